//! Edge fixing: Zhao 2012 §5.5.

#![allow(clippy::unwrap_used, reason = "a test may fail")]

use pickglass::design::{Lattice, WeavePattern};
use pickglass::job::Job;
use pickglass::synthesis::{
    Assignment, BOUND_COLUMN, BlockRef, Catalogue, Closing, Crown, EdgeFix, EdgeHeights, Face,
    Method, NeighbourBits, Neighbourhood, Placement, Randomisation, Rank, SeamRms, Side,
    SynthesisError, assign,
};

const BX: usize = 24;
const BY: usize = 28;

struct Random(u64);

impl Random {
    fn next(&mut self) -> f32 {
        self.0 = self
            .0
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (self.0 >> 40) as f32 / (1u64 << 24) as f32
    }

    fn below(&mut self, count: usize) -> usize {
        (self.next() * count as f32) as usize % count
    }
}

/// The silhouette of a plied yarn of fibres across an edge of `length` stacks: a flattened
/// arch at a level set by what lies on top, two plies, and fibres as small arcs upon them.
fn silhouette(length: usize, level: f32, random: &mut Random) -> Vec<f32> {
    let half = length as f32 / 2.0;
    let centre = half + 4.0 * (random.next() - 0.5);
    let radius = half * (0.8 + 0.4 * random.next());
    let twist = random.next() * std::f32::consts::TAU;
    let fibres: Vec<(f32, f32)> = (0..length / 2)
        .map(|_| (random.next() * length as f32, 1.0 + random.next()))
        .collect();
    (0..length)
        .map(|at| {
            let x = at as f32 + 0.5;
            let u = ((x - centre) / radius).clamp(-1.0, 1.0);
            let arch = 0.6 * radius * (1.0 - u * u).sqrt();
            let plies = 1.5 * (2.0 * u * std::f32::consts::PI + twist).cos().abs();
            let fibre = fibres
                .iter()
                .map(|(at, r)| (r * r - (x - at) * (x - at)).max(0.0).sqrt())
                .fold(0.0, f32::max);
            level + arch + plies + fibre
        })
        .collect()
}

/// Heights of a made-up exemplar set: levels follow the crossings beside the edge.
fn yarn_like(catalogue: &Catalogue, bx: usize, by: usize, seed: u64) -> EdgeHeights {
    let mut random = Random(seed);
    let mut heights = EdgeHeights::flat(catalogue.blocks(), bx, by);
    for block in 0..catalogue.blocks() as u16 {
        for side in Side::ALL {
            let bits = [
                catalogue.key(block) & 1,
                catalogue.key(block) >> side as u8 & 1,
            ];
            for face in Face::ALL {
                let up = bits
                    .iter()
                    .filter(|&&bit| (bit == 1) == (face == Face::Front))
                    .count();
                let along = matches!(side, Side::Below | Side::Above);
                let level = 4.0 * if along { up as f32 } else { 2.0 - up as f32 };
                let length = heights.profile(face, block, side).len();
                let sign = if face == Face::Front { 1.0 } else { -1.0 };
                let profile = silhouette(length, level, &mut random);
                for (height, value) in heights
                    .profile_mut(face, block, side)
                    .iter_mut()
                    .zip(profile)
                {
                    *height = sign * value;
                }
                *heights.crown_mut(face, block, side) = Crown {
                    height: sign * (level + 4.0 * random.next()),
                    slope: 0.4 * (random.next() - 0.5),
                };
            }
        }
    }
    heights
}

fn fix(heights: &[EdgeHeights], catalogue: &Catalogue, closing: impl Into<Closing>) -> EdgeFix {
    EdgeFix::new(heights, catalogue, closing, &Job::new()).unwrap()
}

fn wavy_twill() -> WeavePattern {
    WeavePattern::from_fn(96, 96, |end, pick| {
        let wave = (12.0 * (f64::from(pick) * std::f64::consts::TAU / 96.0).sin()).round();
        (i64::from(end) - wave as i64).rem_euclid(6) < 3
    })
}

fn assigned(catalogue: &Catalogue, method: Method) -> Assignment {
    assign(
        &wavy_twill(),
        Lattice::default(),
        catalogue,
        method,
        3,
        &Job::new(),
    )
    .unwrap()
}

