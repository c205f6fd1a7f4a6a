//! The window: paint a weave, watch the cloth.
//!
//! [`app`] holds the state and the frame; [`layout`] says where the panes lie. A pane
//! changes nothing itself: it pushes [`action`]s, which [`act`] does after all panes were
//! shown; [`run_command`] does the commands of menus and keys.
//!
//! | modules | what they are |
//! |---|---|
//! | `draft`, `preview`, `cloth`, `worker` | the pane one paints in; the cloth, and the threads that draw it |
//! | `panes`, `layout`, `dividers` | the other panes, a row each, and where they lie |
//! | `menu`, `palette`, `tools`, `status`, `forecast`, `toasts`, `focus`, `icons` | round them |
//! | `start`, `session`, `settings`, `autosave`, `lost`, `leaving` | what is open, remembered and recovered |
//! | `files`, `import`, `export`, `volume`, `dialog`, `task` | files, on further threads, so that the window never waits |
//! | `forms`, `asking`, `typing`, `image_form`, `settings_form` | what asks |
//! | `machine_check` | hard cases, tried here |

mod act;
mod action;
mod app;
mod asking;
mod autosave;
mod cloth;
mod cloth_pane;
mod crossing;
mod dialog;
mod dividers;
mod draft;
mod export;
mod files;
mod focus;
mod forecast;
mod forms;
mod icons;
mod image_form;
mod import;
mod laid;
mod layout;
mod leaving;
mod lost;
mod machine_check;
mod menu;
mod pace;
mod palette;
pub mod panes;
mod picture;
mod preview;
mod run_command;
mod session;
mod settings;
mod settings_form;
mod start;
mod status;
mod task;
#[cfg(test)]
mod tests;
mod thumbs;
mod toasts;
mod tools;
mod typing;
mod view;
mod volume;
mod weave;
mod worker;

use std::any::Any;
use std::ffi::OsString;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::opened::Opened;
use app::AppOptions;
use autosave::RecoveryFolder;
pub use lost::Restarts;
pub use panes::Pane;
use settings::SettingsFile;

/// Why there is no window.
pub enum NoWindow {
    /// None can open here; the reason in a few words.
    Unavailable(String),
    /// It opened and then broke.
    Broken(anyhow::Error),
}

/// What the window is opened with.
pub struct Start {
    /// `None` = the start page.
    pub opened: Option<Opened>,
    /// A recovery copy to open instead.
    pub recover: Option<PathBuf>,
    /// How often the program started itself again.
    pub restarts: Restarts,
    /// The window closes itself after this many frames.
    pub smoke_frames: Option<u32>,
    /// The graphics device is lost after this many frames.
    pub lose_device_after: Option<u32>,
    /// Arguments that are handed on when the program starts itself again.
    pub carry: Vec<OsString>,
}

/// Opens the window and returns when it is closed.
pub fn run(start: Start) -> Result<(), NoWindow> {
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
    let lost = Arc::new(AtomicBool::new(false));
    hush(&shown, &lost);
    let (created, losing) = (Arc::clone(&shown), Arc::clone(&lost));
    let open = move || {
        eframe::run_native(
            "pickglass",
            options,
            Box::new(move |cc| {
                let app = watched_app(cc, start, losing)?;
                created.store(true, Ordering::Relaxed);
                Ok(Box::new(app))
            }),
        )
    };
    let broke = |why: &str| NoWindow::Broken(anyhow::anyhow!("{why}"));
    match catch_unwind(AssertUnwindSafe(open)) {
        Ok(Ok(())) => Ok(()),
        Ok(Err(error)) if shown.load(Ordering::Relaxed) => Err(broke(&format!(
            "the window broke ({error}): start again, or use `pickglass still`"
        ))),
        Ok(Err(error)) => Err(NoWindow::Unavailable(unavailable(&error))),
        // The thread that starts the program again ends this one; it does not come to this.
        Err(_) if lost.load(Ordering::SeqCst) => Err(broke(
            "the graphics device was lost: start again; unsaved work is offered",
        )),
        Err(panic) if shown.load(Ordering::Relaxed) => resume_unwind(panic),
        Err(panic) => Err(NoWindow::Unavailable(no_window_system(&*panic))),
    }
}

