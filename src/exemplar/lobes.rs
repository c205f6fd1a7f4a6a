//! How far the fibres of a coarse voxel point apart, in four bytes.
//!
//! A voxel above level 0 holds many fibres. Their mean E[ttᵀ] has the axes e₁, e₂, e₃ with
//! shares λ₁ ≥ λ₂ ≥ λ₃ of its trace 1. A lookup takes a direction ce₁ ± m√λ₂e₂ ± n√λ₃e₃ by
//! chance, m and n uniform about 1 so that E[m²] = E[n²] = 1: a unit vector each time, and
//! their mean ttᵀ is the voxel's own. So a coarse voxel scatters as a mixture of fibres,
//! and a highlight that glides over a crimped float stays as wide and as even as the
//! float's slopes make it; one mean direction with a larger α would blur it all round, and
//! four directions alone (m = n = 1) leave the slopes between them dark.

use glam::Vec3;
use nalgebra::{Matrix3, SymmetricEigen};

use super::direction::{decode_direction, encode_direction};

/// Largest of uniform numbers from 0 whose mean square is 1.
const SQRT_3: f32 = 1.732_050_8;

/// The second and third axis of the fibres of a voxel, and how far fibres lean to them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Lobes {
    /// Angle of e₂ round e₁, in 1/256 of a half turn.
    turn: u8,
    /// √λ₂ and √λ₃ in 1/255.
    lean: [u8; 2],
    /// Keeps the size a power of two.
    unused: u8,
}

impl Lobes {
    /// The main axis e₁ of summed moments Σ w ttᵀ (xx, yy, zz, xy, xz, yz), and what lies
    /// beside it. Moments without a finite trace above 0 give +z alone.
    pub fn new(moments: [f32; 6]) -> (Vec3, Self) {
        let [xx, yy, zz, xy, xz, yz] = moments.map(f64::from);
        let trace = xx + yy + zz;
        if !(trace.is_finite() && trace > 0.0) {
            return (Vec3::Z, Self::default());
        }
        let matrix = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz) / trace;
        let Some(eigen) = SymmetricEigen::try_new(matrix, 1e-14, 200) else {
            return (Vec3::Z, Self::default());
        };
        let mut order = [0, 1, 2];
        order.sort_by(|&a, &b| eigen.eigenvalues[b].total_cmp(&eigen.eigenvalues[a]));
        let axis = |rank: usize| {
            let column = eigen.eigenvectors.column(order[rank]);
            Vec3::new(column[0] as f32, column[1] as f32, column[2] as f32)
        };
        // The angle is measured in the frame of the axis as it will be read back.
        let first = decode_direction(encode_direction(axis(0)));
        let (a, b) = frame(first);
        let second = axis(1);
        let angle = second.dot(b).atan2(second.dot(a)) / std::f32::consts::PI;
        let lean = [1, 2].map(|rank| {
            let share = eigen.eigenvalues[order[rank]].clamp(0.0, 1.0);
            (share.sqrt() * 255.0).round() as u8
        });
        let turn = (angle.rem_euclid(1.0) * 256.0).round() as u32 as u8;
        let unused = 0;
        (first, Self { turn, lean, unused })
    }

    /// A direction about the axis `first`, chosen by `bits_of` a uniform number. The
    /// fibres lean `spread` times as far as they do; 1 is as they are.
    pub fn direction(self, first: Vec3, bits: u32, spread: f32) -> Vec3 {
        if self.lean == [0, 0] {
            return first;
        }
        let (sine, cosine) = (f32::from(self.turn) * (std::f32::consts::PI / 256.0)).sin_cos();
        let (a, b) = frame(first);
        let [second, third] = self.lean.map(|lean| f32::from(lean) * (spread / 255.0));
        // Uniform in low..=high with a mean square of 1; no direction leaves the sphere.
        let aside2 = second * second + third * third;
        let high = SQRT_3.min(aside2.max(1e-6).sqrt().recip()).max(1.0);
        let low = 0.5 * ((12.0 - 3.0 * high * high).max(0.0).sqrt() - high);
        let of = |bits: u32| {
            let much = ((bits >> 1 & 63) as f32 + 0.5) * (1.0 / 64.0);
            let much = low + (high - low) * much;
            if bits & 1 == 1 { much } else { -much }
        };
        let (second, third) = (second * of(bits), third * of(bits >> 7));
        let rest = (1.0 - second * second - third * third).max(0.0).sqrt();
        let aside = (a * cosine + b * sine) * second + (b * cosine - a * sine) * third;
        (first * rest + aside).try_normalize().unwrap_or(first)
    }
}

