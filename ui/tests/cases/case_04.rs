//! The inputs of tests/cases/04, each with what is wanted of it, and their neighbours.

use super::program::Place;

/// The picture of a volume.
pub fn picture(place: &Place, file: &str) -> Vec<u8> {
    let arguments = [
        "still",
        file,
        "-o",
        "a.png",
        "--size",
        "150x100",
        "--spp",
        "8",
        "--set",
        "denoise=off",
    ];
    place.run(&arguments).done();
    let picture = image::open(place.path("a.png")).expect("a picture");
    picture.into_rgba8().into_raw()
}

#[test]
fn header_size_is_skipped_and_minus_one_counts_from_the_end() {
    let place = Place::of("04");
    let plain = picture(&place, "plain.mhd");
    assert!(picture(&place, "twenty.mhd") == plain);
    assert!(picture(&place, "minus-one.mhd") == plain);
    // Control: a byte less is another volume.
    let text = std::fs::read_to_string(place.path("twenty.mhd")).expect("read");
    let less = text.replace("HeaderSize = 20", "HeaderSize = 16");
    std::fs::write(place.path("twenty.mhd"), less).expect("written");
    assert!(picture(&place, "twenty.mhd") != plain);
}

#[test]
fn a_header_size_that_is_none_is_refused_by_name() {
    let place = Place::of("04");
    let text = std::fs::read_to_string(place.path("twenty.mhd")).expect("read");
    for wrong in ["-2", "many", "99999999"] {
        let changed = text.replace("HeaderSize = 20", &format!("HeaderSize = {wrong}"));
        std::fs::write(place.path("twenty.mhd"), changed).expect("written");
        let said = place.run(&["still", "twenty.mhd", "-o", "a.png"]).refused();
        assert!(
            said.contains("HeaderSize") || said.contains("cut off"),
            "{said}"
        );
    }
}
