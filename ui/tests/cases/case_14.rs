//! The inputs of tests/cases/14, each with what is wanted of it, and their neighbours.

use crate::program::Place;

#[test]
fn case_14_two_colours_of_single_crossings_are_a_weave() {
    let place = Place::of("14");
    for (name, darker) in [
        ("twill-navy-cream.png", true),
        ("twill-red-white.png", true),
        ("twill-black-cream.png", false),
        ("twill-nearblack-white.png", false),
        ("plain-dark-grey-pale-grey.bmp", false),
    ] {
        let said = place
            .run(&["convert", name, "a.png", "--write", "weave"])
            .done();
        assert!(said.err.contains("read as a weave"), "{name}: {}", said.err);
        assert_eq!(
            said.err.contains("the darker of its two colours"),
            darker,
            "{name}"
        );
        assert!(said.err.contains("warp up"), "{name}: {}", said.err);
        let read = |name: &str| {
            let bytes = std::fs::read(place.path(name)).expect("a file");
            image::load_from_memory(&bytes)
                .expect("an image")
                .to_luma8()
        };
        let (drawn, woven) = (read(name), read("a.png"));

        let (low, high) = (drawn.iter().min(), drawn.iter().max());
        assert!(low < high && woven.dimensions() == drawn.dimensions());
        let between = (u32::from(*low.expect("one")) + u32::from(*high.expect("one"))) / 2;

        for (pixel, crossing) in drawn.pixels().zip(woven.pixels()) {
            assert_eq!(
                u32::from(pixel.0[0]) > between,
                crossing.0[0] == 255,
                "{name}"
            );
        }
    }
}

/// Regions larger than a weave's repeat stay artwork.
#[test]
fn case_14_two_colours_of_large_regions_are_artwork() {
    let place = Place::of("14");
    let disc = image::RgbImage::from_fn(64, 64, |x, y| {
        match x.abs_diff(32).pow(2) + y.abs_diff(32).pow(2) < 400 {
            true => image::Rgb([25, 25, 117]),
            false => image::Rgb([243, 238, 226]),
        }
    });
    disc.save(place.path("disc.png")).expect("written");
    let said = place.run(&["check", "disc.png"]).done();
    assert!(
        (said.out.clone() + &said.err).contains("read as artwork of 2 colours"),
        "{said:?}"
    );
}
