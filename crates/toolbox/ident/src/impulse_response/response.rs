//! [`ImpulseFit`]: estimated responses over time.

use lti::{LtiError, PolynomialModel};

use super::Hyperparameters;
use crate::{Fit, IdentError};

/// An estimate of impulse responses.
#[derive(Debug, Clone, PartialEq)]
pub struct ImpulseFit {
    /// The responses as a model whose only polynomials are `B`. With a prior, its covariance is that of the posterior,
    /// outputs taken as independent, and its degrees of freedom count effective parameters.
    pub fit: Fit<PolynomialModel>,
    /// Tuned parameters of the kernels: one row an output, one column an input; empty without a kernel.
    pub hyperparameters: Vec<Vec<Hyperparameters>>,
}

/// A response over time with its standard error.
#[derive(Debug, Clone, PartialEq)]
pub struct ResponseEstimate {
    /// Time, in seconds.
    pub time_s: Vec<f64>,
    /// The response at that time.
    pub value: Vec<f64>,
    /// Its standard error.
    pub standard_error: Vec<f64>,
}

impl ImpulseFit {
    /// The response of an output to an impulse at an input, one sample long and of height one.
    ///
    /// # Errors
    /// [`IdentError::Lti`] for a channel there is not.
    pub fn impulse(&self, output: usize, input: usize) -> Result<ResponseEstimate, IdentError> {
        let first = self.first_parameter(output, input)?;
        Ok(self.over_time(output, input, |j| {
            let variance = self.fit.covariance[(first + j, first + j)];
            (self.taps(output, input)[j], variance)
        }))
    }

    /// The response of an output to a step of height one at an input: the impulse response summed up.
    ///
    /// # Errors
    /// Those of [`ImpulseFit::impulse`].
    pub fn step(&self, output: usize, input: usize) -> Result<ResponseEstimate, IdentError> {
        let first = self.first_parameter(output, input)?;
        let (mut value, mut variance) = (0.0, 0.0);
        Ok(self.over_time(output, input, |j| {
            let covariance = |l: usize| self.fit.covariance[(first + l, first + j)];
            value += self.taps(output, input)[j];
            variance += covariance(j) + 2.0 * (0..j).map(covariance).sum::<f64>();
            (value, variance)
        }))
    }

    fn taps(&self, output: usize, input: usize) -> &[f64] {
        &self.fit.model.equations()[output].b[input]
    }

    /// Index of the first coefficient of one response.
    fn first_parameter(&self, output: usize, input: usize) -> Result<usize, IdentError> {
        let (outputs, inputs) = (self.fit.model.outputs(), self.fit.model.inputs());
        for (what, index, count) in [("output", output, outputs), ("input", input, inputs)] {
            if index >= count {
                return Err(LtiError::Index { what, index, count }.into());
            }
        }
        Ok((output * inputs + input) * self.taps(output, input).len())
    }

    fn over_time(
        &self,
        output: usize,
        input: usize,
        mut value_and_variance: impl FnMut(usize) -> (f64, f64),
    ) -> ResponseEstimate {
        let delay = self.fit.model.equations()[output].nk[input];
        let count = self.taps(output, input).len();
        let mut response = ResponseEstimate { time_s: Vec::new(), value: Vec::new(), standard_error: Vec::new() };
        for j in 0..count {
            let (value, variance) = value_and_variance(j);
            response.time_s.push((delay + j) as f64 * self.fit.model.sample_time_s());
            response.value.push(value);
            response.standard_error.push(variance.max(0.0).sqrt());
        }
        response
    }
}
