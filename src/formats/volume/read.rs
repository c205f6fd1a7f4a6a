//! Volumes in: the extinction, and beside it albedo and S where they are, become a grid.

use std::collections::HashMap;
use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use glam::{UVec3, Vec3};

use super::fields::{Field, Rows, in_words};
use super::{VolumeFileError, VolumeFormat, beside, meta_image, nrrd, vol};
use crate::job::Job;
use crate::memory;
use crate::volume::source::fibres_of;
use crate::volume::{DenseGrid, GridVoxel, Optics, Taps, VolumeError};

/// Albedo where none is given.
const GREY: f32 = 0.8;
/// Steps of albedo and α that are told apart, tried in order until the colours are few
/// enough.
const STEPS: [f32; 3] = [4095.0, 255.0, 31.0];
/// Most colours that are told apart.
const MOST_OPTICS: usize = 32_767;
/// S that differs this much from that of fibres is remarked on.
const UNLIKE: f32 = 0.05;
/// Optical depth of an opaque voxel: a millionth of the light passes.
const OPAQUE: f32 = 13.815_511;
/// Longest head that is looked for.
const LONGEST_HEAD: u64 = 1 << 16;

/// A grid that was read.
#[derive(Debug)]
pub struct GridFile {
    /// The grid.
    pub grid: DenseGrid,
    /// One line each: what was absent or mended.
    pub warnings: Vec<String>,
}

pub(super) fn damaged(path: &Path, what: String, remedy: &'static str) -> VolumeFileError {
    VolumeFileError::Damaged {
        path: path.to_owned(),
        what,
        remedy,
    }
}

/// As [`read_scaled`] for files that say how large a voxel is.
///
/// # Errors
/// As [`read_scaled`].
pub fn read(path: &Path, taps: Taps, job: &Job) -> Result<GridFile, VolumeFileError> {
    read_scaled(path, taps, None, job)
}

/// Reads `NAME.vol`, `.nrrd`, `.nhdr`, `.mhd` or `.mha` (extinction in 1/mm, lengths in mm
/// unless the file names another unit) with `NAME.albedo.…` and `NAME.sggx.…` beside it.
/// Without them the voxels are grey and isotropic, and that is remarked on. An S that is not
/// of fibres becomes the nearest one. `voxel_mm` is the edge of a voxel along x, for files
/// that do not say it or say it wrong.
///
/// # Errors
/// One line where a file cannot be read, is damaged or too large, or the files do not
/// belong together. Sizes are checked against the files before memory is asked for.
pub fn read_scaled(
    path: &Path,
    taps: Taps,
    voxel_mm: Option<f64>,
    job: &Job,
) -> Result<GridFile, VolumeFileError> {
    let format = VolumeFormat::opened(path);
    let format = format.ok_or_else(|| VolumeFileError::NotRead(path.to_owned()))?;
    let mut warnings = Vec::new();
    let sigma = extinction(format, path, voxel_mm, &mut warnings)?;
    let size = sigma.lie.size;
    let albedo = part(
        format,
        path,
        ("albedo", 3, "grey of albedo 0.8"),
        &sigma,
        &mut warnings,
    )?;
    let sggx = part(
        format,
        path,
        ("sggx", 6, "isotropic voxels"),
        &sigma,
        &mut warnings,
    )?;
    let extent = sigma.lie.bounds.max - sigma.lie.bounds.min;
    let mut fields = Fields {
        sigma: sigma.open()?,
        albedo: albedo.as_ref().map(Field::open).transpose()?,
        sggx: sggx.as_ref().map(Field::open).transpose()?,
        edge: (extent / size.as_vec3()).min_element(),
        unlike: 0,
        opaque: 0,
    };
    let (palette, filled) = Palette::of(&mut fields, size, job)?
        .ok_or_else(|| grid_error(path, VolumeError::TooManyOptics(MOST_OPTICS + 1)))?;
    memory::ask(DenseGrid::bytes(size, filled), || {
        path.display().to_string()
    })?;
    (fields.unlike, fields.opaque) = (0, 0);
    let grid = DenseGrid::from_fn(size, sigma.lie.bounds, palette.list.clone(), taps, |cell| {
        let Some(voxel) = fields.voxel(cell) else {
            // NaN and negative numbers are the grid's to mend and to count.
            let [sigma] = fields.sigma.at(cell);
            return GridVoxel {
                sigma,
                ..GridVoxel::EMPTY
            };
        };
        GridVoxel {
            sigma: voxel.sigma,
            direction: voxel.direction,
            optics: palette
                .known
                .get(&palette.key(&voxel))
                .copied()
                .unwrap_or(0),
        }
    })
    .map_err(|source| grid_error(path, source))?;
    fields.finish()?;
    job.check()?;
    fields.remarks(&mut warnings);
    let mended = grid.mended();
    if mended.extinctions > 0 {
        warnings.push(format!(
            "{} negative or no number: taking 0",
            counted(mended.extinctions, "extinction")
        ));
    }
    if mended.materials > 0 {
        warnings.push(format!(
            "{} outside 0 to 1 or no number: taking the nearest",
            counted(mended.materials, "albedo")
        ));
    }
    Ok(GridFile { grid, warnings })
}

