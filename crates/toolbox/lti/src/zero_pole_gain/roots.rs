//! Roots in conjugate pairs.

use crate::Complex64;
use crate::error::{LtiError, check_finite};

/// How far a root may lie from its conjugate's mirror image, relative to its size.
const MIRROR: f64 = 1e-6;
/// Imaginary part, relative to the size, below which a root without a conjugate counts as real.
const REAL: f64 = 1e-12;

/// Real roots first, then pairs, each exactly conjugate, the one above the real axis first.
pub(super) fn paired(what: &'static str, roots: &[Complex64]) -> Result<Vec<Complex64>, LtiError> {
    check_finite(what, roots.iter().flat_map(|r| [r.re, r.im]))?;
    let is_real = |r: &&Complex64| r.im.abs() <= REAL * r.norm();
    let mut sorted: Vec<Complex64> = roots.iter().filter(is_real).map(|r| Complex64::from(r.re)).collect();
    let off_axis = || roots.iter().filter(|r| !is_real(r)).copied();
    let mut below: Vec<Complex64> = off_axis().filter(|r| r.im < 0.0).collect();
    for root in off_axis().filter(|r| r.im > 0.0) {
        let distance = |other: &Complex64| (other.conj() - root).norm();
        let nearest = (0..below.len())
            .min_by(|i, j| distance(&below[*i]).total_cmp(&distance(&below[*j])))
            .filter(|i| distance(&below[*i]) <= MIRROR * root.norm())
            .ok_or(LtiError::NotConjugate { what })?;
        let middle = 0.5 * (root + below.swap_remove(nearest).conj());
        sorted.extend([middle, middle.conj()]);
    }
    if below.is_empty() { Ok(sorted) } else { Err(LtiError::NotConjugate { what }) }
}

/// A root taken alone, or a pair by the one above the real axis.
pub(super) fn factors(paired: &[Complex64]) -> impl Iterator<Item = Complex64> + '_ {
    paired.iter().filter(|r| r.im >= 0.0).copied()
}

/// The roots that a factor stands for.
pub(super) fn members(factor: Complex64) -> impl Iterator<Item = Complex64> {
    let conjugate = (factor.im != 0.0).then(|| factor.conj());
    std::iter::once(factor).chain(conjugate)
}
