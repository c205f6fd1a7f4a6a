//! What a mill checks before it weaves: ties, floats, take-up, heddles, yarn needed.
//!
//! Pure functions over a [`Design`]; nothing is rendered. [`check`] gathers them all.
//!
//! | file | holds |
//! |---|---|
//! | `floats` | the longest floats as the cloth repeats, in threads and mm |
//! | `layers` | whether the cloth hangs together (Clapham 1980) |
//! | `take_up` | crimp from interlacings, diameters and pitches (Peirce 1937) |
//! | `needs` | shafts, heddles, metres and grams of yarn |
//! | `reed` | dents, width in the reed, finished size |

mod floats;
mod layers;
mod needs;
mod reed;
mod take_up;

pub use floats::{FloatLength, FloatLengthsMm, SeamLength, lattice_floats};
pub use layers::{Layer, loose_layer};
pub use needs::{YarnNeed, heddles, yarn_needs};
pub use reed::{Reed, reed};
pub use take_up::{Interlacing, TakeUp, excess_mm, take_up};

use super::document::Design;
use super::pattern::WeavePattern;

/// Everything a mill checks.
#[derive(Debug, Clone, PartialEq)]
pub struct MillReport {
    /// The longest floats as the cloth repeats.
    pub longest: FloatLengthsMm,
    /// The longest floats within one repeat.
    pub inside: FloatLengthsMm,
    /// Floats longer than any within the repeat, which arise where repeats meet.
    pub seams: Vec<SeamLength>,
    /// Ends on one face throughout, from 0.
    pub unbound_ends: Vec<u32>,
    /// Picks on one face throughout, from 0.
    pub unbound_picks: Vec<u32>,
    /// Threads that lie wholly on top of the others; `None` = the cloth hangs together.
    pub loose: Option<Layer>,
    /// Take-up of the warp.
    pub warp: TakeUp,
    /// Take-up of the weft.
    pub weft: TakeUp,
    /// Heddles on each shaft for one repeat of the weave.
    pub heddles: Vec<u32>,
    /// Different lifts among the picks: treadles of a direct tie-up, bars of a dobby.
    pub lifts: u32,
    /// Width and height of the weave's repeat in mm.
    pub weave_repeat_mm: [f64; 2],
    /// Width and height of the cloth's repeat in mm, yarn orders and spacings included.
    pub cloth_repeat_mm: [f64; 2],
    /// What a metre of cloth takes of each of the design's yarns.
    pub yarns: Vec<YarnNeed>,
    /// The width of cloth that `yarns` is for, in mm: one repeat of the cloth, or of the
    /// weave where that is too long.
    pub width_mm: f64,
    /// Mass of the cloth in g/m².
    pub grams_per_m2: f64,
    /// Why no loom weaves it; empty = it can be woven.
    pub obstacles: Vec<String>,
}

impl MillReport {
    /// Whether it can be woven.
    pub fn weavable(&self) -> bool {
        self.obstacles.is_empty()
    }

    /// Take-up of the warp over that of the weft; 1 = balanced. `None` where the weft lies
    /// straight.
    pub fn balance(&self) -> Option<f64> {
        (self.weft.mean > 0.0).then(|| self.warp.mean / self.weft.mean)
    }
}

/// Checks a design. Yarns that have no room are obstacles, and all numbers are those of the
/// cloth in which they touch.
pub fn check(design: &Design) -> MillReport {
    let too_thick = design.too_thick();
    let design = &design.lying();
    let weave = design.weave();
    let found = lattice_floats(design, &weave);
    let warp = take_up(design, &weave, Interlacing::Warp);
    let weft = take_up(design, &weave, Interlacing::Weft);
    let needs = yarn_needs(design, &warp, &weft);
    let (ends, picks) = (i64::from(design.ends()), i64::from(design.picks()));
    let (all_ends, all_picks) = design.cloth_repeat();
    let across = |ends: i64| design.end_positions().start(ends);
    let along = |picks: i64| design.pick_positions().start(picks);
    let far = |threads: u64| i64::try_from(threads).unwrap_or(i64::MAX >> 1);
    let grams: f64 = needs.yarns.iter().map(|yarn| yarn.grams).sum();
    MillReport {
        obstacles: (too_thick.iter().map(ToString::to_string))
            .chain(obstacles(design, &found.unbound_ends, &found.unbound_picks))
            .collect(),
        longest: found.longest,
        inside: found.inside,
        seams: found.seams,
        unbound_ends: found.unbound_ends,
        unbound_picks: found.unbound_picks,
        loose: loose_layer(&weave),
        warp,
        weft,
        heddles: heddles(design, &weave),
        lifts: different_rows(&weave),
        weave_repeat_mm: [across(ends), along(picks)],
        cloth_repeat_mm: [across(far(all_ends)), along(far(all_picks))],
        grams_per_m2: grams / (needs.width_mm * 1e-3),
        width_mm: needs.width_mm,
        yarns: needs.yarns,
    }
}

/// What keeps a loom from weaving the design.
fn obstacles(design: &Design, ends: &[u32], picks: &[u32]) -> Vec<String> {
    let mut obstacles = Vec::new();
    for (map, thread) in [(&design.maps().warp, "warp"), (&design.maps().weft, "weft")] {
        if map.order().is_none() {
            obstacles.push(format!(
                "a {thread} yarn changes along its length: give the {thread} an order"
            ));
        }
    }
    for (threads, unbound) in [("end", ends), ("pick", picks)] {
        if let Some(first) = unbound.first() {
            obstacles.push(format!(
                "{} {threads}s are never bound, {threads} {} first: bind each at least once",
                unbound.len(),
                first + 1
            ));
        }
    }
    obstacles
}

/// How many picks lift differently.
fn different_rows(weave: &WeavePattern) -> u32 {
    let rows: std::collections::BTreeSet<Vec<u64>> = (0..weave.picks())
        .map(|pick| weave.pick_words(pick).collect())
        .collect();
    rows.len() as u32
}
