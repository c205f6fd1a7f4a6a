//! `pickglass check`: floats, ties, take-up, heddles and yarn, as a mill checks a design.

use pickglass::design::checks::{FloatLengthsMm, MillReport, TakeUp, check};
use pickglass::design::{Density, FloatKind};
use serde_json::{Map, Value, json};

use crate::cli::CheckArgs;
use crate::idle;
use crate::opened::Opened;
use crate::out;

/// A float longer than this snags, mm.
const SNAG_MM: f32 = 5.0;

/// Shafts that are written out one by one in text.
const SHOWN_SHAFTS: usize = 24;

pub fn run(args: &CheckArgs) -> anyhow::Result<()> {
    idle::in_reading(&args.design, &args.image)?;
    let opened = Opened::argument(&args.design, &args.sett, &args.image)?;
    let report = check(&opened.design);
    let mut warnings = opened.warnings.clone();
    warnings.extend(remarks(&opened, &report));
    if args.json {
        out::say_json(&report_json(&opened, &report, &warnings))
    } else {
        out::say(&describe(&opened, &report, &warnings))
    }
}

/// What a weaver should look at.
fn remarks(opened: &Opened, report: &MillReport) -> Vec<String> {
    let told = |obstacle: &&String| !opened.warnings.contains(obstacle);
    let mut remarks: Vec<String> = report.obstacles.iter().filter(told).cloned().collect();
    for (kind, length) in report.longest.kinds() {
        if length.mm > SNAG_MM {
            remarks.push(format!(
                "the longest {} float, {} crossings, is {:.1} mm: it may snag",
                kind_name(kind).replace('_', " "),
                length.threads,
                length.mm
            ));
        }
    }
    // Threads that nothing binds come away too, and were named above.
    let bound = report.unbound_ends.is_empty() && report.unbound_picks.is_empty();
    if let (Some(layer), true) = (report.loose, bound) {
        remarks.push(format!(
            "{} ends and {} picks of the repeat lift off as a layer of their own: stitch the \
             layers where the cloth should be one",
            layer.ends, layer.picks
        ));
    }
    if !opened.design.weavable() {
        remarks.push("this design is for previews only".to_owned());
    }
    if opened.design.sett().assumed {
        remarks.push("the sett is the yarns' usual one: give the real one with --sett".to_owned());
    }
    remarks
}

fn kind_name(kind: FloatKind) -> &'static str {
    match kind {
        FloatKind::WarpFace => "warp_face",
        FloatKind::WarpBack => "warp_back",
        FloatKind::WeftFace => "weft_face",
        FloatKind::WeftBack => "weft_back",
    }
}

