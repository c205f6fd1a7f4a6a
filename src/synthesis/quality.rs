//! How consistent and how continuous an assignment is. Zhao 2012 §5.3.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::design::WeavePattern;
use crate::job::Job;

use super::SynthesisError;
use super::assign::{Assignment, column_keys};
use super::catalogue::{Catalogue, Side, matching_neighbours};
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
        let columns: Vec<Self> = (0..assignment.ends())
            .into_par_iter()
            .map_init(Buffers::default, |buffers, end| {
                job.check()?;
                Ok(column_quality(
                    pattern,
                    assignment,
                    catalogue,
                    randomisation,
                    end,
                    buffers,
                ))
            })
            .collect::<Result<_, SynthesisError>>()?;
        Ok(columns.into_iter().fold(Self::default(), Self::plus))
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

/// A column of the cloth with one row more than the design: before and after shifting.
#[derive(Default)]
struct Buffers {
    keys: Vec<u8>,
    here: Vec<Option<(u16, u16)>>,
    right: Vec<Option<(u16, u16)>>,
}

/// The part of one end: its crossings, and its pairs with the end to the right and the
/// pick above.
fn column_quality(
    pattern: &WeavePattern,
    assignment: &Assignment,
    catalogue: &Catalogue,
    randomisation: Randomisation,
    end: u32,
    buffers: &mut Buffers,
) -> Quality {
    let Buffers { keys, here, right } = buffers;
    keys.clear();
    column_keys(pattern, assignment.lattice(), end, keys);
    let fill = |column: &mut Vec<Option<(u16, u16)>>, end: i64| {
        column.clear();
        column.extend((0..=i64::from(assignment.picks())).map(|pick| {
            let block = assignment.at(end, pick)?;
            Some((block, randomisation.apply(catalogue, block, end, pick)))
        }));
    };
    fill(here, i64::from(end));
    fill(right, i64::from(end) + 1);

    let mut quality = Quality::default();
    for (pick, &key) in keys.iter().enumerate() {
        let Some((block, shown)) = here[pick] else {
            continue;
        };
        let matches = matching_neighbours(key, catalogue.key(block));
        quality.crossings += 1;
        quality.consistency += u64::from(matches);
        quality.consistency_max += 4;
        quality.incorrect += u64::from((key ^ catalogue.key(block)) & 1);
        quality.mismatched += u64::from(matches < 4);
        for (side, neighbour) in [(Side::Right, right[pick]), (Side::Above, here[pick + 1])] {
            let Some((other, other_shown)) = neighbour else {
                continue;
            };
            let before = 2 * u64::from(catalogue.continues(block, side, other));
            quality.continuity.max += 2;
            quality.continuity.before += before;
            quality.continuity.after +=
                2 * u64::from(catalogue.continues(shown, side, other_shown));
            if side == Side::Above {
                quality.continuity.before_along += before;
            }
        }
    }
    quality
}
