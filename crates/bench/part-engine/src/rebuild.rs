//! T_e of one recording.

use faer::Mat;
use fitting::IdentError;
use fitting::smoothing::Smoothed;
use numerics::null::nan_if_null;
use numerics::parallel;
use part_controller::speed_controller::SpeedControllerFit;
use part_torque::torque_control::TorqueControlFit;
use part_torque::torque_smoother::{
    Clock, Levels, Mechanics, NoiseLevels, Observations, Prepared, Stamps, TorqueSmoother, TorqueSource, firing_lines,
    needed,
};
use rig::estimation::{EstimateError, noise_floor};
use rig::facts::Engine;
use rig::{Experiment, Role};
use serde::{Deserialize, Serialize};
use signal::Signal;
use signal::resample::{Interpolation, interpolate_at};
use signal::zero_phase::{Wanted, ZeroPhase};

use super::source::{TwoMasses, Values};

/// Up to where the filter without phase shift passes, Hz.
const BAND_HZ: f64 = 120.0;
/// Standard deviation of the speeds at the start, rad/s.
const START_SPEED_RAD_S: f64 = 1.0;
/// Standard deviation of the torque in the shaft at the start, Nm.
const START_SHAFT_NM: f64 = 300.0;
/// Least noise of a speed, rad/s.
const LEAST_NOISE_RAD_S: f64 = 1e-6;
/// The highest multiple of the firing frequency that is modelled, as a part of half the rate of N_d. N_d and the drift
/// of the speed separate the aliases in N_e from true lines, as far as they can.
const HIGHEST_LINE: f64 = 0.95;
/// The noise levels are estimated from so much of the recording's middle, s.
const FOR_LEVELS_S: f64 = 4.0;
/// The error of an encoder, of the speed, whose effect at order 1 is stated.
pub(super) const ENCODER_ERROR: f64 = 1e-4;
/// States of the mechanics: twist, ω_d, ω_e.
const TWIST: usize = 0;
const DYNO: usize = 1;
const ENGINE: usize = 2;

/// The engine's torque of a recording.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RebuiltEngine {
    /// Instant of the first value, s of the clock of N_d.
    #[serde(deserialize_with = "nan_if_null")]
    pub start_s: f64,
    /// Time between values, s.
    #[serde(deserialize_with = "nan_if_null")]
    pub sample_time_s: f64,
    /// By the smoother, Nm.
    #[serde(deserialize_with = "nan_if_null")]
    pub smoothed_nm: Vec<f64>,
    /// Its standard deviation, Nm: of noise, as wide as the innovations show ([`NoiseLevels::widening`]), and of the
    /// masses and the shaft together.
    #[serde(deserialize_with = "nan_if_null")]
    pub standard_deviation_nm: Vec<f64>,
    /// The part of it that is of the masses and the shaft, Nm, which longer recordings do not average out.
    #[serde(deserialize_with = "nan_if_null")]
    pub of_masses_nm: Vec<f64>,
    /// By a filter without phase shift, Nm.
    #[serde(deserialize_with = "nan_if_null")]
    pub zero_phase_nm: Vec<f64>,
    /// Source of T_d.
    pub torque: TorqueSource,
    /// Noise levels.
    pub noise: NoiseLevels,
    /// Amplitude at order 1, Nm, of what an error of 10⁻⁴ of the speed, once a turn, of the engine's encoder makes: it
    /// cannot be separated from a motion, and widens the standard deviation only as far as the innovations show it.
    #[serde(deserialize_with = "nan_if_null")]
    pub once_a_turn_nm: f64,
}

/// Motion that the smoother found.
pub(super) struct Motion {
    /// ω_e, rad/s, at the instants of the torque.
    pub(super) engine_speed_rad_s: Vec<f64>,
    /// Integral of T_e up to every instant, Nm s: the change of J_d ω_d + J_e ω_e and what T_d and the slope of the
    /// friction took.
    pub(super) impulse: Vec<f64>,
    /// Variance of J_d ω_d + J_e ω_e at every instant by noise, as wide as the innovations show, (Nm s)².
    pub(super) momentum_variance: Vec<f64>,
    /// Spectral density of the error of T_d, Nm²/Hz.
    pub(super) torque_density: f64,
}

