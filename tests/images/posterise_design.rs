//! Posterised designs: shapes, stability, weavability, documents.

#![allow(clippy::unwrap_used, reason = "a test may fail")]

use std::sync::Arc;

use pickglass::design::{
    Corrections, Design, Fill, Regions, SourceImage, Srgb, Structure, WeavePattern, YarnMap,
    delta_e_00, floats, lab,
};
use pickglass::formats::ron;
use pickglass::job::Job;
use pickglass::posterise::{Fit, PosteriseError, PosteriseSettings, Posterised, posterise};

/// Blocks of eight colours with a ramp of light below them.
fn picture() -> Arc<SourceImage> {
    const COLOURS: [[u8; 3]; 8] = [
        [20, 24, 40],
        [70, 30, 30],
        [40, 90, 60],
        [120, 110, 30],
        [160, 90, 120],
        [130, 170, 200],
        [230, 190, 120],
        [245, 240, 230],
    ];
    let pixels = (0..160u32 * 120).map(|k| {
        let (x, y) = (k % 160, k / 160);
        if y < 90 {
            COLOURS[((x / 20 + y / 30) % 8) as usize]
        } else {
            [(x * 255 / 159) as u8; 3]
        }
    });
    Arc::new(SourceImage::new(160, 120, pixels.collect()).unwrap())
}

fn settings(colours: u16) -> PosteriseSettings {
    PosteriseSettings {
        colours,
        ends: Some(160),
        picks: Some(200),
        ends_per_cm: 24.0,
        picks_per_cm: 40.0,
        ..PosteriseSettings::default()
    }
}

fn made(settings: &PosteriseSettings, previous: Option<&Design>) -> Posterised {
    posterise(&picture(), settings, previous, &Job::new()).unwrap()
}

fn regions(design: &Design) -> &Regions {
    match design.structure() {
        Structure::Regions(regions) => regions,
        _ => panic!("a posterised design has regions"),
    }
}

#[test]
fn weaves_rise_with_the_picture_and_the_loom_can_do_it() {
    for colours in [2, 6, 9, 24, 60] {
        let made = made(&settings(colours), None);
        assert!(made.design.weavable());
        assert!(made.warnings.is_empty(), "{:?}", made.warnings);
        assert_eq!(made.design.yarns().len(), 2);
        let count = made.colours.len();
        assert!(count <= usize::from(colours) && count >= usize::from(colours.min(9)) - 1);
        let share: f64 = made.colours.iter().map(|c| c.coverage).sum();
        assert!((share - 1.0).abs() < 1e-9);
        let light = |colour: Srgb| lab(colour.to_linear())[0];
        for pair in made.colours.windows(2) {
            assert!(light(pair[0].asked) <= light(pair[1].asked));
            assert!(light(pair[0].expected) <= light(pair[1].expected));
        }
        let floats = floats(&made.design.weave());
        let longest = [
            floats.longest.warp_face,
            floats.longest.warp_back,
            floats.longest.weft_face,
            floats.longest.weft_back,
        ];
        assert!(longest.iter().all(|&length| length <= 7), "{longest:?}");
    }
}

#[test]
fn expected_differences_are_those_of_the_colours_named() {
    let made = made(&settings(6), None);
    for colour in &made.colours {
        let named = delta_e_00(
            lab(colour.asked.to_linear()),
            lab(colour.expected.to_linear()),
        );
        assert!((named - colour.delta_e).abs() < 1.0, "{colour:?}");
    }
}

#[test]
fn the_picture_stands_upright() {
    let made = made(&settings(8), None);
    let map = regions(&made.design).map();
    // The ramp is at the bottom: its left is dark and its right light.
    assert_eq!(map.get(0, 0), 0);
    assert_eq!(usize::from(map.get(159, 0)), made.colours.len() - 1);
    // The last pick shows the first row: dark at the left.
    assert_eq!(map.get(0, 199), 0);
}

#[test]
fn assignments_follow_the_nearest_colours_to_another_number() {
    let first = made(&settings(6), None);
    let mut edited = regions(&first.design).clone();
    let own = [(1, "3/3 basket"), (4, "2/2 herringbone 8")];
    for (region, notation) in own {
        assert!(edited.set_fill(region, Fill::by_notation(notation).unwrap()));
        assert!(edited.set_locked(region, true));
    }
    let mask = WeavePattern::from_fn(160, 200, |end, pick| end == 7 && pick < 9);
    let hand = Corrections::new(mask.clone(), mask).unwrap();
    let edited = edited.with_corrections(Some(hand.clone())).unwrap();
    let design = first.design.clone();
    let design = design.with_structure(Structure::Regions(edited)).unwrap();
    for colours in [5, 9, 6] {
        let again = made(&settings(colours), Some(&design));
        let found = regions(&again.design);
        assert_eq!(found.corrections(), Some(&hand), "hand corrections stay");
        assert_eq!(again.design.yarns(), first.design.yarns());
        for (region, notation) in own {
            let before = first.colours[usize::from(region)].asked;
            let kept: Vec<_> = (found.palette().iter())
                .filter(|region| region.fill.notation() == Some(notation))
                .collect();
            assert_eq!(kept.len(), 1, "{notation} at {colours}");
            assert!(kept[0].locked);
            // No other colour is nearer to the one it belonged to, unless the other lock
            // has taken that.
            let off = |colour: Srgb| delta_e_00(lab(colour.to_linear()), lab(before.to_linear()));
            let nearer = (found.palette().iter())
                .filter(|other| !other.locked)
                .filter(|other| off(other.colour.unwrap()) < off(kept[0].colour.unwrap()))
                .count();
            assert_eq!(nearer, 0, "{notation} at {colours}");
        }
        if colours == 6 {
            assert!(
                again.design.structure() == design.structure(),
                "nothing changes"
            );
        }
    }
    // Without the previous design nothing is known of them.
    let fresh = made(&settings(9), None);
    let found = regions(&fresh.design).palette().iter();
    assert!(found.clone().all(|region| !region.locked));
}

