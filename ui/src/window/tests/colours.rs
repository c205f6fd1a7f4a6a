//! Colourways by key and side by side, painting in steps, and the picture one draws by.

use egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable;
use pickglass::design::{Colourway, Design, Srgb};
use pickglass::edit::Edit;

use super::{Window, build, builder, open, options, says, shows, wait_for};
use crate::command_table::{Command, Switch};
use crate::opened::Opened;
use crate::window::app::{App, AppOptions};
use crate::window::settings::SettingsFile;

/// The Oxford in three colourways beside its own yarns.
fn coloured() -> Window {
    let opened = Opened::preset("oxford").expect("a preset");
    let mut design = Design::clone(&opened.design);
    "sand".clone_into(&mut design.colourway);
    let dyed = |name: &str, colour: Srgb| {
        let mut yarns = design.yarns().to_vec();
        yarns[0].colour = colour;
        let name = name.to_owned();
        Colourway { name, yarns }
    };
    let list = vec![
        dyed("moss", Srgb(60, 90, 40)),
        dyed("wine", Srgb(110, 20, 40)),
        dyed("ash", Srgb(120, 120, 120)),
    ];
    let design = design.with_colourways(list).expect("colourways");
    let mut window = open(
        builder(),
        Some(Opened {
            design: design.into(),
            ..opened
        }),
    );
    window.state_mut().preview.freeze();
    window.run_steps(3);
    window
}

fn in_use(window: &Window) -> String {
    let document = window.state().document().expect("open");
    document.design().colourway.clone()
}

#[test]
fn keys_go_through_the_colourways_by_name() {
    let mut window = coloured();
    let mut seen = vec![in_use(&window)];
    for _ in 0..4 {
        window.key_press(Key::Period);
        window.run_steps(2);
        seen.push(in_use(&window));
    }
    assert_eq!(seen, ["sand", "wine", "ash", "moss", "sand"]);
    window.key_press(Key::Comma);
    window.run_steps(2);
    assert_eq!(in_use(&window), "moss");
    window.key_press_modifiers(Modifiers::COMMAND.plus(Modifiers::ALT), Key::Num4);
    window.run_steps(2);
    assert_eq!(in_use(&window), "wine");
    // There is no fifth, and the one in use stays.
    window.key_press_modifiers(Modifiers::COMMAND.plus(Modifiers::ALT), Key::Num5);
    window.run_steps(2);
    assert_eq!(in_use(&window), "wine");
    window.key_press(Key::Z);
    window.run_steps(2);
    assert_eq!(in_use(&window), "moss");
}

#[test]
fn the_contact_sheet_names_all_and_weaves_in_the_one_that_is_chosen() {
    let mut window = coloured();
    window.key_press(Key::K);
    window.run_steps(2);
    for name in ["ash", "moss", "wine"] {
        assert!(shows(&window, &format!("Weave in {name}")), "{name}");
        assert!(shows(&window, &format!("Cloth in {name}")), "{name}");
    }
    assert!(shows(&window, "sand, in use"));
    window.get_by_label("Weave in moss").click();
    window.run_steps(3);
    assert_eq!(in_use(&window), "moss");
    assert!(shows(&window, "moss, in use"));

    window.key_press_modifiers(Modifiers::SHIFT, Key::K);
    window.run_steps(2);
    assert!(shows(&window, "Cloth in moss") && shows(&window, "Cloth in ash"));
    assert!(!shows(&window, "Cloth in wine"));
    window.get_by_label("Close").click();
    window.run_steps(3);
    assert!(!shows(&window, "Cloth in moss") && shows(&window, "Cloth of Oxford"));
}

#[test]
fn a_design_without_colourways_has_no_sheet() {
    let mut window = build(builder(), Some("oxford"));
    window.state_mut().preview.freeze();
    window.run_steps(2);
    window.key_press(Key::K);
    window.run_steps(2);
    assert!(window.state().preview.sheet_kind().is_none());
}

