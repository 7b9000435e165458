//! Friction of the dynamometer.

use serde::{Deserialize, Serialize};

/// Speeds within which Coulomb friction changes its sign, rad/s: without this the bench would rattle about standstill.
const STANDSTILL_RAD_S: f64 = 0.5;

/// Friction that brakes a dynamometer beside its air-gap torque, c_0 sgn ω_d + c_1 ω_d: bearings and windage, T_shaft =
/// T_d + T_fric at a constant speed. None by default.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct DynoFriction {
    /// c_0, Nm.
    pub coulomb_nm: f64,
    /// c_1, Nm s/rad.
    pub viscous_nm_s_per_rad: f64,
}

impl DynoFriction {
    /// T_fric at a speed, Nm: positive where it brakes a bench that turns forwards.
    ///
    /// # Example
    /// ```
    /// use bench_model::friction::DynoFriction;
    /// let friction = DynoFriction { coulomb_nm: 1.2, viscous_nm_s_per_rad: 0.02 };
    /// assert_eq!(friction.torque_nm(100.0), 3.2);
    /// assert_eq!(friction.torque_nm(-100.0), -3.2);
    /// assert_eq!(friction.torque_nm(0.0), 0.0);
    /// ```
    #[must_use]
    pub fn torque_nm(&self, speed_rad_s: f64) -> f64 {
        let direction = (speed_rad_s / STANDSTILL_RAD_S).clamp(-1.0, 1.0);
        self.coulomb_nm * direction + self.viscous_nm_s_per_rad * speed_rad_s
    }
}
