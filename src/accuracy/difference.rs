//! How far pictures are from each other: plain functions over pixels.
//!
//! All of them take *several* pictures of each kind, made with other paths, and only ever
//! multiply one's difference with another's: what is left has no share of the noise in it,
//! however few paths there were (the mean of (a − r₁)(a − r₂) is the squared error of a against
//! the truth, while that of (a − r)² is larger by the variance of r). Intervals come from blocks
//! of the picture, which are nearly independent of each other.

use glam::Vec3;

use super::estimate::Estimate;

/// Least edge of a block, pixels.
pub const BLOCK: usize = 8;
/// What is added to the mean square that errors are relative to: one hundredth of a white
/// diffuser, squared.
const DARK: f64 = 1e-4;

/// Pixels of one picture: premultiplied linear RGB, row by row.
pub type Pixels = Vec<Vec3>;

/// How a picture is cut into blocks.
#[derive(Debug, Clone, Copy)]
pub struct Frame {
    /// Pixels across.
    pub width: usize,
    /// Edge of a block, pixels: wide enough that what is wrong in one says little of the next.
    pub block: usize,
}

/// Means over blocks, of a value of each pixel.
fn blocks(frame: Frame, count: usize, of: impl Fn(usize) -> f64) -> Vec<f64> {
    let (width, edge) = (frame.width.max(1), frame.block.max(1));
    let across = width.div_ceil(edge);
    let rows = count / width;
    let mut sums = vec![(0.0, 0u32); across * rows.div_ceil(edge).max(1)];
    for pixel in 0..count {
        let (x, y) = (pixel % width, pixel / width);
        let (sum, number) = &mut sums[(y / edge) * across + x / edge];
        *sum += of(pixel);
        *number += 1;
    }
    let seen = sums.iter().filter(|(_, number)| *number > 0);
    seen.map(|(sum, number)| sum / f64::from(*number)).collect()
}

/// The mean over channels of the product of two colours.
fn product(one: Vec3, other: Vec3) -> f64 {
    f64::from(one.dot(other)) / 3.0
}

/// Mean of the products of all pairs of different ones: the square of what they have in common.
fn common(values: &[Vec3]) -> f64 {
    let count = values.len() as f64;
    let sum: Vec3 = values.iter().sum();
    let own: f64 = values.iter().map(|one| product(*one, *one)).sum();
    (product(sum, sum) - own) / (count * (count - 1.0))
}

/// The mean square that errors are relative to.
///
/// `pictures` of the same scene with other paths, at least two.
pub fn power(pictures: &[Pixels]) -> f64 {
    let count = pictures.first().map_or(0, Vec::len);
    let at = |pixel: usize| -> Vec<Vec3> { pictures.iter().map(|one| one[pixel]).collect() };
    let sum: f64 = (0..count).map(|pixel| common(&at(pixel))).sum();
    (sum / count.max(1) as f64).max(0.0) + DARK
}

/// Relative root mean square of what is wrong with `pictures` whatever the number of paths,
/// against those of the same place of `reference`, which were made with the same random
/// numbers each: what paths have in common cancels.
pub fn bias(pictures: &[Pixels], reference: &[Pixels], frame: Frame) -> Estimate {
    let count = pictures.first().map_or(0, Vec::len);
    let squares = blocks(frame, count, |pixel| {
        let differences: Vec<Vec3> = (pictures.iter().zip(reference))
            .map(|(one, other)| one[pixel] - other[pixel])
            .collect();
        common(&differences)
    });
    let power = power(reference);
    Estimate::mean(&squares).scaled(1.0 / power).root()
}

/// Root mean square of the noise of one of `pictures`, which differ in their paths alone,
/// relative to pictures of this [`power`].
pub fn noise(pictures: &[Pixels], power: f64, frame: Frame) -> Estimate {
    let count = pictures.first().map_or(0, Vec::len);
    let taken = pictures.len() as f64;
    let squares = blocks(frame, count, |pixel| {
        let sum: Vec3 = pictures.iter().map(|one| one[pixel]).sum();
        let mean = sum / taken as f32;
        let spread: f64 = (pictures.iter())
            .map(|one| product(one[pixel] - mean, one[pixel] - mean))
            .sum();
        spread / (taken - 1.0)
    });
    Estimate::mean(&squares).scaled(1.0 / power).root()
}

/// Relative root mean square of all that is wrong with `pictures`, noise and the rest, against
/// what `reference` converges to: other paths than those of `pictures`, at least two of them.
pub fn total(pictures: &[Pixels], reference: &[Pixels], frame: Frame) -> Estimate {
    let count = pictures.first().map_or(0, Vec::len);
    let squares = blocks(frame, count, |pixel| {
        let sums: f64 = (pictures.iter())
            .map(|one| {
                let differences: Vec<Vec3> = (reference.iter())
                    .map(|other| one[pixel] - other[pixel])
                    .collect();
                common(&differences)
            })
            .sum();
        sums / pictures.len() as f64
    });
    let power = power(reference);
    Estimate::mean(&squares).scaled(1.0 / power).root()
}

