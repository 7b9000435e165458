//! Nonlinear least squares: Levenberg–Marquardt with bounds, by QR of the Jacobian.

mod search;

use faer::{Mat, MatMut};
use numerics::vector::sum_of_squares;

use crate::{IdentError, Triangle};
use search::Search;

/// Residuals ε(θ) and their Jacobian ∂ε/∂θ.
pub trait ResidualModel {
    /// Number of parameters.
    fn parameter_count(&self) -> usize;

    /// Number of residuals.
    fn residual_count(&self) -> usize;

    /// Writes ε(θ) into `residuals` and, when asked, ∂ε_i/∂θ_j into row i, column j of `jacobian`.
    ///
    /// # Errors
    /// θ at which the model cannot be evaluated; the step towards it is then shortened.
    fn evaluate(
        &mut self,
        parameters: &[f64],
        residuals: &mut [f64],
        jacobian: Option<MatMut<'_, f64>>,
    ) -> Result<(), IdentError>;
}

/// A sum of squares ‖ε(θ)‖² that yields the triangular factor of [J ε] without keeping J.
pub(crate) trait SumOfSquares {
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

/// A residual model with its latest residuals and Jacobian.
struct Tabulated<'a, M> {
    model: &'a mut M,
    residuals: Vec<f64>,
    trial: Vec<f64>,
    jacobian: Mat<f64>,
}

impl<'a, M: ResidualModel> Tabulated<'a, M> {
    fn new(model: &'a mut M) -> Self {
        let (rows, columns) = (model.residual_count(), model.parameter_count());
        Tabulated { model, residuals: vec![0.0; rows], trial: vec![0.0; rows], jacobian: Mat::zeros(rows, columns) }
    }
}

impl<M: ResidualModel> SumOfSquares for Tabulated<'_, M> {
    fn parameter_count(&self) -> usize {
        self.model.parameter_count()
    }

    fn residual_count(&self) -> usize {
        self.model.residual_count()
    }

    fn cost(&mut self, parameters: &[f64]) -> Result<f64, IdentError> {
        self.model.evaluate(parameters, &mut self.trial, None)?;
        Ok(sum_of_squares(&self.trial))
    }

    fn factor(&mut self, parameters: &[f64]) -> Result<Mat<f64>, IdentError> {
        self.model.evaluate(parameters, &mut self.residuals, Some(self.jacobian.as_mut()))?;
        // A later step is accepted only where its cost is finite.
        if let Some(index) = self.residuals.iter().position(|r| !r.is_finite()) {
            return Err(IdentError::NotFinite { what: "residuals at the starting point", index });
        }
        let n = self.jacobian.ncols();
        let mut triangle = Triangle::new(n + 1);
        let mut row = vec![0.0; n + 1];
        for (i, residual) in self.residuals.iter().enumerate() {
            (0..n).for_each(|j| row[j] = self.jacobian[(i, j)]);
            row[n] = *residual;
            triangle.push_row(&row);
        }
        Ok(triangle.finish())
    }
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

    fn clamp(&self, value: f64) -> f64 {
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

/// How an iteration ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Termination {
    /// Solved at once, without a search.
    Direct,
    /// The step became negligible.
    SmallStep,
    /// The cost can no longer fall noticeably.
    SmallDecrease,
    /// No damping makes the cost fall: as good as the arithmetic allows.
    NoDescent,
    /// The cost would fall further where there is no model, such as beyond the edge of stability.
    Edge,
    /// The iteration limit was reached first.
    IterationLimit,
}

impl Termination {
    /// Whether the iteration reached a minimum.
    pub fn converged(self) -> bool {
        !matches!(self, Termination::Edge | Termination::IterationLimit)
    }
}

/// The minimum of ‖ε(θ)‖².
#[derive(Debug, Clone, PartialEq)]
pub struct Minimum {
    /// θ at the minimum.
    pub parameters: Vec<f64>,
    /// ε at the minimum.
    pub residuals: Vec<f64>,
    /// ∂ε/∂θ at the minimum: rows are residuals, columns parameters.
    pub jacobian: Mat<f64>,
    /// (JᵀJ)⁻¹ over the free parameters, zero in the rows and columns of those that rest on a bound.
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

impl Minimum {
    /// Residuals less free parameters.
    pub fn degrees_of_freedom(&self) -> f64 {
        let free = self.at_bound.iter().filter(|b| !**b).count();
        self.residuals.len() as f64 - free as f64
    }

