//! Measures dials, one after the other: which of them, with how many paths, and in what order
//! their settings take turns.

use std::sync::Arc;

use strum::{Display, EnumMessage, EnumString, IntoStaticStr, VariantArray};

use super::AccuracyError;
use super::axis::{Asked, Axis};
use super::curve::{Accuracy, Curve, Machine, Point, Trial};
use super::difference::{self, BLOCK, Frame};
use super::estimate::Estimate;
use super::picture::{options, paths_asked, with_paths};
use super::studio::{Exposing, Studio, Take, Takes, piece};
use super::woven::{Synthesised, Woven};
use crate::clock::Took;
use crate::cloth::ClothSettings;
use crate::design::Design;
use crate::exemplar::ExemplarStore;
use crate::film::{Picture, Tone};
use crate::formats::png::Depth;
use crate::job::Job;
use crate::plan::{Measure, Subject};
use crate::random::Random;
use crate::synthesis::MOST_AT_ONCE;

/// How much is measured.
#[derive(
    Debug,
    Clone,
    Copy,
    PartialEq,
    Eq,
    Default,
    Display,
    EnumString,
    EnumMessage,
    IntoStaticStr,
    VariantArray,
)]
#[strum(serialize_all = "kebab-case")]
pub enum Effort {
    /// The four dials that matter most, roughly: half a minute where nothing else works.
    Quick,
    /// The eight dials that matter most to this design: at most five minutes, likewise.
    #[default]
    Default,
    /// Every dial, closely: half an hour, likewise.
    Full,
}

impl Effort {
    /// Seconds of the whole.
    fn seconds(self) -> f64 {
        match self {
            Self::Quick => 25.0,
            Self::Default => 210.0,
            Self::Full => 1800.0,
        }
    }

    /// Pictures of each setting.
    fn seeds(self) -> u64 {
        match self {
            Self::Quick => 3,
            Self::Default => 5,
            Self::Full => 9,
        }
    }

    /// Dials that are measured where none is named.
    fn dials(self) -> usize {
        match self {
            Self::Quick => 4,
            Self::Default => 8,
            Self::Full => usize::MAX,
        }
    }
}

/// What is to be measured.
pub struct Measuring {
    /// The picture, and what draws it.
    pub asked: Asked,
    /// How much.
    pub effort: Effort,
    /// Which dials; empty = those that matter most to the design.
    pub axes: Vec<Axis>,
    /// What was measured before, to go on from where it has the same key.
    pub before: Option<Accuracy>,
}

/// What a setting looks like: one piece of the picture for each of a curve's settings.
pub type Crops = Vec<Picture>;

/// Pictures whose time is not measured: what is made ready at the first.
const WARM: Exposing = Exposing { seed: 0, spp: 1 };
/// How each dial is tried to find out whether it matters.
const TRIED: Runs = Runs { seeds: 2, spp: 1 };
/// Paths a pixel beyond which more are predicted, in multiples of those of other pictures.
const LONGER: u32 = 4;
/// Random settings of several dials that are measured.
const TRIALS: usize = 10;
/// Paths a pixel of a picture that is shown, at most, also in multiples of those of other
/// pictures, and how many are taken.
const SHOWN_SPP: u32 = 64;
const SHOWN_LONGER: u32 = 2;
const SHOWN_SEEDS: u64 = 3;
/// The first seed of paths that no setting's picture has.
const OTHER_PATHS: u64 = 1 << 32;
/// Settings at random that take longer than so many pictures as they are asked for are passed
/// over.
const TRIAL_SECONDS: f64 = 3.0;

/// How often, and with how many paths a pixel, each setting's picture is taken.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Runs {
    seeds: u64,
    spp: u32,
}

