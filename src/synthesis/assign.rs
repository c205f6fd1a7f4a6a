//! Which block every crossing of a design copies. Zhao 2012 §5.3 and §5.4.
//!
//! Comes in: a weave pattern, its lattice, a catalogue. Goes out: an [`Assignment`].
//! Every choice depends on the keys of one column and of the two beside it, hence on five
//! columns of the pattern: columns are worked out in parallel, an edit redoes five.

use std::borrow::Cow;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use strum::{Display, EnumMessage, EnumString, IntoStaticStr, VariantArray};

use crate::design::{Lattice, Repeat, WeavePattern};
use crate::job::Job;

use super::SynthesisError;
use super::catalogue::{Catalogue, NO_BLOCK, key_of};
use super::chain::{Column, Scratch, cover};
use super::hash::{hash, index_below};
use super::part::Stretch;

/// The most crossings of a design that is assigned whole (2²⁸, 512 MiB of blocks).
const MOST_WHOLE: u64 = 1 << 28;

/// How a block is chosen for each crossing, from crude to reference.
#[derive(
    Debug,
    Clone,
    Copy,
    PartialEq,
    Eq,
    Hash,
    Default,
    Serialize,
    Deserialize,
    Display,
    EnumString,
    EnumMessage,
    IntoStaticStr,
    VariantArray,
)]
#[strum(serialize_all = "kebab-case")]
pub enum Method {
    /// Any block with the right yarn on top.
    Naive,
    /// Any block with the most matching neighbours.
    Greedy,
    /// Of those, the ones that continue each other along the warp as often as possible.
    #[default]
    Dp,
}

/// The block each crossing of a design copies: two bytes a crossing, in columns that
/// clones share until they are edited. A column that was not asked for is empty.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Assignment {
    columns: Vec<Arc<[u16]>>,
    picks: u32,
    lattice: Lattice,
    method: Method,
    seed: u64,
}

/// Chooses a block for every crossing of `pattern`.
///
/// Correct wherever the catalogue allows it, then the most matching neighbours (both
/// exactly); [`Method::Dp`] then makes each column as continuous as can be (exactly).
/// The same input gives the same blocks for any number of threads.
///
/// # Errors
/// When the lattice is dropped in both directions, the pattern is larger than is assigned
/// whole (2²⁸ crossings), or the job is cancelled.
pub fn assign(
    pattern: &WeavePattern,
    lattice: Lattice,
    catalogue: &Catalogue,
    method: Method,
    seed: u64,
    job: &Job,
) -> Result<Assignment, SynthesisError> {
    let (ends, picks) = (pattern.ends(), pattern.picks());
    if u64::from(ends) * u64::from(picks) > MOST_WHOLE {
        return Err(SynthesisError::TooMany {
            ends,
            picks,
            most: MOST_WHOLE,
        });
    }
    let mut assignment = blank(pattern, lattice, method, seed)?;
    assignment.redo(pattern, catalogue, &vec![true; ends as usize], job)?;
    Ok(assignment)
}

/// Chooses a block for every crossing of the columns that lie in `stretch`: the blocks
/// that [`assign`] chooses for them. Elsewhere there is no cloth.
///
/// # Errors
/// As [`assign`]; of the pattern's size, the columns of the stretch alone count, see
/// [`Stretch::columns`].
pub fn assign_part(
    pattern: &WeavePattern,
    lattice: Lattice,
    catalogue: &Catalogue,
    (method, seed): (Method, u64),
    stretch: &Stretch,
    job: &Job,
) -> Result<Assignment, SynthesisError> {
    let mut assignment = blank(pattern, lattice, method, seed)?;
    assignment.look_at(pattern, catalogue, stretch, job)?;
    Ok(assignment)
}

/// An assignment of no column yet.
fn blank(
    pattern: &WeavePattern,
    lattice: Lattice,
    method: Method,
    seed: u64,
) -> Result<Assignment, SynthesisError> {
    check_lattice(lattice)?;
    let column: Arc<[u16]> = Arc::from([]);
    Ok(Assignment {
        columns: vec![column; pattern.ends() as usize],
        picks: pattern.picks(),
        lattice,
        method,
        seed,
    })
}

/// Refuses a lattice that is dropped in both directions: its neighbours are not mutual.
fn check_lattice(lattice: Lattice) -> Result<(), SynthesisError> {
    match (lattice.across, lattice.along) {
        (Repeat::Dropped(_), Repeat::Dropped(_)) => Err(SynthesisError::DroppedTwice),
        _ => Ok(()),
    }
}

