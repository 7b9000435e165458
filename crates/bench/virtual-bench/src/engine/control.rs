//! The engine's speed control.

use rig::bench_parameters::EngineParameters;

/// Engine speed control in TN mode: T = K_p (ω_e* − ω_e) + I, dI/dt = K_i (ω_e* − ω_e), every update.
#[derive(Debug, Clone)]
pub(crate) struct EngineSpeedControl {
    proportional: f64,
    integral_gain: f64,
    integral_nm: f64,
}

impl EngineSpeedControl {
    /// The control at rest at a torque.
    pub(crate) fn new(parameters: &EngineParameters, torque_nm: f64) -> Self {
        Self {
            proportional: parameters.speed_control_proportional_nm_s_per_rad,
            integral_gain: parameters.speed_control_integral_nm_per_rad,
            integral_nm: torque_nm,
        }
    }

    /// One update; returns the torque level, Nm.
    pub(crate) fn update(&mut self, error_rad_s: f64, update_s: f64) -> f64 {
        let level_nm = self.proportional * error_rad_s + self.integral_nm;
        self.integral_nm += self.integral_gain * update_s * error_rad_s;
        level_nm
    }
}
