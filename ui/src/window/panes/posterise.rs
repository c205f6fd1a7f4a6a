//! Posterising: the picture beside its map, and what it is made with; live, on a thread of
//! its own.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use egui::{DragValue, RichText, ScrollArea, TextEdit, TextureHandle, TextureOptions, Vec2, vec2};
use pickglass::design::{Design, Regions, SourceImage, Srgb, Structure};
use pickglass::edit::{Document, Edit};
use pickglass::formats::photo;
use pickglass::posterise::{Fit, PosteriseSettings, Posterised, posterise};
use pickglass::text::visible;

use super::later::Later;
use super::regions::RegionList;
use super::{PaneView, Shown};
use crate::tokens::{self, Palette};
use crate::window::action::Action;
use crate::window::icons;

use crate::window::picture::shrunk;
use crate::window::task::{Outcome, Task};
use crate::window::toasts::Grade;
use crate::window::typing;

/// Longer side of a picture on the screen, pixels.
const SHOWN: usize = 512;
/// From this width of the pane on, points, the pictures stand beside the settings.
const BESIDE: f32 = 840.0;
/// Colours one can ask for here.
const COLOURS: std::ops::RangeInclusive<u16> = 2..=24;

/// The picture that was read, or why not.
type Read = Result<photo::Photo, String>;
/// What was made, or why not.
type Made = Result<Box<Posterised>, String>;

/// The pane's state.
#[derive(Default)]
pub struct Posterise {
    path: String,
    /// The field of the path, where Enter was pressed in it and nothing was typed since.
    field: Option<egui::Id>,
    reading: Option<Task<Read>>,
    choosing: Option<Task<Option<PathBuf>>>,
    problem: Option<String>,
    picture: Option<Picture>,
    settings: PosteriseSettings,
    own_size: bool,
    made: Later<(u64, PosteriseSettings), Made>,
    map: Option<(u64, TextureHandle)>,
    /// Counts answers, to know when the map is to be drawn again.
    seen: u64,
    regions: RegionList,
}

/// The picture to be posterised.
struct Picture {
    source: Arc<SourceImage>,
    /// Another number for every picture.
    number: u64,
    /// It is the open design's own.
    of_design: bool,
    texture: TextureHandle,
}

impl PaneView for Posterise {
    fn show(&mut self, ui: &mut egui::Ui, shown: &Shown<'_>, actions: &mut Vec<Action>) {
        let document = shown.document;
        self.poll(ui.ctx());
        let regions = match document.design().structure() {
            Structure::Regions(regions) => Some(regions),
            _ => None,
        };
        if self.picture.is_none()
            && let Some(source) = regions.and_then(Regions::source)
        {
            self.take(ui.ctx(), Arc::clone(source), true);
            self.settings.colours = regions.map_or(8, |r| r.palette().len() as u16).clamp(2, 24);
            self.settings.ends = Some(document.design().ends());
            self.settings.picks = Some(document.design().picks());
            self.own_size = true;
        }
        let beside = self.picture.is_some() && ui.available_width() > BESIDE;
        if beside {
            // The regions stay in sight while one looks at the map.
            ui.columns(2, |columns| {
                let height = columns[1].available_height();
                self.controls_ui(&mut columns[0], document, regions, None, actions);
                self.pictures_ui(&mut columns[1], height);
            });
        } else {
            let width = ui.available_width();
            self.controls_ui(ui, document, regions, Some(1.6 * width), actions);
        }
    }

    // Forgets the design before, and its picture; one that was read from a file stays.
    fn forget(&mut self) {
        self.regions = RegionList::default();
        if (self.picture.as_ref()).is_some_and(|picture| picture.of_design) {
            *self = Self {
                seen: self.seen,
                ..Self::default()
            };
        }
    }
}

