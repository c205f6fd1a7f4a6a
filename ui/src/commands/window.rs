//! `pickglass [DESIGN]`: the window, or a still where there is no display.

use std::ffi::OsString;
use std::path::Path;
use std::time::Instant;

use serde_json::json;

use super::{note_warnings, still};
use crate::cli::{WindowArgs, source_words};
use crate::idle;
use crate::opened::{DEFAULT_PRESET, Opened};
use crate::out;
use crate::window::{self, NoWindow, Start};
use pickglass::engine::{StillRequest, Stop, reference};
use pickglass::formats::output;
use pickglass::render::Backing;

/// Where the picture goes when no window can open.
const FALLBACK_PICTURE: &str = "cloth.png";
/// How long that picture refines, s.
const FALLBACK_SECONDS: f64 = 20.0;

pub fn run(args: &WindowArgs) -> anyhow::Result<()> {
    let argument = args.design.as_deref().unwrap_or(DEFAULT_PRESET);
    idle::in_reading(argument, &args.image)?;
    let opened = Opened::argument(argument, &args.sett, &args.image)?;
    note_warnings(&opened.warnings);
    let name = opened.name().to_owned();
    let start = Start {
        // Without a design the start page is shown.
        opened: args.design.is_some().then(|| opened.clone()),
        recover: args.recover.clone(),
        restarts: args.restarted.clone().unwrap_or_default(),
        smoke_frames: args.smoke_frames,
        lose_device_after: args.smoke_lose_device,
        carry: carried(args),
    };
    match window::run(start) {
        Ok(()) if args.json => out::say_json(&json!({ "opened": name })),
        Ok(()) => Ok(()),
        Err(NoWindow::Unavailable(reason)) => match &args.recover {
            Some(copy) => Err(anyhow::anyhow!(
                "no window ({reason}): the work is in {} and is offered at the next start",
                copy.display()
            )),
            None => {
                let source = source_words(argument, &args.sett, &args.image);
                without_window(&opened, &reason, source.join(" "), args.json)
            }
        },
        Err(NoWindow::Broken(error)) => Err(error),
    }
}

/// What a program that starts itself again is told once more.
fn carried(args: &WindowArgs) -> Vec<OsString> {
    let mut carried = Vec::new();
    if args.json {
        carried.push("--json".into());
    }
    if let Some(frames) = args.smoke_frames {
        carried.extend(["--smoke-frames".into(), frames.to_string().into()]);
    }
    carried
}

fn without_window(opened: &Opened, reason: &str, source: String, json: bool) -> anyhow::Result<()> {
    out::note(&format!(
        "No window ({reason}): rendering {} to {FALLBACK_PICTURE} instead.",
        opened.name()
    ));
    let request = StillRequest {
        width: 1280,
        height: 720,
        backing: Backing::Itself,
        stop: Stop {
            seconds: Some(FALLBACK_SECONDS),
            ..Stop::default()
        },
        ..StillRequest::default()
    };
    let path = Path::new(FALLBACK_PICTURE);
    output::check(path, opened.path.as_deref())?;
    let made = still::render_to(
        opened,
        (&request, reference()),
        still::Settling::Nothing,
        path,
        Instant::now(),
        source,
    )?;
    made.tell(path, json)
}
