//! Each pane without a display: what it shows and what it asks for, by accessible label.

use egui::accesskit::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use pickglass::accuracy::{Asked, Axis};
use pickglass::design::{Lattice, Repeat, Structure};
use pickglass::edit::{Document, Edit};
use pickglass::engine::{self, StillRequest};
use pickglass::presets;

use super::{Pane, Panes, accuracy};
use crate::help;
use crate::window::action::{Action, Mark};
use crate::window::{crossing, laid};

/// A document with its panes, and what they asked for so far.
pub(super) struct Bench {
    pub document: Document,
    pub panes: Panes,
    pane: Pane,
    pub asked: Vec<Action>,
}

pub(super) fn bench(preset: &str, pane: Pane) -> Harness<'static, Bench> {
    let builder = Harness::builder().with_size([720.0, 520.0]);
    build(builder, preset, pane)
}

pub(super) fn build(
    builder: egui_kittest::HarnessBuilder<Bench>,
    preset: &str,
    pane: Pane,
) -> Harness<'static, Bench> {
    let design = presets::design(preset)
        .expect("a preset")
        .expect("a design");
    let bench = Bench {
        document: Document::new(design),
        panes: Panes::default(),
        pane,
        asked: Vec::new(),
    };
    builder.build_ui_state(
        |ui, bench: &mut Bench| {
            let mut actions = Vec::new();
            let ground = egui::Frame::NONE
                .fill(crate::tokens::Palette::current(ui).panel)
                .inner_margin(crate::tokens::GAP);
            egui::CentralPanel::default().frame(ground).show(ui, |ui| {
                bench
                    .panes
                    .show(bench.pane, ui, &bench.document, &mut actions);
            });
            for action in actions {
                if let Action::Edit(edit) = &action {
                    bench.document.apply(Edit::clone(edit)).expect("an edit");
                }
                bench.asked.push(action);
            }
        },
        bench,
    )
}

