//! A cloth that is turned by 180° as it lies: the same threads, the light where it was, and
//! a Z twill that stays one.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

use std::sync::Arc;

use glam::Vec3;
use miniz_oxide::inflate::decompress_to_vec_zlib;
use pickglass::design::{
    Design, Draft, Family, Fill, Filled, Lifting, Sett, Shed, Srgb, Structure, Ties, Yarn, YarnId,
    YarnMaps,
};
use pickglass::engine::{
    FirstSight, Heading, LightChoice, SightTables, Still, StillRequest, Stop, prepare, render,
};
use pickglass::exemplar::ExemplarStore;
use pickglass::job::Job;
use pickglass::plan::{EffectBase, EffectChoice, Settings};
use pickglass::print::{self, PdfOptions};
use pickglass::scene::{LightRig, Pose, Sky, View};

const SIDE: u32 = 64;

/// A dark warp over a light weft.
fn design(structure: Structure) -> Arc<Design> {
    let yarns = vec![
        Yarn::new("dark", Family::Cotton, Srgb(30, 20, 20)),
        Yarn::new("light", Family::Cotton, Srgb(230, 225, 210)),
    ];
    let maps = YarnMaps::plain(YarnId(0), YarnId(1));
    let sett = Sett::per_cm(20.0, 20.0);
    Arc::new(Design::new("twill", structure, yarns, maps, sett).unwrap())
}

fn twill(notation: &str) -> Arc<Design> {
    let fill = Fill::by_notation(notation).unwrap();
    design(Structure::Weave(Filled::new(fill, 8, 8).unwrap()))
}

/// 8 × 8 crossings, with a sun that stands low, so that it matters where.
fn request(design: &Design, turned: bool, azimuth: i16) -> StillRequest {
    let pitch = design.sett().ends.mean_pitch_mm();
    let mut settings = Settings::default().at_level(3);
    settings.showing.denoise = false;
    StillRequest {
        width: SIDE,
        height: SIDE,
        width_mm: Some(8.0 * pitch),
        // Not the middle of a repeat: the cloth is turned about what is looked at.
        centre_mm: Some([3.3 * pitch, 2.1 * pitch]),
        turned,
        light: LightChoice::Sun(Heading {
            azimuth,
            elevation: 25,
        }),
        effects: EffectChoice {
            base: EffectBase::None,
            ..EffectChoice::default()
        },
        settings,
        stop: Stop {
            spp: Some(16),
            ..Stop::default()
        },
        ..StillRequest::default()
    }
}

fn sight(design: &Arc<Design>, request: &StillRequest) -> Vec<u8> {
    let engine = FirstSight::new(
        Arc::clone(design),
        Arc::new(design.weave()),
        Arc::new(SightTables::default()),
    );
    engine.look(request, &Job::new()).unwrap().rgba
}

/// A picture turned by 180°.
fn turned(rgba: &[u8]) -> Vec<u8> {
    rgba.chunks(4).rev().flatten().copied().collect()
}

/// Share of the pixels that differ by more than two levels.
fn differing(one: &[u8], other: &[u8]) -> f64 {
    let far = |(a, b): (&[u8], &[u8])| a.iter().zip(b).any(|(a, b)| a.abs_diff(*b) > 2);
    let pairs = one.chunks(4).zip(other.chunks(4));
    pairs.filter(|&pair| far(pair)).count() as f64 / (one.len() / 4) as f64
}

#[test]
fn a_turned_camera_looks_along_the_same_rays() {
    let target = Vec3::new(3.0, -2.0, 0.1);
    let round = Vec3::new(-1.0, -1.0, 1.0);
    for &view in View::ALL {
        let plain = view.camera(target, 8.0, 64, 48);
        let turned = plain.turned();
        for (x, y) in [(0.5, 0.5), (31.0, 7.0), (60.5, 47.5)] {
            let (there, here) = (plain.ray(x, y), turned.ray(x, y));
            // The whole camera goes round the normal of the cloth in the middle of the picture.
            let about = target + (there.origin - target) * round;
            assert!((here.origin - about).length() < 1e-3, "{view:?}");
            assert!((here.direction - there.direction * round).length() < 1e-5);
            if matches!(view, View::Face | View::Back) {
                let opposite = plain.ray(64.0 - x, 48.0 - y);
                assert!((here.origin - opposite.origin).length() < 1e-3, "{view:?}");
                assert!((here.direction - opposite.direction).length() < 1e-6);
            }
            let (across, up) = turned.film_axes();
            assert!(across.cross(up).dot(-turned.forward()) > 0.999, "mirrored");
        }
    }
}

