//! The curve of one dial: error over time, both logarithmic.

use egui::{RichText, Ui, vec2};
use egui_plot::{GridInput, GridMark, Line, MarkerShape, Plot, PlotPoint, PlotPoints, Points};
use pickglass::accuracy::{Curve, Point, number};

use super::words;
use crate::tokens::{self, Palette};

/// Least height of a plot, points.
const LEAST: f32 = 24.0 * tokens::GRID;
/// How near to a setting the pointer has to be, points.
const NEAR: f32 = 20.0;
/// Errors of nothing stand below the least that there is, at this share of it.
const BELOW: f64 = 0.3;
/// Powers of ten that an axis covers, at least: two of its marks are always there.
const COVERED: f64 = 0.7;

/// Draws the curve; says which setting the pointer is at, and whether it was clicked.
pub fn show(ui: &mut Ui, curve: &Curve, now: &str) -> Option<(usize, bool)> {
    let places = places(curve);
    let palette = Palette::current(ui);
    let of_power = |mark: GridMark| number(10f64.powf(mark.value));
    let mut plot = Plot::new(("accuracy", &curve.name))
        .height(ui.available_height().max(LEAST))
        .grid_color(palette.line)
        .allow_drag(false)
        .allow_zoom(false)
        .allow_scroll(false)
        .allow_boxed_zoom(false)
        .x_axis_label("seconds")
        .y_axis_label(words::unit(curve))
        .x_axis_formatter(move |mark, _| of_power(mark))
        .y_axis_formatter(move |mark, _| of_power(mark))
        .x_grid_spacer(decades)
        .y_grid_spacer(decades)
        .set_margin_fraction(vec2(0.12, 0.15))
        .label_formatter(|_| None);
    for end in covered(places.iter().map(|place| place[0])) {
        plot = plot.include_x(end);
    }
    for end in covered(places.iter().map(|place| place[1])) {
        plot = plot.include_y(end);
    }
    let shown = plot.show(ui, |plot| {
        let series = |keep: &dyn Fn(&Point) -> bool| -> PlotPoints<'_> {
            let both = places.iter().zip(&curve.settings);
            let kept = both.filter(|(_, point)| keep(point));
            kept.map(|(place, _)| *place).collect()
        };
        let is_wrong = |point: &Point| point.error > 0.0;
        let line = Line::new("", series(&|point| is_wrong(point)));
        plot.line(line.color(palette.focus));
        for filled in [true, false] {
            let wrong = series(&|point| is_wrong(point) && point.measured == filled);
            let points = Points::new("", wrong).filled(filled);
            plot.points(points.radius(4.0).color(palette.focus));
        }
        // No error has no place on such an axis: an arrow points to where it is.
        let none = Points::new("", series(&|point| !is_wrong(point)));
        let arrow = none.shape(MarkerShape::Down).radius(6.0);
        plot.points(arrow.color(palette.focus));
        let here = Points::new("", series(&|point| point.value == now));
        let ring = here.shape(MarkerShape::Circle).filled(false).radius(8.0);
        plot.points(ring.color(palette.warning));
        for ([x, y], point) in places.iter().zip(&curve.settings) {
            let told = match is_wrong(point) {
                true => point.value.clone(),
                false => format!("{}: no error", point.value),
            };
            let said = RichText::new(told).color(palette.text);
            let text = egui_plot::Text::new("", PlotPoint::new(*x, *y), said);
            plot.text(text.anchor(egui::Align2::LEFT_BOTTOM));
        }
    });
    let pointer = shown.response.hover_pos()?;
    let distance = |place: &[f64; 2]| {
        let at = PlotPoint::new(place[0], place[1]);
        shown.transform.position_from_point(&at).distance(pointer)
    };
    let nearest = (places.iter().map(distance).enumerate())
        .min_by(|one, other| one.1.total_cmp(&other.1))
        .filter(|(_, distance)| *distance < NEAR);
    let clicked = shown.response.clicked();
    if let Some((at, _)) = nearest {
        let told = words::row(curve, &curve.settings[at]);
        shown.response.on_hover_text_at_pointer(told);
    }
    nearest.map(|(at, _)| (at, clicked))
}

/// Decimal logarithms of time and error of each setting, in the units that are told.
fn places(curve: &Curve) -> Vec<[f64; 2]> {
    let errors = (curve.settings.iter()).map(|point| words::in_unit(curve, point.error));
    let least = (errors.clone().filter(|error| *error > 0.0)).fold(f64::INFINITY, f64::min);
    let floor = if least.is_finite() {
        BELOW * least
    } else {
        1e-3
    };
    let times = curve.settings.iter().map(|point| point.seconds);
    let places = times.zip(errors);
    let place = |(seconds, error): (f64, f64)| {
        let error = if error > 0.0 { error } else { floor };
        [seconds.max(1e-9).log10(), error.log10()]
    };
    places.map(place).collect()
}

/// What an axis covers besides its places where they lie close together: nothing, or two ends.
fn covered(places: impl Iterator<Item = f64>) -> Vec<f64> {
    let (low, high) = places.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), place| {
        (low.min(place), high.max(place))
    });
    if !(low.is_finite() && high.is_finite() && high - low < COVERED) {
        return Vec::new();
    }
    let middle = 0.5 * (low + high);
    vec![middle - 0.5 * COVERED, middle + 0.5 * COVERED]
}

/// What is marked in a decade, and how far it is to the next mark of its kind.
const DECADE: [(f64, f64); 6] = [
    (1.0, 1.0),
    (2.0, 0.3),
    (5.0, 0.3),
    (1.5, 0.1),
    (3.0, 0.1),
    (7.0, 0.1),
];

/// Powers of ten, and what stands between them.
fn decades(input: GridInput) -> Vec<GridMark> {
    let (low, high) = input.bounds;
    let (first, last) = (low.floor() as i32, high.ceil().min(low + 40.0) as i32);
    let marks = (first..=last).flat_map(|power| {
        DECADE.map(|(times, step_size)| GridMark {
            value: f64::from(power) + times.log10(),
            step_size,
        })
    });
    marks
        .filter(|mark| mark.value >= low && mark.value <= high)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_axis_always_has_two_marks() {
        // Settings that take as long as each other are given room on both sides.
        let ends = covered([0.301, 0.302].into_iter());
        assert!(ends[0] < 0.0 && ends[1] > 0.6, "{ends:?}");
        assert!(covered([0.0, 2.0].into_iter()).is_empty());
        assert!(covered(std::iter::empty()).is_empty());
        for tenth in -50..50 {
            let at = 0.1 * f64::from(tenth);
            let ends = covered([at].into_iter());
            let input = GridInput {
                bounds: (ends[0], ends[1]),
                base_step_size: 0.1,
            };
            assert!(decades(input).len() >= 2, "{at}");
        }
    }
}
