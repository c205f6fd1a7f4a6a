//! What a picture simulates, and how closely: [`Settings`], [`Dial`]s and [`Effect`]s.
//!
//! A request carries typed [`Settings`], those of the systems, and an [`EffectChoice`]. A
//! [`Plan`] makes of both what each system takes, and says of every effect whether it is on,
//! why, and who decided. Names and texts stand in two tables, [`DIALS`] and [`Effect`], which
//! serve the command line and reports.

mod dial;
mod dials;
mod effect;
mod settings;

pub use dial::{Dial, DialError, Invalidates};
pub use dials::{DIALS, check, dial};
pub use effect::{Decider, Effect, EffectBase, EffectChoice, Planned, Subject, UnknownEffect};
pub use settings::{Settings, ShowingSettings};

use crate::cloth::ClothSettings;
use crate::render::{Backing, RenderSettings};
use crate::synthesis::Rank;

/// What each system takes for one picture.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// The cloth's settings.
    pub cloth: ClothSettings,
    /// The tracer's settings.
    pub render: RenderSettings,
    /// How the film is shown.
    pub showing: ShowingSettings,
    /// Of each effect that the subject can have, whether it is simulated.
    pub effects: Vec<Planned>,
}

impl Plan {
    /// What `settings` and `choice` come to for a subject.
    ///
    /// # Errors
    /// When a setting lies outside of what its dial takes.
    pub fn new(
        settings: &Settings,
        choice: &EffectChoice,
        subject: Subject,
    ) -> Result<Self, DialError> {
        check(settings)?;
        let (mut cloth, mut render) = (settings.cloth, settings.tracing.clone());
        let effects = choice.plan(subject);
        for &Planned { effect, on, .. } in &effects {
            match effect {
                Effect::Shadows => render.shadows = on,
                Effect::Sky => render.sky = on,
                Effect::Tap => cloth.tap = on,
                // They are a layer of their own, made where they are on.
                Effect::Hairs => {}
                // What these do is what their dials are set to.
                Effect::Multiple if on => {}
                Effect::EdgeFixing if on => {}
                Effect::Randomisation if on => {}
                Effect::Multiple => render.max_order = 1,
                Effect::EdgeFixing => cloth.synthesis.rank = Rank::Off,
                Effect::Randomisation => cloth.synthesis.patch = 0,
            }
        }
        Ok(Self {
            cloth,
            render,
            showing: settings.showing,
            effects,
        })
    }

    /// The same with a seed for every random choice.
    pub fn seeded(mut self, seed: u64) -> Self {
        self.cloth.synthesis.seed = seed;
        self.render.seed = seed;
        self
    }

    /// The same before something else.
    pub fn before(mut self, backing: Backing) -> Self {
        self.render.backing = backing;
        self
    }

    /// Whether an effect is simulated.
    pub fn on(&self, effect: Effect) -> bool {
        (self.effects.iter()).any(|planned| planned.effect == effect && planned.on)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;

    #[test]
    fn what_is_off_is_no_work() {
        let choice = EffectChoice {
            base: EffectBase::None,
            changes: vec![(Effect::Sky, true)],
        };
        let plan = Plan::new(&Settings::default(), &choice, Subject::Cloth).unwrap();
        assert_eq!(plan.effects.iter().filter(|effect| effect.on).count(), 1);
        let render = &plan.render;
        assert!(render.sky && !render.shadows && render.max_order == 1 && !plan.cloth.tap);
        assert_eq!(plan.cloth.synthesis.rank, Rank::Off);
        assert_eq!(plan.cloth.synthesis.patch, 0);
        assert!(plan.on(Effect::Sky) && !plan.on(Effect::Hairs));
    }

    #[test]
    fn by_themselves_systems_are_as_they_are() {
        let choice = EffectChoice::default();
        let plan = Plan::new(&Settings::default(), &choice, Subject::Cloth).unwrap();
        assert_eq!(plan.cloth, ClothSettings::default());
        assert_eq!(plan.render, RenderSettings::default());
    }

    #[test]
    fn each_dial_undoes_what_its_row_says() {
        let plan = |settings: &Settings| {
            Plan::new(settings, &EffectChoice::default(), Subject::Cloth).unwrap()
        };
        let usual = plan(&Settings::default());
        for dial in DIALS {
            for value in dial.ladder {
                let mut settings = Settings::default();
                dial.turn(&mut settings, value).unwrap();
                let turned = plan(&settings);
                let changed = dial.get(&settings) != dial.get(&Settings::default());
                let cloth = dial.invalidates < Invalidates::Picture;
                let picture = dial.invalidates == Invalidates::Picture;
                let what = format!("{}={value}", dial.name);
                assert_eq!(turned.cloth != usual.cloth, changed && cloth, "{what}");
                assert_eq!(turned.render != usual.render, changed && picture, "{what}");
                let shown = turned.showing != usual.showing;
                assert_eq!(shown, changed && !cloth && !picture, "{what}");
            }
        }
    }
}
