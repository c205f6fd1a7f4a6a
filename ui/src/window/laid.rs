//! Where the threads of a design lie: the geometry that views of the cloth share.

use std::sync::Arc;

use pickglass::design::{Design, Positions, Repeat, WeavePattern};
use pickglass::edit::Document;

/// A whole design larger than this is shown by its weave's repeat alone, threads.
const LARGEST_WHOLE: u32 = 192;

/// Ends and picks that show the whole design, colours included: the cloth's own repeat
/// where that is small enough to look at, else the weave's.
pub fn whole(design: &Design) -> (u32, u32) {
    let lattice = design.lattice();
    // Shifted repeats of the weave are no repeats of the colours.
    let straight = ![lattice.across, lattice.along]
        .iter()
        .any(|repeat| matches!(repeat, Repeat::Dropped(_)));
    let (all_ends, all_picks) = design.cloth_repeat();
    let bounded = |all: u64, own: u32, repeat: Repeat| match u32::try_from(all) {
        Ok(all) if all <= own.max(LARGEST_WHOLE) && straight && repeat == Repeat::Straight => all,
        _ => own,
    };
    (
        bounded(all_ends, design.ends(), lattice.across),
        bounded(all_picks, design.picks(), lattice.along),
    )
}

/// A design with its drawdown and the places of its threads, worked out once.
#[derive(Clone)]
pub struct Laid {
    pub design: Arc<Design>,
    pub drawdown: Arc<WeavePattern>,
    ends: Arc<Positions>,
    picks: Arc<Positions>,
}

impl Laid {
    /// The geometry of a document as it is now; what `before` still says of it is kept.
    pub fn of(document: &Document, before: Option<Self>) -> Self {
        let design = Arc::clone(document.design());
        let drawdown = Arc::clone(document.drawdown());
        let kept = before.filter(|before| {
            let size = |design: &Design| (design.ends(), design.picks());
            size(&before.design) == size(&design) && before.design.sett() == design.sett()
        });
        let (ends, picks) = match kept {
            Some(kept) => (kept.ends, kept.picks),
            None => (
                Arc::new(design.end_positions()),
                Arc::new(design.pick_positions()),
            ),
        };
        Self {
            design,
            drawdown,
            ends,
            picks,
        }
    }

    /// Size of the [`whole`] design, mm.
    pub fn whole_mm(&self) -> [f32; 2] {
        let (ends, picks) = whole(&self.design);
        [
            self.ends.start(i64::from(ends)) as f32,
            self.picks.start(i64::from(picks)) as f32,
        ]
    }

    /// The crossing (end, pick) of the endless cloth at a point of it, mm.
    pub fn crossing_at(&self, [x, y]: [f32; 2]) -> (i64, i64) {
        (
            self.ends.locate(f64::from(x)).0,
            self.picks.locate(f64::from(y)).0,
        )
    }

    /// The left, lower, right and upper border of a crossing, mm.
    pub fn crossing_mm(&self, end: i64, pick: i64) -> [f32; 4] {
        [
            self.ends.start(end) as f32,
            self.picks.start(pick) as f32,
            self.ends.start(end + 1) as f32,
            self.picks.start(pick + 1) as f32,
        ]
    }

    /// As [`Self::crossing_mm`], in the repeat nearest to a point of the cloth.
    pub fn near(&self, [x, y]: [f32; 2], end: i64, pick: i64) -> [f32; 4] {
        let nearest = |middle: f32, thread: i64, threads: u32, places: &Positions| {
            let threads = i64::from(threads.max(1));
            let at = places.locate(f64::from(middle)).0;
            let home = thread.rem_euclid(threads);
            home + ((at - home) as f64 / threads as f64).round() as i64 * threads
        };
        self.crossing_mm(
            nearest(x, end, self.design.ends(), &self.ends),
            nearest(y, pick, self.design.picks(), &self.picks),
        )
    }
}