/// The window's state, with the device watched.
fn watched_app(
    cc: &eframe::CreationContext<'_>,
    start: Start,
    lost: Arc<AtomicBool>,
) -> std::io::Result<app::App> {
    let options = AppOptions {
        settings: SettingsFile::of_user(),
        recovery: RecoveryFolder::of_user(),
        ..AppOptions::default()
    };
    let mut app = app::App::new(&cc.egui_ctx, start.opened, options)?;
    app.begin_with(&cc.egui_ctx, start.recover, &start.restarts);
    if let Some(state) = &cc.wgpu_render_state {
        let (restarts, carry) = (start.restarts, start.carry);
        let then = move |rescued| {
            let (code, line) = lost::follow(&rescued, &restarts, &carry);
            crate::out::note(&format!("pickglass: {line}"));
            std::process::exit(code);
        };
        app.watch(&state.device, lost, Arc::new(then));
    }
    Ok(app
        .closing_after(start.smoke_frames)
        .losing_after(start.lose_device_after))
}

/// Says nothing of what breaks because the device is lost, or because no window can open:
/// both are told in one line by who finds out.
fn hush(shown: &Arc<AtomicBool>, lost: &Arc<AtomicBool>) {
    let (shown, lost) = (Arc::clone(shown), Arc::clone(lost));
    let usual = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |info| {
        let opening =
            !shown.load(Ordering::Relaxed) && std::thread::current().name() == Some("main");
        if !opening && !lost.load(Ordering::SeqCst) {
            usual(info);
        }
    }));
}

/// Debian's packages that let wgpu find an adapter, at least one that draws in software.
const ADAPTER_PACKAGES: &str = "mesa-vulkan-drivers libvulkan1";
/// Debian's packages that winit loads while it opens a window.
const WINDOW_PACKAGES: &str =
    "libxkbcommon-x11-0 libxkbcommon0 libx11-6 libx11-xcb1 libxcursor1 libxi6 libxrandr2";

/// Why no window opened, with what to do where that is known.
fn unavailable(error: &eframe::Error) -> String {
    let why = few_words(&error.to_string());
    match error {
        eframe::Error::Wgpu(_) => format!(
            "no usable graphics adapter, on Debian or Ubuntu: sudo apt-get install \
             {ADAPTER_PACKAGES}; {why}"
        ),
        _ => why,
    }
}

/// As [`unavailable`], for a library of the system that is not there: winit gives up then.
fn no_window_system(panic: &(dyn Any + Send)) -> String {
    let said = (panic.downcast_ref::<String>().map(String::as_str))
        .or_else(|| panic.downcast_ref::<&str>().copied());
    let why = few_words(said.unwrap_or("for a reason it did not give"));
    format!(
        "the window system cannot be used, on Debian or Ubuntu: sudo apt-get install {WINDOW_PACKAGES}; {why}"
    )
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
mod opening_tests {
    use super::*;

    #[test]
    fn a_reason_is_short_and_names_no_place_in_code() {
        let long = "winit EventLoopError: os error at /home/x/src/platform/mod.rs:762: failed";
        assert_eq!(few_words(long), "winit EventLoopError: os error at");
        assert_eq!(few_words("no \n adapter"), "no adapter");
        assert_eq!(few_words(&"é".repeat(300)).chars().count(), 101);
    }

    #[test]
    fn without_an_adapter_one_line_names_the_packages() {
        use eframe::egui_wgpu::WgpuError;
        for error in [
            WgpuError::NoSurfaceFormatsAvailable,
            WgpuError::CustomNativeAdapterSelectionError("none\nat all".to_owned()),
        ] {
            let line = unavailable(&eframe::Error::Wgpu(error));
            assert!(line.contains("sudo apt-get install mesa-vulkan-drivers libvulkan1"));
            assert!(!line.contains('\n'), "{line}");
        }
        // Another error is not blamed on the adapter.
        let other = unavailable(&eframe::Error::AppCreation("no thread".into()));
        assert!(
            other.contains("no thread") && !other.contains("mesa"),
            "{other}"
        );
        let lacking: Box<dyn Any + Send> = Box::new("Library libxkbcommon-x11.so".to_owned());
        let line = no_window_system(&*lacking);
        assert!(line.contains("libxkbcommon-x11-0") && line.ends_with("libxkbcommon-x11.so"));
    }
}
