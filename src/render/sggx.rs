//! The SGGX microflake of a fibre (Heitz, Dupuy, Crassin, Dachsbacher 2015).
//!
//! For fibres along t with roughness α the matrix is S = I − (1−α²)ttᵀ, and everything
//! has a closed form in c = ω·t: projected area σ(ω)² = 1 − (1−α²)c², |S| = α²,
//! mᵀS⁻¹m = 1 + (1/α²−1)(m·t)², so D(m) = 1/(πα(1+(1/α²−1)(m·t)²)²). Nothing is
//! inverted, eigenvalues never exceed 1, and 1 − (1−α²)c² is computed as s² + α²c²
//! with s² = |ω×t|², which does not cancel when one looks along a smooth fibre.
//!
//! Directions `wi` and `wo` point away from the fibre; the specular flake is a mirror.

use glam::Vec3;
use std::f32::consts::PI;

use crate::random::disk;

/// The smallest roughness: below it D is a needle that light sampling cannot hit.
pub const ALPHA_FLOOR: f32 = 0.01;

/// Fibres along one direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fibre {
    /// Unit direction; t and −t mean the same.
    pub direction: Vec3,
    /// Roughness α, at least [`ALPHA_FLOOR`], at most 1 (isotropic).
    pub alpha: f32,
}

impl Fibre {
    /// Fibres along `direction` (unit) with α clamped to its range; NaN becomes 1.
    #[inline]
    pub fn new(direction: Vec3, alpha: f32) -> Self {
        let alpha = if alpha < 1.0 {
            alpha.max(ALPHA_FLOOR)
        } else {
            1.0
        };
        Self { direction, alpha }
    }

    /// σ(ω)², the squared projected area of the flakes seen along `w`; 0..=1.
    #[inline]
    pub fn projected_area_squared(&self, w: Vec3) -> f32 {
        let cosine = w.dot(self.direction);
        let sine_squared = w.cross(self.direction).length_squared();
        sine_squared + self.alpha * self.alpha * cosine * cosine
    }

    /// σ(ω), the projected area of the flakes seen along `w`: α along the fibre, 1
    /// across it.
    #[inline]
    pub fn projected_area(&self, w: Vec3) -> f32 {
        self.projected_area_squared(w).sqrt()
    }

    /// D for a squared cosine (m·t)² between normal and fibre.
    #[inline]
    fn density(&self, cosine_squared: f32) -> f32 {
        let a2 = self.alpha * self.alpha;
        // With both sides times α²: D = α³ / (π (α² + (1−α²)(m·t)²)²).
        let base = a2 + (1.0 - a2) * cosine_squared;
        a2 * self.alpha / (PI * base * base)
    }

    /// D(m), the distribution of flake normals over the sphere, 1/sr.
    #[inline]
    pub fn normal_distribution(&self, m: Vec3) -> f32 {
        let cosine = m.dot(self.direction);
        self.density(cosine * cosine)
    }

    /// The phase function p(wi → wo) = D(h)/(4σ(wi)), 1/sr; integrates to 1 over `wo`.
    #[inline]
    pub fn phase(&self, wi: Vec3, wo: Vec3) -> f32 {
        let half = wi + wo;
        let length_squared = half.length_squared();
        let along = half.dot(self.direction);
        // Straight on (wo = −wi) every half vector is across the ray; take the brightest.
        let cosine_squared = if length_squared > 1e-14 {
            (along * along / length_squared).min(1.0)
        } else {
            0.0
        };
        self.density(cosine_squared) / (4.0 * self.projected_area(wi))
    }

    /// A flake normal as seen from `wi`, drawn exactly from ⟨wi,m⟩D(m)/σ(wi).
    #[inline]
    pub fn visible_normal(&self, wi: Vec3, u: [f32; 2]) -> Vec3 {
        self.scaled_normal(wi, u).normalize_or(wi)
    }

    /// A visible normal times some positive number.
    ///
    /// Heitz 2015's construction in the frame (k, j, wi) whose j lies in the plane of
    /// `wi` and the fibre: there S_kj = S_ki = 0 and the three vectors collapse to
    /// M_k = k, M_j = α/σ j, M_i = −(1−α²)sc/σ j + σ wi, all taken times σ.
    #[inline(always)]
    fn scaled_normal(&self, wi: Vec3, u: [f32; 2]) -> Vec3 {
        let c = wi.dot(self.direction);
        let across = self.direction - wi * c;
        let s2 = across.length_squared();
        let (s, j) = if s2 > 1e-12 {
            let s = s2.sqrt();
            (s, across / s)
        } else {
            (0.0, wi.any_orthonormal_vector())
        };
        let k = wi.cross(j);
        let a2 = self.alpha * self.alpha;
        let area2 = (s2 + a2 * c * c).max(a2 * 0.25);
        let (x, y) = disk(u);
        let z = (1.0 - u[0]).sqrt();
        let along_j = y * self.alpha - z * (1.0 - a2) * s * c;
        k * (x * area2.sqrt()) + j * along_j + wi * (z * area2)
    }

    /// Samples the phase function: a direction `wo` of density [`Fibre::phase`], so that
    /// its weight is exactly 1. Unit length to rounding when `wi` is.
    #[inline(always)]
    pub fn sample(&self, wi: Vec3, u: [f32; 2]) -> Vec3 {
        let m = self.scaled_normal(wi, u);
        let length2 = m.length_squared();
        if length2 > 0.0 {
            let wo = m * (2.0 * wi.dot(m) / length2) - wi;
            // One Newton step keeps rounding from growing along a path.
            wo * (1.5 - 0.5 * wo.length_squared())
        } else {
            -wi
        }
    }
}
