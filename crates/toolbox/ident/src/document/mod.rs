//! Models written down: one document, versioned, for every kind of model and what is known of its estimate.

mod estimate;
mod model;
mod noise;

use serde::{Deserialize, Serialize};

pub use estimate::{EstimateRecord, Source};
pub use model::AnyModel;

use crate::{Fit, IdentError, Intersample, Label, Trend};
use fitting::StructureError;

/// Text of the `format` field of a document.
const FORMAT: &str = "dynoid model";
/// The version of documents written here, and the only one read.
const VERSION: u32 = 1;

/// Header of a document: the part that stays the same in every version.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
pub struct DocumentHeader {
    /// The kind of document.
    pub format: String,
    /// The version of its layout.
    pub version: u32,
}

impl DocumentHeader {
    /// Returns true if this is the `format` of a model file.
    #[must_use]
    pub fn is_format(format: &str) -> bool {
        format == FORMAT
    }

    /// Checks that a document that begins so is understood here.
    ///
    /// # Errors
    /// [`IdentError::Document`] for another kind, [`IdentError::DocumentVersion`] for another version.
    pub fn check(&self) -> Result<(), IdentError> {
        if !Self::is_format(&self.format) {
            return Err(IdentError::Document { found: self.format.clone(), expected: FORMAT.to_owned() });
        }
        if self.version != VERSION {
            return Err(IdentError::DocumentVersion { found: self.version, known: VERSION });
        }
        Ok(())
    }
}

/// A model, its channels and its operating point, and how it was estimated. Serialised, this is the model file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ModelDocument {
    format: String,
    version: u32,
    /// Names and units of the inputs.
    pub inputs: Vec<Label>,
    /// Names and units of the outputs.
    pub outputs: Vec<Label>,
    /// The sample time of the data, or of a discrete model, in seconds.
    pub sample_time_s: f64,
    /// Behaviour of the inputs between samples.
    pub intersample: Intersample,
    /// Trend that was taken off the data: the model holds about it.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub trend: Option<Trend>,
    /// The model.
    pub model: AnyModel,
    /// How it was estimated; none for a model that was converted or written by hand.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub estimate: Option<EstimateRecord>,
}

impl ModelDocument {
    /// A model between these channels, without an estimate.
    pub fn new(model: impl Into<AnyModel>, inputs: Vec<Label>, outputs: Vec<Label>, sample_time_s: f64) -> Self {
        ModelDocument {
            format: FORMAT.to_owned(),
            version: VERSION,
            inputs,
            outputs,
            sample_time_s,
            intersample: Intersample::default(),
            trend: None,
            model: model.into(),
            estimate: None,
        }
    }

    /// Checks that this is a document of the kind and version that is understood here.
    ///
    /// # Errors
    /// As [`DocumentHeader::check`]; [`IdentError::Length`] where there is not one label a channel; those of
    /// [`Self::fit`] where there is a covariance.
    pub fn checked(self) -> Result<Self, IdentError> {
        use crate::LinearModel;
        DocumentHeader { format: self.format.clone(), version: self.version }.check()?;
        for (what, expected, found) in [
            ("`inputs`", self.model.inputs(), self.inputs.len()),
            ("`outputs`", self.model.outputs(), self.outputs.len()),
        ] {
            if expected != found {
                return Err(IdentError::Length { what, expected, found });
            }
        }
        if let Some(trend) = &self.trend {
            trend.check_channels(self.model.inputs(), self.model.outputs())?;
        }
        self.model.check_size()?;
        if !(self.sample_time_s.is_finite() && self.sample_time_s > 0.0) {
            return Err(IdentError::SampleTime { sample_time_s: self.sample_time_s });
        }
        if let Some(own_s) = self.model.own_sample_time_s() {
            crate::data::check_clock(own_s, self.sample_time_s)?;
        }
        if let Some(estimate) = self.estimate.as_ref().filter(|estimate| !estimate.covariance.is_empty()) {
            estimate.to_fit(self.model.clone())?;
        }
        Ok(self)
    }

    /// The estimate as an estimator returned it, for everything that needs its covariance.
    ///
    /// # Errors
    /// [`IdentError::NoEstimate`] where the document holds none, [`IdentError::Length`] where it is not the model's.
    pub fn fit(&self) -> Result<Fit<AnyModel>, IdentError> {
        let record = self.estimate.as_ref().ok_or(IdentError::NoEstimate)?;
        record.to_fit(self.model.clone())
    }
}

/// Most states that a polynomial model in a document may have.
const MOST_STATES: usize = 5000;

impl AnyModel {
    /// The sample time of a discrete model.
    fn own_sample_time_s(&self) -> Option<f64> {
        match self {
            AnyModel::Polynomial(model) => Some(model.sample_time_s()),
            AnyModel::StateSpace(model) => model.system().sample_time_s(),
            _ => None,
        }
    }

    /// Refuses orders and delays that no memory could hold as states.
    fn check_size(&self) -> Result<(), IdentError> {
        let AnyModel::Polynomial(model) = self else { return Ok(()) };
        let coefficients = model.coefficients().len();
        let delays = model.equations().iter().flat_map(|e| &e.nk).fold(0_usize, |sum, nk| sum.saturating_add(*nk));
        let found = coefficients.saturating_add(delays);
        if found > MOST_STATES {
            let what = "samples that the orders and delays of the model add up to";
            return Err(StructureError::TooMany { what, found, most: MOST_STATES }.into());
        }
        Ok(())
    }
}
