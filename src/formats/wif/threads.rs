//! What a WIF says about single threads: colour number, spacing, thickness.

use std::collections::BTreeMap;
use std::num::{IntErrorKind, ParseIntError};

use super::WifError;
use super::colours::channels;
use super::read::{File, is_program_default};
use super::text::{bare, same, shorten};
use crate::design::{
    Density, Family, MAX_PITCH_MM, MIN_PITCH_MM, Sett, Srgb, StatedThreads, Yarn, YarnId,
};
use crate::formats::LoadOptions;
use crate::formats::sheet::Warnings;
use crate::limits;

/// Warp or weft.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::formats) enum Direction {
    Warp = 0,
    Weft = 1,
}

impl Direction {
    pub fn section(self) -> &'static str {
        match self {
            Self::Warp => "WARP",
            Self::Weft => "WEFT",
        }
    }

    fn list(self, which: List) -> &'static str {
        match (self, which) {
            (Self::Warp, List::Colours) => "WARP COLORS",
            (Self::Weft, List::Colours) => "WEFT COLORS",
            (Self::Warp, List::Spacing) => "WARP SPACING",
            (Self::Weft, List::Spacing) => "WEFT SPACING",
            (Self::Warp, List::Thickness) => "WARP THICKNESS",
            (Self::Weft, List::Thickness) => "WEFT THICKNESS",
        }
    }
}

#[derive(Debug, Clone, Copy)]
enum List {
    Colours,
    Spacing,
    Thickness,
}

/// The threads of one direction as the file describes them.
pub(in crate::formats) struct Threads {
    /// Default colour number as written, with its line.
    pub default_colour: Option<(u32, i64)>,
    /// Channels behind the default number, for files whose table lacks it.
    pub default_channels: Option<[f32; 3]>,
    /// Line and colour number, as written, of each thread that has its own.
    pub colours: Vec<Option<(u32, i64)>>,
    unit: Option<String>,
    unit_mm: Option<f32>,
    spacing: Option<f32>,
    thickness: Option<f32>,
    /// Thread from 0 and value in the unit, sorted.
    spacings: Vec<(u32, f32)>,
    thicknesses: Vec<(u32, f32)>,
}

impl Threads {
    /// As many threads as another format lists, with their usual spacing in a unit and
    /// that of single threads (from 0).
    pub fn listed(count: usize, spacing: Option<(&str, f32)>, spacings: Vec<(u32, f32)>) -> Self {
        let (unit, spacing) = spacing.unzip();
        Self {
            default_colour: None,
            default_channels: None,
            colours: vec![None; count],
            unit: unit.map(str::to_owned),
            unit_mm: unit.and_then(unit_mm),
            spacing,
            thickness: None,
            spacings,
            thicknesses: Vec::new(),
        }
    }

    /// What is written back as long as nobody chooses a sett.
    pub fn stated(&self) -> Option<StatedThreads> {
        let says = self.spacing.is_some()
            || self.thickness.is_some()
            || !self.spacings.is_empty()
            || !self.thicknesses.is_empty();
        says.then(|| StatedThreads {
            unit: self.unit.clone().unwrap_or_default(),
            spacing: self.spacing,
            thickness: self.thickness,
            spacings: self.spacings.clone(),
            thicknesses: self.thicknesses.clone(),
        })
    }
}

/// Millimetres of a WIF unit.
pub(super) fn unit_mm(unit: &str) -> Option<f32> {
    let is = |names: &[&str]| names.iter().any(|name| same(unit, name));
    if is(&["centimeters", "centimetres", "centimeter", "cm"]) {
        Some(10.0)
    } else if is(&["inches", "inch", "in"]) {
        Some(25.4)
    } else if is(&["decipoints", "decipoint"]) {
        Some(25.4 / 720.0)
    } else if is(&["millimeters", "millimetres", "mm"]) {
        Some(1.0)
    } else {
        None
    }
}

