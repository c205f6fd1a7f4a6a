//! What is copied of a design: to be pasted, moved, turned, or used as a stamp.

use super::cells::{Cells, Rect};
use super::document::Document;
use super::edits::Edit;
use super::symmetry::{Point, Surface};
use crate::design::{Grid, Structure, WeavePattern, YarnId};

/// A piece of a design: which crossings of its box it covers, what they weave, and their
/// regions where there are any.
#[derive(Debug, Clone, PartialEq)]
pub struct Clip {
    cells: Cells,
    weave: WeavePattern,
    regions: Option<Grid<u16>>,
}

impl Clip {
    /// What a selection covers; `None` if it is empty or of another design.
    pub fn copy(document: &Document, selection: &Cells) -> Option<Self> {
        let design = document.design();
        let same = selection.size() == (design.ends(), design.picks());
        let bounds = selection.bounds().filter(|_| same)?;
        let Rect {
            end: left,
            pick: bottom,
            ends,
            picks,
        } = bounds;
        let covered = |end, pick| selection.contains(left + end, bottom + pick);
        let weave = |end, pick| document.drawdown().get(left + end, bottom + pick);
        let regions = match design.structure() {
            Structure::Regions(regions) => {
                let here = |end, pick| regions.map().get(left + end, bottom + pick);
                Some(Grid::from_fn(ends, picks, here).ok()?)
            }
            _ => None,
        };
        Some(Self {
            cells: Cells::of_pattern(&WeavePattern::from_fn(ends, picks, covered)),
            weave: WeavePattern::from_fn(ends, picks, weave),
            regions,
        })
    }

    /// A weave, all of it: to be stamped.
    pub fn of_weave(pattern: &WeavePattern) -> Self {
        Self {
            cells: Cells::all(pattern.ends(), pattern.picks()),
            weave: pattern.clone(),
            regions: None,
        }
    }

    /// Ends and picks of its box.
    pub fn size(&self) -> (u32, u32) {
        self.cells.size()
    }

    /// Which crossings of its box it covers.
    pub fn cells(&self) -> &Cells {
        &self.cells
    }

    /// What they weave.
    pub fn weave(&self) -> &WeavePattern {
        &self.weave
    }

    /// Its crossings where (end, pick) of the new box of `size` shows `from(end, pick)`.
    fn rearranged(&self, size: (u32, u32), from: impl Fn(u32, u32) -> (u32, u32)) -> Self {
        let pattern = |old: &WeavePattern| {
            WeavePattern::from_fn(size.0, size.1, |end, pick| {
                let (end, pick) = from(end, pick);
                old.get(end, pick)
            })
        };
        let regions = self.regions.as_ref().and_then(|old| {
            let here = |end, pick| {
                let (end, pick) = from(end, pick);
                old.get(end, pick)
            };
            Grid::from_fn(size.0, size.1, here).ok()
        });
        Self {
            cells: Cells::of_pattern(&pattern(self.cells.bits())),
            weave: pattern(&self.weave),
            regions,
        }
    }

    /// Left and right exchanged; the hand of a twill changes.
    pub fn mirrored(&self) -> Self {
        let (ends, picks) = self.size();
        self.rearranged((ends, picks), |end, pick| (ends - 1 - end, pick))
    }

    /// Turned by quarters anticlockwise, as a drawing: a marked crossing stays warp up.
    pub fn rotated(&self, quarters: u8) -> Self {
        let (ends, picks) = self.size();
        match quarters % 4 {
            1 => self.rearranged((picks, ends), |end, pick| (pick, picks - 1 - end)),
            2 => self.rearranged((ends, picks), |end, pick| {
                (ends - 1 - end, picks - 1 - pick)
            }),
            3 => self.rearranged((picks, ends), |end, pick| (ends - 1 - pick, end)),
            _ => self.clone(),
        }
    }

    /// Warp and weft exchanged on the face.
    pub fn inverted(&self) -> Self {
        Self {
            weave: self.weave.inverted(),
            ..self.clone()
        }
    }

    /// The edit that puts its weave at a place of the cloth, its lowest left crossing at
    /// `at`, wrapped by the repeat and painted with the surface's symmetries moved, not
    /// mirrored.
    pub fn paste(&self, surface: &Surface, at: Point) -> Edit {
        let mut cells = Cells::none(surface.ends, surface.picks);
        let mut values = WeavePattern::new(surface.ends, surface.picks);
        self.land(surface, at, |place, own| {
            cells.insert(place.0, place.1);
            values.set(place.0, place.1, self.weave.get(own.0, own.1));
        });
        Edit::Place { cells, values }
    }

    /// The edit that puts its regions there instead; `None` if it has none.
    pub fn paste_regions(&self, surface: &Surface, at: Point) -> Option<Edit> {
        let known = self.regions.as_ref()?;
        let mut cells = Cells::none(surface.ends, surface.picks);
        let mut regions = Grid::filled(surface.ends, surface.picks, 0).ok()?;
        self.land(surface, at, |place, own| {
            cells.insert(place.0, place.1);
            regions.set(place.0, place.1, known.get(own.0, own.1));
        });
        let regions = Box::new(regions);
        Some(Edit::PlaceRegions { cells, regions })
    }

    /// Where each of its crossings (second) lands in the design (first).
    fn land(&self, surface: &Surface, at: Point, mut put: impl FnMut((u32, u32), (u32, u32))) {
        let at = surface.held(at);
        for own in self.cells.iter() {
            let point = (at.0 + i64::from(own.0), at.1 + i64::from(own.1));
            if let Some(place) = surface.wrap(point) {
                put(place, own);
            }
        }
    }

