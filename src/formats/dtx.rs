//! Fiberworks .dtx, the text format of a drafting program: reading.
//!
//! Sections open with `@@Name`, keys with `%%`; `@@EndDTX` closes the file. `@@Threading`
//! has the shaft of each end (0 = none), `@@Tieup` a row of 0 and 1 for each shaft with
//! shaft 1 *last*, `@@Treadling` the treadles of each pick (several separated by commas),
//! `@@Liftplan` a row for each pick. Colours count from 0; spacings are multiples of
//! 0.053 cm, 4 where nothing is said, which is the program's default and no sett. Whatever
//! is read is treated as in the `wif` module: shafts grow to what is used, treadles
//! that are neither declared nor tied up are refused, tie-up and treadling count where a
//! lift plan differs.

use std::num::IntErrorKind;

use super::encoding::decode;
use super::field_table::Handling::{Honoured, Warned};
use super::field_table::{Field, Table};
use super::sheet::text::{lines, shorten};
use super::sheet::threads::Threads;
use super::sheet::{
    Misfit, Place, Sheet, SheetError, StandIns, Warnings, at_least, colours, tieup_or_plan,
    warn_unused_threads, without_path,
};
use super::{Imported, LoadOptions};
use crate::design::{
    Direction, Draft, FirstEnd, FirstPick, Lifting, MAX_SHAFTS, Shed, Srgb, Structure, Ties,
    check_size,
};
use crate::limits::DRAFT_THREADS as MAX_THREADS;

/// How every file begins.
const MAGIC: &[u8] = b"@@StartDTX";

/// One step of spacing in cm, and the steps of a thread that nothing is said about.
const STEP_CM: f32 = 0.053;
const USUAL_STEPS: u32 = 4;

/// The largest step of spacing taken; beyond, no cloth hangs together.
const MAX_STEPS: u32 = 1000;

/// More sections than any program writes; a guard against files made of headers.
const MAX_SECTIONS: usize = 256;

/// What a file says of sizes, colours and threads: keys, and sections with their lines.
pub const FIELDS: Table = Table {
    format: "dtx",
    fields: &[
        Field::new("%%shafts", Honoured, "6"),
        Field::new("%%treadles", Honoured, "6"),
        Field::new("%%ends", Honoured, "6"),
        Field::new("%%picks", Honoured, "6"),
        Field::new("%%sinking", Honoured, "1"),
        Field::new("@@Threading", Honoured, "4 3 1 1"),
        Field::new("@@Tieup", Honoured, "1000\n0100\n0010\n0011"),
        Field::new("@@Treadling", Honoured, "4 3 1,2 1"),
        Field::new("@@Liftplan", Honoured, "1111\n0100\n0010\n0011"),
        Field::new("@@Color Palet", Honoured, "9,9,9\n1,2,3"),
        Field::new("@@Color Palette", Honoured, "9,9,9\n1,2,3"),
        Field::new("@@Warp Colors", Honoured, "1 0 1 1"),
        Field::new("@@Weft Colors", Honoured, "0 0 1 1"),
        Field::new("@@Warp Spacing", Honoured, "4 2 4 4"),
        Field::new("@@Weft Spacing", Honoured, "4 2 4 4"),
        // Not of the format as it is known: what a later version may add.
        Field::new("@@Warp Thickness", Warned, "4 2 4 4"),
    ],
};

/// The sections that are read, or say nothing of the cloth.
const KNOWN: [&str; 16] = [
    "startdtx",
    "enddtx",
    "description",
    "imprint",
    "info",
    "notes",
    "threading",
    "tieup",
    "treadling",
    "liftplan",
    "color palet",
    "color palette",
    "warp colors",
    "weft colors",
    "warp spacing",
    "weft spacing",
];

/// Whether bytes are a Fiberworks draft.
pub fn recognises(bytes: &[u8]) -> bool {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let start = bytes.trim_ascii_start();
    start.len() >= MAGIC.len() && start[..MAGIC.len()].eq_ignore_ascii_case(MAGIC)
}