fn placement<'a>(catalogue: &'a Catalogue, assignment: &'a Assignment) -> Placement<'a> {
    Placement {
        catalogue,
        assignment,
        randomisation: Randomisation { seed: 3, patch: 3 },
    }
}

fn rms(catalogue: &Catalogue, heights: &[EdgeHeights], closing: impl Into<Closing>) -> SeamRms {
    let assignment = assigned(catalogue, Method::Dp);
    placement(catalogue, &assignment)
        .seam_rms(
            &fix(heights, catalogue, closing),
            heights,
            |_, _| 0,
            [1.0; 2],
            &Job::new(),
        )
        .unwrap()
}

fn random_neighbourhood(catalogue: &Catalogue, sets: usize, random: &mut Random) -> Neighbourhood {
    let mut block = || BlockRef {
        set: random.below(sets) as u16,
        block: random.below(catalogue.blocks()) as u16,
    };
    Neighbourhood {
        centre: block(),
        sides: [(); 4].map(|()| Some(block())),
    }
}

/// A random neighbourhood whose neighbours have the yarn on top that the centre expects.
fn consistent_neighbourhood(
    catalogue: &Catalogue,
    sets: usize,
    random: &mut Random,
) -> Neighbourhood {
    let mut around = random_neighbourhood(catalogue, sets, random);
    let key = catalogue.key(around.centre.block);
    for side in Side::ALL {
        let list = catalogue.correct(key >> side as u8 & 1 == 1);
        if let Some(neighbour) = &mut around.sides[side.index()] {
            neighbour.block = list[random.below(list.len())];
        }
    }
    around
}

fn height_after(
    heights: &[EdgeHeights],
    fix: &EdgeFix,
    around: &Neighbourhood,
    face: Face,
    side: Side,
    at: usize,
) -> f32 {
    let (x, y) = match side {
        Side::Left => (0, at),
        Side::Right => (fix.block_size().0 - 1, at),
        Side::Below => (at, 0),
        Side::Above => (at, fix.block_size().1 - 1),
    };
    let seam = fix.seam(around, face);
    let centre = around.centre;
    heights[usize::from(centre.set)].profile(face, centre.block, side)[at] + fix.shift(&seam, x, y)
}

/// Largest jump left at the shared edge of two blocks among random others.
fn largest_jump(rank: Rank) -> f32 {
    let catalogue = Catalogue::standard();
    let heights = [
        yarn_like(&catalogue, BX, BY, 1),
        yarn_like(&catalogue, BX, BY, 2),
    ];
    let fix = fix(&heights, &catalogue, rank);
    let mut random = Random(7);
    let mut largest = 0.0f32;
    for _ in 0..200 {
        let mut one = random_neighbourhood(&catalogue, 2, &mut random);
        let mut two = random_neighbourhood(&catalogue, 2, &mut random);
        for (side, length) in [(Side::Right, BY), (Side::Above, BX)] {
            one.sides[side.index()] = Some(two.centre);
            two.sides[side.opposite().index()] = Some(one.centre);
            if fix.continues(one.centre, side, two.centre) {
                continue;
            }
            for face in Face::ALL {
                for at in 1..length - 1 {
                    let first = height_after(&heights, &fix, &one, face, side, at);
                    let second = height_after(&heights, &fix, &two, face, side.opposite(), at);
                    largest = largest.max((first - second).abs());
                }
            }
        }
    }
    largest
}

#[test]
fn exact_rank_closes_every_seam() {
    assert!(largest_jump(Rank::Exact) < 1e-4);
    assert!(largest_jump(Rank::Truncated(1000)) < 1e-4);
}

/// Half of the jump across each edge of a block, `[side][along]`, straight from the heights:
/// what the membrane has at its border.
fn half_jumps(
    heights: &[EdgeHeights],
    fix: &EdgeFix,
    around: &Neighbourhood,
    face: Face,
) -> [Vec<f64>; 4] {
    Side::ALL.map(|side| {
        let of = |block: BlockRef, side| {
            heights[usize::from(block.set)].profile(face, block.block, side)
        };
        let own = of(around.centre, side);
        let seam = (around.sides[side.index()])
            .filter(|other| !fix.continues(around.centre, side, *other));
        let Some(other) = seam else {
            return vec![0.0; own.len()];
        };
        let other = of(other, side.opposite());
        let pairs = other.iter().zip(own);
        pairs
            .map(|(other, own)| 0.5 * f64::from(other - own))
            .collect()
    })
}

