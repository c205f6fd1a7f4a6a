//! The window by keys alone: no pointer moves in these tests.

use egui::{Key, Modifiers, Rect, Vec2};
use egui_kittest::kittest::{By, NodeT, Queryable};
use pickglass::scene::View;

use super::files::modified;
use super::pictures::renderer;
use super::{Window, build, builder, open, says, shows, wait_for};
use crate::command_table::Tool;
use crate::window::session::blank;

fn still_window(design: &str) -> Window {
    let mut window = build(builder(), Some(design));
    window.state_mut().preview.freeze();
    window.run_steps(3);
    window
}

fn press(window: &mut Window, key: Key) {
    window.key_press(key);
    window.run_steps(2);
}

fn press_with(window: &mut Window, modifiers: Modifiers, key: Key) {
    window.key_press_modifiers(modifiers, key);
    window.run_steps(2);
}

fn up(window: &Window, end: u32, pick: u32) -> bool {
    let document = window.state().document().expect("a document");
    document.drawdown().get(end, pick)
}

/// The name and the place of what has the keyboard: nothing that has it is without a name.
fn focused(window: &Window) -> Option<(String, Rect)> {
    let node = window
        .query_all(By::new().predicate(|node| node.is_focused()))
        .find(|node| node.accesskit_node().role() != egui::Role::Window)?;
    let name = node.accesskit_node().label().unwrap_or_default();
    let (role, place) = (node.accesskit_node().role(), node.rect());
    assert!(!name.is_empty(), "no name: {role:?} at {place:?}");
    Some((name, place))
}

/// All names that Tab comes to, once round.
fn stops(window: &mut Window) -> Vec<String> {
    let mut names = Vec::new();
    for _ in 0..400 {
        press(window, Key::Tab);
        let Some((name, _)) = focused(window) else {
            continue;
        };
        if names.first() == Some(&name) {
            return names;
        }
        names.push(name);
    }
    panic!("Tab never came round: {names:?}");
}

#[test]
fn tab_comes_to_everything() {
    let mut window = open(builder(), Some(blank().expect("a design")));
    window.state_mut().preview.freeze();
    window.run_steps(3);
    let names = stops(&mut window);
    let wanted = [
        "File",
        "Cloth",
        "Find a command",
        "Pencil",
        "Stamp",
        "Paint mirrored left and right",
        "Exchange the yarns of the two buttons",
        "Drawdown of",
        "Threading",
        "Tie-up",
        "Warp colours",
        "Weft colours",
        "Cloth of",
        "Divider between Draft and Cloth",
        "Divider between Draft and Floats",
        "Floats",
        "Yarns",
        "Posterise",
        "History",
        "Log",
    ];
    for name in wanted {
        let there = names.iter().any(|stop| stop.starts_with(name));
        assert!(there, "no {name} among {names:?}");
    }
}

#[test]
fn dividers_are_moved_with_the_arrow_keys() {
    let mut window = still_window("oxford");
    let cloth = |window: &Window| {
        let cloth = window.query_all_by_label_contains("Cloth of ").next();
        cloth.expect("a cloth").rect()
    };
    let before = cloth(&window);
    for (name, key, back) in [
        (
            "Divider between Draft and Cloth",
            Key::ArrowLeft,
            Key::ArrowRight,
        ),
        (
            "Divider between Draft and Floats",
            Key::ArrowUp,
            Key::ArrowDown,
        ),
    ] {
        window.get_by_label(name).focus();
        window.run_steps(2);
        press(&mut window, key);
        let now = cloth(&window);
        let by = [before.left() - now.left(), before.bottom() - now.bottom()];
        let moved = if key == Key::ArrowLeft {
            [16.0, 0.0]
        } else {
            [0.0, 16.0]
        };
        assert!((by[0] - moved[0]).abs() < 1.5, "{name}: {by:?}");
        assert!((by[1] - moved[1]).abs() < 1.5, "{name}: {by:?}");
        // Never so far that a pane is lost.
        for _ in 0..100 {
            press(&mut window, key);
        }
        assert!(cloth(&window).height() > 80.0 && cloth(&window).width() < 900.0);
        for _ in 0..100 {
            press(&mut window, back);
        }
        assert!(cloth(&window).width() > 80.0);
        window.state_mut().layout.reset();
        window.run_steps(3);
        assert_eq!(cloth(&window), before);
    }
}

#[test]
fn arrows_move_the_crosshair_and_ctrl_goes_further() {
    let mut window = still_window("damask");
    press(&mut window, Key::F6);
    assert!(window.state().draft.has_focus(&window.ctx));
    press(&mut window, Key::ArrowRight);
    press(&mut window, Key::ArrowUp);
    assert_eq!(window.state().hover, Some((1, 1)));
    press_with(&mut window, Modifiers::COMMAND, Key::ArrowRight);
    press_with(&mut window, Modifiers::COMMAND, Key::ArrowUp);
    assert_eq!(window.state().hover, Some((9, 9)));
    press(&mut window, Key::ArrowLeft);
    press(&mut window, Key::ArrowDown);
    assert_eq!(window.state().hover, Some((8, 8)));
    assert!(says(&window, "pick 9"), "the status line tells of it");
}

