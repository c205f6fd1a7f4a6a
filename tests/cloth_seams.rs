//! Seams, measured independently of the fit: on the surface that is seen.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

mod cloth_scenes;

use std::ops::Range;

use cloth_scenes::{at_level, preset, surface, weave};
use pickglass::cloth::{ClothSettings, ClothVolume};
use pickglass::synthesis::{BlockRef, Face, Rank, Side};
use rayon::prelude::*;

#[derive(Debug, Clone, Copy, Default)]
struct Jumps {
    border: [f64; 4],
    inside: [f64; 4],
    count: [f64; 4],
}

impl Jumps {
    fn plus(mut self, other: Self) -> Self {
        for i in 0..4 {
            self.border[i] += other.border[i];
            self.inside[i] += other.inside[i];
            self.count[i] += other.count[i];
        }
        self
    }

    fn add(&mut self, border: &[f64], insides: [&[f64]; 2]) {
        let length = border.len();
        for (i, part) in [length, 8, 4, 2].into_iter().enumerate() {
            let width = (length / part).max(1);
            for from in (0..=length - width).step_by(width) {
                let mean = |jumps: &[f64]| {
                    let known: Vec<f64> = jumps[from..from + width]
                        .iter()
                        .copied()
                        .filter(|j| !j.is_nan())
                        .collect();
                    (2 * known.len() > width)
                        .then(|| known.iter().sum::<f64>() / known.len() as f64)
                };
                if let (Some(b), Some(x), Some(y)) =
                    (mean(border), mean(insides[0]), mean(insides[1]))
                {
                    self.border[i] += b * b;
                    self.inside[i] += 0.5 * (x * x + y * y);
                    self.count[i] += 1.0;
                }
            }
        }
    }

    /// ms excess signed root, by smoothing
    fn rms(&self) -> [String; 4] {
        std::array::from_fn(|i| {
            let (b, s) = (
                self.border[i] / self.count[i],
                self.inside[i] / self.count[i],
            );
            let e = b - s;
            format!(
                "{:.2}/{:.2}:{:.2}",
                b.sqrt(),
                s.sqrt(),
                e.abs().sqrt() * e.signum()
            )
        })
    }
}

/// `[seam or not]`
fn jumps(cloth: &ClothVolume, ends: Range<i64>, picks: Range<i64>, face: Face) -> [Jumps; 2] {
    let [bx, by, _] = cloth.sets()[0].grid.block;
    let at = |end: i64, pick: i64| BlockRef {
        set: cloth.set_at(end, pick),
        block: cloth.placement().block(end, pick).unwrap(),
    };
    let height = |end: i64, pick: i64, x: usize, y: usize| {
        let x = cloth.ends().start(end) + (x as f64 + 0.5) / bx as f64 * cloth.ends().pitch(end);
        let y =
            cloth.picks().start(pick) + (y as f64 + 0.5) / by as f64 * cloth.picks().pitch(pick);
        surface(cloth, x as f32, y as f32, face).map(|hit| f64::from(hit.0))
    };
    ends.into_par_iter()
        .map(|end| {
            let mut sums = [Jumps::default(); 2];
            for pick in picks.clone() {
                for side in [Side::Right, Side::Above] {
                    let (dx, dy) = side.offset();
                    let joined =
                        cloth
                            .edge_fix()
                            .continues(at(end, pick), side, at(end + dx, pick + dy));
                    let length = if side == Side::Right { by } else { bx };
                    let mut j = [const { Vec::new() }; 3];
                    // Corners belong to four blocks.
                    for k in 1..length - 1 {
                        let heights = match side {
                            Side::Right => [
                                height(end, pick, bx - 2, k),
                                height(end, pick, bx - 1, k),
                                height(end + 1, pick, 0, k),
                                height(end + 1, pick, 1, k),
                            ],
                            _ => [
                                height(end, pick, k, by - 2),
                                height(end, pick, k, by - 1),
                                height(end, pick + 1, k, 0),
                                height(end, pick + 1, k, 1),
                            ],
                        };
                        for i in 0..3 {
                            j[i].push(match (heights[i], heights[i + 1]) {
                                (Some(a), Some(b)) => b - a,
                                _ => f64::NAN,
                            });
                        }
                    }
                    sums[usize::from(joined)].add(&j[1], [&j[0], &j[2]]);
                }
            }
            sums
        })
        .reduce(
            || [Jumps::default(); 2],
            |a, b| std::array::from_fn(|i| a[i].plus(b[i])),
        )
}

fn with_rank(level: u32, rank: Rank) -> ClothSettings {
    let mut settings = at_level(level);
    settings.synthesis.rank = rank;
    settings
}

#[test]
fn explore() {
    let design = preset("wavy-twill");
    let level: u32 = std::env::var("LEVEL").map_or(1, |v| v.parse().unwrap());
    let n: i64 = std::env::var("N").map_or(24, |v| v.parse().unwrap());
    for rank in [
        Rank::Off,
        Rank::Truncated(1),
        Rank::Truncated(5),
        Rank::Truncated(15),
        Rank::Exact,
    ] {
        let begun = std::time::Instant::now();
        let cloth = weave(&design, with_rank(level, rank)).with_window(0.0..12.0, 0.0..12.0);
        let made = begun.elapsed().as_secs_f32();
        let placement = cloth.placement();
        let heights: Vec<_> = cloth.sets().iter().map(|s| s.heights.clone()).collect();
        let own = placement
            .seam_rms(
                cloth.edge_fix(),
                &heights,
                |e, p| cloth.set_at(e, p),
                &pickglass::job::Job::new(),
            )
            .unwrap();
        println!(
            "{rank:?} block {:?} made {made} own {own:?}",
            cloth.sets()[0].grid
        );
        for face in Face::ALL {
            let j = jumps(&cloth, 10..10 + n, 20..20 + n, face);
            println!(
                "   {face:?} seams {:?} joined {:?} n {} {}",
                j[0].rms(),
                j[1].rms(),
                j[0].count[0],
                j[1].count[0]
            );
        }
        println!("   {:.1} s", begun.elapsed().as_secs_f32());
    }
}