/// Reads a Fiberworks draft. `name` is what messages call it.
///
/// # Errors
/// [`SheetError`]: one line with the file, the line, what was expected and what to do.
pub fn read(bytes: &[u8], name: &str, options: &LoadOptions) -> Result<Imported, SheetError> {
    let mut warnings = Warnings::default();
    let text = decode(bytes, &mut warnings);
    let file = File::split(&text, name, &mut warnings)?;
    let draft = read_draft(&file, &mut warnings)?;
    warn_unused_threads(&draft, &mut warnings);
    let palette = read_palette(&file, &mut warnings)?;
    let mut stand_ins = StandIns::default();
    let mut side = |side: Side, threads: u32| -> Result<_, SheetError> {
        let threads = threads as usize;
        let chosen = side.colours(&file, &palette, threads, &mut stand_ins, &mut warnings)?;
        Ok((chosen, side.spacings(&file, threads, &mut warnings)?))
    };
    let (warp_colours, warp) = side(WARP, draft.ends())?;
    let (weft_colours, weft) = side(WEFT, draft.picks())?;
    stand_ins.tell("@@Color Palet", palette.len(), &mut warnings);
    let first_line = |section| {
        let first = file.section(section)?.rows().next()?;
        Some(first.1.to_owned())
    };
    let notes = read_notes(&file, &mut warnings);
    let sheet = Sheet {
        file: name,
        title: first_line("description").map(|title| without_path(&title)),
        notes,
        program: first_line("imprint").map(|version| format!("Fiberworks {version}")),
        structure: Structure::Draft(draft),
        warp,
        weft,
        warp_colours,
        weft_colours,
        palette,
        sections: Vec::new(),
        first_end: FirstEnd::Left,
        first_pick: FirstPick::Bottom,
    };
    let wrong = |misfit: Misfit| SheetError::whole(name, misfit.problem, misfit.remedy);
    sheet.design(options, warnings).map_err(wrong)
}

/// More lines of notes than anybody writes.
const MAX_NOTES: usize = 10_000;

fn read_notes(file: &File<'_>, warnings: &mut Warnings) -> String {
    let mut notes = String::new();
    let Some(section) = file.section("notes") else {
        return notes;
    };
    for (count, (line, note)) in section.rows().enumerate() {
        if count >= MAX_NOTES {
            warnings.at(line, format!("notes beyond {MAX_NOTES} lines are left out"));
            break;
        }
        if count > 0 {
            notes.push('\n');
        }
        notes.push_str(note);
    }
    notes
}

/// What stands between one `@@` line and the next.
struct Section<'t> {
    name: &'t str,
    /// Line of the header, from 1.
    line: u32,
    body: &'t str,
}

impl<'t> Section<'t> {
    /// Lines that are neither blank nor keys, without blanks around them, by number.
    fn rows(&self) -> impl Iterator<Item = (u32, &'t str)> + use<'t> {
        let from = self.line + 1;
        let numbered = (from..).zip(lines(self.body).map(str::trim));
        numbered.filter(|(_, row)| !row.is_empty() && !row.starts_with("%%"))
    }

    /// The value of a `%%key`, with its line.
    fn key(&self, key: &str) -> Option<(u32, &'t str)> {
        let from = self.line + 1;
        (from..).zip(lines(self.body)).find_map(|(line, row)| {
            let row = row.trim().strip_prefix("%%")?;
            let (found, value) = row.split_once(char::is_whitespace).unwrap_or((row, ""));
            found
                .eq_ignore_ascii_case(key)
                .then_some((line, value.trim()))
        })
    }

    /// Words between blanks, by line.
    fn words(&self) -> impl Iterator<Item = (u32, &'t str)> + use<'t> {
        self.rows()
            .flat_map(|(line, row)| row.split_whitespace().map(move |word| (line, word)))
    }
}

/// The sections of one file.
struct File<'t> {
    name: &'t str,
    sections: Vec<Section<'t>>,
}

impl<'t> File<'t> {
    fn split(text: &'t str, name: &'t str, warnings: &mut Warnings) -> Result<Self, SheetError> {
        let start_of = |line: &str| line.as_ptr() as usize - text.as_ptr() as usize;
        let mut file = Self {
            name,
            sections: Vec::new(),
        };
        let mut body_from = 0;
        let mut ended = false;
        for (number, line) in (1..).zip(lines(text)) {
            let Some(header) = line.trim().strip_prefix("@@") else {
                continue;
            };
            if let Some(last) = file.sections.last_mut() {
                last.body = &text[body_from..start_of(line)];
            }
            if file.sections.len() >= MAX_SECTIONS {
                let problem = format!("expected at most {MAX_SECTIONS} sections");
                return Err(file.at(number, problem, "this is not a draft"));
            }
            let header = header.trim();
            if file.section(header).is_some() {
                warnings.at(
                    number,
                    format!("@@{} again; the first counts", shorten(header)),
                );
            }
            if !KNOWN.iter().any(|name| header.eq_ignore_ascii_case(name)) {
                let what = format!("@@{} is not known and not read", shorten(header));
                warnings.at(number, what);
            }
            ended = header.eq_ignore_ascii_case("EndDTX");
            body_from = (start_of(line) + line.len()).min(text.len());
            // The line break after the header is its own line's.
            let rest = &text[body_from..];
            body_from += match rest.as_bytes() {
                [b'\r', b'\n', ..] => 2,
                [b'\r' | b'\n', ..] => 1,
                _ => 0,
            };
            file.sections.push(Section {
                name: header,
                line: number,
                body: &text[body_from..],
            });
            if ended {
                break;
            }
        }
        if !ended {
            warnings.whole("there is no @@EndDTX: the file may have been cut off");
        }
        Ok(file)
    }

