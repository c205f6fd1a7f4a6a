//! First sight resembles what the path tracer refines to.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

use std::sync::Arc;

use crate::picture_likeness::{Looked, mean_delta_e, ssim};
use pickglass::design::{
    Design, Family, Srgb, Structure, WeavePattern, Yarn, YarnId, YarnMaps, usual_sett,
};
use pickglass::engine::{
    Engine, FirstSight, LightChoice, Shot, SightTables, StillRequest, Stop, prepare,
};
use pickglass::exemplar::ExemplarStore;
use pickglass::job::Job;
use pickglass::plan::{Settings, Subject};
use pickglass::presets;
use pickglass::render::Backing;
use pickglass::scene::View;

fn design(name: &str) -> Arc<Design> {
    Arc::new(presets::design(name).unwrap().unwrap())
}

fn request(view: View, light: &str) -> StillRequest {
    StillRequest {
        width: 360,
        height: 240,
        view,
        light: LightChoice::Preset(light.to_owned()),
        settings: Settings::default().at_level(1),
        stop: Stop {
            spp: Some(12),
            ..Stop::default()
        },
        ..StillRequest::default()
    }
}

/// The last picture of an engine. Where `PICKGLASS_PICTURES` names a folder, it is kept.
fn picture(engine: &dyn Engine, request: &StillRequest, name: &str) -> Vec<u8> {
    let mut rgba = Vec::new();
    let shot = Shot::new(request, request.plan(Subject::Cloth).unwrap()).unwrap();
    engine
        .expose(&shot, &Job::new(), &mut |pass| {
            rgba = pass.rgba();
            if engine.name() == "sight" {
                println!("{name}: first sight in {:.1} ms", pass.seconds * 1e3);
            }
        })
        .unwrap();
    if let Some(folder) = std::env::var_os("PICKGLASS_PICTURES") {
        let path = std::path::Path::new(&folder).join(format!("{name} {}.png", engine.name()));
        image::save_buffer(
            path,
            &rgba,
            request.width,
            request.height,
            image::ColorType::Rgba8,
        )
        .unwrap();
    }
    rgba
}

fn first(design: &Arc<Design>) -> FirstSight {
    let drawdown = Arc::new(design.weave());
    FirstSight::new(
        Arc::clone(design),
        drawdown,
        Arc::new(SightTables::default()),
    )
}

fn looked(request: &StillRequest, rgba: &[u8]) -> Looked {
    Looked::at(request.width, request.height, rgba, 4)
}

#[test]
fn first_sight_resembles_the_converged_picture() {
    let mut faults = Vec::new();
    for (name, view, light) in [
        ("default", View::Face, "day"),
        ("denim", View::Face, "day"),
        ("damask", View::Face, "day"),
        ("herringbone", View::Face, "raking-left"),
        ("tweed", View::Back, "day"),
        ("oxford", View::Face, "overcast"),
    ] {
        let design = design(name);
        let mut request = request(view, light);
        // About what a pane shows: twelve pixels a crossing.
        request.width_mm = Some(30.0 * design.sett().ends.mean_pitch_mm());
        let cloth = prepare(&design, &request, &ExemplarStore::user(), &Job::new()).unwrap();
        let traced = looked(&request, &picture(&cloth, &request, name));
        let seen = looked(&request, &picture(&first(&design), &request, name));
        let (likeness, colour) = (ssim(&seen, &traced), mean_delta_e(&seen, &traced));
        println!("{name} {view:?} {light}: SSIM {likeness:.3}, ΔE {colour:.2}");
        // A damask of one silk is seen by its sheen alone, which first sight does not show.
        let least = if name == "damask" { 0.2 } else { 0.75 };
        if likeness < least || colour > 12.0 {
            faults.push(format!("{name}: {likeness:.3} {colour:.2}"));
        }
        // Control: the same cloth half a repeat away does not resemble it, nor does the
        // cloth in other light.
        let mut moved = request.clone();
        let pitch = design.sett().ends.mean_pitch_mm();
        moved.centre_mm = Some([
            design.end_positions().repeat_mm() as f32 * 0.5 + 1.5 * pitch,
            design.pick_positions().repeat_mm() as f32 * 0.5,
        ]);
        let other = looked(&request, &picture(&first(&design), &moved, "control"));
        assert!(ssim(&other, &traced) < likeness, "{name}: the control");
    }
    assert!(faults.is_empty(), "{faults:?}");
}

