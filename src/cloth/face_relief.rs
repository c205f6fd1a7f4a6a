//! The relief of a crossing by what stands around it: which yarn is seen where, how it
//! slopes and what hides it from the light.
//!
//! Comes in: a pair of yarns, their spacing and the side that is looked at. Goes out: the
//! spots of every crossing of the catalogue's weaves, from the laid-out yarns alone: no
//! voxels. Any light is then put on them by [`super::FaceTable`].

use glam::{Vec2, Vec3};
use rayon::prelude::*;

use crate::design::{Direction, WeavePattern};
use crate::exemplar::{Pair, layout};
use crate::scene::Pose;
use crate::synthesis::{Catalogue, KEYS, Side, key_of};
use crate::yarn::WeaveGeometry;

/// Texels along a crossing's side at the finest level.
pub const TEXELS: usize = 12;
/// Directions round a spot in which the horizon is searched.
pub(super) const AZIMUTHS: usize = 8;
/// How far, in texels.
const REACH: i64 = TEXELS as i64;
/// How much darker a yarn is at the border of a crossing than in its middle, where light
/// also comes in from the sides.
const ROUNDED: f32 = 0.3;

/// A covered place of some crossing.
pub(super) struct Spot {
    /// Its texel: neighbourhood by neighbourhood, row by row from the lower left.
    pub texel: usize,
    pub warp: bool,
    /// Unit normal, z towards the eye's side.
    pub normal: Vec3,
    /// Tangent of the horizon's height, direction by direction from +x.
    pub horizon: [f32; AZIMUTHS],
    /// How bright its place in the crossing makes it.
    pub rounded: f32,
}

/// The relief of all neighbourhoods of one pair of yarns, seen from one side.
pub struct FaceRelief {
    pub(super) spots: Vec<Spot>,
    /// Crossings of each neighbourhood that the spots are of.
    pub(super) counts: [f32; KEYS],
    /// Which side is seen.
    pub(super) pose: Pose,
}

impl FaceRelief {
    /// The relief of a pair at a spacing of ends and picks (mm), seen from the face or the
    /// back.
    pub fn new(catalogue: &Catalogue, pair: &Pair, pitch: Vec2, pose: Pose) -> Self {
        let spots = (0..catalogue.exemplars())
            .into_par_iter()
            .flat_map_iter(|exemplar| {
                let weave = &catalogue.weaves()[exemplar];
                let geometry = layout(catalogue, pair, pitch, exemplar);
                Heights::of(&geometry, pose).spots(weave)
            })
            .collect();
        let mut counts = [0.0; KEYS];
        for weave in catalogue.weaves() {
            for pick in 0..i64::from(weave.picks()) {
                for end in 0..i64::from(weave.ends()) {
                    counts[usize::from(key_at(weave, end, pick))] += 1.0;
                }
            }
        }
        Self {
            spots,
            counts,
            pose,
        }
    }
}

fn key_at(weave: &WeavePattern, end: i64, pick: i64) -> u8 {
    let up = |end, pick| weave.get_wrapped(end, pick);
    let beside = Side::ALL.map(|side| {
        let (ends, picks) = side.offset();
        up(end + ends, pick + picks)
    });
    key_of(up(end, pick), beside)
}

/// The yarns' surface over one repeat of a weave, upwards to the eye.
struct Heights {
    width: i64,
    height: i64,
    /// Size of a texel, mm.
    texel: Vec2,
    z: Vec<f32>,
    /// Whether the warp is seen; `None` through a gap.
    warp: Vec<Option<bool>>,
}

