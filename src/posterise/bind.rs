//! Long floats where regions meet, bound by corrections.

use super::PosteriseError;
use crate::design::{Corrections, Regions, WeavePattern};
use crate::job::Job;

/// Corrections that bind floats, and what they could not bind.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Bound {
    /// The hand corrections there were, and the new ones; `None` if there are none.
    pub corrections: Option<Corrections>,
    /// Crossings that were exchanged.
    pub changed: u64,
    /// Floats between regions that are still too long.
    pub left: u64,
}

/// Rounds after which what is still too long is reported: an exchange can lengthen a float
/// the other way, and that of a next round another one.
const ROUNDS: u32 = 6;

/// Binds every float over more than `longest` crossings that reaches across regions, by
/// exchanging single crossings near the border; hand corrections stay. Floats within one
/// region are its weave's own and are left alone. The panel's border counts as an end.
///
/// # Errors
/// [`PosteriseError::Cancelled`].
pub fn bind_floats(regions: &Regions, longest: u32, job: &Job) -> Result<Bound, PosteriseError> {
    let weave = regions.weave();
    let (ends, picks) = (weave.ends(), weave.picks());
    let (hand, value) = match regions.corrections() {
        Some(found) => (found.mask().clone(), found.value().clone()),
        None => (
            WeavePattern::new(ends, picks),
            WeavePattern::new(ends, picks),
        ),
    };
    let mut cloth = Cloth {
        regions,
        longest: longest.max(1),
        weave,
        mask: hand.clone(),
        hand,
    };
    let (mut changed, mut left) = (0, 0);
    for _ in 0..ROUNDS {
        job.check()?;
        let before = cloth.mask.count_warp_up();
        left = cloth.bind_along(false) + cloth.bind_along(true);
        let now = cloth.mask.count_warp_up() - before;
        changed += now;
        if left == 0 && now == 0 {
            break;
        }
    }
    let mut values = value;
    for pick in 0..picks {
        for word in 0..values.words_per_pick() {
            let mask = cloth.mask.pick_word(word, pick) & !cloth.hand.pick_word(word, pick);
            let bits =
                values.pick_word(word, pick) & !mask | cloth.weave.pick_word(word, pick) & mask;
            values.set_pick_word(word, pick, bits);
        }
    }
    let corrections = (cloth.mask.count_warp_up() > 0)
        .then(|| Corrections::new(cloth.mask, values))
        .transpose()?;
    Ok(Bound {
        corrections,
        changed,
        left,
    })
}

struct Cloth<'r> {
    regions: &'r Regions,
    longest: u32,
    weave: WeavePattern,
    /// Where the designer or an earlier exchange has spoken.
    mask: WeavePattern,
    /// Where the designer has.
    hand: WeavePattern,
}

