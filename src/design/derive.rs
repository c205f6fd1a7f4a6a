//! The way back: a draft that weaves a given drawdown.
//!
//! Ends that are lifted alike share a shaft and picks that lift alike share a treadle.
//! With each end on one shaft and one treadle for each pick no draft does with fewer: two
//! ends of different columns cannot hang on one shaft, two picks of different rows cannot
//! press one treadle. Shafts are numbered in the order in which end 1, 2, … first need
//! them and treadles likewise from pick 1, as weavers do. An end that is never lifted has
//! a shaft too, and a pick that lifts nothing a treadle, so that nothing is left hanging.
//!
//! Where a loom has too few treadles, several may be pressed together: a row that is the
//! union of other rows needs none of its own. That is the least for treadles tied as rows
//! of the cloth; ties that are no row might do with fewer, but finding them is a set cover
//! that takes exponential time, and is not tried.

use std::collections::HashMap;

use super::draft::{Draft, DraftError, Lifting, MAX_SHAFTS, Shed, Ties};
use super::pattern::WeavePattern;

/// What a loom has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Loom {
    /// Shafts.
    pub shafts: u32,
    /// Treadles; 0 where there are none.
    pub treadles: u32,
    /// Whether it can lift any shafts for each pick (dobby, table loom).
    pub dobby: bool,
}

impl Loom {
    /// A dobby without treadles: its drafts have a lift plan.
    pub fn dobby(shafts: u32) -> Self {
        Self {
            shafts,
            treadles: 0,
            dobby: true,
        }
    }
}

/// A drawdown that a loom cannot weave.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum DeriveError {
    /// More different columns than shafts.
    #[error("the weave needs {needed} shafts; the loom has {shafts}: weave it as a jacquard")]
    Shafts {
        /// Different columns of the drawdown.
        needed: u32,
        /// Shafts of the loom.
        shafts: u32,
    },
    /// More different rows than treadles, even when several are pressed together.
    #[error(
        "the weave needs {needed} treadles; the loom has {treadles}: use a dobby or a table loom"
    )]
    Treadles {
        /// Treadles needed.
        needed: u32,
        /// Treadles of the loom.
        treadles: u32,
    },
    /// A draft that cannot be.
    #[error(transparent)]
    Draft(#[from] DraftError),
}

/// The most words that are compared in looking for unions; beyond, none are looked for.
const MOST_COMPARED: usize = 1 << 27;

/// A rising-shed draft that weaves `pattern` on `loom`: tie-up and treadling where the
/// loom has the treadles, else a lift plan on a dobby, else several treadles together.
///
/// Takes time in proportion to the crossings (two passes over their words).
///
/// # Errors
/// [`DeriveError`] names how many shafts or treadles it needs.
pub fn derive(pattern: &WeavePattern, loom: &Loom) -> Result<Draft, DeriveError> {
    let columns = Alike::picks_of(&pattern.transposed());
    let (needed, shafts) = (columns.first.len() as u32, loom.shafts.min(MAX_SHAFTS));
    if needed > shafts {
        return Err(DeriveError::Shafts { needed, shafts });
    }
    let threading = columns.ties();
    let lifted = |pick: u32| -> Vec<u16> {
        let shafts = columns.first.iter().enumerate();
        let up = shafts.filter(|&(_, &end)| pattern.get(end, pick));
        up.map(|(shaft, _)| shaft as u16).collect()
    };
    if loom.treadles == 0 && loom.dobby {
        let plan = Ties::from_rows((0..pattern.picks()).map(lifted));
        return planned(needed, threading, plan);
    }
    let rows = Alike::picks_of(pattern);
    let (pressed, most) = (rows.first.len(), loom.treadles.min(MAX_SHAFTS) as usize);
    let rows_up = || rows.first.iter().map(|&pick| lifted(pick));
    if pressed <= most {
        let tieup = Ties::from_rows(rows_up());
        return treadled(needed, tieup, threading, rows.ties());
    }
    if loom.dobby {
        let known: Vec<Vec<u16>> = rows_up().collect();
        let plan = Ties::from_rows(rows.of.iter().map(|&row| &known[row as usize]));
        return planned(needed, threading, plan);
    }
    let too_few = |needed: usize| DeriveError::Treadles {
        needed: needed as u32,
        treadles: loom.treadles,
    };
    let words = (needed as usize).div_ceil(64);
    if pressed.saturating_mul(pressed).saturating_mul(words) > MOST_COMPARED {
        return Err(too_few(pressed));
    }
    let (tieup, together) = unions(rows_up().collect(), needed);
    if tieup.len() > most {
        return Err(too_few(tieup.len()));
    }
    let treadling = Ties::from_rows(rows.of.iter().map(|&row| together.row(row as usize)));
    treadled(needed, tieup, threading, treadling)
}

