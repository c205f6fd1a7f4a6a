//! What is shown in the end.

/// A picture ready for display: sRGB-encoded RGB and alpha in 0..=1, top row first.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// `width`·`height` pixels, colour not premultiplied.
    pub pixels: Vec<[f32; 4]>,
}
