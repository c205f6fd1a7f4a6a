//! The window's state and its frame: what is read off the threads, what is shown where,
//! and then all that was asked for.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use egui::{CentralPanel, Frame, Id, Panel, Rect, ViewportCommand};
use pickglass::edit::{Document, recovery};
use pickglass::exemplar::ExemplarStore;
use pickglass::text::visible;

use super::action::Action;
use super::asking::Asking;
use super::autosave::{Autosave, RecoveryFolder, Rescued};
use super::cloth::bar::is_scale;
use super::crossing;
use super::draft::DraftPane;
use super::export::Export;
use super::files::Files;
use super::import::Import;
use super::layout::Layout;
use super::lost::{Guard, Restarts};
use super::machine_check::MachineCheck;
use super::menu::{self, Choice, Situation};
use super::palette::CommandPalette;
use super::panes::{Pane, Panes};
use super::preview::{Preview, PreviewSettings};
use super::session::Session;
use super::settings::{Settings, SettingsFile};
use super::settings_form::SettingsForm;
use super::start::StartPage;
use super::status::{self, Cancel, Status};
use super::toasts::{Grade, Toasts};
use super::tools;
use super::typing::Keys;
use super::volume::VolumeExport;
use crate::opened::Opened;
use crate::tokens;

/// What the app is made with.
#[derive(Default)]
pub struct AppOptions {
    pub preview: PreviewSettings,
    pub settings: SettingsFile,
    pub recovery: RecoveryFolder,
}

/// The window's state.
pub struct App {
    pub(super) session: Option<Session>,
    pub(super) draft: DraftPane,
    pub(super) preview: Preview,
    pub(super) panes: Panes,
    pub(super) layout: Layout,
    pub(super) start: StartPage,
    pub(super) files: Files,
    /// What is asked of an image before it is opened.
    pub(super) import: Option<Import>,
    pub(super) autosave: Autosave,
    pub(super) export: Export,
    pub(super) volume: VolumeExport,
    pub(super) asking: Asking,
    pub(super) palette: CommandPalette,
    pub(super) toasts: Toasts,
    pub(super) settings: Settings,
    pub(super) settings_file: SettingsFile,
    pub(super) show_shortcuts: bool,
    pub(super) settings_form: Option<SettingsForm>,
    pub(super) machine_check: Option<MachineCheck>,
    /// Where exemplars are kept.
    pub(super) store: ExemplarStore,
    keys: Keys,
    /// The open design was made of a picture.
    pub(super) pictured: bool,
    /// The crossing of the endless cloth under the pointer, in whichever view.
    pub(super) hover: Option<(i64, i64)>,
    /// The window may close: nothing is unsaved, or the person said so.
    pub(super) may_close: bool,
    /// The title the system was last told.
    pub(super) told_title: String,
    frames_left: Option<u32>,
    /// The device the window is drawn with, and after how many frames it is lost on trial.
    guard: Option<Guard>,
    lose_after: Option<u32>,
    pub(super) ctx: egui::Context,
    /// Time spent in each frame.
    #[cfg(test)]
    pub(super) spent: super::tests::Spent,
}

impl App {
    /// The window of a design, or of the start page.
    pub fn new(
        ctx: &egui::Context,
        opened: Option<Opened>,
        options: AppOptions,
    ) -> std::io::Result<Self> {
        tokens::apply(ctx);
        let (mut settings, wrong) = options.settings.read();
        if settings.light {
            ctx.set_theme(egui::Theme::Light);
        }
        let store = options.preview.store.clone();
        let mut app = Self {
            session: None,
            draft: DraftPane::of(&settings),
            preview: Preview::new(ctx, options.preview)?,
            panes: Panes::default(),
            layout: Layout::from_kept(settings.layout.take()),
            start: StartPage::default(),
            files: Files::default(),
            import: None,
            autosave: Autosave::new(ctx, options.recovery),
            export: Export::default(),
            volume: VolumeExport::default(),
            asking: Asking::default(),
            palette: CommandPalette::default(),
            toasts: Toasts::default(),
            settings,
            settings_file: options.settings,
            show_shortcuts: false,
            settings_form: None,
            machine_check: None,
            store,
            keys: Keys::default(),
            pictured: false,
            hover: None,
            may_close: false,
            told_title: String::new(),
            frames_left: None,
            guard: None,
            lose_after: None,
            ctx: ctx.clone(),
            #[cfg(test)]
            spent: super::tests::Spent::default(),
        };
        app.preview.quality = app.settings.quality;
        if let Some(scale) = app.settings.mm_per_point.filter(|mm| is_scale(*mm)) {
            app.preview.mm_per_point = scale;
        }
        if let Some(wrong) = wrong {
            app.warn(wrong, "Nothing of your designs is lost.");
        }
        if let Some(opened) = opened {
            let session = Session::of(&opened);
            app.take_design(&opened, session);
        }
        Ok(app)
    }

