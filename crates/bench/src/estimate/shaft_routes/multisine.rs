//! The shaft from a periodic torque demand: sample maximum likelihood.
//!
//! At each excited line k every period gives a vector Z = (ω_d, ω_e, T_d) of Fourier coefficients. The shaft's equation
//! c(s_k, θ)ᵀ Z = 0, c = (J_d s² + K + B s, −(K + B s) e^{sδ_e}, s g(s) e^{sδ_T}), holds for what repeats and for what the
//! engine does in between alike; what errs are the sensors. With Z̄ the mean over P periods and C its sample covariance,
//! V = Σ_k |cᵀ Z̄|²/(cᵀ C c*) is made small: noise levels need not be known, and may be correlated between the signals.
//! g = (1 − e^{−sT_g})/(sT_g) gives the torque the gate of the encoders.
//!
//! A sample covariance from few periods errs, so that |e|²/σ̂² is F-distributed. It is therefore averaged over neighbouring
//! lines, as a factor upon the shape that equal white noise of both encoders would have, until it has enough degrees of
//! freedom ν; cost and covariance are then freed of what is left, ν/(ν − 1) and ν/(ν − 2).
//!
//! J_e follows from the engine's side, s T_shaft + J_e s² ω_e + (P s + I) h(s) ω_e = s T_e, with P and I the engine's own
//! speed control, which acts upon its next firing and holds, h(s) = (1 − e^{−2sτ})/(2sτ). T_e is not recorded, but does not
//! repeat with the demand; its scatter is in C.
//!
//! # Source
//! Pintelon & Schoukens, *System Identification: A Frequency Domain Approach*, 2nd ed. 2012, §10.3 and §12.3 (sample maximum
//! likelihood, its expected cost and covariance); thesis (6.1), (6.4), (6.10).

use std::f64::consts::TAU;

use faer::{Mat, MatMut};
use ident::distributions::normal_quantile;
use ident::frequency::{Window, samples_in};
use ident::{Bounds, IdentError, Minimum, NonlinearOptions, ResidualModel, minimise};
use serde::Serialize;
use signal::periodicity::detect_period;
use signal::{Complex64, Signal};

use super::aligned::inner_stretch;
use super::{B, DYNO_INERTIA, ENGINE_INERTIA, K, SKEW_ENGINE, SKEW_TORQUE, Timing, estimate_of};
use crate::estimate::EstimateError;
use crate::estimate::shaft::ShaftInputs;
use crate::estimate::timing_floor_s;
use crate::study::{Estimate, Stretch};

/// Fewest periods.
const FEWEST_PERIODS: usize = 3;
/// Part of the power of a demand that need not repeat: rounding, and a first value of its own.
const UNREPEATED: f64 = 1e-3;
/// Left out at the start, s, for the bench to settle.
const SETTLING_S: f64 = 2.0;
/// A line is excited where the demand has more than this part of its strongest line.
const EXCITED: f64 = 0.02;
/// Lines used, Hz, and as a part of the slowest sample rate.
const LOWEST_HZ: f64 = 0.4;
const HIGHEST_HZ: f64 = 110.0;
const CLEAN_PART: f64 = 0.44;
/// Degrees of freedom that a variance is averaged up to.
const WANTED_FREEDOM: usize = 24;
/// Largest skew looked for, s.
const LARGEST_SKEW_S: f64 = 0.02;
/// Probability that the cost of a right model lies between the limits.
const LEVEL: f64 = 0.95;
/// Steps of differences, as a part of a parameter's size.
const STEP: f64 = 1e-5;
/// Fewest periods from which the engine's torque, whose spectrum has lines, is weighed.
const FEWEST_FOR_ENGINE: usize = 6;
/// Standard uncertainty of the hold of the engine's control beforehand, as a part of it.
const HOLD_SPREAD: f64 = 0.6;

/// What is found of J_d.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum DynoInertia {
    /// As stated, within its uncertainty.
    Stated,
    /// Estimated along, as if nothing were known of it.
    Estimated,
}

/// Whether what is left is noise.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct CostTest {
    /// V at the minimum.
    pub achieved: f64,
    /// Its expected value under a right model.
    pub expected: f64,
    /// Between these it lies with 95 % probability under a right model. Above: the shaft is not linear, or the model lacks
    /// something. Below: the periods are not independent.
    pub limits: (f64, f64),
}

