//! What all questions and forms share: they lie over the window, with room round them, and
//! only what their fields, their buttons and Esc say closes them.

use std::path::PathBuf;

use egui::{Align2, Context, Frame, Id, Modal, Pos2, Rect, RichText};

use super::icons;
use super::task::{Outcome, Task};
use super::toasts::Grade;
use crate::tokens::{self, Palette};
use pickglass::text::visible;

/// Passes in which a form that was just opened finds its place.
const SETTLING: u64 = 3;

/// What came of a form in this frame.
pub struct Shown<R> {
    pub inner: R,
    /// Esc was pressed: the form is to be closed.
    pub escaped: bool,
    /// It was clicked beside the form. What was typed is not given up by that.
    pub beside: bool,
}

/// Where a form lies, and since when.
#[derive(Clone, Copy)]
struct Place {
    opened: u64,
    pass: u64,
    screen: Rect,
    rect: Rect,
}

/// Shows a question or form of this name in the middle of the window. Where its size
/// changes, its lower edge stays: the buttons are there, and one of them may be just about
/// to be pressed.
pub fn show<R>(ctx: &Context, name: &str, content: impl FnOnce(&mut egui::Ui) -> R) -> Shown<R> {
    let id = Id::unique(name);
    let key = id.with("place");
    let (pass, screen) = (ctx.cumulative_pass_nr(), ctx.content_rect());
    let before = ctx
        .data(|kept| kept.get_temp::<Place>(key))
        .filter(|place| place.pass + 1 >= pass && place.screen == screen);
    let opened = before.map_or(pass, |place| place.opened);
    let settled = before.filter(|_| pass - opened >= SETTLING);
    let frame = Frame::popup(&ctx.style_of(ctx.theme())).inner_margin(tokens::PAD);
    let mut area = Modal::default_area(id);
    if let Some(place) = settled {
        area = egui::Area::new(id)
            .kind(egui::UiKind::Modal)
            .sense(egui::Sense::hover())
            .order(egui::Order::Foreground)
            .pivot(Align2::LEFT_BOTTOM)
            .fixed_pos(place.rect.left_bottom());
    }
    let modal = Modal::new(id).area(area).frame(frame).show(ctx, content);
    let size = modal.response.rect.size();
    let changed = before.is_some_and(|place| (place.rect.size() - size).length() > 0.5);
    let rect = match settled {
        Some(place) => {
            let corner = place.rect.left_bottom();
            Rect::from_min_max(
                Pos2::new(corner.x, corner.y - size.y),
                Pos2::new(corner.x + size.x, corner.y),
            )
        }
        None => Rect::from_center_size(screen.center(), size),
    };
    let place = Place {
        opened,
        pass,
        screen,
        rect,
    };
    ctx.data_mut(|kept| kept.insert_temp(key, place));
    if changed {
        // Not even for a frame do the buttons lie elsewhere.
        ctx.request_discard("a form changed its size");
    } else if settled.is_none() {
        ctx.request_repaint();
    }
    let top = modal.is_top_modal && !modal.any_popup_open;
    Shown {
        beside: modal.backdrop_response.clicked(),
        escaped: top
            && ctx.input_mut(|input| input.consume_key(egui::Modifiers::NONE, egui::Key::Escape)),
        inner: modal.inner,
    }
}

/// A line that says what is wrong, if anything is. Its room is there always, so that
/// nothing moves when it comes and goes.
pub fn problem(ui: &mut egui::Ui, problem: Option<&str>) {
    ui.vertical(|ui| {
        ui.set_min_height(2.0 * ui.text_style_height(&egui::TextStyle::Body));
        if let Some(problem) = problem {
            let colour = Palette::current(ui).error;
            ui.horizontal_top(|ui| {
                icons::show(ui, Grade::Error, colour);
                let text = RichText::new(format!("Error: {}", visible(problem))).color(colour);
                ui.add(egui::Label::new(text).wrap());
            });
        }
    });
}

/// The system's dialog that asks where to write a file, one at a time.
#[derive(Default)]
pub struct Browse(Option<Task<Option<PathBuf>>>);

impl Browse {
    /// Asks, unless it is asking.
    pub fn ask(
        &mut self,
        ctx: &Context,
        title: &'static str,
        files: &'static str,
        endings: &'static [&'static str],
    ) {
        if self.0.is_none() {
            let dialog = move || {
                rfd::FileDialog::new()
                    .set_title(title)
                    .add_filter(files, endings)
                    .save_file()
            };
            self.0 = Task::start(ctx, "dialog", dialog).ok();
        }
    }

    /// The file that was chosen, once.
    pub fn poll(&mut self) -> Option<PathBuf> {
        let chosen = match self.0.as_ref()?.poll() {
            Outcome::Working => return None,
            Outcome::Ready(chosen) => chosen,
            Outcome::Lost => None,
        };
        self.0 = None;
        chosen
    }
}
