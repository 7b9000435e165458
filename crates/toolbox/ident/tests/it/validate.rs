#![allow(clippy::print_stdout, reason = "sizes of tests are for whoever reads the deep check")]

use faer::Mat;
use ident::prediction::InitialState;
use ident::validate::{ResidualTest, TestData, compare_with, fit_percent, judge, rms_error};
use ident::{Arx, ContinuousTransferFunction, Dataset, IdentError, LinearModel};
use lti::{PolynomialEquation, PolynomialModel};
use testkit::system;

use crate::noise::Noise;

#[test]
fn exact_fit_of_mean_is_zero_and_of_truth_hundred() {
    let y = [1.0, 2.0, 3.0, 6.0];
    assert_eq!(fit_percent(&y, &y).unwrap(), 100.0);
    assert!(fit_percent(&y, &[3.0; 4]).unwrap().abs() < 1e-12);
    assert!((rms_error(&y, &[2.0, 3.0, 4.0, 7.0]).unwrap() - 1.0).abs() < 1e-15);
    assert!(fit_percent(&y, &[1.0]).is_err());
}

#[test]
fn exact_cross_correlation_finds_a_missed_lag() {
    let mut noise = Noise::new(4);
    let input = noise.normals(2000);
    let residuals: Vec<f64> = (0..2000).map(|t: usize| if t >= 3 { input[t - 3] } else { 0.0 }).collect();
    let data = Dataset::siso(1.0, &input, &residuals).unwrap();
    let cross = ResidualTest::default().run_on_residuals(&data).unwrap().independence.remove(0).remove(0).cross;
    let peak = (0..cross.len()).max_by(|a, b| cross[*a].total_cmp(&cross[*b])).unwrap();
    assert_eq!(peak as isize - 25, 3);
}

#[test]
fn stat_regions_hold_ninety_nine_percent_of_lags_under_independence() {
    let mut noise = Noise::new(5);
    let (mut outside_cross, mut outside_auto, mut total) = (0, 0, 0);
    for _ in 0..200 {
        let residuals = noise.normals(1000);
        let mut state = 0.0;
        let input: Vec<f64> = (0..1000)
            .map(|_| {
                state = 0.8 * state + noise.normal();
                state
            })
            .collect();
        let data = Dataset::siso(1.0, &input, &residuals).unwrap();
        let report = ResidualTest::default().run_on_residuals(&data).unwrap();
        let (whiteness, independence) = (&report.whiteness[0], &report.independence[0][0]);
        outside_cross +=
            independence.cross.iter().zip(&independence.bounds).filter(|(c, bound)| c.abs() > **bound).count();
        outside_auto +=
            whiteness.auto.iter().zip(&whiteness.bounds).skip(1).filter(|(c, bound)| c.abs() > **bound).count();
        total += 25;
    }
    let cross = outside_cross as f64 / (2.0 * f64::from(total) + 200.0);
    let auto = outside_auto as f64 / f64::from(total);
    assert!((0.003..0.02).contains(&cross), "{cross}");
    assert!((0.003..0.02).contains(&auto), "{auto}");
}

#[test]
fn regress_constant_signals_are_refused() {
    for count in [500, 10] {
        let still = Dataset::siso(1.0, &vec![1.0; count], &vec![0.0; count]).unwrap();
        assert!(ResidualTest::default().run_on_residuals(&still).is_err());
    }
}

/// Output `0.7 y(t−1) + u(t−1) + 0.4 u(t−2) + e(t)` of white input and noise.
fn white_campaign(noise: &mut Noise, samples: usize) -> Dataset {
    let (u, e) = (noise.normals(samples), noise.normals(samples));
    let mut y = vec![0.0; samples];
    for t in 2..samples {
        y[t] = 0.7 * y[t - 1] + u[t - 1] + 0.4 * u[t - 2] + e[t];
    }
    Dataset::siso(1.0, &u, &y).unwrap()
}

