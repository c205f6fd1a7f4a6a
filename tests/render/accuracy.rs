//! What accuracy costs: curves that theory knows, references, going on, and measurements that
//! would be wrong.

use std::sync::Arc;

use pickglass::accuracy::{
    self, Accuracy, AccuracyError, Asked, Axis, Curve, Effort, Measuring, Point,
};
use pickglass::design::Design;
use pickglass::engine::{self, StillRequest, Stop};
use pickglass::exemplar::ExemplarStore;
use pickglass::job::Job;
use pickglass::plan::Measure;
use pickglass::presets;

fn design() -> Arc<Design> {
    Arc::new(
        presets::design("default")
            .expect("a name")
            .expect("a design"),
    )
}

fn asked() -> Asked {
    Asked {
        request: StillRequest {
            width: 48,
            height: 36,
            width_mm: Some(3.0),
            stop: Stop {
                spp: Some(8),
                ..Stop::default()
            },
            ..StillRequest::default()
        },
        renderer: engine::reference(),
    }
}

fn measuring(names: &[&str]) -> Measuring {
    Measuring {
        asked: asked(),
        effort: Effort::Quick,
        axes: names
            .iter()
            .map(|name| Axis::named(name).expect(name))
            .collect(),
        before: None,
    }
}

fn measured(names: &[&str]) -> Accuracy {
    let (store, job) = (ExemplarStore::user(), Job::new());
    accuracy::measure(&design(), &measuring(names), &store, &job, &mut |_, _| {
        Ok(())
    })
    .expect("measured")
}

fn curve<'a>(accuracy: &'a Accuracy, name: &str) -> &'a Curve {
    let found = accuracy.dials.iter().find(|curve| curve.name == name);
    found.expect(name)
}

fn point<'a>(accuracy: &'a Accuracy, name: &str, value: &str) -> &'a Point {
    curve(accuracy, name).point(value).expect(value)
}

/// Whether an error is no larger than another, as far as both are known.
fn no_larger(one: &Point, other: &Point) -> bool {
    let [low, _] = one.error_interval.unwrap_or([one.error; 2]);
    let [_, high] = other.error_interval.unwrap_or([other.error; 2]);
    low <= high
}

/// What theory says of curves, of those that are there; the first thing that is not so.
fn what_theory_says(accuracy: &Accuracy) -> Result<(), String> {
    let all = |name: &str| {
        let known = accuracy.dials.iter().find(|curve| curve.name == name);
        known.map_or(&[][..], |curve| &curve.settings)
    };
    let says = |holds: bool, what: &str| match holds {
        true => Ok(()),
        false => Err(what.to_owned()),
    };
    // A reference is not wrong against itself.
    for curve in &accuracy.dials {
        let last = &curve.settings[curve.settings.len() - 1];
        let is_none = curve.measure != Measure::Bias || last.error == 0.0;
        says(is_none, &format!("{}: its reference is wrong", curve.name))?;
        let sound = |point: &Point| point.seconds > 0.0 && point.error >= 0.0;
        says(
            curve.settings.iter().all(sound),
            "times and errors are no numbers",
        )?;
    }
    // Each further scattering brings light that was missing before.
    let order = all("order");
    for pair in order.windows(2) {
        says(no_larger(&pair[1], &pair[0]), &format!("order: {pair:?}"))?;
    }
    if let [first, ..] = order {
        says(first.error > 0.1, "single scattering alone is dark")?;
    }
    // Paths are independent: noise falls with the root of their number. What is predicted takes
    // as much longer as there are more of them, but for what no path takes.
    let paths = |point: &Point| point.value.parse::<f64>().unwrap_or(f64::NAN);
    for pair in all("spp").windows(2) {
        let times = paths(&pair[1]) / paths(&pair[0]);
        let ratio = pair[0].error / pair[1].error / times.sqrt();
        says(
            (ratio - 1.0).abs() < 0.25,
            &format!("spp: {ratio} {pair:?}"),
        )?;
        let longer = pair[1].seconds / pair[0].seconds / times;
        let is_so = pair[0].measured || (0.5..1.01).contains(&longer);
        says(is_so, &format!("spp: {longer} {pair:?}"))?;
    }
    // The method that finds the optimum is no worse than the others, a closer rank or patch
    // than a coarser one.
    for (name, slack) in [("method", 1.0), ("rank", 1.001), ("seams", 0.5)] {
        let falls = (all(name).windows(2)).all(|pair| pair[1].error <= pair[0].error * slack);
        says(falls, &format!("{name}: {:?}", all(name)))?;
    }
    if let [never, .., always] = all("patch") {
        says(
            never.error == 1.0,
            "without patches each repeat is the next",
        )?;
        says(always.error < 0.6, "patches leave repeats")?;
    }
    // Rounding to steps of 1/255 loses 1/√12 of a step.
    if let [eight, ..] = all("png-bits") {
        let steps = eight.error * 255.0 * 12f64.sqrt();
        says((steps - 1.0).abs() < 0.1, &format!("png-bits: {steps}"))?;
    }
    Ok(())
}

/// Makes a measurement wrong.
type Spoil = fn(&mut Accuracy);

