//! One dial: its name, what it takes, what turning it undoes.

use std::ops::RangeInclusive;

use serde::{Deserialize, Serialize};

use super::effect::{Effect, Subject};
use super::settings::Settings;
use crate::render::Backing;

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

/// In what the error of a dial's settings is told.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Measure {
    /// Share of the neighbouring crossings whose blocks do not go on in each other.
    Continuity,
    /// Root mean square of the steps in height that are left at seams, in yarn diameters.
    Seams,
    /// By how much yarns that are seen bend where blocks meet, root mean square, degrees.
    Kinks,
    /// Share of the crossings that look as one repeat of the design further on.
    Repetition,
    /// What is wrong with the picture whatever the number of paths: root mean square against
    /// the dial's reference, relative to the picture.
    Bias,
    /// Noise of the traced picture: root mean square, relative to the picture.
    Noise,
    /// All that is wrong with the picture that is shown, noise too: root mean square, relative
    /// to the picture.
    Shown,
    /// As [`Measure::Shown`], of an engine: it stands for all other dials.
    Engine,
    /// What rounding does to the samples of a file: root mean square, of white.
    Rounding,
}

impl Measure {
    /// What is measured, in words for a plot's axis.
    pub fn about(self) -> &'static str {
        match self {
            Self::Continuity => "neighbours that do not go on in each other",
            Self::Seams => "steps at seams",
            Self::Kinks => "kinks of yarns at seams",
            Self::Repetition => "crossings that look as a repeat further on",
            Self::Bias => "wrong however many paths",
            Self::Noise => "noise of the traced picture",
            Self::Shown | Self::Engine => "wrong in the picture that is shown, with its noise",
            Self::Rounding => "lost by rounding",
        }
    }

    /// Its unit.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Continuity => "of neighbours",
            Self::Seams => "yarn diameters",
            Self::Kinks => "degrees",
            Self::Repetition => "of crossings",
            Self::Bias | Self::Noise | Self::Shown | Self::Engine => "relative RMSE",
            Self::Rounding => "of white",
        }
    }
}

/// One dial of one approximation.
pub struct Dial {
    /// Its name for `--set`.
    pub name: &'static str,
    /// What somebody calls it who does not know the command line.
    pub title: &'static str,
    /// What it approximates.
    pub about: &'static str,
    /// Values it takes, in words.
    pub values: &'static str,
    /// Settings from crude to reference.
    pub ladder: &'static [&'static str],
    /// What turning it undoes.
    pub invalidates: Invalidates,
    /// In what the error of its settings is told.
    pub measure: Measure,
    /// The effect that it belongs to: left out, there is nothing to turn.
    pub effect: Option<Effect>,
    /// Whether voxels that were read have it; cloth has all.
    pub of_voxels: bool,
    /// What decides on it where a picture refines before somebody's eyes; `None` where it is
    /// turned there like all others.
    pub elsewhere: Option<&'static str>,
    /// Why it changes nothing of a picture with these settings before this backing, and what
    /// would have to be so; `None` where it does.
    pub idle: fn(&Settings, Backing) -> Option<&'static str>,
    pub(super) get: fn(&Settings) -> String,
    pub(super) set: fn(&mut Settings, &str) -> Option<()>,
}

impl Dial {
    /// What it is set to, as [`Dial::turn`] takes it.
    pub fn get(&self, settings: &Settings) -> String {
        (self.get)(settings)
    }

    /// The setting that the others are measured against: the last of its ladder.
    pub fn reference(&self) -> &'static str {
        self.ladder.last().copied().unwrap_or_default()
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

/// The dial always does something.
pub(super) fn always(_: &Settings, _: Backing) -> Option<&'static str> {
    None
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