#[test]
fn exact_long_data_are_tested_in_parts_that_show_what_is_missing() {
    let data = white_campaign(&mut Noise::new(21), 300_000);
    for (initial, parts) in [(InitialState::Estimated, 4), (InitialState::Zero, 1)] {
        let test = ResidualTest { most_samples: 40_000, initial, ..Default::default() };
        let whole = ResidualTest { most_samples: usize::MAX, ..test.clone() };
        let right = Arx::new(1, 2, 1).fit(&data).unwrap();
        let report = test.run(&right, &data, TestData::Own).unwrap();
        assert_eq!((report.samples, report.samples_given), (40_000, 300_000));
        let white = &report.whiteness[0];
        assert!(white.joint.passes(0.999) && report.independence[0][0].dynamics.passes(0.999), "{parts} parts");
        // Bounds are those of the samples that were tested.
        let bounds = whole.run(&right, &data, TestData::Own).unwrap().whiteness[0].bounds[20];
        assert!((white.bounds[20] / bounds / 7.5_f64.sqrt() - 1.0).abs() < 0.02, "{} {bounds}", white.bounds[20]);
        let wrong = Arx::new(1, 1, 1).fit(&data).unwrap();
        assert!(!test.run(&wrong, &data, TestData::Own).unwrap().independence[0][0].dynamics.passes(0.999));
    }
}

/// An estimate from all of the data, tested on a part of them.
#[test]
fn stat_tests_on_parts_of_the_own_data_hold_their_level() {
    let test = ResidualTest { most_samples: 1000, ..Default::default() };
    let (mut noise, runs, mut alarms) = (Noise::new(22), 600, [0; 3]);
    for _ in 0..runs {
        let data = white_campaign(&mut noise, 3000);
        let fit = Arx::new(1, 2, 1).fit(&data).unwrap();
        let report = test.run(&fit, &data, TestData::Own).unwrap();
        let independence = &report.independence[0][0];
        let tests = [report.whiteness[0].joint, independence.dynamics, independence.feedback];
        alarms.iter_mut().zip(tests).for_each(|(count, test)| *count += usize::from(!test.passes(0.95)));
    }
    // 30 are expected; four standard deviations of a binomial count.
    assert!(alarms.iter().all(|count| (9..=51).contains(count)), "{alarms:?}");
}

/// False alarms of every test with the truth as the model; the input and the residual may be coloured.
#[test]
#[ignore = "slow"]
fn stat_residual_tests_raise_one_false_alarm_in_a_hundred() {
    let test = ResidualTest::default();
    let runs = 2000;
    let (mut alarms, mut outside) = ([0; 4], 0);
    for seed in 0..runs {
        let data = system::experiments(&system::armax().unwrap(), 0.1, &[700, 500], 1.0, seed).unwrap();
        let report = test.run_known(&system::armax().unwrap(), &data).unwrap();
        let independence = &report.independence[0][0];
        let tests = [report.whiteness[0].joint, report.joint_whiteness, independence.dynamics, independence.feedback];
        for (count, test) in alarms.iter_mut().zip(tests) {
            *count += usize::from(!test.passes(0.99));
        }
        outside += independence.cross.iter().zip(&independence.bounds).filter(|(c, bound)| c.abs() > **bound).count();
    }
    println!("alarms of {runs} at 1 %: {alarms:?}");
    // Four standard deviations of a binomial count about 1 %.
    assert!(alarms.iter().all(|count| (3..=37).contains(count)), "{alarms:?}");
    let share = outside as f64 / (51.0 * runs as f64);
    assert!((0.006..0.014).contains(&share), "{share}");
}

#[test]
#[ignore = "slow"]
fn stat_joint_tests_are_uniform_for_coloured_residuals_and_inputs() {
    let test = ResidualTest { initial: InitialState::Zero, ..Default::default() };
    let colour = |a: f64, x: Vec<f64>| {
        x.iter()
            .scan(0.0, |state, v| {
                *state = a * *state + v;
                Some(*state)
            })
            .collect::<Vec<f64>>()
    };
    // A static gain of zero: the residual is the output.
    let model = PolynomialModel::siso(1.0, 0, PolynomialEquation { b: vec![vec![0.0]], ..Default::default() }).unwrap();
    let mut noise = Noise::new(77);
    let (mut below_five, mut below_half, runs) = (0, 0, 1000);
    for _ in 0..runs {
        let (u, y) = (colour(0.9, noise.normals(2000)), colour(0.7, noise.normals(2000)));
        let report = test.run_known(&model, &Dataset::siso(1.0, &u, &y).unwrap()).unwrap();
        let p = report.independence[0][0].dynamics.p_value;
        below_five += usize::from(p < 0.05);
        below_half += usize::from(p < 0.5);
        assert!(!report.whiteness[0].joint.passes(0.99));
    }
    println!("of {runs}: {below_five} below 5 %, {below_half} below a half");
    // Four standard deviations of binomial counts.
    assert!((22..=78).contains(&below_five), "{below_five}");
    assert!((437..=563).contains(&below_half), "{below_half}");
}

