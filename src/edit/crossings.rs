//! Painting crossings: the drawdown, hand corrections, the region map.

use super::cells::Cells;
use super::document::Work;
use super::error::EditError;
use super::regions;
use crate::design::{Corrections, Grid, Structure, WeavePattern};

/// Puts warp or weft on top.
pub(super) fn paint(work: &mut Work, cells: &Cells, warp_up: bool) -> Result<(), EditError> {
    let value = if warp_up { u64::MAX } else { 0 };
    put(work, cells, |_, _, _| value)
}

/// Copies crossings from a pattern.
pub(super) fn place(
    work: &mut Work,
    cells: &Cells,
    values: &WeavePattern,
) -> Result<(), EditError> {
    check_size(work, values.ends(), values.picks())?;
    put(work, cells, |word, pick, _| values.pick_word(word, pick))
}

/// Exchanges warp and weft.
pub(super) fn flip(work: &mut Work, cells: &Cells) -> Result<(), EditError> {
    put(work, cells, |_, _, woven| !woven)
}

/// Writes `value(word, pick, woven)` where there are cells.
fn put(
    work: &mut Work,
    cells: &Cells,
    value: impl Fn(u32, u32, u64) -> u64,
) -> Result<(), EditError> {
    let (ends, picks) = cells.size();
    check_size(work, ends, picks)?;
    if matches!(work.design.structure(), Structure::Weave(_)) && !cells.is_empty() {
        become_pattern(work)?;
    }
    match work.design.structure_mut() {
        Structure::Weave(_) => {}
        Structure::Draft(_) => return Err(EditError::ShaftDraft),
        Structure::Pattern(pattern) => {
            for (word, pick, bits) in cells.words() {
                let woven = pattern.pick_word(word, pick);
                let painted = woven & !bits | value(word, pick, woven) & bits;
                pattern.set_pick_word(word, pick, painted);
            }
            work.drawdown = pattern.clone();
        }
        Structure::Regions(regions) => {
            let (_, _, corrections) = regions.parts_mut();
            let none = || Corrections::none(ends, picks);
            let (mask, said) = corrections.get_or_insert_with(none).parts_mut();
            for (word, pick, bits) in cells.words() {
                let woven = work.drawdown.pick_word(word, pick);
                let painted = value(word, pick, woven) & bits;
                mask.set_pick_word(word, pick, mask.pick_word(word, pick) | bits);
                said.set_pick_word(word, pick, said.pick_word(word, pick) & !bits | painted);
                work.drawdown
                    .set_pick_word(word, pick, woven & !bits | painted);
            }
        }
    }
    Ok(())
}

/// Takes hand corrections away.
pub(super) fn clear(work: &mut Work, cells: &Cells) -> Result<(), EditError> {
    let (ends, picks) = cells.size();
    check_size(work, ends, picks)?;
    let regions = regions::of(&mut work.design)?;
    let Some(corrections) = regions.parts_mut().2 else {
        return Ok(());
    };
    let (mask, value) = corrections.parts_mut();
    for (word, pick, bits) in cells.words() {
        mask.set_pick_word(word, pick, mask.pick_word(word, pick) & !bits);
        value.set_pick_word(word, pick, value.pick_word(word, pick) & !bits);
    }
    reweave(work, cells)
}

/// Gives crossings to a region.
pub(super) fn paint_region(work: &mut Work, cells: &Cells, region: u16) -> Result<(), EditError> {
    regions::check(&mut work.design, region)?;
    put_regions(work, cells, |_, _| region)
}

/// Copies regions from a map.
pub(super) fn place_regions(
    work: &mut Work,
    cells: &Cells,
    map: &Grid<u16>,
) -> Result<(), EditError> {
    check_size(work, map.ends(), map.picks())?;
    if let Some(most) = cells.iter().map(|(end, pick)| map.get(end, pick)).max() {
        regions::check(&mut work.design, most)?;
    }
    put_regions(work, cells, |end, pick| map.get(end, pick))
}

fn put_regions(
    work: &mut Work,
    cells: &Cells,
    region: impl Fn(u32, u32) -> u16,
) -> Result<(), EditError> {
    let (ends, picks) = cells.size();
    check_size(work, ends, picks)?;
    let usual = regions::usual_yarns(&work.design);
    let regions = regions::of(&mut work.design)?;
    let (map, _, _) = regions.parts_mut();
    let mut left = Vec::new();
    for (end, pick) in cells.iter() {
        let (before, after) = (map.get(end, pick), region(end, pick));
        if before != after {
            map.set(end, pick, after);
            if usual.is_some() {
                left.push((end, pick, before));
            }
        }
    }
    if let Some(usual) = usual {
        regions::move_yarns(work, &usual, &left)?;
    }
    reweave(work, cells)
}

/// Weaves the words of some crossings of a jacquard again.
pub(super) fn reweave(work: &mut Work, cells: &Cells) -> Result<(), EditError> {
    let regions = regions::of(&mut work.design)?;
    for (word, pick, _) in cells.words() {
        work.drawdown
            .set_pick_word(word, pick, regions.weave_word(word, pick));
    }
    Ok(())
}

/// Makes the design a bare drawdown.
pub(super) fn become_pattern(work: &mut Work) -> Result<(), EditError> {
    *work.design.structure_mut() = Structure::Pattern(work.drawdown.clone());
    Ok(())
}

/// Refuses crossings of a design of another size.
pub(super) fn check_size(work: &Work, ends: u32, picks: u32) -> Result<(), EditError> {
    match (ends, picks) == (work.design.ends(), work.design.picks()) {
        true => Ok(()),
        false => Err(EditError::OtherSize { ends, picks }),
    }
}
