//! The analysis of the assembled model.

use std::collections::BTreeMap;
use std::f64::consts::TAU;

use bench_model::analysis::{Influence, WholeInputs, margins, whole_model};
use bench_model::model::{ModelParameter, ModelUncertainty, PartCovariance};
use bench_model::simulate::{DynoInput, InitialState, Inputs, simulate};
use bench_model::skews::SignalSkews;
use part_lines::segments::steady_sines;
use part_lines::sine::{SineTest, sine_points};
use rig::facts::Engine;
use rig::results::Quantity;
use rig::{Experiment, Role};
use signal::Signal;

use bench_testkit::models::bench_a;

const ENGINE: Engine = Engine { cylinders: 4, strokes: 4 };

fn uncertainty() -> ModelUncertainty {
    ModelUncertainty::new(&[PartCovariance {
        parameters: vec![ModelParameter::Stiffness, ModelParameter::Damping],
        covariance: vec![vec![100.0, 0.0], vec![0.0, 0.01]],
        degrees_of_freedom: 30.0,
    }])
    .unwrap()
}

/// Sines of 1, 2, … Hz, three seconds each, held for 10 ms as a demand is.
fn sines(highest: usize) -> Vec<f64> {
    let frequency = |i: usize| 1.0 + (i / 3000) as f64;
    (0..3000 * highest).map(|i| 60.0 + 20.0 * (TAU * frequency(i) * (i / 10 * 10) as f64 * 1e-3).sin()).collect()
}

/// A sine test on the model with an engine whose torque depends on its speed, as a governor's would.
fn sine_test(highest: usize, governor: f64) -> Experiment {
    let model = bench_a();
    let demand = sines(highest);
    let engine: Vec<f64> = (0..demand.len())
        .map(|i| 60.0 + governor * (TAU * (1.0 + (i / 3000) as f64) * i as f64 * 1e-3 + 0.7).sin())
        .collect();
    let start = InitialState::steady(&model, 125.0, 60.0);
    let inputs = Inputs { sample_time_s: 1e-3, engine_torque_nm: &engine, dyno: DynoInput::TorqueDemand(&demand) };
    let response = simulate(&model, &inputs, &start).unwrap();
    let signal = |samples: Vec<f64>| Signal::new(0.0, 1e-3, samples).unwrap();
    let signals = BTreeMap::from([
        (Role::DynoSpeed, signal(response.dyno_speed_rad_s)),
        (Role::EngineSpeed, signal(response.engine_speed_rad_s)),
        (Role::DynoTorqueDemand, signal(demand)),
        (Role::AirGapTorque, signal(response.air_gap_torque_nm)),
    ]);
    Experiment { file: "sine".into(), label: "Sine_T_TN".parse().unwrap(), signals }
}

#[test]
fn exact_steady_sines_are_found_with_their_frequencies() {
    let demand = Signal::new(2.5, 1e-3, sines(25)).unwrap();
    let found = steady_sines(&demand);
    assert_eq!(found.len(), 25);
    for (i, segment) in found.iter().enumerate() {
        let start = 2.5 + 3.0 * i as f64;
        assert!((segment.frequency_hz - (i + 1) as f64).abs() < 5e-3, "{segment:?}");
        assert!(segment.start_s > start - 0.25 && segment.end_s < start + 3.25, "{segment:?}");
        assert!(segment.end_s - segment.start_s > 2.0, "{segment:?}");
    }
}

#[test]
fn exact_noise_holds_no_sine() {
    let mut state = 1_u64;
    let mut step = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (state >> 33) as f64
    };
    let samples = (0..3000).map(|_| step()).flat_map(|v| [v; 10]).collect();
    assert!(steady_sines(&Signal::new(0.0, 1e-3, samples).unwrap()).is_empty());
    assert!(steady_sines(&Signal::new(0.0, 1e-3, vec![3.0; 5000]).unwrap()).is_empty());
}

#[test]
fn exact_sine_gains_are_those_of_the_curve_once_the_engine_is_accounted_for() {
    // N_d lags by half its gate, T_d does not: seen from N_d, T_d is early by half a gate.
    let skews = SignalSkews { engine_speed_s: 0.0, torque_s: -0.5e-3 };
    for governor in [0.0, 5.0] {
        let experiment = sine_test(20, governor);
        let model = bench_a();
        let test = SineTest { experiment: &experiment, air_gap_torque: None, skews };
        let uncertainty = uncertainty();
        let points = sine_points(&model, ENGINE, &test).unwrap();
        let inputs = WholeInputs { model: &model, uncertainty: &uncertainty, engine: ENGINE, sine_points: &points };
        let whole = whole_model(&inputs);
        assert_eq!(whole.sine_points.len(), 20);
        for point in &whole.sine_points {
            let corrected = point.gain_corrected_for_engine.unwrap();
            let with_engine = point.model_gain_with_engine.unwrap();
            assert!((corrected / point.model_gain - 1.0).abs() < 0.01, "{governor} {point:?}");
            assert!((with_engine / point.gain - 1.0).abs() < 0.01, "{governor} {point:?}");
            if governor == 0.0 {
                assert!((point.gain / point.model_gain - 1.0).abs() < 0.02, "{point:?}");
            }
        }
        let marked: Vec<f64> = whole.sine_points.iter().filter(|p| p.at_engine_order).map(|p| p.frequency_hz).collect();
        // 125 rad/s are 19.9 turns a second: orders 0.5 and 1 are near 10 and 20 Hz.
        assert_eq!(marked.iter().map(|f| f.round()).collect::<Vec<f64>>(), vec![10.0, 20.0]);
    }
}

