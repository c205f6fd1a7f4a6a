//! Numbers on a grid in a file: where they are, what they are, read a few rows at a time.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::PathBuf;

use glam::{UVec3, Vec3};

use super::VolumeFileError;
use super::read::damaged;
use crate::render::Bounds;

/// Most voxels of a grid that is read.
const MOST_VOXELS: u64 = 1 << 31;
/// Most voxels along a side.
const LONGEST: u32 = 1 << 20;
/// Rows and layers that are held at once: those of a brick of the grid that is built.
const HELD: u32 = 4;

/// What a number is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Scalar {
    U8,
    I16,
    U16,
    F32,
    F64,
}

impl Scalar {
    pub fn of_nrrd(name: &str) -> Option<Self> {
        Some(match name {
            "uchar" | "unsigned char" | "uint8" | "uint8_t" => Self::U8,
            "short" | "short int" | "signed short" | "int16" | "int16_t" => Self::I16,
            "ushort" | "unsigned short" | "uint16" | "uint16_t" => Self::U16,
            "float" => Self::F32,
            "double" => Self::F64,
            _ => return None,
        })
    }

    pub fn of_meta_image(name: &str) -> Option<Self> {
        Some(match name {
            "MET_UCHAR" => Self::U8,
            "MET_SHORT" => Self::I16,
            "MET_USHORT" => Self::U16,
            "MET_FLOAT" => Self::F32,
            "MET_DOUBLE" => Self::F64,
            _ => return None,
        })
    }

    fn bytes(self) -> usize {
        match self {
            Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    /// The number in the first bytes of little-endian `bytes`.
    fn number(self, bytes: &[u8]) -> f32 {
        let mut whole = [0u8; 8];
        whole[..self.bytes()].copy_from_slice(&bytes[..self.bytes()]);
        let two = [whole[0], whole[1]];
        match self {
            Self::U8 => f32::from(whole[0]),
            Self::I16 => f32::from(i16::from_le_bytes(two)),
            Self::U16 => f32::from(u16::from_le_bytes(two)),
            Self::F32 => f32::from_le_bytes([whole[0], whole[1], whole[2], whole[3]]),
            Self::F64 => f64::from_le_bytes(whole) as f32,
        }
    }
}

/// All numbers of a line that may hold brackets, commas and words.
pub(super) fn numbers(text: &str) -> impl DoubleEndedIterator<Item = f64> + '_ {
    text.split([' ', '\t', '(', ')', ','])
        .filter_map(|word| word.parse().ok())
}

/// Bounds in mm of voxels with these edges whose first has its centre at `origin`.
pub(super) fn placed(size: [u32; 3], edges: [f64; 3], origin: [f64; 3]) -> Bounds {
    let low = [0, 1, 2].map(|k| origin[k] - 0.5 * edges[k]);
    let high = [0, 1, 2].map(|k| low[k] + f64::from(size[k]) * edges[k]);
    let vector = |v: [f64; 3]| Vec3::from_array(v.map(|x| x as f32));
    Bounds {
        min: vector(low),
        max: vector(high),
    }
}

/// Numbers on a grid in a file.
#[derive(Debug, Clone)]
pub(super) struct Field {
    /// The file with the numbers.
    pub path: PathBuf,
    pub size: UVec3,
    pub bounds: Bounds,
    /// Numbers a voxel.
    pub components: u32,
    pub scalar: Scalar,
    pub big_endian: bool,
    /// Bytes before the first.
    pub offset: u64,
}

impl Field {
    /// The field, if a file of `length` bytes can hold it. Checked before any memory is
    /// asked for.
    pub fn checked(self, length: u64) -> Result<Self, VolumeFileError> {
        let [nx, ny, nz] = self.size.to_array();
        let wrong = |what: String, remedy| Err(damaged(&self.path, what, remedy));
        let voxels = u64::from(nx) * u64::from(ny);
        let voxels = voxels
            .checked_mul(u64::from(nz))
            .filter(|&n| n <= MOST_VOXELS);
        if self.size.min_element() == 0 {
            return wrong(
                format!("it is of {nx} x {ny} x {nz} voxels"),
                "give a volume with voxels on every axis",
            );
        }
        let Some(voxels) = voxels.filter(|_| self.size.max_element() <= LONGEST) else {
            return Err(VolumeFileError::TooLarge {
                path: self.path,
                what: format!("{nx} x {ny} x {nz} voxels are more than can be read"),
            });
        };
        if ![1, 3, 6].contains(&self.components) {
            return wrong(
                format!("it has {} numbers a voxel", self.components),
                "give 1, 3 or 6 numbers a voxel",
            );
        }
        let Bounds { min, max } = self.bounds;
        if !(min.is_finite() && max.is_finite() && (max - min).min_element() > 0.0) {
            return wrong(
                format!("its box is {min:?} to {max:?}"),
                "give finite corners that ascend",
            );
        }
        let bytes = voxels * u64::from(self.components) * self.scalar.bytes() as u64;
        let expected = self.offset.saturating_add(bytes);
        if length < expected {
            return wrong(
                format!("it has {length} bytes and its head speaks of {expected}"),
                "it was cut off: copy it again",
            );
        }
        Ok(self)
    }

