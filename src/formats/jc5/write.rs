//! A design is put into the cloth area of a card file.

use super::areas::{Area, CardFile, Role, parse};
use super::read::turned_over;
use crate::design::{Design, MAX_CROSSINGS, Repeat, Structure, WeavePattern, check_size};
use crate::formats::sheet::SheetError;

/// How a card file is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct WriteOptions {
    /// The cloth is woven face down: what lies on its face is not lifted.
    pub face_down: bool,
}

/// A written file and what of the design it does not hold.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Written {
    /// The file.
    pub bytes: Vec<u8>,
    /// One line each: what a card file has no place for.
    pub lost: Vec<String>,
}

/// Writes the weave of `design` into the hooks of `template`, a card file of the loom:
/// header, controls and selvedge stay word for word, only the number of picks and the
/// cloth change. `name` is what messages call the template.
///
/// A design narrower than the cloth is repeated over it if it fits a whole number of times.
/// With another number of picks than the template has, a selvedge goes on in its own
/// repeat.
///
/// # Errors
/// [`SheetError`] for a template that is none, and for a design that does not fit its hooks.
pub fn write_into(
    template: &[u8],
    name: &str,
    design: &Design,
    options: WriteOptions,
) -> Result<Written, SheetError> {
    let card = parse(template, name)?;
    let Some(cloth) = card.cloth() else {
        let problem = "expected an area of hooks for the cloth, found none";
        return Err(SheetError::whole(name, problem, "choose another loom file"));
    };
    let mut lost = losses(design);
    let weave = fitted(&card, cloth, design, &mut lost)?;
    let weave = if options.face_down {
        turned_over(&weave)
    } else {
        weave
    };
    let picks = weave.picks();
    let hooks = card.width() as u64 * 8;
    check_size(hooks, u64::from(picks))
        .map_err(|error| SheetError::whole(name, error.to_string(), "use a smaller repeat"))?;
    let mut kept = Vec::new();
    for area in card.areas.iter().filter(|area| *area != cloth) {
        kept.push((area.bytes(), Continued::of(&card, area, picks, &mut lost)?));
    }
    let (header, width) = (card.header.len(), card.width());
    let mut bytes = Vec::with_capacity(header + width * picks as usize + card.tail.len());
    bytes.extend_from_slice(card.header);
    bytes[card.picks_at..card.picks_at + 4].copy_from_slice(&picks.to_be_bytes());
    let mut row = vec![0u8; width];
    for pick in 0..picks {
        for (place, rows) in &kept {
            row[place.clone()].copy_from_slice(rows.row(&card, place, pick));
        }
        let cells = row[cloth.bytes()].chunks_mut(8);
        for (cell, word) in cells.zip(weave.pick_words(pick)) {
            cell.copy_from_slice(&word.to_le_bytes()[..cell.len()]);
        }
        bytes.extend_from_slice(&row);
    }
    bytes.extend_from_slice(card.tail);
    Ok(Written { bytes, lost })
}

/// The design's weave as wide as the cloth area.
fn fitted(
    card: &CardFile<'_>,
    cloth: &Area,
    design: &Design,
    lost: &mut Vec<String>,
) -> Result<WeavePattern, SheetError> {
    let (ends, picks) = (design.ends(), design.picks());
    if ends == cloth.hooks {
        return Ok(design.weave());
    }
    if ends > cloth.hooks || !cloth.hooks.is_multiple_of(ends) {
        let hooks = cloth.hooks;
        let problem = format!("the cloth of this loom has {hooks} hooks, the design {ends} ends");
        let below = (1..=ends.min(hooks))
            .rev()
            .find(|&ends| hooks.is_multiple_of(ends));
        let above = (ends..=hooks).find(|&ends| hooks.is_multiple_of(ends));
        let fits = match (below, above) {
            (Some(below), Some(above)) => format!("{below} or {above}"),
            (Some(only), None) | (None, Some(only)) => only.to_string(),
            (None, None) => hooks.to_string(),
        };
        let remedy = format!("draw it on {fits} ends, or choose another loom");
        return Err(SheetError::whole(card.file, problem, remedy));
    }
    check_size(u64::from(cloth.hooks), u64::from(picks))
        .map_err(|error| SheetError::whole(card.file, error.to_string(), "use fewer picks"))?;
    lost.push(format!(
        "nothing yet, but the design's {ends} ends are repeated {} times over {} hooks",
        cloth.hooks / ends,
        cloth.hooks
    ));
    Ok(design.weave().repeated(cloth.hooks, picks, (0, 0)))
}

/// What a card file has no place for.
fn losses(design: &Design) -> Vec<String> {
    let mut lost = vec!["yarns, their colours and the sett: a card file only lifts".to_owned()];
    if !design.weavable() {
        lost.push(
            "yarns that change along a thread are for previews only: no loom weaves them".into(),
        );
    }
    match design.structure() {
        Structure::Regions(_) => {
            lost.push("regions and corrections: only the weave they make is written".into());
        }
        Structure::Draft(_) => {
            lost.push(
                "threading, tie-up and treadling: only the weave they make is written".into(),
            );
        }
        Structure::Pattern(_) | Structure::Weave(_) => {}
    }
    let lattice = design.lattice();
    if lattice.across != Repeat::Straight || lattice.along != Repeat::Straight {
        lost.push("the repeat: a loom goes on straight".into());
    }
    let (ends, picks) = design.cloth_repeat();
    let own = (u64::from(design.ends()), u64::from(design.picks()));
    if (ends, picks) != own && ends.saturating_mul(picks) <= MAX_CROSSINGS {
        lost.push(format!(
            "the order of yarns repeats after {ends} ends × {picks} picks, not with the weave"
        ));
    }
    lost
}

/// Another area, gone on for a new number of picks.
enum Continued {
    /// As in the template, pick by pick.
    Verbatim,
    /// From the start again after so many picks.
    After(u32),
}

impl Continued {
    fn of(
        card: &CardFile<'_>,
        area: &Area,
        picks: u32,
        lost: &mut Vec<String>,
    ) -> Result<Self, SheetError> {
        if picks == card.picks {
            return Ok(Self::Verbatim);
        }
        if area.role == Role::Controls {
            return Ok(Self::After(1));
        }
        let Some(period) = period(card, area) else {
            let problem = format!(
                "its area of {} hooks beside the cloth does not repeat within {} picks, and the \
                 design has {picks}",
                area.hooks, card.picks
            );
            let remedy = format!("draw the design on {} picks", card.picks);
            return Err(SheetError::whole(card.file, problem, remedy));
        };
        if !picks.is_multiple_of(period) {
            lost.push(format!(
                "the selvedge's repeat: {picks} picks are no multiple of its {period}"
            ));
        }
        Ok(Self::After(period))
    }

    fn row<'c>(&self, card: &CardFile<'c>, place: &std::ops::Range<usize>, pick: u32) -> &'c [u8] {
        let pick = match self {
            Self::Verbatim => pick,
            Self::After(period) => pick % period,
        };
        let from = pick as usize * card.width();
        &card.rows[from + place.start..from + place.end]
    }
}

/// The longest repeat of a selvedge that is looked for, picks.
const LONGEST_PERIOD: u32 = 256;

/// After how many picks an area starts again; it must do so at least once in the file.
fn period(card: &CardFile<'_>, area: &Area) -> Option<u32> {
    (1..=LONGEST_PERIOD.min(card.picks / 2)).find(|&period| {
        let rows = card.area_rows(area);
        let later = rows.clone().skip(period as usize);
        rows.zip(later).all(|(row, later)| row == later)
    })
}
