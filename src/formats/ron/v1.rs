//! Version 1 of the design document.
//!
//! These types are what a file says and nothing else: they never change once released,
//! while the design's own types may.

use std::fmt;
use std::marker::PhantomData;
use std::sync::Arc;

use serde::de::{Error as _, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};

use super::Fault;
use super::image::{read_map, read_pattern, read_picture, write_map, write_pattern, write_picture};
use crate::design::{
    Colourway, Corrections, Density, Design, Draft, Family, Fill, Filled, FirstEnd, FirstPick,
    ForeignSection, Grid, Lattice, Lifting, MAX_COLOURWAYS, MAX_CROSSINGS, Origin, Region,
    RegionYarns, Regions, Repeat, Sett, Shed, Srgb, StatedThreads, Structure, Ties, WeavePattern,
    Yarn, YarnId, YarnMap, YarnMaps, check_size,
};

/// Unknown fields that are named one by one.
pub(super) const MOST_UNKNOWN: usize = 8;

#[derive(Serialize, Deserialize)]
pub(super) struct Document {
    pickglass: u32,
    design: DesignV1,
}

#[derive(Serialize, Deserialize)]
struct DesignV1 {
    name: String,
    #[serde(default, skip_serializing_if = "String::is_empty")]
    notes: String,
    ends: u32,
    picks: u32,
    structure: StructureV1,
    yarns: Limited<YarnV1, MAX_YARNS>,
    warp: MapV1,
    weft: MapV1,
    sett: SettV1,
    #[serde(default)]
    across: RepeatV1,
    #[serde(default)]
    along: RepeatV1,
    #[serde(default, skip_serializing_if = "Limited::is_empty")]
    colourways: Limited<ColourwayV1, MAX_COLOURWAYS>,
    #[serde(default, skip_serializing_if = "String::is_empty")]
    colourway: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    origin: Option<OriginV1>,
}

#[derive(Serialize, Deserialize)]
struct ColourwayV1 {
    name: String,
    yarns: Limited<YarnV1, MAX_YARNS>,
}

/// A PNG in base64.
type Image = String;

#[derive(Serialize, Deserialize)]
enum StructureV1 {
    Pattern(Image),
    Weave(FillV1),
    Draft(DraftV1),
    Regions(RegionsV1),
}

#[derive(Serialize, Deserialize)]
enum FillV1 {
    Notation(String),
    Drawn { ends: u32, picks: u32, image: Image },
}

/// Sets of shafts or treadles counted from 1: `1 2 3,4 -` (`-` = none).
type Sets = String;

#[derive(Serialize, Deserialize)]
struct DraftV1 {
    shafts: u32,
    treadles: u32,
    rising: bool,
    threading: Sets,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    tieup: Option<Sets>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    treadling: Option<Sets>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    liftplan: Option<Sets>,
}

#[derive(Serialize, Deserialize)]
struct RegionsV1 {
    map: Image,
    palette: Limited<RegionV1, MAX_REGIONS>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    corrections: Option<CorrectionsV1>,
    /// The picture it was made of.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    source: Option<Image>,
}

#[derive(Serialize, Deserialize)]
struct RegionV1 {
    name: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    colour: Option<String>,
    fill: FillV1,
    #[serde(default)]
    origin: (i32, i32),
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    locked: bool,
    /// Warp and weft yarn, from 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    yarns: Option<(u16, u16)>,
}

#[derive(Serialize, Deserialize)]
struct CorrectionsV1 {
    mask: Image,
    value: Image,
}

#[derive(Serialize, Deserialize)]
struct YarnV1 {
    name: String,
    colour: String,
    family: String,
    surface_share: f32,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    gloss: Option<f32>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    diameter_mm: Option<f32>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    tex: Option<f32>,
}

#[derive(Serialize, Deserialize)]
enum MapV1 {
    /// Yarn numbers from 0, `0*20 1*8`.
    Order(String),
    Crossings(Image),
}

