//! Numbers on a grid in a file: where they are, what they are, read a few rows at a time.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::PathBuf;

use glam::UVec3;

use super::VolumeFileError;
use super::axes::Lie;
use super::read::damaged;
use crate::memory;
use crate::volume::corner;

/// Most voxels of a grid that is read.
const MOST_VOXELS: u64 = 1 << 31;
/// Most voxels along a side.
const LONGEST: u32 = 1 << 20;
/// Rows and layers that are held at once: those of a brick of the grid that is built.
const HELD: u32 = 4;

/// What a number is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Scalar {
    pub fn of_nrrd(name: &str) -> Option<Self> {
        Some(match name {
            "signed char" | "int8" | "int8_t" => Self::I8,
            "uchar" | "unsigned char" | "uint8" | "uint8_t" => Self::U8,
            "short" | "short int" | "signed short" | "int16" | "int16_t" => Self::I16,
            "ushort" | "unsigned short" | "uint16" | "uint16_t" => Self::U16,
            "int" | "signed int" | "int32" | "int32_t" => Self::I32,
            "uint" | "unsigned int" | "uint32" | "uint32_t" => Self::U32,
            "float" => Self::F32,
            "double" => Self::F64,
            _ => return None,
        })
    }

    pub fn of_meta_image(name: &str) -> Option<Self> {
        Some(match name {
            "MET_CHAR" => Self::I8,
            "MET_UCHAR" => Self::U8,
            "MET_SHORT" => Self::I16,
            "MET_USHORT" => Self::U16,
            "MET_INT" => Self::I32,
            "MET_UINT" => Self::U32,
            "MET_FLOAT" => Self::F32,
            "MET_DOUBLE" => Self::F64,
            _ => return None,
        })
    }

    pub fn bytes(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    /// The number in the first bytes of little-endian `bytes`.
    fn number(self, bytes: &[u8]) -> f32 {
        let mut whole = [0u8; 8];
        whole[..self.bytes()].copy_from_slice(&bytes[..self.bytes()]);
        let two = [whole[0], whole[1]];
        let four = [whole[0], whole[1], whole[2], whole[3]];
        match self {
            Self::I8 => f32::from(whole[0] as i8),
            Self::U8 => f32::from(whole[0]),
            Self::I32 => i32::from_le_bytes(four) as f32,
            Self::U32 => u32::from_le_bytes(four) as f32,
            Self::I16 => f32::from(i16::from_le_bytes(two)),
            Self::U16 => f32::from(u16::from_le_bytes(two)),
            Self::F32 => f32::from_le_bytes(four),
            Self::F64 => f64::from_le_bytes(whole) as f32,
        }
    }
}

/// A field that cannot be followed.
pub(super) struct Wrong {
    pub what: String,
    pub remedy: &'static str,
}

impl Wrong {
    pub fn new(what: impl Into<String>, remedy: &'static str) -> Self {
        let what = what.into();
        Self { what, remedy }
    }
}

/// All numbers of a line; `None` where a word is none.
pub(super) fn numbers(text: &str) -> Option<Vec<f64>> {
    text.split_whitespace()
        .map(|word| word.parse().ok())
        .collect()
}

/// Sides of a grid.
pub(super) fn in_words(size: UVec3) -> String {
    format!("{} × {} × {} voxels", size.x, size.y, size.z)
}

/// Numbers on a grid in a file.
#[derive(Debug, Clone)]
pub(super) struct Field {
    /// The file with the numbers.
    pub path: PathBuf,
    /// Where they lie.
    pub lie: Lie,
    /// Numbers a voxel.
    pub components: u32,
    /// Whether six numbers are a symmetric matrix by rows, xx xy xz yy yz zz.
    pub by_rows: bool,
    pub scalar: Scalar,
    pub big_endian: bool,
    /// Where the first is.
    pub start: Start,
    /// Why the size of a voxel is not known.
    pub unscaled: Option<String>,
    /// One line each: what the head says that is not followed.
    pub warnings: Vec<String>,
}

