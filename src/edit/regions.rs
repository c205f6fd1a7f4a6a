//! The regions of a jacquard: their list, their weaves, and yarns of their own.

use super::Edit;
use super::cells::Cells;
use super::crossings;
use super::document::Work;
use super::error::EditError;
use crate::design::{
    Design, Fill, Grid, Region, RegionYarns, Regions, Srgb, Structure, YarnId, YarnMap, YarnMaps,
};

/// The regions of a design that is a jacquard.
pub(super) fn of(design: &mut Design) -> Result<&mut Regions, EditError> {
    match design.structure_mut() {
        Structure::Regions(regions) => Ok(regions),
        _ => Err(EditError::NoPart {
            part: "regions",
            remedy: "make it a jacquard first",
        }),
    }
}

/// Refuses a region that is not there.
pub(super) fn check(design: &mut Design, region: u16) -> Result<(), EditError> {
    entry(design, region).map(|_| ())
}

fn entry(design: &mut Design, region: u16) -> Result<&mut Region, EditError> {
    let (_, palette, _) = of(design)?.parts_mut();
    let count = palette.len();
    palette
        .get_mut(usize::from(region))
        .ok_or(EditError::Missing {
            thing: "region",
            number: u64::from(region) + 1,
            count: count as u64,
        })
}

/// A region more.
pub(super) fn add(work: &mut Work, region: Region) -> Result<(), EditError> {
    if let Some(own) = region.yarns {
        check_yarns(&work.design, own)?;
    }
    let (_, palette, _) = of(&mut work.design)?.parts_mut();
    if palette.len() > usize::from(u16::MAX) {
        return Err(EditError::Value {
            place: "regions",
            problem: "65536 is the most: merge some first".to_owned(),
        });
    }
    palette.push(region);
    Ok(())
}

/// Another weave, under outlines and corrections that stay.
pub(super) fn set_fill(work: &mut Work, region: u16, fill: Fill) -> Result<(), EditError> {
    entry(&mut work.design, region)?.fill = fill;
    reweave(work, region)
}

/// Another place for the weave.
pub(super) fn set_origin(
    work: &mut Work,
    region: u16,
    origin: (i32, i32),
) -> Result<(), EditError> {
    entry(&mut work.design, region)?.origin = origin;
    reweave(work, region)
}

/// Weaves a region's crossings again, in the words that hold any of it.
fn reweave(work: &mut Work, region: u16) -> Result<(), EditError> {
    let regions = of(&mut work.design)?;
    let map = regions.map();
    for pick in 0..map.picks() {
        for word in 0..map.ends().div_ceil(64) {
            if map.pick_values(word, pick).contains(&region) {
                let bits = regions.weave_word(word, pick);
                work.drawdown.set_pick_word(word, pick, bits);
            }
        }
    }
    Ok(())
}

/// Another name and colour.
pub(super) fn rename(
    work: &mut Work,
    region: u16,
    name: String,
    colour: Option<Srgb>,
) -> Result<(), EditError> {
    let entry = entry(&mut work.design, region)?;
    (entry.name, entry.colour) = (name, colour);
    Ok(())
}

/// Fixed, or free for proposals.
pub(super) fn lock(work: &mut Work, region: u16, locked: bool) -> Result<(), EditError> {
    entry(&mut work.design, region)?.locked = locked;
    Ok(())
}

/// Puts the regions in another order: place i gets the region that had number `order[i]`.
pub(super) fn reorder(work: &mut Work, order: &[u16]) -> Result<(), EditError> {
    let (map, palette, _) = of(&mut work.design)?.parts_mut();
    let number = places("regions", order, palette.len())?;
    *palette = order
        .iter()
        .map(|&old| palette[usize::from(old)].clone())
        .collect();
    // Beyond the edges a tile may hold numbers of regions that are gone.
    map.replace_values(|old| number.get(usize::from(old)).copied().unwrap_or(0));
    Ok(())
}

