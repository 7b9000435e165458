//! Fourier transforms, power and cross spectra by Welch's method, coherence, and how far to trust them.
//!
//! Transforms use `e^{−jωt}` and no factor in front.

mod coherence;
mod peaks;
mod spectrogram;
mod welch;

pub use peaks::{SpectralPeak, peaks, top_range};
pub use spectrogram::{Bands, Spectrogram, SpectrogramBuilder, spectrogram};
pub(crate) use welch::SegmentTransform;
pub use welch::{CrossSpectrum, PowerSpectrum, Welch, cross_spectrum, power_spectrum};

use std::f64::consts::TAU;

use crate::Complex64;
use crate::error::{SignalError, check_at_least, check_finite, check_sample_time};
use crate::plans;

/// One-sided discrete Fourier transform, `X[k] = Σ_t x[t] e^{−j2πkt/N}`, `k = 0 ..= N/2`.
///
/// Lengths with large prime factors are an order of magnitude slower.
///
/// # Errors
/// [`SignalError::TooShort`] for an empty `x`.
///
/// # Example
/// ```
/// let spectrum = signal::spectrum::fft_real(&[1.0, 0.0, -1.0, 0.0])?;
/// assert!((spectrum[1].re - 2.0).abs() < 1e-12 && spectrum.len() == 3);
/// # Ok::<(), signal::SignalError>(())
/// ```
pub fn fft_real(x: &[f64]) -> Result<Vec<Complex64>, SignalError> {
    check_at_least(1, x.len())?;
    let plan = plans::forward(x.len());
    let mut input = x.to_vec();
    let mut output = plan.make_output_vec();
    plan.process(&mut input, &mut output).map_err(|_| SignalError::Transform { length: x.len() })?;
    Ok(output)
}

/// The frequencies of [`fft_real`]'s values, in hertz, for `length` samples.
#[must_use]
pub fn fft_frequencies_hz(length: usize, sample_time_s: f64) -> Vec<f64> {
    (0..=length / 2).map(|k| k as f64 / (length as f64 * sample_time_s)).collect()
}

/// The Fourier sum at arbitrary frequencies, `X(f) = Σ_t x[t] e^{−j2πftT}`; costs one pass a frequency.
///
/// # Errors
/// [`SignalError::SampleTime`], [`SignalError::NonFinite`] for a frequency that is not finite.
pub fn dft_at(x: &[f64], sample_time_s: f64, freqs_hz: &[f64]) -> Result<Vec<Complex64>, SignalError> {
    check_sample_time(sample_time_s)?;
    check_finite(freqs_hz)?;
    Ok(freqs_hz.iter().map(|f| fourier_sum(x, TAU * f * sample_time_s)).collect())
}

/// Turns by multiplication, restarted every few hundred samples so that rounding does not build up.
pub(crate) fn fourier_sum(x: &[f64], angle: f64) -> Complex64 {
    const BLOCK: usize = 256;
    let turn = Complex64::cis(-angle);
    let mut sum = Complex64::ZERO;
    for (index, block) in work::checked(x.chunks(BLOCK)).enumerate() {
        let mut factor = Complex64::cis(-angle * (index * BLOCK) as f64);
        for v in block {
            sum += factor * *v;
            factor *= turn;
        }
    }
    sum
}

/// The real signal of `length` samples whose one-sided transform, as [`fft_real`] gives it, is `spectrum`:
/// `x[t] = 1/N Σ_k X[k] e^{j2πkt/N}`.
///
/// # Errors
/// [`SignalError::TooShort`] for a length of zero, [`SignalError::Transform`] where `spectrum` does not hold
/// `length/2 + 1` values.
///
/// # Example
/// ```
/// let x = [1.0, 3.0, -2.0, 0.5];
/// let back = signal::spectrum::inverse_fft_real(signal::spectrum::fft_real(&x)?, 4)?;
/// assert!(back.iter().zip(x).all(|(a, b)| (a - b).abs() < 1e-12));
/// # Ok::<(), signal::SignalError>(())
/// ```
pub fn inverse_fft_real(mut spectrum: Vec<Complex64>, length: usize) -> Result<Vec<f64>, SignalError> {
    check_at_least(1, length)?;
    let plan = plans::inverse(length);
    // The transform of a real signal is real at zero and at the Nyquist frequency; rounding may say otherwise.
    if let Some(first) = spectrum.first_mut() {
        first.im = 0.0;
    }
    if let (true, Some(last)) = (length.is_multiple_of(2), spectrum.last_mut()) {
        last.im = 0.0;
    }
    let mut output = plan.make_output_vec();
    plan.process(&mut spectrum, &mut output).map_err(|_| SignalError::Transform { length })?;
    output.iter_mut().for_each(|x| *x /= length as f64);
    Ok(output)
}
