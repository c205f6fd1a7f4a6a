//! What a gain depends on: the kind of place, and the directions of light, eye and fibre.

use glam::Vec3;

use crate::render::{Arrival, PLACE, SYSTEM};

/// Terms of a gain's series.
pub const TERMS: usize = 24;
/// Kinds of places where light is scattered.
pub const KINDS: usize = 18;
/// Terms that each kind of place has a factor of its own for: the first ones.
pub const OWN: usize = 12;

/// Light scattered more often than these is that of yarns paler and paler.
const OFTEN: [f32; 3] = [8.0, 32.0, 128.0];
/// The lower yarn's kinds follow the upper one's.
const LOWER: u32 = 9;
/// Bits of a place: its kind, from here on the hand of its twill line, then [`SYSTEM`], and
/// from here on the number of the gains.
const HAND: u32 = 5;
const GAINS: u32 = 8;
/// The number of no gains; those from here on have no bits.
pub const UNCORRECTED: usize = 127;

/// How the lower and the upper yarn of a block of this key stand, as bits of [`PLACE`].
///
/// The upper yarn's float goes on to none, one or both sides of the block, and none, one
/// or both yarns beside it are up as well: nine kinds, for warp and weft alike, and nine
/// more for the lower yarn. Where one and one are, they make a twill's line, which has a
/// hand.
pub fn places(key: u8) -> [u32; 2] {
    let up = key & 1;
    let same = |bit: u8| u32::from(key >> bit & 1 == up);
    let [x, y] = [same(1) + same(2), same(3) + same(4)];
    let (along, across) = if up == 1 { (y, x) } else { (x, y) };
    let kind = along * 3 + across;
    let hand = if (along, across) == (1, 1) {
        1 + u32::from(same(2) == same(4))
    } else {
        0
    };
    [LOWER, 0].map(|lower| ((kind + lower) | (hand << HAND)) << PLACE.trailing_zeros())
}

/// The number of the gains of a yarn in the warp (0) or the weft (1) as bits of [`PLACE`].
pub fn corrected(number: usize, yarn: usize) -> u32 {
    let number = (number.min(UNCORRECTED) as u32) << (PLACE.trailing_zeros() + GAINS);
    number | (SYSTEM * u32::from(yarn > 0))
}

/// The number of the gains of optics that carry its bits, and warp (0) or weft (1).
#[inline]
pub fn correction(optics: u32) -> (usize, usize) {
    let number = (optics & PLACE) >> (PLACE.trailing_zeros() + GAINS);
    (number as usize, usize::from(optics & SYSTEM != 0))
}

/// The kind of place of an arrival, below [`KINDS`] in a corrected cloth.
#[inline]
pub fn kind(arrival: &Arrival) -> usize {
    let place = (arrival.optics & PLACE) >> PLACE.trailing_zeros();
    (place & ((1 << HAND) - 1)) as usize
}

/// The terms of the series at an arrival, each between −1 and 1: a constant, how often the
/// light was scattered (four of them, one first), on which side it stands, whether both
/// systems of yarns scattered it and how often then, how low it stands over the cloth, how
/// far it comes along the fibre, how far the fibre is off a mirror's direction (½ where the
/// half vector leans by α), on which side of a twill's lines the light stands, the fibre's
/// slope, how far the fibre's seen side faces the light, and where the light stands, all
/// round.
#[inline]
pub fn terms(arrival: &Arrival) -> [f32; TERMS] {
    let place = (arrival.optics & PLACE) >> PLACE.trailing_zeros();
    let hand = [0.0, -1.0, 1.0, 0.0][(place >> HAND & 3) as usize];
    let (light, eye, fibre) = (arrival.to_light, arrival.to_eye, arrival.fibre);
    let order = arrival.order.max(1) as f32;
    let mixed = f32::from(u8::from(arrival.mixed));
    let low = 1.0 - light.z.abs().min(1.0);
    let half = (eye + light).normalize_or(Vec3::Z);
    let lean = half.dot(fibre).powi(2);
    let off = lean / (lean + arrival.alpha * arrival.alpha).max(1e-6);
    let aside = light.x * light.x - light.y * light.y;
    let seen = (eye - fibre * eye.dot(fibre)).normalize_or(Vec3::Z);
    [
        1.0,
        1.0 / order,
        light.x,
        light.y,
        order / (order + OFTEN[0]),
        order / (order + OFTEN[1]),
        order / (order + OFTEN[2]),
        mixed,
        mixed / order,
        low,
        low * low,
        light.dot(fibre).powi(2),
        off,
        off * low,
        hand * light.x * light.y,
        fibre.z * fibre.z,
        seen.dot(light),
        aside,
        aside * low,
        aside * aside,
        off * off,
        light.x * low,
        light.y * low,
        light.x * light.y,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_correction_is_named_beside_any_place_and_yarn() {
        for number in [0, 1, 77, 126, 127, 1000] {
            for (place, yarn) in places(0b11111).into_iter().flat_map(|p| [(p, 0), (p, 1)]) {
                let optics = 9 | place | corrected(number, yarn);
                assert_eq!(correction(optics), (number.min(UNCORRECTED), yarn));
                assert_eq!(optics & !PLACE, 9);
                assert_eq!(optics & PLACE & !corrected(UNCORRECTED, 1), place);
            }
        }
    }

    fn place(key: u8, upper: bool) -> (u32, u32) {
        let bits = places(key)[usize::from(upper)] >> PLACE.trailing_zeros();
        (bits & 31, bits >> HAND)
    }

    #[test]
    fn kinds_tell_crowns_floats_and_lines_apart_and_warp_and_weft_are_alike() {
        // Bits: centre, left, right, below, above.
        let (crown, middle) = (0b00001, 0b11001);
        assert_eq!(place(crown, true), (0, 0));
        assert_eq!(place(middle, true), (6, 0));
        assert_eq!(place(0b11111, true), (8, 0));
        for key in 0..32u8 {
            let turned = (key & 1) | (key & 0b110) << 2 | (key & 0b11000) >> 2;
            let (kind, hand) = place(key, true);
            assert!(kind < 9 && hand < 3, "{key}");
            assert_eq!(place(key, false).0, kind + 9);
            // A weft that lies as this warp does is of the same kind.
            assert_eq!(place(turned ^ 31, true).0, kind, "{key}");
        }
        // A line that rises to the right and one that rises to the left.
        let (z, s) = (0b10101, 0b10011);
        assert_eq!((place(z, true), place(s, true)), ((4, 2), (4, 1)));
    }

    #[test]
    fn terms_are_bounded_in_all_directions() {
        let ring = |i: usize| {
            let (sine, cosine) = (0.37 * i as f32).sin_cos();
            let z = (i % 21) as f32 / 10.0 - 1.0;
            let r = (1.0 - z * z).max(0.0).sqrt();
            Vec3::new(r * cosine, r * sine, z)
        };
        for i in 0..2000 {
            let arrival = Arrival {
                order: i as u32 % 5,
                mixed: i % 3 == 0,
                optics: 7 | places((i % 32) as u8)[i % 2],
                fibre: ring(i),
                alpha: 0.08,
                to_eye: ring(3 * i + 1),
                to_light: ring(7 * i + 2),
            };
            assert!(kind(&arrival) < KINDS);
            for term in terms(&arrival) {
                assert!((-1.001..=1.001).contains(&term), "{arrival:?}: {term}");
            }
        }
    }
}
