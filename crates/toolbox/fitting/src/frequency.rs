//! Continuous-time models from sampled records, in the frequency domain, with noise on every signal.
//!
//! A linear differential equation Σ_i P_i(p) x_i(t) = 0 (p = d/dt) between signals that were each sampled on a clock of
//! their own is multiplied by a smooth window h that vanishes at both ends together with its derivatives, and
//! transformed. Integration by parts moves every derivative from the data to the window, so initial conditions, leakage
//! and numerical differentiation do not arise, and no signal needs resampling:
//!
//! L_n{x}(s) = ∫ h x⁽ⁿ⁾ e^{−st} dt = Σ_m (n over m) (−1)^m s^{n−m} ∫ h⁽ᵐ⁾ x e^{−st} dt,  s = jω.
//!
//! A delay is e^{−sδ} only as far as the window does not change over δ. Where that matters, date the signals by a first
//! estimate of their delays and fit what is left.
//!
//! # Source
//! Shinbrot, *On the analysis of linear and nonlinear systems*, 1957 (modulating functions); Pintelon & Schoukens 2012,
//! ch. 9 (errors in variables, maximum likelihood).

use std::f64::consts::{PI, TAU};

use faer::MatMut;
use signal::resample::{Interpolation, interpolate_at};
use signal::{Complex64, Signal};

use crate::{Bounds, IdentError, Minimum, NonlinearOptions, ResidualModel, minimise};

/// Highest order of derivative used.
pub const ORDERS: usize = 3;

/// Part of the window at each end in which it rises from zero and falls again. A short rise leaves the data their
/// weight; a long one keeps what is not in the equation, such as lines of sensors, together.
const TAPER: f64 = 0.2;

/// ∫h²/T: a rise sin²(πx/2), 0 < x < 1, has 3/8 of what it would have at one.
const ENERGY: f64 = 1.0 - 2.0 * TAPER * (1.0 - 3.0 / 8.0);

/// Correlation of neighbouring bins under the window h: T ∫h⁴/(∫h²)². The information in n bins is that of n over this
/// number.
pub const OVERLAP: f64 = (1.0 - 2.0 * TAPER * (1.0 - 35.0 / 128.0)) / (ENERGY * ENERGY);

/// Bins over which the window spreads a line, each way.
const REACH: usize = 4;

/// Errors this small beside the stated noise are those of the arithmetic; a prior keeps some weight beside them.
const SMALLEST_SCALE: f64 = 1e-12;

/// A window may differ from a whole number of samples by this part of one.
const EVEN: f64 = 1e-3;

/// The stretch of time that is transformed, and its frequencies k/T.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Window {
    /// Start, s.
    pub start_s: f64,
    /// Length T, s.
    pub duration_s: f64,
}

impl Window {
    /// Frequency of bin `k`, Hz.
    pub fn frequency_hz(&self, k: usize) -> f64 {
        k as f64 / self.duration_s
    }

    /// Bins from `low_hz` to `high_hz`.
    pub fn bins(&self, low_hz: f64, high_hz: f64) -> std::ops::RangeInclusive<usize> {
        let first = (low_hz * self.duration_s).ceil().max(1.0) as usize;
        first..=(high_hz * self.duration_s).floor() as usize
    }

    /// ∫h² dt, s: what turns the variance of white samples, times their sample time, into that of a bin.
    pub fn energy_s(&self) -> f64 {
        ENERGY * self.duration_s
    }
}

/// L_0, L_1, L_2 of one signal at bins 0…`bins`.
#[derive(Debug, Clone, PartialEq)]
pub struct Modulated {
    /// `orders[n][k]` is L_n at bin k.
    pub orders: [Vec<Complex64>; ORDERS],
}

