//! How much light each place of a crossing sends to the eye, by what stands around it.
//!
//! Comes in: a pair of yarns and their spacing, a light and the side that is looked at.
//! Goes out: for each of the 32 neighbourhoods of a crossing a small picture of the share
//! that warp and weft take of it and how brightly they are lit, from the laid-out yarns of
//! the catalogue's weaves alone: no voxels, no paths. Light is direct light on the relief,
//! hidden where a neighbour stands higher, and softened as fibres scatter it on. Brightness
//! is relative to the mean of the same neighbourhood under the default light, whose
//! colour [`super::expected`] knows.

use glam::{Vec2, Vec3};
use rayon::prelude::*;

use crate::exemplar::Pair;
use crate::render::{Environment, LightRig, Sky, luminance};
use crate::synthesis::Catalogue;
use crate::yarn::{Direction, WeaveGeometry, hash};

/// Texels along a crossing's side at the finest level.
pub const TEXELS: usize = 12;
/// Texels along a side, level by level.
const SIDES: [usize; 4] = [TEXELS, 6, 3, 1];
/// Neighbourhoods of a crossing.
const KEYS: usize = 32;
/// Directions in which the sky is sampled.
const SKY_SAMPLES: usize = 48;
/// Directions round a texel in which the horizon is searched.
const AZIMUTHS: usize = 8;
/// How far, in texels.
const REACH: i64 = TEXELS as i64;
/// Share of the light that has lost its direction by scattering among fibres.
const SOFTENED: f32 = 0.35;
/// How much darker a yarn is at the border of a crossing than in its middle, where light
/// also comes in from the sides.
const ROUNDED: f32 = 0.3;
/// Seed of the layout; each weave has its own.
const SEED: u64 = 2012;

/// What one place of a crossing sends to the eye.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Texel {
    /// Brightness of the warp seen here, times its share of the place.
    pub warp: f32,
    /// Brightness of the weft seen here, times its share of the place.
    pub weft: f32,
    /// Share of the place that is covered by either, 0..=1.
    pub cover: f32,
}

impl Texel {
    fn plus(self, other: Self, weight: f32) -> Self {
        Self {
            warp: self.warp + other.warp * weight,
            weft: self.weft + other.weft * weight,
            cover: self.cover + other.cover * weight,
        }
    }
}

/// Number of a crossing's neighbourhood: bit 0 = warp up here, then left, right, below and
/// above.
pub fn neighbourhood(here: bool, left: bool, right: bool, below: bool, above: bool) -> u8 {
    [here, left, right, below, above]
        .into_iter()
        .enumerate()
        .fold(0, |key, (bit, up)| key | u8::from(up) << bit)
}

/// The table of one pair of yarns.
#[derive(Debug, Clone, PartialEq)]
pub struct FaceTable {
    /// By level, neighbourhood and texel, pick by pick from the lower left.
    levels: [Vec<Texel>; 4],
}

/// A far light of the relief.
struct Lamp {
    /// Unit direction, z towards the eye's side.
    towards: Vec3,
    /// What a white diffuser that faces it would show.
    light: f32,
}

/// The yarns' upper surface over one repeat of a weave.
struct Relief {
    width: i64,
    height: i64,
    /// Size of a texel, mm.
    texel: Vec2,
    z: Vec<f32>,
    /// Whether warp or weft is seen; `None` through a gap.
    warp: Vec<Option<bool>>,
}

