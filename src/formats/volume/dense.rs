//! Files that hold every voxel at a place known in advance: a head, voxels x fastest,
//! a tail. Boxes of voxels are sampled in any order and put where they belong.

use std::io::{Seek, SeekFrom, Write};
use std::path::PathBuf;

use glam::{UVec3, Vec3};
use rayon::prelude::*;

use super::VolumeFileError;
use crate::atomic::Pending;
use crate::job::Job;
use crate::volume::source::{CellBox, Frame, SourceVoxel, VoxelSource};

/// Voxels that are held at once: 24 bytes each, and what they are encoded to.
const HELD: u32 = 1 << 20;
/// Voxels of a row that are held at once.
const WIDEST: u32 = 1024;
/// Layers of voxels that are held at once.
const DEEPEST: u32 = 512;

/// What of a voxel a file holds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Channel {
    /// Extinction across the fibres, f32, 1/mm.
    Sigma,
    /// Albedo, 3 × f32; 0 in empty space.
    Albedo,
    /// S as 6 × f32: Sxx, Syy, Szz, Sxy, Sxz, Syz.
    Sggx,
    /// Yarn number, i16; −1 in empty space.
    Yarn,
    /// Extinction in units of this much, u16.
    Sigma16(f32),
    /// Yarn number + 1, u16; 0 in empty space.
    Yarn16,
}

impl Channel {
    /// Bytes a voxel.
    pub fn bytes(self) -> u64 {
        match self {
            Self::Sigma => 4,
            Self::Albedo => 12,
            Self::Sggx => 24,
            Self::Yarn | Self::Sigma16(_) | Self::Yarn16 => 2,
        }
    }

    /// Numbers a voxel.
    pub fn components(self) -> u32 {
        match self {
            Self::Albedo => 3,
            Self::Sggx => 6,
            _ => 1,
        }
    }

    fn put(self, voxel: &SourceVoxel, albedos: &[Vec3], out: &mut [u8]) {
        match self {
            Self::Sigma => put_floats(&[voxel.sigma], out),
            Self::Albedo => put_floats(&albedo(voxel, albedos).to_array(), out),
            Self::Sggx => put_floats(&voxel.sggx(), out),
            Self::Yarn => {
                let yarn = i16::try_from(voxel.yarn).unwrap_or(i16::MAX);
                out.copy_from_slice(&yarn.to_le_bytes());
            }
            Self::Sigma16(unit) => {
                let steps = (voxel.sigma / unit).round().clamp(0.0, 65535.0);
                out.copy_from_slice(&(steps as u16).to_le_bytes());
            }
            Self::Yarn16 => {
                let yarn = (voxel.yarn + 1).clamp(0, 65535) as u16;
                out.copy_from_slice(&yarn.to_le_bytes());
            }
        }
    }
}

fn put_floats(values: &[f32], out: &mut [u8]) {
    for (value, out) in values.iter().zip(out.chunks_exact_mut(4)) {
        out.copy_from_slice(&value.to_le_bytes());
    }
}

/// The albedo of a voxel; 0 in empty space.
pub(super) fn albedo(voxel: &SourceVoxel, albedos: &[Vec3]) -> Vec3 {
    usize::try_from(voxel.yarn)
        .ok()
        .and_then(|yarn| albedos.get(yarn))
        .copied()
        .unwrap_or(Vec3::ZERO)
}

/// A file of one channel.
#[derive(Debug, Clone)]
pub(super) struct Layer {
    pub path: PathBuf,
    pub channel: Channel,
    /// What stands before the voxels.
    pub head: Vec<u8>,
    /// What stands behind them.
    pub tail: Vec<u8>,
    /// A small file that describes this one.
    pub header: Option<(PathBuf, Vec<u8>)>,
}

impl Layer {
    /// The files of this layer with their bytes, the one to be opened first.
    pub fn files(&self, frame: &Frame) -> impl Iterator<Item = (PathBuf, u64)> {
        let around = (self.head.len() + self.tail.len()) as u64;
        let voxels = frame.voxels().saturating_mul(self.channel.bytes());
        let header = self.header.as_ref();
        let header = header.map(|(path, bytes)| (path.clone(), bytes.len() as u64));
        let own = (self.path.clone(), voxels.saturating_add(around));
        header.into_iter().chain([own])
    }
}

