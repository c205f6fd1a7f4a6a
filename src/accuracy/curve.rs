//! What was measured: curves of error over time.

use serde::{Deserialize, Serialize};

use super::estimate::Estimate;
use crate::plan::Measure;

/// What was measured of one design on one machine.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Accuracy {
    /// What it was measured with and of: what has another key cannot go on from here.
    pub key: String,
    /// The design's name.
    pub design: String,
    /// The picture that the times are of, as options of a command line.
    pub picture: String,
    /// Paths a pixel of that picture; 0 where an older program did not say.
    #[serde(default)]
    pub spp: u32,
    /// Where it was measured.
    pub machine: Machine,
    /// Pixels of the piece that was traced, across and down.
    pub piece: [u32; 2],
    /// Width of that piece, mm.
    pub piece_mm: f64,
    /// What is measured where nothing is named: what mattered most.
    #[serde(default)]
    pub chosen: Vec<String>,
    /// A curve of each dial.
    pub dials: Vec<Curve>,
    /// Settings of several dials together: what the curves say of them, and what is so.
    #[serde(default)]
    pub trials: Vec<Trial>,
}

/// Several dials set at random: how far their curves add.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Trial {
    /// Dials and settings.
    pub settings: Vec<(String, String)>,
    /// Seconds of the picture, by the curves.
    pub predicted_seconds: f64,
    /// Seconds of the picture.
    pub seconds: f64,
    /// Relative root mean square error, by the curves.
    pub predicted_error: f64,
    /// Relative root mean square error.
    pub error: f64,
    /// Its 95 % confidence interval.
    pub error_interval: Option<[f64; 2]>,
}

/// Where something was measured.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Machine {
    /// System and processor.
    pub system: String,
    /// Threads that worked.
    pub threads: usize,
}

/// Error over time of one dial's settings.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Curve {
    /// The dial's name.
    pub name: String,
    /// What it is.
    pub about: String,
    /// What its error is.
    pub measure: Measure,
    /// The error's unit.
    pub unit: String,
    /// The setting that the others are measured against.
    pub reference: String,
    /// What the picture is asked for with.
    pub current: String,
    /// The setting after which more time brings little.
    pub knee: Option<String>,
    /// Its settings, from crude to reference.
    pub settings: Vec<Point>,
}

/// Time and error of one setting.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Point {
    /// The setting.
    pub value: String,
    /// Seconds of the picture that is asked for, or of the synthesis where that is measured.
    pub seconds: f64,
    /// Its 95 % confidence interval.
    pub seconds_interval: [f64; 2],
    /// Seconds that processors work on it, all threads together.
    pub processor_seconds: Option<f64>,
    /// How wrong it is, in the curve's unit.
    pub error: f64,
    /// Its 95 % confidence interval; `None` where nothing is known of it.
    pub error_interval: Option<[f64; 2]>,
    /// Noise of the traced picture with all its paths, relative to the curve's reference, where
    /// that was looked at besides.
    #[serde(default)]
    pub noise: Option<f64>,
    /// Paths a pixel of the pictures that the error is of, where it is not of all paths.
    #[serde(default)]
    pub paths: Option<u32>,
    /// Mean ΔE₀₀ from 30 cm: against the reference, or of what is shown against what is traced.
    pub delta_e: Option<f64>,
    /// Structural similarity, likewise.
    pub ssim: Option<f64>,
    /// Whether it was measured; else it follows from the setting before by what theory says.
    pub measured: bool,
}

impl Point {
    /// A setting that took `seconds` and is wrong by `error`.
    pub(super) fn new(value: &str, seconds: Estimate, error: Estimate) -> Self {
        let interval = [error.low, error.high];
        Self {
            value: value.to_owned(),
            seconds: seconds.value,
            seconds_interval: [seconds.low, seconds.high],
            processor_seconds: None,
            noise: None,
            paths: None,
            error: error.value,
            error_interval: interval
                .iter()
                .all(|end| end.is_finite())
                .then_some(interval),
            delta_e: None,
            ssim: None,
            measured: true,
        }
    }
}

impl Curve {
    /// The point of a setting.
    pub fn point(&self, value: &str) -> Option<&Point> {
        self.settings.iter().find(|point| point.value == value)
    }

    /// Finds the knee: on log axes, the setting farthest below the line from the fastest to
    /// the most accurate one. None where the curve does not bend, or has no two ends.
    pub(super) fn find_knee(&mut self) {
        self.knee = knee(&self.settings).map(|at| self.settings[at].value.clone());
    }
}

/// Errors below this share of the largest count as that: a reference is no error at all from
/// itself.
const NOTHING: f64 = 1e-3;

fn knee(points: &[Point]) -> Option<usize> {
    let largest = points.iter().map(|point| point.error).fold(0.0, f64::max);
    let places: Vec<[f64; 2]> = (points.iter())
        .map(|point| [point.seconds.ln(), point.error.max(NOTHING * largest).ln()])
        .collect();
    let sound = places.iter().flatten().all(|place| place.is_finite());
    let by =
        |axis: usize| move |one: &&[f64; 2], other: &&[f64; 2]| one[axis].total_cmp(&other[axis]);
    let fastest = *places.iter().filter(|_| sound).min_by(by(0))?;
    let best = *places.iter().min_by(by(1))?;
    let [across, down] = [best[0] - fastest[0], fastest[1] - best[1]];
    if !(across > 0.0 && down > 0.0) {
        return None;
    }
    // Distance below the line, both axes brought to 0..1.
    let below = |place: &[f64; 2]| {
        let [x, y] = [
            (place[0] - fastest[0]) / across,
            (place[1] - best[1]) / down,
        ];
        1.0 - x - y
    };
    let depths = places.iter().map(below).enumerate();
    let (at, depth) = depths.max_by(|one, other| one.1.total_cmp(&other.1))?;
    (depth > 0.05).then_some(at)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(all: &[(f64, f64)]) -> Vec<Point> {
        (all.iter().enumerate())
            .map(|(at, &(seconds, error))| {
                let [seconds, error] = [seconds, error].map(Estimate::exact);
                Point::new(&at.to_string(), seconds, error)
            })
            .collect()
    }

    #[test]
    fn the_knee_is_where_more_time_begins_to_bring_little() {
        let bent = points(&[(1.0, 1.0), (2.0, 0.1), (8.0, 0.08), (32.0, 0.06)]);
        assert_eq!(knee(&bent), Some(1));
        // On log axes, noise falls in a straight line: no knee.
        let straight = points(&[(1.0, 1.0), (4.0, 0.5), (16.0, 0.25), (64.0, 0.125)]);
        assert_eq!(knee(&straight), None);
        // What costs nothing has no knee, nor has what is wrong in no setting.
        assert_eq!(knee(&points(&[(1.0, 0.5), (1.0, 0.1)])), None);
        assert_eq!(knee(&points(&[(1.0, 0.0), (2.0, 0.0)])), None);
        assert_eq!(knee(&[]), None);
        assert_eq!(knee(&points(&[(0.0, f64::NAN), (2.0, 0.0)])), None);
    }
}
