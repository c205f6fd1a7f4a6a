//! What the tracer traces: anything that can be looked up and bounded.

use glam::Vec3;

use crate::scene::{Bounds, Ray};

/// What a medium is at a point: SGGX fibres S = I − (1−α²)ttᵀ (Heitz 2015).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Voxel {
    /// Extinction across the fibres, 1/mm; 0 = empty (then nothing else counts).
    pub sigma: f32,
    /// Unit fibre direction; t and −t mean the same.
    pub direction: Vec3,
    /// SGGX roughness α, 0.01..=1; 1 = isotropic.
    pub alpha: f32,
    /// Names the optics: [`Medium::albedo`] resolves it. Bits of [`PLACE`] say where in
    /// the medium's pattern the voxel lies, for [`Medium::gain`] alone.
    pub optics: u32,
}

/// The bits of a voxel's optics that do not name the optics.
pub const PLACE: u32 = 0x7fff_0000;
/// The bit of them that says to which of two systems of yarns, warp or weft, a voxel
/// belongs.
pub const SYSTEM: u32 = 0x0080_0000;

impl Voxel {
    /// Empty space.
    pub const EMPTY: Self = Self {
        sigma: 0.0,
        direction: Vec3::Z,
        alpha: 1.0,
        optics: 0,
    };
}

/// A stretch of a ray with an upper bound of the extinction on it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stretch {
    /// Distance at which it begins, mm.
    pub start: f32,
    /// Distance at which it ends, mm.
    pub end: f32,
    /// No voxel that [`MajorantWalk::voxel`] returns on it has a larger `sigma`, 1/mm.
    pub majorant: f32,
}

/// A participating medium: lookup and majorants along rays.
pub trait Medium: Sync {
    /// The state of one walk along one ray.
    type Walk<'m>: MajorantWalk
    where
        Self: 'm;

    /// Everything outside is empty.
    fn bounds(&self) -> Bounds;

    /// Starts a walk over the part of the ray with 0 ≤ t ≤ `t_max` (mm, may be infinite).
    fn walk(&self, ray: &Ray, t_max: f32) -> Self::Walk<'_>;

    /// Single-scattering albedo (linear RGB) of an optics id that a voxel carried.
    fn albedo(&self, optics: u32) -> Vec3;

    /// What a medium that stands for a finer one multiplies the light with that it sends
    /// to the eye; 1 for one that stands for itself.
    #[inline]
    fn gain(&self, _: &Arrival) -> f32 {
        1.0
    }
}

/// The last scattering on the way from a light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Arrival {
    /// How often the light was scattered.
    pub order: u32,
    /// Whether voxels of both systems scattered it (see [`SYSTEM`]).
    pub mixed: bool,
    /// Optics id of the voxel that scattered it last (first, as the light goes).
    pub optics: u32,
    /// Its fibre, unit.
    pub fibre: Vec3,
    /// Its roughness α.
    pub alpha: f32,
    /// Where the path went on to the eye, unit.
    pub to_eye: Vec3,
    /// Where the light came from, unit.
    pub to_light: Vec3,
}

impl<M: Medium> Medium for &M {
    type Walk<'m>
        = M::Walk<'m>
    where
        Self: 'm;

    fn bounds(&self) -> Bounds {
        (**self).bounds()
    }

    fn walk(&self, ray: &Ray, t_max: f32) -> Self::Walk<'_> {
        (**self).walk(ray, t_max)
    }

    fn albedo(&self, optics: u32) -> Vec3 {
        (**self).albedo(optics)
    }

    #[inline]
    fn gain(&self, arrival: &Arrival) -> f32 {
        (**self).gain(arrival)
    }
}

/// A walk along a ray, stretch by stretch, in order of distance. Empty stretches may be
/// skipped; the walk always ends.
pub trait MajorantWalk {
    /// The next stretch that may hold matter.
    fn next_stretch(&mut self) -> Option<Stretch>;

    /// The medium at distance `t`, which lies on the current stretch. `tap` holds uniform
    /// numbers in [0,1) for a stochastic one-tap filter; a medium without one ignores them.
    /// Where `sigma` is below `least` (1/mm) the caller has no use for the rest, and the
    /// answer may be [`Voxel::EMPTY`].
    fn voxel(&self, t: f32, tap: Vec3, least: f32) -> Voxel;
}
