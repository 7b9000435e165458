//! Positive definite matrices.

use faer::linalg::solvers::{DenseSolveCore, Llt, Solve};
use faer::{Mat, MatRef, Side};

use super::DecompositionError;

/// `M = L Lᵀ` of a positive definite matrix.
#[derive(Debug, Clone)]
pub struct Cholesky(Llt<f64>);

impl Cholesky {
    /// Factorises a symmetric matrix, of which the lower half is read.
    ///
    /// # Errors
    /// [`DecompositionError::NotPositiveDefinite`].
    pub fn new(m: MatRef<'_, f64>) -> Result<Self, DecompositionError> {
        work::checkpoint();
        m.llt(Side::Lower).map(Cholesky).map_err(|_| DecompositionError::NotPositiveDefinite)
    }

    /// `L`, lower triangular.
    #[must_use]
    pub fn lower(&self) -> MatRef<'_, f64> {
        self.0.L()
    }

    /// `M⁻¹`.
    #[must_use]
    pub fn inverse(&self) -> Mat<f64> {
        self.0.inverse()
    }

    /// `X` with `M X = B`.
    #[must_use]
    pub fn solve(&self, b: MatRef<'_, f64>) -> Mat<f64> {
        self.0.solve(b)
    }
}
