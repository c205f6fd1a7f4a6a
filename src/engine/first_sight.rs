//! First sight: the cloth within milliseconds, without paths or synthesis.
//!
//! Every crossing shows what its neighbourhood, its yarns, the light and the side looked
//! at make of it: the places of [`FaceTable`], in the colours of
//! [`colours_on_top`]. A crossing smaller than a pixel is its mean. What
//! lies behind the cloth is a sheet of paper, nothing, or the mean of more cloth; hairs and
//! the slant of a view are not shown; the path tracer brings them.

use std::sync::{Arc, Mutex, PoisonError};

use glam::{Vec2, Vec3};
use rayon::prelude::*;

use super::carried::{Place, Sighted};
use super::exposure::{Engine, Exposure, Pass, byte};
use super::prepare::coloured;
use super::renderer::{Making, Renderer};
use super::request::{LightChoice, StillReport};
use super::shot::{Shot, camera, lights, origin};
use super::{StillError, StillRequest};
use crate::cloth::colour::colours_on_top;
use crate::cloth::{FaceRelief, FaceTable, TEXELS, Texel, YarnClasses};
use crate::design::{Design, Positions, WeavePattern, YarnId};
use crate::exemplar::Pair;
use crate::film::{Film, Sample, Tone};
use crate::job::Job;
use crate::render::Backing;
use crate::scene::{Camera, Pose};
use crate::synthesis::{Catalogue, Side, key_of};

/// Samples a pixel, each way, where crossings are smaller than pixels.
const MOST_SAMPLES: usize = 4;
/// Tables that are kept for the next picture.
const MOST_TABLES: usize = 24;
/// Pairs of yarns whose colours are worked out in advance.
const MOST_PAIRS: usize = 1024;
/// Places of the curve from light to display values, and the light it reaches to.
const CURVE: usize = 1 << 13;
const BRIGHTEST: f32 = 2.0;
/// Brightness of more of the same cloth seen through a gap, beside that of the cloth.
const BENEATH: f32 = 0.4;
/// Light of a sheet of paper behind cloth.
const PAPER: f32 = 0.7;

/// The tables of lights and pairs of yarns, made once and kept.
#[derive(Default)]
pub struct SightTables {
    catalogue: std::sync::OnceLock<Catalogue>,
    reliefs: Mutex<Vec<(ReliefKey, Arc<FaceRelief>)>>,
    kept: Mutex<Vec<(TableKey, Arc<FaceTable>)>>,
}

#[derive(Clone, PartialEq)]
struct ReliefKey {
    pair: Pair,
    pitch: Vec2,
    /// Unturned: a relief is the same then.
    pose: Pose,
}

#[derive(Clone, PartialEq)]
struct TableKey {
    relief: ReliefKey,
    light: LightChoice,
    pose: Pose,
}

impl SightTables {
    fn get(&self, key: &TableKey) -> Result<Arc<FaceTable>, StillError> {
        if let Some(table) = find(&self.kept, key) {
            return Ok(table);
        }
        let relief = find(&self.reliefs, &key.relief).unwrap_or_else(|| {
            let catalogue = self.catalogue.get_or_init(Catalogue::standard);
            let ReliefKey { pair, pitch, pose } = &key.relief;
            let relief = Arc::new(FaceRelief::new(catalogue, pair, *pitch, *pose));
            keep(&self.reliefs, &key.relief, &relief);
            relief
        });
        let table = Arc::new(FaceTable::new(&relief, &lights(&key.light, key.pose)?));
        keep(&self.kept, key, &table);
        Ok(table)
    }
}

/// Things made once, by what they were made for.
type Kept<K, T> = Mutex<Vec<(K, Arc<T>)>>;

fn find<K: PartialEq, T>(kept: &Kept<K, T>, key: &K) -> Option<Arc<T>> {
    let kept = kept.lock().unwrap_or_else(PoisonError::into_inner);
    let (_, found) = kept.iter().find(|(known, _)| known == key)?;
    Some(Arc::clone(found))
}

/// Keeps one thing more; the oldest gives way.
fn keep<K: Clone, T>(kept: &Kept<K, T>, key: &K, thing: &Arc<T>) {
    let mut kept = kept.lock().unwrap_or_else(PoisonError::into_inner);
    if kept.len() >= MOST_TABLES {
        kept.remove(0);
    }
    kept.push((key.clone(), Arc::clone(thing)));
}

