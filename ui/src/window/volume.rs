//! Exporting a volume: which crossings, how fine and where to; the bytes are said first,
//! and nothing is written before the person has seen them.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use egui::{DragValue, RichText};
use pickglass::cloth::{ClothWindow, Part, Region};
use pickglass::design::Design;
use pickglass::exemplar::ExemplarStore;
use pickglass::formats::volume::{self, VolumeFileError, bytes_in_words};
use pickglass::job::Job;
use pickglass::still::{self, PreparedCloth, StillRequest};
use pickglass::volume::source::VoxelSource;

use super::task::{Outcome, Pace, Task};
use super::toasts::Grade;
use super::{dialog, icons};
use crate::tokens::{self, Palette};

/// Crossings along the side of the window that is proposed where nothing is selected.
const PROPOSED: u32 = 16;

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
}

type Planned = Result<(Arc<PreparedCloth>, String), String>;

struct Form {
    design: Arc<Design>,
    wanted: Wanted,
    cloth: Option<Arc<PreparedCloth>>,
    planning: Option<(Wanted, Job, Task<Planned>)>,
    /// What was planned, and how large it will be.
    planned: Option<(Wanted, Result<String, String>)>,
}

struct Work {
    job: Job,
    progress: Arc<Mutex<String>>,
    task: Task<Exported>,
}

/// The form and the export under way. Dropping it cancels both.
#[derive(Default)]
pub struct VolumeExport {
    form: Option<Form>,
    work: Option<Work>,
}

impl Drop for VolumeExport {
    fn drop(&mut self) {
        self.cancel();
        self.close();
    }
}

