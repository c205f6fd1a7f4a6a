//! Drafts and loom files of other programs in the window: what is wrong in them, what they
//! do not say, and what their texts hold.

use std::path::{Path, PathBuf};

use egui::accesskit::Role;
use egui::{Key, Modifiers};
use egui_kittest::kittest::{By, NodeT, Queryable};
use pickglass::design::WeavePattern;
use pickglass::formats::{LoadOptions, load};

use super::opening::open_by_path;
use super::{Window, build, builder, says, shows, wait_for};

fn folder(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../tests")
        .join(name)
}

fn opened(path: &Path) -> Window {
    let mut window = build(builder(), None);
    window.step();
    open_by_path(&mut window, &path.display().to_string());
    window
}

fn drawdown(window: &Window) -> WeavePattern {
    WeavePattern::clone(window.state().document().expect("open").drawdown())
}

#[test]
fn case_01_a_draft_with_colours_that_are_not_there_opens() {
    let plain = WeavePattern::from_fn(4, 4, |end, pick| (end + pick) % 2 == 0);
    for name in [
        "colours-without-table",
        "default-colour-3-of-2",
        "default-colours-0-and-1",
        "one-end-colour-7-of-2",
    ] {
        let mut window = opened(&folder("cases/01").join(format!("{name}.wif")));
        wait_for(&mut window, "the draft", |window| {
            says(window, "Drawdown of ")
        });
        window.state_mut().preview.freeze();
        wait_for(&mut window, "the remark", |window| says(window, "colour"));
        assert!(!says(&window, "Error"), "{name}");
        assert_eq!(drawdown(&window), plain, "{name}");
    }
}

#[test]
fn a_loom_file_is_asked_which_side_lies_up() {
    let path = folder("fixtures/looms/face_down.jc5");
    let face_down = LoadOptions {
        face_down: true,
        ..LoadOptions::default()
    };
    let known = [LoadOptions::default(), face_down]
        .map(|options| load(&path, &options).expect("it opens").design.weave());
    assert_ne!(known[0], known[1]);
    for (side, expected) in [("face up", &known[0]), ("face down", &known[1])] {
        let mut window = opened(&path);
        wait_for(&mut window, "the form", |window| {
            says(window, "taken as woven face up")
        });
        assert!(says(&window, "Open the loom file") && !says(&window, "--face-down"));
        assert!(window.state().document().is_none(), "nothing opens unasked");
        window.run_steps(4);
        window.get_by_label(side).click();
        window.run_steps(2);
        if side == "face down" {
            wait_for(&mut window, "the other side", |window| {
                says(window, "woven face down, as")
            });
        }
        window.run_steps(4);
        window.get_by_label("Open it").click();
        wait_for(&mut window, "the design", |window| {
            says(window, "Drawdown of ")
        });
        window.state_mut().preview.freeze();
        assert_eq!(&drawdown(&window), expected, "{side}");
    }
}

/// Everything that is shown, but for fields in which texts are typed.
fn labels(window: &Window) -> Vec<String> {
    let shown = window.query_all(By::new().predicate(|node| {
        let role = node.role();
        ![Role::TextInput, Role::MultilineTextInput, Role::TextRun].contains(&role)
    }));
    let texts = shown.flat_map(|node| {
        let node = node.accesskit_node();
        [node.label(), node.value(), node.description()]
    });
    texts.flatten().collect()
}

#[test]
fn case_16_what_a_file_says_is_shown_with_its_hidden_signs_written_out() {
    let mut window = opened(&folder("cases/16/esc.ron"));
    wait_for(&mut window, "the design", |window| {
        says(window, "Drawdown of ")
    });
    window.state_mut().preview.freeze();
    let keys = [None].into_iter().chain(
        [
            Key::Num1,
            Key::Num2,
            Key::Num3,
            Key::Num4,
            Key::Num6,
            Key::Num7,
            Key::Num8,
        ]
        .map(Some),
    );
    let mut named = 0;
    for key in keys {
        if let Some(key) = key {
            window.key_press_modifiers(Modifiers::ALT, key);
        }
        window.run_steps(6);
        let labels = labels(&window);
        assert!(!labels.is_empty());
        for label in &labels {
            let hidden = |sign: char| (sign.is_control() && sign != '\n') || sign == '\u{202e}';
            assert!(!label.contains(hidden), "{key:?}: {label:?}");
        }
        named += labels
            .iter()
            .filter(|label| label.contains("\\u{1b}"))
            .count();
    }
    assert!(named > 10, "{named} labels with signs written out");
    assert!(says(&window, "name\\nsecond line") && !shows(&window, "second line"));
}