/// Fourteen bits of a uniform number in [0,1) that say nothing of its size.
#[inline]
pub fn bits_of(uniform: f32) -> u32 {
    // The last bits of those that filters get, which are multiples of 2⁻²¹.
    (uniform * 2_097_152.0) as u32 & 0x3fff
}

/// Two unit vectors that make a right-handed frame with a unit vector.
fn frame(axis: Vec3) -> (Vec3, Vec3) {
    axis.any_orthonormal_pair()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn moments(fibres: &[(Vec3, f32)]) -> [f32; 6] {
        let mut sum = [0.0; 6];
        for &(t, w) in fibres {
            let products = [
                t.x * t.x,
                t.y * t.y,
                t.z * t.z,
                t.x * t.y,
                t.x * t.z,
                t.y * t.z,
            ];
            for (sum, product) in sum.iter_mut().zip(products) {
                *sum += w * product;
            }
        }
        sum
    }

    /// Largest difference of two sums of moments.
    fn apart(a: [f32; 6], b: [f32; 6]) -> f32 {
        (a.iter().zip(&b)).fold(0.0, |worst, (a, b)| worst.max((a - b).abs()))
    }

    #[test]
    fn the_directions_have_the_moments_of_the_fibres() {
        let unit = |x: f32, y: f32, z: f32| Vec3::new(x, y, z).normalize_or(Vec3::Z);
        for fibres in [
            vec![(unit(1.0, 0.0, 0.3), 0.5), (unit(1.0, 0.1, -0.3), 0.5)],
            vec![(unit(0.2, 1.0, 0.1), 0.6), (unit(1.0, 0.2, 0.3), 0.4)],
            vec![(Vec3::X, 0.4), (Vec3::Y, 0.35), (Vec3::Z, 0.25)],
        ] {
            let own = moments(&fibres);
            let (axis, lobes) = Lobes::new(own.map(|m| 7.0 * m));
            let all: Vec<(Vec3, f32)> = (0..1 << 14)
                .map(|bits| (lobes.direction(axis, bits, 1.0), 1.0 / 16384.0))
                .collect();
            assert!(all.iter().all(|(t, _)| (t.length() - 1.0).abs() < 1e-4));
            // Packing the axis moves it by up to a degree.
            assert!(apart(moments(&all), own) < 0.03, "{fibres:?}");
            assert!(
                apart(moments(&[(axis, 1.0)]), own) > 0.04,
                "one direction is not enough"
            );
        }
    }

    #[test]
    fn one_fibre_has_one_direction_and_bad_moments_have_none() {
        let t = Vec3::new(0.6, 0.0, 0.8);
        let (axis, lobes) = Lobes::new(moments(&[(t, 2.0)]));
        for bits in 0..1 << 14 {
            assert!(lobes.direction(axis, bits, 1.0).dot(t).abs() > 0.999);
        }
        for bad in [[0.0; 6], [f32::NAN; 6], [f32::INFINITY; 6], [-1.0; 6]] {
            let (axis, lobes) = Lobes::new(bad);
            assert_eq!((axis, lobes), (Vec3::Z, Lobes::default()));
        }
    }
}
