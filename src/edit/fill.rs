//! Flood fill and replace: crossings that are alike.

use std::collections::VecDeque;

use super::cells::Cells;
use super::document::Document;
use super::symmetry::Surface;
use crate::design::{Design, Repeat, Structure, WeavePattern};

/// In what crossings are alike.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Alike {
    /// The same thread on top, whatever the region.
    Drawdown,
    /// The same region; of a design without regions, everything.
    Region,
}

/// A rule that says for 64 crossings at once (word, pick) which of them are alike to one.
struct Rule<'d> {
    like: Like<'d>,
    ends: u32,
    limits: Option<&'d Cells>,
}

enum Like<'d> {
    Woven(&'d WeavePattern, bool),
    Region(&'d Design, u16),
    All,
}

impl Rule<'_> {
    fn word(&self, word: u32, pick: u32) -> u64 {
        let alike = match self.like {
            Like::Woven(pattern, true) => pattern.pick_word(word, pick),
            Like::Woven(pattern, false) => !pattern.pick_word(word, pick),
            Like::All => u64::MAX,
            Like::Region(design, wanted) => match design.structure() {
                Structure::Regions(regions) => {
                    let values = regions.map().pick_values(word, pick).iter().enumerate();
                    values.fold(0, |bits, (place, &region)| {
                        bits | u64::from(region == wanted) << place
                    })
                }
                _ => u64::MAX,
            },
        };
        // Beyond the last end there is nothing, alike or not.
        let alike = match self.ends - 64 * word {
            width @ 0..64 => alike & ((1 << width) - 1),
            _ => alike,
        };
        match self.limits {
            Some(cells) => alike & cells.bits().pick_word(word, pick),
            None => alike,
        }
    }
}

fn rule<'d>(
    document: &'d Document,
    start: (u32, u32),
    alike: Alike,
    limits: Option<&'d Cells>,
) -> Rule<'d> {
    let design = document.design();
    let like = match (alike, design.structure()) {
        (Alike::Drawdown, _) => {
            let pattern = document.drawdown();
            Like::Woven(pattern, pattern.get(start.0, start.1))
        }
        (Alike::Region, Structure::Regions(regions)) => {
            Like::Region(design, regions.map().get(start.0, start.1))
        }
        (Alike::Region, _) => Like::All,
    };
    // A selection of another size limits nothing it could.
    let same = |cells: &&Cells| cells.size() == (design.ends(), design.picks());
    let limits = limits.filter(same);
    Rule {
        like,
        ends: design.ends(),
        limits,
    }
}

/// The crossings joined to `start` (end, pick of the design) through their sides that are
/// alike to it, across the seams of the repeat, within `limits` if there are any.
///
/// Works on 64 crossings at a time; its memory is two bits a crossing and a queue of words.
pub fn flood(
    document: &Document,
    start: (u32, u32),
    alike: Alike,
    limits: Option<&Cells>,
) -> Cells {
    let surface = Surface::of(document.design());
    let mut reached = Cells::none(surface.ends, surface.picks);
    if start.0 >= surface.ends || start.1 >= surface.picks {
        return reached;
    }
    let rule = rule(document, start, alike, limits);
    let mut flood = Flood {
        rule: &rule,
        waiting: WeavePattern::new(surface.ends.div_ceil(64), surface.picks),
        queue: VecDeque::new(),
        reached: &mut reached,
        surface,
    };
    flood.reach(start.0 / 64, start.1, 1 << (start.0 % 64));
    while let Some((word, pick)) = flood.queue.pop_front() {
        flood.waiting.set(word, pick, false);
        flood.spread(word, pick);
    }
    reached
}

struct Flood<'f> {
    rule: &'f Rule<'f>,
    /// Which words are in the queue, so that none is twice.
    waiting: WeavePattern,
    queue: VecDeque<(u32, u32)>,
    reached: &'f mut Cells,
    surface: Surface,
}

impl Flood<'_> {
    /// Adds those of `bits` that are alike and new, and has their word spread.
    fn reach(&mut self, word: u32, pick: u32, bits: u64) {
        let known = self.reached.bits().pick_word(word, pick);
        let new = bits & !known;
        if new == 0 {
            return;
        }
        let new = new & self.rule.word(word, pick);
        if new != 0 {
            self.reached.insert_word(word, pick, new);
            if !self.waiting.get(word, pick) {
                self.waiting.set(word, pick, true);
                self.queue.push_back((word, pick));
            }
        }
    }

    fn reach_one(&mut self, end: i64, pick: i64) {
        if let Some((end, pick)) = self.surface.wrap((end, pick)) {
            self.reach(end / 64, pick, 1 << (end % 64));
        }
    }

    /// Spreads what is reached of a word within it and to its four neighbours.
    fn spread(&mut self, word: u32, pick: u32) {
        let known = self.reached.bits().pick_word(word, pick);
        let bits = along(known, self.rule.word(word, pick));
        self.reached.insert_word(word, pick, bits);
        // The ends of the word touch its neighbours, or the design beside this one.
        let (first, last) = (64 * word, (64 * word + 63).min(self.surface.ends - 1));
        let (end, row) = (i64::from(first), i64::from(pick));
        if bits & 1 == 1 {
            self.reach_one(end - 1, row);
        }
        if bits >> (last - first) & 1 == 1 {
            self.reach_one(i64::from(last) + 1, row);
        }
        for up in [-1, 1] {
            let next = row + up;
            let inside = (0..i64::from(self.surface.picks)).contains(&next);
            match self.surface.lattice.along {
                _ if inside => self.reach(word, next as u32, bits),
                Repeat::None => {}
                Repeat::Straight => {
                    let picks = i64::from(self.surface.picks);
                    self.reach(word, next.rem_euclid(picks) as u32, bits);
                }
                // A dropped seam does not meet word for word.
                Repeat::Dropped(_) => {
                    for place in (0..64).filter(|place| bits >> place & 1 == 1) {
                        self.reach_one(end + place, next);
                    }
                }
            }
        }
    }
}

