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
        hash(self.seed, self.patch_of(end), self.patch_of(pick))
    }

    /// ⌊crossing / patch⌋. Narrow division where that suffices: it is several times faster,
    /// and this runs at every lookup.
    #[inline]
    fn patch_of(&self, crossing: i64) -> u64 {
        let patch = i64::from(self.patch);
        let narrow = u32::try_from(crossing).map(|crossing| i64::from(crossing / self.patch));
        narrow.unwrap_or_else(|_| crossing.div_euclid(patch)) as u64
    }

    /// The patches of one end, to be walked along its picks.
    pub(super) fn patches_of(&self, end: i64) -> Patches {
        Patches {
            randomisation: *self,
            end,
            patch: None,
            word: 0,
        }
    }
}

/// Remembers the patch it was last asked about.
pub(super) struct Patches {
    randomisation: Randomisation,
    end: i64,
    patch: Option<u64>,
    word: u64,
}

impl Patches {
    /// As [`Randomisation::apply`].
    #[inline]
    pub(super) fn apply(&mut self, catalogue: &Catalogue, block: u16, pick: i64) -> u16 {
        if self.randomisation.patch == 0 {
            return block;
        }
        let patch = self.randomisation.patch_of(pick);
        if self.patch != Some(patch) {
            self.patch = Some(patch);
            self.word = self.randomisation.patch_hash(self.end, pick);
        }
        let images = catalogue.images(block);
        images[index_below(self.word, images.len())]
    }
}
