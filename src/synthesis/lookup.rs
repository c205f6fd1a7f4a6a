//! From a crossing of the endless cloth to its block, its neighbours and its seams.

use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hash, Hasher};

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::job::Job;

use super::SynthesisError;
use super::assign::Assignment;
use super::catalogue::{Catalogue, Side};
use super::edges::EdgeFix;
use super::heights::{EdgeHeights, Face};
use super::shift::Randomisation;

/// A block of one exemplar set.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct BlockRef {
    /// Index of the exemplar set.
    pub set: u16,
    /// Block id in the catalogue.
    pub block: u16,
}

/// A block and what stands on its four sides; `None` where the cloth ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Neighbourhood {
    /// The block in the middle.
    pub centre: BlockRef,
    /// Neighbours in the order of [`Side::ALL`]: left, right, below, above.
    pub sides: [Option<BlockRef>; 4],
}

/// A block before and after randomisation.
#[derive(Debug, Clone, Copy)]
pub(super) struct Shown {
    pub assigned: u16,
    pub shown: u16,
}

/// An assignment with its randomisation: what is finally shown where.
#[derive(Clone, Copy)]
pub struct Placement<'a> {
    /// The exemplars' weaves.
    pub catalogue: &'a Catalogue,
    /// The block of every crossing of the design.
    pub assignment: &'a Assignment,
    /// The shifts of patches.
    pub randomisation: Randomisation,
}

