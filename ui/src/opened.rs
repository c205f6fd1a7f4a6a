//! A design that was opened: where it came from, what was remarked on, and how the
//! program looks at it.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use pickglass::design::{Design, Positions, Sett, Srgb, WeavePattern, YarnId};

use crate::cli::SettArgs;
use crate::stub::design::{self, Imported, LoadOptions};

/// The preset that is shown when nothing is asked for.
pub const DEFAULT_PRESET: &str = "herringbone";

/// A design with the remarks made while reading it, and its drawdown worked out once.
#[derive(Clone)]
pub struct Opened {
    pub design: Arc<Design>,
    pub warnings: Vec<String>,
    weave: Arc<WeavePattern>,
    ends: Arc<Positions>,
    picks: Arc<Positions>,
}

impl Opened {
    /// Opens a design argument. A preset's name wins; `./twill` is a file all the same.
    pub fn argument(argument: &str, sett: &SettArgs) -> anyhow::Result<Self> {
        let sett = sett
            .sett
            .map(|sett| (sett.ends_per_cm as f32, sett.picks_per_cm as f32));
        match design::preset(argument) {
            Some(mut design) => {
                if let Some((ends, picks)) = sett {
                    design = design.with_sett(Sett::per_cm(ends, picks))?;
                }
                Ok(Self::new(design, Vec::new()))
            }
            None => Self::load(Path::new(argument), &LoadOptions { sett }),
        }
    }

    /// Opens a preset by name.
    pub fn preset(name: &str) -> anyhow::Result<Self> {
        match design::preset(name) {
            Some(design) => Ok(Self::new(design, Vec::new())),
            None => anyhow::bail!(
                "{name}: no preset has this name: choose one of {}",
                design::PRESETS.join(", ")
            ),
        }
    }

    /// Opens a file.
    pub fn file(path: PathBuf) -> anyhow::Result<Self> {
        Self::load(&path, &LoadOptions::default())
    }

    fn load(path: &Path, options: &LoadOptions) -> anyhow::Result<Self> {
        let Imported { design, warnings } = design::load(path, options)?;
        Ok(Self::new(design, warnings))
    }

    fn new(mut design: Design, warnings: Vec<String>) -> Self {
        if design.name.trim().is_empty() {
            design.name = "untitled".to_owned();
        }
        Self {
            weave: Arc::new(design.weave()),
            ends: Arc::new(design.end_positions()),
            picks: Arc::new(design.pick_positions()),
            design: Arc::new(design),
            warnings,
        }
    }

    /// What the designer calls it.
    pub fn name(&self) -> &str {
        &self.design.name
    }

    /// The drawdown of one repeat.
    pub fn weave(&self) -> &WeavePattern {
        &self.weave
    }

    /// The yarn on top at a crossing of the design.
    pub fn yarn_on_top(&self, end: u32, pick: u32) -> YarnId {
        let maps = self.design.maps();
        if self.weave.get(end, pick) {
            maps.warp(i64::from(end), i64::from(pick))
        } else {
            maps.weft(i64::from(end), i64::from(pick))
        }
    }

    /// The colour on top at a crossing of the design.
    pub fn colour_on_top(&self, end: u32, pick: u32) -> Srgb {
        self.design.yarn(self.yarn_on_top(end, pick)).colour
    }

    /// The crossing at a point of the cloth (mm) in words; `None` where there is no cloth.
    pub fn describe_crossing(&self, [x, y]: [f32; 2]) -> Option<String> {
        let (end, pick) = (
            self.ends.locate(f64::from(x)).0,
            self.picks.locate(f64::from(y)).0,
        );
        let (ends, picks) = (self.design.ends(), self.design.picks());
        let (home_end, home_pick) = self.design.lattice().wrap(end, pick, ends, picks)?;
        let maps = self.design.maps();
        let name = |yarn| self.design.yarn(yarn).name.as_str();
        let (warp, weft) = (name(maps.warp(end, pick)), name(maps.weft(end, pick)));
        let (above, below) = if self.weave.get(home_end, home_pick) {
            (warp, weft)
        } else {
            (weft, warp)
        };
        Some(format!(
            "end {home_end} · pick {home_pick} · {above} over {below}"
        ))
    }

    /// Size of one repeat of the weave, mm.
    pub fn size_mm(&self) -> [f32; 2] {
        [
            self.ends.start(i64::from(self.design.ends())) as f32,
            self.picks.start(i64::from(self.design.picks())) as f32,
        ]
    }
}
