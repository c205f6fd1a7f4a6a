//! One voxel of a crossing.

use std::cell::Cell;

use glam::Vec3;

use super::build::ClothVolume;
use crate::exemplar::{BrickVolume, bits_of, cell_of};
use crate::render::Voxel;
use crate::synthesis::{BlockRef, Face, Neighbourhood};

/// A crossing of the endless cloth, made ready for lookups.
pub(super) struct Crossing<'c> {
    pub end: i64,
    pub pick: i64,
    pub block: BlockRef,
    /// Lower corner, mm.
    pub corner: [f32; 2],
    /// Voxels a mm along x and y.
    pub per_mm: [f32; 2],
    /// Found when first needed: most crossings are only passed over.
    around: Cell<Option<Neighbourhood>>,
    /// Which of the window's shifts are its own.
    kept: Option<usize>,
    /// The voxels it copies, found when first needed.
    source: Cell<Option<Source<'c>>>,
}

/// The voxels of a block.
#[derive(Clone, Copy)]
struct Source<'c> {
    volume: &'c BrickVolume,
    /// Lowest voxel of the block in its exemplar.
    corner: [usize; 2],
    /// Column and row of the block in its exemplar.
    place: [i32; 2],
    /// Ends and picks of the exemplar.
    repeat: [i32; 2],
}

/// The seams of a crossing, as they shift it at one height.
struct Seams {
    around: Neighbourhood,
    kept: Option<usize>,
    /// Weight of the front's field.
    front: f32,
}

impl Seams {
    /// What the fields of the two faces say, blended where both have a weight.
    #[inline]
    fn blend<T>(&self, of: impl Fn(Face) -> T, blend: impl Fn(f32, T, T) -> T) -> T {
        if self.front >= 1.0 {
            of(Face::Front)
        } else if self.front <= 0.0 {
            of(Face::Back)
        } else {
            blend(self.front, of(Face::Front), of(Face::Back))
        }
    }
}

