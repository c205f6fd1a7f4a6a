//! The colour a designer asks for is the colour the woven cloth shows: twelve dyes in
//! plain weave of every family, lit at 45° from all round, seen at 0°, on an opaque pile.
//!
//! The pictures are made by the same tracer, settings and exemplars as any still; CIELAB
//! and ΔE₀₀, which judge them, have published tables of their own as oracles.

#![allow(clippy::unwrap_used, reason = "a test may fail")]

use std::f32::consts::{FRAC_1_SQRT_2, PI, TAU};
use std::fmt::Write;
use std::sync::{Arc, LazyLock};

use glam::{UVec3, Vec3};
use pickglass::cloth::{ClothSettings, ClothVolume, YarnClasses, colour};
use pickglass::design::{
    Design, Family, Filled, Srgb, Structure, Yarn, YarnId, YarnMaps, delta_e_00, lab, usual_sett,
};
use pickglass::exemplar::ExemplarStore;
use pickglass::job::Job;
use pickglass::render::{Backing, RenderSettings, Scatterer, render};
use pickglass::scene::{Bounds, LightRig, Sky, Sun, View};
use pickglass::synthesis::Catalogue;
use pickglass::volume::{DenseGrid, GridVoxel, Optics, Taps};

/// The dyes, as cloth merchants' cards print them.
const DYES: [(&str, Srgb); 12] = [
    ("white", Srgb(0xf2, 0xf0, 0xea)),
    ("black", Srgb(0x1c, 0x1b, 0x1d)),
    ("navy", Srgb(0x1f, 0x2a, 0x4d)),
    ("yellow", Srgb(0xe8, 0xc0, 0x2c)),
    ("red", Srgb(0xb3, 0x20, 0x2a)),
    ("orange", Srgb(0xdd, 0x6b, 0x20)),
    ("green", Srgb(0x2e, 0x7d, 0x4f)),
    ("sky", Srgb(0x7f, 0xb2, 0xdd)),
    ("purple", Srgb(0x5d, 0x3a, 0x7e)),
    ("brown", Srgb(0x5c, 0x3d, 0x2a)),
    ("beige", Srgb(0xd2, 0xbe, 0x9c)),
    ("mid-grey", Srgb(0x80, 0x80, 0x80)),
];
/// Pixels along a side of the film.
const SIDE: u32 = 16;
/// Crossings across the film.
const CROSSINGS: f32 = 24.0;
/// Samples a pixel of the pile, of the single layer and of the negative control.
const SPP: [u32; 3] = [28, 8, 2];
/// Mean ΔE₀₀ allowed within the gamut.
const ALLOWED: f64 = 3.0;

/// Eight lamps 45° above the cloth; a white diffuser under all of them has radiance 1.
fn lamps() -> LightRig {
    let suns = (0..8).map(|i| {
        let (sine, cosine) = (TAU * (i as f32 + 0.5) / 8.0).sin_cos();
        Sun {
            towards: Vec3::new(cosine, sine, 1.0) * FRAC_1_SQRT_2,
            irradiance: Vec3::splat(PI / (8.0 * FRAC_1_SQRT_2)),
            angular_radius: 0.0,
        }
    });
    LightRig::new("45/0", suns.collect(), Sky::Dark)
}

/// Mean linear colour of a film over `width_mm` of something, seen straight from above,
/// and the standard error of its luminance.
fn seen<S: Scatterer>(it: &S, width_mm: f32, backing: Backing, spp: u32) -> (Vec3, f64) {
    let camera = View::Face.camera(Vec3::ZERO, width_mm, SIDE, SIDE);
    let settings = RenderSettings {
        spp,
        backing,
        seed: 4500,
        ..RenderSettings::default()
    };
    let outcome = render(
        it,
        &camera,
        &lamps(),
        &settings,
        &Job::new(),
        &mut |_, _| {},
    )
    .unwrap();
    let pixels = outcome.film.pixels();
    let n = pixels.len() as f64;
    let mean = pixels
        .iter()
        .map(|pixel| pixel.mean().as_dvec3())
        .sum::<glam::DVec3>()
        / n;
    let variance = pixels.iter().map(|pixel| pixel.variance()).sum::<f64>() / (n * n);
    assert_eq!(outcome.counters.invalid_samples, 0);
    (mean.as_vec3(), variance.sqrt())
}

