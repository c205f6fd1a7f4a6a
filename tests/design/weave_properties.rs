//! What holds for every weave: satins of all sizes, bound floats, shadings, lattices.

#![allow(clippy::unwrap_used, reason = "a test may fail")]

use pickglass::design::{
    BindError, Lattice, Repeat, WeavePattern, bind_floats, drop_repeat, floats, longest_float,
    satin, satin_moves, shadow_series, shifted, weave,
};
use proptest::prelude::*;

/// A random pattern with about `density`/16 of the crossings up.
fn noise(ends: u32, picks: u32, seed: u64, density: u64) -> WeavePattern {
    let mut state = seed | 1;
    WeavePattern::from_fn(ends, picks, |_, _| {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        state >> 9 & 15 < density
    })
}

#[test]
fn satins_of_every_move_to_32_bind_once_and_do_not_touch() {
    let mut satins = 0;
    for ends in 5..=32u32 {
        for step in satin_moves(ends) {
            let pattern = satin(ends, step).unwrap();
            satins += 1;
            for thread in 0..ends {
                let on_pick = (0..ends).filter(|&end| pattern.get(end, thread)).count();
                let on_end = (0..ends).filter(|&pick| pattern.get(thread, pick)).count();
                assert_eq!((on_pick, on_end), (1, 1), "{ends} move {step}");
            }
            for pick in 0..ends {
                for end in (0..ends).filter(|&end| pattern.get(end, pick)) {
                    for (right, up) in [(1, 0), (1, 1), (0, 1), (-1, 1)] {
                        let beside = (i64::from(end) + right, i64::from(pick) + up);
                        assert!(
                            !pattern.get_wrapped(beside.0, beside.1),
                            "{ends} move {step}"
                        );
                    }
                }
            }
        }
    }
    // Moves coprime to n, without 1 and n − 1: Euler's φ(n) − 2, summed over 5..=32.
    let totient = |n: u32| (1..=n).filter(|&k| gcd(k, n) == 1).count();
    assert_eq!(satins, (5..=32).map(|n| totient(n) - 2).sum::<usize>());
}

fn gcd(a: u32, b: u32) -> u32 {
    if b == 0 { a } else { gcd(b, a % b) }
}

