//! Prediction-error estimates of several outputs, whose noise has something in common.

use faer::Mat;
use ident::{Armax, BoxJenkins, Dataset, Focus, OutputError, Polynomial};
use lti::{PolynomialEquation, PolynomialModel};

use crate::noise::Noise;
use crate::polynomials::{binary, bj_model, low_pass, respond, simulated, table};

/// A second output three times the first brings no news: its coefficients are those of the first with gains three times
/// as large, and they vary together.
#[test]
fn exact_an_output_that_is_three_times_another_varies_with_it() {
    let single = simulated(&bj_model(), 1500, 0.5, 17);
    let (u, y) = (single.experiments()[0].input(0), single.experiments()[0].output(0));
    let thrice: Vec<f64> = y.iter().map(|v| 3.0 * v).collect();
    let double = Dataset::new(1.0, table(&[u]), table(&[y, &thrice])).unwrap();
    let bj = BoxJenkins::new(2, 2, 2, 2, 1);
    for options in [
        Armax::new(3, 2, 2, 1),
        OutputError::new(2, 2, 1),
        OutputError::new(2, 2, 1).robust(20),
        bj.clone().with_focus(Focus::Simulation),
        bj.clone().with_prefilter(low_pass()),
        bj,
    ] {
        let (one, two) = (options.fit(&single).unwrap(), options.fit(&double).unwrap());
        let (n, names) = (one.parameters().len(), one.model.coefficient_names());
        assert!((one.degrees_of_freedom / two.degrees_of_freedom - 1.0).abs() < 1e-9);
        let gain = |i: usize| if i >= n && names[i % n].starts_with('b') { 3.0 } else { 1.0 };
        for (i, j) in (0..2 * n).flat_map(|i| (0..2 * n).map(move |j| (i, j))) {
            let size = (one.covariance[(i % n, i % n)] * one.covariance[(j % n, j % n)]).sqrt();
            let found = two.covariance[(i, j)] / (gain(i) * gain(j));
            assert!((found - one.covariance[(i % n, j % n)]).abs() < 1e-4 * size, "{options:?}: {i} {j}");
        }
    }
}

/// Two outputs of one input whose innovations have the correlation 0.9.
fn correlated(first: PolynomialEquation, second: PolynomialEquation) -> impl Fn(u64) -> Dataset {
    let model = PolynomialModel::new(1.0, vec![first, second], Mat::identity(2, 2)).unwrap();
    move |seed| {
        let mut noise = Noise::new(seed);
        let u = binary(&mut noise, 600, 3);
        let (e, own) = (noise.normals(600), noise.normals(600));
        let other: Vec<f64> = e.iter().zip(own).map(|(e, v)| 0.9 * e + 0.19_f64.sqrt() * v).collect();
        let y = respond(&model, &[&u], &[&e, &other], None);
        Dataset::new(1.0, table(&[&u]), y).unwrap()
    }
}

/// Sums and differences of like coefficients of both outputs lie in their 95 % intervals as often as they should.
fn judge(options: &Polynomial, truth: &[f64], data: impl Fn(u64) -> Dataset) {
    let (runs, n) = (200, truth.len() / 2);
    let mut inside = vec![0; 2 * n];
    for run in 0..runs {
        let fit = options.fit(&data(3000 + run)).unwrap();
        let (values, p) = (fit.parameters(), &fit.covariance);
        for (k, sign) in [1.0, -1.0].into_iter().enumerate() {
            for j in 0..n {
                let error = values[j] - truth[j] + sign * (values[n + j] - truth[n + j]);
                let variance = p[(j, j)] + p[(n + j, n + j)] + 2.0 * sign * p[(j, n + j)];
                let quantile = ident::distributions::student_t_quantile(0.975, fit.degrees_of_freedom);
                inside[k * n + j] += u32::from(error.abs() < quantile * variance.sqrt());
            }
        }
    }
    // 190 expected, deviation 3.1.
    assert!(inside.iter().all(|count| (181..=199).contains(count)), "{inside:?}");
}

#[test]
#[ignore = "slow"]
fn stat_armax_of_two_outputs_covers_sums_and_differences() {
    let equation = |output: usize, a: f64, b: f64, c: f64| {
        let mut all = vec![vec![], vec![]];
        all[output] = vec![a];
        PolynomialEquation { a: all, b: vec![vec![b]], nk: vec![1], c: vec![c], f: vec![vec![]], d: vec![] }
    };
    let data = correlated(equation(0, -0.7, 1.0, 0.4), equation(1, -0.6, 0.8, 0.3));
    judge(&Armax::new(1, 1, 1, 1), &[-0.7, 1.0, 0.4, -0.6, 0.8, 0.3], data);
}

/// Output errors that remember, so that the covariance has to be that of coloured errors.
#[test]
#[ignore = "slow"]
fn stat_output_error_of_two_outputs_covers_sums_and_differences() {
    let equation = |b: f64, d: f64, f: f64| PolynomialEquation {
        a: vec![vec![], vec![]],
        b: vec![vec![b]],
        nk: vec![1],
        c: vec![],
        d: vec![d],
        f: vec![vec![f]],
    };
    for options in [OutputError::new(1, 1, 1), OutputError::new(1, 1, 1).robust(20)] {
        let data = correlated(equation(1.0, -0.8, -0.7), equation(0.8, -0.7, -0.6));
        judge(&options, &[1.0, -0.7, 0.8, -0.6], data);
    }
}

/// An output that is missing now and then takes nothing from what both have in common elsewhere.
#[test]
fn stat_outputs_with_gaps_of_their_own() {
    let equation = |f: f64| PolynomialEquation {
        a: vec![vec![], vec![]],
        b: vec![vec![1.0]],
        nk: vec![1],
        c: vec![],
        d: vec![],
        f: vec![vec![f]],
    };
    let whole = correlated(equation(-0.7), equation(-0.7))(5);
    let record = &whole.experiments()[0];
    let blank = |t: usize, k: usize| (k == 0 && t.is_multiple_of(3)) || (k == 1 && (300..330).contains(&t));
    let y = Mat::from_fn(600, 2, |t, k| if blank(t, k) { f64::NAN } else { record.outputs[(t, k)] });
    let gappy = Dataset::new(1.0, record.inputs.clone(), y).unwrap();
    for options in [OutputError::new(1, 1, 1), OutputError::new(1, 1, 1).robust(60)] {
        let (all, some) = (options.fit(&whole).unwrap(), options.fit(&gappy).unwrap());
        for (fit, common) in [(&all, 0.9), (&some, 0.9 * (2.0_f64 / 3.0 * 0.95).sqrt())] {
            let p = &fit.covariance;
            let correlation = p[(0, 2)] / (p[(0, 0)] * p[(2, 2)]).sqrt();
            assert!((correlation - common).abs() < 0.15, "{options:?}: {correlation} {common}");
        }
    }
}
