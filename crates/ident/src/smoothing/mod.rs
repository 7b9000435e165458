//! States of a linear system that noise moves, from measurements of it: Kalman filter, fixed-interval smoother, and the
//! likelihood of the noise levels.

mod backward;
mod forward;
mod likelihood;
mod steady;

use faer::{Mat, MatRef};
use lti::StateSpace;

use crate::IdentError;
use forward::Forward;
pub use likelihood::{Likeliest, likeliest};

/// A discrete system with noise in its states and on its outputs:
///
/// `x(k+1) = A x(k) + B u(k) + w(k)`, `y(k) = C x(k) + D u(k) + v(k)`, `Cov w = Q`, `Cov v = diag(r)`, both white, w
/// independent of v.
///
/// # Example
/// ```
/// use faer::{Mat, mat};
/// use ident::smoothing::{Belief, NoisySystem};
/// // A level that wanders, measured three times, the second time not at all.
/// let level = lti::StateSpace::discrete(mat![[1.0]], Mat::zeros(1, 0), mat![[1.0]], Mat::zeros(1, 0), 1.0)?;
/// let system = NoisySystem::new(level, mat![[1.0]], vec![1.0])?;
/// let start = Belief { mean: vec![0.0], covariance: mat![[1e9]] };
/// let outputs = mat![[1.0], [f64::NAN], [4.0]];
/// let smoothed = system.smooth(&start, Mat::zeros(3, 0).as_ref(), outputs.as_ref())?;
/// // Between two readings whose difference has the variance 1 + 1 + 1 + 1.
/// assert!((smoothed.states[(1, 0)] - 2.5).abs() < 1e-6);
/// assert!((smoothed.states[(0, 0)] - 1.75).abs() < 1e-6);
/// # Ok::<(), ident::IdentError>(())
/// ```
///
/// # Source
/// Durbin, J. and Koopman, S. J. (2012), *Time Series Analysis by State Space Methods*, 2nd ed., ch. 4 and 6.4.
#[derive(Debug, Clone, PartialEq)]
pub struct NoisySystem {
    system: StateSpace,
    process_covariance: Mat<f64>,
    measurement_variance: Vec<f64>,
}

/// What is known of a state: mean, and covariance.
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
    /// Covariances, one after the other, by rows.
    covariances: Vec<f64>,
}

impl Smoothed {
    /// The covariance of the state at a sample; none where there is no such sample.
    #[must_use]
    pub fn covariance(&self, sample: usize) -> Option<Mat<f64>> {
        let n = self.states.ncols();
        let square = self.covariances.get(sample * n * n..(sample + 1) * n * n)?;
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
        Ok((values, deviations.collect()))
    }
}

impl NoisySystem {
    /// A discrete system with the covariance `process_covariance` of what moves its states a sample (states × states), and
    /// the variances of what is added to its outputs.
    ///
    /// # Errors
    /// A continuous system, sizes that do not fit, values that are not finite, variances below zero.
    pub fn new(
        system: StateSpace,
        process_covariance: Mat<f64>,
        measurement_variance: Vec<f64>,
    ) -> Result<Self, IdentError> {
        if system.sample_time_s().is_none() {
            return Err(IdentError::Lti(lti::LtiError::NotDiscrete));
        }
        let n = system.states();
        check_length("measurement variances", system.outputs(), measurement_variance.len())?;
        check_square("process covariance", n, process_covariance.as_ref())?;
        let is_variance = |v: f64| v.is_finite() && v >= 0.0;
        let variances = (0..n).map(|i| process_covariance[(i, i)]).chain(measurement_variance.iter().copied());
        match variances.into_iter().all(is_variance) {
            true => Ok(NoisySystem { system, process_covariance, measurement_variance }),
            false => Err(IdentError::Structure { what: "a variance of the noise is below zero or not finite" }),
        }
    }

    /// The system without its noise.
    #[must_use]
    pub fn system(&self) -> &StateSpace {
        &self.system
    }

    /// States and their covariance at every sample, given all measurements.
    ///
    /// `inputs` is samples × inputs, `outputs` samples × outputs; an output that was not measured is NaN. `start` is what
    /// is known of x(0) before the first measurement; where that is nothing, a covariance that is large but not beyond 10¹²
    /// times what the measurements leave of it.
    ///
    /// The backward pass is Bryson and Frazier's form of the smoother of Rauch, Tung and Striebel: the same numbers without
    /// the inverse of the predicted covariance, which is singular where noise does not reach every state. Measurements of
    /// a sample are taken up one after the other.
    ///
    /// # Errors
    /// Sizes that do not fit; inputs that are not finite; measurements that noise and start leave no room for.
    ///
    /// # Source
    /// Bryson & Frazier (1963); Koopman & Durbin (2000), *Fast filtering and smoothing for multivariate state space models*.
    pub fn smooth(
        &self,
        start: &Belief,
        inputs: MatRef<'_, f64>,
        outputs: MatRef<'_, f64>,
    ) -> Result<Smoothed, IdentError> {
        let forward = Forward::run(self, start, inputs, outputs, true)?;
        Ok(backward::smooth(&forward, outputs))
    }

    /// ln p(y), in nats: how likely the measurements are. Arguments and errors as of [`NoisySystem::smooth`].
    ///
    /// # Errors
    /// Those of [`NoisySystem::smooth`].
    pub fn log_likelihood(
        &self,
        start: &Belief,
        inputs: MatRef<'_, f64>,
        outputs: MatRef<'_, f64>,
    ) -> Result<f64, IdentError> {
        Ok(Forward::run(self, start, inputs, outputs, false)?.log_likelihood())
    }

    /// Innovations over their standard deviations, in the order in which they were measured: white, of variance one, where
    /// the system is right. Arguments and errors as of [`NoisySystem::smooth`].
    ///
    /// # Errors
    /// Those of [`NoisySystem::smooth`].
    pub fn innovations(
        &self,
        start: &Belief,
        inputs: MatRef<'_, f64>,
        outputs: MatRef<'_, f64>,
    ) -> Result<Vec<f64>, IdentError> {
        let forward = Forward::run(self, start, inputs, outputs, false)?;
        Ok(forward.innovations.iter().map(|one| one.value / one.variance.sqrt()).collect())
    }
}

fn check_length(what: &'static str, expected: usize, found: usize) -> Result<(), IdentError> {
    if expected == found { Ok(()) } else { Err(IdentError::Length { what, expected, found }) }
}

fn check_square(what: &'static str, n: usize, m: MatRef<'_, f64>) -> Result<(), IdentError> {
    check_length(what, n, m.nrows())?;
    check_length(what, n, m.ncols())
}
