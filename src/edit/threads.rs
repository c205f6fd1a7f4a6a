//! Yarns and the threads that are of them.

use super::document::Work;
use super::error::EditError;
use super::regions;
use crate::design::{
    Colourway, Design, Direction, RegionYarns, Structure, Yarn, YarnId, YarnMap, YarnMaps,
};

/// Refuses a yarn that is not there.
pub(super) fn check(design: &Design, yarn: YarnId) -> Result<(), EditError> {
    let count = design.yarns().len();
    match usize::from(yarn.0) < count {
        true => Ok(()),
        false => Err(EditError::Missing {
            thing: "yarn",
            number: u64::from(yarn.0) + 1,
            count: count as u64,
        }),
    }
}

/// Puts other yarns, and with them other colourways, in their places. The structure may
/// name other yarns already.
fn put(
    work: &mut Work,
    yarns: Vec<Yarn>,
    maps: YarnMaps,
    colourways: Vec<Colourway>,
) -> Result<(), EditError> {
    let design = work.design.clone();
    let structure = design.structure().clone();
    work.design = design.with_parts(structure, yarns, maps, colourways)?;
    Ok(())
}

/// A yarn more, the same in every colourway.
pub(super) fn add(work: &mut Work, yarn: Yarn) -> Result<(), EditError> {
    let mut yarns = work.design.yarns().to_vec();
    let mut colourways = work.design.colourways().to_vec();
    for colourway in &mut colourways {
        colourway.yarns.push(yarn.clone());
    }
    yarns.push(yarn);
    let maps = work.design.maps().clone();
    put(work, yarns, maps, colourways)
}

/// Other properties.
pub(super) fn set(work: &mut Work, yarn: YarnId, to: Yarn) -> Result<(), EditError> {
    check(&work.design, yarn)?;
    let mut yarns = work.design.yarns().to_vec();
    yarns[usize::from(yarn.0)] = to;
    let (maps, colourways) = (
        work.design.maps().clone(),
        work.design.colourways().to_vec(),
    );
    put(work, yarns, maps, colourways)
}

/// Every thread of yarn i becomes one of yarn `number[i]`, in the orders and the regions.
fn renumber(work: &mut Work, number: &[YarnId]) {
    let to = |YarnId(yarn): YarnId| number.get(usize::from(yarn)).copied().unwrap_or(YarnId(0));
    let maps = work.design.maps_mut();
    for map in [&mut maps.warp, &mut maps.weft] {
        match map {
            YarnMap::Order(order) => order.iter_mut().for_each(|yarn| *yarn = to(*yarn)),
            YarnMap::Crossings(grid) => grid.replace_values(to),
        }
    }
    if let Structure::Regions(regions) = work.design.structure_mut() {
        if regions
            .palette()
            .iter()
            .all(|region| region.yarns.is_none())
        {
            return;
        }
        for region in regions.parts_mut().1 {
            region.yarns = region.yarns.map(|own| RegionYarns {
                warp: to(own.warp),
                weft: to(own.weft),
            });
        }
    }
}

fn identity(work: &Work) -> Vec<YarnId> {
    (0..work.design.yarns().len())
        .map(|yarn| YarnId(yarn as u16))
        .collect()
}

/// Exchanges the threads of two yarns.
pub(super) fn swap(work: &mut Work, one: YarnId, other: YarnId) -> Result<(), EditError> {
    check(&work.design, one)?;
    check(&work.design, other)?;
    let mut number = identity(work);
    number.swap(usize::from(one.0), usize::from(other.0));
    renumber(work, &number);
    Ok(())
}