    /// Closes itself after this many frames.
    pub fn closing_after(mut self, frames: Option<u32>) -> Self {
        self.frames_left = frames;
        self
    }

    /// Loses the graphics device after this many frames.
    pub fn losing_after(mut self, frames: Option<u32>) -> Self {
        self.lose_after = frames;
        self
    }

    /// Opens a recovery copy, and says so where the program started itself again.
    pub fn begin_with(
        &mut self,
        ctx: &egui::Context,
        recover: Option<PathBuf>,
        restarts: &Restarts,
    ) {
        if restarts.happened() {
            let what = "The graphics device was lost, so the window was opened anew.";
            self.warn(what, "Your work is as it was.");
        }
        match recover.as_deref().map(recovery::describe) {
            Some(Ok(found)) => self.files.recover(ctx, &found),
            Some(Err(error)) => self.say(Grade::Error, error.to_string(), ""),
            None => {}
        }
    }

    /// Watches the device the window is drawn with: when it is lost, `lost` is set, what is
    /// open is written, and `then` is done on another thread.
    pub fn watch(
        &mut self,
        device: &eframe::wgpu::Device,
        lost: Arc<AtomicBool>,
        then: Arc<dyn Fn(Rescued) + Send + Sync>,
    ) {
        let rescuer = self.autosave.rescuer();
        self.guard = rescuer.map(|rescuer| Guard::new(device, rescuer, lost, then));
    }

    /// Asks whether the device is still there, so that whoever watches it hears.
    fn mind_device(&mut self) {
        let Some(guard) = &self.guard else { return };
        if let Some(left) = &mut self.lose_after {
            if *left == 0 {
                guard.destroy();
            }
            *left = left.saturating_sub(1);
            self.ctx.request_repaint();
        }
        guard.ask();
    }

