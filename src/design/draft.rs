//! Shaft drafts: threading, tie-up, treadling or lift plan, and the cloth they weave.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::pattern::{SizeError, WeavePattern, check_size};

/// Which shafts each end is on, or which treadles each pick uses: a list of small sets.
///
/// Sets are kept sorted, without repetition and all in one allocation, so that a draft of
/// 5120 ends and 6300 picks stays small. Shafts and treadles count from 0 here; files and
/// weavers count from 1.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Ties {
    /// `members[starts[i]..starts[i + 1]]` is set i.
    starts: Vec<u32>,
    members: Vec<u16>,
}

/// The most shafts or treadles a draft can have.
pub const MAX_SHAFTS: u32 = crate::limits::SHAFTS;

impl Ties {
    /// The sets in order, each sorted and freed of repetitions.
    pub fn from_rows<Row: AsRef<[u16]>>(rows: impl IntoIterator<Item = Row>) -> Self {
        let mut ties = Self::default();
        for row in rows {
            ties.push(row.as_ref());
        }
        ties
    }

    /// Reads sets as weavers write them, counted from 1: `1 2 3,4 -` (`-` = none).
    ///
    /// # Errors
    /// What was expected and what was found.
    pub fn parse(text: &str) -> Result<Self, String> {
        let mut ties = Self::default();
        let mut set = Vec::new();
        for word in text.split_whitespace() {
            set.clear();
            for member in word.split(',').filter(|_| word != "-") {
                match member.parse::<u16>() {
                    Ok(member) if member > 0 => set.push(member - 1),
                    _ => {
                        let word: String = word.chars().take(40).collect();
                        return Err(format!("expected numbers from 1 or -, found \"{word}\""));
                    }
                }
            }
            ties.push(&set);
        }
        Ok(ties)
    }

    /// No sets yet, but room for `sets` with `members` in all.
    pub fn with_room(sets: usize, members: usize) -> Self {
        Self {
            starts: Vec::with_capacity(sets + 1),
            members: Vec::with_capacity(members),
        }
    }

    /// One set more at the end.
    pub fn push(&mut self, row: &[u16]) {
        if self.starts.is_empty() {
            self.starts.push(0);
        }
        let first = self.members.len();
        self.members.extend_from_slice(row);
        self.members[first..].sort_unstable();
        let mut kept = first;
        for next in first..self.members.len() {
            if next == first || self.members[next] != self.members[kept - 1] {
                self.members[kept] = self.members[next];
                kept += 1;
            }
        }
        self.members.truncate(kept);
        self.starts.push(self.members.len() as u32);
    }

    /// Number of sets.
    pub fn len(&self) -> usize {
        self.starts.len().saturating_sub(1)
    }

    /// Whether there are no sets at all.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Set `index`, sorted; empty beyond the last.
    pub fn row(&self, index: usize) -> &[u16] {
        match (self.starts.get(index), self.starts.get(index + 1)) {
            (Some(&from), Some(&to)) => &self.members[from as usize..to as usize],
            _ => &[],
        }
    }

    /// All sets in order.
    pub fn iter(&self) -> impl Iterator<Item = &[u16]> {
        (0..self.len()).map(|index| self.row(index))
    }

    /// The largest number in any set, plus one.
    pub fn bound(&self) -> u32 {
        self.members
            .iter()
            .max()
            .map_or(0, |&most| u32::from(most) + 1)
    }

    /// The same sets, with other ones at some places (place, set); the last of several for
    /// one place counts, and places beyond the last set are ignored.
    pub fn with_rows(&self, changes: &[(u32, Vec<u16>)]) -> Self {
        let changes: BTreeMap<usize, &[u16]> = changes
            .iter()
            .map(|(place, set)| (*place as usize, set.as_slice()))
            .collect();
        let mut ties = Self::with_room(self.len(), self.members.len());
        for (place, row) in self.iter().enumerate() {
            ties.push(changes.get(&place).copied().unwrap_or(row));
        }
        ties
    }

    /// Bytes of memory.
    fn bytes(&self) -> usize {
        4 * self.starts.capacity() + 2 * self.members.capacity()
    }

