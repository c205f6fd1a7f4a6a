//! The cloth at true size, cut into pages, with a ruler to check the print by.

use super::sheet::{BLACK, Book, GREY, MARGIN, Page};
use super::{PdfError, Raster};
use crate::design::{Design, Srgb, WeavePattern};

/// The most pages of cloth.
const MOST_PAGES: u64 = 40;
/// Heading and ruler, in mm.
const HEAD: f32 = 12.0;
const RULER: f32 = 10.0;
/// The most crossings on a page, beyond which several share a pixel.
const MOST_PIXELS: f32 = 4_000_000.0;

/// What of a page's width and height the cloth may take, in mm.
fn room(book: &Book) -> [f32; 2] {
    let [width, height] = book.room();
    [width, height - HEAD - RULER]
}

/// Refuses more pages than anybody prints.
fn count(across: u64, along: u64) -> Result<u64, PdfError> {
    match across.saturating_mul(along) {
        pages if pages <= MOST_PAGES => Ok(pages),
        pages => Err(PdfError::TooManyPages {
            part: "cloth",
            pages,
            most: MOST_PAGES,
            remedy: "print the draft and the lists without it, or crop the design",
        }),
    }
}

/// The drawdown in colour: the yarn on top of each crossing. A design smaller than a page is
/// repeated over one.
pub(super) fn drawn(
    book: &mut Book,
    design: &Design,
    drawdown: &WeavePattern,
    turned: bool,
) -> Result<(), PdfError> {
    let [width, height] = room(book);
    let pitch = [
        design.sett().ends.mean_pitch_mm(),
        design.sett().picks.mean_pitch_mm(),
    ];
    // Whole crossings on each page.
    let fit = |room: f32, pitch: f32| ((room / pitch) as u32).max(1);
    let (across, along) = (fit(width, pitch[0]), fit(height, pitch[1]));
    let columns = design.ends().div_ceil(across);
    let rows = design.picks().div_ceil(along);
    let pages = count(u64::from(columns), u64::from(rows))?;
    let (mut ends, mut picks) = (design.ends(), design.picks());
    if pages == 1 {
        (ends, picks) = (across, along);
    }
    let mut number = 0;
    // From the top left, so that the last sheets take what is left over.
    for row in 0..rows {
        for column in 0..columns {
            number += 1;
            let left = column * across;
            let size = (across.min(ends - left), along.min(picks - row * along));
            let first = (left, picks - row * along - size.1);
            let step = (size.0 as f32 * size.1 as f32 / MOST_PIXELS)
                .sqrt()
                .ceil()
                .max(1.0) as u32;
            let pixels = (size.0.div_ceil(step), size.1.div_ceil(step));
            let mut colours = Vec::with_capacity(3 * pixels.0 as usize * pixels.1 as usize);
            for up in (0..pixels.1).rev() {
                for right in 0..pixels.0 {
                    let (mut end, mut pick) = (first.0 + right * step, first.1 + up * step);
                    if turned {
                        (end, pick) = (ends - 1 - end, picks - 1 - pick);
                    }
                    let (end, pick) = (i64::from(end), i64::from(pick));
                    let Srgb(red, green, blue) = colour(design, drawdown, end, pick);
                    colours.extend([red, green, blue]);
                }
            }
            let mut page = book.page();
            let top = heading(&mut page, book, design, number, pages);
            let size = [size.0 as f32 * pitch[0], size.1 as f32 * pitch[1]];
            let at = [MARGIN, MARGIN + top - size[1]];
            page.image(at, size, pixels.0, &colours);
            page.framed(at, size);
            ruler(&mut page);
            book.add(page);
        }
    }
    Ok(())
}

/// The colour of the yarn on top; white where there is no cloth.
fn colour(design: &Design, drawdown: &WeavePattern, end: i64, pick: i64) -> Srgb {
    let (ends, picks) = (design.ends(), design.picks());
    match design.lattice().wrap(end, pick, ends, picks) {
        None => Srgb(255, 255, 255),
        Some((e, p)) if drawdown.get(e, p) => design.yarn(design.warp_yarn(end, pick)).colour,
        Some(_) => design.yarn(design.weft_yarn(end, pick)).colour,
    }
}

/// A picture of the cloth, cut into pages from its top left.
pub(super) fn picture(
    book: &mut Book,
    design: &Design,
    picture: &Raster<'_>,
) -> Result<(), PdfError> {
    let row_bytes = 3 * picture.width as usize;
    if row_bytes == 0
        || picture.pixels.is_empty()
        || !picture.pixels.len().is_multiple_of(row_bytes)
    {
        return Err(PdfError::Picture("has no whole rows"));
    }
    let pixel = picture.width_mm / picture.width as f32;
    if !(pixel.is_finite() && pixel > 1e-6) {
        return Err(PdfError::Picture("has no size"));
    }
    let height = picture.pixels.len() / row_bytes;
    let [wide, high] = room(book);
    if pixel > wide.min(high) {
        return Err(PdfError::Picture("has pixels larger than a page"));
    }
    let fit = |room: f32| ((room / pixel) as usize).max(1);
    let (across, along) = (fit(wide), fit(high));
    let width = picture.width as usize;
    let pages = count(width.div_ceil(across) as u64, height.div_ceil(along) as u64)?;
    let mut number = 0;
    for from in (0..height).step_by(along) {
        for left in (0..width).step_by(across) {
            number += 1;
            let (columns, rows) = (across.min(width - left), along.min(height - from));
            let mut part = Vec::with_capacity(3 * columns * rows);
            for row in from..from + rows {
                let start = row * row_bytes + 3 * left;
                part.extend_from_slice(&picture.pixels[start..start + 3 * columns]);
            }
            let mut page = book.page();
            let top = heading(&mut page, book, design, number, pages);
            let size = [columns as f32 * pixel, rows as f32 * pixel];
            page.image(
                [MARGIN, MARGIN + top - size[1]],
                size,
                columns as u32,
                &part,
            );
            ruler(&mut page);
            book.add(page);
        }
    }
    Ok(())
}

/// What is on the page; gives the height left below it.
fn heading(page: &mut Page, book: &Book, design: &Design, number: u64, pages: u64) -> f32 {
    let top = book.room()[1];
    page.ink(BLACK);
    page.text([MARGIN, MARGIN + top - 5.0], 5.0, true, &design.name);
    page.ink(GREY);
    let mut line = "The cloth at true size: print at 100 %".to_owned();
    if pages > 1 {
        line += &format!(", sheet {number} of {pages}");
    }
    page.text([MARGIN, MARGIN + top - 9.5], 3.0, false, &line);
    top - HEAD
}

/// Five centimetres, to be measured on the print.
fn ruler(page: &mut Page) {
    page.ink(BLACK);
    for centimetre in 0..5 {
        let at = [MARGIN + 10.0 * centimetre as f32, MARGIN];
        match centimetre % 2 {
            0 => page.filled(at, [10.0, 1.5]),
            _ => page.framed(at, [10.0, 1.5]),
        }
    }
    page.text([MARGIN + 52.0, MARGIN], 3.0, false, "5 cm");
}
