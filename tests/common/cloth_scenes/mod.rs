//! Cloth for the tests: designs, exemplars built once a process, and ways to look at a
//! cloth that share nothing with the tracer.

#![allow(dead_code, reason = "each test file uses a part")]
#![allow(clippy::unwrap_used, reason = "a test may fail")]

use std::collections::HashMap;
use std::sync::{Arc, Mutex, OnceLock};

use glam::Vec3;
use pickglass::cloth::{ClothSettings, ClothVolume, YarnClasses};
use pickglass::design::{
    Design, Family, Sett, Srgb, Structure, WeavePattern, Yarn, YarnId, YarnMaps,
};
use pickglass::exemplar::{ExemplarSet, ExemplarStore, Pair, VoxelGrid};
use pickglass::job::Job;
use pickglass::presets;
use pickglass::random::Random;
use pickglass::render::Voxel;
use pickglass::scene::Ray;
use pickglass::synthesis::{Catalogue, Face};

/// Settings of the default cloth at a coarser level: whatever does not hang on resolution
/// is tested there.
pub fn at_level(level: u32) -> ClothSettings {
    ClothSettings {
        level,
        ..ClothSettings::default()
    }
}

/// A dark warp yarn 0 and a light weft yarn 1.
pub fn two_yarns(family: Family) -> Vec<Yarn> {
    vec![
        Yarn::new("warp", family, Srgb(30, 40, 90)),
        Yarn::new("weft", family, Srgb(235, 230, 220)),
    ]
}

/// A cotton cloth of this weave, at a usual sett.
pub fn cotton(weave: WeavePattern) -> Design {
    woven(weave, Sett::per_cm(34.0, 32.0))
}

/// A cotton cloth of this weave and sett.
pub fn woven(weave: WeavePattern, sett: Sett) -> Design {
    let maps = YarnMaps::plain(YarnId(0), YarnId(1));
    let structure = Structure::Pattern(weave);
    Design::new("cloth", structure, two_yarns(Family::Cotton), maps, sett).unwrap()
}

/// An embedded design.
pub fn preset(name: &str) -> Design {
    presets::design(name).unwrap().unwrap()
}

type Key = String;

/// The exemplars of a pair that are needed; each is built once a process.
fn exemplars(
    catalogue: &Catalogue,
    pair: &Pair,
    grid: VoxelGrid,
    needed: &[bool],
) -> Arc<ExemplarSet> {
    static BUILT: OnceLock<Mutex<HashMap<Key, Arc<ExemplarSet>>>> = OnceLock::new();
    let key = format!("{} {pair:?} {grid:?}", catalogue.exemplars());
    let mut built = BUILT.get_or_init(Mutex::default).lock().unwrap();
    let known = built.get(&key);
    let missing: Vec<bool> = (needed.iter().enumerate())
        .map(|(exemplar, needed)| {
            *needed && known.is_none_or(|set| set.volumes[exemplar].is_none())
        })
        .collect();
    if known.is_none() || missing.contains(&true) {
        let new = ExemplarStore::none()
            .get(catalogue, pair, grid, &missing, &Job::new())
            .unwrap();
        let set = match known {
            None => new,
            Some(known) => {
                let mut set = ExemplarSet::clone(known);
                for (exemplar, volume) in new.volumes.iter().enumerate() {
                    if let Some(volume) = volume {
                        set.put(catalogue, exemplar, Arc::clone(volume));
                    }
                }
                Arc::new(set)
            }
        };
        built.insert(key.clone(), set);
    }
    Arc::clone(&built[&key])
}

/// The cloth of a design, from the standard exemplars.
pub fn weave(design: &Design, settings: ClothSettings) -> ClothVolume {
    weave_from(design, Catalogue::standard(), settings)
}

/// The cloth of a design, from these exemplars.
pub fn weave_from(design: &Design, catalogue: Catalogue, settings: ClothSettings) -> ClothVolume {
    weave_altered(design, catalogue, settings, |_| {})
}

/// The cloth of a design from exemplar sets that a test alters.
pub fn weave_altered(
    design: &Design,
    catalogue: Catalogue,
    settings: ClothSettings,
    alter: impl Fn(&mut ExemplarSet),
) -> ClothVolume {
    let job = Job::new();
    let catalogue = Arc::new(catalogue);
    let (assignment, needed) = ClothVolume::assign(design, &catalogue, &settings, &job).unwrap();
    let classes = YarnClasses::new(design);
    let grid = ClothVolume::grid_for(&catalogue, &classes, &settings).unwrap();
    let sets = (classes.pairs.iter())
        .map(|pair| {
            let mut set = ExemplarSet::clone(&exemplars(&catalogue, pair, grid, &needed));
            alter(&mut set);
            Arc::new(set)
        })
        .collect();
    let albedo = (design.yarns().iter())
        .map(|yarn| yarn.colour.to_linear())
        .collect();
    ClothVolume::new(
        design, catalogue, classes, assignment, sets, albedo, settings, &job,
    )
    .unwrap()
}

