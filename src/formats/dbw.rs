//! DB-WEAVE .dbw, the text format of a drafting program: reading.
//!
//! The file begins with `@dbw3:file`; sections nest as `\name{ … }`, fields are
//! `key==value`, a `\` at the end of a line continues the value, lines that begin with `;`
//! are comments. Lists are hexadecimal bytes:
//!
//! | field | holds |
//! |---|---|
//! | data/fields/einzug | shaft of each end, 16 bits, low byte first; 0 = none |
//! | data/fields/aufknuepfung | tie-up, a byte each, a row for each shaft |
//! | data/fields/trittfolge/trittfolge | treadling, a byte each, a row for each pick |
//! | data/fields/kettfarben, schussfarben | colour of each end and pick, from 0 |
//! | data/palette | `data2`: red, green, blue, 0; `data`: the same behind 4 other bytes |
//! | view/general | `hebung` 0 = sinking shed; `viewpegplan` 1 = the treadling is a lift plan; `righttoleft`, `toptobottom` 1 = end 1 is at the right, pick 1 at the top |
//!
//! A tie is a byte from 1 to 127; its number is the pattern range it belongs to, and 12
//! is a tie taken away. The grid is of a fixed size: the draft is what is threaded and
//! treadled on it. Sizes in mm are not in the file; the reed is told and not
//! followed, guide lines are not read.

use std::collections::BTreeMap;

use super::encoding::decode;
use super::field_table::Handling::{Honoured, Warned};
use super::field_table::{self, Table};
use super::sheet::text::{lines, shorten};
use super::sheet::threads::Threads;
use super::sheet::{
    Misfit, Place, Sheet, SheetError, StandIns, Warnings, colours, warn_unused_threads,
};
use super::{Imported, LoadOptions};
use crate::design::{
    Direction, Draft, FirstEnd, FirstPick, Lifting, MAX_SHAFTS, Shed, Srgb, Structure, Ties,
    check_size,
};
use crate::limits::DRAFT_THREADS as MAX_THREADS;

/// How every file begins.
const MAGIC: &[u8] = b"@dbw3:file";

/// What a file says of sizes, colours and threads, by the paths of its sections.
pub const FIELDS: Table = Table {
    format: "dbw",
    fields: &[
        field_table::Field::new("data/fields/einzug/data", Honoured, "0100030001000200"),
        field_table::Field::new(
            "data/fields/aufknuepfung/data",
            Honoured,
            "010100000001000001",
        ),
        field_table::Field::new("data/fields/aufknuepfung/sizex", Honoured, "2"),
        field_table::Field::new("data/fields/aufknuepfung/sizey", Honoured, "2"),
        field_table::Field::new(
            "data/fields/trittfolge/trittfolge/data",
            Honoured,
            "010000010000000100",
        ),
        field_table::Field::new("data/fields/trittfolge/trittfolge/sizex", Honoured, "2"),
        field_table::Field::new("data/fields/trittfolge/trittfolge/sizey", Honoured, "2"),
        field_table::Field::new("data/fields/kettfarben/data", Honoured, "01010001"),
        field_table::Field::new("data/fields/schussfarben/data", Honoured, "000001"),
        field_table::Field::new("data/palette/data", Honoured, "000300020a0b0c000d0e0f00"),
        field_table::Field::new("data/palette/data2", Honoured, "0a0b0c000d0e0f00"),
        field_table::Field::new("data/fields/blatteinzug/data", Warned, "00000100"),
        field_table::Field::new("view/general/hebung", Honoured, "0"),
        field_table::Field::new("view/general/viewpegplan", Honoured, "1"),
        field_table::Field::new("view/general/righttoleft", Honoured, "1"),
        field_table::Field::new("view/general/toptobottom", Honoured, "1"),
        field_table::Field::new("view/general/faktor_kette", Warned, "2.0"),
        field_table::Field::new("view/general/faktor_schuss", Warned, "2.0"),
    ],
};