#[test]
fn stat_whiteness_of_an_output_known_at_every_fourth_sample_holds_its_level() {
    let model = PolynomialModel::siso(1.0, 0, PolynomialEquation { b: vec![vec![0.0]], ..Default::default() }).unwrap();
    let mut noise = Noise::new(5);
    let (mut below_five, mut below_half, runs) = (0, 0, 300);
    for _ in 0..runs {
        let (u, mut y) = (noise.normals(1200), noise.normals(1200));
        (0..1200).filter(|t| t % 4 != 0).for_each(|t| y[t] = f64::NAN);
        let report = ResidualTest::default().run_known(&model, &Dataset::siso(1.0, &u, &y).unwrap()).unwrap();
        let joint = report.whiteness[0].joint;
        assert_eq!(joint.degrees_of_freedom, 6.0);
        below_five += usize::from(joint.p_value < 0.05);
        below_half += usize::from(joint.p_value < 0.5);
    }
    // 95 % of binomial counts lie within 8 … 23 and 133 … 167; these bounds are twice as wide.
    assert!((1..=30).contains(&below_five), "{below_five}");
    assert!((116..=184).contains(&below_half), "{below_half}");
}

#[test]
#[ignore = "slow"]
fn stat_whiteness_of_two_outputs_with_missing_samples_holds_its_level() {
    let model = system::arx_two_by_two().unwrap();
    let (mut alarms, runs) = (0, 300);
    for seed in 0..runs {
        let data = system::data(&model, 0.1, 600, 1.0, seed).unwrap();
        let record = &data.experiments()[0];
        let gap = |t: usize| (200..215).contains(&t) || (400..420).contains(&t);
        let outputs = Mat::from_fn(600, 2, |t, i| if gap(t) { f64::NAN } else { record.outputs[(t, i)] });
        let data = Dataset::new(0.1, record.inputs.clone(), outputs).unwrap();
        alarms += usize::from(!ResidualTest::default().run_known(&model, &data).unwrap().joint_whiteness.passes(0.99));
    }
    assert!(alarms <= 10, "{alarms}");
}

#[test]
fn stat_feedback_and_missed_dynamics_are_told_apart() {
    let mut noise = Noise::new(8);
    let (e, r) = (noise.normals(3000), noise.normals(3000));
    let (mut u, mut y) = (vec![0.0; 3000], vec![0.0; 3000]);
    for t in 1..3000 {
        y[t] = 0.5 * y[t - 1] + u[t - 1] + e[t] + 0.5 * e[t - 1];
        u[t] = r[t] - 0.3 * y[t];
    }
    let data = Dataset::siso(1.0, &u, &y).unwrap();
    let siso = |equation| PolynomialModel::siso(1.0, 1, equation).unwrap();
    let (a, b, c) = (vec![vec![-0.5]], vec![vec![1.0]], vec![0.5]);
    let truth = siso(PolynomialEquation { a, b: b.clone(), c, ..Default::default() });
    let report = ResidualTest::default().run_known(&truth, &data).unwrap();
    assert!(report.whiteness[0].joint.passes(0.99));
    let independence = &report.independence[0][0];
    // u(t) depends on e(t) through y(t) without a delay, so lag zero belongs to the feedback here.
    assert!(!independence.feedback.passes(0.99), "{independence:?}");
    let lacking = siso(PolynomialEquation { b, ..Default::default() });
    let report = ResidualTest::default().run_known(&lacking, &data).unwrap();
    assert!(!report.independence[0][0].dynamics.passes(0.99) && !report.whiteness[0].joint.passes(0.99));
}

