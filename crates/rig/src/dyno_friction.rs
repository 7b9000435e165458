//! The friction that a dynamometer has beside its air-gap torque: as its class has it, and as run-outs show it.

use serde::{Deserialize, Serialize};
use signal::distributions::normal_quantile;

use crate::bench_file::BenchFile;

/// Coulomb friction over the torque limit at the most. Bearings, seals and the fan of asynchronous machines have 0.2 … 2 % of the torque limit
/// at 300 rad/s; this and [`MOST_SLOPE_S_PER_RAD`] make 2 % there.
pub const MOST_COULOMB: f64 = 4e-3;
/// Slope of friction over speed, over the torque limit, at the most, s/rad.
pub const MOST_SLOPE_S_PER_RAD: f64 = 5e-5;
/// Standard uncertainty of friction on another day than that of its run-out unless that is stated, % of it: it changes with the temperature
/// of the oil.
pub const DOUBT_PERCENT: f64 = 20.0;

/// Friction that run-outs show, T_fric = c_0 sgn ω + c_1 ω.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EstimatedFriction {
    /// c_0, Nm.
    pub coulomb_nm: f64,
    /// c_1, Nm s/rad.
    pub viscous_nm_s_per_rad: f64,
    /// Covariance of both on the day of the run-outs, in Nm and Nm s/rad.
    pub covariance: [[f64; 2]; 2],
    /// Lowest and highest speed of the run-outs, whatever the direction, rad/s.
    pub speeds_rad_s: (f64, f64),
    /// The recordings that show it.
    pub recordings: Vec<String>,
}

impl EstimatedFriction {
    /// What counts beside a bench file: nothing where that states both parts.
    #[must_use]
    pub fn unless_stated<'a>(estimated: Option<&'a Self>, bench: &BenchFile) -> Option<&'a Self> {
        let stated = bench.dynamometer_friction_nm_s_per_rad.and(bench.dynamometer_coulomb_friction_nm);
        estimated.filter(|_| stated.is_none())
    }

    /// T_fric at a speed above zero, Nm.
    #[must_use]
    pub fn torque_nm(&self, speed_rad_s: f64) -> f64 {
        self.coulomb_nm + self.viscous_nm_s_per_rad * speed_rad_s
    }

    /// Half of the 95 % interval of [`Self::torque_nm`] on the day of the run-outs, Nm.
    #[must_use]
    pub fn half_width_nm(&self, speed_rad_s: f64) -> f64 {
        normal_quantile(0.975) * deviation_nm(&self.covariance, speed_rad_s)
    }

    /// The covariance on another day, when both parts differ by the same share of themselves, whose standard deviation is the one that
    /// the bench file states, or [`DOUBT_PERCENT`].
    ///
    /// # Example
    /// ```
    /// # use rig::dyno_friction::EstimatedFriction;
    /// let friction = EstimatedFriction {
    ///     coulomb_nm: 2.0, viscous_nm_s_per_rad: 0.01, covariance: [[0.09, 0.0], [0.0, 0.0]],
    ///     speeds_rad_s: (10.0, 300.0), recordings: Vec::new(),
    /// };
    /// assert!((friction.covariance_on_another_day(Some(20.0))[0][0] - 0.25).abs() < 1e-12);
    /// ```
    #[must_use]
    pub fn covariance_on_another_day(&self, uncertainty_percent: Option<f64>) -> [[f64; 2]; 2] {
        let share = uncertainty_percent.unwrap_or(DOUBT_PERCENT) / 100.0;
        let parts = [self.coulomb_nm, self.viscous_nm_s_per_rad].map(|part| share * part);
        std::array::from_fn(|i| std::array::from_fn(|j| self.covariance[i][j] + parts[i] * parts[j]))
    }
}

/// Standard deviation of c_0 sgn ω + c_1 ω at a speed, Nm.
#[must_use]
pub fn deviation_nm(covariance: &[[f64; 2]; 2], speed_rad_s: f64) -> f64 {
    let [[coulomb, both], [_, slope]] = *covariance;
    (coulomb + speed_rad_s * (2.0 * both + speed_rad_s * slope)).max(0.0).sqrt()
}
