//! A contact sheet: one design in all its colourways, side by side.
//!
//! The cloth is made once; a colourway whose yarns have the same families and sizes only
//! recolours it. Pictures stand in rows from the top left, the design's own yarns first.

use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use super::again::Again;
use super::exposure::{Engine, Pass};
use super::renderer::Renderer;
use super::request::{StillReport, StillRequest};
use super::shot::{SHOWN_BYTES, Shot};
use super::still::{Still, draw};
use super::{StillError, finishing, png_ending};
use crate::design::Design;
use crate::exemplar::ExemplarStore;
use crate::formats::png;
use crate::job::Job;
use crate::limits;
use crate::memory;
use crate::plan::Subject;

/// The name that asks for a sheet of every colourway; no colourway is called that.
pub const ALL_COLOURWAYS: &str = "all";
/// What the design's own yarns are called on a sheet.
pub const AS_DESIGNED: &str = "as designed";

/// The most pictures in a row while there are few.
const FEW: usize = 4;
/// Where one colourway stands on a sheet.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SheetPlace {
    /// The colourway.
    pub name: String,
    /// Pixels from the left edge.
    pub x: u32,
    /// Pixels from the top edge.
    pub y: u32,
    /// Whether the cloth was only recoloured for it, without synthesis.
    pub recoloured: bool,
}

/// A finished sheet.
pub struct Sheet {
    /// How it came about: sizes of the whole sheet, times and faults of all pictures
    /// together, the largest error.
    pub report: StillReport,
    /// Its pictures in order.
    pub places: Vec<SheetPlace>,
    /// Width and height of each picture in pixels.
    pub each: (u32, u32),
    picture: crate::film::Picture,
    depth: png::Depth,
    again: Again,
    metadata: png::Metadata,
}

impl Sheet {
    /// The sheet as shown, sRGB with straight alpha; clear between the pictures.
    pub fn picture(&self) -> &crate::film::Picture {
        &self.picture
    }

    /// The same, of what a command line calls `source`.
    pub fn made_from(mut self, source: String) -> Self {
        self.again.source = Some(source);
        self
    }

    /// Names and places, as the file's metadata says them: `name at x,y; …`.
    pub fn labels(&self) -> String {
        labels(&self.places)
    }

    /// Writes a `.png`, replacing the file in one step.
    ///
    /// # Errors
    /// When the ending is another or the file cannot be written.
    pub fn save(&self, path: &Path) -> Result<(), StillError> {
        png_ending(path)?;
        let mut metadata = self.metadata.clone();
        for (key, text) in &mut metadata.texts {
            if key == "Settings" {
                *text = self.again.line();
            }
        }
        png::write(path, &self.picture, self.depth, &metadata)?;
        Ok(())
    }
}

fn labels(places: &[SheetPlace]) -> String {
    let each: Vec<String> = places
        .iter()
        .map(|place| format!("{} at {},{}", place.name, place.x, place.y))
        .collect();
    each.join("; ")
}

/// How `count` pictures are laid out.
struct Layout {
    columns: usize,
    gap: u32,
    size: (u32, u32),
}

impl Layout {
    fn new(count: usize, width: u32, height: u32) -> Result<Self, StillError> {
        let columns = match count {
            0..=FEW => count.max(1),
            _ => (1..=count).find(|n| n * n >= count).unwrap_or(count),
        };
        let rows = count.div_ceil(columns) as u64;
        let gap = (width.min(height) / 40).max(2);
        let length = |each: u32, times: u64| {
            u64::from(each) * times + u64::from(gap) * times.saturating_sub(1)
        };
        let (all_width, all_height) = (length(width, columns as u64), length(height, rows));
        let clipped = |length: u64| u32::try_from(length).unwrap_or(u32::MAX);
        let size = (clipped(all_width), clipped(all_height));
        if !limits::PICTURE_SIDE.contains(&size.0) || !limits::PICTURE_SIDE.contains(&size.1) {
            return Err(StillError::Size(size.0, size.1));
        }
        Ok(Self { columns, gap, size })
    }

    fn place(&self, index: usize, width: u32, height: u32) -> (u32, u32) {
        let (column, row) = ((index % self.columns) as u32, (index / self.columns) as u32);
        (column * (width + self.gap), row * (height + self.gap))
    }
}

