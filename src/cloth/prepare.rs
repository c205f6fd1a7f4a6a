//! The cloth of a design made ready to be looked at, and kept ready while it is edited.
//!
//! Comes in: a design, its drawdown, [`ClothSettings`] and the crossings that are looked at.
//! Designs of up to [`MOST_AT_ONCE`] crossings are made into cloth whole. Of larger ones the
//! columns that are looked at are, with all that lies so near that light comes from there;
//! what is shown is then, block for block, what the whole design would show.

use std::ops::Range;
use std::sync::{Arc, OnceLock};
use std::time::Instant;

use glam::Vec3;

use super::build::{ClothError, ClothSettings, ClothVolume, YarnClasses};
use super::colour;
use super::hairs::{HairLayer, HairStock};
use crate::design::{Design, WeavePattern};
use crate::exemplar::{ExemplarError, ExemplarSet, ExemplarStore, Pair, VoxelGrid, bytes_at_most};
use crate::job::Job;
use crate::memory;
use crate::synthesis::{Catalogue, MOST_AT_ONCE, Stretch};

/// Threads beyond what is looked at that may throw light or shadow into it.
const BESIDE: i64 = 64;

/// A cloth that can be looked at: exemplars built, blocks assigned, colours found.
pub struct PreparedCloth {
    design: Arc<Design>,
    drawdown: Arc<WeavePattern>,
    cloth: ClothVolume,
    catalogue: Arc<Catalogue>,
    seconds: Vec<(String, f64)>,
    settings: ClothSettings,
    /// The part of a very large design that it has; `None` = all of it.
    within: Option<Stretch>,
    /// Hairs, made when first looked at.
    hairs: OnceLock<Option<Arc<HairStock>>>,
}

/// A cloth that follows an edit.
pub enum Followed {
    /// It can be looked at.
    Ready(PreparedCloth),
    /// It needs exemplars that were not built yet.
    Unfinished(UnfinishedCloth),
}

/// A cloth whose exemplars are not all there: there would be holes in its picture, so
/// none is taken before [`UnfinishedCloth::complete`].
pub struct UnfinishedCloth {
    cloth: PreparedCloth,
    needed: Vec<bool>,
}

impl UnfinishedCloth {
    /// Reads or builds what is missing.
    ///
    /// # Errors
    /// When an exemplar cannot be built or the job is cancelled.
    pub fn complete(self, store: &ExemplarStore, job: &Job) -> Result<PreparedCloth, ClothError> {
        let Self { mut cloth, needed } = self;
        let begun = Instant::now();
        let sets = (cloth.cloth.sets().iter())
            .map(|set| store.complete(&cloth.catalogue, set, &needed, job))
            .collect::<Result<Vec<_>, _>>()?;
        let exemplars = begun.elapsed().as_secs_f64();
        let begun = Instant::now();
        cloth.cloth = cloth.cloth.with_sets(sets, job)?;
        cloth.seconds = stages(exemplars, begun.elapsed().as_secs_f64());
        Ok(cloth)
    }
}

fn stages(exemplars: f64, synthesis: f64) -> Vec<(String, f64)> {
    vec![
        ("exemplars".to_owned(), exemplars),
        ("synthesis".to_owned(), synthesis),
    ]
}

/// The crossings that looking at `extent` needs; `None` = the design is made into cloth
/// whole.
pub fn needed(design: &Design, extent: &Stretch) -> Option<Stretch> {
    let small = u64::from(design.ends()) * u64::from(design.picks()) <= MOST_AT_ONCE;
    (!small).then(|| extent.grown(BESIDE, BESIDE))
}

/// As [`needed`], with room for the eye to move a little.
fn roomy(design: &Design, extent: &Stretch) -> Option<Stretch> {
    let seen = needed(design, extent)?;
    let share = |range: &Range<i64>| range.end.saturating_sub(range.start) / 4;
    let room = seen.grown(share(&seen.ends), share(&seen.picks));
    let fits = room.columns(design.ends(), design.picks(), design.lattice());
    Some(if fits.is_ok() { room } else { seen })
}

/// Refuses to look at more of a very large design than is made into cloth at once, before
/// anything is made.
///
/// # Errors
/// [`SynthesisError::TooWide`](crate::synthesis::SynthesisError::TooWide).
pub fn check_extent(design: &Design, extent: &Stretch) -> Result<(), ClothError> {
    if let Some(seen) = needed(design, extent) {
        seen.columns(design.ends(), design.picks(), design.lattice())?;
    }
    Ok(())
}

