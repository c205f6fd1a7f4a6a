//! Stripes as a designer types them: "12 navy 4 cream 3x(2 navy 2 cream)".
//!
//! An order is a list of bands, each a count and a yarn, and of groups that repeat. A yarn is
//! named in any case, in quotes where its name has digits or signs in it, or by its number:
//! `#2` is the second. Commas and line ends between bands are ignored.

use super::yarn::{Yarn, YarnId};

/// The most threads that an order may come to.
pub const MOST_THREADS: usize = 1 << 20;

/// Groups within groups.
const MOST_DEPTH: usize = 16;

/// The longest group looked for in writing, in bands.
const MOST_BANDS: usize = 12;

/// An order that cannot be read.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("stripes, column {column}: {problem}")]
pub struct StripeError {
    /// Where, in characters from 1.
    pub column: usize,
    /// What is wrong, and what would be right.
    pub problem: String,
}

#[derive(Debug, Clone, PartialEq, Eq)]
enum Token {
    Number(usize),
    Name(String),
    Yarn(usize),
    Times,
    Open,
    Close,
}

/// The order that a text gives, a yarn for each thread.
///
/// # Errors
/// [`StripeError`] names the place, and the yarns there are if one is not known.
pub fn parse(text: &str, yarns: &[Yarn]) -> Result<Vec<YarnId>, StripeError> {
    let tokens = tokens(text)?;
    let mut reader = Reader {
        end: text.chars().count() + 1,
        tokens: &tokens,
        next: 0,
        yarns,
    };
    let order = reader.bands(0)?;
    match tokens.get(reader.next) {
        Some((column, _)) => Err(wrong(*column, "this ) closes nothing: take it out")),
        None if order.is_empty() => Err(wrong(1, "name one yarn at least: \"12 navy 4 cream\"")),
        None => Ok(order),
    }
}

fn wrong(column: usize, problem: impl Into<String>) -> StripeError {
    let problem = problem.into();
    StripeError { column, problem }
}

fn tokens(text: &str) -> Result<Vec<(usize, Token)>, StripeError> {
    let symbols: Vec<char> = text.chars().collect();
    let mut tokens = Vec::new();
    // Words side by side are one name, but not across a comma.
    let (mut at, mut apart) = (0, false);
    while let Some(&symbol) = symbols.get(at) {
        let column = at + 1;
        let run = |from: usize, within: &dyn Fn(char) -> bool| {
            let rest = symbols[from..].iter();
            rest.take_while(|&&symbol| within(symbol))
                .collect::<String>()
        };
        let digits = |from: usize| run(from, &|symbol| symbol.is_ascii_digit());
        match symbol {
            '(' => tokens.push((column, Token::Open)),
            ')' => tokens.push((column, Token::Close)),
            '×' | '*' => tokens.push((column, Token::Times)),
            ',' | ';' => apart = true,
            blank if blank.is_whitespace() => {}
            '"' => {
                let name = run(at + 1, &|symbol| symbol != '"');
                at += name.chars().count() + 1;
                if at >= symbols.len() {
                    return Err(wrong(column, "this quotation mark is not closed: add one"));
                }
                tokens.push((column, Token::Name(name)));
            }
            '#' => {
                let number = digits(at + 1);
                at += number.len();
                let Ok(number) = number.parse() else {
                    return Err(wrong(column, "expected a yarn's number after #, as #2"));
                };
                tokens.push((column, Token::Yarn(number)));
            }
            digit if digit.is_ascii_digit() => {
                let number = digits(at);
                at += number.len() - 1;
                // Too long for a number is too many threads in any case.
                tokens.push((column, Token::Number(number.parse().unwrap_or(usize::MAX))));
            }
            _ => {
                let word = |symbol: char| !symbol.is_whitespace() && !"(),;\"#×*".contains(symbol);
                let name = run(at, &|symbol| word(symbol) && !symbol.is_ascii_digit());
                at += name.chars().count() - 1;
                push_word(&mut tokens, column, name, std::mem::take(&mut apart));
            }
        }
        at += 1;
    }
    Ok(tokens)
}

/// A word: `x` after a number means times, a second word goes with the first ("dark blue").
fn push_word(tokens: &mut Vec<(usize, Token)>, column: usize, word: String, apart: bool) {
    match tokens.last_mut() {
        Some((_, Token::Number(_))) if word.eq_ignore_ascii_case("x") => {
            tokens.push((column, Token::Times));
        }
        Some((_, Token::Name(name))) if !apart => {
            name.push(' ');
            name.push_str(&word);
        }
        _ => tokens.push((column, Token::Name(word))),
    }
}

