//! Palette, colour table, and the colour of each thread.

use std::collections::BTreeMap;

use super::WifError;
use super::read::File;
use super::text::bare;
use crate::design::{Direction, Srgb};
use crate::formats::sheet::text::shorten;
use crate::formats::sheet::threads::Threads;
use crate::formats::sheet::{NO_PALETTE, StandIns, Warnings, kept_number};

/// The file's colours by their numbers.
pub(super) struct Palette {
    /// Number and colour, sorted by number; empty where the file has no table.
    table: Vec<(u32, Srgb)>,
    /// The channels that are black and white.
    range: (f32, f32),
}

/// The threads of a direction: what the file says of them, and which do something.
type Side<'t> = (&'t Threads, &'t [bool]);

impl Palette {
    pub fn read(file: &File<'_>, warnings: &mut Warnings) -> Result<Self, WifError> {
        let rows = read_table(file)?;
        let range = range(file, &rows, warnings);
        let mut table: Vec<(u32, Srgb)> = Vec::with_capacity(rows.len());
        let (mut outside, mut first) = (0, None);
        for (number, (line, channels)) in rows {
            let (colour, inside) = scaled(channels, range);
            if !inside {
                outside += 1;
                first.get_or_insert(line);
            }
            table.push((number, colour));
        }
        if let Some(line) = first {
            let (low, high) = range;
            let what = match outside {
                1 => "a colour lies".to_owned(),
                _ => format!("{outside} colours lie"),
            };
            warnings.at(line, format!("{what} outside Range={low},{high}: cut off"));
        }
        Ok(Self { table, range })
    }

    /// The colour of a number.
    fn colour(&self, number: i64) -> Option<(u32, Srgb)> {
        let number = u32::try_from(number).ok()?;
        let place = self.table.binary_search_by_key(&number, |entry| entry.0);
        place.ok().map(|place| self.table[place])
    }

    /// All colours in the order of their numbers.
    pub fn colours(&self) -> Vec<Srgb> {
        self.table.iter().map(|&(_, colour)| colour).collect()
    }

    /// The colour number and colour of every end and every pick.
    pub fn choose(&self, warp: Side<'_>, weft: Side<'_>, warnings: &mut Warnings) -> Chosen {
        let from_zero = self.counts_from_zero([warp.0, weft.0]);
        if from_zero {
            warnings.whole(
                "colour 0 is named and [COLOR TABLE] begins with 1: colours are counted from 0",
            );
        }
        let mut stand_ins = StandIns::default();
        let base = i64::from(from_zero);
        let chosen = [(Direction::Warp, warp), (Direction::Weft, weft)]
            .map(|(direction, side)| self.side(direction, side, base, &mut stand_ins, warnings));
        stand_ins.tell("[COLOR TABLE]", self.table.len(), warnings);
        chosen
    }

    /// Whether the numbers of threads count from 0 while the table counts from 1: colour 0
    /// is named, and every number that is named has its colour one further on.
    fn counts_from_zero(&self, sides: [&Threads; 2]) -> bool {
        let named = sides.into_iter().flat_map(|threads| {
            let all_listed = threads.colours.iter().all(Option::is_some);
            let usual = threads.default_colour.filter(|_| !all_listed);
            threads.colours.iter().flatten().copied().chain(usual)
        });
        let mut zero = false;
        let mut fits = self.colour(0).is_none();
        for (_, number) in named {
            zero |= number == 0;
            fits &= self.colour(number.saturating_add(1)).is_some();
        }
        zero && fits
    }

