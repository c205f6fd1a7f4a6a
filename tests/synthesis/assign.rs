//! Catalogue, assignment, editing, randomisation: Zhao 2012 §5.3–5.4.

#![allow(clippy::unwrap_used, reason = "a test may fail")]

use pickglass::design::{Lattice, Repeat, WeavePattern};
use pickglass::job::Job;
use pickglass::synthesis::{
    Assignment, Catalogue, Method, Quality, Randomisation, Side, SynthesisError, assign,
};
use proptest::prelude::*;

const CYCLIC: Lattice = Lattice {
    across: Repeat::Straight,
    along: Repeat::Straight,
};
const OPEN: Lattice = Lattice {
    across: Repeat::Straight,
    along: Repeat::None,
};
const ALL_METHODS: [Method; 3] = [Method::Naive, Method::Greedy, Method::Dp];

/// A 96-end wavy twill: 3/3, its line waving along the warp.
fn wavy_twill(ends: u32, picks: u32) -> WeavePattern {
    WeavePattern::from_fn(ends, picks, |end, pick| {
        let wave = (12.0 * (f64::from(pick % 96) * std::f64::consts::TAU / 96.0).sin()).round();
        (i64::from(end) - wave as i64).rem_euclid(6) < 3
    })
}

fn noise(ends: u32, picks: u32, seed: u64) -> WeavePattern {
    let mut state = seed;
    WeavePattern::from_fn(ends, picks, |_, _| {
        state = state
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        state >> 40 & 1 == 1
    })
}

/// Noise with long uniform stretches: long and short runs in one column.
fn patchy(ends: u32, picks: u32, seed: u64, every: u32) -> WeavePattern {
    let base = noise(ends, picks, seed);
    WeavePattern::from_fn(ends, picks, |end, pick| {
        let twill = (end + 5 * picks - pick) % 5 < 2;
        let odd = (end * 7 + pick * 13 + seed as u32).is_multiple_of(every);
        if odd { base.get(end, pick) } else { twill }
    })
}

fn built(
    pattern: &WeavePattern,
    lattice: Lattice,
    catalogue: &Catalogue,
    method: Method,
) -> Assignment {
    assign(pattern, lattice, catalogue, method, 5, &Job::new()).unwrap()
}

fn quality(pattern: &WeavePattern, assignment: &Assignment, catalogue: &Catalogue) -> Quality {
    let randomisation = Randomisation { seed: 5, patch: 3 };
    Quality::measure(pattern, assignment, catalogue, randomisation, &Job::new()).unwrap()
}

/// The key of a crossing, written independently of the library.
fn key_at(pattern: &WeavePattern, lattice: Lattice, end: i64, pick: i64) -> u8 {
    let endless = |r| {
        if r == Repeat::None {
            Repeat::Straight
        } else {
            r
        }
    };
    let lattice = Lattice {
        across: endless(lattice.across),
        along: endless(lattice.along),
    };
    let places = [(0, 0), (-1, 0), (1, 0), (0, -1), (0, 1)];
    places.iter().enumerate().fold(0, |key, (bit, (dx, dy))| {
        let (e, p) = lattice
            .wrap(end + dx, pick + dy, pattern.ends(), pattern.picks())
            .unwrap();
        key | u8::from(pattern.get(e, p)) << bit
    })
}

/// Zhao's recursion, over all candidates: the most continuous pairs a column can have.
fn dp_oracle(catalogue: &Catalogue, keys: &[u8], cyclic: bool) -> u64 {
    let gain = |below: u16, above: u16| u64::from(catalogue.continues(below, Side::Above, above));
    let best_from = |first: Option<u16>| {
        let start: Vec<u16> =
            first.map_or_else(|| catalogue.candidates(keys[0]).to_vec(), |t| vec![t]);
        let mut f: Vec<(u16, u64)> = start.into_iter().map(|t| (t, 0)).collect();
        for &key in &keys[1..] {
            f = catalogue
                .candidates(key)
                .iter()
                .map(|&t| {
                    (
                        t,
                        f.iter()
                            .map(|&(u, value)| value + gain(u, t))
                            .max()
                            .unwrap(),
                    )
                })
                .collect();
        }
        let closing = |t: u16| first.map_or(0, |first| gain(t, first));
        f.iter()
            .map(|&(t, value)| value + closing(t))
            .max()
            .unwrap()
    };
    if cyclic {
        catalogue
            .candidates(keys[0])
            .iter()
            .map(|&t| best_from(Some(t)))
            .max()
            .unwrap()
    } else {
        best_from(None)
    }
}

