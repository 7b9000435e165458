//! A system with noise, and what is known of its states.

use faer::{Mat, MatRef};
use lti::StateSpace;

use crate::IdentError;

/// A discrete system with noise in its states and on its outputs:
///
/// `x(k+1) = A x(k) + B u(k) + w(k)`, `y(k) = C x(k) + D u(k) + v(k)`, `Cov w = Q`, `Cov v = diag(r)`, both white, w
/// independent of v.
///
/// # Example
/// ```
/// use faer::{Mat, mat};
/// use fitting::smoothing::{Belief, NoisySystem};
/// // A level that wanders, measured three times, the second time not at all.
/// let level = lti::StateSpace::discrete(mat![[1.0]], Mat::zeros(1, 0), mat![[1.0]], Mat::zeros(1, 0), 1.0)?;
/// let system = NoisySystem::new(level, mat![[1.0]], vec![1.0])?;
/// let start = Belief { mean: vec![0.0], covariance: mat![[1e9]] };
/// let outputs = mat![[1.0], [f64::NAN], [4.0]];
/// let smoothed = system.smooth(&start, Mat::zeros(3, 0).as_ref(), outputs.as_ref())?;
/// // Between two readings whose difference has the variance 1 + 1 + 1 + 1.
/// assert!((smoothed.states[(1, 0)] - 2.5).abs() < 1e-6);
/// assert!((smoothed.states[(0, 0)] - 1.75).abs() < 1e-6);
/// # Ok::<(), fitting::IdentError>(())
/// ```
///
/// # Source
/// Durbin, J. and Koopman, S. J. (2012), *Time Series Analysis by State Space Methods*, 2nd ed., ch. 4 and 6.4.
#[derive(Debug, Clone, PartialEq)]
pub struct NoisySystem {
    pub(super) system: StateSpace,
    pub(super) process_covariance: Mat<f64>,
    pub(super) measurement_variance: Vec<f64>,
}

/// Knowledge of a state: mean, and covariance.
#[derive(Debug, Clone, PartialEq)]
pub struct Belief {
    /// Mean.
    pub mean: Vec<f64>,
    /// Covariance, states × states.
    pub covariance: Mat<f64>,
}

/// The states of every sample, given all measurements.
#[derive(Debug, Clone, PartialEq)]
pub struct Smoothed {
    /// Means; rows are samples, columns states.
    pub states: Mat<f64>,
    /// ln p(y), in nats.
    pub log_likelihood: f64,
    /// The covariances that differ, one after the other, by rows.
    pub(super) covariances: Vec<f64>,
    /// Which of them is that of each sample.
    pub(super) of_sample: Vec<usize>,
}

impl Smoothed {
    /// The covariance of the state at a sample; none where there is no such sample.
    #[must_use]
    pub fn covariance(&self, sample: usize) -> Option<Mat<f64>> {
        let n = self.states.ncols();
        let place = *self.of_sample.get(sample)?;
        let square = self.covariances.get(place * n * n..(place + 1) * n * n)?;
        Some(Mat::from_fn(n, n, |i, j| square[i * n + j]))
    }

    /// `cᵀx` at every sample, and its standard deviation.
    ///
    /// # Errors
    /// As many weights as states are needed.
    pub fn combination(&self, weights: &[f64]) -> Result<(Vec<f64>, Vec<f64>), IdentError> {
        let n = self.states.ncols();
        check_length("weights", n, weights.len())?;
        let value = |k: usize| (0..n).map(|i| weights[i] * self.states[(k, i)]).sum();
        let values = (0..self.states.nrows()).map(value).collect();
        let pairs = |square: &[f64]| -> f64 {
            (0..n).map(|i| weights[i] * (0..n).map(|j| square[i * n + j] * weights[j]).sum::<f64>()).sum()
        };
        let deviations = self.covariances.chunks_exact((n * n).max(1)).map(|square| pairs(square).max(0.0).sqrt());
        let deviations: Vec<f64> = deviations.collect();
        Ok((values, self.of_sample.iter().map(|place| deviations.get(*place).copied().unwrap_or(0.0)).collect()))
    }
}

pub(super) fn check_length(what: &'static str, expected: usize, found: usize) -> Result<(), IdentError> {
    if expected == found { Ok(()) } else { Err(IdentError::Length { what, expected, found }) }
}

pub(super) fn check_square(what: &'static str, n: usize, m: MatRef<'_, f64>) -> Result<(), IdentError> {
    check_length(what, n, m.nrows())?;
    check_length(what, n, m.ncols())
}
