//! Recordings replayed on the assembled model (thesis §7.3).

mod compare;
mod encoder_error;
mod error;
mod initial;
mod once_a_turn;
mod reconstruct;
mod result;

use rig::estimation::EstimateError;
use rig::results::Stretch;
use rig::{ControlMode, Experiment, Role};
use signal::Signal;
use signal::resample::hold;

use crate::drive_ripple::DriveRipple;
use crate::model::{BenchModel, ModelParameter};
use crate::simulate::{Drive, InitialState, Inputs, Response, Ripple, simulate_with_ripple};
use crate::skews::SignalSkews;
use compare::Comparison;
pub use encoder_error::{EncoderError, encoder_error};
pub use error::ReplayError;
use once_a_turn::OnceATurn;
use reconstruct::{Acted, reconstruct};
pub use result::Replay;

/// What a replay takes in addition to the recording and the model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReplayInputs<'a> {
    /// T_d at 1 kHz, on the clock of T_d,calc; T_d,calc itself, band-limited, where `None`.
    pub air_gap_torque: Option<&'a Signal>,
    /// Offset and ripple of T_d as they were in this recording, on the clock of T_d,calc. They are put upon the modelled
    /// T_d; without it the replay has none. Delay and lag are those of the bench model.
    pub ripple: Option<&'a DriveRipple>,
    /// Skews of N_e and T_d against N_d.
    pub skews: SignalSkews,
    /// Once-a-turn error of the recorded N_d. It is taken out of the reconstruction and put onto the modelled N_d before
    /// that is compared.
    pub encoder_error: Option<EncoderError>,
    /// Up to where torques are reconstructed, Hz; above it the reconstruction falls to zero at 1.4 times that.
    pub band_hz: f64,
    /// Part of the recording, s of its clock; all of it where `None`.
    pub stretch_s: Option<(f64, f64)>,
    /// Whether any part of the model was estimated from this recording.
    pub seen_in_estimation: bool,
}

impl Default for ReplayInputs<'_> {
    fn default() -> Self {
        ReplayInputs {
            air_gap_torque: None,
            ripple: None,
            skews: SignalSkews::default(),
            encoder_error: None,
            band_hz: 120.0,
            stretch_s: None,
            seen_in_estimation: false,
        }
    }
}

/// Replays a recording: simulates the model under the demands that were given and the engine torque that acted, and
/// compares N_d, N_e, T_d, T_shaft and, in speed control, T_d* with what was recorded.
///
/// The engine torque is reconstructed, T_e = J_e dω_e/dt + T_shaft with T_shaft = J_d dω_d/dt + T_d, by zero-phase means.
/// It holds N_d and N_e themselves, so agreement of the speeds is partly built in; what is tested is the shaft between
/// them, the controller, and the inverter.
///
/// Speed control: ω_d, ω_e, Δθ and the integrator at the start are refined by least squares on the speeds of the first
/// ten seconds. Torque control: nothing holds the speed, so the smallest error of the mean torque grows into a drift;
/// ω_d, ω_e, Δθ at the start and a constant error of T_e are fitted to the speeds of the whole stretch. A linear drift of
/// the speeds is therefore no test of the model in torque control. Torque control is driven by T_d* where the model has
/// an inverter, else by T_d.
///
/// The ripple of the drive is a known disturbance: its amplitudes, phases and frequencies are taken from the recording's
/// own T_d,calc, not predicted, while the torque it is relative to is the modelled one; N_d and T_shaft answer it. So the
/// comparison of T_d says how well controller and inverter are modelled, and nothing of how well ripple can be foretold.
///
/// The engine's encoder has a once-a-turn error too, which makes a torque appear in T_e that never was; near the resonance
/// it would drown all else. Its two amplitudes are fitted with the start, so at order 1 of the speed agreement is partly
/// built in.
///
/// T_d* is taken to stand on the clock of N_d; the inverter's delay, which was estimated on the clock of T_d,calc, is
/// corrected by what that is late.
///
/// # Errors
/// N_d, N_e, T_d or the demand is missing; less than a second is common to all; the model lacks the speed controller or
/// inverter that speed control needs.
pub fn replay(experiment: &Experiment, model: &BenchModel, inputs: &ReplayInputs<'_>) -> Result<Replay, ReplayError> {
    let acted = reconstruct(experiment, model, inputs)?;
    let run = Run::new(experiment, model, inputs, acted)?;
    let start = run.fitted_start()?;
    let response = run.simulate(&start)?;
    let (acted, comparison) = (&run.acted, run.comparison(&start));
    Ok(Replay {
        stretch: Stretch { file: experiment.file.clone(), start_s: acted.start_s, end_s: acted.end_s() },
        label: experiment.label.to_string(),
        mode: experiment.label.mode,
        seen_in_estimation: inputs.seen_in_estimation,
        signals: comparison.all(response)?,
    })
}

