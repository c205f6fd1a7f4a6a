//! The 1-D optimum along a column of the cloth. Zhao 2012 §5.4.
//!
//! Zhao's recursion is f(i, t) = max over t′ of f(i − 1, t′) + gain(t′, t), and gain is 1
//! for at most one t′, the block below t in its exemplar. So
//! f(i, t) = max(best(i − 1), f(i − 1, below t) + 1): constant time for each candidate.
//!
//! Many choices are equally continuous along the warp. Among them the sum of a second
//! score decides: how many of the blocks beside t in its exemplar would fit the crossings
//! beside, so that neighbouring columns find continuity without knowing each other, and a
//! fixed preference for some exemplars and phases, so that they tend to choose alike.
//!
//! A cyclic column is opened where some optimum has a break. Where no candidate of one
//! row continues any of the row below, every optimum has. Else a closed cycle of blocks
//! without any break is looked for. Else longest *runs* (chains of candidates that stand
//! on each other in an exemplar) tell: an optimum covers the column by the fewest runs,
//! and the jump j ↦ j + (longest run at j) is monotone and commutes with a turn round the
//! column, so a row that repeats under it is an optimal start (the argument of Lee and
//! Lee 1984 for covering a circle by the fewest arcs).

use super::catalogue::{Catalogue, NO_BLOCK, Side};
use super::hash::hash;

/// One representative column for each class of exemplar columns that are translations of
/// each other (Zhao 2012 §5.4, *Algorithm optimization*), as a compact list of blocks.
#[derive(Clone, Default)]
pub(super) struct Columns {
    entries: Vec<Entry>,
    /// Candidate entries of each key.
    by_key: Vec<Vec<u16>>,
    /// For each entry and each column modulo the exemplar's width: the translated block.
    aligned: Vec<u16>,
    /// Bit k of `[block][0]` (`[1]`): the block to its left (right) is a candidate for k.
    beside: Vec<[u32; 2]>,
    /// Bit k of `[key]`: some candidate of k stands on one of `key`.
    continued_by: [u32; 32],
}

/// A block of a representative column.
#[derive(Clone, Copy)]
struct Entry {
    block: u16,
    /// Entries above and below, `NO_BLOCK` past a border that does not wrap.
    above: u16,
    below: u16,
    /// Bit k: a candidate for key k.
    accepts: u32,
    exemplar: u16,
    width: u16,
    height: u16,
    /// First element in `Columns::aligned`.
    aligned: u32,
}

impl Columns {
    pub(super) fn new(catalogue: &Catalogue) -> Self {
        let accepts = |block: u16| {
            (0..32u8)
                .filter(|&key| catalogue.candidates(key).contains(&block))
                .fold(0u32, |bits, key| bits | 1 << key)
        };
        let accepts: Vec<u32> = (0..catalogue.blocks() as u16).map(accepts).collect();
        let mut columns = Self {
            by_key: vec![Vec::new(); 32],
            ..Self::default()
        };
        let mut entry_of = vec![NO_BLOCK; catalogue.blocks()];
        for block in 0..catalogue.blocks() as u16 {
            if let Some(entry) = columns.representative(catalogue, block) {
                entry_of[usize::from(block)] = columns.entries.len() as u16;
                columns.entries.push(entry);
            }
            columns.beside.push([Side::Left, Side::Right].map(|side| {
                let beside = catalogue.neighbour(block, side);
                beside.map_or(0, |beside| accepts[usize::from(beside)])
            }));
        }
        for index in 0..columns.entries.len() {
            let block = columns.entries[index].block;
            let entry_beyond = |side: Side| {
                let beyond = catalogue.neighbour(block, side);
                beyond.map_or(NO_BLOCK, |beyond| entry_of[usize::from(beyond)])
            };
            let entry = &mut columns.entries[index];
            entry.above = entry_beyond(Side::Above);
            entry.below = entry_beyond(Side::Below);
            entry.accepts = accepts[usize::from(block)];
            for key in (0..32).filter(|key| entry.accepts >> key & 1 == 1) {
                columns.by_key[key].push(index as u16);
            }
        }
        for entry in &columns.entries {
            if let Some(above) = columns.entries.get(usize::from(entry.above)) {
                for key in (0..32).filter(|key| entry.accepts >> key & 1 == 1) {
                    columns.continued_by[key] |= above.accepts;
                }
            }
        }
        columns
    }

