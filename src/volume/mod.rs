//! Dense voxel grids that can be traced: nearest or stochastic one-tap lookup, majorant
//! bricks of 4³ voxels with a level of empty-space blocks (16³ voxels) above. Bricks in
//! which a few voxels are far denser than the rest have a majorant for each voxel, so that
//! a single one does not cost every ray that passes near it.
//!
//! Voxels are stored brick by brick, 8 bytes each (extinction as a share of the brick's
//! largest, two components of the direction, optics), so that a short flight touches half
//! a kilobyte; bricks without matter are not stored.

pub mod cells;
pub mod source;
mod walk;

use glam::{IVec3, Mat3, UVec3, Vec3};
use rayon::prelude::*;

use crate::render::{Medium, Voxel};
use crate::scene::{Bounds, Ray};

pub use walk::GridWalk;

/// Voxels along the edge of a majorant brick.
const BRICK: i32 = 4;
/// Bricks along the edge of an empty-space block.
const BLOCK: i32 = 4;
/// Tentative collisions on the way through a brick above which it is worth walking voxel by
/// voxel, and how many times denser than the mean of its voxels the densest then is.
const RUGGED: [f32; 2] = [16.0, 1.25];
/// Voxels in a brick.
const BRICK_VOXELS: usize = (BRICK * BRICK * BRICK) as usize;

/// How a grid answers between its voxel centres.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Taps {
    /// The voxel that holds the point.
    #[default]
    Nearest,
    /// One of the eight voxels around the point, with its trilinear weight as
    /// probability: a mixture of flakes in the mean, never a mixed flake.
    StochasticTrilinear,
}

/// Colour and gloss shared by many voxels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Optics {
    /// Single-scattering albedo, linear RGB, 0..=1.
    pub albedo: Vec3,
    /// SGGX roughness α, 0.01..=1.
    pub alpha: f32,
}

/// One voxel as it is given to [`DenseGrid::from_fn`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GridVoxel {
    /// Extinction across the fibres, 1/mm.
    pub sigma: f32,
    /// Fibre direction, any length but 0; t and −t mean the same.
    pub direction: Vec3,
    /// Index into the grid's optics.
    pub optics: u32,
}

impl GridVoxel {
    /// Empty space.
    pub const EMPTY: Self = Self {
        sigma: 0.0,
        direction: Vec3::Z,
        optics: 0,
    };
}

/// What had to be mended in the voxels given to a grid.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Mended {
    /// Extinctions that were NaN, infinite or negative: made 0.
    pub extinctions: u64,
    /// Directions of no length or not finite in voxels with matter: made z, α = 1.
    pub directions: u64,
    /// Optics beyond the table: made 0.
    pub optics: u64,
    /// Optics with an albedo outside 0..=1 or an α outside 0.01..=1: clamped.
    pub materials: u64,
}

/// Why a grid could not be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum VolumeError {
    /// A side of no voxels.
    #[error("volume of {0}x{1}x{2} voxels: every side needs at least one voxel")]
    Empty(u32, u32, u32),
    /// More voxels than can be addressed.
    #[error("volume of {0}x{1}x{2} voxels is too large: choose a smaller region or coarser voxels")]
    TooLarge(u32, u32, u32),
    /// Bounds without volume.
    #[error("a volume from {} to {}: its corners must be finite and ascend on every axis", corner(*.0), corner(*.1))]
    Bounds(Vec3, Vec3),
    /// More optics than a voxel can name.
    #[error("a volume of {0} optics: merge colours until there are at most 32767")]
    TooManyOptics(usize),
    /// No optics at all.
    #[error("a volume needs at least one entry of optics")]
    NoOptics,
}

/// A place for people: its coordinates in mm.
pub(crate) fn corner(place: Vec3) -> String {
    format!("({}, {}, {}) mm", place.x, place.y, place.z)
}

/// One stored voxel: 8 bytes.
#[derive(Debug, Clone, Copy)]
struct Packed {
    /// In units of the brick's scale; 0 = empty.
    sigma: u16,
    /// x and y of the direction in units of 1/32767; z is the positive root.
    x: i16,
    y: i16,
    optics: u16,
}

const EMPTY: Packed = Packed {
    sigma: 0,
    x: 0,
    y: 0,
    optics: 0,
};

/// Where a brick's voxels would begin if it had any matter.
const NOT_STORED: u32 = u32::MAX;