    /// The first section of a name; `Color Palet` is how the program spells its palette.
    fn section(&self, name: &str) -> Option<&Section<'t>> {
        self.sections.iter().find(|section| {
            let is = |known: &str| section.name.eq_ignore_ascii_case(known);
            is(name) || (name == "color palette" && is("color palet"))
        })
    }

    fn at(&self, line: u32, problem: impl Into<String>, remedy: impl Into<String>) -> SheetError {
        SheetError::at(self.name, Place::Line(line), problem, remedy)
    }

    /// A count from `@@Info`; missing or 0 is `None`.
    fn count(&self, key: &str, most: u32) -> Result<Option<u32>, SheetError> {
        let Some((line, value)) = self.section("info").and_then(|info| info.key(key)) else {
            return Ok(None);
        };
        match value.parse::<u32>() {
            Ok(count) if count <= most => Ok((count > 0).then_some(count)),
            _ => {
                let value = shorten(value);
                let problem = format!(
                    "expected %%{key} to be a whole number up to {most}, found \"{value}\""
                );
                Err(self.at(line, problem, "correct the number"))
            }
        }
    }

    /// Sets of numbers from 1 (0 = none), separated by blanks; commas within a set.
    fn sets(
        &self,
        section: &Section<'_>,
        what: &str,
        most: u32,
        threads: Option<u32>,
        warnings: &mut Warnings,
    ) -> Result<Ties, SheetError> {
        let mut ties = Ties::default();
        let mut set: Vec<u16> = Vec::new();
        let mut open = false;
        let limit = threads.unwrap_or(MAX_THREADS);
        let mut beyond = None;
        let mut finish = |set: &mut Vec<u16>, line| {
            if ties.len() as u32 >= limit {
                beyond.get_or_insert(line);
            } else {
                ties.push(set);
            }
            set.clear();
        };
        let mut last = section.line;
        for (line, word) in section.words() {
            // ", " within a set continues it.
            if open && !word.starts_with(',') {
                finish(&mut set, last);
            }
            last = line;
            for member in word.split(',').filter(|member| !member.is_empty()) {
                match member.parse::<u32>() {
                    Ok(0) => {}
                    Ok(number) if number <= most => set.push((number - 1) as u16),
                    _ => {
                        let member = shorten(member);
                        let problem =
                            format!("expected a {what} from 0 to {most}, found \"{member}\"");
                        let remedy = "correct the number, or declare and tie up what it names";
                        return Err(self.at(line, problem, remedy));
                    }
                }
            }
            open = !word.ends_with(',');
        }
        if open || !set.is_empty() {
            finish(&mut set, last);
        }
        if let Some(line) = beyond {
            let what = format!(
                "@@{} goes on beyond the last thread ({limit})",
                section.name
            );
            warnings.at(line, format!("{what}; the rest is ignored"));
        }
        Ok(ties)
    }
}

/// `ties` with empty sets up to `threads`.
fn padded(mut ties: Ties, threads: u32) -> Ties {
    while (ties.len() as u32) < threads {
        ties.push(&[]);
    }
    ties
}

