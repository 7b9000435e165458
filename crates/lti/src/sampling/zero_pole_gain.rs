//! Sampling of zeros, poles and gain.

use super::{Discretisation, matched};
use crate::error::LtiError;
use crate::zero_pole_gain::ZeroPoleGain;

impl ZeroPoleGain {
    /// This continuous system sampled; no polynomial is formed on the way. The delay has to be whole samples and stays;
    /// see [`StateSpace::to_discrete`](crate::StateSpace::to_discrete).
    ///
    /// # Errors
    /// Those of [`StateSpace::to_discrete`](crate::StateSpace::to_discrete), [`LtiError::FractionalDelay`],
    /// [`LtiError::Improper`].
    pub fn to_discrete(&self, method: Discretisation, sample_time_s: f64) -> Result<Self, LtiError> {
        crate::error::check_sample_time(sample_time_s)?;
        if self.sample_time_s().is_some() {
            return Err(LtiError::NotContinuous);
        }
        let lag = crate::delayed::Lag::new(self.delay_s(), sample_time_s)?;
        if lag.fraction() > 0.0 {
            return Err(LtiError::FractionalDelay { delay_s: self.delay_s(), sample_time_s });
        }
        let sampled = match method {
            Discretisation::Matched => matched::discrete(self, sample_time_s)?,
            other => self
                .clone()
                .with_delay(0.0)?
                .to_state_space()?
                .to_discrete(other, sample_time_s)?
                .to_zero_pole_gain(0, 0)?,
        };
        sampled.with_delay(lag.whole() as f64 * sample_time_s)
    }

    /// The continuous system that this discrete one samples, with the same delay; see
    /// [`StateSpace::to_continuous`](crate::StateSpace::to_continuous).
    ///
    /// # Errors
    /// Those of [`StateSpace::to_continuous`](crate::StateSpace::to_continuous), [`LtiError::Improper`].
    pub fn to_continuous(&self, method: Discretisation) -> Result<Self, LtiError> {
        let sample_time_s = self.sample_time_s().ok_or(LtiError::NotDiscrete)?;
        let continuous = match method {
            Discretisation::Matched => matched::continuous(self, sample_time_s)?,
            other => self.clone().with_delay(0.0)?.to_state_space()?.to_continuous(other)?.to_zero_pole_gain(0, 0)?,
        };
        continuous.with_delay(self.delay_s())
    }
}
