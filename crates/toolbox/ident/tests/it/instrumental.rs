//! Instrumental variables.

use faer::Mat;
use ident::{Arx, ArxOrders, Dataset, Experiment, Fit, IdentError, InstrumentalVariables, Instruments, Iv4};
use lti::PolynomialModel;

use crate::arx::{assert_covers, coverage, respond};
use crate::noise::Noise;

const TRUTH: [f64; 4] = [-1.5, 0.7, 1.0, 0.5];

/// An output error: white noise on the measured output, so the equation errors are `A(q) e`.
fn output_error(samples: usize, spread: f64, seed: u64) -> Dataset {
    let mut noise = Noise::new(seed);
    let u = noise.normals(samples);
    let x = respond(&TRUTH[..2], &TRUTH[2..], 1, &u, &vec![0.0; samples]);
    let y: Vec<f64> = x.iter().map(|x| x + spread * noise.normal()).collect();
    Dataset::siso(1.0, &u, &y).unwrap()
}

fn deviation(fit: &Fit<PolynomialModel>, truth: &[f64]) -> f64 {
    fit.parameters().iter().zip(truth).map(|(v, t)| (v - t).abs()).fold(0.0, f64::max)
}

#[test]
fn exact_every_choice_of_instruments() {
    let data = output_error(400, 0.0, 1);
    let orders = ArxOrders::siso(2, 2, 1);
    let model = Arx::new(2, 2, 1).fit(&data).unwrap().model;
    let x = data.experiments()[0].outputs.clone();
    for instruments in [Instruments::DelayedInputs, Instruments::Model(model), Instruments::Signals(vec![x])] {
        let plain = InstrumentalVariables::new(orders.clone(), instruments);
        let filtered = plain.clone().prefilter(vec![1.0, -0.5, 0.2]);
        assert!(deviation(&plain.fit(&data).unwrap(), &TRUTH) < 1e-10);
        assert!(deviation(&filtered.fit(&data).unwrap(), &TRUTH) < 1e-10);
    }
    assert!(deviation(&Iv4::new(2, 2, 1).fit(&data).unwrap(), &TRUTH) < 1e-9);
}

#[test]
fn exact_several_channels_experiments_and_missing_samples() {
    let mut noise = Noise::new(2);
    let mut record = |samples: usize| {
        let u = Mat::from_fn(samples, 2, |_, _| noise.normal());
        let mut y = Mat::<f64>::zeros(samples, 2);
        for t in 2..samples {
            y[(t, 0)] = 0.9 * y[(t - 1, 0)] - 0.3 * y[(t - 1, 1)] + u[(t - 1, 0)];
            y[(t, 1)] = 0.2 * y[(t - 1, 0)] + 0.5 * y[(t - 1, 1)] + 2.0 * u[(t - 2, 1)];
        }
        (u, y)
    };
    let (u, mut y) = record(300);
    y[(70, 1)] = f64::NAN;
    let (inputs, outputs) = record(100);
    let data = Dataset::new(0.1, u, y).unwrap();
    let data = data.with_experiment(Experiment { name: "2".into(), start_s: 0.0, inputs, outputs }).unwrap();
    let orders =
        ArxOrders { na: vec![vec![1; 2]; 2], nb: vec![vec![1, 0], vec![0, 1]], nk: vec![vec![1, 1], vec![1, 2]] };
    let truth = [-0.9, 0.3, 1.0, -0.2, -0.5, 2.0];
    assert!(deviation(&Iv4::with_orders(orders.clone()).fit(&data).unwrap(), &truth) < 1e-9);
    let delayed = InstrumentalVariables::new(orders, Instruments::DelayedInputs).fit(&data).unwrap();
    assert!(deviation(&delayed, &truth) < 1e-9);
}

#[test]
fn stat_unbiased_where_least_squares_is_not() {
    let data = output_error(100_000, 1.0, 3);
    let instruments = InstrumentalVariables::new(ArxOrders::siso(2, 2, 1), Instruments::DelayedInputs);
    assert!(deviation(&Arx::new(2, 2, 1).fit(&data).unwrap(), &TRUTH) > 0.05);
    assert!(deviation(&instruments.fit(&data).unwrap(), &TRUTH) < 0.05);
    let fit = Iv4::new(2, 2, 1).fit(&data).unwrap();
    for ((v, t), e) in fit.parameters().iter().zip(TRUTH).zip(fit.standard_errors()) {
        assert!((v - t).abs() < 4.0 * e && e < 0.01);
    }
}

