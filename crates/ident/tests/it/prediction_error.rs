//! Prediction-error estimates of polynomial models.

use faer::Mat;
use ident::prediction_error::{Focus, InitialState, Residuals};
use ident::{Arma, Armax, Ararx, BoxJenkins, Dataset, Experiment, Fit, IdentError, OutputError, Polynomial};
use lti::{PolynomialEquation, PolynomialModel};
use proptest::prelude::*;

use crate::noise::Noise;
use crate::shared::shared;

/// Binary input, each level held `hold` samples.
fn binary(noise: &mut Noise, samples: usize, hold: usize) -> Vec<f64> {
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

fn table(columns: &[&[f64]]) -> Mat<f64> {
    Mat::from_fn(columns.first().map_or(0, |c| c.len()), columns.len(), |i, j| columns[j][i])
}

/// The model's output under these inputs and innovations, from this state.
fn respond(model: &PolynomialModel, inputs: &[&[f64]], e: &[&[f64]], state: Option<&[f64]>) -> Mat<f64> {
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

fn siso(nk: usize, e: PolynomialEquation) -> PolynomialModel {
    PolynomialModel::siso(1.0, nk, e).unwrap()
}

fn armax_model() -> PolynomialModel {
    let (a, b, c) = (vec![vec![-1.5, 0.7]], vec![vec![1.0, 0.5]], vec![-1.0, 0.2]);
    siso(1, PolynomialEquation { a, b, c, ..Default::default() })
}

fn oe_model() -> PolynomialModel {
    siso(1, PolynomialEquation { b: vec![vec![1.0, 0.5]], f: vec![vec![-1.5, 0.7]], ..Default::default() })
}

fn bj_model() -> PolynomialModel {
    let (b, f) = (vec![vec![1.0, 0.5]], vec![vec![-1.5, 0.7]]);
    siso(1, PolynomialEquation { b, c: vec![-1.0, 0.2], d: vec![-1.2, 0.5], f, ..Default::default() })
}

fn simulated(model: &PolynomialModel, samples: usize, deviation: f64, seed: u64) -> Dataset {
    let mut noise = Noise::new(seed);
    let u = binary(&mut noise, samples, 3);
    let e: Vec<f64> = noise.normals(samples).iter().map(|v| v * deviation).collect();
    let y = respond(model, &[&u], &[&e], None);
    Dataset::siso(1.0, &u, y.col(0).try_as_col_major().unwrap().as_slice()).unwrap()
}

fn assert_close(found: &[f64], expected: &[f64], tolerance: f64) {
    assert_eq!(found.len(), expected.len());
    for (f, e) in found.iter().zip(expected) {
        assert!((f - e).abs() <= tolerance, "{found:?} differs from {expected:?}");
    }
}

#[test]
fn exact_output_error_without_noise() {
    let fit = OutputError::new(2, 2, 1).fit(&simulated(&oe_model(), 500, 0.0, 1)).unwrap();
    assert_close(&fit.parameters(), &oe_model().coefficients(), 1e-10);
}

fn read(path: &str) -> Option<Vec<Vec<f64>>> {
    let text = std::fs::read_to_string(shared(path)?).unwrap();
    let row = |line: &str| line.split(',').map(|v| v.trim().parse().unwrap()).collect::<Vec<f64>>();
    let rows: Vec<Vec<f64>> = text.lines().skip(1).filter(|l| !l.is_empty()).map(row).collect();
    Some((0..rows[0].len()).map(|j| rows.iter().map(|r| r[j]).collect()).collect())
}

fn without_mean(x: &[f64]) -> Vec<f64> {
    let mean = x.iter().sum::<f64>() / x.len() as f64;
    x.iter().map(|v| v - mean).collect()
}

fn show(name: &str, fit: &Fit<PolynomialModel>) {
    println!("{name}: {:?} {:?} loss {} in {} {:?}", fit.parameters(), fit.standard_errors(), fit.loss, fit.iterations, fit.termination);
}

#[test]
fn ref_dryer() {
    let Some(c) = read("reference/peers/dryer_slicot.csv") else { return };
    let data = Dataset::siso(0.08, &without_mean(&c[0][..500]), &without_mean(&c[1][..500])).unwrap();
    let fit = Armax::new(2, 2, 2, 3).initial_state(InitialState::Zero).fit(&data).unwrap();
    show("armax", &fit);
    let fit = OutputError::new(2, 2, 3).initial_state(InitialState::Zero).fit(&data).unwrap();
    show("oe", &fit);
}

#[test]
fn ref_others() {
    for (name, options) in [
        ("armax", Armax::new(1, 2, 1, 2)),
        ("oe", OutputError::new(2, 1, 2)),
        ("bj", BoxJenkins::new(2, 1, 1, 1, 2)),
    ] {
        let Some(c) = read(&format!("reference/peers/r_{name}sim.csv")) else { return };
        let data = Dataset::siso(1.0, &c[0], &c[1]).unwrap();
        show(name, &options.clone().initial_state(InitialState::Zero).fit(&data).unwrap());
        show(name, &options.fit(&data).unwrap());
    }
    let Some(c) = read("reference/peers/gas_furnace_seriesJ.csv") else { return };
    let data = Dataset::siso(1.0, &without_mean(&c[0]), &without_mean(&c[1])).unwrap();
    let options = BoxJenkins::new(3, 0, 2, 2, 3);
    show("furnace", &options.clone().initial_state(InitialState::Zero).fit(&data).unwrap());
    show("furnace", &options.fit(&data).unwrap());
}

#[test]
#[ignore = "slow"]
fn timing() {
    for (name, options, model) in [
        ("armax", Armax::new(2, 2, 2, 1), armax_model()),
        ("oe", OutputError::new(2, 2, 1), oe_model()),
        ("bj", BoxJenkins::new(2, 2, 2, 2, 1), bj_model()),
    ] {
        let data = simulated(&model, 1_000_000, 0.5, 7);
        for _ in 0..2 {
            let clock = std::time::Instant::now();
            let fit = options.fit(&data).unwrap();
            println!("{name} {:?}", clock.elapsed());
            show(name, &fit);
        }
    }
}
