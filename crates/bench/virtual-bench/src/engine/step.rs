//! The engine's torque over a step.

use crate::train::Jump;

/// Combustion in a cylinder: fuel burns or not.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Combustion {
    Fired,
    Motored,
    /// The shaft is off: the engine does not turn.
    Stopped,
}

/// The engine's torque over a step. `end_nm` is that of the cylinder firing at its start, continued to its end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct EngineStep {
    pub(crate) start_nm: f64,
    pub(crate) end_nm: f64,
    pub(crate) firing: Option<Jump>,
}
