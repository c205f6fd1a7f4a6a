//! Exporting a volume: which crossings, how fine and where to; the bytes are said first,
//! and nothing is written before the person has seen them.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use egui::{DragValue, RichText};
use pickglass::cloth::{self, ClothWindow, Part, PreparedCloth, Region};
use pickglass::design::Design;
use pickglass::engine::{self, StillError, StillRequest};
use pickglass::exemplar::{COARSEST_LEVEL, ExemplarStore};
use pickglass::formats::output;
use pickglass::formats::volume::{self, Attachment, VolumeFileError, bytes_in_words};
use pickglass::formats::yarns::{self, YarnsError};
use pickglass::job::Job;
use pickglass::plan::{Settings, Subject};
use pickglass::synthesis::Stretch;
use pickglass::volume::source::VoxelSource;
use pickglass::yarn::tubes::YarnTube;

use super::task::{Outcome, Running};
use super::{dialog, typing};
use crate::tokens::{self, Palette};
use crate::{values, volumes};

/// Crossings along the side of the window that is proposed where nothing is selected.
const PROPOSED: u32 = 16;

/// What stands for no number of voxels.
const AS_CLOTH: &str = "as the cloth";

/// What became of an export.
pub enum Exported {
    Written { path: PathBuf, about: String },
    Cancelled,
    Failed(String),
}

/// What the form asks for.
#[derive(Debug, Clone, PartialEq)]
struct Wanted {
    region: [u32; 4],
    part: Part,
    level: u32,
    /// 0 = as fine as the cloth's own.
    voxels_a_crossing: u32,
    path: String,
}

impl Wanted {
    fn region(&self) -> Region {
        let [end, pick, ends, picks] = self.region;
        Region {
            // People count from 1.
            end: i64::from(end) - 1,
            pick: i64::from(pick) - 1,
            ends,
            picks,
        }
    }

    fn path(&self) -> Result<PathBuf, String> {
        values::volume_path(self.path.trim()).map(|path| path.0)
    }

    /// The cloth of it, of a picture like this one.
    fn request(&self, shown: &StillRequest) -> StillRequest {
        StillRequest {
            view: shown.view,
            eye: shown.eye,
            turned: shown.turned,
            light: shown.light.clone(),
            exposure_ev: shown.exposure_ev,
            seed: shown.seed,
            colourway: shown.colourway.clone(),
            settings: Settings::default().at_level(self.level),
            ..StillRequest::default()
        }
    }
}

/// What is written: voxels of a cloth, or yarns of a design.
#[derive(Clone)]
enum Made {
    Cloth(Arc<PreparedCloth>),
    Yarns(Arc<Design>, Arc<[YarnTube]>),
}

/// What was made to be written, and how large it will be.
type Planned = Result<(Made, String), String>;

struct Form {
    design: Arc<Design>,
    /// How the cloth is shown now.
    shown: StillRequest,
    wanted: Wanted,
    /// Cloth that was made, and its level.
    cloth: Option<(u32, Arc<PreparedCloth>)>,
    planning: Option<(Wanted, Running<Planned>)>,
    planned: Option<(Wanted, Planned)>,
}

/// The form and the export under way. Dropping it cancels both.
#[derive(Default)]
pub struct VolumeExport {
    /// The file that the design is from: not to be written over.
    pub source: Option<PathBuf>,
    form: Option<Form>,
    browse: dialog::Browse,
    work: Option<Running<Exported>>,
}

impl VolumeExport {
    /// Shows the form; `selected` = first end and pick from 0, ends and picks.
    pub fn ask(
        &mut self,
        design: Arc<Design>,
        shown: StillRequest,
        selected: Option<[u32; 4]>,
        path: String,
    ) {
        let [end, pick, ends, picks] = selected.unwrap_or([
            0,
            0,
            design.ends().min(PROPOSED),
            design.picks().min(PROPOSED),
        ]);
        self.form = Some(Form {
            design,
            shown,
            wanted: Wanted {
                region: [end + 1, pick + 1, ends, picks],
                part: Part::Whole,
                level: 0,
                voxels_a_crossing: 0,
                path,
            },
            cloth: None,
            planning: None,
            planned: None,
        });
    }

