//! Content of a Campbell map: short spectra, each at a speed.

use numerics::null::nan_if_null;
use serde::{Deserialize, Serialize};
use signal::Signal;

use super::angle::Angle;
use crate::lines::amplitudes::amplitudes;

/// Length of the short spectra, s: 2 Hz between their lines.
const SHORT_S: f64 = 0.5;
/// Short spectra of a recording, at most; they overlap by three quarters where there are fewer.
const MOST: usize = 200;

/// The spectrum of a moment.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ShortSpectrum {
    /// Its middle, s.
    #[serde(deserialize_with = "nan_if_null")]
    pub time_s: f64,
    /// Mean speed, rad/s.
    #[serde(deserialize_with = "nan_if_null")]
    pub speed_rad_s: f64,
    /// Amplitude of a sine at each multiple of [`ShortSpectrum::STEP_HZ`] from zero on, in SI.
    #[serde(deserialize_with = "nan_if_null")]
    pub amplitude: Vec<f64>,
}

impl ShortSpectrum {
    /// From one frequency to the next, Hz.
    pub const STEP_HZ: f64 = 1.0 / SHORT_S;
}

/// Short spectra along a signal, through Hann windows, a straight line taken out of each.
pub(super) fn short_spectra(signal: &Signal, angle: &Angle<'_>) -> Vec<ShortSpectrum> {
    let spare_s = signal.duration_s() - SHORT_S;
    let count = (4.0 * spare_s / SHORT_S).floor().max(0.0) as usize;
    let count = count.min(MOST);
    let of = |k: usize| {
        let from_s = signal.start_s + spare_s * k as f64 / count.max(1) as f64;
        let part = signal.slice(from_s, from_s + SHORT_S);
        let (_, amplitude) = amplitudes(&straightened(&part.samples), part.sample_time_s);
        ShortSpectrum {
            time_s: from_s + 0.5 * SHORT_S,
            speed_rad_s: std::f64::consts::TAU * angle.mean_hz(from_s, from_s + SHORT_S),
            amplitude,
        }
    };
    (0..count).map(of).collect()
}

/// Samples less the line through them, by least squares.
fn straightened(samples: &[f64]) -> Vec<f64> {
    let middle = 0.5 * (samples.len() as f64 - 1.0);
    let place = |k: usize| k as f64 - middle;
    let moment: f64 = (0..samples.len()).map(|k| place(k) * place(k)).sum();
    let slope = samples.iter().enumerate().map(|(k, x)| place(k) * x).sum::<f64>() / moment.max(f64::MIN_POSITIVE);
    samples.iter().enumerate().map(|(k, x)| x - slope * place(k)).collect()
}
