//! Why a model cannot be exported.

use bench_model::simulate::SimulationError;
use ident::IdentError;

/// States that a target holds. A file of MATLAB has 8 MB of them.
pub(crate) const MOST_STATES: usize = 1000;

/// Why a model cannot be exported to a target.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ExportError {
    /// The bench model has no form that the target needs.
    #[error("the model has no linear form: {0}")]
    Simulation(#[from] SimulationError),
    /// The linear model has no state space.
    #[error("the model has no state space: {0}")]
    Model(#[from] IdentError),
    /// The target holds only bench models.
    #[error(
        "{target} holds bench models alone; export this linear model with --to fmu2, fmu3, c, mat, modelica, python or ssv"
    )]
    BenchOnly {
        /// The target.
        target: &'static str,
    },
    /// A linear model that the target cannot hold.
    #[error("{target} holds up to {MOST_STATES} states, and the model has {states}; export it with --to {others}")]
    TooLarge {
        /// The target.
        target: &'static str,
        /// States of the model.
        states: usize,
        /// Targets that can hold it.
        others: &'static str,
    },
    /// A model without what the target holds.
    #[error("{target} holds estimated parameters, and this model has none; export it with --to fmu2, c, mat or python")]
    NoEstimate {
        /// The target.
        target: &'static str,
    },
    /// The outputs have different delays.
    #[error(
        "{target} has one delay an input, and the outputs of this model differ in theirs; `dynoid model convert --to ss \
         --sample-time` makes it discrete first"
    )]
    DelaysDiffer {
        /// The target.
        target: &'static str,
    },
    /// A text that cannot be written.
    #[error("the model cannot be written as text: {reason}")]
    Text {
        /// The writer's words.
        reason: String,
    },
    /// The uncertainty allows hardly any bench.
    #[error("hardly any draw of the covariance is a bench that can be; export without draws")]
    NoDraws,
    /// A delay that the runtime of the FMUs cannot hold.
    #[error("{name} is {delay_s} s, and FMU and C hold delays from 0 to {longest_s} s; correct it in the model file")]
    Delay {
        /// Name of the delay.
        name: &'static str,
        /// Its value, s.
        delay_s: f64,
        /// The longest delay, s.
        longest_s: f64,
    },
}
