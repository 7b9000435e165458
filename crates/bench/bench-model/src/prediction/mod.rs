//! Predicted behaviour of a bench in an experiment: the bench model under the plan's demands, and its peaks against the
//! limits that the bench file states.
//!
//! The engine gives its mean torque and, where they are asked for, its pulses at the angle of its crank; those of a
//! motored engine have the share of the virtual bench. In TN mode the engine's speed control, its intake and its
//! ignition are those of the virtual bench. What a virtual bench adds beyond the model is no part of it.

mod demanded;
mod inputs;
mod peaks;

use std::cell::RefCell;

use rig::ControlMode;
use rig::bench_parameters::EngineParameters;
use rig::experiment::{ExperimentPlan, TorqueTarget, UPDATE_S};
use units::RPM_RAD_S;

use crate::model::{BenchModel, Mechanics, ModelUncertainty};
use crate::simulate::{
    Acting, DynoInput, EngineSpeedControl, FiringEngine, GovernedAir, InitialState, Inputs, Response, SimulationError,
    simulate_acted_on,
};
use demanded::Demanded;
pub use inputs::PredictionInputs;
pub use peaks::{Peak, PeakOf};

/// Predicted behaviour of the bench.
#[derive(Debug, Clone, PartialEq)]
pub struct Prediction {
    /// Time between samples, s: that of the controller, or 1 ms.
    pub sample_time_s: f64,
    /// Speeds, torques and demand at every sample.
    pub response: Response,
    /// True where there is a shaft, and so an engine that turns.
    pub has_shaft: bool,
    /// Largest values, against the limits.
    pub peaks: Vec<Peak>,
}

/// Why nothing can be predicted.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PredictionError {
    /// The model has no control of the shaft torque.
    #[error(
        "control of the shaft torque is no part of the bench model; `dynoid experiment simulate` runs it on the virtual bench"
    )]
    ShaftTorqueControl,
    /// The model cannot be simulated.
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    /// A speed that no engine has.
    #[error(
        "at {time_s:.3} s the speed demanded is {:.0} rpm; with a shaft it must be from 0 to {:.0} rpm, since an engine turns forwards",
        speed_rad_s / RPM_RAD_S,
        HIGHEST_RAD_S / RPM_RAD_S
    )]
    EngineSpeed {
        /// The speed, rad/s.
        speed_rad_s: f64,
        /// When, s.
        time_s: f64,
    },
    /// The response left the finite numbers.
    #[error("the prediction grows without bound: this model's speed control is not stable on these inertias")]
    Unstable,
}

/// The highest speed of an engine, rad/s: racing engines come close to it.
const HIGHEST_RAD_S: f64 = 20_000.0 * RPM_RAD_S;

/// Checks that an engine can have speeds so far apart in time, s.
///
/// # Errors
/// [`PredictionError::EngineSpeed`] with the first one that it cannot have.
pub fn check_engine_speeds(speed_rad_s: &[f64], step_s: f64) -> Result<(), PredictionError> {
    let is_possible = |speed: &f64| (0.0..=HIGHEST_RAD_S * (1.0 + 1e-9)).contains(speed);
    match speed_rad_s.iter().position(|speed| !is_possible(speed)) {
        Some(k) => Err(PredictionError::EngineSpeed { speed_rad_s: speed_rad_s[k], time_s: k as f64 * step_s }),
        None => Ok(()),
    }
}

/// Predicts an experiment.
///
/// # Errors
/// A part the plan needs is missing in the model, control of the shaft torque, a speed that no engine has, an unstable
/// loop.
pub fn predict(inputs: &PredictionInputs<'_>) -> Result<Prediction, PredictionError> {
    if inputs.plan.has_shaft {
        check_engine_speeds(&inputs.demands.speed_rad_s, UPDATE_S)?;
    }
    let sample_time_s = sample_time_s(inputs);
    let response = respond(inputs, inputs.model)?;
    let peaks = peaks::all(&response, sample_time_s, inputs);
    Ok(Prediction { sample_time_s, response, has_shaft: inputs.plan.has_shaft, peaks })
}

/// The standard error of each peak of a prediction, from the model's uncertainty by the delta method; in the order of
/// [`Prediction::peaks`].
pub fn peak_errors(inputs: &PredictionInputs<'_>, uncertainty: &ModelUncertainty) -> Vec<f64> {
    let sample_time_s = sample_time_s(inputs);
    // Every peak asks for the same neighbours of the model.
    let known: RefCell<Vec<(BenchModel, Vec<f64>)>> = RefCell::default();
    let peak = |model: &BenchModel, index: usize| {
        if let Some((_, values)) = known.borrow().iter().find(|(other, _)| other == model) {
            return values.get(index).copied().unwrap_or(f64::NAN);
        }
        let peaks = respond(inputs, model).map(|response| peaks::all(&response, sample_time_s, inputs));
        let values: Vec<f64> = peaks.unwrap_or_default().iter().map(|peak| peak.value).collect();
        let value = values.get(index).copied().unwrap_or(f64::NAN);
        known.borrow_mut().push((model.clone(), values));
        value
    };
    let count = predict(inputs).map_or(0, |prediction| prediction.peaks.len());
    (0..count).map(|index| uncertainty.propagate(inputs.model, |m| peak(m, index)).standard_error).collect()
}

