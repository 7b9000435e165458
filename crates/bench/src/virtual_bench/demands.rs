//! The plan's demands, update by update.

use super::UPDATE_S;
use super::noise::{Random, Source};
use super::parameters::BenchParameters;
use super::plan::ExperimentPlan;
use super::waveform::{Waveform, hold};

/// Demands at every update of the recording. Each random one has a stream of its own.
#[derive(Debug, Clone)]
pub(super) struct Demands {
    pub(super) speed_rad_s: Vec<f64>,
    pub(super) dyno_torque_nm: Vec<f64>,
    pub(super) engine_torque_nm: Vec<f64>,
    /// Empty where the engine gets a torque.
    pub(super) throttle: Vec<f64>,
    pub(super) ignition_efficiency: Vec<f64>,
}

impl Demands {
    /// The demands; those of the automation system change only once in its hold time.
    pub(super) fn new(parameters: &BenchParameters, plan: &ExperimentPlan, seed: u64, updates: usize) -> Self {
        let held_updates = (parameters.controller.demand_hold_s / UPDATE_S).round() as usize;
        let sample = |waveform: &Waveform, source| waveform.sample(&mut Random::new(seed, source), UPDATE_S, updates);
        let held = |waveform: &Waveform, source| {
            let mut values = sample(waveform, source);
            hold(&mut values, held_updates);
            values
        };
        Self {
            speed_rad_s: sample(&plan.speed_rad_s, Source::Speed),
            dyno_torque_nm: held(&plan.dyno_torque_nm, Source::DynoTorque),
            engine_torque_nm: held(&plan.engine_torque_nm, Source::EngineTorque),
            throttle: plan.throttle.as_ref().map_or_else(Vec::new, |throttle| held(throttle, Source::Throttle)),
            ignition_efficiency: held(&plan.ignition_efficiency, Source::Ignition),
        }
    }
}
