//! The pane of effects by accessible label: what it shows and asks for.

use egui::Key;
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use pickglass::edit::Edit;
use pickglass::engine::{LightChoice, StillRequest};
use pickglass::plan::{Effect, Settings};

use super::words;
use crate::window::action::Action;
use crate::window::panes::Pane;
use crate::window::panes::tests::{Bench, bench, build};

type Shown = Harness<'static, Bench>;

/// A small picture of coarse voxels in a light without a sky.
fn request() -> StillRequest {
    StillRequest {
        width: 24,
        height: 16,
        width_mm: Some(2.0),
        light: LightChoice::Preset("sun".to_owned()),
        settings: Settings::default().at_level(3),
        ..StillRequest::default()
    }
}

fn follow(harness: &mut Shown, request: &StillRequest) {
    let panes = &mut harness.state_mut().panes;
    panes.look(Some(request));
    panes.effects.follow(request.clone());
    harness.run_steps(3);
}

fn says(harness: &Shown, part: &str) -> bool {
    harness.query_all_by_label_contains(part).next().is_some()
}

fn is_disabled(harness: &Shown, label: &str) -> bool {
    harness.get_by_label(label).accesskit_node().is_disabled()
}

fn click(harness: &mut Shown, label: &str) {
    harness.get_by_label(label).click();
    harness.run_steps(3);
}