    /// Variance of ε: cost over degrees of freedom.
    pub fn noise_variance(&self) -> f64 {
        self.cost / self.degrees_of_freedom()
    }

    /// Covariance of θ when ε is white with the variance the fit found.
    pub fn covariance(&self) -> Mat<f64> {
        faer::Scale(self.noise_variance()) * &self.unscaled_covariance
    }
}

/// Minimises ‖ε(θ)‖² from `start`, within `bounds`.
///
/// # Errors
/// Start outside its bounds, fewer residuals than parameters, a model that cannot be evaluated at the start, residuals
/// that are not finite there, or a Jacobian of deficient rank at the minimum.
///
/// # Source
/// Moré, *The Levenberg–Marquardt algorithm: implementation and theory*, 1978 (scaling); Nielsen, *Damping parameter in
/// Marquardt's method*, 1999 (damping); Ljung 1999, §10.2.
pub fn minimise<M: ResidualModel>(
    model: &mut M,
    start: &[f64],
    bounds: &[Bounds],
    options: NonlinearOptions,
) -> Result<Minimum, IdentError> {
    let mut tabulated = Tabulated::new(model);
    let lowest = descend(&mut tabulated, start, bounds, options)?;
    Ok(Minimum {
        parameters: lowest.parameters,
        residuals: tabulated.residuals,
        jacobian: tabulated.jacobian,
        unscaled_covariance: lowest.unscaled_covariance,
        cost: lowest.cost,
        at_bound: lowest.at_bound,
        iterations: lowest.iterations,
        termination: lowest.termination,
        condition: lowest.condition,
    })
}

/// Where a search ended; the fields are those of [`Minimum`].
#[derive(Debug, Clone)]
pub(crate) struct Lowest {
    pub(crate) parameters: Vec<f64>,
    /// Triangular factor of [J ε].
    pub(crate) factor: Mat<f64>,
    pub(crate) unscaled_covariance: Mat<f64>,
    pub(crate) cost: f64,
    pub(crate) at_bound: Vec<bool>,
    pub(crate) iterations: usize,
    pub(crate) termination: Termination,
    pub(crate) condition: f64,
}

/// [`minimise`] for anything that yields the factor of [J ε].
///
/// # Errors
/// Those of [`minimise`].
pub(crate) fn descend<O: SumOfSquares>(
    objective: &mut O,
    start: &[f64],
    bounds: &[Bounds],
    options: NonlinearOptions,
) -> Result<Lowest, IdentError> {
    let all_the_way = descend_unless(objective, start, bounds, options, |_, _| false)?;
    all_the_way.ok_or(IdentError::Structure { what: "the search was given up" })
}

/// [`descend`], given up where θ and its cost fulfil `idle`.
///
/// # Errors
/// Those of [`minimise`].
pub(crate) fn descend_unless<O: SumOfSquares>(
    objective: &mut O,
    start: &[f64],
    bounds: &[Bounds],
    options: NonlinearOptions,
    idle: impl Fn(&[f64], f64) -> bool,
) -> Result<Option<Lowest>, IdentError> {
    check_start(objective, start, bounds)?;
    let mut search = Search::new(objective, start, bounds)?;
    match search.run(options, idle)? {
        Some(termination) => search.finish(termination).map(Some),
        None => Ok(None),
    }
}

fn check_start<O: SumOfSquares>(model: &O, start: &[f64], bounds: &[Bounds]) -> Result<(), IdentError> {
    let n = model.parameter_count();
    if start.len() != n || bounds.len() != n {
        let found = if start.len() == n { bounds.len() } else { start.len() };
        return Err(IdentError::Length { what: "starting values or bounds", expected: n, found });
    }
    if model.residual_count() <= n {
        return Err(IdentError::TooFewSamples { samples: model.residual_count(), parameters: n });
    }
    for (index, (value, b)) in start.iter().zip(bounds).enumerate() {
        if !(*value >= b.lower && *value <= b.upper) {
            return Err(IdentError::StartOutsideBounds { index, start: *value, lower: b.lower, upper: b.upper });
        }
    }
    Ok(())
}
