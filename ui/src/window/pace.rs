//! What this machine can do: how fast and how well the cloth was traced so far, and what
//! size of picture that is enough for.

/// Widths that are proposed, pixels, the largest first.
const WIDTHS: [u32; 6] = [2560, 1920, 1600, 1280, 960, 640];
/// Where nothing was traced yet.
const UNMEASURED: Proposal = Proposal {
    width: 1280,
    seconds: 60.0,
};
/// A proposed picture comes to this error, before it is denoised, …
const GOOD_ERROR: f64 = 0.05;
/// … within so many seconds.
const PATIENCE: f64 = 300.0;
/// The shortest time that is proposed, s.
const SHORTEST: f64 = 10.0;

/// How the cloth was traced.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measured {
    pub paths_per_second: f64,
    /// The error of one path a pixel; it falls with the square root of their number.
    pub error_of_one: f64,
}

/// A size and a time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Proposal {
    pub width: u32,
    pub seconds: f64,
}

impl Measured {
    /// Of a picture with so many pixels and paths in each, after so many seconds, with this
    /// error; `None` where that says nothing.
    pub fn of(pixels: f64, spp: u32, seconds: f64, error: Option<f64>) -> Option<Self> {
        let paths = pixels * f64::from(spp);
        let measured = Self {
            paths_per_second: paths / seconds,
            error_of_one: error? * f64::from(spp).sqrt(),
        };
        let counts = |number: f64| number.is_finite() && number > 0.0;
        (spp > 0 && counts(measured.paths_per_second) && counts(measured.error_of_one))
            .then_some(measured)
    }

    /// The error of a picture after so many seconds of tracing.
    pub fn error_after(&self, pixels: f64, seconds: f64) -> f64 {
        let spp = (self.paths_per_second * seconds / pixels.max(1.0)).max(1.0);
        self.error_of(spp)
    }

    /// The error of so many paths a pixel.
    pub fn error_of(&self, spp: f64) -> f64 {
        self.error_of_one / spp.max(1.0).sqrt()
    }

    /// Seconds of tracing until so many paths are in every pixel.
    pub fn seconds_of(&self, pixels: f64, spp: f64) -> f64 {
        pixels * spp.max(1.0) / self.paths_per_second
    }

    /// Seconds of tracing until a picture has this error.
    pub fn seconds_to(&self, pixels: f64, error: f64) -> f64 {
        self.seconds_of(pixels, (self.error_of_one / error).powi(2))
    }
}

/// The largest picture that becomes good in reasonable time; `aspect` = height over width.
pub fn propose(measured: Option<Measured>, aspect: f64) -> Proposal {
    let Some(measured) = measured else {
        return UNMEASURED;
    };
    let seconds = |width: u32| measured.seconds_to(f64::from(width).powi(2) * aspect, GOOD_ERROR);
    let smallest = WIDTHS[WIDTHS.len() - 1];
    let width = WIDTHS.into_iter().find(|&width| seconds(width) <= PATIENCE);
    let width = width.unwrap_or(smallest);
    // In whole tens, as a person would say it.
    let tens = (seconds(width) / 10.0).ceil() * 10.0;
    Proposal {
        width,
        seconds: tens.clamp(SHORTEST, PATIENCE),
    }
}

/// Seconds as a person says them.
pub fn in_words(seconds: f64) -> String {
    match seconds.max(0.0).ceil() {
        hours if hours >= 7200.0 => format!("{:.0} h", hours / 3600.0),
        minutes if minutes >= 120.0 => format!("{:.0} min", minutes / 60.0),
        seconds => format!("{seconds:.0} s"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_fall_with_the_square_root_of_paths() {
        // 100 × 100 pixels, 16 paths each in 2 s: 80 000 paths a second.
        let measured = Measured::of(1e4, 16, 2.0, Some(0.1)).expect("measured");
        assert!((measured.paths_per_second - 8e4).abs() < 1.0);
        assert!((measured.error_of(64.0) - 0.05).abs() < 1e-9);
        // Half the error takes four times the time.
        assert!((measured.seconds_to(1e4, 0.05) - 8.0).abs() < 1e-9);
        assert!((measured.error_after(1e4, 8.0) - 0.05).abs() < 1e-9);
        for (pixels, spp, seconds, error) in [
            (1e4, 0, 2.0, Some(0.1)),
            (1e4, 4, 0.0, Some(0.1)),
            (1e4, 4, 2.0, None),
            (1e4, 4, 2.0, Some(f64::NAN)),
        ] {
            assert_eq!(Measured::of(pixels, spp, seconds, error), None);
        }
    }

    #[test]
    fn what_is_proposed_is_good_in_the_time_that_is_said() {
        let aspect = 0.8;
        let mut before = 0;
        for paths_per_second in [1e4, 1e5, 1e6, 1e7, 1e8] {
            let measured = Measured {
                paths_per_second,
                error_of_one: 0.5,
            };
            let Proposal { width, seconds } = propose(Some(measured), aspect);
            let pixels = f64::from(width).powi(2) * aspect;
            let error = measured.error_after(pixels, seconds);
            assert!(error <= GOOD_ERROR * 1.001 || width == 640, "{error}");
            assert!((SHORTEST..=PATIENCE).contains(&seconds));
            assert!(width >= before, "a faster machine draws larger");
            before = width;
        }
        assert_eq!(before, 2560);
        assert_eq!(propose(None, aspect), UNMEASURED);
    }
}
