//! Fields and forms: keys are theirs until they are left on purpose, and nothing that was
//! typed is given up by a click elsewhere or by a form that changes its size.

use egui::accesskit::Role;
use egui::{Event, Key, Modifiers, PointerButton, Pos2};
use egui_kittest::kittest::{By, NodeT, Queryable};

use super::opening::open_by_path;
use super::{TABBY, Window, build, builder, says, shows, wait_for};
use crate::command_table::{Command, Tool, WeaveCommand};
use crate::window::Pane;

fn window(design: Option<&str>) -> Window {
    let mut window = build(builder().with_size([1280.0, 1200.0]), design);
    window.state_mut().preview.freeze();
    window.run_steps(2);
    window
}

fn run_command(window: &mut Window, command: Command) {
    let ctx = window.ctx.clone();
    window.state_mut().run_command(&ctx, command);
    window.run_steps(6);
}

fn press(window: &mut Window, key: Key) {
    window.key_press(key);
    window.run_steps(3);
}

/// Puts the keyboard into a field and this text in the place of what is there.
fn type_over(window: &mut Window, role: Role, field: &str, text: &str) {
    window.get_by_role_and_label(role, field).focus();
    window.run_steps(3);
    retype(window, text);
}

/// Types over what has the keyboard; the letters also come as keys, as on a real mailbox.
fn retype(window: &mut Window, text: &str) {
    window.key_press_modifiers(Modifiers::COMMAND, Key::A);
    window.run_steps(2);
    for letter in text.chars() {
        let key = Key::from_name(&letter.to_uppercase().to_string());
        if let Some(key) = key {
            window.key_down(key);
        }
        window.event(Event::Text(letter.to_string()));
        if let Some(key) = key {
            window.key_up(key);
        }
    }
    window.run_steps(2);
}

/// The text of what has the keyboard.
fn typed(window: &Window) -> Option<String> {
    let focused = By::new().predicate(|node| node.is_focused());
    (window.query_all(focused))
        .find(|node| node.accesskit_node().role() != Role::Window)
        .and_then(|node| node.accesskit_node().value())
}

fn click(window: &mut Window, at: Pos2) {
    window.event(Event::PointerMoved(at));
    for pressed in [true, false] {
        window.event(Event::PointerButton {
            pos: at,
            button: PointerButton::Primary,
            pressed,
            modifiers: Modifiers::NONE,
        });
    }
    window.run_steps(4);
}

#[test]
fn stripes_with_a_mistake_keep_the_keyboard_until_they_are_right() {
    let mut window = window(Some("oxford"));
    run_command(&mut window, Command::Show(Pane::Yarns));
    let order = |window: &Window| {
        let design = window.state().document().expect("open").design().clone();
        design.maps().warp.order().map(<[_]>::to_vec)
    };
    let before = order(&window);
    type_over(&mut window, Role::TextInput, "Warp stripes", "3 lilac");
    press(&mut window, Key::Enter);
    assert!(says(&window, "lilac"), "what is wrong is told");
    assert_eq!(typed(&window).as_deref(), Some("3 lilac"));
    assert_eq!(order(&window), before);
    // The correction is typed at once: its letters are keys of tools elsewhere.
    let yarns = window.state().document().expect("open").design().yarns();
    let (first, last) = (yarns[0].name.clone(), yarns[yarns.len() - 1].name.clone());
    retype(&mut window, &format!("3 {first} 1 {last}"));
    assert_eq!(window.state().draft.tool(), Tool::Pencil);
    press(&mut window, Key::Enter);
    assert_eq!(order(&window).map(|order| order.len()), Some(4));
    assert_eq!(typed(&window), None, "the field is left");
    // Esc leaves as well, and the stripes are written as they are.
    type_over(&mut window, Role::TextInput, "Warp stripes", "9 nothing");
    press(&mut window, Key::Escape);
    window.run_steps(2);
    let field = window.get_by_role_and_label(Role::TextInput, "Warp stripes");
    let told = field.accesskit_node().value().unwrap_or_default();
    assert!(!told.contains("nothing") && told.contains('3'), "{told}");
}

#[test]
fn a_path_with_a_mistake_is_corrected_where_it_stands() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("tabby.wif");
    std::fs::write(&path, TABBY).expect("written");
    let mut window = window(Some("oxford"));
    window.key_press_modifiers(Modifiers::COMMAND, Key::L);
    window.run_steps(3);
    retype(&mut window, "/absent/lpg.wif");
    press(&mut window, Key::Enter);
    wait_for(&mut window, "what is wrong", |window| {
        says(window, "Error: ")
    });
    window.run_steps(3);
    assert_eq!(typed(&window).as_deref(), Some("/absent/lpg.wif"));
    assert!(shows(&window, "Drawdown of Oxford"));
    assert_eq!(window.state().draft.tool(), Tool::Pencil);
    retype(&mut window, &path.display().to_string());
    assert!(!says(&window, "Error: "), "the mistake is gone");
    press(&mut window, Key::Enter);
    wait_for(&mut window, "the draft", |window| {
        !shows(window, "Drawdown of Oxford")
    });
    assert!(!says(&window, "Open by path"));
}

#[test]
fn a_place_that_cannot_be_written_is_corrected_where_it_stands() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut window = window(Some("oxford"));
    window.key_press_modifiers(Modifiers::COMMAND, Key::S);
    window.run_steps(4);
    retype(&mut window, "/absent/folder/shawl.ron");
    press(&mut window, Key::Enter);
    wait_for(&mut window, "what is wrong", |window| {
        says(window, "Error: ")
    });
    window.run_steps(3);
    assert_eq!(typed(&window).as_deref(), Some("/absent/folder/shawl.ron"));
    let path = folder.path().join("shawl.ron");
    retype(&mut window, &path.display().to_string());
    press(&mut window, Key::Enter);
    wait_for(&mut window, "the file", |window| says(window, "Saved "));
    assert!(path.exists() && !says(&window, "Save as"));
}