fn report_json(opened: &Opened, report: &MillReport, warnings: &[String]) -> Value {
    let design = &opened.design;
    let size = opened.size_mm();
    let lengths = |of: &FloatLengthsMm, mm: bool| -> Map<String, Value> {
        let value = |(kind, length): (FloatKind, pickglass::design::checks::FloatLength)| {
            let value = if mm {
                json!(length.mm)
            } else {
                json!(length.threads)
            };
            (kind_name(kind).to_owned(), value)
        };
        of.kinds().into_iter().map(value).collect()
    };
    let seams = report.seams.iter().map(|seam| {
        json!({
            "kind": kind_name(seam.kind),
            "thread": seam.thread + 1,
            "length": seam.length.threads,
            "mm": seam.length.mm,
        })
    });
    // As in the window, on paper and in files.
    let from_1 = |threads: &[u32]| threads.iter().map(|at| at + 1).collect::<Vec<u32>>();
    let take_up = |of: &TakeUp| json!({ "mean": of.mean, "jammed": of.jammed });
    let yarns = report.yarns.iter().zip(design.yarns()).map(|(need, yarn)| {
        json!({
            "name": yarn.name,
            "tex": yarn.linear_density(),
            "warp_metres": need.warp_metres,
            "weft_metres": need.weft_metres,
            "metres": need.metres,
            "grams": need.grams,
        })
    });
    json!({
        "name": opened.name(),
        "ends": design.ends(),
        "picks": design.picks(),
        "shafts": report.heddles.len(),
        "heddles": report.heddles,
        "lifts": report.lifts,
        "longest_float": lengths(&report.longest, false),
        "longest_float_mm": lengths(&report.longest, true),
        "longest_float_inside": lengths(&report.inside, false),
        "seam_floats": seams.collect::<Vec<_>>(),
        "unbound_ends": from_1(&report.unbound_ends),
        "unbound_picks": from_1(&report.unbound_picks),
        "loose_layer": report.loose.map(|layer| json!({ "ends": layer.ends, "picks": layer.picks })),
        "take_up": {
            "warp": take_up(&report.warp),
            "weft": take_up(&report.weft),
            "balance": report.balance(),
        },
        "weavable": report.weavable(),
        "obstacles": report.obstacles,
        "yarns": design.yarns().len(),
        "yarn_per_metre": yarns.collect::<Vec<_>>(),
        "yarn_width_mm": report.width_mm,
        "grams_per_m2": report.grams_per_m2,
        "repeat_cm": report.weave_repeat_mm.map(|mm| mm / 10.0),
        "cloth_repeat_cm": report.cloth_repeat_mm.map(|mm| mm / 10.0),
        "colourways": design.colourways().iter().map(|known| &known.name).collect::<Vec<_>>(),
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

fn describe(opened: &Opened, report: &MillReport, warnings: &[String]) -> Vec<String> {
    let design = &opened.design;
    let [width, height] = report.weave_repeat_mm.map(|mm| mm / 10.0);
    let [cloth_width, cloth_height] = report.cloth_repeat_mm.map(|mm| mm / 10.0);
    let longest = report.longest;
    let float =
        |of: pickglass::design::checks::FloatLength| format!("{} ({:.1} mm)", of.threads, of.mm);
    let mut lines = vec![
        opened.name().to_owned(),
        format!(
            "{} ends × {} picks, {} shafts, {} different lifts, {} yarns",
            design.ends(),
            design.picks(),
            report.heddles.len(),
            report.lifts,
            design.yarns().len(),
        ),
        format!(
            "{:.1} ends/cm × {:.1} picks/cm: the weave repeats after {width:.2} × {height:.2} cm, \
             the cloth after {cloth_width:.2} × {cloth_height:.2} cm",
            per_cm(&design.sett().ends),
            per_cm(&design.sett().picks),
        ),
        format!(
            "longest floats: warp {} on the face, {} on the back; weft {} on the face, {} on \
             the back",
            float(longest.warp_face),
            float(longest.warp_back),
            float(longest.weft_face),
            float(longest.weft_back),
        ),
    ];
    if !report.seams.is_empty() {
        lines.push(format!(
            "{} floats are this long only across the seam of the repeat",
            report.seams.len()
        ));
    }
    lines.push(format!(
        "take-up: warp {:.1} %, weft {:.1} %{}",
        report.warp.mean * 100.0,
        report.weft.mean * 100.0,
        jam(report)
    ));
    lines.push(heddle_line(&report.heddles));
    lines.push(format!(
        "a metre of cloth {:.1} mm wide takes ({:.0} g/m²):",
        report.width_mm, report.grams_per_m2
    ));
    for (need, yarn) in report.yarns.iter().zip(design.yarns()) {
        lines.push(format!(
            "  {}: {:.2} m warp, {:.2} m weft, {:.3} g",
            yarn.name, need.warp_metres, need.weft_metres, need.grams
        ));
    }
    lines.push(match report.weavable() {
        true => "a loom can weave it".to_owned(),
        false => format!("no loom weaves it: {}", report.obstacles.join("; ")),
    });
    lines.extend(warnings.iter().map(|warning| format!("warning: {warning}")));
    for line in &mut lines[1..] {
        line.insert_str(0, "  ");
    }
    lines
}

/// A remark where threads are closer than round ones can lie.
fn jam(report: &MillReport) -> String {
    match (report.warp.jammed, report.weft.jammed) {
        (0, 0) => String::new(),
        (warp, weft) => format!(
            " (closer than round threads lie for {warp} ends and {weft} picks: they flatten)"
        ),
    }
}

fn heddle_line(heddles: &[u32]) -> String {
    let shown: Vec<String> = heddles
        .iter()
        .take(SHOWN_SHAFTS)
        .map(u32::to_string)
        .collect();
    let more = match heddles.len().saturating_sub(SHOWN_SHAFTS) {
        0 => String::new(),
        more => format!(" … and {more} shafts more"),
    };
    format!("heddles on each shaft: {}{more}", shown.join(" "))
}
