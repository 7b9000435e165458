//! Judging a model on data: fit, residual tests, comparison of models.

mod compare;
mod footing;
mod quadratic;
mod residual_test;
mod sensitivity;
mod series;
mod span;
mod whiteness;

pub use compare::{Comparison, Judgement, compare, compare_with, judge};
pub use residual_test::{Independence, ResidualReport, ResidualTest, TestData, Whiteness};

use crate::IdentError;
use crate::distributions::chi_squared_tail;

/// A statistic that follows χ² where there is nothing to find.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointTest {
    /// The statistic.
    pub statistic: f64,
    /// Degrees of freedom of its χ² distribution.
    pub degrees_of_freedom: f64,
    /// The probability of a statistic as large as this by chance.
    pub p_value: f64,
}

impl JointTest {
    pub(crate) fn chi_squared(statistic: f64, degrees_of_freedom: f64) -> Self {
        JointTest { statistic, degrees_of_freedom, p_value: chi_squared_tail(statistic, degrees_of_freedom) }
    }

    /// Whether the statistic stays in the region that holds it with probability `level` (e.g. 0.99) where there is nothing
    /// to find.
    #[must_use]
    pub fn passes(&self, level: f64) -> bool {
        self.p_value >= 1.0 - level
    }
}

/// What rounding makes of a constant, in parts of its size.
const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// 100(1 − ‖y − ŷ‖/‖y − ȳ‖): 100 is perfect, 0 no better than the mean, negative worse than it. NaN where y does not vary by
/// more than rounding: of nothing, no part is explained.
///
/// # Errors
/// Lengths that differ, or no data.
///
/// # Source
/// The normalised root-mean-square fit customary since Ljung's System Identification Toolbox.
pub fn fit_percent(measured: &[f64], modelled: &[f64]) -> Result<f64, IdentError> {
    same_length(measured, modelled)?;
    let error: f64 = measured.iter().zip(modelled).map(|(y, m)| (y - m).powi(2)).sum();
    Ok(variation(|| measured.iter().copied()).map_or(f64::NAN, |whole| 100.0 * (1.0 - (error / whole).sqrt())))
}

/// `Σ (y − ȳ)²`; none where that is nothing but rounding of a constant.
pub(crate) fn variation<I: Iterator<Item = f64>>(values: impl Fn() -> I) -> Option<f64> {
    let (mut count, mut sum, mut size) = (0_usize, 0.0, 0.0);
    values().for_each(|v| {
        (count, sum, size) = (count + 1, sum + v, size + v * v);
    });
    let first = sum / count as f64;
    // The rounding of a long sum is taken off again.
    let mean = first + values().map(|v| v - first).sum::<f64>() / count as f64;
    let about: f64 = values().map(|v| (v - mean).powi(2)).sum();
    (about > ROUNDING * ROUNDING * size).then_some(about)
}

/// Root of the mean squared difference.
///
/// # Errors
/// Lengths that differ, or no data.
pub fn rms_error(measured: &[f64], modelled: &[f64]) -> Result<f64, IdentError> {
    same_length(measured, modelled)?;
    let error: f64 = measured.iter().zip(modelled).map(|(y, m)| (y - m).powi(2)).sum();
    Ok((error / measured.len() as f64).sqrt())
}

fn same_length(a: &[f64], b: &[f64]) -> Result<(), IdentError> {
    if a.len() != b.len() {
        return Err(IdentError::Length { what: "modelled output", expected: a.len(), found: b.len() });
    }
    if a.is_empty() {
        return Err(IdentError::TooFewSamples { samples: 0, parameters: 1 });
    }
    Ok(())
}