/// Plain weave of one yarn of a family, to be dyed.
struct Plain {
    yarn: Yarn,
    width_mm: f32,
    cloth: ClothVolume,
}

/// One of every family; the exemplars are built once for all tests.
static CLOTHS: LazyLock<Vec<Plain>> = LazyLock::new(|| {
    (Family::ALL.iter())
        .map(|&family| Plain::new(undyed(family)))
        .collect()
});

/// The usual yarn of a family.
fn undyed(family: Family) -> Yarn {
    Yarn::new("undyed", family, family.numbers().undyed)
}

impl Plain {
    fn new(yarn: Yarn) -> Self {
        let maps = YarnMaps::plain(YarnId(0), YarnId(0));
        let sett = usual_sett(std::slice::from_ref(&yarn), &maps);
        let width_mm = CROSSINGS * sett.end_pitch_mm();
        let weave = Structure::Weave(Filled::once("plain").unwrap());
        let design = Design::new("plain", weave, vec![yarn.clone()], maps, sett).unwrap();

        let job = Job::new();
        let catalogue = Arc::new(Catalogue::standard());
        let settings = ClothSettings::default();
        let (assignment, needed) =
            ClothVolume::assign(&design, &catalogue, &settings, &job).unwrap();
        let classes = YarnClasses::new(&design);
        let grid = ClothVolume::grid_for(&catalogue, &classes, &settings).unwrap();
        let sets = (classes.pairs.iter())
            .map(|pair| {
                ExemplarStore::none()
                    .get(&catalogue, pair, grid, &needed, &job)
                    .unwrap()
            })
            .collect();
        let albedo = design.yarns().iter().map(colour::albedo).collect();
        let cloth = ClothVolume::new(
            &design, catalogue, classes, assignment, sets, albedo, settings, &job,
        )
        .unwrap();
        Self {
            yarn,
            width_mm,
            cloth,
        }
    }

    /// Its yarn in another colour.
    fn dyed(&self, colour: Srgb) -> Yarn {
        Yarn {
            colour,
            ..self.yarn.clone()
        }
    }

    /// What the cloth shows in a single-scattering albedo.
    fn shown(&self, albedo: Vec3, backing: Backing, spp: u32) -> (Vec3, f64) {
        let mut cloth = self.cloth.clone();
        cloth.recolour(vec![albedo]);
        seen(&cloth, self.width_mm, backing, spp)
    }
}

/// Whether some albedo gives the colour: every channel within the family's curve.
fn in_gamut(yarn: &Yarn) -> bool {
    let curve = colour::curve(yarn.family, yarn.alpha()).unwrap();
    let (low, high) = curve.range(yarn.surface_share);
    let colour = yarn.colour.to_linear();
    colour.min_element() >= low && colour.max_element() <= high
}

fn mean(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |sum, value| sum + value) / values.len().max(1) as f64
}

#[test]
fn a_sheet_of_known_albedo_shows_it() {
    let air = Bounds {
        min: Vec3::new(-9.0, -9.0, 0.0),
        max: Vec3::new(9.0, 9.0, 1.0),
    };
    let optics = vec![Optics {
        albedo: Vec3::ONE,
        alpha: 1.0,
    }];
    let empty = |_| GridVoxel::EMPTY;
    let air = DenseGrid::from_fn(UVec3::ONE, air, optics, Taps::Nearest, empty).unwrap();
    let (white, _) = seen(&air, 0.5, Backing::White, 2);
    assert!((white - 0.95).abs().max_element() < 1e-4, "{white}");
}

