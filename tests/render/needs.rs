//! What a picture calls for: bounds that hold, and work that is not done.

use std::sync::Arc;

use pickglass::design::Design;
use pickglass::engine::{self, Engine, LightChoice, StillRequest, Stop};
use pickglass::exemplar::ExemplarStore;
use pickglass::job::Job;
use pickglass::needs::{self, Need, Needs};
use pickglass::plan::{Decider, Effect};
use pickglass::presets;

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

/// Mean luminance of the picture.
fn light(engine: &dyn Engine, design: &Arc<Design>, request: &StillRequest) -> f64 {
    let plan = engine::reference().plan(request, pickglass::plan::Subject::Cloth);
    let shot = engine::Shot::new(request, plan.expect("a plan")).expect("a shot");
    let still = engine::draw(engine, design, &shot, &Job::new(), &mut |_| {}).expect("a still");
    let pixels = still.film.pixels();
    pixels.iter().map(|pixel| pixel.luminance()).sum::<f64>() / pixels.len() as f64
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
