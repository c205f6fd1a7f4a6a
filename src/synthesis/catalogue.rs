//! The exemplars' weaves, their blocks, and which blocks fit which neighbourhood.
//!
//! Zhao 2012 §5.3: a block is a *candidate* for a crossing when it has the right yarn on
//! top and, among those, as many matching neighbours as any. A crossing and its four
//! neighbours make a key of five bits, so all candidate lists are built once.

use crate::design::WeavePattern;

use super::chain::Columns;
use super::{SynthesisError, weaves};

/// Where a neighbour lies. The discriminant is the neighbour's bit in a key.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[repr(u8)]
pub enum Side {
    /// End − 1.
    Left = 1,
    /// End + 1.
    Right = 2,
    /// Pick − 1.
    Below = 3,
    /// Pick + 1.
    Above = 4,
}

impl Side {
    /// All four sides in the order of the key's bits.
    pub const ALL: [Self; 4] = [Self::Left, Self::Right, Self::Below, Self::Above];

    /// (ends, picks) to the neighbour.
    pub fn offset(self) -> (i64, i64) {
        match self {
            Self::Left => (-1, 0),
            Self::Right => (1, 0),
            Self::Below => (0, -1),
            Self::Above => (0, 1),
        }
    }

    /// This side seen from the neighbour.
    pub fn opposite(self) -> Self {
        match self {
            Self::Left => Self::Right,
            Self::Right => Self::Left,
            Self::Below => Self::Above,
            Self::Above => Self::Below,
        }
    }

    /// Position in [`Side::ALL`].
    pub fn index(self) -> usize {
        self as usize - 1
    }
}

/// Keys that a crossing can have.
pub const KEYS: usize = 32;

/// The key of a crossing: bit 0 = warp up here, then its neighbours in the order of
/// [`Side::ALL`].
pub fn key_of(here: bool, beside: [bool; 4]) -> u8 {
    Side::ALL
        .iter()
        .zip(beside)
        .fold(u8::from(here), |key, (&side, up)| {
            key | u8::from(up) << side as u8
        })
}

/// The crossing of an exemplar that a block shows: Zhao's triple (u, x, y).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Place {
    /// Index of the exemplar in the catalogue.
    pub exemplar: u16,
    /// End inside the exemplar.
    pub x: u16,
    /// Pick inside the exemplar.
    pub y: u16,
}

/// Stands for "no block" in tables.
pub(super) const NO_BLOCK: u16 = u16::MAX;
/// The neighbours' bits of a key.
const NEIGHBOURS: u8 = 0b11110;

/// The ordered list of exemplar weaves that all exemplar sets share.
///
/// Blocks are numbered exemplar by exemplar, pick by pick: id = base + y · ends + x.
#[derive(Clone)]
pub struct Catalogue {
    weaves: Vec<WeavePattern>,
    wraps: Vec<[bool; 2]>,
    base: Vec<u16>,
    places: Vec<Place>,
    keys: Vec<u8>,
    neighbours: Vec<[u16; 4]>,
    candidates: Vec<Vec<u16>>,
    matches: [u8; 32],
    by_centre: [Vec<u16>; 2],
    symmetries: Vec<Vec<(u16, u16)>>,
    shifted: Vec<u16>,
    shifted_base: Vec<u32>,
    columns: Columns,
}

impl Catalogue {
    /// A catalogue of `weaves`; `wraps[u]` = whether the voxels of exemplar u continue
    /// from its last to its first [end, pick]. The weave itself always repeats straight.
    ///
    /// # Errors
    /// When no crossing has the warp, or none the weft, on top; when there are more blocks
    /// than a `u16` can number; when `wraps` has another length than `weaves`.
    pub fn new(weaves: Vec<WeavePattern>, wraps: Vec<[bool; 2]>) -> Result<Self, SynthesisError> {
        if weaves.len() != wraps.len() {
            return Err(SynthesisError::Wraps {
                weaves: weaves.len(),
                wraps: wraps.len(),
            });
        }
        let blocks: usize = weaves
            .iter()
            .map(|weave| weave.ends() as usize * weave.picks() as usize)
            .sum();
        if blocks > usize::from(NO_BLOCK) {
            return Err(SynthesisError::TooManyBlocks(blocks));
        }

        let catalogue = Self::assemble(weaves, wraps);
        for (warp_up, yarn) in [(true, "warp"), (false, "weft")] {
            if catalogue.correct(warp_up).is_empty() {
                return Err(SynthesisError::NoCandidate(yarn));
            }
        }
        Ok(catalogue)
    }

