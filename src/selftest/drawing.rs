//! Designs and views that are hard to draw, by any engine.

use std::sync::Arc;

use super::fault::Fault;
use crate::design::{
    Design, Family, Sett, Srgb, Structure, WeavePattern, Yarn, YarnId, YarnMaps, weave,
};
use crate::engine::{Heading, LightChoice, Renderer, Shot, Still, StillRequest, Stop, draw};
use crate::exemplar::ExemplarStore;
use crate::job::Job;
use crate::plan::{Effect, EffectChoice, Settings, Subject};
use crate::random::Random;
use crate::scene::View;
use crate::synthesis::{Rank, Seams};

/// Voxels of this level are quickly made, and no less hard.
const LEVEL: u32 = 3;

/// A cotton cloth, dark warp on light weft; `diameter_mm` of its yarns where that is not usual.
fn cotton(
    pattern: WeavePattern,
    sett: Sett,
    diameter_mm: Option<f32>,
) -> Result<Arc<Design>, Fault> {
    let yarn = |name, colour| Yarn {
        diameter_mm,
        ..Yarn::new(name, Family::Cotton, colour)
    };
    let yarns = vec![
        yarn("warp", Srgb(30, 40, 90)),
        yarn("weft", Srgb(235, 230, 220)),
    ];
    let maps = YarnMaps::plain(YarnId(0), YarnId(1));
    Design::new("hard case", Structure::Pattern(pattern), yarns, maps, sett)
        .map(Arc::new)
        .map_err(Fault::of)
}

fn twill() -> Result<WeavePattern, Fault> {
    weave("2/2 twill").map_err(Fault::of)
}

fn usual() -> Sett {
    Sett::per_cm(34.0, 32.0)
}

/// A small picture of `width_mm`.
fn small(width_mm: f32) -> StillRequest {
    StillRequest {
        width: 20,
        height: 16,
        width_mm: Some(width_mm),
        settings: Settings::default().at_level(LEVEL),
        stop: Stop {
            spp: Some(4),
            ..Stop::default()
        },
        ..StillRequest::default()
    }
}

/// The picture, where there is nothing in it that is no light; with a name for what is wrong.
fn drawn(
    name: &str,
    (renderer, job): (&Renderer, &Job),
    design: &Arc<Design>,
    request: &StillRequest,
) -> Result<Still, Fault> {
    let store = ExemplarStore::user();
    let engine = renderer.engine(design, request, &store, job)?;
    let plan = renderer.plan(request, Subject::Cloth).map_err(Fault::of)?;
    let shot = Shot::new(request, plan)?;
    let still = draw(&*engine, design, &shot, job, &mut |_| {})?;
    sound(&still).map_err(|wrong| Fault::Wrong(format!("{name}: {wrong}")))?;
    Ok(still)
}

fn sound(still: &Still) -> Result<(), Fault> {
    let report = &still.report;
    Fault::unless_counted_clean(
        report.majorant_violations,
        report.invalid_samples,
        report.invalid_rays,
    )?;
    // Light that is caught between two layers of yarn goes on and on, now and then.
    let paths = u64::from(report.width) * u64::from(report.height) * u64::from(report.spp);
    Fault::unless(100 * report.capped_walks <= paths, || {
        format!("{} walks without an end", report.capped_walks)
    })?;
    let light =
        (still.film.means().into_iter()).all(|mean| mean.is_finite() && mean.min_element() >= 0.0);
    let shown = (still.picture().pixels.iter().flatten()).all(|value| (0.0..=1.0).contains(value));
    Fault::unless(light && shown, || "pixels that are no light".to_owned())
}

/// The share of a picture that cloth covers.
fn covered(still: &Still) -> f32 {
    let pixels = still.film.pixels();
    pixels.iter().map(crate::film::Pixel::alpha).sum::<f32>() / pixels.len().max(1) as f32
}

/// Refuses a picture that is not covered within `range`.
fn covers(name: &str, still: &Still, range: std::ops::RangeInclusive<f32>) -> Result<(), Fault> {
    let covered = covered(still);
    Fault::unless(range.contains(&covered), || {
        format!("{name}: {:.0} % of it is covered", 100.0 * covered)
    })
}