    /// The entry of a block that lies in the leftmost column of its class.
    fn representative(&mut self, catalogue: &Catalogue, block: u16) -> Option<Entry> {
        let place = catalogue.place(block);
        let exemplar = usize::from(place.exemplar);
        let width = catalogue.weaves()[exemplar].ends() as u16;
        let height = catalogue.weaves()[exemplar].picks() as u16;
        // The symmetries along which a chain of blocks may be moved sideways whole.
        let wraps_along = catalogue.wraps(exemplar)[1];
        let moves = catalogue.symmetries(exemplar).iter();
        let moves = moves.filter(|&&(_, b)| wraps_along || b == 0);
        if moves.clone().any(|&(a, _)| (place.x + a) % width < place.x) {
            return None;
        }
        let aligned = self.aligned.len() as u32;
        for end in 0..width {
            // The class's column that stands closest right of the cloth's column.
            let nearest = moves
                .clone()
                .min_by_key(|&&(a, b)| ((place.x + a + width - end) % width, b));
            let (a, b) = nearest.copied().unwrap_or((0, 0));
            let mut image = place;
            image.x = (place.x + a) % width;
            image.y = (place.y + b) % height;
            self.aligned.push(catalogue.block(image));
        }
        Some(Entry {
            block,
            above: NO_BLOCK,
            below: NO_BLOCK,
            accepts: 0,
            exemplar: place.exemplar,
            width,
            height,
            aligned,
        })
    }

    /// The block of an entry, translated so that exemplar columns fall on the cloth's
    /// columns in step: neighbouring columns that choose alike are continuous.
    #[inline]
    fn align(&self, entry: &Entry, end: u32) -> u16 {
        self.aligned[(entry.aligned + end % u32::from(entry.width)) as usize]
    }

    /// Entry above, when it is a candidate for `key`.
    #[inline]
    fn follow(&self, entry: u16, key: u8) -> Option<u16> {
        let above = self.entries[usize::from(entry)].above;
        let fits = |above: &Entry| above.accepts >> key & 1 == 1;
        self.entries
            .get(usize::from(above))
            .is_some_and(fits)
            .then_some(above)
    }
}

/// A continuous pair along the warp, in the score; everything else stays below.
const ALONG: u64 = 1 << 32;
/// A block beside that would fit, in the score.
const BESIDE: u64 = 64;
/// Preferences lie below this: a column of four rows of them does not outweigh a block
/// beside (measured: heavier preferences cost continuity across the warp).
const PREFERENCES: u64 = 16;

/// A column of the cloth: keys of its own crossings and of those beside it, row by row.
pub(super) struct Column<'a> {
    /// The design's columns that it consists of, upwards, `picks` rows each. Exemplar
    /// columns are kept in step with them, run by run.
    pub ends: &'a [u32],
    /// Rows of each of the design's columns.
    pub picks: usize,
    /// Keys from the first row upwards.
    pub keys: &'a [u8],
    /// Keys of the crossings to the left.
    pub left: &'a [u8],
    /// Keys of the crossings to the right.
    pub right: &'a [u8],
    /// Whether the first row stands on the last.
    pub cyclic: bool,
}

/// Buffers of one thread, kept between columns.
#[derive(Default)]
pub(super) struct Scratch {
    /// The candidates of each key as they lie on this column, in the order of the keys.
    laid: Vec<Laid>,
    /// First of each key's candidates in `laid`, and the end of the last.
    laid_from: Vec<usize>,
    /// Preferences `[laid.preferences + row mod height]`.
    preferences: Vec<u8>,
    /// Distinct heights of exemplars and the row modulo each.
    heights: Vec<u32>,
    phases: Vec<u32>,
    scores: Vec<u64>,
    scores_below: Vec<u64>,
    /// Best entry of each row.
    best: Vec<u16>,
    /// For each row and each of its candidates: whether it continues the row below.
    continued: Vec<bool>,
    /// First element of each row in `continued`.
    rows: Vec<usize>,
    runs: Vec<u32>,
    runs_above: Vec<u32>,
    longest: Vec<u32>,
    visited: Vec<bool>,
}