/// Lets the look end.
fn wait(harness: &mut Shown) {
    let begun = std::time::Instant::now();
    while harness.state().panes.effects.is_looking() {
        assert!(begun.elapsed().as_secs() < 300, "it still looks");
        harness.step();
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    harness.run_steps(3);
}

/// What was switched, in order.
fn switched(harness: &Shown) -> Vec<(Effect, Option<bool>)> {
    let asked = harness.state().asked.iter();
    asked
        .filter_map(|action| match action {
            Action::Switch(effect, on) => Some((*effect, *on)),
            _ => None,
        })
        .collect()
}

#[test]
fn every_effect_has_a_row_and_a_switch_before_anything_is_looked_at() {
    let mut harness = bench("silk-satin", Pane::Effects);
    harness.run_steps(3);
    for effect in Effect::ALL {
        let title = words::title(*effect);
        assert!(harness.query_by_label(&title).is_some(), "{title}");
        for place in ["auto", "on", "off"] {
            let label = format!("{title}: {place}");
            assert!(harness.query_by_label(&label).is_some(), "{label}");
        }
    }
    let nobody = "On by itself: nothing is left out unasked.";
    assert_eq!(
        harness.query_all_by_label(nobody).count(),
        Effect::ALL.len()
    );
    assert!(!says(&harness, "of the work"));
    // The cloth is not looked at yet, and nothing can be taken back.
    for button in ["Look", "Leave out what does not show", "All effects"] {
        assert!(is_disabled(&harness, button), "{button}");
    }
    // What somebody switched says so.
    let mut asked = request();
    asked.effects.switch(Effect::Tap, Some(false));
    follow(&mut harness, &asked);
    assert!(says(&harness, "Off: you left it out."));
    assert_eq!(
        harness.query_all_by_label(nobody).count(),
        Effect::ALL.len() - 1
    );
    assert!(!is_disabled(&harness, "All effects"));
    click(&mut harness, "Shadows: off");
    click(&mut harness, "Smoothing: auto");
    let wanted = [(Effect::Shadows, Some(false)), (Effect::Tap, None)];
    assert_eq!(switched(&harness), wanted);
}

#[test]
fn a_look_says_what_costs_most_and_what_may_be_left_out() {
    let mut harness = bench("silk-satin", Pane::Effects);
    let mut asked = request();
    follow(&mut harness, &asked);
    click(&mut harness, "Look");
    assert!(harness.state().panes.is_measuring());
    wait(&mut harness);
    assert!(says(&harness, "The biggest cost in this picture is "));
    // Silk has no hairs, and this light no sky.
    let none = "Sky light and flyaway hairs can be left out: there are none.";
    assert!(says(&harness, none));
    assert!(says(
        &harness,
        " of the work. Without them places are lit alike"
    ));
    assert!(!says(&harness, "This was looked at"));

    // All that does not show is left out, and nothing else is.
    click(&mut harness, "Leave out what does not show");
    let left_out = switched(&harness);
    let off = |effect| left_out.contains(&(effect, Some(false)));
    assert!(off(Effect::Sky) && off(Effect::Hairs) && !off(Effect::Shadows));
    for (effect, on) in left_out {
        asked.effects.switch(effect, on);
    }
    let order = harness
        .state()
        .asked
        .iter()
        .find_map(|action| match action {
            Action::Set(name, order) => {
                (name == "order").then(|| order.parse::<u32>().expect("one"))
            }
            _ => None,
        });
    let usual = asked.settings.render.max_order;
    let order = order.expect("later scattering does not show");
    assert!(order > 1 && order < usual, "{order}");
    asked.settings.render.max_order = order;
    follow(&mut harness, &asked);
    assert!(is_disabled(&harness, "Leave out what does not show"));
    assert!(says(&harness, "with other effects"));

    // All of them come back.
    harness.state_mut().asked.clear();
    click(&mut harness, "All effects");
    let wanted = [(Effect::Sky, None), (Effect::Hairs, None)];
    assert_eq!(switched(&harness), wanted);
    let usual = usual.to_string();
    let set = |action: &Action| matches!(action, Action::Set(name, order) if name == "order" && *order == usual);
    assert!(harness.state().asked.iter().any(set));
}

#[test]
fn what_was_looked_at_of_another_picture_says_so_and_leaves_nothing_out() {
    let mut harness = bench("silk-satin", Pane::Effects);
    let mut asked = request();
    follow(&mut harness, &asked);
    click(&mut harness, "Look");
    wait(&mut harness);
    assert!(!is_disabled(&harness, "Leave out what does not show"));
    asked.width_mm = Some(3.0);
    follow(&mut harness, &asked);
    assert!(says(&harness, "in another view"));
    assert!(is_disabled(&harness, "Leave out what does not show"));
    follow(&mut harness, &request());
    assert!(!is_disabled(&harness, "Leave out what does not show"));
    click(&mut harness, "Unseen below 5 %");
    assert!(says(&harness, "another tolerance"));
    let edit = Edit::Rename("other".to_owned());
    harness.state_mut().document.apply(edit).expect("a name");
    harness.run_steps(3);
    assert!(says(&harness, "before the design was changed"));
}

#[test]
fn a_look_that_is_stopped_finds_nothing_and_keeps_what_was_found_before() {
    let mut harness = bench("silk-satin", Pane::Effects);
    // So large that it is not done before the click.
    let mut asked = request();
    (asked.width, asked.height) = (640, 480);
    asked.settings.render.max_order = 4096;
    follow(&mut harness, &asked);
    click(&mut harness, "Look");
    assert!(harness.query_by_label("Look").is_none());
    click(&mut harness, "Stop looking");
    wait(&mut harness);
    assert!(harness.query_by_label("Look").is_some());
    assert!(!says(&harness, "of the work"));
    // The control: one that is not stopped finds something, and that stays.
    follow(&mut harness, &request());
    click(&mut harness, "Look");
    wait(&mut harness);
    assert!(says(&harness, "of the work"));
    follow(&mut harness, &asked);
    click(&mut harness, "Look");
    click(&mut harness, "Stop looking");
    wait(&mut harness);
    assert!(says(&harness, "of the work") && says(&harness, "in another view"));
}

#[test]
fn pictures_are_flipped_by_the_keyboard() {
    let mut harness = bench("silk-satin", Pane::Effects);
    follow(&mut harness, &request());
    click(&mut harness, "Look");
    wait(&mut harness);
    click(&mut harness, "Shadows");
    assert!(says(&harness, "With shadows"));
    harness.get_by_label("Without shadows").focus();
    harness.run_steps(2);
    harness.key_press(Key::Space);
    harness.run_steps(3);
    assert!(says(&harness, "The cloth without shadows") && !says(&harness, "With shadows"));
    harness.key_press(Key::Space);
    harness.run_steps(3);
    assert!(says(&harness, "The cloth with shadows"));
    // After a click as well.
    harness.get_by_label("Shadows").focus();
    click(&mut harness, "Without shadows");
    assert!(says(&harness, "The cloth without shadows"));
    harness.key_press(Key::Space);
    harness.run_steps(3);
    assert!(says(&harness, "The cloth with shadows"));
    // There are none of what the design has nothing of.
    harness.get_by_label("Flyaway hairs").click_accesskit();
    harness.run_steps(3);
    assert!(says(
        &harness,
        "No pictures: there was nothing of flyaway hairs."
    ));
}

#[test]
fn the_keyboard_stays_on_a_switch_when_a_notice_appears_above_it() {
    let mut harness = bench("silk-satin", Pane::Effects);
    let mut asked = request();
    follow(&mut harness, &asked);
    click(&mut harness, "Look");
    wait(&mut harness);
    harness.get_by_label("Shadows: off").focus();
    harness.run_steps(2);
    harness.key_press(Key::Space);
    harness.run_steps(3);
    assert_eq!(switched(&harness), [(Effect::Shadows, Some(false))]);
    assert!(!says(&harness, "with other effects"));
    asked.effects.switch(Effect::Shadows, Some(false));
    follow(&mut harness, &asked);
    assert!(says(&harness, "with other effects"));
    let switch = harness.get_by_label("Shadows: off");
    assert!(switch.accesskit_node().is_focused());
}

/// Wide and narrow in both themes. Where `PICKGLASS_PICTURES` names a folder, the pictures are
/// kept there.
#[test]
fn it_draws_itself_wide_and_narrow() {
    let folder = std::env::var_os("PICKGLASS_PICTURES");
    for (theme, word) in [(egui::Theme::Dark, "dark"), (egui::Theme::Light, "light")] {
        let Some(renderer) = crate::window::tests::renderer("pictures of effects") else {
            return;
        };
        let builder = Harness::builder().with_theme(theme).renderer(renderer);
        let mut harness = build(builder, "silk-satin", Pane::Effects);
        crate::tokens::apply(&harness.ctx);
        let mut asked = request();
        // Somebody looks at what is kept.
        if folder.is_some() {
            (asked.width, asked.height) = (640, 480);
            (asked.width_mm, asked.settings) = (Some(8.0), Settings::default());
        }
        follow(&mut harness, &asked);
        click(&mut harness, "Look");
        wait(&mut harness);
        harness.get_by_label("Edge fixing").click_accesskit();
        for size in [[1200.0, 280.0], [400.0, 700.0], [400.0, 160.0]] {
            harness.set_size(size.into());
            harness.run_steps(4);
            // Nothing is wider than the pane.
            for label in [
                "Look",
                "All effects",
                "Edge fixing: off",
                "Without edge fixing",
            ] {
                let rect = harness.get_by_label(label).rect();
                assert!(rect.left() >= 0.0 && rect.right() <= size[0], "{label}");
            }
            let picture = harness.render().expect("a picture");
            if let Some(folder) = &folder {
                let name = format!("Effects {word} {} {}.png", size[0], size[1]);
                let _ = picture.save(std::path::Path::new(folder).join(name));
            }
        }
    }
}