/// The longest float of any kind; an unbound thread counts as endless.
fn longest(pattern: &WeavePattern) -> u32 {
    let found = floats(pattern);
    if !found.unbound_ends.is_empty() || !found.unbound_picks.is_empty() {
        return u32::MAX;
    }
    let of = found.longest;
    of.warp_face
        .max(of.warp_back)
        .max(of.weft_face)
        .max(of.weft_back)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn bound_floats_are_never_longer_than_asked(
        ends in 2u32..90, picks in 2u32..40, seed: u64, density in 0u64..17, most in 2u32..12
    ) {
        let asked = noise(ends, picks, seed, density);
        let bound = bind_floats(&asked, most).unwrap();
        prop_assert_eq!((bound.ends(), bound.picks()), (ends, picks));
        prop_assert!(longest(&bound) <= most, "{} over {}\n{}", longest(&bound), most, bound);
        // What needs no tie gets none, and what is bound stays.
        if longest(&asked) <= most {
            prop_assert_eq!(&bound, &asked);
        }
        prop_assert_eq!(bind_floats(&bound, most).unwrap(), bound);
    }

    #[test]
    fn floats_over_one_leave_only_plain_weave(
        ends in 2u32..20, picks in 2u32..20, seed: u64, density in 0u64..17
    ) {
        let asked = noise(ends, picks, seed, density);
        match bind_floats(&asked, 1) {
            Ok(bound) => {
                prop_assert!(ends % 2 == 0 && picks % 2 == 0);
                prop_assert_eq!(longest(&bound), 1);
            }
            Err(error) => {
                prop_assert!(ends % 2 == 1 || picks % 2 == 1);
                prop_assert_eq!(error, BindError::Odd { ends, picks });
            }
        }
    }

    #[test]
    fn shadings_grow_and_never_float_longer_than_their_ends(
        size in 0usize..4, at in 0usize..8, steps in 2u32..17
    ) {
        let ends = [5u32, 7, 8, 12][size];
        let moves = satin_moves(ends);
        let step = moves[at % moves.len()];
        let from = satin(ends, step).unwrap();
        let to = weave(&format!("{}/1 satin move {step}", ends - 1)).unwrap();
        let series = shadow_series(&from, &to, steps).unwrap();
        prop_assert_eq!(series.len() as u32, steps);
        prop_assert_eq!(&series[0], &from);
        prop_assert_eq!(series[steps as usize - 1].count_warp_up(), to.count_warp_up());
        for pair in series.windows(2) {
            for pick in 0..ends {
                prop_assert_eq!(pair[0].pick_word(0, pick) & !pair[1].pick_word(0, pick), 0);
            }
            let grown = pair[1].count_warp_up() - pair[0].count_warp_up();
            let whole = to.count_warp_up() - from.count_warp_up();
            prop_assert!(grown.abs_diff(whole / u64::from(steps - 1)) <= 1, "even steps");
            prop_assert!(longest(&pair[1]) < ends);
        }
    }

    #[test]
    fn wrapping_commutes_with_shifting(
        ends in 1u32..24, picks in 1u32..24, by in 0u32..30, kind in 0..5,
        right in -40i64..40, up in -40i64..40, seed: u64
    ) {
        let lattice = match kind {
            0 => Lattice::default(),
            1 => Lattice { across: Repeat::Dropped(by), along: Repeat::Straight },
            2 => Lattice { across: Repeat::Straight, along: Repeat::Dropped(by) },
            3 => Lattice { across: Repeat::None, along: Repeat::Straight },
            _ => Lattice { across: Repeat::Straight, along: Repeat::None },
        };
        // Across an edge of the cloth nothing can be shifted.
        let right = if lattice.across == Repeat::None { 0 } else { right };
        let up = if lattice.along == Repeat::None { 0 } else { up };
        let pattern = noise(ends, picks, seed, 8);
        let cloth = |pattern: &WeavePattern, end: i64, pick: i64| {
            let home = lattice.wrap(end, pick, ends, picks);
            home.map(|(end, pick)| pattern.get(end, pick))
        };
        let moved = WeavePattern::from_fn(ends, picks, |end, pick| {
            cloth(&pattern, i64::from(end) + right, i64::from(pick) + up).unwrap()
        });
        for pick in -30..50 {
            for end in -30..50 {
                prop_assert_eq!(
                    cloth(&moved, end, pick),
                    cloth(&pattern, end + right, pick + up)
                );
            }
        }
        // The straight shift of the library is the straight lattice's.
        if kind == 0 {
            prop_assert_eq!(shifted(&pattern, -right as i32, -up as i32), moved);
        }
    }

    #[test]
    fn a_dropped_repeat_laid_out_is_what_the_lattice_says(
        ends in 1u32..12, picks in 1u32..12, by in 0u32..20, seed: u64
    ) {
        let pattern = noise(ends, picks, seed, 8);
        let whole = drop_repeat(&pattern, by).unwrap();
        let lattice = Lattice { across: Repeat::Dropped(by), along: Repeat::Straight };
        for pick in -20..20 {
            for end in -40..80 {
                let (e, p) = lattice.wrap(end, pick, ends, picks).unwrap();
                prop_assert_eq!(whole.get_wrapped(end, pick), pattern.get(e, p));
            }
        }
    }
}

#[test]
fn every_small_weave_can_be_bound() {
    for (ends, picks) in [
        (2, 2),
        (2, 3),
        (3, 2),
        (3, 3),
        (2, 5),
        (5, 2),
        (4, 3),
        (3, 4),
        (4, 4),
    ] {
        for bits in 0..1u32 << (ends * picks) {
            let asked = WeavePattern::from_fn(ends, picks, |end, pick| {
                bits >> (end + ends * pick) & 1 == 1
            });
            for most in 2..4 {
                let bound = bind_floats(&asked, most).unwrap();
                assert!(longest(&bound) <= most, "{asked}to {most}:\n{bound}");
            }
        }
    }
}

#[test]
fn the_measure_of_binding_can_fail() {
    let bare = WeavePattern::new(9, 9);
    assert_eq!(longest(&bare), u32::MAX);
    assert_eq!(longest(&satin(9, 2).unwrap()), 8);
    assert_eq!(longest_float(&bind_floats(&bare, 3).unwrap()).weft_face, 3);
}

#[test]
fn binding_touches_only_what_floats() {
    // A plain ground with one bare figure in the middle.
    let asked = WeavePattern::from_fn(40, 40, |end, pick| {
        let figure = (12..28).contains(&end) && (12..28).contains(&pick);
        !figure && (end + pick) % 2 == 0
    });
    let bound = bind_floats(&asked, 5).unwrap();
    let mut ties = 0;
    for pick in 0..40 {
        for end in 0..40 {
            if bound.get(end, pick) != asked.get(end, pick) {
                assert!(
                    (11..29).contains(&end) && (11..29).contains(&pick),
                    "{end} {pick}"
                );
                ties += 1;
            }
        }
    }
    // 16 × 16 bare crossings need about one tie in six each way.
    assert!((32..80).contains(&ties), "{ties}\n{bound}");
}
