//! Edge fixing: shifts of voxel stacks that close the seams. Zhao 2012 §5.5.
//!
//! Where two blocks meet that do not continue each other, each is moved half of the
//! difference of their edge heights towards the other, and the discrete Laplace equation
//! carries this smoothly into the block. The profile of a seam is *half a difference of
//! two edge heights*, so coefficients belong to the blocks' edges and a seam's are a
//! difference: nothing is stored per crossing.
//!
//! Comes in: [`EdgeHeights`] of every exemplar set, all with one block size. Goes out: the
//! shift s(x, y), in voxels, of the stack (x, y) of a block among its neighbours; the
//! content shown at z is the exemplar's at z − s. The fields of the two faces are separate.
//!
//! The basis holds the leading eigenvectors of the Gram matrix of all seams of a fixed
//! corpus, so a truncation to r has the least squared error of all rank-r bases. Fields
//! of opposite edges are mirror images and stored once.
//!
//! Beside the paper's way there is [`Closing::Crowns`], which keeps fibres straight where they
//! are seen: a membrane closes the step and leaves a kink of several degrees, wider than the
//! highlight of silk. There only edges count that the yarn on that face crosses and goes on
//! beyond, as a float does; the crown of the yarn has the same height *and slope* on either
//! side ([`Crown`](super::Crown)), by a cubic along the yarn that leaves its other end alone
//! and fades towards its flanks.

use nalgebra::{DMatrix, SymmetricEigen};
use serde::{Deserialize, Serialize};

use crate::job::Job;

use super::SynthesisError;
use super::bounds::Bounds;
use super::catalogue::{Catalogue, NO_BLOCK, Side};
use super::corpus::{Meeting, meetings};
use super::heights::{EdgeHeights, Face};
use super::laplace::EdgeSolver;
use super::lookup::{BlockRef, Neighbourhood};

/// How finely the profiles of seams are resolved, from crude to reference.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Rank {
    /// No edge fixing, and no work for it.
    Off,
    /// This many basis profiles per direction; Zhao uses 15. More than an edge has stacks
    /// means all.
    Truncated(u32),
    /// Every profile exactly.
    Exact,
}

/// How seams are closed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Closing {
    /// They are not.
    Off,
    /// A membrane closes steps between the heights of edges.
    Membrane(Rank),
    /// Height and slope of a yarn's crown are the same on both sides, where it is seen to
    /// cross the edge.
    Crowns,
}

impl From<Rank> for Closing {
    fn from(rank: Rank) -> Self {
        match rank {
            Rank::Off | Rank::Truncated(0) => Self::Off,
            _ => Self::Membrane(rank),
        }
    }
}

/// Which neighbours a bound of the shift allows for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum NeighbourBits {
    /// Neighbours with the same yarn on top as the block's neighbours in its exemplar:
    /// true of every consistent crossing, and tighter.
    Consistent,
    /// Any neighbours.
    Any,
}

/// Lanes of a dot product; coefficients are padded to a multiple.
const LANES: usize = 8;
/// Edge of the columns of stacks that a bound is given for.
pub const BOUND_COLUMN: usize = 4;

/// Edge fixing of all exemplar sets of a catalogue.
#[derive(Debug, Clone)]
pub struct EdgeFix {
    blocks: usize,
    sets: usize,
    bx: usize,
    by: usize,
    /// Profiles and fields of the left edge; the right edge mirrors them.
    vertical: Basis,
    /// Profiles and fields of the bottom edge; the top edge mirrors them.
    horizontal: Basis,
    /// `[face][set][block]`: left, right, bottom, top, each padded.
    coefficients: Vec<f32>,
    /// Block beside each block in its exemplar, by side.
    neighbours: Vec<[u16; 4]>,
    /// `[face][block]`: at which sides there may be a seam.
    seams: Vec<[bool; 4]>,
    bounds: Bounds,
}

