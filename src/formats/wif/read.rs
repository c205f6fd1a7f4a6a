//! A WIF becomes a design.

use std::borrow::Cow;
use std::collections::BTreeMap;

use super::fields::name_unfollowed;
use super::text::{self, Section, bare, boolean};
use super::{MAX_THREADS, WifError, colours, threads};
use crate::design::{
    Direction, Draft, FirstEnd, FirstPick, ForeignSection, Lifting, MAX_SHAFTS, Shed, Structure,
    Ties, check_size,
};
use crate::formats::encoding::decode;
use crate::formats::sheet::text::{same, shorten};
use crate::formats::sheet::{
    Active, Misfit, Sheet, Warnings, at_least, tieup_or_plan, warn_unused_threads, without_path,
};
use crate::formats::{Imported, LoadOptions};

/// The sections a design has a place for; all others are kept word for word.
const OWN: [&str; 17] = [
    "WIF",
    "CONTENTS",
    "COLOR PALETTE",
    "COLOR TABLE",
    "WEAVING",
    "WARP",
    "WEFT",
    "THREADING",
    "TIEUP",
    "TREADLING",
    "LIFTPLAN",
    "WARP COLORS",
    "WEFT COLORS",
    "WARP SPACING",
    "WEFT SPACING",
    "WARP THICKNESS",
    "WEFT THICKNESS",
];

/// Texts of which a design keeps title and notes.
const TEXTS: [&str; 2] = ["TEXT", "NOTES"];

pub(super) fn known(name: &str) -> bool {
    OWN.iter().chain(&TEXTS).any(|own| same(own, name))
}

/// The sections of one file, by name.
pub(super) struct File<'t> {
    pub name: &'t str,
    sections: Vec<Section<'t>>,
}

