//! [`Criteria`]: what a model's loss is worth, given what the model cost.

use std::f64::consts::TAU;

use numerics::null::{infinite_if_null, nan_if_null};

/// Information criteria of a model: the smaller, the better. They compare models fitted to the same samples.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Criteria {
    /// Akaike's final prediction error `V (1 + d/N) / (1 − d/N)`: the loss to expect on new data. Infinite for `d ≥ N`.
    #[serde(deserialize_with = "infinite_if_null")]
    pub fpe: f64,
    /// Akaike's information criterion `N ln V + 2 d + N p (ln 2π + 1)`.
    #[serde(deserialize_with = "nan_if_null")]
    pub aic: f64,
    /// The same, corrected for few samples: `AIC + 2 d (d + 1) / (N − d − 1)`. Infinite for `d + 1 ≥ N`.
    #[serde(deserialize_with = "infinite_if_null")]
    pub aicc: f64,
    /// Akaike's criterion per sample: `ln V + 2 d/N`.
    #[serde(deserialize_with = "nan_if_null")]
    pub naic: f64,
    /// The Bayesian information criterion `N ln V + N p (ln 2π + 1) + d ln N`.
    #[serde(deserialize_with = "nan_if_null")]
    pub bic: f64,
    /// Rissanen's minimum description length `V (1 + d ln N / N)`.
    #[serde(deserialize_with = "nan_if_null")]
    pub mdl: f64,
}

impl Criteria {
    /// The criteria of a model of `p = outputs` whose loss `V`, the determinant of the mean of `ε εᵀ`, rests on
    /// `N = samples` and `d = parameters`.
    ///
    /// # Example
    /// ```
    /// let criteria = ident::Criteria::of(1.6575, 6, 300, 1);
    /// assert!((criteria.fpe - 1.7252).abs() < 1e-4 && (criteria.bic - 1037.2).abs() < 0.05);
    /// ```
    ///
    /// # Source
    /// Ljung 1999, §16.4; Hurvich & Tsai, *Regression and time series model selection in
    /// small samples*, 1989.
    #[must_use]
    pub fn of(loss: f64, parameters: usize, samples: usize, outputs: usize) -> Self {
        let (d, n) = (parameters as f64, samples as f64);
        let likelihood = n * (loss.ln() + outputs as f64 * (TAU.ln() + 1.0));
        let or_infinite = |enough: bool, value: f64| if enough { value } else { f64::INFINITY };
        let aic = likelihood + 2.0 * d;
        Criteria {
            fpe: or_infinite(n > d, loss * (1.0 + d / n) / (1.0 - d / n)),
            aic,
            aicc: or_infinite(n > d + 1.0, aic + 2.0 * d * (d + 1.0) / (n - d - 1.0)),
            naic: loss.ln() + 2.0 * d / n,
            bic: likelihood + d * n.ln(),
            mdl: loss * (1.0 + d * n.ln() / n),
        }
    }
}
