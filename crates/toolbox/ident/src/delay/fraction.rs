//! A delay to a fraction of a sample beside dynamics.

use numerics::search;
use numerics::vector::dot;

use super::{ArxDelay, DelayEstimate, check_one_input, past_outputs, signals};
use crate::data::regression::{Lagged, Regression};
use crate::distributions::chi_squared_quantile;
use crate::{Dataset, IdentError};

/// Step of the second difference, in samples.
const STEP: f64 = 0.05;

/// Samples by which the input is delayed before lags are taken.
const AHEAD: isize = 2;

/// Correlations by which errors are tested for colour, and with which confidence.
const LAGS: usize = 25;
const WHITE: f64 = 0.999;

/// Errors below this part of the output's power are those of rounding and of interpolation.
const EXACT: f64 = 1e-8;

/// Where the search for the fraction ends, in samples.
const TOLERANCE: f64 = 1e-4;

/// Minimises the loss of `A(q) y(t) = B(q) u(t − τ) + e(t)` over `τ`: over whole samples by [`ArxDelay`] first, then
/// between the neighbours of the best, with the input interpolated as [`Dataset::delay_input`] does.
///
/// The standard error follows from the curvature of the loss at the minimum, `2V/(N V″)`, with `A` and `B` estimated
/// along; it is large where coefficients of `B` can do what the delay does, and infinite where the errors are not
/// white: the model is biased then, and the delay with it (test of Ljung and Box).
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
        let fraction = search::try_minimum((-1.0, 1.0), TOLERANCE, loss)?;
        let (below, at, above) = (loss(fraction - STEP)?, loss(fraction)?, loss(fraction + STEP)?);
        let curvature = (below - 2.0 * at + above) / (STEP * STEP);
        let variance = 2.0 * at / (ranking.samples as f64 * curvature);
        let is_determined = curvature > 0.0 && self.leaves_white_errors(data, whole, fraction)?;
        let standard_error = if is_determined { variance.sqrt() } else { f64::INFINITY };
        Ok(DelayEstimate { samples: whole + fraction, standard_error })
    }

    /// The regression with the input delayed by [`AHEAD`] samples more, and so many less in the lags: for every
    /// fraction as many rows are cut off.
    fn columns(&self, whole: f64) -> Vec<Lagged> {
        let first = whole as isize - AHEAD;
        let past = past_outputs(self.0.na, self.0.spacing);
        let fed = Lagged::each(1, first..first + self.0.nb as isize);
        past.chain(fed).chain([Lagged::new(0, 0)]).collect()
    }

    /// Mean squared error with the input delayed by `whole + fraction`.
    fn loss(&self, data: &Dataset, whole: f64, fraction: f64) -> Result<f64, IdentError> {
        let delayed = data.delay_input(0, fraction + AHEAD as f64)?;
        let columns = self.columns(whole);
        let parameters = columns.len() - 1;
        let signals = signals(&delayed)?;
        let regression = Regression::new(&signals, columns);
        if regression.rows <= parameters {
            return Err(IdentError::TooFewSamples { samples: regression.rows, parameters });
        }
        Ok(regression.factor()[(parameters, parameters)].powi(2) / regression.rows as f64)
    }

    /// Returns true if the errors look white: with others the model, and the delay with it, is biased.
    fn leaves_white_errors(&self, data: &Dataset, whole: f64, fraction: f64) -> Result<bool, IdentError> {
        let delayed = data.delay_input(0, fraction + AHEAD as f64)?;
        let (signals, columns) = (signals(&delayed)?, self.columns(whole));
        let theta = Regression::new(&signals, columns.clone()).least_squares()?.parameters;
        let first = columns.iter().map(|c| c.lag.max(0)).max().unwrap_or(0);
        let ahead = columns.iter().map(|c| (-c.lag).max(0)).max().unwrap_or(0);
        let (mut sums, mut rows) = (vec![0.0; LAGS + 1], 0);
        for record in &signals {
            let read = |c: &Lagged, t: isize| record[c.signal][(t - c.lag) as usize];
            let explained = |t: isize| columns.iter().zip(&theta).map(|(c, b)| b * read(c, t)).sum::<f64>();
            let errors: Vec<f64> =
                (first..record[0].len() as isize - ahead).map(|t| record[0][t as usize] - explained(t)).collect();
            rows += errors.len();
            for (lag, sum) in sums.iter_mut().enumerate() {
                *sum += errors.get(lag..).map_or(0.0, |later| dot(later, &errors));
            }
        }
        let n = rows as f64;
        let part = |(lag, sum): (usize, &f64)| (sum / sums[0]).powi(2) / (n - lag as f64);
        let statistic = n * (n + 2.0) * sums.iter().enumerate().skip(1).map(part).sum::<f64>();
        // Errors that are rounding have no colour.
        Ok(statistic.is_nan() || statistic <= chi_squared_quantile(WHITE, LAGS as f64) || {
            let power: f64 = signals.iter().flat_map(|record| record[0].iter()).map(|y| y * y).sum();
            sums[0] <= EXACT * power
        })
    }
}