#[test]
fn the_light_stays_with_the_viewer() {
    let rig = LightRig::sun(135, 45).unwrap();
    let turned = rig.on(Pose::TURNED);
    assert_eq!(turned.on(Pose::TURNED), rig);
    for (there, here) in rig.suns.iter().zip(&turned.suns) {
        let [a, b] = [there.towards, here.towards];
        assert!((a + b).truncate().length() < 1e-6 && (a.z - b.z).abs() < 1e-6);
    }
    // Turned over and turned: in the end about the x axis.
    assert_eq!(
        rig.on(Pose::BACK).on(Pose::TURNED).sky_turn(),
        Vec3::new(1.0, -1.0, -1.0)
    );
    assert!(!matches!(rig.sky, Sky::Dark));
}

#[test]
fn first_sight_of_a_turned_cloth_is_that_picture_turned() {
    let design = twill("3/1 twill");
    for view in [View::Face, View::Back] {
        let picture = |turned, azimuth| {
            let request = StillRequest {
                view,
                ..request(&design, turned, azimuth)
            };
            sight(&design, &request)
        };
        let plain = turned(&picture(false, 150));
        assert!(differing(&plain, &picture(true, -30)) < 0.01, "{view:?}");
        // The light stays by default: turned cloth in the same light is another picture.
        assert!(differing(&plain, &picture(true, 150)) > 0.1, "{view:?}");
        assert!(differing(&turned(&plain), &picture(true, -30)) > 0.1);
    }
}

/// Mean of the squared differences over their variances, where the second picture is turned.
fn apart(one: &Still, other: &Still) -> f64 {
    let (one, other) = (one.film.pixels(), other.film.pixels());
    let squares = one.iter().zip(other.iter().rev()).map(|(a, b)| {
        let variance = a.variance() + b.variance();
        (a.luminance() - b.luminance()).powi(2) / (variance + 1e-6)
    });
    squares.sum::<f64>() / one.len() as f64
}

#[test]
fn a_traced_turned_cloth_is_that_picture_turned_within_its_noise() {
    let design = twill("3/1 twill");
    let first = request(&design, false, 150);
    let cloth = prepare(&design, &first, &ExemplarStore::user(), &Job::new()).unwrap();
    let traced = |turned, azimuth| {
        let request = request(&design, turned, azimuth);
        render(&cloth, &request, &Job::new(), &mut |_| {}).unwrap()
    };
    let (plain, along, stays) = (traced(false, 150), traced(true, -30), traced(true, 150));
    let (same, other) = (apart(&plain, &along), apart(&plain, &stays));
    println!("light turned along {same:.2}, light that stays {other:.2}");
    // About 1 where only noise is between them.
    assert!(same < 1.5 && other > 2.0 * same, "{same} {other}");
}

/// Which way the lines of a picture of 8 × 8 crossings rise: positive to the right.
fn rises(rgba: &[u8]) -> f64 {
    let (side, step) = (SIDE as i64, SIDE as i64 / 8);
    let at = |x: i64, y: i64| f64::from(rgba[((y * side + x) * 4 + 1) as usize]);
    let mut apart = [0.0, 0.0];
    for y in step..side - step {
        for x in step..side - step {
            // Up on the screen is a smaller y.
            apart[0] += (at(x, y) - at(x + step, y - step)).abs();
            apart[1] += (at(x, y) - at(x + step, y + step)).abs();
        }
    }
    apart[1] - apart[0]
}

#[test]
fn a_z_twill_stays_a_z_twill_however_it_lies() {
    let s = {
        let weave = twill("1/3 twill").weave();
        design(Structure::Pattern(weave.mirrored()))
    };
    let z = twill("1/3 twill");
    for turned in [false, true] {
        let rise = |design: &Arc<Design>| rises(&sight(design, &request(design, turned, 135)));
        let (z, s) = (rise(&z), rise(&s));
        assert!(z > 0.0 && s < 0.0, "{turned}: {z} {s}");
    }
}

/// Texts of a PDF with their places, and the lower left corners of what is filled.
struct Printed {
    texts: Vec<(f32, f32, String)>,
    filled: Vec<(f32, f32, f32)>,
}

