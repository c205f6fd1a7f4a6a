//! A window of the cloth as cubic voxels, sampled box by box.
//!
//! Crossings need not be square and voxels here are, so a window covers its crossings to
//! the nearest voxel. Where voxels are as fine as the exemplars' own they are looked up at
//! their centres; coarser ones average: extinction linearly, fibres as ttᵀ, colour by the
//! yarn with most matter.

use glam::{DVec3, UVec3, Vec3};
use rayon::prelude::*;

use super::build::ClothVolume;
use crate::design::Positions;
use crate::render::Voxel;
use crate::synthesis::Stretch;
use crate::volume::sggx_matrix;
use crate::volume::source::{CellBox, Frame, NO_YARN, SourceVoxel, VoxelSource, fibres_of, upper};

/// Most voxels along an axis of a window, so that places stay exact in f32.
const LONGEST: f64 = 1_048_576.0;
/// Most lookups a voxel and axis.
const MOST_SAMPLES: u32 = 8;
/// Yarns that may share a voxel and still be told apart.
const SHARED: usize = 4;

/// A rectangle of crossings of the endless cloth.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Region {
    /// First end.
    pub end: i64,
    /// First pick.
    pub pick: i64,
    /// Ends.
    pub ends: u32,
    /// Picks.
    pub picks: u32,
}

impl Region {
    /// The same as what is looked at.
    pub fn extent(&self) -> Stretch {
        let range = |first: i64, count: u32| first..first.saturating_add(i64::from(count));
        Stretch {
            ends: range(self.end, self.ends),
            picks: range(self.pick, self.picks),
        }
    }
}

impl std::fmt::Display for Region {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        let Self {
            end,
            pick,
            ends,
            picks,
        } = self;
        write!(f, "{end},{pick},{ends},{picks}")
    }
}

/// How much of the thickness.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Part {
    /// All of it.
    #[default]
    Whole,
    /// What lies above the mid plane.
    Face,
}

/// A window that cannot be sampled.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum WindowError {
    /// A rectangle without crossings.
    #[error("region {0}: give at least one end and one pick, as 0,0,8,8")]
    Empty(Region),
    /// A rectangle too far from the cloth's origin or too long.
    #[error("region {0} reaches too far: keep ends and picks within ±1000000000")]
    Far(Region),
    /// Voxels that are no size.
    #[error("{0} voxels a crossing: give 1 to 1024")]
    PerCrossing(u32),
    /// A cloth of no thickness.
    #[error("the cloth is {0} mm thick there: check its yarns")]
    Thickness(f64),
    /// More voxels along one side than can be told apart.
    #[error(
        "a window of {0:.0} x {1:.0} x {2:.0} voxels is too long: choose a smaller region or \
         fewer voxels a crossing"
    )]
    Long(f64, f64, f64),
}

/// A window of a cloth on a grid of cubic voxels.
pub struct ClothWindow<'c> {
    cloth: &'c ClothVolume,
    frame: Frame,
    /// Lookups a voxel along each axis.
    samples: u32,
}

