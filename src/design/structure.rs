//! What a weave is made of: a pattern, a draft, a notation, or regions of weaves.

use std::sync::Arc;

use super::draft::Draft;
use super::grid::Grid;
use super::maps::{YarnMap, YarnMaps};
use super::pattern::{SizeError, WeavePattern, check_size};
use super::source::SourceImage;
use super::weaves::{NotationError, weave};
use super::yarn::{Srgb, YarnId};

/// A small weave to fill with: its notation if it has one, and its repeat.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fill {
    notation: Option<String>,
    pattern: WeavePattern,
}

impl Fill {
    /// The weave of a notation ("1/7 satin move 3").
    ///
    /// # Errors
    /// [`NotationError`], see [`super::weave`].
    pub fn by_notation(notation: &str) -> Result<Self, NotationError> {
        Ok(Self {
            pattern: weave(notation)?,
            notation: Some(notation.trim().to_owned()),
        })
    }

    /// A drawn repeat.
    pub fn drawn(pattern: WeavePattern) -> Self {
        Self {
            notation: None,
            pattern,
        }
    }

    /// The notation it was made by, if any.
    pub fn notation(&self) -> Option<&str> {
        self.notation.as_deref()
    }

    /// One repeat.
    pub fn pattern(&self) -> &WeavePattern {
        &self.pattern
    }
}

/// One colour of a jacquard's artwork: the weave that fills it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Region {
    /// What the designer calls it.
    pub name: String,
    /// The colour that stands for it in the artwork, if it has one.
    pub colour: Option<Srgb>,
    /// The weave that fills it.
    pub fill: Fill,
    /// The crossing (end, pick) where the weave's own (0, 0) lies.
    pub origin: (i32, i32),
    /// Whether the designer fixed the weave: proposals leave it alone.
    pub locked: bool,
    /// Yarns of its own, which no loom can do ("preview only"); `None` = the design's.
    pub yarns: Option<RegionYarns>,
}

impl Region {
    /// A region with a weave that starts at crossing (0, 0), in the design's yarns.
    pub fn new(name: impl Into<String>, fill: Fill) -> Self {
        Self {
            name: name.into(),
            colour: None,
            fill,
            origin: (0, 0),
            locked: false,
            yarns: None,
        }
    }
}

/// The yarns of a region whose warp and weft change along their length (Zhao 2012 §5.2).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RegionYarns {
    /// Of its ends.
    pub warp: YarnId,
    /// Of its picks.
    pub weft: YarnId,
}

/// Crossings set by hand, over whatever the regions weave.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Corrections {
    /// Where a correction stands.
    mask: WeavePattern,
    /// What it says there.
    value: WeavePattern,
}

impl Corrections {
    /// From two patterns of one size: where, and what (ignored elsewhere).
    ///
    /// # Errors
    /// [`StructureError::Corrections`] if the sizes differ.
    pub fn new(mask: WeavePattern, value: WeavePattern) -> Result<Self, StructureError> {
        if (mask.ends(), mask.picks()) != (value.ends(), value.picks()) {
            return Err(StructureError::Corrections);
        }
        Ok(Self { mask, value })
    }

    /// Where corrections stand.
    pub fn mask(&self) -> &WeavePattern {
        &self.mask
    }

    /// What they say.
    pub fn value(&self) -> &WeavePattern {
        &self.value
    }

    /// None yet, for a design of this size.
    pub(crate) fn none(ends: u32, picks: u32) -> Self {
        let mask = WeavePattern::new(ends, picks);
        let value = mask.clone();
        Self { mask, value }
    }

    /// Where corrections stand, and what they say, to be changed in place.
    pub(crate) fn parts_mut(&mut self) -> (&mut WeavePattern, &mut WeavePattern) {
        (&mut self.mask, &mut self.value)
    }
}

/// A jacquard's artwork: a region for every crossing, the weave of each region, and hand
/// corrections over them. Changing a region's weave keeps outlines and corrections.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Regions {
    map: Grid<u16>,
    palette: Arc<Vec<Region>>,
    corrections: Option<Corrections>,
    source: Option<Arc<SourceImage>>,
}

