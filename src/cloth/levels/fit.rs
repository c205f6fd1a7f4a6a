//! Measures what corrects a coarse level.
//!
//! A picture is linear in the factors of the gain's series. One run of the tracer over a
//! coarse cloth therefore gives what each term at each kind of place alone would show
//! under each lamp; [`super::solve`] finds the factors with which all of them come
//! nearest to level 0. Most of the noise is in light that was scattered once, whose paths
//! are short: for each long path a few short ones are followed as well.

use std::f32::consts::{PI, TAU};
use std::ops::Range;

use glam::Vec3;
use rayon::prelude::*;

use super::series::{KINDS, TERMS, kind, places, terms};
use crate::cloth::colour::{first_ray, path_to};
use crate::cloth::{ClothVolume, HairLayer};
use crate::job::{Cancelled, Job};
use crate::random::Random;
use crate::render::path::Tally;
use crate::render::{Arrival, Both, Counters, PLACE, RenderSettings, SECOND, Scatterer, Stack};
use crate::scene::{Ray, Sun};

/// Elevations of the lamps, degrees, and where each starts its ring of [`AZIMUTHS`], as a
/// share of a step: all round, straight across and along the yarns, where highlights are
/// (30°), and half-way between, where the usual sun is (45°).
pub(super) const RINGS: [(f32, f32); 10] = [
    (12.0, 0.03),
    (22.0, 0.23),
    (40.0, 0.43),
    (60.0, 0.63),
    (85.0, 0.83),
    (30.0, 0.0),
    (45.0, 0.5),
    (35.0, 0.67),
    (52.0, 0.36),
    (72.0, 0.2),
];
pub(super) const AZIMUTHS: usize = 4;
/// Lamps of a measurement.
pub const LAMPS: usize = RINGS.len() * AZIMUTHS;
/// Albedos of warp and weft for which light is summed: dark, pale, and either of them dark.
pub(super) const ALBEDOS: [[f32; 2]; 10] = [
    [0.5, 0.5],
    [0.9, 0.9],
    [0.98, 0.98],
    [0.998, 0.998],
    [0.4, 0.98],
    [0.98, 0.4],
    [0.8, 0.995],
    [0.995, 0.8],
    [0.25, 0.998],
    [0.998, 0.25],
];
/// Light is summed apart where the eye looks at the weft's and at the warp's side of the
/// weave: a design may show either alone.
pub(super) const SEEN: usize = 2;
/// What the second channel is multiplied with each time that the warp scatters a path. It
/// is so near 1 that the number of times can still be read from it after [`MOST_ORDERS`].
const MARK: f32 = 0.98;
/// Light of higher order is left out, from both sides of the comparison.
const MOST_ORDERS: u32 = 192;
/// Paths that follow light scattered once, for each that follows all.
const ONCE: u32 = 12;
/// Starts of paths along a side of a square that is followed at once.
const ROW: u32 = 16;
/// Tasks of a measurement: each follows every so many squares.
const TASKS: u32 = 16;
/// Light below which shadow rays play roulette.
const SHADOW_ROULETTE: f32 = 0.1;
/// Numbers of a lamp, a pair of albedos and a side of the weave: of the last yarn (warp,
/// weft), the kind of place and the order (once, more), by term; then light that comes from
/// hairs, which no gain changes, as a first term.
pub(super) const EACH: usize = (PLACES + 1) * TERMS;
/// Last yarns, kinds of place and orders.
pub(super) const PLACES: usize = 2 * KINDS * 2;
const NUMBERS: usize = LAMPS * ALBEDOS.len() * SEEN * EACH;

/// Mean light by lamp, pair of albedos, yarn on top (weft, warp), last yarn (warp, weft),
/// kind of place, order (once, more often) and term.
#[derive(Debug, Clone, PartialEq)]
pub struct Light(Vec<f64>);

/// Place of the terms of a last yarn, a kind of place and an order (0: once) among the
/// numbers of [`EACH`], in units of [`TERMS`].
const fn place_of(yarn: usize, kind: usize, order: usize) -> usize {
    (yarn * KINDS + kind) * 2 + order
}

