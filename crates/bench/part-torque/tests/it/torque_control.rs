use part_torque::torque_control::{TorqueControlFit, choose, estimate};
use rig::estimation::EstimateError;
use rig::experiment::Test;
use rig::results::Quantity;
use rig::{Experiment, Finding, Role};
use signal::Signal;

use bench_testkit::torque_bench::{
    Noise, TRUTH, Truth, calculated, experiment, lagged, rippled, white_demand, white_noise,
};

fn value(fit: &TorqueControlFit, index: usize) -> f64 {
    fit.result.delay_and_lag.parameters[index].value
}

fn assert_exact(truth: Truth) {
    let fit = estimate(&white_noise(truth, 1), None).unwrap();
    let close = |found: f64, true_value: f64| assert!((found / true_value - 1.0).abs() < 1e-6, "{found} {true_value}");
    close(value(&fit, 0), truth.delay_s);
    close(value(&fit, 1), truth.lag_rad_s);
    close(value(&fit, 2), truth.delay_s + 1.0 / truth.lag_rad_s);
    assert_eq!(fit.model.ripple.lines.len(), usize::from(truth.ripple_hz.is_some()));
    assert!(fit.result.delay_and_lag_validation.fit_percent > 99.999);
    assert!(fit.result.pure_delay_validation.fit_percent < 95.0);
    let pure = fit.result.pure_delay.parameters[0].value;
    assert!(pure > truth.delay_s && pure < truth.delay_s + 1.0 / truth.lag_rad_s + 1e-3, "{pure}");
}

#[test]
fn exact_delay_and_lag_without_ripple() {
    assert_exact(Truth { ripple_hz: None, ..TRUTH });
}

#[test]
fn exact_delay_and_lag_with_ripple_whose_frequency_is_found() {
    assert_exact(TRUTH);
    assert_exact(Truth { ripple_hz: Some(61.37), ..TRUTH });
}

#[test]
fn exact_stamps_between_those_of_the_demand() {
    assert_exact(Truth { shift_s: 0.2403e-3, delay_s: 3.4e-3, lag_rad_s: 180.0, ..TRUTH });
}

#[test]
fn exact_of_a_long_recording_the_part_is_used_in_which_the_demand_moves() {
    let truth = Truth { duration_s: 400.0, ..TRUTH };
    let mut noise = Noise::new(1);
    let mut demand = white_demand(truth, &mut noise);
    let moves = 100.0..340.0;
    for k in 0..demand.len() {
        if !moves.contains(&demand.time_s(k)) {
            demand.samples[k] = 60.0;
        }
    }
    let torque = calculated(truth, &demand, &mut noise);
    let long = experiment("WhiteNoise_T_TN", [(Role::DynoTorqueDemand, demand), (Role::AirGapTorque, torque)]);
    let fit = estimate(&long, None).unwrap();
    let used = &fit.result.delay_and_lag.stretches[0];
    let judged = &fit.result.delay_and_lag_validation.stretch;
    assert!(
        (used.start_s - moves.start).abs() <= 1.0 && (judged.end_s - moves.end).abs() <= 1.0,
        "{used:?} {judged:?}"
    );
    assert!((value(&fit, 1) / TRUTH.lag_rad_s - 1.0).abs() < 1e-6, "{}", value(&fit, 1));
}

#[test]
fn exact_torque_dated_before_its_demand() {
    let mut early = white_noise(TRUTH, 1);
    let shift_s = TRUTH.delay_s + 0.9e-3;
    if let Some(torque) = early.signals.get_mut(&Role::AirGapTorque) {
        torque.start_s -= shift_s;
    }
    let fit = estimate(&early, None).unwrap();
    assert!((value(&fit, 0) + 0.9e-3).abs() < 1e-8, "{}", value(&fit, 0));
    assert!((value(&fit, 1) / TRUTH.lag_rad_s - 1.0).abs() < 1e-6);
    let advances = fit.diagnostics.iter().filter_map(|d| match d.finding {
        Finding::EarlySignal { role: Role::AirGapTorque, advance_s } => Some(advance_s),
        _ => None,
    });
    assert!(advances.map(|a| (a - 0.9e-3).abs()).fold(f64::INFINITY, f64::min) < 1e-6, "{:?}", fit.diagnostics);
    assert!(estimate(&white_noise(TRUTH, 1), None).unwrap().diagnostics.is_empty());
}

