//! The hairs of a cloth as a medium of their own, beside the blocks.
//!
//! One layer lies on each face. A layer's patch repeats in mm, and its heights count from
//! the crowns of the yarns that are on top, blended between crossings.

use std::sync::Arc;

use glam::{Vec2, Vec3};

use super::build::ClothVolume;
use crate::exemplar::CELL;
use crate::exemplar::hairs::{HairPatch, root_step};
use crate::render::{Bounds, MajorantWalk, Medium, Ray, Stretch, Voxel};
use crate::yarn::{WeaveGeometry, YarnRecipe};

/// Most cells that one walk visits.
const MAX_CELLS: u32 = 1 << 20;

/// The hairs on both faces of a cloth.
pub struct HairLayer<'a> {
    cloth: &'a ClothVolume,
    patch: Arc<HairPatch>,
    /// Whether each yarn has hairs.
    hairy: Vec<bool>,
    /// Height of the crowns on the front and on the back: where a weft and where a warp
    /// lies on that face, mm.
    crowns: [[f32; 2]; 2],
    /// Extinction of a voxel wholly inside fibre: warp, weft.
    full: [f32; 2],
}

impl<'a> HairLayer<'a> {
    /// The hairs of a cloth; `None` when no yarn of it has any.
    pub fn new(cloth: &'a ClothVolume, hairy: Vec<bool>) -> Option<Self> {
        let set = cloth.sets().iter().max_by(|a, b| {
            let hairs = |s: &crate::exemplar::ExemplarSet| {
                s.pair.warp.hairs_per_mm + s.pair.weft.hairs_per_mm
            };
            hairs(a).total_cmp(&hairs(b))
        })?;
        let pitch = Vec2::new(
            cloth.ends().repeat_mm() as f32 / cloth.ends().threads() as f32,
            cloth.picks().repeat_mm() as f32 / cloth.picks().threads() as f32,
        );
        let patch = HairPatch::new(&set.pair.warp, &set.pair.weft, pitch, 16)?;
        Some(Self {
            cloth,
            crowns: crowns(&set.pair.warp, &set.pair.weft, pitch),
            full: [&set.pair.warp, &set.pair.weft].map(YarnRecipe::full_extinction),
            patch: Arc::new(patch),
            hairy,
        })
    }

    /// Height of the surface of a face at a place, mm: crowns blended between crossings.
    fn surface(&self, face: usize, x: f32, y: f32) -> f32 {
        let [weft, warp] = self.crowns[face];
        if (weft - warp).abs() < 1e-4 {
            return weft;
        }
        let (end, u) = self.cloth.ends().locate(x.into());
        let (pick, v) = self.cloth.picks().locate(y.into());
        let (u, v) = (u as f32 - 0.5, v as f32 - 0.5);
        let (dx, dy) = (if u < 0.0 { -1 } else { 1 }, if v < 0.0 { -1 } else { 1 });
        let crown = |end, pick| {
            let up = self.cloth.warp_up(end, pick).unwrap_or(false);
            if up == (face == 0) { warp } else { weft }
        };
        let (u, v) = (u.abs(), v.abs());
        let low = crown(end, pick) * (1.0 - u) + crown(end + dx, pick) * u;
        let high = crown(end, pick + dy) * (1.0 - u) + crown(end + dx, pick + dy) * u;
        low * (1.0 - v) + high * v
    }

    /// Range of a face's surface, mm.
    fn surface_range(&self, face: usize) -> (f32, f32) {
        let [a, b] = self.crowns[face];
        (a.min(b), a.max(b))
    }
}

/// Crown heights of a plain weave of these yarns, front and back: weft up, warp up.
fn crowns(warp: &YarnRecipe, weft: &YarnRecipe, pitch: Vec2) -> [[f32; 2]; 2] {
    use crate::yarn::Direction;
    let plain = crate::design::WeavePattern::from_fn(2, 2, |end, pick| (end + pick) % 2 == 0);
    let weave = WeaveGeometry::new(&plain, warp, weft, pitch, 0);
    let height = |direction, index: usize, upper| {
        let (own, along) = match direction {
            Direction::Warp => (pitch.x, pitch.y),
            Direction::Weft => (pitch.y, pitch.x),
        };
        let across = (index as f32 + 0.5) * own;
        weave
            .surface(direction, index, 0.5 * along, across, upper)
            .unwrap_or(0.0)
    };
    // Crossing (0, 0) has the warp up, crossing (1, 0) and (0, 1) the weft.
    [
        [
            height(Direction::Weft, 1, true),
            height(Direction::Warp, 0, true),
        ],
        [
            height(Direction::Weft, 0, false),
            height(Direction::Warp, 1, false),
        ],
    ]
}

