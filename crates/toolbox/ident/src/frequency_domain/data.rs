//! Measured frequency responses and spectra with their noise.

use std::f64::consts::TAU;

use signal::Complex64;
use signal::frf::{FrequencyResponse, LocalEstimate, PeriodicSpectra, periodic_spectra};

use super::shared_noise::SharedNoise;
use crate::{ChannelPair, Dataset, IdentError};
use fitting::StructureError;

/// A measured frequency response: gains with the variance of each.
#[derive(Debug, Clone, PartialEq)]
pub struct FrequencyData {
    /// Angular frequencies, in rad/s.
    pub omega_rad_s: Vec<f64>,
    /// The gain at each.
    pub response: Vec<Complex64>,
    /// E|error|² of each gain: the sum of the variances of real and imaginary part.
    pub variance: Vec<f64>,
    /// Periods or averages that the variances were computed from; `None` where they are known exactly.
    pub averages: Option<usize>,
    /// Noise that the errors of several gains have in common; `None` where they are independent.
    pub shared_noise: Option<SharedNoise>,
}

/// Spectra of an input and an output under a periodic excitation, with the noise on both: means over periods, and
/// variances of the means.
#[derive(Debug, Clone, PartialEq)]
pub struct SpectralData {
    /// Angular frequencies, in rad/s.
    pub omega_rad_s: Vec<f64>,
    /// Spectrum of the input at each.
    pub input: Vec<Complex64>,
    /// Spectrum of the output at each, in the same normalisation.
    pub output: Vec<Complex64>,
    /// E|n_u|².
    pub input_variance: Vec<f64>,
    /// E|n_y|².
    pub output_variance: Vec<f64>,
    /// E n_y n_u*.
    pub covariance: Vec<Complex64>,
    /// Periods that the variances were computed from; `None` where they are known exactly.
    pub averages: Option<usize>,
}

impl FrequencyData {
    /// One channel of an estimated response; `averages` is what its variances were computed from, such as
    /// the periods of [`signal::frf::periodic_spectra`].
    ///
    /// # Errors
    /// [`IdentError::Structure`] for a channel that does not exist.
    pub fn of_response(
        response: &FrequencyResponse,
        ChannelPair { output, input }: ChannelPair,
        averages: Option<usize>,
    ) -> Result<Self, IdentError> {
        check_channel(ChannelPair { output, input }, response.inputs, response.outputs)?;
        Ok(FrequencyData {
            omega_rad_s: response.freq_hz.iter().map(|f| TAU * f).collect(),
            response: response.response_of(output, input),
            variance: response.variance_of(output, input),
            averages,
            shared_noise: None,
        })
    }

    /// One channel of a local polynomial or rational estimate. Estimates closer than a window come from the same noise:
    /// the covariance of what is fitted to them contains that.
    ///
    /// # Errors
    /// Those of [`FrequencyData::of_response`].
    ///
    /// # Example
    /// ```
    /// use ident::{FrequencyData, FrequencyTransferFunction};
    /// use signal::frf::LocalModel;
    /// let mut random = signal::excitation::Random::new(1);
    /// let u: Vec<f64> = (0..2000).map(|_| random.normal()).collect();
    /// // y(t) = 0.8 y(t−1) + u(t−1), measured with noise.
    /// let mut x = vec![0.0; 2000];
    /// (1..2000).for_each(|t| x[t] = 0.8 * x[t - 1] + u[t - 1]);
    /// let y: Vec<f64> = x.iter().map(|x| x + 0.1 * random.normal()).collect();
    /// let local = LocalModel::polynomial(2, 1).estimate(&[&u], &[&y], 0.1)?;
    /// let data = FrequencyData::of_local(&local, ident::ChannelPair { output: 0, input: 0 })?;
    /// let fit = FrequencyTransferFunction::discrete(0, 1, 0.1).fit(&data)?;
    /// let pole = fit.fit.model.transfer_function()?.den()[1];
    /// assert!((pole + 0.8).abs() < 0.01);
    /// # Ok::<(), ident::IdentError>(())
    /// ```
    pub fn of_local(estimate: &LocalEstimate, channel: ChannelPair) -> Result<Self, IdentError> {
        let data = Self::of_response(&estimate.response, channel, Some(estimate.degrees_of_freedom + 1))?;
        Ok(FrequencyData { shared_noise: Some(SharedNoise::of_local(estimate, channel)), ..data })
    }

