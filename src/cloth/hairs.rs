//! The hairs of a cloth as a medium of their own, beside the blocks.
//!
//! One layer lies on each face. A layer's patch repeats in mm, and its heights count from
//! the crowns of the yarns that are on top, blended between crossings.

use std::sync::Arc;

use glam::{IVec3, Vec2, Vec3};

use super::build::ClothVolume;
use super::hair_cells::{HairCell, HairCells};
use crate::design::{Positions, Yarn};
use crate::exemplar::hairs::{HAIRLESS, HairPatch, root_step};
use crate::exemplar::{CELL, cell_of};
use crate::render::{MajorantWalk, Medium, SYSTEM, Stretch, Voxel};
use crate::scene::{Bounds, Ray};
use crate::volume::cells::CellRay;
use crate::yarn::{WeaveGeometry, YarnRecipe};

/// Most cells that one walk visits.
const MAX_CELLS: u32 = 1 << 20;

/// What the hairs of a cloth are made of, wherever it is looked at.
pub struct HairStock {
    patch: HairPatch,
    /// Height of the crowns on the front and on the back: where a weft and where a warp
    /// lies on that face, mm.
    crowns: [[f32; 2]; 2],
    /// Cells of the front's and of the back's layer.
    cells: [HairCells; 2],
    /// Extinction of a voxel wholly inside fibre: warp, weft.
    full: [f32; 2],
}

impl HairStock {
    /// That of a cloth: it is worth keeping, as long as families, sizes and spacing of the yarns
    /// stay. `None` when no yarn has any hairs.
    pub fn new(cloth: &ClothVolume) -> Option<Self> {
        let set = hairiest(cloth)?;
        let (warp, weft) = (&set.pair.warp, &set.pair.weft);
        let patch = HairPatch::new(warp, weft, pitch(cloth), 16)?;
        let crowns = crowns(warp, weft, pitch(cloth));
        let cell_mm = patch.voxel_mm.z * CELL as f32;
        Some(Self {
            cells: crowns.map(|[a, b]| {
                let lift = ((a - b).abs() / cell_mm).ceil() as usize;
                HairCells::new(&patch, lift)
            }),
            crowns,
            full: [warp, weft].map(YarnRecipe::full_extinction),
            patch,
        })
    }
}

/// The hairs on both faces of a cloth.
pub struct HairLayer<'a> {
    cloth: &'a ClothVolume,
    stock: Arc<HairStock>,
    /// Whether each yarn has hairs.
    hairy: Vec<bool>,
    /// Where a patch begins, mm: the first thread is at the corner of one.
    corner: Vec2,
}

impl<'a> HairLayer<'a> {
    /// Whether each yarn has hairs.
    pub fn hairy(yarns: &[Yarn]) -> Vec<bool> {
        let hairs = |yarn: &Yarn| YarnRecipe::family(yarn.family, yarn.diameter()).hairs_per_mm;
        yarns.iter().map(|yarn| hairs(yarn) >= HAIRLESS).collect()
    }

    /// The hairs of a cloth; `None` when no yarn of it has any.
    pub fn new(cloth: &'a ClothVolume, hairy: Vec<bool>) -> Option<Self> {
        Some(Self::of(cloth, Arc::new(HairStock::new(cloth)?), hairy))
    }

    /// The hairs of a cloth, from its own stock.
    pub fn of(cloth: &'a ClothVolume, stock: Arc<HairStock>, hairy: Vec<bool>) -> Self {
        let size = stock.patch.size_mm();
        let corner = |threads: &Positions, size: f32| {
            0.0 - threads.origin_mm().rem_euclid(f64::from(size)) as f32
        };
        Self {
            corner: Vec2::new(corner(cloth.ends(), size.x), corner(cloth.picks(), size.y)),
            cloth,
            stock,
            hairy,
        }
    }

    /// Size of a voxel of the layer, mm.
    pub fn patch_voxel_mm(&self) -> Vec3 {
        self.stock.patch.voxel_mm
    }

    /// Height of the surface of a face at a place, mm: crowns blended between crossings.
    fn surface(&self, face: usize, place: Vec3) -> f32 {
        let [weft, warp] = self.stock.crowns[face];
        if (weft - warp).abs() < 1e-4 {
            return weft;
        }
        let (end, u) = self.cloth.ends().locate(place.x.into());
        let (pick, v) = self.cloth.picks().locate(place.y.into());
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
        let [a, b] = self.stock.crowns[face];
        (a.min(b), a.max(b))
    }
}

/// The exemplar set whose yarns have the most hairs.
fn hairiest(cloth: &ClothVolume) -> Option<&Arc<crate::exemplar::ExemplarSet>> {
    cloth.sets().iter().max_by(|a, b| {
        let hairs =
            |s: &crate::exemplar::ExemplarSet| s.pair.warp.hairs_per_mm + s.pair.weft.hairs_per_mm;
        hairs(a).total_cmp(&hairs(b))
    })
}

/// Mean spacing of ends and picks, mm.
fn pitch(cloth: &ClothVolume) -> Vec2 {
    Vec2::new(
        cloth.ends().repeat_mm() as f32 / cloth.ends().threads() as f32,
        cloth.picks().repeat_mm() as f32 / cloth.picks().threads() as f32,
    )
}

