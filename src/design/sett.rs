//! Sett: threads per length, and where each thread lies.
//!
//! Cloth coordinates map to crossings through prefix arrays of thread positions
//! ([`Positions`]), never by dividing by a pitch: threads of one cloth may be spaced
//! unequally.

use serde::{Deserialize, Serialize};

use crate::limits;

/// How densely the threads of one direction lie.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Density {
    /// Threads per cm where no list says otherwise.
    pub per_cm: f32,
    /// Pitch of each thread in mm (centre to centre), repeating; `None` = all equal.
    pub pitches_mm: Option<Vec<f32>>,
}

impl Density {
    /// Equally spaced threads.
    pub fn per_cm(per_cm: f32) -> Self {
        Self {
            per_cm,
            pitches_mm: None,
        }
    }

    /// The usual pitch in mm.
    pub fn pitch_mm(&self) -> f32 {
        10.0 / self.per_cm
    }

    /// Pitch of one thread in mm.
    pub fn pitch_of(&self, thread: i64) -> f32 {
        match &self.pitches_mm {
            Some(list) if !list.is_empty() => list[thread.rem_euclid(list.len() as i64) as usize],
            _ => self.pitch_mm(),
        }
    }

    /// Mean pitch over the list in mm.
    pub fn mean_pitch_mm(&self) -> f32 {
        match &self.pitches_mm {
            Some(list) if !list.is_empty() => {
                (list.iter().map(|&pitch| f64::from(pitch)).sum::<f64>() / list.len() as f64) as f32
            }
            _ => self.pitch_mm(),
        }
    }

    /// The positions of `threads` threads, after which they repeat.
    pub fn positions(&self, threads: u32) -> Positions {
        Positions::new((0..i64::from(threads.max(1))).map(|thread| self.pitch_of(thread)))
    }

    fn fault(&self, what: &str) -> Option<String> {
        let usable = |value: f32| (MIN_PITCH_MM..=MAX_PITCH_MM).contains(&value);
        if !limits::can_be_woven(self.pitch_mm()) {
            let (per_cm, range) = (self.per_cm, limits::in_words(&limits::SETT_PER_CM));
            return Some(format!(
                "{per_cm} {what} per cm cannot be woven: give {range}"
            ));
        }
        let list = self.pitches_mm.as_ref()?;
        if list.is_empty() {
            return Some(format!("the list of {what} pitches is empty: leave it out"));
        }
        let place = list.iter().position(|&pitch| !usable(pitch))?;
        Some(format!(
            "pitch {} of the {what} is {} mm, but must lie in {MIN_PITCH_MM} to {MAX_PITCH_MM}",
            place + 1,
            list[place]
        ))
    }
}

/// The smallest pitch taken, in mm.
pub const MIN_PITCH_MM: f32 = *limits::THREAD_PITCH_MM.start();
/// The largest pitch taken, in mm.
pub const MAX_PITCH_MM: f32 = *limits::THREAD_PITCH_MM.end();

/// Ends and picks per length.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Sett {
    /// Of the warp.
    pub ends: Density,
    /// Of the weft.
    pub picks: Density,
    /// Nobody chose it: it is what is usual for the yarns.
    #[serde(default)]
    pub assumed: bool,
}

impl Sett {
    /// Equally spaced ends and picks, chosen by somebody.
    pub fn per_cm(ends: f32, picks: f32) -> Self {
        Self {
            ends: Density::per_cm(ends),
            picks: Density::per_cm(picks),
            assumed: false,
        }
    }

    /// Centre-to-centre distance of the ends in mm, where no list says otherwise.
    pub fn end_pitch_mm(&self) -> f32 {
        self.ends.pitch_mm()
    }

    /// Centre-to-centre distance of the picks in mm, where no list says otherwise.
    pub fn pick_pitch_mm(&self) -> f32 {
        self.picks.pitch_mm()
    }

