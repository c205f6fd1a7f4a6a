//! A set of crossings: what a stroke, a fill or a selection covers.

use crate::design::WeavePattern;

/// A box of crossings, `ends` wide and `picks` high from (`end`, `pick`).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Rect {
    /// Its leftmost end.
    pub end: u32,
    /// Its lowest pick.
    pub pick: u32,
    /// Ends across.
    pub ends: u32,
    /// Picks along.
    pub picks: u32,
}

impl Rect {
    /// A single crossing.
    pub fn one(end: u32, pick: u32) -> Self {
        let (ends, picks) = (1, 1);
        Self {
            end,
            pick,
            ends,
            picks,
        }
    }

    /// The least box that holds both.
    pub fn join(self, other: Self) -> Self {
        let (end, pick) = (self.end.min(other.end), self.pick.min(other.pick));
        let right = (self.end + self.ends).max(other.end + other.ends);
        let top = (self.pick + self.picks).max(other.pick + other.picks);
        Self {
            end,
            pick,
            ends: right - end,
            picks: top - pick,
        }
    }

    /// Whether a crossing lies in it.
    pub fn contains(self, end: u32, pick: u32) -> bool {
        end >= self.end
            && pick >= self.pick
            && end - self.end < self.ends
            && pick - self.pick < self.picks
    }
}

/// A set of crossings of a design, one bit each in tiles: a stroke costs a few tiles, and
/// the largest selection no more than a drawdown.
#[derive(Debug, Clone)]
pub struct Cells {
    bits: WeavePattern,
    /// What `bits` began as: tiles that are still its own hold nothing.
    blank: WeavePattern,
}

impl Cells {
    /// No crossings yet, of a design of `ends` × `picks` (each at least 1).
    pub fn none(ends: u32, picks: u32) -> Self {
        let bits = WeavePattern::new(ends, picks);
        let blank = bits.clone();
        Self { bits, blank }
    }

    /// These crossings (end, pick); those outside the design are left out.
    pub fn of(ends: u32, picks: u32, crossings: impl IntoIterator<Item = (u32, u32)>) -> Self {
        let mut cells = Self::none(ends, picks);
        for (end, pick) in crossings {
            cells.insert(end, pick);
        }
        cells
    }

    /// The part of a box that lies in the design.
    pub fn of_rect(ends: u32, picks: u32, rect: Rect) -> Self {
        let mut cells = Self::none(ends, picks);
        let right = rect.end.saturating_add(rect.ends).min(cells.bits.ends());
        let top = rect.pick.saturating_add(rect.picks).min(cells.bits.picks());
        if rect.end >= right {
            return cells;
        }
        for pick in rect.pick..top {
            for word in rect.end / 64..right.div_ceil(64) {
                let from = rect.end.saturating_sub(64 * word);
                let width = (right - 64 * word).min(64) - from;
                let bits = u64::MAX >> (64 - width) << from;
                cells.insert_word(word, pick, bits);
            }
        }
        cells
    }

    /// Every crossing.
    pub fn all(ends: u32, picks: u32) -> Self {
        Self::of_rect(
            ends,
            picks,
            Rect {
                end: 0,
                pick: 0,
                ends,
                picks,
            },
        )
    }

    /// The crossings where a pattern has the warp up.
    pub fn of_pattern(pattern: &WeavePattern) -> Self {
        let blank = WeavePattern::new(pattern.ends(), pattern.picks());
        let bits = pattern.clone();
        Self { bits, blank }
    }

    /// One crossing more; false if it was there or lies outside the design.
    pub fn insert(&mut self, end: u32, pick: u32) -> bool {
        let new = end < self.bits.ends() && pick < self.bits.picks() && !self.bits.get(end, pick);
        if new {
            self.bits.set(end, pick, true);
        }
        new
    }

    /// Up to 64 crossings more: those of `bits` from end 64·`word` on.
    pub fn insert_word(&mut self, word: u32, pick: u32, bits: u64) {
        if bits != 0 && word < self.bits.words_per_pick() && pick < self.bits.picks() {
            let before = self.bits.pick_word(word, pick);
            self.bits.set_pick_word(word, pick, before | bits);
        }
    }

    /// Takes one crossing out.
    pub fn remove(&mut self, end: u32, pick: u32) {
        if self.contains(end, pick) {
            self.bits.set(end, pick, false);
        }
    }

