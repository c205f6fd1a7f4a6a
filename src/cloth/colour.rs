//! The colour a designer picks is the colour the woven cloth shows.
//!
//! A thick cloth of single-scattering albedo ω reflects R(ω) = Σ pₙ ωⁿ, where pₙ is the
//! light that was scattered n times; one run of the tracer gives all pₙ at once. The
//! curves are measured per family and roughness on plain weave, in a pile of four layers,
//! lit at 45° from all round and seen at 0°, relative to a white diffuser, and kept in
//! `presets/reflectance.ron`. Inverting them turns a colour into an albedo.

use std::sync::OnceLock;

use glam::{Vec2, Vec3};
use serde::{Deserialize, Serialize};

use super::build::ClothVolume;
use crate::design::{Family, Positions, Yarn};
use crate::job::{Cancelled, Job};
use crate::random::Random;
use crate::render::path::{ByOrder, Path, Plane};
use crate::render::{Counters, RenderSettings, Stack};
use crate::scene::{Dark, Ray, Sun};

/// Nodes of a stored curve, equally spaced in s = √(1−ω) from 0 to 1: R is smooth in s.
pub const NODES: usize = 25;
/// Orders of scattering that a measurement keeps.
const ORDERS: usize = 2048;
/// Directions of the light round the cloth.
const AZIMUTHS: usize = 8;
/// Starts of paths along a side of the square that one task follows.
const ROW: u32 = 8;
/// Paths that one task follows.
const BATCH: u32 = ROW * ROW;
/// Light below which shadow rays play roulette: about one of the lamps is asked at each
/// scattering, and those that a fibre mirrors always.
const SHADOW_ROULETTE: f32 = 0.3;

/// Reflectance of thick plain-woven cloth against single-scattering albedo.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ReflectanceCurve {
    /// The yarns' family.
    pub family: Family,
    /// SGGX roughness α of the fibres.
    pub alpha: f32,
    /// R at s = √(1−ω) = k/24, k = 0..24: falling.
    pub reflectance: Vec<f32>,
}

impl ReflectanceCurve {
    /// R(ω). The domain is 0..=1.
    pub fn reflectance(&self, albedo: f32) -> f32 {
        let s = (1.0 - albedo.clamp(0.0, 1.0)).sqrt() * (NODES - 1) as f32;
        let node = (s as usize).min(NODES - 2);
        let (a, b) = (self.reflectance[node], self.reflectance[node + 1]);
        a + (b - a) * (s - node as f32)
    }

    /// The ω that gives a reflectance, held in 0..=1 where no ω does.
    pub fn albedo(&self, reflectance: f32) -> f32 {
        let last = NODES - 1;
        if reflectance.is_nan() || reflectance <= self.reflectance[last] {
            return 0.0;
        }
        if reflectance >= self.reflectance[0] {
            return 1.0;
        }
        // The curve falls with s: find the nodes that enclose the reflectance.
        let above = self
            .reflectance
            .partition_point(|&r| r > reflectance)
            .clamp(1, last);
        let (a, b) = (self.reflectance[above - 1], self.reflectance[above]);
        let s = (above as f32 - 1.0 + (a - reflectance) / (a - b).max(1e-9)) / last as f32;
        (1.0 - s * s).clamp(0.0, 1.0)
    }

    /// Reflectances that some albedo between `surface_share` and 1 gives.
    pub fn range(&self, surface_share: f32) -> (f32, f32) {
        (self.reflectance(surface_share), self.reflectance[0])
    }

    fn mixed(a: &Self, b: &Self, t: f32) -> Self {
        let reflectance = a
            .reflectance
            .iter()
            .zip(&b.reflectance)
            .map(|(a, b)| a + (b - a) * t)
            .collect();
        Self {
            family: a.family,
            alpha: a.alpha + (b.alpha - a.alpha) * t,
            reflectance,
        }
    }
}

/// A measured curve and how far noise may have moved it.
#[derive(Debug, Clone, PartialEq)]
pub struct Measured {
    /// The curve.
    pub curve: ReflectanceCurve,
    /// Standard error of each of its nodes. The nodes share their paths, so they err
    /// together and the curve stays smooth.
    pub standard_error: Vec<f32>,
}

