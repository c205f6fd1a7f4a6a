//! The 1-D optimum along a column: the fewest runs that cover it. Zhao 2012 §5.4.
//!
//! Zhao's recursion is f(i, t) = max over t′ of f(i − 1, t′) + gain(t′, t), and gain is 1
//! for at most one t′ (the block below t in its exemplar). So an optimum is a cover of the
//! column by the fewest *runs*: chains of blocks that stand on each other in one exemplar
//! and are all candidates. A part of a run is a run; hence jumping as far as possible each
//! time is optimal from a given start. On a cyclic column the optimum also depends on the
//! start. The jump j ↦ j + (longest run at j) is monotone and commutes with a turn round
//! the column, so every point of a cycle of that map is an optimal start (the argument of
//! Lee and Lee 1984 for covering a circle by arcs); following jumps until one repeats
//! finds it in linear time. The only better case, a closed cycle of blocks with no break
//! at all, passes through every row and is looked for at row 0 first.

use super::catalogue::{Catalogue, NO_BLOCK, Side};
use super::hash::hash;

/// One representative column for each class of exemplar columns that are translations of
/// each other (Zhao 2012 §5.4, *Algorithm optimization*), as a compact list of blocks.
#[derive(Debug, Clone, Default)]
pub(super) struct Columns {
    /// Block id of each entry.
    blocks: Vec<u16>,
    /// Entry above each entry, `NO_BLOCK` past a border that does not wrap.
    next: Vec<u16>,
    /// Bit k: the entry is a candidate for key k.
    accepts: Vec<u32>,
    /// Candidate entries of each key.
    by_key: Vec<Vec<u16>>,
    /// For each entry and each column modulo the exemplar's width: the translated block.
    aligned: Vec<u16>,
    /// First element of an entry in `aligned`.
    aligned_base: Vec<u32>,
    /// (exemplar, width, height) of each entry.
    sizes: Vec<(u16, u16, u16)>,
}

impl Columns {
    pub(super) fn new(catalogue: &Catalogue) -> Self {
        let mut columns = Self {
            by_key: vec![Vec::new(); 32],
            ..Self::default()
        };
        let mut entry_of = vec![NO_BLOCK; catalogue.blocks()];
        for block in 0..catalogue.blocks() as u16 {
            let place = catalogue.place(block);
            let exemplar = usize::from(place.exemplar);
            let moves = column_moves(catalogue, exemplar);
            let width = catalogue.weaves()[exemplar].ends() as u16;
            let height = catalogue.weaves()[exemplar].picks() as u16;
            // The representative is the leftmost column of its class.
            if moves.iter().any(|&(a, _)| (place.x + a) % width < place.x) {
                continue;
            }
            entry_of[usize::from(block)] = columns.blocks.len() as u16;
            columns.blocks.push(block);
            columns.sizes.push((place.exemplar, width, height));
            columns.aligned_base.push(columns.aligned.len() as u32);
            // The class's column that stands closest right of the cloth's column.
            for end in 0..width {
                let nearest = moves
                    .iter()
                    .min_by_key(|&&(a, b)| ((place.x + a + width - end) % width, b));
                let (a, b) = nearest.copied().unwrap_or((0, 0));
                let mut image = place;
                image.x = (place.x + a) % width;
                image.y = (place.y + b) % height;
                columns.aligned.push(catalogue.block(image));
            }
        }
        for (entry, &block) in columns.blocks.iter().enumerate() {
            let above = catalogue.neighbour(block, Side::Above);
            let next = above.map_or(NO_BLOCK, |above| entry_of[usize::from(above)]);
            columns.next.push(next);
            let mut accepts = 0;
            for key in 0..32u8 {
                if catalogue.candidates(key).contains(&block) {
                    accepts |= 1 << key;
                    columns.by_key[usize::from(key)].push(entry as u16);
                }
            }
            columns.accepts.push(accepts);
        }
        columns
    }

