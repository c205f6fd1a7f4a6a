//! The viewer: its state, its layout and what its commands do.

use egui::{CentralPanel, Frame, Id, Panel, Rect, RichText, ViewportCommand, pos2, vec2};
use pickglass::exemplar::ExemplarStore;
use pickglass::formats::presets;
use pickglass::render::View;

use super::cloth_pane::ClothPane;
use super::export::{Export, Exported};
use super::files::{Files, Opening};
use super::menu::{self, Choice, Chosen};
use super::status::{self, Cancel, Status};
use super::strip::Strip;
use super::toasts::{Grade, Toasts};
use super::view::ClothView;
use super::worker::{ClothWorker, Phase, PreviewRequest};
use crate::command_table::Command;
use crate::opened::Opened;
use crate::tokens::{self, Palette};
use pickglass::still::{EffectChoice, LightChoice, StillRequest, usual_width_mm};

/// One step of the zoom keys.
const ZOOM_STEP: f32 = 1.25;
/// Millimetres of cloth a point at actual size, on a screen of 96 points an inch.
const ACTUAL_SIZE: f32 = 25.4 / 96.0;
/// A preview has at most this many pixels; beyond, it is drawn smaller and stretched.
const MOST_PIXELS: f32 = 4.0e6;

/// How previews are made.
pub struct PreviewSettings {
    pub store: ExemplarStore,
    pub effects: EffectChoice,
    pub dials: Vec<(String, String)>,
}

impl Default for PreviewSettings {
    fn default() -> Self {
        Self {
            store: ExemplarStore::user(),
            effects: EffectChoice::default(),
            // Each pass is shown.
            dials: vec![("pass-spp".to_owned(), "1".to_owned())],
        }
    }
}

/// The window's state.
pub struct Viewer {
    opened: Option<Opened>,
    view: View,
    light: LightChoice,
    /// `None` until the pane's size is known, or when the view is to be set anew.
    cloth_view: Option<ClothView>,
    /// Whether a view set anew shows the whole repeat, or the view's usual width.
    fit: bool,
    effects: EffectChoice,
    dials: Vec<(String, String)>,
    pane: ClothPane,
    /// What was last asked of the worker.
    asked: Option<StillRequest>,
    generation: u64,
    worker: ClothWorker,
    reported_failure: Option<String>,
    strip: Strip,
    show_strip: bool,
    paused: bool,
    show_shortcuts: bool,
    files: Files,
    export: Export,
    toasts: Toasts,
    /// The crossing under the pointer, in words.
    crossing: Option<String>,
    frames_left: Option<u32>,
}

impl Viewer {
    /// A viewer of a design, or of nothing yet.
    pub fn new(
        ctx: &egui::Context,
        opened: Option<Opened>,
        preview: PreviewSettings,
    ) -> std::io::Result<Self> {
        tokens::apply(ctx);
        let wake = ctx.clone();
        let mut viewer = Self {
            opened: None,
            view: View::Face,
            light: LightChoice::default(),
            cloth_view: None,
            fit: false,
            effects: preview.effects,
            dials: preview.dials,
            pane: ClothPane::default(),
            asked: None,
            generation: 0,
            worker: ClothWorker::start(preview.store, move || wake.request_repaint())?,
            reported_failure: None,
            strip: Strip::default(),
            show_strip: true,
            paused: false,
            show_shortcuts: false,
            files: Files::default(),
            export: Export::default(),
            toasts: Toasts::default(),
            crossing: None,
            frames_left: None,
        };
        if let Some(opened) = opened {
            viewer.take_design(ctx, opened);
        }
        Ok(viewer)
    }

    /// Closes itself after this many frames.
    pub fn closing_after(mut self, frames: Option<u32>) -> Self {
        self.frames_left = frames;
        self
    }

    fn take_design(&mut self, ctx: &egui::Context, opened: Opened) {
        for warning in &opened.warnings {
            self.toasts
                .say(Grade::Warning, warning.clone(), "The design was opened.");
        }
        let title = format!("{} — Pickglass", opened.name());
        ctx.send_viewport_cmd(ViewportCommand::Title(title));
        self.opened = Some(opened);
        self.cloth_view = None;
        self.pane.shown = None;
        self.asked = None;
    }

