//! What `check` says about five designs, against values worked out by hand.
//!
//! All yarns are 0.2 mm thick, so that both diameters together are D = 0.4 mm and each wave
//! is h = 0.2 mm high. Peirce: θ = asin(D/√(p²+0.2²)) − atan(0.2/p), the straight part is
//! s = (p − D sin θ)/cos θ, and an interlacing costs s + Dθ − p.
//!
//! | pitch p | θ | s | s + Dθ | costs |
//! |---|---|---|---|---|
//! | 0.5 mm | 0.456709 | 0.360555 | 0.543239 | 0.0432386 mm |
//! | 0.4 mm | 0.643501 (3-4-5) | (0.4 − 0.24)/0.8 = 0.2 | 0.457400 | 0.057400 mm |
//! | 0.3 mm | below 0.3464 = (√3/2)·D: jam | 0 | – | D(π/3 − √3/2) = 0.072469 mm |

#![allow(clippy::unwrap_used, reason = "a test may fail")]

use pickglass::design::checks::{FloatLength, Layer, check, excess_mm};
use pickglass::design::{
    Design, Draft, Family, Filled, FloatKind, Grid, Lattice, Lifting, Repeat, Sett, Shed, Srgb,
    Structure, Ties, WeavePattern, Yarn, YarnId, YarnMap, YarnMaps, weave,
};

fn yarn(tex: f32) -> Yarn {
    Yarn {
        tex: Some(tex),
        diameter_mm: Some(0.2),
        ..Yarn::new(format!("{tex} tex"), Family::Cotton, Srgb(90, 90, 90))
    }
}

fn close(found: f64, expected: f64) {
    let off = (found - expected).abs();
    assert!(
        off <= 1e-5 * expected.abs().max(0.01),
        "{found}, expected {expected}"
    );
}

fn float(length: FloatLength, threads: u32, mm: f32) {
    assert_eq!(length.threads, threads);
    assert!(
        (length.mm - mm).abs() < 1e-4,
        "{length:?}, expected {mm} mm"
    );
}

fn woven(notation: &str, sett: (f32, f32)) -> Design {
    let structure = Structure::Weave(Filled::once(notation).unwrap());
    let maps = YarnMaps::plain(YarnId(0), YarnId(1));
    let yarns = vec![yarn(30.0), yarn(30.0)];
    Design::new(
        notation,
        structure,
        yarns,
        maps,
        Sett::per_cm(sett.0, sett.1),
    )
    .unwrap()
}

#[test]
fn what_an_interlacing_costs() {
    close(excess_mm(0.5, 0.4), 0.0432386);
    close(excess_mm(0.4, 0.4), 0.057400);
    close(excess_mm(0.3, 0.4), 0.072469);
    assert!(excess_mm(0.5, 0.3) < 0.04, "a thinner yarn costs less");
}

/// Plain, 20 × 20 per cm. Every crossing interlaces (k = n), so the take-up is
/// 0.0432386/0.5 = 8.64772 % both ways. The repeat is 2 × 0.5 = 1 mm wide. Warp: 2 ends ×
/// 1.0864772 m = 2.172954 m. Weft: 2000 picks a metre × 0.001 m × 1.0864772 = the same.
/// Each × 30 tex = 0.0651886 g; both over 0.001 m² = 130.377 g/m².
#[test]
fn plain() {
    let report = check(&woven("plain", (20.0, 20.0)));
    for (_, length) in report.longest.kinds() {
        float(length, 1, 0.5);
    }
    close(report.warp.mean, 0.0864772);
    close(report.weft.mean, 0.0864772);
    close(report.balance().unwrap(), 1.0);
    assert_eq!((report.warp.jammed, report.weft.jammed), (0, 0));
    assert_eq!(report.heddles, [1, 1]);
    assert_eq!(report.lifts, 2);
    close(report.weave_repeat_mm[0], 1.0);
    close(report.width_mm, 1.0);
    close(report.yarns[0].metres, 2.172954);
    close(report.yarns[1].metres, 2.172954);
    close(report.yarns[1].grams, 0.0651886);
    close(report.grams_per_m2, 130.377);
    assert!(report.weavable() && report.seams.is_empty() && report.loose.is_none());
}

