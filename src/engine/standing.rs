//! What stands on the screen, and what a traced picture adds to it: never worse.
//!
//! Comes in: the picture that stands there (first sight, or what was traced before) and a
//! film so far. Goes out: the picture to show next. Their difference is taken apart by
//! octaves of size. In each octave and neighbourhood the difference holds what the standing
//! picture has wrong and the film's noise; how large the noise is, the film's even and odd
//! samples tell. A part `1 − noise / difference` of it is believed (Wiener 1949; with the
//! noise measured, James and Stein 1961), which is the share that leaves the least expected
//! error, and none where all of it may be noise. So colours of large places, which are known
//! after few paths, come true first, and fibres fade in as the film gets to know them.
//!
//! The denoiser is asked about the finest octaves alone, and a film of a fraction of the
//! size, whose pixels are large places themselves, is one without the finest octaves.

use glam::{Vec3, Vec4};

use super::planes::Plane;
use crate::film::Film;
use crate::film::tone::{curve, decode_srgb, encode_srgb, uncurve};
use crate::scene::luminance;

/// Variance that the denoiser leaves of the noise, in octaves from the pixel up. Of larger
/// places it is not believed: with the noise it takes what is there.
const LEFT_BY_DENOISER: [f32; 2] = [0.25, 0.4];
/// Noise counts for more than was measured of it, so that chance passes for a difference
/// less often.
const DOUBT: f32 = 1.6;
/// Pixels of an octave to each side within which differences are compared.
const NEIGHBOURHOOD: usize = 8;
/// An octave with no more pixels than this along a side is the last.
const SMALLEST: usize = 4;
/// Light below which differences count absolutely, 1 = a white diffuser.
const DARK: f32 = 0.02;

/// A picture in linear light times alpha, before the tone curve.
#[derive(Clone)]
pub struct Standing {
    light: Plane<Vec4>,
}

impl Standing {
    /// Of sRGB with straight alpha, top row first; `None` where the sizes do not agree.
    pub fn of_rgba(width: u32, height: u32, rgba: &[u8]) -> Option<Self> {
        let linear: Vec<f32> = (0..=255u8)
            // White is all that is brighter as well: taken as the step that it begins with, so
            // that no channel runs away from the others.
            .map(|value| uncurve(decode_srgb(f32::from(value).min(254.5) / 255.0)))
            .collect();
        let pixels = rgba.chunks_exact(4).map(|pixel| {
            let alpha = f32::from(pixel[3]) / 255.0;
            let [r, g, b] = [0, 1, 2].map(|channel| linear[usize::from(pixel[channel])]);
            (Vec3::new(r, g, b) * alpha).extend(alpha)
        });
        let light = Plane::new(width as usize, height as usize, pixels.collect())?;
        Some(Self { light })
    }

    /// What a film shows, with nothing else known.
    #[cfg(test)]
    fn of_film(film: &Film) -> Self {
        let pixels = film.pixels().iter();
        let pixels = pixels
            .map(|pixel| pixel.mean().extend(pixel.alpha()))
            .collect();
        let light = Plane {
            width: film.width() as usize,
            height: film.height() as usize,
            pixels,
        };
        Self { light }
    }

    /// Pixels across and down.
    pub fn size(&self) -> [u32; 2] {
        [self.light.width as u32, self.light.height as u32]
    }

    /// sRGB with straight alpha, top row first.
    pub fn rgba(&self) -> Vec<u8> {
        let steps: Vec<u8> = (0..=ENCODED)
            .map(|step| {
                let root = step as f32 / ENCODED as f32;
                super::exposure::byte(encode_srgb(root * root))
            })
            .collect();
        let mut rgba = Vec::with_capacity(self.light.pixels.len() * 4);
        for light in &self.light.pixels {
            let alpha = light.w.clamp(0.0, 1.0);
            let colour = light.truncate() / alpha.max(1e-3);
            rgba.extend(colour.to_array().map(|value| {
                let step = curve(value).sqrt() * ENCODED as f32;
                steps[(step.round() as usize).min(ENCODED)]
            }));
            rgba.push(super::exposure::byte(alpha));
        }
        rgba
    }

