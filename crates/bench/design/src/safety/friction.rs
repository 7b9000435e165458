//! Friction of dynamometers that could be the one at hand.

use bench_model::friction::DynoFriction;
use numerics::random::Stream;
use rig::BenchFile;
use rig::dyno_friction::{DOUBT_PERCENT, MOST_COULOMB, MOST_SLOPE_S_PER_RAD};
use serde::Serialize;

/// Whence friction is known.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum FrictionFrom {
    /// The bench file.
    Stated,
    /// Dynamometers in general, for all or a part of it.
    Assumed,
}

/// How friction differs between the benches drawn.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct FrictionSpread {
    /// Whence it is known.
    pub from: FrictionFrom,
    /// Coulomb friction at the least and at the most, Nm.
    pub coulomb_nm: (f64, f64),
    /// Slope over speed at the least and at the most, Nm s/rad.
    pub viscous_nm_s_per_rad: (f64, f64),
}

impl FrictionSpread {
    /// No friction.
    pub const NONE: FrictionSpread =
        FrictionSpread { from: FrictionFrom::Stated, coulomb_nm: (0.0, 0.0), viscous_nm_s_per_rad: (0.0, 0.0) };

    /// Spread that a bench file states, and where it does not, the one that a dynamometer with this torque limit can
    /// have.
    #[must_use]
    pub fn of(bench: &BenchFile, torque_limit_nm: f64) -> Self {
        let percent = bench.dynamometer_friction_uncertainty_percent.unwrap_or(DOUBT_PERCENT);
        // As even a spread as the standard uncertainty has.
        let reach = 3.0_f64.sqrt() * percent / 100.0;
        let about = |value: f64| (value * (1.0 - reach).max(0.0), value * (1.0 + reach));
        let (slope, coulomb) = (bench.dynamometer_friction_nm_s_per_rad, bench.dynamometer_coulomb_friction_nm);
        FrictionSpread {
            from: if slope.and(coulomb).is_some() { FrictionFrom::Stated } else { FrictionFrom::Assumed },
            coulomb_nm: coulomb.map_or((0.0, MOST_COULOMB * torque_limit_nm), about),
            viscous_nm_s_per_rad: slope.map_or((0.0, MOST_SLOPE_S_PER_RAD * torque_limit_nm), about),
        }
    }

    /// The middle of what it can be.
    #[must_use]
    pub fn middle(&self) -> DynoFriction {
        let middle = |(low, high): (f64, f64)| 0.5 * (low + high);
        DynoFriction { coulomb_nm: middle(self.coulomb_nm), viscous_nm_s_per_rad: middle(self.viscous_nm_s_per_rad) }
    }

    /// The friction of a bench: no value is more probable than another one.
    #[must_use]
    pub fn draw(&self, random: &mut Stream) -> DynoFriction {
        let mut between = |(low, high): (f64, f64)| random.between(low, high);
        let coulomb_nm = between(self.coulomb_nm);
        DynoFriction { coulomb_nm, viscous_nm_s_per_rad: between(self.viscous_nm_s_per_rad) }
    }
}
