//! The design: everything the designer decided, and what was kept of the file it is from.

use std::sync::Arc;

use crate::limits::YARNS;

use super::colourways::{self, Colourway, ColourwayError};
use super::lattice::{Lattice, LatticeError};
use super::maps::{YarnMap, YarnMaps};
use super::pattern::WeavePattern;
use super::sett::{Density, Positions, Sett};
use super::structure::Structure;
use super::yarn::{Srgb, Yarn, YarnId};

/// A design that cannot be.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum DesignError {
    /// No yarn at all.
    #[error("the design has no yarns: give at least one")]
    NoYarns,
    /// More yarns than can be numbered.
    #[error("the design has {0} yarns; the most is {YARNS}: join those that look alike")]
    TooManyYarns(usize),
    /// A map that names a yarn that is not there.
    #[error("the {direction} names yarn {yarn}, but the design has {yarns}: add it")]
    MissingYarn {
        /// Warp or weft.
        direction: &'static str,
        /// The yarn's number, from 0.
        yarn: u16,
        /// Yarns there are.
        yarns: usize,
    },
    /// An order with no threads, or a map of another size than the design.
    #[error("the {direction} yarns {reason}")]
    Map {
        /// Warp or weft.
        direction: &'static str,
        /// What is wrong and what would be right.
        reason: String,
    },
    /// A number that cannot be.
    #[error("{0}")]
    Number(String),
    /// A lattice that does not close.
    #[error(transparent)]
    Lattice(#[from] LatticeError),
    /// A colourway that does not fit.
    #[error(transparent)]
    Colourway(#[from] ColourwayError),
}

/// A section of a foreign file that the design has no place for, kept word by word.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ForeignSection {
    /// Its name, without brackets.
    pub name: String,
    /// Its lines, comments and blank lines included, separated by `\n`.
    pub text: String,
}

/// Spacing and thickness that a file stated and the design set aside because they are its
/// program's default; written back as long as nobody chooses a sett.
#[derive(Debug, Clone, PartialEq)]
pub struct StatedThreads {
    /// The unit as the file names it.
    pub unit: String,
    /// The usual spacing in that unit.
    pub spacing: Option<f32>,
    /// The usual thickness in that unit.
    pub thickness: Option<f32>,
    /// Spacing of single threads (thread from 0, spacing in the unit).
    pub spacings: Vec<(u32, f32)>,
    /// Thickness of single threads (thread from 0, thickness in the unit).
    pub thicknesses: Vec<(u32, f32)>,
}

/// On which side a file or loom starts to count the ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum FirstEnd {
    /// End 1 is at the left, seen on the face.
    #[default]
    Left,
    /// End 1 is at the right.
    Right,
}

/// On which side a file or loom starts to count the picks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum FirstPick {
    /// Pick 1 is at the bottom, seen on the face.
    #[default]
    Bottom,
    /// Pick 1 is at the top.
    Top,
}

/// What is remembered of the file a design was imported from, for writing it back.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Origin {
    /// The program that wrote the file, as it called itself.
    pub program: Option<String>,
    /// Where the file starts to count ends.
    pub first_end: FirstEnd,
    /// Where the file starts to count picks.
    pub first_pick: FirstPick,
    /// Sections the design has no place for.
    pub sections: Vec<ForeignSection>,
    /// What the file stated about the ends and the design set aside.
    pub ends: Option<StatedThreads>,
    /// What the file stated about the picks and the design set aside.
    pub picks: Option<StatedThreads>,
    /// Colours of the file's palette, in its order, used or not.
    pub palette: Vec<Srgb>,
}

impl Origin {
    /// Bytes of memory of its texts and lists.
    fn bytes(&self) -> usize {
        let sections = self.sections.iter();
        let texts: usize = sections.map(|kept| kept.name.len() + kept.text.len()).sum();
        let threads = [&self.ends, &self.picks].into_iter().flatten();
        let lists: usize = threads
            .map(|stated| 8 * (stated.spacings.len() + stated.thicknesses.len()))
            .sum();
        size_of::<Self>() + texts + lists + 3 * self.palette.len()
    }
}

