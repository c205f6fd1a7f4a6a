//! How the yarns of a small weave lie: centre curves and flattened cross-sections.
//!
//! Every yarn is a table of sections along its length. Heights follow the weave's ups and
//! downs; floats bulge and spread; a float covers the tie beside it. Where a warp and a
//! weft would overlap in height, both give way to a common plane between them, so that
//! yarns never pass through each other.

use std::f32::consts::{PI, TAU};

use glam::{Vec2, Vec3};

use super::noise::{crossing_window, hash, signed};
use super::recipe::YarnRecipe;
use crate::design::{Direction, WeavePattern};

/// Sections stored per crossing.
const STATIONS: usize = 32;
/// Share of a yarn's thickness that contact may not take away.
const INCOMPRESSIBLE: f32 = 0.45;

/// Share of its room that a yarn loses where it dives from face to face.
const SQUEEZE: f32 = 0.13;

/// A yarn's cross-section at one place; lengths in mm.
#[derive(Debug, Clone, Copy, Default)]
struct Section {
    /// Centre across the yarn, in cloth coordinates.
    across: f32,
    /// Centre height over the cloth's mid plane.
    height: f32,
    /// Half-width on the lower-coordinate side.
    lower: f32,
    /// Half-width on the higher-coordinate side.
    upper: f32,
    /// Half-height.
    half_height: f32,
    /// Turns of the plies beyond the regular twist.
    phase: f32,
}

impl Section {
    fn lerp(a: &Self, b: &Self, t: f32) -> Self {
        let mix = |p: f32, q: f32| p + (q - p) * t;
        Self {
            across: mix(a.across, b.across),
            height: mix(a.height, b.height),
            lower: mix(a.lower, b.lower),
            upper: mix(a.upper, b.upper),
            half_height: mix(a.half_height, b.half_height),
            phase: mix(a.phase, b.phase),
        }
    }

    /// Height interval that the section covers `offset` mm from its centre.
    fn interval(&self, offset: f32) -> Option<(f32, f32)> {
        let u = offset / if offset < 0.0 { self.lower } else { self.upper };
        let chord = 1.0 - u * u;
        if !(chord > 0.0) {
            return None;
        }
        let half = self.half_height * chord.sqrt();
        Some((self.height - half, self.height + half))
    }
}

/// One yarn of a weave: sections along one repeat of the exemplar.
#[derive(Debug, Clone)]
pub struct YarnPath {
    sections: Vec<Section>,
    /// Length of the repeat, mm.
    pub length_mm: f32,
    /// Where the regular twist has phase 0, mm along the yarn.
    pub twist_origin_mm: f32,
}

impl YarnPath {
    fn at(&self, along: f32) -> Section {
        let count = self.sections.len();
        let position = (along / self.length_mm).rem_euclid(1.0) * count as f32;
        let index = (position as usize).min(count - 1);
        Section::lerp(
            &self.sections[index],
            &self.sections[(index + 1) % count],
            position - index as f32,
        )
    }

    /// Turns of the plies beyond the regular twist at a place (mm along the yarn).
    pub fn phase(&self, along: f32) -> f32 {
        self.at(along).phase
    }
}

/// The yarns of one exemplar weave, periodic on both axes.
#[derive(Clone)]
pub struct WeaveGeometry {
    /// The weave.
    pub pattern: WeavePattern,
    /// Spacing of ends (x) and picks (y), mm.
    pub pitch: Vec2,
    /// Ends, left to right.
    pub warp: Vec<YarnPath>,
    /// Picks, bottom to top.
    pub weft: Vec<YarnPath>,
}

/// What the layout of one direction's yarns needs to know.
struct Side<'a> {
    recipe: &'a YarnRecipe,
    /// Envelope radius, mm.
    radius: f32,
    /// Spacing of these yarns.
    pitch: f32,
    /// Spacing of the yarns they cross.
    step: f32,
    /// Height of a yarn's centre where it lies on top.
    crimp: f32,
    seed: u64,
}

