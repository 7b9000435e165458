//! The bench at the start of a replay.

use faer::Mat;
use rig::estimation::EstimateError;
use rig::{ControlMode, Role};

use super::ReplayError;
use crate::replay::run::{Run, Start, held};
use crate::simulate::InitialState;

/// In speed control the start is fitted on this much, s.
const FITTED_S: f64 = 10.0;
/// Steps of the numerical derivatives; the response is linear, so their size hardly matters.
const STEPS: [f64; 6] = [1.0, 1.0, 1e-2, 1e-3, 1e-3, 1.0];

impl Run<'_> {
    /// The start by least squares on N_d and N_e, from a first guess read off the reconstruction.
    pub(super) fn fitted_start(&self) -> Result<Start, ReplayError> {
        let guess = self.guess()?;
        let reference = self.speeds(&guess)?;
        let measured = self.measured_speeds(&guess);
        let mut columns = Vec::with_capacity(STEPS.len());
        for (which, step) in STEPS.iter().enumerate() {
            let moved = self.speeds(&self.moved(&guess, which, *step))?;
            columns.push(moved.iter().zip(&reference).map(|(m, r)| (m - r) / step).collect::<Vec<f64>>());
        }
        let target: Vec<f64> = measured.iter().zip(&reference).map(|(m, r)| m - r).collect();
        let regressors = Mat::from_fn(target.len(), STEPS.len(), |i, j| columns[j][i]);
        let fit = fitting::least_squares(regressors.as_ref(), &target)
            .map_err(|source| EstimateError::Ident { file: self.experiment.file.clone(), source })?;
        Ok(fit.parameters.iter().enumerate().fold(guess, |start, (which, by)| self.moved(&start, which, *by)))
    }

    fn guess(&self) -> Result<Start, EstimateError> {
        let (acted, mechanics) = (&self.acted, self.model.mechanics);
        let (dyno, engine) = (acted.dyno_speed[0], acted.engine_speed[0]);
        let damping_torque = mechanics.damping_nm_s_per_rad * (engine - dyno);
        let state = InitialState {
            dyno_speed_rad_s: dyno,
            engine_speed_rad_s: engine,
            twist_rad: (acted.shaft_torque[0] - damping_torque) / mechanics.stiffness_nm_per_rad,
            air_gap_torque_nm: self.smooth_torque_guess(),
            integrator_nm: self.integrator_guess()?,
        };
        Ok(Start { state, engine_encoder: [0.0; 2], engine_torque_error_nm: 0.0 })
    }

    /// T_d at the first sample without its ripple.
    fn smooth_torque_guess(&self) -> f64 {
        let first = |series: &[f64]| series.first().copied().unwrap_or(0.0);
        (self.acted.air_gap_torque[0] - first(&self.ripple.1)) / (1.0 + first(&self.ripple.0))
    }

    /// T_d* less proportional part and feed-forward at the first sample; zero in torque control.
    fn integrator_guess(&self) -> Result<f64, EstimateError> {
        let (Some(demand), Some(pi), ControlMode::Nt) =
            (&self.demand, self.model.speed_controller, self.experiment.label.mode)
        else {
            return Ok(0.0);
        };
        let torque = held(self.experiment, &self.acted, Role::DynoTorqueDemand)?;
        let error = self.acted.recorded_speed[0] - demand[0];
        let feed_forward = self.model.feed_forward.map_or(0.0, |f| f.speed_nm_s_per_rad * demand[0]);
        Ok(torque[0] - pi.proportional_nm_s_per_rad * error - feed_forward)
    }

    fn moved(&self, start: &Start, which: usize, by: f64) -> Start {
        let mut moved = *start;
        match (which, self.experiment.label.mode) {
            (0, _) => moved.state.dyno_speed_rad_s += by,
            (1, _) => moved.state.engine_speed_rad_s += by,
            (2, _) => moved.state.twist_rad += by,
            (3, _) => moved.engine_encoder[0] += by,
            (4, _) => moved.engine_encoder[1] += by,
            (_, ControlMode::Nt) => moved.state.integrator_nm += by,
            (_, ControlMode::Tn) => moved.engine_torque_error_nm += by,
        }
        moved
    }

    /// N_d, then N_e, as the model has them, over the stretch the start is fitted on.
    fn speeds(&self, start: &Start) -> Result<Vec<f64>, ReplayError> {
        let response = self.simulate(start)?;
        let comparison = self.comparison(start);
        let mut speeds = comparison.dyno_speed_of(&response);
        speeds.truncate(self.fitted_samples(self.acted.step_s));
        let measured = comparison.engine_speed();
        let mut engine = comparison.engine_speed_of(&response, measured.as_ref())?;
        engine.truncate(self.fitted_samples(measured.map_or(self.acted.step_s, |m| m.sample_time_s)));
        speeds.extend(engine);
        Ok(speeds)
    }

    fn measured_speeds(&self, start: &Start) -> Vec<f64> {
        let mut speeds = self.acted.recorded_speed.clone();
        speeds.truncate(self.fitted_samples(self.acted.step_s));
        if let Some(engine) = self.comparison(start).engine_speed() {
            speeds.extend(engine.samples.iter().take(self.fitted_samples(engine.sample_time_s)));
        }
        speeds
    }

    fn fitted_samples(&self, step_s: f64) -> usize {
        match self.experiment.label.mode {
            ControlMode::Nt => (FITTED_S / step_s) as usize,
            ControlMode::Tn => usize::MAX,
        }
    }
}
