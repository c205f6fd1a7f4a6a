//! The cloth pane: what is looked at and how, what the worker is asked for, and what it
//! says while it works.

use std::time::Instant;

use egui::{Frame, Id, PointerButton, Rect, RichText, Vec2, pos2, vec2};
use pickglass::accuracy::{Asked, Axis};
use pickglass::edit::Document;
use pickglass::engine::{self, Heading, LightChoice, StillRequest, usual_width_mm};
use pickglass::exemplar::ExemplarStore;
use pickglass::plan::{Effect, EffectChoice, Settings};
use pickglass::render::Backing;
use pickglass::scene::View;
use pickglass::text::visible;

use super::action::Action;
use super::cloth::bar::{self, Says};
use super::cloth::compare::Compare;
use super::cloth::glass::{self, Glass};
use super::cloth::lamp;
use super::cloth::sheet::{Kind as SheetKind, Sheet};
use super::cloth_pane::{ClothPane, KEY_STEP};
use super::laid::Laid;
use super::toasts::Grade;
use super::view::ClothView;
use super::worker::{Aim, Building, ClothWorker, Phase, PreviewRequest, Quality};
use crate::command_table::{ClothCommand, Toward, ZoomCommand};
use crate::tokens::{self, Palette};

/// One step of the zoom keys.
const ZOOM_STEP: f32 = 1.25;
/// Degrees that the eye turns for a point of dragging, and how low it may go.
const TURN_A_POINT: f32 = 0.4;
const LOWEST_EYE: f32 = 12.0;
/// Degrees that a key turns the eye.
const TURN_STEP: f32 = 5.0;
/// Millimetres of cloth a point at actual size, on a screen of 96 points an inch: where
/// nobody has held a card against it.
const ACTUAL_SIZE: f32 = 25.4 / 96.0;
/// A preview has at most this many pixels; beyond, it is drawn smaller and stretched.
const MOST_PIXELS: f32 = 4.0e6;

/// How previews are made.
pub struct PreviewSettings {
    pub store: ExemplarStore,
    pub effects: EffectChoice,
    pub settings: Settings,
}

impl Default for PreviewSettings {
    fn default() -> Self {
        let mut settings = Settings::default();
        // Each pass is shown.
        settings.render.pass_spp = 1;
        Self {
            store: ExemplarStore::user(),
            effects: EffectChoice::default(),
            settings,
        }
    }
}

/// The cloth as it is looked at.
pub struct Preview {
    pub view: View,
    pub light: LightChoice,
    /// Until when pictures are refined.
    pub quality: Quality,
    pub paused: bool,
    pub pane: ClothPane,
    /// The cloth is turned by 180°, as the draft is.
    pub turned: bool,
    /// The crossing that is marked on the cloth, as in every view.
    pub marked: Option<(i64, i64)>,
    /// Millimetres a point of this screen.
    pub mm_per_point: f32,
    /// Where the eye was turned to; `None` = where the view looks from.
    eye: Option<[f32; 2]>,
    glass: Glass,
    compare: Option<Compare>,
    calibrating: bool,
    /// The colourways in the place of the cloth.
    sheet: Option<Sheet>,
    /// `None` until the pane's size is known, or when the view is to be set anew.
    cloth_view: Option<ClothView>,
    /// Whether a view set anew shows the whole repeat, or the view's usual width.
    fit: bool,
    effects: EffectChoice,
    settings: Settings,
    laid: Option<Laid>,
    /// What was last asked of the worker, and of which cloth, by [`Laid::cloth`].
    asked: Option<(u64, StillRequest)>,
    generation: u64,
    /// When the newest picture was asked for.
    begun: Instant,
    worker: ClothWorker,
    reported_failure: Option<String>,
    /// Whether the pointer or the keyboard is on the cloth.
    in_use: bool,
    widget: Option<Id>,
    /// The pane when it was shown last, points.
    pane_size: Vec2,
}

