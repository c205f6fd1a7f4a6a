//! The right yarn lies on top: every crossing of a cloth against the drawdown, on both
//! faces.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

use std::path::Path;

use crate::cloth_scenes::{Seen, at_level, preset, seen, weave};
use pickglass::cloth::ClothVolume;
use pickglass::design::{Design, WeavePattern, YarnId};
use pickglass::formats::wif;
use pickglass::synthesis::Face;
use rayon::prelude::*;

/// What the middle of every crossing of a design shows, pick by pick.
fn look(cloth: &ClothVolume, design: &Design, face: Face) -> Vec<(Option<Seen>, f32)> {
    let (ends, picks) = (i64::from(design.ends()), i64::from(design.picks()));
    (0..ends * picks)
        .into_par_iter()
        .map(|at| seen(cloth, at % ends, at / ends, face))
        .collect()
}

/// Crossings that show another yarn than this drawdown says.
fn wrong(
    looks: &[(Option<Seen>, f32)],
    design: &Design,
    weave: &WeavePattern,
    face: Face,
) -> Vec<(u32, u32)> {
    let crossings =
        (0..weave.picks()).flat_map(|pick| (0..weave.ends()).map(move |end| (end, pick)));
    let is_wrong = |&((end, pick), look): &((u32, u32), &(Option<Seen>, f32))| {
        let (i, j) = (i64::from(end), i64::from(pick));
        let warp = weave.get(end, pick) == (face == Face::Front);
        let YarnId(yarn) = if warp {
            design.warp_yarn(i, j)
        } else {
            design.weft_yarn(i, j)
        };
        // Yarns of one name on both sides still differ in the way they run.
        look.0 != Some((u32::from(yarn), warp))
    };
    let wrong = crossings.zip(looks).filter(is_wrong);
    wrong.map(|(crossing, _)| crossing).collect()
}

fn expect_drawdown(design: &Design, level: u32) {
    let (pattern, cloth) = (design.weave(), woven(design, level));
    // Control: with one crossing of the drawdown turned over, that one fails.
    let (end, pick) = (pattern.ends() / 3, pattern.picks() / 2);
    let mut turned = pattern.clone();
    turned.set(end, pick, !pattern.get(end, pick));
    for face in Face::ALL {
        let looks = look(&cloth, design, face);
        let wrong_here = wrong(&looks, design, &pattern, face);
        let least = looks.iter().fold(1.0f32, |least, look| least.min(look.1));
        println!(
            "{} {face:?}: {} of {} wrong, least share {least:.2}",
            design.name,
            wrong_here.len(),
            looks.len()
        );
        let first = &wrong_here[..wrong_here.len().min(8)];
        assert!(first.is_empty(), "{} {face:?}: {first:?} …", design.name);
        assert_eq!(wrong(&looks, design, &turned, face), [(end, pick)]);
    }
}

fn woven(design: &Design, level: u32) -> ClothVolume {
    let cloth = weave(design, at_level(level));
    let across = cloth.ends().repeat_mm() as f32;
    let along = cloth.picks().repeat_mm() as f32;
    cloth.with_window(0.0..across, 0.0..along)
}

fn read(bytes: &[u8], name: &str) -> Design {
    wif::read(bytes, name).unwrap().design
}

#[test]
fn a_shaft_draft_shows_its_drawdown() {
    let fixture = include_bytes!("../fixtures/plain_twill.wif");
    expect_drawdown(&read(fixture, "plain_twill.wif"), 1);
    let fixture = include_bytes!("../fixtures/several_shafts_and_treadles.wif");
    expect_drawdown(&read(fixture, "several.wif"), 1);
}

#[test]
fn a_herringbone_shows_its_drawdown() {
    expect_drawdown(&preset("herringbone"), 1);
}

#[test]
fn a_damask_shows_its_drawdown() {
    expect_drawdown(&preset("damask"), 1);
}

#[test]
fn an_overshot_shows_its_drawdown() {
    let folder = std::env::var_os("PICKGLASS_DRAFTS").map_or_else(
        || Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/drafts"),
        std::path::PathBuf::from,
    );
    let path = folder.join("warptracker/Overshot_Honeysuckle.wif");
    let Ok(bytes) = std::fs::read(&path) else {
        let required = std::env::var("GOLDEN_REQUIRED").is_ok_and(|value| value == "1");
        assert!(
            !required,
            "no draft {}: set PICKGLASS_DRAFTS",
            path.display()
        );
        eprintln!("not run: no draft {}", path.display());
        return;
    };
    expect_drawdown(&read(&bytes, "Overshot_Honeysuckle.wif"), 1);
}
