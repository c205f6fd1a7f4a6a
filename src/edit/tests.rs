//! What a document promises, on small designs.

use super::*;
use crate::design::{
    Design, Draft, Family, Fill, Filled, Grid, Lifting, Region, Regions, Shed, Srgb, Structure,
    Ties, Yarn, YarnId, YarnMaps, usual_sett,
};

/// A design of this structure in navy and cream, with a stripe of three.
pub(super) fn design(structure: Structure) -> Design {
    let yarns = vec![
        Yarn::new("navy", Family::Cotton, Srgb(20, 30, 90)),
        Yarn::new("cream", Family::Cotton, Srgb(240, 240, 235)),
    ];
    let order = vec![YarnId(0), YarnId(0), YarnId(1)];
    let maps = YarnMaps::orders(order, vec![YarnId(1)]);
    let sett = usual_sett(&yarns, &maps);
    Design::new("cloth", structure, yarns, maps, sett).unwrap()
}

/// Two regions side by side: plain, and a 2/2 twill.
pub(super) fn jacquard(ends: u32, picks: u32) -> Design {
    let map = Grid::from_fn(ends, picks, |end, _| u16::from(end >= ends / 2)).unwrap();
    let region = |name: &str, notation| Region::new(name, Fill::by_notation(notation).unwrap());
    let palette = vec![region("ground", "plain"), region("figure", "2/2 twill")];
    design(Structure::Regions(
        Regions::new(map, palette, None).unwrap(),
    ))
}

/// A straight 2/2 twill on four shafts, twice across and along.
pub(super) fn shaft_draft() -> Design {
    let rows = || Ties::from_rows((0..8u16).map(|thread| [thread % 4]));
    let lifting = Lifting::Treadled {
        tieup: Ties::from_rows([[0, 1], [1, 2], [2, 3], [0, 3]]),
        treadling: rows(),
    };
    design(Structure::Draft(
        Draft::new(4, 4, Shed::Rising, rows(), lifting).unwrap(),
    ))
}

fn paint(document: &Document, crossings: &[(u32, u32)], warp_up: bool) -> Edit {
    let (ends, picks) = (document.design().ends(), document.design().picks());
    let cells = Cells::of(ends, picks, crossings.iter().copied());
    Edit::Paint { cells, warp_up }
}

#[test]
fn a_stroke_is_painted_undone_and_redone() {
    let mut document = Document::new(design(Structure::Weave(Filled::once("plain").unwrap())));
    let before = document.drawdown().to_string();
    let change = document.apply(paint(&document, &[(1, 0)], true)).unwrap();
    let (end, pick) = (1, 0);
    assert_eq!(change.crossings, Touched::Rects(vec![Rect::one(end, pick)]));
    assert!(change.structure, "a weave by notation became a drawdown");
    assert_eq!(document.drawdown().to_string(), ".#\n##\n");
    assert!(document.is_modified());
    let back = document.undo().unwrap();
    assert_eq!(back.crossings, Touched::Rects(vec![Rect::one(end, pick)]));
    assert_eq!(document.drawdown().to_string(), before);
    assert!(!document.is_modified());
    assert!(document.undo().is_none());
    document.redo().unwrap();
    assert_eq!(document.drawdown().to_string(), ".#\n##\n");
    assert!(document.redo().is_none());
    // Painting what is there already is no entry.
    assert!(
        document
            .apply(paint(&document, &[(1, 0)], true))
            .unwrap()
            .is_nothing()
    );
    assert_eq!(document.entries().len(), 2);
}

#[test]
fn a_gesture_is_one_entry_and_escape_takes_it_back() {
    let mut document = Document::new(jacquard(16, 8));
    let before = document.design().clone();
    document.begin("pencil");
    for end in 0..5 {
        document.apply(paint(&document, &[(end, 0)], true)).unwrap();
    }
    assert!(document.is_modified());
    document.finish();
    assert_eq!((document.entries().len(), document.position()), (2, 1));
    assert_eq!(document.entries()[1].name(), "pencil");
    document.begin("pencil");
    document.apply(paint(&document, &[(9, 0)], true)).unwrap();
    let painted = document.drawdown().to_string();
    assert!(!document.restart().is_nothing());
    document.apply(paint(&document, &[(9, 0)], true)).unwrap();
    assert_eq!(document.drawdown().to_string(), painted);
    document.cancel();
    assert_eq!((document.entries().len(), document.position()), (2, 1));
    document.begin("nothing");
    document.finish();
    assert_eq!(document.entries().len(), 2);
    document.go_to(0).unwrap();
    assert_eq!(document.design(), &before);
}

