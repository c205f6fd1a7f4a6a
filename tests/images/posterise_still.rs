//! A photograph becomes cloth that shows it: every region's rendered average is the colour
//! that was expected of it, and the blurred picture follows the photograph.

#![allow(clippy::unwrap_used, reason = "a test may fail")]

use std::sync::Arc;

use glam::{DVec3, Vec3};
use pickglass::design::{
    Design, Fill, Regions, SourceImage, Structure, WeavePattern, delta_e_00, lab, weave,
};
use pickglass::engine::{self, StillRequest, Stop};
use pickglass::exemplar::ExemplarStore;
use pickglass::formats::photo;
use pickglass::job::Job;
use pickglass::posterise::{PosteriseSettings, Posterised, posterise};

/// ΔE₀₀ allowed between a region's rendered average and its expected colour.
const ALLOWED: f64 = 4.0;
/// Luminance correlation demanded of the blurred picture and the photograph.
const ALIKE: f64 = 0.9;
/// Pixels across the picture.
const WIDTH: u32 = 120;
/// Samples a pixel.
const SPP: u32 = 3;
/// Pixels along a side of the squares that blur the picture.
const BLUR: u32 = 10;

/// A portrait of sorts, drawn: a lit ball and its shadow on a graded ground, with a coloured
/// band. Used where the photograph is not there.
fn drawn() -> SourceImage {
    let side = 256u32;
    let pixel = |x: u32, y: u32| -> [u8; 3] {
        let (u, v) = (x as f32 / side as f32 - 0.5, y as f32 / side as f32 - 0.5);
        let inside = 1.0 - (u * u + v * v) / 0.1;
        let light = if inside > 0.0 {
            0.15 + 0.8 * (0.6 * inside.sqrt() - u - v).clamp(0.0, 1.0)
        } else if (v - 0.38).abs() < 0.06 {
            return [190, 80, 50];
        } else {
            0.55 - 0.5 * (u + 0.5) * (v + 0.5)
        };
        [light, light * 0.96, light * 0.9].map(|c| (c.clamp(0.0, 1.0) * 255.0) as u8)
    };
    let pixels = (0..side * side).map(|k| pixel(k % side, k / side));
    SourceImage::new(side, side, pixels.collect()).unwrap()
}

/// The photograph where the checkout has it beside it.
fn photograph() -> SourceImage {
    let path =
        std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/images/astronaut.png");
    match photo::load(&path) {
        Ok(photo) => photo.source,
        Err(error) => {
            println!("a drawn picture instead of the photograph: {error}");
            drawn()
        }
    }
}

/// What a still shows of a design as a whole: colours of pixels, top row first.
struct Shown {
    height: u32,
    pixels: Vec<Vec3>,
}

fn shown(design: &Design) -> Shown {
    let size = [design.end_positions(), design.pick_positions()].map(|p| p.repeat_mm() as f32);
    let height = (WIDTH as f32 * size[1] / size[0]).round() as u32;
    let mut request = StillRequest {
        width: WIDTH,
        height,
        width_mm: Some(size[0]),
        stop: Stop {
            spp: Some(SPP),
            ..Stop::default()
        },
        ..StillRequest::default()
    };
    request.settings.showing.denoise = false;
    let job = Job::new();
    let design = Arc::new(design.clone());
    let cloth = engine::prepare(&design, &request, &ExemplarStore::user(), &job).unwrap();
    let still = engine::render(&cloth, &request, &job, &mut |_| {}).unwrap();
    assert_eq!(still.report.invalid_samples, 0);
    // The colour of what is covered, as the picture's file holds it.
    let pixels = still.film.pixels().iter();
    let pixels = pixels.map(|pixel| pixel.mean() / pixel.alpha().max(1e-3));
    println!(
        "{:.1} s, {:.0} paths/s",
        still.report.total_seconds, still.report.paths_per_second
    );
    Shown {
        height,
        pixels: pixels.collect(),
    }
}

/// The region that fills a pixel's whole square of crossings, or `None` on a border.
fn region_of(regions: &Regions, shown: &Shown, x: u32, y: u32) -> Option<u16> {
    let map = regions.map();
    let range = |at: u32, pixels: u32, threads: u32| {
        (at * threads / pixels)..=((at + 1) * threads / pixels).min(threads - 1)
    };
    let mut found = None;
    for row in range(y, shown.height, map.picks()) {
        for end in range(x, WIDTH, map.ends()) {
            let here = map.get(end, map.picks() - 1 - row);
            if *found.get_or_insert(here) != here {
                return None;
            }
        }
    }
    found
}

fn regions(design: &Design) -> &Regions {
    match design.structure() {
        Structure::Regions(regions) => regions,
        _ => panic!("a posterised design has regions"),
    }
}

/// ΔE₀₀ between every region's rendered average and its expected colour, for regions with
/// pixels enough to average.
fn against_expected(made: &Posterised, shown: &Shown) -> Vec<f64> {
    let regions = regions(&made.design);
    let mut sums = vec![(DVec3::ZERO, 0u32); made.colours.len()];
    for y in 0..shown.height {
        for x in 0..WIDTH {
            if let Some(region) = region_of(regions, shown, x, y) {
                let sum = &mut sums[usize::from(region)];
                sum.0 += shown.pixels[(y * WIDTH + x) as usize].as_dvec3();
                sum.1 += 1;
            }
        }
    }
    let mut found = Vec::new();
    for ((sum, count), colour) in sums.into_iter().zip(&made.colours) {
        if count < 60 {
            println!("{} too small: {count} pixels", colour.asked);
            continue;
        }
        let mean = (sum / f64::from(count)).as_vec3();
        let off = delta_e_00(lab(mean), lab(colour.expected.to_linear()));
        println!(
            "asked {} {:4.1} %, expected {}, shown {:.3?}, ΔE {off:.2} over {count} pixels",
            colour.asked,
            100.0 * colour.coverage,
            colour.expected,
            mean.to_array()
        );
        found.push(off);
    }
    found
}

