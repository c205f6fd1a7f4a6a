//! Times and memory of the synthesis, printed and never asserted:
//! `cargo bench --bench synthesis`.

use std::hint::black_box;
use std::time::Instant;

use pickglass::design::{Lattice, Repeat, WeavePattern};
use pickglass::job::Job;
use pickglass::synthesis::{
    Assignment, Catalogue, EdgeFix, EdgeHeights, Face, Method, Placement, Quality, Randomisation,
    Rank, assign,
};

const RANDOMISATION: Randomisation = Randomisation { seed: 1, patch: 3 };

fn wavy_twill(ends: u32, picks: u32) -> WeavePattern {
    WeavePattern::from_fn(ends, picks, |end, pick| {
        let wave = (12.0 * (f64::from(pick % 96) * std::f64::consts::TAU / 96.0).sin()).round();
        (i64::from(end) - wave as i64).rem_euclid(6) < 3
    })
}

fn noise(ends: u32, picks: u32) -> WeavePattern {
    let mut state = 1u64;
    WeavePattern::from_fn(ends, picks, |_, _| {
        state = state
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        state >> 40 & 1 == 1
    })
}

/// 1/15 and 15/1 satin in discs.
fn damask(ends: u32, picks: u32) -> WeavePattern {
    WeavePattern::from_fn(ends, picks, |end, pick| {
        let tie = (7 * end + 16 * picks - pick).is_multiple_of(16);
        let (x, y) = (i64::from(end % 200) - 100, i64::from(pick % 200) - 100);
        tie != (x * x + y * y < 6400)
    })
}

/// Processor time of this process in seconds, all threads: what counts on a busy machine.
fn processor_seconds() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let fields = stat.rsplit(')').next().unwrap_or("").split_whitespace();
    let ticks = fields
        .skip(11)
        .take(2)
        .filter_map(|ticks| ticks.parse::<f64>().ok());
    ticks.sum::<f64>() / 100.0
}

/// The best of a few runs, in seconds, with the last result.
fn best_of<T>(runs: u32, mut work: impl FnMut() -> T) -> (f64, T) {
    let mut best = f64::INFINITY;
    loop {
        let start = Instant::now();
        let result = black_box(work());
        best = best.min(start.elapsed().as_secs_f64());
        static RUNS: std::sync::atomic::AtomicU32 = std::sync::atomic::AtomicU32::new(0);
        if RUNS.fetch_add(1, std::sync::atomic::Ordering::Relaxed) + 1 >= runs {
            RUNS.store(0, std::sync::atomic::Ordering::Relaxed);
            return (best, result);
        }
    }
}

/// Peak resident memory of this process in MB, from the kernel; 0 where it does not say.
fn peak_mb() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find(|line| line.starts_with("VmHWM"));
    let kb = line.and_then(|line| line.split_whitespace().nth(1));
    kb.and_then(|kb| kb.parse::<f64>().ok()).unwrap_or(0.0) / 1024.0
}

fn heights(catalogue: &Catalogue, b: usize) -> EdgeHeights {
    let mut heights = EdgeHeights::flat(catalogue.blocks(), b, b);
    let mut state = 1u64;
    for table in [
        &mut heights.left,
        &mut heights.right,
        &mut heights.bottom,
        &mut heights.top,
    ] {
        for height in table.iter_mut() {
            state = state
                .wrapping_mul(6364136223846793005)
                .wrapping_add(1442695040888963407);
            *height = (state >> 40) as f32 / (1u64 << 22) as f32;
        }
    }
    heights
}

fn stages(name: &str, pattern: &WeavePattern, lattice: Lattice, runs: u32) -> Assignment {
    let catalogue = Catalogue::standard();
    let job = Job::new();
    let before = peak_mb();
    println!("{name}: {} x {}", pattern.ends(), pattern.picks());
    let mut last = None;
    let cpu = processor_seconds();
    for _ in 0..runs {
        black_box(assign(pattern, lattice, &catalogue, Method::Dp, 1, &job).expect("assigned"));
    }
    println!(
        "  dp: {:.3} processor seconds a run",
        (processor_seconds() - cpu) / f64::from(runs)
    );
    for method in [Method::Naive, Method::Greedy, Method::Dp] {
        let (seconds, assignment) = best_of(runs, || {
            assign(pattern, lattice, &catalogue, method, 1, &job).expect("assigned")
        });
        let (stats, quality) = best_of(runs, || {
            Quality::measure(pattern, &assignment, &catalogue, RANDOMISATION, &job)
                .expect("measured")
        });
        let c = quality.continuity;
        println!(
            "  {method:?}: assign {seconds:.4} s, quality {stats:.4} s; consistency {}/{}, mismatched {}, continuity before {:.4} (along {:.4}, across {:.4}) after {:.4}",
            quality.consistency,
            quality.consistency_max,
            quality.mismatched,
            c.before as f64 / c.max as f64,
            c.before_along as f64 / (c.max as f64 / 2.0),
            (c.before - c.before_along) as f64 / (c.max as f64 / 2.0),
            c.after as f64 / c.max as f64,
        );
        last = Some(assignment);
    }
    let assignment = last.expect("three methods");
    println!(
        "  assignment {:.1} MB, peak memory +{:.1} MB",
        assignment.bytes() as f64 / 1e6,
        peak_mb() - before
    );
    assignment
}

