//! All dials together: the settings for which no other is both faster and more accurate.
//!
//! The curves are taken to add: a dial's setting multiplies the time and the noise of any
//! picture by what it multiplied those of the measured one by, and what it gets wrong whatever
//! the number of paths adds up in squares.

use super::curve::{Accuracy, Curve, Point};
use crate::plan::Measure;

/// Combinations that are looked at, at most: dials that do least are left as they are where
/// there would be more.
const MOST: usize = 1 << 20;

/// Settings of all dials of a picture, with what they cost.
#[derive(Debug, Clone, PartialEq)]
pub struct Choice {
    /// Dial and setting, those of the table's order.
    pub settings: Vec<(String, String)>,
    /// Seconds of the picture.
    pub seconds: f64,
    /// Seconds that processors work on it; `None` where that is not known of every dial.
    pub processor_seconds: Option<f64>,
    /// Relative root mean square of all that is wrong with it.
    pub error: f64,
}

/// What a setting does to a picture.
#[derive(Debug, Clone, Copy)]
struct Factor {
    seconds: f64,
    processor: Option<f64>,
    /// Squared.
    bias: f64,
    /// Squared.
    noise: f64,
}

impl Factor {
    /// Both together.
    fn and(self, other: Self) -> Self {
        Self {
            seconds: self.seconds * other.seconds,
            processor: self.processor.zip(other.processor).map(|(a, b)| a * b),
            bias: self.bias + other.bias,
            noise: self.noise * other.noise,
        }
    }
}

const NEUTRAL: Factor = Factor {
    seconds: 1.0,
    processor: Some(1.0),
    bias: 0.0,
    noise: 1.0,
};

/// What a dial's settings do to a picture, beside what it is set to.
fn factors(curve: &Curve) -> Option<Vec<Factor>> {
    let now = curve.point(&curve.current)?;
    let ratio = |one: f64, other: f64| {
        let ratio = one / other;
        (ratio > 0.0 && ratio.is_finite()).then_some(ratio)
    };
    let all = curve.settings.iter().map(|point| {
        let processor = point.processor_seconds.zip(now.processor_seconds);
        let factor = Factor {
            seconds: ratio(point.seconds, now.seconds)?,
            processor: processor.and_then(|(one, other)| ratio(one, other)),
            ..NEUTRAL
        };
        match curve.measure {
            Measure::Bias => Some(Factor {
                bias: point.error * point.error,
                ..factor
            }),
            Measure::Noise | Measure::Shown => {
                let noise = ratio(point.error, now.error)?;
                Some(Factor {
                    noise: noise * noise,
                    ..factor
                })
            }
            // What has another unit does not add to these, nor does another engine.
            Measure::Continuity
            | Measure::Seams
            | Measure::Repetition
            | Measure::Rounding
            | Measure::Engine => None,
        }
    });
    all.collect()
}

/// How much a dial's settings do to time and error, in powers of e.
fn spread(factors: &[Factor]) -> f64 {
    let of = |value: fn(&Factor) -> f64| {
        let values = factors.iter().map(value);
        let (low, high) = values.fold((f64::INFINITY, 0.0), |(low, high), value| {
            (value.min(low), value.max(high))
        });
        (high.max(1e-6) / low.max(1e-6)).ln()
    };
    of(|factor| factor.seconds) + of(|factor| factor.noise) + of(|factor| factor.bias + 1e-4)
}

impl Accuracy {
    /// The picture as it is asked for: its point on the curve of its paths, or of any other
    /// dial of a picture.
    fn now(&self) -> Option<(&Point, f64)> {
        let of = |curve: &&Curve| curve.measure == Measure::Noise;
        let curve = self.dials.iter().find(of)?;
        let point = curve.point(&curve.current)?;
        Some((point, point.error))
    }

