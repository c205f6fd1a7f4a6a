//! Dials of the voxels that are looked at.

use crate::exemplar::COARSEST_LEVEL;
use crate::plan::dial::{Dial, Invalidates, Measure, always, number, switch, switched};

pub(super) static LEVEL: Dial = Dial {
    name: "level",
    title: "Size of voxels",
    about: "coarseness of the voxels, each step twice as large",
    values: "4 to 0",
    ladder: &["4", "3", "2", "1", "0"],
    invalidates: Invalidates::Exemplars,
    measure: Measure::Bias,
    effect: None,
    of_voxels: false,
    elsewhere: None,
    idle: always,
    get: |settings| settings.cloth.level.to_string(),
    set: |settings, text| {
        settings.cloth.level = number(text, 0..=COARSEST_LEVEL)?;
        Some(())
    },
};

pub(super) static LEVEL_CORRECTION: Dial = Dial {
    name: "level-correction",
    title: "Light of coarse voxels",
    about: "coarse voxels are corrected for what averaging does to light",
    values: "off or on",
    ladder: &["off", "on"],
    invalidates: Invalidates::Seams,
    measure: Measure::Bias,
    effect: None,
    of_voxels: false,
    elsewhere: None,
    idle: |settings, _| {
        let why = "level 0 needs none: add --set level=1 to 4, or leave it out";
        (settings.cloth.level == 0).then_some(why)
    },
    get: |settings| switched(settings.cloth.correct_levels),
    set: |settings, text| {
        settings.cloth.correct_levels = switch(text)?;
        Some(())
    },
};
