//! Take-up (crimp): how much longer a thread is than the cloth it lies in.
//!
//! Peirce's geometry of round, flexible threads (F. T. Peirce, "The geometry of cloth
//! structure", J. Text. Inst. 28, 1937, T45–T96). Where a thread passes from face to back
//! between two crossing threads a pitch p apart, with D the sum of both diameters and h its
//! own wave height,
//!
//! ```text
//! p = (l − Dθ) cos θ + D sin θ        h = (l − Dθ) sin θ + D (1 − cos θ)
//! ```
//!
//! for its angle θ and length l. Both directions' heights add up to D; the loom's tensions
//! decide how, and half each is assumed here. Eliminating l gives p sin θ + (D − h) cos θ =
//! D, so θ = asin(D/√(p² + (D−h)²)) − atan((D−h)/p). (Peirce
//! also gives l/p − 1 ≈ (9/16)(h/p)² for slight waves; the closed form needs no such limit.)
//!
//! Other weaves: only interlacings cost length, floats lie straight. A thread with k
//! interlacings over n crossings takes up k·(l − p)/(n·p). Plain weave has k = n.
//!
//! At p = (√3/2)·D the arcs meet: round threads jam. Closer cloth exists because threads
//! flatten and crossing threads under floats close up; take-up is then that of the jam and
//! [`TakeUp::jammed`] counts the threads for which not even closing up leaves room
//! (Ashenhurst's diameters and intersections).

use crate::design::document::Design;
use crate::design::lattice::Repeat;
use crate::design::maps::YarnMap;
use crate::design::pattern::WeavePattern;
use crate::design::yarn::YarnId;

/// Whose take-up.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Interlacing {
    /// Of the ends, which pass between picks.
    Warp,
    /// Of the picks, which pass between ends.
    Weft,
}

/// Take-up of the threads of one direction.
#[derive(Debug, Clone, PartialEq)]
pub struct TakeUp {
    /// Take-up of each thread of the weave, as a share of the cloth's length.
    pub threads: Vec<f64>,
    /// Their mean.
    pub mean: f64,
    /// Threads that are closer than round threads can lie.
    pub jammed: u32,
}

/// √3/2: pitch over summed diameters at which round threads jam.
const JAM: f64 = 0.866_025_403_784_438_6;

/// Extra length in mm of a thread that passes from face to back between crossing threads
/// `pitch_mm` apart, `diameters_mm` being both diameters together, each wave half of that.
/// At least 0 and finite for positive numbers; see the module for formula and source.
pub fn excess_mm(pitch_mm: f64, diameters_mm: f64) -> f64 {
    let (p, d) = (pitch_mm, diameters_mm);
    if !(p > JAM * d) {
        return d * (std::f64::consts::FRAC_PI_3 - JAM);
    }
    let rest = 0.5 * d;
    let angle = (d / p.hypot(rest)).min(1.0).asin() - rest.atan2(p);
    let straight = (p - d * angle.sin()) / angle.cos();
    (straight + d * angle - p).max(0.0)
}

/// Take-up of every thread of one direction. `weave` is the design's drawdown.
pub fn take_up(design: &Design, weave: &WeavePattern, whose: Interlacing) -> TakeUp {
    let turned;
    let (along, own, crossing, pitch, ends) = match whose {
        Interlacing::Weft => {
            let maps = design.maps();
            let pitch = design.sett().ends.mean_pitch_mm();
            (
                weave,
                &maps.weft,
                &maps.warp,
                pitch,
                design.lattice().across,
            )
        }
        Interlacing::Warp => {
            turned = weave.transposed();
            let maps = design.maps();
            let pitch = design.sett().picks.mean_pitch_mm();
            (
                &turned,
                &maps.warp,
                &maps.weft,
                pitch,
                design.lattice().along,
            )
        }
    };
    let crossed = mean_diameter(design, crossing);
    let usual = mean_diameter(design, own);
    let (pitch, crossings) = (f64::from(pitch), f64::from(along.ends()));
    let mut jammed = 0;
    let threads: Vec<f64> = (0..along.picks())
        .map(|thread| {
            let own = diameter(design, own, thread, whose).unwrap_or(usual);
            let both = own + crossed;
            let passes = f64::from(interlacings(along, thread, ends != Repeat::None));
            let room = crossings * pitch - (crossings - passes) * crossed;
            jammed += u32::from(room < passes * JAM * both);
            passes * excess_mm(pitch, both) / (crossings * pitch)
        })
        .collect();
    TakeUp {
        mean: threads.iter().sum::<f64>() / threads.len().max(1) as f64,
        threads,
        jammed,
    }
}

