//! The shaft torque rebuilt from N_d and T_d, T_shaft = J_d dω_d/dt + T_d (6.1): by a fixed-interval smoother, which says how
//! certain it is, and by a filter without phase shift beside it.
//!
//! The smoother's model: T_shaft wanders (its slope is a random walk) and swings at the firing frequency and its multiples
//! (damped oscillators that noise drives); ω_d answers it and T_d exactly; what is wrong with T_d is white; N_d is the mean
//! of ω_d over a sample, with white noise. The levels of the noises are those of greatest likelihood.

use std::f64::consts::TAU;

use faer::Mat;
use ident::smoothing::{Belief, NoisySystem, likeliest};
use ident::{Bounds, IdentError};
use lti::StateSpace;
use serde::Serialize;
use signal::Signal;
use signal::resample::{Interpolation, interpolate_at};

use crate::estimate::speed_controller::Encoder;
use crate::estimate::torque_control::TorqueControlFit;
use crate::estimate::{EstimateError, noise_floor};
use crate::model::Engine;
use crate::replay::{EncoderError, Wanted, ZeroPhase, encoder_error};
use crate::study::inverter_of;
use crate::{Experiment, Role};

/// Shortest recording, s.
const SHORTEST_S: f64 = 2.0;
/// The noise levels are estimated from so much of its middle, s.
const LEVELS_S: f64 = 8.0;
/// Up to where the filter without phase shift passes, Hz.
const BAND_HZ: f64 = 120.0;
/// Multiples of the firing frequency that are modelled, and the highest as a part of half the rate of N_d.
const LINES: (usize, f64) = (3, 0.5);
/// Instants at which T_d is read within a sample of N_d.
const WITHIN: usize = 4;
/// Standard deviations at the start: of ω_d, rad/s; T_shaft, Nm; its slope, Nm/s.
const START: (f64, f64, f64) = (1.0, 300.0, 1e4);
/// ln of the density of the slope's noise where the search starts, tried one after the other, (Nm/s)²/s.
const WANDERING: [f64; 4] = [9.0, 13.0, 17.0, 21.0];
/// Amplitude of a line, Nm, and its damping ratio, where the search starts.
const LINE: (f64, f64) = (5.0, 0.01);
/// Range of every logarithm.
const LOGARITHM: f64 = 30.0;

/// Where T_d comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum TorqueSource {
    /// T_d* through the torque control that was estimated, with the ripple of this recording.
    Modelled,
    /// T_d,calc.
    Calculated,
}

/// The noise levels of greatest likelihood.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NoiseLevels {
    /// Standard deviation of a sample of N_d, rad/s.
    pub speed_rad_s: f64,
    /// Spectral density of the error of T_d, Nm/√Hz.
    pub torque_nm_per_root_hz: f64,
    /// Spectral density of the noise in the second derivative of T_shaft, Nm/s²/√Hz.
    pub wandering_nm_s2_per_root_hz: f64,
    /// Firing frequency and multiples, Hz, with the amplitude that the model expects, Nm.
    pub lines: Vec<(f64, f64)>,
    /// Whether the search reached a maximum.
    pub converged: bool,
    /// Variance of the innovations at lag one over that at lag zero: near zero where the model is right.
    pub innovations_correlation: f64,
}

/// The shaft torque of a recording.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RebuiltShaft {
    /// Instant of the first value, s of the clock of N_d.
    pub start_s: f64,
    /// Time between values, s.
    pub sample_time_s: f64,
    /// By the smoother, Nm.
    pub smoothed_nm: Vec<f64>,
    /// Its standard deviation, Nm.
    pub standard_deviation_nm: Vec<f64>,
    /// By the filter without phase shift, Nm.
    pub zero_phase_nm: Vec<f64>,
    /// What T_d was taken from.
    pub torque: TorqueSource,
    /// Noise levels.
    pub noise: NoiseLevels,
    /// The once-a-turn error of the encoder.
    pub once_a_turn: OnceATurn,
}

/// What the once-a-turn error of the dynamometer's encoder does to the shaft torque. Once a turn it cannot be told from a motion,
/// unless a speed controller that reads another speed answers the motion alone.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum OnceATurn {
    /// Known from the speed controller and taken out of N_d: its amplitude as a torque, Nm.
    TakenOut(f64),
    /// Not known: an error of 10⁻⁴ of the speed stands in T_shaft at order 1 with this amplitude, Nm, which is not in the
    /// standard deviation.
    Unknown(f64),
}

