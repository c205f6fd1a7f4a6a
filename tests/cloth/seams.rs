//! Seams, measured independently of the fit: on the surface that is seen.
//!
//! The map holds the height at which the optical depth from a face passes 1. Its jumps
//! across block borders, less the jumps one voxel inside either block (the fibres' own
//! roughness), are what is left of a seam.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

use std::ops::Range;

use crate::cloth_scenes::{at_level, preset, surface, weave_altered};
use pickglass::cloth::ClothVolume;
use pickglass::exemplar::ExemplarSet;
use pickglass::job::Job;
use pickglass::synthesis::{BlockRef, Catalogue, EdgeHeights, Face, Rank, Seams, Side};
use rayon::prelude::*;

/// Sums of squared jumps in height, voxels.
#[derive(Debug, Clone, Copy, Default)]
struct Jumps {
    border: f64,
    inside: f64,
    count: f64,
}

impl Jumps {
    fn plus(self, other: Self) -> Self {
        Self {
            border: self.border + other.border,
            inside: self.inside + other.inside,
            count: self.count + other.count,
        }
    }

    /// Mean square of the jumps at the borders beyond those inside; below 0 where borders
    /// are smoother.
    fn excess(&self) -> f64 {
        (self.border - self.inside) / self.count
    }

    /// Its root, at least 0, voxels.
    fn rms(&self) -> f64 {
        self.excess().max(0.0).sqrt()
    }
}

/// Jumps at all borders of a stretch of cloth that are seams, and at those where blocks
/// continue each other.
fn jumps(cloth: &ClothVolume, ends: Range<i64>, picks: Range<i64>, face: Face) -> [Jumps; 2] {
    let [bx, by, _] = cloth.sets()[0].grid.block;
    let height = |end: i64, pick: i64, x: usize, y: usize| {
        let place = |positions: &pickglass::design::Positions, thread, at, of| {
            let through = (at as f64 + 0.5) / of as f64;
            positions.start(thread) + through * positions.pitch(thread)
        };
        let x = place(cloth.ends(), end, x, bx);
        let y = place(cloth.picks(), pick, y, by);
        surface(cloth, x as f32, y as f32, face).map(|hit| f64::from(hit.0))
    };
    let at = |end: i64, pick: i64| BlockRef {
        set: cloth.set_at(end, pick),
        block: cloth.placement().block(end, pick).unwrap(),
    };
    let of_border = |end: i64, pick: i64, side: Side| {
        let (dx, dy) = side.offset();
        let beside = at(end + dx, pick + dy);
        let joined = cloth.edge_fix().continues(at(end, pick), side, beside);
        let mut sum = Jumps::default();
        // Corners belong to four blocks.
        for k in 1..if dx == 1 { by } else { bx } - 1 {
            let heights = if dx == 1 {
                [
                    height(end, pick, bx - 2, k),
                    height(end, pick, bx - 1, k),
                    height(end + 1, pick, 0, k),
                    height(end + 1, pick, 1, k),
                ]
            } else {
                [
                    height(end, pick, k, by - 2),
                    height(end, pick, k, by - 1),
                    height(end, pick + 1, k, 0),
                    height(end, pick + 1, k, 1),
                ]
            };
            let [Some(a), Some(b), Some(c), Some(d)] = heights else {
                continue;
            };
            sum.border += (c - b).powi(2);
            sum.inside += 0.5 * ((b - a).powi(2) + (d - c).powi(2));
            sum.count += 1.0;
        }
        let mut sums = [Jumps::default(); 2];
        sums[usize::from(joined)] = sum;
        sums
    };
    let borders: Vec<(i64, i64, Side)> = ends
        .flat_map(|end| picks.clone().map(move |pick| (end, pick)))
        .flat_map(|(end, pick)| [Side::Right, Side::Above].map(|side| (end, pick, side)))
        .collect();
    let sums: Vec<[Jumps; 2]> = borders
        .into_par_iter()
        .map(|(end, pick, side)| of_border(end, pick, side))
        .collect();
    sums.into_iter().fold([Jumps::default(); 2], |a, b| {
        std::array::from_fn(|i| a[i].plus(b[i]))
    })
}

/// The wavy twill at a rank of the edge fixing, its exemplars altered.
fn twill(level: u32, rank: Rank, alter: impl Fn(&mut ExemplarSet)) -> ClothVolume {
    let mut settings = at_level(level);
    (settings.synthesis.seams, settings.synthesis.rank) = (Seams::Membrane, rank);
    let design = preset("wavy-twill");
    weave_altered(&design, Catalogue::standard(), settings, alter).with_window(0.0..12.0, 0.0..12.0)
}

/// Seams of a patch on both faces.
fn seams(name: &str, cloth: &ClothVolume, size: i64) -> [Jumps; 2] {
    Face::ALL.map(|face| {
        let [seams, joined] = jumps(cloth, 8..8 + size, 20..20 + size, face);
        println!(
            "{name} {face:?}: border {:.2}, inside {:.2}, excess² {:.2} over {} stacks; joined {:.2}",
            (seams.border / seams.count).sqrt(),
            (seams.inside / seams.count).sqrt(),
            seams.excess(),
            seams.count,
            joined.excess(),
        );
        seams
    })
}

/// Heights of every block as those of another.
fn shuffled(set: &mut ExemplarSet) {
    let old = set.heights.clone();
    let blocks = old.blocks as u16;
    let mut new = EdgeHeights::flat(old.blocks, old.bx, old.by);
    for block in 0..blocks {
        let other = (u32::from(block) * 89 + 57) % u32::from(blocks);
        for face in Face::ALL {
            for side in Side::ALL {
                new.profile_mut(face, block, side)
                    .copy_from_slice(old.profile(face, other as u16, side));
            }
        }
    }
    set.heights = new;
}