/// What a designer makes: a weave, yarns and where they lie, a sett and a repeat.
///
/// A `Design` is always whole: every yarn a map names is there, all numbers are finite and
/// in range, and the drawdown is of a size that can be made. Clones share what they can.
#[derive(Debug, Clone, PartialEq)]
pub struct Design {
    /// What the designer calls it.
    pub name: String,
    /// Notes, lines separated by `\n`.
    pub notes: String,
    /// What its own yarns are called among the colourways; empty if nobody named them.
    pub colourway: String,
    /// What is remembered of the file it came from.
    pub origin: Arc<Origin>,
    structure: Structure,
    yarns: Arc<Vec<Yarn>>,
    maps: Arc<YarnMaps>,
    sett: Arc<Sett>,
    lattice: Lattice,
    colourways: Arc<Vec<Colourway>>,
}

impl Design {
    /// A design from its parts, with the straight repeat.
    ///
    /// # Errors
    /// [`DesignError`] names the part that does not fit.
    pub fn new(
        name: impl Into<String>,
        structure: Structure,
        yarns: Vec<Yarn>,
        maps: YarnMaps,
        sett: Sett,
    ) -> Result<Self, DesignError> {
        let (ends, picks) = structure.size();
        check_yarns(&yarns)?;
        check_map("warp", &maps.warp, yarns.len(), ends, picks)?;
        check_map("weft", &maps.weft, yarns.len(), ends, picks)?;
        check_regions(&structure, yarns.len())?;
        if let Some(fault) = sett.fault() {
            return Err(DesignError::Number(fault));
        }
        Ok(Self {
            name: name.into(),
            notes: String::new(),
            colourway: String::new(),
            origin: Arc::default(),
            structure,
            yarns: Arc::new(yarns),
            maps: Arc::new(maps),
            sett: Arc::new(sett),
            lattice: Lattice::default(),
            colourways: Arc::default(),
        })
    }

    /// The same design with another repeat.
    ///
    /// # Errors
    /// [`LatticeError`] if the lattice does not close.
    pub fn with_lattice(mut self, lattice: Lattice) -> Result<Self, DesignError> {
        lattice.check()?;
        self.lattice = lattice;
        Ok(self)
    }

    /// The same design at another sett.
    ///
    /// # Errors
    /// [`DesignError::Number`] for a sett that cannot be woven.
    pub fn with_sett(mut self, sett: Sett) -> Result<Self, DesignError> {
        if let Some(fault) = sett.fault() {
            return Err(DesignError::Number(fault));
        }
        self.sett = Arc::new(sett);
        Ok(self)
    }

    /// The same design with another weave of the same or another size.
    ///
    /// # Errors
    /// [`DesignError::Map`] if yarns change by crossing and the size differs.
    pub fn with_structure(mut self, structure: Structure) -> Result<Self, DesignError> {
        let (ends, picks) = structure.size();
        let yarns = self.yarns.len();
        check_map("warp", &self.maps.warp, yarns, ends, picks)?;
        check_map("weft", &self.maps.weft, yarns, ends, picks)?;
        check_regions(&structure, yarns)?;
        self.structure = structure;
        Ok(self)
    }

    /// The same design with another weave, other yarns and other places for them, all at
    /// once: what an edit needs that changes the size or the number of yarns.
    ///
    /// # Errors
    /// [`DesignError`] names the part that does not fit.
    pub fn with_parts(
        mut self,
        structure: Structure,
        yarns: Vec<Yarn>,
        maps: YarnMaps,
        colourways: Vec<Colourway>,
    ) -> Result<Self, DesignError> {
        self.structure = structure;
        self.colourways = Arc::new(colourways);
        self.with_yarns(yarns, maps)
    }

    /// The weave, to be changed in place by an edit that keeps its size and names only
    /// yarns that are there: checking those again would go through every crossing.
    pub(crate) fn structure_mut(&mut self) -> &mut Structure {
        &mut self.structure
    }

    /// Which yarn lies where, to be changed in place on the same terms.
    pub(crate) fn maps_mut(&mut self) -> &mut YarnMaps {
        Arc::make_mut(&mut self.maps)
    }

