//! Opening an image: what cannot be known from the file is asked beside a preview of what
//! comes of it, with the habits of makers to begin with.

use std::path::PathBuf;

use egui::{
    Button, ComboBox, DragValue, Key as Pressed, Modifiers, RichText, ScrollArea, TextureHandle,
    TextureOptions, vec2,
};
use pickglass::formats::image::{
    Black, Convention, Corner, ImageAs, ImageError, ImageReading, Key,
};
use pickglass::formats::{FormatError, LoadOptions};
use pickglass::limits::SETT_PER_CM;
use pickglass::text::{visible, with_causes};

use super::panes::later::Later;
use super::thumbs;
use super::toasts::Grade;
use super::{dialog, icons, typing};
use crate::opened::Opened;
use crate::tokens::{self, Palette};

/// Side of the preview, points.
const PREVIEW: f32 = 50.0 * tokens::GRID;
/// Width of the questions, points.
const QUESTIONS: f32 = 68.0 * tokens::GRID;

/// What an image may be.
const KINDS: [(Option<ImageAs>, &str); 6] = [
    (None, "As its colours suggest"),
    (Some(ImageAs::Weave), "A weave: one pixel a crossing"),
    (Some(ImageAs::Artwork), "Artwork: one colour a region"),
    (Some(ImageAs::Warp), "The warp yarns, by colour"),
    (Some(ImageAs::Weft), "The weft yarns, by colour"),
    (Some(ImageAs::Picture), "A photograph, to be posterised"),
];

/// The corner where end 1 and pick 1 meet, in words.
pub const CORNERS: [(Corner, &str); 4] = [
    (Corner::BottomLeft, "lower left"),
    (Corner::BottomRight, "lower right"),
    (Corner::TopLeft, "upper left"),
    (Corner::TopRight, "upper right"),
];

/// What came of the form.
pub enum Answer {
    /// The design as it was shown.
    Open(Box<Opened>),
    /// The picture is to be posterised.
    Posterise(PathBuf),
    Closed,
}

/// What is answered so far.
#[derive(Debug, Clone, PartialEq)]
struct Answers {
    reading: ImageReading,
    /// A loom file is of cloth that was woven face down.
    face_down: bool,
    /// Ends and picks per cm, where the person knows better than the file.
    sett: Option<(f32, f32)>,
}

/// What would be opened, or why nothing would.
type Read = Result<(Opened, egui::ColorImage), Unread>;

/// Why an image is not opened as it is.
enum Unread {
    /// It is a picture of so many colours.
    Picture(String),
    Wrong(String),
}

impl Unread {
    fn of(error: &anyhow::Error) -> Self {
        match error.downcast_ref() {
            Some(FormatError::Image(ImageError {
                picture: Some(colours),
                ..
            })) => Self::Picture(colours.clone()),
            _ => Self::Wrong(with_causes(error.as_ref())),
        }
    }
}

/// The form of one image or loom file.
pub struct Import {
    path: PathBuf,
    /// It is a loom file: hooks and picks are certain, which side is the face is not.
    loom: bool,
    answers: Answers,
    maker: Option<Convention>,
    read: Later<Answers, Read>,
    /// How many colours it has, where it was found to be a picture.
    colours: Option<String>,
    /// The preview, and what it answers.
    shown: Option<(Answers, TextureHandle)>,
}

impl Import {
    /// The form of the loom file at a path.
    pub fn of_loom(path: PathBuf) -> Self {
        Self {
            loom: true,
            ..Self::new(path)
        }
    }

    /// The form of the image at a path.
    pub fn new(path: PathBuf) -> Self {
        Self {
            path,
            loom: false,
            answers: Answers {
                reading: ImageReading::default(),
                face_down: false,
                sett: None,
            },
            maker: None,
            read: Later::default(),
            colours: None,
            shown: None,
        }
    }

