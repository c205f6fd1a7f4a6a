//! `pickglass still`: a picture of the cloth.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use serde_json::{Value, json};

use super::{effects, note_warnings, seconds_json};
use crate::cli::{PictureArgs, StillArgs, source_words};
use crate::idle;
use crate::interrupt::Interrupt;
use crate::late::Late;
use crate::opened::Opened;
use crate::out::{self, Progress};
use pickglass::accuracy::{self, Asked, Choice};
use pickglass::design::Design;
use pickglass::engine::{
    self, ALL_COLOURWAYS, Engine, Pass, Renderer, StillError, StillReport, StillRequest, Stop,
};
use pickglass::exemplar::ExemplarStore;
use pickglass::formats::output;
use pickglass::formats::volume::{self, VolumeFormat};
use pickglass::job::Job;
use pickglass::needs::{self, Needs, Promise};
use pickglass::plan::{Budget, Settings, Subject};
use pickglass::render::Backing;

/// Longer than anybody waits: no end at all.
const LONGEST_SECONDS: f64 = 1e9;

/// Makes the picture; the program began at `begun`.
pub fn run(args: &StillArgs, begun: Instant) -> anyhow::Result<()> {
    let renderer = engine::renderer(&args.picture.renderer)?;
    let path = &args.output.0;
    let volume = Path::new(&args.design);
    let is_volume = VolumeFormat::opened(volume).is_some();
    let parts = match is_volume {
        true => volume::files_read(volume),
        false => Vec::new(),
    };
    let mut inputs = Opened::inputs(&args.design, &args.image);
    inputs.extend(args.picture.light.file());
    inputs.extend(parts.iter().map(PathBuf::as_path));
    output::check(path, inputs)?;
    if is_volume {
        idle::of_volume(args)?;
        let request = request(args, Backing::None)?;
        idle::in_still(args, &request, renderer, Subject::Voxels)?;
        let work = Work::begin(&request.stop, begun);
        let volume = (volume, args.voxel);
        let made = engine::render_grid(volume, &request, renderer, &work.job, &mut |pass| {
            work.pass(pass);
        });
        let (still, warnings) = work.ended(made)?;
        note_warnings(&warnings);
        let still = still.made_from(source(args));
        still.save(path)?;
        return tell(&still.report, path, work.interrupt.happened(), args.json);
    }
    if args.voxel.is_some() {
        anyhow::bail!(
            "--voxel: only a volume has voxels of its own: give --sett to scale a design"
        );
    }
    idle::in_reading(&args.design, &args.image)?;
    let opened = Opened::argument(&args.design, &args.sett, &args.image)?;
    note_warnings(&opened.warnings);
    let request = request(args, Backing::Itself)?;
    idle::in_still(args, &request, renderer, Subject::Cloth)?;
    let (mut request, mut settling) = (request, Settling::of(args));
    let mut chosen = None;
    if let (Some(folder), Some(budget)) = (&args.curves, args.budget) {
        let (asked, choice) = by_curves(folder, budget, (request, renderer), &opened.design)?;
        (request, settling) = (asked, Settling::Nothing);
        out::note(&chose(&choice));
        chosen = Some(choice);
    }
    if args.colourway.as_deref() == Some(ALL_COLOURWAYS) {
        if let Some(flag) = settling.flag() {
            anyhow::bail!("{flag}: colourways side by side are made alike: leave it out");
        }
        return sheet(args, &opened, (&request, renderer), begun);
    }
    let picture = (&request, renderer);
    let mut made = render_to(&opened, picture, settling, path, begun, source(args))?;
    if let Some(choice) = chosen {
        made.settled = Settled::Choice(choice);
    }
    made.tell(path, args.json)
}

/// What is settled about a picture once its cloth is there.
#[derive(Debug, Clone, Copy)]
pub enum Settling {
    /// Nothing: it is made as it is asked for.
    Nothing,
    /// What it leaves out, by a tolerance.
    Tolerance(f64),
    /// How often light is scattered, and when it ends.
    Budget(Budget),
}

