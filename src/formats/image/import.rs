//! An image becomes a design.
//!
//! * **Weave**: see the module's rules for black and white. The yarns are a dark warp and
//!   a light weft, so that the cloth looks like the image.
//! * **Artwork**: every colour becomes a region, numbered from dark to light, with a first
//!   weave from the shaded 8-end satin: 7/1 (nearly all warp) for the darkest to 1/7
//!   (nearly all weft) for the lightest, the steps between spread evenly.
//! * **Warp, weft**: see `yarn_maps`.

use std::sync::Arc;

use super::numbers::Numbers;
use super::raster::{Colours, MAX_COLOURS, Pixels, Raster, luma};
use super::yarn_maps::yarns_only;
use super::{Black, Decoded, Fault, ImageAs, ImageError, ImageReading};
use crate::design::{
    Density, Design, DesignError, Family, Fill, FirstEnd, FirstPick, Grid, Origin, Region, Regions,
    Sett, Srgb, Structure, WeavePattern, Yarn, YarnId, YarnMaps, usual_sett,
};
use crate::formats::reading::{Imported, LoadOptions, stem};
use crate::limits;

/// The most colours that are taken for artwork without being told.
const FLAT_COLOURS: usize = 64;

/// A difference in luma that is hard to see.
const CLOSE: f32 = 48.0;

/// Yarns of a design whose image says nothing about them: dark warp, light weft.
const DARK: Srgb = Srgb(0x24, 0x2b, 0x3a);
const LIGHT: Srgb = Srgb(0xee, 0xe9, 0xde);

/// Resolutions in dots per inch that programs write when nobody chose one.
const DEFAULT_DPI: [f32; 3] = [72.0, 96.0, 300.0];

/// Makes a design of an image. `name` is the file's name.
///
/// # Errors
/// [`ImageError`] for pictures, for more colours than regions or yarns can be told apart
/// by, and for a sett that cannot be woven.
pub fn design(decoded: Decoded, name: &str, options: &LoadOptions) -> Result<Imported, ImageError> {
    let lossy = decoded.encoding.lossy();
    let mut warnings = decoded.warnings;
    let raster = decoded.raster;
    let colours = raster.colours();
    let what = options
        .image
        .what
        .unwrap_or_else(|| propose(&raster, &colours, lossy));
    if lossy && what != ImageAs::Picture {
        let format = decoded.encoding.name();
        warnings.push(format!(
            "{format} changes colours when it is saved: pixels may be wrong; use a 1-bit or \
             indexed image"
        ));
    }
    let family = options.family.unwrap_or(Family::Cotton);
    let per_cm = raster.per_cm;
    let built = match what {
        ImageAs::Picture => return Err(picture(&colours, name)),
        ImageAs::Weave => Ok(weave(
            raster,
            &colours,
            options.image,
            family,
            &mut warnings,
        )),
        ImageAs::Artwork => artwork(raster, &colours, options.image, family, &mut warnings),
        ImageAs::Warp | ImageAs::Weft => {
            yarns_only(&raster, what, options.image, family, &mut warnings)
        }
    };
    let (structure, yarns, maps) = built.map_err(|fault| fault.named(name))?;
    let sett = match options.sett {
        Some((ends, picks)) => Sett::per_cm(ends, picks),
        None => match per_cm.and_then(stated_sett) {
            Some(sett) => {
                warnings.push(format!(
                    "sett from the image's resolution: {} ends × {} picks per cm",
                    sett.ends.per_cm, sett.picks.per_cm
                ));
                sett
            }
            None => usual_sett(&yarns, &maps),
        },
    };
    let wrong = |error: DesignError| {
        Fault::new(error.to_string(), "give another sett or image").named(name)
    };
    let mut design = Design::new(stem(name), structure, yarns, maps, sett).map_err(wrong)?;
    design.origin = Arc::new(Origin {
        first_end: match options.image.corner.from_right() {
            true => FirstEnd::Right,
            false => FirstEnd::Left,
        },
        first_pick: match options.image.corner.turned() {
            true => FirstPick::Top,
            false => FirstPick::Bottom,
        },
        ..Origin::default()
    });
    Ok(Imported { design, warnings })
}