/// 2/2 twill, 25 ends × 20 picks per cm. Each thread interlaces twice in four crossings.
/// Ends pass between picks 0.5 mm apart: 2 × 0.0432386/(4 × 0.5) = 4.32386 %. Picks pass
/// between ends 0.4 mm apart: 2 × 0.0574004/(4 × 0.4) = 7.1751 %. The balance is
/// 0.0432386/0.0717505 = 0.602624. Floats: 2 picks = 1.0 mm, 2 ends = 0.8 mm. The repeat is
/// 1.6 × 2.0 mm. Warp: 4 × 1.0432386 = 4.172954 m; weft: 2000 × 0.0016 × 1.0717505 =
/// 3.429602 m.
#[test]
fn even_twill() {
    let report = check(&woven("2/2 twill", (25.0, 20.0)));
    float(report.longest.warp_face, 2, 1.0);
    float(report.longest.warp_back, 2, 1.0);
    float(report.longest.weft_face, 2, 0.8);
    float(report.longest.weft_back, 2, 0.8);
    // Two at the left border meet on picks 1 and 3: 2 is not longer than within.
    assert!(report.seams.is_empty());
    close(report.warp.mean, 0.0432386);
    close(report.weft.mean, 0.0717505);
    close(report.balance().unwrap(), 0.602624);
    assert_eq!(report.heddles, [1, 1, 1, 1]);
    close(report.weave_repeat_mm[0], 1.6);
    close(report.weave_repeat_mm[1], 2.0);
    close(report.yarns[0].warp_metres, 4.172954);
    close(report.yarns[0].weft_metres, 0.0);
    close(report.yarns[1].metres, 3.429602);
    // The other hand is no different to the mill.
    let left = check(&woven("s 2/2 twill", (25.0, 20.0)));
    close(left.weft.mean, report.weft.mean);
}

/// Satin of five, 33⅓ × 33⅓ per cm: p = 0.3 mm, closer than round threads interlace evenly.
/// But three of five crossings lie under floats, where threads touch at 0.2 mm: 1.5 − 3 ×
/// 0.2 = 0.9 mm are left for two interlacings that need 2 × 0.3464 mm: not jammed. Take-up
/// 2 × 0.072469/1.5 = 9.6625 %. At 50 per cm (p = 0.2) 1.0 − 0.6 = 0.4 mm are left: jammed.
#[test]
fn satin() {
    let report = check(&woven("1/4 satin move 2", (100.0 / 3.0, 100.0 / 3.0)));
    float(report.longest.warp_face, 1, 0.3);
    float(report.longest.warp_back, 4, 1.2);
    float(report.longest.weft_face, 4, 1.2);
    float(report.longest.weft_back, 1, 0.3);
    // Picks 1 to 3 reach their four only round the seam, but picks 0 and 4 do not.
    assert!(report.seams.is_empty());
    close(report.warp.mean, 0.096625);
    assert_eq!(report.warp.jammed, 0);
    assert_eq!(report.heddles, [1; 5]);
    let close_set = check(&woven("1/4 satin move 2", (50.0, 50.0)));
    assert_eq!((close_set.warp.jammed, close_set.weft.jammed), (5, 5));
}

/// Goose eye on four shafts, drawn in 1 2 3 4 3 2 (heddles 1 2 2 1) and trodden likewise,
/// 20 × 20 per cm, ends one of 20 tex to two of 50 tex, weft of 20 tex.
///
/// ```text
/// .##.##   Ends interlace 4 2 4 2 4 2 times in 6 picks, picks 2 4 2 4 2 4 times in
/// ..###.   6 ends (from the left, from below).
/// #..#..   An interlacing in 3 mm is 0.0432386/3 = 1.441286 %: ends take up 5.76514 or
/// ..###.   2.88257 %, on the mean 4.32386 %, and so do picks.
/// .##.##   20 tex: ends 1 and 4: 1.0576514 + 1.0288257 = 2.086477 m; weft 2000 × 0.003 ×
/// ##...#   1.0432386 = 6.259431 m; 8.345908 m × 20 tex = 0.166918 g.
/// ```
/// 50 tex: ends 2, 3, 5, 6: 2 × (1.0288257 + 1.0576514) = 4.172954 m, 0.208648 g.
/// Together 0.375566 g on 0.003 m²: 125.1886 g/m².
#[test]
fn goose_eye_with_a_stripe() {
    let rows = |rows: &[&[u16]]| Ties::from_rows(rows.iter().map(|row| row.to_vec()));
    let order: [&[u16]; 6] = [&[0], &[1], &[2], &[3], &[2], &[1]];
    let lifting = Lifting::Treadled {
        tieup: rows(&[&[0, 1], &[1, 2], &[2, 3], &[0, 3]]),
        treadling: rows(&order),
    };
    let draft = Draft::new(4, 4, Shed::Rising, rows(&order), lifting).unwrap();
    assert_eq!(draft.drawdown(), weave("goose eye 6").unwrap());
    let ids = |list: &[u16]| list.iter().copied().map(YarnId).collect::<Vec<_>>();
    let design = Design::new(
        "goose eye",
        Structure::Draft(draft),
        vec![yarn(20.0), yarn(50.0)],
        YarnMaps::orders(ids(&[0, 1, 1]), ids(&[0])),
        Sett::per_cm(20.0, 20.0),
    )
    .unwrap();
    let report = check(&design);
    for (_, length) in report.longest.kinds() {
        float(length, 3, 1.5);
    }
    assert_eq!(report.heddles, [1, 2, 2, 1]);
    assert_eq!(report.lifts, 4);
    close(report.warp.threads[0], 0.0576514);
    close(report.warp.threads[1], 0.0288257);
    close(report.warp.mean, 0.0432386);
    close(report.weft.mean, 0.0432386);
    close(report.yarns[0].warp_metres, 2.086477);
    close(report.yarns[0].weft_metres, 6.259431);
    close(report.yarns[0].grams, 0.166918);
    close(report.yarns[1].warp_metres, 4.172954);
    close(report.yarns[1].grams, 0.208648);
    close(report.grams_per_m2, 125.1886);
    // The same drawdown without its draft needs as many heddles on its fewest shafts.
    let drawn = design
        .clone()
        .with_structure(Structure::Pattern(design.weave()))
        .unwrap();
    assert_eq!(check(&drawn).heddles, [1, 2, 2, 1]);
    // A stripe of four makes the cloth 12 ends wide: 6 mm, and twice the weft.
    let four = YarnMaps::orders(ids(&[0, 1, 1, 1]), ids(&[0]));
    let wider = check(
        &design
            .clone()
            .with_yarns(design.yarns().to_vec(), four)
            .unwrap(),
    );
    close(wider.cloth_repeat_mm[0], 6.0);
    close(wider.yarns[0].weft_metres, 2.0 * 6.259431);
}

