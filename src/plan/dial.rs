//! One dial: its name, what it takes, what turning it undoes.

use std::ops::RangeInclusive;

use super::effect::{Effect, Subject};
use super::settings::Settings;

/// What has to be made anew when a dial is turned, dearest first; what comes later is made
/// anew as well.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Invalidates {
    /// The voxels that crossings copy.
    Exemplars,
    /// Which block each crossing copies.
    Assignment,
    /// How seams between blocks are closed.
    Seams,
    /// The traced picture.
    Picture,
    /// How the picture is shown and written.
    Showing,
}

/// One dial of one approximation.
pub struct Dial {
    /// Its name for `--set`.
    pub name: &'static str,
    /// What it approximates.
    pub about: &'static str,
    /// Values it takes, in words.
    pub values: &'static str,
    /// Settings from crude to reference.
    pub ladder: &'static [&'static str],
    /// What turning it undoes.
    pub invalidates: Invalidates,
    /// The effect that it belongs to: left out, there is nothing to turn.
    pub effect: Option<Effect>,
    /// Whether voxels that were read have it; cloth has all.
    pub of_voxels: bool,
    pub(super) get: fn(&Settings) -> String,
    pub(super) set: fn(&mut Settings, &str) -> Option<()>,
}

impl Dial {
    /// What it is set to, as [`Dial::turn`] takes it.
    pub fn get(&self, settings: &Settings) -> String {
        (self.get)(settings)
    }

    /// Sets it.
    ///
    /// # Errors
    /// [`DialError::Value`], with what it takes; nothing is changed then.
    pub fn turn(&self, settings: &mut Settings, value: &str) -> Result<(), DialError> {
        (self.set)(settings, value).ok_or_else(|| DialError::Value {
            dial: self.name,
            value: value.to_owned(),
            values: self.values,
        })
    }

    /// Whether what is looked at has it.
    pub fn applies_to(&self, subject: Subject) -> bool {
        subject == Subject::Cloth || self.of_voxels
    }
}

/// A dial that cannot be set like this.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum DialError {
    /// No such dial.
    #[error("no dial is called {name:?}; the dials are {names}")]
    Unknown {
        /// What was given.
        name: String,
        /// All dials.
        names: String,
    },
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
}

/// A whole number of a range.
pub(super) fn number(text: &str, range: RangeInclusive<u32>) -> Option<u32> {
    text.parse().ok().filter(|number| range.contains(number))
}

/// `on` or `off`.
pub(super) fn switch(text: &str) -> Option<bool> {
    match text {
        "on" => Some(true),
        "off" => Some(false),
        _ => None,
    }
}

/// What [`switch`] reads.
pub(super) fn switched(on: bool) -> String {
    if on { "on" } else { "off" }.to_owned()
}
