//! The shaft from a periodic torque demand: sample maximum likelihood.
//!
//! At each excited line k every period gives a vector Z of transforms of ω_d, ω_e, T_d and of ω cos θ and ω sin θ of both
//! encoders, whose once-a-turn errors are estimated along. The shaft's equation c(s_k, θ)ᵀ Z = 0, for exact encoders
//! (J_d s² + K + B s) ω_d − (K + B s) e^{sδ_e} ω_e + s g(s) e^{sδ_T} T_d = 0, holds for what repeats and for what the engine does
//! in between alike; what errs are the sensors. With Z̄ the mean over P periods and C its sample covariance,
//! V = Σ_k |cᵀ Z̄|²/(cᵀ C c*) is made small: noise levels need not be known, and may be correlated between the signals.
//! g = (1 − e^{−sT_g})/(sT_g) gives the torque the gate of the encoders.
//!
//! A period is weighed by a window that rises like sin² over a quarter of a period and falls over the first quarter of the next,
//! so that windows add up to one: the mean over periods holds all of the data and nothing of other lines of the demand.
//! Derivatives are moved to the window, so that what does not repeat leaks into no equation.
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
//! likelihood, its expected cost and covariance); Shinbrot, *On the analysis of linear and nonlinear systems*, 1957
//! (derivatives by the window); thesis (6.1), (6.4), (6.10).

use std::f64::consts::{PI, TAU};

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
use crate::model::Engine;
use crate::study::{Estimate, Stretch};

/// Fewest periods.
const FEWEST_PERIODS: usize = 3;
/// Part of a period over which its window rises.
const RISE: f64 = 0.25;
/// Standard uncertainty of the once-a-turn errors beforehand, as a part of the speed.
const ECCENTRICITY: f64 = 1e-3;
/// Beyond this coherence the engine's cycles repeat with the demand.
const COHERENT: f64 = 0.5;
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
    /// something. Below: periods scatter by more than what their mean keeps, as by a once-a-turn error of an encoder whose
    /// turns do not repeat with the demand; intervals are wider than need be.
    pub limits: (f64, f64),
}

impl CostTest {
    /// Whether the cost is no more than that of noise.
    #[must_use]
    pub fn passed(&self) -> bool {
        self.achieved <= self.limits.1
    }

