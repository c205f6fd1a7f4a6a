//! A card file taken apart: header, areas, rows.

use crate::design::check_size;
use crate::formats::encoding::decode_short;
use crate::formats::field_table::Handling::{Honoured, Warned};
use crate::formats::field_table::{Field, Table};
use crate::formats::sheet::{Place, SheetError};

/// How every file begins.
pub(super) const MAGIC: &[u8] = b"\x81\xfe\x01\x01";

/// Tags of the records this program knows, and of areas.
pub(super) const NAME: u32 = 1;
pub(super) const PICKS: u32 = 2;
pub(super) const PROGRAM: u32 = 8;
pub(super) const AREA: u32 = 0x64;

/// What a file says of sizes and threads; it has no names for it.
pub const FIELDS: Table = Table {
    format: "jc5",
    fields: &[
        Field::new("picks", Honoured, "3"),
        Field::new("hooks", Honoured, "16"),
        Field::new("rows", Honoured, "5a"),
        Field::new("record 6", Warned, "1"),
        Field::new("record 9", Warned, "1"),
        Field::new("first number of area 1", Warned, "2"),
        Field::new("behind the last row", Warned, "0"),
    ],
};

/// A record that is 0 in all files that are known, and the first number of their areas.
const NOTHING: u32 = 6;
const USUAL_AREA: u32 = 1;

/// Records beyond these are not told one by one.
const MOST_TOLD: usize = 8;

/// More areas than any harness has.
const MAX_AREAS: u32 = 256;

/// What an area of hooks is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Role {
    /// Weft colours, take-up and other functions of the loom: the same on every pick.
    Controls,
    /// The edges of the cloth.
    Selvedge,
    /// The cloth.
    Cloth,
}

/// A run of hooks.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Area {
    /// What the file calls it.
    pub name: String,
    /// Number of hooks, a multiple of 8.
    pub hooks: u32,
    /// Its first byte in a row.
    pub from: usize,
    /// What it is taken to be for.
    pub role: Role,
}

impl Area {
    /// Its bytes in a row.
    pub fn bytes(&self) -> std::ops::Range<usize> {
        self.from..self.from + (self.hooks / 8) as usize
    }
}

/// A card file: what its header says and where its rows are.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CardFile<'b> {
    /// What messages call the file.
    pub file: &'b str,
    /// The name in the header, if any.
    pub name: Option<String>,
    /// The program in the header, if any.
    pub program: Option<String>,
    /// Number of picks.
    pub picks: u32,
    /// Where the number of picks stands.
    pub picks_at: usize,
    /// The areas in their order.
    pub areas: Vec<Area>,
    /// Everything before the first row.
    pub header: &'b [u8],
    /// The rows, pick 0 first.
    pub rows: &'b [u8],
    /// Bytes behind the last row, which no known file has.
    pub tail: &'b [u8],
    /// One line each: what stands there and is not understood.
    pub unread: Vec<String>,
}

/// Whether bytes are a card file.
pub fn recognises(bytes: &[u8]) -> bool {
    bytes.starts_with(MAGIC)
}

/// The bytes of a header, read on.
struct Header<'b> {
    bytes: &'b [u8],
    file: &'b str,
    at: usize,
}

impl<'b> Header<'b> {
    fn take(&mut self, count: usize, what: &str) -> Result<&'b [u8], SheetError> {
        let end = self.at.checked_add(count);
        match end.and_then(|end| self.bytes.get(self.at..end)) {
            Some(taken) => {
                self.at += count;
                Ok(taken)
            }
            None => {
                let rest = self.bytes.len() - self.at;
                let problem = format!("expected {what} ({count} bytes), found {rest}");
                Err(self.wrong(self.at, problem))
            }
        }
    }

    fn number(&mut self, what: &str) -> Result<u32, SheetError> {
        let bytes = self.take(4, what)?;
        Ok(u32::from_be_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]))
    }

    fn wrong(&self, byte: usize, problem: impl Into<String>) -> SheetError {
        let remedy = "the file is cut off or damaged: get a whole one";
        SheetError::at(self.file, Place::Byte(byte), problem, remedy)
    }
}

/// Adds what is not understood, and in the end that there is more.
fn tell(unread: &mut Vec<String>, what: impl FnOnce() -> String) {
    match unread.len() {
        MOST_TOLD => unread.push("more records and areas are not read".to_owned()),
        told if told < MOST_TOLD => unread.push(what()),
        _ => {}
    }
}

/// A text that ends at its first zero byte.
fn text(bytes: &[u8]) -> String {
    let end = bytes.iter().position(|&byte| byte == 0);
    let text = decode_short(&bytes[..end.unwrap_or(bytes.len())]);
    text.chars().take(80).collect()
}

