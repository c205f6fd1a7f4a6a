//! What a draft says about single threads: colour number, spacing, thickness; and the yarns
//! and the sett that are made of it.

use std::collections::BTreeMap;

use super::text::same;
use super::warnings::Warnings;
use crate::design::{
    Density, Family, MAX_PITCH_MM, MIN_PITCH_MM, Sett, Srgb, StatedThreads, Yarn, YarnId,
};
use crate::formats::LoadOptions;
use crate::limits;

/// The program default that is no sett, in cm.
const DEFAULT_SPACING_CM: f32 = 0.212;

/// The threads of one direction as the file describes them.
pub(in crate::formats) struct Threads {
    /// Default colour number as written, with its line.
    pub default_colour: Option<(u32, i64)>,
    /// Channels behind the default number, for files whose table lacks it.
    pub default_channels: Option<[f32; 3]>,
    /// Line and colour number, as written, of each thread that has its own.
    pub colours: Vec<Option<(u32, i64)>>,
    pub unit: Option<String>,
    pub unit_mm: Option<f32>,
    pub spacing: Option<f32>,
    pub thickness: Option<f32>,
    /// Thread from 0 and value in the unit, sorted.
    pub spacings: Vec<(u32, f32)>,
    pub thicknesses: Vec<(u32, f32)>,
}

impl Threads {
    /// As many threads as another format lists, with their usual spacing in a unit and
    /// that of single threads (from 0).
    pub fn listed(count: usize, spacing: Option<(&str, f32)>, spacings: Vec<(u32, f32)>) -> Self {
        let (unit, spacing) = spacing.unzip();
        Self {
            default_colour: None,
            default_channels: None,
            colours: vec![None; count],
            unit: unit.map(str::to_owned),
            unit_mm: unit.and_then(unit_mm),
            spacing,
            thickness: None,
            spacings,
            thicknesses: Vec::new(),
        }
    }

    /// What is written back as long as nobody chooses a sett.
    pub fn stated(&self) -> Option<StatedThreads> {
        let says = self.spacing.is_some()
            || self.thickness.is_some()
            || !self.spacings.is_empty()
            || !self.thicknesses.is_empty();
        says.then(|| StatedThreads {
            unit: self.unit.clone().unwrap_or_default(),
            spacing: self.spacing,
            thickness: self.thickness,
            spacings: self.spacings.clone(),
            thicknesses: self.thicknesses.clone(),
        })
    }
}

/// Millimetres of a unit of length by its name.
pub(in crate::formats) fn unit_mm(unit: &str) -> Option<f32> {
    let is = |names: &[&str]| names.iter().any(|name| same(unit, name));
    if is(&["centimeters", "centimetres", "centimeter", "cm"]) {
        Some(10.0)
    } else if is(&["inches", "inch", "in"]) {
        Some(25.4)
    } else if is(&["decipoints", "decipoint"]) {
        Some(25.4 / 720.0)
    } else if is(&["millimeters", "millimetres", "mm"]) {
        Some(1.0)
    } else {
        None
    }
}

/// Whether a spacing in mm is the default of a drawing program rather than a sett.
fn is_program_default(spacing_mm: f32) -> bool {
    (spacing_mm / (10.0 * DEFAULT_SPACING_CM) - 1.0).abs() < 1e-3
}

/// Pitches and drawn widths in mm, as far as the file or the caller says anything.
pub(in crate::formats) struct Spacing {
    ends: Side,
    picks: Side,
    assumed: bool,
}

/// One direction.
struct Side {
    /// Usual pitch in mm; `None` = whatever is usual for the yarn.
    pitch: Option<f32>,
    /// Pitch of single threads relative to the usual one.
    relative: Vec<f32>,
    /// Drawn width of each thread in mm; empty where the file says nothing usable.
    widths: Vec<Option<f32>>,
    threads: usize,
}

impl Spacing {
    pub fn resolve(
        warp: &Threads,
        weft: &Threads,
        options: &LoadOptions,
        warnings: &mut Warnings,
    ) -> Result<Self, String> {
        let millimetres = |threads: &Threads| Some(threads.spacing? * threads.unit_mm?);
        let stated = [millimetres(warp), millimetres(weft)];
        let believed = stated.map(|spacing| {
            spacing.filter(|&mm| limits::can_be_woven(mm) && !is_program_default(mm))
        });
        if let Some((ends, picks)) = options.sett {
            for (per_cm, what) in [(ends, "ends"), (picks, "picks")] {
                if !limits::can_be_woven(10.0 / per_cm) {
                    let range = limits::in_words(&limits::SETT_PER_CM);
                    return Err(format!("expected {range} {what} per cm, found {per_cm}"));
                }
            }
            return Ok(Self {
                ends: Side::new(warp, Some(10.0 / ends), false),
                picks: Side::new(weft, Some(10.0 / picks), false),
                assumed: false,
            });
        }
        for (threads, side, mm) in [(warp, "WARP", stated[0]), (weft, "WEFT", stated[1])] {
            if threads.spacing.is_some() && threads.unit_mm.is_none() {
                warnings.whole(format!(
                    "[{side}] gives a spacing without Units: its size is unknown and what is \
                     usual for the yarn is taken; give a sett"
                ));
            } else if mm.is_some_and(is_program_default) {
                warnings.whole(format!(
                    "[{side}] spacing of 0.212 cm is a drawing program's default, no sett: what \
                     is usual for the yarn is taken; give a sett"
                ));
            } else if mm.is_some_and(|mm| !limits::can_be_woven(mm)) {
                let range = limits::in_words(&limits::PITCH_MM);
                warnings.whole(format!(
                    "[{side}] Spacing is no cloth's ({range} mm): what is usual for the yarn is \
                     taken"
                ));
            }
            if threads.thickness > threads.spacing && threads.spacing.is_some() {
                warnings.whole(format!(
                    "[{side}] Thickness is greater than Spacing: yarns are taken to touch"
                ));
            }
        }
        // One direction stands for both where only one is believed.
        let [ends, picks] = [believed[0].or(believed[1]), believed[1].or(believed[0])];
        Ok(Self {
            ends: Side::new(warp, ends, believed[0].is_some()),
            picks: Side::new(weft, picks, believed[1].is_some()),
            assumed: ends.is_none(),
        })
    }

