//! What draft and loom files have in common: threads, colours and spacings become a design.
//!
//! Each reader fills in a [`Sheet`]; the rules by which yarns, sett and name are made of it
//! are here and in `threads`, once for all formats.

pub(super) mod text;
pub(super) mod threads;
mod warnings;

use std::sync::Arc;

use std::fmt;

use super::reading::{Imported, LoadOptions, stem};
use crate::design::{
    Design, Direction, Draft, Family, FirstEnd, FirstPick, ForeignSection, Lifting, Origin, Srgb,
    Structure, YarnMaps, usual_sett,
};
use threads::{Spacing, Threads};
pub(super) use warnings::Warnings;

/// Where in a file something is wrong.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// A line of a text, from 1.
    Line(u32),
    /// A byte, from 0.
    Byte(usize),
}

impl fmt::Display for Place {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Line(line) => write!(out, "line {line}"),
            Self::Byte(byte) => write!(out, "byte {byte}"),
        }
    }
}

/// A draft or loom file that cannot be read or written: one line with the file, the place,
/// what was expected and what to do.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{}", self.message())]
pub struct SheetError {
    /// The file, as the reader was told.
    pub file: String,
    /// Where, if one place is to blame.
    pub place: Option<Place>,
    /// What was expected and what was found.
    pub problem: String,
    /// What to do about it.
    pub remedy: String,
}

impl SheetError {
    pub(super) fn at(
        file: &str,
        place: Place,
        problem: impl Into<String>,
        remedy: impl Into<String>,
    ) -> Self {
        Self {
            file: file.to_owned(),
            place: Some(place),
            problem: problem.into(),
            remedy: remedy.into(),
        }
    }

    pub(super) fn whole(file: &str, problem: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self {
            file: file.to_owned(),
            place: None,
            problem: problem.into(),
            remedy: remedy.into(),
        }
    }

    fn message(&self) -> String {
        let place = match self.place {
            Some(place) => format!("{}, {place}", self.file),
            None => self.file.clone(),
        };
        format!("{place}: {}; {}", self.problem, self.remedy)
    }
}

/// Colours of the warp and the weft in a file that gives none (Fiberworks' own).
pub(super) const NO_PALETTE: [Srgb; 2] = [Srgb(255, 255, 255), Srgb(0, 0, 255)];

/// Colour numbers of threads that the file has no colour for: a draft weaves all the same,
/// so each gets a colour that stands in, and one line tells of all.
#[derive(Debug, Default)]
pub(super) struct StandIns {
    /// Of the warp and the weft: how many threads, and the colour that stands in.
    sides: [Option<(usize, Srgb)>; 2],
    /// Line, direction, thread from 1 and number as written, of the first.
    first: Option<(Option<u32>, Direction, usize, i64)>,
}

impl StandIns {
    /// Counts a thread (from 0) with a number that has no colour.
    pub fn count(
        &mut self,
        direction: Direction,
        thread: usize,
        (line, number): (Option<u32>, i64),
        colour: Srgb,
    ) {
        self.sides[direction as usize].get_or_insert((0, colour)).0 += 1;
        self.first
            .get_or_insert((line, direction, thread + 1, number));
    }

    /// Tells what was counted. `place` is where the file has its `known` colours.
    pub fn tell(self, place: &str, known: usize, warnings: &mut Warnings) {
        let Some((line, direction, thread, number)) = self.first else {
            return;
        };
        let (mut threads, mut colours) = (Vec::new(), Vec::new());
        for (side, [one, many, name]) in self
            .sides
            .iter()
            .zip([["end", "ends", "warp"], ["pick", "picks", "weft"]])
        {
            if let Some((count, colour)) = side {
                threads.push(format!("{count} {}", if *count == 1 { one } else { many }));
                colours.push(format!("{colour} for the {name}"));
            }
        }
        let having = match self.sides {
            [Some((1, _)), None] | [None, Some((1, _))] => "has a colour number",
            _ => "have colour numbers",
        };
        let lacking = match known {
            0 => format!("but there is no {place}"),
            _ => format!("outside the {known} of {place}"),
        };
        let what = format!(
            "{} {having} {lacking} (first {} {thread}: colour {number}); taken instead: {}",
            threads.join(" and "),
            ["end", "pick"][direction as usize],
            colours.join(", ")
        );
        match line {
            Some(line) => warnings.at(line, what),
            None => warnings.whole(what),
        }
    }
}

/// The number by which a yarn of a colour that has a stand-in is called: the file's own,
/// so that stripes stay apart, if a yarn can have it.
pub(super) fn kept_number(written: i64, stand_in: u32) -> u32 {
    u16::try_from(written).map_or(stand_in, u32::from)
}

/// The number (from 1) and colour of each of `threads` threads: as `listed` (from 0, with
/// the line where there is one), the rest as `usual` (from 1) if the palette has it, else
/// as the palette's first. A number that the palette lacks is counted and gets the
/// direction's own colour.
pub(super) fn colours<Number: Copy + Into<i64>>(
    palette: &[Srgb],
    listed: impl Iterator<Item = (Option<u32>, Number)>,
    threads: usize,
    usual: i64,
    (direction, stand_ins): (Direction, &mut StandIns),
) -> Vec<(u32, Srgb)> {
    let of = |number: i64| {
        let place = usize::try_from(number).ok()?;
        Some((place as u32 + 1, *palette.get(place)?))
    };
    let own = direction as u32;
    let stand_in = of(own.into())
        .or_else(|| of(0))
        .unwrap_or((own + 1, NO_PALETTE[own as usize]));
    let rest = of(usual - 1).unwrap_or(match palette.first() {
        Some(&first) => (1, first),
        None => stand_in,
    });
    let mut chosen = Vec::with_capacity(threads);
    for (thread, (line, number)) in listed.take(threads).enumerate() {
        let number = number.into();
        chosen.push(of(number).unwrap_or_else(|| {
            stand_ins.count(direction, thread, (line, number), stand_in.1);
            let kept = kept_number(number.saturating_add(1), stand_in.0);
            (kept, stand_in.1)
        }));
    }
    chosen.resize(threads, rest);
    chosen
}

