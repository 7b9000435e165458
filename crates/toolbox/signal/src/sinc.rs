//! Band-limited interpolation of a sequence by a Kaiser-windowed sinc.

use std::f64::consts::PI;
use std::sync::LazyLock;

use crate::window::kaiser;

/// Samples used on each side of the instant.
pub(crate) const HALF_WIDTH: usize = 32;
/// Samples used in all.
const WIDTH: usize = 2 * HALF_WIDTH;
/// Kaiser shape parameter: about −100 dB of ripple up to 0.4 of the sample rate at this half width.
const BETA: f64 = 10.0;
/// Coefficients of the polynomials that stand for the window: their error is below the rounding.
const COEFFICIENTS: usize = 10;

/// The window over one sample time about each sample: `WINDOW[n][j]` is the coefficient of `(f − ½)ⁿ` at sample `j`.
static WINDOW: LazyLock<[[f64; WIDTH]; COEFFICIENTS]> = LazyLock::new(window);

/// `x` at the fractional index `position`, read through `at`, weights normalised to a gain of one at rest.
pub(crate) fn interpolate(at: impl Fn(i64) -> f64, position: f64) -> f64 {
    let nearest = position.round();
    if position == nearest {
        return at(nearest as i64);
    }
    let below = position.floor();
    let first = below as i64 + 1 - HALF_WIDTH as i64;
    weighted(std::array::from_fn(|j| at(first + j as i64)), position - below)
}

/// The same of a slice, which is read through `beyond` only where the instant is near an end.
pub(crate) fn interpolate_slice(x: &[f64], beyond: impl Fn(i64) -> f64, position: f64) -> f64 {
    let below = position.floor();
    let near = (below as usize + 1).checked_sub(HALF_WIDTH).and_then(|first| x.get(first..)?.first_chunk());
    match near {
        Some(near) if position > below => weighted(*near, position - below),
        _ => interpolate(beyond, position),
    }
}

/// The samples' value a `fraction` of a sample after that in the middle, 0 < `fraction` < 1.
fn weighted(samples: [f64; WIDTH], fraction: f64) -> f64 {
    let mut window = WINDOW[COEFFICIENTS - 1];
    for coefficients in WINDOW[..COEFFICIENTS - 1].iter().rev() {
        for (value, coefficient) in window.iter_mut().zip(coefficients) {
            *value = *value * (fraction - 0.5) + coefficient;
        }
    }
    // sin(π(f − k)) = (−1)^k sin(πf), and the factor sin(πf)/π that all weights have in common cancels.
    let (mut sums, mut totals) = ([0.0; 2], [0.0; 2]);
    for j in 0..WIDTH {
        let weight = window[j] / (fraction + (HALF_WIDTH as f64 - 1.0) - j as f64);
        totals[j % 2] += weight;
        sums[j % 2] += weight * samples[j];
    }
    (sums[0] - sums[1]) / (totals[0] - totals[1])
}

/// The window's polynomials, through its values at Chebyshev's points.
fn window() -> [[f64; WIDTH]; COEFFICIENTS] {
    let points: [f64; COEFFICIENTS] =
        std::array::from_fn(|i| 0.5 * (PI * (i as f64 + 0.5) / COEFFICIENTS as f64).cos());
    let mut table = [[0.0; WIDTH]; COEFFICIENTS];
    for j in 0..WIDTH {
        let distance = |u: f64| u + HALF_WIDTH as f64 - 0.5 - j as f64;
        let values = points.map(|u| kaiser(distance(u) / HALF_WIDTH as f64, BETA));
        for (row, coefficient) in table.iter_mut().zip(through(&points, values)) {
            row[j] = coefficient;
        }
    }
    table
}

/// Coefficients of the polynomial through these points, by Newton's divided differences.
fn through(points: &[f64; COEFFICIENTS], mut differences: [f64; COEFFICIENTS]) -> [f64; COEFFICIENTS] {
    for order in 1..COEFFICIENTS {
        for i in (order..COEFFICIENTS).rev() {
            differences[i] = (differences[i] - differences[i - 1]) / (points[i] - points[i - order]);
        }
    }
    let mut coefficients = [0.0; COEFFICIENTS];
    for i in (0..COEFFICIENTS).rev() {
        // p ← p (u − u_i) + d_i
        for n in (1..COEFFICIENTS).rev() {
            coefficients[n] = coefficients[n - 1] - points[i] * coefficients[n];
        }
        coefficients[0] = differences[i] - points[i] * coefficients[0];
    }
    coefficients
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_polynomials_are_the_window() {
        let mut furthest = 0.0f64;
        for fraction in (1..1000).map(|i| f64::from(i) / 1000.0) {
            for j in 0..WIDTH {
                let polynomial = (0..COEFFICIENTS).rev().fold(0.0, |sum, n| sum * (fraction - 0.5) + WINDOW[n][j]);
                let distance = fraction + (HALF_WIDTH as f64 - 1.0) - j as f64;
                furthest = furthest.max((polynomial - kaiser(distance / HALF_WIDTH as f64, BETA)).abs());
            }
        }
        assert!(furthest < 1e-14, "{furthest}");
    }

    #[test]
    fn exact_weights_are_those_of_the_windowed_sinc() {
        let at = |k: i64| (0.3 * k as f64).sin() + 0.1 * (k * k % 7) as f64;
        let x: Vec<f64> = (0..200).map(at).collect();
        for position in [40.001, 70.25, 99.5, 120.999, 133.333] {
            let (mut sum, mut total) = (0.0, 0.0);
            for k in position as i64 - 31..=position as i64 + 32 {
                let distance = position - k as f64;
                let weight = (PI * distance).sin() / distance * kaiser(distance / HALF_WIDTH as f64, BETA);
                total += weight;
                sum += weight * at(k);
            }
            let [one, other] = [interpolate(at, position), interpolate_slice(&x, at, position)];
            assert!((one - sum / total).abs() < 1e-13 && one == other, "{position}: {one} {other} {}", sum / total);
        }
    }
}
