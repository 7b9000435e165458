//! Curves and roots of models in numbers.

use numerics::null::{infinite_if_null, nan_if_null};
use serde::{Deserialize, Serialize};

/// A curve of a model, with its band.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CurveFacts {
    /// Name of the model.
    pub model: String,
    /// Names of the input and of the output.
    pub channel: String,
    /// Where its values are.
    #[serde(flatten)]
    pub at: Points,
    /// Quantities that it shows.
    pub quantities: Vec<QuantityFacts>,
    /// Numbers that sum it up.
    pub summary: Vec<Fact>,
}

/// Points of a curve.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Points {
    /// Frequencies, Hz.
    Frequency(Vec<f64>),
    /// Times, s.
    Time(Vec<f64>),
}

/// A quantity of a curve.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct QuantityFacts {
    /// Its name.
    pub name: String,
    /// Its unit.
    pub unit: String,
    /// Its values.
    #[serde(deserialize_with = "nan_if_null")]
    pub values: Vec<f64>,
    /// Their intervals; none of a model without an estimate.
    #[serde(deserialize_with = "nan_if_null")]
    pub band: Option<Vec<(f64, f64)>>,
}

/// A number that sums up a curve, or a remark that stands for it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Fact {
    /// Its name.
    pub name: String,
    /// The number; none where the remark stands for it.
    pub value: Option<f64>,
    /// Its unit.
    pub unit: String,
    /// Its interval; none of a model without an estimate.
    #[serde(deserialize_with = "nan_if_null")]
    pub interval: Option<(f64, f64)>,
    /// Remark on it, in words.
    pub remark: String,
}

impl Fact {
    pub(super) fn number(name: &str, value: f64, unit: &str, interval: Option<(f64, f64)>) -> Self {
        Fact { name: name.to_owned(), value: Some(value), unit: unit.to_owned(), interval, remark: String::new() }
    }

    pub(super) fn remark(name: &str, remark: &str) -> Self {
        let (name, remark) = (name.to_owned(), remark.to_owned());
        Fact { name, value: None, unit: String::new(), interval: None, remark }
    }

    pub(super) fn noted(self, remark: String) -> Self {
        Fact { remark, ..self }
    }
}

/// Poles and zeros of a model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ModelRootsFacts {
    /// Name of the model.
    pub model: String,
    /// Its sample time, s: its roots are in z. None of a continuous model, whose roots are in s, rad/s.
    pub sample_time_s: Option<f64>,
    /// Confidence of the intervals.
    pub level: f64,
    /// The poles, once where channels share them.
    pub poles: Vec<RootsFacts>,
    /// The zeros of each channel.
    pub zeros: Vec<RootsFacts>,
}

/// Poles or zeros of channels.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RootsFacts {
    /// Names of the input and of the output of each channel.
    pub channels: Vec<String>,
    /// The roots.
    pub roots: Vec<RootFacts>,
}

/// Outline of the region of confidence of a pole or a zero.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RegionFacts {
    /// True of a pole.
    pub is_pole: bool,
    /// Names of the channels that have the root; none where all do.
    pub channels: Vec<String>,
    /// Real and imaginary parts along the outline.
    pub outline: Vec<(f64, f64)>,
}

/// A pole or a zero. Intervals are none of a model without an estimate, and where the root may reach another one.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RootFacts {
    /// Its real part.
    pub re: f64,
    /// Its imaginary part.
    pub im: f64,
    /// Covariance of both parts.
    #[serde(deserialize_with = "nan_if_null")]
    pub covariance: [[f64; 2]; 2],
    /// True if it may reach another root within its uncertainty.
    pub near_multiple: bool,
    /// Natural frequency, Hz; infinite of a root at zero in z.
    #[serde(deserialize_with = "infinite_if_null")]
    pub natural_frequency_hz: f64,
    /// Its interval, Hz; without an end where the frequency may be infinite.
    #[serde(deserialize_with = "infinite_if_null")]
    pub natural_frequency_interval_hz: Option<(f64, f64)>,
    /// Damping ratio.
    #[serde(deserialize_with = "nan_if_null")]
    pub damping: f64,
    /// Its interval.
    #[serde(deserialize_with = "nan_if_null")]
    pub damping_interval: Option<(f64, f64)>,
    /// Time constant, s; infinite of an integrator.
    #[serde(deserialize_with = "infinite_if_null")]
    pub time_constant_s: f64,
    /// Its interval, s; without an end where the root may be an integrator.
    #[serde(deserialize_with = "infinite_if_null")]
    pub time_constant_interval_s: Option<(f64, f64)>,
}
