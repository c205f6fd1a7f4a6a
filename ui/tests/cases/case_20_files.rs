//! What tests/cases/20 wants of the files that commands write: never one that is read, told
//! at once where they cannot be written, and kept when the work is interrupted.

use std::path::Path;
use std::process::Stdio;

use super::program::{Place, Said};

/// A folder with a weave in `w.png`.
fn place() -> Place {
    let place = Place::of("20");
    place.run(&["convert", "herringbone", "w.png"]).done();
    place
}

#[test]
fn an_output_that_is_an_input_is_refused_by_whatever_name() {
    let place = place();
    let weave = std::fs::read(place.path("w.png")).expect("the weave");
    for name in ["sky.exr", "x.mtl", "keep.ron", "like.jc5", "map.gif"] {
        std::fs::write(place.path(name), &weave).expect("a copy");
    }
    std::fs::hard_link(place.path("w.png"), place.path("hard.png")).expect("a link");
    let refused = [
        "still w.png -o w.png",
        "still w.png -o ./w.png",
        "still w.png -o hard.png",
        "still hard.png -o w.png",
        "still herringbone -o sky.exr --light sky.exr",
        "still herringbone -o w.png --warp-map w.png",
        "convert w.png w.png",
        "convert herringbone map.gif --weft-map map.gif",
        "convert herringbone like.jc5 --like like.jc5",
        "posterize w.png -o keep.ron --keep keep.ron",
        // Files beside the one that is named: the colours of an .obj.
        "volume x.mtl -o x.obj --region 0,0,4,4",
    ];
    for line in refused {
        let arguments: Vec<&str> = line.split(' ').collect();
        let said = place.run(&arguments);
        assert_eq!(said.code, Some(1), "{line}: {said:?}");
        assert!(said.err.contains("that is read"), "{line}: {said:?}");
    }
    for name in [
        "w.png", "hard.png", "sky.exr", "x.mtl", "keep.ron", "like.jc5", "map.gif",
    ] {
        let now = std::fs::read(place.path(name)).expect("still there");
        assert!(now == weave, "{name} is as it was");
    }
    assert!(!place.path("x.obj").exists());
    // Another file of the same name elsewhere, and an equal one, are written.
    place.run(&["convert", "w.png", "hard.tif"]).done();
    place.run(&["convert", "w.png", "sky.png"]).done();
    place.run(&["convert", "sky.png", "w.png"]).done();
}

#[cfg(unix)]
#[test]
fn links_are_followed_for_inputs_and_for_outputs() {
    use std::os::unix::fs::symlink;
    let place = place();
    let weave = std::fs::read(place.path("w.png")).expect("the weave");
    symlink("w.png", place.path("link.png")).expect("a link");
    for pair in [["w.png", "link.png"], ["link.png", "w.png"]] {
        let told = place.run(&["convert", pair[0], pair[1]]).refused();
        assert!(told.contains("that is read"), "{told}");
    }
    assert!(std::fs::read(place.path("w.png")).expect("still there") == weave);
    // A link to another file stays a link, and that file is written.
    symlink("far.wif", place.path("link.wif")).expect("a link");
    place.run(&["convert", "w.png", "link.wif"]).done();
    let link = std::fs::symlink_metadata(place.path("link.wif")).expect("the link");
    assert!(link.is_symlink() && place.path("far.wif").is_file());
}

#[cfg(target_os = "linux")]
#[test]
fn pipes_devices_and_folders_are_never_replaced() {
    use std::os::unix::fs::FileTypeExt;
    let place = place();
    let pipe = place.path("pipe.wif");
    let made = std::process::Command::new("mkfifo").arg(&pipe).status();
    assert!(made.expect("mkfifo runs").success());
    std::fs::create_dir(place.path("folder.wif")).expect("a folder");
    std::os::unix::fs::symlink("/dev/null", place.path("null.wif")).expect("a link");
    for name in ["pipe.wif", "folder.wif", "null.wif"] {
        let told = place.run(&["convert", "w.png", name]).refused();
        assert!(told.contains("name a file"), "{told}");
    }
    assert!(
        std::fs::metadata(&pipe)
            .expect("the pipe")
            .file_type()
            .is_fifo()
    );
}

#[cfg(target_os = "linux")]
#[test]
fn a_folder_that_cannot_be_written_is_told_before_the_work() {
    let place = place();
    // Nobody may make files here, root included. The work itself would take hours.
    let long = "still w.png -o /proc/o.png --size 4096x4096 --spp 1000000";
    let missing = "still w.png -o missing/o.png --size 4096x4096 --spp 1000000";
    let rest = [
        "convert w.png /proc/o.wif",
        "posterize w.png -o /proc/o.ron",
        "volume w.png -o /proc/o.vol",
        "volume w.png -o /proc/o.glb",
    ];
    for line in [long, missing].iter().chain(&rest) {
        let arguments: Vec<&str> = line.split(' ').collect();
        let told = place.run(&arguments).refused();
        assert!(told.contains("/o."), "{line}: {told}");
    }
}

#[test]
fn what_a_killed_program_left_is_swept_and_nothing_else() {
    let place = place();
    std::fs::write(place.path(".pickglass-dead.tmp"), b"half").expect("a file");
    std::fs::write(place.path(".mine.tmp"), b"whole").expect("a file");
    place.run(&["convert", "w.png", "w.wif"]).done();
    assert!(!place.path(".pickglass-dead.tmp").exists());
    assert!(place.path(".mine.tmp").exists());
}

