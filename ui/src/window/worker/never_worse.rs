//! The first minute, with a number of paths in the place of a clock: no picture that is
//! shown is worse than one that was shown before for the same request.

use std::sync::{Arc, Condvar, Mutex};
use std::time::Instant;

use glam::Vec3;
use pickglass::cloth::PreparedCloth;
use pickglass::design::{delta_e_00, lab};
use pickglass::engine::{SightTables, StillRequest, Stop, prepare_woven};
use pickglass::exemplar::ExemplarStore;
use pickglass::job::Job;

use super::drawing::{Drawing, OnScreen};
use super::{
    Aim, COARSE_SAMPLES, Fibres, Mailbox, Picture, PreviewRequest, Quality, Shared, coarsest_film,
};
use preview_views::{PreviewView, SIZE, reference, squares, visits};

#[path = "../../../../tests/common/preview_views/mod.rs"]
mod preview_views;

/// What a picture may be worse than the least so far.
const TIMES: f64 = 1.1;
const MORE: f64 = 0.3;

/// Mean difference to a reference.
fn off(shown: &[Vec3], reference: &[Vec3]) -> f64 {
    assert_eq!(shown.len(), reference.len());
    let sum: f64 = shown
        .iter()
        .zip(reference)
        .map(|(&a, &b)| delta_e_00(lab(a), lab(b)))
        .sum();
    sum / shown.len() as f64
}

fn squares_of(picture: &Picture) -> Vec<Vec3> {
    let pixels: Vec<[f32; 4]> = (picture.image.pixels.iter())
        .map(|pixel| {
            pixel
                .to_srgba_unmultiplied()
                .map(|byte| f32::from(byte) / 255.0)
        })
        .collect();
    squares(picture.image.size[0], &pixels)
}

/// A mailbox that keeps every picture that is put on it.
fn mailbox() -> (Arc<Mailbox>, Arc<Mutex<Vec<Picture>>>) {
    let seen: Arc<Mutex<Vec<Picture>>> = Arc::default();
    let mailbox = Arc::new_cyclic(|mailbox: &std::sync::Weak<Mailbox>| {
        let (mailbox, seen) = (mailbox.clone(), Arc::clone(&seen));
        Mailbox {
            shared: Mutex::new(Shared::default()),
            changed: Condvar::new(),
            wake: Box::new(move || {
                if let Some(picture) = mailbox
                    .upgrade()
                    .and_then(|mailbox| mailbox.lock().picture.take())
                {
                    seen.lock().expect("seen").push(picture);
                }
            }),
            store: ExemplarStore::user(),
        }
    });
    (mailbox, seen)
}

fn request_of(view: &PreviewView, generation: u64) -> PreviewRequest {
    let mut still = view.still.clone();
    still.settings.render.pass_spp = 1;
    PreviewRequest {
        generation,
        aim: Aim::Pane,
        design: Arc::clone(&view.design),
        drawdown: Arc::clone(&view.drawdown),
        still,
        quality: Quality::Good,
        blank: false,
    }
}

/// Designs that are also looked at from elsewhere and edited.
const FOLLOWED: usize = 1;

/// Samples a pixel of the film in full size; coarser ones go before it as in the program.
const SAMPLES: u32 = 5;

/// What is shown of a view, and what was shown before: whatever was traced replaced what
/// stood there, from a quarter of a path a pixel on.
struct Watched {
    shown: Vec<f64>,
    replaced: Vec<f64>,
}

/// How far each pass of a film is off, enlarged to the size of the picture.
fn films(
    cloth: &PreparedCloth,
    still: &StillRequest,
    (level, spp): (u32, u32),
    reference: &[Vec3],
) -> Vec<f64> {
    let mut still = still.clone();
    (still.width, still.height) = (still.width >> level, still.height >> level);
    still.stop.spp = Some(spp);
    let mut films = Vec::new();
    pickglass::engine::render(cloth, &still, &Job::new(), &mut |pass| {
        let rgba = pass.rgba();
        let pixel = |at: usize| {
            let (x, y) = (
                (at % SIZE[0] as usize) >> level,
                (at / SIZE[0] as usize) >> level,
            );
            let from = (y * pass.film.width() as usize + x) * 4;
            [0, 1, 2, 3].map(|channel| f32::from(rgba[from + channel]) / 255.0)
        };
        let pixels: Vec<[f32; 4]> = (0..(SIZE[0] * SIZE[1]) as usize).map(pixel).collect();
        films.push(off(&squares(SIZE[0] as usize, &pixels), reference));
    })
    .expect("a picture");
    films
}