/// Laplace's equation on a block of `bx` × `by` stacks by elimination, row after row: inside of
/// it each stack is the mean of the four beside it. x fastest; the border is as given.
fn membrane(bx: usize, by: usize, border: &[Vec<f64>; 4]) -> Vec<f64> {
    let [left, right, below, above] =
        [Side::Left, Side::Right, Side::Below, Side::Above].map(|side| &border[side.index()]);
    let given = |x: usize, y: usize| match (x, y) {
        (0, y) => left[y],
        (x, y) if x + 1 == bx => right[y],
        (x, 0) => below[x],
        (x, _) => above[x],
    };
    let [width, height] = [bx - 2, by - 2];
    // A band around the diagonal: stack k meets k ± 1 and k ± width.
    let (n, band) = (width * height, 2 * width + 1);
    let mut rows = vec![vec![0.0; band]; n];
    let mut wanted = vec![0.0; n];
    for k in 0..n {
        let (x, y) = (k % width + 1, k / width + 1);
        rows[k][width] = 4.0;
        for (x, y) in [(x - 1, y), (x + 1, y), (x, y - 1), (x, y + 1)] {
            if (1..=width).contains(&x) && (1..=height).contains(&y) {
                let other = (y - 1) * width + (x - 1);
                rows[k][other + width - k] = -1.0;
            } else {
                wanted[k] += given(x, y);
            }
        }
    }
    for pivot in 0..n {
        for below in pivot + 1..n.min(pivot + width + 1) {
            let factor = rows[below][pivot + width - below] / rows[pivot][width];
            for column in pivot..n.min(pivot + width + 1) {
                let from = rows[pivot][column + width - pivot];
                rows[below][column + width - below] -= factor * from;
            }
            wanted[below] -= factor * wanted[pivot];
        }
    }
    let mut inside = vec![0.0; n];
    for k in (0..n).rev() {
        let known =
            (k + 1..n.min(k + width + 1)).map(|other| rows[k][other + width - k] * inside[other]);
        inside[k] = (wanted[k] - known.sum::<f64>()) / rows[k][width];
    }
    let stacks = (0..by).flat_map(|y| (0..bx).map(move |x| (x, y)));
    let at = |(x, y): (usize, usize)| match x > 0 && y > 0 && x + 1 < bx && y + 1 < by {
        true => inside[(y - 1) * width + (x - 1)],
        false => given(x, y),
    };
    stacks.map(at).collect()
}

/// The largest difference between what a rank shifts inside of blocks and what their membranes
/// say, voxels.
fn off_the_membrane(rank: Rank) -> f64 {
    let catalogue = Catalogue::standard();
    let heights = [
        yarn_like(&catalogue, BX, BY, 1),
        yarn_like(&catalogue, BX, BY, 2),
    ];
    let fix = fix(&heights, &catalogue, rank);
    let mut random = Random(11);
    let mut largest = 0.0f64;
    for face in Face::ALL.into_iter().cycle().take(24) {
        let mut around = random_neighbourhood(&catalogue, 2, &mut random);
        // The border of the cloth is no seam.
        if random.below(3) == 0 {
            around.sides[random.below(4)] = None;
        }
        let expected = membrane(BX, BY, &half_jumps(&heights, &fix, &around, face));
        let shifts = fix.shifts(&around, face);
        for y in 1..BY - 1 {
            for x in 1..BX - 1 {
                let off = f64::from(shifts[y * BX + x]) - expected[y * BX + x];
                largest = largest.max(off.abs());
            }
        }
    }
    largest
}

#[test]
fn exact_rank_is_the_membrane_of_its_seams() {
    // Heights are up to some tens of voxels, in 32 bits.
    let exact = off_the_membrane(Rank::Exact);
    assert!(exact < 1e-4, "{exact}");
    // The control: a basis of few seams is not.
    let few = off_the_membrane(Rank::Truncated(4));
    assert!(few > 0.1, "{few}");
}