impl Preview {
    /// Starts the worker; `ctx` is woken whenever it has something.
    pub fn new(ctx: &egui::Context, settings: PreviewSettings) -> std::io::Result<Self> {
        let wake = ctx.clone();
        Ok(Self {
            view: View::Face,
            light: LightChoice::default(),
            quality: Quality::default(),
            paused: false,
            pane: ClothPane::default(),
            turned: false,
            marked: None,
            mm_per_point: ACTUAL_SIZE,
            eye: None,
            glass: Glass::default(),
            compare: None,
            calibrating: false,
            sheet: None,
            cloth_view: None,
            fit: false,
            effects: settings.effects,
            settings: settings.settings,
            laid: None,
            asked: None,
            generation: 0,
            begun: Instant::now(),
            worker: ClothWorker::start(settings.store, move || wake.request_repaint())?,
            reported_failure: None,
            in_use: false,
            widget: None,
            pane_size: Vec2::ZERO,
        })
    }

    /// Looks at the design as one that was just opened.
    pub fn look_anew(&mut self) {
        self.cloth_view = None;
        self.fit = false;
    }

    /// Forgets what was seen: another document is open.
    pub fn forget(&mut self) {
        self.look_anew();
        self.pane.forget();
        self.compare = None;
        self.sheet = None;
        self.asked = None;
        self.laid = None;
    }

    /// Shows the colourways in the place of the cloth, or the cloth alone again.
    pub fn toggle_sheet(&mut self, kind: SheetKind) {
        self.sheet = match self.sheet_kind() {
            Some(shown) if shown == kind => None,
            _ => Some(Sheet::new(kind)),
        };
    }

    /// Whether a sheet is open and all its cloths are drawn.
    #[cfg(test)]
    pub fn sheet_is_drawn(&self) -> bool {
        self.sheet.as_ref().is_some_and(Sheet::is_drawn)
    }

    /// How the colourways are shown, if they are.
    pub fn sheet_kind(&self) -> Option<SheetKind> {
        self.sheet.as_ref().map(|sheet| sheet.kind)
    }

    /// Whether keys such as `F` mean the cloth.
    pub fn in_use(&self) -> bool {
        self.in_use
    }

    /// Gives the keyboard to the cloth.
    pub fn focus(&self, ctx: &egui::Context) {
        if let Some(id) = self.widget {
            ctx.memory_mut(|memory| memory.request_focus(id));
        }
    }

    /// What the worker is at.
    pub fn phase(&self) -> Phase {
        self.worker.phase()
    }

    /// Refines until pictures are as good as this.
    pub fn refine_until(&mut self, quality: Quality) {
        if self.quality != quality {
            self.quality = quality;
            self.asked = None;
        }
    }

    /// Turns a dial or switches an effect, by name.
    ///
    /// # Errors
    /// One line that says why not.
    pub fn set(&mut self, name: &str, value: &str) -> Result<(), String> {
        let asked = Asked {
            request: self.look(),
            renderer: engine::reference(),
        };
        let set = Axis::named(name).and_then(|axis| axis.set(&asked, value));
        let request = set.map_err(|error| error.to_string())?.request;
        (self.settings, self.effects) = (request.settings, request.effects);
        Ok(())
    }

    /// Switches an effect on or off by name; `None` = by itself again.
    pub fn switch(&mut self, effect: Effect, on: Option<bool>) {
        self.effects.switch(effect, on);
    }

    /// Refining waits while nobody sees the window.
    pub fn set_hidden(&self, hidden: bool) {
        self.worker.set_hidden(hidden);
    }

    /// Whether it waits for that.
    pub fn is_hidden(&self) -> bool {
        self.worker.is_hidden()
    }

    /// How far the building of exemplars is.
    pub fn building(&self) -> Option<Building> {
        self.worker.building()
    }

    /// What was last asked for, for an export of the same.
    pub fn asked(&self) -> Option<&StillRequest> {
        self.asked.as_ref().map(|(_, still)| still)
    }

