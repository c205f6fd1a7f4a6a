//! Pages to draw on in mm from the lower left corner, and the file made of them.

use encoding_rs::WINDOWS_1252;
use miniz_oxide::deflate::compress_to_vec_zlib;
use pdf_writer::{Content, Filter, Finish, Name, Pdf, Rect, Ref, Str, TextStr};

use super::Paper;
use crate::design::Srgb;
use crate::text::visible;

/// PDF points in a mm.
const POINTS: f32 = 72.0 / 25.4;
/// White border of every page in mm.
pub(super) const MARGIN: f32 = 15.0;
/// Ink of what is read first, and of the rest.
pub(super) const BLACK: Srgb = Srgb(0, 0, 0);
pub(super) const GREY: Srgb = Srgb(90, 90, 90);
/// Width of a digit of Helvetica over its size.
const DIGIT: f32 = 0.556;
/// Deflate's usual effort.
const EFFORT: u8 = 6;

/// A picture on a page, in pixels.
struct Image {
    width: u32,
    height: u32,
    /// Three bytes a pixel, deflated.
    pixels: Vec<u8>,
}

struct Finished {
    content: Vec<u8>,
    images: Vec<Image>,
}

/// The pages of a file.
pub(super) struct Book {
    paper: Paper,
    pages: Vec<Finished>,
}

impl Book {
    pub(super) fn new(paper: Paper) -> Self {
        let pages = Vec::new();
        Self { paper, pages }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.pages.is_empty()
    }

    /// Width and height within the margins in mm.
    pub(super) fn room(&self) -> [f32; 2] {
        self.paper.size_mm().map(|length| length - 2.0 * MARGIN)
    }

    /// A blank page.
    pub(super) fn page(&self) -> Page {
        let mut content = Content::new();
        content.set_line_width(0.4);
        Page {
            content,
            images: Vec::new(),
        }
    }

    pub(super) fn add(&mut self, page: Page) {
        let content = page.content.finish();
        self.pages.push(Finished {
            content: compress_to_vec_zlib(content.as_slice(), EFFORT),
            images: page.images,
        });
    }

    /// The file.
    pub(super) fn finish(self, title: &str) -> Vec<u8> {
        let mut next = 0;
        let mut id = || {
            next += 1;
            Ref::new(next)
        };
        let (catalog, tree, font, bold, about) = (id(), id(), id(), id(), id());
        let ids: Vec<(Ref, Ref, Vec<Ref>)> = self
            .pages
            .iter()
            .map(|page| (id(), id(), page.images.iter().map(|_| id()).collect()))
            .collect();
        let mut pdf = Pdf::new();
        pdf.catalog(catalog).pages(tree);
        let count = ids.len() as i32;
        pdf.pages(tree)
            .kids(ids.iter().map(|(page, _, _)| *page))
            .count(count);
        pdf.document_info(about)
            .title(TextStr(&visible(title)))
            .producer(TextStr("Pickglass"));
        for (font, name) in [(font, "Helvetica"), (bold, "Helvetica-Bold")] {
            pdf.type1_font(font)
                .base_font(Name(name.as_bytes()))
                .encoding_predefined(Name(b"WinAnsiEncoding"));
        }
        let [width, height] = self.paper.size_mm();
        let sheet = Rect::new(0.0, 0.0, width * POINTS, height * POINTS);
        for (page, (page_id, content_id, images)) in self.pages.iter().zip(&ids) {
            let mut written = pdf.page(*page_id);
            written.media_box(sheet).parent(tree).contents(*content_id);
            let mut resources = written.resources();
            resources
                .fonts()
                .pair(Name(b"F"), font)
                .pair(Name(b"B"), bold);
            let mut objects = resources.x_objects();
            for (place, image) in images.iter().enumerate() {
                objects.pair(Name(image_name(place).as_bytes()), *image);
            }
            objects.finish();
            resources.finish();
            written.finish();
            pdf.stream(*content_id, &page.content)
                .filter(Filter::FlateDecode);
            for (image, image_id) in page.images.iter().zip(images) {
                let mut written = pdf.image_xobject(*image_id, &image.pixels);
                written.filter(Filter::FlateDecode);
                written
                    .width(image.width as i32)
                    .height(image.height as i32);
                written.color_space().device_rgb();
                written.bits_per_component(8);
            }
        }
        pdf.finish()
    }
}

fn image_name(place: usize) -> String {
    format!("I{place}")
}

/// A page that is being drawn; all places and sizes in mm.
pub(super) struct Page {
    content: Content,
    images: Vec<Image>,
}