/// Crown heights of a plain weave of these yarns, front and back: weft up, warp up.
fn crowns(warp: &YarnRecipe, weft: &YarnRecipe, pitch: Vec2) -> [[f32; 2]; 2] {
    use crate::design::Direction;
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
    cell: IVec3,
    /// The cell of the stretch last given.
    here: IVec3,
    /// The ray in cells of the present layer, once it is entered.
    cells: Option<CellRay>,
    left: u32,
}

impl HairLayer<'_> {
    /// z-range of a face's layer, mm.
    fn slab(&self, face: usize) -> (f32, f32) {
        let (low, high) = self.surface_range(face);
        let (sink, height) = (self.stock.patch.sink_mm, self.stock.patch.size_mm().z);
        if face == 0 {
            (low - sink, high - sink + height)
        } else {
            (low + sink - height, high + sink)
        }
    }

    /// Where cells of a face's layer are counted from, and voxels per mm there.
    fn frame(&self, face: usize) -> (Vec3, Vec3) {
        let (low, high) = self.slab(face);
        let scale = self.stock.patch.voxel_mm.recip() / CELL as f32;
        let corner = self.corner.extend(0.0);
        // The back is the mirror image.
        if face == 0 {
            (corner.with_z(low), scale)
        } else {
            (corner.with_z(high), scale * Vec3::new(1.0, 1.0, -1.0))
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
            cell: IVec3::ZERO,
            here: IVec3::ZERO,
            cells: None,
            left: MAX_CELLS,
        }
    }

    fn albedo(&self, optics: u32) -> Vec3 {
        self.cloth.albedo(optics)
    }
}

impl HairWalk<'_> {
    /// Enters the present layer.
    fn set_up(&mut self) -> CellRay {
        let (face, start, _) = self.spans[self.span];
        let (corner, scale) = self.layer.frame(face);
        let cells = CellRay::new(&self.ray, corner, scale);
        self.t = start;
        let entry = cells.at(start);
        self.cell = IVec3::from_array(entry.to_array().map(cell_of));
        self.cells = Some(cells);
        cells
    }

    /// Goes on to where the ray leaves the cube of cells that reaches `reach` cells beyond the
    /// present one; gives the distance.
    #[inline]
    fn leave_cube(&mut self, cells: &CellRay, reach: i32) -> f32 {
        let (distance, out) = cells.exit_cube(self.cell, reach);
        let exit = cells.at(distance.max(self.t));
        for axis in 0..3 {
            let cell = self.cell[axis];
            self.cell[axis] = if axis == out {
                cell.saturating_add(cells.step(axis) * (reach + 1))
            } else {
                // Rounding may not carry the ray out of the cube by another side.
                let (low, high) = (cell.saturating_sub(reach), cell.saturating_add(reach));
                cell_of(exit[axis]).clamp(low, high)
            };
        }
        distance
    }
}

impl MajorantWalk for HairWalk<'_> {
    fn next_stretch(&mut self) -> Option<Stretch> {
        while self.span < 2 && self.left > 0 {
            let (face, start, end) = self.spans[self.span];
            let cells = match self.cells {
                Some(cells) => cells,
                None if start < end => self.set_up(),
                None => {
                    self.span += 1;
                    continue;
                }
            };
            self.left -= 1;
            if !(self.t < end) {
                // Stay on this span: its last stretch may still be asked for voxels.
                self.span += 1;
                self.cells = None;
                continue;
            }
            let HairCell { fill, reach } = self.layer.stock.cells[face].at(self.cell.to_array());
            self.here = self.cell;
            let from = self.t;
            let reach = i32::from(reach).max(1) - 1;
            self.t = self.leave_cube(&cells, reach).min(end).max(from);
            if fill > 0 && self.t > from {
                let [warp, weft] = self.layer.stock.full;
                let majorant = f32::from(fill) * (1.0 / 255.0) * warp.max(weft);
                return Some(Stretch {
                    start: from,
                    end: self.t,
                    majorant,
                });
            }
        }
        None
    }

    fn voxel(&self, t: f32, _tap: Vec3, least: f32) -> Voxel {
        let Some(&(face, ..)) = self.spans.get(self.span) else {
            return Voxel::EMPTY;
        };
        let layer = self.layer;
        let point = self.ray.at(t);
        let over = point.z - layer.surface(face, point);
        let over = if face == 0 { over } else { -over };
        let place = point.truncate() - layer.corner;
        let place = place.extend(over + layer.stock.patch.sink_mm) / layer.stock.patch.voxel_mm;
        // The stretch lies in one cell; rounding may not carry it beside it.
        let within = |place: f32, low: i32, high: i32| {
            let [low, high] = [low, high].map(|cell| (cell * CELL as i32) as f32);
            place.clamp(low, high - 1e-2)
        };
        let [x, y, z] = self.here.to_array();
        let place = Vec3::new(
            within(place.x, x, x + 1),
            within(place.y, y, y + 1),
            within(place.z, z - layer.stock.cells[face].lift, z + 1),
        );
        let voxel = layer.stock.patch.voxel(place);
        let weft = voxel.is_weft();
        let sigma = f32::from(voxel.fill()) * (1.0 / 255.0) * layer.stock.full[usize::from(weft)];
        if !(sigma > 0.0 && sigma >= least) {
            return Voxel::EMPTY;
        }
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
            sigma,
            direction,
            alpha: layer.cloth.alpha[usize::from(yarn.0)],
            optics: u32::from(yarn.0) | (SYSTEM * u32::from(weft)),
        }
    }
}
