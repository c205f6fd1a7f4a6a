//! Fibres to voxels: fill fraction, principal direction of ttᵀ, yarn.
//!
//! A fibre runs mainly along its yarn, so it is met plane by plane: one point for each
//! voxel plane across the yarn (at levels 1 and 2, for each plane that level 0 would have),
//! splatted as a disc of the fibre's own thickness. Slabs of eight voxel rows are
//! independent and run in parallel; sums are in fixed order.

use glam::{Vec2, Vec3};
use rayon::prelude::*;

use super::bricks::{BRICK, BrickVolume, PackedVoxel};
use super::lobes::Lobes;
use super::set::Pair;
use crate::design::Direction;
use crate::job::{Cancelled, Job};
use crate::yarn::fibre::{self, FibreLayout};
use crate::yarn::{WeaveGeometry, YarnRecipe};

/// The grid of one exemplar.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct VoxelGrid {
    /// Voxels of one block (crossing) along x and y, and of the whole thickness.
    pub block: [usize; 3],
    /// Size of a voxel, mm.
    pub voxel_mm: Vec3,
    /// How often the resolution was halved.
    pub level: u32,
}

impl VoxelGrid {
    /// Height of the lowest voxel's lower face over the cloth's mid plane, mm.
    pub fn floor_mm(&self) -> f32 {
        -0.5 * self.block[2] as f32 * self.voxel_mm.z
    }
}

/// All fibres of one direction, as points at voxel planes.
struct Strands {
    direction: Direction,
    /// Points of each fibre, `planes` each, in voxels.
    points: Vec<Vec3>,
    planes: usize,
    /// Points to a voxel.
    steps: usize,
    /// Points to a voxel of level 0, at least 1.
    baseline: f32,
    /// Share of a splat that a voxel takes, so that all levels hold as much fibre.
    share: f32,
    /// Yarn of each fibre.
    yarns: Vec<u8>,
    /// Fibre radius, mm.
    radius: f32,
}

/// Dense slabs that are held at once.
const SLABS_AT_ONCE: usize = 8;

/// Running sums of one voxel.
#[derive(Clone, Copy, Default)]
struct Sums {
    fill: f32,
    /// Σ w ttᵀ: xx, yy, zz, xy, xz, yz.
    moments: [f32; 6],
    strongest: f32,
    yarn: u8,
    weft: bool,
}

/// Builds the voxels of an exemplar. The recipes are those that made `weave`.
///
/// # Errors
/// [`Cancelled`] when the job was.
pub fn voxelise(
    weave: &WeaveGeometry,
    warp: &YarnRecipe,
    weft: &YarnRecipe,
    grid: &VoxelGrid,
    seed: u64,
    job: &Job,
) -> Result<BrickVolume, Cancelled> {
    let size = [
        grid.block[0] * weave.warp.len(),
        grid.block[1] * weave.weft.len(),
        grid.block[2],
    ];
    let strands = [
        strands(weave, warp, Direction::Warp, grid, size[1], seed),
        strands(weave, weft, Direction::Weft, grid, size[0], seed),
    ];
    let mut volume = BrickVolume::new(size);
    let rows: Vec<usize> = (0..size[1] / BRICK).collect();
    // A few at a time: slabs are dense, and what is kept of them is not.
    for rows in rows.chunks(SLABS_AT_ONCE) {
        job.check()?;
        let slabs: Vec<Slab> = (rows.par_iter())
            .map(|&row| slab(&strands, size, grid, row))
            .collect();
        for (&row, (voxels, lobes)) in rows.iter().zip(&slabs) {
            volume.put_slab(row, voxels, lobes);
        }
    }
    Ok(volume)
}

/// Bytes of one voxel that is kept.
pub(super) fn bytes_a_voxel(grid: &VoxelGrid) -> u64 {
    let lobes = if grid.level > 0 {
        size_of::<Lobes>()
    } else {
        0
    };
    (size_of::<PackedVoxel>() + lobes) as u64
}

/// Bytes that building an exemplar of so many ends and picks takes and gives back.
pub(super) fn building_bytes(pair: &Pair, grid: &VoxelGrid, [ends, picks]: [u64; 2]) -> u64 {
    let fine = grid.fine().map(|side| side as u64);
    let points = |recipe: &YarnRecipe, yarns: u64, planes: u64| {
        let fibres = FibreLayout::new(recipe).len() as u64;
        yarns * fibres * planes * size_of::<Vec3>() as u64
    };
    // Rounded up to whole steps a voxel, there are at most twice as many planes.
    let strands = points(&pair.warp, ends, 2 * fine[1] * picks).saturating_add(points(
        &pair.weft,
        picks,
        2 * fine[0] * ends,
    ));
    let slab = ends * (grid.block[0] * BRICK * grid.block[2]) as u64;
    let voxel = size_of::<Sums>() as u64 + bytes_a_voxel(grid);
    strands.saturating_add(slab.saturating_mul(voxel * SLABS_AT_ONCE as u64))
}