impl CostTest {
    /// Whether the cost is that of noise.
    #[must_use]
    pub fn passed(&self) -> bool {
        (self.limits.0..=self.limits.1).contains(&self.achieved)
    }
}

/// The shaft from a periodic demand.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MultisineRoute {
    /// K, B, J_d where it was not exactly known, δ_e and δ_T; J_e where it is told.
    pub estimate: Estimate,
    /// The period, s.
    pub period_s: f64,
    /// Periods that were used.
    pub periods: usize,
    /// The lines, Hz.
    pub lines_hz: Vec<f64>,
    /// |e|/σ at each line.
    pub normalised: Vec<f64>,
    /// Degrees of freedom of the variance at a line.
    pub variance_freedom: f64,
    /// The test of the cost.
    pub cost: CostTest,
    /// The test of the cost of the engine's side, where J_e is told.
    pub engine_cost: Option<CostTest>,
    /// Why J_e is not told, in the user's words.
    pub engine_untold: Option<String>,
}

/// Estimates the shaft from a recording under a periodic torque demand, T_d* on the clock of N_d. `timing` gives the gate;
/// both skews are estimated. `firings_per_turn` tells how long the engine's control holds.
///
/// # Errors
/// A demand that does not repeat or repeats too seldom, a torque that is that of a flange, or data that do not determine the
/// parameters.
pub fn estimate(
    inputs: &ShaftInputs<'_>,
    demand: &Signal,
    timing: &Timing,
    inertia: DynoInertia,
    firings_per_turn: f64,
) -> Result<MultisineRoute, EstimateError> {
    let of = |source| EstimateError::Ident { file: inputs.file.to_owned(), source };
    let Some(stated) = inputs.inertia_kg_m2 else {
        let what = "the multisine route needs T_d, but the torque is that of a flange";
        return Err(of(IdentError::Structure { what }));
    };
    let lines = Lines::new(inputs, demand)?;
    let prior = (inertia == DynoInertia::Stated).then_some(stated);
    let mut model = Shaft { lines: &lines, gate_s: timing.gate_s.0, stated: stated.0, prior };
    let (fit, covariance) = model.fit().map_err(of)?;
    let chosen = model.read();
    let theta = fit.parameters.clone();
    let mut found: Vec<_> = chosen.iter().map(|(label, i)| (*label, theta[*i])).collect();
    let entry = |i: usize, j: usize| covariance[(i, j)];
    let mut rows: Vec<Vec<f64>> =
        chosen.iter().map(|(_, i)| chosen.iter().map(|(_, j)| entry(*i, *j)).collect()).collect();
    // What is uncertain of the gate shifts the torque by half of it.
    if let Some(skew) = chosen.iter().position(|(_, i)| *i == TORQUE_SKEW) {
        rows[skew][skew] += (0.5 * timing.gate_s.1).powi(2) + timing_floor_s(inputs.dyno_speed.sample_time_s).powi(2);
    }
    let engine = EngineSide::new(&model, inputs, firings_per_turn).and_then(|engine| engine.fit(&theta, &covariance));
    let (engine_cost, engine_untold) = match engine {
        Ok(engine) => {
            let with: Vec<f64> = chosen.iter().map(|(_, i)| engine.with_shaft[*i]).collect();
            rows.iter_mut().zip(&with).for_each(|(row, c)| row.push(*c));
            rows.push(with.into_iter().chain([engine.variance]).collect());
            found.push((ENGINE_INERTIA, engine.inertia_kg_m2));
            (Some(engine.cost), None)
        }
        Err(reason) => (None, Some(reason)),
    };
    let normalised =
        fit.residuals.chunks_exact(2).take(lines.count()).map(|r| r[0].hypot(r[1]) / 2f64.sqrt()).collect();
    let free = fit.at_bound.iter().filter(|b| !**b).count() - usize::from(prior.is_some_and(|(_, u)| u > 0.0));
    let freedom = 2.0 * lines.count() as f64 - free as f64;
    let squares: f64 = fit.residuals.iter().take(2 * lines.count()).map(|r| r * r).sum();
    Ok(MultisineRoute {
        estimate: estimate_of(
            &found,
            rows,
            freedom.max(1.0),
            lines.stretch(inputs.file),
            (fit.iterations, fit.condition),
        ),
        period_s: lines.period_s,
        periods: lines.periods,
        lines_hz: lines.frequencies_hz.clone(),
        normalised,
        variance_freedom: lines.freedom(),
        cost: cost_test(0.5 * squares, freedom, lines.freedom()),
        engine_cost,
        engine_untold,
    })
}

