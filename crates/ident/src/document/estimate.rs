//! What a model file says of the estimate.

use serde::{Deserialize, Serialize};

use super::{rows, square};
use crate::{Doubt, Fit, IdentError, Parametric, Termination};

/// Data that an estimate rests on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Source {
    /// The recording.
    pub file: String,
    /// SHA-256 of its content, hexadecimal.
    pub sha256: String,
    /// First instant used, s.
    pub from_s: f64,
    /// Last instant used, s.
    pub to_s: f64,
}

/// An estimate without its model: a [`Fit`] written down, with how it was made.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EstimateRecord {
    /// The method and its options, in words.
    pub method: String,
    /// The data.
    pub sources: Vec<Source>,
    /// What each parameter is called, in the order of the covariance.
    pub parameter_names: Vec<String>,
    /// Their values.
    pub parameters: Vec<f64>,
    /// Their covariance, by rows.
    pub covariance: Vec<Vec<f64>>,
    /// Degrees of freedom of Student's t.
    pub degrees_of_freedom: f64,
    /// Covariance of the prediction errors, outputs × outputs, by rows.
    pub noise_covariance: Vec<Vec<f64>>,
    /// Determinant of the mean of `ε εᵀ`.
    pub loss: f64,
    /// Rows of prediction errors.
    pub samples: usize,
    /// Free parameters.
    pub free_parameters: usize,
    /// Initial state of each experiment.
    pub initial_states: Vec<Vec<f64>>,
    /// How the search ended.
    pub termination: Termination,
    /// Iterations taken.
    pub iterations: usize,
    /// Condition number of the scaled regressor or Jacobian; none where it is not known.
    pub condition: Option<f64>,
    /// What to doubt.
    pub doubts: Vec<Doubt>,
}

impl EstimateRecord {
    /// Writes a fit down.
    pub fn new<M: Parametric>(fit: &Fit<M>, method: impl Into<String>, sources: Vec<Source>) -> Self {
        EstimateRecord {
            method: method.into(),
            sources,
            parameter_names: fit.model.parameter_names(),
            parameters: fit.model.parameters(),
            covariance: rows(&fit.covariance),
            degrees_of_freedom: fit.degrees_of_freedom,
            noise_covariance: rows(&fit.noise_covariance),
            loss: fit.loss,
            samples: fit.samples,
            free_parameters: fit.free_parameters,
            initial_states: fit.initial_states.clone(),
            termination: fit.termination,
            iterations: fit.iterations,
            condition: fit.condition.is_finite().then_some(fit.condition),
            doubts: fit.doubts.clone(),
        }
    }

    /// The fit again, of this model.
    pub(super) fn to_fit<M: Parametric>(&self, model: M) -> Result<Fit<M>, IdentError> {
        let count = model.parameters().len();
        let found = self.covariance.len();
        if found != count {
            return Err(IdentError::Length { what: "rows of the covariance", expected: count, found });
        }
        let names = model.parameter_names();
        if self.parameter_names != names {
            let found = format!("an estimate of {}", self.parameter_names.join(", "));
            return Err(IdentError::Document { found, expected: format!("an estimate of {}", names.join(", ")) });
        }
        Ok(Fit {
            covariance: square("covariance", &self.covariance)?,
            degrees_of_freedom: self.degrees_of_freedom,
            noise_covariance: square("noise covariance", &self.noise_covariance)?,
            loss: self.loss,
            samples: self.samples,
            free_parameters: self.free_parameters,
            initial_states: self.initial_states.clone(),
            termination: self.termination,
            iterations: self.iterations,
            condition: self.condition.unwrap_or(f64::NAN),
            doubts: self.doubts.clone(),
            model,
        })
    }
}
