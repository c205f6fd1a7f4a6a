//! Colourways: other sets of yarns for the same weave.

use super::document::Work;
use super::error::EditError;
use super::threads;
use crate::design::{Colourway, ColourwayError, Yarn, YarnId};

fn missing(work: &Work, colourway: usize) -> EditError {
    EditError::Missing {
        thing: "colourway",
        number: colourway as u64 + 1,
        count: work.design.colourways().len() as u64,
    }
}

/// The colourways, to be changed, and the one that is meant among them.
fn listed(work: &Work, colourway: usize) -> Result<Vec<Colourway>, EditError> {
    match work.design.colourways().get(colourway) {
        Some(_) => Ok(work.design.colourways().to_vec()),
        None => Err(missing(work, colourway)),
    }
}

fn put(work: &mut Work, colourways: Vec<Colourway>) -> Result<(), EditError> {
    work.design = work.design.clone().with_colourways(colourways)?;
    Ok(())
}

/// A colourway more, as another or as the design's own yarns.
pub(super) fn add(work: &mut Work, name: String, of: Option<usize>) -> Result<(), EditError> {
    let yarns = match of {
        None => work.design.yarns().to_vec(),
        Some(of) => match work.design.colourways().get(of) {
            Some(colourway) => colourway.yarns.clone(),
            None => return Err(missing(work, of)),
        },
    };
    check_name(work, &name)?;
    let mut colourways = work.design.colourways().to_vec();
    colourways.push(Colourway { name, yarns });
    put(work, colourways)
}

/// Another name.
pub(super) fn rename(work: &mut Work, colourway: usize, name: String) -> Result<(), EditError> {
    let mut colourways = listed(work, colourway)?;
    if colourways[colourway].name != name {
        check_name(work, &name)?;
    }
    colourways[colourway].name = name;
    put(work, colourways)
}

/// Away with it.
pub(super) fn remove(work: &mut Work, colourway: usize) -> Result<(), EditError> {
    let mut colourways = listed(work, colourway)?;
    colourways.remove(colourway);
    put(work, colourways)
}

/// Other properties of one of its yarns.
pub(super) fn set_yarn(
    work: &mut Work,
    colourway: usize,
    yarn: YarnId,
    to: Yarn,
) -> Result<(), EditError> {
    threads::check(&work.design, yarn)?;
    let mut colourways = listed(work, colourway)?;
    colourways[colourway].yarns[usize::from(yarn.0)] = to;
    put(work, colourways)
}

/// What the design's own yarns are called.
pub(super) fn name_own(work: &mut Work, name: String) -> Result<(), EditError> {
    check_name(work, &name)?;
    work.design.colourway = name;
    Ok(())
}

/// Refuses the name of the design's own yarns for another colourway and the other way round.
fn check_name(work: &Work, name: &str) -> Result<(), EditError> {
    let same = |other: &str| other.trim().to_lowercase() == name.trim().to_lowercase();
    let own = !work.design.colourway.is_empty() && same(&work.design.colourway);
    if own
        || work
            .design
            .colourways()
            .iter()
            .any(|other| same(&other.name))
    {
        return Err(EditError::Colourway(ColourwayError::Name {
            name: name.to_owned(),
            problem: "is taken",
        }));
    }
    Ok(())
}

/// Its yarns become the design's own; those the design had take its place in the list.
pub(super) fn make_current(work: &mut Work, colourway: usize) -> Result<(), EditError> {
    let mut colourways = listed(work, colourway)?;
    work.design.colourway = work.design.own_colourway();
    let chosen = colourways[colourway].clone();
    let kept = Colourway {
        name: std::mem::replace(&mut work.design.colourway, chosen.name),
        yarns: work.design.yarns().to_vec(),
    };
    colourways[colourway] = kept;
    let structure = work.design.structure().clone();
    let maps = work.design.maps().clone();
    let design = work.design.clone();
    work.design = design.with_parts(structure, chosen.yarns, maps, colourways)?;
    Ok(())
}