#[test]
fn exact_curves_and_margins_of_the_speed_loop() {
    let model = bench_a();
    let uncertainty = uncertainty();
    let inputs = WholeInputs { model: &model, uncertainty: &uncertainty, engine: ENGINE, sine_points: &[] };
    let whole = whole_model(&inputs);
    assert_eq!(whole.bode.len(), 6);
    for curve in &whole.bode {
        assert!(curve.frequencies_hz.len() > 190 && curve.frequencies_hz.is_sorted());
        assert!(curve.gain_band_db.0.iter().zip(&curve.gain_db).all(|(low, g)| low <= g));
        assert!(curve.phase_deg.iter().all(|p| p.is_finite()));
    }
    // A speed demand that hardly changes is followed.
    assert!(whole.bode[0].gain_db[0].abs() < 0.2);
    let found = whole.speed_loop_margins.unwrap();
    let at = model.open_loop(TAU * found.crossover_hz).unwrap();
    assert!((at.norm() - 1.0).abs() < 1e-9);
    assert!((at.arg().to_degrees() + 180.0 - found.phase_margin_deg).rem_euclid(360.0).min(1.0) < 1e-6);
    // With the gain raised by the gain margin the loop passes through −1.
    let mut raised = model.clone();
    let factor = 10_f64.powf(found.gain_margin_db / 20.0);
    let pi = raised.speed_controller.as_mut().unwrap();
    pi.proportional_nm_s_per_rad *= factor;
    pi.integral_nm_per_rad *= factor;
    assert!(margins(&raised).unwrap().gain_margin_db.abs() < 1e-6);
}

/// f_r of a lightly damped shaft is √(K (1/J_d + 1/J_e)), J_d = 0.6 and J_e = 0.28: half a per cent a per cent of K,
/// and of each inertia half its part in 1/J_d + 1/J_e.
#[test]
fn exact_what_each_parameter_does_to_the_resonance() {
    let mut model = bench_a();
    model.mechanics.damping_nm_s_per_rad = 0.05;
    let found = |covariance: Vec<Vec<f64>>| {
        let parameters = vec![ModelParameter::Stiffness, ModelParameter::Damping];
        let part = PartCovariance { parameters, covariance, degrees_of_freedom: 30.0 };
        let uncertainty = ModelUncertainty::new(&[part]).unwrap();
        let inputs = WholeInputs { model: &model, uncertainty: &uncertainty, engine: ENGINE, sine_points: &[] };
        whole_model(&inputs).influences
    };
    let alone = found(vec![vec![100.0, 0.0], vec![0.0, 1e-6]]);
    let of = |all: &[Influence], quantity: Quantity, parameter: ModelParameter| {
        let influence = all.iter().find(|i| i.quantity == quantity).unwrap();
        *influence.parameters.iter().find(|p| p.parameter == parameter).unwrap()
    };
    let (stiffness, engine) = (
        of(&alone, Quantity::ResonanceFrequency, ModelParameter::Stiffness),
        of(&alone, Quantity::ResonanceFrequency, ModelParameter::EngineInertia),
    );
    assert!((stiffness.elasticity - 0.5).abs() < 1e-3, "{stiffness:?}");
    assert!((stiffness.variance_share.unwrap() - 1.0).abs() < 1e-3, "{stiffness:?}");
    assert!((engine.elasticity + 0.5 * 0.6 / 0.88).abs() < 1e-3, "{engine:?}");
    assert_eq!(engine.variance_share, None);
    // The damping ratio is B/2 √((1/J_d + 1/J_e)/K).
    let damping = of(&alone, Quantity::ResonanceDampingRatio, ModelParameter::Damping);
    assert!((damping.elasticity - 1.0).abs() < 1e-3, "{damping:?}");
    let total: f64 = alone
        .iter()
        .find(|i| i.quantity == Quantity::ResonanceDampingRatio)
        .unwrap()
        .parameters
        .iter()
        .filter_map(|p| p.variance_share)
        .sum();
    assert!((total - 1.0).abs() < 1e-9, "{total}");
    // Where two are known together, knowing either leaves nothing.
    let together = found(vec![vec![100.0, 0.01 * (1.0 - 1e-9)], vec![0.01 * (1.0 - 1e-9), 1e-6]]);
    for parameter in [ModelParameter::Stiffness, ModelParameter::Damping] {
        let share = of(&together, Quantity::ResonanceDampingRatio, parameter).variance_share.unwrap();
        assert!((share - 1.0).abs() < 1e-6, "{parameter:?}: {share}");
    }
}

#[test]
fn exact_what_the_model_lacks_is_left_out() {
    let mut model = bench_a();
    model.speed_controller = None;
    model.torque_control = None;
    let uncertainty = ModelUncertainty::default();
    let inputs = WholeInputs { model: &model, uncertainty: &uncertainty, engine: ENGINE, sine_points: &[] };
    let whole = whole_model(&inputs);
    assert_eq!(whole.bode.len(), 2);
    assert!(whole.speed_loop_margins.is_none());
    assert_eq!(whole.resonance_hz.standard_error, 0.0);
}
