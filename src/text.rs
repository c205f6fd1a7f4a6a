//! Texts of files, shown to people.
//!
//! Titles, names and field texts are what a stranger wrote, and so are the names of files.
//! Raw on a terminal they move its cursor, rename its window or turn the line round; in a
//! window or on paper they hide signs. Whatever shows them (standard output and error, the
//! log, the window, a printed page) sends them through [`visible`], at the door where the
//! text leaves.

use std::borrow::Cow;
use std::error::Error;
use std::fmt::Write;

use unicode_general_category::{GeneralCategory, get_general_category};

/// `text` as one word of a POSIX shell, quoted where it has to be.
pub fn shell_word(text: &str) -> Cow<'_, str> {
    let plain = |sign: char| sign.is_ascii_alphanumeric() || "_./:=,+@%-".contains(sign);
    match !text.is_empty() && text.chars().all(plain) {
        true => Cow::Borrowed(text),
        false => Cow::Owned(format!("'{}'", text.replace('\'', r"'\''"))),
    }
}

/// Whether a sign is seen by what it does, not by its shape: control signs, line breaks,
/// formatting (directions, zero widths, tags).
fn is_hidden(sign: char) -> bool {
    // Most signs of most texts need no table.
    if sign.is_ascii() {
        return sign.is_ascii_control();
    }
    matches!(
        get_general_category(sign),
        GeneralCategory::Control
            | GeneralCategory::Format
            | GeneralCategory::LineSeparator
            | GeneralCategory::ParagraphSeparator
    )
}

/// A text on one line, its control and formatting signs written out: `\n`, `\0`,
/// `\u{1b}`. All else stays as it is, backslashes too, so that it may pass several doors.
pub fn visible(text: &str) -> Cow<'_, str> {
    let Some(first) = text.find(is_hidden) else {
        return Cow::Borrowed(text);
    };
    let mut shown = String::with_capacity(text.len() + 16);
    shown.push_str(&text[..first]);
    for sign in text[first..].chars() {
        match sign {
            '\0' => shown.push_str("\\0"),
            _ if is_hidden(sign) => {
                let _ = write!(shown, "{}", sign.escape_default());
            }
            _ => shown.push(sign),
        }
    }
    Cow::Owned(shown)
}

/// An error with its causes, each said once: many say their cause themselves, in the middle
/// of the sentence, where it reads best.
pub fn with_causes(error: &dyn Error) -> String {
    let mut told = error.to_string();
    let mut next = error.source();
    while let Some(cause) = next {
        let said = cause.to_string();
        if !told.contains(&said) {
            let _ = write!(told, ": {said}");
        }
        next = cause.source();
    }
    told
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Debug, thiserror::Error)]
    enum Wrong {
        #[error("cannot read a.wif: {0}; check the name")]
        Told(#[source] std::io::Error),
        #[error("the picture is damaged")]
        Untold(#[source] std::io::Error),
        #[error(transparent)]
        Other(Box<Wrong>),
    }

    #[test]
    fn a_cause_is_said_once() {
        let cause = || std::io::Error::other("no such file");
        let told = with_causes(&Wrong::Told(cause()));
        assert_eq!(told, "cannot read a.wif: no such file; check the name");
        let other = with_causes(&Wrong::Other(Box::new(Wrong::Told(cause()))));
        assert_eq!(other, told);
        let untold = with_causes(&Wrong::Untold(cause()));
        assert_eq!(untold, "the picture is damaged: no such file");
    }

    #[test]
    fn hidden_signs_are_written_out() {
        let cases = [
            ("A\u{1b}]0;pwn\u{7}B", "A\\u{1b}]0;pwn\\u{7}B"),
            ("two\nlines\r\n", "two\\nlines\\r\\n"),
            ("tab\tnul\0del\u{7f}", "tab\\tnul\\0del\\u{7f}"),
            ("\u{9b}2J\u{85}", "\\u{9b}2J\\u{85}"),
            (
                "a\u{202e}b\u{2066}c\u{200f}",
                "a\\u{202e}b\\u{2066}c\\u{200f}",
            ),
            ("zero\u{200b}width\u{feff}", "zero\\u{200b}width\\u{feff}"),
            ("a\u{2028}b\u{2029}c", "a\\u{2028}b\\u{2029}c"),
            (
                "soft\u{ad}\u{61c}\u{e0041}",
                "soft\\u{ad}\\u{61c}\\u{e0041}",
            ),
        ];
        for (text, shown) in cases {
            assert_eq!(visible(text), shown);
            assert_eq!(visible(shown), shown, "a second door changes nothing");
        }
    }

    #[test]
    fn what_is_seen_stays_as_it_is() {
        for text in [
            "",
            "Körper 2/2",
            "e\u{301}, composed by its parts",
            "綾織\u{3000}二",
            "C:\\weaves\\\"a\".wif",
            "נול",
            "a\u{a0}b — c",
            "🧵",
        ] {
            assert!(matches!(visible(text), Cow::Borrowed(same) if same == text));
        }
    }
}
