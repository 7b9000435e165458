//! The model's linear forms and its simulation.

use std::f64::consts::TAU;

use bench_model::model::{BenchModel, Mechanics, ModelParameter, ModelUncertainty, PartCovariance, TorqueControlModel};
use bench_model::simulate::{DynoInput, InitialState, Inputs, Ripple, SimulationError, simulate, simulate_with_ripple};
use bench_testkit::models::bench_a;
use proptest::prelude::*;
use rig::facts::Engine;
use rig::results::Part;

fn grid(count: usize) -> impl Iterator<Item = f64> {
    (0..count).map(|i| i as f64 * 1e-3)
}

#[test]
fn exact_static_gain_and_resonance_match_the_closed_form() {
    let mechanics = bench_a().mechanics;
    assert!((mechanics.torque_to_shaft(1e-3).norm() - 0.28 / 0.88).abs() < 1e-9);
    assert!((mechanics.static_gain() - 0.28 / 0.88).abs() < 1e-15);
    let found = mechanics.resonance();
    let at = |f: f64| mechanics.torque_to_shaft(TAU * f).norm();
    assert!((at(found.frequency_hz) - found.gain).abs() < 1e-12 * found.gain);
    assert!(at(found.frequency_hz * 1.0001) < found.gain && at(found.frequency_hz * 0.9999) < found.gain);
    assert!((found.natural_frequency_hz - (2437.7 * (1.0 / 0.6 + 1.0 / 0.28_f64)).sqrt() / TAU).abs() < 1e-12);
}

#[test]
fn exact_firing_of_four_cylinders_meets_18_hz_at_540_rpm() {
    let engine = Engine { cylinders: 4, strokes: 4 };
    assert!((engine.firing_speed_rpm(18.0) - 540.0).abs() < 1e-12);
    assert_eq!(engine.orders(), [0.5, 1.0, 2.0]);
    assert!((Engine { strokes: 2, ..engine }.firing_speed_rpm(18.0) - 270.0).abs() < 1e-12);
}

#[test]
fn exact_free_oscillation_decays_as_the_poles_say() {
    let mut model = bench_a();
    model.encoder_gate_s = 0.0;
    let mechanics = model.mechanics;
    let start = InitialState { twist_rad: 0.01, ..InitialState::steady(&model, 100.0, 0.0) };
    let zeros = vec![0.0; 400];
    let inputs = Inputs { sample_time_s: 1e-3, engine_torque_nm: &zeros, dyno: DynoInput::AirGapTorque(&zeros) };
    let response = simulate(&model, &inputs, &start).unwrap();
    let found = mechanics.resonance();
    let omega = TAU * found.natural_frequency_hz;
    let damped = omega * (1.0 - found.damping_ratio.powi(2)).sqrt();
    for (k, t) in grid(400).enumerate() {
        // Δθ(t) from Δθ(0) = 0.01 at rest; ω_e − ω_d is its derivative.
        let decay = (-found.damping_ratio * omega * t).exp();
        let slope = -0.01 * omega * omega / damped * decay * (damped * t).sin();
        let difference = response.engine_speed_rad_s[k] - response.dyno_speed_rad_s[k];
        assert!((difference - slope).abs() < 1e-10, "{k}: {difference} {slope}");
    }
}

#[test]
fn exact_momentum_is_the_integral_of_the_torques() {
    let mut model = bench_a();
    model.encoder_gate_s = 0.0;
    let engine: Vec<f64> = grid(1001).map(|t| 50.0 + 20.0 * t).collect();
    let brake = vec![30.0; 1001];
    let start = InitialState::steady(&model, 100.0, 30.0);
    let inputs = Inputs { sample_time_s: 1e-3, engine_torque_nm: &engine, dyno: DynoInput::AirGapTorque(&brake) };
    let response = simulate(&model, &inputs, &start).unwrap();
    let momentum = |k: usize| 0.6 * response.dyno_speed_rad_s[k] + 0.28 * response.engine_speed_rad_s[k];
    assert!((momentum(1000) - momentum(0) - 30.0).abs() < 1e-9);
}

#[test]
fn exact_energy_stays_without_damping() {
    let mut model = bench_a();
    model.mechanics.damping_nm_s_per_rad = 0.0;
    model.encoder_gate_s = 0.0;
    let zeros = vec![0.0; 5000];
    let start = InitialState { twist_rad: 0.02, ..InitialState::steady(&model, 0.0, 0.0) };
    let inputs = Inputs { sample_time_s: 1e-3, engine_torque_nm: &zeros, dyno: DynoInput::AirGapTorque(&zeros) };
    let response = simulate(&model, &inputs, &start).unwrap();
    let energy = |k: usize| {
        let (d, e) = (response.dyno_speed_rad_s[k], response.engine_speed_rad_s[k]);
        0.5 * (0.6 * d * d + 0.28 * e * e + response.shaft_torque_nm[k].powi(2) / 2437.7)
    };
    assert!((energy(4999) / energy(0) - 1.0).abs() < 1e-9);
}

