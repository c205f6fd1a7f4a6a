//! Stills: an exposure developed, shown and written.

use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use glam::Vec3;

use super::again::Again;
use super::developing::Developing;
use super::exposure::{Engine, Exposure, Pass};
use super::prepare::coloured;
use super::renderer::Renderer;
use super::request::{StillReport, StillRequest};
use super::shot::Shot;
use super::table::reference;
use super::{StillError, finishing};
use crate::cloth::PreparedCloth;
use crate::design::Design;
use crate::exemplar::ExemplarStore;
use crate::film::Film;
use crate::formats::png::Depth;
use crate::formats::{exr, png};
use crate::job::Job;
use crate::plan::Subject;

/// Takes one picture of a prepared cloth with the path tracer; `on_pass` sees it after every
/// pass.
///
/// # Errors
/// When the request is not usable or the job is cancelled.
pub fn render(
    prepared: &PreparedCloth,
    request: &StillRequest,
    job: &Job,
    on_pass: &mut dyn FnMut(&Pass<'_>),
) -> Result<Still, StillError> {
    let shot = Shot::new(request, reference().plan(request, Subject::Cloth)?)?;
    draw(prepared, prepared.design(), &shot, job, on_pass)
}

/// Takes one picture of a design with an engine that was made ready for it.
///
/// # Errors
/// When the request is not usable or the job is cancelled.
pub fn draw(
    engine: &dyn Engine,
    design: &Arc<Design>,
    shot: &Shot<'_>,
    job: &Job,
    on_pass: &mut dyn FnMut(&Pass<'_>),
) -> Result<Still, StillError> {
    let exposure = engine.expose(shot, job, on_pass)?;
    Ok(develop(shot, exposure, Shown::Design(Arc::clone(design))))
}

/// Makes an engine ready and takes the picture, with the user's exemplar store.
///
/// # Errors
/// When the design cannot be drawn, the request is not usable or the job is cancelled.
pub fn render_still(
    design: &Arc<Design>,
    request: &StillRequest,
    renderer: &Renderer,
    job: &Job,
    on_pass: &mut dyn FnMut(&Pass<'_>),
) -> Result<Still, StillError> {
    render_settled(
        design,
        request,
        renderer,
        job,
        &mut |_, _| Ok(None),
        on_pass,
    )
}

/// Settles what is left open of a picture once its engine is ready, by looking at it: what is
/// asked for instead, which needs no other engine and no other light; `None` where that stays as it is.
pub type Settle<'s> =
    dyn FnMut(&dyn Engine, &Arc<Design>) -> Result<Option<StillRequest>, StillError> + 's;

/// As [`render_still`]; `settle` has a say before anything is traced.
///
/// # Errors
/// As [`render_still`], and when `settle` fails.
pub fn render_settled(
    design: &Arc<Design>,
    request: &StillRequest,
    renderer: &Renderer,
    job: &Job,
    settle: &mut Settle<'_>,
    on_pass: &mut dyn FnMut(&Pass<'_>),
) -> Result<Still, StillError> {
    renderer.check(Subject::Cloth)?;
    // What is wrong with the light is said before anything takes long.
    let shot = Shot::new(request, renderer.plan(request, Subject::Cloth)?)?;
    let job = &finishing::bounded(request, job);
    let engine = renderer.engine(design, request, &ExemplarStore::user(), job)?;
    let design = coloured(design, request)?;
    let begun = Instant::now();
    let settled = settle(&*engine, &design)?;
    let looked = settled.is_some().then(|| begun.elapsed().as_secs_f64());
    let shot = match &settled {
        Some(request) => Shot {
            plan: renderer.plan(request, Subject::Cloth)?,
            request,
            ..shot
        },
        None => shot,
    };
    let mut still = draw(&*engine, &design, &shot, job, on_pass)?;
    if let Some(seconds) = looked {
        let report = &mut still.report;
        let before = report.seconds.len().saturating_sub(1);
        report
            .seconds
            .insert(before, ("settling".to_owned(), seconds));
        report.total_seconds += seconds;
    }
    Ok(still)
}

/// The still of an exposure.
pub(super) fn develop(shot: &Shot<'_>, exposure: Exposure, shown: Shown) -> Still {
    Still {
        again: Again::new(shot.request, &exposure.report),
        report: exposure.report,
        film: exposure.film,
        developing: shot.developing(),
        png_depth: shot.plan.showing.png_depth,
        pixels_per_mm: exposure.pixels_per_mm,
        shown,
    }
}

/// Hash of a design's document, hexadecimal.
fn design_hash(design: &Design) -> String {
    match crate::formats::ron::write(design) {
        Ok(text) => blake3::hash(text.as_bytes()).to_hex()[..16].to_owned(),
        Err(_) => "unknown".to_owned(),
    }
}

/// A finished picture with its film.
pub struct Still {
    /// How it came about.
    pub report: StillReport,
    /// Linear means, variances and features.
    pub film: Film,
    developing: Developing,
    png_depth: Depth,
    pub(super) pixels_per_mm: f32,
    shown: Shown,
    again: Again,
}

/// What a still shows.
pub(super) enum Shown {
    /// A design's cloth.
    Design(Arc<Design>),
    /// A volume that was read, by its name.
    Volume(String),
}

impl Still {
    /// The same, of what a command line calls `source`: a file or the name of a preset, with
    /// the options for reading it.
    pub fn made_from(mut self, source: String) -> Self {
        self.again.source = Some(source);
        self
    }

    /// The command line that makes the picture again.
    pub fn command_line(&self) -> String {
        self.again.line()
    }

    /// The film's radiances denoised; `None` where the request said not to, or the job is
    /// cancelled.
    pub fn clean(&self, job: &Job) -> Option<Vec<Vec3>> {
        self.developing.clean(&self.film, job)
    }

    /// The picture as shown: denoised unless the request said no, sRGB with straight alpha.
    pub fn picture(&self) -> crate::film::Picture {
        self.developing.picture(&self.film)
    }

    /// What the picture's file says of it.
    pub(super) fn texts(&self) -> Vec<(String, String)> {
        // The hash is of the whole document: it is worked out for pictures that are kept.
        let (title, hash) = match &self.shown {
            Shown::Design(design) => (design.name.clone(), design_hash(design)),
            Shown::Volume(name) => (name.clone(), "a volume".to_owned()),
        };
        [
            (
                "Software",
                format!("Pickglass {}", env!("CARGO_PKG_VERSION")),
            ),
            ("Title", title),
            ("Design", hash),
            ("Settings", self.command_line()),
            ("invalid_samples", self.report.invalid_samples.to_string()),
            (
                "majorant_violations",
                self.report.majorant_violations.to_string(),
            ),
            ("capped_walks", self.report.capped_walks.to_string()),
            ("invalid_rays", self.report.invalid_rays.to_string()),
        ]
        .map(|(key, text)| (key.to_owned(), text))
        .to_vec()
    }

    /// Writes `.png` or `.exr`, replacing the file in one step.
    ///
    /// # Errors
    /// When the ending is neither or the file cannot be written.
    pub fn save(&self, path: &Path) -> Result<(), StillError> {
        match path.extension().and_then(|ending| ending.to_str()) {
            Some(ending) if ending.eq_ignore_ascii_case("png") => {
                let metadata = png::Metadata {
                    pixels_per_mm: Some(self.pixels_per_mm),
                    texts: self.texts(),
                };
                png::write(path, &self.picture(), self.png_depth, &metadata)?;
            }
            Some(ending) if ending.eq_ignore_ascii_case("exr") => {
                exr::write(path, &self.film, self.pixels_per_mm, &self.texts())?;
            }
            _ => return Err(StillError::Ending(path.to_owned())),
        }
        Ok(())
    }
}
