//! Effects: what a picture may leave out, and who decided that it does.

use std::borrow::Cow;

use strum::{Display, EnumMessage, EnumString, IntoStaticStr, VariantArray};

/// What is looked at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Subject {
    /// The cloth of a design.
    Cloth,
    /// Voxels that were read.
    Voxels,
}

/// An effect that can be left out.
#[derive(
    Debug,
    Clone,
    Copy,
    PartialEq,
    Eq,
    Hash,
    VariantArray,
    IntoStaticStr,
    EnumString,
    EnumMessage,
    Display,
)]
#[strum(
    serialize_all = "kebab-case",
    parse_err_ty = UnknownEffect,
    parse_err_fn = unknown
)]
pub enum Effect {
    /// Light is blocked on its way to a fibre.
    Shadows,
    /// Light is scattered more than once.
    Multiple,
    /// Light from all round, beside the suns.
    Sky,
    /// Flyaway fibres on both faces.
    Hairs,
    /// Seams between blocks are closed.
    EdgeFixing,
    /// Blocks vary, so that the cloth has no period.
    Randomisation,
    /// Voxels are filtered.
    Tap,
}

/// No effect has this name.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("no effect is called {0:?}; the effects are {names}", names = names())]
pub struct UnknownEffect(pub String);

fn unknown(name: &str) -> UnknownEffect {
    UnknownEffect(name.to_owned())
}

fn names() -> String {
    let names: Vec<&str> = Effect::ALL.iter().map(|effect| effect.name()).collect();
    names.join(", ")
}

impl Effect {
    /// All of them, in the order of reports.
    pub const ALL: &'static [Self] = Self::VARIANTS;

    /// Its name on the command line and in reports.
    pub fn name(self) -> &'static str {
        self.into()
    }

    /// What it is.
    pub fn about(self) -> &'static str {
        self.get_documentation().unwrap_or_default()
    }

    /// Whether what is looked at can have it.
    pub fn applies_to(self, subject: Subject) -> bool {
        let woven = matches!(self, Self::Hairs | Self::EdgeFixing | Self::Randomisation);
        subject == Subject::Cloth || !woven
    }

    /// Whether a scene calls for it where nobody says anything, and why.
    fn called_for(self, subject: Subject) -> (bool, &'static str) {
        match (self, subject) {
            (Self::Tap, Subject::Voxels) => (false, "a point is the voxel that holds it"),
            _ => (true, "the picture is the reference"),
        }
    }
}

/// Which effects to start from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, EnumString, Display)]
#[strum(serialize_all = "kebab-case")]
pub enum EffectBase {
    /// What the scene calls for.
    #[default]
    Auto,
    /// All of them.
    All,
    /// None of them.
    None,
}

/// Which effects are simulated.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct EffectChoice {
    /// Where to start.
    pub base: EffectBase,
    /// Effects switched on or off; the last word on each counts.
    pub changes: Vec<(Effect, bool)>,
    /// What was found out about the scene, which [`EffectBase::Auto`] follows.
    pub found: Vec<Found>,
}

/// What was found out about one effect of a scene (see [`crate::needs`]).
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Found {
    /// The effect.
    pub effect: Effect,
    /// Whether the scene calls for it.
    pub on: bool,
    /// Why, in a designer's words.
    pub why: String,
}

/// Who decided whether an effect is simulated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Display)]
#[strum(serialize_all = "kebab-case")]
pub enum Decider {
    /// The program, from the scene.
    Scene,
    /// Whoever asked for the picture.
    Person,
    /// The engine that draws, which has none of it.
    Renderer,
}

/// Whether one effect is simulated.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Planned {
    /// The effect.
    pub effect: Effect,
    /// Whether it is.
    pub on: bool,
    /// Why.
    pub why: Cow<'static, str>,
    /// Who decided.
    pub by: Decider,
}

impl EffectChoice {
    /// Switches an effect on or off by name; `None` = back to where the choice starts from.
    pub fn switch(&mut self, effect: Effect, on: Option<bool>) {
        self.changes.retain(|(named, _)| *named != effect);
        self.changes.extend(on.map(|on| (effect, on)));
    }

    /// Whether an effect is switched on or off by name.
    pub fn named(&self, effect: Effect) -> Option<bool> {
        let last = (self.changes.iter().rev()).find(|(named, _)| *named == effect);
        last.map(|(_, on)| *on)
    }

