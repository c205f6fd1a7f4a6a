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
    assert!(shows(&window, "Drawdown of Oxford"));
    window.run_steps(3);
    window.key_press(Key::Escape);
    wait_for(&mut window, "its end", |window| !says(window, "Error"));
    assert!(shows(&window, "Drawdown of Oxford"));
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

/// Lets a form that has changed its size find its place.
fn settle(window: &mut Window) {
    window.run_steps(4);
}

/// A checked image of 8 × 4 pixels, its lower left pixel black.
fn checked(folder: &std::path::Path) -> PathBuf {
    let path = folder.join("checked.png");
    let image = image::GrayImage::from_fn(8, 4, |x, y| {
        image::Luma([if (x + y) % 2 == 1 { 0 } else { 255 }])
    });
    image.save(&path).expect("written");
    path
}

#[test]
fn an_image_is_asked_about_beside_a_preview() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = checked(folder.path());
    let up = |window: &Window| {
        let document = window.state().document().expect("open");
        (document.drawdown().get(0, 0), document.drawdown().ends())
    };
    for (black, expected) in [(None, true), (Some("weft up"), false)] {
        let mut window = build(builder(), None);
        window.step();
        open_by_path(&mut window, &path.display().to_string());
        wait_for(&mut window, "the preview", |window| {
            says(window, "8 ends × 4 picks")
        });
        assert!(window.state().document().is_none(), "nothing opens unasked");
        if let Some(black) = black {
            settle(&mut window);
            window.get_by_label(black).click();
            window.run_steps(2);
            wait_for(&mut window, "the preview again", |window| {
                says(window, "black = weft up")
            });
        }
        settle(&mut window);
        window.get_by_label("Open it").click();
        wait_for(&mut window, "the design", |window| {
            says(window, "Drawdown of ")
        });
        window.state_mut().preview.freeze();
        assert_eq!(up(&window), (expected, 8), "{black:?}");
    }
}

#[test]
fn an_image_that_is_given_up_leaves_what_was_open() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = checked(folder.path());
    let mut window = build(builder(), Some("oxford"));
    window.state_mut().preview.freeze();
    window.step();
    open_by_path(&mut window, &path.display().to_string());
    wait_for(&mut window, "the form", |window| {
        says(window, "Open the image")
    });
    settle(&mut window);
    window.get_by_label("Cancel").click();
    window.run_steps(3);
    assert!(!says(&window, "Open the image"));
    assert!(shows(&window, "Drawdown of Oxford"));
}

#[test]
fn a_photograph_goes_on_to_be_posterised() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("sunset.png");
    let image = image::RgbImage::from_fn(64, 48, |x, y| {
        image::Rgb([(4 * x) as u8, (5 * y) as u8, ((x * y) % 251) as u8])
    });
    image.save(&path).expect("written");
    let mut window = build(builder(), None);
    window.step();
    open_by_path(&mut window, &path.display().to_string());
    wait_for(&mut window, "the form", |window| {
        says(window, "Open the image")
    });
    settle(&mut window);
    window
        .get_by_label("A photograph, to be posterised")
        .click();
    window.run_steps(2);
    settle(&mut window);
    window.get_by_label("Posterise").click();
    wait_for(&mut window, "the picture", |window| {
        shows(window, "Make it the design")
    });
}