/// The files that [`read_scaled`] reads for a volume: its head, those beside it, and the files
/// their voxels are in.
pub fn files_read(path: &Path) -> Vec<PathBuf> {
    let mut files = vec![path.to_owned()];
    files.extend(["albedo", "sggx"].map(|part| beside(path, part)));
    if let Some(format) = VolumeFormat::opened(path) {
        let voxels: Vec<PathBuf> = (files.iter())
            .filter_map(|head| Some(open(format, head).ok()?.path))
            .collect();
        files.extend(voxels);
    }
    files
}

/// So many of them were.
fn counted(number: u64, of: &str) -> String {
    match number {
        1 => format!("1 {of} was"),
        _ => format!("{number} {of}s were"),
    }
}

/// The head of the extinction, to the scale that is known.
fn extinction(
    format: VolumeFormat,
    path: &Path,
    voxel_mm: Option<f64>,
    warnings: &mut Vec<String>,
) -> Result<Field, VolumeFileError> {
    let mut sigma = open(format, path)?;
    if sigma.components != 1 {
        let what = format!("it has {} numbers a voxel, not 1", sigma.components);
        return Err(damaged(path, what, "give the file of the extinction"));
    }
    match voxel_mm {
        Some(edge) => sigma.lie.scaled(edge),
        None => {
            if let Some(why) = &sigma.unscaled {
                warnings.push(format!(
                    "{}: {why}; --voxel gives the edge of a voxel in mm",
                    path.display()
                ));
            }
        }
    }
    if let Some([x, y, z]) = sigma.lie.far {
        warnings.push(format!(
            "{}: its box begins at ({x}, {y}, {z}) mm, too far away for voxels of its size: \
             taking it to begin at 0",
            path.display()
        ));
    }
    say(&sigma.warnings, path, warnings);
    Ok(sigma)
}

/// Says what of a file was not followed.
fn say(remarks: &[String], path: &Path, warnings: &mut Vec<String>) {
    let remarks = remarks.iter();
    warnings.extend(remarks.map(|remark| format!("{}: {remark}", path.display())));
}

/// The head of a file beside the extinction, if it is there.
fn part(
    format: VolumeFormat,
    path: &Path,
    (name, components, instead): (&str, u32, &str),
    sigma: &Field,
    warnings: &mut Vec<String>,
) -> Result<Option<Field>, VolumeFileError> {
    let path = beside(path, name);
    if !path.exists() {
        let file = path.display();
        warnings.push(format!("{file} is not there: taking {instead}"));
        return Ok(None);
    }
    let field = open(format, &path)?;
    if field.components != components || field.lie.size != sigma.lie.size {
        let what = format!(
            "it has {} of {} numbers and the extinction {}",
            in_words(field.lie.size),
            field.components,
            in_words(sigma.lie.size)
        );
        let remedy = "give files that were written together";
        return Err(damaged(&path, what, remedy));
    }
    say(&field.warnings, &path, warnings);
    Ok(Some(field))
}