#[test]
fn curves_fall_where_theory_says_so() {
    let accuracy = measured(&[
        "method", "rank", "seams", "patch", "order", "spp", "png-bits",
    ]);
    assert_eq!(what_theory_says(&accuracy), Ok(()));
    let order = &curve(&accuracy, "order").settings;
    assert!(order[0].delta_e > order[3].delta_e, "{order:?}");
    let method = &curve(&accuracy, "method").settings;
    assert!(method[0].error > method[2].error + 0.01, "{method:?}");
    // How many are measured depends on the machine: the first two are on any.
    let spp = &curve(&accuracy, "spp").settings;
    let measured = spp.iter().filter(|point| point.measured).count();
    assert!(measured >= 2, "{spp:?}");
    assert!(!point(&accuracy, "spp", "4096").measured);

    // Measurements that are deliberately wrong are noticed, each by what it gets wrong.
    let wrong: [(&str, &str, Spoil); 6] = [
        ("order", "two settings exchanged", |accuracy| {
            let settings = &mut of(accuracy, "order").settings;
            let [one, other] = [settings[0].clone(), settings[4].clone()];
            (settings[0].error, settings[0].error_interval) = (other.error, other.error_interval);
            (settings[4].error, settings[4].error_interval) = (one.error, one.error_interval);
        }),
        ("reference", "held against another picture", |accuracy| {
            for point in &mut of(accuracy, "order").settings {
                point.error += 0.02;
            }
        }),
        ("spp", "noise as if paths were one", |accuracy| {
            for point in &mut of(accuracy, "spp").settings {
                point.error *= point.error;
            }
        }),
        ("spp", "the time of one path for all", |accuracy| {
            let settings = &mut of(accuracy, "spp").settings;
            let one = settings[0].seconds;
            settings.iter_mut().for_each(|point| point.seconds = one);
        }),
        (
            "method",
            "the crude end taken for the reference",
            |accuracy| {
                of(accuracy, "method").settings.reverse();
            },
        ),
        ("png-bits", "a wrong number of steps", |accuracy| {
            of(accuracy, "png-bits").settings[0].error *= 2.0;
        }),
    ];
    for (told, what, spoil) in wrong {
        let mut spoiled = accuracy.clone();
        spoil(&mut spoiled);
        let said = what_theory_says(&spoiled).expect_err(what);
        assert!(said.contains(told), "{what}: {said}");
    }
}

fn of<'a>(accuracy: &'a mut Accuracy, name: &str) -> &'a mut Curve {
    let found = accuracy.dials.iter_mut().find(|curve| curve.name == name);
    found.expect(name)
}

#[test]
fn what_changes_no_expectation_changes_the_noise_alone() {
    let accuracy = measured(&["roulette-order", "shadow-roulette", "pass-spp"]);
    for name in ["roulette-order", "shadow-roulette"] {
        let settings = &curve(&accuracy, name).settings;
        let (crude, reference) = (&settings[0], &settings[settings.len() - 1]);
        assert!(crude.error > 0.0 && reference.error > 0.0, "{settings:?}");
        assert!(no_larger(reference, crude), "{settings:?}");
    }
    // How often one looks at the picture does not change it: bit for bit.
    let errors = curve(&accuracy, "pass-spp")
        .settings
        .iter()
        .map(|point| point.error);
    let errors: Vec<f64> = errors.collect();
    assert!(errors.iter().all(|error| *error == errors[0]), "{errors:?}");
    assert!(errors[0] > 0.01, "{errors:?}");
}

#[test]
fn engines_and_denoising_are_told_against_what_the_picture_converges_to() {
    let accuracy = measured(&["denoise", "renderer", "hairs", "tap"]);
    let sight = point(&accuracy, "renderer", "sight");
    let cpu = point(&accuracy, "renderer", "cpu");
    assert!(
        sight.seconds < cpu.seconds && sight.error > 0.05,
        "{sight:?} {cpu:?}"
    );
    assert!(sight.delta_e > Some(1.0), "{sight:?}");
    let [off, on] = ["off", "on"].map(|value| point(&accuracy, "denoise", value));
    assert!(on.error < off.error, "{off:?} {on:?}");
    assert_eq!(curve(&accuracy, "tap").measure, Measure::Bias);
    assert!(point(&accuracy, "tap", "off").error > 0.0);
}

#[test]
fn measuring_goes_on_from_what_is_there_and_stops_when_it_is_cancelled() {
    let (store, job) = (ExemplarStore::user(), Job::new());
    let mut first = measuring(&["order", "method", "pass-spp"]);
    let mut kept: Option<Accuracy> = None;
    let stopped = accuracy::measure(&design(), &first, &store, &job, &mut |so_far, crops| {
        assert_eq!(
            crops.len(),
            so_far.dials.last().expect("a dial").settings.len()
        );
        kept = Some(so_far.clone());
        job.cancel();
        Ok(())
    });
    assert!(matches!(stopped, Err(AccuracyError::Cancelled(_))));
    let kept = kept.expect("one dial");
    assert_eq!(kept.dials.len(), 1);
    let anew = |measuring: &Measuring| {
        let mut names = Vec::new();
        let job = Job::new();
        accuracy::measure(&design(), measuring, &store, &job, &mut |so_far, _| {
            names.push(so_far.dials.last().expect("a dial").name.clone());
            Ok(())
        })
        .expect("measured");
        names
    };
    first.before = Some(kept.clone());
    assert_eq!(anew(&first), ["method", "pass-spp"]);
    // Another picture has nothing in common with it.
    first.asked.request.width_mm = Some(4.0);
    assert_eq!(anew(&first), ["order", "method", "pass-spp"]);
    // What changes nothing is refused by name.
    let idle = measuring(&["level-correction"]);
    let refused = accuracy::measure(&design(), &idle, &store, &Job::new(), &mut |_, _| Ok(()));
    let refused = refused.expect_err("level 0 has none").to_string();
    assert!(refused.contains("level-correction"), "{refused}");
}