fn read_draft(file: &File<'_>, warnings: &mut Warnings) -> Result<Draft, SheetError> {
    let missing = |what: &str, line: Option<u32>| {
        let problem = format!("expected {what}, found none");
        let remedy = "add it, or write an @@Liftplan";
        match line {
            Some(line) => file.at(line, problem, remedy),
            None => SheetError::whole(file.name, problem, remedy),
        }
    };
    let Some(threading) = file.section("threading") else {
        let problem = "expected an @@Threading with the shaft of each end, found none";
        return Err(SheetError::whole(file.name, problem, "add the threading"));
    };
    let (ends, picks) = (
        file.count("ends", MAX_THREADS)?,
        file.count("picks", MAX_THREADS)?,
    );
    let [tieup, treadling, plan] =
        ["tieup", "treadling", "liftplan"].map(|name| file.section(name));
    let line = |section: Option<&Section<'_>>| section.map(|section| section.line);
    let declared = file.count("treadles", MAX_SHAFTS)?;
    let treadled = match (tieup, treadling) {
        (Some(tieup), Some(treadling)) => Some((tieup, treadling)),
        (None, None) if plan.is_none() => {
            return Err(missing("@@Tieup and @@Treadling, or an @@Liftplan", None));
        }
        (Some(_), None) if plan.is_none() => {
            return Err(missing("an @@Treadling for the tie-up", line(tieup)));
        }
        (None, Some(_)) if plan.is_none() => {
            return Err(missing("an @@Tieup for the treadles", line(treadling)));
        }
        _ => None,
    };
    let threading = file.sets(threading, "shaft", MAX_SHAFTS, ends, warnings)?;
    let ends = ends.unwrap_or(threading.len() as u32);
    let size_checked = |picks: u32| {
        check_size(u64::from(ends), u64::from(picks)).map_err(|error| {
            let line = line(file.section("info")).unwrap_or(1);
            file.at(line, error.to_string(), "check %%ends and %%picks")
        })
    };
    let threading = padded(threading, ends);
    let shafts = file.count("shafts", MAX_SHAFTS)?;
    let wrong = |error: crate::design::DraftError| {
        SheetError::whole(file.name, error.to_string(), "correct the draft")
    };
    let mut by_treadles = None;
    if let Some((tieup, treadling)) = treadled {
        let (ties, shed) = read_tieup(file, tieup)?;
        let treadles = at_least(declared, ties.len() as u32, "treadles", warnings);
        let pressed = file.sets(treadling, "treadle", treadles, picks, warnings)?;
        let picks = picks.unwrap_or(pressed.len() as u32);
        size_checked(picks)?;
        let shafts = at_least(
            shafts,
            threading.bound().max(ties.bound()),
            "shafts",
            warnings,
        );
        let lifting = Lifting::Treadled {
            tieup: padded(ties, treadles),
            treadling: padded(pressed, picks),
        };
        by_treadles =
            Some(Draft::new(shafts, treadles, shed, threading.clone(), lifting).map_err(wrong)?);
    }
    let Some(plan) = plan else {
        return by_treadles.ok_or_else(|| missing("a tie-up or a lift plan", None));
    };
    let (lifts, shed) = read_plan(file, plan, picks, warnings)?;
    let picks = picks.unwrap_or(lifts.len() as u32);
    size_checked(picks)?;
    let shafts = at_least(
        shafts,
        threading.bound().max(lifts.bound()),
        "shafts",
        warnings,
    );
    let lifting = Lifting::LiftPlan(padded(lifts, picks));
    let treadles = shafts.max(declared.unwrap_or(0));
    let planned = Draft::new(shafts, treadles, shed, threading, lifting).map_err(wrong)?;
    Ok(match by_treadles {
        Some(treadled) => tieup_or_plan(treadled, &planned, plan.line, warnings),
        None => planned,
    })
}

fn shed(section: &Section<'_>) -> Shed {
    match section.key("sinking") {
        Some(_) => Shed::Sinking,
        None => Shed::Rising,
    }
}