    /// Whether a crossing is in the set.
    pub fn contains(&self, end: u32, pick: u32) -> bool {
        end < self.bits.ends() && pick < self.bits.picks() && self.bits.get(end, pick)
    }

    /// Ends and picks of the design.
    pub fn size(&self) -> (u32, u32) {
        (self.bits.ends(), self.bits.picks())
    }

    /// Words with crossings in them: (word, pick, bits), see [`WeavePattern::pick_word`].
    pub fn words(&self) -> impl Iterator<Item = (u32, u32, u64)> + '_ {
        let tiles = self.bits.unshared(&self.blank).into_iter().flatten();
        tiles.flat_map(move |(column, row)| {
            let picks = 64 * row..(64 * row + 64).min(self.bits.picks());
            picks
                .map(move |pick| (column, pick, self.bits.pick_word(column, pick)))
                .filter(|&(_, _, bits)| bits != 0)
        })
    }

    /// The crossings (end, pick), tile by tile.
    pub fn iter(&self) -> impl Iterator<Item = (u32, u32)> + '_ {
        self.words().flat_map(|(word, pick, bits)| {
            (0..64)
                .filter(move |&bit| bits >> bit & 1 == 1)
                .map(move |bit| (64 * word + bit, pick))
        })
    }

    /// How many crossings there are.
    pub fn count(&self) -> u64 {
        self.words()
            .map(|(_, _, bits)| u64::from(bits.count_ones()))
            .sum()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.words().next().is_none()
    }

    /// The least box that holds them all.
    pub fn bounds(&self) -> Option<Rect> {
        self.words()
            .map(|(word, pick, bits)| Rect {
                end: 64 * word + bits.trailing_zeros(),
                pick,
                ends: 64 - bits.leading_zeros() - bits.trailing_zeros(),
                picks: 1,
            })
            .reduce(Rect::join)
    }

    /// One bit a crossing.
    pub fn bits(&self) -> &WeavePattern {
        &self.bits
    }

    /// Adds the crossings of another set of the same design.
    pub fn extend(&mut self, other: &Self) {
        for (word, pick, bits) in other.words() {
            self.insert_word(word, pick, bits);
        }
    }

    /// Takes out the crossings of another set.
    pub fn subtract(&mut self, other: &Self) {
        for (word, pick, bits) in other.words() {
            if word < self.bits.words_per_pick() && pick < self.bits.picks() {
                let before = self.bits.pick_word(word, pick);
                self.bits.set_pick_word(word, pick, before & !bits);
            }
        }
    }

    /// The crossings that are not in the set.
    pub fn inverted(&self) -> Self {
        Self::of_pattern(&self.bits.inverted())
    }
}

impl PartialEq for Cells {
    fn eq(&self, other: &Self) -> bool {
        self.bits == other.bits
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_hold_what_was_put_in_and_nothing_else() {
        let wanted = [(0, 0), (63, 1), (64, 1), (129, 199), (0, 0)];
        let mut cells = Cells::of(130, 200, wanted.into_iter().chain([(130, 0), (0, 200)]));
        assert_eq!(cells.count(), 4);
        let mut found: Vec<_> = cells.iter().collect();
        found.sort_unstable();
        assert_eq!(found, [(0, 0), (63, 1), (64, 1), (129, 199)]);
        let all = Rect {
            end: 0,
            pick: 0,
            ends: 130,
            picks: 200,
        };
        assert_eq!(cells.bounds(), Some(all));
        cells.remove(129, 199);
        assert_eq!(
            cells.bounds(),
            Some(Rect {
                end: 0,
                pick: 0,
                ends: 65,
                picks: 2
            })
        );
        assert_eq!(cells.inverted().count(), 130 * 200 - 3);
    }

    #[test]
    fn a_box_is_its_crossings() {
        let rect = Rect {
            end: 60,
            pick: 3,
            ends: 70,
            picks: 2,
        };
        let cells = Cells::of_rect(128, 10, rect);
        for pick in 0..10 {
            for end in 0..128 {
                assert_eq!(cells.contains(end, pick), rect.contains(end, pick));
            }
        }
        assert!(Cells::of_rect(128, 10, Rect { end: 128, ..rect }).is_empty());
        assert_eq!(Cells::all(65, 3).count(), 195);
    }
}
