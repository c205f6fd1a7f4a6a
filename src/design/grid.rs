//! A grid of small values, one a crossing, in copy-on-write tiles.

use std::sync::Arc;

use super::pattern::{SizeError, check_size};

const TILE: u32 = 64;

/// Values by crossing, in 64×64 tiles that clones share until they are written.
///
/// Used for the region of every crossing and for yarns that change along their length.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Grid<T> {
    ends: u32,
    picks: u32,
    tiles: Vec<Arc<[T]>>,
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
        let count = ends.div_ceil(TILE) as usize * picks.div_ceil(TILE) as usize;
        Ok(Self {
            ends,
            picks,
            tiles: vec![blank; count],
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
        let columns = ends.div_ceil(TILE);
        let mut cells = Vec::with_capacity((TILE * TILE) as usize);
        for (index, tile) in grid.tiles.iter_mut().enumerate() {
            let (left, bottom) = (index as u32 % columns * TILE, index as u32 / columns * TILE);
            cells.clear();
            for pick in bottom..bottom + TILE {
                for end in left..left + TILE {
                    let inside = end < ends && pick < picks;
                    cells.push(if inside { value(end, pick) } else { usual });
                }
            }
            if cells.iter().any(|&cell| cell != usual) {
                *tile = cells.as_slice().into();
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

    fn place(&self, end: u32, pick: u32) -> (usize, usize) {
        let tile =
            (pick / TILE) as usize * self.ends.div_ceil(TILE) as usize + (end / TILE) as usize;
        (tile, (pick % TILE * TILE + end % TILE) as usize)
    }

    /// The value at a crossing inside the grid.
    pub fn get(&self, end: u32, pick: u32) -> T {
        let (tile, cell) = self.place(end, pick);
        self.tiles[tile][cell]
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
        let (tile, cell) = self.place(end, pick);
        if self.tiles[tile][cell] != value {
            Arc::make_mut(&mut self.tiles[tile])[cell] = value;
        }
    }

    /// All values, pick by pick from the bottom, each from left to right.
    pub fn iter(&self) -> impl Iterator<Item = T> + '_ {
        (0..self.picks).flat_map(move |pick| (0..self.ends).map(move |end| self.get(end, pick)))
    }
}

impl<T: Copy + PartialEq + Ord> Grid<T> {
    /// The largest value, by whole tiles where they are shared.
    pub fn max(&self) -> Option<T> {
        self.iter().max()
    }
}