#[derive(Serialize, Deserialize)]
struct SettV1 {
    ends_per_cm: f32,
    picks_per_cm: f32,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    end_pitches_mm: Option<Limited<f32, MAX_ORDER>>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pick_pitches_mm: Option<Limited<f32, MAX_ORDER>>,
    #[serde(default)]
    assumed: bool,
}

#[derive(Serialize, Deserialize, Default)]
enum RepeatV1 {
    #[default]
    Straight,
    Dropped(u32),
    Once,
}

#[derive(Serialize, Deserialize, Default)]
#[serde(default)]
struct OriginV1 {
    #[serde(skip_serializing_if = "Option::is_none")]
    program: Option<String>,
    first_end_right: bool,
    first_pick_top: bool,
    #[serde(skip_serializing_if = "Option::is_none")]
    ends: Option<StatedV1>,
    #[serde(skip_serializing_if = "Option::is_none")]
    picks: Option<StatedV1>,
    /// Colours separated by blanks.
    palette: String,
    sections: Limited<SectionV1, MAX_SECTIONS>,
}

#[derive(Serialize, Deserialize)]
struct StatedV1 {
    unit: String,
    #[serde(default)]
    spacing: Option<f32>,
    #[serde(default)]
    thickness: Option<f32>,
    #[serde(default)]
    spacings: Limited<(u32, f32), MAX_ORDER>,
    #[serde(default)]
    thicknesses: Limited<(u32, f32), MAX_ORDER>,
}

#[derive(Serialize, Deserialize)]
struct SectionV1 {
    name: String,
    text: String,
}

/// The most yarns that can be numbered.
const MAX_YARNS: usize = crate::limits::YARNS;
/// The most regions that can be numbered.
const MAX_REGIONS: usize = 1 << 16;
/// More sections than any program writes.
const MAX_SECTIONS: usize = 4096;
/// The longest yarn order or list of pitches a file may have.
const MAX_ORDER: usize = 1 << 20;

/// A list that is refused, while it is read, beyond `MOST` items.
#[derive(Serialize)]
#[serde(transparent)]
struct Limited<T, const MOST: usize>(Vec<T>);

impl<T, const MOST: usize> Limited<T, MOST> {
    fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

impl<T, const MOST: usize> Default for Limited<T, MOST> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

impl<'de, T: Deserialize<'de>, const MOST: usize> Deserialize<'de> for Limited<T, MOST> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Items<T, const MOST: usize>(PhantomData<T>);
        impl<'de, T: Deserialize<'de>, const MOST: usize> Visitor<'de> for Items<T, MOST> {
            type Value = Vec<T>;

            fn expecting(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
                write!(out, "a list of at most {MOST}")
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<Vec<T>, A::Error> {
                let mut list = Vec::new();
                while let Some(item) = items.next_element()? {
                    if list.len() >= MOST {
                        return Err(A::Error::invalid_length(MOST + 1, &self));
                    }
                    list.push(item);
                }
                Ok(list)
            }
        }
        deserializer
            .deserialize_seq(Items::<T, MOST>(PhantomData))
            .map(Self)
    }
}

/// The document, and the names of fields that it has and this version does not know.
pub(super) fn parse(text: &str) -> Result<(Document, Vec<String>), ::ron::error::SpannedError> {
    let options = ::ron::Options::default().with_recursion_limit(32);
    let mut reader = ::ron::Deserializer::from_str_with_options(text, &options)?;
    let mut unknown = Vec::new();
    let read = serde_ignored::deserialize(&mut reader, |field| {
        if unknown.len() <= MOST_UNKNOWN {
            unknown.push(field.to_string());
        }
    });
    let document = read.map_err(|error| reader.span_error(error))?;
    (reader.end()).map_err(|error| reader.span_error(error))?;
    Ok((document, unknown))
}

pub(super) fn print(document: &Document) -> Result<String, String> {
    let style = ::ron::ser::PrettyConfig::new()
        .compact_arrays(false)
        .depth_limit(5);
    let text = ::ron::Options::default()
        .to_string_pretty(document, style)
        .map_err(|error| error.to_string())?;
    Ok(text + "\n")
}

// Reading.