impl Cloth<'_> {
    /// Threads, and crossings on each, along the ends or the picks.
    fn size(&self, ends: bool) -> (u32, u32) {
        match ends {
            true => (self.weave.ends(), self.weave.picks()),
            false => (self.weave.picks(), self.weave.ends()),
        }
    }

    /// End and pick of a place on a thread.
    fn place(ends: bool, thread: u32, at: u32) -> (u32, u32) {
        if ends { (thread, at) } else { (at, thread) }
    }

    fn up(&self, ends: bool, thread: u32, at: u32) -> bool {
        let (end, pick) = Self::place(ends, thread, at);
        self.weave.get(end, pick)
    }

    fn region(&self, ends: bool, thread: u32, at: u32) -> u16 {
        let (end, pick) = Self::place(ends, thread, at);
        self.regions.map().get(end, pick)
    }

    /// Binds the floats of one direction; how many stayed too long.
    fn bind_along(&mut self, ends: bool) -> u64 {
        let (threads, crossings) = self.size(ends);
        let mut left = 0;
        for thread in 0..threads {
            let mut start = 0;
            while start < crossings {
                let side = self.up(ends, thread, start);
                let mut stop = start + 1;
                while stop < crossings && self.up(ends, thread, stop) == side {
                    stop += 1;
                }
                if stop - start > self.longest && !self.bind(ends, thread, start, stop) {
                    left += 1;
                }
                start = stop;
            }
        }
        left
    }

    /// Binds one float from `start` up to `stop`; false if it stays too long.
    fn bind(&mut self, ends: bool, thread: u32, start: u32, stop: u32) -> bool {
        let first = self.region(ends, thread, start);
        if (start..stop).all(|at| self.region(ends, thread, at) == first) {
            return true;
        }
        let mut from = start;
        while stop - from > self.longest {
            // The tie may lie anywhere that leaves no float too long before it; borders of
            // regions first, then as far on as possible.
            let reach = (from + self.longest).min(stop - 1);
            let border = |at: u32| {
                at > start && self.region(ends, thread, at) != self.region(ends, thread, at - 1)
            };
            let possible = |at: &u32| self.may_change(ends, thread, *at);
            let tie = ((from + 1)..=reach)
                .rev()
                .filter(|at| border(*at) && stop - at - 1 <= self.longest)
                .find(possible)
                .or_else(|| ((from + 1)..=reach).rev().find(possible));
            let Some(at) = tie else {
                return false;
            };
            let (end, pick) = Self::place(ends, thread, at);
            self.weave.set(end, pick, !self.weave.get(end, pick));
            self.mask.set(end, pick, true);
            from = at + 1;
        }
        true
    }

    /// Whether exchanging a crossing leaves the float across it short enough.
    fn may_change(&self, ends: bool, thread: u32, at: u32) -> bool {
        let (end, pick) = Self::place(ends, thread, at);
        if self.mask.get(end, pick) {
            return false;
        }
        let side = !self.weave.get(end, pick);
        let (_, crossings) = self.size(!ends);
        let same = |place: &u32| self.up(!ends, at, *place) == side;
        let above = (thread + 1..crossings).take_while(same).count() as u32;
        let below = (0..thread).rev().take_while(same).count() as u32;
        above + below < self.longest
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;
    use crate::design::{Fill, Grid, Region, floats};

    /// Satins whose origins do not fit, in blocks of odd sizes.
    fn clash(corrections: Option<Corrections>) -> Regions {
        let map = Grid::from_fn(80, 72, |end, pick| ((end / 11 + pick / 13) % 3) as u16);
        let region = |notation, origin| Region {
            origin,
            ..Region::new("r", Fill::by_notation(notation).unwrap())
        };
        let palette = vec![
            region("1/7 satin", (0, 0)),
            region("7/1 satin", (3, 2)),
            region("1/7 satin", (5, 6)),
        ];
        Regions::new(map.unwrap(), palette, corrections).unwrap()
    }

    fn longest(weave: &WeavePattern) -> u32 {
        let found = floats(weave).longest_inside;
        [
            found.warp_face,
            found.warp_back,
            found.weft_face,
            found.weft_back,
        ]
        .into_iter()
        .max()
        .unwrap()
    }

    #[test]
    fn floats_between_regions_are_bound_and_little_else_changes() {
        let regions = clash(None);
        assert!(longest(&regions.weave()) > 9, "the case must be one");
        let bound = bind_floats(&regions, 9, &Job::new()).unwrap();
        assert_eq!(bound.left, 0);
        let after = regions.clone().with_corrections(bound.corrections).unwrap();
        assert!(longest(&after.weave()) <= 9);
        assert!(bound.changed > 0 && bound.changed < 80 * 72 / 50);
    }

    #[test]
    fn hand_corrections_stay_as_they_are() {
        let mask = WeavePattern::from_fn(80, 72, |end, pick| (end * pick) % 17 == 3);
        let value = WeavePattern::from_fn(80, 72, |end, pick| (end + pick) % 2 == 0);
        let hand = Corrections::new(mask.clone(), value.clone()).unwrap();
        let bound = bind_floats(&clash(Some(hand)), 9, &Job::new()).unwrap();
        let found = bound.corrections.unwrap();
        for (end, pick) in (0..80 * 72).map(|k| (k % 80, k / 80)) {
            if mask.get(end, pick) {
                assert!(found.mask().get(end, pick));
                assert_eq!(found.value().get(end, pick), value.get(end, pick));
            }
        }
    }

    #[test]
    fn what_fits_is_left_alone() {
        let bound = bind_floats(&clash(None), 200, &Job::new()).unwrap();
        assert_eq!((bound.corrections, bound.changed, bound.left), (None, 0, 0));
    }
}
