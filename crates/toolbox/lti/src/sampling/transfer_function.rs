//! Sampling of transfer functions, with their delays.

use super::{Discretisation, matched, tustin};
use crate::delayed::Lag;
use crate::error::{LtiError, check_sample_time};
use crate::transfer_function::TransferFunction;

impl TransferFunction {
    /// This continuous system sampled; see [`StateSpace::to_discrete`](crate::StateSpace::to_discrete).
    ///
    /// Whole samples of the delay stay a delay. What is left of it is exact under the zero-order hold and for the
    /// impulse response, which change the numerator by it, and refused by the other methods.
    ///
    /// # Errors
    /// Those of [`StateSpace::to_discrete`](crate::StateSpace::to_discrete); [`LtiError::FractionalDelay`],
    /// [`LtiError::Delay`] for more than 1e9 samples; [`LtiError::Improper`] where the holds get a numerator of the
    /// higher degree.
    ///
    /// # Example
    /// ```
    /// use lti::{Discretisation, TransferFunction};
    /// // An integrator behind a quarter of a sample and one more: (0.75 z + 0.25) / (z (z − 1)), one sample late.
    /// let late = TransferFunction::continuous(vec![1.0], vec![1.0, 0.0])?.with_delay(1.25)?;
    /// let sampled = late.to_discrete(Discretisation::ZeroOrderHold, 1.0)?;
    /// assert!((sampled.num()[0] - 0.75).abs() < 1e-12 && (sampled.num()[1] - 0.25).abs() < 1e-12);
    /// assert_eq!((sampled.den().len(), sampled.delay_s()), (3, 1.0));
    /// # Ok::<(), lti::LtiError>(())
    /// ```
    pub fn to_discrete(&self, method: Discretisation, sample_time_s: f64) -> Result<Self, LtiError> {
        check_sample_time(sample_time_s)?;
        if self.sample_time_s().is_some() {
            return Err(LtiError::NotContinuous);
        }
        let lag = Lag::new(self.delay_s(), sample_time_s)?;
        let ratio = self.clone().with_delay(0.0)?;
        let sampled = match method {
            Discretisation::ZeroOrderHold if lag.fraction() > 0.0 => {
                let late = [lag.fraction() * sample_time_s];
                let system = ratio.to_state_space()?.to_discrete_delayed(&late, sample_time_s)?;
                system.to_state_space()?.to_transfer_function()?
            }
            Discretisation::ImpulseInvariant if lag.fraction() > 0.0 => {
                return ratio.late_impulse(lag, sample_time_s);
            }
            _ if lag.fraction() > 0.0 => {
                return Err(LtiError::FractionalDelay { delay_s: self.delay_s(), sample_time_s });
            }
            Discretisation::Tustin { prewarp_rad_s } => {
                tustin::discrete_ratio(&ratio, tustin::step(sample_time_s, prewarp_rad_s)?, sample_time_s)?
            }
            Discretisation::Matched => {
                matched::discrete(&ratio.to_zero_pole_gain()?, sample_time_s)?.to_transfer_function()?
            }
            hold => ratio.to_state_space()?.to_discrete(hold, sample_time_s)?.to_transfer_function()?,
        };
        sampled.with_delay(lag.whole() as f64 * sample_time_s)
    }

    /// The continuous system that this discrete one samples, with the same delay; what undoes
    /// [`TransferFunction::to_discrete`] but for a delay that is not whole samples.
    ///
    /// # Errors
    /// Those of [`StateSpace::to_continuous`](crate::StateSpace::to_continuous); [`LtiError::Improper`] where the holds
    /// get a numerator of the higher degree.
    pub fn to_continuous(&self, method: Discretisation) -> Result<Self, LtiError> {
        let sample_time_s = self.sample_time_s().ok_or(LtiError::NotDiscrete)?;
        let ratio = self.clone().with_delay(0.0)?;
        let continuous = match method {
            Discretisation::Tustin { prewarp_rad_s } => {
                tustin::continuous_ratio(&ratio, tustin::step(sample_time_s, prewarp_rad_s)?)?
            }
            Discretisation::Matched => {
                matched::continuous(&ratio.to_zero_pole_gain()?, sample_time_s)?.to_transfer_function()?
            }
            hold => ratio.to_state_space()?.to_continuous(hold)?.to_transfer_function()?,
        };
        continuous.with_delay(self.delay_s())
    }

    /// This discrete system at another sample time; see [`StateSpace::resampled`](crate::StateSpace::resampled). But
    /// for the zero-order hold and the impulse response the delay has to be whole samples of the new sample time.
    ///
    /// # Errors
    /// Those of [`StateSpace::resampled`](crate::StateSpace::resampled), [`LtiError::FractionalDelay`].
    pub fn resampled(&self, method: Discretisation, sample_time_s: f64) -> Result<Self, LtiError> {
        check_sample_time(sample_time_s)?;
        let is_whole = Lag::new(self.delay_s(), sample_time_s)?.fraction() == 0.0;
        if method != Discretisation::ZeroOrderHold || !is_whole {
            return self.to_continuous(method)?.to_discrete(method, sample_time_s);
        }
        let system = self.clone().with_delay(0.0)?.to_state_space()?.resampled(method, sample_time_s)?;
        system.to_transfer_function()?.with_delay(self.delay_s())
    }

    /// The impulse response of a system behind a delay that falls between samples: it starts at the sample after.
    fn late_impulse(&self, lag: Lag, sample_time_s: f64) -> Result<Self, LtiError> {
        let system = self.to_state_space()?.started_late((1.0 - lag.fraction()) * sample_time_s)?;
        let sampled = system.to_discrete(Discretisation::ImpulseInvariant, sample_time_s)?;
        sampled.to_transfer_function()?.with_delay((lag.whole() + 1) as f64 * sample_time_s)
    }
}
