//! Solving the equations of a regression from its triangular factor, and how certain the solution is.

use faer::{Mat, MatRef};
use numerics::linalg::{self, Qr};

use crate::IdentError;
use crate::condition::checked_condition;
use crate::triangle::upper_factor;

/// One equation `target = regressorsᵀ θ + ε` by the indices of its columns. Least squares where the instruments are the
/// regressors.
#[derive(Debug, Clone, PartialEq)]
pub struct Equation {
    /// Columns that the parameters multiply.
    pub regressors: Vec<usize>,
    /// Columns that the errors are uncorrelated with.
    pub instruments: Vec<usize>,
    /// The column that is explained.
    pub target: usize,
}

/// θ of one equation, and how it depends on the data.
#[derive(Debug, Clone)]
pub struct Solution {
    /// θ.
    pub theta: Vec<f64>,
    /// `G` in `θ̂ − θ = G Σ z(t) ε(t)`, parameters × instruments.
    pub gain: Mat<f64>,
    /// `G Zᵀ` in the coordinates of the factor's rows.
    influence: Mat<f64>,
    /// Condition number of the regressors with their columns scaled to one, or of the instruments where it is larger.
    pub condition: f64,
}

/// Solves one equation: least squares where instruments and regressors are the same, otherwise two-stage least squares
/// `θ = (Φ̂ᵀΦ̂)⁻¹Φ̂ᵀy` with `Φ̂` the projection of `Φ` on the instruments, which is `(ZᵀΦ)⁻¹Zᵀy` where there are as
/// many instruments as regressors. `factor` is the triangular factor of all columns.
///
/// # Errors
/// [`IdentError::RankDeficient`] where regressors or instruments are collinear, or unrelated to each other.
pub fn solve(factor: &Mat<f64>, equation: &Equation) -> Result<Solution, IdentError> {
    let (z, phi) = (&equation.instruments, &equation.regressors);
    if z == phi {
        return least_squares(factor, equation);
    }
    let all: Vec<usize> = z.iter().chain(phi).chain([&equation.target]).copied().collect();
    let joint = factor_of(factor, &all);
    let (instruments, parameters) = (z.len(), phi.len());
    if joint.nrows() < instruments || instruments < parameters {
        return Err(IdentError::RankDeficient {
            rank: instruments.min(joint.nrows()),
            parameters,
            condition: f64::INFINITY,
        });
    }
    let of_z = Pseudo::new(joint.get(..instruments, ..instruments), &norms(joint.as_ref(), 0..instruments))?;
    let scale = norms(joint.as_ref(), instruments..instruments + parameters);
    let across = Pseudo::new(joint.get(..instruments, instruments..instruments + parameters), &scale)?;
    let theta = across.solve(joint.get(..instruments, instruments + parameters..));
    // G = (R₁₂)⁺ R₁₁⁻ᵀ
    let gain = across.inverse() * of_z.inverse().transpose();
    Ok(Solution {
        theta: (0..parameters).map(|i| theta[(i, 0)]).collect(),
        influence: &gain * columns(factor, z).transpose(),
        gain,
        condition: across.condition.max(of_z.condition),
    })
}

fn least_squares(factor: &Mat<f64>, equation: &Equation) -> Result<Solution, IdentError> {
    let regressors = columns(factor, &equation.regressors);
    let pseudo = Pseudo::new(regressors.as_ref(), &norms(regressors.as_ref(), 0..regressors.ncols()))?;
    let theta = pseudo.solve(columns(factor, &[equation.target]).as_ref());
    let influence = pseudo.inverse();
    Ok(Solution {
        theta: (0..theta.nrows()).map(|i| theta[(i, 0)]).collect(),
        gain: &influence * influence.transpose(),
        influence,
        condition: pseudo.condition,
    })
}

/// The triangular factor of some columns of what `factor` is the factor of, square if they are no more than its rows.
pub fn factor_of(factor: &Mat<f64>, indices: &[usize]) -> Mat<f64> {
    upper_factor(columns(factor, indices))
}

fn columns(factor: &Mat<f64>, indices: &[usize]) -> Mat<f64> {
    Mat::from_fn(factor.nrows(), indices.len(), |i, j| factor[(i, indices[j])])
}

