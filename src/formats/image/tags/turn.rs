//! How stored pixels are turned and mirrored to be seen (TIFF 6.0 field 274, which EXIF
//! took over).

use super::super::{Pixels, Raster, RasterError};
use image::metadata::Orientation;

/// One of the eight ways to lay an image down.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::formats::image) struct Turn(Orientation);

impl Default for Turn {
    fn default() -> Self {
        Self(Orientation::NoTransforms)
    }
}

impl Turn {
    /// Of the tag's value, 1 to 8.
    pub fn of_tag(value: u64) -> Option<Self> {
        let value = u8::try_from(value).ok()?;
        Orientation::from_exif(value).map(Self)
    }

    /// Whether rows become columns.
    pub fn sideways(self) -> bool {
        self.0.to_exif() >= 5
    }

    /// The image as it is to be seen.
    pub fn apply(self, raster: Raster) -> Result<Raster, RasterError> {
        if self == Self::default() {
            return Ok(raster);
        }
        let (width, height) = (raster.width() as usize, raster.height() as usize);
        let (right, bottom) = (width - 1, height - 1);
        // The stored column and row of a pixel that is seen.
        let place = |x: usize, y: usize| match self.0 {
            Orientation::NoTransforms => (x, y),
            Orientation::FlipHorizontal => (right - x, y),
            Orientation::Rotate180 => (right - x, bottom - y),
            Orientation::FlipVertical => (x, bottom - y),
            Orientation::Rotate90FlipH => (y, x),
            Orientation::Rotate90 => (y, bottom - x),
            Orientation::Rotate270FlipH => (right - y, bottom - x),
            Orientation::Rotate270 => (right - y, x),
        };
        let (across, down) = match self.sideways() {
            true => (height, width),
            false => (width, height),
        };
        let pixels = match raster.pixels() {
            Pixels::Bits(bits) => {
                let (from, to) = (width.div_ceil(8), across.div_ceil(8));
                let mut turned = vec![0; to * down];
                for (y, row) in turned.chunks_exact_mut(to).enumerate() {
                    for x in 0..across {
                        let (column, line) = place(x, y);
                        let bit = bits[line * from + column / 8] >> (7 - column % 8) & 1;
                        row[x / 8] |= bit << (7 - x % 8);
                    }
                }
                Pixels::Bits(turned)
            }
            Pixels::Indices(all) => Pixels::Indices(turned(all, width, across, down, place)),
            Pixels::Colours(all) => Pixels::Colours(turned(all, width, across, down, place)),
        };
        let per_cm = raster.per_cm.map(|(x, y)| match self.sideways() {
            true => (y, x),
            false => (x, y),
        });
        let palette = raster.palette().to_vec();
        let mut seen = Raster::new(across as u32, down as u32, pixels, palette)?;
        seen.per_cm = per_cm;
        Ok(seen)
    }
}

fn turned<T: Copy>(
    stored: &[T],
    width: usize,
    across: usize,
    down: usize,
    place: impl Fn(usize, usize) -> (usize, usize),
) -> Vec<T> {
    let mut seen = Vec::with_capacity(stored.len());
    for y in 0..down {
        seen.extend((0..across).map(|x| {
            let (column, line) = place(x, y);
            stored[line * width + column]
        }));
    }
    seen
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;
    use crate::design::Srgb;

    /// Where the stored first row and first column are seen (TIFF 6.0, Orientation).
    #[test]
    fn all_eight_orientations_are_those_of_the_specification() {
        // Stored: 0 1 2 / 3 4 5.
        let seen: [(u64, &[u8], u32); 8] = [
            (1, &[0, 1, 2, 3, 4, 5], 3),
            (2, &[2, 1, 0, 5, 4, 3], 3),
            (3, &[5, 4, 3, 2, 1, 0], 3),
            (4, &[3, 4, 5, 0, 1, 2], 3),
            (5, &[0, 3, 1, 4, 2, 5], 2),
            (6, &[3, 0, 4, 1, 5, 2], 2),
            (7, &[5, 2, 4, 1, 3, 0], 2),
            (8, &[2, 5, 1, 4, 0, 3], 2),
        ];
        let palette: Vec<Srgb> = (0..6).map(|k| Srgb(k, k, k)).collect();
        for (tag, indices, width) in seen {
            let stored = Pixels::Indices((0..6).collect());
            let mut stored = Raster::new(3, 2, stored, palette.clone()).unwrap();
            stored.per_cm = Some((10.0, 20.0));
            let turned = Turn::of_tag(tag).unwrap().apply(stored).unwrap();
            assert_eq!(turned.pixels(), &Pixels::Indices(indices.to_vec()), "{tag}");
            assert_eq!(turned.width(), width);
            let swapped = turned.per_cm == Some((20.0, 10.0));
            assert_eq!(swapped, tag >= 5);
            // The same of bits and of colours.
            let bits = Pixels::Bits(vec![0b0110_0000, 0b1000_0000]);
            let bits = Raster::new(3, 2, bits, palette[..2].to_vec()).unwrap();
            let colours = (0..6)
                .map(|k| [bits.index(k % 3, k / 3).unwrap(); 3])
                .collect();
            let colours = Raster::new(3, 2, Pixels::Colours(colours), Vec::new()).unwrap();
            let turn = Turn::of_tag(tag).unwrap();
            let (bits, colours) = (turn.apply(bits).unwrap(), turn.apply(colours).unwrap());
            for (x, y) in (0..6).map(|k| (k % width, k / width)) {
                assert_eq!(bits.colour(x, y), colours.colour(x, y), "{tag} {x} {y}");
            }
        }
        for wrong in [0, 9, 300, u64::MAX] {
            assert_eq!(Turn::of_tag(wrong), None);
        }
    }
}