#[test]
fn exact_air_gap_torque_between_the_samples_and_in_another_recording() {
    let fit = estimate(&white_noise(TRUTH, 1), None).unwrap();
    let truth = Truth { start_s: 7.1234, ..TRUTH };
    let mut noise = Noise::new(5);
    let demand = white_demand(truth, &mut noise);
    let torque = calculated(truth, &demand, &mut noise);
    let times: Vec<f64> = (0..demand.len()).map(|i| demand.time_s(i)).collect();
    let smooth = lagged(&demand, truth.delay_s, truth.lag_rad_s, &times);
    let moved = fit.model.refit_ripple(&demand, &torque).unwrap();
    let modelled = moved.air_gap_torque(&demand);
    for (i, t) in times.iter().enumerate() {
        assert!((modelled.samples[i] - rippled(smooth[i], truth.ripple_hz, *t)).abs() < 1e-4);
    }
}

#[test]
fn stat_intervals_cover_the_truth_and_residuals_are_white() {
    let truth = Truth { noise_nm: 0.2, duration_s: 8.0, ..TRUTH };
    let targets = [truth.delay_s, truth.lag_rad_s, truth.delay_s + 1.0 / truth.lag_rad_s];
    let (mut covered, mut white, runs) = ([0; 3], 0, 100);
    for seed in 0..runs {
        let fit = estimate(&white_noise(truth, 100 + seed), None).unwrap();
        for (k, p) in fit.result.delay_and_lag.parameters.iter().enumerate() {
            covered[k] += usize::from(p.interval.0 <= targets[k] && targets[k] <= p.interval.1);
        }
        white += usize::from(fit.model.residual.white);
        assert!((fit.model.residual.standard_deviation_nm - 0.2).abs() < 0.03);
    }
    // Binomial(100, 0.95) is at least 87 with probability 0.9985, Binomial(100, 0.99) at least 95 with 0.9994.
    assert!(covered.iter().all(|c| *c >= 87), "{covered:?}");
    assert!(white >= 95, "{white}");
}

#[test]
fn stat_no_ripple_is_found_in_noise() {
    let truth = Truth { noise_nm: 0.3, ripple_hz: None, duration_s: 8.0, ..TRUTH };
    let found = |seed| usize::from(!estimate(&white_noise(truth, seed), None).unwrap().model.ripple.lines.is_empty());
    assert!((0..40).map(found).sum::<usize>() <= 2);
}

#[test]
fn stat_a_wrong_gain_is_reported() {
    let mut scaled = white_noise(Truth { noise_nm: 0.2, ..TRUTH }, 3);
    let torque = scaled.signals.get_mut(&Role::AirGapTorque).unwrap();
    *torque = torque.map(|v| 1.02 * v);
    let fit = estimate(&scaled, None).unwrap();
    let lag = fit.result.delay_and_lag.parameter(Quantity::TorqueControlBandwidth).unwrap();
    assert!((lag.interval.0..=lag.interval.1).contains(&TRUTH.lag_rad_s), "{lag:?}");
    assert!((fit.gain.value - 1.02).abs() < 5.0 * fit.gain.standard_error);
    assert!(fit.diagnostics.iter().any(|d| matches!(d.finding, Finding::RoutesDisagree { .. })));
    let right = estimate(&white_noise(Truth { noise_nm: 0.2, ..TRUTH }, 3), None).unwrap();
    assert!(right.diagnostics.is_empty(), "{:?}", right.diagnostics);
}

