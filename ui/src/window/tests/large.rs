//! Designs as large as looms weave: they open, are looked at from near and far, and are
//! painted in while the time of each frame is told.

use std::sync::Arc;

use egui::{Event, Key, Modifiers, PointerButton};
use pickglass::design::{
    Design, Family, Srgb, Structure, WeavePattern, Yarn, YarnId, YarnMaps, usual_sett,
};

use super::{Window, builder, open, says, wait_for};
use crate::opened::Opened;

/// A satin of so many ends and picks in two cottons.
pub fn satin(ends: u32, picks: u32) -> Opened {
    let weave = WeavePattern::from_fn(ends, picks, |end, pick| (end + 3 * pick) % 8 == 0);
    let yarns = vec![
        Yarn::new("navy", Family::Cotton, Srgb(38, 52, 94)),
        Yarn::new("cream", Family::Cotton, Srgb(236, 226, 203)),
    ];
    let maps = YarnMaps::plain(YarnId(0), YarnId(1));
    let sett = usual_sett(&yarns, &maps);
    let structure = Structure::Pattern(weave);
    let design = Design::new("large", structure, yarns, maps, sett).expect("a design");
    Opened {
        design: Arc::new(design),
        warnings: Vec::new(),
        path: None,
    }
}

fn still(opened: Opened) -> Window {
    let mut window = open(builder().with_size([1280.0, 800.0]), Some(opened));
    window.state_mut().preview.freeze();
    window.run_steps(5);
    window
}

/// A stroke of forty crossings round the middle, with the pointer; the first and the last.
pub fn paint(window: &mut Window) -> [(i64, i64); 2] {
    let at = |window: &Window, step: i64| {
        let cell = (2540 + step, 3150 + step % 7);
        (cell, window.state().draft.place_of(cell))
    };
    let (first, place) = at(window, 0);
    window.event(Event::PointerMoved(place));
    window.step();
    let press = |window: &mut Window, pressed| {
        window.event(Event::PointerButton {
            pos: place,
            button: PointerButton::Primary,
            pressed,
            modifiers: Modifiers::NONE,
        });
        window.step();
    };
    press(window, true);
    for step in 1..40 {
        let (_, place) = at(window, step);
        window.event(Event::PointerMoved(place));
        window.step();
    }
    press(window, false);
    [first, at(window, 39).0]
}

#[test]
fn the_largest_loom_file_is_painted_in() {
    let mut window = still(satin(5120, 6300));
    for zoom in 0..2 {
        window.state_mut().draft.look_at(2560, 3150);
        window.run_steps(5);
        window.state_mut().spent.frames.clear();
        let [first, last] = paint(&mut window);
        let up = |window: &Window, (end, pick): (i64, i64)| {
            let document = window.state().document().expect("open");
            document.drawdown().get(end as u32, pick as u32)
        };
        if zoom > 0 {
            // Near enough for a pointer to mean one crossing.
            assert!(up(&window, first) && up(&window, last));
        }
        let document = window.state().document().expect("open");
        assert!(document.is_modified());
        let cell = window.state().draft.cell();
        let what = format!("painting on 5120 × 6300 at {cell} pixels a crossing");
        window.state_mut().spent.tell(&what);
        window.key_press_modifiers(Modifiers::COMMAND, Key::Z);
        window.run_steps(3);
        assert!(!window.state().document().expect("open").is_modified());
        for _ in 0..20 {
            if window.state().draft.cell() < 4.0 {
                window.key_press(Key::Plus);
                window.step();
            }
        }
    }
}

#[test]
fn a_panel_of_sixteen_by_twenty_thousand_opens_and_pans() {
    let mut window = still(satin(16_000, 20_000));
    window.state_mut().spent.frames.clear();
    for step in 0..40 {
        window.state_mut().draft.look_at(400 * step, 300 * step);
        window.step();
    }
    for _ in 0..10 {
        window.key_press(Key::Plus);
        window.step();
    }
    assert!(window.state().draft.cell() > 1.0);
    window.state_mut().spent.tell("panning on 16000 × 20000");
}

/// The cloth of the part in view is traced, and a view of all of it stays at first sight
/// without a failure; neither makes the whole panel into cloth.
#[test]
fn the_cloth_of_a_large_panel_is_traced_where_one_looks() {
    let mut window = open(
        builder().with_size([1280.0, 800.0]),
        Some(satin(16_000, 20_000)),
    );
    wait_for(&mut window, "a traced picture", |window| {
        let shown = &window.state().preview.pane.shown;
        shown.as_ref().is_some_and(|shown| shown.spp > 0)
    });
    window.state().preview.focus(&window.ctx.clone());
    window.run_steps(2);
    window.key_press(Key::F);
    wait_for(&mut window, "first sight of all", |window| {
        says(window, "look closer to refine")
    });
    let width = window
        .state()
        .preview
        .asked()
        .and_then(|still| still.width_mm);
    assert!(width.is_some_and(|mm| mm > 1000.0), "{width:?}");
    assert!(!says(&window, "Error"));
}
