//! What a WIF says about single threads, read line by line.

use std::collections::BTreeMap;
use std::num::{IntErrorKind, ParseIntError};

use super::WifError;
use super::colours::channels;
use super::read::File;
use super::text::bare;
use crate::design::Direction;
use crate::formats::sheet::Warnings;
use crate::formats::sheet::text::{same, shorten};
use crate::formats::sheet::threads::{Threads, unit_mm};

#[derive(Debug, Clone, Copy)]
enum List {
    Colours,
    Spacing,
    Thickness,
}

/// The section of a direction.
pub(super) fn section(direction: Direction) -> &'static str {
    match direction {
        Direction::Warp => "WARP",
        Direction::Weft => "WEFT",
    }
}

fn list(direction: Direction, which: List) -> &'static str {
    match (direction, which) {
        (Direction::Warp, List::Colours) => "WARP COLORS",
        (Direction::Weft, List::Colours) => "WEFT COLORS",
        (Direction::Warp, List::Spacing) => "WARP SPACING",
        (Direction::Weft, List::Spacing) => "WEFT SPACING",
        (Direction::Warp, List::Thickness) => "WARP THICKNESS",
        (Direction::Weft, List::Thickness) => "WEFT THICKNESS",
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
    let section = section(direction);
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
        spacings: measures(file, list(direction, List::Spacing), count, base, warnings)?,
        thicknesses: measures(
            file,
            list(direction, List::Thickness),
            count,
            base,
            warnings,
        )?,
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
    let list = list(direction, List::Colours);
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
