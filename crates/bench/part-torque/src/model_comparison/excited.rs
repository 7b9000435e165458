//! Recordings in which the demand moves the torque.

use serde::{Deserialize, Serialize};

/// Mover of T_d*.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Excited {
    /// The dynamometer's own demand.
    Dynamometer,
    /// The engine, which the speed controller answers.
    Engine,
}
