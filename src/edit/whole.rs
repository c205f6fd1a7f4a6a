//! Edits of the whole design: sett, repeat, size, mirror and turns.
//!
//! Resizing, cropping and tiling look at the endless cloth through another window: ends and
//! picks keep their yarns and pitches. Rolling, mirroring, turning and inverting change the
//! drawing alone: the yarns stay on the loom as they are, except those given by crossing,
//! which are part of the drawing. A region's weave runs on from its origin.

use super::document::Work;
use super::error::EditError;
use super::turn::{Turn, turned};
use crate::design::{
    Corrections, Density, Design, Direction, Draft, Fill, Filled, Grid, Lattice, Lifting, Regions,
    Repeat, Sett, Structure, Ties, WeavePattern, YarnId, YarnMap, YarnMaps, check_size,
};

/// Threads per length; everything else stays.
pub(super) fn set_sett(work: &mut Work, sett: Sett) -> Result<(), EditError> {
    work.design = work.design.clone().with_sett(sett)?;
    Ok(())
}

/// How the design repeats.
pub(super) fn set_lattice(work: &mut Work, lattice: Lattice) -> Result<(), EditError> {
    work.design = work.design.clone().with_lattice(lattice)?;
    Ok(())
}

/// From (0, 0) on, so many ends and picks.
pub(super) fn resize(work: &mut Work, ends: u32, picks: u32) -> Result<(), EditError> {
    let lattice = work.design.lattice();
    window(work, (0, 0), (ends, picks), lattice, true)
}

/// A box of the design.
pub(super) fn crop(work: &mut Work, rect: super::Rect) -> Result<(), EditError> {
    let inside = |from: u32, size: u32, whole: u32| {
        size > 0 && from.checked_add(size).is_some_and(|to| to <= whole)
    };
    let design = &work.design;
    if !inside(rect.end, rect.ends, design.ends()) || !inside(rect.pick, rect.picks, design.picks())
    {
        return Err(EditError::Value {
            place: "crop",
            problem: "the box reaches out of the design: keep it inside".to_owned(),
        });
    }
    let lattice = design.lattice();
    let from = (i64::from(rect.end), i64::from(rect.pick));
    window(work, from, (rect.ends, rect.picks), lattice, true)
}

/// The repeat written out several times; a dropped one with the drop of as many.
pub(super) fn tile(work: &mut Work, across: u32, along: u32) -> Result<(), EditError> {
    let (ends, picks) = (work.design.ends(), work.design.picks());
    check_size(
        u64::from(ends) * u64::from(across),
        u64::from(picks) * u64::from(along),
    )?;
    let size = (ends * across, picks * along);
    let drop = |repeat: Repeat, copies: u32, period: u32| match repeat {
        Repeat::Dropped(by) => {
            Repeat::Dropped((u64::from(by) * u64::from(copies) % u64::from(period)) as u32)
        }
        other => other,
    };
    let lattice = work.design.lattice();
    let lattice = Lattice {
        across: drop(lattice.across, across, size.1),
        along: drop(lattice.along, along, size.0),
    };
    // A panel that does not repeat would stay empty beyond its first copy.
    let panel = |repeat| matches!(repeat, Repeat::None);
    let before = work.design.lattice();
    if (panel(before.across) && across > 1) || (panel(before.along) && along > 1) {
        return Err(EditError::Value {
            place: "tile",
            problem: "the design does not repeat this way: give it a repeat first".to_owned(),
        });
    }
    window(work, (0, 0), size, lattice, true)
}

/// The drawing moved within its repeat.
pub(super) fn roll(work: &mut Work, ends: i32, picks: i32) -> Result<(), EditError> {
    let size = (work.design.ends(), work.design.picks());
    let lattice = work.design.lattice();
    // A panel is rolled as if it repeated: nothing is lost at its edges.
    let repeats = |repeat| match repeat {
        Repeat::None => Repeat::Straight,
        other => other,
    };
    work.design = work.design.clone().with_lattice(Lattice {
        across: repeats(lattice.across),
        along: repeats(lattice.along),
    })?;
    window(
        work,
        (-i64::from(ends), -i64::from(picks)),
        size,
        lattice,
        false,
    )
}

