//! Every engine of the table makes every kind of picture.

use std::sync::Arc;

use pickglass::design::Sett;
use pickglass::engine::{
    LightChoice, Pass, RENDERERS, StillRequest, Stop, reference, render_sheet, render_still,
    renderer,
};
use pickglass::exemplar::ExemplarStore;
use pickglass::film::Picture;
use pickglass::job::Job;
use pickglass::presets;
use pickglass::render::Backing;
use pickglass::scene::View;

fn request() -> StillRequest {
    StillRequest {
        width: 40,
        height: 30,
        width_mm: Some(6.0),
        light: LightChoice::Preset("day".to_owned()),
        stop: Stop {
            spp: Some(4),
            ..Stop::default()
        },
        ..StillRequest::default()
    }
}

/// Mean display value of a picture.
fn mean(picture: &Picture) -> f64 {
    let values = picture.pixels.iter().flat_map(|pixel| &pixel[..3]);
    values.map(|value| f64::from(*value)).sum::<f64>() / (3.0 * picture.pixels.len() as f64)
}

#[test]
fn every_engine_makes_stills_sheets_and_exr() {
    let folder = tempfile::tempdir().unwrap();
    let design = Arc::new(presets::design("herringbone").unwrap().unwrap());
    let (request, job, store) = (request(), Job::new(), ExemplarStore::user());
    let mut brightness = Vec::new();
    for renderer in RENDERERS {
        let mut last = Vec::new();
        let mut keep = |pass: &Pass<'_>| last = pass.rgba();
        let still = render_still(&design, &request, renderer, &job, &mut keep).unwrap();
        assert_eq!(still.report.renderer, renderer.name);
        // What is kept is what was seen last.
        let pixels = still.picture().pixels;
        let byte = |value: f32| (value.clamp(0.0, 1.0) * 255.0).round() as u8;
        let kept: Vec<u8> = pixels.iter().flat_map(|pixel| pixel.map(byte)).collect();
        assert!(kept == last, "{} is kept as it was not seen", renderer.name);
        assert!(still.report.total_seconds > 0.0);
        brightness.push(mean(&still.picture()));
        for file in ["a.png", "a.exr"] {
            let path = folder.path().join(file);
            still.save(&path).unwrap();
            assert!(std::fs::metadata(&path).unwrap().len() > 500, "{file}");
        }
        let mut seen = Vec::new();
        let sheet = render_sheet(
            &design,
            &request,
            renderer,
            &store,
            &job,
            &mut |at, _, pass| {
                seen.push((at, pass.rgba().len()));
            },
        );
        let sheet = sheet.unwrap();
        assert_eq!(sheet.report.renderer, renderer.name);
        assert_eq!(sheet.places.len(), 4);
        assert!(sheet.places[1..].iter().all(|place| place.recoloured));
        // Each picture was seen on its way, whole.
        assert!(
            (0..4).all(|at| seen.contains(&(at, 40 * 30 * 4))),
            "{seen:?}"
        );
    }
    // They draw the same cloth.
    let traced = brightness[0];
    for other in &brightness {
        assert!((traced / other - 1.0).abs() < 0.25, "{brightness:?}");
    }
    assert_eq!(RENDERERS[0], reference());
}

/// What lies behind open cloth is seen through its gaps, by first sight as well.
#[test]
fn gaps_show_what_lies_behind() {
    let open = Sett::per_cm(8.0, 8.0);
    let design = presets::design("herringbone").unwrap().unwrap();
    let design = Arc::new(design.with_sett(open).unwrap());
    let sight = renderer("sight").unwrap();
    let seen = |backing, view| {
        let request = StillRequest {
            backing,
            view,
            ..request()
        };
        let still = render_still(&design, &request, sight, &Job::new(), &mut |_| {}).unwrap();
        let alpha = |pixel: &[f32; 4]| pixel[3];
        let picture = still.picture();
        let least = picture.pixels.iter().map(alpha).fold(1.0, f32::min);
        (least, mean(&picture))
    };
    for view in [View::Face, View::Oblique] {
        let (nothing, _) = seen(Backing::None, view);
        assert_eq!(nothing, 0.0, "the control: gaps are open");
        let backed = [Backing::White, Backing::Itself, Backing::Black].map(|b| seen(b, view));
        assert!(backed.iter().all(|(least, _)| *least == 1.0), "{backed:?}");
        let [white, itself, black] = backed.map(|(_, mean)| mean);
        assert!(white > itself && itself > black, "{backed:?}");
    }
}