#[test]
fn exact_steady_bench_stays_steady_in_speed_control() {
    let model = bench_a();
    let (speed, torque) = (vec![125.0; 3000], vec![60.0; 3000]);
    let start = InitialState::steady(&model, 125.0, 60.0);
    let dyno = DynoInput::SpeedDemand(&speed);
    let response = simulate(&model, &Inputs { sample_time_s: 1e-3, engine_torque_nm: &torque, dyno }, &start).unwrap();
    assert!(response.dyno_speed_rad_s.iter().all(|n| (n - 125.0).abs() < 1e-8));
    assert!(response.torque_demand_nm.iter().all(|t| (t - 60.0).abs() < 1e-6));
}

#[test]
fn exact_speed_control_answers_a_sine_of_the_engine_as_the_closed_loop_says() {
    let mut model = bench_a();
    model.speed_controller.as_mut().unwrap().delay_s = 1.3e-3;
    let f = 8.0;
    let torque: Vec<f64> = grid(8000).map(|t| 60.0 + (TAU * f * t).cos()).collect();
    let speed = vec![125.0; torque.len()];
    let start = InitialState::steady(&model, 125.0, 60.0);
    let dyno = DynoInput::SpeedDemand(&speed);
    let response = simulate(&model, &Inputs { sample_time_s: 1e-3, engine_torque_nm: &torque, dyno }, &start).unwrap();
    let (mut re, mut im) = (0.0, 0.0);
    for (t, n) in grid(8000).zip(&response.dyno_speed_rad_s).skip(7000) {
        re += (n - 125.0) * (TAU * f * t).cos() * 2e-3;
        im -= (n - 125.0) * (TAU * f * t).sin() * 2e-3;
    }
    // The encoder shows the speed through its gate of 1 ms: 0.5 ms late.
    let expected = model.engine_to_speed_controlled(TAU * f).unwrap().norm();
    assert!((re.hypot(im) / expected - 1.0).abs() < 2e-3, "{} {expected}", re.hypot(im));
}

#[test]
fn exact_limit_is_kept_and_does_not_wind_up() {
    let mut model = bench_a();
    model.torque_limit_nm = Some(80.0);
    let torque: Vec<f64> = grid(6000).map(|t| if t > 0.5 && t < 2.5 { 120.0 } else { 60.0 }).collect();
    let speed = vec![125.0; torque.len()];
    let start = InitialState::steady(&model, 125.0, 60.0);
    let dyno = DynoInput::SpeedDemand(&speed);
    let response = simulate(&model, &Inputs { sample_time_s: 1e-3, engine_torque_nm: &torque, dyno }, &start).unwrap();
    assert!(response.torque_demand_nm.iter().all(|t| t.abs() <= 80.0));
    assert!(response.limited_share > 0.3);
    assert!((response.torque_demand_nm[0] - 60.0).abs() < 1e-9);
}

#[test]
fn exact_missing_parts_are_named() {
    let mut model = bench_a();
    model.speed_controller = None;
    let dyno = DynoInput::SpeedDemand(&[1.0]);
    let inputs = Inputs { sample_time_s: 1e-3, engine_torque_nm: &[0.0], dyno };
    let start = InitialState::steady(&model, 1.0, 0.0);
    let error = simulate(&model, &inputs, &start).unwrap_err();
    assert_eq!(error, SimulationError::MissingPart { part: Part::SpeedController });
}

#[test]
fn stat_delta_method_agrees_with_sampling() {
    let model = bench_a();
    let (sd_k, sd_b, correlation) = (20.0, 0.15, -0.4);
    let cross = correlation * sd_k * sd_b;
    let uncertainty = ModelUncertainty::new(&[PartCovariance {
        parameters: vec![ModelParameter::Stiffness, ModelParameter::Damping],
        covariance: vec![vec![sd_k * sd_k, cross], vec![cross, sd_b * sd_b]],
        degrees_of_freedom: 40.0,
    }])
    .unwrap();
    let functions: [fn(&BenchModel) -> f64; 3] = [
        |m| m.mechanics.resonance().frequency_hz,
        |m| m.mechanics.resonance().gain,
        |m| m.mechanics.resonance().damping_ratio,
    ];
    let mut noise = Normals(7);
    let draws: Vec<BenchModel> = (0..20_000)
        .map(|_| {
            let (z1, z2) = (noise.next(), noise.next());
            let b = sd_b * (correlation * z1 + (1.0 - correlation * correlation).sqrt() * z2);
            model.with(ModelParameter::Stiffness, 2437.7 + sd_k * z1).with(ModelParameter::Damping, 5.8 + b)
        })
        .collect();
    for function in functions {
        let derived = uncertainty.propagate(&model, function);
        let values: Vec<f64> = draws.iter().map(function).collect();
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        let sd = (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / values.len() as f64).sqrt();
        assert!((derived.standard_error / sd - 1.0).abs() < 0.03, "{} {sd}", derived.standard_error);
        assert!((derived.degrees_of_freedom - 40.0).abs() < 1e-6);
    }
}

