//! Polynomials with real coefficients in descending powers.

use faer::Mat;

use crate::Complex64;
use crate::error::{LtiError, check_finite};
use crate::matrix::eigenvalues;

/// The value at a complex point, by Horner's rule; zero for no coefficients.
#[must_use]
pub fn evaluate(coefficients: &[f64], at: Complex64) -> Complex64 {
    coefficients.iter().fold(Complex64::ZERO, |value, c| value * at + c)
}

/// The product of two polynomials; empty where either is.
#[must_use]
pub fn multiply(p: &[f64], q: &[f64]) -> Vec<f64> {
    if p.is_empty() || q.is_empty() {
        return Vec::new();
    }
    let mut product = vec![0.0; p.len() + q.len() - 1];
    for (i, a) in p.iter().enumerate() {
        for (j, b) in q.iter().enumerate() {
            product[i + j] += a * b;
        }
    }
    product
}

/// The sum of two polynomials, constant terms aligned.
#[must_use]
pub fn add(p: &[f64], q: &[f64]) -> Vec<f64> {
    let (long, short) = if p.len() >= q.len() { (p, q) } else { (q, p) };
    let mut sum = long.to_vec();
    let offset = long.len() - short.len();
    for (slot, v) in sum[offset..].iter_mut().zip(short) {
        *slot += v;
    }
    sum
}

/// The roots, as eigenvalues of the balanced companion matrix; leading zeros are ignored, trailing ones are roots at
/// zero.
///
/// # Errors
/// [`LtiError::NonFinite`], [`LtiError::ZeroPolynomial`], [`LtiError::NoConvergence`].
///
/// # Example
/// ```
/// let mut roots = lti::polynomial::roots(&[1.0, 3.0, 2.0])?;
/// roots.sort_by(|a, b| a.re.total_cmp(&b.re));
/// assert!((roots[0].re + 2.0).abs() < 1e-12 && (roots[1].re + 1.0).abs() < 1e-12);
/// # Ok::<(), lti::LtiError>(())
/// ```
pub fn roots(coefficients: &[f64]) -> Result<Vec<Complex64>, LtiError> {
    check_finite("polynomial", coefficients.iter().copied())?;
    let p = without_leading_zeros(coefficients);
    let Some(last) = p.iter().rposition(|c| *c != 0.0) else {
        return Err(LtiError::ZeroPolynomial { what: "polynomial" });
    };
    let companion = Mat::from_fn(last, last, |i, j| match i {
        0 => -p[j + 1] / p[0],
        _ => f64::from(u8::from(i == j + 1)),
    });
    let mut roots = eigenvalues(companion.as_ref())?;
    roots.resize(p.len() - 1, Complex64::ZERO);
    Ok(roots)
}

/// The monic polynomial with these roots; imaginary parts left by roots that are not in conjugate pairs are dropped.
#[must_use]
pub fn from_roots(roots: &[Complex64]) -> Vec<f64> {
    let mut p = vec![Complex64::ONE];
    for root in roots {
        p.push(Complex64::ZERO);
        for i in (1..p.len()).rev() {
            let before = p[i - 1];
            p[i] -= before * root;
        }
    }
    p.iter().map(|c| c.re).collect()
}

pub(crate) fn without_leading_zeros(p: &[f64]) -> &[f64] {
    let first = p.iter().position(|c| *c != 0.0).unwrap_or(p.len());
    &p[first..]
}
