//! Dials of the path tracer.

use crate::limits;
use crate::plan::dial::{Dial, Invalidates, Measure, always, number};
use crate::plan::effect::Effect;
use crate::render::Backing;

pub(super) static ORDER: Dial = Dial {
    name: "order",
    title: "Scatterings followed",
    about: "scatterings after which a path ends",
    values: "1 to 4096",
    ladder: &["1", "2", "4", "8", "16", "64", "256", "1024"],
    invalidates: Invalidates::Picture,
    measure: Measure::Bias,
    effect: Some(Effect::Multiple),
    of_voxels: true,
    elsewhere: None,
    idle: always,
    get: |settings| settings.render.max_order.to_string(),
    set: |settings, text| {
        settings.render.max_order = number(text, 1..=4096)?;
        Some(())
    },
};

pub(super) static ROULETTE_ORDER: Dial = Dial {
    name: "roulette-order",
    title: "Ending of faint paths",
    about: "scatterings after which paths play roulette",
    values: "1 to 4096, or never",
    ladder: &["1", "2", "4", "8", "16", "never"],
    invalidates: Invalidates::Picture,
    measure: Measure::Noise,
    effect: Some(Effect::Multiple),
    of_voxels: true,
    elsewhere: None,
    idle: always,
    get: |settings| match settings.render.roulette_order {
        u32::MAX => "never".to_owned(),
        order => order.to_string(),
    },
    set: |settings, text| {
        settings.render.roulette_order = match text {
            "never" => u32::MAX,
            _ => number(text, 1..=4096)?,
        };
        Some(())
    },
};

pub(super) static SHADOW_ROULETTE: Dial = Dial {
    name: "shadow-roulette",
    title: "Ending of faint shadow rays",
    about: "radiance below which shadow rays play roulette",
    values: "1 to 0",
    ladder: &["1", "0.3", "0.1", "0.03", "0"],
    invalidates: Invalidates::Picture,
    measure: Measure::Noise,
    effect: Some(Effect::Shadows),
    of_voxels: true,
    elsewhere: None,
    idle: always,
    get: |settings| settings.render.shadow_roulette.to_string(),
    set: |settings, text| {
        let share = text.parse().ok()?;
        let taken = (0.0..=1.0).contains(&share);
        taken.then(|| settings.render.shadow_roulette = share)
    },
};

pub(super) static SPP: Dial = Dial {
    name: "spp",
    title: "Paths a pixel",
    about: "paths a pixel, where nothing else ends the picture",
    values: "1 to 1000000",
    ladder: &["1", "4", "16", "64", "256", "1024", "4096"],
    invalidates: Invalidates::Picture,
    measure: Measure::Noise,
    effect: None,
    of_voxels: true,
    elsewhere: Some("what is refined until says how many paths there are"),
    idle: always,
    get: |settings| settings.render.spp.to_string(),
    set: |settings, text| {
        settings.render.spp = number(text, limits::STILL_SPP)?;
        Some(())
    },
};

pub(super) static PASS_SPP: Dial = Dial {
    name: "pass-spp",
    title: "Paths between two looks",
    about: "paths a pixel between two looks at the picture",
    values: "1 to 1024",
    ladder: &["1", "4", "16"],
    invalidates: Invalidates::Picture,
    measure: Measure::Noise,
    effect: None,
    of_voxels: true,
    elsewhere: Some("the window shows a picture as soon as it is better"),
    idle: always,
    get: |settings| settings.render.pass_spp.to_string(),
    set: |settings, text| {
        settings.render.pass_spp = number(text, 1..=1024)?;
        Some(())
    },
};

pub(super) static BACKING_LAYERS: Dial = Dial {
    name: "backing-layers",
    title: "Layers of cloth beneath",
    about: "layers of the cloth where it lies on itself",
    values: "1 to 16",
    ladder: &["1", "2", "4", "8", "16"],
    invalidates: Invalidates::Picture,
    measure: Measure::Bias,
    effect: None,
    of_voxels: false,
    elsewhere: None,
    idle: |_, backing| {
        let why = "only cloth that lies on itself has layers: add --backing self, or leave it out";
        (backing != Backing::Itself).then_some(why)
    },
    get: |settings| settings.render.backing_layers.to_string(),
    set: |settings, text| {
        settings.render.backing_layers = number(text, 1..=16)?;
        Some(())
    },
};
