//! Everything that can be done to a design, and what each is called.

use super::cells::{Cells, Rect};
use super::document::Work;
use super::error::EditError;
use super::{colourways, crossings, drafts, regions, threads, whole};
use crate::design::{
    Design, Direction, Fill, Grid, Lattice, Region, RegionYarns, Sett, Shed, WeavePattern, Yarn,
    YarnId,
};

/// New sets for some places: (place, members), ends with their shafts for instance. All
/// count from 0.
pub type Rows = Vec<(u32, Vec<u16>)>;

/// A change to a design. Painting changes the drawdown of a pattern and the hand corrections
/// of a jacquard; a design given as one weave becomes a pattern when it is painted.
#[derive(Debug, Clone)]
pub enum Edit {
    /// Puts the warp (`true`) or the weft on top at some crossings.
    Paint {
        /// Where.
        cells: Cells,
        /// What.
        warp_up: bool,
    },
    /// Copies crossings from a pattern of the design's size: paste, stamp, roll a selection.
    Place {
        /// Where.
        cells: Cells,
        /// What lies there; ignored elsewhere.
        values: WeavePattern,
    },
    /// Exchanges warp and weft on the face at some crossings.
    Flip(Cells),
    /// Takes the hand corrections away at some crossings of a jacquard.
    ClearCorrections(Cells),
    /// Gives some crossings of a jacquard to a region.
    PaintRegion {
        /// Where.
        cells: Cells,
        /// The region's number.
        region: u16,
    },
    /// Copies regions from a map of the design's size.
    PlaceRegions {
        /// Where.
        cells: Cells,
        /// The region numbers; ignored elsewhere.
        regions: Box<Grid<u16>>,
    },

    /// A region more, at the end of the list.
    AddRegion(Box<Region>),
    /// Gives a region another weave; outlines and hand corrections stay.
    SetFill {
        /// The region's number.
        region: u16,
        /// Its new weave.
        fill: Fill,
    },
    /// Moves a region's weave: the crossing where its (0, 0) lies.
    SetFillOrigin {
        /// The region's number.
        region: u16,
        /// (end, pick).
        origin: (i32, i32),
    },
    /// Gives a region another name and colour.
    NameRegion {
        /// The region's number.
        region: u16,
        /// Its new name.
        name: String,
        /// Its new colour in the artwork, if any.
        colour: Option<crate::design::Srgb>,
    },
    /// Fixes a region's weave, or frees it.
    LockRegion {
        /// The region's number.
        region: u16,
        /// Whether proposals leave it alone.
        locked: bool,
    },
    /// Gives a region yarns of its own ("preview only"), or the design's again.
    SetRegionYarns {
        /// The region's number.
        region: u16,
        /// Its yarns; `None` = the design's.
        yarns: Option<RegionYarns>,
    },
    /// Puts the regions in another order; the cloth stays. Place i of the list gets the
    /// region that had number `order[i]`.
    OrderRegions(Vec<u16>),
    /// Puts the regions in the order of their areas, the largest first.
    SortRegions,
    /// Gives a region's crossings to another and takes it off the list.
    MergeRegion {
        /// The region that goes.
        region: u16,
        /// The one that gets its crossings.
        into: u16,
    },

    /// The shafts of some ends of a draft.
    Threading(Rows),
    /// The shafts tied to some treadles; treadles beyond the last are added.
    TieUp(Rows),
    /// The treadles of some picks.
    Treadling(Rows),
    /// The shafts of some picks.
    LiftPlan(Rows),
    /// How many shafts a draft has.
    SetShafts(u32),
    /// How many treadles a draft has.
    SetTreadles(u32),
    /// Whether named shafts rise or sink; the cloth turns to its other face.
    SetShed(Shed),
    /// Says the lifting pick by pick instead of by treadles; the cloth stays.
    UseLiftPlan,
    /// Says the lifting by the fewest treadles, one a pick; the cloth stays.
    UseTreadles,
    /// Makes the design a draft of the fewest shafts that weaves its drawdown, after `after`
    /// was done to that drawdown.
    DeriveDraft {
        /// A painting of crossings, first.
        after: Option<Box<Edit>>,
    },
    /// Makes the design a jacquard whose one region weaves its drawdown, then does `then`.
    BecomeJacquard {
        /// An edit of the jacquard.
        then: Option<Box<Edit>>,
    },
    /// Makes the design a bare drawdown.
    BecomePattern,