/// Every assignment there is, one by one.
fn brute_force(catalogue: &Catalogue, keys: &[u8], cyclic: bool) -> u64 {
    let lists: Vec<&[u16]> = keys.iter().map(|&key| catalogue.candidates(key)).collect();
    let mut choice = vec![0usize; keys.len()];
    let mut best = 0;
    loop {
        let block = |row: usize| lists[row][choice[row]];
        let pairs = if cyclic { keys.len() } else { keys.len() - 1 };
        let value = (0..pairs)
            .filter(|&row| {
                catalogue.continues(block(row), Side::Above, block((row + 1) % keys.len()))
            })
            .count() as u64;
        best = best.max(value);
        let Some(row) = (0..keys.len()).find(|&row| choice[row] + 1 < lists[row].len()) else {
            return best;
        };
        choice[row] += 1;
        choice[..row].fill(0);
    }
}

/// Continuous pairs along one end of an assignment.
fn continuous_pairs(catalogue: &Catalogue, column: &[u16], cyclic: bool) -> u64 {
    let rows = column.len();
    let pairs = if cyclic { rows } else { rows - 1 };
    (0..pairs)
        .filter(|&row| catalogue.continues(column[row], Side::Above, column[(row + 1) % rows]))
        .count() as u64
}

fn column_keys(pattern: &WeavePattern, lattice: Lattice, end: u32) -> Vec<u8> {
    let picks = 0..i64::from(pattern.picks());
    picks
        .map(|pick| key_at(pattern, lattice, i64::from(end), pick))
        .collect()
}

/// A few exemplars whose voxels do not wrap, as scans have.
fn scans() -> Catalogue {
    let weaves = Catalogue::paper().weaves().to_vec();
    let wraps = vec![[false; 2]; weaves.len()];
    Catalogue::new(weaves, wraps).unwrap()
}

/// Small enough that all assignments of a short column can be tried.
fn tiny() -> Catalogue {
    let weaves = Catalogue::standard().weaves()[19..].to_vec();
    let wraps = vec![[true, true], [true, false]];
    Catalogue::new(weaves, wraps).unwrap()
}

#[test]
fn standard_completes_all_32_neighbourhoods_and_the_paper_22() {
    assert_eq!(Catalogue::standard().neighbourhoods_covered(), 32);
    assert_eq!(Catalogue::paper().neighbourhoods_covered(), 22);
    assert_eq!(scans().neighbourhoods_covered(), 22);
}

#[test]
fn without_the_completing_weave_the_count_falls() {
    let weaves = Catalogue::standard().weaves()[..20].to_vec();
    let wraps = vec![[true; 2]; weaves.len()];
    assert_eq!(
        Catalogue::new(weaves, wraps)
            .unwrap()
            .neighbourhoods_covered(),
        30
    );
}

#[test]
fn satin_of_the_paper_is_warp_over_two_move_three() {
    let catalogue = Catalogue::paper();
    let weave = &catalogue.weaves()[5];
    let art: Vec<String> = (0..5)
        .rev()
        .map(|pick| {
            (0..5)
                .map(|end| if weave.get(end, pick) { '#' } else { '.' })
                .collect()
        })
        .collect();
    assert_eq!(art, ["..#.#", ".#..#", ".#.#.", "#..#.", "#.#.."]);
}

