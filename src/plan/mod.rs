//! What a picture simulates, and how closely: [`Settings`], [`Dial`]s and [`Effect`]s.
//!
//! A request carries typed [`Settings`], those of the systems, and an [`EffectChoice`]. A
//! [`Plan`] makes of both what each system takes, and says of every effect whether it is on,
//! why, and who decided: the scene or the person ([`Plan::new`]), or the engine that has none of
//! it ([`Plan::limited_to`]); reports say it too. Names and texts stand in two tables, [`DIALS`]
//! and [`Effect`], which serve the command line, its help and reports.

mod budget;
mod dial;
mod dials;
mod effect;
mod settings;

pub use budget::Budget;
pub use dial::{Dial, DialError, Invalidates, Measure};
pub use dials::{DIALS, check, dial};
pub use effect::{
    Decider, Effect, EffectBase, EffectChoice, Found, Planned, Subject, UnknownEffect,
};
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
        let effects = choice.plan(subject);
        let mut plan = Self {
            cloth: settings.cloth,
            render: settings.render.clone(),
            showing: settings.showing,
            effects: Vec::new(),
        };
        for planned in &effects {
            plan.simulate(planned.effect, planned.on);
        }
        Ok(Self { effects, ..plan })
    }

    /// Has each system do its part of an effect, or not.
    fn simulate(&mut self, effect: Effect, on: bool) {
        let synthesis = &mut self.cloth.synthesis;
        match effect {
            Effect::Shadows => self.render.shadows = on,
            Effect::Sky => self.render.sky = on,
            Effect::Tap => self.cloth.tap = on,
            // They are a layer of their own, made where they are on.
            Effect::Hairs => {}
            // What these do is what their dials are set to.
            Effect::Multiple | Effect::EdgeFixing | Effect::Randomisation if on => {}
            Effect::Multiple => self.render.max_order = 1,
            Effect::EdgeFixing => synthesis.rank = Rank::Off,
            Effect::Randomisation => synthesis.patch = 0,
        }
    }

    /// The same for an engine that simulates these effects and no other.
    pub fn limited_to(mut self, effects: &[Effect]) -> Self {
        let lacking = |planned: &&mut Planned| planned.on && !effects.contains(&planned.effect);
        let mut off = Vec::new();
        for planned in self.effects.iter_mut().filter(lacking) {
            planned.on = false;
            planned.why = "this renderer has none of it".into();
            planned.by = Decider::Renderer;
            off.push(planned.effect);
        }
        for effect in off {
            self.simulate(effect, false);
        }
        self
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
            ..EffectChoice::default()
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
    fn what_an_engine_lacks_is_no_work_of_it_either() {
        let plan = Plan::new(
            &Settings::default(),
            &EffectChoice::default(),
            Subject::Cloth,
        );
        let plan = plan.unwrap().limited_to(&[Effect::Sky, Effect::Tap]);
        assert!(plan.on(Effect::Sky) && plan.render.sky && plan.cloth.tap);
        assert!(!plan.on(Effect::Shadows) && !plan.render.shadows);
        assert_eq!((plan.render.max_order, plan.cloth.synthesis.patch), (1, 0));
        let by = |effect| {
            plan.effects
                .iter()
                .find(|known| known.effect == effect)
                .map(|p| p.by)
        };
        assert_eq!(by(Effect::Shadows), Some(Decider::Renderer));
        assert_eq!(by(Effect::Sky), Some(Decider::Scene));
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
                // What decides on blocks, and on the voxels that they are copied from.
                let blocks =
                    |cloth: &ClothSettings| (cloth.synthesis.method, cloth.synthesis.patch);
                let assignment = dial.invalidates == Invalidates::Assignment;
                let another = blocks(&turned.cloth) != blocks(&usual.cloth);
                assert_eq!(another, changed && assignment, "{what}");
                let exemplars = dial.invalidates == Invalidates::Exemplars;
                let another = turned.cloth.level != usual.cloth.level;
                assert_eq!(another, changed && exemplars, "{what}");
                let shown = turned.showing != usual.showing;
                assert_eq!(shown, changed && !cloth && !picture, "{what}");
            }
        }
    }
}
