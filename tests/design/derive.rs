//! From drawdowns back to drafts: the same cloth on the least shafts.

#![allow(clippy::unwrap_used, reason = "a test may fail")]

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use pickglass::design::{
    Design, Draft, Family, Lifting, Loom, MAX_SHAFTS, Shed, Srgb, Structure, Ties, WeavePattern,
    Yarn, YarnId, YarnMaps, derive, shafts_needed, usual_sett, weave,
};
use pickglass::formats::wif;
use proptest::prelude::*;

const ANY: Loom = Loom {
    shafts: MAX_SHAFTS,
    treadles: MAX_SHAFTS,
    dobby: false,
};

/// Different columns and rows, counted crossing by crossing.
fn different(pattern: &WeavePattern) -> (usize, usize) {
    let (ends, picks) = (pattern.ends(), pattern.picks());
    let column = |end| (0..picks).map(|pick| pattern.get(end, pick)).collect();
    let row = |pick| (0..ends).map(|end| pattern.get(end, pick)).collect();
    let columns: BTreeSet<Vec<bool>> = (0..ends).map(column).collect();
    let rows: BTreeSet<Vec<bool>> = (0..picks).map(row).collect();
    (columns.len(), rows.len())
}

#[test]
fn known_weaves_need_what_weavers_know() {
    for (pattern, shafts, treadles) in [
        (weave("plain").unwrap(), 2, 2),
        (weave("2/2 twill").unwrap(), 4, 4),
        (weave("1/7 satin").unwrap(), 8, 8),
        (weave("2/2 basket").unwrap(), 2, 2),
    ] {
        let draft = derive(&pattern, &ANY).unwrap();
        assert_eq!((draft.shafts(), draft.treadles()), (shafts, treadles));
        assert_eq!(draft.drawdown(), pattern);
    }
    // Six ends in a point on four shafts: 1 2 3 4 3 2.
    let point = WeavePattern::parse("#..#..\n..###.\n.##.##\n##...#").unwrap();
    let draft = derive(&point, &ANY).unwrap();
    assert_eq!((draft.shafts(), draft.treadles()), (4, 4));
    let straight_and_back = Ties::from_rows([[0], [1], [2], [3], [2], [1]]);
    assert_eq!(draft.threading(), &straight_and_back);
}

#[test]
fn an_overshot_needs_four_shafts() {
    let folder = std::env::var_os("PICKGLASS_DRAFTS").map_or_else(
        || Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/drafts"),
        PathBuf::from,
    );
    let path = folder.join("warptracker/Overshot_Honeysuckle.wif");
    let Ok(bytes) = std::fs::read(&path) else {
        let required = std::env::var("GOLDEN_REQUIRED").is_ok_and(|value| value == "1");
        assert!(!required, "no {}: set PICKGLASS_DRAFTS", path.display());
        eprintln!("not run: no {}", path.display());
        return;
    };
    let overshot = wif::read(&bytes, "overshot").unwrap().design.weave();
    let loom = Loom {
        shafts: 4,
        treadles: 6,
        dobby: false,
    };
    let draft = derive(&overshot, &loom).unwrap();
    assert_eq!(draft.shafts(), 4);
    assert_eq!(draft.drawdown(), overshot);
    let small = Loom { shafts: 3, ..loom };
    let message = derive(&overshot, &small).unwrap_err().to_string();
    assert!(
        message.contains("needs 4 shafts; the loom has 3"),
        "{message}"
    );
}

fn design(pattern: WeavePattern) -> Design {
    let yarns = vec![Yarn::new("a", Family::Cotton, Srgb(20, 30, 90))];
    let maps = YarnMaps::plain(YarnId(0), YarnId(0));
    let sett = usual_sett(&yarns, &maps);
    Design::new("cloth", Structure::Pattern(pattern), yarns, maps, sett).unwrap()
}

