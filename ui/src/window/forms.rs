//! Forms of the weave menu: size, repeat, loom, name and notes. Each begins with what the
//! design has and comes to edits, which are one entry of the history.

use egui::{ComboBox, DragValue, Response, RichText, ScrollArea};
use pickglass::design::{
    Design, Lattice, Lifting, MAX_CROSSINGS, MAX_SHAFTS, Repeat, Shed, WeavePattern, library, weave,
};
use pickglass::edit::Edit;

use super::{dialog, draft, typing};
use crate::tokens::{self, Palette};

/// Names of the library that are offered while a weave is typed.
const MOST_NAMES: usize = 12;
/// Room for them, points.
const NAMES_HEIGHT: f32 = 24.0 * tokens::GRID;

/// A form with what was entered so far.
pub enum Form {
    Size {
        ends: u32,
        picks: u32,
    },
    Repeat(Lattice),
    /// Repeats across and along that become one.
    Tile([u32; 2]),
    Loom {
        before: Loom,
        wanted: Loom,
    },
    Words {
        name: String,
        notes: String,
    },
    /// The notation or the name of a weave to stamp.
    Stamp(String),
}

/// What a loom can be told.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Loom {
    shafts: u32,
    treadles: u32,
    shed: Shed,
    lift_plan: bool,
}

/// What came of a form in this frame.
pub enum Filled {
    Open,
    Closed,
    /// The entry of the history, and its edits.
    Done(&'static str, Vec<Edit>),
    /// A weave to stamp.
    Stamp(WeavePattern),
}

impl Form {
    /// Ends and picks.
    pub fn size(design: &Design) -> Self {
        Self::Size {
            ends: design.ends(),
            picks: design.picks(),
        }
    }

    /// How the design repeats.
    pub fn repeat(design: &Design) -> Self {
        Self::Repeat(design.lattice())
    }

    /// Shafts, treadles and shed; `None` for a design without a draft.
    pub fn loom(design: &Design) -> Option<Self> {
        let draft = draft::draft_of(design)?;
        let loom = Loom {
            shafts: draft.shafts(),
            treadles: draft.treadles(),
            shed: draft.shed(),
            lift_plan: matches!(draft.lifting(), Lifting::LiftPlan(_)),
        };
        Some(Self::Loom {
            before: loom,
            wanted: loom,
        })
    }

    /// Name and notes.
    pub fn words(design: &Design) -> Self {
        Self::Words {
            name: design.name.clone(),
            notes: design.notes.clone(),
        }
    }

    fn title(&self) -> &'static str {
        match self {
            Self::Size { .. } => "Resize",
            Self::Repeat(_) => "Repeat",
            Self::Tile(_) => "Repeat more often",
            Self::Loom { .. } => "Loom",
            Self::Words { .. } => "Name and notes",
            Self::Stamp(_) => "Stamp a weave",
        }
    }

    /// Shows the form.
    pub fn show(&mut self, ui: &mut egui::Ui) -> Filled {
        let title = self.title();
        ui.label(RichText::new(title).text_style(egui::TextStyle::Heading));
        ui.add_space(tokens::GRID);
        let mut entered = false;
        let wrong = match self {
            Self::Size { ends, picks } => size_ui(ui, ends, picks),
            Self::Repeat(lattice) => repeat_ui(ui, lattice),
            Self::Tile(copies) => {
                note(ui, "So many repeats become one, so that they can differ.");
                let [across, along] = copies;
                egui::Grid::new("tile").num_columns(2).show(ui, |ui| {
                    number(ui, "Across", across, 1 << 10);
                    number(ui, "Along", along, 1 << 10);
                });
                None
            }
            Self::Loom { wanted, .. } => {
                loom_ui(ui, wanted);
                None
            }
            Self::Words { name, notes } => {
                let field = words_ui(ui, name, notes);
                entered = typing::entered(ui, &field);
                if entered {
                    field.request_focus();
                }
                let empty = name.trim().is_empty();
                empty.then(|| "a design needs a name, to be found again: type one".to_owned())
            }
            Self::Stamp(text) => {
                let field = stamp_ui(ui, text);
                entered = typing::entered(ui, &field);
                if entered {
                    field.request_focus();
                }
                by_name(text).err().filter(|_| !text.trim().is_empty())
            }
        };
        dialog::problem(ui, wrong.as_deref());
        let mut filled = Filled::Open;
        ui.horizontal(|ui| {
            let apply = egui::Button::new("Apply");
            let ready =
                wrong.is_none() && !matches!(self, Self::Stamp(text) if text.trim().is_empty());
            if ui.add_enabled(ready, apply).clicked() || (ready && entered) {
                filled = match self {
                    Self::Stamp(text) => by_name(text).map_or(Filled::Open, Filled::Stamp),
                    _ => Filled::Done(title, self.edits()),
                };
            }
            if ui.button("Cancel").clicked() {
                filled = Filled::Closed;
            }
        });
        filled
    }

