//! `pickglass synthesize`: assignment and edge fixing, measured, with no picture.

use std::sync::Arc;
use std::time::Instant;

use pickglass::cloth::{ClothSettings, ClothVolume, YarnClasses};
use pickglass::exemplar::{ExemplarSet, ExemplarStore};
use pickglass::job::Job;
use pickglass::synthesis::{
    Catalogue, EdgeFix, Placement, Quality, Randomisation, Rank, SeamRms, SynthesisSettings,
};
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
    let design = &opened.design;
    let cloth = ClothSettings {
        synthesis,
        ..ClothSettings::default()
    };
    let catalogue = Catalogue::standard();
    let begun = Instant::now();
    let (assignment, needed) = ClothVolume::assign(design, &catalogue, &cloth, job)?;
    let assigning = begun.elapsed().as_secs_f64();

    let begun = Instant::now();
    let classes = YarnClasses::new(design);
    let grid = ClothVolume::grid_for(&catalogue, &classes, &cloth)?;
    let store = ExemplarStore::user();
    let sets = (classes.pairs.iter())
        .map(|pair| store.get(&catalogue, pair, grid, &needed, job))
        .collect::<Result<Vec<Arc<ExemplarSet>>, _>>()?;
    let heights: Vec<_> = sets.iter().map(|set| set.heights.clone()).collect();
    let exemplar_seconds = begun.elapsed().as_secs_f64();

    let begun = Instant::now();
    let edge_fix = EdgeFix::new(&heights, &catalogue, synthesis.rank, job)?;
    let fixing = begun.elapsed().as_secs_f64();

    let randomisation = Randomisation {
        seed: synthesis.seed,
        patch: synthesis.patch,
    };
    let quality = Quality::measure(
        &opened.design.weave(),
        &assignment,
        &catalogue,
        randomisation,
        job,
    )?;
    let placement = Placement {
        catalogue: &catalogue,
        assignment: &assignment,
        randomisation,
    };
    let set_at = |end, pick| classes.set(design.warp_yarn(end, pick), design.weft_yarn(end, pick));
    let seams = placement.seam_rms(&edge_fix, &heights, set_at, job)?;
    Ok(Report {
        exemplar_seconds,
        stages: [
            ("assignment".to_owned(), assigning),
            ("edge_fixing".to_owned(), fixing),
        ],
        bytes: assignment.bytes() + edge_fix.bytes(),
        quality,
        seams,
        voxel_mm: f64::from(grid.voxel_mm.z),
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
        ]
    }
}
