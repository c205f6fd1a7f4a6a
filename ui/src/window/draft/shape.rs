//! The crossings a gesture covers, as sets of the design.

use pickglass::design::Structure;
use pickglass::edit::{Cells, Document};

use super::Layer;
use super::zone::Cell;

/// A stroke that covers more cells than this is no stroke of a hand.
const LONGEST: i64 = 1 << 16;

/// Cells of the endless cloth brought home by the design's lattice, with their mirror
/// images; `None` if none of them is cloth.
pub fn cells(
    document: &Document,
    cells: impl IntoIterator<Item = Cell>,
    symmetry: [bool; 2],
) -> Option<Cells> {
    let design = document.design();
    let (ends, picks) = (design.ends(), design.picks());
    let mut found = Cells::none(ends, picks);
    let mut any = false;
    for (end, pick) in cells {
        let Some((end, pick)) = design.lattice().wrap(end, pick, ends, picks) else {
            continue;
        };
        any = true;
        let across = [end, ends - 1 - end];
        let along = [pick, picks - 1 - pick];
        for end in &across[..1 + usize::from(symmetry[0])] {
            for pick in &along[..1 + usize::from(symmetry[1])] {
                found.insert(*end, *pick);
            }
        }
    }
    any.then_some(found)
}

/// The cells of a straight line, both ends included (Bresenham 1965).
pub fn line(from: Cell, to: Cell) -> impl Iterator<Item = Cell> + use<> {
    let (across, along) = (to.0 - from.0, to.1 - from.1);
    let steps = across.abs().max(along.abs()).clamp(0, LONGEST);
    let at = move |step: i64, by: i64| match steps {
        0 => 0,
        // Half a step is added so that the middle of a line is rounded like its ends.
        steps => (2 * step * by + steps).div_euclid(2 * steps),
    };
    (0..=steps).map(move |step| (from.0 + at(step, across), from.1 + at(step, along)))
}

/// A rectangle between two corners: filled, or its outline alone.
pub fn rectangle(
    document: &Document,
    from: Cell,
    to: Cell,
    outline: bool,
    symmetry: [bool; 2],
) -> Option<Cells> {
    let design = document.design();
    // Wider than a repeat covers no more than a repeat.
    let span = |a: i64, b: i64, count: u32| {
        let (low, high) = (a.min(b), a.max(b));
        (low, high.min(low + i64::from(count) - 1))
    };
    let (left, right) = span(from.0, to.0, design.ends());
    let (low, high) = span(from.1, to.1, design.picks());
    let on_edge =
        move |end: i64, pick: i64| end == left || end == right || pick == low || pick == high;
    let all = (low..=high).flat_map(move |pick| (left..=right).map(move |end| (end, pick)));
    cells(
        document,
        all.filter(move |&(end, pick)| !outline || on_edge(end, pick)),
        symmetry,
    )
}

/// What a crossing is compared by.
fn value(document: &Document, layer: Layer) -> impl Fn(u32, u32) -> u16 + '_ {
    move |end, pick| match (layer, document.design().structure()) {
        (Layer::Regions, Structure::Regions(regions)) => regions.map().get(end, pick),
        _ => u16::from(document.drawdown().get(end, pick)),
    }
}

/// The crossings that are like the one at `cell` and joined to it by sides, round the
/// repeat.
pub fn fill(document: &Document, cell: Cell, layer: Layer) -> Option<Cells> {
    let design = document.design();
    let (ends, picks, lattice) = (design.ends(), design.picks(), design.lattice());
    let first = lattice.wrap(cell.0, cell.1, ends, picks)?;
    let value = value(document, layer);
    let wanted = value(first.0, first.1);
    let mut found = Cells::of(ends, picks, [first]);
    let mut next = vec![first];
    while let Some((end, pick)) = next.pop() {
        for (across, along) in [(1, 0), (-1, 0), (0, 1), (0, -1)] {
            let (end, pick) = (i64::from(end) + across, i64::from(pick) + along);
            if let Some((end, pick)) = lattice.wrap(end, pick, ends, picks)
                && value(end, pick) == wanted
                && found.insert(end, pick)
            {
                next.push((end, pick));
            }
        }
    }
    Some(found)
}

/// All crossings that are like the one at `cell`.
pub fn alike(document: &Document, cell: Cell, layer: Layer) -> Option<Cells> {
    let design = document.design();
    let (ends, picks) = (design.ends(), design.picks());
    let (end, pick) = design.lattice().wrap(cell.0, cell.1, ends, picks)?;
    let value = value(document, layer);
    let wanted = value(end, pick);
    let all = (0..picks).flat_map(|pick| (0..ends).map(move |end| (end, pick)));
    Some(Cells::of(
        ends,
        picks,
        all.filter(|&(end, pick)| value(end, pick) == wanted),
    ))
}
