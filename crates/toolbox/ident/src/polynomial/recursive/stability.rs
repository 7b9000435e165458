//! Stability of a polynomial without its roots.

/// Returns true if `1 + p₁ q⁻¹ + … + p_n q⁻ⁿ` has all its zeros inside the unit circle, by the step-down recursion of
/// its reflection coefficients.
///
/// # Source
/// Söderström & Stoica, *System Identification*, 1989, complement C8.1 (Schur–Cohn).
pub(super) fn is_stable(coefficients: &[f64]) -> bool {
    let mut p = coefficients.to_vec();
    while let Some(reflection) = p.pop() {
        if reflection.is_nan() || reflection.abs() >= 1.0 {
            return false;
        }
        let scale = 1.0 / (1.0 - reflection * reflection);
        let reversed: Vec<f64> = p.iter().rev().copied().collect();
        p.iter_mut().zip(reversed).for_each(|(a, b)| *a = (*a - reflection * b) * scale);
    }
    true
}

#[cfg(test)]
mod tests {
    use super::is_stable;

    #[test]
    fn exact_stable_polynomials_are_told_from_others() {
        assert!(is_stable(&[]) && is_stable(&[-0.999]) && !is_stable(&[-1.0]) && !is_stable(&[f64::NAN]));
        // Roots 0.9 e^{±j}, and 1.01 e^{±j}.
        for (radius, stable) in [(0.9_f64, true), (1.01, false)] {
            assert_eq!(is_stable(&[-2.0 * radius * 1.0_f64.cos(), radius * radius]), stable);
        }
        // (1 − 0.5 q⁻¹)(1 + 1.2 q⁻¹).
        assert!(!is_stable(&[0.7, -0.6]) && is_stable(&[0.3, -0.4]));
    }
}