/// Radius of the envelope of a yarn: plies leave grooves, so it is wider than the yarn.
pub(crate) fn envelope_radius(recipe: &YarnRecipe) -> f32 {
    recipe.diameter_mm * 0.5 * if recipe.plies > 1 { 1.12 } else { 1.03 }
}

impl Side<'_> {
    /// Half-width and half-height of a section, given its aspect and the widest it may be.
    fn half_sizes(&self, aspect: f32, widest: f32) -> (f32, f32) {
        let width = (self.radius * aspect.sqrt()).min(widest);
        // A yarn squeezed sideways grows taller and denser, but not without end.
        let height = (self.radius * self.radius / width).min(self.radius * 1.15);
        (width, height)
    }
}

impl WeaveGeometry {
    /// Lays out a weave of `warp` and `weft` yarns at a pitch in mm (x: ends, y: picks).
    pub fn new(
        pattern: &WeavePattern,
        warp: &YarnRecipe,
        weft: &YarnRecipe,
        pitch: Vec2,
        seed: u64,
    ) -> Self {
        let (ends, picks) = (pattern.ends() as usize, pattern.picks() as usize);
        let up = |end: i64, pick: i64| pattern.get_wrapped(end, pick);
        let side = |recipe, own: f32, step: f32, salt: u64| Side {
            recipe,
            radius: envelope_radius(recipe),
            pitch: own,
            step,
            crimp: 0.0,
            seed: hash(seed, salt),
        };
        let mut warps = side(warp, pitch.x, pitch.y, 1);
        let mut wefts = side(weft, pitch.y, pitch.x, 2);

        // Where they cross, the two half-heights share the way from mid plane to face. The
        // thicker yarn bends less; in a warp-faced weave the wefts run straighter.
        let stack = warps.half_sizes(warp.crossing_aspect, pitch.x * 0.5).1
            + wefts.half_sizes(weft.crossing_aspect, pitch.y * 0.5).1;
        let warp_up = (0..ends * picks)
            .filter(|i| pattern.get((i % ends) as u32, (i / ends) as u32))
            .count();
        let face = warp_up as f32 / (ends * picks) as f32 - 0.5;
        let share =
            (weft.diameter_mm / (warp.diameter_mm + weft.diameter_mm) + 0.4 * face).clamp(0.2, 0.8);
        warps.crimp = 0.92 * stack * share;
        wefts.crimp = 0.92 * stack * (1.0 - share);

        let lay = |side: &Side, count: usize, along: usize, on_top: &dyn Fn(i64, i64) -> bool| {
            let levels: Vec<Vec<f32>> = (0..count as i64)
                .map(|yarn| {
                    (0..along * STATIONS)
                        .map(|s| level(s, along, &|k| on_top(yarn, k)))
                        .collect()
                })
                .collect();
            (0..count)
                .map(|yarn| lay_yarn(side, yarn, along, &levels, &|k| on_top(yarn as i64, k)))
                .collect::<Vec<_>>()
        };
        Self {
            pattern: pattern.clone(),
            pitch,
            warp: lay(&warps, ends, picks, &|yarn, k| up(yarn, k)),
            weft: lay(&wefts, picks, ends, &|yarn, k| !up(k, yarn)),
        }
    }

    /// The yarns of one direction.
    pub fn yarns(&self, direction: Direction) -> &[YarnPath] {
        match direction {
            Direction::Warp => &self.warp,
            Direction::Weft => &self.weft,
        }
    }

    /// Lowest and highest point of any yarn, mm.
    pub fn height_range(&self) -> (f32, f32) {
        self.warp
            .iter()
            .chain(&self.weft)
            .flat_map(|yarn| &yarn.sections)
            .fold((0.0f32, 0.0f32), |(low, high), s| {
                (
                    low.min(s.height - s.half_height),
                    high.max(s.height + s.half_height),
                )
            })
    }

