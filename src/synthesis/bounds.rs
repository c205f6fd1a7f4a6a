//! How far the stacks of a block can be shifted, whatever stands beside it.
//!
//! Majorants of the cloth need this before any assignment is known. The shift is a sum
//! over the four edges of ½ (field of the neighbour's edge − field of the own edge), and
//! neighbours on different sides are independent; so the extremes of each edge over all
//! possible neighbours, taken stack by stack, are exact for one edge and add up.

use rayon::prelude::*;

use super::catalogue::{Catalogue, Side};
use super::edges::{BOUND_COLUMN, EdgeFix, NeighbourBits};
use super::heights::Face;
use super::lookup::BlockRef;

/// Widens bounds for the rounding of single-precision sums, in voxels.
const SLACK: f32 = 1e-3;

/// `[face][set][block][column of stacks]`: lowest and highest shift.
#[derive(Debug, Clone, Default)]
pub(super) struct Bounds {
    columns: usize,
    consistent: Vec<[f32; 2]>,
    any: Vec<[f32; 2]>,
}

/// Lowest and highest field that each side can receive from a neighbour, by the
/// neighbour's yarn on top: `[side][bit][stack]`.
type Received = [[Vec<[f32; 2]>; 2]; 4];

impl Bounds {
    pub(super) fn new(fix: &EdgeFix, catalogue: &Catalogue) -> Self {
        let (bx, by) = fix.block_size();
        let mut bounds = Self {
            columns: bx.div_ceil(BOUND_COLUMN) * by.div_ceil(BOUND_COLUMN),
            ..Self::default()
        };
        let blocks: Vec<BlockRef> = fix.every_block().collect();
        for face in Face::ALL {
            let received = received(fix, catalogue, &blocks, face);
            let pairs: Vec<_> = blocks
                .par_iter()
                .map(|&block| {
                    let own = Side::ALL.map(|side| {
                        (fix.may_shift(block.block, side, face))
                            .then(|| fix.edge_field(block, face, side, side))
                    });
                    let key = catalogue.key(block.block);
                    (
                        over_columns(fix, &own, &received, Some(key)),
                        over_columns(fix, &own, &received, None),
                    )
                })
                .collect();
            for (consistent, any) in pairs {
                bounds.consistent.extend(consistent);
                bounds.any.extend(any);
            }
        }
        bounds
    }

    pub(super) fn of(&self, row: usize, bits: NeighbourBits) -> &[[f32; 2]] {
        let table = match bits {
            NeighbourBits::Consistent => &self.consistent,
            NeighbourBits::Any => &self.any,
        };
        table
            .get(row * self.columns..(row + 1) * self.columns)
            .unwrap_or(&[])
    }

    pub(super) fn bytes(&self) -> usize {
        (self.consistent.len() + self.any.len()) * size_of::<[f32; 2]>()
    }
}

/// Extremes over all blocks of the field their opposite edge makes across a seam.
fn received(fix: &EdgeFix, catalogue: &Catalogue, blocks: &[BlockRef], face: Face) -> Received {
    let (bx, by) = fix.block_size();
    Side::ALL.map(|side| {
        [false, true].map(|warp_up| {
            let widest = || vec![[f32::INFINITY, f32::NEG_INFINITY]; bx * by];
            blocks
                .par_iter()
                .filter(|block| (catalogue.key(block.block) & 1 == 1) == warp_up)
                .filter(|block| fix.may_shift(block.block, side.opposite(), face))
                .fold(widest, |mut extremes, &block| {
                    let field = fix.edge_field(block, face, side.opposite(), side);
                    for ([low, high], value) in extremes.iter_mut().zip(field) {
                        *low = low.min(value);
                        *high = high.max(value);
                    }
                    extremes
                })
                .reduce(widest, |mut extremes, others| {
                    for ([low, high], other) in extremes.iter_mut().zip(others) {
                        *low = low.min(other[0]);
                        *high = high.max(other[1]);
                    }
                    extremes
                })
        })
    })
}

/// Bounds of one block over each column of stacks; `key` fixes the neighbours' bits.
fn over_columns(
    fix: &EdgeFix,
    own: &[Option<Vec<f32>>; 4],
    received: &Received,
    key: Option<u8>,
) -> Vec<[f32; 2]> {
    let (bx, by) = fix.block_size();
    let across = bx.div_ceil(BOUND_COLUMN);
    let mut columns = vec![[0.0f32, 0.0]; across * by.div_ceil(BOUND_COLUMN)];
    for y in 0..by {
        for x in 0..bx {
            let stack = y * bx + x;
            let (mut lowest, mut highest) = (-SLACK, SLACK);
            for side in Side::ALL {
                let bits: &[usize] = match key.map(|key| key >> side as u8 & 1) {
                    Some(0) => &[0],
                    Some(_) => &[1],
                    None => &[0, 1],
                };
                let Some(own) = &own[side.index()] else {
                    continue;
                };
                let own = own[stack];
                // Without a seam, or without a neighbour, the edge adds nothing.
                let (mut low, mut high) = (0.0f32, 0.0f32);
                for &bit in bits {
                    let [least, most] = received[side.index()][bit][stack];
                    low = low.min(0.5 * (least - own));
                    high = high.max(0.5 * (most - own));
                }
                lowest += low;
                highest += high;
            }
            let column = &mut columns[y / BOUND_COLUMN * across + x / BOUND_COLUMN];
            column[0] = column[0].min(lowest);
            column[1] = column[1].max(highest);
        }
    }
    columns
}
