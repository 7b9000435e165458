//! Recordings in which the demand moves the torque.

use serde::Serialize;

/// Mover of T_d*.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Excited {
    /// The dynamometer's own demand.
    Dynamometer,
    /// The engine, which the speed controller answers.
    Engine,
}
