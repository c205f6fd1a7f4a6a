//! What was traced before an edit, carried over to what is seen after it.
//!
//! Comes in: first sight before and after an edit, and the traced picture of before. Goes
//! out: a picture of after that is as near to the traced one as what is known allows.
//! Where first sight did not change, nor does the picture. Elsewhere the traced picture
//! tells what first sight leaves out: a crossing whose neighbourhood and yarns were seen
//! before looks as they looked on average, place by place; one whose yarns have new
//! colours keeps what tracing made of the old ones; and where not even its neighbourhood
//! was seen, first sight is changed as its side or the whole was.

use std::collections::HashMap;
use std::hash::BuildHasherDefault;
use std::ops::AddAssign;

use glam::{Vec3, Vec4};
use rayon::prelude::*;

use super::exposure::byte;
use crate::design::{Yarn, YarnId};
use crate::exemplar::Pair;
use crate::film::tone::{decode_srgb, encode_srgb};
use crate::scene::Pose;
use crate::synthesis::KEYS;

/// Cells along a crossing's side in which what was seen is told apart.
const CELLS: usize = 4;
/// Pixels of a class and cell from which their mean is believed.
const ENOUGH: f32 = 3.0;
/// Pixels whose worth a coarser statistic has beside a finer one.
const PRIOR: f32 = 12.0;
/// First sight shows more of a yarn through the one above it than tracing does: so much of
/// a change of the lower yarn's colour is believed.
const THROUGH: f32 = 0.5;
/// Parts that a picture is learnt from at once, and the fewest pixels of one: whatever the
/// number of threads, so that sums have the same bits.
const PARTS: usize = 8;
const LEAST_PART: usize = 1 << 13;
/// Light below which a channel tells nothing of what is darker or brighter.
const LEAST: f32 = 0.01;

/// What a pixel shows, as far as first sight knows.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Place {
    /// Neighbourhood of the crossing.
    pub key: u8,
    /// Cell of the crossing, [`NOWHERE`] where there is no cloth, [`MIXED`] where
    /// crossings are smaller than pixels.
    pub cell: u8,
    /// Pair of yarns.
    pub set: u16,
    pub warp: YarnId,
    pub weft: YarnId,
}

const NOWHERE: u8 = u8::MAX;
const MIXED: u8 = u8::MAX - 1;

impl Place {
    /// No cloth.
    pub const NONE: Self = Self {
        key: 0,
        cell: NOWHERE,
        set: 0,
        warp: YarnId(0),
        weft: YarnId(0),
    };

    /// The cell of a place (`u`, `v`) of a crossing, each 0..1.
    pub fn cell(u: f32, v: f32) -> u8 {
        let [x, y] = [u, v].map(|part| ((part * CELLS as f32) as usize).min(CELLS - 1));
        (y * CELLS + x) as u8
    }

    /// Of several crossings at once.
    pub fn mixed(self) -> Self {
        Self {
            cell: MIXED,
            ..self
        }
    }

    fn cell_index(&self) -> Option<usize> {
        let cell = usize::from(self.cell);
        (cell < CELLS * CELLS).then_some(cell)
    }
}

/// A first sight that later ones are compared with.
pub struct Sighted {
    /// sRGB with straight alpha, top row first.
    pub rgba: Vec<u8>,
    pub(super) places: Vec<Place>,
    pub(super) yarns: Vec<Yarn>,
    /// Whether the back is seen.
    pub(super) pose: Pose,
    /// The pairs of yarns that the places name by their number.
    pub(super) pairs: Vec<Pair>,
}

/// A picture that was carried over.
pub struct Carried {
    /// sRGB with straight alpha, top row first.
    pub rgba: Vec<u8>,
    /// Share of the pixels that first sight changed.
    pub changed: f64,
}

