//! Fourier transforms, power and cross spectra by Welch's method, coherence.
//!
//! Transforms use `e^{−jωt}` and no factor in front.

use std::f64::consts::TAU;

use realfft::RealFftPlanner;
use serde::{Deserialize, Serialize};

use crate::Complex64;
use crate::error::{SignalError, check_at_least, check_finite, check_range, check_same_length, check_sample_time};
use crate::series::mean;

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
    let plan = RealFftPlanner::<f64>::new().plan_fft_forward(x.len());
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
fn fourier_sum(x: &[f64], angle: f64) -> Complex64 {
    const BLOCK: usize = 256;
    let turn = Complex64::cis(-angle);
    let mut sum = Complex64::ZERO;
    for (index, block) in x.chunks(BLOCK).enumerate() {
        let mut factor = Complex64::cis(-angle * (index * BLOCK) as f64);
        for v in block {
            sum += factor * *v;
            factor *= turn;
        }
    }
    sum
}

/// How Welch's method cuts the record.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Welch {
    /// Samples in a segment; the resolution is about `1.5 / (segment · T)` hertz.
    pub segment: usize,
    /// Samples two neighbouring segments share, less than `segment`; half is usual with the Hann window.
    pub overlap: usize,
}

impl Welch {
    /// Segments of this length that overlap by half.
    #[must_use]
    pub fn half_overlapping(segment: usize) -> Self {
        Self { segment, overlap: segment / 2 }
    }

    fn check(self, length: usize) -> Result<(), SignalError> {
        check_range("segment", self.segment as f64, 2.0, f64::INFINITY)?;
        check_range("overlap", self.overlap as f64, 0.0, self.segment as f64 - 1.0)?;
        check_at_least(self.segment, length)
    }
}

/// Averaged spectra of an input `x` and an output `y`, one-sided densities per hertz.
///
/// All vectors have one entry a frequency, from zero to half the sample rate.
#[derive(Debug, Clone, PartialEq)]
pub struct CrossSpectrum {
    /// Frequencies in hertz.
    pub freq_hz: Vec<f64>,
    /// Power density of `x`, (unit of x)²/Hz.
    pub pxx: Vec<f64>,
    /// Power density of `y`, (unit of y)²/Hz.
    pub pyy: Vec<f64>,
    /// Cross density, mean of `conj(X)·Y`: an output that lags has a negative phase.
    pub pxy: Vec<Complex64>,
    /// Number of segments averaged.
    pub segments: usize,
}

impl CrossSpectrum {
    /// Magnitude-squared coherence, `|Pxy|² / (Pxx·Pyy)`, between 0 and 1; 0 where there is no power. One segment alone
    /// gives 1 everywhere and means nothing.
    #[must_use]
    pub fn coherence(&self) -> Vec<f64> {
        let value = |i: usize| {
            let power = self.pxx[i] * self.pyy[i];
            if power > 0.0 { self.pxy[i].norm_sqr() / power } else { 0.0 }
        };
        (0..self.pxy.len()).map(value).collect()
    }

    /// The frequency response estimate `H1 = Pxy / Pxx`, right under noise on the output; NaN where `x` has no power.
    #[must_use]
    pub fn response_h1(&self) -> Vec<Complex64> {
        self.pxy.iter().zip(&self.pxx).map(|(xy, xx)| xy / xx).collect()
    }
}

