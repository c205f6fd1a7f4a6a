//! The colour that a weave of two yarns is expected to show from afar, without rendering.
//!
//! Two things happen between yarns and cloth. The share of the face that is warp is not
//! the share of crossings with the warp up: where an end or a pick changes sides it dips,
//! and a lone tie stands proud. And light that entered one yarn leaves through another, so
//! that a mixture is darker than the mean of its parts: as in halftone prints (Yule &
//! Nielsen 1951), R^(1/n) = a·W^(1/n) + (1−a)·F^(1/n), where n grows with the border
//! between warp and weft.
//!
//! The coefficients are least-squares fits to pictures of this program's own tracer: a
//! single layer under the light "day", seen on the face, 23 weaves in each family, yarns
//! 0.95 pitches thick at 60 ends and 100 picks per inch, in channels of 0.02, 0.15 and
//! 0.75 against 0.75, 0.50 and 0.02.

use glam::Vec3;

use super::colour::curve;
use crate::design::{Family, WeavePattern, Yarn};

/// What the fit to one family found.
struct Fitted {
    /// Cube root of a pure cloth's reflectance as a polynomial of the asked one's.
    own: [f32; 3],
    /// Mixing n: without borders, and its growth with them.
    mixing: [f32; 2],
    /// Growth of the warp's share by changes of the picks, its loss by changes of the ends,
    /// and how far lone ties stand proud.
    share: [f32; 3],
}

fn fitted(family: Family) -> &'static Fitted {
    match family {
        Family::Cotton => &COTTON,
        Family::Silk => &SILK,
        Family::Wool => &WOOL,
        Family::Linen => &LINEN,
    }
}

const COTTON: Fitted = Fitted {
    own: [-0.0255, 1.1680, -0.1676],
    mixing: [0.864, 2.798],
    share: [0.129, 0.106, 0.325],
};
const SILK: Fitted = Fitted {
    own: [-0.0191, 1.3167, -0.3297],
    mixing: [0.490, 3.290],
    share: [0.126, 0.083, 0.144],
};
const WOOL: Fitted = Fitted {
    own: [-0.0472, 1.3859, -0.3754],
    mixing: [0.915, 4.331],
    share: [0.064, 0.106, 0.726],
};
const LINEN: Fitted = Fitted {
    own: [-0.0217, 1.2255, -0.2176],
    mixing: [0.613, 3.330],
    share: [0.117, 0.077, 0.214],
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

    /// The warp's share of the face, and the mixing n.
    fn mixing(&self, fit: &Fitted) -> (f32, f32) {
        let borders = 0.5 * (self.along_ends + self.along_picks);
        // Borders for the area they enclose: 1 in plain weave.
        let even = 4.0 * self.lift * (1.0 - self.lift);
        let mixed = if even > 0.0 {
            (borders / even).min(1.0)
        } else {
            0.0
        };
        let [by_picks, by_ends, proud] = fit.share;
        let share = self.lift + by_picks * self.along_picks - by_ends * self.along_ends
            + proud * (0.5 - self.lift) * borders;
        let n = (fit.mixing[0] + fit.mixing[1] * mixed).max(1.0);
        (share.clamp(0.0, 1.0), n)
    }
}

/// The linear colour (Rec. 709, 0..=1) that cloth of this yarn alone is expected to show:
/// the yarn's own within what its family can reflect, as "day" lights it.
pub fn yarn_colour(yarn: &Yarn) -> Vec3 {
    let (low, high) = curve(yarn.family, yarn.alpha())
        .map_or((0.0, 1.0), |curve| curve.range(yarn.surface_share));
    let [a, b, c] = fitted(yarn.family).own;
    let shown = |asked: f32| {
        let x = asked.clamp(low, high.max(low)).cbrt();
        (a + x * (b + x * c)).clamp(0.0, 1.0).powi(3)
    };
    Vec3::from_array(yarn.colour.to_linear().to_array().map(shown))
}

/// The linear colour (Rec. 709, 0..=1) that a weave of two yarns is expected to show from
/// afar: what a still's pixels average to under the default light.
pub fn expected_colour(weave: &WeavePattern, warp: &Yarn, weft: &Yarn) -> Vec3 {
    let face = Face::of(weave);
    let (warp_share, n) = face.mixing(fitted(warp.family));
    let (weft_share, m) = face.mixing(fitted(weft.family));
    let (share, n) = (0.5 * (warp_share + weft_share), 0.5 * (n + m));
    let (warp, weft) = (yarn_colour(warp), yarn_colour(weft));
    let root = |colour: Vec3| colour.powf(1.0 / n);
    (root(warp) * share + root(weft) * (1.0 - share)).powf(n)
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;
    use crate::design::{Srgb, weave};

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
        let (low, high) = (yarn_colour(&dark), yarn_colour(&light));
        for notation in [
            "plain",
            "2/2 twill",
            "1/7 satin",
            "4/4 basket",
            "4/4 warp rib",
        ] {
            let weave = weave(notation).unwrap();
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
    fn one_colour_shows_itself_in_every_weave() {
        let (dark, _) = yarns();
        for notation in ["plain", "1/7 satin", "3/3 basket"] {
            let shown = expected_colour(&weave(notation).unwrap(), &dark, &dark);
            assert!((shown - yarn_colour(&dark)).abs().max_element() < 1e-5);
        }
        let (one, two) = (WeavePattern::new(1, 1), WeavePattern::new(3, 2).inverted());
        let (dark, light) = yarns();
        assert!(expected_colour(&one, &dark, &light).abs_diff_eq(yarn_colour(&light), 1e-5));
        assert!(expected_colour(&two, &dark, &light).abs_diff_eq(yarn_colour(&dark), 1e-5));
    }
}