fn grid_error(path: &Path, source: VolumeError) -> VolumeFileError {
    VolumeFileError::Grid {
        path: path.to_owned(),
        why: source,
    }
}

/// What the head of a file says.
fn open(format: VolumeFormat, path: &Path) -> Result<Field, VolumeFileError> {
    match format {
        VolumeFormat::Vol => vol::field(path),
        VolumeFormat::Nrrd => nrrd::field(path),
        VolumeFormat::MetaImage => meta_image::field(path),
        VolumeFormat::Vdb | VolumeFormat::Tiff => Err(VolumeFileError::NotRead(path.to_owned())),
    }
}

fn unreadable(path: &Path) -> impl Fn(std::io::Error) -> VolumeFileError + '_ {
    |why| VolumeFileError::Unreadable {
        path: path.to_owned(),
        why,
    }
}

/// The first bytes of a file, in which its head is.
pub(super) fn beginning(path: &Path) -> Result<Vec<u8>, VolumeFileError> {
    let about = std::fs::metadata(path).map_err(unreadable(path))?;
    if !about.is_file() {
        // A pipe would wait for its other end, and volumes are read here and there.
        let why = std::io::Error::other("it is no regular file: copy it into one");
        return Err(unreadable(path)(why));
    }
    let file = File::open(path).map_err(unreadable(path))?;
    let mut start = Vec::new();
    (file.take(LONGEST_HEAD).read_to_end(&mut start)).map_err(unreadable(path))?;
    Ok(start)
}

/// Bytes of a file.
pub(super) fn length_of(path: &Path) -> Result<u64, VolumeFileError> {
    let about = std::fs::metadata(path).map_err(unreadable(path))?;
    Ok(about.len())
}

/// Where so many lines end, counted from a place in a file; `None` where there are fewer.
pub(super) fn behind_lines(
    path: &Path,
    from: u64,
    lines: u64,
) -> Result<Option<u64>, VolumeFileError> {
    if lines == 0 {
        return Ok(Some(from));
    }
    let mut file = File::open(path).map_err(unreadable(path))?;
    (file.seek(SeekFrom::Start(from))).map_err(unreadable(path))?;
    let (mut left, mut place) = (lines, from);
    let mut bytes = vec![0; 1 << 16];
    loop {
        let read = file.read(&mut bytes).map_err(unreadable(path))?;
        if read == 0 {
            return Ok(None);
        }
        for &byte in &bytes[..read] {
            place += 1;
            left -= u64::from(byte == b'\n');
            if left == 0 {
                return Ok(Some(place));
            }
        }
    }
}

/// What is read of a voxel with matter.
struct Matter {
    sigma: f32,
    direction: Vec3,
    alpha: f32,
    albedo: Vec3,
}

struct Fields {
    sigma: Rows,
    albedo: Option<Rows>,
    sggx: Option<Rows>,
    /// Shortest edge of a voxel, mm.
    edge: f32,
    /// Voxels whose S is far from that of fibres.
    unlike: u64,
    /// Voxels whose extinction was cut to where they are opaque.
    opaque: u64,
}

impl Fields {
    /// The voxel of a cell, if it has matter.
    fn voxel(&mut self, cell: UVec3) -> Option<Matter> {
        let [sigma] = self.sigma.at(cell);
        if !(sigma > 0.0) {
            return None;
        }
        let albedo = match &mut self.albedo {
            Some(rows) => Vec3::from_array(rows.at::<3>(cell)),
            None => Vec3::splat(GREY),
        };
        let s = match &mut self.sggx {
            Some(rows) => rows.at::<6>(cell),
            None => [1.0, 1.0, 1.0, 0.0, 0.0, 0.0],
        };
        let (scale, direction, alpha, unlike) = match fibres_of(s) {
            Some(fibres) => fibres,
            None => (1.0, Vec3::Z, 1.0, 1.0),
        };
        self.unlike += u64::from(unlike > UNLIKE);
        // More than this no light tells from it, and it costs steps without end.
        let opaque = OPAQUE / (self.edge * alpha);
        let sigma = sigma * scale;
        self.opaque += u64::from(sigma > opaque);
        Some(Matter {
            sigma: sigma.min(opaque),
            direction,
            alpha,
            albedo,
        })
    }

