//! Volumes in: the extinction, and beside it albedo and S where they are, become a grid.

use std::collections::HashMap;
use std::fs::File;
use std::io::Read;
use std::path::Path;

use glam::{UVec3, Vec3};

use super::fields::{Field, Rows};
use super::{VolumeFileError, VolumeFormat, beside, meta_image, nrrd, vol};
use crate::job::Job;
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

/// Reads `NAME.vol`, `NAME.nrrd` or `NAME.mhd` (extinction in 1/mm, box in mm) with
/// `NAME.albedo.…` and `NAME.sggx.…` beside it. Without them the voxels are grey and
/// isotropic, and that is remarked on. An S that is not of fibres becomes the nearest one.
///
/// # Errors
/// One line where a file cannot be read, is damaged or too large, or the files do not
/// belong together. Sizes are checked against the files before memory is asked for.
pub fn read(path: &Path, taps: Taps, job: &Job) -> Result<GridFile, VolumeFileError> {
    let format = VolumeFormat::of(path).filter(|format| format.readable());
    let format = format.ok_or_else(|| VolumeFileError::NotRead(path.to_owned()))?;
    let sigma = open(format, path)?;
    if sigma.components != 1 {
        let what = format!("it has {} numbers a voxel, not 1", sigma.components);
        return Err(damaged(path, what, "give the file of the extinction"));
    }
    let mut warnings = Vec::new();
    let mut part = |name: &str, components: u32, instead: &str| {
        let path = beside(path, name);
        if !path.exists() {
            let file = path.display();
            warnings.push(format!("{file} is not there: taking {instead}"));
            return Ok(None);
        }
        let field = open(format, &path)?;
        if field.components != components || field.size != sigma.size {
            let what = format!(
                "it has {} x {} and the extinction {}",
                field.size, field.components, sigma.size
            );
            return Err(damaged(
                &path,
                what,
                "give files that were written together",
            ));
        }
        Ok(Some(field))
    };
    let albedo = part("albedo", 3, "grey of albedo 0.8")?;
    let sggx = part("sggx", 6, "isotropic voxels")?;
    let mut fields = Fields {
        sigma: sigma.open()?,
        albedo: albedo.as_ref().map(Field::open).transpose()?,
        sggx: sggx.as_ref().map(Field::open).transpose()?,
        unlike: 0,
    };
    let palette = Palette::of(&mut fields, sigma.size, job)?
        .ok_or_else(|| grid_error(path, VolumeError::TooManyOptics(MOST_OPTICS + 1)))?;
    fields.unlike = 0;
    let grid = DenseGrid::from_fn(
        sigma.size,
        sigma.bounds,
        palette.list.clone(),
        taps,
        |cell| {
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
        },
    )
    .map_err(|source| grid_error(path, source))?;
    fields.finish()?;
    job.check()?;
    if fields.unlike > 0 {
        warnings.push(format!(
            "{} voxels are not of fibres: taking the nearest fibres",
            fields.unlike
        ));
    }
    let mended = grid.mended();
    if mended.extinctions > 0 {
        warnings.push(format!(
            "{} extinctions were negative or no number: taking 0",
            mended.extinctions
        ));
    }
    Ok(GridFile { grid, warnings })
}

fn grid_error(path: &Path, source: VolumeError) -> VolumeFileError {
    VolumeFileError::Grid {
        path: path.to_owned(),
        source,
    }
}

/// What the head of a file says.
fn open(format: VolumeFormat, path: &Path) -> Result<Field, VolumeFileError> {
    let unreadable = |source| VolumeFileError::Unreadable {
        path: path.to_owned(),
        source,
    };
    let file = File::open(path).map_err(unreadable)?;
    let length = file.metadata().map_err(unreadable)?.len();
    let mut start = Vec::new();
    (file.take(nrrd::LONGEST_HEAD as u64).read_to_end(&mut start)).map_err(unreadable)?;
    match format {
        VolumeFormat::Vol => vol::field(&start, length, path),
        VolumeFormat::Nrrd => nrrd::field(&start, length, path),
        _ => meta_image::field(&start, path),
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
    /// Voxels whose S is far from that of fibres.
    unlike: u64,
}

impl Fields {
    /// The voxel of a cell, if it has matter.
    fn voxel(&mut self, cell: UVec3) -> Option<Matter> {
        let [sigma] = self.sigma.at(cell);
        if !(sigma > 0.0 && sigma.is_finite()) {
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
        Some(Matter {
            sigma: sigma * scale,
            direction,
            alpha,
            albedo,
        })
    }

    fn finish(&mut self) -> Result<(), VolumeFileError> {
        self.sigma.finish()?;
        for rows in self.albedo.iter_mut().chain(self.sggx.iter_mut()) {
            rows.finish()?;
        }
        Ok(())
    }
}

/// The colours and roughnesses that occur.
struct Palette {
    steps: f32,
    known: HashMap<[u16; 4], u32>,
    list: Vec<Optics>,
}

impl Palette {
    /// Those of a file; `None` when even coarse ones are too many.
    fn of(fields: &mut Fields, size: UVec3, job: &Job) -> Result<Option<Self>, VolumeFileError> {
        for steps in STEPS {
            let mut palette = Self {
                steps,
                known: HashMap::new(),
                list: Vec::new(),
            };
            if palette.collect(fields, size, job)? {
                if palette.list.is_empty() {
                    palette.list.push(Optics {
                        albedo: Vec3::splat(GREY),
                        alpha: 1.0,
                    });
                }
                return Ok(Some(palette));
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
