//! First proposals: one dark warp, one light weft, and for every colour a weave of the
//! shadow series that shows its lightness.

use super::series::{DARKEST, LIGHTEST, shadow_weave};
use super::settings::PosteriseSettings;
use crate::cloth::expected::expected_colour;
use crate::design::{Design, Fill, Lab, Sett, Srgb, WeavePattern, Yarn, YarnId, YarnMaps, lab};

/// Diameter over pitch of the yarns: dense cloth, as jacquards are, that hides what lies
/// behind it.
const COVER: f32 = 0.95;
/// Colours of each half of the palette that are tried as a yarn.
const TRIED: usize = 8;
/// How much darker than a colour of the picture its warp is tried: 1/7 of even the darkest
/// weave is weft.
const DARKER: [f32; 3] = [1.0, 0.5, 0.25];
/// How much lighter the weft is tried.
const LIGHTER: [f32; 3] = [1.0, 1.4, 2.0];
/// What squared differences of a* and b* count beside those of L*.
const HUE_WEIGHT: f64 = 0.1;
/// A black that dyers reach.
const BLACK: Srgb = Srgb(0x1c, 0x1b, 0x1d);
/// No dye leaves less light than this in any channel, linear.
const LEAST_LIGHT: f32 = 0.01;

/// The two yarns of a cloth.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Pair {
    pub warp: Yarn,
    pub weft: Yarn,
}

/// The yarns of a cloth and where they lie, before regions get their own.
pub(super) struct Yarns {
    pub all: Vec<Yarn>,
    pub maps: YarnMaps,
    /// What weaves are proposed for: the first of the warp order and of the weft order.
    pub pair: Pair,
}

impl Yarns {
    fn of_pair(pair: Pair) -> Self {
        Self {
            all: vec![pair.warp.clone(), pair.weft.clone()],
            maps: YarnMaps::plain(YarnId(0), YarnId(1)),
            pair,
        }
    }

    /// Those of a design that is posterised anew. Of a design for previews only the first
    /// two: the regions' own follow them.
    pub fn kept(design: &Design) -> Self {
        let yarn = |id| design.yarn(id).clone();
        let (warp, weft) = (design.maps().warp.order(), design.maps().weft.order());
        match (warp.and_then(<[_]>::first), weft.and_then(<[_]>::first)) {
            (Some(&warp), Some(&weft)) => Self {
                all: design.yarns().to_vec(),
                maps: design.maps().clone(),
                pair: Pair {
                    warp: yarn(warp),
                    weft: yarn(weft),
                },
            },
            _ => Self::of_pair(Pair {
                warp: yarn(YarnId(0)),
                weft: yarn(YarnId(1)),
            }),
        }
    }

    /// Those proposed for a picture.
    pub fn proposed(asked: &[Srgb], coverage: &[f64], settings: &PosteriseSettings) -> Self {
        Self::of_pair(pair(asked, coverage, settings))
    }
}

/// A yarn as thick as the sett calls for.
fn yarn(name: &str, settings: &PosteriseSettings, colour: Srgb, pitch_mm: f32) -> Yarn {
    Yarn {
        diameter_mm: Some(COVER * pitch_mm),
        ..Yarn::new(name, settings.family, colour)
    }
}

fn pair_in(settings: &PosteriseSettings, [warp, weft]: [Srgb; 2]) -> Pair {
    let sett = Sett::per_cm(settings.ends_per_cm, settings.picks_per_cm);
    Pair {
        warp: yarn("warp", settings, warp, sett.end_pitch_mm()),
        weft: yarn("weft", settings, weft, sett.pick_pitch_mm()),
    }
}

/// How far a mixture is from a colour in the eyes of a picture: two yarns meet lightness,
/// which makes the drawing, and hue only by luck.
fn unlikeness(asked: Lab, shown: Lab) -> f64 {
    let [l, a, b] = [0, 1, 2].map(|at| (asked[at] - shown[at]).powi(2));
    l + HUE_WEIGHT * (a + b)
}

