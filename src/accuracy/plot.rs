//! Plots of curves, as pictures and as SVG: error over time on log axes.

use std::ops::Range;
use std::path::Path;
use std::sync::Once;

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{FontStyle, register_font};

use super::AccuracyError;
use super::curve::{Accuracy, Curve, Point};
use super::digits::number;
use super::model::Choice;
use crate::atomic;
use crate::film::Picture;
use crate::formats::png::{self, Depth, Metadata};

/// Pixels of a plot.
const SIZE: (u32, u32) = (1280, 840);
/// The only family of letters.
const LETTERS: &str = "sans-serif";
const INK: RGBColor = RGBColor(40, 40, 40);
const LINE: RGBColor = RGBColor(31, 99, 163);
const NOW: RGBColor = RGBColor(190, 90, 0);
/// An error of nothing is drawn at this share of the least that there is.
const BELOW: f64 = 0.3;

/// Error over time of some settings.
pub struct Plot {
    title: String,
    /// What the error is, and its unit.
    error: String,
    marks: Vec<Mark>,
    /// A point beside the line: what is asked for.
    beside: Option<[f64; 2]>,
}

/// One setting on a plot.
struct Mark {
    seconds: f64,
    seconds_interval: [f64; 2],
    error: f64,
    error_interval: [f64; 2],
    measured: bool,
    current: bool,
    label: String,
}

impl Plot {
    /// A dial's.
    pub fn of_curve(curve: &Curve) -> Self {
        let mark = |point: &Point| Mark {
            seconds: point.seconds,
            seconds_interval: point.seconds_interval,
            error: point.error,
            error_interval: point.error_interval.unwrap_or([point.error; 2]),
            measured: point.measured,
            current: point.value == curve.current,
            label: label(curve, point),
        };
        Self {
            title: format!("{}: {}", curve.name, curve.about),
            error: format!("{} ({})", curve.measure.about(), curve.unit),
            marks: curve.settings.iter().map(mark).collect(),
            beside: None,
        }
    }

    /// That of all dials together.
    pub fn of_front(front: &[Choice], accuracy: &Accuracy) -> Self {
        let mark = |choice: &Choice| Mark {
            seconds: choice.seconds,
            seconds_interval: [choice.seconds; 2],
            error: choice.error,
            error_interval: [choice.error; 2],
            measured: false,
            current: false,
            label: String::new(),
        };
        let now = accuracy.predict(&[]);
        Self {
            title: "all dials together: what nothing beats, and what is asked for".to_owned(),
            error: "relative RMSE".to_owned(),
            marks: front.iter().map(mark).collect(),
            beside: now.map(|now| [now.seconds, now.error]),
        }
    }
}

/// Draws `plot` into `folder`, as `NAME.png` and `NAME.svg`.
///
/// # Errors
/// When one of them cannot be drawn or written.
pub fn write(folder: &Path, name: &str, plot: &Plot) -> Result<(), AccuracyError> {
    let at = |ending: &str| folder.join(format!("{name}.{ending}"));
    let wrong = |ending: &str, why: String| AccuracyError::Plot(at(ending), why);
    let svg = svg(plot).map_err(|why| wrong("svg", why))?;
    atomic::write(&at("svg"), svg.as_bytes())?;
    let picture = picture(plot).map_err(|why| wrong("png", why))?;
    png::write(&at("png"), &picture, Depth::Eight, &Metadata::default())?;
    Ok(())
}

/// The plot as SVG.
fn svg(plot: &Plot) -> Result<String, String> {
    let mut text = String::new();
    let area = SVGBackend::with_string(&mut text, SIZE).into_drawing_area();
    draw(plot, &area).map_err(|error| error.to_string())?;
    drop(area);
    Ok(text)
}

/// The plot as a picture.
fn picture(plot: &Plot) -> Result<Picture, String> {
    let mut bytes = vec![255u8; SIZE.0 as usize * SIZE.1 as usize * 3];
    let area = BitMapBackend::with_buffer(&mut bytes, SIZE).into_drawing_area();
    draw(plot, &area).map_err(|error| error.to_string())?;
    drop(area);
    let pixels = bytes.as_chunks::<3>().0.iter();
    Ok(Picture {
        width: SIZE.0,
        height: SIZE.1,
        pixels: pixels
            .map(|rgb| {
                let [r, g, b] = rgb.map(|byte| f32::from(byte) / 255.0);
                [r, g, b, 1.0]
            })
            .collect(),
    })
}