    /// A yarn more, in every colourway.
    AddYarn(Box<Yarn>),
    /// Gives a yarn other properties.
    SetYarn {
        /// Which.
        yarn: YarnId,
        /// What it is from now on.
        to: Box<Yarn>,
    },
    /// Exchanges the threads of two yarns, in every colourway.
    SwapYarns(YarnId, YarnId),
    /// Gives a yarn's threads to another and takes it off the list.
    RemoveYarn {
        /// The yarn that goes.
        yarn: YarnId,
        /// The one that gets its threads.
        instead: YarnId,
    },
    /// Puts the yarns in another order; the cloth stays. Place i of the list gets the yarn
    /// that had number `order[i]`.
    OrderYarns(Vec<u16>),
    /// Gives some threads another yarn. The order is written out until it closes with the
    /// design: threads count up to the cloth's repeat.
    PaintThreads {
        /// Ends or picks.
        direction: Direction,
        /// Their numbers.
        threads: Vec<u32>,
        /// Their yarn.
        yarn: YarnId,
    },
    /// The order of the yarns of one direction, repeating.
    SetOrder {
        /// Of the ends or of the picks.
        direction: Direction,
        /// A yarn for each thread.
        order: Vec<YarnId>,
    },

    /// A colourway more, of a colourway's yarns or of the design's own.
    AddColourway {
        /// Its name.
        name: String,
        /// The one it begins as; `None` = the design's own yarns.
        of: Option<usize>,
    },
    /// Gives a colourway another name.
    RenameColourway {
        /// Which, from 0.
        colourway: usize,
        /// Its new name.
        name: String,
    },
    /// Takes a colourway away.
    RemoveColourway(usize),
    /// Gives a yarn of a colourway other properties.
    SetColourwayYarn {
        /// Which, from 0.
        colourway: usize,
        /// Which of its yarns.
        yarn: YarnId,
        /// What it is from now on.
        to: Box<Yarn>,
    },
    /// Makes a colourway's yarns the design's own; those the design had take its place in
    /// the list, so that nothing is lost ("original" if nobody named them).
    UseColourway(usize),
    /// What the design's own yarns are called ([`Design::colourway`]).
    NameColourway(String),

    /// Threads per length; the threads stay, the cloth becomes larger or smaller.
    SetSett(Box<Sett>),
    /// Threads per length; the cloth keeps its size and the artwork is resampled to the
    /// threads that then fit (nearest crossing).
    SetSettKeepSize(Box<Sett>),
    /// How the design repeats.
    SetLattice(Lattice),
    /// More or fewer ends and picks from (0, 0); the design repeats into what is new.
    Resize {
        /// Ends from now on.
        ends: u32,
        /// Picks from now on.
        picks: u32,
    },
    /// Cuts the design down to a box.
    Crop(Rect),
    /// Writes the repeat out several times; the cloth stays, where region weaves close.
    Tile {
        /// Copies across.
        across: u32,
        /// Copies along.
        along: u32,
    },
    /// Moves the design within its repeat: what leaves at one side comes in at the other.
    Roll {
        /// Ends to the right.
        ends: i32,
        /// Picks up.
        picks: i32,
    },
    /// Mirrors the design with its yarns: left and right (`Warp`, ends change places) or top
    /// and bottom (`Weft`). The hand of the cloth changes: Z becomes S.
    Mirror(Direction),
    /// Turns the drawing by quarters, anticlockwise: a marked crossing stays warp up.
    Rotate(u8),
    /// Exchanges warp and weft on the face everywhere.
    Invert,

