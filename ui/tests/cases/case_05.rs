//! The inputs of tests/cases/05, each with what is wanted of it, and their neighbours.

use super::case_04::picture;
use super::program::Place;

/// How many of a picture's opaque pixels lie left, right, above and below its middle.
fn halves(rgba: &[u8], width: usize) -> [usize; 4] {
    let height = rgba.len() / 4 / width;
    let mut counts = [0; 4];
    for at in (0..rgba.len() / 4).filter(|at| rgba[4 * at + 3] > 127) {
        let (x, y) = (at % width, at / width);
        counts[usize::from(2 * x >= width)] += 1;
        counts[2 + usize::from(2 * y >= height)] += 1;
    }
    counts
}

#[test]
fn turned_axes_show_the_same_as_axes_that_are_not_turned() {
    let place = Place::of("05");
    // The same grid, unturned: an L whose upright is at the left.
    let case_04 = Place::of("04");
    let [left, right, upper, lower] = halves(&picture(&case_04, "plain.mhd"), 150);
    assert!(
        left > right && lower > upper,
        "{left} {right} {upper} {lower}"
    );
    let turned = picture(&place, "transform-matrix.mhd");
    let found = halves(&turned, 150);
    assert!(found[0] > found[1] && found[3] > found[2], "{found:?}");
    for file in ["orientation.mhd", "rotation.mhd", "same-as-nrrd.nrrd"] {
        assert!(picture(&place, file) == turned, "{file}");
    }
    // Control: without the matrix it is the mirror image.
    let text = std::fs::read_to_string(place.path("rotation.mhd")).expect("read");
    let straight = text.replace("Rotation = -1", "Rotation = 1");
    std::fs::write(place.path("rotation.mhd"), straight).expect("written");
    let mirrored = halves(&picture(&place, "rotation.mhd"), 150);
    assert!(mirrored[0] < mirrored[1], "{mirrored:?}");
}

#[test]
fn axes_that_lie_aslant_are_refused_with_what_to_do() {
    let place = Place::of("05");
    let said = place
        .run(&["still", "turned-30-degrees.mhd", "-o", "a.png"])
        .refused();
    assert!(
        said.contains("TransformMatrix") && said.contains("resample"),
        "{said}"
    );
}
