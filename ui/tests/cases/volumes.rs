//! Volumes of tests/cases/10 and 20: files with their voxels elsewhere, names of exported
//! scenes, levels and lookups.

use std::path::Path;

use super::case_04::picture;
use super::program::{Place, Said};

#[test]
fn case_10_voxels_behind_the_head_and_heads_beside_the_voxels_are_read() {
    let place = Place::of("10");
    let plain = picture(&Place::of("04"), "plain.mhd");
    assert!(picture(&place, "local.mha") == plain);
    assert!(picture(&place, "head.nhdr") == plain);
}

#[test]
fn case_10_volumes_given_for_a_design_are_called_volumes() {
    let place = Place::of("10");
    for (file, name) in [
        ("local.mha", "MetaImage"),
        ("head.nhdr", "NRRD"),
        ("zero-box.vol", "Mitsuba"),
    ] {
        let said = place.run(&["check", file]).refused();
        assert!(said.contains(name) && said.contains("still"), "{said}");
    }
}

#[test]
fn case_10_a_pattern_of_files_is_refused_with_its_cause_once() {
    let place = Place::of("10");
    let said = place
        .run(&["still", "pattern.mhd", "-o", "a.png"])
        .refused();
    assert!(
        said.contains("ElementDataFile") && !said.contains("os error"),
        "{said}"
    );
    for (file, line) in [
        ("a.mhd", "ElementDataFile = gone.raw"),
        ("a.nhdr", "data file: gone.raw"),
    ] {
        let like = if file == "a.mhd" {
            "pattern.mhd"
        } else {
            "head.nhdr"
        };
        let text = std::fs::read_to_string(place.path(like)).expect("read");
        let text = text.replace("ElementDataFile = slice_%03d.raw 0 3 1", line);
        let text = text.replace("data file: head.raw", line);
        std::fs::write(place.path(file), text).expect("written");
        let said = place.run(&["still", file, "-o", "a.png"]).refused();
        assert_eq!(said.matches("os error").count(), 1, "{said}");
    }
}

#[test]
fn case_10_a_box_of_no_size_is_said_in_mm() {
    let place = Place::of("10");
    let said = place
        .run(&["still", "zero-box.vol", "-o", "a.png"])
        .refused();
    assert!(
        said.contains("(0, 0, 0) mm") && !said.contains("Vec3"),
        "{said}"
    );
}

/// Exports a few crossings, and says which files there are.
fn export(place: &Place, name: &str, level: &str) -> Vec<String> {
    let arguments = [
        "volume", "default", "-o", name, "--region", "0,0,2,2", "--level", level, "--json",
    ];
    let report = place.run(&arguments).done().json();
    let files = report["files"].as_array().expect("files");
    files
        .iter()
        .map(|file| file.as_str().expect("a name").to_owned())
        .collect()
}

/// The files that a scene names.
fn named(scene: &str) -> Vec<&str> {
    let parts = scene.split("name=\"filename\" value=\"").skip(1);
    parts.filter_map(|part| part.split('"').next()).collect()
}

#[test]
fn case_20_scenes_name_the_files_beside_them_for_any_ending() {
    let place = Place::of("20");
    for name in ["B.VOL", "a.volt.vol", "two words.Vol", "\u{200b}é.vol"] {
        let files = export(&place, name, "3");
        let xml = Path::new(name).with_extension("xml");
        let scene = std::fs::read_to_string(place.path(&xml.to_string_lossy())).expect("a scene");
        let named = named(&scene);
        assert!(named.len() >= 3, "{name}: {named:?}");
        for file in named {
            assert!(place.path(file).is_file(), "{name}: {file}");
            assert!(
                files.iter().any(|written| written == file),
                "{name}: {file}"
            );
        }
        assert!(scene.contains("<path value=\".\"/>"), "{name}");
        let python = place.path(&Path::new(name).with_extension("py").to_string_lossy());
        let python = std::fs::read_to_string(python).expect("a script");
        assert!(python.is_ascii() && !python.contains("u{"), "{python}");
    }
}