/// Takes a card file apart. `file` is what messages call it.
///
/// # Errors
/// [`SheetError`]: one line with the file, the byte, what was expected and what to do. A
/// size beyond the file or beyond what can be woven is refused before memory is asked for.
pub fn parse<'b>(bytes: &'b [u8], file: &'b str) -> Result<CardFile<'b>, SheetError> {
    let mut header = Header { bytes, file, at: 0 };
    if header.take(4, "the beginning of a card file")? != MAGIC {
        return Err(header.wrong(0, "expected 81 FE 01 01"));
    }
    let (mut name, mut program, mut picks) = (None, None, None);
    let mut unread = Vec::new();
    for _ in 0..header.number("the count of records")? {
        let tag = header.number("a record's tag")?;
        let length = header.number("a record's length")? as usize;
        let at = header.at;
        let body = header.take(length, "a record")?;
        match tag {
            NAME => name = Some(text(body)).filter(|name| !name.is_empty()),
            PROGRAM => program = Some(text(body)).filter(|program| !program.is_empty()),
            PICKS => match body.try_into() {
                Ok(count) => picks = Some((u32::from_be_bytes(count), at)),
                Err(_) => return Err(header.wrong(at, "expected the picks in 4 bytes")),
            },
            NOTHING if body.iter().all(|&byte| byte == 0) => {}
            _ => tell(&mut unread, || {
                format!("record {tag}, {length} bytes, is not read")
            }),
        }
    }
    let Some((picks, picks_at)) = picks else {
        return Err(header.wrong(header.at, "expected a record with the picks, found none"));
    };
    let mut areas = read_areas(&mut header, &mut unread)?;
    let width: usize = areas.iter().map(|area| area.bytes().len()).sum();
    let hooks = width as u64 * 8;
    check_size(hooks, u64::from(picks))
        .map_err(|error| header.wrong(picks_at, error.to_string()))?;
    let length = width * picks as usize;
    let found = bytes.len() - header.at;
    if found < length {
        let problem = format!("expected {picks} rows of {width} bytes, found {found} bytes");
        return Err(header.wrong(header.at, problem));
    }
    let (rows, tail) = bytes[header.at..].split_at(length);
    propose_roles(&mut areas, rows, width);
    Ok(CardFile {
        file,
        name,
        program,
        picks,
        picks_at,
        areas,
        header: &bytes[..header.at],
        rows,
        tail,
        unread,
    })
}

fn read_areas(header: &mut Header<'_>, unread: &mut Vec<String>) -> Result<Vec<Area>, SheetError> {
    let at = header.at;
    let count = header.number("the count of areas")?;
    if !(1..=MAX_AREAS).contains(&count) {
        let problem = format!("expected 1 to {MAX_AREAS} areas, found {count}");
        return Err(header.wrong(at, problem));
    }
    let mut areas: Vec<Area> = Vec::new();
    let mut from = 0;
    for number in 1..=count {
        let at = header.at;
        let tag = header.number("an area's tag")?;
        let length = header.number("an area's length")? as usize;
        let body = header.take(length, "an area")?;
        let (Some(AREA), Some([e, f, g, h, a, b, c, d, name @ ..])) = (Some(tag), Some(body))
        else {
            let problem = format!("expected area {number} with tag 100, found tag {tag}");
            return Err(header.wrong(at, problem));
        };
        let first = u32::from_be_bytes([*e, *f, *g, *h]);
        if first != USUAL_AREA {
            tell(unread, || {
                format!("the first number of area {number} is {first}, not {USUAL_AREA}: not read")
            });
        }
        let hooks = u32::from_be_bytes([*a, *b, *c, *d]);
        if hooks == 0 || !hooks.is_multiple_of(8) || hooks > 1 << 24 {
            let problem = format!("expected a multiple of 8 hooks in area {number}, found {hooks}");
            return Err(header.wrong(at + 12, problem));
        }
        areas.push(Area {
            name: text(name),
            hooks,
            from,
            role: Role::Cloth,
        });
        from += (hooks / 8) as usize;
    }
    Ok(areas)
}

/// The widest area is the cloth, even where nothing is drawn on it yet; of the others,
/// those that never change are controls.
fn propose_roles(areas: &mut [Area], rows: &[u8], width: usize) {
    let widest = areas.iter().map(|area| area.hooks).max();
    let mut cloth_found = false;
    for area in areas {
        let part = area.bytes();
        let mut parts = rows.chunks_exact(width).map(|row| &row[part.clone()]);
        let first = parts.next();
        area.role = if !cloth_found && Some(area.hooks) == widest {
            cloth_found = true;
            Role::Cloth
        } else if parts.all(|part| Some(part) == first) {
            Role::Controls
        } else {
            Role::Selvedge
        };
    }
}

impl CardFile<'_> {
    /// Bytes of a row.
    pub fn width(&self) -> usize {
        self.areas.iter().map(|area| area.bytes().len()).sum()
    }

    /// The area that is taken as the cloth.
    pub fn cloth(&self) -> Option<&Area> {
        self.areas.iter().find(|area| area.role == Role::Cloth)
    }

    /// The areas and what they are taken to be for, in one line.
    pub fn roles(&self) -> String {
        let each = self.areas.iter().zip(1..).map(|(area, number)| {
            let role = match area.role {
                Role::Controls => "controls (the same on every pick)",
                Role::Selvedge => "selvedge",
                Role::Cloth => "the cloth (the widest)",
            };
            format!("area {number}, {} hooks: {role}", area.hooks)
        });
        each.collect::<Vec<_>>().join("; ")
    }

    /// The rows of an area, pick 0 first.
    pub fn area_rows(&self, area: &Area) -> impl ExactSizeIterator<Item = &[u8]> + Clone {
        let part = area.bytes();
        self.rows
            .chunks_exact(self.width())
            .map(move |row| &row[part.clone()])
    }
}
