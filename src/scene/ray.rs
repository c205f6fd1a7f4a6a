//! Rays, and the boxes that they meet.

use glam::Vec3;

/// A ray in cloth space (mm); the direction is unit length and finite.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ray {
    /// Where it starts, mm.
    pub origin: Vec3,
    /// Unit direction.
    pub direction: Vec3,
}

impl Ray {
    /// The point at distance `t` mm.
    pub fn at(&self, t: f32) -> Vec3 {
        self.origin + self.direction * t
    }
}

/// An axis-aligned box in mm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// Lower corner.
    pub min: Vec3,
    /// Upper corner.
    pub max: Vec3,
}

impl Bounds {
    /// The part of `0..t_max` of a ray that lies inside, as (start, end); empty
    /// (start ≥ end) when it misses.
    pub fn clip(&self, ray: &Ray, t_max: f32) -> (f32, f32) {
        let (mut start, mut end) = (0.0f32, t_max);
        for axis in 0..3 {
            let (origin, direction) = (ray.origin[axis], ray.direction[axis]);
            if direction == 0.0 {
                if !(self.min[axis] <= origin && origin <= self.max[axis]) {
                    return (0.0, 0.0);
                }
                continue;
            }
            let (a, b) = (
                (self.min[axis] - origin) / direction,
                (self.max[axis] - origin) / direction,
            );
            start = start.max(a.min(b));
            end = end.min(a.max(b));
        }
        (start, end)
    }
}
