//! OpenVDB, file version 224 without compression: grids `density` (float, fog volume),
//! `direction` and `albedo` (vec3s), `roughness` and `yarn` (float), all with the same
//! active voxels, in millimetres: OpenVDB takes a voxel of less than 14.4 µm in metres
//! for a singular transform (its determinant is then below 3·10⁻¹⁵).
//!
//! No installable library writes the format from Rust. A tree is root → 32³ nodes of
//! 4096³ voxels → 16³ nodes of 128³ → leaves of 8³. A file holds a grid's whole topology
//! before its values, so both are gathered in files of their own while the voxels pass
//! through once, 128³ at a time, and are put together at the end: memory is that of one
//! such box, disk is needed twice over.

use std::fs::File;
use std::io::{self, BufWriter, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use glam::{UVec3, Vec3};
use rayon::prelude::*;

use super::dense::albedo;
use super::{Plan, VolumeFileError};
use crate::atomic::{Pending, WriteError, folder_of};
use crate::job::Job;
use crate::volume::source::{CellBox, Frame, NO_YARN, SourceVoxel, VoxelSource};

/// Voxels along the edge of a leaf, a lower node and an upper node.
const LEAF: u32 = 8;
const LOWER: u32 = 128;
const UPPER: u32 = 4096;
/// Bytes of the masks of an upper and a lower node.
const UPPER_MASK: usize = 32 * 32 * 32 / 8;
const LOWER_MASK: usize = 16 * 16 * 16 / 8;
/// Voxels along the edge of a box that is sampled at once.
const HELD: u32 = LOWER;
/// A leaf's mask.
type LeafMask = [u8; 64];

/// A grid of the file.
#[derive(Debug, Clone, Copy)]
struct Grid {
    name: &'static str,
    kind: &'static str,
    /// Bytes of a value.
    bytes: u64,
    /// `class` for fogs, `vector_type` for vectors.
    metadata: Option<(&'static str, &'static str)>,
    /// The value of empty space.
    background: [u8; 4],
    put: fn(&SourceVoxel, &[Vec3], &mut Vec<u8>),
}

const GRIDS: [Grid; 5] = [
    Grid {
        name: "density",
        kind: "Tree_float_5_4_3",
        bytes: 4,
        metadata: Some(("class", "fog volume")),
        background: [0; 4],
        put: |voxel, _, out| out.extend(voxel.sigma.to_le_bytes()),
    },
    Grid {
        name: "direction",
        kind: "Tree_vec3s_5_4_3",
        bytes: 12,
        metadata: Some(("vector_type", "contravariant relative")),
        background: [0; 4],
        put: |voxel, _, out| put_vector(voxel.direction, out),
    },
    Grid {
        name: "albedo",
        kind: "Tree_vec3s_5_4_3",
        bytes: 12,
        metadata: Some(("vector_type", "invariant")),
        background: [0; 4],
        put: |voxel, albedos, out| put_vector(albedo(voxel, albedos), out),
    },
    Grid {
        name: "roughness",
        kind: "Tree_float_5_4_3",
        bytes: 4,
        metadata: None,
        background: [0; 4],
        put: |voxel, _, out| out.extend(voxel.alpha.to_le_bytes()),
    },
    Grid {
        name: "yarn",
        // Debian's Python cannot read whole numbers; floats hold yarns exactly.
        kind: "Tree_float_5_4_3",
        bytes: 4,
        metadata: None,
        background: (NO_YARN as f32).to_le_bytes(),
        put: |voxel, _, out| out.extend((voxel.yarn as f32).to_le_bytes()),
    },
];

fn put_vector(vector: Vec3, out: &mut Vec<u8>) {
    for value in vector.to_array() {
        out.extend(value.to_le_bytes());
    }
}

/// Bytes a leaf adds to the topology and the values of a grid, its values aside.
const LEAF_BYTES: f64 = 64.0 + 65.0;

/// What writing will make, given the share of voxels with matter.
pub(super) fn plan(frame: &Frame, filled: f64, path: &Path) -> Result<Plan, VolumeFileError> {
    if frame.size.max_element() > 1 << 30 {
        return Err(VolumeFileError::TooLarge {
            path: path.to_owned(),
            what: format!("a tree of {} voxels along a side", frame.size.max_element()),
        });
    }
    let voxels = frame.voxels() as f64;
    let values: u64 = GRIDS.iter().map(|grid| grid.bytes).sum();
    // Leaves with a single voxel count whole: a fifth more than are full.
    let leaves = voxels / 512.0 * (1.2 * filled).min(1.0) + 1.0;
    let bytes = voxels * filled * values as f64 + leaves * LEAF_BYTES * GRIDS.len() as f64;
    let nodes = (UPPER_MASK + LOWER_MASK) as f64 * 2.0 * GRIDS.len() as f64;
    let bytes = (bytes + nodes) as u64;
    Ok(Plan {
        voxels: frame.voxels(),
        files: vec![(path.to_owned(), bytes)],
        exact: false,
        needed: bytes.saturating_mul(2),
        seconds: 0.0,
    })
}

/// Writes the file.
pub(super) fn write(
    source: &dyn VoxelSource,
    path: &Path,
    job: &Job,
) -> Result<Vec<(PathBuf, u64)>, VolumeFileError> {
    let failed = |source| WriteError {
        path: path.to_owned(),
        source,
    };
    let mut pending = Pending::create(path)?;
    let mut parts = Parts::new(folder_of(path)).map_err(failed)?;
    parts.gather(source, path, job)?;
    job.check()?;
    let length = (parts.assemble(&source.frame(), pending.file())).map_err(failed)?;
    job.check()?;
    pending.commit()?;
    Ok(vec![(path.to_owned(), length)])
}

/// A file without a name that is gone when it is closed.
struct Scratch(BufWriter<File>);

impl Scratch {
    fn new(folder: &Path) -> io::Result<Self> {
        let file = tempfile::tempfile_in(folder)?;
        Ok(Self(BufWriter::with_capacity(1 << 18, file)))
    }

    /// Appends all of it to `out` and says how many bytes that were.
    fn pour(&mut self, out: &mut File) -> io::Result<u64> {
        self.0.flush()?;
        let file = self.0.get_mut();
        file.seek(SeekFrom::Start(0))?;
        io::copy(file, out)
    }
}

/// The parts of the file while they grow.
struct Parts {
    /// Upper nodes with all below them, the same for all grids.
    topology: Scratch,
    /// Upper nodes.
    uppers: u32,
    /// The leaves' masks and values, by grid.
    values: Vec<Scratch>,
}

impl Parts {
    fn new(folder: &Path) -> io::Result<Self> {
        let values = GRIDS
            .iter()
            .map(|_| Scratch::new(folder))
            .collect::<io::Result<_>>()?;
        Ok(Self {
            topology: Scratch::new(folder)?,
            uppers: 0,
            values,
        })
    }

    /// Runs through all voxels in the order of the tree: x slowest.
    fn gather(
        &mut self,
        source: &dyn VoxelSource,
        path: &Path,
        job: &Job,
    ) -> Result<(), VolumeFileError> {
        let size = source.frame().size;
        let total = source.frame().voxels().max(1) as f64;
        let mut done = 0.0f64;
        let mut voxels = Vec::new();
        for upper in tree_order(UVec3::ZERO, size, UPPER) {
            let end = (upper + UPPER).min(size);
            let mut open = None;
            for low in tree_order(upper, end, LOWER) {
                job.check()?;
                let cells = CellBox {
                    low,
                    size: (end - low).min(UVec3::splat(HELD)),
                };
                voxels.clear();
                voxels.resize(cells.voxels(), SourceVoxel::EMPTY);
                source.fill(cells, &mut voxels);
                self.lower(&mut open, upper, cells, &voxels, source.albedos())
                    .map_err(|source| WriteError {
                        path: path.to_owned(),
                        source,
                    })?;
                done += cells.voxels() as f64;
                job.report("volume", (done / total) as f32);
            }
            self.close(open).map_err(|source| WriteError {
                path: path.to_owned(),
                source,
            })?;
        }
        Ok(())
    }

    /// Takes the voxels of one lower node.
    fn lower(
        &mut self,
        open: &mut Option<OpenUpper>,
        upper: UVec3,
        cells: CellBox,
        voxels: &[SourceVoxel],
        albedos: &[Vec3],
    ) -> io::Result<()> {
        let places: Vec<UVec3> = tree_order(UVec3::ZERO, cells.size, LEAF).collect();
        let leaves: Vec<Option<Leaf>> = places
            .into_par_iter()
            .map(|place| Leaf::of(cells.size, voxels, place, albedos))
            .collect();
        let mut children = [0u8; LOWER_MASK];
        let mut masks: Vec<LeafMask> = Vec::new();
        for leaf in leaves.into_iter().flatten() {
            let place = leaf.low / LEAF;
            set(&mut children, (place.x << 8) | (place.y << 4) | place.z);
            masks.push(leaf.mask);
            for (values, scratch) in leaf.values.iter().zip(&mut self.values) {
                scratch.0.write_all(values)?;
            }
        }
        if masks.is_empty() {
            return Ok(());
        }
        let out = &mut self.topology.0;
        let node = match open {
            Some(node) => node,
            None => {
                self.uppers += 1;
                for place in upper.to_array() {
                    out.write_all(&(place as i32).to_le_bytes())?;
                }
                let masks_at = out.stream_position()?;
                // The children's mask is known when the node ends; no tile is active.
                out.write_all(&[0; 2 * UPPER_MASK + 1])?;
                open.insert(OpenUpper {
                    masks_at,
                    children: vec![0; UPPER_MASK],
                })
            }
        };
        let place = (cells.low - upper) / LOWER;
        set(
            &mut node.children,
            (place.x << 10) | (place.y << 5) | place.z,
        );
        out.write_all(&children)?;
        out.write_all(&[0; LOWER_MASK + 1])?;
        masks.iter().try_for_each(|mask| out.write_all(mask))
    }

    /// Ends an upper node: its mask goes where room was left.
    fn close(&mut self, open: Option<OpenUpper>) -> io::Result<()> {
        let Some(node) = open else {
            return Ok(());
        };
        let out = &mut self.topology.0;
        let end = out.stream_position()?;
        out.seek(SeekFrom::Start(node.masks_at))?;
        out.write_all(&node.children)?;
        out.seek(SeekFrom::Start(end))?;
        Ok(())
    }

    /// Puts the file together and gives its length.
    fn assemble(&mut self, frame: &Frame, out: &mut File) -> io::Result<u64> {
        out.write_all(&file_head())?;
        for (grid, values) in GRIDS.iter().zip(&mut self.values) {
            let mut head = Vec::new();
            put_text(grid.name, &mut head);
            put_text(grid.kind, &mut head);
            put_text("", &mut head);
            out.write_all(&head)?;
            let places_at = out.stream_position()?;
            out.write_all(&[0; 24])?;
            let grid_at = out.stream_position()?;
            out.write_all(&grid_head(grid, frame, self.uppers))?;
            self.topology.pour(out)?;
            let values_at = out.stream_position()?;
            values.pour(out)?;
            let end = out.stream_position()?;
            out.seek(SeekFrom::Start(places_at))?;
            for place in [grid_at, values_at, end] {
                out.write_all(&place.to_le_bytes())?;
            }
            out.seek(SeekFrom::Start(end))?;
        }
        out.stream_position()
    }
}

/// An upper node that is being written.
struct OpenUpper {
    /// Where its masks stand in the topology.
    masks_at: u64,
    children: Vec<u8>,
}

/// The lower corners of cubes of an edge between two corners, x slowest, z fastest.
fn tree_order(low: UVec3, end: UVec3, edge: u32) -> impl Iterator<Item = UVec3> {
    let along = move |axis: usize| (low[axis]..end[axis]).step_by(edge as usize);
    along(0)
        .flat_map(move |x| along(1).flat_map(move |y| along(2).map(move |z| UVec3::new(x, y, z))))
}

fn set(mask: &mut [u8], bit: u32) {
    mask[bit as usize / 8] |= 1 << (bit % 8);
}

/// A leaf with matter.
struct Leaf {
    low: UVec3,
    mask: LeafMask,
    /// Mask and active values as they stand in the file, by grid.
    values: [Vec<u8>; GRIDS.len()],
}

impl Leaf {
    /// The leaf of a box of voxels, if any of its voxels is active.
    fn of(size: UVec3, voxels: &[SourceVoxel], low: UVec3, albedos: &[Vec3]) -> Option<Self> {
        let mut mask = [0; 64];
        let mut active = Vec::new();
        let end = (low + LEAF).min(size);
        for cell in tree_order(low, end, 1) {
            // Boxes are filled x fastest, then z, then y.
            let place = (cell.y as usize * size.z as usize + cell.z as usize) * size.x as usize;
            let voxel = &voxels[place + cell.x as usize];
            if voxel.sigma > 0.0 {
                let inside = cell - low;
                set(&mut mask, (inside.x << 6) | (inside.y << 3) | inside.z);
                active.push(voxel);
            }
        }
        if active.is_empty() {
            return None;
        }
        let values = GRIDS.map(|grid| {
            let mut bytes = Vec::with_capacity(65 + active.len() * grid.bytes as usize);
            bytes.extend(mask);
            // What is not active has the background's value and is not stored.
            bytes.push(0);
            for voxel in &active {
                (grid.put)(voxel, albedos, &mut bytes);
            }
            bytes
        });
        Some(Self { low, mask, values })
    }
}

/// A text with its length before it.
fn put_text(text: &str, out: &mut Vec<u8>) {
    out.extend((text.len() as u32).to_le_bytes());
    out.extend(text.as_bytes());
}

fn file_head() -> Vec<u8> {
    let mut head = 0x5644_4220_i64.to_le_bytes().to_vec();
    // File version, version of the library that could have written it, grid offsets.
    for number in [224u32, 10, 0] {
        head.extend(number.to_le_bytes());
    }
    head.push(1);
    // An identifier that readers compare with another file's of the same name only.
    head.extend(b"70696b67-6c61-4373-8000-766f6c756d65");
    head.extend(0u32.to_le_bytes());
    head.extend((GRIDS.len() as u32).to_le_bytes());
    head
}

/// Everything of a grid before its upper nodes.
fn grid_head(grid: &Grid, frame: &Frame, uppers: u32) -> Vec<u8> {
    let mut head = 2u32.to_le_bytes().to_vec();
    let mut metadata = vec![
        ("name", grid.name),
        ("creator", "Pickglass"),
        ("length_unit", "mm"),
    ];
    metadata.extend(grid.metadata);
    head.extend((metadata.len() as u32).to_le_bytes());
    for (key, value) in metadata {
        put_text(key, &mut head);
        put_text("string", &mut head);
        put_text(value, &mut head);
    }
    put_text("UniformScaleTranslateMap", &mut head);
    let edge = frame.edge_mm;
    // Index 0 is the centre of the first voxel.
    let origin = frame.origin_mm + 0.5 * edge;
    let triples = [
        origin.to_array(),
        [edge; 3],
        [edge; 3],
        [1.0 / edge; 3],
        [1.0 / (edge * edge); 3],
        [0.5 / edge; 3],
    ];
    for number in triples.into_iter().flatten() {
        head.extend(number.to_le_bytes());
    }
    head.extend(1i32.to_le_bytes());
    for _ in 0..grid.bytes / 4 {
        head.extend(grid.background);
    }
    // No tiles at the root.
    head.extend(0u32.to_le_bytes());
    head.extend(uppers.to_le_bytes());
    head
}
