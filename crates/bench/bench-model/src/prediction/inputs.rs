//! Inputs of a prediction.

use rig::bench_file::Limits;
use rig::bench_parameters::EngineParameters;
use rig::experiment::{Demands, ExperimentPlan};

use crate::disturbances::Disturbances;
use crate::friction::DynoFriction;
use crate::model::BenchModel;

/// Inputs of a prediction.
#[derive(Debug, Clone, Copy)]
pub struct PredictionInputs<'a> {
    /// The plan.
    pub plan: &'a ExperimentPlan,
    /// Its demands, every millisecond.
    pub demands: &'a Demands,
    /// The bench; a part that it lacks must not be needed.
    pub model: &'a BenchModel,
    /// The engine: motored torque, throttle map, intake, speed control.
    pub engine: &'a EngineParameters,
    /// An engine that fires adds its pulses, which vary from cycle to cycle as this seed says; without one it gives its
    /// mean torque.
    pub firing_seed: Option<u64>,
    /// Friction of the dynamometer: in torque control the shaft has it in addition to T_d.
    pub friction: DynoFriction,
    /// Ripple of the drive and errors of the dynamometer's encoder. They act where there is a seed of the firing, which
    /// draws their phases, too.
    pub disturbances: Disturbances,
    /// Limits that the bench must not exceed.
    pub limits: Limits,
}
