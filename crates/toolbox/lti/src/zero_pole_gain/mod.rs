//! [`ZeroPoleGain`]: a gain, its zeros and its poles.

mod cancel;
mod roots;
mod sections;

use serde::{Deserialize, Serialize};

use crate::Complex64;
use crate::error::{LtiError, check_delay, check_finite, check_sample_time};
use crate::frequency_response::FrequencyResponse;
use crate::polynomial::from_roots;
use crate::state_space::{StateSpace, frequency_point};
use crate::transfer_function::TransferFunction;

/// One input, one output: `H(s) = k Π(s − zᵢ) / Π(s − pᵢ) · e^{−s·delay}`, or the same in `z` with `z^{−delay/T}`.
///
/// Roots off the real axis come in conjugate pairs. This form keeps roots that lie close together, such as the slow
/// poles of a system sampled fast; the coefficients of a polynomial would lose them.
///
/// # Example
/// ```
/// use lti::{Complex64, ZeroPoleGain};
/// let pair = vec![Complex64::new(-1.0, 2.0), Complex64::new(-1.0, -2.0)];
/// let mode = ZeroPoleGain::continuous(vec![], pair, 5.0)?;
/// assert!((mode.dc_gain() - 1.0).abs() < 1e-15);
/// assert_eq!(mode.to_transfer_function()?.den(), [1.0, 2.0, 5.0]);
/// # Ok::<(), lti::LtiError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(with = "Parts"))]
#[serde(try_from = "Parts", into = "Parts")]
pub struct ZeroPoleGain {
    zeros: Vec<Complex64>,
    poles: Vec<Complex64>,
    gain: f64,
    delay_s: f64,
    sample_time_s: Option<f64>,
}

/// How it is written down: a root as its real and imaginary part.
#[derive(Clone, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct Parts {
    zeros: Vec<(f64, f64)>,
    poles: Vec<(f64, f64)>,
    gain: f64,
    delay_s: f64,
    sample_time_s: Option<f64>,
}

impl From<ZeroPoleGain> for Parts {
    fn from(whole: ZeroPoleGain) -> Self {
        let written = |roots: &[Complex64]| roots.iter().map(|r| (r.re, r.im)).collect();
        Self {
            zeros: written(&whole.zeros),
            poles: written(&whole.poles),
            gain: whole.gain,
            delay_s: whole.delay_s,
            sample_time_s: whole.sample_time_s,
        }
    }
}

impl TryFrom<Parts> for ZeroPoleGain {
    type Error = LtiError;

    fn try_from(parts: Parts) -> Result<Self, LtiError> {
        let read = |roots: Vec<(f64, f64)>| roots.into_iter().map(|(re, im)| Complex64::new(re, im)).collect();
        Self::new(read(parts.zeros), read(parts.poles), parts.gain, parts.sample_time_s)?.with_delay(parts.delay_s)
    }
}

impl ZeroPoleGain {
    /// A system without delay; `None` for the sample time makes it continuous. Roots are put in order: real ones first,
    /// then pairs.
    ///
    /// # Errors
    /// [`LtiError::NonFinite`], [`LtiError::NotConjugate`], [`LtiError::SampleTime`].
    pub fn new(
        zeros: Vec<Complex64>,
        poles: Vec<Complex64>,
        gain: f64,
        sample_time_s: Option<f64>,
    ) -> Result<Self, LtiError> {
        sample_time_s.map_or(Ok(()), check_sample_time)?;
        check_finite("gain", std::iter::once(gain))?;
        let (zeros, poles) = (roots::paired("zeros", &zeros)?, roots::paired("poles", &poles)?);
        Ok(Self { zeros, poles, gain, delay_s: 0.0, sample_time_s })
    }

    /// A continuous system; see [`ZeroPoleGain::new`].
    ///
    /// # Errors
    /// Those of [`ZeroPoleGain::new`].
    pub fn continuous(zeros: Vec<Complex64>, poles: Vec<Complex64>, gain: f64) -> Result<Self, LtiError> {
        Self::new(zeros, poles, gain, None)
    }

    /// A discrete system; see [`ZeroPoleGain::new`].
    ///
    /// # Errors
    /// Those of [`ZeroPoleGain::new`].
    pub fn discrete(
        zeros: Vec<Complex64>,
        poles: Vec<Complex64>,
        gain: f64,
        sample_time_s: f64,
    ) -> Result<Self, LtiError> {
        Self::new(zeros, poles, gain, Some(sample_time_s))
    }

