//! `pickglass synthesize`: assignment and edge fixing, measured, with no picture.

use pickglass::synthesis::{Method, Rank, SynthesisSettings};
use serde_json::json;

use super::{note_warnings, seconds_json};
use crate::cli::{MethodArg, SynthesizeArgs};
use crate::opened::Opened;
use crate::out::{self, Progress};
use crate::stub::synthesis;

pub fn run(args: &SynthesizeArgs) -> anyhow::Result<()> {
    let opened = Opened::argument(&args.design, &args.sett)?;
    note_warnings(&opened.warnings);
    let settings = SynthesisSettings {
        method: match args.method {
            MethodArg::Naive => Method::Naive,
            MethodArg::Greedy => Method::Greedy,
            MethodArg::Dp => Method::Dp,
        },
        rank: match args.rank {
            0 => Rank::Off,
            rank => Rank::Truncated(rank),
        },
        seed: args.seed,
        ..SynthesisSettings::default()
    };
    let progress = Progress::new();
    let report = synthesis::measure(
        &opened.design,
        &synthesis::Request { settings },
        &progress.job(),
    )?;
    progress.finish();
    if args.json {
        return out::say_json(&json!({
            "crossings": report.crossings,
            "seconds": seconds_json(&report.seconds, report.total_seconds),
            "bytes": report.bytes,
            "consistency": { "sum": report.consistency_sum, "max": report.consistency_max },
            "continuity": {
                "before": report.continuity_before,
                "after": report.continuity_after,
                "max": report.continuity_max,
            },
            "seam_rms": { "before": report.seam_rms_before, "after": report.seam_rms_after },
        }));
    }
    out::say(&format!(
        "{}: {} crossings in {:.3} s, {} bytes\n  \
         consistency {} of {}\n  continuity {} of {}, {} after shifting\n  \
         seam rms {:.4} mm, {:.4} mm after edge fixing",
        opened.name(),
        report.crossings,
        report.total_seconds,
        report.bytes,
        report.consistency_sum,
        report.consistency_max,
        report.continuity_before,
        report.continuity_max,
        report.continuity_after,
        report.seam_rms_before,
        report.seam_rms_after,
    ))
}
