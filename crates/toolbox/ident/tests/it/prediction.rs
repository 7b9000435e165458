//! Simulation, prediction and initial states.

use faer::{Mat, mat};
use ident::prediction::{InitialState, predict, residuals, simulate};
use ident::{Dataset, IdentError, Intersample, LinearModel};
use lti::{Innovations, PolynomialEquation, PolynomialModel, StateSpace};
use proptest::prelude::*;
use testkit::system;

use crate::noise::Noise;

fn largest_difference(a: &Mat<f64>, b: &Mat<f64>) -> f64 {
    (0..a.ncols()).flat_map(|j| (0..a.nrows()).map(move |i| (a[(i, j)] - b[(i, j)]).abs())).fold(0.0, f64::max)
}

/// The prediction from the definition: the state after sample t − k, then k − 1 steps without measurements.
fn by_definition(form: &Innovations, data: &Dataset, horizon: usize, x0: &[f64]) -> Mat<f64> {
    let (record, system) = (&data.experiments()[0], form.system());
    let (n, samples) = (system.states(), record.len());
    let row = |m: &Mat<f64>, t: usize| Mat::from_fn(m.ncols(), 1, |j, _| m[(t, j)]);
    // filtered[t] is the state at t that measurements before t give.
    let mut filtered = vec![Mat::from_fn(n, 1, |i, _| x0[i])];
    for t in 0..samples {
        let x = &filtered[t];
        let e = row(&record.outputs, t) - system.c() * x - system.d() * row(&record.inputs, t);
        filtered.push(system.a() * x + system.b() * row(&record.inputs, t) + form.k() * e);
    }
    let mut predicted = Mat::zeros(samples, system.outputs());
    for t in 0..samples {
        let known = (t + 1).saturating_sub(horizon);
        let mut x = filtered[known].clone();
        for s in known..t {
            x = system.a() * x + system.b() * row(&record.inputs, s);
        }
        let y = system.c() * x + system.d() * row(&record.inputs, t);
        (0..system.outputs()).for_each(|i| predicted[(t, i)] = y[(i, 0)]);
    }
    predicted
}

#[test]
fn exact_k_step_prediction_follows_its_definition() {
    let model = system::arx_two_by_two().unwrap();
    let data = system::data(&model, system::SAMPLE_TIME_S, 80, 1.0, 3).unwrap();
    let form = model.innovations().unwrap();
    let x0: Vec<f64> = (0..form.system().states()).map(|i| 0.3 * i as f64 - 0.5).collect();
    for horizon in [1, 2, 3, 7, 40, 200] {
        let given = InitialState::Given(vec![x0.clone()]);
        let predicted = predict(&model, &data, horizon, &given).unwrap();
        let expected = by_definition(&form, &data, horizon, &x0);
        assert!(largest_difference(&predicted.outputs[0], &expected) < 1e-11, "{horizon}");
    }
}

#[test]
fn exact_long_horizon_is_simulation() {
    let model = system::box_jenkins().unwrap();
    let data = system::data(&model, system::SAMPLE_TIME_S, 300, 1.0, 4).unwrap();
    let predicted = predict(&model, &data, 300, &InitialState::Zero).unwrap();
    let simulated = simulate(&model, &data, &InitialState::Zero).unwrap();
    assert!(largest_difference(&predicted.outputs[0], &simulated.outputs[0]) < 1e-11);
}

/// Ljung 1999, §3.2: for `y(t) = e(t) + c e(t−1) − a y(t−1)` the k-step predictor is
/// `(c − a)(−a)^{k−1} / (1 + c q⁻¹) y(t−k)`.
#[test]
fn exact_armax_first_order_predictor_is_the_one_by_hand() {
    let (a, c) = (-0.8, 0.4);
    let equation = PolynomialEquation { a: vec![vec![a]], c: vec![c], ..Default::default() };
    let model = PolynomialModel::new(1.0, vec![equation], Mat::full(1, 1, 1.0)).unwrap();
    let y = Noise::new(2).normals(60);
    let data = Dataset::new(1.0, Mat::zeros(60, 0), Mat::from_fn(60, 1, |t, _| y[t])).unwrap();
    for k in [1_usize, 2, 5] {
        let predicted = predict(&model, &data, k, &InitialState::Zero).unwrap();
        let mut by_hand = vec![0.0; 60];
        for t in k..60 {
            by_hand[t] = (c - a) * (-a).powi(k as i32 - 1) * y[t - k] - c * by_hand[t - 1];
        }
        for t in k..60 {
            assert!((predicted.outputs[0][(t, 0)] - by_hand[t]).abs() < 1e-12, "{k} {t}");
        }
    }
}

