//! Ties for floats that are too long, on either face and in either direction.
//!
//! A tie is one crossing turned over. In a long float of the warp it puts the weft on top,
//! which lengthens floats of the weft beside it: a binding that looks at one direction only
//! moves the trouble. Here every turn is weighed on both threads that cross.
//!
//! Three passes, each for what the last left over:
//! 1. ties on a satin grid of `longest + 1`, the even look that mills choose, wherever a
//!    turn ends too long a float and begins none;
//! 2. single ties where they help most, with a bounded number of detours out of dead ends;
//! 3. for the few repeats where that finds no way (small odd ones): plain weave, turned back
//!    crossing by crossing towards the weave asked for as long as nothing becomes too long.
//!    Plain weave cut to any repeat floats over two at most, so this always ends well.

use std::collections::VecDeque;

use super::regular::satin_moves;
use crate::design::pattern::WeavePattern;

/// Floats that cannot be bound.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum BindError {
    /// A limit below one.
    #[error("floats of at most 0 threads: give 1 or more")]
    Zero,
    /// A single thread has nothing to be bound by.
    #[error(
        "a repeat of {ends} ends and {picks} picks cannot be bound: repeat the weave to at \
         least 2 each way first"
    )]
    TooSmall {
        /// Ends of the weave.
        ends: u32,
        /// Picks of the weave.
        picks: u32,
    },
    /// Only plain weave has no float of two, and it needs even repeats.
    #[error(
        "only plain weave floats over 1, and it does not fit {ends} ends × {picks} picks: \
         allow floats of 2 or repeat the weave to even numbers"
    )]
    Odd {
        /// Ends of the weave.
        ends: u32,
        /// Picks of the weave.
        picks: u32,
    },
}

/// The weave with ties added so that no float, of warp or weft, on face or back, counted
/// round the straight repeat, is longer than `longest` threads. A weave without such floats
/// comes back as it is.
///
/// # Errors
/// [`BindError`] if the repeat is too small to be bound, or `longest` is 1 and the repeat
/// odd.
pub fn bind_floats(weave: &WeavePattern, longest: u32) -> Result<WeavePattern, BindError> {
    let (ends, picks) = (weave.ends(), weave.picks());
    if longest == 0 {
        return Err(BindError::Zero);
    }
    if ends < 2 || picks < 2 {
        return Err(BindError::TooSmall { ends, picks });
    }
    if longest == 1 {
        if ends % 2 == 1 || picks % 2 == 1 {
            return Err(BindError::Odd { ends, picks });
        }
        return Ok(nearest_plain(weave));
    }
    let mut bound = Binding {
        weave: weave.clone(),
        // No float is longer than a thread unless it never ends, which any limit shows.
        longest: longest.min(ends.max(picks)),
    };
    bound.on_a_satin_grid();
    if !bound.by_single_ties() {
        bound.weave = nearest_plain(weave);
        bound.turn_back_to(weave);
    }
    Ok(bound.weave)
}

/// Plain weave cut to the size of `weave`, in the step that agrees with it at more places.
fn nearest_plain(weave: &WeavePattern) -> WeavePattern {
    let agreeing = |step: u32| {
        (0..weave.picks())
            .flat_map(|pick| (0..weave.ends()).map(move |end| (end, pick)))
            .filter(|&(end, pick)| weave.get(end, pick) == ((end + pick) % 2 == step))
            .count()
    };
    let step = u32::from(agreeing(1) > agreeing(0));
    WeavePattern::from_fn(weave.ends(), weave.picks(), |end, pick| {
        (end + pick) % 2 == step
    })
}

/// A float that is too long: along a pick or an end, from a thread on, so many crossings.
#[derive(Debug, Clone, Copy)]
struct Long {
    along_pick: bool,
    thread: u32,
    start: u32,
    length: u32,
}

impl Long {
    /// The crossing `step` after its start, round the repeat.
    fn crossing(&self, step: u32, weave: &WeavePattern) -> (u32, u32) {
        if self.along_pick {
            ((self.start + step) % weave.ends(), self.thread)
        } else {
            (self.thread, (self.start + step) % weave.picks())
        }
    }
}

/// Detours for each thread that is left over, before plain weave takes the weave's place.
const DETOURS: u32 = 64;
/// The most detours in all.
const MAX_DETOURS: u32 = 20_000;
/// The most times that all crossings are gone through to turn them back.
const MAX_TURNS: u32 = 16;

struct Binding {
    weave: WeavePattern,
    longest: u32,
}

