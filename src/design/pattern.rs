//! The weave pattern: one bit a crossing, in copy-on-write tiles.

use std::sync::Arc;

const TILE: u32 = 64;

/// A tile of 64×64 crossings: one word a pick, bit = end.
type Tile = [u64; TILE as usize];

/// A binary weave pattern; `true` = warp on top (on the face). Zhao 2012 §3, §5.1.
///
/// End 0 is the left column and pick 0 the bottom row, seen on the face. Tiles are
/// shared between clones until written, so a snapshot is cheap.
#[derive(Clone, PartialEq, Eq)]
pub struct WeavePattern {
    ends: u32,
    picks: u32,
    tiles: Vec<Arc<Tile>>,
}

impl WeavePattern {
    /// All weft up, `ends` × `picks` crossings (each at least 1).
    pub fn new(ends: u32, picks: u32) -> Self {
        let (ends, picks) = (ends.max(1), picks.max(1));
        let blank = Arc::new([0u64; TILE as usize]);
        let count = ends.div_ceil(TILE) as usize * picks.div_ceil(TILE) as usize;
        Self {
            ends,
            picks,
            tiles: vec![blank; count],
        }
    }

    /// The pattern whose crossing (end, pick) is `warp_up(end, pick)`.
    pub fn from_fn(ends: u32, picks: u32, mut warp_up: impl FnMut(u32, u32) -> bool) -> Self {
        let mut pattern = Self::new(ends, picks);
        for pick in 0..pattern.picks {
            for end in 0..pattern.ends {
                if warp_up(end, pick) {
                    pattern.set(end, pick, true);
                }
            }
        }
        pattern
    }

    /// Number of ends (columns).
    pub fn ends(&self) -> u32 {
        self.ends
    }

    /// Number of picks (rows).
    pub fn picks(&self) -> u32 {
        self.picks
    }

    fn tile(&self, end: u32, pick: u32) -> usize {
        (pick / TILE) as usize * self.ends.div_ceil(TILE) as usize + (end / TILE) as usize
    }

    /// Whether the warp is on top at a crossing inside the pattern.
    pub fn get(&self, end: u32, pick: u32) -> bool {
        debug_assert!(end < self.ends && pick < self.picks);
        self.tiles[self.tile(end, pick)][(pick % TILE) as usize] >> (end % TILE) & 1 == 1
    }

    /// Whether the warp is on top at any crossing of the straight repeat.
    pub fn get_wrapped(&self, end: i64, pick: i64) -> bool {
        self.get(
            end.rem_euclid(i64::from(self.ends)) as u32,
            pick.rem_euclid(i64::from(self.picks)) as u32,
        )
    }

    /// Puts the warp (`true`) or the weft on top at a crossing.
    pub fn set(&mut self, end: u32, pick: u32, warp_up: bool) {
        debug_assert!(end < self.ends && pick < self.picks);
        let tile = self.tile(end, pick);
        if self.get(end, pick) != warp_up {
            Arc::make_mut(&mut self.tiles[tile])[(pick % TILE) as usize] ^= 1 << (end % TILE);
        }
    }
}