pub(super) fn to_design(document: Document) -> Result<Design, Fault> {
    let file = document.design;
    let (ends, picks) = (file.ends, file.picks);
    check_size(u64::from(ends), u64::from(picks)).map_err(|error| Fault::new("size", error))?;
    let structure = structure(file.structure, ends, picks)?;
    if structure.size() != (ends, picks) {
        let (found, lifts) = structure.size();
        let problem = format!("{ends} × {picks} are declared, the weave has {found} × {lifts}");
        return Err(Fault::new("size", problem));
    }
    let yarns = yarns(file.yarns)?;
    let mut colourways = Vec::new();
    for ColourwayV1 { name, yarns: found } in file.colourways.0 {
        let yarns = self::yarns(found)?;
        colourways.push(Colourway { name, yarns });
    }
    let maps = YarnMaps {
        warp: map("warp", file.warp, ends, picks)?,
        weft: map("weft", file.weft, ends, picks)?,
    };
    let density = |per_cm, pitches: Option<Limited<f32, MAX_ORDER>>| Density {
        per_cm,
        pitches_mm: pitches.map(|list| list.0),
    };
    let sett = Sett {
        ends: density(file.sett.ends_per_cm, file.sett.end_pitches_mm),
        picks: density(file.sett.picks_per_cm, file.sett.pick_pitches_mm),
        assumed: file.sett.assumed,
    };
    let lattice = Lattice {
        across: repeat(file.across),
        along: repeat(file.along),
    };
    let mut design = Design::new(file.name, structure, yarns, maps, sett)?
        .with_lattice(lattice)?
        .with_colourways(colourways)?;
    design.notes = file.notes;
    design.colourway = file.colourway;
    if let Some(found) = file.origin {
        design.origin = Arc::new(origin(found)?);
    }
    Ok(design)
}

fn repeat(found: RepeatV1) -> Repeat {
    match found {
        RepeatV1::Straight => Repeat::Straight,
        RepeatV1::Dropped(by) => Repeat::Dropped(by),
        RepeatV1::Once => Repeat::None,
    }
}

fn structure(found: StructureV1, ends: u32, picks: u32) -> Result<Structure, Fault> {
    let pattern = |place, image: &str| {
        read_pattern(image, ends, picks).map_err(|problem| Fault::new(place, problem))
    };
    Ok(match found {
        StructureV1::Pattern(image) => Structure::Pattern(pattern("weave", &image)?),
        StructureV1::Weave(found) => {
            let filled = Filled::new(fill("weave", found)?, ends, picks);
            Structure::Weave(filled.map_err(|error| Fault::new("weave", error))?)
        }
        StructureV1::Draft(found) => Structure::Draft(draft(found, ends, picks)?),
        StructureV1::Regions(found) => {
            let map = read_map(&found.map, ends, picks);
            let map = map.map_err(|problem| Fault::new("regions", problem))?;
            let mut palette = Vec::new();
            for region in found.palette.0 {
                palette.push(Region {
                    name: region.name,
                    colour: match region.colour {
                        None => None,
                        Some(text) => Some(colour("region", &text)?),
                    },
                    fill: fill("region", region.fill)?,
                    origin: region.origin,
                    locked: region.locked,
                    yarns: region.yarns.map(|(warp, weft)| RegionYarns {
                        warp: YarnId(warp),
                        weft: YarnId(weft),
                    }),
                });
            }
            let corrections = match found.corrections {
                None => None,
                Some(found) => {
                    let mask = pattern("corrections", &found.mask)?;
                    let value = pattern("corrections", &found.value)?;
                    let both = Corrections::new(mask, value);
                    Some(both.map_err(|error| Fault::new("corrections", error))?)
                }
            };
            let source = match found.source {
                None => None,
                Some(image) => {
                    let read = read_picture(&image);
                    Some(Arc::new(read.map_err(|fault| Fault::new("source", fault))?))
                }
            };
            let regions = Regions::new(map, palette, corrections);
            let regions = regions.map_err(|error| Fault::new("regions", error))?;
            Structure::Regions(regions.with_source(source))
        }
    })
}

