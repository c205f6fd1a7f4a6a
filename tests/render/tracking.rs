//! Flights and transmittance against closed forms, and everything that may go wrong.

use crate::render_scenes::{shoot, silk_satin, wool_twill};
use glam::{UVec3, Vec3};
use pickglass::random::Random;
use pickglass::render::{
    Background, Both, Counters, MajorantWalk, Medium, Nothing, RenderSettings, Scatterer, Stack,
    Stretch, Voxel,
};
use pickglass::scene::{Bounds, Dome, EnvironmentImage, LightRig, Ray, Sky, View};
use pickglass::volume::{DenseGrid, GridVoxel, Optics, Taps, VolumeError};

const ALPHAS: [f32; 6] = [0.01, 0.05, 0.1, 0.3, 0.6, 1.0];

fn oblique() -> [Vec3; 6] {
    [
        Vec3::new(1.0, 2.0, 3.0),
        Vec3::new(-3.0, 1.0, 0.5),
        Vec3::new(0.2, -1.0, 4.0),
        Vec3::new(5.0, -0.3, -1.0),
        Vec3::new(-1.0, -1.0, -1.0),
        Vec3::new(0.02, 3.0, -0.9),
    ]
    .map(|v: Vec3| v.normalize_or(Vec3::Z))
}

/// A cube of `n`³ equal voxels, 1 mm wide, centred on the origin.
fn cube(n: u32, sigma: f32, direction: Vec3, alpha: f32, albedo: f32) -> DenseGrid {
    let bounds = Bounds {
        min: Vec3::splat(-0.5),
        max: Vec3::splat(0.5),
    };
    let optics = vec![Optics {
        albedo: Vec3::splat(albedo),
        alpha,
    }];
    let voxel = GridVoxel {
        sigma,
        direction,
        optics: 0,
    };
    DenseGrid::from_fn(UVec3::splat(n), bounds, optics, Taps::Nearest, |_| voxel).expect("sound")
}

fn ray(origin: Vec3, direction: Vec3) -> Ray {
    Ray { origin, direction }
}

/// Mean and standard error of a sampled quantity.
fn measure(n: u64, mut one: impl FnMut(&mut Random) -> f64) -> (f64, f64) {
    let (mut sum, mut squares) = (0.0, 0.0);
    for k in 0..n {
        let value = one(&mut Random::new(11, 0, k));
        sum += value;
        squares += value * value;
    }
    let n = n as f64;
    let mean = sum / n;
    (mean, ((squares / n - mean * mean).max(0.0) / n).sqrt())
}

#[test]
fn slab_transmittance_is_the_exponential() {
    let mut counters = Counters::default();
    for alpha in ALPHAS {
        for fibre in oblique() {
            let grid = cube(13, 2.0, fibre, alpha, 0.5);
            for towards in [Vec3::Z, Vec3::new(0.3, 0.2, -1.0).normalize_or(Vec3::Z)] {
                let start = ray(-towards * 3.0, towards);
                let cosine = fibre.dot(towards);
                let area = (1.0 - (1.0 - alpha * alpha) * cosine * cosine).sqrt();
                let length = 1.0 / towards.abs().max_element();
                let exact = f64::from((-2.0 * area * length).exp());
                for below in [0.0, 0.2, 1.0] {
                    let (mean, error) = measure(20_000, |random| {
                        f64::from(grid.transmittance(
                            &start,
                            f32::INFINITY,
                            below,
                            random,
                            &mut counters,
                        ))
                    });
                    assert!(
                        (mean - exact).abs() < 5.0 * error + 1e-5,
                        "{mean} {exact} ± {error}"
                    );
                }
                let (mean, error) = measure(20_000, |random| {
                    let hit = grid.collide(&start, f32::INFINITY, random, &mut counters);
                    f64::from(u8::from(hit.is_none()))
                });
                assert!(
                    (mean - exact).abs() < 5.0 * error + 1e-5,
                    "{mean} {exact} ± {error}"
                );
            }
        }
    }
    assert_eq!(counters.majorant_violations, 0);
    assert_eq!(counters.capped_walks + counters.invalid_rays, 0);
}