#[test]
fn a_number_that_is_none_keeps_the_keyboard() {
    let mut window = window(Some("oxford"));
    run_command(&mut window, Command::Show(Pane::Sett));
    let field = |window: &Window| {
        let field = window.get_by_role_and_label(Role::SpinButton, "Ends a dent");
        field.accesskit_node().value().unwrap_or_default()
    };
    type_over(&mut window, Role::SpinButton, "Ends a dent", "3p");
    press(&mut window, Key::Enter);
    assert_eq!(typed(&window).as_deref(), Some("3p"));
    assert!(says(&window, "this is no number"));
    retype(&mut window, "3");
    assert!(!says(&window, "this is no number"));
    press(&mut window, Key::Enter);
    assert_eq!(field(&window), "3");
    press(&mut window, Key::L);
    assert_eq!(window.state().draft.tool(), Tool::Line, "the field is left");
}

#[test]
fn a_name_that_cannot_be_keeps_the_keyboard() {
    let mut window = window(Some("herringbone"));
    run_command(&mut window, Command::Show(Pane::Colourways));
    let names = |window: &Window| -> Vec<String> {
        let design = window.state().document().expect("open").design().clone();
        design.colourways().iter().map(|c| c.name.clone()).collect()
    };
    let before = names(&window);
    let [first, second] = [before[0].clone(), before[1].clone()];
    let label = format!("Rename {first}");
    window.get_by_label(&label).click_accesskit();
    window.run_steps(4);
    for wrong in ["", second.as_str()] {
        retype(&mut window, wrong);
        if wrong.is_empty() {
            window.key_press_modifiers(Modifiers::COMMAND, Key::A);
            press(&mut window, Key::Backspace);
        }
        press(&mut window, Key::Enter);
        assert_eq!(typed(&window).as_deref(), Some(wrong));
        assert!(says(&window, "Error: "));
        assert_eq!(names(&window), before);
    }
    retype(&mut window, "lagoon");
    press(&mut window, Key::Enter);
    assert_eq!(names(&window)[0], "lagoon");
    assert_eq!(typed(&window), None);
}

#[test]
fn a_click_beside_a_form_gives_nothing_up() {
    for command in [
        Command::ExportStill,
        Command::ExportVolume,
        Command::Weave(WeaveCommand::Words),
        Command::Weave(WeaveCommand::StampWeave),
        Command::Weave(WeaveCommand::Resize),
        Command::Print,
    ] {
        let mut window = window(Some("oxford"));
        run_command(&mut window, command);
        assert!(shows(&window, "Cancel"), "{command:?} is open");
        click(&mut window, Pos2::new(6.0, 600.0));
        assert!(
            shows(&window, "Cancel"),
            "{command:?} was closed by a click"
        );
        // Esc is on purpose.
        press(&mut window, Key::Escape);
        window.run_steps(3);
        assert!(!shows(&window, "Cancel"), "{command:?}");
    }
}

#[test]
fn buttons_stay_where_they_are_when_a_form_changes_its_size() {
    let mut window = window(Some("oxford"));
    run_command(&mut window, Command::ExportVolume);
    window.run_steps(6);
    let place = |window: &Window, label: &str| window.get_by_label(label).rect();
    let before = place(&window, "Count the bytes");
    // An error of several lines, then what will be written: neither moves the button.
    let absent = format!("/absent/{}.jpg", "long/".repeat(30));
    type_over(&mut window, Role::TextInput, "File", &absent);
    click(&mut window, before.center());
    wait_for(&mut window, "what is wrong", |window| {
        says(window, "Error: ")
    });
    window.run_steps(3);
    let now = place(&window, "Count the bytes");
    assert!((now.min - before.min).length() < 1.0, "{before:?}, {now:?}");
}

#[test]
fn a_message_that_comes_does_not_move_the_button_of_a_path() {
    let mut window = window(Some("oxford"));
    window.key_press_modifiers(Modifiers::COMMAND, Key::L);
    window.run_steps(8);
    retype(
        &mut window,
        "/absent/a/very/long/path/that/takes/more/than/a/line/to/be/told/of.wif",
    );
    let before = window.get_by_label("Open").rect();
    press(&mut window, Key::Enter);
    wait_for(&mut window, "what is wrong", |window| {
        says(window, "Error: ")
    });
    window.run_steps(3);
    let now = window.get_by_label("Open").rect();
    assert!((now.min - before.min).length() < 1.0, "{before:?}, {now:?}");
}

#[test]
fn a_photograph_is_proposed_to_be_posterised_without_an_error() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("sunset.png");
    let image = image::RgbImage::from_fn(64, 48, |x, y| {
        image::Rgb([(4 * x) as u8, (5 * y) as u8, ((x * y) % 251) as u8])
    });
    image.save(&path).expect("written");
    let mut window = window(None);
    open_by_path(&mut window, &path.display().to_string());
    wait_for(&mut window, "what it is", |window| {
        says(window, "A picture of")
    });
    assert!(!says(&window, "Error") && !says(&window, "pickglass posterize"));
    assert!(!says(&window, "--"));
    window.run_steps(4);
    // Enter is the first button's.
    window.key_press(Key::Enter);
    wait_for(&mut window, "the picture", |window| {
        shows(window, "Make it the design")
    });
}