#[test]
fn a_low_rank_leaves_jumps() {
    assert!(largest_jump(Rank::Truncated(4)) > 0.1);
    assert!(largest_jump(Rank::Off) > 5.0);
}

#[test]
fn rank_15_takes_four_fifths_of_the_seams_on_both_faces() {
    let catalogue = Catalogue::standard();
    let heights = [yarn_like(&catalogue, 40, 40, 5)];
    let measured = rms(&catalogue, &heights, Rank::Truncated(15));
    println!("{measured:?}");
    assert!(measured.seams > 1000);
    assert!(measured.before > 5.0 * measured.after, "{measured:?}");
    assert!(measured.front[0] > 5.0 * measured.front[1], "{measured:?}");
    assert!(measured.back[0] > 5.0 * measured.back[1], "{measured:?}");
}

#[test]
fn seams_shrink_with_rank_and_stay_without_it() {
    let catalogue = Catalogue::standard();
    let heights = [yarn_like(&catalogue, BX, BY, 5)];
    let after = |rank| rms(&catalogue, &heights, rank).after;
    let off = rms(&catalogue, &heights, Rank::Off);
    assert_eq!(off.before, off.after);
    assert_eq!(after(Rank::Truncated(0)), off.before);
    let ladder = [1, 2, 4, 8, 15, 22].map(|rank| after(Rank::Truncated(rank)));
    assert!(ladder[0] < off.before);
    assert!(ladder.is_sorted_by(|a, b| a > b), "{ladder:?}");
    assert!(after(Rank::Exact) < 1e-5);
}

#[test]
fn the_basis_beats_one_of_another_catalogue_of_heights() {
    // Negative control of "the Gram matrix fits these seams": a basis fitted to other
    // heights, here white noise, leaves more at the same rank.
    let catalogue = Catalogue::standard();
    let good = yarn_like(&catalogue, BX, BY, 5);
    let mut noise = EdgeHeights::flat(catalogue.blocks(), BX, BY);
    let mut random = Random(1);
    for table in [
        &mut noise.left,
        &mut noise.right,
        &mut noise.bottom,
        &mut noise.top,
    ] {
        table
            .iter_mut()
            .for_each(|height| *height = 1000.0 * random.next());
    }
    let alone = rms(&catalogue, std::slice::from_ref(&good), Rank::Truncated(8));
    let disturbed = rms(&catalogue, &[good, noise], Rank::Truncated(8));
    assert!(
        disturbed.after > 1.5 * alone.after,
        "{} {}",
        disturbed.after,
        alone.after
    );
}

#[test]
fn shifting_straight_from_the_neighbourhood_is_the_same() {
    let catalogue = Catalogue::standard();
    let heights = [yarn_like(&catalogue, BX, BY, 1)];
    for closing in [
        Closing::Off,
        Closing::Membrane(Rank::Truncated(15)),
        Closing::Membrane(Rank::Exact),
        Closing::Crowns,
    ] {
        let fix = fix(&heights, &catalogue, closing);
        let mut random = Random(3);
        for _ in 0..300 {
            let mut around = random_neighbourhood(&catalogue, 1, &mut random);
            around.sides[random.below(4)] = None;
            let seam = fix.seam(&around, Face::Back);
            let (x, y) = (random.below(BX), random.below(BY));
            let (value, _, _) = fix.shift_and_gradient(&seam, x, y);
            let direct = fix.shift_at(&around, Face::Back, x, y);
            assert!((value - direct).abs() < 1e-4, "{value} {direct}");
            assert!(closing != Closing::Off || value == 0.0);
            let all = fix.shifts(&around, Face::Back);
            assert_eq!(all[y * BX + x].to_bits(), direct.to_bits());
        }
    }
}