/// A dense grid of fibre voxels in an axis-aligned box.
#[derive(Debug, Clone)]
pub struct DenseGrid {
    size: IVec3,
    bounds: Bounds,
    taps: Taps,
    /// Voxels of the bricks with matter, one brick after the other, x fastest in each.
    voxels: Vec<[Packed; BRICK_VOXELS]>,
    optics: Vec<Optics>,
    bricks: IVec3,
    /// Where each brick is in `voxels`, or [`NOT_STORED`].
    places: Vec<u32>,
    /// Extinction of one unit in each brick.
    scales: Vec<f32>,
    majorants: Vec<f32>,
    /// Where the majorants of a brick's voxels are in `fine`, or [`NOT_STORED`].
    fine_places: Vec<u32>,
    fine: Vec<[f32; BRICK_VOXELS]>,
    blocks: IVec3,
    /// Whether any brick of the block has matter.
    occupied: Vec<bool>,
    mended: Mended,
    scale: Vec3,
}

impl DenseGrid {
    /// Makes a grid of `size` voxels in `bounds` (mm) by asking `voxel` for every cell.
    /// Bad voxels are mended and counted, see [`DenseGrid::mended`].
    pub fn from_fn(
        size: UVec3,
        bounds: Bounds,
        optics: Vec<Optics>,
        taps: Taps,
        mut voxel: impl FnMut(UVec3) -> GridVoxel,
    ) -> Result<Self, VolumeError> {
        let (nx, ny, nz) = (size.x, size.y, size.z);
        if size.min_element() == 0 {
            return Err(VolumeError::Empty(nx, ny, nz));
        }
        let count = u128::from(nx) * u128::from(ny) * u128::from(nz);
        if size.max_element() > 1 << 20 || count > 1 << 34 {
            return Err(VolumeError::TooLarge(nx, ny, nz));
        }
        let extent = bounds.max - bounds.min;
        if !(bounds.min.is_finite() && bounds.max.is_finite() && extent.min_element() > 0.0) {
            return Err(VolumeError::Bounds(bounds.min, bounds.max));
        }
        if optics.is_empty() {
            return Err(VolumeError::NoOptics);
        }
        if optics.len() > usize::from(u16::MAX) / 2 {
            return Err(VolumeError::TooManyOptics(optics.len()));
        }
        let mut mended = Mended::default();
        let mut optics: Vec<Optics> = optics
            .into_iter()
            .map(|one| mend_optics(one, &mut mended))
            .collect();
        // An isotropic twin of every entry serves voxels whose direction is lost.
        let isotropic = optics.len() as u32;
        let twins: Vec<Optics> = optics.iter().map(|o| Optics { alpha: 1.0, ..*o }).collect();
        optics.extend(twins);

        let size = size.as_ivec3();
        let bricks = (size + BRICK - 1) / BRICK;
        let mut voxels = Vec::new();
        let (mut places, mut scales) = (Vec::new(), Vec::new());
        for brick in cells(bricks) {
            let low = brick * BRICK;
            let mut cell_of = |inside: IVec3| {
                let cell = low + inside;
                if cell.cmplt(size).all() {
                    mend(voxel(cell.as_uvec3()), isotropic, &mut mended)
                } else {
                    GridVoxel::EMPTY
                }
            };
            let given: Vec<GridVoxel> = cells(IVec3::splat(BRICK)).map(&mut cell_of).collect();
            let largest = given.iter().fold(0.0, |top: f32, v| top.max(v.sigma));
            let scale = largest / f32::from(u16::MAX);
            let place = if scale > 0.0 {
                let mut packed = [EMPTY; BRICK_VOXELS];
                for (packed, voxel) in packed.iter_mut().zip(&given) {
                    *packed = pack(voxel, scale);
                }
                voxels.push(packed);
                voxels.len() as u32 - 1
            } else {
                NOT_STORED
            };
            places.push(place);
            scales.push(scale);
        }
        let blocks = (bricks + BLOCK - 1) / BLOCK;
        let mut grid = Self {
            size,
            bounds,
            taps,
            voxels,
            optics,
            bricks,
            places,
            scales,
            majorants: Vec::new(),
            fine_places: Vec::new(),
            fine: Vec::new(),
            blocks,
            occupied: Vec::new(),
            mended,
            scale: size.as_vec3() / extent,
        };
        grid.build_majorants();
        Ok(grid)
    }

    /// Bytes of a grid of `size` voxels, of which so many bricks of 4³ have matter.
    pub fn bytes(size: UVec3, filled: u64) -> u64 {
        let brick = |side: u32| u64::from(side.div_ceil(BRICK as u32));
        let bricks = size.to_array().map(brick).into_iter().product::<u64>();
        // Places, scales, majorants and where finer ones are; and the latter while they are made.
        let around = 4 * size_of::<f32>() as u64 + size_of::<usize>() as u64;
        // Voxels, and their majorants where bricks have such.
        let brick = size_of::<[Packed; BRICK_VOXELS]>() + size_of::<[f32; BRICK_VOXELS]>();
        filled * brick as u64 + bricks * around
    }

