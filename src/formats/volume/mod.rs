//! Voxels out and in: Mitsuba `.vol`, OpenVDB `.vdb`, `.nrrd`, MetaImage and TIFF stacks.
//!
//! [`plan`] says which files a window makes and how large they are; [`write()`] makes them,
//! box by box, so that memory does not grow with the window, and puts them in place only
//! when all are whole. [`read`] makes a grid of `.vol`, `.nrrd`, `.nhdr`, `.mhd` and `.mha`,
//! which the tracer renders like any other medium. One file a format:
//!
//! | ending | files | channels |
//! |---|---|---|
//! | `.vol` | `NAME.vol`, `NAME.albedo.vol`, `NAME.sggx.vol` | σ, albedo, S |
//! | `.nrrd` | `NAME.nrrd`, `NAME.albedo.nrrd`, `NAME.sggx.nrrd`, `NAME.yarn.nrrd` | and yarn |
//! | `.mhd` | the same, each a header and a `.raw` | and yarn |
//! | `.tif` | `NAME.tif`, `NAME.yarn.tif`, one page a layer | σ in 16 bits, yarn |
//! | `.vdb` | one | density, direction, albedo, roughness, yarn |

mod axes;
mod dense;
mod fields;
mod meta_image;
pub mod mitsuba;
mod nrrd;
mod nrrd_head;
mod read;
mod tiff_stack;
mod units;
mod vdb;
mod vol;

use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;

use crate::atomic::{Pending, WriteError, folder_of};
use crate::job::{Cancelled, Job};
use crate::memory::TooMuch;
use crate::volume::VolumeError;
use crate::volume::source::{CellBox, SourceVoxel, VoxelSource};

pub use meta_image::FIELDS as META_IMAGE_FIELDS;
pub use nrrd_head::FIELDS as NRRD_FIELDS;
pub use read::{GridFile, files_read, read, read_scaled};
pub use vol::FIELDS as VOL_FIELDS;

/// The formats.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum VolumeFormat {
    /// Mitsuba's grids.
    Vol,
    /// OpenVDB.
    Vdb,
    /// Nearly raw raster data, of Teem, ITK and Slicer.
    Nrrd,
    /// MetaImage, of ITK and ParaView.
    MetaImage,
    /// A page a layer.
    Tiff,
}

impl VolumeFormat {
    /// The format in which a file of this ending is written.
    pub fn of(path: &Path) -> Option<Self> {
        let ending = path.extension()?.to_str()?.to_ascii_lowercase();
        Some(match ending.as_str() {
            "vol" => Self::Vol,
            "vdb" => Self::Vdb,
            "nrrd" => Self::Nrrd,
            "mhd" => Self::MetaImage,
            "tif" | "tiff" => Self::Tiff,
            _ => return None,
        })
    }

    /// The format of a volume that is opened, by its ending. A `.tif` is an image then.
    pub fn opened(path: &Path) -> Option<Self> {
        let ending = path.extension()?.to_str()?.to_ascii_lowercase();
        Some(match ending.as_str() {
            "nhdr" => Self::Nrrd,
            "mha" => Self::MetaImage,
            _ => return Self::of(path).filter(|format| *format != Self::Tiff),
        })
    }
}

