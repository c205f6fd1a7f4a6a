//! Painting in the draft, with the pointer and with the keyboard, and taking it back.

use egui::{Event, Key, Modifiers, PointerButton, Pos2};
use egui_kittest::kittest::Queryable;
use pickglass::design::Structure;

use super::{Window, build, builder, says, shows, wait_for};
use crate::command_table::Tool;

/// A window of a design whose cloth is not drawn.
fn still_window(design: &str) -> Window {
    let mut window = build(builder(), Some(design));
    window.state_mut().preview.freeze();
    window.run_steps(3);
    window
}

fn up(window: &Window, end: u32, pick: u32) -> bool {
    let document = window.state().document().expect("a document");
    document.drawdown().get(end, pick)
}

fn button(window: &mut Window, at: Pos2, button: PointerButton, pressed: bool) {
    window.event(Event::PointerButton {
        pos: at,
        button,
        pressed,
        modifiers: Modifiers::NONE,
    });
    window.step();
}

/// Presses on the first cell, moves through the others and lets go.
fn stroke(window: &mut Window, cells: &[(i64, i64)], with: PointerButton) {
    let places: Vec<Pos2> = (cells.iter())
        .map(|&cell| window.state().draft.place_of(cell))
        .collect();
    drag(window, &places, with);
}

fn drag(window: &mut Window, places: &[Pos2], with: PointerButton) {
    window.event(Event::PointerMoved(places[0]));
    window.step();
    button(window, places[0], with, true);
    for place in &places[1..] {
        window.event(Event::PointerMoved(*place));
        window.step();
    }
    button(window, places[places.len() - 1], with, false);
    window.run_steps(2);
}

fn entries(window: &Window) -> usize {
    window.state().document().expect("a document").position()
}

#[test]
fn a_stroke_paints_is_one_entry_and_is_taken_back() {
    let mut window = still_window("damask");
    let before: Vec<bool> = (0..8).map(|end| up(&window, end, 3)).collect();
    stroke(
        &mut window,
        &[(0, 3), (3, 3), (7, 3)],
        PointerButton::Primary,
    );
    assert!((0..8).all(|end| up(&window, end, 3)), "painted warp up");
    assert_eq!(entries(&window), 1);
    stroke(&mut window, &[(0, 3), (7, 3)], PointerButton::Secondary);
    assert!((0..8).all(|end| !up(&window, end, 3)), "painted weft up");
    assert_eq!(entries(&window), 2);
    window.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    window.run_steps(2);
    window.key_press(Key::Z);
    window.run_steps(2);
    let after: Vec<bool> = (0..8).map(|end| up(&window, end, 3)).collect();
    assert_eq!(after, before);
    assert!(!window.state().document().expect("open").is_modified());
    window.key_press_modifiers(Modifiers::SHIFT, Key::Z);
    window.run_steps(2);
    assert!((0..8).all(|end| up(&window, end, 3)), "made again");
}

#[test]
fn escape_gives_a_stroke_up() {
    let mut window = still_window("damask");
    let before = up(&window, 2, 2);
    let with = if before {
        PointerButton::Secondary
    } else {
        PointerButton::Primary
    };
    let at = window.state().draft.place_of((2, 2));
    window.event(Event::PointerMoved(at));
    window.step();
    button(&mut window, at, with, true);
    window.run_steps(2);
    assert_ne!(
        up(&window, 2, 2),
        before,
        "the stroke shows while it is made"
    );
    window.key_press(Key::Escape);
    window.run_steps(2);
    assert_eq!((up(&window, 2, 2), entries(&window)), (before, 0));
    button(&mut window, at, with, false);
    assert_eq!(entries(&window), 0);
}

#[test]
fn the_keyboard_alone_paints() {
    let mut window = still_window("damask");
    let before = up(&window, 1, 1);
    window.state().draft.focus(&window.ctx.clone());
    window.run_steps(2);
    for key in [Key::ArrowRight, Key::ArrowUp] {
        window.key_press(key);
        window.step();
    }
    window.key_press(Key::Enter);
    window.run_steps(2);
    assert_ne!(up(&window, 1, 1), before);
    window.key_press(Key::Space);
    window.run_steps(2);
    assert_eq!(up(&window, 1, 1), before);
    assert_eq!(entries(&window), 2);
}

#[test]
fn a_rectangle_follows_the_pointer_and_shift_makes_it_an_outline() {
    let mut window = still_window("damask");
    window.key_press(Key::R);
    window.run_steps(2);
    assert_eq!(window.state().draft.tool(), Tool::Rectangle);
    stroke(
        &mut window,
        &[(2, 2), (9, 9), (5, 6)],
        PointerButton::Primary,
    );
    for pick in 2..=6 {
        assert!((2..=5).all(|end| up(&window, end, pick)));
    }
    assert_eq!(entries(&window), 1);
    // What only an earlier corner covered is as it was.
    window.key_press(Key::Z);
    window.run_steps(2);
    let untouched = up(&window, 8, 8);
    window.key_press_modifiers(Modifiers::COMMAND.plus(Modifiers::SHIFT), Key::Z);
    window.run_steps(2);
    assert_eq!(up(&window, 8, 8), untouched);
}

