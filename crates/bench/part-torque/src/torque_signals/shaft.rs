//! The shaft torque rebuilt from N_d and T_d, T_shaft = J_d dω_d/dt + T_d (6.1): by a fixed-interval smoother, which
//! says how certain it is, and by a filter without phase shift beside it.

use faer::Mat;
use ident::IdentError;
use numerics::null::nan_if_null;
use part_controller::speed_controller::Encoder;
use rig::estimation::{EstimateError, noise_floor};
use rig::facts::Engine;
use rig::results::Trace;
use rig::{Experiment, Role};
use serde::{Deserialize, Serialize};
use signal::Signal;
use signal::zero_phase::{Wanted, ZeroPhase};

use super::routes;
use crate::torque_control::TorqueControlFit;
use crate::torque_smoother::{
    Clock, Mechanics, NoiseLevels, Observations, Prepared, Stamps, TorqueSmoother, TorqueSource, firing_lines,
};

/// Up to where the filter without phase shift passes, Hz.
const BAND_HZ: f64 = 120.0;
/// The highest multiple of the firing frequency that is modelled, as a part of half the rate of N_d.
const HIGHEST_LINE: f64 = 0.5;
/// The noise levels are estimated from so much of the recording's middle, s.
const FOR_LEVELS_S: f64 = 8.0;
/// Standard deviation of ω_d at the start, rad/s.
const START_RAD_S: f64 = 1.0;
/// The filter answers an impulse for less than this before and after it, s.
const IMPULSE_S: f64 = 0.2;
/// Least noise of a speed, rad/s.
const LEAST_NOISE_RAD_S: f64 = 1e-6;

/// The shaft torque of a recording.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RebuiltShaft {
    /// Instant of the first value, s of the clock of N_d.
    #[serde(deserialize_with = "nan_if_null")]
    pub start_s: f64,
    /// Time between values, s.
    #[serde(deserialize_with = "nan_if_null")]
    pub sample_time_s: f64,
    /// By the smoother, Nm.
    #[serde(deserialize_with = "nan_if_null")]
    pub smoothed_nm: Vec<f64>,
    /// Its standard deviation, Nm. Where the two routes differ by more than their noise, it holds the difference.
    #[serde(deserialize_with = "nan_if_null")]
    pub standard_deviation_nm: Vec<f64>,
    /// By how much the two routes differ beyond their noise, root mean square, Nm.
    #[serde(deserialize_with = "nan_if_null")]
    pub routes_apart_nm: f64,
    /// By the filter without phase shift, Nm.
    #[serde(deserialize_with = "nan_if_null")]
    pub zero_phase_nm: Vec<f64>,
    /// The system's own T_d,shaft,calc as it was recorded, where it was.
    pub system: Option<Trace>,
    /// Source of T_d.
    pub torque: TorqueSource,
    /// Noise levels.
    pub noise: NoiseLevels,
    /// The once-a-turn error of the encoder.
    pub once_a_turn: OnceATurn,
}

/// Effect of the once-a-turn error of the dynamometer's encoder on the shaft torque. Once a turn it cannot be separated
/// from a motion, unless a speed controller that reads another speed answers the motion alone.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum OnceATurn {
    /// Known from the speed controller and taken out of N_d: its amplitude as a torque, Nm.
    TakenOut(f64),
    /// Not known: an error of 10⁻⁴ of the speed appears in T_shaft at order 1 with this amplitude, Nm, which is not in
    /// the standard deviation.
    Unknown(f64),
}

