//! Uncertainty of what is computed from the model.

use faer::Mat;
use numerics::linalg::symmetric_eigenvalues;
use numerics::null::infinite_if_null;
use numerics::random::Stream;
use rig::results::{Parameter, Quantity};
use serde::{Deserialize, Serialize};
use signal::distributions::chi_squared_quantile;

use super::{BenchModel, ModelParameter};

/// Draws after which a model is given up that hardly ever gives a possible bench.
const MOST_DRAWS: usize = 1000;
/// Pivots of a correlation matrix below this are rounding.
const SMALLEST_PIVOT: f64 = 1e-14;
/// Part of the standard errors by which rounding may move a covariance.
const ROUNDING: f64 = 1e-6;

/// Covariance of the parameters of one part of the model, SI.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PartCovariance {
    /// Parameters, in the covariance's order.
    pub parameters: Vec<ModelParameter>,
    /// Their covariance, SI.
    pub covariance: Vec<Vec<f64>>,
    /// Degrees of freedom behind it; infinite ones are written as null.
    #[serde(deserialize_with = "infinite_if_null")]
    pub degrees_of_freedom: f64,
}

/// Why a covariance cannot be used; `part` counts from 0.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum UncertaintyError {
    /// The covariance is not square in the number of parameters.
    #[error(
        "`uncertainty[{part}].covariance` has {rows} rows of {columns} numbers, and its {parameters} `parameters` need {parameters} of {parameters}"
    )]
    Shape {
        /// Which part.
        part: usize,
        /// Parameters.
        parameters: usize,
        /// Rows found.
        rows: usize,
        /// Numbers in the row of another length, or in the first.
        columns: usize,
    },
    /// A variance is negative or an entry is not finite.
    #[error(
        "`uncertainty[{part}].covariance[{row}]` has a negative variance on the diagonal, or a number that is not finite"
    )]
    NotAVariance {
        /// Which part.
        part: usize,
        /// Which row.
        row: usize,
    },
    /// Two entries that belong together differ, or are larger than the variances allow.
    #[error("`uncertainty[{part}].covariance` is not symmetric, or too large, in row {row} and column {column}")]
    NotACovariance {
        /// Which part.
        part: usize,
        /// Which row.
        row: usize,
        /// Which column.
        column: usize,
    },
    /// Degrees of freedom that no estimate has.
    #[error("`uncertainty[{part}].degrees_of_freedom` is {found}, and must be above 0, or null")]
    DegreesOfFreedom {
        /// Which part.
        part: usize,
        /// The number found.
        found: f64,
    },
}

