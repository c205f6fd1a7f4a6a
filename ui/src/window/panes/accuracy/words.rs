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
        Measure::Kinks => "degrees",
        Measure::Continuity => "% of neighbours",
        Measure::Repetition => "% of crossings",
        Measure::Rounding => "% of white",
        Measure::Bias | Measure::Noise | Measure::Shown | Measure::Engine => "% wrong",
    }
}

/// An error in that unit.
pub fn in_unit(curve: &Curve, error: f64) -> f64 {
    match curve.measure {
        Measure::Seams | Measure::Kinks => error,
        _ => 100.0 * error,
    }
}

/// A setting in words.
pub fn row(curve: &Curve, point: &Point) -> String {
    let unit = match curve.measure {
        Measure::Seams => " yarn diameters",
        Measure::Kinks => " degrees",
        _ => " %",
    };
    let error = match point.error > 0.0 {
        true => format!("{}{unit}", number(in_unit(curve, point.error))),
        false => "no error".to_owned(),
    };
    let seen = point.delta_e.map_or_else(String::new, |delta_e| {
        format!(" · {} from 30 cm", self::delta_e(delta_e))
    });
    let knee = match curve.knee.as_ref() == Some(&point.value) {
        true => " · after it more time brings little",
        false => "",
    };
    let predicted = if point.measured { "" } else { " · predicted" };
    format!(
        "{} · {} · {error}{seen}{knee}{predicted}",
        point.value,
        duration(point.seconds)
    )
}

/// A time, in units in which it is no large number.
pub fn duration(seconds: f64) -> String {
    let units = [
        ("min", 60.0, 180.0),
        ("h", 3600.0, 3.0 * 3600.0),
        ("days", 86400.0, 3.0 * 86400.0),
    ];
    let coarser = units.iter().rev().find(|(_, _, from)| seconds >= *from);
    match coarser {
        Some((unit, length, _)) => format!("{} {unit}", number(seconds / length)),
        None => format!("{} s", number(seconds)),
    }
}

/// A colour difference.
pub fn delta_e(delta_e: f64) -> String {
    match delta_e {
        small if small < 0.05 => "ΔE under 0.1".to_owned(),
        _ => format!("ΔE {delta_e:.1}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_told_in_units_of_their_size() {
        for (seconds, told) in [
            (0.0123, "0.0123 s"),
            (21.0, "21.0 s"),
            (179.0, "179 s"),
            (420.0, "7.00 min"),
            (341_698.0, "3.95 days"),
        ] {
            assert_eq!(duration(seconds), told);
        }
        assert_eq!(delta_e(0.01), "ΔE under 0.1");
        assert_eq!(delta_e(3.42), "ΔE 3.4");
    }
}
