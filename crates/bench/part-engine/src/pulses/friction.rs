//! The friction of the dynamometer's bearings, which the mean torque of the engine overcomes.

use rig::BenchFile;
use rig::dyno_friction::{DOUBT_PERCENT, MOST_COULOMB, MOST_SLOPE_S_PER_RAD};

/// A number with its standard deviation.
#[derive(Debug, Clone, Copy)]
struct Uncertain {
    mean: f64,
    deviation: f64,
}

impl Uncertain {
    /// Anywhere between none and this.
    fn at_most(most: f64) -> Self {
        Uncertain { mean: 0.5 * most, deviation: most / 12.0_f64.sqrt() }
    }
}

/// Friction as stated, or as the class has it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Friction {
    coulomb_nm: Uncertain,
    slope_nm_s_per_rad: Uncertain,
}

impl Friction {
    /// Of a bench; where it states no torque limit, of one with this.
    pub(super) fn of(bench: &BenchFile, torque_limit_nm: impl Fn() -> f64) -> Self {
        let percent = bench.dynamometer_friction_uncertainty_percent.unwrap_or(DOUBT_PERCENT);
        let about = |mean: f64| Uncertain { mean, deviation: mean * percent / 100.0 };
        let limit_nm = bench.limits.torque_nm.unwrap_or_else(torque_limit_nm);
        let (coulomb, slope) = (bench.dynamometer_coulomb_friction_nm, bench.dynamometer_friction_nm_s_per_rad);
        Friction {
            coulomb_nm: coulomb.map_or_else(|| Uncertain::at_most(MOST_COULOMB * limit_nm), about),
            slope_nm_s_per_rad: slope.map_or_else(|| Uncertain::at_most(MOST_SLOPE_S_PER_RAD * limit_nm), about),
        }
    }

    /// The mean at a speed, Nm.
    pub(super) fn mean_nm(&self, speed_rad_s: f64) -> f64 {
        self.coulomb_nm.mean + self.slope_nm_s_per_rad.mean * speed_rad_s
    }

    /// Its standard deviation, Nm.
    pub(super) fn deviation_nm(&self, speed_rad_s: f64) -> f64 {
        self.coulomb_nm.deviation.hypot(self.slope_nm_s_per_rad.deviation * speed_rad_s)
    }
}
