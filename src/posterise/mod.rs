//! A picture becomes regions of weaves: V(x, y) = V_p(I(x,y))(x, y), Zhao 2012 §5.2.
//!
//! A [`SourceImage`] and [`PosteriseSettings`] come in; a [`Posterised`] design goes out,
//! with what each of its colours is expected to show. The picture is resampled to one pixel
//! a crossing (`resample`), reduced to a few colours (`quantise`), cleared of specks
//! (`specks`); the colours get weaves of a shadow series and the cloth a dark warp and a
//! light weft (`series`, `propose`), or keep those of a previous design (`follow`); long
//! floats between regions are bound where asked (`bind`).
//!
//! The module stands above `design`, since a weave is proposed by the colour the cloth is
//! expected to show, which [`crate::cloth::expected`] knows.

mod bind;
mod follow;
mod propose;
mod quantise;
mod resample;
mod series;
mod settings;
mod specks;

use std::sync::Arc;

pub use bind::{Bound, bind_floats};
pub use follow::follow;
pub use resample::{Layout, MAX_PANEL, panel};
pub use series::{DARKEST, LIGHTEST, shadow_weave};
pub use settings::{Fit, MAX_COLOURS, PosteriseSettings};

use crate::cloth::expected::expected_colour;
use crate::design::{
    Corrections, Design, DesignError, Fill, Grid, Region, RegionYarns, Regions, SizeError,
    SourceImage, Srgb, Structure, StructureError, Yarn, YarnId, delta_e_00, lab,
};
use crate::job::{Cancelled, Job};
use crate::memory::{self, TooMuch};
use propose::Yarns;
use quantise::{Reduced, quantise};

