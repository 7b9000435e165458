//! Recorded against modelled, each quantity on its own raster.

use fitting::{fit_percent, rms_error};
use rig::estimation::EstimateError;
use rig::results::{Stretch, Trace, Validation};
use rig::{Experiment, Role};
use signal::Signal;
use signal::resample::{Interpolation, hold, interpolate_at};
use signal::zero_phase::{Wanted, ZeroPhase};
use units::RPM_RAD_S;

use super::reconstruct::Acted;
use crate::replay::inputs::ReplayInputs;
use crate::simulate::Response;

/// Compared signals keep off the ends of the simulation by this, s, so that skews can be undone.
const MARGIN_S: f64 = 0.02;

pub(super) struct Comparison<'a> {
    pub(super) experiment: &'a Experiment,
    pub(super) inputs: &'a ReplayInputs<'a>,
    pub(super) acted: &'a Acted,
    pub(super) gate_s: f64,
    /// Once-a-turn error in the reading of N_e, on the clock of the simulation.
    pub(super) engine_encoder_error: Vec<f64>,
}

impl Comparison<'_> {
    pub(super) fn all(&self, response: Response) -> Result<Vec<Validation>, EstimateError> {
        let acted = self.acted;
        let recorded = acted.signal(acted.recorded_speed.clone());
        let mut found = vec![self.validation("N_d", "rpm", recorded, self.dyno_speed_of(&response))?];
        if let Some(measured) = self.engine_speed() {
            let modelled = self.engine_speed_of(&response, Some(&measured))?;
            found.push(self.validation("N_e", "rpm", measured, modelled)?);
        }
        if let Some(measured) = self.recorded(Role::AirGapTorque) {
            let late = 0.5 * self.gate_s + self.inputs.skews.torque_s;
            let modelled = self.late(&response.air_gap_torque_nm, &measured, late)?;
            found.push(self.validation("T_d", "Nm", measured, modelled)?);
        }
        found.push(self.shaft_torque(response.shaft_torque_nm)?);
        if self.experiment.label.mode == rig::ControlMode::Nt && !response.torque_demand_nm.is_empty() {
            found.extend(self.torque_demand(response.torque_demand_nm)?);
        }
        Ok(found)
    }

    /// N_d of the model as the recording would show it.
    pub(super) fn dyno_speed_of(&self, response: &Response) -> Vec<f64> {
        response.dyno_speed_rad_s.iter().zip(&self.acted.encoder_error).map(|(n, e)| n + e).collect()
    }

    /// N_e as recorded, within the simulated time.
    pub(super) fn engine_speed(&self) -> Option<Signal> {
        self.recorded(Role::EngineSpeed)
    }

    /// N_e of the model at the instants of the recorded one.
    pub(super) fn engine_speed_of(
        &self,
        response: &Response,
        measured: Option<&Signal>,
    ) -> Result<Vec<f64>, EstimateError> {
        let shown = response.engine_speed_rad_s.iter().zip(&self.engine_encoder_error);
        let shown: Vec<f64> = shown.map(|(n, e)| n + e).collect();
        let modelled = |m| self.late(&shown, m, self.inputs.skews.engine_speed_s);
        measured.map_or(Ok(Vec::new()), modelled)
    }

    fn recorded(&self, role: Role) -> Option<Signal> {
        let cut = |x: &Signal| x.slice(self.acted.start_s + MARGIN_S, self.acted.end_s() - MARGIN_S);
        self.experiment.signal(role).map(cut)
    }

    /// Values of the model `late_s` before each instant of a recorded signal.
    fn late(&self, modelled: &[f64], recorded: &Signal, late_s: f64) -> Result<Vec<f64>, EstimateError> {
        let modelled = self.acted.signal(modelled.to_vec());
        let times: Vec<f64> = (0..recorded.len())
            .map(|i| (recorded.time_s(i) - late_s).clamp(modelled.start_s, modelled.end_s()))
            .collect();
        interpolate_at(&modelled, &times, Interpolation::BandLimited).map_err(|source| self.signal_error(source))
    }

    /// The flange's torque, or else the reconstructed one, with the model's through the same low-pass.
    fn shaft_torque(&self, modelled: Vec<f64>) -> Result<Validation, EstimateError> {
        if let Some(flange) = self.recorded(Role::FlangeTorque) {
            let modelled = self.late(&modelled, &flange, 0.0)?;
            return self.validation("T_shaft", "Nm", flange, modelled);
        }
        let acted = self.acted;
        let low_pass = ZeroPhase { band_hz: self.inputs.band_hz, gate_s: 0.0, wanted: Wanted::Value };
        let smooth = low_pass.at(&acted.signal(modelled), acted.start_s, acted.step_s, acted.len());
        self.validation("T_shaft", "Nm", acted.signal(acted.shaft_torque.clone()), smooth)
    }

    fn torque_demand(&self, modelled: Vec<f64>) -> Result<Option<Validation>, EstimateError> {
        let Some(recorded) = self.experiment.signal(Role::DynoTorqueDemand) else { return Ok(None) };
        let grid = self.acted.signal(modelled);
        let times: Vec<f64> = (0..grid.len()).map(|i| grid.time_s(i)).collect();
        let measured = hold(recorded, &times).map_err(|source| self.signal_error(source))?;
        self.validation("T_d*", "Nm", grid.with_samples(measured), grid.samples).map(Some)
    }

    fn validation(
        &self,
        quantity: &str,
        unit: &str,
        measured: Signal,
        modelled: Vec<f64>,
    ) -> Result<Validation, EstimateError> {
        let ident_error = |source| EstimateError::Ident { file: self.experiment.file.clone(), source };
        let scale = if unit == "rpm" { RPM_RAD_S } else { 1.0 };
        let trace = |samples: &[f64]| Trace {
            start_s: measured.start_s,
            sample_time_s: measured.sample_time_s,
            values: samples.iter().map(|v| v / scale).collect(),
        };
        Ok(Validation {
            stretch: Stretch { file: self.experiment.file.clone(), start_s: measured.start_s, end_s: measured.end_s() },
            quantity: quantity.to_owned(),
            unit: unit.to_owned(),
            fit_percent: fit_percent(&measured.samples, &modelled).map_err(ident_error)?,
            rms_error: rms_error(&measured.samples, &modelled).map_err(ident_error)? / scale,
            measured: trace(&measured.samples),
            modelled: trace(&modelled),
            residuals: None,
        })
    }

    fn signal_error(&self, source: signal::SignalError) -> EstimateError {
        EstimateError::Signal { file: self.experiment.file.clone(), source }
    }
}
