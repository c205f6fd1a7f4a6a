//! What is drawn over the drawdown's tiles: shaded edges of the threads, grid lines,
//! rulers, ghosts, crosshair, floats and the selection.

use egui::{Align2, Color32, FontId, Mesh, Painter, Rect, Shape, Stroke, pos2, vec2};
use pickglass::design::{ClothBox, Design, Structure, WeavePattern, long_floats_in};
use pickglass::edit::{Cells, Document, Rect as Crossings};

use super::super::action::Mark;
use super::super::laid;
use super::areas::Areas;
use super::grid::{CellGrid, ruler_step};
use crate::tokens::{self, Palette};

/// Grid lines are drawn between cells of at least so many pixels.
const LINES_FROM: f64 = 6.0;
/// The edges of threads are shaded from so many pixels a cell on.
const SHADED_FROM: f64 = 10.0;
/// Long floats, and strokes that are asked about, are drawn from so many pixels a cell on.
const FLOATS_FROM: f64 = 2.0;
/// Share of a cell that a shaded edge takes.
const EDGE: f64 = 0.13;

/// A box of crossings of the endless cloth, kept within what can be seen.
fn visible(grid: &CellGrid) -> ClothBox {
    let [ends, picks] = grid.visible();
    ClothBox {
        end: *ends.start(),
        pick: *picks.start(),
        ends: (ends.end() - ends.start() + 1).clamp(0, 1 << 20) as u32,
        picks: (picks.end() - picks.start() + 1).clamp(0, 1 << 20) as u32,
    }
}

/// The shaded edges of the threads on top, so that equal colours can be told apart and
/// floats are seen to run on. `None` where cells are too small for them.
pub fn thread_edges(grid: &CellGrid, design: &Design, drawdown: &WeavePattern) -> Option<Mesh> {
    if grid.cell < SHADED_FROM {
        return None;
    }
    let edge = ((grid.cell * EDGE).round().max(1.0) / grid.density) as f32;
    let seen = visible(grid);
    let (ends, picks) = (drawdown.ends(), drawdown.picks());
    let lattice = design.lattice();
    let up = |end, pick| {
        let (end, pick) = lattice.wrap(end, pick, ends, picks)?;
        Some(drawdown.get(end, pick))
    };
    let mut mesh = Mesh::default();
    let mut strip = |rect: Rect| mesh.add_colored_rect(rect, tokens::THREAD_EDGE);
    let (past_end, past_pick) = (
        seen.end + i64::from(seen.ends),
        seen.pick + i64::from(seen.picks),
    );
    // One strip along each side of a run: a run is one thread passing over others.
    for end in seen.end..past_end {
        runs(
            seen.pick,
            past_pick,
            |pick| up(end, pick) == Some(true),
            |from, to| {
                let run = grid.rect(end, from, 1, to - from);
                strip(run.with_max_x(run.left() + edge));
                strip(run.with_min_x(run.right() - edge));
            },
        );
    }
    for pick in seen.pick..past_pick {
        runs(
            seen.end,
            past_end,
            |end| up(end, pick) == Some(false),
            |from, to| {
                let run = grid.rect(from, pick, to - from, 1);
                strip(run.with_max_y(run.top() + edge));
                strip(run.with_min_y(run.bottom() - edge));
            },
        );
    }
    Some(mesh)
}

/// Gives the maximal runs from..to of `first..past` on which `is` holds.
fn runs(first: i64, past: i64, is: impl Fn(i64) -> bool, mut put: impl FnMut(i64, i64)) {
    let mut start = None;
    for at in first..=past {
        match (at < past && is(at), start) {
            (true, None) => start = Some(at),
            (false, Some(from)) => {
                put(from, at);
                start = None;
            }
            _ => {}
        }
    }
}

/// Lines between cells, stronger each fourth and eighth.
pub fn grid_lines(painter: &Painter, grid: &CellGrid) {
    if grid.cell < LINES_FROM {
        return;
    }
    let mut mesh = Mesh::default();
    let pixel = grid.pixel();
    let [ends, picks] = grid.visible();
    for end in ends {
        let line = Rect::from_min_size(
            pos2(grid.line_x(end), grid.pane.top()),
            vec2(pixel, grid.pane.height()),
        );
        mesh.add_colored_rect(line, line_colour(end));
    }
    for pick in picks {
        let line = Rect::from_min_size(
            pos2(grid.pane.left(), grid.line_y(pick)),
            vec2(grid.pane.width(), pixel),
        );
        mesh.add_colored_rect(line, line_colour(pick));
    }
    painter.add(Shape::mesh(mesh));
}

