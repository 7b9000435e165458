//! Sampling of systems in state space.

use faer::{Mat, MatRef, Scale};

use super::{Discretisation, hold, matched, tustin};
use crate::error::{LtiError, check_sample_time};
use crate::matrix::{balance, inverse};
use crate::state_space::StateSpace;

impl StateSpace {
    /// This continuous system sampled.
    ///
    /// The holds keep `A`'s and `C`'s coordinates; [`StateSpace::to_discrete_foh`] keeps those of the state itself too.
    /// [`Discretisation::Matched`] needs one input and one output.
    ///
    /// # Errors
    /// [`LtiError::NotContinuous`], [`LtiError::SampleTime`], [`LtiError::NonFinite`] where an exponential overflows;
    /// [`LtiError::Frequency`] for a prewarping frequency beyond Nyquist's; [`LtiError::Singular`] for a pole at `2/T`
    /// (Tustin); [`LtiError::Improper`] for feed-through (impulse-invariant); [`LtiError::NotSiso`] (matched).
    ///
    /// # Example
    /// ```
    /// use lti::{Discretisation, TransferFunction};
    /// let lag = TransferFunction::continuous(vec![1.0], vec![1.0, 1.0])?.to_state_space()?;
    /// let tustin = Discretisation::Tustin { prewarp_rad_s: None };
    /// let pole = lag.to_discrete(tustin, 0.5)?.poles()?[0];
    /// assert!((pole.re - 0.75 / 1.25).abs() < 1e-15);
    /// # Ok::<(), lti::LtiError>(())
    /// ```
    ///
    /// # Source
    /// Franklin, G. F., Powell, J. D. and Workman, M. (1998), *Digital Control of Dynamic Systems*, ch. 6.
    pub fn to_discrete(&self, method: Discretisation, sample_time_s: f64) -> Result<Self, LtiError> {
        check_sample_time(sample_time_s)?;
        if self.sample_time_s().is_some() {
            return Err(LtiError::NotContinuous);
        }
        match method {
            Discretisation::ZeroOrderHold => self.to_discrete_zoh(sample_time_s),
            Discretisation::FirstOrderHold => self.to_discrete_foh(sample_time_s)?.to_state_space(),
            Discretisation::Tustin { prewarp_rad_s } => {
                tustin::discrete(self, tustin::step(sample_time_s, prewarp_rad_s)?, sample_time_s)
            }
            Discretisation::ImpulseInvariant => self.impulse_invariant(sample_time_s),
            Discretisation::Matched => {
                self.check_siso()?;
                matched::discrete(&self.to_zero_pole_gain(0, 0)?, sample_time_s)?.to_state_space()
            }
        }
    }

    /// The continuous system that this discrete one samples: what undoes [`StateSpace::to_discrete`], as far as no pole
    /// of the continuous system lies beyond the Nyquist frequency.
    ///
    /// # Errors
    /// [`LtiError::NotDiscrete`]; [`LtiError::NoLogarithm`] for a pole at zero or on the negative real axis (all but
    /// Tustin); [`LtiError::Singular`] for a pole at −1 (Tustin); [`LtiError::Frequency`]; [`LtiError::NotSiso`]
    /// (matched).
    pub fn to_continuous(&self, method: Discretisation) -> Result<Self, LtiError> {
        let sample_time_s = self.sample_time_s().ok_or(LtiError::NotDiscrete)?;
        match method {
            Discretisation::ZeroOrderHold => hold::zero_order_undone(self, sample_time_s),
            Discretisation::FirstOrderHold => hold::first_order_undone(self, sample_time_s),
            Discretisation::Tustin { prewarp_rad_s } => {
                tustin::continuous(self, tustin::step(sample_time_s, prewarp_rad_s)?)
            }
            Discretisation::ImpulseInvariant => self.impulse_invariant_undone(sample_time_s),
            Discretisation::Matched => {
                self.check_siso()?;
                matched::continuous(&self.to_zero_pole_gain(0, 0)?, sample_time_s)?.to_state_space()
            }
        }
    }

