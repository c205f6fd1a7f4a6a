//! Print: a design as PDF, with its draft, its yarns and the cloth at true size.
//!
//! First what the weaver needs to dress the loom: threading, tie-up and treadling with their
//! numbers, then yarns, orders and heddles, then the cloth in its own size, cut into pages.
//! Text is set in Helvetica, which every reader has; signs outside
//! Windows-1252 become `?`, and hidden ones are written out.

mod cloth;
mod draft;
mod lists;
mod sheet;

use crate::design::{Design, WeavePattern};
use sheet::Book;

/// The size of the paper.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Paper {
    /// 210 × 297 mm.
    #[default]
    A4,
    /// 8½ × 11 in.
    Letter,
}

impl Paper {
    /// Width and height in mm.
    pub fn size_mm(self) -> [f32; 2] {
        match self {
            Self::A4 => [210.0, 297.0],
            Self::Letter => [215.9, 279.4],
        }
    }
}

/// A picture of the cloth, to be printed in its own size.
#[derive(Debug, Clone, Copy)]
pub struct Raster<'p> {
    /// Pixels across.
    pub width: u32,
    /// Pixels, row by row from the top, three bytes sRGB each.
    pub pixels: &'p [u8],
    /// How wide it is in mm.
    pub width_mm: f32,
}

/// What is printed.
#[derive(Debug, Clone, Copy)]
pub struct PdfOptions<'p> {
    /// On what.
    pub paper: Paper,
    /// Threading, tie-up, treadling and drawdown.
    pub draft: bool,
    /// Yarns, orders, heddles, sett.
    pub lists: bool,
    /// The cloth at true size.
    pub cloth: bool,
    /// Draft and cloth are turned by 180°: end 1 at the right, pick 1 at the top. The threads
    /// keep their numbers, and a [`PdfOptions::picture`] stays as it is.
    pub turned: bool,
    /// A picture of the cloth; without one it is drawn as its drawdown in colour.
    pub picture: Option<Raster<'p>>,
}

impl Default for PdfOptions<'_> {
    fn default() -> Self {
        Self {
            paper: Paper::default(),
            draft: true,
            lists: true,
            cloth: true,
            turned: false,
            picture: None,
        }
    }
}

/// A design that cannot be printed.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum PdfError {
    /// Nothing was asked for.
    #[error("nothing to print: choose the draft, the lists or the cloth")]
    Nothing,
    /// More pages than anybody wants.
    #[error("the {part} would take {pages} pages (the most is {most}): {remedy}")]
    TooManyPages {
        /// Draft or cloth.
        part: &'static str,
        /// Pages it would take.
        pages: u64,
        /// Pages allowed.
        most: u64,
        /// What to do instead.
        remedy: &'static str,
    },
    /// A picture whose pixels or size cannot be.
    #[error("the picture of the cloth {0}: give whole rows of pixels and a width in mm")]
    Picture(&'static str),
}

/// The pages of a design. `drawdown` is its weave.
///
/// # Errors
/// [`PdfError`].
pub fn write(
    design: &Design,
    drawdown: &WeavePattern,
    options: &PdfOptions<'_>,
) -> Result<Vec<u8>, PdfError> {
    let mut book = Book::new(options.paper);
    if options.draft {
        draft::pages(&mut book, design, drawdown, options.turned)?;
    }
    if options.lists {
        lists::pages(&mut book, design, drawdown);
    }
    if options.cloth {
        match &options.picture {
            Some(picture) => cloth::picture(&mut book, design, picture)?,
            None => cloth::drawn(&mut book, design, drawdown, options.turned)?,
        }
    }
    if book.is_empty() {
        return Err(PdfError::Nothing);
    }
    Ok(book.finish(&design.name))
}