/// A twill of 900 × 1500 crossings, and what it is after an edit of each kind.
fn edits() -> (Arc<Design>, Vec<(&'static str, Arc<Design>)>) {
    let yarns = vec![
        Yarn::new("navy", Family::Cotton, Srgb(38, 52, 94)),
        Yarn::new("cream", Family::Cotton, Srgb(236, 226, 203)),
    ];
    let maps = YarnMaps::plain(YarnId(0), YarnId(1));
    let sett = usual_sett(&yarns, &maps);
    let twill = |end: u32, pick: u32| (end + 8 - pick % 8) % 4 < 2;
    let of = |yarns: &[Yarn], up: &dyn Fn(u32, u32) -> bool| {
        let pattern = Structure::Pattern(WeavePattern::from_fn(900, 1500, up));
        let design = Design::new("twill", pattern, yarns.to_vec(), maps.clone(), sett.clone());
        Arc::new(design.unwrap())
    };
    let mut red = yarns.clone();
    red[0].colour = Srgb(150, 30, 40);
    // In view lie the crossings round the middle, 450 and 750.
    let edits = vec![
        (
            "a painted cell",
            of(&yarns, &|end, pick| {
                twill(end, pick) != ((end, pick) == (452, 751))
            }),
        ),
        (
            "a tie-up click",
            of(&yarns, &|end, pick| {
                twill(end, pick) != (end % 8 == 3 && pick % 8 == 1)
            }),
        ),
        (
            "a fill",
            of(&yarns, &|end, pick| match end > 450 && pick > 745 {
                true => (end + 3 * pick) % 8 == 0,
                false => twill(end, pick),
            }),
        ),
        ("a yarn's colour", of(&red, &twill)),
    ];
    (of(&yarns, &twill), edits)
}

#[test]
fn an_edit_looks_at_once_much_as_it_will() {
    let mut faults = Vec::new();
    let (before, edits) = edits();
    let mut request = request(View::Face, "day");
    request.width_mm = Some(30.0 * before.sett().ends.mean_pitch_mm());
    let traced = |design: &Arc<Design>, name: &str| {
        let cloth = prepare(design, &request, &ExemplarStore::user(), &Job::new()).unwrap();
        picture(&cloth, &request, name)
    };
    let tables = Arc::new(SightTables::default());
    let sighted = |design: &Arc<Design>| {
        let sight = FirstSight::new(
            Arc::clone(design),
            Arc::new(design.weave()),
            Arc::clone(&tables),
        );
        sight.look(&request, &Job::new()).unwrap()
    };
    let (known, seen) = (traced(&before, "twill"), sighted(&before));
    for (name, after) in edits {
        let (wanted, sight) = (traced(&after, name), sighted(&after));
        let carried = seen.carried_to(&sight, &known).unwrap();
        let [wanted, shown, alone, old] =
            [&wanted, &carried.rgba, &sight.rgba, &known].map(|rgba| looked(&request, rgba));
        let (likeness, colour) = (ssim(&shown, &wanted), mean_delta_e(&shown, &wanted));
        println!(
            "{name}: {:.1} % of the pixels change; SSIM {likeness:.3}, ΔE {colour:.2} \
             (first sight alone {:.3}, {:.2}; the old picture {:.3}, {:.2})",
            100.0 * carried.changed,
            ssim(&alone, &wanted),
            mean_delta_e(&alone, &wanted),
            ssim(&old, &wanted),
            mean_delta_e(&old, &wanted),
        );
        if likeness < 0.8 || colour > 5.0 {
            faults.push(format!("{name}: {likeness:.3} {colour:.2}"));
        }
        // Controls: neither first sight alone nor the old picture is as near.
        assert!(
            colour < mean_delta_e(&alone, &wanted),
            "{name}: first sight"
        );
        assert!(
            colour < mean_delta_e(&old, &wanted),
            "{name}: the old picture"
        );
    }
    assert!(faults.is_empty(), "{faults:?}");
}

#[test]
fn an_edit_changes_only_what_is_beside_it() {
    let design = design("oxford");
    let request = request(View::Face, "day");
    let drawdown = design.weave();
    let mut edited: WeavePattern = drawdown.clone();
    edited.set(0, 0, !drawdown.get(0, 0));
    let tables = Arc::new(SightTables::default());
    let draw = |drawdown: WeavePattern| {
        let sight = FirstSight::new(Arc::clone(&design), Arc::new(drawdown), Arc::clone(&tables));
        picture(&sight, &request, "edit")
    };
    let (before, after) = (draw(drawdown.clone()), draw(edited));
    let changed = before
        .chunks(4)
        .zip(after.chunks(4))
        .filter(|(a, b)| a != b);
    let share = changed.count() as f64 / (360.0 * 240.0);
    // The crossing and its four neighbours, of 4 × 2.
    assert!((0.2..0.75).contains(&share), "{share}");
    assert!(before == draw(drawdown));
}

#[test]
fn every_view_and_wild_places_give_a_picture() {
    let design = design("twill-satin");
    for &view in View::ALL {
        let sight = first(&design);
        for width_mm in [0.011, 3.0, 9_000.0] {
            for centre in [[0.0, 0.0], [-1e6, 1e6], [1e9, -1e9]] {
                let mut request = request(view, "day");
                (request.width, request.height) = (31, 17);
                request.width_mm = Some(width_mm);
                request.centre_mm = Some(centre);
                let rgba = picture(&sight, &request, "wild");
                assert_eq!(rgba.len(), 31 * 17 * 4);
                // What is no place is refused.
                request.centre_mm = Some([f32::NAN, 0.0]);
                assert!(pickglass::engine::check_view(&design, &request).is_err());
            }
        }
    }
}

#[test]
fn a_large_jacquard_is_seen_whole() {
    // 900 × 1500 crossings of satins, seen whole and from near.
    let weave = WeavePattern::from_fn(900, 1500, |end, pick| {
        let warp_faced = ((end / 90) + (pick / 150)) % 2 == 0;
        ((end * 3 + 8 - pick % 8) % 8 == 0) != warp_faced
    });
    let silk = design("silk-satin");
    let large = Design::clone(&silk)
        .with_structure(pickglass::design::Structure::Pattern(weave))
        .unwrap();
    let sight = first(&Arc::new(large.clone()));
    let mut request = request(View::Face, "day");
    (request.width, request.height) = (900, 700);
    for width_mm in [40.0, large.end_positions().repeat_mm() as f32] {
        request.width_mm = Some(width_mm);
        // The first picture makes the tables, the second has them.
        for _ in 0..2 {
            let rgba = picture(&sight, &request, &format!("900 × 1500, {width_mm:.0} mm"));
            let covered = rgba.chunks(4).filter(|pixel| pixel[3] > 200).count();
            assert!(covered > 900 * 700 * 9 / 10, "{covered}");
        }
    }
}

/// Steps of green light from one pixel of cloth to the next, across and down: the sum of their
/// squares. Of light, as that is what is blended: an even blend of display values it is not.
fn unevenness(rgba: &[u8], width: usize) -> f64 {
    let pixels = rgba.len() / 4;
    let light = |at: usize| f64::from(Srgb(0, rgba[4 * at + 1], 0).to_linear().y);
    let step = |[a, b]: [usize; 2]| {
        let cloth = [a, b].iter().all(|at| rgba[4 * at + 3] == u8::MAX);
        cloth.then(|| (light(a) - light(b)).powi(2))
    };
    let across = (0..pixels - 1).filter(|at| (at + 1) % width > 0);
    let across = across.map(|at| [at, at + 1]);
    let down = (width..pixels).map(|at| [at - width, at]);
    across.chain(down).filter_map(step).sum()
}

#[test]
fn close_by_neither_texels_nor_crossings_are_tiles() {
    const CLOSER: u32 = 8;
    for name in ["oxford", "default"] {
        let design = design(name);
        let sett = design.sett();
        let pitch = (sett.ends.mean_pitch_mm()).max(sett.picks.mean_pitch_mm());
        let look = |pixels: u32| {
            let request = StillRequest {
                width: 4 * pixels,
                height: 4 * pixels,
                width_mm: Some(4.0 * pitch),
                backing: Backing::Itself,
                ..request(View::Face, "day")
            };
            let name = format!("{name} with {pixels} pixels a crossing");
            let rgba = picture(&first(&design), &request, &name);
            unevenness(&rgba, 4 * pixels as usize)
        };
        // With pixels as large as texels, each of them made so many across and down. An even
        // blend of a step over so many pixels is an eighth of that; a picture that is closer
        // also shows the blend with what lies beyond its edge.
        let tiles = f64::from(CLOSER) * look(12);
        let close = look(12 * CLOSER);
        println!("{name}: {:.2} of what tiles would be", close / tiles);
        assert!(close < 0.35 * tiles, "{name}: {close} {tiles}");
    }
}