/// The tie that takes a tie away.
const UNTIED: u8 = 12;

/// Sections nest no deeper.
const MAX_DEPTH: usize = 30;

/// The longest name of a section that is looked at, bytes.
const MAX_NAME: usize = 64;

/// Whether bytes are a DB-WEAVE draft.
pub fn recognises(bytes: &[u8]) -> bool {
    bytes
        .strip_prefix(b"\xef\xbb\xbf")
        .unwrap_or(bytes)
        .starts_with(MAGIC)
}

/// Reads a DB-WEAVE draft. `name` is what messages call it.
///
/// # Errors
/// [`SheetError`]: one line with the file, the line, what was expected and what to do.
pub fn read(bytes: &[u8], name: &str, options: &LoadOptions) -> Result<Imported, SheetError> {
    let mut warnings = Warnings::default();
    let text = decode(bytes, &mut warnings);
    let file = File::split(&text, name)?;
    for personal in ["properties/author", "properties/organization"] {
        if let Some(field) = file
            .fields
            .get(personal)
            .filter(|field| !field.value.is_empty())
        {
            warnings.at(field.line, format!("{personal} is personal and not kept"));
        }
    }
    let grid = Grid::read(&file, &mut warnings)?;
    let flag = |key: &str| file.number(key, 1).map(|value| value.unwrap_or(0) == 1);
    let right = flag("view/general/righttoleft")?;
    let top = flag("view/general/toptobottom")?;
    let draft = grid.draft(&file, right, top, &mut warnings)?;
    warn_unused_threads(&draft, &mut warnings);
    let palette = file.palette()?;
    let mut stand_ins = StandIns::default();
    let mut side = |direction, from: usize, threads: u32, reversed| {
        let range = from..from + threads as usize;
        file.colours((direction, &mut stand_ins), &palette, range, reversed)
    };
    let warp_colours = side(Direction::Warp, grid.ends.0, draft.ends(), right)?;
    let weft_colours = side(Direction::Weft, grid.picks.0, draft.picks(), top)?;
    stand_ins.tell("the palette", palette.len(), &mut warnings);
    for factor in ["view/general/faktor_kette", "view/general/faktor_schuss"] {
        let stated = file.fields.get(factor);
        if let Some(field) = stated.filter(|field| field.value.trim().parse() != Ok(1.0f32)) {
            let what = "states only how wide threads are drawn, no sett";
            warnings.at(field.line, format!("{factor} {what}; give one"));
        }
    }
    if let Some(field) = file.fields.get(REED) {
        // Dents alternate; a reed of one end a dent says nothing.
        let dents = field.bytes(name)?;
        if dents.iter().any(|&dent| dent != 0) {
            let what = "says how the ends lie in the reed; it is not read";
            warnings.at(field.line, format!("{REED} {what}"));
        }
    }
    let notes = file.fields.get("properties/remarks");
    let sheet = Sheet {
        file: name,
        title: None,
        notes: notes.map_or_else(String::new, |field| field.value.to_owned()),
        program: Some("DB-WEAVE".to_owned()),
        warp: Threads::listed(draft.ends() as usize, None, Vec::new()),
        weft: Threads::listed(draft.picks() as usize, None, Vec::new()),
        structure: Structure::Draft(draft),
        warp_colours,
        weft_colours,
        palette,
        sections: Vec::new(),
        first_end: if right {
            FirstEnd::Right
        } else {
            FirstEnd::Left
        },
        first_pick: if top {
            FirstPick::Top
        } else {
            FirstPick::Bottom
        },
    };
    let wrong = |misfit: Misfit| SheetError::whole(name, misfit.problem, misfit.remedy);
    sheet.design(options, warnings).map_err(wrong)
}

/// One `key==value`, continued lines included.
#[derive(Clone, Copy)]
struct Field<'t> {
    line: u32,
    value: &'t str,
}

