//! Nonlinear least squares: Levenberg–Marquardt with bounds, by QR of the Jacobian.

mod problem;
mod search;

use faer::{Mat, MatMut};
use numerics::vector::sum_of_squares;

use crate::structure_error::StructureError;
use crate::{IdentError, Termination, Triangle};
pub use problem::{Bounds, NonlinearOptions};
pub use problem::{Lowest, LowestPoint, SumOfSquares};
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

/// A residual model with its latest residuals and Jacobian.
struct Tabulated<'a, M> {
    model: &'a mut M,
    residuals: Vec<f64>,
    trial: Vec<f64>,
    jacobian: Mat<f64>,
    /// Parameters that may move: columns of the others cost time and conditioning, and no search reads them.
    free: Vec<usize>,
}

impl<'a, M: ResidualModel> Tabulated<'a, M> {
    fn new(model: &'a mut M, bounds: &[Bounds]) -> Self {
        let (rows, columns) = (model.residual_count(), model.parameter_count());
        let (residuals, jacobian) = (vec![0.0; rows], Mat::zeros(rows, columns));
        let free = (0..columns.min(bounds.len())).filter(|j| bounds[*j].lower < bounds[*j].upper).collect();
        Tabulated { model, trial: residuals.clone(), residuals, jacobian, free }
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
        let mut triangle = Triangle::new(self.free.len() + 1);
        let column = |j: usize| match self.free.get(j) {
            None => Some(self.residuals.as_slice()),
            Some(j) => self.jacobian.col(*j).try_as_col_major().map(|column| column.as_slice()),
        };
        triangle.push_columns(self.residuals.len(), |j, start, target| {
            if let Some(column) = column(j) {
                target.copy_from_slice(&column[start..start + target.len()]);
            }
        });
        let of_free = triangle.finish();
        let mut factor = Mat::zeros(n + 1, n + 1);
        let places = || self.free.iter().copied().chain([n]).enumerate();
        for (b, j) in places() {
            places().take(b + 1).for_each(|(a, i)| factor[(i, j)] = of_free[(a, b)]);
        }
        Ok(factor)
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
    let mut tabulated = Tabulated::new(model, bounds);
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

/// The point that [`minimise`] comes to, whether the data separate all parameters there or not.
///
/// # Errors
/// Those of [`minimise`] at the start.
pub fn lowest_point<M: ResidualModel>(
    model: &mut M,
    start: &[f64],
    bounds: &[Bounds],
    options: NonlinearOptions,
) -> Result<LowestPoint, IdentError> {
    let mut tabulated = Tabulated::new(model, bounds);
    check_start(&tabulated, start, bounds)?;
    let mut search = Search::new(&mut tabulated, start, bounds)?;
    let termination = search.run(options, |_, _| false)?.ok_or(StructureError::GivenUp)?;
    Ok(search.point(termination))
}

/// [`minimise`] for anything that yields the factor of [J ε].
///
/// # Errors
/// Those of [`minimise`].
pub fn descend<O: SumOfSquares>(
    objective: &mut O,
    start: &[f64],
    bounds: &[Bounds],
    options: NonlinearOptions,
) -> Result<Lowest, IdentError> {
    let all_the_way = descend_unless(objective, start, bounds, options, |_, _| false)?;
    all_the_way.ok_or(StructureError::GivenUp.into())
}

/// [`descend`], given up where θ and its cost fulfil `idle`.
///
/// # Errors
/// Those of [`minimise`].
pub fn descend_unless<O: SumOfSquares>(
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
