//! Copies of one scatterer laid on each other: the cloth as its own backing, and the
//! opaque pile on which colours are measured.

use glam::Vec3;

use super::counters::Counters;
use super::medium::Arrival;
use super::track::{Collision, Scatterer};
use crate::random::Random;
use crate::scene::{Bounds, Ray};

/// Copies of a scatterer, the top one in its own place and the others below it.
///
/// Layers do not overlap as long as `spacing_mm` is at least the thickness, so the
/// layers are visited in the order of the ray and the first collision is the nearest.
#[derive(Debug, Clone)]
pub struct Stack<'s, S> {
    layer: &'s S,
    /// Shift of each layer against the original, mm, from the top layer to the lowest.
    offsets: Vec<Vec3>,
}

impl<'s, S: Scatterer> Stack<'s, S> {
    /// `layers` copies (at least one) as close as their bounds allow, each shifted by
    /// `slide_mm` in x and y against the one above.
    pub fn new(layer: &'s S, layers: u32, slide_mm: glam::Vec2) -> Self {
        let bounds = layer.bounds();
        let thickness = bounds.max.z - bounds.min.z;
        let spacing = if thickness.is_finite() {
            thickness.max(0.0)
        } else {
            0.0
        };
        let offsets = (0..layers.max(1))
            .map(|k| (slide_mm * k as f32).extend(-spacing * k as f32))
            .collect();
        Self { layer, offsets }
    }

    /// The scatterer with `layers − 1` copies behind it (below, or above when
    /// `from_below`: seen from the back), each slid by `slide_mm`, so that gaps do not
    /// line up.
    pub fn behind(layer: &'s S, layers: u32, slide_mm: glam::Vec2, from_below: bool) -> Self {
        let mut stack = Self::new(layer, layers, slide_mm);
        if from_below {
            for offset in &mut stack.offsets {
                offset.z = -offset.z;
            }
            stack.offsets.reverse();
        }
        stack
    }

    /// Layers in the order in which the ray meets them.
    #[inline]
    fn in_order(&self, ray: &Ray) -> impl Iterator<Item = Vec3> + '_ {
        let down = ray.direction.z <= 0.0;
        let n = self.offsets.len();
        (0..n).map(move |k| self.offsets[if down { k } else { n - 1 - k }])
    }
}

/// The ray as a layer shifted by `offset` sees it.
#[inline]
fn shifted(ray: &Ray, offset: Vec3) -> Ray {
    Ray {
        origin: ray.origin - offset,
        direction: ray.direction,
    }
}

/// Whether the ray can still meet the slab `min..max` in z.
#[inline]
fn may_meet(ray: &Ray, bounds: &Bounds) -> bool {
    if ray.direction.z < 0.0 {
        ray.origin.z > bounds.min.z
    } else if ray.direction.z > 0.0 {
        ray.origin.z < bounds.max.z
    } else {
        true
    }
}

impl<S: Scatterer> Scatterer for Stack<'_, S> {
    fn bounds(&self) -> Bounds {
        let one = self.layer.bounds();
        let mut all = one;
        for &offset in &self.offsets {
            all.min = all.min.min(one.min + offset);
            all.max = all.max.max(one.max + offset);
        }
        all
    }

    fn collide(
        &self,
        ray: &Ray,
        t_max: f32,
        random: &mut Random,
        counters: &mut Counters,
    ) -> Option<Collision> {
        let bounds = self.layer.bounds();
        self.in_order(ray).find_map(|offset| {
            let ray = shifted(ray, offset);
            may_meet(&ray, &bounds)
                .then(|| self.layer.collide(&ray, t_max, random, counters))
                .flatten()
        })
    }

    fn transmittance(
        &self,
        ray: &Ray,
        t_max: f32,
        roulette_below: f32,
        random: &mut Random,
        counters: &mut Counters,
    ) -> f32 {
        let bounds = self.layer.bounds();
        let mut transmittance = 1.0;
        for offset in self.in_order(ray) {
            let ray = shifted(ray, offset);
            if may_meet(&ray, &bounds) {
                let below = (roulette_below / transmittance).min(1.0);
                transmittance *= self
                    .layer
                    .transmittance(&ray, t_max, below, random, counters);
                if transmittance == 0.0 {
                    break;
                }
            }
        }
        transmittance
    }

    fn albedo(&self, optics: u32) -> Vec3 {
        self.layer.albedo(optics)
    }

    #[inline]
    fn gain(&self, arrival: &Arrival) -> f32 {
        self.layer.gain(arrival)
    }
}