/// Measures the shares pₙ of light scattered n times and makes the curve of them.
///
/// `cloth` should be plain weave of one yarn; its own colours do not matter. All orders
/// come from the same `paths`, none of them negative: the curve cannot but fall with s.
///
/// # Errors
/// [`Cancelled`] when the job was.
pub fn measure(
    cloth: &ClothVolume,
    family: Family,
    alpha: f32,
    layers: u32,
    paths: u32,
    job: &Job,
) -> Result<Measured, Cancelled> {
    use rayon::prelude::*;
    let slide = RenderSettings::default().backing_slide_mm;
    let stack = Stack::new(cloth, layers, slide.into());
    let suns = lamps();
    let top = cloth.height_range().1;
    let path = path_to(&suns, &stack, ORDERS as u32, SHADOW_ROULETTE);
    // Each batch gives its own curve; their mean is the curve, their spread its error.
    let batches: Vec<[f64; NODES]> = (0..paths.div_ceil(BATCH).max(2))
        .into_par_iter()
        .map(|batch| {
            job.check()?;
            let mut orders = ByOrder(vec![0.0; ORDERS + 1]);
            let mut counters = Counters::default();
            for index in 0..BATCH {
                let mut random = Random::new(45, u64::from(batch), u64::from(index));
                let ray = first_ray(cloth, top, ROW, index, Vec3::NEG_Z, &mut random);
                path.trace(ray, &mut orders, &mut random, &mut counters);
            }
            Ok(nodes_of(&orders.0).map(|sum| sum / f64::from(BATCH)))
        })
        .collect::<Result<_, Cancelled>>()?;
    let n = batches.len() as f64;
    let mut reflectance = Vec::with_capacity(NODES);
    let mut standard_error = Vec::with_capacity(NODES);
    for node in 0..NODES {
        let mean = batches.iter().map(|batch| batch[node]).sum::<f64>() / n;
        let squares: f64 = (batches.iter())
            .map(|batch| (batch[node] - mean).powi(2))
            .sum();
        reflectance.push(mean as f32);
        standard_error.push((squares / (n * (n - 1.0))).sqrt() as f32);
    }
    Ok(Measured {
        curve: ReflectanceCurve {
            family,
            alpha,
            reflectance,
        },
        standard_error,
    })
}

/// Σ pₙ ωⁿ at the nodes of a curve.
fn nodes_of(shares: &[f64]) -> [f64; NODES] {
    std::array::from_fn(|node| {
        let s = node as f64 / (NODES - 1) as f64;
        let albedo = 1.0 - s * s;
        // Horner's rule from the highest order.
        (shares.iter().rev()).fold(0.0, |sum, &share| sum * albedo + share)
    })
}

/// The lamps of the 45°/0° geometry; a white diffuser under them has radiance 1.
pub fn lamps() -> [Sun; AZIMUTHS] {
    use std::f32::consts::{FRAC_1_SQRT_2, PI, TAU};
    std::array::from_fn(|azimuth| {
        let (sine, cosine) = (TAU * (azimuth as f32 + 0.5) / AZIMUTHS as f32).sin_cos();
        Sun {
            towards: Vec3::new(cosine, sine, 1.0) * FRAC_1_SQRT_2,
            irradiance: Vec3::splat(PI / (FRAC_1_SQRT_2 * AZIMUTHS as f32)),
            angular_radius: 0.0,
        }
    })
}

/// Threads along a side of the patch that is measured, at least. Crossings of one kind are
/// not alike: of a satin in silk 24 × 24 of them let through an eighth less than 96 × 96.
const PATCH: u32 = 96;

/// A ray from over `top` (mm) onto a patch of cloth that is whole repeats. The rays of a
/// batch start in the cells of a square of `row` × `row`, each in its own.
pub(super) fn first_ray(
    cloth: &ClothVolume,
    top: f32,
    row: u32,
    index: u32,
    direction: Vec3,
    random: &mut Random,
) -> Ray {
    let side = |threads: &Positions| {
        let repeats = PATCH.div_ceil(threads.threads());
        threads.repeat_mm() as f32 * repeats as f32
    };
    let patch = Vec2::new(side(cloth.ends()), side(cloth.picks()));
    let cell = Vec2::new((index % row) as f32, (index / row) as f32);
    let place = (cell + Vec2::from(random.pair())) / row as f32;
    let above = (top + 1.0) / direction.z.abs().max(0.1);
    Ray {
        origin: (place * patch).extend(0.0) - direction * above,
        direction,
    }
}