/// The places of the 1s in a row of 0 and 1, which may stand apart.
fn ones<'r>(
    file: &'r File<'_>,
    line: u32,
    row: &'r str,
) -> impl Iterator<Item = Result<u16, SheetError>> + 'r {
    let cells = row.bytes().filter(|cell| !cell.is_ascii_whitespace());
    cells
        .enumerate()
        .filter_map(move |(place, cell)| match cell {
            b'0' if place < MAX_SHAFTS as usize => None,
            b'1' if place < MAX_SHAFTS as usize => Some(Ok(place as u16)),
            _ => {
                let problem = format!(
                    "expected at most {MAX_SHAFTS} of 0 and 1, found \"{}\"",
                    shorten(row)
                );
                Some(Err(file.at(line, problem, "correct the row")))
            }
        })
}

/// Shafts of each treadle; the last row is shaft 1.
fn read_tieup(file: &File<'_>, section: &Section<'_>) -> Result<(Ties, Shed), SheetError> {
    let shafts = section.rows().count();
    if shafts == 0 || shafts > MAX_SHAFTS as usize {
        let problem = format!("expected 1 to {MAX_SHAFTS} rows in @@Tieup, found {shafts}");
        return Err(file.at(section.line, problem, "write a row for each shaft"));
    }
    // Counting sort by treadle: how many shafts each has, where they start, then which.
    let mut starts = vec![0usize];
    for (line, row) in section.rows() {
        let width = row
            .bytes()
            .filter(|cell| !cell.is_ascii_whitespace())
            .count();
        starts.resize(starts.len().max(width.min(MAX_SHAFTS as usize) + 1), 0);
        for treadle in ones(file, line, row) {
            starts[usize::from(treadle?) + 1] += 1;
        }
    }
    for treadle in 1..starts.len() {
        starts[treadle] += starts[treadle - 1];
    }
    let mut tied = vec![0u16; starts[starts.len() - 1]];
    let mut next = starts.clone();
    for (above, (line, row)) in section.rows().enumerate() {
        for treadle in ones(file, line, row) {
            let place = &mut next[usize::from(treadle?)];
            tied[*place] = (shafts - 1 - above) as u16;
            *place += 1;
        }
    }
    let mut ties = Ties::with_room(starts.len() - 1, tied.len());
    for treadle in starts.windows(2) {
        ties.push(&tied[treadle[0]..treadle[1]]);
    }
    Ok((ties, shed(section)))
}

/// Shafts of each pick; the first row is pick 1.
fn read_plan(
    file: &File<'_>,
    section: &Section<'_>,
    picks: Option<u32>,
    warnings: &mut Warnings,
) -> Result<(Ties, Shed), SheetError> {
    let limit = picks.unwrap_or(MAX_THREADS);
    let mut plan = Ties::default();
    let mut lifted = Vec::new();
    for (line, row) in section.rows() {
        if plan.len() as u32 >= limit {
            let what = format!("@@{} goes on beyond the last pick ({limit})", section.name);
            warnings.at(line, format!("{what}; the rest is ignored"));
            break;
        }
        lifted.clear();
        for shaft in ones(file, line, row) {
            lifted.push(shaft?);
        }
        plan.push(&lifted);
    }
    Ok((plan, shed(section)))
}

fn read_palette(file: &File<'_>, warnings: &mut Warnings) -> Result<Vec<Srgb>, SheetError> {
    let Some(section) = file.section("color palette") else {
        return Ok(Vec::new());
    };
    let mut palette = Vec::new();
    let mut outside: Option<(u32, u32)> = None;
    for (line, row) in section.rows() {
        let mut channels = row.split(',').map(|channel| whole(channel.trim()));
        let (Some(Some(red)), Some(Some(green)), Some(Some(blue)), None) = (
            channels.next(),
            channels.next(),
            channels.next(),
            channels.next(),
        ) else {
            let row = shorten(row);
            let problem = format!("expected red,green,blue from 0 to 255, found \"{row}\"");
            return Err(file.at(line, problem, "correct the colour"));
        };
        if palette.len() >= MAX_COLOURS {
            let problem = format!("expected at most {MAX_COLOURS} colours");
            return Err(file.at(line, problem, "join those that look alike"));
        }
        let written = [red, green, blue];
        let [red, green, blue] = written.map(|channel| channel.clamp(0, 255) as u8);
        if [red, green, blue].map(i64::from) != written {
            outside.get_or_insert((line, 0)).1 += 1;
        }
        palette.push(Srgb(red, green, blue));
    }
    if let Some((line, count)) = outside {
        let what = match count {
            1 => "a colour lies".to_owned(),
            _ => format!("{count} colours lie"),
        };
        warnings.at(line, format!("{what} outside 0 to 255: cut off"));
    }
    Ok(palette)
}