/// A walk along a ray through the layers.
pub struct HairWalk<'l> {
    layer: &'l HairLayer<'l>,
    ray: Ray,
    /// The layers still to be walked: face, start and end.
    spans: [(usize, f32, f32); 2],
    span: usize,
    t: f32,
    cell: [i64; 3],
    /// The cell of the stretch last given.
    here: [i64; 3],
    next: [f32; 3],
    delta: [f32; 3],
    ready: bool,
    left: u32,
}

impl HairLayer<'_> {
    /// z-range of a face's layer, mm.
    fn slab(&self, face: usize) -> (f32, f32) {
        let (low, high) = self.surface_range(face);
        let (sink, height) = (self.patch.sink_mm, self.patch.size_mm().z);
        if face == 0 {
            (low - sink, high - sink + height)
        } else {
            (low + sink - height, high + sink)
        }
    }

    /// Where cells of a face's layer are counted from, and voxels per mm there.
    fn frame(&self, face: usize) -> (Vec3, Vec3) {
        let (low, high) = self.slab(face);
        let scale = self.patch.voxel_mm.recip() / CELL as f32;
        // The back is the mirror image.
        if face == 0 {
            (Vec3::new(0.0, 0.0, low), scale)
        } else {
            (Vec3::new(0.0, 0.0, high), scale * Vec3::new(1.0, 1.0, -1.0))
        }
    }
}

impl Medium for HairLayer<'_> {
    type Walk<'m>
        = HairWalk<'m>
    where
        Self: 'm;

    fn bounds(&self) -> Bounds {
        let mut bounds = self.cloth.bounds();
        bounds.max.z = bounds.max.z.max(self.slab(0).1);
        bounds.min.z = bounds.min.z.min(self.slab(1).0);
        bounds
    }

    fn walk(&self, ray: &Ray, t_max: f32) -> HairWalk<'_> {
        let outer = self.bounds();
        let clip = |face: usize| {
            let (low, high) = self.slab(face);
            let bounds = Bounds {
                min: outer.min.with_z(low),
                max: outer.max.with_z(high),
            };
            let (start, end) = bounds.clip(ray, t_max);
            (face, start, end)
        };
        let mut spans = [clip(0), clip(1)];
        if ray.direction.z > 0.0 {
            spans.swap(0, 1);
        }
        HairWalk {
            layer: self,
            ray: *ray,
            spans,
            span: 0,
            t: 0.0,
            cell: [0; 3],
            here: [0; 3],
            next: [0.0; 3],
            delta: [0.0; 3],
            ready: false,
            left: MAX_CELLS,
        }
    }

    fn albedo(&self, optics: u32) -> Vec3 {
        self.cloth.albedo(optics)
    }
}

impl HairWalk<'_> {
    fn set_up(&mut self) {
        let (face, start, _) = self.spans[self.span];
        let (corner, scale) = self.layer.frame(face);
        let (origin, direction) = (
            (self.ray.origin - corner) * scale,
            self.ray.direction * scale,
        );
        let entry = origin + direction * start;
        self.t = start;
        for axis in 0..3 {
            let cell = entry[axis].floor();
            self.cell[axis] = cell as i64;
            let d = direction[axis];
            if d.abs() > 1e-12 {
                let plane = if d > 0.0 { cell + 1.0 } else { cell };
                self.next[axis] = (plane - origin[axis]) / d;
                self.delta[axis] = (1.0 / d).abs();
            } else {
                self.next[axis] = f32::INFINITY;
                self.delta[axis] = f32::INFINITY;
            }
        }
        self.ready = true;
    }

    /// Bound of the fill in the present cell.
    fn bound(&self) -> u8 {
        let [nx, ny, nz] = self.layer.patch.cells();
        let [x, y, z] = self.cell;
        // Heights above the crowns' lowest may belong to any lift between lowest and
        // highest crown: bounds are widened by one cell, more is looked through here.
        let (low, high) = self.layer.surface_range(self.spans[self.span].0);
        let lift = ((high - low) / (self.layer.patch.voxel_mm.z * CELL as f32)).ceil() as i64;
        let (x, y) = (
            x.rem_euclid(nx as i64) as usize,
            y.rem_euclid(ny as i64) as usize,
        );
        (z - lift..=z)
            .filter(|z| (0..nz as i64).contains(z))
            .map(|z| self.layer.patch.bound([x, y, z as usize]))
            .max()
            .unwrap_or(0)
    }
}

