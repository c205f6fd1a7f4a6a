//! A design becomes an image: its weave, its artwork, or the yarns of one direction.

use std::collections::{BTreeMap, BTreeSet};
use strum::{EnumMessage, EnumString, IntoStaticStr, VariantArray};

use super::import::looks_like_default;
use super::raster::{MAX_COLOURS, Pixels, Raster};
use super::{Black, Corner, Fault, ImageError};
use crate::design::{
    Design, FirstEnd, FirstPick, Regions, Repeat, Srgb, Structure, WeavePattern, YarnId,
};

/// What of a design an image shows.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, Default, EnumMessage, EnumString, IntoStaticStr, VariantArray,
)]
#[strum(serialize_all = "kebab-case")]
pub enum ImageContent {
    /// The weave, 1 bit a crossing: what looms take.
    #[default]
    Weave,
    /// The regions, each in its colour.
    Artwork,
    /// The warp yarn of every crossing, in its colour.
    Warp,
    /// The weft yarn of every crossing, in its colour.
    Weft,
}

/// An image of a design and what of the design it does not hold.
#[derive(Debug, Clone, PartialEq)]
pub struct Export {
    /// The image, one pixel a crossing.
    pub raster: Raster,
    /// One line each: what has no place in it.
    pub lost: Vec<String>,
}

/// The corner in which the file that a design is from starts to count.
fn remembered(design: &Design) -> Corner {
    Corner::of(
        design.origin.first_end == FirstEnd::Right,
        design.origin.first_pick == FirstPick::Top,
    )
}

/// Draws a design. `corner` = `None` starts where the file started that the design is
/// from. The image's resolution is the sett, if somebody chose one.
///
/// # Errors
/// [`ImageError`] if the design has no regions to show, or more regions or yarns than an
/// indexed image has colours.
pub fn export(
    design: &Design,
    content: ImageContent,
    black: Black,
    corner: Option<Corner>,
) -> Result<Export, ImageError> {
    let corner = corner.unwrap_or_else(|| remembered(design));
    let mut lost = Vec::new();
    let drawn = match (content, design.structure()) {
        (ImageContent::Weave, _) => weave(&design.weave(), black, corner),
        (ImageContent::Artwork, Structure::Regions(regions)) => artwork(regions, corner, &mut lost),
        (ImageContent::Artwork, _) => Err(Fault::new(
            "expected a design with regions, found a weave without any",
            "write its weave instead",
        )),
        (ImageContent::Warp | ImageContent::Weft, _) => {
            yarns(design, content == ImageContent::Warp, corner, &mut lost)
        }
    };
    let mut raster = drawn.map_err(|fault| fault.named(&design.name))?;
    list_losses(design, content, &mut lost);
    let sett = design.sett();
    if !sett.assumed {
        raster.per_cm = Some((sett.ends.per_cm, sett.picks.per_cm));
    }
    Ok(Export { raster, lost })
}

