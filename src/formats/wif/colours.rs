//! Palette, colour table, and the colour of each thread.

use std::collections::BTreeMap;

use super::WifError;
use super::read::File;
use super::text::{bare, shorten};
use super::threads::{Direction, Threads};
use crate::design::Srgb;
use crate::formats::sheet::{NO_PALETTE, Warnings};

/// The file's colours by their numbers.
pub(super) struct Palette {
    /// Number and colour, sorted by number; empty where the file has no table.
    table: Vec<(u32, Srgb)>,
}

impl Palette {
    pub fn read(file: &File<'_>, warnings: &mut Warnings) -> Result<Self, WifError> {
        let rows = read_table(file)?;
        let (low, high) = range(file, &rows, warnings);
        let mut table: Vec<(u32, Srgb)> = Vec::with_capacity(rows.len());
        let mut outside = None;
        for (number, (line, channels)) in rows {
            let channels = channels.map(|value| {
                if !(low..=high).contains(&value) {
                    outside.get_or_insert(line);
                }
                ((value - low) * 255.0 / (high - low))
                    .round()
                    .clamp(0.0, 255.0) as u8
            });
            table.push((number, Srgb(channels[0], channels[1], channels[2])));
        }
        if let Some(line) = outside {
            let what = format!("a colour lies outside Range={low},{high} and is cut off");
            warnings.at(line, what);
        }
        Ok(Self { table })
    }

    /// The colour of a number.
    pub fn colour(&self, number: u32) -> Option<Srgb> {
        let place = self.table.binary_search_by_key(&number, |entry| entry.0);
        place.ok().map(|place| self.table[place].1)
    }

    /// All colours in the order of their numbers.
    pub fn colours(&self) -> Vec<Srgb> {
        self.table.iter().map(|&(_, colour)| colour).collect()
    }

    /// The colour number and colour of every thread of a direction.
    pub fn choose(
        &self,
        file: &File<'_>,
        direction: Direction,
        threads: &Threads,
        active: &[bool],
        warnings: &mut Warnings,
    ) -> Result<Vec<(u32, Srgb)>, WifError> {
        let side = direction.section();
        if self.table.is_empty() {
            if let Some((line, _)) = threads.colours.iter().flatten().next() {
                return Err(WifError::at(
                    file.name,
                    *line,
                    format!("expected a [COLOR TABLE] for the numbers in [{side} COLORS]"),
                    "add the table or take the numbers out",
                ));
            }
            let colour = NO_PALETTE[usize::from(direction == Direction::Weft)];
            let colour = threads.default_rgb.unwrap_or(colour);
            let number = direction as u32 + 1;
            return Ok(vec![(number, colour); threads.colours.len()]);
        }
        let missing = |line: u32, number: u32| {
            WifError::at(
                file.name,
                line,
                format!(
                    "expected a colour from the table's {} in [{side}], found colour {number}",
                    self.table.len()
                ),
                "add that colour to [COLOR TABLE] or correct the number",
            )
        };
        let fallback = self.default_number(direction, threads, warnings);
        let mut chosen = Vec::with_capacity(threads.colours.len());
        for (thread, explicit) in threads.colours.iter().enumerate() {
            let number = match (explicit, fallback) {
                (Some((line, number)), _) => {
                    let number = *number;
                    chosen.push((
                        number,
                        self.colour(number).ok_or_else(|| missing(*line, number))?,
                    ));
                    continue;
                }
                (None, Ok(number)) => number,
                (None, Err((line, number))) => {
                    if active.get(thread).copied().unwrap_or(false) {
                        return Err(missing(line, number));
                    }
                    // Only threads that do nothing would use it.
                    self.first_explicit(threads)
                }
            };
            let colour = self.colour(number).unwrap_or(NO_PALETTE[0]);
            chosen.push((number, colour));
        }
        if let Err((line, number)) = fallback {
            let what = format!("default colour {number} of [{side}] is not in the table");
            warnings.at(line, format!("{what}; no thread that is woven needs it"));
        }
        Ok(chosen)
    }

    fn first_explicit(&self, threads: &Threads) -> u32 {
        let first = threads.colours.iter().flatten().next();
        first.map_or(self.table[0].0, |&(_, number)| number)
    }

    /// The default colour number; `Err` with its line if the table lacks it.
    fn default_number(
        &self,
        direction: Direction,
        threads: &Threads,
        warnings: &mut Warnings,
    ) -> Result<u32, (u32, u32)> {
        match threads.default_colour {
            Some((_, number)) if self.colour(number).is_some() => Ok(number),
            Some((line, number)) => Err((line, number)),
            None => {
                let usual = direction as u32 + 1;
                if self.colour(usual).is_some() {
                    return Ok(usual);
                }
                if threads.colours.iter().any(Option::is_none) {
                    let side = direction.section();
                    let what = format!("[{side}] has no Color and the table no colour {usual}");
                    warnings.whole(format!("{what}; the table's first is taken"));
                }
                Ok(self.table[0].0)
            }
        }
    }
}

/// By number: line and channels as written. Later lines of a number win.
type Rows = BTreeMap<u32, (u32, [f32; 3])>;

fn read_table(file: &File<'_>) -> Result<Rows, WifError> {
    let mut rows = Rows::new();
    for section in file.all("COLOR TABLE") {
        for entry in section.entries(true) {
            let Some(value) = entry.value.as_deref() else {
                continue;
            };
            let channels = channels(bare(value));
            match (entry.key.parse::<u16>(), channels) {
                (Ok(number), Some(channels)) => {
                    rows.insert(u32::from(number), (entry.line, channels));
                }
                _ => {
                    return Err(WifError::at(
                        file.name,
                        entry.line,
                        format!(
                            "expected number=red,green,blue in [COLOR TABLE], found \"{}={}\"",
                            shorten(entry.key),
                            shorten(value)
                        ),
                        "correct the colour",
                    ));
                }
            }
        }
    }
    Ok(rows)
}

/// Three finite numbers separated by commas.
pub(super) fn channels(text: &str) -> Option<[f32; 3]> {
    let mut values = text.split(',').map(|value| value.trim().parse::<f32>());
    let mut channels = [0.0; 3];
    for channel in &mut channels {
        *channel = values.next()?.ok().filter(|value| value.is_finite())?;
    }
    values.next().is_none().then_some(channels)
}

/// The palette's range; 0 to 255, or to the largest value, where it says nothing usable.
fn range(file: &File<'_>, rows: &Rows, warnings: &mut Warnings) -> (f32, f32) {
    let stated = file.value("COLOR PALETTE", "Range");
    if let Some((_, value)) = &stated {
        let mut ends = bare(value).split(',').map(|end| end.trim().parse::<f32>());
        if let (Some(Ok(low)), Some(Ok(high)), None) = (ends.next(), ends.next(), ends.next())
            && low < high
            && (high - low).is_finite()
        {
            return (low, high);
        }
    }
    let most = rows.values().flat_map(|row| row.1).fold(255.0f32, f32::max);
    if !rows.is_empty() {
        let line = stated.map_or_else(|| file.line_of("COLOR TABLE").unwrap_or(1), |at| at.0);
        let what = format!("no usable Range in [COLOR PALETTE]; 0,{most} is taken");
        warnings.at(line, what);
    }
    (0.0, most)
}
