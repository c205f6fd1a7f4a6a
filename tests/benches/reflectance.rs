//! Measures the reflectance curves of all families and prints `presets/reflectance.ron`.
//!
//! `cargo bench --bench reflectance > presets/reflectance.ron`; an argument sets the paths
//! a curve.

use std::sync::Arc;

use glam::Vec3;
use pickglass::cloth::{ClothSettings, ClothVolume, YarnClasses, colour};
use pickglass::design::{Design, Family, Filled, Sett, Srgb, Structure, Yarn, YarnId, YarnMaps};
use pickglass::exemplar::ExemplarStore;
use pickglass::job::Job;
use pickglass::synthesis::Catalogue;

/// Roughness of the fibres, from filament to chalk.
const ALPHAS: [f32; 6] = [0.03, 0.08, 0.15, 0.25, 0.45, 1.0];

fn main() {
    let paths = std::env::args()
        .find_map(|word| word.parse().ok())
        .unwrap_or(20_000);
    let families = [Family::Cotton, Family::Silk, Family::Wool, Family::Linen];
    println!("[");
    for family in families {
        let mut cloth = None;
        for alpha in ALPHAS {
            let mut yarn = Yarn::new("white", family, Srgb(255, 255, 255));
            yarn.gloss = Some(alpha);
            let design = plain(yarn);
            let job = Job::new();
            let catalogue = Arc::new(Catalogue::standard());
            let settings = ClothSettings {
                level: 1,
                ..ClothSettings::default()
            };
            let classes = YarnClasses::new(&design);
            let sets = cloth.get_or_insert_with(|| {
                let grid = ClothVolume::grid_for(&catalogue, &classes, &settings).expect("grid");
                let build = |pair| ExemplarSet::build(&catalogue, pair, grid, &job);
                classes
                    .pairs
                    .iter()
                    .map(|pair| Arc::new(build(pair).expect("set")))
                    .collect::<Vec<_>>()
            });
            let white = vec![Vec3::ONE];
            let volume = ClothVolume::new(
                &design,
                catalogue,
                classes,
                sets.clone(),
                white,
                settings,
                &job,
            )
            .expect("cloth");
            let curve = colour::measure(&volume, family, alpha, 4, paths, &job).expect("curve");
            let values: Vec<String> = curve
                .reflectance
                .iter()
                .map(|r| format!("{r:.5}"))
                .collect();
            println!(
                "    (family: {family:?}, alpha: {alpha:?}, reflectance: [{}]),",
                values.join(", ")
            );
        }
    }
    println!("]");
}

/// Plain weave of one yarn at its usual sett.
fn plain(yarn: Yarn) -> Design {
    let maps = YarnMaps::plain(YarnId(0), YarnId(0));
    let sett: Sett = pickglass::design::usual_sett(std::slice::from_ref(&yarn), &maps);
    let weave = Structure::Weave(Filled::once("plain").expect("plain is a weave"));
    Design::new("plain", weave, vec![yarn], maps, sett).expect("a design")
}
