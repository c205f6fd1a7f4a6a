//! All exemplars of one pair of yarns.

use std::sync::Arc;

use glam::{Vec2, Vec3};
use rayon::prelude::*;

use super::bricks::{BRICK, BrickVolume};
use super::heights::{measure, predict};
use super::voxelise::{VoxelGrid, building_bytes, bytes_a_voxel, voxelise};
use crate::job::{Cancelled, Job};
use crate::limits;
use crate::memory::TooMuch;
use crate::synthesis::{Catalogue, EdgeHeights};
use crate::yarn::{RecipeError, WeaveGeometry, YarnRecipe, hash};

/// Seed of all recipes: exemplars are the same on every machine.
const SEED: u64 = 2012;
/// Finest voxel, µm; fibres are 10–20 µm.
const VOXEL_UM: f32 = 5.6;
/// The coarsest level: blocks of the next would have too few voxels to tell yarns apart.
pub const COARSEST_LEVEL: u32 = 4;
/// Fewest and most voxels along a block's side at level 0.
const BLOCK_SIDE: [usize; 2] = [40, 72];

/// Why exemplars could not be had.
#[derive(Debug, thiserror::Error)]
pub enum ExemplarError {
    /// A recipe is not usable.
    #[error(transparent)]
    Recipe(#[from] RecipeError),
    /// The yarns' spacing is not usable.
    #[error("a thread spacing of {0} mm cannot be woven; give {range} mm", range = limits::in_words(&limits::PITCH_MM))]
    Pitch(f32),
    /// They are larger than the memory that may be used.
    #[error(transparent)]
    Memory(#[from] TooMuch),
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

/// The exemplars of one pair of yarns. Those that no crossing needs are not built.
#[derive(Clone)]
pub struct ExemplarSet {
    /// The yarns.
    pub pair: Pair,
    /// Voxels of a block, and their size.
    pub grid: VoxelGrid,
    /// One grid a weave, in the catalogue's order; `None` = not built.
    pub volumes: Vec<Option<Arc<BrickVolume>>>,
    /// Heights at the blocks' edges: measured where built, else predicted.
    pub heights: EdgeHeights,
    /// Heights at the blocks' edges that the recipe predicts.
    pub predicted: EdgeHeights,
}

/// Rounds a size to the nearest power of 1.1: within 5 %.
pub fn quantise(size: f32) -> f32 {
    let steps = (size.ln() / 1.1f32.ln()).round();
    1.1f32.powf(steps)
}

/// The one grid that exemplars of all `pairs` at this spacing (mm) share. Each `level`
/// above 0 halves the resolution, until a block has one brick: what would be no coarser
/// than a finer level is that level, and says so.
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
        if !limits::can_be_woven(side) {
            return Err(ExemplarError::Pitch(side));
        }
    }
    let side = |pitch: f32| voxels_along(pitch, level);
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
    let is_same =
        |finer: &u32| (voxels_along(pitch.x, *finer), voxels_along(pitch.y, *finer)) == (bx, by);
    let level = (0..level).find(is_same).unwrap_or(level);
    let (vx, vy) = (pitch.x / bx as f32, pitch.y / by as f32);
    let vz = (vx * vy).sqrt();
    let depth = ((2.0 * reach / vz).ceil() as usize + 4).next_multiple_of(BRICK);
    Ok(VoxelGrid {
        block: [bx, by, depth],
        voxel_mm: Vec3::new(vx, vy, vz),
        level,
    })
}

/// Voxels along a block's side of `pitch` mm at a level.
fn voxels_along(pitch: f32, level: u32) -> usize {
    let fine = (pitch * 1000.0 / VOXEL_UM) as usize;
    let fine = fine.clamp(BLOCK_SIDE[0], BLOCK_SIDE[1]);
    ((fine >> level.min(COARSEST_LEVEL)).next_multiple_of(BRICK)).max(BRICK)
}

impl VoxelGrid {
    /// Voxels along x and y of a block that level 0 has at this grid's spacing.
    pub fn fine(&self) -> [usize; 2] {
        if self.level == 0 {
            return [self.block[0], self.block[1]];
        }
        self.pitch().to_array().map(|pitch| voxels_along(pitch, 0))
    }

    /// Spacing of ends and picks, mm.
    pub fn pitch(&self) -> Vec2 {
        self.voxel_mm.truncate() * Vec2::new(self.block[0] as f32, self.block[1] as f32)
    }

    /// Geometric mean of a voxel's sides, µm: of this grid, and of level 0 at its spacing.
    pub fn voxel_um(&self) -> [f32; 2] {
        let (pitch, fine) = (self.pitch(), self.fine());
        let fine = [pitch.x / fine[0] as f32, pitch.y / fine[1] as f32];
        [
            self.voxel_mm.element_product().cbrt(),
            (fine[0] * fine[1]).sqrt(),
        ]
        .map(|mm| 1000.0 * mm)
    }
}

impl ExemplarSet {
    /// A set of which nothing is built yet, on a grid of [`common_grid`].
    ///
    /// # Errors
    /// When a recipe is not usable.
    pub fn new(catalogue: &Catalogue, pair: &Pair, grid: VoxelGrid) -> Result<Self, ExemplarError> {
        pair.warp.check()?;
        pair.weft.check()?;
        let mut predicted = EdgeHeights::flat(catalogue.blocks(), grid.block[0], grid.block[1]);
        for exemplar in 0..catalogue.exemplars() {
            let weave = layout(catalogue, pair, grid.pitch(), exemplar);
            predict(&mut predicted, catalogue, exemplar, &weave, &grid);
        }
        Ok(Self {
            pair: pair.clone(),
            grid,
            volumes: vec![None; catalogue.exemplars()],
            heights: predicted.clone(),
            predicted,
        })
    }

