//! One design after another: every pane shows the one that is open, and nothing of the one
//! before, whichever kinds the two are of.

use std::collections::BTreeSet;
use std::sync::Arc;
use std::time::{Duration, Instant};

use egui_kittest::kittest::{By, NodeT, Queryable};
use pickglass::design::{Design, Structure, WeavePattern};
use pickglass::edit::{Document, Edit};

use super::{Window, build, builder, shows};
use crate::opened::Opened;
use crate::window::panes::Pane;
use crate::window::session::{Session, blank};

/// A draft, a filled weave, a drawdown, regions, and one for previews only.
fn kinds() -> Vec<(&'static str, Opened)> {
    let preset = |name: &str| Opened::preset(name).expect("a preset");
    let oxford = preset("oxford");
    let changed = |design: Design| Opened {
        design: Arc::new(design),
        warnings: Vec::new(),
        path: None,
    };
    let long = WeavePattern::from_fn(24, 12, |end, pick| (end / 8 + pick / 4) % 2 == 0);
    let drawdown = Design::clone(&preset("denim").design).with_structure(Structure::Pattern(long));
    let mut several = Document::new(Design::clone(&oxford.design));
    for name in ["one", "two"] {
        let name = name.to_owned();
        let edit = Edit::AddColourway { name, of: None };
        several.apply(edit).expect("a colourway");
    }
    vec![
        ("draft", blank().expect("a design")),
        ("weave", preset("herringbone")),
        ("drawdown", changed(drawdown.expect("a design"))),
        ("regions", preset("damask")),
        ("preview only", preset("twills-9")),
        ("colourways", changed(Design::clone(several.design()))),
    ]
}

/// The panes of which one is seen at a time, beside draft and cloth; the log tells what
/// happened, not what is.
fn told() -> impl Iterator<Item = Pane> {
    let others = [Pane::Draft, Pane::Cloth, Pane::Log];
    Pane::ALL
        .into_iter()
        .filter(move |pane| !others.contains(pane))
}

/// All that can be read in a window.
fn read(window: &Window) -> BTreeSet<String> {
    let all = window.query_all(By::new().predicate(|_| true));
    all.flat_map(|node| {
        let node = node.accesskit_node();
        let role = node.role();
        [node.label(), node.value()]
            .into_iter()
            .flatten()
            .map(move |text| format!("{role:?}: {text}"))
    })
    .collect()
}

fn take(window: &mut Window, opened: &Opened) {
    let session = Session::of(opened);
    window.state_mut().take_design(opened, session);
    window.state_mut().preview.freeze();
}

fn bring(window: &mut Window, pane: Pane) {
    window.state_mut().layout.bring(pane);
    window.run_steps(3);
}

/// What a pane says once it has worked out all it says: twice the same, with nothing under way.
fn settled(window: &mut Window, pane: Pane) -> BTreeSet<String> {
    bring(window, pane);
    let begun = Instant::now();
    let mut before = BTreeSet::new();
    loop {
        std::thread::sleep(Duration::from_millis(30));
        window.run_steps(2);
        let now = read(window);
        let busy = |text: &String| text.contains("Looking for") || text.contains("looking again");
        if now == before && !now.iter().any(busy) {
            return now;
        }
        assert!(begun.elapsed() < Duration::from_secs(60), "{pane:?}");
        before = now;
    }
}

#[test]
fn panes_show_the_open_design_whatever_was_open_before() {
    let kinds = kinds();
    let alone: Vec<Vec<BTreeSet<String>>> = (kinds.iter())
        .map(|(_, opened)| {
            let mut window = build(builder(), None);
            take(&mut window, opened);
            told().map(|pane| settled(&mut window, pane)).collect()
        })
        .collect();
    // Or nothing would be compared.
    for (one, panes) in alone.iter().enumerate() {
        for other in &alone[one + 1..] {
            let differ = panes.iter().zip(other).filter(|(a, b)| a != b).count();
            assert!(differ >= 6, "{one}: only {differ} panes differ");
        }
    }
    for (first, before) in &kinds {
        let mut window = build(builder(), None);
        for ((second, after), expected) in kinds.iter().zip(&alone) {
            take(&mut window, before);
            for pane in told() {
                settled(&mut window, pane);
            }
            take(&mut window, after);
            for (pane, expected) in told().zip(expected) {
                // At once or after a moment, but in the end as if nothing had been open.
                let begun = Instant::now();
                let mut found = settled(&mut window, pane);
                while found != *expected && begun.elapsed() < Duration::from_secs(5) {
                    found = settled(&mut window, pane);
                }
                let odd: Vec<_> = found.symmetric_difference(expected).collect();
                assert!(
                    odd.is_empty(),
                    "{pane:?} of {second} after {first}: {odd:?}"
                );
            }
        }
    }
}

#[test]
fn what_was_typed_for_one_design_is_not_offered_for_the_next() {
    let mut window = build(builder(), None);
    let kinds = kinds();
    take(&mut window, &kinds[0].1);
    bring(&mut window, Pane::Sett);
    let field = window.get_by_role_and_label(egui::Role::SpinButton, "Ends");
    field.focus();
    window.run_steps(2);
    window.key_press(egui::Key::ArrowUp);
    window.run_steps(3);
    assert!(shows(&window, "Keep threads"), "nothing was typed");
    take(&mut window, &kinds[1].1);
    bring(&mut window, Pane::Sett);
    assert!(!shows(&window, "Keep threads"));
}