    /// What the choice comes to, of each effect that the subject can have.
    pub(super) fn plan(&self, subject: Subject) -> Vec<Planned> {
        let effects = Effect::ALL.iter().copied();
        (effects.filter(|effect| effect.applies_to(subject)))
            .map(|effect| self.planned(effect, subject))
            .collect()
    }

    fn planned(&self, effect: Effect, subject: Subject) -> Planned {
        let found = self.found.iter().find(|found| found.effect == effect);
        let (on, why, by) = match (self.named(effect), self.base, found) {
            (Some(true), ..) => (true, "asked for by name".into(), Decider::Person),
            (Some(false), ..) => (false, "left out by name".into(), Decider::Person),
            (None, EffectBase::All, _) => (true, "all were asked for".into(), Decider::Person),
            (None, EffectBase::None, _) => (false, "none was asked for".into(), Decider::Person),
            (None, EffectBase::Auto, Some(found)) => {
                (found.on, found.why.clone().into(), Decider::Scene)
            }
            (None, EffectBase::Auto, None) => {
                let (on, why) = effect.called_for(subject);
                (on, why.into(), Decider::Scene)
            }
        };
        Planned {
            effect,
            on,
            why,
            by,
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;

    #[test]
    fn names_go_there_and_back() {
        for effect in Effect::ALL {
            assert_eq!(effect.name().parse(), Ok(*effect));
            assert!(effect.about().ends_with('.'), "{effect}");
        }
        assert_eq!(Effect::EdgeFixing.name(), "edge-fixing");
        let unknown = "glow".parse::<Effect>().unwrap_err().to_string();
        assert!(
            unknown.contains("glow") && unknown.contains("shadows, multiple"),
            "{unknown}"
        );
    }

    #[test]
    fn the_last_word_counts_and_says_whose_it_was() {
        let choice = EffectChoice {
            base: EffectBase::None,
            changes: vec![(Effect::Sky, false), (Effect::Sky, true)],
            found: vec![found(Effect::Sky, false), found(Effect::Hairs, true)],
        };
        let plan = choice.plan(Subject::Cloth);
        let on: Vec<Effect> = (plan.iter().filter(|planned| planned.on))
            .map(|planned| planned.effect)
            .collect();
        assert_eq!(on, [Effect::Sky]);
        assert!(plan.iter().all(|planned| planned.by == Decider::Person));
    }

    #[test]
    fn a_switch_is_said_once_and_taken_back() {
        let mut choice = EffectChoice {
            changes: vec![(Effect::Sky, true), (Effect::Sky, false)],
            ..EffectChoice::default()
        };
        choice.switch(Effect::Hairs, Some(false));
        choice.switch(Effect::Sky, Some(true));
        choice.switch(Effect::Sky, Some(false));
        assert_eq!(
            choice.changes,
            [(Effect::Hairs, false), (Effect::Sky, false)]
        );
        assert_eq!(choice.named(Effect::Sky), Some(false));
        choice.switch(Effect::Sky, None);
        assert_eq!(choice.changes, [(Effect::Hairs, false)]);
        assert_eq!(choice.named(Effect::Sky), None);
    }

    fn found(effect: Effect, on: bool) -> Found {
        Found {
            effect,
            on,
            why: "it was looked at".to_owned(),
        }
    }

    #[test]
    fn what_was_found_is_followed_where_nobody_says_anything() {
        let choice = EffectChoice {
            base: EffectBase::Auto,
            changes: vec![(Effect::Hairs, true)],
            found: vec![found(Effect::Sky, false), found(Effect::Hairs, false)],
        };
        let plan = choice.plan(Subject::Cloth);
        let of = |effect| {
            plan.iter()
                .find(|planned| planned.effect == effect)
                .unwrap()
        };
        let sky = of(Effect::Sky);
        assert!(!sky.on && sky.by == Decider::Scene && sky.why == "it was looked at");
        assert!(of(Effect::Hairs).on && of(Effect::Hairs).by == Decider::Person);
        assert!(of(Effect::Shadows).on);
    }

    #[test]
    fn voxels_have_nothing_of_weaving_and_are_shown_as_they_are() {
        let plan = EffectChoice::default().plan(Subject::Voxels);
        let of = |effect| plan.iter().find(|planned| planned.effect == effect);
        assert_eq!(of(Effect::Hairs), None);
        let tap = of(Effect::Tap).unwrap();
        assert!(!tap.on && tap.by == Decider::Scene);
        assert!(of(Effect::Shadows).unwrap().on);
        let all = EffectChoice {
            base: EffectBase::All,
            ..EffectChoice::default()
        };
        assert!(all.plan(Subject::Voxels).iter().all(|planned| planned.on));
    }
}
