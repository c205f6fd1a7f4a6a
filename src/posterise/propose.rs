//! First proposals: one dark warp, one light weft, and for every colour a weave of the
//! shadow series that shows its lightness.

use super::series::{DARKEST, LIGHTEST, shadow_weave};
use super::settings::PosteriseSettings;
use crate::cloth::expected::expected_colour;
use crate::design::{Design, Fill, Lab, Sett, Srgb, Yarn, YarnId, YarnMaps, delta_e_00, lab};

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
/// A black that dyers reach.
const BLACK: Srgb = Srgb(0x1c, 0x1b, 0x1d);
/// A white that bleaching reaches.
const WHITE: Srgb = Srgb(0xfd, 0xfc, 0xfd);
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

/// The colours that most of a half of the picture has, as they are and scaled in light, and
/// `usual` ones.
fn candidates(half: &[(Srgb, f64)], scales: [f32; 3], usual: &[Srgb]) -> Vec<Srgb> {
    let mut most = half.to_vec();
    most.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    let mut found = usual.to_vec();
    for (colour, _) in most.into_iter().take(TRIED) {
        let light = colour.to_linear();
        found.push(colour);
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

/// The dark and the light yarn with which the picture's colours, woven as [`weaves`] would
/// weave them, are expected to be least off; the warp is the dark one.
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
    let undyed = settings.family.numbers().undyed;
    let darks = candidates(dark, DARKER, &[BLACK]);
    let lights = candidates(light, LIGHTER, &[undyed, WHITE]);
    let wanted = Wanted::of(asked, coverage);
    let series = series(asked.len());
    let mut best = (f64::INFINITY, [BLACK, undyed]);
    for &warp in &darks {
        for &weft in &lights {
            let off = wanted.off(&series, &pair_in(settings, [warp, weft]));
            if off < best.0 {
                best = (off, [warp, weft]);
            }
        }
    }
    pair_in(settings, best.1)
}

/// The colours that are to be shown.
struct Wanted {
    colours: Vec<Lab>,
    coverage: Vec<f64>,
}

impl Wanted {
    fn of(asked: &[Srgb], coverage: &[f64]) -> Self {
        Self {
            colours: asked.iter().map(|colour| lab(colour.to_linear())).collect(),
            coverage: coverage.to_vec(),
        }
    }

    /// For each colour the place in `shown`, the colours of a series, of the one whose
    /// lightness is nearest, no two alike as long as there are enough.
    fn chosen(&self, shown: &[Lab]) -> Vec<usize> {
        let mut order: Vec<usize> = (0..shown.len()).collect();
        order.sort_by(|&a, &b| shown[a][0].total_cmp(&shown[b][0]).then(a.cmp(&b)));
        let levels: Vec<f64> = order.iter().map(|&at| shown[at][0]).collect();
        let wanted: Vec<(f64, f64)> = (self.colours.iter().zip(&self.coverage))
            .map(|(colour, coverage)| (colour[0], coverage.sqrt() + 1e-3))
            .collect();
        let chosen = rising(&wanted, &levels);
        chosen.into_iter().map(|level| order[level]).collect()
    }

    /// Mean and root mean square of ΔE₀₀ over the cloth, added: a pair that is better in
    /// both is never passed over, and none buys a small mean with one colour far off.
    fn off(&self, series: &[Fill], pair: &Pair) -> f64 {
        let shown = shown(series, pair);
        let (mut mean, mut squares, mut all) = (0.0, 0.0, 0.0);
        let parts = self.colours.iter().zip(&self.coverage);
        for ((&colour, &share), at) in parts.zip(self.chosen(&shown)) {
            let off = delta_e_00(colour, shown[at]);
            mean += share * off;
            squares += share * off * off;
            all += share;
        }
        (mean + (squares * all).sqrt()) / f64::max(all, 1e-12)
    }
}

/// The weaves that `colours` colours are chosen from: twice as many, so that lightness is
/// met well.
fn series(colours: usize) -> Vec<Fill> {
    let steps = (DARKEST - LIGHTEST) as usize;
    let step = [8, 4, 2]
        .into_iter()
        .find(|step| steps / step + 1 >= 2 * colours);
    (LIGHTEST..=DARKEST)
        .step_by(step.unwrap_or(1))
        .map(shadow_weave)
        .collect()
}

/// What each weave of a series is expected to show.
fn shown(series: &[Fill], pair: &Pair) -> Vec<Lab> {
    let colour = |fill: &Fill| lab(expected_colour(fill.pattern(), &pair.warp, &pair.weft));
    series.iter().map(colour).collect()
}

/// A weave for every colour that does not keep one: the weave of the series whose expected
/// lightness is nearest, no two colours alike as long as there are weaves enough.
pub(super) fn weaves(
    asked: &[Srgb],
    coverage: &[f64],
    kept: &[Option<usize>],
    pair: &Pair,
) -> Vec<Fill> {
    let series = series(asked.len());
    let free: Vec<usize> = (0..asked.len()).filter(|&at| kept[at].is_none()).collect();
    let of_free = |at: &usize| (asked[*at], coverage[*at]);
    let (colours, shares): (Vec<Srgb>, Vec<f64>) = free.iter().map(of_free).unzip();
    let chosen = Wanted::of(&colours, &shares).chosen(&shown(&series, pair));
    let mut weaves = vec![series[0].clone(); asked.len()];
    for (&at, weave) in free.iter().zip(chosen) {
        weaves[at] = series[weave].clone();
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

    /// Mean and root mean square of ΔE₀₀ of a picture woven of a pair.
    fn off(asked: &[Srgb], coverage: &[f64], pair: &Pair) -> [f64; 2] {
        let kept = vec![None; asked.len()];
        let woven = weaves(asked, coverage, &kept, pair);
        let each: Vec<f64> = (asked.iter().zip(shown(&woven, pair)))
            .map(|(colour, shown)| delta_e_00(lab(colour.to_linear()), shown))
            .collect();
        let sum = |of: &dyn Fn(f64) -> f64| -> f64 {
            each.iter()
                .zip(coverage)
                .map(|(&e, share)| share * of(e))
                .sum()
        };
        [sum(&|e| e), sum(&|e| e * e).sqrt()]
    }

    #[test]
    fn no_simple_pair_is_better_in_mean_and_in_the_worst_colours() {
        let settings = PosteriseSettings::default();
        let pictures: [&[Srgb]; 4] = [
            &[
                Srgb(20, 20, 200),
                Srgb(220, 20, 20),
                Srgb(30, 200, 30),
                Srgb(255, 255, 255),
            ],
            &[Srgb(90, 60, 30), Srgb(120, 130, 60), Srgb(220, 190, 150)],
            &[Srgb(0, 0, 0), Srgb(255, 255, 0)],
            &[
                Srgb(60, 60, 60),
                Srgb(110, 110, 115),
                Srgb(160, 160, 160),
                Srgb(210, 210, 210),
            ],
        ];
        for asked in pictures {
            let coverage = vec![1.0 / asked.len() as f64; asked.len()];
            let found = off(asked, &coverage, &pair(asked, &coverage, &settings));
            let (dark, light) = (asked[0], asked[asked.len() - 1]);
            for colours in [
                [BLACK, settings.family.numbers().undyed],
                [BLACK, WHITE],
                [dark, light],
                [BLACK, light],
                [dark, WHITE],
            ] {
                let simple = off(asked, &coverage, &pair_in(&settings, colours));
                let sum = |both: [f64; 2]| both[0] + both[1];
                assert!(
                    sum(found) <= sum(simple) + 1e-9,
                    "{found:?} {simple:?} {colours:?}"
                );
            }
        }
    }

    #[test]
    fn grain_does_not_change_the_pair() {
        let settings = PosteriseSettings::default();
        let picture = [
            Srgb(25, 25, 200),
            Srgb(220, 25, 25),
            Srgb(30, 200, 30),
            Srgb(254, 254, 254),
        ];
        let coverage = [0.25; 4];
        let lab_of = |yarn: &Yarn| lab(yarn.colour.to_linear());
        let calm = pair(&picture, &coverage, &settings);
        for grain in 0..16u8 {
            let shift = |value: u8, bit: u8| match grain >> bit & 1 {
                0 => value - 1,
                _ => value + 1,
            };
            let grainy = picture.map(|Srgb(r, g, b)| Srgb(shift(r, 0), shift(g, 1), shift(b, 2)));
            let found = pair(&grainy, &coverage, &settings);
            for (a, b) in [(&calm.warp, &found.warp), (&calm.weft, &found.weft)] {
                let apart = delta_e_00(lab_of(a), lab_of(b));
                assert!(apart < 3.0, "{grain}: {} {}", a.colour, b.colour);
            }
        }
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
