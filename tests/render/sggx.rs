//! The fibre microflake against integrals and against numbers from elsewhere.

use glam::{DMat3, DVec3, Vec3};
use pickglass::random::{LARGEST_BELOW_ONE, Random};
use pickglass::render::Fibre;
use pickglass::volume::sggx_matrix;

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

/// ∫ f(m) dm over the sphere with polar axis `axis`, fine near its equator, where D of a
/// smooth fibre lives.
fn over_sphere(axis: Vec3, mut f: impl FnMut(Vec3) -> f64) -> f64 {
    let axis = axis.as_dvec3().normalize_or(DVec3::Z);
    let (a, b) = axis.any_orthonormal_pair();
    let (polar, round) = (2001, 180);
    let mut sum = 0.0;
    for i in 0..polar {
        // cosine = sinh-like: s³ puts most nodes near 0.
        let s = (f64::from(i) + 0.5) / f64::from(polar) * 2.0 - 1.0;
        let cosine = s * s * s;
        let weight = 3.0 * s * s * 2.0 / f64::from(polar);
        let sine = (1.0 - cosine * cosine).sqrt();
        let mut ring = 0.0;
        for k in 0..round {
            let phi = (f64::from(k) + 0.5) / f64::from(round) * std::f64::consts::TAU;
            let m: DVec3 = axis * cosine + (a * phi.cos() + b * phi.sin()) * sine;
            ring += f(m.as_vec3());
        }
        sum += ring * weight * std::f64::consts::TAU / f64::from(round);
    }
    sum
}

fn second_moments(fibre: &Fibre, wi: Vec3, n: u32) -> DMat3 {
    let mut sum = DMat3::ZERO;
    for k in 0..n {
        let mut random = Random::new(7, 0, u64::from(k));
        let m = fibre.visible_normal(wi, random.pair()).as_dvec3();
        sum += DMat3::from_cols(m * m.x, m * m.y, m * m.z);
    }
    sum * (1.0 / f64::from(n))
}

#[test]
fn projected_area_is_the_integral_of_the_flakes() {
    for alpha in ALPHAS {
        for wi in oblique() {
            let fibre = Fibre::new(Vec3::new(0.3, 0.9, -0.2).normalize_or(Vec3::Z), alpha);
            let seen = over_sphere(fibre.direction, |m| {
                f64::from(wi.dot(m).max(0.0) * fibre.normal_distribution(m))
            });
            let area = f64::from(fibre.projected_area(wi));
            assert!(
                (seen / area - 1.0).abs() < 2e-3,
                "α {alpha}: {seen} against {area}"
            );
            // And the matrix form of the paper.
            let matrix = sggx_matrix(fibre.direction, alpha);
            let by_matrix = wi.dot(matrix * wi).max(0.0).sqrt();
            assert!((by_matrix - fibre.projected_area(wi)).abs() < 2e-3);
        }
    }
}

/// Reference figures of S = diag(0.05, 1, 1) seen from (1,2,3)/√14: E[m²] as mitsuba
/// 3.5.2 samples it; later versions give (0.187, 0.374, 0.439).
#[test]
fn second_moments_at_an_oblique_direction_match_the_published_figures() {
    let fibre = Fibre::new(Vec3::X, 0.05f32.sqrt());
    let wi = Vec3::new(1.0, 2.0, 3.0).normalize_or(Vec3::Z);
    let moments = second_moments(&fibre, wi, 400_000);
    for (axis, expected) in [0.0338, 0.4207, 0.5455].into_iter().enumerate() {
        let got = moments.col(axis)[axis];
        assert!((got - expected).abs() < 0.002, "axis {axis}: {got}");
    }
}

#[test]
fn second_moments_match_quadrature_at_oblique_directions() {
    for alpha in ALPHAS {
        let fibre = Fibre::new(Vec3::new(0.5, -0.6, 0.4).normalize_or(Vec3::Z), alpha);
        for wi in oblique() {
            let sampled = second_moments(&fibre, wi, 60_000);
            for i in 0..3 {
                for j in 0..=i {
                    let exact = over_sphere(fibre.direction, |m| {
                        let seen = wi.dot(m).max(0.0) * fibre.normal_distribution(m);
                        f64::from(seen * m[i] * m[j])
                    }) / f64::from(fibre.projected_area(wi));
                    let got = sampled.col(i)[j];
                    // Five standard errors of a quantity bounded by 1.
                    assert!(
                        (got - exact).abs() < 0.01,
                        "α {alpha} {wi} {i}{j}: {got} {exact}"
                    );
                }
            }
        }
    }
}

#[test]
fn a_transposed_frame_is_noticed() {
    // Negative control: normals rotated into the wrong frame fail the moments.
    let fibre = Fibre::new(Vec3::X, 0.05f32.sqrt());
    let wi = Vec3::new(1.0, 2.0, 3.0).normalize_or(Vec3::Z);
    let frame = glam::Mat3::from_cols(wi.any_orthonormal_pair().0, wi.any_orthonormal_pair().1, wi);
    let mut sum = 0.0;
    for k in 0..100_000 {
        let m = fibre.visible_normal(wi, Random::new(7, 0, k).pair());
        let wrong = frame.transpose() * (frame.transpose() * m);
        sum += f64::from(wrong.x * wrong.x);
    }
    assert!((sum / 1e5 - 0.0339).abs() > 0.02);
}

