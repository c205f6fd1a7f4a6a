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

impl Catalogue {
    /// Whether the yarn that is seen on a face of a block crosses a side of it and is seen
    /// beyond, in the block's own exemplar: a float runs on there.
    pub fn runs_on(&self, block: u16, side: Side, face: Face) -> bool {
        let key = self.key(block);
        let warp_up = key & 1 == 1;
        let along_warp = matches!(side, Side::Below | Side::Above);
        let warp_seen = warp_up == (face == Face::Front);
        along_warp == warp_seen && (key >> side as u8 & 1 == 1) == warp_up
    }
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
    /// \[face\]\[block\]\[side\]: the crown of the yarn that is seen and crosses the edge.
    /// Those of edges that it does not cross say nothing.
    pub crowns: Vec<Crown>,
}

/// The middle of a yarn's surface where it crosses an edge.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Crown {
    /// Height at the border, voxels.
    pub height: f32,
    /// How much it rises along +x or +y, voxels a stack.
    pub slope: f32,
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
            crowns: vec![Crown::default(); 2 * blocks * Side::ALL.len()],
        }
    }

    /// The crown at a block's edge on a face.
    pub fn crown(&self, face: Face, block: u16, side: Side) -> Crown {
        self.crowns[self.crown_at(face, block, side)]
    }

    /// The same, to be written.
    pub fn crown_mut(&mut self, face: Face, block: u16, side: Side) -> &mut Crown {
        let at = self.crown_at(face, block, side);
        &mut self.crowns[at]
    }

    fn crown_at(&self, face: Face, block: u16, side: Side) -> usize {
        (face as usize * self.blocks + usize::from(block)) * Side::ALL.len() + side.index()
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
        let wanted = 2 * self.blocks * Side::ALL.len();
        if self.crowns.len() != wanted {
            return fail(format!("{} crowns instead of {wanted}", self.crowns.len()));
        }
        let wild = |crown: &Crown| !(crown.height.is_finite() && crown.slope.is_finite());
        if let Some(at) = self.crowns.iter().position(wild) {
            let block = at / Side::ALL.len() % self.blocks;
            return fail(format!(
                "the crown at block {block} is {:?}",
                self.crowns[at]
            ));
        }
        Ok(())
    }
}