struct Reader<'t> {
    tokens: &'t [(usize, Token)],
    next: usize,
    yarns: &'t [Yarn],
    /// The column after the last.
    end: usize,
}

impl Reader<'_> {
    fn peek(&self) -> Option<&Token> {
        self.tokens.get(self.next).map(|(_, token)| token)
    }

    fn column(&self) -> usize {
        self.tokens
            .get(self.next)
            .map_or(self.end, |(column, _)| *column)
    }

    /// Bands up to the end or a closing bracket.
    fn bands(&mut self, depth: usize) -> Result<Vec<YarnId>, StripeError> {
        if depth > MOST_DEPTH {
            let problem =
                format!("more than {MOST_DEPTH} groups within each other: write some out");
            return Err(wrong(self.column(), problem));
        }
        let mut order = Vec::new();
        while self.peek().is_some_and(|token| *token != Token::Close) {
            let column = self.column();
            let count = match self.peek() {
                Some(&Token::Number(count)) => {
                    self.next += 1;
                    count
                }
                _ => 1,
            };
            if count == 0 {
                return Err(wrong(column, "a band of 0 threads is none: leave it out"));
            }
            let times = self.peek() == Some(&Token::Times);
            self.next += usize::from(times);
            let band = match self.peek() {
                Some(Token::Open) => {
                    self.next += 1;
                    let group = self.bands(depth + 1)?;
                    if self.peek() != Some(&Token::Close) {
                        return Err(wrong(self.column(), "a group is not closed: add )"));
                    }
                    self.next += 1;
                    group
                }
                _ => vec![self.yarn()?],
            };
            let threads = band.len().saturating_mul(count).saturating_add(order.len());
            if threads > MOST_THREADS {
                let problem = format!("more than {MOST_THREADS} threads: shorten the order");
                return Err(wrong(column, problem));
            }
            for _ in 0..if band.is_empty() { 0 } else { count } {
                order.extend_from_slice(&band);
            }
        }
        Ok(order)
    }

    fn yarn(&mut self) -> Result<YarnId, StripeError> {
        let column = self.column();
        let known = || {
            let names = self.yarns.iter().take(12).map(|yarn| yarn.name.as_str());
            let more = if self.yarns.len() > 12 { ", …" } else { "" };
            names.collect::<Vec<_>>().join(", ") + more
        };
        let found = match self.peek() {
            Some(Token::Name(name)) => {
                let same =
                    |yarn: &Yarn| yarn.name.trim().to_lowercase() == name.trim().to_lowercase();
                let place = self.yarns.iter().position(same);
                place.ok_or_else(|| {
                    let name: String = name.chars().take(40).collect();
                    wrong(
                        column,
                        format!("no yarn is called \"{name}\"; there are {}", known()),
                    )
                })?
            }
            Some(&Token::Yarn(number)) if (1..=self.yarns.len()).contains(&number) => number - 1,
            Some(Token::Yarn(number)) => {
                let count = self.yarns.len();
                return Err(wrong(
                    column,
                    format!("yarn #{number}: there are {count}; choose one"),
                ));
            }
            Some(Token::Number(_)) => {
                return Err(wrong(
                    column,
                    "two numbers in a row: name a yarn after the first",
                ));
            }
            Some(Token::Times) => return Err(wrong(column, "expected a yarn or a group")),
            _ => {
                return Err(wrong(
                    column,
                    format!("expected a yarn: one of {}", known()),
                ));
            }
        };
        self.next += 1;
        Ok(YarnId(found as u16))
    }
}

/// An order as text that [`parse`] reads back, with groups where bands repeat.
pub fn write(order: &[YarnId], yarns: &[Yarn]) -> String {
    let mut bands: Vec<(usize, YarnId)> = Vec::new();
    for &yarn in order {
        match bands.last_mut() {
            Some((count, last)) if *last == yarn => *count += 1,
            _ => bands.push((1, yarn)),
        }
    }
    let mut words = Vec::new();
    let mut at = 0;
    while at < bands.len() {
        let (length, times) = group(&bands[at..]);
        let text: Vec<String> = bands[at..at + length]
            .iter()
            .map(|&(count, yarn)| format!("{count} {}", name(yarn, yarns)))
            .collect();
        match times {
            1 => words.push(text.join(" ")),
            _ => words.push(format!("{times}x({})", text.join(" "))),
        }
        at += length * times;
    }
    words.join(" ")
}

/// The group at the head of some bands that saves the most: its bands and how often.
fn group(bands: &[(usize, YarnId)]) -> (usize, usize) {
    let mut best = (1, 1);
    for length in 2..=MOST_BANDS.min(bands.len() / 2) {
        let (head, mut times) = (&bands[..length], 1);
        while bands.get(length * times..length * (times + 1)) == Some(head) {
            times += 1;
        }
        if times > 1 && length * (times - 1) > best.0 * (best.1 - 1) {
            best = (length, times);
        }
    }
    best
}