    /// What the menus and the palette need to know.
    pub(super) fn situation(&self) -> Situation<'_> {
        let document = self.session.as_ref().map(|session| &session.document);
        let name = |entry: usize| {
            let entry = document?.entries().get(entry)?;
            Some(entry.name().to_owned())
        };
        let at = document.map_or(0, Document::position);
        Situation {
            open: document.is_some(),
            undo: document.filter(|d| d.can_undo()).and_then(|_| name(at)),
            redo: document.filter(|d| d.can_redo()).and_then(|_| name(at + 1)),
            selection: self.draft.selection().is_some(),
            view: self.preview.view,
            light: &self.preview.light,
            quality: self.preview.quality,
            paused: self.preview.paused,
            tool: self.draft.tool(),
            arrangement: self.draft.show.arrangement,
            structure_alone: self.draft.show.structure_alone,
            grid_lines: self.draft.show.grid_lines,
            long_floats: self.draft.show.long_floats,
            ghosts: self.draft.show.ghosts,
            navigator: self.draft.show.navigator,
            symmetry: self.draft.symmetry,
            steps: self.draft.steps.on,
            reference: self
                .draft
                .reference
                .as_ref()
                .map(|reference| reference.shown),
            colourways: document.map_or(0, |document| document.design().colourways().len()),
            sheet: self.preview.sheet_kind(),
            recent: &self.settings.recent,
        }
    }

    fn menu_ui(&mut self, ui: &mut egui::Ui) {
        let title = self.session.as_ref().map_or_else(String::new, |session| {
            let mark = if session.document.is_modified() {
                " *"
            } else {
                ""
            };
            format!("{}{mark}", visible(session.name()))
        });
        let choice = menu::show(ui, &self.situation(), &title);
        let ctx = ui.ctx().clone();
        match choice {
            Some(Choice::Command(command)) => self.run_command(&ctx, command),
            Some(Choice::Preset(name)) => self.leave_for(&ctx, super::asking::Next::Preset(name)),
            Some(Choice::Recent(path)) => self.leave_for(&ctx, super::asking::Next::File(path)),
            Some(Choice::Light(preset)) => self.set_light(preset),
            Some(Choice::Quality(quality)) => self.preview.refine_until(quality),
            None => {}
        }
    }

    fn status_ui(&mut self, ui: &mut egui::Ui) {
        let phase = self.preview.phase();
        let document = self.session.as_ref().map(|session| &session.document);
        let crossing = document
            .zip(self.hover)
            .and_then(|(document, at)| crossing::describe(document, at, self.draft.limits));
        let cancel = status::show(
            ui,
            &Status {
                design: document.map(|document| document.design().as_ref()),
                shown: self.preview.pane.shown.as_ref(),
                foretold: &|| self.preview.pane.foretold(),
                phase: &phase,
                building: self.preview.building(),
                paused: self.preview.paused,
                working: self.preview.working(),
                hidden: self.preview.is_hidden(),
                measuring: self.panes.is_measuring(),
                quality: self.preview.quality,
                export: self.export.progress().or_else(|| self.volume.progress()),
                files: self.files.at_work(),
                crossing: crossing.as_deref(),
                tool: self.draft.tool_words(),
            },
        );
        match cancel {
            Some(Cancel::Preview) => self.preview.pause(),
            Some(Cancel::Export) => {
                self.export.cancel();
                self.volume.cancel();
            }
            None => {}
        }
    }

    fn work_ui(&mut self, ui: &mut egui::Ui, actions: &mut Vec<Action>) {
        let Some(session) = &self.session else {
            return;
        };
        let document = &session.document;
        let (draft, preview, panes) = (&mut self.draft, &mut self.preview, &mut self.panes);
        draft.set_hover(self.hover);
        preview.marked = self.hover;
        panes.section.follow(self.hover);
        panes.look(preview.asked());
        panes.effects.follow(preview.look());
        (preview.turned, panes.turned) = (draft.turned(), draft.turned());
        Panel::left("tools")
            .exact_size(tokens::TOOLS_WIDTH)
            .resizable(false)
            .show(ui, |ui| tools::show(ui, draft, document, actions));
        let ground = Frame::NONE.fill(tokens::Palette::current(ui).panel);
        CentralPanel::default().frame(ground).show(ui, |ui| {
            self.layout.show(ui, &mut |ui, pane| match pane {
                Pane::Draft => draft.show(ui, document, actions),
                Pane::Cloth => preview.show(ui, document, actions),
                other => {
                    let room = Frame::NONE.inner_margin(tokens::GAP);
                    room.show(ui, |ui| panes.show(other, ui, document, actions));
                }
            });
        });
    }

    fn count_frame(&mut self, ctx: &egui::Context) {
        if let Some(left) = &mut self.frames_left {
            *left = left.saturating_sub(1);
            if *left == 0 {
                self.may_close = true;
                ctx.send_viewport_cmd(ViewportCommand::Close);
            }
            ctx.request_repaint();
        }
    }

    /// What will be kept for the next start.
    fn keep_settings(&mut self, ctx: &egui::Context) {
        self.remember_reference();
        let show = &self.draft.show;
        self.settings.light = ctx.theme() == egui::Theme::Light;
        self.settings.layout = Some(self.layout.kept());
        self.settings.grid_lines = show.grid_lines;
        self.settings.ghosts = show.ghosts;
        self.settings.long_floats = show.long_floats;
        self.settings.navigator = show.navigator;
        self.settings.quality = self.preview.quality;
        self.write_settings();
    }

    /// Writes the settings as they are; a failure is a line in the log.
    pub(super) fn write_settings(&self) {
        if let Err(error) = self.settings_file.write(&self.settings) {
            log::warn!("{error}");
        }
    }
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

impl eframe::App for App {
    fn ui(&mut self, ui: &mut egui::Ui, _frame: &mut eframe::Frame) {
        #[cfg(test)]
        let begun = super::tests::Clocks::now();
        self.frame(ui);
        #[cfg(test)]
        self.spent.frame(begun);
    }