/// Gives a yarn's threads to another and takes it off the list and out of the colourways.
pub(super) fn remove(work: &mut Work, yarn: YarnId, instead: YarnId) -> Result<(), EditError> {
    check(&work.design, yarn)?;
    check(&work.design, instead)?;
    if yarn == instead {
        return Err(EditError::Value {
            place: "yarns",
            problem: "a yarn cannot take its own place: choose another for its threads".to_owned(),
        });
    }
    let mut number = identity(work);
    number[usize::from(yarn.0)] = instead;
    for id in &mut number {
        id.0 -= u16::from(id.0 > yarn.0);
    }
    renumber(work, &number);
    let gone = usize::from(yarn.0);
    let mut yarns = work.design.yarns().to_vec();
    yarns.remove(gone);
    let mut colourways = work.design.colourways().to_vec();
    for colourway in &mut colourways {
        colourway.yarns.remove(gone);
    }
    let maps = work.design.maps().clone();
    put(work, yarns, maps, colourways)
}

/// Puts the yarns in another order; the cloth stays.
pub(super) fn reorder(work: &mut Work, order: &[u16]) -> Result<(), EditError> {
    let places = regions::places("yarns", order, work.design.yarns().len())?;
    let number: Vec<YarnId> = places.into_iter().map(YarnId).collect();
    renumber(work, &number);
    let put_in_order = |yarns: &[Yarn]| -> Vec<Yarn> {
        order
            .iter()
            .map(|&old| yarns[usize::from(old)].clone())
            .collect()
    };
    let yarns = put_in_order(work.design.yarns());
    let mut colourways = work.design.colourways().to_vec();
    for colourway in &mut colourways {
        colourway.yarns = put_in_order(&colourway.yarns);
    }
    let maps = work.design.maps().clone();
    put(work, yarns, maps, colourways)
}

/// The longest order that painting a thread writes out.
const MOST_WRITTEN: usize = 1 << 20;

/// Gives threads another yarn. The order is first written out until it closes with the
/// design, so that no other thread of the cloth's repeat changes.
pub(super) fn paint(
    work: &mut Work,
    direction: Direction,
    threads: &[u32],
    yarn: YarnId,
) -> Result<(), EditError> {
    check(&work.design, yarn)?;
    let (count, thing) = match direction {
        Direction::Warp => (work.design.ends() as usize, "end"),
        Direction::Weft => (work.design.picks() as usize, "pick"),
    };
    let maps = work.design.maps_mut();
    let map = match direction {
        Direction::Warp => &mut maps.warp,
        Direction::Weft => &mut maps.weft,
    };
    let YarnMap::Order(order) = map else {
        return Err(by_crossing(direction));
    };
    let mut copies = 1;
    while copies * order.len() <= MOST_WRITTEN && !(copies * order.len()).is_multiple_of(count) {
        copies += 1;
    }
    let length = copies * order.len();
    if length > MOST_WRITTEN {
        return Err(EditError::Value {
            place: "yarn order",
            problem: "it closes with the design only after a million threads: type it instead"
                .to_owned(),
        });
    }
    if let Some(&most) = threads.iter().max()
        && most as usize >= length
    {
        return Err(EditError::Missing {
            thing,
            number: u64::from(most) + 1,
            count: length as u64,
        });
    }
    *order = order.repeat(copies);
    for &thread in threads {
        order[thread as usize] = yarn;
    }
    Ok(())
}

fn by_crossing(direction: Direction) -> EditError {
    let part = match direction {
        Direction::Warp => "warp order",
        Direction::Weft => "weft order",
    };
    let remedy = "its yarns are given by crossing; take the yarns of the regions away first";
    EditError::NoPart { part, remedy }
}

/// The order of one direction.
pub(super) fn set_order(
    work: &mut Work,
    direction: Direction,
    order: Vec<YarnId>,
) -> Result<(), EditError> {
    let mut maps = work.design.maps().clone();
    let map = match direction {
        Direction::Warp => &mut maps.warp,
        Direction::Weft => &mut maps.weft,
    };
    if map.order().is_none() {
        return Err(by_crossing(direction));
    }
    *map = YarnMap::Order(order);
    let yarns = work.design.yarns().to_vec();
    let colourways = work.design.colourways().to_vec();
    put(work, yarns, maps, colourways)
}