/// A cost of `freedom` real residuals, each over a variance of ν degrees of freedom.
fn cost_test(achieved: f64, freedom: f64, nu: f64) -> CostTest {
    let expected = 0.5 * freedom * nu / (nu - 1.0);
    // Variance of F(2, 2ν), for each complex residual; neighbours that share variances scatter more.
    let spread = if nu > 2.0 { nu.powi(3) / ((nu - 1.0).powi(2) * (nu - 2.0)) } else { f64::INFINITY };
    let reach = normal_quantile(0.5 + 0.5 * LEVEL) * (0.5 * freedom * spread).sqrt();
    CostTest { achieved, expected, limits: (expected - reach, expected + reach) }
}

const SIGNALS: usize = 3;
type Coefficients = [Complex64; SIGNALS];

/// Mean coefficients and covariances of the means at the excited lines.
struct Lines {
    start_s: f64,
    period_s: f64,
    periods: usize,
    frequencies_hz: Vec<f64>,
    means: Vec<Coefficients>,
    covariances: Vec<[Coefficients; SIGNALS]>,
    /// Lines on either side over which variances are averaged.
    reach: usize,
}

impl Lines {
    fn new(inputs: &ShaftInputs<'_>, demand: &Signal) -> Result<Self, EstimateError> {
        let of = |source| EstimateError::Ident { file: inputs.file.to_owned(), source };
        let stretch = inner_stretch(inputs)?;
        let start_s = stretch.start_s.max(demand.start_s) + SETTLING_S;
        let end_s = stretch.end_s.min(demand.end_s());
        let used = demand.slice(start_s, end_s);
        let period = detect_period(&used.samples, UNREPEATED)
            .map_err(|source| EstimateError::Signal { file: inputs.file.to_owned(), source })?;
        let what = "T_d* does not repeat, or fewer than three times: record Multisine_T_TN with at least three periods of the \
                    demand, better ten, after two seconds to settle";
        let Some(period) = period else { return Err(of(IdentError::Structure { what })) };
        let period_s = period.period as f64 * demand.sample_time_s;
        let periods = ((end_s - start_s) / period_s + 1e-6).floor() as usize;
        if periods < FEWEST_PERIODS {
            return Err(of(IdentError::Structure { what }));
        }
        let slowest_s = inputs.signals().map(|s| s.sample_time_s).fold(0.0, f64::max);
        let highest_hz = HIGHEST_HZ.min(CLEAN_PART / slowest_s);
        let excited = excited(&used, Window { start_s: used.start_s, duration_s: period_s }, highest_hz).map_err(of)?;
        if excited.is_empty() {
            return Err(of(IdentError::Constant { what: "T_d* in the band of the shaft" }));
        }
        let mut of_periods = Vec::with_capacity(periods);
        for p in 0..periods {
            let window = Window { start_s: start_s + p as f64 * period_s, duration_s: period_s };
            of_periods.push(coefficients(inputs, window, &excited).map_err(of)?);
        }
        let (means, covariances) = (0..excited.len()).map(|k| moments(&of_periods, k)).unzip();
        let groups = WANTED_FREEDOM.div_ceil(periods - 1);
        Ok(Lines {
            start_s,
            period_s,
            periods,
            frequencies_hz: excited.iter().map(|k| *k as f64 / period_s).collect(),
            means,
            covariances,
            reach: (groups / 2).min((excited.len() - 1) / 2),
        })
    }

    fn count(&self) -> usize {
        self.means.len()
    }

    fn s(&self, k: usize) -> Complex64 {
        Complex64::new(0.0, TAU * self.frequencies_hz[k])
    }