/// An entry in step with a column of the cloth: all that the recursion asks of it.
#[derive(Clone, Copy)]
struct Laid {
    entry: u16,
    /// Entry below, and the keys it is a candidate for: none when there is no entry.
    below: u16,
    below_accepts: u32,
    beside: [u32; 2],
    /// Which of `Scratch::heights` the exemplar has.
    height: u32,
    preferences: u32,
}

/// Fills `blocks` with the best block for each row of a column.
pub(super) fn cover(
    catalogue: &Catalogue,
    column: &Column<'_>,
    seed: u64,
    scratch: &mut Scratch,
    blocks: &mut Vec<u16>,
) {
    let solver = Solver {
        columns: catalogue.columns(),
        column,
    };
    blocks.clear();
    blocks.resize(column.keys.len(), NO_BLOCK);
    solver.lay(catalogue, seed, scratch);
    let start = if column.cyclic {
        if let Some(start) = solver.forced_break() {
            start
        } else if let Some(cycle) = solver.closed_cycle(scratch) {
            solver.write_run(cycle, 0, column.keys.len(), blocks);
            return;
        } else {
            solver.longest_runs(scratch);
            solver.repeating_start(scratch)
        }
    } else {
        0
    };
    solver.maximise(start, scratch);
    solver.write_back(start, scratch, blocks);
}

struct Solver<'a> {
    columns: &'a Columns,
    column: &'a Column<'a>,
}

