//! Test that one model's errors are smaller than another's on the same samples.

use ident::distributions::f_tail;
use numerics::null::{infinite_if_null, nan_if_null};
use serde::{Deserialize, Serialize};

use crate::torque_control::batches;

/// A test of squared errors in pairs.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PairedTest {
    /// Mean of the bar's squared error less the model's, Nm²: positive where the model is better.
    #[serde(deserialize_with = "nan_if_null")]
    pub difference_nm2: f64,
    /// Its standard error, Nm².
    #[serde(deserialize_with = "nan_if_null")]
    pub standard_error_nm2: f64,
    /// Degrees of freedom of Student's t.
    #[serde(deserialize_with = "infinite_if_null")]
    pub degrees_of_freedom: f64,
    /// Probability of a difference as large as this, either way, where there is none.
    #[serde(deserialize_with = "nan_if_null")]
    pub p_value: f64,
}

/// Compares squared errors by their means over batches of half a second: what hangs together within a batch, such as a
/// held demand or ripple, counts once.
///
/// # Source
/// Diebold & Mariano, *Comparing predictive accuracy*, J. Business & Economic Statistics 13, 1995, with the variance of
/// Ibragimov & Müller, *t-statistic based correlation and heterogeneity robust inference*, 2010.
pub(super) fn compare(bar: &[f64], model: &[f64], sample_time_s: f64) -> PairedTest {
    let differences: Vec<f64> = bar.iter().zip(model).map(|(b, m)| b * b - m * m).collect();
    let count = batches(differences.len(), sample_time_s);
    let length = (differences.len() / count).max(1);
    let means: Vec<f64> = differences.chunks_exact(length).map(|c| c.iter().sum::<f64>() / length as f64).collect();
    let n = means.len() as f64;
    let difference_nm2 = means.iter().sum::<f64>() / n;
    let variance = means.iter().map(|m| (m - difference_nm2).powi(2)).sum::<f64>() / (n * (n - 1.0));
    let degrees_of_freedom = n - 1.0;
    let t_squared = difference_nm2 * difference_nm2 / variance;
    let p_value = match difference_nm2 {
        0.0 => 1.0,
        _ if t_squared.is_finite() => f_tail(t_squared, 1.0, degrees_of_freedom),
        _ => f64::NAN,
    };
    PairedTest { difference_nm2, standard_error_nm2: variance.sqrt(), degrees_of_freedom, p_value }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Errors that hang together for 20 samples, equal in size: false alarms at 5 % of the tests.
    #[test]
    fn stat_errors_of_one_size_are_not_separated() {
        let mut random = signal::excitation::Random::new(9);
        let mut coloured = || {
            let (mut x, keep) = (0.0, 0.95_f64);
            let values = (0..4000).map(|_| {
                x = keep * x + random.normal();
                x
            });
            values.collect::<Vec<f64>>()
        };
        let alarms = (0..400).filter(|_| compare(&coloured(), &coloured(), 4e-3).p_value < 0.05).count();
        // Binomial(400, 0.05): 8 to 34 with probability 0.998.
        assert!((8..=34).contains(&alarms), "{alarms}");
    }
}