    /// The first number that cannot be, as a line for the designer; `None` if all can.
    pub fn fault(&self) -> Option<String> {
        self.ends
            .fault("ends")
            .or_else(|| self.picks.fault("picks"))
    }
}

/// Where the threads of one direction lie in mm, over one repeat and for ever after it.
///
/// Thread i owns the stretch from `start(i)` to `start(i + 1)`; its centre is the middle.
#[derive(Debug, Clone, PartialEq)]
pub struct Positions {
    /// Start of each thread; one more than there are threads.
    starts: Vec<f64>,
    /// First thread that can own a point of each of as many equal stretches.
    buckets: Vec<u32>,
    per_mm: f64,
    /// Where positions are counted from.
    origin_mm: f64,
}

impl Positions {
    /// From the pitch of each thread in mm; pitches that cannot be count as the smallest.
    pub fn new(pitches_mm: impl IntoIterator<Item = f32>) -> Self {
        let mut starts = vec![0.0];
        let mut sum = 0.0;
        for pitch in pitches_mm {
            let usable = if pitch.is_nan() { MIN_PITCH_MM } else { pitch };
            sum += f64::from(usable.clamp(MIN_PITCH_MM, MAX_PITCH_MM));
            starts.push(sum);
        }
        if starts.len() == 1 {
            starts.push(1.0);
            sum = 1.0;
        }
        let threads = starts.len() - 1;
        let per_mm = threads as f64 / sum;
        let mut buckets = Vec::with_capacity(threads + 1);
        let mut thread = 0;
        for bucket in 0..=threads {
            let from = bucket as f64 / per_mm;
            while thread + 1 < threads && starts[thread + 1] <= from {
                thread += 1;
            }
            buckets.push(thread as u32);
        }
        Self {
            starts,
            buckets,
            per_mm,
            origin_mm: 0.0,
        }
    }

    /// The same threads with positions counted from a place, mm: near it 32 bits are enough
    /// for all that is worked out of a position, however far it is from the first thread.
    pub fn seen_from(mut self, origin_mm: f64) -> Self {
        self.origin_mm = origin_mm;
        self
    }

    /// Where positions are counted from, mm from the start of the first thread.
    pub fn origin_mm(&self) -> f64 {
        self.origin_mm
    }

    /// Threads in one repeat.
    pub fn threads(&self) -> u32 {
        (self.starts.len() - 1) as u32
    }

    /// Length of one repeat in mm.
    pub fn repeat_mm(&self) -> f64 {
        self.starts[self.starts.len() - 1]
    }

    /// Where thread `thread` of the endless cloth starts, in mm.
    pub fn start(&self, thread: i64) -> f64 {
        let threads = i64::from(self.threads());
        let repeat = thread.div_euclid(threads);
        let start = self.starts[thread.rem_euclid(threads) as usize];
        repeat as f64 * self.repeat_mm() + start - self.origin_mm
    }

    /// Width of thread `thread`'s stretch in mm.
    pub fn pitch(&self, thread: i64) -> f64 {
        let within = thread.rem_euclid(i64::from(self.threads())) as usize;
        self.starts[within + 1] - self.starts[within]
    }

    /// The middle of thread `thread` of the endless cloth, in mm.
    pub fn centre(&self, thread: i64) -> f64 {
        self.start(thread) + 0.5 * self.pitch(thread)
    }

    /// The thread of the endless cloth that owns position `mm`, and how far through its
    /// stretch that is (0..1). Positions that are no number belong to thread 0.
    pub fn locate(&self, mm: f64) -> (i64, f64) {
        let repeat_mm = self.repeat_mm();
        let mm = mm + self.origin_mm;
        let repeat = (mm / repeat_mm).floor();
        let local = mm - repeat * repeat_mm;
        // Rounding may leave the remainder just outside; the bounds below hold it in.
        let threads = self.threads() as usize;
        let bucket = ((local * self.per_mm) as usize).min(threads);
        let mut thread = self.buckets[bucket] as usize;
        while thread > 0 && local < self.starts[thread] {
            thread -= 1;
        }
        while thread + 1 < threads && local >= self.starts[thread + 1] {
            thread += 1;
        }
        let (from, to) = (self.starts[thread], self.starts[thread + 1]);
        let through = ((local - from) / (to - from)).clamp(0.0, 1.0);
        let through = if through < 1.0 { through } else { LAST_THROUGH };
        let whole = if repeat.is_finite() {
            (repeat as i64).saturating_mul(threads as i64)
        } else {
            0
        };
        (whole.saturating_add(thread as i64), through)
    }
}

