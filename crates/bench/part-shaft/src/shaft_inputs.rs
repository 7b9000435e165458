//! From an experiment to what the shaft's estimators need of it.

use part_controller::speed_controller::{Encoder, SpeedControllerFit};
use part_torque::air_gap_torque::{air_gap_torque, sampled_torque};
use part_torque::torque_control::TorqueControlFit;
use rig::estimation::{EstimateError, liveliest_part, need};
use rig::facts::BenchVariant;
use rig::prepare::believable;
use rig::results::{Estimate, Quantity};
use rig::{BenchFile, Experiment, Role};

use crate::shaft::{self, NoisyTorque, ShaftInputs, TorqueDelay, Wanted};

/// The torque that moves the shaft, between its samples; of a long recording in the minutes in which N_e changes most.
pub fn shaft_torque(
    experiment: &Experiment,
    bench: &BenchFile,
    torque_control: Option<&TorqueControlFit>,
) -> Result<Vec<NoisyTorque>, EstimateError> {
    let part = liveliest_part(experiment, Role::EngineSpeed);
    match bench.variant {
        BenchVariant::TorqueFlange => Ok(vec![sampled_torque(need(&part, Role::FlangeTorque)?)]),
        BenchVariant::LoadCell => {
            believable(experiment)?;
            air_gap_torque(&part, torque_control)
        }
    }
}

/// Inputs of the shaft's estimator from one recording, beside this torque.
pub fn shaft_inputs<'a>(
    experiment: &'a Experiment,
    bench: &BenchFile,
    controller: Option<&SpeedControllerFit>,
    torque: Vec<NoisyTorque>,
    torque_control: Option<&TorqueControlFit>,
) -> Result<ShaftInputs<'a>, EstimateError> {
    let dyno_speed = need(experiment, Role::DynoSpeed)?;
    let encoder = Encoder::known_or_assumed(controller.map(|c| c.encoder), dyno_speed, stated_gate(bench));
    let inertia = bench.dynamometer_inertia();
    let inertia_kg_m2 =
        (bench.variant == BenchVariant::LoadCell).then(|| (inertia.kg_m2, inertia.standard_uncertainty_kg_m2()));
    // A second record is what the samples hold beyond the model: the torque is then no model's alone.
    let is_modelled = bench.variant == BenchVariant::LoadCell
        && experiment.signal(Role::DynoTorqueDemand).is_some()
        && torque.len() == 1;
    Ok(ShaftInputs {
        file: &experiment.file,
        dyno_speed,
        engine_speed: need(experiment, Role::EngineSpeed)?,
        torque,
        inertia_kg_m2,
        friction_slope_nm_s_per_rad: friction_slope(bench),
        encoder_noise_rad_s: encoder.noise_rad_s,
        gate_s: (encoder.gate_s, encoder.gate_standard_error_s),
        torque_control: torque_control.filter(|_| is_modelled).map(torque_delay),
        firings_per_turn: bench.engine().firings_per_turn(),
    })
}

/// Standard uncertainty of a lag or delay of which a recording shows nothing, s.
const UNKNOWN_S: f64 = 1e-3;

/// Uncertainty that the torque control leaves in the torque.
fn torque_delay(control: &TorqueControlFit) -> TorqueDelay {
    let lag_s = 1.0 / control.model.lag_rad_s;
    let error = |quantity| control.result.delay_and_lag.parameter(quantity).map_or(f64::INFINITY, |p| p.standard_error);
    let or_unknown = |error: f64| if error < UNKNOWN_S { error } else { UNKNOWN_S };
    TorqueDelay {
        lag_s,
        lag_uncertainty_s: or_unknown(error(Quantity::TorqueControlBandwidth) * lag_s * lag_s),
        delay_uncertainty_s: or_unknown(error(Quantity::TorqueControlDelay)),
    }
}

/// The slope of the dynamometer's friction with its standard uncertainty, Nm s/rad: as stated, or what is usual.
fn friction_slope(bench: &BenchFile) -> (f64, f64) {
    match bench.dynamometer_friction_nm_s_per_rad {
        Some(slope) => {
            let percent = bench.dynamometer_friction_uncertainty_percent.unwrap_or(rig::dyno_friction::DOUBT_PERCENT);
            (slope, percent / 100.0 * slope)
        }
        None => ShaftInputs::usual_friction(bench.dynamometer_inertia_kg_m2),
    }
}

/// Both inertias as if nothing were known of them.
///
/// # Errors
/// Those of [`shaft::fit`].
pub fn both_inertias(
    experiment: &Experiment,
    inputs: &ShaftInputs<'_>,
    bench: &BenchFile,
) -> Result<Estimate, EstimateError> {
    let demand = need(experiment, Role::DynoTorqueDemand)?;
    let firings_per_turn = bench.engine().firings_per_turn();
    Ok(shaft::fit(inputs, Wanted::Inertias { demand, firings_per_turn })?.estimate)
}

/// The gate of N_d as the bench file states it, s.
pub fn stated_gate(bench: &BenchFile) -> Option<f64> {
    bench.channels.get(&Role::DynoSpeed).and_then(|mapping| mapping.gate_s)
}