/// A volume that could not be written or read: one line with the file, what is wrong and
/// what to do.
#[derive(Debug, thiserror::Error)]
pub enum VolumeFileError {
    /// The owner cancelled the work; nothing was left behind.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// A file could not be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// A name whose ending is not a format.
    #[error("{}: volumes are written as .vol, .vdb, .nrrd, .mhd or .tif; end the name in one of them", .0.display())]
    Ending(PathBuf),
    /// A format that is only written.
    #[error(
        "{}: volumes are read as .vol, .nrrd, .nhdr, .mhd or .mha; convert it first", .0.display()
    )]
    NotRead(PathBuf),
    /// More memory than there is for it.
    #[error(transparent)]
    Memory(#[from] TooMuch),
    /// More than the disk holds.
    #[error(
        "{}: the volume needs {} and the disk has {} left; choose a smaller region, fewer voxels \
         a crossing or another disk", path.display(), bytes_in_words(*needed), bytes_in_words(*free)
    )]
    NoSpace {
        /// The file.
        path: PathBuf,
        /// Bytes that it needs while it is written.
        needed: u64,
        /// Bytes that are free.
        free: u64,
    },
    /// More than the format or a reader can hold.
    #[error("{}: {what}; choose a smaller region or fewer voxels a crossing", path.display())]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// What is too large.
        what: String,
    },
    /// A file could not be read.
    #[error("cannot read {}: {why}; check the name and that you may read it", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What the system said; not a source, which would be said again.
        why: std::io::Error,
    },
    /// A file that is not what its ending says, or damaged.
    #[error("{}: {what}; {remedy}", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What is wrong where.
        what: String,
        /// What to do.
        remedy: &'static str,
    },
    /// Voxels that make no grid.
    #[error("{}: {why}", path.display())]
    Grid {
        /// The file.
        path: PathBuf,
        /// Why; not a source, which would be said again.
        why: VolumeError,
    },
}

/// A size for people.
pub fn bytes_in_words(bytes: u64) -> String {
    let bytes = bytes as f64;
    match bytes {
        b if b >= 1e12 => format!("{:.1} TB", b / 1e12),
        b if b >= 1e9 => format!("{:.1} GB", b / 1e9),
        b if b >= 1e6 => format!("{:.1} MB", b / 1e6),
        b => format!("{:.0} kB", (b / 1e3).ceil()),
    }
}

/// A small file that is written with a volume.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Attachment {
    /// Where.
    pub path: PathBuf,
    /// What.
    pub bytes: Vec<u8>,
}

/// What writing a volume will make.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// Voxels in the window.
    pub voxels: u64,
    /// The files, in the order in which they are named to the user, with their bytes.
    pub files: Vec<(PathBuf, u64)>,
    /// Whether the bytes are exact; a sparse file's are estimated from a few layers.
    pub exact: bool,
    /// Bytes of disk that are needed while it is written.
    pub needed: u64,
    /// Seconds it will take, roughly: measured on a few voxels; writing at 500 MB/s.
    pub seconds: f64,
}

impl Plan {
    /// Bytes of all files.
    pub fn bytes(&self) -> u64 {
        self.files.iter().map(|file| file.1).sum()
    }
}

/// What was written.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Written {
    /// Voxels in the window.
    pub voxels: u64,
    /// Bytes of all files.
    pub bytes: u64,
    /// The files.
    pub files: Vec<PathBuf>,
}

/// Says what [`write()`] will make at `path`, and refuses what does not fit on the disk.
///
/// # Errors
/// When the ending is no format, the folder is missing, or the volume is too large.
pub fn plan(
    source: &dyn VoxelSource,
    path: &Path,
    attached: &[Attachment],
) -> Result<Plan, VolumeFileError> {
    let format = VolumeFormat::of(path).ok_or_else(|| VolumeFileError::Ending(path.to_owned()))?;
    let frame = source.frame();
    let probe = Probe::of(source);
    let mut plan = match format {
        VolumeFormat::Vdb => vdb::plan(&frame, probe.filled, path)?,
        _ => {
            let layers = dense_layers(format, source, path)?;
            let files: Vec<_> = (layers.iter().flat_map(|layer| layer.files(&frame))).collect();
            let needed = files.iter().map(|file| file.1).fold(0, u64::saturating_add);
            Plan {
                voxels: frame.voxels(),
                files,
                exact: true,
                needed,
                seconds: 0.0,
            }
        }
    };
    for attachment in attached {
        let bytes = attachment.bytes.len() as u64;
        plan.files.push((attachment.path.clone(), bytes));
        plan.needed = plan.needed.saturating_add(bytes);
    }
    plan.seconds = plan.voxels as f64 * probe.seconds_a_voxel + plan.needed as f64 / 5e8;
    let folder = folder_of(path);
    let free = fs4::available_space(folder).map_err(|source| WriteError {
        path: path.to_owned(),
        source,
    })?;
    if plan.needed > free {
        return Err(VolumeFileError::NoSpace {
            path: path.to_owned(),
            needed: plan.needed,
            free,
        });
    }
    Ok(plan)
}