    /// Takes what the worker finished.
    pub fn poll(&mut self, ctx: &egui::Context, actions: &mut Vec<Action>) {
        let mut failed = |error: String, kept: &str| {
            actions.push(Action::Say(Grade::Error, error, kept.to_owned()));
        };
        if let Some(picture) = self.worker.take_picture()
            && picture.generation == self.generation
        {
            self.pane.take(ctx, picture);
        }
        if let Some(picture) = self.worker.take_glass()
            && self.glass.is_held()
        {
            self.glass.take(ctx, picture);
        }
        if let Some(error) = self.worker.take_failure() {
            failed(error, "The last picture is still shown.");
        }
        if let Phase::Failed(error) = self.worker.phase()
            && self.reported_failure.as_ref() != Some(&error)
        {
            failed(error.clone(), "The last picture is still shown.");
            self.reported_failure = Some(error);
        }
    }

    /// Looks at the cloth as a command says.
    pub fn run_command(&mut self, command: ClothCommand) {
        match command {
            ClothCommand::Look(view) => {
                self.view = view;
                self.eye = None;
                self.fit = false;
                self.cloth_view = None;
            }
            ClothCommand::Pause if self.paused => self.resume(),
            ClothCommand::Pause => self.pause(),
            ClothCommand::TurnOver => self.turn_over(),
            ClothCommand::Straighten => self.straighten(),
            ClothCommand::Orbit(toward) => self.turn_by(step(toward) * TURN_STEP),
            ClothCommand::Pan(toward) => {
                let by = step(toward) * vec2(-1.0, 1.0) * self.pane_size * KEY_STEP;
                self.rescale(|view| view.pan(by));
            }
        }
    }

    /// Shows the cloth as large as a command says.
    pub fn zoom_as(&mut self, command: ZoomCommand) {
        match command {
            ZoomCommand::Fit => {
                if !self.view.pose(self.turned).back {
                    self.view = View::Face;
                }
                self.fit = true;
                self.cloth_view = None;
            }
            ZoomCommand::ActualSize => {
                let actual = self.mm_per_point;
                self.rescale(|view| view.mm_per_point = actual);
            }
            ZoomCommand::In => self.zoom(ZOOM_STEP),
            ZoomCommand::Out => self.zoom(1.0 / ZOOM_STEP),
        }
    }

    /// Seconds since the picture was asked for, while the worker is at it.
    pub fn working(&self) -> Option<f64> {
        let at_work = matches!(self.worker.phase(), Phase::Preparing | Phase::Refining);
        let seen = at_work && !self.paused && !self.is_hidden();
        seen.then(|| self.begun.elapsed().as_secs_f64())
    }

