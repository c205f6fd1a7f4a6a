//! A ray's walk through the cloth: crossing by crossing, and inside each through its
//! block's majorant cells by a 3-D digital differential analyser.

use glam::{IVec3, Vec3};

use super::build::ClothVolume;
use super::levels::series;
use super::lookup::Crossing;
use crate::design::Positions;
use crate::exemplar::{CELL, cell_of};
use crate::render::{Arrival, MajorantWalk, Medium, PLACE, Stretch, Voxel};
use crate::scene::{Bounds, Ray};
use crate::volume::cells::{CellRay, first};

/// Half the side of the largest cloth, mm: rays leave it at last.
pub const REACH_MM: f32 = 4000.0;
/// Most crossings that one walk visits.
const MAX_CROSSINGS: u32 = 200_000;

/// One walk; see [`Medium::walk`].
pub struct ClothWalk<'a> {
    cloth: &'a ClothVolume,
    ray: Ray,
    t: f32,
    t_end: f32,
    end: i64,
    pick: i64,
    crossing: Option<Crossing<'a>>,
    cells: Cells,
    left: u32,
    /// Set before the first crossing is entered.
    fresh: bool,
}

/// State of the walk through one block's cells.
#[derive(Clone, Copy, Default)]
struct Cells {
    /// Where the ray leaves the crossing.
    t_out: f32,
    /// Whether it leaves through a side in x (else in y).
    out_x: bool,
    /// The ray in the block's cells.
    ray: CellRay,
    /// Whether there are cells to walk through.
    active: bool,
    cell: [i32; 3],
    /// Where the ray leaves that cell on each axis.
    next: [f32; 3],
}

impl Medium for ClothVolume {
    type Walk<'m> = ClothWalk<'m>;

    fn bounds(&self) -> Bounds {
        let (low, high) = self.height_range();
        let span = |threads: &Positions| {
            let [from, to] = [0, threads.threads()].map(|thread| threads.start(thread.into()));
            (from as f32, to as f32)
        };
        let mut bounds = Bounds {
            min: Vec3::new(-REACH_MM, -REACH_MM, low),
            max: Vec3::new(REACH_MM, REACH_MM, high),
        };
        // Where the design does not repeat, the cloth ends with it.
        if self.lattice.across == crate::design::Repeat::None {
            (bounds.min.x, bounds.max.x) = span(&self.ends);
        }
        if self.lattice.along == crate::design::Repeat::None {
            (bounds.min.y, bounds.max.y) = span(&self.picks);
        }
        bounds
    }

    fn walk(&self, ray: &Ray, t_max: f32) -> ClothWalk<'_> {
        let (t, t_end) = self.bounds().clip(ray, t_max);
        let entry = ray.at(t);
        ClothWalk {
            cloth: self,
            ray: *ray,
            t,
            t_end,
            end: self.ends.locate(f64::from(entry.x)).0,
            pick: self.picks.locate(f64::from(entry.y)).0,
            crossing: None,
            cells: Cells::default(),
            left: MAX_CROSSINGS,
            fresh: true,
        }
    }

    fn albedo(&self, optics: u32) -> Vec3 {
        self.albedo
            .get((optics & !PLACE) as usize)
            .copied()
            .unwrap_or(Vec3::ZERO)
    }

    #[inline]
    fn gain(&self, arrival: &Arrival) -> f32 {
        let (number, yarn) = series::correction(arrival.optics);
        (self.gains.get(number)).map_or(1.0, |gains| gains[yarn].at(arrival))
    }
}