/// The letters are the window's own: no system's are looked for.
fn letters() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        let bytes = epaint_default_fonts::UBUNTU_LIGHT;
        // Without them the plot says so where it is drawn.
        let _ = register_font(LETTERS, FontStyle::Normal, bytes);
    });
}

/// Ends of an axis that shows all `values`, with room at both.
fn range(values: impl Iterator<Item = f64> + Clone) -> Range<f64> {
    let sound = values.filter(|value| *value > 0.0 && value.is_finite());
    let low = sound.clone().fold(f64::INFINITY, f64::min);
    let high = sound.fold(0.0, f64::max);
    if !(low <= high) {
        return 0.1..10.0;
    }
    let room = (high / low).powf(0.12).max(1.5);
    let (low, high) = (low / room, high * room);
    // Powers of ten are what is written at an axis: at least two of them.
    let (below, above) = (low.log10().floor(), high.log10().ceil());
    match below + 1.0 < above - 1.0 {
        true => low..high,
        false => 10f64.powf(below)..10f64.powf(above),
    }
}

fn draw<B: DrawingBackend>(
    plot: &Plot,
    area: &DrawingArea<B, Shift>,
) -> Result<(), DrawingAreaErrorKind<B::ErrorType>> {
    letters();
    area.fill(&WHITE)?;
    let marks: Vec<&Mark> = (plot.marks.iter())
        .filter(|mark| mark.seconds > 0.0 && (mark.seconds + mark.error).is_finite())
        .collect();
    let errors = marks.iter().map(|mark| mark.error);
    let least = (errors.filter(|error| *error > 0.0)).fold(f64::INFINITY, f64::min);
    let floor = if least.is_finite() {
        BELOW * least
    } else {
        1e-3
    };
    let place = |mark: &Mark| (mark.seconds, mark.error.max(floor));
    let beside = plot.beside.iter();
    let times = range(
        marks
            .iter()
            .map(|mark| mark.seconds)
            .chain(beside.clone().map(|p| p[0])),
    );
    let heights = range(
        marks
            .iter()
            .map(|mark| place(mark).1)
            .chain(beside.map(|p| p[1])),
    );
    let ink = |size: i32| (LETTERS, size).into_font().color(&INK);
    let mut chart = ChartBuilder::on(area)
        .margin(28)
        .caption(&plot.title, ink(34))
        .x_label_area_size(84)
        .y_label_area_size(124)
        .build_cartesian_2d(times.clone().log_scale(), heights.clone().log_scale())?;
    chart
        .configure_mesh()
        .light_line_style(RGBColor(240, 240, 240))
        .bold_line_style(RGBColor(220, 220, 220))
        .axis_style(INK)
        .label_style(ink(25))
        .x_desc("seconds")
        .y_desc(&plot.error)
        .axis_desc_style(ink(27))
        .x_label_formatter(&|seconds| number(*seconds))
        .y_label_formatter(&|error| number(*error))
        .draw()?;
    let line = marks.iter().map(|mark| place(mark));
    chart.draw_series(LineSeries::new(line, LINE.stroke_width(3)))?;
    for mark in &marks {
        let (x, y) = place(mark);
        let up = (mark.error_interval).map(|end| (x, end.clamp(heights.start, heights.end)));
        let along = (mark.seconds_interval).map(|end| (end.clamp(times.start, times.end), y));
        chart.draw_series([PathElement::new(up, LINE), PathElement::new(along, LINE)])?;
        if mark.label.is_empty() {
            continue;
        }
        let fill = match mark.measured && mark.error > 0.0 {
            true => LINE.filled(),
            false => LINE.stroke_width(3),
        };
        chart.draw_series([Circle::new((x, y), 7, fill)])?;
        if mark.current {
            chart.draw_series([Circle::new((x, y), 15, NOW.stroke_width(4))])?;
        }
    }
    let middle = (times.start * times.end).sqrt();
    for (at, said) in labels(&marks, &place) {
        // Texts stand where there is room for them.
        let (side, offset) = match at.0 > middle {
            true => (HPos::Right, -14),
            false => (HPos::Left, 14),
        };
        let style = ink(27).pos(Pos::new(side, VPos::Top));
        let text = Text::new(said, (offset, -38), style);
        chart.draw_series([EmptyElement::at(at) + text])?;
    }
    if let Some([x, y]) = plot.beside {
        chart.draw_series([Circle::new((x, y), 15, NOW.stroke_width(4))])?;
    }
    area.present()
}