    /// Also done while the window is hidden: work is copied even then.
    fn logic(&mut self, ctx: &egui::Context, _frame: &mut eframe::Frame) {
        #[cfg(test)]
        let begun = super::tests::Clocks::now();
        self.mind_device();
        let visible = ctx.input(|input| input.viewport().visible());
        let waits = visible == Some(false) || self.panes.is_measuring();
        self.preview.set_hidden(waits);
        if let Some(session) = &self.session {
            self.autosave.keep(ctx, session);
        }
        #[cfg(test)]
        self.spent.before(begun);
    }

    fn on_exit(&mut self) {
        let ctx = self.ctx.clone();
        self.keep_settings(&ctx);
        let modified =
            (self.session.as_ref()).is_some_and(|session| session.document.is_modified());
        if !modified || self.may_close {
            self.autosave.leave();
        }
        self.autosave.finish();
    }
}

impl App {
    /// What was finished is taken, keys are followed, all is shown, and what the panes asked
    /// for is done.
    fn frame(&mut self, ui: &mut egui::Ui) {
        let ctx = ui.ctx().clone();
        let mut actions = Vec::new();
        self.preview.poll(&ctx, &mut actions);
        self.pick_up(&ctx);
        // What is asked is answered before anything else is done.
        let asked = ctx.memory(|memory| memory.top_modal_layer().is_some());
        self.keys.begin(&ctx);
        while !asked && let Some((command, place)) = menu::pressed(&ctx) {
            self.run_command(&ctx, command);
            // Keys pressed in one slow frame are all meant.
            if !menu::goes_on(command) {
                self.keys.put_off(&ctx, place);
                break;
            }
        }
        self.ask_before_closing(&ctx);
        Panel::top("menu").show(ui, |ui| self.menu_ui(ui));
        Panel::bottom("status")
            .exact_size(7.0 * tokens::GRID)
            .show(ui, |ui| self.status_ui(ui));
        let pane = ui.available_rect_before_wrap();
        if self.session.is_some() {
            self.work_ui(ui, &mut actions);
        } else {
            self.start_ui(ui);
        }
        hovered_ui(&ctx, pane);
        self.toasts.show(&ctx, pane.right_bottom());
        self.files.show(&ctx);
        self.import_ui(&ctx);
        self.export.show(&ctx);
        self.volume.show(&ctx);
        self.asking_ui(&ctx);
        let mut palette = std::mem::take(&mut self.palette);
        let command = palette.show(&ctx, &self.situation());
        self.palette = palette;
        if let Some(command) = command {
            self.run_command(&ctx, command);
        }
        if self.show_shortcuts {
            self.show_shortcuts = menu::shortcuts_ui(&ctx);
        }
        let form = self.settings_form.take();
        self.settings_form = form.and_then(|mut form| form.show(&ctx).then_some(form));
        let check = self.machine_check.take();
        self.machine_check = check.and_then(|mut check| check.show(&ctx).then_some(check));
        self.act(&ctx, actions);
        self.autosave.note(self.session.as_ref());
        self.count_frame(&ctx);
    }

    fn start_ui(&mut self, ui: &mut egui::Ui) {
        let ctx = ui.ctx().clone();
        let mut choice = None;
        CentralPanel::default().show(ui, |ui| {
            choice = self
                .start
                .show(ui, &self.settings.recent, &self.autosave.found);
        });
        match choice {
            Some(super::start::Choice::Command(command)) => self.run_command(&ctx, command),
            Some(super::start::Choice::Preset(name)) => self.files.open_preset(&ctx, name),
            Some(super::start::Choice::Recent(path)) => self.files.open(&ctx, path),
            Some(super::start::Choice::Recover(found)) => self.files.recover(&ctx, &found),
            Some(super::start::Choice::Discard(path)) => self.autosave.discard(&path),
            None => {}
        }
    }
}

#[cfg(test)]
impl App {
    pub fn document(&self) -> Option<&Document> {
        self.session.as_ref().map(|session| &session.document)
    }

    /// Every setting is put into the file now, as at the end.
    pub fn keep_now(&mut self, ctx: &egui::Context) {
        self.keep_settings(ctx);
    }
}