/// The bits of `allowed` joined to those of `from` side by side (Kogge–Stone prefix, both
/// ways).
fn along(from: u64, allowed: u64) -> u64 {
    let (mut up, mut through) = (from & allowed, allowed);
    for shift in [1, 2, 4, 8, 16, 32] {
        up |= through & up << shift;
        through &= through << shift;
    }
    let (mut down, mut through) = (up, allowed);
    for shift in [1, 2, 4, 8, 16, 32] {
        down |= through & down >> shift;
        through &= through >> shift;
    }
    down
}

/// Every crossing of the design alike to `start`, joined to it or not: what replace changes.
pub fn everywhere(
    document: &Document,
    start: (u32, u32),
    alike: Alike,
    limits: Option<&Cells>,
) -> Cells {
    let (ends, picks) = (document.design().ends(), document.design().picks());
    let mut cells = Cells::none(ends, picks);
    if start.0 >= ends || start.1 >= picks {
        return cells;
    }
    let rule = rule(document, start, alike, limits);
    for pick in 0..picks {
        for word in 0..ends.div_ceil(64) {
            cells.insert_word(word, pick, rule.word(word, pick));
        }
    }
    cells
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::design::{Lattice, Structure};
    use crate::edit::tests::design;

    /// Crossing by crossing, with a list of those seen: the plain way.
    fn brute(pattern: &WeavePattern, lattice: Lattice, start: (u32, u32)) -> Cells {
        let (ends, picks) = (pattern.ends(), pattern.picks());
        let mut found = Cells::none(ends, picks);
        let mut todo = vec![start];
        while let Some((end, pick)) = todo.pop() {
            if pattern.get(end, pick) != pattern.get(start.0, start.1) || !found.insert(end, pick) {
                continue;
            }
            for (e, p) in [(1, 0), (-1, 0), (0, 1), (0, -1)] {
                let (e, p) = (i64::from(end) + e, i64::from(pick) + p);
                todo.extend(lattice.wrap(e, p, ends, picks));
            }
        }
        found
    }

    proptest! {
        #[test]
        fn a_flood_reaches_what_a_plain_search_does(
            ends in 1u32..150, picks in 1u32..20, drop in 0u32..30, kind in 0..4, seed in any::<u64>()
        ) {
            let lattice = match kind {
                0 => Lattice::default(),
                1 => Lattice { across: Repeat::Dropped(drop), along: Repeat::Straight },
                2 => Lattice { across: Repeat::Straight, along: Repeat::Dropped(drop) },
                _ => Lattice { across: Repeat::None, along: Repeat::None },
            };
            let mut state = seed;
            let pattern = WeavePattern::from_fn(ends, picks, |_, _| {
                state = crate::hash::mix(state.wrapping_add(1));
                state % 5 < 2
            });
            let cloth = design(Structure::Pattern(pattern.clone())).with_lattice(lattice).unwrap();
            let document = Document::new(cloth);
            let start = ((seed % u64::from(ends)) as u32, (seed % u64::from(picks)) as u32);
            let found = flood(&document, start, Alike::Drawdown, None);
            prop_assert_eq!(&found, &brute(&pattern, lattice, start));
            let all = everywhere(&document, start, Alike::Drawdown, None);
            let wanted = if pattern.get(start.0, start.1) { pattern.clone() } else { pattern.inverted() };
            prop_assert_eq!(all.bits(), &wanted);
            let limits = Cells::of(ends, picks, [start]);
            prop_assert_eq!(flood(&document, start, Alike::Drawdown, Some(&limits)).count(), 1);
        }
    }

    #[test]
    fn a_flood_goes_round_the_repeat_and_not_over_the_edge_of_a_panel() {
        let pattern = WeavePattern::parse("#.#.#").unwrap();
        let cloth = design(Structure::Pattern(pattern));
        let document = Document::new(cloth.clone());
        assert_eq!(flood(&document, (0, 0), Alike::Drawdown, None).count(), 2);
        let panel = Lattice {
            across: Repeat::None,
            along: Repeat::None,
        };
        let document = Document::new(cloth.with_lattice(panel).unwrap());
        assert_eq!(flood(&document, (0, 0), Alike::Drawdown, None).count(), 1);
        assert_eq!(flood(&document, (0, 0), Alike::Region, None).count(), 5);
    }
}
