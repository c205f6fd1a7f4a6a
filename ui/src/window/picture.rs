//! Pictures for the screen: those that people open, made small enough, and those of cloth.

use pickglass::design::SourceImage;
use pickglass::film::Picture;

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

/// A picture of cloth, pixel by pixel.
pub fn image(picture: &Picture) -> egui::ColorImage {
    let size = [picture.width as usize, picture.height as usize];
    let bytes: Vec<u8> = (picture.pixels.iter())
        .flat_map(|pixel| pixel.map(|value| (value.clamp(0.0, 1.0) * 255.0).round() as u8))
        .collect();
    egui::ColorImage::from_rgba_unmultiplied(size, &bytes)
}
