//! Amplitudes of a signal over frequency.

use std::f64::consts::TAU;

use signal::spectrum::{fft_frequencies_hz, fft_real};

/// Frequencies, Hz, and the amplitude of a sine at each, of samples without their mean, seen through a Hann window.
pub fn amplitudes(samples: &[f64], sample_time_s: f64) -> (Vec<f64>, Vec<f64>) {
    let count = samples.len() as f64;
    let mean = samples.iter().sum::<f64>() / count;
    let window = |k: usize| 1.0 - (TAU * (k as f64 + 0.5) / count).cos();
    let seen: Vec<f64> = samples.iter().enumerate().map(|(k, x)| window(k) * (x - mean)).collect();
    let lines = fft_real(&seen).unwrap_or_default();
    let amplitude = lines.iter().map(|line| 2.0 * line.norm() / count).collect();
    (fft_frequencies_hz(samples.len(), sample_time_s), amplitude)
}
