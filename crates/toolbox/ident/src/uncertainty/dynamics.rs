//! [`Dynamics`]: what poles, zeros and frequency responses are computed from.

use lti::polynomial::multiply;
use lti::{Complex64, FrequencyResponse, Innovations, LtiError, PolynomialModel, StateSpace};

use crate::{ContinuousChannel, ContinuousModel, GreyBoxModel, StateSpaceModel, Structure};

/// A ratio of polynomials in descending powers of `s` or `z`.
#[derive(Debug, Clone, PartialEq)]
pub struct Ratio {
    /// The numerator.
    pub numerator: Vec<f64>,
    /// The denominator.
    pub denominator: Vec<f64>,
}

/// A model whose way from inputs to outputs is a linear system in its own time, continuous or discrete.
pub trait Dynamics {
    /// The system from inputs to outputs, without the delays of [`Dynamics::delay_s`]. Its matrices must be smooth
    /// functions of the parameters.
    ///
    /// # Errors
    /// Where the model has no such system.
    fn system(&self) -> Result<StateSpace, LtiError>;

    /// The delay from an input to an output that [`Dynamics::system`] leaves out, in seconds: that of a continuous
    /// model. A discrete model holds its delays as states.
    ///
    /// # Errors
    /// [`LtiError::Index`].
    fn delay_s(&self, _output: usize, _input: usize) -> Result<f64, LtiError> {
        Ok(0.0)
    }

    /// The ratio from an input to an output, delays left out, where the model is written in polynomials; `None` where
    /// it is not. Their roots are the poles and zeros then.
    ///
    /// # Errors
    /// [`LtiError::Index`].
    fn polynomials(&self, _output: usize, _input: usize) -> Result<Option<Ratio>, LtiError> {
        Ok(None)
    }

    /// The gain from an input to an output at angular frequencies in rad/s, delays included.
    ///
    /// # Errors
    /// [`LtiError::Index`], [`LtiError::NonFinite`].
    fn frequency_response(
        &self,
        output: usize,
        input: usize,
        omega_rad_s: &[f64],
    ) -> Result<FrequencyResponse, LtiError> {
        self.system()?.frequency_response(output, input, omega_rad_s)
    }
}

impl Dynamics for Innovations {
    fn system(&self) -> Result<StateSpace, LtiError> {
        Ok(Innovations::system(self).clone())
    }
}

impl Dynamics for PolynomialModel {
    fn system(&self) -> Result<StateSpace, LtiError> {
        Ok(self.innovations()?.system().clone())
    }

    fn polynomials(&self, output: usize, input: usize) -> Result<Option<Ratio>, LtiError> {
        match self.transfer_function(output, input) {
            Err(LtiError::OutputsCoupled { .. }) => return Ok(None),
            other => other?,
        };
        let e = &self.equations()[output];
        let monic = |p: &[f64]| std::iter::once(1.0).chain(p.iter().copied()).collect::<Vec<_>>();
        let denominator = multiply(&monic(&e.a[output]), &monic(&e.f[input]));
        Ok(Some(Ratio { numerator: e.b[input].clone(), denominator }))
    }
}

impl Dynamics for StateSpaceModel {
    fn system(&self) -> Result<StateSpace, LtiError> {
        Ok(StateSpaceModel::system(self).clone())
    }
}

impl<C: ContinuousChannel> Dynamics for ContinuousModel<C> {
    fn system(&self) -> Result<StateSpace, LtiError> {
        self.without_delays()
    }

    fn delay_s(&self, output: usize, input: usize) -> Result<f64, LtiError> {
        Ok(self.transfer_function(output, input)?.delay_s())
    }

    fn polynomials(&self, output: usize, input: usize) -> Result<Option<Ratio>, LtiError> {
        let h = self.transfer_function(output, input)?;
        Ok(Some(Ratio { numerator: h.num().to_vec(), denominator: h.den().to_vec() }))
    }

    fn frequency_response(
        &self,
        output: usize,
        input: usize,
        omega_rad_s: &[f64],
    ) -> Result<FrequencyResponse, LtiError> {
        self.transfer_function(output, input)?.frequency_response(omega_rad_s)
    }
}

impl<S: Structure> Dynamics for GreyBoxModel<S> {
    fn system(&self) -> Result<StateSpace, LtiError> {
        GreyBoxModel::system(self)
    }

    fn delay_s(&self, _output: usize, input: usize) -> Result<f64, LtiError> {
        Ok(self.input_delay_s(input))
    }

    fn frequency_response(
        &self,
        output: usize,
        input: usize,
        omega_rad_s: &[f64],
    ) -> Result<FrequencyResponse, LtiError> {
        let mut found = self.system()?.frequency_response(output, input, omega_rad_s)?;
        let delay_s = self.input_delay_s(input);
        for (gain, omega) in found.response.iter_mut().zip(omega_rad_s) {
            *gain *= Complex64::cis(-omega * delay_s);
        }
        Ok(found)
    }
}