/// What does not fit together in a sheet, and what to do.
pub(super) struct Misfit {
    pub problem: String,
    pub remedy: &'static str,
}

/// What a file says, whichever format it is in.
pub(super) struct Sheet<'f> {
    /// The file, as the reader was told.
    pub file: &'f str,
    /// Its title; `None` = the file's own name.
    pub title: Option<String>,
    pub notes: String,
    pub program: Option<String>,
    pub structure: Structure,
    pub warp: Threads,
    pub weft: Threads,
    /// Number and colour of each end; the order repeats.
    pub warp_colours: Vec<(u32, Srgb)>,
    /// Number and colour of each pick; the order repeats.
    pub weft_colours: Vec<(u32, Srgb)>,
    pub palette: Vec<Srgb>,
    pub sections: Vec<ForeignSection>,
    pub first_end: FirstEnd,
    pub first_pick: FirstPick,
}

impl Sheet<'_> {
    /// The design, with a yarn for each colour and size.
    ///
    /// # Errors
    /// [`Misfit`] for a sett that cannot be, too many yarns or a design that cannot be.
    pub fn design(self, options: &LoadOptions, mut warnings: Warnings) -> Result<Imported, Misfit> {
        let family = options.family.unwrap_or(Family::Cotton);
        let misfit = |remedy| move |problem| Misfit { problem, remedy };
        let spacing = Spacing::resolve(&self.warp, &self.weft, options, &mut warnings)
            .map_err(misfit("give another sett"))?;
        let (yarns, warp_order, weft_order) =
            threads::yarns(family, &spacing, &self.warp_colours, &self.weft_colours)
                .map_err(misfit("use fewer colours"))?;
        let maps = YarnMaps::orders(warp_order, weft_order);
        let sett = spacing.sett(usual_sett(&yarns, &maps));
        let title = self.title.unwrap_or_else(|| stem(self.file));
        let mut design = Design::new(title, self.structure, yarns, maps, sett)
            .map_err(|error| misfit("correct the draft")(error.to_string()))?;
        design.notes = self.notes;
        design.origin = Arc::new(Origin {
            program: self.program.filter(|program| !program.is_empty()),
            first_end: self.first_end,
            first_pick: self.first_pick,
            sections: self.sections,
            ends: self.warp.stated(),
            picks: self.weft.stated(),
            palette: self.palette,
        });
        Ok(Imported {
            design,
            warnings: warnings.finish(),
        })
    }
}

/// A title without the folders that some programs put before it.
pub(super) fn without_path(title: &str) -> String {
    let drive = title.get(1..3) == Some(":\\");
    let name = match title.rsplit_once('\\') {
        Some((_, name)) if drive => name,
        _ => title,
    };
    name.trim().to_owned()
}

/// How many there are: as declared, or as many as are used.
pub(super) fn at_least(
    declared: Option<u32>,
    used: u32,
    what: &str,
    warnings: &mut Warnings,
) -> u32 {
    match declared {
        Some(declared) if declared >= used => declared,
        Some(declared) if declared > 0 => {
            warnings.whole(format!(
                "{what}={declared} is declared, but {used} are used: there are {used}"
            ));
            used
        }
        _ => used,
    }
}

/// Of a tie-up and a lift plan in one file: silent if they weave the same.
pub(super) fn tieup_or_plan(
    treadled: Draft,
    planned: &Draft,
    line: u32,
    warnings: &mut Warnings,
) -> Draft {
    if treadled.drawdown() != planned.drawdown() {
        let what = "the lift plan weaves another cloth than tie-up and treadling";
        warnings.at(line, format!("{what}; tie-up and treadling count"));
    }
    treadled
}

/// Ends on a shaft and picks that lift something.
pub(super) struct Active {
    pub ends: Vec<bool>,
    pub picks: Vec<bool>,
}

impl Active {
    pub fn of(draft: &Draft) -> Self {
        let lifts = match draft.lifting() {
            Lifting::Treadled { treadling, .. } => treadling,
            Lifting::LiftPlan(plan) => plan,
        };
        Self {
            ends: draft.threading().iter().map(|on| !on.is_empty()).collect(),
            picks: lifts.iter().map(|set| !set.is_empty()).collect(),
        }
    }
}

pub(super) fn warn_unused_threads(draft: &Draft, warnings: &mut Warnings) {
    let active = Active::of(draft);
    for (flags, thread, does) in [
        (&active.ends, "end", "on no shaft"),
        (&active.picks, "pick", "without a lift"),
    ] {
        let idle = flags.iter().filter(|&&used| !used).count();
        if idle == 0 {
            continue;
        }
        let last = flags.iter().rposition(|&used| used).map_or(0, |at| at + 1);
        let place = if flags.len() - last == idle {
            format!(": all after {thread} {last}")
        } else {
            String::new()
        };
        let plural = if idle == 1 { " is" } else { "s are" };
        warnings.whole(format!("{idle} {thread}{plural} {does}{place}"));
    }
}
