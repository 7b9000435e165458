//! Quadratic forms with the inverse of a Toeplitz covariance.

use faer::Mat;

use super::JointTest;
use crate::IdentError;
use crate::gram::dot;
use crate::uncertainty::root::inverse_root;

/// Directions with less than this part of the largest variance count as not moving.
pub(super) const STILL: f64 = 1e-8;

/// So many sums are taken apart into directions in good time.
const SEPARABLE: usize = 500;

/// The test of `sᵀ P⁻¹ s` for the Toeplitz matrix P of these covariances, over the directions in which s moves at all.
///
/// Where some do not and the sums are many, δ is added to the variance λ of each direction, 1e-8 of the largest there can
/// be: a direction then counts as `λ/(λ + δ)` of a degree of freedom, which is what it adds to the form on average.
pub(super) fn quadratic_form(sums: &[f64], covariances: &[f64]) -> Result<JointTest, IdentError> {
    let m = sums.len();
    let largest = covariances[0] + 2.0 * covariances.iter().take(m).skip(1).map(|v| v.abs()).sum::<f64>();
    let least = STILL * largest;
    let test = |form: &Form, floor: f64| JointTest::chi_squared(form.value, m as f64 - floor * form.trace);
    match by_recursion(sums, covariances, 0.0) {
        Some(form) if form.trace * least < 1.0 => return Ok(test(&form, 0.0)),
        _ => {}
    }
    if m > SEPARABLE
        && let Some(form) = by_recursion(sums, covariances, least)
    {
        return Ok(test(&form, least));
    }
    let (statistic, directions) = by_directions(sums, covariances)?;
    Ok(JointTest::chi_squared(statistic, directions as f64))
}

/// `sᵀ Q⁻¹ s`, and the trace of `Q⁻¹`, which bounds the reciprocal of the smallest eigenvalue.
struct Form {
    value: f64,
    trace: f64,
}

/// The form with `Q = P + floor·I`: each sum is predicted from those before it, and the errors are taken in units of
/// their variances v. The trace of `Q⁻¹` is `Σ (1 + φᵀφ)/v` for the predictors φ. `None` where Q is not positive.
///
/// # Source
/// Brockwell & Davis, *Time Series: Theory and Methods*, 2nd ed., 1991, proposition 5.2.1 (Durbin and Levinson).
fn by_recursion(sums: &[f64], covariances: &[f64], floor: f64) -> Option<Form> {
    let m = sums.len();
    let (mut variance, mut form) = (covariances[0] + floor, Form { value: 0.0, trace: 0.0 });
    // The oldest sum's coefficient first.
    let (mut predictor, mut longer) = (Vec::with_capacity(m), Vec::with_capacity(m));
    for k in 0..m {
        if k > 0 {
            let reflection = (covariances[k] - dot(&predictor, &covariances[1..k])) / variance;
            longer.clear();
            longer.push(reflection);
            longer.extend(predictor.iter().zip(predictor.iter().rev()).map(|(x, y)| x - reflection * y));
            std::mem::swap(&mut predictor, &mut longer);
            variance *= 1.0 - reflection * reflection;
        }
        if variance.is_nan() || variance <= 0.0 {
            return None;
        }
        form.trace += (1.0 + dot(&predictor, &predictor)) / variance;
        form.value += (sums[k] - dot(&predictor, &sums[..k])).powi(2) / variance;
    }
    (form.value.is_finite() && form.trace.is_finite()).then_some(form)
}

/// The form over the directions that move, and their number.
fn by_directions(sums: &[f64], covariances: &[f64]) -> Result<(f64, usize), IdentError> {
    let m = sums.len();
    let root = inverse_root(&Mat::from_fn(m, m, |i, j| covariances[i.abs_diff(j)]), STILL)?;
    let along = |k: usize| (0..m).map(|i| root[(i, k)] * sums[i]).sum::<f64>();
    Ok(((0..root.ncols()).map(|k| along(k).powi(2)).sum(), root.ncols()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn prop_recursion_and_directions_agree() {
        let mut random = signal::excitation::Random::new(3);
        for pole in [0.0, 0.6, -0.8, 0.95] {
            for m in [1, 2, 40, 150] {
                let covariances: Vec<f64> = (0..m).map(|l| 7.0 * f64::powi(pole, l)).collect();
                let sums: Vec<f64> = (0..m).map(|_| random.normal()).collect();
                let fast = by_recursion(&sums, &covariances, 0.0).unwrap().value;
                let (slow, directions) = by_directions(&sums, &covariances).unwrap();
                assert_eq!(directions, m as usize);
                assert!((fast / slow - 1.0).abs() < 1e-10, "{pole} {m}: {fast} {slow}");
            }
        }
    }

    /// Two lines: four directions whatever the number of lags.
    #[test]
    fn prop_directions_that_stand_still_are_left_out() {
        for m in [60, 800] {
            let line = |t: i32, phase: f64| (0.5 * f64::from(t) + phase).cos() + (1.3 * f64::from(t)).cos();
            let covariances: Vec<f64> = (0..m).map(|l| line(l, 0.0)).collect();
            let sums: Vec<f64> = (0..m).map(|t| line(t, 0.2)).collect();
            let (statistic, directions) = by_directions(&sums, &covariances).unwrap();
            let test = quadratic_form(&sums, &covariances).unwrap();
            assert_eq!(directions, 4);
            assert!((test.degrees_of_freedom - 4.0).abs() < 1e-3, "{test:?}");
            assert!((test.statistic / statistic - 1.0).abs() < 1e-3, "{test:?} {statistic}");
        }
    }
}
