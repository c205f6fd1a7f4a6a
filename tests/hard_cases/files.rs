//! Files of every format that is read, damaged.

#![allow(clippy::unwrap_used, reason = "a test may fail")]

use std::path::{Path, PathBuf};

use crate::how_many;
use pickglass::formats::{LoadOptions, exr, load_bytes, photo, volume};
use pickglass::job::Job;
use pickglass::selftest::damaged;
use pickglass::volume::Taps;

/// What damage puts in.
const PIECES: [&[u8]; 8] = [
    b"\n[",
    b"=-1\n",
    b"99999999999999999999",
    b"\xff\xff\xff\xff",
    b"\0\0\0\0",
    b"((((",
    b"1e999,NaN",
    b"\x80\x00\x00\x7f",
];

/// A whole file of a folder: the folder, its name, its bytes.
type Whole = (PathBuf, String, Vec<u8>);

/// Files that are whole, of every kind that stands in the repository.
fn files() -> Vec<Whole> {
    let tests = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests");
    let in_folder = |folder: &Path| -> Vec<PathBuf> {
        let entries = std::fs::read_dir(folder).unwrap();
        entries.map(|entry| entry.unwrap().path()).collect()
    };
    let mut folders = in_folder(&tests.join("cases"));
    folders.extend([tests.join("fixtures"), tests.join("fixtures/looms")]);
    let mut files: Vec<Whole> = (folders.iter())
        .filter(|folder| folder.is_dir())
        .flat_map(|folder| in_folder(folder))
        .filter(|path| path.is_file())
        .map(|path| {
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            let folder = path.parent().unwrap().to_owned();
            (folder, name, std::fs::read(&path).unwrap())
        })
        .filter(|(_, _, bytes)| bytes.len() < 1 << 19)
        .collect();
    files.sort();
    assert!(files.len() > 60, "{}", files.len());
    files
}

/// What a reader says, where it is one line.
fn said<T>(answer: Result<T, impl std::fmt::Display>) -> bool {
    match answer {
        Ok(_) => true,
        Err(error) => {
            let error = error.to_string();
            assert_eq!(error.lines().count(), 1, "{error:?}");
            false
        }
    }
}

#[test]
fn damaged_files_of_every_reader_give_an_answer() {
    let files = files();
    let rounds = how_many(3, 10_000 / files.len() as u64 + 1);
    let job = Job::new();
    let (mut read, mut all) = ([0; 4], 0);
    for (number, (from, name, whole)) in files.iter().enumerate() {
        // A head finds the voxels beside it.
        let folder = tempfile::tempdir().unwrap();
        for (other, name, bytes) in &files {
            if other == from {
                std::fs::write(folder.path().join(name), bytes).unwrap();
            }
        }
        let path = folder.path().join(name);
        for round in 0..rounds {
            let bytes = damaged(whole, (number as u64) << 32 | round, &PIECES);
            std::fs::write(&path, &bytes).unwrap();
            let answers = [
                said(load_bytes(&bytes, name, &LoadOptions::default())),
                said(photo::read(&bytes, name)),
                said(exr::read_environment(&path)),
                said(volume::read(&path, Taps::Nearest, &job)),
            ];
            for (read, answer) in read.iter_mut().zip(answers) {
                *read += usize::from(answer);
            }
            all += 1;
        }
    }
    println!("of {all}: {read:?} designs, photographs, skies and volumes are read");
    assert!(read.iter().all(|read| *read > 0 && *read < all), "{read:?}");
}
