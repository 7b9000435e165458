//! Additions of firing pulses to what has limits.

/// Largest additions of pulses; nothing by default.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Added {
    /// To T_shaft upwards, Nm.
    pub(crate) shaft_above_nm: f64,
    /// To T_shaft downwards, Nm.
    pub(crate) shaft_below_nm: f64,
    /// To |dT_shaft/dt|, Nm/s.
    pub(crate) shaft_slew_nm_per_s: f64,
    /// To |T_d*|, Nm.
    pub(crate) demand_nm: f64,
    /// Their root mean square in T_d*, Nm.
    pub(crate) demand_rms_nm: f64,
    /// To the change of T_d* within 10 ms, Nm/s.
    pub(crate) demand_slew_nm_per_s: f64,
    /// To |ω_d|, rad/s.
    pub(crate) dyno_speed_rad_s: f64,
    /// To |ω_e|, rad/s.
    pub(crate) engine_speed_rad_s: f64,
    /// To the change of ω_d within 50 ms, rad/s².
    pub(crate) speed_gradient_rad_s2: f64,
}

impl Added {
    /// The larger of each.
    pub(crate) fn or_more(&self, other: &Added) -> Added {
        self.with(other, f64::max)
    }

    /// Each of both.
    pub(crate) fn with(&self, other: &Added, of: impl Fn(f64, f64) -> f64) -> Added {
        Added {
            shaft_above_nm: of(self.shaft_above_nm, other.shaft_above_nm),
            shaft_below_nm: of(self.shaft_below_nm, other.shaft_below_nm),
            shaft_slew_nm_per_s: of(self.shaft_slew_nm_per_s, other.shaft_slew_nm_per_s),
            demand_nm: of(self.demand_nm, other.demand_nm),
            demand_rms_nm: of(self.demand_rms_nm, other.demand_rms_nm),
            demand_slew_nm_per_s: of(self.demand_slew_nm_per_s, other.demand_slew_nm_per_s),
            dyno_speed_rad_s: of(self.dyno_speed_rad_s, other.dyno_speed_rad_s),
            engine_speed_rad_s: of(self.engine_speed_rad_s, other.engine_speed_rad_s),
            speed_gradient_rad_s2: of(self.speed_gradient_rad_s2, other.speed_gradient_rad_s2),
        }
    }
}
