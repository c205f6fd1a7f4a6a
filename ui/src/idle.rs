//! Options that have nothing to say where they were given: refused by name, so that nobody
//! believes that they were followed.

use std::path::Path;

use anyhow::bail;
use pickglass::engine::{Renderer, StillRequest};
use pickglass::formats::image::Encoding;
use pickglass::formats::{self, Kind, jc5};
use pickglass::plan::{Budget, Effect, EffectBase, Subject};
use pickglass::presets;
use pickglass::render::Backing;

use crate::cli::{ConvertArgs, ImageArgs, PictureArgs, StillArgs};
use crate::opened::head;

/// What of the image flags is given, by name.
fn given(image: &ImageArgs) -> Vec<&'static str> {
    let flags = [
        ("--as", image.what.is_some()),
        ("--convention", image.convention.is_some()),
        ("--black", image.black.is_some()),
        ("--origin", image.origin.is_some()),
        ("--mirror", image.mirror),
        ("--key", image.key.is_some()),
        ("--warp-map", image.warp_map.is_some()),
        ("--weft-map", image.weft_map.is_some()),
        ("--face-down", image.face_down),
    ];
    let given = flags.into_iter().filter(|(_, given)| *given);
    given.map(|(flag, _)| flag).collect()
}

/// Refuses flags of images and loom files where none is read.
///
/// # Errors
/// One line that names the first of them.
pub fn in_reading(argument: &str, image: &ImageArgs) -> anyhow::Result<()> {
    refuse(argument, image, &[], false)
}

/// As [`in_reading`]; what is written follows some of them as well.
///
/// # Errors
/// As [`in_reading`], also where what is written is no image.
pub fn in_converting(args: &ConvertArgs) -> anyhow::Result<()> {
    let ending = args.output.extension().unwrap_or_default();
    let ending = ending.to_string_lossy().to_ascii_lowercase();
    let format = formats::of_ending(&ending).filter(|format| format.is_written());
    let written = format.is_some_and(|format| format.kind == Kind::Image);
    let cards = format.is_some_and(|format| format.kind == Kind::Loom);
    if !cards && (args.loom.like.is_some() || args.loom.loom.is_some()) {
        bail!(
            "{}: --like and --loom are for loom files: end the name in .jc5",
            args.output.display()
        );
    }
    let out = [
        ("--write", args.write.is_some()),
        ("--out-black", args.out_black.is_some()),
        ("--out-origin", args.out_origin.is_some()),
    ];
    if let (false, Some((flag, _))) = (written, out.iter().find(|(_, given)| *given)) {
        bail!(
            "{flag}: {} is no image: leave it out, or end the name in .png",
            args.output.display()
        );
    }
    let followed: &[&str] = match written {
        true => &["--as", "--convention", "--black", "--origin"],
        false => &[],
    };
    refuse(&args.input, &args.image, followed, cards)
}

fn refuse(
    argument: &str,
    image: &ImageArgs,
    followed: &[&str],
    writes_loom: bool,
) -> anyhow::Result<()> {
    let given = given(image);
    if given.is_empty() {
        return Ok(());
    }
    let is_preset = presets::design(argument).is_some();
    let start = match is_preset {
        true => Vec::new(),
        false => head(Path::new(argument)),
    };
    if start.is_empty() && !is_preset {
        // What is wrong with the file is said where it is read.
        return Ok(());
    }
    let reads_image =
        Encoding::of(&start).is_some() || image.warp_map.is_some() || image.weft_map.is_some();
    let reads_loom = jc5::recognises(&start);
    for flag in given {
        let (idle, what) = match flag {
            "--warp-map" | "--weft-map" => (false, ""),
            "--face-down" => (!reads_loom && !writes_loom, "loom file (.jc5)"),
            _ => (!reads_image && !followed.contains(&flag), "image"),
        };
        if idle {
            bail!("{flag}: {argument} is no {what}: leave it out");
        }
    }
    Ok(())
}

/// Refuses what only cloth has, where a volume is looked at.
///
/// # Errors
/// One line that names the first of it.
pub fn of_volume(args: &StillArgs) -> anyhow::Result<()> {
    let mut idle: Vec<String> = given(&args.image).into_iter().map(str::to_owned).collect();
    if args.sett.sett.is_some() {
        bail!("--sett: a volume has voxels and no threads: --voxel scales it");
    }
    if args.colourway.is_some() {
        idle.push("--colourway".to_owned());
    }
    if args.tolerance.is_some() {
        idle.push("--tolerance".to_owned());
    }
    if args.budget.is_some() {
        idle.push("--budget".to_owned());
    }
    if args.picture.backing == Some(Backing::Itself) {
        idle.push("--backing self".to_owned());
    }
    let dials = args.picture.dials.iter().map(|turned| turned.dial);
    let idle_dials = dials.filter(|dial| !dial.applies_to(Subject::Voxels));
    idle.extend(idle_dials.map(|dial| format!("--set {}", dial.name)));
    let effects = args.picture.effects.changes.iter().filter(|(_, on)| *on);
    let idle_effects = effects.filter(|(effect, _)| !effect.applies_to(Subject::Voxels));
    idle.extend(idle_effects.map(|(effect, _)| format!("--effects +{effect}")));
    match idle.first() {
        Some(flag) => bail!(
            "{flag}: {} is a volume, no design: leave it out",
            args.design
        ),
        None => Ok(()),
    }
}

