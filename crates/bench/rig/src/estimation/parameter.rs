//! Making [`Parameter`]s and [`Estimate`]s from numbers.

use faer::Mat;
use fitting::Minimum;
use signal::distributions::interval;

use crate::results::{Estimate, Parameter, Quantity, Stretch};

/// Level of every parameter's interval.
pub const INTERVAL_LEVEL: f64 = 0.95;

/// A quantity as a function of a fit's internal parameters, in SI.
pub type ReadOut<'a> = (Quantity, &'a dyn Fn(&[f64]) -> f64);

impl Parameter {
    /// A parameter with its 95 % Student-t interval.
    pub fn new(quantity: Quantity, value: f64, standard_error: f64, degrees_of_freedom: f64) -> Self {
        Parameter {
            quantity,
            value,
            standard_error,
            degrees_of_freedom,
            interval: interval(value, standard_error, degrees_of_freedom, INTERVAL_LEVEL),
        }
    }
}

impl Estimate {
    /// Adds a systematic uncertainty that moves these quantities together and nothing else.
    pub fn add_systematic(&mut self, quantities: &[Quantity], standard_uncertainty: f64) {
        let moved: Vec<usize> = quantities.iter().filter_map(|quantity| self.place(*quantity)).collect();
        let move_of = |i: usize| if moved.contains(&i) { standard_uncertainty } else { 0.0 };
        let moves: Vec<f64> = (0..self.parameters.len()).map(move_of).collect();
        self.add_moves(&moves);
    }

    /// Adds what one unknown of unit variance does: it moves each parameter by so much.
    pub fn add_moves(&mut self, moves: &[f64]) {
        for (row, a) in self.covariance.iter_mut().zip(moves) {
            row.iter_mut().zip(moves).for_each(|(value, b)| *value += a * b);
        }
        for (i, parameter) in self.parameters.iter_mut().enumerate().filter(|(i, _)| moves.get(*i) != Some(&0.0)) {
            parameter.standard_error = self.covariance[i][i].sqrt();
            let (error, dof) = (parameter.standard_error, parameter.degrees_of_freedom);
            parameter.interval = interval(parameter.value, error, dof, INTERVAL_LEVEL);
        }
    }
}

/// Quantities as functions of a fit's internal parameters, with their covariance by the delta method.
pub fn transformed(
    outputs: &[ReadOut<'_>],
    fit: &Minimum,
    covariance: &Mat<f64>,
    degrees_of_freedom: f64,
    stretch: &Stretch,
) -> Estimate {
    let gradients: Vec<Vec<f64>> =
        outputs.iter().map(|(_, g)| fitting::covariance::gradient(&fit.parameters, covariance, g)).collect();
    let joint = |a: &[f64], b: &[f64]| {
        let n = a.len();
        (0..n).map(|i| (0..n).map(|j| a[i] * covariance[(i, j)] * b[j]).sum::<f64>()).sum::<f64>()
    };
    let matrix: Vec<Vec<f64>> = gradients.iter().map(|a| gradients.iter().map(|b| joint(a, b)).collect()).collect();
    let parameter = |(i, (quantity, g)): (usize, &ReadOut<'_>)| {
        Parameter::new(*quantity, g(&fit.parameters), matrix[i][i].max(0.0).sqrt(), degrees_of_freedom)
    };
    Estimate {
        parameters: outputs.iter().enumerate().map(parameter).collect(),
        covariance: matrix,
        stretches: vec![stretch.clone()],
        iterations: fit.iterations,
        condition: fit.condition,
    }
}
