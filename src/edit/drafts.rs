//! Shaft drafts: threading, tie-up, treadling, lift plan, and back from the cloth.

use super::crossings;
use super::document::Work;
use super::edits::{Edit, Rows};
use super::error::EditError;
use crate::design::{Draft, Lifting, Loom, Shed, Structure, Ties, derive};

/// The most shafts of a draft that is derived from a cloth; what needs more is a jacquard.
const MOST_DERIVED: u32 = 1024;

/// The draft of a design that has one.
fn of(work: &Work, part: &'static str) -> Result<Draft, EditError> {
    match work.design.structure() {
        Structure::Draft(draft) => Ok(draft.clone()),
        _ => Err(EditError::NoPart {
            part,
            remedy: "derive a draft from the drawdown first",
        }),
    }
}

/// Puts a draft in the place of the one before and weaves some picks, or all.
fn put(work: &mut Work, draft: Draft, picks: Option<Vec<u32>>) {
    match picks {
        Some(picks) => draft.weave_picks(picks, &mut work.drawdown),
        None => draft.weave_picks(0..draft.picks(), &mut work.drawdown),
    }
    *work.design.structure_mut() = Structure::Draft(draft);
}

/// Refuses places beyond the last.
fn check(rows: &Rows, thing: &'static str, count: usize) -> Result<(), EditError> {
    match rows.iter().map(|(place, _)| *place).max() {
        Some(most) if most as usize >= count => Err(EditError::Missing {
            thing,
            number: u64::from(most) + 1,
            count: count as u64,
        }),
        _ => Ok(()),
    }
}

/// The shafts of some ends.
pub(super) fn threading(work: &mut Work, rows: &Rows) -> Result<(), EditError> {
    let draft = of(work, "threading")?;
    check(rows, "end", draft.ends() as usize)?;
    let threading = draft.threading().with_rows(rows);
    let draft = rebuilt(&draft, threading, draft.lifting().clone())?;
    // Ends far apart cost whole picks; what weaves as before stays shared.
    put(work, draft, None);
    Ok(())
}

/// A draft of the same frame with other threading and lifting.
pub(super) fn rebuilt(
    draft: &Draft,
    threading: Ties,
    lifting: Lifting,
) -> Result<Draft, EditError> {
    let (shafts, treadles) = (draft.shafts(), draft.treadles());
    Ok(Draft::new(
        shafts,
        treadles,
        draft.shed(),
        threading,
        lifting,
    )?)
}

/// The shafts of some treadles.
pub(super) fn tie_up(work: &mut Work, rows: &Rows) -> Result<(), EditError> {
    let draft = of(work, "tie-up")?;
    let Lifting::Treadled { tieup, treadling } = draft.lifting() else {
        return Err(no_treadles("tie-up"));
    };
    check(rows, "treadle", draft.treadles() as usize)?;
    // Treadles at the end of the list may have no row yet.
    let most = rows.iter().map(|(place, _)| *place as usize + 1).max();
    let mut longer = tieup.clone();
    for _ in longer.len()..most.unwrap_or(0) {
        longer.push(&[]);
    }
    let tieup = longer.with_rows(rows);
    let mut changed = vec![false; draft.treadles() as usize];
    for (place, _) in rows {
        changed[*place as usize] = true;
    }
    let pressed = |pick: &usize| {
        let pressed = treadling.row(*pick).iter();
        pressed
            .into_iter()
            .any(|&treadle| changed[usize::from(treadle)])
    };
    let picks = (0..treadling.len())
        .filter(pressed)
        .map(|pick| pick as u32)
        .collect();
    let lifting = Lifting::Treadled {
        tieup,
        treadling: treadling.clone(),
    };
    let draft = rebuilt(&draft, draft.threading().clone(), lifting)?;
    put(work, draft, Some(picks));
    Ok(())
}

fn no_treadles(part: &'static str) -> EditError {
    EditError::NoPart {
        part,
        remedy: "it lifts by a lift plan; use treadles first",
    }
}

/// The treadles of some picks.
pub(super) fn treadling(work: &mut Work, rows: &Rows) -> Result<(), EditError> {
    let draft = of(work, "treadling")?;
    let Lifting::Treadled { tieup, treadling } = draft.lifting() else {
        return Err(no_treadles("treadling"));
    };
    check(rows, "pick", treadling.len())?;
    let treadling = treadling.with_rows(rows);
    let lifting = Lifting::Treadled {
        tieup: tieup.clone(),
        treadling,
    };
    relift(work, &draft, lifting, rows)
}

/// The shafts of some picks.
pub(super) fn lift_plan(work: &mut Work, rows: &Rows) -> Result<(), EditError> {
    let draft = of(work, "lift plan")?;
    let Lifting::LiftPlan(plan) = draft.lifting() else {
        return Err(EditError::NoPart {
            part: "lift plan",
            remedy: "it lifts by treadles; use a lift plan first",
        });
    };
    check(rows, "pick", plan.len())?;
    let lifting = Lifting::LiftPlan(plan.with_rows(rows));
    relift(work, &draft, lifting, rows)
}

