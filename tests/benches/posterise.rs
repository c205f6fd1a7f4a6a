//! Times of posterising, printed and never asserted: `cargo bench --bench posterise`.

use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use pickglass::design::SourceImage;
use pickglass::formats::photo;
use pickglass::job::Job;
use pickglass::posterise::{PosteriseSettings, posterise};

/// Noise with some structure, where the photograph is not there.
fn drawn() -> SourceImage {
    let pixel = |k: u32| {
        let (x, y) = (k % 512, k / 512);
        let noise = k.wrapping_mul(2_654_435_761) >> 27;
        [
            (x / 2 + noise) as u8,
            (y / 2 + noise) as u8,
            ((x ^ y) / 2) as u8,
        ]
    };
    SourceImage::new(512, 512, (0..512 * 512).map(pixel).collect()).expect("a size")
}

fn main() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/images/astronaut.png");
    println!("{} threads", rayon::current_num_threads());
    for (colours, ends, picks) in [
        (6, 960, 1600),
        (24, 960, 1600),
        (256, 960, 1600),
        (12, 5120, 6300),
    ] {
        let begun = Instant::now();
        let source = photo::load(&path).map_or_else(
            |error| {
                println!("a drawn picture: {error}");
                drawn()
            },
            |photo| photo.source,
        );
        let decoded = begun.elapsed().as_secs_f64();
        let settings = PosteriseSettings {
            colours,
            ends: Some(ends),
            picks: Some(picks),
            ends_per_cm: 60.0 / 2.54,
            picks_per_cm: 100.0 / 2.54,
            ..PosteriseSettings::default()
        };
        let made = posterise(&Arc::new(source), &settings, None, &Job::new());
        let total = begun.elapsed().as_secs_f64();
        match made {
            Ok(made) => println!(
                "{ends} × {picks}, {colours} colours ({} used): decoded in {decoded:.3} s, design after {total:.3} s",
                made.colours.len()
            ),
            Err(error) => println!("{ends} × {picks}: {error}"),
        }
    }
}
