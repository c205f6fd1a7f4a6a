//! `pickglass synthesize`: assignment and edge fixing, measured, with no picture.

use std::sync::Arc;

use pickglass::accuracy::Woven;
use pickglass::cloth::ClothSettings;
use pickglass::exemplar::ExemplarStore;
use pickglass::job::Job;
use pickglass::synthesis::{Quality, Rank, SeamRms, SynthesisSettings};
use serde_json::json;

use super::{note_warnings, seconds_json};
use crate::cli::SynthesizeArgs;
use crate::idle;
use crate::opened::Opened;
use crate::out::{self, Progress};

pub fn run(args: &SynthesizeArgs) -> anyhow::Result<()> {
    idle::in_reading(&args.design, &args.image)?;
    let opened = Opened::argument(&args.design, &args.sett, &args.image)?;
    note_warnings(&opened.warnings);
    let progress = Progress::new();
    let report = measure(&opened, settings(args), &progress.job());
    progress.finish();
    let report = report?;
    if args.json {
        out::say_json(&report.json())
    } else {
        out::say(&report.describe(opened.name()))
    }
}

fn settings(args: &SynthesizeArgs) -> SynthesisSettings {
    SynthesisSettings {
        method: args.method,
        seams: args.seams,
        rank: match args.rank {
            0 => Rank::Off,
            rank => Rank::Truncated(rank),
        },
        seed: args.seed,
        ..SynthesisSettings::default()
    }
}

/// What the synthesis took and what it achieved.
struct Report {
    exemplar_seconds: f64,
    stages: [(String, f64); 2],
    bytes: usize,
    quality: Quality,
    seams: SeamRms,
    /// Height of a voxel, mm.
    voxel_mm: f64,
}

/// Runs the stages one by one, each timed; the exemplars they need are timed apart.
fn measure(opened: &Opened, synthesis: SynthesisSettings, job: &Job) -> anyhow::Result<Report> {
    let cloth = ClothSettings {
        synthesis,
        ..ClothSettings::default()
    };
    let woven = Woven::new(
        Arc::clone(&opened.design),
        cloth,
        &ExemplarStore::user(),
        job,
    )?;
    let made = woven.synthesise(synthesis, job)?;
    Ok(Report {
        exemplar_seconds: woven.exemplar_seconds,
        stages: [
            ("assignment".to_owned(), made.assignment.seconds),
            ("edge_fixing".to_owned(), made.edge_fixing.seconds),
        ],
        bytes: made.bytes,
        quality: made.quality,
        seams: made.seams,
        voxel_mm: woven.voxel_mm,
    })
}

impl Report {
    fn total(&self) -> f64 {
        self.stages.iter().map(|stage| stage.1).sum()
    }

    fn json(&self) -> serde_json::Value {
        let continuity = self.quality.continuity;
        json!({
            "crossings": self.quality.crossings,
            "seconds": seconds_json(&self.stages, self.total()),
            "exemplar_seconds": self.exemplar_seconds,
            "bytes": self.bytes,
            "consistency": {
                "sum": self.quality.consistency,
                "max": self.quality.consistency_max,
            },
            "incorrect": self.quality.incorrect,
            "mismatched": self.quality.mismatched,
            "continuity": {
                "before": continuity.before,
                "after": continuity.after,
                "max": continuity.max,
            },
            "seam_rms": {
                "before": self.seams.before * self.voxel_mm,
                "after": self.seams.after * self.voxel_mm,
            },
            "kinks_degrees": {
                "before": self.seams.kinks[0],
                "after": self.seams.kinks[1],
            },
        })
    }

    fn describe(&self, name: &str) -> Vec<String> {
        let quality = &self.quality;
        let share = |part: u64, whole: u64| 100.0 * part as f64 / whole.max(1) as f64;
        let continuity = quality.continuity;
        vec![
            format!(
                "{name}: {} crossings in {:.3} s, {:.2} MB (exemplars {:.1} s)",
                quality.crossings,
                self.total(),
                self.bytes as f64 / 1e6,
                self.exemplar_seconds,
            ),
            format!(
                "  consistent {:.2} %, {} crossings with the wrong yarn on top, {} with a \
                 neighbour amiss",
                share(quality.consistency, quality.consistency_max),
                quality.incorrect,
                quality.mismatched,
            ),
            format!(
                "  continuous {:.2} %, {:.2} % after shifting",
                share(continuity.before, continuity.max),
                share(continuity.after, continuity.max),
            ),
            format!(
                "  seams {:.2} µm, {:.2} µm after edge fixing",
                self.seams.before * self.voxel_mm * 1e3,
                self.seams.after * self.voxel_mm * 1e3,
            ),
            format!(
                "  kinks of floats {:.1}°, {:.1}° after edge fixing",
                self.seams.kinks[0], self.seams.kinks[1],
            ),
        ]
    }
}
