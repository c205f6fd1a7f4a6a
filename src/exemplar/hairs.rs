//! Flyaway hairs: a sparse periodic layer that lies on the cloth, apart from the blocks.
//!
//! Hairs are longer than blocks and would be cut at their borders. So one patch of
//! 16 × 16 crossings of them is laid for each pair of yarns and repeated; heights count
//! from the local surface of the cloth. Both faces use the same patch, mirrored.

use glam::{Vec2, Vec3};

use super::bricks::{BRICK, BrickVolume, PackedVoxel, cell_of};
use super::majorants::CELL;
use crate::design::Direction;
use crate::yarn::{YarnRecipe, hash, unit};

/// Crossings along a side of the patch.
pub const PATCH: usize = 16;
/// Hairs a mm below which a yarn has none.
pub(crate) const HAIRLESS: f32 = 0.5;
/// Most voxels along a side of the patch.
const MOST_VOXELS: usize = 1024;

/// A periodic patch of hairs.
pub struct HairPatch {
    voxels: BrickVolume,
    /// Size of a voxel, mm.
    pub voxel_mm: Vec3,
    /// Depth below the surface at which the patch begins, mm.
    pub sink_mm: f32,
    /// Largest fill of each cell of 4³ voxels.
    cells: Vec<u8>,
    count: [usize; 3],
}

/// A hair on its way.
struct Hair {
    place: Vec3,
    direction: Vec3,
}

impl HairPatch {
    /// Lays the hairs of a warp and a weft yarn at a spacing in mm; `None` when neither
    /// yarn has any.
    pub fn new(warp: &YarnRecipe, weft: &YarnRecipe, pitch: Vec2, seed: u64) -> Option<Self> {
        let hairy = |recipe: &YarnRecipe| recipe.hairs_per_mm >= HAIRLESS;
        if !hairy(warp) && !hairy(weft) {
            return None;
        }
        let patch = pitch * PATCH as f32;
        let fibre = warp.fibre_um.min(weft.fibre_um) * 1e-3;
        let side = |mm: f32| {
            ((mm / fibre) as usize)
                .clamp(64, MOST_VOXELS)
                .next_multiple_of(BRICK)
        };
        let (nx, ny) = (side(patch.x), side(patch.y));
        let voxel = Vec2::new(patch.x / nx as f32, patch.y / ny as f32);
        let vz = 0.5 * (voxel.x + voxel.y);
        let reach = [warp, weft]
            .map(|r| r.hair_length_mm[1])
            .into_iter()
            .fold(0.0, f32::max)
            * 0.35;
        let sink_mm = 0.25 * warp.diameter_mm.max(weft.diameter_mm);
        let depth = (((reach + sink_mm) / vz) as usize).clamp(BRICK, 256);
        let mut dense = Dense::new([nx, ny, depth.next_multiple_of(BRICK)]);
        let voxel_mm = voxel.extend(vz);
        for (direction, recipe) in [(Direction::Warp, warp), (Direction::Weft, weft)] {
            if hairy(recipe) {
                let seed = hash(seed, direction as u64);
                lay(
                    &mut dense, recipe, direction, pitch, voxel_mm, sink_mm, seed,
                );
            }
        }
        let voxels = dense.into_bricks();
        let (cells, count) = cell_bounds(&voxels);
        Some(Self {
            voxels,
            voxel_mm,
            sink_mm,
            cells,
            count,
        })
    }

    /// Sides of the patch and its height, mm.
    pub fn size_mm(&self) -> Vec3 {
        let [x, y, z] = self.voxels.size().map(|n| n as f32);
        Vec3::new(x, y, z) * self.voxel_mm
    }

    /// Cells of 4³ voxels along each axis.
    pub fn cells(&self) -> [usize; 3] {
        self.count
    }

    /// Upper bound of the fill (of 255) in a cell.
    #[inline]
    pub fn bound(&self, [x, y, z]: [usize; 3]) -> u8 {
        self.cells[(z * self.count[1] + y) * self.count[0] + x]
    }

