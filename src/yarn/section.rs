//! A cut through the cloth along one thread: how it passes over and under the others.

use glam::Vec2;

use super::geometry::WeaveGeometry;
use super::recipe::YarnRecipe;
use crate::design::{Design, Direction, WeavePattern, YarnId};

/// Points along a crossing of the thread's outline.
const STEPS: u32 = 12;
/// Points round a thread that is cut across.
const ROUND: usize = 20;
/// Threads beside the cut one that are laid out with it.
const BESIDE: i64 = 2;
/// The most crossings of a cut.
pub const MOST_CROSSINGS: u32 = 256;

/// A thread that the cut goes across.
#[derive(Debug, Clone, PartialEq)]
pub struct CutThread {
    /// Its number in the endless cloth.
    pub thread: i64,
    /// Its yarn.
    pub yarn: YarnId,
    /// Whether it lies over the cut thread on the face.
    pub over: bool,
    /// Outline, mm: along the cut and up.
    pub outline: Vec<Vec2>,
}

/// A cut along an end or a pick. Lengths in mm, from where the cut begins and from the
/// cloth's mid plane, the face upwards.
#[derive(Debug, Clone, PartialEq)]
pub struct CrossSection {
    /// The yarn that the cut follows.
    pub yarn: YarnId,
    /// Its upper surface from left to right.
    pub upper: Vec<Vec2>,
    /// Its lower surface from left to right.
    pub lower: Vec<Vec2>,
    /// The threads across.
    pub threads: Vec<CutThread>,
    /// Length of the cut.
    pub length_mm: f32,
}

/// Cuts the cloth of a design along an end (`Warp`) or a pick (`Weft`) of the endless
/// cloth, over `count` crossings from number `first` (at most [`MOST_CROSSINGS`]).
/// `None` where there is no cloth.
///
/// Yarns lie as the exemplars' recipes lay them, in the average spacing of the sett.
pub fn cross_section(
    design: &Design,
    drawdown: &WeavePattern,
    direction: Direction,
    thread: i64,
    first: i64,
    count: u32,
) -> Option<CrossSection> {
    let count = count.clamp(2, MOST_CROSSINGS);
    let side = (2 * BESIDE + 1) as u32;
    let (ends, picks) = match direction {
        Direction::Warp => (side, count),
        Direction::Weft => (count, side),
    };
    let (left, bottom) = match direction {
        Direction::Warp => (thread - BESIDE, first),
        Direction::Weft => (first, thread - BESIDE),
    };
    let lattice = design.lattice();
    let up = |end: i64, pick: i64| {
        let (end, pick) = lattice.wrap(end, pick, drawdown.ends(), drawdown.picks())?;
        Some(drawdown.get(end, pick))
    };
    up(left + BESIDE, bottom + BESIDE.min(i64::from(count) / 2))?;
    let pattern = WeavePattern::from_fn(ends, picks, |end, pick| {
        up(left + i64::from(end), bottom + i64::from(pick)).unwrap_or(false)
    });
    let yarn_at = |along: i64| match direction {
        Direction::Warp => (
            design.warp_yarn(thread, along),
            design.weft_yarn(thread, along),
        ),
        Direction::Weft => (
            design.weft_yarn(along, thread),
            design.warp_yarn(along, thread),
        ),
    };
    let lying = design.lying_yarns();
    let recipe = |id: YarnId| {
        let yarn = &lying[usize::from(id.0)];
        YarnRecipe::family(yarn.family, yarn.diameter())
    };
    let (own, across) = yarn_at(first);
    let (warp, weft) = match direction {
        Direction::Warp => (recipe(own), recipe(across)),
        Direction::Weft => (recipe(across), recipe(own)),
    };
    let sett = design.sett();
    let pitch = Vec2::new(sett.ends.mean_pitch_mm(), sett.picks.mean_pitch_mm());
    let geometry = WeaveGeometry::new(&pattern, &warp, &weft, pitch, 0);
    let (step, own_pitch, crossing) = match direction {
        Direction::Warp => (pitch.y, pitch.x, Direction::Weft),
        Direction::Weft => (pitch.x, pitch.y, Direction::Warp),
    };
    let index = BESIDE as usize;
    let middle = (index as f32 + 0.5) * own_pitch;
    let length_mm = step * count as f32;
    let surface = |upper: bool| {
        (0..=count * STEPS)
            .filter_map(|at| {
                let along = length_mm * at as f32 / (count * STEPS) as f32;
                let v = if upper { 1.0 } else { -1.0 };
                let z = geometry.place(direction, index, along, 0.0, v).z;
                z.is_finite().then(|| Vec2::new(along, z))
            })
            .collect()
    };
    let threads = (0..count)
        .map(|at| {
            let outline = (0..ROUND)
                .map(|k| {
                    let angle = k as f32 * std::f32::consts::TAU / ROUND as f32;
                    let (v, u) = angle.sin_cos();
                    let point = geometry.place(crossing, at as usize, middle, u, v);
                    let along = match direction {
                        Direction::Warp => point.y,
                        Direction::Weft => point.x,
                    };
                    Vec2::new(along, point.z)
                })
                .collect();
            let number = first + i64::from(at);
            let here = match direction {
                Direction::Warp => up(thread, number),
                Direction::Weft => up(number, thread),
            };
            let warp_up = here.unwrap_or(false);
            CutThread {
                thread: number,
                yarn: yarn_at(number).1,
                over: warp_up != (direction == Direction::Warp),
                outline,
            }
        })
        .collect();
    Some(CrossSection {
        yarn: own,
        upper: surface(true),
        lower: surface(false),
        threads,
        length_mm,
    })
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;
    use crate::presets;

    #[test]
    fn a_thread_passes_over_and_under_as_the_drawdown_says() {
        let design = presets::design("herringbone").unwrap().unwrap();
        let drawdown = design.weave();
        for direction in [Direction::Warp, Direction::Weft] {
            let cut = cross_section(&design, &drawdown, direction, 3, -5, 16).unwrap();
            assert_eq!(cut.threads.len(), 16);
            let mean = |points: &[Vec2]| {
                points.iter().map(|point| point.y).sum::<f32>() / points.len() as f32
            };
            for thread in &cut.threads {
                let (end, pick) = match direction {
                    Direction::Warp => (3, thread.thread),
                    Direction::Weft => (thread.thread, 3),
                };
                let up = drawdown.get_wrapped(end, pick);
                assert_eq!(thread.over, up != (direction == Direction::Warp));
                let at = (thread.thread + 5) as f32 + 0.5;
                let place = at / 16.0 * (cut.upper.len() - 1) as f32;
                let centre = 0.5 * (cut.upper[place as usize].y + cut.lower[place as usize].y);
                assert_eq!(mean(&thread.outline) > centre, thread.over, "{direction:?}");
            }
        }
    }

    #[test]
    fn wild_places_give_a_cut_or_none() {
        let design = presets::design("oxford").unwrap().unwrap();
        let drawdown = design.weave();
        for thread in [i64::from(i32::MIN), -1, 0, 1 << 40] {
            for count in [0, 1, u32::MAX] {
                let cut = cross_section(&design, &drawdown, Direction::Weft, thread, 7, count);
                let cut = cut.unwrap();
                assert!(
                    cut.upper
                        .iter()
                        .chain(&cut.lower)
                        .all(|point| point.is_finite())
                );
                assert!(cut.threads.len() <= MOST_CROSSINGS as usize);
            }
        }
    }
}
