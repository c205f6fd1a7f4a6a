//! Which exemplar block every crossing copies, and how the seams between blocks are
//! closed. Zhao 2012 §5.3–5.5.
//!
//! A cloth of millions of crossings is never stored as voxels: every crossing *refers* to
//! a block, one crossing of one of a few small exemplars. Data passes through like this:
//!
//! 1. [`Catalogue`]: the exemplars' weaves. Numbers their blocks and lists, for each of
//!    the 32 neighbourhoods of a crossing, the blocks that fit it best (correct, then
//!    consistent, §5.3).
//! 2. [`assign`]: weave pattern + lattice → [`Assignment`], a block for every crossing of
//!    the design, with as much continuity as possible (§5.4). [`Assignment::edit`]
//!    follows a change of the pattern. Of very large designs only the columns in view are
//!    assigned ([`assign_part`], [`Stretch`]).
//! 3. [`Randomisation`]: at lookup, patches of crossings are moved along the exemplars'
//!    own symmetries, so that the cloth has no period (§5.4, *Randomization*).
//! 4. [`EdgeFix`]: from the heights of the yarns at the blocks' edges ([`EdgeHeights`])
//!    to the shift in z of every stack of voxels (§5.5).
//! 5. [`Quality`] and [`SeamRms`] say how well it went.
//!
//! Nothing here sees a voxel or a yarn: an assignment belongs to the weave alone, and
//! recolouring a design never makes a new one.

mod assign;
mod bounds;
mod catalogue;
mod chain;
mod corpus;
mod edges;
mod hash;
mod heights;
mod laplace;
mod lookup;
mod part;
mod quality;
mod shift;
mod weaves;

pub use assign::{Assignment, Method, assign, assign_part};
pub use catalogue::{Catalogue, KEYS, Place, Side, key_of};
pub use edges::{BOUND_COLUMN, Closing, EdgeFix, NeighbourBits, Rank, SeamCoefficients};
pub use heights::{Crown, EdgeHeights, Face};
pub use lookup::{BlockRef, Neighbourhood, Placement, SeamRms};
pub use part::{MOST_AT_ONCE, Stretch};
pub use quality::{Continuity, Quality};
pub use shift::Randomisation;

use serde::{Deserialize, Serialize};
use strum::{Display, EnumMessage, EnumString, IntoStaticStr, VariantArray};

use crate::job::Cancelled;

/// What is brought together where blocks meet, from crude to reference.
#[derive(
    Debug,
    Clone,
    Copy,
    PartialEq,
    Eq,
    Default,
    Serialize,
    Deserialize,
    Display,
    EnumString,
    EnumMessage,
    IntoStaticStr,
    VariantArray,
)]
#[strum(serialize_all = "kebab-case")]
pub enum Seams {
    /// The heights of all edges, by a membrane over the block: Zhao 2012 §5.5.
    #[default]
    Membrane,
    /// Height and slope of the yarns that are seen to run on.
    Crowns,
}

/// Every approximation of the synthesis, each with its crude and its reference end.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct SynthesisSettings {
    /// How blocks are chosen. Crude: [`Method::Naive`]; reference: [`Method::Dp`].
    pub method: Method,
    /// What is brought together at seams. Crude: [`Seams::Membrane`], which leaves kinks;
    /// reference: [`Seams::Crowns`].
    pub seams: Seams,
    /// How finely a membrane closes seams, or [`Rank::Off`] for leaving all of them open.
    /// Crude: [`Rank::Off`]; reference: [`Rank::Exact`].
    pub rank: Rank,
    /// Seed of every random choice; not an approximation, any value is as good.
    pub seed: u64,
    /// Edge of the square patches that are randomised together, in crossings. 0 leaves
    /// randomisation out (crude: the cloth repeats visibly); 1 gives the most variety and
    /// the least continuity; Zhao uses 3 for exemplars of 5 × 5.
    pub patch: u32,
}

impl Default for SynthesisSettings {
    fn default() -> Self {
        Self {
            method: Method::Dp,
            seams: Seams::default(),
            rank: Rank::Truncated(15),
            seed: 0,
            patch: 3,
        }
    }
}

impl SynthesisSettings {
    /// How seams are closed.
    pub fn closing(&self) -> Closing {
        match (self.seams, self.rank) {
            (_, Rank::Off | Rank::Truncated(0)) => Closing::Off,
            (Seams::Crowns, _) => Closing::Crowns,
            (Seams::Membrane, rank) => Closing::Membrane(rank),
        }
    }
}

/// What can go wrong in the synthesis.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum SynthesisError {
    /// The exemplars hold no crossing with this yarn on top.
    #[error("the exemplars' weaves hold no crossing with the {0} on top; add a weave that has one")]
    NoCandidate(&'static str),
    /// More blocks than a `u16` can number.
    #[error(
        "the exemplars hold {0} blocks, at most 65535 can be numbered; use fewer or smaller exemplars"
    )]
    TooManyBlocks(usize),
    /// One entry of `wraps` is needed for each weave.
    #[error(
        "{weaves} exemplar weaves but {wraps} entries that say whether they wrap; give one each"
    )]
    Wraps {
        /// Number of weaves.
        weaves: usize,
        /// Number of entries.
        wraps: usize,
    },
    /// Both directions of the repeat are dropped.
    #[error("the repeat is dropped across and along; at most one direction may be dropped")]
    DroppedTwice,
    /// The pattern has another size than the assignment that should follow it.
    #[error(
        "the pattern has {ends} × {picks} crossings, its assignment {was_ends} × {was_picks}; assign it anew"
    )]
    SizeChanged {
        /// Ends of the pattern.
        ends: u32,
        /// Picks of the pattern.
        picks: u32,
        /// Ends of the assignment.
        was_ends: u32,
        /// Picks of the assignment.
        was_picks: u32,
    },
    /// More crossings than are assigned at once.
    #[error(
        "{ends} × {picks} crossings are too many to make into cloth at once (the most is {most}): crop the design, or look at a part of it"
    )]
    TooMany {
        /// Ends of the pattern.
        ends: u32,
        /// Picks of the pattern.
        picks: u32,
        /// The most crossings.
        most: u64,
    },
    /// A view of more columns than are assigned at once.
    #[error(
        "the view takes in {ends} ends of {picks} picks each, of which at most {most} are made into cloth at once: look closer, or crop the design"
    )]
    TooWide {
        /// Ends in view.
        ends: u64,
        /// Picks of each.
        picks: u32,
        /// The most ends.
        most: u64,
    },
    /// Edge heights that do not fit the catalogue or each other.
    #[error("edge heights of exemplar set {set}: {what}; measure them again for this catalogue")]
    Heights {
        /// Index of the exemplar set.
        set: usize,
        /// What does not fit.
        what: String,
    },
    /// The owner cancelled the work.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}
