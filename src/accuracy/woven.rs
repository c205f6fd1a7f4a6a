//! Synthesis by itself: its stages one by one, each timed, and what they achieve. Zhao 2012 §5
//! and its table 2.

use std::sync::Arc;
use std::time::Instant;

use super::AccuracyError;
use crate::clock::{Clock, Took};
use crate::cloth::{ClothSettings, ClothVolume, YarnClasses};
use crate::design::{Design, Lattice, Repeat};
use crate::exemplar::{ExemplarSet, ExemplarStore};
use crate::job::Job;
use crate::synthesis::{
    Assignment, Catalogue, EdgeFix, EdgeHeights, Placement, Quality, Randomisation, SeamRms,
    SynthesisSettings,
};

/// A design whose exemplars are there: its synthesis can be measured again and again.
pub struct Woven {
    design: Arc<Design>,
    catalogue: Catalogue,
    classes: YarnClasses,
    heights: Vec<EdgeHeights>,
    settings: ClothSettings,
    /// Seconds that reading or building the exemplars took.
    pub exemplar_seconds: f64,
    /// Height of a voxel, mm.
    pub voxel_mm: f64,
    /// How much higher a voxel is than long along x and y.
    rise: [f32; 2],
    /// Mean diameter of the yarns, mm.
    pub diameter_mm: f64,
}

/// What one synthesis took and what it achieved.
pub struct Synthesised {
    /// What choosing a block for every crossing took.
    pub assignment: Took,
    /// What finding the edges' corrections took.
    pub edge_fixing: Took,
    /// Bytes beyond the design and the exemplars.
    pub bytes: usize,
    /// How consistent and how continuous it is.
    pub quality: Quality,
    /// Seams before and after edge fixing, voxels.
    pub seams: SeamRms,
    /// Share of the crossings that show the same block as the crossing one repeat of the
    /// design further along the warp, or along the weft.
    pub repeated: f64,
}

impl Woven {
    /// Reads or builds the exemplars of a design.
    ///
    /// # Errors
    /// When the cloth cannot be made or the job is cancelled.
    pub fn new(
        design: Arc<Design>,
        settings: ClothSettings,
        store: &ExemplarStore,
        job: &Job,
    ) -> Result<Self, AccuracyError> {
        let catalogue = Catalogue::standard();
        let (_, needed) = ClothVolume::assign(&design, &catalogue, &settings, job)?;
        let begun = Instant::now();
        let classes = YarnClasses::new(&design);
        let grid = ClothVolume::grid_for(&catalogue, &classes, &settings)?;
        let sets = (classes.pairs.iter())
            .map(|pair| store.get(&catalogue, pair, grid, &needed, job))
            .collect::<Result<Vec<Arc<ExemplarSet>>, _>>()?;
        let recipes = (classes.pairs.iter()).flat_map(|pair| [&pair.warp, &pair.weft]);
        let diameters: Vec<f64> = recipes.map(|recipe| recipe.diameter_mm.into()).collect();
        Ok(Self {
            design,
            heights: sets.iter().map(|set| set.heights.clone()).collect(),
            exemplar_seconds: begun.elapsed().as_secs_f64(),
            voxel_mm: f64::from(grid.voxel_mm.z),
            rise: [grid.voxel_mm.x, grid.voxel_mm.y].map(|along| grid.voxel_mm.z / along),
            diameter_mm: diameters.iter().sum::<f64>() / diameters.len().max(1) as f64,
            settings,
            catalogue,
            classes,
        })
    }

    /// Chooses blocks and fixes edges as `synthesis` says, timed, and looks at the outcome.
    ///
    /// # Errors
    /// When the cloth cannot be made or the job is cancelled.
    pub fn synthesise(
        &self,
        synthesis: SynthesisSettings,
        job: &Job,
    ) -> Result<Synthesised, AccuracyError> {
        let settings = ClothSettings {
            synthesis,
            ..self.settings
        };
        let begun = Clock::now();
        let (blocks, _) = ClothVolume::assign(&self.design, &self.catalogue, &settings, job)?;
        let assignment = begun.took();
        let begun = Clock::now();
        let edge_fix = EdgeFix::new(&self.heights, &self.catalogue, synthesis.closing(), job)?;
        let edge_fixing = begun.took();

        let randomisation = Randomisation {
            seed: synthesis.seed,
            patch: synthesis.patch,
        };
        let weave = self.design.weave();
        let quality = Quality::measure(&weave, &blocks, &self.catalogue, randomisation, job)?;
        let placement = Placement {
            catalogue: &self.catalogue,
            assignment: &blocks,
            randomisation,
        };
        let (design, classes) = (&self.design, &self.classes);
        let set_at =
            |end, pick| classes.set(design.warp_yarn(end, pick), design.weft_yarn(end, pick));
        let seams = placement.seam_rms(&edge_fix, &self.heights, set_at, self.rise, job)?;
        Ok(Synthesised {
            assignment,
            edge_fixing,
            bytes: blocks.bytes() + edge_fix.bytes(),
            quality,
            seams,
            repeated: repeated(&placement, &blocks),
        })
    }

    /// Root mean square of the seams that are left, in diameters of the yarns.
    pub fn seams_in_diameters(&self, made: &Synthesised) -> f64 {
        made.seams.after * self.voxel_mm / self.diameter_mm
    }
}

/// See [`Synthesised::repeated`]: over a square of crossings.
fn repeated(placement: &Placement<'_>, assignment: &Assignment) -> f64 {
    const LOOKED_AT: i64 = 128;
    let (ends, picks) = (i64::from(assignment.ends()), i64::from(assignment.picks()));
    let dropped = |repeat| match repeat {
        Repeat::Dropped(by) => i64::from(by),
        Repeat::Straight | Repeat::None => 0,
    };
    let Lattice { across, along } = assignment.lattice();
    let repeats = [(ends, dropped(across)), (dropped(along), picks)];
    let (mut same, mut seen) = (0u32, 0u32);
    for end in 0..LOOKED_AT {
        for pick in 0..LOOKED_AT {
            let here = placement.block(end, pick);
            for (right, up) in repeats {
                let there = placement.block(end + right, pick + up);
                if let Some((here, there)) = here.zip(there) {
                    seen += 1;
                    same += u32::from(here == there);
                }
            }
        }
    }
    f64::from(same) / f64::from(seen.max(1))
}
