//! Where each hard case is tried: a test by name, or a case of the program.

use pickglass::selftest::CASES;

use crate::named_tests::is_test;

/// What is hard, and what tries it: `file::test`, or the name of a case of the program.
const LIST: &[(&str, &[&str])] = &[
    // Tracking.
    (
        "NaN directions and distances",
        &[
            "rays-that-are-none",
            "tests/render/tracking.rs::poisoned_rays_end_at_once_and_are_counted",
            "tests/cloth/majorants.rs::poison_rays_end_and_are_counted",
            "tests/render/sggx.rs::poison_gives_unit_directions_or_nan_but_no_panic",
        ],
    ),
    (
        "rays along an axis, through corners, with ±0, from a face",
        &[
            "rays-along-axes",
            "tests/render/tracking.rs::walks_cover_all_matter_from_any_side",
        ],
    ),
    (
        "majorants, with shifts and at a scale of 10⁶",
        &[
            "densest-matter",
            "tests/cloth/majorants.rs::no_lookup_is_above_its_majorant",
            "tests/cloth/majorants.rs::leaving_out_an_allowance_is_noticed",
            "tests/render/tracking.rs::scale_of_a_million_violates_nothing_and_ends",
            "tests/render/tracking.rs::majorants_hold_and_lowered_ones_are_noticed",
        ],
    ),
    (
        "random numbers 0 and 1 − 2⁻²⁴",
        &[
            "extreme-random-numbers",
            "tests/render/tracking.rs::extreme_random_numbers_end_every_walk",
        ],
    ),
    (
        "an empty volume is the background",
        &[
            "empty-volume",
            "tests/render/tracking.rs::empty_volume_is_exactly_the_background",
        ],
    ),
    (
        "walks without an end",
        &["tests/render/tracking.rs::a_walk_at_its_cap_is_absorbed_and_told"],
    ),
    (
        "fibres like mirrors and like powder, albedo 1, oblique",
        &[
            "white-furnace",
            "tests/render/tracking.rs::white_furnace_is_one",
            "tests/hard_cases/furnace.rs::white_cloth_in_even_light_cannot_be_seen",
            "tests/render/sggx.rs::second_moments_match_quadrature_at_oblique_directions",
        ],
    ),
    (
        "eyes that graze the cloth, or are inside of it",
        &[
            "views",
            "tests/hard_cases/eyes_and_lights.rs::eyes_at_a_tenth_of_a_degree_and_inside",
        ],
    ),
    (
        "light on the horizon",
        &["tests/hard_cases/eyes_and_lights.rs::a_sun_on_the_horizon_is_like_one_beside_it"],
    ),
    (
        "lamps of no size through hairs",
        &["tests/hard_cases/eyes_and_lights.rs::a_point_lamp_through_hairs_is_a_small_lamp"],
    ),
    ("cloth kilometres away", &["far-from-the-origin"]),
    (
        "the noise of a pixel, with the tap and without",
        &["tests/hard_cases/noise.rs::pixels_differ_by_their_noise"],
    ),
    (
        "any number of threads",
        &[
            "threads",
            "tests/render/film.rs::one_thread_and_two_give_the_same_bits_in_any_passes",
            "tests/cloth/walk.rs::windows_and_threads_change_no_bit",
            "tests/synthesis/assign.rs::any_number_of_threads_gives_the_same_blocks",
        ],
    ),
    (
        "a million samples",
        &[
            "a-million-samples",
            "poisoned-samples",
            "tests/render/film.rs::sums_keep_their_digits_after_a_million_samples",
            "tests/render/denoise.rs::a_firefly_stays_alone_and_poison_is_harmless",
        ],
    ),
    // Designs.
    (
        "one crossing, one end, one pick, one yarn on top throughout",
        &[
            "smallest-designs",
            "tests/hard_cases/designs.rs::the_smallest_designs",
            "tests/synthesis/assign.rs::thin_and_uneven_designs_are_assigned_like_any",
        ],
    ),
    (
        "yarns thicker than their spacing, nets and membranes",
        &[
            "setts",
            "tests/hard_cases/designs.rs::yarns_thicker_than_their_spacing",
            "tests/hard_cases/designs.rs::setts_from_fishing_net_to_membrane",
        ],
    ),
    (
        "a pattern that no exemplar matches, a stripe that does not fit its weave",
        &[
            "noise-as-a-weave",
            "tests/hard_cases/designs.rs::a_pattern_that_no_exemplar_matches",
            "tests/hard_cases/designs.rs::a_stripe_of_28_on_an_eight_end_weave",
        ],
    ),
    (
        "random designs, by every engine",
        &["tests/hard_cases/random_designs.rs::random_designs_come_out_whole"],
    ),
    (
        "rank 0, more than an edge has, and identical seams",
        &[
            "edge-fixing",
            "tests/synthesis/edges.rs::every_block_size_and_rank_is_finite",
            "tests/synthesis/edges.rs::identical_seams_have_a_singular_gram_matrix_and_no_shift",
            "tests/synthesis/edges.rs::huge_and_tiny_heights_stay_finite",
        ],
    ),
    // Files.
    (
        "NaN, infinite and negative voxels, and wrong grids",
        &[
            "tests/render/tracking.rs::grids_mend_poison_and_refuse_nonsense",
            "tests/volumes/files.rs::bad_numbers_are_mended_and_counted",
        ],
    ),
    (
        "damaged files",
        &[
            "damaged-files",
            "tests/hard_cases/files.rs::damaged_files_of_every_reader_give_an_answer",
            "tests/formats/loom_fuzz.rs::mutated_files_give_an_answer",
            "tests/formats/wif_fuzz.rs::mutated_drafts_and_designs_give_an_answer",
            "tests/volumes/files.rs::files_cut_off_anywhere_are_refused",
        ],
    ),
    (
        "recovery copies",
        &[
            "damaged-recovery",
            "tests/edit/recovery.rs::a_killed_writer_loses_nothing_that_was_written",
        ],
    ),
    (
        "names that are no names, on paper",
        &["tests/hard_cases/pages.rs::hostile_names_are_text_and_nothing_else"],
    ),
    // The window.
    (
        "edits and their undoing",
        &["tests/edit/history.rs::a_thousand_strokes_are_undone_and_redone"],
    ),
    (
        "events at random",
        &["ui/src/window/tests/random_events.rs::a_window_outlives_random_events"],
    ),
    (
        "edits while threads stall",
        &["ui/src/window/worker/stalls.rs::the_last_picture_is_of_the_last_request"],
    ),
];

/// Whether what tries a case is there.
fn is_there(tried_by: &str) -> bool {
    is_test(tried_by) || CASES.iter().any(|case| case.name == tried_by)
}

#[test]
fn every_hard_case_has_what_tries_it() {
    for (case, tried_by) in LIST {
        assert!(!tried_by.is_empty(), "{case}");
        for trial in *tried_by {
            assert!(is_there(trial), "{case}: {trial} is not there");
        }
    }
    // No case of the program is forgotten here.
    for case in CASES {
        let listed = LIST
            .iter()
            .any(|(_, tried_by)| tried_by.contains(&case.name));
        assert!(listed, "{}", case.name);
    }
    // Control: what is not there is told.
    assert!(!is_there("no-such-case"));
    assert!(!is_there("tests/hard_cases/list.rs::is_there"));
}
