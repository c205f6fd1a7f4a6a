//! Opening files: by path, by dropping, and what happens when they are not there.

use std::path::PathBuf;

use egui::accesskit::Role;
use egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable;

use super::{TABBY, Window, build, builder, says, shows, wait_for};

pub fn open_by_path(window: &mut Window, path: &str) {
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
    assert!(shows(&window, "Open by path…"));
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
