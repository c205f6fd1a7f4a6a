//! The inputs of tests/cases/08, each with what is wanted of it, and their neighbours.

use crate::program::Place;

fn pixels(place: &Place, name: &str) -> image::RgbImage {
    let bytes = std::fs::read(place.path(name)).expect("a file");
    image::load_from_memory(&bytes).expect("an image").to_rgb8()
}

#[test]
fn case_08_turned_and_mirrored_weaves_are_read_as_they_are_seen() {
    let place = Place::of("08");
    let upright = pixels(&place, "upright.png");
    for stored in [2, 3, 6] {
        let name = format!("weave-orientation-{stored}.tif");
        let said = place
            .run(&["convert", &name, "a.png", "--write", "weave"])
            .done();
        assert_eq!(pixels(&place, "a.png"), upright, "{name}");
        assert!(!said.err.contains("stored"), "{}", said.err);
    }
    // Negative control: a mirrored weave is another one.
    let mut mirrored = upright.clone();
    image::imageops::flip_horizontal_in_place(&mut mirrored);
    assert_ne!(mirrored, upright);
}

#[test]
fn case_08_turned_artwork_is_read_as_it_is_seen_by_every_format() {
    let place = Place::of("08");
    let upright = pixels(&place, "quarters-upright.png");
    for name in ["quarters-exif-6.png", "quarters-exif-6.webp"] {
        place
            .run(&[
                "convert", name, "b.png", "--as", "artwork", "--write", "artwork",
            ])
            .done();
        let found = pixels(&place, "b.png");
        assert_eq!(found.dimensions(), (60, 40), "{name}");
        assert_eq!(found, upright, "{name}");
    }
}

/// The window and `posterize` read pictures by the same function.
#[test]
fn case_08_pictures_and_artwork_are_turned_alike() {
    let place = Place::of("08");
    let seen = |name: &str| {
        let bytes = std::fs::read(place.path(name)).expect("a file");
        let photo = pickglass::formats::photo::read(&bytes, name).expect("a picture");
        let raster = pickglass::formats::image::read(&bytes, name)
            .expect("an image")
            .raster;
        let source = photo.source;
        assert_eq!((source.width(), source.height()), (60, 40), "{name}");
        assert_eq!((raster.width(), raster.height()), (60, 40), "{name}");
        let corners = [(1, 1), (58, 1), (1, 38), (58, 38)];
        for (x, y) in corners {
            let pickglass::design::Srgb(red, green, blue) = raster.colour(x, y);
            let pixel = source.pixels()[(y * 60 + x) as usize];
            assert_eq!(pixel, [red, green, blue], "{name}");
        }
        corners.map(|(x, y)| source.pixels()[(y * 60 + x) as usize])
    };
    let upright = seen("quarters-upright.png");
    for name in [
        "quarters-exif-6.png",
        "quarters-exif-6.webp",
        "quarters-exif-6.jpg",
    ] {
        for (found, wanted) in seen(name).iter().zip(&upright) {
            let off = found.iter().zip(wanted).map(|(a, b)| a.abs_diff(*b)).max();
            assert!(off <= Some(12), "{name}: {found:?} {wanted:?}");
        }
    }
}