    /// Bytes of memory that this design does not share with `other`, within a few hundred.
    pub fn bytes_beyond(&self, other: Option<&Self>) -> usize {
        fn unless<T>(mine: &Arc<T>, other: Option<&Arc<T>>, bytes: impl Fn(&T) -> usize) -> usize {
            match other {
                Some(other) if Arc::ptr_eq(mine, other) => 0,
                _ => bytes(mine),
            }
        }
        let yarns = |yarns: &[Yarn]| {
            size_of_val(yarns) + yarns.iter().map(|yarn| yarn.name.len()).sum::<usize>()
        };
        let map = |mine: &YarnMap, other: Option<&YarnMap>| match (mine, other) {
            (YarnMap::Order(order), _) => order.len() * size_of::<YarnId>(),
            (YarnMap::Crossings(grid), Some(YarnMap::Crossings(other))) => {
                grid.bytes_beyond(Some(other))
            }
            (YarnMap::Crossings(grid), _) => grid.bytes_beyond(None),
        };
        let maps = |maps: &YarnMaps| {
            map(&maps.warp, other.map(|other| &other.maps.warp))
                + map(&maps.weft, other.map(|other| &other.maps.weft))
        };
        let pitches =
            |density: &Density| density.pitches_mm.as_ref().map_or(0, |list| 4 * list.len());
        size_of::<Self>()
            + self.name.len()
            + self.notes.len()
            + self
                .structure
                .bytes_beyond(other.map(|other| &other.structure))
            + unless(
                &self.origin,
                other.map(|other| &other.origin),
                Origin::bytes,
            )
            + unless(&self.yarns, other.map(|other| &other.yarns), |list| {
                yarns(list)
            })
            + unless(&self.maps, other.map(|other| &other.maps), maps)
            + unless(&self.sett, other.map(|other| &other.sett), |sett| {
                pitches(&sett.ends) + pitches(&sett.picks)
            })
            + unless(
                &self.colourways,
                other.map(|other| &other.colourways),
                |list| list.iter().map(|colourway| yarns(&colourway.yarns)).sum(),
            )
    }

    /// The same design in other yarns and another arrangement of them.
    ///
    /// # Errors
    /// [`DesignError`] if a map names a yarn that is not there, or the colourways have
    /// another number of yarns.
    pub fn with_yarns(mut self, yarns: Vec<Yarn>, maps: YarnMaps) -> Result<Self, DesignError> {
        let (ends, picks) = self.structure.size();
        check_yarns(&yarns)?;
        check_map("warp", &maps.warp, yarns.len(), ends, picks)?;
        check_map("weft", &maps.weft, yarns.len(), ends, picks)?;
        colourways::check(&self.colourways, yarns.len())?;
        check_regions(&self.structure, yarns.len())?;
        (self.yarns, self.maps) = (Arc::new(yarns), Arc::new(maps));
        Ok(self)
    }

    /// The same design with these colourways instead of those it had.
    ///
    /// # Errors
    /// [`ColourwayError`] if one does not fit the design.
    pub fn with_colourways(mut self, colourways: Vec<Colourway>) -> Result<Self, DesignError> {
        colourways::check(&colourways, self.yarns.len())?;
        self.colourways = Arc::new(colourways);
        Ok(self)
    }

    /// The same design in the yarns of one of its colourways, by name in any case.
    ///
    /// # Errors
    /// [`ColourwayError::Unknown`] lists those there are.
    pub fn with_colourway(mut self, name: &str) -> Result<Self, ColourwayError> {
        let named = |known: &&Colourway| colourways::same_name(&known.name, name);
        let Some(chosen) = self.colourways.iter().find(named) else {
            if !self.colourway.is_empty() && colourways::same_name(&self.colourway, name) {
                return Ok(self);
            }
            return Err(colourways::unknown(name, &self.name, &self.colourways));
        };
        self.yarns = Arc::new(chosen.yarns.clone());
        self.colourway = chosen.name.clone();
        Ok(self)
    }

    /// Its colourways, beside its own yarns.
    pub fn colourways(&self) -> &[Colourway] {
        &self.colourways
    }

    /// Where the weave comes from.
    pub fn structure(&self) -> &Structure {
        &self.structure
    }

    /// Number of ends of the weave.
    pub fn ends(&self) -> u32 {
        self.structure.size().0
    }

    /// Number of picks of the weave.
    pub fn picks(&self) -> u32 {
        self.structure.size().1
    }

    /// The drawdown, computed from the structure.
    pub fn weave(&self) -> WeavePattern {
        self.structure.weave()
    }

    /// The yarns; at least one.
    pub fn yarns(&self) -> &[Yarn] {
        &self.yarns
    }

    /// One yarn; the maps name only yarns that exist.
    pub fn yarn(&self, id: YarnId) -> &Yarn {
        &self.yarns[usize::from(id.0).min(self.yarns.len() - 1)]
    }

    /// Which yarn lies where.
    pub fn maps(&self) -> &YarnMaps {
        &self.maps
    }

