//! The weave pattern: one bit a crossing, in copy-on-write tiles.

use crate::memory::{self, TooMuch};
use std::fmt;
use std::sync::Arc;

use crate::limits;

use super::tiles::{TILE, Tiles};

/// The most crossings a pattern, map or drawdown may have (2²⁹, 64 MiB of bits): sixteen
/// times the largest loom file seen (5120 × 6300), and a panel of 16 000 × 20 000 with room
/// around it. A crossing's number, and four times that, fit into 32 bits.
pub const MAX_CROSSINGS: u64 = limits::CROSSINGS;

/// The most ends, and the most picks.
const THREADS: u64 = limits::THREADS;

/// A tile of 64×64 crossings: one word a pick, bit = end.
type Tile = [u64; TILE as usize];

/// A size that cannot be a design.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum SizeError {
    /// No ends or no picks.
    #[error("{ends} ends × {picks} picks is no cloth: give at least one of each")]
    Empty {
        /// Ends asked for.
        ends: u64,
        /// Picks asked for.
        picks: u64,
    },
    /// More crossings than [`MAX_CROSSINGS`].
    #[error(
        "{ends} ends × {picks} picks are too many crossings (the most is {MAX_CROSSINGS}): \
         cut the design into parts"
    )]
    TooLarge {
        /// Ends asked for.
        ends: u64,
        /// Picks asked for.
        picks: u64,
    },
    /// More ends or picks than [`limits::THREADS`].
    #[error(
        "{ends} ends × {picks} picks are too many threads (the most is {THREADS} either way): \
         cut the design into parts"
    )]
    TooLong {
        /// Ends asked for.
        ends: u64,
        /// Picks asked for.
        picks: u64,
    },
    /// More crossings than there is memory for.
    #[error("{}", TooMuch {
        what: format!("{ends} ends × {picks} picks"), needed: *needed, budget: *budget
    })]
    Memory {
        /// Ends asked for.
        ends: u64,
        /// Picks asked for.
        picks: u64,
        /// Bytes they would take.
        needed: u64,
        /// Bytes that may be taken.
        budget: u64,
    },
}

/// Bytes a crossing of a design: its region or its yarn, and the weave.
const CROSSING_BYTES: u64 = 3;

/// Bytes of what is known of a thread: its place, its yarn, its course.
const THREAD_BYTES: u64 = 200;

/// Refuses sizes that are empty, beyond [`MAX_CROSSINGS`] or beyond the memory that may be
/// used, before any is taken.
pub(crate) fn check_size(ends: u64, picks: u64) -> Result<(), SizeError> {
    if ends == 0 || picks == 0 {
        return Err(SizeError::Empty { ends, picks });
    }
    match ends.checked_mul(picks) {
        Some(crossings) if crossings <= MAX_CROSSINGS => {
            if ends.max(picks) > THREADS {
                return Err(SizeError::TooLong { ends, picks });
            }
            let needed = crossings * CROSSING_BYTES + (ends + picks) * THREAD_BYTES;
            let asked = memory::ask(needed, String::new);
            asked.map_err(|refused| SizeError::Memory {
                ends,
                picks,
                needed: refused.needed,
                budget: refused.budget,
            })
        }
        _ => Err(SizeError::TooLarge { ends, picks }),
    }
}

/// ASCII art that is not a pattern.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ArtError {
    /// A character that stands for nothing.
    #[error("line {line}, column {column}: '{found}' is neither '#' (warp up) nor '.' (weft up)")]
    Character {
        /// Line, from 1 at the top.
        line: usize,
        /// Column, from 1 at the left.
        column: usize,
        /// What stands there.
        found: char,
    },
    /// A line of another length than the first.
    #[error("line {line} has {found} crossings where the lines above have {expected}")]
    Ragged {
        /// Line, from 1 at the top.
        line: usize,
        /// Crossings in this line.
        found: usize,
        /// Crossings in the first line.
        expected: usize,
    },
    /// Nothing, or too much.
    #[error(transparent)]
    Size(#[from] SizeError),
}

/// A binary weave pattern; `true` = warp on top (on the face). Zhao 2012 §3, §5.1.
///
/// End 0 is the left column and pick 0 the bottom row, seen on the face. Tiles are
/// shared between clones until written, so a snapshot is cheap. Bits outside the pattern
/// are always zero.
#[derive(Clone, PartialEq, Eq)]
pub struct WeavePattern {
    ends: u32,
    picks: u32,
    tiles: Tiles<Tile>,
}

