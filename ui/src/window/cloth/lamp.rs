//! The lamp: a small dome over the cloth on which one drags the light about.

use egui::{Pos2, Rect, Sense, Stroke, vec2};
use pickglass::engine::{Heading, LightChoice};

use crate::tokens::{self, Palette};
use crate::window::focus;

/// Radius of the dome.
pub const RADIUS: f32 = 7.0 * tokens::GRID;
/// Where the default light's sun stands.
const USUAL: Heading = Heading {
    azimuth: 135,
    elevation: 45,
};
/// Degrees of an arrow key.
const STEP: i16 = 5;
/// Lowest the lamp may stand, degrees.
const LOWEST: i16 = 5;

/// Where on the dome a heading lies.
fn place(middle: Pos2, heading: Heading) -> Pos2 {
    let towards = heading.towards();
    middle + vec2(towards.x, -towards.y) * RADIUS
}

/// The heading at a point of the dome; beyond its rim the lamp stands lowest.
fn heading(middle: Pos2, at: Pos2) -> Heading {
    let off = (at - middle) / RADIUS;
    let away = off.length().min(1.0);
    Heading {
        azimuth: (-off.y).atan2(off.x).to_degrees().round() as i16,
        elevation: (away.acos().to_degrees().round() as i16).clamp(LOWEST, 90),
    }
}

/// Shows the lamp with its middle at a point and moves the light as the person asks.
pub fn show(ui: &mut egui::Ui, middle: Pos2, light: &mut LightChoice) {
    let palette = Palette::current(ui);
    let now = match light {
        LightChoice::Sun(heading) => *heading,
        _ => USUAL,
    };
    let rect = Rect::from_center_size(middle, vec2(2.0, 2.0) * RADIUS);
    let response = ui.interact(rect, ui.scope_id().with("lamp"), Sense::click_and_drag());
    let spoken = format!("Light from {}°, {}° high", now.azimuth, now.elevation);
    response.widget_info(|| {
        egui::WidgetInfo::slider(true, f64::from(now.azimuth), format!("Lamp: {spoken}"))
    });
    if response.clicked() {
        response.request_focus();
    }
    if (response.dragged() || response.clicked())
        && let Some(at) = response.interact_pointer_pos()
    {
        *light = LightChoice::Sun(heading(middle, at));
    }
    let [turn, lift] = focus::arrows(ui, &response).map(|by| by.clamp(-9, 9) as i16);
    if turn != 0 || lift != 0 {
        *light = LightChoice::Sun(Heading {
            azimuth: (now.azimuth - turn * STEP + 180).rem_euclid(360) - 180,
            elevation: (now.elevation + lift * STEP).clamp(LOWEST, 90),
        });
    }
    let painter = ui.painter();
    painter.circle(
        middle,
        RADIUS,
        palette.raised,
        Stroke::new(1.0, palette.line),
    );
    painter.circle_stroke(middle, 0.5 * RADIUS, Stroke::new(1.0, palette.line));
    let moved = matches!(light, LightChoice::Sun(_));
    let colour = if moved { tokens::ACCENT } else { palette.quiet };
    let at = place(middle, now);
    painter.line_segment([middle, at], Stroke::new(1.0, colour));
    painter.circle(at, tokens::GRID, colour, Stroke::new(1.0, palette.text));
    if response.has_focus() {
        focus::circle(painter, middle, RADIUS, &palette);
    }
    response.on_hover_text(format!("{spoken}. Drag it to put the light elsewhere."));
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::pos2;

    #[test]
    fn the_lamp_stands_where_it_was_put() {
        let middle = pos2(40.0, 60.0);
        for azimuth in [-170, -90, 0, 45, 135] {
            for elevation in [10, 45, 80] {
                let put = Heading { azimuth, elevation };
                let found = heading(middle, place(middle, put));
                assert!((found.azimuth - azimuth).abs() <= 1, "{put:?} {found:?}");
                assert!(
                    (found.elevation - elevation).abs() <= 1,
                    "{put:?} {found:?}"
                );
            }
        }
        assert_eq!(heading(middle, middle + vec2(900.0, 0.0)).elevation, LOWEST);
        assert!(heading(middle, middle).elevation == 90);
    }
}
