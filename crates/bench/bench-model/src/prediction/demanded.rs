//! Demands of a plan on the bench, on the clock of the prediction.

use rig::ControlMode;
use rig::experiment::UPDATE_S;

use super::PredictionInputs;
use crate::intake::demanded_torque_nm;

/// Demands on the bench, on one clock.
pub(super) struct Demanded {
    pub(super) speed_rad_s: Vec<f64>,
    pub(super) dyno_torque_nm: Vec<f64>,
    /// The engine's torque; in torque control of a fired engine beside that of its speed control.
    pub(super) engine_torque_nm: Vec<f64>,
    /// η at every sample.
    pub(super) ignition_efficiency: Vec<f64>,
    /// Torque that the engine gives at rest at the start.
    pub(super) mean_engine_torque_nm: f64,
}

impl Demanded {
    pub(super) fn of(inputs: &PredictionInputs<'_>, sample_time_s: f64) -> Self {
        let PredictionInputs { plan, demands, engine, .. } = *inputs;
        let on_clock = |values: &[f64]| resampled(values, sample_time_s);
        let speed_rad_s = on_clock(&demands.speed_rad_s);
        let constant = |torque_nm: f64| vec![torque_nm; speed_rad_s.len()];
        let (engine_torque_nm, governed_nm) = match (plan.has_shaft, plan.is_motored, plan.label.mode) {
            (false, ..) => (constant(0.0), 0.0),
            (true, true, _) => (constant(engine.motored_torque_nm), 0.0),
            (true, false, ControlMode::Nt) => (on_clock(&demanded_torque_nm(engine, demands)), 0.0),
            (true, false, ControlMode::Tn) => {
                (constant(0.0), demands.dyno_torque_nm[0] + inputs.friction.torque_nm(speed_rad_s[0]))
            }
        };
        Demanded {
            mean_engine_torque_nm: engine_torque_nm[0] + governed_nm,
            dyno_torque_nm: on_clock(&demands.dyno_torque_nm),
            ignition_efficiency: on_clock(&demands.ignition_efficiency),
            speed_rad_s,
            engine_torque_nm,
        }
    }

    /// The same after so many samples of the first demands.
    pub(super) fn after(&self, samples: usize) -> Self {
        Demanded {
            speed_rad_s: held_before(samples, &self.speed_rad_s),
            dyno_torque_nm: held_before(samples, &self.dyno_torque_nm),
            engine_torque_nm: held_before(samples, &self.engine_torque_nm),
            ignition_efficiency: held_before(samples, &self.ignition_efficiency),
            mean_engine_torque_nm: self.mean_engine_torque_nm,
        }
    }
}

/// A series with its first value so many times before it.
fn held_before(samples: usize, series: &[f64]) -> Vec<f64> {
    std::iter::repeat_n(series[0], samples).chain(series.iter().copied()).collect()
}

/// Values of every millisecond, held, on another clock.
fn resampled(values: &[f64], sample_time_s: f64) -> Vec<f64> {
    let ratio = sample_time_s / UPDATE_S;
    let count = ((values.len() as f64 / ratio + 1e-6).floor() as usize).max(1);
    let last = values.len().saturating_sub(1);
    (0..count).map(|k| values[((k as f64 * ratio + 1e-6).floor() as usize).min(last)]).collect()
}