    /// Members of all sets together.
    pub fn total(&self) -> usize {
        self.members.len()
    }
}

/// Whether the shafts that a pick names go up or down.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Shed {
    /// Named shafts rise: their ends come to the face.
    #[default]
    Rising,
    /// Named shafts sink: all other ends come to the face.
    Sinking,
}

/// How the shafts of each pick are chosen.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Lifting {
    /// Treadles tied to shafts, and the treadles pressed for each pick.
    Treadled {
        /// Shafts tied to each treadle.
        tieup: Ties,
        /// Treadles pressed for each pick.
        treadling: Ties,
    },
    /// Shafts named directly for each pick (dobby peg plan).
    LiftPlan(Ties),
}

/// A draft that cannot be woven.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum DraftError {
    /// No ends, no picks, or too many crossings.
    #[error(transparent)]
    Size(#[from] SizeError),
    /// More shafts or treadles than can be numbered.
    #[error(
        "{0} shafts or treadles are too many (the most is {MAX_SHAFTS}): draw the weave itself"
    )]
    TooMany(u32),
    /// A shaft that the loom does not have.
    #[error("the {place} names shaft {shaft}, but the draft has {shafts} shafts: add shafts")]
    Shaft {
        /// Which part of the draft.
        place: &'static str,
        /// The shaft, counted from 1.
        shaft: u32,
        /// Shafts of the draft.
        shafts: u32,
    },
    /// A treadle that the loom does not have.
    #[error("the treadling names treadle {treadle}, but the draft has {treadles}: tie it up")]
    Treadle {
        /// The treadle, counted from 1.
        treadle: u32,
        /// Treadles of the draft.
        treadles: u32,
    },
}

/// A shaft draft: what a hand weaver writes instead of the drawdown.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Draft {
    shafts: u32,
    treadles: u32,
    shed: Shed,
    threading: Ties,
    lifting: Lifting,
}

impl Draft {
    /// A draft of `shafts` shafts: the shafts of each end, how picks lift, which shed.
    ///
    /// # Errors
    /// [`DraftError`] for an empty or too large drawdown and for shafts or treadles
    /// beyond those there are.
    pub fn new(
        shafts: u32,
        treadles: u32,
        shed: Shed,
        threading: Ties,
        lifting: Lifting,
    ) -> Result<Self, DraftError> {
        let draft = Self {
            shafts,
            treadles,
            shed,
            threading,
            lifting,
        };
        check_size(draft.threading.len() as u64, draft.lifts().len() as u64)?;
        if shafts.max(treadles) > MAX_SHAFTS {
            return Err(DraftError::TooMany(shafts.max(treadles)));
        }
        let within = |place, bound: u32| {
            if bound > shafts {
                let shaft = bound;
                return Err(DraftError::Shaft {
                    place,
                    shaft,
                    shafts,
                });
            }
            Ok(())
        };
        within("threading", draft.threading.bound())?;
        match &draft.lifting {
            Lifting::LiftPlan(plan) => within("lift plan", plan.bound())?,
            Lifting::Treadled { tieup, treadling } => {
                within("tie-up", tieup.bound())?;
                let treadle = treadling.bound();
                if treadle > treadles || tieup.len() > treadles as usize {
                    let treadle = treadle.max(tieup.len() as u32);
                    return Err(DraftError::Treadle { treadle, treadles });
                }
            }
        }
        Ok(draft)
    }

    fn lifts(&self) -> &Ties {
        match &self.lifting {
            Lifting::Treadled { treadling, .. } => treadling,
            Lifting::LiftPlan(plan) => plan,
        }
    }

    /// Number of ends.
    pub fn ends(&self) -> u32 {
        self.threading.len() as u32
    }

    /// Number of picks.
    pub fn picks(&self) -> u32 {
        self.lifts().len() as u32
    }

    /// Number of shafts.
    pub fn shafts(&self) -> u32 {
        self.shafts
    }

    /// Number of treadles.
    pub fn treadles(&self) -> u32 {
        self.treadles
    }

    /// Whether named shafts rise or sink.
    pub fn shed(&self) -> Shed {
        self.shed
    }

    /// The shafts each end is threaded on.
    pub fn threading(&self) -> &Ties {
        &self.threading
    }