#[test]
fn cloth_shows_the_colour_that_was_asked_for() {
    let mut report = String::new();
    let mut all = Vec::new();
    for plain in CLOTHS.iter() {
        let mut inside = Vec::new();
        let mut outside = Vec::new();
        let mut single = Vec::new();
        let name = plain.yarn.family.name();
        for (dye, asked) in DYES {
            let yarn = plain.dyed(asked);
            let albedo = colour::albedo(&yarn);
            let difference = |shown: Vec3| delta_e_00(lab(asked.to_linear()), lab(shown));
            let (shown, error) = plain.shown(albedo, Backing::Itself, SPP[0]);
            let (layer, _) = plain.shown(albedo, Backing::None, SPP[1]);
            let (pile, alone) = (difference(shown), difference(layer));
            let fits = in_gamut(&yarn);
            if fits { &mut inside } else { &mut outside }.push(pile);
            single.push(alone);
            let _ = writeln!(
                report,
                "{name:<7}{dye:<9} asked {asked} shown {} ΔE {pile:5.2}{} noise {:.1} %, single layer {} ΔE {alone:5.2}",
                Srgb::from_linear(shown),
                if fits { "         " } else { " (beyond)" },
                100.0 * error / f64::from(shown.max_element()),
                Srgb::from_linear(layer),
            );
        }
        let _ = writeln!(
            report,
            "{name}: mean ΔE00 {:.2} of {} in gamut, {:.2} of {} beyond; single layer {:.2}\n",
            mean(&inside),
            inside.len(),
            mean(&outside),
            outside.len(),
            mean(&single)
        );
        all.extend(inside);
    }
    let mean_all = mean(&all);
    println!(
        "{report}all families: mean ΔE00 {mean_all:.2} of {} in gamut",
        all.len()
    );
    assert!(
        all.len() >= 36,
        "only {} dyes are in gamut:\n{report}",
        all.len()
    );
    assert!(mean_all <= ALLOWED, "mean ΔE00 {mean_all:.2}:\n{report}");
}

/// The curves are measured on usual yarns at a few roughnesses, and hold for others.
#[test]
fn unusual_yarns_show_their_colour_too() {
    let glossy = |family, gloss| Yarn {
        gloss: Some(gloss),
        ..undyed(family)
    };
    let yarns = [
        undyed(Family::Cotton).with_tex(120.0),
        glossy(Family::Silk, 0.13),
        glossy(Family::Wool, 0.6),
        glossy(Family::Linen, 0.05),
    ];
    for yarn in yarns {
        let plain = Plain::new(yarn);
        let differences = ["red", "sky", "brown", "mid-grey"].map(|name| {
            let asked = DYES.iter().find(|dye| dye.0 == name).unwrap().1;
            let albedo = colour::albedo(&plain.dyed(asked));
            let (shown, _) = plain.shown(albedo, Backing::Itself, SPP[1]);
            delta_e_00(lab(asked.to_linear()), lab(shown))
        });
        let Yarn { family, .. } = plain.yarn;
        let (tex, alpha) = (plain.yarn.linear_density(), plain.yarn.alpha());
        let mean = mean(&differences);
        println!("{family:?} of {tex:.0} tex, α {alpha}: mean ΔE00 {mean:.2}");
        assert!(mean <= ALLOWED, "{family:?}: {differences:?}");
    }
}

/// The negative control: a colour used as albedo is seen to be wrong.
#[test]
fn the_colour_itself_is_not_the_albedo() {
    let mut differences = Vec::new();
    for plain in CLOTHS.iter() {
        for (_, asked) in DYES {
            let yarn = plain.dyed(asked);
            if in_gamut(&yarn) {
                let colour = asked.to_linear();
                let (shown, _) = plain.shown(colour, Backing::Itself, SPP[2]);
                differences.push(delta_e_00(lab(colour), lab(shown)));
            }
        }
    }
    let mean = mean(&differences);
    println!("colour as albedo: mean ΔE00 {mean:.2}");
    assert!(mean > ALLOWED, "mean ΔE00 {mean:.2}");
}
