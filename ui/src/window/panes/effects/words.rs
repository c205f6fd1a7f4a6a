//! What the pane of effects says, in a designer's words.

use pickglass::needs::{Need, at_most};
use pickglass::plan::{Decider, Effect, Planned};

use super::looking::{Looked, Stale};

/// A smaller share of the work is told as none.
const HARDLY: f64 = 0.02;

/// What a designer calls an effect, within a sentence.
pub fn name(effect: Effect) -> &'static str {
    match effect {
        Effect::Shadows => "shadows",
        Effect::Multiple => "scattered light",
        Effect::Sky => "sky light",
        Effect::Hairs => "flyaway hairs",
        Effect::EdgeFixing => "edge fixing",
        Effect::Randomisation => "randomisation",
        Effect::Tap => "smoothing",
    }
}

/// As [`name`], where a sentence begins.
pub fn title(effect: Effect) -> String {
    sentence(name(effect))
}

/// What an effect does, and what the command line calls it.
pub fn about(effect: Effect) -> String {
    format!("{} On the command line: {effect}", effect.about())
}

/// How far a look is, by the library's name of what it is at.
pub fn stage(stage: &str, share: f32) -> String {
    let without = stage.strip_prefix("without ");
    let told = match without.and_then(|effect| effect.parse().ok()) {
        Some(effect) => format!("looking without {}", name(effect)),
        None => stage.to_owned(),
    };
    format!("{} · {:.0} %", sentence(&told), 100.0 * share)
}

/// Whether an effect is on, and who decided so; `brief` where more is said of it.
pub fn state(planned: &Planned, brief: bool) -> String {
    match (planned.on, planned.by) {
        (true, Decider::Person) => "On: you asked for it.".to_owned(),
        (false, Decider::Person) => "Off: you left it out.".to_owned(),
        (true, Decider::Scene) if brief => "On by itself.".to_owned(),
        (true, Decider::Scene) => "On by itself: nothing is left out unasked.".to_owned(),
        (on, _) => format!("{}: {}.", if on { "On" } else { "Off" }, planned.why),
    }
}

/// What a look found of an effect; nothing where it was left out then.
pub fn found(need: &Need) -> String {
    if need.bound == Some(0.0) && !need.on {
        return format!("{}: leaving it out changes nothing.", sentence(&need.why));
    }
    let cost = match need.cost {
        Some(cost) if cost > HARDLY => {
            format!("{}{} of the work. ", share(cost), need.cost_range())
        }
        Some(_) => "Next to none of the work. ".to_owned(),
        None => String::new(),
    };
    match (need.by, need.bound, need.changes()) {
        (Decider::Scene, Some(_), _) => format!("{cost}{}.", sentence(&need.why)),
        (_, _, Some(changes)) => format!("{cost}Without it {changes}."),
        _ => cost.trim_end().to_owned(),
    }
}

/// What takes most of the work of a picture, and what may be left out of it.
pub fn verdict(looked: &Looked) -> String {
    let dearest = match looked.dearest() {
        Some((effect, cost)) if cost > HARDLY => format!(
            "The biggest cost in this picture is {}: {} of the work.",
            name(effect),
            share(cost)
        ),
        _ => "No effect costs much in this picture.".to_owned(),
    };
    format!("{dearest} {}", unseen(looked))
}

/// What may be left out.
fn unseen(looked: &Looked) -> String {
    let (absent, bounded): (Vec<&Need>, Vec<&Need>) =
        looked.unseen().partition(|need| need.bound == Some(0.0));
    let mut told = Vec::new();
    if !absent.is_empty() {
        let one = absent.len() == 1 && absent[0].effect == Effect::Sky;
        let none = if one {
            "there is none"
        } else {
            "there are none"
        };
        let names = sentence(&listed(&names(&absent)));
        told.push(format!("{names} can be left out: {none}."));
    }
    let mut faint = names(&bounded);
    if let Some(order) = looked.order {
        faint.push(format!("what is scattered more than {order} times"));
    }
    if !faint.is_empty() {
        told.push(format!(
            "{} can be left out unseen: that changes 95 of 100 places by {} at most and saves {} of the work.",
            sentence(&listed(&faint)),
            at_most(looked.needs.left_out),
            share(looked.needs.saved)
        ));
    }
    // Nobody bounds what these change, but no more was seen of them.
    let hardly: Vec<&Need> = (looked.needs.effects.iter())
        .filter(|need| hardly_seen(need, looked.tolerance))
        .collect();
    if !hardly.is_empty() {
        told.push(format!(
            "Of {} hardly anything was seen: judge by the pictures.",
            listed(&names(&hardly))
        ));
    }
    if told.is_empty() {
        told.push("Nothing can be left out unseen.".to_owned());
    }
    told.join(" ")
}

/// Whether less than a tolerance was seen of an effect that is never left out by that.
fn hardly_seen(need: &Need, tolerance: f64) -> bool {
    let bounded = matches!(need.effect, Effect::Multiple | Effect::Sky);
    let seen = need.on && need.by == Decider::Scene && need.change.is_some() && !bounded;
    seen && need.bound.is_some_and(|bound| bound <= tolerance)
}

/// Why what was found is not of what is shown.
pub fn stale(stale: Stale) -> &'static str {
    match stale {
        Stale::Design => "This was looked at before the design was changed.",
        Stale::View => "This was looked at in another view, or with other settings.",
        Stale::Switched => "This was looked at with other effects, or another tolerance.",
    }
}

fn names(needs: &[&Need]) -> Vec<String> {
    needs
        .iter()
        .map(|need| name(need.effect).to_owned())
        .collect()
}

/// Names in a row: `a`, `a and b`, `a, b and c`.
fn listed(names: &[String]) -> String {
    match names {
        [all @ .., last] if !all.is_empty() => format!("{} and {last}", all.join(", ")),
        _ => names.concat(),
    }
}

/// With a capital.
pub fn sentence(text: &str) -> String {
    let mut letters = text.chars();
    match letters.next() {
        Some(first) => first.to_uppercase().chain(letters).collect(),
        None => String::new(),
    }
}

/// A share in per cent.
fn share(share: f64) -> String {
    match 100.0 * share {
        percent if percent < 0.95 => "under 1 %".to_owned(),
        percent => format!("{percent:.0} %"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_stand_in_a_row_and_stages_in_words() {
        let names = ["a", "b", "c"].map(str::to_owned);
        assert_eq!(listed(&names), "a, b and c");
        assert_eq!(listed(&names[..2]), "a and b");
        assert_eq!(listed(&names[..1]), "a");
        assert_eq!(listed(&[]), "");
        let said = stage("without edge-fixing", 0.5);
        assert_eq!(said, "Looking without edge fixing · 50 %");
        assert_eq!(stage("making the cloth", 0.0), "Making the cloth · 0 %");
        assert_eq!(stage("without glow", 0.0), "Without glow · 0 %");
        assert_eq!(
            (share(0.004), share(0.36)),
            ("under 1 %".into(), "36 %".into())
        );
    }
}
