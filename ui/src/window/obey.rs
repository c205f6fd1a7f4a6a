//! What the commands and the actions of the panes do: the one place where the document
//! changes.

use std::path::PathBuf;

use egui::ViewportCommand;
use pickglass::edit::{Cells, Change, Direction, Edit, EditError, Rect};
use pickglass::still::LightChoice;

use super::action::{Action, Button, Mark};
use super::app::App;
use super::asking::{Answer, Next};
use super::draft::Clip;
use super::export::Exported;
use super::files::{FileEvent, Writing};
use super::panes::Pane;
use super::session::Session;
use super::toasts::Grade;
use crate::command_table::{Command, DraftLayout, Tool, Toward};
use crate::opened::Opened;

impl App {
    /// Does what the panes asked for, in order.
    pub(super) fn act(&mut self, ctx: &egui::Context, actions: Vec<Action>) {
        self.hover = None;
        self.draft.mark = Mark::Nothing;
        for action in actions {
            match action {
                Action::Edit(edit) => self.edit(*edit),
                Action::Begin(name) => {
                    if let Some(session) = &mut self.session {
                        session.document.begin(name);
                    }
                }
                Action::Restart => self.rework(|session| Some(session.document.restart())),
                Action::Finish => {
                    if let Some(session) = &mut self.session {
                        session.document.finish();
                    }
                }
                Action::Cancel => self.rework(|session| Some(session.document.cancel())),
                Action::GoTo(entry) => self.rework(|session| session.document.go_to(entry)),
                Action::Command(command) => self.obey(ctx, command),
                Action::Hover(at) => self.hover = at.or(self.hover),
                Action::Mark(mark) => self.draft.mark = mark,
                Action::LookAt { end, pick } => {
                    self.draft.look_at(end, pick);
                    self.layout.bring(Pane::Draft);
                }
                Action::PaintYarn(yarn, button) => {
                    self.draft.yarns[usize::from(button == Button::Second)] = yarn;
                }
                Action::PaintRegion(region, button) => {
                    self.draft.regions[usize::from(button == Button::Second)] = region;
                }
                Action::Limits(limits) => self.draft.limits = limits,
                Action::Show(pane) => self.layout.bring(pane),
                Action::Say(grade, text, kept) => self.say(grade, text, kept),
            }
        }
    }

    /// Tells the person, and keeps it in the log.
    pub(super) fn say(&mut self, grade: Grade, text: impl Into<String>, kept: impl Into<String>) {
        let (text, kept) = (text.into(), kept.into());
        self.panes.log.add(grade, &text, &kept);
        self.toasts.say(grade, text, kept);
    }

    pub(super) fn warn(&mut self, text: impl Into<String>, kept: &str) {
        self.say(Grade::Warning, text, kept);
    }

    /// Does an edit, or asks what to do instead where it is refused.
    fn edit(&mut self, edit: Edit) {
        let Some(session) = &mut self.session else {
            return;
        };
        let edit = match edit {
            Edit::Paint { .. } | Edit::Place { .. } | Edit::Flip(_)
                if self.asking.derive_always && super::draft::is_shaft_draft(&session.document) =>
            {
                Edit::DeriveDraft {
                    after: Some(Box::new(edit)),
                }
            }
            other => other,
        };
        // Only what a question could be about is kept for it.
        let refused = matches!(
            edit,
            Edit::Paint { .. } | Edit::Place { .. } | Edit::Flip(_) | Edit::PaintRegion { .. }
        )
        .then(|| edit.clone());
        match session.document.apply(edit) {
            Ok(change) => self.changed(&change),
            Err(error) => self.refused(&error, refused),
        }
    }

    fn refused(&mut self, error: &EditError, edit: Option<Edit>) {
        self.draft.give_up();
        self.rework(|session| Some(session.document.cancel()));
        let remedies = edit.map_or_else(Vec::new, |edit| error.remedies(&edit));
        if remedies.is_empty() {
            self.say(Grade::Error, error.to_string(), "The design is as it was.");
        } else {
            self.asking.about_refused(error.to_string(), remedies);
        }
    }

