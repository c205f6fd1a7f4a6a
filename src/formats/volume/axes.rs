//! How the axes of a file lie along x, y and z.
//!
//! Axes that run against x, y and z, or are exchanged, are another order of the same voxels.
//! Axes that lie aslant would have to be resampled, which other programs do better.

use glam::{UVec3, Vec3};

use crate::scene::Bounds;

/// Share of a step by which an axis may be off x, y or z: what rounding in text leaves.
const ASLANT: f64 = 1e-4;

/// Edges of a voxel from the origin beyond which single precision would tell on the voxels.
const FAR: f64 = 16_384.0;

/// What to do with a volume whose axes lie aslant.
pub(super) const RESAMPLE: &str = "resample it along x, y and z first (unu resample, or \
                                   SimpleITK's Resample), so that its axes are theirs";

/// Voxels of a file as they lie in space.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Lie {
    /// Voxels along x, y and z.
    pub size: UVec3,
    /// The box, mm.
    pub bounds: Bounds,
    /// Where the box begins in the file, mm, where that is so far away that it is taken to
    /// begin at 0: nothing else stands beside a volume.
    pub far: Option<[f64; 3]>,
    /// For x, y and z: the file's axis that runs along it, and whether it descends.
    along: [(usize, bool); 3],
}

impl Lie {
    /// Voxels whose axes are x, y and z.
    pub fn straight(size: [u32; 3], bounds: Bounds) -> Self {
        let along = [0, 1, 2].map(|axis| (axis, false));
        let [low, high] = [bounds.min, bounds.max].map(|v| v.to_array().map(f64::from));
        Self::between(size.into(), low, high, along)
    }

    /// A box of voxels, moved to the origin where it is too far from there.
    fn between(size: UVec3, low: [f64; 3], high: [f64; 3], along: [(usize, bool); 3]) -> Self {
        let counts = size.to_array().map(f64::from);
        let is_far = (0..3).any(|k| {
            let extent = high[k] - low[k];
            let away = low[k].abs().max(high[k].abs());
            away.is_finite() && away > FAR * (extent / counts[k]) && away > 2.0 * extent
        });
        let from = if is_far { low } else { [0.0; 3] };
        let corner =
            |corner: [f64; 3]| Vec3::from_array([0, 1, 2].map(|k| (corner[k] - from[k]) as f32));
        Self {
            size,
            bounds: Bounds {
                min: corner(low),
                max: corner(high),
            },
            far: is_far.then_some(low),
            along,
        }
    }

    /// Voxels of a file that has `size` of them along its axes, each a `step` (mm) from the
    /// one before, the first with its centre at `origin`; without one the box begins at 0.
    /// `None` where an axis is not one of x, y and z.
    pub fn new(size: [u32; 3], steps: [[f64; 3]; 3], origin: Option<[f64; 3]>) -> Option<Self> {
        let mut along = [None; 3];
        for (axis, step) in steps.iter().enumerate() {
            let main = (0..3).max_by(|&a, &b| step[a].abs().total_cmp(&step[b].abs()))?;
            let aside = (0..3).filter(|&k| k != main).map(|k| step[k].abs());
            let aside = aside.fold(0.0, f64::max);
            if !(aside <= ASLANT * step[main].abs()) || along[main].is_some() {
                return None;
            }
            along[main] = Some((axis, step[main] < 0.0));
        }
        let along = [along[0]?, along[1]?, along[2]?];
        let (mut low, mut high) = ([0.0; 3], [0.0; 3]);
        for (k, &(axis, descends)) in along.iter().enumerate() {
            let (count, edge) = (f64::from(size[axis]), steps[axis][k].abs());
            low[k] = match origin {
                None => 0.0,
                Some(origin) if descends => origin[k] - (count - 0.5) * edge,
                Some(origin) => origin[k] - 0.5 * edge,
            };
            high[k] = low[k] + count * edge;
        }
        let size = along.map(|(axis, _)| size[axis]).into();
        Some(Self::between(size, low, high, along))
    }