#[test]
fn painting_goes_on_in_steps_and_too_small_ones_are_refused() {
    let mut window = build(builder(), Some("damask"));
    window.state_mut().preview.freeze();
    window.run_steps(3);
    let ctx = window.ctx.clone();
    window.state_mut().edit(Edit::Resize {
        ends: 64,
        picks: 48,
    });
    window.state_mut().edit(Edit::BecomePattern);
    window
        .state_mut()
        .run_command(&ctx, Command::Switch(Switch::SymmetrySteps));
    window.state_mut().draft.steps.every = [16, 24];
    window.run_steps(3);
    assert!(shows(&window, "Step in ends") && shows(&window, "Step in picks"));
    let count = |window: &Window| {
        let document = window.state().document().expect("open");
        document.drawdown().count_warp_up()
    };
    let up = |window: &Window, end, pick| {
        let document = window.state().document().expect("open");
        document.drawdown().get(end, pick)
    };
    window.state().draft.focus(&ctx);
    window.run_steps(2);
    let before = count(&window);
    let first = up(&window, 0, 0);
    let rest: Vec<bool> = (0..8)
        .map(|copy| up(&window, 16 * (copy % 4), 24 * (copy / 4)))
        .collect();
    window.key_press(Key::Enter);
    window.run_steps(2);
    assert_ne!(up(&window, 0, 0), first);
    for (copy, was) in (0..8).zip(&rest) {
        assert_ne!(up(&window, 16 * (copy % 4), 24 * (copy / 4)), *was);
    }
    let downs = rest.iter().filter(|&&up| up).count() as u64;
    assert_eq!(count(&window) + 2 * downs, before + 8, "and nothing else");

    let entries = window.state().document().expect("open").position();
    window.state_mut().edit(Edit::Resize {
        ends: 640,
        picks: 480,
    });
    window.state_mut().draft.steps.every = [1, 1];
    window.run_steps(2);
    window.key_press(Key::Enter);
    window.run_steps(3);
    assert!(says(&window, "choose larger ones"));
    assert_eq!(
        window.state().document().expect("open").position(),
        entries + 1
    );
}

#[test]
fn a_reference_lies_over_the_draft_and_comes_back_with_its_design() {
    let folder = tempfile::tempdir().expect("a folder");
    let (design, picture) = (
        folder.path().join("oxford.ron"),
        folder.path().join("sketch.png"),
    );
    let preset = Opened::preset("oxford").expect("a preset").design;
    pickglass::formats::save(&preset, &design, &Default::default()).expect("saved");
    image::RgbaImage::from_pixel(40, 30, image::Rgba([200, 30, 30, 128]))
        .save(&picture)
        .expect("written");
    let settings = SettingsFile::at(folder.path().join("window.ron"));
    let start = || -> Window {
        let options = AppOptions {
            settings: settings.clone(),
            ..options()
        };
        let opened = Opened::file(design.clone()).expect("read");
        let mut window: Window = builder()
            .build_eframe(|cc| App::new(&cc.egui_ctx, Some(opened), options).expect("a worker"));
        window.state_mut().files.typed_only = true;
        window.state_mut().preview.freeze();
        window.run_steps(2);
        window
    };
    let mut window = start();
    let ctx = window.ctx.clone();
    let document = window.state().document().expect("open").clone();
    window
        .state_mut()
        .files
        .open_reference(&ctx, picture.clone());
    wait_for(&mut window, "the picture", |window| {
        window.state().draft.reference.is_some()
    });
    wait_for(&mut window, "its controls", |window| {
        shows(window, "Take it away")
    });
    assert!(says(&window, "transparent pixels are read as white paper"));
    // The weave knows nothing of it.
    let now = window.state().document().expect("open");
    assert!(!now.is_modified() && now.design() == document.design());
    window.key_press(Key::V);
    window.run_steps(2);
    let shown = |window: &Window| window.state().draft.reference.as_ref().map(|r| r.shown);
    assert_eq!(shown(&window), Some(false));
    if let Some(reference) = &mut window.state_mut().draft.reference {
        reference.opacity = 0.25;
    }
    window.state_mut().keep_now(&ctx);
    drop(window);

    let mut window = start();
    wait_for(&mut window, "the picture again", |window| {
        window.state().draft.reference.is_some()
    });
    let reference = window.state().draft.reference.as_ref().expect("there");
    assert_eq!((reference.path.clone(), reference.opacity), (picture, 0.25));
    assert!(!reference.window_open);
}
