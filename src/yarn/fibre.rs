//! Where the fibres of a yarn run: packing, plies, twist and migration.
//!
//! A ply's section is a hexagonal packing, which a sixth of a turn maps onto itself, and
//! all plies of a yarn share one layout: so the twist needs only a whole number of sixths
//! (singles) or halves (two plies) of a turn on an exemplar's repeat to close, and the
//! yarn's own twist is kept nearly exactly.

use std::f32::consts::TAU;

use glam::{Vec2, Vec3};

use super::geometry::{WeaveGeometry, twist_angle};
use super::noise::{crossing_window, hash, signed, unit};
use super::recipe::YarnRecipe;
use crate::design::Direction;

/// Every yarn of a recipe shares one layout, so that its fibres meet at block borders.
const LAYOUT_SEED: u64 = 0x70_6963_6b67;

/// Places of a fibre in its ply's section, unit disc.
#[derive(Debug, Clone)]
pub struct FibreLayout {
    places: Vec<Vec2>,
    plies: u32,
    /// Turns of a ply's layout that map it onto itself, per turn.
    symmetry: u32,
}

impl FibreLayout {
    /// Packs a recipe's fibres into its plies.
    pub fn new(recipe: &YarnRecipe) -> Self {
        let per_ply = (recipe.fibres() / recipe.plies.max(1)).max(7) as f32;
        // A hexagonal lattice of spacing a holds π/(a²·√3/2) points in the unit disc.
        let spacing = (TAU / 2.0 / (per_ply * 3f32.sqrt() / 2.0)).sqrt();
        let reach = (1.0 / spacing).ceil() as i32 + 1;
        // One sixth of it is laid with some disorder, and turned six times.
        let mut places = vec![Vec2::ZERO];
        for row in 0..=reach {
            for column in 1..=2 * reach {
                let number = (row * 4 * reach + column) as u64;
                let disorder = 0.3
                    * spacing
                    * Vec2::new(
                        signed(LAYOUT_SEED, 2 * number),
                        signed(LAYOUT_SEED, 2 * number + 1),
                    );
                let place = spacing
                    * Vec2::new(
                        column as f32 + 0.5 * row as f32,
                        row as f32 * 3f32.sqrt() / 2.0,
                    );
                if place.length() <= 0.97 {
                    places.extend((0..6).map(|turn| {
                        Vec2::from_angle(TAU * turn as f32 / 6.0).rotate(place + disorder)
                    }));
                }
            }
        }
        Self {
            places,
            plies: recipe.plies.max(1),
            symmetry: 6,
        }
    }

    /// Fibres of the whole yarn.
    pub fn len(&self) -> usize {
        self.places.len() * self.plies as usize
    }

    /// True when the layout holds no fibre, which a checked recipe never gives.
    pub fn is_empty(&self) -> bool {
        self.places.is_empty()
    }
}