/// Shafts that a drawdown needs: its different columns.
pub fn shafts_needed(pattern: &WeavePattern) -> u32 {
    Alike::picks_of(&pattern.transposed()).first.len() as u32
}

fn planned(shafts: u32, threading: Ties, plan: Ties) -> Result<Draft, DeriveError> {
    let lifting = Lifting::LiftPlan(plan);
    Ok(Draft::new(
        shafts,
        shafts,
        Shed::Rising,
        threading,
        lifting,
    )?)
}

fn treadled(
    shafts: u32,
    tieup: Ties,
    threading: Ties,
    treadling: Ties,
) -> Result<Draft, DeriveError> {
    let treadles = tieup.len() as u32;
    let lifting = Lifting::Treadled { tieup, treadling };
    Ok(Draft::new(
        shafts,
        treadles,
        Shed::Rising,
        threading,
        lifting,
    )?)
}

/// Threads that are alike, numbered in the order of their first appearance.
struct Alike {
    /// The number of each thread.
    of: Vec<u32>,
    /// The first thread of each number.
    first: Vec<u32>,
}

impl Alike {
    /// The picks of a pattern, by whole words.
    fn picks_of(pattern: &WeavePattern) -> Self {
        let mut known: HashMap<Box<[u64]>, u32> = HashMap::new();
        let mut row = vec![0u64; pattern.words_per_pick() as usize];
        let mut of = Vec::with_capacity(pattern.picks() as usize);
        let mut first = Vec::new();
        for pick in 0..pattern.picks() {
            for (word, bits) in row.iter_mut().zip(pattern.pick_words(pick)) {
                *word = bits;
            }
            let number = match known.get(row.as_slice()) {
                Some(&number) => number,
                None => {
                    let number = first.len() as u32;
                    known.insert(row.as_slice().into(), number);
                    first.push(pick);
                    number
                }
            };
            of.push(number);
        }
        Self { of, first }
    }

    /// Each thread on its number; there are at most [`MAX_SHAFTS`] of them.
    fn ties(&self) -> Ties {
        let mut ties = Ties::with_room(self.of.len(), self.of.len());
        for &number in &self.of {
            ties.push(&[number as u16]);
        }
        ties
    }
}