fn printed(bytes: &[u8]) -> Printed {
    let find = |from: usize, what: &[u8]| {
        let found = bytes[from..].windows(what.len()).position(|at| at == what);
        found.map(|at| from + at)
    };
    let (mut texts, mut filled) = (Vec::new(), Vec::new());
    let mut from = 0;
    while let Some(at) = find(from, b"\nstream\n") {
        let begin = at + 8;
        from = find(begin, b"endstream").unwrap();
        let Ok(content) = decompress_to_vec_zlib(&bytes[begin..from]) else {
            continue;
        };
        let content = String::from_utf8_lossy(&content).into_owned();
        let lines: Vec<&str> = content.lines().collect();
        let numbers = |line: &str| -> Vec<f32> {
            line.split(' ')
                .filter_map(|word| word.parse().ok())
                .collect()
        };
        for pair in lines.windows(2) {
            if let (true, Some(text)) = (pair[0].ends_with(" Td"), pair[1].strip_suffix(") Tj")) {
                let place = numbers(pair[0]);
                let text = text.trim_start_matches('(').to_owned();
                texts.push((place[0], place[1], text));
            }
            if pair[0].ends_with(" re") && pair[1] == "f" {
                let place = numbers(pair[0]);
                filled.push((place[0], place[1], place[2]));
            }
        }
    }
    Printed { texts, filled }
}

#[test]
fn the_printed_threads_keep_their_numbers_when_the_draft_is_turned() {
    // Not alike from both sides: end 1 hangs on shaft 1 and end 8 on shaft 3.
    let threading = Ties::from_rows([0u16, 1, 2, 3, 0, 1, 3, 2].map(|shaft| [shaft]));
    let treadling = Ties::from_rows([1u16, 1, 2, 3, 0, 2, 3, 0].map(|treadle| [treadle]));
    let tieup = Ties::from_rows((0..4u16).map(|shaft| [shaft]));
    let lifting = Lifting::Treadled { tieup, treadling };
    let draft = Draft::new(4, 4, Shed::Rising, threading, lifting).unwrap();
    let design = design(Structure::Draft(draft));
    let weave = design.weave();
    for turned in [false, true] {
        let options = PdfOptions {
            turned,
            lists: false,
            cloth: false,
            ..PdfOptions::default()
        };
        let printed = printed(&print::write(&design, &weave, &options).unwrap());
        let numbers: Vec<_> = (printed.texts.iter())
            .filter_map(|(x, y, text)| Some((*x, *y, text.parse::<u32>().ok()?)))
            .collect();
        let low = numbers.iter().map(|text| text.1).fold(f32::MAX, f32::min);
        let right = numbers.iter().map(|text| text.0).fold(f32::MIN, f32::max);
        let near = |a: f32, b: f32| (a - b).abs() < 0.1;
        // Numbers of threads are smaller than those in the cells, in whose middle both stand.
        let beside = |a: f32, b: f32| (a - b).abs() < 2.0;
        let ends: Vec<_> = numbers.iter().filter(|text| near(text.1, low)).collect();
        let picks: Vec<_> = numbers.iter().filter(|text| near(text.0, right)).collect();
        let named = |of: &[&(f32, f32, u32)]| {
            let mut names: Vec<u32> = of.iter().map(|text| text.2).collect();
            names.sort_unstable();
            names
        };
        assert_eq!(
            (named(&ends), named(&picks)),
            (vec![1, 4, 8], vec![1, 4, 8])
        );
        for end in &ends {
            let above = numbers
                .iter()
                .find(|text| beside(text.0, end.0) && text.1 > end.1 + 1.0);
            let shaft = [1, 2, 3, 4, 1, 2, 4, 3][end.2 as usize - 1];
            assert_eq!(above.unwrap().2, shaft, "end {} turned {turned}", end.2);
        }
        for pick in &picks {
            let pressed = numbers
                .iter()
                .find(|text| beside(text.1, pick.1) && text.0 < pick.0 - 1.0);
            let treadle = [2, 2, 3, 4, 1, 3, 4, 1][pick.2 as usize - 1];
            assert_eq!(
                pressed.unwrap().2,
                treadle,
                "pick {} turned {turned}",
                pick.2
            );
        }
        // The crossing where the printed end and the printed pick meet is the file's.
        for (end, pick) in ends
            .iter()
            .flat_map(|end| picks.iter().map(move |pick| (end, pick)))
        {
            let inside = |&&(x, y, size): &&(f32, f32, f32)| {
                (x..x + size).contains(&(end.0 + 1.0)) && (y..y + size).contains(&(pick.1 + 1.0))
            };
            let up = printed.filled.iter().find(inside).is_some();
            assert_eq!(up, weave.get(end.2 - 1, pick.2 - 1), "{end:?} {pick:?}");
        }
        let place = |of: &[&(f32, f32, u32)], number| **of.iter().find(|t| t.2 == number).unwrap();
        let (first, last) = (place(&ends, 1).0, place(&ends, 8).0);
        assert_eq!(
            first > last,
            turned,
            "end 1 at the right where it is turned"
        );
        assert_eq!(
            place(&picks, 1).1 > place(&picks, 8).1,
            turned,
            "pick 1 at the top"
        );
    }
}