impl<'t> File<'t> {
    /// All sections of a name, in order: real files repeat them.
    pub fn all(&self, name: &'static str) -> impl Iterator<Item = &Section<'t>> {
        self.sections
            .iter()
            .filter(move |section| section.line > 0 && same(section.name, name))
    }

    /// The last value of a key in a section of this name, with its line.
    pub fn value(&self, name: &'static str, key: &str) -> Option<(u32, String)> {
        self.all(name)
            .filter_map(|section| section.value(key))
            .last()
            .map(|(line, value)| (line, value.into_owned()))
    }

    /// The first line of the first section of this name.
    pub fn line_of(&self, name: &'static str) -> Option<u32> {
        self.all(name).next().map(|section| section.line)
    }

    /// A count: whole, not negative; missing or empty is `None`.
    fn count(&self, name: &'static str, key: &str, most: u32) -> Result<Option<u32>, WifError> {
        let Some((line, value)) = self.value(name, key) else {
            return Ok(None);
        };
        let value = bare(&value);
        if value.is_empty() {
            return Ok(None);
        }
        match value.parse::<u32>() {
            Ok(count) if count <= most => Ok(Some(count)),
            _ => Err(WifError::at(
                self.name,
                line,
                format!(
                    "expected {key} in [{name}] to be a whole number up to {most}, found \"{}\"",
                    shorten(value)
                ),
                "correct the number",
            )),
        }
    }
}

/// Reads a WIF. `name` is the file's name, for messages and as the name of a design
/// without a title.
///
/// # Errors
/// [`WifError`]: one line with the file, the line, what was expected and what to do.
pub fn read(bytes: &[u8], name: &str) -> Result<Imported, WifError> {
    read_with(bytes, name, &LoadOptions::default())
}

/// As [`read`], with a sett or a yarn family that the file cannot know.
///
/// # Errors
/// As [`read`].
pub fn read_with(bytes: &[u8], name: &str, options: &LoadOptions) -> Result<Imported, WifError> {
    let mut warnings = Warnings::default();
    let text = decode(bytes, &mut warnings);
    let file = File {
        name,
        sections: text::sections(&text, name, known)?,
    };
    if !file.sections.iter().any(|section| known(section.name)) {
        let problem = "expected a WIF with sections like [WEAVING] and [THREADING], found none";
        return Err(WifError::whole(name, problem, "choose a .wif file"));
    }
    check_shape(&file, &mut warnings);
    name_unfollowed(&file, &mut warnings);
    let (draft, zero_based) = read_draft(&file, &mut warnings)?;
    let active = Active::of(&draft);
    let palette = colours::Palette::read(&file, &mut warnings)?;
    let base = u32::from(!zero_based);
    let warp = threads::read(&file, Direction::Warp, draft.ends(), base, &mut warnings)?;
    let weft = threads::read(&file, Direction::Weft, draft.picks(), base, &mut warnings)?;
    let [warp_colours, weft_colours] =
        palette.choose((&warp, &active.ends), (&weft, &active.picks), &mut warnings);
    let (title, notes) = read_texts(&file, &mut warnings);
    let sheet = Sheet {
        file: name,
        title,
        notes,
        program: file.value("WIF", "Source Program").map(|found| found.1),
        structure: Structure::Draft(draft),
        warp,
        weft,
        warp_colours,
        weft_colours,
        palette: palette.colours(),
        sections: foreign(&file),
        first_end: FirstEnd::Left,
        first_pick: FirstPick::Bottom,
    };
    let wrong = |misfit: Misfit| WifError::whole(name, misfit.problem, misfit.remedy);
    sheet.design(options, warnings).map_err(wrong)
}

/// Warns about what is odd in the file's shape but does no harm.
fn check_shape(file: &File<'_>, warnings: &mut Warnings) {
    if let Some(before) = file.sections.first()
        && let Some(entry) = before.entries(false).next()
    {
        let what = "text before the first section is ignored";
        warnings.at(entry.line, what);
    }
    if file.all("WIF").next().is_none() {
        warnings.whole("there is no [WIF] section; read as WIF 1.1 all the same");
    }
    for own in OWN.iter().chain(&TEXTS) {
        if let Some(again) = file.all(own).nth(1) {
            let what = format!("[{own}] stands there again; later lines count");
            warnings.at(again.line, what);
        }
    }
    for section in &file.sections {
        if section.line > 0 && OWN.iter().any(|own| same(own, section.name)) {
            for entry in section.entries(true).filter(|entry| entry.value.is_none()) {
                if warnings.flooded() {
                    continue;
                }
                let what = format!("\"{}\" has no \"=\" and is ignored", shorten(entry.key));
                warnings.at(entry.line, what);
            }
        }
    }
}

/// Sections that a design has no place for.
fn foreign(file: &File<'_>) -> Vec<ForeignSection> {
    file.sections
        .iter()
        .filter(|section| section.line > 0 && !known(section.name))
        .map(|section| ForeignSection {
            name: section.name.to_owned(),
            text: section.verbatim(),
        })
        .collect()
}

/// Title and notes; addresses are left behind.
fn read_texts(file: &File<'_>, warnings: &mut Warnings) -> (Option<String>, String) {
    let title = file
        .value("TEXT", "Title")
        .map(|(_, title)| without_path(&title))
        .filter(|title| !title.is_empty());
    for contact in ["Author", "Address", "EMail", "Telephone", "FAX"] {
        if let Some((line, value)) = file.value("TEXT", contact)
            && !value.is_empty()
        {
            warnings.at(line, format!("{contact} is personal and not kept"));
        }
    }
    (title, read_notes(file, warnings))
}

/// More lines of notes than anybody writes.
const MAX_NOTES: usize = 10_000;

/// The notes in the order of their numbers.
fn read_notes(file: &File<'_>, warnings: &mut Warnings) -> String {
    let mut lines: BTreeMap<u32, Cow<'_, str>> = BTreeMap::new();
    for section in file.all("NOTES") {
        for entry in section.entries(false) {
            let (Ok(place), Some(note)) = (entry.key.parse(), entry.value) else {
                continue;
            };
            if lines.len() >= MAX_NOTES && !lines.contains_key(&place) {
                let what = format!("notes beyond {MAX_NOTES} lines are left out");
                warnings.at(entry.line, what);
                break;
            }
            lines.insert(place, note);
        }
    }
    let mut notes = String::new();
    for line in lines.values() {
        notes.push_str(line);
        notes.push('\n');
    }
    notes.truncate(notes.trim_end().len());
    notes
}

/// A list section as it stands: for each thread named, its members.
struct Rows {
    /// By thread as written: line, and where its members start and end.
    rows: BTreeMap<u32, (u32, u32, u32)>,
    members: Vec<u16>,
}

impl Rows {
    fn read(
        file: &File<'_>,
        name: &'static str,
        warnings: &mut Warnings,
    ) -> Result<Self, WifError> {
        // As many members as separators, at most: one allocation of the right size.
        let separators = |section: &Section<'_>| {
            let marks = section.body.bytes().filter(|byte| b"=,".contains(byte));
            marks.count()
        };
        let mut found = Self {
            rows: BTreeMap::new(),
            members: Vec::with_capacity(file.all(name).map(separators).sum()),
        };
        for section in file.all(name) {
            for entry in section.entries(true) {
                let Some(value) = &entry.value else {
                    continue;
                };
                let thread = bare(entry.key).parse::<u32>().ok();
                let Some(thread) = thread.filter(|&thread| thread <= MAX_THREADS) else {
                    let what = format!("\"{}\" in [{name}] is no thread", shorten(entry.key));
                    warnings.at(entry.line, format!("{what}; ignored"));
                    continue;
                };
                let from = found.members.len() as u32;
                found.read_members(file.name, name, entry.line, bare(value))?;
                let to = found.members.len() as u32;
                let again = found.rows.insert(thread, (entry.line, from, to)).is_some();
                if again && !warnings.flooded() {
                    let what = format!("thread {thread} in [{name}] stands there again");
                    warnings.at(entry.line, format!("{what}; the later line counts"));
                }
            }
        }
        Ok(found)
    }

