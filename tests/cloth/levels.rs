//! Coarse levels show as much light as level 0, and let as much through; what averaging
//! alone does is the control.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

use std::sync::Arc;

use pickglass::design::Sett;
use pickglass::engine::{self, StillRequest, Stop};
use pickglass::exemplar::ExemplarStore;
use pickglass::job::Job;
use pickglass::plan::{Settings, dial};
use pickglass::presets;

/// Mean radiance and coverage of a design.
fn shown(name: &str, level: u32, corrected: bool) -> [f64; 2] {
    let design = Arc::new(presets::design(name).unwrap().unwrap());
    let mut settings = Settings::default().at_level(level);
    settings.cloth.correct_levels = corrected;
    let request = StillRequest {
        width: 56,
        height: 56,
        width_mm: Some(6.0),
        settings,
        stop: Stop {
            spp: Some(24),
            ..Stop::default()
        },
        ..StillRequest::default()
    };
    let cloth = engine::prepare(&design, &request, &ExemplarStore::user(), &Job::new()).unwrap();
    let still = engine::render(&cloth, &request, &Job::new(), &mut |_| {}).unwrap();
    assert_eq!(still.report.majorant_violations, 0);
    let pixels = still.film.pixels();
    let count = pixels.len() as f64;
    let light = |pixel: &pickglass::film::Pixel| f64::from(pixel.mean().element_sum()) / 3.0;
    [
        pixels.iter().map(light).sum::<f64>() / count,
        (pixels.iter().map(|pixel| f64::from(pixel.alpha()))).sum::<f64>() / count,
    ]
}

#[test]
fn coarse_levels_keep_light_and_coverage() {
    // A shirting whose gaps are seen. The picture's own noise is half a percent.
    let [light, cover] = shown("oxford", 0, true);
    for (level, least_light, least_cover) in [(1, 0.012, 0.004), (2, 0.04, 0.008), (3, 0.06, 0.02)]
    {
        let off = |[coarse, covered]: [f64; 2]| [coarse / light - 1.0, covered - cover];
        let averaged = off(shown("oxford", level, false));
        let corrected = off(shown("oxford", level, true));
        println!("level {level}: averaged {averaged:.4?}, corrected {corrected:.4?}");
        assert!(corrected[0].abs() < 0.028, "{corrected:?}");
        assert!(corrected[0].abs() < 0.3 * averaged[0], "level {level}");
        assert!(corrected[1].abs() < 0.006, "{corrected:?}");
        assert!(
            averaged[0] > least_light && averaged[1] > least_cover,
            "{averaged:?}"
        );
        assert!(corrected[1].abs() < 0.5 * averaged[1], "level {level}");
    }
}

#[test]
fn a_coarse_cloth_says_how_far_its_light_is_off() {
    let of = |sett: Sett, dials: &[(&str, &str)]| {
        let design = presets::design("linen-plain").unwrap().unwrap();
        let design = design.with_sett(sett).unwrap();
        let mut settings = Settings::default();
        for (name, value) in dials {
            dial(name).unwrap().turn(&mut settings, value).unwrap();
        }
        let request = StillRequest {
            width: 8,
            height: 8,
            width_mm: Some(2.0),
            settings,
            stop: Stop {
                spp: Some(1),
                ..Stop::default()
            },
            ..StillRequest::default()
        };
        let store = ExemplarStore::user();
        let cloth = engine::prepare(&Arc::new(design), &request, &store, &Job::new()).unwrap();
        let report = engine::render(&cloth, &request, &Job::new(), &mut |_| {})
            .unwrap()
            .report;
        assert_eq!(report.light_error, cloth.cloth().light_error());
        (report.level, report.light_error)
    };
    let same = Sett::per_cm(33.0, 32.0);
    assert_eq!(of(same.clone(), &[("level", "0")]), (0, Some(0.0)));
    let (level, error) = of(same.clone(), &[("level", "3")]);
    assert!(
        level == 3 && (0.001..0.03).contains(&error.unwrap()),
        "{error:?}"
    );
    // Averaging alone was not measured, nor were yarns of another size.
    let averaged = [("level", "3"), ("level-correction", "off")];
    assert_eq!(of(same.clone(), &averaged), (3, None));
    let other = Sett::per_cm(25.0, 28.0);
    assert_eq!(of(other, &[("level", "3")]), (3, None));
}
