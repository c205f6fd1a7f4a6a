//! The inside of a recovery file: records with checksums, and tiles that changed.
//!
//! ```text
//! magic
//! (length u32, kind u8, bytes, the first 16 bytes of the BLAKE3 hash of kind and bytes)…
//! ```
//!
//! All numbers are little-endian. The first record is the head (JSON), the second the design
//! (a design document), each further one the tiles that differ from the state before it.

use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::design::{Design, Grid, Regions, Structure, WeavePattern, YarnId, YarnMap};
use crate::edit::change::Change;
use crate::formats::ron;

/// What a recovery file begins with.
pub(super) const MAGIC: &[u8] = b"pickglass recovery 1\n";
/// Bytes that hold every head.
pub(super) const MOST_HEAD: u64 = 1 << 16;
/// Bytes of a checksum.
const SUM: usize = 16;
/// The longest name and path kept, in characters.
const MOST_TEXT: usize = 4096;

/// What a record holds.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Head = 0,
    Design = 1,
    Tiles = 2,
}

/// What is known of a copy without reading the design.
#[derive(Serialize, Deserialize)]
pub(super) struct Head {
    pub(super) name: String,
    pub(super) original: Option<String>,
}

impl Head {
    pub(super) fn now(name: &str, original: Option<&Path>) -> Self {
        let short = |text: &str| text.chars().take(MOST_TEXT).collect();
        Self {
            name: short(name),
            original: original.map(|path| short(&path.to_string_lossy())),
        }
    }

    pub(super) fn bytes(&self) -> Vec<u8> {
        // Two texts always become JSON; nothing would be a damaged head and told as such.
        serde_json::to_vec(self).unwrap_or_default()
    }
}

fn sum(kind: u8, bytes: &[u8]) -> [u8; SUM] {
    let mut hash = blake3::Hasher::new();
    hash.update(&[kind]).update(bytes);
    let mut sum = [0; SUM];
    sum.copy_from_slice(&hash.finalize().as_bytes()[..SUM]);
    sum
}

/// One record.
pub(super) fn record(kind: Kind, bytes: &[u8]) -> Vec<u8> {
    let mut record = Vec::with_capacity(bytes.len() + SUM + 5);
    record.extend((bytes.len() as u32).to_le_bytes());
    record.push(kind as u8);
    record.extend(bytes);
    record.extend(sum(kind as u8, bytes));
    record
}

/// The first record of some bytes, and what is behind it.
fn next(bytes: &[u8]) -> Result<(u8, &[u8], &[u8]), String> {
    let torn = || "it ends in the middle of a record".to_owned();
    let (length, rest) = bytes.split_first_chunk::<4>().ok_or_else(torn)?;
    let (&kind, rest) = rest.split_first().ok_or_else(torn)?;
    let length = u32::from_le_bytes(*length) as usize;
    let (content, rest) = rest.split_at_checked(length).ok_or_else(torn)?;
    let (found, rest) = rest.split_at_checked(SUM).ok_or_else(torn)?;
    match found == sum(kind, content) {
        true => Ok((kind, content, rest)),
        false => Err("a checksum does not fit".to_owned()),
    }
}

fn begin(bytes: &[u8]) -> Result<(Head, &[u8]), String> {
    let rest = bytes
        .strip_prefix(MAGIC)
        .ok_or("it is no recovery copy of this program")?;
    let (kind, content, rest) = next(rest)?;
    if kind != Kind::Head as u8 {
        return Err("it has no head".to_owned());
    }
    let head = serde_json::from_slice(content).map_err(|error| error.to_string())?;
    Ok((head, rest))
}

/// The head of a file, from its first [`MOST_HEAD`] bytes.
pub(super) fn head(bytes: &[u8]) -> Result<Head, String> {
    Ok(begin(bytes)?.0)
}

/// The design of a file after all its changes that are whole, and what was lost behind them.
pub(super) fn read(bytes: &[u8]) -> Result<(Design, Option<String>), String> {
    let (_, rest) = begin(bytes)?;
    let (kind, content, mut rest) = next(rest)?;
    if kind != Kind::Design as u8 {
        return Err("it has no design".to_owned());
    }
    let mut design = ron::read(content, "the design").map_err(|error| error.to_string())?;
    while !rest.is_empty() {
        let changed = next(rest).and_then(|(kind, content, behind)| {
            if kind != Kind::Tiles as u8 {
                return Err("a record is not of a known kind".to_owned());
            }
            let mut changed = design.clone();
            put_tiles(&mut changed, content)?;
            Ok((changed, behind))
        });
        match changed {
            Ok((changed, behind)) => (design, rest) = (changed, behind),
            Err(problem) => {
                let lost = format!("the last changes could not be read: {problem}");
                return Ok((design, Some(lost)));
            }
        }
    }
    Ok((design, None))
}

/// Which grid of a design a tile belongs to.
#[derive(Clone, Copy)]
enum Of {
    Pattern = 0,
    Map = 1,
    Mask = 2,
    Value = 3,
    Warp = 4,
    Weft = 5,
}