impl Regions {
    /// Artwork from the region number of every crossing and the regions.
    ///
    /// # Errors
    /// [`StructureError`] if a crossing names a region that does not exist, or the
    /// corrections have another size.
    pub fn new(
        map: Grid<u16>,
        palette: Vec<Region>,
        corrections: Option<Corrections>,
    ) -> Result<Self, StructureError> {
        let regions = palette.len();
        if let Some(region) = map.max()
            && usize::from(region) >= regions
        {
            return Err(StructureError::Region { region, regions });
        }
        if let Some(corrections) = &corrections
            && (corrections.mask.ends(), corrections.mask.picks()) != (map.ends(), map.picks())
        {
            return Err(StructureError::Corrections);
        }
        Ok(Self {
            map,
            palette: Arc::new(palette),
            corrections,
            source: None,
        })
    }

    /// The same artwork with the picture it was made of.
    pub fn with_source(mut self, source: Option<Arc<SourceImage>>) -> Self {
        self.source = source;
        self
    }

    /// The same artwork with other hand corrections.
    ///
    /// # Errors
    /// [`StructureError::Corrections`] if they have another size.
    pub fn with_corrections(
        self,
        corrections: Option<Corrections>,
    ) -> Result<Self, StructureError> {
        let palette = Arc::unwrap_or_clone(self.palette);
        Ok(Self::new(self.map, palette, corrections)?.with_source(self.source))
    }

    /// The picture the artwork was made of, if it was.
    pub fn source(&self) -> Option<&Arc<SourceImage>> {
        self.source.as_ref()
    }

    /// The region of every crossing.
    pub fn map(&self) -> &Grid<u16> {
        &self.map
    }

    /// The regions.
    pub fn palette(&self) -> &[Region] {
        &self.palette
    }

    /// The hand corrections, if any.
    pub fn corrections(&self) -> Option<&Corrections> {
        self.corrections.as_ref()
    }

    /// Gives a region another weave; outlines and corrections stay. False if there is no
    /// such region.
    pub fn set_fill(&mut self, region: u16, fill: Fill) -> bool {
        match Arc::make_mut(&mut self.palette).get_mut(usize::from(region)) {
            Some(entry) => {
                entry.fill = fill;
                true
            }
            None => false,
        }
    }

    /// Fixes a region's weave, or frees it. False if there is no such region.
    pub fn set_locked(&mut self, region: u16, locked: bool) -> bool {
        match Arc::make_mut(&mut self.palette).get_mut(usize::from(region)) {
            Some(entry) => {
                entry.locked = locked;
                true
            }
            None => false,
        }
    }

    /// Which yarn lies where: `usual`, and over it the yarns of the regions that have
    /// their own. Without any of those it is `usual` itself, so a loom can weave it.
    ///
    /// # Errors
    /// [`SizeError`], which no artwork that exists should cause.
    pub fn yarn_maps(&self, usual: &YarnMaps) -> Result<YarnMaps, SizeError> {
        if self.palette.iter().all(|region| region.yarns.is_none()) {
            return Ok(usual.clone());
        }
        let (ends, picks) = (self.map.ends(), self.map.picks());
        let own = |end, pick| self.palette[usize::from(self.map.get(end, pick))].yarns;
        let warp = Grid::from_fn(ends, picks, |end, pick| match own(end, pick) {
            Some(yarns) => yarns.warp,
            None => usual.warp(i64::from(end), i64::from(pick)),
        })?;
        let weft = Grid::from_fn(ends, picks, |end, pick| match own(end, pick) {
            Some(yarns) => yarns.weft,
            None => usual.weft(i64::from(end), i64::from(pick)),
        })?;
        Ok(YarnMaps {
            warp: YarnMap::Crossings(warp),
            weft: YarnMap::Crossings(weft),
        })
    }

    /// The drawdown.
    pub fn weave(&self) -> WeavePattern {
        let mut pattern = WeavePattern::new(self.map.ends(), self.map.picks());
        for pick in 0..pattern.picks() {
            for word in 0..pattern.words_per_pick() {
                pattern.set_pick_word(word, pick, self.weave_word(word, pick));
            }
        }
        pattern
    }

