//! Colourways: named sets of yarns for one structure, side by side.

use egui::{RichText, ScrollArea, Sense, Stroke, TextEdit, vec2};
use pickglass::design::{Colouring, Design, swatch};
use pickglass::design::{Srgb, SwatchWindow, Yarn};
use pickglass::edit::{Document, Edit};
use pickglass::text::visible;

use super::swatches;
use super::{PaneView, Shown};
use crate::tokens::{self, Palette};
use crate::window::action::Action;
use crate::window::draft::picture_uv;

use crate::window::{focus, typing};

/// Side of a thumbnail, in pixels and points.
const THUMB: usize = 96;
/// Yarns of a colourway that are shown.
const MOST_YARNS: usize = 24;

/// The list.
#[derive(Default)]
pub struct Colourways {
    renaming: Option<Renaming>,
    thumbs: Option<Thumbs>,
}

/// A colourway that is being renamed.
struct Renaming {
    at: usize,
    text: String,
    /// The field was given the keyboard.
    begun: bool,
    problem: Option<String>,
}

impl Renaming {
    /// Whether a name can be had; what is wrong with it is told.
    fn check(&mut self, document: &Document) -> Option<Edit> {
        let edit = Edit::RenameColourway {
            colourway: self.at,
            name: self.text.trim().to_owned(),
        };
        self.problem = match document.check(edit.clone()) {
            _ if self.text.trim().is_empty() => Some("a colourway needs a name".to_owned()),
            Err(error) => Some(error.to_string()),
            Ok(()) => None,
        };
        self.problem.is_none().then_some(edit)
    }
}

/// A picture of each colourway, the design's own yarns first.
struct Thumbs {
    revision: u64,
    textures: Vec<egui::TextureHandle>,
}

impl PaneView for Colourways {
    fn show(&mut self, ui: &mut egui::Ui, shown: &Shown<'_>, actions: &mut Vec<Action>) {
        let document = shown.document;
        let design = document.design();
        self.draw_thumbs(ui.ctx(), document);
        let add = ui.button("Duplicate the yarns in use");
        if add
            .on_hover_text("A colourway more that begins as the cloth is now")
            .clicked()
        {
            let name = free_name(design);
            actions.push(Action::edit(Edit::AddColourway { name, of: None }));
        }
        let own = (None, "In use", design.yarns());
        let named = design.colourways().iter().enumerate();
        let all: Vec<(Option<usize>, &str, &[Yarn])> = std::iter::once(own)
            .chain(named.map(|(at, c)| (Some(at), c.name.as_str(), c.yarns.as_slice())))
            .collect();
        if all.len() == 1 {
            let quiet = Palette::current(ui).quiet;
            let text = "No colourways yet: duplicate the yarns in use and change their colours.";
            ui.label(RichText::new(text).color(quiet));
        }
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            ui.horizontal_wrapped(|ui| {
                for (place, (at, name, yarns)) in all.into_iter().enumerate() {
                    ui.vertical(|ui| {
                        ui.set_width(2.0 * THUMB as f32);
                        self.one_ui(
                            ui,
                            document,
                            (place, at, name, yarns),
                            shown.turned,
                            actions,
                        );
                    });
                }
            });
        });
    }

    fn forget(&mut self) {
        *self = Self::default();
    }
}

