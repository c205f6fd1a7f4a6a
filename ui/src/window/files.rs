//! Opening files: the system's dialog on its own thread, a typed path where there is
//! none, and reading on a thread as well.

use std::path::PathBuf;

use egui::{Id, Key, Modal, RichText};

use super::task::{Outcome, Task};
use crate::opened::Opened;
use crate::tokens::{self, Palette};

/// A dialog that ends sooner than this without a choice never opened, s.
const NEVER_OPENED: f64 = 1.5;

/// Endings that the dialog shows; files are known by their content.
const OPENED: [&str; 15] = [
    "ron", "wif", "dtx", "wpo", "dbw", "jc5", "png", "bmp", "tif", "tiff", "gif", "pcx", "jpg",
    "jpeg", "webp",
];

/// What opening came to.
pub enum Opening {
    Opened(Box<Opened>),
    Failed(String),
}

type Reading = Task<anyhow::Result<Opened>>;

/// The opening of files.
#[derive(Default)]
pub struct Files {
    dialog: Option<Task<Option<PathBuf>>>,
    reading: Option<(String, Reading)>,
    typed: Option<TypedPath>,
}

struct TypedPath {
    text: String,
    reason: &'static str,
    focused: bool,
}

impl Files {
    /// Shows the system's dialog.
    pub fn ask(&mut self, ctx: &egui::Context) {
        if self.dialog.is_some() {
            return;
        }
        let task = Task::start(ctx, "dialog", || {
            rfd::FileDialog::new()
                .set_title("Open a design, a draft or an image")
                .add_filter("Designs, drafts and images", &OPENED)
                .add_filter("All files", &["*"])
                .pick_file()
        });
        match task {
            Ok(task) => self.dialog = Some(task),
            Err(_) => self.type_path("The system's dialog could not be opened."),
        }
    }

    /// Shows the field for a path.
    pub fn type_path(&mut self, reason: &'static str) {
        self.typed = Some(TypedPath {
            text: String::new(),
            reason,
            focused: false,
        });
    }

    /// Opens a preset by name.
    pub fn open_preset(&mut self, ctx: &egui::Context, name: &str) {
        let preset = name.to_owned();
        self.read(ctx, name, move || Opened::preset(&preset));
    }

    /// Opens a file.
    pub fn open(&mut self, ctx: &egui::Context, path: PathBuf) {
        let name = path.file_name().unwrap_or(path.as_os_str()).to_owned();
        self.read(ctx, &name.to_string_lossy(), move || Opened::file(path));
    }

    /// The file that is being read, if any.
    pub fn reading(&self) -> Option<&str> {
        self.reading.as_ref().map(|(name, _)| name.as_str())
    }

    fn read(
        &mut self,
        ctx: &egui::Context,
        name: &str,
        work: impl FnOnce() -> anyhow::Result<Opened> + Send + 'static,
    ) {
        // A newer choice replaces one that is still being read.
        if let Ok(task) = Task::start(ctx, "reading", work) {
            self.reading = Some((name.to_owned(), task));
        }
    }

    /// Picks up what the threads finished.
    pub fn poll(&mut self, ctx: &egui::Context) -> Option<Opening> {
        if let Some(dialog) = &self.dialog {
            match dialog.poll() {
                Outcome::Working => {}
                Outcome::Ready(Some(path)) => {
                    self.dialog = None;
                    self.open(ctx, path);
                }
                Outcome::Ready(None) | Outcome::Lost => {
                    let never_opened = dialog.seconds() < NEVER_OPENED;
                    self.dialog = None;
                    if never_opened {
                        self.type_path("This system offers no file dialog.");
                    }
                }
            }
        }
        let (name, task) = self.reading.as_ref()?;
        let opening = match task.poll() {
            Outcome::Working => return None,
            Outcome::Ready(Ok(opened)) => Opening::Opened(Box::new(opened)),
            Outcome::Ready(Err(error)) => Opening::Failed(format!("{error:#}")),
            Outcome::Lost => Opening::Failed(format!(
                "{name}: reading it failed unexpectedly: check the file"
            )),
        };
        self.reading = None;
        Some(opening)
    }

    /// Shows the field for a path, when it is asked for.
    pub fn show(&mut self, ctx: &egui::Context) {
        let Some(typed) = &mut self.typed else {
            return;
        };
        let (mut open, mut close) = (false, false);
        let modal = Modal::new(Id::unique("typed path")).show(ctx, |ui| {
            ui.set_width(tokens::TOAST_WIDTH);
            let quiet = Palette::current(ui).quiet;
            ui.label(RichText::new("Open by path").text_style(egui::TextStyle::Heading));
            ui.label(RichText::new(typed.reason).color(quiet));
            let label = ui.label("Path of a .ron, .wif or image file");
            let field = ui
                .add(egui::TextEdit::singleline(&mut typed.text).desired_width(f32::INFINITY))
                .labelled_by(label.id);
            if !typed.focused {
                field.request_focus();
                typed.focused = true;
            }
            open |= field.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
            ui.add_space(tokens::GAP);
            ui.horizontal(|ui| {
                let ready = !typed.text.trim().is_empty();
                open |= ui.add_enabled(ready, egui::Button::new("Open")).clicked();
                close |= ui.button("Cancel").clicked();
            });
        });
        close |= modal.should_close();
        let path = typed.text.trim().trim_matches('"').to_owned();
        if open && !path.is_empty() {
            self.typed = None;
            self.open(ctx, PathBuf::from(path));
        } else if close {
            self.typed = None;
        }
    }
}