#[test]
fn blocks_are_numbered_exemplar_by_exemplar_pick_by_pick() {
    let catalogue = Catalogue::standard();
    let mut next = 0u16;
    for (exemplar, weave) in catalogue.weaves().iter().enumerate() {
        for y in 0..weave.picks() {
            for x in 0..weave.ends() {
                let place = catalogue.place(next);
                assert_eq!(
                    (
                        usize::from(place.exemplar),
                        u32::from(place.x),
                        u32::from(place.y)
                    ),
                    (exemplar, x, y)
                );
                assert_eq!(catalogue.block(place), next);
                assert_eq!(
                    catalogue.key(next),
                    key_at(weave, CYCLIC, i64::from(x), i64::from(y))
                );
                next += 1;
            }
        }
    }
    assert_eq!(usize::from(next), catalogue.blocks());
}

#[test]
fn scans_end_at_their_borders() {
    let catalogue = scans();
    assert_eq!(catalogue.neighbour(0, Side::Left), None);
    assert_eq!(catalogue.neighbour(0, Side::Right), Some(1));
    assert_eq!(catalogue.neighbour(0, Side::Above), Some(5));
    assert_eq!(catalogue.neighbour(24, Side::Above), None);
    assert_eq!(Catalogue::paper().neighbour(24, Side::Above), Some(4));
}

#[test]
fn dp_equals_brute_force_on_small_columns() {
    let catalogue = tiny();
    let mut differs = 0;
    for seed in 0..60 {
        for picks in 1..6 {
            let pattern = noise(3, picks, seed);
            for (lattice, cyclic) in [(CYCLIC, true), (OPEN, false)] {
                let assignment = built(&pattern, lattice, &catalogue, Method::Dp);
                let greedy = built(&pattern, lattice, &catalogue, Method::Greedy);
                let keys = column_keys(&pattern, lattice, 1);
                let tries: f64 = keys
                    .iter()
                    .map(|&key| catalogue.candidates(key).len() as f64)
                    .product();
                if tries > 2e5 {
                    continue;
                }
                let best = brute_force(&catalogue, &keys, cyclic);
                assert_eq!(
                    continuous_pairs(&catalogue, assignment.column(1), cyclic),
                    best
                );
                assert_eq!(dp_oracle(&catalogue, &keys, cyclic), best);
                // Negative control: the comparison can tell a worse assignment.
                differs += u32::from(continuous_pairs(&catalogue, greedy.column(1), cyclic) < best);
            }
        }
    }
    assert!(differs > 50, "only {differs}");
}

#[test]
fn dp_equals_the_papers_recursion() {
    for catalogue in [Catalogue::standard(), Catalogue::paper(), scans(), tiny()] {
        let mut patterns = vec![wavy_twill(12, 96), noise(8, 41, 3)];
        patterns.extend((2..12).map(|every| patchy(6, 37 + every, u64::from(every), every)));
        for pattern in patterns {
            for (lattice, cyclic) in [(CYCLIC, true), (OPEN, false)] {
                let assignment = built(&pattern, lattice, &catalogue, Method::Dp);
                for end in 0..pattern.ends() {
                    let keys = column_keys(&pattern, lattice, end);
                    let got = continuous_pairs(&catalogue, assignment.column(end), cyclic);
                    assert_eq!(got, dp_oracle(&catalogue, &keys, cyclic), "end {end}");
                }
            }
        }
    }
}

/// A pattern three ends wide, pieced together from rows of the exemplars.
fn pieces(catalogue: &Catalogue, picks: u32, next: &mut impl FnMut(u32) -> u32) -> WeavePattern {
    let weaves = catalogue.weaves();
    let (mut exemplar, mut y) = (0, 0);
    let rows: Vec<(usize, u32)> = (0..picks)
        .map(|_| {
            if next(4) == 0 {
                exemplar = next(weaves.len() as u32) as usize;
                y = next(weaves[exemplar].picks());
            }
            y = (y + 1) % weaves[exemplar].picks();
            (exemplar, y)
        })
        .collect();
    WeavePattern::from_fn(3, picks, |end, pick| {
        let (exemplar, y) = rows[pick as usize];
        weaves[exemplar].get(end, y)
    })
}

