//! From many colours to a few, in Oklab, where distances look alike.
//!
//! The palette is Wu's, refined by k-means on a sample of the panel with a fixed seed; then
//! every crossing takes its nearest colour, or is dithered by Floyd and Steinberg.

use quantette::color_map::{IndexedColorMap, NearestNeighborColorMap};
use quantette::color_space::{oklab_to_srgb8, srgb8_to_oklab};
use quantette::deps::palette;
use quantette::dither::FloydSteinberg;
use quantette::kmeans::KmeansOptions;
use quantette::{ImageRef, PaletteSize, Pipeline};
use rayon::prelude::*;

use super::PosteriseError;
use crate::design::{Srgb, lab};
use crate::job::Job;

/// Pixels that the palette is made of, at most: more change it by less than one sees.
const SAMPLE: usize = 1 << 17;
/// Pixels that one task maps.
const CHUNK: usize = 1 << 14;

/// A picture of few colours, top row first.
pub(super) struct Reduced {
    /// The colours, darkest first; at most 256.
    pub palette: Vec<Srgb>,
    /// The colour of every pixel.
    pub indices: Vec<u8>,
}

/// Reduces `pixels` in rows of `width` to at most `colours` of them.
pub(super) fn quantise(
    pixels: &[[u8; 3]],
    width: u32,
    colours: u16,
    dither: bool,
    job: &Job,
) -> Result<Reduced, PosteriseError> {
    let pixels: &[palette::Srgb<u8>] = palette::cast::from_array_slice(pixels);
    // An odd step meets all columns in turn.
    let step = pixels.len().div_ceil(SAMPLE) | 1;
    let sample: Vec<_> = pixels.iter().copied().step_by(step).collect();
    let too_large = |_| PosteriseError::TooLarge {
        ends: width,
        picks: (pixels.len() / width.max(1) as usize) as u32,
    };
    let centres = Pipeline::new()
        .palette_size(PaletteSize::from_u16_clamped(colours))
        .quantize_method(KmeansOptions::new().sampling_factor(1.0).seed(0))
        .dedup(false)
        .input_slice(&sample)
        .map_err(too_large)?
        .output_oklab_palette();
    job.check()?;
    let nearest = NearestNeighborColorMap::new(centres);
    let indices: Vec<u8> = if dither {
        let colours = srgb8_to_oklab(pixels);
        let height = pixels.len() as u32 / width.max(1);
        let image = ImageRef::new(width, height, colours.as_slice()).map_err(|_| {
            PosteriseError::TooLarge {
                ends: width,
                picks: height,
            }
        })?;
        FloydSteinberg::new()
            .dither_image_to_indexed(image, &nearest)
            .into_parts()
            .1
    } else {
        let mapped = |chunk: &[palette::Srgb<u8>]| -> Vec<u8> {
            let colours = srgb8_to_oklab(chunk);
            colours.iter().map(|c| nearest.palette_index(c)).collect()
        };
        pixels.par_chunks(CHUNK).flat_map_iter(mapped).collect()
    };
    let palette = oklab_to_srgb8(nearest.palette().as_slice());
    let palette = palette.iter().map(|c| Srgb(c.red, c.green, c.blue));
    let mut reduced = Reduced {
        palette: palette.collect(),
        indices,
    };
    reduced.sort();
    Ok(reduced)
}

impl Reduced {
    /// Puts the darkest colour first, and equal colours together.
    fn sort(&mut self) {
        let lightness = |colour: &Srgb| lab(colour.to_linear())[0];
        let mut sorted = self.palette.clone();
        sorted.sort_by(|a, b| lightness(a).total_cmp(&lightness(b)).then(a.cmp(b)));
        sorted.dedup();
        let place: Vec<u8> = (self.palette.iter())
            .map(|colour| sorted.iter().position(|other| other == colour).unwrap_or(0) as u8)
            .collect();
        self.indices
            .iter_mut()
            .for_each(|index| *index = place[usize::from(*index)]);
        self.palette = sorted;
    }