    /// Height of a yarn's upper or lower surface at a place of the cloth, mm: `along` the
    /// yarn and `across` it; `None` beside the yarn.
    pub fn surface(
        &self,
        direction: Direction,
        index: usize,
        along: f32,
        across: f32,
        upper: bool,
    ) -> Option<f32> {
        let section = self.yarns(direction)[index].at(along);
        let offset = across - section.across;
        let u = offset
            / if offset < 0.0 {
                section.lower
            } else {
                section.upper
            };
        let chord = 1.0 - u * u;
        if !(chord > 0.0) {
            return None;
        }
        let v = if upper { chord.sqrt() } else { -chord.sqrt() };
        Some(self.place(direction, index, along, u, v).z)
    }

    /// The point of a yarn's section at (`u`, `v`) in units of its half-width and
    /// half-height, `along` mm from the repeat's start; x and y are not wrapped.
    pub fn place(&self, direction: Direction, index: usize, along: f32, u: f32, v: f32) -> Vec3 {
        let yarn = &self.yarns(direction)[index];
        let section = yarn.at(along);
        let across = section.across
            + u * if u < 0.0 {
                section.lower
            } else {
                section.upper
            };
        let half = section.half_height * (1.0 - u * u).max(v * v).max(0.0).sqrt();
        let (mut low, mut high) = (section.height - half, section.height + half);
        let mut z = section.height + section.half_height * v;

        // Give way to each crossing yarn that covers this place.
        let crossed = match direction {
            Direction::Warp => &self.weft,
            Direction::Weft => &self.warp,
        };
        let step = yarn.length_mm / crossed.len() as f32;
        let cell = (along / step).floor();
        let neighbour = if along / step - cell < 0.5 {
            cell - 1.0
        } else {
            cell + 1.0
        };
        for position in [cell, neighbour] {
            let other = (position as i64).rem_euclid(crossed.len() as i64) as usize;
            let section = crossed[other].at(across);
            let centre = section.across + (position - other as f32) * step;
            let Some((other_low, other_high)) = section.interval(along - centre) else {
                continue;
            };
            let on_top = match direction {
                Direction::Warp => self.pattern.get(index as u32, other as u32),
                Direction::Weft => !self.pattern.get(other as u32, index as u32),
            };
            let (new_low, new_high) = if on_top {
                (give_way(low, high, other_low, other_high), high)
            } else {
                (low, -give_way(-high, -low, -other_high, -other_low))
            };
            if high > low {
                z = new_low + (z - low) * (new_high - new_low) / (high - low);
            }
            (low, high) = (new_low, new_high);
        }
        match direction {
            Direction::Warp => Vec3::new(across, along, z),
            Direction::Weft => Vec3::new(along, across, z),
        }
    }
}

/// New lower bound of the upper yarn `low..high` over the lower yarn.
fn give_way(low: f32, high: f32, other_low: f32, other_high: f32) -> f32 {
    if other_high <= low {
        return low;
    }
    // The common plane lies between both, nearer to the thinner one.
    let (own, other) = ((high - low).max(1e-6), (other_high - other_low).max(1e-6));
    let plane = (low * other + other_high * own) / (own + other);
    // Neither is crushed to nothing: what is left over is pushed out.
    let plane = plane
        .min(high - INCOMPRESSIBLE * own)
        .max(other_low + INCOMPRESSIBLE * other);
    plane.max(low)
}

/// +1 where the yarn lies on top, −1 where it lies below, eased between crossings.
fn level(station: usize, along: usize, on_top: &dyn Fn(i64) -> bool) -> f32 {
    let position = station as f32 / STATIONS as f32 - 0.5;
    let (first, fraction) = (position.floor() as i64, position - position.floor());
    let sign = |k: i64| {
        if on_top(k.rem_euclid(along as i64)) {
            1.0
        } else {
            -1.0
        }
    };
    let (a, b): (f32, f32) = (sign(first), sign(first + 1));
    if a == b {
        return a;
    }
    a + (b - a) * fraction * fraction * (3.0 - 2.0 * fraction)
}