impl Posterise {
    /// The settings and the regions; between them the pictures, where they have this height.
    fn controls_ui(
        &mut self,
        ui: &mut egui::Ui,
        document: &Document,
        regions: Option<&Regions>,
        pictures: Option<f32>,
        actions: &mut Vec<Action>,
    ) {
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            self.source_ui(ui);
            if self.picture.is_some() {
                self.settings_ui(ui, document);
                self.work_ui(ui, document, actions);
                if let Some(height) = pictures {
                    self.pictures_ui(ui, height);
                }
            }
            if let Some(regions) = regions {
                ui.separator();
                self.regions.show(ui, document, regions, actions);
            }
        });
    }

    fn poll(&mut self, ctx: &egui::Context) {
        if let Some(choosing) = &self.choosing {
            match choosing.poll() {
                Outcome::Working => {}
                Outcome::Ready(path) => {
                    self.choosing = None;
                    if let Some(path) = path {
                        self.read_file(ctx, &path);
                    }
                }
                Outcome::Lost => self.choosing = None,
            }
        }
        let Some(reading) = &self.reading else {
            return;
        };
        match reading.poll() {
            Outcome::Working => {}
            Outcome::Ready(Ok(photo)) => {
                self.reading = None;
                if let Some(field) = self.field.take() {
                    ctx.memory_mut(|memory| memory.surrender_focus(field));
                }
                self.problem = (!photo.warnings.is_empty()).then(|| photo.warnings.join("\n"));
                self.take(ctx, Arc::new(photo.source), false);
            }
            Outcome::Ready(Err(problem)) => {
                self.reading = None;
                self.problem = Some(problem);
            }
            Outcome::Lost => {
                self.reading = None;
                self.problem = Some("the picture could not be read: try another".to_owned());
            }
        }
    }

    /// Reads the picture at a path.
    pub fn read_file(&mut self, ctx: &egui::Context, path: &Path) {
        self.path = path.display().to_string();
        self.read(ctx);
    }

    fn read(&mut self, ctx: &egui::Context) {
        let path = PathBuf::from(self.path.trim());
        self.problem = None;
        if let Some(stem) = path.file_stem() {
            self.settings.name = stem.to_string_lossy().into_owned();
        }
        let work = move || photo::load(&path).map_err(|error| error.to_string());
        self.reading = Task::start(ctx, "picture", work).ok();
    }

    /// Takes a picture to be posterised: the open design's own, or another.
    fn take(&mut self, ctx: &egui::Context, source: Arc<SourceImage>, of_design: bool) {
        let image = shrunk(&source, SHOWN);
        self.picture = Some(Picture {
            source,
            number: self
                .picture
                .as_ref()
                .map_or(0, |picture| picture.number + 1),
            of_design,
            texture: ctx.load_texture("picture", image, TextureOptions::LINEAR),
        });
    }

    fn source_ui(&mut self, ui: &mut egui::Ui) {
        let palette = Palette::current(ui);
        ui.horizontal(|ui| {
            let label = ui.label("Picture");
            let field = TextEdit::singleline(&mut self.path).hint_text("path of a photograph");
            let field = ui.add(field).labelled_by(label.id);
            let entered = typing::entered(ui, &field);
            if entered {
                // Left once there is a picture of this path.
                field.request_focus();
                self.field = Some(field.id);
            } else if field.changed() {
                self.field = None;
            }
            if (ui.button("Read").clicked() || entered) && !self.path.trim().is_empty() {
                self.read(ui.ctx());
            }
            if ui.button("Choose…").clicked() && self.choosing.is_none() {
                let ask = || {
                    let dialog = rfd::FileDialog::new().set_title("A picture to posterise");
                    dialog.pick_file()
                };
                self.choosing = Task::start(ui.ctx(), "dialog", ask).ok();
            }
            if self.reading.is_some() {
                ui.spinner();
            }
        });
        if let Some(problem) = &self.problem {
            ui.horizontal_wrapped(|ui| {
                icons::show(ui, Grade::Warning, palette.warning);
                ui.label(RichText::new(visible(problem)).color(palette.warning));
            });
        }
        if self.picture.is_none() {
            let text = "Read a photograph or an artwork: it becomes regions of weaves.";
            ui.label(RichText::new(text).color(palette.quiet));
        }
    }

    fn settings_ui(&mut self, ui: &mut egui::Ui, document: &Document) {
        let settings = &mut self.settings;
        let sett = document.design().sett();
        (settings.ends_per_cm, settings.picks_per_cm) = (sett.ends.per_cm, sett.picks.per_cm);
        ui.horizontal_wrapped(|ui| {
            let label = ui.label("Colours");
            ui.add(egui::Slider::new(&mut settings.colours, COLOURS))
                .labelled_by(label.id);
            if ui.checkbox(&mut settings.dither, "dither").changed() && settings.dither {
                // Dithering is made of specks.
                settings.speck = 0;
            }
            ui.checkbox(&mut settings.preview_only, "own yarns for each colour");
        });
        ui.horizontal_wrapped(|ui| {
            let mut ends = settings.ends.unwrap_or(960);
            let label = ui.label("Ends");
            let field = DragValue::new(&mut ends).range(2..=16_000);
            if typing::number(ui, field).labelled_by(label.id).changed() {
                settings.ends = Some(ends);
            }
            ui.checkbox(&mut self.own_size, "own number of picks");
            if self.own_size {
                let mut picks = settings.picks.unwrap_or(960);
                let label = ui.label("Picks");
                let field = DragValue::new(&mut picks).range(2..=20_000);
                typing::number(ui, field).labelled_by(label.id);
                settings.picks = Some(picks);
                let label = ui.label("fit");
                let fits = egui::ComboBox::from_id_salt("fit");
                let shown = fits
                    .selected_text(fit_name(settings.fit))
                    .show_ui(ui, |ui| {
                        for fit in [Fit::Crop, Fit::Pad, Fit::Stretch] {
                            ui.selectable_value(&mut settings.fit, fit, fit_name(fit));
                        }
                    });
                shown.response.labelled_by(label.id);
            } else {
                // The picks follow from the picture's shape and the sett.
                settings.picks = None;
            }
            // In one piece, so that a narrow pane does not part word and number.
            let field = DragValue::new(&mut settings.speck)
                .range(0..=500)
                .prefix("merge specks under ")
                .suffix(" crossings");
            let name = "Merge specks under so many crossings";
            typing::number(ui, field)
                .widget_info(|| egui::WidgetInfo::labeled(egui::Role::SpinButton, true, name));
        });
    }

    /// Keeps the posterised design up to date and shows it.
    fn work_ui(&mut self, ui: &mut egui::Ui, document: &Document, actions: &mut Vec<Action>) {
        let Some(picture) = &self.picture else {
            return;
        };
        let previous = follows(document.design(), &picture.source);
        let (source, settings) = (Arc::clone(&picture.source), self.settings.clone());
        let question = (picture.number, settings.clone());
        let was_working = self.made.is_working();
        self.made.ask(ui.ctx(), &question, move |job| {
            let made = posterise(&source, &settings, previous.as_deref(), job);
            made.map(Box::new).map_err(|error| error.to_string())
        });
        if was_working && !self.made.is_working() {
            self.seen += 1;
        }
        let palette = Palette::current(ui);
        let made = match self.made.answer() {
            Some(Ok(made)) => made,
            Some(Err(problem)) => {
                ui.label(
                    RichText::new(format!("Error: {}", visible(problem))).color(palette.error),
                );
                return;
            }
            None => {
                ui.label(RichText::new("Reducing the colours…").color(palette.quiet));
                return;
            }
        };
        if self.map.as_ref().is_none_or(|(seen, _)| *seen != self.seen) {
            self.map = Some((self.seen, map_of(ui.ctx(), made)));
        }
        let (ends, picks) = (made.design.ends(), made.design.picks());
        ui.horizontal_wrapped(|ui| {
            let weavable = made.design.weavable();
            let (grade, colour, word) = match weavable {
                true => (Grade::Done, palette.text, "Weavable"),
                false => (
                    Grade::Warning,
                    palette.warning,
                    "Preview only: no loom weaves it",
                ),
            };
            icons::show(ui, grade, colour);
            ui.label(RichText::new(word).color(colour));
            let sett = made.design.sett();
            let across = ends as f32 * sett.ends.mean_pitch_mm() / 10.0;
            let along = picks as f32 * sett.picks.mean_pitch_mm() / 10.0;
            ui.label(format!(
                "{ends} ends × {picks} picks · {across:.1} × {along:.1} cm"
            ));
            let apply = ui.button("Make it the design");
            if apply
                .on_hover_text("Undo brings the present design back")
                .clicked()
            {
                let design = Design::clone(&made.design);
                actions.push(Action::edit(Edit::Replace(Box::new(design))));
            }
            if self.made.is_working() {
                ui.spinner();
            }
        });
        for warning in &made.warnings {
            ui.horizontal_wrapped(|ui| {
                icons::show(ui, Grade::Warning, palette.warning);
                ui.label(
                    RichText::new(visible(warning))
                        .small()
                        .color(palette.warning),
                );
            });
        }
    }

    /// The picture and its map side by side, at most `height` points high.
    fn pictures_ui(&self, ui: &mut egui::Ui, height: f32) {
        let (Some(picture), Some(Ok(made))) = (&self.picture, self.made.answer()) else {
            return;
        };
        ui.horizontal_wrapped(|ui| {
            let width = (ui.available_width() / 2.0 - tokens::GAP).clamp(80.0, 360.0);
            let room = vec2(width, height.min(1.6 * width));
            let aspect = picture.source.height() as f32 / picture.source.width().max(1) as f32;
            shown_ui(ui, &picture.texture, room, aspect, "The picture");
            if let Some((_, map)) = &self.map {
                let sett = made.design.sett();
                let across = made.design.ends() as f32 * sett.ends.mean_pitch_mm();
                let along = made.design.picks() as f32 * sett.picks.mean_pitch_mm();
                let aspect = along / across.max(1e-6);
                shown_ui(ui, map, room, aspect, "Its map of regions");
            }
        });
    }
}