/// What is known beside the recording.
pub(super) struct Known<'a> {
    pub(super) inertia_kg_m2: f64,
    pub(super) engine: Engine,
    pub(super) torque_control: Option<&'a TorqueControlFit>,
    pub(super) encoder: Option<Encoder>,
    pub(super) stated_gate_s: Option<f64>,
}

/// Rebuilds the shaft torque of a recording.
///
/// # Errors
/// N_d or T_d,calc is missing or too short; noise levels that cannot be found.
pub(super) fn rebuild(experiment: &Experiment, known: &Known<'_>) -> Result<RebuiltShaft, EstimateError> {
    let measured = needed(experiment, Role::DynoSpeed)?;
    let calculated = needed(experiment, Role::AirGapTorque)?;
    let encoder = Encoder::known_or_assumed(known.encoder, measured, known.stated_gate_s);
    let once = known.encoder.map(|_| EncoderError { cosine: encoder.once_a_turn.0, sine: encoder.once_a_turn.1 });
    let error = encoder_error(measured, once);
    let speed = measured.with_samples(measured.samples.iter().zip(&error).map(|(n, e)| n - e).collect());
    let modelled = inverter_of(experiment, known.torque_control)
        .map(|(demand, inverter)| inverter.finer_air_gap_torque(demand, 2 * WITHIN));
    let (torque, source) = match &modelled {
        Some(torque) => (torque, TorqueSource::Modelled),
        None => (calculated, TorqueSource::Calculated),
    };
    let failed = |source: IdentError| EstimateError::Ident { file: experiment.file.clone(), source };
    let bench = Bench::new(experiment, &speed, torque, encoder.gate_s, known)?;
    let levels = bench.levels().map_err(failed)?;
    let (system, start) = bench.system(&levels.0, levels.1).map_err(failed)?;
    let smoothed = system.smooth(&start, bench.torque.as_ref(), bench.speed.as_ref()).map_err(failed)?;
    let innovations = system.innovations(&start, bench.torque.as_ref(), bench.speed.as_ref()).map_err(failed)?;
    let (smoothed_nm, standard_deviation_nm) = smoothed.combination(&bench.shaft_weights()).map_err(failed)?;
    let count = smoothed_nm.len();
    let filtered = |x: &Signal, wanted, gate_s, late_s: f64| {
        ZeroPhase { band_hz: BAND_HZ, gate_s, wanted }.at(x, bench.start_s + late_s, speed.sample_time_s, count)
    };
    let slope = filtered(&speed, Wanted::Derivative, encoder.gate_s, 0.5 * encoder.gate_s);
    let torque = filtered(torque, Wanted::Value, 0.0, 0.0);
    let mean = speed.mean().unwrap_or(0.0);
    Ok(RebuiltShaft {
        start_s: bench.start_s,
        sample_time_s: speed.sample_time_s,
        zero_phase_nm: slope.iter().zip(&torque).map(|(a, t)| known.inertia_kg_m2 * a + t).collect(),
        smoothed_nm,
        standard_deviation_nm,
        torque: source,
        noise: bench.noise(&levels.0, levels.1, levels.2, &innovations),
        once_a_turn: match encoder.eccentricity() {
            0.0 => OnceATurn::Unknown(1e-4 * known.inertia_kg_m2 * mean * mean),
            error => OnceATurn::TakenOut(error * known.inertia_kg_m2 * mean * mean),
        },
    })
}

fn needed(experiment: &Experiment, role: Role) -> Result<&Signal, EstimateError> {
    let file = || experiment.file.clone();
    let signal = experiment.signal(role).ok_or_else(|| EstimateError::MissingSignal { file: file(), role })?;
    if signal.duration_s() < SHORTEST_S {
        return Err(EstimateError::TooShort { file: file(), duration_s: signal.duration_s(), needed_s: SHORTEST_S });
    }
    Ok(signal)
}

/// A recording as the smoother sees it. Its states: mean of ω_d over the sample, ω_d, the wandering part of T_shaft, its
/// slope, and two for each line.
struct Bench {
    start_s: f64,
    sample_time_s: f64,
    inertia_kg_m2: f64,
    /// N_d without its first value, one column.
    speed: Mat<f64>,
    /// Mean of T_d from each sample to the next, one column.
    torque: Mat<f64>,
    lines_hz: Vec<f64>,
    noise_rad_s: f64,
}

