//! Randomisation: blocks move along their exemplar's symmetries, patch by patch. Zhao
//! 2012 §5.4, *Randomization*.
//!
//! The shift hashes the *absolute* crossing, at lookup: the cloth has no period even when
//! its design has. A symmetry of the weave keeps every neighbourhood, so a shifted block
//! is as correct and as consistent as before; inside a patch all blocks of an exemplar
//! move together, so continuity is lost at most at the patches' borders.

use super::catalogue::Catalogue;
use super::hash::{hash, index_below};

/// Shifts every patch of crossings by a random symmetry of its blocks' exemplars.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Randomisation {
    /// Seed of the hash.
    pub seed: u64,
    /// Edge of a patch in crossings; 0 = no shifts.
    pub patch: u32,
}

impl Randomisation {
    /// The block finally shown at crossing (end, pick) of the endless cloth.
    #[inline]
    pub fn apply(&self, catalogue: &Catalogue, block: u16, end: i64, pick: i64) -> u16 {
        if self.patch == 0 {
            return block;
        }
        let images = catalogue.images(block);
        images[index_below(self.patch_hash(end, pick), images.len())]
    }

    /// The random word that all crossings of a patch share.
    #[inline]
    fn patch_hash(&self, end: i64, pick: i64) -> u64 {
        let patch = i64::from(self.patch);
        hash(
            self.seed,
            end.div_euclid(patch) as u64,
            pick.div_euclid(patch) as u64,
        )
    }
}
