//! Keys and strokes when a frame takes a second: what was done counts, not how long the
//! window took to see it.

use egui::{Event, Key, Modifiers, PointerButton, Pos2};
use egui_kittest::kittest::{NodeT, Queryable};

use super::{Window, build, builder, says, shows};
use crate::command_table::{Command, Tool};
use crate::window::Pane;

fn slow_window(design: &str) -> Window {
    let builder = builder().with_size([1280.0, 1200.0]).with_step_dt(1.0);
    let mut window = build(builder, Some(design));
    window.state_mut().preview.freeze();
    window.run_steps(3);
    window
}

fn key(key: Key, pressed: bool) -> Event {
    Event::Key {
        key,
        physical_key: None,
        pressed,
        repeat: false,
        modifiers: Modifiers::NONE,
    }
}

fn button(at: Pos2, pressed: bool) -> Event {
    Event::PointerButton {
        pos: at,
        button: PointerButton::Primary,
        pressed,
        modifiers: Modifiers::NONE,
    }
}

/// All of these in one frame.
fn frame(window: &mut Window, events: impl IntoIterator<Item = Event>) {
    window.input_mut().events.extend(events);
    window.step();
}

fn tool(window: &Window) -> Tool {
    window.state().draft.tool()
}

#[test]
fn case_12_a_tap_switches_the_tool_however_slow_the_frames_are() {
    let mut window = slow_window("damask");
    let at = window.state().draft.place_of((3, 3));
    frame(&mut window, [Event::PointerMoved(at)]);
    let others = [
        Tool::Line,
        Tool::Fill,
        Tool::Select,
        Tool::Pencil,
        Tool::Rectangle,
    ];
    for wanted in others {
        let letter = key_of(wanted).expect("a key");
        frame(&mut window, [key(letter, true)]);
        // The key is down for seconds of frames, but nothing is done with the tool.
        window.run_steps(3);
        frame(&mut window, [key(letter, false)]);
        window.run_steps(2);
        assert_eq!(tool(&window), wanted, "{letter:?}");
    }
}

fn key_of(tool: Tool) -> Option<Key> {
    crate::window::menu::key_of(crate::command_table::Command::Use(tool))
}

#[test]
fn case_12_taps_in_one_frame_all_count() {
    let mut window = slow_window("damask");
    let (line, fill) = (key_of(Tool::Line), key_of(Tool::Fill));
    let (line, fill) = (line.expect("a key"), fill.expect("a key"));
    frame(
        &mut window,
        [line, fill]
            .into_iter()
            .flat_map(|letter| [key(letter, true), key(letter, false)]),
    );
    window.run_steps(2);
    assert_eq!(tool(&window), Tool::Fill, "the last tap");
}

#[test]
fn case_12_a_tool_is_given_back_only_where_it_was_used_with_its_key_down() {
    let line = key_of(Tool::Line).expect("a key");
    let mut window = slow_window("damask");
    let [from, to] = [(2, 2), (6, 2)].map(|cell| window.state().draft.place_of(cell));
    // Used with the key down, each event in a frame of its own and all in one frame.
    for at_once in [false, true] {
        let first = [Event::PointerMoved(from), key(line, true)];
        let rest = [
            button(from, true),
            Event::PointerMoved(to),
            button(to, false),
            key(line, false),
        ];
        frame(&mut window, first);
        assert_eq!(tool(&window), Tool::Line);
        let entries = window.state().document().expect("open").position();
        if at_once {
            frame(&mut window, rest);
        } else {
            rest.into_iter()
                .for_each(|event| frame(&mut window, [event]));
        }
        window.run_steps(2);
        assert_eq!(tool(&window), Tool::Pencil, "given back: {at_once}");
        let drawn = window.state().document().expect("open").position() - entries;
        assert!(drawn <= 1, "one line");
    }
    // The key goes up before the press, in the same slow frame: it was a tap.
    frame(&mut window, [key(line, true)]);
    let rest = [key(line, false), button(from, true), button(from, false)];
    frame(&mut window, rest);
    window.run_steps(2);
    assert_eq!(tool(&window), Tool::Line, "kept");
}

#[test]
fn case_12_what_is_typed_right_after_a_key_that_opens_a_form_goes_into_it() {
    let mut window = slow_window("oxford");
    let open = Event::Key {
        key: Key::K,
        physical_key: None,
        pressed: true,
        repeat: false,
        modifiers: Modifiers::COMMAND,
    };
    let typed = [
        key(Key::L, true),
        Event::Text("l".to_owned()),
        key(Key::L, false),
    ];
    frame(&mut window, std::iter::once(open).chain(typed));
    window.run_steps(3);
    let field = window.get_by_label("Command to find");
    assert_eq!(field.accesskit_node().value().as_deref(), Some("l"));
    assert_eq!(tool(&window), Tool::Pencil);
}

#[test]
fn case_12_after_enter_on_an_error_all_keys_of_the_frame_go_to_the_field() {
    let mut window = slow_window("oxford");
    window.key_press_modifiers(Modifiers::COMMAND, Key::L);
    window.run_steps(4);
    assert!(says(&window, "Open by path"));
    let before = tool(&window);
    frame(
        &mut window,
        [
            key(Key::Enter, true),
            key(Key::Enter, false),
            key(Key::L, true),
            Event::Text("/absent/l".to_owned()),
            key(Key::L, false),
        ],
    );
    window.run_steps(3);
    let field = window.get_by_role(egui::accesskit::Role::TextInput);
    assert_eq!(field.accesskit_node().value().as_deref(), Some("/absent/l"));
    assert_eq!(tool(&window), before);
    assert!(shows(&window, "Drawdown of Oxford"));
}

#[test]
fn case_12_what_was_typed_into_a_field_that_esc_gave_up_is_no_command() {
    let mut window = slow_window("oxford");
    let ctx = window.ctx.clone();
    window
        .state_mut()
        .run_command(&ctx, Command::Show(Pane::Yarns));
    window.run_steps(6);
    let stripes = egui::accesskit::Role::TextInput;
    window
        .get_by_role_and_label(stripes, "Warp stripes")
        .focus();
    window.run_steps(2);
    let line = key_of(Tool::Line).expect("a key");
    frame(
        &mut window,
        [
            key(line, true),
            Event::Text("l".to_owned()),
            key(line, false),
            key(Key::Escape, true),
            key(Key::Escape, false),
        ],
    );
    window.run_steps(2);
    assert_eq!(tool(&window), Tool::Pencil, "the letter was for the field");
    // Out of the field the same key is the command.
    frame(&mut window, [key(line, true), key(line, false)]);
    window.run_steps(2);
    assert_eq!(tool(&window), Tool::Line);
}
