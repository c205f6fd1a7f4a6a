//! Whether a cloth hangs together, or lifts apart in layers though every thread is bound.
//!
//! Some ends and picks come away on top if each of them lies over every thread that stays
//! below. For a set of s ends and t picks on top, the ends lie over all n−t other picks and
//! the picks over all m−s other ends. Counting warp-up crossings, Σ(ends of the set) −
//! Σ(picks of the set) reaches its bound s·(n−t) exactly then; and the set that comes
//! nearest takes the s ends most often up and the t picks least often crossed. So sorting
//! the sums decides it (C. R. J. Clapham, "When a fabric hangs together", Bull. London Math.
//! Soc. 12, 1980, 161–164).

use crate::design::pattern::WeavePattern;

/// Threads that lie wholly on top of the rest of the cloth.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Layer {
    /// Ends of the repeat in it.
    pub ends: u32,
    /// Picks of the repeat in it.
    pub picks: u32,
}

/// The smallest layer that lifts off the face; `None` if the cloth hangs together.
pub fn loose_layer(weave: &WeavePattern) -> Option<Layer> {
    let (ends, picks) = (weave.ends(), weave.picks());
    let turned = weave.transposed();
    let ups = |pattern: &WeavePattern, thread: u32| -> i64 {
        let words = pattern.pick_words(thread);
        words.map(|word| i64::from(word.count_ones())).sum()
    };
    let mut end_ups: Vec<i64> = (0..ends).map(|end| ups(&turned, end)).collect();
    let mut pick_ups: Vec<i64> = (0..picks).map(|pick| ups(weave, pick)).collect();
    end_ups.sort_unstable_by(|a, b| b.cmp(a));
    pick_ups.sort_unstable();
    let mut best: Option<Layer> = None;
    let mut over = 0;
    for s in 0..=ends {
        if s > 0 {
            over += end_ups[s as usize - 1];
        }
        let mut under = 0;
        for t in 0..=picks {
            if t > 0 {
                under += pick_ups[t as usize - 1];
            }
            let some = s + t > 0 && (s, t) != (ends, picks);
            let smaller = best.is_none_or(|layer| s + t < layer.ends + layer.picks);
            if some && smaller && over - under == i64::from(s) * i64::from(picks - t) {
                best = Some(Layer { ends: s, picks: t });
            }
        }
    }
    best
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;
    use crate::design::{double_cloth, weave};
    use proptest::prelude::*;

    /// The same by trying every set of threads.
    fn tried(pattern: &WeavePattern) -> bool {
        let (ends, picks) = (pattern.ends(), pattern.picks());
        let all = (1u32 << (ends + picks)) - 1;
        (1..all).any(|set| {
            let end_on_top = |end: u32| set >> end & 1 == 1;
            let pick_on_top = |pick: u32| set >> (ends + pick) & 1 == 1;
            (0..ends).all(|end| {
                (0..picks).all(|pick| match (end_on_top(end), pick_on_top(pick)) {
                    (true, false) => pattern.get(end, pick),
                    (false, true) => !pattern.get(end, pick),
                    _ => true,
                })
            })
        })
    }

    #[test]
    fn a_double_cloth_lifts_apart_and_its_single_weave_does_not() {
        let plain = weave("plain").unwrap();
        assert_eq!(loose_layer(&plain), None);
        let double = double_cloth(&plain, &plain).unwrap();
        assert_eq!(loose_layer(&double), Some(Layer { ends: 2, picks: 2 }));
        // One stitch holds it.
        let mut stitched = double.clone();
        let back = (0..4)
            .find(|&pick| pick % 2 == 0 && !double.get(1, pick))
            .unwrap();
        stitched.set(1, back, true);
        assert_eq!(loose_layer(&stitched), None);
    }

    proptest! {
        #[test]
        fn sums_find_what_trying_every_set_finds(
            ends in 1u32..5, picks in 1u32..5, bits: u32
        ) {
            let pattern = WeavePattern::from_fn(ends, picks, |end, pick| {
                bits >> (end + ends * pick) & 1 == 1
            });
            prop_assert_eq!(loose_layer(&pattern).is_some(), tried(&pattern));
        }
    }
}
