//! What the curves say of settings of several dials together.
//!
//! The curves are taken to add: a dial's setting multiplies the time and the noise of any
//! picture by what it multiplied those of the measured one by, and what it gets wrong whatever
//! the number of paths adds up in squares.

use super::curve::{Accuracy, Curve, Point};
use crate::plan::Measure;

/// The dial that says how many paths there are: any number between its settings will do.
pub(super) const PATHS: &str = "spp";
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
    /// The part of the error that no paths make smaller.
    pub bias: f64,
    /// Mean ΔE₀₀ from 30 cm of all that is wrong with it; `None` where nothing was measured of
    /// what is seen of noise.
    pub delta_e: Option<f64>,
}

/// What a setting does to a picture.
#[derive(Debug, Clone, Copy)]
pub(super) struct Factor {
    /// Multiplies the time that tracing takes.
    pub seconds: f64,
    processor: Option<f64>,
    /// Seconds more of the whole picture, however many paths.
    pub more: f64,
    more_processor: Option<f64>,
    /// Relative square error however many paths.
    pub bias: f64,
    /// Multiplies the squared noise.
    pub noise: f64,
    /// Squared ΔE₀₀ however many paths.
    pub tint: f64,
    /// Multiplies the squared ΔE₀₀ of the noise.
    pub grain: f64,
}

impl Factor {
    const NEUTRAL: Self = Self {
        seconds: 1.0,
        processor: Some(1.0),
        more: 0.0,
        more_processor: Some(0.0),
        bias: 0.0,
        noise: 1.0,
        tint: 0.0,
        grain: 1.0,
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
            tint: self.tint + other.tint,
            grain: self.grain * other.grain,
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
                let (tint, grain) = match curve.measure {
                    Measure::Bias => (point.delta_e.unwrap_or(0.0), noise),
                    _ => {
                        let both = point.delta_e.zip(now.delta_e);
                        let grain = both.and_then(|(one, other)| ratio(one, other));
                        (0.0, grain.unwrap_or(noise))
                    }
                };
                Some(Factor {
                    seconds: ratio(point.seconds - fixed.0, now.seconds - fixed.0)?,
                    processor: processor(now)
                        .and_then(|(one, other)| ratio(one - fixed.1, other - fixed.1)),
                    bias,
                    noise: noise * noise,
                    tint: tint * tint,
                    grain: grain * grain,
                    ..Factor::NEUTRAL
                })
            }
            // The crude end shows what was traced as it is.
            Measure::Shown => {
                let noise = ratio(point.error, crude.error)?;
                let seen = point.delta_e.zip(crude.delta_e);
                let grain = seen.and_then(|(one, other)| ratio(one, other));
                let grain = grain.unwrap_or(noise);
                Some(Factor {
                    more: point.seconds - crude.seconds,
                    more_processor: processor(crude).map(|(one, other)| one - other),
                    noise: noise * noise,
                    grain: grain * grain,
                    ..Factor::NEUTRAL
                })
            }
            // What has another unit does not add to these, nor does another engine.
            Measure::Continuity
            | Measure::Seams
            | Measure::Kinks
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
pub(super) struct Dial<'a> {
    pub curve: &'a Curve,
    pub factors: Vec<Factor>,
    /// What it is set to, among its settings.
    pub now: usize,
}

/// All dials that add, and the picture that their factors multiply.
pub(super) struct Model<'a> {
    pub dials: Vec<Dial<'a>>,
    /// Seconds, of the clock and of processors, that tracing takes.
    pub seconds: f64,
    processor: Option<f64>,
    /// Relative root mean square of what is traced.
    pub noise: f64,
    /// What an eye sees of it, ΔE₀₀.
    pub grain: Option<f64>,
}

impl<'a> Model<'a> {
    /// What the curves say; `None` where none says how much noise there is.
    pub fn new(accuracy: &'a Accuracy) -> Option<Self> {
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
            grain: point.delta_e,
            dials,
        })
    }

    /// What settings come to, each dial's by `at`.
    pub fn come_to(&self, at: impl Fn(usize) -> usize) -> Factor {
        let chosen = (self.dials.iter().enumerate()).map(|(dial, own)| own.factors[at(dial)]);
        chosen.fold(Factor::NEUTRAL, Factor::and)
    }

    pub fn seconds(&self, whole: &Factor) -> f64 {
        self.seconds * whole.seconds + whole.more
    }

    pub fn error(&self, whole: &Factor) -> f64 {
        (whole.bias + self.noise * self.noise * whole.noise).sqrt()
    }

    fn delta_e(&self, whole: &Factor) -> Option<f64> {
        let grain = self.grain?;
        Some((whole.tint + grain * grain * whole.grain).sqrt())
    }

    /// Settings, each dial's by `at`, with what they come to.
    pub fn choice(&self, at: impl Fn(usize) -> usize) -> Choice {
        self.settings(&at, &self.come_to(&at))
    }

    fn settings(&self, at: &dyn Fn(usize) -> usize, whole: &Factor) -> Choice {
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
            seconds: self.seconds(whole),
            processor_seconds: processor.map(|((base, factor), more)| base * factor + more),
            error: self.error(whole),
            bias: whole.bias.sqrt(),
            delta_e: self.delta_e(whole),
        }
    }

    /// As [`Model::choice`], with so many `paths` a pixel instead of the `known` ones.
    pub fn with_paths(&self, at: impl Fn(usize) -> usize, paths: f64, known: f64) -> Choice {
        let whole = self.come_to(&at);
        let times = paths / known;
        let whole = Factor {
            seconds: whole.seconds * times,
            processor: whole.processor.map(|processor| processor * times),
            noise: whole.noise / times,
            grain: whole.grain / times,
            ..whole
        };
        let mut choice = self.settings(&at, &whole);
        choice.settings.retain(|(name, _)| name != PATHS);
        let paths = format!("{paths:.0}");
        choice.settings.push((PATHS.to_owned(), paths));
        choice
    }

    /// The dials that do most, as many as can be combined in all ways.
    pub fn combined(&self) -> Vec<usize> {
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
    pub fn digits(&self, combined: &[usize], mut choice: usize) -> Vec<usize> {
        let mut at: Vec<usize> = self.dials.iter().map(|dial| dial.now).collect();
        for dial in combined {
            let settings = self.dials[*dial].factors.len();
            at[*dial] = choice % settings;
            choice /= settings;
        }
        at
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
pub(super) mod tests {
    use super::*;
    use crate::accuracy::curve::Machine;
    use crate::accuracy::estimate::Estimate;

    pub fn curve(
        name: &str,
        measure: Measure,
        current: &str,
        points: &[(&str, f64, f64)],
    ) -> Curve {
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

    pub fn measured() -> Accuracy {
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
            spp: 64,
        }
    }
}