/// Measures the accuracy of one design on this machine. `on_curve` is told after each dial:
/// all that was measured so far, and what the settings of the last curve look like.
///
/// # Errors
/// When a dial that is named changes nothing, there is no picture, `on_curve` fails or the job
/// is cancelled.
pub fn measure(
    design: &Arc<Design>,
    measuring: &Measuring,
    store: &ExemplarStore,
    job: &Job,
    on_curve: &mut dyn FnMut(&Accuracy, &Crops) -> Result<(), AccuracyError>,
) -> Result<Accuracy, AccuracyError> {
    measuring.check()?;
    let asked = with_paths(&measuring.asked);
    let key = measuring.key(design);
    let before = (measuring.before.clone()).filter(|before| before.key == key);
    let piece = piece(design, &asked.request);
    let mut accuracy = before.unwrap_or_else(|| Accuracy {
        key,
        design: design.name.clone(),
        picture: options(&asked),
        spp: paths_asked(&asked),
        machine: machine(),
        piece: [piece.width, piece.height],
        piece_mm: piece.width_mm.unwrap_or_default().into(),
        chosen: Vec::new(),
        dials: Vec::new(),
        trials: Vec::new(),
    });
    let begun = std::time::Instant::now();
    let mut bench = Bench::new(design, asked, store, job)?;
    let mut names: Vec<&str> = measuring.axes.iter().map(Axis::name).collect();
    if names.is_empty() {
        // What was chosen once stays so: another trial might choose otherwise.
        if accuracy.chosen.is_empty() {
            accuracy.chosen = bench.chosen(measuring.effort, job)?;
        }
        names = accuracy.chosen.iter().map(String::as_str).collect();
    }
    let mut left: Vec<Axis> = Vec::new();
    for name in names {
        let known = accuracy.dials.iter().any(|curve| curve.name == name);
        if !known && !left.iter().any(|axis| axis.name() == name) {
            left.push(Axis::named(name)?);
        }
    }
    let time = measuring.effort.seconds() - begun.elapsed().as_secs_f64();
    let runs = bench.runs(&left, measuring.effort, time)?;
    for (number, axis) in left.iter().enumerate() {
        let share = (number as f32, left.len() as f32);
        let (curve, crops) = bench.curve(axis, &bench.ladder(axis), runs, &|stage| {
            let stage = (share.0 + stage) / share.1;
            job.report(&format!("then measuring {}", axis.name()), stage);
        })?;
        accuracy.dials.push(curve);
        on_curve(&accuracy, &crops)?;
    }
    if measuring.effort != Effort::Quick && accuracy.trials.is_empty() {
        let going = |share| job.report("last setting dials together", share);
        accuracy.trials = bench.trials(&accuracy, runs, &going)?;
        if !accuracy.trials.is_empty() {
            on_curve(&accuracy, &Crops::new())?;
        }
    }
    Ok(accuracy)
}

impl Measuring {
    /// Refuses what changes nothing of the picture.
    ///
    /// # Errors
    /// [`AccuracyError::Idle`] of the first such dial.
    pub fn check(&self) -> Result<(), AccuracyError> {
        let idle = self.axes.iter().find(|axis| !axis.applies(&self.asked));
        idle.map_or(Ok(()), |axis| Err(AccuracyError::Idle(axis.name())))
    }

    /// What measurements have to have in common to stand in one file: program and machine, the
    /// design, the picture with its light, and how much is measured.
    pub fn key(&self, design: &Design) -> String {
        let text = crate::formats::ron::write(design).unwrap_or_default();
        let light = self.asked.request.light.file();
        let light = light.and_then(|path| std::fs::read(path).ok());
        let light = light.map(|bytes| blake3::hash(&bytes).to_hex());
        let said = format!(
            "{} {} {} {:?} {light:?} {text}",
            env!("CARGO_PKG_VERSION"),
            options(&self.asked),
            self.effort,
            machine(),
        );
        blake3::hash(said.as_bytes()).to_hex()[..16].to_owned()
    }
}

/// This machine.
fn machine() -> Machine {
    let processor = sysinfo::System::new().ok().and_then(|mut system| {
        system.refresh_cpu_list(sysinfo::CpuRefreshKind::nothing());
        let first = system.cpus().first()?;
        Some(first.brand().trim().to_owned())
    });
    let [os, kind] = [std::env::consts::OS, std::env::consts::ARCH];
    let processor = processor.filter(|name| !name.is_empty());
    Machine {
        system: format!("{os}, {}", processor.as_deref().unwrap_or(kind)),
        threads: rayon::current_num_threads(),
    }
}

/// Where dials are measured.
struct Bench<'d> {
    /// In the colourway that is asked for.
    design: Arc<Design>,
    asked: Asked,
    store: &'d ExemplarStore,
    /// Cancelled with the work, and told nothing.
    quiet: Job,
    studio: Studio<'d>,
    woven: Option<Woven>,
    /// What the picture as it is asked for converges to.
    truth: Option<(Runs, Takes)>,
    /// Pixels across of the piece, and its blocks: a crossing wide, as what is wrong repeats
    /// from crossing to crossing.
    frame: Frame,
    /// Pixels of the picture for each of the piece.
    scale: f64,
    tone: Tone,
    pixels_per_mm: f32,
}

/// Told between pictures how far the curve is.
type Going<'g> = &'g dyn Fn(f32);

