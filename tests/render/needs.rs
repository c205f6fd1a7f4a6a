//! What a picture calls for: bounds that hold, and work that is not done.

use std::sync::Arc;

use pickglass::design::Design;
use pickglass::engine::{self, Engine, LightChoice, Still, StillRequest, Stop};
use pickglass::exemplar::ExemplarStore;
use pickglass::job::Job;
use pickglass::needs::{self, Need, Needs};
use pickglass::plan::{Decider, Effect, Subject};
use pickglass::presets;
use pickglass::random::Random;
use pickglass::render::Counters;
use pickglass::scene::{PRESET_NAMES, View};

fn design(name: &str) -> Arc<Design> {
    let design = presets::design(name).expect("a name");
    Arc::new(design.expect("a design"))
}

fn request(light: &str) -> StillRequest {
    StillRequest {
        width: 64,
        height: 48,
        width_mm: Some(4.0),
        light: LightChoice::Preset(light.to_owned()),
        stop: Stop {
            spp: Some(32),
            ..Stop::default()
        },
        ..StillRequest::default()
    }
}

/// Settles, with the engine that it was settled for.
fn settled(
    design: &Arc<Design>,
    request: &StillRequest,
    tolerance: f64,
) -> (Box<dyn Engine>, StillRequest, Needs) {
    let (renderer, job) = (engine::reference(), Job::new());
    let engine = renderer
        .engine(design, request, &ExemplarStore::user(), &job)
        .expect("cloth");
    let (settled, needs) =
        needs::settle(&*engine, renderer, design, request, tolerance, &job).expect("settled");
    (engine, settled, needs)
}

fn need(needs: &Needs, effect: Effect) -> &Need {
    let mut all = needs.effects.iter();
    all.find(|need| need.effect == effect).expect("an effect")
}

fn still(engine: &dyn Engine, design: &Arc<Design>, request: &StillRequest) -> Still {
    let plan = engine::reference().plan(request, Subject::Cloth);
    let shot = engine::Shot::new(request, plan.expect("a plan")).expect("a shot");
    engine::draw(engine, design, &shot, &Job::new(), &mut |_| {}).expect("a still")
}

/// Mean luminance of the picture.
fn light(engine: &dyn Engine, design: &Arc<Design>, request: &StillRequest) -> f64 {
    still(engine, design, request).film.mean_luminance().0
}

#[test]
fn what_there_is_nothing_of_is_left_out_and_all_else_only_with_leave() {
    let design = design("silk-satin");
    let asked = request("sun");
    let (_, exact, needs) = settled(&design, &asked, 0.0);
    for effect in [Effect::Hairs, Effect::Sky] {
        let need = need(&needs, effect);
        assert!(!need.on && need.by == Decider::Scene && need.bound == Some(0.0));
    }
    assert!(need(&needs, Effect::Shadows).on && need(&needs, Effect::Multiple).on);
    assert_eq!((needs.left_out, needs.saved), (0.0, 0.0));
    assert_eq!(exact.settings, asked.settings);
    // The picture is the same to the last bit.
    let (engine, ..) = settled(&design, &asked, 0.0);
    let same = [&asked, &exact].map(|request| light(&*engine, &design, request));
    assert_eq!(same[0].to_bits(), same[1].to_bits());
    // What somebody asks for by name stays.
    let mut named = asked.clone();
    named.effects.changes.push((Effect::Sky, true));
    let (.., needs) = settled(&design, &named, 0.5);
    assert!(need(&needs, Effect::Sky).on && need(&needs, Effect::Sky).by == Decider::Person);
}