fn luminance(colour: Vec3) -> f64 {
    f64::from(colour.dot(Vec3::new(0.2126, 0.7152, 0.0722)))
}

/// Correlation of the light of the blurred picture and the photograph. Glints are cut off at
/// white, as in a picture's file.
fn likeness(shown: &Shown, source: &SourceImage) -> f64 {
    let (columns, rows) = (WIDTH / BLUR, shown.height / BLUR);
    let mut pairs = Vec::new();
    for row in 0..rows {
        for column in 0..columns {
            let mut here = 0.0;
            for k in 0..BLUR * BLUR {
                let at = (row * BLUR + k / BLUR) * WIDTH + column * BLUR + k % BLUR;
                here += luminance(shown.pixels[at as usize].min(Vec3::ONE));
            }
            let range = |at: u32, all: u32, size: u32| at * size / all..(at + 1) * size / all;
            let (mut there, mut count) = (0.0, 0.0);
            for y in range(row, rows, source.height()) {
                for x in range(column, columns, source.width()) {
                    let [r, g, b] = source.pixels()[(y * source.width() + x) as usize];
                    there += luminance(pickglass::design::Srgb(r, g, b).to_linear());
                    count += 1.0;
                }
            }
            pairs.push((here, there / count));
        }
    }
    correlation(&pairs)
}

fn correlation(pairs: &[(f64, f64)]) -> f64 {
    let n = pairs.len() as f64;
    let (sx, sy) = pairs.iter().fold((0.0, 0.0), |s, p| (s.0 + p.0, s.1 + p.1));
    let (mx, my) = (sx / n, sy / n);
    let sum = |f: &dyn Fn(&(f64, f64)) -> f64| pairs.iter().map(f).sum::<f64>();
    let both = sum(&|p| (p.0 - mx) * (p.1 - my));
    both / (sum(&|p| (p.0 - mx).powi(2)) * sum(&|p| (p.1 - my).powi(2))).sqrt()
}

fn settings() -> PosteriseSettings {
    PosteriseSettings {
        colours: 6,
        ends: Some(480),
        picks: Some(800),
        ends_per_cm: 60.0 / 2.54,
        picks_per_cm: 100.0 / 2.54,
        ..PosteriseSettings::default()
    }
}

#[test]
fn every_region_shows_the_colour_expected_of_it_and_the_cloth_the_photograph() {
    let source = Arc::new(photograph());
    let made = posterise(&source, &settings(), None, &Job::new()).unwrap();
    assert!(made.design.weavable());
    let picture = shown(&made.design);
    let off = against_expected(&made, &picture);
    assert!(off.len() >= 4, "regions too small to judge");
    assert!(off.iter().all(|&off| off <= ALLOWED), "{off:?}");
    let alike = likeness(&picture, &source);
    println!("likeness {alike:.3}");
    assert!(alike >= ALIKE, "{alike}");

    // The negative control: the same regions with each other's weaves.
    let mut shuffled = regions(&made.design).clone();
    let count = made.colours.len() as u16;
    for region in 0..count {
        let other = (region + count / 2) % count;
        let fill = regions(&made.design).palette()[usize::from(other)]
            .fill
            .clone();
        shuffled.set_fill(region, fill);
    }
    let design = made
        .design
        .clone()
        .with_structure(Structure::Regions(shuffled))
        .unwrap();
    let picture = shown(&design);
    let off = against_expected(&made, &picture);
    assert!(off.iter().any(|&off| off > ALLOWED), "{off:?}");
    let alike = likeness(&picture, &source);
    println!("shuffled: likeness {alike:.3}");
    assert!(alike < ALIKE, "{alike}");
}

#[test]
fn weaves_outside_the_series_are_expected_right_too() {
    // Four weaves as stripes of one panel, each wide enough to average.
    let notations = ["2/2 twill", "1/4 satin", "3/1 twill", "4/4 basket"];
    let bars = SourceImage::new(4, 1, vec![[20; 3], [90; 3], [160; 3], [240; 3]]).unwrap();
    let settings = PosteriseSettings {
        ends: Some(160),
        picks: Some(240),
        colours: 4,
        fit: pickglass::posterise::Fit::Stretch,
        ..settings()
    };
    let before = posterise(&Arc::new(bars.clone()), &settings, None, &Job::new()).unwrap();
    let mut regions = regions(&before.design).clone();
    for (region, notation) in notations.iter().enumerate() {
        assert!(regions.set_fill(region as u16, Fill::by_notation(notation).unwrap()));
    }
    let design = before
        .design
        .clone()
        .with_structure(Structure::Regions(regions))
        .unwrap();
    // Posterised anew, the weaves stay and what they are expected to show is known.
    let made = posterise(&Arc::new(bars), &settings, Some(&design), &Job::new()).unwrap();
    let expected: Vec<WeavePattern> = notations.iter().map(|n| weave(n).unwrap()).collect();
    for (region, weave) in self::regions(&made.design).palette().iter().zip(expected) {
        assert!(*region.fill.pattern() == weave);
    }
    let off = against_expected(&made, &shown(&made.design));
    assert_eq!(off.len(), 4);
    assert!(off.iter().all(|&off| off <= ALLOWED), "{off:?}");
}