/// A path of a measurement: lamps alone, nothing behind the cloth, no roulette.
pub(super) fn path_to<'a, S>(
    suns: &'a [Sun],
    scatterer: &'a S,
    max_order: u32,
    shadow_roulette: f32,
) -> Path<'a, S, Dark, true, false> {
    Path {
        scatterer,
        suns,
        environment: &Dark,
        turn: Vec3::ONE,
        plane: Plane {
            z: 0.0,
            facing: 1.0,
            albedo: 0.0,
        },
        max_order,
        roulette_order: u32::MAX,
        shadow_roulette,
        background: crate::render::Background::Transparent,
    }
}

/// The built-in curves.
pub fn curves() -> &'static [ReflectanceCurve] {
    static CURVES: OnceLock<Vec<ReflectanceCurve>> = OnceLock::new();
    CURVES.get_or_init(|| {
        let text = include_str!("../../presets/reflectance.ron");
        let curves: Vec<ReflectanceCurve> = ron::from_str(text).unwrap_or_default();
        curves
            .into_iter()
            .filter(|curve| curve.reflectance.len() == NODES)
            .collect()
    })
}

/// The curve of a family at a roughness, between the measured ones.
pub fn curve(family: Family, alpha: f32) -> Option<ReflectanceCurve> {
    let mut measured: Vec<&ReflectanceCurve> = curves()
        .iter()
        .filter(|curve| curve.family == family)
        .collect();
    measured.sort_by(|a, b| a.alpha.total_cmp(&b.alpha));
    let above = measured.partition_point(|curve| curve.alpha < alpha);
    match (
        above.checked_sub(1).and_then(|i| measured.get(i)),
        measured.get(above),
    ) {
        (Some(a), Some(b)) => Some(ReflectanceCurve::mixed(
            a,
            b,
            (alpha - a.alpha) / (b.alpha - a.alpha),
        )),
        (Some(end), None) | (None, Some(end)) => Some((*end).clone()),
        (None, None) => None,
    }
}

/// Single-scattering albedo of a yarn (linear RGB): a dyed share and the uncoloured
/// surface share F, so never below F.
pub fn albedo(yarn: &Yarn) -> Vec3 {
    let colour = yarn.colour.to_linear();
    let share = yarn.surface_share.clamp(0.0, 1.0);
    let Some(curve) = curve(yarn.family, yarn.alpha()) else {
        return colour.max(Vec3::splat(share));
    };
    Vec3::from_array(
        colour
            .to_array()
            .map(|reflectance| curve.albedo(reflectance).max(share)),
    )
}

/// How a single layer of cloth shows a yarn on top of another.
struct OneLayer {
    /// Light that a yarn of albedo 1 sends back, relative to a white diffuser.
    bright: f32,
    /// How much of it is lost as fibres absorb.
    absorbed: f32,
    /// Share of the scattering that happens in the yarn below.
    shared: f32,
    /// Light that the yarn below sends out past the one on top, where both are white.
    seen_past: f32,
}

/// Fits to this program's own pictures (2/2 twill and plain weave under the light "day",
/// reflectances 0.02 to 0.75 on each other); they leave a root mean square of 1.8 to 2.5 in
/// L* of the whole cloth.
fn one_layer(family: Family) -> OneLayer {
    let [bright, absorbed, shared, seen_past] = match family {
        Family::Cotton => [0.871, 4.99, 0.099, 0.0251],
        Family::Silk => [0.827, 5.07, 0.149, 0.0121],
        Family::Wool => [0.937, 5.29, 0.073, 0.0272],
        Family::Linen => [0.912, 4.43, 0.111, 0.0222],
    };
    OneLayer {
        bright,
        absorbed,
        shared,
        seen_past,
    }
}

