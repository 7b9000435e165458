//! Shaft-torque control: the third control mode of the bench (thesis §3.2).

use rig::bench_parameters::ControllerParameters;

/// T_d* = T_shaft* + I, dI/dt = K (T_shaft* − T_shaft), within ± the torque limit; the integrator rests while the limit
/// is exceeded and the error would drive it further. At rest T_d* = T_shaft* − T_fric: the integrator finds the
/// friction.
#[derive(Debug, Clone)]
pub(crate) struct ShaftTorqueController {
    integral_per_s: f64,
    limit_nm: f64,
    update_s: f64,
    integral_nm: f64,
}

impl ShaftTorqueController {
    /// The controller at rest: holding a shaft torque with an air-gap torque.
    pub(crate) fn new(
        parameters: &ControllerParameters,
        limit_nm: f64,
        update_s: f64,
        shaft_nm: f64,
        air_gap_nm: f64,
    ) -> Self {
        let integral_nm = air_gap_nm - shaft_nm;
        Self { integral_per_s: parameters.shaft_torque_integral_per_s, limit_nm, update_s, integral_nm }
    }

    /// One update with the demand and the shaft torque as the bench knows it; returns T_d*, Nm.
    pub(crate) fn update(&mut self, demand_nm: f64, shaft_nm: f64) -> f64 {
        let output_nm = demand_nm + self.integral_nm;
        let change_nm = self.integral_per_s * self.update_s * (demand_nm - shaft_nm);
        if output_nm.abs() <= self.limit_nm || change_nm * output_nm <= 0.0 {
            self.integral_nm += change_nm;
        }
        output_nm.clamp(-self.limit_nm, self.limit_nm)
    }
}
