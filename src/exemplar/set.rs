//! All exemplars of one pair of yarns.

use glam::{Vec2, Vec3};
use rayon::prelude::*;

use super::bricks::{BRICK, BrickVolume};
use super::heights::edge_heights;
use super::voxelise::{VoxelGrid, voxelise};
use crate::job::{Cancelled, Job};
use crate::synthesis::{Catalogue, EdgeHeights};
use crate::yarn::{RecipeError, WeaveGeometry, YarnRecipe, hash};

/// Seed of all recipes: exemplars are the same on every machine.
const SEED: u64 = 2012;
/// Finest voxel, µm; fibres are 10–20 µm.
const VOXEL_UM: f32 = 5.6;
/// Fewest and most voxels along a block's side at level 0.
const BLOCK_SIDE: [usize; 2] = [40, 72];

/// Why exemplars could not be had.
#[derive(Debug, thiserror::Error)]
pub enum ExemplarError {
    /// A recipe is not usable.
    #[error(transparent)]
    Recipe(#[from] RecipeError),
    /// The yarns' spacing is not usable.
    #[error("a thread spacing of {0} mm cannot be woven; give between 0.02 and 20 mm")]
    Pitch(f32),
    /// The owner cancelled the work.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// A warp and a weft recipe and their spacing: what one exemplar set is for.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Pair {
    /// The ends' recipe.
    pub warp: YarnRecipe,
    /// The picks' recipe.
    pub weft: YarnRecipe,
}

/// One exemplar for each weave of a catalogue, all of one pair of yarns.
pub struct ExemplarSet {
    /// The yarns.
    pub pair: Pair,
    /// Voxels of a block, and their size.
    pub grid: VoxelGrid,
    /// One grid a weave, in the catalogue's order.
    pub volumes: Vec<BrickVolume>,
    /// Heights at the blocks' edges.
    pub heights: EdgeHeights,
}

/// Rounds a size to the nearest power of 1.1: within 5 %.
pub fn quantise(size: f32) -> f32 {
    let steps = (size.ln() / 1.1f32.ln()).round();
    1.1f32.powf(steps)
}

/// The one grid that exemplars of all `pairs` at this spacing (mm) share. Each `level`
/// above 0 halves the resolution.
///
/// # Errors
/// When a recipe or the spacing is not usable.
pub fn common_grid(
    catalogue: &Catalogue,
    pairs: &[Pair],
    pitch: Vec2,
    level: u32,
) -> Result<VoxelGrid, ExemplarError> {
    for side in [pitch.x, pitch.y] {
        if !(0.02..=20.0).contains(&side) {
            return Err(ExemplarError::Pitch(side));
        }
    }
    let side = |pitch: f32| {
        let fine = (pitch * 1000.0 / VOXEL_UM) as usize;
        let fine = fine.clamp(BLOCK_SIDE[0], BLOCK_SIDE[1]);
        ((fine >> level.min(4)).next_multiple_of(BRICK)).max(BRICK)
    };
    let mut reach = 0.0f32;
    for pair in pairs {
        pair.warp.check()?;
        pair.weft.check()?;
        for weave in catalogue.weaves() {
            let weave = WeaveGeometry::new(weave, &pair.warp, &pair.weft, pitch, SEED);
            let (low, high) = weave.height_range();
            reach = reach.max(high).max(-low);
        }
        // Loose fibres stand off the surface.
        reach += 0.1 * pair.warp.diameter_mm.max(pair.weft.diameter_mm);
    }
    let (bx, by) = (side(pitch.x), side(pitch.y));
    let (vx, vy) = (pitch.x / bx as f32, pitch.y / by as f32);
    let vz = (vx * vy).sqrt();
    let depth = ((2.0 * reach / vz).ceil() as usize + 4).next_multiple_of(BRICK);
    Ok(VoxelGrid {
        block: [bx, by, depth],
        voxel_mm: Vec3::new(vx, vy, vz),
    })
}

impl ExemplarSet {
    /// Builds the set on a grid of [`common_grid`].
    ///
    /// # Errors
    /// When a recipe is not usable or the job is cancelled.
    pub fn build(
        catalogue: &Catalogue,
        pair: &Pair,
        grid: VoxelGrid,
        job: &Job,
    ) -> Result<Self, ExemplarError> {
        pair.warp.check()?;
        pair.weft.check()?;
        let pitch = Vec2::new(
            grid.voxel_mm.x * grid.block[0] as f32,
            grid.voxel_mm.y * grid.block[1] as f32,
        );
        let done = std::sync::atomic::AtomicUsize::new(0);
        let count = catalogue.exemplars();
        let volumes = catalogue
            .weaves()
            .par_iter()
            .enumerate()
            .map(|(number, weave)| {
                let weave = WeaveGeometry::new(
                    weave,
                    &pair.warp,
                    &pair.weft,
                    pitch,
                    hash(SEED, number as u64),
                );
                let seed = hash(SEED, 1000 + number as u64);
                let volume = voxelise(&weave, &pair.warp, &pair.weft, &grid, seed, job)?;
                let done = 1 + done.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
                job.report("exemplars", done as f32 / count as f32);
                Ok(volume)
            })
            .collect::<Result<Vec<_>, Cancelled>>()?;
        let heights = edge_heights(catalogue, &volumes, grid.block);
        Ok(Self {
            pair: pair.clone(),
            grid,
            volumes,
            heights,
        })
    }

