//! Why nothing can be said.

use bench_model::prediction::PredictionError;
use bench_model::simulate::SimulationError;
use cycle::CycleError;

/// Why a test cannot be judged.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum CapabilityError {
    /// The bench cannot be simulated.
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    /// The bench cannot be predicted.
    #[error(transparent)]
    Prediction(#[from] PredictionError),
    /// A requirement cannot be applied.
    #[error(transparent)]
    Cycle(#[from] CycleError),
    /// The uncertainty holds hardly any possible bench.
    #[error(
        "the parameters are so uncertain that hardly any bench drawn from them is possible; give better data to the study, or leave out --model"
    )]
    NoBench,
    /// A wish that is no sine and no gradient.
    #[error("`{text}` is no sine and no gradient; write it as `100 rpm at 2 Hz`, `20 Nm at 8 Hz` or `4000 rpm/s`")]
    Wanted {
        /// Text that was written.
        text: String,
    },
    /// A torque limit above what the drive gives in the runs that it is to judge.
    #[error(
        "the drive gives no more than {drive_nm} Nm, and some benches reach that; state a larger `torque` in [limits], and run the test again"
    )]
    BeyondDrive {
        /// The limit, Nm.
        limit_nm: f64,
        /// The torque that the drive gives, Nm.
        drive_nm: f64,
    },
    /// No samples.
    #[error("at least one bench must be drawn")]
    NoSamples,
}
