//! Majorants bound every lookup, and rays of any kind end.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

use crate::cloth_scenes::{at_level, cotton, direction, two_yarns, wavy_twill, weave, woven};
use glam::Vec3;
use pickglass::cloth::ClothVolume;
use pickglass::design::{
    Design, Family, Lattice, Repeat, Sett, Srgb, WeavePattern, Yarn, YarnId, YarnMaps,
};
use pickglass::exemplar::Allowance;
use pickglass::random::Random;
use pickglass::render::{Counters, MajorantWalk, Medium, Scatterer};
use pickglass::scene::Ray;
use rayon::prelude::*;

/// A weave without order: nearly every border is a seam.
fn noise(ends: u32, picks: u32) -> WeavePattern {
    let mut random = Random::new(5, 0, 0);
    WeavePattern::from_fn(ends, picks, |_, _| random.uniform() < 0.5)
}

fn lattice(across: Repeat, along: Repeat) -> Lattice {
    Lattice { across, along }
}

fn uneven() -> Sett {
    let mut sett = Sett::per_cm(34.0, 32.0);
    sett.ends.pitches_mm = Some(vec![0.3, 0.2, 0.5, 0.29, 0.25]);
    sett.picks.pitches_mm = Some(vec![0.28, 0.45, 0.3]);
    sett
}

fn families() -> Design {
    let mut yarns = two_yarns(Family::Cotton);
    yarns.push(Yarn::new("wool", Family::Wool, Srgb(90, 80, 70)));
    yarns.push(Yarn::new("silk", Family::Silk, Srgb(240, 200, 190)));
    let maps = YarnMaps::orders(vec![YarnId(0)], vec![YarnId(1), YarnId(2), YarnId(3)]);
    cotton(noise(24, 24)).with_yarns(yarns, maps).unwrap()
}

fn designs() -> Vec<(&'static str, Design)> {
    let drop = lattice(Repeat::Dropped(5), Repeat::Straight);
    let panel = lattice(Repeat::None, Repeat::None);
    vec![
        ("waves", cotton(wavy_twill(96, 96))),
        ("noise", cotton(noise(48, 48))),
        ("families", families()),
        ("uneven", woven(noise(32, 32), uneven())),
        ("dropped", cotton(noise(24, 24)).with_lattice(drop).unwrap()),
        ("panel", cotton(noise(16, 16)).with_lattice(panel).unwrap()),
    ]
}

/// A ray that meets the cloth: of any direction, grazing, along an axis, with zeros of
/// either sign; from above, below, inside or on a border.
fn ray(cloth: &ClothVolume, random: &mut Random) -> Ray {
    let (low, high) = cloth.height_range();
    let pick = (random.uniform() * 8.0) as u32;
    let mut towards = direction(random);
    match pick {
        0 => towards.z *= 0.02,
        1 => towards = Vec3::new(towards.x.signum(), 0.0, -0.0),
        2 => towards = Vec3::new(-0.0, towards.y.signum(), 0.0),
        3 => towards = Vec3::new(0.0, -0.0, towards.z.signum()),
        4 => towards.x = 0.0,
        _ => {}
    }
    let towards = towards.normalize_or(Vec3::Z);
    let [x, y] = random.pair().map(|u| 6.0 * u - 0.5);
    let z = low + (high - low) * random.uniform();
    let mut origin = Vec3::new(x, y, z);
    if random.uniform() < 0.3 {
        let end = cloth.ends().locate(x.into()).0;
        origin.x = cloth.ends().start(end) as f32;
    }
    if random.uniform() < 0.4 {
        origin -= towards * 0.5;
    }
    Ray {
        origin,
        direction: towards,
    }
}

/// Lookups, and those above the bound of their stretch times `scale`.
fn violations(cloth: &ClothVolume, rays: u64, scale: f32) -> (u64, u64) {
    (0..rays)
        .into_par_iter()
        .map(|k| {
            let mut random = Random::new(11, 0, k);
            let ray = ray(cloth, &mut random);
            let mut walk = cloth.walk(&ray, 3.0);
            let (mut lookups, mut above, mut last) = (0, 0, 0.0f32);
            while let Some(stretch) = walk.next_stretch() {
                assert!(stretch.start >= last && stretch.end > stretch.start);
                assert!(stretch.majorant.is_finite() && stretch.majorant > 0.0);
                last = stretch.end;
                for _ in 0..3 {
                    let t = stretch.start + (stretch.end - stretch.start) * random.uniform();
                    let voxel = walk.voxel(t, random.tap(), 0.0);
                    lookups += 1;
                    above += u64::from(voxel.sigma > stretch.majorant * scale * (1.0 + 1e-5));
                }
            }
            (lookups, above)
        })
        .reduce(|| (0, 0), |a, b| (a.0 + b.0, a.1 + b.1))
}