/// The rows that are no union of others, and for each row those of them that make it.
fn unions(rows: Vec<Vec<u16>>, shafts: u32) -> (Ties, Ties) {
    let words = (shafts as usize).div_ceil(64);
    let bits: Vec<Vec<u64>> = rows
        .iter()
        .map(|row| {
            let mut bits = vec![0u64; words];
            for &shaft in row {
                bits[usize::from(shaft) / 64] |= 1 << (shaft % 64);
            }
            bits
        })
        .collect();
    let within = |part: &[u64], whole: &[u64]| part.iter().zip(whole).all(|(p, w)| p & !w == 0);
    let join = |part: &[u64], whole: &mut [u64]| {
        for (whole, part) in whole.iter_mut().zip(part) {
            *whole |= part;
        }
    };
    let mut own = Vec::new();
    let mut tieup = Ties::default();
    for (index, whole) in bits.iter().enumerate() {
        let mut made = vec![0u64; words];
        for (other, part) in bits.iter().enumerate() {
            if other != index && within(part, whole) {
                join(part, &mut made);
            }
        }
        if made != *whole {
            own.push(index);
            tieup.push(&rows[index]);
        }
    }
    // Long rows first: few treadles for each pick.
    let mut by_length: Vec<u16> = (0..own.len() as u16).collect();
    by_length.sort_by_key(|&treadle| std::cmp::Reverse(rows[own[usize::from(treadle)]].len()));
    let mut together = Ties::default();
    let mut pressed = Vec::new();
    for whole in &bits {
        pressed.clear();
        let mut made = vec![0u64; words];
        for &treadle in &by_length {
            let part = &bits[own[usize::from(treadle)]];
            if within(part, whole) && !within(part, &made) {
                join(part, &mut made);
                pressed.push(treadle);
            }
        }
        together.push(&pressed);
    }
    (tieup, together)
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::super::weave;
    use super::*;

    const FLOOR: Loom = Loom {
        shafts: 8,
        treadles: 10,
        dobby: false,
    };

    #[test]
    fn a_twill_is_straight_on_four() {
        let twill = weave("2/2 twill").unwrap();
        let draft = derive(&twill, &FLOOR).unwrap();
        assert_eq!((draft.shafts(), draft.treadles()), (4, 4));
        assert_eq!(draft.threading(), &Ties::from_rows([[0], [1], [2], [3]]));
        assert_eq!(draft.drawdown(), twill);
        assert_ne!(draft.drawdown(), twill.inverted());
    }

    #[test]
    fn a_loom_that_is_too_small_says_what_it_lacks() {
        let satin = weave("1/26 satin move 5").unwrap();
        let message = derive(&satin, &FLOOR).unwrap_err().to_string();
        assert_eq!(
            message,
            "the weave needs 27 shafts; the loom has 8: weave it as a jacquard"
        );
        // Two shafts and no treadles.
        let plain = weave("plain").unwrap();
        let none = Loom {
            treadles: 1,
            ..FLOOR
        };
        let message = derive(&plain, &none).unwrap_err().to_string();
        assert!(
            message.contains("needs 2 treadles; the loom has 1"),
            "{message}"
        );
        let dobby = derive(&plain, &Loom::dobby(2)).unwrap();
        assert!(matches!(dobby.lifting(), Lifting::LiftPlan(_)));
        assert_eq!(dobby.drawdown(), plain);
    }

    #[test]
    fn idle_threads_hang_on_a_shaft_and_a_treadle_of_their_own() {
        let pattern = WeavePattern::parse("#..#\n....\n#.##").unwrap();
        let draft = derive(&pattern, &FLOOR).unwrap();
        assert_eq!((draft.shafts(), draft.treadles()), (3, 3));
        assert_eq!(draft.threading(), &Ties::from_rows([[0], [1], [2], [0]]));
        assert_eq!(draft.drawdown(), pattern);
    }

    #[test]
    fn rows_that_are_unions_need_no_treadle() {
        // Five rows on three shafts; the last two are joins of the first three.
        let pattern = WeavePattern::parse("...\n##.\n###\n..#\n.#.\n#..").unwrap();
        let loom = |treadles| Loom { treadles, ..FLOOR };
        let apart = derive(&pattern, &loom(6)).unwrap();
        assert_eq!(apart.treadles(), 6);
        let together = derive(&pattern, &loom(3)).unwrap();
        assert_eq!(together.treadles(), 3);
        assert_eq!(together.drawdown(), pattern);
        assert!(derive(&pattern, &loom(2)).is_err());
    }

    #[test]
    fn a_lift_plan_of_the_drawdown_weaves_the_same_cloth() {
        let pattern = WeavePattern::from_fn(150, 90, |end, pick| {
            (end * end + 3 * pick + end * pick) % 7 < 3
        });
        let draft = derive(&pattern, &Loom::dobby(MAX_SHAFTS)).unwrap();
        assert_eq!(draft.drawdown(), pattern);
        let mut other = pattern.clone();
        other.set(149, 89, !pattern.get(149, 89));
        assert_ne!(draft.drawdown(), other);
    }
}
