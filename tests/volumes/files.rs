//! Volumes out and in again, windows of the cloth, and everything that can go wrong.

#![allow(clippy::unwrap_used, reason = "a test may fail")]

use std::fs;
use std::path::Path;

use crate::cloth_scenes::{at_level, preset, weave};
use crate::volume_sources::{Rule, all, names};
use glam::{DVec3, UVec3, Vec3};
use pickglass::cloth::{ClothWindow, Part, Region, WindowError};
use pickglass::formats::volume::{self, Attachment, GridFile, VolumeFileError};
use pickglass::job::Job;
use pickglass::volume::Taps;
use pickglass::volume::source::{CellBox, Frame, SourceVoxel, VoxelSource};
use proptest::prelude::*;

const SIZE: UVec3 = UVec3::new(13, 9, 6);
const ENDINGS: [&str; 5] = ["vol", "vdb", "nrrd", "mhd", "tif"];
const READABLE: [&str; 3] = ["vol", "nrrd", "mhd"];

fn read(path: &Path) -> Result<GridFile, VolumeFileError> {
    volume::read(path, Taps::Nearest, &Job::new())
}

/// What is wrong with a grid that should hold a rule's voxels.
fn difference(file: &GridFile, rule: &Rule) -> Option<String> {
    let size = rule.frame.size;
    if file.grid.size() != size {
        return Some(format!("{} voxels", file.grid.size()));
    }
    for z in 0..size.z {
        for y in 0..size.y {
            for x in 0..size.x {
                let cell = UVec3::new(x, y, z);
                let (found, wanted) = (file.grid.cell(cell), rule.voxel(cell));
                if (found.sigma - wanted.sigma).abs() > 100.0 / 65535.0 {
                    return Some(format!("{cell}: {} for {}", found.sigma, wanted.sigma));
                }
                if wanted.sigma == 0.0 {
                    continue;
                }
                let albedo = file.grid.optics(found.optics).albedo;
                let wanted_albedo = rule.albedos[wanted.yarn as usize];
                if (albedo - wanted_albedo).abs().max_element() > 1e-3
                    || found.direction.dot(wanted.direction).abs() < 1.0 - 1e-4
                    || (found.alpha - wanted.alpha).abs() > 1e-3
                {
                    return Some(format!("{cell}: {found:?} for {wanted:?}"));
                }
            }
        }
    }
    None
}

#[test]
fn what_is_written_is_read_again() {
    for ending in READABLE {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(format!("cloth.{ending}"));
        let rule = Rule::new(SIZE);
        volume::write(&rule, &path, &[], &Job::new()).unwrap();
        let file = read(&path).unwrap();
        assert_eq!(difference(&file, &rule), None, "{ending}");
        assert!(file.warnings.is_empty(), "{:?}", file.warnings);
        // Negative control: one other voxel is noticed.
        let changed = Rule {
            changed: Some(UVec3::new(5, 6, 2)),
            ..rule
        };
        assert!(difference(&file, &changed).is_some(), "{ending}");
    }
}

#[test]
fn plans_say_the_bytes_that_are_written() {
    for ending in ENDINGS {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(format!("cloth.{ending}"));
        let rule = Rule::new(UVec3::new(70, 41, 33));
        let attached = [Attachment {
            path: folder.path().join("note.txt"),
            bytes: b"beside".to_vec(),
        }];
        let plan = volume::plan(&rule, &path, &attached).unwrap();
        let written = volume::write(&rule, &path, &attached, &Job::new()).unwrap();
        let on_disk: u64 = names(folder.path())
            .iter()
            .map(|name| fs::metadata(folder.path().join(name)).unwrap().len())
            .sum();
        assert_eq!(written.bytes, on_disk, "{ending}");
        assert_eq!(written.files.len(), names(folder.path()).len(), "{ending}");
        let ratio = plan.bytes() as f64 / on_disk as f64;
        let right = if plan.exact {
            ratio == 1.0
        } else {
            (0.8..1.25).contains(&ratio)
        };
        assert!(right, "{ending}: planned {} of {on_disk}", plan.bytes());
    }
}

