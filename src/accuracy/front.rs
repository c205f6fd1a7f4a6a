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
    /// Multiplies the time that tracing takes.
    seconds: f64,
    processor: Option<f64>,
    /// Seconds more of the whole picture, however many paths.
    more: f64,
    more_processor: Option<f64>,
    /// Relative square error however many paths.
    bias: f64,
    /// Multiplies the squared noise.
    noise: f64,
}

impl Factor {
    const NEUTRAL: Self = Self {
        seconds: 1.0,
        processor: Some(1.0),
        more: 0.0,
        more_processor: Some(0.0),
        bias: 0.0,
        noise: 1.0,
    };

    /// Both together.
    fn and(self, other: Self) -> Self {
        let both = |one: Option<f64>, two: Option<f64>, join: fn(f64, f64) -> f64| {
            one.zip(two).map(|(one, two)| join(one, two))
        };
        Self {
            seconds: self.seconds * other.seconds,
            processor: both(self.processor, other.processor, |a, b| a * b),
            more: self.more + other.more,
            more_processor: both(self.more_processor, other.more_processor, |a, b| a + b),
            bias: self.bias + other.bias,
            noise: self.noise * other.noise,
        }
    }
}

/// A ratio that can be multiplied by.
fn ratio(one: f64, other: f64) -> Option<f64> {
    let ratio = one / other;
    (ratio > 0.0 && ratio.is_finite()).then_some(ratio)
}

/// What a dial's settings do to a picture, `fixed` seconds of which (of the clock and of
/// processors) no path takes; `None` where they have no place among the others.
fn factors(curve: &Curve, fixed: (f64, f64)) -> Option<Vec<Factor>> {
    let now = curve.point(&curve.current)?;
    let crude = curve.settings.first()?;
    let of = |point: &Point| {
        let processor = |other: &Point| point.processor_seconds.zip(other.processor_seconds);
        match curve.measure {
            Measure::Bias | Measure::Noise => {
                let noise = match curve.measure {
                    Measure::Noise => ratio(point.error, now.error)?,
                    // Where nothing is known of it, it is as it was.
                    _ => (point.noise.zip(now.noise))
                        .and_then(|(one, other)| ratio(one, other))
                        .unwrap_or(1.0),
                };
                let bias = match curve.measure {
                    Measure::Bias => point.error * point.error,
                    _ => 0.0,
                };
                Some(Factor {
                    seconds: ratio(point.seconds - fixed.0, now.seconds - fixed.0)?,
                    processor: processor(now)
                        .and_then(|(one, other)| ratio(one - fixed.1, other - fixed.1)),
                    bias,
                    noise: noise * noise,
                    ..Factor::NEUTRAL
                })
            }
            // The crude end shows what was traced as it is.
            Measure::Shown => {
                let noise = ratio(point.error, crude.error)?;
                Some(Factor {
                    more: point.seconds - crude.seconds,
                    more_processor: processor(crude).map(|(one, other)| one - other),
                    noise: noise * noise,
                    ..Factor::NEUTRAL
                })
            }
            // What has another unit does not add to these, nor does another engine.
            Measure::Continuity
            | Measure::Seams
            | Measure::Repetition
            | Measure::Rounding
            | Measure::Engine => None,
        }
    };
    curve.settings.iter().map(of).collect()
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

/// One dial of the model.
struct Dial<'a> {
    curve: &'a Curve,
    factors: Vec<Factor>,
    /// What it is set to, among its settings.
    now: usize,
}

/// All dials that add, and the picture that their factors multiply.
struct Model<'a> {
    dials: Vec<Dial<'a>>,
    /// Seconds, of the clock and of processors, that tracing takes.
    seconds: f64,
    processor: Option<f64>,
    /// Relative root mean square of what is traced.
    noise: f64,
}

impl<'a> Model<'a> {
    /// What the curves say; `None` where none says how much noise there is.
    fn new(accuracy: &'a Accuracy) -> Option<Self> {
        let point = (accuracy.dials.iter())
            .filter(|curve| curve.measure == Measure::Noise)
            .find_map(|curve| curve.point(&curve.current))?;
        let shown = accuracy
            .dials
            .iter()
            .filter(|curve| curve.measure == Measure::Shown);
        let fixed = shown.filter_map(|curve| {
            let (now, crude) = (curve.point(&curve.current)?, curve.settings.first()?);
            let processor = now.processor_seconds.zip(crude.processor_seconds);
            let processor = processor.map_or(0.0, |(now, crude)| now - crude);
            Some((now.seconds - crude.seconds, processor))
        });
        let fixed = fixed.fold((0.0, 0.0), |sum, one| (sum.0 + one.0, sum.1 + one.1));
        let dials: Vec<Dial<'a>> = (accuracy.dials.iter())
            .filter_map(|curve| {
                let now = (curve.settings.iter()).position(|point| point.value == curve.current)?;
                Some(Dial {
                    factors: factors(curve, fixed)?,
                    curve,
                    now,
                })
            })
            .collect();
        let now = dials.iter().map(|dial| dial.factors[dial.now]);
        let now = now.fold(Factor::NEUTRAL, Factor::and);
        Some(Self {
            seconds: (point.seconds - now.more).max(0.0),
            processor: (point.processor_seconds.zip(now.more_processor))
                .map(|(all, more)| (all - more).max(0.0)),
            noise: point.error,
            dials,
        })
    }

