//! The friction of the dynamometer's bearings, which the mean torque of the engine overcomes.

use rig::BenchFile;
use rig::dyno_friction::{DOUBT_PERCENT, EstimatedFriction, MOST_COULOMB, MOST_SLOPE_S_PER_RAD, deviation_nm};

/// Coulomb friction, Nm, and its slope over speed, Nm s/rad, with their covariance: as stated, as run-outs show it, or as the class has it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Friction {
    parts: [f64; 2],
    covariance: [[f64; 2]; 2],
}

impl Friction {
    /// Of a bench; where it states no torque limit, of one with this.
    pub(super) fn of(
        bench: &BenchFile,
        estimated: Option<&EstimatedFriction>,
        torque_limit_nm: impl Fn() -> f64,
    ) -> Self {
        let percent = bench.dynamometer_friction_uncertainty_percent;
        if let Some(estimated) = EstimatedFriction::unless_stated(estimated, bench) {
            let covariance = estimated.covariance_on_another_day(percent);
            return Friction { parts: [estimated.coulomb_nm, estimated.viscous_nm_s_per_rad], covariance };
        }
        let about = |mean: f64| (mean, mean * percent.unwrap_or(DOUBT_PERCENT) / 100.0);
        // Anywhere between none and the most.
        let class = |most: f64| (0.5 * most, most / 12.0_f64.sqrt());
        let limit_nm = bench.limits.torque_nm.unwrap_or_else(torque_limit_nm);
        let (coulomb, slope) = (bench.dynamometer_coulomb_friction_nm, bench.dynamometer_friction_nm_s_per_rad);
        let coulomb = coulomb.map_or_else(|| class(MOST_COULOMB * limit_nm), about);
        let slope = slope.map_or_else(|| class(MOST_SLOPE_S_PER_RAD * limit_nm), about);
        Friction { parts: [coulomb.0, slope.0], covariance: [[coulomb.1.powi(2), 0.0], [0.0, slope.1.powi(2)]] }
    }

    /// The mean at a speed, Nm.
    pub(super) fn mean_nm(&self, speed_rad_s: f64) -> f64 {
        self.parts[0] + self.parts[1] * speed_rad_s
    }

    /// Its standard deviation, Nm.
    pub(super) fn deviation_nm(&self, speed_rad_s: f64) -> f64 {
        deviation_nm(&self.covariance, speed_rad_s)
    }
}
