//! How the signals of a recording lie in time against each other.

use serde::{Deserialize, Serialize};

/// How much later other signals show an event than N_d does (N_d itself is late by half its gate), s.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SignalSkews {
    /// N_e.
    pub engine_speed_s: f64,
    /// T_d.
    pub torque_s: f64,
}