#[test]
fn what_is_left_out_is_within_its_bound() {
    let design = design("silk-satin");
    let asked = request("day");
    let (engine, followed, needs) = settled(&design, &asked, 0.05);
    let order = followed.settings.render.max_order;
    assert!(order > 1 && order < asked.settings.render.max_order);
    assert!(needs.left_out > 0.0 && needs.left_out <= 0.05, "{needs:?}");
    assert!(needs.saved > 0.0 && need(&needs, Effect::Shadows).on);
    let with_order = |order| {
        let mut request = asked.clone();
        request.settings.render.max_order = order;
        light(&*engine, &design, &request)
    };
    let all = with_order(asked.settings.render.max_order);
    // Blocks that are looked at most leave out less than the bound: so does their mean. Both
    // pictures follow the same paths until one of them ends.
    let lost = 1.0 - with_order(order) / all;
    assert!(lost < 0.05 + 0.01, "{lost}");
    // The control: single scattering leaves out much more, and is not allowed.
    let single = 1.0 - with_order(1) / all;
    assert!(single > 0.1, "{single}");
    // Nothing of it is up to chance.
    let (_, again, _) = settled(&design, &asked, 0.05);
    assert_eq!(again, followed);
    // The order is the least that will do: with less leave, it is larger.
    let (_, closer, _) = settled(&design, &asked, 0.01);
    assert!(closer.settings.render.max_order > order);
}

/// A scene that nobody chose: a design, near or far, in any light.
fn scene(number: u64) -> (Arc<Design>, StillRequest, f64) {
    let mut random = Random::new(60, number, 0);
    let mut below = |sides: usize| (random.bits() % sides as u64) as usize;
    let names: Vec<&str> = presets::names().collect();
    // Each preset in turn, and each light.
    let design = design(names[number as usize % names.len()]);
    let asked = StillRequest {
        view: View::ALL[below(View::ALL.len())],
        width_mm: Some([1.5, 4.0, 10.0, 30.0, 90.0][below(5)]),
        seed: number,
        ..request(PRESET_NAMES[number as usize % PRESET_NAMES.len()])
    };
    let tolerance = [0.005, 0.01, 0.02, 0.05][below(4)];
    (design, asked, tolerance)
}

/// What a picture lacks of another of the same paths, block by block of 8 × 8 pixels, relative
/// to the light there.
fn lacks(all: &Still, some: &Still) -> Vec<f64> {
    const DARK: f64 = 0.01;
    let (width, height) = (all.film.width(), all.film.height());
    let mut lacks = Vec::new();
    for y in (0..height).step_by(8) {
        for x in (0..width).step_by(8) {
            let of = |still: &Still| -> f64 {
                let pixels = (0..8).flat_map(|down| (0..8).map(move |right| (right, down)));
                let light = pixels.map(|(right, down)| still.film.pixel(x + right, y + down));
                light.map(|pixel| pixel.luminance()).sum::<f64>() / 64.0
            };
            let (all, some) = (of(all), of(some));
            lacks.push((all - some).abs() / (all + DARK));
        }
    }
    lacks
}

/// What the 95th percentile is above of, in 95 of 100 samples: an order statistic.
fn lower_percentile(values: &[f64]) -> f64 {
    let mut values = values.to_vec();
    values.sort_by(f64::total_cmp);
    let (n, p) = (values.len(), 0.95f64);
    // The chance that fewer than k of them lie below the percentile.
    let mut chance = (1.0 - p).powi(n as i32);
    let mut below = 0.0;
    for k in 0..n {
        if below + chance > 0.05 {
            return values[k.saturating_sub(1)];
        }
        below += chance;
        chance *= (n - k) as f64 / (k + 1) as f64 * p / (1.0 - p);
    }
    values[n - 1]
}

#[test]
fn a_percentile_is_above_its_lower_limit_as_often_as_is_said() {
    let holds = (0..400u64).filter(|sample| {
        let mut random = Random::new(4, *sample, 0);
        let values: Vec<f64> = (0..48).map(|_| random.uniform().into()).collect();
        lower_percentile(&values) <= 0.95
    });
    let holds = holds.count();
    assert!((370..400).contains(&holds), "{holds} of 400");
}

