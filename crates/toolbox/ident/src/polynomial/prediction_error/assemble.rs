//! The equations of all outputs put together.

use faer::Mat;
use lti::PolynomialModel;
use numerics::linalg;

use super::equation::Equation;
use super::orders::Orders;
use super::stability_boundary;
use super::unseen_modes;
use super::{joint, noise_roots};
use crate::{Dataset, Doubt, Fit, IdentError, Termination};
use fitting::condition::ILL_CONDITIONED;

/// The model of these coefficients, one list an equation, with noise of variance one.
pub(super) fn model(orders: &Orders, data: &Dataset, thetas: &[Vec<f64>]) -> Result<PolynomialModel, IdentError> {
    let outputs = thetas.len();
    let equations = thetas.iter().enumerate().map(|(i, theta)| orders.equation(theta, i, outputs)).collect();
    Ok(PolynomialModel::new(data.sample_time_s(), equations, Mat::identity(outputs, outputs))?)
}

pub(super) fn fit(
    orders: &Orders,
    data: &Dataset,
    equations: Vec<Equation<'_>>,
) -> Result<Fit<PolynomialModel>, IdentError> {
    let thetas: Vec<Vec<f64>> = equations.iter().map(|e| e.theta.clone()).collect();
    let (moments, rows) = error_moments(&equations);
    if rows == 0 {
        return Err(IdentError::TooFewSamples { samples: 0, parameters: orders.count() });
    }
    let taken: Vec<f64> = equations.iter().map(spent).collect();
    let outputs = equations.len();
    // The geometric mean keeps the matrix a covariance where equations spend different numbers of parameters.
    let left = |i: usize| (rows as f64 - taken[i]).max(1.0).sqrt();
    let noise_covariance = Mat::from_fn(outputs, outputs, |i, j| moments[(i, j)] / (left(i) * left(j)));
    // Rounding may take the determinant of a singular covariance below zero.
    let loss = linalg::determinant((faer::Scale(1.0 / rows as f64) * &moments).as_ref()).max(0.0);
    let free = |e: &Equation<'_>| e.lowest.at_bound.iter().filter(|b| !**b).count();
    let stages: Vec<&[joint::Stage<'_>]> = equations.iter().map(|e| e.stages.as_slice()).collect();
    let (mut covariance, degrees_of_freedom) = joint::covariance(&stages, data)?;
    let mut doubts = doubts(orders, &equations, data, rows)?;
    let at_edge: Vec<usize> = doubts.iter().flat_map(|doubt| noise_roots::at_edge(orders, doubt)).collect();
    for place in at_edge {
        covariance.row_mut(place).fill(0.0);
        covariance.col_mut(place).fill(0.0);
        doubts.push(Doubt::AtBound { parameter: place });
    }
    for (output, theta) in thetas.iter().enumerate() {
        let (first, count) = (output * orders.count(), orders.count());
        let own = covariance.as_ref().submatrix(first, first, count, count);
        let is_said =
            doubts.iter().any(|d| matches!(d, Doubt::RootAtEdge { output: of, polynomial: 'C', .. } if *of == output));
        if !is_said && noise_roots::is_uncertain(orders, theta, own, rows)? {
            doubts.push(Doubt::UncertainNoiseModel { output });
        }
    }
    let experiments = data.experiments().len();
    let state = |m: usize| equations.iter().flat_map(|e| e.states[m].iter().copied()).collect();
    Ok(Fit {
        model: model(orders, data, &thetas)?.with_noise_covariance(noise_covariance.clone())?,
        covariance,
        degrees_of_freedom,
        noise_covariance,
        loss,
        samples: rows,
        free_parameters: equations.iter().map(free).sum(),
        initial_states: (0..experiments).map(state).collect(),
        levels: Vec::new(),
        termination: termination(&equations),
        iterations: equations.iter().map(|e| e.lowest.iterations).max().unwrap_or(0),
        condition: equations.iter().map(|e| e.lowest.condition).fold(1.0, f64::max),
        doubts,
        origin: None,
    }
    .doubting(data))
}

/// Parameters and initial states estimated for an equation.
fn spent(equation: &Equation<'_>) -> f64 {
    (equation.lowest.at_bound.iter().filter(|b| !**b).count() + equation.state_parameters) as f64
}

/// Σ ε(t) ε(t)ᵀ over the rows in which every output has an error, and their number.
fn error_moments(equations: &[Equation<'_>]) -> (Mat<f64>, usize) {
    let n = equations.len();
    let (mut moments, mut rows) = (Mat::zeros(n, n), 0);
    let experiments = equations.first().map_or(0, |e| e.errors.len());
    for m in 0..experiments {
        for t in 0..equations[0].errors[m].len() {
            if equations.iter().any(|e| e.errors[m][t].is_nan()) {
                continue;
            }
            rows += 1;
            for i in 0..n {
                for j in 0..n {
                    moments[(i, j)] += equations[i].errors[m][t] * equations[j].errors[m][t];
                }
            }
        }
    }
    (moments, rows)
}

/// That of the equation that ended worst.
fn termination(equations: &[Equation<'_>]) -> Termination {
    let ends = equations.iter().map(|e| e.lowest.termination);
    let worse = |a: Termination, b: Termination| if a.converged() { b } else { a };
    ends.reduce(worse).unwrap_or(Termination::Direct)
}

fn doubts(orders: &Orders, equations: &[Equation<'_>], data: &Dataset, rows: usize) -> Result<Vec<Doubt>, IdentError> {
    let of = data.samples();
    let mut doubts = Vec::new();
    for (output, equation) in equations.iter().enumerate().filter(|(_, e)| !e.lowest.termination.converged()) {
        let reason = stability_boundary::reason(orders, equation, output)?.unwrap_or(Doubt::NotConverged);
        if !doubts.contains(&reason) {
            doubts.push(reason);
        }
    }
    let condition = equations.iter().map(|e| e.lowest.condition).fold(1.0, f64::max);
    if condition > ILL_CONDITIONED {
        doubts.push(Doubt::IllConditioned { condition });
    }
    if rows < of {
        doubts.push(Doubt::RowsLeftOut { rows: of - rows, of });
    }
    if equations.iter().any(|e| !e.stable) {
        doubts.push(Doubt::Unstable);
    }
    for (output, equation) in equations.iter().enumerate() {
        doubts.extend(unseen_modes::doubts(orders, equation, data, output)?);
    }
    Ok(doubts)
}
