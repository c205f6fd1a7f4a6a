//! Weaves by notation: what weavers write instead of drawing.
//!
//! | notation | weave |
//! |---|---|
//! | `plain` | over one, under one |
//! | `2/3 twill`, `z 2/3 twill` | warp over 2, under 3; lines rise to the right (Z) |
//! | `s 3/1 twill` | the same with lines that rise to the left (S) |
//! | `3/1/1/3 twill` | compound twill: over 3, under 1, over 1, under 3 |
//! | `1/7 satin move 3` | 8-end satin: each pick's tie lies 3 ends to the right of the last |
//! | `7/1 satin` | the move left out: the one whose ties lie farthest apart |
//! | `2/2 basket`, `3/1 basket` | plain weave of groups of threads both ways |
//! | `2/2 warp rib` | plain weave with the warp over 2 picks, under 2 |
//! | `2/2 weft rib` | plain weave with the weft over 2 ends, under 2 |
//! | `2/2 herringbone 8` | twill that turns every 8 ends with a clean cut |
//! | `2/2 pointed twill 8` | twill that turns on every 8th end, mirrored in it |
//! | `wavy 4/4 twill 96` | a Z twill of 96 × 96 whose lines swing between steep and flat |
//!
//! Words may stand in any order and case. Pick 0 is the lowest, end 0 the leftmost; every
//! weave starts with end 0 coming up on pick 0. The first number of a ratio counts picks
//! the warp lies *over*, so `1/7` shows mostly weft and `7/1` mostly warp. In satins too
//! the numbers run along the warp: `2/3 satin move 2` lifts each end for two picks in
//! succession. A satin's move must have no factor in common with the number of ends and
//! must not be 1 or one less than that number (those are twills); 4 and 6 ends have no
//! regular satin. Every name of the [library](super::library()) is a notation too.
//!
//! | file | holds |
//! |---|---|
//! | `regular` | what a ratio alone describes |
//! | `combine` | weaves made of weaves: joined, shifted, rearranged, dropped, shaded |
//! | `bind` | ties for floats that are too long |

mod bind;
mod combine;
mod regular;

pub use bind::{BindError, bind_floats};
pub use combine::{
    CombineError, both, counterchange, double_cloth, drop_repeat, either, rearranged, repeated,
    shadow_series, shifted,
};
pub use regular::satin_moves;
use regular::{herringbone, pointed, satin_of, twill, wavy};

use super::pattern::WeavePattern;

/// The longest repeat that notation can ask for, in threads.
pub const MAX_REPEAT: u32 = 2048;

/// A notation that stands for no weave.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("weave \"{notation}\": {reason}")]
pub struct NotationError {
    /// What was written (shortened if long).
    pub notation: String,
    /// What is wrong and what would be right.
    pub reason: String,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Plain,
    Twill,
    Satin,
    Basket,
    WarpRib,
    WeftRib,
    Herringbone,
    Pointed,
    Wavy,
}

/// The words of a notation, sorted by what they are.
#[derive(Debug, Default)]
struct Words {
    ratio: Option<Vec<u32>>,
    number: Option<u32>,
    step: Option<u32>,
    leans_left: Option<bool>,
    names: Vec<String>,
}

/// The weave that a notation stands for; the module's table lists them.
///
/// A name of the [library](super::library()) stands for its weave.
///
/// # Errors
/// [`NotationError`] with what is wrong and what would be right.
pub fn weave(notation: &str) -> Result<WeavePattern, NotationError> {
    regular_weave(notation).or_else(|error| {
        super::library::find(notation).map_or(Err(error), |known| Ok(known.pattern().clone()))
    })
}

/// As [`weave`], without the library: what the library itself is made of.
pub(in crate::design) fn regular_weave(notation: &str) -> Result<WeavePattern, NotationError> {
    build(notation).map_err(|reason| NotationError {
        notation: notation
            .split_whitespace()
            .collect::<Vec<_>>()
            .join(" ")
            .chars()
            .take(60)
            .collect(),
        reason,
    })
}

