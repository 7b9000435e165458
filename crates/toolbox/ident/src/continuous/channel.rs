//! Interface of a channel of a continuous model.

use lti::{LtiError, TransferFunction};

use crate::Parametric;

/// Degree of the numerator and number of poles of a transfer function.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Degrees {
    /// Degree of the numerator.
    pub numerator: usize,
    /// Number of poles.
    pub poles: usize,
}

/// The way from one input to one output of a [`ContinuousModel`](crate::ContinuousModel), with parameters of its own.
pub trait ContinuousChannel: Parametric + Sync {
    /// Degrees of the structure.
    fn degrees(&self) -> Degrees;

    /// Which parameter is the delay in seconds, where there is one.
    fn delay_parameter(&self) -> Option<usize>;

    /// Parameters whose intervals a profile of the errors has to confirm: that of the delay at least.
    fn profiled_parameters(&self) -> Vec<usize> {
        self.delay_parameter().into_iter().collect()
    }

    /// The same with equal time constants a little apart, where there are any: where two are equal no data separate
    /// them, and nothing says how certain they are.
    fn apart(&self) -> Option<Self> {
        None
    }

    /// The continuous transfer function at the parameters; numerator and denominator are polynomials of degree two at
    /// most in each single parameter.
    ///
    /// # Errors
    /// Parameters at which there is none.
    fn transfer_function(&self) -> Result<TransferFunction, LtiError>;
}