impl Placement<'_> {
    /// The block shown at a crossing of the endless cloth; `None` where there is no cloth.
    #[inline]
    pub fn block(&self, end: i64, pick: i64) -> Option<u16> {
        let block = self.assignment.at(end, pick)?;
        Some(self.randomisation.apply(self.catalogue, block, end, pick))
    }

    /// The blocks of one end of the cloth at picks 0 to `picks` of the design, that is one
    /// more than it has: as assigned and as shown. `None` where there is no cloth.
    pub(super) fn column(&self, end: i64, column: &mut Vec<Option<Shown>>) {
        column.clear();
        let mut patch = self.randomisation.patches_of(end);
        column.extend((0..=i64::from(self.assignment.picks())).map(|pick| {
            let assigned = self.assignment.at(end, pick)?;
            let shown = patch.apply(self.catalogue, assigned, pick);
            Some(Shown { assigned, shown })
        }));
    }

    /// The block shown at a crossing and its four neighbours; `set_at(end, pick)` is the
    /// exemplar set of a crossing of the cloth.
    #[inline]
    pub fn neighbourhood(
        &self,
        end: i64,
        pick: i64,
        set_at: impl Fn(i64, i64) -> u16,
    ) -> Option<Neighbourhood> {
        let at = |end: i64, pick: i64| {
            let block = self.block(end, pick)?;
            let set = set_at(end, pick);
            Some(BlockRef { set, block })
        };
        Some(Neighbourhood {
            centre: at(end, pick)?,
            sides: Side::ALL.map(|side| {
                let (dx, dy) = side.offset();
                at(end + dx, pick + dy)
            }),
        })
    }

    /// Root mean square of the jumps in height at all seams of one repeat of the design,
    /// before and after edge fixing, both faces together, in voxels.
    ///
    /// A seam is an edge between blocks that do not continue each other. Corners, where
    /// four blocks meet, are left out. `rise` is how much a voxel is higher than it is long
    /// along x and along y.
    ///
    /// # Errors
    /// When the job is cancelled.
    pub fn seam_rms(
        &self,
        edge_fix: &EdgeFix,
        heights: &[EdgeHeights],
        set_at: impl Fn(i64, i64) -> u16 + Sync,
        rise: [f32; 2],
        job: &Job,
    ) -> Result<SeamRms, SynthesisError> {
        let seams = self.count_seams(edge_fix, &set_at, job)?;
        let jumps: Vec<[Jumps; 2]> = seams
            .par_iter()
            .map(|&(first, second, side, count)| {
                Face::ALL.map(|face| {
                    let mut jumps = Jumps::default();
                    jumps.add_seam(edge_fix, heights, (first, second), side, face);
                    jumps.times(count)
                })
            })
            .collect();
        let total = |faces: &[usize]| {
            let mut sum = Jumps::default();
            for pair in &jumps {
                for &face in faces {
                    sum = sum.plus(pair[face]);
                }
            }
            sum.rms()
        };
        let [(front_before, front_after), (back_before, back_after)] = [total(&[0]), total(&[1])];
        let (before, after) = total(&[0, 1]);
        let mut kinks = Jumps::default();
        for &(first, second, side, count) in &seams {
            let mut own = Jumps::default();
            own.add_kinks(
                edge_fix,
                self.catalogue,
                heights,
                (first, second),
                side,
                rise,
            );
            kinks = kinks.plus(own.times(count));
        }
        let (kinks_before, kinks_after) = kinks.rms();
        Ok(SeamRms {
            kinks: [kinks_before, kinks_after].map(|kink| kink.atan().to_degrees()),
            before,
            after,
            front: [front_before, front_after],
            back: [back_before, back_after],
            seams: seams.iter().map(|seam| seam.3).sum(),
        })
    }

    /// Every pair of blocks that meets at a seam, with its side and count, in order.
    fn count_seams(
        &self,
        edge_fix: &EdgeFix,
        set_at: &(impl Fn(i64, i64) -> u16 + Sync),
        job: &Job,
    ) -> Result<Vec<(BlockRef, BlockRef, Side, u64)>, SynthesisError> {
        let ends: Vec<i64> = (0..i64::from(self.assignment.ends())).collect();
        let share = ends.len().div_ceil(4 * rayon::current_num_threads());
        let counts = ends
            .par_chunks(share.max(1))
            .map(|ends| {
                let mut counts = SeamCounts::default();
                let (mut here, mut right) = (Vec::new(), Vec::new());
                for &end in ends {
                    job.check()?;
                    if right.is_empty() {
                        self.column(end, &mut right);
                    }
                    std::mem::swap(&mut here, &mut right);
                    self.column(end + 1, &mut right);
                    let set_at = |side: i64, pick: usize| set_at(end + side, pick as i64);
                    count_column(edge_fix, &here, &right, set_at, &mut counts);
                }
                Ok::<_, SynthesisError>(counts)
            })
            .try_reduce(SeamCounts::default, |mut counts, others| {
                // Whole numbers add up to the same in any order.
                others.into_iter().for_each(|(seam, count)| {
                    *counts.entry(seam).or_insert(0) += count;
                });
                Ok(counts)
            })?;
        let mut list: Vec<_> = counts.into_iter().collect();
        list.sort_unstable_by_key(|&(seam, _)| seam);
        Ok(list
            .into_iter()
            .map(|(seam, count)| (seam.first, seam.second, Side::ALL[seam.side], count))
            .collect())
    }
}

/// Counts the seams of one end with the end to the right and along itself.
fn count_column(
    edge_fix: &EdgeFix,
    here: &[Option<Shown>],
    right: &[Option<Shown>],
    set_at: impl Fn(i64, usize) -> u16,
    counts: &mut SeamCounts,
) {
    for pick in 0..here.len().saturating_sub(1) {
        let at = |step: i64, column: &[Option<Shown>], pick: usize| {
            let block = column[pick]?.shown;
            let set = set_at(step, pick);
            Some(BlockRef { set, block })
        };
        let Some(first) = at(0, here, pick) else {
            continue;
        };
        let beside = [
            (Side::Right, at(1, right, pick)),
            (Side::Above, at(0, here, pick + 1)),
        ];
        for (side, second) in beside {
            let Some(second) = second else { continue };
            if !edge_fix.continues(first, side, second) {
                let side = side.index();
                *counts
                    .entry(Seam {
                        first,
                        second,
                        side,
                    })
                    .or_insert(0) += 1;
            }
        }
    }
}

/// Two blocks that meet at a side of the first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Seam {
    first: BlockRef,
    second: BlockRef,
    side: usize,
}