#[test]
fn exact_residuals_of_the_truth_are_its_noise() {
    let model = system::armax().unwrap();
    let u = system::white(400, 1, 9);
    let form = model.innovations().unwrap();
    let e = system::white(400, 1, 10);
    let rest = vec![0.0; form.system().states()];
    let y = form.system().simulate(u.as_ref(), &rest).unwrap()
        + form.noise_system().unwrap().simulate(e.as_ref(), &rest).unwrap();
    let data = Dataset::new(system::SAMPLE_TIME_S, u, y).unwrap();
    let found = residuals(&model, &data, &InitialState::Zero).unwrap();
    assert!(largest_difference(&found.outputs[0], &e) < 1e-12);
}

#[test]
fn exact_initial_state_is_recovered_in_simulation_and_prediction() {
    let form = system::two_mass_sampled().unwrap();
    let x0 = [0.02, 10.0, 3.0];
    let u = system::white(500, 2, 5);
    let y = form.system().simulate(u.as_ref(), &x0).unwrap();
    let data = Dataset::new(1e-3, u, y.clone()).unwrap();
    for response in [
        simulate(&form, &data, &InitialState::Estimated).unwrap(),
        predict(&form, &data, 1, &InitialState::Estimated).unwrap(),
    ] {
        for (found, truth) in response.initial_states[0].iter().zip(&x0) {
            assert!((found - truth).abs() < 1e-10 * truth.abs().max(1e-2), "{found} {truth}");
        }
        assert!(largest_difference(&response.outputs[0], &y) < 1e-10);
    }
}

/// Outputs of unequal noise, of a model whose dynamics are not quite right.
#[test]
fn exact_without_a_noise_model_prediction_is_simulation() {
    let form = system::two_mass_sampled().unwrap();
    let system = form.system();
    let mut noise = Noise::new(9);
    let u = system::white(400, system.inputs(), 6);
    let exact = system.simulate(u.as_ref(), &[0.02, 10.0, 3.0]).unwrap();
    let y = Mat::from_fn(400, exact.ncols(), |t, i| exact[(t, i)] * 1.1 + (1.0 + 9.0 * i as f64) * noise.normal());
    let data = Dataset::new(1e-3, u, y).unwrap();
    let plain = Innovations::new(
        system.clone(),
        Mat::zeros(system.states(), system.outputs()),
        Mat::from_fn(system.outputs(), system.outputs(), |i, j| if i == j { 1.0 + 80.0 * i as f64 } else { 0.0 }),
    )
    .unwrap();
    let simulated = simulate(&plain, &data, &InitialState::Estimated).unwrap();
    let predicted = predict(&plain, &data, 1, &InitialState::Estimated).unwrap();
    assert!(largest_difference(&simulated.outputs[0], &predicted.outputs[0]) < 1e-9);
}

/// Modes that grow and modes that decay by ten orders of magnitude over the record, in mixed coordinates.
#[test]
fn exact_initial_state_of_a_system_with_an_unstable_mode() {
    let mixing = mat![[1.0, 0.5, -0.3], [0.2, 1.0, 0.4], [-0.6, 0.1, 1.0]];
    let inverse = faer::linalg::solvers::DenseSolveCore::inverse(&mixing.partial_piv_lu());
    let modes = mat![[1.12, 0.0, 0.0], [0.0, 0.9, 0.3], [0.0, -0.3, 0.9]];
    let a = &mixing * modes * inverse;
    let system = StateSpace::discrete(a, mat![[1.0], [0.5], [2.0]], mat![[1.0, 1.0, 0.5]], mat![[0.0]], 1.0).unwrap();
    let form = Innovations::output_error(system, Mat::full(1, 1, 1.0)).unwrap();
    let (u, x0) = (system::white(200, 1, 8), [1.0, -2.0, 0.5]);
    let y = form.system().simulate(u.as_ref(), &x0).unwrap();
    let data = Dataset::new(1.0, u, y.clone()).unwrap();
    let response = simulate(&form, &data, &InitialState::Estimated).unwrap();
    let size = (0..200).map(|t| y[(t, 0)].abs()).fold(0.0, f64::max);
    assert!(size > 1e9);
    assert!(largest_difference(&response.outputs[0], &y) < 1e-10 * size, "{:?}", response.initial_states);
}

