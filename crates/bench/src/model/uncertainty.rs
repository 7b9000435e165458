//! Uncertainty of what is computed from the model.

use faer::Mat;
use serde::{Deserialize, Deserializer, Serialize};

use super::{BenchModel, ModelParameter};
use crate::estimate::Label;
use crate::study::Parameter;

/// Covariance of the parameters of one part of the model, SI.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PartCovariance {
    /// Parameters, in the covariance's order.
    pub parameters: Vec<ModelParameter>,
    /// Their covariance, SI.
    pub covariance: Vec<Vec<f64>>,
    /// Degrees of freedom behind it; infinite ones are written as null.
    #[serde(deserialize_with = "infinite_if_null")]
    pub degrees_of_freedom: f64,
}

/// Why a covariance cannot be used.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum UncertaintyError {
    /// The covariance is not square in the number of parameters.
    #[error("the covariance of {parameters} parameters has {rows} rows, or a row of another length")]
    Shape {
        /// Parameters.
        parameters: usize,
        /// Rows found.
        rows: usize,
    },
    /// A variance is negative or an entry is not finite.
    #[error("the covariance of {parameter:?} is not a variance")]
    NotAVariance {
        /// The parameter whose row is wrong.
        parameter: ModelParameter,
    },
}

/// Uncertainty of a [`BenchModel`]: parts estimated from different data, hence independent; the covariance of all
/// parameters is block diagonal. A parameter in no part is taken as exact, as inertias stated in the bench file are.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(into = "Vec<PartCovariance>", try_from = "Vec<PartCovariance>")]
pub struct ModelUncertainty {
    parts: Vec<(Vec<ModelParameter>, Mat<f64>, f64)>,
}

/// A number computed from the model, with its uncertainty.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Derived {
    /// Value at the estimates.
    pub value: f64,
    /// Standard error.
    pub standard_error: f64,
    /// Effective degrees of freedom; infinite where nothing is uncertain.
    pub degrees_of_freedom: f64,
}

impl ModelUncertainty {
    /// Uncertainty from its parts.
    ///
    /// # Errors
    /// A covariance of the wrong shape, with a negative variance, or not finite.
    pub fn new(parts: &[PartCovariance]) -> Result<Self, UncertaintyError> {
        let parts = parts.iter().map(checked).collect::<Result<Vec<_>, _>>()?;
        Ok(ModelUncertainty { parts })
    }

    /// A function of the model, with its standard error by the delta method, Var g ≈ Σ_parts ∇gᵀ P ∇g, and the degrees
    /// of freedom of that sum of independent variances, (Σ v_i)²/Σ(v_i²/ν_i).
    ///
    /// # Source
    /// Thesis (2.4); Ljung 1999, (9.56); Satterthwaite, Biometrics Bulletin 2 (1946) 110.
    pub fn propagate(&self, model: &BenchModel, function: impl Fn(&BenchModel) -> f64) -> Derived {
        let (mut total, mut weighted) = (0.0, 0.0);
        for (parameters, covariance, degrees_of_freedom) in &self.parts {
            let known: Vec<f64> = parameters.iter().map(|p| model.value(*p).unwrap_or(0.0)).collect();
            let at = |values: &[f64]| {
                let changed = parameters.iter().zip(values).fold(model.clone(), |m, (p, v)| m.with(*p, *v));
                function(&changed)
            };
            let variance = ident::covariance::delta_variance(&known, covariance, at).max(0.0);
            total += variance;
            weighted += variance * variance / degrees_of_freedom;
        }
        let degrees_of_freedom = if weighted > 0.0 { total * total / weighted } else { f64::INFINITY };
        Derived { value: function(model), standard_error: total.sqrt(), degrees_of_freedom }
    }
}

impl TryFrom<Vec<PartCovariance>> for ModelUncertainty {
    type Error = UncertaintyError;

    fn try_from(parts: Vec<PartCovariance>) -> Result<Self, UncertaintyError> {
        ModelUncertainty::new(&parts)
    }
}

impl From<ModelUncertainty> for Vec<PartCovariance> {
    fn from(uncertainty: ModelUncertainty) -> Self {
        let part = |(parameters, covariance, degrees_of_freedom): (Vec<ModelParameter>, Mat<f64>, f64)| {
            let row = |i| (0..covariance.ncols()).map(|j| covariance[(i, j)]).collect();
            PartCovariance { covariance: (0..covariance.nrows()).map(row).collect(), parameters, degrees_of_freedom }
        };
        uncertainty.parts.into_iter().map(part).collect()
    }
}

fn infinite_if_null<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    Ok(Option::deserialize(deserializer)?.unwrap_or(f64::INFINITY))
}

impl Derived {
    /// As a parameter of a study.
    pub(crate) fn parameter(self, label: Label) -> Parameter {
        Parameter::new(label, self.value, self.standard_error, self.degrees_of_freedom)
    }
}

fn checked(part: &PartCovariance) -> Result<(Vec<ModelParameter>, Mat<f64>, f64), UncertaintyError> {
    let n = part.parameters.len();
    if part.covariance.len() != n || part.covariance.iter().any(|row| row.len() != n) {
        return Err(UncertaintyError::Shape { parameters: n, rows: part.covariance.len() });
    }
    for (i, parameter) in part.parameters.iter().enumerate() {
        if part.covariance[i].iter().any(|v| !v.is_finite()) || part.covariance[i][i] < 0.0 {
            return Err(UncertaintyError::NotAVariance { parameter: *parameter });
        }
    }
    let matrix = Mat::from_fn(n, n, |i, j| part.covariance[i][j]);
    Ok((part.parameters.clone(), matrix, part.degrees_of_freedom))
}