/// Knowledge beside the recording.
pub(super) struct Known<'a> {
    pub(super) engine: Engine,
    pub(super) stated_gate_s: Option<f64>,
    pub(super) controller: Option<&'a SpeedControllerFit>,
    pub(super) torque_control: Option<&'a TorqueControlFit>,
}

/// Rebuilds the engine's torque of a recording.
///
/// # Errors
/// N_d, N_e or T_d,calc is missing or too short; noise levels that cannot be found.
pub(super) fn rebuild(
    experiment: &Experiment,
    masses: &TwoMasses,
    known: &Known<'_>,
) -> Result<(RebuiltEngine, Motion), EstimateError> {
    let encoder = known.controller.map(|fit| fit.encoder);
    let engine_speed = needed(experiment, Role::EngineSpeed)?;
    let dyno = Prepared::new(experiment, known.torque_control, encoder, known.stated_gate_s)?;
    let lines_hz = firing_lines(experiment, known.engine, engine_speed, HIGHEST_LINE * dyno.speed.nyquist_hz());
    let recorded = Recorded { file: &experiment.file, dyno, engine_speed, lines_hz };
    let failed = |source: IdentError| EstimateError::Ident { file: experiment.file.clone(), source };
    let values = Values::of(&masses.values);
    let (mechanics, observed) = (two_masses(&values), recorded.observations(&values)?);
    let smoother = TorqueSmoother { mechanics: &mechanics, observed: &observed };
    let levels = smoother.levels(FOR_LEVELS_S).map_err(failed)?;
    let smoothed = smoother.smooth(&levels).map_err(failed)?;
    let (smoothed_nm, of_noise_nm) = smoothed.combination(&smoother.weights()).map_err(failed)?;
    let of_masses_nm = recorded.of_masses(masses, &levels, observed.start_s, observed.sample_time_s, &smoothed_nm)?;
    let noise = smoother.noise(&levels).map_err(failed)?;
    let widening = noise.widening;
    let motion = motion(&smoother, &smoothed, &values, observed.first_rad_s, &noise).map_err(failed)?;
    let mean = recorded.engine_speed.mean().unwrap_or(0.0);
    let engine = RebuiltEngine {
        start_s: observed.start_s,
        sample_time_s: observed.sample_time_s,
        standard_deviation_nm: of_noise_nm.iter().zip(&of_masses_nm).map(|(a, b)| (widening * a).hypot(*b)).collect(),
        zero_phase_nm: recorded.zero_phase(&values, observed.start_s, observed.sample_time_s, smoothed_nm.len()),
        smoothed_nm,
        of_masses_nm,
        torque: recorded.dyno.source,
        noise,
        once_a_turn_nm: ENCODER_ERROR * values.engine_inertia * mean * mean,
    };
    Ok((engine, motion))
}

/// J_d dω_d/dt = K φ + B dφ/dt − c_1 ω_d − T_d, J_e dω_e/dt = T_e − K φ − B dφ/dt, dφ/dt = ω_e − ω_d; the friction at
/// the mean speed counts as engine torque.
fn two_masses(v: &Values) -> Mechanics {
    let (dyno, engine) = (1.0 / v.dyno_inertia, 1.0 / v.engine_inertia);
    let mut a = Mat::zeros(3, 3);
    (a[(TWIST, DYNO)], a[(TWIST, ENGINE)]) = (-1.0, 1.0);
    (a[(DYNO, TWIST)], a[(DYNO, DYNO)], a[(DYNO, ENGINE)]) =
        (dyno * v.stiffness, -dyno * (v.damping + v.friction_slope), dyno * v.damping);
    (a[(ENGINE, TWIST)], a[(ENGINE, DYNO)], a[(ENGINE, ENGINE)]) =
        (-engine * v.stiffness, engine * v.damping, -engine * v.damping);
    Mechanics {
        a,
        by_air_gap: vec![0.0, -dyno, 0.0],
        by_sought: vec![0.0, 0.0, engine],
        measured: vec![DYNO, ENGINE],
        at_rest: vec![1.0 / v.stiffness, 0.0, 0.0],
        start: vec![START_SHAFT_NM / v.stiffness, START_SPEED_RAD_S, START_SPEED_RAD_S],
    }
}

