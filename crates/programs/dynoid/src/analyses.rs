//! The analyses of a bench's recordings that have commands of their own. [`crate::Session`] has them for its
//! recordings.

use part_controller::SpeedControllers;
use part_controller::speed_controller::{SpeedControl, speed_control};
use part_engine::{EngineTorque, engine_torque};
use part_friction::{Friction, FrictionError};
use part_shaft::Parts;
use part_shaft::shaft_analysis::{ShaftAnalysis, shaft_analysis};
use part_torque::TorqueControls;
use part_torque::model_comparison::{ModelComparison, ModelComparisonError, OrdersTried, compare_models};
use part_torque::torque_signals::TorqueSignals;
use rig::{BenchFile, Experiment};
use work::Context;

pub use study::lines;

/// The torque signals against each other, and the shaft torque rebuilt.
pub fn torque_signals(experiments: &[Experiment], bench: &BenchFile, context: &Context) -> TorqueSignals {
    let (all, limit) = (all(experiments), bench.limits.torque_nm);
    let (controllers, torque_controls) = (SpeedControllers::of(&all, limit), TorqueControls::of(&all, limit));
    part_torque::torque_signals::torque_signals(&controllers, &torque_controls, bench, context)
}

/// Models of the torque control, compared.
///
/// # Errors
/// No recording from which they can be estimated.
pub fn torque_control(
    experiments: &[Experiment],
    bench: &BenchFile,
    orders: OrdersTried,
    context: &Context,
) -> Result<ModelComparison, ModelComparisonError> {
    compare_models(&TorqueControls::of(&all(experiments), bench.limits.torque_nm), orders, context)
}

/// The speed controller and its feed-forward.
pub fn controller(experiments: &[Experiment], bench: &BenchFile, context: &Context) -> SpeedControl {
    speed_control(&SpeedControllers::of(&all(experiments), bench.limits.torque_nm), context)
}

/// The shaft of every recording, and of all together.
pub fn shaft(experiments: &[Experiment], bench: &BenchFile, context: &Context) -> ShaftAnalysis {
    shaft_analysis(&Parts::of(&all(experiments), bench), context)
}

/// The engine's torque, rebuilt.
pub fn engine(experiments: &[Experiment], bench: &BenchFile, context: &Context) -> EngineTorque {
    engine_torque(&Parts::of(&all(experiments), bench), context)
}

/// Friction and inertia of the dynamometer, from the recordings without shaft.
///
/// # Errors
/// No recording that shows them.
pub fn friction(experiments: &[Experiment], bench: &BenchFile) -> Result<Friction, FrictionError> {
    study::friction_of(&all(experiments), bench)
}

fn all(experiments: &[Experiment]) -> Vec<&Experiment> {
    experiments.iter().collect()
}