impl Binding {
    /// By how much the floats through a crossing are too long: the windows of
    /// `longest` + 1 equal crossings that hold it, along its pick and along its end.
    fn excess(&self, end: u32, pick: u32) -> u32 {
        let (ends, picks) = (self.weave.ends(), self.weave.picks());
        let value = self.weave.get(end, pick);
        let reach = |at: &dyn Fn(u32) -> bool| {
            (1..=self.longest).take_while(|&by| at(by) == value).count() as u32
        };
        let right = reach(&|by| self.weave.get((end + by % ends) % ends, pick));
        let left = reach(&|by| self.weave.get((end + ends - by % ends) % ends, pick));
        let up = reach(&|by| self.weave.get(end, (pick + by % picks) % picks));
        let down = reach(&|by| self.weave.get(end, (pick + picks - by % picks) % picks));
        (left + right + 1).saturating_sub(self.longest)
            + (down + up + 1).saturating_sub(self.longest)
    }

    fn turn(&mut self, end: u32, pick: u32) {
        let value = self.weave.get(end, pick);
        self.weave.set(end, pick, !value);
    }

    /// How much better the weave is with a crossing turned over.
    fn gain(&mut self, end: u32, pick: u32) -> i64 {
        let before = self.excess(end, pick);
        self.turn(end, pick);
        let after = self.excess(end, pick);
        self.turn(end, pick);
        i64::from(before) - i64::from(after)
    }

    fn on_a_satin_grid(&mut self) {
        let grid = self.longest + 1;
        let moves = satin_moves(grid.min(4096));
        // The move nearest the middle of its kind; a twill where there is no satin.
        let step = moves.get(moves.len() / 2).copied().unwrap_or(1);
        for pick in 0..self.weave.picks() {
            let first = (u64::from(pick) * u64::from(step) % u64::from(grid)) as u32;
            for end in (first..self.weave.ends()).step_by(grid as usize) {
                if self.excess(end, pick) == 0 {
                    continue;
                }
                self.turn(end, pick);
                if self.excess(end, pick) > 0 {
                    self.turn(end, pick);
                }
            }
        }
    }

    /// The floats of one thread that are too long, round the repeat.
    fn long_floats(&self, along_pick: bool, thread: u32) -> Vec<Long> {
        let (at, length): (&dyn Fn(u32) -> bool, u32) = if along_pick {
            (&|place| self.weave.get(place, thread), self.weave.ends())
        } else {
            (&|place| self.weave.get(thread, place), self.weave.picks())
        };
        let long = |start, length| Long {
            along_pick,
            thread,
            start,
            length,
        };
        let turns = |&place: &u32| at(place) != at((place + length - 1) % length);
        let Some(first) = (0..length).find(turns) else {
            // Nothing binds this thread at all: it floats for ever.
            return vec![long(0, length.max(self.longest + 1))];
        };
        let mut found = Vec::new();
        let (mut start, mut run) = (first, 1);
        for step in 1..=length {
            let place = (first + step) % length;
            if step < length && at(place) == at(start) {
                run += 1;
                continue;
            }
            if run > self.longest {
                found.push(long(start, run));
            }
            (start, run) = (place, 1);
        }
        found
    }

    /// Turns single crossings until nothing is too long; false if it found no way.
    fn by_single_ties(&mut self) -> bool {
        let picks = (0..self.weave.picks()).map(|pick| (true, pick));
        let ends = (0..self.weave.ends()).map(|end| (false, end));
        let mut waiting: VecDeque<(bool, u32)> = picks
            .chain(ends)
            .filter(|&(along_pick, thread)| !self.long_floats(along_pick, thread).is_empty())
            .collect();
        let most = MAX_DETOURS.min(DETOURS * (waiting.len() as u32).saturating_add(4));
        let mut detours = 0;
        while let Some((along_pick, thread)) = waiting.pop_front() {
            let long = self.long_floats(along_pick, thread);
            let Some(&float) = long.get(detours as usize % long.len().max(1)) else {
                continue;
            };
            let mut helped = false;
            for float in &long {
                helped |= self.tie(float, &mut waiting);
            }
            if !helped {
                // A dead end: the least bad tie of one float, another one each time.
                if detours >= most {
                    return false;
                }
                detours += 1;
                let (step, _) = self.best_in(&float, 0, float.length, detours);
                self.turn_at(&float, step, &mut waiting);
            }
            waiting.push_back((along_pick, thread));
        }
        true
    }

    /// Ties one float, often enough that no part of it is too long. True if that helped.
    fn tie(&mut self, float: &Long, waiting: &mut VecDeque<(bool, u32)>) -> bool {
        let mut helped = false;
        let mut from = 0;
        while from < float.length && float.length - from > self.longest {
            let to = from.saturating_add(self.longest + 1).min(float.length);
            let (step, gain) = self.best_in(float, from, to, 0);
            from = if gain > 0 {
                self.turn_at(float, step, waiting);
                helped = true;
                step + 1
            } else {
                to
            };
        }
        helped
    }