impl FaceTable {
    /// The table of a pair at a spacing of ends and picks (mm), seen from the face or the
    /// back. The rig is the one that lights the cloth in cloth space (for the back: turned
    /// over).
    pub fn new(
        catalogue: &Catalogue,
        pair: &Pair,
        pitch: Vec2,
        rig: &LightRig,
        back: bool,
    ) -> Self {
        let lamps = lamps(rig, back);
        let usual = LightRig::preset("day").unwrap_or_else(|_| rig.clone());
        let usual = lamps_of_usual(&usual);
        let sums: Vec<[Vec<Texel>; 2]> = (0..catalogue.exemplars())
            .into_par_iter()
            .map(|exemplar| {
                let weave = &catalogue.weaves()[exemplar];
                let seed = hash(SEED, exemplar as u64);
                let geometry = WeaveGeometry::new(weave, &pair.warp, &pair.weft, pitch, seed);
                let relief = Relief::of(&geometry, back);
                relief.by_neighbourhood(&geometry, [&lamps, &usual])
            })
            .collect();
        let mut lit = vec![Texel::default(); KEYS * TEXELS * TEXELS];
        let mut usually = lit.clone();
        let mut counts = vec![0.0f32; KEYS];
        for (exemplar, [here, there]) in sums.iter().enumerate() {
            for (sum, texel) in lit.iter_mut().zip(here) {
                *sum = sum.plus(*texel, 1.0);
            }
            for (sum, texel) in usually.iter_mut().zip(there) {
                *sum = sum.plus(*texel, 1.0);
            }
            let weave = &catalogue.weaves()[exemplar];
            for pick in 0..i64::from(weave.picks()) {
                for end in 0..i64::from(weave.ends()) {
                    counts[usize::from(key_at(weave, end, pick))] += 1.0;
                }
            }
        }
        let size = TEXELS * TEXELS;
        for (key, count) in counts.into_iter().enumerate() {
            let range = key * size..(key + 1) * size;
            let usual = usually[range.clone()]
                .iter()
                .fold(Texel::default(), |sum, texel| sum.plus(*texel, 1.0));
            let brightness = (usual.warp + usual.weft) / usual.cover.max(1e-6);
            for texel in &mut lit[range] {
                let scale = 1.0 / (count * brightness).max(1e-6);
                texel.warp *= scale;
                texel.weft *= scale;
                texel.cover /= count.max(1.0);
            }
        }
        Self {
            levels: coarser(lit),
        }
    }

    /// The level whose texels are about as large as pixels, at this many pixels a crossing.
    pub fn level(pixels: f32) -> usize {
        let finest = SIDES.iter().rposition(|&side| side as f32 >= pixels);
        finest.unwrap_or(0)
    }

    /// What the place (`u`, `v`) of a crossing, each 0..1, sends to the eye.
    #[inline]
    pub fn at(&self, level: usize, key: u8, u: f32, v: f32) -> Texel {
        let level = level.min(SIDES.len() - 1);
        let side = SIDES[level];
        let [x, y] = [u, v].map(|place| ((place * side as f32) as usize).min(side - 1));
        self.levels[level][(usize::from(key & 31) * side + y) * side + x]
    }
}

/// The levels of a finest table.
fn coarser(finest: Vec<Texel>) -> [Vec<Texel>; 4] {
    let mean = |from: usize| {
        let side = SIDES[from];
        let step = TEXELS / side;
        let weight = 1.0 / (step * step) as f32;
        let mut level = vec![Texel::default(); KEYS * side * side];
        for (index, texel) in finest.iter().enumerate() {
            let (row, x) = (index / TEXELS, index % TEXELS);
            let (key, y) = (row / TEXELS, row % TEXELS);
            let cell = &mut level[(key * side + y / step) * side + x / step];
            *cell = cell.plus(*texel, weight);
        }
        level
    };
    [mean(0), mean(1), mean(2), mean(3)]
}

fn key_at(weave: &crate::design::WeavePattern, end: i64, pick: i64) -> u8 {
    let up = |end, pick| weave.get_wrapped(end, pick);
    neighbourhood(
        up(end, pick),
        up(end - 1, pick),
        up(end + 1, pick),
        up(end, pick - 1),
        up(end, pick + 1),
    )
}

/// The lights of a rig as far lamps, z towards the side that is looked at.
fn lamps(rig: &LightRig, back: bool) -> Vec<Lamp> {
    let side = if back { -1.0 } else { 1.0 };
    let seen = |towards: Vec3| Vec3::new(towards.x, towards.y, side * towards.z);
    let mut lamps: Vec<Lamp> = (rig.suns.iter())
        .map(|sun| Lamp {
            towards: seen(sun.towards),
            light: luminance(sun.irradiance) / std::f32::consts::PI,
        })
        .collect();
    let turn = if rig.is_turned_over() { -1.0 } else { 1.0 };
    match &rig.sky {
        Sky::Dark => {}
        Sky::Dome(dome) => {
            for towards in hemisphere() {
                let from = Vec3::new(turn * towards.x, towards.y, turn * side * towards.z);
                lamps.push(Lamp {
                    towards,
                    light: luminance(dome.radiance(from)) * 2.0 / SKY_SAMPLES as f32,
                });
            }
        }
        Sky::Image(image) => {
            for k in 0..SKY_SAMPLES {
                let u = [place(k, 0.754_877_7), place(k, 0.569_840_3)];
                if let Some(sample) = image.sample(u) {
                    let from = sample.direction;
                    let towards = seen(Vec3::new(turn * from.x, from.y, turn * from.z));
                    let share = std::f32::consts::PI * SKY_SAMPLES as f32 * sample.density;
                    lamps.push(Lamp {
                        towards,
                        light: luminance(sample.radiance) / share,
                    });
                }
            }
        }
    }
    lamps.retain(|lamp| lamp.light > 0.0 && lamp.light.is_finite());
    lamps
}

