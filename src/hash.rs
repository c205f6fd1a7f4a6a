//! The one bit mixer that every hash-based random number of the library is made with.

/// splitmix64's finaliser: a bijection of 64 bits in which every bit of the input moves
/// about half of the output.
#[inline]
pub fn mix(bits: u64) -> u64 {
    let bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    bits ^ (bits >> 31)
}
