//! The right yarn lies on top: every crossing of a cloth against the drawdown, on both
//! faces.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

mod cloth_scenes;

use std::path::Path;

use cloth_scenes::{at_level, preset, surface, weave};
use pickglass::cloth::ClothVolume;
use pickglass::design::{Design, WeavePattern, YarnId};
use pickglass::formats::wif;
use pickglass::synthesis::Face;
use rayon::prelude::*;

/// Crossings at whose centre another yarn is seen than the drawdown says.
fn wrong(
    cloth: &ClothVolume,
    design: &Design,
    weave: &WeavePattern,
    face: Face,
) -> Vec<(u32, u32)> {
    let crossings: Vec<(u32, u32)> = (0..weave.picks())
        .flat_map(|pick| (0..weave.ends()).map(move |end| (end, pick)))
        .collect();
    let is_wrong = |&(end, pick): &(u32, u32)| {
        let (i, j) = (i64::from(end), i64::from(pick));
        let warp = weave.get(end, pick) == (face == Face::Front);
        let YarnId(yarn) = if warp {
            design.warp_yarn(i, j)
        } else {
            design.weft_yarn(i, j)
        };
        let (x, y) = (cloth.ends().centre(i), cloth.picks().centre(j));
        let Some((_, seen)) = surface(cloth, x as f32, y as f32, face) else {
            return true;
        };
        // Yarns of one name on both sides still differ in the way they run.
        let along_warp = seen.direction.y.abs() > seen.direction.x.abs();
        along_warp != warp || seen.optics != u32::from(yarn)
    };
    crossings.into_par_iter().filter(is_wrong).collect()
}

fn expect_drawdown(design: &Design, level: u32) {
    let (pattern, cloth) = (design.weave(), woven(design, level));
    let crossings = u64::from(pattern.ends()) * u64::from(pattern.picks());
    for face in Face::ALL {
        let wrong = wrong(&cloth, design, &pattern, face);
        println!(
            "{} {face:?}: {} of {crossings} wrong",
            design.name,
            wrong.len()
        );
        assert!(
            wrong.is_empty(),
            "{} {face:?}: {} of {crossings} crossings, first {:?}",
            design.name,
            wrong.len(),
            &wrong[..wrong.len().min(8)]
        );
    }
    // Control: with one crossing of the drawdown turned over, that one fails.
    let (end, pick) = (pattern.ends() / 3, pattern.picks() / 2);
    let mut turned = pattern.clone();
    turned.set(end, pick, !pattern.get(end, pick));
    for face in Face::ALL {
        assert_eq!(wrong(&cloth, design, &turned, face), [(end, pick)]);
    }
}

fn woven(design: &Design, level: u32) -> ClothVolume {
    let cloth = weave(design, at_level(level));
    let across = cloth.ends().repeat_mm().min(30.0) as f32;
    let along = cloth.picks().repeat_mm().min(30.0) as f32;
    cloth.with_window(0.0..across, 0.0..along)
}

fn read(bytes: &[u8], name: &str) -> Design {
    wif::read(bytes, name).unwrap().design
}

#[test]
fn a_shaft_draft_shows_its_drawdown() {
    let fixture = include_bytes!("fixtures/plain_twill.wif");
    expect_drawdown(&read(fixture, "plain_twill.wif"), 1);
    let fixture = include_bytes!("fixtures/several_shafts_and_treadles.wif");
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