/// How far into a float a station is: 0 at its ends, towards 1 in the middle of a long one.
fn float_share(station: usize, along: usize, on_top: &dyn Fn(i64) -> bool) -> f32 {
    let crossing = (station / STATIONS) as i64;
    let wrapped = |k: i64| on_top(k.rem_euclid(along as i64));
    let here = wrapped(crossing);
    let limit = along as i64;
    let before = (1..limit)
        .take_while(|d| wrapped(crossing - d) == here)
        .count() as i64;
    let after = (1..limit)
        .take_while(|d| wrapped(crossing + d) == here)
        .count() as i64;
    let length = (before + after + 1).min(limit) as f32;
    let place = (before as f32 + (station % STATIONS) as f32 / STATIONS as f32) / length;
    (PI * place.clamp(0.0, 1.0)).sin().powf(1.5) * (1.0 - 1.0 / length)
}

/// How near a dive is: 1 where the yarn changes faces, 0 from 0.8 of a crossing away.
fn dive_share(station: usize, along: usize, on_top: &dyn Fn(i64) -> bool) -> f32 {
    let crossing = (station / STATIONS) as i64;
    let within = (station % STATIONS) as f32 / STATIONS as f32;
    let wrapped = |k: i64| on_top(k.rem_euclid(along as i64));
    let reach = |distance: f32, a: i64, b: i64| {
        let dives = wrapped(a) != wrapped(b);
        if dives {
            (0.5 * PI * (distance / 0.8).min(1.0)).cos().powi(2)
        } else {
            0.0
        }
    };
    reach(within, crossing - 1, crossing).max(reach(1.0 - within, crossing, crossing + 1))
}

fn lay_yarn(
    side: &Side,
    yarn: usize,
    along: usize,
    levels: &[Vec<f32>],
    on_top: &dyn Fn(i64) -> bool,
) -> YarnPath {
    let count = levels.len();
    let recipe = side.recipe;
    let seed = hash(side.seed, yarn as u64);
    let own = &levels[yarn];
    let (before, after) = (
        &levels[(yarn + count - 1) % count],
        &levels[(yarn + 1) % count],
    );
    let sections = (0..along * STATIONS)
        .map(|station| {
            let crossing = (station / STATIONS) as u64;
            let window = crossing_window((station % STATIONS) as f32 / STATIONS as f32);
            let noise = |what: u64| window * signed(seed, crossing * 8 + what);

            let float = float_share(station, along, on_top);
            let aspect =
                recipe.crossing_aspect + (recipe.float_aspect - recipe.crossing_aspect) * float;
            // Between faces a yarn is squeezed by those that it dives between. A long float
            // spreads over the ties beside it.
            let squeeze = 1.0 - SQUEEZE * dive_share(station, along, on_top);
            let spread = 0.4 * (float - 0.5).max(0.0);
            let room = |other: f32| {
                let apart = 0.5 * (own[station] - other).abs();
                side.pitch * (0.515 + spread * apart * apart) * squeeze
            };
            let thickness = 1.0 + recipe.unevenness * 1.6 * noise(0);
            let (lower, low_height) = side.half_sizes(aspect, room(before[station]));
            let (upper, high_height) = side.half_sizes(aspect, room(after[station]));
            let bulge = recipe.float_bulge * side.radius * float * own[station].signum();
            Section {
                across: (yarn as f32 + 0.5) * side.pitch + side.pitch * 0.05 * noise(1),
                height: side.crimp * own[station] + bulge + side.radius * 0.08 * noise(2),
                lower: lower * (1.0 + 0.3 * (thickness - 1.0)),
                upper: upper * (1.0 + 0.3 * (thickness - 1.0)),
                half_height: 0.5 * (low_height + high_height) * thickness,
                phase: recipe.twist_unevenness * noise(3),
            }
        })
        .collect();

    // Twist is counted from where the yarn comes up, so that symmetric places of the weave
    // carry the same phase and blocks copied from them meet.
    let origin = (0..along as i64)
        .find(|&k| on_top(k) && !on_top((k - 1).rem_euclid(along as i64)))
        .unwrap_or(0);
    YarnPath {
        sections,
        length_mm: along as f32 * side.step,
        twist_origin_mm: origin as f32 * side.step,
    }
}

