//! Why a recording cannot be replayed.

use rig::NotReplayed;
use rig::estimation::EstimateError;
use rig::results::Reason;

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

impl From<ReplayError> for NotReplayed {
    fn from(error: ReplayError) -> Self {
        match error {
            ReplayError::Recording(error) => NotReplayed::Lacks(Reason::from(error)),
            ReplayError::Simulation { source: SimulationError::MissingPart { part }, .. } => {
                NotReplayed::Lacks(Reason::Part { part })
            }
            ReplayError::Simulation { source: SimulationError::Clock { inputs_s, controller_s }, .. } => {
                NotReplayed::Clock { demand_s: inputs_s, controller_s }
            }
            ReplayError::Simulation { .. } => NotReplayed::NotSimulated,
        }
    }
}
