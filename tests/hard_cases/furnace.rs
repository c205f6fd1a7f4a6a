//! The white furnace: cloth of white fibres, in even light, behind which there is that light.

use crate::cloth_scenes::{at_level, cotton, weave};
use crate::how_many;
use glam::Vec3;
use pickglass::cloth::ClothSettings;
use pickglass::design::{Design, Family, Srgb, WeavePattern, Yarn};
use pickglass::job::Job;
use pickglass::render::{Background, RenderOutcome, RenderSettings, render};
use pickglass::scene::{Camera, Dome, EnvironmentImage, LightRig, Sky};

/// A twill of both yarns of this family and colour.
fn twill(family: Family, colour: Srgb) -> Design {
    let pattern = WeavePattern::from_fn(4, 4, |end, pick| (end + 4 - pick) % 4 < 2);
    let design = cotton(pattern);
    let yarns = ["warp", "weft"].map(|name| Yarn::new(name, family, colour));
    let maps = design.maps().clone();
    design.with_yarns(yarns.to_vec(), maps).expect("two yarns")
}

fn look(family: Family, colour: Srgb, camera: &Camera, sky: Sky, spp: u32) -> RenderOutcome {
    // What coarse voxels are corrected by changes their light.
    let settings = ClothSettings {
        correct_levels: false,
        ..at_level(3)
    };
    let cloth = weave(&twill(family, colour), settings);
    let lights = LightRig::new("even", Vec::new(), sky);
    let settings = RenderSettings {
        spp,
        max_order: 100_000,
        background: Background::Sky,
        ..RenderSettings::default()
    };
    let outcome = render(
        &cloth,
        camera,
        &lights,
        &settings,
        &Job::new(),
        &mut |_, _| {},
    );
    let outcome = outcome.expect("not cancelled");
    assert_eq!(outcome.counters.invalid_samples, 0);
    assert_eq!(outcome.counters.majorant_violations, 0);
    outcome
}

/// From straight above to a tenth of a degree, from below, and from inside.
fn cameras() -> Vec<(String, Camera)> {
    let at = Vec3::new(7.3, 5.1, 0.0);
    let mut cameras: Vec<_> = [90.0f32, 45.0, 18.0, 5.0, 0.1, -30.0, -90.0]
        .map(|degrees| {
            let (sine, cosine) = degrees.to_radians().sin_cos();
            let from = Vec3::new(0.6 * cosine, -0.8 * cosine, sine);
            let camera = Camera::orthographic(at, from, Vec3::Y, 1.2, 16, 16);
            (format!("{degrees}°"), camera)
        })
        .into();
    let inside = Camera::perspective(at, Vec3::new(0.3, -0.5, 0.1), Vec3::Y, 90.0, 0.02, 16, 16);
    cameras.push(("inside".to_owned(), inside));
    cameras
}

const FAMILIES: [Family; 4] = [Family::Cotton, Family::Silk, Family::Wool, Family::Linen];
const WHITE: Srgb = Srgb(255, 255, 255);

/// In a dome every path that comes out has met the same light: there is no noise at all.
#[test]
fn white_cloth_in_even_light_cannot_be_seen() {
    let dome = || Sky::Dome(Dome::uniform(Vec3::ONE));
    for family in FAMILIES {
        for (name, camera) in cameras() {
            let outcome = look(family, WHITE, &camera, dome(), how_many(2, 32) as u32);
            let (mean, _) = outcome.film.mean_luminance();
            // Those that are given up are missing, and they are few.
            let lost = outcome.counters.capped_walks as f64 / outcome.counters.paths as f64;
            println!("{family:?} {name}: {mean:.5}, {lost:.5} given up");
            assert!(
                (mean + lost - 1.0).abs() < 2e-3 && lost < 5e-3,
                "{family:?} {name}: {mean}"
            );
        }
    }
    // Control: grey cloth is seen.
    let (_, face) = &cameras()[0];
    let grey = look(Family::Cotton, Srgb(240, 240, 240), face, dome(), 8);
    let (grey, _) = grey.film.mean_luminance();
    assert!(grey < 0.95, "{grey}");
}

/// As a picture the light is sampled as well, and both ways have to agree.
#[test]
fn white_cloth_under_a_picture_cannot_be_seen() {
    let picture = EnvironmentImage::new(16, 8, vec![Vec3::ONE; 128]).expect("sound");
    let sky = Sky::Image(picture.into());
    let families = how_many(1, 4) as usize;
    for family in FAMILIES.into_iter().take(families) {
        for (name, camera) in cameras() {
            let spp = how_many(16, 512) as u32;
            let outcome = look(family, WHITE, &camera, sky.clone(), spp);
            let (mean, error) = outcome.film.mean_luminance();
            println!("{family:?} {name}: {mean:.4} ± {error:.4}");
            assert!(
                (mean - 1.0).abs() < 4.5 * error + 1e-3,
                "{family:?} {name}: {mean}"
            );
        }
    }
}
