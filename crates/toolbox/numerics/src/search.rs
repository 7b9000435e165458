//! Extrema and roots of functions of one variable.

use std::convert::Infallible;

/// Part of an interval that a step of a golden section leaves.
const GOLDEN_RATIO: f64 = 0.618_033_988_749_894_9;
/// Part of its step to which a search for the highest of several maxima goes: rounding hides what is finer.
const FINE: f64 = 8e-9;
/// Halvings of an interval after which a double has no digits left.
const HALVINGS: usize = 60;

/// Where a function with one minimum between two points is smallest, to within `width`.
///
/// # Errors
/// The first error of the function.
///
/// # Example
/// ```
/// let parabola = |x: f64| Ok::<_, String>((x - 2.0).powi(2));
/// let found = numerics::search::try_minimum((0.0, 5.0), 1e-6, parabola)?;
/// assert!((found - 2.0).abs() < 1e-6);
/// # Ok::<(), String>(())
/// ```
///
/// # Source
/// Kiefer, *Sequential minimax search for a maximum*, Proc. Amer. Math. Soc. 4 (1953) 502.
pub fn try_minimum<E>(
    (mut low, mut high): (f64, f64),
    width: f64,
    mut function: impl FnMut(f64) -> Result<f64, E>,
) -> Result<f64, E> {
    let left = |low: f64, high: f64| high - GOLDEN_RATIO * (high - low);
    let right = |low: f64, high: f64| low + GOLDEN_RATIO * (high - low);
    let (mut a, mut b) = (left(low, high), right(low, high));
    let (mut at_a, mut at_b) = (function(a)?, function(b)?);
    while high - low > width {
        work::checkpoint();
        if at_a > at_b {
            low = a;
            (a, at_a) = (b, at_b);
            b = right(low, high);
            at_b = function(b)?;
        } else {
            high = b;
            (b, at_b) = (a, at_a);
            a = left(low, high);
            at_a = function(a)?;
        }
    }
    Ok(0.5 * (low + high))
}

/// Where a function with one minimum between two points is smallest, to within `width`.
#[must_use]
pub fn minimum(bounds: (f64, f64), width: f64, mut function: impl FnMut(f64) -> f64) -> f64 {
    let Ok(found) = try_minimum(bounds, width, |x| Ok::<_, Infallible>(function(x)));
    found
}

/// Where a function with one maximum between two points is largest, to within `width`.
///
/// # Example
/// ```
/// let found = numerics::search::maximum((0.0, 3.0), 1e-6, f64::sin);
/// assert!((found - std::f64::consts::FRAC_PI_2).abs() < 1e-6);
/// ```
#[must_use]
pub fn maximum(bounds: (f64, f64), width: f64, mut function: impl FnMut(f64) -> f64) -> f64 {
    minimum(bounds, width, |x| -function(x))
}

/// Where a function with several maxima is largest: the best of `steps` equal steps between the bounds, then a golden
/// section between the neighbours of that step.
#[must_use]
pub fn global_maximum((low, high): (f64, f64), steps: usize, function: impl Fn(f64) -> f64) -> f64 {
    let spacing = (high - low) / steps as f64;
    let points = work::checked(0..=steps).map(|k| low + k as f64 * spacing).map(|x| (x, function(x)));
    let (best, _) = points.max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((low, 0.0));
    maximum(((best - spacing).max(low), (best + spacing).min(high)), FINE * spacing, function)
}

/// Where a condition that holds at the lower bound and not at the upper one ends, by bisection: the last point found
/// where it holds, and the first where it does not.
///
/// # Errors
/// The first error of the condition.
pub fn try_bisect<E>(
    (mut low, mut high): (f64, f64),
    mut holds: impl FnMut(f64) -> Result<bool, E>,
) -> Result<(f64, f64), E> {
    for _ in 0..HALVINGS {
        work::checkpoint();
        let middle = 0.5 * (low + high);
        if holds(middle)? {
            low = middle;
        } else {
            high = middle;
        }
    }
    Ok((low, high))
}

/// Where a condition that holds at the lower bound and not at the upper one ends, by bisection: the last point found
/// where it holds, and the first where it does not.
///
/// # Example
/// ```
/// let (below, above) = numerics::search::bisect((0.0, 2.0), |x| x * x < 2.0);
/// assert!(below <= above && (above - 2.0_f64.sqrt()).abs() < 1e-15);
/// ```
#[must_use]
pub fn bisect(bounds: (f64, f64), mut holds: impl FnMut(f64) -> bool) -> (f64, f64) {
    let Ok(found) = try_bisect(bounds, |x| Ok::<_, Infallible>(holds(x)));
    found
}

#[cfg(test)]
mod tests {
    use super::{global_maximum, maximum, try_minimum};

    #[test]
    fn exact_extrema_of_one_peak() {
        let found = maximum((-1.0, 4.0), 1e-9, |x| -(x - 1.25).powi(2));
        assert!((found - 1.25).abs() < 1e-7, "{found}");
        assert!((maximum((0.0, 1.0), 1e-9, |x| x) - 1.0).abs() < 1e-8);
    }

    #[test]
    fn exact_the_highest_of_several_peaks() {
        let two = |x: f64| (-(x - 1.0).powi(2) / 0.02).exp() + 2.0 * (-(x - 7.3).powi(2) / 0.02).exp();
        let found = global_maximum((0.0, 10.0), 50, two);
        assert!((found - 7.3).abs() < 1e-6, "{found}");
    }

    #[test]
    fn regress_an_error_ends_the_search() {
        let mut calls = 0;
        let outcome = try_minimum((0.0, 1.0), 1e-9, |_| {
            calls += 1;
            if calls < 5 { Ok(0.0) } else { Err("no model") }
        });
        assert_eq!((outcome, calls), (Err("no model"), 5));
    }
}
