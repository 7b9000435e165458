//! Friction of dynamometers that could be the one at hand.

use bench_model::friction::DynoFriction;
use numerics::random::Stream;
use rig::BenchFile;
use rig::dyno_friction::{DOUBT_PERCENT, EstimatedFriction, MOST_COULOMB, MOST_SLOPE_S_PER_RAD};
use serde::Serialize;
use signal::distributions::normal_quantile;

/// Whence friction is known.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum FrictionFrom {
    /// The bench file.
    Stated,
    /// Run-outs.
    Estimated,
    /// Dynamometers in general, for all or a part of it.
    Assumed,
}

/// How friction differs between the benches drawn.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct FrictionSpread {
    /// Whence it is known.
    pub from: FrictionFrom,
    /// Coulomb friction at the least and at the most, Nm; of estimates the 95 % range.
    pub coulomb_nm: (f64, f64),
    /// Slope over speed at the least and at the most, Nm s/rad; of estimates the 95 % range.
    pub viscous_nm_s_per_rad: (f64, f64),
    /// Covariance of both where they are estimated.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub covariance: Option<[[f64; 2]; 2]>,
}

impl FrictionSpread {
    /// No friction.
    pub const NONE: FrictionSpread = FrictionSpread {
        from: FrictionFrom::Stated,
        coulomb_nm: (0.0, 0.0),
        viscous_nm_s_per_rad: (0.0, 0.0),
        covariance: None,
    };

    /// What a bench file states; else what run-outs show, on another day; else what a dynamometer with this torque limit can have.
    #[must_use]
    pub fn of(bench: &BenchFile, torque_limit_nm: f64, estimated: Option<&EstimatedFriction>) -> Self {
        if let Some(estimated) = EstimatedFriction::unless_stated(estimated, bench) {
            return Self::estimated(estimated, bench.dynamometer_friction_uncertainty_percent);
        }
        let percent = bench.dynamometer_friction_uncertainty_percent.unwrap_or(DOUBT_PERCENT);
        // As even a spread as the standard uncertainty has.
        let reach = 3.0_f64.sqrt() * percent / 100.0;
        let about = |value: f64| (value * (1.0 - reach).max(0.0), value * (1.0 + reach));
        let (slope, coulomb) = (bench.dynamometer_friction_nm_s_per_rad, bench.dynamometer_coulomb_friction_nm);
        FrictionSpread {
            from: if slope.and(coulomb).is_some() { FrictionFrom::Stated } else { FrictionFrom::Assumed },
            coulomb_nm: coulomb.map_or((0.0, MOST_COULOMB * torque_limit_nm), about),
            viscous_nm_s_per_rad: slope.map_or((0.0, MOST_SLOPE_S_PER_RAD * torque_limit_nm), about),
            covariance: None,
        }
    }

    fn estimated(friction: &EstimatedFriction, uncertainty_percent: Option<f64>) -> Self {
        let covariance = friction.covariance_on_another_day(uncertainty_percent);
        let about = |value: f64, variance: f64| {
            let reach = normal_quantile(0.975) * variance.sqrt();
            (value - reach, value + reach)
        };
        FrictionSpread {
            from: FrictionFrom::Estimated,
            coulomb_nm: about(friction.coulomb_nm, covariance[0][0]),
            viscous_nm_s_per_rad: about(friction.viscous_nm_s_per_rad, covariance[1][1]),
            covariance: Some(covariance),
        }
    }

    /// The middle of what it can be.
    #[must_use]
    pub fn middle(&self) -> DynoFriction {
        let middle = |(low, high): (f64, f64)| 0.5 * (low + high);
        DynoFriction { coulomb_nm: middle(self.coulomb_nm), viscous_nm_s_per_rad: middle(self.viscous_nm_s_per_rad) }
    }

    /// The friction of a bench: by the covariance of an estimate, or else no value is more probable than another one. No part of it drives.
    #[must_use]
    pub fn draw(&self, random: &mut Stream) -> DynoFriction {
        if let Some([[coulomb, both], [_, viscous]]) = self.covariance {
            let middle = self.middle();
            let root = coulomb.sqrt();
            let shared = if root > 0.0 { both / root } else { 0.0 };
            let (of_coulomb, of_slope) = (random.normal(), random.normal());
            let slope = shared * of_coulomb + (viscous - shared * shared).max(0.0).sqrt() * of_slope;
            return DynoFriction {
                coulomb_nm: (middle.coulomb_nm + root * of_coulomb).max(0.0),
                viscous_nm_s_per_rad: (middle.viscous_nm_s_per_rad + slope).max(0.0),
            };
        }
        let mut between = |(low, high): (f64, f64)| random.between(low, high);
        let coulomb_nm = between(self.coulomb_nm);
        DynoFriction { coulomb_nm, viscous_nm_s_per_rad: between(self.viscous_nm_s_per_rad) }
    }
}
