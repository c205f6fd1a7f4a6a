//! How much light each place of a crossing sends to the eye, by what stands around it.
//!
//! Comes in: a [`FaceRelief`] and a light. Goes out: for each of the 32 neighbourhoods of a
//! crossing a small picture of the share that warp and weft take of it and how brightly
//! they are lit. Light is direct light on the relief, hidden where a neighbour stands
//! higher, and softened as fibres scatter it on. Brightness and tint are relative to the
//! mean of the same neighbourhood under the default light, in which
//! [`super::colour::colours_on_top`] knows what yarns show.

use glam::Vec3;

use super::face_relief::{AZIMUTHS, FaceRelief, Spot, TEXELS};
use crate::scene::{Environment, LightRig, Pose, Sky, luminance};
use crate::synthesis::KEYS;

/// Texels along a side, level by level.
const SIDES: [usize; 4] = [TEXELS, 6, 3, 1];
/// Directions in which the sky is sampled.
const SKY_SAMPLES: usize = 48;
/// Share of the light that has lost its direction by scattering among fibres.
const SOFTENED: f32 = 0.35;

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

/// The table of one relief in one light.
#[derive(Debug, Clone, PartialEq)]
pub struct FaceTable {
    /// By level, neighbourhood and texel, pick by pick from the lower left.
    levels: [Vec<Texel>; 4],
    /// What the light's colour makes of colours.
    tint: Vec3,
}

impl FaceTable {
    /// The table of a relief. The rig is the one that lights the cloth in cloth space (for
    /// the back: turned over).
    pub fn new(relief: &FaceRelief, rig: &LightRig) -> Self {
        let mut usual = LightRig::preset("day").unwrap_or_else(|_| rig.clone());
        // The default light stays with the eye, whichever side that looks at.
        usual = usual.on(relief.pose);
        let lamps = [lamps(rig, relief.pose), lamps(&usual, relief.pose)];
        let blank = vec![Texel::default(); KEYS * TEXELS * TEXELS];
        let mut sums = [blank.clone(), blank];
        for spot in &relief.spots {
            for (sum, lamps) in sums.iter_mut().zip(&lamps) {
                let light = spot.rounded * brightness(spot, lamps);
                let texel = Texel {
                    warp: if spot.warp { light } else { 0.0 },
                    weft: if spot.warp { 0.0 } else { light },
                    cover: 1.0,
                };
                sum[spot.texel] = sum[spot.texel].plus(texel, 1.0);
            }
        }
        let [mut lit, usually] = sums;
        let size = TEXELS * TEXELS;
        for (key, count) in relief.counts.into_iter().enumerate() {
            let range = key * size..(key + 1) * size;
            let usual = usually[range.clone()]
                .iter()
                .fold(Texel::default(), |sum, texel| sum.plus(*texel, 1.0));
            let brightness = (usual.warp + usual.weft) / usual.cover.max(1e-6);
            let scale = 1.0 / (count * brightness).max(1e-6);
            for texel in &mut lit[range] {
                texel.warp *= scale;
                texel.weft *= scale;
                texel.cover /= count.max(1.0);
            }
        }
        Self {
            levels: [0, 1, 2, 3].map(|level| coarser(&lit, level)),
            tint: colour_of(&lamps[0]) / colour_of(&lamps[1]),
        }
    }