impl Assignment {
    /// Number of ends of the design.
    pub fn ends(&self) -> u32 {
        self.columns.len() as u32
    }

    /// Number of picks of the design.
    pub fn picks(&self) -> u32 {
        self.picks
    }

    /// How the design repeats.
    pub fn lattice(&self) -> Lattice {
        self.lattice
    }

    /// How the blocks were chosen.
    pub fn method(&self) -> Method {
        self.method
    }

    /// The block of a crossing inside the design, in a column that is assigned.
    #[inline]
    pub fn block(&self, end: u32, pick: u32) -> u16 {
        self.columns[end as usize][pick as usize]
    }

    /// The blocks of one end, from pick 0 upwards; none where it is not assigned.
    pub fn column(&self, end: u32) -> &[u16] {
        &self.columns[end as usize]
    }

    /// The block of a crossing of the endless cloth, before randomisation; `None` where
    /// there is no cloth or its column is not assigned.
    #[inline]
    pub fn at(&self, end: i64, pick: i64) -> Option<u16> {
        // Most lookups fall inside the design and need no lattice.
        let inside = u32::try_from(end).ok().zip(u32::try_from(pick).ok());
        let inside = inside.filter(|&(end, pick)| end < self.ends() && pick < self.picks);
        let (end, pick) = match inside {
            Some(crossing) => crossing,
            None => self.lattice.wrap(end, pick, self.ends(), self.picks)?,
        };
        self.columns[end as usize].get(pick as usize).copied()
    }

    /// Bytes held by the blocks.
    pub fn bytes(&self) -> usize {
        let counts = 2 * size_of::<usize>();
        let column = |blocks: &Arc<[u16]>| match blocks.len() {
            0 => size_of::<Arc<[u16]>>(),
            picks => picks * size_of::<u16>() + counts + size_of::<Arc<[u16]>>(),
        };
        self.columns.iter().map(column).sum()
    }

    /// Assigns the columns of `stretch` that are not assigned yet, and forgets all others.
    ///
    /// # Errors
    /// When the stretch is too wide, the pattern has another size, or the job is cancelled;
    /// the assignment is then as it was.
    pub fn look_at(
        &mut self,
        pattern: &WeavePattern,
        catalogue: &Catalogue,
        stretch: &Stretch,
        job: &Job,
    ) -> Result<(), SynthesisError> {
        self.check_size(pattern)?;
        let wanted = stretch.columns(self.ends(), self.picks, self.lattice)?;
        let missing: Vec<bool> = (wanted.iter().zip(&self.columns))
            .map(|(&wanted, column)| wanted && column.is_empty())
            .collect();
        self.redo(pattern, catalogue, &missing, job)?;
        let none: Arc<[u16]> = Arc::from([]);
        for (column, wanted) in self.columns.iter_mut().zip(wanted) {
            if !wanted {
                *column = Arc::clone(&none);
            }
        }
        Ok(())
    }

    fn check_size(&self, pattern: &WeavePattern) -> Result<(), SynthesisError> {
        if (pattern.ends(), pattern.picks()) == (self.ends(), self.picks) {
            return Ok(());
        }
        Err(SynthesisError::SizeChanged {
            ends: pattern.ends(),
            picks: pattern.picks(),
            was_ends: self.ends(),
            was_picks: self.picks,
        })
    }

    /// Follows a change of `cells` that has led to `pattern`, and returns the ends whose
    /// columns were worked out again, in order.
    ///
    /// The result is bit for bit what [`assign`] makes of the new pattern. Work is done
    /// for the columns of the cells and their neighbours only; when the design is dropped
    /// along the warp, columns continue in each other and are redone together.
    ///
    /// # Errors
    /// When the pattern's size has changed, or the job is cancelled; the assignment is
    /// then as it was.
    pub fn edit(
        &mut self,
        pattern: &WeavePattern,
        catalogue: &Catalogue,
        cells: &[(u32, u32)],
        job: &Job,
    ) -> Result<Vec<u32>, SynthesisError> {
        self.check_size(pattern)?;
        let mut stale = vec![false; self.columns.len()];
        for &(end, pick) in cells {
            if end >= self.ends() || pick >= self.picks {
                continue;
            }
            for (dx, dy) in self.dependents() {
                let cell = (i64::from(end) + dx, i64::from(pick) + dy);
                let (end, _) = neighbour_cell(pattern, self.lattice, cell.0, cell.1);
                // What is not assigned has nothing to follow.
                stale[end as usize] = !self.columns[end as usize].is_empty();
            }
        }
        self.redo(pattern, catalogue, &stale, job)
    }

