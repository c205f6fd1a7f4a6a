//! Where the threads of a design lie: the geometry that views of the cloth share.

use std::sync::Arc;

use pickglass::design::{Design, Positions, Repeat, WeavePattern};
use pickglass::edit::Document;

use super::view::ClothView;

/// A whole design larger than this is shown by its weave's repeat alone, threads.
const LARGEST_WHOLE: u32 = 192;

/// Width of cloth that is shown of a design that was just opened, mm: one repeat, but no
/// more than this, and no fewer than [`FEWEST_OPENED`] threads.
pub const WIDEST_OPENED_MM: f32 = 200.0;
/// Threads across that a small repeat is shown with, itself and its neighbours.
const FEWEST_OPENED: f32 = 24.0;

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
    /// A design of this cloth: where an edit changes words or a draft alone it stays the
    /// one that pictures were made of.
    pub design: Arc<Design>,
    pub drawdown: Arc<WeavePattern>,
    /// Another number for every other cloth.
    pub cloth: u64,
    /// What the document had when this was last compared with it.
    seen: (Arc<Design>, Arc<WeavePattern>),
    ends: Arc<Positions>,
    picks: Arc<Positions>,
}

impl Laid {
    /// The geometry of a document as it is now; what `before` still says of it is kept.
    pub fn of(document: &Document, before: Option<Self>) -> Self {
        let design = Arc::clone(document.design());
        let drawdown = Arc::clone(document.drawdown());
        let cloth = before.as_ref().map_or(0, |before| before.cloth + 1);
        let before = match before {
            Some(before) if before.is_of(&design, &drawdown) => {
                let seen = (design, drawdown);
                return Self { seen, ..before };
            }
            before => before,
        };
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
            seen: (Arc::clone(&design), Arc::clone(&drawdown)),
            design,
            drawdown,
            cloth,
            ends,
            picks,
        }
    }

    /// Whether a state of the document is this cloth.
    fn is_of(&self, design: &Arc<Design>, drawdown: &Arc<WeavePattern>) -> bool {
        let same = Arc::ptr_eq(design, &self.seen.0) && Arc::ptr_eq(drawdown, &self.seen.1);
        same || design.same_cloth(drawdown, &self.design, &self.drawdown)
    }

    /// Size of the [`whole`] design, mm.
    pub fn whole_mm(&self) -> [f32; 2] {
        let (ends, picks) = whole(&self.design);
        [
            self.ends.start(i64::from(ends)) as f32,
            self.picks.start(i64::from(picks)) as f32,
        ]
    }

    /// Width of cloth across a pane whose width is `aspect` times its height, mm, where the
    /// design was just opened.
    pub fn opened_mm(&self, aspect: f32) -> f32 {
        let [width, height] = self.whole_mm();
        let sett = self.design.sett();
        let pitch = sett.ends.mean_pitch_mm().max(sett.picks.mean_pitch_mm());
        let fitting = ClothView::MARGIN * width.max(height * aspect);
        fitting.min(WIDEST_OPENED_MM).max(FEWEST_OPENED * pitch)
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

#[cfg(test)]
mod tests {
    use super::*;
    use pickglass::design::{Sett, Structure};

    /// A weave of so many ends and picks at 20 threads a cm each way.
    fn laid(ends: u32, picks: u32) -> Laid {
        let blank = crate::window::session::blank().expect("a design");
        let weave = Structure::Pattern(WeavePattern::new(ends, picks));
        let design = Design::clone(&blank.design)
            .with_structure(weave)
            .expect("woven");
        let design = design.with_sett(Sett::per_cm(20.0, 20.0)).expect("a sett");
        Laid::of(&Document::new(design), None)
    }

    #[test]
    fn a_design_is_opened_on_one_repeat_and_no_wider_than_is_said() {
        // 0.5 mm a thread: 120 ends are 60 mm, with a margin.
        let width = laid(120, 120).opened_mm(1.0);
        assert!((width - 60.0 * ClothView::MARGIN).abs() < 0.01, "{width}");
        // What is higher than the pane decides.
        let width = laid(120, 120).opened_mm(1.5);
        assert!((width - 90.0 * ClothView::MARGIN).abs() < 0.01, "{width}");
        for (ends, picks) in [(960, 600), (600, 4000), (5120, 6300)] {
            assert_eq!(laid(ends, picks).opened_mm(1.2), WIDEST_OPENED_MM);
        }
        // Four threads alone would be a fence: 24 of them are shown.
        assert!((laid(4, 4).opened_mm(1.0) - 12.0).abs() < 0.01);
    }
}
