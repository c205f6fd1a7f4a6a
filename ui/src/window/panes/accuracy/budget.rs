//! A budget: dials by the measured curves.

use egui::{Button, RichText, TextEdit, Ui};
use pickglass::accuracy::{Accuracy, Asked, Axis, Choice, number};
use pickglass::plan::Budget;

use super::words;
use crate::tokens::{self, Palette};
use crate::window::action::Action;

/// Width of what is written, points.
const WIDTH: f32 = 32.0 * tokens::GRID;

/// What was written, and what the curves say of it.
#[derive(Default)]
pub struct BudgetForm {
    text: String,
    found: Option<Found>,
}

/// What the curves say of a text.
struct Found {
    text: String,
    /// Which curves, as whoever measures counts them.
    curves: (u64, usize),
    /// The best use of the budget; or why there is none.
    choice: Result<Choice, String>,
}

impl BudgetForm {
    /// Writes into it.
    #[cfg(test)]
    pub fn write(&mut self, text: &str) {
        text.clone_into(&mut self.text);
    }

    /// What the curves say of what is written: many settings are tried for that, so once.
    fn choice(&mut self, accuracy: &Accuracy, curves: (u64, usize)) -> &Result<Choice, String> {
        let found = self.found.take();
        let found = found.filter(|found| found.text == self.text && found.curves == curves);
        let found = found.unwrap_or_else(|| Found {
            text: self.text.clone(),
            curves,
            choice: best(accuracy, &self.text),
        });
        &self.found.insert(found).choice
    }

    /// Shows it, with what the curves say of it, which are the `number`-th that were measured;
    /// `asked` is the picture that is looked at.
    pub fn show(
        &mut self,
        ui: &mut Ui,
        (accuracy, number): (&Accuracy, u64),
        asked: &Asked,
        actions: &mut Vec<Action>,
    ) {
        let palette = Palette::current(ui);
        ui.horizontal_wrapped(|ui| {
            let label = ui.label("Budget");
            let edit = TextEdit::singleline(&mut self.text)
                .hint_text("2 s, 1 % or ΔE 1")
                .desired_width(WIDTH);
            let tip = "So many seconds, or so little error: the curves choose the dials";
            let edit = ui.add(edit).labelled_by(label.id).on_hover_text(tip);
            let entered =
                edit.lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter));
            if self.text.trim().is_empty() {
                return;
            }
            let choice = match self.choice(accuracy, (number, accuracy.dials.len())) {
                Ok(choice) => choice,
                Err(wrong) => {
                    // It is to be written anew, and letters are keys of tools elsewhere.
                    if entered {
                        edit.request_focus();
                    }
                    ui.label(RichText::new(wrong).color(palette.warning));
                    return;
                }
            };
            let changes = changes(choice, asked);
            let set = ui.add_enabled(!changes.is_empty(), Button::new("Set the dials"));
            let set = set.on_hover_text(super::NOT_UNDONE);
            let told = said(choice, &changes);
            if set.clicked() || entered {
                let set = changes
                    .into_iter()
                    .map(|(axis, value)| Action::Set(axis.name().to_owned(), value));
                actions.extend(set);
            }
            ui.label(told);
        });
    }
}

/// The best use of what is written; or why there is none.
fn best(accuracy: &Accuracy, text: &str) -> Result<Choice, String> {
    let budget: Budget = text.parse()?;
    let choice = accuracy.within(budget);
    let choice = choice.ok_or("No measured settings are so good.")?;
    match budget {
        Budget::Seconds(seconds) if choice.seconds > seconds => Err(format!(
            "No measured settings of a traced picture are so fast: the fastest take {}.{}",
            words::duration(choice.seconds),
            first_sight(accuracy)
        )),
        _ => Ok(choice),
    }
}

/// What first sight takes, where that was measured.
fn first_sight(accuracy: &Accuracy) -> String {
    let curve = accuracy.dials.iter().find(|curve| curve.name == "renderer");
    let sight = curve.and_then(|curve| curve.point("sight"));
    sight.map_or_else(String::new, |sight| {
        let took = words::duration(sight.seconds);
        format!(" First sight, which no budget counts, takes {took}.")
    })
}

/// What the window sets for a choice, of what is set otherwise now.
fn changes(choice: &Choice, asked: &Asked) -> Vec<(Axis, String)> {
    let settings = choice.settings.iter();
    settings
        .filter_map(|(name, value)| {
            let axis = Axis::named(name).ok()?;
            let open = axis.elsewhere().is_none() && axis.current(asked) != *value;
            open.then(|| (axis, value.clone()))
        })
        .collect()
}

/// What a choice comes to, and what is set for it.
fn said(choice: &Choice, changes: &[(Axis, String)]) -> String {
    let seen = choice.delta_e.map_or_else(String::new, |delta_e| {
        format!(", {}", words::delta_e(delta_e))
    });
    let paths = choice
        .paths()
        .map_or_else(String::new, |paths| match paths {
            1 => " with one path a pixel".to_owned(),
            _ => format!(" with {paths} paths a pixel"),
        });
    let set = match changes {
        [] => "the dials are set so already".to_owned(),
        changes => (changes.iter())
            .map(|(axis, value)| format!("{}: {value}", words::title(axis)))
            .collect::<Vec<_>>()
            .join(", "),
    };
    // In the window, paths are not set: it goes on until the picture is good.
    format!(
        "After {} the picture is {} % wrong{seen}{paths}; it refines on, as the menu View \
         says under Refine until · {set}",
        words::duration(choice.seconds),
        number(100.0 * choice.error)
    )
}
