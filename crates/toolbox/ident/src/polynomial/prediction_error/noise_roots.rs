//! Noise polynomials whose intervals are too narrow.
//!
//! Short data take the roots of `C` and `D` to the unit circle, and to each other, more often than the covariance says:
//! beside the circle the errors are no parabola, they level out.

use std::ops::Range;

use faer::{Mat, MatRef};
use lti::{Complex64, polynomial};

use super::orders::Orders;
use crate::{Doubt, IdentError};

/// From so many samples for each coefficient of `C` and `D` on, intervals hold.
///
/// Chosen on 200 records each of 60 to 1000 samples of a box-jenkins and an armax model, whose 95 % intervals held in
/// 76, 85, 88, 92 and 95 % (box-jenkins, 60 to 1000 samples).
const SAMPLES_EACH: usize = 200;

/// A root counts as known from so many standard errors inside the unit circle on.
const INSIDE: f64 = 2.0;

/// Tells whether the intervals of the noise model of one equation, which rests on so many samples, are too narrow.
///
/// # Errors
/// Those of [`polynomial::roots`].
pub(super) fn is_uncertain(
    orders: &Orders,
    theta: &[f64],
    covariance: MatRef<'_, f64>,
    samples: usize,
) -> Result<bool, IdentError> {
    let is_short = samples < SAMPLES_EACH * (orders.nc + orders.nd);
    Ok(is_short || is_near(theta, covariance, orders.c())? || is_near(theta, covariance, orders.d())?)
}

/// Tells whether a root of a polynomial may well be on the unit circle.
fn is_near(theta: &[f64], covariance: MatRef<'_, f64>, place: Range<usize>) -> Result<bool, IdentError> {
    let (first, count) = (place.start, place.len());
    let own = covariance.submatrix(first, first, count, count);
    let whole: Vec<f64> = std::iter::once(1.0).chain(theta[place].iter().copied()).collect();
    let is_near = |root: Complex64| {
        let by = growth(&whole, root);
        let by = Mat::from_fn(count, 1, |j, _| by[j]);
        let variance = (by.transpose() * own * &by)[(0, 0)];
        1.0 - root.norm() < INSIDE * variance.max(0.0).sqrt()
    };
    Ok(polynomial::roots(&whole)?.into_iter().any(is_near))
}

/// By how much the magnitude of a root of `zⁿ + c₁ zⁿ⁻¹ + …` grows with each coefficient: `∂z/∂c_j = −zⁿ⁻ʲ / P′(z)`.
fn growth(whole: &[f64], root: Complex64) -> Vec<f64> {
    let n = whole.len() - 1;
    let power = |k: usize| root.powu(k as u32);
    let slope: Complex64 = (0..n).map(|k| power(n - k - 1) * (whole[k] * (n - k) as f64)).sum();
    let direction = root.conj() / root.norm();
    (1..=n).map(|j| -(direction * power(n - j) / slope).re).collect()
}

/// The coefficients of a polynomial that ended at the unit circle, and of the one that cancels its root: the covariance
/// of a minimum says nothing of them.
pub(super) fn at_edge(orders: &Orders, doubt: &Doubt) -> Vec<usize> {
    let Doubt::RootAtEdge { output, polynomial: 'C', cancelled_by, .. } = doubt else { return Vec::new() };
    let cancelling = if *cancelled_by == Some('D') { orders.d() } else { 0..0 };
    orders.c().chain(cancelling).map(|own| output * orders.count() + own).collect()
}
