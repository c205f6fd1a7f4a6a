//! What is measured: a curve for each dial, for each effect that is the crude end of none, and
//! for the engines.

use std::fmt;

use super::AccuracyError;
use crate::engine::{self, RENDERERS, Renderer, StillRequest};
use crate::plan::{DIALS, Dial, Effect, Measure, Subject};

/// One way in which a picture can be more or less accurate.
#[derive(Clone, Copy)]
pub enum Axis {
    /// A dial.
    Dial(&'static Dial),
    /// An effect that is simulated or not.
    Effect(Effect),
    /// What draws.
    Renderer,
}

impl fmt::Debug for Axis {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        to.write_str(self.name())
    }
}

/// A picture that is asked for, and what draws it.
#[derive(Debug, Clone)]
pub struct Asked {
    /// The picture.
    pub request: StillRequest,
    /// What draws it.
    pub renderer: &'static Renderer,
}

/// Settings of an effect, crude first.
const SWITCH: &[&str] = &["off", "on"];

/// Whether leaving an effect out is what the crude end of a dial does.
fn is_dialled(effect: Effect) -> bool {
    match effect {
        // order=1, rank=0, patch=0.
        Effect::Multiple | Effect::EdgeFixing | Effect::Randomisation => true,
        Effect::Shadows | Effect::Sky | Effect::Hairs | Effect::Tap => false,
    }
}

impl Axis {
    /// All that there are.
    pub fn all() -> Vec<Self> {
        let dials = DIALS.iter().map(|dial| Self::Dial(dial));
        let effects = Effect::ALL.iter().copied();
        let effects = effects.filter(|effect| !is_dialled(*effect));
        dials
            .chain(effects.map(Self::Effect))
            .chain([Self::Renderer])
            .collect()
    }

    /// The one of this name.
    ///
    /// # Errors
    /// [`AccuracyError::Unknown`], with the names that there are.
    pub fn named(name: &str) -> Result<Self, AccuracyError> {
        let known = Self::all().into_iter().find(|axis| axis.name() == name);
        known.ok_or_else(|| AccuracyError::Unknown(name.to_owned(), Self::names()))
    }

    fn names() -> String {
        let names: Vec<&str> = Self::all().iter().map(Self::name).collect();
        names.join(", ")
    }

