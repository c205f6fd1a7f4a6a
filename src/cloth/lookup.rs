//! One voxel of a crossing.

use std::cell::Cell;

use glam::Vec3;

use super::build::ClothVolume;
use crate::render::Voxel;
use crate::synthesis::{BlockRef, Face, Neighbourhood};

/// A crossing of the endless cloth, made ready for lookups.
pub(super) struct Crossing {
    pub end: i64,
    pub pick: i64,
    pub block: BlockRef,
    /// Lower corner, mm.
    pub corner: [f32; 2],
    /// Voxels a mm along x and y.
    pub per_mm: [f32; 2],
    /// Found when first needed: most crossings are only passed over.
    around: Cell<Option<Neighbourhood>>,
    /// Where the window keeps its shifts.
    kept: Option<usize>,
}

/// The seams of a crossing that has any: what shifts its stacks.
struct Seams<'c> {
    cloth: &'c ClothVolume,
    around: Neighbourhood,
    kept: Option<usize>,
    /// Weight of the front face's field at the height looked at.
    front: f32,
}

impl Seams<'_> {
    /// Shift of a stack, blended between the fields of the two faces.
    #[inline]
    fn shift(&self, x: usize, y: usize) -> f32 {
        if self.front >= 1.0 {
            self.field(Face::Front, x, y)
        } else if self.front <= 0.0 {
            self.field(Face::Back, x, y)
        } else {
            let (front, back) = (self.field(Face::Front, x, y), self.field(Face::Back, x, y));
            self.front * front + (1.0 - self.front) * back
        }
    }

    #[inline]
    fn field(&self, face: Face, x: usize, y: usize) -> f32 {
        let fix = &self.cloth.edge_fix;
        let (bx, by) = fix.block_size();
        let work_out = || -> Box<[f32]> {
            let stacks = (0..bx * by).map(|i| fix.shift_at(&self.around, face, i % bx, i / bx));
            stacks.collect()
        };
        match self
            .kept
            .and_then(|place| self.cloth.window.shifts(place, face))
        {
            Some(kept) => kept.get_or_init(work_out)[y * bx + x],
            None => fix.shift_at(&self.around, face, x, y),
        }
    }

    /// A direction sheared by the slope of the shift, taken towards the next stack (at the
    /// far border: from the one before).
    fn sheared(&self, here: f32, [x, y]: [usize; 2], direction: Vec3) -> Vec3 {
        let [bx, by, _] = self.cloth.grid.block;
        let slope_x = if x + 1 < bx {
            self.shift(x + 1, y) - here
        } else {
            here - self.shift(x - 1, y)
        };
        let slope_y = if y + 1 < by {
            self.shift(x, y + 1) - here
        } else {
            here - self.shift(x, y - 1)
        };
        let mm = self.cloth.grid.voxel_mm;
        let rise = slope_x * direction.x * mm.z / mm.x + slope_y * direction.y * mm.z / mm.y;
        (direction + Vec3::Z * rise)
            .try_normalize()
            .unwrap_or(direction)
    }
}

impl ClothVolume {
    /// The crossing at (end, pick); `None` where there is no cloth.
    #[inline]
    pub(super) fn crossing(&self, end: i64, pick: i64) -> Option<Crossing> {
        if let Some((along_x, along_y, around, kept)) = self.window.crossing(end, pick) {
            let around = around?;
            return Some(Crossing {
                end,
                pick,
                block: around.centre,
                corner: [along_x.start, along_y.start],
                per_mm: [along_x.per_mm, along_y.per_mm],
                around: Cell::new(Some(around)),
                kept: Some(kept),
            });
        }
        self.crossing_anywhere(end, pick)
    }

    fn crossing_anywhere(&self, end: i64, pick: i64) -> Option<Crossing> {
        let block = self.placement().block(end, pick)?;
        let [bx, by, _] = self.grid.block;
        Some(Crossing {
            end,
            pick,
            block: BlockRef {
                set: self.set_at(end, pick),
                block,
            },
            corner: [self.ends.start(end) as f32, self.picks.start(pick) as f32],
            per_mm: [
                bx as f32 / self.ends.pitch(end) as f32,
                by as f32 / self.picks.pitch(pick) as f32,
            ],
            around: Cell::new(None),
            kept: None,
        })
    }

    #[inline]
    fn around(&self, crossing: &Crossing) -> Option<Neighbourhood> {
        if crossing.around.get().is_none() {
            crossing
                .around
                .set(self.seams_around(crossing.end, crossing.pick));
        }
        crossing.around.get()
    }

