//! Mitsuba's `.vol`, version 3, little-endian: `VOL`, 3, i32 encoding (1 = f32), i32 size
//! in x, y, z, i32 channels, f32 lower and upper corner, then voxels x fastest with their
//! channels side by side. Corners here are in mm, σ in 1/mm.

use std::path::Path;

use super::axes::Lie;
use super::dense::{Channel, Layer};
use super::fields::{Field, Scalar, Start};
use super::read::{beginning, damaged, length_of};
use super::{VolumeFileError, beside};
use crate::formats::field_table::{Field as Row, Handling, Table};
use crate::scene::Bounds;
use crate::volume::source::Frame;

/// Bytes before the voxels.
const HEAD: usize = 48;

/// The three files of a volume.
pub(super) fn layers(frame: &Frame, path: &Path) -> Result<Vec<Layer>, VolumeFileError> {
    let layer = |path, channel| Layer {
        path,
        channel,
        head: head(frame, channel.components()),
        tail: Vec::new(),
        header: None,
    };
    Ok(vec![
        layer(path.to_owned(), Channel::Sigma),
        layer(beside(path, "albedo"), Channel::Albedo),
        layer(beside(path, "sggx"), Channel::Sggx),
    ])
}

fn head(frame: &Frame, channels: u32) -> Vec<u8> {
    let mut head = b"VOL\x03".to_vec();
    let [nx, ny, nz] = frame.size.to_array();
    for number in [1, nx, ny, nz, channels] {
        head.extend(number.to_le_bytes());
    }
    let Bounds { min, max } = frame.bounds();
    for number in min.to_array().into_iter().chain(max.to_array()) {
        head.extend(number.to_le_bytes());
    }
    head
}

/// What changes size, place, scale or density, by place: the format has no names.
pub const FIELDS: Table = Table {
    format: "vol",
    fields: &[
        Row::new("version", Handling::Refused, "2"),
        Row::new("encoding", Handling::Refused, "2"),
        Row::new("size", Handling::Honoured, "3 4 2"),
        Row::new("channels", Handling::Refused, "2"),
        Row::new("box", Handling::Honoured, "1 1 1 2 2 2"),
        Row::new("box", Handling::Refused, "0 0 0 0 0 0"),
        Row::new("box", Handling::Refused, "2 2 2 1 1 1"),
    ],
};

/// What the head of a file says.
pub(super) fn field(path: &Path) -> Result<Field, VolumeFileError> {
    let (start, length) = (beginning(path)?, length_of(path)?);
    let wrong = |what: String| {
        damaged(
            path,
            what,
            "give a Mitsuba .vol of version 3, 32-bit floats",
        )
    };
    let number = |at: usize| -> [u8; 4] {
        let mut bytes = [0; 4];
        if let Some(found) = start.get(at..at + 4) {
            bytes.copy_from_slice(found);
        }
        bytes
    };
    if start.len() < HEAD {
        return Err(wrong(format!("{} bytes are no .vol", start.len())));
    }
    if &start[..3] != b"VOL" {
        return Err(wrong("it does not begin with VOL".to_owned()));
    }
    if start[3] != 3 {
        return Err(wrong(format!("it is of version {}", start[3])));
    }
    let encoding = i32::from_le_bytes(number(4));
    if encoding != 1 {
        return Err(wrong(format!("its encoding is {encoding}, not 1")));
    }
    let mut size = [0u32; 3];
    for (axis, size) in size.iter_mut().enumerate() {
        let side = i32::from_le_bytes(number(8 + 4 * axis));
        *size = u32::try_from(side)
            .map_err(|_| wrong(format!("its size has a side of {side} voxels")))?;
    }
    let channels = i32::from_le_bytes(number(20));
    if ![1, 3, 6].contains(&channels) {
        return Err(wrong(format!("it has {channels} channels, not 1, 3 or 6")));
    }
    let corner = |at: usize| [0, 1, 2].map(|k| f32::from_le_bytes(number(at + 4 * k)));
    let bounds = Bounds {
        min: corner(24).into(),
        max: corner(36).into(),
    };
    Field {
        path: path.to_owned(),
        lie: Lie::straight(size, bounds),
        components: channels as u32,
        by_rows: false,
        scalar: Scalar::F32,
        big_endian: false,
        start: Start::At(HEAD as u64),
        unscaled: None,
        warnings: Vec::new(),
    }
    .checked(length)
}