/// Waits for what a pane works out on a thread of its own.
fn wait(harness: &mut Harness<'_, Bench>, label: &str) {
    for _ in 0..2000 {
        harness.step();
        if harness.query_all_by_label_contains(label).next().is_some() {
            return;
        }
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    panic!("waited in vain for {label:?}");
}

#[test]
fn every_pane_shows_every_preset() {
    for preset in presets::names() {
        for pane in Pane::ALL {
            let mut harness = bench(preset, pane);
            harness.run_steps(3);
        }
    }
}

#[test]
fn every_dial_has_its_place_in_help_reports_and_window() {
    let asked = Asked {
        request: StillRequest::default(),
        renderer: engine::reference(),
    };
    let help = help::still();
    for axis in Axis::all() {
        let (name, ladder) = (axis.name(), axis.ladder());
        assert!(
            ladder.len() > 1 && axis.reference() == ladder[ladder.len() - 1],
            "{name}"
        );
        assert!(
            !axis.measure().unit().is_empty() && !axis.about().is_empty(),
            "{name}"
        );
        // Reports take it by name, and help says it, but for what draws: that is an option.
        assert_eq!(Axis::named(name).expect("a name").name(), name);
        let said = help.contains(&format!("* {name}: ")) || name == "renderer";
        assert!(said, "{name}");
        // The window sets it, or says what does.
        match axis.elsewhere() {
            Some(what) => assert!(!what.ends_with('.'), "{name}"),
            None => {
                for value in ladder {
                    let set = axis.set(&asked, value).expect("a setting of its ladder");
                    assert_eq!(axis.current(&set), value, "{name}");
                }
            }
        }
    }
    // Control: what is no dial has no place.
    assert!(Axis::named("glow").is_err() && !help.contains("* glow: "));
}

fn axis_of(name: &str) -> Axis {
    Axis::named(name).expect("a name")
}

fn asked_for(request: &StillRequest) -> Asked {
    Asked {
        request: request.clone(),
        renderer: engine::reference(),
    }
}

#[test]
fn accuracy_is_measured_and_a_setting_is_taken() {
    let mut harness = bench("default", Pane::Accuracy);
    harness.run_steps(2);
    // Nothing is measured before the cloth is looked at.
    assert!(
        harness
            .get_by_label("Measure")
            .accesskit_node()
            .is_disabled()
    );
    let mut request = StillRequest {
        width: 24,
        height: 16,
        width_mm: Some(2.0),
        ..StillRequest::default()
    };
    request.settings.render.spp = 1;
    harness.state_mut().panes.look(Some(&request));
    harness.run_steps(2);
    harness.get_by_label("quick").click();
    harness.run_steps(2);
    harness.get_by_label("Measure").click();
    harness.run_steps(2);
    assert!(harness.state().panes.is_measuring());
    let begun = std::time::Instant::now();
    while harness.state().panes.is_measuring() {
        assert!(begun.elapsed().as_secs() < 300, "it is still measured");
        harness.step();
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
    harness.run_steps(2);
    let measured = harness.state().panes.accuracy.measured().expect("measured");
    assert_eq!(measured.dials.len(), 4);
    // One that the window can set.
    let set_elsewhere = ["spp", "pass-spp", "renderer", "png-bits"];
    let curve = (measured.dials.iter())
        .find(|curve| !set_elsewhere.contains(&curve.name.as_str()))
        .expect("a dial");
    let title = |name: &str| accuracy::title(&axis_of(name));
    let listed = format!("{}: {}", title(&curve.name), curve.current);
    harness.get_by_label(&listed).click();
    harness.run_steps(2);
    let other = (curve.settings.iter()).find(|point| point.value != curve.current);
    let other = &other.expect("another setting").value;
    {
        let start = format!("{other} · ");
        let rows: Vec<_> = harness.get_all_by_label_contains(&start).collect();
        let row = rows.iter().find(|row| {
            let label = row.accesskit_node().label();
            label.is_some_and(|label| label.starts_with(&start))
        });
        row.expect("its row").click();
    }
    harness.run_steps(2);
    let asked = &harness.state().asked;
    let set = |action: &Action| matches!(action, Action::Set(name, value) if *name == curve.name && value == other);
    assert!(asked.iter().any(set), "{asked:?}");
    // What was taken is of the same curves; a budget chooses among all of them.
    (axis_of(&curve.name).set(&asked_for(&request), other)).map_or_else(
        |error| panic!("{error}"),
        |set| harness.state_mut().panes.look(Some(&set.request)),
    );
    harness.run_steps(2);
    let stale = |harness: &Harness<'_, Bench>| {
        (harness.query_all_by_label_contains("This was measured"))
            .next()
            .is_some()
    };
    assert!(!stale(&harness));
    harness.state_mut().panes.accuracy.budget("wrong");
    harness.run_steps(2);
    assert!(
        harness
            .query_by_label_contains("expected seconds")
            .is_some()
    );
    harness.state_mut().panes.accuracy.budget("900 s");
    harness.run_steps(2);
    assert!(harness.query_by_label_contains("% wrong").is_some());
    harness.state_mut().panes.accuracy.budget("0.000001 ms");
    harness.run_steps(2);
    let fastest = "No measured settings of a traced picture are so fast";
    assert!(harness.query_by_label_contains(fastest).is_some());
    harness.state_mut().panes.accuracy.budget("0.000001%");
    harness.run_steps(2);
    let none = "No measured settings are so good.";
    assert!(harness.query_by_label(none).is_some());
    // Where nothing can be set, the keyboard stays in the field.
    harness
        .get_by_role_and_label(Role::TextInput, "Budget")
        .focus();
    harness.run_steps(2);
    harness.key_press(egui::Key::Enter);
    harness.run_steps(3);
    assert!(
        harness
            .get_by_role_and_label(Role::TextInput, "Budget")
            .is_focused()
    );
    // A change of the design is told, and told no more once it is undone.
    let rename = Edit::Rename("another".to_owned());
    harness.state_mut().document.apply(rename).expect("an edit");
    harness.run_steps(2);
    assert!(stale(&harness));
    harness.state_mut().document.undo();
    harness.run_steps(2);
    assert!(!stale(&harness));
    // Another view is another picture.
    let another = |harness: &Harness<'_, Bench>| {
        (harness.query_all_by_label_contains("another view"))
            .next()
            .is_some()
    };
    assert!(!another(&harness));
    request.width_mm = Some(3.0);
    harness.state_mut().panes.look(Some(&request));
    harness.run_steps(2);
    assert!(another(&harness));
}

#[test]
fn floats_are_listed_and_looked_at() {
    let mut harness = bench("silk-satin", Pane::Floats);
    wait(&mut harness, "No float is longer");
    harness.state_mut().panes.floats = super::floats::Floats::with_limits([2, 2]);
    wait(&mut harness, "long floats");
    let first = harness
        .get_all_by_label_contains("(")
        .next()
        .expect("a float");
    first.click();
    harness.run_steps(3);
    let asked = &harness.state().asked;
    assert!(
        asked
            .iter()
            .any(|action| matches!(action, Action::LookAt { .. }))
    );
    assert!(asked.iter().any(
        |action| matches!(action, Action::Mark(Mark::Float { ends, picks, .. })
            if ends.max(picks) > &2)
    ));
}

