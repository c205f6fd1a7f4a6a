//! A design becomes a WIF.

use std::collections::BTreeMap;
use std::fmt::Write;

use super::read::known;
use super::{MAX_THREADS, WifError};
use crate::design::{
    Density, DeriveError, Design, Draft, Lifting, Loom, MAX_CROSSINGS, MAX_SHAFTS, Repeat, Shed,
    Srgb, StatedThreads, Structure, WeavePattern, YarnId, YarnMap, derive,
};
use crate::formats::sheet::threads::unit_mm;

/// A written file and what of the design it does not hold.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Written {
    /// The file.
    pub text: String,
    /// One line each: what a WIF has no place for.
    pub lost: Vec<String>,
}

/// The most numbers a lift plan may have; beyond, no program opens the file.
const MAX_LIFTS: u64 = 1 << 24;

/// The most shafts and treadles of a drawdown that is written as a tie-up; beyond, no loom
/// has treadles and a lift plan says the same.
const MOST_TREADLED: u32 = 64;

/// The most shafts that programs read (DrawBoy).
const MOST_READ: u32 = 40;

/// Writes a design as WIF 1.1. Weaves that are no draft get the draft of fewest shafts, with
/// a tie-up up to 64 shafts and treadles and a lift plan beyond.
///
/// # Errors
/// [`WifError`] if the design is too large for shafts; export an image then.
pub fn write(design: &Design) -> Result<Written, WifError> {
    let mut lost = Vec::new();
    let drawn;
    let draft = match design.structure() {
        Structure::Draft(draft) => draft,
        other => {
            if matches!(other, Structure::Regions(_)) {
                lost.push("regions and corrections: only the weave they make is written".into());
            }
            drawn =
                draft_of(&design.weave()).map_err(|error| refused(design, error.to_string()))?;
            &drawn
        }
    };
    let size = threads(design, &mut lost);
    list_losses(design, &mut lost);
    let total = match draft.lifting() {
        Lifting::LiftPlan(plan) => plan.total() as u64 * size.1 / u64::from(draft.picks()),
        Lifting::Treadled { tieup, treadling } => {
            tieup.total() as u64 + treadling.total() as u64 * size.1 / u64::from(draft.picks())
        }
    };
    if total > MAX_LIFTS {
        let problem = format!("its lift plan would hold {total} numbers");
        return Err(refused(design, problem));
    }
    if draft.shafts() > MOST_READ {
        lost.push(format!(
            "nothing yet, but {} shafts are more than most programs read ({MOST_READ})",
            draft.shafts()
        ));
    }
    let text = Writer::new(design).all(draft, size);
    Ok(Written { text, lost })
}

fn draft_of(weave: &WeavePattern) -> Result<Draft, DeriveError> {
    let loom = Loom {
        shafts: MOST_TREADLED,
        treadles: MOST_TREADLED,
        dobby: true,
    };
    match derive(weave, &loom) {
        Err(DeriveError::Shafts { .. }) => derive(weave, &Loom::dobby(MAX_SHAFTS)),
        answer => answer,
    }
}

fn refused(design: &Design, problem: String) -> WifError {
    let remedy = "write an image of the weave instead";
    WifError::whole(&design.name, problem, remedy)
}

/// Ends and picks of the file: the cloth's whole repeat, or the weave's if that is too long.
fn threads(design: &Design, lost: &mut Vec<String>) -> (u64, u64) {
    let (ends, picks) = design.cloth_repeat();
    let most = u64::from(MAX_THREADS);
    if ends <= most && picks <= most && ends.saturating_mul(picks) <= MAX_CROSSINGS {
        return (ends, picks);
    }
    lost.push(format!(
        "the repeat of {ends} ends × {picks} picks is too long: yarn orders are cut off after \
         one repeat of the weave"
    ));
    (u64::from(design.ends()), u64::from(design.picks()))
}

fn list_losses(design: &Design, lost: &mut Vec<String>) {
    if !design.weavable() {
        lost.push("yarns that change along a thread: each thread keeps its first".into());
    }
    let lattice = design.lattice();
    if lattice.across != Repeat::Straight || lattice.along != Repeat::Straight {
        lost.push("the repeat: a WIF repeats straight in both directions".into());
    }
    if design.yarns().iter().any(|yarn| {
        yarn.tex.is_some() || yarn.gloss.is_some() || yarn.family != crate::design::Family::Cotton
    }) {
        lost.push("what yarns are made of, their counts and gloss".into());
    }
}

struct Writer<'d> {
    design: &'d Design,
    /// Colours in the order of their numbers.
    palette: Vec<Srgb>,
    /// Number of each colour, from 1.
    numbers: BTreeMap<Srgb, usize>,
    sections: Vec<(String, String)>,
}