#[test]
fn cancelling_leaves_nothing_behind() {
    for ending in ENDINGS {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(format!("cloth.{ending}"));
        fs::write(&path, "old").unwrap();
        let job = Job::new();
        let other = job.clone();
        // At the first report: voxels have been written, but not all is said.
        let job = job.with_listener(move |_, _| other.cancel());
        let done = volume::write(&Rule::new(SIZE), &path, &[], &job);
        assert!(
            matches!(done, Err(VolumeFileError::Cancelled(_))),
            "{ending}: {done:?}"
        );
        assert_eq!(
            names(folder.path()),
            [format!("cloth.{ending}")],
            "{ending}"
        );
        assert_eq!(fs::read(&path).unwrap(), b"old");
    }
}

#[test]
fn what_does_not_fit_is_refused_before_writing() {
    let folder = tempfile::tempdir().unwrap();
    for ending in ["vol", "vdb", "nrrd", "mhd"] {
        let path = folder.path().join(format!("cloth.{ending}"));
        let huge = Rule::new(UVec3::splat(1 << 20));
        let message = volume::plan(&huge, &path, &[]).unwrap_err().to_string();
        assert!(
            message.contains("disk has") && !message.contains('\n'),
            "{message}"
        );
    }
    let path = folder.path().join("cloth.tif");
    let message = volume::plan(&Rule::new(UVec3::splat(1 << 20)), &path, &[]);
    assert!(message.unwrap_err().to_string().contains("smaller region"));
    assert!(names(folder.path()).is_empty());
}

#[test]
fn folders_that_cannot_be_written_are_named() {
    let folder = tempfile::tempdir().unwrap();
    for ending in ENDINGS {
        let path = folder.path().join(format!("missing/cloth.{ending}"));
        let message = volume::write(&Rule::new(SIZE), &path, &[], &Job::new());
        let message = message.unwrap_err().to_string();
        assert!(message.contains("make its folder first"), "{message}");
    }
    let path = folder.path().join("cloth.xyz");
    let message = volume::write(&Rule::new(SIZE), &path, &[], &Job::new());
    assert!(message.unwrap_err().to_string().contains(".vdb"));
    assert!(names(folder.path()).is_empty());
}

/// The files of a small volume, by format.
fn written(ending: &str) -> (tempfile::TempDir, std::path::PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(format!("cloth.{ending}"));
    volume::write(&Rule::new(UVec3::new(5, 3, 2)), &path, &[], &Job::new()).unwrap();
    (folder, path)
}

/// An answer, or one line.
fn answers(path: &Path) -> bool {
    match read(path) {
        Ok(_) => true,
        Err(error) => {
            let line = error.to_string();
            assert!(!line.is_empty() && !line.contains('\n'), "{line:?}");
            false
        }
    }
}

#[test]
fn files_cut_off_anywhere_are_refused() {
    for ending in READABLE {
        let (folder, path) = written(ending);
        for name in names(folder.path()) {
            if name.contains("yarn") {
                continue;
            }
            let file = folder.path().join(&name);
            let whole = fs::read(&file).unwrap();
            // A MetaImage's head may lose its last line feed.
            let keep = usize::from(name.ends_with(".mhd"));
            for length in 0..whole.len() - keep {
                fs::write(&file, &whole[..length]).unwrap();
                assert!(!answers(&path), "{name} of {length} bytes was read");
            }
            fs::write(&file, &whole).unwrap();
            assert!(answers(&path), "{name}");
        }
    }
}

#[test]
fn what_is_missing_beside_a_volume_is_said() {
    let (folder, path) = written("vol");
    fs::remove_file(folder.path().join("cloth.albedo.vol")).unwrap();
    fs::remove_file(folder.path().join("cloth.sggx.vol")).unwrap();
    let file = read(&path).unwrap();
    assert_eq!(file.warnings.len(), 2, "{:?}", file.warnings);
    let some = (0..5).map(|x| file.grid.cell(UVec3::new(x, 0, 0)));
    let voxel = some.clone().find(|voxel| voxel.sigma > 0.0).unwrap();
    assert!((voxel.alpha - 1.0).abs() < 1e-6);
    assert_eq!(file.grid.optics(voxel.optics).albedo, Vec3::splat(0.8));
}

#[test]
fn files_of_different_windows_are_refused() {
    let (folder, path) = written("nrrd");
    let other = folder.path().join("other.nrrd");
    volume::write(&Rule::new(UVec3::new(5, 2, 3)), &other, &[], &Job::new()).unwrap();
    fs::rename(
        folder.path().join("other.sggx.nrrd"),
        folder.path().join("cloth.sggx.nrrd"),
    )
    .unwrap();
    assert!(
        read(&path)
            .unwrap_err()
            .to_string()
            .contains("written together")
    );
}

