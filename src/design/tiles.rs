//! Copy-on-write tiles, in copy-on-write rows of tiles.
//!
//! A clone shares every row, a write copies one row of pointers and one tile: at 5120 × 6300
//! crossings a snapshot and a stroke cost a few kilobytes, so that undo may keep thousands.

use std::sync::Arc;

/// Crossings along each side of a tile.
pub(super) const TILE: u32 = 64;

/// Tiles side by side, from left to right.
type Row<T> = Arc<Vec<Arc<T>>>;

/// Tiles in rows from the bottom, each from left to right.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Tiles<T: ?Sized> {
    rows: Vec<Row<T>>,
}

impl<T: ?Sized> Clone for Tiles<T> {
    fn clone(&self) -> Self {
        let rows = self.rows.clone();
        Self { rows }
    }
}

impl<T: ?Sized> Tiles<T> {
    /// As many tiles as `ends` × `picks` crossings need, all of them `blank`.
    pub(super) fn filled(ends: u32, picks: u32, blank: Arc<T>) -> Self {
        let row = Arc::new(vec![blank; ends.div_ceil(TILE) as usize]);
        Self {
            rows: vec![row; picks.div_ceil(TILE) as usize],
        }
    }

    /// From tiles in rows, each row of one length.
    pub(super) fn from_rows(rows: impl IntoIterator<Item = Vec<Arc<T>>>) -> Self {
        Self {
            rows: rows.into_iter().map(Arc::new).collect(),
        }
    }

    /// The tile of a crossing.
    #[inline]
    pub(super) fn at(&self, end: u32, pick: u32) -> &T {
        &self.rows[(pick / TILE) as usize][(end / TILE) as usize]
    }

    /// The place of the tile of a crossing, to be written; its row becomes one's own.
    pub(super) fn slot(&mut self, end: u32, pick: u32) -> &mut Arc<T> {
        let row = Arc::make_mut(&mut self.rows[(pick / TILE) as usize]);
        &mut row[(end / TILE) as usize]
    }

    /// All tiles, row by row from the bottom.
    pub(super) fn iter(&self) -> impl Iterator<Item = &T> {
        self.rows.iter().flat_map(|row| row.iter().map(Arc::as_ref))
    }

    /// Puts `change(tile)` in the place of every tile; neighbours that share a tile share
    /// what it becomes.
    pub(super) fn replace(&mut self, change: impl Fn(&Arc<T>) -> Arc<T>) {
        let mut last_row: Option<(Row<T>, Row<T>)> = None;
        for row in &mut self.rows {
            if let Some((old, new)) = &last_row
                && Arc::ptr_eq(old, row)
            {
                *row = Arc::clone(new);
                continue;
            }
            let mut last: Option<(&Arc<T>, Arc<T>)> = None;
            let mut changed = Vec::with_capacity(row.len());
            for tile in row.iter() {
                let new = match &last {
                    Some((old, new)) if Arc::ptr_eq(old, tile) => Arc::clone(new),
                    _ => change(tile),
                };
                last = Some((tile, Arc::clone(&new)));
                changed.push(new);
            }
            let changed = Arc::new(changed);
            let old = std::mem::replace(row, Arc::clone(&changed));
            last_row = Some((old, changed));
        }
    }

    /// Column and row of the tiles that are not the very same memory in `other`, which is
    /// of the same size: all that may differ.
    pub(super) fn unshared<'t>(&'t self, other: &'t Self) -> impl Iterator<Item = (u32, u32)> + 't {
        let rows = self.rows.iter().zip(&other.rows).enumerate();
        rows.filter(|(_, (mine, theirs))| !Arc::ptr_eq(mine, theirs))
            .flat_map(|(row, (mine, theirs))| {
                let tiles = mine.iter().zip(theirs.iter()).enumerate();
                tiles
                    .filter(|(_, (mine, theirs))| !Arc::ptr_eq(mine, theirs))
                    .map(move |(column, _)| (column as u32, row as u32))
            })
    }

    /// Bytes of memory, of tiles of `tile_bytes` each, that this does not share with
    /// `other`; all of them without one or with one of another size.
    pub(super) fn bytes_beyond(&self, other: Option<&Self>, tile_bytes: usize) -> usize {
        // Both reference counts come before the contents.
        let (row_head, tile_head) = (size_of::<Vec<Arc<T>>>() + 16, 16);
        let pointer = size_of::<Arc<T>>();
        let same_size = |other: &&Self| {
            other.rows.len() == self.rows.len()
                && other.rows.first().map(|row| row.len()) == self.rows.first().map(|row| row.len())
        };
        let other = other.filter(same_size);
        let mut bytes = self.rows.len() * size_of::<Row<T>>();
        for (place, row) in self.rows.iter().enumerate() {
            let before = other.map(|other| &other.rows[place]);
            if before.is_some_and(|before| Arc::ptr_eq(before, row)) {
                continue;
            }
            bytes += row_head + row.len() * pointer;
            for (column, tile) in row.iter().enumerate() {
                let same = before.is_some_and(|before| Arc::ptr_eq(&before[column], tile));
                bytes += usize::from(!same) * (tile_head + tile_bytes);
            }
        }
        bytes
    }
}
