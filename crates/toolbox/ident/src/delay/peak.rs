//! The peak of the correlation of whitened signals.

use signal::SignalError;
use signal::correlation::delay_by_correlation;

use super::{DelayEstimate, check_one_input, signals};
use crate::data::regression::{Lagged, Regression, Signals};
use crate::{Dataset, IdentError};

/// Zeros beyond the longest delay that keep experiments apart, as many as the interpolation of the peak reaches.
const APART: usize = 40;

/// Whitens the input by an autoregression, filters the output alike, and takes the lag at which they are most
/// correlated.
///
/// For `y(t) = g u(t − τ) + v(t)`, `v` white after the filter, the correlation has one peak, at `τ`. Without whitening
/// the peak of a slow input is broad, and noise moves it far.
///
/// # Example
/// ```
/// # let mut random = signal::excitation::Random::new(3);
/// # let u: Vec<f64> = (0..500).map(|_| random.normal()).collect();
/// let y: Vec<f64> = (0..500).map(|t: usize| if t < 4 { 0.0 } else { -2.0 * u[t - 4] }).collect();
/// let peak = ident::delay::PeakDelay::default().estimate(&ident::Dataset::siso(0.1, &u, &y)?)?;
/// assert!((peak.delay.samples - 4.0).abs() < 1e-3 && peak.coefficient < -0.99);
/// # Ok::<(), ident::IdentError>(())
/// ```
///
/// # Source
/// Box & Jenkins, *Time Series Analysis*, §11.2 (prewhitening); Knapp & Carter, *The generalized correlation method for
/// estimation of time delay*, 1976 (variance).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PeakDelay {
    /// Order of the autoregression of the input; zero for none.
    pub whitening_order: usize,
    /// Longest delay, in samples, either way.
    pub highest: usize,
}

impl Default for PeakDelay {
    /// Order 10, delays from −50 to 50.
    fn default() -> Self {
        PeakDelay { whitening_order: 10, highest: 50 }
    }
}

/// The peak of a correlation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CorrelationPeak {
    /// Where it is; negative where the output leads. The standard error holds for a pure delay with white noise.
    pub delay: DelayEstimate,
    /// The coefficient of correlation there, −1 to 1.
    pub coefficient: f64,
    /// True if the peak is at the longest delay looked at: the true one may lie beyond.
    pub at_edge: bool,
}

impl PeakDelay {
    /// The peak for data of one input and one output.
    ///
    /// # Errors
    /// [`IdentError::Structure`] for other channels; [`IdentError::Missing`]; [`IdentError::TooFewSamples`];
    /// [`SignalError::Constant`]; [`IdentError::RankDeficient`] for an input that its past determines, such as a sine:
    /// whiten by a lower order.
    pub fn estimate(&self, data: &Dataset) -> Result<CorrelationPeak, IdentError> {
        check_one_input(data)?;
        data.refuse_missing()?;
        let signals = signals(data)?;
        let filter = self.whitening_filter(&signals)?;
        // One record with zeros between the experiments has the sum of their correlations.
        let (mut u, mut y) = (Vec::new(), Vec::new());
        let mut samples = 0;
        for s in &signals {
            for (whole, part) in [(&mut y, whitened(s[0], &filter)), (&mut u, whitened(s[1], &filter))] {
                samples += part.len();
                whole.extend(centred(part));
                whole.extend(std::iter::repeat_n(0.0, self.highest + APART));
            }
        }
        samples /= 2;
        if samples <= self.highest + APART {
            return Err(SignalError::TooShort { needed: self.highest + APART + 1, got: samples }.into());
        }
        let peak = delay_by_correlation(&u, &y, 1.0, self.highest as f64)?;
        let squared = peak.coefficient.powi(2).min(1.0);
        // A white signal has a mean squared slope of π²/3 times its power.
        let slope = std::f64::consts::PI / 3.0_f64.sqrt();
        let standard_error = ((1.0 - squared) / (squared * samples as f64)).sqrt() / slope;
        let delay = DelayEstimate { samples: peak.delay_s, standard_error };
        Ok(CorrelationPeak { delay, coefficient: peak.coefficient, at_edge: peak.at_edge })
    }

    /// `1, a₁ …`: the one-step prediction error of the input.
    fn whitening_filter(&self, signals: &Signals<'_>) -> Result<Vec<f64>, IdentError> {
        if self.whitening_order == 0 {
            return Ok(vec![1.0]);
        }
        let columns = Lagged::each(1, 1..=self.whitening_order as isize).chain([Lagged::new(1, 0)]).collect();
        let fit = Regression::new(signals, columns).least_squares()?;
        Ok(std::iter::once(1.0).chain(fit.parameters.iter().map(|a| -a)).collect())
    }
}

fn whitened(x: &[f64], filter: &[f64]) -> Vec<f64> {
    let order = filter.len() - 1;
    (order..x.len()).map(|t| filter.iter().enumerate().map(|(i, a)| a * x[t - i]).sum()).collect()
}

fn centred(x: Vec<f64>) -> impl Iterator<Item = f64> {
    let mean = x.iter().sum::<f64>() / x.len().max(1) as f64;
    x.into_iter().map(move |v| v - mean)
}