/// Orthonormal profiles along an edge and the field each makes in a block.
#[derive(Debug, Clone, Default)]
struct Basis {
    rank: usize,
    padded: usize,
    /// `[t][position]`.
    profiles: Vec<f32>,
    /// `[y][x][t]`, padded with zeros.
    fields: Vec<f32>,
    /// The same for the opposite edge; empty where they are the mirror image.
    opposite: Vec<f32>,
}

/// Half-differences of edge coefficients at the four edges of a block.
///
/// Worth keeping while several stacks of one block are evaluated; reuse one value to
/// avoid allocating.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SeamCoefficients {
    /// Left, right, bottom, top, each padded; empty = no shift.
    values: Vec<f32>,
}

impl EdgeFix {
    /// Prepares edge fixing for exemplar sets that share `catalogue` and one block size.
    ///
    /// # Errors
    /// When heights do not fit the catalogue or each other or are not finite, or the job
    /// is cancelled.
    pub fn new(
        heights: &[EdgeHeights],
        catalogue: &Catalogue,
        closing: impl Into<Closing>,
        job: &Job,
    ) -> Result<Self, SynthesisError> {
        Self::with_basis_of(heights, heights, catalogue, closing, job)
    }

    /// The same with a basis made for other heights, such as those that recipes predict:
    /// it stays what it is while more exemplars are built and measured.
    ///
    /// # Errors
    /// As [`EdgeFix::new`].
    pub fn with_basis_of(
        predicted: &[EdgeHeights],
        heights: &[EdgeHeights],
        catalogue: &Catalogue,
        closing: impl Into<Closing>,
        job: &Job,
    ) -> Result<Self, SynthesisError> {
        let closing = closing.into();
        let (bx, by) = heights.first().map_or((1, 1), |first| (first.bx, first.by));
        for (set, heights) in predicted.iter().chain(heights).enumerate() {
            heights.check(set, catalogue)?;
            if (heights.bx, heights.by) != (bx, by) {
                let what = format!(
                    "blocks of {} × {} stacks, the first set's have {bx} × {by}",
                    heights.bx, heights.by
                );
                return Err(SynthesisError::Heights { set, what });
            }
        }
        let neighbours = (0..catalogue.blocks() as u16)
            .map(|block| Side::ALL.map(|side| catalogue.neighbour(block, side).unwrap_or(NO_BLOCK)))
            .collect();
        let mut fix = Self {
            blocks: catalogue.blocks(),
            sets: heights.len(),
            bx,
            by,
            vertical: Basis::default(),
            horizontal: Basis::default(),
            coefficients: Vec::new(),
            neighbours,
            seams: seams(catalogue, closing),
            bounds: Bounds::default(),
        };
        let wanted = match closing {
            _ if heights.is_empty() => return Ok(fix),
            Closing::Off | Closing::Membrane(Rank::Off) => return Ok(fix),
            Closing::Crowns => {
                fix.vertical = Basis::crowns(bx, by, |x, y| y * bx + x);
                fix.horizontal = Basis::crowns(by, bx, |y, x| y * bx + x);
                fix.take_crowns(heights);
                fix.bounds = Bounds::new(&fix, catalogue);
                return Ok(fix);
            }
            Closing::Membrane(Rank::Truncated(rank)) => rank as usize,
            Closing::Membrane(Rank::Exact) => usize::MAX,
        };
        let [across, along] = meetings(catalogue, job)?;
        job.report("edge fixing", 0.1);
        let gram = gram_matrix(predicted, &across, Side::Right, by);
        fix.vertical = Basis::vertical(gram, wanted, bx, by);
        let gram = gram_matrix(predicted, &along, Side::Above, bx);
        fix.horizontal = Basis::horizontal(gram, wanted, bx, by);
        job.check()?;
        job.report("edge fixing", 0.4);
        fix.project(heights, predicted);
        job.check()?;
        fix.bounds = Bounds::new(&fix, catalogue);
        job.report("edge fixing", 1.0);
        Ok(fix)
    }

