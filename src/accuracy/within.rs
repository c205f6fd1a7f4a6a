//! Dials by a budget: the settings that make the most of so many seconds, or that are soonest
//! no more wrong than so much.

use super::curve::Accuracy;
use super::model::{Choice, Factor, Model, PATHS};
use crate::limits;
use crate::plan::Budget;

impl Accuracy {
    /// What the curves say is the best use of a budget: the most accurate settings that take no
    /// longer, the fastest of all where none does, or the fastest that are no more wrong. Paths
    /// a pixel are a setting as well, and any number of them. `None` where no setting is so
    /// good, or the curves do not say how much noise there is, or what is seen of it.
    pub fn within(&self, budget: Budget) -> Option<Choice> {
        let model = Model::new(self)?;
        if self.spp == 0 || (matches!(budget, Budget::DeltaE(_)) && model.grain.is_none()) {
            return None;
        }
        let paths = (model.dials.iter()).position(|dial| dial.curve.name == PATHS);
        let mut combined = model.combined();
        combined.retain(|dial| Some(*dial) != paths);
        let settings = combined.iter().map(|dial| model.dials[*dial].factors.len());
        let count: usize = settings.product();
        let known = f64::from(self.spp);
        let tried = (0..count).filter_map(|choice| {
            let digits = model.digits(&combined, choice);
            let one = OnePath::new(&model, &model.come_to(|dial| digits[dial]), known);
            let many = one.paths(budget)?;
            Some((one.rank(many, budget), many, choice))
        });
        let by_rank = |one: &([f64; 2], f64, usize), other: &([f64; 2], f64, usize)| {
            let [late, worse] = [0, 1].map(|at: usize| one.0[at].total_cmp(&other.0[at]));
            late.then(worse).then(one.2.cmp(&other.2))
        };
        let (_, many, choice) = tried.min_by(by_rank)?;
        let digits = model.digits(&combined, choice);
        Some(model.with_paths(|dial| digits[dial], many, known))
    }
}

/// What settings come to, path by path.
struct OnePath {
    /// Seconds of one path a pixel, and of all that no path takes.
    seconds: f64,
    more: f64,
    /// Squared: what is wrong whatever the paths, and the noise of one path a pixel.
    bias: f64,
    noise: f64,
    /// Likewise what is seen of both.
    tint: f64,
    grain: f64,
}

impl OnePath {
    fn new(model: &Model<'_>, whole: &Factor, known: f64) -> Self {
        let grain = model.grain.unwrap_or(0.0);
        Self {
            seconds: model.seconds * whole.seconds / known,
            more: whole.more,
            bias: whole.bias,
            noise: model.noise * model.noise * whole.noise * known,
            tint: whole.tint,
            grain: grain * grain * whole.grain * known,
        }
    }

    /// How many make use of a budget; `None` where none keep within it.
    fn paths(&self, budget: Budget) -> Option<f64> {
        let many = match budget {
            Budget::Seconds(seconds) => ((seconds - self.more) / self.seconds).floor(),
            Budget::Error(error) => enough(self.noise, error * error - self.bias)?,
            Budget::DeltaE(delta_e) => enough(self.grain, delta_e * delta_e - self.tint)?,
        };
        let [least, most] = [limits::STILL_SPP.start(), limits::STILL_SPP.end()];
        let many = many.max(f64::from(*least));
        // Fewer than are enough are not.
        let is_time = matches!(budget, Budget::Seconds(_));
        (is_time || many <= f64::from(*most)).then_some(many.min(f64::from(*most)))
    }

    /// What is less is better: first of all to keep within the time.
    fn rank(&self, many: f64, budget: Budget) -> [f64; 2] {
        let seconds = self.more + self.seconds * many;
        match budget {
            Budget::Seconds(most) => {
                let late = if seconds > most { seconds } else { 0.0 };
                [late, self.bias + self.noise / many]
            }
            Budget::Error(_) | Budget::DeltaE(_) => [seconds, self.bias],
        }
    }
}

