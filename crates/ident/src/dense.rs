//! Dense helpers: truncated least squares and the stationary Kalman filter.

use faer::linalg::solvers::{DenseSolveCore, Solve};
use faer::{Mat, MatRef};

use crate::IdentError;

/// The solution of least norm of `min ‖M X − R‖`, singular values below `tolerance` times the largest taken as zero.
pub(crate) fn solve_truncated(
    m: MatRef<'_, f64>,
    right: MatRef<'_, f64>,
    tolerance: f64,
) -> Result<Mat<f64>, IdentError> {
    if m.ncols() == 0 || m.nrows() == 0 {
        return Ok(Mat::zeros(m.ncols(), right.ncols()));
    }
    let svd = m.thin_svd().map_err(|_| IdentError::Decomposition { what: "singular value" })?;
    let values: Vec<f64> = svd.S().column_vector().iter().copied().collect();
    let floor = tolerance * values.first().copied().unwrap_or(0.0);
    let mut inner = svd.U().transpose() * right;
    for i in 0..inner.nrows() {
        let factor = if values[i] > floor { 1.0 / values[i] } else { 0.0 };
        inner.row_mut(i).iter_mut().for_each(|v| *v *= factor);
    }
    Ok(svd.V() * inner)
}

/// Largest modulus of the eigenvalues.
pub(crate) fn spectral_radius(m: MatRef<'_, f64>) -> Result<f64, IdentError> {
    if m.nrows() == 0 {
        return Ok(0.0);
    }
    let values = m.eigenvalues().map_err(|_| IdentError::Decomposition { what: "eigenvalue" })?;
    Ok(values.iter().map(|v| v.norm()).fold(0.0, f64::max))
}

/// `L⁻¹` of `Λ = L Lᵀ`. A covariance that is not positive definite, as with an output predicted exactly, is raised
/// along its diagonal by as little as makes it so.
pub(crate) fn whitening(covariance: MatRef<'_, f64>) -> Result<Mat<f64>, IdentError> {
    let p = covariance.nrows();
    let mut trace = (0..p).map(|i| covariance[(i, i)].abs()).sum::<f64>() / p.max(1) as f64;
    if trace <= 0.0 {
        trace = 1.0;
    }
    for raise in [0.0, 1e-14, 1e-12, 1e-9, 1.0] {
        let raised = Mat::from_fn(p, p, |i, j| covariance[(i, j)] + if i == j { raise * trace } else { 0.0 });
        if let Ok(factor) = raised.llt(faer::Side::Lower) {
            let lower = factor.L().to_owned();
            let mut inverse = Mat::<f64>::identity(p, p);
            faer::linalg::triangular_solve::solve_lower_triangular_in_place(
                lower.as_ref(),
                inverse.as_mut(),
                faer::Par::Seq,
            );
            if (0..p).all(|i| inverse[(i, i)].is_finite()) {
                return Ok(inverse);
            }
        }
    }
    Err(IdentError::Decomposition { what: "Cholesky" })
}

/// The gain `K` and the innovations' covariance `Λ` of the stationary Kalman filter of
/// `x(t+1) = A x(t) + w(t)`, `y(t) = C x(t) + v(t)` with the joint covariance `[Q S; Sᵀ R]` of `w` and `v`; `None`
/// where there is no filter that forgets its start.
///
/// # Source
/// Chu, Fan, Lin & Wang, *Structure-preserving algorithms for periodic discrete-time algebraic Riccati equations*,
/// Int. J. Control 77(8), 2004: the doubling iteration, for the dual (filter) equation.
pub(crate) fn kalman(
    a: MatRef<'_, f64>,
    c: MatRef<'_, f64>,
    q: MatRef<'_, f64>,
    s: MatRef<'_, f64>,
    r: MatRef<'_, f64>,
) -> Option<(Mat<f64>, Mat<f64>)> {
    const DOUBLINGS: usize = 60;
    let n = a.nrows();
    let precision = r.partial_piv_lu().inverse();
    let gain = s * &precision;
    let mut f = (a - &gain * c).transpose().to_owned();
    let mut g = c.transpose() * (&precision * c);
    let mut h = q - &gain * s.transpose();
    for _ in 0..DOUBLINGS {
        let lu = (Mat::<f64>::identity(n, n) + &g * &h).partial_piv_lu();
        let (through_f, through_g) = (lu.solve(&f), lu.solve(&g));
        let added = f.transpose() * (&h * &through_f);
        g = &g + &f * (&through_g * f.transpose());
        h = &h + &added;
        h = Mat::from_fn(n, n, |i, j| 0.5 * (h[(i, j)] + h[(j, i)]));
        f = &f * &through_f;
        if !(added.norm_max().is_finite() && g.norm_max().is_finite()) {
            return None;
        }
        if added.norm_max() <= 1e-15 * h.norm_max() {
            break;
        }
    }
    let covariance = c * (&h * c.transpose()) + r;
    let gain = (a * (&h * c.transpose()) + s) * covariance.partial_piv_lu().inverse();
    let closed = a - &gain * c;
    let usable = closed.norm_max().is_finite() && spectral_radius(closed.as_ref()).is_ok_and(|radius| radius < 1.0);
    usable.then_some((gain, covariance))
}
