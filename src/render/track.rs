//! Free flights and transmittance through a [`Medium`].
//!
//! Delta tracking (Woodcock 1965) for distances and ratio tracking (Novák 2014) with
//! roulette for transmittance, both through the majorant stretches of the medium. One
//! exponential optical depth is spent across stretches, which is the same process as
//! drawing anew in each (it has no memory) and needs fewer numbers.
//!
//! Extinction along ω is the voxel's `sigma` times the projected area σ(ω) ≤ 1 of its
//! flakes. Loops go on only while `t < end`, so that NaN ends them; every walk has a cap.

use glam::Vec3;

use super::counters::Counters;
use super::medium::{Arrival, MajorantWalk, Medium, Voxel};
use super::sggx::Fibre;
use crate::random::{Random, free_path};
use crate::scene::{Bounds, Ray};

/// Tentative collisions after which a walk is given up and counted. A walk through a
/// cloth needs tens, a grazing one hundreds; 2¹⁴ is reached only where the extinction is
/// absurd. Where it is, hardly any light passes: what is given up counts as absorbed.
pub const STEP_CAP: u32 = 1 << 14;

/// Where a flight ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Collision {
    /// Distance from the ray's origin, mm.
    pub t: f32,
    /// The medium there.
    pub voxel: Voxel,
    /// The walk was given up there (see [`STEP_CAP`]): nothing is scattered.
    pub absorbed: bool,
}

impl Voxel {
    /// The flakes of this voxel.
    #[inline]
    pub fn fibre(&self) -> Fibre {
        Fibre::new(self.direction, self.alpha)
    }
}

/// Anything light flies through and scatters in: a [`Medium`], two of them in the same
/// place, a stack of copies.
pub trait Scatterer: Sync {
    /// Everything outside is empty.
    fn bounds(&self) -> Bounds;

    /// The first collision with 0 ≤ t < `t_max` (mm, may be infinite), or `None`.
    fn collide(
        &self,
        ray: &Ray,
        t_max: f32,
        random: &mut Random,
        counters: &mut Counters,
    ) -> Option<Collision>;

    /// An unbiased estimate of the transmittance over 0 ≤ t < `t_max`. Below
    /// `roulette_below` the estimate plays roulette: 0 = never (pure ratio tracking),
    /// 1 = always (the answer is 0 or 1).
    fn transmittance(
        &self,
        ray: &Ray,
        t_max: f32,
        roulette_below: f32,
        random: &mut Random,
        counters: &mut Counters,
    ) -> f32;

    /// Single-scattering albedo (linear RGB) of an optics id that a voxel carried.
    fn albedo(&self, optics: u32) -> Vec3;

    /// As [`Medium::gain`].
    #[inline]
    fn gain(&self, _: &Arrival) -> f32 {
        1.0
    }
}

/// A ray worth walking: finite origin, unit direction, an end that is a number.
#[inline]
fn is_sound(ray: &Ray, t_max: f32) -> bool {
    let unit = (ray.direction.length_squared() - 1.0).abs() < 1e-3;
    unit && ray.origin.length_squared() < f32::MAX && !t_max.is_nan()
}

/// σ(ω)² in the short form, right to 1e-7 absolutely.
#[inline(always)]
fn area_squared(voxel: &Voxel, direction: Vec3) -> f32 {
    let cosine = direction.dot(voxel.direction);
    let smooth = 1.0 - voxel.alpha * voxel.alpha;
    (1.0 - smooth * cosine * cosine).max(0.0)
}

impl<M: Medium> Scatterer for M {
    fn bounds(&self) -> Bounds {
        Medium::bounds(self)
    }

    fn collide(
        &self,
        ray: &Ray,
        t_max: f32,
        random: &mut Random,
        counters: &mut Counters,
    ) -> Option<Collision> {
        if !is_sound(ray, t_max) {
            counters.invalid_rays += 1;
            return None;
        }
        let mut walk = self.walk(ray, t_max);
        let mut depth = free_path(random.uniform());
        let mut steps = 0;
        while let Some(stretch) = walk.next_stretch() {
            let mean_free_path = 1.0 / stretch.majorant;
            let mut t = stretch.start;
            loop {
                // Spend the optical depth; what the stretch cannot take is carried on.
                let next = t + depth * mean_free_path;
                let within = next < stretch.end;
                if !within {
                    depth = (depth - (stretch.end - t) * stretch.majorant).max(0.0);
                    break;
                }
                t = next;
                let tap = random.tap();
                let [accept, flight] = random.pair();
                // Projected areas are at most 1: less than this cannot be accepted.
                let voxel = walk.voxel(t, tap, accept * stretch.majorant);
                steps += 1;
                if voxel.sigma > 0.0 {
                    let share = voxel.sigma * mean_free_path;
                    counters.majorant_violations += u64::from(share > 1.0 + 1e-5);
                    let area2 = area_squared(&voxel, ray.direction);
                    if accept * accept < share * share * area2 {
                        counters.lookups += u64::from(steps);
                        return Some(Collision {
                            t,
                            voxel,
                            absorbed: false,
                        });
                    }
                }
                if steps >= STEP_CAP {
                    counters.capped_walks += 1;
                    counters.lookups += u64::from(steps);
                    return Some(Collision {
                        t,
                        voxel,
                        absorbed: true,
                    });
                }
                depth = free_path(flight);
            }
        }
        counters.lookups += u64::from(steps);
        None
    }