impl ClothVolume {
    /// The crossing at (end, pick); `None` where there is no cloth.
    #[inline]
    pub(super) fn crossing(&self, end: i64, pick: i64) -> Option<Crossing<'_>> {
        if let Some((along_x, along_y, around, kept)) = self.window.crossing(end, pick) {
            let around = around?;
            return Some(Crossing {
                end,
                pick,
                block: around.centre,
                corner: [along_x.start, along_y.start],
                per_mm: [along_x.per_mm, along_y.per_mm],
                around: Cell::new(Some(around)),
                kept,
                source: Cell::new(None),
            });
        }
        self.crossing_anywhere(end, pick)
    }

    fn crossing_anywhere(&self, end: i64, pick: i64) -> Option<Crossing<'_>> {
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
            source: Cell::new(None),
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

    /// The voxels of a crossing's block; `None` where its exemplar is not built.
    #[inline]
    fn source<'c>(&'c self, crossing: &Crossing<'c>) -> Option<Source<'c>> {
        if let Some(source) = crossing.source.get() {
            return Some(source);
        }
        let place = self.catalogue.place(crossing.block.block);
        let exemplar = usize::from(place.exemplar);
        let volume = self.sets[usize::from(crossing.block.set)].volumes[exemplar].as_deref()?;
        let weave = &self.catalogue.weaves()[exemplar];
        let [bx, by, _] = self.grid.block;
        let source = Source {
            volume,
            corner: [usize::from(place.x) * bx, usize::from(place.y) * by],
            place: [i32::from(place.x), i32::from(place.y)],
            repeat: [weave.ends() as i32, weave.picks() as i32],
        };
        crossing.source.set(Some(source));
        Some(source)
    }

    /// The voxel at a point of a crossing given in voxels (x and y from the crossing's
    /// corner, z from the exemplar's floor), which may lie up to a block across its border.
    /// One whose `sigma` is below `least` may be given as empty. Coarse voxels choose among
    /// the directions of their fibres by `chance`, uniform in [0,1), and say where they
    /// stand; without one they give the main direction.
    #[inline]
    pub(super) fn voxel_near<'c>(
        &'c self,
        crossing: &Crossing<'c>,
        point: Vec3,
        least: f32,
        chance: Option<f32>,
    ) -> Voxel {
        let [bx, by, _] = self.grid.block.map(|voxels| voxels as i32);
        let (x, y) = (cell_of(point.x), cell_of(point.y));
        let side = |place: i32, block: i32| i32::from(place >= block) - i32::from(place < 0);
        let (across, along) = (side(x, bx), side(y, by));
        if (across, along) == (0, 0) {
            return self.voxel_in(crossing, [x as usize, y as usize], point.z, least, chance);
        }
        let beside = (
            crossing.end + i64::from(across),
            crossing.pick + i64::from(along),
        );
        let Some(beside) = self.crossing(beside.0, beside.1) else {
            return Voxel::EMPTY;
        };
        let within =
            |place: i32, side: i32, block: i32| (place - side * block).clamp(0, block - 1) as usize;
        let stack = [within(x, across, bx), within(y, along, by)];
        self.voxel_in(&beside, stack, point.z, least, chance)
    }

    /// The voxel of stack (x, y) of a crossing at height `z` (voxels).
    #[inline]
    fn voxel_in<'c>(
        &'c self,
        crossing: &Crossing<'c>,
        [x, y]: [usize; 2],
        z: f32,
        least: f32,
        chance: Option<f32>,
    ) -> Voxel {
        let depth = self.grid.block[2] as f32;
        // Blocks that only continue each other are not shifted.
        let mut seams = None;
        let mut height = z;
        if !self.edge_fix.is_off() {
            let Some(around) = self.around(crossing) else {
                return Voxel::EMPTY;
            };
            if around.sides != [None; 4] {
                let found = Seams {
                    around,
                    kept: crossing.kept,
                    front: front_weight(z / depth),
                };
                height -= self.shift(&found, [x, y]);
                seams = Some(found);
            }
        }
        if !(height >= 0.0 && height < depth) {
            return Voxel::EMPTY;
        }
        let Some(source) = self.source(crossing) else {
            return Voxel::EMPTY;
        };
        let place = [source.corner[0] + x, source.corner[1] + y, height as usize];
        let voxel = source.volume.get(place[0], place[1], place[2]);
        let weft = voxel.is_weft();
        let matter = &self.matter[usize::from(crossing.block.set)][usize::from(weft)];
        let sigma = matter.at(voxel.fill());
        if !(sigma > 0.0 && sigma >= least) {
            return Voxel::EMPTY;
        }

        // The yarn byte names a column or row of the exemplar: the same step from this
        // crossing is an end or pick of the cloth, so a bulging yarn keeps its own colour.
        let across = usize::from(weft);
        let step = i64::from(nearest_step(
            voxel.yarn(),
            source.place[across],
            source.repeat[across],
        ));
        let yarn = if weft {
            let pick = crossing.pick + step;
            self.window
                .weft(pick)
                .unwrap_or_else(|| self.weft_yarn(crossing.end, pick))
        } else {
            let end = crossing.end + step;
            self.window
                .warp(end)
                .unwrap_or_else(|| self.warp_yarn(end, crossing.pick))
        };
        let mut direction = voxel.direction();
        let mut stands = 0;
        if source.volume.coarse()
            && let Some(chance) = chance
        {
            if let Some(places) = self.places.get(usize::from(crossing.block.block)) {
                let warp_up = self.catalogue.key(crossing.block.block) & 1 == 1;
                stands = places[usize::from(warp_up != weft)] | matter.corrected;
            }
            let lobes = source.volume.lobes(place[0], place[1], place[2]);
            direction = lobes.direction(direction, bits_of(chance), matter.spread);
        }
        if let Some(seams) = &seams
            && self.settings.shear
        {
            direction = self.sheared(self.rise(seams, [x, y]), direction);
        }
        Voxel {
            sigma,
            direction,
            alpha: self.alpha[usize::from(yarn.0)],
            optics: u32::from(yarn.0) | stands,
        }
    }

    /// Shift of a stack, voxels upwards, blended between the fields of the two faces.
    #[inline]
    fn shift(&self, seams: &Seams, [x, y]: [usize; 2]) -> f32 {
        let of = |face| self.field(seams, face, x, y);
        seams.blend(of, |front, upper, lower| {
            front * upper + (1.0 - front) * lower
        })
    }

    /// How much the shift rises from stack to stack in x and y, likewise.
    #[inline]
    fn rise(&self, seams: &Seams, [x, y]: [usize; 2]) -> [f32; 2] {
        let (bx, by) = self.edge_fix.block_size();
        // Half-way between the neighbours on both sides; at the rims there is one.
        let [left, right] = [x.saturating_sub(1), (x + 1).min(bx - 1)];
        let [below, above] = [y.saturating_sub(1), (y + 1).min(by - 1)];
        let of = |face: Face| {
            let rise = |from: [usize; 2], to: [usize; 2], steps: usize| {
                let [from, to] = [from, to].map(|[x, y]| self.field(seams, face, x, y));
                (to - from) / steps.max(1) as f32
            };
            [
                rise([left, y], [right, y], right - left),
                rise([x, below], [x, above], above - below),
            ]
        };
        seams.blend(of, |front, upper, lower| {
            [0, 1].map(|axis| front * upper[axis] + (1.0 - front) * lower[axis])
        })
    }

    /// Shift of a stack under one face's field.
    #[inline]
    fn field(&self, seams: &Seams, face: Face, x: usize, y: usize) -> f32 {
        match seams.kept.and_then(|kind| self.window.shifts(kind, face)) {
            Some(kept) => {
                let width = self.edge_fix.block_size().0;
                kept.get_or_init(|| self.all_shifts(&seams.around, face))[y * width + x]
            }
            None => self.edge_fix.shift_at(&seams.around, face, x, y),
        }
    }

    #[cold]
    fn all_shifts(&self, around: &Neighbourhood, face: Face) -> Box<[f32]> {
        self.edge_fix.shifts(around, face).into()
    }

    /// A direction sheared by the slope of the shift.
    #[inline]
    fn sheared(&self, rise: [f32; 2], direction: Vec3) -> Vec3 {
        let mm = self.grid.voxel_mm;
        let slope = [rise[0] * mm.z / mm.x, rise[1] * mm.z / mm.y];
        let lift = slope[0] * direction.x + slope[1] * direction.y;
        (direction + Vec3::Z * lift)
            .try_normalize()
            .unwrap_or(direction)
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
        self.voxel_near(&crossing, local, 0.0, None)
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
fn nearest_step(to: u8, from: i32, period: i32) -> i32 {
    let step = i32::from(to) - from;
    if 2 * step > period {
        step - period
    } else if 2 * step <= -period {
        step + period
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
