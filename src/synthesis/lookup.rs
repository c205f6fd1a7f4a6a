//! From a crossing of the endless cloth to its block, its neighbours and its seams.

use std::collections::HashMap;

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
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Neighbourhood {
    /// The block in the middle.
    pub centre: BlockRef,
    /// Neighbours in the order of [`Side::ALL`]: left, right, below, above.
    pub sides: [Option<BlockRef>; 4],
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
    /// four blocks meet, are left out.
    ///
    /// # Errors
    /// When the job is cancelled.
    pub fn seam_rms(
        &self,
        edge_fix: &EdgeFix,
        heights: &[EdgeHeights],
        set_at: impl Fn(i64, i64) -> u16 + Sync,
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
        Ok(SeamRms {
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
        let at = |end: i64, pick: i64| {
            let block = self.block(end, pick)?;
            let set = set_at(end, pick);
            Some(BlockRef { set, block })
        };
        let picks = i64::from(self.assignment.picks());
        let counts = (0..i64::from(self.assignment.ends()))
            .into_par_iter()
            .try_fold(SeamCounts::new, |mut counts, end| {
                job.check()?;
                let mut above = at(end, 0);
                for pick in 0..picks {
                    let here = above;
                    above = at(end, pick + 1);
                    for (side, other) in [(Side::Right, at(end + 1, pick)), (Side::Above, above)] {
                        let (Some(first), Some(second)) = (here, other) else {
                            continue;
                        };
                        if !edge_fix.continues(first, side, second) {
                            *counts.entry((side.index(), first, second)).or_insert(0) += 1;
                        }
                    }
                }
                Ok::<_, SynthesisError>(counts)
            })
            .try_reduce(SeamCounts::new, |mut counts, others| {
                // Whole numbers add up to the same in any order.
                others.into_iter().for_each(|(seam, count)| {
                    *counts.entry(seam).or_insert(0) += count;
                });
                Ok(counts)
            })?;
        let mut list: Vec<_> = counts.into_iter().collect();
        list.sort_unstable();
        Ok(list
            .into_iter()
            .map(|((side, first, second), count)| (first, second, Side::ALL[side], count))
            .collect())
    }
}

type SeamCounts = HashMap<(usize, BlockRef, BlockRef), u64>;

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
