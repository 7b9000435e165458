//! The discrete form of PI, and the part of it that no recording shows.

use numerics::null::nan_if_null;
use rig::results::{Estimate, Parameter, Quantity};
use serde::{Deserialize, Serialize};

/// PI as the controller computes it: T_d*(k) = T_d*(k − 1) + b_0 e(k) + b_1 e(k − 1), e the speed error delayed by τ.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Discrete {
    /// Sample time T of the controller, s.
    #[serde(deserialize_with = "nan_if_null")]
    pub sample_time_s: f64,
    /// b_0 = K_p and b_1 = K_i T − K_p, Nm s/rad, with the covariance that follows from that of K_p and K_i.
    pub coefficients: Estimate,
    /// K_p by each rule of integration, all of which give these coefficients; K_i = (b_0 + b_1)/T is the same in all.
    pub proportional_gains: Vec<(IntegrationRule, Parameter)>,
}

/// How a controller integrates the speed error.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum IntegrationRule {
    /// I(k + 1) = I(k) + K_i T e(k): forward Euler, and the exact form of (6.5) under a held input.
    Forward,
    /// I(k) = I(k − 1) + K_i T (e(k) + e(k − 1))/2: Tustin's.
    Trapezoidal,
    /// I(k) = I(k − 1) + K_i T e(k).
    Backward,
}

impl IntegrationRule {
    /// All of them.
    pub const ALL: [IntegrationRule; 3] =
        [IntegrationRule::Forward, IntegrationRule::Trapezoidal, IntegrationRule::Backward];

    /// The part of K_i T by which K_p is less than by forward Euler.
    fn share(self) -> f64 {
        match self {
            IntegrationRule::Forward => 0.0,
            IntegrationRule::Trapezoidal => 0.5,
            IntegrationRule::Backward => 1.0,
        }
    }
}

impl Discrete {
    /// Of K_p and K_i, the first two parameters of an estimate.
    pub(super) fn of(estimate: &Estimate, sample_time_s: f64) -> Self {
        let by_rule = |rule: IntegrationRule| {
            (rule, combined(estimate, Quantity::ProportionalGain, [1.0, -rule.share() * sample_time_s]))
        };
        let rows = [[1.0, 0.0], [-1.0, sample_time_s]];
        let covariance = rows.iter().map(|a| rows.iter().map(|b| joint(estimate, *a, *b)).collect()).collect();
        let coefficients = Estimate {
            parameters: vec![
                combined(estimate, Quantity::PresentErrorGain, rows[0]),
                combined(estimate, Quantity::PreviousErrorGain, rows[1]),
            ],
            covariance,
            ..estimate.clone()
        };
        let proportional_gains = IntegrationRule::ALL.map(by_rule).to_vec();
        Discrete { sample_time_s, coefficients, proportional_gains }
    }
}

/// A sum of K_p and K_i with these factors.
fn combined(estimate: &Estimate, quantity: Quantity, factors: [f64; 2]) -> Parameter {
    let value: f64 = estimate.parameters.iter().zip(factors).map(|(p, factor)| factor * p.value).sum();
    let freedom = estimate.parameters.first().map_or(f64::NAN, |p| p.degrees_of_freedom);
    Parameter::new(quantity, value, joint(estimate, factors, factors).max(0.0).sqrt(), freedom)
}

/// Covariance of two such sums.
fn joint(estimate: &Estimate, a: [f64; 2], b: [f64; 2]) -> f64 {
    let rows = estimate.covariance.iter().zip(a);
    rows.map(|(row, a)| row.iter().zip(b).map(|(value, b)| a * value * b).sum::<f64>()).sum()
}
