//! Times and memory of the cloth volume, printed and never asserted:
//! `cargo bench --bench cloth`.

use std::sync::Arc;
use std::time::Instant;

use glam::Vec3;
use pickglass::cloth::{ClothSettings, ClothVolume, YarnClasses};
use pickglass::design::Design;
use pickglass::engine::usual_width_mm;
use pickglass::exemplar::{Allowance, BlockMajorants, ExemplarStore};
use pickglass::job::Job;
use pickglass::presets;
use pickglass::render::{RenderSettings, render};
use pickglass::scene::{LightRig, View};
use pickglass::synthesis::{Catalogue, EdgeFix, NeighbourBits};

fn timed<T>(what: &str, work: impl FnOnce() -> T) -> T {
    let begun = Instant::now();
    let result = work();
    println!("{what:<44} {:9.5} s", begun.elapsed().as_secs_f64());
    result
}

/// The cloth of a design, each stage timed.
fn woven(design: &Design, level: u32) -> ClothVolume {
    let job = Job::new();
    let settings = ClothSettings {
        level,
        ..ClothSettings::default()
    };
    let catalogue = Arc::new(Catalogue::standard());
    let (assignment, needed) = timed("assignment", || {
        ClothVolume::assign(design, &catalogue, &settings, &job).expect("a repeat")
    });
    let classes = YarnClasses::new(design);
    let grid = timed("grid", || {
        ClothVolume::grid_for(&catalogue, &classes, &settings).expect("yarns")
    });
    println!(
        "blocks of {:?} voxels of {:.4} mm",
        grid.block, grid.voxel_mm
    );
    let store = ExemplarStore::none();
    let sets: Vec<_> = (classes.pairs.iter())
        .map(|pair| {
            let count = needed.iter().filter(|needed| **needed).count();
            let set = timed(&format!("{count} exemplars, level {level}"), || {
                store
                    .get(&catalogue, pair, grid, &needed, &job)
                    .expect("exemplars")
            });
            println!("{:<44} {:9.1} MB", "  voxels", set.bytes() as f64 / 1e6);
            set
        })
        .collect();
    let heights: Vec<_> = sets.iter().map(|set| set.heights.clone()).collect();
    let predicted: Vec<_> = sets.iter().map(|set| set.predicted.clone()).collect();
    let closing = settings.synthesis.closing();
    let fix = timed("edge fixing", || {
        EdgeFix::with_basis_of(&predicted, &heights, &catalogue, closing, &job).expect("heights")
    });
    println!("{:<44} {:9.1} MB", "  tables", fix.bytes() as f64 / 1e6);
    let majorants = timed("majorants", || {
        let bits = NeighbourBits::Consistent;
        BlockMajorants::new(&catalogue, &sets, &fix, bits, Allowance::FULL)
    });
    println!(
        "{:<44} {:9.1} MB",
        "  cells",
        majorants.bytes() as f64 / 1e6
    );
    let albedo = vec![Vec3::splat(0.7); design.yarns().len()];
    timed("cloth, edge fixing and majorants included", || {
        ClothVolume::new(
            design, catalogue, classes, assignment, sets, albedo, settings, &job,
        )
        .expect("a cloth")
    })
}

fn edit(design: &Design, cloth: &mut ClothVolume) {
    let mut weave = design.weave();
    let cell = (weave.ends() / 2, weave.picks() / 2);
    weave.set(cell.0, cell.1, !weave.get(cell.0, cell.1));
    timed("one edited cell → cloth", || {
        cloth
            .edit(&weave, &[cell], &Job::new())
            .expect("the same size");
    });
}

fn pictures(design: &Design, cloth: &ClothVolume) {
    let target = Vec3::new(
        0.5 * cloth.ends().repeat_mm() as f32,
        0.5 * cloth.picks().repeat_mm() as f32,
        0.0,
    );
    for view in [
        View::Face,
        View::Back,
        View::Close,
        View::Oblique,
        View::Grazing,
    ] {
        let width = usual_width_mm(view, design);
        let camera = view.camera(target, width, 320, 240);
        let lights = LightRig::preset("day")
            .expect("a preset")
            .on(view.pose(false));
        let settings = RenderSettings {
            spp: 8,
            ..RenderSettings::default()
        };
        let reach = width * if view == View::Grazing { 2.5 } else { 1.2 };
        let ready = cloth.clone().with_window(
            target.x - reach..target.x + reach,
            target.y - reach..target.y + reach,
        );
        let outcome = render(
            &ready,
            &camera,
            &lights,
            &settings,
            &Job::new(),
            &mut |_, _| {},
        )
        .expect("not cancelled");
        let lookups = outcome.counters.lookups as f64 / outcome.counters.paths as f64;
        println!(
            "{:<44} {:9.0} paths/s, {lookups:.0} lookups a path",
            format!("still, {}", view.name()),
            outcome.paths_per_second
        );
    }
}

fn main() {
    for name in ["wavy-twill", "default"] {
        let design = presets::design(name).expect("a name").expect("a design");
        for level in [3, 2, 0] {
            println!("\n{name}, level {level}");
            let mut cloth = woven(&design, level);
            edit(&design, &mut cloth);
            if level == 0 {
                pictures(&design, &cloth);
            }
        }
    }
}