impl<'d> Bench<'d> {
    fn new(
        design: &Arc<Design>,
        asked: Asked,
        store: &'d ExemplarStore,
        job: &Job,
    ) -> Result<Self, AccuracyError> {
        let coloured = crate::engine::coloured(design, &asked.request)?;
        let piece = piece(&coloured, &asked.request);
        let pixels_per_mm = piece.width as f32 / piece.width_mm.unwrap_or(1.0);
        let sett = coloured.sett();
        let pitch = sett.ends.mean_pitch_mm().max(sett.picks.mean_pitch_mm());
        let crossing = (pitch * pixels_per_mm).ceil() as usize;
        let pixels = |request: &crate::engine::StillRequest| {
            f64::from(request.width) * f64::from(request.height)
        };
        Ok(Self {
            quiet: job.clone().with_listener(|_, _| {}),
            studio: Studio::new(Arc::clone(design), store),
            woven: None,
            truth: None,
            frame: Frame {
                width: piece.width as usize,
                block: crossing.clamp(BLOCK, (piece.width as usize / 4).max(BLOCK)),
            },
            scale: pixels(&asked.request) / pixels(&piece),
            tone: Tone {
                exposure: asked.request.exposure_ev,
            },
            pixels_per_mm,
            design: coloured,
            asked,
            store,
        })
    }

    fn spp(&self) -> u32 {
        self.asked.request.stop.spp.unwrap_or(1).max(1)
    }

    /// The settings of a dial, with the one that is asked for among them.
    fn ladder(&self, axis: &Axis) -> Vec<String> {
        with_current(&axis.ladder(), axis.current(&self.asked))
    }

    /// Whether the synthesis of the whole design can be measured.
    fn is_small(&self) -> bool {
        u64::from(self.design.ends()) * u64::from(self.design.picks()) <= MOST_AT_ONCE
    }

    /// The dials that matter most, in the order of their table. Of very large designs the
    /// synthesis is left out: their pictures make only what they show.
    fn chosen(&mut self, effort: Effort, job: &Job) -> Result<Vec<String>, AccuracyError> {
        let of_cloth = |axis: &Axis| {
            matches!(
                axis.measure(),
                Measure::Continuity | Measure::Seams | Measure::Kinks | Measure::Repetition
            )
        };
        let all = Axis::all().into_iter();
        let all: Vec<Axis> = all
            .filter(|axis| axis.applies(&self.asked) && (self.is_small() || !of_cloth(axis)))
            .collect();
        let names = |kept: &[usize]| kept.iter().map(|at| all[*at].name().to_owned()).collect();
        let most = effort.dials();
        if all.len() <= most {
            return Ok(names(&(0..all.len()).collect::<Vec<_>>()));
        }
        let asked = self.asked.clone();
        self.studio.take(&asked, WARM, &self.quiet)?;
        let whole = self.studio.take(&asked, WARM, &self.quiet)?;
        let paths = Paths::new(WARM.spp, self.spp());
        let whole = self.point("", &[whole], paths, Estimate::exact(0.0));
        let mut matter = Vec::with_capacity(all.len());
        for (number, axis) in all.iter().enumerate() {
            job.report("first trying all dials", number as f32 / all.len() as f32);
            let ends = [axis.ladder()[0], axis.reference()].map(str::to_owned);
            let (curve, _) = self.curve(axis, &ends, TRIED, &|_| {})?;
            matter.push((number, matters(&curve, whole.seconds)));
        }
        matter.sort_by(|one, other| other.1.total_cmp(&one.1));
        let mut kept: Vec<usize> = matter.iter().take(most).map(|(at, _)| *at).collect();
        kept.sort_unstable();
        Ok(names(&kept))
    }

    /// With how many paths each setting's picture is taken so that all takes `time` seconds.
    fn runs(&mut self, axes: &[Axis], effort: Effort, time: f64) -> Result<Runs, AccuracyError> {
        let seeds = effort.seeds();
        let mut seconds = 0.0;
        for axis in axes {
            let [crude, reference] = self.ends(axis)?;
            // Settings between them take as long as the slower one where few do.
            let each = 0.5 * (crude + reference);
            let settings = axis.ladder().len() as f64;
            seconds += each
                * match axis.measure() {
                    // One picture of each, to look at.
                    Measure::Continuity | Measure::Seams | Measure::Kinks | Measure::Repetition => {
                        settings
                    }
                    Measure::Shown | Measure::Engine | Measure::Rounding => {
                        let taken = seeds.min(SHOWN_SEEDS) as f64 * f64::from(SHOWN_LONGER);
                        taken * (settings + 1.0)
                    }
                    Measure::Bias | Measure::Noise => settings * seeds as f64,
                };
        }
        let spp = time / seconds.max(1e-9);
        Ok(Runs {
            seeds,
            spp: (spp as u32).clamp(1, 4 * self.spp().max(1)),
        })
    }

