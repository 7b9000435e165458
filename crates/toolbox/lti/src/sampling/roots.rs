//! Roots on their way between discrete and continuous time.

use crate::Complex64;
use crate::error::LtiError;

/// A zero this near to −1 comes from infinity, if it is the only one.
const AT_INFINITY: f64 = 1e-6;
/// Zeros about −1 that rounding may have driven apart.
const CLUSTER: f64 = 0.1;

/// `ln(z)/T`.
pub(super) fn logarithm(root: Complex64, sample_time_s: f64) -> Result<Complex64, LtiError> {
    if root.im == 0.0 && root.re <= 0.0 {
        return Err(LtiError::NoLogarithm { re: root.re, im: root.im });
    }
    Ok(root.ln() / sample_time_s)
}

/// Test of whether a zero lies on −1, which means infinity, within the precision of the zeros.
pub(super) fn at_infinity(zeros: &[Complex64]) -> impl Fn(&Complex64) -> bool + use<> {
    let from_minus_one = |r: &Complex64| (r + 1.0).norm();
    let scattered = |r: &&Complex64| from_minus_one(r) > 0.0 && from_minus_one(r) < CLUSTER;
    let together = zeros.iter().filter(scattered).count().max(1);
    // A root of multiplicity m is known to the m-th root of the precision.
    let radius = (10.0 * f64::EPSILON.powf(1.0 / together as f64)).clamp(AT_INFINITY, CLUSTER);
    move |r| from_minus_one(r) <= radius
}

/// The product of some numbers, in conjugate pairs, over that of others; in turn, lest a product overflows that the
/// ratio would not.
pub(super) fn quotient(above: &[Complex64], below: &[Complex64]) -> f64 {
    let factor = |list: &[Complex64], i: usize| list.get(i).copied().unwrap_or(Complex64::ONE);
    let count = above.len().max(below.len());
    (0..count).fold(Complex64::ONE, |value, i| value * (factor(above, i) / factor(below, i))).re
}
