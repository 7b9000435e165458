//! Why an effect cannot be shown.

use study::StudyError;
use virtual_bench::VirtualBenchError;

/// Why an effect cannot be shown.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum EffectsError {
    /// The virtual bench cannot run.
    #[error(transparent)]
    VirtualBench(#[from] VirtualBenchError),
    /// A filter for the recordings cannot be made.
    #[error("virtual bench: {0}")]
    Filter(#[from] signal::SignalError),
    /// A study of simulated recordings has no result.
    #[error("virtual bench: the study of what was simulated failed: {0}")]
    Study(#[from] StudyError),
    /// The study of simulated recordings has no shaft.
    #[error("virtual bench: the study of what was simulated failed: the shaft was not estimated")]
    NoShaft,
}