    /// Linear colours under this light, over those under the default light; brightness is
    /// the texels' matter.
    pub fn tint(&self) -> Vec3 {
        self.tint
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

    /// One of the finest texels, counted from the lower left.
    #[inline]
    pub fn texel(&self, key: u8, [x, y]: [usize; 2]) -> Texel {
        let last = TEXELS - 1;
        self.levels[0][(usize::from(key & 31) * TEXELS + y.min(last)) * TEXELS + x.min(last)]
    }

    /// The mean of a crossing.
    pub fn mean(&self, key: u8) -> Texel {
        self.at(SIDES.len() - 1, key, 0.0, 0.0)
    }

    /// Whether pixels are so much smaller than the finest texels, at this many a crossing,
    /// that texels would be seen as squares.
    pub fn shows_texels(pixels: f32) -> bool {
        pixels > 1.5 * TEXELS as f32
    }
}

/// A level of a finest table.
fn coarser(finest: &[Texel], level: usize) -> Vec<Texel> {
    let side = SIDES[level];
    let step = TEXELS / side;
    let weight = 1.0 / (step * step) as f32;
    let mut texels = vec![Texel::default(); KEYS * side * side];
    for (index, texel) in finest.iter().enumerate() {
        let (row, x) = (index / TEXELS, index % TEXELS);
        let (key, y) = (row / TEXELS, row % TEXELS);
        let cell = &mut texels[(key * side + y / step) * side + x / step];
        *cell = cell.plus(*texel, weight);
    }
    texels
}

/// A far light on the relief.
struct Lamp {
    /// Unit direction, z towards the eye's side.
    towards: Vec3,
    /// What a white diffuser that faces it would show, and its luminance.
    colour: Vec3,
    light: f32,
    /// Which of the horizon's directions it stands in, and the tangent of its height.
    sector: usize,
    above: f32,
}

impl Lamp {
    fn new(towards: Vec3, colour: Vec3) -> Self {
        let turns = towards.y.atan2(towards.x) / std::f32::consts::TAU;
        let sector = (turns * AZIMUTHS as f32).round() as i64;
        Self {
            towards,
            colour,
            light: luminance(colour),
            sector: sector.rem_euclid(AZIMUTHS as i64) as usize,
            above: towards.z / towards.truncate().length().max(1e-4),
        }
    }
}

/// The lights of a rig as far lamps, z towards the side that is looked at.
fn lamps(rig: &LightRig, pose: Pose) -> Vec<Lamp> {
    use std::f32::consts::PI;
    let side = pose.up();
    let turn = rig.sky_turn();
    let seen = |towards: Vec3| Vec3::new(towards.x, towards.y, side * towards.z);
    let mut lamps: Vec<Lamp> = (rig.suns.iter())
        .map(|sun| Lamp::new(seen(sun.towards), sun.irradiance / PI))
        .collect();
    match &rig.sky {
        Sky::Dark => {}
        Sky::Dome(dome) => lamps.extend(hemisphere().map(|towards| {
            let from = turn * seen(towards);
            Lamp::new(towards, dome.radiance(from) * 2.0 / SKY_SAMPLES as f32)
        })),
        Sky::Image(image) => lamps.extend((0..SKY_SAMPLES).filter_map(|k| {
            let sample = image.sample([place(k, 0.754_877_7), place(k, 0.569_840_3)])?;
            let towards = seen(turn * sample.direction);
            let share = PI * SKY_SAMPLES as f32 * sample.density;
            Some(Lamp::new(towards, sample.radiance / share))
        })),
    }
    lamps.retain(|lamp| lamp.light > 0.0 && lamp.light.is_finite());
    lamps
}

/// Colour of a white diffuser that lies flat, at a luminance of 1.
fn colour_of(lamps: &[Lamp]) -> Vec3 {
    let flat: Vec3 = (lamps.iter())
        .map(|lamp| lamp.colour * lamp.towards.z.max(0.0))
        .sum();
    let colour = flat / luminance(flat);
    if colour.is_finite() {
        colour.max(Vec3::splat(1e-3))
    } else {
        Vec3::ONE
    }
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

/// Light on a spot; a white diffuser that lies flat in the open has 1.
fn brightness(spot: &Spot, lamps: &[Lamp]) -> f32 {
    let mut sum = 0.0;
    for lamp in lamps {
        // Fibres let light through: the shadow's edge is soft.
        let lit = (1.0 + 2.0 * (lamp.above - spot.horizon[lamp.sector])).clamp(0.0, 1.0);
        let facing = spot.normal.dot(lamp.towards).max(0.0);
        let even = lamp.towards.z.max(0.0);
        sum += lamp.light * (lit * facing * (1.0 - SOFTENED) + even * SOFTENED);
    }
    sum
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;
    use crate::design::Family;
    use crate::exemplar::Pair;
    use crate::synthesis::{Catalogue, key_of};
    use crate::yarn::YarnRecipe;
    use glam::Vec2;

    fn pose(back: bool) -> Pose {
        Pose { back, ..Pose::FACE }
    }

    fn relief(back: bool) -> FaceRelief {
        let recipe = YarnRecipe::family(Family::Cotton, 0.3);
        let pair = Pair {
            warp: recipe.clone(),
            weft: recipe,
        };
        FaceRelief::new(&Catalogue::standard(), &pair, Vec2::splat(0.36), pose(back))
    }

    fn table(light: &str, back: bool) -> FaceTable {
        let rig = LightRig::preset(light).unwrap();
        FaceTable::new(&relief(back), &rig.on(pose(back)))
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
    fn the_usual_light_is_as_bright_as_expected_and_raking_light_is_not() {
        let (day, raking) = (table("day", false), table("raking-left", false));
        let off = |table: &FaceTable, key: u8| {
            let whole = table.at(3, key, 0.5, 0.5);
            (whole.warp + whole.weft - whole.cover).abs()
        };
        assert!((0..32).all(|key| off(&day, key) < 1e-3));
        assert!((0..32).any(|key| off(&raking, key) > 0.02));
        let unturned = FaceTable::new(&relief(true), &LightRig::preset("sun").unwrap());
        assert!((0..32).any(|key| off(&unturned, key) > 0.02));
        // Both sides look alike in the default light, which stays with the eye.
        assert!((0..32).all(|key| off(&table("day", true), key) < 1e-3));
    }

    #[test]
    fn a_coloured_light_tints_and_the_usual_one_does_not() {
        assert_eq!(table("day", false).tint(), Vec3::ONE);
        let mut rig = LightRig::preset("sun").unwrap();
        for sun in &mut rig.suns {
            sun.irradiance = Vec3::new(2.0, 1.0, 0.5);
        }
        rig.sky = Sky::Dark;
        let tint = FaceTable::new(&relief(false), &rig).tint();
        assert!(tint.x > tint.y && tint.y > tint.z, "{tint}");
        rig.suns.clear();
        assert_eq!(FaceTable::new(&relief(false), &rig).levels[3].len(), KEYS);
        assert!(FaceTable::new(&relief(false), &rig).tint().is_finite());
    }

    #[test]
    fn a_light_from_the_left_lights_left_slopes() {
        let table = table("raking-left", false);
        // Warp up between wefts: the end is a ridge from below to above.
        let key = key_of(true, [false, false, true, true]);
        let (left, right) = (table.at(0, key, 0.2, 0.5), table.at(0, key, 0.8, 0.5));
        assert!(
            left.warp + left.weft > right.warp + right.weft,
            "{left:?} {right:?}"
        );
    }
}
