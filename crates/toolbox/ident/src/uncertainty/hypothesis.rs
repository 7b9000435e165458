//! Tests between estimates.

use crate::dense::covariance_root::inverse_root;
use crate::distributions::f_tail;
use crate::{Fit, IdentError, Parametric};
use fitting::StructureError;

/// Directions with less than this part of the largest variance count as certain.
const CERTAIN: f64 = 1e-13;

/// A statistic that follows F where there is nothing to find.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RatioTest {
    /// The statistic.
    pub statistic: f64,
    /// Degrees of freedom of its numerator.
    pub numerator: f64,
    /// Degrees of freedom of its denominator; infinite where the statistic times the numerator's is χ².
    pub denominator: f64,
    /// The probability of a statistic as large as this by chance.
    pub p_value: f64,
}

impl RatioTest {
    fn new(statistic: f64, numerator: f64, denominator: f64) -> Self {
        RatioTest { statistic, numerator, denominator, p_value: f_tail(statistic, numerator, denominator) }
    }

    /// Returns true if the statistic stays in the region that holds it with probability `level` (e.g. 0.99) where there
    /// is nothing to find.
    #[must_use]
    pub fn passes(&self, level: f64) -> bool {
        self.p_value >= 1.0 - level
    }
}

/// Tests whether the larger of two nested models, both fitted to the same rows, explains more than chance would: passes
/// where the smaller one is enough.
///
/// For one output `F = (V_s − V_l)/V_l · (N − d_l)/(d_l − d_s)`; for several the likelihood ratio `N ln(V_s/V_l)`, χ²
/// with `d_l − d_s` degrees of freedom.
///
/// # Errors
/// [`IdentError::Length`] where the estimates do not rest on equally many rows; [`IdentError::Structure`] where the
/// larger model does not have more free parameters; [`IdentError::TooFewSamples`].
///
/// # Source
/// Ljung 1999, §16.4 (F-test and likelihood ratio); Söderström & Stoica, *System Identification*, 1989, §11.4.
pub fn nested<S: Parametric, L: Parametric>(small: &Fit<S>, large: &Fit<L>) -> Result<RatioTest, IdentError> {
    if small.samples != large.samples {
        return Err(IdentError::Length {
            what: "rows behind the larger model",
            expected: small.samples,
            found: large.samples,
        });
    }
    let Some(added) = large.free_parameters.checked_sub(small.free_parameters).filter(|d| *d > 0) else {
        let (larger, smaller) = (large.free_parameters, small.free_parameters);
        return Err(StructureError::NotNested { larger, smaller }.into());
    };
    if large.samples <= large.free_parameters {
        return Err(IdentError::TooFewSamples { samples: large.samples, parameters: large.free_parameters });
    }
    let (added, samples) = (added as f64, large.samples as f64);
    if large.noise_covariance.nrows() > 1 {
        return Ok(RatioTest::new(samples * (small.loss / large.loss).ln().max(0.0) / added, added, f64::INFINITY));
    }
    let rest = samples - large.free_parameters as f64;
    let gained = ((small.loss - large.loss) / large.loss).max(0.0);
    Ok(RatioTest::new(gained * rest / added, added, rest))
}

/// Tests whether two estimates of the same structure from independent data agree: `δᵀ (P₁ + P₂)⁻¹ δ` with
/// `δ = θ₁ − θ₂`, over its degrees of freedom.
///
/// # Errors
/// [`IdentError::Length`] where the parameters differ in number; [`IdentError::NotFinite`].
///
/// # Source
/// Wald's test; Ljung 1999, §9.6, for the distribution of the estimates.
pub fn agreement<M: Parametric>(one: &Fit<M>, other: &Fit<M>) -> Result<RatioTest, IdentError> {
    let (a, b) = (one.parameters(), other.parameters());
    for found in [b.len(), one.covariance.nrows(), other.covariance.nrows()] {
        if found != a.len() {
            return Err(IdentError::Length { what: "parameters of the other estimate", expected: a.len(), found });
        }
    }
    let whiten = inverse_root(&(&one.covariance + &other.covariance), CERTAIN)?;
    let along = |k: usize| (0..a.len()).map(|i| whiten[(i, k)] * (a[i] - b[i])).sum::<f64>();
    let statistic = (0..whiten.ncols()).map(|k| along(k).powi(2)).sum::<f64>();
    let freedom = whiten.ncols() as f64;
    Ok(RatioTest::new(statistic / freedom.max(1.0), freedom, one.degrees_of_freedom + other.degrees_of_freedom))
}