    /// Seconds of a path a pixel at both ends of a dial.
    fn ends(&mut self, axis: &Axis) -> Result<[f64; 2], AccuracyError> {
        let mut seconds = [0.0; 2];
        let ladder = axis.ladder();
        // The number of paths itself takes what it takes.
        let ends = match axis.name() {
            "spp" => [axis.current(&self.asked), axis.current(&self.asked)],
            _ => [ladder[0].to_owned(), axis.reference().to_owned()],
        };
        for (seconds, value) in seconds.iter_mut().zip(&ends) {
            let asked = axis.set(&self.asked, value)?;
            self.studio.take(&asked, WARM, &self.quiet)?;
            *seconds = self.studio.take(&asked, WARM, &self.quiet)?.took.seconds;
        }
        self.studio.clear_but(&self.asked);
        Ok(seconds)
    }

    /// Measures one dial at the settings of `ladder`.
    fn curve(
        &mut self,
        axis: &Axis,
        ladder: &[String],
        runs: Runs,
        going: Going<'_>,
    ) -> Result<(Curve, Crops), AccuracyError> {
        let measure = axis.measure();
        let (settings, crops) = match measure {
            Measure::Continuity | Measure::Seams | Measure::Kinks | Measure::Repetition => {
                self.of_synthesis(axis, ladder, runs, going)?
            }
            Measure::Bias => self.biased(axis, ladder, runs, going)?,
            Measure::Noise => self.noisy(axis, ladder, runs, going)?,
            Measure::Shown | Measure::Engine | Measure::Rounding => {
                self.shown(axis, ladder, runs, going)?
            }
        };
        self.studio.clear_but(&self.asked);
        let mut curve = Curve {
            name: axis.name().to_owned(),
            about: axis.about().to_owned(),
            measure,
            unit: measure.unit().to_owned(),
            reference: axis.reference().to_owned(),
            current: axis.current(&self.asked),
            knee: None,
            settings,
        };
        curve.find_knee();
        Ok((curve, crops))
    }

    /// Pictures of each setting: seed after seed, all settings in turn.
    fn take_all(
        &mut self,
        settings: &[Asked],
        runs: Runs,
        first_seed: u64,
        going: Going<'_>,
    ) -> Result<Vec<Takes>, AccuracyError> {
        for asked in settings {
            self.studio.take(asked, WARM, &self.quiet)?;
        }
        let mut all: Vec<Takes> = settings.iter().map(|_| Takes::default()).collect();
        let count = (runs.seeds as usize * settings.len()).max(1);
        let mut done = 0;
        for seed in 0..runs.seeds {
            for (asked, takes) in settings.iter().zip(&mut all) {
                going(done as f32 / count as f32);
                let exposing = Exposing {
                    seed: first_seed + seed,
                    spp: runs.spp,
                };
                takes
                    .0
                    .push(self.studio.take(asked, exposing, &self.quiet)?);
                done += 1;
            }
        }
        Ok(all)
    }

    fn settings(&self, axis: &Axis, ladder: &[String]) -> Result<Vec<Asked>, AccuracyError> {
        let set = ladder.iter().map(|value| axis.set(&self.asked, value));
        set.collect()
    }

    /// What is wrong whatever the number of paths.
    fn biased(
        &mut self,
        axis: &Axis,
        ladder: &[String],
        runs: Runs,
        going: Going<'_>,
    ) -> Result<(Vec<Point>, Crops), AccuracyError> {
        let settings = self.settings(axis, ladder)?;
        let all = self.take_all(&settings, runs, 1, going)?;
        let traced: Vec<Vec<difference::Pixels>> = all.iter().map(Takes::traced).collect();
        let [.., reference] = &traced[..] else {
            return Ok((Vec::new(), Vec::new()));
        };
        let means: Vec<_> = traced.iter().map(|takes| difference::mean(takes)).collect();
        let seen: Vec<_> = (all.iter().zip(&means))
            .map(|(takes, mean)| takes.shown(self.frame.width, mean, self.tone))
            .collect();
        let far: Vec<_> = (seen.iter())
            .map(|shown| shown.at_reading_distance(self.pixels_per_mm))
            .collect();
        let (power, paths) = (difference::power(reference), self.paths(runs.spp));
        let mut points = Vec::with_capacity(ladder.len());
        for (at, value) in ladder.iter().enumerate() {
            let error = difference::bias(&traced[at], reference, self.frame);
            let mut point = self.point(value, &all[at].0, paths, error);
            let noise = difference::noise(&traced[at], power, self.frame);
            point.noise = Some(noise.value * paths.fewer().sqrt());
            let looks = far[at].difference(&far[far.len() - 1]);
            (point.delta_e, point.ssim) = (Some(looks.delta_e), Some(looks.ssim));
            points.push(point);
        }
        let crops = seen.iter().map(|shown| shown.picture()).collect();
        Ok((points, crops))
    }

