//! Cells of a hair layer: how full each is at most, and how far the next full one is.
//!
//! A hair layer is nearly empty. Where a cell is empty, a walk leaps over the whole cube
//! of empty cells around it.

use crate::exemplar::hairs::HairPatch;

/// Farthest cell that is looked for.
const FARTHEST: u8 = 12;

/// One cell.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct HairCell {
    /// Largest fill in it, of 255.
    pub fill: u8,
    /// Cells to the nearest full one, along the axis on which it is farther; 0 = this one
    /// is full. All cells nearer than that are empty.
    pub reach: u8,
}

/// The cells of one face's layer; x and y repeat with the patch.
pub(super) struct HairCells {
    count: [usize; 3],
    /// Cells by which the surface, and the hairs with it, may be raised.
    pub lift: i32,
    /// x fastest, then y, then z.
    cells: Vec<HairCell>,
}

impl HairCells {
    /// Cells of a patch that is raised by up to `lift` cells.
    pub fn new(patch: &HairPatch, lift: usize) -> Self {
        let [nx, ny, nz] = patch.cells();
        let count = [nx, ny, nz + lift];
        let fill = |i: usize| {
            let (x, y, z) = (i % nx, i / nx % ny, i / nx / ny);
            (z.saturating_sub(lift)..(z + 1).min(nz))
                .map(|z| patch.bound([x, y, z]))
                .max()
                .unwrap_or(0)
        };
        let fills: Vec<u8> = (0..count.iter().product()).map(fill).collect();
        let mut near: Vec<bool> = fills.iter().map(|fill| *fill > 0).collect();
        let mut cells: Vec<HairCell> = (fills.iter())
            .map(|&fill| HairCell {
                fill,
                reach: if fill > 0 { 0 } else { FARTHEST },
            })
            .collect();
        for reach in 1..FARTHEST {
            near = grown(&near, count);
            for (cell, near) in cells.iter_mut().zip(&near) {
                if *near {
                    cell.reach = cell.reach.min(reach);
                }
            }
        }
        Self {
            count,
            lift: lift as i32,
            cells,
        }
    }

    /// The cell at a place; above and below the layer, an empty one.
    #[inline]
    pub fn at(&self, [x, y, z]: [i32; 3]) -> HairCell {
        let [nx, ny, nz] = self.count.map(|n| n as i32);
        if !(0..nz).contains(&z) {
            return HairCell::default();
        }
        let (x, y) = (x.rem_euclid(nx), y.rem_euclid(ny));
        self.cells[((z * ny + y) * nx + x) as usize]
    }
}

/// Cells that are marked or next to a marked one, corners included.
fn grown(marked: &[bool], [nx, ny, nz]: [usize; 3]) -> Vec<bool> {
    let mut grown = marked.to_vec();
    for (stride, n, wraps) in [(1, nx, true), (nx, ny, true), (nx * ny, nz, false)] {
        let before = grown.clone();
        for (i, cell) in grown.iter_mut().enumerate() {
            let place = i / stride % n;
            let beside = |to: usize| before[i + to * stride - place * stride];
            let low = if place > 0 {
                beside(place - 1)
            } else {
                wraps && beside(n - 1)
            };
            let high = if place + 1 < n {
                beside(place + 1)
            } else {
                wraps && beside(0)
            };
            *cell |= low || high;
        }
    }
    grown
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;
    use crate::design::Family;
    use crate::yarn::YarnRecipe;
    use glam::Vec2;

    #[test]
    fn nothing_is_leapt_over() {
        let recipe = YarnRecipe::family(Family::Wool, 0.4);
        let patch = HairPatch::new(&recipe, &recipe, Vec2::splat(0.5), 3).unwrap();
        for lift in [0, 2] {
            let cells = HairCells::new(&patch, lift);
            let [nx, ny, nz] = cells.count.map(|n| n as i32);
            let (mut far, mut tight) = (0, 0);
            for i in (0..nx * ny * nz).step_by(97) {
                let at = [i % nx, i / nx % ny, i / nx / ny];
                let reach = i32::from(cells.at(at).reach);
                far = far.max(reach);
                let nearest = (-reach..=reach)
                    .flat_map(|x| (-reach..=reach).map(move |y| (x, y)))
                    .flat_map(|(x, y)| (-reach..=reach).map(move |z| [x, y, z]))
                    .filter(|d| cells.at([0, 1, 2].map(|a| at[a] + d[a])).fill > 0)
                    .map(|d| d.into_iter().map(i32::abs).max().unwrap())
                    .min();
                assert!(nearest.is_none_or(|n| n >= reach), "{at:?}: {nearest:?}");
                tight += i32::from(nearest == Some(reach));
            }
            assert!(far > 3 && tight > 100, "{far} {tight}");
        }
    }

    #[test]
    fn a_raised_cell_takes_in_the_cells_below() {
        let recipe = YarnRecipe::family(Family::Wool, 0.4);
        let patch = HairPatch::new(&recipe, &recipe, Vec2::splat(0.5), 3).unwrap();
        let cells = HairCells::new(&patch, 2);
        let [nx, ny, nz] = patch.cells();
        let mut raised = 0;
        for i in 0..nx * ny * nz {
            let (x, y, z) = (i % nx, i / nx % ny, i / nx / ny);
            let own = patch.bound([x, y, z]);
            for lift in 0..=2 {
                let at = [x as i32, y as i32, (z + lift) as i32];
                assert!(cells.at(at).fill >= own);
            }
            raised += usize::from(own > 0);
        }
        assert!(raised > 100);
    }
}
