//! Spectral analysis after Blackman and Tukey: smoothed spectra from windowed correlations.

use std::f64::consts::{PI, TAU};

use super::least_squares::LeastSquares;
use super::{FrequencyResponse, check_records};
use crate::Complex64;
use crate::correlation::{cross_correlation, is_constant};
use crate::error::{SignalError, check_at_least, check_range};
use crate::series::mean;
use crate::spectrum::PowerSpectrum;

/// Frequency response and noise spectrum from correlations under a Hann lag window `w` of width `M`:
/// `Φ̂(f) = T Σ_{|τ|≤M} w(τ) R̂(τ) e^{−j2πfτT}`, `Ĝ = Φ̂_uy/Φ̂_u`, `Φ̂_v = Φ̂_y − |Φ̂_uy|²/Φ̂_u` (matrices for several
/// inputs).
///
/// A larger `M` resolves more (about `1/(M·T)` hertz) and scatters more: the variance grows with `M/N`. Means are
/// removed. Without an input the noise spectrum is that of the output.
///
/// # Example
/// ```
/// use signal::excitation::{Random, Timing, held_noise};
/// use signal::frf::BlackmanTukey;
/// let u = held_noise(&mut Random::new(1), Timing { sample_time_s: 0.1, length: 5000 }, 0.0, 1.0, 0.1)?;
/// let y: Vec<f64> = (0..5000).map(|t| if t == 0 { 0.0 } else { 2.0 * u.samples[t - 1] }).collect();
/// let found = BlackmanTukey::new(30).estimate(&[&u.samples], &y, 0.1)?;
/// assert!((found.response.response[20].norm() - 2.0).abs() < 0.02);
/// # Ok::<(), signal::SignalError>(())
/// ```
///
/// # Source
/// Ljung, L. (1999), *System Identification*, §6.4: (6.45) to (6.51), (6.58) to (6.60).
#[derive(Debug, Clone, PartialEq)]
pub struct BlackmanTukey {
    /// Width `M` of the lag window, in samples.
    pub lags: usize,
    /// Frequencies in hertz, from zero to half the sample rate; none means 128 even steps up to half the sample rate.
    pub freqs_hz: Vec<f64>,
}

/// Result of [`BlackmanTukey`].
#[derive(Debug, Clone, PartialEq)]
pub struct SpectralAnalysis {
    /// The response and its variance `W Φ̂_v [Φ̂_u⁻¹]_jj / N`, `W = Σ w²`.
    pub response: FrequencyResponse,
    /// One-sided power density of the noise on the output, at the same frequencies, freed of what the inputs explain by
    /// chance (`1 − nu·W/N`).
    pub noise: PowerSpectrum,
}

const DEFAULT_STEPS: u32 = 128;

impl BlackmanTukey {
    /// A window of this width, at the default frequencies.
    #[must_use]
    pub fn new(lags: usize) -> Self {
        Self { lags, freqs_hz: vec![] }
    }

    /// The estimate from inputs, none or more, and one output.
    ///
    /// Frequencies where the inputs do not determine the response are left out.
    ///
    /// # Errors
    /// [`SignalError::Parameter`] for less than two lags or a frequency out of range; [`SignalError::TooShort`] where
    /// the record is not longer than the lags, or too short for so many inputs and lags; [`SignalError::NotExcited`]
    /// where no frequency is left; [`SignalError::LengthMismatch`], [`SignalError::NonFinite`],
    /// [`SignalError::SampleTime`].
    pub fn estimate(
        &self,
        inputs: &[&[f64]],
        output: &[f64],
        sample_time_s: f64,
    ) -> Result<SpectralAnalysis, SignalError> {
        let channels = [inputs, &[output]].concat();
        let length = check_records(&channels, sample_time_s)?;
        check_range("lags", self.lags as f64, 2.0, 1e9)?;
        check_at_least(self.lags + 1, length)?;
        let nyquist_hz = 0.5 / sample_time_s;
        for &freq_hz in &self.freqs_hz {
            check_range("freqs_hz", freq_hz, 0.0, nyquist_hz)?;
        }
        let window = lag_window(self.lags);
        let energy: f64 = window.iter().map(|w| w * w).sum();
        let left = 1.0 - inputs.len() as f64 * energy / length as f64;
        if left <= 0.0 {
            return Err(SignalError::TooShort { needed: (inputs.len() as f64 * energy) as usize + 1, got: length });
        }
        let steps = (1..=DEFAULT_STEPS).map(|k| nyquist_hz * f64::from(k) / f64::from(DEFAULT_STEPS));
        let freqs_hz = if self.freqs_hz.is_empty() { steps.collect() } else { self.freqs_hz.clone() };
        let analysis = Analysis {
            products: products(&channels, &window)?,
            inputs: inputs.len(),
            variance: energy / length as f64,
            left,
            window,
            sample_time_s,
        };
        analysis.at(&freqs_hz)
    }
}

/// `w(τ) = (1 + cos(πτ/M))/2`, `τ = −M ..= M`.
fn lag_window(lags: usize) -> Vec<f64> {
    let width = lags as f64;
    (0..=2 * lags).map(|i| 0.5 + 0.5 * (PI * (i as f64 - width) / width).cos()).collect()
}

