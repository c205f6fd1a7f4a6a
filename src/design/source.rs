//! The picture a design was posterised from.
//!
//! It is kept with the design, so that the number of colours can be changed later, and
//! bounded, so that no document grows without end.

/// The most pixels of a picture that are kept: 16 megapixels, more than any panel's
/// crossings resolve.
pub const MAX_SOURCE_PIXELS: u64 = 1 << 24;

/// A picture that cannot be kept.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum SourceError {
    /// No pixels, or too many.
    #[error(
        "a picture of {width} × {height} pixels cannot be kept: give at least one and at most \
         {MAX_SOURCE_PIXELS} of them"
    )]
    Size {
        /// Pixels across.
        width: u32,
        /// Pixels down.
        height: u32,
    },
    /// Pixels that are not as many as the size says.
    #[error("a picture of {width} × {height} has {pixels} pixels: give width times height")]
    Pixels {
        /// Pixels across.
        width: u32,
        /// Pixels down.
        height: u32,
        /// Pixels given.
        pixels: usize,
    },
}

/// An opaque 8-bit sRGB picture, top row first.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SourceImage {
    width: u32,
    height: u32,
    pixels: Vec<[u8; 3]>,
}

impl SourceImage {
    /// A picture from its pixels, row by row from the top.
    ///
    /// # Errors
    /// [`SourceError`] for a size that is empty, too large, or not that of the pixels.
    pub fn new(width: u32, height: u32, pixels: Vec<[u8; 3]>) -> Result<Self, SourceError> {
        Self::check_size(width, height)?;
        let wanted = u64::from(width) * u64::from(height);
        if pixels.len() as u64 != wanted {
            let pixels = pixels.len();
            return Err(SourceError::Pixels {
                width,
                height,
                pixels,
            });
        }
        Ok(Self {
            width,
            height,
            pixels,
        })
    }

    /// Refuses sizes that are empty or too large, before memory is asked for.
    ///
    /// # Errors
    /// [`SourceError::Size`].
    pub fn check_size(width: u32, height: u32) -> Result<(), SourceError> {
        match u64::from(width) * u64::from(height) {
            1..=MAX_SOURCE_PIXELS => Ok(()),
            _ => Err(SourceError::Size { width, height }),
        }
    }

    /// Pixels across.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Pixels down.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// The pixels, row by row from the top.
    pub fn pixels(&self) -> &[[u8; 3]] {
        &self.pixels
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_checked() {
        assert!(SourceImage::new(2, 1, vec![[0; 3]; 2]).is_ok());
        for (width, height, pixels) in [(0, 1, 0), (2, 2, 3), (1 << 20, 1 << 20, 1)] {
            assert!(SourceImage::new(width, height, vec![[0; 3]; pixels]).is_err());
        }
        assert!(SourceImage::check_size(u32::MAX, u32::MAX).is_err());
        assert!(SourceImage::check_size(4096, 4096).is_ok());
    }
}
