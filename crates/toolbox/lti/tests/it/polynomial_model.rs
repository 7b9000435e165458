//! Polynomial models as state space, against their difference equation written out.

use faer::Mat;
use lti::{PolynomialEquation, PolynomialModel};

fn two_outputs() -> PolynomialModel {
    let first = PolynomialEquation {
        a: vec![vec![-0.6, 0.2], vec![0.3]],
        b: vec![vec![1.0, 0.5], vec![0.7, -0.2]],
        nk: vec![0, 2],
        c: vec![0.4],
        d: vec![],
        f: vec![vec![], vec![-0.5, 0.1]],
    };
    let second = PolynomialEquation {
        a: vec![vec![0.1, 0.05], vec![-0.7]],
        b: vec![vec![0.3], vec![1.5]],
        nk: vec![3, 0],
        c: vec![0.2, -0.1],
        d: vec![-0.8],
        f: vec![vec![0.2], vec![]],
    };
    PolynomialModel::new(0.1, vec![first, second], Mat::identity(2, 2)).unwrap()
}

/// `x(t − lag)`, zero before the start.
fn back(x: &[f64], t: usize, lag: usize) -> f64 {
    t.checked_sub(lag).map_or(0.0, |i| x[i])
}

/// The equations as they stand in the documentation, one sample after the other.
fn written_out(model: &PolynomialModel, u: &[Vec<f64>], e: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let samples = u[0].len();
    let mut y = vec![vec![0.0; samples]; 2];
    let mut w = vec![vec![vec![0.0; samples]; 2]; 2];
    let mut v = vec![vec![0.0; samples]; 2];
    for t in 0..samples {
        for (i, equation) in model.equations().iter().enumerate() {
            let past = |p: &[f64], x: &[f64]| (1..=p.len()).map(|lag| p[lag - 1] * back(x, t, lag)).sum::<f64>();
            for k in 0..2 {
                let driven =
                    equation.delayed_b(k).iter().enumerate().map(|(lag, b)| b * back(&u[k], t, lag)).sum::<f64>();
                w[i][k][t] = driven - past(&equation.f[k], &w[i][k]);
            }
            v[i][t] = e[i][t] + past(&equation.c, &e[i]) - past(&equation.d, &v[i]);
            y[i][t] = w[i][0][t] + w[i][1][t] + v[i][t] - past(&equation.a[0], &y[0]) - past(&equation.a[1], &y[1]);
        }
    }
    y
}

#[test]
fn exact_innovations_form_obeys_the_difference_equation() {
    let model = two_outputs();
    let form = model.innovations().unwrap();
    let mut state = 1_u64;
    let mut number = || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 33) as f64 / 2f64.powi(31) - 0.5
    };
    let mut series = || (0..2).map(|_| (0..40).map(|_| number()).collect()).collect::<Vec<Vec<f64>>>();
    let (u, e) = (series(), series());
    let table = |x: &[Vec<f64>]| Mat::from_fn(40, 2, |i, j| x[j][i]);
    let rest = vec![0.0; form.system().states()];
    let from_input = form.system().simulate(table(&u).as_ref(), &rest).unwrap();
    let from_noise = form.noise_system().unwrap().simulate(table(&e).as_ref(), &rest).unwrap();
    let expected = written_out(&model, &u, &e);
    for t in 0..40 {
        for i in 0..2 {
            let y = from_input[(t, i)] + from_noise[(t, i)];
            assert!((y - expected[i][t]).abs() < 1e-12, "sample {t} of output {i}: {y} for {}", expected[i][t]);
        }
    }
}

#[test]
fn exact_predictor_returns_the_innovations() {
    let form = two_outputs().innovations().unwrap();
    let e = Mat::from_fn(30, 2, |i, j| ((3 * i + 7 * j) as f64).sin());
    let rest = vec![0.0; form.system().states()];
    let y = form.noise_system().unwrap().simulate(e.as_ref(), &rest).unwrap();
    let seen = Mat::from_fn(30, 4, |i, j| if j < 2 { 0.0 } else { y[(i, j - 2)] });
    let predicted = form.predictor().unwrap().simulate(seen.as_ref(), &rest).unwrap();
    for t in 0..30 {
        assert!((y[(t, 1)] - predicted[(t, 1)] - e[(t, 1)]).abs() < 1e-12);
    }
}

#[test]
fn exact_transfer_function_is_the_channel_of_the_innovations_form() {
    let equation = PolynomialEquation {
        a: vec![vec![-1.5, 0.7]],
        b: vec![vec![1.0, 0.5]],
        c: vec![-1.0, 0.2],
        d: vec![0.3],
        f: vec![vec![-0.4]],
        nk: vec![],
    };
    let model = PolynomialModel::siso(0.01, 2, equation).unwrap();
    let omega = [0.1, 10.0, 100.0, 300.0];
    let form = model.innovations().unwrap();
    let pairs = [
        (model.transfer_function(0, 0).unwrap(), form.system().clone()),
        (model.noise_transfer_function(0).unwrap(), form.noise_system().unwrap()),
    ];
    for (ratio, system) in pairs {
        let (a, b) = (ratio.frequency_response(&omega).unwrap(), system.frequency_response(0, 0, &omega).unwrap());
        for (x, y) in a.response.iter().zip(&b.response) {
            assert!((x - y).norm() < 1e-12 * x.norm());
        }
    }
}

#[test]
fn exact_names_follow_the_coefficients() {
    let names = two_outputs().coefficient_names();
    assert_eq!(names.len(), two_outputs().coefficients().len());
    assert_eq!(&names[..5], ["a1[1,1]", "a2[1,1]", "a1[1,2]", "b0[1,1]", "b1[1,1]"]);
    let model = two_outputs();
    assert_eq!(model.with_coefficients(&model.coefficients()).unwrap(), model);
    assert!(model.with_coefficients(&[1.0]).is_err());
}
