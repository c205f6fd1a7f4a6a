//! Whether two designs weave the same cloth, whatever else is told of them: a picture of
//! one is then a picture of the other.

use super::document::{Design, lcm};
use super::maps::YarnMap;
use super::pattern::WeavePattern;
use super::yarn::Yarn;

/// Threads of two orders of different lengths that are compared; beyond, they count as
/// different.
const MOST_COMPARED: u64 = 1 << 20;

impl Yarn {
    /// Whether the other looks the same in any cloth. Names are not compared, nor counts
    /// that come to the same diameter.
    pub fn looks_like(&self, other: &Self) -> bool {
        self.colour == other.colour
            && self.family == other.family
            && self.surface_share == other.surface_share
            && self.alpha() == other.alpha()
            && self.diameter() == other.diameter()
    }
}

impl Design {
    /// Whether this design, whose drawdown is `drawdown`, weaves the same cloth as another:
    /// the same crossings in yarns that look alike at the same spacing, repeating alike.
    /// How the weave comes about (threading, tie-up, regions), words, colourways and yarns
    /// that lie nowhere do not count.
    ///
    /// False for some designs that are alike all the same, never true for others.
    pub fn same_cloth(
        &self,
        drawdown: &WeavePattern,
        other: &Self,
        other_drawdown: &WeavePattern,
    ) -> bool {
        let spacing = |design: &Self| (design.sett().ends.clone(), design.sett().picks.clone());
        self.lattice() == other.lattice()
            && spacing(self) == spacing(other)
            && self.same_yarns(&self.maps().warp, other, &other.maps().warp)
            && self.same_yarns(&self.maps().weft, other, &other.maps().weft)
            && drawdown == other_drawdown
    }

