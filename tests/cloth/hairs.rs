//! The hair layer's walk leaps over empty cells: what it finds is what many short walks
//! find, which have no room to leap, and no voxel is above its bound.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

use crate::cloth_scenes::{at_level, direction, preset, weave};
use glam::Vec3;
use pickglass::cloth::{ClothVolume, HairLayer};
use pickglass::random::Random;
use pickglass::render::{Counters, MajorantWalk, Medium, Scatterer};
use pickglass::scene::Ray;

fn tweed() -> ClothVolume {
    weave(&preset("tweed"), at_level(3))
}

fn hairs(cloth: &ClothVolume) -> HairLayer<'_> {
    HairLayer::new(cloth, vec![true; 8]).unwrap()
}

/// A ray that starts above or below the cloth, or in it.
fn ray(layer: &HairLayer<'_>, random: &mut Random) -> Ray {
    let bounds = Medium::bounds(layer);
    let [x, y] = random.pair().map(|u| 9.0 * u - 2.0);
    let z = bounds.min.z + (bounds.max.z - bounds.min.z) * random.uniform();
    Ray {
        origin: Vec3::new(x, y, z),
        direction: direction(random),
    }
}

/// Optical depth over 0 ≤ t < `t_max`, from walks of one step each.
fn marched(layer: &HairLayer<'_>, ray: &Ray, t_max: f32, step: f32) -> f64 {
    let mut depth = 0.0;
    for k in 0..(t_max / step) as usize {
        let here = Ray {
            origin: ray.at(k as f32 * step),
            ..*ray
        };
        let mut walk = layer.walk(&here, step);
        while let Some(stretch) = walk.next_stretch() {
            let voxel = walk.voxel(0.5 * (stretch.start + stretch.end), Vec3::splat(0.5), 0.0);
            let area = voxel.fibre().projected_area(ray.direction);
            depth += f64::from(voxel.sigma * area * (stretch.end - stretch.start));
        }
    }
    depth
}

/// Mean and standard error of the transmittance found by walks of full length.
fn tracked(layer: &HairLayer<'_>, ray: &Ray, t_max: f32, random: &mut Random) -> (f64, f64) {
    let (n, mut mean, mut square) = (2000, 0.0, 0.0);
    let mut counters = Counters::default();
    for _ in 0..n {
        let through = f64::from(layer.transmittance(ray, t_max, 0.0, random, &mut counters));
        mean += through;
        square += through * through;
    }
    assert_eq!(
        (counters.majorant_violations, counters.capped_walks),
        (0, 0)
    );
    let mean = mean / f64::from(n);
    let variance = (square / f64::from(n) - mean * mean).max(0.0) / f64::from(n);
    (mean, variance.sqrt())
}

/// Largest deviation between long and short walks in standard errors, over rays that meet
/// hairs; the short ones moved aside by `slide` mm.
fn deviation(slide: f32) -> (f64, u32) {
    let cloth = tweed();
    let layer = hairs(&cloth);
    let voxel = layer.patch_voxel_mm().min_element();
    let (mut worst, mut met) = (0.0f64, 0);
    for k in 0..4000 {
        let mut random = Random::new(5, 0, k);
        let ray = ray(&layer, &mut random);
        let t_max = 2.0 * random.uniform();
        let aside = Ray {
            origin: ray.origin + Vec3::X * slide,
            ..ray
        };
        let found = |ray: &Ray, step| (-marched(&layer, ray, t_max, step)).exp();
        if found(&ray, voxel / 4.0) > 0.995 {
            continue;
        }
        met += 1;
        let expected = found(&aside, voxel / 64.0);
        let (mean, error) = tracked(&layer, &ray, t_max, &mut random);
        // The march is right to a step at each face of a voxel.
        worst = worst.max((mean - expected).abs() / error.hypot(0.01));
        if met == 60 {
            break;
        }
    }
    (worst, met)
}

#[test]
fn long_walks_find_what_short_ones_find() {
    let (worst, met) = deviation(0.0);
    assert!(met == 60 && worst < 4.5, "{met} rays, {worst}");
    let (slid, _) = deviation(0.1);
    assert!(slid > 9.0, "a layer moved aside is told apart: {slid}");
}

#[test]
fn rays_that_miss_the_layer_cost_nothing() {
    let cloth = tweed();
    let layer = hairs(&cloth);
    let above = Medium::bounds(&layer).max.z + 0.1;
    let mut counters = Counters::default();
    let mut random = Random::new(1, 0, 0);
    let ray = Ray {
        origin: Vec3::new(1.0, 1.0, above),
        direction: Vec3::X,
    };
    let through = layer.transmittance(&ray, f32::INFINITY, 0.0, &mut random, &mut counters);
    assert_eq!((through, counters.lookups), (1.0, 0));
}