#[test]
fn two_media_add_and_a_stack_multiplies() {
    let mut counters = Counters::default();
    let (a, b) = (
        cube(8, 0.7, Vec3::Z, 1.0, 0.5),
        cube(5, 0.9, Vec3::X, 1.0, 0.25),
    );
    let both = Both(a.clone(), b);
    let start = ray(Vec3::new(0.1, 0.2, 3.0), Vec3::NEG_Z);
    let mut count = |scatterer: &dyn Fn(&mut Random, &mut Counters) -> f64| {
        measure(100_000, |random| scatterer(random, &mut counters))
    };
    let exact = (-1.6f64).exp();
    let (t, e) = count(&|r, c| f64::from(both.transmittance(&start, 9.0, 0.1, r, c)));
    assert!((t - exact).abs() < 5.0 * e, "{t} {exact}");
    let (t, e) = count(&|r, c| f64::from(u8::from(both.collide(&start, 9.0, r, c).is_none())));
    assert!((t - exact).abs() < 5.0 * e, "{t} {exact}");
    // Which of the two is hit goes by extinction.
    let (share, e) = count(&|r, c| match both.collide(&start, 9.0, r, c) {
        Some(hit) => f64::from(both.albedo(hit.voxel.optics).x == 0.25),
        None => 0.0,
    });
    let expected = (1.0 - exact) * 0.9 / 1.6;
    assert!((share - expected).abs() < 5.0 * e, "{share} {expected}");

    let stack = Stack::new(&a, 3, glam::Vec2::ZERO);
    let exact = (-2.1f64).exp();
    for start in [start, ray(Vec3::new(0.1, 0.2, -7.0), Vec3::Z)] {
        let (t, e) = count(&|r, c| f64::from(stack.transmittance(&start, 20.0, 0.3, r, c)));
        assert!((t - exact).abs() < 5.0 * e, "{t} {exact}");
        let (t, e) =
            count(&|r, c| f64::from(u8::from(stack.collide(&start, 20.0, r, c).is_none())));
        assert!((t - exact).abs() < 5.0 * e, "{t} {exact}");
    }
    let bounds = stack.bounds();
    assert_eq!((bounds.min.z, bounds.max.z), (-2.5, 0.5));

    let with_nothing = Both(a.clone(), Nothing);
    let mut one = Random::new(1, 2, 3);
    let mut two = one.clone();
    assert_eq!(
        with_nothing.collide(&start, 9.0, &mut one, &mut counters),
        a.collide(&start, 9.0, &mut two, &mut counters)
    );
}

/// Lowers the majorants of a medium below the truth.
struct Lowered<'g>(&'g DenseGrid, f32);
struct LoweredWalk<'g>(<DenseGrid as Medium>::Walk<'g>, f32);

impl Medium for Lowered<'_> {
    type Walk<'m>
        = LoweredWalk<'m>
    where
        Self: 'm;
    fn bounds(&self) -> Bounds {
        Medium::bounds(self.0)
    }
    fn walk(&self, ray: &Ray, t_max: f32) -> LoweredWalk<'_> {
        LoweredWalk(self.0.walk(ray, t_max), self.1)
    }
    fn albedo(&self, optics: u32) -> Vec3 {
        Medium::albedo(self.0, optics)
    }
}

impl MajorantWalk for LoweredWalk<'_> {
    fn next_stretch(&mut self) -> Option<Stretch> {
        let stretch = self.0.next_stretch()?;
        Some(Stretch {
            majorant: stretch.majorant * self.1,
            ..stretch
        })
    }
    fn voxel(&self, t: f32, tap: Vec3, least: f32) -> Voxel {
        self.0.voxel(t, tap, least)
    }
}

