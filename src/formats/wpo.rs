//! WeavePoint .wpo, the binary format of a drafting program: reading.
//!
//! | bytes | what |
//! |---|---|
//! | 0, 1 | 123, version (known up to 7) |
//! | 2 | 100 lift plan, 101 one treadle a pick, 102 several |
//! | 4, 5 | shafts, treadles |
//! | 7 | 0 = rising shed |
//! | 9, 10 | ends and picks per inch |
//! | 13–16 | ends and picks of the sheet, big-endian |
//! | 24 … | threading, warp colours, weft colours: a count (big-endian) and as many bytes |
//! | … | tie-up (a mask for each treadle), then treadling or lift plan with a count |
//! | … | 66 bytes for translations, then a count of colours and their channels |
//!
//! Masks are little-endian, bit 0 = shaft or treadle 1; colours count from 0 and have 64
//! steps a channel before version 4. The sheet is as large as the program's grid (1200 ×
//! 1200); the draft is what is threaded and treadled on it, and only that is read.
//! Spacing and thickness of single threads and notes lie behind the palette in a form
//! that is not known, and are not read.

use super::field_table::Handling::{Honoured, Warned};
use super::field_table::{Field, Table};
use super::sheet::threads::Threads;
use super::sheet::{
    Misfit, Place, Sheet, SheetError, StandIns, Warnings, at_least, colours, warn_unused_threads,
};
use super::{Imported, LoadOptions};
use crate::design::{
    Direction, Draft, FirstEnd, FirstPick, Lifting, Shed, Srgb, Structure, Ties, check_size,
};

/// The latest version whose layout is known.
const KNOWN_VERSION: u8 = 7;

/// What a file says of sizes, colours and threads; it has no names for it.
pub const FIELDS: Table = Table {
    format: "wpo",
    fields: &[
        Field::new("version", Honoured, "3"),
        Field::new("kind of lifting", Honoured, "100"),
        Field::new("shafts", Honoured, "5"),
        Field::new("treadles", Honoured, "5"),
        Field::new("rising shed", Honoured, "1"),
        Field::new("ends per inch", Honoured, "24"),
        Field::new("picks per inch", Honoured, "20"),
        Field::new("sheet", Warned, "9"),
        Field::new("threading", Honoured, "4"),
        Field::new("warp colours", Honoured, "1"),
        Field::new("weft colours", Honoured, "1"),
        Field::new("tie-up", Honoured, "8"),
        Field::new("treadling", Honoured, "4"),
        Field::new("palette", Honoured, "7"),
        Field::new("spacing and thickness of single threads", Warned, "1"),
    ],
};

/// Whether bytes are a WeavePoint draft; JSON also begins with `{`, but never so.
pub fn recognises(bytes: &[u8]) -> bool {
    matches!(bytes, [123, version, 100..=102, ..] if *version < b'\t')
}