    /// The picture to show, now that `film` knows so much; `clean` are its radiances
    /// denoised, `exposure` is in stops. The film's sides are the picture's, or these halved
    /// some times. `None` where the film has other sides or fewer than two samples a pixel.
    pub fn improved(&self, film: &Film, clean: Option<&[Vec3]>, exposure: f32) -> Option<Self> {
        let level = self.level_of(film)?;
        let scale = Some(exposure.exp2()).filter(|scale| scale.is_finite())?;
        let noise: Option<Vec<f32>> = (film.pixels().iter())
            .map(|pixel| pixel.noise().map(|noise| noise * scale))
            .collect();
        let sides = (film.width() as usize, film.height() as usize);
        let noise = Plane::new(sides.0, sides.1, noise?)?;
        let of = |radiance: &[Vec3]| {
            let pixels = film.pixels().iter().zip(radiance);
            let pixels = pixels.map(|(pixel, &light)| (light * scale).extend(pixel.alpha()));
            Plane::new(sides.0, sides.1, pixels.collect())
        };
        let traced = of(&film.means())?;
        let mut stands = self.light.clone();
        let mut larger = Vec::new();
        for _ in 0..level {
            larger.push((stands.width, stands.height));
            stands = stands.halved();
        }
        let (width, height) = (stands.width, stands.height);
        let traced = traced.resized(width, height);
        let noise = Noise::new(&noise.resized(width, height), &stands, &traced);
        let best = match clean.filter(|_| level == 0) {
            Some(clean) => {
                let clean = of(clean)?.resized(width, height);
                let octaves = LEFT_BY_DENOISER.len() as u32;
                clean.plus(&large_places(&traced.minus(&clean), octaves))
            }
            None => traced,
        };
        let left: &[f32] = if clean.is_some() && level == 0 {
            &LEFT_BY_DENOISER
        } else {
            &[]
        };
        let mut gained = wiener(&best.minus(&stands), &noise, left);
        for (width, height) in larger.into_iter().rev() {
            gained = gained.doubled(width, height);
        }
        let mut light = self.light.plus(&gained);
        for light in &mut light.pixels {
            *light = light.max(Vec4::ZERO);
            light.w = light.w.min(1.0);
        }
        Some(Self { light })
    }

    /// The same with large places as in `other`, whose pixels are `coarser` times as large as
    /// these: what is smaller than its pixels stays. Both show the same; where `other` has no
    /// alpha it says nothing.
    pub fn coloured_as(&self, other: &Self, coarser: f32) -> Self {
        let own = &self.light;
        let mut there = other.light.clone().resized(own.width, own.height);
        for (there, here) in there.pixels.iter_mut().zip(&own.pixels) {
            if there.w <= 0.0 {
                *there = *here;
            }
        }
        let steps = coarser.max(1.0).log2().ceil() as u32;
        let (own_large, large) = (large_places(own, steps), large_places(&there, steps));
        let mut light = own.clone();
        let places = own_large.pixels.iter().zip(&large.pixels);
        for (light, (own, other)) in light.pixels.iter_mut().zip(places) {
            // What gets darker is scaled, so that nothing falls below black.
            let scaled = *light * (*other + DARK) / (*own + DARK);
            let darker = other.cmple(*own);
            *light = Vec4::select(darker, scaled, *light + (*other - *own)).max(Vec4::ZERO);
            light.w = light.w.min(1.0);
        }
        Self { light }
    }

