//! Crossings made ready in advance, for the part of the cloth that a picture shows.
//!
//! Nothing here decides anything: it is what [`ClothVolume`] would find out again and
//! again, kept for a rectangle of crossings. Outside it the same is found out on the spot.

use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::ops::Range;
use std::sync::OnceLock;

use rayon::prelude::*;

use super::build::ClothVolume;
use crate::design::{Positions, YarnId};
use crate::synthesis::{Face, Neighbourhood, Side};

/// Most crossings that are made ready: a picture of more is not close enough to need it.
const MOST: usize = 1 << 21;
/// Most memory in which shifts are kept, once worked out, bytes.
const MOST_SHIFTS: usize = 1 << 28;
/// Threads kept beyond the rectangle, for yarns that bulge past it.
const MARGIN: i64 = 8;

/// A thread of the window.
#[derive(Debug, Clone, Copy)]
pub(super) struct Thread {
    /// Where its stretch starts, mm.
    pub start: f32,
    /// Voxels a mm across it.
    pub per_mm: f32,
}

/// The shifts of all stacks of a crossing under one face's field, voxels upwards, x fastest,
/// once worked out.
pub(super) type KeptShifts = OnceLock<Box<[f32]>>;

/// A crossing made ready: its threads, what stands around it (`None`: no cloth) and where the
/// window keeps its shifts, where it does.
pub(super) type Ready = (Thread, Thread, Option<Neighbourhood>, Option<usize>);

/// Of a crossing whose shifts are not kept: it has no seam, or there were too many.
const NOT_KEPT: u32 = u32::MAX;

/// A rectangle of crossings made ready.
#[derive(Default)]
pub(super) struct Window {
    end: i64,
    pick: i64,
    width: usize,
    height: usize,
    /// Row by row; `None` where there is no cloth.
    cells: Vec<Option<Neighbourhood>>,
    /// Which shifts each of them has, or [`NOT_KEPT`]: a cloth repeats its blocks, and equal
    /// neighbourhoods are shifted alike.
    kept: Vec<u32>,
    /// Shifts of the stacks of each kind of neighbourhood, front and back, worked out when
    /// first needed.
    shifts: Vec<[KeptShifts; 2]>,
    ends: Vec<Thread>,
    picks: Vec<Thread>,
    /// Yarns of the ends and picks, with margins; empty when they change along a thread.
    warp: Vec<YarnId>,
    weft: Vec<YarnId>,
}

impl Window {
    /// Position of a crossing in the window.
    #[inline]
    fn index(&self, end: i64, pick: i64) -> Option<(usize, usize)> {
        let (x, y) = (
            end.wrapping_sub(self.end) as usize,
            pick.wrapping_sub(self.pick) as usize,
        );
        (x < self.width && y < self.height).then_some((x, y))
    }

    /// A crossing that was made ready: its threads and what stands around it. The inner
    /// `None`: there is no cloth.
    #[inline]
    pub fn crossing(&self, end: i64, pick: i64) -> Option<Ready> {
        let (x, y) = self.index(end, pick)?;
        let place = y * self.width + x;
        let kept = self.kept[place];
        let kept = (kept != NOT_KEPT).then_some(kept as usize);
        Some((self.ends[x], self.picks[y], self.cells[place], kept))
    }

    /// The block shown at a crossing that was made ready.
    #[inline]
    pub fn block(&self, end: i64, pick: i64) -> Option<Option<u16>> {
        let (x, y) = self.index(end, pick)?;
        let around = self.cells[y * self.width + x];
        Some(around.map(|around| around.centre.block))
    }

    /// Where the shifts of the crossing at a place are kept.
    #[inline]
    pub fn shifts(&self, place: usize, face: Face) -> Option<&KeptShifts> {
        Some(&self.shifts.get(place)?[face as usize])
    }

    /// The yarn of an end.
    #[inline]
    pub fn warp(&self, end: i64) -> Option<YarnId> {
        self.warp
            .get(end.wrapping_sub(self.end - MARGIN) as usize)
            .copied()
    }

    /// The yarn of a pick.
    #[inline]
    pub fn weft(&self, pick: i64) -> Option<YarnId> {
        self.weft
            .get(pick.wrapping_sub(self.pick - MARGIN) as usize)
            .copied()
    }
}