impl<'d> Writer<'d> {
    fn new(design: &'d Design) -> Self {
        let mut palette = design.origin.palette.clone();
        let mut numbers = BTreeMap::new();
        for (place, &colour) in palette.iter().enumerate() {
            numbers.entry(colour).or_insert(place + 1);
        }
        for yarn in design.yarns() {
            numbers.entry(yarn.colour).or_insert_with(|| {
                palette.push(yarn.colour);
                palette.len()
            });
        }
        Self {
            design,
            palette,
            numbers,
            sections: Vec::new(),
        }
    }

    fn section(&mut self, name: &str, body: String) {
        self.sections.push((name.to_owned(), body));
    }

    /// The colour number of a yarn, from 1.
    fn number(&self, id: YarnId) -> usize {
        let colour = self.design.yarn(id).colour;
        self.numbers.get(&colour).copied().unwrap_or(1)
    }

    fn all(mut self, draft: &Draft, (ends, picks): (u64, u64)) -> String {
        let design = self.design;
        self.texts();
        self.weaving(draft);
        let sett = design.sett();
        let origin = &design.origin;
        let maps = design.maps();
        self.thread_sections("WARP", &maps.warp, &sett.ends, origin.ends.as_ref(), ends);
        self.thread_sections(
            "WEFT",
            &maps.weft,
            &sett.picks,
            origin.picks.as_ref(),
            picks,
        );
        let mut range = String::new();
        let _ = writeln!(range, "Range=0,255\nEntries={}", self.palette.len());
        self.section("COLOR PALETTE", range);
        let mut table = String::new();
        for (place, Srgb(red, green, blue)) in self.palette.iter().enumerate() {
            let _ = writeln!(table, "{}={red},{green},{blue}", place + 1);
        }
        self.section("COLOR TABLE", table);
        self.draft(draft, ends, picks);
        for kept in &design.origin.sections {
            if known(&kept.name) || kept.name.contains([']', '\n', '\r']) {
                continue;
            }
            let mut body = String::with_capacity(kept.text.len() + 1);
            for line in kept.text.lines() {
                // A line that would open a section cannot have come from one.
                if !line.trim_start().starts_with('[') && !line.contains('\r') {
                    let _ = writeln!(body, "{line}");
                }
            }
            self.section(&kept.name, body);
        }
        self.finish()
    }

    fn texts(&mut self) {
        let title = one_line(&self.design.name);
        self.section("TEXT", format!("Title={title}\n"));
        if !self.design.notes.is_empty() {
            let mut notes = String::new();
            for (place, note) in self.design.notes.lines().enumerate() {
                let _ = writeln!(notes, "{}={}", place + 1, one_line(note));
            }
            self.section("NOTES", notes);
        }
    }

    fn weaving(&mut self, draft: &Draft) {
        let rising = match draft.shed() {
            Shed::Rising => "true",
            Shed::Sinking => "false",
        };
        let treadles = draft.treadles().max(1);
        let shafts = draft.shafts().max(1);
        self.section(
            "WEAVING",
            format!("Rising Shed={rising}\nTreadles={treadles}\nShafts={shafts}\n"),
        );
    }

    fn thread_sections(
        &mut self,
        side: &str,
        map: &YarnMap,
        density: &Density,
        stated: Option<&StatedThreads>,
        threads: u64,
    ) {
        let at = |thread: u64| match map {
            YarnMap::Order(order) => order[(thread % order.len() as u64) as usize],
            YarnMap::Crossings(grid) if side == "WARP" => grid.get_wrapped(thread as i64, 0),
            YarnMap::Crossings(grid) => grid.get_wrapped(0, thread as i64),
        };
        let number = |thread: u64| self.number(at(thread));
        let first = number(0);
        let mut colours = String::new();
        if (1..threads).any(|thread| number(thread) != first) {
            for thread in 0..threads {
                let _ = writeln!(colours, "{}={}", thread + 1, number(thread));
            }
        }
        let width = |thread| self.design.yarn(at(thread)).diameter() / 10.0;
        let assumed = self.design.sett().assumed;
        let unchanged = stated.filter(|stated| {
            let same = |pitch: f32| (pitch / density.pitch_mm() - 1.0).abs() < 1e-4;
            assumed || pitch_of(stated).is_some_and(same)
        });
        let lengths = match unchanged {
            Some(stated) => Lengths::stated(stated),
            // A sett that nobody chose is not written down as if somebody had.
            None if assumed => Lengths::default(),
            None => Lengths::chosen(density, threads, width),
        };
        let usual = &lengths.usual;
        self.section(side, format!("Threads={threads}\nColor={first}\n{usual}"));
        for (what, list) in [
            ("COLORS", colours),
            ("SPACING", lengths.spacings),
            ("THICKNESS", lengths.thicknesses),
        ] {
            if !list.is_empty() {
                self.section(&format!("{side} {what}"), list);
            }
        }
    }

