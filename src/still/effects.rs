//! Effects and dials by name: what a request may leave out or approximate.

use super::request::{EffectBase, EffectChoice};
use crate::cloth::ClothSettings;
use crate::exemplar::COARSEST_LEVEL;
use crate::formats::png::Depth;
use crate::render::RenderSettings;
use crate::synthesis::{Method, Rank};

/// An effect that can be left out.
pub struct Effect {
    /// Its name on the command line.
    pub name: &'static str,
    /// What it is.
    pub about: &'static str,
}

/// The effects, in the order of the report.
pub const EFFECTS: [Effect; 7] = [
    Effect {
        name: "shadows",
        about: "light is blocked on its way to a fibre",
    },
    Effect {
        name: "multiple",
        about: "light is scattered more than once",
    },
    Effect {
        name: "sky",
        about: "light from all round, beside the suns",
    },
    Effect {
        name: "hairs",
        about: "flyaway fibres on both faces",
    },
    Effect {
        name: "edge-fixing",
        about: "seams between blocks are closed",
    },
    Effect {
        name: "randomisation",
        about: "blocks vary, so that the cloth has no period",
    },
    Effect {
        name: "tap",
        about: "voxels are filtered",
    },
];

/// A dial's name and what values it takes, from crude to reference.
pub struct Dial {
    /// Its name for `--set`.
    pub name: &'static str,
    /// Values it takes.
    pub values: &'static str,
}

/// The dials.
pub const DIALS: [Dial; 12] = [
    Dial {
        name: "denoise",
        values: "off or on",
    },
    Dial {
        name: "method",
        values: "naive, greedy or dp",
    },
    Dial {
        name: "rank",
        values: "0 to 1000, or exact",
    },
    Dial {
        name: "patch",
        values: "0 to 64",
    },
    Dial {
        name: "level",
        values: "4 to 0",
    },
    Dial {
        name: "level-correction",
        values: "off or on",
    },
    Dial {
        name: "order",
        values: "1 to 4096",
    },
    Dial {
        name: "roulette-order",
        values: "1 to 4096, or never",
    },
    Dial {
        name: "shadow-roulette",
        values: "1 to 0",
    },
    Dial {
        name: "pass-spp",
        values: "1 to 1024",
    },
    Dial {
        name: "png-bits",
        values: "8 or 16",
    },
    Dial {
        name: "backing-layers",
        values: "1 to 16",
    },
];

/// A dial or effect that cannot be set like this.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum DialError {
    /// No such dial.
    #[error("no dial is called {0:?}; the dials are {names}", names = names(DIALS.iter().map(|d| d.name)))]
    Unknown(String),
    /// A value it does not take.
    #[error("dial {dial} does not take {value:?}; give {values}")]
    Value {
        /// The dial.
        dial: &'static str,
        /// What was given.
        value: String,
        /// What it takes.
        values: &'static str,
    },
    /// No such effect.
    #[error("no effect is called {0:?}; the effects are {names}", names = names(EFFECTS.iter().map(|e| e.name)))]
    Effect(String),
}

fn names<'a>(list: impl Iterator<Item = &'a str>) -> String {
    list.collect::<Vec<_>>().join(", ")
}

/// Turns the dials of a request.
pub(super) fn turn(
    dials: &[(String, String)],
    cloth: &mut ClothSettings,
    render: &mut RenderSettings,
) -> Result<(), DialError> {
    for (name, value) in dials {
        let dial = DIALS
            .iter()
            .find(|dial| dial.name == name)
            .ok_or_else(|| DialError::Unknown(name.clone()))?;
        let wrong = || DialError::Value {
            dial: dial.name,
            value: value.clone(),
            values: dial.values,
        };
        let number = |low: u32, high: u32| {
            let number = value.parse::<u32>().map_err(|_| wrong())?;
            if (low..=high).contains(&number) {
                Ok(number)
            } else {
                Err(wrong())
            }
        };
        match dial.name {
            "method" => {
                cloth.synthesis.method = match value.as_str() {
                    "naive" => Method::Naive,
                    "greedy" => Method::Greedy,
                    "dp" => Method::Dp,
                    _ => return Err(wrong()),
                }
            }
            "rank" => {
                cloth.synthesis.rank = match value.as_str() {
                    "exact" => Rank::Exact,
                    "0" => Rank::Off,
                    _ => Rank::Truncated(number(1, 1000)?),
                }
            }
            "patch" => cloth.synthesis.patch = number(0, 64)?,
            "denoise" => {
                switch(value).ok_or_else(wrong)?;
            }
            "png-bits" => {
                depth(value).ok_or_else(wrong)?;
            }
            "level" => cloth.level = number(0, COARSEST_LEVEL)?,
            "level-correction" => cloth.correct_levels = switch(value).ok_or_else(wrong)?,
            "order" => render.max_order = number(1, 4096)?,
            "roulette-order" if value == "never" => render.roulette_order = u32::MAX,
            "roulette-order" => render.roulette_order = number(1, 4096)?,
            "shadow-roulette" => {
                let share = value.parse::<f32>().map_err(|_| wrong())?;
                if !(0.0..=1.0).contains(&share) {
                    return Err(wrong());
                }
                render.shadow_roulette = share;
            }
            "pass-spp" => render.pass_spp = number(1, 1024)?,
            _ => render.backing_layers = number(1, 16)?,
        }
    }
    Ok(())
}