    /// True when edge fixing is off: every shift is zero.
    pub fn is_off(&self) -> bool {
        self.coefficients.is_empty()
    }

    /// Stacks of voxels across and along a block.
    pub fn block_size(&self) -> (usize, usize) {
        (self.bx, self.by)
    }

    /// Basis profiles of vertical and of horizontal edges.
    pub fn ranks(&self) -> (usize, usize) {
        (self.vertical.rank, self.horizontal.rank)
    }

    /// Bytes of all tables.
    pub fn bytes(&self) -> usize {
        let floats = self.coefficients.len()
            + self.vertical.profiles.len()
            + self.vertical.fields.len()
            + self.horizontal.profiles.len()
            + self.horizontal.fields.len()
            + self.vertical.opposite.len()
            + self.horizontal.opposite.len();
        floats * size_of::<f32>()
            + self.bounds.bytes()
            + self.neighbours.len() * size_of::<[u16; 4]>()
            + self.seams.len() * size_of::<[bool; 4]>()
    }

    /// True when no seam is between two blocks: they stand so in one exemplar.
    #[inline]
    pub fn continues(&self, block: BlockRef, side: Side, neighbour: BlockRef) -> bool {
        block.set == neighbour.set
            && self.neighbours[usize::from(block.block)][side.index()] == neighbour.block
    }

    /// Whether anything is shifted on a face where these two meet.
    #[inline]
    pub fn shifts_across(
        &self,
        block: BlockRef,
        side: Side,
        neighbour: BlockRef,
        face: Face,
    ) -> bool {
        let may = |block: u16, side: Side| {
            self.seams[face as usize * self.blocks + usize::from(block)][side.index()]
        };
        may(block.block, side)
            && may(neighbour.block, side.opposite())
            && !self.continues(block, side, neighbour)
    }

    /// Whether a block may have a seam at a side on a face.
    pub(super) fn may_shift(&self, block: u16, side: Side, face: Face) -> bool {
        self.seams[face as usize * self.blocks + usize::from(block)][side.index()]
    }

    /// Coefficients of a block's four seams, to be evaluated by [`EdgeFix::shift`].
    pub fn seam(&self, around: &Neighbourhood, face: Face) -> SeamCoefficients {
        let mut seam = SeamCoefficients::default();
        self.seam_into(around, face, &mut seam);
        seam
    }

    /// The same, written into a value that is reused.
    pub fn seam_into(&self, around: &Neighbourhood, face: Face, seam: &mut SeamCoefficients) {
        seam.values.clear();
        if self.is_off() {
            return;
        }
        for side in Side::ALL {
            let own = self.edge(around.centre, face, side);
            match self.across_seam(around, face, side) {
                Some(other) => {
                    let pairs = own.iter().zip(other);
                    seam.values
                        .extend(pairs.map(|(own, other)| 0.5 * (other - own)));
                }
                None => seam.values.extend(own.iter().map(|_| 0.0)),
            }
        }
    }

    /// Shift of the stack (x, y) of the block in voxels, x < bx and y < by.
    #[inline]
    pub fn shift(&self, seam: &SeamCoefficients, x: usize, y: usize) -> f32 {
        if seam.values.is_empty() {
            return 0.0;
        }
        let mut rest = seam.values.as_slice();
        let mut sum = 0.0;
        for side in Side::ALL {
            let field = self.field(side, x, y);
            let (coefficients, after) = rest.split_at(field.len());
            sum += dot(coefficients, field);
            rest = after;
        }
        sum
    }

    /// Shift of the stack (x, y) straight from the neighbourhood: the cheapest way to a
    /// single value, without allocating. Edges without a seam cost nothing.
    #[inline]
    pub fn shift_at(&self, around: &Neighbourhood, face: Face, x: usize, y: usize) -> f32 {
        if self.is_off() {
            return 0.0;
        }
        let mut sum = 0.0;
        for side in Side::ALL {
            if let Some(other) = self.across_seam(around, face, side) {
                let own = self.edge(around.centre, face, side);
                sum += 0.5 * dot_difference(other, own, self.field(side, x, y));
            }
        }
        sum
    }

