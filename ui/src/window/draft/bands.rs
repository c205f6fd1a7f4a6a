//! Threading, tie-up, treadling and the colour bars: where their cells lie, and which edit
//! a touch asks for.

use egui::Rect;
use pickglass::design::{Design, Direction, Draft, Lifting, Structure, YarnId};
use pickglass::edit::Edit;

use super::super::action::Button;
use super::areas::Areas;
use super::grid::CellGrid;
use super::zone::Cell;

/// A field beside the drawdown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Band {
    Threading,
    TieUp,
    Treadling,
    WarpBar,
    WeftBar,
}

impl Band {
    pub const ALL: [Self; 5] = [
        Self::Threading,
        Self::TieUp,
        Self::Treadling,
        Self::WarpBar,
        Self::WeftBar,
    ];

    /// What assistive technology calls it, and what the history calls a stroke in it.
    pub fn name(self, lift_plan: bool) -> &'static str {
        match self {
            Self::Threading => "Threading",
            Self::TieUp => "Tie-up",
            Self::Treadling if lift_plan => "Lift plan",
            Self::Treadling => "Treadling",
            Self::WarpBar => "Warp colours",
            Self::WeftBar => "Weft colours",
        }
    }

    /// One line for those who come from graphics.
    pub fn tip(self) -> &'static str {
        match self {
            Self::Threading => "Which shaft each end hangs on. Right click takes it off",
            Self::TieUp => "Which shafts each treadle lifts",
            Self::Treadling => "What is pressed or lifted for each pick",
            Self::WarpBar => "The yarn of each end; paints with the yarns chosen at the left",
            Self::WeftBar => "The yarn of each pick; paints with the yarns chosen at the left",
        }
    }

    /// Where it lies.
    pub fn rect(self, areas: &Areas) -> Rect {
        match self {
            Self::Threading => areas.threading,
            Self::TieUp => areas.tieup,
            Self::Treadling => areas.treadling,
            Self::WarpBar => areas.warp_bar,
            Self::WeftBar => areas.weft_bar,
        }
    }

    /// The cell under a point: (end, shaft), (treadle, shaft), (treadle, pick), (end, 0)
    /// or (0, pick). Ends and picks are of the endless cloth.
    pub fn cell(self, areas: &Areas, grid: &CellGrid, at: egui::Pos2) -> Cell {
        let (end, pick) = grid.crossing(at);
        match self {
            Self::Threading => (end, areas.shaft_at(at.y)),
            Self::TieUp => (areas.treadle_at(at.x), areas.shaft_at(at.y)),
            Self::Treadling => (areas.treadle_at(at.x), pick),
            Self::WarpBar => (end, 0),
            Self::WeftBar => (0, pick),
        }
    }

    /// The screen rectangle of a cell.
    pub fn place(self, areas: &Areas, grid: &CellGrid, (x, y): Cell) -> Rect {
        let size = areas.loom.map_or(0.0, |loom| loom.cell);
        let ends = || grid.rect(x, 0, 1, 1).x_range();
        let picks = || grid.rect(0, y, 1, 1).y_range();
        let shaft = || egui::Rangef::new(areas.shaft_top(y), areas.shaft_top(y) + size);
        let treadle = || egui::Rangef::new(areas.treadle_left(x), areas.treadle_left(x) + size);
        match self {
            Self::Threading => Rect::from_x_y_ranges(ends(), shaft()),
            Self::TieUp => Rect::from_x_y_ranges(treadle(), shaft()),
            Self::Treadling => Rect::from_x_y_ranges(treadle(), picks()),
            Self::WarpBar => Rect::from_x_y_ranges(ends(), areas.warp_bar.y_range()),
            Self::WeftBar => Rect::from_x_y_ranges(areas.weft_bar.x_range(), picks()),
        }
    }
}

/// The draft of a design that has one.
pub fn draft(design: &Design) -> Option<&Draft> {
    match design.structure() {
        Structure::Draft(draft) => Some(draft),
        _ => None,
    }
}