/// The largest fraction below one.
const LAST_THROUGH: f64 = 1.0 - f64::EPSILON / 2.0;

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;

    #[test]
    fn equal_threads_lie_at_multiples_of_the_pitch() {
        let positions = Density::per_cm(20.0).positions(7);
        assert!((positions.repeat_mm() - 3.5).abs() < 1e-9);
        assert_eq!(positions.locate(0.26).0, 0);
        assert_eq!(positions.locate(0.51).0, 1);
        assert_eq!(positions.locate(-0.01).0, -1);
        assert_eq!(positions.locate(35.2).0, 70);
    }

    #[test]
    fn every_thread_owns_its_own_centre_and_start() {
        let pitches = [0.1, 0.5, 0.05, 0.05, 2.0, 0.3];
        let positions = Positions::new(pitches);
        for thread in -20..20 {
            let (found, through) = positions.locate(positions.centre(thread));
            assert_eq!(found, thread);
            assert!((through - 0.5).abs() < 1e-6);
            let inside = positions.start(thread) + 1e-9;
            assert_eq!(positions.locate(inside).0, thread);
            // The same place by plain search.
            let pitch = f64::from(pitches[thread.rem_euclid(6) as usize]);
            assert!((positions.pitch(thread) - pitch).abs() < 1e-12);
        }
        assert_ne!(positions.locate(positions.start(3) - 1e-6).0, 3);
    }

    #[test]
    fn a_place_far_away_is_as_exact_as_one_near_by() {
        let positions = Density::per_cm(20.0).positions(7);
        let far = positions.clone().seen_from(1e10);
        for mm in [-3.26f32, 0.0, 0.26, 1.99] {
            let (thread, through) = positions.locate(1e10 + f64::from(mm));
            let (same, just) = far.locate(f64::from(mm));
            assert_eq!(thread, same);
            assert!((through - just).abs() < 1e-4);
            let back = far.start(same) + just * far.pitch(same);
            assert!((back - f64::from(mm)).abs() < 1e-4, "{back}");
        }
        // Control: 32 bits would not tell places of the same metre apart.
        assert_eq!(1e10f32 + 0.26, 1e10);
    }

    #[test]
    fn wild_positions_and_pitches_still_give_a_thread() {
        let positions = Positions::new([f32::NAN, 0.0, -1.0, f32::INFINITY]);
        assert!(positions.repeat_mm().is_finite());
        for mm in [
            f64::NAN,
            f64::INFINITY,
            f64::NEG_INFINITY,
            1e300,
            -1e300,
            -0.0,
            5e-324,
        ] {
            let (_, through) = positions.locate(mm);
            assert!((0.0..1.0).contains(&through), "{mm}");
        }
        assert_eq!(Positions::new([]).threads(), 1);
    }

    #[test]
    fn faults_are_named() {
        assert_eq!(Sett::per_cm(20.0, 18.0).fault(), None);
        for wrong in [0.0, -3.0, f32::NAN, f32::INFINITY] {
            assert!(Sett::per_cm(wrong, 20.0).fault().is_some(), "{wrong}");
        }
        let mut sett = Sett::per_cm(20.0, 20.0);
        sett.picks.pitches_mm = Some(vec![0.5, f32::NAN]);
        assert!(sett.fault().unwrap().contains("pitch 2 of the picks"));
    }
}