/// The linear colours that the warp on top of the weft, and the weft on top of the warp,
/// show on average in a single layer of cloth.
///
/// A thin layer scatters light but a few times: it follows the fibres' albedo ω as
/// aω/(1 + b√(1−ω′)) (two streams, as in Hapke 1981) and not the thick cloth's R(ω). Of the
/// later scatterings some happen in the yarn below, so that ω′ is a mean of both, channel
/// by channel: white looks reddish where it lies on red.
pub fn colours_on_top(warp: &Yarn, weft: &Yarn) -> [Vec3; 2] {
    let albedos = [warp, weft].map(albedo);
    [(warp, 0, 1), (weft, 1, 0)].map(|(yarn, top, below)| {
        let layer = one_layer(yarn.family);
        let (top, below) = (albedos[top], albedos[below]);
        let lost = (Vec3::ONE - top.lerp(below, layer.shared)).max(Vec3::ZERO);
        let lost = lost.map(f32::sqrt);
        layer.bright * top / (Vec3::ONE + layer.absorbed * lost) + layer.seen_past * below * below
    })
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;
    use crate::render::sggx::ALPHA_FLOOR;

    #[test]
    fn curves_rise_with_albedo_and_invert() {
        assert!(!curves().is_empty());
        for curve in curves() {
            for pair in curve.reflectance.windows(2) {
                assert!(pair[0] > pair[1], "{:?} α {}", curve.family, curve.alpha);
            }
            for i in 1..50 {
                let albedo = i as f32 / 50.0;
                let back = curve.albedo(curve.reflectance(albedo));
                assert!((back - albedo).abs() < 1e-3, "{albedo} became {back}");
            }
            assert_eq!(curve.albedo(2.0), 1.0);
            assert_eq!(curve.albedo(-1.0), 0.0);
            assert_eq!(curve.albedo(f32::NAN), 0.0);
        }
    }

    #[test]
    fn every_family_is_measured_at_its_own_roughness_and_all_around_it() {
        for &family in Family::ALL {
            let alphas: Vec<f32> = (curves().iter())
                .filter(|curve| curve.family == family)
                .map(|curve| curve.alpha)
                .collect();
            let own = family.numbers().alpha;
            assert!(alphas.contains(&own), "{family:?} at {own}: {alphas:?}");
            assert!(alphas.contains(&ALPHA_FLOOR) && alphas.contains(&1.0));
            // Between two of them the curve lies between theirs.
            let (low, high) = (curve(family, own), curve(family, 1.0));
            let (low, high) = (low.unwrap(), high.unwrap());
            let middle = curve(family, 0.5 * (own + 1.0)).unwrap();
            assert!(middle.reflectance.len() == NODES && low != middle && middle != high);
        }
    }

    #[test]
    fn a_thin_layer_is_darker_on_a_dark_yarn_and_rises_with_the_colour() {
        let yarn = |grey| Yarn::new("y", Family::Cotton, crate::design::Srgb(grey, grey, grey));
        let (dark, light) = (yarn(30), yarn(230));
        let [alone, _] = colours_on_top(&light, &light);
        let [over, under] = colours_on_top(&light, &dark);
        assert!(over.cmplt(alone).all() && under.cmplt(over).all());
        let shown = |grey| colours_on_top(&yarn(grey), &yarn(grey))[0].x;
        // Black and white may lie beyond what the fibres reach; between them it rises.
        assert!((1..=25u8).all(|step| shown(step * 10) >= shown((step - 1) * 10)));
        assert!((6..=20u8).all(|step| shown(step * 10) > shown((step - 1) * 10)));
    }

    #[test]
    fn no_surface_share_or_colour_leads_out_of_the_albedos() {
        let mut yarn = Yarn::new("odd", Family::Wool, crate::design::Srgb(0, 255, 7));
        for share in [0.0, 0.05, 1.0, -3.0, 7.0, f32::INFINITY] {
            yarn.surface_share = share;
            let albedo = albedo(&yarn);
            assert!(albedo.min_element() >= share.clamp(0.0, 1.0));
            assert!(albedo.max_element() <= 1.0);
        }
    }
}
