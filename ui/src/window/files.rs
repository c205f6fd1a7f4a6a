//! Opening and saving: the system's dialog on its own thread, a typed path where there is
//! none, and reading and writing on a thread as well.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use egui::RichText;
use pickglass::atomic;
use pickglass::design::Design;
use pickglass::edit::recovery::{self, Found};
use pickglass::formats::image::Encoding;
use pickglass::formats::photo::{self, Photo};
use pickglass::formats::{self, Format, Kind, SaveOptions, jc5, output};
use pickglass::print::{self, PdfOptions};
use pickglass::text::with_causes;

use super::image_form::{self, ImageForm};
use super::session::{self, Session};
use super::task::{Outcome, Task};
use super::{dialog, typing};
use crate::opened::{Opened, head};
use crate::tokens::{self, Palette};

/// A dialog that ends sooner than this without a choice never opened, s.
const NEVER_OPENED: f64 = 1.5;

/// Endings of pictures that a design is drawn by: those of photographs and of scans.
const PICTURES: [&str; 7] = ["png", "jpg", "jpeg", "webp", "bmp", "tif", "tiff"];
/// Whether drafts are exported in a format here: cards want a loom, which nobody is asked for.
fn is_exported(format: &Format) -> bool {
    format.is_written() && format.kind != Kind::Loom
}

/// What came of a file.
pub enum FileEvent {
    /// A design was read, from a file or of the program's own, and woven.
    Opened(Box<Opened>, Box<Session>),
    /// Unsaved work of an earlier run, the copy it is from, and its file if it has one.
    Recovered {
        session: Box<Session>,
        lost: Option<String>,
        copy: PathBuf,
    },
    /// An image, of which more is to be asked than it says.
    Image(PathBuf),
    /// A loom file, likewise.
    Loom(PathBuf),
    /// A picture to draw by.
    Reference { path: PathBuf, picture: Box<Photo> },
    /// This state of the document is in its file.
    Saved { path: PathBuf, state: u64 },
    /// A copy was written; what of the design is not in it, one line each.
    Exported { path: PathBuf, lost: Vec<String> },
    /// One line for the person.
    OpenFailed(String),
    /// One line for the person; the earlier file is as it was.
    SaveFailed(String),
}

/// What a path is asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Purpose {
    Open,
    Save,
    Export,
    Print,
    Reference,
}

impl Purpose {
    /// Whether the file is read, not written.
    fn reads(self) -> bool {
        matches!(self, Self::Open | Self::Reference)
    }

    fn title(self) -> &'static str {
        match self {
            Self::Open => "Open by path",
            Self::Save => "Save as",
            Self::Export => "Export the draft",
            Self::Print => "Print to PDF",
            Self::Reference => "Reference image",
        }
    }

    fn field(self) -> String {
        let image = |format: &Format| matches!(format.kind, Kind::Image | Kind::Picture);
        match self {
            Self::Open => {
                let others = formats::endings_in_words(|format| !image(format), ", ");
                format!("Path of a {others} or image file")
            }
            Self::Save => "Path of a .ron file".to_owned(),
            Self::Export => {
                let written = formats::endings_in_words(is_exported, " or ");
                format!("Path that ends in {written}")
            }
            Self::Print => "Path of a .pdf file".to_owned(),
            Self::Reference => "Path of a photograph or a drawing".to_owned(),
        }
    }

    /// The ending of a file that is written without one.
    fn ending(self) -> &'static str {
        match self {
            Self::Export => "wif",
            Self::Print => "pdf",
            _ => "ron",
        }
    }

    fn button(self) -> &'static str {
        match self {
            Self::Open => "Open",
            Self::Save => "Save",
            Self::Export => "Export",
            Self::Print => "Print",
            Self::Reference => "Show it",
        }
    }

    /// The system's dialog; `None` = nothing was chosen, or none could open.
    fn dialog(self, proposed: &str) -> Option<PathBuf> {
        let dialog = rfd::FileDialog::new();
        match self {
            Self::Open => dialog
                .set_title("Open a design, a draft or an image")
                // Files are known by their content.
                .add_filter("Designs, drafts and images", &formats::endings(|_| true))
                .add_filter("All files", &["*"])
                .pick_file(),
            Self::Save => dialog
                .set_title("Save the design")
                .add_filter("Design", &["ron"])
                .set_file_name(proposed)
                .save_file(),
            Self::Export => dialog
                .set_title("Export the draft")
                .add_filter("Drafts and loom images", &formats::endings(is_exported))
                .set_file_name(proposed)
                .save_file(),
            Self::Print => dialog
                .set_title("Print to PDF")
                .add_filter("PDF", &["pdf"])
                .set_file_name(proposed)
                .save_file(),
            Self::Reference => dialog
                .set_title("A picture to draw by")
                .add_filter("Pictures", &PICTURES)
                .add_filter("All files", &["*"])
                .pick_file(),
        }
    }
}

