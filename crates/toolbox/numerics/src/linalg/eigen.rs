//! Eigenvalues.

use faer::{Mat, MatRef, Side, c64};

use super::DecompositionError;

/// Eigenvalues and, as columns, the eigenvectors of a general matrix.
#[derive(Debug, Clone)]
pub struct Eigen {
    /// The eigenvalues.
    pub values: Vec<c64>,
    /// The eigenvectors as columns.
    pub vectors: Mat<c64>,
}

/// Eigenvalues in ascending order and, as columns, the orthonormal eigenvectors of a symmetric matrix.
#[derive(Debug, Clone)]
pub struct SymmetricEigen {
    /// The eigenvalues, ascending.
    pub values: Vec<f64>,
    /// The eigenvectors as columns.
    pub vectors: Mat<f64>,
}

/// Eigenvalues and eigenvectors of a square matrix.
///
/// # Errors
/// [`DecompositionError::Eigenvalues`].
pub fn eigen(m: MatRef<'_, f64>) -> Result<Eigen, DecompositionError> {
    work::checkpoint();
    let found = m.eigen().map_err(|_| DecompositionError::Eigenvalues)?;
    let values = found.S().column_vector().iter().copied().collect();
    Ok(Eigen { values, vectors: found.U().to_owned() })
}

/// Eigenvalues of a square matrix.
///
/// # Errors
/// [`DecompositionError::Eigenvalues`].
pub fn eigenvalues(m: MatRef<'_, f64>) -> Result<Vec<c64>, DecompositionError> {
    work::checkpoint();
    m.eigenvalues().map_err(|_| DecompositionError::Eigenvalues)
}

/// Eigenvalues and eigenvectors of a symmetric matrix, of which the lower half is read.
///
/// # Errors
/// [`DecompositionError::Eigenvalues`].
pub fn symmetric_eigen(m: MatRef<'_, f64>) -> Result<SymmetricEigen, DecompositionError> {
    work::checkpoint();
    let found = m.self_adjoint_eigen(Side::Lower).map_err(|_| DecompositionError::Eigenvalues)?;
    let values = found.S().column_vector().iter().copied().collect();
    Ok(SymmetricEigen { values, vectors: found.U().to_owned() })
}

/// Eigenvalues of a symmetric matrix, of which the lower half is read, in ascending order.
///
/// # Errors
/// [`DecompositionError::Eigenvalues`].
pub fn symmetric_eigenvalues(m: MatRef<'_, f64>) -> Result<Vec<f64>, DecompositionError> {
    work::checkpoint();
    m.self_adjoint_eigenvalues(Side::Lower).map_err(|_| DecompositionError::Eigenvalues)
}