    /// Builds all tables; candidate lists stay empty where no block is correct.
    fn assemble(weaves: Vec<WeavePattern>, wraps: Vec<[bool; 2]>) -> Self {
        let mut catalogue = Self {
            base: Vec::new(),
            places: Vec::new(),
            keys: Vec::new(),
            neighbours: Vec::new(),
            candidates: vec![Vec::new(); 32],
            matches: [0; 32],
            by_centre: [Vec::new(), Vec::new()],
            symmetries: weaves.iter().map(symmetries).collect(),
            shifted: Vec::new(),
            shifted_base: Vec::new(),
            columns: Columns::default(),
            weaves,
            wraps,
        };
        catalogue.number_blocks();
        catalogue.list_candidates();
        catalogue.tabulate_shifts();
        catalogue.columns = Columns::new(&catalogue);
        catalogue
    }

    /// The catalogue of the built-in recipes: 5-end twills 1/4, 2/3, 3/2, 4/1 of both
    /// hands, 5-end satins of both moves, 2/2 basket, warp rib, weft rib, plain, and one
    /// weave that completes all 32 neighbourhoods. Recipes wrap on both axes.
    pub fn standard() -> Self {
        Self::built_in(weaves::standard())
    }

    /// The eight exemplars of Zhao 2012, which cover 22 of the 32 neighbourhoods.
    pub fn paper() -> Self {
        Self::built_in(weaves::paper())
    }

    fn built_in(weaves: Vec<WeavePattern>) -> Self {
        let wraps = vec![[true; 2]; weaves.len()];
        Self::assemble(weaves, wraps)
    }

    fn number_blocks(&mut self) {
        for (exemplar, weave) in self.weaves.iter().enumerate() {
            let base = self.places.len() as u16;
            self.base.push(base);
            let (ends, picks) = (i64::from(weave.ends()), i64::from(weave.picks()));
            let wraps = self.wraps[exemplar];
            for y in 0..picks {
                for x in 0..ends {
                    let beside = Side::ALL.map(|side| {
                        let (dx, dy) = side.offset();
                        weave.get_wrapped(x + dx, y + dy)
                    });
                    let key = key_of(weave.get_wrapped(x, y), beside);
                    let mut neighbours = [NO_BLOCK; 4];
                    for side in Side::ALL {
                        let (dx, dy) = side.offset();
                        let inside_x = wraps[0] || (0..ends).contains(&(x + dx));
                        let inside_y = wraps[1] || (0..picks).contains(&(y + dy));
                        if inside_x && inside_y {
                            let (x, y) = ((x + dx).rem_euclid(ends), (y + dy).rem_euclid(picks));
                            neighbours[side.index()] = base + (y * ends + x) as u16;
                        }
                    }
                    self.places.push(Place {
                        exemplar: exemplar as u16,
                        x: x as u16,
                        y: y as u16,
                    });
                    self.keys.push(key);
                    self.neighbours.push(neighbours);
                }
            }
        }
        for (block, key) in self.keys.iter().enumerate() {
            self.by_centre[usize::from(key & 1)].push(block as u16);
        }
    }

    fn list_candidates(&mut self) {
        for key in 0..32u8 {
            let correct = &self.by_centre[usize::from(key & 1)];
            let matching = |&block: &u16| matching_neighbours(key, self.keys[usize::from(block)]);
            let best = correct.iter().map(matching).max().unwrap_or(0);
            let list: Vec<u16> = correct
                .iter()
                .copied()
                .filter(|b| matching(b) == best)
                .collect();
            self.candidates[usize::from(key)] = list;
            self.matches[usize::from(key)] = best;
        }
    }

    fn tabulate_shifts(&mut self) {
        for place in &self.places {
            self.shifted_base.push(self.shifted.len() as u32);
            let exemplar = usize::from(place.exemplar);
            let weave = &self.weaves[exemplar];
            for &(a, b) in &self.symmetries[exemplar] {
                let x = (u32::from(place.x) + u32::from(a)) % weave.ends();
                let y = (u32::from(place.y) + u32::from(b)) % weave.picks();
                self.shifted
                    .push(self.base[exemplar] + (y * weave.ends() + x) as u16);
            }
        }
    }

