//! Sparse voxels in bricks of 8³.

use super::direction::{decode_direction, encode_direction};
use super::lobes::Lobes;
use glam::Vec3;

/// Voxels along the edge of a brick.
pub const BRICK: usize = 8;
const BRICK_VOXELS: usize = BRICK * BRICK * BRICK;
const EMPTY: u32 = u32::MAX;
/// Set in the yarn byte of a weft.
const WEFT: u8 = 0x80;

/// The cell that holds a coordinate: the whole number at or below it, held in range; NaN
/// gives 0. (`f32::floor` is a library call on processors without SSE 4.1.)
#[inline(always)]
pub(crate) fn cell_of(coordinate: f32) -> i32 {
    let towards_zero = coordinate as i32;
    towards_zero.saturating_sub(i32::from(towards_zero as f32 > coordinate))
}

/// One voxel in four bytes: fill fraction, direction, yarn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(transparent)]
pub struct PackedVoxel(pub u32);

impl PackedVoxel {
    /// Packs a fill fraction (0..1), a direction and the yarn (column or row of the
    /// exemplar, and whether it is a weft).
    pub fn new(fill: f32, direction: Vec3, yarn: u8, weft: bool) -> Self {
        let fill = (fill.clamp(0.0, 1.0) * 255.0).round() as u32;
        if fill == 0 {
            return Self(0);
        }
        let yarn = yarn & !WEFT | if weft { WEFT } else { 0 };
        Self(fill | u32::from(encode_direction(direction)) << 8 | u32::from(yarn) << 24)
    }

    /// Fill fraction in 1/255.
    pub fn fill(self) -> u8 {
        self.0 as u8
    }

    /// Unit fibre direction.
    pub fn direction(self) -> Vec3 {
        decode_direction((self.0 >> 8) as u16)
    }

    /// Whether the voxel belongs to a weft.
    pub fn is_weft(self) -> bool {
        self.0 >> 31 == 1
    }

    /// Column (warp) or row (weft) of the exemplar that the voxel's yarn is.
    pub fn yarn(self) -> u8 {
        (self.0 >> 24) as u8 & !WEFT
    }
}

/// A grid of voxels whose sides are multiples of 8, stored as bricks that hold matter.
#[derive(Clone, PartialEq, Eq)]
pub struct BrickVolume {
    size: [usize; 3],
    index: Vec<u32>,
    voxels: Vec<PackedVoxel>,
    /// Beside each voxel; none at level 0, whose voxels hold a fibre or two.
    lobes: Vec<Lobes>,
}

impl BrickVolume {
    /// An empty grid; sides are rounded up to multiples of 8.
    pub fn new(size: [usize; 3]) -> Self {
        let size = size.map(|n| n.next_multiple_of(BRICK).max(BRICK));
        let bricks = size.iter().map(|n| n / BRICK).product();
        Self {
            size,
            index: vec![EMPTY; bricks],
            voxels: Vec::new(),
            lobes: Vec::new(),
        }
    }

    /// Voxels along x, y and z.
    pub fn size(&self) -> [usize; 3] {
        self.size
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        self.index.len() * 4 + self.voxels.len() * 4 + self.lobes.len() * 4
    }

    fn brick(&self, x: usize, y: usize, z: usize) -> usize {
        (z / BRICK * (self.size[1] / BRICK) + y / BRICK) * (self.size[0] / BRICK) + x / BRICK
    }

    /// The voxel at a place inside the grid.
    #[inline]
    pub fn get(&self, x: usize, y: usize, z: usize) -> PackedVoxel {
        match self.place(x, y, z) {
            Some(place) => self.voxels[place],
            None => PackedVoxel(0),
        }
    }

    /// Where a voxel is kept; `None` in a brick without matter.
    #[inline]
    fn place(&self, x: usize, y: usize, z: usize) -> Option<usize> {
        let brick = self.index[self.brick(x, y, z)];
        let within = (z % BRICK * BRICK + y % BRICK) * BRICK + x % BRICK;
        (brick != EMPTY).then_some(brick as usize * BRICK_VOXELS + within)
    }

    /// Whether voxels hold fibres that point apart: only then are there [`Lobes`].
    #[inline]
    pub fn coarse(&self) -> bool {
        !self.lobes.is_empty()
    }

    /// How far the fibres of a voxel inside the grid point apart.
    pub fn lobes(&self, x: usize, y: usize, z: usize) -> Lobes {
        let place = self.place(x, y, z);
        place
            .and_then(|place| self.lobes.get(place))
            .copied()
            .unwrap_or_default()
    }

