//! All dials together: the settings for which no other is both faster and more accurate.

use super::curve::Accuracy;
use super::model::{Choice, Model};

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
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;
    use crate::accuracy::model::tests::{curve, measured};
    use crate::plan::Measure;

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
