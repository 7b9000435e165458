//! Covariances that survive coloured residuals, and the covariance of functions of the parameters.

use faer::Mat;

use crate::{Fit, IdentError};

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
pub fn batched_sandwich(fit: &Fit, batches: usize) -> Result<(Mat<f64>, f64), IdentError> {
    let middle = batched_middle(fit, batches)?;
    Ok((&fit.unscaled_covariance * middle * &fit.unscaled_covariance, batches as f64 - 1.0))
}

fn batched_middle(fit: &Fit, batches: usize) -> Result<Mat<f64>, IdentError> {
    let (rows, n) = fit.jacobian.shape();
    let length = rows / batches.max(1);
    if batches < 2 || length <= n {
        return Err(IdentError::TooFewSamples { samples: rows, parameters: n * batches.max(2) });
    }
    let mut middle = Mat::<f64>::zeros(n, n);
    let mut sum = vec![0.0; n];
    for batch in 0..batches {
        let end = if batch + 1 == batches { rows } else { (batch + 1) * length };
        for (j, s) in sum.iter_mut().enumerate() {
            *s = (batch * length..end).map(|i| fit.jacobian[(i, j)] * fit.residuals[i]).sum();
        }
        for i in 0..n {
            for j in 0..n {
                middle[(i, j)] += sum[i] * sum[j];
            }
        }
    }
    // The sums add up to the gradient, which is zero at the minimum: one degree of freedom is spent on that.
    Ok(faer::Scale(batches as f64 / (batches as f64 - 1.0)) * middle)
}

/// Variance of g(θ) by the delta method: ∇gᵀ P ∇g, with the gradient by central differences whose steps are a small
/// part of each parameter's standard error.
///
/// # Source
/// Ljung 1999, (9.56) and appendix II; thesis (2.4).
pub fn delta_variance(parameters: &[f64], covariance: &Mat<f64>, function: impl Fn(&[f64]) -> f64) -> f64 {
    let n = parameters.len();
    let mut point = parameters.to_vec();
    let gradient: Vec<f64> = (0..n)
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
        .collect();
    let mut variance = 0.0;
    for i in 0..n {
        for j in 0..n {
            variance += gradient[i] * covariance[(i, j)] * gradient[j];
        }
    }
    variance
}
