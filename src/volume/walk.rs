//! The walk of a ray through the bricks of a grid, and where it must, through their voxels.

use glam::{IVec3, Vec3};

use super::cells::CellRay;
use super::{BLOCK, BRICK, BRICK_VOXELS, DenseGrid, NOT_STORED, Taps, index, inside};
use crate::render::{MajorantWalk, Stretch, Voxel};
use crate::scene::Ray;

/// A walk through the bricks of a [`DenseGrid`], which only ever advance, so that it ends.
#[derive(Debug)]
pub struct GridWalk<'g> {
    grid: &'g DenseGrid,
    /// The ray in voxels.
    ray: CellRay,
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
        let ray = CellRay::new(ray, grid.bounds.min, grid.scale);
        let (enter, leave) = ray.clip(grid.size.as_vec3());
        let (start, end) = (enter.max(0.0), leave.min(t_max));
        let inside = start < end;
        let entry = ray.at(if inside { start } else { 0.0 });
        let cell = IVec3::new(floor(entry.x), floor(entry.y), floor(entry.z));
        let cell = cell.clamp(IVec3::ZERO, grid.size - 1);
        let brick = cell >> 2;
        Self {
            grid,
            ray,
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

    /// Enters a brick that has majorants by voxel; the ray leaves it at `leave`.
    fn enter(&mut self, brick: IVec3, leave: f32, fine: &'g [f32; BRICK_VOXELS]) {
        let point = self.ray.at(self.t);
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
            let (exit, axis) = self.ray.exit(cell, 1);
            self.cell += self.ray.stride(axis);
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
        let point = self.ray.at(t);
        let guess = (point * (1.0 / BRICK as f32)).floor().as_ivec3();
        let mut brick = guess.clamp(low, high);
        // Rounding must not turn the walk back on the other axes.
        let up = self.ray.far().cmpeq(IVec3::ONE);
        brick = IVec3::select(up, brick.max(self.next), brick.min(self.next));
        brick[axis] = if self.ray.step(axis) > 0 {
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
                let (exit, axis) = self.ray.exit(brick, BRICK);
                let start = self.t;
                self.next += self.ray.stride(axis);
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
                let (exit, axis) = self.ray.exit(brick, BRICK);
                self.next += self.ray.stride(axis);
                self.t = exit.max(self.t);
            } else {
                let (exit, axis) = self.ray.exit(block, BRICK * BLOCK);
                self.t = exit.max(self.t);
                self.next = self.behind_block(block, axis, self.t);
            }
        }
        None
    }

    #[inline(always)]
    fn voxel(&self, t: f32, tap: Vec3, _: f32) -> Voxel {
        let point = self.ray.at(t);
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