/// Standard normals, by a linear congruential generator and the sum of twelve.
struct Normals(u64);

impl Normals {
    fn next(&mut self) -> f64 {
        let mut uniform = || {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 11) as f64 / (1_u64 << 53) as f64
        };
        (0..12).map(|_| uniform()).sum::<f64>() - 6.0
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn prop_peak_is_the_largest_gain(jd in 0.05..3.0_f64, je in 0.05..3.0_f64, k in 200.0..20_000.0_f64, b in 0.1..20.0_f64) {
        let mechanics = Mechanics {
            dyno_inertia_kg_m2: jd,
            engine_inertia_kg_m2: je,
            stiffness_nm_per_rad: k,
            damping_nm_s_per_rad: b,
        };
        let peak = mechanics.resonance();
        for i in 1..400 {
            let f = peak.natural_frequency_hz * 0.01 * f64::from(i);
            prop_assert!(mechanics.torque_to_shaft(TAU * f).norm() <= peak.gain * (1.0 + 1e-12));
        }
    }

    #[test]
    fn prop_step_does_not_change_the_answer(delay in 0.0..5e-3_f64, tau in 0.0..3e-3_f64) {
        // The demand of torque control is a step; its answer at whole milliseconds is the same on half the grid.
        let mut model = bench_a();
        model.torque_control = Some(TorqueControlModel { delay_s: delay, bandwidth_rad_s: Some(565.5) });
        model.speed_controller.as_mut().unwrap().delay_s = tau;
        model.encoder_gate_s = 1e-3;
        let run = |step: f64, count: usize| {
            let demand: Vec<f64> = (0..count).map(|i| if i as f64 * step < 0.0205 - 1e-9 { 10.0 } else { 40.0 }).collect();
            let engine = vec![10.0; count];
            let inputs = Inputs { sample_time_s: step, engine_torque_nm: &engine, dyno: DynoInput::TorqueDemand(&demand) };
            simulate(&model, &inputs, &InitialState::steady(&model, 100.0, 10.0)).unwrap()
        };
        let (coarse, fine) = (run(0.5e-3, 200), run(0.25e-3, 400));
        for k in 0..200 {
            prop_assert!((coarse.dyno_speed_rad_s[k] - fine.dyno_speed_rad_s[2 * k]).abs() < 1e-9);
            prop_assert!((coarse.shaft_torque_nm[k] - fine.shaft_torque_nm[2 * k]).abs() < 1e-8);
        }
    }
}

#[test]
fn exact_ripple_brakes_the_dynamometer_as_all_of_its_torque_does() {
    let model = bench_a();
    let (demand, engine) = (vec![60.0; 4000], vec![60.0; 4000]);
    let wave: Vec<f64> = grid(4000).map(|t| (TAU * 18.0 * t).sin()).collect();
    let (relative, added_nm): (Vec<f64>, Vec<f64>) = wave.iter().map(|w| (0.01 * w, 0.4 * w)).unzip();
    let inputs = Inputs { sample_time_s: 1e-3, engine_torque_nm: &engine, dyno: DynoInput::TorqueDemand(&demand) };
    let start = InitialState::steady(&model, 125.0, 60.0);
    let ripple = Ripple { relative: &relative, added_nm: &added_nm };
    let rippled = simulate_with_ripple(&model, &inputs, ripple, &start).unwrap();
    let given: Vec<f64> = wave.iter().map(|w| 60.0 + w).collect();
    let inputs_given = Inputs { dyno: DynoInput::AirGapTorque(&given), ..inputs };
    let expected = simulate(&model, &inputs_given, &start).unwrap();
    for k in 0..given.len() {
        assert!((rippled.air_gap_torque_nm[k] - given[k]).abs() < 1e-9);
        assert!((rippled.shaft_torque_nm[k] - expected.shaft_torque_nm[k]).abs() < 1e-7);
    }
    let short = Ripple { relative: &[0.0], added_nm: &[] };
    let error = simulate_with_ripple(&model, &inputs, short, &start).unwrap_err();
    assert_eq!(error, SimulationError::Length { what: "ripple", expected: 4000, found: 1 });
}
