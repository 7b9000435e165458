//! Correlations and the delays read from them.

use numerics::search;
use numerics::vector::mean_square;
use serde::{Deserialize, Serialize};

use crate::error::{SignalError, check_at_least, check_finite, check_same_length, check_sample_time};
use crate::series::mean;
use crate::{Complex64, plans, sinc};

/// A correlation at the lags `−max_lag ..= max_lag`.
#[derive(Debug, Clone, PartialEq)]
pub struct Correlation {
    /// Largest lag, in samples.
    pub max_lag: usize,
    /// `2·max_lag + 1` values; lag `k` is at index `k + max_lag`.
    pub values: Vec<f64>,
}

impl Correlation {
    /// The lags, in samples, in the order of the values.
    pub fn lags(&self) -> impl Iterator<Item = i64> + use<> {
        -(self.max_lag as i64)..=self.max_lag as i64
    }

    /// The value at a lag, zero outside those held.
    #[must_use]
    pub fn at(&self, lag: i64) -> f64 {
        let index = lag + self.max_lag as i64;
        usize::try_from(index).ok().and_then(|i| self.values.get(i)).copied().unwrap_or(0.0)
    }
}

/// Biased cross-correlation, `R_xy(k) = 1/N · Σ_t x[t] · y[t+k]`, over the samples both have.
///
/// **Sign:** a `y` that comes `d` samples after `x` peaks at `k = +d`. Means are not removed.
///
/// # Errors
/// [`SignalError::LengthMismatch`]; [`SignalError::TooShort`] unless the record is longer than `max_lag`;
/// [`SignalError::NonFinite`].
///
/// # Example
/// ```
/// let r = signal::correlation::cross_correlation(&[1.0, 0.0, 0.0, 0.0], &[0.0, 0.0, 4.0, 0.0], 2)?;
/// assert!((r.at(2) - 1.0).abs() < 1e-12 && r.at(-2).abs() < 1e-12);
/// # Ok::<(), signal::SignalError>(())
/// ```
///
/// # Source
/// Ljung, L. (1999), *System Identification*, ch. 6.
pub fn cross_correlation(x: &[f64], y: &[f64], max_lag: usize) -> Result<Correlation, SignalError> {
    check_same_length(x.len(), y.len())?;
    check_at_least(max_lag + 1, x.len())?;
    check_finite(x)?;
    check_finite(y)?;
    let transforms = Transforms::new(x.len(), max_lag);
    let sx = transforms.spectrum(x)?;
    let mut product = transforms.spectrum(y)?;
    for (b, a) in product.iter_mut().zip(&sx) {
        *b *= a.conj();
    }
    drop(sx);
    transforms.correlation(product)
}

/// Biased auto-correlation, `R_x(k) = 1/N · Σ_t x[t] · x[t+k]`: [`cross_correlation`] of `x` with itself, with one
/// transform less.
///
/// # Errors
/// Those of [`cross_correlation`].
pub fn auto_correlation(x: &[f64], max_lag: usize) -> Result<Correlation, SignalError> {
    check_at_least(max_lag + 1, x.len())?;
    check_finite(x)?;
    let transforms = Transforms::new(x.len(), max_lag);
    let mut power = transforms.spectrum(x)?;
    power.iter_mut().for_each(|v| *v = Complex64::new(v.norm_sqr(), 0.0));
    transforms.correlation(power)
}

/// Transforms of records with so many zeros behind them that no lag wraps around.
struct Transforms {
    samples: usize,
    max_lag: usize,
    length: usize,
}

impl Transforms {
    fn new(samples: usize, max_lag: usize) -> Self {
        Transforms { samples, max_lag, length: (samples + max_lag).next_power_of_two().max(2) }
    }

    fn failed(&self) -> SignalError {
        SignalError::Transform { length: self.length }
    }

    fn spectrum(&self, x: &[f64]) -> Result<Vec<Complex64>, SignalError> {
        let forward = plans::forward(self.length);
        let mut padded = vec![0.0; self.length];
        padded[..x.len()].copy_from_slice(x);
        let mut spectrum = forward.make_output_vec();
        forward.process(&mut padded, &mut spectrum).map_err(|_| self.failed())?;
        Ok(spectrum)
    }

