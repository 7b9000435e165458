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

pub use fitting::{fit_percent, rms_error};

pub use compare::{Comparison, Judgement, compare, compare_with, judge};
pub use residual_test::{Independence, ResidualReport, ResidualTest, TestData, Whiteness};

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