    /// What the export under way is at.
    pub fn progress(&self) -> Option<String> {
        self.work.as_ref().map(Running::progress)
    }

    /// Cancels the export under way.
    pub fn cancel(&self) {
        if let Some(work) = &self.work {
            work.cancel();
        }
    }

    /// Picks up what the threads finished.
    pub fn poll(&mut self) -> Option<Exported> {
        let chosen = self.browse.poll();
        if let Some(form) = &mut self.form {
            if let Some(path) = chosen {
                form.wanted.path = path.display().to_string();
            }
            form.poll();
        }
        let done = match self.work.as_ref()?.poll() {
            Outcome::Working => return None,
            Outcome::Ready(done) => done,
            Outcome::Lost => Exported::Failed(
                "the volume: writing it failed unexpectedly: try fewer crossings".to_owned(),
            ),
        };
        self.work = None;
        Some(done)
    }

    /// Shows the form, when it is asked for.
    pub fn show(&mut self, ctx: &egui::Context) {
        let Some(form) = &mut self.form else {
            return;
        };
        let shown = dialog::show(ctx, "volume", |ui| form.ui(ui));
        let choice = match shown.escaped {
            true => Some(Choice::Close),
            false => shown.inner,
        };
        match choice {
            Some(Choice::Close) => self.form = None,
            Some(Choice::Browse) => (self.browse).ask(
                ctx,
                "Export a volume",
                "Volumes and yarns",
                &["vol", "vdb", "nrrd", "mhd", "tif", "obj", "glb"],
            ),
            Some(Choice::Plan) => form.plan(ctx, self.source.clone()),
            Some(Choice::Write) => {
                if let Some(form) = self.form.take()
                    && let Some((wanted, Ok((made, _)))) = form.planned
                {
                    let request = wanted.request(&form.shown);
                    let work = Running::start(ctx, "volume", move |job, _| {
                        write(&made, &wanted, &request, job)
                    });
                    self.work = work.ok();
                }
            }
            None => {}
        }
    }
}

enum Choice {
    Close,
    Browse,
    Plan,
    Write,
}

impl Form {
    fn poll(&mut self) {
        let Some((_, work)) = &self.planning else {
            return;
        };
        let planned = match work.poll() {
            Outcome::Working => return,
            Outcome::Ready(planned) => planned,
            Outcome::Lost => Err("planning failed unexpectedly: try fewer crossings".to_owned()),
        };
        if let Some((wanted, _)) = self.planning.take() {
            if let Ok((Made::Cloth(cloth), _)) = &planned {
                self.cloth = Some((wanted.level, Arc::clone(cloth)));
            }
            self.planned = Some((wanted, planned));
        }
    }

    /// Has what is to be written made and its bytes counted, on a thread.
    fn plan(&mut self, ctx: &egui::Context, source: Option<PathBuf>) {
        if self.planning.is_some() {
            return;
        }
        let (design, wanted) = (Arc::clone(&self.design), self.wanted.clone());
        let request = wanted.request(&self.shown);
        let known = (self.cloth.as_ref())
            .filter(|(level, _)| *level == wanted.level)
            .map(|(_, cloth)| Arc::clone(cloth));
        let asked = wanted.clone();
        let work = Running::start(ctx, "volume plan", move |job, _| {
            let path = asked.path()?;
            let inputs = || source.as_deref().into_iter().chain(request.light.file());
            output::check(&path, inputs()).map_err(|error| error.to_string())?;
            let (planned, files) = if yarns::is_yarns(&path) {
                (plan_yarns(&design, &asked)?, yarns::files(&path))
            } else {
                plan(&design, known, &asked, request.clone(), job)?
            };
            for file in files {
                output::is_no_input(&file, inputs()).map_err(|error| error.to_string())?;
            }
            Ok(planned)
        });
        self.planning = work.ok().map(|work| (wanted, work));
    }

