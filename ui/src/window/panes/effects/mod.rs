//! Effects: what the picture simulates, switched one by one; a look at the picture says what
//! each costs and changes, and what may be left out of it.

mod looking;
mod pair;
#[cfg(test)]
mod tests;
mod words;

use egui::{Button, Id, Label, RichText, ScrollArea, Ui, UiBuilder, WidgetInfo, vec2};
use pickglass::edit::Document;
use pickglass::engine::{self, StillRequest};
use pickglass::plan::{Effect, Planned, Settings, Subject};

use super::columns::{cell, column, widest};
use super::{PaneView, Shown};
use crate::tokens::{self, Palette};
use crate::window::action::Action;
use crate::window::task::Outcome;
use looking::{Look, Looked, Stale};
use pair::PairView;

pub use words::{sentence, title};

/// What may be left out, as a share of the light of 95 of 100 places.
const TOLERANCES: [f64; 5] = [0.0, 0.005, 0.01, 0.02, 0.05];
/// Room from which the pictures stand beside the rows, points.
const BESIDE: egui::Vec2 = vec2(160.0 * tokens::GRID, 24.0 * tokens::GRID);
/// Width of the pictures beside them, points.
const PICTURE: f32 = 80.0 * tokens::GRID;
/// Height of the pictures among them, points.
const AMONG: f32 = 40.0 * tokens::GRID;
/// Least width of words beside a switch, points.
const WORDS: f32 = 60.0 * tokens::GRID;

/// Said below what a look found.
const OVERLAP: &str = "Shares overlap, as light that is scattered meets hairs and shadows as well: \
                       they do not add up to 100 %.";
/// Said below the switches.
const NOT_UNDONE: &str = "A switch is no part of the design: undo leaves it.";

/// The rows, and what was found.
pub struct EffectsPane {
    /// The picture of the cloth, as it is looked at, once it is.
    asked: Option<StillRequest>,
    /// What pictures are asked for with now.
    now: StillRequest,
    tolerance: f64,
    running: Option<Look>,
    looked: Option<Looked>,
    /// Another number for each look.
    number: u64,
    failed: Option<String>,
    /// The row whose pictures are shown.
    chosen: Option<Effect>,
    pair: PairView,
}

impl Default for EffectsPane {
    fn default() -> Self {
        Self {
            asked: None,
            now: StillRequest::default(),
            tolerance: TOLERANCES[2],
            running: None,
            looked: None,
            number: 0,
            failed: None,
            chosen: None,
            pair: PairView::default(),
        }
    }
}

impl PaneView for EffectsPane {
    fn show(&mut self, ui: &mut Ui, shown: &Shown<'_>, actions: &mut Vec<Action>) {
        self.poll();
        let room = ui.available_size();
        if self.looked.is_none() || room.x < BESIDE.x || room.y < BESIDE.y {
            self.list_ui(ui, shown.document, true, actions);
            return;
        }
        let picture = vec2(PICTURE.min(0.35 * room.x), room.y);
        let list = room.x - picture.x - ui.spacing().item_spacing.x;
        ui.horizontal_top(|ui| {
            column(ui, vec2(list, room.y), |ui| {
                self.list_ui(ui, shown.document, false, actions);
            });
            column(ui, picture, |ui| self.pair_ui(ui, picture));
        });
    }

    // Forgets what was found of the design before.
    fn forget(&mut self) {
        *self = Self {
            tolerance: self.tolerance,
            ..Self::default()
        };
    }
}

impl EffectsPane {
    /// How the cloth is looked at now.
    pub fn look(&mut self, asked: Option<&StillRequest>) {
        if self.asked.as_ref() != asked {
            self.asked = asked.cloned();
        }
    }

    /// What pictures are asked for with now.
    pub fn follow(&mut self, now: StillRequest) {
        self.now = now;
    }

    /// Whether it looks: all else that works would be timed as well.
    pub fn is_looking(&self) -> bool {
        self.running.is_some()
    }

    fn poll(&mut self) {
        let Some(running) = &self.running else { return };
        match running.poll() {
            Outcome::Working => return,
            Outcome::Ready(Ok(Some(looked))) => {
                self.chosen = looked.dearest().map(|(effect, _)| effect).or(self.chosen);
                self.looked = Some(looked);
                self.number += 1;
            }
            // It was stopped: what was found before stays.
            Outcome::Ready(Ok(None)) => {}
            Outcome::Ready(Err(error)) => self.failed = Some(error),
            Outcome::Lost => self.failed = Some("looking ended before it was done".to_owned()),
        }
        self.running = None;
    }