/// The default light as lamps over the side that is looked at.
fn lamps_of_usual(rig: &LightRig) -> Vec<Lamp> {
    lamps(rig, false)
}

/// The fraction of k times an irrational number: evenly spread places.
fn place(k: usize, step: f32) -> f32 {
    ((k as f32 + 0.5) * step).fract()
}

/// Directions of equal solid angle over the upper half.
fn hemisphere() -> impl Iterator<Item = Vec3> {
    (0..SKY_SAMPLES).map(|k| {
        let z = (k as f32 + 0.5) / SKY_SAMPLES as f32;
        let (sine, cosine) = (k as f32 * 2.399_963_2).sin_cos();
        let flat = (1.0 - z * z).sqrt();
        Vec3::new(flat * cosine, flat * sine, z)
    })
}

impl Relief {
    fn of(weave: &WeaveGeometry, back: bool) -> Self {
        let (ends, picks) = (weave.warp.len() as i64, weave.weft.len() as i64);
        let (width, height) = (ends * TEXELS as i64, picks * TEXELS as i64);
        let texel = weave.pitch / TEXELS as f32;
        let side = if back { -1.0 } else { 1.0 };
        let mut z = Vec::with_capacity((width * height) as usize);
        let mut warp = Vec::with_capacity(z.capacity());
        for row in 0..height {
            for column in 0..width {
                let place = Vec2::new(column as f32 + 0.5, row as f32 + 0.5) * texel;
                let (end, pick) = (column / TEXELS as i64, row / TEXELS as i64);
                let mut top: Option<(f32, bool)> = None;
                for beside in -1..=1 {
                    for (direction, thread, threads, along, across, pitch) in [
                        (
                            Direction::Warp,
                            end + beside,
                            ends,
                            place.y,
                            place.x,
                            weave.pitch.x,
                        ),
                        (
                            Direction::Weft,
                            pick + beside,
                            picks,
                            place.x,
                            place.y,
                            weave.pitch.y,
                        ),
                    ] {
                        let index = thread.rem_euclid(threads);
                        let across = across - (thread - index) as f32 * pitch;
                        let surface =
                            weave.surface(direction, index as usize, along, across, !back);
                        if let Some(z) = surface.map(|z| side * z)
                            && top.is_none_or(|(highest, _)| z > highest)
                        {
                            top = Some((z, direction == Direction::Warp));
                        }
                    }
                }
                z.push(top.map_or(f32::NAN, |(z, _)| z));
                warp.push(top.map(|(_, warp)| warp));
            }
        }
        let floor = z.iter().copied().filter(|z| z.is_finite());
        let floor = floor.fold(0.0f32, f32::min);
        for z in &mut z {
            if z.is_nan() {
                *z = floor;
            }
        }
        Self {
            width,
            height,
            texel,
            z,
            warp,
        }
    }

    fn index(&self, column: i64, row: i64) -> usize {
        (row.rem_euclid(self.height) * self.width + column.rem_euclid(self.width)) as usize
    }

    fn z(&self, column: i64, row: i64) -> f32 {
        self.z[self.index(column, row)]
    }

    /// Brightness of a texel under each set of lamps.
    fn brightness<const N: usize>(&self, column: i64, row: i64, lamps: [&[Lamp]; N]) -> [f32; N] {
        let here = self.z(column, row);
        let slope = Vec2::new(
            self.z(column + 1, row) - self.z(column - 1, row),
            self.z(column, row + 1) - self.z(column, row - 1),
        ) / (2.0 * self.texel);
        let normal = Vec3::new(-slope.x, -slope.y, 1.0).normalize_or(Vec3::Z);
        let horizon: [f32; AZIMUTHS] = std::array::from_fn(|azimuth| {
            let (sine, cosine) =
                (azimuth as f32 * std::f32::consts::TAU / AZIMUTHS as f32).sin_cos();
            (1..=REACH)
                .map(|step| {
                    let away = Vec2::new(cosine, sine) * step as f32;
                    let (dx, dy) = (away.x.round(), away.y.round());
                    let rise = self.z(column + dx as i64, row + dy as i64) - here;
                    rise / (Vec2::new(dx, dy) * self.texel).length()
                })
                .fold(0.0, f32::max)
        });
        lamps.map(|lamps| {
            let mut sum = 0.0;
            for lamp in lamps {
                let flat = lamp.towards.truncate().length();
                let azimuth = lamp.towards.y.atan2(lamp.towards.x) / std::f32::consts::TAU;
                let sector = (azimuth * AZIMUTHS as f32)
                    .round()
                    .rem_euclid(AZIMUTHS as f32);
                let above = lamp.towards.z / flat.max(1e-4);
                // Fibres let light through: the shadow's edge is soft.
                let lit =
                    (1.0 + 2.0 * (above - horizon[sector as usize % AZIMUTHS])).clamp(0.0, 1.0);
                let facing = normal.dot(lamp.towards).max(0.0);
                let even = lamp.towards.z.max(0.0);
                sum += lamp.light * (lit * facing * (1.0 - SOFTENED) + even * SOFTENED);
            }
            sum
        })
    }