    /// Degrees of freedom of an averaged variance.
    fn freedom(&self) -> f64 {
        ((self.periods - 1) * (2 * self.reach + 1)) as f64
    }

    /// The error of an equation at a line, and the variance that the sample covariance gives it.
    fn error(&self, k: usize, c: &Coefficients) -> (Complex64, f64) {
        let error = (0..SIGNALS).map(|i| c[i] * self.means[k][i]).sum();
        let product = |i: usize, j: usize| c[i] * self.covariances[k][i][j] * c[j].conj();
        let variance: Complex64 = (0..SIGNALS * SIGNALS).map(|ij| product(ij / SIGNALS, ij % SIGNALS)).sum();
        (error, variance.re.max(0.0))
    }

    fn stretch(&self, file: &str) -> Stretch {
        let end_s = self.start_s + self.periods as f64 * self.period_s;
        Stretch { file: file.to_owned(), start_s: self.start_s, end_s }
    }
}

/// Harmonics that the demand excites.
fn excited(demand: &Signal, window: Window, highest_hz: f64) -> Result<Vec<usize>, IdentError> {
    let values = samples_in(demand, window)?.values;
    let spectrum = signal::spectrum::fft_real(&values).map_err(|_| IdentError::Decomposition { what: "Fourier" })?;
    let bins = window.bins(LOWEST_HZ, highest_hz.min(0.45 / demand.sample_time_s));
    let strongest = bins.clone().map(|k| spectrum[k].norm()).fold(0.0, f64::max);
    Ok(bins.filter(|k| spectrum[*k].norm() > EXCITED * strongest && strongest > 0.0).collect())
}

/// Coefficients of ω_d, ω_e and T_d at harmonics of a window.
fn coefficients(
    inputs: &ShaftInputs<'_>,
    window: Window,
    harmonics: &[usize],
) -> Result<Vec<Coefficients>, IdentError> {
    let transform = |signal: &Signal| -> Result<Vec<Complex64>, IdentError> {
        let samples = samples_in(signal, window)?;
        let spectrum =
            signal::spectrum::fft_real(&samples.values).map_err(|_| IdentError::Decomposition { what: "Fourier" })?;
        let count = samples.values.len() as f64;
        let dated = |k: &usize| {
            let value = spectrum.get(*k).copied().unwrap_or_default();
            value / count * Complex64::cis(-TAU * window.frequency_hz(*k) * samples.offset_s)
        };
        Ok(harmonics.iter().map(dated).collect())
    };
    let (dyno, engine) = (transform(inputs.dyno_speed)?, transform(inputs.engine_speed)?);
    let mut torque = vec![Complex64::default(); harmonics.len()];
    for record in &inputs.torque {
        torque.iter_mut().zip(transform(&record.signal)?).for_each(|(sum, t)| *sum += t);
    }
    Ok((0..harmonics.len()).map(|k| [dyno[k], engine[k], torque[k]]).collect())
}

/// Mean over periods at one line, and the sample covariance of that mean.
fn moments(periods: &[Vec<Coefficients>], k: usize) -> (Coefficients, [Coefficients; SIGNALS]) {
    let count = periods.len() as f64;
    let mean: Coefficients = std::array::from_fn(|i| periods.iter().map(|p| p[k][i]).sum::<Complex64>() / count);
    let product = |i: usize, j: usize| {
        let sum: Complex64 = periods.iter().map(|p| (p[k][i] - mean[i]) * (p[k][j] - mean[j]).conj()).sum();
        sum / (count * (count - 1.0))
    };
    (mean, std::array::from_fn(|i| std::array::from_fn(|j| product(i, j))))
}

const STIFFNESS: usize = 0;
const DAMPING: usize = 1;
const ENGINE_SKEW: usize = 2;
const TORQUE_SKEW: usize = 3;
const INERTIA: usize = 4;
const COUNT: usize = 5;

/// Sizes that differences are measured by where a parameter is small: K, B, skews, J_d.
const SIZES: [f64; COUNT] = [1.0, 0.1, 1e-3, 1e-3, 1e-2];