impl MajorantWalk for HairWalk<'_> {
    fn next_stretch(&mut self) -> Option<Stretch> {
        while self.span < 2 && self.left > 0 {
            let (_, start, end) = self.spans[self.span];
            if !self.ready {
                if !(start < end) {
                    self.span += 1;
                    continue;
                }
                self.set_up();
            }
            self.left -= 1;
            if !(self.t < end) {
                // Stay on this span: its last stretch may still be asked for voxels.
                self.span += 1;
                self.ready = false;
                continue;
            }
            let fill = self.bound();
            self.here = self.cell;
            let axis = if self.next[0] < self.next[1] {
                if self.next[0] < self.next[2] { 0 } else { 2 }
            } else if self.next[1] < self.next[2] {
                1
            } else {
                2
            };
            let from = self.t;
            self.t = self.next[axis].min(end).max(from);
            let to = self.t;
            if self.next[axis] < end {
                let (_, scale) = self.layer.frame(self.spans[self.span].0);
                self.cell[axis] += if self.ray.direction[axis] * scale[axis] > 0.0 {
                    1
                } else {
                    -1
                };
                self.next[axis] += self.delta[axis];
            }
            if fill > 0 && to > from {
                let [warp, weft] = self.layer.full;
                let majorant = f32::from(fill) * (1.0 / 255.0) * warp.max(weft);
                return Some(Stretch {
                    start: from,
                    end: to,
                    majorant,
                });
            }
        }
        None
    }

    fn voxel(&self, t: f32, _tap: Vec3) -> Voxel {
        let Some(&(face, ..)) = self.spans.get(self.span) else {
            return Voxel::EMPTY;
        };
        let layer = self.layer;
        let point = self.ray.at(t);
        let over = point.z - layer.surface(face, point.x, point.y);
        let over = if face == 0 { over } else { -over };
        let place = Vec3::new(point.x, point.y, over + layer.patch.sink_mm) / layer.patch.voxel_mm;
        // The stretch lies in one cell; rounding may not carry it beside it.
        let within = |place: f32, cell: i64| {
            let start = (cell * CELL as i64) as f32;
            place.clamp(start, start + CELL as f32 - 1e-2)
        };
        let place = place
            .with_x(within(place.x, self.here[0]))
            .with_y(within(place.y, self.here[1]));
        let voxel = layer.patch.voxel(place);
        if voxel.fill() == 0 {
            return Voxel::EMPTY;
        }
        let weft = voxel.is_weft();
        let (end, _) = layer.cloth.ends().locate(point.x.into());
        let (pick, _) = layer.cloth.picks().locate(point.y.into());
        let step = root_step(voxel);
        let yarn = match weft {
            true => layer.cloth.weft_yarn(end, pick + step),
            false => layer.cloth.warp_yarn(end + step, pick),
        };
        if !layer
            .hairy
            .get(usize::from(yarn.0))
            .copied()
            .unwrap_or(false)
        {
            return Voxel::EMPTY;
        }
        let mut direction = voxel.direction();
        if face == 1 {
            direction.z = -direction.z;
        }
        Voxel {
            sigma: f32::from(voxel.fill()) * (1.0 / 255.0) * layer.full[usize::from(weft)],
            direction,
            alpha: layer.cloth.alpha[usize::from(yarn.0)],
            optics: u32::from(yarn.0),
        }
    }
}
