//! One crossing in words.

use pickglass::design::{Design, FaceFloat, Structure, float_through};
use pickglass::edit::Document;
use pickglass::text::visible;

use super::laid;

/// Floats are counted up to this many threads; what runs further snags at any sett.
const LONGEST: u32 = 999;

/// The crossing (end, pick) of the endless cloth as weavers would say it, counted from 1 as
/// in files and on paper, in every layout; `None` where there is no cloth. `limits` = threads that an end and a pick
/// may pass over.
pub fn describe(document: &Document, (end, pick): (i64, i64), limits: [u32; 2]) -> Option<String> {
    let (design, drawdown) = (document.design(), document.drawdown());
    let lattice = design.lattice();
    let (home_end, home_pick) = lattice.wrap(end, pick, drawdown.ends(), drawdown.picks())?;
    let FaceFloat { warp, length, .. } = float_through(drawdown, lattice, (end, pick), LONGEST)?;
    let name = |yarn| visible(&design.yarn(yarn).name);
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
        length if length > limits[usize::from(!warp)] => format!("float over {length}, too long"),
        length => format!("float over {length}"),
    };
    let region = match design.structure() {
        Structure::Regions(regions) => {
            let number = regions.map().get(home_end, home_pick);
            let region = regions.palette().get(usize::from(number))?;
            format!(" · {}", visible(&region.name))
        }
        _ => String::new(),
    };
    let (end, pick) = numbers(design, (end, pick))?;
    Some(format!(
        "end {end} · pick {pick} · {above} over {below} · {over}{region}"
    ))
}

/// The numbers, from 1, of the end and the pick that cross at (end, pick) of the endless
/// cloth: counted over the repeat of the colours, as a warper does; `None` where there is no
/// cloth.
pub fn numbers(design: &Design, (end, pick): (i64, i64)) -> Option<(u32, u32)> {
    let (ends, picks) = laid::whole(design);
    let (end, pick) = design.lattice().wrap(end, pick, ends, picks)?;
    Some((end + 1, pick + 1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::opened::Opened;

    #[test]
    fn a_crossing_is_told_as_a_weaver_would() {
        let opened = Opened::preset("oxford").expect("a preset");
        let document = Document::new(Design::clone(&opened.design));
        let ends = i64::from(opened.design.ends());
        let told = |at| describe(&document, at, [7; 2]).expect("cloth");
        let plain = told((0, 0));
        assert!(
            plain.starts_with("end 1 · pick 1 · ") && plain.contains(" over "),
            "{plain}"
        );
        // The next repeat is the same crossing, in whatever yarn.
        let next = told((ends, 0));
        assert!(next.starts_with("end 1 · pick 1 · "), "{next}");
    }

    #[test]
    fn threads_are_counted_over_the_repeat_of_the_colours() {
        let opened = Opened::preset("default").expect("a preset");
        let document = Document::new(Design::clone(&opened.design));
        let (ends, picks) = opened.design.colour_repeat();
        assert!(ends > 4 && picks > 4);
        let told = |at| describe(&document, at, [7; 2]).expect("cloth");
        assert!(told((9, 5)).starts_with("end 10 · pick 6 · "));
        let next = (ends as i64 + 9, 5 - picks as i64);
        assert!(told(next).starts_with("end 10 · pick 6 · "));
    }

    #[test]
    fn a_float_beyond_its_limit_is_called_too_long() {
        let opened = Opened::preset("silk-satin").expect("a preset");
        let document = Document::new(Design::clone(&opened.design));
        let (ends, picks) = (opened.design.ends(), opened.design.picks());
        let long = |limits| {
            let cells = (0..i64::from(ends) * i64::from(picks)).filter(|at| {
                let at = (at % i64::from(ends), at / i64::from(ends));
                let told = describe(&document, at, limits).expect("cloth");
                told.ends_with("too long")
            });
            cells.count()
        };
        assert_eq!(long([99, 99]), 0);
        // Each way has a limit of its own, and both together find what either finds.
        let (warp, weft) = (long([2, 99]), long([99, 2]));
        assert!(warp + weft > 0 && warp != weft, "{warp} {weft}");
        assert_eq!(long([2, 2]), warp + weft);
    }
}
