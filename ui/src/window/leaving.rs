//! What is open: designs that come and go, what the threads finished, and the questions in
//! between.

use std::borrow::Cow;
use std::path::{Path, PathBuf};

use egui::ViewportCommand;
use pickglass::design::SourceImage;
use pickglass::edit::Clip;
use pickglass::text::{visible, with_causes};

use super::app::App;
use super::asking::{Answer, Next};
use super::draft::reference::Reference;
use super::export::Exported;
use super::files::{FileEvent, Writing};
use super::import::{self, Import};
use super::panes::Pane;
use super::session::{self, Session};
use super::settings::KeptReference;
use super::toasts::Grade;
use super::volume;
use crate::command_table::{DraftLayout, Tool};
use crate::opened::Opened;

impl App {
    /// Opens a design.
    pub(super) fn take_design(&mut self, opened: &Opened, session: Session) {
        if let Some(path) = &opened.path {
            self.settings.opened(path);
            self.write_settings();
        }
        self.show_session(Some(session));
        for warning in &opened.warnings {
            self.warn(warning.clone(), "The design was opened.");
        }
    }

    /// Shows another document, or the start page; the copy of what was open before is not
    /// needed any more.
    pub(super) fn show_session(&mut self, session: Option<Session>) {
        self.autosave.leave();
        self.remember_reference();
        if self.session.is_some() {
            self.toasts.leave_design();
        }
        self.session = session;
        self.draft.forget();
        self.lay_out();
        let path = self.session.as_ref().and_then(|s| s.path.as_deref());
        if let Some(kept) = self.settings.reference_of(path)
            && kept.image.exists()
        {
            let image = kept.image.clone();
            self.files.open_reference(&self.ctx, image);
        }
        self.preview.forget();
        self.panes.forget();
        self.asking.derive_always = false;
    }

    /// Lays the draft out as the person chose; figured cloth, which no shaft loom weaves, as
    /// its picture lies.
    pub(super) fn lay_out(&mut self) {
        let Some(session) = &self.session else {
            return;
        };
        self.pictured = session.is_pictured();
        self.draft.show.arrangement = match session.is_figured() {
            true => DraftLayout::Jacquard,
            false => self.settings.arrangement,
        };
    }