    /// Appends the slab of bricks y = 8·`row`.. from a dense slab, x fastest, then y
    /// (8 rows), then z; `lobes` likewise, or none. Slabs come in any order, each once.
    pub(crate) fn put_slab(&mut self, row: usize, slab: &[PackedVoxel], lobes: &[Lobes]) {
        let [width, _, depth] = self.size;
        for brick_z in 0..depth / BRICK {
            for brick_x in 0..width / BRICK {
                let row_at = |y: usize, z: usize| {
                    ((brick_z * BRICK + z) * BRICK + y) * width + brick_x * BRICK
                };
                let start = self.voxels.len();
                for z in 0..BRICK {
                    for y in 0..BRICK {
                        self.voxels.extend(&slab[row_at(y, z)..][..BRICK]);
                    }
                }
                if self.voxels[start..].iter().all(|v| v.fill() == 0) {
                    self.voxels.truncate(start);
                } else {
                    let brick = self.brick(brick_x * BRICK, row * BRICK, brick_z * BRICK);
                    self.index[brick] = (start / BRICK_VOXELS) as u32;
                    for (y, z) in (0..BRICK).flat_map(|z| (0..BRICK).map(move |y| (y, z))) {
                        let row = lobes.get(row_at(y, z)..).unwrap_or_default();
                        self.lobes.extend(row.iter().take(BRICK));
                    }
                }
            }
        }
    }

    /// Visits the voxels of all bricks that hold matter.
    pub(crate) fn for_each(&self, mut visit: impl FnMut([usize; 3], PackedVoxel)) {
        let [width, height, _] = self.size.map(|n| n / BRICK);
        for (place, &brick) in self.index.iter().enumerate() {
            if brick == EMPTY {
                continue;
            }
            let corner = [
                place % width,
                place / width % height,
                place / width / height,
            ];
            let voxels = &self.voxels[brick as usize * BRICK_VOXELS..][..BRICK_VOXELS];
            for (i, &voxel) in voxels.iter().enumerate() {
                let within = [i % BRICK, i / BRICK % BRICK, i / BRICK / BRICK];
                visit(
                    std::array::from_fn(|a| corner[a] * BRICK + within[a]),
                    voxel,
                );
            }
        }
    }

    /// The parts that a file stores: sizes, brick index, voxels, lobes.
    pub(crate) fn parts(&self) -> ([usize; 3], &[u32], &[PackedVoxel], &[Lobes]) {
        (self.size, &self.index, &self.voxels, &self.lobes)
    }

    /// Puts stored parts together again; `None` when they do not fit each other.
    pub(crate) fn from_parts(
        size: [usize; 3],
        index: Vec<u32>,
        voxels: Vec<PackedVoxel>,
        lobes: Vec<Lobes>,
    ) -> Option<Self> {
        let bricks = voxels.len() / BRICK_VOXELS;
        let fits = size.iter().all(|n| *n > 0 && n % BRICK == 0)
            && index.len() == size.iter().map(|n| n / BRICK).product::<usize>()
            && voxels.len().is_multiple_of(BRICK_VOXELS)
            && (lobes.is_empty() || lobes.len() == voxels.len())
            && index.iter().all(|&i| i == EMPTY || (i as usize) < bricks);
        fits.then_some(Self {
            size,
            index,
            voxels,
            lobes,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_hold_their_coordinates() {
        for (coordinate, cell) in [(0.0, 0), (-0.0, 0), (-1e-9, -1), (-1.0, -1), (2.999, 2)] {
            assert_eq!(cell_of(coordinate), cell, "{coordinate}");
        }
        assert_eq!(cell_of(f32::NEG_INFINITY), i32::MIN);
        assert_eq!((cell_of(f32::INFINITY), cell_of(f32::NAN)), (i32::MAX, 0));
    }

    #[test]
    fn voxels_pack_and_unpack() {
        let voxel = PackedVoxel::new(0.5, Vec3::new(0.6, 0.0, 0.8), 4, true);
        assert_eq!(
            (voxel.fill(), voxel.yarn(), voxel.is_weft()),
            (128, 4, true)
        );
        assert!(voxel.direction().dot(Vec3::new(0.6, 0.0, 0.8)) > 0.999);
        assert_eq!(PackedVoxel::new(0.0, Vec3::X, 4, true), PackedVoxel(0));
    }

    #[test]
    fn slabs_read_back_and_empty_bricks_cost_nothing() {
        let mut volume = BrickVolume::new([16, 16, 8]);
        let mut slab = vec![PackedVoxel(0); 16 * 8 * 8];
        let voxel = PackedVoxel::new(1.0, Vec3::Y, 1, false);
        slab[(3 * 8 + 2) * 16 + 9] = voxel;
        volume.put_slab(1, &slab, &[]);
        assert_eq!(volume.get(9, 10, 3), voxel);
        assert_eq!(volume.get(8, 10, 3).fill(), 0);
        assert_eq!(volume.voxels.len(), BRICK_VOXELS);
    }
}