    /// What another view of the same shows of it: pixels that are `scale` times as large as
    /// these, of which the first has its corner at (`left`, `top`), in pixels of this one.
    /// What lies outside has no alpha.
    pub fn seen_from(&self, [width, height]: [u32; 2], [left, top]: [f32; 2], scale: f32) -> Self {
        let light = self
            .light
            .cut([width as usize, height as usize], [left, top], scale);
        Self { light }
    }

    /// This picture, and `under` where this one has no alpha.
    pub fn over(&self, under: &Self) -> Self {
        let mut light = under.light.clone();
        for (below, above) in light.pixels.iter_mut().zip(&self.light.pixels) {
            if above.w > 0.0 {
                *below = *above;
            }
        }
        Self { light }
    }

    /// How often the sides must be halved to be the film's.
    fn level_of(&self, film: &Film) -> Option<u32> {
        let side = |side: usize, level: u32| ((side as u32) >> level).max(1);
        (0..16).find(|&level| {
            side(self.light.width, level) == film.width()
                && side(self.light.height, level) == film.height()
        })
    }
}

/// Steps of the root of light that are encoded at once.
const ENCODED: usize = 1 << 12;

/// What is left of a picture that is halved so often, at its own size.
fn large_places(light: &Plane<Vec4>, steps: u32) -> Plane<Vec4> {
    if steps == 0 || light.width.min(light.height) <= 1 {
        return light.clone();
    }
    large_places(&light.halved(), steps - 1).doubled(light.width, light.height)
}

/// The noise of a film as the eye sees it, and what it is measured in.
struct Noise {
    /// Drawn at random as the film's own noise is, linear light.
    of: Plane<Vec4>,
    /// What a difference counts for, by the light around it.
    weight: Plane<f32>,
}

impl Noise {
    /// Of noise in luminance: colours waver as they are.
    fn new(noise: &Plane<f32>, stands: &Plane<Vec4>, traced: &Plane<Vec4>) -> Self {
        let around = stands.plus(traced).scaled(0.5).blurred(NEIGHBOURHOOD);
        let weight = (around.pixels.iter())
            .map(|light| {
                // Equal steps to the eye: lightness goes as the cube root.
                (luminance(light.truncate()).max(0.0) + DARK).powf(-2.0 / 3.0)
            })
            .collect();
        let of = (noise.pixels.iter().zip(&around.pixels))
            .map(|(&noise, around)| {
                let colour = around.truncate().max(Vec3::ZERO);
                let white = luminance(colour).max(1e-4);
                (colour / white * noise).extend(0.0)
            })
            .collect();
        let with = |pixels| Plane {
            width: noise.width,
            height: noise.height,
            pixels,
        };
        Self {
            of: with(of),
            weight: Plane {
                width: noise.width,
                height: noise.height,
                pixels: weight,
            },
        }
    }

    fn halved(&self) -> Self {
        Self {
            of: self.of.halved(),
            weight: self.weight.halved(),
        }
    }
}

/// What of a difference is more than noise. `left` says which share of the noise is in it,
/// in octaves from the finest; all of it beyond.
fn wiener(difference: &Plane<Vec4>, noise: &Noise, left: &[f32]) -> Plane<Vec4> {
    let (share, coarser) = match left.split_first() {
        Some((share, coarser)) => (*share, coarser),
        None => (1.0, left),
    };
    let (width, height) = (difference.width, difference.height);
    if width.min(height) <= SMALLEST {
        return believed(difference, &noise.of, &noise.weight, share);
    }
    let (below, noise_below) = (difference.halved(), noise.halved());
    let octave = difference.minus(&below.doubled(width, height));
    let noise_here = noise.of.minus(&noise_below.of.doubled(width, height));
    let here = believed(&octave, &noise_here, &noise.weight, share);
    let below = wiener(&below, &noise_below, coarser);
    here.plus(&below.doubled(width, height))
}

