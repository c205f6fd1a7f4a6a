//! From a design to its cloth.

use std::sync::Arc;

use glam::{Vec2, Vec3};

use super::levels::{Gain, LevelCorrection, Matter, series};
use super::window::Window;
use crate::design::{
    Design, Family, Lattice, Positions, WeavePattern, Yarn, YarnId, YarnMap, YarnMaps,
};
use crate::exemplar::{
    Allowance, BlockMajorants, ExemplarError, ExemplarSet, Pair, VoxelGrid, common_grid, quantise,
};
use crate::job::Job;
use crate::synthesis::{
    Assignment, Catalogue, EdgeFix, NeighbourBits, Placement, Randomisation, Stretch,
    SynthesisError, SynthesisSettings, assign, assign_part,
};
use crate::yarn::YarnRecipe;

/// Every approximation of the cloth volume.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClothSettings {
    /// The synthesis's own.
    pub synthesis: SynthesisSettings,
    /// Voxel level: 0 is the reference, each further level halves the resolution.
    pub level: u32,
    /// Stochastic one-tap filter. Off (crude): nearest voxel.
    pub tap: bool,
    /// Shear fibre directions by the slope of the edge fixing. Off (crude): keep them.
    pub shear: bool,
    /// Correct levels above 0 for what averaging does to light. Off (crude): take them as
    /// they are.
    pub correct_levels: bool,
}

impl Default for ClothSettings {
    fn default() -> Self {
        Self {
            synthesis: SynthesisSettings::default(),
            level: 0,
            tap: true,
            shear: true,
            correct_levels: true,
        }
    }
}

