//! Measures the corrections of coarse levels and writes their table.

use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use glam::Vec3;
use pickglass::cloth::levels::LevelCorrection;
use pickglass::cloth::levels::fit::{self, Light};
use pickglass::cloth::levels::solve::{Pair, solve};
use pickglass::cloth::{ClothSettings, ClothVolume, YarnClasses};
use pickglass::design::{
    Design, Family, Filled, Sett, Srgb, Structure, Yarn, YarnId, YarnMaps, usual_sett,
};
use pickglass::exemplar::ExemplarStore;
use pickglass::job::Job;
use pickglass::synthesis::Catalogue;

/// White cloths that the corrections are measured on: family, weave, diameter of the yarns
/// in mm, and how many times as dense as usual the ends are (and the picks as loose). They
/// are not the designs that the corrections are judged by.
const CLOTHS: [(Family, &str, f32, f32); 20] = [
    (Family::Silk, "7/1 satin", 0.12, 0.97),
    (Family::Linen, "plain", 0.21, 1.04),
    (Family::Cotton, "plain", 0.17, 1.06),
    (Family::Wool, "2/2 twill", 0.45, 1.04),
    (Family::Silk, "1/11 satin", 0.11, 1.0),
    (Family::Cotton, "3/1 twill", 0.3, 1.04),
    (Family::Linen, "plain", 0.26, 0.97),
    (Family::Wool, "1/3 twill", 0.5, 1.0),
    (Family::Silk, "4/1 satin", 0.11, 1.04),
    (Family::Cotton, "2/2 weft rib", 0.19, 1.1),
    (Family::Linen, "2/2 twill", 0.28, 1.0),
    (Family::Wool, "plain", 0.33, 1.0),
    (Family::Silk, "1/4 satin", 0.105, 1.04),
    (Family::Cotton, "2/2 twill", 0.33, 1.04),
    (Family::Linen, "4/1 satin", 0.22, 1.0),
    (Family::Wool, "4/1 satin", 0.4, 1.0),
    (Family::Silk, "plain", 0.1, 1.05),
    (Family::Cotton, "1/3 twill", 0.25, 0.96),
    (Family::Silk, "11/1 satin", 0.105, 1.05),
    (Family::Cotton, "4/1 satin", 0.2, 1.0),
];

/// Coarseness at which corrections are kept.
const RATIOS: [f32; 4] = [1.75, 2.9, 5.2, 8.5];

/// By family, at those: thinning, with which those cloths, all together, let as much
/// through as at level 0, and spread, with which highlights of a satin in silk are as
/// bright under all lamps. Coarse cotton is thinned less than that (0.58 would keep what it
/// lets through): more, and the yarn below is seen at the middle of crossings.
const DENSITIES: [(Family, [[f32; 2]; 4]); 4] = [
    (
        Family::Cotton,
        [[0.275, 1.0], [0.345, 1.0], [0.44, 1.0], [0.44, 1.0]],
    ),
    (
        Family::Silk,
        [[0.306, 1.0], [0.37, 1.0], [0.465, 1.43], [0.465, 1.43]],
    ),
    (
        Family::Wool,
        [[0.275, 1.0], [0.303, 1.0], [0.347, 1.0], [0.367, 1.0]],
    ),
    (
        Family::Linen,
        [[0.26, 1.0], [0.333, 1.0], [0.408, 1.0], [0.44, 1.0]],
    ),
];

/// Paths at a coarse level; level 0, which all levels are compared with, has more.
const PATHS: u32 = 3072;
const FINE_PATHS: u32 = 2 * PATHS;
/// Rays that measure what a cloth lets through.
const RAYS: u32 = 1 << 13;

/// A weave in one white yarn.
fn white((family, weave, diameter, dense): (Family, &str, f32, f32)) -> Design {
    let mut yarn = Yarn::new("white", family, Srgb(255, 255, 255));
    yarn.diameter_mm = Some(diameter);
    let maps = YarnMaps::plain(YarnId(0), YarnId(0));
    let usual = usual_sett(std::slice::from_ref(&yarn), &maps);
    let per_cm = 10.0 / usual.ends.mean_pitch_mm() as f32;
    let sett = Sett::per_cm(per_cm * dense, per_cm / dense);
    let structure = Structure::Weave(Filled::once(weave).expect("a weave"));
    Design::new(weave, structure, vec![yarn], maps, sett).expect("a design")
}

