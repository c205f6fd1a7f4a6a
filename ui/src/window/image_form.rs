//! Writing a draft as an image: looms and programs differ in what black means and in where
//! they begin to count, so both are asked.

use std::path::{Path, PathBuf};

use egui::RichText;
use pickglass::formats::image::{Black, ImageContent};
use pickglass::formats::{self, Kind, SaveOptions};
use pickglass::text::visible;

use super::{dialog, import};
use crate::tokens::{self, Palette};

/// What an image may show.
const CONTENTS: [(ImageContent, &str, &str); 4] = [
    (
        ImageContent::Weave,
        "The weave, black and white",
        "One bit a crossing: what looms take",
    ),
    (
        ImageContent::Artwork,
        "The regions, each in its colour",
        "Of a design in regions",
    ),
    (
        ImageContent::Warp,
        "The warp yarn of each crossing",
        "In its colour",
    ),
    (
        ImageContent::Weft,
        "The weft yarn of each crossing",
        "In its colour",
    ),
];

/// What came of the form in this frame.
pub enum Answer {
    Write(PathBuf, SaveOptions),
    Closed,
}

/// The form of one image that is to be written.
pub struct ImageForm {
    path: PathBuf,
    options: SaveOptions,
}

impl ImageForm {
    /// The form of the image at a path; `None` where the ending is that of no image.
    pub fn of(path: &Path) -> Option<Self> {
        let format = formats::of_ending(&path.extension()?.to_string_lossy())?;
        (format.kind == Kind::Image && format.is_written()).then(|| Self {
            path: path.to_owned(),
            options: SaveOptions::default(),
        })
    }

    /// Shows it; the answer once there is one.
    pub fn show(&mut self, ctx: &egui::Context) -> Option<Answer> {
        let mut answer = None;
        let shown = dialog::show(ctx, "draft as image", |ui| {
            ui.set_width(tokens::TOAST_WIDTH);
            let name = self.path.file_name().unwrap_or(self.path.as_os_str());
            let title = format!("Write the image {}", visible(&name.to_string_lossy()));
            ui.label(RichText::new(title).text_style(egui::TextStyle::Heading));
            self.questions_ui(ui);
            ui.add_space(tokens::PAD);
            ui.horizontal(|ui| {
                if ui.button("Write it").clicked() {
                    answer = Some(Answer::Write(self.path.clone(), self.options.clone()));
                }
                if ui.button("Cancel").clicked() {
                    answer = Some(Answer::Closed);
                }
            });
        });
        if answer.is_none() && shown.escaped {
            answer = Some(Answer::Closed);
        }
        answer
    }

    fn questions_ui(&mut self, ui: &mut egui::Ui) {
        let options = &mut self.options;
        import::group(ui, "What it shows");
        for (content, words, tip) in CONTENTS {
            ui.radio_value(&mut options.content, content, words)
                .on_hover_text(tip);
        }
        // Not hidden where it says nothing: what was just pressed would move away.
        ui.add_enabled_ui(options.content == ImageContent::Weave, |ui| {
            import::group(ui, "Black");
            ui.radio_value(&mut options.black, Black::Warp, "warp up");
            ui.radio_value(&mut options.black, Black::Weft, "weft up");
        });
        import::group(ui, "End 1 and pick 1 meet");
        let before = "where they did in the file it is from";
        ui.radio_value(&mut options.corner, None, before);
        for (corner, words) in import::CORNERS {
            ui.radio_value(&mut options.corner, Some(corner), words);
        }
        let quiet = Palette::current(ui).quiet;
        ui.add_space(tokens::GRID);
        let text = "The image shows the face; from an upper corner it is turned by 180°.";
        ui.label(RichText::new(text).color(quiet));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn images_are_asked_about_and_drafts_are_not() {
        for name in ["a.png", "a.TIF", "b.gif", "b.bmp"] {
            assert!(ImageForm::of(Path::new(name)).is_some(), "{name}");
        }
        for name in ["a.wif", "a.ron", "png"] {
            assert!(ImageForm::of(Path::new(name)).is_none(), "{name}");
        }
    }
}
