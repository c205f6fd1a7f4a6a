//! Scenes shared by the renderer's tests: procedural yarns in a dense grid.
#![allow(dead_code, reason = "each test file uses its own part")]

pub mod peer;

use glam::{UVec3, Vec3};
use pickglass::hash::mix;
use pickglass::render::{RenderOutcome, RenderSettings, Scatterer, render};
use pickglass::scene::{Bounds, Camera, LightRig, Sky, Sun};
use pickglass::volume::{DenseGrid, GridVoxel, Optics, Taps};

/// A weave of thick procedural yarns.
pub struct YarnGrid {
    /// Ends and picks of the pattern; `pattern(end, pick)` = warp on top.
    pub repeat: usize,
    pub pattern: fn(usize, usize) -> bool,
    /// Voxels per crossing in x and y, and in z altogether.
    pub per_crossing: usize,
    pub depth: usize,
    pub voxel_mm: f32,
    /// Half axes of the yarn's section, relative to half a pitch and half the thickness.
    pub section: [f32; 2],
    /// Full extinction, 1/mm.
    pub sigma: f32,
    pub alpha: f32,
    pub warp: Vec3,
    pub weft: Vec3,
    /// Fibre direction deviates by this many radians from the yarn's (twist).
    pub twist: f32,
    /// Crossings in the grid along x and y.
    pub crossings: usize,
}

/// A thin silk satin: filament, tight, smooth.
pub fn silk_satin(crossings: usize) -> YarnGrid {
    YarnGrid {
        repeat: 5,
        pattern: |end, pick| (end * 2) % 5 != pick,
        per_crossing: 16,
        depth: 16,
        voxel_mm: 0.007,
        section: [0.95, 0.45],
        sigma: 86.0,
        alpha: 0.1,
        warp: Vec3::new(0.95, 0.75, 0.55),
        weft: Vec3::new(0.9, 0.5, 0.3),
        twist: 0.1,
        crossings,
    }
}

/// A thick wool twill: soft, deep, twisted.
pub fn wool_twill(crossings: usize) -> YarnGrid {
    YarnGrid {
        repeat: 4,
        pattern: |end, pick| (end + 4 - pick) % 4 < 2,
        per_crossing: 32,
        depth: 64,
        voxel_mm: 0.0125,
        section: [1.0, 0.48],
        sigma: 28.0,
        alpha: 0.3,
        warp: Vec3::new(0.97, 0.95, 0.9),
        weft: Vec3::new(0.8, 0.85, 0.95),
        twist: 0.4,
        crossings,
    }
}

impl YarnGrid {
    pub fn size(&self) -> UVec3 {
        let across = (self.crossings * self.per_crossing) as u32;
        UVec3::new(across, across, self.depth as u32)
    }

    pub fn bounds(&self) -> Bounds {
        let max = self.size().as_vec3() * self.voxel_mm;
        Bounds {
            min: Vec3::ZERO,
            max,
        }
    }

    pub fn optics(&self) -> Vec<Optics> {
        [self.warp, self.weft]
            .map(|albedo| Optics {
                albedo,
                alpha: self.alpha,
            })
            .to_vec()
    }

    /// Height and slope of a yarn at `along` pitches, `up(k)` saying where it is on top.
    fn height(along: f32, up: impl Fn(usize) -> bool, repeat: usize) -> (f32, f32) {
        let at = along - 0.5;
        let k = at.floor();
        let f = at - k;
        let level = |k: f32| {
            if up((k as i64).rem_euclid(repeat as i64) as usize) {
                0.5
            } else {
                -0.5
            }
        };
        let (a, b) = (level(k), level(k + 1.0));
        let s = f * f * (3.0 - 2.0 * f);
        (a + (b - a) * s, (b - a) * 6.0 * f * (1.0 - f))
    }

    /// The voxel at a cell.
    pub fn voxel(&self, cell: UVec3) -> GridVoxel {
        let per = self.per_crossing as f32;
        let at = (cell.as_vec3() + 0.5) / Vec3::new(per, per, self.depth as f32);
        let (end, pick) = (at.x as usize % self.repeat, at.y as usize % self.repeat);
        let z = at.z * 2.0 - 1.0;
        let thickness = self.depth as f32 / per;
        let try_yarn = |across: f32, along: f32, up: &dyn Fn(usize) -> bool| {
            let (height, slope) = Self::height(along, up, self.repeat);
            let u = (across - across.floor()) * 2.0 - 1.0;
            let w = (z - height) / self.section[1];
            let u = u / self.section[0];
            (u * u + w * w < 1.0).then_some((u, w, slope * 0.5 * thickness))
        };
        let warp = try_yarn(at.x, at.y, &|pick| (self.pattern)(end, pick));
        let weft = try_yarn(at.y, at.x, &|end| !(self.pattern)(end, pick));
        let (inside, optics) = match (warp, weft) {
            (Some(inside), _) => (inside, 0),
            (_, Some(inside)) => (inside, 1),
            _ => return GridVoxel::EMPTY,
        };
        let (u, w, slope) = inside;
        // A helix: fibres lean sideways with the height over the yarn's centre.
        let lean = self.twist * w;
        let rise = slope - self.twist * u * 0.5;
        let direction = if optics == 0 {
            Vec3::new(lean, 1.0, rise)
        } else {
            Vec3::new(1.0, lean, rise)
        };
        let id = u64::from(cell.x) | u64::from(cell.y) << 20 | u64::from(cell.z) << 40;
        let fill = 0.55 + 0.45 * (mix(id) >> 40) as f32 / 16_777_216.0;
        GridVoxel {
            sigma: self.sigma * fill,
            direction: direction.normalize_or(Vec3::Z),
            optics,
        }
    }

    pub fn grid(&self, taps: Taps) -> DenseGrid {
        self.grid_with(taps, |voxel| voxel)
    }

    /// The grid with every voxel changed.
    pub fn grid_with(&self, taps: Taps, change: impl Fn(GridVoxel) -> GridVoxel) -> DenseGrid {
        DenseGrid::from_fn(self.size(), self.bounds(), self.optics(), taps, |cell| {
            change(self.voxel(cell))
        })
        .expect("the scene is sound")
    }

    /// Straight on, the middle of the grid, `share` of its width across the frame.
    pub fn face_camera(&self, share: f32, width: u32, height: u32) -> Camera {
        let bounds = self.bounds();
        let centre = (bounds.min + bounds.max) * 0.5;
        Camera::orthographic(
            centre,
            Vec3::Z,
            Vec3::Y,
            bounds.max.x * share,
            width,
            height,
        )
    }
}

/// A point sun without a sky.
pub fn lone_sun(towards: Vec3, irradiance: f32) -> LightRig {
    LightRig::new(
        "lone sun",
        vec![Sun {
            towards: towards.normalize_or(Vec3::Z),
            irradiance: Vec3::splat(irradiance),
            angular_radius: 0.0,
        }],
        Sky::Dark,
    )
}

/// Renders without a job and without listening.
pub fn shoot<S: Scatterer>(
    scatterer: &S,
    camera: &Camera,
    lights: &LightRig,
    settings: &RenderSettings,
) -> RenderOutcome {
    let job = pickglass::job::Job::new();
    render(scatterer, camera, lights, settings, &job, &mut |_, _| {}).expect("not cancelled")
}