    /// Voxels along each axis.
    pub fn size(&self) -> UVec3 {
        self.size.as_uvec3()
    }

    /// What had to be mended on construction.
    pub fn mended(&self) -> Mended {
        self.mended
    }

    /// Every optics: those given, then an isotropic twin of each.
    pub fn all_optics(&self) -> &[Optics] {
        &self.optics
    }

    /// The largest extinction of any voxel, 1/mm.
    pub fn densest(&self) -> f32 {
        let largest = self
            .scales
            .iter()
            .fold(0.0, |top: f32, &scale| top.max(scale));
        largest * f32::from(u16::MAX)
    }

    /// The voxel of a cell, which must lie inside.
    pub fn cell(&self, cell: UVec3) -> Voxel {
        self.at(cell.as_ivec3())
    }

    #[inline]
    fn at(&self, cell: IVec3) -> Voxel {
        let brick = index(self.bricks, cell >> 2);
        match self.voxels.get(self.places[brick] as usize) {
            Some(voxels) => self.unpack(voxels[inside(cell)], self.scales[brick]),
            None => Voxel::EMPTY,
        }
    }

    /// The colour and gloss of an optics id.
    pub fn optics(&self, id: u32) -> Optics {
        self.optics[(id as usize).min(self.optics.len() - 1)]
    }

    fn build_majorants(&mut self) {
        let largest: Vec<f32> = self
            .scales
            .iter()
            .map(|scale| scale * f32::from(u16::MAX))
            .collect();
        let brick_index = |b: IVec3| index(self.bricks, b);
        let numbered = (0..largest.len()).into_par_iter();
        self.majorants = match self.taps {
            Taps::Nearest => largest,
            // A tap may land one voxel outside the brick.
            Taps::StochasticTrilinear => numbered
                .map(|number| {
                    let brick = cell_of(self.bricks, number);
                    let low = (brick - 1).max(IVec3::ZERO);
                    let high = (brick + 1).min(self.bricks - 1);
                    let around = box_cells(low, high)
                        .fold(0.0, |top: f32, b| top.max(largest[brick_index(b)]));
                    // Looking closer pays where the neighbours are much denser.
                    if around <= 1.5 * largest[number] {
                        return around;
                    }
                    self.densest_tap(brick * BRICK, brick * BRICK + BRICK - 1)
                })
                .collect(),
        };
        let across = self.scale.max_element().recip() * BRICK as f32;
        let fine: Vec<Option<Box<[f32; BRICK_VOXELS]>>> = (0..self.majorants.len())
            .into_par_iter()
            .map(|number| self.fine_majorants(number, across))
            .collect();
        self.fine_places = Vec::with_capacity(fine.len());
        for majorants in fine {
            self.fine_places.push(match majorants {
                Some(majorants) => {
                    self.fine.push(*majorants);
                    self.fine.len() as u32 - 1
                }
                None => NOT_STORED,
            });
        }
        self.occupied = cells(self.blocks)
            .map(|block| {
                let low = block * BLOCK;
                let high = (low + BLOCK - 1).min(self.bricks - 1);
                box_cells(low, high).any(|b| self.majorants[brick_index(b)] > 0.0)
            })
            .collect();
    }

    /// The largest extinction that a lookup between two voxels, both included, can find.
    fn densest_tap(&self, low: IVec3, high: IVec3) -> f32 {
        let reach = match self.taps {
            Taps::Nearest => 0,
            Taps::StochasticTrilinear => 1,
        };
        let low = (low - reach).max(IVec3::ZERO);
        let high = (high + reach).min(self.size - 1);
        box_cells(low, high).fold(0.0, |top: f32, cell| top.max(self.at(cell).sigma))
    }

    /// Majorants of the voxels of a brick that is `across` mm wide, where it is worth having
    /// them.
    fn fine_majorants(&self, number: usize, across: f32) -> Option<Box<[f32; BRICK_VOXELS]>> {
        let majorant = self.majorants[number];
        if !(majorant * across > RUGGED[0]) {
            return None;
        }
        let low = cell_of(self.bricks, number) * BRICK;
        let mut fine = Box::new([0.0f32; BRICK_VOXELS]);
        for (majorant, inside) in fine.iter_mut().zip(cells(IVec3::splat(BRICK))) {
            let cell = low + inside;
            if cell.cmplt(self.size).all() {
                *majorant = self.densest_tap(cell, cell);
            }
        }
        let mean = fine
            .iter()
            .map(|sigma| sigma / BRICK_VOXELS as f32)
            .sum::<f32>();
        (mean * RUGGED[1] < majorant).then_some(fine)
    }