    /// Tie-up and treadling, or the lift plan.
    pub fn lifting(&self) -> &Lifting {
        &self.lifting
    }

    /// The shafts each pick names, whichever way the draft says it.
    pub fn lift_plan(&self) -> Ties {
        match &self.lifting {
            Lifting::LiftPlan(plan) => plan.clone(),
            Lifting::Treadled { tieup, treadling } => {
                let mut shafts = Vec::new();
                let mut plan = Ties::default();
                for treadles in treadling.iter() {
                    shafts.clear();
                    for &treadle in treadles {
                        shafts.extend_from_slice(tieup.row(usize::from(treadle)));
                    }
                    plan.push(&shafts);
                }
                plan
            }
        }
    }

    /// The cloth this draft weaves.
    ///
    /// An end is named if one of its shafts is. With a rising shed named ends are up, with
    /// a sinking shed all others are; so an end on no shaft stays down in the one and up in
    /// the other. Picks that lift alike are worked out once.
    pub fn drawdown(&self) -> WeavePattern {
        let mut pattern = WeavePattern::new(self.ends(), self.picks());
        self.weave_picks(0..self.picks(), &mut pattern);
        pattern
    }

    /// Weaves some picks into a drawdown of the draft's size; what is the same already
    /// stays shared with clones.
    pub(crate) fn weave_picks(
        &self,
        picks: impl IntoIterator<Item = u32>,
        pattern: &mut WeavePattern,
    ) {
        let words = pattern.words_per_pick() as usize;
        let shafts = ShaftEnds::new(&self.threading, self.shafts as usize, words);
        let treadles = match &self.lifting {
            Lifting::LiftPlan(_) => Vec::new(),
            Lifting::Treadled { tieup, .. } => shafts.treadle_rows(tieup, words),
        };
        let mut known: BTreeMap<&[u16], u32> = BTreeMap::new();
        let mut row = vec![0u64; words];
        for pick in picks {
            let named = self.lifts().row(pick as usize);
            if let Some(&same) = known.get(named) {
                for word in 0..words as u32 {
                    let bits = pattern.pick_word(word, same);
                    pattern.set_pick_word(word, pick, bits);
                }
                continue;
            }
            row.fill(0);
            match &self.lifting {
                Lifting::LiftPlan(_) => shafts.raise(named, &mut row),
                Lifting::Treadled { tieup, .. } => {
                    for &treadle in named {
                        let treadle = usize::from(treadle);
                        match treadles.get(treadle) {
                            Some(known) if !known.is_empty() => join(known, &mut row),
                            _ => shafts.raise(tieup.row(treadle), &mut row),
                        }
                    }
                }
            }
            for (word, &bits) in row.iter().enumerate() {
                let up = match self.shed {
                    Shed::Rising => bits,
                    Shed::Sinking => !bits,
                };
                pattern.set_pick_word(word as u32, pick, up);
            }
            known.insert(named, pick);
        }
    }

    /// Bytes of memory.
    pub(super) fn bytes(&self) -> usize {
        let lifting = match &self.lifting {
            Lifting::Treadled { tieup, treadling } => tieup.bytes() + treadling.bytes(),
            Lifting::LiftPlan(plan) => plan.bytes(),
        };
        self.threading.bytes() + lifting
    }
}

/// The ends on each shaft, as a whole row of bits where there are many and as a list
/// where there are few.
struct ShaftEnds {
    /// `ends[starts[i]..starts[i + 1]]` are on shaft i.
    starts: Vec<u32>,
    ends: Vec<u32>,
    /// Row of bits of each dense shaft; empty for sparse ones.
    rows: Vec<Vec<u64>>,
}

