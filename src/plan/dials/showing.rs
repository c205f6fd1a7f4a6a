//! Dials of showing and writing a traced picture.

use crate::formats::png::Depth;
use crate::plan::dial::{Dial, Invalidates, Measure, always, switch, switched};

pub(super) static DENOISE: Dial = Dial {
    name: "denoise",
    title: "Noise filter",
    about: "noise is filtered out of what is shown",
    values: "off or on",
    ladder: &["off", "on"],
    invalidates: Invalidates::Showing,
    measure: Measure::Shown,
    effect: None,
    of_voxels: true,
    elsewhere: None,
    idle: always,
    get: |settings| switched(settings.showing.denoise),
    set: |settings, text| {
        settings.showing.denoise = switch(text)?;
        Some(())
    },
};

pub(super) static PNG_BITS: Dial = Dial {
    name: "png-bits",
    title: "Bits of a PNG",
    about: "bits of a sample of a PNG",
    values: "8 or 16",
    ladder: &["8", "16"],
    invalidates: Invalidates::Showing,
    measure: Measure::Rounding,
    effect: None,
    of_voxels: true,
    elsewhere: Some("it is a matter of the file: still --set png-bits=16"),
    idle: always,
    get: |settings| match settings.showing.png_depth {
        Depth::Eight => "8".to_owned(),
        Depth::Sixteen => "16".to_owned(),
    },
    set: |settings, text| {
        settings.showing.png_depth = match text {
            "8" => Depth::Eight,
            "16" => Depth::Sixteen,
            _ => return None,
        };
        Some(())
    },
};