/// Phase (radians) of a helix of `turns_per_m` at `along`, with a whole number of
/// 1/`symmetry` turns on the yarn's repeat.
pub(crate) fn twist_angle(yarn: &YarnPath, turns_per_m: f32, symmetry: u32, along: f32) -> f32 {
    let quantum = 1.0 / symmetry.max(1) as f32;
    let turns = (turns_per_m * yarn.length_mm * 1e-3 / quantum).round() * quantum;
    TAU * turns * (along - yarn.twist_origin_mm) / yarn.length_mm
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::design::Family;

    fn twill() -> WeaveGeometry {
        let pattern = WeavePattern::from_fn(5, 5, |end, pick| (end + 5 - pick) % 5 < 3);
        let cotton = YarnRecipe::family(Family::Cotton, 0.3);
        WeaveGeometry::new(&pattern, &cotton, &cotton, Vec2::splat(0.4), 7)
    }

    #[test]
    fn the_yarn_on_top_is_the_pattern_s() {
        let weave = twill();
        for end in 0..5u32 {
            for pick in 0..5u32 {
                let warp = weave
                    .place(
                        Direction::Warp,
                        end as usize,
                        (pick as f32 + 0.5) * 0.4,
                        0.0,
                        0.0,
                    )
                    .z;
                let weft = weave
                    .place(
                        Direction::Weft,
                        pick as usize,
                        (end as f32 + 0.5) * 0.4,
                        0.0,
                        0.0,
                    )
                    .z;
                assert_eq!(
                    warp > weft,
                    weave.pattern.get(end, pick),
                    "end {end} pick {pick}: {warp} {weft}"
                );
            }
        }
    }

    /// Deepest penetration of warp into weft over a grid of places, mm.
    fn deepest_overlap(weave: &WeaveGeometry, judge: impl Fn(u32, u32) -> bool) -> f32 {
        let mut deepest = 0.0f32;
        for i in 0..200 {
            for j in 0..200 {
                let (x, y) = (
                    2.0 * (i as f32 + 0.5) / 200.0,
                    2.0 * (j as f32 + 0.5) / 200.0,
                );
                let (end, pick) = ((x / 0.4) as usize, (y / 0.4) as usize);
                let column = |direction, yarn: usize, along: f32, across: f32| {
                    let section = weave.yarns(direction)[yarn].at(along);
                    let offset = across - section.across;
                    let u = offset
                        / if offset < 0.0 {
                            section.lower
                        } else {
                            section.upper
                        };
                    (u.abs() < 1.0).then(|| {
                        let chord = (1.0 - u * u).sqrt();
                        [-chord, chord].map(|v| weave.place(direction, yarn, along, u, v).z)
                    })
                };
                let (Some(warp), Some(weft)) = (
                    column(Direction::Warp, end, y, x),
                    column(Direction::Weft, pick, x, y),
                ) else {
                    continue;
                };
                let overlap = if judge(end as u32, pick as u32) {
                    weft[1] - warp[0]
                } else {
                    warp[1] - weft[0]
                };
                deepest = deepest.max(overlap);
            }
        }
        deepest
    }

    #[test]
    fn yarns_do_not_pass_through_each_other() {
        let weave = twill();
        let deepest = deepest_overlap(&weave, |e, p| weave.pattern.get(e, p));
        assert!(deepest < 0.02, "{deepest} mm of overlap");
        // Control: judged by the opposite pattern, nearly everything overlaps.
        assert!(deepest_overlap(&weave, |e, p| !weave.pattern.get(e, p)) > 0.1);
    }

    #[test]
    fn the_repeat_closes() {
        let weave = twill();
        for direction in [Direction::Warp, Direction::Weft] {
            let (a, b) = (
                weave.place(direction, 2, 0.0, 0.4, 0.3),
                weave.place(direction, 2, 2.0, 0.4, 0.3),
            );
            assert!((a.z - b.z).abs() < 1e-4, "{a} {b}");
        }
    }
}