#[test]
fn a_drawdown_that_follows_from_a_draft_asks_what_is_meant() {
    let mut window = build(builder(), None);
    window.step();
    window.key_press_modifiers(Modifiers::COMMAND, Key::N);
    wait_for(&mut window, "a new design", |window| {
        says(window, "Drawdown of untitled")
    });
    window.state_mut().preview.freeze();
    window.run_steps(2);
    let before = up(&window, 0, 2);
    let with = if before {
        PointerButton::Secondary
    } else {
        PointerButton::Primary
    };
    let row = |window: &Window| [0, 1, 2, 3, 4, 5].map(|end| up(window, end, 2));
    let drawn = row(&window);
    stroke(&mut window, &[(0, 2), (1, 2), (3, 2)], with);
    assert_eq!(row(&window), drawn, "nothing is painted before the answer");
    window.run_steps(2);
    window
        .get_by_label_contains("Derive the draft again")
        .click();
    window.run_steps(3);
    // All of the stroke, and no more.
    let painted = [!before, !before, !before, !before, drawn[4], drawn[5]];
    assert_eq!(row(&window), painted);
    assert_eq!(entries(&window), 1);
    let is_draft = |window: &Window| {
        let document = window.state().document().expect("open");
        matches!(document.design().structure(), Structure::Draft(_))
    };
    assert!(is_draft(&window));
    // From now on nothing is asked.
    stroke(&mut window, &[(5, 5)], PointerButton::Primary);
    assert!(up(&window, 5, 5) && is_draft(&window));
    assert!(!says(&window, "Derive the draft again"));
}

#[test]
fn the_drawdown_stays_under_the_pointer_while_the_draft_is_derived() {
    let mut window = build(builder(), None);
    window.step();
    window.key_press_modifiers(Modifiers::COMMAND, Key::N);
    wait_for(&mut window, "a new design", |window| {
        says(window, "Drawdown of untitled")
    });
    window.state_mut().preview.freeze();
    window.run_steps(2);
    window.state_mut().asking.derive_always = true;
    let shafts = |window: &Window| {
        let design = window.state().document().expect("open").design().clone();
        match design.structure() {
            Structure::Draft(draft) => draft.shafts(),
            _ => panic!("no draft any more"),
        }
    };
    assert_eq!(shafts(&window), 4);
    let home = |window: &Window| window.state().draft.place_of((0, 0));
    let before = home(&window);
    // Down a diagonal and back: every end becomes another, and needs a shaft of its own.
    let cells: Vec<(i64, i64)> = (0..12).map(|at| (at, (5 * at) % 16)).collect();
    let places: Vec<Pos2> = (cells.iter())
        .map(|&cell| window.state().draft.place_of(cell))
        .collect();
    window.event(Event::PointerMoved(places[0]));
    window.step();
    button(&mut window, places[0], PointerButton::Primary, true);
    for place in &places[1..] {
        window.event(Event::PointerMoved(*place));
        window.step();
        window.step();
        assert_eq!(home(&window), before, "it moved within the stroke");
    }
    assert_eq!(shafts(&window), 4, "derived once the stroke has ended");
    button(&mut window, places[11], PointerButton::Primary, false);
    window.run_steps(2);
    assert!(
        cells
            .iter()
            .all(|&(end, pick)| up(&window, end as u32, pick as u32))
    );
    assert!(shafts(&window) > 4, "another draft");
    assert_ne!(home(&window), before, "which lies elsewhere");
    assert_eq!(entries(&window), 1);
}

#[test]
fn what_is_moved_on_a_draft_is_derived_once_it_lies() {
    let mut window = build(builder(), None);
    window.step();
    window.key_press_modifiers(Modifiers::COMMAND, Key::N);
    wait_for(&mut window, "a new design", |window| {
        says(window, "Drawdown of untitled")
    });
    window.state_mut().preview.freeze();
    window.run_steps(2);
    window.state_mut().asking.derive_always = true;
    let drawdown = |window: &Window| window.state().document().expect("open").drawdown().clone();
    let before = drawdown(&window);
    window.key_press(Key::S);
    window.run_steps(2);
    stroke(&mut window, &[(2, 2), (4, 3)], PointerButton::Primary);
    window.key_press(Key::M);
    window.run_steps(2);
    assert_eq!(window.state().draft.tool(), Tool::Move);
    stroke(
        &mut window,
        &[(3, 3), (6, 9), (9, 10)],
        PointerButton::Primary,
    );
    let after = drawdown(&window);
    for end in 2..=4 {
        for pick in 2..=3 {
            assert_eq!(after.get(end + 6, pick + 7), before.get(end, pick));
            assert!(!after.get(end, pick), "weft is left behind");
        }
    }
    assert_eq!(after.get(7, 7), before.get(7, 7));
    assert_eq!(entries(&window), 1);
}