#[test]
fn the_phase_function_integrates_to_one() {
    for alpha in [0.05, 0.1, 0.3, 0.6, 1.0] {
        let fibre = Fibre::new(Vec3::new(-0.2, 0.4, 0.9).normalize_or(Vec3::Z), alpha);
        for wi in oblique() {
            // By half vectors: dωo = 4 |wi·h| dh covers the sphere with h on wi's side.
            let total = over_sphere(fibre.direction, |h| {
                let cosine = wi.dot(h);
                if cosine <= 1e-4 {
                    return 0.0;
                }
                let wo = h * (2.0 * cosine) - wi;
                f64::from(fibre.phase(wi, wo) * 4.0 * cosine)
            });
            assert!((total - 1.0).abs() < 3e-3, "α {alpha} {wi}: {total}");
            // And over wo itself, by uniform directions.
            let n = 100_000;
            let mut direct = 0.0;
            let mut squares = 0.0;
            for k in 0..n {
                let [u, v] = Random::new(3, 1, k).pair();
                let (z, phi) = (2.0 * u - 1.0, std::f32::consts::TAU * v);
                let r = (1.0 - z * z).max(0.0).sqrt();
                let wo = Vec3::new(r * phi.cos(), r * phi.sin(), z);
                let p = f64::from(fibre.phase(wi, wo)) * 4.0 * std::f64::consts::PI;
                direct += p;
                squares += p * p;
            }
            let n = n as f64;
            let mean = direct / n;
            let error = ((squares / n - mean * mean).max(0.0) / n).sqrt();
            assert!(
                (mean - 1.0).abs() < 5.0 * error + 1e-3,
                "α {alpha}: {mean} ± {error}"
            );
        }
    }
}

#[test]
fn scattering_is_reciprocal() {
    for alpha in ALPHAS {
        let fibre = Fibre::new(Vec3::new(0.1, 0.9, 0.3).normalize_or(Vec3::Z), alpha);
        for wi in oblique() {
            for wo in oblique() {
                let there = fibre.projected_area(wi) * fibre.phase(wi, wo);
                let back = fibre.projected_area(wo) * fibre.phase(wo, wi);
                assert!((there - back).abs() <= 1e-4 * there.max(back) + 1e-6);
            }
        }
    }
}

#[test]
fn sampling_follows_the_phase_function() {
    // The mean of any function under sampling equals its integral against the phase.
    for alpha in ALPHAS {
        let fibre = Fibre::new(Vec3::new(0.5, 0.5, 0.7).normalize_or(Vec3::Z), alpha);
        for wi in oblique() {
            let probe = |wo: Vec3| f64::from(wo.dot(Vec3::new(0.3, -0.5, 0.8)).powi(2) + wo.x);
            let n = 100_000;
            let sampled = (0..n)
                .map(|k| probe(fibre.sample(wi, Random::new(5, 2, k).pair())))
                .sum::<f64>()
                / n as f64;
            let exact = over_sphere(fibre.direction, |h| {
                let cosine = wi.dot(h);
                if cosine <= 0.0 {
                    return 0.0;
                }
                let seen = f64::from(cosine * fibre.normal_distribution(h));
                seen * probe(h * (2.0 * cosine) - wi)
            }) / f64::from(fibre.projected_area(wi));
            assert!(
                (sampled - exact).abs() < 0.02,
                "α {alpha}: {sampled} {exact}"
            );
        }
    }
}

#[test]
fn poison_gives_unit_directions_or_nan_but_no_panic() {
    let bad = [f32::NAN, f32::INFINITY, -0.0, 0.0, 1e-40, -7.0, 1e30];
    for alpha in bad {
        let fibre = Fibre::new(Vec3::Y, alpha);
        assert!((0.01..=1.0).contains(&fibre.alpha), "α {alpha}");
        for u in [0.0, 0.5, LARGEST_BELOW_ONE] {
            for v in [0.0, 0.25, LARGEST_BELOW_ONE] {
                // Along, against and across the fibre, and off it by one rounding.
                for wi in [
                    Vec3::Y,
                    Vec3::NEG_Y,
                    Vec3::X,
                    Vec3::new(1e-7, 1.0, -0.0),
                    Vec3::new(1.0, 1e-20, 0.0),
                ] {
                    let wo = fibre.sample(wi, [u, v]);
                    assert!(
                        (wo.length() - 1.0).abs() < 1e-5,
                        "α {alpha} {u} {v} {wi}: {wo}"
                    );
                    assert!(fibre.phase(wi, wo).is_finite());
                    assert!(fibre.phase(wi, -wi).is_finite());
                    assert!(fibre.projected_area(wi) > 0.0);
                }
            }
        }
    }
    // NaN goes through, to be counted where rays are checked.
    assert!(
        !Fibre::new(Vec3::NAN, 0.5)
            .projected_area(Vec3::X)
            .is_finite()
    );
}