#[test]
fn bounds_hold_in_scenes_that_nobody_chose() {
    let count = match std::env::var_os("PICKGLASS_LONG") {
        Some(_) => 60,
        None => 2,
    };
    let mut faster = 0;
    for number in 0..count {
        let (design, asked, tolerance) = scene(number);
        let (engine, followed, needs) = settled(&design, &asked, tolerance);
        assert!(needs.left_out <= tolerance, "{number}: {needs:?}");
        // The same paths, until one of them ends.
        let all = still(&*engine, &design, &asked);
        let some = still(&*engine, &design, &followed);
        let limit = lower_percentile(&lacks(&all, &some));
        let seconds = [&all, &some].map(|still| still.report.total_seconds);
        println!(
            "{number} {} {:?} {}: {limit:.4} of {:.4}, tolerance {tolerance}, {:.2} times faster",
            design.name,
            asked.view,
            asked.width_mm.unwrap_or_default(),
            needs.left_out,
            seconds[0] / seconds[1]
        );
        assert!(
            limit <= needs.left_out + 1e-6,
            "{number}: {limit} {needs:?}"
        );
        faster += usize::from(seconds[0] > 1.5 * seconds[1]);
        if number == 0 {
            // The control: whoever leaves out shadows leaves out more than any tolerance.
            let mut forced = followed.clone();
            forced.effects.changes.push((Effect::Shadows, false));
            let forced = still(&*engine, &design, &forced);
            assert!(lower_percentile(&lacks(&all, &forced)) > 0.05);
        }
    }
    println!("{faster} of {count} are half as fast again");
}

#[test]
fn what_is_off_is_no_work() {
    let design = design("tweed");
    let mut asked = request("day");
    asked.settings = asked.settings.at_level(3);
    let counted = |off: &[Effect]| -> Counters {
        let mut request = asked.clone();
        (request.effects.changes).extend(off.iter().map(|effect| (*effect, false)));
        let (renderer, job) = (engine::reference(), Job::new());
        let engine = renderer
            .engine(&design, &request, &ExemplarStore::user(), &job)
            .expect("cloth");
        let plan = renderer.plan(&request, Subject::Cloth).expect("a plan");
        let shot = engine::Shot::new(&request, plan).expect("a shot");
        let corners = [[0, 0], [16, 8], [32, 24]];
        let seen = engine.look_at(&shot, &corners, 16, &job).expect("a look");
        seen.expect("it follows paths").counters
    };
    let all = counted(&[]);
    assert!(all.shadow_rays > 0 && all.scatterings > all.paths);
    assert_eq!(counted(&[Effect::Shadows]).shadow_rays, 0);
    let single = counted(&[Effect::Multiple]);
    assert!(single.scatterings <= single.paths);
    // Whatever is met counts as one lookup: hairs are a medium of their own.
    assert!(counted(&[Effect::Hairs]).lookups < all.lookups);
    let none = counted(Effect::ALL);
    assert!(none.shadow_rays == 0 && none.scatterings <= none.paths);
}

#[test]
fn pictures_with_and_without_an_effect_are_alike_but_for_it() {
    let (design, asked) = (design("silk-satin"), request("sun"));
    let (renderer, store, job) = (engine::reference(), ExemplarStore::user(), Job::new());
    let look = || {
        let looked = needs::survey_in_pictures(&design, renderer, &asked, 0.01, &store, &job);
        looked.expect("looked at").2
    };
    let pairs = look();
    let of = |effect| pairs.iter().find(|pair| pair.effect == effect);
    // Silk has no hairs, and this light no sky: there is nothing to be seen of them.
    assert!(of(Effect::Hairs).is_none() && of(Effect::Sky).is_none());
    for pair in &pairs {
        let size = |picture: &pickglass::film::Picture| (picture.width, picture.height);
        assert_eq!(size(&pair.with), (64, 48));
        assert_eq!(size(&pair.without), (64, 48));
    }
    // Without shadows it is brighter, by more than an eye overlooks.
    let mean = |picture: &pickglass::film::Picture| {
        let pixels = picture.pixels.iter();
        pixels.map(|[_, green, ..]| f64::from(*green)).sum::<f64>() / picture.pixels.len() as f64
    };
    let shadows = of(Effect::Shadows).expect("shadows");
    assert!(mean(&shadows.without) > mean(&shadows.with) + 0.02);
    // The control: the same picture taken anew is the same, so that all else is the effect's.
    assert_eq!(look()[0].with, pairs[0].with);
}