#[test]
fn exact_integrator_keeps_its_offset() {
    let sum = StateSpace::discrete(mat![[1.0]], mat![[1.0]], mat![[1.0]], mat![[0.0]], 1.0).unwrap();
    let form = Innovations::output_error(sum, Mat::full(1, 1, 1.0)).unwrap();
    let y = Mat::from_fn(1000, 1, |t, _| 7.0 + t as f64);
    let data = Dataset::new(1.0, Mat::full(1000, 1, 1.0), y).unwrap();
    let response = simulate(&form, &data, &InitialState::Estimated).unwrap();
    assert!((response.initial_states[0][0] - 7.0).abs() < 1e-10);
}

#[test]
fn exact_least_squares_state_is_the_minimum() {
    let model = system::output_error().unwrap();
    let data = system::data(&model, system::SAMPLE_TIME_S, 200, 1.0, 6).unwrap();
    let cost = |initial: &InitialState, horizon: Option<usize>| {
        let response = match horizon {
            None => simulate(&model, &data, initial).unwrap(),
            Some(k) => predict(&model, &data, k, initial).unwrap(),
        };
        let error = &data.experiments()[0].outputs - &response.outputs[0];
        (error.squared_norm_l2(), response.initial_states)
    };
    for horizon in [None, Some(1)] {
        let (best, states) = cost(&InitialState::Estimated, horizon);
        for j in 0..states[0].len() {
            for step in [-1e-3, 1e-3] {
                let mut other = states.clone();
                other[0][j] += step;
                assert!(cost(&InitialState::Given(other), horizon).0 > best);
            }
        }
    }
}

/// A missing output of a first-order model: the filter must give what the Kalman filter gives by hand.
#[test]
fn exact_missing_output_follows_the_kalman_filter_by_hand() {
    let (a, k) = (0.9, 0.5);
    let system = StateSpace::discrete(mat![[a]], Mat::zeros(1, 0), mat![[1.0]], Mat::zeros(1, 0), 1.0).unwrap();
    let form = Innovations::new(system, mat![[k]], mat![[2.0]]).unwrap();
    let mut y = Noise::new(3).normals(30);
    y[5] = f64::NAN;
    y[6] = f64::NAN;
    let data = Dataset::new(1.0, Mat::zeros(30, 0), Mat::from_fn(30, 1, |t, _| y[t])).unwrap();
    let predicted = predict(&form, &data, 1, &InitialState::Given(vec![vec![0.3]])).unwrap();
    let (mut x, mut p) = (0.3, 0.0);
    for t in 0..30 {
        assert!((predicted.outputs[0][(t, 0)] - x).abs() < 1e-12, "{t}");
        if y[t].is_nan() {
            (x, p) = (a * x, a * a * p + k * k * 2.0);
        } else {
            let gain = (a * p + k * 2.0) / (p + 2.0);
            (x, p) = (a * x + gain * (y[t] - x), a * a * p + k * k * 2.0 - gain * gain * (p + 2.0));
        }
    }
}