    /// The gains from one angular frequency to another, both in rad/s.
    #[must_use]
    pub fn within(&self, low_rad_s: f64, high_rad_s: f64) -> Self {
        let chosen: Vec<usize> =
            (0..self.omega_rad_s.len()).filter(|k| (low_rad_s..=high_rad_s).contains(&self.omega_rad_s[*k])).collect();
        FrequencyData {
            omega_rad_s: chosen.iter().map(|k| self.omega_rad_s[*k]).collect(),
            response: chosen.iter().map(|k| self.response[*k]).collect(),
            variance: chosen.iter().map(|k| self.variance[*k]).collect(),
            averages: self.averages,
            shared_noise: self.shared_noise.as_ref().map(|shared| shared.of(&chosen)),
        }
    }
}

impl SpectralData {
    /// One input and one output of mean spectra over periods, by their places among all channels.
    ///
    /// # Errors
    /// [`IdentError::Structure`] for a channel that does not exist.
    pub fn of_spectra(
        spectra: &PeriodicSpectra,
        ChannelPair { output, input }: ChannelPair,
    ) -> Result<Self, IdentError> {
        let channels = spectra.channels;
        check_channel(ChannelPair { output, input }, channels, channels)?;
        let lines = 0..spectra.freq_hz.len();
        let mean = |c: usize| lines.clone().map(|k| spectra.mean[k * channels + c]).collect();
        let covariance = |a: usize, b: usize| {
            let at = move |k: usize| spectra.covariance[(k * channels + a) * channels + b];
            lines.clone().map(at)
        };
        Ok(SpectralData {
            omega_rad_s: spectra.freq_hz.iter().map(|f| TAU * f).collect(),
            input: mean(input),
            output: mean(output),
            input_variance: covariance(input, input).map(|v| v.re).collect(),
            output_variance: covariance(output, output).map(|v| v.re).collect(),
            covariance: covariance(output, input).collect(),
            averages: Some(spectra.periods),
        })
    }

    /// [`SpectralData::of_spectra`] of one input and one output over the last whole periods of the first
    /// experiment, at the given harmonics of one over the period; at all where none are given.
    ///
    /// # Errors
    /// [`IdentError::TooFewSamples`] for fewer than six periods (variances from fewer say too little),
    /// [`IdentError::Missing`] for a gap, [`IdentError::Structure`] for a channel that does not exist,
    /// [`signal::SignalError::Parameter`] for a harmonic that does not.
    ///
    /// # Source
    /// Pintelon & Schoukens 2012, (2-31)–(2-33): sample means and noise (co)variances over periods.
    pub fn from_periods(
        data: &Dataset,
        ChannelPair { output, input }: ChannelPair,
        period: usize,
        harmonics: &[usize],
    ) -> Result<Self, IdentError> {
        check_channel(ChannelPair { output, input }, data.inputs(), data.outputs())?;
        let experiment = data.experiments().first().ok_or(StructureError::NoExperiment)?;
        let (u, y) = (experiment.input(input), experiment.output(output));
        if y.len() / period.max(1) < 6 {
            return Err(IdentError::TooFewSamples { samples: y.len(), parameters: period.saturating_mul(6) });
        }
        for (what, x) in [("an input", u), ("an output", y)] {
            if let Some(index) = x.iter().position(|v| v.is_nan()) {
                return Err(IdentError::Missing { what, index });
            }
        }
        let spectra = periodic_spectra(&[u, y], period, data.sample_time_s(), harmonics)?;
        Self::of_spectra(&spectra, ChannelPair { output: 1, input: 0 })
    }
}

/// One frequency: `Y − G U` is known to have the variance `σ_y² + |G|² σ_u² − 2 Re(G* σ_yu)`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Line {
    pub(crate) omega: f64,
    pub(crate) u: Complex64,
    pub(crate) y: Complex64,
    pub(crate) var_u: f64,
    pub(crate) var_y: f64,
    pub(crate) cov_yu: Complex64,
}

impl Line {
    /// Variance of `D Y − N U`.
    pub(crate) fn variance(&self, n: Complex64, d: Complex64) -> f64 {
        let cross = 2.0 * (d * n.conj() * self.cov_yu).re;
        d.norm_sqr() * self.var_y + n.norm_sqr() * self.var_u - cross
    }
}

