//! One pixel a crossing: the picture at the panel's size and true shape.
//!
//! Light is averaged, not its sRGB code: a fine black-and-white check becomes the grey
//! that it looks like from afar. Where several pixels fall on a crossing all of them count
//! by their area (a triangle filter as wide as needed); where crossings are finer, colours
//! between pixels are interpolated.

use fast_image_resize::images::{Image, ImageRef};
use fast_image_resize::{FilterType, PixelType, ResizeAlg, ResizeOptions, Resizer};

use super::PosteriseError;
use super::settings::Fit;
use crate::design::{Sett, SourceImage, Srgb};
use crate::job::Job;

/// The most crossings of a panel that a picture is brought to: twice the largest loom
/// file known.
pub const MAX_PANEL: u64 = 1 << 26;
/// What lies round a picture that does not fill its panel.
const AROUND: [u8; 3] = [255; 3];

/// The panel a picture is brought to.
#[derive(Debug, Clone, PartialEq)]
pub struct Layout {
    /// Ends of the panel.
    pub ends: u32,
    /// Picks of the panel.
    pub picks: u32,
    /// How the picture is brought to its shape.
    pub fit: Fit,
    /// Threads per length, which give the shape.
    pub sett: Sett,
}

/// The part of the picture that is used, in pixels, and the crossings it covers.
struct Placed {
    /// Left, top, width and height in the picture.
    from: [f64; 4],
    /// Left, top, width and height in the panel, in crossings from its upper left.
    to: [u32; 4],
}

impl Layout {
    fn place(&self, width: u32, height: u32) -> Placed {
        let (wide, high) = (f64::from(width), f64::from(height));
        let panel_mm = [
            f64::from(self.ends) * f64::from(self.sett.end_pitch_mm()),
            f64::from(self.picks) * f64::from(self.sett.pick_pitch_mm()),
        ];
        let whole = [0.0, 0.0, wide, high];
        let all = [0, 0, self.ends, self.picks];
        // How much wider the picture is than the panel, as shapes.
        let wider = wide / high / (panel_mm[0] / panel_mm[1]);
        match self.fit {
            Fit::Stretch => Placed {
                from: whole,
                to: all,
            },
            Fit::Crop => {
                let (used, tall) = (wide / wider.max(1.0), high * wider.min(1.0));
                let from = [0.5 * (wide - used), 0.5 * (high - tall), used, tall];
                Placed { from, to: all }
            }
            Fit::Pad => {
                let covered = |threads: u32, share: f64| {
                    ((f64::from(threads) * share).round() as u32).clamp(1, threads)
                };
                let ends = covered(self.ends, wider.min(1.0));
                let picks = covered(self.picks, 1.0 / wider.max(1.0));
                let left = (self.ends - ends) / 2;
                let top = (self.picks - picks) / 2;
                Placed {
                    from: whole,
                    to: [left, top, ends, picks],
                }
            }
        }
    }
}

/// The picture with one pixel a crossing: `ends` × `picks` of 8-bit sRGB, top row (the last
/// pick) first.
///
/// # Errors
/// [`PosteriseError::Resample`] for a picture of an extreme shape, or when cancelled.
pub fn panel(
    source: &SourceImage,
    layout: &Layout,
    job: &Job,
) -> Result<Vec<[u8; 3]>, PosteriseError> {
    let placed = layout.place(source.width(), source.height());
    let failed = |error: &dyn std::fmt::Display| PosteriseError::Resample(error.to_string());
    let decoded = linear_codes();
    let bytes: Vec<u8> = (source.pixels().as_flattened().iter())
        .flat_map(|&code| decoded[usize::from(code)].to_ne_bytes())
        .collect();
    job.check()?;
    let [left, top, ends, picks] = placed.to;
    let (width, height) = (source.width(), source.height());
    // Bytes of a Vec may lie at odd addresses: copied where the library refuses them.
    let aligned = Image::from_vec_u8(width, height, bytes, PixelType::U16x3);
    let from = aligned.map_err(|error| failed(&error))?;
    let from = ImageRef::new(width, height, from.buffer(), PixelType::U16x3)
        .map_err(|error| failed(&error))?;
    let mut to = Image::new(ends, picks, PixelType::U16x3);
    let [x, y, wide, high] = placed.from;
    let options = ResizeOptions::new()
        .resize_alg(ResizeAlg::Convolution(FilterType::Bilinear))
        .use_alpha(false)
        .crop(x, y, wide, high);
    Resizer::new()
        .resize(&from, &mut to, &options)
        .map_err(|error| failed(&error))?;
    job.check()?;
    let encoded = srgb_codes();
    let code = |pair: &[u8]| encoded[usize::from(u16::from_ne_bytes([pair[0], pair[1]]))];
    let row = |bytes: &[u8]| -> Vec<[u8; 3]> {
        (bytes.chunks_exact(6))
            .map(|rgb| [code(&rgb[..2]), code(&rgb[2..4]), code(&rgb[4..])])
            .collect()
    };
    if (ends, picks) == (layout.ends, layout.picks) {
        return Ok(row(to.buffer()));
    }
    let across = layout.ends as usize;
    let mut pixels = vec![AROUND; across * layout.picks as usize];
    for (line, bytes) in to.buffer().chunks_exact(6 * ends as usize).enumerate() {
        let start = (top as usize + line) * across + left as usize;
        pixels[start..start + ends as usize].copy_from_slice(&row(bytes));
    }
    Ok(pixels)
}