/// The terms among the numbers of [`EACH`], each with its last yarn, kind of place and
/// order.
pub(super) fn by_place(numbers: &[f64]) -> impl Iterator<Item = ([usize; 3], &[f64])> {
    (numbers.chunks_exact(TERMS).take(PLACES).enumerate())
        .map(|(place, terms)| ([place / 2 / KINDS, place / 2 % KINDS, place % 2], terms))
}

impl Light {
    pub(super) fn dark() -> Self {
        Self(vec![0.0; NUMBERS])
    }

    /// All numbers, to keep them.
    pub fn values(&self) -> &[f64] {
        &self.0
    }

    /// Light from numbers that were kept; `None` when there are too few or too many.
    pub fn from_values(values: Vec<f64>) -> Option<Self> {
        (values.len() == NUMBERS).then_some(Self(values))
    }

    /// The mean of some lamps for a pair of albedos: its numbers where the weft is on top
    /// and where the warp is, see [`EACH`].
    pub(super) fn under(&self, lamps: Range<usize>, albedo: usize) -> [Vec<f64>; SEEN] {
        let share = 1.0 / lamps.len() as f64;
        std::array::from_fn(|side| {
            let mut mean = vec![0.0; EACH];
            for lamp in lamps.clone() {
                let first = ((lamp * ALBEDOS.len() + albedo) * SEEN + side) * EACH;
                for (sum, value) in mean.iter_mut().zip(&self.0[first..][..EACH]) {
                    *sum += share * value;
                }
            }
            mean
        })
    }
}

/// Sums by lamp, which it knows by the light's direction. A path's first channel is its
/// light, the second is marked by the warp.
struct Terms<'l> {
    suns: &'l [Sun],
    /// Yarns below are the warp's.
    warps: u32,
    /// Which side of the weave the path starts at: 1 where the warp is on top.
    seen: usize,
    sums: Light,
}

impl Tally for Terms<'_> {
    #[inline]
    fn albedo<S: Scatterer>(&self, _: &S, optics: u32) -> Vec3 {
        let warp = optics & !(PLACE | SECOND) < self.warps;
        Vec3::new(1.0, if warp { MARK } else { 1.0 }, 1.0)
    }

    fn add(&mut self, _: u32, _: Vec3) {}

    #[inline]
    fn add_from<S: Scatterer>(&mut self, _: &S, arrival: &Arrival, light: Vec3) {
        let Some(lamp) = (self.suns.iter()).position(|sun| sun.towards == arrival.to_light) else {
            return;
        };
        let kind = kind(arrival).min(KINDS - 1);
        let yarn = usize::from(arrival.optics & !PLACE >= self.warps);
        let (place, terms) = if arrival.optics & SECOND == 0 {
            let more = usize::from(arrival.order > 1);
            (place_of(yarn, kind, more), terms(arrival))
        } else {
            (
                PLACES,
                std::array::from_fn(|term| f32::from(u8::from(term == 0))),
            )
        };
        let first = place * TERMS;
        let share = if arrival.order > 1 {
            1.0
        } else {
            1.0 / ONCE as f32
        };
        let order = arrival.order as i32;
        let by_warp = ((light.y / light.x).ln() / MARK.ln()).round() as i32;
        let by_warp = by_warp.clamp(0, order);
        for (k, [warp, weft]) in ALBEDOS.iter().enumerate() {
            let light = light.x * share * warp.powi(by_warp) * weft.powi(order - by_warp);
            let side = (lamp * ALBEDOS.len() + k) * SEEN + self.seen;
            let sums = &mut self.sums.0[side * EACH + first..][..TERMS];
            for (sum, term) in sums.iter_mut().zip(terms) {
                *sum += f64::from(light * term);
            }
        }
    }
}

/// How the terms of the series go together in the light of a cloth: mean products of each
/// two, by last yarn (warp, weft), kind of place and order (once, more often).
#[derive(Debug, Clone, PartialEq)]
pub struct Products(Vec<f64>);

/// Products of the terms of one place.
const SQUARE: usize = TERMS * TERMS;
/// Directions that are tried of light from anywhere, at each block's lower and upper yarn.
const ANYWHERE: usize = 120;

/// Any direction.
fn direction(random: &mut Random) -> Vec3 {
    let (up, around) = (2.0 * random.uniform() - 1.0, TAU * random.uniform());
    let aside = (1.0 - up * up).max(0.0).sqrt();
    Vec3::new(aside * around.cos(), aside * around.sin(), up)
}

