//! A design, its files and its checks.

use std::path::Path;

use pickglass::design::{Family, Srgb, WeavePattern, Yarn, YarnId};

/// What the designer makes.
#[derive(Clone)]
pub struct Design {
    pub name: String,
    pub pattern: WeavePattern,
    pub yarns: Vec<Yarn>,
    pub warp: Vec<YarnId>,
    pub weft: Vec<YarnId>,
    pub ends_per_cm: f32,
    pub picks_per_cm: f32,
}

impl Design {
    pub fn pitch_mm(&self) -> [f32; 2] {
        [10.0 / self.ends_per_cm, 10.0 / self.picks_per_cm]
    }
    pub fn middle_mm(&self) -> [f32; 2] {
        let pitch = self.pitch_mm();
        [
            self.pattern.ends() as f32 * pitch[0] / 2.0,
            self.pattern.picks() as f32 * pitch[1] / 2.0,
        ]
    }
    pub fn warp_up(&self, end: i64, pick: i64) -> bool {
        self.pattern.get_wrapped(end, pick)
    }
    pub fn yarn_at(&self, end: i64, pick: i64, warp: bool) -> YarnId {
        let (order, thread) = if warp {
            (&self.warp, end)
        } else {
            (&self.weft, pick)
        };
        order[thread.rem_euclid(order.len() as i64) as usize]
    }
}

#[derive(Debug, thiserror::Error)]
pub enum DesignError {
    #[error("{0}: no such file or preset: see the presets in the window's File menu")]
    Missing(String),
    #[error("{0}: this ending is not a format that can be written: end the name in .ron or .wif")]
    Format(String),
}

pub const PRESETS: &[&str] = &["herringbone", "twill", "plain"];

/// A preset by name.
pub fn preset(name: &str) -> Option<Design> {
    let up: fn(u32, u32) -> bool = match name {
        "herringbone" => |e, p| {
            let column = if e % 16 < 8 { e } else { 31 - e };
            (column + 4 - p % 4) % 4 < 2
        },
        "twill" => |e, p| (e + 4 - p % 4) % 4 < 2,
        "plain" => |e, p| (e + p) % 2 == 0,
        _ => return None,
    };
    let yarn = |name: &str, colour| Yarn {
        name: name.to_owned(),
        colour,
        surface_share: 0.05,
        gloss: None,
        diameter_mm: None,
        tex: None,
        family: Family::Cotton,
    };
    Some(Design {
        name: name.to_owned(),
        pattern: WeavePattern::from_fn(if name == "plain" { 2 } else { 16 }, 4, up),
        yarns: vec![
            yarn("navy", Srgb(38, 52, 96)),
            yarn("cream", Srgb(233, 223, 198)),
        ],
        warp: vec![YarnId(0)],
        weft: vec![YarnId(1)],
        ends_per_cm: 24.0,
        picks_per_cm: 24.0,
    })
}

/// A design and what was remarked on while reading it.
pub fn open(path: &Path) -> Result<(Design, Vec<String>), DesignError> {
    if !path.exists() {
        return Err(DesignError::Missing(path.display().to_string()));
    }
    let mut design = preset("herringbone").ok_or_else(|| DesignError::Missing("".into()))?;
    design.name = path.file_stem().unwrap_or_default().to_string_lossy().into();
    Ok((design, vec!["a stand-in was opened".to_owned()]))
}
