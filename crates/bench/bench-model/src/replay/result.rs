//! A recording replayed on the assembled model, as data.

use rig::results::{Stretch, Validation};
use rig::{ControlMode, ExperimentLabel};
use serde::{Deserialize, Serialize};

/// A recording replayed on the assembled model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Replay {
    /// The recording's file and label.
    pub stretch: Stretch,
    /// Label.
    pub label: ExperimentLabel,
    /// Control mode.
    pub mode: ControlMode,
    /// True where any part of the model was estimated from this recording.
    pub seen_in_estimation: bool,
    /// N_d, N_e, T_d, T_shaft: measured against modelled.
    pub signals: Vec<Validation>,
}