fn read_words(notation: &str) -> Result<Words, String> {
    let mut words = Words::default();
    let mut wants_move = false;
    for word in notation.split_whitespace().map(str::to_lowercase) {
        if word.contains('/') {
            let parts: Result<Vec<u32>, String> = word.split('/').map(thread_count).collect();
            if words.ratio.replace(parts?).is_some() {
                return Err("two ratios: give one, as in 2/2 twill".into());
            }
        } else if word.bytes().all(|byte| byte.is_ascii_digit()) {
            let slot = if wants_move {
                &mut words.step
            } else {
                &mut words.number
            };
            wants_move = false;
            if slot.replace(thread_count(&word)?).is_some() {
                return Err(format!("\"{word}\" is one number too many"));
            }
        } else {
            match word.as_str() {
                "move" => wants_move = true,
                "z" => words.leans_left = Some(false),
                "s" => words.leans_left = Some(true),
                _ => words.names.push(word),
            }
        }
    }
    if wants_move {
        return Err("the move is missing: write for instance move 3".into());
    }
    Ok(words)
}

fn thread_count(text: &str) -> Result<u32, String> {
    match text.parse::<u32>() {
        Ok(0) => Err("0 threads: numbers start at 1".into()),
        Ok(number) if number <= MAX_REPEAT => Ok(number),
        Ok(_) => Err(format!("{text} is more than {MAX_REPEAT} threads")),
        Err(_) => {
            let text: String = text.chars().take(20).collect();
            Err(format!(
                "\"{text}\" is not a number of threads: write for instance 2/2"
            ))
        }
    }
}

fn kind_of(names: &[String]) -> Result<Kind, String> {
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let mut sorted = names.clone();
    sorted.sort_unstable();
    match sorted.as_slice() {
        ["plain"] | ["plain", "weave"] | ["tabby"] => Ok(Kind::Plain),
        ["twill"] => Ok(Kind::Twill),
        ["satin"] | ["sateen"] => Ok(Kind::Satin),
        ["basket"] | ["hopsack"] | ["basket", "weave"] => Ok(Kind::Basket),
        ["rib", "warp"] => Ok(Kind::WarpRib),
        ["rib", "weft"] => Ok(Kind::WeftRib),
        ["herringbone"] | ["herringbone", "twill"] => Ok(Kind::Herringbone),
        ["pointed"] | ["pointed", "twill"] => Ok(Kind::Pointed),
        ["wavy"] | ["twill", "wavy"] => Ok(Kind::Wavy),
        ["rib"] => Err("say which rib: 2/2 warp rib or 2/2 weft rib".into()),
        [] => Err("which weave? write for instance plain, 2/2 twill or 1/7 satin move 3".into()),
        _ => Err(format!(
            "\"{}\" is no weave known here: use plain, twill, satin, basket, warp rib, \
             weft rib, herringbone, pointed twill, wavy twill or a name of the library",
            names.join(" ").chars().take(40).collect::<String>()
        )),
    }
}

fn build(notation: &str) -> Result<WeavePattern, String> {
    let words = read_words(notation)?;
    let kind = kind_of(&words.names)?;
    if words.step.is_some() && kind != Kind::Satin {
        return Err("a move belongs to a satin".into());
    }
    let turning = matches!(kind, Kind::Herringbone | Kind::Pointed | Kind::Wavy);
    if let Some(number) = words.number
        && !turning
    {
        return Err(format!(
            "what is {number}? only turning twills take a length"
        ));
    }
    if words.leans_left.is_some() && !(turning || kind == Kind::Twill) {
        return Err("z and s belong to twills".into());
    }
    if kind == Kind::Plain {
        return match words.ratio.as_deref() {
            None | Some([1, 1]) => Ok(WeavePattern::from_fn(2, 2, |end, pick| end == pick)),
            Some(_) => Err("plain weave is 1/1 and takes no other ratio".into()),
        };
    }
    let ratio = words
        .ratio
        .ok_or("the ratio is missing: write for instance 2/2 before the name")?;
    let total = ratio.iter().fold(0u32, |sum, &n| sum.saturating_add(n));
    if ratio.len() % 2 == 1 {
        return Err("a ratio alternates over and under: 2/2 or 3/1/1/3".into());
    }
    if total > MAX_REPEAT {
        return Err(format!(
            "the repeat of {total} threads is longer than {MAX_REPEAT}"
        ));
    }
    let simple = match ratio.as_slice() {
        &[over, under] => Some((over, under)),
        _ => None,
    };
    let pair = simple.ok_or("only twills may be compound: give two numbers, as in 2/2");
    let left = words.leans_left.unwrap_or(false);
    match kind {
        Kind::Plain | Kind::Twill => Ok(twill(&ratio, left)),
        Kind::Satin => {
            let (over, under) = pair?;
            satin_of(over, under, words.step)
        }
        Kind::Basket => {
            let (over, under) = pair?;
            let first = |thread: u32| thread % total < over;
            let _ = under;
            Ok(WeavePattern::from_fn(total, total, |end, pick| {
                first(end) == first(pick)
            }))
        }
        Kind::WarpRib => {
            let (over, _) = pair?;
            Ok(WeavePattern::from_fn(2, total, |end, pick| {
                (pick < over) == (end == 0)
            }))
        }
        Kind::WeftRib => {
            let (over, _) = pair?;
            Ok(WeavePattern::from_fn(total, 2, |end, pick| {
                (end < over) == (pick == 0)
            }))
        }
        Kind::Herringbone => herringbone(&ratio, words.number.unwrap_or(2 * total), left),
        Kind::Pointed => pointed(&ratio, words.number.unwrap_or(total), left),
        Kind::Wavy => wavy(&ratio, words.number.unwrap_or(96), left),
    }
}

