//! The shadow series: weaves from weft satin to warp satin, one crossing at a time.
//!
//! All stand on the eight-end satin of move 3. Weave *n* has *n* of its 64 crossings warp
//! up: each tie grows along its end, some of them one pick further than the others. Every
//! weave of the series lifts the ties of 1/7 and none lifts those left down in 7/1, so
//! wherever two of them meet no float is longer than seven.

use crate::design::{Fill, WeavePattern, weave};

/// Threads of the satin, both ways.
const SIZE: u32 = 8;
/// Warp-up crossings of the series' lightest weave for a light weft: 1/7 satin.
pub const LIGHTEST: u32 = SIZE;
/// Warp-up crossings of the series' other end: 7/1 satin.
pub const DARKEST: u32 = SIZE * (SIZE - 1);
/// In which order the ties grow: far apart, so that no stripes arise.
const ORDER: [u32; SIZE as usize] = [0, 4, 2, 6, 1, 5, 3, 7];

/// The weave of the series with `up` of 64 crossings warp up, held in
/// [`LIGHTEST`]..=[`DARKEST`]. Multiples of 8 are regular satins with a notation.
pub fn shadow_weave(up: u32) -> Fill {
    let up = up.clamp(LIGHTEST, DARKEST);
    let (over, grown) = (up / SIZE, up % SIZE);
    let satin = format!("{over}/{} satin move 3", SIZE - over);
    match Fill::by_notation(&satin) {
        Ok(fill) if grown == 0 => fill,
        _ => Fill::drawn(grow(over, grown)),
    }
}

/// The satin `over`/(8−`over`) with `grown` of its ties one pick longer.
fn grow(over: u32, grown: u32) -> WeavePattern {
    let of = |over: u32| weave(&format!("{over}/{} satin move 3", SIZE - over));
    let (Ok(short), Ok(long)) = (of(over), of(over + 1)) else {
        return WeavePattern::new(SIZE, SIZE);
    };
    // The tie that starts on pick j lies on end 3·j.
    let starts = |end: u32| (0..SIZE).find(|pick| pick * 3 % SIZE == end).unwrap_or(0);
    let longer = |end: u32| {
        let place = ORDER.iter().position(|&pick| pick == starts(end));
        place.is_some_and(|place| (place as u32) < grown)
    };
    WeavePattern::from_fn(SIZE, SIZE, |end, pick| {
        let weave = if longer(end) { &long } else { &short };
        weave.get(end, pick)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::design::longest_float;

    #[test]
    fn every_weave_lifts_one_crossing_more_and_keeps_the_others() {
        for up in LIGHTEST..DARKEST {
            let (one, next) = (shadow_weave(up), shadow_weave(up + 1));
            assert_eq!(one.pattern().count_warp_up(), u64::from(up));
            for (end, pick) in (0..64).map(|k| (k % 8, k / 8)) {
                assert!(!one.pattern().get(end, pick) || next.pattern().get(end, pick));
            }
            assert_eq!(one.notation().is_some(), up % 8 == 0);
        }
        assert_eq!(shadow_weave(0), shadow_weave(LIGHTEST));
        assert_eq!(shadow_weave(99).notation(), Some("7/1 satin move 3"));
    }

    #[test]
    fn floats_are_bound_within_seven_also_where_two_of_them_meet() {
        for (a, b) in [(8, 56), (8, 20), (13, 47), (31, 33), (56, 8)] {
            let (a, b) = (shadow_weave(a), shadow_weave(b));
            let both = WeavePattern::from_fn(64, 64, |end, pick| {
                let fill = if (end * 3 + pick * 2) / 37 % 2 == 0 {
                    &a
                } else {
                    &b
                };
                fill.pattern().get(end % 8, pick % 8)
            });
            let floats = longest_float(&both);
            let longest = [
                floats.warp_face,
                floats.warp_back,
                floats.weft_face,
                floats.weft_back,
            ];
            assert!(longest.iter().all(|&length| length <= 7), "{longest:?}");
        }
    }
}
