//! Looking at the cloth: menus, pan and zoom, pause, and the export of a still.

use egui::accesskit::Role;
use egui::{Key, Modifiers, pos2};
use egui_kittest::kittest::{NodeT, Queryable};

use pickglass::edit::Edit;

use super::{Window, build, builder, says, shows, wait_for};
use crate::window::worker::Quality;

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
fn refining_waits_while_the_window_is_minimised_and_ends_where_the_person_says() {
    let mut window = build(builder(), Some("oxford"));
    let mut minimised = |minimised: bool| {
        let input = window.input_mut();
        let root = input.viewports.entry(egui::ViewportId::ROOT).or_default();
        (root.minimized, root.occluded) = (Some(minimised), Some(false));
        window.step();
        window.state().preview.is_hidden()
    };
    assert!(minimised(true));
    assert!(!minimised(false));
    window.get_by_label("View").click();
    window.run_steps(3);
    window.get_by_label_contains("Refine until").click();
    window.run_steps(3);
    window.get_by_label("fine: error 1 %").click();
    window.run_steps(3);
    assert_eq!(window.state().preview.quality, Quality::Fine);
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
        window.state().preview.asked().map(|asked| asked.view) == Some(pickglass::scene::View::Back)
    });
}

#[test]
fn edits_that_weave_the_same_cloth_keep_its_picture() {
    let mut window = build(builder(), Some("herringbone"));
    wait_for(&mut window, "a full picture", |window| {
        window.state().preview.has_full_picture()
    });
    let asked = window.state().preview.generation();
    let same = |window: &mut Window, what: &str| {
        window.run_steps(4);
        assert_eq!(window.state().preview.generation(), asked, "{what}");
        assert!(window.state().preview.has_full_picture(), "{what}");
    };
    let edit = |window: &mut Window, edit: Edit| window.state_mut().edit(edit);
    edit(&mut window, Edit::Rename("other".to_owned()));
    same(&mut window, "another name");
    assert!(shows(&window, "Cloth of other"), "which is told");
    edit(&mut window, Edit::DeriveDraft { after: None });
    same(&mut window, "a derived draft");
    edit(&mut window, Edit::BecomeJacquard { then: None });
    same(&mut window, "a jacquard");
    for _ in 0..3 {
        window.state_mut().step_back();
        same(&mut window, "undo");
    }
    // Another colour is another cloth.
    let mut yarn = window.state().document().expect("open").design().yarns()[0].clone();
    yarn.colour = pickglass::design::Srgb(1, 200, 3);
    let to = Box::new(yarn);
    let yarn = pickglass::design::YarnId(0);
    edit(&mut window, Edit::SetYarn { yarn, to });
    window.run_steps(4);
    assert_ne!(window.state().preview.generation(), asked);
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
        width: Some(64),
        seconds: Some(0.1),
        path: Some(path.clone()),
    };
    window.key_press_modifiers(Modifiers::COMMAND, Key::E);
    window.run_steps(3);
    window.get_by_label("Render").click();
    wait_for(&mut window, "the picture", |window| says(window, "Wrote "));
    let picture = image::open(&path).expect("a picture");
    assert_eq!(picture.width(), 64);
    // Unless it is said otherwise, no background shows between the threads.
    let written = std::fs::read(&path).expect("read");
    let settings = b"--backing self";
    assert!(
        written
            .windows(settings.len())
            .any(|bytes| bytes == settings)
    );
}

#[test]
fn the_export_form_proposes_what_the_machine_can_do_and_says_the_error() {
    let mut window = build(builder(), Some("oxford"));
    wait_for(&mut window, "a measured picture", |window| {
        window.state().preview.pane.measured().is_some()
    });
    window.state_mut().preview.pause();
    let measured = window.state().preview.pane.measured();
    let asked = window.state().preview.asked().expect("asked").clone();
    let aspect = f64::from(asked.height) / f64::from(asked.width);
    let proposal = crate::window::pace::propose(measured, aspect);
    window.key_press_modifiers(Modifiers::COMMAND, Key::E);
    window.run_steps(6);
    assert!(says(&window, "An error of about"));
    let width = window.get_by_role_and_label(Role::SpinButton, "Width");
    let width = width.accesskit_node().value().unwrap_or_default();
    assert!(width.starts_with(&proposal.width.to_string()), "{width}");
    // Another end of the refining, another expectation.
    window.get_by_label("Refine until the error is").click();
    window.run_steps(3);
    assert!(!says(&window, "An error of about") && says(&window, "as this machine traced"));
}

#[test]
fn the_settings_say_what_exemplars_take_and_bound_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("a.exemplars");
    std::fs::write(&file, vec![0u8; 3_000_000]).expect("written");
    let mut window = build(builder(), Some("oxford"));
    window.state_mut().preview.freeze();
    window.state_mut().store = pickglass::exemplar::ExemplarStore::at(folder.path(), 1 << 30);
    let open = |window: &mut Window| {
        window.key_press_modifiers(Modifiers::COMMAND, Key::Comma);
        window.run_steps(6);
    };
    open(&mut window);
    assert!(says(&window, "3.0 MB"));
    window.get_by_label("Empty").click();
    window.run_steps(4);
    assert!(!file.exists() && !says(&window, "3.0 MB"));
    let field = window.get_by_role_and_label(Role::SpinButton, "At most");
    field.focus();
    window.run_steps(3);
    window.key_press_modifiers(Modifiers::COMMAND, Key::A);
    window.run_steps(2);
    window.event(egui::Event::Text("0.5".to_owned()));
    window.run_steps(2);
    window.get_by_label("Apply").click();
    window.run_steps(4);
    assert!(!shows(&window, "Settings"), "the form is closed");
    assert_eq!(window.state().store.limit(), 500_000_000);
}