/// Linear light in 16 bits for every 8-bit code.
fn linear_codes() -> [u16; 256] {
    std::array::from_fn(|code| {
        let light = Srgb(code as u8, 0, 0).to_linear().x;
        (light * 65535.0).round() as u16
    })
}

/// The 8-bit code of every 16-bit light.
fn srgb_codes() -> Vec<u8> {
    let code = |light: u32| Srgb::from_linear(glam::Vec3::splat(light as f32 / 65535.0)).0;
    (0..=65535).map(code).collect()
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;

    fn layout(ends: u32, picks: u32, fit: Fit) -> Layout {
        Layout {
            ends,
            picks,
            fit,
            sett: Sett::per_cm(20.0, 20.0),
        }
    }

    fn picture(width: u32, height: u32, pixel: impl Fn(u32, u32) -> [u8; 3]) -> SourceImage {
        let pixels = (0..width * height).map(|k| pixel(k % width, k / width));
        SourceImage::new(width, height, pixels.collect()).unwrap()
    }

    #[test]
    fn a_fine_check_becomes_the_grey_of_its_light() {
        let check = picture(64, 64, |x, y| [if (x + y) % 2 == 0 { 255 } else { 0 }; 3]);
        let small = panel(&check, &layout(8, 8, Fit::Stretch), &Job::new()).unwrap();
        // Half the light is code 188; half the code would be 128.
        assert!(
            small
                .iter()
                .all(|&[r, g, b]| r == g && g == b && r.abs_diff(188) <= 1)
        );
    }

    #[test]
    fn every_code_survives_where_nothing_is_resampled() {
        let all = picture(16, 16, |x, y| {
            [(x + 16 * y) as u8, (255 - x) as u8, y as u8]
        });
        let same = panel(&all, &layout(16, 16, Fit::Crop), &Job::new()).unwrap();
        assert_eq!(same, all.pixels());
    }

    /// Columns of `pixels` whose middle is red.
    fn red_columns(pixels: &[[u8; 3]], ends: usize) -> usize {
        let middle = pixels.len() / ends / 2;
        let row = &pixels[middle * ends..(middle + 1) * ends];
        row.iter().filter(|pixel| pixel[1] < 128).count()
    }

    #[test]
    fn a_circle_is_as_wide_as_high_on_the_cloth() {
        // A disk of half the picture's side, on cloth with 40 picks for 24 ends.
        let disk = picture(200, 200, |x, y| {
            let (x, y) = (x as f32 - 99.5, y as f32 - 99.5);
            if x.hypot(y) < 50.0 {
                [200, 0, 0]
            } else {
                [255; 3]
            }
        });
        let cloth = Layout {
            sett: Sett::per_cm(24.0, 40.0),
            ..layout(120, 400, Fit::Pad)
        };
        let pixels = panel(&disk, &cloth, &Job::new()).unwrap();
        let wide = red_columns(&pixels, 120);
        let column: Vec<_> = pixels.iter().skip(60).step_by(120).copied().collect();
        let high = column.iter().filter(|pixel| pixel[1] < 128).count();
        let (wide_mm, high_mm) = (wide as f32 / 24.0, high as f32 / 40.0);
        assert!((wide_mm / high_mm - 1.0).abs() < 0.05, "{wide} × {high}");
        assert!((wide as f32 - 60.0).abs() <= 2.0, "{wide}");
        // White above and below, none of it at the sides.
        assert_eq!(pixels[60], [255; 3]);
    }

    #[test]
    fn cropping_keeps_the_middle_and_stretching_keeps_all() {
        let thirds = picture(90, 30, |x, _| match x / 30 {
            1 => [200, 0, 0],
            _ => [0, 200, 255],
        });
        let cropped = panel(&thirds, &layout(30, 30, Fit::Crop), &Job::new()).unwrap();
        assert!(cropped.iter().all(|pixel| pixel[1] < 128));
        let stretched = panel(&thirds, &layout(30, 30, Fit::Stretch), &Job::new()).unwrap();
        assert_eq!(red_columns(&stretched, 30), 10);
    }

    #[test]
    fn shapes_beyond_reason_give_a_picture_or_a_line() {
        for (width, height) in [(1, 1), (1, 5000), (5000, 1)] {
            let thin = picture(width, height, |x, y| [(x ^ y) as u8; 3]);
            for fit in [Fit::Crop, Fit::Pad, Fit::Stretch] {
                match panel(&thin, &layout(7, 3, fit), &Job::new()) {
                    Ok(pixels) => assert_eq!(pixels.len(), 21),
                    Err(error) => assert_eq!(error.to_string().lines().count(), 1),
                }
            }
        }
    }
}
