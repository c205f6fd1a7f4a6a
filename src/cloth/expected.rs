//! The colour that a weave of two yarns is expected to show from afar, without rendering.
//!
//! Three things happen between yarns and cloth. The share of the face that is warp is not
//! the share of crossings with the warp up: where an end or a pick changes sides it dips,
//! and a lone tie stands proud. Light that entered one yarn leaves through another, so that
//! a mixture is darker than the mean of its parts: as in halftone prints (Yule & Nielsen
//! 1951), R^(1/n) = a·W^(1/n) + (1−a)·F^(1/n), where n grows with the border between warp
//! and weft, and with the lightness of the lighter yarn, in which light wanders farther.
//! And a yarn that floats shows a little lighter than one that is often bound.
//!
//! The coefficients are least-squares fits to pictures of this program's own tracer: a
//! single layer under the light "day", seen on the face, yarns 0.95 pitches thick at 60
//! ends and 100 picks per inch; 23 weaves in each family, in channels of 0.02, 0.15 and
//! 0.75 against 0.75, 0.50 and 0.02, for cotton and silk also of 0.01 against 0.60, 0.40
//! and 0.20. They leave a root mean square of about 1 in L* for satins (most: 4), 2 for
//! other weaves.

use glam::Vec3;

use super::colour::curve;
use crate::design::{Family, WeavePattern, Yarn};

/// What the fit to one family found.
struct Fitted {
    /// Cube root of a pure cloth's reflectance as a polynomial of the asked one's.
    own: [f32; 3],
    /// How much darker borders make that.
    bound: f32,
    /// Mixing n − 1 of white: without borders, and its growth with them.
    mixing: [f32; 2],
    /// Growth of the warp's share by changes of the picks, its loss by changes of the ends,
    /// and how far lone ties stand proud.
    share: [f32; 3],
}

/// How mixing grows with the lighter yarn's reflectance.
const WANDERING: f32 = 1.25;

fn fitted(family: Family) -> &'static Fitted {
    match family {
        Family::Cotton => &COTTON,
        Family::Silk => &SILK,
        Family::Wool => &WOOL,
        Family::Linen => &LINEN,
    }
}

const COTTON: Fitted = Fitted {
    own: [-0.0317, 1.3602, -0.3916],
    bound: 0.0764,
    mixing: [0.082, 2.793],
    share: [0.150, 0.132, 0.098],
};
const SILK: Fitted = Fitted {
    own: [-0.0506, 1.5412, -0.5584],
    bound: 0.0606,
    mixing: [-0.462, 3.072],
    share: [0.131, 0.099, -0.037],
};
const WOOL: Fitted = Fitted {
    own: [0.0018, 1.2942, -0.3402],
    bound: 0.0516,
    mixing: [0.235, 5.732],
    share: [0.062, 0.111, 0.662],
};
const LINEN: Fitted = Fitted {
    own: [0.0316, 1.1804, -0.2277],
    bound: 0.0932,
    mixing: [-0.172, 3.981],
    share: [0.115, 0.078, 0.161],
};

/// How a weave shows its two yarns.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Face {
    /// Share of crossings with the warp up.
    lift: f32,
    /// Changes between over and under along the ends, per crossing.
    along_ends: f32,
    /// The same along the picks.
    along_picks: f32,
}

impl Face {
    fn of(weave: &WeavePattern) -> Self {
        let (ends, picks) = (weave.ends(), weave.picks());
        let (mut along_ends, mut along_picks) = (0u64, 0u64);
        for pick in 0..picks {
            let above = (pick + 1) % picks;
            for end in 0..ends {
                let up = weave.get(end, pick);
                along_ends += u64::from(up != weave.get(end, above));
                along_picks += u64::from(up != weave.get((end + 1) % ends, pick));
            }
        }
        let crossings = (u64::from(ends) * u64::from(picks)) as f64;
        let share = |count: u64| (count as f64 / crossings) as f32;
        Self {
            lift: share(weave.count_warp_up()),
            along_ends: share(along_ends),
            along_picks: share(along_picks),
        }
    }

    /// Borders between over and under, per crossing: 1 in plain weave.
    fn borders(&self) -> f32 {
        0.5 * (self.along_ends + self.along_picks)
    }

    /// The warp's share of the face, and the mixing n − 1 of white.
    fn mixing(&self, fit: &Fitted) -> (f32, f32) {
        let borders = self.borders();
        // Borders for the area they enclose: 1 in plain weave.
        let even = 4.0 * self.lift * (1.0 - self.lift);
        if even <= 0.0 {
            return (self.lift, 0.0);
        }
        let [by_picks, by_ends, proud] = fit.share;
        let share = self.lift + by_picks * self.along_picks - by_ends * self.along_ends
            + proud * (0.5 - self.lift) * borders;
        let mixing = fit.mixing[0] + fit.mixing[1] * (borders / even).min(1.0);
        (share.clamp(0.0, 1.0), mixing.max(0.0))
    }

