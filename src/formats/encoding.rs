//! How the texts of drafts are encoded: UTF-8, UTF-16 or Windows-1252.
//!
//! No draft format says which. A byte order mark is believed; without one, text of which
//! every other byte is zero is UTF-16, for no other encoding has zero bytes; what is no
//! UTF-8 is Windows-1252, as old programs wrote it (Latin-1 but for 0x80 to 0x9f).

use std::borrow::Cow;

use encoding_rs::{Encoding, UTF_8, UTF_16BE, UTF_16LE, WINDOWS_1252};

use super::sheet::Warnings;

/// Bytes that tell UTF-16 without a byte order mark.
const LOOKED_AT: usize = 512;

/// Bytes in which every format can be known.
const BEGINNING: usize = 8192;

/// UTF-16 with a byte order mark, or certainly without one: which, and how long the mark is.
fn utf_16(bytes: &[u8]) -> Option<(&'static Encoding, usize)> {
    if let Some((encoding, mark)) = Encoding::for_bom(bytes) {
        return (encoding != UTF_8).then_some((encoding, mark));
    }
    let start = &bytes[..bytes.len().min(LOOKED_AT)];
    let units = start.chunks_exact(2);
    let count = units.len();
    let plain =
        |high: u8, low: u8| high == 0 && (matches!(low, b'\t' | b'\n' | b'\r' | b' '..=b'~'));
    // Drafts begin with a bracket, an @ or a remark: the first signs are certainly ASCII.
    let certain = |plain: &dyn Fn(&[u8]) -> bool| {
        count >= 4
            && units.clone().take(4).all(plain)
            && 4 * units.clone().filter(|unit| plain(unit)).count() >= 3 * count
    };
    if certain(&|unit| plain(unit[1], unit[0])) {
        Some((UTF_16LE, 0))
    } else if certain(&|unit| plain(unit[0], unit[1])) {
        Some((UTF_16BE, 0))
    } else {
        None
    }
}

/// The text of a file. Parts of UTF-16 that are no signs become `U+FFFD` and are told.
pub(super) fn decode<'b>(bytes: &'b [u8], warnings: &mut Warnings) -> Cow<'b, str> {
    if let Some((encoding, mark)) = utf_16(bytes) {
        let (text, damaged) = encoding.decode_without_bom_handling(&bytes[mark..]);
        if damaged {
            let count = text.matches(char::REPLACEMENT_CHARACTER).count();
            let signs = if count == 1 { "sign" } else { "signs" };
            warnings.whole(format!(
                "the text is {}, of which {count} {signs} are damaged and read as U+FFFD",
                encoding.name()
            ));
        }
        return text;
    }
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    match std::str::from_utf8(bytes) {
        Ok(text) => Cow::Borrowed(text),
        Err(_) => WINDOWS_1252.decode_without_bom_handling(bytes).0,
    }
}

/// A short text inside a binary file: UTF-8, else Windows-1252.
pub(super) fn decode_short(bytes: &[u8]) -> String {
    match std::str::from_utf8(bytes) {
        Ok(text) => text.to_owned(),
        Err(_) => WINDOWS_1252
            .decode_without_bom_handling(bytes)
            .0
            .into_owned(),
    }
}

/// A file whose text must be UTF-8 or UTF-16, as UTF-8; what is neither stays as it is.
pub(super) fn as_utf_8<'b>(bytes: &'b [u8], warnings: &mut Warnings) -> Cow<'b, [u8]> {
    match utf_16(bytes) {
        Some(_) => Cow::Owned(decode(bytes, warnings).into_owned().into_bytes()),
        None => Cow::Borrowed(bytes),
    }
}

/// The beginning of a file, by which formats are known: UTF-16 as UTF-8, all else as it is.
pub(super) fn beginning(bytes: &[u8]) -> Cow<'_, [u8]> {
    let start = &bytes[..bytes.len().min(BEGINNING)];
    match utf_16(start) {
        Some(_) => as_utf_8(start, &mut Warnings::default())
            .into_owned()
            .into(),
        None => Cow::Borrowed(bytes),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(bytes: &[u8]) -> (String, Vec<String>) {
        let mut warnings = Warnings::default();
        let text = decode(bytes, &mut warnings).into_owned();
        (text, warnings.finish())
    }

    fn units(text: &str, bytes: fn(u16) -> [u8; 2], mark: bool) -> Vec<u8> {
        let mark = mark.then_some(0xfeff).into_iter();
        mark.chain(text.encode_utf16()).flat_map(bytes).collect()
    }

    #[test]
    fn every_encoding_of_a_text_is_read_alike() {
        let written = "[WIF]\r\nTitle=Köper – naïve “x” 綾 𝄞\r\n[WEAVING]\r\nShafts=4\r\n";
        assert_eq!(text(written.as_bytes()).0, written);
        assert_eq!(text(format!("\u{feff}{written}").as_bytes()).0, written);
        for mark in [true, false] {
            for order in [u16::to_le_bytes, u16::to_be_bytes] {
                let bytes = units(written, order, mark);
                assert_eq!(text(&bytes), (written.to_owned(), Vec::new()));
                assert!(beginning(&bytes).starts_with(b"[WIF]"));
            }
        }
    }

    #[test]
    fn what_is_no_utf_8_is_windows_1252() {
        assert_eq!(text(b"a=\xe9 \x96 \x80 \x93x\x94").0, "a=é – € “x”");
        assert_eq!(decode_short(b"Stoff \x96 1"), "Stoff – 1");
        // The five places that Windows-1252 has no sign for.
        assert_eq!(text(b"\xff\x81").0, "ÿ\u{81}");
    }

    #[test]
    fn damage_is_counted() {
        let mut bytes = units("[WIF]\n", u16::to_le_bytes, true);
        bytes.extend(0xd800u16.to_le_bytes());
        bytes.extend(u16::to_le_bytes(b'x'.into()));
        bytes.push(b'y');
        let (text, warnings) = text(&bytes);
        assert_eq!(text, "[WIF]\n\u{fffd}x\u{fffd}");
        assert_eq!(warnings.len(), 1);
        assert!(
            warnings[0].contains("UTF-16LE") && warnings[0].contains("2 signs"),
            "{warnings:?}"
        );
    }

    #[test]
    fn bytes_that_are_no_utf_16_for_certain_are_not_taken_for_it() {
        for bytes in [
            b"[WIF]\nTitle=x".as_slice(),
            b"\0\0\0\0\0\0\0\0",
            b"[\0W\0",
            b"\x81\xfe\x01\x01\0\0\0\x01",
            b"a\0\0\0b\0\0\0c\0\0\0",
        ] {
            assert!(utf_16(bytes).is_none(), "{bytes:?}");
        }
    }
}
