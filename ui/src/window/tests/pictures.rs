//! Reference pictures of the window on a software adapter.

use eframe::egui_wgpu::{RenderState, RendererOptions};
use egui::pos2;
use egui_kittest::SnapshotOptions;
use egui_kittest::wgpu::{WgpuTestRenderer, create_render_state, default_wgpu_setup};

use super::{build, builder, open, shows, wait_for};
use crate::command_table::{Command, DraftLayout};
use crate::opened::Opened;
use crate::window::session::blank;

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

/// What a person may meet, by name.
fn states() -> Vec<(&'static str, Option<&'static str>, Vec<Command>)> {
    vec![
        ("start", None, vec![]),
        ("blank", Some(""), vec![]),
        (
            "blank scandinavian",
            Some(""),
            vec![
                Command::Arrange(DraftLayout::Scandinavian),
                Command::LongFloats,
            ],
        ),
        ("draft", Some("default"), vec![Command::Navigator]),
        (
            "structure",
            Some("herringbone"),
            vec![Command::Structure, Command::SelectAll],
        ),
        ("jacquard", Some("damask"), vec![Command::Navigator]),
        ("palette", Some("oxford"), vec![Command::Palette]),
        ("shortcuts", Some("oxford"), vec![Command::Shortcuts]),
        ("repeat", Some("oxford"), vec![Command::Repeat]),
        (
            "unsaved",
            Some("oxford"),
            vec![Command::Invert, Command::New],
        ),
    ]
}

#[test]
fn every_state_draws_itself_at_every_size_in_both_themes() {
    let folder = std::env::var_os("PICKGLASS_PICTURES");
    for (theme, word) in [(egui::Theme::Dark, "dark"), (egui::Theme::Light, "light")] {
        for size in [[1024.0, 640.0], [2560.0, 1440.0]] {
            for (name, design, commands) in states() {
                let Some(renderer) = renderer("pictures of states") else {
                    return;
                };
                let builder = builder()
                    .with_size(size)
                    .with_theme(theme)
                    .renderer(renderer);
                let opened = match design {
                    Some("") => Some(blank().expect("a design")),
                    Some(preset) => Some(Opened::preset(preset).expect("a preset")),
                    None => None,
                };
                let mut window = open(builder, opened);
                window.state_mut().preview.freeze();
                window.run_steps(5);
                let ctx = window.ctx.clone();
                for command in commands {
                    window.state_mut().obey(&ctx, command);
                    window.run_steps(3);
                }
                // Thumbnails and the navigator are drawn on threads.
                std::thread::sleep(std::time::Duration::from_millis(300));
                window.run_steps(5);
                let picture = window.render().expect("a picture");
                let first = picture.get_pixel(2, 2);
                let other = picture.pixels().filter(|pixel| *pixel != first).count();
                assert!(other > 10_000, "{name} {word}: nothing is drawn");
                if let Some(folder) = &folder {
                    let file = format!("{name} {word} {}.png", size[0]);
                    let _ = picture.save(std::path::Path::new(folder).join(file));
                }
            }
        }
    }
}