fn norms(matrix: MatRef<'_, f64>, range: std::ops::Range<usize>) -> Vec<f64> {
    range.map(|j| matrix.col(j).norm_l2()).collect()
}

/// The pseudo-inverse of a matrix of full column rank, by QR with scaled columns.
struct Pseudo {
    qr: Option<Qr>,
    scale: Vec<f64>,
    rows: usize,
    condition: f64,
}

impl Pseudo {
    fn new(matrix: MatRef<'_, f64>, scale: &[f64]) -> Result<Self, IdentError> {
        let (rows, count) = matrix.shape();
        let scale = scale.to_vec();
        if count == 0 {
            return Ok(Pseudo { qr: None, scale, rows, condition: 1.0 });
        }
        let scaled = |i, j| if scale[j] > 0.0 { matrix[(i, j)] / scale[j] } else { 0.0 };
        let scaled = Mat::from_fn(rows, count, scaled);
        let qr = Qr::new(scaled.as_ref());
        let condition = checked_condition(qr.r())?;
        Ok(Pseudo { qr: Some(qr), scale, rows, condition })
    }

    fn solve(&self, right: MatRef<'_, f64>) -> Mat<f64> {
        let Some(qr) = &self.qr else { return Mat::zeros(0, right.ncols()) };
        let solution = qr.least_squares(right);
        Mat::from_fn(self.scale.len(), right.ncols(), |i, j| solution[(i, j)] / self.scale[i])
    }

    fn inverse(&self) -> Mat<f64> {
        self.solve(Mat::<f64>::identity(self.rows, self.rows).as_ref())
    }
}

/// `Σ ε_i(t) ε_j(t)`, equations × equations, from the factor: no pass through the data.
fn error_products(factor: &Mat<f64>, equations: &[Equation], thetas: &[&[f64]]) -> Mat<f64> {
    let mut errors = Mat::<f64>::zeros(factor.nrows(), equations.len());
    for (i, (equation, theta)) in equations.iter().zip(thetas).enumerate() {
        for row in 0..factor.nrows() {
            let explained = equation.regressors.iter().zip(*theta).map(|(j, v)| factor[(row, *j)] * v);
            errors[(row, i)] = factor[(row, equation.target)] - explained.sum::<f64>();
        }
    }
    errors.transpose() * &errors
}

/// The covariance of the errors with degrees of freedom taken off, `parameters` an equation, and the determinant of
/// their mean product.
pub fn noise_covariance(
    factor: &Mat<f64>,
    equations: &[Equation],
    thetas: &[&[f64]],
    parameters: &[f64],
    rows: usize,
) -> (Mat<f64>, f64) {
    let products = error_products(factor, equations, thetas);
    let free: Vec<f64> = parameters.iter().map(|p| (rows as f64 - p).max(1.0)).collect();
    let count = equations.len();
    let noise = Mat::from_fn(count, count, |i, j| products[(i, j)] / (free[i] * free[j]).sqrt());
    let mean = faer::Scale(1.0 / rows as f64) * products;
    (noise, if count == 1 { mean[(0, 0)] } else { linalg::determinant(mean.as_ref()).max(0.0) })
}

/// The covariance of all parameters, equation by equation, where the errors are white: blocks `Λ_ij G_i Z_iᵀZ_j G_jᵀ`.
///
/// # Source
/// Ljung 1999, §9.3, and §9.5 for instruments.
pub fn parameter_covariance(solutions: &[Solution], noise: &Mat<f64>) -> Mat<f64> {
    let owner = owners(solutions);
    let rows: Vec<_> = solutions.iter().flat_map(|s| (0..s.theta.len()).map(|i| s.influence.row(i))).collect();
    Mat::from_fn(rows.len(), rows.len(), |i, j| noise[(owner[i], owner[j])] * (rows[i] * rows[j].transpose()))
}

/// Which equation each parameter belongs to.
fn owners(solutions: &[Solution]) -> Vec<usize> {
    solutions.iter().enumerate().flat_map(|(e, s)| std::iter::repeat_n(e, s.theta.len())).collect()
}
