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
pub use resample::{MAX_PANEL, panel};
pub use series::{DARKEST, LIGHTEST, shadow_weave};
pub use settings::{Fit, MAX_COLOURS, PosteriseSettings};

use crate::cloth::expected::{expected_colour, yarn_colour};
use crate::design::{
    Design, DesignError, Grid, Region, RegionYarns, Regions, SizeError, SourceImage, Srgb,
    Structure, StructureError, Yarn, YarnId, YarnMaps, delta_e_00, lab,
};
use crate::job::{Cancelled, Job};

/// Why a picture could not become a design.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PosteriseError {
    /// The owner cancelled the work.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
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
    let (ends, picks) = (layout.ends, layout.picks);
    job.report("resampling", 0.0);
    let pixels = panel(source, &layout, job)?;
    job.report("reducing colours", 0.3);
    let mut reduced = quantise::quantise(&pixels, ends, settings.colours, settings.dither, job)?;
    job.report("merging specks", 0.7);
    specks::merge(&mut reduced.indices, ends as usize, settings.speck, job)?;
    reduced.drop_unused();
    job.report("proposing weaves", 0.85);

    let known = previous.and_then(|design| match design.structure() {
        Structure::Regions(regions) => Some(regions),
        _ => None,
    });
    let asked: Vec<Srgb> = reduced.palette.clone();
    let coverage = reduced.coverage();
    let kept = known.map_or_else(
        || vec![None; asked.len()],
        |regions| follow(&asked, regions.palette()),
    );
    let pair = match previous {
        Some(design) => propose::pair_of(design),
        None => propose::pair(&asked, &coverage, settings),
    };
    let mut yarns = vec![pair.warp.clone(), pair.weft.clone()];
    let weaves = propose::weaves(&asked, &coverage, &kept, &pair);
    let mut palette = Vec::with_capacity(asked.len());
    for ((&colour, weave), kept) in asked.iter().zip(weaves).zip(&kept) {
        let before = kept.and_then(|at| known?.palette().get(at));
        let mut region = match before {
            Some(before) => Region {
                yarns: None,
                ..before.clone()
            },
            None => Region::new(colour.to_string(), weave),
        };
        region.colour = Some(colour);
        if settings.preview_only {
            // Both yarns in the colour itself: any weave of them shows it.
            let id = YarnId(yarns.len() as u16);
            let name = region.name.clone();
            yarns.push(Yarn {
                name: format!("{name} weft"),
                colour,
                ..pair.weft.clone()
            });
            yarns.push(Yarn {
                name: format!("{name} warp"),
                colour,
                ..pair.warp.clone()
            });
            let (warp, weft) = (YarnId(id.0 + 1), id);
            region.yarns = Some(RegionYarns { warp, weft });
        }
        palette.push(region);
    }
    job.check()?;

    // The picture's first row is the cloth's last pick.
    let at = |end: u32, pick: u32| (picks - 1 - pick) as usize * ends as usize + end as usize;
    let map = Grid::from_fn(ends, picks, |end, pick| {
        u16::from(reduced.indices[at(end, pick)])
    })?;
    let corrections = known
        .and_then(Regions::corrections)
        .filter(|found| (found.mask().ends(), found.mask().picks()) == (ends, picks))
        .cloned();
    let mut warnings = Vec::new();
    if corrections.is_none() && known.is_some_and(|regions| regions.corrections().is_some()) {
        warnings.push("the hand corrections were drawn on another size and are left out".into());
    }
    let mut regions =
        Regions::new(map, palette, corrections)?.with_source(Some(Arc::clone(source)));
    if let Some(longest) = settings.bind {
        job.report("binding floats", 0.9);
        let bound = bind_floats(&regions, longest, job)?;
        if bound.left > 0 {
            warnings.push(format!(
                "{} floats over {longest} crossings between regions could not be bound: choose \
                 weaves with shorter floats",
                bound.left
            ));
        }
        regions = regions.with_corrections(bound.corrections)?;
    }
    warnings.extend(uneven(&regions));

    let maps = regions.yarn_maps(&YarnMaps::plain(YarnId(0), YarnId(1)))?;
    let colours = expected(&regions, &coverage, &yarns);
    let structure = Structure::Regions(regions);
    let mut design = Design::new(settings.name.clone(), structure, yarns, maps, layout.sett)?;
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

/// What every region is expected to show.
fn expected(regions: &Regions, coverage: &[f64], yarns: &[Yarn]) -> Vec<RegionColour> {
    let yarn = |id: YarnId| &yarns[usize::from(id.0)];
    (regions.palette().iter().zip(coverage))
        .map(|(region, &coverage)| {
            let own = region.yarns.unwrap_or(RegionYarns {
                warp: YarnId(0),
                weft: YarnId(1),
            });
            let shown = expected_colour(region.fill.pattern(), yarn(own.warp), yarn(own.weft));
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

/// The lightest and darkest a pair of yarns can show, for a designer who chooses them.
pub fn reach(warp: &Yarn, weft: &Yarn) -> [Srgb; 2] {
    [warp, weft].map(|yarn| Srgb::from_linear(yarn_colour(yarn)))
}