    /// Shows the form; the answer once there is one.
    pub fn show(&mut self, ctx: &egui::Context) -> Option<Answer> {
        self.read_again(ctx);
        let mut answer = None;
        let shown = dialog::show(ctx, "import", |ui| {
            let name = self.path.file_name().unwrap_or(self.path.as_os_str());
            let kind = if self.loom { "loom file" } else { "image" };
            let title = format!("Open the {kind} {}", visible(&name.to_string_lossy()));
            ui.label(RichText::new(title).text_style(egui::TextStyle::Heading));
            ui.add_space(tokens::GAP);
            let room = ctx.content_rect().height() - 44.0 * tokens::GRID;
            let room = room.max(tokens::LIST_HEIGHT);
            ScrollArea::vertical()
                .min_scrolled_height(room)
                .max_height(room)
                .show(ui, |ui| {
                    ui.horizontal_top(|ui| {
                        ui.vertical(|ui| {
                            ui.set_width(QUESTIONS);
                            self.questions_ui(ui);
                        });
                        ui.vertical(|ui| {
                            ui.set_width(PREVIEW);
                            self.preview_ui(ui);
                        });
                    });
                });
            ui.add_space(tokens::GAP);
            answer = self.buttons_ui(ui);
        });
        if shown.escaped {
            answer = Some(Answer::Closed);
        }
        answer
    }

    /// Reads the image as the answers say, on a thread.
    fn read_again(&mut self, ctx: &egui::Context) {
        let (path, wanted) = (self.path.clone(), self.answers.clone());
        if !self.is_picture() {
            self.read.ask(ctx, &self.answers, move |_| {
                let options = LoadOptions {
                    sett: wanted.sett,
                    image: wanted.reading,
                    face_down: wanted.face_down,
                    ..LoadOptions::default()
                };
                let opened = Opened::read(path, &options).map_err(|error| Unread::of(&error))?;
                let image = thumbs::swatch_of(&opened.design, &opened.design.weave());
                Ok((opened, image))
            });
        }
        let answered = self.read.question().filter(|known| **known == self.answers);
        if let (Some(_), Some(Err(Unread::Picture(colours)))) = (answered, self.read.answer()) {
            // What it is shows in its colours: the way to open it is chosen.
            self.colours = Some(colours.clone());
            self.answers.reading.what = Some(ImageAs::Picture);
            return;
        }
        let fresh = self.shown.as_ref().map(|(known, _)| known) != answered;
        if let (true, Some(Ok((_, image))), Some(known)) = (fresh, self.read.answer(), answered) {
            let texture = ctx.load_texture("import", image.clone(), TextureOptions::LINEAR);
            self.shown = Some((known.clone(), texture));
        }
    }

    fn is_picture(&self) -> bool {
        self.answers.reading.what == Some(ImageAs::Picture)
    }

    fn questions_ui(&mut self, ui: &mut egui::Ui) {
        if self.loom {
            group(ui, "In the loom the cloth lies");
            ui.radio_value(&mut self.answers.face_down, false, "face up");
            ui.radio_value(&mut self.answers.face_down, true, "face down");
            return;
        }
        let label = ui.label("Made for or by");
        let name = |maker: Option<Convention>| maker.map_or("nobody in particular", maker_name);
        let mut maker = self.maker;
        let shown = ComboBox::from_id_salt("maker")
            .selected_text(name(maker))
            .show_ui(ui, |ui| {
                ui.selectable_value(&mut maker, None, name(None));
                for &known in Convention::ALL {
                    ui.selectable_value(&mut maker, Some(known), name(Some(known)));
                }
            });
        shown.response.labelled_by(label.id);
        if maker != self.maker {
            self.maker = maker;
            self.answers.reading = maker.map_or_else(ImageReading::default, Convention::reading);
        }
        let reading = &mut self.answers.reading;
        group(ui, "What it is");
        for (what, words) in KINDS {
            ui.radio_value(&mut reading.what, what, words);
        }
        // Not hidden where they say nothing: what was just pressed would move away.
        ui.add_enabled_ui(!self.is_picture(), |ui| self.reading_ui(ui));
    }

