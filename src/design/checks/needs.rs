//! What a warp and a weft need: shafts, heddles, metres and grams of yarn.

use super::take_up::TakeUp;
use crate::design::document::{Design, lcm};
use crate::design::maps::YarnMap;
use crate::design::pattern::WeavePattern;
use crate::design::structure::Structure;

/// The most threads of a cloth repeat that are gone through one by one.
const MOST_THREADS: u64 = 1 << 20;

/// What one yarn contributes to a metre of cloth.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct YarnNeed {
    /// Metres of it in the warp.
    pub warp_metres: f64,
    /// Metres of it in the weft.
    pub weft_metres: f64,
    /// Both together in metres.
    pub metres: f64,
    /// Its mass in grams: metres × tex / 1000.
    pub grams: f64,
}

/// What [`yarn_needs`] finds.
#[derive(Debug, Clone, PartialEq)]
pub struct YarnNeeds {
    /// Of each of the design's yarns.
    pub yarns: Vec<YarnNeed>,
    /// The width of cloth in mm that this is for.
    pub width_mm: f64,
}

/// Heddles on each shaft for one repeat: of a draft by its threading, of any other weave on
/// the fewest shafts (one for each different column, in order of first use).
///
/// Their number is the shafts needed.
pub fn heddles(design: &Design, weave: &WeavePattern) -> Vec<u32> {
    if let Structure::Draft(draft) = design.structure() {
        let mut heddles = vec![0; draft.shafts() as usize];
        for shaft in draft.threading().iter().flatten() {
            heddles[usize::from(*shaft)] += 1;
        }
        return heddles;
    }
    let columns = weave.transposed();
    let mut shafts = std::collections::BTreeMap::new();
    let mut heddles: Vec<u32> = Vec::new();
    for end in 0..columns.picks() {
        let column: Vec<u64> = columns.pick_words(end).collect();
        let shaft = *shafts.entry(column).or_insert(heddles.len());
        match heddles.get_mut(shaft) {
            Some(count) => *count += 1,
            None => heddles.push(1),
        }
    }
    heddles
}

/// Yarn in one metre of cloth, one repeat of the cloth wide (of the weave alone where the
/// orders make that longer than a million threads), take-up included; no waste, no
/// shrinkage.
///
/// Each end is (1 + take-up) metres long; each of the 1000/pitch picks of a metre is
/// (1 + take-up) widths long.
pub fn yarn_needs(design: &Design, warp: &TakeUp, weft: &TakeUp) -> YarnNeeds {
    let (ends, picks) = (u64::from(design.ends()), u64::from(design.picks()));
    let all_ends = match design.cloth_repeat().0 {
        all if all <= MOST_THREADS.max(ends) => all,
        _ => ends,
    };
    let width_mm = design.end_positions().start(all_ends as i64);
    let mut yarns = vec![YarnNeed::default(); design.yarns().len()];
    let taken = |side: &TakeUp, thread: u64| {
        let threads = side.threads.len().max(1) as u64;
        1.0 + side
            .threads
            .get((thread % threads) as usize)
            .unwrap_or(&0.0)
    };
    match &design.maps().warp {
        YarnMap::Order(order) => {
            for end in 0..all_ends {
                let yarn = order[(end % order.len() as u64) as usize];
                yarns[usize::from(yarn.0)].warp_metres += taken(warp, end);
            }
        }
        YarnMap::Crossings(grid) => {
            // The ends of the weave recur over the width; each pick is a share of a metre.
            let share = (all_ends / ends) as f64 / picks as f64;
            for end in 0..grid.ends() {
                for pick in 0..grid.picks() {
                    let yarn = &mut yarns[usize::from(grid.get(end, pick).0)];
                    yarn.warp_metres += share * taken(warp, u64::from(end));
                }
            }
        }
    }
    let picks_per_metre = 1000.0 / f64::from(design.sett().picks.mean_pitch_mm());
    let width_m = width_mm * 1e-3;
    match &design.maps().weft {
        YarnMap::Order(order) => {
            let all_picks = lcm(picks, order.len() as u64).min(MOST_THREADS.max(picks));
            let length = picks_per_metre * width_m / all_picks as f64;
            for pick in 0..all_picks {
                let yarn = order[(pick % order.len() as u64) as usize];
                yarns[usize::from(yarn.0)].weft_metres += length * taken(weft, pick);
            }
        }
        YarnMap::Crossings(grid) => {
            let length = picks_per_metre * width_m / (picks * ends) as f64;
            for pick in 0..grid.picks() {
                for end in 0..grid.ends() {
                    let yarn = &mut yarns[usize::from(grid.get(end, pick).0)];
                    yarn.weft_metres += length * taken(weft, u64::from(pick));
                }
            }
        }
    }
    for (need, yarn) in yarns.iter_mut().zip(design.yarns()) {
        need.metres = need.warp_metres + need.weft_metres;
        need.grams = need.metres * f64::from(yarn.linear_density()) * 1e-3;
    }
    YarnNeeds { yarns, width_mm }
}