/// Paths of which each brings `one` in squares, until no more than `left` is left.
fn enough(one: f64, left: f64) -> Option<f64> {
    (left > 0.0).then(|| (one / left).ceil())
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;
    use crate::accuracy::model::tests::measured;

    fn set<'c>(choice: &'c Choice, name: &str) -> &'c str {
        let known = choice.settings.iter().find(|(own, _)| own == name);
        &known.unwrap().1
    }

    #[test]
    fn time_is_spent_to_the_last_path() {
        let measured = measured();
        // Order 1 takes a quarter of a second a path, order 8 three quarters, order 64 one.
        let choice = measured.within(Budget::Seconds(50.0)).unwrap();
        assert_eq!((set(&choice, "order"), set(&choice, "spp")), ("8", "66"));
        assert!((choice.seconds - 49.5).abs() < 1e-9, "{choice:?}");
        let error = f64::hypot(0.01, 0.8 / 66f64.sqrt());
        assert!((choice.error - error).abs() < 1e-9 && choice.bias == 0.01);
        // Brute force over all orders and paths finds no better one.
        for (each, bias) in [(0.25, 0.5), (0.75, 0.01), (1.0, 0.0)] {
            for paths in 1..=200 {
                let wrong = f64::hypot(bias, 0.8 / f64::from(paths).sqrt());
                assert!(each * f64::from(paths) > 50.0 || wrong >= choice.error - 1e-12);
            }
        }
        // The fastest of all, where no time is enough.
        let fastest = measured.within(Budget::Seconds(0.01)).unwrap();
        assert_eq!((set(&fastest, "order"), fastest.seconds), ("1", 0.25));
    }

    #[test]
    fn an_error_is_kept_as_soon_as_can_be() {
        let measured = measured();
        let choice = measured.within(Budget::Error(0.05)).unwrap();
        // 0.8² / (0.05² − 0.01²), at three quarters of a second each, beats 256 of one second.
        assert_eq!((set(&choice, "order"), set(&choice, "spp")), ("8", "267"));
        assert!(choice.error <= 0.05 && choice.seconds < 256.0);
        // Below what order 8 lacks, it takes all.
        let choice = measured.within(Budget::Error(0.009)).unwrap();
        assert_eq!(set(&choice, "order"), "64");
        // No number of paths that anybody may ask for is so good.
        assert_eq!(measured.within(Budget::Error(1e-4)), None);
    }

    #[test]
    fn a_colour_difference_takes_curves_that_saw_it() {
        let mut measured = measured();
        assert_eq!(measured.within(Budget::DeltaE(1.0)), None);
        for (dial, seen) in [(1, [20.0, 0.5, 0.0]), (2, [16.0, 4.0, 2.0])] {
            for (point, delta_e) in measured.dials[dial].settings.iter_mut().zip(seen) {
                point.delta_e = Some(delta_e);
            }
        }
        let choice = measured.within(Budget::DeltaE(1.0)).unwrap();
        // 16² / (1 − 0.25) paths of three quarters of a second, or 256 of one second.
        assert_eq!((set(&choice, "order"), set(&choice, "spp")), ("64", "256"));
        assert!((choice.delta_e.unwrap() - 1.0).abs() < 1e-9);
        let loose = measured.within(Budget::DeltaE(2.0)).unwrap();
        assert_eq!((set(&loose, "order"), set(&loose, "spp")), ("8", "69"));
    }

    #[test]
    fn nothing_is_said_of_paths_that_nobody_counted() {
        let mut silent = measured();
        silent.dials.pop();
        assert_eq!(silent.within(Budget::Seconds(1.0)), None);
        let mut uncounted = measured();
        uncounted.spp = 0;
        assert_eq!(uncounted.within(Budget::Seconds(1.0)), None);
    }
}
