//! Dense helpers: whitening and the stationary Kalman filter.

pub(crate) mod covariance_root;

use faer::{Mat, MatRef};
use numerics::linalg::{self, Cholesky, DecompositionError, Lu};

use crate::IdentError;

/// Errors smaller than this part of an output's own size get no more weight for being smaller. Without noise their
/// covariance comes near to singular on the way, and weights by it alone stop the search in the rounding of one output
/// before the other is right.
pub(crate) const WEIGHT_FLOOR: f64 = 1e-6;

/// Largest modulus of the eigenvalues.
pub(crate) fn spectral_radius(m: MatRef<'_, f64>) -> Result<f64, IdentError> {
    if m.nrows() == 0 {
        return Ok(0.0);
    }
    let values = linalg::eigenvalues(m)?;
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
        if let Ok(factor) = Cholesky::new(raised.as_ref()) {
            let mut inverse = Mat::<f64>::identity(p, p);
            linalg::solve_lower(factor.lower(), inverse.as_mut());
            if (0..p).all(|i| inverse[(i, i)].is_finite()) {
                return Ok(inverse);
            }
        }
    }
    Err(DecompositionError::NotPositiveDefinite.into())
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
    let precision = linalg::inverse(r);
    let gain = s * &precision;
    let mut f = (a - &gain * c).transpose().to_owned();
    let mut g = c.transpose() * (&precision * c);
    let mut h = q - &gain * s.transpose();
    for _ in 0..DOUBLINGS {
        let lu = Lu::new((Mat::<f64>::identity(n, n) + &g * &h).as_ref());
        let (through_f, through_g) = (lu.solve(f.as_ref()), lu.solve(g.as_ref()));
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
    let gain = (a * (&h * c.transpose()) + s) * linalg::inverse(covariance.as_ref());
    let closed = a - &gain * c;
    let usable = closed.norm_max().is_finite() && spectral_radius(closed.as_ref()).is_ok_and(|radius| radius < 1.0);
    usable.then_some((gain, covariance))
}