impl Page {
    /// A line of text with its left foot at a place.
    pub(super) fn text(&mut self, [x, y]: [f32; 2], size: f32, bold: bool, text: &str) {
        let font = if bold { Name(b"B") } else { Name(b"F") };
        self.content
            .begin_text()
            .set_font(font, size * POINTS)
            .next_line(x * POINTS, y * POINTS)
            .show(Str(&windows_1252(text)))
            .end_text();
    }

    /// A number in the middle of a place, as large as a cell allows.
    pub(super) fn number(&mut self, [x, y]: [f32; 2], cell: f32, number: u32) {
        let text = number.to_string();
        let digits = text.len() as f32;
        let size = (0.75 * cell).min(0.9 * cell / (DIGIT * digits));
        let at = [x - 0.5 * DIGIT * size * digits, y - 0.36 * size];
        self.text(at, size, false, &text);
    }

    /// Black, or another colour, for what is filled and written next.
    pub(super) fn ink(&mut self, Srgb(red, green, blue): Srgb) {
        let [red, green, blue] = [red, green, blue].map(|part| f32::from(part) / 255.0);
        self.content.set_fill_rgb(red, green, blue);
    }

    /// A filled box.
    pub(super) fn filled(&mut self, [x, y]: [f32; 2], [width, height]: [f32; 2]) {
        let [x, y, width, height] = [x, y, width, height].map(|length| length * POINTS);
        self.content.rect(x, y, width, height).fill_nonzero();
    }

    /// The outline of a box.
    pub(super) fn framed(&mut self, [x, y]: [f32; 2], [width, height]: [f32; 2]) {
        let [x, y, width, height] = [x, y, width, height].map(|length| length * POINTS);
        self.content.rect(x, y, width, height).stroke();
    }

    /// A grid of hairlines, every fourth one stronger.
    pub(super) fn grid(&mut self, [x, y]: [f32; 2], cell: f32, columns: u32, rows: u32) {
        let (width, height) = (cell * columns as f32, cell * rows as f32);
        for (strong, pen) in [(false, 0.15), (true, 0.5)] {
            self.content.set_line_width(pen);
            self.content.set_stroke_gray(if strong { 0.2 } else { 0.6 });
            let drawn =
                |place: &u32, last: u32| (place.is_multiple_of(4) || *place == last) == strong;
            for column in (0..=columns).filter(|place| drawn(place, columns)) {
                let x = (x + cell * column as f32) * POINTS;
                self.content
                    .move_to(x, y * POINTS)
                    .line_to(x, (y + height) * POINTS);
            }
            for row in (0..=rows).filter(|place| drawn(place, rows)) {
                let y = (y + cell * row as f32) * POINTS;
                self.content
                    .move_to(x * POINTS, y)
                    .line_to((x + width) * POINTS, y);
            }
            self.content.stroke();
        }
        self.content.set_stroke_gray(0.0).set_line_width(0.4);
    }

    /// A picture of `width` pixels a row (three bytes each, from the top) in a box.
    pub(super) fn image(&mut self, at: [f32; 2], size: [f32; 2], width: u32, pixels: &[u8]) {
        let height = (pixels.len() / 3) as u32 / width.max(1);
        let name = image_name(self.images.len());
        self.images.push(Image {
            width,
            height,
            pixels: compress_to_vec_zlib(pixels, EFFORT),
        });
        let [across, up, x, y] = [size[0], size[1], at[0], at[1]].map(|length| length * POINTS);
        self.content
            .save_state()
            .transform([across, 0.0, 0.0, up, x, y])
            .x_object(Name(name.as_bytes()))
            .restore_state();
    }
}

/// A text in Windows-1252, hidden signs written out; signs that it lacks become `?`.
fn windows_1252(text: &str) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(text.len());
    for sign in visible(text).chars() {
        let mut room = [0; 4];
        match WINDOWS_1252.encode(sign.encode_utf8(&mut room)) {
            (sign, _, false) => bytes.extend_from_slice(&sign),
            (_, _, true) => bytes.push(b'?'),
        }
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hidden_signs_are_written_out() {
        assert_eq!(
            windows_1252("Köper – \u{1b}[2J\u{202e}\n綾"),
            b"K\xf6per \x96 \\u{1b}[2J\\u{202e}\\n?"
        );
        let mut book = Book::new(Paper::A4);
        book.add(book.page());
        let file = book.finish("a\u{1b}b\u{202e}c");
        let has = |part: &[u8]| file.windows(part.len()).any(|at| at == part);
        // A title of ASCII alone is written as it is.
        assert!(has(b"u{1b}b") && has(b"u{202e}c") && !has(b"\x1b"));
    }
}
