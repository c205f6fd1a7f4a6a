//! The discrete Laplace equation on one block, solved exactly. Zhao 2012 §5.5.
//!
//! Unknowns are the stacks of voxels inside the block; the outermost stacks are given.
//! With data on one edge only, the sine transform along that edge leaves for each
//! frequency θ the recurrence u(x−1) + u(x+1) = (4 − 2 cos θ) u(x), whose solution that
//! vanishes at the opposite edge is sinh(μ(N − x)) / sinh(μN) with cosh μ = 2 − cos θ.

use std::f64::consts::PI;

/// Solves for data on the edge at index 0 of the first axis of a `across` × `along` grid.
pub(super) struct EdgeSolver {
    across: usize,
    along: usize,
    /// `[k][y]`: sin(θ_k y) for the inner rows, times √(2/(along − 1)).
    sines: Vec<f64>,
    /// `[k][x]`: how far frequency k reaches.
    decay: Vec<f64>,
}

impl EdgeSolver {
    /// For blocks with `across` stacks away from the edge and `along` stacks along it.
    pub(super) fn new(across: usize, along: usize) -> Self {
        let inner = if across >= 3 {
            along.saturating_sub(2)
        } else {
            0
        };
        let norm = (2.0 / (along.max(2) - 1) as f64).sqrt();
        let mut sines = Vec::with_capacity(inner * inner);
        let mut decay = Vec::with_capacity(inner * across);
        let length = (across - 1) as f64;
        for k in 1..=inner {
            let theta = PI * k as f64 / (along - 1) as f64;
            sines.extend((1..=inner).map(|y| norm * (theta * y as f64).sin()));
            let mu = (2.0 - theta.cos()).acosh();
            // The quotient of hyperbolic sines, written so that nothing overflows.
            decay.extend((0..across).map(|x| {
                let x = x as f64;
                (-mu * x).exp() * -(-2.0 * mu * (length - x)).exp_m1()
                    / -(-2.0 * mu * length).exp_m1()
            }));
        }
        Self {
            across,
            along,
            sines,
            decay,
        }
    }

    /// The solution `[y][x]` (x away from the edge) for `edge` given along x = 0 and zero
    /// on the other three edges.
    ///
    /// A stack that belongs to several edges (a corner) takes the mean of what they ask
    /// for, so this edge contributes its share. Corners do not touch the inside.
    pub(super) fn solve(&self, edge: &[f64]) -> Vec<f64> {
        let (across, along) = (self.across, self.along);
        let mut field = vec![0.0; across * along];
        let inner = if across >= 3 {
            along.saturating_sub(2)
        } else {
            0
        };
        for k in 0..inner {
            let sines = &self.sines[k * inner..(k + 1) * inner];
            let amplitude: f64 = sines.iter().zip(&edge[1..]).map(|(s, v)| s * v).sum();
            let decay = &self.decay[k * across..(k + 1) * across];
            for (sine, row) in sines.iter().zip(field[across..].chunks_exact_mut(across)) {
                let amplitude = amplitude * sine;
                for (value, reach) in row[1..across - 1].iter_mut().zip(&decay[1..]) {
                    *value += amplitude * reach;
                }
            }
        }
        for (y, value) in edge.iter().enumerate() {
            let edges =
                1 + usize::from(across == 1) + usize::from(y == 0) + usize::from(y + 1 == along);
            field[y * across] = value / edges as f64;
        }
        field
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::EdgeSolver;

    /// Dense Gaussian elimination of the same equations, corners as documented.
    fn dense(across: usize, along: usize, edge: &[f64]) -> Vec<f64> {
        let n = across * along;
        let mut rows = vec![vec![0.0; n + 1]; n];
        for (y, &given) in edge.iter().enumerate() {
            for x in 0..across {
                let at = y * across + x;
                let on = [x == 0, x + 1 == across, y == 0, y + 1 == along];
                let edges = on.iter().filter(|&&b| b).count();
                if edges > 0 {
                    rows[at][at] = 1.0;
                    rows[at][n] = if x == 0 { given / edges as f64 } else { 0.0 };
                } else {
                    rows[at][at] = 4.0;
                    for other in [at - 1, at + 1, at - across, at + across] {
                        rows[at][other] = -1.0;
                    }
                }
            }
        }
        for pivot in 0..n {
            let best = (pivot..n)
                .max_by(|&a, &b| rows[a][pivot].abs().total_cmp(&rows[b][pivot].abs()))
                .unwrap();
            rows.swap(pivot, best);
            let lead = rows[pivot].clone();
            for row in &mut rows[pivot + 1..] {
                let factor = row[pivot] / lead[pivot];
                for (value, from) in row.iter_mut().zip(&lead) {
                    *value -= factor * from;
                }
            }
        }
        let mut solution = vec![0.0; n];
        for at in (0..n).rev() {
            let known: f64 = (at + 1..n).map(|i| rows[at][i] * solution[i]).sum();
            solution[at] = (rows[at][n] - known) / rows[at][at];
        }
        solution
    }

    fn largest_error(across: usize, along: usize, scale: f64) -> f64 {
        let edge: Vec<f64> = (0..along)
            .map(|y| ((y * y * 7 + 3) % 11) as f64 - 4.0)
            .collect();
        let ours = EdgeSolver::new(across, along).solve(&edge);
        let theirs = dense(across, along, &edge);
        let pairs = ours.iter().zip(&theirs);
        pairs
            .map(|(a, b)| (a * scale - b).abs())
            .fold(0.0, f64::max)
    }

    #[test]
    fn sine_solution_equals_dense_elimination() {
        for across in 1..9 {
            for along in 1..9 {
                assert!(
                    largest_error(across, along, 1.0) < 1e-11,
                    "{across}×{along}"
                );
            }
        }
        assert!(largest_error(17, 11, 1.0) < 1e-11);
    }

    #[test]
    fn a_wrong_solution_is_noticed() {
        assert!(largest_error(7, 6, 1.001) > 1e-4);
    }

    #[test]
    fn long_blocks_do_not_overflow() {
        let field = EdgeSolver::new(4000, 5).solve(&[1.0; 5]);
        assert!(field.iter().all(|v| v.is_finite() && *v >= 0.0));
        assert!(field[2 * 4000 + 1] > 0.5 && field[2 * 4000 + 3000] < 1e-9);
    }
}
