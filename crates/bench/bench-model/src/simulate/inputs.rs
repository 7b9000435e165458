//! Inputs of the model, and the state from which it starts.

use crate::model::BenchModel;

/// Input of the dynamometer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum DynoInput<'a> {
    /// Speed control: ω_d*, rad/s, one value an update of the controller.
    SpeedDemand(&'a [f64]),
    /// Torque control: T_d*, Nm, each value held until the next.
    TorqueDemand(&'a [f64]),
    /// The air-gap torque itself, Nm, straight between the samples; torque control and limit play no part.
    AirGapTorque(&'a [f64]),
}

/// Inputs of a simulation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Inputs<'a> {
    /// Time between samples of every input, s.
    pub sample_time_s: f64,
    /// T_e, Nm, straight between the samples.
    pub engine_torque_nm: &'a [f64],
    /// Input of the dynamometer.
    pub dyno: DynoInput<'a>,
}

/// State of the bench at the first sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InitialState {
    /// ω_d, rad/s.
    pub dyno_speed_rad_s: f64,
    /// ω_e, rad/s.
    pub engine_speed_rad_s: f64,
    /// Δθ, rad.
    pub twist_rad: f64,
    /// T_d, Nm.
    pub air_gap_torque_nm: f64,
    /// Output of the controller's integrator, Nm; m of the feed-forward included.
    pub integrator_nm: f64,
}

impl InitialState {
    /// Everything turning at one speed under one torque.
    pub fn steady(model: &BenchModel, speed_rad_s: f64, torque_nm: f64) -> Self {
        let feed_forward = model.feed_forward.map_or(0.0, |f| f.speed_nm_s_per_rad * speed_rad_s);
        InitialState {
            dyno_speed_rad_s: speed_rad_s,
            engine_speed_rad_s: speed_rad_s,
            twist_rad: torque_nm / model.mechanics.stiffness_nm_per_rad,
            air_gap_torque_nm: torque_nm,
            integrator_nm: torque_nm - feed_forward,
        }
    }

    /// The same where friction brakes the dynamometer with some of the shaft's torque.
    #[must_use]
    pub fn with_friction(self, friction_nm: f64) -> Self {
        InitialState {
            air_gap_torque_nm: self.air_gap_torque_nm - friction_nm,
            integrator_nm: self.integrator_nm - friction_nm,
            ..self
        }
    }
}
