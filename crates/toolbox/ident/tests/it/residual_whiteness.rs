//! How often the tests of whiteness fail where the residuals are white, and where they are not.
#![allow(clippy::print_stdout, reason = "sizes of tests are for whoever reads the deep check")]

use ident::validate::{ResidualTest, TestData};
use ident::{Arx, BoxJenkins, Dataset, StateSpacePem};

use crate::noise::Noise;
use crate::residual_levels::{Disturbance, Estimator, armax, arx, bj, oe, record, state_space};

/// Failures at 1 % and at 5 %, and lags outside their region at 99 %, of so many.
#[derive(Debug, Default, Clone, Copy)]
struct Alarms {
    failed: [usize; 2],
    outside: usize,
    lags: usize,
}

/// Alarms on the estimates' own data and on others.
fn alarms(estimate: Estimator, disturbance: Disturbance, samples: usize, runs: u64) -> [Alarms; 2] {
    let mut all = [Alarms::default(); 2];
    for seed in 0..runs {
        let mut noise = Noise::new(7000 + seed);
        let (own, unseen) = (record(samples, disturbance, &mut noise), record(samples, disturbance, &mut noise));
        let fit = estimate(&own).unwrap();
        for (alarms, (data, which)) in all.iter_mut().zip([(&own, TestData::Own), (&unseen, TestData::Unseen)]) {
            let report = ResidualTest::default().run(&fit, data, which).unwrap();
            let test = &report.whiteness[0];
            for (count, level) in alarms.failed.iter_mut().zip([0.99, 0.95]) {
                *count += usize::from(!test.joint.passes(level));
            }
            let lags = test.auto.iter().zip(&test.bounds).skip(1);
            alarms.outside += lags.filter(|(c, bound)| c.abs() > **bound).count();
            alarms.lags += test.auto.len() - 1;
        }
    }
    all
}

/// Counts within binomial bounds of one in a thousand.
fn holds_its_level(name: &str, estimate: Estimator, disturbance: Disturbance, samples: usize, runs: u64) {
    let (mut report, mut good) = (String::new(), true);
    for (which, found) in ["own", "unseen"].iter().zip(alarms(estimate, disturbance, samples, runs)) {
        report += &format!("{name} {which}, {samples} samples, of {runs}: {found:?}\n");
        let n = runs as f64;
        for (count, share) in found.failed.into_iter().zip([0.01, 0.05]) {
            let reach = 3.1 * (n * share * (1.0 - share)).sqrt() + 1.0;
            good &= (count as f64 - n * share).abs() <= reach;
        }
        let share = found.outside as f64 / found.lags as f64;
        good &= (0.005..0.017).contains(&share);
    }
    println!("{report}");
    assert!(good, "{report}");
}

#[test]
#[ignore = "slow"]
fn stat_whiteness_of_equation_errors_holds_its_level() {
    for (samples, runs) in [(300, 1000), (3000, 200)] {
        holds_its_level("arx", arx, Disturbance::Equation(0.0), samples, runs);
    }
}

#[test]
#[ignore = "slow"]
fn stat_whiteness_of_moving_averages_holds_its_level() {
    for (samples, runs) in [(300, 1000), (3000, 150)] {
        holds_its_level("armax", armax, Disturbance::Equation(0.7), samples, runs);
    }
}

#[test]
#[ignore = "slow"]
fn stat_whiteness_of_box_jenkins_holds_its_level() {
    for (samples, runs) in [(300, 1000), (3000, 100)] {
        holds_its_level("bj", bj, Disturbance::Output(0.8), samples, runs);
    }
}

#[test]
#[ignore = "slow"]
fn stat_whiteness_of_state_space_holds_its_level() {
    for (samples, runs) in [(300, 1000), (3000, 100)] {
        holds_its_level("state space", state_space, Disturbance::Equation(0.7), samples, runs);
    }
}

/// An output-error model has nothing that would make residuals white, and takes nothing off: it holds the level where
/// the noise is white.
#[test]
#[ignore = "slow"]
fn stat_whiteness_of_output_errors_holds_its_level_under_white_noise() {
    holds_its_level("oe", oe, Disturbance::Output(0.0), 300, 1000);
}

/// Noise that remembers itself, for which the model has nothing or too little.
#[test]
fn stat_a_missing_noise_pole_is_found() {
    let no_pole: Estimator = |data| BoxJenkins::new(2, 0, 0, 2, 1).fit(data).map(|fit| fit.map(Into::into));
    let short: Estimator = |data| Arx::new(2, 2, 1).fit(data).map(|fit| fit.map(Into::into));
    let cases = [("bj", no_pole, Disturbance::Output(0.5)), ("arx", short, Disturbance::Equation(0.7))];
    for (name, estimate, disturbance) in cases {
        for found in alarms(estimate, disturbance, 600, 20) {
            assert!(found.failed[0] >= 19, "{name}: {found:?}");
        }
    }
}

