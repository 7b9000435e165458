//! The empirical transfer function estimate.

use std::f64::consts::PI;

use super::{FrequencyResponse, check_records};
use crate::Complex64;
use crate::error::{SignalError, check_at_least, check_range};
use crate::spectrum::fft_real;

/// Power of the input below this part of its largest counts as none: rounding.
const NO_POWER: f64 = 1e-24;

/// The empirical transfer function estimate `Ĝ(f_k) = Y(f_k)/U(f_k)` at the bins of the discrete Fourier transform,
/// smoothed over `k − h ..= k + h` where asked: `Ĝ = Σ w Y U* / Σ w |U|²` with Hann weights `w`.
///
/// Exact for periodic data in steady state without noise, with `period` given. Otherwise leakage and noise do not
/// average out however long the record, without smoothing; then the variance is not known either and is NaN. With
/// smoothing it is found from what the smoothed response leaves unexplained. The bins at rest and at half the sample
/// rate are not used.
///
/// # Example
/// ```
/// use signal::frf::Etfe;
/// let u: Vec<f64> = (0..64).map(|t| if t % 16 == 0 { 1.0 } else { 0.0 }).collect();
/// let y: Vec<f64> = (0..64).map(|t| if t % 16 == 1 { 2.0 } else { 0.0 }).collect();
/// let found = Etfe { half_width: 0, period: Some(16) }.estimate(&u, &y, 0.1)?;
/// assert!((found.response[3].norm() - 2.0).abs() < 1e-12);
/// assert!((found.response[3].arg() + std::f64::consts::TAU * found.freq_hz[3] * 0.1).abs() < 1e-12);
/// # Ok::<(), signal::SignalError>(())
/// ```
///
/// # Source
/// Ljung, L. (1999), *System Identification*, (6.24) and (6.46).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Etfe {
    /// Bins (harmonics, for periodic data) `h` taken together on each side; zero for none.
    pub half_width: usize,
    /// The period in samples, for periodic data in steady state: the last whole periods are used, at the harmonics.
    pub period: Option<usize>,
}

impl Etfe {
    /// The estimate from one input and one output. Bins where the input has no power are left out.
    ///
    /// # Errors
    /// [`SignalError::TooShort`] for fewer than three samples or less than one period; [`SignalError::Parameter`] for a
    /// period below 3; [`SignalError::NotExcited`] where no bin is left; [`SignalError::LengthMismatch`],
    /// [`SignalError::NonFinite`], [`SignalError::SampleTime`].
    pub fn estimate(self, input: &[f64], output: &[f64], sample_time_s: f64) -> Result<FrequencyResponse, SignalError> {
        let length = check_records(&[input, output], sample_time_s)?;
        check_at_least(3, length)?;
        let period = self.period.unwrap_or(length);
        check_range("period", period as f64, 3.0, f64::MAX)?;
        check_at_least(period, length)?;
        let transform = |x: &[f64]| fft_real(&fold(&x[length % period..], period));
        let (u, y) = (transform(input)?, transform(output)?);
        let bins = 1..=(period - 1) / 2;
        let strongest = u.iter().map(|v| v.norm_sqr()).fold(0.0, f64::max);
        let mut found = FrequencyResponse::empty(1, 1);
        for k in work::checked(bins.clone()) {
            let window = k.saturating_sub(self.half_width).max(1)..=k.saturating_add(self.half_width).min(*bins.end());
            let sums = Sums::over(window.map(|i| (self.weight(i.abs_diff(k)), u[i], y[i])));
            if sums.input > NO_POWER * strongest {
                found.freq_hz.push(k as f64 / (period as f64 * sample_time_s));
                found.response.push(sums.cross / sums.input);
                found.variance.push(sums.variance());
                found.degrees_of_freedom.push(sums.degrees_of_freedom());
            }
        }
        if found.freq_hz.is_empty() {
            return Err(SignalError::NotExcited { freq_hz: 1.0 / (period as f64 * sample_time_s) });
        }
        Ok(found)
    }

    fn weight(self, distance: usize) -> f64 {
        0.5 + 0.5 * (PI * distance as f64 / (self.half_width as f64 + 1.0)).cos()
    }
}

/// The sum over periods.
fn fold(x: &[f64], period: usize) -> Vec<f64> {
    let mut sum = vec![0.0; period];
    for cycle in x.chunks_exact(period) {
        sum.iter_mut().zip(cycle).for_each(|(s, v)| *s += v);
    }
    sum
}

/// Weighted sums over a window of bins.
#[derive(Default)]
struct Sums {
    weight: f64,
    squared_weight: f64,
    input: f64,
    output: f64,
    cross: Complex64,
    input_squared_weight: f64,
}

impl Sums {
    fn over(bins: impl Iterator<Item = (f64, Complex64, Complex64)>) -> Self {
        bins.fold(Self::default(), |mut sums, (w, u, y)| {
            sums.weight += w;
            sums.squared_weight += w * w;
            sums.input += w * u.norm_sqr();
            sums.output += w * y.norm_sqr();
            sums.cross += w * y * u.conj();
            sums.input_squared_weight += w * w * u.norm_sqr();
            sums
        })
    }

    /// Two for each independent bin, `(Σ w)²/Σ w²` of them, but the one that the response took.
    fn degrees_of_freedom(&self) -> f64 {
        2.0 * (self.weight * self.weight / self.squared_weight - 1.0)
    }

    /// `σ² Σ w²|U|² / (Σ w|U|²)²`, `σ²` from the weighted residuals, whose expectation is
    /// `σ² (Σ w − Σ w²|U|²/Σ w|U|²)`. NaN where nothing is left to judge by.
    fn variance(&self) -> f64 {
        let freedom = self.weight - self.input_squared_weight / self.input;
        let unexplained = (self.output - self.cross.norm_sqr() / self.input).max(0.0);
        if freedom > 1e-9 * self.weight {
            unexplained / freedom * self.input_squared_weight / (self.input * self.input)
        } else {
            f64::NAN
        }
    }
}