#[cfg(test)]
impl Posterise {
    /// Ends and regions of what was made, once nothing newer is under way.
    pub fn made_of(&self) -> Option<(u32, usize)> {
        let Some(Ok(made)) = self.made.answer().filter(|_| !self.made.is_working()) else {
            return None;
        };
        match made.design.structure() {
            Structure::Regions(regions) => Some((made.design.ends(), regions.palette().len())),
            _ => None,
        }
    }

    /// Takes a picture as if it had been read, for a small cloth.
    pub fn take_small(&mut self, ctx: &egui::Context, source: SourceImage) {
        self.settings.ends = Some(64);
        self.settings.colours = 3;
        self.take(ctx, Arc::new(source), false);
    }
}

/// The design whose weaves and locks go on, where it is of the same picture.
fn follows(design: &Arc<Design>, source: &Arc<SourceImage>) -> Option<Arc<Design>> {
    match design.structure() {
        Structure::Regions(regions) => {
            let same = regions
                .source()
                .is_some_and(|known| Arc::ptr_eq(known, source));
            same.then(|| Arc::clone(design))
        }
        _ => None,
    }
}

fn fit_name(fit: Fit) -> &'static str {
    match fit {
        Fit::Crop => "crop",
        Fit::Pad => "pad",
        Fit::Stretch => "stretch",
    }
}

