//! How far the yarn on top runs: the float through one crossing, and the long floats that
//! can be seen in a window of the endless cloth.
//!
//! [`super::floats`] measures a whole design; this answers for what is looked at, on any
//! lattice, and costs no more than what is looked at.

use super::lattice::Lattice;
use super::pattern::WeavePattern;
use crate::job::{Cancelled, Job};

/// A float on the face: where it begins and how many threads it passes over.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct FaceFloat {
    /// Whether it is an end that floats, over picks; else a pick, over ends.
    pub warp: bool,
    /// Leftmost end.
    pub end: i64,
    /// Lowest pick.
    pub pick: i64,
    /// Threads it passes over.
    pub length: u32,
}

/// A box of the endless cloth.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ClothBox {
    /// Leftmost end.
    pub end: i64,
    /// Lowest pick.
    pub pick: i64,
    /// Ends across.
    pub ends: u32,
    /// Picks along.
    pub picks: u32,
}

/// Whether the warp is on top at a crossing of the endless cloth; `None` = no cloth.
fn up(drawdown: &WeavePattern, lattice: Lattice, end: i64, pick: i64) -> Option<bool> {
    let (home_end, home_pick) = lattice.wrap(end, pick, drawdown.ends(), drawdown.picks())?;
    Some(drawdown.get(home_end, home_pick))
}

/// The float of the yarn on top at a crossing. A yarn that is never bound counts as long
/// as `most`, as does one that runs further. `None` where there is no cloth.
pub fn float_through(
    drawdown: &WeavePattern,
    lattice: Lattice,
    (end, pick): (i64, i64),
    most: u32,
) -> Option<FaceFloat> {
    let warp = up(drawdown, lattice, end, pick)?;
    let (across, along) = if warp { (0, 1) } else { (1, 0) };
    let run = |step: i64| {
        let same = |&distance: &u32| {
            let by = step * i64::from(distance);
            up(drawdown, lattice, end + across * by, pick + along * by) == Some(warp)
        };
        (1..most.max(1)).take_while(same).count() as u32
    };
    let (before, after) = (run(-1), run(1));
    Some(FaceFloat {
        warp,
        end: end - across * i64::from(before),
        pick: pick - along * i64::from(before),
        length: (before + after + 1).min(most.max(1)),
    })
}

/// The floats on the face that pass over more threads than allowed and can be seen in
/// `window`: ends over picks by `warp_limit`, picks over ends by `weft_limit`. Parts that
/// lie further outside the window than the limit are not counted.
pub fn long_floats_in(
    drawdown: &WeavePattern,
    lattice: Lattice,
    window: ClothBox,
    warp_limit: u32,
    weft_limit: u32,
) -> Vec<FaceFloat> {
    let mut found = Vec::new();
    let limits = [warp_limit, weft_limit];
    let put = |float| found.push(float);
    // Nobody can cancel a job that nobody else has.
    let _ = each_long_float(drawdown, lattice, window, limits, &Job::new(), put);
    found
}

/// The longest floats of a whole design that pass over more threads than allowed (ends
/// over picks, picks over ends), at most `most` of them with the longest first, and how
/// many there are. However many that is, no more than `2 * most` are in memory.
///
/// # Errors
/// When the job is cancelled.
pub fn longest_floats(
    drawdown: &WeavePattern,
    lattice: Lattice,
    limits: [u32; 2],
    most: usize,
    job: &Job,
) -> Result<(Vec<FaceFloat>, u64), Cancelled> {
    let window = ClothBox {
        end: 0,
        pick: 0,
        ends: drawdown.ends(),
        picks: drawdown.picks(),
    };
    let shorten = |kept: &mut Vec<FaceFloat>| {
        kept.sort_unstable_by_key(|float| (std::cmp::Reverse(float.length), *float));
        kept.truncate(most);
    };
    let (mut kept, mut count) = (Vec::new(), 0u64);
    each_long_float(drawdown, lattice, window, limits, job, |float| {
        count += 1;
        kept.push(float);
        if kept.len() >= 2 * most.max(1) {
            shorten(&mut kept);
        }
    })?;
    shorten(&mut kept);
    Ok((kept, count))
}