impl Bench {
    fn new(
        experiment: &Experiment,
        speed: &Signal,
        torque: &Signal,
        gate_s: f64,
        known: &Known<'_>,
    ) -> Result<Self, EstimateError> {
        let failed = |source| EstimateError::Signal { file: experiment.file.clone(), source };
        let step = speed.sample_time_s;
        // The mean over a gate, taken for that over a sample about the same instant.
        let shift = 0.5 * (step - gate_s);
        let is_inside = |i: &usize| {
            let t = speed.time_s(*i) + shift;
            t >= torque.start_s && t + step <= torque.end_s()
        };
        let used: Vec<usize> = (0..speed.len()).filter(is_inside).collect();
        let duration_s = used.len() as f64 * step;
        if duration_s < SHORTEST_S {
            return Err(EstimateError::TooShort { file: experiment.file.clone(), duration_s, needed_s: SHORTEST_S });
        }
        let start_s = speed.time_s(used[0]) + shift;
        let instants: Vec<f64> = (0..used.len() * WITHIN)
            .map(|k| start_s + ((k / WITHIN) as f64 + ((k % WITHIN) as f64 + 0.5) / WITHIN as f64) * step)
            .collect();
        let way = if torque.sample_time_s > step { Interpolation::BandLimited } else { Interpolation::Linear };
        let within = interpolate_at(torque, &instants, way).map_err(failed)?;
        let mean: Vec<f64> = within.chunks_exact(WITHIN).map(|part| part.iter().sum::<f64>() / WITHIN as f64).collect();
        let first = speed.samples[used[0]];
        let turning_hz = speed.mean().unwrap_or(0.0).abs() / TAU;
        let firing_hz = f64::from(known.engine.cylinders) / (0.5 * f64::from(known.engine.strokes)) * turning_hz;
        let highest_hz = LINES.1 * speed.nyquist_hz();
        let has_shaft = !experiment.label.is_without_shaft();
        let lines = (1..=LINES.0).map(|k| k as f64 * firing_hz).filter(|hz| has_shaft && *hz > 1.0 && *hz < highest_hz);
        Ok(Bench {
            start_s,
            sample_time_s: step,
            inertia_kg_m2: known.inertia_kg_m2,
            speed: Mat::from_fn(used.len(), 1, |k, _| speed.samples[used[k]] - first),
            torque: Mat::from_fn(used.len(), 1, |k, _| mean[k]),
            lines_hz: lines.collect(),
            noise_rad_s: noise_floor(speed).max(1e-6),
        })
    }

    fn states(&self) -> usize {
        4 + 2 * self.lines_hz.len()
    }

    /// What of the states is T_shaft.
    fn shaft_weights(&self) -> Vec<f64> {
        (0..self.states()).map(|i| f64::from(u8::from(i == 2 || (i >= 4 && i % 2 == 0)))).collect()
    }

    /// The model at logarithms of noise densities [wandering, error of T_d, damping ratio, one a line], all covariances times
    /// `scale`.
    fn system(&self, logarithms: &[f64], scale: f64) -> Result<(NoisySystem, Belief), IdentError> {
        let (n, step) = (self.states(), self.sample_time_s);
        let shaft = self.shaft_weights();
        let damping = if self.lines_hz.is_empty() { 0.0 } else { logarithms[2].exp() };
        let mut a = Mat::<f64>::zeros(n, n);
        let mut density = Mat::<f64>::zeros(n, n);
        a[(0, 1)] = 1.0;
        (0..n).for_each(|j| a[(1, j)] = shaft[j] / self.inertia_kg_m2);
        a[(2, 3)] = 1.0;
        density[(3, 3)] = scale * logarithms[0].exp();
        density[(1, 1)] = scale * logarithms[1].exp() / self.inertia_kg_m2.powi(2);
        for (k, hz) in self.lines_hz.iter().enumerate() {
            let (at, omega) = (4 + 2 * k, TAU * hz);
            for i in [at, at + 1] {
                a[(i, i)] = -damping * omega;
                density[(i, i)] = scale * logarithms[3 + k].exp();
            }
            (a[(at, at + 1)], a[(at + 1, at)]) = (omega, -omega);
        }
        let b = Mat::from_fn(n, 1, |i, _| if i == 1 { -1.0 / self.inertia_kg_m2 } else { 0.0 });
        let c = Mat::from_fn(1, n, |_, j| f64::from(u8::from(j == 0)));
        let continuous = StateSpace::continuous(a, b, c.clone(), Mat::zeros(1, 1))?;
        let process = continuous.sampled_noise(density.as_ref(), step)?;
        let held = continuous.to_discrete_zoh(step)?;
        // The first state is the angle turned in a sample over the sample's length: it starts anew with every sample.
        let unit = |i: usize| if i == 0 { 1.0 / step } else { 1.0 };
        let transition = Mat::from_fn(n, n, |i, j| if j == 0 { 0.0 } else { unit(i) * held.a()[(i, j)] });
        let input = Mat::from_fn(n, 1, |i, _| unit(i) * held.b()[(i, 0)]);
        let process = Mat::from_fn(n, n, |i, j| unit(i) * unit(j) * process[(i, j)]);
        let sampled = StateSpace::discrete(transition, input, c, Mat::zeros(1, 1), step)?;
        let system = NoisySystem::new(sampled, process, vec![scale * self.noise_rad_s.powi(2)])?;
        Ok((system, self.start()))
    }

