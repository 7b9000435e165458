//! The model in time: speed control (NT) and torque control (TN), with the torque limit and anti-windup.
//!
//! Between the instants at which a torque demand changes, the mechanics and the torque control's lag are discretised exactly
//! (first-order hold on the engine torque), so the step of 1 ms costs no accuracy whatever the delays are. Inputs and
//! outputs share one uniform grid, that of the controller. Before its first sample the bench is taken to have run at its
//! initial speed and demand.

mod controller;
mod course;
mod encoder;
mod error;
mod inputs;
mod linear_form;
mod plant;
mod ripple;

use std::borrow::Cow;

use crate::model::BenchModel;
use controller::Pi;
pub use course::{Course, CourseInputs, simulate_course};
use encoder::Encoder;
pub use error::SimulationError;
pub use inputs::{DynoInput, InitialState, Inputs};
pub use linear_form::{LinearForm, LoopMode, linear_form};
use plant::{Plant, Streams};
pub use ripple::Ripple;

/// What the bench did, one value a sample.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Response {
    /// N_d as the encoder reads it, rad/s: the mean over the gate that ends at the sample.
    pub dyno_speed_rad_s: Vec<f64>,
    /// N_e as an encoder with the same gate reads it, rad/s.
    pub engine_speed_rad_s: Vec<f64>,
    /// T_d, Nm.
    pub air_gap_torque_nm: Vec<f64>,
    /// T_shaft, Nm.
    pub shaft_torque_nm: Vec<f64>,
    /// T_d*, Nm, limited; empty when the air-gap torque was given.
    pub torque_demand_nm: Vec<f64>,
    /// The engine's torque, Nm: the one given, and that of its speed control.
    pub engine_torque_nm: Vec<f64>,
    /// Share of the samples at which T_d* rests at its limit, 0…1.
    pub limited_share: f64,
}

/// Engine speed control in TN mode, every sample: T_e = K_p (ω_e* − ω_e) + I, dI/dt = K_i (ω_e* − ω_e), ω_e as the encoder
/// reads it. The torque gets there straight, within a sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EngineSpeedControl<'a> {
    /// ω_e*, rad/s.
    pub demand_rad_s: &'a [f64],
    /// K_p, Nm s/rad.
    pub proportional_nm_s_per_rad: f64,
    /// K_i, Nm/rad.
    pub integral_nm_per_rad: f64,
    /// I at the start, Nm.
    pub start_nm: f64,
}

/// Simulates the bench.
///
/// At each sample the encoder is read, the controller updated (or T_d* taken), outputs are recorded, and the bench moves
/// on to the next sample: T_d*(t_k) = v(t_k − τ) + FF(t_k), limited; T_d follows it after d through a/(s + a).
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

/// Simulates the bench under a known ripple of its dyno: T_d = m (1 + r) + w, where m is what torque control and machine make
/// of T_d*. The ripple brakes the dynamometer as all of T_d does. An air-gap torque that is given holds its own ripple,
/// so then `ripple` plays no part.
///
/// # Errors
/// Those of [`simulate`]; a ripple of another length than the inputs.
pub fn simulate_with_ripple(
    model: &BenchModel,
    inputs: &Inputs<'_>,
    ripple: Ripple<'_>,
    start: &InitialState,
) -> Result<Response, SimulationError> {
    run(model, inputs, ripple, None, start)
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
    run(model, inputs, Ripple::NONE, Some(engine), start)
}

fn run(
    model: &BenchModel,
    inputs: &Inputs<'_>,
    ripple: Ripple<'_>,
    engine_control: Option<&EngineSpeedControl<'_>>,
    start: &InitialState,
) -> Result<Response, SimulationError> {
    check_lengths(inputs)?;
    ripple.check_length(inputs.engine_torque_nm.len())?;
    let mut governor = engine_control.map(|control| Governor::new(control, inputs)).transpose()?;
    let mut engine_torque_nm = Cow::Borrowed(inputs.engine_torque_nm);
    if let Some(governor) = &governor {
        engine_torque_nm.to_mut()[0] += governor.integral_nm;
    }
    let mut plant = Plant::new(model, inputs, ripple, start)?;
    let samples = inputs.engine_torque_nm.len();
    let mut response = Response::with_capacity(samples);
    let mut dyno = Encoder::new(model.encoder_gate_s / inputs.sample_time_s, inputs.sample_time_s, samples);
    let mut engine = dyno.clone();
    let mut streams = Streams::new(samples, start, model.torque_limit_nm);
    let mut pi = match inputs.dyno {
        DynoInput::SpeedDemand(_) => Some(Pi::new(model, start, inputs.sample_time_s)?),
        DynoInput::TorqueDemand(_) | DynoInput::AirGapTorque(_) => None,
    };
    for k in 0..samples {
        let state = plant.state();
        let reading = dyno.read(state.dyno_angle_rad, state.dyno_speed_rad_s);
        response.dyno_speed_rad_s.push(reading);
        let engine_reading = engine.read(state.engine_angle_rad, state.engine_speed_rad_s);
        response.engine_speed_rad_s.push(engine_reading);
        if let Some(governor) = &mut governor {
            governor.update(k, engine_reading, engine_torque_nm.to_mut());
        }
        let inputs = &Inputs { engine_torque_nm: &engine_torque_nm, ..*inputs };
        let demand = match (inputs.dyno, pi.as_mut()) {
            (DynoInput::SpeedDemand(demand), Some(pi)) => pi.update(reading, (demand, k), &mut streams),
            (DynoInput::TorqueDemand(demand), _) => streams.push_demand(demand[k]),
            _ => None,
        };
        if let Some(demand) = demand {
            response.torque_demand_nm.push(demand);
        }
        response.air_gap_torque_nm.push(plant.air_gap_torque_nm(inputs, &streams, k));
        response.shaft_torque_nm.push(plant.shaft_torque_nm());
        plant.advance(inputs, &streams, k);
    }
    response.engine_torque_nm = engine_torque_nm.into_owned();
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
            &mut self.engine_torque_nm,
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
            engine_torque_nm: Vec::new(),
            limited_share: 0.0,
        }
    }
}

/// Engine speed control at work.
struct Governor<'a> {
    control: EngineSpeedControl<'a>,
    sample_time_s: f64,
    integral_nm: f64,
}

impl<'a> Governor<'a> {
    fn new(control: &EngineSpeedControl<'a>, inputs: &Inputs<'_>) -> Result<Self, SimulationError> {
        let (expected, found) = (inputs.engine_torque_nm.len(), control.demand_rad_s.len());
        if expected != found {
            return Err(SimulationError::Length { what: "engine speed demand", expected, found });
        }
        Ok(Governor { control: *control, sample_time_s: inputs.sample_time_s, integral_nm: control.start_nm })
    }

    /// The torque that sample `k` asks for is there at the next one.
    fn update(&mut self, k: usize, reading_rad_s: f64, engine_torque_nm: &mut [f64]) {
        let error_rad_s = self.control.demand_rad_s[k] - reading_rad_s;
        let torque_nm = self.control.proportional_nm_s_per_rad * error_rad_s + self.integral_nm;
        self.integral_nm += self.control.integral_nm_per_rad * self.sample_time_s * error_rad_s;
        if let Some(next) = engine_torque_nm.get_mut(k + 1) {
            *next += torque_nm;
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