    /// What a covariance from the scatter alone is multiplied by where the model lacks something.
    fn inflation(&self) -> f64 {
        if self.passed() { 1.0 } else { self.achieved / self.expected }
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
/// both skews are estimated, from its values on. The engine's firings tell how long its
/// control holds.
///
/// # Errors
/// A demand that does not repeat or repeats too seldom, a torque that is that of a flange, or data that do not determine the
/// parameters.
pub fn estimate(
    inputs: &ShaftInputs<'_>,
    demand: &Signal,
    timing: &Timing,
    inertia: DynoInertia,
    engine: Engine,
) -> Result<MultisineRoute, EstimateError> {
    let of = |source| EstimateError::Ident { file: inputs.file.to_owned(), source };
    let Some(stated) = inputs.inertia_kg_m2 else {
        let what = "the multisine route needs T_d, but the torque is that of a flange";
        return Err(of(IdentError::Structure { what }));
    };
    let lines = Lines::new(inputs, demand, timing, engine)?;
    let prior = (inertia == DynoInertia::Stated).then_some(stated);
    let mut model = Shaft { lines: &lines, gate_s: timing.gate_s.0, stated: stated.0, prior };
    let (fit, covariance) = model.fit().map_err(of)?;
    let cost = model.cost(&fit);
    let covariance = faer::Scale(cost.inflation()) * &covariance;
    let chosen = model.read();
    let theta = fit.parameters.clone();
    let dated = |i: usize| match i {
        ENGINE_SKEW => timing.engine_skew_s.0,
        TORQUE_SKEW => timing.torque_skew_s.0,
        _ => 0.0,
    };
    let mut found: Vec<_> = chosen.iter().map(|(label, i)| (*label, theta[*i] + dated(*i))).collect();
    let entry = |i: usize, j: usize| covariance[(i, j)];
    let mut rows: Vec<Vec<f64>> =
        chosen.iter().map(|(_, i)| chosen.iter().map(|(_, j)| entry(*i, *j)).collect()).collect();
    // What is uncertain of the gate shifts the torque by half of it.
    if let Some(skew) = chosen.iter().position(|(_, i)| *i == TORQUE_SKEW) {
        rows[skew][skew] += (0.5 * timing.gate_s.1).powi(2) + timing_floor_s(inputs.dyno_speed.sample_time_s).powi(2);
    }
    let engine = EngineSide::new(&model, inputs, engine).and_then(|engine| engine.fit(&theta, &covariance));
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
    let freedom = 2.0 * cost.expected.max(0.5);
    Ok(MultisineRoute {
        estimate: estimate_of(
            &found,
            rows,
            freedom.max(1.0),
            lines.stretch(inputs.file),
            (fit.iterations, fit.condition),
        ),
        period_s: lines.period_s,
        periods: lines.periods(),
        lines_hz: lines.frequencies_hz.clone(),
        normalised,
        variance_freedom: lines.freedom(),
        cost,
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

/// ω_d, ω_e and T_d; then ω cos θ and ω sin θ of both encoders.
const SIGNALS: usize = 7;
const DYNO: usize = 0;
const ENGINE: usize = 1;
const TORQUE: usize = 2;
const DYNO_WAVES: [usize; 2] = [3, 4];
const ENGINE_WAVES: [usize; 2] = [5, 6];

/// Coefficients of a signal and its first two derivatives.
type Orders = [Complex64; 3];
/// Those of every signal: of an equation, or its transforms.
type Row = [Orders; SIGNALS];

/// The sum of an equation's terms.
fn applied(equation: &Row, transforms: &Row) -> Complex64 {
    let terms = equation.iter().flatten().zip(transforms.iter().flatten());
    terms.map(|(c, z)| c * z).sum()
}

/// Transforms of every period at the excited lines.
struct Lines {
    start_s: f64,
    period_s: f64,
    frequencies_hz: Vec<f64>,
    /// By line, then by period.
    transforms: Vec<Vec<Row>>,
    /// Lines on either side over which variances are averaged.
    reach: usize,
    /// How far the engine's cycles repeat with the demand: 0 not at all, 1 wholly.
    coherence: f64,
}

impl Lines {
    fn new(inputs: &ShaftInputs<'_>, demand: &Signal, timing: &Timing, engine: Engine) -> Result<Self, EstimateError> {
        let of = |source| EstimateError::Ident { file: inputs.file.to_owned(), source };
        let stretch = inner_stretch(inputs)?;
        let start_s = stretch.start_s.max(demand.start_s) + SETTLING_S;
        let end_s = stretch.end_s.min(demand.end_s());
        let used = demand.slice(start_s, end_s);
        let not_periodic = || {
            let what = "T_d* does not repeat, or too seldom: record Multisine_T_TN with two seconds to settle and, after them, \
                        at least four periods of the demand, better ten";
            of(IdentError::Structure { what })
        };
        let period = detect_period(&used.samples, UNREPEATED).map_err(|_| not_periodic())?.ok_or_else(not_periodic)?;
        let period_s = period.period as f64 * demand.sample_time_s;
        // The last window falls within the period after it.
        let periods = ((end_s - start_s) / period_s - RISE + 1e-6).floor() as usize;
        if periods < FEWEST_PERIODS {
            return Err(not_periodic());
        }
        let slowest_s = inputs.signals().map(|s| s.sample_time_s).fold(0.0, f64::max);
        let highest_hz = HIGHEST_HZ.min(CLEAN_PART / slowest_s);
        let excited = excited(&used, Window { start_s: used.start_s, duration_s: period_s }, highest_hz).map_err(of)?;
        if excited.is_empty() {
            return Err(of(IdentError::Constant { what: "T_d* in the band of the shaft" }));
        }
        let grid = Grid { start_s, period_s, periods, harmonics: &excited };
        let transforms = grid.transforms(inputs, timing).map_err(of)?;
        let groups = WANTED_FREEDOM.div_ceil(periods - 1);
        Ok(Lines {
            start_s,
            period_s,
            frequencies_hz: excited.iter().map(|k| *k as f64 / period_s).collect(),
            transforms,
            reach: (groups / 2).min((excited.len() - 1) / 2),
            coherence: grid.coherence(inputs.engine_speed, engine),
        })
    }

    fn count(&self) -> usize {
        self.transforms.len()
    }

    fn periods(&self) -> usize {
        self.transforms.first().map_or(0, Vec::len)
    }

    fn s(&self, k: usize) -> Complex64 {
        Complex64::new(0.0, TAU * self.frequencies_hz[k])
    }

    /// Degrees of freedom of an averaged variance.
    fn freedom(&self) -> f64 {
        ((self.periods() - 1) * (2 * self.reach + 1)) as f64
    }

    /// The mean over periods of an equation's error at a line, and the variance of that mean from its scatter.
    fn error(&self, k: usize, equation: &Row) -> (Complex64, f64) {
        let errors: Vec<Complex64> = self.transforms[k].iter().map(|z| applied(equation, z)).collect();
        let count = errors.len() as f64;
        let mean = errors.iter().sum::<Complex64>() / count;
        let scatter: f64 = errors.iter().map(|e| (e - mean).norm_sqr()).sum();
        (mean, scatter / (count * (count - 1.0)))
    }

    /// The mean transforms at a line.
    fn mean(&self, k: usize) -> Row {
        let count = self.periods() as f64;
        let sum = |i: usize, n: usize| self.transforms[k].iter().map(|z| z[i][n]).sum::<Complex64>() / count;
        std::array::from_fn(|i| std::array::from_fn(|n| sum(i, n)))
    }

    fn stretch(&self, file: &str) -> Stretch {
        let end_s = self.start_s + (self.periods() as f64 + RISE) * self.period_s;
        Stretch { file: file.to_owned(), start_s: self.start_s, end_s }
    }
}

/// Periods and harmonics.
struct Grid<'a> {
    start_s: f64,
    period_s: f64,
    periods: usize,
    harmonics: &'a [usize],
}

impl Grid<'_> {
    /// By harmonic, then by period.
    fn transforms(&self, inputs: &ShaftInputs<'_>, timing: &Timing) -> Result<Vec<Vec<Row>>, IdentError> {
        let mut all = vec![vec![[[Complex64::default(); 3]; SIGNALS]; self.periods]; self.harmonics.len()];
        let mut add = |place: usize, signal: &Signal, earlier_s: f64| -> Result<(), IdentError> {
            let dated = Signal { start_s: signal.start_s - earlier_s, ..signal.clone() };
            for p in 0..self.periods {
                let transform = self.transform(&dated, p)?;
                for (line, orders) in all.iter_mut().zip(transform) {
                    line[p][place].iter_mut().zip(orders).for_each(|(sum, value)| *sum += value);
                }
            }
            Ok(())
        };
        for record in &inputs.torque {
            add(TORQUE, &record.signal, timing.torque_skew_s.0)?;
        }
        let speeds = [
            (inputs.dyno_speed, 0.0, DYNO, DYNO_WAVES),
            (inputs.engine_speed, timing.engine_skew_s.0, ENGINE, ENGINE_WAVES),
        ];
        for (speed, earlier_s, place, waves) in speeds {
            add(place, speed, earlier_s)?;
            for (place, wave) in waves.into_iter().zip(once_a_turn(speed)) {
                add(place, &wave, earlier_s)?;
            }
        }
        Ok(all)
    }

    /// Transforms of a signal and its derivatives over one period.
    fn transform(&self, signal: &Signal, period: usize) -> Result<Vec<Orders>, IdentError> {
        let start_s = self.start_s + period as f64 * self.period_s;
        let whole = samples_in(signal, Window { start_s, duration_s: self.period_s })?;
        let next = samples_in(signal, Window { start_s: start_s + self.period_s, duration_s: RISE * self.period_s })?;
        let (count, dt) = (whole.values.len(), whole.sample_time_s);
        // The mean has no part in any line, and would swamp the others.
        let mean = whole.values.iter().sum::<f64>() / count as f64;
        let mut weighed = [vec![0.0; count], vec![0.0; count], vec![0.0; count]];
        let falling =
            next.values.iter().enumerate().map(|(i, x)| (i, next.offset_s + i as f64 * dt + self.period_s, x));
        let rising = whole.values.iter().enumerate().map(|(i, x)| (i, whole.offset_s + i as f64 * dt, x));
        for (i, time_s, x) in rising.chain(falling) {
            let window = self.window(time_s);
            for (sums, weight) in weighed.iter_mut().zip(window) {
                // What falls into the next period has the same phases there.
                sums[i % count] += weight * (x - mean);
            }
        }
        let spectra: Vec<Vec<Complex64>> = weighed
            .iter()
            .map(|w| signal::spectrum::fft_real(w).map_err(|_| IdentError::Decomposition { what: "Fourier" }))
            .collect::<Result<_, _>>()?;
        let orders = |k: &usize| {
            let omega = TAU * *k as f64 / self.period_s;
            let dated = Complex64::cis(-omega * whole.offset_s) / count as f64;
            let [h0, h1, h2] = [0, 1, 2].map(|n| spectra[n].get(*k).copied().unwrap_or_default() * dated);
            let s = Complex64::new(0.0, omega);
            [h0, s * h0 - h1, s * (s * h0 - 2.0 * h1) + h2]
        };
        Ok(self.harmonics.iter().map(orders).collect())
    }

    /// The window and its first two derivatives at a time after its start.
    fn window(&self, time_s: f64) -> [f64; 3] {
        let rise_s = RISE * self.period_s;
        let (edge, slope) = if time_s < rise_s {
            (time_s / rise_s, 1.0)
        } else if time_s >= self.period_s {
            ((self.period_s - time_s) / rise_s + 1.0, -1.0)
        } else {
            return [1.0, 0.0, 0.0];
        };
        let ((sin, cos), rate) = ((PI * edge.clamp(0.0, 1.0)).sin_cos(), PI / rise_s);
        [0.5 * (1.0 - cos), 0.5 * slope * rate * sin, 0.5 * rate * rate * cos]
    }

    /// |mean over periods of e^{jnφ}| of the worst harmonic n of the working cycle up to the firing, φ the cycle's angle at the
    /// start of a period.
    fn coherence(&self, engine_speed: &Signal, engine: Engine) -> f64 {
        let mut angle = 0.0;
        let mut at_start = Vec::with_capacity(self.periods);
        for (i, omega) in engine_speed.samples.iter().enumerate() {
            let next_s = self.start_s + at_start.len() as f64 * self.period_s;
            if at_start.len() < self.periods && engine_speed.time_s(i) >= next_s {
                at_start.push(2.0 * angle / f64::from(engine.strokes));
            }
            angle += omega * engine_speed.sample_time_s;
        }
        let mean = |n: u32| {
            let sum: Complex64 = at_start.iter().map(|a| Complex64::cis(f64::from(n) * a)).sum();
            sum.norm() / at_start.len().max(1) as f64
        };
        (1..=engine.cylinders).map(mean).fold(0.0, f64::max)
    }
}

/// ω cos θ and ω sin θ, θ being the angle turned since the first sample.
fn once_a_turn(speed: &Signal) -> [Signal; 2] {
    let [cosine, sine] = super::aligned::once_a_turn(&speed.samples, speed.sample_time_s);
    [speed.with_samples(cosine), speed.with_samples(sine)]
}

/// Harmonics that the demand excites.
fn excited(demand: &Signal, window: Window, highest_hz: f64) -> Result<Vec<usize>, IdentError> {
    let values = samples_in(demand, window)?.values;
    let spectrum = signal::spectrum::fft_real(&values).map_err(|_| IdentError::Decomposition { what: "Fourier" })?;
    let bins = window.bins(LOWEST_HZ, highest_hz.min(0.45 / demand.sample_time_s));
    let strongest = bins.clone().map(|k| spectrum[k].norm()).fold(0.0, f64::max);
    Ok(bins.filter(|k| spectrum[*k].norm() > EXCITED * strongest && strongest > 0.0).collect())
}

const STIFFNESS: usize = 0;
const DAMPING: usize = 1;
const ENGINE_SKEW: usize = 2;
const TORQUE_SKEW: usize = 3;
const INERTIA: usize = 4;
/// Once-a-turn errors of ω_d and ω_e.
const DYNO_TURN: [usize; 2] = [5, 6];
const ENGINE_TURN: [usize; 2] = [7, 8];
const COUNT: usize = 9;

/// Sizes that differences are measured by where a parameter is small: K, B, skews, J_d, once-a-turn errors.
const SIZES: [f64; COUNT] = [1.0, 0.1, 1e-3, 1e-3, 1e-2, 1e-3, 1e-3, 1e-3, 1e-3];

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
    fn equation(&self, s: Complex64, theta: &[f64]) -> Row {
        let one = Complex64::from(1.0);
        let [k, b, inertia] = [theta[STIFFNESS], theta[DAMPING], theta[INERTIA]];
        let late = (s * theta[ENGINE_SKEW]).exp();
        let engine = [-late * k, -late * b, 0.0 * one];
        self.with_turns(s, theta, [one * k, one * b, one * inertia], engine)
    }

    /// An equation of the torque's first derivative, from what it does to the two speeds.
    fn with_turns(&self, s: Complex64, theta: &[f64], dyno: Orders, engine: Orders) -> Row {
        let mut row = [[Complex64::default(); 3]; SIGNALS];
        (row[DYNO], row[ENGINE]) = (dyno, engine);
        row[TORQUE][1] = self.torque_factor(s, theta);
        for k in 0..2 {
            row[DYNO_WAVES[k]] = dyno.map(|c| -theta[DYNO_TURN[k]] * c);
            row[ENGINE_WAVES[k]] = engine.map(|c| -theta[ENGINE_TURN[k]] * c);
        }
        row
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
                // What equal white noise of both encoders would have.
                let power = |orders: Orders| {
                    orders.iter().rev().fold(Complex64::default(), |sum, c| sum * self.lines.s(k) + c).norm_sqr()
                };
                shapes.push(power(c[DYNO]) + power(c[ENGINE]));
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
        let mut bounds = [Bounds::NONE; COUNT];
        bounds[..=INERTIA].copy_from_slice(&[positive, positive, skew, skew, positive]);
        if let Some((value, 0.0)) = self.prior {
            bounds[INERTIA] = Bounds::new(value, value);
        }
        let fit = minimise(self, &start, &bounds, NonlinearOptions::default())?;
        let nu = self.lines.freedom();
        let inflation = if nu > 2.0 { nu / (nu - 2.0) } else { nu };
        let covariance = faer::Scale(inflation) * &fit.unscaled_covariance;
        Ok((fit, covariance))
    }

    /// The test of the cost; what is known of J_d and of the encoders beforehand counts for itself.
    fn cost(&self, fit: &Minimum) -> CostTest {
        let (residuals, known) = fit.residuals.split_at(2 * self.lines.count());
        let told = known.iter().filter(|r| **r != 0.0).count();
        let free = fit.at_bound.iter().filter(|b| !**b).count().saturating_sub(told);
        let squares: f64 = residuals.iter().map(|r| r * r).sum();
        cost_test(0.5 * squares, (residuals.len() as f64 - free as f64).max(1.0), self.lines.freedom())
    }

    /// K and B by least squares without skew, J_d as stated.
    fn start(&self) -> [f64; COUNT] {
        let (mut left, mut right) = ([[0.0; 2]; 2], [0.0; 2]);
        for k in 0..self.lines.count() {
            let (s, z) = (self.lines.s(k), self.lines.mean(k));
            let twist = z[ENGINE][0] - z[DYNO][0];
            let rate = self.stated * z[DYNO][2] + self.torque_factor(s, &[0.0; COUNT]) * z[TORQUE][1];
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
        let mut start = [0.0; COUNT];
        (start[STIFFNESS], start[DAMPING], start[INERTIA]) = (sane(stiffness, 1.0), sane(damping, 1e-2), self.stated);
        start
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
        2 * self.lines.count() + 5
    }

    /// √2 e/σ, real and imaginary part in turn, each of variance one; then what is known of J_d and of the encoders.
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
            let known = 2 * shaft.lines.count();
            values[known] = match shaft.prior {
                Some((value, uncertainty)) if uncertainty > 0.0 => (theta[INERTIA] - value) / uncertainty,
                _ => 0.0,
            };
            let turns = values[known + 1..].iter_mut().zip(&theta[DYNO_TURN[0]..]);
            turns.for_each(|(value, amplitude)| *value = amplitude / ECCENTRICITY);
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
    fn new(shaft: &'a Shaft<'a>, inputs: &ShaftInputs<'_>, engine: Engine) -> Result<Self, String> {
        let periods = shaft.lines.periods();
        if periods < FEWEST_FOR_ENGINE {
            return Err(format!(
                "J_e needs {FEWEST_FOR_ENGINE} periods to weigh the engine's torque by its scatter, and {periods} were \
                 recorded; record longer"
            ));
        }
        let turns_per_s = inputs.engine_speed.mean().unwrap_or(0.0).abs().max(SLOWEST_RAD_S) / TAU;
        if shaft.lines.coherence > COHERENT {
            return Err("J_e is not told: the engine's cycles repeat with the demand, so that its torque does not average out; \
                        record at a speed some 1 % higher"
                .to_owned());
        }
        let half_firing_s = 0.5 / (engine.firings_per_turn() * turns_per_s);
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
        let nu = (lines.periods() - 1) as f64;
        let freedom = (2 * lines.count() - ENGINE_UNKNOWNS + 1) as f64;
        let squares: f64 = held.residuals.iter().take(2 * lines.count()).map(|r| r * r).sum();
        let inertia = held.parameters[0];
        let cost = cost_test(0.5 * squares, freedom, nu);
        Ok(EngineFit {
            inertia_kg_m2: inertia,
            // As uncertain as what another control would make of the same data; uniform between the two and as far beyond.
            variance: held.unscaled_covariance[(0, 0)] * nu / (nu - 2.0) * cost.inflation()
                + through
                + (delayed - inertia).powi(2) / 3.0,
            with_shaft,
            cost,
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

    fn equation(&self, s: Complex64, p: &[f64]) -> Row {
        let theta = &self.theta;
        let x = 2.0 * s * p[HOLD];
        let late = match self.control {
            Control::Held => (1.0 - (-x).exp()) / x,
            Control::Delayed => (-0.5 * x).exp(),
        };
        let skew = (s * theta[ENGINE_SKEW]).exp();
        let dyno = [Complex64::default(), Complex64::default(), Complex64::from(theta[INERTIA])];
        let engine = [late * skew * p[2], late * skew * p[1], skew * p[0]];
        self.shaft.with_turns(s, theta, dyno, engine)
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