fn line_colour(thread: i64) -> Color32 {
    match thread {
        thread if thread % 8 == 0 => tokens::GRID_LINE_STRONGEST,
        thread if thread % 4 == 0 => tokens::GRID_LINE_STRONG,
        _ => tokens::GRID_LINE,
    }
}

/// Fades what is not the first repeat, colours included, and frames the weave's.
pub fn ghosts(painter: &Painter, grid: &CellGrid, design: &Design, shown: bool, palette: &Palette) {
    let home = grid.rect(0, 0, i64::from(design.ends()), i64::from(design.picks()));
    let (ends, picks) = laid::whole(design);
    let pane = grid.pane;
    let veil = if shown {
        palette.deep.gamma_multiply(0.6)
    } else {
        palette.deep
    };
    let inner = grid.rect(0, 0, ends.into(), picks.into()).intersect(pane);
    if inner.is_positive() {
        for rect in [
            pane.with_max_y(inner.top()),
            pane.with_min_y(inner.bottom()),
            Rect::from_min_max(
                pos2(pane.left(), inner.top()),
                pos2(inner.left(), inner.bottom()),
            ),
            Rect::from_min_max(
                pos2(inner.right(), inner.top()),
                pos2(pane.right(), inner.bottom()),
            ),
        ] {
            if rect.is_positive() {
                painter.rect_filled(rect, 0.0, veil);
            }
        }
    } else {
        painter.rect_filled(pane, 0.0, veil);
    }
    // A light and a dark line: one of them is seen on any yarn.
    let pixel = grid.pixel();
    for (by, colour) in [(pixel, palette.focus_edge), (0.0, palette.text)] {
        let stroke = Stroke::new(pixel, colour);
        painter.rect_stroke(home.expand(by), 0.0, stroke, egui::StrokeKind::Outside);
    }
}

/// Marks the floats that pass over more threads than allowed: a bar along each, with
/// knobs at its ends, so that colour is not the only sign.
pub fn long_floats(
    painter: &Painter,
    grid: &CellGrid,
    design: &Design,
    drawdown: &WeavePattern,
    limits: [u32; 2],
    palette: &Palette,
) {
    if grid.cell < FLOATS_FROM {
        return;
    }
    let mut mesh = Mesh::default();
    let thick = ((grid.cell * 0.22).round().max(1.0) / grid.density) as f32;
    let found = long_floats_in(
        drawdown,
        design.lattice(),
        visible(grid),
        limits[0],
        limits[1],
    );
    for float in found {
        let length = i64::from(float.length);
        let (ends, picks) = if float.warp { (1, length) } else { (length, 1) };
        let rect = grid.rect(float.end, float.pick, ends, picks);
        let bar = if float.warp {
            Rect::from_center_size(rect.center(), vec2(thick, rect.height() - thick))
        } else {
            Rect::from_center_size(rect.center(), vec2(rect.width() - thick, thick))
        };
        mesh.add_colored_rect(bar.expand(grid.pixel()), palette.deep);
        mesh.add_colored_rect(bar, palette.error);
        if grid.cell >= LINES_FROM {
            let (from, to) = if float.warp {
                (bar.center_top(), bar.center_bottom())
            } else {
                (bar.left_center(), bar.right_center())
            };
            for end in [from, to] {
                let knob = Rect::from_center_size(end, vec2(2.2 * thick, 2.2 * thick));
                mesh.add_colored_rect(knob, palette.error);
            }
        }
    }
    painter.add(Shape::mesh(mesh));
}

/// What a stroke painted and is yet to be asked about: black where the warp is to be up,
/// else white.
pub fn held_back(painter: &Painter, grid: &CellGrid, design: &Design, cells: &Cells, up: bool) {
    if grid.cell < FLOATS_FROM {
        return;
    }
    let mut mesh = Mesh::default();
    let colour = if up { Color32::BLACK } else { Color32::WHITE };
    let (ends, picks) = cells.size();
    let seen = visible(grid);
    let (past_end, past_pick) = (
        seen.end + i64::from(seen.ends),
        seen.pick + i64::from(seen.picks),
    );
    let held = |end, pick| {
        let home = design.lattice().wrap(end, pick, ends, picks);
        home.is_some_and(|(end, pick)| cells.contains(end, pick))
    };
    for pick in seen.pick..past_pick {
        runs(
            seen.end,
            past_end,
            |end| held(end, pick),
            |from, to| mesh.add_colored_rect(grid.rect(from, pick, to - from, 1), colour),
        );
    }
    painter.add(Shape::mesh(mesh));
}

