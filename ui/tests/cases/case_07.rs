//! The inputs of tests/cases/07, each with what is wanted of it, and their neighbours.

use super::program::Place;
use std::path::Path;

const DENSE: [&str; 4] = ["10000", "100000", "1e+06", "1e+30"];

fn still(place: &Place, file: &str, picture: &str, effects: &str) -> serde_json::Value {
    let arguments = [
        "still",
        file,
        "-o",
        picture,
        "--size",
        "150x100",
        "--spp",
        "8",
        "--set",
        "denoise=off",
        "--set",
        "png-bits=16",
        "--effects",
        effects,
        "--json",
    ];
    place.run(&arguments).done().json()
}

/// Mean light (colour times alpha, as encoded) and mean alpha of a picture.
fn mean(path: &Path) -> [f64; 2] {
    let picture = image::open(path).expect("a picture").into_rgba16();
    let share = |value: u16| f64::from(value) / 65535.0;
    let (mut light, mut alpha) = (0.0, 0.0);
    for pixel in picture.pixels() {
        light += share(pixel.0[1]) * share(pixel.0[3]);
        alpha += share(pixel.0[3]);
    }
    let pixels = f64::from(picture.width() * picture.height());
    [light / pixels, alpha / pixels]
}

#[test]
fn one_dense_voxel_changes_its_picture_by_less_than_half_a_per_cent() {
    let place = Place::of("07");
    for effects in ["auto", "+tap"] {
        still(&place, "slab.nrrd", "slab.png", effects);
        let slab = mean(&place.path("slab.png"));
        for dense in DENSE {
            let file = format!("slab-one-voxel-{dense}.nrrd");
            let report = still(&place, &file, "dense.png", effects);
            assert_eq!(report["capped_walks"], 0, "{dense}");
            assert_eq!(report["invalid_rays"], 0, "{dense}");
            assert_eq!(report["invalid_samples"], 0, "{dense}");
            assert_eq!(report["majorant_violations"], 0, "{dense}");
            let found = mean(&place.path("dense.png"));
            for (found, slab) in found.iter().zip(slab) {
                assert!(
                    (found / slab - 1.0).abs() < 0.005,
                    "{dense}: {found} {slab}"
                );
            }
        }
    }
}

#[test]
fn an_opaque_voxel_is_told() {
    let place = Place::of("07");
    let arguments = [
        "still",
        "slab-one-voxel-1e+30.nrrd",
        "-o",
        "a.png",
        "--size",
        "15x10",
        "--spp",
        "1",
    ];
    let said = place.run(&arguments).done();
    assert!(said.err.contains("1 extinction "), "{said:?}");
    let arguments = [
        "still",
        "slab.nrrd",
        "-o",
        "a.png",
        "--size",
        "15x10",
        "--spp",
        "1",
    ];
    let said = place.run(&arguments).done();
    assert!(!said.err.contains("opaque"), "{said:?}");
}

#[test]
fn pictures_say_how_many_walks_were_capped_and_rays_invalid() {
    let place = Place::of("07");
    let arguments = [
        "still",
        "slab.nrrd",
        "-o",
        "a.exr",
        "--size",
        "15x10",
        "--spp",
        "1",
    ];
    place.run(&arguments).done();
    let bytes = std::fs::read(place.path("a.exr")).expect("a picture");
    for name in ["capped_walks", "invalid_rays"] {
        let there = bytes
            .windows(name.len())
            .any(|part| part == name.as_bytes());
        assert!(there, "{name}");
    }
}