/// Why a cloth could not be made.
#[derive(Debug, thiserror::Error)]
pub enum ClothError {
    /// The exemplars could not be had.
    #[error(transparent)]
    Exemplar(#[from] ExemplarError),
    /// The synthesis failed.
    #[error(transparent)]
    Synthesis(#[from] SynthesisError),
}

impl From<crate::job::Cancelled> for ClothError {
    fn from(cancelled: crate::job::Cancelled) -> Self {
        Self::Synthesis(cancelled.into())
    }
}

/// Which yarns of a design are built alike: one recipe a class.
#[derive(Debug, Clone, PartialEq)]
pub struct YarnClasses {
    /// Class of each yarn as a warp; yarns never used as one have class 0.
    warp: Vec<u16>,
    /// Class of each yarn as a weft.
    weft: Vec<u16>,
    /// Number of weft classes.
    wefts: u16,
    /// The pairs of recipes, warp-major.
    pub pairs: Vec<Pair>,
    /// Spacing of ends and picks that the exemplars are for, mm.
    pub pitch: Vec2,
}

impl YarnClasses {
    /// Sorts the yarns of a design by family and the size that they lie in, each within 5 %.
    pub fn new(design: &Design) -> Self {
        let lying = design.lying_yarns();
        let classes = |used: Vec<YarnId>| {
            let mut recipes: Vec<YarnRecipe> = Vec::new();
            let mut class = vec![0u16; lying.len()];
            for id in used {
                let recipe = recipe_of(&lying[usize::from(id.0)]);
                let known = recipes.iter().position(|r| *r == recipe);
                let index = known.unwrap_or_else(|| {
                    recipes.push(recipe);
                    recipes.len() - 1
                });
                class[usize::from(id.0)] = index as u16;
            }
            (class, recipes)
        };
        let (warp, warp_recipes) = classes(used(&design.maps().warp, design));
        let (weft, weft_recipes) = classes(used(&design.maps().weft, design));
        let mut pairs = Vec::new();
        for warp in &warp_recipes {
            for weft in &weft_recipes {
                pairs.push(Pair {
                    warp: warp.clone(),
                    weft: weft.clone(),
                });
            }
        }
        let pitch = Vec2::new(
            quantise(design.sett().ends.mean_pitch_mm()),
            quantise(design.sett().picks.mean_pitch_mm()),
        );
        Self {
            warp,
            weft,
            wefts: weft_recipes.len() as u16,
            pairs,
            pitch,
        }
    }

    /// The exemplar set of a crossing of these yarns.
    #[inline]
    pub fn set(&self, warp: YarnId, weft: YarnId) -> u16 {
        self.warp[usize::from(warp.0)] * self.wefts + self.weft[usize::from(weft.0)]
    }
}

fn recipe_of(yarn: &Yarn) -> YarnRecipe {
    YarnRecipe::family(yarn.family, quantise(yarn.diameter()))
}

/// How the voxels of all sets are read.
struct Corrected {
    /// Of each set's warp and weft.
    matter: Arc<[[Matter; 2]]>,
    /// The gains of their light: each pair once, by the number that the voxels name.
    gains: Vec<[Gain; 2]>,
    /// The largest residual of all corrections; `None` where a set has none.
    light_error: Option<f32>,
}

fn corrected(
    sets: &[Arc<ExemplarSet>],
    of: impl Fn(Family, &ExemplarSet) -> Option<LevelCorrection>,
) -> Corrected {
    let mut gains: Vec<[Gain; 2]> = Vec::new();
    let mut light_error = Some(0.0f32);
    let matter = (sets.iter())
        .map(|set| {
            let recipes = [&set.pair.warp, &set.pair.weft];
            let found = recipes.map(|recipe| of(recipe.family, set));
            for own in &found {
                let residual = own.as_ref().and_then(|own| own.residual);
                light_error = light_error.zip(residual).map(|(worst, own)| worst.max(own));
            }
            let pair = [0, 1].map(|yarn| {
                let own = found[yarn].as_ref().map(|found| found.gains[yarn].clone());
                own.unwrap_or(Gain::NONE)
            });
            let number = if pair == [Gain::NONE; 2] {
                series::UNCORRECTED
            } else {
                let known = gains.iter().position(|known| *known == pair);
                known.unwrap_or_else(|| {
                    gains.push(pair);
                    gains.len() - 1
                })
            };
            [0, 1].map(|yarn| {
                let corrected = series::corrected(number, yarn);
                let full = recipes[yarn].full_extinction();
                Matter::new(full, found[yarn].as_ref(), corrected)
            })
        })
        .collect();
    gains.truncate(series::UNCORRECTED);
    Corrected {
        matter,
        gains,
        light_error,
    }
}

/// SGGX roughness of a yarn's fibres.
pub(super) fn roughness(yarn: &Yarn) -> f32 {
    yarn.alpha().clamp(0.01, 1.0)
}

/// The yarns that a map uses, in order of first use.
fn used(map: &YarnMap, design: &Design) -> Vec<YarnId> {
    let mut seen = vec![false; design.yarns().len()];
    let mut list = Vec::new();
    let mut see = |id: YarnId| {
        if !std::mem::replace(&mut seen[usize::from(id.0)], true) {
            list.push(id);
        }
    };
    match map {
        YarnMap::Order(order) => order.iter().copied().for_each(&mut see),
        YarnMap::Crossings(grid) => grid.iter().for_each(&mut see),
    }
    list
}

/// The cloth of a design as an implicit volume.
#[derive(Clone)]
pub struct ClothVolume {
    pub(super) catalogue: Arc<Catalogue>,
    pub(super) sets: Vec<Arc<ExemplarSet>>,
    pub(super) classes: YarnClasses,
    pub(super) edge_fix: Arc<EdgeFix>,
    pub(super) majorants: Arc<BlockMajorants>,
    pub(super) assignment: Assignment,
    pub(super) randomisation: Randomisation,
    pub(super) lattice: Lattice,
    pub(super) maps: YarnMaps,
    pub(super) ends: Positions,
    pub(super) picks: Positions,
    pub(super) grid: VoxelGrid,
    /// How voxels are read, by set: warp, weft.
    pub(super) matter: Arc<[[Matter; 2]]>,
    /// How each block's lower and upper yarn stand, see [`series::places`]; empty where
    /// levels are not corrected.
    pub(super) places: Vec<[u32; 2]>,
    /// What corrects the light of warp and weft, by the number that voxels name.
    pub(super) gains: Vec<[Gain; 2]>,
    light_error: Option<f32>,
    /// SGGX roughness by yarn.
    pub(super) alpha: Vec<f32>,
    /// Single-scattering albedo by yarn.
    pub(super) albedo: Vec<Vec3>,
    pub(super) settings: ClothSettings,
    pub(super) window: Arc<Window>,
}

impl ClothVolume {
    /// The grid that the exemplars of a design share.
    ///
    /// # Errors
    /// When a yarn or the sett is not usable.
    pub fn grid_for(
        catalogue: &Catalogue,
        classes: &YarnClasses,
        settings: &ClothSettings,
    ) -> Result<VoxelGrid, ExemplarError> {
        common_grid(catalogue, &classes.pairs, classes.pitch, settings.level)
    }

    /// Assigns a block to every crossing of a design, and says which exemplars that needs.
    ///
    /// # Errors
    /// When the design's repeat is not usable or the job is cancelled.
    pub fn assign(
        design: &Design,
        catalogue: &Catalogue,
        settings: &ClothSettings,
        job: &Job,
    ) -> Result<(Assignment, Vec<bool>), ClothError> {
        let weave = design.weave();
        Self::assign_weave(&weave, design.lattice(), None, catalogue, settings, job)
    }

    /// As [`ClothVolume::assign`] for a drawdown that is known already; with `within`, only
    /// the columns that lie there.
    ///
    /// # Errors
    /// When the lattice is not usable, there are too many crossings, or the job is
    /// cancelled.
    pub fn assign_weave(
        weave: &WeavePattern,
        lattice: Lattice,
        within: Option<&Stretch>,
        catalogue: &Catalogue,
        settings: &ClothSettings,
        job: &Job,
    ) -> Result<(Assignment, Vec<bool>), ClothError> {
        let SynthesisSettings { method, seed, .. } = settings.synthesis;
        let assignment = match within {
            Some(stretch) => assign_part(weave, lattice, catalogue, (method, seed), stretch, job)?,
            None => assign(weave, lattice, catalogue, method, seed, job)?,
        };
        let mut blocks = vec![false; catalogue.blocks()];
        for end in 0..assignment.ends() {
            for &block in assignment.column(end) {
                blocks[usize::from(block)] = true;
            }
        }
        let mut needed = vec![false; catalogue.exemplars()];
        for (block, used) in blocks.into_iter().enumerate() {
            needed[usize::from(catalogue.place(block as u16).exemplar)] |= used;
        }
        Ok((assignment, needed))
    }

    /// Makes the cloth of a design from its assignment and exemplar sets, one for each
    /// pair of `classes`. `albedo` holds the single-scattering albedo of each of the design's yarns.
    ///
    /// # Errors
    /// When synthesis fails or the job is cancelled.
    #[allow(
        clippy::too_many_arguments,
        reason = "the parts of a cloth, each made by its own step"
    )]
    pub fn new(
        design: &Design,
        catalogue: Arc<Catalogue>,
        classes: YarnClasses,
        assignment: Assignment,
        sets: Vec<Arc<ExemplarSet>>,
        albedo: Vec<Vec3>,
        settings: ClothSettings,
        job: &Job,
    ) -> Result<Self, ClothError> {
        let SynthesisSettings { seed, patch, .. } = settings.synthesis;
        let (edge_fix, majorants) = fitted(&catalogue, &sets, &settings, design.lattice(), job)?;
        let grid = sets.first().map_or_else(VoxelGrid::default, |set| set.grid);
        let correction = |family, set: &ExemplarSet| {
            (settings.correct_levels).then(|| LevelCorrection::of(family, set))?
        };
        let Corrected {
            matter,
            gains,
            light_error,
        } = corrected(&sets, correction);
        let has_places = settings.correct_levels && grid.level > 0;
        let places = (0..catalogue.blocks() as u16)
            .filter(|_| has_places)
            .map(|block| series::places(catalogue.key(block)))
            .collect();
        Ok(Self {
            grid,
            catalogue,
            sets,
            classes,
            edge_fix,
            majorants,
            assignment,
            randomisation: Randomisation { seed, patch },
            lattice: design.lattice(),
            maps: design.maps().clone(),
            ends: design.end_positions(),
            picks: design.pick_positions(),
            matter,
            places,
            gains,
            light_error,
            alpha: design.yarns().iter().map(roughness).collect(),
            albedo,
            settings,
            window: Arc::default(),
        })
    }

