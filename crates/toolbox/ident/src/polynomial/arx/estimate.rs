//! From solved equations to a fitted polynomial model.

use faer::Mat;
use lti::{PolynomialEquation, PolynomialModel};

use super::ArxOrders;
use crate::data::regression::{Regression, robust_covariance};
use crate::dense::spectral_radius;
use crate::{Doubt, Fit, IdentError, Termination};
use fitting::condition::ILL_CONDITIONED;
use fitting::equation::{Equation, Solution, noise_covariance, parameter_covariance, solve};

/// Assumption about the equation errors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Noise {
    /// White.
    White,
    /// Anything; the covariance comes from the scatter between batches.
    Coloured {
        /// Stretches of equal length.
        batches: usize,
    },
}

/// Equations solved, and the covariance of the parameters of the regression.
pub(crate) struct Solved {
    pub(crate) factor: Mat<f64>,
    solutions: Vec<Solution>,
    covariance: Mat<f64>,
    degrees_of_freedom: f64,
}

/// Solves the equations of a regression.
pub(crate) fn solve_equations(
    regression: &Regression<'_>,
    equations: &[Equation],
    noise: Noise,
) -> Result<Solved, IdentError> {
    let widest = equations.iter().map(|e| e.instruments.len().max(e.regressors.len())).max().unwrap_or(0);
    if regression.rows <= widest {
        return Err(IdentError::TooFewSamples { samples: regression.rows, parameters: widest });
    }
    let factor = regression.factor();
    let solutions = equations.iter().map(|e| solve(&factor, e)).collect::<Result<Vec<_>, _>>()?;
    let (covariance, degrees_of_freedom) = match noise {
        Noise::White => {
            let (noise, _) = errors(&factor, equations, &solutions, regression.rows);
            (parameter_covariance(&solutions, &noise), (regression.rows - widest) as f64)
        }
        Noise::Coloured { batches } => {
            (robust_covariance(regression, equations, &solutions, batches)?, batches as f64 - 1.0)
        }
    };
    Ok(Solved { factor, solutions, covariance, degrees_of_freedom })
}

/// Covariance and loss of the errors.
fn errors(factor: &Mat<f64>, equations: &[Equation], solutions: &[Solution], rows: usize) -> (Mat<f64>, f64) {
    let thetas: Vec<&[f64]> = solutions.iter().map(|s| s.theta.as_slice()).collect();
    let parameters: Vec<f64> = thetas.iter().map(|t| t.len() as f64).collect();
    noise_covariance(factor, equations, &thetas, &parameters, rows)
}

/// The ARX model whose parameters are `solved`, with its errors on `regression`, whose `factor` is given.
pub(crate) fn polynomial_fit(
    orders: &ArxOrders,
    sample_time_s: f64,
    regression: &Regression<'_>,
    factor: &Mat<f64>,
    equations: &[Equation],
    solved: &Solved,
) -> Result<Fit<PolynomialModel>, IdentError> {
    let Solved { solutions, covariance, degrees_of_freedom, .. } = solved;
    let (noise_covariance, loss) = errors(factor, equations, solutions, regression.rows);
    let model = model(orders, sample_time_s, solutions)?.with_noise_covariance(noise_covariance.clone())?;
    let condition = solutions.iter().map(|s| s.condition).fold(1.0, f64::max);
    Ok(Fit {
        covariance: with_signs(orders, covariance),
        degrees_of_freedom: *degrees_of_freedom,
        noise_covariance,
        loss,
        samples: regression.rows,
        free_parameters: orders.parameters(),
        initial_states: Vec::new(),
        levels: Vec::new(),
        termination: Termination::Direct,
        iterations: 0,
        condition,
        doubts: doubts(regression, &model, condition)?,
        origin: None,
        model,
    })
}

/// The model: coefficients of outputs change sign, since they stand on the other side of the equation.
fn model(orders: &ArxOrders, sample_time_s: f64, solutions: &[Solution]) -> Result<PolynomialModel, IdentError> {
    let outputs = orders.na.len();
    let equation = |(i, solution): (usize, &Solution)| {
        let mut theta = solution.theta.iter().copied();
        PolynomialEquation {
            a: orders.na[i].iter().map(|count| theta.by_ref().take(*count).map(|v| -v).collect()).collect(),
            b: orders.nb[i].iter().map(|count| theta.by_ref().take(*count).collect()).collect(),
            nk: orders.nk[i].clone(),
            f: vec![Vec::new(); orders.nb[i].len()],
            ..Default::default()
        }
    };
    let equations = solutions.iter().enumerate().map(equation).collect();
    Ok(PolynomialModel::new(sample_time_s, equations, Mat::identity(outputs, outputs))?)
}

fn with_signs(orders: &ArxOrders, covariance: &Mat<f64>) -> Mat<f64> {
    let sign = |i: usize| {
        let (a, b) = (orders.na[i].iter().sum(), orders.nb[i].iter().sum());
        std::iter::repeat_n(-1.0, a).chain(std::iter::repeat_n(1.0, b))
    };
    let signs: Vec<f64> = (0..orders.na.len()).flat_map(sign).collect();
    Mat::from_fn(signs.len(), signs.len(), |i, j| signs[i] * signs[j] * covariance[(i, j)])
}

fn doubts(regression: &Regression<'_>, model: &PolynomialModel, condition: f64) -> Result<Vec<Doubt>, IdentError> {
    let mut doubts = Vec::new();
    let left_out = regression.candidates - regression.rows;
    if left_out > 0 {
        doubts.push(Doubt::RowsLeftOut { rows: left_out, of: regression.candidates });
    }
    if condition > ILL_CONDITIONED {
        doubts.push(Doubt::IllConditioned { condition });
    }
    if largest_pole(model)? >= 1.0 {
        doubts.push(Doubt::Unstable);
    }
    Ok(doubts)
}

/// Largest magnitude of a pole of an ARX model; inputs are left away, since they bring no poles but zero, and many
/// states.
pub(crate) fn largest_pole(model: &PolynomialModel) -> Result<f64, IdentError> {
    let undriven = |e: &PolynomialEquation| PolynomialEquation { a: e.a.clone(), ..Default::default() };
    let equations = model.equations().iter().map(undriven).collect();
    let noise = model.noise_covariance().to_owned();
    let autonomous = PolynomialModel::new(model.sample_time_s(), equations, noise)?;
    spectral_radius(autonomous.innovations()?.system().a())
}