    /// The front, fastest first. Empty where no curve says how much noise there is.
    pub fn front(&self) -> Vec<Choice> {
        let Some((_, noise)) = self.now() else {
            return Vec::new();
        };
        let mut dials: Vec<(&Curve, Vec<Factor>)> = (self.dials.iter())
            .filter_map(|curve| Some((curve, factors(curve)?)))
            .collect();
        dials.sort_by(|one, other| spread(&other.1).total_cmp(&spread(&one.1)));
        let mut count = 1usize;
        let fits = |(_, factors): &&(&Curve, Vec<Factor>)| {
            let more = count.saturating_mul(factors.len());
            let fits = more <= MOST;
            if fits {
                count = more;
            }
            fits
        };
        let dials: Vec<&(&Curve, Vec<Factor>)> = dials.iter().filter(fits).collect();
        let mut all: Vec<(f64, f64, usize)> = (0..count)
            .map(|choice| {
                let whole = multiplied(&dials, choice);
                let error = (whole.bias + noise * noise * whole.noise).sqrt();
                (whole.seconds, error, choice)
            })
            .collect();
        all.sort_by(|one, other| {
            let times = one.0.total_cmp(&other.0);
            times
                .then(one.1.total_cmp(&other.1))
                .then(one.2.cmp(&other.2))
        });
        let mut least = f64::INFINITY;
        all.retain(|(_, error, _)| {
            let better = *error < least;
            least = least.min(*error);
            better
        });
        (all.into_iter())
            .filter_map(|(_, _, choice)| self.predict(&self.in_order(&dials, choice)))
            .collect()
    }

    /// What the curves say of these settings, all other dials as they are; `None` where a curve
    /// has none of them, or none says how much noise there is.
    pub fn predict(&self, settings: &[(String, String)]) -> Option<Choice> {
        let (now, noise) = self.now()?;
        let whole = settings.iter().try_fold(NEUTRAL, |whole, (name, value)| {
            let curve = self.dials.iter().find(|curve| curve.name == *name)?;
            let at = curve
                .settings
                .iter()
                .position(|point| point.value == *value)?;
            Some(whole.and(factors(curve)?[at]))
        })?;
        Some(Choice {
            settings: settings.to_vec(),
            seconds: now.seconds * whole.seconds,
            processor_seconds: (whole.processor.zip(now.processor_seconds))
                .map(|(factor, seconds)| factor * seconds),
            error: (whole.bias + noise * noise * whole.noise).sqrt(),
        })
    }

    /// The most accurate settings that take no longer than `seconds`; the fastest of all where
    /// none does.
    pub fn within_seconds(&self, seconds: f64) -> Option<Choice> {
        let front = self.front();
        let fast = front.iter().rev().find(|choice| choice.seconds <= seconds);
        fast.or(front.first()).cloned()
    }

    /// The fastest settings that are no more wrong than `error`; the best of all where none is
    /// so good.
    pub fn within_error(&self, error: f64) -> Option<Choice> {
        let front = self.front();
        let good = front.iter().find(|choice| choice.error <= error);
        good.or(front.last()).cloned()
    }

    fn in_order(&self, dials: &[&(&Curve, Vec<Factor>)], choice: usize) -> Vec<(String, String)> {
        let mut chosen: Vec<(usize, (String, String))> = (dials.iter())
            .zip(digits(dials, choice))
            .map(|((curve, _), at)| {
                let place = self.dials.iter().position(|other| other.name == curve.name);
                let setting = (curve.name.clone(), curve.settings[at].value.clone());
                (place.unwrap_or_default(), setting)
            })
            .collect();
        chosen.sort_by_key(|(place, _)| *place);
        chosen.into_iter().map(|(_, setting)| setting).collect()
    }
}

/// Which setting of each dial a combination has.
fn digits(dials: &[&(&Curve, Vec<Factor>)], mut choice: usize) -> Vec<usize> {
    let digit = |(_, factors): &&(&Curve, Vec<Factor>)| {
        let at = choice % factors.len();
        choice /= factors.len();
        at
    };
    dials.iter().map(digit).collect()
}