#[test]
fn stat_four_steps_are_covered_under_coloured_noise() {
    let runs = 400;
    let fit = |seed| Iv4::new(2, 2, 1).fit(&output_error(1500, 0.5, 3000 + seed)).unwrap();
    assert_covers(&coverage(runs, &TRUTH, fit), runs);
}

#[test]
fn stat_four_steps_are_covered_with_the_textbook_covariance_where_it_applies() {
    let runs = 400;
    let fit = |seed| {
        let mut noise = Noise::new(40_000 + seed);
        let (u, e) = (noise.normals(1500), noise.normals(1500));
        let v = respond(&[-0.9, 0.3], &[1.0], 0, &e, &vec![0.0; 1500]);
        let data = Dataset::siso(1.0, &u, &respond(&TRUTH[..2], &TRUTH[2..], 1, &u, &v)).unwrap();
        Iv4::new(2, 2, 1).white_errors().fit(&data).unwrap()
    };
    assert_covers(&coverage(runs, &TRUTH, fit), runs);
}

#[test]
fn stat_simulated_instruments_are_covered_whatever_the_noise() {
    let runs = 400;
    let fit = |seed| {
        let data = output_error(3000, 0.5, 9000 + seed);
        let model = Arx::new(2, 2, 1).fit(&data).unwrap().model;
        InstrumentalVariables::new(ArxOrders::siso(2, 2, 1), Instruments::Model(model)).fit(&data).unwrap()
    };
    assert_covers(&coverage(runs, &TRUTH, fit), runs);
}

#[test]
fn stat_four_steps_beat_plain_instruments() {
    let (mut plain, mut four) = (0.0, 0.0);
    for seed in 0..100 {
        let data = output_error(1000, 1.0, 500 + seed);
        let model = Arx::new(2, 2, 1).fit(&data).unwrap().model;
        let simple = InstrumentalVariables::new(ArxOrders::siso(2, 2, 1), Instruments::Model(model));
        plain += deviation(&simple.fit(&data).unwrap(), &TRUTH).powi(2);
        four += deviation(&Iv4::new(2, 2, 1).fit(&data).unwrap(), &TRUTH).powi(2);
    }
    assert!(four < 0.9 * plain, "{four} for {plain}");
}

#[test]
fn regress_unstable_least_squares_still_give_instruments() {
    // A slow, lightly damped system in much noise: instruments of any first model have to stay bounded.
    let mut noise = Noise::new(5);
    let u = noise.normals(5000);
    let x = respond(&[-1.998, 0.9990], &[0.01], 1, &u, &vec![0.0; 5000]);
    let y: Vec<f64> = x.iter().map(|x| x + 1e-3 * noise.normal()).collect();
    let fit = Iv4::new(2, 1, 1).fit(&Dataset::siso(1.0, &u, &y).unwrap()).unwrap();
    assert!(deviation(&fit, &[-1.998, 0.9990, 0.01]) < 2e-3, "{:?}", fit.parameters());
    let exploding = Arx::new(1, 1, 1)
        .fit(&Dataset::siso(1.0, &u[..40], &respond(&[-1.2], &[1.0], 1, &u[..40], &[0.0; 40])).unwrap())
        .unwrap();
    let orders = ArxOrders::siso(1, 1, 1);
    let data = Dataset::siso(1.0, &u, &respond(&[-0.9], &[1.0], 1, &u, &vec![0.0; 5000])).unwrap();
    let fit = InstrumentalVariables::new(orders, Instruments::Model(exploding.model)).fit(&data).unwrap();
    assert!(deviation(&fit, &[-0.9, 1.0]) < 1e-9);
}

#[test]
fn regress_unusable_instruments_are_named() {
    let data = output_error(100, 0.1, 4);
    let orders = ArxOrders::siso(2, 2, 1);
    let with = |x: Mat<f64>| InstrumentalVariables::new(orders.clone(), Instruments::Signals(vec![x])).fit(&data);
    assert!(matches!(with(Mat::zeros(99, 1)), Err(IdentError::Length { .. })));
    assert!(matches!(with(Mat::zeros(100, 1)), Err(IdentError::RankDeficient { .. })));
    assert!(matches!(with(Mat::full(100, 1, f64::NAN)), Err(IdentError::NotFinite { .. })));
    let series = Dataset::new(1.0, Mat::new(), data.experiments()[0].outputs.clone()).unwrap();
    let undriven = Iv4::with_orders(ArxOrders::miso(2, &[], &[]));
    assert!(matches!(undriven.fit(&series), Err(IdentError::Structure { .. })));
    let filter = InstrumentalVariables::new(orders, Instruments::DelayedInputs).prefilter(vec![]);
    assert!(matches!(filter.fit(&data), Err(IdentError::Structure { .. })));
}