impl Products {
    /// Albedos of the cloths whose light they are the mean of.
    const OF: [f32; 3] = [0.5, 0.9, 0.995];

    fn none() -> Self {
        Self(vec![0.0; PLACES * SQUARE])
    }

    /// Of light from anywhere to anywhere at every kind of place, as no cloth shows all of it.
    pub(super) fn anywhere() -> Self {
        let mut mean = Self::none();
        let mut random = Random::new(14, 0, 0);
        let arrivals = 32 * 2 * ANYWHERE * 2 * 2;
        for optics in (0..32).flat_map(places) {
            for index in 0..ANYWHERE {
                let aside = TAU * random.uniform();
                let slope = 0.4 * (2.0 * random.uniform() - 1.0);
                let level = (1.0 - slope * slope).sqrt();
                let fibre = Vec3::new(level * aside.cos(), level * aside.sin(), slope);
                let light = direction(&mut random);
                let elsewhere = direction(&mut random);
                for more in [0, 1] {
                    let straight = more == 0 || index.is_multiple_of(2);
                    let arrival = Arrival {
                        order: [1, [2, 3, 6, 12, 40, 120][index % 6]][more],
                        mixed: more == 1 && index % 4 < 2,
                        optics,
                        fibre,
                        alpha: 0.2,
                        to_eye: if straight { Vec3::Z } else { elsewhere },
                        to_light: light.with_z(light.z.abs()),
                    };
                    for yarn in [0, 1] {
                        mean.add(yarn, &arrival, 1.0 / arrivals as f64);
                    }
                }
            }
        }
        mean
    }

    /// Adds so much of an arrival.
    #[inline]
    fn add(&mut self, yarn: usize, arrival: &Arrival, share: f64) {
        let (kind, terms) = (kind(arrival).min(KINDS - 1), terms(arrival));
        let first = place_of(yarn, kind, usize::from(arrival.order > 1)) * SQUARE;
        for (row, a) in self.0[first..][..SQUARE].chunks_exact_mut(TERMS).zip(terms) {
            for (sum, b) in row.iter_mut().zip(terms) {
                *sum += share * f64::from(a * b);
            }
        }
    }

    /// All numbers, to keep them.
    pub fn values(&self) -> &[f64] {
        &self.0
    }

    /// Products from numbers that were kept; `None` when there are too few or too many.
    pub fn from_values(values: Vec<f64>) -> Option<Self> {
        (values.len() == PLACES * SQUARE).then_some(Self(values))
    }

    /// The products of each two terms, row by row, each with their last yarn, kind of
    /// place and order.
    pub(super) fn by_place(&self) -> impl Iterator<Item = ([usize; 3], &[f64])> {
        (self.0.chunks_exact(SQUARE).enumerate())
            .map(|(place, square)| ([place / 2 / KINDS, place / 2 % KINDS, place % 2], square))
    }
}

/// Sums of products by albedo. All of a path's channels are its light in white cloth.
struct Squares {
    warps: u32,
    sums: [Products; Products::OF.len()],
}

impl Tally for Squares {
    #[inline]
    fn albedo<S: Scatterer>(&self, _: &S, _: u32) -> Vec3 {
        Vec3::ONE
    }

    fn add(&mut self, _: u32, _: Vec3) {}

    #[inline]
    fn add_from<S: Scatterer>(&mut self, _: &S, arrival: &Arrival, light: Vec3) {
        if arrival.optics & SECOND != 0 {
            return;
        }
        let yarn = usize::from(arrival.optics & !PLACE >= self.warps);
        for (sums, albedo) in self.sums.iter_mut().zip(Products::OF) {
            let light = light.x * albedo.powi(arrival.order as i32);
            sums.add(yarn, arrival, light.into());
        }
    }
}