/// The design seen through a window of the endless cloth: `size` crossings from `from` on.
/// `threads`: whether yarns and pitches come along.
fn window(
    work: &mut Work,
    from: (i64, i64),
    size: (u32, u32),
    lattice: Lattice,
    threads: bool,
) -> Result<(), EditError> {
    check_size(u64::from(size.0), u64::from(size.1))?;
    let old = work.design.clone();
    let (ends, picks, by) = (old.ends(), old.picks(), old.lattice());
    let at = |end: u32, pick: u32| {
        by.wrap(
            from.0 + i64::from(end),
            from.1 + i64::from(pick),
            ends,
            picks,
        )
    };
    let structure = match old.structure() {
        Structure::Pattern(pattern) => Structure::Pattern(seen(pattern, size, at)),
        Structure::Weave(filled) => {
            let fill = moved(filled.fill(), from);
            Structure::Weave(Filled::new(fill, size.0, size.1)?)
        }
        Structure::Draft(draft) => Structure::Draft(draft_window(draft, by, from, size)?),
        Structure::Regions(regions) => {
            let map = Grid::from_fn(size.0, size.1, |end, pick| {
                at(end, pick).map_or(0, |(end, pick)| regions.map().get(end, pick))
            })?;
            let corrections = match regions.corrections() {
                Some(kept) => Some(Corrections::new(
                    seen(kept.mask(), size, at),
                    seen(kept.value(), size, at),
                )?),
                None => None,
            };
            let mut palette = regions.palette().to_vec();
            for region in &mut palette {
                let fill = region.fill.pattern();
                region.origin = (
                    within(i64::from(region.origin.0) - from.0, fill.ends()),
                    within(i64::from(region.origin.1) - from.1, fill.picks()),
                );
            }
            let regions =
                Regions::new(map, palette, corrections)?.with_source(regions.source().cloned());
            Structure::Regions(regions)
        }
    };
    let order = |map: &YarnMap, first: i64| -> Result<YarnMap, EditError> {
        Ok(match map {
            YarnMap::Order(list) if threads => YarnMap::Order(rotated(list, first)),
            YarnMap::Order(list) => YarnMap::Order(list.clone()),
            YarnMap::Crossings(grid) => {
                YarnMap::Crossings(Grid::from_fn(size.0, size.1, |end, pick| {
                    at(end, pick).map_or(YarnId(0), |(end, pick)| grid.get(end, pick))
                })?)
            }
        })
    };
    let maps = YarnMaps {
        warp: order(&old.maps().warp, from.0)?,
        weft: order(&old.maps().weft, from.1)?,
    };
    let sett = old.sett().clone();
    let pitches = |density: &Density, first: i64| Density {
        per_cm: density.per_cm,
        pitches_mm: density.pitches_mm.as_ref().map(|list| rotated(list, first)),
    };
    let sett = match threads {
        true => Sett {
            ends: pitches(&sett.ends, from.0),
            picks: pitches(&sett.picks, from.1),
            assumed: sett.assumed,
        },
        false => sett,
    };
    put(work, structure, maps, Some(sett), lattice)
}

/// Puts a design of other parts in the place of the old one.
pub(super) fn put(
    work: &mut Work,
    structure: Structure,
    maps: YarnMaps,
    sett: Option<Sett>,
    lattice: Lattice,
) -> Result<(), EditError> {
    let old = work.design.clone();
    let (yarns, colourways) = (old.yarns().to_vec(), old.colourways().to_vec());
    let mut design = old
        .with_parts(structure, yarns, maps, colourways)?
        .with_lattice(lattice)?;
    if let Some(sett) = sett {
        design = design.with_sett(sett)?;
    }
    work.replace(design);
    Ok(())
}

/// A list as it repeats from thread `first` on.
fn rotated<T: Copy>(list: &[T], first: i64) -> Vec<T> {
    let mut list = list.to_vec();
    if !list.is_empty() {
        let by = first.rem_euclid(list.len() as i64) as usize;
        list.rotate_left(by);
    }
    list
}

/// A place within a period, as an origin is written.
fn within(place: i64, period: u32) -> i32 {
    place.rem_euclid(i64::from(period)) as i32
}

/// A pattern through a window; outside there is weft.
fn seen(
    pattern: &WeavePattern,
    size: (u32, u32),
    at: impl Fn(u32, u32) -> Option<(u32, u32)>,
) -> WeavePattern {
    WeavePattern::from_fn(size.0, size.1, |end, pick| {
        at(end, pick).is_some_and(|(end, pick)| pattern.get(end, pick))
    })
}

/// A weave as it repeats from (end, pick) on; the same one where it closes there.
fn moved(fill: &Fill, from: (i64, i64)) -> Fill {
    let old = fill.pattern();
    let pattern = WeavePattern::from_fn(old.ends(), old.picks(), |end, pick| {
        old.get_wrapped(from.0 + i64::from(end), from.1 + i64::from(pick))
    });
    match pattern == *old {
        true => fill.clone(),
        false => Fill::drawn(pattern),
    }
}

/// The threads of a draft through a window.
fn draft_window(
    draft: &Draft,
    lattice: Lattice,
    from: (i64, i64),
    size: (u32, u32),
) -> Result<Draft, EditError> {
    let (ends, picks) = (draft.ends(), draft.picks());
    let dropped = |repeat| matches!(repeat, Repeat::Dropped(by) if by != 0);
    let outside = from.0 < 0
        || from.1 < 0
        || from.0 + i64::from(size.0) > i64::from(ends)
        || from.1 + i64::from(size.1) > i64::from(picks);
    if outside && (dropped(lattice.across) || dropped(lattice.along)) {
        return Err(EditError::NoPart {
            part: "straight repeat",
            remedy: "a draft cannot follow a dropped one; make it a drawdown first",
        });
    }
    let rows = |ties: &Ties, first: i64, size: u32, period: u32, repeat: Repeat| {
        Ties::from_rows((0..i64::from(size)).map(|place| {
            let place = first + place;
            let inside = (0..i64::from(period)).contains(&place) || repeat != Repeat::None;
            let row = place.rem_euclid(i64::from(period)) as usize;
            if inside { ties.row(row) } else { &[] }
        }))
    };
    let threading = rows(draft.threading(), from.0, size.0, ends, lattice.across);
    let lifts = |ties: &Ties| rows(ties, from.1, size.1, picks, lattice.along);
    let lifting = match draft.lifting() {
        Lifting::LiftPlan(plan) => Lifting::LiftPlan(lifts(plan)),
        Lifting::Treadled { tieup, treadling } => Lifting::Treadled {
            tieup: tieup.clone(),
            treadling: lifts(treadling),
        },
    };
    super::drafts::rebuilt(draft, threading, lifting)
}

