//! Lines and words of drafts that are texts.

use crate::text::visible;

/// Lines with their terminators (`\n`, `\r\n` or a lone `\r`) taken off.
pub(in crate::formats) fn lines(text: &str) -> impl Iterator<Item = &str> {
    let mut rest = Some(text);
    std::iter::from_fn(move || {
        let text = rest.take()?;
        match text.find(['\n', '\r']) {
            None if text.is_empty() => None,
            None => Some(text),
            Some(end) => {
                let crlf = text[end..].starts_with("\r\n");
                rest = Some(&text[end + if crlf { 2 } else { 1 }..]);
                Some(&text[..end])
            }
        }
    })
}

/// Whether two section names or keys are the same: case and runs of blanks do not count.
pub(in crate::formats) fn same(a: &str, b: &str) -> bool {
    let mut a = a.split_whitespace();
    let mut b = b.split_whitespace();
    loop {
        match (a.next(), b.next()) {
            (None, None) => return true,
            (Some(a), Some(b)) if a.eq_ignore_ascii_case(b) => {}
            _ => return false,
        }
    }
}

/// At most 40 characters of a text, for a message.
pub(in crate::formats) fn shorten(text: &str) -> String {
    let end = text.char_indices().nth(40).map_or(text.len(), |at| at.0);
    let mut short = visible(&text[..end]).into_owned();
    if end < text.len() {
        short.push('…');
    }
    short
}