fn strands(
    weave: &WeaveGeometry,
    recipe: &YarnRecipe,
    direction: Direction,
    grid: &VoxelGrid,
    planes: usize,
    seed: u64,
) -> Strands {
    let layout = FibreLayout::new(recipe);
    // As many points as level 0 has, or a few more: a highlight shows where the slope is
    // the right one, and slopes come from points as far apart as those of level 0.
    let (across, along) = match direction {
        Direction::Warp => (1, weave.weft.len()),
        Direction::Weft => (0, weave.warp.len()),
    };
    let fine = grid.fine()[across] * along;
    let steps = fine.div_ceil(planes.max(1)).max(1);
    let planes = planes * steps;
    let baseline = planes as f32 / fine.max(1) as f32;
    let radius = recipe.fibre_um * 0.5e-3;
    let yarns = weave.yarns(direction).len();
    let mut points = vec![Vec3::ZERO; yarns * layout.len() * planes];
    let floor = Vec3::new(0.0, 0.0, grid.floor_mm());
    points
        .par_chunks_mut(planes)
        .enumerate()
        .for_each(|(strand, points)| {
            let (yarn, fibre) = (strand / layout.len(), strand % layout.len());
            fibre::trace(weave, recipe, &layout, direction, yarn, fibre, seed, points);
            for point in points {
                *point = (*point - floor) / grid.voxel_mm;
            }
        });
    let yarns = (0..yarns * layout.len())
        .map(|strand| (strand / layout.len()) as u8)
        .collect();
    Strands {
        direction,
        points,
        planes,
        steps,
        baseline,
        share: share_of(direction, radius, grid) / steps as f32,
        yarns,
        radius,
    }
}

/// Eight rows of voxels, and above level 0 how far the fibres of each point apart.
type Slab = (Vec<PackedVoxel>, Vec<Lobes>);

fn slab(strands: &[Strands; 2], size: [usize; 3], grid: &VoxelGrid, row: usize) -> Slab {
    let voxel_mm = grid.voxel_mm;
    let [width, height, depth] = size;
    let mut sums = vec![Sums::default(); width * BRICK * depth];
    let rows = row * BRICK..(row + 1) * BRICK;
    for strands in strands {
        for (fibre, &yarn) in strands.yarns.iter().enumerate() {
            let points = &strands.points[fibre * strands.planes..][..strands.planes];
            match strands.direction {
                Direction::Warp => {
                    for plane in rows.start * strands.steps..rows.end * strands.steps {
                        let splat = Splat::new(strands, points, plane, voxel_mm, yarn);
                        let y = plane / strands.steps - rows.start;
                        splat.over(
                            Vec2::new(points[plane].x, points[plane].z),
                            Vec2::new(voxel_mm.x, voxel_mm.z),
                            |x, z, weight| {
                                if (0..depth as i64).contains(&z) {
                                    let x = x.rem_euclid(width as i64) as usize;
                                    splat.add(
                                        &mut sums[(z as usize * BRICK + y) * width + x],
                                        weight,
                                    );
                                }
                            },
                        );
                    }
                }
                Direction::Weft => {
                    // A weft stays near its own pick: most slabs do not meet it.
                    let near = |y: f32| {
                        let offset = (y - rows.start as f32 + 4.0).rem_euclid(height as f32);
                        offset < BRICK as f32 + 8.0
                    };
                    for (plane, point) in points.iter().enumerate().filter(|(_, p)| near(p.y)) {
                        let splat = Splat::new(strands, points, plane, voxel_mm, yarn);
                        let x = plane / strands.steps;
                        splat.over(
                            Vec2::new(point.y, point.z),
                            Vec2::new(voxel_mm.y, voxel_mm.z),
                            |y, z, weight| {
                                let y = y.rem_euclid(height as i64) as usize;
                                if (0..depth as i64).contains(&z) && rows.contains(&y) {
                                    splat.add(
                                        &mut sums
                                            [(z as usize * BRICK + y - rows.start) * width + x],
                                        weight,
                                    );
                                }
                            },
                        );
                    }
                }
            }
        }
    }
    if grid.level == 0 {
        return (sums.iter().map(Sums::pack).collect(), Vec::new());
    }
    sums.iter().map(Sums::pack_apart).unzip()
}