    /// [`EdgeFix::shift_at`] of every stack of the block, x fastest.
    pub fn shifts(&self, around: &Neighbourhood, face: Face) -> Vec<f32> {
        let mut shifts = vec![0.0; self.bx * self.by];
        if self.is_off() {
            return shifts;
        }
        for side in Side::ALL {
            let Some(other) = self.across_seam(around, face, side) else {
                continue;
            };
            let own = self.edge(around.centre, face, side);
            let pairs = other.iter().zip(own);
            let seam: Vec<f32> = pairs.map(|(other, own)| 0.5 * (other - own)).collect();
            for (i, shift) in shifts.iter_mut().enumerate() {
                *shift += dot(&seam, self.field(side, i % self.bx, i / self.bx));
            }
        }
        shifts
    }

    /// Shift in voxels and its slopes ∂s/∂x, ∂s/∂y in voxels per stack: central
    /// differences inside the block, one-sided ones at its border.
    pub fn shift_and_gradient(
        &self,
        seam: &SeamCoefficients,
        x: usize,
        y: usize,
    ) -> (f32, f32, f32) {
        let slope = |low: (usize, usize), high: (usize, usize), steps: usize| {
            let rise = self.shift(seam, high.0, high.1) - self.shift(seam, low.0, low.1);
            rise / steps.max(1) as f32
        };
        if seam.values.is_empty() {
            return (0.0, 0.0, 0.0);
        }
        let (left, right) = (x.saturating_sub(1), (x + 1).min(self.bx - 1));
        let (below, above) = (y.saturating_sub(1), (y + 1).min(self.by - 1));
        (
            self.shift(seam, x, y),
            slope((left, y), (right, y), right - left),
            slope((x, below), (x, above), above - below),
        )
    }

    /// Lowest and highest shift over each column of 4 × 4 stacks of a block, for all
    /// neighbours of the given kind in any set; columns in rows along x, ⌈bx/4⌉ a row.
    /// Empty when edge fixing is off: every shift is zero.
    pub fn bounds(&self, set: u16, block: u16, face: Face, bits: NeighbourBits) -> &[[f32; 2]] {
        self.bounds
            .of(self.row(BlockRef { set, block }, face), bits)
    }

    /// The shift along the edge of `block` towards `neighbour`, apart from corners.
    pub fn seam_profile(
        &self,
        block: BlockRef,
        side: Side,
        neighbour: BlockRef,
        face: Face,
    ) -> Vec<f32> {
        let basis = self.basis(side);
        let length = self.edge_length(side);
        let mut profile = vec![0.0; length];
        if self.is_off() || !self.shifts_across(block, side, neighbour, face) {
            return profile;
        }
        let own = self.edge(block, face, side);
        let other = self.edge(neighbour, face, side.opposite());
        for (t, vector) in basis.profiles.chunks_exact(length).enumerate() {
            let amount = 0.5 * (other[t] - own[t]);
            for (value, shape) in profile.iter_mut().zip(vector) {
                *value += amount * shape;
            }
        }
        profile
    }