impl Modulated {
    /// Transforms `signal` over `window`, up to bin `last_bin`.
    ///
    /// The signal's mean over the window is removed first: of a constant, hardly anything is left beyond the lowest
    /// bins.
    ///
    /// # Errors
    /// The signal does not cover the window, or `last_bin` is beyond its Nyquist frequency.
    pub fn new(signal: &Signal, window: Window, last_bin: usize) -> Result<Self, IdentError> {
        let Samples { values, offset_s: offset, sample_time_s: dt } = samples_in(signal, window)?;
        let count = values.len();
        if 2 * last_bin >= count {
            return Err(IdentError::TooFewSamples { samples: count, parameters: 2 * last_bin });
        }
        let mean = values.iter().sum::<f64>() / count as f64;
        let windowed = window_derivatives(offset / window.duration_s, dt / window.duration_s, count, window.duration_s);
        let turning = turning(0.0, -offset / window.duration_s, last_bin + 1);
        let moment = |order: usize| -> Result<Vec<Complex64>, IdentError> {
            let weigh = |(value, windowed): (&f64, &[f64; ORDERS])| dt * (value - mean) * windowed[order];
            let weighted: Vec<f64> = values.iter().zip(&windowed).map(weigh).collect();
            let mut spectrum = signal::spectrum::fft_real(&weighted)?;
            spectrum.truncate(last_bin + 1);
            spectrum.iter_mut().zip(&turning).for_each(|(value, turning)| *value *= turning);
            Ok(spectrum)
        };
        let (h0, h1, h2) = (moment(0)?, moment(1)?, moment(2)?);
        let s = |k: usize| Complex64::new(0.0, TAU * window.frequency_hz(k));
        let first = (0..=last_bin).map(|k| s(k) * h0[k] - h1[k]).collect();
        let second = (0..=last_bin).map(|k| s(k) * (s(k) * h0[k] - 2.0 * h1[k]) + h2[k]).collect();
        Ok(Modulated { orders: [h0, first, second] })
    }

    /// The transform of a sum of signals.
    pub fn plus(mut self, other: &Modulated) -> Self {
        for (mine, theirs) in self.orders.iter_mut().zip(&other.orders) {
            mine.iter_mut().zip(theirs).for_each(|(a, b)| *a += b);
        }
        self
    }
}

/// A signal's samples inside a window.
#[derive(Debug, Clone, PartialEq)]
pub struct Samples {
    /// As many values as sample times fit into the window.
    pub values: Vec<f64>,
    /// Time of the first after the window's start, s.
    pub offset_s: f64,
    /// Time between two, s: the signal's own, or a whole part of the window where the two differ.
    pub sample_time_s: f64,
}

/// The samples of a signal in a window. A clock that does not divide the window evenly, because it drifts against that
/// of the other signals, is replaced by the nearest one that does, by band-limited interpolation.
///
/// # Errors
/// The signal does not cover the window.
pub fn samples_in(signal: &Signal, window: Window) -> Result<Samples, IdentError> {
    let dt = signal.sample_time_s;
    let count = (window.duration_s / dt).round().max(1.0) as usize;
    let part = signal.slice(window.start_s, window.start_s + (count as f64 + 1.0) * dt);
    let missing = IdentError::Length { what: "samples in the window", expected: count, found: part.len() };
    if (count as f64 * dt - window.duration_s).abs() <= EVEN * dt {
        let values = part.samples.get(..count).ok_or(missing)?.to_vec();
        return Ok(Samples { values, offset_s: part.start_s - window.start_s, sample_time_s: dt });
    }
    let sample_time_s = window.duration_s / count as f64;
    let times: Vec<f64> = (0..count).map(|i| window.start_s + i as f64 * sample_time_s).collect();
    let values = interpolate_at(signal, &times, Interpolation::BandLimited).map_err(|_| missing)?;
    Ok(Samples { values, offset_s: 0.0, sample_time_s })
}

/// h and its derivatives at so many instants of a window of length `duration_s`, given as parts of it: it rises as
/// sin²(πx/2) over the first [`TAPER`] of its length, is one, and falls over the last; neither it nor its slope jumps.
fn window_derivatives(first: f64, step: f64, count: usize, duration_s: f64) -> Vec<[f64; ORDERS]> {
    let (rate, end) = (PI / (TAPER * duration_s), Complex64::cis(PI / TAPER));
    let at = |(i, turning): (usize, Complex64)| {
        let position = first + i as f64 * step;
        let (edge, slope) = match position < 0.5 {
            true => (turning, turning.im),
            false => (end * turning.conj(), -(end * turning.conj()).im),
        };
        match position.min(1.0 - position) < TAPER {
            true => [0.5 * (1.0 - edge.re), 0.5 * rate * slope, 0.5 * rate * rate * edge.re],
            false => [1.0, 0.0, 0.0],
        }
    };
    turning(0.5 * first / TAPER, 0.5 * step / TAPER, count).into_iter().enumerate().map(at).collect()
}

/// A phasor from a number of turns on, so many more turns each time.
fn turning(first: f64, step: f64, count: usize) -> Vec<Complex64> {
    // Restarted now and then so that rounding does not build up.
    const STRAIGHT: usize = 64;
    let turn = Complex64::cis(TAU * step);
    let mut at = Complex64::ONE;
    let next = |k: usize| {
        at = if k.is_multiple_of(STRAIGHT) {
            Complex64::cis(TAU * (first + k as f64 * step).fract())
        } else {
            at * turn
        };
        at
    };
    (0..count).map(next).collect()
}

