//! Which effects a picture has, chosen once and by type: sky, shadows, backing.
//!
//! [`with_path`] looks at the settings and hands a [`Path`] of the fitting type to the
//! work that follows paths, so that nothing that is off is asked about along the way.

use super::path::{Path, Plane};
use super::settings::{Backing, RenderSettings};
use super::stack::Stack;
use super::track::Scatterer;
use crate::scene::environment::{Dark, Environment};
use crate::scene::light::{LightRig, Sky};

/// Work that needs to follow paths, whatever their type.
pub trait WithPath {
    /// What the work gives.
    type Output;

    /// Does the work with a path of the chosen type.
    fn run<S: Scatterer, E: Environment, const SHADOWS: bool, const PLANE: bool>(
        self,
        path: &Path<'_, S, E, SHADOWS, PLANE>,
    ) -> Self::Output;
}

/// Albedo of the white backing sheet.
const WHITE: f32 = 0.95;

/// Does `work` with the paths of these settings. `from_below`: the viewer is on the −z
/// side, and what backs the cloth is on the other.
pub fn with_path<S: Scatterer, W: WithPath>(
    scatterer: &S,
    lights: &LightRig,
    settings: &RenderSettings,
    from_below: bool,
    work: W,
) -> W::Output {
    let choice = Choice {
        lights,
        settings,
        from_below,
    };
    match settings.backing {
        Backing::None => choice.sky::<S, W, false>(scatterer, 0.0, work),
        Backing::White => choice.sky::<S, W, true>(scatterer, WHITE, work),
        Backing::Black => choice.sky::<S, W, true>(scatterer, 0.0, work),
        Backing::Itself => {
            let slide = settings.backing_slide_mm.into();
            let stack = Stack::behind(scatterer, settings.backing_layers, slide, from_below);
            choice.sky::<_, W, false>(&stack, 0.0, work)
        }
    }
}

struct Choice<'s> {
    lights: &'s LightRig,
    settings: &'s RenderSettings,
    from_below: bool,
}

impl Choice<'_> {
    fn sky<S: Scatterer, W: WithPath, const PLANE: bool>(
        &self,
        scatterer: &S,
        sheet: f32,
        work: W,
    ) -> W::Output {
        let sky = if self.settings.sky {
            &self.lights.sky
        } else {
            &Sky::Dark
        };
        match sky {
            Sky::Dark => self.shadows::<S, Dark, W, PLANE>(scatterer, &Dark, sheet, work),
            Sky::Dome(dome) => self.shadows::<S, _, W, PLANE>(scatterer, dome, sheet, work),
            Sky::Image(image) => self.shadows::<S, _, W, PLANE>(scatterer, &**image, sheet, work),
        }
    }

    fn shadows<S: Scatterer, E: Environment, W: WithPath, const PLANE: bool>(
        &self,
        scatterer: &S,
        environment: &E,
        sheet: f32,
        work: W,
    ) -> W::Output {
        if self.settings.shadows {
            work.run(&self.path::<S, E, true, PLANE>(scatterer, environment, sheet))
        } else {
            work.run(&self.path::<S, E, false, PLANE>(scatterer, environment, sheet))
        }
    }

    fn path<'a, S: Scatterer, E: Environment, const SHADOWS: bool, const PLANE: bool>(
        &'a self,
        scatterer: &'a S,
        environment: &'a E,
        sheet: f32,
    ) -> Path<'a, S, E, SHADOWS, PLANE> {
        let bounds = scatterer.bounds();
        let (z, facing) = if self.from_below {
            (bounds.max.z, -1.0)
        } else {
            (bounds.min.z, 1.0)
        };
        Path {
            scatterer,
            suns: &self.lights.suns,
            environment,
            turn: self.lights.sky_turn(),
            plane: Plane {
                z,
                facing,
                albedo: sheet,
            },
            max_order: self.settings.max_order,
            roulette_order: self.settings.roulette_order,
            shadow_roulette: self.settings.shadow_roulette.max(0.0),
            background: self.settings.background,
        }
    }
}