#[test]
fn bad_numbers_are_mended_and_counted() {
    let (folder, path) = written("vol");
    let mut bytes = fs::read(&path).unwrap();
    for (voxel, bad) in [f32::NAN, f32::INFINITY, -1.0, f32::NEG_INFINITY]
        .iter()
        .enumerate()
    {
        bytes[48 + voxel * 4..][..4].copy_from_slice(&bad.to_le_bytes());
    }
    fs::write(&path, bytes).unwrap();
    let file = read(&path).unwrap();
    // Infinite is opaque; the others are nothing.
    assert_eq!(file.grid.mended().extinctions, 3);
    for said in ["1 extinction was so large", "3 extinctions were negative"] {
        let told = file.warnings.iter().any(|line| line.starts_with(said));
        assert!(told, "{said}: {:?}", file.warnings);
    }
    let first = file.grid.cell(UVec3::new(1, 0, 0));
    assert!(
        first.sigma.is_finite() && first.sigma * 0.0125 > 13.0,
        "{first:?}"
    );
    drop(folder);
}

#[test]
fn a_head_that_asks_for_too_much_is_refused_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cloth.vol");
    let mut bytes = b"VOL\x03".to_vec();
    for number in [1, 1 << 19, 1 << 19, 1 << 19, 1] {
        bytes.extend(i32::to_le_bytes(number));
    }
    bytes.extend([0; 24]);
    fs::write(&path, &bytes).unwrap();
    let message = read(&path).unwrap_err().to_string();
    assert!(message.contains("more than can be read"), "{message}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn changed_bytes_give_an_answer(
        format in 0..READABLE.len(),
        changes in proptest::collection::vec((any::<u16>(), any::<u8>()), 1..6),
        heads in any::<bool>(),
    ) {
        let (folder, path) = written(READABLE[format]);
        for name in names(folder.path()) {
            let file = folder.path().join(name);
            let mut bytes = fs::read(&file).unwrap();
            let reach = if heads { bytes.len().min(300) } else { bytes.len() };
            for &(place, byte) in &changes {
                bytes[usize::from(place) % reach] = byte;
            }
            fs::write(&file, bytes).unwrap();
        }
        answers(&path);
    }

    #[test]
    fn random_heads_give_an_answer(lines in "((sizes|type|dimension|encoding|space directions|spacings|DimSize|ElementType|Offset|ElementSpacing|NDims): ?=? ?[0-9a-zA-Z,.() -]{0,24}\n){0,12}") {
        let folder = tempfile::tempdir().unwrap();
        let nrrd = folder.path().join("a.nrrd");
        fs::write(&nrrd, format!("NRRD0004\n{lines}\n\n0123456789")).unwrap();
        answers(&nrrd);
        let mhd = folder.path().join("a.mhd");
        fs::write(&mhd, lines.replace(": ", " = ")).unwrap();
        answers(&mhd);
    }
}

fn region(end: i64, pick: i64, ends: u32, picks: u32) -> Region {
    Region {
        end,
        pick,
        ends,
        picks,
    }
}

#[test]
fn a_window_is_what_the_cloth_is_at_its_voxels() {
    let cloth = weave(&preset("oxford"), at_level(2));
    let window = ClothWindow::new(&cloth, region(-1, 2, 3, 2), Part::Whole, None).unwrap();
    let Frame {
        size,
        origin_mm,
        edge_mm,
    } = window.frame();
    let voxels = all(&window);
    let (mut matter, mut differ) = (0u32, 0u32);
    let albedos = window.albedos();
    for (index, voxel) in voxels.iter().enumerate() {
        let index = index as u32;
        let cell = UVec3::new(
            index % size.x,
            index / size.x % size.y,
            index / (size.x * size.y),
        );
        let at = origin_mm + (cell.as_dvec3() + 0.5) * edge_mm;
        let there = cloth.voxel_at(at.as_vec3());
        matter += u32::from(voxel.sigma > 0.0);
        let same = voxel.sigma == there.sigma
            && (there.sigma == 0.0 || there.optics as i32 == voxel.yarn)
            && (there.sigma == 0.0 || (voxel.direction.dot(there.direction).abs() > 0.9999));
        differ += u32::from(!same);
        assert!(voxel.sigma == 0.0 || albedos.get(voxel.yarn as usize).is_some());
    }
    let share = f64::from(matter) / voxels.len() as f64;
    assert!(
        (0.1..0.9).contains(&share),
        "{share} of the voxels have matter"
    );
    // Places on the border of two of the cloth's voxels may round either way.
    assert!(
        differ < voxels.len() as u32 / 200,
        "{differ} of {} differ",
        voxels.len()
    );
    // Negative control: half a voxel further is something else.
    let aside = DVec3::splat(edge_mm);
    let moved = voxels.iter().enumerate().filter(|(index, voxel)| {
        let index = *index as u32;
        let cell = UVec3::new(
            index % size.x,
            index / size.x % size.y,
            index / (size.x * size.y),
        );
        let at = origin_mm + aside + (cell.as_dvec3() + 0.5) * edge_mm;
        cloth.voxel_at(at.as_vec3()).sigma != voxel.sigma
    });
    assert!(moved.count() > voxels.len() / 20);
}

