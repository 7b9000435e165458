//! From a recording to the torques that acted.

use rig::estimation::EstimateError;
use rig::{Experiment, Role};
use signal::Signal;
use signal::zero_phase::{Wanted, ZeroPhase};

use super::encoder_error::encoder_error;
use crate::model::BenchModel;
use crate::replay::inputs::ReplayInputs;

/// Left out at both ends, where the filters see reflected data, s.
const EDGE_S: f64 = 0.1;
/// Shortest replay, s.
const SHORTEST_S: f64 = 1.0;

/// Motion and torques on the clock of N_d, at true time: the middle of the gate is undone, skews are undone.
pub(super) struct Acted {
    pub(super) start_s: f64,
    pub(super) step_s: f64,
    pub(super) dyno_speed: Vec<f64>,
    pub(super) engine_speed: Vec<f64>,
    pub(super) air_gap_torque: Vec<f64>,
    pub(super) shaft_torque: Vec<f64>,
    pub(super) engine_torque: Vec<f64>,
    /// N_d as recorded.
    pub(super) recorded_speed: Vec<f64>,
    /// The encoder's once-a-turn error in it.
    pub(super) encoder_error: Vec<f64>,
}

impl Acted {
    pub(super) fn len(&self) -> usize {
        self.dyno_speed.len()
    }

    pub(super) fn end_s(&self) -> f64 {
        self.start_s + self.step_s * (self.len() - 1) as f64
    }

    pub(super) fn signal(&self, samples: Vec<f64>) -> Signal {
        Signal { start_s: self.start_s, sample_time_s: self.step_s, samples }
    }
}

pub(super) fn needed(experiment: &Experiment, role: Role) -> Result<&Signal, EstimateError> {
    let missing = || EstimateError::MissingSignal { file: experiment.file.clone(), role };
    experiment.signal(role).ok_or_else(missing)
}

/// T_shaft = J_d dω_d/dt + T_d (6.1), T_e = J_e dω_e/dt + T_shaft (6.4), every term through the same low-pass.
pub(super) fn reconstruct(
    experiment: &Experiment,
    model: &BenchModel,
    inputs: &ReplayInputs<'_>,
) -> Result<Acted, EstimateError> {
    let dyno = needed(experiment, Role::DynoSpeed)?;
    let engine = needed(experiment, Role::EngineSpeed)?;
    let torque = match inputs.air_gap_torque {
        Some(torque) => torque,
        None => needed(experiment, Role::AirGapTorque)?,
    };
    let range = common(experiment, inputs, &[dyno, engine, torque])?;
    let (start, step, count) = (dyno.time_s(range.start), dyno.sample_time_s, range.len());
    let error = encoder_error(dyno, inputs.encoder_error);
    let clean = dyno.with_samples(dyno.samples.iter().zip(&error).map(|(n, e)| n - e).collect());
    let gate = model.encoder_gate_s;
    let filtered = |x: &Signal, wanted, gate_s, late_s: f64| {
        ZeroPhase { band_hz: inputs.band_hz, gate_s, wanted }.at(x, start + late_s, step, count)
    };
    let engine_late = 0.5 * gate + inputs.skews.engine_speed_s;
    let air_gap = filtered(torque, Wanted::Value, 0.0, 0.5 * gate + inputs.skews.torque_s);
    let acceleration = filtered(&clean, Wanted::Derivative, gate, 0.5 * gate);
    let engine_acceleration = filtered(engine, Wanted::Derivative, gate, engine_late);
    let mechanics = model.mechanics;
    let sum = |inertia: f64, slope: &[f64], torque: &[f64]| -> Vec<f64> {
        slope.iter().zip(torque).map(|(a, t)| inertia * a + t).collect()
    };
    let shaft = sum(mechanics.dyno_inertia_kg_m2, &acceleration, &air_gap);
    Ok(Acted {
        start_s: start,
        step_s: step,
        dyno_speed: filtered(&clean, Wanted::Value, gate, 0.5 * gate),
        engine_speed: filtered(engine, Wanted::Value, gate, engine_late),
        air_gap_torque: air_gap,
        engine_torque: sum(mechanics.engine_inertia_kg_m2, &engine_acceleration, &shaft),
        shaft_torque: shaft,
        recorded_speed: dyno.samples[range.clone()].to_vec(),
        encoder_error: error[range].to_vec(),
    })
}

/// Samples of N_d at which every signal is there, with a margin.
fn common(
    experiment: &Experiment,
    inputs: &ReplayInputs<'_>,
    signals: &[&Signal],
) -> Result<std::ops::Range<usize>, EstimateError> {
    let (wanted_from, wanted_to) = inputs.stretch_s.unwrap_or((f64::NEG_INFINITY, f64::INFINITY));
    let demands = [Role::DynoSpeedDemand, Role::DynoTorqueDemand].into_iter().filter_map(|r| experiment.signal(r));
    let all = || signals.iter().copied().chain(demands.clone());
    let from = all().map(|x| x.start_s + EDGE_S).fold(wanted_from, f64::max);
    let to = all().map(|x| x.end_s() - EDGE_S).fold(wanted_to, f64::min);
    if to - from < SHORTEST_S {
        let file = experiment.file.clone();
        return Err(EstimateError::TooShort { file, duration_s: (to - from).max(0.0), needed_s: SHORTEST_S });
    }
    let dyno = signals[0];
    let index = |t: f64| ((t - dyno.start_s) / dyno.sample_time_s).ceil().max(0.0) as usize;
    Ok(index(from)..index(to).min(dyno.len()))
}