    /// Builds the whole set.
    ///
    /// # Errors
    /// When a recipe is not usable or the job is cancelled.
    pub fn build(
        catalogue: &Catalogue,
        pair: &Pair,
        grid: VoxelGrid,
        job: &Job,
    ) -> Result<Self, ExemplarError> {
        let mut set = Self::new(catalogue, pair, grid)?;
        let volumes = (0..catalogue.exemplars())
            .into_par_iter()
            .map(|exemplar| build_exemplar(catalogue, pair, &grid, exemplar, job))
            .collect::<Result<Vec<_>, Cancelled>>()?;
        for (exemplar, volume) in volumes.into_iter().enumerate() {
            set.put(catalogue, exemplar, Arc::new(volume));
        }
        Ok(set)
    }

    /// Takes an exemplar's voxels and measures its edges.
    pub fn put(&mut self, catalogue: &Catalogue, exemplar: usize, volume: Arc<BrickVolume>) {
        measure(
            &mut self.heights,
            catalogue,
            exemplar,
            &volume,
            &self.grid,
            [&self.pair.warp, &self.pair.weft].map(YarnRecipe::full_extinction),
        );
        self.volumes[exemplar] = Some(volume);
    }

    /// Bytes of voxels held.
    pub fn bytes(&self) -> usize {
        self.volumes
            .iter()
            .flatten()
            .map(|volume| volume.bytes())
            .sum()
    }
}

/// Bytes that those of the `needed` exemplars of a pair may take, and with them what
/// building them takes meanwhile.
pub fn bytes_at_most(catalogue: &Catalogue, pair: &Pair, grid: &VoxelGrid, needed: &[bool]) -> u64 {
    let block: u64 = grid.block.iter().map(|&side| side as u64).product();
    let (mut held, mut largest) = (0u64, 0u64);
    for (weave, _) in catalogue
        .weaves()
        .iter()
        .zip(needed)
        .filter(|(_, needed)| **needed)
    {
        let (ends, picks) = (u64::from(weave.ends()), u64::from(weave.picks()));
        let voxels = (ends * picks).saturating_mul(block);
        held = held.saturating_add(voxels.saturating_mul(bytes_a_voxel(grid)));
        largest = largest.max(building_bytes(pair, grid, [ends, picks]));
    }
    let at_once = rayon::current_num_threads() as u64;
    held.saturating_add(largest.saturating_mul(at_once))
}

/// The yarns of one exemplar of a catalogue at a spacing of ends and picks, mm: as they lie
/// in its voxels.
pub fn layout(catalogue: &Catalogue, pair: &Pair, pitch: Vec2, exemplar: usize) -> WeaveGeometry {
    let weave = &catalogue.weaves()[exemplar];
    let seed = hash(SEED, exemplar as u64);
    WeaveGeometry::new(weave, &pair.warp, &pair.weft, pitch, seed)
}

/// The voxels of one exemplar of a catalogue.
///
/// # Errors
/// [`Cancelled`] when the job was.
pub(super) fn build_exemplar(
    catalogue: &Catalogue,
    pair: &Pair,
    grid: &VoxelGrid,
    exemplar: usize,
    job: &Job,
) -> Result<BrickVolume, Cancelled> {
    let weave = layout(catalogue, pair, grid.pitch(), exemplar);
    voxelise(
        &weave,
        &pair.warp,
        &pair.weft,
        grid,
        hash(SEED, 1000 + exemplar as u64),
        job,
    )
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
        let volumes = |set: &ExemplarSet| -> Vec<BrickVolume> {
            set.volumes
                .iter()
                .map(|volume| volume.as_deref().unwrap().clone())
                .collect()
        };
        let (one, two): (ExemplarSet, ExemplarSet) = (build(1), build(2));
        assert!(volumes(&one) == volumes(&two) && one.heights == two.heights);
    }

    #[test]
    fn predicted_edges_are_near_the_measured_ones() {
        let catalogue = Catalogue::paper();
        let grid = common_grid(&catalogue, &[cotton()], Vec2::splat(0.4), 1).unwrap();
        let set = ExemplarSet::build(&catalogue, &cotton(), grid, &Job::new()).unwrap();
        let pairs = set.heights.left.iter().zip(&set.predicted.left);
        let (sum, count) = pairs.fold((0.0, 0.0), |(s, n), (a, b)| (s + (a - b).abs(), n + 1.0));
        // A tenth of the thickness; against the other face, several tenths.
        assert!(
            sum / count < 0.1 * grid.block[2] as f32,
            "{} voxels",
            sum / count
        );
        let half = set.heights.left.len() / 2;
        let turned = set.heights.left[..half]
            .iter()
            .zip(&set.predicted.left[half..]);
        let control: f32 = turned.map(|(a, b)| (a - b).abs()).sum::<f32>() / half as f32;
        assert!(
            control > 2.0 * sum / count,
            "{control} against {}",
            sum / count
        );
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
            let volume = set.volumes[usize::from(place.exemplar)].as_ref().unwrap();
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
