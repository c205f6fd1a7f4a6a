//! A panel of 16 000 ends and 20 000 picks: woven, looked at, measured and made into cloth
//! where one looks, in memory that follows what is looked at.
//!
//! What is measured runs in a process of its own, since peak memory is the process's.

#![allow(clippy::unwrap_used, reason = "a test may fail")]

use std::sync::Arc;

use crate::memory::{alone, peak, reset_peak};
use pickglass::cloth::Followed;
use pickglass::design::{
    Design, Family, Fill, Filled, Lattice, Srgb, Structure, WeavePattern, Yarn, YarnId, YarnMaps,
    longest_floats, usual_sett,
};
use pickglass::engine::{StillRequest, Stop, covers, follow, prepare_woven, render};
use pickglass::exemplar::ExemplarStore;
use pickglass::job::Job;
use pickglass::plan::{EffectBase, EffectChoice, Settings};
use pickglass::synthesis::{Catalogue, Method, Stretch, SynthesisError, assign, assign_part};

const ENDS: u32 = 16_000;
const PICKS: u32 = 20_000;
/// The panel's bits.
const PACKED: u64 = ENDS as u64 * PICKS as u64 / 8;

fn panel() -> Arc<Design> {
    let fill = Fill::by_notation("1/7 satin move 3").unwrap();
    let structure = Structure::Weave(Filled::new(fill, ENDS, PICKS).unwrap());
    let yarns = vec![
        Yarn::new("navy", Family::Cotton, Srgb(38, 52, 94)),
        Yarn::new("cream", Family::Cotton, Srgb(236, 226, 203)),
    ];
    let maps = YarnMaps::plain(YarnId(0), YarnId(1));
    let sett = usual_sett(&yarns, &maps);
    Arc::new(Design::new("panel", structure, yarns, maps, sett).unwrap())
}

fn look(x: f32, y: f32) -> StillRequest {
    StillRequest {
        width: 32,
        height: 24,
        width_mm: Some(8.0),
        centre_mm: Some([x, y]),
        effects: EffectChoice {
            base: EffectBase::None,
            ..EffectChoice::default()
        },
        settings: Settings::default().at_level(4),
        stop: Stop {
            spp: Some(1),
            ..Stop::default()
        },
        ..StillRequest::default()
    }
}

#[test]
fn a_panel_is_made_into_cloth_where_one_looks() {
    let test = concat!(
        module_path!(),
        "::a_panel_is_made_into_cloth_where_one_looks"
    );
    if alone(test, &[""]).is_none() {
        return;
    }
    let (job, store) = (Job::new(), ExemplarStore::user());
    let design = panel();
    let before = reset_peak();
    let drawdown = Arc::new(design.weave());
    if let Some(taken) = before.zip(peak()).map(|(before, after)| after - before) {
        println!("weaving: {} KiB", taken >> 10);
        assert!(taken < 3 * PACKED, "weaving took {taken} bytes");
    }
    let here = look(3000.0, 2000.0);
    let cloth = prepare_woven(&design, &drawdown, &here, &store, &job).unwrap();
    assert!(covers(&cloth, &here));
    let (end, pick) = (
        design.end_positions().locate(3000.0).0,
        design.pick_positions().locate(2000.0).0,
    );
    // From here on exemplars are at hand: what is taken follows the view.
    let before = reset_peak();
    for dx in -20..20 {
        let up = cloth.cloth().warp_up(end + dx, pick + 3);
        let (e, p) = ((end + dx).rem_euclid(i64::from(ENDS)), pick + 3);
        assert_eq!(up, Some(drawdown.get(e as u32, p as u32)));
    }
    let mut seen = 0;
    render(&cloth, &here, &job, &mut |pass| {
        seen = pass.rgba().chunks(4).filter(|pixel| pixel[3] > 0).count();
    })
    .unwrap();
    assert!(seen > 32 * 24 / 2, "cloth shows in {seen} pixels");

    let there = look(6000.0, 2000.0);
    assert!(!covers(&cloth, &there));
    let moved = match follow(&cloth, &design, &drawdown, &there, &job).unwrap() {
        Some(Followed::Ready(cloth)) => cloth,
        Some(Followed::Unfinished(cloth)) => cloth.complete(&store, &job).unwrap(),
        None => panic!("the cloth follows the eye"),
    };
    assert!(covers(&moved, &there) && !covers(&moved, &here));
    if let Some(taken) = before.zip(peak()).map(|(before, after)| after - before) {
        println!("looking: {} KiB", taken >> 10);
        // All blocks would be sixteen times the packed size.
        assert!(taken < 4 * PACKED, "looking took {taken} bytes");
    }
    let all = StillRequest {
        width_mm: Some(8000.0),
        ..look(3000.0, 2000.0)
    };
    let refused = prepare_woven(&design, &drawdown, &all, &store, &job)
        .err()
        .unwrap();
    assert!(refused.is_too_wide(), "{refused}");

    let (floats, count) = longest_floats(&drawdown, Lattice::default(), [6, 6], 400, &job).unwrap();
    assert_eq!((floats.len(), floats[0].length), (400, 7));
    assert!(count > 30_000_000, "{count} floats");
    if let Some(taken) = before.zip(peak()).map(|(before, after)| after - before) {
        assert!(taken < 4 * PACKED, "floats took {taken} bytes");
    }
}

