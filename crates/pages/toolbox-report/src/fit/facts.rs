//! An estimate in numbers.

use ident::validate::Judgement;
use ident::{Criteria, IdentError, ModelDocument};
use numerics::null::nan_if_null;
use serde::{Deserialize, Serialize};

use super::judged::Judged;
use super::repeated::{Repeated, RepeatedFacts};
use crate::residuals::TestFacts;

/// Numbers of [`super::Estimated`]. What is not known is NaN, and null in JSON.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct EstimateFacts {
    /// The model as a file holds it.
    pub model: ModelDocument,
    /// Steps from the recordings to the data, in words.
    pub adjustments: Vec<String>,
    /// Standard error of each parameter.
    #[serde(deserialize_with = "nan_if_null")]
    pub standard_errors: Vec<f64>,
    /// 95 % interval of each parameter.
    #[serde(deserialize_with = "nan_if_null")]
    pub intervals_95: Vec<[f64; 2]>,
    /// Levels of the outputs that were estimated with the model, one list an experiment.
    #[serde(deserialize_with = "nan_if_null")]
    pub levels: Vec<Vec<f64>>,
    /// Quantities that follow from the parameters; none where they cannot be computed.
    pub derived: Option<Vec<DerivedFacts>>,
    /// Information criteria.
    pub criteria: Criteria,
    /// Judgement on the data of the estimate, and on others.
    pub judged: Vec<JudgedFacts>,
    /// Tests of the residuals.
    pub residuals: Option<TestFacts>,
    /// Why there are none.
    pub residuals_error: Option<String>,
    /// Parameters that ended at a bound.
    pub at_bound: Vec<bool>,
    /// Doubts, in words.
    pub doubts: Vec<String>,
}

/// A quantity that follows from parameters.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct DerivedFacts {
    /// Its name.
    pub name: String,
    /// Its value.
    #[serde(deserialize_with = "nan_if_null")]
    pub value: f64,
    /// Its standard error.
    #[serde(deserialize_with = "nan_if_null")]
    pub standard_error: f64,
    /// Its 95 % interval.
    #[serde(deserialize_with = "nan_if_null")]
    pub interval_95: [f64; 2],
}

/// Judgement of a model on data.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct JudgedFacts {
    /// Which data: those of the estimate, or unseen ones.
    pub data: String,
    /// Names of the experiments.
    pub experiments: Vec<String>,
    /// Fit of the simulation, of each experiment and output, %.
    #[serde(deserialize_with = "nan_if_null")]
    pub fit_percent_simulated: Option<Vec<Vec<f64>>>,
    /// Fit of the prediction, of each experiment and output, %.
    #[serde(deserialize_with = "nan_if_null")]
    pub fit_percent_predicted: Option<Vec<Vec<f64>>>,
    /// Why there is no simulation.
    pub error_simulated: Option<String>,
    /// Why there is no prediction.
    pub error_predicted: Option<String>,
    /// Judgement by the mean over periods, where inputs repeat.
    pub repeated: Vec<RepeatedFacts>,
}

impl JudgedFacts {
    pub(super) fn of(judged: &Judged) -> Self {
        let fit = |j: &Result<Judgement, IdentError>| j.as_ref().ok().map(|j| j.fit_percent.clone());
        let error = |j: &Result<Judgement, IdentError>| j.as_ref().err().map(ToString::to_string);
        JudgedFacts {
            data: judged.name.to_owned(),
            experiments: judged.experiments.clone(),
            fit_percent_simulated: fit(&judged.simulated).filter(|_| !judged.diverges),
            fit_percent_predicted: fit(&judged.predicted),
            error_simulated: match judged.diverges {
                true => Some("the model is not stable, and its simulation measures nothing".to_owned()),
                false => error(&judged.simulated),
            },
            error_predicted: error(&judged.predicted),
            repeated: judged.repeated.iter().map(Repeated::facts).collect(),
        }
    }
}
