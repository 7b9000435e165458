//! The model in time: speed control (NT) and torque control (TN), with the torque limit and anti-windup.
//!
//! Between the instants at which a torque demand changes, the mechanics and the torque control's lag are discretised
//! exactly (first-order hold on the engine torque), so the step of 1 ms costs no accuracy whatever the delays are.
//! Inputs and outputs share one uniform grid, that of the controller. Before its first sample the bench is taken to
//! have run at its initial speed and demand.

mod controller;
mod course;
mod encoder;
mod engine;
mod error;
mod firing;
mod inputs;
mod linear_form;
mod plant;
mod ripple;

use crate::disturbances::{Disturbances, Disturbing};
use crate::friction::DynoFriction;
use crate::model::BenchModel;
use controller::Pi;
pub use course::{Course, CourseInputs, simulate_course};
use encoder::Encoder;
use engine::Engine;
pub use engine::{EngineSpeedControl, GovernedAir};
pub use error::SimulationError;
pub use firing::FiringEngine;
pub use inputs::{DynoInput, InitialState, Inputs};
pub use linear_form::{LinearForm, LoopMode, linear_form};
use plant::{Plant, Streams};
pub use ripple::Ripple;

/// Response of the bench, one value a sample.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Response {
    /// N_d as an encoder without errors reads it, rad/s: the mean over the gate that ends at the sample.
    pub dyno_speed_rad_s: Vec<f64>,
    /// N_e as an encoder with the same gate reads it, rad/s.
    pub engine_speed_rad_s: Vec<f64>,
    /// T_d, Nm.
    pub air_gap_torque_nm: Vec<f64>,
    /// T_shaft, Nm.
    pub shaft_torque_nm: Vec<f64>,
    /// T_d*, Nm, limited; empty when the air-gap torque was given.
    pub torque_demand_nm: Vec<f64>,
    /// Share of the samples at which T_d* rests at its limit, 0…1.
    pub limited_share: f64,
}

/// Simulates the bench.
///
/// At each sample the encoder is read, the controller updated (or T_d* taken), outputs are recorded, and the bench
/// moves on to the next sample: T_d*(t_k) = v(t_k − τ) + FF(t_k), limited; T_d follows it after d through a/(s + a).
///
/// # Errors
/// A part the drive needs is missing, inputs of unequal length or none, inputs off the controller's clock.
///
/// # Example
/// ```
/// use bench_model::model::{BenchModel, Mechanics};
/// use bench_model::simulate::{DynoInput, InitialState, Inputs, simulate};
/// let model = BenchModel {
///     mechanics: Mechanics {
///         dyno_inertia_kg_m2: 0.6,
///         engine_inertia_kg_m2: 0.4,
///         stiffness_nm_per_rad: 2400.0,
///         damping_nm_s_per_rad: 50.0,
///     },
///     speed_controller: None,
///     feed_forward: None,
///     torque_control: None,
///     torque_limit_nm: None,
///     encoder_gate_s: 1e-3,
/// };
/// // 10 Nm of the engine on 1 kg m² altogether: 10 rad/s more after a second.
/// let start = InitialState::steady(&model, 100.0, 0.0);
/// let inputs = Inputs {
///     sample_time_s: 1e-3,
///     engine_torque_nm: &[10.0; 1001],
///     dyno: DynoInput::AirGapTorque(&[0.0; 1001]),
/// };
/// let response = simulate(&model, &inputs, &start)?;
/// assert!((response.dyno_speed_rad_s[1000] - 110.0).abs() < 0.02);
/// # Ok::<(), bench_model::simulate::SimulationError>(())
/// ```
pub fn simulate(model: &BenchModel, inputs: &Inputs<'_>, start: &InitialState) -> Result<Response, SimulationError> {
    simulate_with_ripple(model, inputs, Ripple::NONE, start)
}