/// Gives the floats of [`long_floats_in`], end by end and then pick by pick.
fn each_long_float(
    drawdown: &WeavePattern,
    lattice: Lattice,
    window: ClothBox,
    [warp_limit, weft_limit]: [u32; 2],
    job: &Job,
    mut put: impl FnMut(FaceFloat),
) -> Result<(), Cancelled> {
    for end in window.end..window.end + i64::from(window.ends) {
        job.check()?;
        let is_up = |pick| up(drawdown, lattice, end, pick) == Some(true);
        runs(
            window.pick,
            window.picks,
            warp_limit,
            is_up,
            |pick, length| {
                put(FaceFloat {
                    warp: true,
                    end,
                    pick,
                    length,
                });
            },
        );
    }
    for pick in window.pick..window.pick + i64::from(window.picks) {
        job.check()?;
        let is_down = |end| up(drawdown, lattice, end, pick) == Some(false);
        runs(
            window.end,
            window.ends,
            weft_limit,
            is_down,
            |end, length| {
                put(FaceFloat {
                    warp: false,
                    end,
                    pick,
                    length,
                });
            },
        );
    }
    Ok(())
}

/// Gives the runs longer than `limit` that reach into `count` threads from `first`.
fn runs(
    first: i64,
    count: u32,
    limit: u32,
    is: impl Fn(i64) -> bool,
    mut put: impl FnMut(i64, u32),
) {
    let (past, margin) = (first + i64::from(count), i64::from(limit));
    let mut start = None;
    for at in first - margin..=past + margin {
        let inside = at < past + margin && is(at);
        match (inside, start) {
            (true, None) => start = Some(at),
            (false, Some(from)) => {
                if at - from > margin && at > first && from < past {
                    put(from, (at - from) as u32);
                }
                start = None;
            }
            _ => {}
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;
    use crate::design::{Repeat, longest_float, satin};

    #[test]
    fn a_satin_floats_as_long_as_it_is_known_to() {
        let weave = satin(8, 3).unwrap();
        let longest = longest_float(&weave);
        for end in -20..20 {
            for pick in -20..20 {
                let float = float_through(&weave, Lattice::default(), (end, pick), 99).unwrap();
                let known = if float.warp {
                    longest.warp_face
                } else {
                    longest.weft_face
                };
                assert_eq!(float.length, known, "{float:?}");
            }
        }
        let window = ClothBox {
            end: -3,
            pick: 2,
            ends: 16,
            picks: 9,
        };
        let weft = longest.weft_face;
        let long = long_floats_in(&weave, Lattice::default(), window, 7, weft - 1);
        assert!(long.iter().all(|float| !float.warp && float.length == weft));
        assert!(long.iter().any(|float| float.end < window.end));
        assert_eq!(
            long_floats_in(&weave, Lattice::default(), window, 7, weft),
            []
        );
    }

    #[test]
    fn the_longest_floats_are_those_of_the_whole_list() {
        let mut weave = satin(8, 3).unwrap().repeated(40, 24, (0, 0));
        for end in 3..19 {
            weave.set(end, 7, false);
        }
        let window = ClothBox {
            end: 0,
            pick: 0,
            ends: 40,
            picks: 24,
        };
        let mut all = long_floats_in(&weave, Lattice::default(), window, 1, 2);
        all.sort_by_key(|float| (std::cmp::Reverse(float.length), *float));
        for most in [1, 3, 1000] {
            let job = Job::new();
            let (kept, count) =
                longest_floats(&weave, Lattice::default(), [1, 2], most, &job).unwrap();
            assert_eq!(count, all.len() as u64);
            assert_eq!(kept, all[..most.min(all.len())]);
        }
        assert!(all[0].length > 7 && all.len() > 20);
        let stopped = Job::new();
        stopped.cancel();
        assert!(longest_floats(&weave, Lattice::default(), [1, 2], 3, &stopped).is_err());
    }

    #[test]
    fn a_panel_binds_at_its_edge_and_a_free_yarn_is_counted_to_the_limit() {
        let weft_up = WeavePattern::new(6, 1);
        let panel = Lattice {
            across: Repeat::None,
            along: Repeat::Straight,
        };
        let float = float_through(&weft_up, panel, (2, 0), 50).unwrap();
        assert_eq!((float.end, float.length), (0, 6));
        assert_eq!(float_through(&weft_up, panel, (6, 0), 50), None);
        let endless = float_through(&weft_up, Lattice::default(), (2, 0), 50).unwrap();
        assert_eq!(endless.length, 50);
    }
}