    /// What ends 64·`word` … 64·`word`+63 weave along a pick, corrections included; bit 0 =
    /// the leftmost.
    pub fn weave_word(&self, word: u32, pick: u32) -> u64 {
        let mut bits = 0;
        let mut cursor: Option<(u16, Cursor<'_>)> = None;
        for (place, &number) in self.map.pick_values(word, pick).iter().enumerate() {
            let along = match &mut cursor {
                Some((known, along)) if *known == number => along,
                other => {
                    let region = &self.palette[usize::from(number)];
                    let along = Cursor::new(region, 64 * word + place as u32, pick);
                    &mut other.insert((number, along)).1
                }
            };
            bits |= u64::from(along.step()) << place;
        }
        match &self.corrections {
            Some(corrections) => {
                let mask = corrections.mask.pick_word(word, pick);
                bits & !mask | corrections.value.pick_word(word, pick) & mask
            }
            None => bits,
        }
    }

    fn bytes_beyond(&self, other: Option<&Self>) -> usize {
        let map = self.map.bytes_beyond(other.map(|other| &other.map));
        let palette = match other {
            Some(other) if Arc::ptr_eq(&self.palette, &other.palette) => 0,
            _ => self
                .palette
                .iter()
                .map(|region| {
                    size_of::<Region>() + region.name.len() + region.fill.pattern.bytes_beyond(None)
                })
                .sum(),
        };
        let corrections = self.corrections.as_ref().map_or(0, |mine| {
            let before = other.and_then(|other| other.corrections.as_ref());
            mine.mask.bytes_beyond(before.map(|before| &before.mask))
                + mine.value.bytes_beyond(before.map(|before| &before.value))
        });
        let source = match (&self.source, other.and_then(|other| other.source.as_ref())) {
            (Some(mine), Some(other)) if Arc::ptr_eq(mine, other) => 0,
            (Some(mine), _) => 3 * mine.pixels().len(),
            (None, _) => 0,
        };
        map + palette + corrections + source
    }

    /// The parts that an edit changes in place; it keeps the sizes and names only regions
    /// that are there.
    pub(crate) fn parts_mut(
        &mut self,
    ) -> (&mut Grid<u16>, &mut Vec<Region>, &mut Option<Corrections>) {
        (
            &mut self.map,
            Arc::make_mut(&mut self.palette),
            &mut self.corrections,
        )
    }
}

/// Walks along a pick of a region's weave, from left to right, without dividing.
struct Cursor<'r> {
    pattern: &'r WeavePattern,
    end: u32,
    pick: u32,
}

impl<'r> Cursor<'r> {
    fn new(region: &'r Region, end: u32, pick: u32) -> Self {
        let pattern = &region.fill.pattern;
        let wrap = |place: u32, origin: i32, period: u32| {
            (i64::from(place) - i64::from(origin)).rem_euclid(i64::from(period)) as u32
        };
        Self {
            pattern,
            end: wrap(end, region.origin.0, pattern.ends()),
            pick: wrap(pick, region.origin.1, pattern.picks()),
        }
    }

    fn step(&mut self) -> bool {
        let up = self.pattern.get(self.end, self.pick);
        self.end += 1;
        if self.end == self.pattern.ends() {
            self.end = 0;
        }
        up
    }
}

/// A weave repeated over a panel.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Filled {
    fill: Fill,
    ends: u32,
    picks: u32,
}

impl Filled {
    /// `fill` repeated over `ends` × `picks`, starting at crossing (0, 0).
    ///
    /// # Errors
    /// [`SizeError`] for an empty or too large panel.
    pub fn new(fill: Fill, ends: u32, picks: u32) -> Result<Self, SizeError> {
        check_size(u64::from(ends), u64::from(picks))?;
        Ok(Self { fill, ends, picks })
    }

    /// One repeat of a notation's weave.
    ///
    /// # Errors
    /// [`NotationError`], see [`super::weave`].
    pub fn once(notation: &str) -> Result<Self, NotationError> {
        let fill = Fill::by_notation(notation)?;
        let (ends, picks) = (fill.pattern.ends(), fill.pattern.picks());
        Ok(Self { fill, ends, picks })
    }

    /// The weave.
    pub fn fill(&self) -> &Fill {
        &self.fill
    }

    /// Ends and picks of the panel.
    pub fn size(&self) -> (u32, u32) {
        (self.ends, self.picks)
    }
}

/// Regions that do not fit together.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum StructureError {
    /// A crossing names a region that is not there.
    #[error("a crossing names region {region}, but the palette has {regions}: add it")]
    Region {
        /// The region number, from 0.
        region: u16,
        /// Regions there are.
        regions: usize,
    },
    /// Corrections of another size.
    #[error("the corrections have another size than the design: draw them on the same grid")]
    Corrections,
}