/// The selected crossings: a light and a dark line, seen on any colour.
pub fn selection(painter: &Painter, grid: &CellGrid, selected: Crossings) {
    let rect = grid.rect(
        i64::from(selected.end),
        i64::from(selected.pick),
        i64::from(selected.ends),
        i64::from(selected.picks),
    );
    outline(painter, rect);
}

/// A frame that is seen on any colour.
pub fn outline(painter: &Painter, rect: Rect) {
    let inside = egui::StrokeKind::Inside;
    painter.rect_stroke(
        rect.expand(2.0),
        0.0,
        Stroke::new(1.0, Color32::WHITE),
        inside,
    );
    painter.rect_stroke(
        rect.expand(1.0),
        0.0,
        Stroke::new(2.0, tokens::ACCENT),
        inside,
    );
}

/// Makes something easy to find: all else is veiled, or it is framed.
pub fn mark(painter: &Painter, grid: &CellGrid, document: &Document, mark: Mark) {
    let (design, drawdown) = (document.design(), document.drawdown());
    let (ends, picks) = (drawdown.ends(), drawdown.picks());
    if let Mark::Float {
        end,
        pick,
        ends,
        picks,
    } = mark
    {
        let rect = grid.rect(end.into(), pick.into(), ends.into(), picks.into());
        outline(painter, rect);
        return;
    }
    if mark == Mark::Nothing {
        return;
    }
    let is_marked = |end: i64, pick: i64| {
        let (e, p) = design.lattice().wrap(end, pick, ends, picks)?;
        Some(match (mark, design.structure()) {
            (Mark::Yarn(yarn), _) if drawdown.get(e, p) => design.warp_yarn(end, pick) == yarn,
            (Mark::Yarn(yarn), _) => design.weft_yarn(end, pick) == yarn,
            (Mark::Region(region), Structure::Regions(regions)) => {
                regions.map().get(e, p) == region
            }
            _ => true,
        })
    };
    let seen = visible(grid);
    // From afar a pixel shows what its first crossing is.
    let step = (1.0 / grid.cell).ceil().max(1.0) as i64;
    let count = |threads: u32| (i64::from(threads) + step - 1) / step;
    let mut mesh = Mesh::default();
    for row in 0..count(seen.picks) {
        let pick = seen.pick + row * step;
        runs(
            0,
            count(seen.ends),
            |column| is_marked(seen.end + column * step, pick) == Some(false),
            |from, to| {
                let (end, ends) = (seen.end + from * step, (to - from) * step);
                mesh.add_colored_rect(grid.rect(end, pick, ends, step), tokens::VEIL);
            },
        );
    }
    painter.add(Shape::mesh(mesh));
}

/// Row and column of a crossing, through the drawdown and the bands beside it.
pub fn crosshair(painter: &Painter, grid: &CellGrid, areas: &Areas, (end, pick): (i64, i64)) {
    let cell = grid.rect(end, pick, 1, 1);
    let reach = areas.drawdown.union(areas.warp_bar).union(areas.weft_bar);
    let reach = reach.union(areas.pick_ruler).union(areas.end_ruler);
    let column = Rect::from_x_y_ranges(cell.x_range(), reach.y_range());
    let row = Rect::from_x_y_ranges(reach.x_range(), cell.y_range());
    let down = areas.drawdown;
    if cell.left() < down.right() && cell.right() > down.left() {
        painter.rect_filled(column.intersect(reach), 0.0, tokens::CROSSHAIR);
    }
    if cell.top() < down.bottom() && cell.bottom() > down.top() {
        painter.rect_filled(row.intersect(reach), 0.0, tokens::CROSSHAIR);
    }
}

