//! States of a linear system that noise moves, from measurements of it: Kalman filter, fixed-interval smoother, and the
//! likelihood of the noise levels.

mod backward;
mod forward;
mod likelihood;
mod sparse;
mod steady;
mod system;

use faer::{Mat, MatRef};
use lti::StateSpace;

use crate::IdentError;
use crate::structure_error::StructureError;
use forward::Forward;
pub use likelihood::{Likeliest, likeliest};
pub use system::{Belief, NoisySystem, Smoothed};
use system::{check_length, check_square};

impl NoisySystem {
    /// A discrete system with the covariance `process_covariance` of what moves its states a sample (states × states),
    /// and the variances of what is added to its outputs.
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
        let is_none = |v: &f64| !(v.is_finite() && *v >= 0.0);
        let mut variances = (0..n).map(|i| process_covariance[(i, i)]).chain(measurement_variance.iter().copied());
        match variances.find(is_none) {
            None => Ok(NoisySystem { system, process_covariance, measurement_variance }),
            Some(value) => Err(StructureError::NoiseVariance { value }.into()),
        }
    }

    /// The system without its noise.
    #[must_use]
    pub fn system(&self) -> &StateSpace {
        &self.system
    }

    /// States and their covariance at every sample, given all measurements.
    ///
    /// `inputs` is samples × inputs, `outputs` samples × outputs; an output that was not measured is NaN. `start` is
    /// what is known of x(0) before the first measurement; where that is nothing, a covariance that is large but not
    /// beyond 10¹² times what the measurements leave of it.
    ///
    /// The backward pass is Bryson and Frazier's form of the smoother of Rauch, Tung and Striebel: the same numbers
    /// without the inverse of the predicted covariance, which is singular where noise does not reach every state.
    /// Measurements of a sample are taken up one after the other.
    ///
    /// # Errors
    /// Sizes that do not fit; inputs that are not finite; measurements that noise and start leave no room for.
    ///
    /// # Source
    /// Bryson & Frazier (1963); Koopman & Durbin (2000), *Fast filtering and smoothing for multivariate state space
    /// models*.
    pub fn smooth(
        &self,
        start: &Belief,
        inputs: MatRef<'_, f64>,
        outputs: MatRef<'_, f64>,
    ) -> Result<Smoothed, IdentError> {
        let forward = Forward::run(self, start, inputs, outputs, true)?;
        Ok(backward::smooth(&forward, outputs))
    }

    /// The states alone of [`NoisySystem::smooth`], without their covariances: far faster. Arguments and errors are the
    /// same.
    ///
    /// # Errors
    /// Those of [`NoisySystem::smooth`].
    pub fn smooth_states(
        &self,
        start: &Belief,
        inputs: MatRef<'_, f64>,
        outputs: MatRef<'_, f64>,
    ) -> Result<Mat<f64>, IdentError> {
        let forward = Forward::run(self, start, inputs, outputs, true)?;
        Ok(backward::smoothed_states(&forward, outputs.nrows()))
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

    /// Innovations over their standard deviations, in the order in which they were measured: white, of variance one,
    /// where the system is right. Arguments and errors as of [`NoisySystem::smooth`].
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