impl ClothWalk<'_> {
    /// Leaves the present crossing, if any, and enters the next; false at the end.
    fn enter(&mut self) -> bool {
        if self.fresh {
            self.fresh = false;
        } else {
            let direction = self.ray.direction;
            if self.cells.out_x {
                self.end += if direction.x > 0.0 { 1 } else { -1 };
            } else {
                self.pick += if direction.y > 0.0 { 1 } else { -1 };
            }
            self.t = self.t.max(self.cells.t_out);
        }
        if !(self.t < self.t_end) || self.left == 0 {
            return false;
        }
        self.left -= 1;
        let (x_out, y_out) = (self.side_x(), self.side_y());
        let side = x_out.min(y_out);
        self.cells.out_x = x_out <= y_out;
        self.cells.t_out = side.min(self.t_end).max(self.t);
        self.cells.active = false;
        self.crossing = self.cloth.crossing(self.end, self.pick);
        if self.crossing.is_some() {
            self.set_up_cells();
        }
        true
    }

    /// Where the ray leaves the present end.
    fn side_x(&self) -> f32 {
        let (origin, direction) = (self.ray.origin.x, self.ray.direction.x);
        leave(origin, direction, |up| self.cloth.ends.start(self.end + up))
    }

    /// Where the ray leaves the present pick.
    fn side_y(&self) -> f32 {
        let (origin, direction) = (self.ray.origin.y, self.ray.direction.y);
        leave(origin, direction, |up| {
            self.cloth.picks.start(self.pick + up)
        })
    }

    /// Sets up the walk through the majorant cells of the crossing just entered.
    fn set_up_cells(&mut self) {
        let Some(crossing) = &self.crossing else {
            return;
        };
        let count = self.cloth.majorants.cells();
        let scale = 1.0 / CELL as f32;
        let per_mm = Vec3::new(
            crossing.per_mm[0] * scale,
            crossing.per_mm[1] * scale,
            scale / self.cloth.grid.voxel_mm.z,
        );
        let corner = Vec3::new(
            crossing.corner[0],
            crossing.corner[1],
            self.cloth.floor_mm(),
        );
        let ray = CellRay::new(&self.ray, corner, per_mm);
        let entry = ray.at(self.t);
        let last = IVec3::from_array(count.map(|count| count as i32 - 1));
        let cell = IVec3::from_array(entry.to_array().map(cell_of)).clamp(IVec3::ZERO, last);
        (self.cells.cell, self.cells.next) = (cell.to_array(), ray.leaves_all(cell));
        (self.cells.ray, self.cells.active) = (ray, true);
    }
}

/// Distance at which a ray leaves a thread's stretch; `start(0)` and `start(1)` bound it.
fn leave(origin: f32, direction: f32, start: impl Fn(i64) -> f64) -> f32 {
    if direction.abs() < 1e-12 {
        return f32::INFINITY;
    }
    let side = start(i64::from(direction > 0.0)) as f32;
    (side - origin) / direction
}

impl MajorantWalk for ClothWalk<'_> {
    fn next_stretch(&mut self) -> Option<Stretch> {
        loop {
            if !self.cells.active {
                if !self.enter() {
                    return None;
                }
                continue;
            }
            let Some(crossing) = &self.crossing else {
                self.cells.active = false;
                continue;
            };
            let [columns, _, layers] = self.cloth.majorants.cells();
            let fills = self
                .cloth
                .majorants
                .block(crossing.block.set, crossing.block.block);
            let [warp, weft] = &self.cloth.matter[usize::from(crossing.block.set)];
            // Pass over empty cells.
            loop {
                let cells = &mut self.cells;
                let [x, y, z] = cells.cell;
                let index = (y as usize * columns + x as usize) * layers + z as usize;
                let fill = fills.get(index).copied().unwrap_or(0);
                let axis = first(cells.next);
                let (start, until) = (self.t, cells.next[axis].min(cells.t_out).max(self.t));
                self.t = until;
                let counts = self.cloth.majorants.cells();
                let next = cells.cell[axis] + cells.ray.step(axis);
                if !(cells.next[axis] < cells.t_out) || next < 0 || next >= counts[axis] as i32 {
                    // The last stretch of a crossing runs to its border.
                    self.t = cells.t_out;
                    cells.active = false;
                } else {
                    cells.cell[axis] = next;
                    cells.next[axis] = cells.ray.leaves(axis, next);
                }
                let until = self.t;
                if fill > 0 && until > start {
                    let majorant = warp.at(fill).max(weft.at(fill));
                    return Some(Stretch {
                        start,
                        end: until,
                        majorant,
                    });
                }
                if !self.cells.active {
                    break;
                }
            }
        }
    }

    #[inline]
    fn voxel(&self, t: f32, tap: Vec3, least: f32) -> Voxel {
        let Some(crossing) = &self.crossing else {
            return Voxel::EMPTY;
        };
        let cloth = self.cloth;
        let point = self.ray.at(t);
        let [bx, by, _] = cloth.grid.block;
        // The stretch lies in this crossing; rounding may not carry it outside.
        let mut local = Vec3::new(
            ((point.x - crossing.corner[0]) * crossing.per_mm[0]).clamp(0.0, bx as f32 - 1e-3),
            ((point.y - crossing.corner[1]) * crossing.per_mm[1]).clamp(0.0, by as f32 - 1e-3),
            (point.z - cloth.grid.floor_mm()) / cloth.grid.voxel_mm.z,
        );
        if cloth.settings.tap {
            local += tap - 0.5;
        }
        cloth.voxel_near(crossing, local, least, Some(tap.z))
    }
}
