//! Heights of the yarns at the edges of blocks, read off the voxels.
//!
//! What the edge fixing needs (Zhao 2012 §5.5): where the yarn that crosses an edge lies,
//! on each face. Gaps beside the yarn are interpolated.

use rayon::prelude::*;

use super::bricks::BrickVolume;
use crate::synthesis::{Catalogue, EdgeHeights, Face, Side};

/// Fill (of 255) from which a voxel counts as part of a yarn's surface.
const SURFACE: u8 = 60;

/// Measures all blocks of a catalogue; `volumes` holds one grid a weave, of `block` voxels
/// a crossing.
pub(super) fn edge_heights(
    catalogue: &Catalogue,
    volumes: &[BrickVolume],
    block: [usize; 3],
) -> EdgeHeights {
    let mut heights = EdgeHeights::flat(catalogue.blocks(), block[0], block[1]);
    let edges: Vec<_> = (0..catalogue.blocks() as u16)
        .flat_map(|id| Side::ALL.map(|side| (id, side)))
        .collect();
    let measured: Vec<[Vec<f32>; 2]> = edges
        .par_iter()
        .map(|&(id, side)| {
            let place = catalogue.place(id);
            let volume = &volumes[usize::from(place.exemplar)];
            Face::ALL
                .map(|face| profile(volume, [place.x.into(), place.y.into()], block, side, face))
        })
        .collect();
    for (&(id, side), profiles) in edges.iter().zip(&measured) {
        for (face, profile) in Face::ALL.into_iter().zip(profiles) {
            heights.profile_mut(face, id, side).copy_from_slice(profile);
        }
    }
    heights
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
    let (axis, far) = match side {
        Side::Left => (0, false),
        Side::Right => (0, true),
        Side::Below => (1, false),
        Side::Above => (1, true),
    };
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