/// How often a pick of `weave` passes between face and back, round the repeat if it closes.
fn interlacings(weave: &WeavePattern, pick: u32, closes: bool) -> u32 {
    let ends = weave.ends();
    let mut passes = 0;
    let mut before = if closes {
        weave.get(ends - 1, pick)
    } else {
        weave.get(0, pick)
    };
    for end in 0..ends {
        let here = weave.get(end, pick);
        passes += u32::from(here != before);
        before = here;
    }
    passes
}

/// Mean diameter in mm of the threads of a direction.
fn mean_diameter(design: &Design, map: &YarnMap) -> f64 {
    let of = |id: YarnId| f64::from(design.yarn(id).diameter());
    match map {
        YarnMap::Order(order) => {
            order.iter().map(|&id| of(id)).sum::<f64>() / order.len().max(1) as f64
        }
        YarnMap::Crossings(grid) => {
            let crossings = f64::from(grid.ends()) * f64::from(grid.picks());
            grid.iter().map(of).sum::<f64>() / crossings
        }
    }
}

/// Diameter in mm of one thread, the mean over its length where its yarn changes; `None`
/// where the order does not repeat with the weave, so that it is of every yarn by turns.
fn diameter(design: &Design, map: &YarnMap, thread: u32, whose: Interlacing) -> Option<f64> {
    let of = |id: YarnId| f64::from(design.yarn(id).diameter());
    match map {
        YarnMap::Order(order) => {
            let threads = match whose {
                Interlacing::Warp => design.ends(),
                Interlacing::Weft => design.picks(),
            } as usize;
            // Thread i of the weave meets the yarns i, i + threads, … of the order.
            let recurs = threads.is_multiple_of(order.len());
            recurs.then(|| of(order[thread as usize % order.len()]))
        }
        YarnMap::Crossings(grid) => {
            let (sum, count) = match whose {
                Interlacing::Warp => {
                    let along = (0..grid.picks()).map(|pick| of(grid.get(thread, pick)));
                    (along.sum::<f64>(), grid.picks())
                }
                Interlacing::Weft => {
                    let along = (0..grid.ends()).map(|end| of(grid.get(end, thread)));
                    (along.sum::<f64>(), grid.ends())
                }
            };
            Some(sum / f64::from(count))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn peirces_equations_hold() {
        for (pitch, both) in [(0.5, 0.4), (1.0, 0.4), (0.36, 0.4), (10.0, 0.2)] {
            let length = pitch + excess_mm(pitch, both);
            // Put θ back into both equations.
            let rest = 0.5 * both;
            let angle = (both / pitch.hypot(rest)).asin() - rest.atan2(pitch);
            let straight = length - both * angle;
            let across = straight * angle.cos() + both * angle.sin();
            let height = straight * angle.sin() + both * (1.0 - angle.cos());
            assert!((across - pitch).abs() < 1e-12, "{across} {pitch}");
            assert!((height - rest).abs() < 1e-12, "{height} {rest}");
            assert!(straight >= 0.0);
        }
    }

    #[test]
    fn take_up_is_continuous_at_the_jam_and_finite_everywhere() {
        let (at, below) = (excess_mm(JAM + 1e-9, 1.0), excess_mm(JAM - 1e-9, 1.0));
        assert!((at - below).abs() < 1e-6, "{at} {below}");
        for pitch in [1e-3, 0.2, 1.0, 100.0] {
            for both in [2e-3, 0.4, 200.0] {
                let excess = excess_mm(pitch, both);
                assert!(excess.is_finite() && excess >= 0.0);
            }
        }
        // Peirce's approximation for slight waves: (9/16)(h/p)² of the pitch.
        let (pitch, both) = (5.0_f64, 0.4);
        let slight = 9.0 / 16.0 * (0.5 * both / pitch).powi(2) * pitch;
        assert!((excess_mm(pitch, both) / slight - 1.0).abs() < 0.15);
    }
}
