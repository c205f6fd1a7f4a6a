use super::*;
use crate::edit::tests::{jacquard, shaft_draft};
use crate::edit::{Cells, Document, Edit, Rect};

fn paint(document: &mut Document, rect: Rect) {
    let design = document.design();
    let cells = Cells::of_rect(design.ends(), design.picks(), rect);
    let edits = [
        Edit::Flip(cells.clone()),
        Edit::PaintRegion { cells, region: 1 },
    ];
    for edit in edits {
        document.apply(edit).unwrap();
    }
}

fn rect(end: u32) -> Rect {
    Rect {
        end,
        pick: 3,
        ends: 9,
        picks: 5,
    }
}

#[test]
fn changed_tiles_are_appended_and_come_back() {
    let folder = tempfile::tempdir().unwrap();
    let mut recovery = Recovery::begin(folder.path()).unwrap();
    let mut document = Document::new(jacquard(150, 70));
    let original = Path::new("/designs/cloth.ron");
    let mut save = |document: &Document| recovery.save(document.design(), Some(original)).unwrap();
    assert!(matches!(save(&document), Saved::Whole { .. }));
    assert_eq!(save(&document), Saved::Unchanged);
    // The first correction of all is more than tiles.
    paint(&mut document, rect(60));
    assert!(matches!(save(&document), Saved::Whole { .. }));
    for end in [0, 141] {
        paint(&mut document, rect(end));
        let Saved::Tiles { bytes } = save(&document) else {
            panic!("not tiles")
        };
        // One tile of regions and two of bits, not the design.
        assert!(bytes < 3 * 9 + 2 * 4096 + 2 * 512 + 30, "{bytes}");
    }
    assert!(list(folder.path()).found.is_empty(), "its program runs");
    let path = recovery.path().to_owned();
    drop(recovery);
    let listing = list(folder.path());
    assert!(listing.damaged.is_empty());
    let [found] = listing.found.as_slice() else {
        panic!("{listing:?}")
    };
    assert_eq!(
        (found.path.as_path(), found.name.as_str()),
        (path.as_path(), "cloth")
    );
    assert_eq!(found.original.as_deref(), Some(original));
    let recovered = load(&found.path).unwrap();
    assert_eq!(recovered.lost, None);
    assert_eq!(&recovered.design, document.design().as_ref());
    assert_ne!(recovered.design, jacquard(150, 70));
    discard(&found.path).unwrap();
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn what_is_damaged_is_told_and_what_is_whole_comes_back() {
    let folder = tempfile::tempdir().unwrap();
    let mut recovery = Recovery::begin(folder.path()).unwrap();
    let mut document = Document::new(jacquard(20, 10));
    paint(&mut document, rect(1));
    let first = document.design().clone();
    recovery.save(&first, None).unwrap();
    paint(&mut document, rect(9));
    assert!(matches!(
        recovery.save(document.design(), None).unwrap(),
        Saved::Tiles { .. }
    ));
    let path = recovery.path().to_owned();
    drop(recovery);
    let whole = std::fs::read(&path).unwrap();
    // Where the design ends and the tiles begin.
    let (mut bases, mut seen) = (Vec::new(), 0);
    for length in 0..whole.len() {
        std::fs::write(&path, &whole[..length]).unwrap();
        match load(&path) {
            Ok(recovered) => {
                bases.push(length);
                assert_eq!(&recovered.design, first.as_ref(), "cut at {length}");
                seen += usize::from(recovered.lost.is_some());
            }
            Err(error) => assert!(error.to_string().contains("discard it"), "{error}"),
        }
        let listing = list(folder.path());
        assert_eq!(listing.found.len() + listing.damaged.len(), 1);
    }
    // All lengths beyond the design give the design, all but the first say what is lost.
    assert_eq!(bases.len(), whole.len() - bases[0]);
    assert_eq!(seen, bases.len() - 1);
    for place in 0..whole.len() {
        let mut flipped = whole.clone();
        flipped[place] ^= 1 << (place % 8);
        std::fs::write(&path, &flipped).unwrap();
        match load(&path) {
            Ok(recovered) => {
                assert!(place >= bases[0], "an undetected flip at {place}");
                assert!(recovered.lost.is_some());
                assert_eq!(&recovered.design, first.as_ref());
            }
            Err(error) => assert!(error.to_string().contains("design-"), "{error}"),
        }
    }
    std::fs::write(&path, &whole).unwrap();
    assert_eq!(&load(&path).unwrap().design, document.design().as_ref());
}

#[test]
fn two_programs_keep_apart() {
    let folder = tempfile::tempdir().unwrap();
    let mut one = Recovery::begin(folder.path()).unwrap();
    let mut other = Recovery::begin(folder.path()).unwrap();
    one.save(&Arc::new(jacquard(8, 8)), None).unwrap();
    other.save(&Arc::new(shaft_draft()), None).unwrap();
    assert_ne!(one.path(), other.path());
    assert!(list(folder.path()).found.is_empty());
    drop(one);
    let left = list(folder.path()).found;
    assert_eq!(left.len(), 1);
    assert_eq!(load(&left[0].path).unwrap().design, jacquard(8, 8));
    other.close().unwrap();
    assert_eq!(list(folder.path()).found.len(), 1);
}

#[test]
fn a_copy_that_is_gone_is_written_whole_again() {
    let folder = tempfile::tempdir().unwrap();
    let mut recovery = Recovery::begin(folder.path()).unwrap();
    let mut document = Document::new(jacquard(20, 10));
    paint(&mut document, rect(1));
    recovery.save(document.design(), None).unwrap();
    recovery.clear().unwrap();
    assert!(!recovery.path().exists());
    paint(&mut document, rect(9));
    assert!(matches!(
        recovery.save(document.design(), None).unwrap(),
        Saved::Whole { .. }
    ));
    std::fs::remove_file(recovery.path()).unwrap();
    paint(&mut document, rect(5));
    assert!(matches!(
        recovery.save(document.design(), None).unwrap(),
        Saved::Whole { .. }
    ));
}

#[test]
fn a_folder_that_cannot_be_written_is_an_error_and_no_crash() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    std::fs::write(&file, b"").unwrap();
    let message = Recovery::begin(&file.join("below"))
        .unwrap_err()
        .to_string();
    assert!(message.contains("file/below"), "{message}");
    let inside = folder.path().join("inside");
    let mut recovery = Recovery::begin(&inside).unwrap();
    std::fs::remove_dir_all(&inside).unwrap();
    let message = recovery
        .save(&Arc::new(jacquard(8, 8)), None)
        .unwrap_err()
        .to_string();
    assert!(message.contains("make its folder first"), "{message}");
    assert!(list(&inside).found.is_empty());
}