    /// ω_d near the first reading, T_shaft somewhere about T_d.
    fn start(&self) -> Belief {
        let deviation = |i: usize| match i {
            0 | 1 => START.0,
            3 => START.2,
            _ => START.1,
        };
        let n = self.states();
        let mean = (0..n).map(|i| if i == 2 { self.torque[(0, 0)] } else { 0.0 }).collect();
        let covariance = Mat::from_fn(n, n, |i, j| match (i, j) {
            (i, j) if i == j => deviation(i).powi(2),
            _ => 0.0,
        });
        Belief { mean, covariance }
    }

    /// The likeliest logarithms, the scale of all, and whether the search converged; from the middle of the recording.
    fn levels(&self) -> Result<(Vec<f64>, f64, bool), IdentError> {
        let rows = ((LEVELS_S / self.sample_time_s) as usize).min(self.speed.nrows());
        let from = (self.speed.nrows() - rows) / 2;
        let first = self.speed[(from, 0)];
        let speed = Mat::from_fn(rows, 1, |k, _| self.speed[(from + k, 0)] - first);
        let torque = Mat::from_fn(rows, 1, |k, _| self.torque[(from + k, 0)]);
        let part = Bench { speed, torque, lines_hz: self.lines_hz.clone(), ..*self };
        let likelihood = |start: &Vec<f64>| -> Result<f64, IdentError> {
            let (system, belief) = part.system(start, 1.0)?;
            system.log_likelihood(&belief, part.torque.as_ref(), part.speed.as_ref())
        };
        let mut starts = WANDERING.iter().map(|w| part.start_logarithms(*w)).collect::<Vec<_>>();
        let mut best = (f64::NEG_INFINITY, starts[0].clone());
        for start in starts.drain(..) {
            let found = likelihood(&start)?;
            if found > best.0 {
                best = (found, start);
            }
        }
        let bounds = vec![Bounds::new(-LOGARITHM, LOGARITHM); best.1.len()];
        let at = |p: &[f64]| part.system(p, 1.0);
        let found = likeliest(&best.1, &bounds, at, part.torque.as_ref(), part.speed.as_ref())?;
        Ok((found.parameters, found.scale, found.termination.converged()))
    }

    fn start_logarithms(&self, wandering: f64) -> Vec<f64> {
        let mut all = vec![wandering, 1e-4_f64.ln()];
        if !self.lines_hz.is_empty() {
            all.push(LINE.1.ln());
        }
        // A damped oscillator of density q holds the power q/(2 ζω) in each of its two states.
        let line = |(k, hz): (usize, &f64)| {
            let amplitude = LINE.0 / (k + 1) as f64;
            (amplitude.powi(2) * LINE.1 * TAU * hz).ln()
        };
        all.extend(self.lines_hz.iter().enumerate().map(line));
        all
    }

    fn noise(&self, logarithms: &[f64], scale: f64, converged: bool, innovations: &[f64]) -> NoiseLevels {
        let density = |logarithm: f64| (scale * logarithm.exp()).sqrt();
        let line = |(k, hz): (usize, &f64)| {
            let power = scale * (logarithms[3 + k] - logarithms[2]).exp() / (2.0 * TAU * hz);
            (*hz, (2.0 * power).sqrt())
        };
        let power: f64 = innovations.iter().map(|v| v * v).sum();
        let next: f64 = innovations.windows(2).map(|w| w[0] * w[1]).sum();
        NoiseLevels {
            speed_rad_s: scale.sqrt() * self.noise_rad_s,
            torque_nm_per_root_hz: density(logarithms[1]),
            wandering_nm_s2_per_root_hz: density(logarithms[0]),
            lines: self.lines_hz.iter().enumerate().map(line).collect(),
            converged,
            innovations_correlation: next / power,
        }
    }
}