/// Simulates the bench under a known ripple of its dyno: T_d = m (1 + r) + w, where m is what torque control and
/// machine make of T_d*. The ripple brakes the dynamometer as all of T_d does. An air-gap torque that is given holds
/// its own ripple, so then `ripple` plays no part.
///
/// # Errors
/// Those of [`simulate`]; a ripple of another length than the inputs.
pub fn simulate_with_ripple(
    model: &BenchModel,
    inputs: &Inputs<'_>,
    ripple: Ripple<'_>,
    start: &InitialState,
) -> Result<Response, SimulationError> {
    ripple.check_length(inputs.engine_torque_nm.len())?;
    let engine = Engine::of(inputs, None, None, start.engine_speed_rad_s)?;
    run(model, inputs, ripple, DynoFriction::default(), None, engine, start)
}

/// Simulates the bench with the engine under speed control; the engine torque of `inputs` adds to that of the control.
///
/// # Errors
/// Those of [`simulate`]; a demand of another length than the inputs.
pub fn simulate_governed(
    model: &BenchModel,
    inputs: &Inputs<'_>,
    engine: &EngineSpeedControl<'_>,
    start: &InitialState,
) -> Result<Response, SimulationError> {
    simulate_acted_on(model, inputs, &Acting { control: Some(engine), ..Acting::default() }, start)
}

/// Simulates the bench with an engine that fires. The engine torque of `inputs`, and that of the speed control if there
/// is one, is the level that the next firing takes up; pulses come at the angle that the crank has in the run itself.
///
/// # Errors
/// Those of [`simulate_governed`].
pub fn simulate_fired(
    model: &BenchModel,
    inputs: &Inputs<'_>,
    fires: &FiringEngine<'_>,
    control: Option<&EngineSpeedControl<'_>>,
    start: &InitialState,
) -> Result<Response, SimulationError> {
    simulate_acted_on(model, inputs, &Acting { fires: Some(fires), control, ..Acting::default() }, start)
}

/// Additions that act on a bench beside its inputs; nothing by default.
#[derive(Debug, Clone, Copy, Default)]
pub struct Acting<'a> {
    /// Pulses of the engine, see [`simulate_fired`].
    pub fires: Option<&'a FiringEngine<'a>>,
    /// Speed control of the engine, see [`simulate_governed`].
    pub control: Option<&'a EngineSpeedControl<'a>>,
    /// Friction of the dynamometer.
    pub friction: DynoFriction,
    /// Ripple of the drive and errors of the dynamometer's encoder, and the seed of their phases and noise.
    pub disturbances: Option<(Disturbances, u64)>,
}

/// Simulates the bench with what acts on it.
///
/// # Errors
/// Those of [`simulate_governed`].
pub fn simulate_acted_on(
    model: &BenchModel,
    inputs: &Inputs<'_>,
    acting: &Acting<'_>,
    start: &InitialState,
) -> Result<Response, SimulationError> {
    let engine = Engine::of(inputs, acting.control, acting.fires, start.engine_speed_rad_s)?;
    let disturbing = acting.disturbances.map(|(of, seed)| Disturbing::new(of, seed));
    let ripple = |disturbing: &Disturbing| disturbing.ripple(inputs.engine_torque_nm.len(), inputs.sample_time_s);
    let (relative, added_nm) = disturbing.as_ref().map(ripple).unwrap_or_default();
    let ripple = Ripple { relative: &relative, added_nm: &added_nm };
    run(model, inputs, ripple, acting.friction, disturbing, engine, start)
}

