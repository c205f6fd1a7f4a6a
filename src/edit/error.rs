//! What cannot be done to a design, and what can be done instead.

use super::edits::Edit;
use crate::design::{
    ColourwayError, DeriveError, DesignError, DraftError, NotationError, SizeError, StructureError,
};

/// An edit that was refused; the document is as it was.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum EditError {
    /// The cloth of a shaft draft follows from its threading and lifting.
    #[error(
        "the drawdown of a shaft draft follows from its threading and tie-up: derive the draft \
         again from the painted cloth, or make the design a jacquard"
    )]
    ShaftDraft,
    /// A part that this kind of design does not have.
    #[error("this design has no {part}: {remedy}")]
    NoPart {
        /// What was to be edited.
        part: &'static str,
        /// What to do first.
        remedy: &'static str,
    },
    /// Something outside the design.
    #[error("{thing} {number} is not there; the design has {count}: choose one of those")]
    Missing {
        /// End, pick, shaft, yarn, region, …
        thing: &'static str,
        /// Its number as people count, from 1.
        number: u64,
        /// How many there are.
        count: u64,
    },
    /// Crossings of a design of another size.
    #[error(
        "the crossings are of a design of {ends} × {picks}, this one has another size: select again"
    )]
    OtherSize {
        /// Ends of theirs.
        ends: u32,
        /// Picks of theirs.
        picks: u32,
    },
    /// A number or a text that cannot be.
    #[error("{place}: {problem}")]
    Value {
        /// Which field.
        place: &'static str,
        /// What is wrong and what would be right.
        problem: String,
    },
    /// A design that would have no crossings or too many.
    #[error(transparent)]
    Size(#[from] SizeError),
    /// Parts that would not fit together.
    #[error(transparent)]
    Design(#[from] DesignError),
    /// Regions that would not fit together.
    #[error(transparent)]
    Structure(#[from] StructureError),
    /// A draft that cannot be.
    #[error(transparent)]
    Draft(#[from] DraftError),
    /// A drawdown that no such draft weaves.
    #[error(transparent)]
    Derive(#[from] DeriveError),
    /// A weave that cannot be read.
    #[error(transparent)]
    Notation(#[from] NotationError),
    /// A colourway that does not fit.
    #[error(transparent)]
    Colourway(#[from] ColourwayError),
}

impl EditError {
    /// Edits that do what was refused another way, for one click each: to `refused`, which
    /// was refused with this error.
    pub fn remedies(&self, refused: &Edit) -> Vec<Edit> {
        match self {
            Self::ShaftDraft => vec![
                Edit::DeriveDraft {
                    after: Some(Box::new(refused.clone())),
                },
                Edit::BecomeJacquard {
                    then: Some(Box::new(refused.clone())),
                },
            ],
            Self::NoPart {
                part: "regions", ..
            } => {
                vec![Edit::BecomeJacquard {
                    then: Some(Box::new(refused.clone())),
                }]
            }
            _ => Vec::new(),
        }
    }
}