    /// What the design is called.
    Rename(String),
    /// The notes.
    SetNotes(String),
    /// Another design in its place.
    Replace(Box<Design>),
}

impl Edit {
    /// What the history calls it.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Paint { .. } => "paint",
            Self::Place { .. } => "place",
            Self::Flip(_) => "invert crossings",
            Self::ClearCorrections(_) => "clear corrections",
            Self::PaintRegion { .. } => "paint region",
            Self::PlaceRegions { .. } => "place regions",
            Self::AddRegion(_) => "add region",
            Self::SetFill { .. } => "weave of a region",
            Self::SetFillOrigin { .. } => "origin of a region",
            Self::NameRegion { .. } => "rename region",
            Self::LockRegion { locked: true, .. } => "lock region",
            Self::LockRegion { locked: false, .. } => "unlock region",
            Self::SetRegionYarns { .. } => "yarns of a region",
            Self::OrderRegions(_) => "order of regions",
            Self::SortRegions => "sort regions by area",
            Self::MergeRegion { .. } => "merge regions",
            Self::Threading(_) => "threading",
            Self::TieUp(_) => "tie-up",
            Self::Treadling(_) => "treadling",
            Self::LiftPlan(_) => "lift plan",
            Self::SetShafts(_) => "number of shafts",
            Self::SetTreadles(_) => "number of treadles",
            Self::SetShed(_) => "rising or sinking shed",
            Self::UseLiftPlan => "use a lift plan",
            Self::UseTreadles => "use treadles",
            Self::DeriveDraft { .. } => "derive the draft",
            Self::BecomeJacquard { .. } => "become a jacquard",
            Self::BecomePattern => "become a drawdown",
            Self::AddYarn(_) => "add yarn",
            Self::SetYarn { .. } => "yarn",
            Self::SwapYarns(..) => "swap yarns",
            Self::RemoveYarn { .. } => "remove yarn",
            Self::OrderYarns(_) => "order of yarns",
            Self::PaintThreads {
                direction: Direction::Warp,
                ..
            } => "paint ends",
            Self::PaintThreads {
                direction: Direction::Weft,
                ..
            } => "paint picks",
            Self::SetOrder {
                direction: Direction::Warp,
                ..
            } => "warp order",
            Self::SetOrder {
                direction: Direction::Weft,
                ..
            } => "weft order",
            Self::AddColourway { .. } => "add colourway",
            Self::RenameColourway { .. } => "rename colourway",
            Self::RemoveColourway(_) => "remove colourway",
            Self::SetColourwayYarn { .. } => "yarn of a colourway",
            Self::UseColourway(_) => "switch colourway",
            Self::NameColourway(_) => "rename colourway",
            Self::SetSett(_) | Self::SetSettKeepSize(_) => "sett",
            Self::SetLattice(_) => "repeat",
            Self::Resize { .. } => "resize",
            Self::Crop(_) => "crop",
            Self::Tile { .. } => "tile",
            Self::Roll { .. } => "roll",
            Self::Mirror(_) => "mirror",
            Self::Rotate(_) => "rotate",
            Self::Invert => "invert",
            Self::Rename(_) => "rename",
            Self::SetNotes(_) => "notes",
            Self::Replace(_) => "replace the design",
        }
    }
}

