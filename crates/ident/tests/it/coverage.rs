//! Intervals of prediction-error estimates hold the truth as often as they say.

use ident::{Armax, BoxJenkins, Dataset, Focus, OutputError, Polynomial};
use lti::{PolynomialEquation, PolynomialModel};

use crate::polynomials::{armax_model, bj_model, low_pass, oe_model, simulated, siso};

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
    let runs = 200;
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
    // 190 expected, deviation 3.1; the mean of standardised errors has the deviation 0.07, and estimates have a bias of
    // order 1/N against a deviation of order 1/√N.
    assert!(inside.iter().all(|n| *n >= 181 && *n <= 199), "{inside:?} {mean:?}");
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
