//! Averaged spectra over segments, and the certainty of such averages.

use serde::{Deserialize, Serialize};

use super::fft_frequencies_hz;
use crate::Complex64;
use crate::distributions::chi_squared_quantile;
use crate::error::{SignalError, check_at_least, check_finite, check_range, check_same_length, check_sample_time};
use crate::plans;
use crate::series::mean;
use crate::window::Window;

/// How Welch's method cuts the record.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Welch {
    /// Samples in a segment; the resolution is about `1.5 / (segment · T)` hertz.
    pub segment: usize,
    /// Samples two neighbouring segments share, less than `segment`; half is usual with the Hann window.
    pub overlap: usize,
    /// Window that each segment is multiplied with.
    pub window: Window,
}

impl Welch {
    /// Segments of this length that overlap by half, with the Hann window.
    #[must_use]
    pub fn half_overlapping(segment: usize) -> Self {
        Self { segment, overlap: segment / 2, window: Window::Hann }
    }

    /// Width of the rectangle that lets as much noise through as the window, `Σw² / ((Σw)² T)`: that of 1.5 lines with
    /// the Hann window.
    ///
    /// # Errors
    /// Those of [`Window::periodic`].
    pub fn noise_bandwidth_hz(self, sample_time_s: f64) -> Result<f64, SignalError> {
        let window = self.window.periodic(self.segment)?;
        let (sum, energy): (f64, f64) = (window.iter().sum(), window.iter().map(|w| w * w).sum());
        Ok(energy / (sum * sum * sample_time_s))
    }

    /// Sides of a two-sided spectrum that a line stands for: two, but one at rest and at half the sample rate.
    pub(super) fn sides(self, line: usize) -> f64 {
        if line == 0 || 2 * line == self.segment { 1.0 } else { 2.0 }
    }

    pub(super) fn check(self, length: usize) -> Result<(), SignalError> {
        check_range("segment", self.segment as f64, 2.0, f64::INFINITY)?;
        check_range("overlap", self.overlap as f64, 0.0, self.segment as f64 - 1.0)?;
        check_at_least(self.segment, length)
    }

    /// Degrees of freedom of an average over `segments`: two a segment, less what overlapping windows share.
    pub(super) fn degrees_of_freedom(self, window: &[f64], segments: usize) -> f64 {
        let hop = self.segment - self.overlap;
        let energy: f64 = window.iter().map(|w| w * w).sum();
        let shared = |m: usize| {
            let product: f64 = window.iter().zip(&window[m * hop..]).map(|(a, b)| a * b).sum();
            (1.0 - m as f64 / segments as f64) * (product / energy).powi(2)
        };
        let reach = (self.segment - 1) / hop;
        2.0 * segments as f64 / (1.0 + 2.0 * (1..segments.min(reach + 1)).map(shared).sum::<f64>())
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
    /// True if segments have an even number of samples, so that the last frequency is half the sample rate.
    pub has_even_segments: bool,
    /// Degrees of freedom ν of the averages for noise: `ν·P̂/P` is distributed as χ² with ν of them. Half as many at
    /// rest and at half the sample rate. Fewer than two a segment where segments overlap.
    pub degrees_of_freedom: f64,
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

    /// The coherence that unrelated signals exceed at one frequency with probability `false_alarm`,
    /// `1 − p^{1/(ν/2 − 1)}`.
    ///
    /// # Errors
    /// [`SignalError::Parameter`] for a probability outside 0 ..= 1; [`SignalError::TooShort`] where no more than one
    /// segment's worth of averages was made, so that no coherence is significant.
    ///
    /// # Source
    /// Carter, G. C. (1987), Proc. IEEE 75(2), 236–255.
    pub fn coherence_threshold(&self, false_alarm: f64) -> Result<f64, SignalError> {
        check_range("false_alarm", false_alarm, 0.0, 1.0)?;
        let averages = 0.5 * self.degrees_of_freedom;
        if averages <= 1.0 {
            return Err(SignalError::TooShort { needed: 2, got: self.segments });
        }
        Ok(1.0 - false_alarm.powf(1.0 / (averages - 1.0)))
    }

    /// Variance of [`CrossSpectrum::response_h1`], `E|Ĥ − EĤ|² = |Ĥ|² (1 − γ²)/γ² / (ν/2 − 1)` with γ² the coherence:
    /// the scatter that noise on the output causes, without the bias from leakage within a segment. Infinite where the
    /// coherence is zero or there are no more than two degrees of freedom.
    ///
    /// # Source
    /// Bendat and Piersol (2010), *Random Data*, §9.2.4.
    #[must_use]
    pub fn response_h1_variance(&self) -> Vec<f64> {
        let averages = (0.5 * self.degrees_of_freedom - 1.0).max(0.0);
        let unexplained = |i: usize| (self.pyy[i] - self.pxy[i].norm_sqr() / self.pxx[i]).max(0.0);
        let variance = |i: usize| {
            let value = unexplained(i) / self.pxx[i] / averages;
            if value.is_nan() { f64::INFINITY } else { value }
        };
        (0..self.pxx.len()).map(variance).collect()
    }

    /// The frequency response estimate `H1 = Pxy / Pxx`, right under noise on the output; NaN where `x` has no power.
    #[must_use]
    pub fn response_h1(&self) -> Vec<Complex64> {
        self.pxy.iter().zip(&self.pxx).map(|(xy, xx)| xy / xx).collect()
    }
}

/// Auto and cross power densities of two signals on one clock, by Welch's method; each segment's mean is removed.
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
    let window = welch.window.periodic(n)?;
    let mut sum = CrossSpectrum {
        freq_hz: fft_frequencies_hz(n, sample_time_s),
        pxx: vec![0.0; n / 2 + 1],
        pyy: vec![0.0; n / 2 + 1],
        pxy: vec![Complex64::ZERO; n / 2 + 1],
        segments: 0,
        has_even_segments: n.is_multiple_of(2),
        degrees_of_freedom: 0.0,
    };
    let mut transform = SegmentTransform::new(&window);
    let mut sx = vec![Complex64::ZERO; n / 2 + 1];
    for start in (0..=x.len() - n).step_by(n - welch.overlap) {
        sx.copy_from_slice(transform.apply(&x[start..start + n])?);
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
    sum.degrees_of_freedom = welch.degrees_of_freedom(&window, sum.segments);
    for k in 0..sum.pxx.len() {
        let factor = welch.sides(k) * scale;
        sum.pxx[k] *= factor;
        sum.pyy[k] *= factor;
        sum.pxy[k] *= factor;
    }
    Ok(sum)
}

/// The transform of segments of one length, each without its mean and under a window; planned once.
pub(crate) struct SegmentTransform<'a> {
    window: &'a [f64],
    plan: std::sync::Arc<dyn realfft::RealToComplex<f64>>,
    input: Vec<f64>,
    output: Vec<Complex64>,
    scratch: Vec<Complex64>,
}

