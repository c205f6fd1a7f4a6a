//! How long a picture takes after its last pass: denoising, encoding, writing.

use std::time::{Duration, Instant};

use glam::Vec3;

use super::StillRequest;
use super::developing::Developing;
use crate::film::{Film, Sample, Tone};
use crate::formats::{exr, png};
use crate::job::Job;
use crate::random::Random;

/// Pixels that are measured.
const MEASURED: u32 = 1 << 16;
/// What is kept beyond what was measured, for the disk and what else runs.
const MARGIN: f64 = 1.25;
/// The least that is kept, s: texts, hashes and the disk.
const LEAST: f64 = 0.05;

/// A job that ends in time for the picture to be denoised, encoded and written within the
/// seconds of the request, or of the job.
pub(super) fn bounded(request: &StillRequest, job: &Job) -> Job {
    let job = request.stop.bounds(job);
    let Some(deadline) = job.deadline() else {
        return job;
    };
    let kept = time(request, tone(request));
    job.with_deadline(deadline.checked_sub(kept).unwrap_or(deadline))
}

/// Seconds that a request's picture takes once it is traced, at most.
pub fn finishing_seconds(request: &StillRequest) -> f64 {
    time(request, tone(request)).as_secs_f64()
}

fn tone(request: &StillRequest) -> Tone {
    Tone {
        exposure: request.exposure_ev,
    }
}

/// The time that a request's picture takes once it is traced: measured on a strip of noise,
/// which is the most that any picture asks of the denoiser and of the encoders.
fn time(request: &StillRequest, tone: Tone) -> Duration {
    let (width, height) = (request.width.max(1), request.height.max(1));
    let rows = (MEASURED / width).clamp(1, height);
    let strip = noise(width, rows);
    let begun = Instant::now();
    let showing = request.settings.showing;
    let developing = Developing {
        tone,
        denoise: showing.denoise,
    };
    let picture = developing.picture(&strip);
    // What cannot be encoded takes no time; writing it says why.
    let _ = png::encode(&picture, showing.png_depth, &png::Metadata::default());
    let shown = begun.elapsed();
    let begun = Instant::now();
    let _ = exr::encode(&strip, 1.0, &[]);
    let longer = shown.max(begun.elapsed()).as_secs_f64();
    let strips = f64::from(height) / f64::from(rows);
    Duration::from_secs_f64(LEAST + MARGIN * longer * strips)
}

/// A film on which nothing is like anything else.
fn noise(width: u32, height: u32) -> Film {
    let mut film = Film::new(width, height);
    for (number, pixel) in film.pixels_mut().iter_mut().enumerate() {
        for index in 0..4 {
            let mut random = Random::new(0, number as u64, u64::from(index));
            let [a, b] = random.pair();
            let sample = Sample {
                radiance: Vec3::new(a, b, a * b),
                alpha: 1.0,
                first: None,
            };
            pixel.add(index, &sample);
        }
    }
    film
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn more_is_kept_for_larger_pictures() {
        let tone = Tone { exposure: 0.0 };
        let kept = |width, height| {
            let request = StillRequest {
                width,
                height,
                ..StillRequest::default()
            };
            time(&request, tone)
        };
        assert!(kept(1, 1) >= Duration::from_secs_f64(LEAST));
        // A thousand times as many pixels: whatever the machine does meanwhile.
        assert!(kept(1024, 16_384) > 4 * kept(128, 128));
    }
}
