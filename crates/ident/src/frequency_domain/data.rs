//! Measured frequency responses and spectra with their noise.

use signal::Complex64;

use crate::{Dataset, IdentError};

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

impl SpectralData {
    /// Means and sample (co)variances of one input and one output over the whole periods of the first experiment, at the
    /// given harmonics of one over the period.
    ///
    /// # Errors
    /// [`IdentError::TooFewSamples`] for fewer than six periods (variances from fewer say too little),
    /// [`IdentError::Missing`] for a gap, [`IdentError::Structure`] for a channel or harmonic that does not exist.
    ///
    /// # Source
    /// Pintelon & Schoukens 2012, (2-31)–(2-33): sample means and noise (co)variances over periods.
    pub fn from_periods(
        data: &Dataset,
        (output, input): (usize, usize),
        period: usize,
        harmonics: &[usize],
    ) -> Result<Self, IdentError> {
        if input >= data.inputs() || output >= data.outputs() {
            return Err(IdentError::Structure { what: "no such channel" });
        }
        if harmonics.iter().any(|k| *k == 0 || 2 * k >= period) {
            return Err(IdentError::Structure { what: "harmonics must lie between zero and half the sample rate" });
        }
        let experiment = data.experiments().first().ok_or(IdentError::Structure { what: "no experiment" })?;
        let (u, y) = (experiment.input(input), experiment.output(output));
        let averages = y.len() / period.max(1);
        if averages < 6 {
            return Err(IdentError::TooFewSamples { samples: y.len(), parameters: 6 * period });
        }
        let (u, y) = (by_period("an input", u, period)?, by_period("an output", y, period)?);
        let omega = std::f64::consts::TAU / (period as f64 * data.sample_time_s());
        let mut spectra = SpectralData {
            omega_rad_s: harmonics.iter().map(|k| omega * *k as f64).collect(),
            input: Vec::new(),
            output: Vec::new(),
            input_variance: Vec::new(),
            output_variance: Vec::new(),
            covariance: Vec::new(),
            averages: Some(averages),
        };
        harmonics.iter().for_each(|k| spectra.push_line(&u, &y, *k));
        Ok(spectra)
    }

    fn push_line(&mut self, u: &[Vec<Complex64>], y: &[Vec<Complex64>], k: usize) {
        let count = u.len() as f64;
        let mean = |x: &[Vec<Complex64>]| x.iter().map(|p| p[k]).sum::<Complex64>() / count;
        let (mean_u, mean_y) = (mean(u), mean(y));
        let of_mean = 1.0 / (count * (count - 1.0));
        let spread =
            |x: &[Vec<Complex64>], m: Complex64| of_mean * x.iter().map(|p| (p[k] - m).norm_sqr()).sum::<f64>();
        let both = u.iter().zip(y).map(|(u, y)| (y[k] - mean_y) * (u[k] - mean_u).conj());
        self.covariance.push(both.sum::<Complex64>() * of_mean);
        self.input_variance.push(spread(u, mean_u));
        self.output_variance.push(spread(y, mean_y));
        self.input.push(mean_u);
        self.output.push(mean_y);
    }
}

/// The spectrum of each whole period, divided by the number of samples.
fn by_period(what: &'static str, x: &[f64], period: usize) -> Result<Vec<Vec<Complex64>>, IdentError> {
    if let Some(index) = x.iter().position(|v| v.is_nan()) {
        return Err(IdentError::Missing { what, index });
    }
    let transform = |part: &[f64]| -> Result<Vec<Complex64>, IdentError> {
        Ok(signal::spectrum::fft_real(part)?.into_iter().map(|v| v / period as f64).collect())
    };
    x.chunks_exact(period).map(transform).collect()
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
}

/// Data that a model in the frequency domain can be fitted to.
pub trait Measured {
    /// The lines, checked.
    ///
    /// # Errors
    /// [`IdentError::Length`] where the fields differ in length, [`IdentError::NotFinite`], [`IdentError::Structure`] for
    /// a variance that is not positive or fewer than six averages.
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
        check((0..count).map(line).collect(), self.averages)
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
            let what = "every frequency needs an input, a positive variance, and may not be negative";
            return Err(IdentError::Structure { what });
        }
        // Equality is a correlation of one: noise that the input brought and the system passed on.
        if l.cov_yu.norm_sqr() > (1.0 + 1e-9) * l.var_u * l.var_y {
            return Err(IdentError::Structure { what: "a covariance is larger than its variances allow" });
        }
    }
    if averages.is_some_and(|n| n < 6) {
        return Err(IdentError::Structure { what: "variances from fewer than six averages say too little" });
    }
    Ok(Lines { lines, averages })
}

impl Lines {
    /// What sample variances in place of true ones multiply the expected cost, its variance a line, and the covariance of
    /// the parameters by: `|e|²/σ̂²` is distributed as F(2, 2ν), ν being the averages less one.
    pub(crate) fn inflation(&self) -> (f64, f64, f64) {
        let Some(averages) = self.averages else {
            return (1.0, 1.0, 1.0);
        };
        let v = averages as f64 - 1.0;
        (v / (v - 1.0), v.powi(3) / ((v - 1.0).powi(2) * (v - 2.0)), v / (v - 2.0))
    }
}