    /// The edits that make the design what the form says.
    fn edits(&self) -> Vec<Edit> {
        match self {
            Self::Size { ends, picks } => vec![Edit::Resize {
                ends: *ends,
                picks: *picks,
            }],
            Self::Repeat(lattice) => vec![Edit::SetLattice(*lattice)],
            Self::Tile([across, along]) => vec![Edit::Tile {
                across: *across,
                along: *along,
            }],
            Self::Loom { before, wanted } => loom_edits(*before, *wanted),
            Self::Words { name, notes } => vec![
                Edit::Rename(name.trim().to_owned()),
                Edit::SetNotes(notes.clone()),
            ],
            Self::Stamp(_) => Vec::new(),
        }
    }
}

/// Only what differs is changed. Shafts come before the lifting, which may need them.
fn loom_edits(before: Loom, wanted: Loom) -> Vec<Edit> {
    let mut edits = Vec::new();
    if wanted.shafts != before.shafts {
        edits.push(Edit::SetShafts(wanted.shafts));
    }
    if wanted.shed != before.shed {
        edits.push(Edit::SetShed(wanted.shed));
    }
    match (before.lift_plan, wanted.lift_plan) {
        (false, true) => edits.push(Edit::UseLiftPlan),
        (true, false) => edits.push(Edit::UseTreadles),
        (false, false) if wanted.treadles != before.treadles => {
            edits.push(Edit::SetTreadles(wanted.treadles));
        }
        _ => {}
    }
    edits
}

fn note(ui: &mut egui::Ui, text: &str) {
    let quiet = Palette::current(ui).quiet;
    ui.label(RichText::new(text).color(quiet));
    ui.add_space(tokens::GAP);
}

fn number(ui: &mut egui::Ui, name: &str, value: &mut u32, most: u32) {
    let label = ui.label(name);
    typing::number(ui, DragValue::new(value).range(1..=most)).labelled_by(label.id);
    ui.end_row();
}

fn size_ui(ui: &mut egui::Ui, ends: &mut u32, picks: &mut u32) -> Option<String> {
    note(
        ui,
        "The design repeats into what is new; the rest is cut off.",
    );
    egui::Grid::new("size").num_columns(2).show(ui, |ui| {
        number(ui, "Ends", ends, 1 << 20);
        number(ui, "Picks", picks, 1 << 20);
    });
    let crossings = u64::from(*ends) * u64::from(*picks);
    (crossings > MAX_CROSSINGS)
        .then(|| format!("{crossings} crossings; the most is {MAX_CROSSINGS}"))
}

fn repeat_ui(ui: &mut egui::Ui, lattice: &mut Lattice) -> Option<String> {
    note(
        ui,
        "What lies beside the design: the same again, the same shifted, or nothing.",
    );
    egui::Grid::new("repeat").num_columns(3).show(ui, |ui| {
        direction_ui(ui, "Across (past the last end)", &mut lattice.across);
        direction_ui(ui, "Along (past the last pick)", &mut lattice.along);
    });
    lattice.check().err().map(|error| error.to_string())
}

fn direction_ui(ui: &mut egui::Ui, name: &str, repeat: &mut Repeat) {
    ui.label(name);
    let words = |repeat: &Repeat| match repeat {
        Repeat::Straight => "straight",
        Repeat::Dropped(_) => "shifted by",
        Repeat::None => "nothing",
    };
    let shift = match repeat {
        Repeat::Dropped(by) => *by,
        _ => 1,
    };
    let choices = ComboBox::from_id_salt(name).selected_text(words(repeat));
    let shown = choices.show_ui(ui, |ui| {
        for choice in [Repeat::Straight, Repeat::Dropped(shift), Repeat::None] {
            ui.selectable_value(repeat, choice, words(&choice));
        }
    });
    let now = words(repeat);
    shown.response.widget_info(|| {
        egui::WidgetInfo::labeled(egui::Role::ComboBox, true, format!("{name}: {now}"))
    });
    if let Repeat::Dropped(by) = repeat {
        let field = DragValue::new(by)
            .range(0..=u32::from(u16::MAX))
            .suffix(" threads");
        let field = typing::number(ui, field);
        field.widget_info(|| {
            egui::WidgetInfo::labeled(egui::Role::SpinButton, true, format!("{name}: shift"))
        });
    }
    ui.end_row();
}