/// Where in a file the numbers begin.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Start {
    /// Behind so many bytes.
    At(u64),
    /// As far from the end as there are numbers.
    Last,
}

impl Field {
    /// The field, if a file of `length` bytes can hold it. Checked before any memory is
    /// asked for.
    pub fn checked(mut self, length: u64) -> Result<Self, VolumeFileError> {
        let size = self.lie.size;
        let wrong = |what: String, remedy| Err(damaged(&self.path, what, remedy));
        let voxels = size.to_array().map(u64::from).into_iter();
        let voxels = voxels
            .reduce(u64::saturating_mul)
            .filter(|&n| n <= MOST_VOXELS);
        if size.min_element() == 0 {
            return wrong(
                format!("it is of {}", in_words(size)),
                "give a volume with voxels on every axis",
            );
        }
        let Some(voxels) = voxels.filter(|_| size.max_element() <= LONGEST) else {
            return Err(VolumeFileError::TooLarge {
                path: self.path,
                what: format!("{} are more than can be read", in_words(size)),
            });
        };
        if ![1, 3, 6].contains(&self.components) {
            return wrong(
                format!("it has {} numbers a voxel", self.components),
                "give 1, 3 or 6 numbers a voxel",
            );
        }
        let (min, max) = (self.lie.bounds.min, self.lie.bounds.max);
        if !(min.is_finite() && max.is_finite() && (max - min).min_element() > 0.0) {
            return wrong(
                format!("its box is from {} to {}", corner(min), corner(max)),
                "give finite corners that ascend",
            );
        }
        let bytes = voxels * u64::from(self.components) * self.scalar.bytes() as u64;
        let offset = match self.start {
            Start::At(offset) => offset,
            Start::Last => length.saturating_sub(bytes),
        };
        let expected = offset.saturating_add(bytes);
        if length < expected {
            return wrong(
                format!("it has {length} bytes and its head speaks of {expected}"),
                "it was cut off: copy it again",
            );
        }
        self.start = Start::At(offset);
        Ok(self)
    }

    /// Opens it for reading.
    pub fn open(&self) -> Result<Rows, VolumeFileError> {
        let unreadable = |why| VolumeFileError::Unreadable {
            path: self.path.clone(),
            why,
        };
        let [nx, ny, nz] = self.lie.file_size().map(u64::from);
        let row = nx * u64::from(self.components) * size_of::<f32>() as u64;
        let name = || self.path.display().to_string();
        let mut rows = Rows {
            field: self.clone(),
            file: File::open(&self.path).map_err(unreadable)?,
            bytes: Vec::new(),
            rows: Vec::new(),
            held: Held::Nothing,
            failed: None,
        };
        if self.lie.in_order() {
            memory::ask(2 * row * u64::from(HELD * HELD), name)?;
        } else {
            // Neighbours along x lie far from each other in the file.
            memory::ask(row.saturating_mul(ny).saturating_mul(nz), name)?;
            rows.hold_all().map_err(unreadable)?;
        }
        Ok(rows)
    }
}

/// A field, of which four rows in each of four layers are held at once; all of one whose
/// axes are exchanged.
#[derive(Debug)]
pub(super) struct Rows {
    field: Field,
    file: File,
    bytes: Vec<u8>,
    rows: Vec<f32>,
    held: Held,
    /// Why reading ended; zeros are given from then on.
    failed: Option<std::io::Error>,
}

/// What is held.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Held {
    Nothing,
    All,
    /// The row and layer of space, in units of [`HELD`], of a block of rows; and the first
    /// row and layer of it in the file.
    Block([u32; 2], [u32; 2]),
}