    /// How much the shift at the edge of `block` towards `neighbour` rises along +x or +y,
    /// across the edge, in the middle of the edge: voxels a stack. What the block's other
    /// edges add is left out.
    pub fn seam_slope(&self, block: BlockRef, side: Side, neighbour: BlockRef, face: Face) -> f32 {
        if self.is_off() || !self.shifts_across(block, side, neighbour, face) {
            return 0.0;
        }
        let own = self.edge(block, face, side);
        let other = self.edge(neighbour, face, side.opposite());
        let (bx, by) = (self.bx, self.by);
        let most = self.edge_length(match side {
            Side::Left | Side::Right => Side::Below,
            Side::Below | Side::Above => Side::Left,
        });
        let at = |from_edge: usize, along: usize| {
            let from_edge = from_edge.min(most - 1);
            let (x, y) = match side {
                Side::Left => (from_edge, along),
                Side::Right => (bx - 1 - from_edge, along),
                Side::Below => (along, from_edge),
                Side::Above => (along, by - 1 - from_edge),
            };
            0.5 * dot_difference(other, own, self.field(side, x, y))
        };
        let length = self.edge_length(side);
        let middle = length / 5..(length - length / 5).max(length / 5 + 1);
        let count = middle.len() as f32;
        // The slope at the border itself: the parabola through the three stacks next to it.
        let inwards: f32 = middle
            .map(|along| {
                let [a, b, c] = [0, 1, 2].map(|from_edge| at(from_edge, along));
                2.0 * (b - a) - (c - b)
            })
            .sum();
        match side {
            Side::Left | Side::Below => inwards / count,
            Side::Right | Side::Above => -inwards / count,
        }
    }

    /// The neighbour's coefficients when there is a seam towards it.
    #[inline]
    fn across_seam(&self, around: &Neighbourhood, face: Face, side: Side) -> Option<&[f32]> {
        let neighbour = around.sides[side.index()]?;
        if !self.shifts_across(around.centre, side, neighbour, face) {
            return None;
        }
        Some(self.edge(neighbour, face, side.opposite()))
    }

    #[inline]
    fn basis(&self, side: Side) -> &Basis {
        match side {
            Side::Left | Side::Right => &self.vertical,
            Side::Below | Side::Above => &self.horizontal,
        }
    }

    fn edge_length(&self, side: Side) -> usize {
        match side {
            Side::Left | Side::Right => self.by,
            Side::Below | Side::Above => self.bx,
        }
    }

    /// Position of a block in tables by face, set and block.
    #[inline]
    fn row(&self, block: BlockRef, face: Face) -> usize {
        (face as usize * self.sets + usize::from(block.set)) * self.blocks
            + usize::from(block.block)
    }

    /// Coefficients of one edge of a block.
    #[inline]
    fn edge(&self, block: BlockRef, face: Face, side: Side) -> &[f32] {
        let (v, h) = (self.vertical.padded, self.horizontal.padded);
        let base = self.row(block, face) * 2 * (v + h);
        let (from, length) = match side {
            Side::Left => (0, v),
            Side::Right => (v, v),
            Side::Below => (2 * v, h),
            Side::Above => (2 * v + h, h),
        };
        &self.coefficients[base + from..base + from + length]
    }

    /// Values of all basis fields of one edge at a stack.
    #[inline]
    fn field(&self, side: Side, x: usize, y: usize) -> &[f32] {
        let basis = self.basis(side);
        let (fields, [x, y]) = match side {
            Side::Left | Side::Below => (&basis.fields, [x, y]),
            _ if !basis.opposite.is_empty() => (&basis.opposite, [x, y]),
            Side::Right => (&basis.fields, [self.bx - 1 - x, y]),
            Side::Above => (&basis.fields, [x, self.by - 1 - y]),
        };
        let from = (y * self.bx + x) * basis.padded;
        &fields[from..from + basis.padded]
    }

    /// Every block of every set, in the order of the tables.
    pub(super) fn every_block(&self) -> impl Iterator<Item = BlockRef> {
        let blocks = self.blocks as u16;
        (0..self.sets as u16)
            .flat_map(move |set| (0..blocks).map(move |block| BlockRef { set, block }))
    }

    /// The field `[y][x]` that the heights of a block's edge make when they are given at
    /// side `at` of a block.
    pub(super) fn edge_field(&self, block: BlockRef, face: Face, edge: Side, at: Side) -> Vec<f32> {
        let coefficients = self.edge(block, face, edge);
        let stacks = (0..self.by).flat_map(|y| (0..self.bx).map(move |x| (x, y)));
        stacks
            .map(|(x, y)| dot(coefficients, self.field(at, x, y)))
            .collect()
    }