/// What a combination does to the picture.
fn multiplied(dials: &[&(&Curve, Vec<Factor>)], choice: usize) -> Factor {
    let chosen = (dials.iter())
        .zip(digits(dials, choice))
        .map(|((_, factors), at)| factors[at]);
    chosen.fold(NEUTRAL, Factor::and)
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;
    use crate::accuracy::curve::Machine;
    use crate::accuracy::estimate::Estimate;

    fn curve(name: &str, measure: Measure, current: &str, points: &[(&str, f64, f64)]) -> Curve {
        Curve {
            name: name.to_owned(),
            about: String::new(),
            measure,
            unit: measure.unit().to_owned(),
            reference: points.last().unwrap().0.to_owned(),
            current: current.to_owned(),
            knee: None,
            settings: (points.iter())
                .map(|(value, seconds, error)| {
                    let [seconds, error] = [*seconds, *error].map(Estimate::exact);
                    Point::new(value, seconds, error)
                })
                .collect(),
        }
    }

    fn measured() -> Accuracy {
        let spp = [("1", 1.0, 0.8), ("16", 16.0, 0.2), ("64", 64.0, 0.1)];
        let order = [("1", 16.0, 0.5), ("8", 48.0, 0.01), ("64", 64.0, 0.0)];
        let rank = [("0", 0.1, 0.5), ("exact", 0.4, 0.0)];
        Accuracy {
            key: String::new(),
            design: String::new(),
            picture: String::new(),
            machine: Machine {
                system: String::new(),
                threads: 1,
            },
            piece: [1, 1],
            piece_mm: 1.0,
            dials: vec![
                curve("rank", Measure::Seams, "exact", &rank),
                curve("order", Measure::Bias, "64", &order),
                curve("spp", Measure::Noise, "64", &spp),
            ],
            trials: Vec::new(),
        }
    }

    #[test]
    fn the_front_is_what_nothing_beats() {
        let measured = measured();
        let front = measured.front();
        for pair in front.windows(2) {
            assert!(pair[0].seconds < pair[1].seconds && pair[0].error > pair[1].error);
        }
        // By hand: order 1 takes a quarter of the time, order 8 three quarters.
        let best = front.last().unwrap();
        assert_eq!((best.seconds, best.error), (64.0, 0.1));
        let fastest = &front[0];
        assert_eq!(fastest.seconds, 0.25);
        assert!((fastest.error - 0.5f64.hypot(0.8)).abs() < 1e-12);
        let say = |choice: &Choice| format!("{:?}", choice.settings);
        assert_eq!(say(best), r#"[("order", "64"), ("spp", "64")]"#);
        // Brute force over all nine.
        let mut all = Vec::new();
        for (order, bias) in [(0.25, 0.5), (0.75, 0.01), (1.0, 0.0)] {
            for (spp, noise) in [(1.0, 0.8), (16.0, 0.2), (64.0, 0.1)] {
                all.push((spp * order, f64::hypot(bias, noise)));
            }
        }
        let beaten = |one: &(f64, f64)| {
            all.iter().any(|other| {
                other.0 <= one.0 && other.1 <= one.1 && (other.0 < one.0 || other.1 < one.1)
            })
        };
        assert_eq!(all.iter().filter(|one| !beaten(one)).count(), front.len());
    }

    #[test]
    fn budgets_choose_from_the_front() {
        let measured = measured();
        assert_eq!(measured.within_seconds(50.0).unwrap().seconds, 48.0);
        assert_eq!(measured.within_seconds(0.0).unwrap().seconds, 0.25);
        let good = measured.within_error(0.25).unwrap();
        assert_eq!(good.seconds, 12.0);
        assert_eq!(measured.within_error(0.0).unwrap().error, 0.1);
        let mut silent = measured;
        silent.dials.pop();
        assert_eq!(silent.front(), []);
    }
}