/// Knowledge beside the recording.
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
    let Prepared { speed, encoder, torque, source } =
        Prepared::new(experiment, known.torque_control, known.encoder, known.stated_gate_s)?;
    let failed = |source: IdentError| EstimateError::Ident { file: experiment.file.clone(), source };
    let stamps = Stamps { first_s: speed.start_s, step_s: speed.sample_time_s, count: speed.len() };
    let clock = Clock::new(&experiment.file, stamps, &torque, 0.0, encoder.gate_s)?;
    let lines_hz = firing_lines(experiment, known.engine, &speed, HIGHEST_LINE * speed.nyquist_hz());
    let observed = observations(&clock, &speed, lines_hz);
    let mechanics = dynamometer(known.inertia_kg_m2);
    let smoother = TorqueSmoother { mechanics: &mechanics, observed: &observed };
    let levels = smoother.levels(FOR_LEVELS_S).map_err(failed)?;
    let smoothed = smoother.smooth(&levels).map_err(failed)?;
    let (smoothed_nm, of_noise_nm) = smoothed.combination(&smoother.weights()).map_err(failed)?;
    let noise = smoother.noise(&levels).map_err(failed)?;
    let (count, widening) = (smoothed_nm.len(), noise.widening);
    let filtered = |x: &Signal, wanted, gate_s, late_s: f64| {
        ZeroPhase { band_hz: BAND_HZ, gate_s, wanted }.at(x, clock.start_s + late_s, speed.sample_time_s, count)
    };
    let slope = filtered(&speed, Wanted::Derivative, encoder.gate_s, 0.5 * encoder.gate_s);
    let torque = filtered(&torque, Wanted::Value, 0.0, 0.0);
    let zero_phase_nm: Vec<f64> = slope.iter().zip(&torque).map(|(a, t)| known.inertia_kg_m2 * a + t).collect();
    let smoothed = Signal { start_s: clock.start_s, sample_time_s: speed.sample_time_s, samples: smoothed_nm };
    let in_band = filtered(&smoothed, Wanted::Value, 0.0, 0.0);
    let apart: Vec<f64> = zero_phase_nm.iter().zip(&in_band).map(|(filter, smoother)| filter - smoother).collect();
    let noise_nm = known.inertia_kg_m2 * observed.noise_rad_s[0] * slope_noise(&speed, encoder.gate_s);
    let band_hz = BAND_HZ.min(speed.nyquist_hz());
    let apart = routes::beyond_noise(&apart, noise_nm * noise_nm, speed.sample_time_s, band_hz);
    let mean = speed.mean().unwrap_or(0.0);
    Ok(RebuiltShaft {
        start_s: clock.start_s,
        sample_time_s: speed.sample_time_s,
        zero_phase_nm,
        smoothed_nm: smoothed.samples,
        standard_deviation_nm: of_noise_nm
            .iter()
            .zip(&apart)
            .map(|(one, apart)| (widening * one).hypot(*apart))
            .collect(),
        routes_apart_nm: (apart.iter().map(|x| x * x).sum::<f64>() / apart.len().max(1) as f64).sqrt(),
        system: experiment.signal(Role::SystemShaftTorque).map(|recorded| Trace {
            start_s: recorded.start_s,
            sample_time_s: recorded.sample_time_s,
            values: recorded.samples.clone(),
        }),
        torque: source,
        noise,
        once_a_turn: match encoder.eccentricity() {
            0.0 => OnceATurn::Unknown(1e-4 * known.inertia_kg_m2 * mean * mean),
            error => OnceATurn::TakenOut(error * known.inertia_kg_m2 * mean * mean),
        },
    })
}

/// The standard deviation that the filter's derivative makes of white noise of one, in 1/s: the root of the sum of the
/// squares of its answer to an impulse.
fn slope_noise(speed: &Signal, gate_s: f64) -> f64 {
    let half = (IMPULSE_S / speed.sample_time_s).ceil() as usize;
    let mut samples = vec![0.0; 2 * half + 1];
    samples[half] = 1.0;
    let impulse = Signal { start_s: 0.0, sample_time_s: speed.sample_time_s, samples };
    let filter = ZeroPhase { band_hz: BAND_HZ, gate_s, wanted: Wanted::Derivative };
    let answer = filter.at(&impulse, 0.5 * gate_s, speed.sample_time_s, 2 * half + 1);
    answer.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// J_d dω_d/dt = T_shaft − T_d.
fn dynamometer(inertia_kg_m2: f64) -> Mechanics {
    Mechanics {
        a: Mat::zeros(1, 1),
        by_air_gap: vec![-1.0 / inertia_kg_m2],
        by_sought: vec![1.0 / inertia_kg_m2],
        measured: vec![0],
        at_rest: vec![0.0],
        start: vec![START_RAD_S],
    }
}

fn observations(clock: &Clock, speed: &Signal, lines_hz: Vec<f64>) -> Observations {
    let read = &speed.samples[clock.used.clone()];
    Observations {
        start_s: clock.start_s,
        sample_time_s: speed.sample_time_s,
        first_rad_s: read[0],
        speeds: Mat::from_fn(read.len(), 1, |k, _| read[k] - read[0]),
        torque: Mat::from_fn(read.len(), 1, |k, _| clock.torque_nm[k]),
        lines_hz,
        noise_rad_s: vec![noise_floor(speed).max(LEAST_NOISE_RAD_S)],
    }
}
