//! `pickglass still`: a picture of the cloth.

use std::path::Path;

use serde_json::{Value, json};

use super::{check_output, note_warnings, seconds_json};
use crate::cli::{RendererArg, StillArgs};
use crate::opened::Opened;
use crate::out::{self, Progress};
use pickglass::exemplar::ExemplarStore;
use pickglass::formats::volume::VolumeFormat;
use pickglass::still::{self, Pass, StillReport, StillRequest, Stop};

/// Paths per pixel when no way to stop is given.
const USUAL_SPP: u32 = 64;

/// The name that asks for a sheet of every colourway.
const ALL_COLOURWAYS: &str = "all";

pub fn run(args: &StillArgs) -> anyhow::Result<()> {
    refuse_absent_renderers(args.renderer)?;
    let path = &args.output.0;
    check_output(path)?;
    let argument = Path::new(&args.design);
    if VolumeFormat::of(argument).is_some() {
        let report = render_volume(argument, &request(args), path)?;
        if args.json {
            return out::say_json(&report_json(&report));
        }
        return out::say(&describe(&report, path));
    }
    let opened = Opened::argument(&args.design, &args.sett, &args.image)?;
    note_warnings(&opened.warnings);
    if args.colourway.as_deref() == Some(ALL_COLOURWAYS) {
        return sheet(args, &opened, path);
    }
    let report = render_to(&opened, &request(args), path)?;
    if args.json {
        return out::say_json(&report_json(&report));
    }
    out::say(&describe(&report, path))
}

/// Renders all colourways of a design into one file.
fn sheet(args: &StillArgs, opened: &Opened, path: &Path) -> anyhow::Result<()> {
    still::png_ending(path)?;
    let progress = Progress::new();
    let mut show = |index: usize, count: usize, pass: &Pass<'_>| {
        let picture = index + 1;
        progress.show(&format!(
            "colourway {picture} of {count} · {} spp",
            pass.spp
        ));
    };
    let (request, store) = (request(args), ExemplarStore::user());
    let sheet = still::render_sheet(&opened.design, &request, &store, &progress.job(), &mut show);
    progress.finish();
    let sheet = sheet?;
    sheet.save(path)?;
    note_warnings(&sheet.report.warnings);
    if args.json {
        let mut report = report_json(&sheet.report);
        let places = sheet.places.iter().map(|place| {
            json!({
                "name": place.name,
                "x": place.x,
                "y": place.y,
                "width": sheet.each.0,
                "height": sheet.each.1,
                "recoloured": place.recoloured,
            })
        });
        report["colourways"] = places.collect();
        return out::say_json(&report);
    }
    let line = describe(&sheet.report, path);
    out::say(&format!("{line}\n  {}", sheet.labels()))
}

/// Renders a picture into a file, with progress on standard error.
pub fn render_to(
    opened: &Opened,
    request: &StillRequest,
    path: &Path,
) -> anyhow::Result<StillReport> {
    let progress = Progress::new();
    let still = still::render_still(&opened.design, request, &progress.job(), &mut |pass| {
        show_pass(&progress, pass);
    });
    progress.finish();
    let still = still?;
    still.save(path)?;
    note_warnings(&still.report.warnings);
    Ok(still.report)
}

/// Renders a volume's file into a picture's.
fn render_volume(
    volume: &Path,
    request: &StillRequest,
    path: &Path,
) -> anyhow::Result<StillReport> {
    let progress = Progress::new();
    let still = still::render_grid(volume, request, &progress.job(), &mut |pass| {
        show_pass(&progress, pass);
    });
    progress.finish();
    let (still, warnings) = still?;
    note_warnings(&warnings);
    still.save(path)?;
    note_warnings(&still.report.warnings);
    Ok(still.report)
}

fn show_pass(progress: &Progress, pass: &still::Pass) {
    let error = pass.error.map_or_else(String::new, |error| {
        format!(" · error {:.1} %", error * 100.0)
    });
    progress.show(&format!("{} spp · {:.1} s{error}", pass.spp, pass.seconds));
}

/// The picture's line for a person.
pub fn describe(report: &StillReport, path: &Path) -> String {
    let error = report.error.map_or_else(String::new, |error| {
        format!(", error {:.2} %", error * 100.0)
    });
    let level = match (report.level, report.light_error) {
        (0, _) => String::new(),
        (level, Some(error)) => format!(", level {level}: light ±{:.1} %", 100.0 * error),
        (level, None) => format!(", level {level}: light not measured"),
    };
    let wrong = match report.invalid_samples + report.majorant_violations {
        0 => String::new(),
        _ => format!(
            "\n  {} invalid samples, {} majorant violations",
            report.invalid_samples, report.majorant_violations
        ),
    };
    format!(
        "wrote {} ({} x {}, {} spp{error}{level}, {:.1} s, {:.2} M paths/s){wrong}",
        path.display(),
        report.width,
        report.height,
        report.spp,
        report.total_seconds,
        report.paths_per_second / 1e6,
    )
}

/// The picture's report with the keys that scripts rely on.
pub fn report_json(report: &StillReport) -> Value {
    let effects: Vec<Value> = report
        .effects
        .iter()
        .map(|(name, on)| json!({ "name": name, "on": on }))
        .collect();
    let light_error = (report.light_error).map(|error| (1e4 * f64::from(error)).round() / 1e4);
    json!({
        "renderer": report.renderer,
        "width": report.width,
        "height": report.height,
        "spp": report.spp,
        "seconds": seconds_json(&report.seconds, report.total_seconds),
        "paths_per_second": report.paths_per_second,
        "error": report.error,
        "invalid_samples": report.invalid_samples,
        "majorant_violations": report.majorant_violations,
        "effects": effects,
        "level": report.level,
        "light_error": light_error,
        "warnings": report.warnings,
    })
}

fn refuse_absent_renderers(renderer: RendererArg) -> anyhow::Result<()> {
    let name = match renderer {
        RendererArg::Auto | RendererArg::Cpu => return Ok(()),
        RendererArg::Gpu => "gpu",
        RendererArg::Lumislice => "lumislice",
    };
    anyhow::bail!("--renderer {name}: this build has no such renderer: use auto or cpu")
}

fn request(args: &StillArgs) -> StillRequest {
    let mut stop = Stop {
        spp: args.spp,
        seconds: args.seconds,
        error: args.error,
    };
    if stop == Stop::default() {
        stop.spp = Some(USUAL_SPP);
    }
    StillRequest {
        width: args.size.width,
        height: args.size.height,
        eye: None,
        turned: false,
        view: args.view,
        width_mm: args.mm.map(|mm| mm as f32),
        centre_mm: None,
        light: args.light.clone(),
        exposure_ev: args.exposure as f32,
        backing: args.backing,
        effects: args.effects.clone(),
        dials: args
            .dials
            .iter()
            .map(|dial| (dial.name.clone(), dial.value.clone()))
            .collect(),
        seed: args.seed,
        stop,
        colourway: args.colourway.clone(),
    }
}