/// `y(t) = a y(t − 1) + u(t − 1) + e(t)`: the estimate makes the residuals' correlations at short lags smaller than
/// chance makes those of errors.
#[test]
fn stat_the_region_of_an_autoregression_is_narrow_at_short_lags() {
    let (a, samples) = (0.3, 20_000);
    let mut noise = Noise::new(5);
    let (u, e) = (noise.normals(samples), noise.normals(samples));
    let mut y = vec![0.0; samples];
    for t in 1..samples {
        y[t] = a * y[t - 1] + u[t - 1] + e[t];
    }
    let data = Dataset::siso(1.0, &u, &y).unwrap();
    let fit = Arx::new(1, 1, 1).fit(&data).unwrap();
    let test = ResidualTest::default();
    let own = test.run(&fit, &data, TestData::Own).unwrap().whiteness.remove(0);
    // The input makes up half of what determines a: var r(k) = (1 − a^(2k − 2) (1 − a²)/2)/n.
    for (lag, bound) in own.bounds.iter().enumerate().skip(1).take(4) {
        let left = 1.0 - a.powi(2 * lag as i32 - 2) * (1.0 - a * a) / 2.0;
        let wanted = 2.5758 * (left / samples as f64).sqrt();
        assert!((bound / wanted - 1.0).abs() < 0.02, "{lag}: {bound} {wanted}");
    }
    let known = test.run_known(&fit.model, &data).unwrap().whiteness.remove(0);
    assert_eq!(known.joint.degrees_of_freedom, 25.0);
    let by_hand: f64 =
        (1..=25).map(|k| known.auto[k].powi(2) / (samples - k) as f64 * samples as f64 * (samples + 2) as f64).sum();
    assert!((known.joint.statistic / by_hand - 1.0).abs() < 1e-3, "{} {by_hand}", known.joint.statistic);
}

/// A time series: nothing but the past determines it, and the estimate takes as many directions as it has coefficients.
#[test]
fn exact_an_autoregression_of_a_time_series_holds_as_many_directions_as_it_has_coefficients() {
    let mut noise = Noise::new(6);
    let e = noise.normals(2000);
    let mut y = vec![0.0; 2000];
    for t in 2..2000 {
        y[t] = 0.8 * y[t - 1] - 0.5 * y[t - 2] + e[t];
    }
    let outputs = faer::Mat::from_fn(2000, 1, |t, _| y[t]);
    let data = Dataset::new(1.0, faer::Mat::zeros(2000, 0), outputs).unwrap();
    for order in [2, 4] {
        let fit = Arx::autoregression(order).fit(&data).unwrap();
        let own = ResidualTest::default().run(&fit, &data, TestData::Own).unwrap();
        assert_eq!(own.whiteness[0].joint.degrees_of_freedom, 25.0 - order as f64);
        assert_eq!(own.joint_whiteness, own.whiteness[0].joint);
        assert!(own.whiteness[0].bounds[1] < 0.7 * own.whiteness[0].bounds[20]);
        let unseen = ResidualTest::default().run(&fit, &data, TestData::Unseen).unwrap();
        assert_eq!(unseen.whiteness[0].joint.degrees_of_freedom, 25.0);
        assert!(unseen.whiteness[0].bounds[1] > 1.2 * unseen.whiteness[0].bounds[20]);
    }
}

/// Each of two outputs with the past of both.
#[test]
#[ignore = "slow"]
fn stat_joint_whiteness_of_two_outputs_holds_its_level() {
    let (mut own, mut unseen, runs) = ([0; 2], [0; 2], 200);
    for seed in 0..runs {
        let mut noise = Noise::new(800 + seed);
        let mut record = || {
            let (u, e) = (noise.normals(1000), noise.normals(2000));
            let (mut x, mut y) = ([0.0; 2], faer::Mat::zeros(1000, 2));
            for t in 0..1000 {
                let v = [e[2 * t], 0.8 * e[2 * t] + 0.6 * e[2 * t + 1]];
                (y[(t, 0)], y[(t, 1)]) = (x[0] + 0.3 * x[1] + v[0], x[1] + v[1]);
                x = [0.8 * x[0] + u[t] + 0.5 * v[0], 0.3 * x[0] + 0.6 * x[1] + 0.5 * u[t] + 0.4 * v[1]];
            }
            Dataset::new(0.1, faer::Mat::from_fn(1000, 1, |t, _| u[t]), y).unwrap()
        };
        let (first, second) = (record(), record());
        let fit = StateSpacePem::new(2).fit(&first).unwrap();
        for (counts, data, which) in [(&mut own, &first, TestData::Own), (&mut unseen, &second, TestData::Unseen)] {
            let joint = ResidualTest::default().run(&fit, data, which).unwrap().joint_whiteness;
            for (count, level) in counts.iter_mut().zip([0.99, 0.95]) {
                *count += usize::from(!joint.passes(level));
            }
        }
    }
    for counts in [own, unseen] {
        // Binomial bounds of one in a thousand about 2 and 10 of 200.
        assert!(counts[0] <= 7 && (1..=20).contains(&counts[1]), "{own:?} {unseen:?}");
    }
}

/// White residuals that are five times as large in the second half, and ones that are not white.
#[test]
fn stat_whiteness_holds_its_level_where_the_noise_changes_in_size() {
    let failed = |memory: f64| {
        let test = |seed: u64| {
            let mut noise = Noise::new(300 + seed);
            let (u, mut e) = (noise.normals(600), 0.0);
            let sized = |(t, v): (usize, f64)| if t < 300 { v } else { 5.0 * v };
            let mut next = |v: f64| {
                e = memory * e + v;
                e
            };
            let y: Vec<f64> = noise.normals(600).into_iter().enumerate().map(sized).map(&mut next).collect();
            let report = ResidualTest::default().run_on_residuals(&Dataset::siso(1.0, &u, &y).unwrap()).unwrap();
            !report.joint_whiteness.passes(0.99)
        };
        (0..100).filter(|seed| test(*seed)).count()
    };
    let (white, coloured) = (failed(0.0), failed(0.5));
    assert!(white <= 5, "{white} of 100 tests of white residuals failed");
    assert!(coloured >= 95, "{coloured} of 100 tests found the colour");
}
