//! Tests of `signal` through its public face.
#![allow(clippy::unwrap_used, clippy::expect_used)]

mod checks;
mod distributions;
mod drift;
mod excitations;
mod filters;
mod fir;
mod frf;
mod histogram;
mod periodicity;
mod properties;
mod repeated;
mod spectra;
mod spectrogram;
mod spline;

/// The record the reference values were computed from:
/// `sin(0.3 t) + 0.5 cos(1.7 t) + 0.02 t`, `t = 0 .. 60`.
fn record() -> Vec<f64> {
    (0..60).map(f64::from).map(|t| (0.3 * t).sin() + 0.5 * (1.7 * t).cos() + 0.02 * t).collect()
}

fn assert_close(got: &[f64], expected: &[f64], tolerance: f64) {
    assert_eq!(got.len(), expected.len());
    for (i, (a, b)) in got.iter().zip(expected).enumerate() {
        assert!((a - b).abs() <= tolerance, "at {i}: {a} instead of {b}");
    }
}
