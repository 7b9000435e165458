//! A probability, from how often something happened.

use numerics::null::nan_if_null;
use serde::{Deserialize, Serialize};

use crate::distributions::f_quantile;

/// Half of what the 95 % interval leaves out.
const TAIL: f64 = 0.025;

/// A probability, from how often something happened.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Proportion {
    /// How often it happened.
    pub count: usize,
    /// Of how many.
    pub of: usize,
    /// count/of.
    #[serde(deserialize_with = "nan_if_null")]
    pub estimate: f64,
    /// Lower end of the 95 % interval.
    #[serde(deserialize_with = "nan_if_null")]
    pub lower: f64,
    /// Its upper end.
    #[serde(deserialize_with = "nan_if_null")]
    pub upper: f64,
}

impl Proportion {
    /// With the exact binomial interval: its ends are quantiles of the beta distribution, here by those of F.
    ///
    /// # Source
    /// Clopper & Pearson, Biometrika 26 (1934) 404.
    pub fn new(count: usize, of: usize) -> Self {
        let (x, rest) = (count as f64, of.saturating_sub(count) as f64);
        // Without a success there is nothing for F to tell, and the ends have closed forms.
        let lower = match (count, rest > 0.0) {
            (0, _) => 0.0,
            (_, false) => TAIL.powf(1.0 / x),
            _ => 1.0 / (1.0 + (rest + 1.0) / x * f_quantile(1.0 - TAIL, 2.0 * (rest + 1.0), 2.0 * x)),
        };
        let upper = match (count, rest > 0.0) {
            (_, false) => 1.0,
            (0, _) => 1.0 - TAIL.powf(1.0 / rest),
            _ => {
                let odds = (x + 1.0) / rest * f_quantile(1.0 - TAIL, 2.0 * (x + 1.0), 2.0 * rest);
                odds / (1.0 + odds)
            }
        };
        Proportion { count, of, estimate: x / of.max(1) as f64, lower, upper }
    }
}