    /// Whether yarns that look alike lie at the same places of two maps.
    fn same_yarns(&self, map: &YarnMap, other: &Self, other_map: &YarnMap) -> bool {
        match (map, other_map) {
            (YarnMap::Order(mine), YarnMap::Order(theirs)) => {
                let lengths = [mine.len(), theirs.len()].map(|length| length.max(1) as u64);
                let all = lcm(lengths[0], lengths[1]);
                let alike = |thread: usize| match (
                    mine.get(thread % mine.len().max(1)),
                    theirs.get(thread % theirs.len().max(1)),
                ) {
                    (Some(&one), Some(&two)) => self.yarn(one).looks_like(other.yarn(two)),
                    (one, two) => one == two,
                };
                all <= MOST_COMPARED && (0..all as usize).all(alike)
            }
            (YarnMap::Crossings(mine), YarnMap::Crossings(theirs)) => {
                let pairs = self.yarns().iter().zip(other.yarns());
                self.yarns().len() == other.yarns().len()
                    && pairs.into_iter().all(|(one, two)| one.looks_like(two))
                    && mine == theirs
            }
            _ => false,
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;
    use crate::design::{
        Colourway, Density, Family, Grid, Lattice, Loom, Repeat, Sett, Srgb, Structure, YarnId,
        YarnMaps, derive, weave,
    };

    fn twill() -> Design {
        let yarns = vec![
            Yarn::new("navy", Family::Cotton, Srgb(20, 30, 80)),
            Yarn::new("cream", Family::Wool, Srgb(240, 230, 200)),
        ];
        let structure = Structure::Pattern(weave("2/2 twill").unwrap());
        let maps = YarnMaps::orders(vec![YarnId(0), YarnId(1)], vec![YarnId(1)]);
        Design::new("twill", structure, yarns, maps, Sett::per_cm(20.0, 18.0)).unwrap()
    }

    fn same(one: &Design, other: &Design) -> bool {
        let (mine, theirs) = (one.weave(), other.weave());
        let forth = one.same_cloth(&mine, other, &theirs);
        assert_eq!(forth, other.same_cloth(&theirs, one, &mine), "both ways");
        forth
    }

    fn yarns(design: &Design, change: impl Fn(&mut Vec<Yarn>)) -> Design {
        let mut yarns = design.yarns().to_vec();
        change(&mut yarns);
        let maps = design.maps().clone();
        let design = design.clone().with_colourways(Vec::new()).unwrap();
        design.with_yarns(yarns, maps).unwrap()
    }

    #[test]
    fn words_and_what_the_weave_is_from_are_no_cloth() {
        let cloth = twill();
        let mut renamed = cloth.clone();
        (renamed.name, renamed.notes) = ("other".to_owned(), "note".to_owned());
        let draft = derive(&cloth.weave(), &Loom::dobby(8)).unwrap();
        let derived = cloth.clone();
        let derived = derived.with_structure(Structure::Draft(draft)).unwrap();
        let listed = vec![Colourway {
            name: "night".to_owned(),
            yarns: cloth.yarns().to_vec(),
        }];
        let mut assumed = cloth.sett().clone();
        assumed.assumed = !assumed.assumed;
        let alike = [
            renamed,
            derived,
            cloth.clone().with_colourways(listed).unwrap(),
            cloth.clone().with_sett(assumed).unwrap(),
            yarns(&cloth, |yarns| yarns[0].name = "ink".to_owned()),
            yarns(&cloth, |yarns| yarns.push(yarns[0].clone())),
            yarns(&cloth, |yarns| {
                yarns[0].diameter_mm = Some(yarns[0].diameter());
            }),
        ];
        for (place, other) in alike.iter().enumerate() {
            assert!(same(&cloth, other), "{place}");
        }
        // Yarns in another order, and an order that is written out twice.
        let turned = vec![cloth.yarns()[1].clone(), cloth.yarns()[0].clone()];
        let ids = |list: &[u16]| list.iter().copied().map(YarnId).collect::<Vec<_>>();
        let maps = YarnMaps::orders(ids(&[1, 0, 1, 0]), ids(&[0]));
        assert!(same(
            &cloth,
            &cloth.clone().with_yarns(turned, maps).unwrap()
        ));
    }

    #[test]
    fn whatever_is_seen_is_another_cloth() {
        let cloth = twill();
        let shifted = |by: u16| {
            let ids = [YarnId(by % 2), YarnId((by + 1) % 2)];
            YarnMaps::orders(ids.to_vec(), vec![YarnId(1)])
        };
        let lattice = Lattice {
            across: Repeat::Dropped(1),
            along: Repeat::Straight,
        };
        let spaced = Sett {
            ends: Density {
                pitches_mm: Some(vec![0.5, 0.6]),
                ..cloth.sett().ends.clone()
            },
            ..cloth.sett().clone()
        };
        let grid = Grid::filled(4, 4, YarnId(0)).unwrap();
        let by_crossing = |yarn: u16| YarnMaps {
            warp: YarnMap::Crossings(Grid::filled(4, 4, YarnId(yarn)).unwrap()),
            weft: YarnMap::Crossings(grid.clone()),
        };
        let own = cloth.yarns().to_vec();
        let other = [
            cloth
                .clone()
                .with_structure(Structure::Pattern(weave("3/1 twill").unwrap()))
                .unwrap(),
            cloth.clone().with_yarns(own.clone(), shifted(1)).unwrap(),
            cloth.clone().with_lattice(lattice).unwrap(),
            cloth.clone().with_sett(Sett::per_cm(20.0, 18.5)).unwrap(),
            cloth.clone().with_sett(spaced).unwrap(),
            yarns(&cloth, |yarns| yarns[0].colour = Srgb(20, 30, 81)),
            yarns(&cloth, |yarns| yarns[1].gloss = Some(0.9)),
            yarns(&cloth, |yarns| yarns[1].tex = Some(90.0)),
            yarns(&cloth, |yarns| yarns[1].family = Family::Linen),
            yarns(&cloth, |yarns| yarns[0].surface_share = 0.2),
            cloth
                .clone()
                .with_yarns(own.clone(), by_crossing(0))
                .unwrap(),
            cloth.clone().with_yarns(own, by_crossing(1)).unwrap(),
        ];
        for (place, one) in other.iter().enumerate() {
            assert!(!same(&cloth, one), "{place}");
            for (beside, two) in other.iter().enumerate() {
                assert_eq!(same(one, two), place == beside, "{place} and {beside}");
            }
        }
    }
}