    /// Follows a change of the weave at `cells`: only what depends on them is made anew.
    ///
    /// # Errors
    /// When the weave has another size than the cloth's, or the job is cancelled.
    pub fn edit(
        &mut self,
        weave: &WeavePattern,
        cells: &[(u32, u32)],
        job: &Job,
    ) -> Result<(), ClothError> {
        self.assignment.edit(weave, &self.catalogue, cells, job)?;
        self.window = Arc::default();
        Ok(())
    }

    /// Which exemplars the cloth shows that were not built, which an edit may bring about:
    /// there it has holes until they are given to a new cloth.
    pub fn unbuilt(&self) -> Vec<bool> {
        let mut unbuilt: Vec<bool> = (0..self.catalogue.exemplars())
            .map(|exemplar| self.sets.iter().any(|set| set.volumes[exemplar].is_none()))
            .collect();
        if unbuilt.contains(&true) {
            let mut shown = vec![false; unbuilt.len()];
            for end in 0..self.assignment.ends() {
                for &block in self.assignment.column(end) {
                    shown[usize::from(self.catalogue.place(block).exemplar)] = true;
                }
            }
            for (unbuilt, shown) in unbuilt.iter_mut().zip(shown) {
                *unbuilt &= shown;
            }
        }
        unbuilt
    }

