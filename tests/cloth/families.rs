//! Cloth of several families: each crossing from its own pair's exemplars, each yarn in
//! its own colour.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

use crate::cloth_scenes::{at_level, cotton, seen, weave};
use pickglass::cloth::{ClothVolume, YarnClasses};
use pickglass::design::{
    Design, Family, Grid, Lattice, Repeat, Sett, Srgb, Yarn, YarnId, YarnMap, YarnMaps,
    weave as notation,
};
use pickglass::synthesis::Face;

/// Cotton warp in two colours, wool and silk wefts.
fn mixed() -> Design {
    let yarns = vec![
        Yarn::new("red", Family::Cotton, Srgb(200, 20, 30)),
        Yarn::new("white", Family::Cotton, Srgb(240, 240, 230)),
        Yarn::new("wool", Family::Wool, Srgb(90, 80, 70)),
        Yarn::new("silk", Family::Silk, Srgb(240, 200, 190)),
    ];
    let maps = YarnMaps::orders(
        vec![YarnId(0), YarnId(0), YarnId(1)],
        vec![YarnId(2), YarnId(3), YarnId(3), YarnId(2), YarnId(3)],
    );
    cotton(notation("2/3 twill").unwrap())
        .with_sett(Sett::per_cm(30.0, 28.0))
        .unwrap()
        .with_yarns(yarns, maps)
        .unwrap()
}

/// Crossings where another yarn is seen than `design` says.
fn wrong(cloth: &ClothVolume, design: &Design, size: i64) -> usize {
    let weave = design.weave();
    let mut wrong = 0;
    for pick in -size..size {
        for end in -size..size {
            let place = design
                .lattice()
                .wrap(end, pick, weave.ends(), weave.picks());
            let (i, j) = place.unwrap();
            for face in Face::ALL {
                let warp = weave.get(i, j) == (face == Face::Front);
                let YarnId(yarn) = if warp {
                    design.warp_yarn(end, pick)
                } else {
                    design.weft_yarn(end, pick)
                };
                let found = seen(cloth, end, pick, face).0;
                wrong += usize::from(found != Some((u32::from(yarn), warp)));
            }
        }
    }
    wrong
}

#[test]
fn each_pair_of_yarns_has_its_own_exemplars() {
    let design = mixed();
    let cloth = weave(&design, at_level(2));
    assert_eq!(cloth.sets().len(), 2);
    let [wool, silk] = [0, 1].map(|set| cloth.sets()[set].pair.clone());
    assert_eq!(
        (wool.warp.family, wool.weft.family),
        (Family::Cotton, Family::Wool)
    );
    assert_eq!(
        (silk.warp.family, silk.weft.family),
        (Family::Cotton, Family::Silk)
    );
    assert_eq!(cloth.sets()[0].grid, cloth.sets()[1].grid);
    for pick in -7..12 {
        for end in -7..12 {
            let weft = design.yarn(design.weft_yarn(end, pick)).family;
            let set = usize::from(cloth.set_at(end, pick));
            assert_eq!(cloth.sets()[set].pair.weft.family, weft);
        }
    }
}

#[test]
fn each_crossing_shows_its_own_yarn() {
    let design = mixed();
    let cloth = weave(&design, at_level(1)).with_window(-6.0..6.0, -6.0..6.0);
    assert_eq!(wrong(&cloth, &design, 15), 0);
    // Control: with the wefts one pick further many are wrong.
    let maps = YarnMaps::orders(
        vec![YarnId(0), YarnId(0), YarnId(1)],
        vec![YarnId(3), YarnId(3), YarnId(2), YarnId(3), YarnId(2)],
    );
    let other = design
        .clone()
        .with_yarns(design.yarns().to_vec(), maps)
        .unwrap();
    assert!(wrong(&cloth, &other, 15) > 200);
    let classes = YarnClasses::new(&design);
    assert_eq!(classes.pairs.len(), 2);
}

#[test]
fn yarns_by_crossing_follow_a_dropped_repeat() {
    let design = cotton(notation("plain").unwrap().repeated(8, 8, (0, 0)));
    let grid = Grid::from_fn(8, 8, |end, pick| YarnId(u16::from(end < 3 && pick < 4))).unwrap();
    let maps = YarnMaps {
        warp: YarnMap::Crossings(grid.clone()),
        weft: YarnMap::Crossings(grid),
    };
    let dropped = Lattice {
        across: Repeat::Dropped(3),
        along: Repeat::Straight,
    };
    let yarns = design.yarns().to_vec();
    let straight = design.with_yarns(yarns, maps).unwrap();
    let design = straight.clone().with_lattice(dropped).unwrap();
    let cloth = weave(&design, at_level(2));
    // A yarn that changes in mid-thread is one yarn up to the border of a crossing.
    assert_eq!(wrong(&cloth, &design, 20), 0);
    assert!(wrong(&weave(&straight, at_level(2)), &design, 20) > 100);
}
