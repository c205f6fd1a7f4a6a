//! The three signs of the window, drawn, since no font can be relied on to have them.

use egui::{Color32, Painter, Pos2, Rect, Sense, Shape, Stroke, pos2, vec2};

use super::toasts::Grade;

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
