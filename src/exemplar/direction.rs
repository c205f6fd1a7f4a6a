//! Fibre directions in two bytes: octahedral, where t and −t mean the same.

use glam::{Vec2, Vec3};

/// Packs a direction into 2×8 bits; the error stays under about a degree.
///
/// A direction without a finite length packs as +z.
pub fn encode_direction(direction: Vec3) -> u16 {
    let direction = if direction.z < 0.0 {
        -direction
    } else {
        direction
    };
    let sum = direction.x.abs() + direction.y.abs() + direction.z;
    if !(sum.is_finite() && sum > 1e-20) {
        return encode(Vec2::ZERO);
    }
    // The upper half is a diamond; turned by 45° it fills the whole square.
    let diamond = Vec2::new(direction.x, direction.y) / sum;
    encode(Vec2::new(diamond.x + diamond.y, diamond.x - diamond.y))
}

fn encode(square: Vec2) -> u16 {
    let byte = |v: f32| ((v * 127.0).round() + 127.0).clamp(0.0, 254.0) as u16;
    byte(square.x) | byte(square.y) << 8
}

/// The unit direction that [`encode_direction`] packed (z ≥ 0).
pub fn decode_direction(packed: u16) -> Vec3 {
    let value = |byte: u16| (f32::from(byte) - 127.0) / 127.0;
    let (a, b) = (value(packed & 0xff).min(1.0), value(packed >> 8).min(1.0));
    let (x, y) = (0.5 * (a + b), 0.5 * (a - b));
    let direction = Vec3::new(x, y, (1.0 - x.abs() - y.abs()).max(0.0));
    direction * direction.length_recip()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::yarn::{hash, unit};

    #[test]
    fn directions_survive_packing() {
        for i in 0..10_000u64 {
            let random = |k| 2.0 * unit(hash(k, i)) - 1.0;
            let direction = Vec3::new(random(1), random(2), random(3));
            if direction.length() < 0.1 {
                continue;
            }
            let direction = direction / direction.length();
            let error = 1.0
                - direction
                    .dot(decode_direction(encode_direction(direction)))
                    .abs();
            assert!(error < 2.5e-4, "{direction}: {error}");
        }
    }

    #[test]
    fn poison_packs_as_something_finite() {
        for poison in [Vec3::NAN, Vec3::INFINITY, Vec3::ZERO, Vec3::splat(1e-40)] {
            assert!((decode_direction(encode_direction(poison)).length() - 1.0).abs() < 1e-5);
        }
        for packed in 0..=u16::MAX {
            assert!(decode_direction(packed).is_finite());
        }
    }
}