    /// Whether x, y and z are the file's first, second and third axis, either way.
    pub fn in_order(&self) -> bool {
        self.along.map(|(axis, _)| axis) == [0, 1, 2]
    }

    /// Whether the file's axis along `k` descends.
    pub fn descends(&self, k: usize) -> bool {
        self.along[k].1
    }

    /// Voxels along the axes of the file.
    pub fn file_size(&self) -> [u32; 3] {
        let mut size = [0; 3];
        for (k, (axis, _)) in self.along.into_iter().enumerate() {
            size[axis] = self.size[k];
        }
        size
    }

    /// Where in the file a voxel is, along its axes.
    pub fn in_file(&self, cell: UVec3) -> [u32; 3] {
        let mut place = [0; 3];
        for (k, (axis, descends)) in self.along.into_iter().enumerate() {
            place[axis] = if descends {
                self.size[k] - 1 - cell[k]
            } else {
                cell[k]
            };
        }
        place
    }

    /// The same voxels with an edge of `edge` mm along x.
    pub fn scaled(&mut self, edge: f64) {
        let factor = edge * f64::from(self.size.x)
            / (f64::from(self.bounds.max.x) - f64::from(self.bounds.min.x));
        let by = |v: Vec3| (v.as_dvec3() * factor).as_vec3();
        self.bounds = Bounds {
            min: by(self.bounds.min),
            max: by(self.bounds.max),
        };
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;

    #[test]
    fn turned_axes_are_another_order_and_slanting_ones_are_none() {
        // The first axis descends along y, the second ascends along z, the third along x.
        let steps = [[0.0, -0.1, 0.0], [0.0, 0.0, 0.2], [0.3, 0.0, 0.0]];
        let lie = Lie::new([4, 5, 6], steps, Some([1.0, 2.0, 3.0])).unwrap();
        assert_eq!(lie.size, UVec3::new(6, 4, 5));
        assert_eq!(lie.file_size(), [4, 5, 6]);
        assert_eq!(lie.in_file(UVec3::new(1, 0, 2)), [3, 2, 1]);
        let Bounds { min, max } = lie.bounds;
        assert!((min - Vec3::new(0.85, 1.65, 2.9)).length() < 1e-5, "{min}");
        assert!((max - Vec3::new(2.65, 2.05, 3.9)).length() < 1e-5, "{max}");
        let slanting = [[0.1, 0.05, 0.0], [-0.05, 0.1, 0.0], [0.0, 0.0, 0.1]];
        assert!(Lie::new([4, 5, 6], slanting, None).is_none());
        let double = [[0.1, 0.0, 0.0], [0.1, 0.0, 0.0], [0.0, 0.0, 0.1]];
        assert!(Lie::new([4, 5, 6], double, None).is_none());
        assert!(Lie::new([4, 5, 6], [[f64::NAN; 3]; 3], None).is_none());
    }

    #[test]
    fn what_lies_far_away_keeps_its_size() {
        let steps = [[0.1, 0.0, 0.0], [0.0, 0.1, 0.0], [0.0, 0.0, 0.1]];
        let at = |x: f64| Lie::new([64, 64, 8], steps, Some([x, 0.05, 0.05])).unwrap();
        for (x, far) in [(0.05, false), (1e3, false), (1e5, true), (-1e9, true)] {
            let lie = at(x);
            assert_eq!(lie.far.is_some(), far, "{x}");
            let extent = lie.bounds.max - lie.bounds.min;
            assert!(
                (extent - Vec3::new(6.4, 6.4, 0.8)).length() < 1e-3,
                "{x}: {extent}"
            );
        }
        // Control: where it is, it would not.
        assert!((((1e6 + 6.4) as f32 - 1e6_f32) - 6.4).abs() > 1e-3);
        let far = Bounds {
            min: Vec3::splat(1e6),
            max: Vec3::splat(1e6 + 8.0),
        };
        assert!(Lie::straight([64, 64, 64], far).far.is_some());
    }
}
