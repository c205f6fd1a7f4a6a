//! Measures the corrections of coarse levels and writes their table.

use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use glam::Vec3;
use pickglass::cloth::levels::fit::{Light, measure, transmittance};
use pickglass::cloth::levels::solve::{Pair, solve};
use pickglass::cloth::levels::{Gain, LevelCorrection, Sizes};
use pickglass::cloth::{ClothSettings, ClothVolume, YarnClasses};
use pickglass::design::{Design, Family, Grid, YarnId, YarnMap, YarnMaps};
use pickglass::exemplar::ExemplarStore;
use pickglass::formats::presets;
use pickglass::job::Job;
use pickglass::synthesis::Catalogue;

/// Coarseness at which the corrections of a family are kept.
const RATIOS: [f32; 4] = [1.75, 2.9, 5.2, 8.5];

/// By family, at those: thinning, with which five cloths of the family (plain weave, twills
/// and satins of several sizes and setts), all together, let as much through as at level 0,
/// and spread, with which highlights of a satin in silk are as bright under all lamps.
/// Coarse cotton is thinned less than that (0.58 would keep what it lets through): more, and
/// the yarn below is seen at the middle of crossings.
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

/// Paths at a coarse level; level 0, which all levels are compared with, has twice as many,
/// and silk, whose highlights are narrow, too.
const PATHS: u32 = 1 << 15;
/// Rays that measure what a cloth lets through.
const RAYS: u32 = 1 << 13;

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

/// The light of a design at a level with its density corrected, and the coarseness.
struct Measured {
    light: Light,
    ratio: f32,
    sizes: Option<Sizes>,
    family: Family,
}

/// The design with yarns of their own for its weft, and how many the warp has.
fn apart(design: &Design) -> (Design, u32) {
    let warps = design.yarns().len() as u16;
    let other = |yarn: YarnId| YarnId(yarn.0 + warps);
    let weft = match &design.maps().weft {
        YarnMap::Order(order) => YarnMap::Order(order.iter().copied().map(other).collect()),
        YarnMap::Crossings(grid) => {
            let value = |end, pick| other(grid.get(end, pick));
            YarnMap::Crossings(Grid::from_fn(grid.ends(), grid.picks(), value).expect("a grid"))
        }
    };
    let maps = YarnMaps {
        warp: design.maps().warp.clone(),
        weft,
    };
    let yarns = [design.yarns(), design.yarns()].concat();
    let structure = design.structure().clone();
    let apart = Design::new("apart", structure, yarns, maps, design.sett().clone());
    (apart.expect("sound"), u32::from(warps))
}

/// Measures a design; `kept` is a folder where measurements are kept between runs.
fn measured(name: &str, level: u32, kept: &Path) -> Measured {
    let begun = Instant::now();
    let design = presets::design(name).expect("there").expect("sound");
    let (design, warps) = apart(&design);
    let cloth = cloth(&design, level).with_corrections(|family, set| {
        let [coarse, fine] = set.grid.voxel_um();
        LevelCorrection::between(&nodes(family), family, None, coarse / fine)
    });
    let set = &cloth.sets()[0];
    let [coarse, fine] = set.grid.voxel_um();
    let (ratio, family) = (coarse / fine, set.pair.warp.family);
    let file = kept.join(format!("{name}-{level}.f64"));
    let known = std::fs::read(&file).ok().and_then(|bytes| {
        let values = (bytes.chunks_exact(8))
            .map(|eight| f64::from_le_bytes(eight.try_into().unwrap_or_default()));
        Light::from_values(values.collect())
    });
    let light = known.unwrap_or_else(|| {
        let twice = u32::from(level == 0) + u32::from(family == Family::Silk);
        let paths = PATHS << twice;
        let light = measure(&cloth, warps, paths, &Job::new()).expect("not cancelled");
        let through = transmittance(&cloth, RAYS, &Job::new()).expect("not cancelled");
        let bytes: Vec<u8> = (light.values().iter())
            .flat_map(|value| value.to_le_bytes())
            .collect();
        std::fs::create_dir_all(kept).expect("a folder");
        std::fs::write(&file, bytes).expect("measurements are kept");
        eprintln!(
            "{name} level {level}: {ratio:.2} times as coarse, lets through {through:.4}, {:.0} s",
            begun.elapsed().as_secs_f64()
        );
        light
    });
    Measured {
        light,
        ratio,
        sizes: Sizes::of(set),
        family,
    }
}

/// A row of the table before its gains are known, and what they are found from.
type Row = (LevelCorrection, Vec<Pair>);

/// Puts what was measured of a design's exemplars to the rows, one a level.
fn add_rows(name: &str, kept: &Path, rows: &mut Vec<Row>) {
    let fine = measured(name, 0, kept);
    let mut last = 1.0;
    for level in 1..=4 {
        let coarse = measured(name, level, kept);
        // Small blocks have no coarser voxels than eight a side.
        if coarse.ratio <= 1.02 * last || coarse.sizes.is_none() {
            continue;
        }
        last = coarse.ratio;
        let nodes = nodes(coarse.family);
        let density = LevelCorrection::between(&nodes, coarse.family, None, coarse.ratio);
        let row = LevelCorrection {
            sizes: coarse.sizes,
            ratio: coarse.ratio,
            ..density.expect("a coarse level is thinned")
        };
        let pair = Pair {
            fine: fine.light.clone(),
            coarse: coarse.light,
        };
        match rows.iter_mut().find(|(known, _)| *known == row) {
            Some((_, pairs)) => pairs.push(pair),
            None => rows.push((row, vec![pair])),
        }
    }
}

/// Measures what is not kept yet and returns the text of the table: first what holds for
/// any yarns of a family, density alone, then the presets' exemplars, each with its gains.
pub fn table(kept: &Path) -> String {
    let any = Family::ALL.into_iter().flat_map(nodes);
    let mut rows: Vec<Row> = any.map(|row| (row, Vec::new())).collect();
    for name in presets::names() {
        add_rows(name, kept, &mut rows);
    }
    let mut text = String::from("[\n");
    for (mut row, pairs) in rows {
        if !pairs.is_empty() {
            let residual = solve(&pairs, &mut row);
            eprintln!(
                "{} {:?} {:.2}: error {:.2} % of a lamp, with the gains {:.2} %",
                row.family.name(),
                row.sizes,
                row.ratio,
                100.0 * residual.before,
                100.0 * residual.after
            );
        }
        let round = |number: f32| (number * 1e4).round() / 1e4;
        for gain in &mut row.gains {
            *gain = Gain::new(&gain.factors().map(round)).expect("a gain");
        }
        let sizes = (row.sizes.iter_mut())
            .flat_map(|sizes| sizes.diameters_mm.iter_mut().chain(&mut sizes.pitch_mm));
        let rest = [&mut row.ratio, &mut row.thin, &mut row.spread];
        for number in sizes.chain(rest) {
            *number = round(*number);
        }
        text += &format!("    {},\n", ron::to_string(&row).expect("a row"));
    }
    text + "]\n"
}