impl<'a> SegmentTransform<'a> {
    pub(crate) fn new(window: &'a [f64]) -> Self {
        let plan = plans::forward(window.len());
        let (input, output, scratch) = (plan.make_input_vec(), plan.make_output_vec(), plan.make_scratch_vec());
        Self { window, plan, input, output, scratch }
    }

    pub(crate) fn apply(&mut self, segment: &[f64]) -> Result<&[Complex64], SignalError> {
        work::checkpoint();
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
    /// Degrees of freedom ν at each frequency, for noise: `ν·P̂/P` is distributed as χ² with ν of them.
    pub degrees_of_freedom: Vec<f64>,
}

impl PowerSpectrum {
    /// The interval `[ν P̂/χ²_{(1+p)/2}, ν P̂/χ²_{(1−p)/2}]` that holds the density at each frequency with probability
    /// `confidence`, for Gaussian noise whose density is even within the resolution.
    ///
    /// # Errors
    /// [`SignalError::Parameter`] unless `0 < confidence < 1`.
    ///
    /// # Example
    /// ```
    /// use signal::excitation::{Random, Timing, held_noise};
    /// use signal::spectrum::{Welch, power_spectrum};
    /// let x = held_noise(&mut Random::new(1), Timing { sample_time_s: 1.0, length: 20_000 }, 0.0, 1.0, 1.0)?;
    /// let psd = power_spectrum(&x.samples, 1.0, Welch::half_overlapping(200))?;
    /// let inside = psd.interval(0.95)?[1..100].iter().filter(|[low, high]| *low < 2.0 && 2.0 < *high).count();
    /// assert!(inside >= 89); // 95 of 99 expected
    /// # Ok::<(), signal::SignalError>(())
    /// ```
    ///
    /// # Source
    /// Percival and Walden (1993), *Spectral Analysis for Physical Applications*, §6.10 and §6.17.
    pub fn interval(&self, confidence: f64) -> Result<Vec<[f64; 2]>, SignalError> {
        check_range("confidence", confidence, f64::MIN_POSITIVE, 1.0 - f64::EPSILON)?;
        let mut known = (f64::NAN, [0.0; 2]);
        let interval = |(p, &freedom): (&f64, &f64)| {
            if freedom != known.0 {
                let tails = [0.5 * (1.0 + confidence), 0.5 * (1.0 - confidence)];
                known = (freedom, tails.map(|tail| freedom / chi_squared_quantile(tail, freedom)));
            }
            known.1.map(|factor| factor * p)
        };
        Ok(self.density.iter().zip(&self.degrees_of_freedom).map(interval).collect())
    }
}

/// Power spectral density by Welch's method.
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
    // Half as many where the transform is real.
    let freedom = |k: usize| 0.5 * welch.sides(k) * both.degrees_of_freedom;
    let degrees_of_freedom = (0..both.freq_hz.len()).map(freedom).collect();
    Ok(PowerSpectrum { freq_hz: both.freq_hz, density: both.pxx, degrees_of_freedom })
}