#[test]
fn dp_is_optimal_for_made_up_exemplars() {
    let mut state = 1u64;
    let mut next = move |below: u32| {
        state = state
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (state >> 33) as u32 % below
    };
    let mut start_matters = 0;
    for _ in 0..4000 {
        let weaves: Vec<_> = (0..1 + next(3))
            .map(|_| {
                let picks = 2 + next(7);
                let bits: Vec<bool> = (0..3 * picks).map(|_| next(3) == 0).collect();
                WeavePattern::from_fn(3, picks, |end, pick| bits[(3 * pick + end) as usize])
            })
            .collect();
        let wraps = weaves.iter().map(|_| [true, next(2) == 0]).collect();
        let Ok(catalogue) = Catalogue::new(weaves, wraps) else {
            continue;
        };
        let picks = 1 + next(16);
        let pattern = pieces(&catalogue, picks, &mut next);
        for (lattice, cyclic) in [(CYCLIC, true), (OPEN, false)] {
            let assignment = built(&pattern, lattice, &catalogue, Method::Dp);
            for end in 0..3 {
                let keys = column_keys(&pattern, lattice, end);
                let best = dp_oracle(&catalogue, &keys, cyclic);
                let got = continuous_pairs(&catalogue, assignment.column(end), cyclic);
                assert_eq!(got, best, "{keys:?}");
                start_matters += u32::from(cyclic && best > dp_oracle(&catalogue, &keys, false));
            }
        }
    }
    // Columns whose last row continues in the first, so that row 0 is a bad start.
    assert!(start_matters > 500, "only {start_matters}");
}

#[test]
fn thin_and_uneven_designs_are_assigned_like_any() {
    let catalogue = Catalogue::standard();
    let satin_8 = |end: u32, pick: u32| (5 * end + 8 * pick - pick).is_multiple_of(8);
    let patterns = [
        WeavePattern::from_fn(1, 9, |_, pick| pick % 3 == 0),
        WeavePattern::from_fn(9, 1, |end, _| end % 2 == 0),
        WeavePattern::from_fn(2, 2, |end, pick| end == pick),
        WeavePattern::from_fn(16, 16, |_, _| true),
        // A stripe of 28 threads on an 8-end weave: the repeat breaks at the border.
        WeavePattern::from_fn(28, 16, satin_8),
    ];
    for pattern in patterns {
        for (lattice, cyclic) in [(CYCLIC, true), (OPEN, false)] {
            let assignment = built(&pattern, lattice, &catalogue, Method::Dp);
            let quality = quality(&pattern, &assignment, &catalogue);
            assert_eq!((quality.incorrect, quality.mismatched), (0, 0));
            for end in 0..pattern.ends() {
                let keys = column_keys(&pattern, lattice, end);
                let got = continuous_pairs(&catalogue, assignment.column(end), cyclic);
                assert_eq!(got, dp_oracle(&catalogue, &keys, cyclic));
            }
        }
    }
}

#[test]
fn a_closed_cycle_has_no_break() {
    let catalogue = Catalogue::standard();
    let twill = WeavePattern::from_fn(5, 15, |end, pick| (end + 15 - pick) % 5 < 2);
    let quality = quality(
        &twill,
        &built(&twill, CYCLIC, &catalogue, Method::Dp),
        &catalogue,
    );
    assert_eq!(quality.continuity.before, quality.continuity.max);
    // Thirteen picks cannot close on a five-pick exemplar: one break a column.
    let cut = WeavePattern::from_fn(5, 13, |end, pick| (end + 15 - pick) % 5 < 2);
    let assignment = built(&cut, CYCLIC, &catalogue, Method::Dp);
    assert!(continuous_pairs(&catalogue, assignment.column(0), true) < 13);
}

