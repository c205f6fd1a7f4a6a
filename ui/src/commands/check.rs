//! `pickglass check`: floats, warnings and scale.

use pickglass::design::{Density, FloatKind, FloatReport, Structure, floats};
use serde_json::{Value, json};

use crate::cli::CheckArgs;
use crate::opened::Opened;
use crate::out;

/// A float longer than this snags, mm.
const SNAG_MM: f32 = 5.0;

pub fn run(args: &CheckArgs) -> anyhow::Result<()> {
    let opened = Opened::argument(&args.design, &args.sett, &args.image)?;
    let report = floats(opened.weave());
    let mut warnings = opened.warnings.clone();
    warnings.extend(remarks(&opened, &report));
    if args.json {
        out::say_json(&report_json(&opened, &report, &warnings))
    } else {
        out::say(&describe(&opened, &report, &warnings))
    }
}

/// What a weaver should look at.
fn remarks(opened: &Opened, report: &FloatReport) -> Vec<String> {
    let mut remarks = Vec::new();
    for (threads, unbound) in [
        ("ends", &report.unbound_ends),
        ("picks", &report.unbound_picks),
    ] {
        if let Some(first) = unbound.first() {
            remarks.push(format!(
                "{} {threads} are never bound, the first is {}: bind each at least once a repeat",
                unbound.len(),
                first + 1
            ));
        }
    }
    let sett = opened.design.sett();
    let longest = report.longest;
    for (kind, length, across) in [
        (FloatKind::WarpFace, longest.warp_face, &sett.picks),
        (FloatKind::WarpBack, longest.warp_back, &sett.picks),
        (FloatKind::WeftFace, longest.weft_face, &sett.ends),
        (FloatKind::WeftBack, longest.weft_back, &sett.ends),
    ] {
        let mm = length as f32 * across.mean_pitch_mm();
        if mm > SNAG_MM {
            remarks.push(format!(
                "the longest {} float, {length} crossings, is {mm:.1} mm: it may snag",
                kind_name(kind)
            ));
        }
    }
    if !opened.design.weavable() {
        remarks.push(
            "a yarn changes along its length: this is for previews, no loom weaves it".to_owned(),
        );
    }
    if sett.assumed {
        remarks.push("the sett is the yarns' usual one: give the real one with --sett".to_owned());
    }
    remarks
}

/// Shafts of a draft; the different columns of any other weave.
fn shafts(opened: &Opened) -> usize {
    if let Structure::Draft(draft) = opened.design.structure() {
        return draft.shafts() as usize;
    }
    let weave = opened.weave();
    let mut columns = std::collections::BTreeSet::new();
    for end in 0..weave.ends() {
        let column: Vec<bool> = (0..weave.picks())
            .map(|pick| weave.get(end, pick))
            .collect();
        columns.insert(column);
    }
    columns.len()
}

fn kind_name(kind: FloatKind) -> &'static str {
    match kind {
        FloatKind::WarpFace => "warp face",
        FloatKind::WarpBack => "warp back",
        FloatKind::WeftFace => "weft face",
        FloatKind::WeftBack => "weft back",
    }
}

fn report_json(opened: &Opened, report: &FloatReport, warnings: &[String]) -> Value {
    let design = &opened.design;
    let size = opened.size_mm();
    let seams: Vec<Value> = report
        .seam
        .iter()
        .map(|float| {
            json!({
                "kind": kind_name(float.kind).replace(' ', "_"),
                "thread": float.thread,
                "length": float.length,
            })
        })
        .collect();
    json!({
        "name": opened.name(),
        "ends": design.ends(),
        "picks": design.picks(),
        "shafts": shafts(opened),
        "longest_float": {
            "warp_face": report.longest.warp_face,
            "warp_back": report.longest.warp_back,
            "weft_face": report.longest.weft_face,
            "weft_back": report.longest.weft_back,
        },
        "seam_floats": seams,
        "weavable": design.weavable(),
        "yarns": design.yarns().len(),
        "ends_per_cm": per_cm(&design.sett().ends),
        "picks_per_cm": per_cm(&design.sett().picks),
        "sett_assumed": design.sett().assumed,
        "width_mm": size[0],
        "height_mm": size[1],
        "warnings": warnings,
    })
}

fn per_cm(density: &Density) -> f32 {
    10.0 / density.mean_pitch_mm()
}

fn describe(opened: &Opened, report: &FloatReport, warnings: &[String]) -> String {
    let design = &opened.design;
    let [width, height] = opened.size_mm();
    let longest = report.longest;
    let mut text = format!(
        "{}\n  {} ends × {} picks, {} shafts, {} yarns\n  \
         {:.1} ends/cm × {:.1} picks/cm: the repeat is {width:.1} × {height:.1} mm\n  \
         longest floats: warp {} on the face, {} on the back; weft {} on the face, {} on the back",
        opened.name(),
        design.ends(),
        design.picks(),
        shafts(opened),
        design.yarns().len(),
        per_cm(&design.sett().ends),
        per_cm(&design.sett().picks),
        longest.warp_face,
        longest.warp_back,
        longest.weft_face,
        longest.weft_back,
    );
    if !report.seam.is_empty() {
        text += &format!(
            "\n  {} floats are this long only across the seam of the repeat",
            report.seam.len()
        );
    }
    for warning in warnings {
        text += &format!("\n  warning: {warning}");
    }
    text
}
