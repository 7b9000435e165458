//! The parts of a bench that a study estimates.

use serde::{Deserialize, Serialize};

/// A part of the bench.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Part {
    /// Delays of the torque signals.
    Timing,
    /// PI and delay.
    SpeedController,
    /// Feed-forward of the speed controller.
    FeedForward,
    /// From T_d* to T_d.
    TorqueControl,
    /// Stiffness and damping.
    Shaft,
    /// All of them connected.
    Whole,
}