impl WeavePattern {
    /// All weft up, `ends` × `picks` crossings (each at least 1).
    ///
    /// For sizes the program chose; sizes from a file go through
    /// [`WeavePattern::try_new`].
    pub fn new(ends: u32, picks: u32) -> Self {
        let (ends, picks) = (ends.max(1), picks.max(1));
        let blank = Arc::new([0u64; TILE as usize]);
        Self {
            ends,
            picks,
            tiles: Tiles::filled(ends, picks, blank),
        }
    }

    /// All weft up, for a size that comes from outside.
    ///
    /// # Errors
    /// [`SizeError`] for no crossings or more than [`MAX_CROSSINGS`], before any memory
    /// is asked for.
    pub fn try_new(ends: u64, picks: u64) -> Result<Self, SizeError> {
        check_size(ends, picks)?;
        match (u32::try_from(ends), u32::try_from(picks)) {
            (Ok(ends), Ok(picks)) => Ok(Self::new(ends, picks)),
            _ => Err(SizeError::TooLarge { ends, picks }),
        }
    }

    /// The pattern whose crossing (end, pick) is `warp_up(end, pick)`, asked pick by pick
    /// from the bottom, each from left to right.
    pub fn from_fn(ends: u32, picks: u32, mut warp_up: impl FnMut(u32, u32) -> bool) -> Self {
        let mut pattern = Self::new(ends, picks);
        for pick in 0..pattern.picks {
            for word in 0..pattern.words_per_pick() {
                let first = word * TILE;
                let bits = (first..(first + TILE).min(pattern.ends))
                    .map(|end| u64::from(warp_up(end, pick)) << (end - first))
                    .fold(0, |word, bit| word | bit);
                pattern.set_pick_word(word, pick, bits);
            }
        }
        pattern
    }

    /// Reads ASCII art: `#` (or `1`, `X`) = warp up, `.` (or `0`, `-`) = weft up, blanks
    /// ignored, one line a pick; the *last* line is pick 0.
    ///
    /// # Errors
    /// [`ArtError`] for another character, lines of unequal length, or nothing at all.
    pub fn parse(art: &str) -> Result<Self, ArtError> {
        let mut rows: Vec<Vec<bool>> = Vec::new();
        for (line, text) in art.lines().enumerate() {
            let mut row = Vec::new();
            for (column, symbol) in text.chars().enumerate() {
                match symbol {
                    '#' | '1' | 'X' | 'x' => row.push(true),
                    '.' | '0' | '-' => row.push(false),
                    blank if blank.is_whitespace() => {}
                    found => {
                        let (line, column) = (line + 1, column + 1);
                        return Err(ArtError::Character {
                            line,
                            column,
                            found,
                        });
                    }
                }
            }
            if row.is_empty() {
                continue;
            }
            if let Some(first) = rows.first()
                && first.len() != row.len()
            {
                return Err(ArtError::Ragged {
                    line: line + 1,
                    found: row.len(),
                    expected: first.len(),
                });
            }
            rows.push(row);
        }
        let ends = rows.first().map_or(0, Vec::len);
        check_size(ends as u64, rows.len() as u64)?;
        rows.reverse();
        Ok(Self::from_fn(
            ends as u32,
            rows.len() as u32,
            |end, pick| rows[pick as usize][end as usize],
        ))
    }

    /// Number of ends (columns).
    pub fn ends(&self) -> u32 {
        self.ends
    }

    /// Number of picks (rows).
    pub fn picks(&self) -> u32 {
        self.picks
    }

    /// Whether the warp is on top at a crossing inside the pattern.
    pub fn get(&self, end: u32, pick: u32) -> bool {
        debug_assert!(end < self.ends && pick < self.picks);
        self.tiles.at(end, pick)[(pick % TILE) as usize] >> (end % TILE) & 1 == 1
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
        if self.get(end, pick) != warp_up {
            let tile = Arc::make_mut(self.tiles.slot(end, pick));
            tile[(pick % TILE) as usize] ^= 1 << (end % TILE);
        }
    }

    /// Words of 64 crossings in a pick.
    pub fn words_per_pick(&self) -> u32 {
        self.ends.div_ceil(TILE)
    }

    /// Words of 64 crossings in an end.
    pub fn words_per_end(&self) -> u32 {
        self.picks.div_ceil(TILE)
    }

    /// The crossings of ends 64·`word` … 64·`word`+63 along a pick; bit 0 = the leftmost.
    pub fn pick_word(&self, word: u32, pick: u32) -> u64 {
        self.tiles.at(word * TILE, pick)[(pick % TILE) as usize]
    }

