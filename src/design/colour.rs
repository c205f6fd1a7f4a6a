//! CIELAB (D65) and CIEDE2000: how different two colours look. The table of Sharma, Wu &
//! Dalal (2005) is the oracle of the difference.

use glam::Vec3;
use palette::color_difference::Ciede2000;
use palette::convert::FromColorUnclamped;
use palette::white_point::D65;

/// A colour as L*, a*, b*.
pub type Lab = [f64; 3];

/// CIELAB of linear Rec. 709 relative to the white (1, 1, 1), which is D65.
pub fn lab(linear: Vec3) -> Lab {
    let [r, g, b] = linear.to_array().map(f64::from);
    let lab: palette::Lab<D65, f64> =
        palette::Lab::from_color_unclamped(palette::LinSrgb::new(r, g, b));
    lab.into()
}

/// ΔE₀₀ of two colours (CIE 142-2001; Sharma, Wu & Dalal 2005), all weights 1.
pub fn delta_e_00(one: Lab, other: Lab) -> f64 {
    let [one, other] = [one, other].map(palette::Lab::<D65, f64>::from);
    one.difference(other)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Table 1 of Sharma, Wu & Dalal (2005): one row a pair, then its ΔE₀₀.
    const PUBLISHED: [[f64; 7]; 34] = [
        [50.0, 2.6772, -79.7751, 50.0, 0.0, -82.7485, 2.0425],
        [50.0, 3.1571, -77.2803, 50.0, 0.0, -82.7485, 2.8615],
        [50.0, 2.8361, -74.0200, 50.0, 0.0, -82.7485, 3.4412],
        [50.0, -1.3802, -84.2814, 50.0, 0.0, -82.7485, 1.0000],
        [50.0, -1.1848, -84.8006, 50.0, 0.0, -82.7485, 1.0000],
        [50.0, -0.9009, -85.5211, 50.0, 0.0, -82.7485, 1.0000],
        [50.0, 0.0, 0.0, 50.0, -1.0, 2.0, 2.3669],
        [50.0, -1.0, 2.0, 50.0, 0.0, 0.0, 2.3669],
        [50.0, 2.4900, -0.0010, 50.0, -2.4900, 0.0009, 7.1792],
        [50.0, 2.4900, -0.0010, 50.0, -2.4900, 0.0010, 7.1792],
        [50.0, 2.4900, -0.0010, 50.0, -2.4900, 0.0011, 7.2195],
        [50.0, 2.4900, -0.0010, 50.0, -2.4900, 0.0012, 7.2195],
        [50.0, -0.0010, 2.4900, 50.0, 0.0009, -2.4900, 4.8045],
        [50.0, -0.0010, 2.4900, 50.0, 0.0010, -2.4900, 4.8045],
        [50.0, -0.0010, 2.4900, 50.0, 0.0011, -2.4900, 4.7461],
        [50.0, 2.5, 0.0, 50.0, 0.0, -2.5, 4.3065],
        [50.0, 2.5, 0.0, 73.0, 25.0, -18.0, 27.1492],
        [50.0, 2.5, 0.0, 61.0, -5.0, 29.0, 22.8977],
        [50.0, 2.5, 0.0, 56.0, -27.0, -3.0, 31.9030],
        [50.0, 2.5, 0.0, 58.0, 24.0, 15.0, 19.4535],
        [50.0, 2.5, 0.0, 50.0, 3.1736, 0.5854, 1.0000],
        [50.0, 2.5, 0.0, 50.0, 3.2972, 0.0, 1.0000],
        [50.0, 2.5, 0.0, 50.0, 1.8634, 0.5757, 1.0000],
        [50.0, 2.5, 0.0, 50.0, 3.2592, 0.3350, 1.0000],
        [
            60.2574, -34.0099, 36.2677, 60.4626, -34.1751, 39.4387, 1.2644,
        ],
        [
            63.0109, -31.0961, -5.8663, 62.8187, -29.7946, -4.0864, 1.2630,
        ],
        [61.2901, 3.7196, -5.3901, 61.4292, 2.2480, -4.9620, 1.8731],
        [35.0831, -44.1164, 3.7933, 35.0232, -40.0716, 1.5901, 1.8645],
        [
            22.7233, 20.0904, -46.6940, 23.0331, 14.9730, -42.5619, 2.0373,
        ],
        [36.4612, 47.8580, 18.3852, 36.2715, 50.5065, 21.2231, 1.4146],
        [90.8027, -2.0831, 1.4410, 91.1528, -1.6435, 0.0447, 1.4441],
        [90.9257, -0.5406, -0.9208, 88.6381, -0.8985, -0.7239, 1.5381],
        [6.7747, -0.2908, -2.4247, 5.8714, -0.0985, -2.2286, 0.6377],
        [2.0776, 0.0795, -1.1350, 0.9033, -0.0636, -0.5514, 0.9082],
    ];

    #[test]
    fn differences_are_the_published_ones() {
        for [l1, a1, b1, l2, a2, b2, expected] in PUBLISHED {
            let (one, other) = ([l1, a1, b1], [l2, a2, b2]);
            let there = delta_e_00(one, other);
            let back = delta_e_00(other, one);
            assert!(
                (there - expected).abs() < 1e-4,
                "{one:?} {other:?}: {there}"
            );
            assert!((there - back).abs() < 1e-9, "{one:?} {other:?}: {back}");
        }
    }

    #[test]
    fn lab_of_white_red_and_grey_are_the_textbook_ones() {
        let expected = [
            (Vec3::ONE, [100.0, 0.0, 0.0]),
            (Vec3::X, [53.24, 80.09, 67.20]),
            (Vec3::splat(0.184_187), [50.0, 0.0, 0.0]),
            (Vec3::ZERO, [0.0, 0.0, 0.0]),
        ];
        for (linear, expected) in expected {
            for (value, expected) in lab(linear).into_iter().zip(expected) {
                assert!(
                    (value - expected).abs() < 0.02,
                    "{linear}: {:?}",
                    lab(linear)
                );
            }
        }
    }
}
