//! The drawdown as pixels: the yarn on top of every crossing, or from further away the
//! mean of a square of crossings in linear light.
//!
//! Any window of the endless cloth can be drawn; repeats follow the design's lattice while
//! the yarn orders run on with periods of their own.

use glam::Vec4;

use super::document::Design;
use super::maps::YarnMap;
use super::pattern::WeavePattern;
use super::structure::{Region, Structure};
use super::yarn::{Srgb, YarnId};

/// A weft this near to the warp's colour under it, in every channel, is shaded: else a
/// weave in one colour could not be seen.
const ALIKE: u8 = 16;
/// Beyond so many pairs of yarns, colours are compared crossing by crossing alone.
const MOST_COMPARED: usize = 1 << 12;

/// What a crossing shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Colouring {
    /// The colour of the yarn on top; a weft over a warp of its own colour is shaded.
    Yarns,
    /// Black where the warp is up, white where the weft is.
    Structure,
    /// The colour of the region in the artwork; of a design without regions, as `Yarns`.
    Regions,
}

/// A window of the endless cloth: its lower left crossing and its size in pixels, each a
/// square of 2^`level` crossings a side.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SwatchWindow {
    /// First end.
    pub end: i64,
    /// First pick.
    pub pick: i64,
    /// Pixels across and along.
    pub size: [usize; 2],
    /// log₂ of the crossings along the side of a pixel; at most 16.
    pub level: u32,
}

/// Draws a window, rows from the top, as sRGB and coverage; where there is no cloth,
/// pixels are transparent.
///
/// `drawdown` is the design's; it is given so that it need not be made anew.
pub fn swatch(
    design: &Design,
    drawdown: &WeavePattern,
    window: SwatchWindow,
    colouring: Colouring,
) -> Vec<[u8; 4]> {
    let [width, height] = window.size;
    let level = window.level.min(16);
    let side = 1usize << level;
    let rows = |row: usize| window.pick + (row * side) as i64;
    let mut pixels = Vec::with_capacity(width * height);
    if level == 0 {
        let solid = |Srgb(red, green, blue)| [red, green, blue, 255];
        let colours = Colours::of(design, colouring, solid);
        let painter = Painter::new(design, drawdown, window.end, width, colours);
        for row in (0..height).rev() {
            let first = pixels.len();
            pixels.resize(first + width, [0; 4]);
            painter.row(rows(row), |column, colour| pixels[first + column] = colour);
        }
        return pixels;
    }
    let colours = Colours::of(design, colouring, |colour| colour.to_linear().extend(1.0));
    let painter = Painter::new(design, drawdown, window.end, width * side, colours);
    let mut sums = vec![Vec4::ZERO; width];
    let weight = 1.0 / (side * side) as f32;
    for row in (0..height).rev() {
        sums.fill(Vec4::ZERO);
        for along in 0..side as i64 {
            painter.row(rows(row) + along, |column, colour| {
                sums[column >> level] += colour;
            });
        }
        pixels.extend(sums.iter().map(|&sum| encoded(sum, weight)));
    }
    pixels
}

/// The colour that stands for a region: its own, or a grey that its neighbours in the list
/// do not have.
pub fn region_colour(index: usize, region: &Region) -> Srgb {
    region.colour.unwrap_or_else(|| {
        let grey = 40 + (index * 61 % 180) as u8;
        Srgb(grey, grey, grey)
    })
}

/// A colour a little darker, or lighter where it is dark already.
fn shaded(colour: Srgb) -> Srgb {
    let Srgb(red, green, blue) = colour;
    let dark = red.max(green).max(blue) < 80;
    let one = |channel: u8| match dark {
        true => channel + (255 - channel) / 6,
        false => channel - channel / 6,
    };
    Srgb(one(red), one(green), one(blue))
}

fn alike(a: Srgb, b: Srgb) -> bool {
    let near = |a: u8, b: u8| a.abs_diff(b) <= ALIKE;
    near(a.0, b.0) && near(a.1, b.1) && near(a.2, b.2)
}

/// Of each yarn, whether an end may have its colour; unknown ends may have any.
fn met(design: &Design, warp: &[YarnId]) -> Vec<bool> {
    let mut known = warp.to_vec();
    known.sort_unstable_by_key(|yarn| yarn.0);
    known.dedup();
    if known.is_empty() || known.len() * design.yarns().len() > MOST_COMPARED {
        return vec![true; design.yarns().len()];
    }
    let has = |colour| (known.iter()).any(|&end| alike(design.yarn(end).colour, colour));
    design.yarns().iter().map(|yarn| has(yarn.colour)).collect()
}

