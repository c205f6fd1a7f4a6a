//! A cloth follows its design: what an edit does not touch is taken over.
//!
//! Comes in: the cloth as it was and the edited design with its drawdown. Goes out: the
//! cloth of that design, voxel for voxel what making it anew gives, or word that the
//! exemplars are of no use for it. Columns of blocks, exemplars, edge fixing and majorants
//! are shared by both cloths as far as they are equal.

use std::sync::Arc;

use super::build::{ClothError, ClothVolume, YarnClasses, fitted, roughness};
use super::colour;
use crate::design::{Design, WeavePattern};
use crate::exemplar::ExemplarSet;
use crate::job::Job;
use crate::synthesis::Stretch;

/// Beyond this many changed crossings all blocks are assigned anew.
const MOST_CELLS: usize = 1 << 18;

impl ClothVolume {
    /// The cloth of the edited `design`, whose drawdown is `weave`; the cloth as it is
    /// shows the drawdown `before`. It may lack exemplars, see [`ClothVolume::unbuilt`].
    /// With `within`, it has the columns that lie there and no others.
    ///
    /// `None` where other exemplars are needed: for yarns of other families or sizes,
    /// another spacing or another repeat.
    ///
    /// # Errors
    /// When the job is cancelled.
    pub fn follow(
        &self,
        before: &WeavePattern,
        design: &Design,
        weave: &WeavePattern,
        within: Option<&Stretch>,
        job: &Job,
    ) -> Result<Option<Self>, ClothError> {
        let classes = YarnClasses::new(design);
        if classes.pairs != self.classes.pairs
            || classes.pitch != self.classes.pitch
            || design.lattice() != self.lattice
        {
            return Ok(None);
        }
        let mut cloth = self.clone();
        match weave.changed_since(before, MOST_CELLS) {
            Some(cells) if cells.is_empty() => {}
            Some(cells) => {
                (cloth.assignment).edit(weave, &self.catalogue, &cells, job)?;
            }
            None => {
                let (catalogue, settings) = (&self.catalogue, &self.settings);
                (cloth.assignment, _) =
                    Self::assign_weave(weave, self.lattice, within, catalogue, settings, job)?;
            }
        }
        if let Some(stretch) = within {
            (cloth.assignment).look_at(weave, &self.catalogue, stretch, job)?;
        }
        cloth.classes = classes;
        cloth.maps = design.maps().clone();
        cloth.ends = design.end_positions();
        cloth.picks = design.pick_positions();
        cloth.alpha = design.yarns().iter().map(roughness).collect();
        cloth.albedo = design.yarns().iter().map(colour::albedo).collect();
        cloth.window = Arc::default();
        Ok(Some(cloth))
    }

    /// The same cloth with more complete exemplar sets, one for each it has.
    ///
    /// # Errors
    /// When the edge fixing fails or the job is cancelled.
    pub fn with_sets(mut self, sets: Vec<Arc<ExemplarSet>>, job: &Job) -> Result<Self, ClothError> {
        (self.edge_fix, self.majorants) =
            fitted(&self.catalogue, &sets, &self.settings, self.lattice, job)?;
        self.sets = sets;
        self.window = Arc::default();
        Ok(self)
    }
}