/// The colours that most of a half of the picture has, scaled in light, and `own`.
fn candidates(half: &[(Srgb, f64)], scales: [f32; 3], own: Srgb) -> Vec<Srgb> {
    let mut most = half.to_vec();
    most.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    let mut found = vec![own];
    for (colour, _) in most.into_iter().take(TRIED) {
        let light = colour.to_linear();
        found.extend(scales.map(|scale| {
            // Lighter yarns keep their hue: no channel is cut off.
            let most = 0.8 / light.max_element().max(1e-6);
            let scaled = light * scale.min(most.max(1.0));
            Srgb::from_linear(scaled.max(glam::Vec3::splat(LEAST_LIGHT)))
        }));
    }
    found.sort_unstable();
    found.dedup();
    found
}

/// The dark and the light yarn whose mixtures are nearest to the picture's colours, in mean
/// squares weighted with coverage; the warp is the dark one.
fn pair(asked: &[Srgb], coverage: &[f64], settings: &PosteriseSettings) -> Pair {
    if let Some(colours) = settings.yarns {
        return pair_in(settings, colours);
    }
    let colours: Vec<_> = asked
        .iter()
        .copied()
        .zip(coverage.iter().copied())
        .collect();
    let (dark, light) = colours.split_at(colours.len().div_ceil(2));
    let darks = candidates(dark, DARKER, BLACK);
    let lights = candidates(light, LIGHTER, settings.family.numbers().undyed);
    let labs: Vec<_> = asked.iter().map(|c| lab(c.to_linear())).collect();
    let weaves: Vec<Fill> = (LIGHTEST..=DARKEST).step_by(8).map(shadow_weave).collect();
    let patterns: Vec<&WeavePattern> = weaves.iter().map(Fill::pattern).collect();
    let mut best = (f64::INFINITY, [BLACK, settings.family.numbers().undyed]);
    for &warp in &darks {
        for &weft in &lights {
            let pair = pair_in(settings, [warp, weft]);
            let shown: Vec<_> = (patterns.iter())
                .map(|weave| lab(expected_colour(weave, &pair.warp, &pair.weft)))
                .collect();
            let off: f64 = (labs.iter().zip(coverage))
                .map(|(asked, share)| {
                    let nearest = shown
                        .iter()
                        .min_by(|a, b| (a[0] - asked[0]).abs().total_cmp(&(b[0] - asked[0]).abs()));
                    share * nearest.map_or(0.0, |shown| unlikeness(*asked, *shown))
                })
                .sum();
            if off < best.0 {
                best = (off, [warp, weft]);
            }
        }
    }
    pair_in(settings, best.1)
}

/// A weave for every colour that does not keep one: the weave of the series whose expected
/// lightness is nearest, no two colours alike as long as there are weaves enough.
pub(super) fn weaves(
    asked: &[Srgb],
    coverage: &[f64],
    kept: &[Option<usize>],
    pair: &Pair,
) -> Vec<Fill> {
    // Twice as many weaves as colours, so that lightness is met well.
    let steps = (DARKEST - LIGHTEST) as usize;
    let step = [8, 4, 2]
        .into_iter()
        .find(|step| steps / step + 1 >= 2 * asked.len());
    let series: Vec<Fill> = (LIGHTEST..=DARKEST)
        .step_by(step.unwrap_or(1))
        .map(shadow_weave)
        .collect();
    let lightness = |fill: &Fill| lab(expected_colour(fill.pattern(), &pair.warp, &pair.weft))[0];
    let mut shown: Vec<(f64, usize)> = (series.iter().enumerate())
        .map(|(at, fill)| (lightness(fill), at))
        .collect();
    shown.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let free: Vec<usize> = (0..asked.len()).filter(|&at| kept[at].is_none()).collect();
    let wanted: Vec<(f64, f64)> = (free.iter())
        .map(|&at| (lab(asked[at].to_linear())[0], coverage[at].sqrt() + 1e-3))
        .collect();
    let levels: Vec<f64> = shown.iter().map(|&(lightness, _)| lightness).collect();
    let chosen = rising(&wanted, &levels);
    let mut weaves = vec![series[shown[0].1].clone(); asked.len()];
    for (&at, level) in free.iter().zip(chosen) {
        weaves[at] = series[shown[level].1].clone();
    }
    weaves
}

