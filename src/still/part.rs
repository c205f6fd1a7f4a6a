//! Which crossings of a very large design a picture needs.
//!
//! Designs of up to [`MOST_AT_ONCE`] crossings are made into cloth whole. Of larger ones
//! the columns in view are, with all that lies so near that light comes from there; what
//! is shown is then, block for block, what the whole design would show.

use std::ops::Range;
use std::sync::Arc;

use super::picture::{camera, in_view};
use super::prepare::coloured;
use super::{StillError, StillRequest};
use crate::cloth::{ClothError, Region};
use crate::design::{Design, Positions};
use crate::synthesis::{MOST_AT_ONCE, Stretch};

/// Threads beyond the view that may throw light or shadow into it.
const BESIDE: i64 = 64;
/// Pixels along the longer side of a picture of a region.
const REGION_PIXELS: f64 = 16_000.0;

/// The crossings that a picture needs; `None` = the design is made into cloth whole.
///
/// # Errors
/// When the request is not usable.
pub(super) fn stretch(
    design: &Design,
    request: &StillRequest,
) -> Result<Option<Stretch>, StillError> {
    if u64::from(design.ends()) * u64::from(design.picks()) <= MOST_AT_ONCE {
        return Ok(None);
    }
    let (x, y) = in_view(&camera(design, request)?, request);
    let threads = |positions: Positions, range: Range<f32>| {
        let [from, to] = [range.start, range.end].map(|mm| positions.locate(mm.into()).0);
        from..to.saturating_add(1)
    };
    let seen = Stretch {
        ends: threads(design.end_positions(), x),
        picks: threads(design.pick_positions(), y),
    };
    Ok(Some(seen.grown(BESIDE, BESIDE)))
}

/// As [`stretch`], with room for the eye to move a little.
pub(super) fn roomy(
    design: &Design,
    request: &StillRequest,
) -> Result<Option<Stretch>, StillError> {
    let Some(seen) = stretch(design, request)? else {
        return Ok(None);
    };
    let share = |range: &Range<i64>| range.end.saturating_sub(range.start) / 4;
    let room = seen.grown(share(&seen.ends), share(&seen.picks));
    let fits = |stretch: &Stretch| {
        stretch
            .columns(design.ends(), design.picks(), design.lattice())
            .is_ok()
    };
    Ok(Some(if fits(&room) { room } else { seen }))
}

/// Refuses a picture that takes in more of a very large design than is made into cloth at
/// once, before anything is made.
///
/// # Errors
/// [`StillError::is_too_wide`], or when the request is not usable.
pub fn check_view(design: &Arc<Design>, request: &StillRequest) -> Result<(), StillError> {
    let design = coloured(design, request)?;
    if let Some(seen) = stretch(&design, request)? {
        seen.columns(design.ends(), design.picks(), design.lattice())
            .map_err(ClothError::from)?;
    }
    Ok(())
}

impl StillRequest {
    /// The same request, straight on a region of the cloth: what [`super::prepare`] makes
    /// for it has the whole region, however large the design is.
    pub fn over(self, design: &Design, region: &Region) -> Self {
        let span = |positions: Positions, first: i64, count: u32| {
            let from = positions.start(first);
            let to = positions.start(first.saturating_add(i64::from(count)));
            ((from + to) / 2.0, (to - from).max(1e-3))
        };
        let (x, wide) = span(design.end_positions(), region.end, region.ends);
        let (y, high) = span(design.pick_positions(), region.pick, region.picks);
        let per_mm = REGION_PIXELS / wide.max(high);
        let pixels = |mm: f64| ((mm * per_mm).ceil() as u32).max(1);
        Self {
            width: pixels(wide),
            height: pixels(high),
            width_mm: Some((f64::from(pixels(wide)) / per_mm) as f32),
            centre_mm: Some([x as f32, y as f32]),
            eye: None,
            ..self
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;
    use crate::design::{
        Family, Fill, Filled, Srgb, Structure, Yarn, YarnId, YarnMaps, usual_sett,
    };

    fn satin(ends: u32, picks: u32) -> Arc<Design> {
        let fill = Fill::by_notation("1/7 satin move 3").unwrap();
        let structure = Structure::Weave(Filled::new(fill, ends, picks).unwrap());
        let yarns = vec![
            Yarn::new("navy", Family::Cotton, Srgb(20, 30, 90)),
            Yarn::new("cream", Family::Cotton, Srgb(240, 230, 200)),
        ];
        let maps = YarnMaps::plain(YarnId(0), YarnId(1));
        let sett = usual_sett(&yarns, &maps);
        Arc::new(Design::new("satin", structure, yarns, maps, sett).unwrap())
    }

    #[test]
    fn only_very_large_designs_are_seen_in_parts() {
        let near = StillRequest::default();
        assert_eq!(stretch(&satin(5120, 6300), &near).unwrap(), None);
        let large = satin(16_000, 20_000);
        let seen = stretch(&large, &near).unwrap().unwrap();
        assert!(seen.ends.start > 7500 && seen.ends.end < 8500, "{seen:?}");
        assert!(seen.picks.start > 9500 && seen.picks.end < 10_500);
        let room = roomy(&large, &near).unwrap().unwrap();
        assert!(room.holds(&seen) && !seen.holds(&room));
        assert!(check_view(&large, &near).is_ok());
        let far = StillRequest {
            width_mm: Some(9000.0),
            ..near
        };
        assert!(check_view(&large, &far).unwrap_err().is_too_wide());
        assert!(check_view(&satin(5120, 6300), &far).is_ok());
    }

    #[test]
    fn a_region_lies_in_the_view_of_its_request() {
        let large = satin(16_000, 20_000);
        for (end, pick, ends, picks) in [(3, 5, 16, 16), (15_000, 19_000, 700, 3), (-40, 0, 2, 900)]
        {
            let region = Region {
                end,
                pick,
                ends,
                picks,
            };
            let request = StillRequest::default().over(&large, &region);
            let seen = stretch(&large, &request).unwrap().unwrap();
            let asked = Stretch {
                ends: end..end + i64::from(ends),
                picks: pick..pick + i64::from(picks),
            };
            assert!(seen.holds(&asked), "{region}: {seen:?}");
        }
    }
}
