//! Quantiles and tails that intervals and tests are made of.

use statrs::distribution::{ChiSquared, ContinuousCDF, FisherSnedecor, Normal, StudentsT};

/// Above this many degrees of freedom Student's t is replaced by the Cornish–Fisher expansion about the normal.
const NEARLY_NORMAL: f64 = 1e4;

/// Quantile of the standard normal distribution at `probability` (0 < p < 1).
pub fn normal_quantile(probability: f64) -> f64 {
    Normal::standard().inverse_cdf(probability)
}

/// Quantile of Student's t with `degrees_of_freedom` at `probability`; NaN where no such distribution exists.
///
/// The library's inverse loses accuracy at many degrees of freedom although its distribution function is right, so the
/// quantile is found by Newton's method on the latter, and by the Cornish–Fisher expansion above 10⁴ degrees, where its
/// truncation error is below 1e-15.
///
/// # Source
/// Abramowitz & Stegun, 26.7.5.
pub fn student_t_quantile(probability: f64, degrees_of_freedom: f64) -> f64 {
    let z = normal_quantile(probability);
    if degrees_of_freedom > NEARLY_NORMAL {
        return expand_about_normal(z, degrees_of_freedom);
    }
    let Ok(distribution) = StudentsT::new(0.0, 1.0, degrees_of_freedom) else {
        return f64::NAN;
    };
    newton_on_cdf(&distribution, distribution.inverse_cdf(probability), probability)
}

fn newton_on_cdf(distribution: &StudentsT, start: f64, probability: f64) -> f64 {
    use statrs::distribution::Continuous;
    let mut t = start;
    for _ in 0..20 {
        let step = (distribution.cdf(t) - probability) / distribution.pdf(t);
        if !step.is_finite() {
            break;
        }
        t -= step;
        if step.abs() <= 1e-14 * t.abs() {
            break;
        }
    }
    t
}

fn expand_about_normal(z: f64, n: f64) -> f64 {
    let z2 = z * z;
    let first = z * (z2 + 1.0) / 4.0;
    let second = z * ((5.0 * z2 + 16.0) * z2 + 3.0) / 96.0;
    let third = z * (((3.0 * z2 + 19.0) * z2 + 17.0) * z2 - 15.0) / 384.0;
    z + first / n + second / (n * n) + third / (n * n * n)
}

/// Quantile of χ² with `degrees_of_freedom` at `probability`; NaN where no such distribution exists.
pub fn chi_squared_quantile(probability: f64, degrees_of_freedom: f64) -> f64 {
    ChiSquared::new(degrees_of_freedom).map_or(f64::NAN, |d| d.inverse_cdf(probability))
}

/// Two-sided Student-t interval of `level` (e.g. 0.95) about `value`.
pub fn interval(value: f64, standard_error: f64, degrees_of_freedom: f64, level: f64) -> (f64, f64) {
    let reach = student_t_quantile(0.5 + level / 2.0, degrees_of_freedom) * standard_error;
    (value - reach, value + reach)
}

/// Above this many degrees of freedom of its denominator F is found from χ²: the library's distribution function is
/// right to 1e-8 there only, and worse beyond.
const MANY_IN_DENOMINATOR: f64 = 3e4;

/// The probability that χ² with `degrees_of_freedom` is larger than `value`; NaN where no such distribution exists, one
/// without any degree of freedom.
pub fn chi_squared_tail(value: f64, degrees_of_freedom: f64) -> f64 {
    if degrees_of_freedom == 0.0 {
        return 1.0;
    }
    ChiSquared::new(degrees_of_freedom).map_or(f64::NAN, |d| d.sf(value.max(0.0)))
}

/// The probability that F with these degrees of freedom is larger than `value`; NaN where no such distribution exists.
/// An infinite denominator stands for χ² over the degrees of the numerator.
pub fn f_tail(value: f64, numerator: f64, denominator: f64) -> f64 {
    if denominator > MANY_IN_DENOMINATOR {
        // The positive root of the relation in `f_quantile`.
        let (square, linear) = (0.5 / denominator, 1.0 + 0.5 * (2.0 - numerator) / denominator);
        let product = value.max(0.0) * numerator;
        let chi_squared = 2.0 * product / (linear + (linear * linear + 4.0 * square * product).sqrt());
        return chi_squared_tail(chi_squared, numerator);
    }
    FisherSnedecor::new(numerator, denominator).map_or(f64::NAN, |d| d.sf(value.max(0.0)))
}

/// Quantile of F with these degrees of freedom at `probability`; NaN where no such distribution exists.
///
/// With `x` the quantile of χ² with m degrees, that of F with m and many n is `x/m (1 + (x − m + 2)/(2n))` to first
/// order in 1/n.
pub fn f_quantile(probability: f64, numerator: f64, denominator: f64) -> f64 {
    if denominator > MANY_IN_DENOMINATOR {
        let x = chi_squared_quantile(probability, numerator);
        return x / numerator * (1.0 + 0.5 * (x - numerator + 2.0) / denominator);
    }
    FisherSnedecor::new(numerator, denominator).map_or(f64::NAN, |d| d.inverse_cdf(probability))
}

/// p-values of several tests, each raised so that the chance of any false alarm among them is at most the least.
///
/// # Source
/// Holm, *A simple sequentially rejective multiple test procedure*, Scandinavian Journal of Statistics 6, 1979.
#[must_use]
pub fn holm(p_values: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..p_values.len()).collect();
    order.sort_by(|a, b| p_values[*a].total_cmp(&p_values[*b]));
    let mut raised = vec![1.0; p_values.len()];
    let mut least: f64 = 0.0;
    for (rank, index) in order.into_iter().enumerate() {
        least = least.max((p_values.len() - rank) as f64 * p_values[index]).min(1.0);
        raised[index] = least;
    }
    raised
}