fn sample_time_s(inputs: &PredictionInputs<'_>) -> f64 {
    match (inputs.plan.label.mode, inputs.model.speed_controller) {
        (ControlMode::Nt, Some(controller)) => controller.sample_time_s,
        _ => UPDATE_S,
    }
}

fn respond(inputs: &PredictionInputs<'_>, model: &BenchModel) -> Result<Response, PredictionError> {
    let plan = inputs.plan;
    if plan.torque_target == TorqueTarget::Shaft && plan.label.mode == ControlMode::Tn {
        return Err(PredictionError::ShaftTorqueControl);
    }
    let model = &if plan.has_shaft { model.clone() } else { without_shaft(model) };
    let sample_time_s = sample_time_s(inputs);
    let demanded = Demanded::of(inputs, sample_time_s);
    let start = start(model, demanded.speed_rad_s[0], demanded.mean_engine_torque_nm)
        .with_friction(inputs.friction.torque_nm(demanded.speed_rad_s[0]));
    let Some(seed) = inputs.firing_seed.filter(|_| plan.has_shaft) else {
        return run(inputs, model, &demanded, None, &start);
    };
    // The bench is recorded once its answer to the first pulses has died away.
    let settling = (plan.settling_s / sample_time_s).round() as usize;
    let fires = FiringEngine { engine: inputs.engine, seed, is_motored: plan.is_motored };
    let response = run(inputs, model, &demanded.after(settling), Some(&fires), &start)?;
    Ok(response.without_first(settling, model.torque_limit_nm))
}

fn is_fired(plan: &ExperimentPlan) -> bool {
    plan.has_shaft && !plan.is_motored
}

fn is_bounded(response: &Response) -> bool {
    let is_finite = |values: &[f64]| values.iter().all(|value| value.abs() < 1e6);
    is_finite(&response.dyno_speed_rad_s) && is_finite(&response.shaft_torque_nm)
}

/// One run, in which the engine's speed control acts in torque control.
fn run(
    inputs: &PredictionInputs<'_>,
    model: &BenchModel,
    demanded: &Demanded,
    fires: Option<&FiringEngine<'_>>,
    start: &InitialState,
) -> Result<Response, PredictionError> {
    let PredictionInputs { plan, engine, .. } = *inputs;
    let dyno = match plan.label.mode {
        ControlMode::Nt => DynoInput::SpeedDemand(&demanded.speed_rad_s),
        ControlMode::Tn => DynoInput::TorqueDemand(&demanded.dyno_torque_nm),
    };
    let of = Inputs { sample_time_s: sample_time_s(inputs), engine_torque_nm: &demanded.engine_torque_nm, dyno };
    let is_governed = plan.label.mode == ControlMode::Tn && is_fired(plan);
    let control = is_governed.then_some(EngineSpeedControl {
        demand_rad_s: &demanded.speed_rad_s,
        proportional_nm_s_per_rad: engine.speed_control_proportional_nm_s_per_rad,
        integral_nm_per_rad: engine.speed_control_integral_nm_per_rad,
        start_nm: at_best_ignition_nm(engine, demanded),
        air: Some(GovernedAir { engine, ignition_efficiency: &demanded.ignition_efficiency }),
    });
    let disturbances = inputs.firing_seed.map(|seed| (inputs.disturbances, seed));
    let acting = Acting { fires, control: control.as_ref(), friction: inputs.friction, disturbances };
    let response = simulate_acted_on(model, &of, &acting, start)?;
    is_bounded(&response).then_some(response).ok_or(PredictionError::Unstable)
}

/// The torque at the best ignition angle that gives the engine's torque at the start, with the ignition of the start.
fn at_best_ignition_nm(engine: &EngineParameters, demanded: &Demanded) -> f64 {
    let (given_nm, motored_nm) = (demanded.mean_engine_torque_nm, engine.motored_torque_nm);
    match demanded.ignition_efficiency.first() {
        Some(efficiency) if *efficiency > 0.0 => (given_nm - motored_nm) / efficiency + motored_nm,
        _ => given_nm,
    }
}

/// The dynamometer alone.
fn without_shaft(model: &BenchModel) -> BenchModel {
    let mechanics = Mechanics { stiffness_nm_per_rad: 0.0, damping_nm_s_per_rad: 0.0, ..model.mechanics };
    BenchModel { mechanics, ..model.clone() }
}

/// The bench at rest at its first demands.
fn start(model: &BenchModel, speed_rad_s: f64, torque_nm: f64) -> InitialState {
    let steady = InitialState::steady(model, speed_rad_s, torque_nm);
    // Without a shaft there is neither torque nor twist.
    if model.mechanics.stiffness_nm_per_rad > 0.0 { steady } else { InitialState { twist_rad: 0.0, ..steady } }
}