/// The numbers of ends and picks, counted from 1 over the repeat of the colours.
pub fn rulers(
    painter: &Painter,
    grid: &CellGrid,
    areas: &Areas,
    design: &Design,
    hover: Option<(i64, i64)>,
    palette: &Palette,
) {
    let font = FontId::proportional(tokens::TEXT_SMALL);
    let (ends, picks) = laid::whole(design);
    let (ends, picks) = (i64::from(ends), i64::from(picks));
    let [seen_ends, seen_picks] = grid.visible();
    let density = grid.density;

    let numbered = |number, count, width| is_numbered(number, count, grid.cell, width * density);
    let label = |ruler: Rect, at, anchor: Align2, number: i64, here: bool| {
        let colour = if here { palette.text } else { palette.quiet };
        let text = painter.layout_no_wrap(number.to_string(), font.clone(), colour);
        let place = anchor.anchor_size(at, text.size());
        if let Some(place) = on_ruler(ruler, place, here) {
            painter.galley(place.min, text, colour);
        }
    };
    for end in seen_ends {
        let number = end.rem_euclid(ends) + 1;
        let here = hover.is_some_and(|(at, _)| at == end) && grid.cell >= LINES_FROM;
        let near = hover.is_some_and(|(at, _)| {
            ((at - end).abs() as f64) * grid.cell < 26.0 * density && at != end
        });
        if !here && (near && grid.cell >= LINES_FROM || !numbered(number, ends, 34.0)) {
            continue;
        }
        let middle = (grid.x(end) + grid.x(end + 1)) / 2.0;
        let at = pos2(middle, areas.end_ruler.center().y);
        label(areas.end_ruler, at, Align2::CENTER_CENTER, number, here);
    }

    for pick in seen_picks {
        let number = pick.rem_euclid(picks) + 1;
        let here = hover.is_some_and(|(_, at)| at == pick) && grid.cell >= LINES_FROM;
        let near = hover.is_some_and(|(_, at)| {
            ((at - pick).abs() as f64) * grid.cell < 12.0 * density && at != pick
        });
        if !here && (near && grid.cell >= LINES_FROM || !numbered(number, picks, 16.0)) {
            continue;
        }
        let middle = (grid.y(pick) + grid.y(pick + 1)) / 2.0;
        let at = pos2(areas.pick_ruler.right() - tokens::GRID, middle);
        label(areas.pick_ruler, at, Align2::RIGHT_CENTER, number, here);
    }
}

/// Where a number stands on its ruler: half a number would be another one, so what does not
/// fit is left out, but the one under the pointer is moved inside.
fn on_ruler(ruler: Rect, place: Rect, here: bool) -> Option<Rect> {
    let room = ruler.expand(0.5);
    if room.contains_rect(place) {
        return Some(place);
    }
    let into = |low: f32, high: f32, least: f32, most: f32| {
        if low < least {
            least - low
        } else {
            (most - high).min(0.0)
        }
    };
    let by = vec2(
        into(place.left(), place.right(), ruler.left(), ruler.right()),
        into(place.top(), place.bottom(), ruler.top(), ruler.bottom()),
    );
    here.then(|| place.translate(by))
}

/// Whether a ruler shows this number of `count`: each 1, and steps as far apart as a number
/// of `width` pixels needs, where the next repeat's 1 is no nearer.
fn is_numbered(number: i64, count: i64, cell: f64, width: f64) -> bool {
    let to_next = (count + 1 - number) as f64 * cell;
    number == 1 || (number % ruler_step(cell, width) == 0 && to_next >= width)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_a_ruler_keep_apart_over_the_repeats_edge() {
        let shown = |count: i64| -> Vec<i64> {
            (1..=count)
                .filter(|&number| is_numbered(number, count, 3.0, 34.0))
                .collect()
        };
        assert_eq!(shown(120), [1, 20, 40, 60, 80, 100]);
        assert_eq!(shown(132), [1, 20, 40, 60, 80, 100, 120]);
        assert_eq!(shown(8), [1]);
    }

    #[test]
    fn no_number_of_a_ruler_is_cut() {
        let ruler = Rect::from_min_size(pos2(100.0, 10.0), vec2(200.0, 18.0));
        let number = |left: f32| Rect::from_min_size(pos2(left, 12.0), vec2(20.0, 14.0));
        assert_eq!(on_ruler(ruler, number(140.0), false), Some(number(140.0)));
        assert_eq!(on_ruler(ruler, number(95.0), false), None);
        assert_eq!(on_ruler(ruler, number(290.0), false), None);
        assert_eq!(on_ruler(ruler, number(95.0), true), Some(number(100.0)));
        assert_eq!(on_ruler(ruler, number(290.0), true), Some(number(280.0)));
    }

    #[test]
    fn runs_are_whole_and_apart() {
        let mut found = Vec::new();
        runs(
            0,
            8,
            |at| [0, 1, 4, 6, 7].contains(&at),
            |from, to| found.push((from, to)),
        );
        assert_eq!(found, [(0, 2), (4, 5), (6, 8)]);
    }
}