#[test]
fn the_columns_of_a_part_are_those_of_the_whole() {
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    let mut pattern = WeavePattern::from_fn(90, 70, |_, _| {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        state & 6 == 0
    });
    let (catalogue, job) = (Catalogue::standard(), Job::new());
    let stretch = Stretch {
        ends: 80..100,
        picks: 0..9,
    };
    let lattice = Lattice::default();
    let whole = assign(&pattern, lattice, &catalogue, Method::Dp, 3, &job).unwrap();
    let mut part = assign_part(
        &pattern,
        lattice,
        &catalogue,
        (Method::Dp, 3),
        &stretch,
        &job,
    )
    .unwrap();
    let expect = |part: &pickglass::synthesis::Assignment,
                  whole: &pickglass::synthesis::Assignment,
                  there: &dyn Fn(u32) -> bool| {
        for end in 0..90 {
            match there(end) {
                true => assert_eq!(part.column(end), whole.column(end), "{end}"),
                false => assert!(part.column(end).is_empty(), "{end}"),
            }
        }
    };
    expect(&part, &whole, &|end| !(10..80).contains(&end));
    assert_eq!(part.at(40, 3), None, "no cloth where nobody looks");
    assert_eq!(part.at(-5, 3), whole.at(-5, 3));
    assert!(part.bytes() < whole.bytes() / 2);

    // An edit at the border of the part, and one outside it.
    let cells = [(9, 4), (40, 8)];
    for (end, pick) in cells {
        pattern.set(end, pick, !pattern.get(end, pick));
    }
    let redone = part.edit(&pattern, &catalogue, &cells, &job).unwrap();
    assert!(redone.iter().all(|end| !(10..80).contains(end)) && redone.contains(&9));
    let edited = assign(&pattern, lattice, &catalogue, Method::Dp, 3, &job).unwrap();
    expect(&part, &edited, &|end| !(10..80).contains(&end));
    assert_ne!(edited.column(9), whole.column(9), "the edit is seen");

    let on = Stretch {
        ends: 5..30,
        picks: 0..9,
    };
    part.look_at(&pattern, &catalogue, &on, &job).unwrap();
    expect(&part, &edited, &|end| (5..30).contains(&end));
}

#[test]
fn a_whole_panel_is_refused_where_all_of_it_would_be_made() {
    let weave = WeavePattern::new(ENDS, PICKS);
    let (catalogue, job) = (Catalogue::standard(), Job::new());
    let refused = assign(&weave, Lattice::default(), &catalogue, Method::Dp, 0, &job);
    assert!(matches!(refused, Err(SynthesisError::TooMany { .. })));
    let message = refused.unwrap_err().to_string();
    assert!(message.contains("crop the design"), "{message}");
}
