//! Every format read by programs of others, voxel for voxel; a changed voxel is noticed.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::volume_sources::{Rule, python, write_truth};
use glam::UVec3;
use pickglass::formats::{volume, yarns};
use pickglass::job::Job;
use pickglass::presets;
use pickglass::yarn::tubes::tubes;

/// Odd sides: no leaf, tile or page is full.
const SIZE: UVec3 = UVec3::new(37, 21, 13);

/// Whether a test cannot be run; with `GOLDEN_REQUIRED` that is a failure.
fn skipped(what: &str) {
    assert!(
        std::env::var_os("GOLDEN_REQUIRED").is_none(),
        "{what} is required: run tests/run.sh"
    );
    println!("not run: no {what}; run tests/run.sh");
}

/// Exit code of a reader on a file: 0 agrees, 1 differs; `None` where it is not there.
fn reads(python: &Path, reader: &str, file: &Path, truth: &str) -> Option<i32> {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/peers/volumes.py");
    let output = Command::new(python)
        .arg(script)
        .arg(reader)
        .arg(file)
        .arg(truth)
        .output()
        .expect("python runs");
    print!("{}", String::from_utf8_lossy(&output.stdout));
    let code = output.status.code().expect("an exit code");
    if code > 1 && code != 3 {
        panic!("{reader}: {}", String::from_utf8_lossy(&output.stderr));
    }
    (code != 3).then_some(code)
}

/// Writes a rule's voxels and the same with one voxel changed, and lets a reader compare
/// both with what the rule says.
fn agrees_and_notices(python: Option<PathBuf>, reader: &str, ending: &str, rule: Rule) {
    let Some(python) = python else {
        return skipped(reader);
    };
    let folder = tempfile::tempdir().expect("a folder");
    let truth = folder.path().join("truth");
    write_truth(&truth, &rule);
    let truth = truth.to_str().expect("a name").to_owned();
    let size = rule.frame.size;
    let right = folder.path().join(format!("right.{ending}"));
    volume::write(&rule, &right, &[], &Job::new()).expect("written");
    let changed = Rule {
        changed: Some(size - UVec3::new(2, 3, 4)),
        ..rule
    };
    let other = folder.path().join(format!("other.{ending}"));
    volume::write(&changed, &other, &[], &Job::new()).expect("written");
    match reads(&python, reader, &right, &truth) {
        None => return skipped(reader),
        Some(code) => assert_eq!(code, 0, "{reader} reads something else"),
    }
    println!("control, must differ:");
    let control = reads(&python, reader, &other, &truth);
    assert_eq!(control, Some(1), "{reader} does not notice a changed voxel");
}

fn system_python() -> Option<PathBuf> {
    Some(PathBuf::from("/usr/bin/python3")).filter(|path| path.exists())
}

fn mitsuba_python() -> Option<PathBuf> {
    let named = std::env::var_os("PICKGLASS_MITSUBA_PYTHON").map(PathBuf::from);
    named.filter(|path| path.exists()).or_else(python)
}

#[test]
fn pynrrd_reads_nrrd() {
    agrees_and_notices(python(), "pynrrd", "nrrd", Rule::new(SIZE));
}

#[test]
fn simpleitk_reads_nrrd() {
    agrees_and_notices(python(), "simpleitk", "nrrd", Rule::new(SIZE));
}

#[test]
fn simpleitk_reads_meta_image() {
    agrees_and_notices(python(), "simpleitk", "mhd", Rule::new(SIZE));
}

#[test]
fn tifffile_reads_a_stack() {
    agrees_and_notices(python(), "tifffile", "tif", Rule::new(SIZE));
}

#[test]
fn mitsuba_reads_vol() {
    agrees_and_notices(mitsuba_python(), "mitsuba", "vol", Rule::new(SIZE));
}

#[test]
fn openvdb_reads_vdb() {
    agrees_and_notices(system_python(), "openvdb", "vdb", Rule::new(SIZE));
}

#[test]
fn openvdb_reads_vdb_of_several_nodes() {
    // Several lower nodes along each axis and two upper nodes along x, mostly empty.
    let rule = Rule {
        filled: 1,
        ..Rule::new(UVec3::new(4105, 135, 9))
    };
    agrees_and_notices(system_python(), "openvdb", "vdb", rule);
}

#[test]
fn an_empty_vdb_is_one_too() {
    let rule = Rule {
        filled: 0,
        ..Rule::new(SIZE)
    };
    agrees_and_notices(system_python(), "openvdb", "vdb", rule);
}

/// Runs a program of OpenVDB's; `None` where it is not there.
fn tool(name: &str, arguments: &[&Path]) -> Option<String> {
    let output = match Command::new(name).args(arguments).output() {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
            skipped(name);
            return None;
        }
        output => output.expect("it runs"),
    };
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    let errors = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{name}: {said}{errors}");
    Some(said + &errors)
}

#[test]
fn openvdb_s_own_programs_take_vdb() {
    let folder = tempfile::tempdir().expect("a folder");
    let rule = Rule::new(SIZE);
    let path = folder.path().join("cloth.vdb");
    volume::write(&rule, &path, &[], &Job::new()).expect("written");
    let long = Path::new("-l");
    let Some(said) = tool("vdb_print", &[long, &path]) else {
        return;
    };
    for word in [
        "density",
        "direction",
        "albedo",
        "roughness",
        "yarn",
        "fog volume",
    ] {
        assert!(said.contains(word), "{word} is not in\n{said}");
    }
    let nano = folder.path().join("cloth.nvdb");
    if tool("nanovdb_convert", &[&path, &nano]).is_none() {
        return;
    }
    if let Some(said) = tool("nanovdb_validate", &[&nano]) {
        assert!(!said.to_lowercase().contains("invalid"), "{said}");
    }
}

#[test]
fn yarns_become_about_as_large_as_was_said() {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, ends, picks) in [("default", 5, 6), ("denim", 40, 30)] {
        let design = presets::design(name).expect("there").expect("sound");
        let tubes = tubes(&design, 0..ends, 0..picks).expect("laid");
        for ending in ["glb", "obj"] {
            let path = folder.path().join(format!("{name}.{ending}"));
            let said = yarns::about_bytes(&tubes, &path) as f64;
            let files = yarns::write(&design, &tubes, &path, &Job::new()).expect("written");
            let bytes: u64 = files.iter().map(|file| file.1).sum();
            assert!((said / bytes as f64 - 1.0).abs() < 0.1, "{said} of {bytes}");
        }
        assert_eq!(yarns::about_bytes(&tubes, folder.path()), 0);
    }
}

#[test]
fn trimesh_reads_closed_tubes() {
    let Some(python) = python() else {
        return skipped("trimesh");
    };
    let design = presets::design("default").expect("there").expect("sound");
    let tubes = tubes(&design, -2..5, 3..9).expect("laid");
    assert_eq!(tubes.len(), 13);
    for ending in ["glb", "obj"] {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join(format!("yarns.{ending}"));
        yarns::write(&design, &tubes, &path, &Job::new()).expect("written");
        match reads(&python, "trimesh", &path, "13") {
            None => return skipped("trimesh"),
            Some(code) => assert_eq!(code, 0),
        }
        assert_eq!(reads(&python, "trimesh", &path, "12"), Some(1));
    }
}