/// Renders every colourway of a design as `request` asks (its size is that of each
/// picture, its colourway is ignored) and lays them out. `on_pass` sees the number of the
/// picture and of all pictures with each pass.
///
/// # Errors
/// When the design has no colourways, the sheet would be too large, a picture cannot be
/// made, or the job is cancelled.
pub fn render_sheet(
    design: &Arc<Design>,
    request: &StillRequest,
    renderer: &Renderer,
    store: &ExemplarStore,
    job: &Job,
    on_pass: &mut dyn FnMut(usize, usize, &Pass<'_>),
) -> Result<Sheet, StillError> {
    if design.colourways().is_empty() {
        // This says what the design has.
        Design::clone(design).with_colourway(ALL_COLOURWAYS)?;
    }
    let (width, height) = (request.width, request.height);
    let mut designs = vec![(AS_DESIGNED.to_owned(), Arc::clone(design))];
    for colourway in design.colourways() {
        let coloured = Design::clone(design).with_colourway(&colourway.name)?;
        designs.push((colourway.name.clone(), Arc::new(coloured)));
    }
    let count = designs.len();
    let layout = Layout::new(count, width, height)?;
    let request = StillRequest {
        colourway: None,
        ..request.clone()
    };
    renderer.check(Subject::Cloth)?;
    // What is wrong with the light is said before anything takes long.
    let shot = Shot::new(&request, renderer.plan(&request, Subject::Cloth)?)?;
    ask_for_sheet(layout.size)?;
    let job = &finishing::bounded(&request, job);
    let clear = [1.0, 1.0, 1.0, 0.0];
    let mut picture = crate::film::Picture {
        width: layout.size.0,
        height: layout.size.1,
        pixels: vec![clear; layout.size.0 as usize * layout.size.1 as usize],
    };
    let mut engine: Option<Box<dyn Engine>> = None;
    let mut places = Vec::with_capacity(count);
    let mut report = StillReport::default();
    let mut metadata = png::Metadata::default();
    for (index, (name, design)) in designs.into_iter().enumerate() {
        let job = &share_of_time(job, count - index);
        let recoloured = (engine.as_mut()).is_some_and(|engine| engine.recolour(&design));
        let ready = match engine.take() {
            Some(ready) if recoloured => ready,
            _ => renderer.engine(&design, &request, store, job)?,
        };
        let still = draw(&*ready, &design, &shot, job, &mut |pass| {
            on_pass(index, count, pass);
        })?;
        let (x, y) = layout.place(index, width, height);
        paste(&mut picture, &still.picture(), x, y);
        join(&mut report, &still, index == 0);
        if index == 0 {
            metadata.pixels_per_mm = Some(still.pixels_per_mm);
            metadata.texts = still.texts();
        }
        places.push(SheetPlace {
            name,
            x,
            y,
            recoloured,
        });
        engine = Some(ready);
    }
    let all = StillRequest {
        colourway: Some(ALL_COLOURWAYS.to_owned()),
        ..request.clone()
    };
    let again = Again::new(&all, &report);
    (report.width, report.height) = layout.size;
    metadata
        .texts
        .push(("Colourways".to_owned(), labels(&places)));
    Ok(Sheet {
        report,
        places,
        each: (width, height),
        picture,
        again,
        depth: request.settings.showing.png_depth,
        metadata,
    })
}

/// The job of the next of so many pictures: it has an equal share of the time that is left.
fn share_of_time(job: &Job, pictures: usize) -> Job {
    let Some(deadline) = job.deadline() else {
        return job.clone();
    };
    let now = Instant::now();
    let share = deadline.saturating_duration_since(now) / pictures.max(1) as u32;
    job.clone().with_deadline(now + share)
}

/// Asks for the memory of a sheet while it is written.
fn ask_for_sheet((width, height): (u32, u32)) -> Result<(), StillError> {
    let pixels = u64::from(width) * u64::from(height);
    memory::ask(pixels * SHOWN_BYTES, || {
        format!("a sheet of {width} × {height} pixels")
    })?;
    Ok(())
}

/// Copies a picture into the sheet.
fn paste(sheet: &mut crate::film::Picture, picture: &crate::film::Picture, x: u32, y: u32) {
    let (across, width) = (sheet.width as usize, picture.width as usize);
    for (row, pixels) in picture.pixels.chunks(width.max(1)).enumerate() {
        let from = (y as usize + row) * across + x as usize;
        sheet.pixels[from..from + width].copy_from_slice(pixels);
    }
}

/// Adds what one picture took to the report of all.
fn join(all: &mut StillReport, still: &Still, first: bool) {
    let one = &still.report;
    if first {
        *all = one.clone();
        return;
    }
    let paths =
        all.paths_per_second * all.stage("render") + one.paths_per_second * one.stage("render");
    for (name, seconds) in &one.seconds {
        match all.seconds.iter_mut().find(|(known, _)| known == name) {
            Some((_, sum)) => *sum += seconds,
            None => all.seconds.push((name.clone(), *seconds)),
        }
    }
    all.total_seconds += one.total_seconds;
    let rendering = all.stage("render");
    if rendering > 0.0 {
        all.paths_per_second = paths / rendering;
    }
    all.spp = all.spp.min(one.spp);
    all.invalid_samples += one.invalid_samples;
    all.majorant_violations += one.majorant_violations;
    all.capped_walks += one.capped_walks;
    all.invalid_rays += one.invalid_rays;
    for warning in &one.warnings {
        if !all.warnings.contains(warning) {
            all.warnings.push(warning.clone());
        }
    }
    all.level = all.level.max(one.level);
    all.light_error = (all.light_error.zip(one.light_error)).map(|(a, b)| a.max(b));
    if let (Some(known), Some(error)) = (all.error, one.error)
        && error > known
    {
        (all.error, all.error_interval) = (one.error, one.error_interval);
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;

    #[test]
    fn pictures_do_not_overlap_and_fill_the_sheet() {
        for count in 1..30 {
            let layout = Layout::new(count, 50, 30).unwrap();
            let mut taken = vec![false; layout.size.0 as usize * layout.size.1 as usize];
            for index in 0..count {
                let (x, y) = layout.place(index, 50, 30);
                for row in y..y + 30 {
                    for column in x..x + 50 {
                        let pixel = (row * layout.size.0 + column) as usize;
                        assert!(!std::mem::replace(&mut taken[pixel], true), "{count}");
                    }
                }
            }
            assert!(taken[0]);
            if count <= FEW {
                assert_eq!(layout.size.1, 30, "few stand in one row");
            }
        }
        assert!(Layout::new(2, 16_384, 10).is_err());
        assert!(Layout::new(300, 1000, 1000).is_err());
    }
}
