//! The pixels of an image file: indices and their palette, or true colours.

use glam::Vec3;

use crate::design::Srgb;

/// The most colours an indexed image can tell apart.
pub const MAX_COLOURS: usize = 256;

/// How the pixels are held, row by row from the top, each row from the left.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Pixels {
    /// One bit a pixel, rows padded to whole bytes, the highest bit leftmost; the bit is
    /// an index of a palette of two.
    Bits(Vec<u8>),
    /// One palette index a pixel.
    Indices(Vec<u8>),
    /// One colour a pixel.
    Colours(Vec<[u8; 3]>),
}

/// An image as a file holds it: size, pixels, palette and resolution.
///
/// What a pixel *means* is decided by its displayed colour ([`Raster::colour`]); indices
/// are kept for those who ask for them and for writing the image back. Every index is
/// within the palette. Transparent pixels show the white of the paper.
#[derive(Debug, Clone, PartialEq)]
pub struct Raster {
    width: u32,
    height: u32,
    pixels: Pixels,
    palette: Vec<Srgb>,
    /// Pixels per cm across and down, if the file states them.
    pub per_cm: Option<(f32, f32)>,
}

/// Pixels or a palette that are not those of an image of this size.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("{width} × {height} pixels do not fit their buffer or palette: give one a pixel")]
pub struct RasterError {
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
}

/// The distinct displayed colours of an image.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Colours {
    /// At most [`MAX_COLOURS`], each with the number of its pixels, in order of colour.
    Few(Vec<(Srgb, u64)>),
    /// More than [`MAX_COLOURS`].
    Many,
}

impl Raster {
    /// An image from its parts. Indices beyond the palette are refused; the palette of
    /// [`Pixels::Colours`] is empty.
    ///
    /// # Errors
    /// [`RasterError`] if there is not one pixel for each place, or an index is too large.
    pub fn new(
        width: u32,
        height: u32,
        pixels: Pixels,
        palette: Vec<Srgb>,
    ) -> Result<Self, RasterError> {
        let (across, down) = (width as usize, height as usize);
        let fits = across > 0
            && down > 0
            && match &pixels {
                Pixels::Bits(bits) => bits.len() == across.div_ceil(8) * down && palette.len() == 2,
                Pixels::Indices(indices) => {
                    indices.len() == across * down
                        && palette.len() <= MAX_COLOURS
                        && indices
                            .iter()
                            .max()
                            .map(|&most| usize::from(most) < palette.len())
                            == Some(true)
                }
                Pixels::Colours(colours) => colours.len() == across * down && palette.is_empty(),
            };
        if !fits {
            return Err(RasterError { width, height });
        }
        Ok(Self {
            width,
            height,
            pixels,
            palette,
            per_cm: None,
        })
    }