/// What no image of this kind holds.
fn list_losses(design: &Design, content: ImageContent, lost: &mut Vec<String>) {
    let weave = content == ImageContent::Weave;
    match design.structure() {
        Structure::Regions(regions) => {
            let what = match (content, regions.corrections().is_some()) {
                (ImageContent::Artwork, true) => "the regions' weaves, and hand corrections",
                (ImageContent::Artwork, false) => "the regions' names and weaves",
                (_, true) => "regions, their weaves and hand corrections",
                (_, false) => "regions and their weaves",
            };
            lost.push(
                what.to_owned()
                    + if weave {
                        ": the weave they make is written"
                    } else {
                        ""
                    },
            );
        }
        Structure::Draft(_) => lost.push("threading, tie-up and treadling".to_owned()),
        Structure::Weave(filled) if weave => {
            if filled.fill().notation().is_some() {
                lost.push("the weave's notation: the weave itself is written".to_owned());
            }
        }
        Structure::Weave(_) | Structure::Pattern(_) => {
            if !weave {
                lost.push("the weave".to_owned());
            }
        }
    }
    let yarns = match (content, design.weavable()) {
        (ImageContent::Warp, _) => "the weft's yarns; of the warp's, all but their colours",
        (ImageContent::Weft, _) => "the warp's yarns; of the weft's, all but their colours",
        (_, true) => "yarns and their order",
        (_, false) => "yarns, also where they change along a thread (preview only)",
    };
    lost.push(yarns.to_owned());
    let sett = design.sett();
    if sett.ends.pitches_mm.is_some() || sett.picks.pitches_mm.is_some() {
        lost.push("unequal spacing: only the usual sett is written".to_owned());
    }
    let lattice = design.lattice();
    if lattice.across != Repeat::Straight || lattice.along != Repeat::Straight {
        lost.push("the repeat: images repeat straight in both directions".to_owned());
    }
    if !design.notes.is_empty() {
        lost.push("notes".to_owned());
    }
    if !design.origin.sections.is_empty() || !design.origin.palette.is_empty() {
        lost.push("what was kept of the file it is from".to_owned());
    }
}

/// What becomes of the sett in a format that has a resolution or has none.
pub(in crate::formats) fn sett_loss(design: &Design, keeps_resolution: bool) -> Option<String> {
    let sett = design.sett();
    if sett.assumed {
        return None;
    }
    if !keeps_resolution {
        return Some("the sett: this format has no resolution".to_owned());
    }
    looks_like_default(sett).then(|| {
        "the sett: as a resolution it looks like a program's default, which readers pass over"
            .to_owned()
    })
}

/// The crossing (end, pick) behind a pixel, from the top left.
fn crossing(corner: Corner, (width, height): (u32, u32), x: u32, y: u32) -> (u32, u32) {
    match corner.turned() {
        true => (width - 1 - x, y),
        false => (x, height - 1 - y),
    }
}

fn weave(pattern: &WeavePattern, black: Black, corner: Corner) -> Result<Raster, Fault> {
    let (width, height) = (pattern.ends(), pattern.picks());
    let turned;
    let pattern = match corner.turned() {
        true => {
            turned = pattern.mirrored();
            &turned
        }
        false => pattern,
    };
    let line = width.div_ceil(8) as usize;
    let mut bytes = Vec::with_capacity(line * height as usize + 8);
    for y in 0..height {
        let (_, pick) = crossing(corner, (width, height), 0, y);
        let from = bytes.len();
        for bits in pattern.pick_words(pick) {
            // A set bit is white. The first pixel is the highest bit; ours is the lowest.
            let white = if black == Black::Warp { !bits } else { bits };
            bytes.extend_from_slice(&white.reverse_bits().to_be_bytes());
        }
        bytes.truncate(from + line);
    }
    let palette = vec![Srgb(0, 0, 0), Srgb(255, 255, 255)];
    Ok(Raster::new(width, height, Pixels::Bits(bytes), palette)?)
}

fn artwork(regions: &Regions, corner: Corner, lost: &mut Vec<String>) -> Result<Raster, Fault> {
    let palette = regions.palette();
    if palette.len() > MAX_COLOURS {
        let problem = format!(
            "it has {} regions, an indexed image at most {MAX_COLOURS} colours",
            palette.len()
        );
        return Err(Fault::new(problem, "join regions, or keep the .ron design"));
    }
    let wanted: Vec<Option<Srgb>> = palette.iter().map(|region| region.colour).collect();
    let (colours, changed) = distinct(&wanted);
    if changed > 0 {
        lost.push(format!(
            "colours of {changed} regions: they have none or share one, and are drawn in others"
        ));
    }
    let map = regions.map();
    let size = (map.ends(), map.picks());
    indexed(size, colours, |x, y| {
        let (end, pick) = crossing(corner, size, x, y);
        map.get(end, pick) as u8
    })
}