    /// The crowns of all edges are their coefficients.
    fn take_crowns(&mut self, heights: &[EdgeHeights]) {
        for face in Face::ALL {
            let mean = mean_crown(heights, face);
            for heights in heights {
                for block in 0..self.blocks as u16 {
                    for side in Side::ALL {
                        let crown = heights.crown(face, block, side);
                        let own = [crown.height - mean, crown.slope];
                        let padding = [0.0; LANES - 2];
                        self.coefficients.extend(own.into_iter().chain(padding));
                    }
                }
            }
        }
    }

    /// Projects the heights of all edges on the bases.
    fn project(&mut self, heights: &[EdgeHeights], predicted: &[EdgeHeights]) {
        for face in Face::ALL {
            // Of the prediction: which exemplars are built does not move a bit of the rest.
            let mean = mean_height(predicted, face);
            for heights in heights {
                for block in 0..self.blocks as u16 {
                    for side in Side::ALL {
                        let profile = heights.profile(face, block, side);
                        let basis = match side {
                            Side::Left | Side::Right => &self.vertical,
                            Side::Below | Side::Above => &self.horizontal,
                        };
                        basis.project(profile, mean, &mut self.coefficients);
                    }
                }
            }
        }
    }
}

/// At which sides of each block there may be a seam on a face: of crowns, where a float runs
/// on.
fn seams(catalogue: &Catalogue, closing: Closing) -> Vec<[bool; 4]> {
    let blocks = 0..catalogue.blocks() as u16;
    let every = Face::ALL
        .into_iter()
        .flat_map(|face| blocks.clone().map(move |block| (face, block)));
    let may = |(face, block)| {
        Side::ALL.map(|side| closing != Closing::Crowns || catalogue.runs_on(block, side, face))
    };
    every.map(may).collect()
}

/// Where across a yarn its crown is shifted whole, as a share of its pitch from the middle;
/// from there to the border of the block, it fades.
const CROWN: f32 = 0.3;

impl Basis {
    /// Fields of the crown's height and slope at two opposite edges, `away` stacks apart and
    /// `across` stacks long; `stack(a, c)` is the number of the stack that lies so far from the
    /// first and so far along it.
    fn crowns(away: usize, across: usize, stack: impl Fn(usize, usize) -> usize) -> Self {
        let weight: Vec<f32> = (0..across)
            .map(|at| {
                let aside = ((at as f32 + 0.5) / across as f32 - 0.5).abs();
                let rest = ((0.5 - aside) / (0.5 - CROWN)).clamp(0.0, 1.0);
                rest * rest * (3.0 - 2.0 * rest)
            })
            .collect();
        let mut basis = Self {
            rank: 2,
            padded: LANES,
            profiles: [&weight[..], &vec![0.0; across]].concat(),
            fields: vec![0.0; away * across * LANES],
            opposite: vec![0.0; away * across * LANES],
        };
        let length = away as f32;
        for a in 0..away {
            // Cubic Hermite: 1 and slope 0 at the edge, or 0 and slope 1; nothing at the other.
            let t = (a as f32 + 0.5) / length;
            let height = |t: f32| (1.0 + 2.0 * t) * (1.0 - t) * (1.0 - t);
            let slope = |t: f32| length * t * (1.0 - t) * (1.0 - t);
            for (c, &weight) in weight.iter().enumerate() {
                let from = stack(a, c) * LANES;
                basis.fields[from] = weight * height(t);
                basis.fields[from + 1] = weight * slope(t);
                basis.opposite[from] = weight * height(1.0 - t);
                basis.opposite[from + 1] = -weight * slope(1.0 - t);
            }
        }
        basis
    }

    fn vertical(gram: DMatrix<f64>, rank: usize, bx: usize, by: usize) -> Self {
        let solver = EdgeSolver::new(bx, by);
        Self::new(gram, rank, bx * by, |profile| solver.solve(profile))
    }