/// The mean of some pictures.
pub fn mean(pictures: &[Pixels]) -> Pixels {
    let count = pictures.first().map_or(0, Vec::len);
    let scale = 1.0 / pictures.len().max(1) as f32;
    (0..count)
        .map(|pixel| pictures.iter().map(|one| one[pixel]).sum::<Vec3>() * scale)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    const WIDTH: usize = 48;
    const COUNT: usize = WIDTH * 40;
    const FRAME: Frame = Frame {
        width: WIDTH,
        block: BLOCK,
    };

    /// Relative to itself.
    fn own_noise(pictures: &[Pixels]) -> Estimate {
        noise(pictures, power(pictures), FRAME)
    }

    /// A ramp of brightness with `wrong` added and noise of standard deviation `sigma`.
    fn picture(seed: u64, wrong: f32, sigma: f32) -> Pixels {
        (0..COUNT)
            .map(|pixel| {
                let mut random = Random::new(seed, pixel as u64, 0);
                let level = 0.2 + 0.6 * (pixel % WIDTH) as f32 / WIDTH as f32;
                let noise = |random: &mut Random| {
                    let sum: f32 = (0..6).map(|_| random.pair()[0] + random.pair()[1]).sum();
                    (sum - 6.0) * sigma
                };
                let [r, g, b] = [0; 3].map(|_: i32| level + wrong + noise(&mut random));
                Vec3::new(r, g, b)
            })
            .collect()
    }

    fn pictures(seeds: std::ops::Range<u64>, wrong: f32, sigma: f32) -> Vec<Pixels> {
        seeds.map(|seed| picture(seed, wrong, sigma)).collect()
    }

    /// √mean(level² ) of the ramp, and the dark term.
    fn scale() -> f64 {
        let levels = (0..WIDTH).map(|x| 0.2 + 0.6 * x as f64 / WIDTH as f64);
        let mean = levels.map(|level| level * level).sum::<f64>() / WIDTH as f64;
        (mean + DARK).sqrt()
    }

    #[test]
    fn errors_are_told_apart_from_noise() {
        let truth = pictures(100..106, 0.0, 0.3);
        let shifted = pictures(100..106, 0.05, 0.3);
        // Same random numbers: the shift alone is left, exactly.
        let paired = bias(&shifted, &truth, FRAME);
        assert!((paired.value - 0.05 / scale()).abs() < 0.002, "{paired:?}");
        // Others: noise is thirty times the squared shift, and it is still found.
        let unpaired = bias(&pictures(200..206, 0.05, 0.3), &truth, FRAME);
        assert!(
            unpaired.low < 0.05 / scale() && unpaired.high > 0.05 / scale(),
            "{unpaired:?}"
        );
        // The control: pictures without a shift have none, though they differ as much.
        let same = bias(&pictures(200..206, 0.0, 0.3), &truth, FRAME);
        assert!(same.low == 0.0 && same.value < 0.03, "{same:?}");
        let plain: f64 = (truth[0].iter().zip(&shifted[1]))
            .map(|(one, other)| product(*one - *other, *one - *other))
            .sum::<f64>()
            / COUNT as f64;
        assert!(plain.sqrt() / scale() > 0.5, "the plain one is all noise");
    }

    #[test]
    fn noise_is_what_it_is_and_all_of_it_is_the_hypotenuse() {
        let truth = pictures(0..8, 0.0, 0.1);
        let found = own_noise(&truth);
        assert!(
            (found.value * scale() / 0.1 - 1.0).abs() < 0.03,
            "{found:?}"
        );
        assert!(found.low < found.value && found.high > found.value);
        let all = total(&pictures(20..24, 0.1, 0.1), &truth, FRAME);
        let wanted = 0.1f64.hypot(0.1) / scale();
        assert!((all.value / wanted - 1.0).abs() < 0.03, "{all:?}");
        // A shift changes nothing of the noise.
        let shifted = own_noise(&pictures(0..8, 0.2, 0.1));
        let (one, other) = (shifted.value * power(&pictures(0..8, 0.2, 0.1)).sqrt(), 0.1);
        assert!((one / other - 1.0).abs() < 0.03, "{one}");
    }

    #[test]
    fn means_have_less_noise_and_odd_sizes_are_fine() {
        let four = pictures(0..4, 0.0, 0.2);
        let mean = mean(&four);
        let of = |picture: &Pixels| {
            let truth = picture_of_truth();
            (picture.iter().zip(&truth))
                .map(|(one, other)| product(*one - *other, *one - *other))
                .sum::<f64>()
        };
        assert!((of(&four[0]) / of(&mean) - 4.0).abs() < 0.5);
        let frame = |width: usize, block: usize| Frame { width, block };
        assert_eq!(blocks(frame(5, 8), 15, |_| 2.0), [2.0]);
        assert_eq!(blocks(frame(9, 8), 81, |pixel| pixel as f64).len(), 4);
        assert_eq!(blocks(frame(9, 3), 81, |_| 1.0), [1.0; 9]);
        assert!(blocks(frame(0, 0), 0, |_| 1.0).is_empty());
    }

    fn picture_of_truth() -> Pixels {
        picture(0, 0.0, 0.0)
    }
}