/// The tiles in which two designs differ; `None` if something else differs too or they
/// come to more than `room` bytes.
pub(super) fn changed_tiles(old: &Design, new: &Design, room: u64) -> Option<Vec<u8>> {
    if !Change::of_parts(old, new).is_nothing() {
        return None;
    }
    let mut tiles = Tiles {
        bytes: Vec::new(),
        room: usize::try_from(room).ok()?,
    };
    match (old.structure(), new.structure()) {
        (Structure::Pattern(old), Structure::Pattern(new)) => {
            tiles.pattern(Of::Pattern, old, new)?;
        }
        (Structure::Regions(old), Structure::Regions(new)) => {
            tiles.grid(Of::Map, old.map(), new.map(), |region| region)?;
            if let (Some(old), Some(new)) = (old.corrections(), new.corrections()) {
                tiles.pattern(Of::Mask, old.mask(), new.mask())?;
                tiles.pattern(Of::Value, old.value(), new.value())?;
            }
        }
        _ => {}
    }
    let (old, new) = (old.maps(), new.maps());
    for (of, old, new) in [
        (Of::Warp, &old.warp, &new.warp),
        (Of::Weft, &old.weft, &new.weft),
    ] {
        if let (YarnMap::Crossings(old), YarnMap::Crossings(new)) = (old, new) {
            tiles.grid(of, old, new, |YarnId(yarn)| yarn)?;
        }
    }
    Some(tiles.bytes)
}

struct Tiles {
    bytes: Vec<u8>,
    room: usize,
}

impl Tiles {
    fn place(&mut self, of: Of, column: u32, row: u32) -> Option<()> {
        self.bytes.push(of as u8);
        self.bytes.extend(column.to_le_bytes());
        self.bytes.extend(row.to_le_bytes());
        (self.bytes.len() <= self.room).then_some(())
    }

    fn pattern(&mut self, of: Of, old: &WeavePattern, new: &WeavePattern) -> Option<()> {
        for (column, row) in new.unshared(old)? {
            self.place(of, column, row)?;
            for pick in 64 * row..(64 * row + 64).min(new.picks()) {
                self.bytes.extend(new.pick_word(column, pick).to_le_bytes());
            }
        }
        Some(())
    }

    fn grid<T: Copy + PartialEq>(
        &mut self,
        of: Of,
        old: &Grid<T>,
        new: &Grid<T>,
        number: impl Fn(T) -> u16,
    ) -> Option<()> {
        for (column, row) in new.unshared(old)? {
            self.place(of, column, row)?;
            for pick in 64 * row..(64 * row + 64).min(new.picks()) {
                for &value in new.pick_values(column, pick) {
                    self.bytes.extend(number(value).to_le_bytes());
                }
            }
        }
        Some(())
    }
}

/// Puts tiles into a design.
fn put_tiles(design: &mut Design, mut bytes: &[u8]) -> Result<(), String> {
    let wrong = || "a tile does not fit the design".to_owned();
    let (ends, picks, yarns) = (design.ends(), design.picks(), design.yarns().len());
    while let Some((&of, rest)) = bytes.split_first() {
        let (column, rest) = rest.split_first_chunk::<4>().ok_or_else(wrong)?;
        let (row, rest) = rest.split_first_chunk::<4>().ok_or_else(wrong)?;
        let (column, row) = (u32::from_le_bytes(*column), u32::from_le_bytes(*row));
        if column >= ends.div_ceil(64) || row >= picks.div_ceil(64) {
            return Err(wrong());
        }
        let (width, height) = ((ends - 64 * column).min(64), (picks - 64 * row).min(64));
        let words = of == Of::Pattern as u8 || of == Of::Mask as u8 || of == Of::Value as u8;
        let length = if words {
            8 * height
        } else {
            2 * width * height
        };
        let (tile, rest) = rest.split_at_checked(length as usize).ok_or_else(wrong)?;
        bytes = rest;
        if words {
            let pattern = pattern_of(design, of).ok_or_else(wrong)?;
            for (pick, word) in tile.chunks_exact(8).enumerate() {
                let word = word
                    .iter()
                    .rev()
                    .fold(0, |bits, &byte| bits << 8 | u64::from(byte));
                pattern.set_pick_word(column, 64 * row + pick as u32, word);
            }
            continue;
        }
        let values = tile
            .chunks_exact(2)
            .map(|pair| u16::from_le_bytes([pair[0], pair[1]]));
        let place = |index: usize| {
            let (end, pick) = (index as u32 % width, index as u32 / width);
            (64 * column + end, 64 * row + pick)
        };
        let values = values
            .enumerate()
            .map(|(index, value)| (place(index), value));
        if of == Of::Map as u8 {
            let regions = regions_of(design).ok_or_else(wrong)?;
            let count = regions.palette().len();
            let map = regions.parts_mut().0;
            for ((end, pick), region) in values {
                if usize::from(region) >= count {
                    return Err(wrong());
                }
                map.set(end, pick, region);
            }
        } else {
            let maps = design.maps_mut();
            let map = if of == Of::Warp as u8 {
                &mut maps.warp
            } else {
                &mut maps.weft
            };
            let YarnMap::Crossings(grid) = map else {
                return Err(wrong());
            };
            for ((end, pick), yarn) in values {
                if of > Of::Weft as u8 || usize::from(yarn) >= yarns {
                    return Err(wrong());
                }
                grid.set(end, pick, YarnId(yarn));
            }
        }
    }
    Ok(())
}

fn regions_of(design: &mut Design) -> Option<&mut Regions> {
    match design.structure_mut() {
        Structure::Regions(regions) => Some(regions),
        _ => None,
    }
}

fn pattern_of(design: &mut Design, of: u8) -> Option<&mut WeavePattern> {
    match design.structure_mut() {
        Structure::Pattern(pattern) if of == Of::Pattern as u8 => Some(pattern),
        Structure::Regions(regions) => {
            let (mask, value) = regions.parts_mut().2.as_mut()?.parts_mut();
            match of {
                _ if of == Of::Mask as u8 => Some(mask),
                _ if of == Of::Value as u8 => Some(value),
                _ => None,
            }
        }
        _ => None,
    }
}