/// Draws a design at first sight.
pub struct FirstSight {
    design: Arc<Design>,
    drawdown: Arc<WeavePattern>,
    tables: Arc<SightTables>,
}

impl FirstSight {
    /// First sight of a design whose drawdown is `drawdown`.
    pub fn new(design: Arc<Design>, drawdown: Arc<WeavePattern>, tables: Arc<SightTables>) -> Self {
        Self {
            design,
            drawdown,
            tables,
        }
    }
}

/// Everything that the picture's rows share.
struct Sight<'d> {
    design: &'d Design,
    drawdown: &'d WeavePattern,
    classes: YarnClasses,
    tables: Vec<Arc<FaceTable>>,
    /// By warp and weft yarn.
    colours: Vec<[Vec3; 2]>,
    ends: Positions,
    picks: Positions,
    level: usize,
    /// Pixels are smaller than the finest texels.
    close: bool,
    samples: usize,
    backing: Backing,
}

/// Light and cover of each pixel, and what it shows.
struct Rows {
    light: Vec<(Vec3, f32)>,
    places: Vec<Place>,
}

/// Display values by light, for [`show`].
fn curve(exposure: f32) -> Vec<u8> {
    let tone = Tone { exposure };
    (0..CURVE)
        .map(|step| {
            let light = step as f32 * BRIGHTEST / (CURVE - 1) as f32;
            byte(tone.display(Vec3::splat(light), 1.0)[0])
        })
        .collect()
}

/// The display values of a pixel; those of no cloth are 0.
#[inline]
fn show(curve: &[u8], (light, alpha): (Vec3, f32), pixel: &mut [u8]) {
    if !(alpha > 0.0) {
        return;
    }
    let places = light.clamp(Vec3::ZERO, Vec3::splat(BRIGHTEST)) * ((CURVE - 1) as f32 / BRIGHTEST);
    for (shown, place) in pixel.iter_mut().zip(places.to_array()) {
        *shown = curve[(place as usize).min(CURVE - 1)];
    }
    pixel[3] = byte(alpha);
}

/// A crossing made ready.
#[derive(Clone, Copy)]
struct Crossing {
    end: i64,
    pick: i64,
    key: u8,
    set: u16,
    warp: YarnId,
    weft: YarnId,
    colours: [Vec3; 2],
}

impl Crossing {
    /// Light and cover of a texel in the yarns of this crossing.
    #[inline]
    fn lit(&self, table: &FaceTable, texel: Texel) -> (Vec3, f32) {
        let [warp, weft] = self.colours;
        let light = warp * texel.warp + weft * texel.weft;
        (light * table.tint(), texel.cover)
    }

    /// Light of more of the same cloth, seen through a gap: as much of its warp as of its weft.
    fn beneath(&self, table: &FaceTable) -> Vec3 {
        let [warp, weft] = self.colours;
        let mean = table.mean(self.key);
        let brightness = (mean.warp + mean.weft) / mean.cover.max(1e-6);
        (warp + weft) * table.tint() * (0.5 * BENEATH * brightness)
    }
}

/// Its row of the table.
pub(super) static SIGHT: Renderer = Renderer {
    name: NAME,
    about: "first sight, at once, without paths",
    // It is as it is: no effect can be had or left out.
    effects: &[],
    dials: |dial| dial.name == "png-bits",
    refines: false,
    make,
    of_voxels: None,
};

const NAME: &str = "sight";

fn make(making: &Making<'_>) -> Result<Box<dyn Engine>, StillError> {
    // Colours are put on where it is drawn.
    let design = Arc::clone(making.design);
    let drawdown = Arc::new(design.weave());
    Ok(Box::new(FirstSight::new(design, drawdown, Arc::default())))
}