fn loom_ui(ui: &mut egui::Ui, wanted: &mut Loom) {
    note(ui, "The cloth stays unless shafts in use are taken away.");
    egui::Grid::new("loom").num_columns(2).show(ui, |ui| {
        number(ui, "Shafts", &mut wanted.shafts, MAX_SHAFTS.min(1024));
        // Not hidden where there are none: what is chosen below would move away.
        let treadles = ui.label("Treadles");
        ui.add_enabled_ui(!wanted.lift_plan, |ui| {
            let field = DragValue::new(&mut wanted.treadles).range(1..=MAX_SHAFTS.min(1024));
            typing::number(ui, field).labelled_by(treadles.id);
        });
        ui.end_row();
        ui.label("Lifting");
        ui.horizontal(|ui| {
            ui.selectable_value(&mut wanted.lift_plan, false, "tie-up and treadles");
            ui.selectable_value(&mut wanted.lift_plan, true, "lift plan");
        });
        ui.end_row();
        ui.label("Shed");
        ui.horizontal(|ui| {
            ui.selectable_value(&mut wanted.shed, Shed::Rising, "rising");
            ui.selectable_value(&mut wanted.shed, Shed::Sinking, "sinking");
        });
        ui.end_row();
    });
}

/// The fields; that of the name is given back.
fn words_ui(ui: &mut egui::Ui, name: &mut String, notes: &mut String) -> Response {
    let label = ui.label("Name");
    let field = egui::TextEdit::singleline(name).desired_width(f32::INFINITY);
    let field = ui.add(field).labelled_by(label.id);
    let label = ui.label("Notes");
    ui.add(egui::TextEdit::multiline(notes).desired_width(f32::INFINITY))
        .labelled_by(label.id);
    field
}

/// The weave of a name in the library, or of a notation.
fn by_name(text: &str) -> Result<WeavePattern, String> {
    match library::find(text) {
        Some(known) => Ok(known.pattern().clone()),
        None => weave(text).map_err(|error| error.to_string()),
    }
}

/// The field of the weave, given back, and names that it may become.
fn stamp_ui(ui: &mut egui::Ui, text: &mut String) -> Response {
    note(
        ui,
        "A notation such as 3/1 twill, or a name from the library.",
    );
    let label = ui.label("Weave");
    let field = egui::TextEdit::singleline(text).desired_width(f32::INFINITY);
    let field = ui.add(field).labelled_by(label.id);
    let typed = text.trim().to_lowercase();
    let names = (library::library().iter())
        .map(library::LibraryWeave::name)
        .filter(|name| *name != typed && name.to_lowercase().contains(&typed))
        .take(MOST_NAMES);
    let mut chosen = None;
    // As high whatever is found: the field stays where it is while one types.
    ScrollArea::vertical()
        .auto_shrink(false)
        .min_scrolled_height(NAMES_HEIGHT)
        .max_height(NAMES_HEIGHT)
        .show(ui, |ui| {
            ui.horizontal_wrapped(|ui| {
                for name in names {
                    if ui.small_button(name).clicked() {
                        chosen = Some(name.to_owned());
                    }
                }
            });
        });
    if let Some(name) = chosen {
        *text = name;
        field.request_focus();
    }
    field
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::window::session::blank;
    use pickglass::edit::Document;

    #[test]
    fn a_loom_form_changes_what_differs_and_the_cloth_stays() {
        let design = Design::clone(&blank().expect("a design").design);
        let Some(Form::Loom { before, .. }) = Form::loom(&design) else {
            panic!("no draft");
        };
        assert!(loom_edits(before, before).is_empty());
        let wanted = Loom {
            shafts: 8,
            lift_plan: true,
            ..before
        };
        let mut document = Document::new(design);
        let cloth = document.drawdown().clone();
        for edit in loom_edits(before, wanted) {
            document.apply(edit).expect("an edit");
        }
        assert_eq!(**document.drawdown(), *cloth);
        let Some(Form::Loom { before: now, .. }) = Form::loom(document.design()) else {
            panic!("no draft any more");
        };
        assert_eq!((now.shafts, now.lift_plan), (8, true));
    }

    #[test]
    fn a_weave_is_found_by_its_name_and_by_its_notation() {
        let known = &library::library()[0];
        assert_eq!(by_name(known.name()).as_ref(), Ok(known.pattern()));
        let twill = by_name("2/2 twill").expect("a weave");
        assert_eq!((twill.ends(), twill.picks()), (4, 4));
        assert!(by_name("2/2 nonsense").is_err());
    }
}
