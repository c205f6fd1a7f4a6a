//! What the pane of accuracy says, in words that are not of the tracer.

use pickglass::accuracy::{Axis, Curve, Point, number};
use pickglass::plan::Measure;

use crate::window::panes::effects::title as title_of_effect;

/// What a designer calls it.
pub fn title(axis: &Axis) -> String {
    match axis {
        Axis::Dial(dial) => dial.title.to_owned(),
        Axis::Effect(effect) => title_of_effect(*effect),
        Axis::Renderer => "What draws".to_owned(),
    }
}

/// As [`title`], of a curve; its name where no axis is called so.
pub fn title_of(curve: &Curve) -> String {
    let axis = Axis::named(&curve.name);
    axis.map_or_else(|_| curve.name.clone(), |axis| title(&axis))
}

/// What a curve's error is told in, for a plot's axis.
pub fn unit(curve: &Curve) -> &'static str {
    match curve.measure {
        Measure::Seams => "yarn diameters",
        Measure::Continuity => "% of neighbours",
        Measure::Repetition => "% of crossings",
        Measure::Rounding => "% of white",
        Measure::Bias | Measure::Noise | Measure::Shown | Measure::Engine => "% wrong",
    }
}

/// An error in that unit.
pub fn in_unit(curve: &Curve, error: f64) -> f64 {
    match curve.measure {
        Measure::Seams => error,
        _ => 100.0 * error,
    }
}

/// A setting in words.
pub fn row(curve: &Curve, point: &Point) -> String {
    let unit = match curve.measure {
        Measure::Seams => " yarn diameters",
        _ => " %",
    };
    let error = match point.error > 0.0 {
        true => format!("{}{unit}", number(in_unit(curve, point.error))),
        false => "no error".to_owned(),
    };
    let seen = point.delta_e.map_or_else(String::new, |delta_e| {
        format!(" · ΔE {delta_e:.1} from 30 cm")
    });
    let knee = match curve.knee.as_ref() == Some(&point.value) {
        true => " · after it more time brings little",
        false => "",
    };
    let predicted = if point.measured { "" } else { " · predicted" };
    format!(
        "{} · {} s · {error}{seen}{knee}{predicted}",
        point.value,
        number(point.seconds)
    )
}