#[test]
fn no_lookup_is_above_its_majorant() {
    for (name, design) in designs() {
        let cloth = weave(&design, at_level(2)).with_window(0.0..6.0, 0.0..6.0);
        let (lookups, above) = violations(&cloth, 3000, 1.0);
        println!("{name}: {above} of {lookups} lookups");
        assert!(lookups > 20_000, "{name}: {lookups} lookups");
        assert_eq!(above, 0, "{name}");
    }
}

#[test]
fn leaving_out_an_allowance_is_noticed() {
    let cloth = weave(&cotton(noise(48, 48)), at_level(1)).with_window(0.0..6.0, 0.0..6.0);
    for allowance in [
        Allowance {
            shift: false,
            ..Allowance::FULL
        },
        Allowance {
            tap: false,
            ..Allowance::FULL
        },
    ] {
        let wrong = cloth.clone().with_allowance(allowance);
        let (lookups, above) = violations(&wrong, 4000, 1.0);
        println!("{allowance:?}: {above} of {lookups}");
        assert!(above > 0, "{allowance:?}: none of {lookups}");
    }
    let (lookups, above) = violations(&cloth, 1000, 0.5);
    assert!(above > lookups / 100, "halved: {above} of {lookups}");
}

#[test]
fn flights_and_shadows_are_counted_clean() {
    for (name, design) in designs() {
        let cloth = weave(&design, at_level(2)).with_window(0.0..6.0, 0.0..6.0);
        let mut counters = Counters::default();
        for k in 0..150 {
            let mut random = Random::new(12, 0, k);
            let ray = ray(&cloth, &mut random);
            cloth.collide(&ray, f32::INFINITY, &mut random, &mut counters);
            let through = cloth.transmittance(&ray, 5.0, 0.0, &mut random, &mut counters);
            assert!((0.0..=1.0).contains(&through));
        }
        assert!(counters.lookups > 300, "{name}: {counters:?}");
        assert_eq!(counters.majorant_violations, 0, "{name}");
        assert_eq!(counters.invalid_rays, 0, "{name}");
    }
}

#[test]
fn poison_rays_end_and_are_counted() {
    let cloth = weave(&cotton(noise(48, 48)), at_level(2));
    let poison = [
        f32::NAN,
        f32::INFINITY,
        f32::NEG_INFINITY,
        f32::MAX,
        f32::MIN_POSITIVE * 0.5,
        -0.0,
        1e30,
    ];
    let sound = Ray {
        origin: Vec3::new(1.0, 1.0, 1.0),
        direction: Vec3::NEG_Z,
    };
    for value in poison {
        for axis in 0..6 {
            let mut ray = sound;
            if axis < 3 {
                ray.origin[axis] = value;
            } else {
                ray.direction[axis - 3] = value;
            }
            for t_max in [20.0, f32::INFINITY, value] {
                let (mut random, mut counters) = (Random::new(1, 2, 3), Counters::default());
                let hit = cloth.collide(&ray, t_max, &mut random, &mut counters);
                let through = cloth.transmittance(&ray, t_max, 0.0, &mut random, &mut counters);
                assert!(hit.is_none_or(|hit| hit.t.is_finite()), "{ray:?}");
                assert!((0.0..=1.0).contains(&through), "{ray:?}: {through}");
                assert_eq!(counters.majorant_violations, 0);
                // The walk itself ends, too.
                let mut walk = cloth.walk(&ray, t_max);
                let stretches = std::iter::from_fn(|| walk.next_stretch()).take(1 << 22);
                assert!(stretches.count() < 1 << 22, "{ray:?} to {t_max}");
            }
        }
    }
    let mut counters = Counters::default();
    let nowhere = Ray {
        direction: Vec3::ZERO,
        ..sound
    };
    let hit = cloth.collide(&nowhere, 1.0, &mut Random::new(1, 2, 3), &mut counters);
    assert!(hit.is_none() && counters.invalid_rays == 1);
}
