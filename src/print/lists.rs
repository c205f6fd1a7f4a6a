//! What the loom is dressed with: yarns and their lengths, orders, heddles, sett.

use super::sheet::{BLACK, Book, GREY, MARGIN, Page};
use crate::design::checks::{Interlacing, TakeUp, heddles, take_up, yarn_needs};
use crate::design::{Design, Srgb, WeavePattern, YarnMap, stripes};
use crate::text::visible;

/// Height of a line in mm, and of its text.
const LINE: f32 = 5.0;
const TEXT: f32 = 3.2;
/// Width of a letter over its size, on the safe side.
const LETTER: f32 = 0.55;
/// The longest order that is written out, in characters.
const MOST_TEXT: usize = 6000;
/// The most yarns and shafts that are listed.
const MOST_LISTED: usize = 400;

/// The pages of the lists.
pub(super) fn pages(book: &mut Book, design: &Design, drawdown: &WeavePattern) {
    let warp = take_up(design, drawdown, Interlacing::Warp);
    let weft = take_up(design, drawdown, Interlacing::Weft);
    let mut list = List::new(book, &design.name);
    yarns(&mut list, design, &warp, &weft);
    list.heading("Sett");
    let sett = design.sett();
    let assumed = if sett.assumed {
        " (usual for these yarns)"
    } else {
        ""
    };
    list.line(&format!(
        "{:.1} ends per cm, {:.1} picks per cm{assumed}; the design is {:.1} × {:.1} mm",
        10.0 / sett.ends.mean_pitch_mm(),
        10.0 / sett.picks.mean_pitch_mm(),
        f64::from(design.ends()) * f64::from(sett.ends.mean_pitch_mm()),
        f64::from(design.picks()) * f64::from(sett.picks.mean_pitch_mm()),
    ));
    list.line(&format!(
        "take-up {:.1} % in the warp, {:.1} % in the weft",
        100.0 * warp.mean,
        100.0 * weft.mean
    ));
    for (name, map) in [
        ("Warp order", &design.maps().warp),
        ("Weft order", &design.maps().weft),
    ] {
        list.heading(name);
        match map {
            YarnMap::Order(order) => {
                let text = stripes::write(order, design.yarns());
                let more = text.chars().count() > MOST_TEXT;
                let text: String = text.chars().take(MOST_TEXT).collect();
                list.paragraph(&text);
                if more {
                    list.line("… and so on: too long to print");
                }
            }
            YarnMap::Crossings(_) => {
                list.line("preview only: the yarn changes along its length, which no loom does");
            }
        }
    }
    let counts = heddles(design, drawdown);
    list.heading("Heddles for one repeat");
    let each: Vec<String> = counts
        .iter()
        .take(MOST_LISTED)
        .enumerate()
        .map(|(shaft, count)| format!("shaft {}: {count}", shaft + 1))
        .collect();
    list.paragraph(&each.join("   "));
    if counts.len() > MOST_LISTED {
        list.line(&format!("… {} shafts in all", counts.len()));
    }
    let total: u64 = counts.iter().map(|&count| u64::from(count)).sum();
    list.line(&format!("{total} heddles on {} shafts", counts.len()));
    list.finish();
}

fn yarns(list: &mut List<'_>, design: &Design, warp: &TakeUp, weft: &TakeUp) {
    let needs = yarn_needs(design, warp, weft);
    list.heading(&format!(
        "Yarns, for a metre of cloth {:.0} mm wide (take-up included, no waste)",
        needs.width_mm
    ));
    for (yarn, need) in design.yarns().iter().zip(&needs.yarns).take(MOST_LISTED) {
        list.swatch(yarn.colour);
        let name: String = visible(&yarn.name).chars().take(40).collect();
        list.columns(&[
            (8.0, &name),
            (70.0, yarn.family.name()),
            (90.0, &format!("{:.1} tex", yarn.linear_density())),
            (112.0, &format!("{:.2} mm", yarn.diameter())),
            (132.0, &format!("{:.1} m", need.metres)),
            (155.0, &format!("{:.1} g", need.grams)),
        ]);
    }
    if design.yarns().len() > MOST_LISTED {
        list.line(&format!("… {} yarns in all", design.yarns().len()));
    }
}

/// Lines from the top of a page down, and on over further pages.
struct List<'b> {
    book: &'b mut Book,
    page: Option<Page>,
    title: String,
    /// Where the next line goes, above the lower margin.
    y: f32,
}

impl<'b> List<'b> {
    fn new(book: &'b mut Book, title: &str) -> Self {
        Self {
            book,
            page: None,
            title: title.to_owned(),
            y: 0.0,
        }
    }

    /// The page with room for `height` more.
    fn page(&mut self, height: f32) -> &mut Page {
        if self.y < height
            && let Some(full) = self.page.take()
        {
            self.book.add(full);
        }
        if self.page.is_none() {
            let top = self.book.room()[1];
            let mut page = self.book.page();
            page.ink(BLACK);
            page.text([MARGIN, MARGIN + top - 5.0], 5.0, true, &self.title);
            self.page = Some(page);
            self.y = top - 10.0;
        }
        let book = &self.book;
        self.page.get_or_insert_with(|| book.page())
    }

    fn heading(&mut self, text: &str) {
        self.page(4.0 * LINE);
        self.y -= 1.8 * LINE;
        let y = MARGIN + self.y;
        self.page(0.0).text([MARGIN, y], 3.6, true, text);
        self.y -= 0.3 * LINE;
    }

    fn columns(&mut self, texts: &[(f32, &str)]) {
        self.page(LINE);
        self.y -= LINE;
        let y = MARGIN + self.y;
        let page = self.page(0.0);
        for (x, text) in texts {
            page.text([MARGIN + x, y], TEXT, false, text);
        }
    }

    fn line(&mut self, text: &str) {
        self.columns(&[(0.0, text)]);
    }

    /// Words over as many lines as they take.
    fn paragraph(&mut self, text: &str) {
        let most = (self.book.room()[0] / (LETTER * TEXT)) as usize;
        let mut line = String::new();
        for word in text.split(' ') {
            if !line.is_empty() && line.chars().count() + word.chars().count() >= most {
                self.line(&line);
                line.clear();
            }
            line.extend([word, " "]);
        }
        self.line(line.trim_end());
    }

    /// The colour of what the next line says.
    fn swatch(&mut self, colour: Srgb) {
        self.page(LINE);
        let at = [MARGIN, MARGIN + self.y - LINE - 0.6];
        let page = self.page(0.0);
        page.ink(colour);
        page.filled(at, [6.0, 0.75 * LINE]);
        page.ink(GREY);
        page.framed(at, [6.0, 0.75 * LINE]);
        page.ink(BLACK);
    }

    fn finish(mut self) {
        if let Some(last) = self.page.take() {
            self.book.add(last);
        }
    }
}