/// Windowed correlations of each channel with itself and those after it, row by row.
fn products(channels: &[&[f64]], window: &[f64]) -> Result<Vec<Vec<f64>>, SignalError> {
    let centred = |x: &&[f64]| {
        if is_constant(x) {
            return vec![0.0; x.len()];
        }
        let level = mean(x).unwrap_or(0.0);
        x.iter().map(|v| v - level).collect::<Vec<f64>>()
    };
    let channels: Vec<Vec<f64>> = channels.iter().map(centred).collect();
    let mut products = Vec::new();
    for (a, x) in channels.iter().enumerate() {
        for y in &channels[a..] {
            let correlation = cross_correlation(x, y, window.len() / 2)?;
            products.push(correlation.values.iter().zip(window).map(|(r, w)| r * w).collect());
        }
    }
    Ok(products)
}

struct Analysis {
    products: Vec<Vec<f64>>,
    inputs: usize,
    /// `W/N`.
    variance: f64,
    /// `1 − nu·W/N`.
    left: f64,
    window: Vec<f64>,
    sample_time_s: f64,
}

impl Analysis {
    fn at(&self, freqs_hz: &[f64]) -> Result<SpectralAnalysis, SignalError> {
        let inputs = self.inputs;
        let mut response = FrequencyResponse::empty(1, inputs);
        let (mut density, mut degrees_of_freedom) = (vec![], vec![]);
        let mut problem = LeastSquares::new(inputs, inputs);
        for &freq_hz in freqs_hz {
            work::checkpoint();
            let spectra = self.spectra(freq_hz);
            let Some((row, factors)) = self.solve(&mut problem, &spectra) else { continue };
            let output = self.inputs;
            let explained: f64 = row.iter().enumerate().map(|(j, g)| (g * spectra(j, output).conj()).re).sum();
            let noise = (spectra(output, output).re - explained).max(0.0) / self.left;
            response.freq_hz.push(freq_hz);
            response.response.extend_from_slice(&row);
            response.variance.extend(factors.iter().map(|f| self.variance * noise * f));
            density.push(noise);
            degrees_of_freedom.push(self.degrees_of_freedom(freq_hz));
        }
        match (response.freq_hz.is_empty(), freqs_hz.first()) {
            (true, Some(&freq_hz)) => Err(SignalError::NotExcited { freq_hz }),
            _ => {
                response.degrees_of_freedom.clone_from(&degrees_of_freedom);
                let noise = PowerSpectrum { freq_hz: response.freq_hz.clone(), density, degrees_of_freedom };
                Ok(SpectralAnalysis { response, noise })
            }
        }
    }

    /// The one-sided cross density of channels `a` and `b` (means of `conj(A)·B`) at a frequency.
    fn spectra(&self, freq_hz: f64) -> impl Fn(usize, usize) -> Complex64 {
        let channels = self.inputs + 1;
        let lags = self.window.len() / 2;
        let turn = |i: usize| Complex64::cis(-TAU * freq_hz * self.sample_time_s * (i as f64 - lags as f64));
        let turns: Vec<Complex64> = (0..self.window.len()).map(turn).collect();
        let sum = |r: &Vec<f64>| r.iter().zip(&turns).map(|(r, z)| z * r).sum::<Complex64>() * 2.0 * self.sample_time_s;
        let values: Vec<Complex64> = self.products.iter().map(sum).collect();
        let index = move |a: usize, b: usize| a * channels - a * a.saturating_sub(1) / 2 + b - a;
        move |a, b| if a <= b { values[index(a, b)] } else { values[index(b, a)].conj() }
    }

    /// The response's row and the diagonal of the inverse of the inputs' spectra.
    fn solve(
        &self,
        problem: &mut LeastSquares,
        spectra: &impl Fn(usize, usize) -> Complex64,
    ) -> Option<(Vec<Complex64>, Vec<f64>)> {
        problem.clear();
        for j in 0..self.inputs {
            if spectra(j, j).re <= 0.0 || !problem.push((0..self.inputs).map(|i| spectra(i, j))) {
                return None;
            }
        }
        let (mut row, mut column) = (Vec::new(), Vec::new());
        let mut right: Vec<Complex64> = (0..self.inputs).map(|i| spectra(i, self.inputs)).collect();
        problem.solve(&mut right, &mut row);
        let mut factors = Vec::with_capacity(self.inputs);
        for j in 0..self.inputs {
            let mut unit = vec![Complex64::ZERO; self.inputs];
            unit[j].re = 1.0;
            problem.solve(&mut unit, &mut column);
            factors.push(column[j].re);
        }
        factors.iter().all(|f| *f > 0.0).then_some((row, factors))
    }

    /// `2N/W` less two for each input, down to half of it at zero and at half the sample rate, where the transform is
    /// real; in between as for white noise.
    fn degrees_of_freedom(&self, freq_hz: f64) -> f64 {
        let lags = self.window.len() / 2;
        let angle = 2.0 * TAU * freq_hz * self.sample_time_s;
        let real = |(i, w): (usize, &f64)| w * w * (angle * (i as f64 - lags as f64)).cos();
        let energy: f64 = self.window.iter().map(|w| w * w).sum();
        let realness = self.window.iter().enumerate().map(real).sum::<f64>() / energy;
        2.0 * self.left / self.variance / (1.0 + realness)
    }
}
