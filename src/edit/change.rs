//! What differs between two states of a document, so that a view draws only that again.

use std::collections::BTreeMap;

use super::cells::Rect;
use super::history::State;
use crate::design::{Design, Grid, Structure, WeavePattern, YarnMap};

/// Boxes named one by one; beyond, they are joined.
const MOST_RECTS: usize = 64;

/// The crossings that differ.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum Touched {
    /// None.
    #[default]
    None,
    /// Those in these boxes, at most 64 of them and apart from each other.
    Rects(Vec<Rect>),
    /// All, or the design has another size.
    All,
}

impl Touched {
    /// The boxes of a design of `ends` × `picks`.
    pub fn rects(&self, ends: u32, picks: u32) -> Vec<Rect> {
        match self {
            Self::None => Vec::new(),
            Self::Rects(rects) => rects.clone(),
            Self::All => vec![Rect {
                end: 0,
                pick: 0,
                ends,
                picks,
            }],
        }
    }

    /// Whether there are none.
    pub fn is_none(&self) -> bool {
        *self == Self::None
    }
}

/// What an edit changed. Everything false and no crossings: nothing.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Change {
    /// Crossings whose drawdown, region, hand correction or own yarn differs.
    pub crossings: Touched,
    /// The yarns, their order, or the yarns of a region.
    pub yarns: bool,
    /// The colourways.
    pub colourways: bool,
    /// Ends or picks.
    pub size: bool,
    /// The sett.
    pub sett: bool,
    /// How the design repeats.
    pub lattice: bool,
    /// Threading, tie-up, treadling, the list of regions, or the kind of structure.
    pub structure: bool,
    /// Name, notes, the name of the own yarns, or what is kept of the file.
    pub words: bool,
}

impl Change {
    /// Whether nothing changed at all.
    pub fn is_nothing(&self) -> bool {
        *self == Self::default()
    }

    /// What differs between two states.
    pub(super) fn between(before: &State, after: &State) -> Self {
        let parts = Self::of_parts(&before.design, &after.design);
        let crossings = match parts.size {
            true => Touched::All,
            false => touched(before, after),
        };
        Self { crossings, ..parts }
    }

    /// What differs between two designs beside their crossings.
    pub(super) fn of_parts(old: &Design, new: &Design) -> Self {
        let size = (old.ends(), old.picks()) != (new.ends(), new.picks());
        let own_yarns = |structure: &Structure| match structure {
            Structure::Regions(regions) => {
                let own = regions.palette().iter().map(|region| region.yarns);
                own.collect()
            }
            _ => Vec::new(),
        };
        Self {
            crossings: Touched::None,
            yarns: old.yarns() != new.yarns()
                || orders_differ(&old.maps().warp, &new.maps().warp)
                || orders_differ(&old.maps().weft, &new.maps().weft)
                || own_yarns(old.structure()) != own_yarns(new.structure()),
            colourways: old.colourways() != new.colourways(),
            size,
            sett: old.sett() != new.sett(),
            lattice: old.lattice() != new.lattice(),
            structure: structure_differs(old.structure(), new.structure()),
            words: old.name != new.name
                || old.notes != new.notes
                || old.colourway != new.colourway
                || old.origin != new.origin,
        }
    }
}

/// Whether two maps differ in more than their crossings, which are listed apart.
fn orders_differ(old: &YarnMap, new: &YarnMap) -> bool {
    match (old, new) {
        (YarnMap::Crossings(_), YarnMap::Crossings(_)) => false,
        _ => old != new,
    }
}

/// Whether two structures differ in more than their crossings.
fn structure_differs(old: &Structure, new: &Structure) -> bool {
    match (old, new) {
        (Structure::Pattern(_), Structure::Pattern(_)) => false,
        (Structure::Draft(old), Structure::Draft(new)) => old != new,
        (Structure::Weave(old), Structure::Weave(new)) => old != new,
        (Structure::Regions(old), Structure::Regions(new)) => {
            old.palette() != new.palette()
                || old.source() != new.source()
                || old.corrections().is_some() != new.corrections().is_some()
        }
        _ => true,
    }
}