impl<'t> Field<'t> {
    /// The hexadecimal bytes of a value, over its continued lines.
    fn bytes(&self, file: &str) -> Result<Vec<u8>, SheetError> {
        let mut found = Vec::with_capacity(self.value.len() / 2);
        let mut high = None;
        for (line, row) in (self.line..).zip(lines(self.value)) {
            for symbol in row.chars().filter(|symbol| !symbol.is_whitespace()) {
                match (symbol.to_digit(16), high) {
                    (Some(digit), None) => high = Some(digit as u8),
                    (Some(digit), Some(first)) => {
                        found.push(first << 4 | digit as u8);
                        high = None;
                    }
                    (None, _) if symbol == '\\' => {}
                    (None, _) => {
                        let problem =
                            format!("expected hexadecimal digits, found \"{}\"", shorten(row));
                        let remedy = "the list is damaged: get a whole file";
                        return Err(SheetError::at(file, Place::Line(line), problem, remedy));
                    }
                }
            }
        }
        Ok(found)
    }
}

/// The fields this reader knows, by their path.
struct File<'t> {
    name: &'t str,
    fields: BTreeMap<&'static str, Field<'t>>,
}

/// How the ends lie in the reed.
const REED: &str = "data/fields/blatteinzug/data";

/// The paths of these fields; all others are passed over.
const KNOWN: [&str; 25] = [
    "data/fields/aufknuepfung/data",
    "data/fields/aufknuepfung/sizex",
    "data/fields/aufknuepfung/sizey",
    "data/fields/blatteinzug/data",
    "data/fields/einzug/data",
    "data/fields/kettfarben/data",
    "data/fields/schussfarben/data",
    "data/fields/trittfolge/trittfolge/data",
    "data/fields/trittfolge/trittfolge/sizex",
    "data/fields/trittfolge/trittfolge/sizey",
    "data/palette/data",
    "data/palette/data2",
    "data/size/maxx1",
    "data/size/maxx2",
    "data/size/maxy1",
    "data/size/maxy2",
    "properties/author",
    "properties/organization",
    "properties/remarks",
    "view/general/faktor_kette",
    "view/general/faktor_schuss",
    "view/general/hebung",
    "view/general/righttoleft",
    "view/general/toptobottom",
    "view/general/viewpegplan",
];