/// The shaft's equation at the lines.
#[derive(Clone, Copy)]
struct Shaft<'a> {
    lines: &'a Lines,
    gate_s: f64,
    stated: f64,
    /// J_d and its standard uncertainty where it is known.
    prior: Option<(f64, f64)>,
}

impl Shaft<'_> {
    /// The coefficients of ω_d, ω_e and T_d.
    fn equation(&self, s: Complex64, theta: &[f64]) -> Coefficients {
        let spring = theta[STIFFNESS] + theta[DAMPING] * s;
        let engine = (s * theta[ENGINE_SKEW]).exp();
        [theta[INERTIA] * s * s + spring, -spring * engine, s * self.torque_factor(s, theta)]
    }

    /// What turns the torque's transform into that of its mean over the gate.
    fn torque_factor(&self, s: Complex64, theta: &[f64]) -> Complex64 {
        let x = s * self.gate_s;
        let gate = if x.norm() < 1e-9 { Complex64::from(1.0) } else { (1.0 - (-x).exp()) / x };
        gate * (s * theta[TORQUE_SKEW]).exp()
    }

    /// Errors with their averaged variances.
    fn errors(&self, theta: &[f64]) -> Vec<(Complex64, f64)> {
        let n = self.lines.count();
        let mut shapes = Vec::with_capacity(n);
        let raw: Vec<(Complex64, f64)> = (0..n)
            .map(|k| {
                let c = self.equation(self.lines.s(k), theta);
                shapes.push(c[0].norm_sqr() + c[1].norm_sqr());
                self.lines.error(k, &c)
            })
            .collect();
        let width = 2 * self.lines.reach + 1;
        let averaged = |k: usize| {
            let first = k.saturating_sub(self.lines.reach).min(n - width);
            let sum: f64 = (first..first + width).map(|j| raw[j].1 / shapes[j]).sum();
            shapes[k] * sum / width as f64
        };
        (0..n).map(|k| (raw[k].0, averaged(k).max(f64::MIN_POSITIVE))).collect()
    }

    fn fit(&mut self) -> Result<(Minimum, Mat<f64>), IdentError> {
        let start = self.start();
        let positive = Bounds::new(0.0, f64::INFINITY);
        let skew = Bounds::new(-LARGEST_SKEW_S, LARGEST_SKEW_S);
        let mut bounds = [positive, positive, skew, skew, positive];
        if let Some((value, 0.0)) = self.prior {
            bounds[INERTIA] = Bounds::new(value, value);
        }
        let fit = minimise(self, &start, &bounds, NonlinearOptions::default())?;
        let nu = self.lines.freedom();
        let inflation = if nu > 2.0 { nu / (nu - 2.0) } else { nu };
        let covariance = faer::Scale(inflation) * &fit.unscaled_covariance;
        Ok((fit, covariance))
    }

    /// K and B by least squares without skew, J_d as stated.
    fn start(&self) -> [f64; COUNT] {
        let (mut left, mut right) = ([[0.0; 2]; 2], [0.0; 2]);
        for k in 0..self.lines.count() {
            let (s, [dyno, engine, torque]) = (self.lines.s(k), self.lines.means[k]);
            let twist = engine - dyno;
            let rate = self.stated * s * s * dyno + s * self.torque_factor(s, &[0.0; COUNT]) * torque;
            let regressors = [twist, s * twist];
            for i in 0..2 {
                right[i] += (regressors[i].conj() * rate).re / s.norm_sqr();
                (0..2).for_each(|j| left[i][j] += (regressors[i].conj() * regressors[j]).re / s.norm_sqr());
            }
        }
        let determinant = left[0][0] * left[1][1] - left[0][1] * left[1][0];
        let stiffness = (right[0] * left[1][1] - right[1] * left[0][1]) / determinant;
        let damping = (left[0][0] * right[1] - left[1][0] * right[0]) / determinant;
        let sane = |value: f64, least: f64| if value.is_finite() { value.max(least) } else { least };
        [sane(stiffness, 1.0), sane(damping, 1e-2), 0.0, 0.0, self.stated]
    }

    /// What people read.
    fn read(&self) -> Vec<(crate::estimate::Label, usize)> {
        let mut chosen = vec![(K, STIFFNESS), (B, DAMPING)];
        if self.prior.is_none_or(|(_, uncertainty)| uncertainty > 0.0) {
            chosen.push((DYNO_INERTIA, INERTIA));
        }
        chosen.extend([(SKEW_ENGINE, ENGINE_SKEW), (SKEW_TORQUE, TORQUE_SKEW)]);
        chosen
    }
}