    /// Goes to another state of the document.
    fn rework(&mut self, go: impl FnOnce(&mut Session) -> Option<Change>) {
        if let Some(change) = self.session.as_mut().and_then(go) {
            self.changed(&change);
        }
    }

    /// Lets every view know what to draw again.
    fn changed(&mut self, change: &Change) {
        let Some(session) = &self.session else {
            return;
        };
        if !change.is_nothing() {
            self.draft.changed(&session.document, change);
        }
    }

    /// Opens a design.
    pub(super) fn take_design(&mut self, opened: &Opened, path: Option<PathBuf>) {
        for warning in &opened.warnings {
            self.warn(warning.clone(), "The design was opened.");
        }
        if let Some(path) = &path {
            self.settings.opened(path);
            self.write_settings();
        }
        self.session = Some(Session::of(opened, path));
        self.draft.forget();
        self.preview.forget();
        self.asking.derive_always = false;
    }

    /// Takes what the threads finished, and files that were dropped.
    pub(super) fn pick_up(&mut self, ctx: &egui::Context) {
        let session = self.session.as_ref();
        self.files.write_chosen(ctx, || session.map(writing));
        while let Some(event) = self.files.poll(ctx) {
            self.file_event(ctx, event);
        }
        match self.export.poll() {
            Some(Exported::Written(path, report)) => {
                let text = format!("Wrote {}", path.display());
                let kept = format!("{} × {}, {} spp", report.width, report.height, report.spp);
                self.say(Grade::Done, text, kept);
            }
            Some(Exported::Cancelled) => {
                self.say(
                    Grade::Done,
                    "The export was cancelled.",
                    "No file was written.",
                );
            }
            Some(Exported::Failed(error)) => {
                self.say(
                    Grade::Error,
                    error,
                    "An earlier file of that name is unchanged.",
                );
            }
            None => {}
        }
        let dropped = ctx.input_mut(|input| std::mem::take(&mut input.raw.dropped_files));
        if let Some(file) = dropped.first() {
            self.leave_for(ctx, Next::File(file.path().to_path_buf()));
        }
        if let Some(session) = &self.session {
            let title = session.title();
            if self.told_title != title {
                ctx.send_viewport_cmd(ViewportCommand::Title(title.clone()));
                self.told_title = title;
            }
        }
    }

    fn file_event(&mut self, ctx: &egui::Context, event: FileEvent) {
        match event {
            FileEvent::Opened(opened, path) => self.take_design(&opened, path),
            FileEvent::OpenFailed(error) => {
                let kept = match &self.session {
                    Some(session) => format!("{} is still open.", session.name()),
                    None => String::new(),
                };
                self.say(Grade::Error, error, kept);
            }
            FileEvent::Saved { path, state } => {
                if let Some(session) = &mut self.session {
                    session.document.mark_saved_as(state);
                    session.path = Some(path.clone());
                }
                self.settings.opened(&path);
                self.write_settings();
                self.say(Grade::Done, format!("Saved {}", path.display()), "");
                if let Some(next) = self.asking.after_save.take() {
                    self.go(ctx, next);
                }
            }
            FileEvent::Exported { path, lost } if lost.is_empty() => {
                self.say(
                    Grade::Done,
                    format!("Wrote {}", path.display()),
                    "Nothing was left out.",
                );
            }
            FileEvent::Exported { path, lost } => {
                let text = format!("Wrote {}, without {}", path.display(), lost.join("; "));
                self.warn(text, "The design itself is as it was.");
            }
            FileEvent::SaveFailed(error) => {
                self.asking.after_save = None;
                self.say(
                    Grade::Error,
                    error,
                    "The earlier file is as it was, and the design still open.",
                );
            }
        }
    }

    /// Leaves the open design for something else, after asking if work would be lost.
    pub(super) fn leave_for(&mut self, ctx: &egui::Context, next: Next) {
        let modified =
            (self.session.as_ref()).is_some_and(|session| session.document.is_modified());
        if modified {
            self.asking.about_unsaved(next);
        } else {
            self.go(ctx, next);
        }
    }

