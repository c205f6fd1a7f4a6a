//! Requests while threads stall as a hostile system lets them: whatever it was interrupted in,
//! the worker ends with a picture of what was asked for last.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use pickglass::design::{Design, Family, Srgb, Structure, WeavePattern, Yarn, YarnId, YarnMaps};
use pickglass::edit::{Cells, Document, Edit};
use pickglass::engine::StillRequest;
use pickglass::exemplar::ExemplarStore;
use pickglass::plan::{EffectBase, EffectChoice, Settings};
use pickglass::random::Random;

use super::{Aim, ClothWorker, Phase, Picture, PreviewRequest, Quality};

const BLUE: Srgb = Srgb(20, 40, 220);
const RED: Srgb = Srgb(220, 30, 20);

/// A twill of one colour.
fn twill(colour: Srgb) -> Document {
    let pattern = WeavePattern::from_fn(8, 8, |end, pick| (end + 8 - pick) % 4 < 2);
    let yarns = vec![Yarn::new("yarn", Family::Cotton, colour)];
    let maps = YarnMaps::plain(YarnId(0), YarnId(0));
    let sett = pickglass::design::usual_sett(&yarns, &maps);
    let structure = Structure::Pattern(pattern);
    Document::new(Design::new("twill", structure, yarns, maps, sett).expect("a twill"))
}

fn request(document: &Document, random: &mut Random, generation: u64) -> PreviewRequest {
    let [x, y] = random.pair();
    let still = StillRequest {
        width: 48,
        height: 32,
        width_mm: Some(3.0 + 3.0 * x),
        centre_mm: Some([9.0 * x, 9.0 * y]),
        settings: Settings::default().at_level(4),
        effects: EffectChoice {
            base: EffectBase::None,
            ..EffectChoice::default()
        },
        ..StillRequest::default()
    };
    PreviewRequest {
        generation,
        aim: Aim::Pane,
        design: Arc::clone(document.design()),
        drawdown: Arc::clone(document.drawdown()),
        still,
        quality: Quality::Draft,
        blank: false,
    }
}

/// Sleeps up to so many milliseconds.
fn stall(random: &mut Random, most: u64) {
    std::thread::sleep(Duration::from_millis(random.bits() % (most + 1)));
}

/// Whether a picture is more red than blue.
fn is_red(picture: &Picture) -> bool {
    let sum = |channel: usize| -> u64 {
        let pixels = picture.image.pixels.iter();
        pixels
            .map(|pixel| u64::from(pixel.to_array()[channel]))
            .sum()
    };
    sum(0) > sum(2)
}

/// Asks for so many pictures of a cloth that is edited, and last for a red one.
fn round(seed: u64, requests: u64) {
    let mut random = Random::new(seed, 0, 0);
    let wakes = std::sync::Mutex::new(Random::new(seed, 1, 0));
    // Whoever is told may be slow to listen.
    let wake = move || stall(&mut wakes.lock().expect("a number"), 3);
    let worker = ClothWorker::start(ExemplarStore::user(), wake).expect("a thread");
    let mut document = twill(BLUE);
    let mut newest = 0;
    let mut looked_at = |worker: &ClothWorker, asked: u64| -> Option<Picture> {
        let picture = worker.take_picture()?;
        assert!(picture.generation >= newest && picture.generation <= asked);
        newest = picture.generation;
        Some(picture)
    };
    for generation in 1..=requests {
        let place = [random.bits(), random.bits()].map(|bits| (bits % 8) as u32);
        let cells = Cells::of(8, 8, [(place[0], place[1])]);
        document.apply(Edit::Flip(cells)).expect("an edit");
        worker.request(request(&document, &mut random, generation));
        stall(&mut random, 25);
        match random.bits() % 8 {
            0 => worker.stop(),
            1 => worker.set_hidden(true),
            2 => worker.set_hidden(false),
            _ => {
                if let Some(picture) = looked_at(&worker, generation) {
                    assert!(!is_red(&picture));
                }
            }
        }
    }
    let last = requests + 1;
    worker.set_hidden(false);
    worker.request(request(&twill(RED), &mut random, last));
    let begun = Instant::now();
    let mut shown = None;
    loop {
        // It may be that of the request before, as long as there is no traced picture.
        let done = matches!(worker.phase(), Phase::Done(_));
        if let Some(picture) = looked_at(&worker, last) {
            shown = Some(picture);
        }
        let latest = shown
            .as_ref()
            .is_some_and(|picture| picture.generation == last && picture.spp > 0);
        if done && latest {
            break;
        }
        let phase = worker.phase();
        assert!(!matches!(phase, Phase::Failed(_)), "{phase:?}");
        assert!(begun.elapsed().as_secs() < 120, "waited in vain: {phase:?}");
        std::thread::sleep(Duration::from_millis(1));
    }
    let shown = shown.expect("a picture");
    assert!(is_red(&shown), "an older cloth is shown, round {seed}");
}

#[test]
fn the_last_picture_is_of_the_last_request() {
    let long = std::env::var_os("PICKGLASS_LONG").is_some();
    let (rounds, requests) = if long { (200, 60) } else { (6, 30) };
    let over = AtomicBool::new(false);
    std::thread::scope(|scope| {
        // More threads than processors, each of which works and sleeps as it likes.
        for thread in 0..2 * std::thread::available_parallelism().map_or(2, usize::from) {
            let over = &over;
            scope.spawn(move || {
                let mut random = Random::new(9, thread as u64, 0);
                while !over.load(Ordering::Relaxed) {
                    let until = Instant::now() + Duration::from_micros(random.bits() % 5000);
                    while Instant::now() < until {
                        std::hint::spin_loop();
                    }
                    stall(&mut random, 3);
                }
            });
        }
        // However it ends, the others do.
        struct Ended<'o>(&'o AtomicBool);
        impl Drop for Ended<'_> {
            fn drop(&mut self) {
                self.0.store(true, Ordering::Relaxed);
            }
        }
        let _ended = Ended(&over);
        for seed in 0..rounds {
            round(seed, requests);
        }
    });
}
