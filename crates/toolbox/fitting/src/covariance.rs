//! Covariances that survive coloured residuals, and the covariance of functions of the parameters.

use std::ops::Range;

use faer::Mat;

use crate::{IdentError, Minimum};

/// Covariance of parameters when the residuals are coloured: the sandwich (JᵀJ)⁻¹ M (JᵀJ)⁻¹ whose middle is built from
/// sums of J_tᵀε_t over `batches` consecutive stretches of equal length.
///
/// Stretches must be long against the memory of the residuals; then the batch sums are nearly independent and the
/// statistic of one parameter is close to Student's t with `batches − 1` degrees of freedom, which is returned beside
/// the covariance. Periodic residuals (ripple, firing) average out within a batch, as they should.
///
/// # Errors
/// Fewer than two batches, or batches shorter than the number of parameters.
///
/// # Source
/// Ljung 1999, (9.42) for the sandwich; Ibragimov & Müller, *t-statistic based correlation and heterogeneity robust
/// inference*, 2010, for the use of batches.
pub fn batched_sandwich(fit: &Minimum, batches: usize) -> Result<(Mat<f64>, f64), IdentError> {
    let middle = batched_middle(fit, batches)?;
    Ok((&fit.unscaled_covariance * middle * &fit.unscaled_covariance, batches as f64 - 1.0))
}

fn batched_middle(fit: &Minimum, batches: usize) -> Result<Mat<f64>, IdentError> {
    let n = fit.jacobian.ncols();
    let mut sums = Mat::<f64>::zeros(batches, n);
    for (batch, rows) in batches_of_rows(fit, batches)?.enumerate() {
        for j in 0..n {
            sums[(batch, j)] = rows.clone().map(|i| fit.jacobian[(i, j)] * fit.residuals[i]).sum();
        }
    }
    Ok(middle_of_batches(&sums))
}

/// The rows of a fit in so many consecutive batches, equally long but for the last.
///
/// # Errors
/// [`IdentError::TooFewSamples`] where a batch has no more rows than there are parameters, or where there are less than
/// two.
pub fn batches_of_rows(fit: &Minimum, batches: usize) -> Result<impl Iterator<Item = Range<usize>>, IdentError> {
    let (rows, n) = fit.jacobian.shape();
    let length = rows / batches.max(1);
    if batches < 2 || length <= n {
        return Err(IdentError::TooFewSamples { samples: rows, parameters: n * batches.max(2) });
    }
    let end = move |batch: usize| if batch + 1 == batches { rows } else { (batch + 1) * length };
    Ok((0..batches).map(move |batch| batch * length..end(batch)))
}

/// The middle of the sandwich from the sums of J_tᵀε_t, one row a batch.
pub fn middle_of_batches(sums: &Mat<f64>) -> Mat<f64> {
    let batches = sums.nrows() as f64;
    // The sums add up to the gradient, which is zero at the minimum: one degree of freedom is spent on that.
    faer::Scale(batches / (batches - 1.0)) * (sums.transpose() * sums)
}

/// The batched sandwich, but for no parameter less than the covariance under white residuals: a parameter whose data
/// lie in one batch, such as an initial state, has no scatter between batches to be judged by.
///
/// Returns the covariance and the degrees of freedom to use with it.
///
/// # Errors
/// Those of [`batched_sandwich`].
pub fn at_least_white(fit: &Minimum, batches: usize) -> Result<(Mat<f64>, f64), IdentError> {
    let (robust, degrees_of_freedom) = batched_sandwich(fit, batches)?;
    let white = fit.covariance();
    let n = white.nrows();
    let inflation: Vec<f64> = (0..n)
        .map(|i| if white[(i, i)] > 0.0 { (robust[(i, i)] / white[(i, i)]).sqrt().max(1.0) } else { 1.0 })
        .collect();
    Ok((Mat::from_fn(n, n, |i, j| white[(i, j)] * inflation[i] * inflation[j]), degrees_of_freedom))
}

/// Gradient of g(θ) by central differences whose steps are a small part of each parameter's standard error; zero for
/// parameters without uncertainty.
pub fn gradient(parameters: &[f64], covariance: &Mat<f64>, function: impl Fn(&[f64]) -> f64) -> Vec<f64> {
    let mut point = parameters.to_vec();
    (0..parameters.len())
        .map(|j| {
            let step = 1e-2 * covariance[(j, j)].sqrt();
            if step <= 1e-12 * parameters[j].abs() {
                return 0.0;
            }
            point[j] = parameters[j] + step;
            let above = function(&point);
            point[j] = parameters[j] - step;
            let below = function(&point);
            point[j] = parameters[j];
            (above - below) / (2.0 * step)
        })
        .collect()
}

/// Variance of g(θ) by the delta method: ∇gᵀ P ∇g.
///
/// # Source
/// Ljung 1999, (9.56) and appendix II; thesis (2.4).
pub fn delta_variance(parameters: &[f64], covariance: &Mat<f64>, function: impl Fn(&[f64]) -> f64) -> f64 {
    let slope = gradient(parameters, covariance, function);
    let n = parameters.len();
    (0..n).map(|i| (0..n).map(|j| slope[i] * covariance[(i, j)] * slope[j]).sum::<f64>()).sum()
}