    /// Its name.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Dial(dial) => dial.name,
            Self::Effect(effect) => effect.name(),
            Self::Renderer => "renderer",
        }
    }

    /// What it is, within a sentence or as one: without a full stop.
    pub fn about(&self) -> &'static str {
        match self {
            Self::Dial(dial) => dial.about,
            Self::Effect(effect) => effect.about().trim_end_matches('.'),
            Self::Renderer => "what draws the picture",
        }
    }

    /// Its settings from crude to reference.
    pub fn ladder(&self) -> Vec<&'static str> {
        match self {
            Self::Dial(dial) => dial.ladder.to_vec(),
            Self::Effect(_) => SWITCH.to_vec(),
            // The table begins with the best.
            Self::Renderer => RENDERERS.iter().rev().map(|row| row.name).collect(),
        }
    }

    /// The setting that the others are measured against.
    pub fn reference(&self) -> &'static str {
        self.ladder().last().copied().unwrap_or_default()
    }

    /// What decides on it where a picture refines before somebody's eyes; `None` where it is
    /// set there like all others.
    pub fn elsewhere(&self) -> Option<&'static str> {
        match self {
            Self::Dial(dial) => dial.elsewhere,
            Self::Effect(_) => None,
            Self::Renderer => Some("first sight stands until what is traced is better"),
        }
    }

    /// In what its errors are told.
    pub fn measure(&self) -> Measure {
        match self {
            Self::Dial(dial) => dial.measure,
            Self::Effect(_) => Measure::Bias,
            Self::Renderer => Measure::Engine,
        }
    }

    /// What a picture is asked for with.
    pub fn current(&self, asked: &Asked) -> String {
        match self {
            Self::Dial(dial) if dial.name == "spp" => {
                let spp = asked.request.stop.spp;
                spp.map_or_else(|| dial.get(&asked.request.settings), |spp| spp.to_string())
            }
            Self::Dial(dial) => dial.get(&asked.request.settings),
            Self::Effect(effect) => {
                let plan = asked.renderer.plan(&asked.request, Subject::Cloth);
                let on = plan.is_ok_and(|plan| plan.on(*effect));
                SWITCH[usize::from(on)].to_owned()
            }
            Self::Renderer => asked.renderer.name.to_owned(),
        }
    }

    /// The same picture with this set to `value`.
    ///
    /// # Errors
    /// When it does not take this value.
    pub fn set(&self, asked: &Asked, value: &str) -> Result<Asked, AccuracyError> {
        let mut asked = asked.clone();
        let request = &mut asked.request;
        match self {
            Self::Dial(dial) => {
                dial.turn(&mut request.settings, value)?;
                if dial.name == "spp" {
                    request.stop.spp = Some(request.settings.render.spp);
                }
            }
            Self::Effect(effect) => request.effects.switch(*effect, Some(value == SWITCH[1])),
            Self::Renderer => asked.renderer = engine::renderer(value)?,
        }
        Ok(asked)
    }

    /// Whether it changes anything of a picture, as that is asked for otherwise.
    pub fn applies(&self, asked: &Asked) -> bool {
        let Asked { request, renderer } = asked;
        match self {
            Self::Dial(dial) => {
                let plan = renderer.plan(request, Subject::Cloth);
                let on = |effect| plan.as_ref().is_ok_and(|plan| plan.on(effect));
                (renderer.dials)(dial)
                    && dial.effect.is_none_or(on)
                    && (dial.idle)(&request.settings, request.backing).is_none()
            }
            Self::Effect(effect) => renderer.effects.contains(effect),
            Self::Renderer => true,
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;
    use crate::plan::EffectBase;
    use crate::render::Backing;

    fn asked() -> Asked {
        Asked {
            request: StillRequest::default(),
            renderer: engine::reference(),
        }
    }

    #[test]
    fn every_way_has_a_ladder_a_reference_a_unit_and_a_name_of_its_own() {
        let all = Axis::all();
        for axis in &all {
            let name = axis.name();
            let ladder = axis.ladder();
            assert!(ladder.len() >= 2, "{name}");
            assert_eq!(ladder.last().copied(), Some(axis.reference()), "{name}");
            assert!(!axis.measure().unit().is_empty() && !axis.about().is_empty());
            assert!(!axis.about().ends_with('.'), "{name}");
            assert_eq!(all.iter().filter(|other| other.name() == name).count(), 1);
            assert_eq!(Axis::named(name).unwrap().name(), name);
            for value in ladder {
                let set = axis.set(&asked(), value).unwrap();
                assert_eq!(axis.current(&set), value, "{name}");
            }
        }
        for dial in DIALS {
            assert!(
                all.iter().any(|axis| axis.name() == dial.name),
                "{}",
                dial.name
            );
        }
        // What an effect leaves out is a curve's end, or a curve.
        for effect in Effect::ALL {
            let of_dial = DIALS.iter().any(|dial| dial.effect == Some(*effect));
            let own = all.iter().any(|axis| axis.name() == effect.name());
            assert!(own != is_dialled(*effect) && (own || of_dial), "{effect}");
        }
        let unknown = Axis::named("glow").err().unwrap().to_string();
        assert!(
            unknown.contains("glow") && unknown.contains("order"),
            "{unknown}"
        );
    }

    #[test]
    fn what_changes_nothing_is_not_measured() {
        let applies = |name: &str, asked: &Asked| Axis::named(name).unwrap().applies(asked);
        let mut asked = asked();
        assert!(applies("order", &asked) && applies("hairs", &asked));
        assert!(!applies("level-correction", &asked) && !applies("backing-layers", &asked));
        asked.request.settings.cloth.level = 1;
        asked.request.backing = Backing::Itself;
        assert!(applies("level-correction", &asked) && applies("backing-layers", &asked));
        asked.request.effects.base = EffectBase::None;
        assert!(!applies("order", &asked));
        asked.renderer = engine::renderer("sight").unwrap();
        assert!(!applies("hairs", &asked) && applies("renderer", &asked));
    }
}