    /// Offsets to the crossings whose block looks at a crossing: a key reads its four
    /// neighbours, and the best chain also reads the keys to the left and right.
    fn dependents(&self) -> impl Iterator<Item = (i64, i64)> {
        let reach = if self.method == Method::Dp { 2 } else { 1 };
        (-1..=1).flat_map(move |dy: i64| {
            let across = reach - dy.abs();
            (-across..=across).map(move |dx| (dx, dy))
        })
    }

    /// Works out every chain of columns that holds a stale one.
    fn redo(
        &mut self,
        pattern: &WeavePattern,
        catalogue: &Catalogue,
        stale: &[bool],
        job: &Job,
    ) -> Result<Vec<u32>, SynthesisError> {
        let chains = stale_chains(self.lattice, pattern, stale);
        let keys = self.keys_for(pattern, &chains, job)?;
        let done = AtomicUsize::new(0);
        let rebuilt: Vec<Vec<Arc<[u16]>>> = chains
            .par_iter()
            .map_init(Scratch::default, |scratch, chain| {
                job.check()?;
                let columns = match self.method {
                    Method::Dp => self.best_chain(pattern, catalogue, chain, &keys, scratch),
                    Method::Naive | Method::Greedy => chain
                        .iter()
                        .map(|&end| self.independent_column(catalogue, end, &keys))
                        .collect(),
                };
                let done = done.fetch_add(1, Ordering::Relaxed) + 1;
                if done.is_multiple_of(64) {
                    job.report("synthesis", done as f32 / chains.len() as f32);
                }
                Ok(columns)
            })
            .collect::<Result<_, SynthesisError>>()?;
        let mut redone = Vec::new();
        for (chain, columns) in chains.iter().zip(rebuilt) {
            for (&end, column) in chain.iter().zip(columns) {
                self.columns[end as usize] = column;
                redone.push(end);
            }
        }
        redone.sort_unstable();
        Ok(redone)
    }

    /// The keys of all columns of the chains and of the columns beside them; empty for
    /// the others.
    fn keys_for(
        &self,
        pattern: &WeavePattern,
        chains: &[Vec<u32>],
        job: &Job,
    ) -> Result<Vec<Vec<u8>>, SynthesisError> {
        let ends = self.columns.len();
        let mut wanted = vec![false; ends];
        for &end in chains.iter().flatten() {
            let end = end as usize;
            wanted[end] = true;
            if self.method == Method::Dp {
                wanted[(end + 1) % ends] = true;
                wanted[(end + ends - 1) % ends] = true;
            }
        }
        wanted
            .par_iter()
            .enumerate()
            .map(|(end, &wanted)| {
                job.check()?;
                let mut keys = Vec::new();
                if wanted {
                    keys.reserve_exact(self.picks as usize);
                    column_keys(pattern, self.lattice, end as u32, &mut keys);
                }
                Ok(keys)
            })
            .collect()
    }

    /// The columns of a chain, as continuous along the warp as can be.
    fn best_chain(
        &self,
        pattern: &WeavePattern,
        catalogue: &Catalogue,
        chain: &[u32],
        keys: &[Vec<u8>],
        scratch: &mut Scratch,
    ) -> Vec<Arc<[u16]>> {
        let beside = |step: i64| move |end: u32| self.keys_beside(pattern, keys, end, step);
        let own = joined(chain, |end| Cow::Borrowed(&keys[end as usize]));
        let left = joined(chain, beside(-1));
        let right = joined(chain, beside(1));
        let column = Column {
            ends: chain,
            picks: self.picks as usize,
            keys: &own,
            left: &left,
            right: &right,
            cyclic: self.lattice.along != Repeat::None,
        };
        let mut blocks = Vec::new();
        cover(catalogue, &column, self.seed, scratch, &mut blocks);
        let columns = blocks.chunks_exact(self.picks as usize);
        columns.map(Arc::from).collect()
    }

