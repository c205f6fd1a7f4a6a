//! Files as disks, networks and other programs leave them.

use std::path::Path;
use std::sync::Arc;

use super::damage::damaged;
use super::fault::Fault;
use crate::design::{
    Design, Family, Srgb, Structure, WeavePattern, Yarn, YarnId, YarnMaps, usual_sett,
};
use crate::edit::recovery::{self, Recovery};
use crate::formats::{FORMATS, LoadOptions, SaveOptions, load_bytes, save_bytes};
use crate::job::Job;
use crate::presets;

/// Times that each file is damaged.
const TIMES: u64 = 60;
/// What damage puts in.
const PIECES: [&[u8]; 8] = [
    b"\n[WEAVING]\n",
    b"=-1\n",
    b"99999999999999999999",
    b"\xff\xd8\xff",
    b"\0\0\0\0",
    b"(((((((",
    b"1e999,NaN",
    b"\xf0\x9f\xa7\xb5",
];

fn preset() -> Result<Design, Fault> {
    match presets::design("herringbone") {
        Some(design) => design.map_err(Fault::of),
        None => Err(Fault::Wrong("the preset herringbone is missing".to_owned())),
    }
}

pub(super) fn damaged_files(job: &Job) -> Result<String, Fault> {
    let design = preset()?;
    let (mut files, mut read, mut refused) = (0, 0, 0);
    for format in FORMATS.iter().filter(|format| format.is_written()) {
        for ending in format.endings {
            // A format that cannot hold the design says so; there is nothing to damage.
            let Some(Ok(saved)) = save_bytes(&design, ending, &SaveOptions::default()) else {
                continue;
            };
            files += 1;
            let name = format!("damaged.{ending}");
            for seed in 0..TIMES {
                job.check()?;
                let bytes = damaged(&saved.bytes, seed, &PIECES);
                match load_bytes(&bytes, &name, &LoadOptions::default()) {
                    Ok(_) => read += 1,
                    Err(error) => {
                        refused += 1;
                        one_line(&error.to_string())?;
                    }
                }
            }
        }
    }
    Fault::unless(files > 3 && read > 0 && refused > 0, || {
        format!("{files} kinds of files: {read} read, {refused} refused")
    })?;
    Ok(format!(
        "{files} kinds of files: {read} read, {refused} refused"
    ))
}

fn one_line(said: &str) -> Result<(), Fault> {
    let plain = !said.is_empty() && !said.chars().any(char::is_control);
    Fault::unless(plain, || format!("a refusal is not one line: {said:?}"))
}

pub(super) fn damaged_recovery(job: &Job) -> Result<String, Fault> {
    let folder = tempfile::tempdir().map_err(Fault::of)?;
    let mut copy = Recovery::begin(folder.path()).map_err(Fault::of)?;
    let states = three_states()?;
    let mut ends = Vec::new();
    for state in &states {
        copy.save(&Arc::new(state.clone()), None)
            .map_err(Fault::of)?;
        ends.push(std::fs::metadata(copy.path()).map_err(Fault::of)?.len() as usize);
    }
    let whole = std::fs::read(copy.path()).map_err(Fault::of)?;
    copy.close().map_err(Fault::of)?;
    let path = folder.path().join("damaged.recovery");
    let back = |bytes: &[u8]| -> Result<Option<usize>, Fault> {
        std::fs::write(&path, bytes).map_err(Fault::of)?;
        let Some(design) = recovered(&path)? else {
            return Ok(None);
        };
        // What comes back is a state that there was, never a mixture.
        match states.iter().position(|state| *state == design) {
            Some(place) => Ok(Some(place)),
            None => Err(Fault::Wrong("a design came back that never was".to_owned())),
        }
    };
    // Cut off anywhere, all that was whole before comes back.
    for length in (0..=whole.len()).rev().step_by(7) {
        job.check()?;
        let known = ends.iter().rposition(|end| *end <= length);
        let found = back(&whole[..length])?;
        Fault::unless(found == known, || {
            format!("of {length} bytes state {found:?} comes back, not {known:?}")
        })?;
    }
    let mut refused = 0;
    for seed in 0..TIMES {
        job.check()?;
        refused += usize::from(back(&damaged(&whole, seed, &PIECES))?.is_none());
    }
    Ok(format!(
        "whole wherever it was cut off; of {TIMES} damaged {refused} refused"
    ))
}

/// A design, and what becomes of it by two edits.
fn three_states() -> Result<[Design; 3], Fault> {
    let yarn = |name, colour| Yarn::new(name, Family::Cotton, colour);
    let yarns = vec![
        yarn("warp", Srgb(20, 30, 90)),
        yarn("weft", Srgb(240, 230, 200)),
    ];
    let maps = YarnMaps::plain(YarnId(0), YarnId(1));
    let sett = usual_sett(&yarns, &maps);
    let state = |flipped: u32| {
        let pattern = WeavePattern::from_fn(96, 80, |end, pick| {
            let first = pick == 0 && end < flipped;
            ((end + pick) % 3 == 0) != first
        });
        let structure = Structure::Pattern(pattern);
        Design::new(
            "recovered",
            structure,
            yarns.clone(),
            maps.clone(),
            sett.clone(),
        )
    };
    let [first, second, third] = [0, 1, 2].map(state);
    Ok([
        first.map_err(Fault::of)?,
        second.map_err(Fault::of)?,
        third.map_err(Fault::of)?,
    ])
}

/// The design of a recovery copy; `None` where it is refused.
fn recovered(path: &Path) -> Result<Option<Design>, Fault> {
    match recovery::load(path) {
        Ok(recovered) => {
            if let Some(lost) = &recovered.lost {
                one_line(lost)?;
            }
            Ok(Some(recovered.design))
        }
        Err(error) => {
            one_line(&error.to_string())?;
            Ok(None)
        }
    }
}