#[test]
fn exact_judgement_is_the_fit_of_each_channel_without_missing_samples() {
    let model = system::arx_two_by_two().unwrap();
    let data = system::experiments(&model, 0.1, &[60, 40], 1.0, 3).unwrap();
    let mut broken = data.clone();
    let record = data.experiments()[0].clone();
    let mut outputs = record.outputs.clone();
    outputs[(7, 1)] = f64::NAN;
    broken =
        Dataset::new(0.1, record.inputs, outputs).unwrap().with_experiment(broken.experiments()[1].clone()).unwrap();
    let judged = judge(&model, &broken, Some(1), &InitialState::Zero).unwrap();
    assert_eq!(judged.samples, 99);
    let modelled = &judged.response.outputs;
    let whole = fit_percent(data.experiments()[1].output(0), modelled[1].col_as_slice(0)).unwrap();
    assert_eq!(judged.fit_percent[1][0], whole);
    let (y, m): (Vec<f64>, Vec<f64>) =
        (0..60).filter(|t| *t != 7).map(|t| (data.experiments()[0].output(1)[t], modelled[0][(t, 1)])).unzip();
    assert_eq!(judged.fit_percent[0][1], fit_percent(&y, &m).unwrap());
    assert!(judged.fit_percent.iter().flatten().all(|f| *f > 50.0));
}

#[test]
fn exact_comparison_keeps_the_models_that_can_be_judged() {
    let (good, other) = (system::arx().unwrap(), system::arx_two_by_two().unwrap());
    let data = system::data(&good, 0.1, 50, 0.0, 3).unwrap();
    let models: [&dyn LinearModel; 2] = [&good, &other];
    let table = compare_with(&models, &data, None, &InitialState::Zero).named(&["good", "wrong channels"]);
    assert_eq!(table.best(), Some("good"));
    let [first, second] = &table.judgements[..] else { panic!("two models") };
    assert!(first.as_ref().unwrap().fit_percent[0][0] > 100.0 - 1e-9);
    assert!(matches!(second, Err(IdentError::Length { .. })));
}

#[test]
fn regress_residual_test_refuses_what_it_cannot_judge() {
    let model = system::arx().unwrap();
    let short = system::data(&model, 0.1, 50, 1.0, 1).unwrap();
    assert!(matches!(ResidualTest::default().run_known(&model, &short), Err(IdentError::TooFewSamples { .. })));
    let constant = Dataset::siso(0.1, &[1.0; 300], &Noise::new(1).normals(300)).unwrap();
    assert!(matches!(ResidualTest::default().run_known(&model, &constant), Err(IdentError::Constant { .. })));
    let blank = Dataset::siso(0.1, &[1.0; 300], &[f64::NAN; 300]).unwrap();
    assert!(ResidualTest::default().run_known(&model, &blank).is_err());
}

/// A constant that arithmetic has touched: no fit, whatever the model says, nor one of the other outputs' fits lost.
#[test]
fn regress_an_output_that_does_not_vary_has_no_fit() {
    for level in [0.0, 0.1, -1e12, 3.3e-9] {
        let mut y = vec![level; 1000];
        y[3] *= 1.0 + f64::EPSILON;
        assert!(fit_percent(&y, &y).unwrap().is_nan(), "{level}");
        let modelled: Vec<f64> = y.iter().map(|v| v + 1.0).collect();
        assert!(fit_percent(&y, &modelled).unwrap().is_nan(), "{level}");
    }
    // What varies in its last digits but one still varies.
    let y: Vec<f64> = (0..100).map(|t| 1.0 + 1e-13 * f64::from(t)).collect();
    assert!(fit_percent(&y, &y).unwrap() == 100.0);
    let model = system::arx_two_by_two().unwrap();
    let data = system::data(&model, 0.1, 60, 1.0, 3).unwrap();
    let record = &data.experiments()[0];
    let outputs = Mat::from_fn(60, 2, |t, i| if i == 0 { record.outputs[(t, 0)] } else { 0.3 });
    let data = Dataset::new(0.1, record.inputs.clone(), outputs).unwrap();
    let fit = judge(&model, &data, None, &InitialState::Estimated).unwrap().fit_percent;
    assert!(fit[0][0].is_finite() && fit[0][1].is_nan(), "{fit:?}");
}

