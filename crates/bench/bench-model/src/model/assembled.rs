//! A model with its uncertainty.

use rig::dyno_friction::EstimatedFriction;
use rig::engine_pulses::EnginePulses;
use serde::{Deserialize, Serialize};

use super::{BenchModel, ModelUncertainty};
use crate::disturbances::Disturbances;

/// A model with its uncertainty, as a study keeps it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct AssembledModel {
    /// The model.
    pub model: BenchModel,
    /// Of its parameters.
    pub uncertainty: ModelUncertainty,
    /// The engine's firing pulses with their covariance; none where no recording shows them.
    #[serde(default)]
    pub engine_pulses: Option<EnginePulses>,
    /// Disturbances of the bench in its recordings; none where that is not known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub disturbances: Option<Disturbances>,
    /// Friction of the dynamometer with its covariance; none without run-outs. It is no part of the model's equations.
    #[serde(default)]
    pub dyno_friction: Option<EstimatedFriction>,
}