    /// What is being done, and what can be.
    fn head_ui(&mut self, ui: &mut Ui, document: &Document, actions: &mut Vec<Action>) {
        ui.horizontal_wrapped(|ui| {
            if let Some(running) = &self.running {
                ui.label(running.progress());
                if ui.button("Stop looking").clicked() {
                    running.cancel();
                }
            } else {
                let look = ui.add_enabled(self.asked.is_some(), Button::new("Look"));
                let tip = "See what each effect costs and changes; the cloth waits meanwhile";
                if look.on_hover_text(tip).clicked() {
                    self.start(ui.ctx(), document);
                }
                self.tolerance_ui(ui);
            }
            let leave = self.to_leave_out(document);
            let button = Button::new("Leave out what does not show");
            let tip = "Switch off what the look found to be unseen";
            let button = ui.add_enabled(!leave.is_empty(), button).on_hover_text(tip);
            if button.clicked() {
                actions.extend(leave);
            }
            let all = self.to_have_all();
            let button = ui.add_enabled(!all.is_empty(), Button::new("All effects"));
            let tip = "Every switch on auto, and light scattered as often as usual";
            if button.on_hover_text(tip).clicked() {
                actions.extend(all);
            }
        });
        if let Some(failed) = &self.failed {
            ui.label(RichText::new(failed).color(Palette::current(ui).error));
        }
    }

    fn tolerance_ui(&mut self, ui: &mut Ui) {
        ui.label("Unseen below");
        for tolerance in TOLERANCES {
            let told = format!("{} %", 100.0 * tolerance);
            let chosen = self.tolerance.to_bits() == tolerance.to_bits();
            let radio = ui.radio(chosen, &told);
            radio.widget_info(|| {
                let spoken = format!("Unseen below {told}");
                WidgetInfo::selected(egui::Role::RadioButton, true, chosen, spoken)
            });
            let tip = "What changes 95 of 100 places by less counts as unseen";
            if radio.on_hover_text(tip).clicked() {
                self.tolerance = tolerance;
            }
        }
    }

    fn start(&mut self, ctx: &egui::Context, document: &Document) {
        let Some(asked) = self.asked.clone() else {
            return;
        };
        self.failed = None;
        match looking::start(ctx, document, asked, self.tolerance) {
            Ok(running) => self.running = Some(running),
            Err(error) => self.failed = Some(format!("no thread to look on: {error}")),
        }
    }

    /// What is not of the picture that is shown, of what was found.
    fn stale(&self, document: &Document) -> Option<Stale> {
        let (looked, asked) = (self.looked.as_ref()?, self.asked.as_ref()?);
        looked.stale(asked, document, self.tolerance)
    }

    /// What leaves out all that does not show; nothing where there is none, or nobody knows.
    fn to_leave_out(&self, document: &Document) -> Vec<Action> {
        let Some(looked) = &self.looked else {
            return Vec::new();
        };
        if matches!(self.stale(document), Some(Stale::Design | Stale::View)) {
            return Vec::new();
        }
        let unseen = looked.unseen().map(|need| need.effect);
        let still_on = unseen.filter(|effect| self.now.effects.named(*effect) != Some(false));
        let off = still_on.map(|effect| Action::Switch(effect, Some(false)));
        let usual = self.now.settings.render.max_order;
        let order = looked.order.filter(|order| *order != usual);
        off.chain(order.map(set_order)).collect()
    }

    /// What brings all effects back; nothing where they are there.
    fn to_have_all(&self) -> Vec<Action> {
        let named = Effect::ALL.iter().copied();
        let named = named.filter(|effect| self.now.effects.named(*effect).is_some());
        let usual = Settings::default().render.max_order;
        let order = (self.now.settings.render.max_order != usual).then_some(usual);
        let auto = named.map(|effect| Action::Switch(effect, None));
        auto.chain(order.map(set_order)).collect()
    }

    /// What the look comes to.
    fn verdict_ui(&self, ui: &mut Ui, document: &Document) {
        let palette = Palette::current(ui);
        let Some(looked) = &self.looked else {
            let told = "What each effect costs in this picture, and what it changes: a look says \
                        so, on this machine. The cloth waits meanwhile.";
            ui.label(RichText::new(told).color(palette.quiet));
            return;
        };
        ui.label(RichText::new(words::verdict(looked)).strong());
        if let Some(stale) = self.stale(document) {
            let colour = match stale {
                Stale::Design | Stale::View => palette.warning,
                Stale::Switched => palette.quiet,
            };
            ui.label(RichText::new(words::stale(stale)).color(colour));
        }
    }

