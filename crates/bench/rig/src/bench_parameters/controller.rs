//! The dynamometer's controllers.

use serde::{Deserialize, Serialize};
use units::RPM_RAD_S;

use crate::bench_parameters::{ParameterError, require, require_not_negative};
use crate::experiment::DEMAND_HOLD_S;
use crate::results::DelayPlace;

/// Speed control, updated every millisecond: T_d* = e^{−sτ} (K_p + K_i/s)(N_d − N_d*) + k N_d* + m + k_a dN_d*/dt
/// (thesis 6.2, 6.6, 6.7), limited to ± the torque limit.
///
/// In discrete form, with e the measured speed error of update j and T = 1 ms: v_j = K_p e_j + I_j, I_{j+1} = I_j + K_i
/// T e_j; the integrator rests while the limit is exceeded and e_j would drive it further. v_j takes effect τ later and
/// the feed-forward at once, unless the delay acts on the measured speed alone or on both; dN_d*/dt is the backward
/// difference of N_d* over T.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ControllerParameters {
    /// K_p, Nm s/rad.
    pub proportional_nm_s_per_rad: f64,
    /// K_i, Nm/rad.
    pub integral_nm_per_rad: f64,
    /// τ, transport delay of the PI part, s.
    pub delay_s: f64,
    /// Where τ acts.
    pub delay_place: DelayPlace,
    /// k, feed-forward of N_d*, Nm s/rad.
    pub speed_feed_forward_nm_s_per_rad: f64,
    /// m, constant part of the feed-forward, Nm.
    pub offset_feed_forward_nm: f64,
    /// k_a, feed-forward of dN_d*/dt, Nm s²/rad.
    pub acceleration_feed_forward_nm_s2_per_rad: f64,
    /// Integral gain of the shaft-torque control, 1/s. It runs every millisecond too: T_d* = T_shaft* + I, dI/dt = K
    /// (T_shaft* − T_shaft) with T_shaft as the bench knows it: from its flange, or its own.
    pub shaft_torque_integral_per_s: f64,
    /// The automation system's torque demands (T_d* and the engine's) change only once in this time, s.
    pub demand_hold_s: f64,
}

impl Default for ControllerParameters {
    fn default() -> Self {
        Self {
            proportional_nm_s_per_rad: 0.9385 / RPM_RAD_S,
            integral_nm_per_rad: 1.865 / RPM_RAD_S,
            delay_s: 0.001,
            delay_place: DelayPlace::SpeedError,
            speed_feed_forward_nm_s_per_rad: 0.012 / RPM_RAD_S,
            offset_feed_forward_nm: -4.0,
            acceleration_feed_forward_nm_s2_per_rad: -0.085 / RPM_RAD_S,
            shaft_torque_integral_per_s: 4.0,
            demand_hold_s: DEMAND_HOLD_S,
        }
    }
}

impl ControllerParameters {
    pub(crate) fn check(&self) -> Result<(), ParameterError> {
        let any = [
            ("controller.proportional_nm_s_per_rad", self.proportional_nm_s_per_rad),
            ("controller.integral_nm_per_rad", self.integral_nm_per_rad),
            ("controller.speed_feed_forward_nm_s_per_rad", self.speed_feed_forward_nm_s_per_rad),
            ("controller.offset_feed_forward_nm", self.offset_feed_forward_nm),
            ("controller.acceleration_feed_forward_nm_s2_per_rad", self.acceleration_feed_forward_nm_s2_per_rad),
        ];
        for (name, value) in any {
            require(name, value, true, "finite")?;
        }
        let delay = self.delay_s;
        require("controller.delay_s", delay, (0.0..=1.0).contains(&delay), "between 0 and 1 s")?;
        let of_speed_alone = self.delay_place == DelayPlace::MeasuredSpeed;
        let updates = 1e3 * delay;
        let is_whole = !of_speed_alone || (updates - updates.round()).abs() < 1e-6;
        require(
            "controller.delay_s",
            delay,
            is_whole,
            "a whole number of milliseconds where it acts on the measured speed alone",
        )?;
        require_not_negative("controller.shaft_torque_integral_per_s", self.shaft_torque_integral_per_s)?;
        require_not_negative("controller.demand_hold_s", self.demand_hold_s)
    }
}
