//! Gaussian noise.

use super::{Random, Timing};
use crate::error::{SignalError, check_finite, check_range, check_sample_time};
use crate::spectrum::inverse_fft_real;
use crate::{Complex64, Signal};

/// Normal white noise, each value held for `hold_s` (rounded to whole samples, at least one: white on every sample for
/// a `hold_s` of zero).
///
/// # Errors
/// [`SignalError::Parameter`], [`SignalError::SampleTime`], [`SignalError::NonFinite`] for the mean.
pub fn held_noise(
    random: &mut Random,
    timing: Timing,
    mean: f64,
    standard_deviation: f64,
    hold_s: f64,
) -> Result<Signal, SignalError> {
    check_finite(&[mean])?;
    check_range("standard_deviation", standard_deviation, 0.0, f64::MAX)?;
    let hold = timing.samples_in("hold_s", hold_s)?;
    let mut value = 0.0;
    let sample = |i: usize| {
        if i.is_multiple_of(hold) {
            value = mean + standard_deviation * random.normal();
        }
        value
    };
    timing.signal((0..timing.length).map(sample).collect())
}

/// Normal noise with all its power between two frequencies, evenly spread, and none elsewhere; periodic with its
/// length.
///
/// The standard deviation is that expected: the one realised scatters by `1/√(2·lines)` relative to it, with
/// `(high − low) · length · T` lines.
///
/// # Errors
/// [`SignalError::Parameter`] for a negative deviation, a band not within zero to half the sample rate, or no line
/// within the band; [`SignalError::SampleTime`].
///
/// # Example
/// ```
/// use signal::excitation::{Random, Timing, band_limited_noise};
/// let timing = Timing { sample_time_s: 1e-3, length: 1000 };
/// let x = band_limited_noise(&mut Random::new(1), timing, 2.0, [100.0, 300.0])?;
/// let lines = signal::spectrum::fft_real(&x.samples)?;
/// assert!(lines[99].norm() < 1e-9 && lines[100].norm() > 1e-3 && lines[301].norm() < 1e-9);
/// # Ok::<(), signal::SignalError>(())
/// ```
pub fn band_limited_noise(
    random: &mut Random,
    timing: Timing,
    standard_deviation: f64,
    band_hz: [f64; 2],
) -> Result<Signal, SignalError> {
    let Timing { sample_time_s, length } = timing;
    check_sample_time(sample_time_s)?;
    check_range("standard_deviation", standard_deviation, 0.0, f64::MAX)?;
    check_range("band_hz", band_hz[0], 0.0, 0.5 / sample_time_s)?;
    check_range("band_hz", band_hz[1], band_hz[0], 0.5 / sample_time_s)?;
    let duration_s = length as f64 * sample_time_s;
    // Rest and half the sample rate are left out; a line on the edge is in, whatever rounding says.
    let line = |freq_hz: f64| freq_hz * duration_s;
    let first = ((line(band_hz[0]) - 1e-6).ceil() as usize).max(1);
    let last = ((line(band_hz[1]) + 1e-6).floor() as usize).min(length.saturating_sub(1) / 2);
    if first > last {
        return Err(SignalError::Parameter {
            name: "band_hz",
            value: band_hz[1],
            low: first as f64 / duration_s,
            high: 0.5 / sample_time_s,
        });
    }
    let scale = 0.5 * length as f64 * standard_deviation / ((last - first + 1) as f64).sqrt();
    let mut spectrum = vec![Complex64::ZERO; length / 2 + 1];
    for value in &mut spectrum[first..=last] {
        *value = Complex64::new(random.normal(), random.normal()) * scale;
    }
    timing.signal(inverse_fft_real(spectrum, length)?)
}
