//! Linear least squares by QR, with its covariance.

use faer::{Mat, MatRef};

use crate::equation::{Equation, solve};
use crate::{IdentError, Triangle};

/// The solution of y = Φ θ + ε in the sense of least squares.
#[derive(Debug, Clone, PartialEq)]
pub struct LinearFit {
    /// θ.
    pub parameters: Vec<f64>,
    /// (ΦᵀΦ)⁻¹, by way of R: the covariance of θ divided by the variance of white ε.
    pub unscaled_covariance: Mat<f64>,
    /// Sum of squared residuals.
    pub cost: f64,
    /// Rows of Φ.
    pub samples: usize,
    /// Condition number of Φ with its columns scaled to one.
    pub condition: f64,
}

impl LinearFit {
    /// Samples less parameters.
    pub fn degrees_of_freedom(&self) -> f64 {
        self.samples as f64 - self.parameters.len() as f64
    }

    /// Variance of ε: cost over degrees of freedom.
    pub fn noise_variance(&self) -> f64 {
        self.cost / self.degrees_of_freedom()
    }

    /// Covariance of θ when ε is white.
    pub fn covariance(&self) -> Mat<f64> {
        faer::Scale(self.noise_variance()) * &self.unscaled_covariance
    }
}

/// Solves y = Φ θ + ε by QR of [Φ y] with scaled columns.
///
/// `regressors` is Φ (rows are samples, columns parameters), `target` is y.
///
/// # Errors
/// Fewer rows than columns, lengths that differ, values that are not finite, or columns that are linearly dependent.
///
/// # Example
/// ```
/// use faer::mat;
/// let phi = mat![[1.0, 0.0], [1.0, 1.0], [1.0, 2.0]];
/// let fit = fitting::least_squares(phi.as_ref(), &[1.0, 3.0, 5.0])?;
/// assert!((fit.parameters[1] - 2.0).abs() < 1e-12);
/// # Ok::<(), fitting::IdentError>(())
/// ```
///
/// # Source
/// Ljung 1999, §10.1 (least squares by QR).
pub fn least_squares(regressors: MatRef<'_, f64>, target: &[f64]) -> Result<LinearFit, IdentError> {
    let (rows, columns) = regressors.shape();
    if target.len() != rows {
        return Err(IdentError::Length { what: "target", expected: rows, found: target.len() });
    }
    let mut triangle = Triangle::new(columns + 1);
    let mut row = vec![0.0; columns + 1];
    for i in 0..rows {
        for j in 0..columns {
            row[j] = regressors[(i, j)];
        }
        row[columns] = target[i];
        if let Some(bad) = row.iter().position(|v| !v.is_finite()) {
            let what = if bad == columns { "target" } else { "regressors" };
            return Err(IdentError::NotFinite { what, index: i });
        }
        triangle.push_row(&row);
    }
    solve_triangle(triangle)
}

/// Solves the least-squares problem whose rows [Φ y] were gathered in `triangle`.
///
/// # Errors
/// Fewer rows than parameters, or columns that are linearly dependent.
pub fn solve_triangle(triangle: Triangle) -> Result<LinearFit, IdentError> {
    let samples = triangle.rows();
    solve_factor(&triangle.finish(), samples)
}

/// Solves the least-squares problem of `samples` rows [Φ y] whose square triangular factor is given.
///
/// # Errors
/// Those of [`solve_triangle`].
pub fn solve_factor(factor: &Mat<f64>, samples: usize) -> Result<LinearFit, IdentError> {
    let n = factor.ncols() - 1;
    if samples <= n {
        return Err(IdentError::TooFewSamples { samples, parameters: n });
    }
    let regressors: Vec<usize> = (0..n).collect();
    let solution = solve(factor, &Equation { instruments: regressors.clone(), regressors, target: n })?;
    Ok(LinearFit {
        parameters: solution.theta,
        unscaled_covariance: solution.gain,
        cost: factor[(n, n)] * factor[(n, n)],
        samples,
        condition: solution.condition,
    })
}