#[test]
fn the_unsaved_mark_follows_the_saved_state() {
    let mut document = Document::new(jacquard(16, 8));
    document.apply(paint(&document, &[(0, 0)], false)).unwrap();
    document.mark_saved();
    document.apply(paint(&document, &[(1, 0)], true)).unwrap();
    assert!(document.is_modified());
    document.undo().unwrap();
    assert!(!document.is_modified());
    document.undo().unwrap();
    assert!(document.is_modified());
    // Another way on from here: the saved state is gone for good.
    document.apply(paint(&document, &[(2, 0)], true)).unwrap();
    assert_eq!(document.entries().len(), 2);
    for _ in 0..2 {
        assert!(document.is_modified());
        document.undo();
    }
    document.mark_saved();
    document.set_history_limit(0);
    for end in 0..5 {
        document
            .apply(paint(&document, &[(end, 3)], end % 2 == 0))
            .unwrap();
        document
            .apply(paint(&document, &[(end, 3)], end % 2 == 1))
            .unwrap();
    }
    assert_eq!(
        document.entries().len(),
        2,
        "the last gesture can always be taken back"
    );
    document.undo().unwrap();
    assert!(document.undo().is_none());
    assert!(document.is_modified());
}

#[test]
fn the_cloth_of_a_shaft_draft_is_not_painted_but_derived() {
    let mut document = Document::new(shaft_draft());
    let refused = paint(&document, &[(0, 2)], true);
    let error = document.apply(refused.clone()).unwrap_err();
    assert_eq!(error, EditError::ShaftDraft);
    assert_eq!(document.entries().len(), 1);
    let mut expected = document.drawdown().as_ref().clone();
    expected.set(0, 2, true);
    let [derive, jacquard] = <[Edit; 2]>::try_from(error.remedies(&refused)).unwrap();
    for (edit, kind) in [(derive, "draft"), (jacquard, "jacquard")] {
        document.apply(edit).unwrap();
        assert_eq!(**document.drawdown(), expected);
        assert_eq!(document.design().weave(), expected);
        match document.design().structure() {
            Structure::Draft(draft) => assert_eq!((kind, draft.shafts()), ("draft", 5)),
            Structure::Regions(regions) => {
                assert_eq!((kind, regions.palette().len()), ("jacquard", 1));
            }
            _ => panic!("{kind}"),
        }
        document.undo().unwrap();
    }
}

#[test]
fn a_weave_reassigned_keeps_outlines_and_corrections() {
    let mut document = Document::new(jacquard(16, 8));
    document.apply(paint(&document, &[(0, 0)], false)).unwrap();
    let fill = Fill::by_notation("2/2 basket").unwrap();
    document.apply(Edit::SetFill { region: 0, fill }).unwrap();
    assert!(!document.drawdown().get(0, 0), "the correction stands");
    assert_eq!(**document.drawdown(), document.design().weave());
    let cells = Cells::all(16, 8);
    document.apply(Edit::ClearCorrections(cells)).unwrap();
    assert!(document.drawdown().get(0, 0));
    assert_eq!(**document.drawdown(), document.design().weave());
}

#[test]
fn crossings_of_another_design_are_refused() {
    let mut document = Document::new(jacquard(16, 8));
    let edit = Edit::Paint {
        cells: Cells::all(8, 8),
        warp_up: true,
    };
    let message = document.apply(edit).unwrap_err().to_string();
    assert!(
        message.contains("8 × 8") && message.contains("select again"),
        "{message}"
    );
    let edit = Edit::PaintRegion {
        cells: Cells::all(16, 8),
        region: 2,
    };
    assert!(
        document
            .apply(edit)
            .unwrap_err()
            .to_string()
            .contains("region 3")
    );
    assert!(!document.is_modified());
}

#[test]
fn no_two_states_of_two_documents_share_a_revision() {
    let design = || design(Structure::Weave(Filled::once("plain").unwrap()));
    let mut seen = std::collections::BTreeSet::new();
    for _ in 0..3 {
        let mut document = Document::new(design());
        assert!(seen.insert(document.revision()));
        document
            .apply(paint(&document, &[(1, 0)], true))
            .expect("painted");
        assert!(seen.insert(document.revision()));
        document.undo();
        assert!(seen.insert(document.revision()));
        // A copy is the same until it is changed.
        let mut copy = document.clone();
        assert_eq!(copy.revision(), document.revision());
        copy.apply(Edit::Invert).expect("inverted");
        document.apply(Edit::Invert).expect("inverted");
        assert!(seen.insert(copy.revision()) && seen.insert(document.revision()));
    }
}