    /// Noise alone.
    fn noisy(
        &mut self,
        axis: &Axis,
        ladder: &[String],
        runs: Runs,
        going: Going<'_>,
    ) -> Result<(Vec<Point>, Crops), AccuracyError> {
        if axis.name() == "spp" {
            return self.number_of_paths(ladder, runs, going);
        }
        let settings = self.settings(axis, ladder)?;
        let all = self.take_all(&settings, runs, 1, going)?;
        let mut points = Vec::with_capacity(ladder.len());
        let paths = self.paths(runs.spp);
        for (value, takes) in ladder.iter().zip(&all) {
            let noise = self.noise(&takes.traced(), paths);
            let mut point = self.point(value, &takes.0, paths, noise);
            point.delta_e = self.grain(takes, paths);
            points.push(point);
        }
        Ok((points, self.crops(&all)))
    }

    /// Noise by the number of paths: measured as far as that is quick, then predicted.
    fn number_of_paths(
        &mut self,
        ladder: &[String],
        runs: Runs,
        going: Going<'_>,
    ) -> Result<(Vec<Point>, Crops), AccuracyError> {
        let asked = self.asked.clone();
        let (mut points, mut crops): (Vec<Point>, Crops) = (Vec::new(), Vec::new());
        let mut last: Option<(u32, Takes)> = None;
        for value in ladder {
            let wanted: u32 = value.parse().unwrap_or(1);
            let measured = wanted <= LONGER * runs.spp || last.is_none();
            if measured {
                let exposed = Runs {
                    spp: wanted,
                    ..runs
                };
                let all = self.take_all(std::slice::from_ref(&asked), exposed, 1, going)?;
                crops.extend(self.crops(&all));
                last = all.into_iter().next().map(|takes| (wanted, takes));
            }
            let Some((taken, takes)) = &last else {
                continue;
            };
            let paths = Paths::new(*taken, wanted);
            let noise = self.noise(&takes.traced(), paths);
            let mut point = self.point(value, &takes.0, paths, noise);
            point.delta_e = self.grain(takes, paths);
            point.measured = measured;
            points.push(point);
        }
        Ok((points, crops))
    }

    /// All that is wrong with what is shown, against what the picture as it is asked for
    /// converges to.
    fn shown(
        &mut self,
        axis: &Axis,
        ladder: &[String],
        runs: Runs,
        going: Going<'_>,
    ) -> Result<(Vec<Point>, Crops), AccuracyError> {
        let settings = self.settings(axis, ladder)?;
        let exposed = self.exposed(runs);
        let all = self.take_all(&settings, exposed, 1, going)?;
        let reference = match self.truth.take() {
            Some((known, reference)) if known == exposed => reference,
            _ => {
                let mut truth = self.asked.clone();
                truth.renderer = crate::engine::reference();
                let taken = self.take_all(&[truth], exposed, OTHER_PATHS, going)?;
                taken.into_iter().next().unwrap_or_default()
            }
        };
        let converging = reference.traced();
        let far = reference
            .shown(self.frame.width, &difference::mean(&converging), self.tone)
            .at_reading_distance(self.pixels_per_mm);
        let mut points = Vec::with_capacity(ladder.len());
        let mut crops = Vec::with_capacity(ladder.len());
        for ((value, asked), takes) in ladder.iter().zip(&settings).zip(&all) {
            let clean = takes.clean();
            let Some(once) = clean.first() else { continue };
            let seen = takes.shown(self.frame.width, once, self.tone);
            let error = match axis.measure() {
                Measure::Rounding => {
                    let depth = self.depth_of(axis, value)?;
                    Estimate::exact(rounding(&seen.picture(), depth))
                }
                _ => difference::total(&clean, &converging, self.frame),
            };
            let paths = match asked.renderer.refines {
                true => self.paths(exposed.spp),
                // It takes none, however many are asked for.
                false => Paths::new(1, 1),
            };
            let mut point = self.point(value, &takes.0, paths, error);
            if axis.measure() != Measure::Rounding {
                point.paths = Some(exposed.spp).filter(|_| asked.renderer.refines);
                let looks = (seen.at_reading_distance(self.pixels_per_mm)).difference(&far);
                (point.delta_e, point.ssim) = (Some(looks.delta_e), Some(looks.ssim));
            }
            points.push(point);
            crops.push(seen.picture());
        }
        self.truth = Some((exposed, reference));
        Ok((points, crops))
    }

