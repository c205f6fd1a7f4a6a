//! The weaves of the built-in exemplars.

use crate::design::WeavePattern;

/// Holds the neighbourhoods that none of the other standard weaves has: a lone weft
/// crossing on a warp float's line and a lone warp crossing on a weft float's line.
/// Found by a random search over small weaves for the shortest floats.
pub(super) const COMPLETING: &str = "
    ##.#
    .#..
    .#.#
    ..##";

/// Reads ASCII art, `#` = warp up; the last line is pick 0.
pub(super) fn from_ascii(art: &str) -> WeavePattern {
    let picks: Vec<&[u8]> = art
        .lines()
        .map(str::trim)
        .filter(|line| !line.is_empty())
        .map(str::as_bytes)
        .rev()
        .collect();
    let ends = picks.iter().map(|pick| pick.len()).min().unwrap_or(0);
    WeavePattern::from_fn(ends as u32, picks.len() as u32, |end, pick| {
        picks
            .get(pick as usize)
            .and_then(|line| line.get(end as usize))
            .is_some_and(|&c| c == b'#')
    })
}

/// Z twill on five ends, warp over `up`: lines rise to the right.
fn twill_z(up: u32) -> WeavePattern {
    WeavePattern::from_fn(5, 5, |end, pick| (end + 5 - pick) % 5 < up)
}

/// S twill on five ends, warp over `up`: lines rise to the left.
fn twill_s(up: u32) -> WeavePattern {
    WeavePattern::from_fn(5, 5, |end, pick| (end + pick) % 5 < up)
}

/// Satin on five ends, warp over `up` picks; ties move `step` ends to the right per pick.
fn satin(up: u32, step: u32) -> WeavePattern {
    // A tie at end = step · pick lies at pick = inverse · end: 2 and 3 are each other's
    // inverse modulo 5.
    let inverse = 5 - step;
    WeavePattern::from_fn(5, 5, |end, pick| {
        (pick + 5 * inverse - inverse * end) % 5 < up
    })
}

/// The eight exemplars of Zhao 2012: 1/4, 2/3, 3/2 and 4/1 twill and satin.
pub(super) fn paper() -> Vec<WeavePattern> {
    let twills = (1..5).map(twill_z);
    twills.chain((1..5).map(|up| satin(up, 3))).collect()
}

/// Both hands of the paper's weaves, basket, ribs, plain, and the completing weave.
///
/// The short weaves are repeated to 4 × 4 so that a yarn's twist can close in them.
pub(super) fn standard() -> Vec<WeavePattern> {
    let mut weaves = paper();
    weaves.extend((1..5).map(twill_s));
    weaves.extend((1..5).map(|up| satin(up, 2)));
    let square = |warp_up: fn(u32, u32) -> bool| WeavePattern::from_fn(4, 4, warp_up);
    weaves.push(square(|end, pick| (end / 2 + pick / 2) % 2 == 0));
    weaves.push(square(|end, pick| (end + pick / 2) % 2 == 0));
    weaves.push(square(|end, pick| (end / 2 + pick) % 2 == 0));
    weaves.push(square(|end, pick| (end + pick) % 2 == 0));
    weaves.push(from_ascii(COMPLETING));
    weaves
}