    /// Bytes of voxels held.
    pub fn bytes(&self) -> usize {
        self.volumes.iter().map(BrickVolume::bytes).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::design::Family;

    fn cotton() -> Pair {
        let recipe = YarnRecipe::family(Family::Cotton, 0.3);
        Pair {
            warp: recipe.clone(),
            weft: recipe,
        }
    }

    #[test]
    fn sizes_are_quantised_within_five_percent() {
        for i in 1..500 {
            let size = 0.01 * i as f32;
            assert!((quantise(size) / size - 1.0).abs() < 0.05, "{size}");
            assert!((quantise(quantise(size)) - quantise(size)).abs() < 1e-4 * size);
        }
    }

    #[test]
    fn a_set_is_the_same_for_any_number_of_threads() {
        let catalogue = Catalogue::paper();
        let grid = common_grid(&catalogue, &[cotton()], Vec2::splat(0.4), 2).unwrap();
        let build = |threads| {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .unwrap();
            pool.install(|| ExemplarSet::build(&catalogue, &cotton(), grid, &Job::new()).unwrap())
        };
        let (one, two) = (build(1), build(2));
        assert!(one.volumes == two.volumes && one.heights == two.heights);
    }

    #[test]
    fn absurd_spacings_are_refused() {
        for pitch in [0.0, -1.0, f32::NAN, f32::INFINITY, 1e9] {
            assert!(
                common_grid(&Catalogue::paper(), &[cotton()], Vec2::new(pitch, 0.4), 0).is_err()
            );
        }
    }

    #[test]
    fn every_block_shows_its_pattern() {
        // The yarn seen at the centre of each block is the one its weave puts on top.
        let catalogue = Catalogue::standard();
        let grid = common_grid(&catalogue, &[cotton()], Vec2::splat(0.36), 1).unwrap();
        let set = ExemplarSet::build(&catalogue, &cotton(), grid, &Job::new()).unwrap();
        let [bx, by, bz] = grid.block;
        for block in 0..catalogue.blocks() as u16 {
            let place = catalogue.place(block);
            let volume = &set.volumes[usize::from(place.exemplar)];
            let weave = &catalogue.weaves()[usize::from(place.exemplar)];
            let (x, y) = (
                usize::from(place.x) * bx + bx / 2,
                usize::from(place.y) * by + by / 2,
            );
            let top = (0..bz)
                .rev()
                .map(|z| volume.get(x, y, z))
                .find(|v| v.fill() > 60)
                .unwrap();
            let bottom = (0..bz)
                .map(|z| volume.get(x, y, z))
                .find(|v| v.fill() > 60)
                .unwrap();
            let warp_up = weave.get(place.x.into(), place.y.into());
            assert_eq!(
                (top.is_weft(), bottom.is_weft()),
                (!warp_up, warp_up),
                "block {block}"
            );
        }
    }
}