    /// Takes over other colours: no synthesis.
    pub fn recolour(&mut self, albedo: Vec<Vec3>) {
        if albedo.len() == self.albedo.len() {
            self.albedo = albedo;
        }
    }

    /// Takes over colour and gloss of the yarns of `design`, the same design in another
    /// colourway, where they are built alike (same family and size): no synthesis. False,
    /// and nothing changed, where the cloth has to be made anew.
    pub fn recolour_as(&mut self, design: &Design) -> bool {
        let alike = YarnClasses::new(design) == self.classes
            && *design.maps() == self.maps
            && design.yarns().len() == self.albedo.len();
        if alike {
            self.recolour(design.yarns().iter().map(super::colour::albedo).collect());
            self.alpha = design.yarns().iter().map(roughness).collect();
        }
        alike
    }

    /// The same cloth with other corrections of its level: for measuring them. Level 0 is
    /// never corrected.
    pub fn with_corrections(
        mut self,
        of: impl Fn(Family, &ExemplarSet) -> Option<LevelCorrection>,
    ) -> Self {
        if self.grid.level > 0 {
            let found = corrected(&self.sets, of);
            (self.matter, self.gains) = (found.matter, found.gains);
            self.light_error = found.light_error;
        }
        self
    }

    /// The level of its exemplars.
    pub fn level(&self) -> u32 {
        self.grid.level
    }

    /// How far the light of this cloth is off that of level 0, as a share of it: root mean
    /// square over lamps, as it was measured on the worst of its exemplars. 0 for level 0;
    /// `None` where it was not measured.
    pub fn light_error(&self) -> Option<f32> {
        if self.grid.level == 0 {
            return Some(0.0);
        }
        self.light_error
    }