/// Sum of premultiplied linear colours → sRGB of what is covered, and coverage.
fn encoded(sum: Vec4, weight: f32) -> [u8; 4] {
    if sum.w <= 0.0 {
        return [0; 4];
    }
    let Srgb(red, green, blue) = Srgb::from_linear((sum / sum.w).truncate());
    let coverage = (sum.w * weight * 255.0).round() as u8;
    [red, green, blue, coverage]
}

/// What crossings show, in whatever numbers the colours are worked with.
struct Colours<Colour> {
    /// Of each yarn, and the same shaded; empty where the structure alone is shown.
    yarns: Vec<Colour>,
    shaded: Vec<Colour>,
    /// Of each region; empty unless they are shown.
    regions: Vec<Colour>,
    warp_up: Colour,
    weft_up: Colour,
}

impl<Colour: Copy> Colours<Colour> {
    fn of(design: &Design, colouring: Colouring, colour: impl Fn(Srgb) -> Colour) -> Self {
        let dyed = match colouring {
            Colouring::Structure => &[],
            Colouring::Yarns | Colouring::Regions => design.yarns(),
        };
        let yarns = dyed.iter().map(|yarn| colour(yarn.colour)).collect();
        let shaded = dyed.iter().map(|yarn| colour(shaded(yarn.colour)));
        let regions = match (colouring, design.structure()) {
            (Colouring::Regions, Structure::Regions(regions)) => {
                let colours = (regions.palette().iter().enumerate())
                    .map(|(index, region)| colour(region_colour(index, region)));
                colours.collect()
            }
            _ => Vec::new(),
        };
        Self {
            yarns,
            shaded: shaded.collect(),
            regions,
            warp_up: colour(Srgb(0, 0, 0)),
            weft_up: colour(Srgb(255, 255, 255)),
        }
    }

    fn yarn(&self, yarn: YarnId) -> Colour {
        let known = self.yarns.get(usize::from(yarn.0));
        known.copied().unwrap_or(self.warp_up)
    }

    fn shaded(&self, yarn: YarnId) -> Colour {
        let known = self.shaded.get(usize::from(yarn.0));
        known.copied().unwrap_or(self.weft_up)
    }
}

/// Draws rows of crossings; what does not change from row to row is worked out once.
struct Painter<'d, Colour> {
    design: &'d Design,
    drawdown: &'d WeavePattern,
    first: i64,
    columns: usize,
    colours: Colours<Colour>,
    /// Colour of each column's end; empty where the warp changes along its ends.
    ends: Vec<Colour>,
    /// The yarn of each column's end; empty as above, and where no yarns are shown.
    warp: Vec<YarnId>,
    /// Whether any end of these columns may have the colour of a yarn.
    met: Vec<bool>,
}

impl<'d, Colour: Copy> Painter<'d, Colour> {
    fn new(
        design: &'d Design,
        drawdown: &'d WeavePattern,
        first: i64,
        columns: usize,
        colours: Colours<Colour>,
    ) -> Self {
        let warp: Vec<YarnId> = match &design.maps().warp {
            YarnMap::Order(_) if !colours.yarns.is_empty() => (0..columns as i64)
                .map(|column| design.warp_yarn(first + column, 0))
                .collect(),
            _ => Vec::new(),
        };
        let ends = match colours.yarns.is_empty() {
            true => vec![colours.warp_up; columns],
            false => warp.iter().map(|&yarn| colours.yarn(yarn)).collect(),
        };
        Self {
            design,
            drawdown,
            first,
            columns,
            colours,
            ends,
            met: met(design, &warp),
            warp,
        }
    }

    /// What a weft shows over the end of a column, at a crossing of the endless cloth.
    fn weft_over(&self, weft: YarnId, column: usize, (end, pick): (i64, i64)) -> Colour {
        let under = self.warp.get(column).copied();
        let under = under.unwrap_or_else(|| self.design.warp_yarn(end, pick));
        let colour = |yarn| self.design.yarn(yarn).colour;
        match alike(colour(weft), colour(under)) {
            true => self.colours.shaded(weft),
            false => self.colours.yarn(weft),
        }
    }

