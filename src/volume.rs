//! Dense voxel grids that can be traced: nearest or stochastic one-tap lookup, majorant
//! bricks of 4³ voxels with a level of empty-space blocks (16³ voxels) above.
//!
//! Voxels are stored brick by brick, 8 bytes each (extinction as a share of the brick's
//! largest, two components of the direction, optics), so that a short flight touches half
//! a kilobyte; bricks without matter are not stored.

pub mod source;

use glam::{IVec3, Mat3, UVec3, Vec3};

use crate::render::{Bounds, MajorantWalk, Medium, Ray, Stretch, Voxel};

/// Voxels along the edge of a majorant brick.
const BRICK: i32 = 4;
/// Bricks along the edge of an empty-space block.
const BLOCK: i32 = 4;
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
    #[error("volume bounds {0:?}..{1:?} must be finite and ascend on every axis")]
    Bounds(Vec3, Vec3),
    /// More optics than a voxel can name.
    #[error("a volume of {0} optics: merge colours until there are at most 32767")]
    TooManyOptics(usize),
    /// No optics at all.
    #[error("a volume needs at least one entry of optics")]
    NoOptics,
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
            blocks,
            occupied: Vec::new(),
            mended,
            scale: size.as_vec3() / extent,
        };
        grid.build_majorants();
        Ok(grid)
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
        let inside = cell & 3;
        match self.voxels.get(self.places[brick] as usize) {
            Some(voxels) => {
                let number = ((inside.z << 4) | (inside.y << 2) | inside.x) as usize;
                self.unpack(voxels[number % BRICK_VOXELS], self.scales[brick])
            }
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
        self.majorants = match self.taps {
            Taps::Nearest => largest,
            // A tap may land one voxel outside the brick: bound its neighbours too.
            Taps::StochasticTrilinear => cells(self.bricks)
                .map(|brick| {
                    let low = (brick - 1).max(IVec3::ZERO);
                    let high = (brick + 1).min(self.bricks - 1);
                    box_cells(low, high).fold(0.0, |top: f32, b| top.max(largest[brick_index(b)]))
                })
                .collect(),
        };
        self.occupied = cells(self.blocks)
            .map(|block| {
                let low = block * BLOCK;
                let high = (low + BLOCK - 1).min(self.bricks - 1);
                box_cells(low, high).any(|b| self.majorants[brick_index(b)] > 0.0)
            })
            .collect();
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

/// A walk through the bricks of a [`DenseGrid`]: a 3-D DDA (Amanatides and Woo 1987)
/// whose exit distances are computed from whole brick numbers at every step, so that
/// errors do not add up, and whose bricks only ever advance, so that it ends.
#[derive(Debug)]
pub struct GridWalk<'g> {
    grid: &'g DenseGrid,
    /// Origin and direction in voxels.
    origin: Vec3,
    direction: Vec3,
    /// Distance at which the ray crosses the plane `x = k` is `k·inverse + bias`; +∞ on
    /// axes along which it does not move.
    inverse: Vec3,
    bias: Vec3,
    /// 1 where the ray ascends (the far side of a cell), else 0.
    far: IVec3,
    /// The brick to be visited next.
    next: IVec3,
    /// The first voxel of the current stretch's brick, where its voxels are stored, and
    /// their scale.
    low: IVec3,
    place: u32,
    scale: f32,
    t: f32,
    end: f32,
}

impl<'g> GridWalk<'g> {
    #[inline]
    fn new(grid: &'g DenseGrid, ray: &Ray, t_max: f32) -> Self {
        let origin = (ray.origin - grid.bounds.min) * grid.scale;
        let direction = ray.direction * grid.scale;
        let moves = direction.abs().cmpgt(Vec3::splat(1e-12));
        let inverse = Vec3::select(moves, direction.recip(), Vec3::ZERO);
        let bias = Vec3::select(moves, -origin * inverse, Vec3::INFINITY);
        let up = direction.cmpgt(Vec3::ZERO);
        let far = IVec3::select(up, IVec3::ONE, IVec3::ZERO);
        let top = grid.size.as_vec3();

        // Clip to the box; an axis along which the ray stands still is in or out.
        let still_outside = !moves & (origin.cmplt(Vec3::ZERO) | origin.cmpge(top));
        let near_plane = Vec3::select(up, Vec3::ZERO, top);
        let far_plane = Vec3::select(up, top, Vec3::ZERO);
        let enter = Vec3::select(moves, near_plane * inverse + bias, Vec3::NEG_INFINITY);
        let leave = far_plane * inverse + bias;
        let start = enter.max_element().max(0.0);
        let end = leave.min_element().min(t_max);
        let inside = !still_outside.any() && start < end;
        let entry = origin + direction * if inside { start } else { 0.0 };
        let cell = IVec3::new(floor(entry.x), floor(entry.y), floor(entry.z));
        let cell = cell.clamp(IVec3::ZERO, grid.size - 1);
        let brick = cell >> 2;
        Self {
            grid,
            origin,
            direction,
            inverse,
            bias,
            far,
            next: brick,
            low: IVec3::ZERO,
            place: NOT_STORED,
            scale: 0.0,
            t: start,
            end: if inside { end } else { f32::NEG_INFINITY },
        }
    }

