//! Band-limited interpolation of a sequence by a Kaiser-windowed sinc.

use std::f64::consts::PI;

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
        let weight = sign * sine / distance * kaiser(distance / HALF_WIDTH as f64);
        total += weight;
        sum += weight * at(below as i64 + k);
    }
    sum / total
}

/// The Kaiser window at `u` in −1 ..= 1, zero outside, one at its centre.
pub(crate) fn kaiser(u: f64) -> f64 {
    let inside = 1.0 - u * u;
    if inside < 0.0 {
        0.0
    } else {
        bessel_i0(BETA * inside.sqrt()) / bessel_i0(BETA)
    }
}

/// Modified Bessel function of the first kind, order zero, by its power series.
fn bessel_i0(x: f64) -> f64 {
    let quarter = x * x / 4.0;
    let (mut term, mut sum, mut k) = (1.0, 1.0, 1.0);
    while term > sum * 1e-17 {
        term *= quarter / (k * k);
        sum += term;
        k += 1.0;
    }
    sum
}