    /// How pictures that are shown are taken: with paths as they are asked for, as far as that
    /// is quick, as filtering knows no law of their number.
    fn exposed(&self, runs: Runs) -> Runs {
        Runs {
            seeds: runs.seeds.min(SHOWN_SEEDS),
            spp: self.spp().min(SHOWN_SPP).min(SHOWN_LONGER * runs.spp),
        }
    }

    fn depth_of(&self, axis: &Axis, value: &str) -> Result<Depth, AccuracyError> {
        let asked = axis.set(&self.asked, value)?;
        Ok(asked.request.settings.showing.png_depth)
    }

    /// What the synthesis achieves.
    fn of_synthesis(
        &mut self,
        axis: &Axis,
        ladder: &[String],
        runs: Runs,
        going: Going<'_>,
    ) -> Result<(Vec<Point>, Crops), AccuracyError> {
        let settings = self.settings(axis, ladder)?;
        let job = &self.quiet;
        let woven = match self.woven.take() {
            Some(woven) => woven,
            None => Woven::new(
                Arc::clone(&self.design),
                self.cloth_settings(&self.asked)?,
                self.store,
                job,
            )?,
        };
        let mut all: Vec<Vec<Synthesised>> = settings.iter().map(|_| Vec::new()).collect();
        for seed in 0..runs.seeds {
            for (asked, made) in settings.iter().zip(&mut all) {
                going(seed as f32 / (2 * runs.seeds) as f32);
                let mut synthesis = self.cloth_settings(asked)?.synthesis;
                synthesis.seed = synthesis.seed.wrapping_add(seed);
                made.push(woven.synthesise(synthesis, job)?);
            }
        }
        let mut points = Vec::with_capacity(ladder.len());
        for (value, made) in ladder.iter().zip(&all) {
            let (times, errors): (Vec<Took>, Vec<f64>) = (made.iter())
                .map(|made| match axis.measure() {
                    Measure::Seams => (made.edge_fixing, woven.seams_in_diameters(made)),
                    Measure::Kinks => (made.edge_fixing, made.seams.kinks[1]),
                    Measure::Repetition => (made.assignment, made.repeated),
                    _ => (made.assignment, discontinuous(made)),
                })
                .unzip();
            let error = Estimate::mean(&errors);
            let seconds: Vec<f64> = times.iter().map(|took| took.seconds).collect();
            let mut point = Point::new(value, Estimate::median(&seconds), error);
            point.processor_seconds = middle(times.iter().map(|took| took.processor_seconds));
            points.push(point);
        }
        self.woven = Some(woven);
        let looks = Runs { seeds: 1, ..runs };
        let taken = self.take_all(&settings, looks, 1, &|share| going(0.5 + 0.5 * share))?;
        Ok((points, self.crops(&taken)))
    }