    fn counts(&self) -> Vec<u64> {
        let mut counts = vec![0; self.palette.len()];
        for &index in &self.indices {
            counts[usize::from(index)] += 1;
        }
        counts
    }

    /// The share of every colour, 0..=1.
    pub fn coverage(&self) -> Vec<f64> {
        let all = self.indices.len().max(1) as f64;
        self.counts().iter().map(|&n| n as f64 / all).collect()
    }

    /// Leaves out colours that no crossing has.
    pub fn drop_unused(&mut self) {
        let counts = self.counts();
        let mut next = 0;
        let place: Vec<u8> = (counts.iter())
            .map(|&count| {
                let here = next;
                next += u8::from(count > 0 && next < u8::MAX);
                here
            })
            .collect();
        let mut count = counts.iter();
        self.palette
            .retain(|_| count.next().is_some_and(|&n| n > 0));
        self.indices
            .iter_mut()
            .for_each(|index| *index = place[usize::from(*index)]);
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;

    const FLAGS: [[u8; 3]; 4] = [[10, 10, 30], [180, 20, 20], [40, 160, 60], [250, 250, 240]];

    fn flags() -> Vec<[u8; 3]> {
        (0..4000).map(|k| FLAGS[(k / 7 + k / 300) % 4]).collect()
    }

    #[test]
    fn a_picture_of_few_colours_keeps_them() {
        let found = quantise(&flags(), 100, 4, false, &Job::new()).unwrap();
        assert_eq!(found.palette.len(), 4);
        for (&index, pixel) in found.indices.iter().zip(flags()) {
            let Srgb(r, g, b) = found.palette[usize::from(index)];
            let off = [r, g, b].into_iter().zip(pixel).map(|(a, b)| a.abs_diff(b));
            assert!(off.max().unwrap() <= 1, "{r} {g} {b} for {pixel:?}");
        }
        // More than there are does not invent any, and the darkest comes first.
        let more = quantise(&flags(), 100, 24, false, &Job::new()).unwrap();
        assert!(more.palette.len() <= 5, "{:?}", more.palette);
        assert!(more.palette[0].1 < 40 && more.palette.last().unwrap().1 > 200);
        // Fewer join some.
        let fewer = quantise(&flags(), 100, 2, false, &Job::new()).unwrap();
        assert_eq!(fewer.palette.len(), 2);
    }

    #[test]
    fn dithering_mixes_what_the_palette_lacks_and_is_off_otherwise() {
        let ramp: Vec<[u8; 3]> = (0..10_000)
            .map(|k| [(k % 100 * 255 / 99) as u8; 3])
            .collect();
        let changes = |dither| {
            let found = quantise(&ramp, 100, 2, dither, &Job::new()).unwrap();
            found.indices[..100]
                .windows(2)
                .filter(|w| w[0] != w[1])
                .count()
        };
        assert_eq!(changes(false), 1);
        assert!(changes(true) > 10);
    }

    #[test]
    fn threads_do_not_matter() {
        let noise: Vec<[u8; 3]> = (0..60_000u32)
            .map(|k| k.wrapping_mul(2_654_435_761).to_be_bytes())
            .map(|[r, g, b, _]| [r, g, b])
            .collect();
        let with = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            let found = pool
                .unwrap()
                .install(|| quantise(&noise, 200, 9, false, &Job::new()));
            let found = found.unwrap();
            (found.palette, found.indices)
        };
        assert!(with(1) == with(5));
    }

    #[test]
    fn unused_colours_go_and_the_others_keep_their_pixels() {
        let mut reduced = Reduced {
            palette: vec![Srgb(0, 0, 0), Srgb(1, 1, 1), Srgb(2, 2, 2)],
            indices: vec![0, 2, 2, 0],
        };
        reduced.drop_unused();
        assert_eq!(reduced.palette, [Srgb(0, 0, 0), Srgb(2, 2, 2)]);
        assert_eq!(reduced.indices, [0, 1, 1, 0]);
        assert_eq!(reduced.coverage(), [0.5, 0.5]);
    }
}
