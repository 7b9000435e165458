//! A delay to a fraction of a sample beside dynamics.

use super::{ArxDelay, DelayEstimate, check_one_input, golden_minimum, past_outputs, signals};
use crate::regression::{Lagged, Regression};
use crate::{Dataset, IdentError};

/// Step of the second difference, in samples.
const STEP: f64 = 0.05;

/// Where the search for the fraction ends, in samples.
const TOLERANCE: f64 = 1e-4;

/// Minimises the loss of `A(q) y(t) = B(q) u(t − τ) + e(t)` over `τ`: over whole samples by [`ArxDelay`] first, then between
/// the neighbours of the best, with the input interpolated as [`Dataset::delay_input`] does.
///
/// The standard error follows from the curvature of the loss at the minimum, `2V/(N V″)`, with `A` and `B` estimated
/// along; it is large where coefficients of `B` can do what the delay does.
///
/// # Example
/// ```
/// # let mut random = signal::excitation::Random::new(5);
/// # let wave: Vec<[f64; 2]> = (0..40).map(|_| [random.uniform(), 6.28 * random.uniform()]).collect();
/// let at = |t: f64| wave.iter().map(|[f, p]| (2.0 * f * t + p).sin()).sum::<f64>();
/// let u: Vec<f64> = (0..1000).map(|t| at(f64::from(t))).collect();
/// let mut y = vec![0.0; 1000];
/// for t in 1..1000 {
///     y[t] = 0.5 * y[t - 1] + at(t as f64 - 4.3);
/// }
/// let data = ident::Dataset::siso(1.0, &u, &y)?.with_intersample(ident::Intersample::BandLimited);
/// let delay = ident::delay::FractionalDelay(ident::delay::ArxDelay { na: 1, nb: 1, ..Default::default() }).estimate(&data)?;
/// assert!((delay.samples - 4.3).abs() < 0.01);
/// # Ok::<(), ident::IdentError>(())
/// ```
///
/// # Source
/// Ljung 1999, (7.94) for the curvature; concentrated likelihood.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct FractionalDelay(
    /// The model, and the whole delays to start from.
    pub ArxDelay,
);

impl FractionalDelay {
    /// The delay for data of one input and one output.
    ///
    /// # Errors
    /// Those of [`ArxDelay::estimate`]; [`IdentError::Structure`] for several inputs; [`IdentError::Missing`].
    pub fn estimate(&self, data: &Dataset) -> Result<DelayEstimate, IdentError> {
        check_one_input(data)?;
        data.refuse_missing()?;
        let ranking = self.0.estimate(data)?;
        let whole = ranking.delays[0] as f64;
        let loss = |fraction: f64| self.loss(data, whole, fraction);
        let fraction = golden_minimum(loss, -1.0, 1.0, TOLERANCE)?;
        let (below, at, above) = (loss(fraction - STEP)?, loss(fraction)?, loss(fraction + STEP)?);
        let curvature = (below - 2.0 * at + above) / (STEP * STEP);
        let variance = 2.0 * at / (ranking.samples as f64 * curvature);
        let standard_error = if curvature > 0.0 { variance.sqrt() } else { f64::INFINITY };
        Ok(DelayEstimate { samples: whole + fraction, standard_error })
    }

    /// Mean squared error with the input delayed by `whole + fraction`.
    fn loss(&self, data: &Dataset, whole: f64, fraction: f64) -> Result<f64, IdentError> {
        // Two more than wanted and two less in the lags, so that as many rows are cut off for every fraction.
        let delayed = data.delay_input(0, fraction + 2.0)?;
        let first = whole as isize - 2;
        let past = past_outputs(self.0.na, self.0.spacing);
        let fed = Lagged::each(1, first..first + self.0.nb as isize);
        let columns: Vec<Lagged> = past.chain(fed).chain([Lagged::new(0, 0)]).collect();
        let parameters = columns.len() - 1;
        let signals = signals(&delayed)?;
        let regression = Regression::new(&signals, columns);
        if regression.rows <= parameters {
            return Err(IdentError::TooFewSamples { samples: regression.rows, parameters });
        }
        Ok(regression.factor()[(parameters, parameters)].powi(2) / regression.rows as f64)
    }
}