fn expect_closed(level: u32, size: i64) {
    let open = seams("open", &twill(level, Rank::Off, |_| {}), size);
    let cloth = twill(level, Rank::Truncated(15), |_| {});
    let closed = seams("r = 15", &cloth, size);
    let exact = seams("exact", &twill(level, Rank::Exact, |_| {}), size);
    let shuffled = seams(
        "shuffled",
        &twill(level, Rank::Truncated(15), shuffled),
        size,
    );
    for face in 0..2 {
        let before = open[face].rms();
        assert!(before > 2.0, "{face}: {before} voxels");
        assert!(closed[face].rms() < before / 5.0, "{face}: {closed:?}");
        assert!(exact[face].rms() < before / 5.0, "{face}: {exact:?}");
        // Control: what closes the seams is that the heights are the blocks' own.
        assert!(shuffled[face].rms() > 0.8 * before, "{face}: {shuffled:?}");
    }
    // The fit's own measure agrees, as far as 15 profiles hold single fibres.
    let heights: Vec<EdgeHeights> = (cloth.sets().iter())
        .map(|set| set.heights.clone())
        .collect();
    let set_at = |end, pick| cloth.set_at(end, pick);
    let own = cloth
        .placement()
        .seam_rms(cloth.edge_fix(), &heights, set_at, [1.0; 2], &Job::new())
        .unwrap();
    println!("fit: {own:?}");
    for [before, after] in [own.front, own.back] {
        assert!(after < before / 3.0, "{own:?}");
    }
}

#[test]
fn rank_15_closes_the_seams_of_a_wavy_twill() {
    expect_closed(1, 20);
}

#[test]
fn rank_15_closes_the_seams_at_full_resolution() {
    expect_closed(0, 24);
}

/// How much the fibres that are seen bend at borders that floats of the warp run across, and
/// half a pitch before and after them: mean, degrees, and how many borders there were.
///
/// It looks at the directions of the voxels at optical depth 1, over the middle of the yarn,
/// and knows nothing of heights or shifts.
fn bends(cloth: &ClothVolume, ends: Range<i64>, picks: Range<i64>) -> [f64; 3] {
    let [bx, by, _] = cloth.sets()[0].grid.block;
    // Mean elevation of the fibres in a few stacks before or after a place along the yarn.
    let elevation = |end: i64, from: i64| {
        let (mut sum, mut count) = (0.0, 0.0);
        for row in from..from + 3 {
            let (pick, y) = (row.div_euclid(by as i64), row.rem_euclid(by as i64));
            let along = cloth.picks().start(pick)
                + (y as f64 + 0.5) / by as f64 * cloth.picks().pitch(pick);
            for x in bx * 3 / 10..bx * 7 / 10 {
                let across = cloth.ends().start(end)
                    + (x as f64 + 0.5) / bx as f64 * cloth.ends().pitch(end);
                if let Some((_, voxel)) = surface(cloth, across as f32, along as f32, Face::Front)
                    && voxel.direction.y.abs() > 0.6
                {
                    let t = voxel.direction * voxel.direction.y.signum();
                    sum += f64::from(t.z.atan2(t.y)).to_degrees();
                    count += 1.0;
                }
            }
        }
        (count > 0.0).then(|| sum / count)
    };
    let bend = |end: i64, at: i64| Some((elevation(end, at)? - elevation(end, at - 3)?).abs());
    let up = |end: i64, pick: i64| cloth.warp_up(end, pick) == Some(true);
    let borders: Vec<(i64, i64)> = ends
        .flat_map(|end| picks.clone().map(move |pick| (end, pick)))
        .filter(|&(end, pick)| (-2..2).all(|step| up(end, pick + step)))
        .collect();
    let sums = borders
        .par_iter()
        .filter_map(|&(end, pick)| {
            let (border, half) = (pick * by as i64, by as i64 / 2);
            let inside = [border - half, border + half].map(|at| bend(end, at));
            Some([bend(end, border)?, 0.5 * (inside[0]? + inside[1]?), 1.0])
        })
        .reduce(|| [0.0; 3], |a, b| std::array::from_fn(|k| a[k] + b[k]));
    [sums[0] / sums[2], sums[1] / sums[2], sums[2]]
}

#[test]
fn fibres_of_a_satin_run_on_without_a_kink() {
    let design = preset("silk-satin");
    let cloth = |seams: Seams, rank: Rank| {
        let mut settings = at_level(0);
        (settings.synthesis.seams, settings.synthesis.rank) = (seams, rank);
        let cloth = weave_altered(&design, Catalogue::standard(), settings, |_| {});
        bends(&cloth.with_window(0.0..2.0, 0.0..2.0), 2..10, 2..12)
    };
    let [border, inside, count] = cloth(Seams::Crowns, Rank::Truncated(15));
    println!("crowns: {border:.2}° at borders, {inside:.2}° inside, {count} borders");
    assert!(count >= 30.0);
    assert!(border <= 1.5 * inside, "{border} {inside}");
    // Control: a membrane bends them.
    let [membrane, inside, _] = cloth(Seams::Membrane, Rank::Truncated(15));
    println!("membrane: {membrane:.2}° at borders, {inside:.2}° inside");
    assert!(
        membrane > 2.5 * border && membrane > 2.5 * inside,
        "{membrane} {inside}"
    );
}
