//! The yarns of a window of cloth as centre curves and tubes, for programs that want
//! geometry and not voxels.
//!
//! Yarns are laid for the window's own weave with four threads more all round, by the same
//! [`WeaveGeometry`] that exemplars are built from. A tube is a yarn's envelope: plies and
//! fibres are not in it. Threads of several kinds are each laid against the commonest kind
//! that crosses them.

use std::f32::consts::TAU;
use std::ops::Range;

use glam::{Vec2, Vec3};

use super::geometry::WeaveGeometry;
use super::recipe::{RecipeError, YarnRecipe};
use crate::design::{Design, Direction, Positions, WeavePattern, YarnId};
use crate::limits::YARN_CROSSINGS;

/// Threads laid beyond the window on each side.
const MARGIN: i64 = 4;
/// Sections of a tube a crossing.
const SECTIONS: usize = 8;
/// Points round a section.
pub const ROUND: usize = 12;
/// Seed of what is uneven.
const SEED: u64 = 1;

/// A window whose yarns cannot be laid.
#[derive(Debug, thiserror::Error)]
pub enum TubesError {
    /// No crossings.
    #[error("a window of {0} ends and {1} picks has no yarns: give at least one of each")]
    Empty(u64, u64),
    /// Too many crossings.
    #[error(
        "the yarns of {0} x {1} crossings are too many for one file: choose a region of at most \
         {YARN_CROSSINGS} crossings"
    )]
    TooMany(u64, u64),
    /// A yarn that cannot be built.
    #[error(transparent)]
    Recipe(#[from] RecipeError),
}

/// One yarn of the window.
#[derive(Debug, Clone, PartialEq)]
pub struct YarnTube {
    /// End or pick.
    pub direction: Direction,
    /// Its number in the endless cloth.
    pub thread: i64,
    /// Which of the design's yarns, where it enters the window.
    pub yarn: YarnId,
    /// Centre of each section, mm.
    pub centre: Vec<Vec3>,
    /// [`ROUND`] points of each section, mm; counter-clockwise seen from where the yarn
    /// goes to.
    pub skin: Vec<Vec3>,
}

impl YarnTube {
    /// The triangles of the skin with both ends closed, as numbers of points of
    /// [`YarnTube::skin`], counter-clockwise seen from outside.
    pub fn triangles(&self) -> Vec<[u32; 3]> {
        let round = ROUND as u32;
        let last = (self.centre.len() as u32).saturating_sub(1) * round;
        let mut list = Vec::new();
        for section in (0..last).step_by(ROUND) {
            for k in 0..round {
                let next = (k + 1) % round;
                let (a, b) = (section + k, section + next);
                list.push([a, b, b + round]);
                list.push([a, b + round, a + round]);
            }
        }
        for k in 1..round - 1 {
            list.push([0, k + 1, k]);
            list.push([last, last + k, last + k + 1]);
        }
        list
    }

    /// Unit normals of the points of the skin.
    pub fn normals(&self) -> Vec<Vec3> {
        let count = self.centre.len();
        let point = |section: usize, k: usize| self.skin[section * ROUND + k % ROUND];
        (0..count * ROUND)
            .map(|index| {
                let (section, k) = (index / ROUND, index % ROUND);
                let round = point(section, k + 1) - point(section, k + ROUND - 1);
                let (before, after) = (section.saturating_sub(1), (section + 1).min(count - 1));
                let along = point(after, k) - point(before, k);
                let outwards = self.skin[index] - self.centre[section];
                (round.cross(along).try_normalize())
                    .or_else(|| outwards.try_normalize())
                    .unwrap_or(Vec3::Z)
            })
            .collect()
    }
}

/// The yarns of a window: ends from left to right, then picks from bottom to top.
///
/// # Errors
/// When the window is empty or too large, or a yarn cannot be built.
pub fn tubes(
    design: &Design,
    ends: Range<i64>,
    picks: Range<i64>,
) -> Result<Vec<YarnTube>, TubesError> {
    let count = |range: &Range<i64>| range.end.saturating_sub(range.start).max(0) as u64;
    let (width, height) = (count(&ends), count(&picks));
    if width == 0 || height == 0 {
        return Err(TubesError::Empty(width, height));
    }
    // What lies around the window is laid and thrown away, and is of no file.
    if width.saturating_mul(height) > YARN_CROSSINGS {
        return Err(TubesError::TooMany(width, height));
    }
    let design = design.lying();
    let window = Window {
        design: &design,
        weave: design.weave(),
        ends,
        picks,
    };
    let mut list = window.lay(Direction::Warp)?;
    list.extend(window.lay(Direction::Weft)?);
    Ok(list)
}

struct Window<'d> {
    design: &'d Design,
    weave: WeavePattern,
    ends: Range<i64>,
    picks: Range<i64>,
}

