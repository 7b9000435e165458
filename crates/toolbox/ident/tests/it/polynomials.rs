//! Polynomial models with known truth for the tests, and their data.

use faer::Mat;
use ident::Dataset;
use lti::{PolynomialEquation, PolynomialModel};

use crate::noise::Noise;

/// Binary input, each level held `hold` samples.
pub(crate) fn binary(noise: &mut Noise, samples: usize, hold: usize) -> Vec<f64> {
    let mut level = 1.0;
    (0..samples)
        .map(|t| {
            if t % hold == 0 {
                level = if noise.uniform() < 0.5 { -1.0 } else { 1.0 };
            }
            level
        })
        .collect()
}

pub(crate) fn table(columns: &[&[f64]]) -> Mat<f64> {
    Mat::from_fn(columns.first().map_or(0, |c| c.len()), columns.len(), |i, j| columns[j][i])
}

/// The model's output under these inputs and innovations, from this state.
pub(crate) fn respond(model: &PolynomialModel, inputs: &[&[f64]], e: &[&[f64]], state: Option<&[f64]>) -> Mat<f64> {
    let form = model.innovations().unwrap();
    let (n, m) = (form.system().states(), inputs.len());
    let zeros = vec![0.0; n];
    let x0 = state.unwrap_or(&zeros);
    let zero = vec![0.0; n];
    let u = if m == 0 { Mat::zeros(e[0].len(), 0) } else { table(inputs) };
    let from_u = form.system().simulate(u.as_ref(), x0).unwrap();
    let from_e = form.noise_system().unwrap().simulate(table(e).as_ref(), &zero).unwrap();
    from_u + from_e
}

pub(crate) fn siso(nk: usize, e: PolynomialEquation) -> PolynomialModel {
    PolynomialModel::siso(1.0, nk, e).unwrap()
}

pub(crate) fn armax_model() -> PolynomialModel {
    let (a, b, c) = (vec![vec![-1.5, 0.7]], vec![vec![1.0, 0.5]], vec![-1.0, 0.2]);
    siso(1, PolynomialEquation { a, b, c, ..Default::default() })
}

pub(crate) fn oe_model() -> PolynomialModel {
    siso(1, PolynomialEquation { b: vec![vec![1.0, 0.5]], f: vec![vec![-1.5, 0.7]], ..Default::default() })
}

pub(crate) fn bj_model() -> PolynomialModel {
    let (b, f) = (vec![vec![1.0, 0.5]], vec![vec![-1.5, 0.7]]);
    siso(1, PolynomialEquation { b, c: vec![-1.0, 0.2], d: vec![-1.2, 0.5], f, ..Default::default() })
}

pub(crate) fn simulated(model: &PolynomialModel, samples: usize, deviation: f64, seed: u64) -> Dataset {
    let mut noise = Noise::new(seed);
    let u = binary(&mut noise, samples, 3);
    let e: Vec<f64> = noise.normals(samples).iter().map(|v| v * deviation).collect();
    let y = respond(model, &[&u], &[&e], None);
    Dataset::siso(1.0, &u, y.col(0).try_as_col_major().unwrap().as_slice()).unwrap()
}

pub(crate) fn column(m: &Mat<f64>, j: usize) -> Vec<f64> {
    (0..m.nrows()).map(|i| m[(i, j)]).collect()
}

/// A low-pass filter over the poles of the models above.
pub(crate) fn low_pass() -> signal::filter::Sos {
    signal::filter::Sos::butterworth_lowpass(4, 0.25, 1.0).unwrap()
}
