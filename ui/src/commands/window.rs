//! `pickglass [DESIGN]`: the window, or a still where there is no display.

use std::path::Path;

use serde_json::json;

use super::{note_warnings, still};
use crate::cli::WindowArgs;
use crate::opened::{DEFAULT_PRESET, Opened};
use crate::out;
use crate::window::{self, NoWindow};
use pickglass::still::{StillRequest, Stop};

/// Where the picture goes when no window can open.
const FALLBACK_PICTURE: &str = "cloth.png";
/// How long that picture refines, s.
const FALLBACK_SECONDS: f64 = 20.0;

pub fn run(args: &WindowArgs) -> anyhow::Result<()> {
    let argument = args.design.as_deref().unwrap_or(DEFAULT_PRESET);
    let opened = Opened::argument(argument, &args.sett, &args.image)?;
    note_warnings(&opened.warnings);
    let name = opened.name().to_owned();
    // Without a design the start page is shown.
    let shown = args.design.is_some().then(|| opened.clone());
    match window::run(shown, args.smoke_frames) {
        Ok(()) if args.json => out::say_json(&json!({ "opened": name })),
        Ok(()) => Ok(()),
        Err(NoWindow::Unavailable(reason)) => without_window(&opened, &reason, args.json),
        Err(NoWindow::Broken(error)) => Err(error),
    }
}

fn without_window(opened: &Opened, reason: &str, json: bool) -> anyhow::Result<()> {
    out::note(&format!(
        "No window ({reason}): rendering {} to {FALLBACK_PICTURE} instead.",
        opened.name()
    ));
    let request = StillRequest {
        width: 1280,
        height: 720,
        stop: Stop {
            seconds: Some(FALLBACK_SECONDS),
            ..Stop::default()
        },
        ..StillRequest::default()
    };
    let path = Path::new(FALLBACK_PICTURE);
    let report = still::render_to(opened, &request, path)?;
    if json {
        return out::say_json(&still::report_json(&report));
    }
    out::say(&still::describe(&report, path))
}