impl<'c> ClothWindow<'c> {
    /// Lays cubic voxels of an edge of the smaller pitch over `per_crossing` on a window;
    /// `None` = as fine as the cloth's own voxels.
    ///
    /// # Errors
    /// [`WindowError`] where the window has no voxels or too many along a side.
    pub fn new(
        cloth: &'c ClothVolume,
        region: Region,
        part: Part,
        per_crossing: Option<u32>,
    ) -> Result<Self, WindowError> {
        if region.ends == 0 || region.picks == 0 {
            return Err(WindowError::Empty(region));
        }
        let far = |first: i64, count: u32| {
            first.unsigned_abs().saturating_add(u64::from(count)) > 1_000_000_000
        };
        if far(region.end, region.ends) || far(region.pick, region.picks) {
            return Err(WindowError::Far(region));
        }
        let own = cloth.grid.voxel_mm;
        let mean =
            |positions: &Positions| positions.repeat_mm() / f64::from(positions.threads().max(1));
        let pitch = mean(&cloth.ends).min(mean(&cloth.picks));
        let finest = f64::from(own.min_element());
        let edge_mm = match per_crossing {
            Some(count) if !(1..=1024).contains(&count) => {
                return Err(WindowError::PerCrossing(count));
            }
            Some(count) => pitch / f64::from(count),
            None => pitch / (pitch / finest).round().clamp(1.0, 1024.0),
        };
        let (low, high) = cloth.height_range();
        let (low, high) = match part {
            Part::Whole => (f64::from(low), f64::from(high)),
            Part::Face => (0.0, f64::from(high)),
        };
        if !(high - low > 1e-6 && high - low < 1e4) {
            return Err(WindowError::Thickness(high - low));
        }
        let span = |positions: &Positions, first: i64, count: u32| {
            let start = positions.start(first);
            (start, positions.start(first + i64::from(count)) - start)
        };
        let (x, width) = span(&cloth.ends, region.end, region.ends);
        let (y, height) = span(&cloth.picks, region.pick, region.picks);
        let counts = [width, height, high - low].map(|side| side / edge_mm);
        if !counts.iter().all(|&count| count <= LONGEST) {
            return Err(WindowError::Long(counts[0], counts[1], counts[2]));
        }
        let size = UVec3::new(
            counts[0].round().max(1.0) as u32,
            counts[1].round().max(1.0) as u32,
            counts[2].ceil().max(1.0) as u32,
        );
        Ok(Self {
            cloth,
            frame: Frame {
                size,
                origin_mm: DVec3::new(x, y, low),
                edge_mm,
            },
            samples: ((edge_mm / finest).round() as u32).clamp(1, MOST_SAMPLES),
        })
    }

    /// The extent of a box along an axis, mm.
    fn stretch(&self, cells: CellBox, axis: usize) -> std::ops::Range<f32> {
        let at =
            |cell: u32| (self.frame.origin_mm[axis] + f64::from(cell) * self.frame.edge_mm) as f32;
        at(cells.low[axis])..at(cells.low[axis] + cells.size[axis])
    }

    /// Where the samples of a box lie along an axis, mm.
    fn places(&self, cells: CellBox, axis: usize) -> Vec<f64> {
        let first = u64::from(cells.low[axis]) * u64::from(self.samples);
        let count = u64::from(cells.size[axis]) * u64::from(self.samples);
        let step = self.frame.edge_mm / f64::from(self.samples);
        (first..first + count)
            .map(|sample| self.frame.origin_mm[axis] + (sample as f64 + 0.5) * step)
            .collect()
    }
}

/// The thread at a place and the place on it, voxels.
#[derive(Clone, Copy)]
struct OnThread {
    thread: i64,
    voxels: f32,
}

fn on_threads(positions: &Positions, places: &[f64], block: usize) -> Vec<OnThread> {
    let most = block as f64 - 0.01;
    places
        .iter()
        .map(|&mm| {
            let (thread, _) = positions.locate(mm);
            let part = (mm - positions.start(thread)) / positions.pitch(thread);
            OnThread {
                thread,
                voxels: (part * block as f64).clamp(0.0, most) as f32,
            }
        })
        .collect()
}

/// Running sums of one coarse voxel.
#[derive(Clone, Copy)]
struct Sums {
    sigma: f32,
    /// Σ σS: xx, yy, zz, xy, xz, yz.
    sggx: [f32; 6],
    yarns: [(i32, f32); SHARED],
}

impl Sums {
    const NONE: Self = Self {
        sigma: 0.0,
        sggx: [0.0; 6],
        yarns: [(NO_YARN, 0.0); SHARED],
    };

    fn add(&mut self, voxel: &Voxel) {
        self.sigma += voxel.sigma;
        let s = sggx_matrix(voxel.direction, voxel.alpha);
        let parts = [
            s.x_axis.x, s.y_axis.y, s.z_axis.z, s.x_axis.y, s.x_axis.z, s.y_axis.z,
        ];
        for (sum, part) in self.sggx.iter_mut().zip(parts) {
            *sum += voxel.sigma * part;
        }
        let yarn = voxel.optics as i32;
        let known = |entry: &&mut (i32, f32)| entry.0 == yarn || entry.0 == NO_YARN;
        if let Some(entry) = self.yarns.iter_mut().find(known) {
            *entry = (yarn, entry.1 + voxel.sigma);
        }
    }

