//! Colourways: one structure in several named sets of yarns.
//!
//! A colourway replaces every yarn of the design, by number; weave, orders, sett and repeat
//! stay. Where the yarns keep family and size the cloth is only recoloured, never made anew.

use super::yarn::Yarn;

/// The most colourways a design can have.
pub const MAX_COLOURWAYS: usize = 256;

/// The name that stands for every colourway at once where one is asked for.
const ALL: &str = "all";

/// A named set of yarns for a design.
#[derive(Debug, Clone, PartialEq)]
pub struct Colourway {
    /// What the designer calls it; not empty and not "all".
    pub name: String,
    /// A yarn for each of the design's own, by number.
    pub yarns: Vec<Yarn>,
}

/// A colourway that cannot be, or is not there.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ColourwayError {
    /// No colourway of this name.
    #[error("colourway \"{name}\": {design} has {known}; choose one or leave it out")]
    Unknown {
        /// What was asked for.
        name: String,
        /// The design's name.
        design: String,
        /// Those there are, for a person.
        known: String,
    },
    /// A name that is empty, taken or reserved.
    #[error("colourway \"{name}\": this name {problem}; give another")]
    Name {
        /// The name.
        name: String,
        /// What is wrong with it.
        problem: &'static str,
    },
    /// Another number of yarns than the design.
    #[error(
        "colourway \"{name}\" has {found} yarns where the design has {expected}: give one each"
    )]
    Count {
        /// The colourway.
        name: String,
        /// Its yarns.
        found: usize,
        /// The design's yarns.
        expected: usize,
    },
    /// A yarn with a number that cannot be.
    #[error("colourway \"{name}\": {problem}")]
    Yarn {
        /// The colourway.
        name: String,
        /// Which yarn and what is wrong.
        problem: String,
    },
    /// More than can be shown.
    #[error("{0} colourways are too many: give at most {MAX_COLOURWAYS}")]
    TooMany(usize),
}

/// Whether two colourway names are the same to a person.
pub(super) fn same_name(a: &str, b: &str) -> bool {
    a.trim().to_lowercase() == b.trim().to_lowercase()
}

/// Refuses colourways that do not fit a design of `yarns` yarns.
pub(super) fn check(colourways: &[Colourway], yarns: usize) -> Result<(), ColourwayError> {
    if colourways.len() > MAX_COLOURWAYS {
        return Err(ColourwayError::TooMany(colourways.len()));
    }
    for (place, colourway) in colourways.iter().enumerate() {
        let name = colourway.name.clone();
        let taken = |other: &Colourway| same_name(&other.name, &name);
        let problem = if name.trim().is_empty() {
            Some("is empty")
        } else if same_name(&name, ALL) {
            Some("stands for all colourways")
        } else if colourways[..place].iter().any(taken) {
            Some("is taken")
        } else {
            None
        };
        if let Some(problem) = problem {
            return Err(ColourwayError::Name { name, problem });
        }
        if colourway.yarns.len() != yarns {
            return Err(ColourwayError::Count {
                name,
                found: colourway.yarns.len(),
                expected: yarns,
            });
        }
        if let Some(problem) = colourway.yarns.iter().find_map(Yarn::fault) {
            return Err(ColourwayError::Yarn { name, problem });
        }
    }
    Ok(())
}

/// The error for a name that is not there, listing those that are.
pub(super) fn unknown(name: &str, design: &str, colourways: &[Colourway]) -> ColourwayError {
    let names: Vec<&str> = colourways.iter().map(|known| known.name.as_str()).collect();
    ColourwayError::Unknown {
        name: name.chars().take(60).collect(),
        design: design.to_owned(),
        known: match names.as_slice() {
            [] => "its own yarns only".to_owned(),
            names => names.join(", "),
        },
    }
}
