//! Colourways: documents that hold them, cloth that is only recoloured, sheets of all.

#![allow(clippy::unwrap_used, reason = "a test may fail")]

use std::path::Path;
use std::sync::Arc;

use pickglass::design::{Colourway, Design, Family, Srgb, Yarn};
use pickglass::engine::{
    AS_DESIGNED, StillRequest, Stop, prepare, reference, render, render_sheet,
};
use pickglass::exemplar::ExemplarStore;
use pickglass::formats::ron;
use pickglass::job::Job;
use pickglass::presets;

fn herringbone() -> Design {
    presets::design("herringbone").unwrap().unwrap()
}

fn request() -> StillRequest {
    StillRequest {
        width: 24,
        height: 16,
        width_mm: Some(1.2),
        seed: 7,
        stop: Stop {
            spp: Some(2),
            ..Stop::default()
        },
        ..StillRequest::default()
    }
}

#[test]
fn documents_hold_colourways_and_old_ones_keep_every_byte() {
    let design = herringbone();
    assert_eq!(design.colourways().len(), 3);
    let text = ron::write(&design).unwrap();
    assert_eq!(ron::read(text.as_bytes(), "x").unwrap(), design);
    let none = design.clone().with_colourways(Vec::new()).unwrap();
    assert_ne!(none, design);
    let text = ron::write(&none).unwrap();
    assert!(!text.contains("colourways"), "{text}");
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("presets/designs");
    for name in ["oxford", "denim", "damask", "default"] {
        let old = std::fs::read_to_string(folder.join(format!("{name}.ron"))).unwrap();
        let read = ron::read(old.as_bytes(), name).unwrap();
        assert_eq!(ron::write(&read).unwrap(), old, "{name}");
    }
}

#[test]
fn a_colourway_changes_the_yarns_and_nothing_else() {
    let design = herringbone();
    let autumn = design.clone().with_colourway(" Autumn ").unwrap();
    assert_eq!(autumn.yarns()[1].name, "rust");
    assert_eq!(autumn.structure(), design.structure());
    assert_eq!(autumn.maps(), design.maps());
    assert_ne!(autumn, design);
    let back = autumn.with_colourway("granite").unwrap();
    assert_eq!(back.yarns()[0].name, "charcoal");
}

#[test]
fn colourways_that_do_not_fit_are_refused_in_a_line() {
    let design = herringbone();
    let message = |colourways: Vec<Colourway>| {
        let error = design.clone().with_colourways(colourways).unwrap_err();
        let text = error.to_string();
        assert_eq!(text.lines().count(), 1);
        text
    };
    let named = |name: &str, count: usize| Colourway {
        name: name.to_owned(),
        yarns: vec![Yarn::new("y", Family::Cotton, Srgb(1, 2, 3)); count],
    };
    assert!(message(vec![named("one", 1)]).contains("1 yarns where the design has 2"));
    assert!(message(vec![named(" ", 2)]).contains("empty"));
    assert!(message(vec![named("ALL", 2)]).contains("all colourways"));
    assert!(message(vec![named("a", 2), named("A ", 2)]).contains("taken"));
    assert!(message(vec![named("a", 2); 300]).contains("too many"));
    let mut odd = named("odd", 2);
    odd.yarns[1].tex = Some(f32::NAN);
    assert!(message(vec![odd]).contains("tex is NaN"));
    let unknown = design
        .clone()
        .with_colourway("spring")
        .unwrap_err()
        .to_string();
    assert!(unknown.contains("night, autumn, granite"), "{unknown}");
    let oxford = presets::design("oxford").unwrap().unwrap();
    let unknown = oxford.with_colourway("spring").unwrap_err().to_string();
    assert!(unknown.contains("its own yarns only"), "{unknown}");
    // Yarns cannot be taken from under the colourways.
    let yarns = vec![Yarn::new("y", Family::Cotton, Srgb(1, 2, 3)); 3];
    assert!(
        design
            .clone()
            .with_yarns(yarns, design.maps().clone())
            .is_err()
    );
    let text = ron::write(&design).unwrap().replacen("#b5562b", "rust", 1);
    let damaged = ron::read(text.as_bytes(), "x.ron").unwrap_err().to_string();
    assert!(damaged.contains("#rrggbb"), "{damaged}");
}