    fn ui(&mut self, ui: &mut egui::Ui) -> Option<Choice> {
        ui.set_width(tokens::TOAST_WIDTH);
        let palette = Palette::current(ui);
        let mut choice = None;
        ui.label(RichText::new("Export volume").text_style(egui::TextStyle::Heading));
        let what = "Of a window of the cloth the voxels, .vol .vdb .nrrd .mhd .tif, or the yarns, \
                    .obj .glb. A .vol gets a scene for Mitsuba.";
        ui.label(RichText::new(what).color(palette.quiet));
        ui.add_space(tokens::GAP);
        egui::Grid::new("volume form")
            .num_columns(2)
            .show(ui, |ui| {
                let names = ["First end", "First pick", "Ends", "Picks"];
                for (name, value) in names.into_iter().zip(&mut self.wanted.region) {
                    let label = ui.label(name);
                    typing::number(ui, DragValue::new(value).range(1..=65_535))
                        .labelled_by(label.id);
                    ui.end_row();
                }
                let label = ui.label("Voxels a crossing");
                let own = |value: f64, _: std::ops::RangeInclusive<usize>| match value as u32 {
                    0 => AS_CLOTH.to_owned(),
                    count => count.to_string(),
                };
                let read = |text: &str| match text.trim() {
                    AS_CLOTH => Some(0.0),
                    number => typing::parsed(number),
                };
                let count = &mut self.wanted.voxels_a_crossing;
                let field = DragValue::new(count).range(0..=256).custom_formatter(own);
                typing::number_by(ui, field, read).labelled_by(label.id);
                ui.end_row();
                let label = ui.label("Level: each is half as fine");
                let level = DragValue::new(&mut self.wanted.level).range(0..=COARSEST_LEVEL);
                typing::number(ui, level).labelled_by(label.id);
                ui.end_row();
                ui.label("Thickness");
                ui.horizontal(|ui| {
                    ui.radio_value(&mut self.wanted.part, Part::Whole, "whole");
                    ui.radio_value(&mut self.wanted.part, Part::Face, "face alone");
                });
                ui.end_row();
                let label = ui.label("File");
                ui.horizontal(|ui| {
                    let field = ui.add(egui::TextEdit::singleline(&mut self.wanted.path));
                    if typing::entered(ui, &field) {
                        field.request_focus();
                        choice = Some(Choice::Plan);
                    }
                    field.labelled_by(label.id);
                    if ui.button("Browse…").clicked() {
                        choice = Some(Choice::Browse);
                    }
                });
                ui.end_row();
            });
        ui.add_space(tokens::GAP);
        let planned = (self.planned.as_ref())
            .filter(|(wanted, _)| *wanted == self.wanted)
            .map(|(_, planned)| planned);
        match planned {
            _ if self.planning.is_some() => {
                ui.horizontal(|ui| {
                    ui.spinner();
                    ui.label("Making it and counting bytes");
                });
            }
            Some(Ok((_, text))) => {
                ui.label(text);
            }
            Some(Err(wrong)) => dialog::problem(ui, Some(wrong)),
            None => {
                let text = "Nothing is written before its size is known.";
                ui.label(RichText::new(text).color(palette.quiet));
            }
        }
        ui.add_space(tokens::GAP);
        let ready = matches!(planned, Some(Ok(_)));
        ui.horizontal(|ui| {
            if ready && ui.button("Write").clicked() {
                choice = Some(Choice::Write);
            }
            let idle = self.planning.is_none();
            let ask = egui::Button::new("Count the bytes");
            if !ready && ui.add_enabled(idle, ask).clicked() {
                choice = Some(Choice::Plan);
            }
            if ui.button("Cancel").clicked() {
                choice = Some(Choice::Close);
            }
        });
        choice
    }
}