/// Size of a voxel of the cloth, mm.
pub fn voxel_mm(cloth: &ClothVolume) -> Vec3 {
    cloth.sets()[0].grid.voxel_mm
}

/// What is seen straight from above (front) or below (back) at a point: height in voxels
/// at which the optical depth passes 1, and the voxel there. `None` through a gap.
pub fn surface(cloth: &ClothVolume, x: f32, y: f32, face: Face) -> Option<(f32, Voxel)> {
    let (low, high) = cloth.height_range();
    let voxel = voxel_mm(cloth).z;
    // Two steps a voxel: shifts are fractions of one.
    let step = 0.5 * voxel;
    let count = ((high - low) / step) as usize;
    let mut depth = 0.0;
    for k in 0..count {
        let along = (k as f32 + 0.5) * step;
        let z = match face {
            Face::Front => high - along,
            Face::Back => low + along,
        };
        let here = cloth.voxel_at(Vec3::new(x, y, z));
        if here.sigma > 0.0 {
            let gain = here.sigma * here.fibre().projected_area(Vec3::Z) * step;
            if depth + gain >= 1.0 {
                let into = step * ((1.0 - depth) / gain - 0.5);
                let z = match face {
                    Face::Front => z - into,
                    Face::Back => z + into,
                };
                return Some((z / voxel, here));
            }
            depth += gain;
        }
    }
    None
}

/// A yarn seen at a crossing: its number and whether it runs along the warp.
pub type Seen = (u32, bool);

/// What most of the middle of a crossing shows, and the share of it that does.
///
/// The middle is a fifth of the crossing each way: at a single point one may look
/// between the plies of a yarn, or past its fibres, at the yarn below.
pub fn seen(cloth: &ClothVolume, end: i64, pick: i64, face: Face) -> (Option<Seen>, f32) {
    const ACROSS: i32 = 3;
    let mut votes: HashMap<Seen, u32> = HashMap::new();
    for k in 0..ACROSS * ACROSS {
        let place = |centre: f64, pitch: f64, step: i32| {
            let aside = f64::from(step - ACROSS / 2) / f64::from(ACROSS - 1);
            (centre + 0.2 * aside * pitch) as f32
        };
        let x = place(
            cloth.ends().centre(end),
            cloth.ends().pitch(end),
            k % ACROSS,
        );
        let y = place(
            cloth.picks().centre(pick),
            cloth.picks().pitch(pick),
            k / ACROSS,
        );
        if let Some((_, voxel)) = surface(cloth, x, y, face) {
            let along_warp = voxel.direction.y.abs() > voxel.direction.x.abs();
            *votes.entry((voxel.optics, along_warp)).or_insert(0) += 1;
        }
    }
    let most = votes.into_iter().max_by_key(|&(seen, count)| (count, seen));
    let share = most.map_or(0.0, |most| most.1 as f32 / (ACROSS * ACROSS) as f32);
    (most.map(|most| most.0), share)
}

/// Transmittance along a ray by marching in small steps.
pub fn marched(cloth: &ClothVolume, ray: &Ray, t_max: f32, step: f32) -> f64 {
    let mut depth = 0.0f64;
    let count = (t_max / step) as usize;
    for k in 0..count {
        let voxel = cloth.voxel_at(ray.at((k as f32 + 0.5) * step));
        if voxel.sigma > 0.0 {
            let area = voxel.fibre().projected_area(ray.direction);
            depth += f64::from(voxel.sigma * area * step);
        }
    }
    (-depth).exp()
}

/// A direction of uniform distribution.
pub fn direction(random: &mut Random) -> Vec3 {
    let [u, v] = random.pair();
    let z = 1.0 - 2.0 * u;
    let (sin, cos) = (std::f32::consts::TAU * v).sin_cos();
    let r = (1.0 - z * z).max(0.0).sqrt();
    Vec3::new(r * cos, r * sin, z)
}

/// A twill of period 6 whose lines wave with a period of 96.
pub fn wavy_twill(ends: u32, picks: u32) -> WeavePattern {
    WeavePattern::from_fn(ends, picks, |end, pick| {
        let wave = (12.0 * (f64::from(pick) * std::f64::consts::TAU / 96.0).sin()).round();
        (i64::from(end) - wave as i64).rem_euclid(6) < 3
    })
}