impl Solver<'_> {
    /// The design's column of a row.
    fn end(&self, row: usize) -> u32 {
        match self.column.ends {
            [end] => *end,
            ends => ends.get(row / self.column.picks).copied().unwrap_or(0),
        }
    }

    /// A row counted round the column, at most one turn too far.
    #[inline]
    fn round(&self, row: usize) -> usize {
        let rows = self.column.keys.len();
        if row >= rows { row - rows } else { row }
    }

    /// Puts all candidates in step with the column's first row, with their preferences.
    fn lay(&self, catalogue: &Catalogue, seed: u64, scratch: &mut Scratch) {
        scratch.laid.clear();
        scratch.laid_from.clear();
        scratch.preferences.clear();
        scratch.heights.clear();
        let end = self.end(0);
        for list in &self.columns.by_key {
            scratch.laid_from.push(scratch.laid.len());
            for &index in list {
                let entry = &self.columns.entries[usize::from(index)];
                let block = self.columns.align(entry, end);
                let lower = self.columns.entries.get(usize::from(entry.below));
                let height = u32::from(entry.height);
                let known = scratch.heights.iter().position(|&other| other == height);
                let slot = known.unwrap_or(scratch.heights.len());
                if known.is_none() {
                    scratch.heights.push(height);
                }
                scratch.laid.push(Laid {
                    entry: index,
                    below: if lower.is_some() { entry.below } else { 0 },
                    below_accepts: lower.map_or(0, |lower| lower.accepts),
                    beside: self.columns.beside[usize::from(block)],
                    height: slot as u32,
                    preferences: scratch.preferences.len() as u32,
                });
                let place = catalogue.place(block);
                let width = u32::from(entry.width);
                let across = (u32::from(place.x) + width - end % width) % width;
                for row in 0..height {
                    let along = (u32::from(place.y) + height - row) % height;
                    let phase = u64::from(across) << 32 | u64::from(along);
                    let liking = hash(seed, u64::from(entry.exemplar), phase) % PREFERENCES;
                    scratch.preferences.push(liking as u8);
                }
            }
        }
        scratch.laid_from.push(scratch.laid.len());
    }

    /// Fills `phases` with a row modulo each exemplar height.
    fn enter_row(row: usize, heights: &[u32], phases: &mut Vec<u32>) {
        phases.clear();
        phases.extend(heights.iter().map(|&height| row as u32 % height));
    }

    /// The same for the row after the one entered last, without division.
    #[inline]
    fn enter_next_row(heights: &[u32], phases: &mut [u32]) {
        for (phase, &height) in phases.iter_mut().zip(heights) {
            *phase = if *phase + 1 == height { 0 } else { *phase + 1 };
        }
    }

    /// What a candidate is worth at a row, apart from continuity along the warp.
    #[inline]
    fn worth(&self, laid: &Laid, row: usize, phases: &[u32], preferences: &[u8]) -> u64 {
        let left = laid.beside[0] >> self.column.left[row] & 1;
        let right = laid.beside[1] >> self.column.right[row] & 1;
        let phase = phases[laid.height as usize];
        let liking = preferences[(laid.preferences + phase) as usize];
        BESIDE * u64::from(left + right) + u64::from(liking)
    }

    /// The first row that no candidate can continue from the row below.
    fn forced_break(&self) -> Option<usize> {
        let keys = self.column.keys;
        let mut below = *keys.last()?;
        keys.iter().position(|&key| {
            let broken = self.columns.continued_by[usize::from(below)] >> key & 1 == 0;
            below = key;
            broken
        })
    }

    /// The entry at row 0 of the best cycle of blocks that closes on itself.
    fn closed_cycle(&self, scratch: &mut Scratch) -> Option<u16> {
        let first = *self.column.keys.first()?;
        let mut best = None;
        for &start in &self.columns.by_key[usize::from(first)] {
            if let Some(sum) = self.worth_of_cycle(start, scratch) {
                best = best.max(Some((sum, start)));
            }
        }
        best.map(|(_, start)| start)
    }

    /// What the cycle of blocks from an entry at row 0 is worth; `None` unless it closes.
    fn worth_of_cycle(&self, start: u16, scratch: &mut Scratch) -> Option<u64> {
        let mut entry = start;
        let mut sum = 0;
        for (row, &key) in self.column.keys.iter().enumerate() {
            if row > 0 {
                entry = self.columns.follow(entry, key)?;
            }
            Self::enter_row(row, &scratch.heights, &mut scratch.phases);
            let key = usize::from(key);
            let list = &scratch.laid[scratch.laid_from[key]..scratch.laid_from[key + 1]];
            let laid = list.iter().find(|laid| laid.entry == entry)?;
            sum += self.worth(laid, row, &scratch.phases, &scratch.preferences);
        }
        let closed = self.columns.entries[usize::from(entry)].above == start;
        closed.then_some(sum)
    }

    /// The recursion, from `start` upwards (round the column).
    fn maximise(&self, start: usize, scratch: &mut Scratch) {
        let keys = self.column.keys;
        let Scratch {
            laid,
            laid_from,
            preferences,
            heights,
            phases,
            scores,
            scores_below,
            best,
            continued,
            rows,
            ..
        } = scratch;
        scores.clear();
        scores.resize(self.columns.entries.len(), 0);
        scores_below.clone_from(scores);
        best.clear();
        continued.clear();
        rows.clear();
        // No key lies below the first row: nothing can be continued there.
        let mut below_bit = 0u32;
        let mut best_below = 0;
        for row in (start..keys.len()).chain(0..start) {
            if row == start || row == 0 {
                Self::enter_row(row, heights, phases);
            } else {
                Self::enter_next_row(heights, phases);
            }
            rows.push(continued.len());
            let key = usize::from(keys[row]);
            let (mut highest, mut highest_entry) = (0, NO_BLOCK);
            for candidate in &laid[laid_from[key]..laid_from[key + 1]] {
                let fits = candidate.below_accepts & below_bit != 0;
                let continuing = scores_below[usize::from(candidate.below)] + ALONG;
                let continuing = if fits { continuing } else { 0 };
                let score =
                    continuing.max(best_below) + self.worth(candidate, row, phases, preferences);
                scores[usize::from(candidate.entry)] = score;
                continued.push(continuing > best_below);
                if score > highest || highest_entry == NO_BLOCK {
                    (highest, highest_entry) = (score, candidate.entry);
                }
            }
            best.push(highest_entry);
            std::mem::swap(scores, scores_below);
            below_bit = 1 << key;
            best_below = highest;
        }
    }

    /// Follows the recursion back from its best end, run by run.
    fn write_back(&self, start: usize, scratch: &Scratch, blocks: &mut [u16]) {
        let mut top = self.column.keys.len();
        while top > 0 {
            // Down from the best entry of the topmost free row to where its run begins.
            let mut step = top - 1;
            let mut entry = scratch.best[step];
            while self.continues(entry, step, self.round(start + step), scratch) {
                entry = self.columns.entries[usize::from(entry)].below;
                step -= 1;
            }
            self.write_run(entry, self.round(start + step), top - step, blocks);
            top = step;
        }
    }

    /// Whether the best way to an entry continues the entry below.
    fn continues(&self, entry: u16, step: usize, row: usize, scratch: &Scratch) -> bool {
        let list = &self.columns.by_key[usize::from(self.column.keys[row])];
        let position = list.iter().position(|&other| other == entry);
        position.is_some_and(|position| scratch.continued[scratch.rows[step] + position])
    }

    /// Writes a run of blocks that starts with an entry at a row.
    fn write_run(&self, mut entry: u16, row: usize, length: usize, blocks: &mut [u16]) {
        let end = self.end(row);
        for step in 0..length {
            let Some(here) = self.columns.entries.get(usize::from(entry)) else {
                return;
            };
            blocks[self.round(row + step)] = self.columns.align(here, end);
            entry = here.above;
        }
    }

    /// A row of a cycle of the jumps by the longest runs.
    fn repeating_start(&self, scratch: &mut Scratch) -> usize {
        let rows = self.column.keys.len();
        scratch.visited.clear();
        scratch.visited.resize(rows, false);
        let mut start = 0;
        while !scratch.visited[start] {
            scratch.visited[start] = true;
            start = (start + scratch.longest[start] as usize) % rows;
        }
        start
    }

    /// Fills `scratch.longest` with the longest run at each row of the cyclic column, at
    /// most one turn.
    fn longest_runs(&self, scratch: &mut Scratch) {
        let rows = self.column.keys.len();
        scratch.longest.clear();
        scratch.longest.resize(rows, 0);
        scratch.runs.clear();
        scratch.runs.resize(self.columns.entries.len(), 0);
        scratch.runs_above.clone_from(&scratch.runs);
        // The first turn does not know what follows its last row: its runs end there.
        let mut above = None;
        for row in (0..rows).rev() {
            scratch.longest[row] = self.runs_at(row, above, scratch);
            above = Some(self.column.keys[row]);
        }
        // The second knows; it may stop below the lowest run that the first one cut.
        for row in (0..rows).rev() {
            let cut = row + scratch.longest[row] as usize >= rows;
            scratch.longest[row] = self.runs_at(row, above, scratch);
            above = Some(self.column.keys[row]);
            if !cut {
                break;
            }
        }
    }

    /// Runs of every candidate at `row` from those at the row above, whose key is `above`;
    /// returns the longest, at most one turn.
    fn runs_at(&self, row: usize, above: Option<u8>, scratch: &mut Scratch) -> u32 {
        let turn = self.column.keys.len() as u32;
        let mut longest = 0;
        for &entry in &self.columns.by_key[usize::from(self.column.keys[row])] {
            let next = above.and_then(|key| self.columns.follow(entry, key));
            let beyond = next.map_or(0, |next| scratch.runs_above[usize::from(next)]);
            let run = (beyond + 1).min(turn);
            scratch.runs[usize::from(entry)] = run;
            longest = longest.max(run);
        }
        std::mem::swap(&mut scratch.runs_above, &mut scratch.runs);
        longest
    }
}