impl Rows {
    /// The numbers of a cell, the first `N` of them.
    pub fn at<const N: usize>(&mut self, cell: UVec3) -> [f32; N] {
        let wanted = [cell.y / HELD, cell.z / HELD];
        match self.held {
            Held::All => {}
            Held::Block(held, _) if held == wanted => {}
            _ => self.hold(wanted),
        }
        let lie = &self.field.lie;
        let [x, y, z] = lie.in_file(cell).map(|side| side as usize);
        let [nx, ny, _] = lie.file_size().map(|side| side as usize);
        let row = match self.held {
            Held::Block(_, [first, layer]) => {
                (z - layer as usize) * HELD as usize + (y - first as usize)
            }
            _ => z * ny + y,
        };
        let place = (row * nx + x) * self.field.components as usize;
        let mut numbers = [0.0; N];
        if let Some(found) = self.rows.get(place..place + N) {
            numbers.copy_from_slice(found);
        }
        if self.field.by_rows && N == 6 {
            // xx yy zz xy xz yz are wanted.
            let by_rows = numbers;
            for (number, from) in numbers.iter_mut().zip([0, 3, 5, 1, 2, 4]) {
                *number = by_rows[from];
            }
        }
        numbers
    }

    /// What went wrong while reading, if anything did.
    pub fn finish(&mut self) -> Result<(), VolumeFileError> {
        match self.failed.take() {
            Some(why) => Err(VolumeFileError::Unreadable {
                path: self.field.path.clone(),
                why,
            }),
            None => Ok(()),
        }
    }

    /// Holds the rows of a block of space.
    fn hold(&mut self, block: [u32; 2]) {
        let lie = &self.field.lie;
        // First and number of rows along an axis of the file.
        let range = |k: usize| {
            let (low, side) = (block[k - 1] * HELD, lie.size[k]);
            let count = HELD.min(side - low);
            let first = if lie.descends(k) {
                side - low - count
            } else {
                low
            };
            (first, count)
        };
        let (rows, layers) = (range(1), range(2));
        self.held = Held::Block(block, [rows.0, layers.0]);
        if self.failed.is_none()
            && let Err(error) = self.read_block(rows, layers)
        {
            self.failed = Some(error);
        }
        if self.failed.is_some() {
            self.rows.fill(0.0);
        }
    }

    fn per_row(&self) -> usize {
        self.field.lie.file_size()[0] as usize * self.field.components as usize
    }

    fn read_block(
        &mut self,
        (first, count): (u32, u32),
        (layer, layers): (u32, u32),
    ) -> std::io::Result<()> {
        let per_row = self.per_row();
        self.rows.resize(per_row * (HELD * HELD) as usize, 0.0);
        for k in 0..layers {
            let out = (k * HELD) as usize * per_row;
            self.read_rows(layer + k, first, count, out)?;
        }
        Ok(())
    }

    /// Reads some rows of a layer to a place in what is held.
    fn read_rows(&mut self, layer: u32, first: u32, count: u32, out: usize) -> std::io::Result<()> {
        let (scalar, per_row) = (self.field.scalar, self.per_row());
        let Start::At(offset) = self.field.start else {
            return Err(std::io::ErrorKind::InvalidInput.into());
        };
        let row = u64::from(layer) * u64::from(self.field.lie.file_size()[1]) + u64::from(first);
        let place = row * per_row as u64 * scalar.bytes() as u64;
        self.bytes
            .resize(per_row * count as usize * scalar.bytes(), 0);
        self.file.seek(SeekFrom::Start(offset + place))?;
        self.file.read_exact(&mut self.bytes)?;
        if self.field.big_endian {
            for number in self.bytes.chunks_exact_mut(scalar.bytes()) {
                number.reverse();
            }
        }
        let numbers = self.bytes.chunks_exact(scalar.bytes());
        for (out, number) in self.rows[out..].iter_mut().zip(numbers) {
            *out = scalar.number(number);
        }
        Ok(())
    }

    fn hold_all(&mut self) -> std::io::Result<()> {
        let [_, ny, nz] = self.field.lie.file_size();
        let per_row = self.per_row();
        self.rows = vec![0.0; per_row * ny as usize * nz as usize];
        for layer in 0..nz {
            for row in 0..ny {
                let out = (layer as usize * ny as usize + row as usize) * per_row;
                self.read_rows(layer, row, 1, out)?;
            }
        }
        self.held = Held::All;
        Ok(())
    }
}