    /// Says what was replaced.
    fn remarks(&self, warnings: &mut Vec<String>) {
        if self.unlike > 0 {
            let voxels = counted(self.unlike, "voxel");
            warnings.push(format!("{voxels} not of fibres: taking the nearest fibres"));
        }
        if self.opaque > 0 {
            warnings.push(format!(
                "{} so large that a voxel is opaque several times over: taking {:.3e} 1/mm, where \
                 it is opaque, and more along fibres",
                counted(self.opaque, "extinction"),
                OPAQUE / self.edge
            ));
        }
    }

    fn finish(&mut self) -> Result<(), VolumeFileError> {
        self.sigma.finish()?;
        for rows in self.albedo.iter_mut().chain(self.sggx.iter_mut()) {
            rows.finish()?;
        }
        Ok(())
    }
}

/// Voxels along the edge of a brick of the grid.
const BRICK: u32 = 4;

/// The number of the brick that a cell is in.
fn brick(size: UVec3, cell: UVec3) -> usize {
    let (bricks, at) = ((size + BRICK - 1) / BRICK, cell / BRICK);
    let row = u64::from(at.z) * u64::from(bricks.y) + u64::from(at.y);
    (row * u64::from(bricks.x) + u64::from(at.x)) as usize
}

/// The colours and roughnesses that occur.
struct Palette {
    steps: f32,
    known: HashMap<[u16; 4], u32>,
    list: Vec<Optics>,
}

impl Palette {
    /// Those of a file, and how many bricks of voxels have matter; `None` when even coarse ones are too many.
    fn of(
        fields: &mut Fields,
        size: UVec3,
        job: &Job,
    ) -> Result<Option<(Self, u64)>, VolumeFileError> {
        let bricks = (size + BRICK - 1) / BRICK;
        let mut filled = vec![false; bricks.as_u64vec3().element_product() as usize];
        for steps in STEPS {
            let mut palette = Self {
                steps,
                known: HashMap::new(),
                list: Vec::new(),
            };
            if palette.collect(fields, size, &mut filled, job)? {
                if palette.list.is_empty() {
                    palette.list.push(Optics {
                        albedo: Vec3::splat(GREY),
                        alpha: 1.0,
                    });
                }
                let filled = filled.iter().filter(|filled| **filled).count() as u64;
                return Ok(Some((palette, filled)));
            }
        }
        Ok(None)
    }

    fn key(&self, voxel: &Matter) -> [u16; 4] {
        let Vec3 { x, y, z } = voxel.albedo;
        // NaN becomes 0.
        [x, y, z, voxel.alpha].map(|v| (v.clamp(0.0, 1.0) * self.steps).round() as u16)
    }

    /// Whether the colours are few enough.
    fn collect(
        &mut self,
        fields: &mut Fields,
        size: UVec3,
        filled: &mut [bool],
        job: &Job,
    ) -> Result<bool, VolumeFileError> {
        // In the order in which rows are held.
        for band in 0..size.z.div_ceil(4) * size.y.div_ceil(4) {
            job.check()?;
            let (z, y) = (band / size.y.div_ceil(4) * 4, band % size.y.div_ceil(4) * 4);
            for z in z..(z + 4).min(size.z) {
                for y in y..(y + 4).min(size.y) {
                    for x in 0..size.x {
                        let Some(voxel) = fields.voxel(UVec3::new(x, y, z)) else {
                            continue;
                        };
                        if let Some(filled) = filled.get_mut(brick(size, UVec3::new(x, y, z))) {
                            *filled = true;
                        }
                        let next = self.list.len() as u32;
                        if *self.known.entry(self.key(&voxel)).or_insert(next) != next {
                            continue;
                        }
                        if self.list.len() == MOST_OPTICS {
                            return Ok(false);
                        }
                        self.list.push(Optics {
                            albedo: voxel.albedo,
                            alpha: voxel.alpha,
                        });
                    }
                }
            }
        }
        Ok(true)
    }
}
