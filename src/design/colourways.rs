//! Colourways: one structure in several named sets of yarns.
//!
//! A colourway replaces every yarn of the design, by number; weave, orders, sett and repeat
//! stay. Where the yarns keep family and size the cloth is only recoloured, never made anew.

use super::document::Design;
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

impl Design {
    /// What the design's own yarns are called among the colourways: their name, or
    /// "original" where nobody named them.
    pub fn own_colourway(&self) -> String {
        if !self.colourway.trim().is_empty() {
            return self.colourway.clone();
        }
        let names = std::iter::once("original".to_owned())
            .chain((2..).map(|number| format!("original {number}")));
        let taken = |name: &String| (self.colourways().iter()).any(|c| same_name(&c.name, name));
        names
            .into_iter()
            .find(|name| !taken(name))
            .unwrap_or_default()
    }

    /// The colourways by name, the design's own yarns among them: name and place in
    /// [`Design::colourways`], `None` for its own. Numbers in names count as numbers. The
    /// order stays when another colourway comes into use.
    pub fn colourway_order(&self) -> Vec<(String, Option<usize>)> {
        let listed = self.colourways().iter().enumerate();
        let mut order: Vec<_> = std::iter::once((self.own_colourway(), None))
            .chain(listed.map(|(place, colourway)| (colourway.name.clone(), Some(place))))
            .collect();
        order.sort_by_cached_key(|(name, _)| by_number(name));
        order
    }
}

/// A name cut into words and numbers, so that 10 comes after 9.
fn by_number(name: &str) -> Vec<(u64, String)> {
    let mut parts: Vec<(u64, String)> = vec![(0, String::new())];
    let mut counting = false;
    for letter in name.trim().to_lowercase().chars() {
        let digit = letter.to_digit(10);
        if digit.is_some() && !counting {
            parts.push((0, String::new()));
        }
        if let Some((number, word)) = parts.last_mut() {
            match digit {
                Some(digit) => *number = number.saturating_mul(10).saturating_add(digit.into()),
                None => word.push(letter),
            }
        }
        counting = digit.is_some();
    }
    parts
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;
    use crate::design::{Family, Srgb, Structure, WeavePattern, YarnId, YarnMaps, usual_sett};

    #[test]
    fn the_order_is_by_name_and_counts() {
        let yarn = Yarn::new("y", Family::Cotton, Srgb(1, 2, 3));
        let yarns = vec![yarn.clone(), yarn.clone()];
        let maps = YarnMaps::plain(YarnId(0), YarnId(1));
        let sett = usual_sett(&yarns, &maps);
        let structure = Structure::Pattern(WeavePattern::new(4, 4));
        let mut design = Design::new("d", structure, yarns.clone(), maps, sett).unwrap();
        let names = |design: &Design| -> Vec<String> {
            let order = design.colourway_order();
            order.into_iter().map(|(name, _)| name).collect()
        };
        assert_eq!(names(&design), ["original"]);
        let list = ["set 10", "set 9", "Original", "ash"].map(|name| Colourway {
            name: name.to_owned(),
            yarns: yarns.clone(),
        });
        design = design.with_colourways(list.to_vec()).unwrap();
        let expected = ["ash", "Original", "original 2", "set 9", "set 10"];
        assert_eq!(names(&design), expected);
        assert_eq!(design.colourway_order()[2].1, None);
        assert_eq!(design.colourway_order()[3].1, Some(1));
        design.colourway = "zinc".to_owned();
        assert_eq!(names(&design)[4], "zinc");
    }
}
