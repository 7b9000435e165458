//! Speed control over a long time, compared with every sample simulated.

use bench_model::model::BenchModel;
use bench_model::simulate::{
    CourseInputs, DynoInput, InitialState, Inputs, Response, SimulationError, simulate, simulate_course,
};
use rig::bench_parameters::BenchParameters;
use rig::results::Part;

const STEP: usize = 5;

/// Speed and torque that bend at every second, in steps of 5 ms.
fn demands(torque_nm: f64) -> (Vec<f64>, Vec<f64>) {
    let levels = [120.0, 120.0, 180.0, 150.0, 150.0, 260.0, 240.0, 130.0, 130.0, 130.0];
    let between = |time: f64, levels: &[f64]| {
        let low = (time.floor() as usize).min(levels.len() - 1);
        let next = levels[(low + 1).min(levels.len() - 1)];
        levels[low] + time.fract() * (next - levels[low])
    };
    let torques: Vec<f64> = levels.iter().map(|level| torque_nm * (level - 120.0) / 100.0).collect();
    let times = (0..=1900).map(|k| f64::from(k) * 0.005);
    times.map(|time| (between(time, &levels), between(time, &torques))).unzip()
}

/// The same on every sample.
fn every_sample(values: &[f64]) -> Vec<f64> {
    let at = |k: usize| {
        let (low, share) = (k / STEP, (k % STEP) as f64 / STEP as f64);
        let next = values[(low + 1).min(values.len() - 1)];
        values[low] + share * (next - values[low])
    };
    (0..=(values.len() - 1) * STEP).map(at).collect()
}

fn compared(model: &BenchModel, torque_nm: f64) -> (bench_model::simulate::Course, Response) {
    let (speed, torque) = demands(torque_nm);
    let start = InitialState::steady(model, speed[0], torque[0]);
    let inputs = CourseInputs { step_samples: STEP, speed_demand_rad_s: &speed, engine_torque_nm: &torque };
    let course = simulate_course(model, &inputs, &start).unwrap();
    let (speed, torque) = (every_sample(&speed), every_sample(&torque));
    let inputs = Inputs { sample_time_s: 1e-3, engine_torque_nm: &torque, dyno: DynoInput::SpeedDemand(&speed) };
    (course, simulate(model, &inputs, &start).unwrap())
}

fn worst(course: &[f64], response: &[f64]) -> f64 {
    let samples = response.iter().step_by(STEP);
    course.iter().zip(samples).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn ref_a_long_run_equals_the_same_run_sample_by_sample() {
    let model = BenchModel::of(&BenchParameters::default());
    let (course, response) = compared(&model, 100.0);
    assert_eq!(course.stepped, 0);
    let torque = worst(&course.shaft_torque_nm, &response.shaft_torque_nm);
    assert!(torque < 1.0, "{torque} Nm of {}", response.shaft_torque_nm.iter().copied().fold(0.0, f64::max));
    let demand = worst(&course.torque_demand_nm, &response.torque_demand_nm);
    assert!(demand < 2.0, "{demand} Nm");
    // The response reads speeds as means over the gate of the encoder.
    let speed = worst(&course.dyno_speed_rad_s, &response.dyno_speed_rad_s);
    assert!(speed < 0.2, "{speed} rad/s");
}

#[test]
fn ref_a_long_run_at_the_torque_limit_equals_the_same_run_sample_by_sample() {
    let free = BenchModel::of(&BenchParameters::default());
    let model = BenchModel { torque_limit_nm: Some(60.0), ..free.clone() };
    let (course, response) = compared(&model, 100.0);
    assert!(course.stepped > 100 && response.limited_share > 0.05, "{} {}", course.stepped, response.limited_share);
    let torque = worst(&course.shaft_torque_nm, &response.shaft_torque_nm);
    assert!(torque < 1.0, "{torque} Nm");
    let held = worst(&course.dyno_speed_rad_s, &response.dyno_speed_rad_s);
    assert!(held < 0.3, "{held} rad/s");
    // Without the limit the run is another one.
    let (unlimited, _) = compared(&free, 100.0);
    assert!(worst(&unlimited.dyno_speed_rad_s, &response.dyno_speed_rad_s) > 10.0 * held);
}

#[test]
fn regress_what_a_long_run_lacks_is_named() {
    let model = BenchModel { speed_controller: None, ..BenchModel::of(&BenchParameters::default()) };
    let start = InitialState::steady(&model, 100.0, 0.0);
    let inputs = CourseInputs { step_samples: 5, speed_demand_rad_s: &[1.0, 1.0], engine_torque_nm: &[0.0, 0.0] };
    let error = simulate_course(&model, &inputs, &start).unwrap_err();
    assert_eq!(error, SimulationError::MissingPart { part: Part::SpeedController });
    let inputs = CourseInputs { engine_torque_nm: &[0.0], ..inputs };
    let model = BenchModel::of(&BenchParameters::default());
    assert!(matches!(simulate_course(&model, &inputs, &start), Err(SimulationError::Length { .. })));
}