#[test]
fn dp_beats_greedy_beats_naive_before_shifting() {
    for catalogue in [Catalogue::standard(), Catalogue::paper()] {
        for pattern in [wavy_twill(96, 288), noise(40, 40, 9), patchy(30, 50, 4, 9)] {
            let [naive, greedy, dp] = ALL_METHODS.map(|method| {
                quality(
                    &pattern,
                    &built(&pattern, CYCLIC, &catalogue, method),
                    &catalogue,
                )
            });
            assert!(dp.continuity.before > greedy.continuity.before);
            assert!(greedy.continuity.before > naive.continuity.before);
            assert!(dp.continuity.before_along > greedy.continuity.before_along);
            assert_eq!(dp.consistency, greedy.consistency);
            assert!(greedy.consistency > naive.consistency);
            for quality in [naive, greedy, dp] {
                assert_eq!(quality.incorrect, 0);
                assert_eq!(
                    quality.crossings,
                    u64::from(pattern.ends() * pattern.picks())
                );
                assert!(quality.continuity.after <= quality.continuity.max);
            }
        }
    }
}

#[test]
fn quality_notices_a_wrong_block() {
    let catalogue = Catalogue::standard();
    let pattern = wavy_twill(96, 96);
    let good = quality(
        &pattern,
        &built(&pattern, CYCLIC, &catalogue, Method::Dp),
        &catalogue,
    );
    let mut other = pattern.clone();
    other.set(3, 3, !other.get(3, 3));
    let worse = quality(
        &pattern,
        &built(&other, CYCLIC, &catalogue, Method::Dp),
        &catalogue,
    );
    assert_eq!((good.incorrect, good.mismatched), (0, 0));
    assert_eq!((worse.incorrect, worse.mismatched), (1, 4));
    assert!(worse.consistency < good.consistency);
}

#[test]
fn patterns_no_exemplar_matches_come_out_whole() {
    let catalogue = Catalogue::paper();
    let plain = WeavePattern::from_fn(6, 6, |end, pick| (end + pick) % 2 == 0);
    for pattern in [
        plain,
        noise(17, 23, 1),
        WeavePattern::from_fn(1, 1, |_, _| true),
        WeavePattern::new(7, 3),
    ] {
        for method in ALL_METHODS {
            let assignment = built(&pattern, CYCLIC, &catalogue, method);
            let quality = quality(&pattern, &assignment, &catalogue);
            assert_eq!(quality.incorrect, 0);
            let expected: u64 = (0..pattern.ends())
                .flat_map(|end| column_keys(&pattern, CYCLIC, end))
                .map(|key| u64::from(catalogue.mismatch(key) > 0))
                .sum();
            if method != Method::Naive {
                assert_eq!(quality.mismatched, expected);
            }
            assert!((0..pattern.ends()).all(|end| {
                assignment
                    .column(end)
                    .iter()
                    .all(|&block| usize::from(block) < catalogue.blocks())
            }));
        }
    }
}

#[test]
fn any_number_of_threads_gives_the_same_blocks() {
    let catalogue = Catalogue::standard();
    let pattern = patchy(64, 64, 2, 7);
    for method in ALL_METHODS {
        let [one, two, eight] = [1, 2, 8].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .unwrap();
            pool.install(|| built(&pattern, CYCLIC, &catalogue, method))
        });
        assert_eq!(one, two);
        assert_eq!(one, eight);
        let other_seed = assign(&pattern, CYCLIC, &catalogue, method, 6, &Job::new()).unwrap();
        assert_ne!(one, other_seed);
    }
}