/// The crossings that differ between states of one size.
fn touched(before: &State, after: &State) -> Touched {
    let mut tiles = Tiles::default();
    tiles.patterns(&before.drawdown, &after.drawdown);
    if let (Structure::Regions(old), Structure::Regions(new)) =
        (before.design.structure(), after.design.structure())
    {
        tiles.grids(old.map(), new.map());
        match (old.corrections(), new.corrections()) {
            (Some(old), Some(new)) => {
                tiles.patterns(old.mask(), new.mask());
                tiles.patterns(old.value(), new.value());
            }
            (Some(one), None) | (None, Some(one)) => {
                let (ends, picks) = (one.mask().ends(), one.mask().picks());
                tiles.patterns(&WeavePattern::new(ends, picks), one.mask());
            }
            (None, None) => {}
        }
    }
    let (old, new) = (before.design.maps(), after.design.maps());
    for (old, new) in [(&old.warp, &new.warp), (&old.weft, &new.weft)] {
        if let (YarnMap::Crossings(old), YarnMap::Crossings(new)) = (old, new) {
            tiles.grids(old, new);
        }
    }
    tiles.touched(after.design.ends(), after.design.picks())
}

/// What differs in each 64 × 64 tile, by row and column of tiles.
#[derive(Default)]
struct Tiles(BTreeMap<(u32, u32), Rect>);

impl Tiles {
    /// Takes a stretch of a pick that differs, in the tile of a column and row.
    fn add(&mut self, column: u32, row: u32, pick: u32, [end, ends]: [u32; 2]) {
        let rect = Rect {
            end,
            pick,
            ends,
            picks: 1,
        };
        let entry = self.0.entry((row, column)).or_insert(rect);
        *entry = entry.join(rect);
    }

    fn patterns(&mut self, old: &WeavePattern, new: &WeavePattern) {
        for (column, row) in new.unshared(old).into_iter().flatten() {
            for pick in 64 * row..(64 * row + 64).min(new.picks()) {
                let bits = old.pick_word(column, pick) ^ new.pick_word(column, pick);
                if bits != 0 {
                    let end = 64 * column + bits.trailing_zeros();
                    let ends = 64 - bits.leading_zeros() - bits.trailing_zeros();
                    self.add(column, row, pick, [end, ends]);
                }
            }
        }
    }

    fn grids<T: Copy + PartialEq>(&mut self, old: &Grid<T>, new: &Grid<T>) {
        for (column, row) in new.unshared(old).into_iter().flatten() {
            for pick in 64 * row..(64 * row + 64).min(new.picks()) {
                let (mine, theirs) = (new.pick_values(column, pick), old.pick_values(column, pick));
                let differs = |place: &usize| mine[*place] != theirs[*place];
                if let Some(first) = (0..mine.len()).find(differs) {
                    let last = (first..mine.len()).rev().find(differs).unwrap_or(first);
                    let (end, ends) = (64 * column + first as u32, (last - first + 1) as u32);
                    self.add(column, row, pick, [end, ends]);
                }
            }
        }
    }

    /// The boxes of the tiles, joined where there are too many to name.
    fn touched(self, ends: u32, picks: u32) -> Touched {
        let mut rects: Vec<Rect> = Vec::new();
        if self.0.len() <= MOST_RECTS {
            rects.extend(self.0.values());
        } else {
            // One box for each row of tiles, or, where that is too many, one for all.
            let mut rows: BTreeMap<u32, Rect> = BTreeMap::new();
            for (&(row, _), &rect) in &self.0 {
                let entry = rows.entry(row).or_insert(rect);
                *entry = entry.join(rect);
            }
            rects.extend(rows.values());
        }
        if rects.len() > MOST_RECTS {
            rects = rects.into_iter().reduce(Rect::join).into_iter().collect();
        }
        let all = Rect {
            end: 0,
            pick: 0,
            ends,
            picks,
        };
        match rects.as_slice() {
            [] => Touched::None,
            [one] if *one == all => Touched::All,
            _ => Touched::Rects(rects),
        }
    }
}
