//! The drawing mirrored, turned by a quarter, or seen from the other face.

use super::document::Work;
use super::error::EditError;
use super::whole::put;
use crate::design::{
    Corrections, Draft, Fill, Filled, Grid, Lattice, Lifting, Regions, Repeat, Shed, Structure,
    Ties, WeavePattern, YarnMap,
};

/// What is done to the drawing.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Turn {
    /// Left and right exchanged.
    Mirror,
    /// Top and bottom exchanged.
    Upset,
    /// A quarter anticlockwise: what was to the right is above.
    Quarter,
    /// Warp and weft exchanged on the face.
    Invert,
}

impl Turn {
    /// The size of what had size (ends, picks).
    fn size(self, (ends, picks): (u32, u32)) -> (u32, u32) {
        match self {
            Self::Quarter => (picks, ends),
            _ => (ends, picks),
        }
    }

    /// Which old crossing lies at (end, pick) of the turned drawing, for one of old size
    /// (ends, picks); also beyond its edges.
    fn source(self, (ends, picks): (u32, u32), end: i64, pick: i64) -> (i64, i64) {
        match self {
            Self::Mirror => (i64::from(ends) - 1 - end, pick),
            Self::Upset => (end, i64::from(picks) - 1 - pick),
            Self::Quarter => (pick, i64::from(picks) - 1 - end),
            Self::Invert => (end, pick),
        }
    }

    /// A pattern of the design, turned.
    fn pattern(self, old: &WeavePattern) -> WeavePattern {
        if self == Self::Invert {
            return old.inverted();
        }
        let size = (old.ends(), old.picks());
        let (ends, picks) = self.size(size);
        WeavePattern::from_fn(ends, picks, |end, pick| {
            let (end, pick) = self.source(size, i64::from(end), i64::from(pick));
            old.get_wrapped(end, pick)
        })
    }

    fn grid<T: Copy + PartialEq>(self, old: &Grid<T>) -> Result<Grid<T>, EditError> {
        let size = (old.ends(), old.picks());
        let (ends, picks) = self.size(size);
        Ok(Grid::from_fn(ends, picks, |end, pick| {
            let (end, pick) = self.source(size, i64::from(end), i64::from(pick));
            old.get_wrapped(end, pick)
        })?)
    }

    /// A small weave with its (0, 0) at `origin` in a design of old size `design`, turned
    /// with the design; its new origin is (0, 0). The same one where it looks alike.
    fn fill(self, fill: &Fill, origin: (i32, i32), design: (u32, u32)) -> (Fill, (i32, i32)) {
        let old = fill.pattern();
        let (ends, picks) = self.size((old.ends(), old.picks()));
        let pattern = WeavePattern::from_fn(ends, picks, |end, pick| {
            let (end, pick) = self.source(design, i64::from(end), i64::from(pick));
            let (end, pick) = (end - i64::from(origin.0), pick - i64::from(origin.1));
            old.get_wrapped(end, pick) != (self == Self::Invert)
        });
        match pattern == *old {
            true => (fill.clone(), (0, 0)),
            false => (Fill::drawn(pattern), (0, 0)),
        }
    }

