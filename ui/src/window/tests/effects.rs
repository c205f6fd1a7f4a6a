//! Effects that are switched in their pane: what the cloth is asked for with.

use egui_kittest::kittest::Queryable;
use pickglass::engine;
use pickglass::plan::{Effect, EffectChoice};

use super::{Window, builder, options, shows, wait_for};
use crate::opened::Opened;
use crate::window::Pane;
use crate::window::app::{App, AppOptions};
use crate::window::preview::PreviewSettings;

/// A window whose effects nobody has switched.
fn window() -> Window {
    let options = options();
    let options = AppOptions {
        preview: PreviewSettings {
            effects: EffectChoice::default(),
            ..options.preview
        },
        ..options
    };
    let opened = Opened::preset("oxford").expect("a preset");
    let mut window: Window = builder()
        .with_size([1280.0, 900.0])
        .build_eframe(|cc| App::new(&cc.egui_ctx, Some(opened), options).expect("a worker"));
    window.state_mut().layout.bring(Pane::Effects);
    window
}

/// What the cloth is asked for with, as a command line says it.
fn asked(window: &Window) -> String {
    let asked = window.state().preview.asked().expect("asked");
    engine::options(asked, "cpu", None)
}

fn click(window: &mut Window, label: &str) {
    window.get_by_label(label).click();
    window.run_steps(4);
}

#[test]
fn a_switch_changes_what_the_cloth_is_asked_for_with_and_auto_takes_it_back() {
    let mut window = window();
    wait_for(&mut window, "the rows", |window| {
        shows(window, "Flyaway hairs: off") && window.state().preview.asked().is_some()
    });
    let before = (asked(&window), window.state().preview.generation());
    assert!(before.0.contains("--effects auto "), "{}", before.0);
    click(&mut window, "Flyaway hairs: off");
    assert!(asked(&window).contains("--effects auto,-hairs "));
    assert!(window.state().preview.generation() > before.1);
    assert!(shows(&window, "Off: you left it out."));
    // Another word on it takes the place of the one before.
    click(&mut window, "Flyaway hairs: on");
    assert!(asked(&window).contains("--effects auto,+hairs "));
    click(&mut window, "Shadows: off");
    let choice = window.state().preview.look().effects;
    let changes = [(Effect::Hairs, true), (Effect::Shadows, false)];
    assert_eq!(choice.changes, changes);
    click(&mut window, "Flyaway hairs: auto");
    click(&mut window, "Shadows: auto");
    assert_eq!(asked(&window), before.0);
}

#[test]
fn all_effects_takes_back_switches_and_the_order_of_scattering() {
    let mut window = window();
    wait_for(&mut window, "the rows", |window| {
        shows(window, "Sky light: off") && window.state().preview.asked().is_some()
    });
    let before = asked(&window);
    let preview = &mut window.state_mut().preview;
    preview.set("order", "3").expect("an order");
    window.run_steps(4);
    click(&mut window, "Sky light: off");
    let between = asked(&window);
    assert!(between.contains("auto,-sky ") && between.contains("--set order=3"));
    // Another design is looked at with the same effects, as with the same dials.
    window.state_mut().preview.forget();
    window.run_steps(4);
    assert!(asked(&window).contains("auto,-sky "));
    click(&mut window, "All effects");
    assert_eq!(asked(&window), before);
}