    fn pick_up(&mut self, ctx: &egui::Context) {
        match self.files.poll(ctx) {
            Some(Opening::Opened(opened)) => self.take_design(ctx, *opened),
            Some(Opening::Failed(error)) => {
                let kept = match &self.opened {
                    Some(opened) => format!("{} is still open.", opened.name()),
                    None => String::new(),
                };
                self.toasts.say(Grade::Error, error, kept);
            }
            None => {}
        }
        match self.export.poll() {
            Some(Exported::Written(path, report)) => {
                let text = format!("Wrote {}", path.display());
                let kept = format!("{} × {}, {} spp", report.width, report.height, report.spp);
                self.toasts.say(Grade::Done, text, kept);
            }
            Some(Exported::Cancelled) => {
                self.toasts.say(
                    Grade::Done,
                    "The export was cancelled.",
                    "No file was written.",
                );
            }
            Some(Exported::Failed(error)) => {
                self.toasts.say(
                    Grade::Error,
                    error,
                    "An earlier file of that name is unchanged.",
                );
            }
            None => {}
        }
        if let Some(picture) = self.worker.take_picture()
            && picture.generation == self.generation
        {
            self.pane.take(ctx, picture);
        }
        if let Some(error) = self.worker.take_failure() {
            self.toasts
                .say(Grade::Error, error, "The coarse cloth is still shown.");
        }
        if let Phase::Failed(error) = self.worker.phase()
            && self.reported_failure.as_ref() != Some(&error)
        {
            self.toasts.say(
                Grade::Error,
                error.clone(),
                "The last picture is still shown.",
            );
            self.reported_failure = Some(error);
        }
        let dropped = ctx.input_mut(|input| std::mem::take(&mut input.raw.dropped_files));
        if let Some(file) = dropped.first() {
            self.files.open(ctx, file.path().to_path_buf());
        }
    }

    fn obey(&mut self, ctx: &egui::Context, command: Command) {
        match command {
            Command::Open => self.files.ask(ctx),
            Command::OpenPath => self.files.type_path("Type or paste it; Enter opens it."),
            Command::Quit => ctx.send_viewport_cmd(ViewportCommand::Close),
            Command::Theme => {
                let theme = match ctx.theme() {
                    egui::Theme::Dark => egui::Theme::Light,
                    egui::Theme::Light => egui::Theme::Dark,
                };
                ctx.set_theme(theme);
            }
            Command::Shortcuts => self.show_shortcuts = true,
            Command::Strip => self.show_strip = !self.show_strip,
            _ if self.opened.is_none() => {}
            Command::Export => {
                if let (Some(opened), Some(asked)) = (&self.opened, &self.asked) {
                    self.export.ask(opened.clone(), asked.clone());
                }
            }
            Command::Look(view) => {
                self.view = view;
                self.fit = false;
                self.cloth_view = None;
            }
            Command::Fit => {
                if !self.view.turns_over() {
                    self.view = View::Face;
                }
                self.fit = true;
                self.cloth_view = None;
            }
            Command::ActualSize => self.rescale(|view| view.mm_per_point = ACTUAL_SIZE),
            Command::ZoomIn => self.zoom(ZOOM_STEP),
            Command::ZoomOut => self.zoom(1.0 / ZOOM_STEP),
            Command::Pause if self.paused => self.resume(),
            Command::Pause => {
                self.paused = true;
                self.worker.stop();
            }
        }
    }

    fn resume(&mut self) {
        self.paused = false;
        self.asked = None;
    }

    fn rescale(&mut self, change: impl FnOnce(&mut ClothView)) {
        if let Some(view) = &mut self.cloth_view {
            change(view);
        }
    }

    fn zoom(&mut self, factor: f32) {
        self.rescale(|view| {
            let pane = Rect::from_center_size(pos2(0.0, 0.0), vec2(1.0, 1.0));
            view.zoom(pane, pane.center(), factor);
        });
    }

    fn initial_view(&self, pane: Rect, opened: &Opened) -> ClothView {
        let middle = opened.whole_mm().map(|mm| mm / 2.0);
        let mut view = if self.fit {
            ClothView::fitting(pane, middle, opened.whole_mm())
        } else {
            ClothView::across(pane, middle, usual_width_mm(self.view, &opened.design))
        };
        view.mirrored = self.view.turns_over();
        view
    }

    /// Asks for a new picture when what is to be seen has changed.
    fn ask_worker(&mut self, pane: Rect, density: f32) {
        let (Some(opened), Some(view)) = (&self.opened, self.cloth_view) else {
            return;
        };
        let pixels = pane.size() * density;
        let shrink = (MOST_PIXELS / (pixels.x * pixels.y).max(1.0))
            .sqrt()
            .min(1.0);
        let still = StillRequest {
            width: ((pixels.x * shrink) as u32).max(1),
            height: ((pixels.y * shrink) as u32).max(1),
            view: self.view,
            width_mm: Some(view.width_mm(pane)),
            centre_mm: Some(view.centre_mm),
            light: self.light.clone(),
            effects: self.effects.clone(),
            dials: self.dials.clone(),
            ..StillRequest::default()
        };
        if self.asked.as_ref() == Some(&still) {
            return;
        }
        self.asked = Some(still.clone());
        if self.paused {
            return;
        }
        self.generation += 1;
        self.reported_failure = None;
        self.worker.request(PreviewRequest {
            generation: self.generation,
            design: std::sync::Arc::clone(&opened.design),
            still,
        });
    }

