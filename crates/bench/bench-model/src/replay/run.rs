//! A recording on its way through the model.

use rig::estimation::EstimateError;
use rig::{ControlMode, Experiment, Role};
use signal::resample::hold;

use super::compare::Comparison;
use super::error::ReplayError;
use super::inputs::ReplayInputs;
use super::once_a_turn::OnceATurn;
use super::reconstruct::Acted;
use super::reconstruct::needed;
use crate::model::{BenchModel, ModelParameter};
use crate::simulate::{DynoInput, InitialState, Inputs, Response, Ripple, simulate_with_ripple};

/// Unknowns of the fit: the bench at the start, the once-a-turn error of N_e, and a constant error of T_e.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Start {
    pub(super) state: InitialState,
    /// Once-a-turn error of the recorded N_e: cosine and sine.
    pub(super) engine_encoder: [f64; 2],
    pub(super) engine_torque_error_nm: f64,
}

/// A replay ready to be simulated from any start.
pub(super) struct Run<'a> {
    pub(super) experiment: &'a Experiment,
    pub(super) inputs: &'a ReplayInputs<'a>,
    pub(super) model: BenchModel,
    pub(super) acted: Acted,
    pub(super) engine_turn: OnceATurn,
    /// Ripple of T_d: relative, and added with the offset, Nm; empty where none is known.
    pub(super) ripple: (Vec<f64>, Vec<f64>),
    /// N_d* in speed control, T_d* in torque control.
    pub(super) demand: Option<Vec<f64>>,
}

impl<'a> Run<'a> {
    pub(super) fn new(
        experiment: &'a Experiment,
        model: &BenchModel,
        inputs: &'a ReplayInputs<'a>,
        acted: Acted,
    ) -> Result<Self, EstimateError> {
        let late = 0.5 * model.encoder_gate_s + inputs.skews.torque_s;
        let delay = model.value(ModelParameter::TorqueControlDelay).map(|d| (d - late).max(0.0));
        let model = delay.map_or_else(|| model.clone(), |d| model.with(ModelParameter::TorqueControlDelay, d));
        let role = match experiment.label.mode {
            ControlMode::Nt => Some(Role::DynoSpeedDemand),
            ControlMode::Tn => model.torque_control.map(|_| Role::DynoTorqueDemand),
        };
        let demand = role.map(|role| held(experiment, &acted, role)).transpose()?;
        let stamps = (0..acted.len()).map(|i| acted.start_s + i as f64 * acted.step_s + late);
        let ripple = inputs.ripple.map_or_else(Default::default, |r| stamps.map(|t| r.at(t)).unzip());
        let engine_turn = OnceATurn::new(&acted.engine_speed, acted.step_s, model.encoder_gate_s);
        Ok(Run { experiment, inputs, model, acted, engine_turn, ripple, demand })
    }

    pub(super) fn comparison(&self, start: &Start) -> Comparison<'_> {
        Comparison {
            experiment: self.experiment,
            inputs: self.inputs,
            acted: &self.acted,
            gate_s: self.model.encoder_gate_s,
            engine_encoder_error: self.engine_turn.reading(start.engine_encoder),
        }
    }

    pub(super) fn simulate(&self, start: &Start) -> Result<Response, ReplayError> {
        let error = start.engine_torque_error_nm;
        let inertia = self.model.mechanics.engine_inertia_kg_m2;
        let apparent = self.engine_turn.slope(start.engine_encoder);
        let torques = self.acted.engine_torque.iter().zip(&apparent);
        let engine_torque: Vec<f64> = torques.map(|(t, slope)| t - inertia * slope + error).collect();
        let dyno = match (&self.demand, self.experiment.label.mode) {
            (Some(demand), ControlMode::Nt) => DynoInput::SpeedDemand(demand),
            (Some(demand), ControlMode::Tn) => DynoInput::TorqueDemand(demand),
            (None, _) => DynoInput::AirGapTorque(&self.acted.air_gap_torque),
        };
        let inputs = Inputs { sample_time_s: self.acted.step_s, engine_torque_nm: &engine_torque, dyno };
        let ripple = Ripple { relative: &self.ripple.0, added_nm: &self.ripple.1 };
        simulate_with_ripple(&self.model, &inputs, ripple, &start.state)
            .map_err(|source| ReplayError::Simulation { file: self.experiment.file.clone(), source })
    }
}

/// A demand at the instants of the replay.
pub(super) fn held(experiment: &Experiment, acted: &Acted, role: Role) -> Result<Vec<f64>, EstimateError> {
    let times: Vec<f64> = (0..acted.len()).map(|i| acted.start_s + i as f64 * acted.step_s).collect();
    hold(needed(experiment, role)?, &times)
        .map_err(|source| EstimateError::Signal { file: experiment.file.clone(), source })
}