    /// What settings come to, each dial's by `at`.
    fn come_to(&self, at: impl Fn(usize) -> usize) -> Factor {
        let chosen = (self.dials.iter().enumerate()).map(|(dial, own)| own.factors[at(dial)]);
        chosen.fold(Factor::NEUTRAL, Factor::and)
    }

    fn seconds(&self, whole: &Factor) -> f64 {
        self.seconds * whole.seconds + whole.more
    }

    fn error(&self, whole: &Factor) -> f64 {
        (whole.bias + self.noise * self.noise * whole.noise).sqrt()
    }

    fn choice(&self, at: impl Fn(usize) -> usize) -> Choice {
        let whole = self.come_to(&at);
        let processor = self
            .processor
            .zip(whole.processor)
            .zip(whole.more_processor);
        Choice {
            settings: (self.dials.iter().enumerate())
                .map(|(dial, own)| {
                    let point = &own.curve.settings[at(dial)];
                    (own.curve.name.clone(), point.value.clone())
                })
                .collect(),
            seconds: self.seconds(&whole),
            processor_seconds: processor.map(|((base, factor), more)| base * factor + more),
            error: self.error(&whole),
        }
    }

    /// The dials that do most, as many as can be combined in all ways.
    fn combined(&self) -> Vec<usize> {
        let mut order: Vec<usize> = (0..self.dials.len()).collect();
        let spread = |dial: &usize| spread(&self.dials[*dial].factors);
        order.sort_by(|one, other| spread(other).total_cmp(&spread(one)));
        let mut count = 1usize;
        order.retain(|dial| {
            let more = count.saturating_mul(self.dials[*dial].factors.len());
            let fits = more <= MOST;
            if fits {
                count = more;
            }
            fits
        });
        order
    }

    /// Which setting each dial has in a combination of those that are `combined`.
    fn digits(&self, combined: &[usize], mut choice: usize) -> Vec<usize> {
        let mut at: Vec<usize> = self.dials.iter().map(|dial| dial.now).collect();
        for dial in combined {
            let settings = self.dials[*dial].factors.len();
            at[*dial] = choice % settings;
            choice /= settings;
        }
        at
    }
}

impl Accuracy {
    /// The front, fastest first. Empty where no curve says how much noise there is.
    pub fn front(&self) -> Vec<Choice> {
        let Some(model) = Model::new(self) else {
            return Vec::new();
        };
        let combined = model.combined();
        let settings = combined.iter().map(|dial| model.dials[*dial].factors.len());
        let count: usize = settings.product();
        let mut all: Vec<(f64, f64, usize)> = (0..count)
            .map(|choice| {
                let digits = model.digits(&combined, choice);
                let whole = model.come_to(|dial| digits[dial]);
                (model.seconds(&whole), model.error(&whole), choice)
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
            .map(|(_, _, choice)| {
                let digits = model.digits(&combined, choice);
                model.choice(|dial| digits[dial])
            })
            .collect()
    }

    /// What the curves say of these settings, all other dials as they are; `None` where a curve
    /// has none of them, or none says how much noise there is.
    pub fn predict(&self, settings: &[(String, String)]) -> Option<Choice> {
        let model = Model::new(self)?;
        let mut at: Vec<usize> = model.dials.iter().map(|dial| dial.now).collect();
        for (name, value) in settings {
            let dial = model
                .dials
                .iter()
                .position(|dial| dial.curve.name == *name)?;
            let points = &model.dials[dial].curve.settings;
            at[dial] = points.iter().position(|point| point.value == *value)?;
        }
        Some(model.choice(|dial| at[dial]))
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
            chosen: Vec::new(),
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

    #[test]
    fn what_is_asked_for_counts_and_filtering_is_of_what_is_traced() {
        let mut measured = measured();
        // Of 66 seconds two are the filter's, which leaves half of the noise.
        for point in &mut measured.dials[2].settings {
            point.seconds += 2.0;
        }
        let denoise = [("off", 64.0, 0.12), ("on", 66.0, 0.06)];
        measured
            .dials
            .push(curve("denoise", Measure::Shown, "on", &denoise));
        measured.dials[1].current = "8".to_owned();
        let set = |settings: &[(&str, &str)]| {
            let owned = settings.iter();
            let owned: Vec<_> = owned.map(|(a, b)| (a.to_string(), b.to_string())).collect();
            measured.predict(&owned).unwrap()
        };
        // The order that is asked for is wrong by 0.01, whatever else is set.
        let now = set(&[]);
        assert!(
            (now.error - 0.01f64.hypot(0.5 * 0.1)).abs() < 1e-12,
            "{now:?}"
        );
        assert!((now.seconds - 66.0).abs() < 1e-12);
        let off = set(&[("denoise", "off")]);
        assert!((off.error - 0.01f64.hypot(0.1)).abs() < 1e-12, "{off:?}");
        assert!((off.seconds - 64.0).abs() < 1e-12);
        // The filter takes its time however few paths there are.
        let few = set(&[("spp", "1")]);
        assert!((few.seconds - 3.0).abs() < 1e-12, "{few:?}");
        let front = measured.front();
        assert!(front.iter().all(|choice| choice.settings.len() == 3));
        // What is asked for lies on the front or above it.
        let beats = |choice: &Choice| {
            choice.seconds <= now.seconds + 1e-9 && choice.error <= now.error + 1e-9
        };
        assert!(front.iter().any(beats), "{now:?} {front:?}");
        // A setting that no ladder has says nothing of the rest.
        measured.dials[1].current = "9".to_owned();
        assert!((measured.predict(&[]).unwrap().error - 0.05).abs() < 1e-12);
    }
}
