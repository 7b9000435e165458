//! Why no excitation can be designed.

use bench_model::simulate::SimulationError;
use signal::SignalError;

use crate::excitation_design::unknown::Unknown;

/// Why there is no design.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum DesignError {
    /// The task contradicts itself.
    #[error("{requirement}")]
    Task {
        /// The need, in words.
        requirement: &'static str,
    },
    /// The model lacks a part.
    #[error("the model has no {part}")]
    MissingPart {
        /// Which.
        part: &'static str,
    },
    /// No excitation within the band separates one of the parameters from the others.
    #[error("the measured signals cannot separate {unknown} from the other unknowns")]
    NotDetermined {
        /// The parameter that is least known.
        unknown: Unknown,
    },
    /// The model cannot be simulated.
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    /// A transform failed.
    #[error(transparent)]
    Signal(#[from] SignalError),
}