impl Work {
    /// Does an edit; after an error the work is of no use.
    pub(super) fn apply(&mut self, edit: Edit) -> Result<(), EditError> {
        match edit {
            Edit::Paint { cells, warp_up } => crossings::paint(self, &cells, warp_up),
            Edit::Place { cells, values } => crossings::place(self, &cells, &values),
            Edit::Flip(cells) => crossings::flip(self, &cells),
            Edit::ClearCorrections(cells) => crossings::clear(self, &cells),
            Edit::PaintRegion { cells, region } => crossings::paint_region(self, &cells, region),
            Edit::PlaceRegions { cells, regions } => {
                crossings::place_regions(self, &cells, &regions)
            }
            Edit::AddRegion(region) => regions::add(self, *region),
            Edit::SetFill { region, fill } => regions::set_fill(self, region, fill),
            Edit::SetFillOrigin { region, origin } => regions::set_origin(self, region, origin),
            Edit::NameRegion {
                region,
                name,
                colour,
            } => regions::rename(self, region, name, colour),
            Edit::LockRegion { region, locked } => regions::lock(self, region, locked),
            Edit::SetRegionYarns { region, yarns } => regions::set_yarns(self, region, yarns),
            Edit::OrderRegions(order) => regions::reorder(self, &order),
            Edit::SortRegions => regions::sort_by_area(self),
            Edit::MergeRegion { region, into } => regions::merge(self, region, into),
            Edit::Threading(rows) => drafts::threading(self, &rows),
            Edit::TieUp(rows) => drafts::tie_up(self, &rows),
            Edit::Treadling(rows) => drafts::treadling(self, &rows),
            Edit::LiftPlan(rows) => drafts::lift_plan(self, &rows),
            Edit::SetShafts(shafts) => drafts::set_shafts(self, shafts),
            Edit::SetTreadles(treadles) => drafts::set_treadles(self, treadles),
            Edit::SetShed(shed) => drafts::set_shed(self, shed),
            Edit::UseLiftPlan => drafts::use_lift_plan(self),
            Edit::UseTreadles => drafts::use_treadles(self),
            Edit::DeriveDraft { after } => drafts::derive_draft(self, after.map(|edit| *edit)),
            Edit::BecomeJacquard { then } => regions::become_jacquard(self, then.map(|edit| *edit)),
            Edit::BecomePattern => crossings::become_pattern(self),
            Edit::AddYarn(yarn) => threads::add(self, *yarn),
            Edit::SetYarn { yarn, to } => threads::set(self, yarn, *to),
            Edit::SwapYarns(one, other) => threads::swap(self, one, other),
            Edit::RemoveYarn { yarn, instead } => threads::remove(self, yarn, instead),
            Edit::OrderYarns(order) => threads::reorder(self, &order),
            Edit::PaintThreads {
                direction,
                threads,
                yarn,
            } => threads::paint(self, direction, &threads, yarn),
            Edit::SetOrder { direction, order } => threads::set_order(self, direction, order),
            Edit::AddColourway { name, of } => colourways::add(self, name, of),
            Edit::RenameColourway { colourway, name } => colourways::rename(self, colourway, name),
            Edit::RemoveColourway(colourway) => colourways::remove(self, colourway),
            Edit::SetColourwayYarn {
                colourway,
                yarn,
                to,
            } => colourways::set_yarn(self, colourway, yarn, *to),
            Edit::UseColourway(colourway) => colourways::make_current(self, colourway),
            Edit::NameColourway(name) => colourways::name_own(self, name),
            Edit::SetSett(sett) => whole::set_sett(self, *sett),
            Edit::SetSettKeepSize(sett) => whole::set_sett_keep_size(self, *sett),
            Edit::SetLattice(lattice) => whole::set_lattice(self, lattice),
            Edit::Resize { ends, picks } => whole::resize(self, ends, picks),
            Edit::Crop(rect) => whole::crop(self, rect),
            Edit::Tile { across, along } => whole::tile(self, across, along),
            Edit::Roll { ends, picks } => whole::roll(self, ends, picks),
            Edit::Mirror(direction) => whole::mirror(self, direction),
            Edit::Rotate(quarters) => whole::rotate(self, quarters),
            Edit::Invert => whole::invert(self),
            Edit::Rename(name) => {
                self.design.name = name;
                Ok(())
            }
            Edit::SetNotes(notes) => {
                self.design.notes = notes;
                Ok(())
            }
            Edit::Replace(design) => {
                self.replace(*design);
                Ok(())
            }
        }
    }
}
