//! The two clocks of a measurement: the wall's, and the processor's, which does not count
//! what else the machine does meanwhile.

use std::time::Instant;

/// A moment on both clocks.
#[derive(Debug, Clone, Copy)]
pub struct Clock {
    wall: Instant,
    processor: Option<f64>,
}

/// What something took.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Took {
    /// Seconds that passed.
    pub seconds: f64,
    /// Seconds that processors worked on it, all threads together; `None` where the system
    /// does not tell.
    pub processor_seconds: Option<f64>,
}

impl Clock {
    /// Now.
    pub fn now() -> Self {
        Self {
            wall: Instant::now(),
            processor: processor(),
        }
    }

    /// What passed since.
    pub fn took(&self) -> Took {
        let now = processor();
        Took {
            seconds: self.wall.elapsed().as_secs_f64(),
            processor_seconds: now.zip(self.processor).map(|(now, then)| now - then),
        }
    }
}

impl Took {
    /// What is left of it beside a part.
    pub fn without(self, part: Self) -> Self {
        let both = self.processor_seconds.zip(part.processor_seconds);
        Self {
            seconds: (self.seconds - part.seconds).max(0.0),
            processor_seconds: both.map(|(all, part)| (all - part).max(0.0)),
        }
    }
}

/// Seconds that this process has worked.
#[cfg(unix)]
fn processor() -> Option<f64> {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    Some(time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9)
}

/// Seconds that this process has worked.
#[cfg(not(unix))]
fn processor() -> Option<f64> {
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sleep_passes_and_is_no_work() {
        let clock = Clock::now();
        std::thread::sleep(std::time::Duration::from_millis(50));
        let took = clock.took();
        assert!(took.seconds >= 0.05);
        let begun = Clock::now();
        let mut sum = 0u64;
        while begun.wall.elapsed().as_millis() < 50 {
            sum = std::hint::black_box(sum.wrapping_mul(5).wrapping_add(1));
        }
        let worked = begun.took().processor_seconds;
        // Whatever else the machine does, some of that time was ours.
        assert!(worked.is_none_or(|worked| worked > 1e-3), "{worked:?}");
    }
}
