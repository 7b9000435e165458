//! Intervals of prediction-error estimates hold the truth as often as they say.

use faer::Mat;
use ident::{Ararx, Arma, Armax, BoxJenkins, Dataset, Focus, OutputError, Polynomial};
use lti::{PolynomialEquation, PolynomialModel};

use crate::noise::Noise;
use crate::polynomials::{armax_model, binary, bj_model, low_pass, oe_model, respond, simulated, siso, table};

/// Bias and coverage over many runs: the mean of the standardised errors, and how many lie in their 95 % interval.
fn judge(options: &Polynomial, model: &PolynomialModel, samples: usize) {
    judge_part(options, model, &model.coefficients(), samples);
}

/// As [`judge`], for an estimate of these coefficients alone.
fn judge_part(options: &Polynomial, model: &PolynomialModel, truth: &[f64], samples: usize) {
    judge_data(options, truth, |seed| simulated(model, samples, 0.5, seed));
}

/// As [`judge_part`], for data of any kind.
fn judge_data(options: &Polynomial, truth: &[f64], data: impl Fn(u64) -> Dataset) {
    let runs = 1000;
    let mut inside = vec![0; truth.len()];
    let mut mean = vec![0.0; truth.len()];
    for run in 0..runs {
        let fit = options.fit(&data(1000 + run)).unwrap();
        let (values, errors, intervals) = (fit.parameters(), fit.standard_errors(), fit.intervals(0.95));
        for j in 0..truth.len() {
            inside[j] += u32::from(intervals[j].0 <= truth[j] && truth[j] <= intervals[j].1);
            mean[j] += (values[j] - truth[j]) / errors[j] / runs as f64;
        }
    }
    // 950 expected, deviation 6.9; the mean of standardised errors has the deviation 0.03, and estimates have a bias of
    // order 1/N against a deviation of order 1/√N.
    assert!(inside.iter().all(|n| *n >= 925 && *n <= 975), "{inside:?} {mean:?}");
    assert!(mean.iter().all(|m| m.abs() < 0.3), "{inside:?} {mean:?}");
}

#[test]
#[ignore = "slow"]
fn stat_box_jenkins_in_a_band_covers_the_truth() {
    judge(&BoxJenkins::new(2, 2, 2, 2, 1).with_prefilter(low_pass()), &bj_model(), 2000);
}

#[test]
#[ignore = "slow"]
fn stat_box_jenkins_by_simulation_covers_the_truth() {
    judge(&BoxJenkins::new(2, 2, 2, 2, 1).with_focus(Focus::Simulation), &bj_model(), 2000);
}

#[test]
#[ignore = "slow"]
fn stat_armax_in_a_band_covers_the_truth() {
    judge(&Armax::new(2, 2, 2, 1).with_prefilter(low_pass()), &armax_model(), 2000);
}

#[test]
#[ignore = "slow"]
fn stat_armax_by_simulation_covers_the_truth() {
    judge(&Armax::new(2, 2, 2, 1).with_focus(Focus::Simulation), &armax_model(), 2000);
}

#[test]
#[ignore = "slow"]
fn stat_armax_covers_the_truth() {
    judge(&Armax::new(2, 2, 2, 1), &armax_model(), 1000);
}

#[test]
#[ignore = "slow"]
fn stat_output_error_covers_the_truth() {
    judge(&OutputError::new(2, 2, 1), &oe_model(), 1000);
}

/// Noise that remembers tens of samples, and noise that turns with a period of eight.
#[test]
#[ignore = "slow"]
fn stat_output_error_covers_the_truth_under_coloured_noise() {
    let (b, f) = (vec![vec![1.0, 0.5]], vec![vec![-1.5, 0.7]]);
    for d in [vec![-0.95], vec![-1.2, 0.8]] {
        let truth = PolynomialEquation { b: b.clone(), f: f.clone(), d, ..Default::default() };
        judge_part(&OutputError::new(2, 2, 1), &siso(1, truth), &oe_model().coefficients(), 2000);
    }
}

