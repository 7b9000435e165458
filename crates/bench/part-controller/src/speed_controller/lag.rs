//! Series that are late by whole samples.

/// A series later by some samples; its ends are repeated.
pub(super) fn shifted(series: &[f64], lag: i32) -> Vec<f64> {
    (0..series.len()).map(|k| lagged(series, k, lag)).collect()
}

/// The value of a series some samples before `k`; its ends are repeated.
pub(super) fn lagged(series: &[f64], k: usize, lag: i32) -> f64 {
    let last = series.len() as i64 - 1;
    series[(k as i64 - i64::from(lag)).clamp(0, last) as usize]
}
