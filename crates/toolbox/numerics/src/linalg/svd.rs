//! Singular values.

use faer::linalg::solvers;
use faer::{Mat, MatRef, c64};

use super::DecompositionError;

/// `M = U S Vᵀ` with singular values in descending order.
#[derive(Debug, Clone)]
pub struct Svd {
    /// `U`: left singular vectors as columns.
    pub u: Mat<f64>,
    /// The diagonal of `S`.
    pub values: Vec<f64>,
    /// `V`: right singular vectors as columns.
    pub v: Mat<f64>,
}

/// `M = U S Vᴴ` of a complex matrix, with singular values in descending order.
#[derive(Debug, Clone)]
pub struct ComplexSvd {
    /// `U`: left singular vectors as columns.
    pub u: Mat<c64>,
    /// The diagonal of `S`.
    pub values: Vec<f64>,
    /// `V`: right singular vectors as columns.
    pub v: Mat<c64>,
}

/// The decomposition with square `U` and `V`.
///
/// # Errors
/// [`DecompositionError::SingularValues`].
pub fn svd(m: MatRef<'_, f64>) -> Result<Svd, DecompositionError> {
    work::checkpoint();
    m.svd().map(parts).map_err(|_| DecompositionError::SingularValues)
}

/// The decomposition with as many columns of `U` and `V` as there are singular values.
///
/// # Errors
/// [`DecompositionError::SingularValues`].
pub fn thin_svd(m: MatRef<'_, f64>) -> Result<Svd, DecompositionError> {
    work::checkpoint();
    m.thin_svd().map(parts).map_err(|_| DecompositionError::SingularValues)
}

/// The singular values alone, in descending order.
///
/// # Errors
/// [`DecompositionError::SingularValues`].
pub fn singular_values(m: MatRef<'_, f64>) -> Result<Vec<f64>, DecompositionError> {
    work::checkpoint();
    m.singular_values().map_err(|_| DecompositionError::SingularValues)
}

/// The decomposition of a complex matrix, with square `U` and `V`.
///
/// # Errors
/// [`DecompositionError::SingularValues`].
pub fn complex_svd(m: MatRef<'_, c64>) -> Result<ComplexSvd, DecompositionError> {
    work::checkpoint();
    let svd = m.svd().map_err(|_| DecompositionError::SingularValues)?;
    let values = svd.S().column_vector().iter().map(|v| v.re).collect();
    Ok(ComplexSvd { u: svd.U().to_owned(), values, v: svd.V().to_owned() })
}

/// The `X` of least norm that makes `‖M X − B‖` least, with singular values below `tolerance` times the largest taken
/// as zero.
///
/// # Errors
/// [`DecompositionError::SingularValues`].
pub fn least_norm(m: MatRef<'_, f64>, b: MatRef<'_, f64>, tolerance: f64) -> Result<Mat<f64>, DecompositionError> {
    if m.nrows() == 0 || m.ncols() == 0 {
        return Ok(Mat::zeros(m.ncols(), b.ncols()));
    }
    let Svd { u, values, v } = thin_svd(m)?;
    let floor = tolerance * values[0];
    let mut along = u.transpose() * b;
    for (i, value) in values.iter().enumerate() {
        let shown = *value > floor;
        along.row_mut(i).iter_mut().for_each(|entry| *entry = if shown { *entry / value } else { 0.0 });
    }
    Ok(v * along)
}

fn parts(svd: solvers::Svd<f64>) -> Svd {
    let values = svd.S().column_vector().iter().copied().collect();
    Svd { u: svd.U().to_owned(), values, v: svd.V().to_owned() }
}