#[test]
fn majorants_hold_and_lowered_ones_are_noticed() {
    for taps in [Taps::Nearest, Taps::StochasticTrilinear] {
        let scene = wool_twill(6);
        let grid = scene.grid(taps);
        let camera = View::Oblique.camera(scene.bounds().max * 0.5, 1.5, 48, 48);
        let lights = LightRig::preset("day").expect("a preset");
        let settings = RenderSettings {
            spp: 8,
            ..RenderSettings::default()
        };
        let sound = shoot(&grid, &camera, &lights, &settings);
        assert_eq!(sound.counters.majorant_violations, 0);
        let lowered = shoot(&Lowered(&grid, 0.8), &camera, &lights, &settings);
        assert!(lowered.counters.majorant_violations > 0);
    }
}

#[test]
fn a_walk_at_its_cap_is_absorbed_and_told() {
    // Bounds a hundred million times too large cost steps without end.
    let grid = cube(8, 2.0, Vec3::Z, 1.0, 1.0);
    let slow = Lowered(&grid, 1e8);
    let mut counters = Counters::default();
    let start = ray(Vec3::new(0.1, 0.2, 3.0), Vec3::NEG_Z);
    let mut random = Random::new(1, 2, 3);
    let hit = slow.collide(&start, 9.0, &mut random, &mut counters);
    assert!(hit.is_some_and(|hit| hit.absorbed), "{hit:?}");
    let through = slow.transmittance(&start, 9.0, 0.0, &mut random, &mut counters);
    assert_eq!((through, counters.capped_walks), (0.0, 2));
    assert!(counters.warnings()[0].contains("absorbed: 2 on "));
    let lights = LightRig::new("dome", Vec::new(), Sky::Dome(Dome::uniform(Vec3::ONE)));
    let camera = View::Face.camera(Vec3::ZERO, 0.5, 4, 4);
    let settings = RenderSettings {
        spp: 2,
        ..RenderSettings::default()
    };
    let black = shoot(&slow, &camera, &lights, &settings);
    for pixel in black.film.pixels() {
        assert_eq!((pixel.mean(), pixel.alpha()), (Vec3::ZERO, 1.0));
    }
    assert_eq!(black.counters.capped_walks, 32);
    // Control: with bounds that are right nothing is given up.
    let sound = shoot(&grid, &camera, &lights, &settings);
    assert_eq!(sound.counters.capped_walks, 0);
    assert!(sound.counters.warnings().is_empty());
}

#[test]
fn scale_of_a_million_violates_nothing_and_ends() {
    let scene = silk_satin(4);
    let grid = scene.grid_with(Taps::Nearest, |voxel| GridVoxel {
        sigma: voxel.sigma * 1e6,
        ..voxel
    });
    let camera = scene.face_camera(0.8, 24, 24);
    let lights = LightRig::preset("day").expect("a preset");
    let settings = RenderSettings {
        spp: 2,
        ..RenderSettings::default()
    };
    let outcome = shoot(&grid, &camera, &lights, &settings);
    assert_eq!(outcome.counters.majorant_violations, 0);
    assert_eq!(outcome.counters.invalid_samples, 0);
    assert!(outcome.film.means().iter().all(|mean| mean.is_finite()));
    println!("{:?}", outcome.counters);
}

/// Every voxel with matter that the ray passes lies on a stretch that bounds it.
fn expect_covered(grid: &DenseGrid, ray: &Ray) {
    let mut walk = grid.walk(ray, 50.0);
    let mut stretches = Vec::new();
    while let Some(stretch) = walk.next_stretch() {
        stretches.push(stretch);
        assert!(stretches.len() < 1000, "endless walk along {ray:?}");
    }
    for pair in stretches.windows(2) {
        assert!(pair[0].end <= pair[1].start, "disordered along {ray:?}");
    }
    let bounds = Medium::bounds(grid);
    let size = grid.size();
    for k in 0..20_000 {
        let t = (k as f32 + 0.37) * 5.0 / 20_000.0;
        let at = (ray.at(t) - bounds.min) / (bounds.max - bounds.min) * size.as_vec3();
        // Rounding decides on which side of a face a point lies: skip what is close.
        let near_face = (at - at.round()).abs().min_element() < 1e-3;
        if at.min_element() <= 0.0 || (size.as_vec3() - at).min_element() <= 0.0 || near_face {
            continue;
        }
        let sigma = grid.cell(at.as_uvec3()).sigma;
        let bounded = stretches
            .iter()
            .any(|s| s.start <= t + 1e-5 && t <= s.end + 1e-5 && s.majorant >= sigma);
        assert!(
            sigma == 0.0 || bounded,
            "missed matter at {t} along {ray:?}"
        );
    }
}