/// Reads [WARP] or [WEFT] and its lists for `count` threads counted from `base`.
pub(super) fn read(
    file: &File<'_>,
    direction: Direction,
    count: u32,
    base: u32,
    warnings: &mut Warnings,
) -> Result<Threads, WifError> {
    let section = direction.section();
    let unit = file
        .value(section, "Units")
        .map(|(line, unit)| (line, bare(&unit).to_owned()))
        .filter(|(_, unit)| !unit.is_empty());
    let factor = unit.as_ref().and_then(|(_, unit)| unit_mm(unit));
    if let Some((line, unit)) = &unit {
        if factor.is_none() {
            let what = format!("Units={} is unknown", shorten(unit));
            warnings.at(*line, format!("{what}: use Centimeters or Inches"));
        } else if same(unit, "decipoints") {
            warnings.at(*line, "Decipoints are read as 1/720 inch");
        }
    }
    let mut length = |key: &str| -> Result<Option<f32>, WifError> {
        match file.value(section, key) {
            Some((line, value)) => measure(file, line, key, &value, warnings),
            None => Ok(None),
        }
    };
    let spacing = length("Spacing")?;
    let thickness = length("Thickness")?;
    let (default_colour, default_channels) = default_colour(file, section)?;
    Ok(Threads {
        default_colour,
        default_channels,
        colours: colours(file, direction, count, base, warnings)?,
        unit: unit.map(|(_, unit)| unit),
        unit_mm: factor,
        spacing,
        thickness,
        spacings: measures(file, direction.list(List::Spacing), count, base, warnings)?,
        thicknesses: measures(file, direction.list(List::Thickness), count, base, warnings)?,
    })
}

/// A positive length; empty is none, zero and below are warned about and none.
fn measure(
    file: &File<'_>,
    line: u32,
    key: &str,
    value: &str,
    warnings: &mut Warnings,
) -> Result<Option<f32>, WifError> {
    let value = bare(value);
    if value.is_empty() {
        return Ok(None);
    }
    // Some programs write the decimal comma of their country.
    let number = value.replacen(',', ".", 1).parse::<f32>();
    match number {
        Ok(number) if number.is_finite() && number > 0.0 => Ok(Some(number)),
        Ok(number) if number.is_finite() => {
            warnings.at(line, format!("{key}={number} is no distance and ignored"));
            Ok(None)
        }
        _ => Err(WifError::at(
            file.name,
            line,
            format!(
                "expected {key} to be a number, found \"{}\"",
                shorten(value)
            ),
            "correct it or leave it out",
        )),
    }
}

/// The thread a key names, from 0; `None` with a warning if there is no such thread.
fn thread_of(
    key: &str,
    line: u32,
    list: &str,
    count: u32,
    base: u32,
    warnings: &mut Warnings,
) -> Option<u32> {
    let thread = bare(key)
        .parse::<u32>()
        .ok()
        .and_then(|thread| thread.checked_sub(base))
        .filter(|&thread| thread < count);
    if thread.is_none() {
        let what = format!(
            "\"{}\" in [{list}] is none of the {count} threads",
            shorten(key)
        );
        warnings.at(line, format!("{what}; ignored"));
    }
    thread
}

/// Spacing or thickness of single threads, sorted by thread, later lines winning.
fn measures(
    file: &File<'_>,
    list: &'static str,
    count: u32,
    base: u32,
    warnings: &mut Warnings,
) -> Result<Vec<(u32, f32)>, WifError> {
    let mut found: BTreeMap<u32, f32> = BTreeMap::new();
    for section in file.all(list) {
        for entry in section.entries(true) {
            let Some(value) = entry.value.as_deref() else {
                continue;
            };
            let Some(thread) = thread_of(entry.key, entry.line, list, count, base, warnings) else {
                continue;
            };
            let key = format!("{list} {}", entry.key);
            if let Some(value) = measure(file, entry.line, &key, value, warnings)? {
                found.insert(thread, value);
            }
        }
    }
    Ok(found.into_iter().collect())
}

/// `Color=number` or `Color=number,red,green,blue`: the number with its line, and the
/// channels.
type DefaultColour = (Option<(u32, i64)>, Option<[f32; 3]>);

fn default_colour(file: &File<'_>, section: &'static str) -> Result<DefaultColour, WifError> {
    let Some((line, value)) = file.value(section, "Color") else {
        return Ok((None, None));
    };
    let value = bare(&value);
    if value.is_empty() {
        return Ok((None, None));
    }
    let number = colour_number(file, line, section, value)?;
    let rest = value.split_once(',').and_then(|(_, rest)| channels(rest));
    Ok((Some((line, number)), rest))
}

