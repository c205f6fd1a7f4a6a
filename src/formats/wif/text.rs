//! The text of a WIF: sections, keys and values, with their line numbers.
//!
//! Nothing is copied out of the text: a section is a name and a stretch of lines, and its
//! entries are read again by whoever wants them, so that memory stays near the file's size.

use std::borrow::Cow;

use super::WifError;
use crate::formats::sheet::text::{lines, same, shorten};

/// More sections than any program writes; a guard against files made of headers.
const MAX_SECTIONS: usize = 4096;

/// A section: what stands between its header and the next.
#[derive(Debug, Clone, Copy)]
pub(super) struct Section<'t> {
    /// The name as written, without brackets.
    pub name: &'t str,
    /// Line of the header, from 1; 0 for what stands before the first header.
    pub line: u32,
    /// The lines below the header.
    pub body: &'t str,
}

/// One `key=value` line.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Entry<'t> {
    /// Line, from 1.
    pub line: u32,
    /// Left of the first `=`, without blanks around it.
    pub key: &'t str,
    /// Right of it, without blanks around it; `None` where there is no `=`.
    pub value: Option<Cow<'t, str>>,
}

/// The name in a header line, and what follows the bracket.
fn header(line: &str) -> Option<(&str, &str)> {
    let inside = line.trim().strip_prefix('[')?;
    let (name, after) = inside.split_once(']')?;
    Some((name.trim(), after.trim()))
}

/// The sections of a text, first what stands before any header.
///
/// `known` says which names are WIF's own: a header of theirs with something other than a
/// comment behind it is not a WIF, while elsewhere it is only an odd line.
pub(super) fn sections<'t>(
    text: &'t str,
    file: &str,
    known: impl Fn(&str) -> bool,
) -> Result<Vec<Section<'t>>, WifError> {
    let mut found = vec![Section {
        name: "",
        line: 0,
        body: text,
    }];
    let start_of = |line: &str| line.as_ptr() as usize - text.as_ptr() as usize;
    let mut body_from = 0;
    for (index, line) in lines(text).enumerate() {
        let Some((name, after)) = header(line) else {
            continue;
        };
        let number = index as u32 + 1;
        if !after.is_empty() && !after.starts_with(';') {
            if known(name) {
                let problem = format!(
                    "expected the line to end after [{name}], found \"{}\"",
                    shorten(after)
                );
                let remedy = "take the remark out, or begin it with ;";
                return Err(WifError::at(file, number, problem, remedy));
            }
            continue;
        }
        if found.len() >= MAX_SECTIONS {
            let problem = format!("expected at most {MAX_SECTIONS} sections");
            return Err(WifError::at(file, number, problem, "this is not a draft"));
        }
        if let Some(last) = found.last_mut() {
            last.body = &text[body_from..start_of(line)];
        }
        body_from = start_of(line) + line.len();
        found.push(Section {
            name,
            line: number,
            body: &text[body_from..],
        });
    }
    Ok(found)
}