impl Sighted {
    /// `traced`, a picture of what `self` showed, carried over to what `after` shows; `None`
    /// when they are not of one size.
    pub fn carried_to(&self, after: &Self, traced: &[u8]) -> Option<Carried> {
        let pixels = self.places.len();
        let same_size = [traced.len(), self.rgba.len(), after.rgba.len()]
            .iter()
            .all(|&length| length == pixels * 4)
            && after.places.len() == pixels;
        if !same_size || pixels == 0 {
            return None;
        }
        let changed_at = |at: usize| self.rgba[at * 4..][..4] != after.rgba[at * 4..][..4];
        let changed = (0..pixels)
            .into_par_iter()
            .filter(|&at| changed_at(at))
            .count();
        let mut rgba = traced.to_vec();
        if changed > 0 {
            let light = Light::new();
            let known = Known::of(self, traced, &light);
            let kept: Vec<bool> = (self.yarns.iter().zip(&after.yarns))
                .map(|(before, after)| before == after)
                .collect();
            let is_kept = |yarn: YarnId| kept.get(usize::from(yarn.0)) == Some(&true);
            // An edit may number the pairs anew.
            let sets: Vec<u16> = (after.pairs.iter())
                .map(|pair| self.pairs.iter().position(|known| known == pair))
                .map(|set| set.map_or(u16::MAX, |set| set as u16))
                .collect();
            let carry = |at: usize, pixel: &mut [u8], known: &mut Reader<'_>| {
                let range = at * 4..at * 4 + 4;
                let (before, mut place) = (self.places[at], after.places[at]);
                place.set = sets
                    .get(usize::from(place.set))
                    .map_or(u16::MAX, |&set| set);
                let mut seen = light.of(&after.rgba[range.clone()]);
                let same_yarns = is_kept(place.warp) && is_kept(place.weft);
                let mean = same_yarns.then(|| known.mean(&place)).flatten();
                let shown = mean.unwrap_or_else(|| {
                    // The same crossing in other colours keeps its fibres.
                    let own =
                        (before.key, before.cell, before.set) == (place.key, place.cell, place.set);
                    if !own {
                        return known.traced(&place).carry(seen);
                    }
                    let known = Traced {
                        traced: light.of(&traced[range.clone()]),
                        sight: light.of(&self.rgba[range]),
                    };
                    let warp_up = after.pose.sees_warp(place.key & 1 == 1);
                    let upper = if warp_up { place.warp } else { place.weft };
                    if place.cell_index().is_some() && is_kept(upper) {
                        seen = known.sight.lerp(seen, THROUGH);
                    }
                    known.carry(seen)
                });
                light.put(shown, pixel);
            };
            let part = part_of(pixels);
            rgba.par_chunks_mut(part * 4)
                .enumerate()
                .for_each(|(index, pixels)| {
                    let mut known = known.reader();
                    for (at, pixel) in (index * part..).zip(pixels.chunks_exact_mut(4)) {
                        if changed_at(at) {
                            carry(at, pixel, &mut known);
                        }
                    }
                });
        }
        Some(Carried {
            rgba,
            changed: changed as f64 / pixels as f64,
        })
    }
}

impl Sighted {
    /// This first sight as tracing made `traced` of `before`, which is the same cloth in
    /// the same light from another distance: yarn by yarn and side by side, so that no
    /// border shows. `None` where the sizes of `before` do not agree.
    pub fn as_traced(&self, before: &Self, traced: &[u8]) -> Option<Vec<u8>> {
        let sizes =
            [traced.len(), before.rgba.len()].map(|length| length == before.places.len() * 4);
        if sizes.contains(&false) || before.places.is_empty() {
            return None;
        }
        let light = Light::new();
        let known = Known::of(before, traced, &light);
        let mut rgba = self.rgba.clone();
        rgba.par_chunks_mut(4)
            .zip(&self.places)
            .filter(|(_, place)| place.cell != NOWHERE)
            .for_each(|(pixel, place)| {
                let seen = light.of(pixel);
                light.put(known.side_of(place).carry(seen), pixel);
            });
        Some(rgba)
    }
}

/// Between bytes and linear light times alpha.
struct Light {
    linear: [f32; 256],
    shown: Vec<u8>,
}

impl Light {
    const STEPS: usize = 1 << 12;

    fn new() -> Self {
        let shown = |step: usize| {
            // Equal steps of the root are finer where the eye is.
            let root = step as f32 / (Self::STEPS - 1) as f32;
            byte(encode_srgb(root * root))
        };
        Self {
            linear: std::array::from_fn(|value| decode_srgb(value as f32 / 255.0)),
            shown: (0..Self::STEPS).map(shown).collect(),
        }
    }

    fn of(&self, pixel: &[u8]) -> Vec4 {
        let [r, g, b] = [0, 1, 2].map(|channel| self.linear[usize::from(pixel[channel])]);
        let alpha = f32::from(pixel[3]) / 255.0;
        (Vec3::new(r, g, b) * alpha).extend(alpha)
    }

    fn put(&self, light: Vec4, pixel: &mut [u8]) {
        let alpha = light.w.clamp(0.0, 1.0);
        let colour = light.truncate() / alpha.max(1e-3);
        for (byte, value) in pixel.iter_mut().zip(colour.to_array()) {
            let step = value.clamp(0.0, 1.0).sqrt() * (Self::STEPS - 1) as f32;
            *byte = self.shown[(step.round() as usize).min(Self::STEPS - 1)];
        }
        pixel[3] = byte(alpha);
    }
}