/// A cubic through four values, half a stack apart from a border and on, and its slope, both
/// at the border: by Lagrange's formula.
fn at_the_border(values: [f64; 4]) -> [f64; 2] {
    let places = [0.5, 1.5, 2.5, 3.5];
    let of = |at: f64| -> f64 {
        (0..4)
            .map(|k| {
                let others = (0..4).filter(|&other| other != k);
                let share: f64 = others
                    .map(|other| (at - places[other]) / (places[k] - places[other]))
                    .product();
                share * values[k]
            })
            .sum()
    };
    [of(0.0), (of(0.01) - of(-0.01)) / 0.02]
}

/// The largest step and the largest kink of crowns that run across seams of a wavy twill, and
/// the largest shift at borders that no float crosses.
fn crowns_left(closing: Closing) -> [f64; 3] {
    let catalogue = Catalogue::standard();
    let heights = [yarn_like(&catalogue, BX, BY, 5)];
    let fix = fix(&heights, &catalogue, closing);
    let assignment = assigned(&catalogue, Method::Dp);
    let placement = placement(&catalogue, &assignment);
    let around = |end, pick| placement.neighbourhood(end, pick, |_, _| 0).unwrap();
    // Height and slope of the shift at a border of a crossing, in the yarn's middle.
    let shift = |around: &Neighbourhood, face: Face, side: Side| {
        let shifts = fix.shifts(around, face);
        let values = [0, 1, 2, 3].map(|away| {
            let (x, y) = match side {
                Side::Left => (away, BY / 2),
                Side::Right => (BX - 1 - away, BY / 2),
                Side::Below => (BX / 2, away),
                Side::Above => (BX / 2, BY - 1 - away),
            };
            f64::from(shifts.get(y * BX + x).copied().unwrap_or(0.0))
        });
        let [height, inwards] = at_the_border(values);
        match side {
            Side::Left | Side::Below => [height, inwards],
            Side::Right | Side::Above => [height, -inwards],
        }
    };
    let mut left = [0.0f64; 3];
    for (end, pick) in (10..40).flat_map(|end| (10..40).map(move |pick| (end, pick))) {
        for side in [Side::Right, Side::Above] {
            let (dx, dy) = side.offset();
            let (own, beside) = (around(end, pick), around(end + dx, pick + dy));
            let (a, b) = (own.centre.block, beside.centre.block);
            if catalogue.continues(a, side, b) {
                continue;
            }
            for face in Face::ALL {
                let shifts = [
                    shift(&own, face, side),
                    shift(&beside, face, side.opposite()),
                ];
                let runs_on =
                    catalogue.runs_on(a, side, face) && catalogue.runs_on(b, side.opposite(), face);
                if !runs_on {
                    let most = shifts
                        .as_flattened()
                        .iter()
                        .fold(0.0, |most, s| s.abs().max(most));
                    left[2] = left[2].max(most);
                    continue;
                }
                let crown = |block, side| {
                    let crown = heights[0].crown(face, block, side);
                    [crown.height, crown.slope].map(f64::from)
                };
                let crowns = [crown(a, side), crown(b, side.opposite())];
                for k in 0..2 {
                    let jump = crowns[1][k] + shifts[1][k] - crowns[0][k] - shifts[0][k];
                    left[k] = left[k].max(jump.abs());
                }
            }
        }
    }
    left
}

#[test]
fn crowns_run_on_in_height_and_slope_and_nothing_else_is_moved() {
    let [step, kink, elsewhere] = crowns_left(Closing::Crowns);
    assert!(step < 1e-3 && kink < 1e-3, "{step} {kink}");
    assert!(elsewhere < 1e-3, "{elsewhere}");
    // Controls: left open, and by a membrane, which bends yarns and moves what nobody sees.
    let [step, kink, _] = crowns_left(Closing::Off);
    assert!(step > 3.0 && kink > 0.3, "{step} {kink}");
    let [_, kink, elsewhere] = crowns_left(Closing::Membrane(Rank::Truncated(15)));
    assert!(kink > 0.3 && elsewhere > 1.0, "{kink} {elsewhere}");
}