#[test]
fn walks_cover_all_matter_from_any_side() {
    // Sparse matter in a grid whose sides are no multiples of a brick.
    let bounds = Bounds {
        min: Vec3::new(-1.0, 0.0, 2.0),
        max: Vec3::new(0.5, 1.1, 3.0),
    };
    let optics = vec![Optics {
        albedo: Vec3::ONE,
        alpha: 1.0,
    }];
    let size = UVec3::new(47, 33, 21);
    let grid = DenseGrid::from_fn(size, bounds, optics, Taps::Nearest, |cell| {
        let id = u64::from(cell.x + 64 * (cell.y + 64 * cell.z));
        let matter = pickglass::hash::mix(id).is_multiple_of(199);
        GridVoxel {
            sigma: if matter { 3.0 } else { 0.0 },
            direction: Vec3::Z,
            optics: 0,
        }
    })
    .expect("sound");
    let centre = (bounds.min + bounds.max) * 0.5;
    let face = Vec3::new(bounds.min.x, centre.y, centre.z);
    // Axes with both signs of zero, from outside, from inside, from a face, a corner.
    for axis in 0..3 {
        for sign in [1.0, -1.0] {
            for zero in [0.0, -0.0] {
                let mut direction = Vec3::splat(zero);
                direction[axis] = sign;
                for origin in [centre, face, bounds.min, centre - direction * 4.0] {
                    expect_covered(&grid, &ray(origin, direction));
                }
            }
        }
    }
    // Diagonals through corners of bricks, and directions almost along an axis.
    let corner = bounds.min;
    for direction in [
        (bounds.max - bounds.min).normalize_or(Vec3::Z),
        Vec3::ONE.normalize_or(Vec3::Z),
        Vec3::new(1.0, 1e-8, -1e-8),
        Vec3::new(1.0, 1e-14, 0.0),
        Vec3::new(1e-30, 1.0, -0.0),
    ] {
        for back in [0.0, 1.0, 2.0] {
            expect_covered(&grid, &ray(corner - direction * back, direction));
            expect_covered(&grid, &ray(centre - direction * back, direction));
        }
    }
    for k in 0..200 {
        let mut random = Random::new(9, 9, k);
        let direction = (random.tap() - 0.5).normalize_or(Vec3::Z);
        expect_covered(
            &grid,
            &ray(centre - direction * 2.0 + random.tap() * 0.3, direction),
        );
    }
}

#[test]
fn poisoned_rays_end_at_once_and_are_counted() {
    let grid = cube(9, 5.0, Vec3::Y, 0.1, 0.9);
    let bad = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY];
    let mut counters = Counters::default();
    let mut random = Random::new(0, 0, 0);
    let mut rays = vec![
        ray(Vec3::ZERO, Vec3::ZERO),
        ray(Vec3::ZERO, Vec3::splat(1e30)),
    ];
    for value in bad {
        for axis in 0..3 {
            let mut poisoned = Vec3::X;
            poisoned[axis] = value;
            rays.push(ray(Vec3::ZERO, poisoned));
            rays.push(ray(poisoned, Vec3::X));
        }
    }
    for (k, ray) in rays.iter().enumerate() {
        assert!(
            grid.collide(ray, f32::INFINITY, &mut random, &mut counters)
                .is_none()
        );
        assert_eq!(
            grid.transmittance(ray, 1.0, 0.0, &mut random, &mut counters),
            0.0
        );
        assert_eq!(counters.invalid_rays, 2 * (k as u64 + 1), "{ray:?}");
        // The walk itself ends as well, whoever starts it.
        let mut walk = grid.walk(ray, f32::INFINITY);
        let stretches = std::iter::from_fn(|| walk.next_stretch())
            .take(1000)
            .count();
        assert!(stretches < 1000, "{ray:?}");
    }
    for t_max in [f32::NAN, f32::NEG_INFINITY, -1.0, 0.0, -0.0] {
        let sound = ray(Vec3::ZERO, Vec3::X);
        assert!(
            grid.collide(&sound, t_max, &mut random, &mut counters)
                .is_none()
        );
    }
}