    /// The linear colour that this weave of one yarn is expected to show.
    fn own(&self, yarn: &Yarn) -> Vec3 {
        let (low, high) = curve(yarn.family, yarn.alpha())
            .map_or((0.0, 1.0), |curve| curve.range(yarn.surface_share));
        let fit = fitted(yarn.family);
        let [a, b, c] = fit.own;
        let shown = |asked: f32| {
            let x = asked.clamp(low, high.max(low)).cbrt();
            let dimmed = fit.bound * self.borders() * (1.0 - x * x);
            (a + x * (b + x * c) - dimmed).clamp(0.01, 1.0).powi(3)
        };
        Vec3::from_array(yarn.colour.to_linear().to_array().map(shown))
    }
}

/// The linear colour (Rec. 709, 0..=1) that a weave of two yarns is expected to show from
/// afar: what a still's pixels average to under the default light.
pub fn expected_colour(weave: &WeavePattern, warp: &Yarn, weft: &Yarn) -> Vec3 {
    let face = Face::of(weave);
    let (warp_share, warp_mixing) = face.mixing(fitted(warp.family));
    let (weft_share, weft_mixing) = face.mixing(fitted(weft.family));
    let share = 0.5 * (warp_share + weft_share);
    let mixing = 0.5 * (warp_mixing + weft_mixing);
    let (warp, weft) = (face.own(warp), face.own(weft));
    let shown = |warp: f32, weft: f32| {
        let n = 1.0 + mixing * warp.max(weft).powf(WANDERING);
        let root = |light: f32| light.powf(1.0 / n);
        (share * root(warp) + (1.0 - share) * root(weft)).powf(n)
    };
    Vec3::new(
        shown(warp.x, weft.x),
        shown(warp.y, weft.y),
        shown(warp.z, weft.z),
    )
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;
    use crate::design::{Srgb, delta_e_00, lab, weave};

    fn yarns() -> (Yarn, Yarn) {
        let yarn = |colour| Yarn::new("y", Family::Cotton, colour);
        (yarn(Srgb(40, 30, 60)), yarn(Srgb(230, 225, 210)))
    }

    #[test]
    fn more_warp_shows_more_of_the_warp() {
        let (dark, light) = yarns();
        let shown = |notation: &str| {
            expected_colour(&weave(notation).unwrap(), &dark, &light).element_sum()
        };
        for over in 1..7 {
            let (less, more) = (format!("{over}/{} satin", 8 - over), over + 1);
            assert!(
                shown(&less) > shown(&format!("{more}/{} satin", 8 - more)),
                "{over}"
            );
        }
    }

    #[test]
    fn a_mixture_lies_between_its_yarns_and_below_their_mean() {
        let (dark, light) = yarns();
        for notation in [
            "plain",
            "2/2 twill",
            "1/7 satin",
            "4/4 basket",
            "4/4 warp rib",
        ] {
            let weave = weave(notation).unwrap();
            let low = expected_colour(&weave, &dark, &dark);
            let high = expected_colour(&weave, &light, &light);
            let shown = expected_colour(&weave, &dark, &light);
            assert!(
                shown.cmpgt(low).all() && shown.cmplt(high).all(),
                "{notation}"
            );
            let lift = weave.count_warp_up() as f32 / (weave.ends() * weave.picks()) as f32;
            assert!(shown.cmplt(high + (low - high) * lift).all(), "{notation}");
        }
    }

    #[test]
    fn one_colour_shows_itself_whichever_yarn_is_on_top() {
        let (dark, light) = yarns();
        for yarn in [&dark, &light] {
            let asked = yarn.colour.to_linear();
            for notation in ["plain", "1/7 satin", "7/1 satin", "3/3 basket"] {
                let shown = expected_colour(&weave(notation).unwrap(), yarn, yarn);
                let off = delta_e_00(lab(shown), lab(asked));
                assert!(off < 5.0, "{notation}: {off:.1}");
            }
        }
        // Where one yarn alone is on top, the other does not matter.
        let (weft_up, warp_up) = (WeavePattern::new(1, 1), WeavePattern::new(3, 2).inverted());
        let shows = |weave: &WeavePattern, yarn: &Yarn| {
            let mixed = expected_colour(weave, &dark, &light);
            mixed.abs_diff_eq(expected_colour(weave, yarn, yarn), 1e-5)
        };
        assert!(shows(&weft_up, &light) && !shows(&weft_up, &dark));
        assert!(shows(&warp_up, &dark) && !shows(&warp_up, &light));
    }

    #[test]
    fn wild_yarns_give_finite_colours() {
        let (dark, light) = yarns();
        for share in [0.0, 1.0] {
            for &family in Family::ALL {
                let odd = Yarn {
                    surface_share: share,
                    family,
                    gloss: Some(0.0),
                    colour: Srgb(0, 255, 1),
                    ..dark.clone()
                };
                for notation in ["plain", "1/31 satin", "64/1 twill"] {
                    let shown = expected_colour(&weave(notation).unwrap(), &odd, &light);
                    assert!(shown.is_finite() && shown.min_element() >= 0.0);
                    assert!(shown.max_element() <= 1.0);
                }
            }
        }
    }
}
