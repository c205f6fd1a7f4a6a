//! Looms whose hooks are known: a card file to write into, made of a preset.

use serde::{Deserialize, Serialize};

use super::areas::{AREA, MAGIC, NAME, PICKS, PROGRAM, Role};
use crate::design::{WeavePattern, weave};
use crate::formats::sheet::SheetError;

/// More hooks than any loom has.
const MOST_HOOKS: u64 = 1 << 20;

/// The hooks of a loom.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LoomPreset {
    /// What it is, for people.
    pub about: String,
    /// Whether its cloth is woven face down.
    pub face_down: bool,
    /// Its areas, in the order of the hooks.
    pub areas: Vec<LoomArea>,
}

/// One area of hooks.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LoomArea {
    /// What it is for; one of them is the cloth.
    pub role: Role,
    /// Number of hooks, a multiple of 8.
    pub hooks: u32,
    /// Controls: the hooks lifted on every pick, from 1.
    #[serde(default)]
    pub lifted: Vec<u32>,
    /// Selvedge: the notation of its weave ("4/4 twill").
    #[serde(default)]
    pub weave: Option<String>,
}

/// Name and text of the presets that come with the program.
pub const PRESETS: [(&str, &str); 1] = [(
    "staubli-5120",
    include_str!("../../../presets/looms/staubli-5120.ron"),
)];

impl LoomPreset {
    /// Reads a preset's text; `name` is what messages call it.
    ///
    /// # Errors
    /// [`SheetError`] for a text that is no preset, with its line.
    pub fn parse(text: &str, name: &str) -> Result<Self, SheetError> {
        ron::from_str(text).map_err(|error| {
            let problem = format!("expected the areas of a loom: {error}").replace('\n', " ");
            SheetError::whole(name, problem, "see presets/looms for one that is right")
        })
    }

    /// The preset of a name that comes with the program; `None` if there is none.
    ///
    /// # Errors
    /// As [`LoomPreset::parse`], which a test rules out for every name.
    pub fn named(name: &str) -> Option<Result<Self, SheetError>> {
        let (name, text) = PRESETS.iter().find(|preset| preset.0 == name)?;
        Some(Self::parse(text, name))
    }
}

/// The longest repeat of all selvedges together, picks.
const LONGEST_REPEAT: u32 = 256;

/// An empty card file for a loom, to be written into: two repeats of its selvedges, with
/// its controls and nothing lifted in the cloth.
///
/// # Errors
/// [`SheetError`] for a preset whose areas cannot be.
pub fn template(preset: &LoomPreset, name: &str) -> Result<Vec<u8>, SheetError> {
    let refused = |problem: String, remedy: &str| Err(SheetError::whole(name, problem, remedy));
    let of = |role| preset.areas.iter().filter(move |area| area.role == role);
    let widest = preset.areas.iter().map(|area| area.hooks).max();
    if of(Role::Cloth).count() != 1 || of(Role::Cloth).map(|area| area.hooks).max() != widest {
        let problem = "expected one area of cloth, the widest of all".to_owned();
        return refused(problem, "correct the preset");
    }
    let mut rows = Vec::new();
    let (mut hooks, mut repeat) = (0u64, 1u32);
    for (area, number) in preset.areas.iter().zip(1..) {
        hooks += u64::from(area.hooks);
        if area.hooks == 0 || !area.hooks.is_multiple_of(8) || hooks > MOST_HOOKS {
            let problem = format!("area {number} has {} hooks", area.hooks);
            return refused(problem, "give a multiple of 8, as many as the loom has");
        }
        let pattern = area_weave(area, number, name)?;
        // The least common multiple: the first number of repeats that closes.
        let own = pattern.picks();
        let together = (1..=LONGEST_REPEAT).map(|times| repeat.saturating_mul(times));
        repeat = match together
            .take_while(|&picks| picks <= LONGEST_REPEAT)
            .find(|picks| picks.is_multiple_of(own))
        {
            Some(picks) => picks,
            None => {
                let problem =
                    format!("the selvedges repeat after more than {LONGEST_REPEAT} picks");
                return refused(problem, "choose weaves with a shorter common repeat");
            }
        };
        rows.push(pattern);
    }
    let picks = 2 * repeat;
    let mut bytes = MAGIC.to_vec();
    let number = |bytes: &mut Vec<u8>, number: usize| {
        bytes.extend_from_slice(&(number as u32).to_be_bytes());
    };
    let program = format!("Pickglass {}\0", env!("CARGO_PKG_VERSION"));
    let records: [(u32, &[u8]); 4] = [
        (NAME, b"PICKGLAS\0"),
        (PICKS, &picks.to_be_bytes()),
        (6, &[0; 4]),
        (PROGRAM, program.as_bytes()),
    ];
    number(&mut bytes, records.len());
    for (tag, body) in records {
        number(&mut bytes, tag as usize);
        number(&mut bytes, body.len());
        bytes.extend_from_slice(body);
    }
    number(&mut bytes, preset.areas.len());
    for (area, place) in preset.areas.iter().zip(1..) {
        let title = format!("Area {place}: {} hooks\0", area.hooks);
        number(&mut bytes, AREA as usize);
        number(&mut bytes, 8 + title.len());
        number(&mut bytes, 1);
        number(&mut bytes, area.hooks as usize);
        bytes.extend_from_slice(title.as_bytes());
    }
    for pick in 0..picks {
        for (area, pattern) in preset.areas.iter().zip(&rows) {
            let along = pick % pattern.picks();
            for from in (0..area.hooks).step_by(8) {
                let bits = (0..8)
                    .map(|bit| u8::from(pattern.get((from + bit) % pattern.ends(), along)) << bit);
                bytes.push(bits.fold(0, |byte, bit| byte | bit));
            }
        }
    }
    Ok(bytes)
}

/// What an area lifts, one repeat.
fn area_weave(area: &LoomArea, number: u32, name: &str) -> Result<WeavePattern, SheetError> {
    if let Some(notation) = &area.weave {
        return weave(notation).map_err(|error| {
            let problem = format!("area {number}: {error}");
            SheetError::whole(name, problem, "correct the preset")
        });
    }
    if let Some(hook) = area
        .lifted
        .iter()
        .find(|hook| !(1..=area.hooks).contains(hook))
    {
        let problem = format!("area {number} lifts hook {hook} of {}", area.hooks);
        return Err(SheetError::whole(name, problem, "correct the preset"));
    }
    let mut pattern = WeavePattern::try_new(u64::from(area.hooks), 1)
        .map_err(|error| SheetError::whole(name, error.to_string(), "correct the preset"))?;
    for hook in &area.lifted {
        pattern.set(hook - 1, 0, true);
    }
    Ok(pattern)
}
