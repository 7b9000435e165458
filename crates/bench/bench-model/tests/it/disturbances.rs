//! Errors of the encoder and ripple of the drive in a run.

use bench_model::disturbances::Disturbances;
use bench_model::drive_ripple::RippleLine;
use bench_model::model::BenchModel;
use bench_model::simulate::{Acting, DynoInput, InitialState, Inputs, Response, simulate_acted_on};
use rig::bench_parameters::BenchParameters;

const SPEED_RAD_S: f64 = 250.0;
const TORQUE_NM: f64 = 80.0;

/// A bench at a constant speed and torque.
fn run(model: &BenchModel, of: Disturbances) -> Response {
    const SAMPLES: usize = 4000;
    let inputs = Inputs {
        sample_time_s: 1e-3,
        engine_torque_nm: &[TORQUE_NM; SAMPLES],
        dyno: DynoInput::SpeedDemand(&[SPEED_RAD_S; SAMPLES]),
    };
    let acting = Acting { disturbances: Some((of, 5)), ..Acting::default() };
    simulate_acted_on(model, &inputs, &acting, &InitialState::steady(model, SPEED_RAD_S, TORQUE_NM)).unwrap()
}

/// √2 of the standard deviation, which is the amplitude of a sine; of the second half.
fn amplitude(values: &[f64]) -> f64 {
    let values = &values[values.len() / 2..];
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    (2.0 * values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / values.len() as f64).sqrt()
}

/// Once a turn is far above the bandwidth of the speed control, so that the controller passes on what the encoder
/// reads.
#[test]
fn exact_the_controller_answers_the_errors_of_the_encoder() {
    let model = BenchModel::of(&BenchParameters::default());
    let gain = model.speed_controller.unwrap().proportional_nm_s_per_rad;
    let none = run(&model, Disturbances::default());
    assert!(amplitude(&none.torque_demand_nm) < 1e-9, "{}", amplitude(&none.torque_demand_nm));
    let once_a_turn = 4e-4;
    let turned = amplitude(&run(&model, Disturbances { once_a_turn, ..Disturbances::default() }).torque_demand_nm);
    let wanted = gain * once_a_turn * SPEED_RAD_S;
    assert!((turned / wanted - 1.0).abs() < 0.15, "{turned} for {wanted}");
    let speed_noise_rad_s = 0.01;
    let noisy = run(&model, Disturbances { speed_noise_rad_s, ..Disturbances::default() });
    let (found, wanted) = (amplitude(&noisy.torque_demand_nm), 2f64.sqrt() * gain * speed_noise_rad_s);
    assert!((found / wanted - 1.0).abs() < 0.1, "{found} for {wanted}");
    // What a limit of the speed counts is the speed itself.
    assert!(amplitude(&noisy.dyno_speed_rad_s) < 0.5 * speed_noise_rad_s);
}

#[test]
fn exact_the_ripple_of_the_drive_adds_to_its_torque_and_multiplies_it() {
    let model = BenchModel::of(&BenchParameters::default());
    let line = RippleLine { frequency_hz: 100.0, additive_nm: [0.3, 0.4], relative: [0.012, 0.016] };
    let rippled = run(&model, Disturbances { ripple: Some(line), ..Disturbances::default() });
    let (found, wanted) = (amplitude(&rippled.air_gap_torque_nm), 0.5 + 0.02 * TORQUE_NM);
    assert!((found / wanted - 1.0).abs() < 0.05, "{found} for {wanted}");
}