#[test]
fn stat_gap_costs_no_more_than_it_must() {
    let model = system::armax().unwrap();
    let (mut with_gaps, mut complete) = (0.0, 0.0);
    for seed in 0..20 {
        let data = system::data(&model, system::SAMPLE_TIME_S, 500, 1.0, seed).unwrap();
        let record = data.experiments()[0].clone();
        let mut outputs = record.outputs.clone();
        (0..500).filter(|t| t % 10 == 3).for_each(|t| outputs[(t, 0)] = f64::NAN);
        let gaps = Dataset::new(system::SAMPLE_TIME_S, record.inputs, outputs).unwrap();
        let sum = |data: &Dataset| {
            let e = residuals(&model, data, &InitialState::Zero).unwrap().outputs.remove(0);
            (0..500).filter(|t| t % 10 == 9).map(|t| e[(t, 0)].powi(2)).sum::<f64>()
        };
        with_gaps += sum(&gaps);
        complete += sum(&data);
    }
    assert!(with_gaps / complete < 1.05, "{}", with_gaps / complete);
}

#[test]
fn exact_one_of_two_outputs_missing_still_corrects_the_state() {
    let model = system::arx_two_by_two().unwrap();
    let data = system::data(&model, system::SAMPLE_TIME_S, 2000, 1.0, 12).unwrap();
    let record = data.experiments()[0].clone();
    let variance = |keep: [bool; 2]| {
        let outputs = Mat::from_fn(2000, 2, |t, i| if keep[i] || t < 20 { record.outputs[(t, i)] } else { f64::NAN });
        let part = Dataset::new(system::SAMPLE_TIME_S, record.inputs.clone(), outputs).unwrap();
        let predicted = predict(&model, &part, 1, &InitialState::Zero).unwrap().outputs.remove(0);
        (0..2000).map(|t| (predicted[(t, 0)] - record.outputs[(t, 0)]).powi(2)).sum::<f64>() / 2000.0
    };
    let (both, second_only, none) = (variance([true, true]), variance([false, true]), variance([false, false]));
    assert!(both < second_only && second_only < none, "{both} {second_only} {none}");
}

#[test]
fn exact_several_experiments_each_have_their_state() {
    let model = system::arx().unwrap();
    let data = system::experiments(&model, system::SAMPLE_TIME_S, &[100, 50, 70], 1.0, 2).unwrap();
    let whole = residuals(&model, &data, &InitialState::Estimated).unwrap();
    for (i, record) in data.experiments().iter().enumerate() {
        let alone = Dataset::new(system::SAMPLE_TIME_S, record.inputs.clone(), record.outputs.clone()).unwrap();
        let response = residuals(&model, &alone, &InitialState::Estimated).unwrap();
        assert_eq!(response.outputs[0], whole.outputs[i]);
        assert_eq!(response.initial_states[0], whole.initial_states[i]);
    }
}

#[test]
fn regress_unusable_calls_are_errors() {
    let model = system::arx().unwrap();
    let data = system::data(&model, system::SAMPLE_TIME_S, 20, 1.0, 1).unwrap();
    assert!(matches!(predict(&model, &data, 0, &InitialState::Zero), Err(IdentError::Structure { .. })));
    let few = InitialState::Given(vec![vec![0.0]]);
    assert!(matches!(simulate(&model, &data, &few), Err(IdentError::Length { .. })));
    let mut u = system::white(20, 1, 1);
    u[(7, 0)] = f64::NAN;
    let missing = Dataset::new(system::SAMPLE_TIME_S, u, Mat::zeros(20, 1)).unwrap();
    let expected = IdentError::MissingInput { experiment: 0, channel: "u".into(), index: 7 };
    assert_eq!(simulate(&model, &missing, &InitialState::Estimated), Err(expected));
    let other_clock = system::data(&model, system::SAMPLE_TIME_S, 20, 1.0, 1).unwrap();
    let record = other_clock.experiments()[0].clone();
    let slow = Dataset::new(1.0, record.inputs, record.outputs).unwrap();
    assert!(matches!(simulate(&model, &slow, &InitialState::Zero), Err(IdentError::Lti(_))));
}

#[test]
fn regress_overflow_of_an_unstable_model_is_an_error() {
    let equation = PolynomialEquation { a: vec![vec![-3.0]], b: vec![vec![1.0]], ..Default::default() };
    let model = PolynomialModel::siso(1.0, 1, equation).unwrap();
    let data = Dataset::siso(1.0, &[1.0; 1000], &[0.0; 1000]).unwrap();
    for initial in [InitialState::Zero, InitialState::Estimated] {
        assert!(matches!(simulate(&model, &data, &initial), Err(IdentError::NotFinite { .. })));
    }
    assert!(predict(&model, &data, 1, &InitialState::Estimated).is_ok());
}