/// What tracing made of what first sight showed: linear light times alpha.
#[derive(Clone, Copy, Default)]
struct Traced {
    traced: Vec4,
    sight: Vec4,
}

impl Traced {
    /// What tracing would make of another first sight. What gets darker is scaled, what
    /// gets brighter is moved by the difference: neither blows up noise, gloss or hairs of
    /// a dark yarn into those of a bright one.
    fn carry(&self, seen: Vec4) -> Vec4 {
        let scaled = (self.traced + LEAST) / (self.sight + LEAST) * seen;
        let moved = self.traced + (seen - self.sight);
        let darker = seen.cmple(self.sight);
        Vec4::select(darker, scaled, moved).clamp(Vec4::ZERO, Vec4::ONE)
    }
}

/// Sums over pixels.
#[derive(Clone, Copy, Default)]
struct Sum {
    sum: Traced,
    count: f32,
}

impl AddAssign<Traced> for Sum {
    fn add_assign(&mut self, pixel: Traced) {
        self.sum.traced += pixel.traced;
        self.sum.sight += pixel.sight;
        self.count += 1.0;
    }
}

impl AddAssign for Sum {
    fn add_assign(&mut self, more: Self) {
        self.sum.traced += more.sum.traced;
        self.sum.sight += more.sum.sight;
        self.count += more.count;
    }
}

impl Sum {
    /// The mean, with what a coarser statistic makes of it standing for pixels not seen.
    fn mean(&self, coarser: &Traced) -> Traced {
        if self.count == 0.0 {
            return *coarser;
        }
        let sight = self.sum.sight / self.count;
        let traced = self.sum.traced + PRIOR * coarser.carry(sight);
        Traced {
            traced: traced / (self.count + PRIOR),
            sight,
        }
    }
}

/// Neighbourhood and yarns.
type Class = (u8, YarnId, YarnId);
type Sums = [Sum; CELLS * CELLS];

/// What a traced picture tells beyond first sight.
struct Known {
    /// By neighbourhood and yarns: where its cells lie.
    classes: HashMap<Class, u32, BuildHasherDefault<std::hash::DefaultHasher>>,
    cells: Vec<(Class, Sums)>,
    /// By pair, neighbourhood and cell.
    crossings: Vec<Sum>,
    /// By pair and whether the warp is up.
    sides: Vec<Sum>,
    all: Sum,
}

impl Known {
    fn of(sighted: &Sighted, traced: &[u8], light: &Light) -> Self {
        let part = part_of(sighted.places.len());
        let parts: Vec<Self> = (sighted.places.par_chunks(part))
            .zip(traced.par_chunks(part * 4))
            .zip(sighted.rgba.par_chunks(part * 4))
            .map(|((places, traced), sight)| {
                let mut known = Self::nothing(sighted.pairs.len());
                known.learn(places, traced, sight, light);
                known
            })
            .collect();
        let mut known = Self::nothing(sighted.pairs.len());
        parts.into_iter().for_each(|part| known.add(part));
        known
    }

    fn nothing(pairs: usize) -> Self {
        Self {
            classes: HashMap::default(),
            cells: Vec::new(),
            crossings: vec![Sum::default(); pairs * KEYS * CELLS * CELLS],
            sides: vec![Sum::default(); pairs * 2],
            all: Sum::default(),
        }
    }

    fn learn(&mut self, places: &[Place], traced: &[u8], sight: &[u8], light: &Light) {
        let mut last: Option<(Class, u32)> = None;
        let pixels = traced.chunks_exact(4).zip(sight.chunks_exact(4));
        for (place, (traced, sight)) in places.iter().zip(pixels) {
            if place.cell == NOWHERE {
                continue;
            }
            let pixel = Traced {
                traced: light.of(traced),
                sight: light.of(sight),
            };
            self.all += pixel;
            if let Some(sum) = self.sides.get_mut(side(place)) {
                *sum += pixel;
            }
            let Some(cell) = place.cell_index() else {
                continue;
            };
            if let Some(sum) = self.crossings.get_mut(crossing(place, cell)) {
                *sum += pixel;
            }
            let class = (place.key, place.warp, place.weft);
            let index = match last {
                Some((known, index)) if known == class => index,
                _ => self.class(class),
            };
            last = Some((class, index));
            self.cells[index as usize].1[cell] += pixel;
        }
    }