impl PreparedCloth {
    /// The hairs over `cloth`, this cloth made ready for a view; `None` where there are none.
    pub fn hair_layer<'c>(&self, cloth: &'c ClothVolume) -> Option<HairLayer<'c>> {
        let made = || HairStock::new(cloth).map(Arc::new);
        let stock = self.hairs.get_or_init(made).clone()?;
        let hairy = HairLayer::hairy(self.design.yarns());
        Some(HairLayer::of(cloth, stock, hairy))
    }

    /// The cloth.
    pub fn cloth(&self) -> &ClothVolume {
        &self.cloth
    }

    /// The design whose cloth it is.
    pub fn design(&self) -> &Arc<Design> {
        &self.design
    }

    /// What it was made with.
    pub fn settings(&self) -> &ClothSettings {
        &self.settings
    }

    /// Seconds that its stages took, in order.
    pub fn seconds(&self) -> &[(String, f64)] {
        &self.seconds
    }

    /// Why its level is not the one that was asked for, where that is so.
    ///
    /// # Errors
    /// One line with the level that it has.
    pub fn check_level(&self) -> Result<(), String> {
        let (asked, level) = (self.settings.level, self.cloth.level());
        if asked == level {
            return Ok(());
        }
        Err(format!(
            "level {asked} of these yarns and this sett is no coarser than level {level}: choose \
             level {level}"
        ))
    }

    /// Remarks on a picture with the settings `asked` for, where the cloth has others.
    pub fn check(&self, asked: &ClothSettings) -> Vec<String> {
        let same = (asked.synthesis, asked.tap) == (self.settings.synthesis, self.settings.tap);
        let other = "the cloth was made with other dials of synthesis than its picture asks for: \
                     prepare it anew";
        let other = (!same).then(|| other.to_owned());
        self.check_level().err().into_iter().chain(other).collect()
    }

    /// Whether it has all that looking at `extent` of `design` needs.
    pub fn covers(&self, design: &Design, extent: &Stretch) -> bool {
        let same = (design.ends(), design.picks()) == (self.design.ends(), self.design.picks());
        match (&self.within, needed(design, extent)) {
            (None, None) => true,
            (Some(within), Some(seen)) => same && within.holds(&seen),
            _ => false,
        }
    }

    /// Puts the cloth into the yarns of `design`, the same design in another colourway,
    /// without making anything anew. False, and nothing changed, where a yarn has another
    /// family or size: then [`prepare`] it.
    pub fn recolour(&mut self, design: &Arc<Design>) -> bool {
        let alike = self.cloth.recolour_as(design);
        if alike {
            self.design = Arc::clone(design);
            self.seconds.clear();
        }
        alike
    }

    /// The cloth of an edited design, whose drawdown is `drawdown`: only what the edit
    /// touches, and of a very large design what the eye moved to, is made anew, and the
    /// outcome is what [`prepare`] gives. `None` where nothing can be taken over: another
    /// sett, other families or sizes of yarn, other settings.
    ///
    /// # Errors
    /// When more is looked at than can be made at once, or the job is cancelled.
    pub fn follow(
        &self,
        design: &Arc<Design>,
        drawdown: &Arc<WeavePattern>,
        settings: &ClothSettings,
        extent: &Stretch,
        job: &Job,
    ) -> Result<Option<Followed>, ClothError> {
        if *settings != self.settings {
            return Ok(None);
        }
        let begun = Instant::now();
        let within = match self.covers(design, extent) {
            true => self.within.clone(),
            false => roomy(design, extent),
        };
        let followed =
            (self.cloth).follow(&self.drawdown, design, drawdown, within.as_ref(), job)?;
        let Some(cloth) = followed else {
            return Ok(None);
        };
        let needed = cloth.unbuilt();
        let hairs = match design.sett() == self.design.sett() {
            true => self.hairs.clone(),
            false => OnceLock::new(),
        };
        let cloth = Self {
            design: Arc::clone(design),
            drawdown: Arc::clone(drawdown),
            cloth,
            catalogue: Arc::clone(&self.catalogue),
            seconds: stages(0.0, begun.elapsed().as_secs_f64()),
            settings: *settings,
            within,
            hairs,
        };
        Ok(Some(if needed.contains(&true) {
            Followed::Unfinished(UnfinishedCloth { cloth, needed })
        } else {
            Followed::Ready(cloth)
        }))
    }
}