#[test]
fn extreme_random_numbers_end_every_walk() {
    let grid = cube(9, 5.0, Vec3::Y, 0.1, 0.9);
    let through = ray(Vec3::new(-3.0, 0.1, 0.1), Vec3::X);
    for bits in [0, u64::MAX] {
        let mut counters = Counters::default();
        let mut random = Random::stuck_at(bits);
        let hit = grid.collide(&through, f32::INFINITY, &mut random, &mut counters);
        assert!(hit.is_none_or(|hit| hit.t >= 2.49 && hit.t <= 3.51));
        let t = grid.transmittance(&through, f32::INFINITY, 0.1, &mut random, &mut counters);
        assert!((0.0..=1.0).contains(&t));
    }
    let settings = RenderSettings::default();
    let path = pickglass::render::path::Path::<_, _, true, false> {
        scatterer: &grid,
        suns: &[],
        environment: &Dome::uniform(Vec3::ONE),
        turn: Vec3::ONE,
        plane: pickglass::render::path::Plane {
            z: 0.0,
            facing: 1.0,
            albedo: 0.0,
        },
        max_order: settings.max_order,
        roulette_order: settings.roulette_order,
        shadow_roulette: settings.shadow_roulette,
        background: Background::Sky,
    };
    for bits in [0, u64::MAX] {
        let mut total = pickglass::render::path::Total::default();
        let mut counters = Counters::default();
        path.trace(
            through,
            &mut total,
            &mut Random::stuck_at(bits),
            &mut counters,
        );
        assert!(total.0.is_finite());
    }
}

#[test]
fn empty_volume_is_exactly_the_background() {
    let grid = cube(9, 0.0, Vec3::Y, 0.1, 0.9);
    let sky = Dome {
        zenith: Vec3::new(0.1, 0.2, 0.3),
        horizon: Vec3::new(0.7, 0.1, 0.9),
        ground: Vec3::new(0.123, 0.456, 0.789),
    };
    let lights = LightRig::new("dome", Vec::new(), Sky::Dome(sky));
    let camera = View::Face.camera(Vec3::ZERO, 2.0, 16, 16);
    for (background, expected, alpha) in [
        (Background::Sky, sky.ground, 1.0),
        (Background::Transparent, Vec3::ZERO, 0.0),
        (
            Background::Colour(Vec3::new(0.5, 0.25, 1.0)),
            Vec3::new(0.5, 0.25, 1.0),
            1.0,
        ),
    ] {
        let settings = RenderSettings {
            spp: 7,
            background,
            ..RenderSettings::default()
        };
        let outcome = shoot(&grid, &camera, &lights, &settings);
        for pixel in outcome.film.pixels() {
            assert_eq!(pixel.mean(), expected);
            assert_eq!(pixel.alpha(), alpha);
            assert_eq!(pixel.variance(), 0.0);
        }
        assert_eq!(outcome.counters.lookups, 0);
    }
}

/// Albedo 1 in uniform light of radiance 1 must be invisible, at any direction and α. With
/// the light as a picture, sampling and evaluation of the phase function are weighed
/// against each other and have to agree.
#[test]
fn white_furnace_is_one() {
    let picture = EnvironmentImage::new(16, 8, vec![Vec3::ONE; 128]).expect("sound");
    let sampled = LightRig::new("picture", Vec::new(), Sky::Image(picture.into()));
    let dome = LightRig::new("dome", Vec::new(), Sky::Dome(Dome::uniform(Vec3::ONE)));
    let settings = RenderSettings {
        spp: 48,
        max_order: 10_000,
        ..RenderSettings::default()
    };
    for alpha in ALPHAS {
        for fibre in oblique() {
            let grid = cube(9, 4.0, fibre, alpha, 1.0);
            let camera = View::Oblique.camera(Vec3::ZERO, 0.6, 16, 16);
            let outcome = shoot(&grid, &camera, &dome, &settings);
            for pixel in outcome.film.pixels() {
                // Whatever is met ends in the dome: exactly alpha.
                assert!((pixel.mean() - Vec3::splat(pixel.alpha())).length() < 1e-5);
            }
            let opaque = RenderSettings {
                background: Background::Sky,
                ..settings.clone()
            };
            let outcome = shoot(&grid, &camera, &sampled, &opaque);
            let (mean, error) = outcome.film.mean_luminance();
            assert!(
                (mean - 1.0).abs() < 4.5 * error + 1e-4,
                "α {alpha} fibre {fibre}: {mean} ± {error}"
            );
            assert_eq!(outcome.counters.invalid_samples, 0);
        }
    }
}