    fn horizontal(gram: DMatrix<f64>, rank: usize, bx: usize, by: usize) -> Self {
        let solver = EdgeSolver::new(by, bx);
        Self::new(gram, rank, bx * by, |profile| {
            // The solver's x runs away from the edge: here that is the block's y.
            let field = solver.solve(profile);
            let transposed = (0..by).flat_map(|y| (0..bx).map(move |x| (x, y)));
            transposed.map(|(x, y)| field[x * by + y]).collect()
        })
    }

    /// The leading `rank` eigenvectors of a Gram matrix and their fields.
    fn new(
        gram: DMatrix<f64>,
        rank: usize,
        stacks: usize,
        solve: impl Fn(&[f64]) -> Vec<f64>,
    ) -> Self {
        let length = gram.nrows();
        let rank = rank.min(length);
        let padded = rank.div_ceil(LANES) * LANES;
        let mut basis = Self {
            rank,
            padded,
            profiles: Vec::with_capacity(rank * length),
            fields: vec![0.0; stacks * padded],
            opposite: Vec::new(),
        };
        for (t, profile) in eigenvectors(gram).into_iter().take(rank).enumerate() {
            for (stack, value) in solve(&profile).into_iter().enumerate() {
                basis.fields[stack * padded + t] = value as f32;
            }
            basis
                .profiles
                .extend(profile.iter().map(|&value| value as f32));
        }
        basis
    }

    /// Appends the coefficients of a profile about `mean`.
    fn project(&self, profile: &[f32], mean: f64, coefficients: &mut Vec<f32>) {
        for vector in self.profiles.chunks_exact(profile.len()) {
            let products = vector.iter().zip(profile);
            let sum: f64 = products
                .map(|(&shape, &height)| f64::from(shape) * (f64::from(height) - mean))
                .sum();
            coefficients.push(sum as f32);
        }
        coefficients.extend((self.rank..self.padded).map(|_| 0.0));
    }
}

/// Unit eigenvectors of a symmetric matrix, largest eigenvalue first, with a fixed sign.
fn eigenvectors(gram: DMatrix<f64>) -> Vec<Vec<f64>> {
    let length = gram.nrows();
    let largest = gram.amax();
    let scaled = if largest > 0.0 { gram / largest } else { gram };
    let Some(eigen) = SymmetricEigen::try_new(scaled, f64::EPSILON, 1000 * length.max(1)) else {
        // Any orthonormal basis is exact at full rank.
        let unit = |t: usize| (0..length).map(|at| f64::from(u8::from(at == t))).collect();
        return (0..length).map(unit).collect();
    };
    let mut order: Vec<usize> = (0..length).collect();
    order.sort_by(|&a, &b| eigen.eigenvalues[b].total_cmp(&eigen.eigenvalues[a]));
    let column = |&t: &usize| {
        let vector: Vec<f64> = eigen.eigenvectors.column(t).iter().copied().collect();
        let lead = vector
            .iter()
            .copied()
            .fold(0.0f64, |a, b| if b.abs() > a.abs() { b } else { a });
        let sign = if lead < 0.0 { -1.0 } else { 1.0 };
        vector.iter().map(|value| sign * value).collect()
    };
    order.iter().map(column).collect()
}

/// Mean height over all sets and edges of a face: removed first, since only differences
/// count and small numbers round less.
fn mean_height(heights: &[EdgeHeights], face: Face) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for heights in heights {
        for block in 0..heights.blocks as u16 {
            for side in Side::ALL {
                for &height in heights.profile(face, block, side) {
                    sum += f64::from(height);
                    count += 1.0;
                }
            }
        }
    }
    if count > 0.0 { sum / count } else { 0.0 }
}

/// Mean height of all crowns of a face.
fn mean_crown(heights: &[EdgeHeights], face: Face) -> f32 {
    let crowns = heights.iter().flat_map(|heights| {
        let half = heights.crowns.len() / 2;
        &heights.crowns[face as usize * half..][..half]
    });
    let (sum, count) = crowns.fold((0.0, 0.0), |(sum, count), crown| {
        (sum + f64::from(crown.height), count + 1.0)
    });
    if count > 0.0 {
        (sum / count) as f32
    } else {
        0.0
    }
}