    /// The edit that fills crossings with this piece, repeated from `origin` on: a stamp.
    /// What its box does not cover counts as weft.
    pub fn stamp(&self, cells: Cells, origin: Point) -> Edit {
        let (ends, picks) = cells.size();
        let mut values = WeavePattern::new(ends, picks);
        for (end, pick) in cells.iter() {
            let place = (i64::from(end) - origin.0, i64::from(pick) - origin.1);
            values.set(end, pick, self.weave.get_wrapped(place.0, place.1));
        }
        Edit::Place { cells, values }
    }
}

/// The edits that move a selection: weft is left behind, or region `behind` in a jacquard's
/// map where that is what is moved.
pub fn moved(document: &Document, selection: &Cells, by: Point, behind: Option<u16>) -> Vec<Edit> {
    let surface = Surface::of(document.design());
    let (Some(clip), Some(bounds)) = (Clip::copy(document, selection), selection.bounds()) else {
        return Vec::new();
    };
    let at = (i64::from(bounds.end) + by.0, i64::from(bounds.pick) + by.1);
    let cells = selection.clone();
    match (behind, clip.paste_regions(&surface, at)) {
        (Some(region), Some(paste)) => vec![Edit::PaintRegion { cells, region }, paste],
        _ => vec![
            Edit::Paint {
                cells,
                warp_up: false,
            },
            clip.paste(&surface, at),
        ],
    }
}

/// What is at a crossing: what a picker takes up and a status line says.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Picked {
    /// Whether the warp is on top.
    pub warp_up: bool,
    /// The yarn of the end.
    pub warp: YarnId,
    /// The yarn of the pick.
    pub weft: YarnId,
    /// The region, of a jacquard.
    pub region: Option<u16>,
    /// Whether a hand correction stands there.
    pub corrected: bool,
}

/// What is at a crossing of the design; `None` outside it.
pub fn picked(document: &Document, end: u32, pick: u32) -> Option<Picked> {
    let design = document.design();
    if end >= design.ends() || pick >= design.picks() {
        return None;
    }
    let (region, corrected) = match design.structure() {
        Structure::Regions(regions) => {
            let corrected = regions
                .corrections()
                .is_some_and(|kept| kept.mask().get(end, pick));
            (Some(regions.map().get(end, pick)), corrected)
        }
        _ => (None, false),
    };
    Some(Picked {
        warp_up: document.drawdown().get(end, pick),
        warp: design.warp_yarn(i64::from(end), i64::from(pick)),
        weft: design.weft_yarn(i64::from(end), i64::from(pick)),
        region,
        corrected,
    })
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;
    use crate::design::weave;
    use crate::edit::tests::{design, jacquard};

    fn document(art: &str) -> Document {
        Document::new(design(Structure::Pattern(
            WeavePattern::parse(art).unwrap(),
        )))
    }

    #[test]
    fn a_piece_is_copied_and_pasted_across_the_seam() {
        let mut document = document("....\n....\n##..\n#...");
        let clip = Clip::copy(&document, &Cells::of(4, 4, [(0, 0), (0, 1), (1, 1)])).unwrap();
        assert_eq!(clip.size(), (2, 2));
        let surface = Surface::of(document.design());
        document.apply(clip.paste(&surface, (3, 3))).unwrap();
        // (3, 3), (3, 0) and, round both seams, (0, 0); the crossing not covered stays.
        assert_eq!(document.drawdown().to_string(), "...#\n....\n##..\n#..#\n");
    }

    #[test]
    fn pieces_turn_as_drawings() {
        let document = document("#..\n##.");
        let clip = Clip::copy(&document, &Cells::all(3, 2)).unwrap();
        let art = |clip: &Clip| clip.weave().to_string();
        assert_eq!(art(&clip.mirrored()), "..#\n.##\n");
        assert_eq!(art(&clip.rotated(1)), "..\n.#\n##\n");
        assert_eq!(art(&clip.rotated(2)), ".##\n..#\n");
        assert_eq!(art(&clip.rotated(3)), "##\n#.\n..\n");
        assert_eq!(art(&clip.inverted()), ".##\n..#\n");
        assert_eq!(clip.rotated(1).rotated(3), clip);
        assert_ne!(clip.rotated(1).rotated(1), clip);
    }

    #[test]
    fn a_stamp_starts_at_its_origin() {
        let mut document = document("......\n......\n......\n......");
        let clip = Clip::of_weave(&weave("2/2 twill").unwrap());
        let cells = Cells::of_rect(
            6,
            4,
            Rect {
                end: 1,
                pick: 0,
                ends: 4,
                picks: 4,
            },
        );
        document.apply(clip.stamp(cells, (1, 0))).unwrap();
        let expected = "."; // The twill from end 1 on, weft on both sides of it.
        for (line, twill) in document
            .drawdown()
            .to_string()
            .lines()
            .zip(weave("2/2 twill").unwrap().to_string().lines())
        {
            assert_eq!(line, format!("{expected}{twill}{expected}"));
        }
    }

    #[test]
    fn moving_regions_leaves_one_behind() {
        let mut document = Document::new(jacquard(8, 4));
        let selection = Cells::of(8, 4, [(4, 0), (5, 0)]);
        document.begin("move");
        for edit in moved(&document, &selection, (-3, 1), Some(0)) {
            document.apply(edit).unwrap();
        }
        document.finish();
        let region = |end, pick| picked(&document, end, pick).unwrap().region;
        assert_eq!([region(4, 0), region(5, 0)], [Some(0); 2]);
        assert_eq!([region(1, 1), region(2, 1)], [Some(1); 2]);
        assert_eq!(region(3, 1), Some(0));
        assert_eq!(**document.drawdown(), document.design().weave());
        assert_eq!(document.entries().len(), 2);
        assert!(picked(&document, 8, 0).is_none());
    }
}
