//! A few voxels far denser than the rest: they cost little and change little.

#![allow(clippy::unwrap_used, reason = "a test may fail")]

use std::fs;
use std::path::Path;

use crate::render_scenes::shoot;
use pickglass::formats::volume;
use pickglass::job::Job;
use pickglass::render::{Medium, RenderOutcome, RenderSettings};
use pickglass::scene::{LightRig, View};
use pickglass::volume::Taps;

/// Voxels of tests/cases/07/slab.nrrd along x, y and z.
const SIZE: [usize; 3] = [24, 16, 8];

/// The slab with another extinction in some voxels.
fn slab(path: &Path, extinction: f32, is_dense: &dyn Fn([usize; 3]) -> bool) {
    let case = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/cases/07/slab.nrrd");
    let mut bytes = fs::read(case).unwrap();
    let head = bytes.len() - SIZE.iter().product::<usize>() * 4;
    for (number, voxel) in bytes[head..].chunks_exact_mut(4).enumerate() {
        let [nx, ny, _] = SIZE;
        if is_dense([number % nx, number / nx % ny, number / nx / ny]) {
            voxel.copy_from_slice(&extinction.to_le_bytes());
        }
    }
    fs::write(path, bytes).unwrap();
}

fn render(path: &Path, taps: Taps, spp: u32) -> RenderOutcome {
    let grid = volume::read(path, taps, &Job::new()).unwrap().grid;
    let bounds = Medium::bounds(&grid);
    let camera = View::Face.camera((bounds.min + bounds.max) * 0.5, 2.4, 60, 40);
    let settings = RenderSettings {
        spp,
        ..RenderSettings::default()
    };
    shoot(&grid, &camera, &LightRig::preset("day").unwrap(), &settings)
}

/// Means of light and alpha over a picture.
fn means(outcome: &RenderOutcome) -> [f64; 2] {
    let pixels = outcome.film.pixels();
    let mean = |of: &dyn Fn(&pickglass::film::Pixel) -> f64| {
        pixels.iter().map(of).sum::<f64>() / pixels.len() as f64
    };
    [
        mean(&|pixel| pixel.luminance()),
        mean(&|pixel| pixel.alpha().into()),
    ]
}

/// A voxel by its place.
type Dense = dyn Fn([usize; 3]) -> bool;

#[test]
fn dense_voxels_cost_at_most_five_times_the_steps() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.nrrd");
    let arrangements: [(&str, &Dense); 5] = [
        ("one", &|cell| cell == [10, 7, 4]),
        ("at a corner", &|cell| cell == [12, 8, 3]),
        ("several", &|[x, y, z]| x % 7 == 3 && y % 5 == 2 && z == 4),
        ("a line", &|[_, y, z]| y == 7 && z == 4),
        ("a layer", &|[_, _, z]| z == 4),
    ];
    for taps in [Taps::Nearest, Taps::StochasticTrilinear] {
        slab(&path, 0.0, &|_| false);
        let plain = render(&path, taps, 4);
        for (name, is_dense) in arrangements {
            for extinction in [1e4, 1e6, 1e30, f32::INFINITY] {
                slab(&path, extinction, is_dense);
                let dense = render(&path, taps, 4);
                let ratio = dense.counters.lookups as f64 / plain.counters.lookups as f64;
                println!("{taps:?} {name} {extinction}: {ratio:.2} times the steps");
                // Filtered, a long line or a layer is a thick rim for every ray that nears it.
                let wide = taps == Taps::StochasticTrilinear && name.starts_with("a ");
                let most = if wide { 20.0 } else { 5.0 };
                assert!(ratio <= most, "{taps:?} {name} {extinction}: {ratio}");
                assert_eq!(dense.counters.capped_walks, 0, "{name}");
                assert_eq!(dense.counters.majorant_violations, 0, "{name}");
                assert_eq!(dense.counters.invalid_samples, 0, "{name}");
                // Nothing dense is seen through.
                let [_, alpha] = means(&dense);
                assert!(alpha > means(&plain)[1] - 0.005, "{name}: {alpha}");
            }
        }
    }
}

#[test]
fn one_dense_voxel_changes_the_mean_by_less_than_half_a_per_cent() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.nrrd");
    slab(&path, 0.0, &|_| false);
    let plain = means(&render(&path, Taps::Nearest, 64));
    for extinction in [1e4, 1e30] {
        slab(&path, extinction, &|cell| cell == [10, 7, 4]);
        let dense = means(&render(&path, Taps::Nearest, 64));
        for (dense, plain) in dense.iter().zip(plain) {
            assert!(
                (dense / plain - 1.0).abs() < 0.005,
                "{extinction}: {dense} {plain}"
            );
        }
    }
    // Control: a hole of a block is noticed.
    slab(&path, 0.0, &|[x, y, _]| {
        (4..16).contains(&x) && (2..14).contains(&y)
    });
    let hole = means(&render(&path, Taps::Nearest, 64));
    assert!((hole[1] / plain[1] - 1.0).abs() > 0.05);
}
