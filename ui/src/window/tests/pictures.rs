//! Reference pictures of the window on a software adapter.

use eframe::egui_wgpu::{RenderState, RendererOptions};
use egui::pos2;
use egui_kittest::SnapshotOptions;
use egui_kittest::wgpu::{WgpuTestRenderer, create_render_state, default_wgpu_setup};

use super::{build, builder, shows, wait_for};

/// A renderer of snapshots. Without an adapter the test is skipped, or fails where
/// goldens are required.
pub fn renderer(test: &str) -> Option<WgpuTestRenderer> {
    render_state(test).map(WgpuTestRenderer::from_render_state)
}

/// A device of a test's own, as [`renderer`].
pub fn render_state(test: &str) -> Option<RenderState> {
    let create = || create_render_state(default_wgpu_setup(), RendererOptions::PREDICTABLE);
    let state = std::panic::catch_unwind(create).ok();
    if state.is_none() {
        let required = std::env::var_os("GOLDEN_REQUIRED").is_some();
        assert!(
            !required,
            "{test}: no graphics adapter: install mesa-vulkan-drivers"
        );
        eprintln!("skipped {test}: no graphics adapter: install mesa-vulkan-drivers");
    }
    state
}

/// Software adapters compile for the processor at hand, so a few edge pixels differ.
fn tolerance() -> SnapshotOptions {
    SnapshotOptions::new().threshold(1.0).max_failed_pixels(10)
}

#[test]
fn picture_of_nothing_open() {
    let Some(renderer) = renderer("picture_of_nothing_open") else {
        return;
    };
    let mut window = build(builder().renderer(renderer), None);
    // The thumbnails are drawn on a thread.
    wait_for(&mut window, "the thumbnails", |window| {
        shows(window, "Oxford") && window.state().start.is_drawn()
    });
    window.run_steps(5);
    window.snapshot_options("nothing_open", &tolerance());
}

#[test]
fn picture_of_a_design() {
    let Some(renderer) = renderer("picture_of_a_design") else {
        return;
    };
    let mut window = build(builder().renderer(renderer), Some("herringbone"));
    // The cloth itself is another test's business: stop it before it is drawn.
    window.state_mut().preview.freeze();
    // Floats are looked for on a thread.
    wait_for(&mut window, "the floats", |window| {
        shows(window, "No float is longer than the limit.")
    });
    window.run_steps(5);
    window.snapshot_options("herringbone", &tolerance());
}

#[test]
fn a_changed_picture_fails() {
    let Some(renderer) = renderer("a_changed_picture_fails") else {
        return;
    };
    let mut window = build(builder().renderer(renderer), None);
    // The thumbnails are drawn on a thread.
    wait_for(&mut window, "the thumbnails", |window| {
        shows(window, "Oxford") && window.state().start.is_drawn()
    });
    window.run_steps(5);
    window.mask(egui::Rect::from_min_size(
        pos2(480.0, 320.0),
        egui::vec2(8.0, 8.0),
    ));
    let result = window.try_snapshot_options("nothing_open", &tolerance());
    assert!(
        result.is_err(),
        "a square of 64 other pixels went unnoticed"
    );
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/snapshots");
    for ending in ["new", "diff"] {
        let _ = std::fs::remove_file(folder.join(format!("nothing_open.{ending}.png")));
    }
}