    fn mean(&self, samples: f32) -> SourceVoxel {
        if !(self.sigma > 0.0) {
            return SourceVoxel::EMPTY;
        }
        let Some((scale, direction, alpha, _)) = fibres_of(self.sggx.map(|s| s / self.sigma))
        else {
            return SourceVoxel::EMPTY;
        };
        let most = self.yarns.iter().max_by(|a, b| a.1.total_cmp(&b.1));
        SourceVoxel {
            sigma: self.sigma / samples * scale,
            direction,
            alpha,
            yarn: most.map_or(NO_YARN, |entry| entry.0),
        }
    }
}

impl VoxelSource for ClothWindow<'_> {
    fn frame(&self) -> Frame {
        self.frame
    }

    fn albedos(&self) -> &[Vec3] {
        &self.cloth.albedo
    }

    fn densest(&self) -> f32 {
        let all = self.cloth.matter.iter().flatten();
        all.fold(0.0, |top: f32, extinction| top.max(extinction.most()))
    }

    fn fill(&self, cells: CellBox, voxels: &mut [SourceVoxel]) {
        let cloth = self.cloth.clone();
        let cloth = cloth.with_small_window(self.stretch(cells, 0), self.stretch(cells, 1));
        let [bx, by, _] = cloth.grid.block;
        let ends = on_threads(&cloth.ends, &self.places(cells, 0), bx);
        let picks = on_threads(&cloth.picks, &self.places(cells, 1), by);
        let floor = f64::from(cloth.grid.floor_mm());
        let heights: Vec<f32> = (self.places(cells, 2).iter())
            .map(|z| ((z - floor) / f64::from(cloth.grid.voxel_mm.z)) as f32)
            .collect();
        let samples = self.samples as usize;
        let slice = cells.size.x as usize * cells.size.z as usize;
        let rows = voxels
            .par_chunks_mut(slice.max(1))
            .zip(picks.par_chunks(samples));
        rows.for_each(|(out, picks)| {
            if let ([pick], 1) = (picks, samples) {
                out.fill(SourceVoxel::EMPTY);
                cloth.sample_row(&ends, *pick, &heights, |x, z, voxel| {
                    if let Some(out) = out.get_mut(z * ends.len() + x) {
                        *out = exact(voxel);
                    }
                });
                return;
            }
            let mut sums = vec![Sums::NONE; out.len()];
            let width = cells.size.x as usize;
            for &pick in picks {
                cloth.sample_row(&ends, pick, &heights, |x, z, voxel| {
                    if let Some(sums) = sums.get_mut(z / samples * width + x / samples) {
                        sums.add(voxel);
                    }
                });
            }
            let count = (samples * samples * samples) as f32;
            for (out, sums) in out.iter_mut().zip(&sums) {
                *out = sums.mean(count);
            }
        });
    }
}

fn exact(voxel: &Voxel) -> SourceVoxel {
    SourceVoxel {
        sigma: voxel.sigma,
        direction: upper(voxel.direction),
        alpha: voxel.alpha,
        yarn: voxel.optics as i32,
    }
}

impl ClothVolume {
    /// Looks up one pick's row of places at every height and hands over what has matter:
    /// (place, height, voxel).
    fn sample_row(
        &self,
        ends: &[OnThread],
        pick: OnThread,
        heights: &[f32],
        mut found: impl FnMut(usize, usize, &Voxel),
    ) {
        let mut first = 0;
        for run in ends.chunk_by(|a, b| a.thread == b.thread) {
            let begun = first;
            first += run.len();
            let Some(crossing) = self.crossing(run[0].thread, pick.thread) else {
                continue;
            };
            for (z, &height) in heights.iter().enumerate() {
                for (x, end) in run.iter().enumerate() {
                    let point = Vec3::new(end.voxels, pick.voxels, height);
                    let voxel = self.voxel_near(&crossing, point, 0.0, None);
                    if voxel.sigma > 0.0 {
                        found(begun + x, z, &voxel);
                    }
                }
            }
        }
    }
}
