//! Designs that nobody would weave, drawn small by every engine.

#![allow(clippy::unwrap_used, reason = "a test may fail")]

use std::sync::Arc;

use crate::how_many;
use pickglass::design::{
    Density, Design, Family, Lattice, Repeat, Sett, Srgb, Structure, WeavePattern, Yarn, YarnId,
    YarnMaps, library,
};
use pickglass::engine::{Heading, LightChoice, RENDERERS, StillRequest, Stop, render_still};
use pickglass::job::Job;
use pickglass::plan::{Effect, EffectChoice, Settings};
use pickglass::random::Random;
use pickglass::render::Backing;
use pickglass::scene::{PRESET_NAMES, View};
use pickglass::synthesis::{Method, Rank, Seams};

struct Dice(Random);

impl Dice {
    fn below(&mut self, sides: usize) -> usize {
        (self.0.bits() % sides.max(1) as u64) as usize
    }

    fn one<T: Copy>(&mut self, of: &[T]) -> T {
        of[self.below(of.len())]
    }

    /// Even in its logarithm.
    fn between(&mut self, low: f32, high: f32) -> f32 {
        low * (high / low).powf(self.0.uniform())
    }
}

fn pattern(dice: &mut Dice) -> WeavePattern {
    if dice.below(3) == 0 {
        return library()[dice.below(library().len())].pattern().clone();
    }
    let (ends, picks) = (1 + dice.below(40) as u32, 1 + dice.below(40) as u32);
    let share = dice.0.uniform();
    WeavePattern::from_fn(ends, picks, |_, _| dice.0.uniform() < share)
}

fn design(dice: &mut Dice) -> Design {
    let families = [Family::Cotton, Family::Silk, Family::Wool, Family::Linen];
    let per_cm = [dice.between(2.0, 90.0), dice.between(2.0, 90.0)];
    let thick = dice.between(0.3, 3.0);
    let grey = dice.one(&[0u8, 1, 90, 254, 255]);
    let two = [dice.one(&families), dice.one(&families)];
    let yarns: Vec<Yarn> = (0..1 + dice.below(4))
        .map(|number| Yarn {
            // A share of a thread's place; few sizes, as each takes exemplars of its own.
            diameter_mm: (number % 2 == 0).then(|| (thick * 10.0 / per_cm[0]).clamp(0.02, 3.0)),
            ..Yarn::new(
                format!("yarn {number}"),
                two[number % 2],
                Srgb(grey, dice.below(256) as u8, dice.below(256) as u8),
            )
        })
        .collect();
    let order = |dice: &mut Dice| -> Vec<YarnId> {
        (0..1 + dice.below(30))
            .map(|_| YarnId(dice.below(yarns.len()) as u16))
            .collect()
    };
    let maps = YarnMaps::orders(order(dice), order(dice));
    let lattice = dice.one(&[
        Lattice::default(),
        Lattice {
            across: Repeat::Dropped(3),
            along: Repeat::Straight,
        },
        Lattice {
            across: Repeat::None,
            along: Repeat::None,
        },
    ]);
    let pattern = pattern(dice);
    let mut sett = Sett::per_cm(per_cm[0], per_cm[1]);
    if dice.below(4) == 0 {
        let pitches = (0..pattern.ends()).map(|_| dice.between(0.002, 3.0));
        sett.ends = Density {
            pitches_mm: Some(pitches.collect()),
            ..sett.ends
        };
    }
    let structure = Structure::Pattern(pattern);
    let design = Design::new("random", structure, yarns, maps, sett).unwrap();
    design.with_lattice(lattice).unwrap()
}

fn request(dice: &mut Dice) -> StillRequest {
    let heading = |dice: &mut Dice| Heading {
        azimuth: dice.below(720) as i16 - 360,
        elevation: dice.one(&[0, 1, 2, 30, 89, 90]),
    };
    let mut settings = Settings::default().at_level(dice.one(&[3, 4]));
    settings.cloth.tap = dice.below(2) == 0;
    settings.cloth.synthesis.rank = dice.one(&[
        Rank::Off,
        Rank::Truncated(1),
        Rank::Truncated(15),
        Rank::Exact,
    ]);
    settings.cloth.synthesis.seams = dice.one(&[Seams::Membrane, Seams::Crowns]);
    settings.cloth.synthesis.method = dice.one(&[Method::Naive, Method::Greedy, Method::Dp]);
    settings.cloth.synthesis.patch = dice.one(&[0, 1, 3, 64]);
    settings.render.max_order = dice.one(&[1, 8, 256]);
    settings.showing.denoise = dice.below(2) == 0;
    let changes = Effect::ALL.iter().filter(|_| dice.below(8) == 0);
    let changes: Vec<_> = changes.map(|effect| (*effect, false)).collect();
    StillRequest {
        width: 1 + dice.below(24) as u32,
        height: 1 + dice.below(24) as u32,
        view: dice.one(View::ALL),
        eye: (dice.below(3) == 0).then(|| heading(dice)),
        turned: dice.below(2) == 0,
        width_mm: Some(dice.between(0.02, 400.0)),
        centre_mm: (dice.below(3) == 0).then(|| [dice.between(1.0, 1e7), -dice.between(1.0, 1e7)]),
        light: match dice.below(3) {
            0 => LightChoice::Sun(heading(dice)),
            _ => LightChoice::Preset(dice.one(&PRESET_NAMES).to_owned()),
        },
        exposure_ev: dice.one(&[0.0, -9.0, 9.0]),
        backing: dice.one(&[
            Backing::None,
            Backing::White,
            Backing::Black,
            Backing::Itself,
        ]),
        effects: EffectChoice {
            changes,
            ..EffectChoice::default()
        },
        settings,
        seed: dice.0.bits(),
        stop: Stop {
            spp: Some(2),
            ..Stop::default()
        },
        ..StillRequest::default()
    }
}

#[test]
fn random_designs_come_out_whole() {
    let job = Job::new();
    let (mut pictures, mut refused) = (0, 0);
    let mut faults = Vec::new();
    for number in 0..how_many(8, 1000) {
        let mut dice = Dice(Random::new(77, number, 0));
        let design = Arc::new(design(&mut dice));
        let request = request(&mut dice);
        for renderer in RENDERERS {
            let still = match render_still(&design, &request, renderer, &job, &mut |_| {}) {
                Ok(still) => still,
                Err(error) => {
                    // In one line; too few are made for many to be refused.
                    let said = error.to_string();
                    assert!(!said.chars().any(char::is_control), "{said:?}");
                    println!("{number} {}: {said}", renderer.name);
                    refused += 1;
                    continue;
                }
            };
            pictures += 1;
            let report = &still.report;
            let counted = [
                report.invalid_samples,
                report.invalid_rays,
                report.majorant_violations,
            ];
            let light = |mean: glam::Vec3| mean.is_finite() && mean.min_element() >= 0.0;
            let shown = |value: &f32| (0.0..=1.0).contains(value);
            let whole = counted == [0, 0, 0]
                && still.film.means().into_iter().all(light)
                && still.picture().pixels.iter().flatten().all(shown);
            if !whole {
                faults.push(format!(
                    "{number} {}: {counted:?} {request:?}",
                    renderer.name
                ));
            }
        }
    }
    println!("{pictures} pictures, {refused} refused");
    assert!(faults.is_empty(), "{faults:#?}");
    assert!(refused * 20 <= pictures, "{refused} of {pictures} refused");
}