    #[inline(always)]
    fn unpack(&self, packed: Packed, scale: f32) -> Voxel {
        if packed.sigma == 0 {
            return Voxel::EMPTY;
        }
        let x = f32::from(packed.x) * (1.0 / 32767.0);
        let y = f32::from(packed.y) * (1.0 / 32767.0);
        let z = (1.0 - x * x - y * y).max(0.0).sqrt();
        Voxel {
            sigma: f32::from(packed.sigma) * scale,
            direction: Vec3::new(x, y, z),
            alpha: self.optics[usize::from(packed.optics)].alpha,
            optics: u32::from(packed.optics),
        }
    }
}

fn mend_optics(optics: Optics, mended: &mut Mended) -> Optics {
    let albedo = Vec3::from_array(optics.albedo.to_array().map(|a| {
        // NaN fails both comparisons and becomes 0.
        if a >= 1.0 {
            1.0
        } else if a > 0.0 {
            a
        } else {
            0.0
        }
    }));
    let alpha = if optics.alpha.is_nan() {
        1.0
    } else {
        optics.alpha.clamp(0.01, 1.0)
    };
    let result = Optics { albedo, alpha };
    mended.materials += u64::from(result != optics);
    result
}

/// The voxel with sound numbers, unit direction and optics in the table.
fn mend(voxel: GridVoxel, isotropic: u32, mended: &mut Mended) -> GridVoxel {
    if !(voxel.sigma.is_finite() && voxel.sigma >= 0.0) {
        mended.extinctions += 1;
        return GridVoxel::EMPTY;
    }
    if voxel.sigma == 0.0 {
        return GridVoxel::EMPTY;
    }
    let mut optics = voxel.optics;
    if optics >= isotropic {
        mended.optics += 1;
        optics = 0;
    }
    let direction = match voxel.direction.try_normalize() {
        Some(direction) => direction,
        None => {
            mended.directions += 1;
            optics += isotropic;
            Vec3::Z
        }
    };
    GridVoxel {
        sigma: voxel.sigma,
        direction,
        optics,
    }
}

/// A mended voxel in 8 bytes. What has matter keeps some.
fn pack(voxel: &GridVoxel, scale: f32) -> Packed {
    if voxel.sigma <= 0.0 {
        return EMPTY;
    }
    let upper = if voxel.direction.z < 0.0 {
        -voxel.direction
    } else {
        voxel.direction
    };
    Packed {
        sigma: (voxel.sigma / scale).round().max(1.0) as u16,
        x: (upper.x * 32767.0).round() as i16,
        y: (upper.y * 32767.0).round() as i16,
        optics: voxel.optics as u16,
    }
}

#[inline]
fn index(size: IVec3, cell: IVec3) -> usize {
    ((cell.z as usize * size.y as usize) + cell.y as usize) * size.x as usize + cell.x as usize
}

/// A cell's number in its brick.
#[inline(always)]
fn inside(cell: IVec3) -> usize {
    let inside = cell & 3;
    ((inside.z << 4) | (inside.y << 2) | inside.x) as usize % BRICK_VOXELS
}

/// The cell of a number that [`index`] gives.
fn cell_of(size: IVec3, number: usize) -> IVec3 {
    let (nx, ny) = (size.x as usize, size.y as usize);
    IVec3::new(
        (number % nx) as i32,
        (number / nx % ny) as i32,
        (number / nx / ny) as i32,
    )
}

/// All cells of a grid, x fastest.
fn cells(size: IVec3) -> impl Iterator<Item = IVec3> {
    box_cells(IVec3::ZERO, size - 1)
}

/// All cells of a box, both corners included, x fastest.
fn box_cells(low: IVec3, high: IVec3) -> impl Iterator<Item = IVec3> {
    (low.z..=high.z).flat_map(move |z| {
        (low.y..=high.y).flat_map(move |y| (low.x..=high.x).map(move |x| IVec3::new(x, y, z)))
    })
}

impl Medium for DenseGrid {
    type Walk<'m> = GridWalk<'m>;

    fn bounds(&self) -> Bounds {
        self.bounds
    }

    #[inline]
    fn walk(&self, ray: &Ray, t_max: f32) -> GridWalk<'_> {
        GridWalk::new(self, ray, t_max)
    }

    fn albedo(&self, optics: u32) -> Vec3 {
        self.optics(optics).albedo
    }
}

/// The SGGX matrix I − (1−α²)ttᵀ of a voxel, for formats that store matrices.
pub fn sggx_matrix(direction: Vec3, alpha: f32) -> Mat3 {
    let spread = 1.0 - alpha * alpha;
    let outer = Mat3::from_cols(
        direction * direction.x,
        direction * direction.y,
        direction * direction.z,
    );
    Mat3::IDENTITY - outer * spread
}
