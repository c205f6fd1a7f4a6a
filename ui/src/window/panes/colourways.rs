//! Colourways: named sets of yarns for one structure, side by side.

use egui::{RichText, ScrollArea, Sense, Stroke, TextEdit, vec2};
use pickglass::design::{Colouring, Design, swatch};
use pickglass::design::{Srgb, SwatchWindow, Yarn};
use pickglass::edit::{Document, Edit};

use super::swatches;
use crate::tokens::{self, Palette};
use crate::window::action::Action;
use crate::window::draft::picture_uv;
use crate::window::focus;

/// Side of a thumbnail, in pixels and points.
const THUMB: usize = 96;
/// Yarns of a colourway that are shown.
const MOST_YARNS: usize = 24;

/// The list.
#[derive(Default)]
pub struct Colourways {
    /// The colourway that is being renamed, and its new name.
    renaming: Option<(usize, String)>,
    thumbs: Option<Thumbs>,
}

/// A picture of each colourway, the design's own yarns first.
struct Thumbs {
    revision: u64,
    textures: Vec<egui::TextureHandle>,
}

impl Colourways {
    /// Shows the list.
    pub fn show(
        &mut self,
        ui: &mut egui::Ui,
        document: &Document,
        turned: bool,
        actions: &mut Vec<Action>,
    ) {
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
                        self.one_ui(ui, (place, turned), at, name, yarns, actions);
                    });
                }
            });
        });
    }

    fn one_ui(
        &mut self,
        ui: &mut egui::Ui,
        (place, turned): (usize, bool),
        at: Option<usize>,
        name: &str,
        yarns: &[Yarn],
        actions: &mut Vec<Action>,
    ) {
        let side = THUMB as f32;
        let (rect, response) = ui.allocate_exact_size(vec2(side, side), Sense::click());
        let spoken = match at {
            None => format!("Cloth as it is: {name}"),
            Some(_) => format!("Use colourway {name}"),
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
            ui.label(RichText::new(name).strong());
            swatches_ui(ui, None, yarns, actions);
            return;
        };
        match &mut self.renaming {
            Some((renamed, text)) if *renamed == at => {
                let field = ui.add(TextEdit::singleline(text).char_limit(80));
                let spoken = format!("New name of {name}");
                field.widget_info(|| {
                    egui::WidgetInfo::labeled(egui::Role::TextInput, true, &spoken)
                });
                if field.lost_focus() {
                    let name = text.trim().to_owned();
                    if !name.is_empty() && ui.input(|input| !input.key_pressed(egui::Key::Escape)) {
                        actions.push(Action::edit(Edit::RenameColourway {
                            colourway: at,
                            name,
                        }));
                    }
                    self.renaming = None;
                } else {
                    field.request_focus();
                }
            }
            _ => {
                ui.label(name);
            }
        }
        swatches_ui(ui, Some(at), yarns, actions);
        ui.horizontal(|ui| {
            let mut small = |text: &str, tip: &str| {
                let spoken = format!("{text} {name}");
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
                self.renaming = Some((at, name.to_owned()));
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