    /// The voxel at a place in voxels; x and y wrap.
    #[inline]
    pub fn voxel(&self, place: Vec3) -> PackedVoxel {
        let [nx, ny, nz] = self.voxels.size();
        if !(place.z >= 0.0 && place.z < nz as f32) {
            return PackedVoxel::default();
        }
        let wrap = |place: f32, n: usize| cell_of(place).rem_euclid(n as i32) as usize;
        let (x, y) = (wrap(place.x, nx), wrap(place.y, ny));
        self.voxels.get(x, y, place.z as usize)
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        self.voxels.bytes() + self.cells.len()
    }
}

/// How many threads a hair's root is away from where a voxel of it lies.
pub fn root_step(voxel: PackedVoxel) -> i64 {
    i64::from(voxel.yarn()) - 64
}

fn lay(
    dense: &mut Dense,
    recipe: &YarnRecipe,
    direction: Direction,
    pitch: Vec2,
    voxel_mm: Vec3,
    sink_mm: f32,
    seed: u64,
) {
    let (own, along) = match direction {
        Direction::Warp => (pitch.x, pitch.y * PATCH as f32),
        Direction::Weft => (pitch.y, pitch.x * PATCH as f32),
    };
    // Half of a yarn's hairs stand on each face.
    let hairs = (0.5 * recipe.hairs_per_mm * along).ceil() as u64;
    let step = 0.5 * voxel_mm.min_element();
    // A fibre thinner than a voxel fills only a part of it.
    let fibre = recipe.fibre_um * 1e-3;
    let fill =
        (std::f32::consts::FRAC_PI_4 * fibre * fibre * step / voxel_mm.element_product()).min(1.0);
    for yarn in 0..PATCH {
        for number in 0..hairs {
            let seed = hash(hash(seed, yarn as u64), number);
            let random = |what: u64| unit(hash(seed, what));
            let signed = |what: u64| 2.0 * random(what) - 1.0;
            let across = (yarn as f32 + 0.5 + 0.35 * signed(0)) * own;
            let (s, c) = (0.9 * signed(1)).sin_cos();
            let along_sign = if random(2) < 0.5 { -1.0 } else { 1.0 };
            let rise = 0.15 + 0.55 * random(3);
            // Across, along, up; swapped for the weft below.
            let mut hair = Hair {
                place: Vec3::new(across, random(4) * along, -0.5 * sink_mm),
                direction: Vec3::new(s, c * along_sign, rise).normalize_or(Vec3::Z),
            };
            let [short, long] = recipe.hair_length_mm;
            // Short hairs are many, long ones few.
            let length = short + (long - short) * random(5).powi(3);
            let steps = (length / step) as u64;
            let (mut bend, mut sway) = (1.5 * signed(6), 0.0);
            for k in 0..steps.min(100_000) {
                if k % 32 == 0 {
                    // A new curl every so often; hairs fall back onto the cloth.
                    bend = 0.7 * bend + 2.0 * signed(16 + k);
                    sway = 1.6 * signed(17 + k) - 3.0 * hair.place.z / (0.2 * long) * random(7);
                }
                hair.turn(bend * step, sway * step);
                hair.place += hair.direction * step;
                if hair.place.z < -sink_mm {
                    break;
                }
                let (point, tangent) = match direction {
                    Direction::Warp => (hair.place, hair.direction),
                    Direction::Weft => (swap(hair.place), swap(hair.direction)),
                };
                let root = yarn as i64 - (hair.place.x / own).floor() as i64;
                if root.abs() < 60 {
                    let weft = direction == Direction::Weft;
                    let place = (point + Vec3::Z * sink_mm) / voxel_mm;
                    dense.add(place, fill, tangent, (root + 64) as u8, weft);
                }
            }
        }
    }
}

fn swap(v: Vec3) -> Vec3 {
    Vec3::new(v.y, v.x, v.z)
}