    /// The assignment and its randomisation.
    pub fn placement(&self) -> Placement<'_> {
        Placement {
            catalogue: &self.catalogue,
            assignment: &self.assignment,
            randomisation: self.randomisation,
        }
    }

    /// The edge fixing.
    pub fn edge_fix(&self) -> &EdgeFix {
        &self.edge_fix
    }

    /// The exemplar sets.
    pub fn sets(&self) -> &[Arc<ExemplarSet>] {
        &self.sets
    }

    /// The exemplar set of a crossing of the endless cloth.
    #[inline]
    pub fn set_at(&self, end: i64, pick: i64) -> u16 {
        self.classes
            .set(self.warp_yarn(end, pick), self.weft_yarn(end, pick))
    }

    /// The warp yarn of a crossing of the endless cloth.
    #[inline]
    pub(super) fn warp_yarn(&self, end: i64, pick: i64) -> YarnId {
        self.maps.warp_on(self.lattice, end, pick)
    }

    /// The weft yarn of a crossing of the endless cloth.
    #[inline]
    pub(super) fn weft_yarn(&self, end: i64, pick: i64) -> YarnId {
        self.maps.weft_on(self.lattice, end, pick)
    }

    /// Whether the warp is on the face at a crossing; `None` where there is no cloth.
    #[inline]
    pub fn warp_up(&self, end: i64, pick: i64) -> Option<bool> {
        let block = match self.window.block(end, pick) {
            Some(known) => known?,
            None => self.assignment.at(end, pick)?,
        };
        Some(self.catalogue.key(block) & 1 == 1)
    }

    /// Where the ends lie.
    pub fn ends(&self) -> &Positions {
        &self.ends
    }

    /// Where the picks lie.
    pub fn picks(&self) -> &Positions {
        &self.picks
    }

    /// Lowest and highest place that may hold matter, mm.
    pub fn height_range(&self) -> (f32, f32) {
        let floor = self.floor_mm();
        (
            floor,
            floor + (self.majorants.cells()[2] * 4) as f32 * self.grid.voxel_mm.z,
        )
    }

    /// Height of the lowest cell, mm.
    #[inline]
    pub(super) fn floor_mm(&self) -> f32 {
        self.grid.floor_mm() - self.majorants.pad() as f32 * self.grid.voxel_mm.z
    }

    /// Replaces the majorants: for tests that leave an allowance out.
    pub fn with_allowance(mut self, allowance: Allowance) -> Self {
        let bits = neighbour_bits(
            &self.catalogue,
            self.lattice,
            self.settings.synthesis.method,
        );
        self.majorants = Arc::new(BlockMajorants::new(
            &self.catalogue,
            &self.sets,
            &self.edge_fix,
            bits,
            allowance,
        ));
        self
    }
}

/// What follows from the exemplars alone: how seams are closed, and majorants.
pub(super) fn fitted(
    catalogue: &Catalogue,
    sets: &[Arc<ExemplarSet>],
    settings: &ClothSettings,
    lattice: Lattice,
    job: &Job,
) -> Result<(Arc<EdgeFix>, Arc<BlockMajorants>), ClothError> {
    let SynthesisSettings { method, .. } = settings.synthesis;
    let heights: Vec<_> = sets.iter().map(|set| set.heights.clone()).collect();
    let predicted: Vec<_> = sets.iter().map(|set| set.predicted.clone()).collect();
    let closing = settings.synthesis.closing();
    let edge_fix = EdgeFix::with_basis_of(&predicted, &heights, catalogue, closing, job)?;
    job.check().map_err(SynthesisError::from)?;
    let bits = neighbour_bits(catalogue, lattice, method);
    let allowance = Allowance {
        tap: settings.tap,
        ..Allowance::FULL
    };
    let majorants = BlockMajorants::new(catalogue, sets, &edge_fix, bits, allowance);
    Ok((Arc::new(edge_fix), Arc::new(majorants)))
}

/// Consistent neighbours may be relied on when every crossing has a consistent candidate.
fn neighbour_bits(
    catalogue: &Catalogue,
    lattice: Lattice,
    method: crate::synthesis::Method,
) -> NeighbourBits {
    let consistent = method != crate::synthesis::Method::Naive
        && lattice == Lattice::default()
        && (0..32).all(|key| catalogue.mismatch(key) == 0);
    if consistent {
        NeighbourBits::Consistent
    } else {
        NeighbourBits::Any
    }
}