/// A recording on its way to the smoother.
struct Recorded<'a> {
    file: &'a str,
    dyno: Prepared,
    engine_speed: &'a Signal,
    lines_hz: Vec<f64>,
}

impl Recorded<'_> {
    /// Both speeds with N_e and T_d dated as `values` has it. Rows are where N_e was read, and as many between as come
    /// nearest to the rate of N_d: pulses of the engine fold in N_e, so that nothing can be read between its samples;
    /// in N_d, behind the shaft, they hardly are.
    fn observations(&self, values: &Values) -> Result<Observations, EstimateError> {
        let (dyno, engine) = (&self.dyno.speed, self.engine_speed);
        let between = (engine.sample_time_s / dyno.sample_time_s).round().max(1.0) as usize;
        let stamps = self.stamps(values.engine_late_s, between);
        let (torque, gate_s) = (&self.dyno.torque, self.dyno.encoder.gate_s);
        let clock = Clock::new(self.file, stamps, torque, values.torque_late_s, gate_s)?;
        let read_s: Vec<f64> = clock.used.clone().map(|k| stamps.first_s + k as f64 * stamps.step_s).collect();
        let dyno_speed = interpolate_at(dyno, &read_s, Interpolation::BandLimited)
            .map_err(|source| EstimateError::Signal { file: self.file.to_owned(), source })?;
        let noise = |signal: &Signal| noise_floor(signal).max(LEAST_NOISE_RAD_S);
        let first = dyno_speed[0];
        let first_of_engine = ((stamps.first_s + values.engine_late_s - engine.start_s) / engine.sample_time_s).round();
        let reads = |k: usize, column: usize| match (column, clock.used.start + k) {
            (0, _) => dyno_speed[k] - first,
            (_, row) if row.is_multiple_of(between) => engine.samples[first_of_engine as usize + row / between] - first,
            _ => f64::NAN,
        };
        Ok(Observations {
            start_s: clock.start_s,
            sample_time_s: stamps.step_s,
            first_rad_s: first,
            speeds: Mat::from_fn(read_s.len(), 2, reads),
            torque: Mat::from_fn(read_s.len(), 1, |k, _| clock.torque_nm[k]),
            lines_hz: self.lines_hz.clone(),
            noise_rad_s: vec![noise(dyno), noise(engine)],
        })
    }

    /// From the first sample of N_e within N_d on, dated as N_d is, to the last.
    fn stamps(&self, engine_late_s: f64, between: usize) -> Stamps {
        let (dyno, engine) = (&self.dyno.speed, self.engine_speed);
        let is_inside = |k: &usize| (dyno.start_s..=dyno.end_s()).contains(&(engine.time_s(*k) - engine_late_s));
        let mut inside = (0..engine.len()).filter(is_inside);
        let first = inside.next().unwrap_or(0);
        let last = inside.next_back().unwrap_or(first);
        Stamps {
            first_s: engine.time_s(first) - engine_late_s,
            step_s: engine.sample_time_s / between as f64,
            count: (last - first) * between + 1,
        }
    }

    /// The standard deviation that masses and shaft bring, from smoothing anew one standard deviation away in every
    /// direction.
    fn of_masses(
        &self,
        masses: &TwoMasses,
        levels: &Levels,
        start_s: f64,
        step_s: f64,
        smoothed_nm: &[f64],
    ) -> Result<Vec<f64>, EstimateError> {
        let failed = |source: IdentError| EstimateError::Ident { file: self.file.to_owned(), source };
        let moved = |values: &[f64; super::source::PARAMETERS]| -> Result<(f64, Vec<f64>), EstimateError> {
            let values = Values::of(values);
            let (mechanics, observed) = (two_masses(&values), self.observations(&values)?);
            let smoother = TorqueSmoother { mechanics: &mechanics, observed: &observed };
            Ok((observed.start_s, smoother.sought(levels).map_err(failed)?))
        };
        let mut variances = vec![0.0; smoothed_nm.len()];
        for outcome in parallel::map(&masses.apart(), moved) {
            let (moved_start_s, moved) = outcome?;
            // A clock that is read a little later may lose a sample at an end.
            let shift = ((moved_start_s - start_s) / step_s).round() as isize;
            for (k, variance) in variances.iter_mut().enumerate() {
                let at = k.saturating_add_signed(-shift).min(moved.len() - 1);
                *variance += (moved[at] - smoothed_nm[k]).powi(2);
            }
        }
        Ok(variances.iter().map(|v: &f64| v.sqrt()).collect())
    }

    /// J_e dω_e/dt + J_d dω_d/dt + T_d, every term through the same low-pass.
    fn zero_phase(&self, values: &Values, start_s: f64, step: f64, count: usize) -> Vec<f64> {
        let gate_s = self.dyno.encoder.gate_s;
        let filtered = |x: &Signal, wanted, gate_s: f64, late_s: f64| {
            ZeroPhase { band_hz: BAND_HZ, gate_s, wanted }.at(x, start_s + late_s, step, count)
        };
        let dyno = filtered(&self.dyno.speed, Wanted::Derivative, gate_s, 0.5 * gate_s);
        let engine = filtered(self.engine_speed, Wanted::Derivative, gate_s, 0.5 * gate_s + values.engine_late_s);
        let torque = filtered(&self.dyno.torque, Wanted::Value, 0.0, values.torque_late_s);
        let slopes = dyno.iter().zip(&engine).map(|(d, e)| values.dyno_inertia * d + values.engine_inertia * e);
        slopes.zip(&torque).map(|(slopes, t)| slopes + t).collect()
    }
}