    /// Where the cells of a class lie.
    fn class(&mut self, class: Class) -> u32 {
        *self.classes.entry(class).or_insert_with(|| {
            self.cells.push((class, [Sum::default(); CELLS * CELLS]));
            self.cells.len() as u32 - 1
        })
    }

    /// What another part of the picture tells as well.
    fn add(&mut self, part: Self) {
        for (class, sums) in part.cells {
            let own = self.class(class) as usize;
            for (sum, more) in self.cells[own].1.iter_mut().zip(sums) {
                *sum += more;
            }
        }
        let own = self.crossings.iter_mut().chain(&mut self.sides);
        for (sum, more) in own.zip(part.crossings.iter().chain(&part.sides)) {
            *sum += *more;
        }
        self.all += part.all;
    }

    /// What tracing made of first sight where the same yarn of the same pair is up.
    fn side_of(&self, place: &Place) -> Traced {
        let whole = self.all.mean(&Traced::default());
        (self.sides.get(side(place))).map_or(whole, |sum| sum.mean(&whole))
    }

    fn reader(&self) -> Reader<'_> {
        Reader {
            known: self,
            last: None,
        }
    }
}

/// Pixels of a part of a picture.
fn part_of(pixels: usize) -> usize {
    pixels.div_ceil(PARTS).max(LEAST_PART)
}

fn side(place: &Place) -> usize {
    usize::from(place.set) * 2 + usize::from(place.key & 1)
}

fn crossing(place: &Place, cell: usize) -> usize {
    (usize::from(place.set) * KEYS + usize::from(place.key) % KEYS) * CELLS * CELLS + cell
}

/// Asks what is known; pixels beside each other ask for the same.
struct Reader<'k> {
    known: &'k Known,
    last: Option<(Class, Option<u32>)>,
}