/// Where each number goes in an order; refuses one that is no permutation of `count`.
pub(super) fn places(
    place: &'static str,
    order: &[u16],
    count: usize,
) -> Result<Vec<u16>, EditError> {
    let mut places = vec![None; count];
    for (new, &old) in order.iter().enumerate() {
        if let Some(place) = places.get_mut(usize::from(old)) {
            *place = Some(new as u16);
        }
    }
    let all: Option<Vec<u16>> = places.into_iter().collect();
    all.filter(|_| order.len() == count)
        .ok_or_else(|| EditError::Value {
            place,
            problem: format!("the order must name each of the {count} once"),
        })
}

/// Crossings of each region.
pub(super) fn areas(regions: &Regions) -> Vec<u64> {
    let mut areas = vec![0u64; regions.palette().len()];
    let map = regions.map();
    for pick in 0..map.picks() {
        for word in 0..map.ends().div_ceil(64) {
            for &region in map.pick_values(word, pick) {
                areas[usize::from(region)] += 1;
            }
        }
    }
    areas
}

/// The largest region first; equal ones keep their order.
pub(super) fn sort_by_area(work: &mut Work) -> Result<(), EditError> {
    let areas = areas(of(&mut work.design)?);
    let mut order: Vec<u16> = (0..areas.len()).map(|region| region as u16).collect();
    order.sort_by_key(|&region| std::cmp::Reverse(areas[usize::from(region)]));
    reorder(work, &order)
}

/// Gives a region's crossings to another and takes it off the list.
pub(super) fn merge(work: &mut Work, region: u16, into: u16) -> Result<(), EditError> {
    check(&mut work.design, region)?;
    check(&mut work.design, into)?;
    if region == into {
        return Err(EditError::Value {
            place: "regions",
            problem: "a region cannot be merged into itself: choose another".to_owned(),
        });
    }
    let map = of(&mut work.design)?.map();
    let mut cells = Cells::none(map.ends(), map.picks());
    for pick in 0..map.picks() {
        for word in 0..map.ends().div_ceil(64) {
            let values = map.pick_values(word, pick).iter().enumerate();
            let bits = values.fold(0, |bits, (place, &here)| {
                bits | u64::from(here == region) << place
            });
            cells.insert_word(word, pick, bits);
        }
    }
    crossings::paint_region(work, &cells, into)?;
    let (map, palette, _) = of(&mut work.design)?.parts_mut();
    palette.remove(usize::from(region));
    map.replace_values(|old| old - u16::from(old > region));
    Ok(())
}

fn check_yarns(design: &Design, own: RegionYarns) -> Result<(), EditError> {
    let count = design.yarns().len();
    for YarnId(yarn) in [own.warp, own.weft] {
        if usize::from(yarn) >= count {
            return Err(EditError::Missing {
                thing: "yarn",
                number: u64::from(yarn) + 1,
                count: count as u64,
            });
        }
    }
    Ok(())
}

/// The yarns that lie where a region has none of its own, of a design with such regions;
/// `None` for all others.
///
/// The design keeps only what lies at each crossing: an end's usual yarn is read where the
/// first region without own yarns crosses it, and is its neighbour's where none does.
pub(super) fn usual_yarns(design: &Design) -> Option<YarnMaps> {
    let Structure::Regions(regions) = design.structure() else {
        return None;
    };
    let own = |end, pick| {
        let region = usize::from(regions.map().get(end, pick));
        regions.palette()[region].yarns.is_some()
    };
    if design.weavable()
        && regions
            .palette()
            .iter()
            .all(|region| region.yarns.is_none())
    {
        return None;
    }
    let (ends, picks) = (design.ends(), design.picks());
    let mut last = YarnId(0);
    let warp = match &design.maps().warp {
        YarnMap::Order(order) => order.clone(),
        YarnMap::Crossings(grid) => {
            let usual = |end| {
                (0..picks)
                    .find(|&pick| !own(end, pick))
                    .map(|pick| grid.get(end, pick))
            };
            (0..ends)
                .map(|end| {
                    last = usual(end).unwrap_or(last);
                    last
                })
                .collect()
        }
    };
    let mut last = YarnId(0);
    let weft = match &design.maps().weft {
        YarnMap::Order(order) => order.clone(),
        YarnMap::Crossings(grid) => {
            let usual = |pick| {
                (0..ends)
                    .find(|&end| !own(end, pick))
                    .map(|end| grid.get(end, pick))
            };
            (0..picks)
                .map(|pick| {
                    last = usual(pick).unwrap_or(last);
                    last
                })
                .collect()
        }
    };
    Some(YarnMaps::orders(warp, weft))
}