/// The colour number before any channels. Whole numbers that no table can have are numbers
/// all the same: the nearest that can be told.
fn colour_number(file: &File<'_>, line: u32, place: &str, value: &str) -> Result<i64, WifError> {
    let first = value.split(',').next().unwrap_or(value).trim();
    first
        .parse()
        .or_else(|error: ParseIntError| match error.kind() {
            IntErrorKind::PosOverflow => Ok(i64::MAX),
            IntErrorKind::NegOverflow => Ok(i64::MIN),
            _ => Err(WifError::at(
                file.name,
                line,
                format!(
                    "expected a colour's number in [{place}], found \"{}\"",
                    shorten(first)
                ),
                "use a number from [COLOR TABLE]",
            )),
        })
}

fn colours(
    file: &File<'_>,
    direction: Direction,
    count: u32,
    base: u32,
    warnings: &mut Warnings,
) -> Result<Vec<Option<(u32, i64)>>, WifError> {
    let list = direction.list(List::Colours);
    let mut found = vec![None; count as usize];
    for section in file.all(list) {
        for entry in section.entries(true) {
            let value = bare(entry.value.as_deref().unwrap_or(""));
            if value.is_empty() {
                continue;
            }
            let number = colour_number(file, entry.line, list, value)?;
            if let Some(thread) = thread_of(entry.key, entry.line, list, count, base, warnings) {
                found[thread as usize] = Some((entry.line, number));
            }
        }
    }
    Ok(found)
}

/// Pitches and drawn widths in mm, as far as the file or the caller says anything.
pub(in crate::formats) struct Spacing {
    ends: Side,
    picks: Side,
    assumed: bool,
}

/// One direction.
struct Side {
    /// Usual pitch in mm; `None` = whatever is usual for the yarn.
    pitch: Option<f32>,
    /// Pitch of single threads relative to the usual one.
    relative: Vec<f32>,
    /// Drawn width of each thread in mm; empty where the file says nothing usable.
    widths: Vec<Option<f32>>,
    threads: usize,
}

impl Spacing {
    pub fn resolve(
        warp: &Threads,
        weft: &Threads,
        options: &LoadOptions,
        warnings: &mut Warnings,
    ) -> Result<Self, String> {
        let millimetres = |threads: &Threads| Some(threads.spacing? * threads.unit_mm?);
        let stated = [millimetres(warp), millimetres(weft)];
        let believed = stated.map(|spacing| {
            spacing.filter(|&mm| limits::can_be_woven(mm) && !is_program_default(mm))
        });
        if let Some((ends, picks)) = options.sett {
            for (per_cm, what) in [(ends, "ends"), (picks, "picks")] {
                if !limits::can_be_woven(10.0 / per_cm) {
                    let range = limits::in_words(&limits::SETT_PER_CM);
                    return Err(format!("expected {range} {what} per cm, found {per_cm}"));
                }
            }
            return Ok(Self {
                ends: Side::new(warp, Some(10.0 / ends), false),
                picks: Side::new(weft, Some(10.0 / picks), false),
                assumed: false,
            });
        }
        for (threads, side, mm) in [(warp, "WARP", stated[0]), (weft, "WEFT", stated[1])] {
            if threads.spacing.is_some() && threads.unit_mm.is_none() {
                warnings.whole(format!(
                    "[{side}] gives a spacing without Units: its size is unknown and what is \
                     usual for the yarn is taken; give a sett"
                ));
            } else if mm.is_some_and(is_program_default) {
                warnings.whole(format!(
                    "[{side}] spacing of 0.212 cm is a drawing program's default, no sett: what \
                     is usual for the yarn is taken; give a sett"
                ));
            } else if mm.is_some_and(|mm| !limits::can_be_woven(mm)) {
                let range = limits::in_words(&limits::PITCH_MM);
                warnings.whole(format!(
                    "[{side}] Spacing is no cloth's ({range} mm): what is usual for the yarn is \
                     taken"
                ));
            }
            if threads.thickness > threads.spacing && threads.spacing.is_some() {
                warnings.whole(format!(
                    "[{side}] Thickness is greater than Spacing: yarns are taken to touch"
                ));
            }
        }
        // One direction stands for both where only one is believed.
        let [ends, picks] = [believed[0].or(believed[1]), believed[1].or(believed[0])];
        Ok(Self {
            ends: Side::new(warp, ends, believed[0].is_some()),
            picks: Side::new(weft, picks, believed[1].is_some()),
            assumed: ends.is_none(),
        })
    }

