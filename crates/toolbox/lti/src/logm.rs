//! The matrix logarithm.

use faer::{Mat, MatRef, Scale};
use numerics::linalg;

use crate::Complex64;
use crate::error::{LtiError, check_finite, check_shape};
use crate::matrix::{balance, elements, is_singular};
use crate::schur::Schur;

/// Nodes and weights of Gauss and Legendre's quadrature on −1 ..= 1, which is the diagonal Padé approximant of degree
/// 8.
const GAUSS: [(f64, f64); 4] = [
    (0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.525_532_409_916_329, 0.313_706_645_877_887_3),
    (0.796_666_477_413_626_7, 0.222_381_034_453_374_48),
    (0.960_289_856_497_536_3, 0.101_228_536_290_376_26),
];
/// Norm below which the approximant is exact to working precision.
const THETA: f64 = 0.25;
const MAX_ROOTS: i32 = 100;
/// An eigenvalue this near to the negative real axis, relative to its size, counts as on it.
const ON_AXIS: f64 = 1e-8;

/// The principal matrix logarithm, the real `L` with `e^L = A` and eigenvalues of imaginary part within ±π, by square
/// roots of the triangular Schur factor and a Padé approximant of degree 8.
///
/// `a` is square, n × n; so is the result.
///
/// # Errors
/// [`LtiError::NoLogarithm`] where `a` is singular to working precision or has a negative real eigenvalue;
/// [`LtiError::Shape`] where it is not square, [`LtiError::NonFinite`], [`LtiError::NoConvergence`].
///
/// # Example
/// ```
/// let turn = lti::expm(faer::mat![[0.0, -1.0], [1.0, 0.0_f64]].as_ref())?;
/// assert!((lti::logm(turn.as_ref())?[(1, 0)] - 1.0).abs() < 1e-15);
/// # Ok::<(), lti::LtiError>(())
/// ```
///
/// # Source
/// Higham, N. J. (2008), *Functions of Matrices*, algorithm 11.9; diagonals after Al-Mohy, A. H. and Higham, N. J.
/// (2012), SIAM J. Sci. Comput. 34(4), C153–C169.
pub fn logm(a: MatRef<'_, f64>) -> Result<Mat<f64>, LtiError> {
    let n = a.nrows();
    check_shape("matrix of the logarithm", (n, n), (n, a.ncols()))?;
    check_finite("matrix of the logarithm", elements(a))?;
    if n == 0 {
        return Ok(Mat::zeros(0, 0));
    }
    let (balanced, d) = balance(a);
    if is_singular(balanced.as_ref())? {
        return Err(LtiError::NoLogarithm { re: 0.0, im: 0.0 });
    }
    let Schur { t, z } = Schur::new(balanced.as_ref())?;
    for value in (0..n).map(|i| t[(i, i)]) {
        if value.re <= 0.0 && value.im.abs() <= ON_AXIS * value.re.abs() {
            return Err(LtiError::NoLogarithm { re: value.re, im: value.im });
        }
    }
    let whole = &z * triangular(t)? * z.adjoint();
    let result = Mat::from_fn(n, n, |i, j| d[i] * whole[(i, j)].re / d[j]);
    check_finite("matrix logarithm", elements(result.as_ref()))?;
    Ok(result)
}

/// The logarithm of an upper triangular matrix.
fn triangular(mut t: Mat<Complex64>) -> Result<Mat<Complex64>, LtiError> {
    let n = t.nrows();
    let logs: Vec<Complex64> = (0..n).map(|i| t[(i, i)].ln()).collect();
    let mut halvings = 0;
    let less_one = loop {
        let scale = 0.5_f64.powi(halvings);
        // The diagonal from its logarithm, not by subtracting one, which would cancel.
        let x = Mat::from_fn(n, n, |i, j| if i == j { exp_less_one(logs[i] * scale) } else { t[(i, j)] });
        let norm = (0..n).map(|j| (0..=j).map(|i| x[(i, j)].norm()).sum()).fold(0.0, f64::max);
        if norm <= THETA {
            break x;
        }
        if halvings == MAX_ROOTS {
            return Err(LtiError::NoConvergence);
        }
        t = square_root(&t);
        halvings += 1;
    };
    let mut sum: Mat<Complex64> = Mat::zeros(n, n);
    for (node, weight) in GAUSS.iter().flat_map(|(x, w)| [(-x, *w), (*x, *w)]) {
        let at = 0.5 * (1.0 + node);
        let shifted = Mat::from_fn(n, n, |i, j| less_one[(i, j)] * at + f64::from(u8::from(i == j)));
        sum += linalg::complex_solve(shifted.as_ref(), less_one.as_ref()) * Scale(Complex64::from(0.5 * weight));
    }
    let factor = 2_f64.powi(halvings);
    Ok(Mat::from_fn(n, n, |i, j| if i == j { logs[i] } else { sum[(i, j)] * factor }))
}

/// `e^x − 1` without cancellation.
fn exp_less_one(x: Complex64) -> Complex64 {
    // e^(a + jb) − 1 = (e^a − 1) cos b + (cos b − 1) + j e^a sin b
    let half = (0.5 * x.im).sin();
    Complex64::new(x.re.exp_m1() * x.im.cos() - 2.0 * half * half, x.re.exp() * x.im.sin())
}

/// The principal square root of an upper triangular matrix, by columns.
fn square_root(t: &Mat<Complex64>) -> Mat<Complex64> {
    let n = t.nrows();
    let mut root: Mat<Complex64> = Mat::zeros(n, n);
    for j in 0..n {
        root[(j, j)] = t[(j, j)].sqrt();
        for i in (0..j).rev() {
            let inner: Complex64 = (i + 1..j).map(|k| root[(i, k)] * root[(k, j)]).sum();
            root[(i, j)] = (t[(i, j)] - inner) / (root[(i, i)] + root[(j, j)]);
        }
    }
    root
}