impl Hash for Seam {
    fn hash<H: Hasher>(&self, state: &mut H) {
        let word = |block: BlockRef| u64::from(block.set) << 16 | u64::from(block.block);
        state.write_u64(word(self.first) << 32 | word(self.second));
        state.write_u64(self.side as u64);
    }
}

type SeamCounts = HashMap<Seam, u64, BuildHasherDefault<Multiplying>>;

/// A hasher for words that nobody chooses to collide.
#[derive(Default)]
struct Multiplying(u64);

impl Hasher for Multiplying {
    fn finish(&self) -> u64 {
        self.0 ^ self.0 >> 32
    }

    fn write(&mut self, bytes: &[u8]) {
        bytes
            .iter()
            .for_each(|&byte| self.write_u64(u64::from(byte)));
    }

    fn write_u64(&mut self, word: u64) {
        self.0 = (self.0.rotate_left(5) ^ word).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    }
}

/// Jumps in height at the seams, root mean square, in voxels.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct SeamRms {
    /// Without edge fixing, both faces.
    pub before: f64,
    /// With edge fixing, both faces.
    pub after: f64,
    /// Before and after on the front.
    pub front: [f64; 2],
    /// Before and after on the back.
    pub back: [f64; 2],
    /// By how much the yarns that are seen to run across seams bend there, before and after
    /// edge fixing: root mean square, degrees.
    #[serde(default)]
    pub kinks: [f64; 2],
    /// Number of seams.
    pub seams: u64,
}

/// Sums of squared jumps.
#[derive(Debug, Clone, Copy, Default)]
struct Jumps {
    before: f64,
    after: f64,
    stacks: f64,
}

impl Jumps {
    fn add_seam(
        &mut self,
        edge_fix: &EdgeFix,
        heights: &[EdgeHeights],
        (first, second): (BlockRef, BlockRef),
        side: Side,
        face: Face,
    ) {
        let own = heights[usize::from(first.set)].profile(face, first.block, side);
        let other = heights[usize::from(second.set)].profile(face, second.block, side.opposite());
        let shift = edge_fix.seam_profile(first, side, second, face);
        let inner = 1..own.len().max(2) - 1;
        for at in inner {
            let jump = f64::from(other[at]) - f64::from(own[at]);
            // One side rises by the shift, the other sinks by it.
            let left = jump - 2.0 * f64::from(shift[at]);
            self.before += jump * jump;
            self.after += left * left;
            self.stacks += 1.0;
        }
    }

    /// Bends of the crowns that run across a seam, on both faces.
    fn add_kinks(
        &mut self,
        edge_fix: &EdgeFix,
        catalogue: &Catalogue,
        heights: &[EdgeHeights],
        (first, second): (BlockRef, BlockRef),
        side: Side,
        rise: [f32; 2],
    ) {
        let rise = rise[usize::from(matches!(side, Side::Below | Side::Above))];
        for face in Face::ALL {
            let runs_on = catalogue.runs_on(first.block, side, face)
                && catalogue.runs_on(second.block, side.opposite(), face);
            if !runs_on {
                continue;
            }
            let slope = |block: BlockRef, side: Side| {
                let crown = heights[usize::from(block.set)].crown(face, block.block, side);
                crown.slope * rise
            };
            let before = slope(second, side.opposite()) - slope(first, side);
            let bent = edge_fix.seam_slope(second, side.opposite(), first, face)
                - edge_fix.seam_slope(first, side, second, face);
            let after = before + bent * rise;
            self.before += f64::from(before).powi(2);
            self.after += f64::from(after).powi(2);
            self.stacks += 1.0;
        }
    }

    fn times(self, count: u64) -> Self {
        let count = count as f64;
        Self {
            before: self.before * count,
            after: self.after * count,
            stacks: self.stacks * count,
        }
    }

    fn plus(self, other: Self) -> Self {
        Self {
            before: self.before + other.before,
            after: self.after + other.after,
            stacks: self.stacks + other.stacks,
        }
    }

    fn rms(self) -> (f64, f64) {
        let stacks = self.stacks.max(1.0);
        ((self.before / stacks).sqrt(), (self.after / stacks).sqrt())
    }
}