impl Window<'_> {
    /// The weave with its margin.
    fn pattern(&self) -> WeavePattern {
        let side = |range: &Range<i64>| (range.end - range.start + 2 * MARGIN) as u32;
        let lattice = self.design.lattice();
        let (ends, picks) = (self.weave.ends(), self.weave.picks());
        WeavePattern::from_fn(side(&self.ends), side(&self.picks), |end, pick| {
            let end = self.ends.start - MARGIN + i64::from(end);
            let pick = self.picks.start - MARGIN + i64::from(pick);
            lattice
                .wrap(end, pick, ends, picks)
                .is_some_and(|(end, pick)| self.weave.get(end, pick))
        })
    }

    fn yarn(&self, direction: Direction, thread: i64) -> YarnId {
        match direction {
            Direction::Warp => self.design.warp_yarn(thread, self.picks.start),
            Direction::Weft => self.design.weft_yarn(self.ends.start, thread),
        }
    }

    fn recipe(&self, yarn: YarnId) -> YarnRecipe {
        let yarn = self.design.yarn(yarn);
        YarnRecipe::family(yarn.family, yarn.diameter())
    }

    fn threads(&self, direction: Direction) -> &Range<i64> {
        match direction {
            Direction::Warp => &self.ends,
            Direction::Weft => &self.picks,
        }
    }

    /// The yarn that most threads of a direction are of.
    fn commonest(&self, direction: Direction) -> YarnId {
        let mut counts = vec![0u32; self.design.yarns().len()];
        for thread in self.threads(direction).clone() {
            counts[usize::from(self.yarn(direction, thread).0)] += 1;
        }
        let most = (0..counts.len()).max_by_key(|&yarn| (counts[yarn], usize::MAX - yarn));
        YarnId(most.unwrap_or(0) as u16)
    }

    fn lay(&self, direction: Direction) -> Result<Vec<YarnTube>, TubesError> {
        let sett = self.design.sett();
        let pitch = Vec2::new(sett.ends.mean_pitch_mm(), sett.picks.mean_pitch_mm());
        let other = match direction {
            Direction::Warp => Direction::Weft,
            Direction::Weft => Direction::Warp,
        };
        let crossed = self.recipe(self.commonest(other));
        crossed.check()?;
        let pattern = self.pattern();
        let mut laid: Vec<(YarnRecipe, WeaveGeometry)> = Vec::new();
        let places = Places {
            ends: self.design.end_positions(),
            picks: self.design.pick_positions(),
            first: [self.ends.start, self.picks.start],
            pitch,
        };
        let mut list = Vec::new();
        for thread in self.threads(direction).clone() {
            let yarn = self.yarn(direction, thread);
            let recipe = self.recipe(yarn);
            let known = laid.iter().position(|(known, _)| *known == recipe);
            let known = match known {
                Some(known) => known,
                None => {
                    recipe.check()?;
                    let (warp, weft) = match direction {
                        Direction::Warp => (&recipe, &crossed),
                        Direction::Weft => (&crossed, &recipe),
                    };
                    let geometry = WeaveGeometry::new(&pattern, warp, weft, pitch, SEED);
                    laid.push((recipe, geometry));
                    laid.len() - 1
                }
            };
            let (centre, skin) = self.tube(&laid[known].1, direction, thread, &places);
            list.push(YarnTube {
                direction,
                thread,
                yarn,
                centre,
                skin,
            });
        }
        Ok(list)
    }

    /// Centres and skin of one thread over the window.
    fn tube(
        &self,
        geometry: &WeaveGeometry,
        direction: Direction,
        thread: i64,
        places: &Places,
    ) -> (Vec<Vec3>, Vec<Vec3>) {
        let index = (thread - self.threads(direction).start + MARGIN) as usize;
        let (step, crossings) = match direction {
            Direction::Warp => (places.pitch.y, self.picks.end - self.picks.start),
            Direction::Weft => (places.pitch.x, self.ends.end - self.ends.start),
        };
        // Going along +x, +z and +y turn the other way round than going along +y.
        let turn = match direction {
            Direction::Warp => -1.0,
            Direction::Weft => 1.0,
        };
        let sections = crossings as usize * SECTIONS + 1;
        let (mut centre, mut skin) = (Vec::new(), Vec::new());
        for section in 0..sections {
            let along = (MARGIN as f32 + section as f32 / SECTIONS as f32) * step;
            let place = |u: f32, v: f32| places.real(geometry.place(direction, index, along, u, v));
            centre.push(place(0.0, 0.0));
            skin.extend((0..ROUND).map(|k| {
                let (sine, cosine) = (turn * TAU * k as f32 / ROUND as f32).sin_cos();
                place(cosine, sine)
            }));
        }
        (centre, skin)
    }
}

/// From places in even threads to places in the cloth.
struct Places {
    ends: Positions,
    picks: Positions,
    /// First end and pick of the window.
    first: [i64; 2],
    pitch: Vec2,
}

impl Places {
    fn real(&self, point: Vec3) -> Vec3 {
        let along = |positions: &Positions, mm: f32, pitch: f32, first: i64| {
            let threads = f64::from(mm / pitch);
            let thread = first - MARGIN + threads.floor() as i64;
            let part = threads - threads.floor();
            (positions.start(thread) + part * positions.pitch(thread)) as f32
        };
        Vec3::new(
            along(&self.ends, point.x, self.pitch.x, self.first[0]),
            along(&self.picks, point.y, self.pitch.y, self.first[1]),
            point.z,
        )
    }
}