#[test]
fn threading_and_colour_bars_are_painted() {
    let mut window = build(builder(), None);
    window.step();
    window.key_press_modifiers(Modifiers::COMMAND, Key::N);
    wait_for(&mut window, "a new design", |window| {
        shows(window, "Threading")
    });
    window.state_mut().preview.freeze();
    window.run_steps(2);
    let places = [(0, 0), (1, 1), (2, 2), (3, 3), (4, 2), (5, 1)]
        .map(|cell| window.state().draft.threading_place(cell));
    drag(&mut window, &places, PointerButton::Primary);
    let design = window.state().document().expect("open").design().clone();
    let Structure::Draft(draft) = design.structure() else {
        panic!("no draft any more");
    };
    let shafts: Vec<u16> = (0..6).map(|end| draft.threading().row(end)[0]).collect();
    assert_eq!(shafts, [0, 1, 2, 3, 2, 1]);

    let bar = [2, 3, 4].map(|end| window.state().draft.bar_place(end));
    drag(&mut window, &bar, PointerButton::Secondary);
    let design = window.state().document().expect("open").design().clone();
    let yarns: Vec<u16> = (0..6).map(|end| design.warp_yarn(end, 0).0).collect();
    assert_eq!(yarns, [0, 0, 1, 1, 1, 0]);
    assert_eq!(entries(&window), 2);
}

#[test]
fn a_held_key_is_a_tool_for_the_moment() {
    let mut window = still_window("damask");
    window.key_down(Key::R);
    window.run_steps(2);
    assert_eq!(window.state().draft.tool(), Tool::Rectangle);
    stroke(&mut window, &[(1, 1), (3, 3)], PointerButton::Primary);
    window.key_up(Key::R);
    window.run_steps(2);
    assert_eq!(window.state().draft.tool(), Tool::Pencil);
    // A tap is a choice.
    window.key_press(Key::L);
    window.run_steps(2);
    assert_eq!(window.state().draft.tool(), Tool::Line);
}

#[test]
fn copy_and_paste_stamp_a_selection() {
    let mut window = still_window("damask");
    window.key_press(Key::S);
    window.step();
    stroke(&mut window, &[(0, 0), (3, 1)], PointerButton::Primary);
    let copied: Vec<bool> = (0..4).map(|end| up(&window, end, 1)).collect();
    window.event(Event::Copy);
    window.run_steps(2);
    window.key_press_modifiers(Modifiers::COMMAND.plus(Modifiers::SHIFT), Key::A);
    window.step();
    window.event(Event::Paste(String::new()));
    window.run_steps(2);
    assert_eq!(window.state().draft.tool(), Tool::Stamp);
    stroke(&mut window, &[(10, 20)], PointerButton::Primary);
    let pasted: Vec<bool> = (10..14).map(|end| up(&window, end, 21)).collect();
    assert_eq!(pasted, copied);
}

#[test]
fn the_palette_finds_and_does() {
    let mut window = still_window("oxford");
    window.key_press_modifiers(Modifiers::COMMAND, Key::K);
    window.run_steps(3);
    window.get_by_label("Command to find").type_text("invert");
    window.run_steps(3);
    let before = up(&window, 0, 0);
    window.key_press(Key::Enter);
    window.run_steps(3);
    assert_ne!(up(&window, 0, 0), before);
    assert!(!shows(&window, "Exchange warp up and weft up"));
}

#[test]
fn letters_and_enter_in_one_frame_are_the_command_they_find() {
    let mut window = still_window("oxford");
    window.key_press_modifiers(Modifiers::COMMAND, Key::K);
    window.run_steps(3);
    let before = up(&window, 0, 0);
    // Events of the harness have a frame each; these share one.
    window.input_mut().events.extend([
        Event::Text("invert".to_owned()),
        Event::Key {
            key: Key::Enter,
            physical_key: None,
            pressed: true,
            repeat: false,
            modifiers: Modifiers::NONE,
        },
    ]);
    window.run_steps(3);
    assert_ne!(up(&window, 0, 0), before);
}

#[test]
fn one_key_moves_the_keyboard_between_draft_and_cloth() {
    let mut window = still_window("oxford");
    let ctx = window.ctx.clone();
    let in_draft = |window: &Window| window.state().draft.has_focus(&window.ctx);
    assert!(!in_draft(&window));
    window.key_press(Key::F6);
    window.run_steps(2);
    assert!(in_draft(&window));
    window.key_press(Key::F6);
    window.run_steps(2);
    assert!(!in_draft(&window) && ctx.memory(|memory| memory.focused()).is_some());
    window.key_press(Key::F6);
    window.run_steps(2);
    assert!(in_draft(&window));
}
