//! [`TransferFunction`]: a ratio of polynomials and a delay.

use faer::Mat;
use serde::{Deserialize, Serialize};

use crate::Complex64;
use crate::error::{LtiError, check_delay, check_finite, check_sample_time};
use crate::frequency_response::FrequencyResponse;
use crate::matrix::{balance, norm_2};
use crate::polynomial::{add, evaluate, from_roots, multiply, roots, without_leading_zeros};
use crate::state_space::{StateSpace, check_same_clock, frequency_point, is_algebraic_loop};

/// One input, one output: `H(s) = num(s)/den(s) · e^{−s·delay}`, or `H(z) = num(z)/den(z) · z^{−delay/T}`.
///
/// Coefficients are in descending powers of `s` or of `z` (not of `z⁻¹`), without leading zeros.
///
/// # Example
/// ```
/// let lag = lti::TransferFunction::continuous(vec![3.0], vec![0.5, 1.0])?.with_delay(0.1)?;
/// let h = lag.frequency_response(&[2.0])?;
/// assert!((h.magnitude_db()[0] - 20.0 * (3.0 / 2.0_f64.sqrt()).log10()).abs() < 1e-12);
/// assert!((h.phase_deg()[0] - (-45.0 - 0.2_f64.to_degrees())).abs() < 1e-12);
/// # Ok::<(), lti::LtiError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(with = "Parts"))]
#[serde(try_from = "Parts")]
pub struct TransferFunction {
    num: Vec<f64>,
    den: Vec<f64>,
    delay_s: f64,
    sample_time_s: Option<f64>,
}

/// Fields as read, before they are checked.
#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct Parts {
    num: Vec<f64>,
    den: Vec<f64>,
    delay_s: f64,
    sample_time_s: Option<f64>,
}

impl TryFrom<Parts> for TransferFunction {
    type Error = LtiError;

    fn try_from(parts: Parts) -> Result<Self, LtiError> {
        Self::new(parts.num, parts.den, parts.sample_time_s)?.with_delay(parts.delay_s)
    }
}

impl TransferFunction {
    /// A transfer function without delay; `None` for the sample time makes it continuous. Leading zeros are removed.
    ///
    /// # Errors
    /// [`LtiError::NonFinite`], [`LtiError::ZeroPolynomial`] for the denominator, [`LtiError::SampleTime`].
    pub fn new(num: Vec<f64>, den: Vec<f64>, sample_time_s: Option<f64>) -> Result<Self, LtiError> {
        check_finite("numerator", num.iter().copied())?;
        check_finite("denominator", den.iter().copied())?;
        sample_time_s.map_or(Ok(()), check_sample_time)?;
        let (num, den) = (without_leading_zeros(&num).to_vec(), without_leading_zeros(&den).to_vec());
        if den.is_empty() {
            return Err(LtiError::ZeroPolynomial { what: "denominator" });
        }
        let num = if num.is_empty() { vec![0.0] } else { num };
        Ok(Self { num, den, delay_s: 0.0, sample_time_s })
    }

    /// A continuous transfer function; see [`TransferFunction::new`].
    ///
    /// # Errors
    /// Those of [`TransferFunction::new`].
    pub fn continuous(num: Vec<f64>, den: Vec<f64>) -> Result<Self, LtiError> {
        Self::new(num, den, None)
    }

    /// A discrete transfer function; see [`TransferFunction::new`].
    ///
    /// # Errors
    /// Those of [`TransferFunction::new`].
    pub fn discrete(num: Vec<f64>, den: Vec<f64>, sample_time_s: f64) -> Result<Self, LtiError> {
        Self::new(num, den, Some(sample_time_s))
    }

    /// The same ratio with this delay, in seconds, in place of its own.
    ///
    /// # Errors
    /// [`LtiError::Delay`] for a negative delay.
    pub fn with_delay(self, delay_s: f64) -> Result<Self, LtiError> {
        check_delay(delay_s)?;
        Ok(Self { delay_s, ..self })
    }

    /// The numerator, in descending powers.
    #[must_use]
    pub fn num(&self) -> &[f64] {
        &self.num
    }