/// Lines with what their variances rest on.
#[derive(Debug, Clone)]
pub struct Lines {
    pub(crate) lines: Vec<Line>,
    pub(crate) averages: Option<usize>,
    pub(crate) shared_noise: Option<SharedNoise>,
}

/// Data that a model in the frequency domain can be fitted to.
pub trait Measured {
    /// The lines, checked.
    ///
    /// # Errors
    /// [`IdentError::Length`] where the fields differ in length, [`IdentError::NotFinite`], [`IdentError::Structure`]
    /// for a variance that is not positive or fewer than six averages.
    fn lines(&self) -> Result<Lines, IdentError>;
}

impl Measured for FrequencyData {
    fn lines(&self) -> Result<Lines, IdentError> {
        let count = self.omega_rad_s.len();
        check_lengths(count, &[self.response.len(), self.variance.len()])?;
        let line = |k: usize| Line {
            omega: self.omega_rad_s[k],
            u: Complex64::new(1.0, 0.0),
            y: self.response[k],
            var_u: 0.0,
            var_y: self.variance[k],
            cov_yu: Complex64::default(),
        };
        let lines = check((0..count).map(line).collect(), self.averages)?;
        if let Some(shared) = &self.shared_noise {
            check_lengths(count, &[shared.first.len(), shared.weights.len()])?;
        }
        Ok(Lines { shared_noise: self.shared_noise.clone(), ..lines })
    }
}

impl Measured for SpectralData {
    fn lines(&self) -> Result<Lines, IdentError> {
        let count = self.omega_rad_s.len();
        let variances = [self.input_variance.len(), self.output_variance.len(), self.covariance.len()];
        check_lengths(count, &variances)?;
        check_lengths(count, &[self.input.len(), self.output.len()])?;
        let line = |k: usize| Line {
            omega: self.omega_rad_s[k],
            u: self.input[k],
            y: self.output[k],
            var_u: self.input_variance[k],
            var_y: self.output_variance[k],
            cov_yu: self.covariance[k],
        };
        check((0..count).map(line).collect(), self.averages)
    }
}

fn check_channel(channel: ChannelPair, inputs: usize, outputs: usize) -> Result<(), IdentError> {
    let ChannelPair { output, input } = channel;
    if input < inputs && output < outputs {
        return Ok(());
    }
    Err(StructureError::NoChannel { output, input, outputs, inputs }.into())
}

fn check_lengths(expected: usize, found: &[usize]) -> Result<(), IdentError> {
    match found.iter().find(|n| **n != expected) {
        Some(found) => Err(IdentError::Length { what: "values at the frequencies", expected, found: *found }),
        None => Ok(()),
    }
}

fn check(lines: Vec<Line>, averages: Option<usize>) -> Result<Lines, IdentError> {
    for (index, l) in lines.iter().enumerate() {
        let numbers = [l.omega, l.u.re, l.u.im, l.y.re, l.y.im, l.var_u, l.var_y, l.cov_yu.re, l.cov_yu.im];
        if numbers.iter().any(|v| !v.is_finite()) {
            return Err(IdentError::NotFinite { what: "the frequency data", index });
        }
        if l.omega < 0.0 || l.var_u < 0.0 || l.var_y < 0.0 || l.var_u + l.var_y == 0.0 || l.u == Complex64::default() {
            return Err(StructureError::Frequency { index }.into());
        }
        // Equality is a correlation of one: noise that the input brought and the system passed on.
        if l.cov_yu.norm_sqr() > (1.0 + 1e-9) * l.var_u * l.var_y {
            return Err(StructureError::CovarianceTooLarge { index }.into());
        }
    }
    if let Some(found) = averages.filter(|n| *n < 6) {
        return Err(StructureError::TooFew { what: "averages behind the variances", found, least: 6 }.into());
    }
    Ok(Lines { lines, averages, shared_noise: None })
}

impl Lines {
    /// Factors of sample variances in place of true ones: on the expected cost, its variance a line, and the covariance
    /// of the parameters. `|e|²/σ̂²` is distributed as F(2, 2ν), ν being the averages less one.
    pub(crate) fn inflation(&self) -> (f64, f64, f64) {
        let Some(averages) = self.averages else {
            return (1.0, 1.0, 1.0);
        };
        let v = averages as f64 - 1.0;
        (v / (v - 1.0), v.powi(3) / ((v - 1.0).powi(2) * (v - 2.0)), v / (v - 2.0))
    }
}
