//! A design that was opened: where it came from, what was remarked on, and how the
//! program looks at it.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::cli::SettArgs;
use crate::stub::design::{self, Design};

/// The preset that is shown when nothing is asked for.
pub const DEFAULT_PRESET: &str = "herringbone";

/// Where a design came from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Source {
    Preset(String),
    File(PathBuf),
}

/// A design with its source and the remarks made while reading it.
#[derive(Clone)]
pub struct Opened {
    pub source: Source,
    pub design: Arc<Design>,
    pub warnings: Vec<String>,
}

impl Opened {
    /// Opens a design argument: a preset's name, or a file. A file in the way wins over
    /// a preset only when it is spelled with an ending or a folder.
    pub fn argument(argument: &str, sett: &SettArgs) -> anyhow::Result<Self> {
        let opened = match design::preset(argument) {
            Some(design) => Self::preset_of(argument, design),
            None => Self::file(Path::new(argument))?,
        };
        Ok(opened.with_sett(sett))
    }

    /// Opens a preset by name.
    pub fn preset(name: &str) -> anyhow::Result<Self> {
        match design::preset(name) {
            Some(design) => Ok(Self::preset_of(name, design)),
            None => anyhow::bail!(
                "{name}: no preset has this name: choose one of {}",
                design::PRESETS.join(", ")
            ),
        }
    }

    fn preset_of(name: &str, design: Design) -> Self {
        Self {
            source: Source::Preset(name.to_owned()),
            design: Arc::new(design),
            warnings: Vec::new(),
        }
    }

    /// Opens a file.
    pub fn file(path: &Path) -> anyhow::Result<Self> {
        let (design, warnings) = design::open(path)?;
        Ok(Self {
            source: Source::File(path.to_owned()),
            design: Arc::new(design),
            warnings,
        })
    }

    fn with_sett(mut self, args: &SettArgs) -> Self {
        if let Some(sett) = args.sett {
            let design = Arc::make_mut(&mut self.design);
            design.ends_per_cm = sett.ends_per_cm as f32;
            design.picks_per_cm = sett.picks_per_cm as f32;
        }
        self
    }

    /// What the designer calls it.
    pub fn name(&self) -> &str {
        &self.design.name
    }
}