/// For wanted values (rising, each with a weight) levels that rise with them and are
/// nearest in squares; strictly rising if there are levels enough.
fn rising(wanted: &[(f64, f64)], levels: &[f64]) -> Vec<usize> {
    let apart = usize::from(wanted.len() <= levels.len());
    // best[l] = (least cost with the last wanted value on level l or below, that level).
    let mut steps: Vec<Vec<(f64, usize)>> = Vec::with_capacity(wanted.len());
    for (place, &(value, weight)) in wanted.iter().enumerate() {
        let mut row = Vec::with_capacity(levels.len());
        let mut least = (f64::INFINITY, 0);
        for (level, shown) in levels.iter().enumerate() {
            let before = match place.checked_sub(1) {
                None => 0.0,
                Some(last) => match level.checked_sub(apart) {
                    Some(below) => steps[last][below].0,
                    None => f64::INFINITY,
                },
            };
            let cost = before + weight * (value - shown).powi(2);
            if cost < least.0 {
                least = (cost, level);
            }
            row.push(least);
        }
        steps.push(row);
    }
    let mut chosen = vec![0; wanted.len()];
    let mut most = levels.len().saturating_sub(1);
    for place in (0..wanted.len()).rev() {
        chosen[place] = steps[place][most].1;
        most = chosen[place].saturating_sub(apart);
    }
    chosen
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;

    #[test]
    fn levels_rise_with_what_is_wanted_and_are_the_best_that_do() {
        let levels = [10.0, 20.0, 30.0, 40.0];
        let wanted = |list: &[f64]| list.iter().map(|&v| (v, 1.0)).collect::<Vec<_>>();
        assert_eq!(rising(&wanted(&[11.0, 29.0, 90.0]), &levels), [0, 2, 3]);
        assert_eq!(rising(&wanted(&[39.0, 40.0]), &levels), [2, 3]);
        assert_eq!(
            rising(&wanted(&[0.0, 0.0, 0.0, 0.0]), &levels),
            [0, 1, 2, 3]
        );
        // More than there are levels: alike where they must.
        assert_eq!(
            rising(&wanted(&[1.0, 2.0, 3.0, 22.0, 99.0]), &levels),
            [0, 0, 0, 1, 3]
        );
        // Brute force over all strictly rising triples.
        let three = wanted(&[24.0, 26.0, 33.0]);
        let cost = |at: &[usize]| {
            let off = three
                .iter()
                .zip(at)
                .map(|(w, &l)| (w.0 - levels[l]).powi(2));
            off.sum::<f64>()
        };
        let mut least = f64::INFINITY;
        for a in 0..4 {
            for b in a + 1..4 {
                for c in b + 1..4 {
                    least = least.min(cost(&[a, b, c]));
                }
            }
        }
        assert_eq!(cost(&rising(&three, &levels)), least);
    }

    #[test]
    fn a_picture_in_two_colours_gets_yarns_near_them() {
        let asked = [Srgb(30, 40, 90), Srgb(235, 225, 200)];
        let settings = PosteriseSettings::default();
        let pair = pair(&asked, &[0.5, 0.5], &settings);
        let lightness = |colour: Srgb| lab(colour.to_linear())[0];
        assert!(lightness(pair.warp.colour) < 20.0, "{}", pair.warp.colour);
        assert!(lightness(pair.weft.colour) > 80.0, "{}", pair.weft.colour);
        // Blue, as the picture's dark half is.
        assert!(pair.warp.colour.2 > pair.warp.colour.0);
        let chosen = PosteriseSettings {
            yarns: Some([Srgb(1, 2, 3), Srgb(9, 8, 7)]),
            ..settings
        };
        let pair = super::pair(&asked, &[0.5, 0.5], &chosen);
        assert_eq!(
            (pair.warp.colour, pair.weft.colour),
            (Srgb(1, 2, 3), Srgb(9, 8, 7))
        );
    }
}