#[test]
fn shift_makes_a_range_that_is_painted_at_once() {
    let mut window = still_window("damask");
    press(&mut window, Key::F6);
    for _ in 0..3 {
        press(&mut window, Key::ArrowRight);
    }
    for key in [Key::ArrowRight, Key::ArrowRight, Key::ArrowUp] {
        press_with(&mut window, Modifiers::SHIFT, key);
    }
    let range = || (3..6).flat_map(|end| [(end, 0), (end, 1)]);
    let around = [(2, 0), (6, 0), (3, 2), (2, 1), (6, 1)];
    let kept = around.map(|(end, pick)| up(&window, end, pick));
    press(&mut window, Key::Enter);
    assert!(range().all(|(end, pick)| up(&window, end, pick)));
    assert_eq!(around.map(|(end, pick)| up(&window, end, pick)), kept);
    let document = window.state().document().expect("open");
    assert_eq!(document.position(), 1, "one entry");

    // Backwards from where the cursor is, with the other paint.
    for key in [Key::ArrowLeft, Key::ArrowLeft, Key::ArrowDown] {
        press_with(&mut window, Modifiers::SHIFT, key);
    }
    press_with(&mut window, Modifiers::SHIFT, Key::Enter);
    assert!(range().all(|(end, pick)| !up(&window, end, pick)));
    assert_eq!(around.map(|(end, pick)| up(&window, end, pick)), kept);
    // Without Shift there is no range any more: one crossing is exchanged.
    press(&mut window, Key::ArrowRight);
    press(&mut window, Key::Enter);
    let changed = range().filter(|&(end, pick)| up(&window, end, pick));
    assert_eq!(changed.collect::<Vec<_>>(), [(4, 0)]);
}

#[test]
fn a_range_is_what_the_tool_makes_of_it() {
    let mut window = still_window("damask");
    press(&mut window, Key::F6);
    press(&mut window, Key::S);
    assert_eq!(window.state().draft.tool(), Tool::Select);
    for key in [Key::ArrowRight, Key::ArrowUp, Key::ArrowUp] {
        press_with(&mut window, Modifiers::SHIFT, key);
    }
    press(&mut window, Key::Enter);
    let selected = window.state().draft.selection().expect("selected");
    assert_eq!((selected.ends, selected.picks), (2, 3));
    assert!(!modified(&window));
    // Esc forgets the range first of all.
    press_with(&mut window, Modifiers::SHIFT, Key::ArrowRight);
    press(&mut window, Key::Escape);
    press(&mut window, Key::P);
    let cell = up(&window, 2, 2);
    press(&mut window, Key::Enter);
    assert_ne!(up(&window, 2, 2), cell, "one crossing is exchanged");
    let document = window.state().document().expect("open");
    assert_eq!(document.position(), 1);
}

#[test]
fn the_menu_key_opens_the_menu_and_gives_the_keyboard_back() {
    let mut window = still_window("damask");
    for shifted in [false, true] {
        press(&mut window, Key::F6);
        if !window.state().draft.has_focus(&window.ctx) {
            press(&mut window, Key::F6);
        }
        window.state_mut().draft.select(None);
        if shifted {
            press_with(&mut window, Modifiers::SHIFT, Key::F10);
        } else {
            press(&mut window, Key::Menu);
        }
        assert!(shows(&window, "Select all"), "the menu is open");
        // Undo, redo, cut, copy, paste: the sixth is to select all.
        let mut at = focused(&window).map(|(name, _)| name);
        for _ in 0..12 {
            if at.as_deref() == Some("Select all") {
                break;
            }
            press(&mut window, Key::Tab);
            at = focused(&window).map(|(name, _)| name);
        }
        assert_eq!(at.as_deref(), Some("Select all"));
        press(&mut window, Key::Enter);
        window.run_steps(2);
        assert!(window.state().draft.selection().is_some());
        assert!(!shows(&window, "Select all"), "the menu is closed");
        assert!(window.state().draft.has_focus(&window.ctx));
    }
}