    /// A shaft draft, turned: exact, since a crossing is up where the end's shafts meet the
    /// pick's, which does not care which of them is called which.
    fn draft(self, draft: &Draft) -> Result<Draft, EditError> {
        let backwards =
            |ties: &Ties| Ties::from_rows((0..ties.len()).rev().map(|row| ties.row(row)));
        let (threading, lifting) = (draft.threading(), draft.lifting());
        let (shafts, treadles, shed) = (draft.shafts(), draft.treadles(), draft.shed());
        let made = match (self, lifting) {
            (Self::Mirror, _) => Draft::new(
                shafts,
                treadles,
                shed,
                backwards(threading),
                lifting.clone(),
            ),
            (Self::Upset, Lifting::LiftPlan(plan)) => {
                let lifting = Lifting::LiftPlan(backwards(plan));
                Draft::new(shafts, treadles, shed, threading.clone(), lifting)
            }
            (Self::Upset, Lifting::Treadled { tieup, treadling }) => {
                let (tieup, treadling) = (tieup.clone(), backwards(treadling));
                let lifting = Lifting::Treadled { tieup, treadling };
                Draft::new(shafts, treadles, shed, threading.clone(), lifting)
            }
            (Self::Quarter, Lifting::LiftPlan(plan)) => {
                let lifting = Lifting::LiftPlan(threading.clone());
                Draft::new(shafts, treadles, shed, backwards(plan), lifting)
            }
            (Self::Quarter, Lifting::Treadled { tieup, treadling }) => {
                let mut tied = vec![Vec::new(); shafts as usize];
                for (treadle, row) in tieup.iter().enumerate() {
                    for &shaft in row {
                        tied[usize::from(shaft)].push(treadle as u16);
                    }
                }
                let lifting = Lifting::Treadled {
                    tieup: Ties::from_rows(tied),
                    treadling: threading.clone(),
                };
                Draft::new(treadles, shafts, shed, backwards(treadling), lifting)
            }
            (Self::Invert, _) => {
                let shed = match shed {
                    Shed::Rising => Shed::Sinking,
                    Shed::Sinking => Shed::Rising,
                };
                Draft::new(shafts, treadles, shed, threading.clone(), lifting.clone())
            }
        };
        Ok(made?)
    }

    /// The lattice of a design of old size (ends, picks), turned.
    fn lattice(self, lattice: Lattice, (ends, picks): (u32, u32)) -> Lattice {
        let back = |repeat, period: u32| match repeat {
            Repeat::Dropped(by) => Repeat::Dropped((period - by % period) % period),
            other => other,
        };
        match self {
            Self::Mirror | Self::Upset => Lattice {
                across: back(lattice.across, picks),
                along: back(lattice.along, ends),
            },
            Self::Quarter => Lattice {
                across: match lattice.along {
                    Repeat::Dropped(by) => Repeat::Dropped((ends - by % ends) % ends),
                    other => other,
                },
                along: match lattice.across {
                    Repeat::Dropped(by) => Repeat::Dropped((picks - by % picks) % picks),
                    other => other,
                },
            },
            Self::Invert => lattice,
        }
    }
}

/// The design with its drawing turned; yarns given by crossing turn with it, orders stay.
pub(super) fn turned(work: &mut Work, turn: Turn) -> Result<(), EditError> {
    let old = work.design.clone();
    let size = (old.ends(), old.picks());
    let structure = match old.structure() {
        Structure::Pattern(pattern) => Structure::Pattern(turn.pattern(pattern)),
        Structure::Draft(draft) => Structure::Draft(turn.draft(draft)?),
        Structure::Weave(filled) => {
            let (fill, _) = turn.fill(filled.fill(), (0, 0), size);
            let (ends, picks) = turn.size(size);
            Structure::Weave(Filled::new(fill, ends, picks)?)
        }
        Structure::Regions(regions) => {
            let mut palette = regions.palette().to_vec();
            for region in &mut palette {
                (region.fill, region.origin) = turn.fill(&region.fill, region.origin, size);
            }
            let corrections = match regions.corrections() {
                None => None,
                Some(kept) if turn == Turn::Invert => {
                    let said = kept.value().inverted();
                    Some(Corrections::new(kept.mask().clone(), said)?)
                }
                Some(kept) => {
                    let (mask, value) = (turn.pattern(kept.mask()), turn.pattern(kept.value()));
                    Some(Corrections::new(mask, value)?)
                }
            };
            let map = turn.grid(regions.map())?;
            let regions =
                Regions::new(map, palette, corrections)?.with_source(regions.source().cloned());
            Structure::Regions(regions)
        }
    };
    let mut maps = old.maps().clone();
    for map in [&mut maps.warp, &mut maps.weft] {
        if let YarnMap::Crossings(grid) = map {
            *grid = turn.grid(grid)?;
        }
    }
    let lattice = turn.lattice(old.lattice(), size);
    put(work, structure, maps, None, lattice)
}
