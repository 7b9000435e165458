//! A model with its uncertainty.

use serde::{Deserialize, Serialize};

use super::{BenchModel, ModelUncertainty};

/// A model with its uncertainty, as a study keeps it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct AssembledModel {
    /// The model.
    pub model: BenchModel,
    /// Of its parameters.
    pub uncertainty: ModelUncertainty,
}