fn seams(pattern: &WeavePattern, assignment: &Assignment) {
    let catalogue = Catalogue::standard();
    let job = Job::new();
    for (rank, b) in [
        (Rank::Truncated(15), 24),
        (Rank::Truncated(15), 40),
        (Rank::Truncated(15), 80),
        (Rank::Exact, 40),
    ] {
        let heights = [heights(&catalogue, b)];
        let (seconds, fix) = best_of(3, || {
            EdgeFix::new(&heights, &catalogue, rank, &job).expect("fixed")
        });
        let placement = Placement {
            catalogue: &catalogue,
            assignment,
            randomisation: RANDOMISATION,
        };
        let (measuring, rms) = best_of(3, || {
            placement
                .seam_rms(&fix, &heights, |_, _| 0, [1.0; 2], &job)
                .expect("measured")
        });
        println!(
            "edges {rank:?}, {b}² stacks: prepared in {seconds:.3} s, {:.2} MB; seam_rms {measuring:.4} s: {} seams",
            fix.bytes() as f64 / 1e6,
            rms.seams
        );
        let cpu = processor_seconds();
        for _ in 0..3 {
            let quality = Quality::measure(pattern, assignment, &catalogue, RANDOMISATION, &job);
            black_box(quality.expect("measured"));
        }
        let quality = (processor_seconds() - cpu) / 3.0;
        for _ in 0..3 {
            let rms = placement.seam_rms(&fix, &heights, |_, _| 0, [1.0; 2], &job);
            black_box(rms.expect("measured"));
        }
        let rms = (processor_seconds() - cpu) / 3.0 - quality;
        println!("  processor seconds a run: quality {quality:.3}, seam_rms {rms:.3}");
        let count = 1_000_000u64;
        let lookups: Vec<(i64, i64, usize, usize)> = (0..count)
            .map(|n| {
                let n = n.wrapping_mul(0x9e37_79b9_7f4a_7c15);
                (
                    ((n >> 40) % u64::from(pattern.ends())) as i64,
                    ((n >> 20) % u64::from(pattern.picks())) as i64,
                    (n >> 10) as usize % b,
                    n as usize % b,
                )
            })
            .collect();
        let (direct, _) = best_of(3, || {
            lookups
                .iter()
                .filter_map(|&(i, j, x, y)| {
                    Some(fix.shift_at(&placement.neighbourhood(i, j, |_, _| 0)?, Face::Front, x, y))
                })
                .sum::<f32>()
        });
        let around = placement.neighbourhood(5, 6, |_, _| 0).expect("inside");
        let seam = fix.seam(&around, Face::Front);
        let (kept, _) = best_of(3, || {
            lookups
                .iter()
                .map(|&(_, _, x, y)| fix.shift(&seam, x, y))
                .sum::<f32>()
        });
        let (looked_up, _) = best_of(3, || {
            lookups
                .iter()
                .filter_map(|&(i, j, ..)| {
                    Some(u64::from(
                        placement.neighbourhood(i, j, |_, _| 0)?.centre.block,
                    ))
                })
                .sum::<u64>()
        });
        println!(
            "  random crossings: neighbourhood {:.0} ns, with shift_at {:.0} ns; shift of a kept seam {:.0} ns",
            looked_up * 1e9 / count as f64,
            direct * 1e9 / count as f64,
            kept * 1e9 / count as f64
        );
    }
}

fn main() {
    let straight = Lattice::default();
    let pattern = wavy_twill(900, 1500);
    let assignment = stages("wavy twill", &pattern, straight, 5);
    let catalogue = Catalogue::standard();

    let mut edited = pattern.clone();
    edited.set(450, 700, !edited.get(450, 700));
    let (seconds, _) = best_of(20, || {
        let mut assignment = assignment.clone();
        assignment
            .edit(&edited, &catalogue, &[(450, 700)], &Job::new())
            .expect("edited")
    });
    println!(
        "one edited cell, with a copy of the assignment: {:.3} ms",
        seconds * 1e3
    );
    let (seconds, _) = best_of(20, Catalogue::standard);
    println!("Catalogue::standard: {:.3} ms", seconds * 1e3);
    seams(&pattern, &assignment);

    let dropped = Lattice {
        across: Repeat::Straight,
        along: Repeat::Dropped(7),
    };
    stages("wavy twill, dropped", &pattern, dropped, 3);
    stages("damask", &damask(900, 1500), straight, 3);
    stages("noise", &noise(900, 1500), straight, 3);
    stages("large wavy twill", &wavy_twill(5120, 6300), straight, 1);
}