/// Where a design's weave comes from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Structure {
    /// A drawdown, crossing by crossing.
    Pattern(WeavePattern),
    /// A shaft draft.
    Draft(Draft),
    /// A weave repeated over a panel.
    Weave(Filled),
    /// Regions of weaves.
    Regions(Regions),
}

impl Structure {
    /// Ends and picks of the design.
    pub fn size(&self) -> (u32, u32) {
        match self {
            Self::Pattern(pattern) => (pattern.ends(), pattern.picks()),
            Self::Draft(draft) => (draft.ends(), draft.picks()),
            Self::Weave(filled) => filled.size(),
            Self::Regions(regions) => (regions.map.ends(), regions.map.picks()),
        }
    }

    /// Bytes of memory that this weave does not share with `other`.
    pub(super) fn bytes_beyond(&self, other: Option<&Self>) -> usize {
        match (self, other) {
            (Self::Pattern(pattern), Some(Self::Pattern(other))) => {
                pattern.bytes_beyond(Some(other))
            }
            (Self::Pattern(pattern), _) => pattern.bytes_beyond(None),
            (Self::Draft(draft), _) => draft.bytes(),
            (Self::Weave(filled), _) => filled.fill.pattern.bytes_beyond(None),
            (Self::Regions(regions), Some(Self::Regions(other))) => {
                regions.bytes_beyond(Some(other))
            }
            (Self::Regions(regions), _) => regions.bytes_beyond(None),
        }
    }

    /// The drawdown.
    pub fn weave(&self) -> WeavePattern {
        match self {
            Self::Pattern(pattern) => pattern.clone(),
            Self::Draft(draft) => draft.drawdown(),
            Self::Weave(filled) => {
                let (ends, picks) = filled.size();
                filled.fill.pattern.repeated(ends, picks, (0, 0))
            }
            Self::Regions(regions) => regions.weave(),
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;

    fn artwork() -> Regions {
        let map = Grid::from_fn(8, 4, |end, _| u16::from(end >= 4)).unwrap();
        let region = |name: &str, notation| Region::new(name, Fill::by_notation(notation).unwrap());
        let palette = vec![region("ground", "plain"), region("figure", "2/2 twill")];
        let mut mask = WeavePattern::new(8, 4);
        mask.set(0, 0, true);
        let corrections = Corrections::new(mask.clone(), WeavePattern::new(8, 4)).unwrap();
        Regions::new(map, palette, Some(corrections)).unwrap()
    }

    #[test]
    fn regions_weave_their_fills_and_corrections_stay() {
        let mut regions = artwork();
        let expected = ".#.#..##\n#.#..##.\n.#.###..\n..#.#..#\n";
        assert_eq!(regions.weave().to_string(), expected);
        assert!(regions.set_fill(0, Fill::by_notation("2/2 basket").unwrap()));
        assert!(!regions.weave().get(0, 0), "the correction stands");
        assert!(regions.weave().get(1, 0), "the new weave shows");
        assert!(!regions.set_fill(7, Fill::by_notation("plain").unwrap()));
    }

    #[test]
    fn yarns_of_a_region_lie_there_and_nowhere_else() {
        let mut regions = artwork();
        let usual = YarnMaps::plain(YarnId(0), YarnId(1));
        assert_eq!(regions.yarn_maps(&usual).unwrap(), usual);
        let (warp, weft) = (YarnId(2), YarnId(3));
        Arc::make_mut(&mut regions.palette)[1].yarns = Some(RegionYarns { warp, weft });
        let maps = regions.yarn_maps(&usual).unwrap();
        assert!(!maps.weavable());
        assert_eq!((maps.warp(3, 1), maps.weft(3, 1)), (YarnId(0), YarnId(1)));
        assert_eq!((maps.warp(4, 1), maps.weft(4, 1)), (warp, weft));
    }

    #[test]
    fn a_region_that_is_missing_is_named() {
        let map = Grid::filled(4, 4, 3).unwrap();
        let message = Regions::new(map, Vec::new(), None).unwrap_err().to_string();
        assert!(message.contains("names region 3"), "{message}");
    }
}
