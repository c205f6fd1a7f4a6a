//! The inputs of tests/cases/06, each with what is wanted of it, and their neighbours.

use super::program::{Place, Said};

/// What is said of a volume, and how wide its picture is, mm, by the dots a metre in the PNG.
fn width_mm(place: &Place, file: &str, more: &[&str]) -> (Said, f64) {
    let arguments = [
        "still", file, "-o", "a.png", "--size", "150x100", "--spp", "1",
    ];
    let said = place.run(&[&arguments[..], more].concat()).done();
    let bytes = std::fs::read(place.path("a.png")).expect("a picture");
    let at = bytes
        .windows(4)
        .position(|four| four == b"pHYs")
        .expect("a scale")
        + 4;
    let dots = u32::from_be_bytes(bytes[at..at + 4].try_into().expect("four bytes"));
    (said, 150.0 / f64::from(dots) * 1000.0)
}

#[test]
fn units_of_length_make_the_same_cloth() {
    let place = Place::of("06");
    for file in [
        "units-um.nrrd",
        "units-mm.nrrd",
        "units-m.nrrd",
        "space-units-um.nrrd",
        "space-units-mm.nrrd",
        "space-units-m.nrrd",
        "element-size.mhd",
    ] {
        let (said, width) = width_mm(&place, file, &[]);
        assert!((width - 1.2).abs() < 0.001, "{file}: {width} mm");
        assert!(!said.err.contains("how large"), "{said:?}");
    }
}

#[test]
fn a_scale_that_is_not_known_is_told_with_the_option_that_gives_it() {
    let place = Place::of("06");
    for file in ["no-spacing.nrrd", "spacing-unknown-nan.nrrd"] {
        let (said, width) = width_mm(&place, file, &[]);
        assert!((width - 12.0).abs() < 0.01, "{file}: {width} mm");
        let warned = said.err.lines().any(|line| {
            line.contains(file) && line.contains("spacings") && line.contains("--voxel")
        });
        assert!(warned, "{said:?}");
        let (said, width) = width_mm(&place, file, &["--voxel", "0.1"]);
        assert!((width - 1.2).abs() < 0.001, "{file}: {width} mm");
        assert!(!said.err.contains("--voxel"), "{said:?}");
    }
    // A file without any size, as MetaImage.
    let text = std::fs::read_to_string(place.path("element-size.mhd")).expect("read");
    let without = text.replace("ElementSize", "Elementsize");
    std::fs::write(place.path("element-size.mhd"), without).expect("written");
    let (said, width) = width_mm(&place, "element-size.mhd", &[]);
    assert!(
        (width - 12.0).abs() < 0.01 && said.err.contains("ElementSpacing"),
        "{said:?}"
    );
}

#[test]
fn designs_have_no_voxels_to_scale() {
    let place = Place::of("06");
    let said = place
        .run(&["still", "twill", "-o", "a.png", "--voxel", "1"])
        .refused();
    assert!(
        said.contains("--voxel") && said.contains("--sett"),
        "{said}"
    );
}