impl Heights {
    fn of(weave: &WeaveGeometry, pose: Pose) -> Self {
        let size = [weave.warp.len(), weave.weft.len()].map(|threads| (threads * TEXELS) as i64);
        let texel = weave.pitch / TEXELS as f32;
        let mut z = Vec::with_capacity((size[0] * size[1]) as usize);
        let mut warp = Vec::with_capacity(z.capacity());
        for row in 0..size[1] {
            for column in 0..size[0] {
                let top = top_at(weave, [column, row], texel, pose);
                z.push(top.map_or(f32::NAN, |(z, _)| z));
                warp.push(top.map(|(_, warp)| warp));
            }
        }
        let floor = z
            .iter()
            .copied()
            .filter(|z| z.is_finite())
            .fold(0.0, f32::min);
        for z in z.iter_mut().filter(|z| z.is_nan()) {
            *z = floor;
        }
        Self {
            width: size[0],
            height: size[1],
            texel,
            z,
            warp,
        }
    }

    fn index(&self, column: i64, row: i64) -> usize {
        (row.rem_euclid(self.height) * self.width + column.rem_euclid(self.width)) as usize
    }

    fn z(&self, column: i64, row: i64) -> f32 {
        self.z[self.index(column, row)]
    }

    fn normal(&self, column: i64, row: i64) -> Vec3 {
        let slope = Vec2::new(
            self.z(column + 1, row) - self.z(column - 1, row),
            self.z(column, row + 1) - self.z(column, row - 1),
        ) / (2.0 * self.texel);
        Vec3::new(-slope.x, -slope.y, 1.0).normalize_or(Vec3::Z)
    }

    fn horizon(&self, column: i64, row: i64) -> [f32; AZIMUTHS] {
        let here = self.z(column, row);
        std::array::from_fn(|azimuth| {
            let away = Vec2::from_angle(azimuth as f32 * std::f32::consts::TAU / AZIMUTHS as f32);
            (1..=REACH)
                .map(|step| {
                    let off = (away * step as f32).round();
                    let rise = self.z(column + off.x as i64, row + off.y as i64) - here;
                    rise / (off * self.texel).length()
                })
                .fold(0.0, f32::max)
        })
    }

    fn spots(&self, weave: &WeavePattern) -> Vec<Spot> {
        let side = TEXELS as i64;
        let rounded = |place: i64| {
            let off = (2 * place + 1 - side) as f32 / side as f32;
            1.0 - ROUNDED * off * off
        };
        let mut spots = Vec::with_capacity(self.z.len());
        for row in 0..self.height {
            for column in 0..self.width {
                let Some(warp) = self.warp[self.index(column, row)] else {
                    continue;
                };
                let key = usize::from(key_at(weave, column / side, row / side));
                let (x, y) = (column % side, row % side);
                spots.push(Spot {
                    texel: (key * TEXELS + y as usize) * TEXELS + x as usize,
                    warp,
                    normal: self.normal(column, row),
                    horizon: self.horizon(column, row),
                    rounded: rounded(x) * rounded(y),
                });
            }
        }
        spots
    }
}

/// Height of the yarn that is seen at a texel and whether it is the warp; `None` through a
/// gap. The threads beside a crossing may bulge into it.
fn top_at(
    weave: &WeaveGeometry,
    [column, row]: [i64; 2],
    texel: Vec2,
    pose: Pose,
) -> Option<(f32, bool)> {
    let side = pose.up();
    let place = Vec2::new(column as f32 + 0.5, row as f32 + 0.5) * texel;
    let (end, pick) = (column / TEXELS as i64, row / TEXELS as i64);
    let mut top: Option<(f32, bool)> = None;
    for beside in -1..=1 {
        for (direction, thread, along, across, pitch) in [
            (
                Direction::Warp,
                end + beside,
                place.y,
                place.x,
                weave.pitch.x,
            ),
            (
                Direction::Weft,
                pick + beside,
                place.x,
                place.y,
                weave.pitch.y,
            ),
        ] {
            let index = thread.rem_euclid(weave.yarns(direction).len() as i64);
            let across = across - (thread - index) as f32 * pitch;
            let surface = weave.surface(direction, index as usize, along, across, !pose.back);
            if let Some(z) = surface.map(|z| side * z)
                && top.is_none_or(|(highest, _)| z > highest)
            {
                top = Some((z, direction == Direction::Warp));
            }
        }
    }
    top
}