/// Hundreds of stretches shorter than the lags asked for: initial states are taken out stretch by stretch, and lags
/// that no stretch has are not there.
#[test]
fn regress_hundreds_of_short_stretches_are_tested_at_the_lags_they_have() {
    let model = system::armax().unwrap();
    let test = ResidualTest { lags: 50, ..Default::default() };
    let (mut alarms, runs) = ([0; 3], 8);
    for seed in 0..runs {
        let data = system::experiments(&model, 0.1, &[30; 400], 1.0, seed).unwrap();
        let report = test.run_known(&model, &data).unwrap();
        let (own, cross) = (&report.whiteness[0], &report.independence[0][0]);
        let freedom = [own.joint, cross.dynamics, cross.feedback].map(|test| test.degrees_of_freedom);
        // At the lags −29 to −27 the inputs meet the first three errors alone, which the three initial states explain.
        assert_eq!(freedom, [29.0, 30.0, 26.0]);
        assert_eq!((own.auto.len(), cross.cross.len()), (51, 101));
        for (lag, (c, bound)) in own.auto.iter().zip(&own.bounds).enumerate() {
            assert!(c.is_nan() == (lag > 29) && bound.is_nan() == (lag > 29), "{lag} {c} {bound}");
        }
        for (i, (c, bound)) in cross.cross.iter().zip(&cross.bounds).enumerate() {
            let there = i.abs_diff(50) <= 29;
            assert!(c.is_finite() == there && bound.is_finite() == there, "{i} {c} {bound}");
        }
        for (count, test) in alarms.iter_mut().zip([own.joint, cross.dynamics, cross.feedback]) {
            *count += usize::from(!test.passes(0.95));
        }
    }
    // As many of 8 at 5 % come once in some three hundred times.
    assert!(alarms.iter().all(|count| *count <= 3), "{alarms:?}");
}

#[test]
fn regress_models_without_states_are_tested_over_gaps_that_differ() {
    let mut noise = Noise::new(8);
    let equation = |gain: f64| PolynomialEquation {
        a: vec![Vec::new(); 2],
        b: vec![vec![gain]],
        f: vec![Vec::new()],
        nk: vec![0],
        ..Default::default()
    };
    let model = PolynomialModel::new(1.0, vec![equation(2.0), equation(-1.0)], Mat::identity(2, 2)).unwrap();
    let u = noise.normals(400);
    let outputs = Mat::from_fn(400, 2, |t, i| match (t, i) {
        (50..60, 0) | (200..230, 1) => f64::NAN,
        (_, 0) => 2.0 * u[t] + noise.normal(),
        _ => -u[t] + noise.normal(),
    });
    let data = Dataset::new(1.0, Mat::from_fn(400, 1, |t, _| u[t]), outputs).unwrap();
    let report = ResidualTest::default().run_known(&model, &data).unwrap();
    for output in 0..2 {
        assert!(
            report.whiteness[output].joint.p_value > 1e-3 && report.independence[output][0].dynamics.p_value > 1e-3
        );
    }
}

/// A controller without delay makes the input follow the residual within the sample: only lag 0 shows it.
#[test]
fn stat_feedback_within_the_sample_shows_at_lag_zero_alone() {
    let mut noise = crate::noise::Noise::new(77);
    let (w, e) = (noise.normals(3000), noise.normals(3000));
    let (mut u, mut y) = (vec![0.0; 3000], vec![0.0; 3000]);
    for t in 0..3000 {
        let past = if t > 0 { 0.5 * y[t - 1] + u[t - 1] } else { 0.0 };
        y[t] = past + 0.5 * e[t];
        u[t] = w[t] - 0.3 * y[t];
    }
    let data = Dataset::siso(1.0, &u, &y).unwrap();
    let fit = Arx::new(1, 1, 1).fit(&data).unwrap();
    let report = ResidualTest::default().run(&fit, &data, TestData::Own).unwrap();
    let independence = &report.independence[0][0];
    assert!(!independence.dynamics.passes(0.99) && independence.past.passes(0.99), "{independence:?}");
}

/// Levels that an estimate has for every recording are no errors of it.
#[test]
fn regress_estimated_levels_of_recordings_are_taken_out_of_residuals() {
    let mut noise = Noise::new(3);
    let mut one = |level: f64| {
        let u = noise.normals(600);
        let mut x = 0.0;
        let mut next = |u: &f64| {
            let before = x;
            x = 0.8 * x + 0.2 * u;
            before + level + 0.1 * noise.normal()
        };
        let y: Vec<f64> = u.iter().map(&mut next).collect();
        Dataset::siso(0.1, &u, &y).unwrap()
    };
    let data = one(0.0).merge(&one(30.0)).unwrap();
    let fit = ContinuousTransferFunction::new(0, 1).with_offset().fit(&data).unwrap();
    let report = ResidualTest::default().run(&fit, &data, TestData::Own).unwrap();
    assert!(report.joint_whiteness.passes(0.999), "{:?}", report.joint_whiteness);
}
