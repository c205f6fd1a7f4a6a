//! The walk of a ray through the bricks of a grid, and where it must, through their voxels.

use glam::{IVec3, Vec3};

use super::{BLOCK, BRICK, BRICK_VOXELS, DenseGrid, NOT_STORED, Taps, index, inside};
use crate::render::{MajorantWalk, Stretch, Voxel};
use crate::scene::Ray;

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
    /// The first and last voxel of the current stretch, where the voxels of its brick are
    /// stored, and their scale.
    low: IVec3,
    high: IVec3,
    place: u32,
    scale: f32,
    /// The brick's majorants by voxel, where it has them and is not yet passed; the voxel to
    /// be visited next in it, and where the ray leaves it.
    fine: Option<&'g [f32; BRICK_VOXELS]>,
    cell: IVec3,
    leave: f32,
    t: f32,
    end: f32,
}

impl<'g> GridWalk<'g> {
    #[inline]
    pub(super) fn new(grid: &'g DenseGrid, ray: &Ray, t_max: f32) -> Self {
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
            high: IVec3::ZERO,
            place: NOT_STORED,
            scale: 0.0,
            fine: None,
            cell: IVec3::ZERO,
            leave: f32::NEG_INFINITY,
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

    /// One step on along an axis.
    #[inline(always)]
    fn step(&self, axis: usize) -> IVec3 {
        let step = |k: usize, far: i32| if k == axis { 2 * far - 1 } else { 0 };
        IVec3::new(
            step(0, self.far.x),
            step(1, self.far.y),
            step(2, self.far.z),
        )
    }

    /// Goes on to the next brick along an axis.
    #[inline(always)]
    fn advance(&mut self, axis: usize) {
        self.next += self.step(axis);
    }

    /// Enters a brick that has majorants by voxel; the ray leaves it at `leave`.
    fn enter(&mut self, brick: IVec3, leave: f32, fine: &'g [f32; BRICK_VOXELS]) {
        let point = self.origin + self.direction * self.t;
        let cell = IVec3::new(floor(point.x), floor(point.y), floor(point.z));
        let low = brick * BRICK;
        self.cell = cell.clamp(low, low + BRICK - 1);
        (self.fine, self.leave) = (Some(fine), leave);
    }

    /// The next voxel of such a brick that may hold matter; `None` behind the last.
    fn next_fine(&mut self, fine: &'g [f32; BRICK_VOXELS]) -> Option<Stretch> {
        let brick = self.cell >> 2;
        while self.cell >> 2 == brick && self.t < self.leave.min(self.end) {
            let (cell, start) = (self.cell, self.t);
            let (exit, axis) = self.exit(cell, 1);
            self.cell += self.step(axis);
            self.t = exit.max(start).min(self.leave);
            let majorant = fine[inside(cell)];
            if majorant > 0.0 {
                (self.low, self.high) = (cell, cell);
                return Some(Stretch {
                    start,
                    end: self.t.min(self.end),
                    majorant,
                });
            }
        }
        (self.fine, self.t) = (None, self.t.max(self.leave));
        None
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
            if let Some(fine) = self.fine {
                match self.next_fine(fine) {
                    Some(stretch) => return Some(stretch),
                    None => continue,
                }
            }
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
                self.advance(axis);
                if let Some(fine) = self.grid.fine.get(self.grid.fine_places[number] as usize) {
                    self.enter(brick, exit.max(start), fine);
                    continue;
                }
                let end = exit.max(start).min(self.end);
                self.low = brick * BRICK;
                self.high = self.low + BRICK - 1;
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
        // Rounding may put the point just outside its stretch, whose majorant holds here.
        let (low, high) = (self.low, self.high);
        match grid.taps {
            Taps::Nearest => {
                let cell = IVec3::new(floor(point.x), floor(point.y), floor(point.z));
                match grid.voxels.get(self.place as usize) {
                    Some(voxels) => grid.unpack(voxels[inside(cell.clamp(low, high))], self.scale),
                    None => Voxel::EMPTY,
                }
            }
            Taps::StochasticTrilinear => {
                let shifted = point + tap - 0.5;
                let cell = IVec3::new(floor(shifted.x), floor(shifted.y), floor(shifted.z))
                    .clamp(low - 1, high + 1)
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
