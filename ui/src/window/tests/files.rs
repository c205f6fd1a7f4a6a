//! Saving, closing with unsaved work, and what is remembered.

use egui::accesskit::Role;
use egui::{Key, Modifiers, ViewportCommand};
use egui_kittest::kittest::Queryable;
use pickglass::formats::{self, LoadOptions};

use super::opening::open_by_path;
use super::{Window, build, builder, options, says, shows, wait_for};
use crate::opened::Opened;
use crate::window::app::{App, AppOptions};
use crate::window::autosave::RecoveryFolder;
use crate::window::settings::SettingsFile;

pub fn invert(window: &mut Window) {
    window.key_press_modifiers(Modifiers::COMMAND, Key::I);
    window.run_steps(2);
}

pub fn modified(window: &Window) -> bool {
    window.state().document().expect("open").is_modified()
}

/// Types a path into the field that stands in for the system's dialog.
pub fn type_path(window: &mut Window, path: &str, button: &str) {
    wait_for(window, "the field", |window| {
        window.query_by_role(Role::TextInput).is_some()
    });
    let field = window.get_by_role(Role::TextInput);
    field.focus();
    window.run_steps(2);
    window.key_press_modifiers(Modifiers::COMMAND, Key::A);
    window.run_steps(2);
    window.get_by_role(Role::TextInput).type_text(path);
    window.run_steps(2);
    window.get_by_label(button).click();
}

#[test]
fn a_design_is_saved_under_a_name_and_again_without_asking() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("mine.ron");
    let mut window = build(builder(), Some("oxford"));
    window.state_mut().preview.freeze();
    window.step();
    invert(&mut window);
    assert!(modified(&window));
    window.key_press_modifiers(Modifiers::COMMAND, Key::S);
    type_path(&mut window, &path.display().to_string(), "Save");
    wait_for(&mut window, "the file", |window| says(window, "Saved "));
    assert!(!modified(&window));
    let read = |path: &std::path::Path| {
        let imported = formats::load(path, &LoadOptions::default()).expect("read");
        imported.design.weave()
    };
    let document = window.state().document().expect("open");
    assert_eq!(read(&path), **document.drawdown());

    invert(&mut window);
    window.key_press_modifiers(Modifiers::COMMAND, Key::S);
    wait_for(&mut window, "the second save", |window| !modified(window));
    let document = window.state().document().expect("open");
    assert_eq!(read(&path), **document.drawdown());
}

#[test]
fn a_folder_that_is_not_there_keeps_the_work_and_says_so() {
    let mut window = build(builder(), Some("oxford"));
    window.state_mut().preview.freeze();
    window.step();
    invert(&mut window);
    window.key_press_modifiers(Modifiers::COMMAND, Key::S);
    type_path(&mut window, "/absent/folder/mine.ron", "Save");
    wait_for(&mut window, "the message", |window| says(window, "Error"));
    assert!(says(&window, "/absent/folder"));
    assert!(modified(&window));
}

#[test]
fn unsaved_work_is_asked_about_before_another_design_opens() {
    let mut window = build(builder(), Some("oxford"));
    window.state_mut().preview.freeze();
    window.step();
    invert(&mut window);
    window.key_press_modifiers(Modifiers::COMMAND, Key::N);
    window.run_steps(3);
    assert!(says(&window, "Oxford has changes"));
    window.get_by_label("Cancel").click();
    window.run_steps(3);
    assert!(shows(&window, "Drawdown of Oxford"));
    window.key_press_modifiers(Modifiers::COMMAND, Key::N);
    window.run_steps(3);
    window.get_by_label("Do not save").click();
    wait_for(&mut window, "the new design", |window| {
        shows(window, "Drawdown of untitled")
    });
}

#[test]
fn closing_with_unsaved_work_is_held_and_without_it_is_not() {
    let mut window = build(builder(), Some("oxford"));
    window.state_mut().preview.freeze();
    window.step();
    let close = |window: &mut Window| {
        let viewport = window.ctx.viewport_id();
        let input = window.input_mut();
        let info = input.viewports.entry(viewport).or_default();
        info.events.push(egui::ViewportEvent::Close);
        window.step();
        let output = &window.output().viewport_output[&viewport];
        let held = output.commands.contains(&ViewportCommand::CancelClose);
        if let Some(info) = window.input_mut().viewports.get_mut(&viewport) {
            info.events.clear();
        }
        held
    };
    assert!(!close(&mut window));
    invert(&mut window);
    assert!(close(&mut window));
    window.run_steps(3);
    assert!(says(&window, "Oxford has changes"));
    window.get_by_label("Do not save").click();
    window.run_steps(2);
    assert!(window.state().may_close);
}

#[test]
fn recent_files_and_the_theme_are_remembered() {
    let folder = tempfile::tempdir().expect("a folder");
    let design = folder.path().join("tabby.wif");
    std::fs::write(&design, super::TABBY).expect("written");
    let settings = SettingsFile::at(folder.path().join("window.ron"));
    let start = |settings: &SettingsFile| -> Window {
        let options = AppOptions {
            settings: settings.clone(),
            ..options()
        };
        builder().build_eframe(|cc| App::new(&cc.egui_ctx, None, options).expect("a worker"))
    };
    let mut window = start(&settings);
    window.step();
    open_by_path(&mut window, &design.display().to_string());
    wait_for(&mut window, "the draft", |window| {
        says(window, "Drawdown of ")
    });
    window.key_press_modifiers(Modifiers::COMMAND, Key::T);
    window.run_steps(2);
    let ctx = window.ctx.clone();
    window.state_mut().keep_now(&ctx);
    drop(window);

    let mut window = start(&settings);
    window.run_steps(2);
    assert!(shows(&window, "tabby.wif"));
    // The harness sets a theme of its own after the start.
    assert!(window.state().settings.light);
    window.get_by_label("tabby.wif").click();
    wait_for(&mut window, "the draft", |window| {
        says(window, "Drawdown of ")
    });
}