pub(super) fn smallest_designs(renderer: &Renderer, job: &Job) -> Result<String, Fault> {
    let mut pictures = 0;
    for (name, ends, picks) in [
        ("one crossing", 1, 1),
        ("one end", 1, 6),
        ("one pick", 6, 1),
        ("a yarn on top throughout", 8, 8),
    ] {
        for up in [true, false] {
            let design = cotton(WeavePattern::from_fn(ends, picks, |_, _| up), usual(), None)?;
            for view in [View::Face, View::Back, View::Grazing] {
                let request = StillRequest { view, ..small(1.5) };
                let still = drawn(name, (renderer, job), &design, &request)?;
                covers(name, &still, 0.7..=1.0)?;
                pictures += 1;
            }
        }
    }
    Ok(format!("{pictures} pictures, all whole"))
}

pub(super) fn setts(renderer: &Renderer, job: &Job) -> Result<String, Fault> {
    let cases = [
        ("a fishing net", 0.2, Sett::per_cm(0.6, 0.6), 0.0..=0.3),
        ("uneven", 0.2, Sett::per_cm(60.0, 8.0), 0.5..=1.0),
        ("five times too thick", 1.5, usual(), 0.9..=1.0),
        ("a membrane", 0.025, Sett::per_cm(340.0, 320.0), 0.5..=1.0),
    ];
    let mut seen = Vec::new();
    for (name, diameter, sett, range) in cases {
        let width = 10.0 * sett.end_pitch_mm().max(sett.pick_pitch_mm());
        let design = cotton(twill()?, sett, Some(diameter))?;
        let still = drawn(name, (renderer, job), &design, &small(width))?;
        covers(name, &still, range)?;
        seen.push(format!("{name} {:.0} %", 100.0 * covered(&still)));
    }
    Ok(format!("covered: {}", seen.join(", ")))
}

pub(super) fn noise_as_a_weave(renderer: &Renderer, job: &Job) -> Result<String, Fault> {
    let mut random = Random::new(41, 0, 0);
    let noise = WeavePattern::from_fn(23, 29, |_, _| random.uniform() < 0.5);
    let design = cotton(noise, usual(), None)?;
    let still = drawn("noise", (renderer, job), &design, &small(4.0))?;
    covers("noise", &still, 0.8..=1.0)?;
    let satin = cotton(weave("7/1 satin").map_err(Fault::of)?, usual(), None)?;
    let stripe = (0..28).map(|end| YarnId(u16::from(end < 20))).collect();
    let maps = YarnMaps::orders(stripe, vec![YarnId(0)]);
    let design = Design::clone(&satin)
        .with_yarns(satin.yarns().to_vec(), maps)
        .map_err(Fault::of)?;
    let still = drawn("stripe", (renderer, job), &Arc::new(design), &small(8.0))?;
    covers("stripe", &still, 0.8..=1.0)?;
    // The stripe shows: twenty light ends beside eight dark ones.
    let light = |x: u32| -> f64 {
        (0..16)
            .map(|y| still.film.pixel(x, y).luminance())
            .sum::<f64>()
    };
    let columns: Vec<f64> = (0..20).map(light).collect();
    let most = columns.iter().copied().fold(0.0, f64::max);
    let least = columns.iter().copied().fold(f64::INFINITY, f64::min);
    Fault::unless(most > 1.5 * least, || {
        format!("the stripe does not show: {least:.2} to {most:.2}")
    })?;
    Ok(format!(
        "a stripe {:.1} times as light as its ground",
        most / least
    ))
}

pub(super) fn ranks(renderer: &Renderer, job: &Job) -> Result<String, Fault> {
    let all = [
        ("off", Rank::Off, Seams::Membrane),
        ("none", Rank::Truncated(0), Seams::Crowns),
        ("one", Rank::Truncated(1), Seams::Membrane),
        ("too many", Rank::Truncated(1000), Seams::Membrane),
        ("exact", Rank::Exact, Seams::Membrane),
        ("crowns", Rank::Exact, Seams::Crowns),
    ];
    // A plain weave's seams are alike: the matrix of their profiles has no inverse.
    for (weave, pattern) in [
        ("twill", twill()?),
        (
            "plain",
            WeavePattern::from_fn(2, 2, |end, pick| (end + pick) % 2 == 0),
        ),
    ] {
        let design = cotton(pattern, usual(), None)?;
        for (name, rank, seams) in all {
            let mut request = small(3.0);
            let synthesis = &mut request.settings.cloth.synthesis;
            (synthesis.rank, synthesis.seams) = (rank, seams);
            let name = format!("{weave}, {name}");
            let still = drawn(&name, (renderer, job), &design, &request)?;
            covers(&name, &still, 0.8..=1.0)?;
        }
    }
    Ok(format!("{} pictures, all whole", 2 * all.len()))
}