fn yarns(
    design: &Design,
    warp: bool,
    corner: Corner,
    lost: &mut Vec<String>,
) -> Result<Raster, Fault> {
    let size = (design.ends(), design.picks());
    let maps = design.maps();
    let at = |end: u32, pick: u32| -> YarnId {
        match warp {
            true => maps.warp(i64::from(end), i64::from(pick)),
            false => maps.weft(i64::from(end), i64::from(pick)),
        }
    };
    let map = if warp { &maps.warp } else { &maps.weft };
    let threads = if warp { size.0 } else { size.1 };
    let used: BTreeSet<YarnId> = match map {
        crate::design::YarnMap::Order(order) => order.iter().copied().collect(),
        crate::design::YarnMap::Crossings(grid) => grid.iter().collect(),
    };
    if let Some(order) = map.order()
        && !(threads as usize).is_multiple_of(order.len())
    {
        lost.push(format!(
            "the yarn order of {} threads: it is cut off after the weave's {threads}",
            order.len()
        ));
    }
    if used.len() > MAX_COLOURS {
        let problem = format!(
            "it has {} yarns, an indexed image at most {MAX_COLOURS} colours",
            used.len()
        );
        return Err(Fault::new(
            problem,
            "use fewer yarns, or keep the .ron design",
        ));
    }
    let wanted: Vec<Option<Srgb>> = used
        .iter()
        .map(|&id| Some(design.yarn(id).colour))
        .collect();
    let (colours, changed) = distinct(&wanted);
    if changed > 0 {
        lost.push(format!(
            "colours of {changed} yarns: they share one, and are drawn in others"
        ));
    }
    let numbers: BTreeMap<YarnId, u8> = used.into_iter().zip(0..=255).collect();
    indexed(size, colours, |x, y| {
        let (end, pick) = crossing(corner, size, x, y);
        numbers.get(&at(end, pick)).copied().unwrap_or(0)
    })
}

fn indexed(
    (width, height): (u32, u32),
    palette: Vec<Srgb>,
    mut index: impl FnMut(u32, u32) -> u8,
) -> Result<Raster, Fault> {
    let mut indices = Vec::with_capacity(width as usize * height as usize);
    for y in 0..height {
        indices.extend((0..width).map(|x| index(x, y)));
    }
    Ok(Raster::new(
        width,
        height,
        Pixels::Indices(indices),
        palette,
    )?)
}

/// A colour for each, all different, near the wanted ones; and how many had to change.
fn distinct(wanted: &[Option<Srgb>]) -> (Vec<Srgb>, usize) {
    let taken: BTreeSet<Srgb> = wanted.iter().flatten().copied().collect();
    let mut used = BTreeSet::new();
    let mut changed = 0;
    let colours = wanted
        .iter()
        .enumerate()
        .map(|(place, &colour)| {
            if let Some(colour) = colour
                && used.insert(colour)
            {
                return colour;
            }
            changed += 1;
            // Steps of the golden angle through the greys and blues that nobody took.
            let mut step = place as u32;
            loop {
                step = step.wrapping_mul(2_654_435_761).wrapping_add(12_345);
                let [_, red, green, blue] = step.to_be_bytes();
                let free = Srgb(red, green, blue);
                if !taken.contains(&free) && used.insert(free) {
                    return free;
                }
            }
        })
        .collect();
    (colours, changed)
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;

    #[test]
    fn colours_become_different_and_only_where_they_must() {
        let red = Srgb(255, 0, 0);
        let (colours, changed) = distinct(&[Some(red), None, Some(red), Some(Srgb(0, 0, 1))]);
        assert_eq!(changed, 2);
        assert_eq!((colours[0], colours[3]), (red, Srgb(0, 0, 1)));
        let all: BTreeSet<Srgb> = colours.iter().copied().collect();
        assert_eq!(all.len(), 4);
        let (many, changed) = distinct(&[None; 256]);
        assert_eq!(many.into_iter().collect::<BTreeSet<_>>().len(), 256);
        assert_eq!(changed, 256);
    }
}