/// One signal of the equation: its transform, what the record holds beside it, and the noise on its samples.
#[derive(Debug, Clone, PartialEq)]
pub struct NoisySpectrum {
    /// Transform of the record.
    pub modulated: Modulated,
    /// Errors of known shape in the record, such as those of an encoder that repeat with its angle.
    pub errors: Vec<ShapedError>,
    /// Variance of white noise on the samples times their sample time: its spectral density.
    pub noise_density: f64,
}

/// An error of known shape and unknown size.
#[derive(Debug, Clone, PartialEq)]
pub struct ShapedError {
    /// Position of the parameter that is its size.
    pub parameter: usize,
    /// Transform of its shape.
    pub shape: Modulated,
}

impl NoisySpectrum {
    /// L_0, L_1, L_2 at one bin, without the errors of known shape.
    pub fn at(&self, theta: &[f64], bin: usize) -> [Complex64; ORDERS] {
        std::array::from_fn(|n| {
            let error = |e: &ShapedError| theta[e.parameter] * e.shape.orders[n][bin];
            self.modulated.orders[n][bin] - self.errors.iter().map(error).sum::<Complex64>()
        })
    }
}

/// The derivative of one signal's polynomial by one parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Slope {
    /// Position of the parameter.
    pub parameter: usize,
    /// Position of the signal.
    pub signal: usize,
    /// Derivatives of the coefficients of s⁰, s¹, s².
    pub by_order: [Complex64; ORDERS],
}

/// A linear differential equation Σ_i P_i(s, θ) x_i = 0.
pub trait Equation {
    /// Signals.
    const SIGNALS: usize;
    /// Parameters.
    const PARAMETERS: usize;

    /// Writes the coefficient of s^n of P_i at s = jω into `polynomials[i][n]`, and adds the derivatives that are not
    /// zero to `slopes`, which is empty, where these are wanted. Coefficients may themselves depend on s (delays,
    /// gates).
    fn coefficients(
        &self,
        s: Complex64,
        theta: &[f64],
        polynomials: &mut [[Complex64; ORDERS]],
        slopes: Option<&mut Vec<Slope>>,
    );
}

/// Knowledge of a parameter from elsewhere: value and standard uncertainty.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Prior {
    /// Position of the parameter.
    pub parameter: usize,
    /// Value.
    pub value: f64,
    /// Standard uncertainty.
    pub standard_uncertainty: f64,
}

/// Maximum likelihood under white noise of known relative level on every signal: minimises Σ_k |e_k|²/σ_k²(θ), with e
/// the equation's error and σ_k² = ∫h² Σ_i |P_i(jω_k, θ)|² S_i the variance the noise gives it.
#[derive(Debug)]
pub struct ErrorsInVariables<'a, E> {
    equation: &'a E,
    signals: &'a [NoisySpectrum],
    window: Window,
    bins: &'a [usize],
    priors: &'a [Prior],
    /// Weights that multiply the residual of each bin; all ones where empty.
    weights: &'a [f64],
    /// Mean of the squared residuals, which priors are weighed against: one where the noise levels are right.
    scale: f64,
    at_bin: AtBin,
}

/// The equation at one bin, and its derivatives by all parameters; reused from bin to bin.
#[derive(Debug)]
struct AtBin {
    /// The signals.
    records: Vec<[Complex64; ORDERS]>,
    polynomials: Vec<[Complex64; ORDERS]>,
    /// The polynomials at s.
    values: Vec<Complex64>,
    slopes: Vec<Slope>,
    /// Of the equation's error.
    error_slopes: Vec<Complex64>,
    /// Of its variance.
    variance_slopes: Vec<f64>,
}

impl AtBin {
    fn new(signals: usize, parameters: usize) -> Self {
        let zeros = vec![[Complex64::ZERO; ORDERS]; signals];
        AtBin {
            records: zeros.clone(),
            polynomials: zeros,
            values: vec![Complex64::ZERO; signals],
            slopes: Vec::new(),
            error_slopes: vec![Complex64::ZERO; parameters],
            variance_slopes: vec![0.0; parameters],
        }
    }
}

/// The estimate, with a covariance that counts overlapping bins once.
#[derive(Debug, Clone, PartialEq)]
pub struct FrequencyFit {
    /// The minimum. Residuals come in pairs, real and imaginary part, one a bin; priors follow.
    pub fit: Minimum,
    /// Covariance of the parameters.
    pub covariance: faer::Mat<f64>,
    /// Degrees of freedom of the scale.
    pub degrees_of_freedom: f64,
    /// Mean of |e|²/σ², freed of what the parameters take up: one where model and noise levels are right.
    pub scale: f64,
    /// |e|/σ at each bin.
    pub normalised: Vec<f64>,
}