    /// The warp yarn at a crossing of the endless cloth. Orders run on with a period of
    /// their own; yarns given by crossing repeat with the design's lattice.
    pub fn warp_yarn(&self, end: i64, pick: i64) -> YarnId {
        self.maps.warp_on(self.lattice, end, pick)
    }

    /// The weft yarn at a crossing of the endless cloth, as [`Design::warp_yarn`].
    pub fn weft_yarn(&self, end: i64, pick: i64) -> YarnId {
        self.maps.weft_on(self.lattice, end, pick)
    }

    /// Threads per length.
    pub fn sett(&self) -> &Sett {
        &self.sett
    }

    /// How the design repeats.
    pub fn lattice(&self) -> Lattice {
        self.lattice
    }

    /// Whether a loom can weave it: no yarn changes along its length. Designs that cannot
    /// be woven are for previews only.
    pub fn weavable(&self) -> bool {
        self.maps.weavable()
    }

    /// Positions of the ends over their own repeat, in mm.
    pub fn end_positions(&self) -> Positions {
        positions(&self.sett.ends, self.ends())
    }

    /// Positions of the picks over their own repeat, in mm.
    pub fn pick_positions(&self) -> Positions {
        positions(&self.sett.picks, self.picks())
    }

    /// The cloth's own repeat in ends and picks: the least common multiples of the weave's,
    /// the orders' and the spacings' periods (straight repeat).
    pub fn cloth_repeat(&self) -> (u64, u64) {
        let (ends, picks) = self.colour_repeat();
        let pitches = |density: &Density| density.pitches_mm.as_ref().map_or(1, Vec::len) as u64;
        (
            lcm(ends, pitches(&self.sett.ends)),
            lcm(picks, pitches(&self.sett.picks)),
        )
    }

    /// The repeat of weave and colours together in ends and picks: the least common
    /// multiples of the weave's and the orders' periods (straight repeat).
    pub fn colour_repeat(&self) -> (u64, u64) {
        let along = |threads: u32, map: &YarnMap| {
            let order = map.order().map_or(1, <[YarnId]>::len) as u64;
            lcm(u64::from(threads), order)
        };
        (
            along(self.ends(), &self.maps.warp),
            along(self.picks(), &self.maps.weft),
        )
    }
}

/// Positions over the period of the pitches, or over the design where all are equal.
fn positions(density: &Density, threads: u32) -> Positions {
    let period = density
        .pitches_mm
        .as_ref()
        .map_or(threads, |list| list.len() as u32);
    density.positions(period)
}

/// Least common multiple, saturating.
pub(super) fn lcm(a: u64, b: u64) -> u64 {
    let (mut x, mut y) = (a.max(1), b.max(1));
    while y != 0 {
        (x, y) = (y, x % y);
    }
    (a.max(1) / x).saturating_mul(b.max(1))
}

fn check_yarns(yarns: &[Yarn]) -> Result<(), DesignError> {
    if yarns.is_empty() {
        return Err(DesignError::NoYarns);
    }
    if yarns.len() > YARNS {
        return Err(DesignError::TooManyYarns(yarns.len()));
    }
    match yarns.iter().find_map(Yarn::fault) {
        Some(fault) => Err(DesignError::Number(fault)),
        None => Ok(()),
    }
}

/// Refuses regions whose own yarns are not there.
fn check_regions(structure: &Structure, yarns: usize) -> Result<(), DesignError> {
    let Structure::Regions(regions) = structure else {
        return Ok(());
    };
    for own in regions.palette().iter().filter_map(|region| region.yarns) {
        for (direction, YarnId(yarn)) in [("region's warp", own.warp), ("region's weft", own.weft)]
        {
            if usize::from(yarn) >= yarns {
                return Err(DesignError::MissingYarn {
                    direction,
                    yarn,
                    yarns,
                });
            }
        }
    }
    Ok(())
}

fn check_map(
    direction: &'static str,
    map: &YarnMap,
    yarns: usize,
    ends: u32,
    picks: u32,
) -> Result<(), DesignError> {
    match map {
        YarnMap::Order(order) if order.is_empty() => {
            let reason = "are an empty order: name one yarn at least".to_owned();
            return Err(DesignError::Map { direction, reason });
        }
        YarnMap::Crossings(grid) if (grid.ends(), grid.picks()) != (ends, picks) => {
            let reason = format!(
                "are given for {} × {} crossings, but the design has {ends} × {picks}: \
                 draw them on the same grid",
                grid.ends(),
                grid.picks()
            );
            return Err(DesignError::Map { direction, reason });
        }
        _ => {}
    }
    match map.largest() {
        Some(YarnId(yarn)) if usize::from(yarn) >= yarns => Err(DesignError::MissingYarn {
            direction,
            yarn,
            yarns,
        }),
        _ => Ok(()),
    }
}