/// Lifts some picks otherwise.
fn relift(work: &mut Work, draft: &Draft, lifting: Lifting, rows: &Rows) -> Result<(), EditError> {
    let draft = rebuilt(draft, draft.threading().clone(), lifting)?;
    put(
        work,
        draft,
        Some(rows.iter().map(|(pick, _)| *pick).collect()),
    );
    Ok(())
}

/// How many shafts there are; those in use cannot go.
pub(super) fn set_shafts(work: &mut Work, shafts: u32) -> Result<(), EditError> {
    let draft = of(work, "shafts")?;
    let (threading, lifting) = (draft.threading().clone(), draft.lifting().clone());
    let draft = Draft::new(
        shafts.max(1),
        draft.treadles(),
        draft.shed(),
        threading,
        lifting,
    )?;
    put(work, draft, Some(Vec::new()));
    Ok(())
}

/// How many treadles there are; those in use cannot go, those tied but never pressed can.
pub(super) fn set_treadles(work: &mut Work, treadles: u32) -> Result<(), EditError> {
    let draft = of(work, "treadles")?;
    let Lifting::Treadled { tieup, treadling } = draft.lifting() else {
        return Err(no_treadles("treadles"));
    };
    let tieup = Ties::from_rows(tieup.iter().take(treadles as usize));
    let lifting = Lifting::Treadled {
        tieup,
        treadling: treadling.clone(),
    };
    let (shafts, threading) = (draft.shafts(), draft.threading().clone());
    let draft = Draft::new(shafts, treadles, draft.shed(), threading, lifting)?;
    put(work, draft, Some(Vec::new()));
    Ok(())
}

/// Whether named shafts rise or sink.
pub(super) fn set_shed(work: &mut Work, shed: Shed) -> Result<(), EditError> {
    let draft = of(work, "shed")?;
    let (threading, lifting) = (draft.threading().clone(), draft.lifting().clone());
    let draft = Draft::new(draft.shafts(), draft.treadles(), shed, threading, lifting)?;
    put(work, draft, None);
    Ok(())
}

/// Says the lifting pick by pick.
pub(super) fn use_lift_plan(work: &mut Work) -> Result<(), EditError> {
    let draft = of(work, "lift plan")?;
    let plan = draft.lift_plan();
    let threading = draft.threading().clone();
    let (shafts, shed) = (draft.shafts(), draft.shed());
    let draft = Draft::new(shafts, shafts, shed, threading, Lifting::LiftPlan(plan))?;
    put(work, draft, Some(Vec::new()));
    Ok(())
}

/// Says the lifting by treadles: one for each different lift, in order of first use.
pub(super) fn use_treadles(work: &mut Work) -> Result<(), EditError> {
    let draft = of(work, "treadling")?;
    let Lifting::LiftPlan(plan) = draft.lifting() else {
        return Ok(());
    };
    let mut known = std::collections::BTreeMap::new();
    let mut tieup = Ties::default();
    let mut treadling = Ties::default();
    for lift in plan.iter() {
        let next = known.len();
        let treadle = *known.entry(lift).or_insert(next);
        if treadle == next {
            tieup.push(lift);
        }
        let Ok(treadle) = u16::try_from(treadle) else {
            return Err(EditError::Value {
                place: "treadles",
                problem: "more than 65535 different lifts: keep the lift plan".to_owned(),
            });
        };
        treadling.push(&[treadle]);
    }
    let treadles = tieup.len() as u32;
    let lifting = Lifting::Treadled { tieup, treadling };
    let (shafts, threading) = (draft.shafts(), draft.threading().clone());
    let draft = Draft::new(shafts, treadles, draft.shed(), threading, lifting)?;
    put(work, draft, Some(Vec::new()));
    Ok(())
}

/// A draft of the fewest shafts for the drawdown, after something was painted on that. A
/// draft with a lift plan gets one again; a sinking shed becomes a rising one.
pub(super) fn derive_draft(work: &mut Work, after: Option<Edit>) -> Result<(), EditError> {
    let planned = match work.design.structure() {
        Structure::Draft(draft) => matches!(draft.lifting(), Lifting::LiftPlan(_)),
        _ => false,
    };
    if let Some(edit) = after {
        crossings::become_pattern(work)?;
        work.apply(edit)?;
    }
    let loom = Loom {
        shafts: MOST_DERIVED,
        treadles: if planned { 0 } else { MOST_DERIVED },
        dobby: true,
    };
    let draft = derive(&work.drawdown, &loom)?;
    *work.design.structure_mut() = Structure::Draft(draft);
    Ok(())
}
