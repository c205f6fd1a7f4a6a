//! Stripes as weavers write them: "12 navy 4 cream 12 navy".

use super::yarn::{Yarn, YarnId};

/// The most threads of an order that is typed.
const MOST_THREADS: usize = 1 << 20;

/// A text that is no order of stripes.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum StripesError {
    /// Nothing at all.
    #[error("the stripes are empty: write for instance \"12 {0} 4 {0}\"")]
    Empty(String),
    /// A word where a number of threads is expected.
    #[error("\"{0}\" is no number of threads: write a number, then a yarn, as in \"12 navy\"")]
    Count(String),
    /// A number of threads without a yarn, or a yarn that is not there.
    #[error("no yarn is called \"{found}\": the yarns are {known}")]
    Yarn {
        /// What was written.
        found: String,
        /// The yarns there are.
        known: String,
    },
    /// Too many threads.
    #[error("the stripes have more than {MOST_THREADS} threads: write one repeat of them")]
    TooLong,
}

/// Reads an order of stripes: a number and a yarn by name, or by its number in the list
/// ("#2"), one after the other; commas are blanks. Names may have blanks in them and are
/// compared without regard to case.
///
/// # Errors
/// [`StripesError`] names the first word that does not fit.
pub fn read_stripes(text: &str, yarns: &[Yarn]) -> Result<Vec<YarnId>, StripesError> {
    let words: Vec<&str> = text
        .split([' ', ',', '\t', '\n'])
        .filter(|w| !w.is_empty())
        .collect();
    let named: Vec<Vec<String>> = (yarns.iter())
        .map(|yarn| {
            yarn.name
                .split_whitespace()
                .map(str::to_lowercase)
                .collect()
        })
        .collect();
    let mut order = Vec::new();
    let mut rest = words.as_slice();
    while let Some((count, after)) = rest.split_first() {
        let threads: usize = count
            .parse()
            .map_err(|_| StripesError::Count(short(count)))?;
        let by_number = after.first().and_then(|word| word.strip_prefix('#'));
        let numbered = by_number
            .and_then(|number| number.parse::<usize>().ok())
            .filter(|number| (1..=yarns.len()).contains(number));
        let (yarn, length) = match numbered {
            Some(number) => (number - 1, 1),
            // Of names that fit, the longest: "sky blue" before "sky".
            None => (named.iter().enumerate())
                .filter(|(_, name)| !name.is_empty() && starts_with(after, name))
                .map(|(yarn, name)| (yarn, name.len()))
                .max_by_key(|&(yarn, length)| (length, std::cmp::Reverse(yarn)))
                .ok_or_else(|| StripesError::Yarn {
                    found: short(after.first().unwrap_or(&"")),
                    known: known(yarns),
                })?,
        };
        if order.len().saturating_add(threads) > MOST_THREADS {
            return Err(StripesError::TooLong);
        }
        order.extend(std::iter::repeat_n(YarnId(yarn as u16), threads));
        rest = &after[length..];
    }
    if order.is_empty() {
        let name = yarns.first().map_or("navy", |yarn| yarn.name.as_str());
        return Err(StripesError::Empty(name.to_owned()));
    }
    Ok(order)
}

fn starts_with(words: &[&str], name: &[String]) -> bool {
    words.len() >= name.len()
        && words
            .iter()
            .zip(name)
            .all(|(word, part)| word.to_lowercase() == *part)
}

fn short(word: &str) -> String {
    word.chars().take(40).collect()
}

fn known(yarns: &[Yarn]) -> String {
    let names: Vec<&str> = yarns
        .iter()
        .take(12)
        .map(|yarn| yarn.name.as_str())
        .collect();
    names.join(", ")
}

/// Writes an order as stripes, so that [`read_stripes`] reads it again; yarns whose name
/// is no use for that are written by number.
pub fn write_stripes(order: &[YarnId], yarns: &[Yarn]) -> String {
    let mut parts: Vec<String> = Vec::new();
    for run in order.chunk_by(|a, b| a == b) {
        let id = run[0];
        let name = yarns
            .get(usize::from(id.0))
            .map_or("", |yarn| yarn.name.as_str());
        let named = read_stripes(&format!("1 {name}"), yarns) == Ok(vec![id]);
        let name = if named {
            name.to_owned()
        } else {
            format!("#{}", id.0 + 1)
        };
        parts.push(format!("{} {name}", run.len()));
    }
    parts.join(" ")
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;
    use crate::design::{Family, Srgb};

    fn yarns(names: &[&str]) -> Vec<Yarn> {
        let yarn = |name: &&str| Yarn::new(*name, Family::Cotton, Srgb(1, 2, 3));
        names.iter().map(yarn).collect()
    }

    fn ids(list: &[u16]) -> Vec<YarnId> {
        list.iter().copied().map(YarnId).collect()
    }

    #[test]
    fn stripes_are_read_as_they_are_written() {
        let yarns = yarns(&["navy", "cream", "sky", "sky blue", "", "12", "navy"]);
        let order = read_stripes("2 Navy, 1 cream 2 sky 1 sky blue 1 #2", &yarns).unwrap();
        assert_eq!(order, ids(&[0, 0, 1, 2, 2, 3, 1]));
        // Every order comes back, whatever the yarns are called.
        let all = ids(&[0, 1, 1, 2, 3, 4, 4, 5, 6, 0]);
        let text = write_stripes(&all, &yarns);
        assert_eq!(read_stripes(&text, &yarns).unwrap(), all, "{text}");
    }

    #[test]
    fn what_does_not_fit_is_named() {
        let yarns = yarns(&["navy", "cream"]);
        let said = |text: &str| read_stripes(text, &yarns).unwrap_err().to_string();
        assert!(said("").contains("12 navy"));
        assert!(said("navy").contains("\"navy\" is no number"));
        assert!(said("4 red").contains("navy, cream"));
        assert!(said("4").contains("no yarn is called"));
        assert!(said("4 #3").contains("#3"));
        assert!(said("99999999 navy").contains("more than"));
        assert!(read_stripes("99999999999999999999999 navy", &yarns).is_err());
    }
}