    fn go(&mut self, ctx: &egui::Context, next: Next) {
        match next {
            Next::Close => {
                self.may_close = true;
                ctx.send_viewport_cmd(ViewportCommand::Close);
            }
            Next::Start => {
                self.session = None;
                self.draft.forget();
                self.preview.forget();
            }
            Next::New => self.files.open_blank(ctx),
            Next::Preset(name) => self.files.open_preset(ctx, name),
            Next::File(path) => self.files.open(ctx, path),
            Next::Ask => self.files.ask(ctx),
            Next::AskPath => self.files.type_path("Type or paste it; Enter opens it."),
        }
    }

    /// Holds the window open while there is unsaved work.
    pub(super) fn ask_before_closing(&mut self, ctx: &egui::Context) {
        let closing = ctx.input(|input| input.viewport().close_requested());
        let modified =
            (self.session.as_ref()).is_some_and(|session| session.document.is_modified());
        if closing && modified && !self.may_close {
            ctx.send_viewport_cmd(ViewportCommand::CancelClose);
            self.asking.about_unsaved(Next::Close);
        }
    }

    /// Shows the open question and does what it is answered with.
    pub(super) fn asking_ui(&mut self, ctx: &egui::Context) {
        let name = self
            .session
            .as_ref()
            .map_or("", |session| session.name())
            .to_owned();
        match self.asking.show(ctx, &name) {
            Some(Answer::Save(next)) => {
                self.asking.after_save = Some(next);
                self.save(ctx, false);
            }
            Some(Answer::Discard(next)) => self.go(ctx, next),
            Some(Answer::Instead { edit, always }) => {
                self.asking.derive_always |= always;
                self.edit(edit);
            }
            Some(Answer::Edit(edit)) => self.edit(edit),
            None => {}
        }
        // A save that was given up leaves nothing waiting for it.
        if !self.files.is_asking() && !self.files.is_writing() {
            self.asking.after_save = None;
        }
    }

    fn save(&mut self, ctx: &egui::Context, under_new_name: bool) {
        let Some(session) = &self.session else {
            return;
        };
        match &session.path {
            Some(path) if !under_new_name => {
                let path = path.clone();
                self.files.save(ctx, path, writing(session));
            }
            _ => {
                let proposed = session.file_name("ron");
                self.files.ask_save(ctx, proposed);
            }
        }
    }

    /// Lights the cloth by a preset.
    pub(super) fn set_light(&mut self, preset: &str) {
        self.preview.light = LightChoice::Preset(preset.to_owned());
    }

    /// Does a command.
    pub(super) fn obey(&mut self, ctx: &egui::Context, command: Command) {
        if !self.situation().allows(command) {
            return;
        }
        match command {
            Command::New => self.leave_for(ctx, Next::New),
            Command::Open => self.leave_for(ctx, Next::Ask),
            Command::OpenPath => self.leave_for(ctx, Next::AskPath),
            Command::Start => self.leave_for(ctx, Next::Start),
            Command::Save => self.save(ctx, false),
            Command::SaveAs => self.save(ctx, true),
            Command::ExportStill => {
                if let (Some(session), Some(asked)) = (&self.session, self.preview.asked()) {
                    self.export.ask(session.design(), asked.clone());
                }
            }
            Command::ExportDraft => {
                if let Some(session) = &self.session {
                    let proposed = session.file_name("wif");
                    self.files.ask_export(ctx, proposed);
                }
            }
            // The close is asked about where every other close is.
            Command::Quit => ctx.send_viewport_cmd(ViewportCommand::Close),
            Command::Undo => self.step_back(),
            Command::Redo => self.rework(|session| session.document.redo()),
            Command::Theme => {
                let theme = match ctx.theme() {
                    egui::Theme::Dark => egui::Theme::Light,
                    egui::Theme::Light => egui::Theme::Dark,
                };
                ctx.set_theme(theme);
            }
            Command::Palette => self.palette.open(),
            Command::Shortcuts => self.show_shortcuts = true,
            Command::ResetLayout => self.layout.reset(),
            Command::NextPane => {
                if self.draft.in_use() {
                    self.preview.focus(ctx);
                } else {
                    self.draft.focus(ctx);
                }
            }
            Command::Fit | Command::ActualSize | Command::ZoomIn | Command::ZoomOut
                if !self.preview.in_use() =>
            {
                self.draft.obey(command);
            }
            Command::Use(tool) => self.draft.take_tool(ctx, tool),
            Command::SwapColours => {
                self.draft.yarns.swap(0, 1);
                self.draft.regions.swap(0, 1);
            }
            _ => {
                if !self.preview.obey(command) && !self.toggle(command) {
                    self.weave(ctx, command);
                }
            }
        }
    }

