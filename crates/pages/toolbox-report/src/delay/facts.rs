//! Delays in numbers.

use ident::IdentError;
use ident::delay::{DelayCandidate, DelayEstimate};
use numerics::null::{infinite_if_null, nan_if_null};
use serde::{Deserialize, Serialize};

/// Numbers of [`super::Delays`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct DelayFacts {
    /// Time between samples, s.
    pub sample_time_s: f64,
    /// Which clock was taken, and why.
    pub clock: String,
    /// The delay of each input.
    pub delay: Vec<ClaimFacts>,
    /// Models with a dead time beside dynamics.
    pub models: Attempt<Vec<DelayModelFacts>>,
    /// Comparison of ARX models; none where the output is not known every so many samples.
    pub arx: Option<ArxDelayFacts>,
    /// First coefficient of the impulse response to each input that is significant, in samples; none where none is.
    pub impulse_response: Attempt<Vec<Option<usize>>>,
    /// By the phase of the response; none where this method does not fit the data.
    pub phase: Option<Attempt<DelayEstimateFacts>>,
    /// By ARX models, below a sample; none where this method does not fit the data.
    pub arx_fraction: Option<Attempt<DelayEstimateFacts>>,
    /// Notes, in words.
    pub notes: Vec<String>,
    /// Doubts, in words.
    pub doubts: Vec<String>,
}

/// Result of a method, or why there is none.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(untagged)]
pub enum Attempt<T> {
    /// There is none.
    Failed {
        /// The reason.
        error: String,
    },
    /// The result.
    Found(T),
}

impl<T> Attempt<T> {
    pub(super) fn of<F>(result: Result<F, &IdentError>, facts: impl FnOnce(F) -> T) -> Self {
        match result {
            Ok(found) => Attempt::Found(facts(found)),
            Err(reason) => Attempt::Failed { error: reason.to_string() },
        }
    }

    /// The result, if there is one.
    pub fn found(&self) -> Option<&T> {
        match self {
            Attempt::Found(found) => Some(found),
            Attempt::Failed { .. } => None,
        }
    }
}

/// The delay of an input, or why none is claimed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ClaimFacts {
    /// Name of the input.
    pub input: String,
    /// Its delay, s; none where none is claimed.
    pub delay_s: Option<f64>,
    /// The 95 % interval of the delay, s.
    #[serde(deserialize_with = "nan_if_null")]
    pub interval_95_s: Option<[f64; 2]>,
    /// Structure of the model that the delay is of, in words.
    pub model: Option<String>,
    /// Why no delay is claimed.
    pub unclaimed: Option<String>,
    /// Shortest and longest delay that any method allows, s.
    #[serde(deserialize_with = "nan_if_null")]
    pub range_of_methods_s: Option<[f64; 2]>,
}

/// A model with a dead time beside dynamics. Lists have an entry for each input.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct DelayModelFacts {
    /// Number of zeros.
    pub zeros: usize,
    /// Number of poles.
    pub poles: usize,
    /// Mean square of the errors.
    #[serde(deserialize_with = "nan_if_null")]
    pub loss: f64,
    /// Fit of the simulation, %.
    #[serde(deserialize_with = "nan_if_null")]
    pub fit_percent: f64,
    /// Ripple of the output that no input has and that was estimated too, Hz.
    #[serde(deserialize_with = "nan_if_null")]
    pub ripple_hz: Vec<f64>,
    /// Dead times, s.
    #[serde(deserialize_with = "nan_if_null")]
    pub dead_time_s: Vec<f64>,
    /// Their standard errors, s; infinite where the data do not show a dead time.
    #[serde(deserialize_with = "infinite_if_null")]
    pub standard_error_s: Vec<f64>,
    /// Their 95 % intervals, s.
    #[serde(deserialize_with = "nan_if_null")]
    pub interval_95_s: Vec<[f64; 2]>,
    /// By how much slow changes come out late, s.
    pub late_by_s: Vec<Option<f64>>,
    /// The 95 % intervals of that, s.
    #[serde(deserialize_with = "nan_if_null")]
    pub late_by_interval_95_s: Vec<Option<[f64; 2]>>,
    /// Reasons not to rely on the model, in words.
    pub faults: Vec<String>,
}

/// Comparison of ARX models with different delays.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ArxDelayFacts {
    /// The best delay of each input, in samples.
    pub samples: Vec<usize>,
    /// True if the errors of the best model look white, so that the comparison can be relied on.
    pub errors_are_white: Option<bool>,
    /// The best candidates, best first.
    pub candidates: Vec<CandidateFacts>,
}

/// Delays that were compared.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CandidateFacts {
    /// The delay of each input, in samples.
    pub samples: Vec<usize>,
    /// Mean square of the errors.
    #[serde(deserialize_with = "nan_if_null")]
    pub loss: f64,
    /// Likelihood, as a part of the sum over all candidates.
    #[serde(deserialize_with = "nan_if_null")]
    pub weight: f64,
}

impl CandidateFacts {
    pub(super) fn of(candidate: &DelayCandidate) -> Self {
        CandidateFacts { samples: candidate.delays.clone(), loss: candidate.loss, weight: candidate.weight }
    }
}

/// A delay with its standard error.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct DelayEstimateFacts {
    /// The delay, in samples.
    #[serde(deserialize_with = "nan_if_null")]
    pub samples: f64,
    /// Its standard error, in samples; infinite where the data do not show the delay.
    #[serde(deserialize_with = "infinite_if_null")]
    pub standard_error: f64,
}

impl DelayEstimateFacts {
    pub(super) fn of(estimate: &DelayEstimate) -> Self {
        DelayEstimateFacts { samples: estimate.samples, standard_error: estimate.standard_error }
    }
}
