//! The attributes of a header in the order of their names.
//!
//! The codec keeps them in a hash table, which gives them another order in every process.
//! Their order means nothing, and places in the file count from the header's end, so they
//! may be exchanged. (OpenEXR file layout: magic number, version, attributes of name, type,
//! size and value, a zero.)

/// Magic number and version.
const BEFORE: usize = 8;

/// A file of one part with its attributes in order; what is no such file stays as it is.
pub(super) fn in_order(bytes: Vec<u8>) -> Vec<u8> {
    let Some((mut attributes, end)) = attributes(&bytes) else {
        return bytes;
    };
    attributes.sort_unstable();
    let mut ordered = Vec::with_capacity(bytes.len());
    ordered.extend_from_slice(&bytes[..BEFORE]);
    for attribute in attributes {
        ordered.extend_from_slice(attribute);
    }
    ordered.extend_from_slice(&bytes[end..]);
    ordered
}

/// Each attribute whole, and where the zero behind the last stands.
fn attributes(bytes: &[u8]) -> Option<(Vec<&[u8]>, usize)> {
    let text = |from: usize| {
        let length = bytes.get(from..)?.iter().position(|&byte| byte == 0)?;
        Some(from + length + 1)
    };
    let mut found = Vec::new();
    let mut at = BEFORE;
    while *bytes.get(at)? != 0 {
        let size_at = text(text(at)?)?;
        let size = bytes.get(size_at..)?.first_chunk::<4>()?;
        let next = size_at
            .checked_add(4)?
            .checked_add(u32::from_le_bytes(*size) as usize)?;
        found.push(bytes.get(at..next)?);
        at = next;
    }
    Some((found, at))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(attributes: &[&[u8]]) -> Vec<u8> {
        let mut file = b"v/1\x01\x02\0\0\0".to_vec();
        attributes
            .iter()
            .for_each(|one| file.extend_from_slice(one));
        file.extend(b"\0and pixels");
        file
    }

    #[test]
    fn attributes_are_sorted_and_the_rest_stays() {
        let (a, b) = (b"a\0int\0\x04\0\0\0\x01\0\0\0", b"b\0string\0\x02\0\0\0hi");
        assert_eq!(in_order(file(&[b, a])), file(&[a, b]));
        assert_eq!(in_order(file(&[a, b])), file(&[a, b]));
        // What breaks off or lies about itself is left alone.
        for broken in [
            &file(&[b, a])[..20],
            b"",
            b"v/1\x01\x02\0\0\0x\0y\0\xff\xff\xff\xff\0",
        ] {
            assert_eq!(in_order(broken.to_vec()), broken);
        }
    }
}
