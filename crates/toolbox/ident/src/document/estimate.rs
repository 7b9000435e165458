//! Record of the estimate in a model file.

use serde::{Deserialize, Serialize};

use faer::Mat;
use lti::{from_rows, to_rows};
use numerics::linalg;

use crate::{Doubt, Fit, IdentError, Parametric, Termination};
use fitting::StructureError;

/// Data that an estimate rests on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
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

impl Source {
    /// Returns true if both are of one recording and have an instant in common.
    #[must_use]
    pub fn overlaps(&self, other: &Source) -> bool {
        self.sha256 == other.sha256 && self.from_s <= other.to_s && other.from_s <= self.to_s
    }
}

/// An estimate without its model: a [`Fit`] written down, with how it was made.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct EstimateRecord {
    /// The method and its options, in words.
    pub method: String,
    /// The data.
    pub sources: Vec<Source>,
    /// Names of the parameters, in the order of the covariance.
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
    /// Doubts about the estimate.
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
            covariance: to_rows(fit.covariance.as_ref()),
            degrees_of_freedom: fit.degrees_of_freedom,
            noise_covariance: to_rows(fit.noise_covariance.as_ref()),
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
        let parameters = model.parameters();
        let count = parameters.len();
        for (what, found) in
            [("rows of `estimate.covariance`", self.covariance.len()), ("`estimate.parameters`", self.parameters.len())]
        {
            if found != count {
                return Err(IdentError::Length { what, expected: count, found });
            }
        }
        if self.parameters != parameters {
            return Err(StructureError::OtherParameters.into());
        }
        if self.degrees_of_freedom.is_nan() || self.degrees_of_freedom <= 0.0 {
            return Err(StructureError::DegreesOfFreedom { found: self.degrees_of_freedom }.into());
        }
        let covariance = from_rows("`estimate.covariance`", &self.covariance, count, count)?;
        let outputs = self.noise_covariance.len();
        let noise_covariance = from_rows("`estimate.noise_covariance`", &self.noise_covariance, outputs, outputs)?;
        check_covariance(&covariance)?;
        check_covariance(&noise_covariance)?;
        let names = model.parameter_names();
        if self.parameter_names != names {
            let found = format!("an estimate of {}", self.parameter_names.join(", "));
            return Err(IdentError::Document { found, expected: format!("an estimate of {}", names.join(", ")) });
        }
        Ok(Fit {
            covariance,
            degrees_of_freedom: self.degrees_of_freedom,
            noise_covariance,
            loss: self.loss,
            samples: self.samples,
            free_parameters: self.free_parameters,
            initial_states: self.initial_states.clone(),
            levels: Vec::new(),
            termination: self.termination,
            iterations: self.iterations,
            condition: self.condition.unwrap_or(f64::NAN),
            doubts: self.doubts.clone(),
            origin: None,
            model,
        })
    }
}

/// Rounding leaves a covariance this part of its largest eigenvalue below zero at most.
const ROUNDING: f64 = 1e-8;

fn check_covariance(m: &Mat<f64>) -> Result<(), IdentError> {
    let n = m.nrows();
    let not_one = IdentError::Structure(StructureError::NotACovariance);
    if (0..n).any(|i| (0..n).any(|j| !m[(i, j)].is_finite())) {
        return Err(not_one);
    }
    // Scaled to a unit diagonal, so that units do not matter.
    let size = |i: usize| if m[(i, i)] > 0.0 { m[(i, i)].sqrt() } else { 1.0 };
    let scaled = Mat::from_fn(n, n, |i, j| m[(i, j)] / (size(i) * size(j)));
    let skewed = (0..n).any(|i| (0..n).any(|j| (scaled[(i, j)] - scaled[(j, i)]).abs() > ROUNDING));
    let values = linalg::symmetric_eigenvalues(scaled.as_ref())?;
    let smallest = values.iter().copied().fold(0.0, f64::min);
    if skewed || smallest < -ROUNDING * n as f64 { Err(not_one) } else { Ok(()) }
}