    /// Sums of the texels of all crossings by neighbourhood, for each set of lamps.
    fn by_neighbourhood(&self, weave: &WeaveGeometry, lamps: [&[Lamp]; 2]) -> [Vec<Texel>; 2] {
        let blank = vec![Texel::default(); KEYS * TEXELS * TEXELS];
        let mut sums = [blank.clone(), blank];
        let side = TEXELS as i64;
        for row in 0..self.height {
            for column in 0..self.width {
                let Some(warp) = self.warp[self.index(column, row)] else {
                    continue;
                };
                let key = key_at(&weave.pattern, column / side, row / side);
                let place = (usize::from(key) * TEXELS + (row % side) as usize) * TEXELS
                    + (column % side) as usize;
                let rounded = |place: i64| {
                    let off = (2 * place + 1 - side) as f32 / side as f32;
                    1.0 - ROUNDED * off * off
                };
                let rounded = rounded(column % side) * rounded(row % side);
                let bright = self
                    .brightness(column, row, lamps)
                    .map(|light| light * rounded);
                for (sum, light) in sums.iter_mut().zip(bright) {
                    let texel = Texel {
                        warp: if warp { light } else { 0.0 },
                        weft: if warp { 0.0 } else { light },
                        cover: 1.0,
                    };
                    sum[place] = sum[place].plus(texel, 1.0);
                }
            }
        }
        sums
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;
    use crate::design::Family;
    use crate::yarn::YarnRecipe;

    fn table(light: &str, back: bool) -> FaceTable {
        let recipe = YarnRecipe::family(Family::Cotton, 0.3);
        let pair = Pair {
            warp: recipe.clone(),
            weft: recipe,
        };
        let mut rig = LightRig::preset(light).unwrap();
        if back {
            rig = rig.turned_over();
        }
        FaceTable::new(&Catalogue::standard(), &pair, Vec2::splat(0.36), &rig, back)
    }

    #[test]
    fn the_middle_of_a_crossing_shows_the_yarn_on_top() {
        for back in [false, true] {
            let table = table("day", back);
            for key in 0..32u8 {
                let texel = table.at(0, key, 0.5, 0.5);
                let warp_seen = (key & 1 == 1) != back;
                assert_eq!(
                    texel.warp > texel.weft,
                    warp_seen,
                    "{key} {back}: {texel:?}"
                );
                assert!(texel.cover > 0.9, "{key}");
            }
        }
    }

    #[test]
    fn the_usual_light_is_bright_as_expected_and_raking_light_makes_relief() {
        let contrast = |table: &FaceTable| {
            let row = (0..TEXELS).map(|x| table.at(0, 1, (x as f32 + 0.5) / TEXELS as f32, 0.5));
            let lights: Vec<f32> = row.map(|texel| texel.warp).collect();
            lights.iter().copied().fold(0.0, f32::max) - lights[TEXELS / 4]
        };
        let (day, raking) = (table("day", false), table("raking-left", false));
        for key in 0..32u8 {
            let whole = day.at(3, key, 0.5, 0.5);
            assert!(
                (whole.warp + whole.weft - whole.cover).abs() < 1e-3,
                "{key}"
            );
        }
        assert!((contrast(&raking) - contrast(&day)).abs() > 0.02);
    }

    #[test]
    fn a_light_from_the_left_lights_left_slopes() {
        let table = table("raking-left", false);
        // Warp up between wefts: the end is a ridge from below to above.
        let key = neighbourhood(true, false, false, true, true);
        let (left, right) = (table.at(0, key, 0.2, 0.5), table.at(0, key, 0.8, 0.5));
        assert!(
            left.warp + left.weft > right.warp + right.weft,
            "{left:?} {right:?}"
        );
    }
}