struct Dialog {
    purpose: Purpose,
    proposed: String,
    /// The choice, and how long it was made for, s.
    task: Task<(Option<PathBuf>, f64)>,
}

struct TypedPath {
    purpose: Purpose,
    text: String,
    reason: &'static str,
    focused: bool,
    /// The file exists and the person was asked once whether to write over it.
    over: Option<PathBuf>,
    /// The path was entered: the field is closed once its file is read or written.
    at_work: bool,
    /// What came of the path that was entered.
    problem: Option<String>,
}

impl TypedPath {
    /// Takes what came of the path; true where that was told beside the field, which is
    /// then open still.
    fn failed(&mut self, event: &FileEvent) -> bool {
        self.problem = Some(match event {
            FileEvent::OpenFailed(problem) => problem.clone(),
            FileEvent::SaveFailed(problem) => format!("{problem}. The earlier file is as it was."),
            _ => return false,
        });
        (self.at_work, self.focused) = (false, false);
        true
    }
}

/// What is to be written: the design as it was when it was asked for.
pub struct Writing {
    pub design: Arc<Design>,
    /// Draft and cloth are shown turned by 180°; so are they printed.
    pub turned: bool,
    /// The id of the state, see `Document::state_id`.
    pub state: u64,
    /// A file that the design is from, of which it may not hold everything.
    pub source: Option<PathBuf>,
}

/// The opening and saving of files.
#[derive(Default)]
pub struct Files {
    dialog: Option<Dialog>,
    typed: Option<TypedPath>,
    reading: Option<(String, Task<FileEvent>)>,
    writing: Option<(String, Task<FileEvent>)>,
    /// Paths are typed: no dialog of the system is tried.
    pub typed_only: bool,
    /// A path that was chosen for writing; the app hands over the design then.
    chosen: Option<(Purpose, PathBuf, SaveOptions)>,
    /// An image to be written, of which more is asked.
    image: Option<ImageForm>,
}

impl Files {
    /// Asks for a file to open.
    pub fn ask(&mut self, ctx: &egui::Context) {
        self.ask_for(ctx, Purpose::Open, String::new());
    }

    /// Asks where to save; `proposed` is a file's name, perhaps with its folder.
    pub fn ask_save(&mut self, ctx: &egui::Context, proposed: String) {
        self.ask_for(ctx, Purpose::Save, proposed);
    }

    /// Asks where to export the draft to.
    pub fn ask_export(&mut self, ctx: &egui::Context, proposed: String) {
        self.ask_for(ctx, Purpose::Export, proposed);
    }

    /// Asks where to print to.
    pub fn ask_print(&mut self, ctx: &egui::Context, proposed: String) {
        self.ask_for(ctx, Purpose::Print, proposed);
    }

    /// Asks for a picture to draw by.
    pub fn ask_reference(&mut self, ctx: &egui::Context) {
        self.ask_for(ctx, Purpose::Reference, String::new());
    }

    fn ask_for(&mut self, ctx: &egui::Context, purpose: Purpose, proposed: String) {
        if self.dialog.is_some() {
            return;
        }
        if self.typed_only {
            self.type_for(purpose, proposed, "Type or paste it.");
            return;
        }
        let offered = proposed.clone();
        let task = Task::start(ctx, "dialog", move || {
            // Measured here: the window may be slow to pick the answer up.
            let begun = Instant::now();
            let choice = purpose.dialog(&offered);
            (choice, begun.elapsed().as_secs_f64())
        });
        match task {
            Ok(task) => {
                self.dialog = Some(Dialog {
                    purpose,
                    proposed,
                    task,
                });
            }
            Err(_) => self.type_for(
                purpose,
                proposed,
                "The system's dialog could not be opened.",
            ),
        }
    }