impl Colourways {
    fn one_ui(
        &mut self,
        ui: &mut egui::Ui,
        document: &Document,
        (place, at, name, yarns): (usize, Option<usize>, &str, &[Yarn]),
        turned: bool,
        actions: &mut Vec<Action>,
    ) {
        let side = THUMB as f32;
        let (rect, response) = ui.allocate_exact_size(vec2(side, side), Sense::click());
        let shown = visible(name);
        let spoken = match at {
            None => format!("Cloth as it is: {shown}"),
            Some(_) => format!("Use colourway {shown}"),
        };
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &spoken));
        if let Some(texture) = self
            .thumbs
            .as_ref()
            .and_then(|thumbs| thumbs.textures.get(place))
        {
            let uv = picture_uv(turned);
            ui.painter()
                .image(texture.id(), rect, uv, egui::Color32::WHITE);
        }
        let colour = if response.hovered() || at.is_none() {
            tokens::ACCENT
        } else {
            Palette::current(ui).line
        };
        let inside = egui::StrokeKind::Inside;
        ui.painter()
            .rect_stroke(rect, 0.0, Stroke::new(2.0, colour), inside);
        if response.has_focus() {
            focus::ring(ui.painter(), rect, &Palette::current(ui));
        }
        if response.on_hover_text(&spoken).clicked()
            && let Some(at) = at
        {
            actions.push(Action::edit(Edit::UseColourway(at)));
        }
        let Some(at) = at else {
            ui.label(RichText::new(shown).strong());
            swatches_ui(ui, None, yarns, actions);
            return;
        };
        match &mut self.renaming {
            Some(renaming) if renaming.at == at => {
                if rename_ui(ui, document, name, renaming, actions) {
                    self.renaming = None;
                }
            }
            _ => {
                ui.label(shown.as_ref());
            }
        }
        swatches_ui(ui, Some(at), yarns, actions);
        ui.horizontal(|ui| {
            let mut small = |text: &str, tip: &str| {
                let spoken = format!("{text} {shown}");
                let button = ui.small_button(text).on_hover_text(tip);
                button.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &spoken));
                button.clicked()
            };
            if small(
                "Use",
                "Weave in these yarns; those in use take their place here",
            ) {
                actions.push(Action::edit(Edit::UseColourway(at)));
            }
            if small("Rename", "Another name") {
                self.renaming = Some(Renaming {
                    at,
                    text: name.to_owned(),
                    begun: false,
                    problem: None,
                });
            }
            if small("Copy", "A colourway more that begins like this") {
                let name = format!("{name} copy");
                actions.push(Action::edit(Edit::AddColourway { name, of: Some(at) }));
            }
            if small("Remove", "Take it off the list") {
                actions.push(Action::edit(Edit::RemoveColourway(at)));
            }
        });
    }

    /// Draws the drawdown in the yarns of every colourway where the document changed.
    fn draw_thumbs(&mut self, ctx: &egui::Context, document: &Document) {
        let revision = document.revision();
        if self
            .thumbs
            .as_ref()
            .is_some_and(|thumbs| thumbs.revision == revision)
        {
            return;
        }
        let design = document.design();
        let window = SwatchWindow {
            end: 0,
            pick: 0,
            size: [THUMB, THUMB],
            level: 0,
        };
        let draw = |name: &str, design: &Design| {
            let pixels = swatch(design, document.drawdown(), window, Colouring::Yarns);
            let bytes: Vec<u8> = pixels.into_iter().flatten().collect();
            let image = egui::ColorImage::from_rgba_unmultiplied([THUMB, THUMB], &bytes);
            ctx.load_texture(name, image, egui::TextureOptions::NEAREST)
        };
        let mut textures = vec![draw("colourway in use", design)];
        for colourway in design.colourways() {
            if let Ok(dyed) = Design::clone(design).with_colourway(&colourway.name) {
                textures.push(draw(&colourway.name, &dyed));
            }
        }
        self.thumbs = Some(Thumbs { revision, textures });
    }
}

/// The field for a new name; true once it is left.
fn rename_ui(
    ui: &mut egui::Ui,
    document: &Document,
    name: &str,
    renaming: &mut Renaming,
    actions: &mut Vec<Action>,
) -> bool {
    let field = ui.add(TextEdit::singleline(&mut renaming.text).char_limit(80));
    let spoken = format!("New name of {name}");
    field.widget_info(|| egui::WidgetInfo::labeled(egui::Role::TextInput, true, &spoken));
    if !std::mem::replace(&mut renaming.begun, true) {
        field.request_focus();
    }
    if let Some(problem) = &renaming.problem {
        ui.label(RichText::new(format!("Error: {problem}")).color(Palette::current(ui).error));
    }
    if typing::given_up(ui, &field) {
        return true;
    }
    if !field.lost_focus() {
        return false;
    }
    let edit = renaming.check(document);
    if edit.is_none() && typing::entered(ui, &field) {
        field.request_focus();
    }
    let left = edit.is_some();
    actions.extend(edit.map(Action::edit));
    left
}

/// The colours of a set of yarns; those of a colourway can be changed here.
fn swatches_ui(
    ui: &mut egui::Ui,
    colourway: Option<usize>,
    yarns: &[Yarn],
    actions: &mut Vec<Action>,
) {
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = vec2(tokens::GRID, tokens::GRID);
        for (number, yarn) in yarns.iter().enumerate().take(MOST_YARNS) {
            let Some(colourway) = colourway else {
                swatches::field(ui, yarn.colour, &yarn.name);
                continue;
            };
            let mut colour: Srgb = yarn.colour;
            swatches::button(ui, &mut colour, &yarn.name);
            if colour != yarn.colour {
                actions.push(Action::edit(Edit::SetColourwayYarn {
                    colourway,
                    yarn: pickglass::design::YarnId(number as u16),
                    to: Box::new(Yarn {
                        colour,
                        ..yarn.clone()
                    }),
                }));
            }
        }
    });
}

/// "colourway 2" or the next number that is free.
fn free_name(design: &Design) -> String {
    let taken = |name: &str| design.colourways().iter().any(|known| known.name == name);
    (design.colourways().len() + 1..)
        .map(|number| format!("colourway {number}"))
        .find(|name| !taken(name))
        .unwrap_or_default()
}