#[test]
fn a_drawdown_becomes_a_wif_with_tie_up_or_lift_plan() {
    let small = weave("2/2 twill").unwrap();
    let written = wif::write(&design(small.clone())).unwrap();
    assert!(
        written.text.contains("[TIEUP]\n1=1,4\n"),
        "{}",
        written.text
    );
    let again = wif::read(written.text.as_bytes(), "x").unwrap().design;
    assert_eq!(again.weave(), small);
    // 65 shafts: a lift plan.
    let wide = WeavePattern::from_fn(65, 65, |end, pick| end == pick);
    let written = wif::write(&design(wide.clone())).unwrap();
    assert!(written.text.contains("[LIFTPLAN]") && !written.text.contains("[TIEUP]"));
    assert!(written.lost.iter().any(|line| line.contains("65 shafts")));
    let again = wif::read(written.text.as_bytes(), "x").unwrap().design;
    assert_eq!(again.weave(), wide);
}

prop_compose! {
    /// A draft with each end on one shaft or none and any treadles on each pick.
    fn drafts()(shafts in 1u16..12, treadles in 1u16..10, sinking in any::<bool>())(
        threading in proptest::collection::vec(0..=shafts, 1..90),
        tieup in proptest::collection::vec(
            proptest::collection::vec(0..shafts, 0..6), usize::from(treadles)),
        treadling in proptest::collection::vec(
            proptest::collection::vec(0..treadles, 0..3), 1..80),
        shafts in Just(shafts), treadles in Just(treadles), sinking in Just(sinking),
    ) -> Draft {
        let on = |shaft: u16| shaft.checked_sub(1).into_iter().collect::<Vec<_>>();
        let threading = Ties::from_rows(threading.into_iter().map(on));
        let lifting = Lifting::Treadled {
            tieup: Ties::from_rows(tieup),
            treadling: Ties::from_rows(treadling),
        };
        let shed = if sinking { Shed::Sinking } else { Shed::Rising };
        Draft::new(shafts.into(), treadles.into(), shed, threading, lifting).unwrap()
    }
}

proptest! {
    #[test]
    fn a_derived_draft_weaves_the_same_on_no_more_shafts(draft in drafts()) {
        let cloth = draft.drawdown();
        let derived = derive(&cloth, &ANY).unwrap();
        prop_assert_eq!(derived.drawdown(), cloth.clone());
        let (columns, rows) = different(&cloth);
        prop_assert_eq!((derived.shafts() as usize, derived.treadles() as usize), (columns, rows));
        prop_assert_eq!(shafts_needed(&cloth) as usize, columns);
        // Ends on no shaft share one of their own.
        let used: BTreeSet<&[u16]> = draft.threading().iter().collect();
        prop_assert!(derived.shafts() as usize <= used.len());
        prop_assert!(derived.threading().iter().all(|on| on.len() == 1));
        // Numbered as they first come up.
        let mut next = 0;
        for on in derived.threading().iter() {
            prop_assert!(on[0] <= next);
            next = next.max(on[0] + 1);
        }
        let plan = derive(&cloth, &Loom::dobby(MAX_SHAFTS)).unwrap();
        prop_assert_eq!(plan.drawdown(), cloth.clone());
        // Pressed together, no more treadles than apart, and the same cloth.
        for treadles in (1..rows as u32).rev() {
            let Ok(together) = derive(&cloth, &Loom { treadles, ..ANY }) else { break };
            prop_assert!(together.treadles() <= treadles);
            prop_assert_eq!(together.drawdown(), cloth.clone());
        }
    }

    #[test]
    fn any_pattern_is_derived(ends in 1u32..140, picks in 1u32..140, seed in any::<u32>()) {
        let cloth = WeavePattern::from_fn(ends, picks, |end, pick| {
            (end.wrapping_mul(seed) ^ pick.wrapping_mul(31)) % 7 < 3
        });
        let derived = derive(&cloth, &ANY).unwrap();
        prop_assert_eq!(derived.drawdown(), cloth);
    }
}