/// What an image is, by its colours and how they lie.
fn propose(raster: &Raster, colours: &Colours, lossy: bool) -> ImageAs {
    match colours {
        _ if lossy => ImageAs::Picture,
        Colours::Many => ImageAs::Picture,
        Colours::Few(few) if few.len() <= 2 && few.iter().all(|entry| plain(entry.0)) => {
            ImageAs::Weave
        }
        Colours::Few(few) if few.len() == 2 && interlaced(raster) => ImageAs::Weave,
        Colours::Few(few) if few.len() <= FLAT_COLOURS => ImageAs::Artwork,
        Colours::Few(_) => ImageAs::Picture,
    }
}

/// Pixels that are looked at to tell a weave from artwork.
const LOOKED_AT: u64 = 1 << 16;
/// The longest float that is taken for a weave's.
const LONGEST_FLOAT: u32 = 24;
/// The share of pixels that may lie in solid places, or float longer, in a weave.
const MOST_SOLID: f64 = 0.2;

/// Whether two colours change from crossing to crossing, as in a weave: threads are bound
/// both ways before long, and few places are of one colour all round.
///
/// Places are solid where the 5 × 5 pixels about them are alike, the image taken for a
/// repeat. A satin of 16 has few such places, a square of 8 has a quarter.
fn interlaced(raster: &Raster) -> bool {
    let (width, height) = (raster.width(), raster.height());
    let count = u64::from(width) * u64::from(height);
    // An odd step meets all columns in turn.
    let step = count.div_ceil(LOOKED_AT) | 1;
    let at = |x: u32, y: u32| raster.colour(x % width, y % height);
    let (mut looked_at, mut solid) = (0u64, 0u64);
    for place in (0..count).step_by(step as usize) {
        let (x, y) = (
            (place % u64::from(width)) as u32,
            (place / u64::from(width)) as u32,
        );
        let own = at(x, y);
        let alike = |dx: u32, dy: u32| at(x + width + dx - 2, y + height + dy - 2) == own;
        let float = |size: u32, like: &dyn Fn(u32) -> bool| {
            let most = LONGEST_FLOAT.min(size);
            let ahead = (1..most).take_while(|&far| like(far)).count() as u32;
            let back = (1..most).take_while(|&far| like(size - far)).count() as u32;
            1 + ahead + back
        };
        let along = float(width, &|far| at(x + far, y) == own);
        let across = float(height, &|far| at(x, y + far) == own);
        // A thread that never changes sides is not bound at all.
        let loose = |float: u32, size: u32| size > 1 && float > LONGEST_FLOAT.min(size);
        let places = || (0..25).all(|k| alike(k % 5, k / 5));
        looked_at += 1;
        solid += u64::from(loose(along, width) || loose(across, height) || places());
    }
    solid as f64 <= MOST_SOLID * looked_at as f64
}

/// Whether a colour is near black or near white.
fn plain(Srgb(red, green, blue): Srgb) -> bool {
    let (least, most) = (red.min(green).min(blue), red.max(green).max(blue));
    most <= 64 || least >= 192
}

fn picture(colours: &Colours, name: &str) -> ImageError {
    let count = match colours {
        Colours::Many => format!("more than {MAX_COLOURS} colours"),
        Colours::Few(few) => format!("{} colours", few.len()),
    };
    let typed = match name.contains(char::is_whitespace) {
        true => format!("\"{name}\""),
        false => name.to_owned(),
    };
    ImageError {
        file: name.to_owned(),
        problem: format!("expected a weave or flat artwork, found a picture of {count}"),
        remedy: format!(
            "reduce it with `pickglass posterize {typed} -o DESIGN.ron`, or say what it is with \
             --as weave or --as artwork"
        ),
        picture: Some(count),
    }
}

/// Where the weave is from, the yarns and where they lie.
pub(super) type Parts = (Structure, Vec<Yarn>, YarnMaps);

fn dark_and_light(family: Family) -> (Vec<Yarn>, YarnMaps) {
    let yarns = vec![
        Yarn::new("warp", family, DARK),
        Yarn::new("weft", family, LIGHT),
    ];
    (yarns, YarnMaps::plain(YarnId(0), YarnId(1)))
}