/// An octave's part that is more than noise.
fn believed(
    octave: &Plane<Vec4>,
    noise: &Plane<Vec4>,
    weight: &Plane<f32>,
    share: f32,
) -> Plane<Vec4> {
    let energy = |plane: &Plane<Vec4>| {
        let pixels = plane.pixels.iter().zip(&weight.pixels);
        let pixels = pixels
            .map(|(light, weight)| (light.truncate() * *weight).length_squared())
            .collect();
        Plane {
            width: plane.width,
            height: plane.height,
            pixels,
        }
        .blurred(NEIGHBOURHOOD)
    };
    let (all, noise) = (energy(octave), energy(noise));
    let mut believed = octave.clone();
    let energies = all.pixels.iter().zip(&noise.pixels);
    for (light, (all, noise)) in believed.pixels.iter_mut().zip(energies) {
        let part = 1.0 - DOUBT * share * noise / all.max(1e-12);
        *light = if part > 0.0 {
            *light * part
        } else {
            Vec4::ZERO
        };
    }
    believed
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;
    use crate::film::Sample;
    use crate::random::Random;

    const SIDES: [u32; 2] = [64, 48];

    /// A film of a picture with noise: samples that are now and then bright.
    fn film(width: u32, height: u32, spp: u32, truth: impl Fn(u32, u32) -> Vec3) -> Film {
        let mut film = Film::new(width, height);
        for (at, pixel) in film.pixels_mut().iter_mut().enumerate() {
            let (x, y) = (at as u32 % width, at as u32 / width);
            for index in 0..spp {
                let mut random = Random::new(1, at as u64, u64::from(index));
                let [u, _] = random.pair();
                let bright = if u < 0.25 { 4.0 } else { 0.0 };
                pixel.add(
                    index,
                    &Sample {
                        radiance: truth(x, y) * bright,
                        alpha: 1.0,
                        first: None,
                    },
                );
            }
        }
        film
    }

    fn standing(of: impl Fn(u32, u32) -> Vec3) -> Standing {
        let pixels = (0..SIDES[0] * SIDES[1])
            .map(|at| of(at % SIDES[0], at / SIDES[0]).extend(1.0))
            .collect();
        let light = Plane::new(SIDES[0] as usize, SIDES[1] as usize, pixels).unwrap();
        Standing { light }
    }

    /// Root of the mean squared difference to the truth.
    fn off(standing: &Standing, truth: impl Fn(u32, u32) -> Vec3) -> f32 {
        let pixels = standing.light.pixels.iter().enumerate();
        let sum: f32 = pixels
            .map(|(at, light)| {
                let at = at as u32;
                (light.truncate() - truth(at % SIDES[0], at / SIDES[0])).length_squared()
            })
            .sum();
        (sum / (SIDES[0] * SIDES[1]) as f32).sqrt()
    }

    /// Threads over threads.
    fn cloth(x: u32, y: u32) -> Vec3 {
        let up = (x / 4 + y / 4).is_multiple_of(2);
        if up {
            Vec3::new(0.5, 0.3, 0.2)
        } else {
            Vec3::new(0.1, 0.2, 0.4)
        }
    }

    #[test]
    fn what_is_right_is_kept_however_noisy_the_film() {
        let right = standing(cloth);
        for spp in [2, 4, 16, 64] {
            let film = film(SIDES[0], SIDES[1], spp, cloth);
            let shown = right.improved(&film, None, 0.0).unwrap();
            let alone = Standing::of_film(&film);
            let (shown, alone) = (off(&shown, cloth), off(&alone, cloth));
            // Control: the film alone is much worse.
            assert!(shown < 0.25 * alone, "{spp}: {shown} {alone}");
        }
    }

    #[test]
    fn what_is_wrong_comes_true_large_places_first_and_never_worse() {
        let wrong = standing(|x, y| cloth(x, y) * 1.3 + Vec3::new(0.05, 0.0, 0.0));
        let mut least = off(&wrong, cloth);
        for spp in [2, 8, 32, 128, 512] {
            let film = film(SIDES[0], SIDES[1], spp, cloth);
            let shown = off(&wrong.improved(&film, None, 0.0).unwrap(), cloth);
            let alone = off(&Standing::of_film(&film), cloth);
            assert!(
                shown < 1.05 * least.min(alone),
                "{spp}: {shown} {least} {alone}"
            );
            least = least.min(shown);
        }
        // A quarter of the size tells of colours, and fibres stay.
        let small = film(SIDES[0] / 4, SIDES[1] / 4, 64, |x, y| {
            let places = (0..16).map(|at| cloth(4 * x + at % 4, 4 * y + at / 4));
            places.sum::<Vec3>() / 16.0
        });
        let shown = off(&wrong.improved(&small, None, 0.0).unwrap(), cloth);
        assert!(shown < 0.5 * off(&wrong, cloth), "{shown}");
    }

    #[test]
    fn poison_and_other_sizes_do_no_harm() {
        let right = standing(cloth);
        let one = film(SIDES[0], SIDES[1], 1, cloth);
        assert!(
            right.improved(&one, None, 0.0).is_none(),
            "noise is not known"
        );
        let other = film(SIDES[0] - 1, SIDES[1], 2, cloth);
        assert!(right.improved(&other, None, 0.0).is_none());
        let black = film(SIDES[0], SIDES[1], 4, |_, _| Vec3::ZERO);
        assert!(right.improved(&black, None, 200.0).is_none());
        let shown = right.improved(&black, None, 100.0).unwrap();
        assert!(shown.light.pixels.iter().all(|light| light.is_finite()));
        let huge = film(SIDES[0], SIDES[1], 4, |_, _| Vec3::splat(1e30));
        let shown = right.improved(&huge, None, 0.0).unwrap();
        assert!(shown.light.pixels.iter().all(|light| light.is_finite()));
        assert_eq!(shown.rgba().len(), right.rgba().len());
        assert!(Standing::of_rgba(2, 2, &[0; 12]).is_none());
        assert!(Standing::of_rgba(0, 0, &[]).is_none());
        let tiny = Standing::of_rgba(1, 1, &[255, 128, 0, 255]).unwrap();
        let film = film(1, 1, 4, |_, _| Vec3::ONE);
        assert!(tiny.improved(&film, None, 0.0).is_some());
    }

    #[test]
    fn pictures_come_back_and_other_views_take_what_they_can() {
        let rgba: Vec<u8> = (0..64u8)
            .flat_map(|at| [at * 4, 255 - at, 7, 255])
            .collect();
        let standing = Standing::of_rgba(8, 8, &rgba).unwrap();
        for (shown, given) in standing.rgba().iter().zip(&rgba) {
            assert!(shown.abs_diff(*given) <= 1);
        }
        // Moved by two pixels: what was seen is the same, the rest is as it was below.
        let below = Standing::of_rgba(8, 8, &[9; 256]).unwrap();
        let moved = standing.seen_from([8, 8], [2.0, 0.0], 1.0).over(&below);
        assert_eq!(moved.light.pixels[0], standing.light.pixels[2]);
        assert_eq!(moved.light.pixels[7], below.light.pixels[7]);
        // From nearer, colours of large places alone.
        let brown = Standing::of_rgba(8, 8, &[90, 60, 30, 255].repeat(64)).unwrap();
        let near = brown.seen_from([8, 8], [2.0, 2.0], 0.5);
        let detail = Standing::of_rgba(8, 8, &[[0, 0, 0, 255], [255; 4]].concat().repeat(32));
        let shown = detail.unwrap().coloured_as(&near, 8.0);
        let mean = |standing: &Standing| standing.light.pixels.iter().sum::<Vec4>() / 64.0;
        let rms = (mean(&shown) - mean(&brown)).length();
        assert!(
            shown.light.pixels[0] != shown.light.pixels[1] && rms < 0.35,
            "{rms}"
        );
    }
}