    /// Stops drawing until [`Self::resume`].
    pub fn pause(&mut self) {
        self.paused = true;
        self.worker.stop();
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

    /// Shows the pane.
    pub fn show(&mut self, ui: &mut egui::Ui, document: &Document, actions: &mut Vec<Action>) {
        let pane = ui.available_rect_before_wrap();
        self.pane_size = pane.size();
        let laid = Laid::of(document, self.laid.take());
        let mut view = match self.cloth_view {
            Some(view) => view,
            None => self.initial_view(pane, &laid),
        };
        view.turned = self.turned;
        if document.design().colourways().is_empty() {
            self.sheet = None;
        }
        if let Some(mut sheet) = self.sheet.take() {
            let still = self.look();
            self.in_use = ui.rect_contains_pointer(pane);
            if sheet.show(ui, document, &mut view, &still, actions) {
                self.sheet = Some(sheet);
            }
            self.cloth_view = Some(view);
            self.laid = Some(laid);
            return;
        }
        let description = format!("Cloth of {}", visible(&document.design().name));
        let straight = self.is_straight();
        let marked = (self.marked.filter(|_| straight))
            .map(|(end, pick)| laid.near(view.centre_mm, end, pick));
        let response = self.pane.show(ui, &mut view, &description, marked);
        self.turn(&response);
        self.in_use = response.hovered() || response.has_focus();
        self.widget = Some(response.id);
        self.cloth_view = Some(view);
        let asked = self.asked.as_ref().map(|(_, still)| still);
        match self.glass.hold(ui, &response, pane, view, asked) {
            Some(glass::Wish::Look(still)) => self.ask(Aim::Glass, *still, &laid),
            Some(glass::Wish::Leave) => self.asked = None,
            None => {}
        }
        if !self.glass.is_held() {
            self.ask_worker(pane, ui.ctx().pixels_per_point(), &laid);
        }
        if self.pane.shown.is_none() {
            self.busy_ui(ui, pane);
        } else {
            self.over_ui(ui, pane, view);
        }
        self.calibrate_ui(ui, actions);
        // Only the straight views show where a crossing lies.
        if let Some(at) = response.hover_pos().filter(|_| straight) {
            let crossing = laid.crossing_at(view.to_cloth(pane, at));
            actions.push(Action::Hover(Some(crossing)));
        }
        self.laid = Some(laid);
    }

    /// The right button turns the eye round the cloth.
    fn turn(&mut self, response: &egui::Response) {
        if !response.dragged_by(PointerButton::Secondary) {
            return;
        }
        // The cloth follows the pointer, so the eye goes against it.
        self.turn_by(-response.drag_delta() * TURN_A_POINT);
    }

    /// Turns the eye by degrees to the right and upwards.
    fn turn_by(&mut self, by: Vec2) {
        let [azimuth, elevation] = self.eye.unwrap_or([-90.0, 90.0]);
        self.eye = Some([
            (azimuth + by.x + 180.0).rem_euclid(360.0) - 180.0,
            (elevation + by.y).clamp(LOWEST_EYE, 90.0),
        ]);
    }

    fn is_straight(&self) -> bool {
        self.eye.is_none() && self.view.is_straight()
    }

    fn turn_over(&mut self) {
        let back = self.view.pose(self.turned).back;
        self.view = if back { View::Face } else { View::Back };
        if let Some(view) = &mut self.cloth_view {
            view.mirrored = !back;
        }
    }

    fn straighten(&mut self) {
        self.eye = None;
        if !self.view.pose(self.turned).back {
            self.view = View::Face;
        }
    }

    /// Holds the pick glass without a key, or lets go of it.
    pub fn pin_glass(&mut self) {
        self.glass.pin();
    }

    /// What lies over the picture.
    fn over_ui(&mut self, ui: &mut egui::Ui, pane: Rect, view: ClothView) {
        if let Some(compare) = &mut self.compare {
            compare.show(ui, pane, view);
        }
        let lamp_at = pane.right_bottom() - vec2(1.0, 1.0) * (lamp::RADIUS + tokens::PAD);
        if pane.size().min_elem() > 6.0 * lamp::RADIUS {
            lamp::show(ui, lamp_at, &mut self.light);
        }
        let says = Says {
            back: self.view.pose(self.turned).back,
            slanting: !self.is_straight(),
            kept: self.compare.is_some(),
            near: self.in_use,
        };
        match bar::show(ui, pane, &says) {
            Some(bar::Wish::TurnOver) => self.turn_over(),
            Some(bar::Wish::Straighten) => self.straighten(),
            Some(bar::Wish::Keep) => {
                self.compare = (self.pane.shown.as_ref())
                    .map(|shown| Compare::keep(ui.ctx(), shown.still.clone(), &shown.image));
            }
            Some(bar::Wish::Forget) => self.compare = None,
            Some(bar::Wish::Calibrate) => self.calibrating = true,
            None => {}
        }
        self.glass.show(ui, pane, view);
    }

    /// The window in which the screen's scale is set; what was set is kept.
    fn calibrate_ui(&mut self, ui: &egui::Ui, actions: &mut Vec<Action>) {
        if self.calibrating {
            self.calibrating = bar::calibrate(ui.ctx(), &mut self.mm_per_point);
            if !self.calibrating {
                actions.push(Action::Calibrated(self.mm_per_point));
            }
        }
    }

    fn initial_view(&self, pane: Rect, laid: &Laid) -> ClothView {
        let middle = laid.whole_mm().map(|mm| mm / 2.0);
        let straight = self.view.is_straight();
        let mut view = if self.fit {
            ClothView::fitting(pane, middle, laid.whole_mm())
        } else if straight {
            let aspect = pane.width().max(1.0) / pane.height().max(1.0);
            ClothView::across(pane, middle, laid.opened_mm(aspect))
        } else {
            ClothView::across(pane, middle, usual_width_mm(self.view, &laid.design))
        };
        view.mirrored = self.view.pose(self.turned).back;
        view
    }

    /// From where the cloth is looked at, in which light and how exactly.
    pub fn look(&self) -> StillRequest {
        StillRequest {
            view: self.view,
            turned: self.turned,
            eye: self.eye.map(|[azimuth, elevation]| Heading {
                azimuth: azimuth.round() as i16,
                elevation: elevation.round() as i16,
            }),
            light: self.light.clone(),
            // As exported pictures have it.
            backing: Backing::Itself,
            effects: self.effects.clone(),
            settings: self.settings.clone(),
            ..StillRequest::default()
        }
    }

    /// Asks for a new picture when what is to be seen has changed.
    fn ask_worker(&mut self, pane: Rect, density: f32, laid: &Laid) {
        let Some(view) = self.cloth_view else {
            return;
        };
        let pixels = pane.size() * density;
        let shrink = (MOST_PIXELS / (pixels.x * pixels.y).max(1.0))
            .sqrt()
            .min(1.0);
        let still = StillRequest {
            width: ((pixels.x * shrink) as u32).max(1),
            height: ((pixels.y * shrink) as u32).max(1),
            width_mm: Some(view.width_mm(pane)),
            centre_mm: Some(view.centre_mm),
            ..self.look()
        };
        let wanted = (laid.cloth, still);
        if self.asked.as_ref() == Some(&wanted) {
            return;
        }
        let still = wanted.1.clone();
        self.asked = Some(wanted);
        if self.paused {
            return;
        }
        self.generation += 1;
        self.begun = Instant::now();
        self.ask(Aim::Pane, still, laid);
    }

    fn ask(&mut self, aim: Aim, still: StillRequest, laid: &Laid) {
        self.reported_failure = None;
        let blank = match aim {
            Aim::Pane => self.pane.shown.is_none(),
            Aim::Glass => !self.glass.has_picture(),
        };
        self.worker.request(PreviewRequest {
            generation: self.generation,
            aim,
            design: std::sync::Arc::clone(&laid.design),
            drawdown: std::sync::Arc::clone(&laid.drawdown),
            still,
            quality: self.quality,
            blank,
        });
    }

    /// In the middle of an empty pane: what is being done, how far, cancel.
    fn busy_ui(&mut self, ui: &mut egui::Ui, pane: Rect) {
        let phase = self.worker.phase();
        plate(ui, pane, |ui| match phase {
            Phase::Preparing => {
                ui.label(RichText::new("Preparing the cloth").text_style(egui::TextStyle::Heading));
                ui.spinner();
                if ui.button("Stop").clicked() {
                    self.pause();
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
}

/// One step to the right and upwards.
fn step(toward: Toward) -> Vec2 {
    match toward {
        Toward::Left => vec2(-1.0, 0.0),
        Toward::Right => vec2(1.0, 0.0),
        Toward::Up => vec2(0.0, 1.0),
        Toward::Down => vec2(0.0, -1.0),
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

#[cfg(test)]
impl Preview {
    /// Number of the newest request.
    pub fn generation(&self) -> u64 {
        self.generation
    }

    /// Whether the pick glass shows a picture.
    pub fn glass_has_picture(&self) -> bool {
        self.glass.has_picture()
    }

    /// Whether the picture is of full size and from the full exemplars.
    pub fn has_full_picture(&self) -> bool {
        let full = |shown: &super::cloth_pane::Shown| {
            shown.full_size && shown.fibres == super::worker::Fibres::Full
        };
        self.pane.shown.as_ref().is_some_and(full)
    }

    pub fn cloth_view(&self) -> Option<ClothView> {
        self.cloth_view
    }

    /// Stops for a picture of the window that does not change.
    pub fn freeze(&mut self) {
        self.pause();
        self.generation += 1;
        self.pane.forget();
        self.asked = None;
    }
}