/// Uncertainty of a [`BenchModel`]: parts estimated from different data, hence independent; the covariance of all
/// parameters is block diagonal. A parameter in no part is taken as exact, as an inertia stated without uncertainty is.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(with = "Vec<PartCovariance>"))]
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
        let parts = parts.iter().enumerate().map(checked).collect::<Result<Vec<_>, _>>()?;
        Ok(ModelUncertainty { parts })
    }

    /// The parameters in its parts, in order.
    pub fn parameters(&self) -> impl Iterator<Item = ModelParameter> + '_ {
        self.parts.iter().flat_map(|(parameters, _, _)| parameters.iter().copied())
    }

    /// Standard error and degrees of freedom of a parameter; `None` where it is in no part, and taken as exact.
    #[must_use]
    pub fn standard_error(&self, parameter: ModelParameter) -> Option<(f64, f64)> {
        self.parts.iter().find_map(|(parameters, covariance, degrees_of_freedom)| {
            let place = parameters.iter().position(|other| *other == parameter)?;
            Some((covariance[(place, place)].max(0.0).sqrt(), *degrees_of_freedom))
        })
    }

    /// The least eigenvalue of the correlations in each part, by its number: below 0 in no covariance, but for
    /// rounding.
    pub(crate) fn least_eigenvalues(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        self.parts.iter().enumerate().map(|(number, (_, covariance, _))| (number, least_eigenvalue(covariance)))
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
            let variance = fitting::covariance::delta_variance(&known, covariance, at).max(0.0);
            total += variance;
            weighted += variance * variance / degrees_of_freedom;
        }
        let degrees_of_freedom = if weighted > 0.0 { total * total / weighted } else { f64::INFINITY };
        Derived { value: function(model), standard_error: total.sqrt(), degrees_of_freedom }
    }

    /// Of every parameter in a part, which share of the variance of a function of the model would go if it were known
    /// exactly: (P ∇g)_i²/P_ii of the total, by the rule for the conditional variance of normal variables.
    ///
    /// # Source
    /// Anderson, *An Introduction to Multivariate Statistical Analysis*, 3rd ed. 2003, §2.5.
    pub(crate) fn removed_by_knowing(
        &self,
        model: &BenchModel,
        function: impl Fn(&BenchModel) -> f64,
    ) -> Vec<(ModelParameter, f64)> {
        let (mut total, mut removed) = (0.0, Vec::new());
        for (parameters, covariance, _) in &self.parts {
            let known: Vec<f64> = parameters.iter().map(|p| model.value(*p).unwrap_or(0.0)).collect();
            let at = |values: &[f64]| {
                let changed = parameters.iter().zip(values).fold(model.clone(), |m, (p, v)| m.with(*p, *v));
                function(&changed)
            };
            let slope = fitting::covariance::gradient(&known, covariance, at);
            for (i, parameter) in parameters.iter().enumerate() {
                let along: f64 = slope.iter().enumerate().map(|(j, slope)| covariance[(i, j)] * slope).sum();
                total += slope[i] * along;
                let own = covariance[(i, i)];
                removed.push((*parameter, if own > 0.0 { along * along / own } else { 0.0 }));
            }
        }
        let share = |variance: f64| if total > 0.0 { (variance / total).min(1.0) } else { 0.0 };
        removed.into_iter().map(|(parameter, variance)| (parameter, share(variance))).collect()
    }

    /// A model drawn from this uncertainty: each part from a multivariate Student t with its covariance as scale and
    /// its degrees of freedom. A draw that no bench can have (a stiffness or bandwidth of zero or below, a negative
    /// damping, inertia or delay) is drawn again; `None` where nearly all are such.
    pub fn draw(&self, model: &BenchModel, random: &mut Stream) -> Option<BenchModel> {
        self.parts.iter().try_fold(model.clone(), |model, (parameters, covariance, degrees_of_freedom)| {
            let factor = cholesky(covariance);
            (0..MOST_DRAWS).find_map(|_| {
                let normal: Vec<f64> = parameters.iter().map(|_| random.normal()).collect();
                let spread = student_scale(random, *degrees_of_freedom);
                let steps = factor.iter().map(|row| spread * row.iter().zip(&normal).map(|(l, z)| l * z).sum::<f64>());
                parameters.iter().zip(steps).try_fold(model.clone(), |drawn, (parameter, step)| {
                    let value = model.value(*parameter).unwrap_or(0.0) + step;
                    parameter.can_be(value).then(|| drawn.with(*parameter, value))
                })
            })
        })
    }
}

/// Of the correlations of a covariance; a number that is exact has none.
fn least_eigenvalue(covariance: &Mat<f64>) -> f64 {
    let scale: Vec<f64> = (0..covariance.nrows()).map(|i| covariance[(i, i)].sqrt()).collect();
    let correlation = Mat::from_fn(scale.len(), scale.len(), |i, j| match (i == j, scale[i] > 0.0 && scale[j] > 0.0) {
        (true, _) => 1.0,
        (false, true) => 0.5 * (covariance[(i, j)] + covariance[(j, i)]) / scale[i] / scale[j],
        (false, false) => 0.0,
    });
    let values = symmetric_eigenvalues(correlation.as_ref()).unwrap_or(vec![f64::NEG_INFINITY]);
    values.into_iter().fold(f64::INFINITY, f64::min)
}