    fn side(
        &self,
        direction: Direction,
        (threads, active): Side<'_>,
        base: i64,
        stand_ins: &mut StandIns,
        warnings: &mut Warnings,
    ) -> Vec<(u32, Srgb)> {
        let usual = self.usual(direction, threads, base);
        let stand_in = usual.unwrap_or_else(|| self.of_direction(direction));
        let first_listed = || {
            let mut listed = threads.colours.iter().flatten();
            listed.find_map(|&(_, number)| self.colour(number.saturating_add(base)))
        };
        let mut needed = false;
        let chosen = threads.colours.iter().enumerate().map(|(thread, listed)| {
            let (line, number) = match (listed, usual, threads.default_colour) {
                (Some((line, number)), ..) => match self.colour(number.saturating_add(base)) {
                    Some(known) => return known,
                    None => (Some(*line), *number),
                },
                (None, Some(usual), _) => return usual,
                (None, None, None) => return stand_in,
                // Only threads that do nothing would use it.
                (None, None, Some(_)) if active.get(thread) != Some(&true) => {
                    return first_listed().unwrap_or(stand_in);
                }
                (None, None, Some((line, number))) => {
                    needed = true;
                    (Some(line), number)
                }
            };
            stand_ins.count(direction, thread, (line, number), stand_in.1);
            (kept_number(number, stand_in.0), stand_in.1)
        });
        let chosen = chosen.collect();
        let section = super::threads::section(direction);
        match (usual, threads.default_colour) {
            (None, Some((line, number))) if !needed => {
                let what = format!("default colour {number} of [{section}] is not in the table");
                warnings.at(line, format!("{what}; no thread that is woven needs it"));
            }
            (None, None)
                if !self.table.is_empty() && threads.colours.iter().any(Option::is_none) =>
            {
                let number = direction as u32 + 1;
                let what = format!("[{section}] has no Color and the table no colour {number}");
                warnings.whole(format!("{what}; {} is taken", stand_in.1));
            }
            _ => {}
        }
        chosen
    }

    /// The stated default of a direction, or, where none is stated, colour 1 for the warp
    /// and 2 for the weft; `None` if the file has no such colour.
    fn usual(&self, direction: Direction, threads: &Threads, base: i64) -> Option<(u32, Srgb)> {
        let own = direction as u32 + 1;
        match threads.default_colour {
            Some((_, number)) => self.colour(number.saturating_add(base)).or_else(|| {
                let channels = threads.default_channels?;
                Some((kept_number(number, own), scaled(channels, self.range).0))
            }),
            None => self.colour(own.into()),
        }
    }

    /// The colour of a direction that has none: the table's first for the warp and second
    /// for the weft, or white and blue.
    fn of_direction(&self, direction: Direction) -> (u32, Srgb) {
        let place = direction as usize;
        let usual = (place as u32 + 1, NO_PALETTE[place]);
        *(self.table.get(place).or(self.table.first())).unwrap_or(&usual)
    }
}

/// The colour number and colour of every end, and of every pick.
type Chosen = [Vec<(u32, Srgb)>; 2];

/// The colour of channels, and whether they lie in their range.
fn scaled(channels: [f32; 3], (low, high): (f32, f32)) -> (Srgb, bool) {
    let inside = channels.iter().all(|value| (low..=high).contains(value));
    let [red, green, blue] = channels.map(|value| {
        let share = (value.clamp(low, high) - low) * 255.0 / (high - low);
        share.round().clamp(0.0, 255.0) as u8
    });
    (Srgb(red, green, blue), inside)
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

/// Three numbers separated by commas; what is beyond all numbers is beyond every range.
pub(super) fn channels(text: &str) -> Option<[f32; 3]> {
    let mut values = text.split(',').map(|value| value.trim().parse::<f32>());
    let mut channels = [0.0; 3];
    for channel in &mut channels {
        *channel = values.next()?.ok().filter(|value| !value.is_nan())?;
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
    let finite = rows
        .values()
        .flat_map(|row| row.1)
        .filter(|value| value.is_finite());
    let most = finite.fold(255.0f32, f32::max);
    if !rows.is_empty() {
        let line = stated.map_or_else(|| file.line_of("COLOR TABLE").unwrap_or(1), |at| at.0);
        let what = format!("no usable Range in [COLOR PALETTE]; 0,{most} is taken");
        warnings.at(line, what);
    }
    (0.0, most)
}
