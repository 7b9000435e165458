//! A sine in a series: how large it is at one frequency, and how late it follows another.

use std::f64::consts::{PI, TAU};

/// Periods of the window in which an amplitude is looked for: a sweep passes the frequency in few of them.
const PERIODS: f64 = 5.0;
/// Places of the window for each of its lengths.
const PLACES: usize = 8;
/// Share of a series over which its changes fade at its end.
const FADES: f64 = 0.1;
/// Fewest samples in a period.
const LEAST_SAMPLES: f64 = 5.0;

/// The largest amplitude of a frequency in a series, and the middle of the window where it is, s. The window is that of Hann over five
/// periods, or over the whole series if that is shorter. `None` where the series has too few samples in a period, or less than a period.
pub(crate) fn largest_amplitude(values: &[f64], sample_time_s: f64, frequency_hz: f64) -> Option<(f64, f64)> {
    let period = 1.0 / (frequency_hz * sample_time_s);
    if period < LEAST_SAMPLES || (values.len() as f64) < period {
        return None;
    }
    let length = ((PERIODS * period).round() as usize).min(values.len());
    let window: Vec<f64> = (0..length).map(|k| (PI * (k as f64 + 0.5) / length as f64).sin().powi(2)).collect();
    let turn = TAU / period;
    let wave: Vec<(f64, f64)> = (0..length).map(|k| (turn * k as f64).sin_cos()).collect();
    let weight: f64 = window.iter().sum();
    let at = |start: usize| {
        let part = &values[start..start + length];
        let mean = part.iter().zip(&window).map(|(value, w)| value * w).sum::<f64>() / weight;
        let (mut sine, mut cosine) = (0.0, 0.0);
        for ((value, w), (s, c)) in part.iter().zip(&window).zip(&wave) {
            sine += w * (value - mean) * s;
            cosine += w * (value - mean) * c;
        }
        (2.0 * sine.hypot(cosine) / weight, (start as f64 + 0.5 * (length as f64 - 1.0)) * sample_time_s)
    };
    let last = values.len() - length;
    let starts = (0..=last).step_by((length / PLACES).max(1)).chain([last]);
    starts.map(at).reduce(|most, one| if one.0 > most.0 { one } else { most })
}

/// By how much a value is late behind its demand at a frequency, rad, −π … π: the phase of the Fourier transforms of their changes over
/// the whole series. Changes are zero before and after a step, so that its transform has no end effect; those of the last tenth fade, for
/// a sweep that ends at full swing.
pub(crate) fn lag_rad(demand: &[f64], value: &[f64], sample_time_s: f64, frequency_hz: f64) -> f64 {
    let turn = TAU * frequency_hz * sample_time_s;
    let fades = FADES * demand.len() as f64;
    let transform = |series: &[f64]| {
        series.windows(2).enumerate().fold((0.0, 0.0), |(re, im), (k, pair)| {
            let left = (series.len() - 1 - k) as f64 / fades;
            let change = (pair[1] - pair[0]) * (0.5 * PI * left.min(1.0)).sin().powi(2);
            let (sine, cosine) = (turn * k as f64).sin_cos();
            (re + change * cosine, im - change * sine)
        })
    };
    let (asked, came) = (transform(demand), transform(value));
    let lead = (came.1 * asked.0 - came.0 * asked.1).atan2(came.0 * asked.0 + came.1 * asked.1);
    -lead
}
