//! The window without a display: clicks and keys by accessible label, and pictures of it
//! on a software adapter.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use egui::accesskit::Role;
use egui::{Key, Modifiers, pos2};
use egui_kittest::kittest::Queryable;
use egui_kittest::wgpu::WgpuTestRenderer;
use egui_kittest::{Harness, HarnessBuilder, SnapshotOptions};

use super::app::{App, AppOptions};
use super::preview::PreviewSettings;
use crate::opened::Opened;
use pickglass::exemplar::ExemplarStore;
use pickglass::still::{EffectBase, EffectChoice};

type Window = Harness<'static, App>;

fn builder() -> HarnessBuilder<App> {
    Harness::builder()
        .with_size([960.0, 640.0])
        .with_theme(egui::Theme::Dark)
}

/// Pictures that are there at once: what they look like is tested elsewhere.
fn crude() -> PreviewSettings {
    let dial = |name: &str, value: &str| (name.to_owned(), value.to_owned());
    PreviewSettings {
        store: ExemplarStore::user(),
        effects: EffectChoice {
            base: EffectBase::None,
            changes: Vec::new(),
        },
        dials: vec![dial("pass-spp", "1"), dial("level", "4")],
    }
}

fn options() -> AppOptions {
    AppOptions {
        preview: crude(),
        ..AppOptions::default()
    }
}

fn build(builder: HarnessBuilder<App>, design: Option<&str>) -> Window {
    let opened = design.map(|name| Opened::preset(name).expect("a preset"));
    builder.build_eframe(|cc| App::new(&cc.egui_ctx, opened, options()).expect("a worker"))
}

/// Lets the window and its threads go on until `done`.
fn wait_for(window: &mut Window, what: &str, mut done: impl FnMut(&mut Window) -> bool) {
    let start = Instant::now();
    loop {
        window.step();
        if done(window) {
            return;
        }
        assert!(
            start.elapsed() < Duration::from_secs(120),
            "waited in vain for {what}"
        );
        std::thread::sleep(Duration::from_millis(5));
    }
}

fn shows(window: &Window, label: &str) -> bool {
    window.query_all_by_label(label).next().is_some()
}

fn says(window: &Window, part: &str) -> bool {
    window.query_all_by_label_contains(part).next().is_some()
}

#[test]
fn a_design_is_shown_and_refines() {
    let mut window = build(builder(), Some("oxford"));
    wait_for(&mut window, "a full picture", |window| {
        window.state().preview.has_full_picture()
    });
    assert!(shows(&window, "Cloth of Oxford"));
    assert!(shows(&window, "Drawdown of Oxford"));
    assert!(says(&window, "4 ends × 2 picks"));
    assert!(says(&window, " spp · "));
}

#[test]
fn the_menus_open_presets_and_change_the_view() {
    let mut window = build(builder(), Some("oxford"));
    window.step();
    window.get_by_label("File").click();
    window.run_steps(3);
    window.get_by_label_contains("Presets").click();
    window.run_steps(3);
    window.get_by_label("silk-satin").click();
    wait_for(&mut window, "the satin", |window| {
        shows(window, "Cloth of Silk satin")
    });

    window.get_by_label("View").click();
    window.run_steps(3);
    window
        .get_all_by_label_contains("Back")
        .next()
        .expect("a menu item")
        .click();
    wait_for(&mut window, "the back", |window| {
        window.state().preview.asked().map(|asked| asked.view)
            == Some(pickglass::render::View::Back)
    });
}

#[test]
fn every_command_of_a_menu_is_there_by_its_label() {
    use crate::command_table::{Menu, TABLE};
    for (menu, label) in [
        (Menu::File, "File"),
        (Menu::View, "View"),
        (Menu::Help, "Help"),
    ] {
        let mut window = build(builder(), Some("oxford"));
        window.step();
        window.get_by_label(label).click();
        window.run_steps(3);
        for row in TABLE.iter().filter(|row| row.menu == menu) {
            assert!(says(&window, row.label), "{} is not in {label}", row.label);
        }
    }
}

fn open_by_path(window: &mut Window, path: &str) {
    window.key_press_modifiers(Modifiers::COMMAND, Key::L);
    window.run_steps(3);
    window.get_by_role(Role::TextInput).type_text(path);
    window.run_steps(2);
    window.get_by_label("Open").click();
}

#[test]
fn a_missing_file_is_an_error_and_the_design_stays() {
    let mut window = build(builder(), Some("oxford"));
    window.step();
    // Letters that are shortcuts elsewhere are letters in the field.
    open_by_path(&mut window, "/absent/fdpt1.wif");
    wait_for(&mut window, "the message", |window| says(window, "Error"));
    assert!(says(&window, "/absent/fdpt1.wif"));
    assert!(shows(&window, "Oxford is still open."));
    assert!(shows(&window, "Drawdown of Oxford"));
    window.run_steps(3);
    window.get_by_label("Dismiss").click();
    wait_for(&mut window, "its end", |window| !says(window, "Error"));
}