pub(super) fn views(renderer: &Renderer, job: &Job) -> Result<String, Fault> {
    let design = cotton(twill()?, usual(), None)?;
    let mut requests: Vec<(String, StillRequest)> = Vec::new();
    for view in View::ALL {
        for light in ["day", "sun", "raking-left"] {
            let light = LightChoice::Preset(light.to_owned());
            let request = StillRequest {
                view: *view,
                light,
                ..small(4.0)
            };
            requests.push((format!("{view}"), request));
        }
    }
    for elevation in [i16::MIN, 0, 1, 90, i16::MAX] {
        let heading = Heading {
            azimuth: 123,
            elevation,
        };
        let low_eye = StillRequest {
            eye: Some(heading),
            ..small(4.0)
        };
        let low_sun = StillRequest {
            light: LightChoice::Sun(heading),
            ..small(4.0)
        };
        requests.push((format!("an eye at {elevation}°"), low_eye));
        requests.push((format!("a sun at {elevation}°"), low_sun));
    }
    for width in [0.01, 0.1, 300.0, 5000.0] {
        requests.push((format!("{width} mm wide"), small(width)));
    }
    for (name, request) in &requests {
        let still = drawn(name, (renderer, job), &design, request)?;
        // From close by one may look between yarns, and from low down over the cloth's end.
        let least = match (request.width_mm, request.eye) {
            (Some(width), None) if width >= 1.0 => 0.6,
            _ => 0.0,
        };
        covers(name, &still, least..=1.0)?;
    }
    Ok(format!("{} views, all whole", requests.len()))
}

/// A twill of 10 threads a cm repeats every 4 mm: that many repeats away it is itself again,
/// where nothing is varied.
pub(super) fn far_from_the_origin(renderer: &Renderer, job: &Job) -> Result<String, Fault> {
    let design = cotton(twill()?, Sett::per_cm(10.0, 10.0), Some(0.9))?;
    let at = |centre: [f32; 2], varied: bool| {
        let changes = match varied {
            true => Vec::new(),
            false => vec![(Effect::Randomisation, false), (Effect::Hairs, false)],
        };
        let request = StillRequest {
            centre_mm: Some(centre),
            effects: EffectChoice {
                changes,
                ..EffectChoice::default()
            },
            ..small(6.0)
        };
        drawn("far away", (renderer, job), &design, &request)
    };
    let near = at([1.0, 2.0], false)?;
    for repeats in [-2_500_000.0f32, 25_000.0, 2_500_000.0] {
        let far = at([1.0 + 4.0 * repeats, 2.0 - 4.0 * repeats], false)?;
        let apart = apart(&near, &far);
        Fault::unless(apart < 0.01, || {
            format!("{:.0} m away it differs by {apart:.3}", 4e-3 * repeats)
        })?;
    }
    let varied = at([1e7, -1e7], true)?;
    covers("varied", &varied, 0.8..=1.0)?;
    // Control: what differs, differs by more.
    let control = apart(&near, &at([2.0, 2.0], false)?);
    Fault::unless(control > 0.03, || {
        format!("the next end looks the same: {control:.3}")
    })?;
    Ok(format!(
        "10 km away the same; the next end differs by {control:.2}"
    ))
}

/// Root mean square difference of what two pictures of a size show, of display values.
fn apart(one: &Still, other: &Still) -> f32 {
    let (one, other) = (one.picture(), other.picture());
    let pixels = one
        .pixels
        .iter()
        .flatten()
        .zip(other.pixels.iter().flatten());
    let squares: f32 = pixels.map(|(one, other)| (one - other).powi(2)).sum();
    (squares / (4 * one.pixels.len()).max(1) as f32).sqrt()
}