/// Interrupts a long still of a small volume after a while and gives what it said.
#[cfg(unix)]
fn interrupted(place: &Place, millis: u64) -> Said {
    let volume = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/cases/07/slab.nrrd");
    let volume = volume.display().to_string();
    let long = [
        "still", &volume, "-o", "o.png", "--size", "16x12", "--spp", "1000000", "--json",
    ];
    let child = place
        .command(&long)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    std::thread::sleep(std::time::Duration::from_millis(millis));
    let id = child.id().to_string();
    let sent = std::process::Command::new("sh")
        .args(["-c", &format!("kill -INT {id}")])
        .status();
    assert!(sent.expect("a shell runs").success());
    Said::of(child.wait_with_output().expect("it ends"))
}

#[cfg(unix)]
#[test]
fn an_interrupted_still_is_written_as_far_as_it_is() {
    let place = Place::of("20");
    // Before the first pass there is nothing to keep, and that is said: wait longer.
    let said = [200, 800, 3200, 12_800].into_iter().find_map(|millis| {
        let said = interrupted(&place, millis);
        if said.code == Some(0) {
            return Some(said);
        }
        assert!(!place.path("o.png").exists(), "{said:?}");
        None
    });
    let report = said.expect("a picture").json();
    assert_eq!(report["interrupted"], true);
    let samples = report["spp"].as_u64().expect("samples");
    assert!((1..1_000_000).contains(&samples), "{samples}");
    let picture = std::fs::read(place.path("o.png")).expect("the picture");
    assert!(picture.starts_with(b"\x89PNG"));
}

#[test]
fn a_picture_larger_than_the_memory_is_refused_before_it_is_made() {
    let place = place();
    let sizes = ["16384x16384", "12000x12000"];
    for size in sizes {
        let line = [
            "still", "w.png", "-o", "o.png", "--size", size, "--spp", "1",
        ];
        let output = place.command(&line).env("PICKGLASS_MEMORY", "2G").output();
        let said = Said::of(output.expect("the program starts"));
        assert_eq!(said.code, Some(1), "{said:?}");
        assert!(said.err.contains("and 2.1 GB may be used"), "{said:?}");
    }
    // Parser and renderer agree on what is too large for any memory.
    let line = ["still", "w.png", "-o", "o.png", "--size", "16385x1"];
    let said = place.run(&line);
    assert_eq!(said.code, Some(2), "{said:?}");
    assert!(said.err.contains("16384"), "{said:?}");
}

#[test]
fn a_budget_that_is_no_size_is_told() {
    let output = Place::of("20")
        .command(&["weaves", "--json"])
        .env("PICKGLASS_MEMORY", "plenty")
        .output();
    let said = Said::of(output.expect("the program starts")).done();
    assert!(
        said.err.contains("PICKGLASS_MEMORY is \"plenty\""),
        "{said:?}"
    );
}

#[test]
fn a_cloth_that_ends_in_the_picture_is_told() {
    let place = place();
    let still = |mm: &str| {
        let line = format!("still w.png -o o.png --size 16x12 --spp 1 --set level=4 --mm {mm}");
        let arguments: Vec<&str> = line.split(' ').collect();
        place.run(&arguments).done().err
    };
    assert!(still("20000").contains("where it ends"));
    assert!(!still("200").contains("where it ends"));
}

#[test]
fn stills_have_no_pinholes_unless_asked_for() {
    let place = place();
    let clear = |more: &[&str]| {
        let mut line = vec![
            "still", "tweed", "-o", "o.png", "--size", "48x36", "--spp", "4",
        ];
        line.extend(["--set", "level=3", "--set", "denoise=off"]);
        line.extend(more);
        place.run(&line).done();
        let picture = image::open(place.path("o.png"))
            .expect("a picture")
            .into_rgba8();
        picture.pixels().filter(|pixel| pixel.0[3] < 255).count()
    };
    assert_eq!(clear(&[]), 0);
    assert!(clear(&["--backing", "none"]) > 0);
}

#[test]
fn seconds_bound_all_of_the_work_and_say_when_they_cannot() {
    let place = place();
    let cache = place.path("cache");
    let line = [
        "still",
        "w.png",
        "-o",
        "o.png",
        "--size",
        "8x6",
        "--seconds",
        "0.02",
    ];
    let output = place
        .command(&[&line[..], &["--set", "level=3", "--json"]].concat())
        .env("PICKGLASS_CACHE", &cache)
        .output();
    let said = Said::of(output.expect("the program starts")).done();
    let told = said.err.matches("takes longer than --seconds").count();
    assert_eq!(told, 1, "{said:?}");
    assert_eq!(said.json()["spp"], 1);
}

#[test]
fn exemplars_larger_than_the_memory_are_refused_before_they_are_made() {
    let place = place();
    let line = [
        "still", "tweed", "-o", "o.png", "--size", "8x6", "--spp", "1",
    ];
    let output = place
        .command(&line)
        .env("PICKGLASS_MEMORY", "64M")
        .env("PICKGLASS_CACHE", place.path("cache"))
        .output();
    let told = Said::of(output.expect("the program starts")).refused();
    assert!(told.contains("the exemplars of this cloth"), "{told}");
    assert!(!place.path("cache").exists());
}