    /// What can be done, and a row for each effect; `among` = the pictures stand below the
    /// chosen one.
    fn list_ui(
        &mut self,
        ui: &mut Ui,
        document: &Document,
        among: bool,
        actions: &mut Vec<Action>,
    ) {
        self.head_ui(ui, document, actions);
        let plan = engine::reference().plan(&self.now, Subject::Cloth);
        let rows = match plan {
            Ok(plan) => plan.effects,
            Err(error) => {
                ui.label(RichText::new(error.to_string()).color(Palette::current(ui).error));
                return;
            }
        };
        let titles: Vec<String> = rows.iter().map(|row| words::title(row.effect)).collect();
        let width = widest(ui, titles.iter().map(String::as_str));
        let scrolled = ScrollArea::vertical().id_salt("effects").auto_shrink(false);
        scrolled.show(ui, |ui| {
            self.verdict_ui(ui, document);
            for (row, title) in rows.iter().zip(&titles) {
                // The keyboard stays where it is when something is said above.
                let own = UiBuilder::new().scope_id(Id::unique(("effect", title)));
                ui.scope_builder(own, |ui| self.row_ui(ui, row, (title, width), actions));
                if among && self.chosen == Some(row.effect) {
                    self.pair_ui(ui, vec2(ui.available_width(), AMONG));
                }
            }
            let quiet = Palette::current(ui).quiet;
            if self.looked.is_some() {
                ui.label(RichText::new(OVERLAP).color(quiet));
            }
            ui.label(RichText::new(NOT_UNDONE).color(quiet));
        });
    }

    fn row_ui(
        &mut self,
        ui: &mut Ui,
        row: &Planned,
        (title, width): (&str, f32),
        actions: &mut Vec<Action>,
    ) {
        let need = (self.looked.as_ref()).and_then(|looked| looked.need(row.effect));
        let found = need.map(words::found).unwrap_or_default();
        let told = format!("{} {found}", words::state(row, need.is_some()));
        let words = |ui: &mut Ui| ui.add(Label::new(told.trim_end()).wrap());
        let chosen = self.looked.is_some() && self.chosen == Some(row.effect);
        let beside = ui.horizontal_top(|ui| {
            let name = cell(ui, width, |ui| ui.add(Button::selectable(chosen, title)));
            if name.on_hover_text(words::about(row.effect)).clicked() {
                self.chosen = Some(row.effect);
            }
            if let Some(on) = switch_ui(ui, title, self.now.effects.named(row.effect)) {
                actions.push(Action::Switch(row.effect, on));
            }
            let beside = ui.available_width() > WORDS;
            if beside {
                ui.vertical(|ui| {
                    // On the line of the switch.
                    ui.add_space(tokens::GRID);
                    words(ui);
                });
            }
            beside
        });
        if !beside.inner {
            words(ui);
        }
    }

    /// The pictures of the chosen row.
    fn pair_ui(&mut self, ui: &mut Ui, room: egui::Vec2) {
        if let (Some(looked), Some(effect)) = (&self.looked, self.chosen) {
            let own = UiBuilder::new().scope_id(Id::unique("effect in pictures"));
            let (looked, pair) = ((looked, self.number), &mut self.pair);
            ui.scope_builder(own, |ui| pair.show(ui, looked, effect, room));
        }
    }
}

fn set_order(order: u32) -> Action {
    Action::Set("order".to_owned(), order.to_string())
}

/// Auto, on or off; what was clicked.
fn switch_ui(ui: &mut Ui, title: &str, now: Option<bool>) -> Option<Option<bool>> {
    let mut clicked = None;
    let places = [
        (
            "auto",
            None,
            "As the picture calls for; nothing is left out unasked",
        ),
        ("on", Some(true), "Simulated"),
        ("off", Some(false), "Left out"),
    ];
    for (word, place, tip) in places {
        let chosen = now == place;
        let button = ui.add(Button::selectable(chosen, word));
        button.widget_info(|| {
            let spoken = format!("{title}: {word}");
            WidgetInfo::selected(egui::Role::RadioButton, true, chosen, spoken)
        });
        if button.on_hover_text(tip).clicked() {
            clicked = Some(place);
        }
    }
    clicked
}