fn fill(place: &'static str, found: FillV1) -> Result<Fill, Fault> {
    match found {
        FillV1::Notation(notation) => {
            Fill::by_notation(&notation).map_err(|error| Fault::new(place, error))
        }
        FillV1::Drawn { ends, picks, image } => read_pattern(&image, ends, picks)
            .map(Fill::drawn)
            .map_err(|problem| Fault::new(place, problem)),
    }
}

/// Reads sets; as many as `count` unless that is `None`.
fn sets(place: &'static str, text: &str, count: Option<u32>) -> Result<Ties, Fault> {
    let ties = Ties::parse(text).map_err(|problem| Fault::new(place, problem))?;
    match count {
        Some(count) if ties.len() != count as usize => {
            let problem = format!("expected {count} entries, found {}", ties.len());
            Err(Fault::new(place, problem))
        }
        _ => Ok(ties),
    }
}

fn draft(found: DraftV1, ends: u32, picks: u32) -> Result<Draft, Fault> {
    let threading = sets("threading", &found.threading, Some(ends))?;
    let lifting = match (found.tieup, found.treadling, found.liftplan) {
        (Some(tieup), Some(treadling), None) => Lifting::Treadled {
            tieup: sets("tie-up", &tieup, None)?,
            treadling: sets("treadling", &treadling, Some(picks))?,
        },
        (None, None, Some(plan)) => Lifting::LiftPlan(sets("lift plan", &plan, Some(picks))?),
        _ => {
            let problem = "expected either tieup and treadling, or liftplan";
            return Err(Fault::new("draft", problem));
        }
    };
    let shed = if found.rising {
        Shed::Rising
    } else {
        Shed::Sinking
    };
    Draft::new(found.shafts, found.treadles, shed, threading, lifting)
        .map_err(|error| Fault::new("draft", error))
}

fn colour(place: &'static str, text: &str) -> Result<Srgb, Fault> {
    text.parse().map_err(|error| Fault::new(place, error))
}

fn yarns(found: Limited<YarnV1, MAX_YARNS>) -> Result<Vec<Yarn>, Fault> {
    found.0.into_iter().map(yarn).collect()
}

fn yarn(found: YarnV1) -> Result<Yarn, Fault> {
    let family: Result<Family, _> = found.family.parse();
    Ok(Yarn {
        colour: colour("yarn", &found.colour)?,
        family: family.map_err(|error| Fault::new("yarn", error))?,
        name: found.name,
        surface_share: found.surface_share,
        gloss: found.gloss,
        diameter_mm: found.diameter_mm,
        tex: found.tex,
    })
}

fn map(place: &'static str, found: MapV1, ends: u32, picks: u32) -> Result<YarnMap, Fault> {
    match found {
        MapV1::Order(text) => Ok(YarnMap::Order(order(place, &text)?)),
        MapV1::Crossings(image) => {
            let numbers =
                read_map(&image, ends, picks).map_err(|problem| Fault::new(place, problem))?;
            let ids = Grid::from_fn(ends, picks, |end, pick| YarnId(numbers.get(end, pick)));
            let ids = ids.map_err(|error| Fault::new(place, error))?;
            Ok(YarnMap::Crossings(ids))
        }
    }
}

fn order(place: &'static str, text: &str) -> Result<Vec<YarnId>, Fault> {
    let mut order = Vec::new();
    for word in text.split_whitespace() {
        let (yarn, count) = word.split_once('*').unwrap_or((word, "1"));
        let (Ok(yarn), Ok(count)) = (yarn.parse::<u16>(), count.parse::<usize>()) else {
            let word: String = word.chars().take(40).collect();
            let problem = format!("expected yarn*count, for instance 0*20, found \"{word}\"");
            return Err(Fault::new(place, problem));
        };
        if count > MAX_ORDER - order.len() {
            let problem = format!("expected an order of at most {MAX_ORDER} threads");
            return Err(Fault::new(place, problem));
        }
        order.extend(std::iter::repeat_n(YarnId(yarn), count));
    }
    Ok(order)
}