/// A yarn's name as it can be typed: bare where that is clear, quoted, or its number.
fn name(yarn: YarnId, yarns: &[Yarn]) -> String {
    let number = usize::from(yarn.0);
    let by_number = format!("#{}", number + 1);
    let Some(name) = yarns.get(number).map(|yarn| yarn.name.as_str()) else {
        return by_number;
    };
    let same = |yarn: &Yarn| yarn.name.trim().to_lowercase() == name.trim().to_lowercase();
    let first = yarns.iter().position(same) == Some(number);
    let usable = first && !name.trim().is_empty() && !name.contains(['"', '\n', '\r']);
    let plain = |word: &str| {
        word.chars()
            .all(|symbol| symbol.is_alphabetic() || symbol == '-')
    };
    let bare = name.split(' ').all(|word| !word.is_empty() && plain(word));
    match (usable, bare && !name.to_lowercase().starts_with('x')) {
        (true, true) => name.to_owned(),
        (true, false) => format!("\"{name}\""),
        (false, _) => by_number,
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::design::{Family, Srgb};

    fn yarns(names: &[&str]) -> Vec<Yarn> {
        let yarn = |name: &&str| Yarn::new(*name, Family::Cotton, Srgb(0, 0, 0));
        names.iter().map(yarn).collect()
    }

    fn ids(list: &[u16]) -> Vec<YarnId> {
        list.iter().copied().map(YarnId).collect()
    }

    #[test]
    fn orders_are_read_as_they_are_typed() {
        let yarns = yarns(&["navy", "Cream", "dark blue", "no 7"]);
        let read = |text| parse(text, &yarns).unwrap();
        assert_eq!(read("2 navy 1 cream"), ids(&[0, 0, 1]));
        assert_eq!(read("2x(1 NAVY, cream)"), ids(&[0, 1, 0, 1]));
        assert_eq!(read("2 × ( navy 2 (cream) )"), ids(&[0, 1, 1, 0, 1, 1]));
        assert_eq!(read("2 dark blue 1 \"no 7\" #1"), ids(&[2, 2, 3, 0]));
    }

    #[test]
    fn what_is_wrong_is_named_with_its_place() {
        let yarns = yarns(&["navy", "cream"]);
        let message = |text: &str| parse(text, &yarns).unwrap_err().to_string();
        assert_eq!(
            message("2 navy 3 gold"),
            "stripes, column 10: no yarn is called \"gold\"; there are navy, cream"
        );
        for (text, part) in [
            ("", "name one yarn"),
            ("()", "name one yarn"),
            ("2 2 navy", "two numbers"),
            ("3x(2 navy", "column 10: a group is not closed"),
            ("2 navy)", "closes nothing"),
            ("0 navy", "0 threads"),
            ("2 #3", "yarn #3"),
            ("2 \"navy", "not closed"),
            ("2 x", "expected a yarn"),
            ("99999999999999999999999 navy", "shorten"),
            ("9999x(9999x(9999 navy))", "shorten"),
            ("9999x(9999x())", "name one yarn"),
        ] {
            assert!(message(text).contains(part), "{text}: {}", message(text));
        }
        assert!(message(&"(".repeat(100_000)).contains("groups within"));
    }

    #[test]
    fn repeats_are_written_as_groups() {
        let yarns = yarns(&["navy", "cream"]);
        let order = parse("12 navy 3x(2 cream 2 navy) 4 cream", &yarns).unwrap();
        assert_eq!(write(&order, &yarns), "12 navy 3x(2 cream 2 navy) 4 cream");
    }

    proptest! {
        #[test]
        fn what_is_written_is_read_back(
            order in prop::collection::vec(0u16..6, 1..120),
            groups in 1usize..5,
        ) {
            let yarns = yarns(&["navy", "x", "NAVY", "a \"b\"", "no 7 (old)", "x ray"]);
            let order: Vec<u16> = order.repeat(groups);
            prop_assert_eq!(parse(&write(&ids(&order), &yarns), &yarns).unwrap(), ids(&order));
        }

        #[test]
        fn no_text_is_a_crash(text in "[0-9a-zx()#\"× ,*]{0,40}") {
            let yarns = yarns(&["navy", "x"]);
            if let Ok(order) = parse(&text, &yarns) {
                prop_assert!(order.len() <= MOST_THREADS);
                prop_assert_eq!(parse(&write(&order, &yarns), &yarns).unwrap(), order);
            }
        }
    }
}