    fn step_back(&mut self) {
        self.draft.give_up();
        self.rework(|session| session.document.undo());
    }

    /// Commands that turn something on or off; false for any other.
    fn toggle(&mut self, command: Command) -> bool {
        let (show, symmetry) = (&mut self.draft.show, &mut self.draft.symmetry);
        let flag = match command {
            Command::Structure => &mut show.structure_alone,
            Command::GridLines => &mut show.grid_lines,
            Command::LongFloats => &mut show.long_floats,
            Command::Ghosts => &mut show.ghosts,
            Command::Navigator => &mut show.navigator,
            Command::SymmetryAcross => &mut symmetry[0],
            Command::SymmetryAlong => &mut symmetry[1],
            Command::Arrange(arrangement) => {
                show.arrangement = arrangement;
                self.draft.obey(Command::Fit);
                return true;
            }
            _ => return false,
        };
        *flag = !*flag;
        true
    }

    /// Commands that change the weave, and those of the clipboard.
    fn weave(&mut self, ctx: &egui::Context, command: Command) {
        let Some(session) = &self.session else {
            return;
        };
        let document = &session.document;
        let design = document.design();
        let (ends, picks) = (design.ends(), design.picks());
        let selection = self.draft.selection();
        let selected = selection.map(|rect| Cells::of_rect(ends, picks, rect));
        let edit = match command {
            Command::SelectAll => {
                let (end, pick) = (0, 0);
                self.draft.select(Some(Rect {
                    end,
                    pick,
                    ends,
                    picks,
                }));
                return;
            }
            Command::Deselect => {
                self.draft.select(None);
                return;
            }
            Command::Copy | Command::Cut => {
                let layer = self.draft.layer(document);
                let clip = selection.and_then(|rect| Clip::of(document, rect, layer));
                let Some(clip) = clip else { return };
                ctx.copy_text(clip.text());
                self.draft.copy(clip);
                match (command, selected) {
                    (Command::Cut, Some(cells)) => Edit::Paint {
                        cells,
                        warp_up: false,
                    },
                    _ => return,
                }
            }
            Command::Paste => {
                self.draft.take_tool(ctx, Tool::Stamp);
                return;
            }
            Command::Clear => match selected {
                Some(cells) => Edit::Paint {
                    cells,
                    warp_up: false,
                },
                None => return,
            },
            Command::Invert => match selected {
                Some(cells) => Edit::Flip(cells),
                None => Edit::Invert,
            },
            Command::MirrorAcross => Edit::Mirror(Direction::Warp),
            Command::MirrorAlong => Edit::Mirror(Direction::Weft),
            Command::TurnHalf => Edit::Rotate(2),
            Command::TurnQuarter => Edit::Rotate(1),
            Command::Roll(toward) => {
                let (ends, picks) = match toward {
                    Toward::Left => (-1, 0),
                    Toward::Right => (1, 0),
                    Toward::Up => (0, 1),
                    Toward::Down => (0, -1),
                };
                Edit::Roll { ends, picks }
            }
            Command::Resize => {
                self.asking.about_size(document);
                return;
            }
            Command::CropToSelection => match selection {
                Some(rect) => Edit::Crop(rect),
                None => return,
            },
            Command::Repeat2 => Edit::Tile {
                across: 2,
                along: 2,
            },
            Command::DeriveDraft => {
                if self.draft.show.arrangement == DraftLayout::Jacquard {
                    self.draft.show.arrangement = DraftLayout::Us;
                }
                Edit::DeriveDraft { after: None }
            }
            Command::BecomeJacquard => Edit::BecomeJacquard { then: None },
            _ => return,
        };
        self.edit(edit);
    }
}

/// What is to be written: the design as it is now.
fn writing(session: &Session) -> Writing {
    Writing {
        design: session.design(),
        state: session.document.state_id(),
    }
}