#[test]
fn kinks_are_told_as_they_are() {
    let catalogue = Catalogue::standard();
    let heights = [yarn_like(&catalogue, BX, BY, 5)];
    let open = rms(&catalogue, &heights, Closing::Off);
    let membrane = rms(&catalogue, &heights, Rank::Truncated(15));
    let crowns = rms(&catalogue, &heights, Closing::Crowns);
    println!("{open:?}\n{membrane:?}\n{crowns:?}");
    // Slopes differ by two uniform numbers 0.4 apart: 0.4/√6 root mean square, 9.3°.
    let expected = (0.4f64 / 6f64.sqrt()).atan().to_degrees();
    assert!((open.kinks[1] / expected - 1.0).abs() < 0.1, "{open:?}");
    assert_eq!(open.kinks[0], open.kinks[1]);
    // What is left is told by the parabola that stands for the cubic next to the border.
    assert!(crowns.kinks[1] < 0.05 * open.kinks[1], "{crowns:?}");
    assert!(membrane.kinks[1] > 0.8 * open.kinks[1], "{membrane:?}");
}

#[test]
fn gradients_are_slopes() {
    let catalogue = Catalogue::paper();
    let heights = [yarn_like(&catalogue, BX, BY, 1)];
    let fix = fix(&heights, &catalogue, Rank::Truncated(15));
    let mut random = Random(3);
    let seam = fix.seam(
        &random_neighbourhood(&catalogue, 1, &mut random),
        Face::Front,
    );
    let at = |x, y| fix.shift(&seam, x, y);
    let close = |a: f32, b: f32| assert!((a - b).abs() < 1e-5, "{a} {b}");
    let (value, dx, dy) = fix.shift_and_gradient(&seam, 5, 9);
    close(value, at(5, 9));
    close(dx, (at(6, 9) - at(4, 9)) / 2.0);
    close(dy, (at(5, 10) - at(5, 8)) / 2.0);
    let (_, dx, dy) = fix.shift_and_gradient(&seam, 0, BY - 1);
    close(dx, at(1, BY - 1) - at(0, BY - 1));
    close(dy, at(0, BY - 1) - at(0, BY - 2));
}

#[test]
fn continuing_blocks_and_the_border_of_the_cloth_have_no_seam() {
    let catalogue = Catalogue::standard();
    let heights = [
        yarn_like(&catalogue, BX, BY, 1),
        yarn_like(&catalogue, BX, BY, 2),
    ];
    let fix = fix(&heights, &catalogue, Rank::Truncated(15));
    let centre = BlockRef { set: 0, block: 7 };
    let beside = Side::ALL.map(|side| BlockRef {
        set: 0,
        block: catalogue.neighbour(7, side).unwrap(),
    });
    let stacks = || (0..BY).flat_map(|y| (0..BX).map(move |x| (x, y)));
    for sides in [[None; 4], beside.map(Some)] {
        let around = Neighbourhood { centre, sides };
        let seam = fix.seam(&around, Face::Front);
        assert!(stacks().all(|(x, y)| fix.shift(&seam, x, y) == 0.0));
    }
    // The same neighbours in another set do make a seam.
    let sides = beside.map(|beside| Some(BlockRef { set: 1, ..beside }));
    let seam = fix.seam(&Neighbourhood { centre, sides }, Face::Front);
    assert!(stacks().any(|(x, y)| fix.shift(&seam, x, y).abs() > 0.1));
}

/// As [`outside`], of the worst way of closing seams.
fn violations(bits: NeighbourBits, sampled: NeighbourBits, shrink: f32) -> u32 {
    let ways = [Closing::Membrane(Rank::Truncated(6)), Closing::Crowns];
    let counts = ways.map(|closing| outside(closing, bits, sampled, shrink));
    println!("{bits:?} of {sampled:?} at {shrink}: {counts:?}");
    // Controls have to show for each of them.
    if shrink < 1.0 {
        counts[0].min(counts[1])
    } else {
        counts[0].max(counts[1])
    }
}

