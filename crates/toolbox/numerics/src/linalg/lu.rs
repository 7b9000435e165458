//! Linear equations of square matrices.
//!
//! A singular matrix gives values that are not finite, or very large.

use faer::linalg::solvers::{DenseSolveCore, FullPivLu, PartialPivLu, Solve};
use faer::{Mat, MatRef, c64};

/// The factors of a square matrix, rows pivoted.
#[derive(Debug, Clone)]
pub struct Lu(PartialPivLu<f64>);

impl Lu {
    /// Factorises a square matrix.
    #[must_use]
    pub fn new(m: MatRef<'_, f64>) -> Self {
        Lu(m.partial_piv_lu())
    }

    /// `X` with `M X = B`.
    #[must_use]
    pub fn solve(&self, b: MatRef<'_, f64>) -> Mat<f64> {
        self.0.solve(b)
    }

    /// `M⁻¹`.
    #[must_use]
    pub fn inverse(&self) -> Mat<f64> {
        self.0.inverse()
    }
}

/// The factors of a square matrix, rows and columns pivoted: slower, and more accurate near singularity.
#[derive(Debug, Clone)]
pub struct FullyPivotedLu(FullPivLu<f64>);

impl FullyPivotedLu {
    /// Factorises a square matrix.
    #[must_use]
    pub fn new(m: MatRef<'_, f64>) -> Self {
        FullyPivotedLu(m.full_piv_lu())
    }

    /// `X` with `M X = B`.
    #[must_use]
    pub fn solve(&self, b: MatRef<'_, f64>) -> Mat<f64> {
        self.0.solve(b)
    }
}

/// `X` with `A X = B`.
#[must_use]
pub fn solve(a: MatRef<'_, f64>, b: MatRef<'_, f64>) -> Mat<f64> {
    Lu::new(a).solve(b)
}

/// `A⁻¹`.
#[must_use]
pub fn inverse(a: MatRef<'_, f64>) -> Mat<f64> {
    Lu::new(a).inverse()
}

/// The determinant.
#[must_use]
pub fn determinant(a: MatRef<'_, f64>) -> f64 {
    a.determinant()
}

/// `X` with `A X = B`, of complex matrices.
#[must_use]
pub fn complex_solve(a: MatRef<'_, c64>, b: MatRef<'_, c64>) -> Mat<c64> {
    work::checkpoint();
    a.partial_piv_lu().solve(b)
}
