//! Upper bounds of the fill over bricks of 4³ voxels, block by block.
//!
//! A cloth shows a block's voxels shifted in z by the edge fixing and, with a one-tap
//! filter, up to one voxel aside. So each column of 4 × 4 stacks is widened in z by that
//! column's own bounds of the shift and by one voxel, and takes in the rim of the columns
//! around it, in whatever block they lie.

use rayon::prelude::*;

use super::bricks::BrickVolume;
use super::set::ExemplarSet;
use crate::synthesis::{BOUND_COLUMN, Catalogue, EdgeFix, Face, NeighbourBits};

/// Voxels along the edge of a majorant brick.
pub const CELL: usize = BOUND_COLUMN;

/// What the majorants allow for; leaving either out is wrong, and tests show it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Allowance {
    /// Widen columns by the bounds of their shift.
    pub shift: bool,
    /// Widen by one voxel for the filter's tap.
    pub tap: bool,
}

impl Allowance {
    /// Both.
    pub const FULL: Self = Self {
        shift: true,
        tap: true,
    };
}

/// Majorants of all blocks of all sets.
#[derive(Clone)]
pub struct BlockMajorants {
    /// Cells along x, y and z.
    cells: [usize; 3],
    /// Voxels by which the cells reach below and above the exemplar's grid.
    pad: usize,
    blocks: usize,
    /// `[set][block][y][x][z]`, fill in 1/255.
    fill: Vec<u8>,
}

/// Largest fill of a column of stacks and of its four rims, by exemplar z.
struct Column {
    all: Vec<u8>,
    rims: [Vec<u8>; 4],
}

impl BlockMajorants {
    /// Majorants of the blocks of `sets`, which share one grid.
    pub fn new(
        catalogue: &Catalogue,
        sets: &[std::sync::Arc<ExemplarSet>],
        edge_fix: &EdgeFix,
        bits: NeighbourBits,
        allowance: Allowance,
    ) -> Self {
        let block = sets.first().map_or([8, 8, 8], |set| set.grid.block);
        let (columns, rows) = (block[0] / CELL, block[1] / CELL);
        let bounds = |set: usize, id: usize, column: usize| {
            if !allowance.shift {
                return [0.0, 0.0];
            }
            Face::ALL.iter().fold([0.0f32, 0.0f32], |range, &face| {
                match edge_fix
                    .bounds(set as u16, id as u16, face, bits)
                    .get(column)
                {
                    Some(b) => [range[0].min(b[0]), range[1].max(b[1])],
                    None => range,
                }
            })
        };
        let blocks = catalogue.blocks();
        let widest = (0..sets.len() * blocks)
            .flat_map(|i| (0..columns * rows).map(move |column| (i / blocks, i % blocks, column)))
            .map(|(set, id, column)| bounds(set, id, column))
            .fold(0.0f32, |widest, b| widest.max(b[1]).max(-b[0]));
        let pad = (widest.ceil() as usize + 1).next_multiple_of(CELL);
        let cells = [columns, rows, block[2] / CELL + 2 * pad / CELL];

        // Each column, shifted by its own bounds, in cloth cells.
        let tap = usize::from(allowance.tap);
        let columns_of: Vec<Vec<Column>> = (0..sets.len() * blocks)
            .into_par_iter()
            .map(|i| {
                let (set, id) = (i / blocks, i % blocks);
                let place = catalogue.place(id as u16);
                // What is not built is never shown.
                let Some(volume) = &sets[set].volumes[usize::from(place.exemplar)] else {
                    return Vec::new();
                };
                let corner = [
                    usize::from(place.x) * block[0],
                    usize::from(place.y) * block[1],
                ];
                (0..columns * rows)
                    .map(|column| {
                        let at = [
                            corner[0] + column % columns * CELL,
                            corner[1] + column / columns * CELL,
                        ];
                        read_column(volume, at).spread(bounds(set, id, column), pad, tap, cells[2])
                    })
                    .collect()
            })
            .collect();

        // What may stand just across a border, whatever the neighbour: by the yarn that
        // lies on top there and the place along the border.
        let across = Across::new(catalogue, &columns_of, columns, rows, cells[2]);
        let mut fill = vec![0u8; sets.len() * blocks * columns * rows * cells[2]];
        fill.par_chunks_mut(columns * rows * cells[2])
            .enumerate()
            .for_each(|(i, fill)| {
                let own = &columns_of[i];
                if own.is_empty() {
                    return;
                }
                for (column, fill) in fill.chunks_mut(cells[2]).enumerate() {
                    let (x, y) = ((column % columns) as i64, (column / columns) as i64);
                    raise(fill, &own[column].all);
                    if !allowance.tap {
                        continue;
                    }
                    for dy in -1..=1 {
                        for dx in -1..=1 {
                            let (nx, ny) = (x + dx, y + dy);
                            if (dx, dy) == (0, 0) {
                                continue;
                            }
                            // The rim that faces this column; a corner lies on two rims.
                            let rim = if dx != 0 {
                                usize::from(dx < 0)
                            } else {
                                2 + usize::from(dy < 0)
                            };
                            let inside =
                                (0..columns as i64).contains(&nx) && (0..rows as i64).contains(&ny);
                            if inside {
                                raise(fill, &own[ny as usize * columns + nx as usize].rims[rim]);
                            } else {
                                raise(fill, across.rim(rim, nx, ny, columns, rows));
                            }
                        }
                    }
                }
            });
        Self {
            cells,
            pad,
            blocks,
            fill,
        }
    }

