//! `pickglass effects`: what a picture calls for.

use pickglass::engine::{self, StillRequest};
use pickglass::exemplar::ExemplarStore;
use pickglass::needs::{self, Need, Needs};
use pickglass::plan::{Effect, Subject};
use pickglass::render::Backing;
use serde_json::{Value, json};

use super::{note_warnings, still};
use crate::cli::EffectsArgs;
use crate::idle;
use crate::interrupt::Interrupt;
use crate::opened::Opened;
use crate::out::{self, Progress};

/// Looks at the picture, and says what it calls for.
pub fn run(args: &EffectsArgs) -> anyhow::Result<()> {
    idle::in_reading(&args.design, &args.image)?;
    let opened = Opened::argument(&args.design, &args.sett, &args.image)?;
    note_warnings(&opened.warnings);
    let renderer = engine::renderer(&args.picture.renderer)?;
    if !renderer.refines {
        anyhow::bail!(
            "--renderer {}: it follows no paths, and has none of what is looked at: use auto",
            renderer.name
        );
    }
    let mut request = still::picture(&args.picture, Backing::Itself)?;
    request.colourway.clone_from(&args.colourway);
    let stop = args.picture.spp.map(|_| "--spp");
    idle::in_picture(&args.picture, stop, &request, renderer, Subject::Cloth)?;
    let progress = Progress::new();
    let job = progress.job();
    let interrupt = Interrupt::watch(&job);
    let store = ExemplarStore::user();
    let found = needs::survey(
        &opened.design,
        renderer,
        &request,
        args.tolerance,
        &store,
        &job,
    );
    progress.finish();
    if found.is_err() && interrupt.happened() {
        anyhow::bail!("interrupted before all effects were looked at: give it more time");
    }
    let (settled, needs) = found?;
    match args.json {
        true => out::say_json(&needs_json(&settled, renderer.name, &needs)),
        false => out::say(&lines(&settled, &needs, args.tolerance)),
    }
}

/// A line for each effect.
fn lines(settled: &StillRequest, needs: &Needs, tolerance: f64) -> String {
    let mut lines = vec![format!(
        "{} blocks looked at, tolerance {}",
        needs.blocks,
        share(tolerance)
    )];
    lines.extend(needs.effects.iter().map(line));
    lines.push(left_out(settled, needs));
    lines.join("\n")
}

fn line(need: &Need) -> String {
    let on = if need.on { "on" } else { "off" };
    let by = need.by.to_string();
    let cost = need.cost.map_or_else(String::new, |cost| match cost {
        cost if cost > 0.02 => format!("; it is {}{} of the work", share(cost), need.cost_range()),
        _ => "; it costs next to nothing".to_owned(),
    });
    let (name, why) = (need.effect.name(), &need.why);
    format!("  {name:<13} {on:<3} {by:<8} {why}{cost}")
}

/// What is left out of a picture, in one line.
pub fn left_out(settled: &StillRequest, needs: &Needs) -> String {
    let off = (needs.effects.iter()).filter(|need| !need.on && need.bound.is_some());
    let mut parts: Vec<String> = off.map(|need| need.effect.name().to_owned()).collect();
    let multiple = (needs.effects.iter()).find(|need| need.effect == Effect::Multiple);
    if multiple.is_some_and(|need| need.on) && needs.saved > 0.0 {
        let order = settled.settings.render.max_order;
        parts.push(format!("scattering beyond {order} times"));
    }
    match parts.is_empty() {
        true => "nothing is left out: all of it shows".to_owned(),
        false => format!(
            "left out: {}; together that changes 95 of 100 blocks by no more than {}, and saves {} of the work",
            parts.join(", "),
            share(needs.left_out),
            share(needs.saved)
        ),
    }
}

fn share(share: f64) -> String {
    match 100.0 * share {
        percent if percent < 9.95 => format!("{percent:.1} %"),
        percent => format!("{percent:.0} %"),
    }
}

/// What was found, with the keys that scripts rely on.
pub fn needs_json(settled: &StillRequest, renderer: &str, needs: &Needs) -> Value {
    let effects = needs.effects.iter().map(|need| {
        json!({
            "name": need.effect.name(),
            "on": need.on,
            "by": need.by.to_string(),
            "reason": need.why,
            "bound": need.bound,
            "change": need.change,
            "noise": need.noise,
            "cost": need.cost,
            "cost_interval": need.cost_interval,
        })
    });
    json!({
        "effects": effects.collect::<Vec<_>>(),
        "blocks": needs.blocks,
        "tolerance": needs.tolerance,
        "left_out": needs.left_out,
        "saved": needs.saved,
        "order": settled.settings.render.max_order,
        "seconds": needs.seconds,
        "options": engine::options(settled, renderer, settled.stop.spp),
    })
}
