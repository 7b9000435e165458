//! The way back: what later measurements say of earlier states.

use std::convert::Infallible;

use faer::{Mat, MatRef};

use super::system::Smoothed;
use numerics::vector::{add_scaled, dot};

use super::forward::{Forward, add_columns};
use super::sparse::SparseRow;
use super::steady::Memory;
use crate::triangle::upper_factor;

/// Minus the curvature of the likelihood by the state, N of Durbin and Koopman, as RᵀR. By R, information that a
/// measurement replaces leaves no rounding error behind that a wide covariance would enlarge.
struct Later {
    /// R, by rows.
    root: Vec<f64>,
    /// N.
    information: Vec<f64>,
    column: Vec<f64>,
}

/// Information of later measurements about a state, and the number of the covariance that is then left of it.
struct Known {
    root: Vec<f64>,
    information: Vec<f64>,
    number: usize,
}

/// x̂(k) = x(k | k−1) + P(k | k−1) r, with the covariance P − P N P.
pub(super) fn smooth(forward: &Forward, outputs: MatRef<'_, f64>) -> Smoothed {
    let (n, samples) = (forward.states, outputs.nrows());
    let mut covariances = Vec::new();
    let mut of_sample = vec![0; samples];
    let mut later = Later { root: vec![0.0; n * n], information: vec![0.0; n * n], column: vec![0.0; n] };
    // N at a sample and the covariance of its state, by the forward step and N at the sample after it.
    let mut memory: Memory<usize, Known> = Memory::new();
    let mut left = forward.innovations.len();
    for sample in work::checked((0..samples).rev()) {
        let measured = forward.measured_at(sample, &mut left);
        let root = &later.root;
        let column = &mut later.column;
        let make = || -> Result<Known, Infallible> {
            let mut root = root.clone();
            if sample + 1 < samples {
                root_through_transition(&mut root, &forward.transition, column);
            }
            for i in measured.rev() {
                let innovation = &forward.innovations[i];
                let c = &forward.output[innovation.output];
                root_through_measurement(&mut root, c, forward.gain(i), innovation.variance);
            }
            let (known, posterior) =
                Known::new(root, forward.covariance(sample), n, covariances.len() / (n * n).max(1));
            covariances.extend(posterior);
            Ok(known)
        };
        let Ok(known) = memory.step(&forward.settled[sample], &later.information, make);
        of_sample[sample] = known.number;
        later.root.copy_from_slice(&known.root);
        later.information.copy_from_slice(&known.information);
    }
    let states = smoothed_states(forward, samples);
    Smoothed { states, log_likelihood: forward.log_likelihood(), covariances, of_sample }
}

/// x̂(k) = x(k | k−1) + P(k | k−1) r.
pub(super) fn smoothed_states(forward: &Forward, samples: usize) -> Mat<f64> {
    let n = forward.states;
    let mut states = Mat::zeros(samples, n);
    let (mut gradient, mut column) = (vec![0.0; n], vec![0.0; n]);
    let mut left = forward.innovations.len();
    for sample in work::checked((0..samples).rev()) {
        if sample + 1 < samples {
            // r ← Aᵀ r.
            add_columns(&forward.by_rows, &gradient, &mut column);
            gradient.copy_from_slice(&column);
        }
        for i in forward.measured_at(sample, &mut left).rev() {
            // With L = I − K cᵀ: r ← c v/F + Lᵀ r.
            let innovation = &forward.innovations[i];
            let push = innovation.value / innovation.variance - dot(forward.gain(i), &gradient);
            forward.output[innovation.output].add_to(&mut gradient, push);
        }
        // P is symmetric: its rows are its columns.
        add_columns(forward.covariance(sample), &gradient, &mut column);
        for i in 0..n {
            states[(sample, i)] = forward.predicted[sample * n + i] + column[i];
        }
    }
    states
}

/// R ← R A.
fn root_through_transition(root: &mut [f64], a: &[SparseRow], column: &mut [f64]) {
    for row in root.chunks_exact_mut(a.len().max(1)) {
        column.fill(0.0);
        row.iter().zip(a).filter(|(value, _)| **value != 0.0).for_each(|(value, a)| a.add_to(column, *value));
        row.copy_from_slice(column);
    }
}

/// With L = I − K cᵀ, N ← c cᵀ/F + Lᵀ N L: R ← R L with the row cᵀ/√F below.
fn root_through_measurement(root: &mut Vec<f64>, c: &SparseRow, gain: &[f64], variance: f64) {
    for row in root.chunks_exact_mut(gain.len()) {
        let taken = dot(row, gain);
        c.add_to(row, -taken);
    }
    let end = root.len();
    root.resize(end + gain.len(), 0.0);
    c.add_to(&mut root[end..], 1.0 / variance.sqrt());
}

impl Known {
    /// From any R of n columns, and the covariance P of the state before later measurements, with P − P N P.
    fn new(root: Vec<f64>, p: &[f64], n: usize, number: usize) -> (Known, Vec<f64>) {
        let rows = root.len() / n.max(1);
        let factor = upper_factor(Mat::from_fn(rows, n, |i, j| root[i * n + j]));
        let mut root = vec![0.0; n * n];
        let mut explained = vec![0.0; n * n];
        for i in 0..factor.nrows() {
            (i..n).for_each(|j| root[i * n + j] = factor[(i, j)]);
            let row = &mut explained[i * n..(i + 1) * n];
            (i..n).for_each(|k| add_scaled(factor[(i, k)], &p[k * n..(k + 1) * n], row));
        }
        let mut information = vec![0.0; n * n];
        add_squares(1.0, &root, n, &mut information);
        let mut posterior = p.to_vec();
        add_squares(-1.0, &explained, n, &mut posterior);
        (Known { root, information, number }, posterior)
    }
}

/// Adds a multiple of MᵀM to a matrix, M being of n columns and by rows.
fn add_squares(factor: f64, m: &[f64], n: usize, sum: &mut [f64]) {
    for row in m.chunks_exact(n.max(1)) {
        for (value, sum) in row.iter().zip(sum.chunks_exact_mut(n)) {
            add_scaled(factor * value, row, sum);
        }
    }
}