    /// Turns a crossing of a float over; the thread that crosses there is looked at again.
    fn turn_at(&mut self, float: &Long, step: u32, waiting: &mut VecDeque<(bool, u32)>) {
        let (end, pick) = float.crossing(step, &self.weave);
        self.turn(end, pick);
        let crossing = if float.along_pick { end } else { pick };
        waiting.push_back((!float.along_pick, crossing));
    }

    /// The best place for a tie among some crossings of a float, and its gain. Of equally
    /// good places the one nearest the middle, or on detours another each time.
    fn best_in(&mut self, float: &Long, from: u32, to: u32, detour: u32) -> (u32, i64) {
        let middle = u64::from(from) + u64::from(to);
        // Every fourth detour goes anywhere, lest it undo the one before for ever.
        let anywhere = detour > 0 && crate::hash::mix(u64::from(detour)).is_multiple_of(4);
        let mut best = (from, i64::MIN, u64::MAX);
        for step in from..to {
            let (end, pick) = float.crossing(step, &self.weave);
            let gain = if anywhere { 0 } else { self.gain(end, pick) };
            let off = match detour {
                0 => (2 * u64::from(step) + 1).abs_diff(middle),
                _ => crate::hash::mix(u64::from(detour) << 32 | u64::from(step)),
            };
            if gain > best.1 || gain == best.1 && off < best.2 {
                best = (step, gain, off);
            }
        }
        (best.0, best.1)
    }

    /// Turns crossings back to what `asked` says wherever nothing becomes too long.
    fn turn_back_to(&mut self, asked: &WeavePattern) {
        for _ in 0..MAX_TURNS {
            let mut changed = false;
            for pick in 0..self.weave.picks() {
                for end in 0..self.weave.ends() {
                    if self.weave.get(end, pick) == asked.get(end, pick) {
                        continue;
                    }
                    self.turn(end, pick);
                    if self.excess(end, pick) > 0 {
                        self.turn(end, pick);
                    } else {
                        changed = true;
                    }
                }
            }
            if !changed {
                break;
            }
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::super::weave;
    use super::*;

    #[test]
    fn a_weave_without_long_floats_stays_as_it_is() {
        for notation in ["plain", "2/2 twill", "1/7 satin", "4/4 basket"] {
            let asked = weave(notation).unwrap();
            assert_eq!(bind_floats(&asked, 7).unwrap(), asked, "{notation}");
        }
        let satin = weave("1/7 satin").unwrap();
        assert_ne!(bind_floats(&satin, 6).unwrap(), satin);
    }

    #[test]
    fn a_bare_ground_is_bound_in_satin() {
        let bound = bind_floats(&WeavePattern::new(8, 8), 7).unwrap();
        // One tie an end and pick, none touching: a satin.
        assert_eq!(bound.count_warp_up(), 8);
        for pick in 0..8 {
            let tie = (0..8).find(|&end| bound.get(end, pick)).unwrap();
            for beside in [tie + 1, tie + 7] {
                assert!(!bound.get(beside % 8, (pick + 1) % 8), "{bound}");
            }
        }
    }

    #[test]
    fn turning_plain_weave_back_never_makes_a_float_too_long() {
        let mut bits = 0x2545_f491_4f6c_dd1d_u64;
        for (ends, picks) in [(5, 7), (9, 4), (16, 16), (3, 3)] {
            let asked = WeavePattern::from_fn(ends, picks, |_, _| {
                bits = crate::hash::mix(bits);
                bits & 3 == 0
            });
            for longest in 2..6 {
                let plain = nearest_plain(&asked);
                let mut bound = Binding {
                    weave: plain.clone(),
                    longest,
                };
                bound.turn_back_to(&asked);
                for end in 0..ends {
                    assert!(bound.long_floats(false, end).is_empty());
                }
                for pick in 0..picks {
                    assert!(bound.long_floats(true, pick).is_empty());
                }
                let kept = |weave: &WeavePattern| {
                    let crossings = (0..picks).flat_map(|p| (0..ends).map(move |e| (e, p)));
                    crossings
                        .filter(|&(e, p)| weave.get(e, p) == asked.get(e, p))
                        .count()
                };
                assert!(kept(&bound.weave) >= kept(&plain));
                assert!(longest < 5 || kept(&bound.weave) > kept(&plain));
            }
        }
    }

    #[test]
    fn what_cannot_be_bound_is_refused() {
        let bare = WeavePattern::new(3, 4);
        assert_eq!(bind_floats(&bare, 0), Err(BindError::Zero));
        assert!(matches!(bind_floats(&bare, 1), Err(BindError::Odd { .. })));
        let single = WeavePattern::new(1, 4);
        assert!(matches!(
            bind_floats(&single, 3),
            Err(BindError::TooSmall { .. })
        ));
        let even = bind_floats(&WeavePattern::new(4, 4), 1).unwrap();
        assert_eq!(even.count_warp_up(), 8);
    }
}
