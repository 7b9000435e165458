//! Recordings as they are: their courses, and a step of T_d* with what followed it (thesis, chapter 4, and figures 6.1,
//! 6.2).

use rig::results::Trace;
use rig::{ControlMode, Experiment, ExperimentLabel, Role};
use serde::{Deserialize, Serialize};
use signal::Signal;

/// Time shown before a step, s.
const BEFORE_STEP_S: f64 = 0.02;
/// Time shown after a step, s.
const AFTER_STEP_S: f64 = 0.08;
/// A step stands alone where T_d* is constant for so long before and after it, s: other steps would be in the picture.
const ALONE_S: f64 = 0.05;
/// Signals whose timing a step shows.
const AT_A_STEP: [Role; 6] = [
    Role::DynoTorqueDemand,
    Role::AirGapTorque,
    Role::LoadCellTorque,
    Role::SystemShaftTorque,
    Role::FlangeTorque,
    Role::DynoSpeed,
];

/// The signals of a recording.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RecordedCourse {
    /// The file.
    pub file: String,
    /// The experiment's label.
    pub label: ExperimentLabel,
    /// Each signal, in SI.
    pub signals: Vec<(Role, Trace)>,
}

/// The largest step of T_d* in a recording.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct StepResponse {
    /// The file.
    pub file: String,
    /// When T_d* stepped, s of the recording's clock; the traces count from there.
    pub at_s: f64,
    /// Each signal about that instant, in SI.
    pub signals: Vec<(Role, Trace)>,
}

/// All recordings, whole.
pub(super) fn courses(experiments: &[&Experiment]) -> Vec<RecordedCourse> {
    let course = |experiment: &&Experiment| RecordedCourse {
        file: experiment.file.clone(),
        label: experiment.label.clone(),
        signals: experiment.signals.iter().map(|(role, signal)| (*role, trace(signal, 0..signal.len(), 0.0))).collect(),
    };
    experiments.iter().map(course).collect()
}

/// The largest step that stands alone in a recording in torque control, of all of them.
pub(super) fn step_response(experiments: &[&Experiment]) -> Option<StepResponse> {
    let steps = experiments.iter().filter(|e| e.label.mode == ControlMode::Tn).filter_map(|experiment| {
        let (size_nm, at_s) = largest_step(experiment.signal(Role::DynoTorqueDemand)?)?;
        Some((size_nm, at_s, *experiment))
    });
    let (_, at_s, experiment) = steps.max_by(|a, b| a.0.total_cmp(&b.0))?;
    let around = |role: Role| {
        let signal = experiment.signal(role)?;
        let index = |time_s: f64| ((time_s - signal.start_s) / signal.sample_time_s).round().max(0.0) as usize;
        let range = index(at_s - BEFORE_STEP_S)..index(at_s + AFTER_STEP_S).min(signal.len());
        Some((role, trace(signal, range, at_s)))
    };
    let signals = AT_A_STEP.into_iter().filter_map(around).collect();
    Some(StepResponse { file: experiment.file.clone(), at_s, signals })
}

/// Size and instant of the largest step of a demand between two stretches of constant demand.
fn largest_step(demand: &Signal) -> Option<(f64, f64)> {
    let alone = (ALONE_S / demand.sample_time_s).ceil() as usize;
    let values = &demand.samples;
    let is_constant = |part: &[f64]| part.iter().all(|value| value == &part[0]);
    let size = |k: &usize| (values[*k] - values[k - 1]).abs();
    let last = values.len().saturating_sub(alone);
    let steps = (alone..last).filter(|k| size(k) > 0.0);
    let alone = steps.filter(|k| is_constant(&values[k - alone..*k]) && is_constant(&values[*k..k + alone]));
    let largest = alone.max_by(|a, b| size(a).total_cmp(&size(b)))?;
    Some((size(&largest), demand.time_s(largest)))
}

/// A part of a signal, its times counted from `zero_s`.
fn trace(signal: &Signal, range: std::ops::Range<usize>, zero_s: f64) -> Trace {
    Trace {
        start_s: signal.time_s(range.start) - zero_s,
        sample_time_s: signal.sample_time_s,
        values: signal.samples.get(range).map(<[f64]>::to_vec).unwrap_or_default(),
    }
}
