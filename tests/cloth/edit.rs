//! An edited cloth is the cloth of the edited design.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

use crate::cloth_scenes::{at_level, cotton, wavy_twill, weave};
use glam::Vec3;
use pickglass::cloth::ClothVolume;
use pickglass::design::WeavePattern;
use pickglass::job::Job;
use pickglass::random::Random;
use pickglass::render::Voxel;

/// Blocks of a stretch of cloth, beyond the repeat on every side.
fn blocks(cloth: &ClothVolume) -> Vec<Option<u16>> {
    let placement = cloth.placement();
    (-20..120)
        .flat_map(|pick| (-20..120).map(move |end| placement.block(end, pick)))
        .collect()
}

fn voxels(cloth: &ClothVolume) -> Vec<Voxel> {
    let (low, high) = cloth.height_range();
    let mut random = Random::new(31, 0, 0);
    (0..20_000)
        .map(|_| {
            let [x, y] = random.pair().map(|u| 30.0 * u - 1.0);
            cloth.voxel_at(Vec3::new(x, y, low + (high - low) * random.uniform()))
        })
        .collect()
}

fn turned(pattern: &WeavePattern, cells: &[(u32, u32)]) -> WeavePattern {
    let mut edited = pattern.clone();
    for &(end, pick) in cells {
        edited.set(end, pick, !edited.get(end, pick));
    }
    edited
}

#[test]
fn an_edit_is_building_anew() {
    let pattern = wavy_twill(96, 96);
    let untouched = weave(&cotton(pattern.clone()), at_level(2));
    let cells: [&[(u32, u32)]; 4] = [
        &[(0, 0)],
        &[(95, 40)],
        &[(10, 10), (11, 10), (12, 10), (10, 11)],
        &[(50, 95), (50, 0), (3, 95)],
    ];
    for cells in cells {
        let edited = turned(&pattern, cells);
        // Woven first, so that its exemplars are there for both.
        let anew = weave(&cotton(edited.clone()), at_level(2));
        let mut cloth =
            weave(&cotton(pattern.clone()), at_level(2)).with_window(0.0..9.0, 0.0..9.0);
        cloth.edit(&edited, cells, &Job::new()).unwrap();
        assert!(blocks(&cloth) == blocks(&anew), "{cells:?}");
        assert!(voxels(&cloth) == voxels(&anew), "{cells:?}");
        // Control: the cloth that was not edited is another.
        assert!(blocks(&untouched) != blocks(&anew), "{cells:?}");
        // And back again.
        cloth.edit(&pattern, cells, &Job::new()).unwrap();
        assert!(blocks(&cloth) == blocks(&untouched), "{cells:?}");
    }
}

#[test]
fn a_weave_of_another_size_is_refused() {
    let mut cloth = weave(&cotton(wavy_twill(96, 96)), at_level(2));
    let before = blocks(&cloth);
    assert!(
        cloth
            .edit(&wavy_twill(95, 96), &[(0, 0)], &Job::new())
            .is_err()
    );
    assert!(blocks(&cloth) == before);
}

#[test]
fn an_edit_that_needs_more_exemplars_says_so() {
    // Plain weave shows one exemplar; a float in it needs others.
    let plain = WeavePattern::from_fn(16, 16, |end, pick| (end + pick) % 2 == 0);
    let mut settings = at_level(3);
    settings.synthesis.seed = 77;
    let mut cloth = weave(&cotton(plain.clone()), settings);
    assert!(!cloth.unbuilt().contains(&true));
    let edited = turned(&plain, &[(8, 8)]);
    cloth.edit(&edited, &[(8, 8)], &Job::new()).unwrap();
    assert!(cloth.unbuilt().contains(&true));
    let anew = weave(&cotton(edited), settings);
    assert!(!anew.unbuilt().contains(&true));
    assert!(blocks(&cloth) == blocks(&anew));
}
