//! What all questions and forms share: they lie over the window, with room round them.

use egui::{Context, Frame, Id, Modal};

use crate::tokens;

/// A question or form of this name, to be shown.
pub fn modal(ctx: &Context, name: &str) -> Modal {
    let frame = Frame::popup(&ctx.style_of(ctx.theme())).inner_margin(tokens::PAD);
    Modal::new(Id::unique(name)).frame(frame)
}
