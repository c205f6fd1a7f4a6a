//! What the designer makes: weave, yarns, where each yarn lies, sett and repeat.
//!
//! Zhao 2012 §5.1: a binary weave pattern, a warp and a weft yarn at every crossing,
//! and colour and gloss of each yarn. A [`Design`] holds these and resolves, for any
//! crossing of the endless cloth, which yarn is where and which lies on top.
//!
//! | file | holds |
//! |---|---|
//! | `pattern` | the weave, one bit a crossing |
//! | `weaves` | weaves by notation ("2/2 twill", "1/7 satin move 3"), and made of weaves |
//! | `library` | weaves by name ("honeycomb 8"), with what they are for |
//! | `draft` | threading, tie-up and treadling, and the weave they make |
//! | `derive` | from a weave back to a draft |
//! | `structure` | pattern, draft, notation or regions: where a design's weave is from |
//! | `source` | the picture that regions were made of |
//! | `yarn`, `maps`, `sett`, `lattice` | yarns, where they lie, how densely, how they repeat |
//! | `lying` | how thick yarns lie in the cloth |
//! | `count` | yarn counts as spinners and weavers write them |
//! | `stripes` | the order of a direction's yarns as it is typed ("12 navy 4 cream") |
//! | `tiles` | what patterns and grids are kept in: tiles that clones share |
//! | `document` | the design that holds all of these together |
//! | `colourways` | named sets of yarns for one design |
//! | `floats` | what a designer checks first |
//! | `reach` | the floats where one looks |
//! | `checks` | what a mill checks: ties, take-up, heddles, yarn needed |
//! | `same_cloth` | whether two designs weave the same cloth |
//! | `swatch` | the drawdown as pixels, near and far |
//! | `colour` | how different two colours look |

pub mod checks;
mod colour;
mod colourways;
mod count;
mod derive;
mod direction;
mod document;
mod draft;
mod floats;
mod grid;
mod lattice;
pub mod library;
mod lying;
mod maps;
mod pattern;
mod reach;
mod same_cloth;
mod sett;
mod source;
pub mod stripes;
mod structure;
mod swatch;
mod tiles;
mod weaves;
mod yarn;

pub use colour::{Lab, delta_e_00, lab};
pub use colourways::{Colourway, ColourwayError, MAX_COLOURWAYS};
pub use count::CountUnit;
pub use derive::{DeriveError, Loom, derive, shafts_needed};
pub use direction::Direction;
pub use document::{
    Design, DesignError, FirstEnd, FirstPick, ForeignSection, Origin, StatedThreads, usual_sett,
};
pub use draft::{Draft, DraftError, Lifting, MAX_SHAFTS, Shed, Ties};
pub use floats::{FloatKind, FloatLengths, FloatReport, SeamFloat, floats, longest_float};
pub use grid::Grid;
pub use lattice::{Lattice, LatticeError, Repeat};
pub use library::{ColourOrders, LibraryWeave, library};
pub use lying::TooThick;
pub use maps::{YarnMap, YarnMaps};
pub(crate) use pattern::check_size;
pub use pattern::{ArtError, MAX_CROSSINGS, SizeError, WeavePattern};
pub use reach::{ClothBox, FaceFloat, float_through, long_floats_in, longest_floats};
pub use sett::{Density, MAX_PITCH_MM, MIN_PITCH_MM, Positions, Sett};
pub use source::{MAX_SOURCE_PIXELS, SourceError, SourceImage};
pub use structure::{
    Corrections, Fill, Filled, Region, RegionYarns, Regions, Structure, StructureError,
};
pub use swatch::{Colouring, SwatchWindow, region_colour, swatch};
pub use weaves::{
    BindError, CombineError, MAX_REPEAT, NotationError, bind_floats, both, counterchange,
    double_cloth, drop_repeat, either, rearranged, repeated, satin, satin_moves, shadow_series,
    shifted, weave,
};
pub use yarn::{
    ColourError, Family, FamilyError, FamilyNumbers, Srgb, USUAL_SURFACE_SHARE, Yarn, YarnId,
};
