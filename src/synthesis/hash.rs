//! Random numbers of the synthesis: hashes, so that no result depends on order.

use crate::hash::mix;

/// A well mixed word from a seed and two coordinates (two rounds of splitmix64).
#[inline]
pub(super) fn hash(seed: u64, a: u64, b: u64) -> u64 {
    step(step(seed ^ a.wrapping_mul(0x9e37_79b9_7f4a_7c15)) ^ b.wrapping_mul(0xd1b5_4a32_d192_ed03))
}

/// One step of splitmix64.
#[inline]
fn step(word: u64) -> u64 {
    mix(word.wrapping_add(0x9e37_79b9_7f4a_7c15))
}

/// An index below `count` (at least 1) from a hash.
#[inline]
pub(super) fn index_below(hash: u64, count: usize) -> usize {
    (((hash >> 32) * count as u64) >> 32) as usize
}
