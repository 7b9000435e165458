//! Peaks of the limited quantities.

use serde::{Deserialize, Serialize};

/// Quantities that may be limited.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum LimitedQuantity {
    /// T_shaft.
    ShaftTorque,
    /// T_d.
    AirGapTorque,
    /// ω_d.
    Speed,
    /// The demand itself.
    Demand,
}

/// Largest deviations from the operating point.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Peaks {
    /// Of T_shaft, Nm.
    pub shaft_torque_nm: f64,
    /// Of T_d, Nm; in speed control the larger of T_d and T_d*.
    pub air_gap_torque_nm: f64,
    /// Of ω_d, rad/s.
    pub speed_rad_s: f64,
    /// Of the demand, Nm or rad/s.
    pub demand: f64,
}