impl<'t> Section<'t> {
    /// Its lines with their numbers, the header left out.
    fn numbered(&self) -> impl Iterator<Item = (u32, &'t str)> + use<'t> {
        let first = self.line;
        // Below a header the body begins with the rest of the header's own line.
        let skip = usize::from(first > 0);
        lines(self.body)
            .enumerate()
            .skip(skip)
            .map(move |(index, line)| (first.max(1) + index as u32, line))
    }

    /// Its lines word for word, separated by `\n`, without blank and empty comment lines
    /// at the end.
    pub fn verbatim(&self) -> String {
        let mut kept = String::with_capacity(self.body.len());
        let mut worth = 0;
        for (_, line) in self.numbered() {
            kept.push_str(line);
            if !matches!(line.trim(), "" | ";") {
                worth = kept.len();
            }
            kept.push('\n');
        }
        kept.truncate(worth);
        kept
    }

    /// Its entries; blank lines and lines that begin with `;` are left out.
    ///
    /// With `joined`, a `\` at the end of a line continues it on the next (for lists of
    /// numbers only: texts may end in a path).
    pub fn entries(&self, joined: bool) -> impl Iterator<Item = Entry<'t>> + use<'t> {
        let mut lines = self.numbered();
        std::iter::from_fn(move || {
            loop {
                let (line, text) = lines.next()?;
                let text = text.trim();
                if text.is_empty() || text.starts_with(';') {
                    continue;
                }
                let Some((key, value)) = text.split_once('=') else {
                    let key = text;
                    return Some(Entry {
                        line,
                        key,
                        value: None,
                    });
                };
                let mut value = Cow::Borrowed(value.trim());
                while joined && value.ends_with('\\') {
                    let whole = value.to_mut();
                    whole.pop();
                    match lines.next() {
                        Some((_, next)) => whole.push_str(next.trim()),
                        None => break,
                    }
                }
                let key = key.trim();
                return Some(Entry {
                    line,
                    key,
                    value: Some(value),
                });
            }
        })
    }

    /// The last value given for a key, with its line.
    pub fn value(&self, key: &str) -> Option<(u32, Cow<'t, str>)> {
        self.entries(false)
            .filter(|entry| same(entry.key, key))
            .filter_map(|entry| Some((entry.line, entry.value?)))
            .last()
    }
}

/// A number's or boolean's text without a trailing `; comment`.
pub(super) fn bare(value: &str) -> &str {
    value.split(';').next().unwrap_or(value).trim()
}

/// A boolean: true, on, yes, 1 or false, off, no, 0.
pub(super) fn boolean(value: &str) -> Option<bool> {
    match bare(value).to_ascii_lowercase().as_str() {
        "true" | "on" | "yes" | "1" => Some(true),
        "false" | "off" | "no" | "0" => Some(false),
        _ => None,
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;

    fn parts(text: &str) -> Vec<Section<'_>> {
        sections(text, "t.wif", |name| same(name, "warp")).unwrap()
    }

    #[test]
    fn every_line_ending_counts_one_line() {
        for end in ["\n", "\r\n", "\r"] {
            let text = ["junk", "[A]", ";x", "", "k = v", "[b  C]", "1=2"].join(end);
            let found = parts(&text);
            assert_eq!(found.len(), 3);
            let entry = found[1].entries(false).next().unwrap();
            assert_eq!((entry.line, entry.key), (5, "k"), "{end:?}");
            assert_eq!(entry.value.as_deref(), Some("v"));
            assert!(same(found[2].name, "B c"));
            assert_eq!(found[2].entries(false).next().unwrap().line, 7);
            assert_eq!(found[0].entries(false).next().unwrap().line, 1);
        }
    }

    #[test]
    fn a_backslash_continues_lists_only() {
        let found = parts("[A]\n1=2,\\\n3\n4=5");
        let joined: Vec<_> = found[1].entries(true).collect();
        assert_eq!(joined[0].value.as_deref(), Some("2,3"));
        assert_eq!((joined[1].key, joined[1].line), ("4", 4));
        assert_eq!(found[1].entries(false).count(), 3);
        assert_eq!(parts("[A]\n1=2\\")[1].entries(true).count(), 1);
    }

    #[test]
    fn text_behind_a_known_header_is_no_wif() {
        let error = sections("[WARP] x\n", "t.wif", |name| same(name, "warp")).unwrap_err();
        assert!(error.to_string().starts_with("t.wif, line 1: "), "{error}");
        assert_eq!(parts("[WARP] ; x\n").len(), 2);
        assert_eq!(parts("[other] x\n").len(), 1);
    }

    #[test]
    fn sections_come_back_word_for_word() {
        let found = parts("[X]\n a = b \n;c\n\n;\n\n[Y]");
        assert_eq!(found[1].verbatim(), " a = b \n;c");
    }
}