fn switch(value: &str) -> Option<bool> {
    match value {
        "on" => Some(true),
        "off" => Some(false),
        _ => None,
    }
}

fn depth(value: &str) -> Option<Depth> {
    match value {
        "8" => Some(Depth::Eight),
        "16" => Some(Depth::Sixteen),
        _ => None,
    }
}

/// Whether a request wants its picture denoised for showing; it does unless it says no.
pub(super) fn denoises(dials: &[(String, String)]) -> bool {
    last(dials, "denoise").and_then(switch).unwrap_or(true)
}

/// Bits of a sample of a request's PNG; 8 unless it says otherwise.
pub(super) fn png_depth(dials: &[(String, String)]) -> Depth {
    last(dials, "png-bits")
        .and_then(depth)
        .unwrap_or(Depth::Eight)
}

/// The last value that a dial was turned to.
fn last<'d>(dials: &'d [(String, String)], dial: &str) -> Option<&'d str> {
    let turned = dials.iter().rev().find(|(name, _)| name == dial);
    turned.map(|(_, value)| value.as_str())
}

/// Leaves out the effects that a request leaves out; returns which are on.
pub(super) fn choose(
    choice: &EffectChoice,
    cloth: &mut ClothSettings,
    render: &mut RenderSettings,
) -> Result<Vec<(String, bool)>, DialError> {
    let mut on = EFFECTS.map(|_| choice.base != EffectBase::None);
    for (name, switched) in &choice.changes {
        let index = EFFECTS
            .iter()
            .position(|effect| effect.name == name)
            .ok_or_else(|| DialError::Effect(name.clone()))?;
        on[index] = *switched;
    }
    let [shadows, multiple, sky, _, edge_fixing, randomisation, tap] = on;
    render.shadows &= shadows;
    render.sky &= sky;
    if !multiple {
        render.max_order = 1;
    }
    if !edge_fixing {
        cloth.synthesis.rank = Rank::Off;
    }
    if !randomisation {
        cloth.synthesis.patch = 0;
    }
    cloth.tap &= tap;
    Ok(EFFECTS
        .iter()
        .zip(on)
        .map(|(effect, on)| (effect.name.to_owned(), on))
        .collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn set(name: &str, value: &str) -> Result<(ClothSettings, RenderSettings), DialError> {
        let (mut cloth, mut render) = (ClothSettings::default(), RenderSettings::default());
        turn(
            &[(name.to_owned(), value.to_owned())],
            &mut cloth,
            &mut render,
        )?;
        Ok((cloth, render))
    }

    #[test]
    fn dials_turn_what_they_name() {
        assert_eq!(set("level", "2").unwrap().0.level, 2);
        assert!(!set("level-correction", "off").unwrap().0.correct_levels);
        assert_eq!(set("rank", "exact").unwrap().0.synthesis.rank, Rank::Exact);
        assert_eq!(set("order", "7").unwrap().1.max_order, 7);
        let bits = |value: &str| png_depth(&[("png-bits".to_owned(), value.to_owned())]);
        assert!(bits("16") == Depth::Sixteen && png_depth(&[]) == Depth::Eight);
        assert_eq!(
            set("roulette-order", "never").unwrap().1.roulette_order,
            u32::MAX
        );
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
        assert!(
            set("colour", "1")
                .unwrap_err()
                .to_string()
                .contains("the dials are denoise, method")
        );
    }

    #[test]
    fn effects_are_left_out_by_name() {
        let (mut cloth, mut render) = (ClothSettings::default(), RenderSettings::default());
        let choice = EffectChoice {
            base: EffectBase::None,
            changes: vec![("sky".to_owned(), true)],
        };
        let on = choose(&choice, &mut cloth, &mut render).unwrap();
        assert_eq!(on.iter().filter(|effect| effect.1).count(), 1);
        assert!(render.sky && !render.shadows && render.max_order == 1 && !cloth.tap);
        let unknown = EffectChoice {
            changes: vec![("glow".to_owned(), true)],
            ..choice
        };
        assert!(choose(&unknown, &mut cloth, &mut render).is_err());
    }
}