    /// Writes 64 crossings of a pick at once; bits beyond the last end are dropped.
    pub fn set_pick_word(&mut self, word: u32, pick: u32, bits: u64) {
        let width = self.ends.saturating_sub(word * TILE);
        let bits = if width < TILE {
            bits & ((1 << width) - 1)
        } else {
            bits
        };
        if self.pick_word(word, pick) != bits {
            let tile = Arc::make_mut(self.tiles.slot(word * TILE, pick));
            tile[(pick % TILE) as usize] = bits;
        }
    }

    /// The words of a pick from left to right; bits beyond the last end are zero.
    pub fn pick_words(&self, pick: u32) -> impl Iterator<Item = u64> + '_ {
        (0..self.words_per_pick()).map(move |word| self.pick_word(word, pick))
    }

    /// Ends and picks exchanged: crossing (a, b) becomes (b, a). The warp stays `true`.
    pub fn transposed(&self) -> Self {
        let (columns, rows) = (self.words_per_pick(), self.words_per_end());
        let turned = |column, row| {
            let tile = self.tiles.at(column * TILE, row * TILE);
            Arc::new(transpose_tile(tile))
        };
        let row = |column| (0..rows).map(|row| turned(column, row)).collect();
        Self {
            ends: self.picks,
            picks: self.ends,
            tiles: Tiles::from_rows((0..columns).map(row)),
        }
    }

    /// Warp and weft exchanged on the face: every bit inverted.
    pub fn inverted(&self) -> Self {
        self.map_words(|bits| !bits)
    }

    fn map_words(&self, change: impl Fn(u64) -> u64) -> Self {
        let mut result = Self::new(self.ends, self.picks);
        for pick in 0..self.picks {
            for word in 0..self.words_per_pick() {
                result.set_pick_word(word, pick, change(self.pick_word(word, pick)));
            }
        }
        result
    }

    /// The straight repeat of this pattern cut to `ends` × `picks`, its own crossing
    /// (0, 0) at `origin`.
    pub fn repeated(&self, ends: u32, picks: u32, origin: (i32, i32)) -> Self {
        let mut result = Self::new(ends, picks);
        for pick in 0..result.picks {
            // Picks come again after one repeat.
            let earlier = pick.checked_sub(self.picks);
            let row = i64::from(pick) - i64::from(origin.1);
            for word in 0..result.words_per_pick() {
                let bits = match earlier {
                    Some(earlier) => result.pick_word(word, earlier),
                    None => self.word_wrapped(
                        i64::from(word * TILE) - i64::from(origin.0),
                        row.rem_euclid(i64::from(self.picks)) as u32,
                    ),
                };
                result.set_pick_word(word, pick, bits);
            }
        }
        result
    }

    /// 64 crossings of the straight repeat along a pick, from end `first` on.
    fn word_wrapped(&self, first: i64, pick: u32) -> u64 {
        let mut end = first.rem_euclid(i64::from(self.ends)) as u32;
        let mut bits = 0;
        for place in 0..TILE {
            bits |= u64::from(self.get(end, pick)) << place;
            end = if end + 1 == self.ends { 0 } else { end + 1 };
        }
        bits
    }

    /// The pattern seen in a mirror (left and right exchanged): Z twill becomes S.
    pub fn mirrored(&self) -> Self {
        Self::from_fn(self.ends, self.picks, |end, pick| {
            self.get(self.ends - 1 - end, pick)
        })
    }

    /// The 64 × 64 blocks of crossings (column and row of blocks, from the bottom left)
    /// that are not the very same memory in `other`: all that may differ. `None` if the
    /// sizes do.
    pub fn unshared<'t>(
        &'t self,
        other: &'t Self,
    ) -> Option<impl Iterator<Item = (u32, u32)> + 't> {
        let same = (self.ends, self.picks) == (other.ends, other.picks);
        same.then(|| self.tiles.unshared(&other.tiles))
    }

    /// Bytes of memory that this pattern does not share with `other`.
    pub fn bytes_beyond(&self, other: Option<&Self>) -> usize {
        let other = other.map(|other| &other.tiles);
        self.tiles.bytes_beyond(other, size_of::<Tile>())
    }

    /// The crossings (end, pick) that differ from an earlier pattern, in no order to rely
    /// on; tiles that both share are not looked into. `None` where the sizes differ or
    /// more than `most` crossings do.
    pub fn changed_since(&self, earlier: &Self, most: usize) -> Option<Vec<(u32, u32)>> {
        let mut changed = Vec::new();
        for (column, row) in self.unshared(earlier)? {
            for pick in row * TILE..((row + 1) * TILE).min(self.picks) {
                let mut bits = self.pick_word(column, pick) ^ earlier.pick_word(column, pick);
                while bits != 0 {
                    changed.push((column * TILE + bits.trailing_zeros(), pick));
                    bits &= bits - 1;
                }
            }
            if changed.len() > most {
                return None;
            }
        }
        Some(changed)
    }

    /// Number of crossings with the warp on top.
    pub fn count_warp_up(&self) -> u64 {
        self.tiles
            .iter()
            .flat_map(|tile| tile.iter())
            .map(|word| u64::from(word.count_ones()))
            .sum()
    }
}

