//! Judging a model on data: fit, residual tests, comparison of models.

mod compare;
mod linearised_residuals;
mod quadratic;
mod residual_test;
mod sensitivity;
mod series;
mod span;
mod tangent;
mod whiteness;

pub use compare::{Comparison, Judgement, compare, compare_with, judge};
pub use residual_test::{Independence, ResidualReport, ResidualTest, TestData, Whiteness};

use numerics::vector::variation;

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

    /// Returns true if the statistic stays in the region that holds it with probability `level` (e.g. 0.99) where there
    /// is nothing to find.
    #[must_use]
    pub fn passes(&self, level: f64) -> bool {
        self.p_value >= 1.0 - level
    }
}

/// 100(1 − ‖y − ŷ‖/‖y − ȳ‖): 100 is perfect, 0 no better than the mean, negative worse than it. NaN where y does not
/// vary by more than rounding: of nothing, no part is explained.
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
