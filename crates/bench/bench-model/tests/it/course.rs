//! Speed control over a long time, compared with every sample simulated.

use bench_model::friction::DynoFriction;
use bench_model::model::{BenchModel, FeedForwardGains, PiController, TorqueControlModel};
use bench_model::simulate::{
    Acting, Course, CourseInputs, DynoInput, InitialState, Inputs, Response, SimulationError, simulate_acted_on,
    simulate_course,
};
use proptest::prelude::*;
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

fn compared(model: &BenchModel, torque_nm: f64) -> (Course, Response) {
    compared_with(model, torque_nm, DynoFriction::default())
}

fn compared_with(model: &BenchModel, torque_nm: f64, friction: DynoFriction) -> (Course, Response) {
    let (speed, torque) = demands(torque_nm);
    let start = InitialState::steady(model, speed[0], torque[0]).with_friction(friction.torque_nm(speed[0]));
    let inputs = CourseInputs { step_samples: STEP, speed_demand_rad_s: &speed, engine_torque_nm: &torque, friction };
    let course = simulate_course(model, &inputs, &start).unwrap();
    let (speed, torque) = (every_sample(&speed), every_sample(&torque));
    let inputs = Inputs { sample_time_s: 1e-3, engine_torque_nm: &torque, dyno: DynoInput::SpeedDemand(&speed) };
    let acting = Acting { friction, ..Acting::default() };
    (course, simulate_acted_on(model, &inputs, &acting, &start).unwrap())
}

fn worst(course: &[f64], response: &[f64]) -> f64 {
    let samples = response.iter().step_by(STEP);
    course.iter().zip(samples).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// Fails unless torques are the same, but for rounding.
fn assert_same(course: &Course, response: &Response) {
    for (coarse, fine) in
        [(&course.shaft_torque_nm, &response.shaft_torque_nm), (&course.torque_demand_nm, &response.torque_demand_nm)]
    {
        let largest = fine.iter().fold(1.0, |most: f64, value| most.max(value.abs()));
        let difference = worst(coarse, fine);
        assert!(difference < 1e-8 * largest, "{difference} Nm of {largest}");
    }
}

#[test]
fn ref_a_long_run_equals_the_same_run_sample_by_sample() {
    let model = BenchModel::of(&BenchParameters::default());
    let (course, response) = compared(&model, 100.0);
    assert_eq!(course.stepped, 0);
    assert_same(&course, &response);
    // The response reads speeds as means over the gate of the encoder.
    let speed = worst(&course.dyno_speed_rad_s, &response.dyno_speed_rad_s);
    assert!(speed < 0.2, "{speed} rad/s");
}

/// The default bench with a demand that is late or early, delays of parts of a sample and a gate of the encoder.
fn delayed(error: f64, fed: f64, controller: f64, torque_control: f64, gate: f64) -> BenchModel {
    let model = BenchModel::of(&BenchParameters::default());
    let sample = 1e-3;
    let delay_s = controller * sample;
    BenchModel {
        speed_controller: model.speed_controller.map(|pi| PiController {
            delay_s,
            demand_delay_s: delay_s + error * sample,
            sample_time_s: sample,
            ..pi
        }),
        feed_forward: Some(FeedForwardGains {
            speed_nm_s_per_rad: 0.05,
            acceleration_nm_s2_per_rad: 0.6,
            delay_s: fed * sample,
        }),
        torque_control: model
            .torque_control
            .map(|control| TorqueControlModel { delay_s: torque_control * sample, ..control }),
        encoder_gate_s: gate * sample,
        ..model
    }
}

#[test]
fn regress_a_feed_forward_ahead_of_the_error_by_more_than_a_step_runs_to_the_end() {
    for lead in [-1.0, -4.0, -5.0, -6.0, -11.0] {
        let model = delayed(0.0, lead, 2.0, 1.0, 1.0);
        let (course, response) = compared(&model, 20.0);
        assert_same(&course, &response);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]
    #[test]
    fn prop_a_long_run_equals_the_same_run_sample_by_sample_whatever_is_late_or_early(
        (error, fed) in (-6.0_f64..6.0, -6.0_f64..6.0),
        (controller, torque_control, gate) in (0.0_f64..3.0, 0.0_f64..2.5, prop_oneof![Just(0.0), 0.5_f64..2.5]),
    ) {
        let model = delayed(error, fed, controller, torque_control, gate);
        let (course, response) = compared(&model, 20.0);
        prop_assert_eq!(course.stepped, 0);
        assert_same(&course, &response);
    }
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
fn exact_friction_is_taken_off_the_torque_of_the_dynamometer() {
    let model = BenchModel::of(&BenchParameters::default());
    let friction = DynoFriction { coulomb_nm: 2.0, viscous_nm_s_per_rad: 0.03, beside: None };
    let (course, response) = compared_with(&model, 100.0, friction);
    let demand = worst(&course.torque_demand_nm, &response.torque_demand_nm);
    assert!(demand < 0.3, "{demand} Nm");
    let (without, _) = compared(&model, 100.0);
    // At rest at 130 rad/s in the end.
    let taken = without.torque_demand_nm.last().unwrap() - course.torque_demand_nm.last().unwrap();
    assert!((taken - friction.torque_nm(130.0)).abs() < 0.3, "{taken} Nm");
    let shaft = without.shaft_torque_nm.last().unwrap() - course.shaft_torque_nm.last().unwrap();
    assert!(shaft.abs() < 0.3, "{shaft} Nm");
}

#[test]
fn regress_what_a_long_run_lacks_is_named() {
    let model = BenchModel { speed_controller: None, ..BenchModel::of(&BenchParameters::default()) };
    let (start, friction) = (InitialState::steady(&model, 100.0, 0.0), DynoFriction::default());
    let inputs =
        CourseInputs { step_samples: 5, speed_demand_rad_s: &[1.0, 1.0], engine_torque_nm: &[0.0, 0.0], friction };
    let error = simulate_course(&model, &inputs, &start).unwrap_err();
    assert_eq!(error, SimulationError::MissingPart { part: Part::SpeedController });
    let inputs = CourseInputs { engine_torque_nm: &[0.0], ..inputs };
    let model = BenchModel::of(&BenchParameters::default());
    assert!(matches!(simulate_course(&model, &inputs, &start), Err(SimulationError::Length { .. })));
}