impl Settling {
    fn of(args: &StillArgs) -> Self {
        match (args.tolerance, args.budget) {
            (Some(tolerance), _) => Self::Tolerance(tolerance),
            (_, Some(budget)) => Self::Budget(budget),
            (None, None) => Self::Nothing,
        }
    }

    /// The option that asks for it.
    fn flag(self) -> Option<&'static str> {
        match self {
            Self::Nothing => None,
            Self::Tolerance(_) => Some("--tolerance"),
            Self::Budget(_) => Some("--budget"),
        }
    }
}

/// What was settled.
enum Settled {
    Nothing,
    Needs(Box<StillRequest>, Needs),
    Promise(Promise),
    /// By curves.
    Choice(Choice),
}

/// A picture that was made and written.
pub struct Made {
    report: StillReport,
    settled: Settled,
    interrupted: bool,
}

impl Made {
    /// Says how it came about.
    pub fn tell(&self, path: &Path, json: bool) -> anyhow::Result<()> {
        note_warnings(&self.report.warnings);
        if !json {
            return out::say(&describe(&self.report, path, self.interrupted));
        }
        let mut report = report_json(&self.report, self.interrupted);
        match &self.settled {
            Settled::Nothing => {}
            Settled::Needs(request, needs) => {
                report["needs"] = effects::needs_json(request, &self.report.renderer, needs);
            }
            Settled::Promise(promise) => {
                report["promise"] = json!({
                    "seconds": promise.seconds,
                    "error": promise.error,
                    "bias": promise.bias,
                    "spp": promise.spp,
                    "order": promise.order,
                });
            }
            Settled::Choice(choice) => {
                let settings: serde_json::Map<String, Value> = (choice.settings.iter())
                    .map(|(name, value)| (name.clone(), json!(value)))
                    .collect();
                report["promise"] = json!({
                    "seconds": choice.seconds,
                    "error": choice.error,
                    "bias": choice.bias,
                    "delta_e": choice.delta_e,
                    "spp": choice.paths(),
                    "settings": settings,
                });
            }
        }
        out::say_json(&report)
    }
}

/// Says how a picture came about.
pub fn tell(
    report: &StillReport,
    path: &Path,
    interrupted: bool,
    json: bool,
) -> anyhow::Result<()> {
    note_warnings(&report.warnings);
    match json {
        true => out::say_json(&report_json(report, interrupted)),
        false => out::say(&describe(report, path, interrupted)),
    }
}

/// A picture under way: its progress, what ends it, and what is told of it meanwhile.
struct Work {
    progress: Progress,
    job: Job,
    interrupt: Interrupt,
    /// Told when the first pass comes.
    late: Late,
}

impl Work {
    fn begin(stop: &Stop, begun: Instant) -> Self {
        let progress = Progress::new();
        let seconds = stop.seconds.filter(|seconds| *seconds < LONGEST_SECONDS);
        let deadline = seconds.map(|seconds| begun + Duration::from_secs_f64(seconds));
        let late = Late::watch(deadline, &progress);
        let mut job = progress.job_with(late.listener());
        if let Some(deadline) = deadline {
            job = job.with_deadline(deadline);
        }
        let interrupt = Interrupt::watch(&job);
        Self {
            progress,
            job,
            interrupt,
            late,
        }
    }

    fn pass(&self, pass: &Pass<'_>) {
        self.late.in_time();
        self.interrupt.keep();
        let error = pass.error.map_or_else(String::new, |error| {
            format!(" · error {:.1} %", error * 100.0)
        });
        (self.progress).show(&format!("{} spp · {:.1} s{error}", pass.spp, pass.seconds));
    }

    /// What was made, or why not.
    fn ended<T>(&self, made: Result<T, StillError>) -> anyhow::Result<T> {
        self.progress.finish();
        match made {
            Err(StillError::Cancelled(_)) if self.interrupt.happened() => anyhow::bail!(
                "interrupted before there was a picture: nothing was written; give it more time"
            ),
            made => Ok(made?),
        }
    }
}