/// Measures how the terms go together in the light of the cloth that [`measure`] measures.
///
/// # Errors
/// [`Cancelled`] when the job was.
pub fn products(
    cloth: &ClothVolume,
    warps: u32,
    paths: u32,
    job: &Job,
) -> Result<Products, Cancelled> {
    let slide = RenderSettings::default().backing_slide_mm;
    let stack = Stack::new(cloth, 1, slide.into());
    let suns = lamps();
    let path = path_to(&suns, &stack, MOST_ORDERS, SHADOW_ROULETTE * LAMPS as f32);
    let top = cloth.height_range().1;
    let none = || Squares {
        warps,
        sums: std::array::from_fn(|_| Products::none()),
    };
    let parts = squares(
        13,
        paths.div_ceil(ROW * ROW),
        none,
        job,
        |tally, [_, index], random| {
            let ray = first_ray(cloth, top, ROW, index, Vec3::NEG_Z, random);
            path.trace(ray, tally, random, &mut Counters::default());
        },
    )?;
    // Each albedo counts alike, however much light it shows.
    let mut mean = Products::none();
    for albedo in 0..Products::OF.len() {
        let sums = || parts.iter().map(|part| &part.sums[albedo].0);
        let light: f64 = (sums().flat_map(|sums| sums.iter().step_by(SQUARE))).sum();
        let share = 1.0 / (Products::OF.len() as f64 * light.max(f64::MIN_POSITIVE));
        for sums in sums() {
            for (mean, sum) in mean.0.iter_mut().zip(sums) {
                *mean += share * sum;
            }
        }
    }
    Ok(mean)
}

/// The lamps: a white diffuser under any one of them has radiance 1.
pub fn lamps() -> [Sun; LAMPS] {
    std::array::from_fn(|lamp| {
        let (elevation, start) = RINGS[lamp / AZIMUTHS];
        let elevation = elevation.to_radians();
        let part = start + (lamp % AZIMUTHS) as f32;
        let (sine, cosine) = (TAU * part / AZIMUTHS as f32).sin_cos();
        let (up, aside) = elevation.sin_cos();
        Sun {
            towards: Vec3::new(aside * cosine, aside * sine, up),
            irradiance: Vec3::splat(PI / up),
            angular_radius: 0.0,
        }
    })
}

/// Measures the light of a single layer of cloth with its hairs, seen from above, whose
/// yarns below `warps` are the warp's and whose others are the weft's. Its own colours do
/// not matter.
///
/// # Errors
/// [`Cancelled`] when the job was.
pub fn measure(
    cloth: &ClothVolume,
    hairs: Option<&HairLayer<'_>>,
    warps: u32,
    paths: u32,
    job: &Job,
) -> Result<Light, Cancelled> {
    match hairs {
        Some(hairs) => measure_all(cloth, &Both(cloth, hairs), warps, paths, job),
        None => measure_all(cloth, &cloth, warps, paths, job),
    }
}

/// Measures anything that `cloth` is a part of.
fn measure_all<S: Scatterer>(
    cloth: &ClothVolume,
    all: &S,
    warps: u32,
    paths: u32,
    job: &Job,
) -> Result<Light, Cancelled> {
    let slide = RenderSettings::default().backing_slide_mm;
    let stack = Stack::new(all, 1, slide.into());
    let suns = lamps();
    let roulette = SHADOW_ROULETTE * LAMPS as f32;
    let long = path_to(&suns, &stack, MOST_ORDERS, roulette);
    let short = path_to(&suns, &stack, 1, 0.3 * roulette);
    let top = all.bounds().max.z;
    let count = paths.div_ceil(ROW * ROW).max(2);
    let none = || Terms {
        suns: &suns,
        warps,
        seen: 0,
        sums: Light::dark(),
    };
    let parts = squares(11, count, none, job, |tally, [_, index], random| {
        for once in 0..ONCE {
            let path = if once == 0 { &long } else { &short };
            let ray = first_ray(cloth, top, ROW, index, Vec3::NEG_Z, random);
            tally.seen = usize::from(warp_on_top(cloth, &ray));
            path.trace(ray, tally, random, &mut Counters::default());
        }
    })?;
    let paths = f64::from(count * ROW * ROW);
    let mut mean = Light::dark();
    for part in &parts {
        for (sum, more) in mean.0.iter_mut().zip(&part.sums.0) {
            *sum += more / paths;
        }
    }
    Ok(mean)
}