fn weave(
    raster: Raster,
    colours: &Colours,
    reading: ImageReading,
    family: Family,
    warnings: &mut Vec<String>,
) -> Parts {
    let darker = match colours {
        Colours::Few(few) => match few.as_slice() {
            [(a, _), (b, _)] => Some(if luma(*a) <= luma(*b) { *a } else { *b }),
            _ => None,
        },
        Colours::Many => None,
    };
    let black = |colour: Srgb| match darker {
        Some(darker) => colour == darker,
        None => luma(colour) < 127.5,
    };
    let mut line = format!("read as a weave: {}, {}", reading.black, reading.corner);
    if reading.mirror {
        line += ", mirrored (Z becomes S)";
    }
    let strays = strays(&raster, colours);
    if let Some(darker) = darker.filter(|_| strays > 0) {
        line += &format!(
            "; the darker of its two colours, {darker}, is {}",
            match reading.black {
                Black::Warp => "warp up",
                Black::Weft => "weft up",
            }
        );
    } else if strays > 0 {
        let all = f64::from(raster.width()) * f64::from(raster.height());
        line += &format!(
            "; {} of pixels are neither black nor white",
            percent(strays as f64 / all)
        );
    }
    if let Colours::Few(few) = colours
        && let [(only, _)] = few.as_slice()
    {
        line += match black(*only) {
            true => "; there is only ink, no paper",
            false => "; there is no ink, only paper",
        };
    }
    if let Colours::Few(few) = colours
        && let [(a, _), (b, _)] = few.as_slice()
        && (luma(*a) - luma(*b)).abs() < CLOSE
    {
        line += &format!("; its two colours hardly differ ({a}, {b}): check it");
    }
    warnings.push(line);
    let pattern = pattern(&raster, reading, black);
    let (yarns, maps) = dark_and_light(family);
    (Structure::Pattern(pattern), yarns, maps)
}

/// A share with as many digits as it takes to be no zero.
fn percent(share: f64) -> String {
    match share * 100.0 {
        small if small < 0.1 => "less than 0.1 %".to_owned(),
        more => format!("{more:.1} %"),
    }
}

/// Pixels that are neither near black nor near white.
fn strays(raster: &Raster, colours: &Colours) -> u64 {
    match (colours, raster.pixels()) {
        (Colours::Few(few), _) => few
            .iter()
            .filter(|entry| !plain(entry.0))
            .map(|entry| entry.1)
            .sum(),
        (Colours::Many, Pixels::Colours(pixels)) => pixels
            .iter()
            .filter(|&&[red, green, blue]| !plain(Srgb(red, green, blue)))
            .count() as u64,
        (Colours::Many, _) => 0,
    }
}

/// The weave of an image in which `black` says which colours are black.
fn pattern(raster: &Raster, reading: ImageReading, black: impl Fn(Srgb) -> bool) -> WeavePattern {
    let (width, height) = (raster.width(), raster.height());
    let up = |colour: Srgb| black(colour) == (reading.black == Black::Warp);
    let by_index: Vec<bool> = raster.palette().iter().map(|&colour| up(colour)).collect();
    let turned = reading.corner.turned();
    let mut pattern = WeavePattern::new(width, height);
    let words = pattern.words_per_pick();
    let mut last = ([0; 3], up(Srgb(0, 0, 0)));
    for y in 0..height {
        let pick = if turned { y } else { height - 1 - y };
        for word in 0..words {
            let first = word * 64;
            let here = (width - first).min(64) as usize;
            let from = y as usize * width as usize + first as usize;
            let bits = match raster.pixels() {
                Pixels::Bits(bits) => {
                    let stride = width.div_ceil(8) as usize;
                    let from = y as usize * stride + first as usize / 8;
                    let mut eight = [0; 8];
                    let bytes = &bits[from..(from + 8).min((y as usize + 1) * stride)];
                    eight[..bytes.len()].copy_from_slice(bytes);
                    // The first pixel is the highest bit; ours is the lowest.
                    let ones = u64::from_be_bytes(eight).reverse_bits();
                    match (by_index[0], by_index[1]) {
                        (false, true) => ones,
                        (true, false) => !ones,
                        (both, _) => u64::from(both) * u64::MAX,
                    }
                }
                Pixels::Indices(indices) => indices[from..from + here]
                    .iter()
                    .enumerate()
                    .fold(0, |bits, (at, &index)| {
                        bits | u64::from(by_index[usize::from(index)]) << at
                    }),
                Pixels::Colours(colours) => {
                    let row = colours[from..from + here].iter().enumerate();
                    row.fold(0, |bits, (at, &colour)| {
                        if colour != last.0 {
                            last = (colour, up(Srgb(colour[0], colour[1], colour[2])));
                        }
                        bits | u64::from(last.1) << at
                    })
                }
            };
            pattern.set_pick_word(word, pick, bits);
        }
    }
    match turned != reading.mirror {
        true => pattern.mirrored(),
        false => pattern,
    }
}