    /// Several dials set at random, each such picture measured beside what the curves say of it.
    fn trials(
        &mut self,
        accuracy: &Accuracy,
        runs: Runs,
        going: Going<'_>,
    ) -> Result<Vec<Trial>, AccuracyError> {
        let tried = |curve: &&Curve| {
            // The law of the paths is known, and it would only take time.
            let adds = matches!(curve.measure, Measure::Bias | Measure::Noise);
            adds && curve.name != "spp"
        };
        let curves: Vec<&Curve> = accuracy.dials.iter().filter(tried).collect();
        if curves.len() < 2 {
            return Ok(Vec::new());
        }
        let asked = self.asked.clone();
        let set = |settings: &[(String, String)]| {
            let mut set = settings.iter();
            set.try_fold(asked.clone(), |asked, (name, value)| {
                Axis::named(name)?.set(&asked, value)
            })
        };
        // What changes the noise alone changes nothing of what pictures converge to.
        let best: Vec<(String, String)> = (curves.iter())
            .filter(|curve| curve.measure == Measure::Bias)
            .map(|curve| (curve.name.clone(), curve.reference.clone()))
            .collect();
        let reference = set(&best)?;
        let now = accuracy.predict(&[]).map_or(0.0, |now| now.seconds);
        let at_random = (0..64 * TRIALS as u64).filter_map(|trial| {
            let settings: Vec<(String, String)> = (curves.iter().enumerate())
                .map(|(number, curve)| {
                    let mut random = Random::new(trial, number as u64, 0);
                    let at = (random.pair()[0] * curve.settings.len() as f32) as usize;
                    let at = at.min(curve.settings.len() - 1);
                    (curve.name.clone(), curve.settings[at].value.clone())
                })
                .collect();
            let said = accuracy.predict(&settings)?;
            (said.seconds <= TRIAL_SECONDS * now).then_some((settings, said))
        });
        let all: Vec<_> = at_random.take(TRIALS).collect();
        if all.is_empty() {
            return Ok(Vec::new());
        }
        let truth = self.take_all(std::slice::from_ref(&reference), runs, 1, &|_| {})?;
        let truth: Vec<difference::Pixels> = truth.iter().flat_map(Takes::traced).collect();
        let (power, paths) = (difference::power(&truth), self.paths(runs.spp));
        let mut trials = Vec::with_capacity(TRIALS);
        for (number, (settings, said)) in all.into_iter().enumerate() {
            going(number as f32 / TRIALS as f32);
            let asked = set(&settings)?;
            let taken = self.take_all(std::slice::from_ref(&asked), runs, 1, &|_| {})?;
            let Some(takes) = taken.first() else { continue };
            let traced = takes.traced();
            let bias = difference::bias(&traced, &truth, self.frame).squared();
            let noise = difference::noise(&traced, power, self.frame);
            let noise = noise.scaled(paths.fewer().sqrt()).squared();
            let point = self.point("", &takes.0, paths, bias.plus(noise).root());
            self.studio.clear_but(&self.asked);
            trials.push(Trial {
                settings,
                predicted_seconds: said.seconds,
                seconds: point.seconds,
                predicted_error: said.error,
                error: point.error,
                error_interval: point.error_interval,
            });
        }
        Ok(trials)
    }

    fn cloth_settings(&self, asked: &Asked) -> Result<ClothSettings, AccuracyError> {
        Ok(asked.renderer.plan(&asked.request, Subject::Cloth)?.cloth)
    }

    /// What the first picture of each setting looks like.
    fn crops(&self, all: &[Takes]) -> Crops {
        (all.iter())
            .filter_map(|takes| {
                let first = takes.0.first()?;
                let shown = takes.shown(self.frame.width, &first.traced, self.tone);
                Some(shown.picture())
            })
            .collect()
    }

    /// Paths of pictures taken with `taken` a pixel, and those that are asked for.
    fn paths(&self, taken: u32) -> Paths {
        Paths::new(taken, self.spp())
    }

    /// Noise of pictures with all their paths: paths are independent of each other, so that it
    /// falls with the root of their number.
    fn noise(&self, traced: &[difference::Pixels], paths: Paths) -> Estimate {
        let power = difference::power(traced);
        difference::noise(traced, power, self.frame).scaled(paths.fewer().sqrt())
    }

    /// What an eye at 30 cm sees of the noise of pictures with all their paths, mean ΔE₀₀: how
    /// far each of those that were taken is from the mean of the others, whose own noise is
    /// taken off; small differences of colour fall with the root of their number as the noise
    /// does. `None` where there is one picture alone.
    fn grain(&self, takes: &Takes, paths: Paths) -> Option<f64> {
        let (traced, count) = (takes.traced(), takes.0.len());
        if count < 2 {
            return None;
        }
        let far = |pixels: &difference::Pixels| {
            let shown = takes.shown(self.frame.width, pixels, self.tone);
            shown.at_reading_distance(self.pixels_per_mm)
        };
        let apart = (0..count).map(|own| {
            let others = (0..count).filter(|other| *other != own);
            let others: Vec<_> = others.map(|other| traced[other].clone()).collect();
            let others = far(&difference::mean(&others));
            far(&traced[own]).difference(&others).delta_e
        });
        let own = 1.0 + 1.0 / (count - 1) as f64;
        Some(apart.sum::<f64>() / count as f64 / own.sqrt() * paths.fewer().sqrt())
    }

