//! Why a virtual bench cannot run.

use crate::experiment::PlanError;

/// Why a virtual bench cannot run.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum VirtualBenchError {
    /// A parameter has a value that no bench can have.
    #[error("virtual bench: {name} = {value} is impossible; it must be {requirement}")]
    Parameter {
        /// The field, as a path in [`BenchParameters`](super::BenchParameters).
        name: &'static str,
        /// Its value.
        value: f64,
        /// What it must be.
        requirement: &'static str,
    },
    /// The plan asks for something impossible.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// The table `[virtual_bench]` does not fit the rest of the bench.
    #[error("virtual bench: [virtual_bench] does not fit: {reason}")]
    Unfit {
        /// Why not.
        reason: String,
    },
    /// The equations cannot be discretised.
    #[error("virtual bench: {0}")]
    Discretisation(#[from] lti::LtiError),
    /// A filter for the recordings cannot be made.
    #[error("virtual bench: {0}")]
    Filter(#[from] signal::SignalError),
    /// A study of simulated recordings has no result.
    #[error("virtual bench: the study of what was simulated failed: {reason}")]
    Study {
        /// Why.
        reason: String,
    },
    /// The state left the finite numbers: parameters and step size do not fit each other.
    #[error("virtual bench: the simulation diverged at {time_s} s; a gain is too high or the step too long")]
    Diverged {
        /// When, s after the recording's start (negative while settling).
        time_s: f64,
    },
}

/// Fails unless `value` is finite and `holds`.
pub(super) fn require(
    name: &'static str,
    value: f64,
    holds: bool,
    requirement: &'static str,
) -> Result<(), VirtualBenchError> {
    if value.is_finite() && holds { Ok(()) } else { Err(VirtualBenchError::Parameter { name, value, requirement }) }
}

/// Fails unless `value` is finite and above zero.
pub(super) fn require_positive(name: &'static str, value: f64) -> Result<(), VirtualBenchError> {
    require(name, value, value > 0.0, "finite and above zero")
}

/// Fails unless `value` is finite and not negative.
pub(super) fn require_not_negative(name: &'static str, value: f64) -> Result<(), VirtualBenchError> {
    require(name, value, value >= 0.0, "finite and not negative")
}