fn run(
    model: &BenchModel,
    inputs: &Inputs<'_>,
    ripple: Ripple<'_>,
    friction: DynoFriction,
    mut disturbing: Option<Disturbing>,
    mut engine: Engine<'_>,
    start: &InitialState,
) -> Result<Response, SimulationError> {
    check_lengths(inputs)?;
    let mut plant = Plant::new(model, inputs, ripple, friction, start)?;
    let samples = inputs.engine_torque_nm.len();
    let mut response = Response::with_capacity(samples);
    let mut dyno = Encoder::new(model.encoder_gate_s / inputs.sample_time_s, inputs.sample_time_s, samples);
    let mut engine_encoder = dyno.clone();
    let mut streams = Streams::new(samples, start, model.torque_limit_nm);
    let mut pi = match inputs.dyno {
        DynoInput::SpeedDemand(_) => Some(Pi::new(model, start, inputs.sample_time_s)?),
        DynoInput::TorqueDemand(_) | DynoInput::AirGapTorque(_) => None,
    };
    for k in work::checked(0..samples) {
        let state = plant.state();
        let reading = dyno.read(state.dyno_angle_rad, state.dyno_speed_rad_s);
        response.dyno_speed_rad_s.push(reading);
        let engine_reading = engine_encoder.read(state.engine_angle_rad, state.engine_speed_rad_s);
        response.engine_speed_rad_s.push(engine_reading);
        let engine_nm = engine.update(k, engine_reading, &plant);
        let error = |by: &mut Disturbing| by.of_reading_rad_s(state.dyno_angle_rad, state.dyno_speed_rad_s);
        let seen = reading + disturbing.as_mut().map_or(0.0, error);
        let demand = match (inputs.dyno, pi.as_mut()) {
            (DynoInput::SpeedDemand(demand), Some(pi)) => pi.update(seen, demand, k, &mut streams),
            (DynoInput::TorqueDemand(demand), _) => streams.push_demand(demand[k]),
            _ => None,
        };
        if let Some(demand) = demand {
            response.torque_demand_nm.push(demand);
        }
        response.air_gap_torque_nm.push(plant.air_gap_torque_nm(inputs, &streams, k));
        response.shaft_torque_nm.push(plant.shaft_torque_nm());
        plant.advance(inputs, &streams, k, engine_nm);
    }
    response.limited_share = response.share_at(model.torque_limit_nm);
    Ok(response)
}

impl Response {
    /// The response without its first samples, where T_d* has this limit.
    pub(crate) fn without_first(mut self, first: usize, torque_limit_nm: Option<f64>) -> Self {
        let all = [
            &mut self.dyno_speed_rad_s,
            &mut self.engine_speed_rad_s,
            &mut self.air_gap_torque_nm,
            &mut self.shaft_torque_nm,
            &mut self.torque_demand_nm,
        ];
        for series in all {
            series.drain(..first.min(series.len()));
        }
        self.limited_share = self.share_at(torque_limit_nm);
        self
    }

    /// Share of the samples at which T_d* is at a limit.
    fn share_at(&self, torque_limit_nm: Option<f64>) -> f64 {
        let Some(limit_nm) = torque_limit_nm else { return 0.0 };
        let limited = self.torque_demand_nm.iter().filter(|demand| demand.abs() >= limit_nm).count();
        limited as f64 / self.shaft_torque_nm.len().max(1) as f64
    }

    fn with_capacity(samples: usize) -> Self {
        let series = || Vec::with_capacity(samples);
        Response {
            dyno_speed_rad_s: series(),
            engine_speed_rad_s: series(),
            air_gap_torque_nm: series(),
            shaft_torque_nm: series(),
            torque_demand_nm: series(),
            limited_share: 0.0,
        }
    }
}

fn check_lengths(inputs: &Inputs<'_>) -> Result<(), SimulationError> {
    let expected = inputs.engine_torque_nm.len();
    let same = |what, found: usize| {
        if found == expected { Ok(()) } else { Err(SimulationError::Length { what, expected, found }) }
    };
    if expected == 0 {
        return Err(SimulationError::Length { what: "engine torque", expected: 1, found: 0 });
    }
    match inputs.dyno {
        DynoInput::SpeedDemand(demand) => same("speed demand", demand.len()),
        DynoInput::TorqueDemand(demand) => same("torque demand", demand.len()),
        DynoInput::AirGapTorque(torque) => same("air-gap torque", torque.len()),
    }
}