    /// Takes what the threads finished, and files that were dropped.
    pub(super) fn pick_up(&mut self, ctx: &egui::Context) {
        for problem in self.autosave.poll() {
            self.warn(problem, "The open design is not touched by this.");
        }
        let session = self.session.as_ref();
        let turned = self.draft.turned();
        (self.files).write_chosen(ctx, || session.map(|session| writing(session, turned)));
        while let Some(event) = self.files.poll(ctx) {
            self.file_event(ctx, event);
        }
        match self.export.poll() {
            Some(Exported::Written(path, report)) => {
                let text = format!("Wrote {}", path.display());
                let kept = format!("{} × {}, {} spp", report.width, report.height, report.spp);
                self.say(Grade::Done, text, kept);
                for warning in report.warnings {
                    self.warn(warning, "The picture was written.");
                }
                self.toasts.made(&path);
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
        match self.volume.poll() {
            Some(volume::Exported::Written { path, about }) => {
                self.say(Grade::Done, format!("Wrote {}", path.display()), about);
                self.toasts.made(&path);
            }
            Some(volume::Exported::Cancelled) => {
                self.say(
                    Grade::Done,
                    "The export was cancelled.",
                    "No file was written.",
                );
            }
            Some(volume::Exported::Failed(error)) => {
                self.say(Grade::Error, error, "No file was written.");
            }
            None => {}
        }
        let dropped = ctx.input_mut(|input| std::mem::take(&mut input.raw.dropped_files));
        if let Some(file) = dropped.first() {
            self.leave_for(ctx, Next::File(file.path().to_path_buf()));
        }
        let title = (self.session.as_ref()).map_or("Pickglass".to_owned(), Session::title);
        if self.told_title != title {
            ctx.send_viewport_cmd(ViewportCommand::Title(title.clone()));
            self.told_title = title;
        }
    }

    /// Shows what is asked of an image, and goes on with the answer.
    pub(super) fn import_ui(&mut self, ctx: &egui::Context) {
        let answer = self.import.as_mut().and_then(|import| import.show(ctx));
        match answer {
            None => return,
            Some(import::Answer::Open(mut opened)) => {
                // The form told them beside the cloth that comes of them.
                for warning in opened.warnings.drain(..) {
                    self.panes.log.add(Grade::Note, &warning, "");
                }
                self.files.open_read(ctx, *opened);
            }
            Some(import::Answer::Posterise(path)) => self.posterise(ctx, &path),
            Some(import::Answer::Closed) => {}
        }
        self.import = None;
    }

    /// Takes a photograph to be posterised, beside what is open or a new design.
    fn posterise(&mut self, ctx: &egui::Context, path: &Path) {
        if self.session.is_none() {
            match session::blank() {
                Ok(blank) => self.take_design(&blank, Session::of(&blank)),
                Err(error) => return self.say(Grade::Error, with_causes(error.as_ref()), ""),
            }
        }
        self.panes.read_picture(ctx, path);
        self.layout.bring(Pane::Posterise);
    }

    /// Shows a picture to draw by, as it lay when it was seen last.
    fn take_reference(&mut self, ctx: &egui::Context, path: PathBuf, source: &SourceImage) {
        let Some(session) = &self.session else {
            return;
        };
        let before = self.draft.reference.take();
        let mut reference = Reference::new(ctx, path, source);
        let kept = self.settings.reference_of(session.path.as_deref());
        if let Some(kept) = kept.filter(|kept| kept.image == reference.path) {
            reference.lie(kept.opacity, kept.stretched);
            reference.window_open = false;
        } else if let Some(before) = before {
            reference.lie(before.opacity, before.stretched);
        }
        self.draft.reference = Some(reference);
    }

    /// Remembers by which picture the open design is drawn.
    pub(super) fn remember_reference(&mut self) {
        let path = self.session.as_ref().and_then(|s| s.path.as_deref());
        if let Some(design) = path {
            let reference = self.draft.reference.as_ref();
            self.settings.draws_by(
                design,
                reference.map(|reference| KeptReference {
                    design: design.to_owned(),
                    image: reference.path.clone(),
                    opacity: reference.opacity,
                    stretched: reference.stretched,
                }),
            );
        }
    }

    pub(super) fn file_event(&mut self, ctx: &egui::Context, event: FileEvent) {
        match event {
            FileEvent::Opened(opened, session) => self.take_design(&opened, *session),
            FileEvent::Recovered {
                session,
                lost,
                copy,
            } => {
                self.show_session(Some(*session));
                self.autosave.reopened(copy);
                match lost {
                    Some(lost) => self.warn(lost, "Everything before that was recovered."),
                    None => self.say(Grade::Done, "Recovered.", "Save it to keep it."),
                }
            }
            FileEvent::Image(path) => self.import = Some(Import::new(path)),
            FileEvent::Loom(path) => self.import = Some(Import::of_loom(path)),
            FileEvent::Reference { path, picture } => {
                for warning in picture.warnings {
                    self.warn(warning, "The picture was opened.");
                }
                self.take_reference(ctx, path, &picture.source);
            }
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
                self.toasts.made(&path);
            }
            FileEvent::Exported { path, lost } => {
                let text = format!("Wrote {}, without {}", path.display(), lost.join("; "));
                self.warn(text, "The design itself is as it was.");
                self.toasts.made(&path);
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

    pub(super) fn go(&mut self, ctx: &egui::Context, next: Next) {
        match next {
            Next::Close => {
                self.may_close = true;
                ctx.send_viewport_cmd(ViewportCommand::Close);
            }
            Next::Start => self.show_session(None),
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
            .map_or(Cow::Borrowed(""), |session| visible(session.name()))
            .into_owned();
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
            Some(Answer::Stamp(weave)) => {
                self.draft.copy(Clip::of_weave(&weave));
                self.draft.take_tool(ctx, Tool::Stamp);
            }
            Some(Answer::Filled(name, edits)) => {
                self.begin(name);
                edits.into_iter().for_each(|edit| self.edit(edit));
                self.finish();
            }
            None => {}
        }
        // A save that was given up leaves nothing waiting for it.
        if !self.files.is_asking() && !self.files.is_writing() {
            self.asking.after_save = None;
        }
    }

    pub(super) fn save(&mut self, ctx: &egui::Context, under_new_name: bool) {
        let Some(session) = &self.session else {
            return;
        };
        match &session.path {
            Some(path) if !under_new_name => {
                let path = path.clone();
                let what = writing(session, self.draft.turned());
                self.files.save(ctx, path, what);
            }
            _ => {
                let proposed = session.file_name("ron");
                self.files.ask_save(ctx, proposed);
            }
        }
    }
}

/// What is to be written: the design as it is now, and whether it is shown turned.
fn writing(session: &Session, turned: bool) -> Writing {
    Writing {
        design: session.design(),
        turned,
        state: session.document.state_id(),
        source: session.source.clone(),
    }
}