    fn menu_ui(&mut self, ui: &mut egui::Ui) {
        let title = self
            .opened
            .as_ref()
            .map_or("", |opened| opened.name())
            .to_owned();
        let chosen = Chosen {
            view: self.view,
            light: &self.light,
            strip: self.show_strip,
            paused: self.paused,
            has_design: self.opened.is_some(),
        };
        let choice = menu::show(ui, &chosen, &title);
        let ctx = ui.ctx().clone();
        match choice {
            Some(Choice::Command(command)) => self.obey(&ctx, command),
            Some(Choice::Preset(name)) => self.files.open_preset(&ctx, name),
            Some(Choice::Light(preset)) => self.light = LightChoice::Preset(preset.to_owned()),
            None => {}
        }
    }

    fn status_ui(&mut self, ui: &mut egui::Ui) {
        let phase = self.worker.phase();
        let cancel = status::show(
            ui,
            &Status {
                opened: self.opened.as_ref(),
                shown: self.pane.shown.as_ref(),
                phase: &phase,
                building: self.worker.building(),
                paused: self.paused,
                export: self.export.progress(),
                reading: self.files.reading(),
                crossing: self.crossing.as_deref(),
            },
        );
        match cancel {
            Some(Cancel::Preview) => {
                self.paused = true;
                self.worker.stop();
            }
            Some(Cancel::Export) => self.export.cancel(),
            None => {}
        }
    }

    fn strip_ui(&mut self, ui: &mut egui::Ui) {
        let Some(opened) = &self.opened else {
            return;
        };
        let shown = self.shown_in_repeats(opened);
        if let Some(at) = self.strip.show(ui, opened, shown) {
            let size = opened.whole_mm();
            let centre = [at[0] * size[0], at[1] * size[1]];
            self.rescale(|view| view.centre_mm = centre);
        }
    }

    /// The part of the cloth that is asked for, in repeats, brought home to the first.
    fn shown_in_repeats(&self, opened: &Opened) -> Option<Rect> {
        let still = self.asked.as_ref()?;
        let (centre, width) = (still.centre_mm?, still.width_mm?);
        let size = opened.whole_mm();
        let height = width * still.height as f32 / still.width.max(1) as f32;
        let home = |mm: f32, repeat: f32| (mm / repeat).rem_euclid(1.0);
        let rect = Rect::from_center_size(
            pos2(home(centre[0], size[0]), home(centre[1], size[1])),
            vec2(width / size[0], height / size[1]),
        );
        // A view of the whole repeat or more says nothing.
        (rect.width() < 1.0 || rect.height() < 1.0).then_some(rect)
    }

    fn cloth_ui(&mut self, ui: &mut egui::Ui) {
        let pane = ui.available_rect_before_wrap();
        let Some(opened) = self.opened.clone() else {
            return;
        };
        let mut view = match self.cloth_view {
            Some(view) => view,
            None => self.initial_view(pane, &opened),
        };
        let description = format!("Cloth of {}", opened.name());
        let response = self.pane.show(ui, &mut view, &description);
        self.cloth_view = Some(view);
        self.ask_worker(pane, ui.ctx().pixels_per_point());
        if self.pane.shown.is_none() {
            self.busy_ui(ui, pane);
        }
        // Only the straight views show where a crossing lies.
        let straight = matches!(self.view, View::Face | View::Back);
        self.crossing = response
            .hover_pos()
            .filter(|_| straight)
            .and_then(|at| opened.describe_crossing(view.to_cloth(pane, at)));
    }

    /// In the middle of an empty pane: what is being done, how far, cancel.
    fn busy_ui(&mut self, ui: &mut egui::Ui, pane: Rect) {
        let phase = self.worker.phase();
        plate(ui, pane, |ui| match phase {
            Phase::Preparing => {
                ui.label(RichText::new("Preparing the cloth").text_style(egui::TextStyle::Heading));
                ui.spinner();
                if ui.button("Stop").clicked() {
                    self.paused = true;
                    self.worker.stop();
                }
            }
            _ if self.paused => {
                ui.label(RichText::new("Stopped").text_style(egui::TextStyle::Heading));
                ui.label("The cloth is not being drawn.");
                if ui.button("Draw it").clicked() {
                    self.resume();
                }
            }
            Phase::Failed(error) => {
                ui.label(RichText::new("Error").text_style(egui::TextStyle::Heading));
                ui.label(error);
                if ui.button("Try again").clicked() {
                    self.asked = None;
                }
            }
            _ => {
                ui.label("Drawing the cloth");
            }
        });
    }

