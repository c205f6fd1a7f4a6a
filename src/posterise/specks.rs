//! Specks: patches of one colour too small to weave.
//!
//! A patch (crossings of one colour joined by their sides) below a size takes the colour of
//! the neighbour with which it shares the longest border.

use std::collections::VecDeque;

use super::PosteriseError;
use crate::job::Job;

/// Merges patches of fewer than `smallest` pixels in rows of `width`; 0 and 1 do nothing.
///
/// Patches are met row by row, so the result depends on nothing else. Every merge leaves
/// fewer patches, so the rounds end.
pub(super) fn merge(
    indices: &mut [u8],
    width: usize,
    smallest: u32,
    job: &Job,
) -> Result<(), PosteriseError> {
    if smallest <= 1 || width == 0 {
        return Ok(());
    }
    let mut seen = vec![false; indices.len()];
    let mut patch = Vec::new();
    loop {
        job.check()?;
        seen.fill(false);
        let mut merged = false;
        for start in 0..indices.len() {
            if seen[start] {
                continue;
            }
            let small = spread(indices, width, start, smallest, &mut seen, &mut patch);
            if small && let Some(colour) = longest_border(indices, width, &patch) {
                patch.iter().for_each(|&at| indices[at] = colour);
                merged = true;
            }
        }
        if !merged {
            return Ok(());
        }
    }
}

/// The places beside a place, inside the picture.
fn beside(at: usize, width: usize, all: usize) -> impl Iterator<Item = usize> {
    let column = at % width;
    let left = (column > 0).then(|| at - 1);
    let right = (column + 1 < width && at + 1 < all).then_some(at + 1);
    let above = at.checked_sub(width);
    let below = (at + width < all).then_some(at + width);
    [above, left, right, below].into_iter().flatten()
}

/// Marks the patch that `start` belongs to; if it is of fewer than `smallest` places they
/// are in `patch` and the answer is true.
fn spread(
    indices: &[u8],
    width: usize,
    start: usize,
    smallest: u32,
    seen: &mut [bool],
    patch: &mut Vec<usize>,
) -> bool {
    patch.clear();
    seen[start] = true;
    // Only the rim waits here, however large the patch is.
    let mut rim = VecDeque::from([start]);
    let mut size = 0u64;
    while let Some(at) = rim.pop_front() {
        size += 1;
        if size < u64::from(smallest) {
            patch.push(at);
        }
        for other in beside(at, width, indices.len()) {
            if !seen[other] && indices[other] == indices[start] {
                seen[other] = true;
                rim.push_back(other);
            }
        }
    }
    size < u64::from(smallest)
}

/// The colour that a patch shares the longest border with; the first of equals.
fn longest_border(indices: &[u8], width: usize, patch: &[usize]) -> Option<u8> {
    let own = indices[*patch.first()?];
    let mut borders = [0u32; 256];
    for &at in patch {
        for other in beside(at, width, indices.len()) {
            if indices[other] != own {
                borders[usize::from(indices[other])] += 1;
            }
        }
    }
    let longest = borders.iter().copied().max().filter(|&length| length > 0)?;
    let first = borders.iter().position(|&length| length == longest)?;
    u8::try_from(first).ok()
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;

    fn merged(art: &str, smallest: u32) -> String {
        let lines: Vec<&str> = art.split_whitespace().collect();
        let width = lines[0].len();
        let mut indices: Vec<u8> = lines.concat().bytes().collect();
        merge(&mut indices, width, smallest, &Job::new()).unwrap();
        let rows: Vec<_> = indices.chunks(width).map(String::from_utf8_lossy).collect();
        rows.join(" ")
    }

    #[test]
    fn a_speck_takes_the_colour_of_its_longest_border() {
        // The b's touch one c and five a's.
        assert_eq!(
            merged("aaaaa abbaa aaacc ccccc", 3),
            "aaaaa aaaaa aaacc ccccc"
        );
        // Here they touch three c's and one a.
        assert_eq!(
            merged("abbcc acccc acccc ccccc", 3),
            "acccc acccc acccc ccccc"
        );
    }

    #[test]
    fn patches_of_the_size_stay_and_corners_do_not_join() {
        assert_eq!(merged("aaaa abba aaaa", 2), "aaaa abba aaaa");
        assert_eq!(merged("aaaa abba aaaa", 3), "aaaa aaaa aaaa");
        assert_eq!(merged("baa aba aab", 2), "aaa aaa aaa");
        assert_eq!(merged("baa aba aab", 1), "baa aba aab");
    }

    #[test]
    fn specks_of_specks_join_and_one_colour_stays() {
        let out = merged("abcd dcba abcd dcba", 5);
        let sizes = |colour: char| out.chars().filter(|&c| c == colour).count();
        assert!(
            "abcd".chars().all(|c| sizes(c) == 0 || sizes(c) >= 5),
            "{out}"
        );
        assert_eq!(merged("aa", 100), "aa");
    }
}
