//! Small pictures of designs as cloth: drawn one after the other on a thread, first as a
//! drawdown and then woven, and kept as long as the window is open.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};

use egui::{ColorImage, TextureHandle, TextureOptions};
use pickglass::design::{Colouring, Design, SwatchWindow, WeavePattern, swatch};
use pickglass::edit::recovery;
use pickglass::engine::{FirstSight, SightTables, StillRequest, usual_width_mm};
use pickglass::job::Job;
use pickglass::scene::View;
use pickglass::text::visible;

use crate::opened::Opened;

/// Pixels along the side of a picture.
const PIXELS: u32 = 296;
/// A crossing is at most this many pixels of a drawdown.
const LARGEST_CELL: usize = 6;
/// Larger files are not opened for a picture, bytes.
const LARGEST_FILE: u64 = 32 << 20;
/// A picture whose squares lie no further apart shows no figure.
const PLAIN: u8 = 8;
/// Pixels along such a square.
const SQUARE: usize = 8;
/// Repeats of up to so many threads are shown close, larger ones whole.
const CLOSE: u32 = 72;

/// Whose picture.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub enum Source {
    Preset(&'static str),
    File(PathBuf),
    /// A recovery copy.
    Copy(PathBuf),
}

impl Source {
    fn design(&self) -> Option<Arc<Design>> {
        let small = |path: &PathBuf| {
            let about = std::fs::metadata(path).ok()?;
            (about.is_file() && about.len() <= LARGEST_FILE).then(|| path.clone())
        };
        match self {
            Self::Preset(name) => Some(Opened::preset(name).ok()?.design),
            Self::File(path) => Some(Opened::file(small(path)?).ok()?.design),
            Self::Copy(path) => {
                let recovered = recovery::load(&small(path)?).ok()?;
                Some(Arc::new(recovered.design))
            }
        }
    }
}

/// A picture and what it shows.
pub struct Thumb {
    pub title: String,
    pub caption: String,
    pub texture: TextureHandle,
}

/// What the thread sends; without a picture none can be made.
struct Made {
    source: Source,
    title: String,
    caption: String,
    image: Option<ColorImage>,
    /// As cloth, or as good as it gets: nothing follows.
    woven: bool,
}

/// The pictures, and the thread that draws them.
#[derive(Default)]
pub struct Thumbs {
    kept: BTreeMap<Source, Thumb>,
    asked: BTreeSet<Source>,
    /// Asked for and not woven yet.
    waiting: BTreeSet<Source>,
    maker: Option<(Sender<Source>, Receiver<Made>)>,
}

impl Thumbs {
    /// Has a picture drawn, once.
    pub fn ask(&mut self, ctx: &egui::Context, source: Source) {
        if self.asked.contains(&source) {
            return;
        }
        if self.maker.is_none() {
            self.maker = start(ctx);
        }
        if let Some((orders, _)) = &self.maker
            && orders.send(source.clone()).is_ok()
        {
            self.waiting.insert(source.clone());
        }
        self.asked.insert(source);
    }

    /// Takes what was drawn.
    pub fn poll(&mut self, ctx: &egui::Context) {
        let made: Vec<Made> = match &self.maker {
            Some((_, made)) => made.try_iter().collect(),
            None => return,
        };
        for made in made {
            if made.woven {
                self.waiting.remove(&made.source);
            }
            let Some(image) = made.image else { continue };
            let thumb = Thumb {
                title: made.title,
                caption: made.caption,
                texture: ctx.load_texture("thumbnail", image, TextureOptions::LINEAR),
            };
            self.kept.insert(made.source, thumb);
        }
    }

    /// A picture, as soon as there is one.
    pub fn get(&self, source: &Source) -> Option<&Thumb> {
        self.kept.get(source)
    }

    /// Whether pictures are still being drawn.
    pub fn is_working(&self) -> bool {
        !self.waiting.is_empty()
    }
}

/// Starts the thread; it ends when the window drops its orders.
fn start(ctx: &egui::Context) -> Option<(Sender<Source>, Receiver<Made>)> {
    let (orders, wanted) = channel::<Source>();
    let (sender, made) = channel();
    let ctx = ctx.clone();
    let thread = std::thread::Builder::new().name("thumbnails".to_owned());
    let spawned = thread.spawn(move || {
        let tables = Arc::new(SightTables::default());
        while let Ok(first) = wanted.recv() {
            // All are seen as drawdowns before the first is woven.
            let batch: Vec<Source> = std::iter::once(first).chain(wanted.try_iter()).collect();
            let mut designs = Vec::new();
            for source in batch {
                let (known, made) = drawn(source);
                designs.extend(known);
                if sender.send(made).is_err() {
                    return;
                }
                ctx.request_repaint();
            }
            for (source, design, drawdown) in designs {
                if sender
                    .send(woven(source, design, drawdown, &tables))
                    .is_err()
                {
                    return;
                }
                ctx.request_repaint();
            }
        }
    });
    match spawned {
        Ok(_) => Some((orders, made)),
        Err(error) => {
            log::warn!("no thumbnails are drawn: {error}");
            None
        }
    }
}

type Known = (Source, Arc<Design>, Arc<WeavePattern>);

/// A design's drawdown; nothing where it cannot be read.
fn drawn(source: Source) -> (Option<Known>, Made) {
    let Some(design) = source.design() else {
        let made = Made {
            source,
            title: String::new(),
            caption: String::new(),
            image: None,
            woven: true,
        };
        return (None, made);
    };
    let drawdown = Arc::new(design.weave());
    let made = Made {
        source: source.clone(),
        title: visible(&design.name).into_owned(),
        caption: caption(&design),
        image: Some(swatch_of(&design, &drawdown)),
        woven: false,
    };
    (Some((source, design, drawdown)), made)
}