/// Writes all layers in one go over the voxels; none is put in place before all are whole.
pub(super) fn write(
    source: &dyn VoxelSource,
    layers: Vec<Layer>,
    job: &Job,
) -> Result<Vec<(PathBuf, u64)>, VolumeFileError> {
    let frame = source.frame();
    let mut files: Vec<(Layer, Pending)> = Vec::new();
    for layer in layers {
        let mut pending = Pending::create(&layer.path)?;
        let head = pending.file().write_all(&layer.head);
        head.map_err(|error| pending.failed(error))?;
        files.push((layer, pending));
    }
    let step = tile_of(frame.size);
    let total = frame.voxels().max(1);
    let mut done = 0u64;
    let mut voxels = Vec::new();
    let mut encoded = Vec::new();
    for tile in CellBox::tiles(frame.size, step) {
        job.check()?;
        voxels.clear();
        voxels.resize(tile.voxels(), SourceVoxel::EMPTY);
        source.fill(tile, &mut voxels);
        for (layer, pending) in &mut files {
            encode(layer.channel, &voxels, tile, source.albedos(), &mut encoded);
            let put = put_tile(pending.file(), layer, &frame, tile, &encoded);
            put.map_err(|error| pending.failed(error))?;
        }
        done += tile.voxels() as u64;
        job.report("volume", done as f32 / total as f32);
    }
    let mut written = Vec::new();
    let mut headers = Vec::new();
    for (layer, pending) in &mut files {
        let file = pending.file();
        let tail = (file.seek(SeekFrom::End(0))).and_then(|_| file.write_all(&layer.tail));
        tail.map_err(|error| pending.failed(error))?;
        written.extend(layer.files(&frame));
        if let Some((path, bytes)) = &layer.header {
            let mut header = Pending::create(path)?;
            let put = header.file().write_all(bytes);
            put.map_err(|error| header.failed(error))?;
            headers.push(header);
        }
    }
    job.check()?;
    for (_, pending) in files {
        pending.commit()?;
    }
    for header in headers {
        header.commit()?;
    }
    Ok(written)
}

/// The box that is held at once: long rows, so that what is written is long, but not so
/// long that a box has few of them.
fn tile_of(size: UVec3) -> UVec3 {
    let x = size.x.min(WIDEST);
    let z = size.z.min(DEEPEST);
    UVec3::new(x, (HELD / (x * z)).clamp(1, size.y), z)
}

/// Encodes a box into z-major order.
fn encode(
    channel: Channel,
    voxels: &[SourceVoxel],
    tile: CellBox,
    albedos: &[Vec3],
    out: &mut Vec<u8>,
) {
    let bytes = channel.bytes() as usize;
    let [nx, ny, nz] = tile.size.to_array().map(|side| side as usize);
    out.clear();
    out.resize(voxels.len() * bytes, 0);
    let rows = out.par_chunks_mut(nx * bytes).enumerate();
    rows.for_each(|(row, out)| {
        let (z, y) = (row / ny, row % ny);
        let voxels = &voxels[(y * nz + z) * nx..][..nx];
        for (voxel, out) in voxels.iter().zip(out.chunks_exact_mut(bytes)) {
            channel.put(voxel, albedos, out);
        }
    });
}

/// Puts an encoded box where it belongs, in runs as long as they come.
fn put_tile(
    file: &mut std::fs::File,
    layer: &Layer,
    frame: &Frame,
    tile: CellBox,
    encoded: &[u8],
) -> std::io::Result<()> {
    let bytes = layer.channel.bytes();
    let [nx, ny] = [frame.size.x, frame.size.y].map(u64::from);
    let whole_rows = tile.size.x == frame.size.x;
    let rows = if whole_rows {
        u64::from(tile.size.y)
    } else {
        1
    };
    let run = (u64::from(tile.size.x) * rows * bytes) as usize;
    let per_layer = u64::from(tile.size.y) / rows;
    for (number, run) in encoded.chunks_exact(run).enumerate() {
        let (z, y) = (number as u64 / per_layer, number as u64 % per_layer);
        let [x0, y0, z0] = tile.low.to_array().map(u64::from);
        let place = ((z0 + z) * ny + y0 + y) * nx + x0;
        file.seek(SeekFrom::Start(layer.head.len() as u64 + place * bytes))?;
        file.write_all(run)?;
    }
    Ok(())
}