#[test]
fn yarns_are_opened_exchanged_and_joined() {
    let mut harness = bench("default", Pane::Yarns);
    wait(&mut harness, "m per m");
    harness.get_by_label("ecru").click();
    harness.run_steps(3);
    let before = harness.state().document.design().maps().clone();
    harness.get_by_label("Exchange").click();
    harness.run_steps(3);
    assert!(*harness.state().document.design().maps() != before);
    harness.get_by_label("Join").click();
    harness.run_steps(3);
    assert_eq!(harness.state().document.design().yarns().len(), 2);
    harness.get_by_label("Add yarn").click();
    harness.run_steps(3);
    assert_eq!(harness.state().document.design().yarns().len(), 3);
}

#[test]
fn a_yarn_that_has_the_keyboard_shows_where_it_lies() {
    let mut harness = bench("default", Pane::Yarns);
    harness.run_steps(3);
    let marked = |harness: &Harness<'_, Bench>| {
        let asked = &harness.state().asked;
        asked
            .iter()
            .any(|action| matches!(action, Action::Mark(Mark::Yarn(_))))
    };
    assert!(!marked(&harness));
    harness.get_by_label("ecru").focus();
    harness.run_steps(3);
    assert!(marked(&harness));
}

#[test]
fn colourways_are_duplicated_renamed_and_used() {
    let mut harness = bench("oxford", Pane::Colourways);
    harness.run_steps(2);
    harness.get_by_label("Duplicate the yarns in use").click();
    harness.run_steps(3);
    let name = |harness: &Harness<'_, Bench>| {
        let design = harness.state().document.design();
        design
            .colourways()
            .last()
            .map(|colourway| colourway.name.clone())
    };
    assert!(name(&harness).is_some());
    harness.get_by_label_contains("Remove ").click();
    harness.run_steps(3);
    assert_eq!(name(&harness), None);
    // Undo is the history's: what was removed comes back.
    harness.state_mut().document.undo();
    harness.run_steps(3);
    assert!(name(&harness).is_some());
}

#[test]
fn a_changed_sett_asks_what_to_keep() {
    let mut harness = bench("oxford", Pane::Sett);
    wait(&mut harness, "Width in the reed");
    assert!(harness.query_by_label("Keep threads").is_none());
    harness.state_mut().panes.sett.type_in([31.0, 22.0]);
    harness.run_steps(3);
    harness.get_by_label("Keep threads").click();
    harness.run_steps(3);
    let design = harness.state().document.design();
    assert!((design.sett().ends.per_cm - 31.0).abs() < 1e-3);
    assert!(harness.query_by_label("Keep threads").is_none());
}

#[test]
fn the_history_goes_back() {
    let mut harness = bench("oxford", Pane::History);
    harness
        .state_mut()
        .document
        .apply(Edit::Invert)
        .expect("an edit");
    harness.run_steps(3);
    harness.get_by_label("1 opened").click();
    harness.run_steps(3);
    let asked = harness.state().asked.last();
    assert!(matches!(asked, Some(Action::GoTo(0))), "{asked:?}");
}

#[test]
fn a_picture_becomes_a_design_of_regions() {
    let mut harness = bench("oxford", Pane::Posterise);
    harness.run_steps(2);
    let pixels = (0..64 * 48)
        .map(|at| [[20, 20, 30], [200, 40, 40], [240, 235, 220]][at % 64 / 22])
        .collect();
    let source = pickglass::design::SourceImage::new(64, 48, pixels).expect("a picture");
    let ctx = harness.ctx.clone();
    harness.state_mut().panes.posterise.take_small(&ctx, source);
    wait(&mut harness, "Make it the design");
    harness.get_by_label("Make it the design").click();
    wait(&mut harness, "3 regions");
    harness
        .get_all_by_label_contains("Weave of ")
        .next()
        .expect("a weave")
        .click();
    harness.run_steps(4);
    harness
        .get_all_by_label_contains("plain, ")
        .next()
        .expect("plain weave")
        .click();
    harness.run_steps(3);
    let asked = &harness.state().asked;
    assert!(asked.iter().any(|action| {
        matches!(action, Action::Edit(edit) if matches!(**edit, Edit::SetFill { .. }))
    }));
}

#[test]
fn the_cut_follows_the_pointer() {
    let mut harness = bench("herringbone", Pane::Section);
    harness.run_steps(2);
    let picks = {
        let (_, picks) = laid::whole(harness.state().document.design());
        i64::from(picks)
    };
    let told = |harness: &mut Harness<'_, Bench>, at, what: &str| {
        harness.state_mut().panes.section.follow(Some(at));
        harness.run_steps(2);
        let what = format!("Cut along {what}");
        assert!(
            harness.query_all_by_label_contains(&what).next().is_some(),
            "{what}"
        );
    };
    // In every repeat a thread has the number of the file.
    for repeat in [0, 1, -2] {
        told(&mut harness, (4, 2 + repeat * picks), "pick 3:");
    }
    harness.get_by_label("Along an end").click();
    told(&mut harness, (4, 2), "end 5:");
}

