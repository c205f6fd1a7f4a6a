//! Voxels on their way out: what a writer of volumes asks for, box by box.
//!
//! A [`VoxelSource`] is anything that can fill a box of cubic voxels: a window of the
//! implicit cloth or a grid that was read. Writers ask for one box after the other and
//! never for all of it, so that memory is bounded by the box whatever the window.

use glam::{DVec3, Mat3, UVec3, Vec3};
use nalgebra::{Matrix3, SymmetricEigen};

use super::{DenseGrid, sggx_matrix};
use crate::render::Medium;
use crate::scene::Bounds;

/// Yarn number of empty space.
pub const NO_YARN: i32 = -1;

/// Where the voxels of a volume lie.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame {
    /// Voxels along each axis.
    pub size: UVec3,
    /// Lower corner of the box (not the centre of the first voxel), mm.
    pub origin_mm: DVec3,
    /// Edge of a voxel, mm.
    pub edge_mm: f64,
}

impl Frame {
    /// Voxels in all.
    pub fn voxels(&self) -> u64 {
        u64::from(self.size.x)
            .saturating_mul(u64::from(self.size.y))
            .saturating_mul(u64::from(self.size.z))
    }

    /// The box in mm.
    pub fn bounds(&self) -> Bounds {
        let extent = self.size.as_dvec3() * self.edge_mm;
        Bounds {
            min: self.origin_mm.as_vec3(),
            max: (self.origin_mm + extent).as_vec3(),
        }
    }
}

/// A box of whole voxels inside a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CellBox {
    /// The lowest voxel.
    pub low: UVec3,
    /// Voxels along each axis.
    pub size: UVec3,
}

impl CellBox {
    /// Voxels in the box.
    pub fn voxels(&self) -> usize {
        self.size.x as usize * self.size.y as usize * self.size.z as usize
    }

    /// Boxes of at most `step` voxels a side that cover `size`, x fastest, then y, then z.
    pub fn tiles(size: UVec3, step: UVec3) -> impl Iterator<Item = Self> {
        let step = step.max(UVec3::ONE);
        let count = |axis: usize| size[axis].div_ceil(step[axis]);
        let (nx, ny, nz) = (count(0), count(1), count(2));
        (0..nz).flat_map(move |z| {
            (0..ny).flat_map(move |y| {
                (0..nx).map(move |x| {
                    let low = UVec3::new(x, y, z) * step;
                    Self {
                        low,
                        size: step.min(size - low),
                    }
                })
            })
        })
    }
}

/// One voxel: fibres S = I − (1−α²)ttᵀ (Heitz 2015) of one yarn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SourceVoxel {
    /// Extinction across the fibres, 1/mm; 0 = empty.
    pub sigma: f32,
    /// Unit fibre direction with z ≥ 0; 0 in empty space.
    pub direction: Vec3,
    /// SGGX roughness α, 0.01..=1.
    pub alpha: f32,
    /// Index into [`VoxelSource::albedos`], or [`NO_YARN`].
    pub yarn: i32,
}

impl SourceVoxel {
    /// Empty space.
    pub const EMPTY: Self = Self {
        sigma: 0.0,
        direction: Vec3::ZERO,
        alpha: 1.0,
        yarn: NO_YARN,
    };

    /// S as Sxx, Syy, Szz, Sxy, Sxz, Syz; the identity in empty space, so that a filter
    /// between voxels never meets S = 0.
    pub fn sggx(&self) -> [f32; 6] {
        if self.sigma > 0.0 {
            six(sggx_matrix(self.direction, self.alpha))
        } else {
            [1.0, 1.0, 1.0, 0.0, 0.0, 0.0]
        }
    }
}

/// A symmetric matrix as xx, yy, zz, xy, xz, yz.
fn six(s: Mat3) -> [f32; 6] {
    [
        s.x_axis.x, s.y_axis.y, s.z_axis.z, s.x_axis.y, s.x_axis.z, s.y_axis.z,
    ]
}

/// Anything that can fill boxes of voxels.
pub trait VoxelSource: Sync {
    /// Where the voxels lie.
    fn frame(&self) -> Frame;

    /// Single-scattering albedo of each yarn, linear RGB.
    fn albedos(&self) -> &[Vec3];

    /// The largest extinction that a voxel can have, 1/mm.
    fn densest(&self) -> f32;

    /// Fills a box that lies inside the frame, x fastest, then z, then y. The same voxel
    /// is the same in any box.
    fn fill(&self, cells: CellBox, voxels: &mut [SourceVoxel]);
}

