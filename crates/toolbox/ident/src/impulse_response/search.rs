//! Hyperparameters by maximum marginal likelihood.

use faer::Mat;

use super::kernel::{Hyperparameters, Kernel};
use super::posterior::Evidence;

/// Largest product of regressor and prior, relative to the noise, that double precision can resolve.
const CLEAREST: f64 = 1e11;
/// Rounds over the inputs.
const ROUNDS: usize = 3;
/// Evaluations for one input in one round.
const EVALUATIONS: usize = 80;

/// Kernels of several inputs, one after the other, over coefficients scaled to inputs of magnitude one.
pub(super) struct Prior {
    pub(super) kernel: Kernel,
    pub(super) taps: usize,
    /// Magnitude of each input.
    pub(super) inputs: Vec<f64>,
}

impl Prior {
    /// The root of the prior covariance over the noise variance; `c` is relative to that variance.
    pub(super) fn root(&self, hyperparameters: &[Hyperparameters]) -> Mat<f64> {
        let n = self.taps * self.inputs.len();
        let mut whole = Mat::zeros(n, n);
        for (k, h) in hyperparameters.iter().enumerate() {
            let scaled = faer::Scale(1.0 / self.inputs[k]) * self.kernel.root(self.taps, h);
            whole.get_mut(k * self.taps.., k * self.taps..).get_mut(..self.taps, ..self.taps).copy_from(scaled);
        }
        whole
    }

    /// The hyperparameters under which the data are most likely.
    ///
    /// A grid common to all inputs gives the start; then each input is refined in turn.
    pub(super) fn tune(&self, evidence: &Evidence) -> Vec<Hyperparameters> {
        let limit = 2.0 * (CLEAREST / ((evidence.rows * self.taps) as f64).sqrt()).ln();
        let cost = |points: &[Vec<f64>]| {
            let all: Vec<_> = points.iter().map(|p| from_point(p, limit)).collect();
            evidence.cost(&self.root(&all))
        };
        let mut points = vec![Vec::new(); self.inputs.len()];
        let mut best = f64::INFINITY;
        for decay in [0.3, 0.6, 0.8, 0.9, 0.95, 0.98, 0.995] {
            for scale in [0.01, 1.0, 1e2, 1e4, 1e6, 1e10, 1e14] {
                // ρ = √λ makes DC the same as TC.
                let start = to_point(scale, decay, f64::sqrt(decay), self.kernel.hyperparameters());
                let trial = vec![start; self.inputs.len()];
                let value = cost(&trial);
                if value < best || points[0].is_empty() {
                    (best, points) = (value, trial);
                }
            }
        }
        for _ in 0..ROUNDS {
            let before = best;
            for k in 0..points.len() {
                let start = points[k].clone();
                let mut along = |p: &[f64]| {
                    points[k] = p.to_vec();
                    cost(&points)
                };
                let (found, value) = nelder_mead(&mut along, &start);
                points[k] = found;
                best = value;
            }
            if before - best < 1e-3 {
                break;
            }
        }
        points.iter().map(|p| from_point(p, limit)).collect()
    }
}

fn to_point(scale: f64, decay: f64, correlation: f64, count: usize) -> Vec<f64> {
    let mut point = vec![scale.ln(), (decay / (1.0 - decay)).ln(), correlation.atanh()];
    point.truncate(count);
    point
}

/// The inverse of [`to_point`], to the resolution of the arithmetic.
fn from_point(point: &[f64], limit: f64) -> Hyperparameters {
    Hyperparameters {
        scale: point[0].clamp(-50.0, limit.max(-50.0)).exp(),
        decay: 1.0 / (1.0 + (-point[1].clamp(-6.0, 9.0)).exp()),
        correlation: point.get(2).map_or(0.0, |p| p.clamp(-6.0, 6.0).tanh()),
    }
}

/// Minimises a function of few variables by the simplex of Nelder & Mead (1965); returns the point and its value, never
/// worse than the start.
fn nelder_mead(function: &mut impl FnMut(&[f64]) -> f64, start: &[f64]) -> (Vec<f64>, f64) {
    let n = start.len();
    let mut simplex: Vec<(Vec<f64>, f64)> = (0..=n)
        .map(|k| {
            let mut point = start.to_vec();
            if k > 0 {
                point[k - 1] += 0.5;
            }
            let value = function(&point);
            (point, value)
        })
        .collect();
    let mut evaluations = n + 1;
    while evaluations < EVALUATIONS {
        simplex.sort_by(|a, b| a.1.total_cmp(&b.1));
        if simplex[n].1 - simplex[0].1 < 1e-4 {
            break;
        }
        let centre: Vec<f64> = (0..n).map(|j| simplex[..n].iter().map(|s| s.0[j]).sum::<f64>() / n as f64).collect();
        let worst = simplex[n].clone();
        let mut towards = |factor: f64| {
            let point: Vec<f64> = centre.iter().zip(&worst.0).map(|(c, w)| c + factor * (c - w)).collect();
            let value = function(&point);
            evaluations += 1;
            (point, value)
        };
        let reflected = towards(1.0);
        let replacement = if reflected.1 < simplex[0].1 {
            let further = towards(2.0);
            if further.1 < reflected.1 { further } else { reflected }
        } else if reflected.1 < simplex[n - 1].1 {
            reflected
        } else {
            towards(if reflected.1 < worst.1 { 0.5 } else { -0.5 })
        };
        if replacement.1 < worst.1 {
            simplex[n] = replacement;
            continue;
        }
        let best = simplex[0].0.clone();
        for (point, value) in &mut simplex[1..] {
            point.iter_mut().zip(&best).for_each(|(p, b)| *p = b + 0.5 * (*p - b));
            *value = function(point);
            evaluations += 1;
        }
    }
    simplex.sort_by(|a, b| a.1.total_cmp(&b.1));
    simplex.swap_remove(0)
}