#[test]
fn bad_input_is_refused_by_name() {
    let all_up = WeavePattern::from_fn(4, 4, |_, _| true);
    assert_eq!(
        Catalogue::new(vec![all_up.clone()], vec![[true; 2]]).err(),
        Some(SynthesisError::NoCandidate("weft"))
    );
    assert_eq!(
        Catalogue::new(vec![], vec![]).err(),
        Some(SynthesisError::NoCandidate("warp"))
    );
    assert!(matches!(
        Catalogue::new(vec![all_up], vec![]),
        Err(SynthesisError::Wraps { .. })
    ));
    let huge = WeavePattern::new(300, 300);
    assert!(matches!(
        Catalogue::new(vec![huge], vec![[true; 2]]),
        Err(SynthesisError::TooManyBlocks(90_000))
    ));
    let catalogue = Catalogue::paper();
    let pattern = WeavePattern::new(4, 4);
    let twice = Lattice {
        across: Repeat::Dropped(1),
        along: Repeat::Dropped(1),
    };
    let refused = assign(&pattern, twice, &catalogue, Method::Dp, 0, &Job::new());
    assert_eq!(refused.err(), Some(SynthesisError::DroppedTwice));
    let job = Job::new();
    job.cancel();
    assert!(matches!(
        assign(&pattern, CYCLIC, &catalogue, Method::Dp, 0, &job),
        Err(SynthesisError::Cancelled(_))
    ));
    let mut assignment = built(&pattern, CYCLIC, &catalogue, Method::Dp);
    let other = WeavePattern::new(4, 5);
    assert!(matches!(
        assignment.edit(&other, &catalogue, &[(0, 0)], &Job::new()),
        Err(SynthesisError::SizeChanged { .. })
    ));
}

#[test]
fn a_dropped_column_continues_in_another() {
    // A 2/3 twill of 5 × 7, dropped so that its diagonal goes on without a flaw.
    let catalogue = Catalogue::standard();
    let pattern = WeavePattern::from_fn(5, 7, |end, pick| (end + 35 - pick) % 5 < 2);
    let dropped = Lattice {
        across: Repeat::Straight,
        along: Repeat::Dropped(2),
    };
    let whole = |lattice| {
        let quality = quality(
            &pattern,
            &built(&pattern, lattice, &catalogue, Method::Dp),
            &catalogue,
        );
        (
            quality.mismatched,
            quality.continuity.max - quality.continuity.before,
        )
    };
    let (mismatched, _) = whole(dropped);
    assert_eq!(mismatched, 0);
    let along = {
        let assignment = built(&pattern, dropped, &catalogue, Method::Dp);
        quality(&pattern, &assignment, &catalogue)
            .continuity
            .before_along
    };
    assert_eq!(along, 2 * 35, "the chain of five columns closes on itself");
    assert!(whole(CYCLIC).1 > 0);
}

#[test]
fn an_edit_touches_five_columns_only() {
    let catalogue = Catalogue::standard();
    let mut pattern = wavy_twill(96, 96);
    let mut assignment = built(&pattern, CYCLIC, &catalogue, Method::Dp);
    pattern.set(10, 4, !pattern.get(10, 4));
    let redone = assignment
        .edit(&pattern, &catalogue, &[(10, 4)], &Job::new())
        .unwrap();
    assert_eq!(redone, [8, 9, 10, 11, 12]);
    let redone = assignment
        .edit(&pattern, &catalogue, &[(0, 4)], &Job::new())
        .unwrap();
    assert_eq!(redone, [0, 1, 2, 94, 95]);
}

#[test]
fn an_edit_that_forgets_a_neighbour_would_be_noticed() {
    // Negative control of the property below: telling only of a far cell leaves the
    // assignment stale.
    let catalogue = Catalogue::standard();
    let mut pattern = wavy_twill(96, 96);
    let mut assignment = built(&pattern, CYCLIC, &catalogue, Method::Dp);
    pattern.set(10, 4, !pattern.get(10, 4));
    assignment
        .edit(&pattern, &catalogue, &[(14, 4)], &Job::new())
        .unwrap();
    assert_ne!(assignment, built(&pattern, CYCLIC, &catalogue, Method::Dp));
}