/// Refuses options of a still that others of it leave nothing to say, whatever it is of.
///
/// # Errors
/// One line that names the first of them and why.
pub fn in_still(
    args: &StillArgs,
    request: &StillRequest,
    renderer: &Renderer,
    subject: Subject,
) -> anyhow::Result<()> {
    let stops = [
        ("--spp", args.picture.spp.is_some()),
        ("--seconds", args.seconds.is_some()),
        ("--error", args.error.is_some()),
        ("--budget", args.budget.is_some()),
        // It ends nothing, and asks as much of what draws.
        ("--tolerance", args.tolerance.is_some() && !renderer.refines),
    ];
    let stop = stops.into_iter().find(|(_, given)| *given);
    let stop = stop.map(|(flag, _)| flag);
    if let (Some(budget @ Budget::DeltaE(_)), None) = (args.budget, &args.curves) {
        bail!(
            "--budget {budget}: a look at the picture says nothing of that: add --curves with a \
             folder of pickglass accuracy, or give 20s or 2%"
        );
    }
    in_picture(&args.picture, stop, request, renderer, subject)?;
    let path = &args.output.0;
    let is_exr = (path.extension()).is_some_and(|ending| ending.eq_ignore_ascii_case("exr"));
    let turned = |name: &str| turned(&args.picture, name);
    let showing = [
        ("--set png-bits", turned("png-bits")),
        (
            "--set denoise=on",
            turned("denoise") && request.settings.showing.denoise,
        ),
        ("--exposure", args.picture.exposure.abs() > 0.0),
    ];
    let idle = showing.into_iter().find(|(_, given)| is_exr && *given);
    if let Some((flag, _)) = idle {
        bail!("{flag}: an .exr holds light as it was traced: leave it out, or write a .png");
    }
    Ok(())
}

fn turned(args: &PictureArgs, name: &str) -> bool {
    args.dials.iter().any(|turned| turned.dial.name == name)
}

/// Refuses options of a picture that others of it leave nothing to say; `stop` is the one that
/// says when it ends.
///
/// # Errors
/// One line that names the first of them and why.
pub fn in_picture(
    args: &PictureArgs,
    stop: Option<&str>,
    request: &StillRequest,
    renderer: &Renderer,
    subject: Subject,
) -> anyhow::Result<()> {
    renderer.check(subject)?;
    let name = renderer.name;
    if let (false, Some(flag)) = (renderer.refines, stop) {
        bail!("{flag}: the renderer {name} has no paths and ends at once: leave it out");
    }
    let mut named = args.effects.changes.iter();
    if let Some((effect, on)) = named.find(|(effect, _)| !renderer.effects.contains(effect)) {
        let sign = if *on { '+' } else { '-' };
        bail!("--effects {sign}{effect}: the renderer {name} leaves no choice of it: leave it out");
    }
    let lacking = Effect::ALL
        .iter()
        .find(|effect| !renderer.effects.contains(effect));
    match (args.effects.base, lacking) {
        (EffectBase::All, Some(effect)) => bail!(
            "--effects all: the renderer {name} has none of the effect {effect}: leave it out"
        ),
        (EffectBase::None, Some(_)) if renderer.effects.is_empty() => {
            bail!("--effects none: the renderer {name} leaves no choice of any: leave it out")
        }
        _ => {}
    }
    let plan = renderer.plan(request, subject)?;
    let mut before: Vec<&str> = Vec::new();
    for turned in &args.dials {
        let name = turned.dial.name;
        if before.contains(&name) {
            bail!("--set {name}: it is set twice: leave one of them out");
        }
        before.push(name);
        if !(renderer.dials)(turned.dial) {
            bail!(
                "--set {name}: it changes nothing of the renderer {}: leave it out",
                renderer.name
            );
        }
        if let Some(why) = (turned.dial.idle)(&request.settings, request.backing) {
            bail!("--set {name}: {why}");
        }
        let off = |effect: &Effect| !plan.on(*effect);
        if let Some(effect) = turned.dial.effect.filter(off) {
            bail!("--set {name}: the effect {effect} is left out: leave one of the two out");
        }
    }
    let mut effects: Vec<Effect> = Vec::new();
    for (effect, _) in &args.effects.changes {
        if effects.contains(effect) {
            bail!("--effects: {effect} is switched twice: leave one of the two out");
        }
        effects.push(*effect);
    }
    if let (true, Some(flag)) = (before.contains(&"spp"), stop) {
        bail!("--set spp: {flag} says when the picture ends: leave one of the two out");
    }
    Ok(())
}