fn artwork(
    raster: Raster,
    colours: &Colours,
    reading: ImageReading,
    family: Family,
    warnings: &mut Vec<String>,
) -> Result<Parts, Fault> {
    let numbers = Numbers::of(&raster, colours, reading.key)?;
    let map = Grid::from_fn(
        raster.width(),
        raster.height(),
        numbers.reader(&raster, reading),
    )
    .map_err(|error| Fault::new(error.to_string(), "cut it into parts"))?;
    let colours = numbers.colours;
    drop(raster);
    let mut regions = Vec::with_capacity(colours.len());
    let lightness = ranks(&colours);
    for (&colour, &rank) in colours.iter().zip(&lightness) {
        let notation = shade(rank, colours.len(), colour);
        let fill = Fill::by_notation(&notation)
            .map_err(|error| Fault::new(error.to_string(), "report this, please"))?;
        regions.push(Region {
            locked: false,
            yarns: None,
            name: colour.to_string(),
            colour: Some(colour),
            fill,
            origin: (0, 0),
        });
    }
    let turned = if reading.corner.turned() {
        ", turned by 180°"
    } else {
        ""
    };
    let mirrored = if reading.mirror { ", mirrored" } else { "" };
    warnings.push(format!(
        "read as artwork of {} colours, each filled with a satin by its lightness{turned}{mirrored}",
        regions.len()
    ));
    let regions = Regions::new(map, regions, None)
        .map_err(|error| Fault::new(error.to_string(), "report this, please"))?;
    let (yarns, maps) = dark_and_light(family);
    Ok((Structure::Regions(regions), yarns, maps))
}

/// The place of each colour from dark to light.
fn ranks(colours: &[Srgb]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..colours.len()).collect();
    order.sort_by(|&a, &b| {
        luma(colours[a])
            .total_cmp(&luma(colours[b]))
            .then(a.cmp(&b))
    });
    let mut ranks = vec![0; colours.len()];
    for (rank, place) in order.into_iter().enumerate() {
        ranks[place] = rank;
    }
    ranks
}

/// The weave of the `rank`-th darkest of `count` colours, from the shaded 8-end satin.
fn shade(rank: usize, count: usize, colour: Srgb) -> String {
    let lighter = match count {
        0 | 1 => usize::from(luma(colour) >= 127.5) * 6,
        _ => (6 * rank + (count - 1) / 2) / (count - 1),
    };
    format!("{}/{} satin", 7 - lighter, 1 + lighter)
}

/// The sett that a resolution states; `None` for programs' defaults and what cannot be
/// woven.
fn stated_sett((across, down): (f32, f32)) -> Option<Sett> {
    let default = |per_cm: f32, dpi: f32| (per_cm * 2.54 - dpi).abs() < 0.6;
    let both = |dpi: f32| default(across, dpi) && default(down, dpi);
    let woven = |per_cm: f32| limits::can_be_woven(10.0 / per_cm);
    if DEFAULT_DPI.into_iter().any(both) || !woven(across) || !woven(down) {
        return None;
    }
    Some(Sett {
        ends: Density::per_cm(across),
        picks: Density::per_cm(down),
        assumed: false,
    })
}