impl VolumeExport {
    /// Shows the form; `selected` = first end and pick from 0, ends and picks.
    pub fn ask(&mut self, design: Arc<Design>, selected: Option<[u32; 4]>, path: String) {
        let [end, pick, ends, picks] = selected.unwrap_or([
            0,
            0,
            design.ends().min(PROPOSED),
            design.picks().min(PROPOSED),
        ]);
        self.form = Some(Form {
            design,
            wanted: Wanted {
                region: [end + 1, pick + 1, ends, picks],
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
        let work = self.work.as_ref()?;
        let text = work.progress.lock().unwrap_or_else(PoisonError::into_inner);
        Some(text.clone())
    }

    /// Cancels the export under way.
    pub fn cancel(&self) {
        if let Some(work) = &self.work {
            work.job.cancel();
        }
    }

    fn close(&mut self) {
        if let Some((_, job, _)) = self.form.take().and_then(|form| form.planning) {
            job.cancel();
        }
    }

    /// Picks up what the threads finished.
    pub fn poll(&mut self) -> Option<Exported> {
        if let Some(form) = &mut self.form {
            form.poll();
        }
        let done = match self.work.as_ref()?.task.poll() {
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
        let mut choice = None;
        let modal = dialog::modal(ctx, "volume").show(ctx, |ui| choice = form.ui(ui));
        if modal.should_close() {
            choice = Some(Choice::Close);
        }
        match choice {
            Some(Choice::Close) => self.close(),
            Some(Choice::Plan) => form.plan(ctx),
            Some(Choice::Write) => {
                if let Some(form) = self.form.take()
                    && let Some(cloth) = form.cloth
                {
                    self.begin(ctx, cloth, form.wanted);
                }
            }
            None => {}
        }
    }

    fn begin(&mut self, ctx: &egui::Context, cloth: Arc<PreparedCloth>, wanted: Wanted) {
        let progress = Arc::new(Mutex::new("preparing".to_owned()));
        let (told, told_ctx) = (Arc::clone(&progress), ctx.clone());
        let pace = Pace::default();
        let job = Job::new().with_listener(move |stage, fraction| {
            *told.lock().unwrap_or_else(PoisonError::into_inner) = pace.told(stage, fraction);
            told_ctx.request_repaint();
        });
        let work_job = job.clone();
        let work = move || write(&cloth, &wanted, &work_job);
        self.work = Task::start(ctx, "volume", work).ok().map(|task| Work {
            job,
            progress,
            task,
        });
    }
}

enum Choice {
    Close,
    Plan,
    Write,
}

impl Form {
    fn poll(&mut self) {
        let Some((_, _, task)) = &self.planning else {
            return;
        };
        let planned = match task.poll() {
            Outcome::Working => return,
            Outcome::Ready(planned) => planned,
            Outcome::Lost => Err("planning failed unexpectedly: try fewer crossings".to_owned()),
        };
        if let Some((wanted, _, _)) = self.planning.take() {
            let planned = planned.map(|(cloth, text)| {
                self.cloth = Some(cloth);
                text
            });
            self.planned = Some((wanted, planned));
        }
    }

    /// Has the cloth made and the bytes counted, on a thread.
    fn plan(&mut self, ctx: &egui::Context) {
        if self.planning.is_some() {
            return;
        }
        let (design, wanted, cloth) = (
            Arc::clone(&self.design),
            self.wanted.clone(),
            self.cloth.clone(),
        );
        let job = Job::new();
        let (asked, work_job) = (self.wanted.clone(), job.clone());
        let work = move || {
            // Of a very large design only the region is made into cloth.
            let request = StillRequest::default().over(&design, &wanted.region());
            let cloth = match cloth {
                Some(cloth) if cloth.covers(&request) => cloth,
                _ => {
                    let store = ExemplarStore::user();
                    let prepared = still::prepare(&design, &request, &store, &work_job);
                    Arc::new(prepared.map_err(|error| error.to_string())?)
                }
            };
            let text = plan(&cloth, &wanted)?;
            Ok((cloth, text))
        };
        self.planning = Task::start(ctx, "volume plan", work)
            .ok()
            .map(|task| (asked, job, task));
    }

    fn ui(&mut self, ui: &mut egui::Ui) -> Option<Choice> {
        ui.set_width(tokens::TOAST_WIDTH);
        let palette = Palette::current(ui);
        let mut choice = None;
        ui.label(RichText::new("Export volume").text_style(egui::TextStyle::Heading));
        let what = "Voxels of a window of the cloth: .vol .vdb .nrrd .mhd .tif";
        ui.label(RichText::new(what).color(palette.quiet));
        ui.add_space(tokens::GAP);
        egui::Grid::new("volume form")
            .num_columns(2)
            .show(ui, |ui| {
                let names = ["First end, from the left", "First pick", "Ends", "Picks"];
                for (name, value) in names.into_iter().zip(&mut self.wanted.region) {
                    let label = ui.label(name);
                    ui.add(DragValue::new(value).range(1..=65_535))
                        .labelled_by(label.id);
                    ui.end_row();
                }
                let label = ui.label("Voxels a crossing");
                let own = |value: f64, _: std::ops::RangeInclusive<usize>| match value as u32 {
                    0 => "as the cloth".to_owned(),
                    count => count.to_string(),
                };
                let count = &mut self.wanted.voxels_a_crossing;
                ui.add(DragValue::new(count).range(0..=256).custom_formatter(own))
                    .labelled_by(label.id);
                ui.end_row();
                let label = ui.label("File");
                ui.add(egui::TextEdit::singleline(&mut self.wanted.path))
                    .labelled_by(label.id);
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
                    ui.label("Making the cloth and counting bytes");
                });
            }
            Some(Ok(text)) => {
                ui.label(text);
            }
            Some(Err(wrong)) => {
                ui.horizontal(|ui| {
                    icons::show(ui, Grade::Error, palette.error);
                    ui.label(RichText::new(format!("Error: {wrong}")).color(palette.error));
                });
            }
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

fn window<'c>(cloth: &'c PreparedCloth, wanted: &Wanted) -> Result<ClothWindow<'c>, String> {
    let fine = (wanted.voxels_a_crossing > 0).then_some(wanted.voxels_a_crossing);
    ClothWindow::new(cloth.cloth(), wanted.region(), Part::Whole, fine)
        .map_err(|error| error.to_string())
}

/// What writing would come to, in words.
fn plan(cloth: &PreparedCloth, wanted: &Wanted) -> Result<String, String> {
    let window = window(cloth, wanted)?;
    let plan = volume::plan(&window, Path::new(wanted.path.trim()), &[])
        .map_err(|error| error.to_string())?;
    let frame = window.frame();
    let [x, y, z] = frame.size.to_array();
    let about = if plan.exact { "" } else { "about " };
    Ok(format!(
        "{about}{}: {x} × {y} × {z} voxels of {:.1} µm, about {:.0} s",
        bytes_in_words(plan.bytes()),
        frame.edge_mm * 1e3,
        plan.seconds.ceil(),
    ))
}

fn write(cloth: &PreparedCloth, wanted: &Wanted, job: &Job) -> Exported {
    let path = PathBuf::from(wanted.path.trim());
    let window = match window(cloth, wanted) {
        Ok(window) => window,
        Err(error) => return Exported::Failed(error),
    };
    match volume::write(&window, &path, &[], job) {
        Ok(written) => Exported::Written {
            path,
            about: format!(
                "{} voxels, {}",
                written.voxels,
                bytes_in_words(written.bytes)
            ),
        },
        Err(VolumeFileError::Cancelled(_)) => Exported::Cancelled,
        Err(error) => Exported::Failed(error.to_string()),
    }
}