/// Left and right, or top and bottom, change places.
pub(super) fn mirror(work: &mut Work, direction: Direction) -> Result<(), EditError> {
    turned(
        work,
        match direction {
            Direction::Warp => Turn::Mirror,
            Direction::Weft => Turn::Upset,
        },
    )
}

/// Quarters, anticlockwise.
pub(super) fn rotate(work: &mut Work, quarters: u8) -> Result<(), EditError> {
    for _ in 0..quarters % 4 {
        turned(work, Turn::Quarter)?;
    }
    Ok(())
}

/// Warp and weft exchanged on the face.
pub(super) fn invert(work: &mut Work) -> Result<(), EditError> {
    turned(work, Turn::Invert)
}

/// Another sett for cloth of the same size: a jacquard's artwork is resampled (nearest
/// crossing), other weaves repeat over the threads that then fit; stripes keep their width.
pub(super) fn set_sett_keep_size(work: &mut Work, sett: Sett) -> Result<(), EditError> {
    if let Some(fault) = sett.fault() {
        return Err(EditError::Value {
            place: "sett",
            problem: fault,
        });
    }
    let old = work.design.clone();
    let ratio = |old: &Density, new: &Density| {
        f64::from(old.mean_pitch_mm()) / f64::from(new.mean_pitch_mm())
    };
    let by = (
        ratio(&old.sett().ends, &sett.ends),
        ratio(&old.sett().picks, &sett.picks),
    );
    let scaled = |threads: u32, by: f64| (f64::from(threads) * by).round().max(1.0) as u64;
    let (ends, picks) = (scaled(old.ends(), by.0), scaled(old.picks(), by.1));
    check_size(ends, picks)?;
    let (ends, picks) = (ends as u32, picks as u32);
    let at = |end, pick| {
        (
            nearest(end, ends, old.ends()),
            nearest(pick, picks, old.picks()),
        )
    };
    let resampled = |pattern: &WeavePattern| {
        WeavePattern::from_fn(ends, picks, |end, pick| {
            let (end, pick) = at(end, pick);
            pattern.get(end, pick)
        })
    };
    let structure = match old.structure() {
        Structure::Regions(regions) => {
            let map = Grid::from_fn(ends, picks, |end, pick| {
                let (end, pick) = at(end, pick);
                regions.map().get(end, pick)
            })?;
            let corrections = match regions.corrections() {
                Some(kept) => Some(Corrections::new(
                    resampled(kept.mask()),
                    resampled(kept.value()),
                )?),
                None => None,
            };
            let palette = regions.palette().to_vec();
            let regions = Regions::new(map, palette, corrections)?;
            Structure::Regions(regions.with_source(source(&old)))
        }
        _ => {
            // The weave runs on over the threads that fit; the yarns are dealt with below.
            let lattice = old.lattice();
            window(work, (0, 0), (ends, picks), lattice, false)?;
            work.design.structure().clone()
        }
    };
    let stretched = |map: &YarnMap, by: f64| -> Result<YarnMap, EditError> {
        Ok(match map {
            YarnMap::Order(list) if list.len() > 1 => {
                let period = scaled(list.len() as u32, by).min(1 << 20) as u32;
                let of = |place| list[nearest(place, period, list.len() as u32) as usize];
                YarnMap::Order((0..period).map(of).collect())
            }
            YarnMap::Order(list) => YarnMap::Order(list.clone()),
            YarnMap::Crossings(grid) => YarnMap::Crossings(Grid::from_fn(ends, picks, |e, p| {
                let (end, pick) = at(e, p);
                grid.get(end, pick)
            })?),
        })
    };
    let maps = YarnMaps {
        warp: stretched(&old.maps().warp, by.0)?,
        weft: stretched(&old.maps().weft, by.1)?,
    };
    let lattice = old.lattice();
    put(work, structure, maps, Some(sett), lattice)
}

fn source(design: &Design) -> Option<std::sync::Arc<crate::design::SourceImage>> {
    match design.structure() {
        Structure::Regions(regions) => regions.source().cloned(),
        _ => None,
    }
}

/// The place among `old` threads of the middle of thread `place` of `new`.
fn nearest(place: u32, new: u32, old: u32) -> u32 {
    let twice = (2 * u64::from(place) + 1) * u64::from(old) / (2 * u64::from(new).max(1));
    (twice as u32).min(old.saturating_sub(1))
}
