//! Looking at the cloth: menus, pan and zoom, pause, and the export of a still.

use egui::{Key, Modifiers, pos2};
use egui_kittest::kittest::Queryable;

use super::{build, builder, says, shows, wait_for};

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
    for menu in Menu::ALL {
        let label = menu.title();
        let mut window = build(builder(), Some("oxford"));
        window.step();
        window.get_by_label(label).click();
        window.run_steps(3);
        for row in TABLE.iter().filter(|row| row.menu == menu) {
            assert!(says(&window, row.label), "{} is not in {label}", row.label);
        }
    }
}

#[test]
fn dragging_moves_the_cloth_and_the_wheel_zooms_at_the_pointer() {
    let mut window = build(builder(), Some("oxford"));
    window.step();
    let before = window.state().preview.cloth_view().expect("a view");
    wait_for(&mut window, "a picture", |window| {
        window.state().preview.pane.shown.is_some()
    });
    let start = pos2(760.0, 200.0);
    window.hover_at(start);
    window.step();
    window.drag_at(start);
    window.step();
    window.hover_at(start + egui::vec2(50.0, 20.0));
    window.step();
    window.drop_at(start + egui::vec2(50.0, 20.0));
    window.step();
    let after = window.state().preview.cloth_view().expect("a view");
    // The cloth follows the pointer; turned by 180°, its ends run to the left.
    assert!(after.turned);
    let moved = after.centre_mm[0] - before.centre_mm[0];
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
    window.key_press_modifiers(Modifiers::SHIFT, Key::P);
    wait_for(&mut window, "the stop", |window| {
        says(window, "Stopped") || says(window, "paused")
    });
    window.key_press_modifiers(Modifiers::SHIFT, Key::P);
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
    window.state_mut().export.defaults = crate::window::export::Defaults {
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