#[test]
fn the_cloth_is_looked_at_from_all_sides() {
    let mut window = still_window("oxford");
    let asked = |window: &Window| window.state().preview.asked().expect("asked").clone();
    let view = |window: &Window| window.state().preview.cloth_view().expect("a view");
    let straight = asked(&window);
    assert_eq!(straight.eye, None);

    press(&mut window, Key::T);
    assert_eq!(asked(&window).view, View::Back);
    press(&mut window, Key::T);
    assert_eq!(asked(&window).view, View::Face);

    press(&mut window, Key::PageDown);
    let lowered = asked(&window).eye.expect("turned");
    assert_eq!((lowered.azimuth, lowered.elevation), (-90, 85));
    press(&mut window, Key::OpenBracket);
    assert_eq!(asked(&window).eye.expect("turned").azimuth, -95);
    press(&mut window, Key::CloseBracket);
    press(&mut window, Key::PageUp);
    let raised = asked(&window).eye.expect("turned");
    assert_eq!((raised.azimuth, raised.elevation), (-90, 90));
    press(&mut window, Key::Num0);
    assert_eq!(asked(&window).eye, None);

    let both = Modifiers::COMMAND.plus(Modifiers::SHIFT);
    let before = view(&window);
    press_with(&mut window, both, Key::ArrowRight);
    press_with(&mut window, both, Key::ArrowUp);
    let after = view(&window);
    // Of a turned cloth the next ends lie at the left, and the next picks below.
    assert!(after.turned);
    assert!(after.centre_mm[0] < before.centre_mm[0]);
    assert!(after.centre_mm[1] < before.centre_mm[1]);

    // With the keyboard on the cloth, arrows and zoom are the cloth's.
    press(&mut window, Key::F6);
    press(&mut window, Key::F6);
    assert!(focused(&window).is_some_and(|(name, _)| name.starts_with("Cloth of")));
    press(&mut window, Key::ArrowLeft);
    assert!(view(&window).centre_mm[0] > after.centre_mm[0]);
    press(&mut window, Key::Plus);
    assert!(view(&window).mm_per_point < after.mm_per_point);
}

#[test]
fn a_design_is_opened_changed_and_taken_back_without_a_pointer() {
    let mut window = build(builder(), None);
    wait_for(&mut window, "the thumbnails", |window| {
        shows(window, "Oxford")
    });
    for _ in 0..60 {
        press(&mut window, Key::Tab);
        if focused(&window).is_some_and(|(name, _)| name == "Oxford") {
            break;
        }
    }
    press(&mut window, Key::Enter);
    wait_for(&mut window, "the design", |window| {
        shows(window, "Drawdown of Oxford")
    });
    window.state_mut().preview.freeze();
    press_with(&mut window, Modifiers::COMMAND, Key::I);
    assert!(modified(&window));
    press(&mut window, Key::Z);
    assert!(!modified(&window));
}

/// Pixels in which two pictures differ.
fn differing(one: &image::RgbaImage, other: &image::RgbaImage) -> usize {
    let pairs = one.pixels().zip(other.pixels());
    let far = |(a, b): &(&image::Rgba<u8>, &image::Rgba<u8>)| {
        a.0.iter().zip(b.0).any(|(a, b)| a.abs_diff(b) > 24)
    };
    pairs.filter(far).count()
}

#[test]
fn whatever_has_the_keyboard_is_seen() {
    for theme in [egui::Theme::Dark, egui::Theme::Light] {
        let Some(renderer) = renderer("pictures of the focus") else {
            return;
        };
        let builder = builder()
            .with_size(Vec2::new(1600.0, 1000.0))
            .with_theme(theme)
            .renderer(renderer);
        let mut window = open(builder, Some(blank().expect("a design")));
        window.state_mut().preview.freeze();
        // What threads work out is there before the first picture.
        wait_for(&mut window, "the floats", |window| {
            says(window, "No float is longer") || says(window, " long floats")
        });
        window.run_steps(10);
        let plain = window.render().expect("a picture");
        // The same state twice is the same picture.
        window.run_steps(2);
        let again = window.render().expect("a picture");
        assert_eq!(differing(&plain, &again), 0);
        let (mut first, mut seen) = (None, 0);
        for _ in 0..400 {
            press(&mut window, Key::Tab);
            let Some((name, place)) = focused(&window) else {
                continue;
            };
            if first.as_ref() == Some(&name) {
                break;
            }
            let picture = window.render().expect("a picture");
            let changed = differing(&plain, &picture);
            assert!(changed >= 30, "{theme:?}: {name} at {place:?}: {changed}");
            first.get_or_insert(name);
            seen += 1;
        }
        assert!(seen > 30, "{seen}");
    }
}

#[test]
fn hard_cases_are_tried_and_given_up_by_key() {
    let mut window = still_window("oxford");
    press_with(&mut window, Modifiers::COMMAND, Key::K);
    window.event(egui::Event::Text("check this machine".to_owned()));
    window.run_steps(2);
    press(&mut window, Key::Enter);
    wait_for(&mut window, "a case", |window| {
        says(window, "walks ended and counted")
    });
    assert!(shows(&window, "rays-that-are-none"));
    press(&mut window, Key::Escape);
    assert!(!shows(&window, "rays-that-are-none"));
}