#[test]
fn preview_only_regions_have_yarns_of_their_own_colour() {
    let settings = PosteriseSettings {
        preview_only: true,
        ..settings(6)
    };
    let previewed = made(&settings, None);
    assert!(!previewed.design.weavable());
    assert!(matches!(
        previewed.design.maps().warp,
        YarnMap::Crossings(_)
    ));
    let map = regions(&previewed.design).map();
    for (end, pick) in [(3, 5), (80, 100), (150, 190)] {
        let region = &regions(&previewed.design).palette()[usize::from(map.get(end, pick))];
        for yarn in [
            previewed.design.warp_yarn(i64::from(end), i64::from(pick)),
            previewed.design.weft_yarn(i64::from(end), i64::from(pick)),
        ] {
            assert_eq!(Some(previewed.design.yarn(yarn).colour), region.colour);
        }
    }
    // What two yarns cannot mix, many can: the colours are met.
    let mean = |made: &Posterised| {
        made.colours
            .iter()
            .map(|c| c.delta_e * c.coverage)
            .sum::<f64>()
    };
    let woven = made(&self::settings(6), None);
    let (own, mixed) = (mean(&previewed), mean(&woven));
    assert!(own < 6.0 && own < 0.5 * mixed, "{own:.1} and {mixed:.1}");
    // And back: what was previewed becomes weavable in the first two yarns.
    let back = made(&self::settings(6), Some(&previewed.design));
    assert!(back.design.weavable());
    assert_eq!(back.design.yarns(), woven.design.yarns());
}

#[test]
fn a_posterised_design_survives_its_document() {
    for preview_only in [false, true] {
        let settings = PosteriseSettings {
            preview_only,
            ..settings(7)
        };
        let design = made(&settings, None).design;
        let text = ron::write(&design).unwrap();
        let read = ron::read(text.as_bytes(), "x").unwrap();
        assert!(read == design);
        let mut other = design.clone();
        other.name = "other".into();
        assert!(read != other);
        // Another number of colours can be asked for after opening.
        let source = Arc::clone(regions(&read).source().unwrap());
        assert_eq!(source, picture());
        let again = posterise(&source, &self::settings(4), Some(&read), &Job::new()).unwrap();
        assert!(again.colours.len() <= 4);
    }
}

#[test]
fn sizes_that_cut_the_repeat_are_said_with_the_nearest_that_do_not() {
    let odd = PosteriseSettings {
        ends: Some(163),
        picks: Some(7),
        ..settings(6)
    };
    let warnings = made(&odd, None).warnings;
    assert_eq!(warnings.len(), 2, "{warnings:?}");
    assert!(warnings[0].contains("163 ends") && warnings[0].contains("160 or 168"));
    assert!(warnings[1].contains("7 picks") && warnings[1].contains("8 would not"));
}

#[test]
fn long_floats_between_regions_are_bound_on_request() {
    let first = made(&settings(5), None);
    let mut clash = regions(&first.design).clone();
    for (region, notation) in [(0, "9/1 satin"), (2, "1/8 satin"), (4, "8/1 satin")] {
        assert!(clash.set_fill(region, Fill::by_notation(notation).unwrap()));
    }
    let design = first
        .design
        .with_structure(Structure::Regions(clash))
        .unwrap();
    let longest = |made: &Posterised| {
        let found = floats(&made.design.weave()).longest_inside;
        found
            .warp_face
            .max(found.warp_back)
            .max(found.weft_face)
            .max(found.weft_back)
    };
    assert!(longest(&made(&settings(5), Some(&design))) > 10);
    let bound = PosteriseSettings {
        bind: Some(10),
        ..settings(5)
    };
    let bound = made(&bound, Some(&design));
    assert!(longest(&bound) <= 10, "{:?}", bound.warnings);
    assert!(regions(&bound.design).corrections().is_some());
}

#[test]
fn threads_and_time_of_day_do_not_matter() {
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.unwrap().install(|| made(&settings(11), None))
    };
    let one = with(1);
    assert!(one == with(4));
    assert!(one != made(&settings(10), None));
}

#[test]
fn odd_pictures_give_a_design_or_a_line() {
    for (width, height) in [(1, 1), (1, 300), (300, 1), (2, 2)] {
        let pixels = (0..width * height)
            .map(|k| [k as u8, 255 - k as u8, 3])
            .collect();
        let source = Arc::new(SourceImage::new(width, height, pixels).unwrap());
        for fit in [Fit::Crop, Fit::Pad, Fit::Stretch] {
            let settings = PosteriseSettings {
                fit,
                ..settings(24)
            };
            match posterise(&source, &settings, None, &Job::new()) {
                Ok(made) => assert!(!made.colours.is_empty()),
                Err(error) => assert_eq!(error.to_string().lines().count(), 1),
            }
        }
    }
    let job = Job::new();
    job.cancel();
    let cancelled = posterise(&picture(), &settings(6), None, &job);
    assert!(matches!(cancelled, Err(PosteriseError::Cancelled(_))));
}
