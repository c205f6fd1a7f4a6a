//! The references that the preview's first minute is judged by.
//!
//! `cargo bench --bench preview_references` renders those that are missing in
//! `tests/pictures/preview` (`-- NAME` for those whose names hold it, `-- --anew` all of
//! them, `-- --error=0.04` faster and less exact): the middle of each until squares of 4 × 4 pixels are known to 2 %, about a minute
//! of two cores. The random numbers are not those of a preview: the frame is four pixels wider,
//! and cut.

#[path = "../common/preview_views/mod.rs"]
mod preview_views;

use pickglass::engine::{self, Stop};
use pickglass::exemplar::ExemplarStore;
use pickglass::film::tone::encode_srgb;
use pickglass::formats::png;
use pickglass::job::Job;
use preview_views::{CROP, PreviewView, SIZE, SQUARE, reference_file, squares, visits};

/// Error of the squares' means, unless another is asked for.
const ERROR: f64 = 0.02;
/// Pixels more across.
const WIDER: u32 = 4;

fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let anew = words.iter().any(|word| word == "--anew");
    let given = words.iter().find_map(|word| word.strip_prefix("--error="));
    let error = given.map_or(ERROR, |error| error.parse().expect("a share"));
    let names: Vec<&String> = words
        .iter()
        .filter(|word| !word.starts_with("--"))
        .collect();
    let store = ExemplarStore::user();
    for visit in visits() {
        for view in [visit.open, visit.zoom, visit.edit] {
            let file = reference_file(&view.name);
            let asked = names.is_empty() || names.iter().any(|name| view.name.contains(*name));
            if asked && (anew || !file.exists()) {
                make(&view, error, &store);
            }
        }
    }
}

fn make(view: &PreviewView, error: f64, store: &ExemplarStore) {
    let mut request = view.still.clone();
    let wider = (CROP[0] + WIDER) as f32 / SIZE[0] as f32;
    [request.width, request.height] = [CROP[0] + WIDER, CROP[1]];
    request.width_mm = request.width_mm.map(|mm| mm * wider);
    request.settings.showing.denoise = false;
    request.stop = Stop {
        // Squares of sixteen pixels are four times better than these.
        error: Some(error * SQUARE as f64),
        spp: Some(1 << 14),
        seconds: None,
    };
    let job = Job::new();
    let cloth = engine::prepare_woven(&view.design, &view.drawdown, &request, store, &job);
    let still = engine::render(&cloth.expect("a cloth"), &request, &job, &mut |_| {});
    let still = still.expect("a picture");
    let picture = still.picture();
    let (wide, cut) = (picture.width as usize, WIDER as usize / 2);
    let pixels: Vec<[f32; 4]> = (picture.pixels.chunks(wide))
        .flat_map(|row| &row[cut..wide - cut])
        .copied()
        .collect();
    let means = squares(CROP[0] as usize, &pixels);
    let reference = pickglass::film::Picture {
        width: CROP[0] / SQUARE as u32,
        height: CROP[1] / SQUARE as u32,
        pixels: (means.into_iter())
            .map(|light| {
                let [r, g, b] = light.to_array().map(encode_srgb);
                [r, g, b, 1.0]
            })
            .collect(),
    };
    let error = still.report.error.unwrap_or(f64::NAN);
    let texts = vec![(
        "Comment".to_owned(),
        format!(
            "means of 4 x 4 pixels, {} samples a pixel, error of a mean {:.1} %",
            still.report.spp,
            100.0 * error / SQUARE as f64
        ),
    )];
    let metadata = png::Metadata {
        pixels_per_mm: None,
        texts,
    };
    let file = reference_file(&view.name);
    png::write(&file, &reference, png::Depth::Sixteen, &metadata).expect("written");
    println!(
        "{}: {} samples, {:.0} s",
        view.name, still.report.spp, still.report.total_seconds
    );
}