    fn read_members(
        &mut self,
        file: &str,
        name: &str,
        line: u32,
        list: &str,
    ) -> Result<(), WifError> {
        for member in list.split(',').map(str::trim) {
            if member.is_empty() {
                continue;
            }
            let Ok(member) = member.parse::<u16>() else {
                let problem = format!(
                    "expected numbers up to {MAX_SHAFTS} separated by commas in [{name}], \
                     found \"{}\"",
                    shorten(member)
                );
                return Err(WifError::at(file, line, problem, "correct the list"));
            };
            self.members.push(member);
        }
        Ok(())
    }

    fn members(&self, &(_, from, to): &(u32, u32, u32)) -> &[u16] {
        &self.members[from as usize..to as usize]
    }

    fn first_thread(&self) -> Option<u32> {
        self.rows.keys().next().copied()
    }

    fn largest_thread(&self) -> u32 {
        self.rows.keys().next_back().copied().unwrap_or(0)
    }

    fn largest_member(&self) -> u32 {
        let most = self.rows.values().flat_map(|row| self.members(row)).max();
        most.map_or(0, |&member| u32::from(member))
    }

    /// Whether any line names a member other than 0.
    fn says_something(&self) -> bool {
        let mut all = self.rows.values().flat_map(|row| self.members(row));
        all.any(|&member| member > 0)
    }

    /// `threads` sets counted from 0, from rows and members counted from `base` (0 in a
    /// file that counts from 1 means none).
    fn ties(&self, name: &str, threads: u32, base: u32, warnings: &mut Warnings) -> Ties {
        let mut ties = Ties::with_room(threads as usize, self.members.len());
        let mut set = Vec::new();
        let from = base as u16;
        for thread in base..threads + base {
            set.clear();
            if let Some(row) = self.rows.get(&thread) {
                let members = self.members(row).iter();
                set.extend(members.filter_map(|member| member.checked_sub(from)));
            }
            ties.push(&set);
        }
        let outside = |thread: u32| !(base..threads + base).contains(&thread);
        if let Some((&thread, &(line, ..))) = self.rows.iter().find(|row| outside(*row.0)) {
            let what = format!("thread {thread} in [{name}] is beyond the last ({threads})");
            warnings.at(line, format!("{what} and ignored, as are any other such"));
        }
        ties
    }
}

/// Declared threads of a direction, or as many as the lists name.
fn thread_count(
    file: &File<'_>,
    section: &'static str,
    listed: u32,
    list: &'static str,
    warnings: &mut Warnings,
) -> Result<u32, WifError> {
    let declared = file.count(section, "Threads", MAX_THREADS)?;
    match declared {
        Some(threads) if threads > 0 => Ok(threads),
        _ if listed > 0 && listed <= MAX_THREADS => {
            let what = format!("[{section}] declares no Threads; {listed} are listed");
            warnings.whole(format!("{what} in [{list}] and taken"));
            Ok(listed)
        }
        _ => Err(WifError::at(
            file.name,
            file.line_of(section).unwrap_or(1),
            format!("expected Threads=1 to {MAX_THREADS} in [{section}], found none"),
            format!("say how many threads there are, or list them in [{list}]"),
        )),
    }
}

