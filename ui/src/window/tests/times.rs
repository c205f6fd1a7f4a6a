//! What the window costs: time in its own callbacks while one paints, and how long an edit
//! takes to be seen. All of it is told; no time fails a test. Where `PICKGLASS_TIMES` is
//! set the cloth is traced as in the program, else crudely.

use std::sync::Arc;
use std::time::Instant;

use egui::{Event, PointerButton};
use pickglass::design::{Design, Family, Srgb, Yarn, YarnId};
use pickglass::edit::{Cells, Edit, Rect};
use pickglass::plan::{EffectChoice, Settings};

use super::large::{paint, satin};
use super::{PreviewSettings, Window, builder, options, wait_for};
use crate::opened::Opened;
use crate::window::action::Action;
use crate::window::app::App;
use crate::window::worker::Fibres;
use pickglass::exemplar::ExemplarStore;

/// How often each edit is made.
const ROUNDS: u32 = 2;

/// The wall's clock and that of this thread's work, seconds.
#[derive(Clone, Copy)]
pub struct Clocks {
    wall: Instant,
    worked: Option<f64>,
}

impl Clocks {
    pub fn now() -> Self {
        Self {
            wall: Instant::now(),
            worked: worked(),
        }
    }

    /// Seconds since: on the wall and of work.
    fn elapsed(&self) -> [f64; 2] {
        let wall = self.wall.elapsed().as_secs_f64();
        let work = worked().zip(self.worked).map(|(now, then)| now - then);
        [wall, work.unwrap_or(wall)]
    }
}

/// Seconds that this thread has worked; `None` where the system does not say.
fn worked() -> Option<f64> {
    let stat = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    let nanoseconds: f64 = stat.split_whitespace().next()?.parse().ok()?;
    Some(nanoseconds * 1e-9)
}

/// Time spent in our own callbacks, frame by frame.
#[derive(Default)]
pub struct Spent {
    /// Seconds on the wall and of work.
    pub frames: Vec<[f64; 2]>,
    before: [f64; 2],
}

impl Spent {
    /// What ran before the frame that it belongs to.
    pub fn before(&mut self, begun: Clocks) {
        self.before = begun.elapsed();
    }

    pub fn frame(&mut self, begun: Clocks) {
        let own = begun.elapsed();
        let before = std::mem::take(&mut self.before);
        self.frames.push([own[0] + before[0], own[1] + before[1]]);
    }

    /// Tells the longest and the 99th of 100 frames, and begins anew.
    pub fn tell(&mut self, what: &str) {
        let count = self.frames.len();
        let [wall, work] = [0, 1].map(|clock| {
            let mut times: Vec<f64> = self.frames.iter().map(|frame| frame[clock]).collect();
            times.sort_by(f64::total_cmp);
            move |share: f64| {
                let at = (count.saturating_sub(1) as f64 * share) as usize;
                times.get(at).map_or(0.0, |time| time * 1e3)
            }
        });
        eprintln!(
            "{what}: {count} frames, work p99 {:.1} ms, most {:.1} ms; wall p99 {:.1} ms, \
             longest {:.1} ms",
            work(0.99),
            work(1.0),
            wall(0.99),
            wall(1.0)
        );
        self.frames.clear();
    }
}

/// A window whose cloth is traced.
fn live(opened: Opened) -> Window {
    let mut options = options();
    if std::env::var_os("PICKGLASS_TIMES").is_some() {
        options.preview = PreviewSettings {
            store: ExemplarStore::user(),
            effects: EffectChoice::default(),
            settings: Settings::default(),
        };
    }
    let mut window: Window = builder()
        .build_eframe(|cc| App::new(&cc.egui_ctx, Some(opened), options).expect("a worker"));
    window.state_mut().files.typed_only = true;
    window
}

fn wait_for_cloth(window: &mut Window) {
    wait_for(window, "the traced cloth", |window| {
        let shown = &window.state().preview.pane.shown;
        (shown.as_ref()).is_some_and(|shown| shown.spp > 0 && shown.fibres == Fibres::Full)
    });
}

