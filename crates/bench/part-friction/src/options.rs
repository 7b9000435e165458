//! Options of the friction estimate.

use numerics::null::nan_if_null;
use rig::BenchFile;
use rig::results::{Quantity, Stretch};
use serde::{Deserialize, Serialize};

/// Points of the curve.
pub(super) const POINTS: usize = 41;

/// Longest delay between the clocks, s.
pub(super) const LONGEST_DELAY_S: f64 = 0.05;

/// Rounds of shifting T_d by its delay.
pub(super) const ROUNDS: usize = 8;

/// A round that shifts by less than this has converged, s.
pub(super) const SHIFTED_S: f64 = 1e-7;

/// A term of T_fric(ω).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Term {
    /// T_0, the same whatever the direction: separated from the others where both directions are seen.
    Offset,
    /// c_0 sgn ω.
    Coulomb,
    /// c_1 ω.
    Viscous,
    /// c_2 ω|ω|, of air.
    Quadratic,
    /// c_3 ω³.
    Cubic,
}

impl Term {
    /// Those of one direction, from the lowest order on.
    pub const ALL: [Term; 4] = [Term::Coulomb, Term::Viscous, Term::Quadratic, Term::Cubic];

    pub(super) fn at(self, speed: f64) -> f64 {
        match self {
            Term::Offset => 1.0,
            Term::Coulomb => speed.signum(),
            Term::Viscous => speed,
            Term::Quadratic => speed * speed.abs(),
            Term::Cubic => speed.powi(3),
        }
    }

    /// Quantity of its coefficient as a torque.
    pub(super) fn torque(self) -> Quantity {
        match self {
            Term::Offset => Quantity::FrictionOffset,
            Term::Coulomb => Quantity::CoulombFriction,
            Term::Viscous => Quantity::ViscousFriction,
            Term::Quadratic => Quantity::QuadraticFriction,
            Term::Cubic => Quantity::CubicFriction,
        }
    }

    /// Quantity of its coefficient over J_d.
    pub(super) fn deceleration(self) -> Quantity {
        match self {
            Term::Offset => Quantity::FrictionOffsetOverInertia,
            Term::Coulomb => Quantity::CoulombFrictionOverInertia,
            Term::Viscous => Quantity::ViscousFrictionOverInertia,
            Term::Quadratic => Quantity::QuadraticFrictionOverInertia,
            Term::Cubic => Quantity::CubicFrictionOverInertia,
        }
    }
}

/// Options of the friction estimate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrictionOptions {
    /// J_d of the bench file, kg m²: what turns a deceleration into a torque where the recordings do not show J_d.
    pub inertia_kg_m2: f64,
    /// Slower than this is left out, where a bearing sticks rather than slides, rad/s; a fiftieth of the highest speed,
    /// and at least one, where `None`.
    pub slowest_rad_s: Option<f64>,
    /// Torque limit, Nm.
    pub torque_limit_nm: Option<f64>,
}

impl FrictionOptions {
    /// Options as a bench file states them.
    pub fn of(bench: &BenchFile) -> Self {
        FrictionOptions {
            inertia_kg_m2: bench.dynamometer_inertia_kg_m2,
            slowest_rad_s: None,
            torque_limit_nm: bench.limits.torque_nm,
        }
    }
}

/// Sources of T_d.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum TorqueUsed {
    /// T_d* through the torque control that the recording shows.
    Modelled,
    /// T_d,calc as it was recorded.
    Calculated,
    /// T_d,meas, for want of T_d,calc.
    LoadCell,
}

/// T_fric at a speed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CurvePoint {
    /// ω_d, rad/s.
    #[serde(deserialize_with = "nan_if_null")]
    pub speed_rad_s: f64,
    /// T_fric, Nm.
    #[serde(deserialize_with = "nan_if_null")]
    pub torque_nm: f64,
    /// Half of its 95 % interval, Nm; without the uncertainty of a stated J_d.
    #[serde(deserialize_with = "nan_if_null")]
    pub half_width_nm: f64,
}

/// A speed that was measured beside that of the model, for a figure.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RunOut {
    /// Where.
    pub stretch: Stretch,
    /// Source of T_d; none where none was recorded.
    pub torque: Option<TorqueUsed>,
    /// Samples left out: drop-outs.
    pub left_out: usize,
    /// Instants, s.
    #[serde(deserialize_with = "nan_if_null")]
    pub time_s: Vec<f64>,
    /// N_d, rad/s.
    #[serde(deserialize_with = "nan_if_null")]
    pub measured_rad_s: Vec<f64>,
    /// That of the model from the first sample on, rad/s.
    #[serde(deserialize_with = "nan_if_null")]
    pub modelled_rad_s: Vec<f64>,
}
