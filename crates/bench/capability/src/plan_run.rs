//! A plan on one bench.

use bench_model::prediction::{PredictionInputs, predict};
use rig::ControlMode;
use rig::experiment::Demands;

use crate::error::CapabilityError;
use crate::trace::Trace;

/// Runs a bench, millisecond by millisecond, beside the demands that were asked for.
pub(crate) fn run(inputs: &PredictionInputs<'_>, demands: &Demands) -> Result<Trace, CapabilityError> {
    let prediction = predict(inputs)?;
    let (response, plan) = (prediction.response, inputs.plan);
    let count = response.dyno_speed_rad_s.len();
    let ratio = prediction.sample_time_s / rig::experiment::UPDATE_S;
    let on_clock = |values: &[f64]| -> Vec<f64> {
        let last = values.len().saturating_sub(1);
        (0..count).map(|k| values[((k as f64 * ratio + 1e-6).floor() as usize).min(last)]).collect()
    };
    let is_nt = plan.label.mode == ControlMode::Nt;
    let (torque_demand_nm, torque_nm) = match (is_nt, plan.has_shaft) {
        (true, true) => (on_clock(&demands.engine_torque_nm), response.shaft_torque_nm.clone()),
        (true, false) => (response.torque_demand_nm.clone(), response.air_gap_torque_nm.clone()),
        (false, _) => (on_clock(&demands.dyno_torque_nm), response.air_gap_torque_nm.clone()),
    };
    let speed = if is_nt { &response.dyno_speed_rad_s } else { &response.engine_speed_rad_s };
    let with_shaft = |values: Vec<f64>| if plan.has_shaft { values } else { Vec::new() };
    Ok(Trace {
        start_s: 0.0,
        step_s: prediction.sample_time_s,
        is_demand_held: true,
        speed_demand_rad_s: on_clock(&demands.speed_rad_s),
        speed_rad_s: speed.clone(),
        torque_demand_nm,
        torque_nm,
        dyno_speed_rad_s: response.dyno_speed_rad_s,
        engine_speed_rad_s: with_shaft(response.engine_speed_rad_s),
        shaft_torque_nm: with_shaft(response.shaft_torque_nm),
        dyno_demand_nm: response.torque_demand_nm,
    })
}
