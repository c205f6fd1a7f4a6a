//! One path: camera ray, collisions, light, roulette.
//!
//! At every scattering the suns are asked through shadow rays (next-event estimation), a
//! smooth sky is found by going on, and an environment picture by both ways, weighed
//! (MIS). What is off is off by type: [`Path`] takes the environment as a type and
//! shadows and backing as `const` parameters.

use glam::Vec3;
use std::f32::consts::PI;

use super::counters::Counters;
use super::medium::{Arrival, PLACE, SYSTEM};
use super::settings::Background;
use super::track::{SECOND, Scatterer};
use crate::film::{FirstHit, Sample};
use crate::random::Random;
use crate::scene::Ray;
use crate::scene::environment::{Environment, luminance};
use crate::scene::light::Sun;

/// A diffusing sheet behind the cloth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plane {
    /// Where it lies, mm.
    pub z: f32,
    /// +1 when its lit side faces +z, −1 when it faces −z.
    pub facing: f32,
    /// Lambertian albedo.
    pub albedo: f32,
}

impl Plane {
    /// Distance at which the ray meets the lit side; infinite if it does not.
    #[inline]
    fn distance(&self, ray: &Ray) -> f32 {
        if ray.direction.z * self.facing < 0.0 {
            ((self.z - ray.origin.z) / ray.direction.z).max(0.0)
        } else {
            f32::INFINITY
        }
    }
}

/// Collects what a path brings: the picture wants the sum, the colour table wants it by
/// scattering order.
pub trait Tally {
    /// The albedo by which a path is dimmed at a collision.
    fn albedo<S: Scatterer>(&self, scatterer: &S, optics: u32) -> Vec3;
    /// Takes light that was scattered `order` times, by a sheet last or (0) not at all.
    fn add(&mut self, order: u32, light: Vec3);
    /// Takes light that a voxel scattered last.
    #[inline]
    fn add_from<S: Scatterer>(&mut self, _: &S, arrival: &Arrival, light: Vec3) {
        self.add(arrival.order, light);
    }
}

/// The sum over all orders.
#[derive(Debug, Clone, Copy, Default)]
pub struct Total(pub Vec3);

impl Tally for Total {
    #[inline]
    fn albedo<S: Scatterer>(&self, scatterer: &S, optics: u32) -> Vec3 {
        scatterer.albedo(optics)
    }

    #[inline]
    fn add(&mut self, _: u32, light: Vec3) {
        self.0 += light;
    }

    #[inline]
    fn add_from<S: Scatterer>(&mut self, scatterer: &S, arrival: &Arrival, light: Vec3) {
        self.0 += light * scatterer.gain(arrival);
    }
}

/// Light by order of scattering, for a medium of albedo 1.
#[derive(Debug, Clone, Default)]
pub struct ByOrder(pub Vec<f64>);

impl Tally for ByOrder {
    #[inline]
    fn albedo<S: Scatterer>(&self, _: &S, _: u32) -> Vec3 {
        Vec3::ONE
    }

    #[inline]
    fn add(&mut self, order: u32, light: Vec3) {
        if let Some(sum) = self.0.get_mut(order as usize) {
            *sum += f64::from(luminance(light));
        }
    }
}

/// Everything a path meets. `SHADOWS`: light is blocked on its way; `PLANE`: there is a
/// backing sheet.
#[derive(Debug)]
pub struct Path<'s, S, E, const SHADOWS: bool, const PLANE: bool> {
    /// What scatters.
    pub scatterer: &'s S,
    /// Far lights.
    pub suns: &'s [Sun],
    /// Light from around.
    pub environment: &'s E,
    /// (1, 1, 1), or what turns a cloth direction into one of the environment.
    pub turn: Vec3,
    /// The backing sheet; only looked at where `PLANE`.
    pub plane: Plane,
    /// Longest path, in scatterings.
    pub max_order: u32,
    /// First order at which roulette is played.
    pub roulette_order: u32,
    /// Radiance below which shadow rays play roulette.
    pub shadow_roulette: f32,
    /// What a camera ray that meets nothing brings.
    pub background: Background,
}

/// What scatters light at a vertex of a path.
#[derive(Clone, Copy)]
enum Vertex {
    /// A fibre, its optics, and whether the path has met both systems of yarns.
    Fibre(super::sggx::Fibre, u32, bool),
    Sheet(f32),
}

impl Vertex {
    /// Share of the light from `wo` that goes to `wi`, 1/sr (the cosine included).
    #[inline]
    fn value(&self, wi: Vec3, wo: Vec3) -> f32 {
        match self {
            Self::Fibre(fibre, ..) => fibre.phase(wi, wo),
            Self::Sheet(facing) => (wo.z * facing).max(0.0) / PI,
        }
    }