/// Σ d dᵀ over all seams of the corpus, every pair of sets and both faces, where d is the
/// difference of the two edge heights.
///
/// The square is multiplied out, so that the cost is one outer product a block, not one a
/// pair of blocks and sets.
fn gram_matrix(
    heights: &[EdgeHeights],
    meetings: &[Meeting],
    side: Side,
    length: usize,
) -> DMatrix<f64> {
    let mut gram = DMatrix::zeros(length, length);
    let blocks = heights.first().map_or(0, |first| first.blocks);
    let sets = heights.len() as f64;
    let mut met = [vec![0.0; blocks], vec![0.0; blocks]];
    for meeting in meetings {
        met[0][usize::from(meeting.first)] += f64::from(meeting.count);
        met[1][usize::from(meeting.second)] += f64::from(meeting.count);
    }
    for face in Face::ALL {
        let mean = mean_height(heights, face);
        let centred = |heights: &EdgeHeights, block: usize, side: Side| {
            let profile = heights.profile(face, block as u16, side).iter();
            nalgebra::DVector::from_iterator(length, profile.map(|&h| f64::from(h) - mean))
        };
        // Squares of either side's heights.
        for (which, side) in [side, side.opposite()].into_iter().enumerate() {
            for block in (0..blocks).filter(|&block| met[which][block] > 0.0) {
                for heights in heights {
                    let h = centred(heights, block, side);
                    gram.ger(sets * met[which][block], &h, &h, 1.0);
                }
            }
        }
        // Mixed terms, through the heights summed over the sets.
        let summed = |block: usize, side: Side| {
            let zero = nalgebra::DVector::zeros(length);
            heights
                .iter()
                .fold(zero, |sum, heights| sum + centred(heights, block, side))
        };
        let own: Vec<_> = (0..blocks).map(|block| summed(block, side)).collect();
        let other: Vec<_> = (0..blocks)
            .map(|block| summed(block, side.opposite()))
            .collect();
        for group in meetings.chunk_by(|a, b| a.first == b.first) {
            let mut beyond = nalgebra::DVector::zeros(length);
            for meeting in group {
                beyond.axpy(
                    f64::from(meeting.count),
                    &other[usize::from(meeting.second)],
                    1.0,
                );
            }
            let own = &own[usize::from(group[0].first)];
            gram.ger(-1.0, own, &beyond, 1.0);
            gram.ger(-1.0, &beyond, own, 1.0);
        }
    }
    gram
}

/// Σ a·b in a fixed order that vectorises; lengths are multiples of `LANES`.
#[inline]
fn dot(a: &[f32], b: &[f32]) -> f32 {
    let mut lanes = [0.0f32; LANES];
    for (a, b) in a.chunks_exact(LANES).zip(b.chunks_exact(LANES)) {
        for lane in 0..LANES {
            lanes[lane] += a[lane] * b[lane];
        }
    }
    sum_lanes(lanes)
}

/// Σ (a − b)·c, likewise.
#[inline]
fn dot_difference(a: &[f32], b: &[f32], c: &[f32]) -> f32 {
    let mut lanes = [0.0f32; LANES];
    let pairs = a.chunks_exact(LANES).zip(b.chunks_exact(LANES));
    for ((a, b), c) in pairs.zip(c.chunks_exact(LANES)) {
        for lane in 0..LANES {
            lanes[lane] += (a[lane] - b[lane]) * c[lane];
        }
    }
    sum_lanes(lanes)
}

#[inline]
fn sum_lanes(l: [f32; LANES]) -> f32 {
    ((l[0] + l[4]) + (l[2] + l[6])) + ((l[1] + l[5]) + (l[3] + l[7]))
}
