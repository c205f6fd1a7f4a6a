//! How consistent and how continuous an assignment is. Zhao 2012 §5.3.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::design::WeavePattern;
use crate::job::Job;

use super::SynthesisError;
use super::assign::{Assignment, column_keys};
use super::catalogue::{Catalogue, Side, matching_neighbours};
use super::lookup::{Placement, Shown};
use super::shift::Randomisation;

/// Zhao's measure of continuity, summed over all crossings of one repeat of the design:
/// how many of a crossing's neighbours show the block that is its neighbour in the
/// exemplar. Every such pair counts twice, once from each side.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Continuity {
    /// As assigned.
    pub before: u64,
    /// As shown, after randomisation.
    pub after: u64,
    /// Were every pair of neighbours continuous.
    pub max: u64,
    /// The part of `before` along the warp, which [`super::Method::Dp`] maximises.
    pub before_along: u64,
}

/// What an assignment achieves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Quality {
    /// Crossings of the design.
    pub crossings: u64,
    /// Matching neighbours, summed over all crossings.
    pub consistency: u64,
    /// Four for every crossing.
    pub consistency_max: u64,
    /// Crossings whose block has the wrong yarn on top.
    pub incorrect: u64,
    /// Crossings at which some neighbour does not match.
    pub mismatched: u64,
    /// Continuity before and after randomisation.
    pub continuity: Continuity,
}

impl Quality {
    /// Measures an assignment of `pattern` over one repeat of the design.
    ///
    /// # Errors
    /// When the job is cancelled.
    pub fn measure(
        pattern: &WeavePattern,
        assignment: &Assignment,
        catalogue: &Catalogue,
        randomisation: Randomisation,
        job: &Job,
    ) -> Result<Self, SynthesisError> {
        let placement = Placement {
            catalogue,
            assignment,
            randomisation,
        };
        let ends: Vec<u32> = (0..assignment.ends()).collect();
        let share = ends.len().div_ceil(4 * rayon::current_num_threads());
        let parts: Vec<Self> = ends
            .par_chunks(share.max(1))
            .map(|ends| {
                let mut buffers = Buffers::default();
                let mut sum = Self::default();
                for &end in ends {
                    job.check()?;
                    sum = sum.plus(column_quality(pattern, &placement, end, &mut buffers));
                }
                Ok(sum)
            })
            .collect::<Result<_, SynthesisError>>()?;
        Ok(parts.into_iter().fold(Self::default(), Self::plus))
    }

    fn plus(self, other: Self) -> Self {
        Self {
            crossings: self.crossings + other.crossings,
            consistency: self.consistency + other.consistency,
            consistency_max: self.consistency_max + other.consistency_max,
            incorrect: self.incorrect + other.incorrect,
            mismatched: self.mismatched + other.mismatched,
            continuity: Continuity {
                before: self.continuity.before + other.continuity.before,
                after: self.continuity.after + other.continuity.after,
                max: self.continuity.max + other.continuity.max,
                before_along: self.continuity.before_along + other.continuity.before_along,
            },
        }
    }
}

/// Kept from one column to the next.
#[derive(Default)]
struct Buffers {
    keys: Vec<u8>,
    here: Vec<Option<Shown>>,
    right: Vec<Option<Shown>>,
}

/// The part of one end: its crossings, and its pairs with the end to the right and the
/// pick above. Ends come in order, so that the last right column is this one.
fn column_quality(
    pattern: &WeavePattern,
    placement: &Placement<'_>,
    end: u32,
    buffers: &mut Buffers,
) -> Quality {
    let catalogue = placement.catalogue;
    let Buffers { keys, here, right } = buffers;
    keys.clear();
    column_keys(pattern, placement.assignment.lattice(), end, keys);
    if right.is_empty() {
        placement.column(i64::from(end), right);
    }
    std::mem::swap(here, right);
    placement.column(i64::from(end) + 1, right);

    let mut quality = Quality::default();
    for (pick, &key) in keys.iter().enumerate() {
        let Some(block) = here[pick] else { continue };
        let own = catalogue.key(block.assigned);
        let matches = matching_neighbours(key, own);
        quality.crossings += 1;
        quality.consistency += u64::from(matches);
        quality.consistency_max += 4;
        quality.incorrect += u64::from((key ^ own) & 1);
        quality.mismatched += u64::from(matches < 4);
        for (side, other) in [(Side::Right, right[pick]), (Side::Above, here[pick + 1])] {
            let Some(other) = other else { continue };
            // Each pair counts from both of its sides.
            let before = 2 * u64::from(catalogue.continues(block.assigned, side, other.assigned));
            let after = 2 * u64::from(catalogue.continues(block.shown, side, other.shown));
            quality.continuity.max += 2;
            quality.continuity.before += before;
            quality.continuity.after += after;
            if side == Side::Above {
                quality.continuity.before_along += before;
            }
        }
    }
    quality
}
