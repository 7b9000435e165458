//! The way back: what later measurements say of earlier states.

use std::convert::Infallible;

use faer::{Mat, MatRef};

use super::system::Smoothed;
use numerics::vector::dot;

use super::forward::{Forward, Innovation, add_columns};
use super::steady::Memory;
use crate::triangle::upper_factor;

/// The gradient of the likelihood by the state, and minus its curvature: r and N of Durbin and Koopman, N as RᵀR. By R,
/// information that a measurement replaces leaves no rounding error behind that a wide covariance would enlarge.
struct Later {
    gradient: Vec<f64>,
    /// R, by rows.
    root: Vec<f64>,
    column: Vec<f64>,
}

/// What later measurements say of a state, and what is then known of it.
struct Known {
    root: Vec<f64>,
    information: Vec<f64>,
    posterior: Vec<f64>,
}

/// x̂(k) = x(k | k−1) + P(k | k−1) r, with the covariance P − P N P.
pub(super) fn smooth(forward: &Forward, outputs: MatRef<'_, f64>) -> Smoothed {
    let (n, samples) = (forward.states, outputs.nrows());
    let mut states = Mat::zeros(samples, n);
    let mut covariances = vec![0.0; samples * n * n];
    let mut later = Later { gradient: vec![0.0; n], root: vec![0.0; n * n], column: vec![0.0; n] };
    let mut information = vec![0.0; n * n];
    // N at a sample and the covariance of its state, by the forward step and N at the sample after it.
    let mut memory: Memory<usize, Known> = Memory::new();
    let mut left = forward.innovations.len();
    for sample in (0..samples).rev() {
        if sample + 1 < samples {
            later.gradient_through_transition(&forward.transition);
        }
        let p = &forward.covariances[sample * n * n..(sample + 1) * n * n];
        let last = left;
        while left > 0 && forward.innovations[left - 1].sample == sample {
            left -= 1;
        }
        let step = |i: usize| {
            let innovation = &forward.innovations[i];
            let c = &forward.output[innovation.output * n..(innovation.output + 1) * n];
            (c, &forward.gains[i * n..(i + 1) * n], innovation)
        };
        for (c, gain, innovation) in (left..last).rev().map(step) {
            later.gradient_through_measurement(c, gain, innovation);
        }
        let number = forward.settled[sample];
        let make = || -> Result<Known, Infallible> {
            let before = later.root.clone();
            if sample + 1 < samples {
                later.root_through_transition(&forward.transition);
            }
            for (c, gain, innovation) in (left..last).rev().map(step) {
                later.root_through_measurement(c, gain, innovation.variance);
            }
            let root = std::mem::replace(&mut later.root, before);
            Ok(Known::new(root, p, n))
        };
        let Ok(known) = memory.step(&number, &information, make);
        covariances[sample * n * n..(sample + 1) * n * n].copy_from_slice(&known.posterior);
        later.root.copy_from_slice(&known.root);
        information.copy_from_slice(&known.information);
        // P is symmetric: its rows are its columns.
        add_columns(p, &later.gradient, &mut later.column);
        for i in 0..n {
            states[(sample, i)] = forward.predicted[sample * n + i] + later.column[i];
        }
    }
    Smoothed { states, log_likelihood: forward.log_likelihood(), covariances }
}

impl Later {
    /// r ← Aᵀ r.
    fn gradient_through_transition(&mut self, a: &[f64]) {
        add_columns(a, &self.gradient, &mut self.column);
        self.gradient.copy_from_slice(&self.column);
    }

    /// R ← R A.
    fn root_through_transition(&mut self, a: &[f64]) {
        let n = self.gradient.len();
        for row in self.root.chunks_exact_mut(n) {
            for j in 0..n {
                self.column[j] = (0..n).map(|k| row[k] * a[k * n + j]).sum();
            }
            row.copy_from_slice(&self.column);
        }
    }

    /// With L = I − K cᵀ: r ← c v/F + Lᵀ r.
    fn gradient_through_measurement(&mut self, c: &[f64], gain: &[f64], innovation: &Innovation) {
        let push = innovation.value / innovation.variance - dot(gain, &self.gradient);
        self.gradient.iter_mut().zip(c).for_each(|(r, c)| *r += push * c);
    }

    /// N ← c cᵀ/F + Lᵀ N L: R ← R L with the row cᵀ/√F below.
    fn root_through_measurement(&mut self, c: &[f64], gain: &[f64], variance: f64) {
        for row in self.root.chunks_exact_mut(c.len()) {
            let taken = dot(row, gain);
            row.iter_mut().zip(c).for_each(|(entry, c)| *entry -= taken * c);
        }
        self.root.extend(c.iter().map(|c| c / variance.sqrt()));
    }
}

impl Known {
    /// From any R of n columns, and the covariance P of the state before later measurements: P − P N P.
    fn new(root: Vec<f64>, p: &[f64], n: usize) -> Known {
        let rows = root.len() / n.max(1);
        let factor = upper_factor(Mat::from_fn(rows, n, |i, j| root[i * n + j]));
        let rows = factor.nrows();
        let explained = &factor * Mat::from_fn(n, n, |i, j| p[i * n + j]);
        let square = |m: &Mat<f64>, i: usize, j: usize| -> f64 { (0..rows).map(|k| m[(k, i)] * m[(k, j)]).sum() };
        let pairs = || (0..n).flat_map(|i| (0..n).map(move |j| (i, j)));
        Known {
            root: pairs().map(|(i, j)| if i < rows { factor[(i, j)] } else { 0.0 }).collect(),
            information: pairs().map(|(i, j)| square(&factor, i, j)).collect(),
            posterior: pairs().map(|(i, j)| p[i * n + j] - square(&explained, i, j)).collect(),
        }
    }
}