    /// Where the ray leaves a cell of `edge` voxels, and through which axis.
    #[inline]
    fn exit(&self, cell: IVec3, edge: i32) -> (f32, usize) {
        let planes = ((cell + self.far) * edge).as_vec3() * self.inverse + self.bias;
        if planes.x < planes.y {
            if planes.x < planes.z {
                (planes.x, 0)
            } else {
                (planes.z, 2)
            }
        } else if planes.y < planes.z {
            (planes.y, 1)
        } else {
            (planes.z, 2)
        }
    }

    /// Goes on to the next brick along an axis.
    #[inline(always)]
    fn advance(&mut self, axis: usize) {
        let step = |k: usize, far: i32| if k == axis { 2 * far - 1 } else { 0 };
        self.next.x += step(0, self.far.x);
        self.next.y += step(1, self.far.y);
        self.next.z += step(2, self.far.z);
    }

    /// The first brick behind an empty block; only ever onwards along the ray.
    #[inline]
    fn behind_block(&self, block: IVec3, axis: usize, t: f32) -> IVec3 {
        let low = block * BLOCK;
        let high = low + BLOCK - 1;
        let point = self.origin + self.direction * t;
        let guess = (point * (1.0 / BRICK as f32)).floor().as_ivec3();
        let mut brick = guess.clamp(low, high);
        // Rounding must not turn the walk back on the other axes.
        let up = self.far.cmpeq(IVec3::ONE);
        brick = IVec3::select(up, brick.max(self.next), brick.min(self.next));
        brick[axis] = if self.far[axis] == 1 {
            high[axis] + 1
        } else {
            low[axis] - 1
        };
        brick
    }
}

impl MajorantWalk for GridWalk<'_> {
    #[inline]
    fn next_stretch(&mut self) -> Option<Stretch> {
        while self.t < self.end {
            let brick = self.next;
            if brick.cmplt(IVec3::ZERO).any() || brick.cmpge(self.grid.bricks).any() {
                return None;
            }
            let number = index(self.grid.bricks, brick);
            let majorant = self.grid.majorants[number];
            if majorant > 0.0 {
                self.place = self.grid.places[number];
                self.scale = self.grid.scales[number];
                let (exit, axis) = self.exit(brick, BRICK);
                let start = self.t;
                let end = exit.max(start).min(self.end);
                self.low = brick * BRICK;
                self.advance(axis);
                self.t = exit.max(start);
                return Some(Stretch {
                    start,
                    end,
                    majorant,
                });
            }
            let block = brick >> 2;
            if self.grid.occupied[index(self.grid.blocks, block)] {
                let (exit, axis) = self.exit(brick, BRICK);
                self.advance(axis);
                self.t = exit.max(self.t);
            } else {
                let (exit, axis) = self.exit(block, BRICK * BLOCK);
                self.t = exit.max(self.t);
                self.next = self.behind_block(block, axis, self.t);
            }
        }
        None
    }

    #[inline(always)]
    fn voxel(&self, t: f32, tap: Vec3, _: f32) -> Voxel {
        let point = self.origin + self.direction * t;
        let grid = self.grid;
        // Rounding may put the point just outside its brick, whose majorant holds here.
        let low = self.low;
        match grid.taps {
            Taps::Nearest => {
                let inside = |axis: usize| (floor(point[axis]) - low[axis]).clamp(0, BRICK - 1);
                let number = ((inside(2) << 4) | (inside(1) << 2) | inside(0)) as usize;
                match grid.voxels.get(self.place as usize) {
                    Some(voxels) => grid.unpack(voxels[number % BRICK_VOXELS], self.scale),
                    None => Voxel::EMPTY,
                }
            }
            Taps::StochasticTrilinear => {
                let shifted = point + tap - 0.5;
                let cell = IVec3::new(floor(shifted.x), floor(shifted.y), floor(shifted.z))
                    .clamp(low - 1, low + BRICK)
                    .clamp(IVec3::ZERO, grid.size - 1);
                grid.at(cell)
            }
        }
    }
}

/// The whole number below `x`, for |x| < 2²¹; on a whole number, it or the one below.
/// Anything else gives some number. Adding 1.5·2²³ rounds to the nearest whole number
/// without a library call.
#[inline(always)]
fn floor(x: f32) -> i32 {
    const SHIFT: f32 = 12_582_912.0;
    ((x - 0.5) + SHIFT).to_bits() as i32 - SHIFT.to_bits() as i32
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