impl ShaftEnds {
    fn new(threading: &Ties, shafts: usize, words: usize) -> Self {
        // Counting sort: how many ends a shaft has, where its list starts, then the ends.
        let mut starts = vec![0u32; shafts + 1];
        for &shaft in &threading.members {
            starts[usize::from(shaft) + 1] += 1;
        }
        for shaft in 0..shafts {
            starts[shaft + 1] += starts[shaft];
        }
        let mut next = starts.clone();
        let mut ends = vec![0u32; threading.members.len()];
        for (end, on) in threading.iter().enumerate() {
            for &shaft in on {
                let place = &mut next[usize::from(shaft)];
                ends[*place as usize] = end as u32;
                *place += 1;
            }
        }
        let mut found = Self {
            starts,
            ends,
            rows: Vec::new(),
        };
        found.rows = (0..shafts)
            .map(|shaft| {
                let list = found.list(shaft);
                if list.len() <= 2 * words {
                    return Vec::new();
                }
                let mut row = vec![0u64; words];
                set_bits(list, &mut row);
                row
            })
            .collect();
        found
    }

    fn list(&self, shaft: usize) -> &[u32] {
        match (self.starts.get(shaft), self.starts.get(shaft + 1)) {
            (Some(&from), Some(&to)) => &self.ends[from as usize..to as usize],
            _ => &[],
        }
    }

    fn raise(&self, named: &[u16], row: &mut [u64]) {
        for &shaft in named {
            let shaft = usize::from(shaft);
            match self.rows.get(shaft) {
                Some(dense) if !dense.is_empty() => join(dense, row),
                _ => set_bits(self.list(shaft), row),
            }
        }
    }

    /// The ends each treadle names, for treadles tied to more shafts than a row has words;
    /// empty for others. Together they hold no more words than the tie-up has ties.
    fn treadle_rows(&self, tieup: &Ties, words: usize) -> Vec<Vec<u64>> {
        tieup
            .iter()
            .map(|tied| {
                if tied.len() <= words {
                    return Vec::new();
                }
                let mut row = vec![0u64; words];
                self.raise(tied, &mut row);
                row
            })
            .collect()
    }
}

fn join(bits: &[u64], row: &mut [u64]) {
    for (word, bits) in row.iter_mut().zip(bits) {
        *word |= bits;
    }
}

fn set_bits(ends: &[u32], row: &mut [u64]) {
    for &end in ends {
        row[(end / 64) as usize] |= 1 << (end % 64);
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;

    fn two_two_twill(shed: Shed) -> Draft {
        Draft::new(
            4,
            4,
            shed,
            Ties::from_rows([[0], [1], [2], [3]]),
            Lifting::Treadled {
                tieup: Ties::from_rows([[0, 1], [1, 2], [2, 3], [0, 3]]),
                treadling: Ties::from_rows([[0], [1], [2], [3]]),
            },
        )
        .unwrap()
    }

    #[test]
    fn a_straight_draft_weaves_its_tie_up() {
        let art = "#..#\n..##\n.##.\n##..\n";
        assert_eq!(two_two_twill(Shed::Rising).drawdown().to_string(), art);
    }

    #[test]
    fn a_sinking_shed_shows_the_other_face() {
        let rising = two_two_twill(Shed::Rising).drawdown();
        let sinking = two_two_twill(Shed::Sinking).drawdown();
        assert_eq!(sinking, rising.inverted());
        assert_ne!(sinking, rising);
    }

    #[test]
    fn several_treadles_and_several_shafts_are_joined() {
        let draft = Draft::new(
            3,
            2,
            Shed::Rising,
            Ties::from_rows([vec![0], vec![0, 2], vec![], vec![2, 2]]),
            Lifting::Treadled {
                tieup: Ties::from_rows([vec![0], vec![1, 2]]),
                treadling: Ties::from_rows([vec![0], vec![1], vec![0, 1], vec![]]),
            },
        )
        .unwrap();
        assert_eq!(draft.drawdown().to_string(), "....\n##.#\n.#.#\n##..\n");
    }

    #[test]
    fn shafts_and_treadles_beyond_the_loom_are_refused() {
        let one = || Ties::from_rows([[0]]);
        let far = || Ties::from_rows([[7]]);
        let plan =
            |threading, plan| Draft::new(1, 1, Shed::Rising, threading, Lifting::LiftPlan(plan));
        assert!(plan(one(), one()).is_ok());
        let message = plan(far(), one()).unwrap_err().to_string();
        assert!(message.contains("threading names shaft 8"), "{message}");
        assert!(plan(one(), far()).is_err());
        assert!(plan(Ties::default(), one()).is_err());
    }
}
