//! Images of yarns: every colour becomes a yarn.
//!
//! Columns (warp) or rows (weft) of one colour each make an order, which a loom can weave;
//! anything else is a map by crossing, for previews.

use super::import::Parts;
use super::numbers::Numbers;
use super::raster::Raster;
use super::{Decoded, Fault, ImageAs, ImageError, ImageReading};
use crate::design::{
    DesignError, Family, Fill, Filled, Grid, Structure, Yarn, YarnId, YarnMap, YarnMaps, usual_sett,
};
use crate::formats::{Imported, LoadOptions};

/// A map of yarns, and the yarns it names.
fn yarn_map(
    raster: &Raster,
    what: ImageAs,
    reading: ImageReading,
    family: Family,
) -> Result<(YarnMap, Vec<Yarn>), Fault> {
    let numbers = Numbers::of(raster, &raster.colours(), reading.key)?;
    let yarns = numbers
        .colours
        .iter()
        .map(|&colour| Yarn::new(colour.to_string(), family, colour))
        .collect();
    let (ends, picks) = (raster.width(), raster.height());
    let mut at = numbers.reader(raster, reading);
    let along_warp = what == ImageAs::Warp;
    let order: Vec<YarnId> = match along_warp {
        true => (0..ends).map(|end| YarnId(at(end, 0))).collect(),
        false => (0..picks).map(|pick| YarnId(at(0, pick))).collect(),
    };
    let same = (0..picks).all(|pick| {
        (0..ends).all(|end| {
            let thread = if along_warp { end } else { pick };
            at(end, pick) == order[thread as usize].0
        })
    });
    if same {
        return Ok((YarnMap::Order(order), yarns));
    }
    let grid = Grid::from_fn(ends, picks, |end, pick| YarnId(at(end, pick)))
        .map_err(|error| Fault::new(error.to_string(), "cut it into parts"))?;
    Ok((YarnMap::Crossings(grid), yarns))
}

/// What a yarn map says about itself.
fn map_line(what: ImageAs, map: &YarnMap, yarns: usize) -> String {
    let side = if what == ImageAs::Warp {
        "warp"
    } else {
        "weft"
    };
    let kind = match map {
        YarnMap::Order(_) => "an order",
        YarnMap::Crossings(_) => "by crossing, for previews only: no loom changes a yarn midway",
    };
    format!("read as {side} yarns: {yarns} colours, {kind}")
}

/// A design of yarns alone, in plain weave.
pub(super) fn yarns_only(
    raster: &Raster,
    what: ImageAs,
    reading: ImageReading,
    family: Family,
    warnings: &mut Vec<String>,
) -> Result<Parts, Fault> {
    let (map, mut yarns) = yarn_map(raster, what, reading, family)?;
    warnings.push(map_line(what, &map, yarns.len()) + "; the weave is plain");
    let other = YarnMap::single(YarnId(yarns.len() as u16));
    let (name, maps) = match what {
        ImageAs::Warp => (
            "weft",
            YarnMaps {
                warp: map,
                weft: other,
            },
        ),
        _ => (
            "warp",
            YarnMaps {
                warp: other,
                weft: map,
            },
        ),
    };
    yarns.push(Yarn::new(name, family, family.numbers().undyed));
    let fault = |text: String| Fault::new(text, "cut it into parts");
    let fill = Fill::by_notation("plain").map_err(|error| fault(error.to_string()))?;
    let filled = Filled::new(fill, raster.width(), raster.height());
    let filled = filled.map_err(|error| fault(error.to_string()))?;
    Ok((Structure::Weave(filled), yarns, maps))
}

/// Yarn maps for a design, each with its file's name.
#[derive(Debug, Clone, Default)]
pub struct Maps {
    /// Of the warp.
    pub warp: Option<(Decoded, String)>,
    /// Of the weft.
    pub weft: Option<(Decoded, String)>,
}

/// Gives a design the yarns of one or two maps: images of its own size, one pixel a
/// crossing. A warp map may also be one row of its ends and a weft map one column of its
/// picks. Yarns of the direction that gets no map stay.
///
/// # Errors
/// [`ImageError`] for a map of another size or with too many colours.
pub fn with_maps(
    imported: Imported,
    maps: Maps,
    options: &LoadOptions,
) -> Result<Imported, ImageError> {
    let Imported {
        design,
        mut warnings,
    } = imported;
    let family = options.family.unwrap_or(Family::Cotton);
    let (ends, picks) = (design.ends(), design.picks());
    let mut list = YarnList(Vec::new());
    let mut place = |what, given: Option<(Decoded, String)>, own: &YarnMap| {
        let Some((decoded, name)) = given else {
            return Ok(list.renumbered(own, |id| design.yarn(id).clone()));
        };
        let raster = decoded.raster;
        let size = (raster.width(), raster.height());
        let strip = match what {
            ImageAs::Warp => (ends, 1),
            _ => (1, picks),
        };
        if size != (ends, picks) && size != strip {
            let problem = format!(
                "expected {ends} × {picks} pixels, the size of {}, found {} × {}",
                design.name, size.0, size.1
            );
            return Err(Fault::new(problem, "draw the map on the same grid").named(&name));
        }
        warnings.extend(decoded.warnings);
        let (map, yarns) =
            yarn_map(&raster, what, options.image, family).map_err(|fault| fault.named(&name))?;
        warnings.push(format!("{name}: {}", map_line(what, &map, yarns.len())));
        Ok(list.renumbered(&map, |id| yarns[usize::from(id.0)].clone()))
    };
    let maps = YarnMaps {
        warp: place(ImageAs::Warp, maps.warp, &design.maps().warp)?,
        weft: place(ImageAs::Weft, maps.weft, &design.maps().weft)?,
    };
    let wrong =
        |error: DesignError| Fault::new(error.to_string(), "give other maps").named(&design.name);
    let assumed = design.sett().assumed;
    let mut dressed = design.clone().with_yarns(list.0, maps).map_err(wrong)?;
    if assumed {
        let sett = usual_sett(dressed.yarns(), dressed.maps());
        dressed = dressed.with_sett(sett).map_err(wrong)?;
    }
    Ok(Imported {
        design: dressed,
        warnings,
    })
}

/// Yarns gathered from several maps; equal ones are one.
struct YarnList(Vec<Yarn>);

impl YarnList {
    fn number(&mut self, yarn: Yarn) -> YarnId {
        let at = self
            .0
            .iter()
            .position(|known| *known == yarn)
            .unwrap_or_else(|| {
                self.0.push(yarn);
                self.0.len() - 1
            });
        YarnId(at as u16)
    }

    /// A map by this list's numbers; only yarns in use are taken over.
    fn renumbered(&mut self, map: &YarnMap, yarn: impl Fn(YarnId) -> Yarn) -> YarnMap {
        let mut known = std::collections::BTreeMap::new();
        let mut number = |id: YarnId| *known.entry(id).or_insert_with(|| self.number(yarn(id)));
        match map {
            YarnMap::Order(order) => YarnMap::Order(order.iter().map(|&id| number(id)).collect()),
            YarnMap::Crossings(grid) => {
                // A grid of a size that exists already.
                match Grid::from_fn(grid.ends(), grid.picks(), |end, pick| {
                    number(grid.get(end, pick))
                }) {
                    Ok(grid) => YarnMap::Crossings(grid),
                    Err(_) => map.clone(),
                }
            }
        }
    }
}
