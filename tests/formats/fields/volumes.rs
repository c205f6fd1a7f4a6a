//! Files of volumes with a field and without it.

use std::fs;
use std::path::Path;

use glam::UVec3;
use pickglass::formats::field_table::Field;
use pickglass::formats::volume;
use pickglass::job::Job;
use pickglass::render::Medium;
use pickglass::volume::Taps;

use super::{Outcome, Twins, Walker};

/// The formats of volumes.
pub fn walkers() -> [Walker; 3] {
    let walker = |format, twins, named| Walker {
        format,
        twins,
        read,
        named,
    };
    [
        walker("nrrd", nrrd as fn(&Path, &Field, &str) -> Twins, true),
        walker("mhd", meta_image, true),
        walker("vol", vol, false),
    ]
}

/// Sides, place and every voxel of a grid.
fn read(path: &Path) -> Outcome {
    let read = volume::read(path, Taps::Nearest, &Job::new());
    let file = read.map_err(|error| error.to_string())?;
    let size = file.grid.size();
    let mut text = format!("{size} {:?}", Medium::bounds(&file.grid));
    for z in 0..size.z {
        for y in 0..size.y {
            for x in 0..size.x {
                text += &format!(" {:?}", file.grid.cell(UVec3::new(x, y, z)));
            }
        }
    }
    Ok((text, file.warnings))
}

/// 4 × 3 × 2 different numbers, the first of which holds the byte of a line feed, and some
/// more; `from` tells files apart.
fn numbers(count: usize, from: f32) -> Vec<u8> {
    let first = f32::from_le_bytes([0, b'\n', 0x80, 0x3f]);
    let rest = (1..count + 8).map(|k| from + 0.25 * k as f32);
    let all = std::iter::once(first).chain(rest);
    all.flat_map(f32::to_le_bytes).collect()
}

/// Lines of a head with another for a field: in place of the line that has its name, else
/// before the last.
fn with(lines: &[&str], line: &str, name: &str, between: &str) -> Vec<String> {
    let mut lines: Vec<String> = lines.iter().map(|line| (*line).to_owned()).collect();
    let is_it = |old: &String| old.split(between).next().map(str::trim) == Some(name);
    match lines.iter().position(is_it) {
        Some(at) => lines[at] = line.to_owned(),
        None => lines.insert(lines.len() - 1, line.to_owned()),
    }
    lines
}

const PLAIN: [&str; 6] = [
    "type: float",
    "dimension: 3",
    "sizes: 4 3 2",
    "endian: little",
    "spacings: 0.1 0.2 0.3",
    "encoding: raw",
];
/// Without spacings, which would win.
const RANGES: [&str; 7] = [
    "type: float",
    "dimension: 3",
    "sizes: 4 3 2",
    "endian: little",
    "axis mins: 0 0 0",
    "axis maxs: 1 1 1",
    "encoding: raw",
];
const SPACED: [&str; 7] = [
    "type: float",
    "dimension: 3",
    "sizes: 4 3 2",
    "space dimension: 3",
    "space origin: (0.5,0.5,0.5)",
    "space directions: (0.1,0,0) (0,0.2,0) (0,0,0.3)",
    "encoding: raw",
];
const MATRICES: [&str; 6] = [
    "type: float",
    "dimension: 4",
    "sizes: 6 4 3 2",
    "endian: little",
    "kinds: vector domain domain domain",
    "encoding: raw",
];