    fn draft(&mut self, draft: &Draft, ends: u64, picks: u64) {
        let threading = list(ends, |end| {
            draft
                .threading()
                .row((end % u64::from(draft.ends())) as usize)
        });
        self.section("THREADING", threading);
        let pick_of = |pick: u64| (pick % u64::from(draft.picks())) as usize;
        match draft.lifting() {
            Lifting::Treadled { tieup, treadling } => {
                let ties = list(tieup.len() as u64, |treadle| tieup.row(treadle as usize));
                self.section("TIEUP", ties);
                self.section(
                    "TREADLING",
                    list(picks, |pick| treadling.row(pick_of(pick))),
                );
            }
            Lifting::LiftPlan(plan) => {
                self.section("LIFTPLAN", list(picks, |pick| plan.row(pick_of(pick))));
            }
        }
    }

    fn finish(self) -> String {
        let mut text = String::from(
            "[WIF]\nVersion=1.1\nDate=April 20, 1997\nDevelopers=wif@mhsoft.com\n\
             Source Program=Pickglass\n",
        );
        let _ = writeln!(text, "Source Version={}", env!("CARGO_PKG_VERSION"));
        text.push_str("\n[CONTENTS]\n");
        for (name, _) in &self.sections {
            let _ = writeln!(text, "{name}=true");
        }
        for (name, body) in &self.sections {
            let _ = write!(text, "\n[{name}]\n{body}");
        }
        text
    }
}

/// Units, spacing and thickness of one direction as lines.
#[derive(Default)]
struct Lengths {
    /// For [WARP] or [WEFT].
    usual: String,
    /// For single threads.
    spacings: String,
    thicknesses: String,
}

impl Lengths {
    /// As the file said that the design is from.
    fn stated(stated: &StatedThreads) -> Self {
        let mut lines = Self::default();
        if !stated.unit.is_empty() {
            let _ = writeln!(lines.usual, "Units={}", one_line(&stated.unit));
        }
        if let Some(spacing) = stated.spacing {
            let _ = writeln!(lines.usual, "Spacing={spacing}");
        }
        if let Some(thickness) = stated.thickness {
            let _ = writeln!(lines.usual, "Thickness={thickness}");
        }
        for &(thread, spacing) in &stated.spacings {
            let _ = writeln!(lines.spacings, "{}={spacing}", u64::from(thread) + 1);
        }
        for &(thread, thickness) in &stated.thicknesses {
            let _ = writeln!(lines.thicknesses, "{}={thickness}", u64::from(thread) + 1);
        }
        lines
    }

    /// From the design's own sett and yarns; `width` in cm.
    fn chosen(density: &Density, threads: u64, width: impl Fn(u64) -> f32) -> Self {
        let (pitch, usual) = (density.pitch_mm() / 10.0, width(0));
        let mut lines = Self {
            usual: format!("Units=Centimeters\nSpacing={pitch}\nThickness={usual}\n"),
            ..Self::default()
        };
        for thread in 0..threads {
            if density.pitches_mm.is_some() {
                let pitch = density.pitch_of(thread as i64) / 10.0;
                let _ = writeln!(lines.spacings, "{}={pitch}", thread + 1);
            }
            let width = width(thread);
            if width != usual {
                let _ = writeln!(lines.thicknesses, "{}={width}", thread + 1);
            }
        }
        lines
    }
}

/// The stated pitch in mm.
fn pitch_of(stated: &StatedThreads) -> Option<f32> {
    Some(stated.spacing? * unit_mm(&stated.unit)?)
}

/// A text without line breaks, which would start another entry.
fn one_line(text: &str) -> String {
    text.replace(['\n', '\r'], " ").trim().to_owned()
}

/// `number=member,member…` lines counted from 1; the empty set is 0.
fn list<'d>(count: u64, row: impl Fn(u64) -> &'d [u16]) -> String {
    let mut text = String::new();
    for index in 0..count {
        let _ = write!(text, "{}=", index + 1);
        let members = row(index);
        if members.is_empty() {
            text.push('0');
        }
        for (place, member) in members.iter().enumerate() {
            let comma = if place > 0 { "," } else { "" };
            let _ = write!(text, "{comma}{}", u32::from(*member) + 1);
        }
        text.push('\n');
    }
    text
}
