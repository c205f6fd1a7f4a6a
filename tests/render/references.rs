//! What every reference of accuracy agrees with that does not come from the same code: closed
//! forms, brute force, other solvers, other programs.

use pickglass::accuracy::Axis;

use crate::named_tests::is_test;

/// What can be more or less accurate, what its reference is held against, and by which tests.
const LIST: &[(&str, &str, &[&str])] = &[
    (
        "method",
        "brute force over all columns of blocks, and the recursion of the paper",
        &[
            "tests/synthesis/assign.rs::dp_equals_brute_force_on_small_columns",
            "tests/synthesis/assign.rs::dp_equals_the_papers_recursion",
        ],
    ),
    (
        "rank",
        "Laplace's equation by elimination, of one edge and of whole blocks",
        &[
            "src/synthesis/laplace.rs::sine_solution_equals_dense_elimination",
            "tests/synthesis/edges.rs::exact_rank_is_the_membrane_of_its_seams",
        ],
    ),
    (
        "seams",
        "directions of the voxels that are seen, on either side of borders",
        &["tests/cloth/seams.rs::fibres_of_a_satin_run_on_without_a_kink"],
    ),
    (
        "patch",
        "cloth without a period",
        &["tests/synthesis/assign.rs::a_patch_moves_together_and_the_cloth_has_no_period"],
    ),
    (
        "level",
        "light and coverage of the finest voxels",
        &["tests/cloth/levels.rs::coarse_levels_keep_light_and_coverage"],
    ),
    (
        "level-correction",
        "light and coverage of the finest voxels, and of voxels that are only averaged",
        &["tests/cloth/levels.rs::coarse_levels_keep_light_and_coverage"],
    ),
    (
        "order",
        "Mitsuba by order, and the geometric series of albedos",
        &[
            "tests/peers/mitsuba.rs::mitsuba_renders_the_same_picture",
            "tests/render/film.rs::orders_predict_every_albedo",
        ],
    ),
    (
        "roulette-order",
        "Mitsuba, and a furnace in which no light is lost",
        &[
            "tests/peers/mitsuba.rs::mitsuba_renders_the_same_picture",
            "tests/render/tracking.rs::white_furnace_is_one",
        ],
    ),
    (
        "shadow-roulette",
        "Mitsuba, and the exponential of a slab",
        &[
            "tests/peers/mitsuba.rs::mitsuba_renders_the_same_picture",
            "tests/render/tracking.rs::slab_transmittance_is_the_exponential",
        ],
    ),
    (
        "spp",
        "the true error, which its interval holds as often as it says",
        &["tests/render/film.rs::the_error_interval_covers_the_true_error"],
    ),
    (
        "pass-spp",
        "the same picture in other passes, bit for bit",
        &["tests/render/film.rs::one_thread_and_two_give_the_same_bits_in_any_passes"],
    ),
    (
        "backing-layers",
        "media one behind the other, whose transmittances multiply",
        &[
            "tests/render/tracking.rs::two_media_add_and_a_stack_multiplies",
            "tests/render/film.rs::backings_shine_through_and_self_is_opaque",
        ],
    ),
    (
        "denoise",
        "a picture of many more paths",
        &["tests/render/denoise.rs::denoising_reduces_the_error_and_keeps_the_detail"],
    ),
    (
        "png-bits",
        "an own count of what rounding loses, and another reader",
        &[
            "tests/render/accuracy.rs::curves_fall_where_theory_says_so",
            "tests/render/film.rs::png_keeps_pixels_scale_and_text",
        ],
    ),
    (
        "shadows",
        "the exponential of a slab, and Mitsuba",
        &[
            "tests/render/tracking.rs::slab_transmittance_is_the_exponential",
            "tests/peers/mitsuba.rs::mitsuba_renders_the_same_picture",
        ],
    ),
    (
        "sky",
        "a dome that is known, as itself and as a picture",
        &["tests/render/film.rs::an_environment_picture_of_a_dome_lights_like_the_dome"],
    ),
    (
        "hairs",
        "walks of one step each through the same hairs",
        &["tests/cloth/hairs.rs::long_walks_find_what_short_ones_find"],
    ),
    (
        "tap",
        "a linear field, and grids of twice and four times the resolution",
        &[
            "tests/render/tracking.rs::trilinear_taps_are_trilinear_in_the_mean",
            "tests/render/tracking.rs::taps_are_finer_grids",
        ],
    ),
    (
        "renderer",
        "Mitsuba",
        &[
            "tests/peers/mitsuba.rs::mitsuba_renders_the_same_picture",
            "tests/peers/mitsuba_volume.rs::mitsuba_renders_the_exported_scene_alike",
        ],
    ),
];

#[test]
fn every_reference_is_held_against_something_else() {
    for axis in Axis::all() {
        let name = axis.name();
        let row = LIST.iter().find(|row| row.0 == name);
        let (_, what, tests) = row.unwrap_or_else(|| panic!("{name} is held against nothing"));
        assert!(!what.is_empty() && !tests.is_empty(), "{name}");
        for test in *tests {
            assert!(is_test(test), "{name}: {test} is not there");
        }
    }
    let known = |row: &&(&str, &str, &[&str])| Axis::named(row.0).is_ok();
    assert_eq!(LIST.iter().filter(known).count(), LIST.len());
    // Control: what is no test is told.
    assert!(!is_test("tests/render/references.rs::LIST"));
}
