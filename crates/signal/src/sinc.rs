//! Band-limited interpolation of a sequence by a Kaiser-windowed sinc.

use std::f64::consts::PI;

use crate::window::kaiser;

/// Samples used on each side of the instant.
pub(crate) const HALF_WIDTH: usize = 32;
/// Kaiser shape parameter: about −100 dB of ripple up to 0.4 of the sample rate at this half width.
const BETA: f64 = 10.0;

/// `x` at the fractional index `position`, read through `at`, weights normalised to a gain of one at rest.
pub(crate) fn interpolate(at: impl Fn(i64) -> f64, position: f64) -> f64 {
    let nearest = position.round();
    if position == nearest {
        return at(nearest as i64);
    }
    let below = position.floor();
    let fraction = position - below;
    let sine = (PI * fraction).sin() / PI;
    let (mut sum, mut total) = (0.0, 0.0);
    for k in -(HALF_WIDTH as i64) + 1..=HALF_WIDTH as i64 {
        let distance = fraction - k as f64;
        // sin(π(f − k)) = (−1)^k sin(πf)
        let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
        let weight = sign * sine / distance * kaiser(distance / HALF_WIDTH as f64, BETA);
        total += weight;
        sum += weight * at(below as i64 + k);
    }
    sum / total
}
