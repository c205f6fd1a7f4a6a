//! The cloth of a card file becomes a design.

use super::areas::parse;
use crate::design::{FirstEnd, FirstPick, Structure, WeavePattern};
use crate::formats::sheet::threads::Threads;
use crate::formats::sheet::{Misfit, NO_PALETTE, Place, Sheet, SheetError, Warnings};
use crate::formats::{Imported, LoadOptions};

/// What is remarked on where nobody said that the cloth is woven face down.
pub const FACE_UP: &str = "taken as woven face up: say so if it is woven face down";

/// Reads the cloth of a card file: a drawdown in a white warp and a blue weft, since the
/// loom knows no yarns. `name` is what messages call it.
///
/// # Errors
/// [`SheetError`]: one line with the file, the byte, what was expected and what to do.
pub fn read(bytes: &[u8], name: &str, options: &LoadOptions) -> Result<Imported, SheetError> {
    let card = parse(bytes, name)?;
    let mut warnings = Warnings::default();
    let Some(cloth) = card.cloth() else {
        let problem = "expected an area of hooks, found none";
        return Err(SheetError::at(
            name,
            Place::Byte(card.header.len()),
            problem,
            "get a whole file",
        ));
    };
    warnings.whole(card.roles());
    for what in &card.unread {
        warnings.whole(what.clone());
    }
    if !card.tail.is_empty() {
        warnings.whole(format!(
            "{} bytes behind the last row are not read",
            card.tail.len()
        ));
    }
    let lifted = lifted(card.area_rows(cloth), cloth.hooks);
    let weave = if options.face_down {
        warnings.whole("woven face down, as was asked: turned over like a page");
        turned_over(&lifted)
    } else {
        warnings.whole(FACE_UP);
        lifted
    };
    let (white, blue) = (NO_PALETTE[0], NO_PALETTE[1]);
    let sheet = Sheet {
        file: name,
        title: card.name.clone(),
        notes: String::new(),
        program: card.program.clone(),
        structure: Structure::Pattern(weave),
        warp: Threads::listed(1, None, Vec::new()),
        weft: Threads::listed(1, None, Vec::new()),
        warp_colours: vec![(1, white)],
        weft_colours: vec![(2, blue)],
        palette: Vec::new(),
        sections: Vec::new(),
        first_end: FirstEnd::Left,
        first_pick: FirstPick::Bottom,
    };
    let wrong = |misfit: Misfit| SheetError::whole(name, misfit.problem, misfit.remedy);
    sheet.design(options, warnings).map_err(wrong)
}

/// The pattern of lifts, as the cloth lies in the loom.
fn lifted<'r>(rows: impl ExactSizeIterator<Item = &'r [u8]>, hooks: u32) -> WeavePattern {
    let mut pattern = WeavePattern::new(hooks, rows.len() as u32);
    for (pick, row) in (0..).zip(rows) {
        for (word, bytes) in (0..).zip(row.chunks(8)) {
            let mut bits = [0; 8];
            bits[..bytes.len()].copy_from_slice(bytes);
            pattern.set_pick_word(word, pick, u64::from_le_bytes(bits));
        }
    }
    pattern
}

/// The cloth turned over as one turns a page: the other face, its ends running the other
/// way. Its own inverse.
pub(super) fn turned_over(pattern: &WeavePattern) -> WeavePattern {
    pattern.inverted().mirrored()
}
