//! When a picture that is refined will be how good, and how good such forecasts were.

use super::pace;

/// The errors that are foretold.
const ERRORS: [f64; 3] = [0.05, 0.02, 0.01];
/// A picture that is sooner there than this, s, needs no forecast.
const SOON: f64 = 1.0;
/// Outcomes that are remembered.
const MOST: usize = 256;

/// The forecasts of the picture that is refined, and what became of those before.
#[derive(Default)]
pub struct Forecast {
    /// The picture that they are of.
    generation: Option<u64>,
    /// Seconds of tracing after which each error was said to be reached, as it was said first.
    told: [Option<f64>; ERRORS.len()],
    /// The same as it is known now.
    now: [Option<f64>; ERRORS.len()],
    /// Seconds that it took for each that was said.
    outcomes: Vec<f64>,
}

impl Forecast {
    /// Takes note of a picture after so many seconds of tracing.
    pub fn note(&mut self, generation: u64, seconds: f64, error: f64) {
        let sound = seconds > 0.0 && seconds.is_finite() && error > 0.0 && error.is_finite();
        if !sound {
            return;
        }
        if self.generation != Some(generation) {
            self.generation = Some(generation);
            (self.told, self.now) = Default::default();
        }
        for (place, wanted) in ERRORS.into_iter().enumerate() {
            // The error falls with the square root of the paths, and these with the time.
            let at = seconds * (error / wanted).powi(2);
            if error > wanted {
                self.now[place] = Some(at);
                if at - seconds > SOON {
                    self.told[place].get_or_insert(at);
                }
                continue;
            }
            self.now[place] = None;
            if let Some(told) = self.told[place].take() {
                // It was there somewhat before it was looked at.
                self.outcomes.push(at / told);
                let over = self.outcomes.len().saturating_sub(MOST);
                self.outcomes.drain(..over);
            }
        }
    }

    /// What is foretold of a picture of this age, in words; nothing where there is nothing left.
    pub fn words(&self, seconds: f64) -> Option<String> {
        let left = self.now.iter().zip(ERRORS).filter_map(|(at, error)| {
            let left = pace::in_words(((*at)? - seconds).max(1.0));
            Some(format!("{:.0} % in {left}", 100.0 * error))
        });
        let left: Vec<String> = left.collect();
        (!left.is_empty()).then(|| format!("An error of {}.", left.join(", of ")))
    }

    /// How good forecasts were, in words.
    pub fn record(&self) -> Option<String> {
        let mut off: Vec<f64> = (self.outcomes.iter())
            .map(|took| 100.0 * (took - 1.0).abs())
            .collect();
        off.sort_by(f64::total_cmp);
        let (half, most) = (off.get(off.len() / 2)?, off.last()?);
        Some(match off.len() {
            1 => format!("The one forecast so far was off by {most:.0} % of the time."),
            count => format!(
                "Of {count} forecasts so far half were off by {half:.0} % of the time or less, all \
                 by {most:.0} % at most."
            ),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_the_error_takes_four_times_the_time() {
        let mut forecast = Forecast::default();
        assert_eq!(forecast.words(0.0), None);
        forecast.note(1, 2.0, 0.1);
        assert_eq!(
            forecast.words(2.0).as_deref(),
            Some("An error of 5 % in 6 s, of 2 % in 48 s, of 1 % in 3 min.")
        );
        assert_eq!(forecast.record(), None);
        // It came as it was said, and once much later.
        forecast.note(1, 8.0, 0.05);
        assert_eq!(
            forecast.record().as_deref(),
            Some("The one forecast so far was off by 0 % of the time.")
        );
        forecast.note(1, 100.0, 0.02);
        forecast.note(1, 200.0, 0.01);
        assert_eq!(forecast.words(200.0), None);
        assert_eq!(
            forecast.record().as_deref(),
            Some(
                "Of 3 forecasts so far half were off by 0 % of the time or less, all by 100 % at \
                 most."
            )
        );
    }

    #[test]
    fn another_picture_is_foretold_anew_and_what_is_no_error_is_passed_over() {
        let mut forecast = Forecast::default();
        forecast.note(1, 2.0, 0.1);
        forecast.note(2, 1.0, 0.06);
        // The first picture's forecast came to nothing, and is no outcome.
        forecast.note(2, 2.0, 0.04);
        assert_eq!(forecast.record(), None, "it was there within a second");
        for (seconds, error) in [(0.0, 0.1), (1.0, f64::NAN), (1.0, 0.0), (f64::NAN, 0.1)] {
            forecast.note(3, seconds, error);
        }
        assert_eq!(forecast.generation, Some(2));
    }
}