impl Engine for FirstSight {
    fn name(&self) -> &'static str {
        NAME
    }

    fn expose(
        &self,
        shot: &Shot<'_>,
        job: &Job,
        on_pass: &mut dyn FnMut(&Pass<'_>),
    ) -> Result<Exposure, StillError> {
        let begun = std::time::Instant::now();
        let request = shot.request;
        let design = coloured(&self.design, request)?;
        let camera = camera(&design, request)?;
        let sight = self.sight(&design, request, &camera)?;
        let rows = sight.rows(&camera, request, job)?;
        let mut film = Film::new(request.width, request.height);
        for (pixel, (light, alpha)) in film.pixels_mut().iter_mut().zip(rows.light) {
            let sample = Sample {
                radiance: light * alpha,
                alpha,
                first: None,
            };
            pixel.add(0, &sample);
        }
        let seconds = begun.elapsed().as_secs_f64();
        on_pass(&Pass {
            spp: 1,
            seconds,
            error: None,
            film: &film,
            developing: shot.developing(),
        });
        let report = StillReport {
            renderer: NAME.to_owned(),
            width: request.width,
            height: request.height,
            spp: 1,
            seconds: vec![("render".to_owned(), seconds)],
            total_seconds: seconds,
            effects: shot.plan.effects.clone(),
            warnings: shot.lights.warnings.clone(),
            ..StillReport::default()
        };
        Ok(Exposure {
            film,
            report,
            pixels_per_mm: camera.pixels_per_mm(),
        })
    }

    fn recolour(&mut self, design: &Arc<Design>) -> bool {
        self.design = Arc::clone(design);
        true
    }
}

impl FirstSight {
    /// The picture, with what each pixel shows: what a later one is compared with.
    ///
    /// # Errors
    /// As [`Engine::expose`].
    pub fn look(&self, request: &StillRequest, job: &Job) -> Result<Sighted, StillError> {
        let design = coloured(&self.design, request)?;
        let camera = camera(&design, request)?;
        let sight = self.sight(&design, request, &camera)?;
        let rows = sight.rows(&camera, request, job)?;
        let curve = curve(request.exposure_ev);
        let mut rgba = vec![0u8; rows.light.len() * 4];
        (rgba.par_chunks_mut(4))
            .zip(&rows.light)
            .with_min_len(1 << 12)
            .for_each(|(pixel, seen)| show(&curve, *seen, pixel));
        Ok(Sighted {
            rgba,
            places: rows.places,
            pairs: sight.classes.pairs.clone(),
            yarns: design.yarns().to_vec(),
            pose: request.pose(),
        })
    }

    fn sight<'d>(
        &'d self,
        design: &'d Design,
        request: &StillRequest,
        camera: &Camera,
    ) -> Result<Sight<'d>, StillError> {
        let classes = YarnClasses::new(design);
        let tables = (classes.pairs.iter())
            .map(|pair| {
                let key = TableKey {
                    relief: ReliefKey {
                        pair: pair.clone(),
                        pitch: classes.pitch,
                        pose: request.view.pose(false),
                    },
                    light: request.light.clone(),
                    pose: request.pose(),
                };
                self.tables.get(&key)
            })
            .collect::<Result<Vec<_>, _>>()?;
        let yarns = design.yarns();
        let colours = if yarns.len() * yarns.len() <= MOST_PAIRS {
            (yarns.iter())
                .flat_map(|warp| yarns.iter().map(move |weft| (warp, weft)))
                .map(|(warp, weft)| colours_on_top(warp, weft))
                .collect()
        } else {
            Vec::new()
        };
        let [x, y] = origin(design, request);
        let ends = design.end_positions().seen_from(x);
        let picks = design.pick_positions().seen_from(y);
        let pitch = |positions: &Positions| positions.repeat_mm() / f64::from(positions.threads());
        let pixels = camera.pixels_per_mm() * pitch(&ends).min(pitch(&picks)) as f32;
        Ok(Sight {
            design,
            drawdown: &self.drawdown,
            classes,
            tables,
            colours,
            ends,
            picks,
            level: FaceTable::level(pixels),
            close: FaceTable::shows_texels(pixels),
            samples: ((1.0 / pixels).ceil() as usize).clamp(1, MOST_SAMPLES),
            backing: request.backing,
        })
    }
}