    /// Entry above, when it is a candidate for `key`.
    #[inline]
    fn follow(&self, entry: u16, key: u8) -> Option<u16> {
        let next = self.next[usize::from(entry)];
        (next != NO_BLOCK && self.accepts[usize::from(next)] >> key & 1 == 1).then_some(next)
    }

    /// The block of an entry, translated so that exemplar columns fall on the cloth's
    /// columns in step: neighbouring columns that make the same choice are continuous.
    #[inline]
    fn align(&self, entry: u16, end: u32) -> u16 {
        let (_, width, _) = self.sizes[usize::from(entry)];
        let base = self.aligned_base[usize::from(entry)];
        self.aligned[(base + end % u32::from(width)) as usize]
    }

    /// Fixed order of preference among runs of equal worth, lowest first.
    ///
    /// It depends on the exemplar and on how its repeat lies on the cloth, not on the
    /// crossing, so that neighbouring columns tend to choose alike, yet needs nothing but
    /// the column itself.
    fn preference(&self, catalogue: &Catalogue, entry: u16, start: Crossing, seed: u64) -> u64 {
        let (exemplar, width, height) = self.sizes[usize::from(entry)];
        let place = catalogue.place(self.align(entry, start.end));
        let phase = |at: u16, crossing: u32, period: u16| {
            let period = u32::from(period);
            (u32::from(at) + period - crossing % period) % period
        };
        let across = phase(place.x, start.end, width);
        let along = phase(place.y, start.pick, height);
        hash(
            seed,
            u64::from(exemplar),
            u64::from(across) << 32 | u64::from(along),
        )
    }
}

/// The symmetries along which a chain of blocks may be moved sideways whole.
fn column_moves(catalogue: &Catalogue, exemplar: usize) -> Vec<(u16, u16)> {
    let wraps_along = catalogue.wraps(exemplar)[1];
    let moves = catalogue.symmetries(exemplar).iter().copied();
    moves.filter(|&(_, b)| wraps_along || b == 0).collect()
}

/// A crossing of the design.
#[derive(Debug, Clone, Copy)]
pub(super) struct Crossing {
    pub end: u32,
    pub pick: u32,
}

/// Buffers of one thread, kept between columns.
#[derive(Default)]
pub(super) struct Scratch {
    alive: Vec<Survivor>,
    before: Vec<Survivor>,
    longest: Vec<u32>,
    runs_above: Vec<u32>,
    runs_here: Vec<u32>,
    visited: Vec<bool>,
}

/// A run under way: the entry it began with and the one it has reached.
#[derive(Debug, Clone, Copy)]
struct Survivor {
    first: u16,
    last: u16,
}

/// Fills `blocks` with the best block for each key of a column, in column order.
///
/// `crossing(row)` says where a row lies in the design; it only breaks ties.
pub(super) fn cover(
    catalogue: &Catalogue,
    keys: &[u8],
    cyclic: bool,
    crossing: impl Fn(usize) -> Crossing,
    seed: u64,
    scratch: &mut Scratch,
    blocks: &mut Vec<u16>,
) {
    blocks.clear();
    blocks.resize(keys.len(), NO_BLOCK);
    let mut painter = Painter {
        catalogue,
        columns: catalogue.columns(),
        keys,
        seed,
        blocks,
    };
    let rows = keys.len();
    if !cyclic {
        let mut row = 0;
        while row < rows {
            let length = painter.grow(row, rows - row, scratch);
            painter.paint(row, length, crossing(row), &scratch.alive);
            row += length;
        }
        return;
    }

    // A run that closes on itself has no break at all.
    if painter.grow(0, rows, scratch) == rows {
        let columns = painter.columns;
        let closes = |run: &Survivor| columns.next[usize::from(run.last)] == run.first;
        if scratch.alive.iter().any(closes) {
            scratch.alive.retain(closes);
            painter.paint(0, rows, crossing(0), &scratch.alive);
            return;
        }
    }
    // Follow the longest jumps until one repeats: that row is an optimal start.
    painter.longest_runs(scratch);
    scratch.visited.clear();
    scratch.visited.resize(rows, false);
    let mut start = 0;
    while !scratch.visited[start] {
        scratch.visited[start] = true;
        start = (start + scratch.longest[start] as usize) % rows;
    }
    let mut covered = 0;
    while covered < rows {
        let row = (start + covered) % rows;
        let length = painter.grow(row, rows - covered, scratch);
        painter.paint(row, length, crossing(row), &scratch.alive);
        covered += length;
    }
}