    /// The same system with this delay, in seconds, in place of its own.
    ///
    /// # Errors
    /// [`LtiError::Delay`] for a negative delay.
    pub fn with_delay(self, delay_s: f64) -> Result<Self, LtiError> {
        check_delay(delay_s)?;
        Ok(Self { delay_s, ..self })
    }

    /// The zeros.
    #[must_use]
    pub fn zeros(&self) -> &[Complex64] {
        &self.zeros
    }

    /// The poles.
    #[must_use]
    pub fn poles(&self) -> &[Complex64] {
        &self.poles
    }

    /// `k`, the ratio of the polynomials' leading coefficients; not the gain at rest.
    #[must_use]
    pub fn gain(&self) -> f64 {
        self.gain
    }

    /// The delay, in seconds.
    #[must_use]
    pub fn delay_s(&self) -> f64 {
        self.delay_s
    }

    /// The sample time in seconds, `None` for a continuous system.
    #[must_use]
    pub fn sample_time_s(&self) -> Option<f64> {
        self.sample_time_s
    }

    /// The gain at a complex point, without the delay.
    fn ratio(&self, point: Complex64) -> Complex64 {
        // Factors in turn from above and below, lest a product overflows that the ratio would not.
        let count = self.zeros.len().max(self.poles.len());
        (0..count).fold(Complex64::from(self.gain), |value, i| {
            let factor = |roots: &[Complex64]| roots.get(i).map_or(Complex64::ONE, |r| point - r);
            value * (factor(&self.zeros) / factor(&self.poles))
        })
    }

    /// The gain at a complex point, delay included. Not finite on a pole.
    #[must_use]
    pub fn evaluate(&self, point: Complex64) -> Complex64 {
        let delay = match self.sample_time_s {
            _ if self.delay_s == 0.0 => Complex64::ONE,
            None => (-point * self.delay_s).exp(),
            Some(sample_time_s) => point.powf(-self.delay_s / sample_time_s),
        };
        self.ratio(point) * delay
    }

    /// The frequency response at angular frequencies in rad/s: at `jω`, or `e^{jωT}`, times `e^{−jω·delay}`.
    ///
    /// # Errors
    /// [`LtiError::NonFinite`] for a frequency.
    pub fn frequency_response(&self, omega_rad_s: &[f64]) -> Result<FrequencyResponse, LtiError> {
        let gain = |w: &f64| self.ratio(frequency_point(*w, self.sample_time_s)) * Complex64::cis(-w * self.delay_s);
        FrequencyResponse::new(omega_rad_s.to_vec(), omega_rad_s.iter().map(gain).collect())
    }

    /// The gain at rest; not finite for an integrator.
    #[must_use]
    pub fn dc_gain(&self) -> f64 {
        self.ratio(frequency_point(0.0, self.sample_time_s)).re
    }

    /// The ratio of polynomials, multiplied out, with the same delay.
    ///
    /// # Errors
    /// [`LtiError::NonFinite`] where a coefficient overflows.
    pub fn to_transfer_function(&self) -> Result<TransferFunction, LtiError> {
        let num = from_roots(&self.zeros).iter().map(|c| c * self.gain).collect();
        TransferFunction::new(num, from_roots(&self.poles), self.sample_time_s)?.with_delay(self.delay_s)
    }
}

impl TransferFunction {
    /// The roots of the polynomials and the ratio of their leading coefficients, with the same delay.
    ///
    /// # Errors
    /// [`LtiError::NoConvergence`], [`LtiError::NonFinite`] where the gain overflows.
    pub fn to_zero_pole_gain(&self) -> Result<ZeroPoleGain, LtiError> {
        let (gain, zeros) = match self.num().first() {
            Some(first) if *first != 0.0 => (first / self.den()[0], self.zeros()?),
            _ => (0.0, Vec::new()),
        };
        ZeroPoleGain::new(zeros, self.poles()?, gain, self.sample_time_s())?.with_delay(self.delay_s())
    }
}

impl StateSpace {
    /// The zeros, poles and gain of the way from one input to one output, with all states; nothing is cancelled.
    ///
    /// # Errors
    /// [`LtiError::Index`] where the channel does not exist, [`LtiError::NoConvergence`].
    pub fn to_zero_pole_gain(&self, output: usize, input: usize) -> Result<ZeroPoleGain, LtiError> {
        let (zeros, gain) = match self.channel(output, input)?.zeros_and_gain() {
            Err(LtiError::ZeroSystem) => (Vec::new(), 0.0),
            other => other?,
        };
        ZeroPoleGain::new(zeros, self.poles()?, gain, self.sample_time_s())
    }
}
