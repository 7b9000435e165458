//! The bilinear map.

use faer::Scale;

use super::roots::{at_infinity, quotient};
use crate::Complex64;
use crate::error::LtiError;
use crate::matrix::{difference, identity, inverse};
use crate::polynomial::{add, multiply};
use crate::state_space::StateSpace;
use crate::transfer_function::TransferFunction;
use crate::zero_pole_gain::ZeroPoleGain;

/// `τ` of `s = (2/τ)(z − 1)/(z + 1)`: the sample time, or what makes the map right at a frequency.
pub(super) fn step(sample_time_s: f64, prewarp_rad_s: Option<f64>) -> Result<f64, LtiError> {
    let Some(omega_rad_s) = prewarp_rad_s else { return Ok(sample_time_s) };
    let angle = 0.5 * omega_rad_s * sample_time_s;
    if !(angle > 0.0 && angle < std::f64::consts::FRAC_PI_2) {
        return Err(LtiError::Frequency { omega_rad_s });
    }
    Ok(2.0 * angle.tan() / omega_rad_s)
}

/// With `M = (I − τA/2)⁻¹`: `M (I + τA/2)`, `τ M B`, `C M`, `D + ½ C (τ M B)`.
pub(super) fn discrete(system: &StateSpace, tau: f64, sample_time_s: f64) -> Result<StateSpace, LtiError> {
    let half = system.a() * Scale(0.5 * tau);
    let one = identity(system.states());
    let m = inverse((&one - &half).as_ref()).ok_or(LtiError::Singular { what: "I − τA/2 (a pole at 2/τ)" })?;
    let b = &m * system.b() * Scale(tau);
    let d = system.d() + system.c() * &b * Scale(0.5);
    StateSpace::discrete(&m * (&one + &half), b, system.c() * &m, d, sample_time_s)
}

/// Inverse of [`discrete`].
pub(super) fn continuous(system: &StateSpace, tau: f64) -> Result<StateSpace, LtiError> {
    let one = identity(system.states());
    let sum = &one + system.a();
    let inverse = inverse(sum.as_ref()).ok_or(LtiError::Singular { what: "I + A (a pole at −1)" })?;
    let a = &inverse * (system.a() - &one) * Scale(2.0 / tau);
    let b = &inverse * system.b() * Scale(2.0 / tau);
    let c = system.c() * &inverse * Scale(2.0);
    let d = difference(system.d(), (&c * system.b() * Scale(0.5)).as_ref());
    StateSpace::continuous(a, b, c, d)
}

/// Every root `r` at `(2/τ + r)/(2/τ − r)`, zeros at infinity at −1; the delay is not looked at.
///
/// `s − r = (2/τ − r)(z − ρ)/(z + 1)`, a zero at `2/τ` leaving `−(4/τ)/(z + 1)`.
pub(super) fn discrete_roots(system: &ZeroPoleGain, tau: f64, sample_time_s: f64) -> Result<ZeroPoleGain, LtiError> {
    check_proper(system)?;
    let rate = 2.0 / tau;
    if system.poles().iter().any(|p| *p == Complex64::from(rate)) {
        return Err(LtiError::Singular { what: "I − τA/2 (a pole at 2/τ)" });
    }
    let on_rate = |r: &Complex64| *r == Complex64::from(rate);
    let map = |r: &Complex64| (rate + r) / (rate - r);
    let missing = system.poles().len() - system.zeros().len();
    let moved = system.zeros().iter().filter(|r| !on_rate(r)).map(map);
    let zeros = moved.chain(std::iter::repeat_n(Complex64::from(-1.0), missing)).collect();
    let of_zero = |r: &Complex64| if on_rate(r) { Complex64::from(-2.0 * rate) } else { rate - r };
    let above: Vec<Complex64> = system.zeros().iter().map(of_zero).collect();
    let below: Vec<Complex64> = system.poles().iter().map(|p| rate - p).collect();
    let gain = system.gain() * quotient(&above, &below);
    ZeroPoleGain::discrete(zeros, system.poles().iter().map(map).collect(), gain, sample_time_s)
}

