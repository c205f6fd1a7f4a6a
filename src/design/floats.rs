//! Floats: how far a yarn runs on one face before it is bound again.
//!
//! A float longer than about 5 mm of cloth snags; designers look at it first. Runs are
//! counted round the straight repeat. Each direction is scanned once by words of 64
//! crossings, the warp on the transposed pattern.

use super::pattern::WeavePattern;

/// A direction and a face: which float is meant.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum FloatKind {
    /// An end over several picks, on the face.
    WarpFace,
    /// An end under several picks: it floats on the back.
    WarpBack,
    /// A pick over several ends, on the face.
    WeftFace,
    /// A pick under several ends: it floats on the back.
    WeftBack,
}

/// One length in crossings for each kind of float.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct FloatLengths {
    /// Ends on the face, in picks.
    pub warp_face: u32,
    /// Ends on the back, in picks.
    pub warp_back: u32,
    /// Picks on the face, in ends.
    pub weft_face: u32,
    /// Picks on the back, in ends.
    pub weft_back: u32,
}

/// A float that is longer than any inside the design, and exists only because the design
/// repeats.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SeamFloat {
    /// Direction and face.
    pub kind: FloatKind,
    /// The end or pick, from 0.
    pub thread: u32,
    /// Its length in crossings.
    pub length: u32,
}

/// What [`floats`] finds.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct FloatReport {
    /// The longest floats, counted round the straight repeat. A thread that is never bound
    /// counts the whole repeat.
    pub longest: FloatLengths,
    /// The longest floats inside the design, without going across its border.
    pub longest_inside: FloatLengths,
    /// Floats across the seam that are longer than any of their kind inside.
    pub seam: Vec<SeamFloat>,
    /// Ends that lie on one face throughout: nothing holds them.
    pub unbound_ends: Vec<u32>,
    /// Picks that lie on one face throughout.
    pub unbound_picks: Vec<u32>,
}

/// The longest runs of 1 and 0 in one thread.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
struct Runs {
    /// Longest run without going round: [zeros, ones].
    inside: [u32; 2],
    /// Length of the run across the seam and its bit, if both ends agree.
    seam: Option<(bool, u32)>,
    /// The thread never changes.
    unbound: bool,
}

/// Runs of equal bits along `length` bits, read as whole words.
fn runs(words: impl Iterator<Item = u64>, length: u32) -> Runs {
    let mut found = Runs::default();
    let mut left = length;
    let mut bit = false;
    let mut run = 0u32;
    let mut first: Option<(bool, u32)> = None;
    for word in words {
        let width = left.min(64);
        let mut rest = word;
        let mut here = width;
        if run == 0 {
            bit = word & 1 == 1;
        }
        while here > 0 {
            let same = if bit {
                rest.trailing_ones()
            } else {
                rest.trailing_zeros()
            }
            .min(here);
            run += same;
            here -= same;
            if here > 0 {
                // The run ends inside this word.
                first.get_or_insert((bit, run));
                let most = &mut found.inside[usize::from(bit)];
                *most = (*most).max(run);
                run = 0;
                bit = !bit;
                rest = rest.checked_shr(same).unwrap_or(0);
            }
        }
        left -= width;
    }
    let most = &mut found.inside[usize::from(bit)];
    *most = (*most).max(run);
    match first {
        None => found.unbound = true,
        Some((same, start)) if same == bit => found.seam = Some((bit, start + run)),
        Some(_) => {}
    }
    found
}

struct Direction {
    inside: [u32; 2],
    round: [u32; 2],
    seams: Vec<(u32, bool, u32)>,
    unbound: Vec<u32>,
}

/// Scans every pick of `pattern`.
fn scan(pattern: &WeavePattern) -> Direction {
    let mut all = Direction {
        inside: [0; 2],
        round: [0; 2],
        seams: Vec::new(),
        unbound: Vec::new(),
    };
    for thread in 0..pattern.picks() {
        let found = runs(pattern.pick_words(thread), pattern.ends());
        for side in 0..2 {
            all.inside[side] = all.inside[side].max(found.inside[side]);
        }
        if found.unbound {
            all.unbound.push(thread);
        }
        if let Some((bit, length)) = found.seam {
            all.seams.push((thread, bit, length));
        }
    }
    all.round = all.inside;
    for &(_, bit, length) in &all.seams {
        let most = &mut all.round[usize::from(bit)];
        *most = (*most).max(length);
    }
    let inside = all.inside;
    all.seams
        .retain(|&(_, bit, length)| length > inside[usize::from(bit)]);
    all
}

