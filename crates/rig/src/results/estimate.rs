//! Estimated numbers, their joint uncertainty, and the data they are from.

use serde::Serialize;

/// One estimated number.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Parameter {
    /// Symbol of the thesis, e.g. `K_p`.
    pub symbol: String,
    /// What it is, e.g. `proportional gain`.
    pub name: String,
    /// Unit, as written in reports.
    pub unit: String,
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
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Stretch {
    /// File.
    pub file: String,
    /// Start, s of the recording's clock.
    pub start_s: f64,
    /// End, s.
    pub end_s: f64,
}

/// Parameters and their joint uncertainty.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Estimate {
    /// Parameters.
    pub parameters: Vec<Parameter>,
    /// Covariance, in the parameters' order and units.
    pub covariance: Vec<Vec<f64>>,
    /// Data it was estimated from.
    pub stretches: Vec<Stretch>,
    /// Iterations taken; 0 for a direct solution.
    pub iterations: usize,
    /// Condition number of the scaled Jacobian or regressor.
    pub condition: f64,
}

impl Estimate {
    /// The parameter with this symbol.
    pub fn parameter(&self, symbol: &str) -> Option<&Parameter> {
        self.parameters.iter().find(|p| p.symbol == symbol)
    }
}