/// The sett usual for these yarns: the family's cover over the mean diameter of each
/// direction.
pub fn usual_sett(yarns: &[Yarn], maps: &YarnMaps) -> Sett {
    let density = |map: &YarnMap| {
        let of = |id: YarnId| yarns.get(usize::from(id.0));
        let (mut diameters, mut covers, mut count) = (0.0, 0.0, 0.0f32);
        let mut add = |id| {
            if let Some(yarn) = of(id) {
                diameters += yarn.diameter();
                covers += yarn.family.numbers().cover;
                count += 1.0;
            }
        };
        match map {
            YarnMap::Order(order) => order.iter().copied().for_each(&mut add),
            YarnMap::Crossings(_) => (0..yarns.len())
                .map(|id| YarnId(id as u16))
                .for_each(&mut add),
        }
        if count > 0.0 && diameters > 0.0 {
            Density::per_cm(10.0 * covers / diameters)
        } else {
            Density::per_cm(20.0)
        }
    };
    Sett {
        ends: density(&maps.warp),
        picks: density(&maps.weft),
        assumed: true,
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::super::{Family, Filled, Grid, Repeat};
    use super::*;

    fn cloth(maps: YarnMaps) -> Result<Design, DesignError> {
        let yarns = vec![
            Yarn::new("a", Family::Cotton, Srgb(20, 30, 90)),
            Yarn::new("b", Family::Cotton, Srgb(240, 240, 235)),
        ];
        let sett = usual_sett(&yarns, &maps);
        let weave = Structure::Weave(Filled::once("1/7 satin").unwrap());
        Design::new("cloth", weave, yarns, maps, sett)
    }

    #[test]
    fn a_stripe_of_28_on_an_eight_end_weave_repeats_after_56() {
        let stripe = (0..28).map(|end| YarnId(u16::from(end < 20))).collect();
        let design = cloth(YarnMaps::orders(stripe, vec![YarnId(0)])).unwrap();
        assert_eq!(design.cloth_repeat(), (56, 8));
        assert_eq!(design.maps().warp(28 + 19, 3), YarnId(1));
        assert_eq!(design.maps().warp(28 + 20, 3), YarnId(0));
    }

    #[test]
    fn yarns_by_crossing_follow_a_dropped_repeat_and_orders_do_not() {
        let grid = Grid::from_fn(8, 8, |_, pick| YarnId(u16::from(pick == 0))).unwrap();
        let maps = YarnMaps {
            warp: YarnMap::Crossings(grid),
            weft: YarnMap::Order(vec![YarnId(0), YarnId(1), YarnId(1)]),
        };
        let dropped = Lattice {
            across: Repeat::Dropped(3),
            along: Repeat::Straight,
        };
        let design = cloth(maps).unwrap().with_lattice(dropped).unwrap();
        assert_eq!(design.warp_yarn(0, 0), YarnId(1));
        assert_eq!(design.warp_yarn(8, 0), YarnId(0));
        assert_eq!(design.warp_yarn(8, 3), YarnId(1));
        assert_eq!(design.weft_yarn(8, 3), YarnId(0));
        assert!(!design.weavable());
    }

    #[test]
    fn usual_cloth_covers() {
        let design = cloth(YarnMaps::plain(YarnId(0), YarnId(1))).unwrap();
        let cover = design.yarns()[0].diameter() / design.sett().end_pitch_mm();
        assert!((0.7..=1.0).contains(&cover), "{cover}");
        assert!(design.sett().assumed);
    }

    #[test]
    fn parts_that_do_not_fit_are_named() {
        let missing = cloth(YarnMaps::plain(YarnId(0), YarnId(2))).unwrap_err();
        assert!(missing.to_string().contains("weft names yarn 2"));
        assert!(cloth(YarnMaps::orders(Vec::new(), vec![YarnId(0)])).is_err());
        let design = cloth(YarnMaps::plain(YarnId(0), YarnId(1))).unwrap();
        assert!(
            design
                .clone()
                .with_sett(Sett::per_cm(f32::NAN, 1.0))
                .is_err()
        );
        assert!(
            design
                .clone()
                .with_yarns(Vec::new(), design.maps().clone())
                .is_err()
        );
    }
}
