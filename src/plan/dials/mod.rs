//! The dials: every approximation that can be set, by name. The rows of a system stand in one
//! file beside this one.

mod cloth;
mod showing;
mod synthesis;
mod tracing;

use super::dial::{Dial, DialError};
use super::settings::Settings;

/// All dials, in the order of their systems.
pub static DIALS: &[&Dial] = &[
    &synthesis::METHOD,
    &synthesis::RANK,
    &synthesis::SEAMS,
    &synthesis::PATCH,
    &cloth::LEVEL,
    &cloth::LEVEL_CORRECTION,
    &tracing::ORDER,
    &tracing::ROULETTE_ORDER,
    &tracing::SHADOW_ROULETTE,
    &tracing::SPP,
    &tracing::PASS_SPP,
    &tracing::BACKING_LAYERS,
    &showing::DENOISE,
    &showing::PNG_BITS,
];

/// The dial of this name.
///
/// # Errors
/// [`DialError::Unknown`], with the names that there are.
pub fn dial(name: &str) -> Result<&'static Dial, DialError> {
    let known = DIALS.iter().find(|dial| dial.name == name).copied();
    known.ok_or_else(|| DialError::Unknown {
        name: name.to_owned(),
        names: DIALS
            .iter()
            .map(|dial| dial.name)
            .collect::<Vec<_>>()
            .join(", "),
    })
}

/// Refuses what a dial does not take.
///
/// # Errors
/// [`DialError::Value`] of the first such dial.
pub fn check(settings: &Settings) -> Result<(), DialError> {
    let mut same = settings.clone();
    DIALS
        .iter()
        .try_for_each(|dial| dial.turn(&mut same, &dial.get(settings)))
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;
    use crate::formats::png::Depth;
    use crate::synthesis::Rank;

    fn set(name: &str, value: &str) -> Result<Settings, DialError> {
        let mut settings = Settings::default();
        dial(name)?.turn(&mut settings, value)?;
        Ok(settings)
    }

    #[test]
    fn dials_turn_what_they_name() {
        assert_eq!(set("level", "2").unwrap().cloth.level, 2);
        assert!(!set("level-correction", "off").unwrap().cloth.correct_levels);
        assert_eq!(
            set("rank", "exact").unwrap().cloth.synthesis.rank,
            Rank::Exact
        );
        assert_eq!(set("order", "7").unwrap().render.max_order, 7);
        assert!(set("png-bits", "16").unwrap().showing.png_depth == Depth::Sixteen);
        let never = set("roulette-order", "never").unwrap();
        assert_eq!(never.render.roulette_order, u32::MAX);
        assert_eq!(set("backing-layers", "3").unwrap().render.backing_layers, 3);
    }

    #[test]
    fn a_dial_turns_itself_alone_and_says_what_it_was_turned_to() {
        for turned in DIALS {
            for value in turned.ladder {
                let mut settings = Settings::default();
                turned.turn(&mut settings, value).unwrap();
                assert_eq!(turned.get(&settings), *value, "{}", turned.name);
                check(&settings).unwrap();
                for other in DIALS.iter().filter(|other| other.name != turned.name) {
                    let usual = other.get(&Settings::default());
                    assert_eq!(other.get(&settings), usual, "{}", turned.name);
                }
            }
            let usual = turned.get(&Settings::default());
            let moved = turned.ladder.iter().any(|value| *value != usual);
            assert!(moved, "{} goes nowhere", turned.name);
        }
    }

    #[test]
    fn wrong_values_say_what_is_right() {
        for (name, value) in [
            ("level", "9"),
            ("rank", "-1"),
            ("order", "0"),
            ("method", "best"),
            ("png-bits", "12"),
        ] {
            let message = set(name, value).unwrap_err().to_string();
            assert!(
                message.contains(name) && message.contains("give"),
                "{message}"
            );
        }
        assert!(set("shadow-roulette", "NaN").is_err());
        let unknown = set("colour", "1").unwrap_err().to_string();
        assert!(unknown.contains("the dials are method, rank"), "{unknown}");
    }

    #[test]
    fn settings_that_no_dial_gives_are_refused() {
        let mut settings = Settings::default();
        settings.cloth.level = 99;
        assert!(check(&settings).unwrap_err().to_string().contains("level"));
        let mut settings = Settings::default();
        settings.render.shadow_roulette = f32::NAN;
        assert!(check(&settings).is_err());
    }
}
