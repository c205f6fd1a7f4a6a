//! What all questions and forms share: they lie over the window, with room round them.

use std::path::PathBuf;

use egui::{Context, Frame, Id, Modal};

use super::task::{Outcome, Task};
use crate::tokens;

/// A question or form of this name, to be shown.
pub fn modal(ctx: &Context, name: &str) -> Modal {
    let frame = Frame::popup(&ctx.style_of(ctx.theme())).inner_margin(tokens::PAD);
    Modal::new(Id::unique(name)).frame(frame)
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