    /// The true colours; none of an image with a palette.
    pub fn into_colours(self) -> Vec<[u8; 3]> {
        match self.pixels {
            Pixels::Colours(colours) => colours,
            _ => Vec::new(),
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

    /// The pixels.
    pub fn pixels(&self) -> &Pixels {
        &self.pixels
    }

    /// The palette of the file, in its order; empty for true colours.
    pub fn palette(&self) -> &[Srgb] {
        &self.palette
    }

    /// The palette index of a pixel, `y` counted from the top; `None` for true colours.
    pub fn index(&self, x: u32, y: u32) -> Option<u8> {
        match &self.pixels {
            Pixels::Bits(bits) => {
                let stride = self.width.div_ceil(8) as usize;
                let byte = bits[y as usize * stride + (x / 8) as usize];
                Some(byte >> (7 - x % 8) & 1)
            }
            Pixels::Indices(indices) => Some(indices[self.place(x, y)]),
            Pixels::Colours(_) => None,
        }
    }

    /// The displayed colour of a pixel, `y` counted from the top.
    pub fn colour(&self, x: u32, y: u32) -> Srgb {
        match (&self.pixels, self.index(x, y)) {
            (Pixels::Colours(colours), _) => {
                let [red, green, blue] = colours[self.place(x, y)];
                Srgb(red, green, blue)
            }
            (_, index) => self.palette[usize::from(index.unwrap_or(0))],
        }
    }

    fn place(&self, x: u32, y: u32) -> usize {
        y as usize * self.width as usize + x as usize
    }

    /// How often each palette index occurs; `None` for true colours.
    pub fn index_counts(&self) -> Option<Vec<u64>> {
        let mut counts = vec![0u64; self.palette.len()];
        match &self.pixels {
            Pixels::Bits(bits) => {
                let stride = self.width.div_ceil(8) as usize;
                let padding = stride * 8 - self.width as usize;
                let mut ones = 0u64;
                for row in bits.chunks(stride) {
                    ones += row
                        .iter()
                        .map(|byte| u64::from(byte.count_ones()))
                        .sum::<u64>();
                    let last = row.last().copied().unwrap_or(0);
                    ones -= u64::from((last & low_bits(padding)).count_ones());
                }
                counts[1] = ones;
                counts[0] = u64::from(self.width) * u64::from(self.height) - ones;
            }
            Pixels::Indices(indices) => {
                for &index in indices {
                    counts[usize::from(index)] += 1;
                }
            }
            Pixels::Colours(_) => return None,
        }
        Some(counts)
    }

    /// The distinct displayed colours.
    pub fn colours(&self) -> Colours {
        let Pixels::Colours(colours) = &self.pixels else {
            let counts = self.index_counts().unwrap_or_default();
            let mut few: Vec<(Srgb, u64)> = Vec::new();
            for (&colour, count) in self.palette.iter().zip(counts) {
                match few.binary_search_by_key(&colour, |entry| entry.0) {
                    _ if count == 0 => {}
                    Ok(at) => few[at].1 += count,
                    Err(at) => few.insert(at, (colour, count)),
                }
            }
            return Colours::Few(few);
        };
        let mut few: Vec<(Srgb, u64)> = Vec::new();
        let mut runs = colours.iter().copied().peekable();
        while let Some(colour) = runs.next() {
            let mut run = 1;
            while runs.next_if_eq(&colour).is_some() {
                run += 1;
            }
            let colour = Srgb(colour[0], colour[1], colour[2]);
            match few.binary_search_by_key(&colour, |entry| entry.0) {
                Ok(at) => few[at].1 += run,
                Err(_) if few.len() == MAX_COLOURS => return Colours::Many,
                Err(at) => few.insert(at, (colour, run)),
            }
        }
        Colours::Few(few)
    }
}

/// A byte whose lowest `count` bits are set.
fn low_bits(count: usize) -> u8 {
    ((1u16 << count.min(8)) - 1) as u8
}

/// Luma of a displayed colour in 0..=255 (ITU-R BT.601 weights on the encoded values, as
/// image programs turn colour into grey before a threshold).
pub fn luma(Srgb(red, green, blue): Srgb) -> f32 {
    0.299 * f32::from(red) + 0.587 * f32::from(green) + 0.114 * f32::from(blue)
}

/// A colour seen over white paper, in linear light; `alpha` in 0..=255.
pub(super) fn over_white(colour: [u8; 3], alpha: u8) -> [u8; 3] {
    match alpha {
        255 => colour,
        0 => [255; 3],
        _ => {
            let [red, green, blue] = colour;
            let own = Srgb(red, green, blue).to_linear();
            let Srgb(red, green, blue) =
                Srgb::from_linear(Vec3::ONE.lerp(own, f32::from(alpha) / 255.0));
            [red, green, blue]
        }
    }
}

/// Appends the indices of a row packed at `depth` bits (1, 2, 4), the highest bits first.
pub(super) fn unpack(row: &[u8], depth: usize, width: usize, indices: &mut Vec<u8>) {
    let per_byte = 8 / depth;
    let mask = low_bits(depth);
    let wanted = indices.len() + width;
    for &byte in row.iter().take(width.div_ceil(per_byte)) {
        for place in 1..=per_byte {
            indices.push(byte >> (8 - depth * place) & mask);
        }
    }
    indices.truncate(wanted);
}

/// Makes a palette as long as its indices need; what a file leaves out is black.
pub(super) fn fill_palette(palette: &mut Vec<Srgb>, pixels: &Pixels, warnings: &mut Vec<String>) {
    let stated = palette.len();
    let needed = match pixels {
        Pixels::Bits(_) => 2,
        Pixels::Indices(indices) => indices
            .iter()
            .max()
            .map_or(0, |&most| usize::from(most) + 1),
        Pixels::Colours(_) => 0,
    };
    if matches!(pixels, Pixels::Indices(_)) && needed > stated {
        warnings.push(format!(
            "the palette has {stated} colours, but pixels name colour {}: those missing are black",
            needed - 1
        ));
    }
    if matches!(pixels, Pixels::Bits(_)) {
        palette.truncate(2);
    }
    palette.resize(palette.len().max(needed), Srgb(0, 0, 0));
    palette.truncate(MAX_COLOURS);
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;

    const INK: Srgb = Srgb(0, 0, 0);
    const PAPER: Srgb = Srgb(255, 255, 255);

    #[test]
    fn bits_are_counted_without_their_padding() {
        let bits = Pixels::Bits(vec![0b1011_1111, 0b1111_1111, 0b0000_0000, 0b0111_1111]);
        let raster = Raster::new(9, 2, bits, vec![PAPER, INK]).unwrap();
        assert_eq!(raster.index_counts().unwrap(), [10, 8]);
        assert_eq!(raster.colour(1, 0), PAPER);
        assert_eq!(raster.colour(8, 0), INK);
        assert_eq!(raster.colour(8, 1), PAPER);
        assert_eq!(raster.colours(), Colours::Few(vec![(INK, 8), (PAPER, 10)]));
    }

    #[test]
    fn the_same_colour_twice_in_a_palette_is_one_colour() {
        let raster = Raster::new(3, 1, Pixels::Indices(vec![0, 1, 2]), vec![INK, PAPER, INK]);
        let Colours::Few(few) = raster.unwrap().colours() else {
            panic!("few")
        };
        assert_eq!(few, [(INK, 2), (PAPER, 1)]);
    }

    #[test]
    fn parts_that_do_not_fit_are_refused() {
        let palette = vec![INK, PAPER];
        assert!(Raster::new(2, 2, Pixels::Indices(vec![0; 3]), palette.clone()).is_err());
        assert!(Raster::new(2, 1, Pixels::Indices(vec![0, 2]), palette.clone()).is_err());
        assert!(Raster::new(9, 1, Pixels::Bits(vec![0]), palette).is_err());
        assert!(Raster::new(0, 0, Pixels::Colours(Vec::new()), Vec::new()).is_err());
    }

    #[test]
    fn more_than_256_colours_are_many() {
        let ramp = |count: u32| {
            let colours = (0..count).map(|k| [k as u8, (k / 256) as u8, 0]).collect();
            Raster::new(count, 1, Pixels::Colours(colours), Vec::new()).unwrap()
        };
        assert!(matches!(ramp(256).colours(), Colours::Few(few) if few.len() == 256));
        assert_eq!(ramp(257).colours(), Colours::Many);
    }
}