impl<'t> File<'t> {
    fn split(text: &'t str, name: &'t str) -> Result<Self, SheetError> {
        let start_of = |line: &str| line.as_ptr() as usize - text.as_ptr() as usize;
        let mut file = Self {
            name,
            fields: BTreeMap::new(),
        };
        let mut open: Vec<&str> = Vec::new();
        let mut here = String::new();
        // Where a value began that goes on over lines, if it is one that is wanted.
        let mut unfinished: Option<(Option<&'static str>, u32, usize)> = None;
        for (number, line) in (1..).zip(lines(text)) {
            let goes_on = line.ends_with('\\');
            let end = start_of(line) + line.len();
            if let Some((path, first, from)) = unfinished {
                if !goes_on {
                    file.keep(path, first, &text[from..end]);
                    unfinished = None;
                }
                continue;
            }
            let entry = line.trim_start();
            if entry.starts_with(';') {
                continue;
            }
            if let Some((key, value)) = entry.split_once("==") {
                let path = known_path(&here, key.trim());
                if goes_on {
                    unfinished = Some((path, number, start_of(value)));
                } else {
                    file.keep(path, number, value);
                }
            } else if let Some(section) = entry.strip_prefix('\\') {
                if open.len() >= MAX_DEPTH {
                    let problem = format!("expected sections nested at most {MAX_DEPTH} deep");
                    return Err(file.at(number, problem, "this is not a draft"));
                }
                let section = section.trim_end().trim_end_matches('{').trim_end();
                // Long names are nobody's, and copying them for each section takes time.
                open.push(if section.len() <= MAX_NAME {
                    section
                } else {
                    "?"
                });
                here = open.join("/");
            } else if entry.starts_with('}') {
                open.pop();
                here = open.join("/");
            }
        }
        if unfinished.is_some() || !open.is_empty() {
            let problem = "expected the sections to be closed, found the end of the file";
            return Err(SheetError::whole(
                name,
                problem,
                "it is cut off: get a whole one",
            ));
        }
        Ok(file)
    }

    /// Keeps a wanted field; the first of a path counts.
    fn keep(&mut self, path: Option<&'static str>, line: u32, value: &'t str) {
        if let Some(path) = path {
            self.fields.entry(path).or_insert(Field { line, value });
        }
    }

    fn at(&self, line: u32, problem: impl Into<String>, remedy: impl Into<String>) -> SheetError {
        SheetError::at(self.name, Place::Line(line), problem, remedy)
    }

    fn need(&self, path: &'static str, what: &str) -> Result<Field<'t>, SheetError> {
        self.fields.get(path).copied().ok_or_else(|| {
            let problem = format!("expected {what} in {path}, found none");
            SheetError::whole(self.name, problem, "add it or get a whole file")
        })
    }

    fn number(&self, path: &str, most: u32) -> Result<Option<u32>, SheetError> {
        let Some(field) = self.fields.get(path) else {
            return Ok(None);
        };
        match field.value.trim().parse::<u32>() {
            Ok(number) if number <= most => Ok(Some(number)),
            _ => {
                let value = shorten(field.value.trim());
                let problem = format!("expected {path} from 0 to {most}, found \"{value}\"");
                Err(self.at(field.line, problem, "correct the number"))
            }
        }
    }

    /// A list of rows of one byte a cell: its width, its height and its cells.
    fn rows(
        &self,
        paths: [&'static str; 3],
        usual: [&'static str; 2],
        most: [u32; 2],
        what: &str,
    ) -> Result<(usize, usize, Vec<u8>), SheetError> {
        let field = self.need(paths[0], what)?;
        let size = |which: usize| -> Result<usize, SheetError> {
            let stated = match self.number(paths[which + 1], most[which])? {
                Some(size) => Some(size),
                None => self.number(usual[which], most[which])?,
            };
            let problem = || format!("expected the size of {what} in {}", paths[which + 1]);
            let size = stated.filter(|&size| size > 0);
            size.map(|size| size as usize)
                .ok_or_else(|| self.at(field.line, problem(), "say how large it is"))
        };
        let (width, height) = (size(0)?, size(1)?);
        let cells = field.bytes(self.name)?;
        if cells.len() < width * height {
            let problem = format!(
                "expected {width} × {height} bytes of {what}, found {}",
                cells.len()
            );
            return Err(self.at(field.line, problem, "the list is cut off: get a whole file"));
        }
        Ok((width, height, cells))
    }

    fn palette(&self) -> Result<Vec<Srgb>, SheetError> {
        let (field, skipped) = match self.fields.get("data/palette/data2") {
            Some(field) => (field, 0),
            None => match self.fields.get("data/palette/data") {
                // Version and count of a Windows palette.
                Some(field) => (field, 4),
                None => return Ok(Vec::new()),
            },
        };
        let bytes = field.bytes(self.name)?;
        let cells = bytes.get(skipped..).unwrap_or(&[]).chunks_exact(4);
        Ok(cells
            .take(256)
            .map(|rgb| Srgb(rgb[0], rgb[1], rgb[2]))
            .collect())
    }

    /// Number and colour of the threads in `range` of a direction's list of colours.
    fn colours(
        &self,
        side: (Direction, &mut StandIns),
        palette: &[Srgb],
        range: std::ops::Range<usize>,
        reversed: bool,
    ) -> Result<Vec<(u32, Srgb)>, SheetError> {
        let path = match side.0 {
            Direction::Warp => "data/fields/kettfarben/data",
            Direction::Weft => "data/fields/schussfarben/data",
        };
        let bytes = match self.fields.get(path) {
            Some(field) => field.bytes(self.name)?,
            None => Vec::new(),
        };
        let line = self.fields.get(path).map(|field| field.line);
        let listed = bytes.get(range.start.min(bytes.len())..).unwrap_or(&[]);
        let numbers = listed.iter().map(|&number| (line, number));
        let usual = side.0 as i64 + 1;
        let mut chosen = colours(palette, numbers, range.len(), usual, side);
        if reversed {
            chosen.reverse();
        }
        Ok(chosen)
    }
}

/// The wanted path of a key in the section `here`.
fn known_path(here: &str, key: &str) -> Option<&'static str> {
    KNOWN.into_iter().find(|path| {
        let below = path.strip_prefix(here);
        below.and_then(|below| below.strip_prefix('/')) == Some(key)
    })
}

/// What stands on the program's grid, and which part of it is the draft.
struct Grid {
    /// Shaft of each end, from 1; 0 = none.
    threading: Vec<u16>,
    /// Treadles and shafts of the tie-up, and its cells.
    tieup: (usize, usize, Vec<u8>),
    /// Treadles (shafts for a lift plan) and picks, and the cells.
    treadling: (usize, usize, Vec<u8>),
    plan: bool,
    /// First end and how many there are.
    ends: (usize, usize),
    /// First pick and how many there are.
    picks: (usize, usize),
}

fn is_tied(cell: u8) -> bool {
    (1..128).contains(&cell) && cell != UNTIED
}

impl Grid {
    fn read(file: &File<'_>, warnings: &mut Warnings) -> Result<Self, SheetError> {
        let field = file.need("data/fields/einzug/data", "the threading")?;
        let bytes = field.bytes(file.name)?;
        let threading: Vec<u16> = bytes
            .chunks_exact(2)
            .map(|pair| u16::from_le_bytes([pair[0], pair[1]]))
            // Negative shafts stand for none.
            .map(|shaft| if shaft < 1 << 15 { shaft } else { 0 })
            .collect();
        let plan = file.number("view/general/viewpegplan", 1)? == Some(1);
        let treadling = file.rows(
            [
                "data/fields/trittfolge/trittfolge/data",
                "data/fields/trittfolge/trittfolge/sizex",
                "data/fields/trittfolge/trittfolge/sizey",
            ],
            ["data/size/maxx2", "data/size/maxy2"],
            [MAX_SHAFTS, MAX_THREADS],
            "the treadling",
        )?;
        let tieup = if plan {
            (1, 1, vec![0])
        } else {
            file.rows(
                [
                    "data/fields/aufknuepfung/data",
                    "data/fields/aufknuepfung/sizex",
                    "data/fields/aufknuepfung/sizey",
                ],
                ["data/size/maxx2", "data/size/maxy1"],
                [MAX_SHAFTS, MAX_SHAFTS],
                "the tie-up",
            )?
        };
        let used = |flags: &mut dyn Iterator<Item = bool>, what: &str| {
            let (mut first, mut last, mut all) = (None, 0, 0);
            for (place, used) in flags.enumerate() {
                all = place + 1;
                if used {
                    first.get_or_insert(place);
                    last = place;
                }
            }
            let Some(first) = first else {
                let problem = format!("expected {what}, found an empty grid");
                return Err(SheetError::whole(
                    file.name,
                    problem,
                    "draw the draft first",
                ));
            };
            Ok((first, last + 1 - first, all))
        };
        let ends = used(&mut threading.iter().map(|&shaft| shaft > 0), "a threading")?;
        let (width, height, cells) = &treadling;
        let mut rows = cells.chunks_exact(*width).take(*height);
        let picks = used(
            &mut rows.by_ref().map(|row| row.iter().copied().any(is_tied)),
            "a treadling",
        )?;
        if (ends.1, picks.1) != (ends.2, picks.2) {
            warnings.whole(format!(
                "ends {} to {} and picks {} to {} of a grid of {} × {} are threaded and \
                 treadled; the rest of the grid is left out",
                ends.0 + 1,
                ends.0 + ends.1,
                picks.0 + 1,
                picks.0 + picks.1,
                ends.2,
                picks.2
            ));
        }
        check_size(ends.1 as u64, picks.1 as u64)
            .ok()
            .filter(|()| ends.1 <= MAX_THREADS as usize)
            .ok_or_else(|| {
                let problem = format!("{} ends × {} picks are too many", ends.1, picks.1);
                file.at(field.line, problem, "cut the design into parts")
            })?;
        Ok(Self {
            threading,
            tieup,
            treadling,
            plan,
            ends: (ends.0, ends.1),
            picks: (picks.0, picks.1),
        })
    }

    fn draft(
        &self,
        file: &File<'_>,
        right: bool,
        top: bool,
        warnings: &mut Warnings,
    ) -> Result<Draft, SheetError> {
        let ends = &self.threading[self.ends.0..self.ends.0 + self.ends.1];
        let mut threading = Ties::with_room(ends.len(), ends.len());
        for place in 0..ends.len() {
            let shaft = ends[if right { ends.len() - 1 - place } else { place }];
            match shaft.checked_sub(1) {
                Some(shaft) => threading.push(&[shaft]),
                None => threading.push(&[]),
            }
        }
        let hebung = file.number("view/general/hebung", 1)?;
        if hebung.is_none() {
            warnings.whole("view/general/hebung is missing: a rising shed is taken");
        }
        let sinking = hebung == Some(0);
        let (width, _, cells) = &self.treadling;
        let pick_cells = |pick: usize| {
            let pick = if top { self.picks.1 - 1 - pick } else { pick };
            let from = (self.picks.0 + pick) * width;
            &cells[from..from + width]
        };
        let lifts = sets(self.picks.1, pick_cells);
        let lifting = if self.plan {
            Lifting::LiftPlan(lifts)
        } else {
            let (treadles, shafts, cells) = &self.tieup;
            let treadles = (*treadles).min(lifts.bound() as usize);
            let tieup = columns(cells, self.tieup.0, *shafts, treadles);
            if lifts.bound() as usize > tieup.len() {
                let (most, found) = (tieup.len(), lifts.bound());
                let problem = format!("expected treadles up to {most}, found treadle {found}");
                return Err(SheetError::whole(file.name, problem, "tie that treadle up"));
            }
            if cells.contains(&UNTIED) {
                warnings.whole("ties taken away by hand (range 12) count as no tie");
            }
            Lifting::Treadled {
                tieup,
                treadling: lifts,
            }
        };
        let (named, treadles) = match &lifting {
            Lifting::LiftPlan(plan) => (plan.bound(), plan.bound()),
            Lifting::Treadled { tieup, .. } => (tieup.bound(), tieup.len() as u32),
        };
        let shafts = threading.bound().max(named);
        let shed = if sinking { Shed::Sinking } else { Shed::Rising };
        Draft::new(shafts, treadles, shed, threading, lifting)
            .map_err(|error| SheetError::whole(file.name, error.to_string(), "correct the draft"))
    }
}

/// The tied cells of each of `count` rows.
fn sets<'c>(count: usize, row: impl Fn(usize) -> &'c [u8]) -> Ties {
    let all = |index| row(index).iter().filter(|&&cell| is_tied(cell)).count();
    let mut ties = Ties::with_room(count, (0..count).map(all).sum());
    let mut set = Vec::new();
    for index in 0..count {
        set.clear();
        let tied = row(index)
            .iter()
            .enumerate()
            .filter(|(_, cell)| is_tied(**cell));
        set.extend(tied.map(|(place, _)| place as u16));
        ties.push(&set);
    }
    ties
}

/// The tied cells of each of the first `count` columns of `width` × `height` cells.
fn columns(cells: &[u8], width: usize, height: usize, count: usize) -> Ties {
    let mut ties = Ties::default();
    let mut set = Vec::new();
    for column in 0..count {
        set.clear();
        let tied = (0..height).filter(|row| is_tied(cells[row * width + column]));
        set.extend(tied.map(|row| row as u16));
        ties.push(&set);
    }
    ties
}
