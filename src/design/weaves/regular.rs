//! The regular weaves that a ratio describes: twills, satins and twills that turn.
//!
//! Every end is the same over-and-under of the ratio, started on another pick; only the
//! starts differ.

use super::MAX_REPEAT;
use crate::design::pattern::WeavePattern;

/// For each pick of the repeat, whether a warp that starts at pick 0 is up.
fn lifts(ratio: &[u32]) -> Vec<bool> {
    let mut up = Vec::new();
    for (place, &count) in ratio.iter().enumerate() {
        up.extend(std::iter::repeat_n(place % 2 == 0, count as usize));
    }
    up
}

/// The weave whose end e comes up `starts[e]` picks later than end 0 of a twill.
fn offset_twill(ratio: &[u32], starts: &[i64], picks: u32) -> WeavePattern {
    let up = lifts(ratio);
    let repeat = up.len() as i64;
    WeavePattern::from_fn(starts.len() as u32, picks, |end, pick| {
        up[(i64::from(pick) - starts[end as usize]).rem_euclid(repeat) as usize]
    })
}

/// A twill: warp over and under by `ratio`, each end one pick after its neighbour.
///
/// Lines rise to the right (Z), or to the left if `leans_left` (S).
pub(super) fn twill(ratio: &[u32], leans_left: bool) -> WeavePattern {
    let repeat: u32 = ratio.iter().sum();
    let starts: Vec<i64> = (0..i64::from(repeat))
        .map(|end| if leans_left { -end } else { end })
        .collect();
    offset_twill(ratio, &starts, repeat)
}

/// Greatest common divisor.
fn gcd(a: u32, b: u32) -> u32 {
    if b == 0 { a } else { gcd(b, a % b) }
}

/// The moves that make a regular satin on `ends` ends, smallest first.
pub fn satin_moves(ends: u32) -> Vec<u32> {
    (2..ends.saturating_sub(1))
        .filter(|&step| gcd(step, ends) == 1)
        .collect()
}

/// A satin of `over` + `under` ends; without a step the one whose ties lie farthest apart.
pub(super) fn satin_of(over: u32, under: u32, step: Option<u32>) -> Result<WeavePattern, String> {
    let ends = over + under;
    let moves = satin_moves(ends);
    let listed = |moves: &[u32]| {
        let shown: Vec<String> = moves.iter().take(12).map(u32::to_string).collect();
        shown.join(", ")
    };
    let Some(usual) = moves.iter().copied().max_by_key(|&step| {
        // Of equally good moves the smallest: `max_by_key` keeps the last.
        (tie_distance(ends, step), u32::MAX - step)
    }) else {
        return Err(format!(
            "no regular satin exists on {ends} ends: use 5, 7, 8 or more"
        ));
    };
    let step = step.unwrap_or(usual);
    if !moves.contains(&step) {
        return Err(format!(
            "move {step} makes no satin on {ends} ends: use {}",
            listed(&moves)
        ));
    }
    // End e's tie is on the pick j with step·j ≡ e.
    let mut starts = vec![0; ends as usize];
    for pick in 0..ends {
        starts[(pick * step % ends) as usize] = i64::from(pick);
    }
    Ok(offset_twill(&[over, under], &starts, ends))
}

/// Squared distance between the nearest ties of a satin.
fn tie_distance(ends: u32, step: u32) -> u32 {
    (1..ends)
        .map(|pick| {
            let along = step * pick % ends;
            let along = along.min(ends - along);
            let up = pick.min(ends - pick);
            along * along + up * up
        })
        .min()
        .unwrap_or(0)
}

/// Twill that turns every `width` ends; at each cut the weave jumps by half a repeat, so
/// that face and back change places and no long float arises.
pub(super) fn herringbone(
    ratio: &[u32],
    width: u32,
    leans_left: bool,
) -> Result<WeavePattern, String> {
    let repeat: u32 = ratio.iter().sum();
    if !(2..=MAX_REPEAT / 2).contains(&width) {
        return Err(format!(
            "stripes of {width} ends: give 2 to {}",
            MAX_REPEAT / 2
        ));
    }
    let half = i64::from(repeat / 2);
    let width = i64::from(width);
    let hand = if leans_left { -1 } else { 1 };
    let rising = (0..width).map(|end| hand * end);
    let falling = (0..width).map(|end| hand * (width - 1 - end) + half);
    let starts: Vec<i64> = rising.chain(falling).collect();
    Ok(offset_twill(ratio, &starts, repeat))
}

/// Twill that turns on every `width`-th end: the turning ends stand alone.
pub(super) fn pointed(ratio: &[u32], width: u32, leans_left: bool) -> Result<WeavePattern, String> {
    let repeat: u32 = ratio.iter().sum();
    if !(2..=MAX_REPEAT / 2).contains(&width) {
        return Err(format!(
            "points every {width} ends: give 2 to {}",
            MAX_REPEAT / 2
        ));
    }
    let width = i64::from(width);
    let hand = if leans_left { -1 } else { 1 };
    let starts: Vec<i64> = (0..2 * width)
        .map(|end| hand * end.min(2 * width - end))
        .collect();
    Ok(offset_twill(ratio, &starts, repeat))
}

/// Flattest slope of a wavy twill's lines in picks per end; the steepest is two minus it.
const WAVY_FLATTEST: f64 = 0.4;

/// Twill of `size` × `size` whose slope swings smoothly between flat and steep once.
pub(super) fn wavy(ratio: &[u32], size: u32, leans_left: bool) -> Result<WeavePattern, String> {
    let repeat: u32 = ratio.iter().sum();
    if !size.is_multiple_of(repeat) {
        return Err(format!(
            "{size} is no multiple of the repeat of {repeat}: use {}",
            size.div_ceil(repeat) * repeat
        ));
    }
    let turn = std::f64::consts::TAU / f64::from(size);
    let swing = (1.0 - WAVY_FLATTEST) / turn;
    let hand = if leans_left { -1 } else { 1 };
    let starts: Vec<i64> = (0..size)
        .map(|end| {
            let end = f64::from(end);
            hand * (end + swing * (turn * end).sin()).round() as i64
        })
        .collect();
    Ok(offset_twill(ratio, &starts, size))
}