    /// Shows the field for a path to open.
    pub fn type_path(&mut self, reason: &'static str) {
        self.type_for(Purpose::Open, String::new(), reason);
    }

    fn type_for(&mut self, purpose: Purpose, text: String, reason: &'static str) {
        self.typed = Some(TypedPath {
            purpose,
            text,
            reason,
            focused: false,
            over: None,
            at_work: false,
            problem: None,
        });
    }

    /// Opens a preset by name.
    pub fn open_preset(&mut self, ctx: &egui::Context, name: &str) {
        let preset = name.to_owned();
        self.read(ctx, name, move || Opened::preset(&preset));
    }

    /// Opens a new design.
    pub fn open_blank(&mut self, ctx: &egui::Context) {
        self.read(ctx, "a new design", session::blank);
    }

    /// Opens a file.
    pub fn open(&mut self, ctx: &egui::Context, path: PathBuf) {
        let name = path.file_name().unwrap_or(path.as_os_str()).to_owned();
        let work = move || match head(&path) {
            head if Encoding::of(&head).is_some() => FileEvent::Image(path),
            head if jc5::recognises(&head) => FileEvent::Loom(path),
            _ => opened(Opened::file(path)),
        };
        self.begin_reading(ctx, &name.to_string_lossy(), work);
    }

    /// Opens a design that was read already.
    pub fn open_read(&mut self, ctx: &egui::Context, read: Opened) {
        let name = read.name().to_owned();
        self.begin_reading(ctx, &name, move || opened(Ok(read)));
    }

    /// Reads a picture to draw by.
    pub fn open_reference(&mut self, ctx: &egui::Context, path: PathBuf) {
        let name = path.file_name().unwrap_or(path.as_os_str()).to_owned();
        let work = move || match photo::load(&path) {
            Ok(photo) => FileEvent::Reference {
                path,
                picture: Box::new(photo),
            },
            Err(error) => FileEvent::OpenFailed(error.to_string()),
        };
        self.begin_reading(ctx, &name.to_string_lossy(), work);
    }

    /// Opens unsaved work of an earlier run.
    pub fn recover(&mut self, ctx: &egui::Context, found: &Found) {
        let Found {
            path,
            name,
            original,
            ..
        } = found.clone();
        let work = move || match recovery::load(&path) {
            Ok(recovered) => FileEvent::Recovered {
                session: Box::new(Session::unsaved(recovered.design, original)),
                lost: recovered.lost,
                copy: path,
            },
            Err(error) => FileEvent::OpenFailed(error.to_string()),
        };
        self.begin_reading(ctx, &name, work);
    }

    /// The file that is being read or written, if any, in words.
    pub fn at_work(&self) -> Option<String> {
        let reading = self
            .reading
            .as_ref()
            .map(|(name, _)| format!("Reading {name}"));
        reading.or_else(|| {
            self.writing
                .as_ref()
                .map(|(name, _)| format!("Writing {name}"))
        })
    }

    fn read(
        &mut self,
        ctx: &egui::Context,
        name: &str,
        work: impl FnOnce() -> anyhow::Result<Opened> + Send + 'static,
    ) {
        self.begin_reading(ctx, name, move || opened(work()));
    }

    fn begin_reading(
        &mut self,
        ctx: &egui::Context,
        name: &str,
        work: impl FnOnce() -> FileEvent + Send + 'static,
    ) {
        // A newer choice replaces one that is still being read.
        if let Ok(task) = Task::start(ctx, "reading", work) {
            self.reading = Some((name.to_owned(), task));
        }
    }

    /// Writes the design into its file.
    pub fn save(&mut self, ctx: &egui::Context, path: PathBuf, what: Writing) {
        let options = SaveOptions::default();
        self.write(ctx, (Purpose::Save, path, options), what);
    }