impl ResidualModel for Shaft<'_> {
    fn parameter_count(&self) -> usize {
        COUNT
    }

    fn residual_count(&self) -> usize {
        2 * self.lines.count() + 1
    }

    /// √2 e/σ, real and imaginary part in turn, each of variance one; then what is known of J_d.
    fn evaluate(
        &mut self,
        theta: &[f64],
        residuals: &mut [f64],
        jacobian: Option<MatMut<'_, f64>>,
    ) -> Result<(), IdentError> {
        let shaft = *self;
        let at = |theta: &[f64], values: &mut [f64]| {
            for (k, (error, variance)) in shaft.errors(theta).into_iter().enumerate() {
                let value = error * (2.0 / variance).sqrt();
                (values[2 * k], values[2 * k + 1]) = (value.re, value.im);
            }
            values[2 * shaft.lines.count()] = match shaft.prior {
                Some((value, uncertainty)) if uncertainty > 0.0 => (theta[INERTIA] - value) / uncertainty,
                _ => 0.0,
            };
        };
        at(theta, residuals);
        if let Some(jacobian) = jacobian {
            differences(theta, &SIZES, residuals.len(), at, jacobian);
        }
        Ok(())
    }
}

/// Central differences of residuals.
fn differences(
    theta: &[f64],
    sizes: &[f64],
    count: usize,
    at: impl Fn(&[f64], &mut [f64]),
    mut jacobian: MatMut<'_, f64>,
) {
    let (mut above, mut below) = (vec![0.0; count], vec![0.0; count]);
    for j in 0..theta.len() {
        let step = STEP * theta[j].abs().max(sizes[j]);
        let mut point = theta.to_vec();
        point[j] = theta[j] + step;
        at(&point, &mut above);
        point[j] = theta[j] - step;
        at(&point, &mut below);
        for i in 0..count {
            jacobian[(i, j)] = (above[i] - below[i]) / (2.0 * step);
        }
    }
}

/// J_e with its variance and its covariance with the shaft's parameters.
struct EngineFit {
    inertia_kg_m2: f64,
    variance: f64,
    with_shaft: Vec<f64>,
    cost: CostTest,
}

/// The engine's side of the shaft: J_e, P, I and τ.
struct EngineSide<'a> {
    shaft: &'a Shaft<'a>,
    half_firing_s: f64,
    control: Control,
    theta: Vec<f64>,
}

/// How the engine's control acts upon its torque, where that is not recorded.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Control {
    /// It holds for 2τ.
    Held,
    /// It acts τ late.
    Delayed,
}

const ENGINE_UNKNOWNS: usize = 4;
const HOLD: usize = 3;
const ENGINE_SIZES: [f64; ENGINE_UNKNOWNS] = [1e-2, 0.1, 0.1, 1e-3];
/// An engine at rest has no firing interval; this slow it is as long as it may matter, rad/s.
const SLOWEST_RAD_S: f64 = 30.0;

impl<'a> EngineSide<'a> {
    fn new(shaft: &'a Shaft<'a>, inputs: &ShaftInputs<'_>, firings_per_turn: f64) -> Result<Self, String> {
        let periods = shaft.lines.periods;
        if periods < FEWEST_FOR_ENGINE {
            return Err(format!(
                "J_e needs {FEWEST_FOR_ENGINE} periods to weigh the engine's torque by its scatter, and {periods} were \
                 recorded; record longer"
            ));
        }
        let turns_per_s = inputs.engine_speed.mean().unwrap_or(0.0).abs().max(SLOWEST_RAD_S) / TAU;
        let half_firing_s = 0.5 / (firings_per_turn * turns_per_s);
        Ok(EngineSide { shaft, half_firing_s, control: Control::Held, theta: Vec::new() })
    }

