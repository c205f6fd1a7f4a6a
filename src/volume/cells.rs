//! The walk of a ray through the cells of a regular grid: a 3-D digital differential analyser
//! (Amanatides and Woo 1987) whose exit distances are computed from whole cell numbers at
//! every step, so that errors do not add up. Dense grids, cloth and hairs all walk like this.

use glam::{IVec3, Vec3};

use crate::scene::Ray;

/// Directions shorter than this, in cells a mm, stand still along their axis.
const STILL: f32 = 1e-12;

/// A ray in cells of a grid. What is read axis by axis stands in arrays.
#[derive(Debug, Clone, Copy, Default)]
pub struct CellRay {
    origin: Vec3,
    direction: Vec3,
    /// Cells per mm turned round along axes on which it moves, else 1.
    inverse: [f32; 3],
    /// Its origin along axes on which it moves, else −∞: it reaches no plane there.
    from: [f32; 3],
    /// 1 where it ascends: the far side of a cell; else 0.
    far: [i32; 3],
}

impl CellRay {
    /// A ray in cells that are counted from `corner` (mm), so many of them per mm along each
    /// axis; a negative number counts the other way.
    #[inline]
    pub fn new(ray: &Ray, corner: Vec3, cells_per_mm: Vec3) -> Self {
        let origin = (ray.origin - corner) * cells_per_mm;
        let direction = ray.direction * cells_per_mm;
        let moves = direction.abs().cmpgt(Vec3::splat(STILL));
        Self {
            origin,
            direction,
            inverse: Vec3::select(moves, direction.recip(), Vec3::ONE).to_array(),
            from: Vec3::select(moves, origin, Vec3::NEG_INFINITY).to_array(),
            far: direction.to_array().map(|along| i32::from(along > 0.0)),
        }
    }

    /// Where it is at a distance (mm), in cells.
    #[inline(always)]
    pub fn at(&self, t: f32) -> Vec3 {
        self.origin + self.direction * t
    }

    /// The distances at which it enters and leaves a box of cells from 0 to `size`; the former
    /// is not the smaller one where it misses the box. NaN gives no box.
    #[inline]
    pub fn clip(&self, size: Vec3) -> (f32, f32) {
        let from = Vec3::from_array(self.from);
        let moves = from.cmpgt(Vec3::NEG_INFINITY);
        // An axis along which it stands still is in or out.
        let inside = self.origin.cmpge(Vec3::ZERO) & self.origin.cmplt(size);
        if !(moves | inside).all() {
            return (f32::INFINITY, f32::NEG_INFINITY);
        }
        let up = self.far().cmpeq(IVec3::ONE);
        let inverse = Vec3::from_array(self.inverse);
        let near = (Vec3::select(up, Vec3::ZERO, size) - from) * inverse;
        let far = (Vec3::select(up, size, Vec3::ZERO) - from) * inverse;
        let enter = Vec3::select(moves, near, Vec3::NEG_INFINITY);
        (enter.max_element(), far.min_element())
    }

    /// The distance at which it leaves the cells of this number along an axis.
    #[inline(always)]
    pub fn leaves(&self, axis: usize, cell: i32) -> f32 {
        ((cell + self.far[axis]) as f32 - self.from[axis]) * self.inverse[axis]
    }

    /// The distances at which it leaves a cell along the three axes.
    #[inline(always)]
    pub fn leaves_all(&self, cell: IVec3) -> [f32; 3] {
        self.distances((cell + self.far()).as_vec3()).to_array()
    }

    /// Where it leaves a cell that is `edge` cells wide, and through which axis; `cell` counts
    /// such wide ones.
    #[inline(always)]
    pub fn exit(&self, cell: IVec3, edge: i32) -> (f32, usize) {
        self.first_of(((cell + self.far()) * edge).as_vec3())
    }

    /// Where it leaves the cube of cells that reaches `reach` cells beyond this one on every
    /// side, and through which axis.
    #[inline(always)]
    pub fn exit_cube(&self, cell: IVec3, reach: i32) -> (f32, usize) {
        let way = self.far() * 2 - 1;
        self.first_of((cell + self.far()).as_vec3() + (way * reach).as_vec3())
    }

    /// The distances at which it meets planes, one across each axis.
    #[inline(always)]
    fn distances(&self, planes: Vec3) -> Vec3 {
        (planes - Vec3::from_array(self.from)) * Vec3::from_array(self.inverse)
    }

