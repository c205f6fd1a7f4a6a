//! The draft on paper: threading above the drawdown, tie-up at the corner, treadling beside.
//!
//! Cells are as large as the page allows, at most 4 mm; a draft that is larger than a page
//! goes on over several, each with its part of the threading and the treadling.

use super::PdfError;
use super::sheet::{BLACK, Book, GREY, MARGIN, Page};
use crate::design::{Design, Draft, Lifting, Loom, Shed, Structure, Ties, WeavePattern, derive};

/// The most pages of drafts.
const MOST_PAGES: u64 = 60;
/// Looms with more shafts are not drawn as shaft drafts.
const MOST_SHAFTS: u32 = 40;
/// The largest and the smallest cell in mm.
const CELLS: [f32; 2] = [4.0, 2.0];
/// Heading above and numbers beside, in mm.
const HEAD: f32 = 16.0;
const BESIDE: f32 = 7.0;

/// Threading and lifting as they are drawn; empty for a drawdown alone.
struct Drawn {
    draft: Option<Draft>,
    derived: bool,
}

impl Drawn {
    fn of(design: &Design, drawdown: &WeavePattern) -> Self {
        let drawable = |draft: &Draft| draft.shafts().max(columns(draft)) <= MOST_SHAFTS;
        let (draft, derived) = match design.structure() {
            Structure::Draft(draft) => (Some(draft.clone()), false),
            _ => {
                let loom = Loom {
                    shafts: MOST_SHAFTS,
                    treadles: MOST_SHAFTS,
                    dobby: true,
                };
                (derive(drawdown, &loom).ok(), true)
            }
        };
        let draft = draft.filter(drawable);
        Self { draft, derived }
    }

    /// Rows above the drawdown and columns beside it, with a cell between.
    fn around(&self) -> (u32, u32) {
        match &self.draft {
            Some(draft) => (draft.shafts() + 1, columns(draft) + 1),
            None => (0, 0),
        }
    }
}

/// Treadles, or shafts of a lift plan.
fn columns(draft: &Draft) -> u32 {
    match draft.lifting() {
        Lifting::Treadled { .. } => draft.treadles(),
        Lifting::LiftPlan(_) => draft.shafts(),
    }
}

/// The pages of the draft.
pub(super) fn pages(
    book: &mut Book,
    design: &Design,
    drawdown: &WeavePattern,
    turned: bool,
) -> Result<(), PdfError> {
    let drawn = Drawn::of(design, drawdown);
    let (above, beside) = drawn.around();
    let [width, height] = book.room();
    let (wide, high) = (width - BESIDE, height - HEAD - BESIDE);
    let (ends, picks) = (design.ends(), design.picks());
    let whole = (wide / (ends + beside) as f32).min(high / (picks + above) as f32);
    let cell = whole.clamp(CELLS[1], CELLS[0]);
    let fit = |room: f32, taken: u32| {
        let fit = (room / cell + 1e-3) as u32;
        // Whole groups of four, so that strong lines stay where they are.
        (fit.saturating_sub(taken) / 4 * 4).max(4)
    };
    let (across, along) = (fit(wide, beside).max(1), fit(high, above).max(1));
    let (columns, rows) = (ends.div_ceil(across), picks.div_ceil(along));
    let pages = u64::from(columns) * u64::from(rows);
    if pages > MOST_PAGES {
        return Err(PdfError::TooManyPages {
            part: "draft",
            pages,
            most: MOST_PAGES,
            remedy: "print the lists and the cloth without it, or crop the design to a repeat",
        });
    }
    for row in 0..rows {
        for column in 0..columns {
            let part = Part {
                first: (column * across, row * along),
                size: (
                    across.min(ends - column * across),
                    along.min(picks - row * along),
                ),
                cell,
                turned,
            };
            let mut page = book.page();
            heading(&mut page, height, design, &drawn, &part, pages);
            part.draw(&mut page, height - HEAD, drawdown, &drawn);
            book.add(page);
        }
    }
    Ok(())
}

fn heading(page: &mut Page, height: f32, design: &Design, drawn: &Drawn, part: &Part, pages: u64) {
    page.ink(BLACK);
    page.text([MARGIN, MARGIN + height - 5.0], 5.0, true, &design.name);
    let (ends, picks) = (design.ends(), design.picks());
    let mut line = format!("{ends} ends × {picks} picks");
    match &drawn.draft {
        Some(draft) => {
            let columns = columns(draft);
            line += &match draft.lifting() {
                Lifting::Treadled { .. } => {
                    format!(", {} shafts, {columns} treadles", draft.shafts())
                }
                Lifting::LiftPlan(_) => format!(", {} shafts, lift plan", draft.shafts()),
            };
            line += match draft.shed() {
                Shed::Rising => ", rising shed",
                Shed::Sinking => ", sinking shed",
            };
            if drawn.derived {
                line += ", derived from the drawdown";
            }
        }
        None => line += ", drawdown (too many shafts for a shaft draft)",
    }
    if pages > 1 {
        let ((end, pick), (ends, picks)) = (part.first, part.size);
        line += &format!(
            "; here ends {} to {}, picks {} to {}",
            end + 1,
            end + ends,
            pick + 1,
            pick + picks
        );
    }
    page.ink(GREY);
    page.text([MARGIN, MARGIN + height - 10.0], 3.0, false, &line);
}