#[test]
fn regress_empty_and_short_records_are_no_panic() {
    let model = system::box_jenkins().unwrap();
    for samples in 0..6 {
        let data = system::data(&model, system::SAMPLE_TIME_S, samples, 1.0, 1).unwrap();
        for initial in [InitialState::Zero, InitialState::Estimated] {
            assert_eq!(simulate(&model, &data, &initial).unwrap().outputs[0].nrows(), samples);
            assert_eq!(predict(&model, &data, 3, &initial).unwrap().outputs[0].nrows(), samples);
        }
    }
    let blank = Dataset::siso(system::SAMPLE_TIME_S, &[1.0; 5], &[f64::NAN; 5]).unwrap();
    assert_eq!(predict(&model, &blank, 1, &InitialState::Estimated).unwrap().initial_states[0], vec![0.0; 3]);
}

proptest! {
    /// A change of coordinates changes no prediction, with gaps and an estimated state.
    #[test]
    fn prop_predictions_do_not_depend_on_coordinates(seed in 0_u64..1000, scale in -3.0_f64..3.0) {
        let model = system::box_jenkins().unwrap();
        let mut data = system::data(&model, system::SAMPLE_TIME_S, 120, 1.0, seed).unwrap();
        let record = data.experiments()[0].clone();
        let outputs = Mat::from_fn(120, 1, |t, _| if t % 17 == 5 { f64::NAN } else { record.outputs[(t, 0)] });
        data = Dataset::new(system::SAMPLE_TIME_S, record.inputs, outputs).unwrap();
        let form = LinearModel::innovations(&model, system::SAMPLE_TIME_S, Intersample::ZeroOrderHold).unwrap();
        let factor = |i: usize| 10_f64.powf(scale * i as f64);
        let s = form.system();
        let n = s.states();
        let turned = StateSpace::discrete(
            Mat::from_fn(n, n, |i, j| s.a()[(i, j)] * factor(i) / factor(j)),
            Mat::from_fn(n, 1, |i, _| s.b()[(i, 0)] * factor(i)),
            Mat::from_fn(1, n, |_, j| s.c()[(0, j)] / factor(j)),
            s.d().to_owned(),
            system::SAMPLE_TIME_S,
        ).unwrap();
        let k = Mat::from_fn(n, 1, |i, _| form.k()[(i, 0)] * factor(i));
        let turned = Innovations::new(turned, k, form.noise_covariance().to_owned()).unwrap();
        for horizon in [1, 4] {
            let one = predict(&form, &data, horizon, &InitialState::Estimated).unwrap();
            let two = predict(&turned, &data, horizon, &InitialState::Estimated).unwrap();
            prop_assert!(largest_difference(&one.outputs[0], &two.outputs[0]) < 1e-8);
        }
    }
}

#[test]
fn regress_noise_chain_takes_no_part_in_simulation() {
    // y = 1/(1 − 0.5 q⁻¹) u(t−1) + e/(1 − q⁻¹): the disturbance drifts, and its free response could take the drift up.
    let equation = PolynomialEquation { b: vec![vec![1.0]], f: vec![vec![-0.5]], d: vec![-1.0], ..Default::default() };
    let model = PolynomialModel::siso(0.1, 1, equation).unwrap();
    let mut noise = Noise::new(7);
    let u = noise.normals(200);
    let (mut w, mut y) = (0.0, Vec::new());
    for t in 0..200 {
        y.push(w + 50.0);
        w = 0.5 * w + u[t];
    }
    let data = Dataset::siso(0.1, &u, &y).unwrap();
    let simulated = simulate(&model, &data, &InitialState::Estimated).unwrap();
    let offset: Vec<f64> = (50..200).map(|t| y[t] - simulated.outputs[0][(t, 0)]).collect();
    assert!(offset.iter().all(|v| (v - 50.0).abs() < 1e-6), "the offset is the disturbance's: {:?}", &offset[..3]);
}
