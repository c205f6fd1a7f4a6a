//! Which yarn lies where: a warp and a weft yarn at every crossing (Zhao 2012 §5.1).

use super::grid::Grid;
use super::lattice::Lattice;
use super::yarn::YarnId;

/// The yarns of one direction.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum YarnMap {
    /// A yarn for each thread, repeating with a period of its own: what a loom can do.
    Order(Vec<YarnId>),
    /// A yarn for each crossing: it may change along a thread, which no loom does
    /// ("preview only").
    Crossings(Grid<YarnId>),
}

impl YarnMap {
    /// One yarn for all threads.
    pub fn single(yarn: YarnId) -> Self {
        Self::Order(vec![yarn])
    }

    /// The yarn of a thread (`along` = its place, `across` = where on it) in cloth
    /// coordinates. `ends_first` says whether the thread is an end.
    fn at(&self, end: i64, pick: i64, thread: i64) -> YarnId {
        match self {
            Self::Order(order) => {
                let period = order.len().max(1) as i64;
                order
                    .get(thread.rem_euclid(period) as usize)
                    .copied()
                    .unwrap_or(YarnId(0))
            }
            Self::Crossings(grid) => grid.get_wrapped(end, pick),
        }
    }

    /// As [`YarnMap::at`], where yarns given by crossing repeat with a lattice.
    fn on(&self, lattice: Lattice, end: i64, pick: i64, thread: i64) -> YarnId {
        match self {
            Self::Crossings(grid) if lattice != Lattice::default() => lattice
                .wrap(end, pick, grid.ends(), grid.picks())
                .map_or_else(|| grid.get_wrapped(end, pick), |(e, p)| grid.get(e, p)),
            _ => self.at(end, pick, thread),
        }
    }

    /// The largest yarn number in use.
    pub fn largest(&self) -> Option<YarnId> {
        match self {
            Self::Order(order) => order.iter().copied().max(),
            Self::Crossings(grid) => grid.max(),
        }
    }

    /// The period of the order, or `None` where yarns change along a thread.
    pub fn order(&self) -> Option<&[YarnId]> {
        match self {
            Self::Order(order) => Some(order),
            Self::Crossings(_) => None,
        }
    }
}

/// The warp and weft yarn at every crossing of the endless cloth.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct YarnMaps {
    /// Yarns of the ends.
    pub warp: YarnMap,
    /// Yarns of the picks.
    pub weft: YarnMap,
}

impl YarnMaps {
    /// One yarn for the warp and one for the weft.
    pub fn plain(warp: YarnId, weft: YarnId) -> Self {
        Self {
            warp: YarnMap::single(warp),
            weft: YarnMap::single(weft),
        }
    }

    /// A warp order and a weft order, each with its own period.
    pub fn orders(warp: Vec<YarnId>, weft: Vec<YarnId>) -> Self {
        Self {
            warp: YarnMap::Order(warp),
            weft: YarnMap::Order(weft),
        }
    }

    /// The warp yarn at a crossing of the endless cloth.
    pub fn warp(&self, end: i64, pick: i64) -> YarnId {
        self.warp.at(end, pick, end)
    }

    /// The weft yarn at a crossing of the endless cloth.
    pub fn weft(&self, end: i64, pick: i64) -> YarnId {
        self.weft.at(end, pick, pick)
    }

    /// The warp yarn at a crossing of the endless cloth of a design with this lattice:
    /// orders run on with periods of their own, yarns by crossing repeat with it.
    #[inline]
    pub fn warp_on(&self, lattice: Lattice, end: i64, pick: i64) -> YarnId {
        self.warp.on(lattice, end, pick, end)
    }

    /// The weft yarn, as [`YarnMaps::warp_on`].
    #[inline]
    pub fn weft_on(&self, lattice: Lattice, end: i64, pick: i64) -> YarnId {
        self.weft.on(lattice, end, pick, pick)
    }

    /// Whether a loom can do it: no yarn changes along its length.
    pub fn weavable(&self) -> bool {
        self.warp.order().is_some() && self.weft.order().is_some()
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;

    #[test]
    fn orders_keep_periods_of_their_own() {
        let ids = |list: &[u16]| list.iter().copied().map(YarnId).collect::<Vec<_>>();
        let maps = YarnMaps::orders(ids(&[0, 0, 1]), ids(&[2, 3]));
        assert!(maps.weavable());
        for end in -7i64..7 {
            for pick in -7i64..7 {
                let expected = if end.rem_euclid(3) == 2 { 1 } else { 0 };
                assert_eq!(maps.warp(end, pick), YarnId(expected));
                let expected = if pick.rem_euclid(2) == 0 { 2 } else { 3 };
                assert_eq!(maps.weft(end, pick), YarnId(expected));
            }
        }
    }

    #[test]
    fn a_map_by_crossings_changes_along_a_thread_and_is_not_weavable() {
        let grid = Grid::from_fn(3, 2, |end, pick| YarnId((end + 3 * pick) as u16)).unwrap();
        let maps = YarnMaps {
            warp: YarnMap::Crossings(grid),
            weft: YarnMap::single(YarnId(9)),
        };
        assert!(!maps.weavable());
        assert_eq!(maps.warp(1, 0), YarnId(1));
        assert_eq!(maps.warp(-2, 3), YarnId(4));
        assert_eq!(maps.warp.largest(), Some(YarnId(5)));
    }
}