struct Painter<'a> {
    catalogue: &'a Catalogue,
    columns: &'a Columns,
    keys: &'a [u8],
    seed: u64,
    blocks: &'a mut [u16],
}

impl Painter<'_> {
    /// Length of the longest run at `row`, at most `limit`; the runs of that length are
    /// left in `scratch.alive`. Rows count round the column.
    fn grow(&self, row: usize, limit: usize, scratch: &mut Scratch) -> usize {
        let Scratch { alive, before, .. } = scratch;
        alive.clear();
        let first = &self.columns.by_key[usize::from(self.keys[row])];
        alive.extend(first.iter().map(|&entry| Survivor {
            first: entry,
            last: entry,
        }));
        let mut length = 1;
        let mut next_row = row;
        while length < limit {
            next_row += 1;
            if next_row == self.keys.len() {
                next_row = 0;
            }
            let key = self.keys[next_row];
            before.clear();
            before.extend(alive.iter().filter_map(|run| {
                let last = self.columns.follow(run.last, key)?;
                Some(Survivor { last, ..*run })
            }));
            if before.is_empty() {
                break;
            }
            std::mem::swap(alive, before);
            length += 1;
        }
        length
    }

    /// Writes the preferred one of the runs that start at `row`.
    fn paint(&mut self, row: usize, length: usize, start: Crossing, runs: &[Survivor]) {
        let columns = self.columns;
        let best = runs
            .iter()
            .map(|run| run.first)
            .min_by_key(|&first| columns.preference(self.catalogue, first, start, self.seed));
        let Some(mut entry) = best else { return };
        let mut at = row;
        for _ in 0..length {
            self.blocks[at] = columns.align(entry, start.end);
            entry = columns.next[usize::from(entry)];
            at = if at + 1 == self.keys.len() { 0 } else { at + 1 };
        }
    }

    /// Fills `scratch.longest` with the longest run at each row of the cyclic column, at
    /// most one turn.
    fn longest_runs(&self, scratch: &mut Scratch) {
        let rows = self.keys.len();
        scratch.longest.clear();
        scratch.longest.resize(rows, 0);
        scratch.runs_above.clear();
        scratch.runs_above.resize(self.columns.blocks.len(), 0);
        scratch.runs_here.clone_from(&scratch.runs_above);
        // The first turn does not know what follows its last row: its runs end there.
        let mut above = None;
        for row in (0..rows).rev() {
            scratch.longest[row] = self.runs_at(row, above, rows, scratch);
            above = Some(self.keys[row]);
        }
        // The second knows; it may stop below the lowest run that the first one cut.
        for row in (0..rows).rev() {
            let cut = row + scratch.longest[row] as usize >= rows;
            scratch.longest[row] = self.runs_at(row, above, rows, scratch);
            above = Some(self.keys[row]);
            if !cut {
                break;
            }
        }
    }

    /// Runs of every candidate at `row` from those at the row above, whose key is `above`;
    /// returns the longest.
    fn runs_at(&self, row: usize, above: Option<u8>, limit: usize, scratch: &mut Scratch) -> u32 {
        let mut longest = 0;
        for &entry in &self.columns.by_key[usize::from(self.keys[row])] {
            let next = above.and_then(|key| self.columns.follow(entry, key));
            let beyond = next.map_or(0, |next| scratch.runs_above[usize::from(next)]);
            let run = (beyond + 1).min(limit as u32);
            scratch.runs_here[usize::from(entry)] = run;
            longest = longest.max(run);
        }
        std::mem::swap(&mut scratch.runs_above, &mut scratch.runs_here);
        longest
    }
}