/// The fibres nearest to a mean S̄ of unit projected area or less: S̄ ≈ c(I − (1−α²)ttᵀ)
/// with t the axis of least area. Returns √c (a factor for the extinction), t and α, and
/// how far from fibres S̄ is: the difference of its two larger eigenvalues over c.
/// `None` where S̄ is not finite or has no area.
pub fn fibres_of(s: [f32; 6]) -> Option<(f32, Vec3, f32, f32)> {
    if !s.iter().all(|v| v.is_finite()) {
        return None;
    }
    let [xx, yy, zz, xy, xz, yz] = s.map(f64::from);
    let eigen =
        SymmetricEigen::try_new(Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz), 1e-14, 200)?;
    let mut order = [0, 1, 2];
    order.sort_by(|&a, &b| eigen.eigenvalues[a].total_cmp(&eigen.eigenvalues[b]));
    let [least, middle, most] = order.map(|k| eigen.eigenvalues[k].max(0.0));
    let c = 0.5 * (middle + most);
    if !(c > 1e-9) {
        return None;
    }
    let axis = eigen.eigenvectors.column(order[0]);
    let axis = Vec3::new(axis[0] as f32, axis[1] as f32, axis[2] as f32);
    let alpha = ((least / c).sqrt() as f32).clamp(0.01, 1.0);
    let unlike = ((most - middle) / c) as f32;
    Some((
        c.sqrt() as f32,
        upper(axis.normalize_or(Vec3::Z)),
        alpha,
        unlike,
    ))
}

/// The direction or its opposite, whichever points up.
pub fn upper(direction: Vec3) -> Vec3 {
    if direction.z < 0.0 {
        -direction
    } else {
        direction
    }
}

/// A grid as a source of cubic voxels: what was read can be written again.
pub struct GridSource<'g> {
    grid: &'g DenseGrid,
    albedos: Vec<Vec3>,
    densest: f32,
}

impl<'g> GridSource<'g> {
    /// A grid whose voxels are cubes; those of others come out with the edge along x.
    pub fn new(grid: &'g DenseGrid) -> Self {
        Self {
            albedos: grid.all_optics().iter().map(|o| o.albedo).collect(),
            densest: grid.densest(),
            grid,
        }
    }
}

impl VoxelSource for GridSource<'_> {
    fn frame(&self) -> Frame {
        let bounds = self.grid.bounds();
        let width = f64::from(bounds.max.x) - f64::from(bounds.min.x);
        Frame {
            size: self.grid.size(),
            origin_mm: bounds.min.as_dvec3(),
            edge_mm: width / f64::from(self.grid.size().x),
        }
    }

    fn albedos(&self) -> &[Vec3] {
        &self.albedos
    }

    fn densest(&self) -> f32 {
        self.densest
    }

    fn fill(&self, cells: CellBox, voxels: &mut [SourceVoxel]) {
        let CellBox { low, size } = cells;
        let places = (0..size.y).flat_map(|y| {
            (0..size.z).flat_map(move |z| (0..size.x).map(move |x| UVec3::new(x, y, z)))
        });
        for (place, out) in places.zip(voxels) {
            let voxel = self.grid.cell(low + place);
            *out = if voxel.sigma > 0.0 {
                SourceVoxel {
                    sigma: voxel.sigma,
                    direction: upper(voxel.direction),
                    alpha: voxel.alpha,
                    yarn: voxel.optics as i32,
                }
            } else {
                SourceVoxel::EMPTY
            };
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;

    #[test]
    fn fibres_are_found_again_in_their_matrix() {
        for (direction, alpha) in [
            (Vec3::new(1.0, 2.0, 3.0), 0.1),
            (Vec3::X, 0.5),
            (Vec3::new(-0.3, 0.2, 0.9), 0.02),
        ] {
            let direction = direction.normalize_or(Vec3::Z);
            let (scale, found, found_alpha, unlike) =
                fibres_of(six(sggx_matrix(direction, alpha))).unwrap();
            assert!((scale - 1.0).abs() < 1e-5 && unlike < 1e-5);
            assert!(
                found.dot(direction).abs() > 1.0 - 1e-6,
                "{found} {direction}"
            );
            assert!((found_alpha - alpha).abs() < 1e-3, "{found_alpha} {alpha}");
        }
    }

    #[test]
    fn what_is_no_matrix_gives_no_fibres() {
        assert!(fibres_of([f32::NAN; 6]).is_none());
        assert!(fibres_of([0.0; 6]).is_none());
        assert!(fibres_of([f32::INFINITY; 6]).is_none());
        // A flat flake is far from any fibre, and says so.
        let (_, _, _, unlike) = fibres_of([0.01, 0.01, 1.0, 0.0, 0.0, 0.0]).unwrap();
        assert!(unlike > 1.0);
    }

    #[test]
    fn tiles_cover_a_frame_once() {
        let size = UVec3::new(7, 5, 3);
        let mut seen = vec![0; 7 * 5 * 3];
        for tile in CellBox::tiles(size, UVec3::new(4, 2, 2)) {
            for z in 0..tile.size.z {
                for y in 0..tile.size.y {
                    for x in 0..tile.size.x {
                        let at = tile.low + UVec3::new(x, y, z);
                        seen[((at.z * 5 + at.y) * 7 + at.x) as usize] += 1;
                    }
                }
            }
        }
        assert!(seen.iter().all(|&count| count == 1));
    }
}
