//! The command line that makes a picture again: what a picture's file says of how it was asked
//! for, in the program's own grammar.

use super::request::{LightChoice, StillReport, StillRequest};
use crate::plan::{DIALS, Effect, EffectBase, EffectChoice, Settings};
use crate::text::shell_word;

/// What a picture's file says of how it is made again.
#[derive(Debug, Clone)]
pub(super) struct Again {
    /// What a command line calls what it shows, with the options for reading it.
    pub source: Option<String>,
    options: String,
}

impl Again {
    /// Of a picture of `request` that came about as `report` says.
    pub fn new(request: &StillRequest, report: &StillReport) -> Self {
        Self {
            source: None,
            options: options(
                request,
                &report.renderer,
                // Nothing else is known of how many there are where an engine has no paths.
                (report.paths_per_second > 0.0).then_some(report.spp),
            ),
        }
    }

    /// The whole command line.
    pub fn line(&self) -> String {
        let source = self.source.as_deref().unwrap_or("DESIGN");
        format!("pickglass still {source} -o OUT.png {}", self.options)
    }
}

/// The options of `pickglass still` that make the picture of `request` with an engine, with
/// `spp` paths a pixel where it has paths. Dials stand there where they are not as usual.
pub fn options(request: &StillRequest, renderer: &str, spp: Option<u32>) -> String {
    let mut words = Vec::new();
    let mut say = |name: &str, value: String| words.push(format!("--{name} {value}"));
    say("size", format!("{}x{}", request.width, request.height));
    if let Some(spp) = spp {
        say("spp", spp.to_string());
    }
    say("view", request.view.to_string());
    if let Some(eye) = request.eye {
        say("eye", eye.to_string());
    }
    if let Some(mm) = request.width_mm {
        say("mm", mm.to_string());
    }
    if let Some([x, y]) = request.centre_mm {
        say("centre", format!("{x},{y}"));
    }
    say("light", light(&request.light));
    if request.exposure_ev.abs() > 0.0 {
        say("exposure", request.exposure_ev.to_string());
    }
    say("backing", request.backing.to_string());
    say("renderer", renderer.to_owned());
    say("effects", effects(&request.effects));
    if let Some(colourway) = &request.colourway {
        say("colourway", shell_word(colourway).into_owned());
    }
    say("seed", request.seed.to_string());
    let usual = Settings::default();
    for dial in DIALS {
        let value = dial.get(&request.settings);
        // There is nothing to turn of what is left out.
        let is_idle = left_out(&request.effects).any(|effect| dial.effect == Some(effect));
        // Paths a pixel are said above.
        if dial.name != "spp" && value != dial.get(&usual) && !is_idle {
            say("set", format!("{}={value}", dial.name));
        }
    }
    if request.turned {
        words.push("--turned".to_owned());
    }
    words.join(" ")
}

fn light(choice: &LightChoice) -> String {
    match choice {
        LightChoice::Preset(name) => shell_word(name).into_owned(),
        LightChoice::Environment(path) => shell_word(&path.display().to_string()).into_owned(),
        LightChoice::Sun(heading) => heading.to_string(),
    }
}

fn effects(choice: &EffectChoice) -> String {
    let changes = choice.changes.iter().map(|(effect, on)| {
        let sign = if *on { '+' } else { '-' };
        format!(",{sign}{effect}")
    });
    // What the scene does not call for is said by name: it need not be found out again.
    let found = left_out(choice).map(|effect| format!(",-{effect}"));
    (changes.chain(found)).fold(choice.base.to_string(), |words, word| words + &word)
}

/// Effects that the scene does not call for, where nobody said otherwise.
fn left_out(choice: &EffectChoice) -> impl Iterator<Item = Effect> {
    let is_auto = choice.base == EffectBase::Auto;
    let off = (choice.found.iter()).filter(move |found| is_auto && !found.on);
    let off = off.map(|found| found.effect);
    off.filter(|effect| choice.named(*effect).is_none())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::Heading;
    use crate::plan::Found;
    use crate::render::Backing;

    #[test]
    fn all_that_was_asked_for_is_said() {
        let mut request = StillRequest {
            width: 64,
            height: 48,
            eye: Some(Heading {
                azimuth: 270,
                elevation: 40,
            }),
            turned: true,
            width_mm: Some(2.5),
            centre_mm: Some([-1.0, 0.25]),
            light: LightChoice::Environment("my light.exr".into()),
            backing: Backing::Itself,
            effects: EffectChoice {
                base: EffectBase::None,
                changes: vec![(Effect::Sky, true), (Effect::EdgeFixing, false)],
                ..EffectChoice::default()
            },
            colourway: Some("it's".to_owned()),
            ..StillRequest::default()
        };
        request.settings.cloth.level = 2;
        assert_eq!(
            options(&request, "cpu", Some(12)),
            "--size 64x48 --spp 12 --view face --eye 270,40 --mm 2.5 --centre -1,0.25 \
             --light 'my light.exr' --backing self --renderer cpu \
             --effects none,+sky,-edge-fixing --colourway 'it'\\''s' --seed 0 --set level=2 \
             --turned"
        );
    }

    #[test]
    fn what_the_scene_leaves_out_has_no_dial_to_set() {
        let mut request = StillRequest::default();
        request.settings.render.max_order = 8;
        assert!(options(&request, "cpu", None).contains("--set order=8"));
        request.effects.found.push(Found {
            effect: Effect::Multiple,
            on: false,
            why: String::new(),
        });
        let said = options(&request, "cpu", None);
        assert!(
            said.contains("--effects auto,-multiple") && !said.contains("--set order"),
            "{said}"
        );
        // Named, it is simulated, and its dial says something.
        request.effects.switch(Effect::Multiple, Some(true));
        assert!(options(&request, "cpu", None).contains("--set order=8"));
    }
}
