//! The window: paint a weave, watch the cloth.
//!
//! [`app`] holds the state and the frame; [`layout`] says where the panes lie. A pane
//! changes nothing itself: it pushes [`action`]s, which [`act`] does after all panes were
//! shown; [`obey`] does the commands of menus and keys. [`draft`] is the pane one paints in,
//! [`preview`] the cloth, whose [`worker`] draws on a thread of its own; the others are in
//! [`panes`]. [`files`] reads and writes on further threads, so that the window never
//! waits.

mod act;
mod action;
mod app;
mod asking;
mod autosave;
mod cloth;
mod cloth_pane;
mod crossing;
mod draft;
mod export;
mod files;
mod forms;
mod icons;
mod import;
mod laid;
mod layout;
mod leaving;
mod menu;
mod obey;
mod palette;
mod panes;
mod picture;
mod preview;
mod session;
mod settings;
mod start;
mod status;
mod task;
#[cfg(test)]
mod tests;
mod thumbs;
mod toasts;
mod tools;
mod view;
mod volume;
mod weave;
mod worker;

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::opened::Opened;
use app::AppOptions;
use autosave::RecoveryFolder;
use settings::SettingsFile;

/// Why there is no window.
pub enum NoWindow {
    /// None can open here; the reason in a few words.
    Unavailable(String),
    /// It opened and then broke.
    Broken(anyhow::Error),
}

/// Opens the window and returns when it is closed.
pub fn run(opened: Option<Opened>, smoke_frames: Option<u32>) -> Result<(), NoWindow> {
    if !display_named() {
        return Err(NoWindow::Unavailable(
            "no display: neither DISPLAY nor WAYLAND_DISPLAY is set".to_owned(),
        ));
    }
    let options = eframe::NativeOptions {
        viewport: egui::ViewportBuilder::default()
            .with_title("Pickglass")
            .with_app_id("pickglass")
            .with_inner_size([1280.0, 800.0])
            .with_min_inner_size([640.0, 400.0])
            .with_drag_and_drop(true),
        ..Default::default()
    };
    let shown = Arc::new(AtomicBool::new(false));
    let created = Arc::clone(&shown);
    let outcome = eframe::run_native(
        "pickglass",
        options,
        Box::new(move |cc| {
            let options = AppOptions {
                settings: SettingsFile::of_user(),
                recovery: RecoveryFolder::of_user(),
                ..AppOptions::default()
            };
            let app = app::App::new(&cc.egui_ctx, opened, options)?;
            created.store(true, Ordering::Relaxed);
            Ok(Box::new(app.closing_after(smoke_frames)))
        }),
    );
    match outcome {
        Ok(()) => Ok(()),
        Err(error) if shown.load(Ordering::Relaxed) => Err(NoWindow::Broken(anyhow::anyhow!(
            "the window broke ({error}): start again, or use `pickglass still`"
        ))),
        Err(error) => Err(NoWindow::Unavailable(few_words(&error.to_string()))),
    }
}

/// The beginning of an error, without the places in code that some append.
fn few_words(error: &str) -> String {
    const MOST: usize = 100;
    let plain: Vec<&str> = (error.split_whitespace())
        .take_while(|word| !word.contains("/src/") && !word.contains(".rs"))
        .collect();
    let mut words = plain.join(" ");
    if let Some((end, _)) = words.char_indices().nth(MOST) {
        words.truncate(end);
        words.push('…');
    }
    words.trim_end_matches([':', ',', '(', ' ']).to_owned()
}

/// Whether the environment names a display; systems without such names always have one.
fn display_named() -> bool {
    let named = |name| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    !cfg!(all(unix, not(target_os = "macos")))
        || named("DISPLAY")
        || named("WAYLAND_DISPLAY")
        || named("WAYLAND_SOCKET")
}

#[cfg(test)]
mod few_words_tests {
    use super::few_words;

    #[test]
    fn a_reason_is_short_and_names_no_place_in_code() {
        let long = "winit EventLoopError: os error at /home/x/src/platform/mod.rs:762: failed";
        assert_eq!(few_words(long), "winit EventLoopError: os error at");
        assert_eq!(few_words("no \n adapter"), "no adapter");
        assert_eq!(few_words(&"é".repeat(300)).chars().count(), 101);
    }
}