/// `#...#` over `.#.#.`: end 3 lies under both picks, so nothing binds it. Pick 2's two
/// outer marks meet across the seam: two on the back where within there is one. A panel has
/// no such seam; in a repeat dropped by one pick 2 meets pick 1, whose border is bare.
#[test]
fn what_keeps_a_loom_from_weaving() {
    let pattern = WeavePattern::parse("#...#\n.#.#.").unwrap();
    let maps = YarnMaps::plain(YarnId(0), YarnId(1));
    let yarns = vec![yarn(30.0), yarn(30.0)];
    let sett = Sett::per_cm(20.0, 20.0);
    let design = Design::new("odd", Structure::Pattern(pattern), yarns, maps, sett).unwrap();
    let report = check(&design);
    assert!(!report.weavable());
    assert_eq!(report.unbound_ends, [2]);
    assert!(
        report.obstacles[0].contains("end 3"),
        "{:?}",
        report.obstacles
    );
    // It lies under everything: all the rest lifts off it.
    assert_eq!(report.loose, Some(Layer { ends: 4, picks: 2 }));
    float(report.longest.weft_back, 2, 1.0);
    float(report.inside.weft_back, 1, 0.5);
    assert_eq!(report.seams.len(), 1);
    assert_eq!(
        (report.seams[0].kind, report.seams[0].thread),
        (FloatKind::WeftBack, 1)
    );
    float(report.seams[0].length, 2, 1.0);
    let on = |across: Repeat| {
        let along = Repeat::Straight;
        check(
            &design
                .clone()
                .with_lattice(Lattice { across, along })
                .unwrap(),
        )
    };
    for across in [Repeat::None, Repeat::Dropped(1)] {
        let other = on(across);
        assert!(other.seams.is_empty(), "{across:?}: {:?}", other.seams);
        float(other.longest.weft_back, 1, 0.5);
    }
    // Dropped by a whole repeat it is straight again.
    assert_eq!(on(Repeat::Dropped(2)).seams, report.seams);
    // A yarn that changes along its length is another reason, and still has its metres.
    let grid = Grid::from_fn(5, 2, |_, pick| YarnId(pick as u16)).unwrap();
    let maps = YarnMaps {
        warp: YarnMap::Crossings(grid),
        weft: YarnMap::single(YarnId(1)),
    };
    let painted = check(
        &design
            .clone()
            .with_yarns(design.yarns().to_vec(), maps)
            .unwrap(),
    );
    assert_eq!(painted.obstacles.len(), 2);
    assert!(painted.obstacles[0].contains("warp yarn changes"));
    let warp: f64 = report.yarns[0].warp_metres;
    close(painted.yarns[0].warp_metres, 0.5 * warp);
    close(painted.yarns[1].warp_metres, 0.5 * warp);
}

#[test]
fn a_double_cloth_is_woven_but_falls_apart() {
    let report = check(&woven("double plain", (40.0, 40.0)));
    assert!(report.weavable());
    assert_eq!(report.loose, Some(Layer { ends: 2, picks: 2 }));
    assert_eq!(check(&woven("2/2 twill", (40.0, 40.0))).loose, None);
}

#[test]
fn wild_designs_give_finite_reports() {
    for (ends, picks) in [(1, 1), (1, 7), (7, 1), (64, 65)] {
        for thick in [0.001, 100.0] {
            let yarn = Yarn {
                diameter_mm: Some(thick),
                ..yarn(1e6)
            };
            let pattern = Structure::Pattern(WeavePattern::new(ends, picks));
            let maps = YarnMaps::plain(YarnId(0), YarnId(0));
            let sett = Sett::per_cm(500.0, 0.5);
            let report = check(&Design::new("wild", pattern, vec![yarn], maps, sett).unwrap());
            assert!(report.grams_per_m2.is_finite() && report.warp.mean.is_finite());
            assert!(!report.weavable() && report.balance().is_none());
        }
    }
}
