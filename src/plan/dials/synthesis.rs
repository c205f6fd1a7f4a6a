//! Dials of the synthesis.

use crate::plan::dial::{Dial, Invalidates, Measure, always, number};
use crate::plan::effect::Effect;
use crate::synthesis::{Closing, Rank};

pub(super) static METHOD: Dial = Dial {
    name: "method",
    title: "Choice of blocks",
    about: "how blocks are chosen for crossings",
    values: "naive, greedy or dp",
    ladder: &["naive", "greedy", "dp"],
    invalidates: Invalidates::Assignment,
    measure: Measure::Continuity,
    effect: None,
    of_voxels: false,
    elsewhere: None,
    idle: always,
    get: |settings| settings.cloth.synthesis.method.to_string(),
    set: |settings, text| {
        settings.cloth.synthesis.method = text.parse().ok()?;
        Some(())
    },
};

pub(super) static SEAMS: Dial = Dial {
    name: "seams",
    title: "What meets at seams",
    about: "whether yarns that are seen run on without a kink from block to block",
    values: "membrane or crowns",
    ladder: &["membrane", "crowns"],
    invalidates: Invalidates::Seams,
    measure: Measure::Kinks,
    effect: Some(Effect::EdgeFixing),
    of_voxels: false,
    elsewhere: None,
    idle: |settings, _| {
        let why = "rank 0 leaves all seams open: leave one of the two out";
        (settings.cloth.synthesis.closing() == Closing::Off).then_some(why)
    },
    get: |settings| settings.cloth.synthesis.seams.to_string(),
    set: |settings, text| {
        settings.cloth.synthesis.seams = text.parse().ok()?;
        Some(())
    },
};

pub(super) static RANK: Dial = Dial {
    name: "rank",
    title: "Closing of seams",
    about: "how finely a membrane closes seams between blocks",
    values: "0 to 1000, or exact",
    ladder: &["0", "5", "15", "40", "exact"],
    invalidates: Invalidates::Seams,
    measure: Measure::Seams,
    effect: Some(Effect::EdgeFixing),
    of_voxels: false,
    elsewhere: None,
    idle: |settings, _| {
        let why = "crowns have no membrane: leave one of the two out";
        (settings.cloth.synthesis.closing() == Closing::Crowns).then_some(why)
    },
    get: |settings| match settings.cloth.synthesis.rank {
        Rank::Off => "0".to_owned(),
        Rank::Truncated(rank) => rank.to_string(),
        Rank::Exact => "exact".to_owned(),
    },
    set: |settings, text| {
        settings.cloth.synthesis.rank = match text {
            "exact" => Rank::Exact,
            "0" => Rank::Off,
            _ => Rank::Truncated(number(text, 1..=1000)?),
        };
        Some(())
    },
};

pub(super) static PATCH: Dial = Dial {
    name: "patch",
    title: "Patches that vary",
    about: "edge of the patches that are randomised together, crossings",
    values: "0 to 64",
    ladder: &["0", "64", "8", "3", "1"],
    invalidates: Invalidates::Assignment,
    measure: Measure::Repetition,
    effect: Some(Effect::Randomisation),
    of_voxels: false,
    elsewhere: None,
    idle: always,
    get: |settings| settings.cloth.synthesis.patch.to_string(),
    set: |settings, text| {
        settings.cloth.synthesis.patch = number(text, 0..=64)?;
        Some(())
    },
};