/// Whether a sett written as a resolution would be taken for a default when read back.
pub(super) fn looks_like_default(sett: &Sett) -> bool {
    stated_sett((sett.ends.per_cm, sett.picks.per_cm)).is_none()
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;

    #[test]
    fn shades_run_from_warp_to_weft() {
        let grey = Srgb(90, 90, 90);
        let series: Vec<String> = (0..7).map(|rank| shade(rank, 7, grey)).collect();
        assert_eq!(
            series,
            [
                "7/1 satin",
                "6/2 satin",
                "5/3 satin",
                "4/4 satin",
                "3/5 satin",
                "2/6 satin",
                "1/7 satin"
            ]
        );
        assert_eq!(shade(0, 2, grey), "7/1 satin");
        assert_eq!(shade(1, 2, grey), "1/7 satin");
        assert_eq!(shade(0, 1, grey), "7/1 satin");
        for rank in 0..256 {
            Fill::by_notation(&shade(rank, 256, grey)).unwrap();
        }
    }

    #[test]
    fn default_resolutions_are_no_sett() {
        assert!(stated_sett((28.35, 28.34)).is_none());
        assert!(stated_sett((37.8, 37.8)).is_none());
        assert!(stated_sett((118.11, 118.11)).is_none());
        assert!(stated_sett((0.3, 20.0)).is_none());
        assert!(stated_sett((f32::NAN, 20.0)).is_none());
        let sett = stated_sett((28.35, 20.0)).unwrap();
        assert_eq!((sett.ends.per_cm, sett.picks.per_cm), (28.35, 20.0));
    }

    #[test]
    fn colours_propose_what_an_image_is() {
        let (black, white) = (Srgb(0, 0, 0), Srgb(255, 255, 255));
        let (red, navy) = (Srgb(200, 0, 0), Srgb(25, 25, 117));
        type Lies = fn(u32, u32) -> bool;
        let plain: Lies = |x, y| (x + y) % 2 == 0;
        let twill: Lies = |x, y| (x + 4 - y % 4) % 4 == 0;
        let satin: Lies = |x, y| (3 * x + y) % 8 == 0;
        let satin_16: Lies = |x, y| (7 * x + y) % 16 == 0;
        let basket: Lies = |x, y| (x / 4 + y / 4) % 2 == 0;
        let squares: Lies = |x, y| (x / 8 + y / 8) % 2 == 0;
        let disc: Lies = |x, y| x.abs_diff(24).pow(2) + y.abs_diff(24).pow(2) < 200;
        let stripes: Lies = |_, y| y % 2 == 0;
        let image = |size: u32, dark: Srgb, light: Srgb, lies: Lies| {
            let places = (0..size * size).map(|k| u8::from(!lies(k % size, k / size)));
            let pixels = Pixels::Indices(places.collect());
            let raster = Raster::new(size, size, pixels, vec![dark, light]).unwrap();
            let colours = raster.colours();
            propose(&raster, &colours, false)
        };
        for (size, lies) in [
            (8, plain),
            (4, twill),
            (16, twill),
            (8, satin),
            (48, satin),
            (32, satin_16),
            (16, basket),
        ] {
            assert_eq!(image(size, red, white, lies), ImageAs::Weave, "{size}");
            assert_eq!(image(size, navy, red, lies), ImageAs::Weave, "{size}");
        }
        for (size, lies) in [(48, squares), (48, disc), (16, stripes)] {
            assert_eq!(image(size, red, white, lies), ImageAs::Artwork, "{size}");
            // Black and white are a weave in any shape.
            assert_eq!(image(size, black, white, lies), ImageAs::Weave, "{size}");
        }
        let one = Raster::new(1, 1, Pixels::Colours(vec![[0; 3]]), Vec::new()).unwrap();
        assert_eq!(propose(&one, &one.colours(), false), ImageAs::Weave);
        assert_eq!(propose(&one, &one.colours(), true), ImageAs::Picture);
        assert_eq!(propose(&one, &Colours::Many, false), ImageAs::Picture);
    }
}
