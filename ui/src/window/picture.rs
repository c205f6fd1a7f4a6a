//! Pictures that people open, made small enough for the screen.

use pickglass::design::SourceImage;

use crate::tokens;

/// Every so many pixels of a picture, so that neither side is longer than `longest`.
pub fn shrunk(source: &SourceImage, longest: usize) -> egui::ColorImage {
    let (width, height) = (source.width() as usize, source.height() as usize);
    let step = width.max(height).div_ceil(longest.max(1)).max(1);
    let size = [width / step, height / step].map(|side| side.max(1));
    let pixels = (0..size[0] * size[1])
        .map(|at| {
            let (x, y) = (at % size[0] * step, at / size[0] * step);
            let [red, green, blue] = source.pixels()[y * width + x];
            tokens::yarn_colour(red, green, blue)
        })
        .collect();
    egui::ColorImage::new(size, pixels)
}