impl Hair {
    /// Turns sideways by `bend` and upwards by `sway`, radians.
    fn turn(&mut self, bend: f32, sway: f32) {
        let side = Vec3::new(-self.direction.y, self.direction.x, 0.0);
        let turned = self.direction + side * bend + Vec3::Z * sway;
        self.direction = turned.normalize_or(self.direction);
    }
}

/// Voxels by place while hairs are laid.
struct Dense {
    size: [usize; 3],
    voxels: std::collections::BTreeMap<u64, (f32, Vec3, u8, bool)>,
}

impl Dense {
    fn new(size: [usize; 3]) -> Self {
        Self {
            size,
            voxels: std::collections::BTreeMap::new(),
        }
    }

    fn add(&mut self, place: Vec3, fill: f32, tangent: Vec3, yarn: u8, weft: bool) {
        let [nx, ny, nz] = self.size;
        if !(place.z >= 0.0 && place.z < nz as f32) {
            return;
        }
        let x = (place.x.floor() as i64).rem_euclid(nx as i64) as u64;
        let y = (place.y.floor() as i64).rem_euclid(ny as i64) as u64;
        // Keyed slab by slab, in the order in which bricks are filled.
        let key = (y * nz as u64 + place.z as u64) * nx as u64 + x;
        let voxel = self.voxels.entry(key).or_insert((0.0, tangent, yarn, weft));
        voxel.0 += fill;
    }

    fn into_bricks(self) -> BrickVolume {
        let [nx, ny, nz] = self.size;
        let mut volume = BrickVolume::new(self.size);
        let mut slab = vec![PackedVoxel::default(); nx * BRICK * nz];
        for row in 0..ny / BRICK {
            slab.fill(PackedVoxel::default());
            let first = (row * BRICK * nz * nx) as u64;
            let last = ((row + 1) * BRICK * nz * nx) as u64;
            for (&key, &(fill, tangent, yarn, weft)) in self.voxels.range(first..last) {
                let (x, rest) = (key as usize % nx, key as usize / nx);
                let (z, y) = (rest % nz, rest / nz % BRICK);
                slab[(z * BRICK + y) * nx + x] = PackedVoxel::new(fill, tangent, yarn, weft);
            }
            volume.put_slab(row, &slab, &[]);
        }
        volume
    }
}

/// Largest fill of each cell.
fn cell_bounds(voxels: &BrickVolume) -> (Vec<u8>, [usize; 3]) {
    let count = voxels.size().map(|n| n / CELL);
    let mut cells = vec![0u8; count.iter().product()];
    voxels.for_each(|[x, y, z], voxel| {
        let [x, y, z] = [x, y, z].map(|place| place / CELL);
        let cell = &mut cells[(z * count[1] + y) * count[0] + x];
        *cell = (*cell).max(voxel.fill());
    });
    (cells, count)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::design::Family;

    fn patch(family: Family) -> Option<HairPatch> {
        let recipe = YarnRecipe::family(family, 0.4);
        HairPatch::new(&recipe, &recipe, Vec2::splat(0.5), 3)
    }

    #[test]
    fn wool_has_hairs_and_silk_has_none() {
        assert!(patch(Family::Silk).is_none());
        let wool = patch(Family::Wool).unwrap();
        let mut filled = 0;
        wool.voxels
            .for_each(|_, voxel| filled += usize::from(voxel.fill() > 0));
        assert!(filled > 10_000, "{filled} voxels");
        // Sparse: hairs, not felt.
        let all: usize = wool.voxels.size().iter().product();
        assert!(filled * 20 < all, "{filled} of {all}");
    }

    #[test]
    fn bounds_hold_for_every_voxel_and_are_reached() {
        let wool = patch(Family::Wool).unwrap();
        let mut most = vec![0; wool.cells.len()];
        let [nx, ny, _] = wool.cells();
        wool.voxels.for_each(|place, voxel| {
            let [x, y, z] = place.map(|n| n / CELL);
            assert!(wool.bound([x, y, z]) >= voxel.fill());
            let cell = &mut most[(z * ny + y) * nx + x];
            *cell = voxel.fill().max(*cell);
        });
        assert_eq!(most, wool.cells);
    }
}