/// A picture as large as its shape and the room allow.
fn shown_ui(ui: &mut egui::Ui, texture: &TextureHandle, room: Vec2, aspect: f32, name: &str) {
    let height = (room.x * aspect).min(room.y);
    let size = vec2(height / aspect.max(1e-6), height);
    let image = egui::Image::new((texture.id(), size))
        .fit_to_exact_size(size)
        .alt_text(name);
    ui.add(image).on_hover_text(name);
}

/// The regions in their colours, at most [`SHOWN`] pixels a side.
fn map_of(ctx: &egui::Context, made: &Posterised) -> TextureHandle {
    let (ends, picks) = (made.design.ends(), made.design.picks());
    let step = ends.max(picks).div_ceil(SHOWN as u32).max(1);
    let size = [
        (ends / step).max(1) as usize,
        (picks / step).max(1) as usize,
    ];
    let Structure::Regions(regions) = made.design.structure() else {
        let image = egui::ColorImage::filled([1, 1], tokens::SURROUND);
        return ctx.load_texture("map", image, TextureOptions::NEAREST);
    };
    let pixels = (0..size[0] * size[1])
        .map(|at| {
            let end = (at % size[0]) as u32 * step;
            let pick = picks - 1 - ((at / size[0]) as u32 * step).min(picks - 1);
            let region = regions.map().get(end.min(ends - 1), pick);
            let colour = regions
                .palette()
                .get(usize::from(region))
                .and_then(|r| r.colour);
            let Srgb(red, green, blue) = colour.unwrap_or(Srgb(0, 0, 0));
            tokens::yarn_colour(red, green, blue)
        })
        .collect();
    let image = egui::ColorImage::new(size, pixels);
    ctx.load_texture("map", image, TextureOptions::NEAREST)
}