    /// The correlation whose spectrum this is.
    fn correlation(&self, mut spectrum: Vec<Complex64>) -> Result<Correlation, SignalError> {
        let (n, max_lag) = (self.length, self.max_lag);
        // Rounding may leave an imaginary part at rest and at half the sample rate, which the inverse refuses.
        spectrum[0].im = 0.0;
        spectrum[n / 2].im = 0.0;
        let inverse = plans::inverse(n);
        let mut circular = inverse.make_output_vec();
        inverse.process(&mut spectrum, &mut circular).map_err(|_| self.failed())?;
        let scale = 1.0 / (n as f64 * self.samples as f64);
        let negative = circular[n - max_lag..].iter();
        let values = negative.chain(&circular[..=max_lag]).map(|v| v * scale).collect();
        Ok(Correlation { max_lag, values })
    }
}

/// A delay read from a correlation peak.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct CorrelationDelay {
    /// How much later the second signal is, in seconds; negative where it is earlier.
    pub delay_s: f64,
    /// The correlation coefficient at the peak, −1 to 1; negative where the signals oppose each other.
    pub coefficient: f64,
    /// True if the peak lies on the edge of the range searched: the true one may lie outside.
    pub at_edge: bool,
}

/// How much later `later` is than `earlier`, to a fraction of a sample: the peak of the magnitude of their
/// cross-correlation, interpolated band-limited between the lags.
///
/// The lags searched are `−max_delay_s ..= max_delay_s`. Means are removed. For signals that differ by a filter the
/// result is a mean of the filter's delay over the power of the signal.
///
/// # Errors
/// [`SignalError::Constant`] where either does not vary; [`SignalError::TooShort`] unless the record is longer than
/// the range by 33 samples; [`SignalError::LengthMismatch`], [`SignalError::NonFinite`], [`SignalError::SampleTime`].
///
/// # Example
/// ```
/// let pulse = |t: f64| (-(t / 4.0).powi(2)).exp();
/// let x: Vec<f64> = (0..400).map(|i| pulse(i as f64 - 200.0)).collect();
/// let y: Vec<f64> = (0..400).map(|i| pulse(i as f64 - 202.3)).collect();
/// let found = signal::correlation::delay_by_correlation(&x, &y, 1e-3, 10e-3)?;
/// assert!((found.delay_s - 2.3e-3).abs() < 1e-6);
/// # Ok::<(), signal::SignalError>(())
/// ```
pub fn delay_by_correlation(
    earlier: &[f64],
    later: &[f64],
    sample_time_s: f64,
    max_delay_s: f64,
) -> Result<CorrelationDelay, SignalError> {
    check_sample_time(sample_time_s)?;
    check_finite(&[max_delay_s])?;
    let range = (max_delay_s.abs() / sample_time_s).ceil() as i64;
    if is_constant(earlier) || is_constant(later) {
        return Err(SignalError::Constant);
    }
    let (x, y) = (centred(earlier), centred(later));
    let r = cross_correlation(&x, &y, range as usize + sinc::HALF_WIDTH + 1)?;
    let power = (mean_square(&x) * mean_square(&y)).sqrt();
    let coarse = (-range..=range).max_by(|a, b| r.at(*a).abs().total_cmp(&r.at(*b).abs())).unwrap_or(0);
    let at_edge = range > 0 && coarse.abs() == range;
    let sign = r.at(coarse).signum();
    let value = |lag: f64| sign * sinc::interpolate(|k| r.at(k), lag);
    let lag = search::maximum((coarse as f64 - 1.0, coarse as f64 + 1.0), 1e-8, value);
    Ok(CorrelationDelay { delay_s: lag * sample_time_s, coefficient: sign * value(lag) / power, at_edge })
}

pub(crate) fn is_constant(x: &[f64]) -> bool {
    x.windows(2).all(|w| w[0] == w[1])
}

fn centred(x: &[f64]) -> Vec<f64> {
    let mean = mean(x).unwrap_or(0.0);
    x.iter().map(|v| v - mean).collect()
}