#[test]
fn grids_mend_poison_and_refuse_nonsense() {
    let bounds = Bounds {
        min: Vec3::ZERO,
        max: Vec3::ONE,
    };
    let optics = vec![Optics {
        albedo: Vec3::new(f32::NAN, 2.0, -1.0),
        alpha: f32::NAN,
    }];
    let sigmas = [f32::NAN, f32::INFINITY, -1.0, 1.0, 1.0, 1.0, 0.0, 1e-40];
    let directions = [
        Vec3::X,
        Vec3::X,
        Vec3::X,
        Vec3::ZERO,
        Vec3::NAN,
        Vec3::splat(f32::INFINITY),
        Vec3::NAN,
        Vec3::X * 1e-3,
    ];
    let grid = DenseGrid::from_fn(
        UVec3::splat(2),
        bounds,
        optics.clone(),
        Taps::StochasticTrilinear,
        |c| {
            let k = (c.x + 2 * c.y + 4 * c.z) as usize;
            GridVoxel {
                sigma: sigmas[k],
                direction: directions[k],
                optics: k as u32 & 1,
            }
        },
    )
    .expect("mended");
    let mended = grid.mended();
    assert_eq!(mended.extinctions, 3);
    assert_eq!(mended.directions, 3);
    assert_eq!(mended.materials, 1);
    assert_eq!(grid.optics(0).albedo, Vec3::new(0.0, 1.0, 0.0));
    assert_eq!(grid.optics(0).alpha, 1.0);

    let make = |size, bounds, optics| {
        DenseGrid::from_fn(size, bounds, optics, Taps::Nearest, |_| GridVoxel::EMPTY).map(|_| ())
    };
    let flat = Bounds {
        max: Vec3::new(1.0, 0.0, 1.0),
        ..bounds
    };
    let nan = Bounds {
        max: Vec3::new(1.0, f32::NAN, 1.0),
        ..bounds
    };
    let huge = UVec3::new(1 << 19, 1 << 19, 1 << 19);
    assert!(matches!(
        make(UVec3::new(0, 1, 1), bounds, optics.clone()),
        Err(VolumeError::Empty(0, 1, 1))
    ));
    assert!(matches!(
        make(huge, bounds, optics.clone()),
        Err(VolumeError::TooLarge(..))
    ));
    assert!(matches!(
        make(UVec3::ONE, flat, optics.clone()),
        Err(VolumeError::Bounds(..))
    ));
    assert!(matches!(
        make(UVec3::ONE, nan, optics),
        Err(VolumeError::Bounds(..))
    ));
    assert_eq!(
        make(UVec3::ONE, bounds, Vec::new()),
        Err(VolumeError::NoOptics)
    );
}

