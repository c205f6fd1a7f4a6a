//! Every file of the collections of real drafts and images, as one table: read, read with
//! a warning, or refused, as its folder or name says.
//!
//! `cargo test --release --workspace --test formats collection -- --nocapture` prints it. The collections are
//! not part of the project; where they are absent this says so and passes, unless
//! `GOLDEN_REQUIRED=1` demands them.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

use std::path::{Path, PathBuf};

use pickglass::formats::{LoadOptions, load};

/// What becomes of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Fate {
    Read,
    Warned,
    /// A photograph: proposed for posterising.
    Picture,
    Refused,
}

/// A folder beside the project, or where a variable says; `None` after saying that it is
/// missing.
pub(crate) fn folder(variable: &str, beside: &str) -> Option<PathBuf> {
    let folder = std::env::var_os(variable).map_or_else(
        || Path::new(env!("CARGO_MANIFEST_DIR")).join(beside),
        PathBuf::from,
    );
    if folder.is_dir() {
        return Some(folder);
    }
    let required = std::env::var("GOLDEN_REQUIRED").is_ok_and(|value| value == "1");
    let shown = folder.display();
    assert!(!required, "nothing in {shown}: set {variable}");
    eprintln!("not run: nothing in {shown}");
    None
}

fn files(folder: &Path) -> Vec<PathBuf> {
    let (mut found, mut open) = (Vec::new(), vec![folder.to_owned()]);
    while let Some(folder) = open.pop() {
        for entry in std::fs::read_dir(&folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                open.push(path);
            } else if path.extension().is_none_or(|ending| ending != "md") {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}

/// What becomes of a file, and what is said about it.
fn fate(path: &Path) -> (Fate, String) {
    match load(path, &LoadOptions::default()) {
        Ok(found) => {
            let design = &found.design;
            let size = format!("{} × {}", design.ends(), design.picks());
            match found.warnings.first() {
                None => (Fate::Read, size),
                Some(warning) => (Fate::Warned, format!("{size}; {warning}")),
            }
        }
        Err(error) => {
            let line = error.to_string();
            assert_eq!(line.lines().count(), 1, "{line}");
            let name = path.file_name().unwrap().to_string_lossy();
            assert!(line.contains(&*name), "names the file: {line}");
            let line = line.replace(&path.display().to_string(), "");
            let picture = line.contains("posterize");
            (
                if picture {
                    Fate::Picture
                } else {
                    Fate::Refused
                },
                line,
            )
        }
    }
}

/// What the collection's notes say of a file, where they say something.
fn noted(file: &str) -> Option<&'static [Fate]> {
    const READ: &[Fate] = &[Fate::Read, Fate::Warned];
    const NOTES: [(&str, &[Fate]); 16] = [
        // Notes pasted into it: no WIF.
        ("liftplan and zeros.wpo.wif", &[Fate::Refused]),
        // Colours that are not there have stand-ins.
        ("color_table", &[Fate::Warned]),
        ("color too", &[Fate::Warned]),
        ("/bad_", &[Fate::Refused]),
        ("/warn_", &[Fate::Warned]),
        ("liftplan with defaults.wif", &[Fate::Warned]),
        (".wif", READ),
        (".dtx", READ),
        (".wpo", READ),
        ("Bad_", &[Fate::Refused]),
        ("truncated.jpg", &[Fate::Refused]),
        ("astronaut", &[Fate::Picture]),
        ("coffee", &[Fate::Picture]),
        ("Info_1_Bit", READ),
        ("seq-1c-1b", READ),
        ("fax4", READ),
    ];
    let known = NOTES.iter().find(|(part, _)| file.contains(part));
    known.map(|&(_, fates)| fates)
}

fn table(folder: &Path, least: usize) {
    let (mut count, mut noted_count) = (0, 0);
    for path in files(folder) {
        let file = path.strip_prefix(folder).unwrap().display().to_string();
        let (fate, said) = fate(&path);
        let said: String = said.chars().take(110).collect();
        println!("{:8} {file:64} {said}", format!("{fate:?}").to_lowercase());
        count += 1;
        if let Some(fates) = noted(&format!("/{file}")) {
            noted_count += 1;
            assert!(fates.contains(&fate), "{file}: {fate:?}, noted {fates:?}");
        }
    }
    println!("{count} files, {noted_count} with a note");
    assert!(count >= least && noted_count > 0, "{count}");
}

#[test]
fn every_draft_is_what_its_folder_says() {
    if let Some(folder) = folder("PICKGLASS_DRAFTS", "../shared/drafts") {
        table(&folder, 50);
    }
}

#[test]
fn every_image_is_what_its_name_says() {
    if let Some(folder) = folder("PICKGLASS_IMAGES", "../shared/images") {
        table(&folder, 20);
    }
}

#[test]
fn a_refusal_is_told_from_a_picture() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("Bad_one.bmp");
    std::fs::write(&file, b"BM no more").unwrap();
    assert_eq!(fate(&file).0, Fate::Refused);
    assert_eq!(noted("/Bad_one.bmp"), Some(&[Fate::Refused][..]));
    assert_ne!(noted("/Bad_one.bmp"), noted("/x.wif"));
}