/// Makes the cloth, unless the known one will do, and says what writing it comes to and which
/// files it makes.
fn plan(
    design: &Arc<Design>,
    known: Option<Arc<PreparedCloth>>,
    wanted: &Wanted,
    request: StillRequest,
    job: &Job,
) -> Result<((Made, String), Vec<PathBuf>), String> {
    // Of a very large design only the region is made into cloth.
    let extent = wanted.region().extent();
    let cloth = match known {
        Some(cloth) if cloth.covers(cloth.design(), &extent) => cloth,
        _ => Arc::new(prepare(design, &request, &extent, job).map_err(|error| error.to_string())?),
    };
    let path = wanted.path()?;
    let (window, attached) = voxels(&cloth, wanted, &path, &request)?;
    let plan = volume::plan(&window, &path, &attached).map_err(|error| error.to_string())?;
    let text = volumes::voxels_in_words(&plan, &window.frame());
    let files = plan.files.into_iter().map(|file| file.0).collect();
    Ok(((Made::Cloth(cloth), text), files))
}

/// Makes so many crossings of a design into cloth, as `request` has it.
fn prepare(
    design: &Arc<Design>,
    request: &StillRequest,
    extent: &Stretch,
    job: &Job,
) -> Result<PreparedCloth, StillError> {
    let design = engine::coloured(design, request)?;
    let settings = request.plan(Subject::Cloth)?.cloth;
    let store = ExemplarStore::user();
    Ok(cloth::prepare(&design, &settings, extent, &store, job)?)
}

fn plan_yarns(design: &Arc<Design>, wanted: &Wanted) -> Planned {
    let made = volumes::yarns(design, &wanted.region());
    let tubes = made.map_err(|error| error.to_string())?;
    let text = volumes::yarns_in_words(&tubes, &wanted.path()?);
    Ok((Made::Yarns(Arc::clone(design), tubes.into()), text))
}

/// The voxels of it, and what goes beside them.
fn voxels<'c>(
    cloth: &'c PreparedCloth,
    wanted: &Wanted,
    path: &Path,
    request: &StillRequest,
) -> Result<(ClothWindow<'c>, Vec<Attachment>), String> {
    let fine = (wanted.voxels_a_crossing > 0).then_some(wanted.voxels_a_crossing);
    let asked = (wanted.region(), wanted.part, fine);
    volumes::voxels(cloth, asked, path, request).map_err(|error| error.to_string())
}

/// Writes what was planned; all files or none.
fn write(made: &Made, wanted: &Wanted, request: &StillRequest, job: &Job) -> Exported {
    let written = wanted.path().and_then(|path| match made {
        Made::Cloth(cloth) => write_voxels(cloth, wanted, &path, request, job),
        Made::Yarns(design, tubes) => write_yarns(design, tubes, &path, job),
    });
    written.unwrap_or_else(Exported::Failed)
}

fn write_voxels(
    cloth: &PreparedCloth,
    wanted: &Wanted,
    path: &Path,
    request: &StillRequest,
    job: &Job,
) -> Result<Exported, String> {
    let (window, attached) = voxels(cloth, wanted, path, request)?;
    match volume::write(&window, path, &attached, job) {
        Ok(written) => Ok(Exported::Written {
            path: path.to_owned(),
            about: format!(
                "{} voxels, {}",
                written.voxels,
                bytes_in_words(written.bytes)
            ),
        }),
        Err(VolumeFileError::Cancelled(_)) => Ok(Exported::Cancelled),
        Err(error) => Err(error.to_string()),
    }
}

fn write_yarns(
    design: &Design,
    tubes: &[YarnTube],
    path: &Path,
    job: &Job,
) -> Result<Exported, String> {
    match yarns::write(design, tubes, path, job) {
        Ok(files) => Ok(Exported::Written {
            path: path.to_owned(),
            about: format!(
                "{} yarns, {}",
                tubes.len(),
                bytes_in_words(files.iter().map(|file| file.1).sum())
            ),
        }),
        Err(YarnsError::Cancelled(_)) => Ok(Exported::Cancelled),
        Err(error) => Err(error.to_string()),
    }
}
