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

#[test]
fn curves_fall_where_theory_says_so() {
    let accuracy = measured(&["method", "rank", "patch", "order", "spp", "png-bits"]);
    // Each further scattering brings light that was missing before.
    let order = &curve(&accuracy, "order").settings;
    for pair in order.windows(2) {
        assert!(no_larger(&pair[1], &pair[0]), "{pair:?}");
    }
    assert!(
        order[0].error > 0.1,
        "single scattering alone is dark: {:?}",
        order[0]
    );
    assert!(order[0].delta_e > order[3].delta_e, "{order:?}");
    assert_eq!(point(&accuracy, "order", "1024").error, 0.0);
    // Paths are independent: noise falls with the root of their number. How many are measured
    // depends on the machine: the first two are on any.
    let measured: Vec<&Point> = (curve(&accuracy, "spp").settings.iter())
        .filter(|point| point.measured)
        .collect();
    assert!(measured.len() >= 2, "{measured:?}");
    for pair in measured.windows(2) {
        let [few, many]: [f64; 2] = [0, 1].map(|at: usize| pair[at].value.parse().expect("paths"));
        let times = many / few;
        let ratio = pair[0].error / pair[1].error / times.sqrt();
        assert!((ratio - 1.0).abs() < 0.25, "{pair:?}: {ratio}");
    }
    assert!(!point(&accuracy, "spp", "4096").measured);
    // The method that finds the optimum is no worse than the others.
    let method = &curve(&accuracy, "method").settings;
    assert!(method[2].error <= method[1].error && method[1].error <= method[0].error);
    assert!(method[0].error > method[2].error + 0.01, "{method:?}");
    let seams: Vec<f64> = curve(&accuracy, "rank")
        .settings
        .iter()
        .map(|p| p.error)
        .collect();
    assert!(
        seams.windows(2).all(|pair| pair[1] <= pair[0] * 1.001),
        "{seams:?}"
    );
    assert_eq!(
        point(&accuracy, "patch", "0").error,
        1.0,
        "each repeat is the next"
    );
    assert!(point(&accuracy, "patch", "3").error < 0.6);
    // Rounding to steps of 1/255 loses 1/√12 of a step.
    let rounding = point(&accuracy, "png-bits", "8").error;
    assert!(
        (rounding * 255.0 * 12f64.sqrt() - 1.0).abs() < 0.1,
        "{rounding}"
    );
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
