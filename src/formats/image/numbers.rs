//! Colours become numbers: of regions or of yarns.

use super::raster::{Colours, MAX_COLOURS, Raster, luma};
use super::{Fault, ImageReading, Key};
use crate::design::Srgb;

/// The colours of an image as numbers: regions or yarns.
pub(super) struct Numbers {
    /// Colour of each number.
    pub(super) colours: Vec<Srgb>,
    /// Number of each palette index, or of each colour in order of colour.
    of_index: Vec<u8>,
    of_colour: Vec<(Srgb, u8)>,
}

impl Numbers {
    pub(super) fn of(raster: &Raster, colours: &Colours, key: Key) -> Result<Self, Fault> {
        if key == Key::Index {
            let Some(counts) = raster.index_counts() else {
                let problem = "expected places in a palette, found true colours";
                let remedy = "tell its parts apart by their colour, or save it indexed";
                return Err(Fault::new(problem, remedy));
            };
            let used = counts
                .iter()
                .rposition(|&count| count > 0)
                .map_or(1, |last| last + 1);
            let used = used.min(MAX_COLOURS);
            return Ok(Self {
                colours: raster.palette()[..used].to_vec(),
                of_index: (0..used).map(|number| number as u8).collect(),
                of_colour: Vec::new(),
            });
        }
        let Colours::Few(few) = colours else {
            let problem = format!("expected at most {MAX_COLOURS} flat colours, found more");
            return Err(Fault {
                problem,
                remedy: "posterise it, or save it indexed",
            });
        };
        let mut sorted: Vec<Srgb> = few.iter().map(|entry| entry.0).collect();
        sorted.sort_by(|a, b| luma(*a).total_cmp(&luma(*b)).then(a.cmp(b)));
        let mut of_colour: Vec<(Srgb, u8)> = sorted
            .iter()
            .enumerate()
            .map(|(number, &colour)| (colour, number as u8))
            .collect();
        of_colour.sort_unstable();
        let number = |colour: &Srgb| match of_colour.binary_search_by_key(colour, |known| known.0) {
            Ok(at) => of_colour[at].1,
            Err(_) => 0,
        };
        let of_index = raster.palette().iter().map(number).collect();
        Ok(Self {
            colours: sorted,
            of_index,
            of_colour,
        })
    }

    /// Asks for the number at crossings (end, pick).
    pub(super) fn reader<'r>(
        &'r self,
        raster: &'r Raster,
        reading: ImageReading,
    ) -> impl FnMut(u32, u32) -> u16 + 'r {
        let (width, height) = (raster.width(), raster.height());
        let turned = reading.corner.turned();
        let flipped = turned != reading.mirror;
        let mut last = None;
        move |end, pick| {
            let x = if flipped { width - 1 - end } else { end };
            let y = if turned { pick } else { height - 1 - pick };
            if let Some(index) = raster.index(x, y) {
                return u16::from(self.of_index[usize::from(index)]);
            }
            let colour = raster.colour(x, y);
            match last {
                Some((known, number)) if known == colour => number,
                _ => {
                    let found = self
                        .of_colour
                        .binary_search_by_key(&colour, |known| known.0);
                    let number = found.map_or(0, |at| u16::from(self.of_colour[at].1));
                    last = Some((colour, number));
                    number
                }
            }
        }
    }
}