    fn transmittance(
        &self,
        ray: &Ray,
        t_max: f32,
        roulette_below: f32,
        random: &mut Random,
        counters: &mut Counters,
    ) -> f32 {
        if !is_sound(ray, t_max) {
            counters.invalid_rays += 1;
            return 0.0;
        }
        let mut walk = self.walk(ray, t_max);
        let mut depth = free_path(random.uniform());
        let mut steps = 0;
        let mut transmittance = 1.0f32;
        'walk: while let Some(stretch) = walk.next_stretch() {
            let mean_free_path = 1.0 / stretch.majorant;
            let mut t = stretch.start;
            loop {
                let next = t + depth * mean_free_path;
                let within = next < stretch.end;
                if !within {
                    depth = (depth - (stretch.end - t) * stretch.majorant).max(0.0);
                    break;
                }
                t = next;
                let voxel = walk.voxel(t, random.tap(), 0.0);
                let [survive, flight] = random.pair();
                steps += 1;
                if voxel.sigma > 0.0 {
                    let share = voxel.sigma * mean_free_path;
                    counters.majorant_violations += u64::from(share > 1.0 + 1e-5);
                    let area = area_squared(&voxel, ray.direction).sqrt();
                    transmittance *= (1.0 - share * area).max(0.0);
                    if transmittance < roulette_below {
                        // Go on with probability T/threshold, at the threshold.
                        if survive * roulette_below >= transmittance {
                            transmittance = 0.0;
                            break 'walk;
                        }
                        transmittance = roulette_below;
                    }
                    if transmittance == 0.0 {
                        break 'walk;
                    }
                }
                if steps >= STEP_CAP {
                    counters.capped_walks += 1;
                    transmittance = 0.0;
                    break 'walk;
                }
                depth = free_path(flight);
            }
        }
        counters.lookups += u64::from(steps);
        transmittance
    }

    fn albedo(&self, optics: u32) -> Vec3 {
        Medium::albedo(self, optics)
    }

    #[inline]
    fn gain(&self, arrival: &Arrival) -> f32 {
        Medium::gain(self, arrival)
    }
}

/// No medium at all; with it, an absent layer costs nothing.
#[derive(Debug, Clone, Copy, Default)]
pub struct Nothing;

impl Scatterer for Nothing {
    fn bounds(&self) -> Bounds {
        Bounds {
            min: Vec3::splat(f32::INFINITY),
            max: Vec3::splat(f32::NEG_INFINITY),
        }
    }

    #[inline]
    fn collide(&self, _: &Ray, _: f32, _: &mut Random, _: &mut Counters) -> Option<Collision> {
        None
    }

    #[inline]
    fn transmittance(&self, _: &Ray, _: f32, _: f32, _: &mut Random, _: &mut Counters) -> f32 {
        1.0
    }

    fn albedo(&self, _: u32) -> Vec3 {
        Vec3::ZERO
    }
}

/// Two media in the same place, such as cloth and the hairs that stand off it.
///
/// They are sampled one after the other: the nearer collision is the first collision of
/// the sum of their extinctions, and transmittances multiply.
#[derive(Debug, Clone, Copy)]
pub struct Both<A, B>(pub A, pub B);

/// Set in the optics of what belongs to the second part of a [`Both`].
pub const SECOND: u32 = 1 << 31;

impl<A: Scatterer, B: Scatterer> Scatterer for Both<A, B> {
    fn bounds(&self) -> Bounds {
        let (a, b) = (self.0.bounds(), self.1.bounds());
        Bounds {
            min: a.min.min(b.min),
            max: a.max.max(b.max),
        }
    }

    fn collide(
        &self,
        ray: &Ray,
        t_max: f32,
        random: &mut Random,
        counters: &mut Counters,
    ) -> Option<Collision> {
        let first = self.0.collide(ray, t_max, random, counters);
        let nearer = first.map_or(t_max, |hit| hit.t);
        let second = self.1.collide(ray, nearer, random, counters);
        match second {
            Some(mut hit) => {
                hit.voxel.optics |= SECOND;
                Some(hit)
            }
            None => first,
        }
    }

    fn transmittance(
        &self,
        ray: &Ray,
        t_max: f32,
        roulette_below: f32,
        random: &mut Random,
        counters: &mut Counters,
    ) -> f32 {
        let first = self
            .0
            .transmittance(ray, t_max, roulette_below, random, counters);
        if first == 0.0 {
            return 0.0;
        }
        let below = (roulette_below / first).min(1.0);
        first * self.1.transmittance(ray, t_max, below, random, counters)
    }

    fn albedo(&self, optics: u32) -> Vec3 {
        if optics & SECOND != 0 {
            self.1.albedo(optics & !SECOND)
        } else {
            self.0.albedo(optics)
        }
    }

    #[inline]
    fn gain(&self, arrival: &Arrival) -> f32 {
        if arrival.optics & SECOND != 0 {
            self.1.gain(&Arrival {
                optics: arrival.optics & !SECOND,
                ..*arrival
            })
        } else {
            self.0.gain(arrival)
        }
    }
}