    #[inline(always)]
    fn first_of(&self, planes: Vec3) -> (f32, usize) {
        let distances = self.distances(planes);
        if distances.x < distances.y {
            if distances.x < distances.z {
                (distances.x, 0)
            } else {
                (distances.z, 2)
            }
        } else if distances.y < distances.z {
            (distances.y, 1)
        } else {
            (distances.z, 2)
        }
    }

    /// Which way it goes along an axis: +1 or −1.
    #[inline(always)]
    pub fn step(&self, axis: usize) -> i32 {
        2 * self.far[axis] - 1
    }

    /// One step on along an axis.
    #[inline(always)]
    pub fn stride(&self, axis: usize) -> IVec3 {
        let step = |k: usize, far: i32| if k == axis { 2 * far - 1 } else { 0 };
        let [x, y, z] = self.far;
        IVec3::new(step(0, x), step(1, y), step(2, z))
    }

    /// 1 along the axes on which it ascends, else 0.
    #[inline(always)]
    pub fn far(&self) -> IVec3 {
        IVec3::from_array(self.far)
    }
}

/// The axis of the smallest of three distances.
#[inline(always)]
pub fn first([x, y, z]: [f32; 3]) -> usize {
    if x < y {
        if x < z { 0 } else { 2 }
    } else if y < z {
        1
    } else {
        2
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    fn ray(origin: Vec3, direction: Vec3) -> Ray {
        Ray {
            origin,
            direction: direction.normalize_or(Vec3::X),
        }
    }

    #[test]
    fn a_walk_visits_the_cells_that_the_ray_is_in() {
        let mut random = Random::new(3, 0, 0);
        let mut signed = || {
            let [a, b] = random.pair();
            let [c, _] = random.pair();
            Vec3::new(a, b, c) * 2.0 - 1.0
        };
        for _ in 0..2000 {
            let (corner, scale) = (signed() * 9.0, (signed() + 1.5) * Vec3::new(3.0, 5.0, -7.0));
            let ray = ray(signed() * 20.0, signed());
            let cells = CellRay::new(&ray, corner, scale);
            let mut cell = cells.at(0.0).floor().as_ivec3();
            let mut t = 0.0;
            for _ in 0..200 {
                let (exit, axis) = cells.exit(cell, 1);
                assert!(exit >= t - 1e-4, "{exit} after {t}");
                let middle = cells.at(0.5 * (t + exit));
                let off = (middle - (cell.as_vec3() + 0.5)).abs().max_element();
                assert!(off < 0.5 + 2e-3, "{middle} is not in {cell}");
                assert!((cells.leaves(axis, cell[axis]) - exit).abs() < 1e-6 * exit.abs().max(1.0));
                cell[axis] += cells.step(axis);
                t = exit.max(t);
            }
        }
    }

    #[test]
    fn rays_along_an_axis_leave_through_it_alone() {
        for axis in 0..3 {
            for way in [1.0, -1.0] {
                let mut direction = Vec3::ZERO;
                direction[axis] = way;
                // Starting in a corner of cells, on three of their faces at once.
                let cells = CellRay::new(&ray(Vec3::splat(2.0), direction), Vec3::ZERO, Vec3::ONE);
                let (exit, through) = cells.exit(IVec3::splat(2), 1);
                assert_eq!(through, axis);
                assert!((exit - if way > 0.0 { 1.0 } else { 0.0 }).abs() < 1e-6);
                let (cube, through) = cells.exit_cube(IVec3::splat(2), 3);
                assert_eq!((through, cube - exit), (axis, 3.0));
                assert_eq!(cells.clip(Vec3::splat(4.0)).1, 2.0);
                assert!(cells.clip(Vec3::splat(2.0)).1 < f32::INFINITY);
            }
        }
        // Beside the box, along it.
        let beside = CellRay::new(
            &ray(Vec3::new(-1.0, 0.5, 0.5), Vec3::Z),
            Vec3::ZERO,
            Vec3::ONE,
        );
        let (enter, leave) = beside.clip(Vec3::ONE);
        assert!(!(enter < leave));
    }

    #[test]
    fn nan_ends_walks() {
        let cells = CellRay::new(
            &Ray {
                origin: Vec3::splat(f32::NAN),
                direction: Vec3::X,
            },
            Vec3::ZERO,
            Vec3::ONE,
        );
        let (enter, leave) = cells.clip(Vec3::ONE);
        assert!(!(enter.max(0.0) < leave));
        let (exit, _) = cells.exit(IVec3::ZERO, 1);
        assert!(!(exit < 1.0));
    }
}