#[test]
fn trilinear_taps_are_trilinear_in_the_mean() {
    let bounds = Bounds {
        min: Vec3::ZERO,
        max: Vec3::splat(8.0),
    };
    let optics = vec![Optics {
        albedo: Vec3::ONE,
        alpha: 1.0,
    }];
    let sigma_of = |c: UVec3| (c.x + 10 * c.y + 100 * c.z) as f32 + 1.0;
    let grid = DenseGrid::from_fn(
        UVec3::splat(8),
        bounds,
        optics,
        Taps::StochasticTrilinear,
        |c| GridVoxel {
            sigma: sigma_of(c),
            direction: Vec3::Z,
            optics: 0,
        },
    )
    .expect("sound");
    // A linear field is reproduced exactly in the mean.
    let along = ray(Vec3::new(0.0, 3.3, 4.8), Vec3::X);
    let mut walk = grid.walk(&along, 20.0);
    while let Some(stretch) = walk.next_stretch() {
        let t = 0.5 * (stretch.start + stretch.end);
        if !(0.5..7.5).contains(&t) {
            continue;
        }
        let (mean, error) = measure(20_000, |r| f64::from(walk.voxel(t, r.tap(), 0.0).sigma));
        let exact = f64::from(t - 0.5 + 10.0 * 2.8 + 100.0 * 4.3 + 1.0);
        assert!((mean - exact).abs() < 5.0 * error, "{mean} {exact}");
        assert!(stretch.majorant >= walk.voxel(t, Vec3::splat(0.999), 0.0).sigma);
    }
}

/// A cube of 6³ random voxels, `times` as fine along each axis by interpolation between them,
/// or as they are with taps. Absorbs whatever meets it.
fn interpolated(times: u32, taps: Taps) -> DenseGrid {
    const N: u32 = 6;
    let sigma_of = |c: [i32; 3]| {
        let [x, y, z] = c.map(|c| c.clamp(0, N as i32 - 1) as u64);
        12.0 * Random::new(3, x + 10 * y, z).uniform().powi(3)
    };
    let bounds = Bounds {
        min: Vec3::splat(-0.5),
        max: Vec3::splat(0.5),
    };
    let optics = vec![Optics {
        albedo: Vec3::ZERO,
        alpha: 1.0,
    }];
    DenseGrid::from_fn(UVec3::splat(times * N), bounds, optics, taps, |c| {
        // In voxels of the coarse grid, from the middle of its first.
        let at = (c.as_vec3() + 0.5) / times as f32 - 0.5;
        let (low, share) = (at.floor().as_ivec3(), at - at.floor());
        let mut sigma = 0.0;
        for corner in 0..8 {
            let step = [corner & 1, corner >> 1 & 1, corner >> 2 & 1];
            let weight = (0..3).map(|axis| match step[axis] {
                1 => share[axis],
                _ => 1.0 - share[axis],
            });
            let place = [low.x + step[0], low.y + step[1], low.z + step[2]];
            sigma += weight.product::<f32>() * sigma_of(place);
        }
        GridVoxel {
            sigma,
            direction: Vec3::Z,
            optics: 0,
        }
    })
    .expect("sound")
}

/// What is seen of it, pixel by pixel.
fn coverage(grid: &DenseGrid) -> Vec<f64> {
    let camera = View::Oblique.camera(Vec3::ZERO, 0.8, 14, 14);
    let lights = LightRig::new("dark", Vec::new(), Sky::Dark);
    let settings = RenderSettings {
        spp: 6000,
        background: Background::Transparent,
        ..RenderSettings::default()
    };
    let outcome = shoot(grid, &camera, &lights, &settings);
    assert_eq!(outcome.counters.majorant_violations, 0);
    (outcome.film.pixels().iter())
        .map(|pixel| f64::from(pixel.alpha()))
        .collect()
}

#[test]
fn taps_are_finer_grids() {
    let tapped = coverage(&interpolated(1, Taps::StochasticTrilinear));
    let apart = |times| {
        let finer = coverage(&interpolated(times, Taps::Nearest));
        let squares = tapped
            .iter()
            .zip(&finer)
            .map(|(one, other)| (one - other).powi(2));
        (squares.sum::<f64>() / tapped.len() as f64).sqrt()
    };
    let [same, twice, four] = [1, 2, 4].map(apart);
    // The noise of a pixel is 0.5 / √6000 at most, of both.
    println!("same {same:.4}, twice {twice:.4}, four times {four:.4}");
    assert!(four < 0.01 && four <= twice + 0.002, "{twice} {four}");
    assert!(twice < 0.5 * same, "{same} {twice}");
}