#[test]
fn the_largest_loom_file_is_painted_in_while_its_cloth_is_traced() {
    let mut window = live(satin(5120, 6300));
    wait_for_cloth(&mut window);
    for _ in 0..2 {
        window.state_mut().draft.look_at(2560, 3150);
        window.run_steps(5);
        window.state_mut().spent.frames.clear();
        paint(&mut window);
        let cell = window.state().draft.cell();
        let what = format!("painting on 5120 × 6300, cloth traced, {cell} pixels a crossing");
        window.state_mut().spent.tell(&what);
        wait_for_cloth(&mut window);
        for _ in 0..20 {
            if window.state().draft.cell() < 4.0 {
                window.key_press(egui::Key::Plus);
                window.step();
            }
        }
    }
    assert!(window.state().document().expect("open").is_modified());
}

/// From an edit to the first picture of it that egui is given.
fn seen_after(window: &mut Window, what: &str, edit: impl FnOnce(&mut Window)) {
    wait_for_cloth(window);
    let before = window.state().preview.generation();
    let begun = Instant::now();
    edit(window);
    loop {
        window.step();
        let preview = &window.state().preview;
        let shown = preview.pane.shown.as_ref().map(|shown| shown.generation);
        if preview.generation() > before && shown == Some(preview.generation()) {
            break;
        }
        assert!(begun.elapsed().as_secs() < 60, "{what}: nothing is seen");
        std::thread::sleep(std::time::Duration::from_micros(500));
    }
    let milliseconds = begun.elapsed().as_secs_f64() * 1e3;
    eprintln!("{what}: seen after {milliseconds:.0} ms");
}

#[test]
fn an_edit_is_seen_soon_and_the_time_is_told() {
    let mut opened = satin(900, 1500);
    let derived = Edit::DeriveDraft { after: None };
    let mut document = pickglass::edit::Document::new(Design::clone(&opened.design));
    document.apply(derived).expect("a draft");
    opened.design = Arc::clone(document.design());
    let mut window = live(opened);
    for round in 0..ROUNDS {
        let act = |window: &mut Window, edit: Edit| {
            let ctx = window.ctx.clone();
            window.state_mut().act(&ctx, vec![Action::edit(edit)]);
        };
        // Another treadle each time, so that each click changes something.
        seen_after(&mut window, "a tie-up click", |window| {
            act(window, Edit::TieUp(vec![(round, vec![0, 1, 2, 5])]));
        });
        let navy = Yarn::new("navy", Family::Cotton, Srgb(120, 30 + 9 * round as u8, 40));
        seen_after(&mut window, "a yarn's colour", |window| {
            let to = Box::new(navy);
            act(
                window,
                Edit::SetYarn {
                    yarn: YarnId(0),
                    to,
                },
            );
        });
    }
    let ctx = window.ctx.clone();
    let jacquard = Edit::BecomeJacquard { then: None };
    window.state_mut().act(&ctx, vec![Action::edit(jacquard)]);
    window.run_steps(3);
    for round in 0..ROUNDS {
        let middle = (449 + i64::from(round), 750);
        window.state_mut().draft.look_at(middle.0, middle.1);
        window.run_steps(3);
        seen_after(&mut window, "a painted cell", |window| {
            let at = window.state().draft.place_of(middle);
            let document = window.state().document().expect("open");
            // The second button takes away what the first would put there.
            let button = match document.drawdown().get(middle.0 as u32, 750) {
                true => PointerButton::Secondary,
                false => PointerButton::Primary,
            };
            let pressed = |pressed| Event::PointerButton {
                pos: at,
                button,
                pressed,
                modifiers: egui::Modifiers::NONE,
            };
            for event in [Event::PointerMoved(at), pressed(true), pressed(false)] {
                window.event(event);
            }
        });
        seen_after(&mut window, "a fill", |window| {
            let rect = Rect {
                end: 400 + 10 * round,
                pick: 700,
                ends: 100,
                picks: 100,
            };
            let cells = Cells::of_rect(900, 1500, rect);
            let ctx = window.ctx.clone();
            window
                .state_mut()
                .act(&ctx, vec![Action::edit(Edit::Flip(cells))]);
        });
    }
    assert!(window.state().document().expect("open").is_modified());
}