    /// Opens it for reading.
    pub fn open(&self) -> Result<Rows, VolumeFileError> {
        let file = File::open(&self.path).map_err(|source| VolumeFileError::Unreadable {
            path: self.path.clone(),
            source,
        })?;
        Ok(Rows {
            field: self.clone(),
            file,
            bytes: Vec::new(),
            rows: Vec::new(),
            held: None,
            failed: None,
        })
    }
}

/// A field, of which four rows in each of four layers are held at once.
#[derive(Debug)]
pub(super) struct Rows {
    field: Field,
    file: File,
    bytes: Vec<u8>,
    rows: Vec<f32>,
    /// The first row and layer held, in units of [`HELD`].
    held: Option<[u32; 2]>,
    /// Why reading ended; zeros are given from then on.
    failed: Option<std::io::Error>,
}

impl Rows {
    /// The numbers of a cell, the first `N` of them.
    pub fn at<const N: usize>(&mut self, cell: UVec3) -> [f32; N] {
        let wanted = [cell.y / HELD, cell.z / HELD];
        if self.held != Some(wanted) {
            self.held = Some(wanted);
            if self.failed.is_none()
                && let Err(error) = self.hold(wanted)
            {
                self.failed = Some(error);
            }
            if self.failed.is_some() {
                self.rows.fill(0.0);
            }
        }
        let row = (cell.z % HELD) * HELD + cell.y % HELD;
        let place = (row as usize * self.field.size.x as usize + cell.x as usize)
            * self.field.components as usize;
        let mut numbers = [0.0; N];
        if let Some(found) = self.rows.get(place..place + N) {
            numbers.copy_from_slice(found);
        }
        numbers
    }

    /// What went wrong while reading, if anything did.
    pub fn finish(&mut self) -> Result<(), VolumeFileError> {
        match self.failed.take() {
            Some(source) => Err(VolumeFileError::Unreadable {
                path: self.field.path.clone(),
                source,
            }),
            None => Ok(()),
        }
    }

    fn hold(&mut self, [y, z]: [u32; 2]) -> std::io::Result<()> {
        let Field { size, scalar, .. } = self.field;
        let per_row = size.x as usize * self.field.components as usize;
        self.rows.resize(per_row * (HELD * HELD) as usize, 0.0);
        let (y, z) = (y * HELD, z * HELD);
        let count = HELD.min(size.y - y) as usize;
        self.bytes.resize(per_row * count * scalar.bytes(), 0);
        for layer in 0..HELD.min(size.z - z) {
            let row = u64::from(z + layer) * u64::from(size.y) + u64::from(y);
            let place = row * per_row as u64 * scalar.bytes() as u64;
            self.file.seek(SeekFrom::Start(self.field.offset + place))?;
            self.file.read_exact(&mut self.bytes)?;
            if self.field.big_endian {
                for number in self.bytes.chunks_exact_mut(scalar.bytes()) {
                    number.reverse();
                }
            }
            let rows = &mut self.rows[layer as usize * HELD as usize * per_row..];
            for (out, number) in rows.iter_mut().zip(self.bytes.chunks_exact(scalar.bytes())) {
                *out = scalar.number(number);
            }
        }
        Ok(())
    }
}