/// Whether a cell of a band is set.
pub fn is_set(design: &Design, band: Band, (x, y): Cell) -> bool {
    let Some(draft) = draft(design) else {
        return false;
    };
    let (x, y) = wrapped(draft, band, (x, y));
    let (Ok(x), Ok(y)) = (usize::try_from(x), usize::try_from(y)) else {
        return false;
    };
    let has = |row: &[u16], member: usize| row.iter().any(|&is| usize::from(is) == member);
    match (band, draft.lifting()) {
        (Band::Threading, _) => has(draft.threading().row(x), y),
        (Band::TieUp, Lifting::Treadled { tieup, .. }) => has(tieup.row(x), y),
        (Band::Treadling, Lifting::Treadled { treadling, .. }) => has(treadling.row(y), x),
        (Band::Treadling, Lifting::LiftPlan(plan)) => has(plan.row(y), x),
        _ => false,
    }
}

/// A cell brought home into the first repeat.
pub(super) fn wrapped(draft: &Draft, band: Band, (x, y): Cell) -> Cell {
    match band {
        Band::Threading => (x.rem_euclid(i64::from(draft.ends())), y),
        Band::Treadling => (x, y.rem_euclid(i64::from(draft.picks()))),
        _ => (x, y),
    }
}

/// The edit that sets or clears the cells of a stroke; `None` if none of them is there.
///
/// An end hangs on one shaft and a pick presses one treadle unless `more` is held, when
/// members are added; tie-ups and lift plans always add.
pub fn edit(design: &Design, band: Band, cells: &[Cell], set: bool, more: bool) -> Option<Edit> {
    let draft = draft(design)?;
    let lift_plan = matches!(draft.lifting(), Lifting::LiftPlan(_));
    let (columns, shafts) = match lift_plan {
        true => (draft.shafts(), draft.shafts()),
        false => (draft.treadles(), draft.shafts()),
    };
    let mut rows: std::collections::BTreeMap<u32, Vec<u16>> = Default::default();
    for &cell in cells {
        let (x, y) = wrapped(draft, band, cell);
        let (Ok(x), Ok(y)) = (u32::try_from(x), u32::try_from(y)) else {
            continue;
        };
        // `row` gets or loses `member`; a stroke past the edge does nothing.
        let (row, member, known) = match (band, draft.lifting()) {
            (Band::Threading, _) if y < shafts => (x, y, draft.threading().row(x as usize)),
            (Band::TieUp, Lifting::Treadled { tieup, .. }) if x < columns && y < shafts => {
                (x, y, tieup.row(x as usize))
            }
            (Band::Treadling, Lifting::Treadled { treadling, .. }) if x < columns => {
                (y, x, treadling.row(y as usize))
            }
            (Band::Treadling, Lifting::LiftPlan(plan)) if x < columns => {
                (y, x, plan.row(y as usize))
            }
            _ => continue,
        };
        let member = member as u16;
        let alone = !more && (band == Band::Threading || band == Band::Treadling && !lift_plan);
        let members = rows.entry(row).or_insert_with(|| known.to_vec());
        if set && alone {
            members.clear();
        }
        members.retain(|&is| is != member);
        if set {
            members.push(member);
        }
    }
    let rows: Vec<_> = rows.into_iter().collect();
    if rows.is_empty() {
        return None;
    }
    Some(match band {
        Band::Threading => Edit::Threading(rows),
        Band::TieUp => Edit::TieUp(rows),
        Band::Treadling if lift_plan => Edit::LiftPlan(rows),
        Band::Treadling => Edit::Treadling(rows),
        Band::WarpBar | Band::WeftBar => return None,
    })
}