/// What one page shows.
struct Part {
    /// Its first end and pick.
    first: (u32, u32),
    /// Its ends and picks.
    size: (u32, u32),
    /// Side of a cell in mm.
    cell: f32,
    /// The first end is the last column from the left, the first pick the top row.
    turned: bool,
}

impl Part {
    /// Draws below `top` mm above the margin.
    fn draw(&self, page: &mut Page, top: f32, drawdown: &WeavePattern, drawn: &Drawn) {
        let (above, _) = drawn.around();
        let ((ends, picks), cell) = (self.size, self.cell);
        let left = MARGIN;
        let bottom = MARGIN + top - cell * (above + picks) as f32;
        page.ink(BLACK);
        for row in 0..picks {
            for column in 0..ends {
                if drawdown.get(self.first.0 + column, self.first.1 + row) {
                    let (column, row) = (self.column(column), self.row(row));
                    self.mark(page, [left, bottom], column, row);
                }
            }
        }
        page.grid([left, bottom], cell, ends, picks);
        if let Some(draft) = &drawn.draft {
            self.threading(page, [left, bottom + cell * (picks + 1) as f32], draft);
            let beside = left + cell * (ends + 1) as f32;
            self.lifting(page, [beside, bottom], draft);
        }
        self.numbers(page, [left, bottom], drawn);
    }

    /// The column, from the left, of an end of this part.
    fn column(&self, end: u32) -> u32 {
        match self.turned {
            true => self.size.0 - 1 - end,
            false => end,
        }
    }

    /// The row, from below, of a pick of this part.
    fn row(&self, pick: u32) -> u32 {
        match self.turned {
            true => self.size.1 - 1 - pick,
            false => pick,
        }
    }

    /// Fills a cell of a grid.
    fn mark(&self, page: &mut Page, [x, y]: [f32; 2], column: u32, row: u32) {
        let at = [x + self.cell * column as f32, y + self.cell * row as f32];
        page.filled(at, [self.cell; 2]);
    }

    /// Writes a number into a cell of a grid.
    fn write(&self, page: &mut Page, [x, y]: [f32; 2], column: u32, row: u32, number: u32) {
        let middle = |from: f32, place: u32| from + self.cell * (place as f32 + 0.5);
        page.number([middle(x, column), middle(y, row)], self.cell, number);
    }

    /// Shaft 1 next to the cloth; each cell says its shaft.
    fn threading(&self, page: &mut Page, at: [f32; 2], draft: &Draft) {
        for end in 0..self.size.0 {
            for &shaft in draft.threading().row((self.first.0 + end) as usize) {
                let shaft = u32::from(shaft);
                self.write(page, at, self.column(end), shaft, shaft + 1);
            }
        }
        page.grid(at, self.cell, self.size.0, draft.shafts());
    }

    /// Treadling beside the cloth and tie-up above it, or the lift plan.
    fn lifting(&self, page: &mut Page, [x, y]: [f32; 2], draft: &Draft) {
        let picks = self.size.1;
        let columns = columns(draft);
        let rows: &Ties = match draft.lifting() {
            Lifting::Treadled { treadling, .. } => treadling,
            Lifting::LiftPlan(plan) => plan,
        };
        for pick in 0..picks {
            for &treadle in rows.row((self.first.1 + pick) as usize) {
                let treadle = u32::from(treadle);
                self.write(page, [x, y], treadle, self.row(pick), treadle + 1);
            }
        }
        page.grid([x, y], self.cell, columns, picks);
        let corner = [x, y + self.cell * (picks + 1) as f32];
        if let Lifting::Treadled { tieup, .. } = draft.lifting() {
            for (treadle, tied) in tieup.iter().enumerate() {
                for &shaft in tied {
                    let shaft = u32::from(shaft);
                    self.write(page, corner, treadle as u32, shaft, shaft + 1);
                }
            }
            page.grid(corner, self.cell, columns, draft.shafts());
        }
    }

    /// The numbers of every fourth end and pick, as everywhere.
    fn numbers(&self, page: &mut Page, [x, y]: [f32; 2], drawn: &Drawn) {
        page.ink(GREY);
        let (_, beside) = drawn.around();
        let shown = |number: u32| number.is_multiple_of(4) || number == 1;
        for end in 0..self.size.0 {
            let number = self.first.0 + end + 1;
            if shown(number) {
                let middle = x + self.cell * (self.column(end) as f32 + 0.5);
                page.number([middle, y - 2.0], 3.0, number);
            }
        }
        let right = x + self.cell * (self.size.0 + beside) as f32 + 3.5;
        for pick in 0..self.size.1 {
            let number = self.first.1 + pick + 1;
            if shown(number) {
                let middle = y + self.cell * (self.row(pick) as f32 + 0.5);
                page.number([right, middle], 3.0, number);
            }
        }
        page.ink(BLACK);
    }
}