/// One fibre point on its way into the voxels around it.
struct Splat {
    direction: Vec3,
    /// Fibre radius where the plane cuts it, mm.
    radius: f32,
    share: f32,
    yarn: u8,
    weft: bool,
}

impl Splat {
    fn new(strands: &Strands, points: &[Vec3], plane: usize, voxel_mm: Vec3, yarn: u8) -> Self {
        // Direction by central difference over two voxels of level 0, at whatever level; at
        // the ends of the repeat, one-sided.
        let at = |place: f32| {
            let place = place.clamp(0.0, (points.len() - 1) as f32);
            let (from, part) = (place as usize, place.fract());
            points[from].lerp(points[(from + 1).min(points.len() - 1)], part)
        };
        let (before, after) = (
            plane as f32 - strands.baseline,
            plane as f32 + strands.baseline,
        );
        let step = (at(after) - at(before)) * voxel_mm;
        let direction = step.try_normalize().unwrap_or(match strands.direction {
            Direction::Warp => Vec3::Y,
            Direction::Weft => Vec3::X,
        });
        Self {
            direction,
            radius: strands.radius,
            share: strands.share,
            yarn,
            weft: strands.direction == Direction::Weft,
        }
    }

    /// Calls `visit(a, b, weight)` for the voxels of the plane that the fibre's section
    /// covers; `centre` in voxels, `pitch` = voxel size in mm.
    fn over(&self, centre: Vec2, pitch: Vec2, mut visit: impl FnMut(i64, i64, f32)) {
        if !centre.is_finite() {
            return;
        }
        let edge = edge_of(pitch);
        let reach = Vec2::splat(self.radius + edge) / pitch;
        let (low, high) = ((centre - reach).floor(), (centre + reach).floor());
        // A fibre thinner than a voxel fills only a part of it.
        let thin = (self.radius / edge).min(1.0) * self.share;
        for b in low.y as i64..=high.y as i64 {
            for a in low.x as i64..=high.x as i64 {
                let offset = (Vec2::new(a as f32 + 0.5, b as f32 + 0.5) - centre) * pitch;
                let weight =
                    ((self.radius + edge - offset.length()) / (2.0 * edge)).clamp(0.0, 1.0) * thin;
                if weight > 0.0 {
                    visit(a, b, weight);
                }
            }
        }
    }

    fn add(&self, sums: &mut Sums, weight: f32) {
        let t = self.direction;
        sums.fill += weight;
        for (sum, product) in sums.moments.iter_mut().zip([
            t.x * t.x,
            t.y * t.y,
            t.z * t.z,
            t.x * t.y,
            t.x * t.z,
            t.y * t.z,
        ]) {
            *sum += weight * product;
        }
        if weight > sums.strongest {
            (sums.strongest, sums.yarn, sums.weft) = (weight, self.yarn, self.weft);
        }
    }
}

/// Width of a splat's soft edge on each side of its rim: half a voxel.
fn edge_of(pitch: Vec2) -> f32 {
    0.5 * (pitch.x + pitch.y) * 0.5
}

/// What a splat's weights have to be multiplied by so that they sum to as much as at
/// level 0, where voxels are thinner than a fibre.
fn share_of(direction: Direction, radius: f32, grid: &VoxelGrid) -> f32 {
    if grid.level == 0 {
        return 1.0;
    }
    let across = match direction {
        Direction::Warp => 0,
        Direction::Weft => 1,
    };
    // The weights over a plane make a disc with a soft rim; on thick voxels, a cone.
    let section = |edge: f32| {
        if radius >= edge {
            radius * radius + edge * edge / 3.0
        } else {
            (radius + edge).powi(3) / (6.0 * edge) * (radius / edge)
        }
    };
    let fine = grid.pitch() / Vec2::from(grid.fine().map(|side| side as f32));
    let fine = edge_of(Vec2::new(fine[across], (fine.x * fine.y).sqrt()));
    let edge = edge_of(Vec2::new(grid.voxel_mm[across], grid.voxel_mm.z));
    section(fine) / section(edge)
}

impl Sums {
    fn pack(&self) -> PackedVoxel {
        if self.fill < 1.0 / 510.0 {
            return PackedVoxel(0);
        }
        let (direction, _) = principal_axis(self.moments);
        PackedVoxel::new(self.fill, direction, self.yarn, self.weft)
    }

