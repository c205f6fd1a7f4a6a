//! Measures the corrections of coarse levels and writes their table.

use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use glam::Vec3;
use pickglass::cloth::levels::fit::{Light, Products, measure, products, transmittance};
use pickglass::cloth::levels::solve::{Pair, solve};
use pickglass::cloth::levels::{Gain, LevelCorrection, Sizes};
use pickglass::cloth::{ClothSettings, ClothVolume, HairLayer, YarnClasses};
use pickglass::design::{Design, Family, Grid, YarnId, YarnMap, YarnMaps};
use pickglass::exemplar::{COARSEST_LEVEL, ExemplarStore};
use pickglass::job::Job;
use pickglass::synthesis::Catalogue;
use pickglass::{atomic, presets};

/// Coarseness at which the corrections of a family are kept.
const RATIOS: [f32; 4] = [1.75, 2.9, 5.2, 8.5];

/// By family, at those: thinning, with which five cloths of the family (plain weave, twills
/// and satins of several sizes and setts), all together, let as much through as at level 0,
/// and spread, with which highlights of a satin in silk are as bright under all lamps.
/// Coarse cotton is thinned less than that (0.58 would keep what it lets through): more, and
/// the yarn below is seen at the middle of crossings.
fn densities(family: Family) -> [[f32; 2]; 4] {
    match family {
        Family::Cotton => [[0.275, 1.0], [0.345, 1.0], [0.44, 1.0], [0.44, 1.0]],
        Family::Silk => [[0.306, 1.0], [0.37, 1.0], [0.465, 1.43], [0.465, 1.43]],
        Family::Wool => [[0.275, 1.0], [0.303, 1.0], [0.347, 1.0], [0.367, 1.0]],
        Family::Linen => [[0.26, 1.0], [0.333, 1.0], [0.408, 1.0], [0.44, 1.0]],
    }
}

/// Paths at a coarse level, where no other number is asked for; level 0, which all levels
/// are compared with, has twice as many, and silk, whose highlights are narrow, too.
pub const PATHS: u32 = 1 << 16;
/// Paths that measure how terms go together.
const PRODUCT_PATHS: u32 = 1 << 11;
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
    (RATIOS.into_iter().zip(densities(family)))
        .map(|(ratio, [thin, spread])| LevelCorrection {
            ratio,
            thin,
            spread,
            ..LevelCorrection::none(family)
        })
        .collect()
}

/// The white cloth of a design at a level with its density corrected, and its coarseness.
struct White {
    cloth: ClothVolume,
    /// Yarns below are the warp's.
    warps: u32,
    /// Which yarns have hairs.
    hairy: Vec<bool>,
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

fn white(name: &str, level: u32) -> White {
    let design = presets::design(name).expect("there").expect("sound");
    let (design, warps) = apart(&design);
    let cloth = cloth(&design, level).with_corrections(|family, set| {
        let [coarse, fine] = set.grid.voxel_um();
        LevelCorrection::between(&nodes(family), family, None, coarse / fine)
    });
    let set = &cloth.sets()[0];
    let [coarse, fine] = set.grid.voxel_um();
    White {
        ratio: coarse / fine,
        sizes: Sizes::of(set),
        family: set.pair.warp.family,
        warps,
        hairy: HairLayer::hairy(design.yarns()),
        cloth,
    }
}

/// Numbers that are kept in a file, or else made and kept there.
fn kept(file: &Path, make: impl FnOnce() -> Vec<f64>) -> Vec<f64> {
    if let Ok(bytes) = std::fs::read(file) {
        return (bytes.chunks_exact(8))
            .map(|eight| f64::from_le_bytes(eight.try_into().unwrap_or_default()))
            .collect();
    }
    let values = make();
    let bytes: Vec<u8> = (values.iter())
        .flat_map(|value| value.to_le_bytes())
        .collect();
    atomic::write(file, &bytes).expect("measurements are kept");
    values
}

/// Measures the light of a design's cloth; `folder` is where measurements are kept between
/// runs.
fn light(name: &str, level: u32, white: &White, folder: &Path, paths: u32) -> Light {
    let values = kept(&folder.join(format!("{name}-{level}.f64")), || {
        let begun = Instant::now();
        let twice = u32::from(level == 0) + u32::from(white.family == Family::Silk);
        let (cloth, paths) = (&white.cloth, paths << twice);
        let hairs = HairLayer::new(cloth, white.hairy.clone());
        let light = measure(cloth, hairs.as_ref(), white.warps, paths, &Job::new());
        let light = light.expect("not cancelled");
        let through = transmittance(cloth, RAYS, &Job::new()).expect("not cancelled");
        eprintln!(
            "{name} level {level}: {:.2} times as coarse, lets through {through:.4}, {:.0} s",
            white.ratio,
            begun.elapsed().as_secs_f64()
        );
        light.values().to_vec()
    });
    Light::from_values(values).expect("a folder of measurements of this series")
}

fn products_of(name: &str, level: u32, white: &White, folder: &Path) -> Products {
    let values = kept(&folder.join(format!("{name}-{level}.products.f64")), || {
        let products = products(&white.cloth, white.warps, PRODUCT_PATHS, &Job::new());
        products.expect("not cancelled").values().to_vec()
    });
    Products::from_values(values).expect("a folder of measurements of this series")
}

/// A row of the table before its gains are known, and what they are found from.
type Row = (LevelCorrection, Vec<Pair>);

/// Puts what was measured of a design's exemplars to the rows, one a level.
fn add_rows(name: &str, folder: &Path, paths: u32, rows: &mut Vec<Row>) {
    let fine = light(name, 0, &white(name, 0), folder, paths);
    let mut last = 1.0;
    for level in 1..=COARSEST_LEVEL {
        let coarse = white(name, level);
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
            fine: fine.clone(),
            coarse: light(name, level, &coarse, folder, paths),
            products: products_of(name, level, &coarse, folder),
        };
        match rows.iter_mut().find(|(known, _)| *known == row) {
            Some((_, pairs)) => pairs.push(pair),
            None => rows.push((row, vec![pair])),
        }
    }
}

/// Measures what is not kept yet of some presets and returns the text of the table: first
/// what holds for any yarns of a family, density alone, then the presets' exemplars, each
/// with its gains.
pub fn table(names: &[&str], folder: &Path, paths: u32) -> String {
    let any = Family::ALL.iter().copied().flat_map(nodes);
    std::fs::create_dir_all(folder).expect("a folder");
    let mut rows: Vec<Row> = any.map(|row| (row, Vec::new())).collect();
    for name in names {
        add_rows(name, folder, paths, &mut rows);
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
            row.residual = Some(residual.after as f32);
        }
        let round = |number: f32| (number * 1e4).round() / 1e4;
        for gain in &mut row.gains {
            *gain = Gain::new(&gain.factors().map(round)).expect("a gain");
        }
        let sizes = (row.sizes.iter_mut())
            .flat_map(|sizes| sizes.diameters_mm.iter_mut().chain(&mut sizes.pitch_mm));
        let rest = [&mut row.ratio, &mut row.thin, &mut row.spread];
        for number in sizes.chain(rest).chain(&mut row.residual) {
            *number = round(*number);
        }
        text += &format!("    {},\n", ron::to_string(&row).expect("a row"));
    }
    text + "]\n"
}
