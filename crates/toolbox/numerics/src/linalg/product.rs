//! Products of matrices.

use faer::linalg::matmul::triangular::{BlockStructure, matmul};
use faer::{Accum, Mat, MatRef, Par, c64};

/// `A B`.
#[must_use]
pub fn product(a: MatRef<'_, f64>, b: MatRef<'_, f64>) -> Mat<f64> {
    work::checkpoint();
    a * b
}

/// `A B` of complex matrices.
#[must_use]
pub fn complex_product(a: MatRef<'_, c64>, b: MatRef<'_, c64>) -> Mat<c64> {
    work::checkpoint();
    a * b
}

/// The lower half of `AᵀA`; zero above the diagonal.
#[must_use]
pub fn gram(a: MatRef<'_, f64>) -> Mat<f64> {
    work::checkpoint();
    let mut gram = Mat::zeros(a.ncols(), a.ncols());
    let (lower, full) = (BlockStructure::TriangularLower, BlockStructure::Rectangular);
    matmul(gram.as_mut(), lower, Accum::Replace, a.transpose(), full, a, full, 1.0, Par::Seq);
    gram
}
