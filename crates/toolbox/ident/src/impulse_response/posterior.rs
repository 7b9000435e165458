//! The posterior of a response under a Gaussian prior, and the likelihood of the prior.

use faer::Mat;
use numerics::linalg;

use crate::IdentError;
use fitting::triangle::upper_factor;

/// A regression as its triangular factor `[R₁ R₂]`, target last.
pub(super) struct Evidence {
    factor: Mat<f64>,
    pub(super) rows: usize,
}

/// Mean and covariance of the coefficients, given the data.
pub(super) struct Posterior {
    pub(super) mean: Vec<f64>,
    pub(super) covariance: Mat<f64>,
    /// Variance of the errors.
    pub(super) noise_variance: f64,
    /// The trace of the matrix from measured to fitted outputs.
    pub(super) effective_parameters: f64,
    pub(super) condition: f64,
}

impl Evidence {
    pub(super) fn new(factor: Mat<f64>, rows: usize) -> Self {
        Evidence { factor, rows }
    }

    fn coefficients(&self) -> usize {
        self.factor.ncols() - 1
    }

    /// Root of the mean square of these columns.
    pub(super) fn magnitude(&self, columns: std::ops::Range<usize>) -> f64 {
        let count = (columns.len() * self.rows) as f64;
        (columns.map(|j| self.factor.col(j).squared_norm_l2()).sum::<f64>() / count).sqrt()
    }

    pub(super) fn target_magnitude(&self) -> f64 {
        self.magnitude(self.coefficients()..self.coefficients() + 1)
    }

    /// The factor of `[R₁ L, R₂; I, 0]`, where `L Lᵀ σ²` is the prior covariance.
    fn augmented(&self, root: &Mat<f64>) -> Mat<f64> {
        let (m, n) = (self.factor.nrows(), self.coefficients());
        let projected = self.factor.get(.., ..n) * root;
        let stacked = Mat::from_fn(m + n, n + 1, |i, j| match (i < m, j < n) {
            (true, true) => projected[(i, j)],
            (true, false) => self.factor[(i, n)],
            (false, _) => f64::from(u8::from(i - m == j)),
        });
        upper_factor(stacked)
    }

    /// Minus twice the logarithm of the marginal likelihood, up to a constant, at the noise variance that maximises it:
    /// `N ln(σ̂² N) + ln det(I + Φ P Φᵀ)`, with the prior covariance `σ² P = σ² L Lᵀ`.
    pub(super) fn cost(&self, root: &Mat<f64>) -> f64 {
        let n = self.coefficients();
        let augmented = self.augmented(root);
        let determinant: f64 = (0..n).map(|i| augmented[(i, i)].abs().ln()).sum();
        let cost = 2.0 * (self.rows as f64 * augmented[(n, n)].abs().ln() + determinant);
        if cost.is_nan() { f64::INFINITY } else { cost }
    }

    pub(super) fn posterior(&self, root: &Mat<f64>) -> Result<Posterior, IdentError> {
        let n = self.coefficients();
        let augmented = self.augmented(root);
        let triangle = augmented.get(..n, ..n);
        let values = linalg::singular_values(triangle)?;
        let mut weights = augmented.get(..n, n..).to_owned();
        linalg::solve_upper(triangle, weights.as_mut());
        let mean = root * &weights;
        // L R⁻¹, by columns of its transpose R⁻ᵀ Lᵀ.
        let mut spread = root.transpose().to_owned();
        linalg::solve_lower(triangle.transpose(), spread.as_mut());
        let variance = augmented[(n, n)].powi(2) / self.rows as f64;
        Ok(Posterior {
            mean: (0..n).map(|i| mean[(i, 0)]).collect(),
            noise_variance: variance,
            covariance: faer::Scale(variance) * (spread.transpose() * &spread),
            effective_parameters: (self.factor.get(.., ..n) * spread.transpose()).squared_norm_l2(),
            condition: values.first().copied().unwrap_or(1.0) / values.last().copied().unwrap_or(1.0),
        })
    }
}
