//! Estimated numbers, their joint uncertainty, and the data they are from.

use serde::{Deserialize, Serialize};

use numerics::null::{infinite_if_null, nan_if_null};

use crate::numbers::unscaled;
use crate::quantity::{Notation, Quantity, ReadNotation};

/// One estimated number, in SI.
///
/// It serialises with symbol, name and the unit people read, see [`Quantity::notation`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(with = "WrittenParameter"))]
#[serde(into = "WrittenParameter", try_from = "ReadParameter")]
pub struct Parameter {
    /// The quantity.
    pub quantity: Quantity,
    /// Estimate.
    pub value: f64,
    /// Standard error.
    pub standard_error: f64,
    /// Degrees of freedom of the Student-t interval.
    pub degrees_of_freedom: f64,
    /// 95 % interval.
    pub interval: (f64, f64),
}

/// A stretch of one recording.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Stretch {
    /// File.
    pub file: String,
    /// Start, s of the recording's clock.
    pub start_s: f64,
    /// End, s.
    pub end_s: f64,
}

/// Parameters and their joint uncertainty, in SI.
///
/// It serialises in the units people read, covariance included.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(with = "WrittenEstimate"))]
#[serde(into = "WrittenEstimate", from = "ReadEstimate")]
pub struct Estimate {
    /// Parameters.
    pub parameters: Vec<Parameter>,
    /// Covariance, in the parameters' order, SI.
    pub covariance: Vec<Vec<f64>>,
    /// Data it was estimated from.
    pub stretches: Vec<Stretch>,
    /// Iterations taken; 0 for a direct solution.
    pub iterations: usize,
    /// Condition number of the scaled Jacobian or regressor.
    pub condition: f64,
}

impl Estimate {
    /// The parameter that is this quantity.
    #[must_use]
    pub fn parameter(&self, quantity: Quantity) -> Option<&Parameter> {
        self.parameters.get(self.place(quantity)?)
    }

    /// Where this quantity is among the parameters, and in the covariance.
    #[must_use]
    pub fn place(&self, quantity: Quantity) -> Option<usize> {
        self.parameters.iter().position(|parameter| parameter.quantity == quantity)
    }
}

/// A parameter as people read it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct WrittenParameter {
    /// The quantity, by which the parameter is read again.
    pub key: Quantity,
    /// Symbol, name and unit.
    #[serde(flatten)]
    pub notation: Notation,
    /// Estimate, in the unit people read.
    pub value: f64,
    /// Standard error.
    pub standard_error: f64,
    /// Degrees of freedom of the Student-t interval.
    pub degrees_of_freedom: f64,
    /// 95 % interval.
    pub interval: (f64, f64),
}

impl Parameter {
    /// In the unit people read.
    #[must_use]
    pub fn written(&self) -> WrittenParameter {
        self.scaled(self.quantity.notation())
    }

    /// In SI, for people who want that.
    #[must_use]
    pub fn written_in_si(&self) -> WrittenParameter {
        let notation = self.quantity.notation();
        self.scaled(Notation { unit: notation.si_unit, per_si: 1.0, ..notation })
    }

    fn scaled(&self, notation: Notation) -> WrittenParameter {
        let scale = notation.per_si;
        WrittenParameter {
            key: self.quantity,
            notation,
            value: scale * self.value,
            standard_error: scale * self.standard_error,
            degrees_of_freedom: self.degrees_of_freedom,
            interval: (scale * self.interval.0, scale * self.interval.1),
        }
    }
}

impl From<&Parameter> for WrittenParameter {
    fn from(parameter: &Parameter) -> Self {
        parameter.written()
    }
}

impl From<Parameter> for WrittenParameter {
    fn from(parameter: Parameter) -> Self {
        parameter.written()
    }
}

/// An estimate as JSON has it: each parameter in the unit people read, and the covariance in the same units.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct WrittenEstimate {
    parameters: Vec<WrittenParameter>,
    covariance: Vec<Vec<f64>>,
    stretches: Vec<Stretch>,
    iterations: usize,
    condition: f64,
}

impl From<Estimate> for WrittenEstimate {
    fn from(estimate: Estimate) -> Self {
        let parameters: Vec<WrittenParameter> = estimate.parameters.iter().map(Parameter::written).collect();
        let scaled = |(row, own): (Vec<f64>, &WrittenParameter)| {
            let entries = row.into_iter().zip(&parameters);
            entries.map(|(entry, other)| entry * own.notation.per_si * other.notation.per_si).collect()
        };
        WrittenEstimate {
            covariance: estimate.covariance.into_iter().zip(&parameters).map(scaled).collect(),
            parameters,
            stretches: estimate.stretches,
            iterations: estimate.iterations,
            condition: estimate.condition,
        }
    }
}

/// A parameter as it is read, in the unit people read; null is read as NaN, and as infinite degrees of freedom.
#[derive(Deserialize)]
struct ReadParameter {
    #[serde(flatten)]
    notation: ReadNotation,
    #[serde(deserialize_with = "nan_if_null")]
    value: f64,
    #[serde(deserialize_with = "nan_if_null")]
    standard_error: f64,
    #[serde(deserialize_with = "infinite_if_null")]
    degrees_of_freedom: f64,
    #[serde(deserialize_with = "nan_if_null")]
    interval: (f64, f64),
}

impl TryFrom<ReadParameter> for Parameter {
    type Error = String;

    fn try_from(read: ReadParameter) -> Result<Self, String> {
        let quantity = read.notation.quantity()?;
        let si = |written| unscaled(written, &[quantity.notation().per_si]);
        Ok(Parameter {
            quantity,
            value: si(read.value),
            standard_error: si(read.standard_error),
            degrees_of_freedom: read.degrees_of_freedom,
            interval: (si(read.interval.0), si(read.interval.1)),
        })
    }
}

/// An estimate as it is read; null is read as NaN.
#[derive(Deserialize)]
struct ReadEstimate {
    parameters: Vec<Parameter>,
    #[serde(deserialize_with = "nan_if_null")]
    covariance: Vec<Vec<f64>>,
    stretches: Vec<Stretch>,
    iterations: usize,
    #[serde(deserialize_with = "nan_if_null")]
    condition: f64,
}

impl From<ReadEstimate> for Estimate {
    fn from(read: ReadEstimate) -> Self {
        let scale = |parameter: &Parameter| parameter.quantity.notation().per_si;
        let in_si = |(row, own): (Vec<f64>, &Parameter)| {
            let entries = row.into_iter().zip(&read.parameters);
            entries.map(|(entry, other)| unscaled(entry, &[scale(own), scale(other)])).collect()
        };
        Estimate {
            covariance: read.covariance.into_iter().zip(&read.parameters).map(in_si).collect(),
            parameters: read.parameters,
            stretches: read.stretches,
            iterations: read.iterations,
            condition: read.condition,
        }
    }
}
