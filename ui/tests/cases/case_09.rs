//! The inputs of tests/cases/09, each with what is wanted of it, and their neighbours.

use crate::program::Place;

fn pixels(place: &Place, name: &str) -> image::RgbImage {
    let bytes = std::fs::read(place.path(name)).expect("a file");
    image::load_from_memory(&bytes).expect("an image").to_rgb8()
}

#[test]
fn case_09_a_colour_key_is_white_paper_and_is_told() {
    let place = Place::of("09");
    let said = place
        .run(&[
            "convert",
            "black-on-keyed-magenta.png",
            "a.png",
            "--write",
            "weave",
        ])
        .done();
    assert_eq!(pixels(&place, "a.png"), pixels(&place, "shown.png"));
    assert!(
        said.err
            .contains("transparent pixels are read as white paper"),
        "{}",
        said.err
    );
    assert!(said.err.contains("read as a weave"), "{}", said.err);
}

#[test]
fn case_09_what_is_all_transparent_or_white_has_no_ink() {
    let place = Place::of("09");
    for name in ["grey-keyed-black.png", "white-ink-on-keyed-black-1bit.png"] {
        let said = place
            .run(&["convert", name, "a.png", "--write", "weave"])
            .done();
        assert!(
            pixels(&place, "a.png")
                .pixels()
                .all(|pixel| pixel.0 == [255; 3]),
            "{name}"
        );
        assert!(said.err.contains("no ink"), "{name}: {}", said.err);
        assert!(said.err.contains("transparent"), "{name}: {}", said.err);
    }
    // Negative control: an image with ink is not said to have none.
    let said = place
        .run(&["convert", "shown.png", "a.png", "--write", "weave"])
        .done();
    assert!(
        !said.err.contains("no ink") && !said.err.contains("transparent"),
        "{}",
        said.err
    );
}

#[test]
fn case_09_pictures_follow_the_colour_key_too() {
    let place = Place::of("09");
    let photo = pickglass::formats::photo::load(&place.path("black-on-keyed-magenta.png"));
    let photo = photo.expect("a picture");
    assert!(
        photo.warnings[0].contains("transparent"),
        "{:?}",
        photo.warnings
    );
    let shown = pixels(&place, "shown.png");
    let found = photo.source.pixels().as_flattened();
    assert_eq!(found, shown.as_raw().as_slice());
}
