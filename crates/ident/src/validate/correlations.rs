//! Correlations of one residual with itself and with one input.

use super::same_length;
use crate::IdentError;
use crate::distributions::normal_quantile;

/// Correlations of residuals ε with themselves and with the input u, and the regions they stay in if the model is right.
#[derive(Debug, Clone, PartialEq)]
pub struct ResidualCorrelations {
    /// r_ε(k)/r_ε(0) for k = 0…M.
    pub auto: Vec<f64>,
    /// |r_ε(k)/r_ε(0)| stays below this at each k ≥ 1, at the level asked for, if ε is white.
    pub auto_bound: f64,
    /// r_εu(k)/√(r_ε(0) r_u(0)) for k = −M…M, with r_εu(k) the mean of ε(t) u(t − k): a positive k relates a residual to
    /// past input (the model missed something), a negative k to future input (feedback).
    pub cross: Vec<f64>,
    /// |cross| stays below this at each k, at the level asked for, if ε and u are independent.
    pub cross_bound: f64,
}

/// Tests residuals for whiteness and for independence of the input, at lags up to `lags` and the given `level`
/// (e.g. 0.99).
///
/// The cross-correlation's region takes the colour of both signals into account: under independence √N r_εu(k) is
/// asymptotically normal with variance Σ_j r_ε(j) r_u(j).
///
/// # Errors
/// Lengths that differ, fewer samples than four times `lags`, or a signal that does not vary.
///
/// # Source
/// Ljung 1999, §16.6, (16.64)–(16.67).
pub fn residual_correlations(
    residuals: &[f64],
    input: &[f64],
    lags: usize,
    level: f64,
) -> Result<ResidualCorrelations, IdentError> {
    same_length(residuals, input)?;
    let n = residuals.len();
    if n < 4 * lags.max(1) {
        return Err(IdentError::TooFewSamples { samples: n, parameters: lags });
    }
    let (e, u) = (centred(residuals), centred(input));
    // Longer memory than a quarter of the record cannot be told from chance.
    let reach = (n / 4).min(20 * lags);
    let (re, ru) = (autocovariance(&e, reach), autocovariance(&u, reach));
    if re[0] <= 0.0 {
        return Err(IdentError::Constant { what: "the residual" });
    }
    if ru[0] <= 0.0 {
        return Err(IdentError::Constant { what: "the input" });
    }
    let quantile = normal_quantile(0.5 + level / 2.0);
    let scale = (re[0] * ru[0]).sqrt();
    let product = |j: usize| re[j] * ru[j];
    let variance = (product(0) + 2.0 * (1..=reach).map(product).sum::<f64>()).max(product(0) / n as f64);
    let at = |k: isize| lagged_mean(&e, &u, k) / scale;
    Ok(ResidualCorrelations {
        auto: (0..=lags).map(|k| re[k] / re[0]).collect(),
        auto_bound: quantile / (n as f64).sqrt(),
        cross: (-(lags as isize)..=lags as isize).map(at).collect(),
        cross_bound: quantile * (variance / n as f64).sqrt() / scale,
    })
}

fn centred(values: &[f64]) -> Vec<f64> {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    values.iter().map(|v| v - mean).collect()
}

fn autocovariance(x: &[f64], lags: usize) -> Vec<f64> {
    (0..=lags).map(|k| lagged_mean(x, x, k as isize)).collect()
}

/// Mean of a(t) b(t − k), divided by the full length.
fn lagged_mean(a: &[f64], b: &[f64], k: isize) -> f64 {
    let shift = k.unsigned_abs();
    let pairs = if k >= 0 {
        a[shift..].iter().zip(&b[..b.len() - shift])
    } else {
        a[..a.len() - shift].iter().zip(&b[shift..])
    };
    pairs.map(|(x, y)| x * y).sum::<f64>() / a.len() as f64
}