/// Renders all colourways of a design into one file.
fn sheet(
    args: &StillArgs,
    opened: &Opened,
    (request, renderer): (&StillRequest, &Renderer),
    begun: Instant,
) -> anyhow::Result<()> {
    let path = &args.output.0;
    engine::png_ending(path)?;
    let work = Work::begin(&request.stop, begun);
    let mut show = |index: usize, count: usize, pass: &Pass<'_>| {
        work.pass(pass);
        let picture = index + 1;
        work.progress.show(&format!(
            "colourway {picture} of {count} · {} spp",
            pass.spp
        ));
    };
    let store = ExemplarStore::user();
    let sheet = engine::render_sheet(
        &opened.design,
        request,
        renderer,
        &store,
        &work.job,
        &mut show,
    );
    let sheet = work.ended(sheet)?.made_from(source(args));
    sheet.save(path)?;
    note_warnings(&sheet.report.warnings);
    let interrupted = work.interrupt.happened();
    if args.json {
        let mut report = report_json(&sheet.report, interrupted);
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
    let line = describe(&sheet.report, path, interrupted);
    out::say(&format!("{line}\n  {}", sheet.labels()))
}

/// Renders a picture into a file, with progress on standard error.
pub fn render_to(
    opened: &Opened,
    (request, renderer): (&StillRequest, &Renderer),
    settling: Settling,
    path: &Path,
    begun: Instant,
    source: String,
) -> anyhow::Result<Made> {
    let work = Work::begin(&request.stop, begun);
    let mut settled = Settled::Nothing;
    let mut settle = |engine: &dyn Engine, design: &Arc<Design>| match settling {
        Settling::Nothing => Ok(None),
        Settling::Tolerance(tolerance) => {
            let (request, needs) =
                needs::settle(engine, renderer, design, request, tolerance, &work.job)?;
            work.progress.finish();
            out::note(&effects::left_out(&request, &needs));
            settled = Settled::Needs(Box::new(request.clone()), needs);
            Ok(Some(request))
        }
        Settling::Budget(budget) => {
            let afforded = needs::afford(engine, renderer, request, (budget, begun), &work.job)?;
            Ok(afforded.map(|(request, promise)| {
                work.progress.finish();
                out::note(&promised(&promise));
                settled = Settled::Promise(promise);
                request
            }))
        }
    };
    let still = engine::render_settled(
        &opened.design,
        request,
        renderer,
        &work.job,
        &mut settle,
        &mut |pass| work.pass(pass),
    );
    let still = work.ended(still)?.made_from(source);
    still.save(path)?;
    Ok(Made {
        report: still.report,
        settled,
        interrupted: work.interrupt.happened(),
    })
}