#[test]
fn case_20_names_that_a_scene_cannot_say_are_refused_before_anything_is_written() {
    let place = Place::of("20");
    for name in ["a$spp.vol", "a\u{1}.vol"] {
        let arguments = [
            "volume", "default", "-o", name, "--region", "0,0,2,2", "--level", "3",
        ];
        let said = place.run(&arguments).refused();
        assert!(said.contains("choose another name"), "{said}");
        assert!(!place.path(name).exists(), "{name}");
    }
    // Other formats have no scene.
    export(&place, "a$spp.nrrd", "3");
}

#[test]
fn case_20_a_level_that_is_no_coarser_is_refused() {
    let place = Place::of("20");
    export(&place, "a.vol", "3");
    let arguments = [
        "volume", "default", "-o", "b.vol", "--region", "0,0,2,2", "--level", "4",
    ];
    let said = place.run(&arguments).refused();
    assert!(
        said.contains("level 4") && said.contains("choose level 3"),
        "{said}"
    );
    // A level below differs.
    export(&place, "c.vol", "2");
    let size = |name: &str| std::fs::metadata(place.path(name)).expect("a file").len();
    assert!(size("c.vol") > size("a.vol"));
    let arguments = [
        "still", "default", "-o", "a.png", "--size", "16x16", "--spp", "1", "--set", "level=4",
        "--json",
    ];
    let report = place.run(&arguments).done().json();
    assert_eq!(report["level"], 3);
    assert!(
        report["warnings"][0]
            .as_str()
            .expect("a warning")
            .contains("level 4"),
        "{report}"
    );
}

#[test]
fn case_20_a_volume_is_looked_up_as_its_scene_says() {
    let place = Place::of("20");
    export(&place, "v.vol", "3");
    let scene = std::fs::read_to_string(place.path("v.xml")).expect("a scene");
    assert_eq!(
        scene
            .matches("name=\"filter_type\" value=\"nearest\"")
            .count(),
        3
    );
    let tap = |effects: &str| {
        let arguments = [
            "still",
            "v.vol",
            "-o",
            "a.png",
            "--size",
            "32x32",
            "--spp",
            "4",
            "--set",
            "denoise=off",
            "--effects",
            effects,
            "--json",
        ];
        let report = place.run(&arguments).done().json();
        let effects = report["effects"].as_array().expect("effects").clone();
        let tap = effects.into_iter().find(|effect| effect["name"] == "tap");
        let on = tap.expect("the effect")["on"].as_bool().expect("a switch");
        (on, std::fs::read(place.path("a.png")).expect("a picture"))
    };
    let (usual, picture) = tap("auto");
    let (off, nearest) = tap("-tap");
    let (on, filtered) = tap("+tap");
    assert!(!usual && !off && on);
    let pixels = |bytes: &[u8]| {
        image::load_from_memory(bytes)
            .expect("a picture")
            .into_rgba8()
    };
    assert!(pixels(&picture) == pixels(&nearest));
    assert!(pixels(&picture) != pixels(&filtered));
}

#[test]
fn case_15_volumes_ask_for_memory_before_they_are_read() {
    let place = Place::of("10");
    let head = "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 256 256 256\nencoding: raw\n\
                spacings: 0.01 0.01 0.01\ndata file: voxels.raw\n";
    std::fs::write(place.path("a.nhdr"), head).expect("written");
    let still = |voxels: u8, memory: &str| {
        std::fs::write(place.path("voxels.raw"), vec![voxels; 1 << 24]).expect("written");
        let arguments = [
            "still", "a.nhdr", "-o", "a.png", "--size", "8x8", "--spp", "1",
        ];
        let mut command = place.command(&arguments);
        let output = command.env("PICKGLASS_MEMORY", memory).output();
        Said::of(output.expect("the program starts"))
    };
    let said = still(1, "100M").refused();
    assert!(
        said.contains("a.nhdr") && said.contains("PICKGLASS_MEMORY"),
        "{said}"
    );
    // Empty voxels take none, and more memory does.
    still(0, "100M").done();
    still(1, "300M").done();
}
