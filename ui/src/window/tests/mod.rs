//! The window without a display: clicks and keys by accessible label, and pictures of it
//! on a software adapter.

mod colours;
mod drafts;
mod effects;
mod fields;
mod files;
mod flow;
mod hard;
mod keys;
mod kinds;
mod large;
mod opening;
mod painting;
mod pictures;
mod random_events;
mod slow_frames;
mod states;
mod times;
mod turned;
mod viewing;

pub use pictures::renderer;
pub use times::{Clocks, Spent};

use std::time::{Duration, Instant};

use egui_kittest::kittest::Queryable;
use egui_kittest::{Harness, HarnessBuilder};

use super::app::{App, AppOptions};
use super::preview::PreviewSettings;
use crate::opened::Opened;
use pickglass::exemplar::ExemplarStore;
use pickglass::plan::{EffectBase, EffectChoice, Settings};

type Window = Harness<'static, App>;

fn builder() -> HarnessBuilder<App> {
    Harness::builder()
        .with_size([960.0, 640.0])
        .with_theme(egui::Theme::Dark)
}

/// Pictures that are there at once: what they look like is tested elsewhere.
fn crude() -> PreviewSettings {
    let mut settings = Settings::default().at_level(4);
    settings.render.pass_spp = 1;
    PreviewSettings {
        store: ExemplarStore::user(),
        effects: EffectChoice {
            base: EffectBase::None,
            ..EffectChoice::default()
        },
        settings,
    }
}

fn options() -> AppOptions {
    AppOptions {
        preview: crude(),
        ..AppOptions::default()
    }
}

fn build(builder: HarnessBuilder<App>, design: Option<&str>) -> Window {
    open(
        builder,
        design.map(|name| Opened::preset(name).expect("a preset")),
    )
}

fn open(builder: HarnessBuilder<App>, opened: Option<Opened>) -> Window {
    let mut window: Window =
        builder.build_eframe(|cc| App::new(&cc.egui_ctx, opened, options()).expect("a worker"));
    // On a mailbox with a real dialog a test would wait for a person.
    window.state_mut().files.typed_only = true;
    window
}

/// Lets the window and its threads go on until `done`.
fn wait_for(window: &mut Window, what: &str, mut done: impl FnMut(&mut Window) -> bool) {
    let start = Instant::now();
    loop {
        window.step();
        if done(window) {
            return;
        }
        assert!(
            start.elapsed() < Duration::from_secs(120),
            "waited in vain for {what}"
        );
        std::thread::sleep(Duration::from_millis(5));
    }
}

fn shows(window: &Window, label: &str) -> bool {
    window.query_all_by_label(label).next().is_some()
}

fn says(window: &Window, part: &str) -> bool {
    window.query_all_by_label_contains(part).next().is_some()
}

/// Plain weave on two shafts.
const TABBY: &str = "[WIF]
Version=1.1
Date=April 20, 1997
Developers=wif@mhsoft.com
Source Program=test

[CONTENTS]
WEAVING=yes
WARP=yes
WEFT=yes
THREADING=yes
TIEUP=yes
TREADLING=yes

[WEAVING]
Shafts=2
Treadles=2
Rising Shed=yes

[WARP]
Threads=4
Units=Centimeters
Spacing=0.05

[WEFT]
Threads=4
Units=Centimeters
Spacing=0.05

[THREADING]
1=1
2=2
3=1
4=2

[TIEUP]
1=1
2=2

[TREADLING]
1=1
2=2
3=1
4=2
";