impl Reader<'_> {
    /// How crossings like this one looked there.
    fn mean(&mut self, place: &Place) -> Option<Vec4> {
        let cell = place.cell_index()?;
        let class = (place.key, place.warp, place.weft);
        let index = match self.last {
            Some((last, index)) if last == class => index,
            _ => self.known.classes.get(&class).copied(),
        };
        self.last = Some((class, index));
        let sum = self.known.cells[index? as usize].1[cell];
        (sum.count >= ENOUGH).then(|| sum.sum.traced / sum.count)
    }

    /// What tracing made of first sight in crossings like this one.
    fn traced(&self, place: &Place) -> Traced {
        let known = self.known;
        let sided = known.side_of(place);
        (place.cell_index())
            .and_then(|cell| known.crossings.get(crossing(place, cell)))
            .map_or(sided, |sum| sum.mean(&sided))
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;
    use crate::design::{Family, Srgb};
    use crate::yarn::YarnRecipe;

    /// A row of pixels: neighbourhood, cell and colour at first sight.
    fn sighted(pixels: &[(u8, u8, [u8; 4])], colour: Srgb) -> Sighted {
        Sighted {
            rgba: pixels.iter().flat_map(|pixel| pixel.2).collect(),
            places: (pixels.iter())
                .map(|&(key, cell, _)| Place {
                    key,
                    cell,
                    ..Place::default()
                })
                .collect(),
            yarns: vec![Yarn::new("yarn", Family::Cotton, colour)],
            pose: Pose::FACE,
            pairs: vec![Pair {
                warp: YarnRecipe::family(Family::Cotton, 0.3),
                weft: YarnRecipe::family(Family::Cotton, 0.3),
            }],
        }
    }

    const SEEN: [u8; 4] = [100, 100, 100, 255];
    const OTHER: [u8; 4] = [140, 140, 140, 255];
    const TRACED: [u8; 4] = [60, 80, 120, 250];

    #[test]
    fn what_did_not_change_is_kept_and_what_was_seen_looks_as_it_looked() {
        let grey = Srgb(90, 90, 90);
        let mut before = vec![(1, 0, SEEN); 8];
        before.push((0, 0, OTHER));
        let mut after = before.clone();
        after[8] = (1, 0, SEEN);
        let traced: Vec<u8> = [vec![TRACED; 8], vec![[9, 9, 9, 255]]].concat().concat();
        let (before, after) = (sighted(&before, grey), sighted(&after, grey));
        let carried = before.carried_to(&after, &traced).unwrap();
        assert_eq!(carried.rgba[..32], traced[..32]);
        assert!((carried.changed - 1.0 / 9.0).abs() < 1e-9);
        // The edited pixel is like its kind, not like first sight nor what was there.
        for (byte, wanted) in carried.rgba[32..].iter().zip(TRACED) {
            assert!(byte.abs_diff(wanted) <= 1, "{:?}", &carried.rgba[32..]);
        }
    }

    #[test]
    fn another_colour_is_first_sight_times_what_tracing_made_of_the_old_one() {
        // Tracing halves the light (188 is half of 255 in sRGB).
        let before = sighted(&[(1, 0, [255, 255, 255, 255]); 30], Srgb(255, 255, 255));
        let after = sighted(&[(1, 0, [255, 0, 0, 255]); 30], Srgb(255, 0, 0));
        let traced = [188, 188, 188, 255].repeat(30);
        let carried = before.carried_to(&after, &traced).unwrap();
        for pixel in carried.rgba.chunks(4) {
            assert!(
                pixel[0].abs_diff(188) < 6 && pixel[1..] == [0, 0, 255],
                "{pixel:?}"
            );
        }
        // Control: the same yarns carry the old colour itself.
        let same = sighted(&[(1, 0, [255, 0, 0, 255]); 30], Srgb(255, 255, 255));
        let carried = before.carried_to(&same, &traced).unwrap();
        assert!(
            carried
                .rgba
                .chunks(4)
                .all(|pixel| pixel[1].abs_diff(188) < 2)
        );
    }

    #[test]
    fn a_new_colour_shines_little_through_the_yarn_above_it() {
        // The weft, yarn 1, is recoloured; first sight makes all of it red.
        let sight = |key: u8, colour: Srgb, seen: [u8; 4]| {
            let mut sight = sighted(&[(key, 0, seen); 30], Srgb(200, 200, 200));
            sight.yarns.push(Yarn::new("weft", Family::Cotton, colour));
            for place in &mut sight.places {
                place.weft = YarnId(1);
            }
            sight
        };
        let traced = [188, 188, 188, 255].repeat(30);
        let green = |key: u8, back: bool| {
            let before = sight(key, Srgb(200, 200, 200), [200, 200, 200, 255]);
            let mut after = sight(key, Srgb(200, 0, 0), [200, 100, 100, 255]);
            after.pose.back = back;
            before.carried_to(&after, &traced).unwrap().rgba[1]
        };
        // Key 1: the warp is up.
        assert!(green(1, false) > green(0, false) + 20);
        assert_eq!(green(1, true), green(0, false));
    }

    #[test]
    fn a_dark_channel_does_not_tell_what_a_bright_one_becomes() {
        // A blue yarn whose red is gloss alone turns red: no blaze.
        let before = sighted(&[(1, 0, [10, 10, 200, 255]); 30], Srgb(10, 10, 200));
        let after = sighted(&[(1, 0, [200, 10, 10, 255]); 30], Srgb(200, 10, 10));
        let traced = [40, 40, 200, 255].repeat(30);
        let carried = before.carried_to(&after, &traced).unwrap();
        assert!(carried.rgba[0] < 240, "{:?}", &carried.rgba[..4]);
    }

    #[test]
    fn what_was_never_seen_follows_its_side_and_sizes_must_agree() {
        let grey = Srgb(90, 90, 90);
        // Warp up is traced at half the light, weft up at all of it.
        let up = vec![(1, 0, [255, 255, 255, 255]); 200];
        let down = vec![(0, 0, [255, 255, 255, 255]); 200];
        let mut before = [up, down].concat();
        before.push((0, 0, OTHER));
        let mut after = before.clone();
        after[400] = (3, 0, [255, 255, 255, 255]);
        let mut traced = [188, 188, 188, 255].repeat(200);
        traced.extend([255; 4].repeat(201));
        let (before, after) = (sighted(&before, grey), sighted(&after, grey));
        let carried = before.carried_to(&after, &traced).unwrap();
        assert!(
            carried.rgba[1600].abs_diff(188) < 12,
            "{}",
            carried.rgba[1600]
        );
        // Pairs that were not seen are like the whole.
        let mut silk = sighted(&[(0, 0, [255; 4]); 401], Srgb(91, 90, 90));
        silk.pairs[0].warp = YarnRecipe::family(Family::Silk, 0.1);
        let whole = before.carried_to(&silk, &traced).unwrap();
        assert!(
            (189..255).contains(&whole.rgba[1600]),
            "{}",
            whole.rgba[1600]
        );
        assert!(before.carried_to(&after, &traced[4..]).is_none());
        let empty = sighted(&[], grey);
        assert!(empty.carried_to(&empty, &[]).is_none());
    }
}
