//! Heights of the yarns at the edges of blocks, read off the voxels.
//!
//! What the edge fixing needs (Zhao 2012 §5.5): where the top-most yarn lies along an
//! edge, on each face. That is what is seen: the surface that a look straight at the face
//! stops at, at optical depth 1. Single fibres are no part of an edge's shape, so heights
//! are smoothed over about one of them; gaps are interpolated.

use rayon::prelude::*;

use super::bricks::BrickVolume;
use super::voxelise::VoxelGrid;
use crate::design::Direction;
use crate::synthesis::{Catalogue, Crown, EdgeHeights, Face, Place, Side};
use crate::yarn::WeaveGeometry;

/// How far on either side of a border a crown is looked at, as a share of the block.
const CROWN_REACH: f32 = 0.12;
/// The middle of a yarn whose mean height is its crown, as a share of the block.
const CROWN_WIDTH: f32 = 0.6;
/// Standard deviation of the smoothing along an edge, mm: fibres are 10–20 µm thick.
const SMOOTHING_MM: f32 = 0.015;

/// Puts into `heights` what one exemplar's voxels show. `full` is the extinction of a
/// voxel wholly inside fibre, 1/mm: of warps, of wefts.
pub(super) fn measure(
    heights: &mut EdgeHeights,
    catalogue: &Catalogue,
    exemplar: usize,
    volume: &BrickVolume,
    grid: &VoxelGrid,
    full: [f32; 2],
) {
    let depths = full.map(|full| full * grid.voxel_mm.z / 255.0);
    let surfaces = Face::ALL.map(|face| surface(volume, depths, face));
    fill(heights, catalogue, exemplar, &|place, side, face| {
        let edge = Edge::new(place, side, grid);
        let size = volume.size();
        let height_at = |across: usize, along: usize| {
            let (x, y) = if edge.axis == 0 {
                (across % size[0], along)
            } else {
                (along, across % size[1])
            };
            surfaces[face as usize][y * size[0] + x]
        };
        let reach = edge.crown_reach(grid);
        let crown = edge.crown(grid, |away| {
            let across = edge.border + size[edge.axis] - reach + away;
            let heights = edge.middle().filter_map(|along| height_at(across, along));
            mean(heights)
        });
        let known: Vec<Option<f32>> = (0..edge.length)
            .map(|position| {
                // The border lies between the last stack on either side of it.
                let sides = [edge.border + size[edge.axis] - 1, edge.border];
                match sides.map(|across| height_at(across, edge.start + position)) {
                    [Some(a), Some(b)] => Some(0.5 * (a + b)),
                    [a, b] => a.or(b),
                }
            })
            .collect();
        (edge.profile(&known, grid), crown)
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
    let mm = [grid.voxel_mm.x, grid.voxel_mm.y];
    fill(heights, catalogue, exemplar, &|place, side, face| {
        let edge = Edge::new(place, side, grid);
        let height_at = |across: f32, along: usize| {
            let across = across * mm[edge.axis];
            let along = (along as f32 + 0.5) * mm[1 - edge.axis];
            let at = if edge.axis == 0 {
                [across, along]
            } else {
                [along, across]
            };
            let z = topmost(weave, at, face)?;
            Some((z - grid.floor_mm()) / grid.voxel_mm.z)
        };
        let border = edge.border as f32;
        let known: Vec<Option<f32>> = (0..edge.length)
            .map(|position| height_at(border, edge.start + position))
            .collect();
        let reach = edge.crown_reach(grid) as f32;
        let crown = edge.crown(grid, |away| {
            let across = border - reach + away as f32 + 0.5;
            mean(edge.middle().filter_map(|along| height_at(across, along)))
        });
        (edge.profile(&known, grid), crown)
    });
}

/// Height of the outermost yarn of a layout at a place, mm; `None` between the yarns.
fn topmost(weave: &WeaveGeometry, at: [f32; 2], face: Face) -> Option<f32> {
    let pitch = weave.pitch.to_array();
    [Direction::Warp, Direction::Weft]
        .into_iter()
        .enumerate()
        .flat_map(|(own, direction)| {
            let count = weave.yarns(direction).len() as i64;
            let nearest = (at[own] / pitch[own]).floor() as i64;
            // Yarns bulge past their pitch.
            (nearest - 1..=nearest + 1).filter_map(move |yarn| {
                let index = yarn.rem_euclid(count);
                let across = at[own] - (yarn - index) as f32 * pitch[own];
                let (along, upper) = (at[1 - own], face == Face::Front);
                weave.surface(direction, index as usize, along, across, upper)
            })
        })
        .reduce(|a, b| match face {
            Face::Front => a.max(b),
            Face::Back => a.min(b),
        })
}

/// Where one edge of a block lies in its exemplar, in voxels.
struct Edge {
    /// The axis across the edge.
    axis: usize,
    /// The border's place on that axis.
    border: usize,
    /// Where the edge starts on the other axis, and how many stacks it has.
    start: usize,
    length: usize,
}

impl Edge {
    fn new(place: Place, side: Side, grid: &VoxelGrid) -> Self {
        let (axis, far) = match side {
            Side::Left => (0, 0),
            Side::Right => (0, 1),
            Side::Below => (1, 0),
            Side::Above => (1, 1),
        };
        let crossing = [usize::from(place.x), usize::from(place.y)];
        let length = grid.block[1 - axis];
        Self {
            axis,
            border: (crossing[axis] + far) * grid.block[axis],
            start: crossing[1 - axis] * length,
            length,
        }
    }

    /// Stacks on either side of the border at which a crown is looked at.
    fn crown_reach(&self, grid: &VoxelGrid) -> usize {
        let block = grid.block[self.axis];
        ((CROWN_REACH * block as f32).round() as usize).clamp(1, block)
    }

    /// Stacks along the edge that the crown of a yarn takes in.
    fn middle(&self) -> std::ops::Range<usize> {
        let aside = (0.5 * (1.0 - CROWN_WIDTH) * self.length as f32).round() as usize;
        self.start + aside..(self.start + self.length - aside).max(self.start + aside + 1)
    }

    /// The straight line through the heights of a yarn's middle on both sides of the border;
    /// `height(k)` is the k-th of them, half a stack and more beyond the first. A yarn that is
    /// not seen lies level at half height.
    fn crown(&self, grid: &VoxelGrid, height: impl Fn(usize) -> Option<f32>) -> Crown {
        let reach = self.crown_reach(grid);
        let points = (0..2 * reach).filter_map(|away| {
            let at = away as f32 + 0.5 - reach as f32;
            Some([1.0, at, at * at, height(away)?, at * height(away)?])
        });
        let sums = points.fold([0.0f64; 5], |sums, point| {
            std::array::from_fn(|k| sums[k] + f64::from(point[k]))
        });
        let [n, x, xx, y, xy] = sums;
        let spread = n * xx - x * x;
        if n == 0.0 {
            let height = 0.5 * grid.block[2] as f32;
            return Crown { height, slope: 0.0 };
        }
        let slope = if spread > 0.0 {
            (n * xy - x * y) / spread
        } else {
            0.0
        };
        Crown {
            height: ((y - slope * x) / n) as f32,
            slope: slope as f32,
        }
    }

    /// The profile of an edge from the heights that are known along it; an edge without
    /// any lies at half height.
    fn profile(&self, known: &[Option<f32>], grid: &VoxelGrid) -> Vec<f32> {
        let along = [grid.voxel_mm.x, grid.voxel_mm.y][1 - self.axis];
        match interpolate(known) {
            Some(heights) => smooth(&heights, SMOOTHING_MM / along),
            None => vec![0.5 * grid.block[2] as f32; self.length],
        }
    }
}

/// Height in voxels at which the optical depth, seen from a face, passes 1, by stack in
/// rows along x; `None` where one looks through. `depths` is the optical depth of a voxel
/// across the fibres for each 1/255 of fill: of warps, of wefts.
fn surface(volume: &BrickVolume, depths: [f32; 2], face: Face) -> Vec<Option<f32>> {
    let [width, height, layers] = volume.size();
    let of_stack = |stack: usize| {
        let mut depth = 0.0;
        for k in 0..layers {
            let z = match face {
                Face::Front => layers - 1 - k,
                Face::Back => k,
            };
            let voxel = volume.get(stack % width, stack / width, z);
            if voxel.fill() == 0 {
                continue;
            }
            // Smooth fibres show their length times the sine to the line of sight.
            let rise = voxel.direction().z;
            let area = (1.0 - rise * rise).max(0.0).sqrt();
            let gain = f32::from(voxel.fill()) * depths[usize::from(voxel.is_weft())] * area;
            if depth + gain >= 1.0 {
                let into = (1.0 - depth) / gain;
                return Some(match face {
                    Face::Front => z as f32 + 1.0 - into,
                    Face::Back => z as f32 + into,
                });
            }
            depth += gain;
        }
        None
    };
    (0..width * height).into_par_iter().map(of_stack).collect()
}

/// Gaussian means along a profile, of `sigma` stacks; the ends continue constantly.
fn smooth(profile: &[f32], sigma: f32) -> Vec<f32> {
    if !(sigma > 0.1) {
        return profile.to_vec();
    }
    let last = profile.len() as i64 - 1;
    let reach = ((3.0 * sigma).ceil() as i64).min(last + 1);
    let weights: Vec<f32> = (-reach..=reach)
        .map(|step| (-0.5 * (step as f32 / sigma).powi(2)).exp())
        .collect();
    let total: f32 = weights.iter().sum();
    (0..=last)
        .map(|at| {
            let heights = (at - reach..=at + reach).map(|k| profile[k.clamp(0, last) as usize]);
            let sum: f32 = weights.iter().zip(heights).map(|(w, h)| w * h).sum();
            sum / total
        })
        .collect()
}

/// Fills the profiles and crowns of one exemplar's blocks.
fn fill(
    heights: &mut EdgeHeights,
    catalogue: &Catalogue,
    exemplar: usize,
    edge: &(dyn Fn(Place, Side, Face) -> (Vec<f32>, Crown) + Sync),
) {
    let edges: Vec<_> = (0..catalogue.blocks() as u16)
        .filter(|&id| usize::from(catalogue.place(id).exemplar) == exemplar)
        .flat_map(|id| Side::ALL.map(|side| (id, side)))
        .collect();
    let found: Vec<[(Vec<f32>, Crown); 2]> = edges
        .par_iter()
        .map(|&(id, side)| Face::ALL.map(|face| edge(catalogue.place(id), side, face)))
        .collect();
    for (&(id, side), found) in edges.iter().zip(&found) {
        for (face, (profile, crown)) in Face::ALL.into_iter().zip(found) {
            heights.profile_mut(face, id, side).copy_from_slice(profile);
            *heights.crown_mut(face, id, side) = *crown;
        }
    }
}

/// The mean of some heights; `None` of none.
fn mean(heights: impl Iterator<Item = f32>) -> Option<f32> {
    let (sum, count) = heights.fold((0.0, 0.0), |(sum, count), height| {
        (sum + height, count + 1.0)
    });
    (count > 0.0).then(|| sum / count)
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

    #[test]
    fn smoothing_keeps_levels_and_forgets_fibres() {
        assert_eq!(smooth(&[2.0; 5], 1.5), vec![2.0; 5]);
        let ragged: Vec<f32> = (0..40)
            .map(|k| if k % 2 == 0 { 1.0 } else { -1.0 })
            .collect();
        let smoothed = smooth(&ragged, 2.0);
        assert!(
            smoothed[8..32].iter().all(|h| h.abs() < 1e-2),
            "{smoothed:?}"
        );
        // Control: a slope is no fibre.
        let slope: Vec<f32> = (0..40).map(|k| k as f32).collect();
        let kept = smooth(&slope, 2.0);
        assert!((8..32).all(|k| (kept[k] - k as f32).abs() < 1e-3));
        assert_eq!(smooth(&ragged, 0.0), ragged);
    }
}