#[test]
fn the_cut_numbers_threads_as_the_status_line_does() {
    let mut harness = bench("herringbone", Pane::Section);
    let half = Lattice {
        across: Repeat::Dropped(3),
        along: Repeat::Straight,
    };
    let document = &mut harness.state_mut().document;
    document.apply(Edit::SetLattice(half)).expect("a lattice");
    let (ends, picks) = laid::whole(document.design());
    // A repeat further along the weft, where the weave stands three picks higher.
    let at = (i64::from(ends) + 4, 5);
    let status = crossing::describe(document, at, [7; 2]).expect("cloth");
    assert!(status.starts_with("end 5 · pick 3 · "), "{status}");
    harness.state_mut().panes.section.follow(Some(at));
    harness.run_steps(2);
    assert!(
        (harness.query_all_by_label_contains("Cut along pick 3:"))
            .next()
            .is_some()
    );
    // Below the first pick of a shifted repeat is the last of the one beneath.
    harness.state_mut().panes.section.follow(Some((at.0, 2)));
    harness.run_steps(2);
    let last = format!("Cut along pick {picks}:");
    assert!(harness.query_all_by_label_contains(&last).next().is_some());
}

/// Every pane in both themes and at two densities. Where `PICKGLASS_PICTURES` names a
/// folder, the pictures are kept there.
#[test]
fn every_pane_draws_itself_in_both_themes() {
    let folder = std::env::var_os("PICKGLASS_PICTURES");
    for (theme, word) in [(egui::Theme::Dark, "dark"), (egui::Theme::Light, "light")] {
        for density in [1.0, 2.0] {
            for pane in Pane::ALL {
                // These two are views of their own.
                if matches!(pane, Pane::Draft | Pane::Cloth) {
                    continue;
                }
                let Some(renderer) = crate::window::tests::renderer("pictures of panes") else {
                    return;
                };
                let builder = Harness::builder()
                    .with_size([720.0, 320.0])
                    .with_theme(theme)
                    .with_pixels_per_point(density)
                    .renderer(renderer);
                let mut harness = build(builder, "damask", pane);
                crate::tokens::apply(&harness.ctx);
                for _ in 0..20 {
                    harness.step();
                    std::thread::sleep(std::time::Duration::from_millis(10));
                }
                let picture = harness.render().expect("a picture");
                let first = picture.get_pixel(2, 2);
                let other = picture.pixels().filter(|pixel| *pixel != first).count();
                assert!(other > 100, "{pane:?} {word} ×{density}: nothing is drawn");
                if let Some(folder) = &folder {
                    let name = format!("{pane:?} {word} {density}.png");
                    let _ = picture.save(std::path::Path::new(folder).join(name));
                }
            }
        }
    }
}

#[test]
fn regions_are_added_given_yarns_and_joined() {
    let mut harness = bench("damask", Pane::Posterise);
    harness.run_steps(3);
    let palette =
        |harness: &Harness<'static, Bench>| match harness.state().document.design().structure() {
            Structure::Regions(regions) => regions.palette().to_vec(),
            other => panic!("{other:?}"),
        };
    let before = palette(&harness);
    let drawdown = harness.state().document.drawdown().clone();
    harness.get_by_label("Add region").click();
    harness.run_steps(3);
    assert_eq!(palette(&harness).len(), before.len() + 1);
    assert_eq!(*harness.state().document.drawdown(), drawdown);

    let first = before[0].name.clone();
    let yarns = format!("Yarns of {first}: design's yarns");
    harness.get_by_label(&yarns).click();
    harness.run_steps(3);
    harness.get_by_label_contains("Weft").click();
    harness.run_steps(3);
    let yarn = harness.state().document.design().yarns()[0].name.clone();
    harness.get_by_label(&yarn).click();
    harness.run_steps(3);
    let own = palette(&harness)[0].yarns.expect("yarns of its own");
    assert_eq!(own.weft, pickglass::design::YarnId(0));
    assert!(!harness.state().document.design().weavable());

    harness.get_by_label(&first).click();
    harness.run_steps(3);
    let origin = format!("First end of the weave of {first}");
    assert!(harness.query_by_label(&origin).is_some());
    harness.get_by_label("Join").click();
    harness.run_steps(3);
    let after = palette(&harness);
    assert_eq!(after.len(), before.len());
    assert!(after.iter().all(|region| region.name != first));
}
