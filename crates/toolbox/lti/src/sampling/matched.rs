//! Poles and zeros by `z = e^{sT}`.

use super::roots::{at_infinity, logarithm, quotient};
use crate::Complex64;
use crate::error::LtiError;
use crate::zero_pole_gain::ZeroPoleGain;

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
    let at_infinity = at_infinity(system.zeros());
    let zeros = system.zeros().iter().filter(|r| !at_infinity(r)).map(|r| logarithm(*r, sample_time_s));
    let zeros = zeros.collect::<Result<Vec<Complex64>, LtiError>>()?;
    let poles = system.poles().iter().map(|r| logarithm(*r, sample_time_s));
    let poles = poles.collect::<Result<Vec<Complex64>, LtiError>>()?;
    let low = low_frequency(&zeros, &poles, Complex64::ZERO);
    let unit = low_frequency(system.zeros(), system.poles(), Complex64::ONE);
    let gain = system.gain() * unit / low * sample_time_s.powi(-at_rest(system, Complex64::ONE));
    ZeroPoleGain::continuous(zeros, poles, gain)
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
    quotient(&differences(zeros), &differences(poles))
}