    fn write(
        &mut self,
        ctx: &egui::Context,
        (purpose, path, options): (Purpose, PathBuf, SaveOptions),
        what: Writing,
    ) {
        let name = path.file_name().unwrap_or(path.as_os_str()).to_owned();
        let work = move || {
            let Writing {
                design,
                turned,
                state,
                source,
            } = what;
            let may = output::check(&path, source.as_deref()).map_err(|error| error.to_string());
            let done = may.and_then(|()| match purpose {
                Purpose::Print => print(&design, turned, &path).map(|()| Vec::new()),
                _ => formats::save(&design, &path, &options).map_err(|error| error.to_string()),
            });
            match done {
                Ok(_) if purpose == Purpose::Save => FileEvent::Saved { path, state },
                Ok(lost) => FileEvent::Exported { path, lost },
                Err(error) => FileEvent::SaveFailed(error),
            }
        };
        if let Ok(task) = Task::start(ctx, "writing", work) {
            self.writing = Some((name.to_string_lossy().into_owned(), task));
        }
    }

    /// Whether something is being written.
    pub fn is_writing(&self) -> bool {
        self.writing.is_some() || self.chosen.is_some()
    }

    /// Whether the person is being asked for a path.
    pub fn is_asking(&self) -> bool {
        self.dialog.is_some() || self.typed.is_some() || self.image.is_some()
    }

    /// Writes where a path was chosen for it.
    pub fn write_chosen(&mut self, ctx: &egui::Context, what: impl FnOnce() -> Option<Writing>) {
        if let Some(chosen) = self.chosen.take()
            && let Some(what) = what()
        {
            self.write(ctx, chosen, what);
        }
    }

    /// Picks up what the threads finished.
    pub fn poll(&mut self, ctx: &egui::Context) -> Option<FileEvent> {
        if let Some(dialog) = &self.dialog {
            let choice = match dialog.task.poll() {
                Outcome::Working => None,
                Outcome::Ready(choice) => Some(choice),
                Outcome::Lost => Some((None, 0.0)),
            };
            if let Some((choice, seconds)) = choice
                && let Some(dialog) = self.dialog.take()
            {
                match choice {
                    Some(path) => self.choose(ctx, dialog.purpose, path),
                    // No portal and no helper program: the dialog never was there.
                    None if seconds < NEVER_OPENED => self.type_for(
                        dialog.purpose,
                        dialog.proposed,
                        "This system offers no file dialog.",
                    ),
                    None => {}
                }
            }
        }
        for (slot, failed) in [
            (&mut self.reading, FileEvent::OpenFailed as fn(String) -> _),
            (&mut self.writing, FileEvent::SaveFailed as fn(String) -> _),
        ] {
            let Some((name, task)) = slot else { continue };
            let event = match task.poll() {
                Outcome::Working => continue,
                Outcome::Ready(event) => event,
                Outcome::Lost => failed(format!(
                    "{name}: this failed unexpectedly: check the file and the folder"
                )),
            };
            *slot = None;
            if let Some(typed) = self.typed.as_mut().filter(|typed| typed.at_work) {
                if typed.failed(&event) {
                    continue;
                }
                self.typed = None;
            }
            return Some(event);
        }
        None
    }

    fn choose(&mut self, ctx: &egui::Context, purpose: Purpose, path: PathBuf) {
        match purpose {
            Purpose::Open => self.open(ctx, path),
            Purpose::Save | Purpose::Export | Purpose::Print => {
                let path = with_ending(path, purpose.ending());
                match ImageForm::of(&path).filter(|_| purpose == Purpose::Export) {
                    Some(form) => (self.image, self.typed) = (Some(form), None),
                    None => self.chosen = Some((purpose, path, SaveOptions::default())),
                }
            }
            Purpose::Reference => self.open_reference(ctx, path),
        }
        ctx.request_repaint();
    }

    /// Shows what is asked about an image that is to be written.
    fn show_image(&mut self, ctx: &egui::Context) {
        let Some(answer) = self.image.as_mut().and_then(|form| form.show(ctx)) else {
            return;
        };
        self.image = None;
        if let image_form::Answer::Write(path, options) = answer {
            self.chosen = Some((Purpose::Export, path, options));
            ctx.request_repaint();
        }
    }