#[test]
fn a_draft_opens_by_its_path() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("tabby.wif");
    std::fs::write(&path, TABBY).expect("written");
    let mut window = build(builder(), None);
    window.step();
    assert!(shows(&window, "Nothing is open"));
    open_by_path(&mut window, &path.display().to_string());
    wait_for(&mut window, "the draft", |window| {
        says(window, "Drawdown of ")
    });
}

#[derive(Debug)]
struct Dropped(PathBuf);

impl egui::DroppedFile for Dropped {
    fn path(&self) -> &std::path::Path {
        &self.0
    }
    fn bytes(&self) -> Result<Vec<u8>, String> {
        std::fs::read(&self.0).map_err(|error| error.to_string())
    }
}

#[test]
fn a_dropped_file_opens() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("tabby.wif");
    std::fs::write(&path, TABBY).expect("written");
    let mut window = build(builder(), None);
    window.step();
    let file = std::sync::Arc::new(Dropped(path));
    window.input_mut().dropped_files.push(file);
    wait_for(&mut window, "the draft", |window| {
        says(window, "Drawdown of ")
    });
}

#[test]
fn dragging_moves_the_cloth_and_the_wheel_zooms_at_the_pointer() {
    let mut window = build(builder(), Some("oxford"));
    window.step();
    let before = window.state().preview.cloth_view().expect("a view");
    wait_for(&mut window, "a picture", |window| {
        window.state().preview.pane.shown.is_some()
    });
    let start = pos2(600.0, 300.0);
    window.hover_at(start);
    window.step();
    window.drag_at(start);
    window.step();
    window.hover_at(start + egui::vec2(50.0, 20.0));
    window.step();
    window.drop_at(start + egui::vec2(50.0, 20.0));
    window.step();
    let after = window.state().preview.cloth_view().expect("a view");
    let moved = before.centre_mm[0] - after.centre_mm[0];
    assert!((moved / before.mm_per_point - 50.0).abs() < 0.5, "{moved}");

    window.hover_at(start);
    window.step();
    window.event(egui::Event::MouseWheel {
        unit: egui::MouseWheelUnit::Line,
        delta: egui::vec2(0.0, 3.0),
        phase: egui::TouchPhase::Move,
        source: egui::MouseWheelSource::Unknown,
        modifiers: Modifiers::NONE,
    });
    window.run_steps(30);
    assert!(
        window
            .state()
            .preview
            .cloth_view()
            .expect("a view")
            .mm_per_point
            < after.mm_per_point
    );
}

#[test]
fn stopping_says_so_and_can_be_undone() {
    let mut window = build(builder(), Some("oxford"));
    window.step();
    window.key_press(Key::P);
    wait_for(&mut window, "the stop", |window| {
        says(window, "Stopped") || says(window, "paused")
    });
    window.key_press(Key::P);
    wait_for(&mut window, "a picture", |window| {
        window.state().preview.pane.shown.is_some()
    });
}

#[test]
fn the_export_form_renders_into_a_file() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("out.png");
    let mut window = build(builder(), Some("oxford"));
    wait_for(&mut window, "a picture", |window| {
        window.state().preview.pane.shown.is_some()
    });
    window.state_mut().export.defaults = super::export::Defaults {
        width: 64,
        seconds: 0.1,
        path: Some(path.clone()),
    };
    window.key_press_modifiers(Modifiers::COMMAND, Key::E);
    window.run_steps(3);
    window.get_by_label("Render").click();
    wait_for(&mut window, "the picture", |window| says(window, "Wrote "));
    let picture = image::open(&path).expect("a picture");
    assert_eq!(picture.width(), 64);
}

/// A renderer of snapshots. Without an adapter the test is skipped, or fails where
/// goldens are required.
pub fn renderer(test: &str) -> Option<WgpuTestRenderer> {
    let renderer = std::panic::catch_unwind(WgpuTestRenderer::new).ok();
    if renderer.is_none() {
        let required = std::env::var_os("GOLDEN_REQUIRED").is_some();
        assert!(
            !required,
            "{test}: no graphics adapter: install mesa-vulkan-drivers"
        );
        eprintln!("skipped {test}: no graphics adapter: install mesa-vulkan-drivers");
    }
    renderer
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

/// Plain weave on two shafts.
const TABBY: &str = "[WIF]
Version=1.1
Date=April 20, 1997
Developers=wif@mhsoft.com
Source Program=test

[CONTENTS]
WEAVING=yes
WARP=yes
WEFT=yes
THREADING=yes
TIEUP=yes
TREADLING=yes

[WEAVING]
Shafts=2
Treadles=2
Rising Shed=yes

[WARP]
Threads=4
Units=Centimeters
Spacing=0.05

[WEFT]
Threads=4
Units=Centimeters
Spacing=0.05

[THREADING]
1=1
2=2
3=1
4=2

[TIEUP]
1=1
2=2

[TREADLING]
1=1
2=2
3=1
4=2
";