/// The part of the bound of a way of closing seams that random neighbourhoods leave, scaled
/// by `shrink`: counts stacks whose shift lies outside.
fn outside(closing: Closing, bits: NeighbourBits, sampled: NeighbourBits, shrink: f32) -> u32 {
    let catalogue = Catalogue::paper();
    let heights = [
        yarn_like(&catalogue, BX, BY, 1),
        yarn_like(&catalogue, BX, BY, 2),
    ];
    let fix = fix(&heights, &catalogue, closing);
    let mut random = Random(77);
    let mut outside = 0;
    for _ in 0..300 {
        let mut around = match sampled {
            NeighbourBits::Any => random_neighbourhood(&catalogue, 2, &mut random),
            NeighbourBits::Consistent => consistent_neighbourhood(&catalogue, 2, &mut random),
        };
        if random.below(4) == 0 {
            around.sides[random.below(4)] = None;
        }
        for face in Face::ALL {
            let bounds = fix.bounds(around.centre.set, around.centre.block, face, bits);
            let seam = fix.seam(&around, face);
            for y in 0..BY {
                for x in 0..BX {
                    let [low, high] =
                        bounds[y / BOUND_COLUMN * BX.div_ceil(BOUND_COLUMN) + x / BOUND_COLUMN];
                    assert!(low <= 0.0 && high >= 0.0);
                    let value = fix.shift(&seam, x, y);
                    outside += u32::from(value < low * shrink || value > high * shrink);
                }
            }
        }
    }
    outside
}

#[test]
fn bounds_hold_for_any_neighbours() {
    assert_eq!(violations(NeighbourBits::Any, NeighbourBits::Any, 1.0), 0);
    assert_eq!(
        violations(NeighbourBits::Any, NeighbourBits::Consistent, 1.0),
        0
    );
    assert!(violations(NeighbourBits::Any, NeighbourBits::Any, 0.7) > 0);
}

#[test]
fn bounds_hold_for_consistent_neighbours_only() {
    assert_eq!(
        violations(NeighbourBits::Consistent, NeighbourBits::Consistent, 1.0),
        0
    );
    assert!(violations(NeighbourBits::Consistent, NeighbourBits::Consistent, 0.7) > 0);
    assert!(violations(NeighbourBits::Consistent, NeighbourBits::Any, 1.0) > 0);
}

#[test]
fn every_block_size_and_rank_is_finite() {
    let catalogue = Catalogue::paper();
    for (bx, by) in [
        (1, 1),
        (1, 5),
        (5, 1),
        (2, 2),
        (2, 7),
        (3, 3),
        (4, 9),
        (33, 6),
    ] {
        let heights = [yarn_like(&catalogue, bx, by, 4)];
        for closing in [
            Closing::Off,
            Closing::Membrane(Rank::Truncated(1)),
            Closing::Membrane(Rank::Truncated(15)),
            Closing::Membrane(Rank::Truncated(u32::MAX)),
            Closing::Membrane(Rank::Exact),
            Closing::Crowns,
        ] {
            let fix = fix(&heights, &catalogue, closing);
            let (across, along) = fix.ranks();
            assert!(across <= by.max(2) && along <= bx.max(2));
            let measured = rms(&catalogue, &heights, closing);
            assert!(measured.kinks.iter().all(|kink| kink.is_finite()));
            let mut random = Random(3);
            let around = random_neighbourhood(&catalogue, 1, &mut random);
            for face in Face::ALL {
                let seam = fix.seam(&around, face);
                for y in 0..by {
                    for x in 0..bx {
                        let (s, dx, dy) = fix.shift_and_gradient(&seam, x, y);
                        assert!(s.is_finite() && dx.is_finite() && dy.is_finite());
                        assert!(s.abs() < 100.0);
                    }
                }
            }
            let bounds = fix.bounds(0, 0, Face::Front, NeighbourBits::Any);
            let columns = bx.div_ceil(BOUND_COLUMN) * by.div_ceil(BOUND_COLUMN);
            assert_eq!(
                bounds.len(),
                if closing == Closing::Off { 0 } else { columns }
            );
        }
    }
}