#[test]
fn boxes_of_a_window_agree() {
    let cloth = weave(&preset("oxford"), at_level(2));
    for per_crossing in [None, Some(3)] {
        let window = ClothWindow::new(&cloth, region(0, 0, 3, 3), Part::Whole, per_crossing);
        let window = window.unwrap();
        let size = window.frame().size;
        let whole = all(&window);
        for cells in CellBox::tiles(size, UVec3::new(7, 5, 11)) {
            let mut part = vec![SourceVoxel::EMPTY; cells.voxels()];
            window.fill(cells, &mut part);
            for (place, voxel) in part.iter().enumerate() {
                let place = place as u32;
                let [nx, _, nz] = cells.size.to_array();
                let inside = UVec3::new(place % nx, place / (nx * nz), place / nx % nz);
                let at = cells.low + inside;
                let index = (at.z * size.y + at.y) * size.x + at.x;
                assert_eq!(*voxel, whole[index as usize], "{at}");
            }
        }
    }
}

#[test]
fn coarse_voxels_keep_the_matter() {
    let cloth = weave(&preset("oxford"), at_level(1));
    let mean = |per_crossing| {
        let window = ClothWindow::new(&cloth, region(0, 0, 4, 4), Part::Whole, per_crossing);
        let window = window.unwrap();
        let voxels = all(&window);
        let frame = window.frame();
        let sum: f64 = voxels.iter().map(|voxel| f64::from(voxel.sigma)).sum();
        // Extinction times height, over the area.
        sum * frame.edge_mm / f64::from(frame.size.x * frame.size.y)
    };
    let fine = mean(None);
    for per_crossing in [4, 8, 12] {
        let coarse = mean(Some(per_crossing));
        // Crossed fibres share a voxel: their mean is rounder, its √c below 1.
        assert!(
            (coarse / fine - 1.0).abs() < 0.1,
            "{per_crossing}: {coarse} for {fine}"
        );
    }
}

#[test]
fn windows_that_are_none_are_refused() {
    let cloth = weave(&preset("oxford"), at_level(4));
    let refused = |region, per_crossing| {
        let error = ClothWindow::new(&cloth, region, Part::Whole, per_crossing)
            .err()
            .unwrap();
        let line = error.to_string();
        assert!(!line.contains('\n'));
        error
    };
    assert!(matches!(
        refused(region(0, 0, 0, 4), None),
        WindowError::Empty(_)
    ));
    assert!(matches!(
        refused(region(i64::MIN, 0, 1, 4), None),
        WindowError::Far(_)
    ));
    assert!(matches!(
        refused(region(0, i64::MAX, 1, u32::MAX), None),
        WindowError::Far(_)
    ));
    assert!(matches!(
        refused(region(0, 0, 1, 1), Some(0)),
        WindowError::PerCrossing(0)
    ));
    let long = refused(region(0, 0, 900_000, 1), Some(1024));
    assert!(matches!(long, WindowError::Long(..)));
    // One crossing is a window, and so is its face.
    let one = ClothWindow::new(&cloth, region(7, 7, 1, 1), Part::Whole, Some(1)).unwrap();
    assert_eq!(one.frame().size.truncate(), glam::UVec2::ONE);
    let whole = ClothWindow::new(&cloth, region(0, 0, 2, 2), Part::Whole, Some(16)).unwrap();
    let face = ClothWindow::new(&cloth, region(0, 0, 2, 2), Part::Face, Some(16)).unwrap();
    assert!(face.frame().size.z < whole.frame().size.z);
    assert!(face.frame().origin_mm.z == 0.0);
}