/// The draft, and whether the file counts from 0.
fn read_draft(file: &File<'_>, warnings: &mut Warnings) -> Result<(Draft, bool), WifError> {
    let threading = Rows::read(file, "THREADING", warnings)?;
    let tieup = Rows::read(file, "TIEUP", warnings)?;
    let treadling = Rows::read(file, "TREADLING", warnings)?;
    let plan = Rows::read(file, "LIFTPLAN", warnings)?;
    if threading.rows.is_empty() {
        let problem = "expected a [THREADING] with the shaft of each end, found none";
        return Err(WifError::whole(file.name, problem, "add the threading"));
    }
    let zero_based = threading.first_thread() == Some(0)
        && file.count("WARP", "Threads", MAX_THREADS)? != Some(threading.largest_thread());
    if zero_based {
        warnings.whole("thread 0 is threaded: the file counts threads and shafts from 0");
    }
    let base = u32::from(!zero_based);
    // Highest number used, counted from 1.
    let highest = |number: u32| number + (1 - base);
    let treadled = tieup.says_something() && !treadling.rows.is_empty();
    let lifted = plan.says_something();
    if !treadled && !lifted {
        return Err(no_lifting(file, &tieup, &treadling));
    }
    let picks_listed = highest(treadling.largest_thread().max(plan.largest_thread()));
    let ends_listed = highest(threading.largest_thread());
    let ends = thread_count(file, "WARP", ends_listed, "THREADING", warnings)?;
    let picks = thread_count(file, "WEFT", picks_listed, "TREADLING", warnings)?;
    check_size(u64::from(ends), u64::from(picks)).map_err(|error| {
        let line = file.line_of("WARP").unwrap_or(1);
        WifError::at(file.name, line, error.to_string(), "check Threads")
    })?;
    let shafts_used = [&threading, &tieup, &plan]
        .map(Rows::largest_member)
        .into_iter()
        .max()
        .unwrap_or(0);
    let shafts = at_least(
        file.count("WEAVING", "Shafts", MAX_SHAFTS)?,
        highest(shafts_used),
        "Shafts",
        warnings,
    );
    let threading = threading.ties("THREADING", ends, base, warnings);
    let shed = read_shed(file, warnings);
    let declared = file.count("WEAVING", "Treadles", MAX_SHAFTS)?;
    let make = |lifting, treadles| {
        Draft::new(shafts, treadles, shed, threading.clone(), lifting)
            .map_err(|error| WifError::whole(file.name, error.to_string(), "correct the draft"))
    };
    let by_treadles = if treadled {
        let tied = highest(tieup.largest_thread());
        let treadles = at_least(declared, tied, "Treadles", warnings);
        check_treadles(file, &treadling, treadles, base)?;
        let tieup = tieup.ties("TIEUP", treadles, base, warnings);
        let treadling = treadling.ties("TREADLING", picks, base, warnings);
        Some(make(Lifting::Treadled { tieup, treadling }, treadles)?)
    } else {
        None
    };
    let by_plan = if lifted {
        let plan = plan.ties("LIFTPLAN", picks, base, warnings);
        Some(make(
            Lifting::LiftPlan(plan),
            shafts.max(declared.unwrap_or(0)),
        )?)
    } else {
        None
    };
    let draft = match (by_treadles, by_plan) {
        (Some(treadled), Some(planned)) => choose_lifting(file, treadled, planned, warnings),
        (Some(draft), None) | (None, Some(draft)) => draft,
        (None, None) => return Err(no_lifting(file, &tieup, &treadling)),
    };
    warn_unused_threads(&draft, warnings);
    Ok((draft, zero_based))
}

fn no_lifting(file: &File<'_>, tieup: &Rows, treadling: &Rows) -> WifError {
    let (missing, line) = if !treadling.rows.is_empty() {
        ("a [TIEUP] for the treadles", file.line_of("TREADLING"))
    } else if tieup.says_something() {
        ("a [TREADLING] for the tie-up", file.line_of("TIEUP"))
    } else {
        ("[TIEUP] and [TREADLING], or a [LIFTPLAN]", None)
    };
    WifError {
        file: file.name.to_owned(),
        line,
        problem: format!("expected {missing}, found none"),
        remedy: "add it, or write a [LIFTPLAN]".to_owned(),
    }
}

/// A pressed treadle must be declared or tied up.
fn check_treadles(
    file: &File<'_>,
    treadling: &Rows,
    treadles: u32,
    base: u32,
) -> Result<(), WifError> {
    for row in treadling.rows.values() {
        for &treadle in treadling.members(row) {
            if u32::from(treadle) + (1 - base) > treadles {
                return Err(WifError::at(
                    file.name,
                    row.0,
                    format!("expected treadles up to {treadles}, found treadle {treadle}"),
                    "tie that treadle up in [TIEUP] or correct the number",
                ));
            }
        }
    }
    Ok(())
}

fn read_shed(file: &File<'_>, warnings: &mut Warnings) -> Shed {
    match file.value("WEAVING", "Rising Shed") {
        None => Shed::Rising,
        Some((line, value)) => match boolean(&value) {
            Some(true) => Shed::Rising,
            Some(false) => Shed::Sinking,
            None => {
                let what = format!("Rising Shed=\"{}\" is neither yes nor no", shorten(&value));
                warnings.at(line, format!("{what}; taken as rising"));
                Shed::Rising
            }
        },
    }
}

/// Of a tie-up and a lift plan in one file: silent if they weave the same.
fn choose_lifting(
    file: &File<'_>,
    treadled: Draft,
    planned: Draft,
    warnings: &mut Warnings,
) -> Draft {
    let loom = file.value("WEAVING", "Loom Type");
    if loom.is_some_and(|(_, loom)| same(&loom, "Lift Plan") || same(&loom, "LiftPlan")) {
        return planned;
    }
    let line = file.line_of("LIFTPLAN").unwrap_or(1);
    tieup_or_plan(treadled, &planned, line, warnings)
}
