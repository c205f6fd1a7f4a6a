//! The inputs of tests/cases/21, each with what is wanted of it, and their neighbours.

use std::path::Path;

use super::program::{Place, Said};

/// 64 voxels that are a cloth, in an NRRD with these fields beside the usual ones.
fn nrrd(place: &Place, name: &str, fields: &str) {
    let mut bytes =
        format!("NRRD0004\ntype: float\ndimension: 3\nsizes: 4 4 4\nencoding: raw\n{fields}\n\n")
            .into_bytes();
    for _ in 0..64 {
        bytes.extend(5.0f32.to_le_bytes());
    }
    std::fs::write(place.path(name), bytes).expect("written");
}

fn still<'a>(place: &Place, file: &'a str, more: &[&'a str]) -> Said {
    let mut arguments = vec![
        "still", file, "-o", "out.png", "--size", "16x12", "--spp", "1",
    ];
    arguments.extend(more);
    place.run(&arguments)
}

/// Pixels a metre of the picture, which tell how wide the volume is.
fn scale(place: &Place) -> Option<u32> {
    let bytes = std::fs::read(place.path("out.png")).expect("a picture");
    let at = bytes.windows(4).position(|word| word == b"pHYs")?;
    let number = bytes.get(at + 4..at + 8)?.try_into().ok()?;
    Some(u32::from_be_bytes(number))
}

#[test]
fn case_21_threads_are_bounded_as_crossings_are() {
    let place = Place::of("21");
    for command in ["check", "synthesize"] {
        let said = place.run(&[command, "big_5000000x1.ron"]).refused();
        assert!(said.contains("the most is 1048576 either way"), "{said}");
    }
    let text = std::fs::read_to_string(place.path("big_5000000x1.ron")).expect("a design");
    std::fs::write(place.path("long.ron"), text.replace("5000000", "1000000")).expect("written");
    // Within the limit the memory is asked for.
    let mut command = place.command(&["check", "long.ron"]);
    let said = Said::of(
        command
            .env("PICKGLASS_MEMORY", "100M")
            .output()
            .expect("runs"),
    )
    .refused();
    assert!(said.contains("of memory would be needed"), "{said}");
    place.run(&["check", "long.ron"]).done();
}

#[cfg(unix)]
#[test]
fn case_21_no_file_of_a_volume_is_written_over() {
    let place = Place::of("21");
    let volume = [
        "volume", "default", "-o", "v.vol", "--region", "0,0,2,2", "--level", "3",
    ];
    place.run(&volume).done();
    for (input, part) in [
        ("v.vol", "v.sggx.vol"),
        ("v.vol", "v.albedo.vol"),
        ("head.nhdr", "head.raw"),
    ] {
        let link = place.path("out.png");
        let _ = std::fs::remove_file(&link);
        std::os::unix::fs::symlink(part, &link).expect("a link");
        let before = std::fs::read(place.path(part)).expect("a part");
        let said = still(&place, input, &[]).refused();
        assert!(said.contains("would destroy it"), "{said}");
        assert_eq!(std::fs::read(place.path(part)).expect("a part"), before);
        std::fs::remove_file(&link).expect("removed");
        still(&place, input, &[]).done();
    }
}

#[test]
fn case_21_units_hold_beside_directions_too() {
    let place = Place::of("21");
    let directions =
        |edge: &str| format!("space directions: ({edge},0,0) (0,{edge},0) (0,0,{edge})");
    let space = "endian: little\nspace dimension: 3\n";
    nrrd(&place, "mm.nrrd", &format!("{space}{}", directions("0.1")));
    still(&place, "mm.nrrd", &[]).done();
    let wanted = scale(&place);
    let micrometres = format!("{space}{}\nunits: \"um\" \"um\" \"um\"", directions("100"));
    nrrd(&place, "um.nrrd", &micrometres);
    let said = still(&place, "um.nrrd", &[]).done();
    assert!(wanted.is_some() && scale(&place) == wanted, "{said:?}");
    // Control: without the unit it is another size.
    nrrd(&place, "no.nrrd", &format!("{space}{}", directions("100")));
    still(&place, "no.nrrd", &[]).done();
    assert_ne!(scale(&place), wanted);
    let both = format!("{micrometres}\nspace units: \"mm\" \"mm\" \"mm\"");
    nrrd(&place, "both.nrrd", &both);
    let said = still(&place, "both.nrrd", &[]).done();
    assert!(
        said.err.contains("units are not its space units"),
        "{said:?}"
    );
}

