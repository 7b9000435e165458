//! The simulation as one linear system.

use bench_model::model::{BenchModel, TorqueControlModel};
use bench_model::simulate::{DynoInput, InitialState, Inputs, LoopMode, linear_form, simulate};
use bench_testkit::models::bench_a;
use faer::Mat;
use proptest::prelude::*;

const SAMPLES: usize = 400;

/// Samples at the start in which the demand rests, so that what it was before does not matter.
const RESTING: usize = 8;

/// Largest difference of each output, relative to its range.
fn difference(model: &BenchModel, mode: LoopMode) -> f64 {
    let model = BenchModel { torque_limit_nm: None, ..model.clone() };
    let wave = |k: usize, period: f64| (k as f64 / period).sin();
    let engine: Vec<f64> = (0..SAMPLES).map(|k| 40.0 + 8.0 * wave(k, 7.0) + if k > 150 { 10.0 } else { 0.0 }).collect();
    let demand: Vec<f64> = match mode {
        LoopMode::Speed => (0..SAMPLES).map(|k| 125.0 + 2.0 * wave(k.saturating_sub(RESTING), 31.0)).collect(),
        LoopMode::Torque => (0..SAMPLES).map(|k| 40.0 + 15.0 * wave(k, 11.0)).collect(),
    };
    let start = InitialState { twist_rad: 0.02, ..InitialState::steady(&model, 125.0, 38.0) };
    let dyno = match mode {
        LoopMode::Speed => DynoInput::SpeedDemand(&demand),
        LoopMode::Torque => DynoInput::TorqueDemand(&demand),
    };
    let inputs = Inputs { sample_time_s: 1e-3, engine_torque_nm: &engine, dyno };
    let expected = simulate(&model, &inputs, &start).unwrap();
    let form = linear_form(&model, mode, 1e-3).unwrap();
    let feed_forward = match mode {
        LoopMode::Speed => model.feed_forward.map_or(0.0, |feed| feed.speed_nm_s_per_rad * demand[0]),
        LoopMode::Torque => demand[0],
    };
    let initial = form.initial(&start, [demand[0], engine[0]], feed_forward);
    let lead = if mode == LoopMode::Speed { model.demand_lead() } else { 0 };
    let advanced = |k: usize| demand[(k + lead).min(SAMPLES - 1)];
    let u = Mat::from_fn(SAMPLES, 2, |k, j| if j == 0 { advanced(k) } else { engine[k] });
    let found = form.system.simulate(u.as_ref(), &initial).unwrap();
    let series = [
        &expected.dyno_speed_rad_s,
        &expected.engine_speed_rad_s,
        &expected.air_gap_torque_nm,
        &expected.shaft_torque_nm,
        &expected.torque_demand_nm,
    ];
    let of = |(output, series): (usize, &&Vec<f64>)| {
        let scale = series.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
        (0..SAMPLES).map(|k| (found[(k, output)] - series[k]).abs() / scale).fold(0.0, f64::max)
    };
    series.iter().enumerate().map(of).fold(0.0, f64::max)
}

#[test]
fn exact_the_linear_form_is_the_simulation() {
    for mode in [LoopMode::Speed, LoopMode::Torque] {
        assert!(difference(&bench_a(), mode) < 1e-11, "{mode:?}: {}", difference(&bench_a(), mode));
    }
}

#[test]
fn exact_without_lag_gate_or_feed_forward_too() {
    let bare = BenchModel {
        feed_forward: None,
        torque_control: Some(TorqueControlModel { delay_s: 0.0, bandwidth_rad_s: None }),
        encoder_gate_s: 0.0,
        ..bench_a()
    };
    for mode in [LoopMode::Speed, LoopMode::Torque] {
        assert!(difference(&bare, mode) < 1e-11, "{mode:?}: {}", difference(&bare, mode));
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]
    #[test]
    fn prop_any_delays_and_gates(
        (controller, demand, torque, feed) in (0.0_f64..4e-3, -3_i32..4, 0.0_f64..4e-3, -3_i32..4),
        gate in prop_oneof![Just(0.0), Just(1e-3), Just(2e-3), 1e-4_f64..5e-3],
    ) {
        let mut model = bench_a();
        let pi = model.speed_controller.as_mut().unwrap();
        pi.delay_s = controller;
        pi.demand_delay_s = controller + f64::from(demand) * 1e-3;
        model.feed_forward.as_mut().unwrap().delay_s = f64::from(feed) * 1e-3;
        model.torque_control.as_mut().unwrap().delay_s = torque;
        model.encoder_gate_s = gate;
        for mode in [LoopMode::Speed, LoopMode::Torque] {
            let found = difference(&model, mode);
            prop_assert!(found < 1e-9, "{:?}: {}", mode, found);
        }
    }
}

#[test]
fn regress_missing_parts_are_named() {
    let without = BenchModel { speed_controller: None, ..bench_a() };
    let error = linear_form(&without, LoopMode::Speed, 1e-3).unwrap_err();
    assert!(error.to_string().contains("no speed controller"), "{error}");
    let without = BenchModel { torque_control: None, ..bench_a() };
    let error = linear_form(&without, LoopMode::Torque, 1e-3).unwrap_err();
    assert!(error.to_string().contains("no torque control"), "{error}");
}