/// The weft satin 1/(`ends` − 1): one tie a pick, each `step` ends to the right of the
/// last.
///
/// # Errors
/// [`NotationError`] if no such satin exists; the message lists the moves that do.
pub fn satin(ends: u32, step: u32) -> Result<WeavePattern, NotationError> {
    weave(&format!("1/{} satin move {step}", ends.saturating_sub(1)))
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;

    fn expect_pattern(notation: &str, art: &str) {
        let expected = WeavePattern::parse(art).unwrap();
        assert_eq!(
            weave(notation).unwrap(),
            expected,
            "{notation}\n{}",
            weave(notation).unwrap()
        );
    }

    fn reason(notation: &str) -> String {
        let message = weave(notation).unwrap_err().to_string();
        assert_eq!(message.lines().count(), 1);
        message
    }

    #[test]
    fn satin_5_move_2_has_no_touching_ties() {
        let expected = WeavePattern::parse(
            "
            ...#.
            .#...
            ....#
            ..#..
            #....",
        )
        .unwrap();
        assert_eq!(satin(5, 2).unwrap(), expected);
        // The other move is its mirror image and not the same weave.
        assert_ne!(satin(5, 3).unwrap(), expected);
    }

    #[test]
    fn a_twill_without_a_letter_rises_to_the_right() {
        expect_pattern(
            "2/3 twill",
            "
            ...##
            ..##.
            .##..
            ##...
            #...#",
        );
        assert_eq!(weave("Z 2/3 Twill").unwrap(), weave("twill 2/3").unwrap());
        assert_ne!(weave("s 2/3 twill").unwrap(), weave("z 2/3 twill").unwrap());
    }

    #[test]
    fn an_s_twill_rises_to_the_left() {
        expect_pattern(
            "s 3/1 twill",
            "
            .###
            #.##
            ##.#
            ###.",
        );
    }

    #[test]
    fn ratios_count_along_the_warp() {
        let pattern = weave("3/1/1/3 twill").unwrap();
        let column: Vec<bool> = (0..8).map(|pick| pattern.get(0, pick)).collect();
        assert_eq!(column, [true, true, true, false, true, false, false, false]);
        expect_pattern("2/2 warp rib", ".#\n.#\n#.\n#.");
        expect_pattern("2/2 weft rib", "..##\n##..");
        expect_pattern("2/2 basket", "..##\n..##\n##..\n##..");
        expect_pattern("plain", ".#\n#.");
    }

    #[test]
    fn satins_of_eight() {
        expect_pattern(
            "1/7 satin move 3",
            "
            .....#..
            ..#.....
            .......#
            ....#...
            .#......
            ......#.
            ...#....
            #.......",
        );
        let warp = weave("7/1 satin move 3").unwrap();
        assert_eq!(warp.count_warp_up(), 56);
        assert_eq!(weave("7/1 satin").unwrap(), warp);
        assert_eq!(satin_moves(5), [2, 3]);
        assert_eq!(satin_moves(8), [3, 5]);
        assert_eq!(satin_moves(16), [3, 5, 7, 9, 11, 13]);
        assert!(satin_moves(6).is_empty());
    }

    #[test]
    fn every_satin_binds_every_thread_once() {
        for ends in 5..40 {
            for step in satin_moves(ends) {
                let pattern = satin(ends, step).unwrap();
                for thread in 0..ends {
                    let pick = (0..ends).filter(|&end| pattern.get(end, thread)).count();
                    let end = (0..ends).filter(|&pick| pattern.get(thread, pick)).count();
                    assert_eq!((pick, end), (1, 1));
                }
                assert!(pattern.get(step % ends, 1), "tie moves {step} to the right");
            }
        }
    }

    #[test]
    fn herringbone_cuts_cleanly() {
        expect_pattern(
            "2/2 herringbone 4",
            "
            ..##..##
            .##.#..#
            ##..##..
            #..#.##.",
        );
        // Both cuts exchange face and back on every pick.
        for notation in [
            "2/2 herringbone 4",
            "2/2 herringbone 10",
            "3/3 herringbone 9",
            "s 2/2 herringbone 8",
        ] {
            let pattern = weave(notation).unwrap();
            let width = i64::from(pattern.ends()) / 2;
            for cut in [0, width] {
                for pick in 0..i64::from(pattern.picks()) {
                    assert_ne!(
                        pattern.get_wrapped(cut - 1, pick),
                        pattern.get_wrapped(cut, pick),
                        "{notation}"
                    );
                }
            }
        }
    }

    #[test]
    fn pointed_twill_is_its_own_mirror() {
        let pattern = weave("2/2 pointed twill 8").unwrap();
        assert_eq!(pattern.ends(), 16);
        for pick in 0..4 {
            for end in 0..16 {
                assert_eq!(
                    pattern.get_wrapped(end, pick),
                    pattern.get_wrapped(-end, pick)
                );
            }
        }
    }

    #[test]
    fn a_wavy_twill_swings_without_long_floats() {
        let pattern = weave("wavy 4/4 twill 96").unwrap();
        assert_eq!((pattern.ends(), pattern.picks()), (96, 96));
        let floats = super::super::floats::floats(&pattern);
        assert_eq!(floats.longest.warp_face, 4);
        assert!(floats.longest.weft_face <= 12, "{floats:?}");
        assert!(floats.unbound_ends.is_empty() && floats.unbound_picks.is_empty());
        // It does swing: somewhere two neighbours agree and somewhere they skip a pick.
        assert!((0..95).any(|end| (0..96).all(|p| pattern.get(end, p) == pattern.get(end + 1, p))));
    }

    #[test]
    fn nonsense_is_refused_with_what_would_be_right() {
        assert!(reason("1/7 satin move 2").contains("use 3, 5"));
        assert!(reason("1/5 satin").contains("no regular satin exists on 6 ends"));
        assert!(reason("1/3 satin move 0").contains("0 threads"));
        assert!(reason("0/4 twill").contains("numbers start at 1"));
        assert!(reason("2/2 rib").contains("warp rib"));
        assert!(reason("2/x twill").contains("not a number"));
        assert!(reason("2/2/1 twill").contains("alternates"));
        assert!(reason("99999999999 twill").contains("not a number"));
        assert!(reason("2/2 twill move 3").contains("satin"));
        assert!(reason("wavy 4/4 twill 90").contains("use 96"));
        for notation in [
            "",
            "   ",
            "move",
            "twill",
            "🧵",
            "2/2",
            "s plain",
            "1/7 satin move 9",
        ] {
            let _ = reason(notation);
        }
    }

    #[test]
    fn every_notation_of_the_table_weaves() {
        for notation in [
            "plain",
            "2/3 twill",
            "z 2/3 twill",
            "s 3/1 twill",
            "3/1/1/3 twill",
            "1/7 satin move 3",
            "7/1 satin",
            "1/15 satin",
            "15/1 satin",
            "2/2 basket",
            "3/1 basket",
            "2/2 warp rib",
            "2/2 weft rib",
            "2/2 herringbone 8",
            "2/2 pointed twill 8",
            "wavy 4/4 twill 96",
        ] {
            assert!(weave(notation).is_ok(), "{notation}");
        }
    }
}