/// More colours than any palette has.
const MAX_COLOURS: usize = 1 << 14;

/// One direction and its sections.
struct Side {
    direction: Direction,
    colours: &'static str,
    spacing: &'static str,
}

const WARP: Side = Side {
    direction: Direction::Warp,
    colours: "warp colors",
    spacing: "warp spacing",
};
const WEFT: Side = Side {
    direction: Direction::Weft,
    colours: "weft colors",
    spacing: "weft spacing",
};

/// A whole number, or the nearest that can be told; `None` for what is no number.
fn whole(word: &str) -> Option<i64> {
    match word.parse::<i64>() {
        Ok(number) => Some(number),
        Err(error) if *error.kind() == IntErrorKind::PosOverflow => Some(i64::MAX),
        Err(error) if *error.kind() == IntErrorKind::NegOverflow => Some(i64::MIN),
        Err(_) => None,
    }
}

impl Side {
    /// The whole numbers of a list, with their lines.
    fn list(
        file: &File<'_>,
        name: &str,
        threads: usize,
        warnings: &mut Warnings,
    ) -> Result<Vec<(u32, i64)>, SheetError> {
        let mut found = Vec::new();
        let Some(section) = file.section(name) else {
            return Ok(found);
        };
        for (line, word) in section.words() {
            if found.len() >= threads {
                let what = format!("@@{} goes on beyond the last thread", section.name);
                warnings.at(line, format!("{what} ({threads}); the rest is ignored"));
                break;
            }
            let Some(number) = whole(word) else {
                let (section, word) = (section.name, shorten(word));
                let problem = format!("expected a whole number in @@{section}, found {word}");
                return Err(file.at(line, problem, "correct the number"));
            };
            found.push((line, number));
        }
        Ok(found)
    }

    fn colours(
        &self,
        file: &File<'_>,
        palette: &[Srgb],
        threads: usize,
        stand_ins: &mut StandIns,
        warnings: &mut Warnings,
    ) -> Result<Vec<(u32, Srgb)>, SheetError> {
        let listed = Self::list(file, self.colours, threads, warnings)?;
        let own = self.direction as i64 + 1;
        let usual = listed
            .first()
            .map_or(own, |first| first.1.saturating_add(1));
        let numbers = listed.iter().map(|&(line, number)| (Some(line), number));
        let side = (self.direction, stand_ins);
        Ok(colours(palette, numbers, threads, usual, side))
    }

    fn spacings(
        &self,
        file: &File<'_>,
        threads: usize,
        warnings: &mut Warnings,
    ) -> Result<Threads, SheetError> {
        let steps = Self::list(file, self.spacing, threads, warnings)?;
        if steps.is_empty() {
            return Ok(Threads::listed(threads, None, Vec::new()));
        }
        let mut spacings = Vec::new();
        let mut none: Option<(u32, u32, u32)> = None;
        for (thread, &(line, step)) in (0..).zip(&steps) {
            match u32::try_from(step) {
                Ok(0) => none.get_or_insert((line, thread + 1, 0)).2 += 1,
                Ok(step @ 1..=MAX_STEPS) if step != USUAL_STEPS => {
                    spacings.push((thread, step as f32 * STEP_CM));
                }
                Ok(USUAL_STEPS) => {}
                _ => {
                    let problem = format!(
                        "expected a number from 0 to {MAX_STEPS} in @@{}, found {step}",
                        self.spacing
                    );
                    return Err(file.at(line, problem, "correct the number"));
                }
            }
        }
        if let Some((line, thread, count)) = none {
            let have = if count == 1 {
                "thread has"
            } else {
                "threads have"
            };
            let what = format!("{count} {have} no spacing in @@{}", self.spacing);
            warnings.at(
                line,
                format!("{what} (first {thread}); the usual one is taken"),
            );
        }
        let usual = USUAL_STEPS as f32 * STEP_CM;
        Ok(Threads::listed(
            threads,
            Some(("Centimeters", usual)),
            spacings,
        ))
    }
}
