//! The covariance of an output-error estimate whose errors are coloured.

use faer::Mat;
use statrs::distribution::{ChiSquared, ContinuousCDF};

use super::predictor::Predictor;
use crate::Dataset;

/// Lags of the test for colour.
const LAGS: usize = 20;
/// Probability with which white errors are taken for coloured ones.
const FALSE_ALARM: f64 = 1e-3;
/// Consecutive stretches of the data whose gradients are taken as independent.
const BATCHES: usize = 40;

/// Whether any output's errors are autocorrelated, by the portmanteau test.
///
/// # Source
/// Ljung & Box, *On a measure of lack of fit in time series models*, Biometrika 65(2), 1978.
pub(super) fn is_coloured(predictor: &Predictor, data: &Dataset, x0: &[Vec<f64>]) -> bool {
    let p = predictor.p;
    let mut sums = vec![[0.0; LAGS + 1]; p];
    let mut rows = 0.0;
    for (experiment, x0) in data.experiments().iter().zip(x0) {
        let mut past = vec![[0.0; LAGS + 1]; p];
        predictor.walk(experiment, x0, |_, _, e, complete| {
            rows += f64::from(u8::from(complete));
            for ((sum, past), e) in sums.iter_mut().zip(&mut past).zip(e) {
                past.rotate_right(1);
                past[0] = if complete { *e } else { 0.0 };
                sum.iter_mut().zip(&*past).for_each(|(s, v)| *s += past[0] * v);
            }
        });
    }
    let Ok(distribution) = ChiSquared::new(LAGS as f64) else { return false };
    let limit = distribution.inverse_cdf(1.0 - FALSE_ALARM / p as f64);
    let statistic = |s: &[f64; LAGS + 1]| rows * s[1..].iter().map(|v| (v / s[0]) * (v / s[0])).sum::<f64>();
    sums.iter().any(|s| s[0] > 0.0 && statistic(s) > limit)
}

/// The sandwich `P M P` with `P = U Uᵀ` and `M` from the gradients of consecutive batches, and the degrees of freedom
/// of a variance from it; `None` where the data hold too few batches.
///
/// # Source
/// Ljung 1999, (9.42) for the sandwich; Ibragimov & Müller, *t-statistic based correlation and heterogeneity robust
/// inference*, 2010, for the use of batches.
pub(super) fn sandwich(gradients: &[Vec<f64>], unit: &Mat<f64>) -> Option<(Mat<f64>, f64)> {
    let length = gradients.len() / BATCHES;
    if length == 0 {
        return None;
    }
    let n = unit.nrows();
    let mut turned = Mat::<f64>::zeros(n, BATCHES);
    for (index, gradient) in gradients.iter().enumerate() {
        let batch = (index / length).min(BATCHES - 1);
        gradient.iter().enumerate().for_each(|(j, g)| turned[(j, batch)] += g);
    }
    // The sums add up to the gradient, zero at the minimum: what rounding or the initial states left is taken off.
    for j in 0..n {
        let mean = turned.row(j).iter().sum::<f64>() / BATCHES as f64;
        turned.row_mut(j).iter_mut().for_each(|v| *v -= mean);
    }
    let steps = unit * (unit.transpose() * turned);
    let factor = BATCHES as f64 / (BATCHES as f64 - 1.0);
    Some((&steps * steps.transpose() * faer::Scale(factor), BATCHES as f64 - 1.0))
}
