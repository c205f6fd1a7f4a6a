//! Bytes damaged at random, the same in every run.

use crate::random::Random;

/// `bytes` cut short, changed, shortened in the middle and with some of `pieces` put in; the
/// same for the same `seed`.
pub fn damaged(bytes: &[u8], seed: u64, pieces: &[&[u8]]) -> Vec<u8> {
    let mut random = Random::new(seed, 0, 0);
    let mut below = |most: usize| (random.bits() % (most as u64 + 1)) as usize;
    let mut bytes = bytes.to_vec();
    for _ in 0..=below(3) {
        let at = below(bytes.len());
        match below(3) {
            0 => bytes.truncate(bytes.len() - below(bytes.len() / 4)),
            1 if at < bytes.len() => bytes[at] = below(255) as u8,
            2 if at < bytes.len() => {
                let to = (at + below(39)).min(bytes.len());
                bytes.drain(at..to);
            }
            _ => {
                let piece = pieces.get(below(pieces.len().saturating_sub(1)));
                let piece = piece.copied().unwrap_or_default();
                bytes.splice(at..at, piece.iter().copied());
            }
        }
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn damage_is_the_same_again_and_nearly_always_some() {
        let whole: Vec<u8> = (0..=255).collect();
        let pieces: [&[u8]; 2] = [b"[x]", b"-1"];
        let changed = (0..100).filter(|&seed| {
            let once = damaged(&whole, seed, &pieces);
            assert_eq!(once, damaged(&whole, seed, &pieces));
            once != whole
        });
        assert!(changed.count() > 90);
        assert!(damaged(&[], 3, &[]).is_empty());
    }
}