impl<'a, E: Equation> ErrorsInVariables<'a, E> {
    /// The problem on the given bins.
    pub fn new(
        equation: &'a E,
        signals: &'a [NoisySpectrum],
        window: Window,
        bins: &'a [usize],
        priors: &'a [Prior],
    ) -> Self {
        let at_bin = AtBin::new(E::SIGNALS, E::PARAMETERS);
        ErrorsInVariables { equation, signals, window, bins, priors, weights: &[], scale: 1.0, at_bin }
    }

    /// With a weight for each bin: one over the standard deviation of e/σ there, where the equation leaves more than
    /// the noise.
    #[must_use]
    pub fn with_weights(self, weights: &'a [f64]) -> Self {
        ErrorsInVariables { weights, ..self }
    }

    fn weight(&self, k: usize) -> f64 {
        self.weights.get(k).copied().unwrap_or(1.0)
    }

    /// Minimises from `start` within `bounds`. Only the size of the errors found shows how much the data are worth
    /// beside the priors, so with priors there are two rounds.
    ///
    /// # Errors
    /// Those of [`minimise`].
    pub fn fit(mut self, start: &[f64], bounds: &[Bounds]) -> Result<FrequencyFit, IdentError> {
        let mut fit = minimise(&mut self, start, bounds, NonlinearOptions::default())?;
        if !self.priors.is_empty() {
            self.scale = self.mean_square(&self.weighted(&fit)).max(SMALLEST_SCALE);
            let from = fit.parameters;
            fit = minimise(&mut self, &from, bounds, NonlinearOptions::default())?;
        }
        let weighted = self.weighted(&fit);
        let normalised: Vec<f64> = weighted.iter().enumerate().map(|(k, q)| q / self.weight(k)).collect();
        let covariance = covariance(&fit, self.bins, self.mean_square(&weighted));
        let scale = self.mean_square(&normalised);
        Ok(FrequencyFit { fit, covariance, degrees_of_freedom: self.degrees_of_freedom(), scale, normalised })
    }

    /// Weighted |e|/σ of each bin.
    fn weighted(&self, fit: &Minimum) -> Vec<f64> {
        fit.residuals.chunks_exact(2).take(self.bins.len()).map(|parts| parts[0].hypot(parts[1])).collect()
    }

    /// The number of independent parts of the bins.
    fn information(&self) -> f64 {
        2.0 * self.bins.len() as f64 / OVERLAP
    }

    fn degrees_of_freedom(&self) -> f64 {
        (self.information() - E::PARAMETERS as f64).max(1.0)
    }

    /// Mean of the squares of what each bin leaves, freed of what the parameters take up.
    fn mean_square(&self, left: &[f64]) -> f64 {
        let power: f64 = left.iter().map(|q| q * q).sum();
        power / self.bins.len() as f64 * self.information() / self.degrees_of_freedom()
    }
}

/// (JᵀJ)⁻¹ times half the scale (a complex residual of unit variance has parts of half) times the overlap of bins; and
/// for no parameter less than the sandwich whose middle sums products of neighbouring bins.
fn covariance(fit: &Minimum, bins: &[usize], scale: f64) -> faer::Mat<f64> {
    let n = fit.parameters.len();
    let model = faer::Scale(0.5 * scale.max(1e-300) * OVERLAP) * &fit.unscaled_covariance;
    let middle = neighbour_products(fit, bins);
    let sandwich = &fit.unscaled_covariance * middle * &fit.unscaled_covariance;
    let inflation = |i: usize| {
        if model[(i, i)] > 0.0 { (sandwich[(i, i)] / model[(i, i)]).max(1.0).sqrt() } else { 1.0 }
    };
    faer::Mat::from_fn(n, n, |i, j| model[(i, j)] * inflation(i) * inflation(j))
}

fn neighbour_products(fit: &Minimum, bins: &[usize]) -> faer::Mat<f64> {
    let n = fit.parameters.len();
    let contribution = |k: usize, j: usize| {
        fit.jacobian[(2 * k, j)] * fit.residuals[2 * k] + fit.jacobian[(2 * k + 1, j)] * fit.residuals[2 * k + 1]
    };
    let scores = faer::Mat::from_fn(bins.len(), n, contribution);
    let neighbours = faer::Mat::from_fn(bins.len(), n, |k, j| {
        let near = (k.saturating_sub(REACH)..k).filter(|other| bins[k] - bins[*other] == k - other);
        near.map(|other| scores[(other, j)]).sum::<f64>()
    });
    let across = scores.transpose() * &neighbours;
    scores.transpose() * &scores + &across + across.transpose()
}

