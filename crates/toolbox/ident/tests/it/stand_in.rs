//! A least-squares ARX of one output written as plainly as it can be, to test what judges estimates.

use faer::Mat;
use ident::least_squares::solve_triangle;
use ident::{Dataset, Doubt, Fit, IdentError, Termination, Triangle};
use lti::{PolynomialEquation, PolynomialModel};

/// Orders of A and of every B; a delay of one sample.
pub(crate) fn arx(data: &Dataset, na: usize, nb: usize) -> Result<Fit<PolynomialModel>, IdentError> {
    if data.outputs() != 1 {
        return Err(IdentError::Length { what: "outputs", expected: 1, found: data.outputs() });
    }
    let inputs = data.inputs();
    let d = na + nb * inputs;
    let mut triangle = Triangle::new(d + 1);
    let mut left_out = 0;
    for record in data.experiments() {
        for t in na.max(nb)..record.len() {
            let past = (1..=na).map(|lag| -record.output(0)[t - lag]);
            let driven = (0..inputs).flat_map(|k| (1..=nb).map(move |lag| record.input(k)[t - lag]));
            let row: Vec<f64> = past.chain(driven).chain([record.output(0)[t]]).collect();
            if row.iter().all(|v| v.is_finite()) {
                triangle.push_row(&row);
            } else {
                left_out += 1;
            }
        }
    }
    if triangle.rows() <= d {
        return Err(IdentError::TooFewSamples { samples: triangle.rows(), parameters: d });
    }
    let samples = triangle.rows();
    let fit = solve_triangle(triangle)?;
    if let Some(index) = fit.parameters.iter().position(|v| !v.is_finite()) {
        return Err(IdentError::NotFinite { what: "a parameter", index });
    }
    let equation = PolynomialEquation {
        a: vec![fit.parameters[..na].to_vec()],
        b: (0..inputs).map(|k| fit.parameters[na + k * nb..na + (k + 1) * nb].to_vec()).collect(),
        nk: vec![1; inputs],
        f: vec![vec![]; inputs],
        ..Default::default()
    };
    let noise = Mat::full(1, 1, fit.noise_variance());
    let rows = samples + left_out;
    Ok(Fit {
        model: PolynomialModel::new(data.sample_time_s(), vec![equation], noise.clone())?,
        covariance: fit.covariance(),
        degrees_of_freedom: fit.degrees_of_freedom(),
        noise_covariance: noise,
        loss: fit.cost / samples as f64,
        samples,
        free_parameters: d,
        initial_states: Vec::new(),
        levels: Vec::new(),
        termination: Termination::Direct,
        iterations: 0,
        condition: fit.condition,
        doubts: if left_out > 0 { vec![Doubt::RowsLeftOut { rows: left_out, of: rows }] } else { Vec::new() },
        origin: None,
    })
}