fn cloth(design: &Design, level: u32) -> ClothVolume {
    let catalogue = Arc::new(Catalogue::standard());
    let settings = ClothSettings {
        level,
        correct_levels: true,
        ..ClothSettings::default()
    };
    let job = Job::new();
    let (assignment, needed) =
        ClothVolume::assign(design, &catalogue, &settings, &job).expect("blocks");
    let classes = YarnClasses::new(design);
    let grid = ClothVolume::grid_for(&catalogue, &classes, &settings).expect("a grid");
    let store = ExemplarStore::user();
    let sets = (classes.pairs.iter())
        .map(|pair| (store.get(&catalogue, pair, grid, &needed, &job)).expect("exemplars"))
        .collect();
    let albedo = vec![Vec3::ONE; design.yarns().len()];
    ClothVolume::new(
        design, catalogue, classes, assignment, sets, albedo, settings, &job,
    )
    .expect("a cloth")
}

/// The corrections of a family before their gains are known.
fn nodes(family: Family) -> Vec<LevelCorrection> {
    let own = DENSITIES.iter().filter(|(of, _)| *of == family);
    own.flat_map(|(_, densities)| RATIOS.iter().zip(densities))
        .map(|(&ratio, &[thin, spread])| LevelCorrection {
            ratio,
            thin,
            spread,
            ..LevelCorrection::none(family)
        })
        .collect()
}

/// The light of a cloth at a level with its density corrected, and the coarseness. `kept`
/// is a folder where measurements are kept between runs.
fn light(index: usize, level: u32, kept: &Path) -> Option<(Light, f32)> {
    let (family, weave, ..) = CLOTHS[index];
    let file = kept.join(format!("{index}-{level}.f64"));
    if let Ok(bytes) = std::fs::read(&file) {
        let mut values = (bytes.chunks_exact(8))
            .map(|eight| f64::from_le_bytes(eight.try_into().unwrap_or_default()));
        let head = [values.next()?, values.next()?, values.next()?];
        return Some((Light::from_values(values.collect())?, head[0] as f32));
    }
    let begun = Instant::now();
    let cloth = cloth(&white(CLOTHS[index]), level);
    let [coarse, fine] = cloth.sets()[0].grid.voxel_um();
    let ratio = coarse / fine;
    let nodes = nodes(family);
    let density = LevelCorrection::between(&nodes, family, ratio);
    let cloth = match density {
        Some(density) => cloth.with_corrections(|_| LevelCorrection {
            thin: density.thin,
            spread: density.spread,
            ..LevelCorrection::none(family)
        }),
        None => cloth,
    };
    let paths = if level == 0 { FINE_PATHS } else { PATHS };
    let light = fit::measure(&cloth, paths, &Job::new()).expect("not cancelled");
    let through = fit::transmittance(&cloth, RAYS, &Job::new()).expect("not cancelled");
    let head = [f64::from(ratio), through, f64::from(coarse)];
    let bytes: Vec<u8> = (head.iter().chain(light.values()))
        .flat_map(|value| value.to_le_bytes())
        .collect();
    std::fs::create_dir_all(kept).expect("a folder");
    std::fs::write(&file, bytes).expect("measurements are kept");
    eprintln!(
        "{} {weave} level {level}: {ratio:.2} times as coarse, lets through {through:.4}, {:.0} s",
        family.name(),
        begun.elapsed().as_secs_f64()
    );
    Some((light, ratio))
}

/// Measures what is not kept yet and returns the text of the table.
pub fn table(kept: &Path) -> String {
    let mut pairs: Vec<Pair> = Vec::new();
    for index in 0..CLOTHS.len() {
        let Some((fine, _)) = light(index, 0, kept) else {
            continue;
        };
        let mut last = 1.0;
        for level in 1..=4 {
            let Some((coarse, ratio)) = light(index, level, kept) else {
                continue;
            };
            // Small blocks have no coarser voxels than eight a side.
            if ratio > 1.02 * last {
                let fine = fine.clone();
                pairs.push(Pair {
                    ratio,
                    fine,
                    coarse,
                });
            }
            last = ratio;
        }
    }
    // The families differ by less than the noise of a family's own cloths.
    let mut common = nodes(Family::Cotton);
    let residual = solve(&pairs, &mut common);
    eprintln!(
        "error {:.2} % of a lamp, with the gains {:.2} %",
        100.0 * residual.before,
        100.0 * residual.after
    );
    let mut text = String::from("[\n");
    for family in Family::ALL {
        for (own, common) in nodes(family).into_iter().zip(&common) {
            let mut row = LevelCorrection {
                gain: common.gain,
                kinds: common.kinds,
                ..own
            };
            let factors = row.gain.iter_mut().flatten();
            for factor in factors.chain(row.kinds.iter_mut().flatten().flatten()) {
                *factor = (*factor * 1e4).round() / 1e4;
            }
            text += &format!("    {},\n", ron::to_string(&row).expect("a row"));
        }
    }
    text + "]\n"
}
