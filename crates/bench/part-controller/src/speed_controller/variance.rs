//! The variance that coefficients of a fit have under coloured residuals, where few stretches of the data show them.

use faer::Mat;
use ident::covariance::batches_of_rows;
use ident::{IdentError, Minimum};
use numerics::linalg::{self, Cholesky};

/// Variance of the residuals as far as they bear on some coefficients, and its degrees of freedom: times (JᵀJ)⁻¹, the
/// covariance of these under coloured residuals. It is no less than that of all residuals.
///
/// The scatter is that of batch sums, as in [`ident::covariance::batched_sandwich`], along the directions in which
/// white residuals move the coefficients independently; one variance is taken for all of these. Coefficients that only
/// a few batches bear on have fewer degrees of freedom than there are batches, and residuals of a fit scatter less
/// there than its errors. Both follow from the covariance G that the sums have under white residuals. An estimate of
/// it is unbiased with tr G in the denominator, and has (tr G)²/tr G² degrees of freedom.
///
/// # Errors
/// Those of [`ident::covariance::batched_sandwich`]; coefficients that a single batch shows, which has nothing to
/// scatter against.
///
/// # Source
/// Bell & McCaffrey, *Bias reduction in standard errors for linear regression with multi-stage samples*, Survey
/// Methodology 28, 2002; Satterthwaite, *An approximate distribution of estimates of variance components*, 1946.
pub(super) fn variance_towards(
    fit: &Minimum,
    batches: usize,
    coefficients: &[usize],
) -> Result<(f64, f64), IdentError> {
    let (rows, n) = fit.jacobian.shape();
    let (m, stretches) = (coefficients.len(), batches_of_rows(fit, batches)?);
    let too_few = IdentError::TooFewSamples { samples: rows, parameters: n * batches };
    let chosen = Mat::from_fn(n, m, |i, k| fit.unscaled_covariance[(i, coefficients[k])]);
    let block = Mat::from_fn(m, m, |k, l| chosen[(coefficients[k], l)]);
    let Ok(root) = Cholesky::new(block.as_ref()) else { return Err(too_few) };
    // Columns that are orthonormal over all rows.
    let bearing = &fit.jacobian * (&chosen * linalg::inverse(root.lower()).transpose());
    let mut sums = Mat::<f64>::zeros(batches * m, 1);
    let mut shares = Mat::<f64>::zeros(batches * m, m);
    let mut taken = Mat::<f64>::zeros(n, batches * m);
    for (batch, stretch) in stretches.enumerate() {
        let (own, length) = (bearing.get(stretch.clone(), ..), stretch.len());
        let residuals = Mat::from_fn(length, 1, |i, _| fit.residuals[stretch.start + i]);
        sums.subrows_mut(batch * m, m).copy_from(own.transpose() * residuals);
        shares.subrows_mut(batch * m, m).copy_from(own.transpose() * own);
        taken.subcols_mut(batch * m, m).copy_from(fit.jacobian.get(stretch, ..).transpose() * own);
    }
    let explained = taken.transpose() * &fit.unscaled_covariance * &taken;
    let white = |i: usize, j: usize| if i / m == j / m { shares[(i, j % m)] } else { 0.0 };
    let under_white = Mat::from_fn(batches * m, batches * m, |i, j| white(i, j) - explained[(i, j)]);
    let trace: f64 = (0..batches * m).map(|i| under_white[(i, i)]).sum();
    let freedom = trace * trace / under_white.squared_norm_l2();
    if freedom.is_nan() || freedom < 1.0 {
        return Err(too_few);
    }
    Ok(((sums.squared_norm_l2() / trace).max(fit.noise_variance()), freedom))
}
