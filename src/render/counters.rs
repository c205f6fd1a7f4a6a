//! What went on and what went wrong while tracing: counted, never hidden.

use std::ops::AddAssign;

/// Counts of one thread's work. They are whole numbers, so that adding them up gives
/// the same in every order.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Counters {
    /// Paths begun at the camera.
    pub paths: u64,
    /// Real collisions.
    pub scatterings: u64,
    /// Shadow rays walked.
    pub shadow_rays: u64,
    /// Voxel lookups.
    pub lookups: u64,
    /// Lookups whose extinction was above the majorant of their stretch; anything but 0
    /// makes the picture wrong.
    pub majorant_violations: u64,
    /// Walks ended by [`super::track::STEP_CAP`]; they count as absorbed.
    pub capped_walks: u64,
    /// Walks not begun because the ray was not finite or its direction not of length 1.
    pub invalid_rays: u64,
    /// Samples left out of the film because they were not finite.
    pub invalid_samples: u64,
}

impl AddAssign for Counters {
    fn add_assign(&mut self, other: Self) {
        self.paths += other.paths;
        self.scatterings += other.scatterings;
        self.shadow_rays += other.shadow_rays;
        self.lookups += other.lookups;
        self.majorant_violations += other.majorant_violations;
        self.capped_walks += other.capped_walks;
        self.invalid_rays += other.invalid_rays;
        self.invalid_samples += other.invalid_samples;
    }
}

impl Counters {
    /// What was given up or left out, one line each: the picture is not all that was asked
    /// for where there is any.
    pub fn warnings(&self) -> Vec<String> {
        let mut warnings = Vec::new();
        if self.capped_walks > 0 {
            let what = if self.capped_walks > self.paths / 1000 {
                ": the extinction is too large somewhere; give it in 1/mm"
            } else {
                ", too few to be seen"
            };
            warnings.push(format!(
                "walks of light that found no end within {} steps and count as absorbed: {} on \
                 {} paths{what}",
                super::track::STEP_CAP,
                self.capped_walks,
                self.paths
            ));
        }
        if self.invalid_rays > 0 {
            warnings.push(format!(
                "{} rays had no place or direction and were left out",
                self.invalid_rays
            ));
        }
        warnings
    }
}

impl std::iter::Sum for Counters {
    fn sum<I: Iterator<Item = Self>>(all: I) -> Self {
        all.fold(Self::default(), |mut sum, one| {
            sum += one;
            sum
        })
    }
}