/// A picture with what the curves of `folder` say is the best use of a budget, and what that
/// is.
fn by_curves(
    folder: &Path,
    budget: Budget,
    (request, renderer): (StillRequest, &'static Renderer),
    design: &Design,
) -> anyhow::Result<(StillRequest, Choice)> {
    let shown = out::shown(folder);
    let Some(measured) = accuracy::read(folder) else {
        anyhow::bail!("{shown}: nothing was measured there: pickglass accuracy -o {shown}");
    };
    let asked = Asked { request, renderer };
    if measured.design != design.name || !measured.is_of(&asked) {
        anyhow::bail!(
            "{shown}: what was measured there is of {}, {}: ask for that picture, or measure this \
             one into another folder",
            measured.design,
            measured.picture
        );
    }
    let Some(choice) = measured.within(budget) else {
        anyhow::bail!(
            "--budget {budget}: what was measured in {shown} has no settings for it: give a larger \
             one, or measure more with accuracy --dials spp,order,denoise"
        );
    };
    let mut request = choice.set(&asked)?.request;
    request.stop = match budget {
        Budget::Seconds(_) | Budget::Error(_) => Stop::within(budget, choice.bias),
        Budget::DeltaE(_) => Stop {
            spp: choice.paths(),
            ..Stop::default()
        },
    };
    Ok((request, choice))
}

/// What curves say that a picture will come to, for a person.
fn chose(choice: &Choice) -> String {
    let settings = choice.settings.iter();
    let settings = settings.map(|(name, value)| format!("{name}={value}"));
    let seen = choice
        .delta_e
        .map_or_else(String::new, |delta_e| format!(", ΔE {delta_e:.1}"));
    format!(
        "by the curves it will take {:.1} s once its cloth is made, error {:.1} %{seen}: {}",
        choice.seconds,
        100.0 * choice.error,
        settings.collect::<Vec<_>>().join(" ")
    )
}

/// What a picture will come to, for a person.
fn promised(promise: &Promise) -> String {
    let bias = match promise.bias > 1e-4 {
        true => format!(", {:.1} % of it whatever the time", 100.0 * promise.bias),
        false => String::new(),
    };
    format!(
        "it will take {:.1} s, error {:.1} %{bias}: {} paths a pixel, light followed for {} scatterings",
        promise.seconds,
        100.0 * promise.error,
        promise.spp,
        promise.order,
    )
}

/// The picture's line for a person.
fn describe(report: &StillReport, path: &Path, interrupted: bool) -> String {
    let so_far = if interrupted {
        ", interrupted: the picture so far"
    } else {
        ""
    };
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
    // Not every engine has paths.
    let (samples, rate) = match report.paths_per_second > 0.0 {
        true => (
            format!("{} spp{error}", report.spp),
            format!(", {:.2} M paths/s", report.paths_per_second / 1e6),
        ),
        false => (report.renderer.clone(), String::new()),
    };
    format!(
        "wrote {} ({} x {}, {samples}{level}, {:.1} s{rate}{so_far}){wrong}",
        out::shown(path),
        report.width,
        report.height,
        report.total_seconds,
    )
}

/// The picture's report with the keys that scripts rely on.
fn report_json(report: &StillReport, interrupted: bool) -> Value {
    let effects: Vec<Value> = report
        .effects
        .iter()
        .map(|planned| {
            json!({
                "name": planned.effect.name(),
                "on": planned.on,
                "reason": &*planned.why,
                "by": planned.by.to_string(),
            })
        })
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
        "capped_walks": report.capped_walks,
        "invalid_rays": report.invalid_rays,
        "effects": effects,
        "level": report.level,
        "light_error": light_error,
        "interrupted": interrupted,
        "warnings": report.warnings,
    })
}

/// What is looked at and how it is read, as words of a command line.
fn source(args: &StillArgs) -> String {
    let mut words = source_words(&args.design, &args.sett, &args.image);
    words.extend(args.voxel.map(|voxel| format!("--voxel {voxel}")));
    words.join(" ")
}

/// What is asked for, before `backing` where nothing is said of that.
fn request(args: &StillArgs, backing: Backing) -> anyhow::Result<StillRequest> {
    let mut request = picture(&args.picture, backing)?;
    let budget = args.budget.map(|budget| Stop::within(budget, 0.0));
    let budget = budget.unwrap_or_default();
    request.stop = Stop {
        spp: args.picture.spp,
        seconds: args.seconds.or(budget.seconds),
        error: args.error.or(budget.error),
    };
    request.colourway.clone_from(&args.colourway);
    Ok(request)
}

/// The picture that is asked for, before `backing` where nothing is said of that.
pub fn picture(args: &PictureArgs, backing: Backing) -> anyhow::Result<StillRequest> {
    let mut settings = Settings::default();
    for turned in &args.dials {
        turned.dial.turn(&mut settings, &turned.value)?;
    }
    Ok(StillRequest {
        width: args.size.width,
        height: args.size.height,
        eye: args.eye,
        turned: args.turned,
        view: args.view,
        width_mm: args.mm.map(|mm| mm as f32),
        centre_mm: args.centre,
        light: args.light.clone(),
        exposure_ev: args.exposure as f32,
        backing: args.backing.unwrap_or(backing),
        effects: args.effects.clone(),
        settings,
        seed: args.seed,
        stop: Stop {
            spp: args.spp,
            ..Stop::default()
        },
        colourway: None,
    })
}