fn origin(found: OriginV1) -> Result<Origin, Fault> {
    Ok(Origin {
        program: found.program,
        first_end: if found.first_end_right {
            FirstEnd::Right
        } else {
            FirstEnd::Left
        },
        first_pick: if found.first_pick_top {
            FirstPick::Top
        } else {
            FirstPick::Bottom
        },
        sections: found
            .sections
            .0
            .into_iter()
            .map(|SectionV1 { name, text }| ForeignSection { name, text })
            .collect(),
        ends: found.ends.map(stated).transpose()?,
        picks: found.picks.map(stated).transpose()?,
        palette: found
            .palette
            .split_whitespace()
            .map(|text| colour("palette", text))
            .collect::<Result<_, _>>()?,
    })
}

fn stated(found: StatedV1) -> Result<StatedThreads, Fault> {
    let usual = [found.spacing, found.thickness].into_iter().flatten();
    let single = found.spacings.0.iter().chain(&found.thicknesses.0);
    let mut lengths = usual.chain(single.clone().map(|&(_, length)| length));
    if !lengths.all(|length| length.is_finite() && length > 0.0) {
        return Err(Fault::new("origin", "expected spacings above 0"));
    }
    if single
        .into_iter()
        .any(|&(thread, _)| u64::from(thread) >= MAX_CROSSINGS)
    {
        return Err(Fault::new("origin", "expected threads of the design"));
    }
    Ok(StatedThreads {
        unit: found.unit,
        spacing: found.spacing,
        thickness: found.thickness,
        spacings: found.spacings.0,
        thicknesses: found.thicknesses.0,
    })
}

// Writing.

pub(super) fn of_design(design: &Design) -> Result<Document, String> {
    let lattice = design.lattice();
    let sett = design.sett();
    let file = DesignV1 {
        name: design.name.clone(),
        notes: design.notes.clone(),
        ends: design.ends(),
        picks: design.picks(),
        structure: of_structure(design.structure())?,
        yarns: of_yarns(design.yarns()),
        warp: of_map(&design.maps().warp)?,
        weft: of_map(&design.maps().weft)?,
        sett: SettV1 {
            ends_per_cm: sett.ends.per_cm,
            picks_per_cm: sett.picks.per_cm,
            end_pitches_mm: sett.ends.pitches_mm.clone().map(Limited),
            pick_pitches_mm: sett.picks.pitches_mm.clone().map(Limited),
            assumed: sett.assumed,
        },
        across: of_repeat(lattice.across),
        along: of_repeat(lattice.along),
        colourway: design.colourway.clone(),
        colourways: Limited(
            design
                .colourways()
                .iter()
                .map(|colourway| ColourwayV1 {
                    name: colourway.name.clone(),
                    yarns: of_yarns(&colourway.yarns),
                })
                .collect(),
        ),
        origin: (*design.origin != Origin::default()).then(|| of_origin(&design.origin)),
    };
    Ok(Document {
        pickglass: 1,
        design: file,
    })
}

fn of_repeat(repeat: Repeat) -> RepeatV1 {
    match repeat {
        Repeat::Straight => RepeatV1::Straight,
        Repeat::Dropped(by) => RepeatV1::Dropped(by),
        Repeat::None => RepeatV1::Once,
    }
}

fn of_structure(structure: &Structure) -> Result<StructureV1, String> {
    Ok(match structure {
        Structure::Pattern(pattern) => StructureV1::Pattern(write_pattern(pattern)?),
        Structure::Weave(filled) => StructureV1::Weave(of_fill(filled.fill())?),
        Structure::Draft(draft) => StructureV1::Draft(of_draft(draft)),
        Structure::Regions(regions) => StructureV1::Regions(RegionsV1 {
            map: write_map(regions.map())?,
            palette: regions
                .palette()
                .iter()
                .map(|region| {
                    Ok(RegionV1 {
                        name: region.name.clone(),
                        colour: region.colour.as_ref().map(Srgb::to_string),
                        fill: of_fill(&region.fill)?,
                        origin: region.origin,
                        locked: region.locked,
                        yarns: region.yarns.map(|yarns| (yarns.warp.0, yarns.weft.0)),
                    })
                })
                .collect::<Result<_, String>>()
                .map(Limited)?,
            corrections: match regions.corrections() {
                None => None,
                Some(found) => Some(CorrectionsV1 {
                    mask: write_pattern(found.mask())?,
                    value: write_pattern(found.value())?,
                }),
            },
            source: match regions.source() {
                None => None,
                Some(source) => Some(write_picture(source)?),
            },
        }),
    })
}

