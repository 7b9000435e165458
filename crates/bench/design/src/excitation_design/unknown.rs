//! Unknowns of the bench while an excitation is designed.

use bench_model::model::ModelParameter;
use serde::{Deserialize, Serialize};

/// A number the experiment has to determine, or to be right in spite of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Unknown {
    /// A parameter of the model.
    Model(ModelParameter),
    /// δ_e, skew of N_e against N_d, s: N_e enters as e^{−sδ_e} ω_e.
    EngineSpeedSkew,
    /// T_g, gate of both encoders, s.
    EncoderGate,
}
