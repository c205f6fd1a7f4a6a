//! What lies over the cloth, driven by pointer, keys and accessible labels.

use std::time::{Duration, Instant};

use egui::{Key, pos2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use pickglass::edit::Document;
use pickglass::engine::LightChoice;
use pickglass::exemplar::ExemplarStore;
use pickglass::plan::{EffectBase, EffectChoice, Settings};
use pickglass::presets;

use crate::window::action::Action;
use crate::window::preview::{Preview, PreviewSettings};

/// A cloth view, its document, and what was asked for so far.
struct Bench {
    preview: Option<Preview>,
    document: Document,
    asked: Vec<Action>,
}

fn bench() -> Harness<'static, Bench> {
    let design = presets::design("oxford")
        .expect("a preset")
        .expect("a design");
    let bench = Bench {
        preview: None,
        document: Document::new(design),
        asked: Vec::new(),
    };
    Harness::builder().with_size([640.0, 480.0]).build_ui_state(
        |ui, bench: &mut Bench| {
            let preview = bench.preview.get_or_insert_with(|| {
                let mut settings = Settings::default().at_level(4);
                settings.render.pass_spp = 1;
                let settings = PreviewSettings {
                    store: ExemplarStore::user(),
                    effects: EffectChoice {
                        base: EffectBase::None,
                        ..EffectChoice::default()
                    },
                    settings,
                };
                Preview::new(ui.ctx(), settings).expect("a worker")
            });
            let mut actions = Vec::new();
            preview.poll(&ui.ctx().clone(), &mut actions);
            preview.show(ui, &bench.document, &mut actions);
            bench.asked.extend(actions);
        },
        bench,
    )
}

fn wait(harness: &mut Harness<'_, Bench>, what: &str, done: impl Fn(&Preview) -> bool) {
    let start = Instant::now();
    while !harness.state().preview.as_ref().is_some_and(&done) {
        assert!(
            start.elapsed() < Duration::from_secs(120),
            "waited in vain for {what}"
        );
        harness.step();
        std::thread::sleep(Duration::from_millis(5));
    }
}

fn shown(harness: &mut Harness<'_, Bench>) {
    wait(harness, "a picture", |preview| preview.pane.shown.is_some());
    harness.run_steps(2);
}

#[test]
fn the_glass_shows_while_its_key_is_held() {
    let mut harness = bench();
    shown(&mut harness);
    harness.hover_at(pos2(300.0, 240.0));
    harness.step();
    harness.key_down(Key::Q);
    harness.step();
    wait(&mut harness, "the glass", |preview| {
        preview.glass_has_picture()
    });
    harness.key_up(Key::Q);
    harness.run_steps(2);
    assert!(
        !harness
            .state()
            .preview
            .as_ref()
            .is_some_and(Preview::glass_has_picture)
    );
    // The pane goes on with what it showed.
    shown(&mut harness);
}

#[test]
fn the_glass_is_held_by_the_keyboard_alone() {
    let mut harness = bench();
    shown(&mut harness);
    let has_picture = |harness: &Harness<'_, Bench>| {
        let preview = harness.state().preview.as_ref();
        preview.is_some_and(Preview::glass_has_picture)
    };
    // The key means nothing while the keyboard is elsewhere.
    harness.key_down(Key::Q);
    harness.run_steps(3);
    harness.key_up(Key::Q);
    harness.run_steps(2);
    assert!(!has_picture(&harness));
    harness.get_by_label_contains("Cloth of ").focus();
    harness.run_steps(2);
    harness.key_down(Key::Q);
    harness.step();
    wait(&mut harness, "the glass", Preview::glass_has_picture);
    harness.key_up(Key::Q);
    harness.run_steps(2);
    assert!(!has_picture(&harness));

    // From a menu it stays until Esc.
    if let Some(preview) = &mut harness.state_mut().preview {
        preview.pin_glass();
    }
    wait(&mut harness, "the glass", Preview::glass_has_picture);
    harness.key_press(Key::Escape);
    harness.run_steps(2);
    assert!(!has_picture(&harness));
}

#[test]
fn the_scale_of_the_screen_is_set_by_keys() {
    let mut harness = bench();
    shown(&mut harness);
    harness.get_by_label("Calibrate").focus();
    harness.run_steps(2);
    harness.key_press(Key::Enter);
    harness.run_steps(3);
    let usual = harness.state().preview.as_ref().map(|p| p.mm_per_point);
    harness.get_by_label("Done").focus();
    harness.run_steps(2);
    harness.key_press(Key::Enter);
    harness.run_steps(3);
    assert!(harness.query_by_label("Done").is_none());
    let told = harness
        .state()
        .asked
        .iter()
        .find_map(|action| match action {
            Action::Calibrated(scale) => Some(*scale),
            _ => None,
        });
    assert_eq!(told, usual);
}

#[test]
fn a_picture_is_kept_and_compared_with() {
    let mut harness = bench();
    shown(&mut harness);
    harness.get_by_label("Keep").click();
    harness.run_steps(2);
    assert!(
        harness
            .query_by_label("Border to the kept picture")
            .is_some()
    );
    harness.get_by_label("Forget kept").click();
    harness.run_steps(2);
    assert!(
        harness
            .query_by_label("Border to the kept picture")
            .is_none()
    );
}

#[test]
fn the_cloth_is_turned_over_and_the_lamp_moved() {
    let mut harness = bench();
    shown(&mut harness);
    harness.get_by_label("See back").click();
    wait(&mut harness, "the back", |preview| {
        preview.view.pose(false).back
    });
    harness.run_steps(2);
    harness.get_by_label_contains("Lamp: ").focus();
    harness.run_steps(2);
    harness.key_press(Key::ArrowLeft);
    wait(
        &mut harness,
        "other light",
        |preview| matches!(preview.light, LightChoice::Sun(heading) if heading.azimuth == 140),
    );
}