/// Inverse of [`discrete_roots`].
///
/// `z − ρ = (1 + ρ)(s − r)/(2/τ − s)` with `r = (2/τ)(ρ − 1)/(ρ + 1)`, a zero at −1 leaving `(4/τ)/(2/τ − s)`.
pub(super) fn continuous_roots(system: &ZeroPoleGain, tau: f64) -> Result<ZeroPoleGain, LtiError> {
    check_proper(system)?;
    let rate = 2.0 / tau;
    if system.poles().iter().any(|p| *p == Complex64::from(-1.0)) {
        return Err(LtiError::Singular { what: "I + A (a pole at −1)" });
    }
    let map = |r: &Complex64| rate * (r - 1.0) / (r + 1.0);
    let at_infinity = at_infinity(system.zeros());
    let missing = system.poles().len() - system.zeros().len();
    let moved = system.zeros().iter().filter(|r| !at_infinity(r)).map(map);
    let zeros = moved.chain(std::iter::repeat_n(Complex64::from(rate), missing)).collect();
    // A zero near −1 that counts as one on it keeps its part of the gain at rest.
    let of_zero = |r: &Complex64| if at_infinity(r) { rate * (1.0 - r) } else { 1.0 + r };
    let above: Vec<Complex64> = system.zeros().iter().map(of_zero).collect();
    let below: Vec<Complex64> = system.poles().iter().map(|p| 1.0 + p).collect();
    let sign = if missing.is_multiple_of(2) { 1.0 } else { -1.0 };
    let gain = sign * system.gain() * quotient(&above, &below);
    ZeroPoleGain::continuous(zeros, system.poles().iter().map(map).collect(), gain)
}

fn check_proper(system: &ZeroPoleGain) -> Result<(), LtiError> {
    let (numerator, denominator) = (system.zeros().len(), system.poles().len());
    if numerator > denominator { Err(LtiError::Improper { numerator, denominator }) } else { Ok(()) }
}

/// Both polynomials with `s = (2/τ)(z − 1)/(z + 1)`, times `(z + 1)^n`; the delay is not looked at.
pub(super) fn discrete_ratio(
    system: &TransferFunction,
    tau: f64,
    sample_time_s: f64,
) -> Result<TransferFunction, LtiError> {
    let degree = system.num().len().max(system.den().len()) - 1;
    let map = |p: &[f64]| substituted(p, degree, &[2.0 / tau, -2.0 / tau], &[1.0, 1.0]);
    let (num, den) = monic(map(system.num()), map(system.den()));
    TransferFunction::discrete(num, den, sample_time_s)
}

/// Both polynomials with `z = (1 + sτ/2)/(1 − sτ/2)`, times `(1 − sτ/2)^n`; the delay is not looked at.
pub(super) fn continuous_ratio(system: &TransferFunction, tau: f64) -> Result<TransferFunction, LtiError> {
    let degree = system.num().len().max(system.den().len()) - 1;
    let map = |p: &[f64]| substituted(p, degree, &[0.5 * tau, 1.0], &[-0.5 * tau, 1.0]);
    let den = map(system.den());
    if den[0] == 0.0 {
        return Err(LtiError::Singular { what: "I + A (a pole at −1)" });
    }
    let (num, den) = monic(map(system.num()), den);
    TransferFunction::continuous(num, den)
}

/// A ratio with a leading one in its denominator; as it is where that starts with zero.
fn monic(num: Vec<f64>, den: Vec<f64>) -> (Vec<f64>, Vec<f64>) {
    let lead = if den[0] == 0.0 { 1.0 } else { den[0] };
    let scaled = |p: Vec<f64>| p.into_iter().map(|c| c / lead).collect();
    (scaled(num), scaled(den))
}

/// `Σ cₖ above^k below^(degree − k)`, by Horner's rule; leading coefficients that are nothing but rounding become zero.
fn substituted(p: &[f64], degree: usize, above: &[f64], below: &[f64]) -> Vec<f64> {
    let absolute = |p: &[f64]| p.iter().map(|c| c.abs()).collect::<Vec<f64>>();
    let mut sum = horner(p, degree, above, below);
    let size = horner(&absolute(p), degree, &absolute(above), &absolute(below));
    let rounding = 8.0 * f64::EPSILON * (degree + 1) as f64;
    for (c, size) in sum.iter_mut().zip(size) {
        if c.abs() > rounding * size {
            break;
        }
        *c = 0.0;
    }
    sum
}

fn horner(p: &[f64], degree: usize, above: &[f64], below: &[f64]) -> Vec<f64> {
    let mut power = vec![1.0];
    for _ in p.len()..=degree {
        power = multiply(&power, below);
    }
    let mut sum = Vec::new();
    for c in p {
        let term: Vec<f64> = power.iter().map(|v| v * c).collect();
        sum = add(&multiply(&sum, above), &term);
        power = multiply(&power, below);
    }
    sum
}