    fn pack_apart(&self) -> (PackedVoxel, Lobes) {
        if self.fill < 1.0 / 510.0 {
            return (PackedVoxel(0), Lobes::default());
        }
        let (direction, lobes) = Lobes::new(self.moments);
        (
            PackedVoxel::new(self.fill, direction, self.yarn, self.weft),
            lobes,
        )
    }
}

/// Principal axis of a symmetric matrix (xx, yy, zz, xy, xz, yz) by power iteration, and
/// the share of the trace that lies outside it.
pub(crate) fn principal_axis(m: [f32; 6]) -> (Vec3, f32) {
    let times = |v: Vec3| {
        Vec3::new(
            m[0] * v.x + m[3] * v.y + m[4] * v.z,
            m[3] * v.x + m[1] * v.y + m[5] * v.z,
            m[4] * v.x + m[5] * v.y + m[2] * v.z,
        )
    };
    // Start from the longest column: never orthogonal to the axis.
    let columns = [
        Vec3::new(m[0], m[3], m[4]),
        Vec3::new(m[3], m[1], m[5]),
        Vec3::new(m[4], m[5], m[2]),
    ];
    let start = if m[0] >= m[1] && m[0] >= m[2] {
        0
    } else if m[1] >= m[2] {
        1
    } else {
        2
    };
    let mut axis = columns[start].try_normalize().unwrap_or(Vec3::Z);
    // One fibre alone is its own axis at once; crossing ones take a few steps.
    for _ in 0..6 {
        let next = times(axis).try_normalize().unwrap_or(axis);
        let settled = next.dot(axis) > 1.0 - 1e-6;
        axis = next;
        if settled {
            break;
        }
    }
    let trace = m[0] + m[1] + m[2];
    let outside = if trace > 0.0 {
        1.0 - axis.dot(times(axis)) / trace
    } else {
        0.0
    };
    (axis, outside.clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::design::{Family, WeavePattern};

    #[test]
    fn principal_axis_of_a_known_matrix() {
        let axis = Vec3::new(2.0, -1.0, 2.0) / 3.0;
        let outer = |t: Vec3, w: f32| {
            [
                t.x * t.x,
                t.y * t.y,
                t.z * t.z,
                t.x * t.y,
                t.x * t.z,
                t.y * t.z,
            ]
            .map(|v| v * w)
        };
        let side = Vec3::new(1.0, 2.0, 0.0).normalize_or_zero();
        let (strong, weak) = (outer(axis, 0.9), outer(side, 0.1));
        let mut sum = [0.0; 6];
        for i in 0..6 {
            sum[i] = strong[i] + weak[i];
        }
        let (found, outside) = principal_axis(sum);
        assert!(found.dot(axis).abs() > 0.9999);
        assert!((outside - 0.1).abs() < 1e-3);
        // t and −t are one direction: their plain mean would vanish.
        let (found, outside) = principal_axis(outer(axis, 2.0));
        assert!(found.dot(axis).abs() > 0.9999 && outside < 1e-5);
    }

    #[test]
    fn a_yarn_s_fibre_volume_is_kept() {
        // One straight warp and weft far apart: total fill = fibres × section × length.
        let pattern = WeavePattern::from_fn(4, 4, |e, p| (e + p) % 2 == 0);
        let recipe = YarnRecipe {
            packing: 0.25,
            ..YarnRecipe::family(Family::Linen, 0.24)
        };
        let weave = WeaveGeometry::new(&pattern, &recipe, &recipe, Vec2::splat(0.48), 1);
        let grid = VoxelGrid {
            block: [80, 80, 120],
            voxel_mm: Vec3::splat(0.006),
            level: 0,
        };
        let volume = voxelise(&weave, &recipe, &recipe, &grid, 1, &Job::new()).unwrap();
        let mut fill = 0.0;
        for z in 0..120 {
            for y in 0..320 {
                for x in 0..320 {
                    fill += f64::from(volume.get(x, y, z).fill()) / 255.0;
                }
            }
        }
        let measured = fill * 0.006f64.powi(3);
        let fibre = std::f64::consts::PI * (0.5e-3 * f64::from(recipe.fibre_um)).powi(2);
        let straight = fibre * FibreLayout::new(&recipe).len() as f64 * 4.0 * 0.48 * 4.0 * 2.0;
        // Crimp makes fibres longer; overlaps saturate.
        assert!(
            (0.85..1.25).contains(&(measured / straight)),
            "{measured} against {straight}"
        );
    }
}