    /// Cells along x, y and z of a block.
    pub fn cells(&self) -> [usize; 3] {
        self.cells
    }

    /// Voxels by which cells reach below and above the exemplar's grid.
    pub fn pad(&self) -> usize {
        self.pad
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        self.fill.len()
    }

    /// Cells of one block, `[y][x][z]`, fill in 1/255.
    #[inline]
    pub fn block(&self, set: u16, block: u16) -> &[u8] {
        let length = self.cells.iter().product::<usize>();
        let start = (usize::from(set) * self.blocks + usize::from(block)) * length;
        &self.fill[start..start + length]
    }
}

fn raise(into: &mut [u8], from: &[u8]) {
    for (into, &from) in into.iter_mut().zip(from) {
        *into = (*into).max(from);
    }
}

fn read_column(volume: &BrickVolume, at: [usize; 2]) -> Column {
    let depth = volume.size()[2];
    let mut column = Column {
        all: vec![0; depth],
        rims: std::array::from_fn(|_| vec![0; depth]),
    };
    for z in 0..depth {
        for y in 0..CELL {
            for x in 0..CELL {
                let fill = volume.get(at[0] + x, at[1] + y, z).fill();
                if fill == 0 {
                    continue;
                }
                column.all[z] = column.all[z].max(fill);
                let on_rim = [x == 0, x == CELL - 1, y == 0, y == CELL - 1];
                for (rim, on) in column.rims.iter_mut().zip(on_rim) {
                    if on {
                        rim[z] = rim[z].max(fill);
                    }
                }
            }
        }
    }
    column
}

impl Column {
    /// From exemplar voxels to cloth cells, widened by bounds of the shift and the tap.
    fn spread(&self, bounds: [f32; 2], pad: usize, tap: usize, cells: usize) -> Self {
        let depth = self.all.len() as i64;
        let spread = |fill: &[u8]| -> Vec<u8> {
            (0..cells as i64)
                .map(|cell| {
                    // The cell shows exemplar voxels z − s, give or take the tap.
                    let low = (cell * CELL as i64 - pad as i64) as f32 - bounds[1];
                    let high = ((cell + 1) * CELL as i64 - pad as i64) as f32 - bounds[0];
                    let low = (low.floor() as i64 - tap as i64).clamp(0, depth);
                    let high = (high.ceil() as i64 + tap as i64).clamp(0, depth);
                    fill[low as usize..high.max(low) as usize]
                        .iter()
                        .copied()
                        .max()
                        .unwrap_or(0)
                })
                .collect()
        };
        Self {
            all: spread(&self.all),
            rims: std::array::from_fn(|i| spread(&self.rims[i])),
        }
    }
}

/// The largest rims over all blocks, by rim and place along the border.
struct Across {
    /// `[rim][place]`.
    rims: [Vec<Vec<u8>>; 4],
}

impl Across {
    fn new(
        catalogue: &Catalogue,
        columns_of: &[Vec<Column>],
        columns: usize,
        rows: usize,
        cells: usize,
    ) -> Self {
        debug_assert_eq!(columns_of.len() % catalogue.blocks().max(1), 0);
        let places = [rows, rows, columns, columns];
        // Rim 0 (left) is that of the first column of cells, rim 1 that of the last, ….
        let column_of = |rim: usize, place: usize| match rim {
            0 => place * columns,
            1 => place * columns + columns - 1,
            2 => place,
            _ => (rows - 1) * columns + place,
        };
        let rims = std::array::from_fn(|rim| {
            (0..places[rim])
                .map(|place| {
                    let mut most = vec![0u8; cells];
                    for block in columns_of.iter().filter(|block| !block.is_empty()) {
                        raise(&mut most, &block[column_of(rim, place)].rims[rim]);
                    }
                    most
                })
                .collect()
        });
        Self { rims }
    }

    /// The rim that a column at (x, y), outside the block, may show.
    fn rim(&self, rim: usize, x: i64, y: i64, columns: usize, rows: usize) -> &[u8] {
        let (mut rim, inside_x) = (rim, (0..columns as i64).contains(&x));
        if inside_x {
            // Straight across the lower or upper border, also seen from a diagonal.
            rim = if y < 0 { 3 } else { 2 };
        }
        let place = match rim {
            0 | 1 => y.rem_euclid(rows as i64),
            _ => x.rem_euclid(columns as i64),
        };
        &self.rims[rim][place as usize]
    }
}