/// Reads a WeavePoint draft. `name` is what messages call it.
///
/// # Errors
/// [`SheetError`]: one line with the file, the byte, what was expected and what to do.
pub fn read(bytes: &[u8], name: &str, options: &LoadOptions) -> Result<Imported, SheetError> {
    let mut file = File { bytes, name, at: 0 };
    let mut warnings = Warnings::default();
    let head = file.take(24, "a header of 24 bytes")?;
    if !recognises(head) {
        let problem = "expected a WeavePoint draft";
        return Err(file.error(0, problem, "choose another file"));
    }
    let (version, kind, shafts, treadles) = (head[1], head[2], head[4], head[5]);
    let shed = if head[7] == 0 {
        Shed::Rising
    } else {
        Shed::Sinking
    };
    let (epi, ppi) = (head[9], head[10]);
    let sheet_size = [13, 15].map(|at| u16::from_be_bytes([head[at], head[at + 1]]));
    if version > KNOWN_VERSION {
        warnings.whole(format!(
            "version {version} is later than {KNOWN_VERSION}: compare the drawdown"
        ));
    }
    let threading = file.list("the threading")?;
    let warp_numbers = file.list("the warp colours")?;
    let weft_numbers = file.list("the weft colours")?;
    let (lifting, used) = file.lifting(kind, shafts, treadles, &mut warnings)?;
    let mut ends = Ties::with_room(threading.len(), threading.len());
    for &shaft in threading {
        match shaft.checked_sub(1) {
            Some(shaft) => ends.push(&[u16::from(shaft)]),
            None => ends.push(&[]),
        }
    }
    let picks = match &lifting {
        Lifting::LiftPlan(lifts)
        | Lifting::Treadled {
            treadling: lifts, ..
        } => lifts.len(),
    };
    check_size(ends.len() as u64, picks as u64)
        .map_err(|error| file.error(24, error.to_string(), "thread and treadle the draft"))?;
    if (ends.len(), picks) != (usize::from(sheet_size[0]), usize::from(sheet_size[1])) {
        let [across, along] = sheet_size;
        warnings.whole(format!(
            "{} ends and {picks} picks of a sheet of {across} × {along} are threaded and \
             treadled; the rest of the sheet is left out",
            ends.len()
        ));
    }
    let declared = Some(u32::from(shafts));
    let shafts = at_least(declared, ends.bound().max(used), "shafts", &mut warnings);
    let treadles = match &lifting {
        Lifting::LiftPlan(_) => shafts.max(u32::from(treadles)),
        Lifting::Treadled { .. } => u32::from(treadles),
    };
    let draft = Draft::new(shafts, treadles, shed, ends, lifting)
        .map_err(|error| file.error(24, error.to_string(), "correct the draft"))?;
    warn_unused_threads(&draft, &mut warnings);
    file.take(66, "66 bytes for translations")?;
    let palette = file.palette(version, &mut warnings)?;
    let behind = bytes.len() - file.at;
    if behind > 0 {
        warnings.whole(format!(
            "{behind} bytes behind the palette are not read: spacing and thickness of single \
             threads, and notes, stand there"
        ));
    }
    let mut stand_ins = StandIns::default();
    let mut chosen = |numbers: &[u8], threads: u32, direction: Direction| {
        let own = direction as i64 + 1;
        let usual = numbers.last().map_or(own, |&last| i64::from(last) + 1);
        let listed = numbers.iter().map(|&number| (None, number));
        let side = (direction, &mut stand_ins);
        colours(&palette, listed, threads as usize, usual, side)
    };
    let warp_colours = chosen(warp_numbers, draft.ends(), Direction::Warp);
    let weft_colours = chosen(weft_numbers, draft.picks(), Direction::Weft);
    stand_ins.tell("the palette", palette.len(), &mut warnings);
    let spaced = |count: u32, per_inch: u8| {
        let spacing = (per_inch > 0).then(|| ("Inches", 1.0 / f32::from(per_inch)));
        Threads::listed(count as usize, spacing, Vec::new())
    };
    let sheet = Sheet {
        file: name,
        title: None,
        notes: String::new(),
        program: Some("WeavePoint".to_owned()),
        warp: spaced(draft.ends(), epi),
        weft: spaced(draft.picks(), ppi),
        structure: Structure::Draft(draft),
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

/// The bytes not yet read.
struct File<'b> {
    bytes: &'b [u8],
    name: &'b str,
    at: usize,
}

impl<'b> File<'b> {
    fn error(
        &self,
        byte: usize,
        problem: impl Into<String>,
        remedy: impl Into<String>,
    ) -> SheetError {
        SheetError::at(self.name, Place::Byte(byte), problem, remedy)
    }

    fn take(&mut self, count: usize, what: &str) -> Result<&'b [u8], SheetError> {
        match self.bytes.get(self.at..self.at + count) {
            Some(taken) => {
                self.at += count;
                Ok(taken)
            }
            None => Err(self.error(
                self.at,
                format!(
                    "expected {what} ({count} bytes), found {}",
                    self.bytes.len() - self.at
                ),
                "the file is cut off: get a whole one",
            )),
        }
    }

    fn count(&mut self, what: &str) -> Result<usize, SheetError> {
        let count = self.take(2, &format!("the count of {what}"))?;
        Ok(usize::from(u16::from_be_bytes([count[0], count[1]])))
    }

    /// A count and as many bytes.
    fn list(&mut self, what: &str) -> Result<&'b [u8], SheetError> {
        let count = self.count(what)?;
        self.take(count, what)
    }

    /// `count` masks of `bits` bits each.
    fn masks(
        &mut self,
        count: usize,
        bits: u8,
        what: &str,
        warnings: &mut Warnings,
    ) -> Result<Ties, SheetError> {
        if bits == 0 {
            let problem = format!("expected at least one shaft or treadle for {what}");
            return Err(self.error(4, problem, "the file is damaged: get a whole one"));
        }
        let width = usize::from(bits).div_ceil(8);
        let masks = self.take(count * width, what)?;
        let all = masks.iter().map(|byte| byte.count_ones() as usize).sum();
        let mut ties = Ties::with_room(count, all);
        let mut set = Vec::new();
        let mut stray = false;
        for mask in masks.chunks_exact(width) {
            set.clear();
            for bit in 0..width * 8 {
                if mask[bit / 8] >> (bit % 8) & 1 == 1 {
                    if bit < usize::from(bits) {
                        set.push(bit as u16);
                    } else {
                        stray = true;
                    }
                }
            }
            ties.push(&set);
        }
        if stray {
            warnings.whole(format!(
                "{what} names more than the {bits} there are; ignored"
            ));
        }
        Ok(ties)
    }

    /// The tie-up and treadling or the lift plan, and how many shafts it names.
    fn lifting(
        &mut self,
        kind: u8,
        shafts: u8,
        treadles: u8,
        warnings: &mut Warnings,
    ) -> Result<(Lifting, u32), SheetError> {
        if kind == 100 {
            let picks = self.count("the lift plan")?;
            let plan = self.masks(picks, shafts, "the lift plan", warnings)?;
            let used = plan.bound();
            return Ok((Lifting::LiftPlan(plan), used));
        }
        let tieup = self.masks(usize::from(treadles), shafts, "the tie-up", warnings)?;
        let treadling = if kind == 102 {
            let picks = self.count("the treadling")?;
            self.masks(picks, treadles, "the treadling", warnings)?
        } else {
            let from = self.at + 2;
            let list = self.list("the treadling")?;
            let mut treadling = Ties::with_room(list.len(), list.len());
            for (pick, &treadle) in list.iter().enumerate() {
                if treadle > treadles {
                    let problem =
                        format!("expected treadles up to {treadles}, found treadle {treadle}");
                    return Err(self.error(from + pick, problem, "tie that treadle up"));
                }
                match treadle.checked_sub(1) {
                    Some(treadle) => treadling.push(&[u16::from(treadle)]),
                    None => treadling.push(&[]),
                }
            }
            treadling
        };
        let used = tieup.bound();
        Ok((Lifting::Treadled { tieup, treadling }, used))
    }

    fn palette(&mut self, version: u8, warnings: &mut Warnings) -> Result<Vec<Srgb>, SheetError> {
        let count = self.take(1, "the count of colours")?[0];
        let channels = self.take(3 * usize::from(count), "the palette")?;
        let most = if version < 4 { 63u8 } else { 255 };
        let outside = channels
            .chunks_exact(3)
            .filter(|rgb| rgb.iter().any(|&value| value > most));
        match outside.count() {
            0 => {}
            1 => warnings.whole(format!("a colour lies outside 0 to {most}: cut off")),
            count => warnings.whole(format!("{count} colours lie outside 0 to {most}: cut off")),
        }
        let scaled = |value: u8| {
            let share = f32::from(value.min(most)) / f32::from(most);
            (share * 255.0).round() as u8
        };
        let colour = |rgb: &[u8]| Srgb(scaled(rgb[0]), scaled(rgb[1]), scaled(rgb[2]));
        Ok(channels.chunks_exact(3).map(colour).collect())
    }
}