#[test]
fn work_that_was_not_saved_is_offered_at_the_next_start() {
    let folder = tempfile::tempdir().expect("a folder");
    let recovery = RecoveryFolder::at(folder.path().to_owned());
    let start = |design: Option<&str>| -> Window {
        let opened = design.map(|name| Opened::preset(name).expect("a preset"));
        let options = AppOptions {
            recovery: recovery.clone(),
            ..options()
        };
        builder().build_eframe(|cc| App::new(&cc.egui_ctx, opened, options).expect("a worker"))
    };
    let copies = || {
        let entries = std::fs::read_dir(folder.path()).expect("a folder");
        let endings = entries.flatten().map(|entry| entry.path());
        endings
            .filter(|path| path.extension().is_some_and(|is| is == "recovery"))
            .count()
    };
    let mut window = start(Some("oxford"));
    window.state_mut().preview.freeze();
    window.step();
    assert_eq!(copies(), 0, "nothing is copied before anything changed");
    invert(&mut window);
    let changed = window.state().document().expect("open").drawdown().clone();
    wait_for(&mut window, "the copy", |_| copies() == 1);
    // The window is gone without a word.
    drop(window);

    let mut window = start(None);
    wait_for(&mut window, "the offer", |window| {
        shows(window, "Recover Oxford")
    });
    window.get_by_label("Recover Oxford").click();
    wait_for(&mut window, "the work", |window| {
        shows(window, "Drawdown of Oxford")
    });
    let document = window.state().document().expect("open");
    assert_eq!(*document.drawdown(), changed);
    assert!(document.is_modified());
}

#[test]
fn the_draft_is_printed_and_exported() {
    let folder = tempfile::tempdir().expect("a folder");
    let (pdf, wif) = (
        folder.path().join("oxford.pdf"),
        folder.path().join("oxford.wif"),
    );
    let mut window = build(builder(), Some("oxford"));
    window.state_mut().preview.freeze();
    window.step();
    window.key_press_modifiers(Modifiers::COMMAND, Key::P);
    type_path(&mut window, &pdf.display().to_string(), "Print");
    // The file stands before its field is closed, and that takes the keys.
    wait_for(&mut window, "the pages", |window| {
        pdf.exists() && !window.state().files.is_asking()
    });
    assert!(std::fs::read(&pdf).expect("read").starts_with(b"%PDF"));
    window.key_press_modifiers(Modifiers::COMMAND.plus(Modifiers::SHIFT), Key::E);
    type_path(&mut window, &wif.display().to_string(), "Export");
    wait_for(&mut window, "the draft", |_| wif.exists());
    let read = formats::load(&wif, &LoadOptions::default()).expect("read");
    let document = window.state().document().expect("open");
    assert_eq!(read.design.weave(), **document.drawdown());
    assert!(!modified(&window));
}

#[test]
fn presets_are_offered_as_thumbnails() {
    let mut window = build(builder(), None);
    wait_for(&mut window, "the thumbnails", |window| {
        shows(window, "Herringbone")
    });
    window.run_steps(3);
    window.get_by_label("Herringbone").click();
    wait_for(&mut window, "the design", |window| {
        shows(window, "Drawdown of Herringbone")
    });
}

#[test]
fn an_image_is_written_as_its_form_says() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut window = build(builder(), Some("herringbone"));
    window.state_mut().preview.freeze();
    window.run_steps(2);
    let drawdown = {
        let document = window.state().document().expect("open");
        std::sync::Arc::clone(document.drawdown())
    };
    // What a reader who is told nothing makes of the file: black is warp up, and the
    // lowest row is pick 1.
    let read = |path: &std::path::Path| {
        let image = image::open(path).expect("an image").to_luma8();
        let black = |end, pick| image.get_pixel(end, image.height() - 1 - pick).0[0] == 0;
        let size = (image.width(), image.height());
        pickglass::design::WeavePattern::from_fn(size.0, size.1, black)
    };
    let mut write = |name: &str, answers: &[&str]| {
        let path = folder.path().join(name);
        window.key_press_modifiers(Modifiers::COMMAND.plus(Modifiers::SHIFT), Key::E);
        window.run_steps(3);
        type_path(&mut window, &path.display().to_string(), "Export");
        window.run_steps(3);
        assert!(!path.exists(), "written before it was asked about");
        for answer in answers {
            window.get_by_label(answer).click();
            window.run_steps(2);
        }
        window.get_by_label("Write it").click();
        wait_for(&mut window, "the image", |_| path.exists());
        path
    };
    let usual = read(&write("usual.png", &[]));
    assert_eq!(usual, *drawdown);
    // From an upper corner the image is turned by 180°.
    let other = read(&write("other.png", &["weft up", "upper left"]));
    let (ends, picks) = (drawdown.ends(), drawdown.picks());
    assert_eq!((other.ends(), other.picks()), (ends, picks));
    for (end, pick) in (0..picks).flat_map(|pick| (0..ends).map(move |end| (end, pick))) {
        assert_eq!(
            other.get(end, pick),
            !drawdown.get(ends - 1 - end, picks - 1 - pick),
            "{end} {pick}"
        );
    }
    assert_ne!(other, usual);
}