#[test]
fn stat_saturated_stretches_are_left_out() {
    let truth = Truth { noise_nm: 0.05, ..TRUTH };
    let mut noise = Noise::new(9);
    let mut demand = white_demand(truth, &mut noise);
    demand.samples[3000..3200].fill(150.0);
    let limited = demand.map(|u| u.min(100.0));
    let torque = calculated(truth, &limited, &mut noise);
    let both = [(Role::DynoTorqueDemand, demand), (Role::AirGapTorque, torque)];
    let fit = estimate(&experiment("WhiteNoise_T_TN", both), Some(100.0)).unwrap();
    let total = &fit.result.delay_and_lag.parameters[2];
    assert!((total.value - 3.0184e-3).abs() < 5.0 * total.standard_error, "{total:?}");
    assert!(fit.diagnostics.iter().any(|d| matches!(d.finding, Finding::Saturated { .. })));
}

fn without(role: Role) -> Experiment {
    let mut e = white_noise(TRUTH, 1);
    e.signals.remove(&role);
    e
}

#[test]
fn regress_missing_signals_are_named() {
    for missing in [Role::DynoTorqueDemand, Role::AirGapTorque] {
        let found = estimate(&without(missing), None);
        assert!(matches!(found, Err(EstimateError::MissingSignal { role, .. }) if role == missing));
    }
}

#[test]
fn regress_short_constant_and_nan_are_errors() {
    let short = white_noise(Truth { duration_s: 2.0, ..TRUTH }, 1);
    assert!(matches!(estimate(&short, None), Err(EstimateError::TooShort { .. })));
    let mut constant = white_noise(TRUTH, 1);
    constant.signals.insert(Role::DynoTorqueDemand, Signal::new(2.5, 1e-3, vec![60.0; 12_000]).unwrap());
    assert!(matches!(estimate(&constant, None), Err(EstimateError::WeakExcitation { .. })));
    for role in [Role::DynoTorqueDemand, Role::AirGapTorque] {
        let mut broken = white_noise(TRUTH, 1);
        broken.signals.get_mut(&role).unwrap().samples[77] = f64::NAN;
        assert!(matches!(estimate(&broken, None), Err(EstimateError::Ident { .. })));
    }
    let mut apart = white_noise(TRUTH, 1);
    apart.signals.get_mut(&Role::AirGapTorque).unwrap().start_s = 500.0;
    assert!(estimate(&apart, None).is_err());
    assert!(matches!(estimate(&white_noise(TRUTH, 1), Some(50.0)), Err(EstimateError::Saturated { .. })));
}

#[test]
fn regress_letter_case_of_a_test_does_not_matter() {
    let mut white = white_noise(TRUTH, 1);
    white.label = "whitenoise_T_TN_1500".parse().unwrap();
    assert_eq!(white.label.to_string(), "WhiteNoise_T_TN");
    assert!(choose(&[&white]).is_some());
}

#[test]
fn regress_white_noise_is_preferred() {
    let mut step = white_noise(TRUTH, 1);
    step.label = "Step_T_TN".parse().unwrap();
    let white = white_noise(TRUTH, 1);
    assert!(choose(&[&step, &white]).unwrap().is_test(&Test::WhiteNoise));
    assert!(choose(&[&step]).unwrap().is_test(&Test::Step));
    assert!(choose(&[]).is_none());
}

/// Delay and bandwidth once came out as the limits of the search.
#[test]
fn regress_a_torque_that_no_drive_makes_is_not_estimated() {
    let mut slow = white_noise(TRUTH, 1);
    let torque = slow.signals.get_mut(&Role::AirGapTorque).unwrap();
    let (mut state, part) = (torque.samples[0], 5.0 * torque.sample_time_s);
    torque.samples.iter_mut().for_each(|t| {
        state += part * (*t - state);
        *t = state;
    });
    let found = estimate(&slow, None);
    let is_at_limit = matches!(found, Err(EstimateError::AtLimit { quantity: Quantity::TorqueControlBandwidth, .. }));
    assert!(is_at_limit, "{:?}", found.map(|fit| fit.result.delay_and_lag));
}
