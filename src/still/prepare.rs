//! The cloth of a design made ready for pictures, and kept ready while it is edited.

use std::sync::{Arc, OnceLock};
use std::time::Instant;

use glam::Vec3;

use super::StillError;
use super::part::{roomy, stretch};
use super::request::StillRequest;
use crate::cloth::{ClothError, ClothSettings, ClothVolume, HairLayer, YarnClasses, colour};
use crate::design::{Design, WeavePattern};
use crate::exemplar::hairs::HairPatch;
use crate::exemplar::{ExemplarError, ExemplarSet, ExemplarStore, Pair, VoxelGrid, bytes_at_most};
use crate::job::Job;
use crate::memory;
use crate::plan::Subject;
use crate::synthesis::{Catalogue, Stretch};

/// A cloth that can be looked at: exemplars built, blocks assigned, colours found.
pub struct PreparedCloth {
    pub(super) design: Arc<Design>,
    drawdown: Arc<WeavePattern>,
    cloth: ClothVolume,
    catalogue: Arc<Catalogue>,
    pub(super) seconds: Vec<(String, f64)>,
    settings: ClothSettings,
    /// The part of a very large design that it has; `None` = all of it.
    within: Option<Stretch>,
    /// Hairs, made when first looked at.
    hairs: OnceLock<Option<Arc<HairPatch>>>,
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
    pub fn complete(self, store: &ExemplarStore, job: &Job) -> Result<PreparedCloth, StillError> {
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

impl PreparedCloth {
    /// The hairs over `cloth`, this cloth made ready for a view; `None` where there are none.
    pub(super) fn hair_layer<'c>(&self, cloth: &'c ClothVolume) -> Option<HairLayer<'c>> {
        let patch = self.hairs.get_or_init(|| HairLayer::patch(cloth)).clone()?;
        let hairy = HairLayer::hairy(self.design.yarns());
        Some(HairLayer::of(cloth, patch, hairy))
    }

    /// The cloth.
    pub fn cloth(&self) -> &ClothVolume {
        &self.cloth
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
    pub(super) fn check(&self, asked: &ClothSettings) -> Vec<String> {
        let same = (asked.synthesis, asked.tap) == (self.settings.synthesis, self.settings.tap);
        let other = "the cloth was made with other dials of synthesis than its picture asks for: \
                     prepare it anew";
        let other = (!same).then(|| other.to_owned());
        self.check_level().err().into_iter().chain(other).collect()
    }

    /// The design whose cloth it is.
    pub fn design(&self) -> &Arc<Design> {
        &self.design
    }

    /// Whether a picture finds all it shows in this cloth; else the cloth is to
    /// [`PreparedCloth::follow`] the eye.
    pub fn covers(&self, request: &StillRequest) -> bool {
        self.covers_design(&self.design, request).unwrap_or(false)
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
    /// outcome is what [`prepare`] gives. `None` where
    /// nothing can be taken over: another sett, other families or sizes of yarn, other
    /// dials.
    ///
    /// # Errors
    /// When a dial is wrong, there is no such colourway, or the job is cancelled.
    pub fn follow(
        &self,
        design: &Arc<Design>,
        drawdown: &Arc<WeavePattern>,
        request: &StillRequest,
        job: &Job,
    ) -> Result<Option<Followed>, StillError> {
        let settings = request.plan(Subject::Cloth)?.cloth;
        if settings != self.settings {
            return Ok(None);
        }
        let design = coloured(design, request)?;
        let begun = Instant::now();
        let within = match self.covers_design(&design, request)? {
            true => self.within.clone(),
            false => roomy(&design, request)?,
        };
        let followed =
            (self.cloth).follow(&self.drawdown, &design, drawdown, within.as_ref(), job)?;
        let Some(cloth) = followed else {
            return Ok(None);
        };
        let needed = cloth.unbuilt();
        let hairs = match design.sett() == self.design.sett() {
            true => self.hairs.clone(),
            false => OnceLock::new(),
        };
        let cloth = Self {
            design,
            drawdown: Arc::clone(drawdown),
            cloth,
            catalogue: Arc::clone(&self.catalogue),
            seconds: stages(0.0, begun.elapsed().as_secs_f64()),
            settings,
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

impl PreparedCloth {
    /// Whether the part it has is also what a picture of this design needs.
    fn covers_design(&self, design: &Design, request: &StillRequest) -> Result<bool, StillError> {
        let same = (design.ends(), design.picks()) == (self.design.ends(), self.design.picks());
        Ok(match (&self.within, stretch(design, request)?) {
            (None, None) => true,
            (Some(within), Some(seen)) => same && within.holds(&seen),
            _ => false,
        })
    }
}

/// The design in the colourway that a request names.
///
/// # Errors
/// When it has no such colourway.
pub(super) fn coloured(
    design: &Arc<Design>,
    request: &StillRequest,
) -> Result<Arc<Design>, StillError> {
    match &request.colourway {
        None => Ok(Arc::clone(design)),
        Some(name) => Ok(Arc::new(Design::clone(design).with_colourway(name)?)),
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

/// Builds what every picture of a design needs; `request` gives the dials, the seed and
/// the colourway.
///
/// # Errors
/// When the design cannot be made into cloth, a dial is wrong, or the job is cancelled.
pub fn prepare(
    design: &Arc<Design>,
    request: &StillRequest,
    store: &ExemplarStore,
    job: &Job,
) -> Result<PreparedCloth, StillError> {
    prepare_woven(design, &Arc::new(design.weave()), request, store, job)
}

/// As [`prepare`] for a design whose drawdown is known already.
///
/// # Errors
/// As [`prepare`].
pub fn prepare_woven(
    design: &Arc<Design>,
    drawdown: &Arc<WeavePattern>,
    request: &StillRequest,
    store: &ExemplarStore,
    job: &Job,
) -> Result<PreparedCloth, StillError> {
    let settings = request.plan(Subject::Cloth)?.cloth;
    let design = &coloured(design, request)?;
    let begun = Instant::now();
    let catalogue = Arc::new(Catalogue::standard());
    let (within, lattice) = (roomy(design, request)?, design.lattice());
    let (assignment, needed) = ClothVolume::assign_weave(
        drawdown,
        lattice,
        within.as_ref(),
        &catalogue,
        &settings,
        job,
    )?;
    let assigning = begun.elapsed().as_secs_f64();
    let begun = Instant::now();
    let classes = YarnClasses::new(design);
    let grid = ClothVolume::grid_for(&catalogue, &classes, &settings).map_err(ClothError::from)?;
    let sets = exemplars(&catalogue, &classes.pairs, grid, &needed, store, job)
        .map_err(ClothError::from)?;
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
        settings,
        job,
    )?;
    Ok(PreparedCloth {
        design: Arc::clone(design),
        drawdown: Arc::clone(drawdown),
        cloth,
        catalogue,
        seconds: stages(exemplars, assigning + begun.elapsed().as_secs_f64()),
        settings,
        within,
        hairs: OnceLock::new(),
    })
}