/// Auto and cross power densities of two signals on one clock, by Welch's method with a Hann window; each segment's
/// mean is removed.
///
/// Samples after the last whole segment are not used.
///
/// # Errors
/// [`SignalError::LengthMismatch`], [`SignalError::TooShort`] for a record shorter than a segment,
/// [`SignalError::Parameter`] for impossible segments, [`SignalError::NonFinite`], [`SignalError::SampleTime`].
///
/// # Source
/// Welch, P. D. (1967), IEEE Trans. Audio Electroacoust. 15, 70–73. Scaling as `scipy.signal.csd`.
pub fn cross_spectrum(x: &[f64], y: &[f64], sample_time_s: f64, welch: Welch) -> Result<CrossSpectrum, SignalError> {
    check_same_length(x.len(), y.len())?;
    check_sample_time(sample_time_s)?;
    welch.check(x.len())?;
    check_finite(x)?;
    check_finite(y)?;
    let n = welch.segment;
    let window: Vec<f64> = (0..n).map(|i| 0.5 - 0.5 * (TAU * i as f64 / n as f64).cos()).collect();
    let mut sum = CrossSpectrum {
        freq_hz: fft_frequencies_hz(n, sample_time_s),
        pxx: vec![0.0; n / 2 + 1],
        pyy: vec![0.0; n / 2 + 1],
        pxy: vec![Complex64::ZERO; n / 2 + 1],
        segments: 0,
    };
    let mut transform = SegmentTransform::new(&window);
    for start in (0..=x.len() - n).step_by(n - welch.overlap) {
        let sx = transform.apply(&x[start..start + n])?.to_vec();
        let sy = transform.apply(&y[start..start + n])?;
        for (k, (a, b)) in sx.iter().zip(sy).enumerate() {
            sum.pxx[k] += a.norm_sqr();
            sum.pyy[k] += b.norm_sqr();
            sum.pxy[k] += a.conj() * b;
        }
        sum.segments += 1;
    }
    let energy: f64 = window.iter().map(|w| w * w).sum();
    let scale = sample_time_s / (energy * sum.segments as f64);
    scale_one_sided(&mut sum, scale, n);
    Ok(sum)
}

/// Doubles all but rest and, for an even length, half the sample rate: their negative twin is missing.
fn scale_one_sided(sum: &mut CrossSpectrum, scale: f64, n: usize) {
    for k in 0..sum.pxx.len() {
        let factor = if k == 0 || 2 * k == n { scale } else { 2.0 * scale };
        sum.pxx[k] *= factor;
        sum.pyy[k] *= factor;
        sum.pxy[k] *= factor;
    }
}

struct SegmentTransform<'a> {
    window: &'a [f64],
    plan: std::sync::Arc<dyn realfft::RealToComplex<f64>>,
    input: Vec<f64>,
    output: Vec<Complex64>,
    scratch: Vec<Complex64>,
}

impl<'a> SegmentTransform<'a> {
    fn new(window: &'a [f64]) -> Self {
        let plan = RealFftPlanner::<f64>::new().plan_fft_forward(window.len());
        let (input, output, scratch) = (plan.make_input_vec(), plan.make_output_vec(), plan.make_scratch_vec());
        Self { window, plan, input, output, scratch }
    }

    fn apply(&mut self, segment: &[f64]) -> Result<&[Complex64], SignalError> {
        let mean = mean(segment).unwrap_or(0.0);
        for ((slot, v), w) in self.input.iter_mut().zip(segment).zip(self.window) {
            *slot = (v - mean) * w;
        }
        self.plan
            .process_with_scratch(&mut self.input, &mut self.output, &mut self.scratch)
            .map_err(|_| SignalError::Transform { length: segment.len() })?;
        Ok(&self.output)
    }
}

/// A one-sided power spectral density.
#[derive(Debug, Clone, PartialEq)]
pub struct PowerSpectrum {
    /// Frequencies in hertz.
    pub freq_hz: Vec<f64>,
    /// Power density, (unit of x)²/Hz; its integral over frequency is the variance.
    pub density: Vec<f64>,
}

/// Power spectral density by Welch's method with a Hann window.
///
/// # Errors
/// Those of [`cross_spectrum`].
///
/// # Example
/// ```
/// use signal::spectrum::{Welch, power_spectrum};
/// // A sine of amplitude 2 has a power of 2, all of it near its frequency.
/// let x: Vec<f64> = (0..4000).map(|i| 2.0 * (0.2 * i as f64).sin()).collect();
/// let psd = power_spectrum(&x, 1.0, Welch::half_overlapping(500))?;
/// let power: f64 = psd.density.iter().sum::<f64>() * psd.freq_hz[1];
/// assert!((power - 2.0).abs() < 0.02);
/// # Ok::<(), signal::SignalError>(())
/// ```
pub fn power_spectrum(x: &[f64], sample_time_s: f64, welch: Welch) -> Result<PowerSpectrum, SignalError> {
    let both = cross_spectrum(x, x, sample_time_s, welch)?;
    Ok(PowerSpectrum { freq_hz: both.freq_hz, density: both.pxx })
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
    let plan = RealFftPlanner::<f64>::new().plan_fft_inverse(length);
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