/// The edit that gives the threads of a stroke on a colour bar a yarn. Colours may repeat
/// later than the weave, so threads are counted over both.
pub fn bar_edit(design: &Design, band: Band, cells: &[Cell], yarn: YarnId) -> Option<Edit> {
    let (ends, picks) = design.colour_repeat();
    let (direction, count) = match band {
        Band::WarpBar => (Direction::Warp, ends),
        Band::WeftBar => (Direction::Weft, picks),
        _ => return None,
    };
    let count = i64::from(u32::try_from(count).unwrap_or(u32::MAX));
    let thread = |&(end, pick): &Cell| {
        let at = if direction == Direction::Warp {
            end
        } else {
            pick
        };
        at.rem_euclid(count) as u32
    };
    Some(Edit::PaintThreads {
        direction,
        threads: cells.iter().map(thread).collect(),
        yarn,
    })
}

/// The yarn of a thread, where it has one along its length.
pub fn yarn_of(design: &Design, band: Band, (end, pick): Cell) -> YarnId {
    match band {
        Band::WeftBar => design.weft_yarn(end, pick),
        _ => design.warp_yarn(end, pick),
    }
}

/// Whether a stroke that begins here with this button sets cells or clears them.
pub fn sets(design: &Design, band: Band, cell: Cell, button: Button) -> bool {
    match (button, band) {
        (Button::Second, _) => false,
        (Button::First, Band::TieUp) => !is_set(design, band, cell),
        (Button::First, Band::Treadling) => {
            let lift_plan =
                draft(design).is_some_and(|draft| matches!(draft.lifting(), Lifting::LiftPlan(_)));
            !lift_plan || !is_set(design, band, cell)
        }
        (Button::First, _) => true,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::window::session::blank;

    #[test]
    fn a_stroke_in_the_threading_hangs_each_end_on_one_shaft() {
        let opened = blank().expect("a design");
        let cells = [(0, 3), (1, 2), (17, 0), (5, 9), (-1, 1)];
        let rows = match edit(&opened.design, Band::Threading, &cells, true, false) {
            Some(Edit::Threading(rows)) => rows,
            other => panic!("{other:?}"),
        };
        // 17 is end 1 of the next repeat; shaft 9 is not there; −1 is the last end.
        assert_eq!(rows, [(0, vec![3]), (1, vec![0]), (15, vec![1])]);
        let added = edit(&opened.design, Band::Threading, &[(0, 3)], true, true);
        assert!(matches!(added, Some(Edit::Threading(rows)) if rows == [(0, vec![0, 3])]));
    }

    #[test]
    fn a_bar_gives_the_thread_that_was_clicked_its_yarn() {
        let design = crate::opened::Opened::preset("default")
            .expect("a preset")
            .design;
        // The weave closes after 4 ends, the colours later.
        assert!(design.colour_repeat().0 > 4 && design.ends() == 4);
        let mut document = pickglass::edit::Document::new(Design::clone(&design));
        let edit = bar_edit(&design, Band::WarpBar, &[(10, 0), (-1, 0)], YarnId(2));
        document.apply(edit.expect("an edit")).expect("painted");
        let repeat = design.colour_repeat().0 as i64;
        for end in 0..repeat {
            let expected = match end {
                10 => YarnId(2),
                last if last == repeat - 1 => YarnId(2),
                _ => design.warp_yarn(end, 0),
            };
            assert_eq!(document.design().warp_yarn(end, 0), expected, "{end}");
        }
        assert_ne!(design.warp_yarn(10, 0), YarnId(2));
    }

    #[test]
    fn a_tie_up_is_toggled_by_the_first_cell_and_the_right_button_clears() {
        let design = blank().expect("a design").design;
        assert!(is_set(&design, Band::TieUp, (0, 0)) && !is_set(&design, Band::TieUp, (0, 2)));
        assert!(!sets(&design, Band::TieUp, (0, 0), Button::First));
        assert!(sets(&design, Band::TieUp, (0, 2), Button::First));
        assert!(!sets(&design, Band::TieUp, (0, 2), Button::Second));
        let cleared = edit(&design, Band::TieUp, &[(0, 0)], false, false);
        assert!(matches!(cleared, Some(Edit::TieUp(rows)) if rows == [(0, vec![1])]));
        assert!(edit(&design, Band::TieUp, &[(-1, 0), (4, 0)], true, false).is_none());
    }
}