/// Why a picture could not become a design.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PosteriseError {
    /// The owner cancelled the work.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// A panel larger than the memory that may be used.
    #[error(transparent)]
    Memory(#[from] TooMuch),
    /// A number of colours that cannot be.
    #[error("{0} colours: give 2 to {MAX_COLOURS}")]
    Colours(u16),
    /// A panel that is empty or too large.
    #[error(transparent)]
    Panel(SizeError),
    /// A panel with more crossings than a picture is worth.
    #[error(
        "{ends} ends × {picks} picks are too many crossings for a picture (the most is \
         {MAX_PANEL}): give fewer"
    )]
    TooLarge {
        /// Ends asked for.
        ends: u32,
        /// Picks asked for.
        picks: u32,
    },
    /// A sett that cannot be woven.
    #[error("{0}")]
    Sett(String),
    /// The picture could not be resampled.
    #[error("the picture cannot be fitted to the panel ({0}): crop it to a usual shape first")]
    Resample(String),
    /// Parts that do not fit, which no right settings should cause.
    #[error(transparent)]
    Structure(#[from] StructureError),
    /// As [`PosteriseError::Structure`].
    #[error(transparent)]
    Design(#[from] DesignError),
}

impl From<SizeError> for PosteriseError {
    fn from(error: SizeError) -> Self {
        Self::Panel(error)
    }
}

/// One colour of a posterised picture.
#[derive(Debug, Clone, PartialEq)]
pub struct RegionColour {
    /// The colour in the picture.
    pub asked: Srgb,
    /// The share of the panel's crossings that have it, 0..=1.
    pub coverage: f64,
    /// The colour its cloth is expected to show.
    pub expected: Srgb,
    /// ΔE₀₀ between the two.
    pub delta_e: f64,
}

/// A picture made into a design.
#[derive(Debug, Clone, PartialEq)]
pub struct Posterised {
    /// The design; its structure is [`Regions`], darkest first, with the source kept.
    pub design: Design,
    /// One entry a region, in the order of the palette.
    pub colours: Vec<RegionColour>,
    /// What was remarked on, one line each.
    pub warnings: Vec<String>,
}

/// Makes a design of a picture. With a previous design of the same picture, its yarns,
/// hand corrections, and the weaves and locks of its nearest colours stay.
///
/// The same input gives the same design, whatever the number of threads.
///
/// # Errors
/// [`PosteriseError`]: settings that cannot be, or the job was cancelled.
pub fn posterise(
    source: &Arc<SourceImage>,
    settings: &PosteriseSettings,
    previous: Option<&Design>,
    job: &Job,
) -> Result<Posterised, PosteriseError> {
    let layout = settings.layout(source.width(), source.height())?;
    let reduced = reduce(source, settings, &layout, job)?;
    job.report("proposing weaves", 0.85);
    let known = previous.and_then(|design| match design.structure() {
        Structure::Regions(regions) => Some(regions),
        _ => None,
    });
    let coverage = reduced.coverage();
    let mut yarns = match previous {
        Some(design) => Yarns::kept(design),
        None => Yarns::proposed(&reduced.palette, &coverage, settings),
    };
    let palette = palette(&reduced.palette, &coverage, settings, known, &mut yarns)?;
    job.check()?;

    // The picture's first row is the cloth's last pick.
    let (ends, picks) = (layout.ends, layout.picks);
    let at = |end: u32, pick: u32| (picks - 1 - pick) as usize * ends as usize + end as usize;
    let map = Grid::from_fn(ends, picks, |end, pick| {
        u16::from(reduced.indices[at(end, pick)])
    })?;
    let mut warnings = Vec::new();
    let corrections = kept_corrections(known, (ends, picks), &mut warnings);
    let mut regions =
        Regions::new(map, palette, corrections)?.with_source(Some(Arc::clone(source)));
    if let Some(longest) = settings.bind {
        job.report("binding floats", 0.9);
        regions = bound(regions, longest, &mut warnings, job)?;
    }
    warnings.extend(uneven(&regions));

    let maps = regions.yarn_maps(&yarns.maps)?;
    let colours = expected(&regions, &coverage, &yarns);
    let structure = Structure::Regions(regions);
    let name = settings.name.clone();
    let mut design = Design::new(name, structure, yarns.all, maps, layout.sett)?;
    if let Some(previous) = previous {
        design.name.clone_from(&previous.name);
        design.notes.clone_from(&previous.notes);
    }
    job.report("done", 1.0);
    Ok(Posterised {
        design,
        colours,
        warnings,
    })
}

/// Bytes a crossing while colours are reduced: the picture resampled in linear light and in
/// sRGB, and where it is dithered.
const CROSSING_BYTES: u64 = 20;

/// The picture at the panel's size in a few colours, without specks.
fn reduce(
    source: &SourceImage,
    settings: &PosteriseSettings,
    layout: &Layout,
    job: &Job,
) -> Result<Reduced, PosteriseError> {
    let crossings = u64::from(layout.ends) * u64::from(layout.picks);
    memory::ask(crossings.saturating_mul(CROSSING_BYTES), || {
        format!("a picture in {} × {} crossings", layout.ends, layout.picks)
    })?;
    job.report("resampling", 0.0);
    let pixels = panel(source, layout, job)?;
    job.report("reducing colours", 0.3);
    let (ends, colours) = (layout.ends, settings.colours);
    let mut reduced = quantise(&pixels, ends, colours, settings.dither, job)?;
    job.report("merging specks", 0.7);
    specks::merge(&mut reduced.indices, ends as usize, settings.speck, job)?;
    reduced.drop_unused();
    Ok(reduced)
}

/// A region for every colour: kept, or with a proposed weave.
fn palette(
    asked: &[Srgb],
    coverage: &[f64],
    settings: &PosteriseSettings,
    known: Option<&Regions>,
    yarns: &mut Yarns,
) -> Result<Vec<Region>, DesignError> {
    let kept = known.map_or_else(
        || vec![None; asked.len()],
        |regions| follow(asked, regions.palette()),
    );
    let weaves = propose::weaves(asked, coverage, &kept, &yarns.pair);
    let mut palette = Vec::with_capacity(asked.len());
    for ((&colour, weave), kept) in asked.iter().zip(weaves).zip(&kept) {
        let before = kept.and_then(|at| known?.palette().get(at));
        let mut region = region(colour, weave, before);
        if settings.preview_only {
            region.yarns = Some(own_yarns(&region.name, colour, yarns)?);
        }
        palette.push(region);
    }
    Ok(palette)
}

/// The hand corrections of a previous design of the same size.
fn kept_corrections(
    known: Option<&Regions>,
    size: (u32, u32),
    warnings: &mut Vec<String>,
) -> Option<Corrections> {
    let found = known?.corrections()?;
    if (found.mask().ends(), found.mask().picks()) == size {
        return Some(found.clone());
    }
    warnings.push("the hand corrections were drawn on another size and are left out".to_owned());
    None
}

/// Regions whose floats across each other are bound.
fn bound(
    regions: Regions,
    longest: u32,
    warnings: &mut Vec<String>,
    job: &Job,
) -> Result<Regions, PosteriseError> {
    let bound = bind_floats(&regions, longest, job)?;
    if bound.left > 0 {
        warnings.push(format!(
            "{} floats over {longest} crossings between regions could not be bound: choose \
             weaves with shorter floats",
            bound.left
        ));
    }
    Ok(regions.with_corrections(bound.corrections)?)
}

/// The region of a colour: the one it takes over from, or a new one with `weave`.
fn region(colour: Srgb, weave: Fill, before: Option<&Region>) -> Region {
    let mut region = match before {
        Some(before) => before.clone(),
        None => Region::new(colour.to_string(), weave),
    };
    // A name that only says the colour goes with it.
    if region
        .colour
        .is_some_and(|old| region.name == old.to_string())
    {
        region.name = colour.to_string();
    }
    region.colour = Some(colour);
    region.yarns = None;
    region
}

/// Adds two yarns in a region's colour: any weave of them shows it.
fn own_yarns(name: &str, colour: Srgb, yarns: &mut Yarns) -> Result<RegionYarns, DesignError> {
    let next = yarns.all.len();
    let id = |at: usize| u16::try_from(at).map(YarnId);
    let (Ok(warp), Ok(weft)) = (id(next), id(next + 1)) else {
        return Err(DesignError::TooManyYarns(next + 2));
    };
    for (what, like) in [("warp", &yarns.pair.warp), ("weft", &yarns.pair.weft)] {
        yarns.all.push(Yarn {
            name: format!("{name} {what}"),
            colour,
            ..like.clone()
        });
    }
    Ok(RegionYarns { warp, weft })
}

/// What every region is expected to show.
fn expected(regions: &Regions, coverage: &[f64], yarns: &Yarns) -> Vec<RegionColour> {
    let yarn = |id: YarnId| &yarns.all[usize::from(id.0)];
    (regions.palette().iter().zip(coverage))
        .map(|(region, &coverage)| {
            let (warp, weft) = match region.yarns {
                Some(own) => (yarn(own.warp), yarn(own.weft)),
                None => (&yarns.pair.warp, &yarns.pair.weft),
            };
            let shown = expected_colour(region.fill.pattern(), warp, weft);
            let asked = region.colour.unwrap_or(Srgb(0, 0, 0));
            RegionColour {
                asked,
                coverage,
                expected: Srgb::from_linear(shown),
                delta_e: delta_e_00(lab(asked.to_linear()), lab(shown)),
            }
        })
        .collect()
}

/// Says where a panel is no multiple of its weaves' repeats, and which size would be.
fn uneven(regions: &Regions) -> Vec<String> {
    let lcm = |a: u64, b: u64| {
        let (mut x, mut y) = (a, b);
        while y != 0 {
            (x, y) = (y, x % y);
        }
        (a / x).saturating_mul(b)
    };
    let fills = || regions.palette().iter().map(|region| region.fill.pattern());
    let across = fills().fold(1, |all, fill| lcm(all, u64::from(fill.ends())));
    let along = fills().fold(1, |all, fill| lcm(all, u64::from(fill.picks())));
    let mut warnings = Vec::new();
    for (what, threads, repeat) in [
        ("ends", u64::from(regions.map().ends()), across),
        ("picks", u64::from(regions.map().picks()), along),
    ] {
        if threads.is_multiple_of(repeat) {
            continue;
        }
        let above = (threads / repeat + 1).saturating_mul(repeat);
        let offer = match threads / repeat * repeat {
            0 => above.to_string(),
            below => format!("{below} or {above}"),
        };
        warnings.push(format!(
            "{threads} {what} cut the weaves' repeat of {repeat}, so it breaks where the panel \
             repeats: {offer} would not"
        ));
    }
    warnings
}