    /// The denominator, in descending powers; the first coefficient is not zero.
    #[must_use]
    pub fn den(&self) -> &[f64] {
        &self.den
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

    /// The gain at a complex point, delay included. Not finite on a pole.
    #[must_use]
    pub fn evaluate(&self, point: Complex64) -> Complex64 {
        let delay = match self.sample_time_s {
            _ if self.delay_s == 0.0 => Complex64::ONE,
            None => (-point * self.delay_s).exp(),
            Some(sample_time_s) => point.powf(-self.delay_s / sample_time_s),
        };
        evaluate(&self.num, point) / evaluate(&self.den, point) * delay
    }

    /// The frequency response at angular frequencies in rad/s: at `jω`, or `e^{jωT}`, times `e^{−jω·delay}`.
    ///
    /// # Errors
    /// [`LtiError::NonFinite`] for a frequency.
    pub fn frequency_response(&self, omega_rad_s: &[f64]) -> Result<FrequencyResponse, LtiError> {
        let response = omega_rad_s.iter().map(|w| self.evaluate_at(*w)).collect();
        FrequencyResponse::new(omega_rad_s.to_vec(), response)
    }

    /// The gain at an angular frequency.
    pub(crate) fn evaluate_at(&self, omega_rad_s: f64) -> Complex64 {
        let point = frequency_point(omega_rad_s, self.sample_time_s);
        evaluate(&self.num, point) / evaluate(&self.den, point) * Complex64::cis(-omega_rad_s * self.delay_s)
    }

    /// The gain at rest; infinite for an integrator.
    #[must_use]
    pub fn dc_gain(&self) -> f64 {
        let point = frequency_point(0.0, self.sample_time_s);
        (evaluate(&self.num, point) / evaluate(&self.den, point).re).re
    }

    /// The poles: roots of the denominator.
    ///
    /// # Errors
    /// [`LtiError::NoConvergence`].
    pub fn poles(&self) -> Result<Vec<Complex64>, LtiError> {
        roots(&self.den)
    }

    /// The zeros: roots of the numerator.
    ///
    /// # Errors
    /// [`LtiError::ZeroPolynomial`] where the numerator is zero, [`LtiError::NoConvergence`].
    pub fn zeros(&self) -> Result<Vec<Complex64>, LtiError> {
        roots(&self.num)
    }

    /// This system followed by `next`: polynomials multiplied, delays added.
    ///
    /// # Errors
    /// [`LtiError::SampleTimesDiffer`].
    pub fn series(&self, next: &Self) -> Result<Self, LtiError> {
        check_same_clock(self.sample_time_s, next.sample_time_s)?;
        Self::new(multiply(&self.num, &next.num), multiply(&self.den, &next.den), self.sample_time_s)?
            .with_delay(self.delay_s + next.delay_s)
    }

    /// This system beside `other`, outputs added; nothing is cancelled. A delay that both have stays a delay, and what
    /// one has more of becomes poles at zero.
    ///
    /// # Errors
    /// [`LtiError::SampleTimesDiffer`]; [`LtiError::DelayPresent`] where the delays of continuous systems differ,
    /// [`LtiError::FractionalDelay`] where those of discrete ones do by other than whole samples.
    pub fn parallel(&self, other: &Self) -> Result<Self, LtiError> {
        check_same_clock(self.sample_time_s, other.sample_time_s)?;
        let common = self.delay_s.min(other.delay_s);
        let rest = |system: &Self| match system.sample_time_s {
            _ if system.delay_s == common => system.clone().with_delay(0.0),
            Some(_) => system.clone().with_delay(system.delay_s - common)?.with_delay_absorbed(),
            None => Err(LtiError::DelayPresent { delay_s: system.delay_s }),
        };
        let (p, q) = (rest(self)?, rest(other)?);
        let num = add(&multiply(&p.num, &q.den), &multiply(&q.num, &p.den));
        Self::new(num, multiply(&p.den, &q.den), self.sample_time_s)?.with_delay(common)
    }

    /// The loop closed through `back` with a negative sign, `H / (1 + H·H_back)`; nothing is cancelled. Delays of
    /// discrete systems become poles at zero.
    ///
    /// # Errors
    /// [`LtiError::DelayPresent`] where either of continuous systems has a delay, [`LtiError::FractionalDelay`] where
    /// one of discrete ones is not whole samples; [`LtiError::AlgebraicLoop`] where `1 + D·D_back` vanishes, so that no
    /// signal in the loop is determined; [`LtiError::SampleTimesDiffer`].
    pub fn feedback(&self, back: &Self) -> Result<Self, LtiError> {
        check_same_clock(self.sample_time_s, back.sample_time_s)?;
        let (p, q) = (self.delay_as_poles()?, back.delay_as_poles()?);
        let (open, around) = (multiply(&p.den, &q.den), multiply(&p.num, &q.num));
        if open.len() == around.len() {
            let (first, second) = (open[0], around[0]);
            if is_algebraic_loop(first + second, first.abs() + second.abs()) {
                return Err(LtiError::AlgebraicLoop);
            }
        }
        Self::new(multiply(&p.num, &q.den), add(&open, &around), self.sample_time_s)
    }

    /// This system without a delay: that of a discrete one as poles at zero.
    fn delay_as_poles(&self) -> Result<Self, LtiError> {
        match self.sample_time_s {
            Some(_) if self.delay_s != 0.0 => self.with_delay_absorbed(),
            _ => self.check_no_delay().map(|()| self.clone()),
        }
    }

    /// The system in state space: controllable canonical form, its states scaled by powers of two so that `A` is
    /// balanced and `B` and `C` are alike in size.
    ///
    /// The delay has no finite state-space form: take it off with [`TransferFunction::with_delay`] and apply it with
    /// [`StateSpace::to_discrete_delayed`].
    ///
    /// # Errors
    /// [`LtiError::DelayPresent`]; [`LtiError::Improper`] where the numerator has the higher degree;
    /// [`LtiError::NonFinite`] where the leading coefficient is too small to divide by.
    pub fn to_state_space(&self) -> Result<StateSpace, LtiError> {
        self.check_no_delay()?;
        let n = self.den.len() - 1;
        let Some(missing) = self.den.len().checked_sub(self.num.len()) else {
            return Err(LtiError::Improper { numerator: self.num.len() - 1, denominator: n });
        };
        let monic = |c: &f64| c / self.den[0];
        let den: Vec<f64> = self.den.iter().map(monic).collect();
        let num: Vec<f64> = std::iter::repeat_n(0.0, missing).chain(self.num.iter().map(monic)).collect();
        let companion = Mat::from_fn(n, n, |i, j| match i {
            0 => -den[j + 1],
            _ => f64::from(u8::from(i == j + 1)),
        });
        let (a, scale) = balance(companion.as_ref());
        let mut b = Mat::from_fn(n, 1, |i, _| if i == 0 { 1.0 / scale[0] } else { 0.0 });
        let mut c = Mat::from_fn(1, n, |_, j| (num[j + 1] - den[j + 1] * num[0]) * scale[j]);
        let (size_b, size_c) = (norm_2(b.as_ref()), norm_2(c.as_ref()));
        if size_b > 0.0 && size_c > 0.0 && size_c.is_finite() {
            let factor = (0.5 * (size_c / size_b).log2()).round().exp2();
            b *= faer::Scale(factor);
            c *= faer::Scale(1.0 / factor);
        }
        StateSpace::new(a, b, c, Mat::full(1, 1, num[0]), self.sample_time_s)
    }

    fn check_no_delay(&self) -> Result<(), LtiError> {
        if self.delay_s == 0.0 { Ok(()) } else { Err(LtiError::DelayPresent { delay_s: self.delay_s }) }
    }
}

impl StateSpace {
    /// The transfer function of a system with one input and one output; its denominator is monic and of as many degrees
    /// as there are states (nothing is cancelled), its delay zero.
    ///
    /// # Errors
    /// [`LtiError::NotSiso`], [`LtiError::NoConvergence`], [`LtiError::NonFinite`].
    pub fn to_transfer_function(&self) -> Result<TransferFunction, LtiError> {
        let (zeros, gain) = match self.zeros_and_gain() {
            Err(LtiError::ZeroSystem) => (Vec::new(), 0.0),
            other => other?,
        };
        let num = from_roots(&zeros).iter().map(|c| c * gain).collect();
        TransferFunction::new(num, from_roots(&self.poles()?), self.sample_time_s())
    }
}
