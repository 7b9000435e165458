//! A run of the model that an importer can compare with: inputs, and what the bench did.

use bench_model::model::{BenchModel, TorqueControlModel};
use bench_model::simulate::{DynoInput, InitialState, Inputs, simulate};

use super::csv;
use super::numbers::BenchNumbers;
use crate::ExportError;

/// Samples of the run.
const SAMPLES: usize = 1001;
/// Where the demand and the engine torque step.
const STEPS: [usize; 2] = [100, 500];
/// How far.
const STEP_RAD_S: f64 = 5.0;
const STEP_NM: f64 = 20.0;

/// Inputs and outputs as tables.
pub(super) struct Reference {
    pub(super) inputs: String,
    pub(super) outputs: String,
}

/// The run, by the simulation of dynoid. The outputs at an instant are those that an importer gets when it has stepped
/// there; so T_d* is that of the sample before.
///
/// # Errors
/// Those of the simulation.
pub(super) fn run(model: &BenchModel, numbers: &BenchNumbers) -> Result<Reference, ExportError> {
    let sample_time_s = numbers.value("T_s");
    let at_once = TorqueControlModel { delay_s: 0.0, bandwidth_rad_s: None };
    let model = BenchModel { torque_control: Some(model.torque_control.unwrap_or(at_once)), ..model.clone() };
    let stepped = |from: usize, low: f64, high: f64| -> Vec<f64> {
        (0..SAMPLES).map(|k| if k < from { low } else { high }).collect()
    };
    let speed = stepped(STEPS[0], numbers.start_rad_s, numbers.start_rad_s + STEP_RAD_S);
    let torque = stepped(STEPS[0], numbers.start_nm, numbers.start_nm + STEP_NM);
    let engine = stepped(STEPS[1], numbers.start_nm, numbers.start_nm + STEP_NM);
    let dyno =
        if numbers.has_speed_control { DynoInput::SpeedDemand(&speed) } else { DynoInput::TorqueDemand(&torque) };
    let start = InitialState::steady(&model, numbers.start_rad_s, numbers.start_nm);
    let response = simulate(&model, &Inputs { sample_time_s, engine_torque_nm: &engine, dyno }, &start)?;
    let time_s = |k: usize| k as f64 * sample_time_s;
    let slope = |k: usize| (engine[(k + 1).min(SAMPLES - 1)] - engine[k]) / sample_time_s;
    let inputs = (0..SAMPLES).map(|k| vec![time_s(k), speed[k], torque[k], engine[k], slope(k)]);
    let outputs = (1..SAMPLES).map(|k| {
        vec![
            time_s(k),
            response.dyno_speed_rad_s[k],
            response.engine_speed_rad_s[k],
            response.shaft_torque_nm[k],
            response.torque_demand_nm[k - 1],
        ]
    });
    Ok(Reference {
        inputs: csv::table(&["time", "speed_demand", "torque_demand", "engine_torque", "engine_torque_rate"], inputs),
        outputs: csv::table(&["time", "dyno_speed", "engine_speed", "shaft_torque", "limited_torque_demand"], outputs),
    })
}