    /// Nothing is open: what one can do.
    fn empty_ui(&mut self, ui: &mut egui::Ui) {
        let pane = ui.available_rect_before_wrap();
        ui.painter().rect_filled(pane, 0.0, tokens::SURROUND);
        let ctx = ui.ctx().clone();
        plate(ui, pane, |ui| {
            ui.label(RichText::new("Nothing is open").text_style(tokens::title()));
            ui.label("Drop a .wif or .ron file here, or start from a preset.");
            ui.add_space(tokens::GAP);
            if ui.button("Open…").clicked() {
                self.files.ask(&ctx);
            }
            ui.add_space(tokens::GAP);
            for preset in presets::names() {
                if ui.button(preset).clicked() {
                    self.files.open_preset(&ctx, preset);
                }
            }
        });
    }

    fn count_frame(&mut self, ctx: &egui::Context) {
        if let Some(left) = &mut self.frames_left {
            *left = left.saturating_sub(1);
            if *left == 0 {
                ctx.send_viewport_cmd(ViewportCommand::Close);
            }
            ctx.request_repaint();
        }
    }
}

/// A plate in the middle of the pane.
fn plate(ui: &mut egui::Ui, pane: Rect, content: impl FnOnce(&mut egui::Ui)) {
    let palette = Palette::current(ui);
    egui::Area::new(Id::unique("plate"))
        .order(egui::Order::Middle)
        .pivot(egui::Align2::CENTER_CENTER)
        .fixed_pos(pane.center())
        .show(ui.ctx(), |ui| {
            Frame::new()
                .fill(palette.raised)
                .corner_radius(tokens::RADIUS)
                .inner_margin(2.0 * tokens::PAD)
                .show(ui, |ui| {
                    ui.set_max_width(tokens::TOAST_WIDTH);
                    ui.vertical_centered(content);
                });
        });
}

/// What will happen when the files over the window are dropped.
fn hovered_ui(ctx: &egui::Context, pane: Rect) {
    let hovering = ctx.input(|input| !input.raw.hovered_files.is_empty());
    if !hovering {
        return;
    }
    let layer = egui::LayerId::new(egui::Order::Foreground, Id::unique("drop"));
    let painter = ctx.layer_painter(layer);
    let stroke = egui::Stroke::new(3.0, tokens::ACCENT);
    painter.rect_stroke(
        pane.shrink(2.0),
        tokens::RADIUS,
        stroke,
        egui::StrokeKind::Inside,
    );
}

#[cfg(test)]
impl Viewer {
    /// Whether a picture is shown.
    pub fn has_picture(&self) -> bool {
        self.pane.shown.is_some()
    }

    /// Whether the picture is of full size and from the full exemplars.
    pub fn has_full_picture(&self) -> bool {
        let full = |shown: &super::cloth_pane::Shown| shown.full_size && shown.full_cloth;
        self.pane.shown.as_ref().is_some_and(full)
    }

    pub fn asked_view(&self) -> Option<View> {
        self.asked.as_ref().map(|asked| asked.view)
    }

    pub fn cloth_view(&self) -> Option<ClothView> {
        self.cloth_view
    }

    pub fn set_export_defaults(&mut self, width: u32, seconds: f64, path: &std::path::Path) {
        self.export.defaults = super::export::Defaults {
            width,
            seconds,
            path: Some(path.to_owned()),
        };
    }

    pub fn pause(&mut self) {
        self.paused = true;
        self.worker.stop();
        self.generation += 1;
        self.pane.shown = None;
        self.asked = None;
    }
}

impl eframe::App for Viewer {
    fn ui(&mut self, ui: &mut egui::Ui, _frame: &mut eframe::Frame) {
        let ctx = ui.ctx().clone();
        self.pick_up(&ctx);
        if let Some(command) = menu::pressed(&ctx) {
            self.obey(&ctx, command);
        }
        Panel::top("menu").show(ui, |ui| self.menu_ui(ui));
        Panel::bottom("status")
            .exact_size(7.0 * tokens::GRID)
            .show(ui, |ui| self.status_ui(ui));
        if self.show_strip && self.opened.is_some() {
            Panel::left("strip")
                .default_size(tokens::STRIP_WIDTH)
                .show(ui, |ui| self.strip_ui(ui));
        }
        let pane = ui.available_rect_before_wrap();
        CentralPanel::default().frame(Frame::NONE).show(ui, |ui| {
            if self.opened.is_some() {
                self.cloth_ui(ui);
            } else {
                self.empty_ui(ui);
            }
        });
        hovered_ui(&ctx, pane);
        self.toasts.show(&ctx, pane.right_bottom());
        self.files.show(&ctx);
        self.export.show(&ctx);
        if self.show_shortcuts {
            self.show_shortcuts = menu::shortcuts_ui(&ctx);
        }
        self.count_frame(&ctx);
    }
}