/// Gives crossings that changed their region (end, pick, region before) the yarns of the
/// region they are in now.
pub(super) fn move_yarns(
    work: &mut Work,
    usual: &YarnMaps,
    moved: &[(u32, u32, u16)],
) -> Result<(), EditError> {
    let now: Vec<_> = {
        let regions = of(&mut work.design)?;
        let own = |region: u16| regions.palette()[usize::from(region)].yarns;
        let moved = moved.iter().map(|&(end, pick, before)| {
            (end, pick, own(before), own(regions.map().get(end, pick)))
        });
        moved
            .filter(|(_, _, before, after)| before != after)
            .collect()
    };
    if now.is_empty() {
        return Ok(());
    }
    spread(&mut work.design)?;
    let maps = work.design.maps_mut();
    for (end, pick, _, own) in now {
        let (warp, weft) = match own {
            Some(own) => (own.warp, own.weft),
            None => (
                usual.warp(i64::from(end), i64::from(pick)),
                usual.weft(i64::from(end), i64::from(pick)),
            ),
        };
        if let (YarnMap::Crossings(ends), YarnMap::Crossings(picks)) =
            (&mut maps.warp, &mut maps.weft)
        {
            ends.set(end, pick, warp);
            picks.set(end, pick, weft);
        }
    }
    Ok(())
}

/// Writes the orders out crossing by crossing.
fn spread(design: &mut Design) -> Result<(), EditError> {
    let (ends, picks) = (design.ends(), design.picks());
    let maps = design.maps();
    let warp = match &maps.warp {
        YarnMap::Crossings(_) => None,
        YarnMap::Order(_) => Some(Grid::from_fn(ends, picks, |end, pick| {
            maps.warp(i64::from(end), i64::from(pick))
        })?),
    };
    let weft = match &maps.weft {
        YarnMap::Crossings(_) => None,
        YarnMap::Order(_) => Some(Grid::from_fn(ends, picks, |end, pick| {
            maps.weft(i64::from(end), i64::from(pick))
        })?),
    };
    let maps = design.maps_mut();
    if let Some(warp) = warp {
        maps.warp = YarnMap::Crossings(warp);
    }
    if let Some(weft) = weft {
        maps.weft = YarnMap::Crossings(weft);
    }
    Ok(())
}

/// Gives a region yarns of its own, or the design's again; without any such region left
/// the design has orders again and can be woven.
pub(super) fn set_yarns(
    work: &mut Work,
    region: u16,
    yarns: Option<RegionYarns>,
) -> Result<(), EditError> {
    check(&mut work.design, region)?;
    if let Some(own) = yarns {
        check_yarns(&work.design, own)?;
    }
    let usual = usual_yarns(&work.design).unwrap_or_else(|| work.design.maps().clone());
    entry(&mut work.design, region)?.yarns = yarns;
    let regions = of(&mut work.design)?;
    let maps = regions.yarn_maps(&usual)?;
    *work.design.maps_mut() = maps;
    Ok(())
}

/// One region that weaves the whole drawdown, and then an edit of it.
pub(super) fn become_jacquard(work: &mut Work, then: Option<Edit>) -> Result<(), EditError> {
    let fill = match work.design.structure() {
        Structure::Regions(_) => None,
        Structure::Weave(filled) => Some(filled.fill().clone()),
        _ => Some(Fill::drawn(work.drawdown.clone())),
    };
    if let Some(fill) = fill {
        let map = Grid::filled(work.design.ends(), work.design.picks(), 0)?;
        let regions = Regions::new(map, vec![Region::new("ground", fill)], None)?;
        *work.design.structure_mut() = Structure::Regions(regions);
    }
    match then {
        Some(edit) => work.apply(edit),
        None => Ok(()),
    }
}