    /// Gives `tally` light of an order that came from `wo` and goes on to `wi`.
    #[inline]
    fn pass<S: Scatterer, T: Tally>(
        &self,
        scatterer: &S,
        [wi, wo]: [Vec3; 2],
        order: u32,
        light: Vec3,
        tally: &mut T,
    ) {
        match *self {
            Self::Fibre(fibre, optics, mixed) => {
                let arrival = Arrival {
                    order,
                    mixed,
                    optics,
                    fibre: fibre.direction,
                    alpha: fibre.alpha,
                    to_eye: wi,
                    to_light: wo,
                };
                tally.add_from(scatterer, &arrival, light);
            }
            Self::Sheet(_) => tally.add(order, light),
        }
    }

    /// A direction drawn by [`Vertex::value`], weight 1.
    #[inline]
    fn sample(&self, wi: Vec3, u: [f32; 2]) -> Vec3 {
        match self {
            Self::Fibre(fibre, ..) => fibre.sample(wi, u),
            Self::Sheet(facing) => {
                let (x, y) = crate::random::disk(u);
                let z = (1.0 - x * x - y * y).max(1e-6).sqrt();
                Vec3::new(x, y, z * facing).normalize_or(Vec3::Z)
            }
        }
    }
}

impl<S: Scatterer, E: Environment, const SHADOWS: bool, const PLANE: bool>
    Path<'_, S, E, SHADOWS, PLANE>
{
    /// Follows one path from the camera and gives its light to `tally`.
    #[inline]
    pub fn trace<T: Tally>(
        &self,
        mut ray: Ray,
        tally: &mut T,
        random: &mut Random,
        counters: &mut Counters,
    ) -> Sample {
        counters.paths += 1;
        let mut sample = Sample::default();
        let mut throughput = Vec3::ONE;
        let mut order = 0u32;
        // Density with which the present direction was drawn; infinite for the camera's.
        let mut density = f32::INFINITY;
        // The system of yarns that scattered first, and whether another has since.
        let (mut system, mut mixed) = (None, false);
        // What scattered last, and from where it was come upon.
        let mut last: Option<(Vertex, Vec3)> = None;
        loop {
            // Free flight: to a fibre, to the sheet behind the cloth, or out of everything.
            let sheet = if PLANE {
                self.plane.distance(&ray)
            } else {
                f32::INFINITY
            };
            let (point, vertex) = match self.scatterer.collide(&ray, sheet, random, counters) {
                // A walk that was given up counts as absorbed.
                Some(hit) if hit.absorbed => {
                    if order == 0 {
                        sample.alpha = 1.0;
                    }
                    break;
                }
                // A fibre: its dye takes its share, and its yarn is remembered.
                Some(hit) => {
                    let albedo = tally.albedo(self.scatterer, hit.voxel.optics);
                    if order == 0 {
                        sample.alpha = 1.0;
                        sample.first = Some(first_hit(&ray, &hit, albedo));
                    }
                    throughput *= albedo;
                    let of = hit.voxel.optics & SYSTEM;
                    mixed |= *system.get_or_insert(of) != of;
                    (
                        ray.at(hit.t),
                        Vertex::Fibre(hit.voxel.fibre(), hit.voxel.optics, mixed),
                    )
                }
                // The sheet: a diffuser, or black.
                None if sheet < f32::INFINITY => {
                    sample.alpha = 1.0;
                    if self.plane.albedo == 0.0 {
                        break;
                    }
                    throughput *= self.plane.albedo;
                    let mut point = ray.at(sheet);
                    point.z = self.plane.z;
                    (point, Vertex::Sheet(self.plane.facing))
                }
                // Out: the camera sees the background; a scattered path brings home the sky, by
                // its share against having chosen that direction in the sky (Veach 1997).
                None => {
                    let Some((vertex, wi)) = last else {
                        self.add_background(&ray, tally, &mut sample);
                        break;
                    };
                    if E::LIT {
                        let towards = ray.direction * self.turn;
                        let weight = if E::SAMPLED {
                            power(density, self.environment.density(towards))
                        } else {
                            1.0
                        };
                        let light = self.environment.radiance(towards);
                        let light = throughput * light * weight;
                        vertex.pass(self.scatterer, [wi, ray.direction], order, light, tally);
                    }
                    break;
                }
            };
            // One scattering more, if the order allows it.
            if order == self.max_order {
                break;
            }
            order += 1;
            counters.scatterings += 1;
            // Direct light of this scattering: the suns, and a direction chosen in the sky.
            let wi = -ray.direction;
            self.light_from_suns(
                point, &vertex, wi, throughput, order, tally, random, counters,
            );
            if E::SAMPLED {
                self.light_from_picture(
                    point, &vertex, wi, throughput, order, tally, random, counters,
                );
            }
            // Russian roulette by what the path can still bring.
            if order >= self.roulette_order {
                let survival = throughput.max_element().min(1.0);
                if random.uniform() >= survival {
                    break;
                }
                throughput /= survival;
            }
            // The next direction, and with which density it was drawn.
            let wo = vertex.sample(wi, random.pair());
            if E::SAMPLED {
                density = vertex.value(wi, wo);
            } else if !E::LIT && order == self.max_order {
                break;
            }
            last = Some((vertex, wi));
            ray = Ray {
                origin: point,
                direction: wo,
            };
        }
        sample
    }

    fn add_background<T: Tally>(&self, ray: &Ray, tally: &mut T, sample: &mut Sample) {
        match self.background {
            Background::Transparent => {}
            Background::Sky => {
                sample.alpha = 1.0;
                tally.add(0, self.environment.radiance(ray.direction * self.turn));
            }
            Background::Colour(colour) => {
                sample.alpha = 1.0;
                tally.add(0, colour);
            }
        }
    }

    #[inline]
    #[allow(
        clippy::too_many_arguments,
        reason = "the state of a path, inlined into its loop"
    )]
    fn light_from_suns<T: Tally>(
        &self,
        point: Vec3,
        vertex: &Vertex,
        wi: Vec3,
        throughput: Vec3,
        order: u32,
        tally: &mut T,
        random: &mut Random,
        counters: &mut Counters,
    ) {
        for sun in self.suns {
            let wo = if sun.angular_radius > 0.0 {
                sun.sample(random.pair())
            } else {
                sun.towards
            };
            let light = throughput * sun.irradiance * vertex.value(wi, wo);
            let shade = self.unblocked(point, wo, luminance(light), random, counters);
            if shade > 0.0 {
                vertex.pass(self.scatterer, [wi, wo], order, light * shade, tally);
            }
        }
    }

    #[inline]
    #[allow(
        clippy::too_many_arguments,
        reason = "the state of a path, inlined into its loop"
    )]
    fn light_from_picture<T: Tally>(
        &self,
        point: Vec3,
        vertex: &Vertex,
        wi: Vec3,
        throughput: Vec3,
        order: u32,
        tally: &mut T,
        random: &mut Random,
        counters: &mut Counters,
    ) {
        let Some(drawn) = self.environment.sample(random.pair()) else {
            return;
        };
        let wo = drawn.direction * self.turn;
        let value = vertex.value(wi, wo);
        let weight = power(drawn.density, value) / drawn.density;
        let light = throughput * drawn.radiance * (value * weight);
        let shade = self.unblocked(point, wo, luminance(light), random, counters);
        if shade > 0.0 {
            vertex.pass(self.scatterer, [wi, wo], order, light * shade, tally);
        }
    }

    /// How much of some light arrives from `towards`; light that matters little plays
    /// roulette first.
    #[inline]
    fn unblocked(
        &self,
        point: Vec3,
        towards: Vec3,
        light: f32,
        random: &mut Random,
        counters: &mut Counters,
    ) -> f32 {
        if light.is_nan() {
            // Goes on to be counted by the film.
            return 1.0;
        }
        if light <= 0.0 {
            return 0.0;
        }
        let ray = Ray {
            origin: point,
            direction: towards,
        };
        if PLANE && self.plane.distance(&ray) < f32::INFINITY {
            return 0.0;
        }
        if !SHADOWS {
            return 1.0;
        }
        let below = self.shadow_roulette / light;
        let boost = below.max(1.0);
        if boost > 1.0 && random.uniform() * boost >= 1.0 {
            return 0.0;
        }
        counters.shadow_rays += 1;
        boost
            * self
                .scatterer
                .transmittance(&ray, f32::INFINITY, below.min(1.0), random, counters)
    }
}

/// The power heuristic for one sample of each of two densities; an infinite own density
/// wins.
#[inline]
fn power(own: f32, other: f32) -> f32 {
    let ratio = other / own;
    1.0 / (1.0 + ratio * ratio)
}

#[inline]
fn first_hit(ray: &Ray, hit: &super::track::Collision, albedo: Vec3) -> FirstHit {
    let towards_viewer = -ray.direction;
    let fibre = hit.voxel.direction;
    FirstHit {
        albedo,
        normal: (towards_viewer - fibre * towards_viewer.dot(fibre)).normalize_or(towards_viewer),
        depth: hit.t,
        optics: hit.voxel.optics & !(SECOND | PLACE),
    }
}
