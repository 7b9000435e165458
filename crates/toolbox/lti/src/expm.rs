//! The matrix exponential.

use faer::{Mat, MatRef, Scale};
use numerics::linalg;

use crate::error::{LtiError, check_finite, check_shape};
use crate::matrix::{balance, elements, identity, norm_1};

/// Coefficients of the diagonal Padé approximant of degree 13.
const PADE: [f64; 14] = [
    64_764_752_532_480_000.0,
    32_382_376_266_240_000.0,
    7_771_770_303_897_600.0,
    1_187_353_796_428_800.0,
    129_060_195_264_000.0,
    10_559_470_521_600.0,
    670_442_572_800.0,
    33_522_128_640.0,
    1_323_241_920.0,
    40_840_800.0,
    960_960.0,
    16_380.0,
    182.0,
    1.0,
];
/// Largest norm for which the approximant is exact to working precision.
const THETA: f64 = 5.371_920_351_148_152;

/// The matrix exponential `e^A = Σ Aᵏ/k!`, by balancing, scaling and squaring with a Padé approximant of degree 13.
///
/// `a` is square, n × n; so is the result.
///
/// # Errors
/// [`LtiError::Shape`] where `a` is not square, [`LtiError::NonFinite`] where it holds NaN or the result overflows.
///
/// # Example
/// ```
/// let rotation = lti::expm(faer::mat![[0.0, -1.0], [1.0, 0.0_f64]].as_ref())?;
/// assert!((rotation[(1, 0)] - 1.0_f64.sin()).abs() < 1e-15);
/// # Ok::<(), lti::LtiError>(())
/// ```
///
/// # Source
/// Higham, N. J. (2005), SIAM J. Matrix Anal. Appl. 26(4), 1179–1193, algorithm 2.3.
pub fn expm(a: MatRef<'_, f64>) -> Result<Mat<f64>, LtiError> {
    let n = a.nrows();
    check_shape("matrix of the exponential", (n, n), (n, a.ncols()))?;
    check_finite("matrix of the exponential", elements(a))?;
    if n == 0 {
        return Ok(Mat::zeros(0, 0));
    }
    let (balanced, d) = balance(a);
    let squarings = (norm_1(balanced.as_ref()) / THETA).log2().ceil().max(0.0) as i32;
    let mut power = pade(&balanced * Scale(0.5_f64.powi(squarings)));
    for _ in 0..squarings {
        power = &power * &power;
    }
    let result = Mat::from_fn(n, n, |i, j| d[i] * power[(i, j)] / d[j]);
    check_finite("matrix exponential", elements(result.as_ref()))?;
    Ok(result)
}

fn pade(a: Mat<f64>) -> Mat<f64> {
    let one = identity(a.nrows());
    let a2 = &a * &a;
    let a4 = &a2 * &a2;
    let a6 = &a4 * &a2;
    let high = |k: usize| &a6 * Scale(PADE[k + 5]) + &a4 * Scale(PADE[k + 3]) + &a2 * Scale(PADE[k + 1]);
    let low = |k: usize| {
        &a6 * Scale(PADE[k + 6]) + &a4 * Scale(PADE[k + 4]) + &a2 * Scale(PADE[k + 2]) + &one * Scale(PADE[k])
    };
    let odd = &a * (&a6 * high(8) + low(1));
    let even = &a6 * high(7) + low(0);
    linalg::solve((&even - &odd).as_ref(), (&even + &odd).as_ref())
}
