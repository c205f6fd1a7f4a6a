//! Colour profiles: what an ICC profile calls itself.

/// The largest profile that is looked at, bytes: many times those that cameras write.
pub(super) const MOST: usize = 4 << 20;

/// The bytes of a compressed profile (zlib); `None` if there are more than [`MOST`], none
/// at all if they are damaged.
pub(super) fn unpacked(packed: &[u8]) -> Option<Vec<u8>> {
    use miniz_oxide::inflate::{TINFLStatus, decompress_to_vec_zlib_with_limit};
    match decompress_to_vec_zlib_with_limit(packed, MOST) {
        Ok(profile) => Some(profile),
        Err(error) if error.status == TINFLStatus::HasMoreOutput => None,
        Err(_) => Some(Vec::new()),
    }
}

/// What an ICC profile calls itself, if that is not sRGB.
///
/// The header's bytes 16 to 19 name the space of its numbers; the description is a text
/// somewhere behind it, in ASCII or UTF-16.
pub(super) fn foreign(profile: &[u8]) -> Option<String> {
    let letters: Vec<u8> = (profile.iter().copied())
        .filter(|byte| byte.is_ascii_graphic())
        .map(|byte| byte.to_ascii_lowercase())
        .collect();
    let says = |name: &[u8]| letters.windows(name.len()).any(|part| part == name);
    let space = String::from_utf8_lossy(profile.get(16..20)?)
        .trim()
        .to_owned();
    // The working space of greys is read with sRGB's curve or one close to it.
    if space == "GRAY" || space == "RGB" && (says(b"srgb") || says(b"iec61966-2.1")) {
        return None;
    }
    let known: [(&[u8], &str); 5] = [
        (b"displayp3", "Display P3"),
        (b"adobergb", "Adobe RGB"),
        (b"prophoto", "ProPhoto RGB"),
        (b"rec2020", "Rec. 2020"),
        (b"bt.2020", "Rec. 2020"),
    ];
    let named = known.iter().find(|(name, _)| says(name));
    Some(named.map_or_else(
        || space.chars().filter(|c| c.is_ascii_graphic()).collect(),
        |&(_, name)| name.to_owned(),
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn profiles_other_than_srgb_are_named() {
        let profile = |space: &[u8; 4], text: &[u8]| {
            let mut bytes = vec![0; 128];
            bytes[16..20].copy_from_slice(space);
            bytes.extend_from_slice(text);
            foreign(&bytes)
        };
        assert_eq!(profile(b"RGB ", b"desc sRGB IEC61966-2.1"), None);
        assert_eq!(profile(b"RGB ", b"\0s\0R\0G\0B\0 \0b"), None);
        assert_eq!(profile(b"GRAY", b"Dot gain"), None);
        assert_eq!(
            profile(b"RGB ", b"Display P3").as_deref(),
            Some("Display P3")
        );
        assert_eq!(profile(b"CMYK", b"Coated").as_deref(), Some("CMYK"));
        assert_eq!(foreign(b"short"), None);
    }

    #[test]
    fn profiles_are_unpacked_up_to_a_bound() {
        let pack = |length: usize| miniz_oxide::deflate::compress_to_vec_zlib(&vec![7; length], 6);
        assert_eq!(unpacked(&pack(MOST)).map(|all| all.len()), Some(MOST));
        assert_eq!(unpacked(&pack(MOST + 1)), None);
        assert_eq!(unpacked(b"nonsense"), Some(Vec::new()));
    }
}