    /// The voxel at a point of a crossing given in voxels (x and y from the crossing's
    /// corner, z from the exemplar's floor), which may lie just across its border.
    pub(super) fn voxel_near(&self, crossing: &Crossing, point: Vec3) -> Voxel {
        let [bx, by, _] = self.grid.block;
        let (x, y) = (point.x.floor() as i64, point.y.floor() as i64);
        let (across, along) = (x.div_euclid(bx as i64), y.div_euclid(by as i64));
        if (across, along) == (0, 0) {
            return self.voxel_in(crossing, x as usize, y as usize, point.z);
        }
        let Some(beside) = self.crossing(crossing.end + across, crossing.pick + along) else {
            return Voxel::EMPTY;
        };
        let (x, y) = (x.rem_euclid(bx as i64), y.rem_euclid(by as i64));
        self.voxel_in(&beside, x as usize, y as usize, point.z)
    }

    /// The voxel of stack (x, y) of a crossing at height `z` (voxels).
    #[inline]
    fn voxel_in(&self, crossing: &Crossing, x: usize, y: usize, z: f32) -> Voxel {
        let [bx, by, depth] = self.grid.block;
        // Blocks that only continue each other are not shifted.
        let mut seams = None;
        let mut height = z;
        if !self.edge_fix.is_off() {
            let Some(around) = self.around(crossing) else {
                return Voxel::EMPTY;
            };
            if around.sides != [None; 4] {
                let front = front_weight(z / depth as f32);
                let kept = crossing.kept;
                let around = Seams {
                    cloth: self,
                    around,
                    kept,
                    front,
                };
                let shift = around.shift(x, y);
                height -= shift;
                seams = Some((around, shift));
            }
        }
        if !(height >= 0.0 && height < depth as f32) {
            return Voxel::EMPTY;
        }
        let place = self.catalogue.place(crossing.block.block);
        let set = &self.sets[usize::from(crossing.block.set)];
        let Some(volume) = &set.volumes[usize::from(place.exemplar)] else {
            return Voxel::EMPTY;
        };
        let voxel = volume.get(
            usize::from(place.x) * bx + x,
            usize::from(place.y) * by + y,
            height as usize,
        );
        if voxel.fill() == 0 {
            return Voxel::EMPTY;
        }

        // The yarn byte names a column or row of the exemplar: the same step from this
        // crossing is an end or pick of the cloth, so a bulging yarn keeps its own colour.
        let weft = voxel.is_weft();
        let weave = &self.catalogue.weaves()[usize::from(place.exemplar)];
        let yarn = if weft {
            let step = nearest_step(voxel.yarn(), place.y, weave.picks());
            let pick = crossing.pick + step;
            self.window
                .weft(pick)
                .unwrap_or_else(|| self.weft_yarn(crossing.end, pick))
        } else {
            let step = nearest_step(voxel.yarn(), place.x, weave.ends());
            let end = crossing.end + step;
            self.window
                .warp(end)
                .unwrap_or_else(|| self.warp_yarn(end, crossing.pick))
        };
        let mut direction = voxel.direction();
        if let Some((around, shift)) = &seams
            && self.settings.shear
        {
            direction = around.sheared(*shift, [x, y], direction);
        }
        let full = self.full[usize::from(crossing.block.set)][usize::from(weft)];
        Voxel {
            sigma: f32::from(voxel.fill()) * (1.0 / 255.0) * full,
            direction,
            alpha: self.alpha[usize::from(yarn.0)],
            optics: u32::from(yarn.0),
        }
    }

    /// The voxel at a point of the cloth (mm), without a filter.
    pub fn voxel_at(&self, point: Vec3) -> Voxel {
        let (end, _) = self.ends.locate(f64::from(point.x));
        let (pick, _) = self.picks.locate(f64::from(point.y));
        let Some(crossing) = self.crossing(end, pick) else {
            return Voxel::EMPTY;
        };
        let [bx, by, _] = self.grid.block;
        let local = Vec3::new(
            ((point.x - crossing.corner[0]) * crossing.per_mm[0]).clamp(0.0, bx as f32 - 0.01),
            ((point.y - crossing.corner[1]) * crossing.per_mm[1]).clamp(0.0, by as f32 - 0.01),
            (point.z - self.grid.floor_mm()) / self.grid.voxel_mm.z,
        );
        self.voxel_near(&crossing, local)
    }
}

/// Weight of the front face's field at a height (fraction of the thickness): the two
/// fields are blended over the middle third.
#[inline]
fn front_weight(fraction: f32) -> f32 {
    (3.0 * fraction - 1.0).clamp(0.0, 1.0)
}

/// Steps from column (or row) `from` to `to` of a repeat of `period`, the short way.
#[inline]
fn nearest_step(to: u8, from: u16, period: u32) -> i64 {
    let period = i64::from(period);
    let step = (i64::from(to) - i64::from(from)).rem_euclid(period);
    if 2 * step > period {
        step - period
    } else {
        step
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn yarns_are_counted_the_short_way_round() {
        assert_eq!(nearest_step(4, 0, 5), -1);
        assert_eq!(nearest_step(1, 0, 5), 1);
        assert_eq!(nearest_step(3, 3, 5), 0);
        assert_eq!(nearest_step(0, 4, 5), 1);
    }
}