    /// The keys of the crossings left (step −1) or right (step 1) of a column's.
    fn keys_beside<'a>(
        &self,
        pattern: &WeavePattern,
        keys: &'a [Vec<u8>],
        end: u32,
        step: i64,
    ) -> Cow<'a, [u8]> {
        let beside = i64::from(end) + step;
        let inside = (0..i64::from(self.ends())).contains(&beside);
        if inside || !matches!(self.lattice.across, Repeat::Dropped(_)) {
            let beside = beside.rem_euclid(i64::from(self.ends()));
            return Cow::Borrowed(&keys[beside as usize]);
        }
        // Past the border of a dropped repeat the column is the last or first one, turned.
        let picks = 0..i64::from(self.picks);
        let turned = picks.map(|pick| {
            let (end, pick) = neighbour_cell(pattern, self.lattice, beside, pick);
            keys[end as usize][pick as usize]
        });
        turned.collect()
    }

    /// A column whose crossings are chosen one by one, at random.
    fn independent_column(&self, catalogue: &Catalogue, end: u32, keys: &[Vec<u8>]) -> Arc<[u16]> {
        let choose = |(pick, &key): (usize, &u8)| {
            let list = match self.method {
                Method::Naive => catalogue.correct(key & 1 == 1),
                Method::Greedy | Method::Dp => catalogue.candidates(key),
            };
            let random = hash(self.seed, u64::from(end), pick as u64);
            list.get(index_below(random, list.len()))
                .copied()
                .unwrap_or(NO_BLOCK)
        };
        keys[end as usize].iter().enumerate().map(choose).collect()
    }
}

/// One list of keys for all columns of a chain.
fn joined<'a>(chain: &[u32], keys_of: impl Fn(u32) -> Cow<'a, [u8]>) -> Cow<'a, [u8]> {
    match chain {
        [end] => keys_of(*end),
        _ => chain
            .iter()
            .flat_map(|&end| keys_of(end).into_owned())
            .collect(),
    }
}

/// The cycles of columns that continue in each other along the warp and hold a stale
/// column, each from its leftmost column on.
fn stale_chains(lattice: Lattice, pattern: &WeavePattern, stale: &[bool]) -> Vec<Vec<u32>> {
    let (ends, picks) = (pattern.ends(), pattern.picks());
    let mut chains = Vec::new();
    let mut seen = vec![false; ends as usize];
    for first in 0..ends {
        if seen[first as usize] {
            continue;
        }
        let mut chain = Vec::with_capacity(1);
        let mut end = first;
        while !seen[end as usize] {
            seen[end as usize] = true;
            chain.push(end);
            let above = lattice.wrap(i64::from(end), i64::from(picks), ends, picks);
            end = above.map_or(first, |(end, _)| end);
        }
        if chain.iter().any(|&end| stale[end as usize]) {
            chains.push(chain);
        }
    }
    chains
}

/// The design's crossing that a neighbour's bit is read from.
///
/// Where the cloth ends there is no neighbour; the pattern is then read as if it went on
/// straight, because a key needs some bit and this one is the weave's own.
fn neighbour_cell(pattern: &WeavePattern, lattice: Lattice, end: i64, pick: i64) -> (u32, u32) {
    let endless = |repeat: Repeat| match repeat {
        Repeat::None => Repeat::Straight,
        other => other,
    };
    let lattice = Lattice {
        across: endless(lattice.across),
        along: endless(lattice.along),
    };
    let cell = lattice.wrap(end, pick, pattern.ends(), pattern.picks());
    cell.unwrap_or((0, 0))
}

/// Appends the keys of one end from pick 0 upwards.
pub(super) fn column_keys(pattern: &WeavePattern, lattice: Lattice, end: u32, keys: &mut Vec<u8>) {
    let picks = pattern.picks();
    let bit = |end: i64, pick: i64| {
        let (end, pick) = neighbour_cell(pattern, lattice, end, pick);
        pattern.get(end, pick)
    };
    // Inside the design a neighbour is an index away; only the border needs the lattice.
    let column = i64::from(end);
    let inside = end > 0 && end + 1 < pattern.ends();
    let sides = |pick: u32| {
        if inside {
            (pattern.get(end - 1, pick), pattern.get(end + 1, pick))
        } else {
            (
                bit(column - 1, i64::from(pick)),
                bit(column + 1, i64::from(pick)),
            )
        }
    };
    let mut below = bit(column, -1);
    let mut centre = pattern.get(end, 0);
    for pick in 0..picks {
        let above = if pick + 1 < picks {
            pattern.get(end, pick + 1)
        } else {
            bit(column, i64::from(picks))
        };
        let (left, right) = sides(pick);
        keys.push(key_of(centre, [left, right, below, above]));
        (below, centre) = (centre, above);
    }
}
