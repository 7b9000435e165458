//! Why a text is no bench model.

use rig::engine_pulses::ImpossiblePulses;

use super::json::JsonFault;
use crate::model::{Bound, ModelParameter, short};

/// Why a text is no bench model that can be used.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum DocumentError {
    /// No JSON, or not with the fields of a bench model.
    #[error("{fault}; copy the file again, correct it, or let `dynoid study bench.toml` write it again")]
    Content {
        /// Where, and what is wrong.
        fault: JsonFault,
    },
    /// The document cannot be written.
    #[error("the bench model cannot be written as JSON: {reason}")]
    Unwritable {
        /// The writer's words.
        reason: String,
    },
    /// A document of another kind.
    #[error(
        "this is no bench model, its `format` is “{found}”; `dynoid study bench.toml` writes one to study/model.json"
    )]
    Format {
        /// The document's own `format`.
        found: String,
    },
    /// A version that is not known here.
    #[error(
        "this bench model has version {found}, and this dynoid reads versions 1 to {known}; {}",
        if found > known { "use a later dynoid" } else { "write it again with `dynoid study bench.toml`" }
    )]
    Version {
        /// The version found.
        found: u64,
        /// The latest version that is read.
        known: u64,
    },
    /// `parameters` and `model` have different values.
    #[error(
        "`parameters` has {listed} for {}, and `model.{}` is {}; make the two the same",
        .parameter.quantity().name(), .parameter.field(),
        .modelled.map_or_else(|| "null".to_owned(), |value| value.to_string())
    )]
    Contradiction {
        /// Which number.
        parameter: ModelParameter,
        /// Under `parameters`.
        listed: f64,
        /// Under `model`.
        modelled: Option<f64>,
    },
    /// A number that no bench can have.
    #[error(
        "`{field}` is {}, and a bench has {bound}; correct it, or let `dynoid study bench.toml` write the file again", short(*.value)
    )]
    Impossible {
        /// Where it is.
        field: String,
        /// Its value.
        value: f64,
        /// Bound that the value must keep.
        bound: Bound,
    },
    /// Numbers that no bench has together.
    #[error("{problem}; correct it, or let `dynoid study bench.toml` write the file again")]
    Together {
        /// Which numbers, and what is wrong with them.
        problem: String,
    },
    /// Pulses that no engine can have.
    #[error(
        "`{}` is {}, and must be {}; correct it, or let `dynoid study bench.toml` write the file again",
        .impossible.field, .impossible.value, .impossible.limit
    )]
    Pulses {
        /// Which number.
        impossible: ImpossiblePulses,
    },
    /// The covariance holds a number that the model lacks, or holds it twice.
    #[error(
        "`uncertainty` has the {} {}; let `dynoid study bench.toml` write the file again",
        .parameter.quantity().name(), if *.is_twice { "twice" } else { "that `model` lacks" }
    )]
    Uncertainty {
        /// Which number.
        parameter: ModelParameter,
        /// True where it is there twice; otherwise the model lacks it.
        is_twice: bool,
    },
}