#[test]
fn shifts_keep_every_neighbourhood() {
    let catalogue = Catalogue::standard();
    for patch in [1, 3, 7] {
        let randomisation = Randomisation { seed: 11, patch };
        let mut moved = 0;
        for block in 0..catalogue.blocks() as u16 {
            for at in [
                (0, 0),
                (-1, -1),
                (40, -7),
                (i64::MIN, i64::MAX),
                (123_456_789, 5),
            ] {
                let shown = randomisation.apply(&catalogue, block, at.0, at.1);
                assert_eq!(catalogue.key(shown), catalogue.key(block));
                assert_eq!(
                    catalogue.place(shown).exemplar,
                    catalogue.place(block).exemplar
                );
                moved += u32::from(shown != block);
            }
        }
        assert!(moved > 100);
    }
    let off = Randomisation { seed: 11, patch: 0 };
    assert!(
        (0..catalogue.blocks() as u16).all(|block| off.apply(&catalogue, block, 3, 4) == block)
    );
}

#[test]
fn a_patch_moves_together_and_the_cloth_has_no_period() {
    let catalogue = Catalogue::standard();
    let randomisation = Randomisation { seed: 1, patch: 3 };
    let shown = |block, end, pick| randomisation.apply(&catalogue, block, end, pick);
    for block in 0..25u16 {
        let above = catalogue.neighbour(block, Side::Above).unwrap();
        assert!(catalogue.continues(shown(block, -3, 6), Side::Above, shown(above, -3, 7)));
        assert_eq!(shown(block, -3, 6), shown(block, -1, 8));
    }
    // All five translations of a twill occur, about equally often.
    let mut counts = [0; 5];
    for patch in 0..1000 {
        counts[usize::from(shown(0, 3 * patch, 0) % 5)] += 1;
    }
    assert!(
        counts.iter().all(|&count| (150..250).contains(&count)),
        "{counts:?}"
    );
}

fn lattices() -> impl Strategy<Value = Lattice> {
    let repeat = |dropped: bool| {
        let plain = prop_oneof![Just(Repeat::Straight), Just(Repeat::None)];
        if dropped {
            prop_oneof![plain, (0..40u32).prop_map(Repeat::Dropped)].boxed()
        } else {
            plain.boxed()
        }
    };
    prop_oneof![(repeat(true), repeat(false)), (repeat(false), repeat(true))]
        .prop_map(|(across, along)| Lattice { across, along })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(150))]

    #[test]
    fn editing_is_building_anew(
        (ends, picks) in (1..12u32, 1..14u32),
        seed in any::<u64>(),
        every in 1..9u32,
        lattice in lattices(),
        which in 0..3usize,
        edits in proptest::collection::vec((0..12u32, 0..14u32), 1..5),
    ) {
        let catalogue = Catalogue::standard();
        let mut pattern = patchy(ends, picks, seed >> 40, every);
        let method = ALL_METHODS[which];
        let mut assignment = built(&pattern, lattice, &catalogue, method);
        let before = assignment.clone();
        let cells: Vec<_> = edits.iter().map(|&(end, pick)| (end % ends, pick % picks)).collect();
        for &(end, pick) in &cells {
            pattern.set(end, pick, !pattern.get(end, pick));
        }
        let redone = assignment.edit(&pattern, &catalogue, &cells, &Job::new()).unwrap();
        prop_assert_eq!(&assignment, &built(&pattern, lattice, &catalogue, method));
        for end in (0..ends).filter(|end| !redone.contains(end)) {
            prop_assert_eq!(assignment.column(end), before.column(end));
        }
    }

    #[test]
    fn every_crossing_is_correct_and_as_consistent_as_can_be(
        (ends, picks) in (1..12u32, 1..14u32),
        seed in any::<u64>(),
        every in 1..9u32,
        lattice in lattices(),
    ) {
        for catalogue in [Catalogue::standard(), Catalogue::paper()] {
            let pattern = patchy(ends, picks, seed >> 40, every);
            let assignment = built(&pattern, lattice, &catalogue, Method::Dp);
            for end in 0..ends {
                let keys = column_keys(&pattern, lattice, end);
                for (key, block) in keys.iter().zip(assignment.column(end)) {
                    prop_assert!(catalogue.candidates(*key).contains(block));
                }
            }
        }
    }
}