    /// The point of a setting from pictures of the piece: its time is that of the whole picture
    /// with all its paths.
    fn point(&self, value: &str, takes: &[Take], paths: Paths, error: Estimate) -> Point {
        let more = 1.0 / paths.fewer();
        let scale = |took: Took, by: f64| Took {
            seconds: took.seconds * by,
            processor_seconds: took.processor_seconds.map(|seconds| seconds * by),
        };
        let whole = |take: &Take| {
            let parts = [
                scale(take.took.without(take.before), more * self.scale),
                take.before,
                scale(take.developing, self.scale),
                scale(take.encoding, self.scale),
            ];
            let seconds = parts.iter().map(|part| part.seconds).sum::<f64>();
            let worked: Option<f64> = parts.iter().map(|part| part.processor_seconds).sum();
            (seconds, worked)
        };
        let seconds: Vec<f64> = takes.iter().map(|take| whole(take).0).collect();
        let mut point = Point::new(value, Estimate::median(&seconds), error);
        point.processor_seconds = middle(takes.iter().map(|take| whole(take).1));
        point
    }
}

/// Share of the neighbours that do not go on in each other.
fn discontinuous(made: &Synthesised) -> f64 {
    let continuity = made.quality.continuity;
    1.0 - continuity.before as f64 / continuity.max.max(1) as f64
}

/// The median of what is known.
fn middle(values: impl Iterator<Item = Option<f64>>) -> Option<f64> {
    let known: Option<Vec<f64>> = values.collect();
    known.map(|known| Estimate::median(&known).value)
}

/// Paths a pixel.
#[derive(Debug, Clone, Copy)]
struct Paths {
    taken: u32,
    wanted: u32,
}

impl Paths {
    fn new(taken: u32, wanted: u32) -> Self {
        Self { taken, wanted }
    }

    /// The share that was taken of those that are wanted.
    fn fewer(self) -> f64 {
        f64::from(self.taken.max(1)) / f64::from(self.wanted.max(1))
    }
}

/// A ladder with `current` in its place among numbers, else before its reference.
fn with_current(ladder: &[&str], current: String) -> Vec<String> {
    let mut all: Vec<String> = ladder.iter().map(|&value| value.to_owned()).collect();
    if all.contains(&current) {
        return all;
    }
    let number = |value: &str| value.parse::<f64>().ok();
    let numbers: Vec<f64> = ladder.iter().filter_map(|&value| number(value)).collect();
    let rises = numbers.first() < numbers.last();
    let own = number(&current);
    let is_beyond = |value: &str| {
        let beyond = number(value)
            .zip(own)
            .map(|(other, own)| (other > own) == rises);
        beyond.unwrap_or(false)
    };
    let last = all.len().saturating_sub(1);
    let at = ladder
        .iter()
        .position(|value| is_beyond(value))
        .unwrap_or(last);
    all.insert(at, current);
    all
}

/// Root mean square of what rounding does to a picture's samples, of white.
fn rounding(picture: &Picture, depth: Depth) -> f64 {
    let steps = match depth {
        Depth::Eight => 255.0f64,
        Depth::Sixteen => 65535.0,
    };
    let samples = picture.pixels.iter().flat_map(|pixel| &pixel[..3]);
    let (sum, count) = samples.fold((0.0, 0u32), |(sum, count), sample| {
        let value = f64::from(*sample);
        let lost = (value * steps).round() / steps - value;
        (sum + lost * lost, count + 1)
    });
    (sum / f64::from(count.max(1))).sqrt()
}

/// How much a dial does to a picture that takes `whole` seconds: to its time, in powers of e,
/// and to its error.
fn matters(curve: &Curve, whole: f64) -> f64 {
    let (Some(crude), Some(reference)) = (curve.settings.first(), curve.settings.last()) else {
        return 0.0;
    };
    let beside = match curve.measure {
        // Their time is that of the synthesis.
        Measure::Continuity | Measure::Seams | Measure::Kinks | Measure::Repetition => whole,
        _ => 0.0,
    };
    let time = ((beside + reference.seconds) / (beside + crude.seconds)).ln();
    let time = if time.is_finite() { time.abs() } else { 0.0 };
    time.min(3.0) + (crude.error - reference.error).abs().min(3.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_asked_for_stands_in_its_place_on_the_ladder() {
        let with = |ladder: &[&str], current: &str| with_current(ladder, current.to_owned());
        assert_eq!(with(&["1", "16", "64"], "20"), ["1", "16", "20", "64"]);
        assert_eq!(with(&["4", "2", "0"], "3"), ["4", "3", "2", "0"]);
        assert_eq!(with(&["1", "0.1", "0"], "0.05"), ["1", "0.1", "0.05", "0"]);
        assert_eq!(
            with(&["1", "16", "never"], "32"),
            ["1", "16", "32", "never"]
        );
        assert_eq!(with(&["1", "16", "64"], "100"), ["1", "16", "100", "64"]);
        assert_eq!(with(&["off", "on"], "on"), ["off", "on"]);
    }
}