/// Longest floats of a weave on both faces, those across the seam, and unbound threads.
pub fn floats(pattern: &WeavePattern) -> FloatReport {
    let weft = scan(pattern);
    let warp = scan(&pattern.transposed());
    let lengths = |warp: [u32; 2], weft: [u32; 2]| FloatLengths {
        warp_face: warp[1],
        warp_back: warp[0],
        // Along a pick a 1 is a warp on top: the pick is on the back there.
        weft_face: weft[0],
        weft_back: weft[1],
    };
    let named = |seams: &[(u32, bool, u32)], up: FloatKind, down: FloatKind| {
        seams
            .iter()
            .map(|&(thread, bit, length)| SeamFloat {
                kind: if bit { up } else { down },
                thread,
                length,
            })
            .collect::<Vec<_>>()
    };
    let mut seam = named(&warp.seams, FloatKind::WarpFace, FloatKind::WarpBack);
    seam.extend(named(&weft.seams, FloatKind::WeftBack, FloatKind::WeftFace));
    FloatReport {
        longest: lengths(warp.round, weft.round),
        longest_inside: lengths(warp.inside, weft.inside),
        seam,
        unbound_ends: warp.unbound,
        unbound_picks: weft.unbound,
    }
}

/// The longest floats of a weave on both faces, counted round the straight repeat.
pub fn longest_float(pattern: &WeavePattern) -> FloatLengths {
    floats(pattern).longest
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn lengths(warp_face: u32, warp_back: u32, weft_face: u32, weft_back: u32) -> FloatLengths {
        FloatLengths {
            warp_face,
            warp_back,
            weft_face,
            weft_back,
        }
    }

    #[test]
    fn a_three_one_twill_floats_three_on_each_face() {
        let pattern = WeavePattern::parse("#.##\n.###\n###.\n##.#").unwrap();
        let found = floats(&pattern);
        assert_eq!(found.longest, lengths(3, 1, 1, 3));
        assert!(found.unbound_ends.is_empty() && found.unbound_picks.is_empty());
    }

    #[test]
    fn floats_across_the_seam_are_listed_apart() {
        let found = floats(&WeavePattern::parse("#...#\n.#.#.").unwrap());
        assert_eq!(found.longest_inside.weft_back, 1);
        let across = SeamFloat {
            kind: FloatKind::WeftBack,
            thread: 1,
            length: 2,
        };
        assert_eq!(found.seam, [across]);
        assert_eq!(found.longest.weft_back, 2);
        // Without the seam there is nothing to list.
        assert!(
            floats(&WeavePattern::parse("#.\n.#").unwrap())
                .seam
                .is_empty()
        );
    }

    #[test]
    fn threads_that_nothing_binds_are_named_and_count_the_whole_repeat() {
        let found = floats(&WeavePattern::parse("#.#\n#.#\n##.").unwrap());
        assert_eq!(found.unbound_ends, [0]);
        assert_eq!(found.longest.warp_face, 3);
        let one = floats(&WeavePattern::new(1, 1));
        assert_eq!((one.unbound_ends, one.unbound_picks), (vec![0], vec![0]));
    }

    /// The longest cyclic run along every pick, crossing by crossing.
    fn slow(pattern: &WeavePattern, bit: bool) -> u32 {
        let (ends, picks) = (pattern.ends(), pattern.picks());
        let mut longest = 0;
        for pick in 0..picks {
            for from in 0..ends {
                let run = (0..ends)
                    .take_while(|step| pattern.get((from + step) % ends, pick) == bit)
                    .count() as u32;
                longest = longest.max(run);
            }
        }
        longest
    }

    proptest! {
        #[test]
        fn words_and_single_crossings_count_alike(
            ends in 1u32..150, picks in 1u32..5, seed: u64, density in 0u64..16
        ) {
            let mut state = seed | 1;
            let pattern = WeavePattern::from_fn(ends, picks, |_, _| {
                state ^= state << 13;
                state ^= state >> 7;
                state ^= state << 17;
                state >> 8 & 15 < density
            });
            let found = floats(&pattern).longest;
            prop_assert_eq!(found.weft_back, slow(&pattern, true));
            prop_assert_eq!(found.weft_face, slow(&pattern, false));
            let turned = floats(&pattern.transposed()).longest;
            prop_assert_eq!(turned.warp_face, found.weft_back);
            prop_assert_eq!(turned.weft_face, found.warp_back);
        }
    }
}