/// Follows what starts in the cells of so many squares: `follow` gets a tally, the square
/// and the cell, and random numbers that hang on these two alone. Returns the tallies of
/// all tasks, in their order.
fn squares<T: Send>(
    seed: u64,
    count: u32,
    none: impl Fn() -> T + Sync,
    job: &Job,
    follow: impl Fn(&mut T, [u32; 2], &mut Random) + Sync,
) -> Result<Vec<T>, Cancelled> {
    let task = |task: u32| {
        let mut tally = none();
        for square in (task..count).step_by(TASKS as usize) {
            job.check()?;
            for index in 0..ROW * ROW {
                let mut random = Random::new(seed, u64::from(square), u64::from(index));
                follow(&mut tally, [square, index], &mut random);
            }
        }
        Ok(tally)
    };
    (0..TASKS).into_par_iter().map(task).collect()
}

/// Whether the warp is on top where a ray from straight above meets the cloth.
fn warp_on_top(cloth: &ClothVolume, ray: &Ray) -> bool {
    let (end, _) = cloth.ends().locate(f64::from(ray.origin.x));
    let (pick, _) = cloth.picks().locate(f64::from(ray.origin.y));
    cloth.warp_up(end, pick) == Some(true)
}

/// Mean transmittance of a cloth, straight on and at 45° from two sides.
///
/// # Errors
/// [`Cancelled`] when the job was.
pub fn transmittance(cloth: &ClothVolume, rays: u32, job: &Job) -> Result<f64, Cancelled> {
    let slant = std::f32::consts::FRAC_1_SQRT_2;
    let directions = [
        Vec3::NEG_Z,
        Vec3::new(slant, 0.0, -slant),
        Vec3::new(0.0, slant, -slant),
    ];
    let count = rays.div_ceil(ROW * ROW).max(1);
    let top = cloth.height_range().1;
    let follow = |sum: &mut f64, [square, index]: [u32; 2], random: &mut Random| {
        let direction = directions[(square as usize + index as usize) % 3];
        let ray = first_ray(cloth, top, ROW, index, direction, random);
        let mut counters = Counters::default();
        let share =
            Scatterer::transmittance(cloth, &ray, f32::INFINITY, 0.0, random, &mut counters);
        *sum += f64::from(share);
    };
    let sums = squares(12, count, || 0.0, job, follow)?;
    Ok(sums.iter().sum::<f64>() / f64::from(count * ROW * ROW))
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use std::sync::Arc;

    use glam::Vec2;

    use super::super::LevelCorrection;
    use super::super::gain::{Gain, first_factors};
    use super::super::series::OWN;
    use super::*;
    use crate::cloth::{self, ClothSettings, PreparedCloth, Region};
    use crate::exemplar::ExemplarStore;
    use crate::presets;

    /// The cloth of a preset at a level.
    fn prepared(name: &str, level: u32) -> PreparedCloth {
        let design = Arc::new(presets::design(name).unwrap().unwrap());
        let settings = ClothSettings {
            level,
            ..ClothSettings::default()
        };
        let repeat = Region {
            end: 0,
            pick: 0,
            ends: design.ends(),
            picks: design.picks(),
        };
        let (store, job) = (ExemplarStore::user(), Job::new());
        cloth::prepare(&design, &settings, &repeat.extent(), &store, &job).unwrap()
    }

    #[test]
    fn warp_and_weft_are_told_apart_in_light_scattered_by_both() {
        let prepared = prepared("linen-plain", 3);
        let of = |warps| measure(prepared.cloth(), None, warps, 512, &Job::new()).unwrap();
        // Light by pair of albedos, last yarn and order, mean of all lamps.
        let sums = |light: &Light| {
            let mut sums = vec![[[0.0; 2]; 2]; ALBEDOS.len()];
            for (albedo, sums) in sums.iter_mut().enumerate() {
                for each in light.under(0..LAMPS, albedo) {
                    for ([yarn, _, order], terms) in by_place(&each) {
                        sums[yarn][order] += terms[0];
                    }
                }
            }
            sums
        };
        let [none, both, all] = [0, 1, 2].map(|warps| sums(&of(warps)));
        // Pairs 2, 4 and 5: both pale, dark warp, dark weft.
        assert_eq!(none[2][1], none[4][1]);
        assert_eq!(all[2][0], all[5][0]);
        assert_eq!((none[2][0], all[2][1]), ([0.0; 2], [0.0; 2]));
        let near = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-3;
        for (dark, yarn) in [(4, 0), (5, 1)] {
            let [own, other] = [yarn, 1 - yarn].map(|yarn| (both[dark][yarn], both[2][yarn]));
            assert!(near(own.0[0], own.1[0] * 0.4 / 0.98), "{own:?}");
            assert!(near(other.0[0], other.1[0]), "{other:?}");
            // Light scattered more often was by both, more often by its last.
            assert!(own.0[1] < 0.4 * own.1[1], "{own:?}");
            assert!(
                (0.3..0.95).contains(&(other.0[1] / other.1[1])),
                "{other:?}"
            );
        }
        let [once, more] = [0, 1].map(|order| both[2][0][order] + both[2][1][order]);
        assert!((once / none[2][1][0] - 1.0).abs() < 0.03 && more > 0.0);
    }

    /// Light with the gain of a picture, and with the factors that a fit finds.
    struct Gained {
        warps: u32,
        gains: [Gain; 2],
        sums: [f64; 3],
    }

    impl Tally for Gained {
        fn albedo<S: Scatterer>(&self, _: &S, _: u32) -> Vec3 {
            Vec3::splat(0.5)
        }

        fn add(&mut self, _: u32, _: Vec3) {}

        fn add_from<S: Scatterer>(&mut self, cloth: &S, arrival: &Arrival, light: Vec3) {
            let yarn = usize::from(arrival.optics & !PLACE >= self.warps);
            let (kind, more) = (kind(arrival), usize::from(arrival.order > 1));
            let [common, own] = first_factors(kind, more);
            let factors = self.gains[yarn].factors();
            let fitted: f32 = (terms(arrival).iter().enumerate())
                .map(|(term, value)| {
                    let own = if term < OWN { factors[own + term] } else { 0.0 };
                    value * (factors[common + term] + own)
                })
                .sum();
            let light = f64::from(light.x);
            self.sums[0] += light;
            self.sums[1] += light * f64::from(cloth.gain(arrival));
            self.sums[2] += light * f64::from(1.0 + fitted);
        }
    }

    #[test]
    fn a_picture_shows_the_gain_that_was_fitted() {
        let prepared = prepared("silk-satin", 2);
        let cloth = prepared.cloth();
        let set = &cloth.sets()[0];
        let row = LevelCorrection::of(set.pair.warp.family, set).unwrap();
        let stack = Stack::new(cloth, 1, Vec2::ZERO);
        let suns = lamps();
        let top = cloth.height_range().1;
        for lamp in [25, 22] {
            let path = path_to(&suns[lamp..=lamp], &stack, 64, 0.0);
            let mut tally = Gained {
                warps: 1,
                gains: row.gains.clone(),
                sums: [0.0; 3],
            };
            for index in 0..5_000 {
                let mut random = Random::new(5, index, 0);
                let ray = first_ray(cloth, top, 1, 0, Vec3::NEG_Z, &mut random);
                path.trace(ray, &mut tally, &mut random, &mut Counters::default());
            }
            let [plain, shown, fitted] = tally.sums;
            // A gain that does something, and the same one.
            assert!((shown / plain - 1.0).abs() > 0.03, "{:?}", tally.sums);
            assert!((shown / fitted - 1.0).abs() < 5e-3, "{:?}", tally.sums);
        }
    }

    #[test]
    fn a_place_is_read_where_it_was_put() {
        let numbers: Vec<f64> = (0..EACH).map(|i| i as f64).collect();
        let mut all = 0;
        for ([yarn, kind, order], terms) in by_place(&numbers) {
            assert_eq!(terms[0], (place_of(yarn, kind, order) * TERMS) as f64);
            assert!(yarn < 2 && kind < KINDS && order < 2);
            all += terms.len();
        }
        assert_eq!(all, PLACES * TERMS);
    }

    #[test]
    fn lamps_stand_all_round() {
        let sum: Vec3 = lamps().iter().map(|sun| sun.towards).sum();
        assert!(sum.truncate().length() < 1e-3 * sum.z, "{sum}");
        assert!(
            lamps()
                .iter()
                .all(|sun| (sun.towards.length() - 1.0).abs() < 1e-5)
        );
    }
}
