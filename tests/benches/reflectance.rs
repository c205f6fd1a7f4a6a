//! Measures the reflectance curves of all families: `presets/reflectance.ron`.
//!
//! `cargo bench -p pickglass --bench reflectance -- 8192` prints the table, measured with
//! so many paths a curve; `--write` puts it in the preset's place. Either happens only
//! when every curve is there.

use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use glam::Vec3;
use pickglass::atomic;
use pickglass::cloth::colour::{self, Measured};
use pickglass::cloth::{ClothSettings, ClothVolume, YarnClasses};
use pickglass::design::{Design, Family, Filled, Sett, Srgb, Structure, Yarn, YarnId, YarnMaps};
use pickglass::exemplar::{ExemplarSet, ExemplarStore};
use pickglass::job::Job;
use pickglass::synthesis::Catalogue;

/// Roughness of the fibres, from the smoothest there is to chalk; the one nearest to the
/// family's own gives way to it.
const ALPHAS: [f32; 6] = [0.01, 0.03, 0.08, 0.22, 0.45, 1.0];
/// Layers of the pile: what the table's users call opaque.
const LAYERS: u32 = 4;
/// Paths a curve when no argument says; at the family's own roughness, which nearly every
/// yarn has, [`OWN`] times as many.
const USUAL_PATHS: u32 = 8192;
const OWN: u32 = 4;

fn main() {
    let paths = std::env::args()
        .find_map(|word| word.parse().ok())
        .unwrap_or(USUAL_PATHS);
    let write = std::env::args().any(|word| word == "--write");
    let mut table = String::from("[\n");
    for &family in Family::ALL {
        let begun = Instant::now();
        let bench = Bench::new(family);
        eprintln!("{} {:.1} s", family.name(), begun.elapsed().as_secs_f64());
        for alpha in alphas(family) {
            let begun = Instant::now();
            let own = alpha.to_bits() == family.numbers().alpha.to_bits();
            let measured = bench.measure(alpha, if own { OWN * paths } else { paths });
            eprintln!("{}", line(&measured, begun.elapsed().as_secs_f64()));
            table += &entry(&measured);
        }
    }
    table += "]\n";
    if write {
        let preset = Path::new(env!("CARGO_MANIFEST_DIR")).join("presets/reflectance.ron");
        atomic::write(&preset, table.as_bytes()).expect("the preset is written");
    } else {
        print!("{table}");
    }
}

/// The roughnesses at which a family is measured.
fn alphas(family: Family) -> [f32; 6] {
    let own = family.numbers().alpha;
    let distance = |alpha: f32| (alpha / own).ln().abs();
    let mut alphas = ALPHAS;
    if let Some(nearest) = alphas
        .iter_mut()
        .min_by(|a, b| distance(**a).total_cmp(&distance(**b)))
    {
        *nearest = own;
    }
    alphas
}

/// One family's exemplars, used at every roughness.
struct Bench {
    family: Family,
    catalogue: Arc<Catalogue>,
    settings: ClothSettings,
    sets: Vec<Arc<ExemplarSet>>,
}

impl Bench {
    fn new(family: Family) -> Self {
        let catalogue = Arc::new(Catalogue::standard());
        let settings = ClothSettings::default();
        let design = plain(family, family.numbers().alpha);
        let job = Job::new();
        let (_, needed) =
            ClothVolume::assign(&design, &catalogue, &settings, &job).expect("blocks");
        let classes = YarnClasses::new(&design);
        let grid = ClothVolume::grid_for(&catalogue, &classes, &settings).expect("grid");
        let store = ExemplarStore::none();
        let sets = (classes.pairs.iter())
            .map(|pair| {
                (store.get(&catalogue, pair, grid, &needed, &job)).expect("exemplars are built")
            })
            .collect();
        Self {
            family,
            catalogue,
            settings,
            sets,
        }
    }

    fn measure(&self, alpha: f32, paths: u32) -> Measured {
        let design = plain(self.family, alpha);
        let job = Job::new();
        let (assignment, _) =
            ClothVolume::assign(&design, &self.catalogue, &self.settings, &job).expect("blocks");
        let cloth = ClothVolume::new(
            &design,
            Arc::clone(&self.catalogue),
            YarnClasses::new(&design),
            assignment,
            self.sets.clone(),
            vec![Vec3::ONE],
            self.settings,
            &job,
        )
        .expect("cloth");
        colour::measure(&cloth, self.family, alpha, LAYERS, paths, &job).expect("curve")
    }
}

/// Plain weave of one yarn of the family at its usual size and sett.
fn plain(family: Family, alpha: f32) -> Design {
    let mut yarn = Yarn::new("white", family, Srgb(255, 255, 255));
    yarn.gloss = Some(alpha);
    let maps = YarnMaps::plain(YarnId(0), YarnId(0));
    let sett: Sett = pickglass::design::usual_sett(std::slice::from_ref(&yarn), &maps);
    let weave = Structure::Weave(Filled::once("plain").expect("plain is a weave"));
    Design::new("plain", weave, vec![yarn], maps, sett).expect("a design")
}

/// What is said of a curve while the table grows.
fn line(
    Measured {
        curve,
        standard_error,
    }: &Measured,
    seconds: f64,
) -> String {
    let middle = colour::NODES / 2;
    let at = |node: usize| {
        format!(
            "{:.4} ± {:.4}",
            curve.reflectance[node], standard_error[node]
        )
    };
    format!(
        "  α {:<5} R(1) {}  R(0.75) {}  {seconds:.1} s",
        curve.alpha,
        at(0),
        at(middle)
    )
}

/// A curve as the table holds it.
fn entry(Measured { curve, .. }: &Measured) -> String {
    let values: Vec<String> = (curve.reflectance.iter())
        .map(|reflectance| format!("{reflectance:.5}"))
        .collect();
    format!(
        "    (family: {:?}, alpha: {:?}, reflectance: [{}]),\n",
        curve.family,
        curve.alpha,
        values.join(", ")
    )
}
