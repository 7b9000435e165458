//! Why a recording cannot be replayed.

use rig::estimation::EstimateError;

use crate::simulate::SimulationError;

/// Why a recording cannot be replayed on a model.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ReplayError {
    /// The recording lacks what a replay needs.
    #[error(transparent)]
    Recording(#[from] EstimateError),
    /// The model cannot be simulated on the recording.
    #[error("{file}: {source}")]
    Simulation {
        /// File.
        file: String,
        /// The reason.
        source: SimulationError,
    },
}
