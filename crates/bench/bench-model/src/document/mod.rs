//! The bench model as a file of its own: parameters with their units and their uncertainty, where it is valid, what was
//! not estimated, and where it comes from.
//!
//! The text is JSON. `model` and `uncertainty` are what programs compute with; `parameters` has the same values for
//! people, and a document in which the two contradict each other is refused.

mod check;
mod described;
mod error;
mod json;
mod provenance;
mod read;
mod result_format;
mod validity;

use rig::dyno_friction::EstimatedFriction;
use rig::engine_pulses::EnginePulses;
use rig::facts::BenchFacts;
use serde::{Deserialize, Serialize};

use crate::disturbances::Disturbances;
use crate::drive_ripple::RecordedTorque;
use crate::model::{AssembledModel, BenchModel, ModelUncertainty};
use crate::skews::SignalSkews;
pub use described::DescribedParameter;
pub use error::DocumentError;
pub use json::{JsonFault, from_json};
pub use provenance::{BenchFileOrigin, NotEstimated, Provenance, StudyVerdict, UsedRecording};
pub use result_format::{ResultError, ResultFormat};
pub use validity::{Range, Validity};

/// Text of a document's `format` field.
const FORMAT: &str = "dynoid bench model";
/// The version of documents written here. Earlier ones are read too.
const VERSION: u64 = 1;

/// A bench model, and everything that is known about it. Serialised, this is the bench model file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct BenchModelDocument {
    format: String,
    version: u64,
    /// Facts that the bench file states: name, engine, inertias, limits.
    pub bench: BenchFacts,
    /// Every estimated number of the model, for people.
    parameters: Vec<DescribedParameter>,
    /// The model, in SI.
    pub model: BenchModel,
    /// Covariance of its parameters, part by part, in SI.
    pub uncertainty: ModelUncertainty,
    /// How the signals of the recordings lay in time against each other.
    #[serde(default)]
    pub skews: Option<SignalSkews>,
    /// How the recordings show T_d; null without a torque control.
    #[serde(default)]
    pub recorded_torque: Option<RecordedTorque>,
    /// The engine's firing pulses with their covariance; null where no recording shows them.
    #[serde(default)]
    pub engine_pulses: Option<EnginePulses>,
    /// Noise and once-a-turn error of N_d, and ripple of the drive; none where they are not known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub disturbances: Option<Disturbances>,
    /// Friction of the dynamometer with its covariance; null without run-outs.
    #[serde(default)]
    pub dyno_friction: Option<EstimatedFriction>,
    /// Parts that were not estimated, and why.
    #[serde(default)]
    pub not_estimated: Vec<NotEstimated>,
    /// The range of the recordings that the model was estimated from.
    #[serde(default)]
    pub validity: Validity,
    /// Where it comes from.
    pub provenance: Provenance,
}

/// Statements of a document on itself; the same in every version.
#[derive(Deserialize)]
struct Header {
    format: String,
    version: u64,
}

/// The `format` that a text in JSON states of itself; where it is the first field, also if the text has a fault behind
/// it.
#[must_use]
pub fn format_of(text: &str) -> Option<String> {
    #[derive(Deserialize)]
    struct Named {
        format: String,
    }
    first_format(text).map(str::to_owned).or_else(|| Some(serde_json::from_str::<Named>(text).ok()?.format))
}

fn first_format(text: &str) -> Option<&str> {
    let value = text.trim_start().strip_prefix('{')?.trim_start().strip_prefix("\"format\"")?.trim_start();
    let (format, _) = value.strip_prefix(':')?.trim_start().strip_prefix('"')?.split_once('"')?;
    Some(format)
}

impl BenchModelDocument {
    /// Tells whether this is the `format` of a bench model.
    #[must_use]
    pub fn is_format(format: &str) -> bool {
        format == FORMAT
    }

    /// A document of a model. Validity, skews and what was not estimated are empty.
    #[must_use]
    pub fn new(assembled: AssembledModel, bench: BenchFacts, provenance: Provenance) -> Self {
        let AssembledModel { model, uncertainty, engine_pulses, disturbances, dyno_friction } = assembled;
        BenchModelDocument {
            format: FORMAT.to_owned(),
            version: VERSION,
            bench,
            parameters: described::all(&model, &uncertainty),
            model,
            uncertainty,
            engine_pulses,
            disturbances,
            dyno_friction,
            skews: None,
            recorded_torque: None,
            not_estimated: Vec::new(),
            validity: Validity::default(),
            provenance,
        }
    }

    /// The document with the 95 % intervals of a study, SI.
    #[must_use]
    pub fn with_intervals(mut self, interval: impl Fn(&DescribedParameter) -> Option<(f64, f64)>) -> Self {
        for parameter in &mut self.parameters {
            let found = interval(parameter);
            parameter.interval_95 = found.filter(|(low, high)| low.is_finite() && high.is_finite());
        }
        self
    }

    /// The document as text, which [`Self::from_json`] reads back bit for bit.
    ///
    /// # Errors
    /// [`DocumentError::Unwritable`] where a number or text cannot be written as JSON.
    pub fn to_json(&self) -> Result<String, DocumentError> {
        serde_json::to_string_pretty(self).map_err(|error| DocumentError::Unwritable { reason: error.to_string() })
    }

    /// Every estimated number of the model with symbol, unit and standard error.
    #[must_use]
    pub fn parameters(&self) -> &[DescribedParameter] {
        &self.parameters
    }

    /// The model with its uncertainty.
    #[must_use]
    pub fn assembled(&self) -> AssembledModel {
        AssembledModel {
            model: self.model.clone(),
            uncertainty: self.uncertainty.clone(),
            engine_pulses: self.engine_pulses.clone(),
            disturbances: self.disturbances,
            dyno_friction: self.dyno_friction.clone(),
        }
    }
}
