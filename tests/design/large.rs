//! The largest loom file seen, 5120 ends and 6300 picks: everything a designer waits for is
//! done in one go. Times are printed, never asserted.

#![allow(clippy::unwrap_used, reason = "a test may fail")]

use std::time::Instant;

use pickglass::design::{
    Draft, Fill, Grid, Lifting, Loom, MAX_SHAFTS, Region, Regions, Shed, Ties, derive, floats,
};

const ENDS: u32 = 5120;
const PICKS: u32 = 6300;

fn timed<T>(what: &str, work: impl FnOnce() -> T) -> T {
    let started = Instant::now();
    let result = work();
    println!("{what}: {:?}", started.elapsed());
    result
}

#[test]
fn a_jacquard_of_thirty_million_crossings() {
    let region = |notation| Region::new("", Fill::by_notation(notation).unwrap());
    let palette = vec![
        region("1/7 satin"),
        region("7/1 satin"),
        region("2/2 twill"),
    ];
    let map = timed("region map", || {
        Grid::from_fn(ENDS, PICKS, |end, pick| {
            ((end / 97 + pick / 133) % 3) as u16
        })
        .unwrap()
    });
    let regions = Regions::new(map, palette, None).unwrap();
    let weave = timed("regions to weave", || regions.weave());
    let found = timed("floats", || floats(&weave));
    assert!(found.longest.warp_face >= 7 && found.unbound_ends.is_empty());
    let draft = timed("a shaft for each column", || {
        derive(&weave, &Loom::dobby(MAX_SHAFTS)).unwrap()
    });
    let drawdown = timed("lift plan to weave", || draft.drawdown());
    assert_eq!(drawdown, weave);
}

#[test]
fn a_shaft_draft_of_thirty_million_crossings() {
    let threading = Ties::from_rows((0..ENDS).map(|end| [(end % 16) as u16]));
    let tieup = Ties::from_rows((0..16u16).map(|treadle| {
        let shafts = (0..16).filter(|shaft| (shaft * 5 + treadle * 3) % 16 < 8);
        shafts.collect::<Vec<_>>()
    }));
    let treadling = Ties::from_rows((0..PICKS).map(|pick| [(pick * 7 % 16) as u16]));
    let lifting = Lifting::Treadled { tieup, treadling };
    let draft = Draft::new(16, 16, Shed::Rising, threading, lifting).unwrap();
    let weave = timed("shaft draft to weave", || draft.drawdown());
    assert_eq!((weave.ends(), weave.picks()), (ENDS, PICKS));
    for (end, pick) in [(0, 0), (4999, 6001), (17, 3)] {
        let (shaft, treadle) = (end % 16, pick * 7 % 16);
        assert_eq!(weave.get(end, pick), (shaft * 5 + treadle * 3) % 16 < 8);
    }
}