/// Writes a volume in the format of the ending of `path` and what is attached to it; all
/// files or none.
///
/// # Errors
/// As [`plan`]; also when a file cannot be written or the job is cancelled, and then
/// nothing is left behind.
pub fn write(
    source: &dyn VoxelSource,
    path: &Path,
    attached: &[Attachment],
    job: &Job,
) -> Result<Written, VolumeFileError> {
    let format = VolumeFormat::of(path).ok_or_else(|| VolumeFileError::Ending(path.to_owned()))?;
    let mut pending = Vec::new();
    for attachment in attached {
        let mut file = Pending::create(&attachment.path)?;
        let put = file.file().write_all(&attachment.bytes);
        put.map_err(|error| file.failed(error))?;
        pending.push(file);
    }
    let mut files = match format {
        VolumeFormat::Vdb => vdb::write(source, path, job)?,
        _ => dense::write(source, dense_layers(format, source, path)?, job)?,
    };
    for (file, attachment) in pending.into_iter().zip(attached) {
        file.commit()?;
        files.push((attachment.path.clone(), attachment.bytes.len() as u64));
    }
    Ok(Written {
        voxels: source.frame().voxels(),
        bytes: files.iter().map(|file| file.1).sum(),
        files: files.into_iter().map(|file| file.0).collect(),
    })
}

fn dense_layers(
    format: VolumeFormat,
    source: &dyn VoxelSource,
    path: &Path,
) -> Result<Vec<dense::Layer>, VolumeFileError> {
    match format {
        VolumeFormat::Vol => vol::layers(&source.frame(), path),
        VolumeFormat::Nrrd => nrrd::layers(&source.frame(), path),
        VolumeFormat::MetaImage => meta_image::layers(&source.frame(), path),
        _ => tiff_stack::layers(&source.frame(), source.densest(), path),
    }
}

/// `NAME.part.ending` beside `NAME.ending`.
fn beside(path: &Path, part: &str) -> PathBuf {
    let ending = path.extension().unwrap_or_default().to_string_lossy();
    path.with_extension(format!("{part}.{ending}"))
}

/// What a few voxels tell of all.
struct Probe {
    seconds_a_voxel: f64,
    /// Share of voxels with matter.
    filled: f64,
}

impl Probe {
    /// Fills a few upright boxes spread over the frame.
    fn of(source: &dyn VoxelSource) -> Self {
        let size = source.frame().size;
        let edge = size.min(glam::UVec3::new(64, 64, 256));
        let begun = Instant::now();
        let (mut voxels, mut filled) = (0u64, 0u64);
        for k in 0..3u32 {
            let room = size - edge;
            // Along the diagonal, and a third round from it on the other axes.
            let low = glam::UVec3::new(room.x / 2 * k, room.y / 2 * (k * 2 % 3), room.z / 2);
            let cells = CellBox { low, size: edge };
            let mut out = vec![SourceVoxel::EMPTY; cells.voxels()];
            source.fill(cells, &mut out);
            voxels += out.len() as u64;
            filled += out.iter().filter(|voxel| voxel.sigma > 0.0).count() as u64;
        }
        let voxels = voxels.max(1) as f64;
        Self {
            seconds_a_voxel: begun.elapsed().as_secs_f64() / voxels,
            filled: filled as f64 / voxels,
        }
    }
}