#[test]
#[ignore = "slow"]
fn stat_box_jenkins_covers_the_truth() {
    judge(&BoxJenkins::new(2, 2, 2, 2, 1), &bj_model(), 2000);
}

#[test]
#[ignore = "slow"]
fn stat_ararx_covers_the_truth() {
    let (a, b, d) = (vec![vec![-1.5, 0.7]], vec![vec![1.0, 0.5]], vec![0.6]);
    let model = siso(1, PolynomialEquation { a, b, d, ..Default::default() });
    judge(&Ararx::new(2, 2, 1, 1), &model, 1000);
}

/// All five polynomials: the pole in `A` is that which noise and input share.
#[test]
#[ignore = "slow"]
fn stat_the_whole_polynomial_covers_the_truth() {
    let (a, b, f) = (vec![vec![-0.9]], vec![vec![1.0, 0.5]], vec![vec![0.6]]);
    let model = siso(1, PolynomialEquation { a, b, c: vec![0.7], d: vec![-0.3], f, nk: vec![1] });
    judge(&Polynomial::new(1, 2, 1, 1, 1, 1), &model, 3000);
}

/// Data of a model without inputs.
fn series(equation: PolynomialEquation, samples: usize) -> impl Fn(u64) -> Dataset {
    let model = PolynomialModel::new(1.0, vec![equation], Mat::identity(1, 1)).unwrap();
    move |seed| {
        let y = respond(&model, &[], &[&Noise::new(seed).normals(samples)], None);
        Dataset::new(1.0, Mat::zeros(samples, 0), y).unwrap()
    }
}

#[test]
#[ignore = "slow"]
fn stat_arma_covers_the_truth() {
    let truth = PolynomialEquation { a: vec![vec![-1.2, 0.5]], c: vec![0.6], ..Default::default() };
    judge_data(&Arma::new(2, 1), &[-1.2, 0.5, 0.6], series(truth, 2000));
}

#[test]
#[ignore = "slow"]
fn stat_autoregression_covers_the_truth() {
    let truth = PolynomialEquation { a: vec![vec![-1.2, 0.5]], ..Default::default() };
    judge_data(&Arma::new(2, 0), &[-1.2, 0.5], series(truth, 1000));
}

/// Data of a model with two inputs.
fn from_two_inputs(model: &PolynomialModel, samples: usize) -> impl Fn(u64) -> Dataset {
    move |seed| {
        let mut noise = Noise::new(seed);
        let (u, v) = (binary(&mut noise, samples, 3), binary(&mut noise, samples, 5));
        let e: Vec<f64> = noise.normals(samples).iter().map(|v| 0.5 * v).collect();
        Dataset::new(1.0, table(&[&u, &v]), respond(model, &[&u, &v], &[&e], None)).unwrap()
    }
}

#[test]
#[ignore = "slow"]
fn stat_armax_of_two_inputs_covers_the_truth() {
    let equation = PolynomialEquation {
        a: vec![vec![-1.5, 0.7]],
        b: vec![vec![1.0, 0.5], vec![-0.4]],
        nk: vec![1, 2],
        c: vec![0.4],
        f: vec![vec![], vec![]],
        ..Default::default()
    };
    let model = PolynomialModel::new(1.0, vec![equation], Mat::identity(1, 1)).unwrap();
    let options = Armax::new(2, [2, 1], 1, [1, 2]);
    judge_data(&options, &model.coefficients(), from_two_inputs(&model, 1000));
}

#[test]
#[ignore = "slow"]
fn stat_box_jenkins_of_two_inputs_covers_the_truth() {
    let equation = PolynomialEquation {
        a: vec![vec![]],
        b: vec![vec![1.0], vec![-0.4, 0.8]],
        nk: vec![1, 2],
        c: vec![0.6],
        d: vec![-0.8],
        f: vec![vec![-0.7], vec![-1.1, 0.5]],
    };
    let model = PolynomialModel::new(1.0, vec![equation], Mat::identity(1, 1)).unwrap();
    let options = BoxJenkins::new([1, 2], 1, 1, [1, 2], [1, 2]);
    judge_data(&options, &model.coefficients(), from_two_inputs(&model, 2000));
}