    /// Number of exemplars.
    pub fn exemplars(&self) -> usize {
        self.weaves.len()
    }

    /// Number of blocks.
    pub fn blocks(&self) -> usize {
        self.places.len()
    }

    /// The exemplars' weaves, in order.
    pub fn weaves(&self) -> &[WeavePattern] {
        &self.weaves
    }

    /// Whether the voxels of an exemplar wrap, per [end, pick].
    pub fn wraps(&self, exemplar: usize) -> [bool; 2] {
        self.wraps[exemplar]
    }

    /// Which exemplar and crossing a block shows.
    #[inline]
    pub fn place(&self, block: u16) -> Place {
        self.places[usize::from(block)]
    }

    /// The block that shows a crossing of an exemplar (coordinates inside it).
    pub fn block(&self, place: Place) -> u16 {
        let ends = self.weaves[usize::from(place.exemplar)].ends() as u16;
        self.base[usize::from(place.exemplar)] + place.y * ends + place.x
    }

    /// The five bits of a block: centre, left, right, below, above (bit 0 to bit 4).
    #[inline]
    pub fn key(&self, block: u16) -> u8 {
        self.keys[usize::from(block)]
    }

    /// The block beside this one inside its exemplar; `None` past a border that does not
    /// wrap.
    #[inline]
    pub fn neighbour(&self, block: u16, side: Side) -> Option<u16> {
        let neighbour = self.neighbours[usize::from(block)][side.index()];
        (neighbour != NO_BLOCK).then_some(neighbour)
    }

    /// True when `neighbour` stands beside `block` in the exemplar as it does in the cloth.
    #[inline]
    pub fn continues(&self, block: u16, side: Side, neighbour: u16) -> bool {
        self.neighbours[usize::from(block)][side.index()] == neighbour
    }

    /// The blocks that fit a neighbourhood best: correct, then most matching neighbours.
    #[inline]
    pub fn candidates(&self, key: u8) -> &[u16] {
        &self.candidates[usize::from(key & 31)]
    }

    /// The blocks with the right yarn on top: Zhao's naive choice.
    #[inline]
    pub fn correct(&self, warp_up: bool) -> &[u16] {
        &self.by_centre[usize::from(warp_up)]
    }

    /// How many of the four neighbours no candidate of this key matches (0 = consistent).
    pub fn mismatch(&self, key: u8) -> u8 {
        4 - self.matches[usize::from(key & 31)]
    }

    /// Number of the 32 neighbourhoods that have a consistent candidate.
    pub fn neighbourhoods_covered(&self) -> usize {
        (0..32).filter(|&key| self.mismatch(key) == 0).count()
    }

    /// All (a, b) with S(x + a, y + b) = S(x, y) for the exemplar's weave S; (0, 0) first.
    pub fn symmetries(&self, exemplar: usize) -> &[(u16, u16)] {
        &self.symmetries[exemplar]
    }

    /// The images of a block under its exemplar's symmetries, in their order.
    #[inline]
    pub(super) fn images(&self, block: u16) -> &[u16] {
        let block = usize::from(block);
        let from = self.shifted_base[block] as usize;
        let count = self.symmetries[usize::from(self.places[block].exemplar)].len();
        &self.shifted[from..from + count]
    }

    pub(super) fn columns(&self) -> &Columns {
        &self.columns
    }
}

/// How many of the four neighbours agree.
#[inline]
pub(super) fn matching_neighbours(key: u8, other: u8) -> u8 {
    (!(key ^ other) & NEIGHBOURS).count_ones() as u8
}

/// All translations that map a weave onto itself; (0, 0) first.
fn symmetries(weave: &WeavePattern) -> Vec<(u16, u16)> {
    let (ends, picks) = (weave.ends(), weave.picks());
    let maps_onto_itself = |a: u32, b: u32| {
        (0..picks).all(|y| {
            (0..ends).all(|x| weave.get((x + a) % ends, (y + b) % picks) == weave.get(x, y))
        })
    };
    let mut found = Vec::new();
    for b in 0..picks {
        for a in 0..ends {
            if maps_onto_itself(a, b) {
                found.push((a as u16, b as u16));
            }
        }
    }
    found
}