/// The exemplar sets of all pairs, each asked for before it is made.
fn exemplars(
    catalogue: &Catalogue,
    pairs: &[Pair],
    grid: VoxelGrid,
    needed: &[bool],
    store: &ExemplarStore,
    job: &Job,
) -> Result<Vec<Arc<ExemplarSet>>, ExemplarError> {
    let (mut sets, mut held) = (Vec::with_capacity(pairs.len()), 0u64);
    for pair in pairs {
        let more = bytes_at_most(catalogue, pair, &grid, needed);
        memory::ask(held.saturating_add(more), || {
            "the exemplars of this cloth (fewer sizes of yarn, or more even setts, take less)"
                .to_owned()
        })?;
        let set = store.get(catalogue, pair, grid, needed, job)?;
        held = held.saturating_add(set.bytes() as u64);
        sets.push(set);
    }
    Ok(sets)
}

/// Makes a design into cloth: all that looking at `extent` needs.
///
/// # Errors
/// When more is looked at than can be made at once, the exemplars cannot be had, or the job
/// is cancelled.
pub fn prepare(
    design: &Arc<Design>,
    settings: &ClothSettings,
    extent: &Stretch,
    store: &ExemplarStore,
    job: &Job,
) -> Result<PreparedCloth, ClothError> {
    let drawdown = Arc::new(design.weave());
    prepare_woven(design, &drawdown, settings, extent, store, job)
}

/// As [`prepare`] for a design whose drawdown is known already.
///
/// # Errors
/// As [`prepare`].
pub fn prepare_woven(
    design: &Arc<Design>,
    drawdown: &Arc<WeavePattern>,
    settings: &ClothSettings,
    extent: &Stretch,
    store: &ExemplarStore,
    job: &Job,
) -> Result<PreparedCloth, ClothError> {
    let begun = Instant::now();
    let catalogue = Arc::new(Catalogue::standard());
    let (within, lattice) = (roomy(design, extent), design.lattice());
    let (assignment, needed) = ClothVolume::assign_weave(
        drawdown,
        lattice,
        within.as_ref(),
        &catalogue,
        settings,
        job,
    )?;
    let assigning = begun.elapsed().as_secs_f64();
    let begun = Instant::now();
    let classes = YarnClasses::new(design);
    let grid = ClothVolume::grid_for(&catalogue, &classes, settings)?;
    let sets = exemplars(&catalogue, &classes.pairs, grid, &needed, store, job)?;
    let exemplars = begun.elapsed().as_secs_f64();
    let begun = Instant::now();
    let albedo: Vec<Vec3> = design.yarns().iter().map(colour::albedo).collect();
    let cloth = ClothVolume::new(
        design,
        Arc::clone(&catalogue),
        classes,
        assignment,
        sets,
        albedo,
        *settings,
        job,
    )?;
    Ok(PreparedCloth {
        design: Arc::clone(design),
        drawdown: Arc::clone(drawdown),
        cloth,
        catalogue,
        seconds: stages(exemplars, assigning + begun.elapsed().as_secs_f64()),
        settings: *settings,
        within,
        hairs: OnceLock::new(),
    })
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;
    use crate::design::{
        Family, Fill, Filled, Srgb, Structure, Yarn, YarnId, YarnMaps, usual_sett,
    };

    fn satin(ends: u32, picks: u32) -> Arc<Design> {
        let fill = Fill::by_notation("1/7 satin move 3").unwrap();
        let structure = Structure::Weave(Filled::new(fill, ends, picks).unwrap());
        let yarns = vec![
            Yarn::new("navy", Family::Cotton, Srgb(20, 30, 90)),
            Yarn::new("cream", Family::Cotton, Srgb(240, 230, 200)),
        ];
        let maps = YarnMaps::plain(YarnId(0), YarnId(1));
        let sett = usual_sett(&yarns, &maps);
        Arc::new(Design::new("satin", structure, yarns, maps, sett).unwrap())
    }

    fn stretch(ends: Range<i64>, picks: Range<i64>) -> Stretch {
        Stretch { ends, picks }
    }

    #[test]
    fn only_very_large_designs_are_made_in_parts() {
        let near = stretch(8000..8040, 10_000..10_030);
        assert_eq!(needed(&satin(5120, 6300), &near), None);
        let large = satin(16_000, 20_000);
        let seen = needed(&large, &near).unwrap();
        assert!(seen.holds(&near) && seen.ends.start > 7900 && seen.ends.end < 8110);
        let room = roomy(&large, &near).unwrap();
        assert!(room.holds(&seen) && !seen.holds(&room));
        assert!(check_extent(&large, &near).is_ok());
        let far = stretch(0..16_000, 0..20_000);
        let refused = check_extent(&large, &far).unwrap_err();
        assert!(matches!(
            refused,
            ClothError::Synthesis(crate::synthesis::SynthesisError::TooWide { .. })
        ));
        assert!(check_extent(&satin(5120, 6300), &far).is_ok());
    }
}
