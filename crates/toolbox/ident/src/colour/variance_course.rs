//! Test of whether the size of errors changes over time, and the course of their variance.
//!
//! An interval or a test that takes errors for equally large is too sure where the errors are large while the data say
//! most. The squares of errors whose size changes, slowly or in bursts, depend on those before them.
//!
//! # Source
//! McLeod & Li, *Diagnostic checking ARMA time series models using squared-residual autocorrelations*, J. Time Series
//! Anal. 4, 1983, for the test; White, *A heteroskedasticity-consistent covariance matrix estimator*, Econometrica 48,
//! 1980; Lobato, Nankervis & Savin, *Testing for autocorrelation using a modified Box–Pierce Q test*, Int. Econ. Rev.
//! 42, 2001, for what follows.

use crate::distributions::chi_squared_tail;

/// Lags of the squares that are looked at.
const LAGS: usize = 20;
/// Errors that are needed for so many.
const FEWEST: usize = 60;
/// The probability of a change where there is none.
const FALSE_ALARM: f64 = 1e-3;
/// Neighbours on either side over which squares are averaged.
const REACH: usize = 10;

/// Returns true if errors, of mean zero and NaN where there is none, change in size.
pub(crate) fn changes(series: &[Vec<f64>]) -> bool {
    let squares = || series.iter().flatten().filter(|v| !v.is_nan()).map(|v| v * v);
    let count = squares().count() as f64;
    if count < FEWEST as f64 {
        return false;
    }
    let mean = squares().sum::<f64>() / count;
    let spread: f64 = squares().map(|v| (v - mean).powi(2)).sum();
    let mut statistic = 0.0;
    for lag in 1..=LAGS {
        let (mut sum, mut pairs) = (0.0, 0.0);
        for x in series {
            let both = x.iter().zip(x.get(lag..).unwrap_or_default()).filter(|(a, b)| !a.is_nan() && !b.is_nan());
            both.for_each(|(a, b)| {
                sum += (a * a - mean) * (b * b - mean);
                pairs += 1.0;
            });
        }
        if pairs > 0.0 {
            statistic += count * (count + 2.0) * (sum / spread).powi(2) / pairs;
        }
    }
    statistic.is_finite() && chi_squared_tail(statistic, LAGS as f64) < FALSE_ALARM
}

/// The variance at each instant over that of all, from the errors about it; one where there are none. None of errors
/// that do not change in size.
pub(crate) fn course(series: &[Vec<f64>]) -> Option<Vec<Vec<f64>>> {
    if !changes(series) {
        return None;
    }
    let known = || series.iter().flatten().filter(|v| !v.is_nan());
    let mean = known().map(|v| v * v).sum::<f64>() / known().count() as f64;
    Some(series.iter().map(|x| about(x, mean)).collect())
}

/// Means of the squares about each instant, in units of `mean`.
fn about(x: &[f64], mean: f64) -> Vec<f64> {
    let mut sums = vec![(0.0, 0.0)];
    for v in x {
        let (sum, count) = sums[sums.len() - 1];
        sums.push(if v.is_nan() { (sum, count) } else { (sum + v * v, count + 1.0) });
    }
    let at = |t: usize| {
        let (from, to) = (t.saturating_sub(REACH), (t + REACH + 1).min(x.len()));
        let (sum, count) = (sums[to].0 - sums[from].0, sums[to].1 - sums[from].1);
        if count > 0.0 { sum / count / mean } else { 1.0 }
    };
    (0..x.len()).map(at).collect()
}

#[cfg(test)]
mod tests {
    use signal::excitation::Random;

    use super::*;

    fn errors(seed: u64, size: impl Fn(usize) -> f64) -> Vec<Vec<f64>> {
        let mut random = Random::new(seed);
        vec![(0..600).map(|t| size(t) * random.normal()).collect()]
    }

    #[test]
    fn stat_a_change_of_size_is_found_and_none_where_there_is_none() {
        let found = |size: fn(usize) -> f64| (0..100).filter(|seed| changes(&errors(*seed, size))).count();
        assert!(found(|_| 2.0) <= 2);
        assert!(found(|t| if t < 300 { 1.0 } else { 5.0 }) == 100);
        assert!(found(|t| if t / 20 % 5 == 0 { 5.0 } else { 1.0 }) >= 98);
    }

    #[test]
    fn stat_the_course_is_that_of_the_size() {
        let mut series = errors(3, |t| if t < 300 { 1.0 } else { 3.0 });
        series[0][40] = f64::NAN;
        let course = course(&series).unwrap_or_default();
        let mean = |from: usize, to: usize| course[0][from..to].iter().sum::<f64>() / (to - from) as f64;
        assert!((mean(20, 280) - 0.2).abs() < 0.05 && (mean(320, 580) - 1.8).abs() < 0.3);
    }
}
