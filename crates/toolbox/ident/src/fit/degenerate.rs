//! Doubts about an estimate from degenerate data.

use faer::Mat;
use numerics::linalg::{self, Cholesky};

use crate::{Dataset, Doubt, Fit, Triangle};
use fitting::equation::factor_of;

/// Unexplained part of an input, relative to its variation, below which it counts as a combination of others.
const SAME_INPUT: f64 = 1e-11;
/// As much is left of one that was written with six digits, as a part of its size with its mean; a larger part of its
/// variation than the other is not rounding.
const WRITTEN: f64 = 1e-6;
const MOST_ROUNDED: f64 = 1e-4;
/// Shares of an input below this are rounding.
const SHARE: f64 = 1e-8;
/// Relative difference of two equal errors, below which their covariance is rounding.
const SAME_ERROR: f64 = 1e-7;

impl<M> Fit<M> {
    /// The same with what its data make doubtful: inputs or errors that depend on each other, and errors that vanish.
    pub(crate) fn doubting(mut self, data: &Dataset) -> Self {
        let dependent = dependent_inputs(data).into_iter();
        self.doubts.extend(dependent.map(|Combination { input, .. }| Doubt::DependentInputs { input }));
        self.doubting_errors()
    }

    /// The same with what its errors make doubtful.
    pub(crate) fn doubting_errors(mut self) -> Self {
        let outputs = 0..self.noise_covariance.nrows();
        let nothing: Vec<usize> = outputs.filter(|i| !self.noise_covariance[(*i, *i)].is_normal()).collect();
        let dependent = if nothing.is_empty() { dependent_outputs(&self.noise_covariance) } else { None };
        if dependent.is_some() {
            // Rounding leaves the determinant of a singular covariance anything.
            self.loss = 0.0;
        }
        self.doubts.extend(nothing.into_iter().map(|output| Doubt::NothingLeft { output }));
        self.doubts.extend(dependent.map(|output| Doubt::DependentOutputs { output }));
        self
    }
}

/// The first output whose errors those before it explain.
fn dependent_outputs(covariance: &Mat<f64>) -> Option<usize> {
    let size = |i: usize| covariance[(i, i)].sqrt();
    let of = |n: usize| Mat::from_fn(n, n, |i, j| covariance[(i, j)] / size(i) / size(j));
    (2..=covariance.nrows()).find_map(|n| {
        let independent = Cholesky::new(of(n).as_ref()).is_ok_and(|factor| factor.lower()[(n - 1, n - 1)] > SAME_ERROR);
        (!independent).then_some(n - 1)
    })
}

/// An input that is `Σ weight · u_j + level`.
pub(crate) struct Combination {
    pub(crate) input: usize,
    /// Inputs before it and their weights; none for a constant.
    pub(crate) of: Vec<(usize, f64)>,
    pub(crate) level: f64,
}

/// Inputs that are linear combinations of those before them and a constant.
pub(crate) fn dependent_inputs(data: &Dataset) -> Vec<Combination> {
    let m = data.inputs();
    if m < 2 {
        return Vec::new();
    }
    let size = |k: usize| {
        let values = data.experiments().iter().flat_map(|e| e.input(k)).filter(|v| !v.is_nan());
        values.fold(0.0, |size: f64, v| size.max(v.abs()))
    };
    let sizes: Vec<f64> = (0..m).map(size).collect();
    let mut triangle = Triangle::new(m + 1);
    let mut row = vec![1.0; m + 1];
    for e in data.experiments() {
        for t in work::checked(0..e.len()) {
            for (k, slot) in row[1..].iter_mut().enumerate() {
                *slot = if sizes[k] > 0.0 { e.input(k)[t] / sizes[k] } else { 0.0 };
            }
            if row.iter().all(|v| !v.is_nan()) {
                triangle.push_row(&row);
            }
        }
    }
    let factor = triangle.finish();
    // The first row is the mean: what varies lies below it.
    let varying = |j: usize| (1..=j).map(|i| factor[(i, j)].powi(2)).sum::<f64>().sqrt();
    let mut found = Vec::new();
    // Columns that do not depend on those before them, the constant first. Others are left out: beside them a later
    // column would look dependent too.
    let mut independent = vec![0];
    for j in 1..=m {
        let own = factor_of(&factor, &[independent.as_slice(), &[j]].concat());
        let left = own[(own.ncols() - 1, own.ncols() - 1)].abs();
        let rounded = (WRITTEN * factor.col(j).norm_l2()).min(MOST_ROUNDED * varying(j));
        if j == 1 || left > rounded.max(SAME_INPUT * varying(j)) {
            independent.push(j);
        } else {
            found.push(combination(&own, &sizes, &independent, j - 1));
        }
    }
    found
}

/// The last column of a factor by the others, which are the constant and inputs; `named` says which.
fn combination(own: &Mat<f64>, sizes: &[f64], named: &[usize], input: usize) -> Combination {
    let n = named.len();
    let mut weights = own.get(..n, n..).to_owned();
    linalg::solve_upper(own.get(..n, ..n), weights.as_mut());
    let size = sizes[input];
    let matters = |(_, weight): &(usize, f64)| weight.is_finite() && weight.abs() > SHARE;
    let of = named.iter().enumerate().skip(1).map(|(i, column)| (column - 1, weights[(i, 0)])).filter(matters);
    let of = of.map(|(input, weight)| (input, weight * size / sizes[input])).collect();
    let level = Some(weights[(0, 0)]).filter(|level| level.is_finite() && level.abs() > SHARE).unwrap_or(0.0);
    Combination { input, of, level: level * size }
}