impl Sight<'_> {
    /// All of a picture.
    fn rows(&self, camera: &Camera, request: &StillRequest, job: &Job) -> Result<Rows, StillError> {
        job.check()?;
        let (width, height) = (request.width as usize, request.height as usize);
        let mut light = vec![(Vec3::ZERO, 0.0f32); width * height];
        let mut places = vec![Place::NONE; width * height];
        let straight = request.is_straight();
        let columns: Vec<(i64, f32)> = if straight {
            self.across(camera, width)
        } else {
            Vec::new()
        };
        (light.par_chunks_mut(width))
            .zip(places.par_chunks_mut(width))
            .enumerate()
            .for_each(|(y, (row, places))| match straight {
                true => self.straight_row(camera, y, &columns, row, places),
                false => self.slanting_row(camera, y, row, places),
            });
        Ok(Rows { light, places })
    }

    /// End and place in it for each sample across a straight view.
    fn across(&self, camera: &Camera, width: usize) -> Vec<(i64, f32)> {
        let step = 1.0 / self.samples as f32;
        (0..width * self.samples)
            .map(|sample| {
                let ray = camera.ray((sample as f32 + 0.5) * step, 0.5);
                let (end, u) = self.ends.locate(ray.origin.x.into());
                (end, u as f32)
            })
            .collect()
    }

    fn straight_row(
        &self,
        camera: &Camera,
        y: usize,
        columns: &[(i64, f32)],
        row: &mut [(Vec3, f32)],
        places: &mut [Place],
    ) {
        for sample in 0..self.samples {
            let along = y as f32 + (sample as f32 + 0.5) / self.samples as f32;
            let ray = camera.ray(0.5, along);
            let (pick, v) = self.picks.locate(ray.origin.y.into());
            let mut here: Option<Crossing> = None;
            for (column, &(end, u)) in columns.iter().enumerate() {
                let crossing = match here {
                    Some(here) if here.end == end => Some(here),
                    _ => self.crossing(end, pick),
                };
                here = crossing;
                if let Some(crossing) = crossing {
                    places[column / self.samples] = self.place(&crossing, u, v as f32);
                }
                let (light, cover) = self.seen(crossing.as_ref(), u, v as f32);
                let sum = &mut row[column / self.samples];
                *sum = (sum.0 + light, sum.1 + cover);
            }
        }
        let samples = (self.samples * self.samples) as f32;
        for (light, cover) in row {
            (*light, *cover) = (*light / cover.max(1e-6), *cover / samples);
        }
    }

    fn slanting_row(
        &self,
        camera: &Camera,
        y: usize,
        row: &mut [(Vec3, f32)],
        places: &mut [Place],
    ) {
        let mut here: Option<Crossing> = None;
        for (x, (pixel, shown)) in row.iter_mut().zip(places).enumerate() {
            let ray = camera.ray(x as f32 + 0.5, y as f32 + 0.5);
            let along = -ray.origin.z / ray.direction.z;
            if !(along > 0.0 && along.is_finite()) {
                continue;
            }
            let place = ray.origin + ray.direction * along;
            let (end, u) = self.ends.locate(place.x.into());
            let (pick, v) = self.picks.locate(place.y.into());
            let crossing = match here {
                Some(here) if (here.end, here.pick) == (end, pick) => Some(here),
                _ => self.crossing(end, pick),
            };
            here = crossing;
            if let Some(crossing) = crossing {
                *shown = self.place(&crossing, u as f32, v as f32);
            }
            let (light, cover) = self.seen(crossing.as_ref(), u as f32, v as f32);
            *pixel = (light / cover.max(1e-6), cover);
        }
    }

    /// Whether the warp is up at a crossing of the endless cloth; `None`: no cloth.
    fn up(&self, end: i64, pick: i64) -> Option<bool> {
        let (ends, picks) = (self.drawdown.ends(), self.drawdown.picks());
        let lattice = self.design.lattice();
        let (end, pick) = lattice.wrap(end, pick, ends, picks)?;
        Some(self.drawdown.get(end, pick))
    }

    fn crossing(&self, end: i64, pick: i64) -> Option<Crossing> {
        let here = self.up(end, pick)?;
        let beside = |end, pick| self.up(end, pick).unwrap_or(here);
        let key = key_of(
            here,
            Side::ALL.map(|side| {
                let (ends, picks) = side.offset();
                beside(end + ends, pick + picks)
            }),
        );
        let (warp, weft) = (
            self.design.warp_yarn(end, pick),
            self.design.weft_yarn(end, pick),
        );
        Some(Crossing {
            end,
            pick,
            key,
            set: self.classes.set(warp, weft),
            warp,
            weft,
            colours: self.colours(warp, weft),
        })
    }

    fn colours(&self, warp: YarnId, weft: YarnId) -> [Vec3; 2] {
        let yarns = self.design.yarns().len();
        let known = self
            .colours
            .get(usize::from(warp.0) * yarns + usize::from(weft.0));
        known
            .copied()
            .unwrap_or_else(|| colours_on_top(self.design.yarn(warp), self.design.yarn(weft)))
    }

    /// What a later picture is told of a place of a crossing.
    fn place(&self, crossing: &Crossing, u: f32, v: f32) -> Place {
        let place = Place {
            key: crossing.key,
            cell: Place::cell(u, v),
            set: crossing.set,
            warp: crossing.warp,
            weft: crossing.weft,
        };
        if self.samples > 1 {
            place.mixed()
        } else {
            place
        }
    }

    /// Light and cover of a place of a crossing and of what lies behind it.
    #[inline]
    fn light(&self, crossing: &Crossing, u: f32, v: f32) -> (Vec3, f32) {
        if self.close {
            return self.light_between(crossing, u, v);
        }
        let Some(table) = self.tables.get(usize::from(crossing.set)) else {
            return (Vec3::ZERO, 0.0);
        };
        self.lit(crossing, table, table.at(self.level, crossing.key, u, v))
    }

    /// As [`Self::light`] where pixels are smaller than the finest texels: in proportion
    /// between the four around the place, across the borders of crossings too, so that neither
    /// texels nor crossings are seen as tiles.
    fn light_between(&self, here: &Crossing, u: f32, v: f32) -> (Vec3, f32) {
        let [x, y] = [u, v].map(|place| place.clamp(0.0, 1.0) * TEXELS as f32 - 0.5);
        // Texel and crossing, seen from this one, of each neighbour along a direction.
        let beside = |at: f32| {
            let (first, share) = (at.floor(), at - at.floor());
            [(first as i64, 1.0 - share), (first as i64 + 1, share)].map(|(texel, share)| {
                let side = TEXELS as i64;
                (texel.div_euclid(side), texel.rem_euclid(side), share)
            })
        };
        let mut sum = (Vec3::ZERO, 0.0);
        for (picks, row, along) in beside(y) {
            for (ends, column, across) in beside(x) {
                let mut texel = [column as usize, row as usize];
                let there = match (ends, picks) {
                    (0, 0) => Some(*here),
                    _ => self.crossing(here.end + ends, here.pick + picks),
                };
                let crossing = there.unwrap_or_else(|| {
                    // The cloth ends: its border stands for what is not there.
                    let border = |offset: i64, own: usize| match offset {
                        0 => own,
                        -1 => 0,
                        _ => TEXELS - 1,
                    };
                    texel = [border(ends, texel[0]), border(picks, texel[1])];
                    *here
                });
                let Some(table) = self.tables.get(usize::from(crossing.set)) else {
                    continue;
                };
                let (light, cover) = self.lit(&crossing, table, table.texel(crossing.key, texel));
                let weight = along * across;
                sum = (sum.0 + light * weight, sum.1 + cover * weight);
            }
        }
        sum
    }

    /// Light and cover of a place of a crossing and of what lies behind it; no crossing: of what
    /// lies behind the cloth.
    #[inline]
    fn seen(&self, crossing: Option<&Crossing>, u: f32, v: f32) -> (Vec3, f32) {
        match (crossing, self.backing) {
            (Some(crossing), _) => self.light(crossing, u, v),
            (None, Backing::White) => (Vec3::splat(PAPER), 1.0),
            (None, Backing::Black) => (Vec3::ZERO, 1.0),
            (None, Backing::None | Backing::Itself) => (Vec3::ZERO, 0.0),
        }
    }

    /// Light and cover of a texel of a crossing, and of what is seen through its gaps.
    #[inline]
    fn lit(&self, crossing: &Crossing, table: &FaceTable, texel: Texel) -> (Vec3, f32) {
        let (light, cover) = crossing.lit(table, texel);
        let gap = 1.0 - cover;
        match self.backing {
            Backing::None => (light, cover),
            Backing::White => (light + PAPER * gap, 1.0),
            Backing::Itself if gap > 0.0 => (light + crossing.beneath(table) * gap, 1.0),
            Backing::Black | Backing::Itself => (light, 1.0),
        }
    }
}
