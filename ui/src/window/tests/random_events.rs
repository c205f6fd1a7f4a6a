//! A window that anything at all is done to. It runs in a program of its own, in a folder of
//! its own: what it saves is nobody's.

use std::process::Command;

use egui::{Event, Key, Modifiers, MouseWheelUnit, PointerButton, TouchPhase, pos2, vec2};
use pickglass::random::Random;

use super::{Window, build, builder, shows};

/// Says that this is the program of its own, and how many events there are.
const EVENTS: &str = "PICKGLASS_RANDOM_EVENTS";
const SIZE: [f32; 2] = [960.0, 640.0];
/// Designs that are opened in turn, a new window for each.
const DESIGNS: [Option<&str>; 4] = [Some("oxford"), None, Some("damask"), Some("twill-satin")];
const TEXTS: [&str; 7] = [
    "7",
    "-1",
    "1e999",
    "NaN",
    "ü綾🧵",
    "\u{202e}x\u{0}",
    "1/3 twill",
];

fn one<T: Copy>(random: &mut Random, of: &[T]) -> T {
    of[(random.bits() % of.len() as u64) as usize]
}

fn modifiers(random: &mut Random) -> Modifiers {
    let bits = match random.bits() % 3 {
        0 => random.bits(),
        _ => 0,
    };
    Modifiers {
        alt: bits & 1 != 0,
        shift: bits & 2 != 0,
        ctrl: bits & 4 != 0,
        command: bits & 4 != 0,
        mac_cmd: false,
    }
}

/// Events of one frame.
fn events(random: &mut Random) -> Vec<Event> {
    let [x, y] = random.pair();
    let at = pos2(x * SIZE[0], y * SIZE[1]);
    let keys = modifiers(random);
    let buttons = [
        PointerButton::Primary,
        PointerButton::Primary,
        PointerButton::Primary,
        PointerButton::Secondary,
        PointerButton::Middle,
    ];
    let button = |button, pressed| Event::PointerButton {
        pos: at,
        button,
        pressed,
        modifiers: keys,
    };
    let key = |key, pressed| Event::Key {
        key,
        physical_key: None,
        pressed,
        repeat: false,
        modifiers: keys,
    };
    match random.bits() % 16 {
        0..4 => {
            let which = one(random, &buttons);
            vec![
                Event::PointerMoved(at),
                button(which, true),
                button(which, false),
            ]
        }
        4 => vec![Event::PointerMoved(at), button(one(random, &buttons), true)],
        5 => vec![
            Event::PointerMoved(at),
            button(one(random, &buttons), false),
        ],
        6..8 => vec![Event::PointerMoved(at)],
        8..12 => {
            let which = one(random, Key::ALL);
            match random.bits() % 8 {
                // Held for some frames, or let go by a window that had not the focus.
                0 => vec![key(which, true)],
                1 => vec![key(which, false)],
                _ => vec![key(which, true), key(which, false)],
            }
        }
        12 => vec![Event::Text(one(random, &TEXTS).to_owned())],
        13 => vec![Event::MouseWheel {
            unit: MouseWheelUnit::Line,
            delta: vec2(0.0, 6.0 * random.uniform() - 3.0),
            phase: TouchPhase::Move,
            source: egui::MouseWheelSource::Unknown,
            modifiers: keys,
        }],
        14 => vec![match random.bits() % 3 {
            0 => Event::Copy,
            1 => Event::Cut,
            _ => Event::Paste(one(random, &TEXTS).to_owned()),
        }],
        _ => vec![match random.bits() % 3 {
            0 => Event::PointerGone,
            1 => Event::WindowFocused(false),
            _ => Event::WindowFocused(true),
        }],
    }
}

/// What must be true of a window whatever was done to it.
fn check(window: &Window, seed: u64, step: u64) {
    let Some(document) = window.state().document() else {
        return;
    };
    let design = document.design();
    let small = u64::from(design.ends()) * u64::from(design.picks()) < 1 << 18;
    if small {
        let same = **document.drawdown() == design.weave();
        assert!(
            same,
            "the drawdown is not that of the design: {seed}, {step}"
        );
    }
}

/// Does so many things to a window of each design.
fn torment(count: u64) {
    for (number, design) in DESIGNS.iter().enumerate() {
        let seed = number as u64;
        let mut random = Random::new(seed, 0, 0);
        // What no font has is drawn as a box, as in the program.
        let mut window = build(builder().allow_missing_glyphs(), *design);
        window.state_mut().preview.freeze();
        window.run_steps(2);
        for step in 0..count / DESIGNS.len() as u64 {
            let events = events(&mut random);
            window.input_mut().events.extend(events);
            window.step();
            if step % 64 == 0 {
                check(&window, seed, step);
            }
        }
        check(&window, seed, count);
        // It is still a window.
        for _ in 0..4 {
            window.input_mut().events.push(Event::WindowFocused(true));
            window.step();
        }
        assert!(shows(&window, "File"), "{design:?}");
    }
}

#[test]
fn a_window_outlives_random_events() {
    if let Some(count) = std::env::var_os(EVENTS) {
        let count = count.to_string_lossy().parse().expect("a number");
        return torment(count);
    }
    let count = match std::env::var_os("PICKGLASS_LONG") {
        Some(_) => "200000",
        None => "3000",
    };
    let folder = tempfile::tempdir().expect("a folder");
    let program = std::env::current_exe().expect("this program");
    let name = "window::tests::random_events::a_window_outlives_random_events";
    let output = Command::new(program)
        .args([name, "--exact", "--nocapture"])
        .current_dir(folder.path())
        .env(EVENTS, count)
        .env("HOME", folder.path())
        .env("XDG_CONFIG_HOME", folder.path())
        .env("XDG_DATA_HOME", folder.path())
        .env_remove("PICKGLASS_CACHE")
        .output()
        .expect("it runs");
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{} {said}", output.status);
    let ran = String::from_utf8_lossy(&output.stdout);
    assert!(ran.contains("1 passed"), "{ran}");
}