    /// Shows the field for a path, when it is asked for, or what else is asked of a file.
    pub fn show(&mut self, ctx: &egui::Context) {
        self.show_image(ctx);
        let Some(typed) = &mut self.typed else {
            return;
        };
        let shown = dialog::show(ctx, "typed path", |ui| typed_ui(ui, typed));
        let reads = typed.purpose.reads();
        if shown.escaped || shown.inner == Wish::Close {
            // What is being read was for this field alone.
            if typed.at_work && reads {
                self.reading = None;
            }
            self.typed = None;
            return;
        }
        let path = PathBuf::from(typed.text.trim().trim_matches('"'));
        let ready = !path.as_os_str().is_empty() && (reads || !typed.at_work);
        if shown.inner == Wish::Go && ready {
            let purpose = typed.purpose;
            typed.problem = None;
            // Ask once before an existing file is written over.
            if !reads && path.exists() && typed.over.as_deref() != Some(&*path) {
                typed.over = Some(path);
                return;
            }
            typed.at_work = true;
            self.choose(ctx, purpose, path);
        }
    }
}

/// What is wished in the form of a path.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Wish {
    Nothing,
    Go,
    Close,
}

fn typed_ui(ui: &mut egui::Ui, typed: &mut TypedPath) -> Wish {
    ui.set_width(tokens::TOAST_WIDTH);
    let palette = Palette::current(ui);
    let mut wish = Wish::Nothing;
    ui.label(RichText::new(typed.purpose.title()).text_style(egui::TextStyle::Heading));
    ui.label(RichText::new(typed.reason).color(palette.quiet));
    let label = ui.label(typed.purpose.field());
    let field = ui
        .add(egui::TextEdit::singleline(&mut typed.text).desired_width(f32::INFINITY))
        .labelled_by(label.id);
    if !typed.focused {
        field.request_focus();
        typed.focused = true;
    }
    if field.changed() {
        typed.problem = None;
    }
    if typing::entered(ui, &field) {
        // It is left once the file is there: a correction is typed here as well.
        field.request_focus();
        wish = Wish::Go;
    }
    let over = (typed.over.as_deref()).is_some_and(|over| over == Path::new(typed.text.trim()));
    if over && typed.problem.is_none() {
        ui.vertical(|ui| {
            ui.set_min_height(2.0 * ui.text_style_height(&egui::TextStyle::Body));
            let text = "Warning: this file exists and will be written over.";
            ui.label(RichText::new(text).color(palette.warning));
        });
    } else {
        dialog::problem(ui, typed.problem.as_deref());
    }
    ui.horizontal(|ui| {
        let ready = !typed.text.trim().is_empty();
        let name = if over {
            "Write over it"
        } else {
            typed.purpose.button()
        };
        if ui.add_enabled(ready, egui::Button::new(name)).clicked() {
            wish = Wish::Go;
        }
        if ui.button("Cancel").clicked() {
            wish = Wish::Close;
        }
        if typed.at_work {
            ui.spinner();
        }
    });
    wish
}

/// What was opened, woven, or why not.
fn opened(read: anyhow::Result<Opened>) -> FileEvent {
    match read {
        Ok(opened) => {
            let session = Box::new(Session::of(&opened));
            FileEvent::Opened(Box::new(opened), session)
        }
        Err(error) => FileEvent::OpenFailed(with_causes(error.as_ref())),
    }
}

/// Writes a design as pages.
fn print(design: &Design, turned: bool, path: &Path) -> Result<(), String> {
    let options = PdfOptions {
        turned,
        ..PdfOptions::default()
    };
    let pages = print::write(design, &design.weave(), &options);
    let bytes = pages.map_err(|error| error.to_string())?;
    atomic::write(path, &bytes).map_err(|error| error.to_string())
}

/// The path with this ending where it has none.
fn with_ending(path: PathBuf, ending: &str) -> PathBuf {
    match path.extension() {
        Some(_) => path,
        None => path.with_extension(ending),
    }
}
