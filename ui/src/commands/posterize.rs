//! `pickglass posterize`: a picture becomes regions of weaves.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use pickglass::atomic;
use pickglass::design::{Structure, Yarn, YarnId, YarnMap};
use pickglass::formats::{LoadOptions, load, output, photo, ron};
use pickglass::posterise::{PosteriseSettings, Posterised, posterise};
use serde_json::{Value, json};

use super::note_warnings;
use crate::cli::PosterizeArgs;
use crate::out::{self, Progress};

/// Inches are what picture and loom people count threads by.
const CM_PER_INCH: f64 = 2.54;

pub fn run(args: &PosterizeArgs) -> anyhow::Result<()> {
    let path = &args.output;
    let shown = path.display();
    if !path
        .extension()
        .is_some_and(|ending| ending.eq_ignore_ascii_case("ron"))
    {
        anyhow::bail!("{shown}: designs are written as .ron: end the name in .ron");
    }
    let inputs = [Some(&args.image), args.keep.as_ref()];
    output::check(path, inputs.into_iter().flatten().map(PathBuf::as_path))?;
    let begun = Instant::now();
    let progress = Progress::new();
    progress.show("reading");
    let photo = photo::load(&args.image)?;
    let previous = match &args.keep {
        Some(path) => Some(load(path, &LoadOptions::default())?.design),
        None => None,
    };
    let source = Arc::new(photo.source);
    let made = posterise(&source, &settings(args), previous.as_ref(), &progress.job());
    progress.finish();
    let made = made?;
    let seconds = begun.elapsed().as_secs_f64();
    let warnings: Vec<String> = photo
        .warnings
        .iter()
        .chain(&made.warnings)
        .cloned()
        .collect();
    note_warnings(&warnings);
    atomic::write(path, ron::write(&made.design)?.as_bytes())?;
    if args.json {
        return out::say_json(&report(&made, &warnings, path, seconds));
    }
    out::say(&describe(&made, path, seconds))
}

fn settings(args: &PosterizeArgs) -> PosteriseSettings {
    let name = (args.image.file_stem()).map_or_else(
        || "posterised".to_owned(),
        |stem| stem.to_string_lossy().into_owned(),
    );
    let usual = PosteriseSettings::default();
    PosteriseSettings {
        name,
        colours: args.colours,
        ends: args.ends,
        picks: args.picks,
        ends_per_cm: (args.epi / CM_PER_INCH) as f32,
        picks_per_cm: (args.ppi.unwrap_or(args.epi) / CM_PER_INCH) as f32,
        fit: args.fit,
        dither: args.dither,
        // Dithering is made of specks.
        speck: args
            .speck
            .unwrap_or(if args.dither { 0 } else { usual.speck }),
        preview_only: args.preview_only,
        bind: args.bind,
        family: args.family,
        yarns: args.warp.zip(args.weft).map(|(warp, weft)| [warp, weft]),
    }
}

/// The region's weave in words.
fn weaves(made: &Posterised) -> Vec<String> {
    let Structure::Regions(regions) = made.design.structure() else {
        return Vec::new();
    };
    (regions.palette().iter())
        .map(|region| match region.fill.notation() {
            Some(notation) => notation.to_owned(),
            None => {
                let pattern = region.fill.pattern();
                let all = u64::from(pattern.ends()) * u64::from(pattern.picks());
                format!("shadow {}/{all}", pattern.count_warp_up())
            }
        })
        .collect()
}

/// The yarn that most ends or picks are of.
fn first<'d>(made: &'d Posterised, map: &YarnMap, usual: YarnId) -> &'d Yarn {
    let id = map.order().and_then(|order| order.first().copied());
    made.design.yarn(id.unwrap_or(usual))
}

fn yarns(made: &Posterised) -> [String; 2] {
    let maps = made.design.maps();
    [
        first(made, &maps.warp, YarnId(0)),
        first(made, &maps.weft, YarnId(1)),
    ]
    .map(|yarn| yarn.colour.to_string())
}

fn report(made: &Posterised, warnings: &[String], path: &Path, seconds: f64) -> Value {
    let colours = &made.colours;
    let [warp, weft] = yarns(made);
    json!({
        "written": path.display().to_string(),
        "ends": made.design.ends(),
        "picks": made.design.picks(),
        "weavable": made.design.weavable(),
        "warp": warp,
        "weft": weft,
        "colours": colours.iter().map(|c| c.asked.to_string()).collect::<Vec<_>>(),
        "coverage": colours.iter().map(|c| c.coverage).collect::<Vec<_>>(),
        "weaves": weaves(made),
        "expected": colours.iter().map(|c| c.expected.to_string()).collect::<Vec<_>>(),
        "expected_delta_e": colours.iter().map(|c| c.delta_e).collect::<Vec<_>>(),
        "seconds": seconds,
        "warnings": warnings,
    })
}

fn describe(made: &Posterised, path: &Path, seconds: f64) -> String {
    let [warp, weft] = yarns(made);
    let kind = if made.design.weavable() {
        "weavable"
    } else {
        "preview only"
    };
    let mut text = format!(
        "wrote {}: {} ends × {} picks in {seconds:.2} s, {kind}, warp {warp}, weft {weft}",
        out::shown(path),
        made.design.ends(),
        made.design.picks(),
    );
    for (colour, weave) in made.colours.iter().zip(weaves(made)) {
        text += &format!(
            "\n  {} {:5.1} %  {weave:<18} shows {}, ΔE {:.1}",
            colour.asked,
            100.0 * colour.coverage,
            colour.expected,
            colour.delta_e
        );
    }
    text
}
