//! From an experiment to what the shaft's estimators need of it.

use part_controller::speed_controller::{Encoder, SpeedControllerFit};
use part_torque::air_gap_torque::{air_gap_torque, sampled_torque};
use part_torque::torque_control::TorqueControlFit;
use rig::estimation::{EstimateError, need};
use rig::experiment::Test;
use rig::facts::BenchVariant;
use rig::results::Estimate;
use rig::{BenchFile, ControlMode, Experiment, Role};

use crate::shaft::{self, ShaftInputs};

/// Standard uncertainty of a stated slope of friction unless that is stated, % of it: friction changes with the oil's temperature.
const FRICTION_DOUBT_PERCENT: f64 = 20.0;
/// Tests the shaft can be estimated from, best first.
pub const SHAFT_TESTS: [Test; 7] =
    [Test::Multisine, Test::Binary, Test::Bs, Test::WhiteNoise, Test::Levels, Test::Ramp, Test::Step];
/// Tests in which T_d* moves the bench over a wide band.
const EXCITED_TESTS: [Test; 3] = [Test::Multisine, Test::Binary, Test::WhiteNoise];

/// What the shaft's estimator needs of one recording, with the torque between its samples.
pub fn shaft_inputs<'a>(
    experiment: &'a Experiment,
    bench: &BenchFile,
    controller: Option<&SpeedControllerFit>,
    torque_control: Option<&TorqueControlFit>,
) -> Result<ShaftInputs<'a>, EstimateError> {
    let dyno_speed = need(experiment, Role::DynoSpeed)?;
    let encoder = Encoder::known_or_assumed(controller.map(|c| c.encoder), dyno_speed, stated_gate(bench));
    let inertia = bench.dynamometer_inertia_kg_m2;
    let uncertainty = bench.dynamometer_inertia_uncertainty_percent.unwrap_or(0.0) / 100.0 * inertia;
    let (torque, inertia_kg_m2) = match bench.variant {
        BenchVariant::TorqueFlange => (vec![sampled_torque(need(experiment, Role::FlangeTorque)?)], None),
        BenchVariant::LoadCell => (air_gap_torque(experiment, torque_control)?, Some((inertia, uncertainty))),
    };
    Ok(ShaftInputs {
        file: &experiment.file,
        dyno_speed,
        engine_speed: need(experiment, Role::EngineSpeed)?,
        torque,
        inertia_kg_m2,
        friction_slope_nm_s_per_rad: friction_slope(bench),
        encoder_noise_rad_s: encoder.noise_rad_s,
        gate_s: (encoder.gate_s, encoder.gate_standard_error_s),
    })
}

/// The slope of the dynamometer's friction with its standard uncertainty, Nm s/rad: as stated, or what is usual.
fn friction_slope(bench: &BenchFile) -> (f64, f64) {
    match bench.dynamometer_friction_nm_s_per_rad {
        Some(slope) => {
            let percent = bench.dynamometer_friction_uncertainty_percent.unwrap_or(FRICTION_DOUBT_PERCENT);
            (slope, percent / 100.0 * slope)
        }
        None => ShaftInputs::usual_friction(bench.dynamometer_inertia_kg_m2),
    }
}

/// Whether an experiment shows both inertias: T_d* moves the bench over a wide band, and behind a torque flange stands a
/// dual-mass flywheel, with which there is no one J_e.
pub fn tells_inertias(experiment: &Experiment, bench: &BenchFile) -> bool {
    bench.variant == BenchVariant::LoadCell
        && experiment.label.mode == ControlMode::Tn
        && EXCITED_TESTS.contains(&experiment.label.test)
}

/// Both inertias as if nothing were known of them.
///
/// # Errors
/// Those of [`shaft::estimate_with_inertias`].
pub fn both_inertias(
    experiment: &Experiment,
    inputs: &ShaftInputs<'_>,
    bench: &BenchFile,
) -> Result<Estimate, EstimateError> {
    let demand = need(experiment, Role::DynoTorqueDemand)?;
    let engine = bench.engine();
    shaft::estimate_with_inertias(inputs, demand, engine.firings_per_turn())
}

/// The gate of N_d as the bench file states it, s.
pub fn stated_gate(bench: &BenchFile) -> Option<f64> {
    bench.channels.get(&Role::DynoSpeed).and_then(|mapping| mapping.gate_s)
}