fn watch(
    view: &PreviewView,
    tables: &Arc<SightTables>,
    screen: &mut Option<OnScreen>,
) -> Option<Watched> {
    let reference = reference(&view.name)?;
    let (mailbox, seen) = mailbox();
    let request = request_of(view, 1);
    let job = Job::new();
    let drawing = Drawing {
        mailbox: &mailbox,
        request: &request,
        job: &job,
        begun: Instant::now(),
        patience: 0,
    };
    drawing.first_sight(tables, screen).expect("first sight");
    let still = &request.still;
    let cloth = prepare_woven(&view.design, &view.drawdown, still, &mailbox.store, &job);
    let cloth = cloth.expect("a cloth");
    let coarse = (1..=coarsest_film(&request)).rev();
    let steps = coarse.map(|level| (level, COARSE_SAMPLES));
    for (level, spp) in steps.chain([(0, SAMPLES)]) {
        let stop = Stop {
            spp: Some(spp),
            ..Stop::default()
        };
        drawing
            .trace(&cloth, Fibres::Full, level, stop, screen)
            .expect("traced");
    }
    let mut replaced = films(&cloth, still, (1, 1), &reference);
    replaced.extend(films(&cloth, still, (0, 2), &reference));
    let seen = seen.lock().expect("seen");
    let shown: Vec<f64> = (seen.iter())
        .map(|picture| off(&squares_of(picture), &reference))
        .collect();
    replaced.insert(0, shown[0]);
    Some(Watched { shown, replaced })
}

/// Where a row of pictures gets worse: its place, and the least before.
fn worse(shown: &[f64]) -> Option<(usize, f64, f64)> {
    let mut least = f64::INFINITY;
    for (at, &off) in shown.iter().enumerate() {
        if off > TIMES * least + MORE {
            return Some((at, off, least));
        }
        least = least.min(off);
    }
    None
}

#[test]
fn no_picture_that_is_shown_is_worse_than_one_before() {
    // Behind the other tests, some of which wait for threads of this niceness.
    super::threads::behind(watch_all);
}

fn watch_all() {
    let soak = std::env::var_os("PICKGLASS_SOAK").is_some();
    let (mut watched, mut control) = (0, 0);
    let mut faults = Vec::new();
    for (number, visit) in visits().into_iter().enumerate() {
        let tables: Arc<SightTables> = Arc::default();
        let mut screen = None;
        let views = [&visit.open, &visit.zoom, &visit.edit];
        // The rest takes long.
        let looked_at = if soak || number < FOLLOWED { 3 } else { 1 };
        for view in views.into_iter().take(looked_at) {
            let Some(row) = watch(view, &tables, &mut screen) else {
                continue;
            };
            watched += 1;
            let text =
                |row: &[f64]| -> String { row.iter().map(|off| format!("{off:.1} ")).collect() };
            println!(
                "{:24} {}| replaced: {}",
                view.name,
                text(&row.shown),
                text(&row.replaced)
            );
            if let Some((at, off, least)) = worse(&row.shown) {
                faults.push(format!(
                    "{}: picture {at} is {off:.2} off, after {least:.2}",
                    view.name
                ));
            }
            control += usize::from(worse(&row.replaced).is_some());
        }
    }
    assert!(
        watched >= 6,
        "{watched} references: cargo bench --bench preview_references"
    );
    assert!(faults.is_empty(), "{faults:#?}");
    assert!(
        control > 0,
        "the control: what is traced may replace first sight at once, and is never worse"
    );
}

/// With a clock, as a person sees it: prints how far off what is shown was at each second.
/// Only where `PICKGLASS_SOAK` says for how many seconds a view is watched.
#[test]
fn the_first_minute_by_the_clock() {
    let seconds = std::env::var("PICKGLASS_SOAK")
        .ok()
        .and_then(|text| text.parse::<u64>().ok());
    let Some(seconds) = seconds else { return };
    for visit in visits() {
        let worker = super::ClothWorker::start(ExemplarStore::user(), || {}).expect("a thread");
        for (generation, view) in [&visit.open, &visit.zoom, &visit.edit]
            .into_iter()
            .enumerate()
        {
            let Some(reference) = reference(&view.name) else {
                continue;
            };
            let request = request_of(view, generation as u64);
            worker.request(request);
            let begun = Instant::now();
            let (mut row, mut line) = (Vec::new(), String::new());
            let mut next = 0.0;
            while begun.elapsed().as_secs() < seconds {
                std::thread::sleep(std::time::Duration::from_millis(5));
                let picture = worker.take_picture();
                let Some(picture) = picture.filter(|p| p.generation == generation as u64) else {
                    continue;
                };
                row.push(off(&squares_of(&picture), &reference));
                let now = begun.elapsed().as_secs_f64();
                if now >= next {
                    line += &format!(" {now:.1}s {:.1}", row[row.len() - 1]);
                    next = 1.5 * now + 0.1;
                }
            }
            let fault = worse(&row).map_or_else(String::new, |(at, off, least)| {
                format!(" | WORSE: picture {at} is {off:.2} off, after {least:.2}")
            });
            println!("{:24}{line}{fault}", view.name);
        }
    }
}