    /// The sett, with what is usual where nothing was said.
    pub fn sett(&self, usual: Sett) -> Sett {
        Sett {
            ends: self.ends.density(usual.ends),
            picks: self.picks.density(usual.picks),
            assumed: self.assumed,
        }
    }
}

/// The most a stated thickness may cover: beyond, yarns are taken to touch.
const MOST_COVER: f32 = 0.95;

impl Side {
    fn new(threads: &Threads, pitch: Option<f32>, believed: bool) -> Self {
        let count = threads.colours.len();
        let mut relative = Vec::new();
        let usual = threads.spacing.unwrap_or_else(|| {
            let sum: f32 = threads.spacings.iter().map(|&(_, spacing)| spacing).sum();
            sum / threads.spacings.len().max(1) as f32
        });
        if threads
            .spacings
            .iter()
            .any(|&(_, spacing)| spacing != usual)
            && usual > 0.0
        {
            relative = vec![1.0; count];
            for &(thread, spacing) in &threads.spacings {
                relative[thread as usize] = spacing / usual;
            }
        }
        let mut widths = Vec::new();
        if let (true, Some(unit), Some(pitch)) = (believed, threads.unit_mm, pitch) {
            let width = |thickness: f32| Some((thickness * unit).min(MOST_COVER * pitch));
            widths = vec![threads.thickness.and_then(width); count];
            for &(thread, thickness) in &threads.thicknesses {
                widths[thread as usize] = width(thickness);
            }
        }
        Self {
            pitch,
            relative,
            widths,
            threads: count,
        }
    }

    fn density(&self, usual: Density) -> Density {
        let pitch = self.pitch.unwrap_or_else(|| usual.pitch_mm());
        let pitches_mm = (!self.relative.is_empty()).then(|| {
            self.relative
                .iter()
                .map(|ratio| (pitch * ratio).clamp(MIN_PITCH_MM, MAX_PITCH_MM))
                .collect()
        });
        Density {
            per_cm: 10.0 / pitch,
            pitches_mm,
        }
    }

    /// Diameter in mm of a thread's yarn; `None` = the family's usual one.
    fn diameter(&self, thread: usize, family: Family) -> Option<f32> {
        let stated = self.widths.get(thread).copied().flatten();
        let diameter = stated.or_else(|| Some(self.pitch? * family.numbers().cover))?;
        Some(diameter.clamp(MIN_PITCH_MM, MAX_PITCH_MM))
    }
}

/// The yarns in use, and which each end and pick is: one yarn for each colour number,
/// colour and diameter. (One number has two colours where the file has none for it.)
pub(in crate::formats) type Yarns = (Vec<Yarn>, Vec<YarnId>, Vec<YarnId>);

pub(in crate::formats) fn yarns(
    family: Family,
    spacing: &Spacing,
    warp: &[(u32, Srgb)],
    weft: &[(u32, Srgb)],
) -> Result<Yarns, String> {
    let mut known: BTreeMap<(u32, Srgb, Option<u32>), YarnId> = BTreeMap::new();
    let mut yarns: Vec<Yarn> = Vec::new();
    let mut order = |side: &Side, chosen: &[(u32, Srgb)]| -> Result<Vec<YarnId>, String> {
        let mut order = Vec::with_capacity(side.threads);
        for (thread, &(number, colour)) in chosen.iter().enumerate() {
            let diameter_mm = side.diameter(thread, family);
            let key = (number, colour, diameter_mm.map(f32::to_bits));
            let id = match known.get(&key) {
                Some(&id) => id,
                None => {
                    let id = u16::try_from(yarns.len()).map(YarnId).map_err(|_| {
                        format!("expected at most {} different yarns", limits::YARNS)
                    })?;
                    yarns.push(Yarn {
                        diameter_mm,
                        ..Yarn::new(format!("colour {number}"), family, colour)
                    });
                    known.insert(key, id);
                    id
                }
            };
            order.push(id);
        }
        Ok(order)
    };
    let warp = order(&spacing.ends, warp)?;
    let weft = order(&spacing.picks, weft)?;
    Ok((yarns, warp, weft))
}