    /// How a weave or artwork is read.
    fn reading_ui(&mut self, ui: &mut egui::Ui) {
        let reading = &mut self.answers.reading;
        group(ui, "Black");
        ui.radio_value(&mut reading.black, Black::Warp, "warp up");
        ui.radio_value(&mut reading.black, Black::Weft, "weft up");
        group(ui, "End 1 and pick 1 meet");
        for (corner, words) in CORNERS {
            ui.radio_value(&mut reading.corner, corner, words);
        }
        ui.checkbox(&mut reading.mirror, "Exchange left and right: Z becomes S");
        group(ui, "Regions and yarns are told apart by");
        ui.radio_value(&mut reading.key, Key::Rgb, "their colour");
        ui.radio_value(&mut reading.key, Key::Index, "their place in the palette");
        group(ui, "Sett");
        let mut own = self.answers.sett.is_some();
        if ui
            .checkbox(&mut own, "I know it better than the file")
            .changed()
        {
            self.answers.sett = own.then(|| self.stated_sett());
        }
        if let Some((ends, picks)) = &mut self.answers.sett {
            for (value, name) in [(ends, "ends/cm"), (picks, "picks/cm")] {
                let field = DragValue::new(value).range(SETT_PER_CM).speed(0.1);
                let field = typing::number(ui, field.suffix(format!(" {name}")));
                field.widget_info(|| egui::WidgetInfo::labeled(egui::Role::SpinButton, true, name));
            }
        }
    }

    /// The sett that the file or its yarns have.
    fn stated_sett(&self) -> (f32, f32) {
        match self.read.answer() {
            Some(Ok((opened, _))) => {
                let sett = opened.design.sett();
                (sett.ends.per_cm, sett.picks.per_cm)
            }
            _ => (24.0, 24.0),
        }
    }

    fn preview_ui(&self, ui: &mut egui::Ui) {
        let palette = Palette::current(ui);
        if self.is_picture() {
            if let Some(colours) = &self.colours {
                ui.label(format!("A picture of {colours}."));
            }
            let text = "It becomes regions of weaves in the pane Posterise.";
            ui.label(RichText::new(text).color(palette.quiet));
            return;
        }
        if let Some((_, texture)) = &self.shown {
            let image = egui::Image::new((texture.id(), vec2(PREVIEW, PREVIEW)))
                .fit_to_exact_size(vec2(PREVIEW, PREVIEW))
                .alt_text("The drawdown that comes of it");
            ui.add(image);
        }
        if self.read.is_working() {
            ui.spinner();
            return;
        }
        match self.read.answer() {
            Some(Ok((opened, _))) => {
                let design = &opened.design;
                ui.label(format!("{} ends × {} picks", design.ends(), design.picks()));
                for warning in &opened.warnings {
                    ui.label(RichText::new(visible(warning)).small().color(palette.quiet));
                }
            }
            Some(Err(Unread::Wrong(problem))) => {
                ui.horizontal_wrapped(|ui| {
                    icons::show(ui, Grade::Error, palette.error);
                    ui.label(
                        RichText::new(format!("Error: {}", visible(problem))).color(palette.error),
                    );
                });
            }
            Some(Err(Unread::Picture(_))) | None => {}
        }
    }

    fn buttons_ui(&self, ui: &mut egui::Ui) -> Option<Answer> {
        let mut answer = None;
        // Enter is the first button's, unless something else has the keyboard.
        let is_free = ui.memory(|memory| memory.focused().is_none());
        let entered =
            is_free && ui.input_mut(|input| input.consume_key(Modifiers::NONE, Pressed::Enter));
        ui.horizontal(|ui| {
            if self.is_picture() {
                if ui.button("Posterise").clicked() || entered {
                    answer = Some(Answer::Posterise(self.path.clone()));
                }
            } else {
                let ready = match self.read.answer() {
                    Some(Ok((opened, _))) if self.read.question() == Some(&self.answers) => {
                        Some(opened)
                    }
                    _ => None,
                };
                let open = ui.add_enabled(ready.is_some(), Button::new("Open it"));
                if let Some(opened) = ready.filter(|_| open.clicked() || entered) {
                    answer = Some(Answer::Open(Box::new(opened.clone())));
                }
            }
            if ui.button("Cancel").clicked() {
                answer = Some(Answer::Closed);
            }
        });
        answer
    }
}

pub fn group(ui: &mut egui::Ui, title: &str) {
    ui.add_space(tokens::GRID);
    ui.label(RichText::new(title).strong());
}

fn maker_name(maker: Convention) -> &'static str {
    match maker {
        Convention::Tc2 => "TC2 (Digital Weaving Norway)",
        Convention::Pointcarre => "Pointcarré",
        Convention::ArahWeave => "ArahWeave or ArahPaint",
    }
}