/// Which kind of neighbourhood each crossing has, of those that have a seam, and how many kinds
/// there are: no more than `most`, the others are [`NOT_KEPT`].
fn kinds(cells: &[Option<Neighbourhood>], most: usize) -> (Vec<u32>, usize) {
    let mut known: HashMap<Neighbourhood, u32> = HashMap::new();
    let kept = cells.iter().map(|around| {
        let Some(around) = around.filter(|around| around.sides != [None; 4]) else {
            return NOT_KEPT;
        };
        let next = known.len();
        match known.entry(around) {
            Entry::Occupied(kind) => *kind.get(),
            Entry::Vacant(_) if next >= most => NOT_KEPT,
            Entry::Vacant(new) => *new.insert(next as u32),
        }
    });
    let kept = kept.collect();
    (kept, known.len())
}

impl ClothVolume {
    /// The same cloth with positions counted from a place (mm), see [`Positions::seen_from`];
    /// a window of it is to be made anew.
    pub fn seen_from(mut self, [x, y]: [f64; 2]) -> Self {
        self.ends = self.ends.seen_from(x);
        self.picks = self.picks.seen_from(y);
        self.window = Window::default().into();
        self
    }

    /// Makes the crossings of a rectangle of cloth ready (mm), as far as they are not too
    /// many. Pictures are the same with or without it.
    pub fn with_window(mut self, x: Range<f32>, y: Range<f32>) -> Self {
        self.window = self.window_over(x, y, MARGIN, MOST_SHIFTS).into();
        self
    }

    /// As [`ClothVolume::with_window`] for a box of voxels that are looked up once: one
    /// crossing more all round and little memory.
    pub(super) fn with_small_window(mut self, x: Range<f32>, y: Range<f32>) -> Self {
        self.window = self.window_over(x, y, 1, MOST_SHIFTS / 8).into();
        self
    }

    fn window_over(&self, x: Range<f32>, y: Range<f32>, margin: i64, most_shifts: usize) -> Window {
        let first = |positions: &Positions, range: &Range<f32>| {
            let [from, to] = [range.start, range.end].map(|mm| positions.locate(mm.into()).0);
            (
                from - margin,
                (to - from).clamp(0, 1 << 20) as usize + 1 + 2 * margin as usize,
            )
        };
        let ((end, width), (pick, height)) = (first(&self.ends, &x), first(&self.picks, &y));
        if width.saturating_mul(height) > MOST {
            return Window::default();
        }
        let [bx, by, _] = self.grid.block;
        let threads = |positions: &Positions, first: i64, count: usize, voxels| {
            let thread = |thread| Thread {
                start: positions.start(thread) as f32,
                per_mm: voxels as f32 / positions.pitch(thread) as f32,
            };
            (first..first + count as i64)
                .map(thread)
                .collect::<Vec<_>>()
        };
        let cells: Vec<_> = (0..width * height)
            .into_par_iter()
            .map(|index| {
                let (x, y) = ((index % width) as i64, (index / width) as i64);
                self.seams_around(end + x, pick + y)
            })
            .collect();
        let yarns =
            |map: &crate::design::YarnMap, at: &dyn Fn(i64) -> YarnId, first: i64, count| {
                let range = first - MARGIN..first + count as i64 + MARGIN;
                if map.order().is_some() {
                    range.map(at).collect()
                } else {
                    Vec::new()
                }
            };
        let bytes = 2 * bx * by * size_of::<f32>();
        let (kept, kinds) = kinds(&cells, most_shifts / bytes.max(1));
        Window {
            end,
            pick,
            width,
            height,
            cells,
            kept,
            shifts: (0..kinds).map(|_| Default::default()).collect(),
            ends: threads(&self.ends, end, width, bx),
            picks: threads(&self.picks, pick, height, by),
            warp: yarns(&self.maps.warp, &|end| self.warp_yarn(end, 0), end, width),
            weft: yarns(
                &self.maps.weft,
                &|pick| self.weft_yarn(0, pick),
                pick,
                height,
            ),
        }
    }

    /// A crossing's block and the neighbours that it has a seam with; neighbours that shift
    /// nothing, as they continue it, are left out.
    pub(super) fn seams_around(&self, end: i64, pick: i64) -> Option<Neighbourhood> {
        let set_at = |end, pick| self.set_at(end, pick);
        let mut around = self.placement().neighbourhood(end, pick, set_at)?;
        for side in Side::ALL {
            let beside = &mut around.sides[side.index()];
            let shifts = beside.is_some_and(|beside| {
                (Face::ALL.into_iter()).any(|face| {
                    self.edge_fix
                        .shifts_across(around.centre, side, beside, face)
                })
            });
            if !shifts {
                *beside = None;
            }
        }
        Some(around)
    }
}
