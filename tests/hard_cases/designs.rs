//! Numerical hard cases of a cloth: each comes out whole.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

use crate::cloth_scenes::{self, at_level, cotton, two_yarns, weave, weave_from, woven};
use glam::Vec3;
use pickglass::cloth::ClothVolume;
use pickglass::design::{
    Design, Family, Sett, WeavePattern, Yarn, YarnId, YarnMaps, weave as notation,
};
use pickglass::job::Job;
use pickglass::random::Random;
use pickglass::render::{RenderSettings, render};
use pickglass::scene::{LightRig, View};
use pickglass::synthesis::Catalogue;

/// Looks at a cloth from all sides; answers the share of it that is covered, seen from
/// the front.
fn look(name: &str, cloth: &ClothVolume) -> f32 {
    let pitch = Vec3::new(
        cloth.ends().pitch(0) as f32,
        cloth.picks().pitch(0) as f32,
        0.0,
    );
    let mut covered = 0.0;
    for view in [View::Face, View::Back, View::Oblique, View::Grazing] {
        let width = 5.0 * pitch.x.max(pitch.y);
        let camera = view.camera(pitch * 7.3, width, 20, 16);
        let lights = LightRig::preset("sun").unwrap().on(view.pose(false));
        let settings = RenderSettings {
            spp: 4,
            ..RenderSettings::default()
        };
        let outcome = render(
            cloth,
            &camera,
            &lights,
            &settings,
            &Job::new(),
            &mut |_, _| {},
        )
        .unwrap();
        let counters = outcome.counters;
        assert_eq!(counters.majorant_violations, 0, "{name} {view:?}");
        assert_eq!(counters.invalid_samples, 0, "{name} {view:?}");
        assert_eq!(counters.invalid_rays, 0, "{name} {view:?}");
        let pixels = outcome.film.pixels();
        assert!(
            pixels.iter().all(|pixel| pixel.mean().is_finite()),
            "{name}"
        );
        assert!(
            pixels.iter().all(|pixel| pixel.mean().min_element() >= 0.0),
            "{name}"
        );
        if view == View::Face {
            covered = pixels.iter().map(|pixel| pixel.alpha()).sum::<f32>() / pixels.len() as f32;
        }
    }
    println!("{name}: {covered:.3} covered");
    covered
}

fn expect_covered(name: &str, design: &Design, range: std::ops::RangeInclusive<f32>) {
    let covered = look(name, &weave(design, at_level(3)));
    assert!(range.contains(&covered), "{name}: {covered} covered");
}

#[test]
fn the_smallest_designs() {
    for (name, ends, picks) in [
        ("one crossing", 1, 1),
        ("one end", 1, 6),
        ("one pick", 6, 1),
        ("all", 8, 8),
    ] {
        for up in [true, false] {
            let pattern = WeavePattern::from_fn(ends, picks, |_, _| up);
            expect_covered(&format!("{name} {up}"), &cotton(pattern), 0.8..=1.0);
        }
    }
    let mixed = WeavePattern::from_fn(1, 6, |_, pick| pick % 3 == 0);
    expect_covered("one end, mixed", &cotton(mixed), 0.8..=1.0);
    let mixed = WeavePattern::from_fn(6, 1, |end, _| end % 3 == 0);
    expect_covered("one pick, mixed", &cotton(mixed), 0.8..=1.0);
}

/// A plain cotton cloth of yarns of this diameter (mm) at this sett.
fn of_size(diameter: f32, sett: Sett) -> Design {
    let yarns: Vec<Yarn> = two_yarns(Family::Cotton)
        .into_iter()
        .map(|yarn| Yarn {
            diameter_mm: Some(diameter),
            ..yarn
        })
        .collect();
    let maps = YarnMaps::plain(YarnId(0), YarnId(1));
    woven(notation("2/2 twill").unwrap(), sett)
        .with_yarns(yarns, maps)
        .unwrap()
}

#[test]
fn yarns_thicker_than_their_spacing() {
    expect_covered("twice", &of_size(0.6, Sett::per_cm(34.0, 32.0)), 0.9..=1.0);
    expect_covered(
        "5 times",
        &of_size(1.5, Sett::per_cm(34.0, 32.0)),
        0.9..=1.0,
    );
}

#[test]
fn setts_from_fishing_net_to_membrane() {
    expect_covered("net", &of_size(0.2, Sett::per_cm(0.6, 0.6)), 0.0..=0.3);
    expect_covered("uneven", &of_size(0.2, Sett::per_cm(60.0, 8.0)), 0.5..=1.0);
    expect_covered(
        "fine",
        &of_size(0.025, Sett::per_cm(340.0, 320.0)),
        0.5..=1.0,
    );
}

#[test]
fn a_spacing_that_cannot_be_woven_is_an_error() {
    for per_cm in [0.3, 2000.0] {
        let base = cotton(notation("2/2 twill").unwrap());
        let message = base.with_sett(Sett::per_cm(per_cm, 30.0)).unwrap_err();
        let message = message.to_string();
        assert!(message.contains("cannot be woven"), "{message}");
    }
}

#[test]
fn a_stripe_of_28_on_an_eight_end_weave() {
    let stripe = (0..28).map(|end| YarnId(u16::from(end < 20))).collect();
    let maps = YarnMaps::orders(stripe, vec![YarnId(0)]);
    let base = cotton(notation("7/1 satin").unwrap());
    let yarns = base.yarns().to_vec();
    let design = base.with_yarns(yarns, maps).unwrap();
    let cloth = weave(&design, at_level(3));
    assert!(look("stripe", &cloth) > 0.8);
    // The stripe runs on with a period of 28, not 8 or 56: seen from above.
    let (mut right, mut short) = (0, 0);
    for end in 0..112i64 {
        for pick in 0..8i64 {
            if !design.weave().get_wrapped(end, pick) {
                continue;
            }
            let (x, y) = (cloth.ends().centre(end), cloth.picks().centre(pick));
            let face = pickglass::synthesis::Face::Front;
            let (_, seen) = cloth_scenes::surface(&cloth, x as f32, y as f32, face).unwrap();
            assert_eq!(seen.optics, u32::from(end % 28 < 20), "end {end}");
            right += 1;
            // Control: taken with the weave's own period it would be wrong.
            short += usize::from(seen.optics != u32::from(end % 8 < 20));
        }
    }
    assert!(right > 700 && short > 150, "{right}, {short}");
}

#[test]
fn a_pattern_that_no_exemplar_matches() {
    let mut random = Random::new(41, 0, 0);
    let pattern = WeavePattern::from_fn(24, 24, |_, _| random.uniform() < 0.5);
    let catalogue = Catalogue::paper();
    assert!(catalogue.neighbourhoods_covered() < 32);
    let cloth = weave_from(&cotton(pattern), catalogue, at_level(3));
    assert!(look("noise, paper's exemplars", &cloth) > 0.8);
}