#[test]
fn recolouring_gives_what_making_anew_gives() {
    let folder = tempfile::tempdir().unwrap();
    let store = ExemplarStore::at(folder.path(), 1 << 30);
    let job = Job::new();
    let design = Arc::new(herringbone());
    let mut cloth = prepare(&design, &request(), &store, &job).unwrap();
    let base = render(&cloth, &request(), &job, &mut |_| ())
        .unwrap()
        .picture();
    let night = StillRequest {
        colourway: Some("night".to_owned()),
        ..request()
    };
    let anew = prepare(&design, &night, &store, &job).unwrap();
    let anew = render(&anew, &night, &job, &mut |_| ()).unwrap().picture();
    let mut coloured = Design::clone(&design).with_colourway("night").unwrap();
    assert!(cloth.recolour(&Arc::new(coloured.clone())));
    let recoloured = render(&cloth, &request(), &job, &mut |_| ())
        .unwrap()
        .picture();
    assert!(recoloured == anew, "recoloured and made anew differ");
    assert!(recoloured != base, "the colourway shows");
    // Gloss is looked up too; another family or size is another cloth.
    let shiny = |change: &dyn Fn(&mut Yarn)| {
        let mut yarns = coloured.yarns().to_vec();
        change(&mut yarns[0]);
        Arc::new(
            coloured
                .clone()
                .with_yarns(yarns, coloured.maps().clone())
                .unwrap(),
        )
    };
    let glossy = shiny(&|yarn| yarn.gloss = Some(0.05));
    let (silk, thick) = (
        shiny(&|yarn| yarn.family = Family::Silk),
        shiny(&|yarn| yarn.tex = Some(60.0)),
    );
    assert!(!cloth.recolour(&silk) && !cloth.recolour(&thick));
    assert!(cloth.recolour(&glossy));
    let bright = render(&cloth, &request(), &job, &mut |_| ())
        .unwrap()
        .picture();
    assert!(bright != recoloured, "gloss shows");
    coloured = Design::clone(&glossy);
    let anew = prepare(&Arc::new(coloured), &request(), &store, &job).unwrap();
    let anew = render(&anew, &request(), &job, &mut |_| ())
        .unwrap()
        .picture();
    assert!(bright == anew, "gloss is that of a cloth made anew");
}

#[test]
fn a_sheet_shows_every_colourway_in_its_place() {
    let folder = tempfile::tempdir().unwrap();
    let store = ExemplarStore::at(folder.path(), 1 << 30);
    let job = Job::new();
    let design = Arc::new(herringbone());
    let sheet = render_sheet(
        &design,
        &request(),
        reference(),
        &store,
        &job,
        &mut |_, _, _| (),
    )
    .unwrap();
    let names: Vec<&str> = sheet
        .places
        .iter()
        .map(|place| place.name.as_str())
        .collect();
    assert_eq!(names, [AS_DESIGNED, "night", "autumn", "granite"]);
    let recoloured: Vec<bool> = sheet.places.iter().map(|place| place.recoloured).collect();
    assert_eq!(recoloured, [false, true, true, true]);
    assert_eq!(
        (sheet.report.width, sheet.report.height),
        (4 * 24 + 3 * 2, 16)
    );
    // Each place holds the picture that the colourway has by itself.
    let alone = |name: Option<&str>| {
        let request = StillRequest {
            colourway: name.map(str::to_owned),
            ..request()
        };
        let cloth = prepare(&design, &request, &store, &job).unwrap();
        render(&cloth, &request, &job, &mut |_| ())
            .unwrap()
            .picture()
    };
    let cut = |x: u32| -> Vec<[f32; 4]> {
        let rows = sheet.picture().pixels.chunks(sheet.report.width as usize);
        rows.flat_map(|row| row[x as usize..x as usize + 24].to_vec())
            .collect()
    };
    let third = cut(sheet.places[2].x);
    assert!(third == alone(Some("autumn")).pixels);
    assert!(third != alone(None).pixels);
    let path = folder.path().join("sheet.png");
    sheet.save(&path).unwrap();
    let decoder = png::Decoder::new(std::io::BufReader::new(std::fs::File::open(&path).unwrap()));
    let reader = decoder.read_info().unwrap();
    let texts = &reader.info().uncompressed_latin1_text;
    let label = texts
        .iter()
        .find(|text| text.keyword == "Colourways")
        .unwrap();
    assert!(label.text.contains("autumn at 52,0"), "{}", label.text);
    assert!(sheet.save(&folder.path().join("sheet.exr")).is_err());
    let oxford = Arc::new(presets::design("oxford").unwrap().unwrap());
    let none = render_sheet(
        &oxford,
        &request(),
        reference(),
        &store,
        &job,
        &mut |_, _, _| (),
    );
    assert!(none.is_err_and(|error| error.to_string().contains("own yarns only")));
}
