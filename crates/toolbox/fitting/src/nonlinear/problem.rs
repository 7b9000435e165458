//! A sum of squares to be minimised, where to search, and what is found.

use faer::Mat;

use crate::{IdentError, Termination};

/// A sum of squares ‖ε(θ)‖² that yields the triangular factor of [J ε] without keeping J.
pub trait SumOfSquares {
    /// Number of parameters n.
    fn parameter_count(&self) -> usize;

    /// Number of residuals.
    fn residual_count(&self) -> usize;

    /// ‖ε(θ)‖².
    ///
    /// # Errors
    /// θ at which there is no model; the step towards it is then shortened.
    fn cost(&mut self, parameters: &[f64]) -> Result<f64, IdentError>;

    /// The triangular factor of [J ε] at θ, n + 1 square. It is asked for at the start and at every accepted step.
    ///
    /// # Errors
    /// θ at which there is no model.
    fn factor(&mut self, parameters: &[f64]) -> Result<Mat<f64>, IdentError>;
}

/// Lower and upper bound of one parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// Smallest value allowed.
    pub lower: f64,
    /// Largest value allowed.
    pub upper: f64,
}

impl Bounds {
    /// No bounds.
    pub const NONE: Bounds = Bounds { lower: f64::NEG_INFINITY, upper: f64::INFINITY };

    /// From `lower` to `upper`.
    pub fn new(lower: f64, upper: f64) -> Self {
        Bounds { lower, upper }
    }

    /// The value, or the bound that it is beyond.
    pub fn clamp(&self, value: f64) -> f64 {
        value.max(self.lower).min(self.upper)
    }
}

/// How far and how exactly to iterate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NonlinearOptions {
    /// Most iterations.
    pub iteration_limit: usize,
    /// Converged when a step changes no scaled parameter by more than this fraction.
    pub step_tolerance: f64,
    /// Converged when the cost is expected to fall by less than this fraction.
    pub cost_tolerance: f64,
}

impl Default for NonlinearOptions {
    fn default() -> Self {
        NonlinearOptions { iteration_limit: 100, step_tolerance: 1e-10, cost_tolerance: 1e-14 }
    }
}

/// Where a search ended, whether the data separate all parameters there or not; as [`Minimum`](super::Minimum).
#[derive(Debug, Clone)]
pub struct LowestPoint {
    /// θ.
    pub parameters: Vec<f64>,
    /// ‖ε‖².
    pub cost: f64,
    /// How it ended.
    pub termination: Termination,
    /// Iterations taken.
    pub iterations: usize,
}

/// Where a search ended that keeps the factor of the Jacobian alone.
#[derive(Debug, Clone)]
pub struct Lowest {
    /// θ.
    pub parameters: Vec<f64>,
    /// Triangular factor of [J ε].
    pub factor: Mat<f64>,
    /// (JᵀJ)⁻¹ over the free parameters.
    pub unscaled_covariance: Mat<f64>,
    /// ‖ε‖².
    pub cost: f64,
    /// Parameters that rest on a bound.
    pub at_bound: Vec<bool>,
    /// Iterations taken.
    pub iterations: usize,
    /// How it ended.
    pub termination: Termination,
    /// Condition number of the Jacobian with its columns scaled to one.
    pub condition: f64,
}
