//! The inputs of tests/cases/17, each with what is wanted of it, and their neighbours.

use crate::program::Place;
use glam::Vec3;

#[test]
fn case_17_an_environment_that_its_bytes_cannot_hold_is_refused_before_it_is_unpacked() {
    let place = Place::of("17");
    let message = place.run(&[
        "still",
        "herringbone",
        "-o",
        "o.png",
        "--size",
        "24x16",
        "--spp",
        "2",
        "--light",
        "e64mp100ch.exr",
    ]);
    let message = message.refused();
    assert!(message.contains("e64mp100ch.exr"), "{message}");
    assert!(message.contains("cannot hold"), "{message}");
}

#[test]
fn case_17_memory_is_asked_for_before_an_environment_is_read() {
    let place = Place::of("17");
    let bytes = pickglass::formats::exr::encode_rgb(4096, 2048, |_, _| Vec3::ONE);
    std::fs::write(place.path("large.exr"), bytes.expect("encodes")).expect("written");
    let said = place
        .command(&[
            "still",
            "herringbone",
            "-o",
            "o.png",
            "--size",
            "24x16",
            "--light",
            "large.exr",
        ])
        .env("PICKGLASS_MEMORY", "70M")
        .output()
        .expect("the program starts");
    let message = crate::program::Said::of(said).refused();
    assert!(message.contains("large.exr"), "{message}");
    assert!(message.contains("of memory would be needed"), "{message}");
}

/// A file without an end.
#[cfg(unix)]
#[test]
fn case_17_a_link_to_a_device_is_no_environment() {
    let place = Place::of("17");
    std::os::unix::fs::symlink("/dev/zero", place.path("zero.exr")).expect("a link");
    let message = place
        .run(&["still", "herringbone", "-o", "o.png", "--light", "zero.exr"])
        .refused();
    assert!(message.contains("zero.exr"), "{message}");
}
