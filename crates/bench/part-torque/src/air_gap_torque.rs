//! T_d of a recording, as finely as it can be known.

use rig::estimation::{EstimateError, need, noise_floor};
use rig::{Experiment, Role};
use signal::Signal;

use crate::torque_control::{AirGapTorqueModel, TorqueControlFit};

/// A torque model whose residual is white is taken for this many times cleaner than the samples it was fitted to: its
/// errors are those of a handful of parameters.
const MODEL_ADVANTAGE: f64 = 30.0;
/// Values of the modelled torque in a sample of the demand.
const FINER: usize = 8;

/// T_d as a sampled record, its noise read from the top of its spectrum.
pub fn sampled_torque(torque: &Signal) -> NoisyTorque {
    NoisyTorque::new(torque.clone(), noise_floor(torque))
}

/// T_d between the samples of T_d,calc: the model's response to T_d*, which is known every millisecond, with the
/// ripple found in T_d,calc. T_d,calc itself folds everything above half its rate; it is used alone where there is no
/// model, and its difference from the model is added where that is not white.
pub fn air_gap_torque(
    experiment: &Experiment,
    torque_control: Option<&TorqueControlFit>,
) -> Result<Vec<NoisyTorque>, EstimateError> {
    let measured = need(experiment, Role::AirGapTorque)?;
    let Some((demand, model)) = model_of(experiment, torque_control) else {
        return Ok(vec![sampled_torque(measured)]);
    };
    let noise = model.residual.standard_deviation_nm;
    let signal = model.finer_air_gap_torque(demand, FINER);
    let unseen_hz = model.unseen_lines_hz(measured.sample_time_s);
    let mut records = vec![NoisyTorque { unseen_hz, ..NoisyTorque::new(signal, noise / MODEL_ADVANTAGE) }];
    if !model.residual.white {
        records.push(NoisyTorque::new(difference(measured, &records[0].signal), noise));
    }
    Ok(records)
}

/// T_d on the clock of T_d*, from the model with the ripple of this recording.
pub fn modelled_torque(
    experiment: &Experiment,
    torque_control: Option<&AirGapTorqueModel>,
) -> Option<(Signal, AirGapTorqueModel)> {
    let (demand, model) = in_recording(experiment, torque_control?)?;
    Some((model.air_gap_torque(demand), model))
}

/// T_d* and the model with the ripple of this recording.
pub(crate) fn model_of<'a>(
    experiment: &'a Experiment,
    torque_control: Option<&TorqueControlFit>,
) -> Option<(&'a Signal, AirGapTorqueModel)> {
    in_recording(experiment, &torque_control?.model)
}

fn in_recording<'a>(
    experiment: &'a Experiment,
    torque_control: &AirGapTorqueModel,
) -> Option<(&'a Signal, AirGapTorqueModel)> {
    let demand = experiment.signal(Role::DynoTorqueDemand)?;
    let measured = experiment.signal(Role::AirGapTorque)?;
    Some((demand, torque_control.refit_ripple(demand, measured).ok()?))
}

/// A sampled signal less another, held, at its own instants.
fn difference(measured: &Signal, modelled: &Signal) -> Signal {
    let last = modelled.len().saturating_sub(1) as f64;
    let at = |i: usize| ((measured.time_s(i) - modelled.start_s) / modelled.sample_time_s).round().clamp(0.0, last);
    let values = measured.samples.iter().enumerate().map(|(i, m)| m - modelled.samples[at(i) as usize]).collect();
    measured.with_samples(values)
}

/// A torque record and the noise on its samples.
#[derive(Debug, Clone, PartialEq)]
pub struct NoisyTorque {
    /// Torque, Nm.
    pub signal: Signal,
    /// Standard deviation of its white noise, Nm.
    pub noise_nm: f64,
    /// Where the torque has lines of which the record shows too little, Hz.
    pub unseen_hz: Vec<f64>,
}

impl NoisyTorque {
    /// A record that shows the torque at all frequencies.
    pub fn new(signal: Signal, noise_nm: f64) -> Self {
        NoisyTorque { signal, noise_nm, unseen_hz: Vec::new() }
    }
}
