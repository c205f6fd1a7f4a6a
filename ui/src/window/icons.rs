//! The signs of the window, drawn, since no font can be relied on to have them.

use egui::{Color32, Painter, Pos2, Rect, Sense, Shape, Stroke, pos2, vec2};

use super::toasts::Grade;
use crate::command_table::Tool;

/// Side of a sign, points.
const SIDE: f32 = 14.0;

/// Shows the sign of a grade in a colour. The word beside it names it.
pub fn show(ui: &mut egui::Ui, grade: Grade, colour: Color32) {
    let (rect, _) = ui.allocate_exact_size(vec2(SIDE, SIDE), Sense::hover());
    let stroke = Stroke::new(1.5, colour);
    let painter = ui.painter();
    match grade {
        Grade::Done => lines(
            painter,
            rect,
            stroke,
            &[(0.15, 0.55), (0.4, 0.8), (0.85, 0.25)],
        ),
        Grade::Note => {
            painter.circle_stroke(rect.center(), SIDE * 0.46, stroke);
            lines(painter, rect, stroke, &[(0.5, 0.45), (0.5, 0.78)]);
            painter.circle_filled(at(rect, (0.5, 0.27)), 1.0, colour);
        }
        Grade::Warning => {
            let corners = [(0.5, 0.08), (0.96, 0.92), (0.04, 0.92)];
            let corners = corners.map(|corner| at(rect, corner)).to_vec();
            painter.add(Shape::closed_line(corners, stroke));
            lines(painter, rect, stroke, &[(0.5, 0.38), (0.5, 0.62)]);
            painter.circle_filled(at(rect, (0.5, 0.77)), 1.0, colour);
        }
        Grade::Error => {
            painter.circle_stroke(rect.center(), SIDE * 0.46, stroke);
            lines(painter, rect, stroke, &[(0.34, 0.34), (0.66, 0.66)]);
            lines(painter, rect, stroke, &[(0.66, 0.34), (0.34, 0.66)]);
        }
    }
}

fn at(rect: Rect, (x, y): (f32, f32)) -> Pos2 {
    pos2(
        rect.left() + x * rect.width(),
        rect.top() + y * rect.height(),
    )
}

fn lines(painter: &Painter, rect: Rect, stroke: Stroke, points: &[(f32, f32)]) {
    let points: Vec<Pos2> = points.iter().map(|&point| at(rect, point)).collect();
    painter.add(Shape::line(points, stroke));
}

/// Draws a tool's sign.
pub fn tool(painter: &Painter, button: Rect, tool: Tool, colour: Color32) {
    let rect = Rect::from_center_size(button.center(), vec2(16.0, 16.0));
    let stroke = Stroke::new(1.5, colour);
    let path = |points: &[(f32, f32)]| lines(painter, rect, stroke, points);
    let square =
        |from: (f32, f32), to: (f32, f32)| Rect::from_two_pos(at(rect, from), at(rect, to));
    let outline = |from, to| {
        painter.rect_stroke(square(from, to), 0.0, stroke, egui::StrokeKind::Middle);
    };
    match tool {
        Tool::Pencil => {
            path(&[
                (0.08, 0.92),
                (0.16, 0.66),
                (0.74, 0.08),
                (0.92, 0.26),
                (0.34, 0.84),
                (0.08, 0.92),
            ]);
            path(&[(0.6, 0.22), (0.78, 0.4)]);
        }
        Tool::Line => path(&[(0.08, 0.92), (0.92, 0.08)]),
        Tool::Rectangle => outline((0.06, 0.2), (0.94, 0.8)),
        Tool::Fill => {
            path(&[
                (0.42, 0.1),
                (0.8, 0.5),
                (0.42, 0.88),
                (0.04, 0.5),
                (0.42, 0.1),
            ]);
            painter.rect_filled(square((0.2, 0.5), (0.64, 0.66)), 0.0, colour);
            path(&[(0.92, 0.6), (0.92, 0.9)]);
        }
        Tool::Replace => {
            painter.rect_filled(square((0.04, 0.1), (0.36, 0.42)), 0.0, colour);
            outline((0.64, 0.58), (0.94, 0.88));
            path(&[(0.52, 0.24), (0.82, 0.24), (0.82, 0.46)]);
            path(&[(0.48, 0.76), (0.2, 0.76), (0.2, 0.54)]);
        }
        Tool::Picker => {
            path(&[
                (0.06, 0.94),
                (0.12, 0.74),
                (0.56, 0.3),
                (0.7, 0.44),
                (0.26, 0.88),
                (0.06, 0.94),
            ]);
            painter.circle_filled(at(rect, (0.76, 0.24)), 3.2, colour);
        }
        Tool::Select => {
            for edge in [
                [(0.08, 0.3), (0.08, 0.1), (0.3, 0.1)],
                [(0.7, 0.1), (0.92, 0.1), (0.92, 0.3)],
                [(0.92, 0.7), (0.92, 0.9), (0.7, 0.9)],
                [(0.3, 0.9), (0.08, 0.9), (0.08, 0.7)],
            ] {
                path(&edge);
            }
        }
        Tool::Move => {
            path(&[(0.5, 0.04), (0.5, 0.96)]);
            path(&[(0.04, 0.5), (0.96, 0.5)]);
            path(&[(0.36, 0.18), (0.5, 0.04), (0.64, 0.18)]);
            path(&[(0.36, 0.82), (0.5, 0.96), (0.64, 0.82)]);
            path(&[(0.18, 0.36), (0.04, 0.5), (0.18, 0.64)]);
            path(&[(0.82, 0.36), (0.96, 0.5), (0.82, 0.64)]);
        }
        Tool::Stamp => {
            outline((0.1, 0.72), (0.9, 0.9));
            path(&[
                (0.3, 0.72),
                (0.42, 0.5),
                (0.36, 0.2),
                (0.5, 0.08),
                (0.64, 0.2),
                (0.58, 0.5),
                (0.7, 0.72),
            ]);
        }
    }
}

/// Draws the sign of a mirror: two arrows apart, across (0) or along (1).
pub fn mirror(painter: &Painter, button: Rect, axis: usize, colour: Color32) {
    let rect = Rect::from_center_size(button.center(), vec2(16.0, 16.0));
    let stroke = Stroke::new(1.5, colour);
    let turned = |(x, y): (f32, f32)| if axis == 0 { (x, y) } else { (y, x) };
    for path in [
        [(0.5, 0.0), (0.5, 0.5), (0.5, 1.0)],
        [(0.22, 0.3), (0.02, 0.5), (0.22, 0.7)],
        [(0.78, 0.3), (0.98, 0.5), (0.78, 0.7)],
    ] {
        lines(painter, rect, stroke, &path.map(turned));
    }
    for shaft in [[(0.02, 0.5), (0.36, 0.5)], [(0.64, 0.5), (0.98, 0.5)]] {
        lines(painter, rect, stroke, &shaft.map(turned));
    }
}