/// What stands beside points: one text for those that lie on each other.
fn labels(marks: &[&Mark], place: &dyn Fn(&Mark) -> (f64, f64)) -> Vec<((f64, f64), String)> {
    let near = |one: (f64, f64), other: (f64, f64)| {
        (one.0 / other.0).ln().abs() < 0.08 && (one.1 / other.1).ln().abs() < 0.15
    };
    let mut labels: Vec<((f64, f64), String, bool)> = Vec::new();
    for mark in marks.iter().filter(|mark| !mark.label.is_empty()) {
        let at = place(mark);
        match labels.iter_mut().find(|(other, ..)| near(at, *other)) {
            Some((_, said, _)) => *said = format!("{said}, {}", mark.label),
            None => labels.push((at, mark.label.clone(), mark.error > 0.0)),
        }
    }
    let said = |(at, said, wrong)| match wrong {
        true => (at, said),
        false => (at, format!("{said}: no error")),
    };
    labels.into_iter().map(said).collect()
}

/// What stands beside a point.
fn label(curve: &Curve, point: &Point) -> String {
    match Some(&point.value) == curve.knee.as_ref() {
        true => format!("{} (knee)", point.value),
        false => point.value.clone(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accuracy::Estimate;
    use crate::plan::Measure;

    fn plot(points: &[(f64, f64)]) -> Plot {
        Plot::of_curve(&curve(points))
    }

    fn curve(points: &[(f64, f64)]) -> Curve {
        let settings = (points.iter().enumerate())
            .map(|(at, &(seconds, error))| {
                let [seconds, error] = [seconds, error].map(Estimate::exact);
                Point::new(&at.to_string(), seconds, error)
            })
            .collect();
        Curve {
            name: "order".to_owned(),
            about: "scatterings < all".to_owned(),
            measure: Measure::Bias,
            unit: "relative RMSE".to_owned(),
            reference: "2".to_owned(),
            current: "1".to_owned(),
            knee: Some("1".to_owned()),
            settings,
        }
    }

    #[test]
    fn plots_show_every_setting_and_the_one_that_is_set() {
        let drawn = svg(&plot(&[(1.0, 0.5), (2.0, 0.02), (9.0, 0.0)])).expect("drawn");
        for said in [
            "0",
            "1 (knee)",
            "2: no error",
            "seconds",
            "relative RMSE",
            "scatterings &lt; all",
        ] {
            assert!(drawn.contains(said), "{said}: {drawn}");
        }
        let circles = drawn.matches("<circle").count();
        assert_eq!(circles, 4, "three settings and the ring of one");
        let picture = picture(&plot(&[(1.0, 0.5), (2.0, 0.02)])).expect("drawn");
        let blue = picture.pixels.iter().filter(|p| p[2] > p[0] + 0.3).count();
        assert!(blue > 200, "{blue} pixels of the line");
    }

    #[test]
    fn hard_curves_are_drawn_all_the_same() {
        for points in [
            &[][..],
            &[(0.0, 0.0)],
            &[(1.0, 0.0)],
            &[(1e-12, 1e12), (1e12, 1e-12)],
            &[(f64::NAN, 1.0), (1.0, f64::NAN), (f64::INFINITY, 1.0)],
            &[(2.0, 0.5), (2.0, 0.5)],
        ] {
            assert!(svg(&plot(points)).is_ok(), "{points:?}");
            assert!(picture(&plot(points)).is_ok(), "{points:?}");
        }
    }
}