#[test]
fn identical_seams_have_a_singular_gram_matrix_and_no_shift() {
    let catalogue = Catalogue::standard();
    let mut heights = EdgeHeights::flat(catalogue.blocks(), BX, BY);
    let arch = |at: usize, length: usize| 30.0 + (at * (length - at)) as f32 * 0.1;
    for (table, length) in [
        (&mut heights.left, BY),
        (&mut heights.right, BY),
        (&mut heights.bottom, BX),
        (&mut heights.top, BX),
    ] {
        for (at, height) in table.iter_mut().enumerate() {
            *height = arch(at % length, length);
        }
    }
    for heights in [heights, EdgeHeights::flat(catalogue.blocks(), BX, BY)] {
        for rank in [Rank::Truncated(15), Rank::Exact] {
            let fix = fix(std::slice::from_ref(&heights), &catalogue, rank);
            let mut random = Random(1);
            for _ in 0..100 {
                let seam = fix.seam(
                    &random_neighbourhood(&catalogue, 1, &mut random),
                    Face::Front,
                );
                let value = fix.shift(&seam, random.below(BX), random.below(BY));
                assert!(value.abs() < 1e-4, "{value}");
            }
            let measured = rms(&catalogue, std::slice::from_ref(&heights), rank);
            assert!(measured.before == 0.0 && measured.after < 1e-5);
        }
    }
}

#[test]
fn huge_and_tiny_heights_stay_finite() {
    let catalogue = Catalogue::paper();
    for scale in [1e30f32, 1e-30, f32::MIN_POSITIVE / 8.0] {
        let mut heights = yarn_like(&catalogue, 8, 8, 4);
        for table in [
            &mut heights.left,
            &mut heights.right,
            &mut heights.bottom,
            &mut heights.top,
        ] {
            table.iter_mut().for_each(|height| *height *= scale);
        }
        let fix = fix(&[heights], &catalogue, Rank::Truncated(5));
        let mut random = Random(1);
        let seam = fix.seam(
            &random_neighbourhood(&catalogue, 1, &mut random),
            Face::Back,
        );
        assert!((0..8).all(|at| fix.shift(&seam, at, 7 - at).is_finite()));
    }
}

#[test]
fn heights_that_do_not_fit_are_refused_by_name() {
    let catalogue = Catalogue::paper();
    let good = yarn_like(&catalogue, 8, 8, 4);
    let refused = |heights: &[EdgeHeights]| match EdgeFix::new(
        heights,
        &catalogue,
        Rank::Truncated(5),
        &Job::new(),
    ) {
        Err(error @ SynthesisError::Heights { .. }) => error.to_string(),
        other => panic!("{:?}", other.map(|fix| fix.bytes())),
    };
    for poison in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let mut heights = good.clone();
        heights.profile_mut(Face::Back, 17, Side::Below)[3] = poison;
        let message = refused(&[good.clone(), heights]);
        assert!(
            message.contains("set 1") && message.contains("block 17"),
            "{message}"
        );
    }
    let mut short = good.clone();
    short.top.pop();
    assert!(refused(&[short]).contains("Above"));
    assert!(refused(&[yarn_like(&Catalogue::standard(), 8, 8, 1)]).contains("blocks"));
    assert!(refused(&[good.clone(), yarn_like(&catalogue, 8, 9, 1)]).contains("8 × 9"));
    assert!(refused(&[EdgeHeights::flat(catalogue.blocks(), 0, 8)]).contains("0 × 8"));
    assert!(EdgeFix::new(&[], &catalogue, Rank::Exact, &Job::new()).is_ok());
    let job = Job::new();
    job.cancel();
    let cancelled = EdgeFix::new(&[good], &catalogue, Rank::Exact, &job);
    assert!(matches!(cancelled, Err(SynthesisError::Cancelled(_))));
}

#[test]
fn a_placement_shows_shifted_blocks_and_their_neighbours() {
    let catalogue = Catalogue::standard();
    let assignment = assigned(&catalogue, Method::Dp);
    let placement = placement(&catalogue, &assignment);
    for (end, pick) in [(0, 0), (-1, -1), (95, 40), (1000, -777)] {
        let around = placement
            .neighbourhood(end, pick, |end, _| (end & 1) as u16)
            .unwrap();
        assert_eq!(around.centre.block, placement.block(end, pick).unwrap());
        assert_eq!(i64::from(around.centre.set), end & 1);
        for side in Side::ALL {
            let (dx, dy) = side.offset();
            let neighbour = around.sides[side.index()].unwrap();
            assert_eq!(
                neighbour.block,
                placement.block(end + dx, pick + dy).unwrap()
            );
            assert_eq!(i64::from(neighbour.set), (end + dx) & 1);
        }
    }
}
