//! The first lag at which an input matters.

use super::{past_outputs, signals};
use crate::data::check_range;
use crate::data::regression::{Lagged, Regression};
use crate::distributions::normal_quantile;
use crate::{Dataset, IdentError};

/// Regresses the output on many lags of every input, `y(t) = −Σ a_i y(t−i) + Σ_k Σ_l b_{k,l} u_k(t − l) + e(t)`, and
/// takes the first `b` that differs from zero.
///
/// With `na = 0` it is the finite impulse response itself, right where the noise on the output is white and the
/// response is over within `lags`; with past outputs the noise may be coloured and the response long, and the first
/// coefficient that matters is the first one of the impulse response all the same.
///
/// # Example
/// ```
/// # let mut random = signal::excitation::Random::new(2);
/// # let u: Vec<f64> = (0..400).map(|_| random.normal()).collect();
/// # let e: Vec<f64> = (0..400).map(|_| 0.1 * random.normal()).collect();
/// let y: Vec<f64> = (0..400).map(|t| if t < 5 { 0.0 } else { u[t - 4] + 0.5 * u[t - 5] + e[t] }).collect();
/// let found = ident::delay::ImpulseDelay { na: 0, lags: 20, level: 0.999, ..Default::default() };
/// assert_eq!(found.estimate(&ident::Dataset::siso(0.1, &u, &y)?)?[0].delay, Some(4));
/// # Ok::<(), ident::IdentError>(())
/// ```
///
/// # Source
/// Björklund & Ljung 2003, §3.2; simultaneous level by Bonferroni.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ImpulseDelay {
    /// Past outputs in the regression.
    pub na: usize,
    /// Samples from one past output to the next: one, or more for an output that is known only so often.
    pub spacing: usize,
    /// Lags of each input, from zero.
    pub lags: usize,
    /// Probability that no lag of an input without effect is taken for one with.
    pub level: f64,
}

impl Default for ImpulseDelay {
    /// Ten past outputs, lags 0 to 29, a level of 0.99.
    fn default() -> Self {
        ImpulseDelay { na: 10, spacing: 1, lags: 30, level: 0.99 }
    }
}

/// How the response to one input starts.
#[derive(Debug, Clone, PartialEq)]
pub struct ImpulseResponseStart {
    /// The first lag that matters, `None` where none does.
    pub delay: Option<usize>,
    /// The coefficients `b` at lag zero and on.
    pub coefficients: Vec<f64>,
    /// Their standard errors, for white residuals.
    pub standard_errors: Vec<f64>,
    /// A coefficient matters from this many standard errors on.
    pub threshold: f64,
}

impl ImpulseDelay {
    /// The start of the response to each input of data of one output. Rows with missing samples are left out.
    ///
    /// # Errors
    /// [`IdentError::Structure`] for several outputs or no input; [`IdentError::TooFewSamples`];
    /// [`IdentError::RankDeficient`] where the inputs excite fewer orders than `lags`;
    /// [`signal::SignalError::Parameter`].
    pub fn estimate(&self, data: &Dataset) -> Result<Vec<ImpulseResponseStart>, IdentError> {
        let signals = signals(data)?;
        check_range("lags", self.lags as f64, 1.0, 1e5)?;
        check_range("level", self.level, 0.0, 1.0 - 1e-12)?;
        let past = past_outputs(self.na, self.spacing);
        let fed = (1..=data.inputs()).flat_map(|k| Lagged::each(k, 0..self.lags as isize));
        let columns = past.chain(fed).chain([Lagged::new(0, 0)]).collect();
        let fit = Regression::new(&signals, columns).least_squares()?;
        let covariance = fit.covariance();
        let threshold = normal_quantile(1.0 - (1.0 - self.level) / (2.0 * self.lags as f64));
        let start = |k: usize| {
            let own = self.na + k * self.lags..self.na + (k + 1) * self.lags;
            let standard_errors: Vec<f64> = own.clone().map(|i| covariance[(i, i)].max(0.0).sqrt()).collect();
            let coefficients = fit.parameters[own].to_vec();
            // Of exact data the errors are rounding, and so are the coefficients that are zero.
            let rounding = 1e-12 * coefficients.iter().fold(0.0_f64, |m, b| m.max(b.abs()));
            let matters = |(b, se): (&f64, &f64)| b.abs() > (threshold * se).max(rounding);
            let delay = coefficients.iter().zip(&standard_errors).position(matters);
            ImpulseResponseStart { delay, coefficients, standard_errors, threshold }
        };
        Ok((0..data.inputs()).map(start).collect())
    }
}