fn caption(design: &Design) -> String {
    format!("{} × {}", design.ends(), design.picks())
}

/// The cloth at first sight.
fn woven(
    source: Source,
    design: Arc<Design>,
    drawdown: Arc<WeavePattern>,
    tables: &Arc<SightTables>,
) -> Made {
    let sett = design.sett();
    let whole = (design.ends() as f32 * sett.ends.mean_pitch_mm())
        .max(design.picks() as f32 * sett.picks.mean_pitch_mm());
    let close = design.ends().max(design.picks()) <= CLOSE;
    let request = StillRequest {
        width: PIXELS,
        height: PIXELS,
        width_mm: Some(match close {
            true => usual_width_mm(View::Face, &design),
            false => whole,
        }),
        ..StillRequest::default()
    };
    let (title, caption) = (visible(&design.name).into_owned(), caption(&design));
    let sight = FirstSight::new(
        Arc::clone(&design),
        Arc::clone(&drawdown),
        Arc::clone(tables),
    );
    let image = match sight.look(&request, &Job::new()) {
        Ok(seen) => Some(ColorImage::from_rgba_unmultiplied(
            [PIXELS as usize; 2],
            &seen.rgba,
        )),
        Err(error) => {
            log::warn!("{title}: its thumbnail stays a drawdown: {error}");
            None
        }
    };
    // Cloth of one colour may show no figure from afar: its drawdown says more then.
    let figure = spread(&swatch_of(&design, &drawdown));
    let image =
        image.filter(|image| figure < PLAIN || 3 * u16::from(spread(image)) > figure.into());
    Made {
        source,
        title,
        caption,
        image,
        woven: true,
    }
}

/// How far apart the lightness of a picture lies from place to place, but for the outermost:
/// means of squares, so that threads count for nothing and figures for all.
fn spread(image: &ColorImage) -> u8 {
    let [width, height] = image.size;
    let corners = (0..height / SQUARE).flat_map(|y| (0..width / SQUARE).map(move |x| (x, y)));
    let mean = |(x, y): (usize, usize)| {
        let rows = (y * SQUARE..(y + 1) * SQUARE).flat_map(|row| {
            let first = row * width + x * SQUARE;
            image.pixels.get(first..first + SQUARE).unwrap_or_default()
        });
        let sum: usize = rows.map(|pixel| usize::from(pixel.g())).sum();
        (sum / (SQUARE * SQUARE)) as u8
    };
    let mut means: Vec<u8> = corners.map(mean).collect();
    means.sort_unstable();
    let few = means.len() / 20;
    let at = |place: usize| means.get(place).copied().unwrap_or_default();
    at(means.len().saturating_sub(few + 1)).saturating_sub(at(few))
}

/// As much of the drawdown as fits, in cells of whole pixels; large designs from afar.
pub fn swatch_of(design: &Design, drawdown: &WeavePattern) -> ColorImage {
    let pixels = PIXELS as usize;
    let longest = design.ends().max(design.picks()) as usize;
    let cell = (pixels / longest.max(1)).clamp(1, LARGEST_CELL);
    let level = (0..16)
        .find(|level| longest >> level <= pixels)
        .unwrap_or(16);
    let side = pixels.div_ceil(cell);
    let window = SwatchWindow {
        end: 0,
        pick: 0,
        size: [side, side],
        level: level as u32,
    };
    let small = swatch(design, drawdown, window, Colouring::Yarns);
    let large: Vec<[u8; 4]> = (0..pixels * pixels)
        .map(|at| small[(at / pixels / cell) * side + at % pixels / cell])
        .collect();
    ColorImage::from_rgba_unmultiplied([pixels; 2], large.as_flattened())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::{Duration, Instant};

    fn wait(thumbs: &mut Thumbs, ctx: &egui::Context) {
        let begun = Instant::now();
        while thumbs.is_working() {
            thumbs.poll(ctx);
            assert!(begun.elapsed() < Duration::from_secs(120), "waited in vain");
            std::thread::sleep(Duration::from_millis(2));
        }
    }

    #[test]
    fn a_preset_is_woven_and_a_file_that_is_not_there_has_no_picture() {
        let ctx = egui::Context::default();
        let mut thumbs = Thumbs::default();
        let absent = Source::File(PathBuf::from("/absent/no.wif"));
        thumbs.ask(&ctx, absent.clone());
        thumbs.ask(&ctx, Source::Preset("oxford"));
        wait(&mut thumbs, &ctx);
        let oxford = thumbs.get(&Source::Preset("oxford")).expect("a picture");
        assert_eq!(oxford.title, "Oxford");
        assert!(thumbs.get(&absent).is_none());
        assert!(thumbs.get(&Source::Preset("damask")).is_none());
    }

    #[test]
    fn a_weave_in_one_colour_stays_a_drawdown_in_which_it_is_seen() {
        let (known, made) = drawn(Source::Preset("damask"));
        assert!(spread(&made.image.expect("drawn")) > PLAIN);
        let (source, design, drawdown) = known.expect("a design");
        assert!(
            woven(source, design, drawdown, &Arc::default())
                .image
                .is_none()
        );
        let plain = ColorImage::filled([64, 64], egui::Color32::GRAY);
        assert_eq!(spread(&plain), 0);
    }

    #[test]
    fn the_cloth_takes_the_place_of_the_drawdown() {
        let (known, made) = drawn(Source::Preset("herringbone"));
        let (source, design, drawdown) = known.expect("a design");
        let cloth = woven(source, design, drawdown, &Arc::default());
        let (before, after) = (made.image.expect("drawn"), cloth.image.expect("woven"));
        assert!(!made.woven && cloth.woven);
        assert_eq!(before.size, after.size);
        assert_ne!(before.pixels, after.pixels);
    }
}
