//! One crossing in words.

use pickglass::design::{FaceFloat, float_through};
use pickglass::edit::Document;

/// Floats are counted up to this many threads; what runs further snags at any sett.
const LONGEST: u32 = 999;

/// The crossing (end, pick) of the endless cloth as weavers would say it, counted from 1;
/// `None` where there is no cloth.
pub fn describe(document: &Document, (end, pick): (i64, i64)) -> Option<String> {
    let (design, drawdown) = (document.design(), document.drawdown());
    let lattice = design.lattice();
    let (home_end, home_pick) = lattice.wrap(end, pick, drawdown.ends(), drawdown.picks())?;
    let FaceFloat { warp, length, .. } = float_through(drawdown, lattice, (end, pick), LONGEST)?;
    let name = |yarn| design.yarn(yarn).name.as_str();
    let (end_yarn, pick_yarn) = (
        name(design.warp_yarn(end, pick)),
        name(design.weft_yarn(end, pick)),
    );
    let (above, below) = if warp {
        (end_yarn, pick_yarn)
    } else {
        (pick_yarn, end_yarn)
    };
    let over = match length {
        LONGEST => "never bound".to_owned(),
        1 => "over 1".to_owned(),
        length => format!("float over {length}"),
    };
    let (end, pick) = (home_end + 1, home_pick + 1);
    Some(format!(
        "end {end} · pick {pick} · {above} over {below} · {over}"
    ))
}
