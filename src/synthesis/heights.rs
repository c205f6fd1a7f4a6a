//! Heights of the yarns at the blocks' edges: what edge fixing needs to know of voxels.

use super::SynthesisError;
use super::catalogue::{Catalogue, Side};

/// A side of the cloth.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Face {
    /// The upper side, +z, which the weave pattern shows.
    Front,
    /// The lower side.
    Back,
}

impl Face {
    /// Both faces, in the order of all tables.
    pub const ALL: [Self; 2] = [Self::Front, Self::Back];
}

/// Height profiles along the four edges of every block of one exemplar set, in voxels.
///
/// Each table is \[face\]\[block\]\[position\], faces in the order of [`Face::ALL`], positions
/// along +x or +y. A height is that of the yarn that crosses the edge, seen from that
/// face, *at the border itself* (half a voxel beyond the outermost stack), hairs left out
/// and gaps interpolated. Only differences of heights on the same face matter.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct EdgeHeights {
    /// Number of blocks, that of the catalogue.
    pub blocks: usize,
    /// Stacks of voxels across a block (length of the profiles `bottom` and `top`).
    pub bx: usize,
    /// Stacks of voxels along a block (length of the profiles `left` and `right`).
    pub by: usize,
    /// At the edge towards end − 1, `by` values a block.
    pub left: Vec<f32>,
    /// At the edge towards end + 1, `by` values a block.
    pub right: Vec<f32>,
    /// At the edge towards pick − 1, `bx` values a block.
    pub bottom: Vec<f32>,
    /// At the edge towards pick + 1, `bx` values a block.
    pub top: Vec<f32>,
}

impl EdgeHeights {
    /// Flat edges: all heights 0.
    pub fn flat(blocks: usize, bx: usize, by: usize) -> Self {
        Self {
            blocks,
            bx,
            by,
            left: vec![0.0; 2 * blocks * by],
            right: vec![0.0; 2 * blocks * by],
            bottom: vec![0.0; 2 * blocks * bx],
            top: vec![0.0; 2 * blocks * bx],
        }
    }

    /// The profile of a block's edge on a face.
    pub fn profile(&self, face: Face, block: u16, side: Side) -> &[f32] {
        let (table, length) = self.table(side);
        let from = (face as usize * self.blocks + usize::from(block)) * length;
        &table[from..from + length]
    }

    /// The same, to be written.
    pub fn profile_mut(&mut self, face: Face, block: u16, side: Side) -> &mut [f32] {
        let length = self.table(side).1;
        let from = (face as usize * self.blocks + usize::from(block)) * length;
        let table = match side {
            Side::Left => &mut self.left,
            Side::Right => &mut self.right,
            Side::Below => &mut self.bottom,
            Side::Above => &mut self.top,
        };
        &mut table[from..from + length]
    }

    fn table(&self, side: Side) -> (&[f32], usize) {
        match side {
            Side::Left => (&self.left, self.by),
            Side::Right => (&self.right, self.by),
            Side::Below => (&self.bottom, self.bx),
            Side::Above => (&self.top, self.bx),
        }
    }

    /// Checks sizes and values; `set` names the set in the error.
    pub(super) fn check(&self, set: usize, catalogue: &Catalogue) -> Result<(), SynthesisError> {
        let fail = |what: String| Err(SynthesisError::Heights { set, what });
        if self.blocks != catalogue.blocks() {
            let wanted = catalogue.blocks();
            return fail(format!(
                "{} blocks where the catalogue has {wanted}",
                self.blocks
            ));
        }
        if self.bx == 0 || self.by == 0 {
            return fail(format!(
                "blocks of {} × {} stacks of voxels",
                self.bx, self.by
            ));
        }
        for side in Side::ALL {
            let (table, length) = self.table(side);
            let wanted = 2 * self.blocks * length;
            if table.len() != wanted {
                return fail(format!(
                    "{side:?}: {} values instead of {wanted}",
                    table.len()
                ));
            }
            if let Some(at) = table.iter().position(|height| !height.is_finite()) {
                let block = at / length % self.blocks;
                return fail(format!(
                    "{side:?}: the height at block {block} is {}",
                    table[at]
                ));
            }
        }
        Ok(())
    }
}
