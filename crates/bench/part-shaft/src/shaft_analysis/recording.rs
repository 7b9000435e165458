//! Findings of one recording on the shaft.

use numerics::null::nan_if_null;
use rig::ExperimentLabel;
use rig::results::{Estimate, Outcome, Shaft, read_found, read_if_sought, write_found, write_if_sought};
use serde::{Deserialize, Serialize};

use crate::shaft::Beyond;
use crate::shaft_routes::black_box::BlackBoxRoute;
use crate::shaft_routes::multisine::MultisineRoute;
use crate::shaft_routes::state_space::StateSpaceRoute;

/// Findings of one recording.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ShaftRecording {
    /// The file.
    pub file: String,
    /// The experiment's label.
    pub label: ExperimentLabel,
    /// The shaft by Δω → T_shaft with gate and skew, from 70 % of the recording, the rest judging it.
    #[serde(serialize_with = "write_found", deserialize_with = "read_found")]
    pub shaft: Outcome<Shaft>,
    /// By which part of itself the J_d of the bench file differs from the one found, where that is no accident.
    pub inertia_contradiction: Option<f64>,
    /// The same by band; a band that shows nothing is left out.
    pub bands: Vec<Band>,
    /// Terms that may be in the shaft beyond K and B.
    #[serde(serialize_with = "write_found", deserialize_with = "read_found")]
    pub beyond: Outcome<Beyond>,
    /// The shaft with a dual-mass flywheel, where the simple one does not do or the bench has a torque flange, which
    /// goes with such a flywheel.
    #[serde(serialize_with = "write_if_sought", deserialize_with = "read_if_sought")]
    pub dual_mass: Option<Outcome<DualMass>>,
    /// K and B by other routes, each of which errs in its own way.
    pub routes: Routes,
    /// Both inertias with K and B as if nothing were known of them; `None` where the experiment cannot show them.
    #[serde(serialize_with = "write_if_sought", deserialize_with = "read_if_sought")]
    pub inertias: Option<Outcome<Estimate>>,
}

/// Two springs with a mass between them, thesis §3.3.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct DualMass {
    /// K and B of the shaft, J_2, K_2 and B_2 of the flywheel, timing.
    pub estimate: Estimate,
    /// Mean of |error|²/σ²: one where the model and the noise levels are right.
    #[serde(deserialize_with = "nan_if_null")]
    pub misfit: f64,
}

/// Routes to the shaft beside Δω → T_shaft; `None` where the experiment does not allow one. Behind a torque flange all
/// are.
#[derive(Debug, Clone, PartialEq, Serialize, Default, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Routes {
    /// (T_d, ω_e) → ω_d in the time domain, thesis (6.11).
    #[serde(serialize_with = "write_if_sought", deserialize_with = "read_if_sought")]
    pub state_space: Option<Outcome<StateSpaceRoute>>,
    /// T_d → ω_d alone, with the engine motored (Unfired_N_NT): a fired one hides K and B behind its torque.
    #[serde(serialize_with = "write_if_sought", deserialize_with = "read_if_sought")]
    pub black_box: Option<Outcome<BlackBoxRoute>>,
    /// Means over the periods of a demand that repeats (Multisine_T_TN).
    #[serde(serialize_with = "write_if_sought", deserialize_with = "read_if_sought")]
    pub multisine: Option<Outcome<MultisineRoute>>,
    /// How far apart T_d is known, s. What folds where it is known by its own samples alone is in no interval.
    pub torque_sample_time_s: Option<f64>,
}

/// The shaft from a band of frequencies.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Band {
    /// From and to, Hz.
    #[serde(deserialize_with = "nan_if_null")]
    pub band_hz: (f64, f64),
    /// K and B, with timing and friction as the whole band shows them.
    pub estimate: Estimate,
    /// K and B as if time stamps were exact and speeds momentary.
    pub ignoring_timing: Estimate,
}