/// What is fitted: the bench at the start, the once-a-turn error of N_e, and a constant error of T_e.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Start {
    state: InitialState,
    /// Once-a-turn error of the recorded N_e: cosine and sine.
    engine_encoder: [f64; 2],
    engine_torque_error_nm: f64,
}

/// A replay ready to be simulated from any start.
struct Run<'a> {
    experiment: &'a Experiment,
    inputs: &'a ReplayInputs<'a>,
    model: BenchModel,
    acted: Acted,
    engine_turn: OnceATurn,
    /// Ripple of T_d: relative, and added with the offset, Nm; empty where none is known.
    ripple: (Vec<f64>, Vec<f64>),
    /// N_d* in speed control, T_d* in torque control.
    demand: Option<Vec<f64>>,
}

impl<'a> Run<'a> {
    fn new(
        experiment: &'a Experiment,
        model: &BenchModel,
        inputs: &'a ReplayInputs<'a>,
        acted: Acted,
    ) -> Result<Self, EstimateError> {
        let late = 0.5 * model.encoder_gate_s + inputs.skews.torque_s;
        let delay = model.value(ModelParameter::InverterDelay).map(|d| (d - late).max(0.0));
        let model = delay.map_or_else(|| model.clone(), |d| model.with(ModelParameter::InverterDelay, d));
        let role = match experiment.label.mode {
            ControlMode::Nt => Some(Role::DynoSpeedDemand),
            ControlMode::Tn => model.inverter.map(|_| Role::DynoTorqueDemand),
        };
        let demand = role.map(|role| held(experiment, &acted, role)).transpose()?;
        let stamps = (0..acted.len()).map(|i| acted.start_s + i as f64 * acted.step_s + late);
        let ripple = inputs.ripple.map_or_else(Default::default, |r| stamps.map(|t| r.at(t)).unzip());
        let engine_turn = OnceATurn::new(&acted.engine_speed, acted.step_s, model.encoder_gate_s);
        Ok(Run { experiment, inputs, model, acted, engine_turn, ripple, demand })
    }

    fn comparison(&self, start: &Start) -> Comparison<'_> {
        Comparison {
            experiment: self.experiment,
            inputs: self.inputs,
            acted: &self.acted,
            gate_s: self.model.encoder_gate_s,
            engine_encoder_error: self.engine_turn.reading(start.engine_encoder),
        }
    }

    fn simulate(&self, start: &Start) -> Result<Response, ReplayError> {
        let error = start.engine_torque_error_nm;
        let inertia = self.model.mechanics.engine_inertia_kg_m2;
        let apparent = self.engine_turn.slope(start.engine_encoder);
        let torques = self.acted.engine_torque.iter().zip(&apparent);
        let engine_torque: Vec<f64> = torques.map(|(t, slope)| t - inertia * slope + error).collect();
        let drive = match (&self.demand, self.experiment.label.mode) {
            (Some(demand), ControlMode::Nt) => Drive::SpeedDemand(demand),
            (Some(demand), ControlMode::Tn) => Drive::TorqueDemand(demand),
            (None, _) => Drive::AirGapTorque(&self.acted.air_gap_torque),
        };
        let inputs = Inputs { sample_time_s: self.acted.step_s, engine_torque_nm: &engine_torque, drive };
        let ripple = Ripple { relative: &self.ripple.0, added_nm: &self.ripple.1 };
        simulate_with_ripple(&self.model, &inputs, ripple, &start.state)
            .map_err(|source| ReplayError::Simulation { file: self.experiment.file.clone(), source })
    }
}

/// A demand at the instants of the replay.
fn held(experiment: &Experiment, acted: &Acted, role: Role) -> Result<Vec<f64>, EstimateError> {
    let times: Vec<f64> = (0..acted.len()).map(|i| acted.start_s + i as f64 * acted.step_s).collect();
    hold(reconstruct::needed(experiment, role)?, &times)
        .map_err(|source| EstimateError::Signal { file: experiment.file.clone(), source })
}
