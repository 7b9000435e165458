//! The test of the cost of a fit.

use ident::distributions::normal_quantile;
use numerics::null::nan_if_null;
use serde::{Deserialize, Serialize};

/// Test that the rest is noise.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CostTest {
    /// V at the minimum.
    #[serde(deserialize_with = "nan_if_null")]
    pub achieved: f64,
    /// Its expected value under a right model.
    #[serde(deserialize_with = "nan_if_null")]
    pub expected: f64,
    /// Between these it lies with 95 % probability under a right model. Above: the shaft is not linear, or the model
    /// lacks something. Below: periods scatter by more than what their mean keeps, as by a once-a-turn error of an
    /// encoder whose turns do not repeat with the demand; intervals are wider than need be.
    #[serde(deserialize_with = "nan_if_null")]
    pub limits: (f64, f64),
}

impl CostTest {
    /// Tells whether the cost is no more than that of noise.
    #[must_use]
    pub fn passed(&self) -> bool {
        self.achieved <= self.limits.1
    }

    /// Factor on a covariance from the scatter alone where the model lacks something.
    pub(super) fn inflation(&self) -> f64 {
        if self.passed() { 1.0 } else { self.achieved / self.expected }
    }
}

/// A cost of `freedom` real residuals, each over a variance of ν degrees of freedom.
pub(crate) fn cost_test(achieved: f64, freedom: f64, nu: f64) -> CostTest {
    let expected = 0.5 * freedom * nu / (nu - 1.0);
    // Variance of F(2, 2ν), for each complex residual; neighbours that share variances scatter more.
    let spread = if nu > 2.0 { nu.powi(3) / ((nu - 1.0).powi(2) * (nu - 2.0)) } else { f64::INFINITY };
    let reach = normal_quantile(0.5 + 0.5 * LEVEL) * (0.5 * freedom * spread).sqrt();
    CostTest { achieved, expected, limits: (expected - reach, expected + reach) }
}

/// Probability that the cost of a right model lies between the limits.
pub(super) const LEVEL: f64 = 0.95;