fn of_fill(fill: &Fill) -> Result<FillV1, String> {
    match fill.notation() {
        Some(notation) => Ok(FillV1::Notation(notation.to_owned())),
        None => drawn(fill.pattern()),
    }
}

fn drawn(pattern: &WeavePattern) -> Result<FillV1, String> {
    Ok(FillV1::Drawn {
        ends: pattern.ends(),
        picks: pattern.picks(),
        image: write_pattern(pattern)?,
    })
}

fn of_sets(ties: &Ties) -> Sets {
    let words: Vec<String> = ties
        .iter()
        .map(|set| match set {
            [] => "-".to_owned(),
            set => {
                let members: Vec<String> = set
                    .iter()
                    .map(|&m| (u32::from(m) + 1).to_string())
                    .collect();
                members.join(",")
            }
        })
        .collect();
    words.join(" ")
}

fn of_draft(draft: &Draft) -> DraftV1 {
    let (tieup, treadling, liftplan) = match draft.lifting() {
        Lifting::Treadled { tieup, treadling } => {
            (Some(of_sets(tieup)), Some(of_sets(treadling)), None)
        }
        Lifting::LiftPlan(plan) => (None, None, Some(of_sets(plan))),
    };
    DraftV1 {
        shafts: draft.shafts(),
        treadles: draft.treadles(),
        rising: draft.shed() == Shed::Rising,
        threading: of_sets(draft.threading()),
        tieup,
        treadling,
        liftplan,
    }
}

fn of_yarns(yarns: &[Yarn]) -> Limited<YarnV1, MAX_YARNS> {
    Limited(yarns.iter().map(of_yarn).collect())
}

fn of_yarn(yarn: &Yarn) -> YarnV1 {
    YarnV1 {
        name: yarn.name.clone(),
        colour: yarn.colour.to_string(),
        family: yarn.family.name().to_owned(),
        surface_share: yarn.surface_share,
        gloss: yarn.gloss,
        diameter_mm: yarn.diameter_mm,
        tex: yarn.tex,
    }
}

fn of_map(map: &YarnMap) -> Result<MapV1, String> {
    match map {
        YarnMap::Order(order) => {
            let mut words = Vec::new();
            for run in order.chunk_by(|a, b| a == b) {
                words.push(match run.len() {
                    1 => run[0].0.to_string(),
                    count => format!("{}*{count}", run[0].0),
                });
            }
            Ok(MapV1::Order(words.join(" ")))
        }
        YarnMap::Crossings(grid) => {
            let numbers =
                Grid::from_fn(grid.ends(), grid.picks(), |end, pick| grid.get(end, pick).0);
            let numbers = numbers.map_err(|error| error.to_string())?;
            Ok(MapV1::Crossings(write_map(&numbers)?))
        }
    }
}

fn of_origin(origin: &Origin) -> OriginV1 {
    let stated = |found: &Option<StatedThreads>| {
        found.as_ref().map(|found| StatedV1 {
            unit: found.unit.clone(),
            spacing: found.spacing,
            thickness: found.thickness,
            spacings: Limited(found.spacings.clone()),
            thicknesses: Limited(found.thicknesses.clone()),
        })
    };
    OriginV1 {
        program: origin.program.clone(),
        first_end_right: origin.first_end == FirstEnd::Right,
        first_pick_top: origin.first_pick == FirstPick::Top,
        ends: stated(&origin.ends),
        picks: stated(&origin.picks),
        palette: origin
            .palette
            .iter()
            .map(Srgb::to_string)
            .collect::<Vec<_>>()
            .join(" "),
        sections: Limited(
            origin
                .sections
                .iter()
                .map(|section| SectionV1 {
                    name: section.name.clone(),
                    text: section.text.clone(),
                })
                .collect(),
        ),
    }
}