    /// This discrete system at another sample time.
    ///
    /// Under a zero-order hold and a whole multiple of the sample time this is exact for every system and input;
    /// otherwise the way goes through the continuous system.
    ///
    /// # Errors
    /// Those of [`StateSpace::to_continuous`] and [`StateSpace::to_discrete`].
    pub fn resampled(&self, method: Discretisation, sample_time_s: f64) -> Result<Self, LtiError> {
        check_sample_time(sample_time_s)?;
        let now = self.sample_time_s().ok_or(LtiError::NotDiscrete)?;
        match method {
            Discretisation::ZeroOrderHold => hold::lengthened(self, now, sample_time_s),
            other => self.to_continuous(other)?.to_discrete(other, sample_time_s),
        }
    }

    /// `h_k = T C e^{AkT} B` from `k = 0`.
    fn impulse_invariant(&self, sample_time_s: f64) -> Result<Self, LtiError> {
        if self.d().norm_max() != 0.0 {
            return Err(LtiError::Improper { numerator: self.states(), denominator: self.states() });
        }
        let (phi, _) = self.transition(sample_time_s)?;
        let b = &phi * self.b() * Scale(sample_time_s);
        let first = self.c() * self.b() * Scale(sample_time_s);
        // A response that starts at zero must not get a feed-through of rounding, and with it a zero far away.
        let rounding = 4.0 * f64::EPSILON * self.states() as f64;
        let terms = magnitudes(self.c()) * magnitudes(self.b()) * Scale(rounding * sample_time_s);
        let d = Mat::from_fn(first.nrows(), first.ncols(), |i, j| {
            if first[(i, j)].abs() <= terms[(i, j)] { 0.0 } else { first[(i, j)] }
        });
        Self::discrete(phi, b, self.c().to_owned(), d, sample_time_s)
    }

    fn impulse_invariant_undone(&self, sample_time_s: f64) -> Result<Self, LtiError> {
        let a = crate::logm(self.a())? * Scale(1.0 / sample_time_s);
        let before = crate::expm((&a * Scale(-sample_time_s)).as_ref())?;
        let b = before * self.b() * Scale(1.0 / sample_time_s);
        let first = self.c() * &b * Scale(sample_time_s);
        // D is the first sample of the impulse response, or there is feed-through that no impulse response has. Where
        // that sample is zero both are rounding, so their difference counts against the sizes of C and B.
        let (_, states) = balance(a.as_ref());
        let c = Mat::from_fn(self.outputs(), states.len(), |i, j| self.c()[(i, j)] * states[j]);
        let scaled = Mat::from_fn(states.len(), self.inputs(), |i, j| b[(i, j)] / states[i]);
        let terms = sample_time_s * c.norm_l2() * scaled.norm_l2();
        let missed = self.d() - &first;
        if missed.norm_max() > 1e-6 * terms.max(self.d().norm_max()) {
            return Err(LtiError::Improper { numerator: self.states(), denominator: self.states() });
        }
        // The smallest change of B that has `T C B = D`: without it rounding would be a zero far away.
        let b = match pseudo_inverse(self.c()) {
            Some(inverse) => b + inverse * missed * Scale(1.0 / sample_time_s),
            None => b,
        };
        let zero = Mat::zeros(self.outputs(), self.inputs());
        Self::continuous(a, b, self.c().to_owned(), zero)
    }
}

fn magnitudes(m: MatRef<'_, f64>) -> Mat<f64> {
    Mat::from_fn(m.nrows(), m.ncols(), |i, j| m[(i, j)].abs())
}

/// `C⁺`, where rows of C are independent.
fn pseudo_inverse(c: MatRef<'_, f64>) -> Option<Mat<f64>> {
    let gram = c * c.transpose();
    Some(c.transpose() * inverse(gram.as_ref())?)
}
