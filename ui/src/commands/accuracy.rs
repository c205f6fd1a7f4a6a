//! `pickglass accuracy`: what each setting of each dial costs, measured.

use std::path::Path;

use anyhow::Context;
use pickglass::accuracy::{self, Accuracy, AccuracyError, Asked, Curve, Measuring};
use pickglass::engine;
use pickglass::exemplar::ExemplarStore;
use pickglass::formats::output;
use pickglass::plan::{Measure, Subject};
use pickglass::render::Backing;

use super::{note_warnings, still};
use crate::cli::AccuracyArgs;
use crate::idle;
use crate::interrupt::Interrupt;
use crate::opened::Opened;
use crate::out::{self, Progress};

/// Measures, and writes what was measured after every dial.
pub fn run(args: &AccuracyArgs) -> anyhow::Result<()> {
    idle::in_reading(&args.design, &args.image)?;
    let opened = Opened::argument(&args.design, &args.sett, &args.image)?;
    note_warnings(&opened.warnings);
    let renderer = engine::renderer(&args.picture.renderer)?;
    let mut request = still::picture(&args.picture, Backing::Itself)?;
    request.colourway.clone_from(&args.colourway);
    let stop = args.picture.spp.map(|_| "--spp");
    idle::in_picture(&args.picture, stop, &request, renderer, Subject::Cloth)?;
    let folder = &args.output;
    std::fs::create_dir_all(folder).with_context(|| {
        format!(
            "{}: the folder cannot be made: choose another",
            out::shown(folder)
        )
    })?;
    output::check(&folder.join("accuracy.json"), [])?;

    let before = accuracy::read(folder);
    let measuring = Measuring {
        asked: Asked { request, renderer },
        effort: args.extent,
        axes: args.dials.clone(),
        before: before.clone(),
    };
    measuring.check()?;
    // Half an hour of measuring is not written over by the way.
    if let Some(before) = &before
        && before.key != measuring.key(&opened.design)
    {
        anyhow::bail!(
            "{}: what was measured there is of {}, another picture, machine or extent: choose \
             another folder, or remove it",
            out::shown(&folder.join("accuracy.json")),
            before.design
        );
    }
    let progress = Progress::new();
    let job = progress.job();
    let interrupt = Interrupt::watch(&job);
    let store = ExemplarStore::user();
    let mut known = before.as_ref().map_or(0, |before| before.dials.len());
    let mut write = |measured: &Accuracy, crops: &_| {
        known = measured.dials.len();
        accuracy::write(folder, measured, crops)
    };
    let measured = accuracy::measure(&opened.design, &measuring, &store, &job, &mut write);
    progress.finish();
    let measured = match measured {
        Err(AccuracyError::Cancelled(_)) if interrupt.happened() => anyhow::bail!(
            "interrupted: {} dials are measured so far: the same command goes on from them",
            known
        ),
        measured => measured?,
    };
    match args.json {
        true => out::say_json(&serde_json::to_value(&measured)?),
        false => out::say(&lines(&measured, folder)),
    }
}

/// What was measured, a line a dial.
fn lines(measured: &Accuracy, folder: &Path) -> Vec<String> {
    let first = format!(
        "wrote {} ({} dials)",
        out::shown(&folder.join("accuracy.md")),
        measured.dials.len()
    );
    let dials = measured.dials.iter().map(line);
    std::iter::once(first).chain(dials).collect()
}

fn line(curve: &Curve) -> String {
    let said = |name: &str, value: &str| {
        curve.point(value).map_or_else(String::new, |point| {
            let error = match curve.measure {
                Measure::Seams => format!("{:.4} {}", point.error, curve.unit),
                _ => format!("{:.2} %", 100.0 * point.error),
            };
            format!(", {name} {value}: {:.2} s, {error}", point.seconds)
        })
    };
    let knee = curve.knee.as_deref().filter(|knee| *knee != curve.current);
    format!(
        "  {}: {}{}{}",
        curve.name,
        curve.measure.about(),
        said("now", &curve.current),
        knee.map_or_else(String::new, |knee| said("knee", knee)),
    )
}
