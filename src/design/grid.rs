//! A grid of small values, one a crossing, in copy-on-write tiles.

use std::sync::Arc;

use super::pattern::{SizeError, check_size};
use super::tiles::{TILE, Tiles};

/// Values by crossing, in 64×64 tiles that clones share until they are written.
///
/// Used for the region of every crossing and for yarns that change along their length.
#[derive(Debug, Clone)]
pub struct Grid<T> {
    ends: u32,
    picks: u32,
    tiles: Tiles<[T]>,
}

impl<T: Copy + PartialEq> Grid<T> {
    /// A grid of `ends` × `picks` crossings that all hold `value`.
    ///
    /// # Errors
    /// [`SizeError`] for no crossings or more than [`super::MAX_CROSSINGS`], before any
    /// memory is asked for.
    pub fn filled(ends: u32, picks: u32, value: T) -> Result<Self, SizeError> {
        check_size(u64::from(ends), u64::from(picks))?;
        let blank: Arc<[T]> = vec![value; (TILE * TILE) as usize].into();
        Ok(Self {
            ends,
            picks,
            tiles: Tiles::filled(ends, picks, blank),
        })
    }

    /// The grid whose crossing (end, pick) holds `value(end, pick)`, asked in any order.
    ///
    /// # Errors
    /// [`SizeError`], as for [`Grid::filled`].
    pub fn from_fn(
        ends: u32,
        picks: u32,
        mut value: impl FnMut(u32, u32) -> T,
    ) -> Result<Self, SizeError> {
        check_size(u64::from(ends), u64::from(picks))?;
        let usual = value(0, 0);
        let mut grid = Self::filled(ends, picks, usual)?;
        let mut cells = Vec::with_capacity((TILE * TILE) as usize);
        for bottom in (0..picks).step_by(TILE as usize) {
            for left in (0..ends).step_by(TILE as usize) {
                cells.clear();
                for pick in bottom..bottom + TILE {
                    for end in left..left + TILE {
                        let inside = end < ends && pick < picks;
                        cells.push(if inside { value(end, pick) } else { usual });
                    }
                }
                if cells.iter().any(|&cell| cell != usual) {
                    *grid.tiles.slot(left, bottom) = cells.as_slice().into();
                }
            }
        }
        Ok(grid)
    }

    /// Number of ends (columns).
    pub fn ends(&self) -> u32 {
        self.ends
    }

    /// Number of picks (rows).
    pub fn picks(&self) -> u32 {
        self.picks
    }

    /// The value at a crossing inside the grid.
    pub fn get(&self, end: u32, pick: u32) -> T {
        self.tiles.at(end, pick)[cell(end, pick)]
    }

    /// The value at any crossing of the straight repeat.
    pub fn get_wrapped(&self, end: i64, pick: i64) -> T {
        self.get(
            end.rem_euclid(i64::from(self.ends)) as u32,
            pick.rem_euclid(i64::from(self.picks)) as u32,
        )
    }

    /// Writes one crossing; its tile is copied first if a clone shares it.
    pub fn set(&mut self, end: u32, pick: u32, value: T) {
        if self.get(end, pick) != value {
            Arc::make_mut(self.tiles.slot(end, pick))[cell(end, pick)] = value;
        }
    }

    /// The values of ends 64·`word` … 64·`word`+63 along a pick, fewer at the right edge.
    pub fn pick_values(&self, word: u32, pick: u32) -> &[T] {
        let width = (self.ends - word * TILE).min(TILE);
        let first = cell(0, pick);
        &self.tiles.at(word * TILE, pick)[first..first + width as usize]
    }

    /// Puts `to(value)` in the place of every value.
    pub(crate) fn replace_values(&mut self, to: impl Fn(T) -> T) {
        self.tiles.replace(|tile| {
            if tile.iter().all(|&value| to(value) == value) {
                return Arc::clone(tile);
            }
            tile.iter().map(|&value| to(value)).collect()
        });
    }

    /// The 64 × 64 blocks that are not the very same memory in `other`; see
    /// [`super::WeavePattern::unshared`].
    pub fn unshared<'t>(
        &'t self,
        other: &'t Self,
    ) -> Option<impl Iterator<Item = (u32, u32)> + 't> {
        let same = (self.ends, self.picks) == (other.ends, other.picks);
        same.then(|| self.tiles.unshared(&other.tiles))
    }

    /// Bytes of memory that this grid does not share with `other`.
    pub fn bytes_beyond(&self, other: Option<&Self>) -> usize {
        let tile = (TILE * TILE) as usize * size_of::<T>();
        let other = other.map(|other| &other.tiles);
        self.tiles.bytes_beyond(other, tile)
    }

    /// All values, pick by pick from the bottom, each from left to right.
    pub fn iter(&self) -> impl Iterator<Item = T> + '_ {
        (0..self.picks).flat_map(move |pick| (0..self.ends).map(move |end| self.get(end, pick)))
    }
}

impl<T: Copy + PartialEq + Ord> Grid<T> {
    /// The largest value.
    pub fn max(&self) -> Option<T> {
        let words = self.ends.div_ceil(TILE);
        let picks = (0..self.picks).flat_map(|pick| (0..words).map(move |word| (word, pick)));
        picks
            .filter_map(|(word, pick)| self.pick_values(word, pick).iter().copied().max())
            .max()
    }
}

/// The values of crossings alone: what a tile holds beyond the edges says nothing.
impl<T: Copy + PartialEq> PartialEq for Grid<T> {
    fn eq(&self, other: &Self) -> bool {
        self.unshared(other).is_some_and(|mut tiles| {
            tiles.all(|(column, row)| {
                let bottom = row * TILE;
                (bottom..self.picks.min(bottom + TILE))
                    .all(|pick| self.pick_values(column, pick) == other.pick_values(column, pick))
            })
        })
    }
}

impl<T: Copy + Eq> Eq for Grid<T> {}

/// Where a crossing stands in its tile.
fn cell(end: u32, pick: u32) -> usize {
    (pick % TILE * TILE + end % TILE) as usize
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;

    #[test]
    fn grids_are_equal_where_their_crossings_are() {
        // What pads the tiles of the one is 7, of the other 3.
        let mut painted = Grid::from_fn(70, 65, |end, pick| if end + pick == 0 { 3 } else { 7u16 });
        let made = painted.clone().unwrap();
        let painted = painted.as_mut().unwrap();
        painted.set(0, 0, 7);
        let whole = Grid::filled(70, 65, 7u16).unwrap();
        assert_eq!(*painted, whole);
        assert_ne!(made, whole);
        for (end, pick) in [(0, 0), (69, 0), (0, 64), (69, 64), (63, 63)] {
            let mut other = whole.clone();
            other.set(end, pick, 1);
            assert_ne!(*painted, other, "{end}, {pick}");
        }
        // The same tiles in another size.
        assert_ne!(Grid::filled(71, 65, 7u16).unwrap(), whole);
    }
}