impl<E: Equation> ErrorsInVariables<'_, E> {
    /// e and σ² at one bin; with `sloped`, also their derivatives, which are kept.
    fn error_and_variance(&mut self, bin: usize, theta: &[f64], sloped: bool) -> (Complex64, f64) {
        let s = Complex64::new(0.0, TAU * self.window.frequency_hz(bin));
        let AtBin { records, polynomials, values, slopes, .. } = &mut self.at_bin;
        slopes.clear();
        self.equation.coefficients(s, theta, polynomials, sloped.then_some(slopes));
        let (mut error, mut variance) = (Complex64::default(), 0.0);
        for (i, signal) in self.signals.iter().enumerate() {
            records[i] = signal.at(theta, bin);
            values[i] = horner(&polynomials[i], s);
            error += apply(&polynomials[i], &records[i]);
            variance += values[i].norm_sqr() * signal.noise_density;
        }
        let energy_s = self.window.energy_s();
        if sloped {
            self.gather_slopes(bin, s, energy_s);
        }
        (error, variance * energy_s)
    }

    /// The derivatives of e and σ² by every parameter at one bin.
    fn gather_slopes(&mut self, bin: usize, s: Complex64, energy_s: f64) {
        let AtBin { records, polynomials, values, slopes, error_slopes, variance_slopes } = &mut self.at_bin;
        error_slopes.fill(Complex64::ZERO);
        variance_slopes.fill(0.0);
        for Slope { parameter, signal, by_order } in slopes.iter() {
            error_slopes[*parameter] += apply(by_order, &records[*signal]);
            let density = self.signals.get(*signal).map_or(0.0, |signal| signal.noise_density);
            if density > 0.0 {
                let of_power = 2.0 * (values[*signal].conj() * horner(by_order, s)).re;
                variance_slopes[*parameter] += of_power * density * energy_s;
            }
        }
        for (polynomial, signal) in polynomials.iter().zip(self.signals) {
            for error in &signal.errors {
                let shape = std::array::from_fn(|n| error.shape.orders[n][bin]);
                error_slopes[error.parameter] -= apply(polynomial, &shape);
            }
        }
    }
}

fn apply(polynomial: &[Complex64; ORDERS], signal: &[Complex64; ORDERS]) -> Complex64 {
    polynomial.iter().zip(signal).map(|(p, x)| p * x).sum()
}

fn horner(polynomial: &[Complex64; ORDERS], s: Complex64) -> Complex64 {
    polynomial.iter().rev().fold(Complex64::default(), |sum, c| sum * s + c)
}

impl<E: Equation> ResidualModel for ErrorsInVariables<'_, E> {
    fn parameter_count(&self) -> usize {
        E::PARAMETERS
    }

    fn residual_count(&self) -> usize {
        2 * self.bins.len() + self.priors.len()
    }

    fn evaluate(
        &mut self,
        theta: &[f64],
        residuals: &mut [f64],
        mut jacobian: Option<MatMut<'_, f64>>,
    ) -> Result<(), IdentError> {
        for (k, bin) in work::checked(self.bins).enumerate() {
            let (error, variance) = self.error_and_variance(*bin, theta, jacobian.is_some());
            let deviation = variance.sqrt() / self.weight(k);
            let residual = error / deviation;
            (residuals[2 * k], residuals[2 * k + 1]) = (residual.re, residual.im);
            if let Some(jacobian) = jacobian.as_mut() {
                let slopes = self.at_bin.error_slopes.iter().zip(&self.at_bin.variance_slopes);
                for (j, (by_error, by_variance)) in slopes.enumerate() {
                    let slope = by_error / deviation - residual * (by_variance / (2.0 * variance));
                    (jacobian[(2 * k, j)], jacobian[(2 * k + 1, j)]) = (slope.re, slope.im);
                }
            }
        }
        // Scaled so that the covariance, which counts each bin as 1/OVERLAP of one and each part as half of one, and
        // all in units of the errors found, gives the prior its own uncertainty back.
        let base = 2 * self.bins.len();
        for (row, prior) in self.priors.iter().enumerate() {
            let weight = (0.5 * OVERLAP * self.scale).sqrt() / prior.standard_uncertainty;
            residuals[base + row] = (theta[prior.parameter] - prior.value) * weight;
            if let Some(jacobian) = jacobian.as_mut() {
                for j in 0..E::PARAMETERS {
                    jacobian[(base + row, j)] = if j == prior.parameter { weight } else { 0.0 };
                }
            }
        }
        Ok(())
    }
}