/// Transposes 64×64 bits by exchanging ever smaller quarters (Warren, Hacker's Delight
/// 2nd ed., §7-3, for least significant bit = left).
fn transpose_tile(tile: &Tile) -> Tile {
    let mut rows = *tile;
    let mut size = 32;
    let mut mask = u64::MAX >> 32;
    while size > 0 {
        let mut row = 0;
        while row < TILE as usize {
            let swap = (rows[row] >> size ^ rows[row + size]) & mask;
            rows[row] ^= swap << size;
            rows[row + size] ^= swap;
            row = (row + size + 1) & !size;
        }
        size >>= 1;
        mask ^= mask << size;
    }
    rows
}

/// ASCII art: `#` = warp up, `.` = weft up, one line a pick, the last line is pick 0.
impl fmt::Display for WeavePattern {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        for pick in (0..self.picks).rev() {
            let line: String = (0..self.ends)
                .map(|end| if self.get(end, pick) { '#' } else { '.' })
                .collect();
            writeln!(out, "{line}")?;
        }
        Ok(())
    }
}

impl fmt::Debug for WeavePattern {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "WeavePattern {}×{}", self.ends, self.picks)?;
        if self.ends <= 64 && self.picks <= 64 {
            write!(out, "\n{self}")?;
        }
        Ok(())
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;

    fn noise(ends: u32, picks: u32) -> WeavePattern {
        let mut state = 0x9e37_79b9_7f4a_7c15_u64;
        WeavePattern::from_fn(ends, picks, |_, _| {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            state & 4 == 0
        })
    }

    #[test]
    fn art_is_read_from_the_top_and_printed_back() {
        let art = "..#\n#..\n";
        let pattern = WeavePattern::parse(art).unwrap();
        assert!(pattern.get(0, 0) && pattern.get(2, 1) && !pattern.get(0, 1));
        assert_eq!(pattern.to_string(), art);
        assert_ne!(pattern.to_string(), "#..\n..#\n");
    }

    #[test]
    fn bad_art_names_the_place() {
        let message = |art| WeavePattern::parse(art).unwrap_err().to_string();
        assert!(message("##\n#?").contains("line 2, column 2"));
        assert!(message("##\n#").contains("line 2 has 1"));
        assert!(message("  \n").contains("no cloth"));
    }

    #[test]
    fn sizes_from_outside_are_checked_before_memory() {
        assert!(WeavePattern::try_new(1 << 14, 1 << 14).is_ok());
        assert!(WeavePattern::try_new((1 << 15) + 1, 1 << 14).is_err());
        assert!(WeavePattern::try_new(u64::MAX, u64::MAX).is_err());
        assert!(WeavePattern::try_new(0, 5).is_err());
    }

    #[test]
    fn words_columns_and_transposition_agree_with_single_crossings() {
        let pattern = noise(131, 70);
        let flipped = pattern.transposed();
        assert_eq!((flipped.ends(), flipped.picks()), (70, 131));
        for end in 0..131 {
            let column: Vec<u64> = flipped.pick_words(end).collect();
            for pick in 0..70 {
                let bit = column[(pick / 64) as usize] >> (pick % 64) & 1 == 1;
                assert_eq!(bit, pattern.get(end, pick));
                assert_eq!(flipped.get(pick, end), pattern.get(end, pick));
            }
        }
        assert_eq!(flipped.transposed(), pattern);
        assert_ne!(noise(70, 70).transposed(), noise(70, 70));
    }

    #[test]
    fn bits_outside_the_pattern_stay_zero() {
        let mut pattern = WeavePattern::new(3, 2).inverted();
        pattern.set_pick_word(0, 0, u64::MAX);
        assert_eq!(pattern.count_warp_up(), 6);
        assert_eq!(pattern, WeavePattern::from_fn(3, 2, |_, _| true));
    }

    #[test]
    fn a_clone_does_not_see_later_edits() {
        let mut pattern = noise(200, 200);
        let snapshot = pattern.clone();
        let before = pattern.get(150, 150);
        pattern.set(150, 150, !before);
        assert_eq!(snapshot.get(150, 150), before);
        assert_ne!(snapshot, pattern);
    }
}
