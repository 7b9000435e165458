//! Why a virtual bench cannot run.

use rig::bench_parameters::ParameterError;
use rig::experiment::PlanError;

/// Why a virtual bench cannot run.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum VirtualBenchError {
    /// A parameter has a value that no bench can have.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
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
    /// The state left the finite numbers: parameters and step size do not fit each other.
    #[error("virtual bench: the simulation diverged at {time_s} s; a gain is too high or the step too long")]
    Diverged {
        /// When, s after the recording's start (negative while settling).
        time_s: f64,
    },
}