/// Traces fibre number `fibre` of a yarn through `planes` equally spaced places along one
/// repeat. Positions are in mm and not wrapped; `out` holds one point a plane.
#[allow(
    clippy::too_many_arguments,
    reason = "what is traced, where, and where to"
)]
pub fn trace(
    weave: &WeaveGeometry,
    recipe: &YarnRecipe,
    layout: &FibreLayout,
    direction: Direction,
    index: usize,
    fibre: usize,
    seed: u64,
    out: &mut [Vec3],
) {
    let yarn = &weave.yarns(direction)[index];
    let crossings = match direction {
        Direction::Warp => weave.weft.len(),
        Direction::Weft => weave.warp.len(),
    };
    let ply = (fibre / layout.places.len()) as f32;
    let place = layout.places[fibre % layout.places.len()];
    let seed = hash(
        hash(
            seed,
            (direction == Direction::Warp) as u64 + 2 * index as u64,
        ),
        fibre as u64,
    );
    // Angles are measured from +across towards +z; that is a left-handed frame for the
    // warp and a right-handed one for the weft, and Z twist is a right-handed helix.
    let hand = match direction {
        Direction::Warp => -1.0,
        Direction::Weft => 1.0,
    };
    let planes = out.len();
    let radius = place.length();
    for (plane, point) in out.iter_mut().enumerate() {
        let fraction = (plane as f32 + 0.5) / planes as f32;
        let along = fraction * yarn.length_mm;
        let position = fraction * crossings as f32;
        let crossing = (position as u64).min(crossings as u64 - 1);
        let within = position - crossing as f32;
        let window = crossing_window(within);
        let noise = |what: u64| signed(seed, crossing * 16 + what);
        let sway = 2.0 * within - 1.0;

        // Migration: the fibre wanders in its section inside each crossing.
        let wander = recipe.migration * window;
        let mut section = place
            + wander
                * Vec2::new(
                    noise(0) + 1.5 * noise(1) * sway,
                    noise(2) + 1.5 * noise(3) * sway,
                );
        // Loose fibres of the outer layer stand off the surface.
        if radius > 0.8 && unit(hash(seed, crossing * 16 + 4)) < recipe.looseness {
            section *= 1.0 + 0.22 * window * unit(hash(seed, crossing * 16 + 5));
        }

        let singles = hand * twist_angle(yarn, recipe.singles_twist, layout.symmetry, along);
        let mut section = Vec2::from_angle(singles).rotate(section);
        if layout.plies > 1 {
            section = in_plies(section, layout.plies);
            let plied = hand
                * (twist_angle(yarn, recipe.ply_twist, layout.plies, along)
                    + TAU * yarn.phase(along));
            section = Vec2::from_angle(plied + TAU * ply / layout.plies as f32).rotate(section);
        } else {
            section = Vec2::from_angle(hand * TAU * yarn.phase(along)).rotate(section);
        }
        *point = weave.place(direction, index, along, section.x, section.y);
    }
}

/// Moves a point of a ply's unit disc into the first of `plies` plies of a yarn of radius
/// 1. Plies press flat against each other, so the inner side is squeezed.
fn in_plies(section: Vec2, plies: u32) -> Vec2 {
    let (offset, radius): (f32, f32) = if plies == 2 {
        (0.44, 0.56)
    } else {
        (0.54, 0.46)
    };
    let x = section.x
        * if section.x < 0.0 {
            offset.min(radius) * 0.97
        } else {
            radius
        };
    Vec2::new(offset + x, section.y * radius * 1.1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::design::{Family, WeavePattern};

    #[test]
    fn layouts_hold_the_recipe_s_fibres() {
        for family in [Family::Cotton, Family::Silk, Family::Wool, Family::Linen] {
            let recipe = YarnRecipe::family(family, 0.3);
            let (asked, laid) = (
                recipe.fibres() as f32,
                FibreLayout::new(&recipe).len() as f32,
            );
            assert!(
                (laid / asked - 1.0).abs() < 0.15,
                "{family:?}: asked {asked}, laid {laid}"
            );
        }
    }

    /// Mean slant dx/dy of the fibres on the face of a straight single warp yarn.
    fn face_slant(twist: f32) -> f32 {
        let all_up = WeavePattern::from_fn(1, 1, |_, _| true);
        let recipe = YarnRecipe {
            plies: 1,
            singles_twist: twist,
            migration: 0.0,
            ..YarnRecipe::family(Family::Linen, 0.3)
        };
        let weave = WeaveGeometry::new(&all_up, &recipe, &recipe, Vec2::splat(2.0), 1);
        let layout = FibreLayout::new(&recipe);
        let mut points = vec![Vec3::ZERO; 200];
        let (mut slant, mut count) = (0.0, 0.0);
        for fibre in 0..layout.len() {
            trace(
                &weave,
                &recipe,
                &layout,
                Direction::Warp,
                0,
                fibre,
                3,
                &mut points,
            );
            let top = points.iter().map(|p| p.z).fold(f32::MIN, f32::max);
            for pair in points.windows(2) {
                if pair[0].z > top - 0.02 {
                    slant += (pair[1].x - pair[0].x) / (pair[1].y - pair[0].y);
                    count += 1.0;
                }
            }
        }
        slant / count
    }

    #[test]
    fn z_twist_leans_like_the_letter() {
        assert!(face_slant(600.0) > 0.05, "Z: {}", face_slant(600.0));
        assert!(face_slant(-600.0) < -0.05, "S: {}", face_slant(-600.0));
    }
}
