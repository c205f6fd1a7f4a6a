//! `pickglass volume`: a window of the cloth as voxels, or its yarns as geometry.

use std::path::{Path, PathBuf};
use std::time::Instant;

use pickglass::cloth::{self, Part, Region};
use pickglass::engine::{self, StillRequest};
use pickglass::exemplar::ExemplarStore;
use pickglass::formats::volume::{self, bytes_in_words};
use pickglass::formats::{output, yarns};
use pickglass::plan::{Settings, Subject};
use pickglass::volume::source::VoxelSource;
use serde_json::{Value, json};

use super::note_warnings;
use crate::cli::VolumeArgs;
use crate::idle;
use crate::interrupt::Interrupt;
use crate::opened::Opened;
use crate::out::{self, Progress};
use crate::volumes;

pub fn run(args: &VolumeArgs) -> anyhow::Result<()> {
    let path = &args.output.0;
    let inputs = inputs(args);
    output::check(path, inputs.iter().copied())?;
    idle::in_reading(&args.design, &args.image)?;
    let opened = Opened::argument(&args.design, &args.sett, &args.image)?;
    note_warnings(&opened.warnings);
    let region = region(args, &opened);
    if yarns::is_yarns(path) {
        return run_yarns(args, &opened, region);
    }
    let request = StillRequest {
        view: args.view,
        light: args.light.clone(),
        seed: args.seed,
        settings: Settings::default().at_level(args.level),
        ..StillRequest::default()
    };
    note_warnings(&engine::light_warnings(&request)?);
    let progress = Progress::new();
    let job = progress.job();
    Interrupt::watch(&job);
    let settings = request.plan(Subject::Cloth)?.cloth;
    let store = ExemplarStore::user();
    let prepared = cloth::prepare(&opened.design, &settings, &region.extent(), &store, &job);
    progress.finish();
    let prepared = prepared?;
    let part = if args.face { Part::Face } else { Part::Whole };
    let asked = (region, part, args.voxels_per_crossing);
    let (window, attached) = volumes::voxels(&prepared, asked, path, &request)?;
    let frame = window.frame();
    let plan = volume::plan(&window, path, &attached)?;
    for (file, _) in &plan.files {
        output::is_no_input(file, inputs.iter().copied())?;
    }
    out::note(&volumes::voxels_in_words(&plan, &frame));
    let begun = Instant::now();
    let written = volume::write(&window, path, &attached, &job);
    progress.finish();
    let written = written?;
    let seconds = begun.elapsed().as_secs_f64();
    if args.json {
        return out::say_json(&json!({
            "voxels": written.voxels,
            "bytes": written.bytes,
            "files": names(&written.files),
            "size": frame.size.to_array(),
            "voxel_mm": frame.edge_mm,
            "origin_mm": frame.origin_mm.to_array(),
            "planned": { "bytes": plan.bytes(), "exact": plan.exact, "seconds": plan.seconds },
            "seconds": seconds,
        }));
    }
    out::say(&wrote(&written.files, written.bytes, seconds))
}

/// The files that the command reads.
fn inputs(args: &VolumeArgs) -> Vec<&Path> {
    let mut inputs = Opened::inputs(&args.design, &args.image);
    inputs.extend(args.light.file());
    inputs
}

/// The rectangle asked for, or one repeat of the weave.
fn region(args: &VolumeArgs, opened: &Opened) -> Region {
    args.region.unwrap_or(Region {
        end: 0,
        pick: 0,
        ends: opened.design.ends(),
        picks: opened.design.picks(),
    })
}

fn wrote(files: &[PathBuf], bytes: u64, seconds: f64) -> String {
    let list: Vec<String> = files.iter().map(|file| out::shown(file)).collect();
    format!(
        "wrote {} ({}, {seconds:.1} s)",
        list.join(", "),
        bytes_in_words(bytes)
    )
}

fn names(files: &[PathBuf]) -> Vec<Value> {
    files
        .iter()
        .map(|file| Value::from(file.display().to_string()))
        .collect()
}

fn run_yarns(args: &VolumeArgs, opened: &Opened, region: Region) -> anyhow::Result<()> {
    let path = &args.output.0;
    let tubes = volumes::yarns(&opened.design, &region)?;
    for file in yarns::files(path) {
        output::is_no_input(&file, inputs(args))?;
    }
    out::note(&volumes::yarns_in_words(&tubes, path));
    let progress = Progress::new();
    let begun = Instant::now();
    let job = progress.job();
    Interrupt::watch(&job);
    let written = yarns::write(&opened.design, &tubes, path, &job);
    progress.finish();
    let written = written?;
    let seconds = begun.elapsed().as_secs_f64();
    let bytes: u64 = written.iter().map(|file| file.1).sum();
    let files: Vec<PathBuf> = written.into_iter().map(|file| file.0).collect();
    if args.json {
        return out::say_json(&json!({
            "voxels": 0,
            "yarns": tubes.len(),
            "bytes": bytes,
            "files": names(&files),
            "seconds": seconds,
        }));
    }
    out::say(&wrote(&files, bytes, seconds))
}