    fn fit(mut self, theta: &[f64], covariance: &Mat<f64>) -> Result<EngineFit, String> {
        let failed = |e: IdentError| format!("J_e: {e}");
        let held = self.solve(theta).map_err(failed)?;
        self.control = Control::Delayed;
        let delayed = self.solve(theta).map_err(failed)?.parameters[0];
        self.control = Control::Held;
        let gradient: Vec<f64> = (0..COUNT)
            .map(|i| {
                let step = 0.1 * covariance[(i, i)].max(0.0).sqrt();
                let moved = |side: &mut Self, by: f64| {
                    let mut theta = theta.to_vec();
                    theta[i] += by;
                    side.solve(&theta).map(|m| m.parameters[0])
                };
                if step == 0.0 {
                    return Ok(0.0);
                }
                Ok((moved(&mut self, step)? - moved(&mut self, -step)?) / (2.0 * step))
            })
            .collect::<Result<_, IdentError>>()
            .map_err(failed)?;
        let with_shaft: Vec<f64> =
            (0..COUNT).map(|i| (0..COUNT).map(|j| covariance[(i, j)] * gradient[j]).sum()).collect();
        let through: f64 = with_shaft.iter().zip(&gradient).map(|(c, g)| c * g).sum();
        let lines = self.shaft.lines;
        let nu = (lines.periods - 1) as f64;
        let freedom = (2 * lines.count() - ENGINE_UNKNOWNS + 1) as f64;
        let squares: f64 = held.residuals.iter().take(2 * lines.count()).map(|r| r * r).sum();
        let inertia = held.parameters[0];
        Ok(EngineFit {
            inertia_kg_m2: inertia,
            // As uncertain as what another control would make of the same data; uniform between the two and as far beyond.
            variance: held.unscaled_covariance[(0, 0)] * nu / (nu - 2.0) + through + (delayed - inertia).powi(2) / 3.0,
            with_shaft,
            cost: cost_test(0.5 * squares, freedom, nu),
        })
    }

    fn solve(&mut self, theta: &[f64]) -> Result<Minimum, IdentError> {
        self.theta = theta.to_vec();
        let start = [0.5 * self.shaft.stated, 1.0, 1.0, self.half_firing_s];
        let bounds = [
            Bounds::new(0.0, f64::INFINITY),
            Bounds::new(0.0, f64::INFINITY),
            Bounds::new(0.0, f64::INFINITY),
            Bounds::new(0.05 * self.half_firing_s, 5.0 * self.half_firing_s),
        ];
        minimise(self, &start, &bounds, NonlinearOptions::default())
    }

    fn equation(&self, s: Complex64, p: &[f64]) -> Coefficients {
        let theta = &self.theta;
        let x = 2.0 * s * p[HOLD];
        let late = match self.control {
            Control::Held => (1.0 - (-x).exp()) / x,
            Control::Delayed => (-0.5 * x).exp(),
        };
        let engine = (s * theta[ENGINE_SKEW]).exp();
        [
            theta[INERTIA] * s * s,
            (p[0] * s * s + (p[1] * s + p[2]) * late) * engine,
            s * self.shaft.torque_factor(s, theta),
        ]
    }
}

impl ResidualModel for EngineSide<'_> {
    fn parameter_count(&self) -> usize {
        ENGINE_UNKNOWNS
    }

    fn residual_count(&self) -> usize {
        2 * self.shaft.lines.count() + 1
    }

    fn evaluate(
        &mut self,
        p: &[f64],
        residuals: &mut [f64],
        jacobian: Option<MatMut<'_, f64>>,
    ) -> Result<(), IdentError> {
        let side = &*self;
        let at = |p: &[f64], values: &mut [f64]| {
            let lines = side.shaft.lines;
            for k in 0..lines.count() {
                let (error, variance) = lines.error(k, &side.equation(lines.s(k), p));
                let value = error * (2.0 / variance.max(f64::MIN_POSITIVE)).sqrt();
                (values[2 * k], values[2 * k + 1]) = (value.re, value.im);
            }
            values[2 * lines.count()] = (p[HOLD] - side.half_firing_s) / (HOLD_SPREAD * side.half_firing_s);
        };
        at(p, residuals);
        if let Some(jacobian) = jacobian {
            differences(p, &ENGINE_SIZES, residuals.len(), at, jacobian);
        }
        Ok(())
    }
}
