//! Files damaged at random, the same in every run.

/// Numbers for a mutation, from a counter.
fn hash(counter: u64) -> u64 {
    let mut x = counter.wrapping_add(0x9e37_79b9_7f4a_7c15);
    x = (x ^ x >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ x >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ x >> 31
}

/// Bytes cut short, changed, shortened in the middle and with `pieces` put in.
pub fn mutated(bytes: &[u8], seed: u64, pieces: &[&[u8]]) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    for step in 0..=hash(seed) % 4 {
        let pick = hash(seed * 31 + step);
        let at = (pick >> 8) as usize % (bytes.len() + 1);
        match pick % 4 {
            0 => bytes.truncate(bytes.len() - (pick >> 40) as usize % (bytes.len() / 4 + 1)),
            1 if at < bytes.len() => bytes[at] = (pick >> 48) as u8,
            2 if at < bytes.len() => {
                let to = (at + (pick >> 40) as usize % 40).min(bytes.len());
                bytes.drain(at..to);
            }
            _ => {
                let piece = pieces[(pick >> 32) as usize % pieces.len()];
                bytes.splice(at..at, piece.iter().copied());
            }
        }
    }
    bytes
}