fn nrrd(folder: &Path, field: &Field, name: &str) -> Twins {
    let lines: &[&str] = match field.name {
        "axis mins" | "axis maxs" | "centerings" => &RANGES,
        field if field.starts_with("space") || field == "measurement frame" => &SPACED,
        _ => &PLAIN,
    };
    let put = |path: &Path, lines: &[String], voxels: &[u8]| {
        let head = format!("NRRD0005\n{}\n\n", lines.join("\n"));
        fs::write(path, [head.as_bytes(), voxels].concat()).expect("written");
    };
    let line = format!("{name}: {}", field.example);
    fs::write(folder.join("other.raw"), numbers(24, 50.0)).expect("written");
    let twins = Twins {
        with: folder.join("with.nrrd"),
        without: folder.join("without.nrrd"),
    };
    let plain: Vec<String> = lines.iter().map(|line| (*line).to_owned()).collect();
    let given = with(lines, &line, name, ":");
    if field.example.starts_with("3D-symmetric-matrix") {
        // What is said of matrices is said in the file of the matrices.
        let matrices: Vec<String> = MATRICES.iter().map(|line| (*line).to_owned()).collect();
        let given = with(&MATRICES, &line, name, ":");
        put(&twins.with, &plain, &numbers(24, 5.0));
        put(&twins.without, &plain, &numbers(24, 5.0));
        put(&folder.join("with.sggx.nrrd"), &given, &numbers(144, 0.5));
        put(
            &folder.join("without.sggx.nrrd"),
            &matrices,
            &numbers(144, 0.5),
        );
        return twins;
    }
    put(&twins.with, &given, &numbers(24, 5.0));
    put(&twins.without, &plain, &numbers(24, 5.0));
    twins
}

const HEAD: [&str; 7] = [
    "ObjectType = Image",
    "NDims = 3",
    "DimSize = 4 3 2",
    "ElementType = MET_FLOAT",
    "Offset = 0.5 0.5 0.5",
    "ElementSpacing = 0.1 0.2 0.3",
    "ElementDataFile = voxels.raw",
];
/// Without a spacing, which would win.
const SIZED: [&str; 6] = [
    "ObjectType = Image",
    "NDims = 3",
    "DimSize = 4 3 2",
    "ElementType = MET_FLOAT",
    "ElementSize = 0.1 0.2 0.3",
    "ElementDataFile = voxels.raw",
];

fn meta_image(folder: &Path, field: &Field, name: &str) -> Twins {
    let lines: &[&str] = match field.name {
        "ElementSize" => &SIZED,
        _ => &HEAD,
    };
    for (file, from) in [("voxels.raw", 5.0), ("other.raw", 50.0)] {
        fs::write(folder.join(file), numbers(24, from)).expect("written");
    }
    let line = format!("{name} = {}", field.example);
    // Another name of what the head says already is refused beside it.
    let unplaced: Vec<&str> = (lines.iter().copied())
        .filter(|line| !line.starts_with("Offset"))
        .collect();
    let lines: &[&str] = match field.name {
        "Position" | "Origin" => &unplaced,
        _ => lines,
    };
    let twins = Twins {
        with: folder.join("with.mhd"),
        without: folder.join("without.mhd"),
    };
    let given = with(lines, &line, name, "=").join("\n") + "\n";
    // Voxels behind the head are there for the head that says so.
    let given = [given.as_bytes(), &numbers(24, 20.0)].concat();
    fs::write(&twins.with, given).expect("written");
    fs::write(&twins.without, lines.join("\n")).expect("written");
    twins
}

fn vol(folder: &Path, field: &Field, _: &str) -> Twins {
    let whole = |bytes: &mut Vec<u8>, numbers: &[i32]| {
        bytes.extend(numbers.iter().flat_map(|number| number.to_le_bytes()));
    };
    let file = |field: &str, example: &str| {
        let given: Vec<i32> = example.split(' ').filter_map(|n| n.parse().ok()).collect();
        let or = |name: &str, usual: &[i32]| {
            if field == name {
                given.clone()
            } else {
                usual.to_vec()
            }
        };
        let mut bytes = b"VOL".to_vec();
        bytes.push(or("version", &[3])[0] as u8);
        whole(&mut bytes, &or("encoding", &[1]));
        whole(&mut bytes, &or("size", &[4, 3, 2]));
        whole(&mut bytes, &or("channels", &[1]));
        let corners = or("box", &[0, 0, 0, 4, 3, 2]);
        bytes.extend(
            corners
                .iter()
                .flat_map(|&corner| (corner as f32).to_le_bytes()),
        );
        bytes.extend(numbers(24, 5.0));
        bytes
    };
    let twins = Twins {
        with: folder.join("with.vol"),
        without: folder.join("without.vol"),
    };
    fs::write(&twins.with, file(field.name, field.example)).expect("written");
    fs::write(&twins.without, file("", "")).expect("written");
    twins
}
