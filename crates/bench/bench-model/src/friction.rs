//! Friction of the dynamometer.

use rig::dyno_friction::Unseen;
use serde::{Deserialize, Serialize};

/// Speeds within which Coulomb friction changes its sign, rad/s: without this the bench would rattle about standstill.
const STANDSTILL_RAD_S: f64 = 0.5;

/// Friction that brakes a dynamometer beside its air-gap torque, c_0 sgn ω_d + c_1 ω_d: bearings and windage, T_shaft =
/// T_d + T_fric at a constant speed. None by default.
///
/// A part may be below zero, where run-outs show the sum better than its parts. The sum never drives.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct DynoFriction {
    /// c_0, Nm.
    pub coulomb_nm: f64,
    /// c_1, Nm s/rad.
    pub viscous_nm_s_per_rad: f64,
    /// Friction beside this line at speeds that no run-out has.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub beside: Option<Beside>,
}

/// Friction beside the line, at speeds that no run-out has.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Beside {
    /// Its standard deviation over the speed.
    pub unseen: Unseen,
    /// Number of these standard deviations.
    pub deviations: f64,
}

impl DynoFriction {
    /// T_fric at a speed, Nm: positive where it brakes a bench that turns forwards.
    ///
    /// # Example
    /// ```
    /// use bench_model::friction::DynoFriction;
    /// let friction = DynoFriction { coulomb_nm: 1.2, viscous_nm_s_per_rad: 0.02, beside: None };
    /// assert_eq!(friction.torque_nm(100.0), 3.2);
    /// assert_eq!(friction.torque_nm(-100.0), -3.2);
    /// assert_eq!(friction.torque_nm(0.0), 0.0);
    /// assert_eq!(DynoFriction { coulomb_nm: -0.1, ..friction }.torque_nm(1.0), 0.0);
    /// ```
    #[must_use]
    pub fn torque_nm(&self, speed_rad_s: f64) -> f64 {
        let speed = speed_rad_s.abs();
        let beside_nm = self.beside.map_or(0.0, |beside| beside.deviations * beside.unseen.deviation_nm(speed));
        let sliding = (speed / STANDSTILL_RAD_S).min(1.0);
        let braking_nm = (self.coulomb_nm + beside_nm) * sliding + self.viscous_nm_s_per_rad * speed;
        braking_nm.max(0.0) * speed_rad_s.signum()
    }
}