    /// Gives the colour of each column that has cloth at `pick` of the endless cloth.
    fn row(&self, pick: i64, mut put: impl FnMut(usize, Colour)) {
        let (ends, picks) = (self.drawdown.ends(), self.drawdown.picks());
        let lattice = self.design.lattice();
        let bare = self.colours.yarns.is_empty();
        let weft = match &self.design.maps().weft {
            YarnMap::Order(_) if !bare => Some(self.design.weft_yarn(self.first, pick)),
            _ => None,
        };
        // One colour for the whole row, if it has one.
        let plain = match weft {
            _ if bare => Some(self.colours.weft_up),
            Some(weft) if self.met.get(usize::from(weft.0)) == Some(&false) => {
                Some(self.colours.yarn(weft))
            }
            _ => None,
        };
        let map = match self.design.structure() {
            Structure::Regions(regions) if !self.colours.regions.is_empty() => Some(regions.map()),
            _ => None,
        };
        let mut column = 0;
        while column < self.columns {
            let end = self.first + column as i64;
            // Up to the repeat's border the home crossings lie side by side.
            let to_border = i64::from(ends) - end.rem_euclid(i64::from(ends));
            let Some((home_end, home_pick)) = lattice.wrap(end, pick, ends, picks) else {
                column += to_border as usize;
                continue;
            };
            let run = (ends - home_end).min((self.columns - column).min(u32::MAX as usize) as u32);
            let mut word = 0;
            for step in 0..run {
                let home = home_end + step;
                if step == 0 || home % 64 == 0 {
                    word = self.drawdown.pick_word(home / 64, home_pick);
                }
                let up = word >> (home % 64) & 1 == 1;
                let at = column + step as usize;
                let known = match map {
                    Some(map) => {
                        let region = map.get(home, home_pick);
                        self.colours.regions.get(usize::from(region)).copied()
                    }
                    None if up => self.ends.get(at).copied(),
                    None => plain,
                };
                let colour = known.unwrap_or_else(|| {
                    let end = end + i64::from(step);
                    match (up, weft) {
                        (true, _) => self.colours.yarn(self.design.warp_yarn(end, pick)),
                        (false, Some(weft)) => self.weft_over(weft, at, (end, pick)),
                        (false, None) => {
                            let weft = self.design.weft_yarn(end, pick);
                            self.weft_over(weft, at, (end, pick))
                        }
                    }
                });
                put(at, colour);
            }
            column += run as usize;
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;
    use crate::design::{
        Family, Fill, Grid, Lattice, Regions, Repeat, Sett, Yarn, YarnMaps, usual_sett,
    };

    fn design(lattice: Lattice) -> Design {
        let yarn = |colour| Yarn::new("y", Family::Cotton, colour);
        let yarns = vec![
            yarn(Srgb(200, 10, 30)),
            yarn(Srgb(20, 220, 60)),
            yarn(Srgb(40, 70, 250)),
        ];
        let ids = |list: &[u16]| list.iter().copied().map(YarnId).collect::<Vec<_>>();
        let maps = YarnMaps::orders(ids(&[0, 0, 1]), ids(&[2, 1]));
        let weave = WeavePattern::parse("#..#.\n.##..\n##..#\n..##.").unwrap();
        let sett: Sett = usual_sett(&yarns, &maps);
        Design::new("d", Structure::Pattern(weave), yarns, maps, sett)
            .unwrap()
            .with_lattice(lattice)
            .unwrap()
    }

    /// Crossing by crossing, by the design's own words.
    fn one(design: &Design, end: i64, pick: i64) -> Option<Srgb> {
        let weave = design.weave();
        let (e, p) = design
            .lattice()
            .wrap(end, pick, weave.ends(), weave.picks())?;
        let (warp, weft) = (design.warp_yarn(end, pick), design.weft_yarn(end, pick));
        let colour = |yarn| design.yarn(yarn).colour;
        Some(match weave.get(e, p) {
            true => colour(warp),
            // No two yarns of the design are alike.
            false if warp == weft => shaded(colour(weft)),
            false => colour(weft),
        })
    }

    fn window(level: u32) -> SwatchWindow {
        SwatchWindow {
            end: -7,
            pick: -9,
            size: [23, 21],
            level,
        }
    }

    #[test]
    fn each_pixel_is_the_yarn_on_top_on_every_lattice() {
        let dropped = Lattice {
            across: Repeat::Dropped(3),
            along: Repeat::Straight,
        };
        let panel = Lattice {
            across: Repeat::None,
            along: Repeat::Straight,
        };
        let mut seen = Vec::new();
        for lattice in [Lattice::default(), dropped, panel] {
            let design = design(lattice);
            let pixels = swatch(&design, &design.weave(), window(0), Colouring::Yarns);
            for (index, pixel) in pixels.iter().enumerate() {
                let (x, y) = (index % 23, index / 23);
                let at = (-7 + x as i64, -9 + (20 - y) as i64);
                let expected = match one(&design, at.0, at.1) {
                    Some(Srgb(red, green, blue)) => [red, green, blue, 255],
                    None => [0; 4],
                };
                assert_eq!(*pixel, expected, "{lattice:?} {at:?}");
            }
            seen.push(pixels);
        }
        assert!(seen[0] != seen[1] && seen[0] != seen[2]);
    }

    #[test]
    fn a_weave_in_one_colour_is_seen() {
        for (colour, other) in [
            (Srgb(200, 180, 140), Srgb(167, 150, 117)),
            (Srgb(12, 0, 30), Srgb(52, 42, 67)),
        ] {
            let yarn = |colour| Yarn::new("y", Family::Cotton, colour);
            // The second weft is no warp's colour, so it stays as it is.
            let yarns = vec![yarn(colour), yarn(colour), yarn(Srgb(90, 200, 90))];
            let maps = YarnMaps::orders(vec![YarnId(0)], vec![YarnId(1), YarnId(2)]);
            let weave = WeavePattern::parse("#.\n.#").unwrap();
            let sett: Sett = usual_sett(&yarns, &maps);
            let design = Design::new("d", Structure::Pattern(weave), yarns, maps, sett).unwrap();
            let window = SwatchWindow {
                end: 0,
                pick: 0,
                size: [2, 2],
                level: 0,
            };
            let bytes = |Srgb(red, green, blue)| [red, green, blue, 255];
            let shown = swatch(&design, &design.weave(), window, Colouring::Yarns);
            let green = bytes(Srgb(90, 200, 90));
            let (warp, shaded) = (bytes(colour), bytes(other));
            assert_eq!(shown, [warp, green, shaded, warp]);
        }
    }

    #[test]
    fn from_further_away_light_is_averaged_not_numbers() {
        let design = design(Lattice::default());
        let pixels = swatch(&design, &design.weave(), window(2), Colouring::Yarns);
        let mut sum = glam::Vec3::ZERO;
        for pick in 0..4 {
            for end in 0..4 {
                sum += one(&design, -7 + end, -9 + pick).unwrap().to_linear();
            }
        }
        let Srgb(red, green, blue) = Srgb::from_linear(sum / 16.0);
        assert_eq!(pixels[20 * 23], [red, green, blue, 255]);
        // Half black and half white is lighter than the middle of the numbers.
        let weave = WeavePattern::parse("#.\n.#").unwrap();
        let plain = design.with_structure(Structure::Pattern(weave)).unwrap();
        let grey = swatch(&plain, &plain.weave(), window(1), Colouring::Structure)[0];
        assert_eq!(grey, [188, 188, 188, 255]);
    }

    #[test]
    fn regions_show_their_own_colour_or_one_apart_from_their_neighbours() {
        let fill = || Fill::by_notation("2/2 twill").unwrap();
        let mut named = Region::new("ground", fill());
        named.colour = Some(Srgb(9, 90, 200));
        let palette = vec![named, Region::new("figure", fill())];
        let map = Grid::from_fn(5, 4, |end, _| u16::from(end > 2)).unwrap();
        let artwork = Structure::Regions(Regions::new(map, palette, None).unwrap());
        let design = design(Lattice::default()).with_structure(artwork).unwrap();
        let window = SwatchWindow {
            end: 0,
            pick: 0,
            size: [5, 1],
            level: 0,
        };
        let show = |colouring| swatch(&design, &design.weave(), window, colouring);
        let pixels = show(Colouring::Regions);
        assert_eq!(pixels[0], [9, 90, 200, 255]);
        assert!(pixels[4] != pixels[0] && pixels[3] == pixels[4]);
        assert_ne!(show(Colouring::Yarns), pixels);
    }
}