/// √(ν/χ²_ν), by which normal draws become those of Student's t; 1 where ν is no finite number above zero.
fn student_scale(random: &mut Stream, degrees_of_freedom: f64) -> f64 {
    if !degrees_of_freedom.is_finite() || degrees_of_freedom <= 0.0 {
        return 1.0;
    }
    let chi_squared = chi_squared_quantile(1.0 - random.uniform(), degrees_of_freedom);
    (degrees_of_freedom / chi_squared).sqrt()
}

/// L with L Lᵀ = P, of the scaled matrix; a direction without variance gets zeros.
fn cholesky(covariance: &Mat<f64>) -> Vec<Vec<f64>> {
    let n = covariance.nrows();
    let scale: Vec<f64> = (0..n).map(|i| covariance[(i, i)].sqrt()).collect();
    let mut lower = vec![vec![0.0; n]; n];
    for j in 0..n {
        for i in j..n {
            let product = scale[i] * scale[j];
            let entry = if product > 0.0 { covariance[(i, j)] / product } else { 0.0 };
            let rest = entry - (0..j).map(|k| lower[i][k] * lower[j][k]).sum::<f64>();
            let pivot: f64 = lower[j][j];
            lower[i][j] = match (i == j, rest > SMALLEST_PIVOT, pivot > 0.0) {
                (true, true, _) => rest.sqrt(),
                (false, _, true) => rest / pivot,
                _ => 0.0,
            };
        }
    }
    for (row, scale) in lower.iter_mut().zip(&scale) {
        row.iter_mut().for_each(|entry| *entry *= scale);
    }
    lower
}

impl TryFrom<Vec<PartCovariance>> for ModelUncertainty {
    type Error = UncertaintyError;

    /// Checks more than [`ModelUncertainty::new`], as a document may be edited by hand.
    fn try_from(parts: Vec<PartCovariance>) -> Result<Self, UncertaintyError> {
        let uncertainty = ModelUncertainty::new(&parts)?;
        parts.iter().enumerate().try_for_each(|(number, part)| possible(number, part))?;
        Ok(uncertainty)
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

impl Derived {
    /// As a parameter of a study; the function gives the quantity in SI.
    pub fn parameter(self, quantity: Quantity) -> Parameter {
        Parameter::new(quantity, self.value, self.standard_error, self.degrees_of_freedom)
    }
}

fn checked((number, part): (usize, &PartCovariance)) -> Result<(Vec<ModelParameter>, Mat<f64>, f64), UncertaintyError> {
    let n = part.parameters.len();
    let rows = part.covariance.len();
    let wrong = part.covariance.iter().map(Vec::len).find(|columns| *columns != n);
    if rows != n || wrong.is_some() {
        let columns = wrong.unwrap_or(if rows == 0 { 0 } else { n });
        return Err(UncertaintyError::Shape { part: number, parameters: n, rows, columns });
    }
    let is_variance = |i: usize| part.covariance[i].iter().all(|v| v.is_finite()) && part.covariance[i][i] >= 0.0;
    if let Some(row) = (0..n).find(|i| !is_variance(*i)) {
        return Err(UncertaintyError::NotAVariance { part: number, row });
    }
    let matrix = Mat::from_fn(n, n, |i, j| part.covariance[i][j]);
    Ok((part.parameters.clone(), matrix, part.degrees_of_freedom))
}

/// Refuses degrees of freedom and covariances that no estimate has: |P_ij| ≤ √(P_ii P_jj), but for rounding.
fn possible(number: usize, part: &PartCovariance) -> Result<(), UncertaintyError> {
    if part.degrees_of_freedom.is_nan() || part.degrees_of_freedom <= 0.0 {
        return Err(UncertaintyError::DegreesOfFreedom { part: number, found: part.degrees_of_freedom });
    }
    let p = &part.covariance;
    for row in 0..p.len() {
        for column in 0..row {
            let largest = (p[row][row] * p[column][column]).sqrt();
            let is_possible = (p[row][column] - p[column][row]).abs() <= ROUNDING * largest
                && p[row][column].abs() <= (1.0 + ROUNDING) * largest;
            if !is_possible {
                return Err(UncertaintyError::NotACovariance { part: number, row, column });
            }
        }
    }
    Ok(())
}
