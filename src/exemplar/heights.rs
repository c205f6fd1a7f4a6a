//! Heights of the yarns at the edges of blocks, read off the voxels.
//!
//! What the edge fixing needs (Zhao 2012 §5.5): where the yarn that crosses an edge lies,
//! on each face. Gaps beside the yarn are interpolated.

use rayon::prelude::*;

use super::bricks::BrickVolume;
use super::voxelise::VoxelGrid;
use crate::synthesis::{Catalogue, EdgeHeights, Face, Place, Side};
use crate::yarn::{Direction, WeaveGeometry};

/// Fill (of 255) from which a voxel counts as part of a yarn's surface.
const SURFACE: u8 = 60;

/// Puts into `heights` what one exemplar's voxels, of `block` voxels a crossing, show.
pub(super) fn measure(
    heights: &mut EdgeHeights,
    catalogue: &Catalogue,
    exemplar: usize,
    volume: &BrickVolume,
    block: [usize; 3],
) {
    fill(heights, catalogue, exemplar, &|place, side, face| {
        profile(volume, [place.x.into(), place.y.into()], block, side, face)
    });
}

/// Puts into `heights` what the layout of one exemplar's yarns predicts.
pub(super) fn predict(
    heights: &mut EdgeHeights,
    catalogue: &Catalogue,
    exemplar: usize,
    weave: &WeaveGeometry,
    grid: &VoxelGrid,
) {
    fill(heights, catalogue, exemplar, &|place, side, face| {
        let crossing = [usize::from(place.x), usize::from(place.y)];
        let (axis, far) = axis_of(side);
        let (direction, index) = match axis {
            0 => (Direction::Weft, crossing[1]),
            _ => (Direction::Warp, crossing[0]),
        };
        let mm = [grid.voxel_mm.x, grid.voxel_mm.y];
        let border = ((crossing[axis] + usize::from(far)) * grid.block[axis]) as f32 * mm[axis];
        let length = grid.block[1 - axis];
        let known: Vec<Option<f32>> = (0..length)
            .map(|position| {
                let across = ((crossing[1 - axis] * length + position) as f32 + 0.5) * mm[1 - axis];
                let z = weave.surface(direction, index, border, across, face == Face::Front)?;
                Some((z - grid.floor_mm()) / grid.voxel_mm.z)
            })
            .collect();
        interpolate(&known).unwrap_or_else(|| vec![0.5 * grid.block[2] as f32; length])
    });
}

/// Fills the profiles of one exemplar's blocks.
fn fill(
    heights: &mut EdgeHeights,
    catalogue: &Catalogue,
    exemplar: usize,
    profile: &(dyn Fn(Place, Side, Face) -> Vec<f32> + Sync),
) {
    let edges: Vec<_> = (0..catalogue.blocks() as u16)
        .filter(|&id| usize::from(catalogue.place(id).exemplar) == exemplar)
        .flat_map(|id| Side::ALL.map(|side| (id, side)))
        .collect();
    let profiles: Vec<[Vec<f32>; 2]> = edges
        .par_iter()
        .map(|&(id, side)| Face::ALL.map(|face| profile(catalogue.place(id), side, face)))
        .collect();
    for (&(id, side), profiles) in edges.iter().zip(&profiles) {
        for (face, profile) in Face::ALL.into_iter().zip(profiles) {
            heights.profile_mut(face, id, side).copy_from_slice(profile);
        }
    }
}

/// The axis across an edge, and whether the edge is at its far end.
fn axis_of(side: Side) -> (usize, bool) {
    match side {
        Side::Left => (0, false),
        Side::Right => (0, true),
        Side::Below => (1, false),
        Side::Above => (1, true),
    }
}

/// Height profile, in voxels, of the yarn that crosses one edge of a block.
fn profile(
    volume: &BrickVolume,
    crossing: [usize; 2],
    block: [usize; 3],
    side: Side,
    face: Face,
) -> Vec<f32> {
    let size = volume.size();
    let (axis, far) = axis_of(side);
    // Wefts cross the left and right edges, warps the others.
    let (weft, yarn) = (axis == 0, crossing[1 - axis]);
    let border = (crossing[axis] + usize::from(far)) * block[axis];
    let length = block[1 - axis];
    let surface = |across: usize, position: usize| {
        let mut at = [0; 2];
        at[axis] = across % size[axis];
        at[1 - axis] = crossing[1 - axis] * length + position;
        let holds = |z: &usize| {
            let voxel = volume.get(at[0], at[1], *z);
            voxel.fill() >= SURFACE && voxel.is_weft() == weft && usize::from(voxel.yarn()) == yarn
        };
        match face {
            Face::Front => (0..size[2]).rev().find(holds),
            Face::Back => (0..size[2]).find(holds),
        }
    };
    // The border lies between the last stack on either side of it.
    let known: Vec<Option<f32>> = (0..length)
        .map(|position| {
            let pair = [border + size[axis] - 1, border].map(|across| surface(across, position));
            match pair {
                [Some(a), Some(b)] => Some(0.5 * (a + b) as f32),
                [a, b] => a.or(b).map(|z| z as f32),
            }
        })
        .collect();
    interpolate(&known).unwrap_or_else(|| vec![0.5 * size[2] as f32; length])
}

/// Fills gaps linearly, ends constantly; `None` when nothing is known.
fn interpolate(known: &[Option<f32>]) -> Option<Vec<f32>> {
    let places: Vec<(usize, f32)> = known
        .iter()
        .enumerate()
        .filter_map(|(i, v)| v.map(|v| (i, v)))
        .collect();
    let (first, last) = (places.first()?, places.last()?);
    let mut values = vec![first.1; known.len()];
    for pair in places.windows(2) {
        let ((from, a), (to, b)) = (pair[0], pair[1]);
        for (position, value) in values.iter_mut().enumerate().take(to + 1).skip(from) {
            *value = a + (b - a) * (position - from) as f32 / (to - from) as f32;
        }
    }
    values[last.0..].fill(last.1);
    Some(values)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gaps_are_interpolated_and_ends_kept() {
        let known = [None, Some(2.0), None, None, Some(5.0), None];
        assert_eq!(
            interpolate(&known),
            Some(vec![2.0, 2.0, 3.0, 4.0, 5.0, 5.0])
        );
        assert_eq!(interpolate(&[None, None]), None);
        assert_eq!(interpolate(&[Some(1.0)]), Some(vec![1.0]));
    }
}