fn motion(
    smoother: &TorqueSmoother<'_>,
    smoothed: &Smoothed,
    values: &Values,
    first_rad_s: f64,
    noise: &NoiseLevels,
) -> Result<Motion, IdentError> {
    let states = smoother.weights().len();
    let one = |state: usize, weight: f64| (smoother.of_mechanics(state), weight);
    let weights = |parts: &[(usize, f64)]| {
        let mut all = vec![0.0; states];
        parts.iter().for_each(|(at, weight)| all[*at] = *weight);
        all
    };
    let (speed, _) = smoothed.combination(&weights(&[one(ENGINE, 1.0)]))?;
    let (dyno, _) = smoothed.combination(&weights(&[one(DYNO, 1.0)]))?;
    let parts = weights(&[one(DYNO, values.dyno_inertia), one(ENGINE, values.engine_inertia)]);
    let (momentum, deviation) = smoothed.combination(&parts)?;
    let widening = noise.widening;
    let mut taken = 0.0;
    let impulse = (0..momentum.len()).map(|k| {
        let so_far = momentum[k] - momentum[0] + taken;
        let torque = smoother.observed.torque[(k, 0)] + values.friction_slope * dyno[k];
        taken += torque * smoother.observed.sample_time_s;
        so_far
    });
    Ok(Motion {
        engine_speed_rad_s: speed.iter().map(|w| w + first_rad_s).collect(),
        impulse: impulse.collect(),
        momentum_variance: deviation.iter().map(|s| (widening * s).powi(2)).collect(),
        torque_density: noise.torque_nm_per_root_hz.powi(2),
    })
}