#[test]
fn case_21_fields_that_contradict_each_other_are_told_or_refused() {
    let place = Place::of("21");
    let spacings = "spacings: 0.1 0.1 0.1";
    for (fields, told) in [
        (format!("{spacings}\nendian: middle"), "endian is middle"),
        (
            format!("{spacings}\nendian: little\nspacings: 0.2 0.2 0.2"),
            "spacings stands there twice",
        ),
    ] {
        nrrd(&place, "a.nrrd", &fields);
        let said = still(&place, "a.nrrd", &[]).refused();
        assert!(said.contains(told), "{said}");
    }
    let directions = "endian: little\nspace dimension: 3\n\
                      space directions: (0.1,0,0) (0,0.1,0) (0,0,0.1)";
    for (fields, told) in [
        (spacings.to_owned(), "does not say its endian"),
        (
            format!("{directions}\nspacings: 0.5 0.5 0.5"),
            "spacings stand beside space directions",
        ),
        (
            format!("{directions}\naxis mins: 1 2 3"),
            "axis mins stand beside space directions",
        ),
        (
            format!("{spacings}\nendian: little\naxis mins: 1e6 0 0"),
            "taking it to begin at 0",
        ),
    ] {
        nrrd(&place, "a.nrrd", &fields);
        let said = still(&place, "a.nrrd", &[]).done();
        assert!(said.err.contains(told), "{said:?}");
    }
    // Controls: what agrees is not remarked on.
    for fields in [
        format!("{spacings}\nendian: little"),
        format!("{directions}\n{spacings}"),
    ] {
        nrrd(&place, "a.nrrd", &fields);
        let said = still(&place, "a.nrrd", &[]).done();
        let told = ["endian", "stand beside", "begin at 0"].map(|part| said.err.contains(part));
        assert_eq!(told, [false; 3], "{said:?}");
    }
    for (file, names) in [
        (
            "ends.mhd",
            ["ElementByteOrderMSB", "BinaryDataByteOrderMSB"],
        ),
        ("twoorg.mhd", ["Offset", "Position"]),
    ] {
        let said = still(&place, file, &[]).refused();
        assert!(names.iter().all(|name| said.contains(name)), "{said}");
    }
}

#[test]
fn case_21_options_that_say_nothing_here_are_refused_by_name() {
    let place = Place::of("21");
    let volume: [&[&str]; 9] = [
        &["--sett", "20"],
        &["--backing", "self"],
        &["--colourway", "x"],
        &["--as", "weave"],
        &["--mirror"],
        &["--face-down"],
        &["--set", "level=1"],
        &["--set", "rank=3"],
        &["--effects", "+hairs"],
    ];
    for more in volume {
        let said = still(&place, "head.nhdr", more).refused();
        assert!(said.contains(more[0]), "{said}");
        assert!(!place.path("out.png").exists());
    }
    for input in ["plain_twill.wif", "denim"] {
        for more in [&["--mirror"][..], &["--key", "index"], &["--face-down"]] {
            let mut arguments = vec!["convert", input, "b.png"];
            arguments.extend(more);
            let said = place.run(&arguments).refused();
            assert!(said.contains(more[0]) && said.contains(input), "{said}");
            let said = place.run(&[&["check", input], more].concat()).refused();
            assert!(said.contains(more[0]), "{said}");
        }
        // What is written follows these.
        place
            .run(&[
                "convert", input, "b.png", "--origin", "top-left", "--black", "weft",
            ])
            .done();
        let said = place.run(&["convert", input, "b.wif", "--out-black", "weft"]);
        assert!(said.refused().contains("--out-black"));
        let said = place.run(&["check", input, "--origin", "top-left"]);
        assert!(said.refused().contains("--origin"));
    }
    // An image is read by them.
    place.run(&["check", "b.png", "--mirror"]).done();
    place.run(&["check", "b.png", "--as", "weave"]).done();
}

#[test]
fn case_21_what_lies_behind_the_colours_and_is_no_alpha_is_left_out() {
    let place = Place::of("21");
    let arguments = [
        "posterize",
        "half_unspec.tif",
        "-o",
        "q.ron",
        "--colours",
        "3",
    ];
    place.run(&arguments).done();
}

#[test]
fn case_21_fields_that_a_design_does_not_have_are_told() {
    let place = Place::of("21");
    let said = place.run(&["convert", "unk.ron", "a.wif"]).done();
    assert!(said.err.contains("design.wickedfield"), "{said:?}");
    let text = std::fs::read_to_string(place.path("unk.ron")).expect("a design");
    std::fs::write(
        place.path("known.ron"),
        text.replace("wickedfield: 3, ", ""),
    )
    .expect("written");
    let said = place.run(&["convert", "known.ron", "a.wif"]).done();
    assert!(!said.err.contains("left out"), "{said:?}");
}

#[test]
fn case_21_exported_threads_have_the_numbers_of_the_file() {
    let place = Place::of("21");
    let arguments = ["volume", "denim", "-o", "a.obj", "--region", "0,0,2,3"];
    place.run(&arguments).done();
    let text = std::fs::read_to_string(place.path("a.obj")).expect("a mesh");
    let mut names: Vec<&str> = text
        .lines()
        .filter_map(|line| line.strip_prefix("o "))
        .collect();
    names.sort_unstable();
    names.dedup();
    assert!(
        names.contains(&"end_1") && names.contains(&"pick_3"),
        "{names:?}"
    );
    assert!(!names.iter().any(|name| name.ends_with("_0")), "{names:?}");
}

#[test]
fn case_21_names_with_line_breaks_are_refused() {
    let place = Place::of("21");
    let name = "a\nx.obj";
    let said = place
        .run(&["volume", "denim", "-o", name, "--region", "0,0,1,1"])
        .refused();
    assert!(said.contains("line break"), "{said}");
    assert!(!Path::new(&place.path(name)).exists());
}
