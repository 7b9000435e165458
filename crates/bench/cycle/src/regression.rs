//! The regression line of 40 CFR 1065.602.

use numerics::null::nan_if_null;
use serde::{Deserialize, Serialize};

/// Times the line is fitted to what is left of the fit before: each round adds the digits that rounding has cost.
const ROUNDS: usize = 3;

/// y = a_1 r + a_0, with what is left over.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Regression {
    /// Points.
    pub points: usize,
    /// a_1 = Σ(y − ȳ)(r − r̄)/Σ(r − r̄)².
    #[serde(deserialize_with = "nan_if_null")]
    pub slope: f64,
    /// a_0 = ȳ − a_1 r̄.
    #[serde(deserialize_with = "nan_if_null")]
    pub intercept: f64,
    /// SEE = √(Σ(y − a_0 − a_1 r)²/(N − 2)).
    #[serde(deserialize_with = "nan_if_null")]
    pub standard_error: f64,
    /// r² = 1 − Σ(y − a_0 − a_1 r)²/Σ(y − ȳ)².
    #[serde(deserialize_with = "nan_if_null")]
    pub determination: f64,
}

impl Regression {
    /// Of feedback `y` on reference `r`, pair by pair; `None` of fewer than three pairs, or of a reference that never
    /// changes.
    ///
    /// # Example
    /// ```
    /// let line = cycle::Regression::of(&[(0.0, 1.0), (1.0, 3.0), (2.0, 5.0)]).unwrap();
    /// assert_eq!((line.slope, line.intercept, line.determination), (2.0, 1.0, 1.0));
    /// ```
    ///
    /// # Source
    /// 40 CFR 1065.602(h) … (k).
    pub fn of(pairs: &[(f64, f64)]) -> Option<Self> {
        let points = pairs.len();
        if points < 3 {
            return None;
        }
        let mean_r = mean(pairs.iter().map(|pair| pair.0));
        let spread: f64 = pairs.iter().map(|pair| (pair.0 - mean_r).powi(2)).sum();
        if spread <= 0.0 {
            return None;
        }
        let (mut slope, mut intercept) = (0.0, 0.0);
        for _ in 0..ROUNDS {
            let left = |pair: &(f64, f64)| f64::mul_add(-slope, pair.0, pair.1) - intercept;
            let mean_left = mean(pairs.iter().map(left));
            let more = pairs.iter().map(|pair| (left(pair) - mean_left) * (pair.0 - mean_r)).sum::<f64>() / spread;
            slope += more;
            intercept += f64::mul_add(-more, mean_r, mean_left);
        }
        let mean_y = mean(pairs.iter().map(|pair| pair.1));
        let left: f64 = pairs.iter().map(|pair| (f64::mul_add(-slope, pair.0, pair.1) - intercept).powi(2)).sum();
        let total: f64 = pairs.iter().map(|pair| (pair.1 - mean_y).powi(2)).sum();
        Some(Regression {
            points,
            slope,
            intercept,
            standard_error: (left / (points as f64 - 2.0)).sqrt(),
            determination: if total > 0.0 { 1.0 - left / total } else { 0.0 },
        })
    }
}

/// The mean, corrected by the mean of what is left.
fn mean(values: impl Iterator<Item = f64> + Clone) -> f64 {
    let (count, sum) = values.clone().fold((0.0, 0.0), |(count, sum), value| (count + 1.0, sum + value));
    let first = sum / count;
    first + values.map(|value| value - first).sum::<f64>() / count
}
