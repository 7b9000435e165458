//! Poles and zeros by `z = e^{sT}`.

use crate::Complex64;
use crate::error::LtiError;
use crate::zero_pole_gain::ZeroPoleGain;

/// A zero this near to −1 comes from infinity, if it is the only one.
const AT_INFINITY: f64 = 1e-6;
/// Zeros about −1 that rounding may have driven apart.
const CLUSTER: f64 = 0.1;

/// The discrete system; the delay is not looked at.
pub(super) fn discrete(system: &ZeroPoleGain, sample_time_s: f64) -> Result<ZeroPoleGain, LtiError> {
    let map = |roots: &[Complex64]| roots.iter().map(|r| (r * sample_time_s).exp()).collect::<Vec<Complex64>>();
    let (mut zeros, poles) = (map(system.zeros()), map(system.poles()));
    let missing = poles.len().saturating_sub(zeros.len() + 1);
    zeros.extend(std::iter::repeat_n(Complex64::from(-1.0), missing));
    let low = low_frequency(system.zeros(), system.poles(), Complex64::ZERO);
    let unit = low_frequency(&zeros, &poles, Complex64::ONE);
    // Every root at rest stands for s on one side and (z − 1)/T on the other.
    let gain = system.gain() * low / unit * sample_time_s.powi(at_rest(system, Complex64::ZERO));
    ZeroPoleGain::discrete(zeros, poles, gain, sample_time_s)
}

/// The continuous system; the delay is not looked at.
pub(super) fn continuous(system: &ZeroPoleGain, sample_time_s: f64) -> Result<ZeroPoleGain, LtiError> {
    let from_minus_one = |r: &Complex64| (r + 1.0).norm();
    let together = system.zeros().iter().filter(|r| from_minus_one(r) < CLUSTER).count().max(1);
    // A root of multiplicity m is known to the m-th root of the precision.
    let radius = (10.0 * f64::EPSILON.powf(1.0 / together as f64)).clamp(AT_INFINITY, CLUSTER);
    let finite = |r: &&Complex64| from_minus_one(r) > radius;
    let zeros = system.zeros().iter().filter(finite).map(|r| logarithm(*r, sample_time_s));
    let zeros = zeros.collect::<Result<Vec<Complex64>, LtiError>>()?;
    let poles = system.poles().iter().map(|r| logarithm(*r, sample_time_s));
    let poles = poles.collect::<Result<Vec<Complex64>, LtiError>>()?;
    let low = low_frequency(&zeros, &poles, Complex64::ZERO);
    let unit = low_frequency(system.zeros(), system.poles(), Complex64::ONE);
    let gain = system.gain() * unit / low * sample_time_s.powi(-at_rest(system, Complex64::ONE));
    ZeroPoleGain::continuous(zeros, poles, gain)
}

fn logarithm(root: Complex64, sample_time_s: f64) -> Result<Complex64, LtiError> {
    if root.im == 0.0 && root.re <= 0.0 {
        return Err(LtiError::NoLogarithm { re: root.re, im: root.im });
    }
    Ok(root.ln() / sample_time_s)
}

/// How many more poles than zeros lie on the point at rest.
fn at_rest(system: &ZeroPoleGain, rest: Complex64) -> i32 {
    let count = |roots: &[Complex64]| roots.iter().filter(|r| **r == rest).count() as i32;
    count(system.poles()) - count(system.zeros())
}

/// `Π(rest − zᵢ)/Π(rest − pᵢ)` over the roots that do not lie on the point itself.
fn low_frequency(zeros: &[Complex64], poles: &[Complex64], rest: Complex64) -> f64 {
    let differences =
        |roots: &[Complex64]| roots.iter().filter(|r| **r != rest).map(|r| rest - r).collect::<Vec<Complex64>>();
    let (above, below) = (differences(zeros), differences(poles));
    let factor = |list: &[Complex64], i: usize| list.get(i).copied().unwrap_or(Complex64::ONE);
    let count = above.len().max(below.len());
    (0..count).fold(Complex64::ONE, |value, i| value * (factor(&above, i) / factor(&below, i))).re
}