    /// The sett, with what is usual where nothing was said.
    pub fn sett(&self, usual: Sett) -> Sett {
        Sett {
            ends: self.ends.density(usual.ends),
            picks: self.picks.density(usual.picks),
            assumed: self.assumed,
        }
    }
}

/// The most a stated thickness may cover: beyond, yarns are taken to touch.
const MOST_COVER: f32 = 0.95;

impl Side {
    fn new(threads: &Threads, pitch: Option<f32>, believed: bool) -> Self {
        let count = threads.colours.len();
        let mut relative = Vec::new();
        let usual = threads.spacing.unwrap_or_else(|| {
            let sum: f32 = threads.spacings.iter().map(|&(_, spacing)| spacing).sum();
            sum / threads.spacings.len().max(1) as f32
        });
        if threads
            .spacings
            .iter()
            .any(|&(_, spacing)| spacing != usual)
            && usual > 0.0
        {
            relative = vec![1.0; count];
            for &(thread, spacing) in &threads.spacings {
                relative[thread as usize] = spacing / usual;
            }
        }
        let mut widths = Vec::new();
        if let (true, Some(unit), Some(pitch)) = (believed, threads.unit_mm, pitch) {
            let width = |thickness: f32| Some((thickness * unit).min(MOST_COVER * pitch));
            widths = vec![threads.thickness.and_then(width); count];
            for &(thread, thickness) in &threads.thicknesses {
                widths[thread as usize] = width(thickness);
            }
        }
        Self {
            pitch,
            relative,
            widths,
            threads: count,
        }
    }

    fn density(&self, usual: Density) -> Density {
        let pitch = self.pitch.unwrap_or_else(|| usual.pitch_mm());
        let pitches_mm = (!self.relative.is_empty()).then(|| {
            self.relative
                .iter()
                .map(|ratio| (pitch * ratio).clamp(MIN_PITCH_MM, MAX_PITCH_MM))
                .collect()
        });
        Density {
            per_cm: 10.0 / pitch,
            pitches_mm,
        }
    }

    /// Diameter in mm of a thread's yarn; `None` = the family's usual one.
    fn diameter(&self, thread: usize, family: Family) -> Option<f32> {
        let stated = self.widths.get(thread).copied().flatten();
        let diameter = stated.or_else(|| Some(self.pitch? * family.numbers().cover))?;
        Some(diameter.clamp(MIN_PITCH_MM, MAX_PITCH_MM))
    }
}

/// The yarns in use, and which each end and pick is: one yarn for each colour number,
/// colour and diameter. (One number has two colours where the file has none for it.)
pub(in crate::formats) type Yarns = (Vec<Yarn>, Vec<YarnId>, Vec<YarnId>);

pub(in crate::formats) fn yarns(
    family: Family,
    spacing: &Spacing,
    warp: &[(u32, Srgb)],
    weft: &[(u32, Srgb)],
) -> Result<Yarns, String> {
    let mut known: BTreeMap<(u32, Srgb, Option<u32>), YarnId> = BTreeMap::new();
    let mut yarns: Vec<Yarn> = Vec::new();
    let mut order = |side: &Side, chosen: &[(u32, Srgb)]| -> Result<Vec<YarnId>, String> {
        let mut order = Vec::with_capacity(side.threads);
        for (thread, &(number, colour)) in chosen.iter().enumerate() {
            let diameter_mm = side.diameter(thread, family);
            let key = (number, colour, diameter_mm.map(f32::to_bits));
            let id = match known.get(&key) {
                Some(&id) => id,
                None => {
                    let id = u16::try_from(yarns.len()).map(YarnId).map_err(|_| {
                        format!("expected at most {} different yarns", limits::YARNS)
                    })?;
                    yarns.push(Yarn {
                        diameter_mm,
                        ..Yarn::new(format!("colour {number}"), family, colour)
                    });
                    known.insert(key, id);
                    id
                }
            };
            order.push(id);
        }
        Ok(order)
    };
    let warp = order(&spacing.ends, warp)?;
    let weft = order(&spacing.picks, weft)?;
    Ok((yarns, warp, weft))
}
